"""The curve of periodic orbits over a parameter, and Newton's method onto it.

G(z, p) = P^n(z; p) - z = 0 with states and parameter scaled. dG/dz comes from the variational
equations, dG/dp from derivatives of the map where it has them and else from a difference. A fold
is where (1 - mu_1)(1 - mu_2)... vanishes, a period doubling where (1 + mu_1)(1 + mu_2)... does, a
torus where a product 1 - mu_i mu_j of a pair does. Where the return map jumps, Newton's method has
nothing to end on: the orbit is then said not to be there.
Checked by ``tests/analysis/test_continuation.py``: dG/dp against differences of the map, the
located points against independent values.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import brentq

from thermogear.analysis.orbits import Orbit, closed
from thermogear.analysis.section import plain
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.return_map import ReturnMap, Visit, is_moved, return_map

Family = Callable[[float], object]

NEWTON_TOLERANCE = 1e-14
ROUNDING = 1e-10
"""A residual that no longer falls is rounding below this (scaled); a long orbit carries its own."""
KEPT = 2
"""Values of the parameter whose maps a curve remembers."""
ENOUGH = (0.0, 1e-2 * ROUNDING, ROUNDING)
"""What a residual must be below that has not fallen for so many steps."""
MOVED = 1e-6
"""A step of the parameter (scaled) that is long enough to tell dG/dp."""
ZERO = 1e-13
"""Scaled distance along the branch to which events are located."""
ROUGH = 1e-4
"""That step where the return map itself is differentiated, which carries more rounding."""
FOUND = 1e-9
"""As :data:`ZERO`, of such a map."""
SHARES = (0.5, 0.4, 0.6, 0.2, 0.8)
"""Where between two orbits another one is looked for."""
JUMP = 3e-5
"""Scaled distance within which no orbit may close, where such a map jumps."""
HOPELESS = 6
"""Newton's steps without a smaller residual, from one side of such a jump to the other."""
SMALL = 1e-5
"""Step of the parameter (of its range) in which the numbers of the equation are differentiated.

Rounding, 1/SMALL times enlarged, and the curvature, SMALL^2, are alike in size. It turns the
tangent a little: points slip along the branch, by 1e-13, and not off it.
"""


@dataclass(frozen=True, kw_only=True)
class Tests:
    """What vanishes where a multiplier is +1, -1, or the product of two multipliers is 1.

    ``fold`` is (1 - mu_1)(1 - mu_2)..., ``flip`` (1 + mu_1)(1 + mu_2)..., ``torus`` the product of
    1 - mu_i mu_j over all pairs.
    Of two multipliers with a known product the products of all factors themselves, of more the
    smallest factor with the sign of their product.

    ``spiral``: 1 less the largest modulus of a complex pair; inf where there is none, or where the
    product of both is known.
    """

    fold: float
    flip: float
    torus: float
    spiral: float = np.inf

    @classmethod
    def of(cls, jacobian: Floats, closing: float) -> Tests:
        """Of a Jacobian (d, d) with the determinant ``closing`` (nan: not known)."""
        if jacobian.shape == (2, 2) and not np.isnan(closing):
            trace = float(jacobian[0, 0] + jacobian[1, 1])
            return cls(fold=1.0 - trace + closing, flip=1.0 + trace + closing, torus=1.0 - closing)
        mu = np.linalg.eigvals(jacobian).astype(complex)
        pairs = np.triu_indices(mu.size, 1)
        turning = np.abs(mu[np.abs(mu.imag) > 1e-6])
        return cls(
            spiral=float(1.0 - turning.max()) if turning.size else np.inf,
            fold=_nearest(1.0 - mu),
            flip=_nearest(1.0 + mu),
            torus=_nearest(1.0 - mu[pairs[0]] * mu[pairs[1]]),
        )


def _nearest(factors: Any) -> float:
    """The smallest of ``factors`` by modulus, with the sign of their product, which is real.

    Of hundreds the product itself may be as small as rounding without any of them.
    """
    sizes = np.abs(factors)
    least = float(sizes.min()) if sizes.size else 1.0
    return least if not least > 0.0 else float(np.copysign(least, np.prod(factors / sizes).real))


