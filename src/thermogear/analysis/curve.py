"""The curve of periodic orbits over a parameter, and Newton's method onto it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from thermogear.analysis.orbits import Orbit, closed
from thermogear.analysis.section import lanes_of
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics import exact
from thermogear.dynamics.exact_map import ExactMap, scales
from thermogear.dynamics.return_map import Visit
from thermogear.dynamics.tables import Lanes

Floats = NDArray[np.float64]
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
SMALL = 1e-5
"""Step of the parameter (of its range) in which the numbers of the equation are differentiated.

Rounding, 1/SMALL times enlarged, and the curvature, SMALL^2, are alike in size. It turns the
tangent a little: points slip along the branch, by 1e-13, and not off it.
"""


@dataclass(frozen=True, kw_only=True)
class Point:
    """A converged point of a branch in scaled coordinates, with its tangent.

    ``visit`` runs over the whole orbit, ``determinant`` is that of its Jacobian. ``trace`` and
    ``closing`` are trace and determinant of the map whose fixed point it is: the orbit's own, or
    of a symmetric orbit half of it with the sign reversed. ``margin``: how near an extreme of x
    comes to an edge of the backlash, in half backlashes (inf: x does not turn). ``slope`` (2,):
    dG/dp.
    """

    scaled: Floats
    tangent: Floats
    visit: Visit
    determinant: float
    trace: float
    closing: float
    margin: float
    slope: Floats

    @property
    def fold(self) -> float:
        """(1 - mu_1)(1 - mu_2)."""
        return 1.0 - self.trace + self.closing

    @property
    def flip(self) -> float:
        """(1 + mu_1)(1 + mu_2)."""
        return 1.0 + self.trace + self.closing

    @property
    def contacts(self) -> tuple[int, int]:
        return self.visit.contact_losses, self.visit.back_impacts

    @property
    def floats(self) -> bool:
        """Whether the orbit never touches a tooth."""
        return self.contacts == (0, 0) and float(self.visit.shares[1]) > 0.5


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
    """G(z, p) = P^n(z; p) - z in coordinates scaled by b, 2 pi b/T and the parameter's range.

    ``mirrors``: :func:`mirrored` holds all along. On a ``symmetric`` branch, of orbits with
    x(t + n T/2) = -x(t), P^n is the square of the map H = -(half an orbit), and G = H(z; p) - z:
    where its symmetry breaks the orbit has a multiplier +1 of P^n, but -1 of H, so that the
    branch runs through the pitchfork as any branch runs through a flip.
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
    ) -> None:
        self.family = family
        self.mirrors = mirrors
        self.parameter = parameter
        self.period = period
        self.span = span
        self.symmetric = symmetric
        self.unit = np.append(scales(lanes_of(family(start))), span)
        self._maps: dict[float, ExactMap] = {}
        self._moved: dict[float, tuple[Floats, Floats, float]] = {}

    def map_at(self, value: float) -> ExactMap:
        """The return map at a value, prepared once for all orbits looked at there in a row."""
        if value not in self._maps:
            _keep(self._maps, value, ExactMap(lanes_of(self.family(value))))
        return self._maps[value]

    def residual(self, scaled: Floats) -> tuple[Floats, Floats, ExactMap]:
        """G (2,), the Jacobian (2, 2) of the closing map in units of the model, its maps."""
        value = scaled * self.unit
        section = self.map_at(float(value[2]))
        if self.symmetric:
            end, jacobian = section.flow(value[:2], self.period)
            end, jacobian = -end, -jacobian
        else:
            end, jacobian = section.flow(value[:2], 2 * self.period)
        return (end - value[:2]) / self.unit[:2], jacobian, section

    def in_parameter(self, scaled: Floats, section: ExactMap) -> tuple[Floats, float]:
        """dG/dp (2,) along the path of this orbit, and its margin in half backlashes.

        The maps are differentiated, not the trajectory: crossings stay at their phases, so that
        no grazing lies between the ends of a difference.
        """
        value = scaled * self.unit
        maps = section.maps
        count = maps.half.shape[0]
        if self.symmetric:
            middle = int(np.searchsorted(maps.borders, 0.5))
            steps = (self.period // 2) * count + (middle if self.period % 2 else 0)
        else:
            steps = self.period * count
        rates = self._rates(float(value[2]))
        moved, margin = exact.moved_by(maps, rates=rates, start=value[:2], steps=steps)
        sign = -1.0 if self.symmetric else 1.0
        return sign * moved * self.span / self.unit[:2], margin / section.backlash

    def _rates(self, value: float) -> tuple[Floats, Floats, float]:
        """Derivatives of the affine maps by the parameter, exact but for those of the equation's
        numbers: central differences, one-sided at the parameter's border."""
        if value in self._moved:
            return self._moved[value]
        section = self.map_at(value)
        small = SMALL * self.span
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                around = {k: lanes_of(self.family(value + k * small)) for k in weights}
            except InputError:
                continue
            break
        else:
            raise InputError(self.parameter, value, allowed="values with neighbours")
        rates = [(weight / small, around[k]) for k, weight in weights.items()]
        found = exact.maps_moved(section.maps, section.lanes, rates)
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
        matrix = np.empty((3, 3))
        matrix[2] = normal
        two = self.unit[:2]
        best: tuple[float, Floats, Floats, ExactMap] | None = None
        last = np.inf
        stalled = 0
        upright = not normal[:2].any()
        step = before = np.zeros(3)
        for count in range(20):
            gap, jacobian, section = self.residual(scaled)
            size = float(np.max(np.abs(gap)))
            if not (np.isfinite(size) and np.all(np.isfinite(jacobian))):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian, section), 0
            else:
                stalled += 1
            if size <= NEWTON_TOLERANCE or best[0] < ENOUGH[min(stalled, 2)]:
                break
            flat = jacobian / two[:, None] * two - np.eye(2)
            if upright:
                matrix[:2, 2] = 0.0  # the parameter does not move
            elif count == 0 and slope is not None:
                matrix[:2, 2] = slope
            elif count > 0 and abs(step[2]) > MOVED:
                # the mean of dG/dp over the last step, from what it did to the residual
                mean = 0.5 * (matrix[:2, :2] + flat)
                matrix[:2, 2] = (gap - before - mean @ step[:2]) / step[2]
            elif count == 0 or (size > 0.01 * last and size > 1e-11):
                # dear, and near enough from the last time while Newton falls fast
                matrix[:2, 2] = self.in_parameter(scaled, section)[0]
            matrix[:2, :2] = flat
            before = gap
            last = size
            try:
                step = np.linalg.solve(matrix, [-gap[0], -gap[1], -normal @ (scaled - guess)])
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        return self._point(*best[1:], direction=normal if old is None else old)

    def _point(
        self, scaled: Floats, jacobian: Floats, section: ExactMap, *, direction: Floats
    ) -> Point | None:
        """The point at ``scaled``, its tangent along ``direction``; None without numbers."""
        two = self.unit[:2]
        slope, margin = self.in_parameter(scaled, section)
        matrix = np.column_stack([jacobian / two[:, None] * two - np.eye(2), slope])
        if not np.all(np.isfinite(matrix)):
            return None
        null = _null(matrix)
        whole = section.determinant(self.period)
        return Point(
            scaled=scaled,
            tangent=-null if null @ direction < 0.0 else null,
            visit=section.visit(scaled[:2] * two, self.period),
            determinant=whole,
            trace=float(jacobian[0, 0] + jacobian[1, 1]),
            closing=float(np.sqrt(whole)) if self.symmetric else whole,
            margin=margin,
            slope=slope,
        )

    def orbit(self, point: Point) -> Orbit:
        value = point.scaled * self.unit
        model = self.family(float(value[2]))
        return closed(ExactMap(lanes_of(model)), value[:2], self.period, model=model)


def _keep(kept: dict[float, Any], value: float, found: object) -> None:
    while len(kept) >= KEPT:
        del kept[next(iter(kept))]
    kept[value] = found


def _null(matrix: Floats) -> Floats:
    """The unit vector (3,) that both rows (2, 3) are normal to."""
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
                    f"{float((a.scaled[2] + step * a.tangent[2]) * curve.span)!r}, "
                    "between two orbits of the branch"
                )
            self.points[step] = found
        return found

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
        return float(brentq(lambda step: test(self.at(step)), low, high, xtol=ZERO, rtol=8.9e-16))
