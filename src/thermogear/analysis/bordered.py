"""The equations of a fold, period doubling, pitchfork, torus or grazing in two parameters.

Unknown are the state z (d,) on the section and both parameters p and q. The orbit closes, G(z, p,
q) = 0, and one scalar g vanishes. Of a real multiplier s = +1 or -1, with J = DP^n,

    (J - s 1, b; c^T, 0)(v; g) = (0; 1),        dg/da = -w^T (dJ/da) v,

w^T the same of J^T with b and c exchanged; b and c are the singular vectors of the last point, so
that the bordered matrix is regular, also where the curve turns. Of a complex pair g = |mu|^2 - 1
and dmu/da = w^H (dJ/da) v/(w^H v). As second derivatives commute, w^T (dJ/dz_i) v for all i is w^T
times one difference of J along v: a step costs as many runs for thirty coordinates as for one.
J is that of the variational equations; derivatives of J, and those by p and q, are central
differences and steer Newton's method alone. Of a grazing g is the depth of the extreme that
touches, which its contact and its phase tell from others. Derivatives of g are needed in three
directions alone, the two in which G stays 0 and the one in which it gets there. Behind a grazing J
changes as the root of the depth: Newton's method converges, of the order 3/2.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from thermogear.analysis.bifurcations import FLIP, GRAZING, PITCHFORK, TORUS, Bifurcation
from thermogear.analysis.curve import Curve, Family, Point
from thermogear.analysis.nearby import zero_near
from thermogear.analysis.orbits import multipliers
from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.dynamics.extremes import Extremes, Touch
from thermogear.dynamics.return_map import is_moved

Sheet = Callable[[float, float], object]
"""(p, q) -> model."""

APART = {True: 1e-5, False: 1e-4}
"""Scaled step of the differences: of one mass, and of maps that carry more rounding."""
TOUCHING = {True: 1e-7, False: 1e-5}
"""The same of a grazing: the kink of G counts with the root of the step."""
CLOSED = {True: 1e-12, False: 1e-10}
"""A residual at which Newton's method ends, as :data:`APART`."""
GRAZED = {True: 1e-11, False: 1e-10}
"""The same of a grazing, whose g carries the interpolation of a motion."""
ROUNDING = 1e-8
"""A residual that no longer falls is rounding below this."""
MOST_STEPS = 10
SLOW, PATIENT = 0.5, 2.0
"""A residual that falls less in a step asks for fresh derivatives; of a train's grazing, whose
derivatives cost ten models, one that grows by so much, chosen: a fifth of the models a point."""
PHASE = 0.05
"""A mesh period, to see which extreme of x touches; the same one from point to point [orbits]."""
LEAP = 1e-3
"""A zero through which g jumps by more is none."""
WIDTH = 1e-4
"""First step of a search along a line, a share of the parameter's range."""
ANGLE, ROUND = 0.03, 10.0
"""First step of one on a circle, and the angle that counts as one half backlash [rad]."""
OUTSIDE = 1e-6
"""Beyond 1 by more, a multiplier other than the one that bifurcates makes the orbit unstable."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Located:
    """A converged point (d + 2,), its equations' matrix (d + 1, d + 2) and its tangent."""

    scaled: Floats
    matrix: Floats
    tangent: Floats
    jacobian: Floats
    multipliers: Complexes
    touch: Touch | None = None
    losses: tuple[int, ...] = ()
    """Of a grazing how often every contact opens, with the one that touches left out."""


@dataclass(frozen=True, kw_only=True)
class Path:
    """A line or circle ``at`` value -> (p, q), searched from ``start``.

    ``span`` of the value counts as a half backlash; ``first`` step, so scaled.
    """

    at: Callable[[float], tuple[float, float]]
    start: float
    span: float
    first: float