@dataclass(frozen=True, kw_only=True)
class Point:
    """A converged point of a branch in scaled coordinates (d + 1,), with its tangent.

    ``visit`` runs over the whole orbit, ``determinant`` is that of its Jacobian (nan: not known).
    ``tests`` of the map whose fixed point it is: the orbit's own, or of a symmetric orbit half of
    it with the sign reversed. ``margin``: how near an extreme of x comes to an edge of the
    backlash, in half backlashes (inf: x does not turn, or nothing is known of it). ``slope`` (d,):
    dG/dp.
    """

    scaled: Floats
    tangent: Floats
    visit: Visit
    determinant: float
    tests: Tests
    margin: float
    slope: Floats
    losses: tuple[int, ...] | None = None
    """How often every contact opens, where the map tells of its extremes."""

    @property
    def contacts(self) -> tuple[int, ...]:
        """How often the drive flank opens and the back flank closes, and bearings open."""
        return self.losses or (self.visit.contact_losses, self.visit.back_impacts)

    @property
    def floats(self) -> bool:
        """Whether the orbit never touches a tooth."""
        return not any(self.contacts[:2]) and float(self.visit.shares[1]) > 0.5


def mirrored(lanes: Lanes, period: int) -> bool:
    """Whether x(t) -> -x(t + n T/2) takes solutions to solutions, n = ``period``.

    Of odd n a force of odd orders and a stiffness of even ones do it, of even n no force at all.
    """
    tables = (*lanes.stiffness_pieces, *lanes.force_pieces)
    if any(piece is not None for piece in tables):
        return False
    if period % 2 == 0:
        return not np.any(lanes.force)
    return not (np.any(lanes.force[:, ::2]) or np.any(lanes.stiffness[:, 1::2]))


