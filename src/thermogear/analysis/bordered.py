"""The equations of a fold, period doubling, pitchfork, torus or grazing in two parameters.

Unknown are the state z (d,) on the section and both parameters p and q. The orbit closes, G(z, p,
q) = 0, and one scalar g vanishes. Of a real multiplier s = +1 or -1, with J = DP^n,

    (J - s 1, b; c^T, 0)(v; g) = (0; 1),        dg/da = -w^T (dJ/da) v,

w^T the same of J^T with b and c exchanged; b and c are the singular vectors of the last point, so
that the bordered matrix is regular, also where the curve turns. Of a complex pair g = |mu|^2 - 1
and dmu/da = w^H (dJ/da) v/(w^H v). As second derivatives commute, w^T (dJ/dz_i) v for all i is w^T
times one difference of J along v: a step costs as many runs for thirty coordinates as for one.
J is that of the variational equations; derivatives of J, and those by p and q, are central
differences and steer Newton's method alone. Of a grazing g is how far the nearest extreme of x
lies from an edge of the backlash, with the sign of whether the contacts are still those where a
search began; it is bracketed along the branch of orbits, without Newton's method. Where two
grazings cross, the phase of the extreme tells them apart.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermogear.analysis.bifurcations import FLIP, GRAZING, PITCHFORK, TORUS, Bifurcation
from thermogear.analysis.curve import Curve, Family, Point
from thermogear.analysis.nearby import zero_near
from thermogear.analysis.orbits import multipliers
from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.dynamics.return_map import is_moved, return_map

Sheet = Callable[[float, float], object]
"""(p, q) -> model."""

APART = {True: 1e-5, False: 1e-4}
"""Scaled step of the differences: of one mass, and of maps that carry more rounding."""
CLOSED = {True: 1e-12, False: 1e-10}
"""A residual at which Newton's method ends, as :data:`APART`."""
ROUNDING = 1e-8
"""A residual that no longer falls is rounding below this."""
MOST_STEPS = 10
SLOW = 0.5
"""A residual that falls less in a step asks for fresh derivatives."""
SAMPLES, PHASE = 128, 0.05
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
    touch: tuple[float, float] = (np.nan, np.nan)
    """Of a grazing the phase [mesh periods] of the extreme that touches, and x there [b]."""


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
        self.apart, self.closed = APART[one_mass], CLOSED[one_mass]
        self.root = -1.0 if self.kind in (FLIP, PITCHFORK) else 1.0
        self.mu = complex(self.root)
        if self.kind == TORUS:
            given = bifurcation.multipliers
            off = np.where(np.abs(given.imag) > 1e-9, np.abs(np.abs(given) - 1.0), np.inf)
            mu = complex(given[int(off.argmin())])
            self.mu = complex(mu.real, abs(mu.imag))
        self.borders: tuple[Floats, Floats] | None = None
        self.touch = (np.nan, np.nan)

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
        return np.append(gap, self.vectors(jacobian)[0]), jacobian

    def matrix(self, scaled: Floats, *, jacobian: Floats) -> Floats:
        """d(G, g)/d(z, p, q), (d + 1, d + 2)."""
        d = len(jacobian)
        found = np.zeros((d + 1, d + 2))
        found[:d, :d] = jacobian - np.eye(d)
        _, v, w = self.vectors(jacobian)
        for factor, along in ((1.0, np.real(v)), (1j, np.imag(v))):
            size = float(np.linalg.norm(along))
            if size > 0.0:
                _, change = self._apart(scaled, np.append(along / size, [0.0, 0.0]))
                found[d, :d] += size * (factor * (w @ change)).real
        for column in (d, d + 1):
            gap, change = self._apart(scaled, np.eye(d + 2)[column])
            found[:d, column] = gap
            found[d, column] = (w @ change @ v).real
        return found

    def _apart(self, scaled: Floats, along: Floats) -> tuple[Floats, Floats]:
        """Derivatives of G and J along a direction, one-sided at a parameter's border."""
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                parts = [
                    (weight, self.closing(scaled + k * self.apart * along))
                    for k, weight in weights.items()
                ]
            except InputError:
                continue
            gap = sum(weight * one[0] for weight, one in parts)
            change = sum(weight * one[1] for weight, one in parts)
            return np.asarray(gap / self.apart), np.asarray(change / self.apart)
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
        None of a grazing, which is searched for.
        """
        if self.kind == GRAZING:
            return None
        scaled, own = guess.copy(), None if matrix is None else matrix.copy()
        best: tuple[float, Floats, Floats] | None = None
        last, stalled = np.inf, 0
        step, before = np.zeros(guess.size), np.zeros(guess.size - 1)
        for _ in range(MOST_STEPS):
            rest, jacobian = self.residual(scaled)
            size = float(np.max(np.abs(rest)))
            if not np.isfinite(size):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian), 0
            else:
                stalled += 1
            if size <= self.closed or (stalled and best[0] < 0.1 * ROUNDING) or stalled > 2:
                break
            if own is None or size > SLOW * last:
                own = self.matrix(scaled, jacobian=jacobian)
            elif step.any():
                own = own + np.outer(rest - before - own @ step, step) / (step @ step)
            own[:-1, :-2] = jacobian - np.eye(len(jacobian))
            last, before = size, rest
            whole = np.vstack([own, normal])
            try:
                step = np.linalg.solve(whole, np.append(-rest, -normal @ (scaled - guess)))
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        return self._located(*best[1:], direction=direction)

    def _located(
        self, scaled: Floats, jacobian: Floats, *, direction: Floats | None
    ) -> Located | None:
        """The point with its derivatives; None where they are no numbers."""
        own = self.matrix(scaled, jacobian=jacobian)
        if not np.all(np.isfinite(own)):
            return None
        tangent = np.linalg.svd(own)[2][-1]
        if direction is not None and tangent @ direction < 0.0:
            tangent = -tangent
        return Located(
            scaled=scaled,
            matrix=own,
            tangent=tangent,
            jacobian=jacobian,
            multipliers=self.orbit_multipliers(scaled, jacobian=jacobian),
        )

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

        begun: list[tuple[int, int]] = []

        def measured(point: Point) -> float:
            if self.kind == GRAZING:
                begun.append(point.contacts)
                size = min(max(point.margin, 1e-300), 1.0)
                return size if point.contacts == begun[0] else -size
            gap, jacobian, _ = curve.residual(point.scaled)
            return self.vectors(self._scaled(jacobian))[0] if np.isfinite(gap).all() else np.nan

        start = np.append(guess[:-2], path.start / path.span)
        found = zero_near(curve, measured, start, farthest=farthest, first=path.first)
        if found is None or not abs(measured(found)) < LEAP:
            return None
        scaled = whole(found)
        jacobian = self.closing(scaled)[1]
        if self.kind != GRAZING:
            return self._located(scaled, jacobian, direction=direction)
        touch = self._touch(scaled)
        apart = np.abs((touch[0] - self.touch[0] + 0.5) % 1.0 - 0.5)
        if apart > PHASE or touch[1] * self.touch[1] < 0.0:
            return None  # another extreme that touches nearby
        return Located(
            scaled=scaled, matrix=np.zeros((0, scaled.size)), tangent=direction, touch=touch,
            jacobian=jacobian, multipliers=self.orbit_multipliers(scaled, jacobian=jacobian),
        )  # fmt: skip

    def _touch(self, scaled: Floats) -> tuple[float, float]:
        """Phase of the orbit's extreme nearest to an edge of the backlash, and x there."""
        value = scaled * self.whole
        section = return_map(self.sheet(float(value[-2]), float(value[-1])), SAMPLES)
        period = self.bifurcation.period
        x = section.visit(value[:-2], period, sampled=True).samples[:, 0] / section.unit[0]
        turns = (x - np.roll(x, 1)) * (np.roll(x, -1) - x) <= 0.0
        place = int(np.argmin(np.where(turns, np.abs(np.abs(x) - 1.0), np.inf)))
        return place / SAMPLES / period, float(x[place])

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
        self.border(point.jacobian)
        self.touch = point.touch
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