class Bordered:
    """G and g over (z, p, q), scaled by the map's units and by both ranges."""

    def __init__(
        self,
        bifurcation: Bifurcation,
        sheet: Sheet,
        second: float,
        *,
        spans: tuple[float, float],
    ) -> None:
        self.kind = bifurcation.kind
        self.bifurcation = bifurcation
        self.sheet = sheet
        self.spans = spans
        self._curves: dict[float, Curve] = {}
        self.unit = self._made(second, bifurcation.value).unit
        self.whole = np.append(self.unit, spans[1])
        one_mass = is_moved(bifurcation.orbit.section)
        self.apart = (TOUCHING if self.kind == GRAZING else APART)[one_mass]
        self.closed = (GRAZED if self.kind == GRAZING else CLOSED)[one_mass]
        # a train's grazing: a model costs more than its orbit
        self.dear = self.kind == GRAZING and not one_mass
        self.root = -1.0 if self.kind in (FLIP, PITCHFORK) else 1.0
        self.mu = complex(self.root)
        if self.kind == TORUS:
            given = bifurcation.multipliers
            off = np.where(np.abs(given.imag) > 1e-9, np.abs(np.abs(given) - 1.0), np.inf)
            mu = complex(given[int(off.argmin())])
            self.mu = complex(mu.real, abs(mu.imag))
        self.borders: tuple[Floats, Floats] | None = None
        self.refused = ""
        self.touch: Touch | None = None
        if self.kind == GRAZING:
            place = np.append(bifurcation.state, [bifurcation.value, second]) / self.whole
            self.touch = self._extremes(place).touch()

    def _made(self, second: float, value: float) -> Curve:
        return self._over(lambda first: self.sheet(first, second), value, self.spans[0])

    def _over(self, family: Family, start: float, span: float) -> Curve:
        broken = self.kind == PITCHFORK
        return Curve(
            family, self.bifurcation.parameter, self.bifurcation.period, start=start, span=span,
            mirrors=broken, symmetric=broken,
        )  # fmt: skip

    def curve(self, second: float, *, value: float) -> Curve:
        """The curve of orbits over p at one q, in the units of the first one."""
        found = self._curves.get(second)
        if found is None:
            for old in list(self._curves)[:-3]:
                del self._curves[old]
            found = self._curves[second] = self._made(second, value)
            found.unit = self.unit
        return found

    def closing(self, scaled: Floats) -> tuple[Floats, Floats]:
        """G (d,) and J (d, d), both scaled."""
        value = scaled * self.whole
        curve = self.curve(float(value[-1]), value=float(value[-2]))
        gap, jacobian, _ = curve.residual(scaled[:-1])
        return gap, self._scaled(jacobian)

    def _scaled(self, jacobian: Floats) -> Floats:
        units = self.unit[:-1]
        return np.asarray(jacobian / units[:, None] * units)

    def _extremes(self, scaled: Floats) -> Extremes:
        """Those of the orbit through a point."""
        value = scaled * self.whole
        section: Any = self.curve(float(value[-1]), value=float(value[-2])).map_at(float(value[-2]))
        seen: Extremes = section.extremes(value[:-2], self.bifurcation.period)
        return seen

    def depth(self, scaled: Floats) -> float:
        """Of a grazing the depth of the extreme that touches [half backlashes]; nan without it."""
        assert self.touch is not None
        seen = self._extremes(scaled)
        place = seen.place(self.touch, within=PHASE)
        return np.nan if place is None else float(seen.depth[place])

    def depths_beside(self, point: Located) -> float:
        """How far the next extreme's depth is from 0 at a grazing [half backlashes]; else inf."""
        if self.touch is None:
            return np.inf
        seen = self._extremes(point.scaled)
        of_contact = seen.depth[seen.contact == self.touch.contact]
        return float(np.sort(np.abs(of_contact))[1])

    def border(self, jacobian: Floats) -> None:
        """Take b and c from J, for the points that come."""
        left, _, right = np.linalg.svd(jacobian - self.root * np.eye(len(jacobian)))
        self.borders = (left[:, -1], right[-1])

    def vectors(self, jacobian: Floats) -> tuple[float, Any, Any]:
        """g, and v and w with dg = Re(w (dJ) v)."""
        if self.kind == TORUS:
            values, right = np.linalg.eig(jacobian)
            left = np.linalg.inv(right)
            place = int(np.argmin(np.abs(values - self.mu)))
            mu = complex(values[place])
            return abs(mu) ** 2 - 1.0, right[:, place], 2.0 * np.conj(mu) * left[place]
        if self.borders is None:
            self.border(jacobian)
        assert self.borders is not None
        b, c = self.borders
        d = len(jacobian)
        matrix = np.zeros((d + 1, d + 1))
        matrix[:d, :d] = jacobian - self.root * np.eye(d)
        matrix[:d, d], matrix[d, :d] = b, c
        last = np.append(np.zeros(d), 1.0)
        v, w = np.linalg.solve(matrix, last), np.linalg.solve(matrix.T, last)
        return float(v[d]), v[:d], -w[:d]

    def residual(self, scaled: Floats) -> tuple[Floats, Floats]:
        """(G, g) (d + 1,) and J."""
        gap, jacobian = self.closing(scaled)
        if not (np.all(np.isfinite(gap)) and np.all(np.isfinite(jacobian))):
            return np.full(gap.size + 1, np.nan), jacobian
        return np.append(gap, self.measure(scaled, jacobian=jacobian)), jacobian

    def measure(self, scaled: Floats, *, jacobian: Floats) -> float:
        """g, of a point with its J."""
        return self.depth(scaled) if self.kind == GRAZING else self.vectors(jacobian)[0]

    def matrix(self, scaled: Floats, *, jacobian: Floats) -> Floats:
        """d(G, g)/d(z, p, q), (d + 1, d + 2)."""
        d = len(jacobian)
        found = np.zeros((d + 1, d + 2))
        found[:d, :d] = jacobian - np.eye(d)
        changes = [self._apart(scaled, along, self._closed) for along in np.eye(d + 2)[d:]]
        found[:d, d:] = np.stack([change[:, 0] for change in changes], axis=1)
        if self.kind == GRAZING:
            if np.all(np.isfinite(found)):
                left, sizes, ways = np.linalg.svd(found[:d])
                back = ways[:d].T @ (left.T @ self.closing(scaled)[0] / sizes)
                size = float(np.linalg.norm(back))
                ahead = np.vstack([ways[d:], back / size]) if size > ROUNDING else ways[d:]
                found[d] = [self._apart(scaled, along, self.depth) for along in ahead] @ ahead
            return found
        _, v, w = self.vectors(jacobian)
        for factor, along in ((1.0, np.real(v)), (1j, np.imag(v))):
            size = float(np.linalg.norm(along))
            if size > 0.0:
                change = self._apart(scaled, np.append(along / size, [0.0, 0.0]), self._closed)
                found[d, :d] += size * (factor * (w @ change[:, 1:])).real
        found[d, d:] = [(w @ change[:, 1:] @ v).real for change in changes]
        return found

    def _closed(self, scaled: Floats) -> Floats:
        """G and J side by side (d, 1 + d)."""
        gap, jacobian = self.closing(scaled)
        return np.column_stack([gap, jacobian])

    def _apart(self, scaled: Floats, along: Floats, what: Callable[[Floats], Any]) -> Any:
        """The derivative of ``what`` along a direction, one-sided at a parameter's border."""
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                parts = [w * what(scaled + k * self.apart * along) for k, w in weights.items()]
            except InputError:
                continue
            return sum(parts) / self.apart
        raise InputError("parameter", (scaled * self.whole)[-2:].tolist(), allowed="neighbours")

    def correct(
        self,
        guess: Floats,
        *,
        normal: Floats,
        matrix: Floats | None = None,
        direction: Floats | None = None,
        reach: float = np.inf,
    ) -> Located | None:
        """Newton onto the curve in the plane through ``guess`` normal to ``normal``.

        It begins with a ``matrix`` from nearby, and takes a fresh one where that converges slowly.
        Of a train's grazing what the steps made of it serves the point, too: a fresh one costs ten
        models.
        """
        found = self._newton(guess, normal=normal, matrix=matrix, reach=reach)
        if found is None and matrix is not None and self.dear:
            found = self._newton(guess, normal=normal, matrix=None, reach=reach)
        if found is None:
            return None
        scaled, jacobian, left = found
        return self._located(
            scaled, jacobian, direction=direction, matrix=left if self.dear else None
        )

    def _newton(
        self, guess: Floats, *, normal: Floats, matrix: Floats | None, reach: float
    ) -> tuple[Floats, Floats, Floats | None] | None:
        """Point, J and the equations' matrix as the last step left it; None where it fails."""
        bare = self.kind == GRAZING and not self.dear
        kept_matrix = None if matrix is None or bare else matrix.copy()
        scaled = guess.copy()
        best: tuple[float, Floats, Floats] | None = None
        last, stalled, fresh = np.inf, 0, not self.dear
        # of such a grazing the first step behind fresh derivatives closes the orbit alone
        most, often = (SLOW, 0) if fresh else (PATIENT, 1)
        step, before = np.zeros(guess.size), np.zeros(guess.size - 1)
        for number in range(MOST_STEPS):
            rest, jacobian = self.residual(scaled)
            size = float(np.max(np.abs(rest)))
            if not np.isfinite(size):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian), 0
            else:
                stalled += 1
            rounded = stalled > often and best[0] < 0.1 * ROUNDING
            if size <= self.closed or (rounded and fresh) or stalled > 2:
                break
            late = not fresh and (rounded or number == MOST_STEPS - 3)
            if kept_matrix is None or size > most * last or late:
                kept_matrix, fresh = self.matrix(scaled, jacobian=jacobian), True
            elif step.any():
                kept_matrix = kept_matrix + np.outer(rest - before - kept_matrix @ step, step) / (
                    step @ step
                )
                fresh = often == 0
            kept_matrix[:-1, :-2] = jacobian - np.eye(len(jacobian))
            last, before = size, rest
            whole = np.vstack([kept_matrix, normal])
            try:
                step = np.linalg.solve(whole, np.append(-rest, -normal @ (scaled - guess)))
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        if kept_matrix is not None:
            kept_matrix[:-1, :-2] = best[2] - np.eye(len(best[2]))
        return best[1], best[2], kept_matrix

    def _located(
        self, scaled: Floats, jacobian: Floats, *, direction: Floats | None,
        matrix: Floats | None = None,
    ) -> Located | None:  # fmt: skip
        """The point with its derivatives, fresh or ``matrix``; None where they are no numbers."""
        own = self.matrix(scaled, jacobian=jacobian) if matrix is None else matrix
        if not np.all(np.isfinite(own)):
            return None
        tangent = np.linalg.svd(own)[2][-1]
        if direction is not None and tangent @ direction < 0.0:
            tangent = -tangent
        point = Located(
            scaled=scaled,
            matrix=own,
            tangent=tangent,
            jacobian=jacobian,
            multipliers=self.orbit_multipliers(scaled, jacobian=jacobian),
        )
        if self.touch is None:
            return point
        seen = self._extremes(scaled)
        place = seen.place(self.touch, within=PHASE)
        if place is None:
            return None
        return replace(point, touch=seen.touch(place), losses=seen.without(place).losses)

    def on_line(self, guess: Floats, *, held: int) -> Path:
        """Through a point, on which its parameter ``held`` (-1: q, -2: p) stays."""
        p, q = (guess * self.whole)[-2:].tolist()
        if held == -1:
            return Path(at=lambda value: (value, q), start=p, span=self.spans[0], first=WIDTH)
        return Path(at=lambda value: (p, value), start=q, span=self.spans[1], first=WIDTH)

    def on_circle(self, centre: Floats, *, step: Floats) -> Path | None:
        """Around a point, from the end of a ``step``; None where the step moves no parameter."""
        (p, q), (along, across) = centre[-2:].tolist(), step[-2:].tolist()
        radius = float(np.hypot(along, across))
        if radius < 0.05 * float(np.linalg.norm(step)):
            return None
        first, second = self.spans

        def at(angle: float) -> tuple[float, float]:
            return first * (p + radius * np.cos(angle)), second * (q + radius * np.sin(angle))

        angle = float(np.arctan2(across, along))
        return Path(at=at, start=angle, span=ROUND, first=ANGLE / ROUND)

    def searched(
        self, guess: Floats, path: Path, *, direction: Floats, farthest: float
    ) -> Located | None:
        """The point nearest ``guess`` on a ``path`` through the parameters.

        By bracketing g along the branch of orbits over the path. Where a contact begins or ends
        multipliers run as the root of the distance from it, and where an engine begins to see a
        contact within its step they jump a little: no Newton's method follows g there. None
        without such a point within ``farthest``, as the path is scaled.
        """

        def family(value: float) -> object:
            return self.sheet(*path.at(value))

        curve = self._over(family, path.start, path.span)
        curve.unit = np.append(self.unit[:-1], path.span)

        def whole(point: Point) -> Floats:
            values = path.at(float(point.scaled[-1] * path.span))
            return np.append(point.scaled[:-1], np.array(values) / self.whole[-2:])

        def measured(point: Point) -> float:
            gap, jacobian, _ = curve.residual(point.scaled)
            whole_there = np.isfinite(gap).all()
            return (
                self.measure(whole(point), jacobian=self._scaled(jacobian))
                if whole_there
                else np.nan
            )

        start = np.append(guess[:-2], path.start / path.span)
        found = zero_near(curve, measured, start, farthest=farthest, first=path.first)
        if found is None or not abs(measured(found)) < LEAP:
            return None
        scaled = whole(found)
        return self._located(scaled, self.closing(scaled)[1], direction=direction)

    def orbit_multipliers(self, scaled: Floats, *, jacobian: Floats) -> Complexes:
        """Those of the whole orbit, also of a symmetric one."""
        units = self.unit[:-1]
        mine = jacobian * units[:, None] / units
        value = scaled * self.whole
        section = self.curve(float(value[-1]), value=float(value[-2])).map_at(float(value[-2]))
        period = self.bifurcation.period
        whole = mine @ mine if self.kind == PITCHFORK else mine
        return multipliers(whole, section.determinant(period))

    def settle(self, point: Located) -> None:
        """Take borders, multiplier and touch from a point, for those that come."""
        if self.kind == GRAZING:
            self.touch = point.touch
            return
        self.border(point.jacobian)
        if self.kind == TORUS:
            values = np.linalg.eigvals(point.jacobian).astype(complex)
            self.mu = complex(values[int(np.argmin(np.abs(values - self.mu)))])

    def stable(self, found: Complexes) -> bool:
        """Whether no multiplier but those that bifurcate lies outside the unit circle."""
        outside = int(np.sum(np.abs(found) > 1.0 + OUTSIDE))
        if outside == 0:
            return True
        near = np.abs(np.abs(found) - 1.0)
        own = {TORUS: 2, GRAZING: 0}.get(self.kind, 1)
        rest = np.delete(found, np.argsort(near)[:own])
        return not bool(np.any(np.abs(rest) > 1.0 + OUTSIDE))