class Curve:
    """G(z, p) = P^n(z; p) - z in coordinates scaled by the map's units and the parameter's range.

    Of one mass these are b and 2 pi b/T.

    ``mirrors``: :func:`mirrored` holds all along. On a ``symmetric`` branch, of orbits with
    x(t + n T/2) = -x(t), P^n is the square of the map H = -(half an orbit), and G = H(z; p) - z:
    where its symmetry breaks the orbit has a multiplier +1 of P^n, but -1 of H, so that the
    branch runs through the pitchfork as any branch runs through a flip. ``maps`` of the last
    values are kept there, for another curve of the same family.
    """

    def __init__(
        self,
        family: Family,
        parameter: str,
        period: int,
        *,
        start: float,
        span: float,
        mirrors: bool = False,
        symmetric: bool = False,
        maps: dict[float, ReturnMap] | None = None,
    ) -> None:
        self.family = family
        self.mirrors = mirrors
        self.parameter = parameter
        self.period = period
        self.span = span
        self.symmetric = symmetric
        self._maps = {} if maps is None else maps
        self._last: tuple[bytes, Visit] | None = None
        self._moved: dict[float, Any] = {}
        self.unit = np.append(self.map_at(start).unit, span)

    @property
    def dimension(self) -> int:
        """Length d of a state."""
        return self.unit.size - 1

    @property
    def upright(self) -> Floats:
        """The direction (d + 1,) of the parameter alone."""
        return np.append(np.zeros(self.dimension), 1.0)

    def map_at(self, value: float) -> ReturnMap:
        """The return map at a value, prepared once for all orbits looked at there in a row."""
        if value not in self._maps:
            _keep(self._maps, value, return_map(self.family(value)))
        return self._maps[value]

    def residual(self, scaled: Floats) -> tuple[Floats, Floats, ReturnMap]:
        """G (d,), the Jacobian (d, d) of the closing map in units of the model, its maps."""
        value = scaled * self.unit
        section = self.map_at(float(value[-1]))
        if not is_moved(section):
            try:
                visit = self._visit(scaled, section)
            except ConvergenceError:  # Newton's step led to where motions run away
                d = self.dimension
                return np.full(d, np.nan), np.full((d, d), np.nan), section
            end, jacobian = visit.points[-1], visit.jacobian
        elif self.symmetric:
            end, jacobian = section.flow(value[:-1], self.period)
            end, jacobian = -end, -jacobian
        else:
            end, jacobian = section.flow(value[:-1], 2 * self.period)
        return (end - value[:-1]) / self.unit[:-1], jacobian, section

    def _visit(self, scaled: Floats, section: ReturnMap) -> Visit:
        """The whole orbit with its Jacobian; the last one is remembered."""
        key = scaled.tobytes()
        if self._last is None or self._last[0] != key:
            value = scaled[:-1] * self.unit[:-1]
            self._last = (key, section.visit(value, self.period))
        return self._last[1]

    @property
    def exact(self) -> bool:
        """Whether the maps are exact to rounding; otherwise they carry an integrator's error."""
        return all(is_moved(one) for one in self._maps.values())

    def in_parameter(self, scaled: Floats, section: ReturnMap) -> tuple[Floats, float]:
        """dG/dp (d,) along the path of this orbit, and its margin in half backlashes.

        Of one mass the maps are differentiated, not the trajectory: crossings stay at their phases,
        so that no grazing lies between the ends of a difference. Of other models by differences;
        nan where the motion runs away.
        """
        value = scaled * self.unit
        rates = self._rates(float(value[-1]))
        if not is_moved(section):
            try:
                ends = [weight * one.carry(value[:-1], self.period)[-1] for weight, one in rates]
            except ConvergenceError:
                return np.full(self.dimension, np.nan), np.inf
            moved = np.sum(ends, axis=0) * self.span / self.unit[:-1]
            return moved, np.inf
        halves = self.period if self.symmetric else 2 * self.period
        moved, margin = section.moved(value[:-1], halves, rates)
        sign = -1.0 if self.symmetric else 1.0
        return sign * moved * self.span / self.unit[:-1], margin

    def _rates(self, value: float) -> Any:
        """What :meth:`in_parameter` needs at a value of the parameter.

        Of one mass the derivatives of the affine maps by the parameter, exact but for those of the
        equation's numbers: central differences, one-sided at the parameter's border. Of other
        models the weights and maps of such differences.
        """
        if value in self._moved:
            return self._moved[value]
        section = self.map_at(value)
        small = (SMALL if is_moved(section) else ROUGH) * self.span
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                around = {k: plain(self.family(value + k * small)) for k in weights}
            except InputError:
                continue
            break
        else:
            raise InputError(self.parameter, value, allowed="values with neighbours")
        rates = [(weight / small, around[k]) for k, weight in weights.items()]
        found: Any
        found = (
            section.rates(rates)
            if is_moved(section)
            else [(w, return_map(one)) for w, one in rates]
        )
        _keep(self._moved, value, found)
        return found

    def correct(
        self,
        guess: Floats,
        *,
        normal: Floats,
        old: Floats | None = None,
        reach: float = np.inf,
        near: Floats | None = None,
        slope: Floats | None = None,
    ) -> Point | None:
        """Newton onto the curve inside the plane through ``guess`` normal to ``normal``.

        It begins at ``near``, a better guess in that plane, with dG/dp as ``slope`` says, and
        stays within ``reach`` of ``guess``. Done when the residual is below 1e-14, or no longer
        falls and is what rounding leaves.
        """
        scaled = guess.copy() if near is None else near.copy()
        d = self.dimension
        matrix = np.empty((d + 1, d + 1))
        matrix[d] = normal
        units = self.unit[:-1]
        best: tuple[float, Floats, Floats, ReturnMap] | None = None
        last = np.inf
        stalled = 0
        upright = not normal[:-1].any()
        step: Floats = np.zeros(d + 1)
        before: Floats = step
        for count in range(20):
            gap, jacobian, section = self.residual(scaled)
            size = float(np.max(np.abs(gap)))
            if not (np.isfinite(size) and np.all(np.isfinite(jacobian))):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian, section), 0
            else:
                stalled += 1
            enough = NEWTON_TOLERANCE if is_moved(section) else ROUNDING
            hopeless = stalled >= HOPELESS and not is_moved(section)
            if size <= enough or best[0] < ENOUGH[min(stalled, 2)] or hopeless:
                break
            flat = jacobian / units[:, None] * units - np.eye(d)
            if upright:
                matrix[:d, d] = 0.0  # the parameter does not move
            elif count == 0 and slope is not None:
                matrix[:d, d] = slope
            elif count > 0 and abs(step[-1]) > MOVED:
                # the mean of dG/dp over the last step, from what it did to the residual
                mean = 0.5 * (matrix[:d, :d] + flat)
                matrix[:d, d] = (gap - before - mean @ step[:-1]) / step[-1]
            elif count == 0 or (size > 0.01 * last and size > 1e-11):
                # dear, and near enough from the last time while Newton falls fast
                matrix[:d, d] = self.in_parameter(scaled, section)[0]
            matrix[:d, :d] = flat
            before = gap
            last = size
            try:
                right = np.append(-gap, -normal @ (scaled - guess))
                step = np.asarray(np.linalg.solve(matrix, right), dtype=float)
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        return self._point(*best[1:], direction=normal if old is None else old)

    def _point(
        self, scaled: Floats, jacobian: Floats, section: ReturnMap, *, direction: Floats
    ) -> Point | None:
        """The point at ``scaled``, its tangent along ``direction``; None without numbers."""
        units = self.unit[:-1]
        slope, margin = self.in_parameter(scaled, section)
        watch = None if is_moved(section) else getattr(section, "extremes", None)
        seen = None if watch is None else watch(scaled[:-1] * units, self.period)
        flat = jacobian / units[:, None] * units
        matrix = np.column_stack([flat - np.eye(self.dimension), slope])
        if not np.all(np.isfinite(matrix)):
            return None
        null = _null(matrix)
        whole = section.determinant(self.period)
        return Point(
            scaled=scaled,
            tangent=-null if null @ direction < 0.0 else null,
            visit=self._visit(scaled, section),
            determinant=whole,
            tests=Tests.of(jacobian, float(np.sqrt(whole)) if self.symmetric else whole),
            margin=margin if seen is None else seen.margin,
            slope=slope,
            losses=None if seen is None else seen.losses,
        )

    def orbit(self, point: Point) -> Orbit:
        value = point.scaled * self.unit
        model = self.family(float(value[-1]))
        return closed(return_map(model), value[:-1], self.period, model=model)


