"""Points of a branch of periodic orbits, and where between two of them it bifurcates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, root_scalar

from thermogear.analysis.orbits import Orbit, closed, shoot
from thermogear.analysis.section import ReturnMap, Visit, lanes_of, scales
from thermogear.base.errors import ConvergenceError

Floats = NDArray[np.float64]
Family = Callable[[float], object]

FOLD = "fold"
FLIP = "period doubling"
GRAZING = "grazing"
BIRTH = "period halving"

NEWTON_TOLERANCE = 1e-14
LONGEST_STEP = 0.05


@dataclass(frozen=True)
class Bifurcation:
    """Where a branch changes: ``kind`` fold, period doubling, grazing or period halving.

    ``parameter`` and its ``value``, the ``orbit`` there; ``note`` says what a grazing begins
    or ends.
    """

    kind: str
    parameter: str
    value: float
    orbit: Orbit
    note: str = ""

    @property
    def period(self) -> int:
        """Mesh periods of the orbit that bifurcates."""
        return self.orbit.period

    @property
    def state(self) -> Floats:
        """(x, x') of the orbit at phase 0."""
        return self.orbit.state

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers of the orbit."""
        return self.orbit.multipliers


@dataclass(frozen=True, kw_only=True)
class Point:
    """A converged point of a branch in scaled coordinates, with its tangent."""

    scaled: Floats
    tangent: Floats
    visit: Visit
    determinant: float

    @property
    def trace(self) -> float:
        return float(self.visit.jacobian[0, 0] + self.visit.jacobian[1, 1])

    @property
    def fold(self) -> float:
        """(1 - mu_1)(1 - mu_2)."""
        return 1.0 - self.trace + self.determinant

    @property
    def flip(self) -> float:
        """(1 + mu_1)(1 + mu_2)."""
        return 1.0 + self.trace + self.determinant

    @property
    def contacts(self) -> tuple[int, int]:
        return self.visit.contact_losses, self.visit.back_impacts


class Curve:
    """G(z, p) = P^n(z; p) - z in coordinates scaled by b, 2 pi b/T and the parameter's range."""

    def __init__(
        self, family: Family, parameter: str, period: int, *, start: float, span: float
    ) -> None:
        self.family = family
        self.parameter = parameter
        self.period = period
        self.span = span
        self.unit = np.append(scales(lanes_of(family(start))), span)

    def map_at(self, value: float) -> ReturnMap:
        return ReturnMap(lanes_of(self.family(value)))

    def residual(self, scaled: Floats) -> tuple[Floats, Visit]:
        value = scaled * self.unit
        visit = self.map_at(float(value[2])).visit(value[:2], self.period)
        return (visit.points[-1] - visit.points[0]) / self.unit[:2], visit

    def in_parameter(self, scaled: Floats) -> Floats:
        """dG/dp (2,) by central differences of the map."""
        small = 1e-6
        ends = []
        for sign in (1.0, -1.0):
            moved = scaled.copy()
            moved[2] += sign * small
            ends.append(self.residual(moved)[0])
        return np.asarray((ends[0] - ends[1]) / (2.0 * small))

    def correct(
        self,
        guess: Floats,
        *,
        normal: Floats,
        old: Floats | None = None,
        reach: float = np.inf,
        tangent: bool = True,
    ) -> Point | None:
        """Newton onto the curve inside the plane through ``guess`` normal to ``normal``.

        The point's tangent is exact with ``tangent``, else good enough for nothing but its sign.
        """
        scaled = guess.copy()
        gap, visit = self.residual(scaled)
        matrix = np.empty((3, 3))
        matrix[2] = normal
        best = np.inf
        last = np.inf
        for count in range(12):
            size = float(np.max(np.abs(gap)))
            if not np.isfinite(size):
                return None
            two = self.unit[:2]
            matrix[:2, :2] = visit.jacobian / two[:, None] * two - np.eye(2)
            if count == 0 or (size > 0.01 * last and size > 1e-11):
                # dear, and near enough from the last time while Newton falls fast
                matrix[:2, 2] = self.in_parameter(scaled)
            last = size
            if size <= NEWTON_TOLERANCE or (size >= best and best < 1e-10):
                break
            best = min(best, size)
            try:
                step = np.linalg.solve(matrix, [-gap[0], -gap[1], -normal @ (scaled - guess)])
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
            gap, visit = self.residual(scaled)
        else:
            return None
        if tangent:
            matrix[:2, 2] = self.in_parameter(scaled)
        if not np.all(np.isfinite(matrix)):
            return None
        null = np.linalg.svd(matrix[:2])[2][2]
        direction = normal if old is None else old
        if null @ direction < 0.0:
            null = -null
        value = float(scaled[2] * self.unit[2])
        lanes = lanes_of(self.family(value))
        determinant = float(np.exp(-lanes.damping[0] * lanes.period[0] * self.period))
        return Point(scaled=scaled, tangent=null, visit=visit, determinant=determinant)

    def orbit(self, point: Point) -> Orbit:
        value = point.scaled * self.unit
        model = self.family(float(value[2]))
        return closed(ReturnMap(lanes_of(model)), value[:2], self.period, model=model)

    def zero(self, a: Point, name: str, *, low: float, high: float) -> float:
        """Where the test function ``name`` vanishes between two distances from ``a``."""
        return float(
            brentq(
                lambda step: getattr(self.between(a, step), name),
                low,
                high,
                xtol=1e-14,
                rtol=8.9e-16,
            )
        )

    def between(self, a: Point, step: float) -> Point:
        """The point a distance ``step`` along the tangent of ``a``."""
        if step == 0.0:
            return a
        point = self.correct(a.scaled + step * a.tangent, normal=a.tangent, tangent=False)
        if point is None:
            raise ConvergenceError(
                f"continuation in {self.parameter}: no orbit between two orbits of the branch "
                f"near {float(a.scaled[2] * self.span)!r}"
            )
        return point


def locate(curve: Curve, a: Point, b: Point) -> list[Bifurcation]:
    """Bifurcations between two neighbouring points, in the order of the walk."""
    length = float((b.scaled - a.scaled) @ a.tangent)
    events: list[tuple[float, Bifurcation]] = []

    def at(step: float, kind: str, note: str = "") -> None:
        point = curve.between(a, step)
        value = float(point.scaled[2] * curve.span)
        events.append((step, Bifurcation(kind, curve.parameter, value, curve.orbit(point), note)))

    nodes = {0.0: a, length: b}
    start = 0.0
    while nodes[start].contacts != b.contacts:
        low, high = start, length
        before = nodes[start].contacts
        while high - low > 1e-13:
            middle = 0.5 * (low + high)
            if curve.between(a, middle).contacts == before:
                low = middle
            else:
                high = middle
        nodes[high] = curve.between(a, high)
        at(high, GRAZING, _grazed(before, nodes[high].contacts))
        # multipliers turn sharply where contact changes: folds come in pairs close by
        for near in (1e-5, 1e-4, 1e-3):
            for step in (high - near, high + near):
                if 0.0 < step < length:
                    nodes[step] = curve.between(a, step)
        if high == start:
            break
        start = high
    ends = sorted(nodes)
    for low, high in pairwise(ends):
        for name, kind in (("fold", FOLD), ("flip", FLIP)):
            if getattr(nodes[low], name) * getattr(nodes[high], name) < 0.0:
                at(curve.zero(a, name, low=low, high=high), kind)
    return [event for _, event in sorted(events, key=lambda pair: pair[0])]


def half_shift(curve: Curve, point: Point) -> Floats:
    """How far the orbit stands from itself half its period later, scaled (0: it closes there)."""
    points = point.visit.points
    return np.asarray((points[curve.period // 2] - points[0]) / curve.unit[:2])


def closes_at_half(curve: Curve, point: Point) -> bool:
    """Whether the orbit closes after half its period already."""
    return curve.period % 2 == 0 and float(np.max(np.abs(half_shift(curve, point)))) < 1e-9


def passed_mother(curve: Curve, a: Point, b: Point) -> bool:
    """Whether a doubled branch went through its mother orbit and on as its own half shift."""
    if curve.period % 2:
        return False
    return closes_at_half(curve, b) or float(half_shift(curve, a) @ half_shift(curve, b)) < 0.0


def birth_of(curve: Curve, a: Point) -> Bifurcation | None:
    """The flip of the mother orbit near the doubled orbit ``a``; None when not found."""
    half = curve.period // 2
    centre = 0.5 * (a.visit.points[0] + a.visit.points[half])

    def mother(value: float) -> Orbit | None:
        if not np.isfinite(value):
            return None
        model = curve.family(value)
        return shoot(ReturnMap(lanes_of(model)), centre, half, model=model)

    def flip(value: float) -> float:
        orbit = mother(value)
        return (
            np.nan if orbit is None else float(1.0 + np.trace(orbit.jacobian) + orbit.determinant)
        )

    start = float(a.scaled[2] * curve.span)
    found = root_scalar(flip, method="secant", x0=start, x1=start + 1e-4 * curve.span, xtol=1e-13)
    if not found.converged or not abs(found.root - start) < LONGEST_STEP * curve.span:
        return None
    orbit = mother(float(found.root))
    if orbit is None:
        return None
    return Bifurcation(BIRTH, curve.parameter, float(found.root), orbit)


def _grazed(before: tuple[int, int], after: tuple[int, int]) -> str:
    parts = []
    for name, old, new in zip(("contact losses", "back-side impacts"), before, after, strict=True):
        if old != new:
            parts.append(f"{name} per orbit {old} -> {new}")
    return ", ".join(parts)