def _keep(kept: dict[float, Any], value: float, found: object) -> None:
    while len(kept) >= KEPT:
        del kept[next(iter(kept))]
    kept[value] = found


def _null(matrix: Floats) -> Floats:
    """The unit vector (d + 1,) that all rows (d, d + 1) are normal to."""
    if matrix.shape != (2, 3):
        # the columns of the transpose span d of d + 1 directions; the last of Q is the other
        return np.asarray(np.linalg.qr(matrix.T, mode="complete")[0][:, -1])
    (a, b, c), (d, e, f) = matrix.tolist()
    null = np.array([b * f - c * e, c * d - a * f, a * e - b * d])
    size = float(np.linalg.norm(null))
    if size > 1e-6 * float(np.sum(matrix * matrix)):
        return null / size
    return np.asarray(np.linalg.svd(matrix)[2][2])


class Stretch:
    """The curve between two neighbouring points, by the distance along the first one's tangent.

    Each point is computed once, from a guess between its known neighbours.
    """

    def __init__(self, curve: Curve, a: Point, b: Point) -> None:
        self.curve = curve
        self.first = a
        self.length = float((b.scaled - a.scaled) @ a.tangent)
        self.points = {0.0: a, self.length: b}

    def at(self, step: float) -> Point:
        """The point a distance ``step`` on; ConvergenceError where Newton finds none."""
        found = self.points.get(step)
        if found is None:
            a, curve = self.first, self.curve
            near, slope = self._near(step)
            found = curve.correct(
                a.scaled + step * a.tangent,
                normal=a.tangent,
                old=a.tangent,
                near=near,
                slope=slope,
            )
            if found is None:
                raise ConvergenceError(
                    f"no orbit found near {curve.parameter} = "
                    f"{float((a.scaled[-1] + step * a.tangent[-1]) * curve.span)!r}, "
                    "between two orbits of the branch"
                )
            self.points[step] = found
        return found

    def between(self, *, low: float, high: float) -> float | None:
        """A step between two of them where Newton finds an orbit; None where it finds none.

        An engine misses contacts that are shorter than its steps; where it begins to see one its
        map jumps by rounding's size or more, and on a short piece of the branch no orbit closes.
        """
        steps = (low + share * (high - low) for share in SHARES)
        return next((step for step in steps if self.closes(step)), None)

    def closes(self, step: float) -> bool:
        """Whether Newton finds an orbit a distance ``step`` on."""
        try:
            self.at(step)
        except ConvergenceError:
            return False
        return True

    def narrowed(self, same: Callable[[Point], bool], low: float) -> float:
        """The first step known beyond ``low`` that is not ``same``, within :data:`JUMP` of one.

        ConvergenceError where no orbits close that near to each other.
        """
        while True:
            known = sorted(step for step in self.points if step >= low)
            place = next(i for i, step in enumerate(known) if not same(self.points[step]))
            below, high = known[place - 1], known[place]
            if high - below <= JUMP:
                return high
            if self.between(low=below, high=high) is None:
                self.at(0.5 * (below + high))  # raises what it says of that orbit

    def _near(self, step: float) -> tuple[Floats, Floats]:
        """On the cubic through the neighbours on either side and their tangents; dG/dp there."""
        low = max((s for s in self.points if s < step), default=0.0)
        high = min((s for s in self.points if s > step), default=self.length)
        width = high - low
        along = self.first.tangent
        one, other = self.points[low], self.points[high]
        t = (step - low) / width
        chord = other.scaled - one.scaled
        begin = width / float(one.tangent @ along) * one.tangent
        end = width / float(other.tangent @ along) * other.tangent
        bent = t * (1.0 - t) * ((1.0 - t) * (begin - chord) - t * (end - chord))
        return one.scaled + t * chord + bent, one.slope + t * (other.slope - one.slope)

    def zero(self, test: Callable[[Point], float], *, low: float, high: float) -> float:
        """Where ``test`` of the point, of different signs at both ends, vanishes between them."""
        near = self.near
        return float(brentq(lambda step: test(self.at(step)), low, high, xtol=near, rtol=8.9e-16))

    @property
    def near(self) -> float:
        """Scaled distance to which a zero is located."""
        return ZERO if self.curve.exact else FOUND
