"""Continuation of periodic orbits in one parameter: folds, flips, grazing, branch switching."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from thermogear.analysis.orbits import Orbit, closed, multipliers, shoot
from thermogear.analysis.section import ReturnMap, Visit, lanes_of, scales
from thermogear.base.errors import ConvergenceError, InputError, nearest

Floats = NDArray[np.float64]
Family = Callable[[float], object]

FOLD = "fold"
FLIP = "period doubling"
GRAZING = "grazing"
BIRTH = "period halving"
SHRUNK = "the orbit shrank into one of half its period"

NEWTON_TOLERANCE = 1e-14
LONGEST_STEP = 0.05
SHORTEST_STEP = 1e-7


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


@dataclass(frozen=True)
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


@dataclass(frozen=True)
class Branch:
    """A branch of periodic orbits, stable and unstable, in the order it was walked.

    ``values`` of the parameter, ``states`` (point, 2), ``multipliers`` (point, 2),
    ``contact_losses`` and ``back_impacts`` per orbit, ``bifurcations`` in order, ``ended``: why.
    """

    parameter: str
    period: int
    family: Family = field(repr=False)
    values: Floats
    states: Floats
    multipliers: NDArray[np.complex128]
    contact_losses: NDArray[np.int64]
    back_impacts: NDArray[np.int64]
    bifurcations: tuple[Bifurcation, ...]
    ended: str

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Which points are stable."""
        return np.asarray(np.max(np.abs(self.multipliers), axis=1) < 1.0)

    def of_kind(self, kind: str) -> tuple[Bifurcation, ...]:
        """The bifurcations of one kind."""
        return tuple(b for b in self.bifurcations if b.kind == kind)

    def orbit(self, index: int) -> Orbit:
        """The orbit at one point."""
        model = self.family(float(self.values[index]))
        return closed(ReturnMap(lanes_of(model)), self.states[index], self.period, model=model)


class _Curve:
    """G(z, p) = P^n(z; p) - z in coordinates scaled by b, 2 pi b/T and the parameter's range."""

    def __init__(
        self, family: Family, parameter: str, period: int, start: float, span: float
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

    def derivative(self, scaled: Floats, visit: Visit) -> Floats:
        """D G (2, 3); the parameter by central differences of the map."""
        out = np.empty((2, 3))
        two = self.unit[:2]
        out[:, :2] = visit.jacobian / two[:, None] * two - np.eye(2)
        small = 1e-6
        ends = []
        for sign in (1.0, -1.0):
            moved = scaled.copy()
            moved[2] += sign * small
            ends.append(self.residual(moved)[0])
        out[:, 2] = (ends[0] - ends[1]) / (2.0 * small)
        return out

    def correct(
        self, guess: Floats, normal: Floats, old: Floats | None = None, reach: float = np.inf
    ) -> Point | None:
        """Newton onto the curve inside the plane through ``guess`` normal to ``normal``."""
        scaled = guess.copy()
        gap, visit = self.residual(scaled)
        matrix = np.empty((3, 3))
        matrix[2] = normal
        best = np.inf
        for count in range(12):
            size = float(np.max(np.abs(gap)))
            if not np.isfinite(size):
                return None
            if count == 0 or size > NEWTON_TOLERANCE:
                matrix[:2] = self.derivative(scaled, visit)
            if size <= NEWTON_TOLERANCE or (size >= best and best < 1e-10):
                break
            best = min(best, size)
            try:
                step = np.linalg.solve(matrix, [-gap[0], -gap[1], -normal @ (scaled - guess)])
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if float(np.linalg.norm(scaled - guess)) > reach:
                return None
            gap, visit = self.residual(scaled)
        else:
            return None
        null = np.linalg.svd(matrix[:2])[2][2]
        direction = normal if old is None else old
        if null @ direction < 0.0:
            null = -null
        value = float(scaled[2] * self.unit[2])
        lanes = lanes_of(self.family(value))
        determinant = float(np.exp(-lanes.damping[0] * lanes.period[0] * self.period))
        return Point(scaled, null, visit, determinant)

    def orbit(self, point: Point) -> Orbit:
        value = point.scaled * self.unit
        model = self.family(float(value[2]))
        return closed(ReturnMap(lanes_of(model)), value[:2], self.period, model=model)

    def between(self, a: Point, step: float) -> Point:
        """The point a distance ``step`` along the tangent of ``a``."""
        if step == 0.0:
            return a
        point = self.correct(a.scaled + step * a.tangent, a.tangent)
        if point is None:
            raise ConvergenceError(
                f"continuation in {self.parameter}: no orbit between two orbits of the branch "
                f"near {float(a.scaled[2] * self.span)!r}"
            )
        return point


def family_of(model: object, parameter: str) -> tuple[Family, float]:
    """value -> model with the field ``parameter`` changed, and its present value."""
    if not is_dataclass(model) or isinstance(model, type):
        raise InputError("model", type(model).__name__, allowed="a model with named fields")
    known = [
        f.name
        for f in fields(model)
        if isinstance(getattr(model, f.name), float | int) and np.ndim(getattr(model, f.name)) == 0
    ]
    if parameter not in known:
        raise InputError("parameter", repr(parameter), fix=nearest(str(parameter), known))
    base: Any = model

    def family(value: float) -> object:
        return replace(base, **{parameter: value})

    return family, float(getattr(model, parameter))


def continuation(
    orbit: Orbit,
    parameter: str,
    to: float,
    *,
    family: Family | None = None,
    start: float | None = None,
    most_points: int = 2000,
    stop_at: str | None = None,
    direction: Floats | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Branch:
    """Walk the branch of ``orbit`` in ``parameter`` until it reaches ``to``.

    Pseudo-arclength continuation of stable and unstable orbits alike, around folds; it ends at
    ``to``, or where the branch leaves the range on the side it came from, shrinks into an orbit
    of half its period, or after ``most_points``. On the way folds (multiplier +1), period
    doublings (-1) and grazing (an extremum touches an edge of the backlash) are located.

    ``parameter`` is a number field of the orbit's model; for anything else (rpm, temperature)
    give ``family``, a function value -> model, and its present value ``start``. ``stop_at`` a
    kind of bifurcation to stop at. ``progress`` is called with the points so far and the
    parameter.

    Raises InputError for an unknown parameter or ``to`` equal to the present value,
    ConvergenceError when the first orbit is none.
    """
    if family is None:
        family, start = family_of(orbit.model, parameter)
    if start is None:
        raise InputError("start", None, why="a family of models needs the present value")
    if not np.isfinite(to) or to == start:
        raise InputError("to", to, allowed=f"a finite number other than {start}")
    span = abs(to - start)
    curve = _Curve(family, parameter, orbit.period, start, span)
    guess = np.append(orbit.state, start) / curve.unit
    heading = np.array([0.0, 0.0, float(np.sign(to - start))])
    if direction is None:
        first = curve.correct(guess, heading)
    else:
        toward = np.asarray(direction, dtype=float)
        first = curve.correct(guess, toward, toward)
    if first is None:
        raise ConvergenceError(f"continuation in {parameter}: the first orbit does not close")
    points = [first]
    found: list[Bifurcation] = []
    ended = f"{most_points} points"
    for point in _walk(curve, first, start, to, most_points):
        if isinstance(point, str):
            ended = point
            break
        if _halved(curve, point):
            # the corrector slid onto the mother orbit walked twice: end where they meet
            found.append(_birth(curve, points[-1], point))
            ended = SHRUNK
            break
        fresh = _events(curve, points[-1], point)
        found += fresh
        points.append(point)
        if progress is not None:
            progress(len(points), float(point.scaled[2] * span))
        if stop_at is not None and any(b.kind == stop_at for b in fresh):
            ended = f"stopped at a {stop_at}"
            break
    scaled = np.array([p.scaled for p in points])
    return Branch(
        parameter,
        orbit.period,
        family,
        scaled[:, 2] * span,
        scaled[:, :2] * curve.unit[:2],
        np.array([multipliers(p.visit.jacobian, p.determinant) for p in points]),
        np.array([p.contacts[0] for p in points]),
        np.array([p.contacts[1] for p in points]),
        tuple(found),
        ended,
    )


def _walk(curve: _Curve, first: Point, start: float, to: float, most: int) -> Iterator[Point | str]:
    """Points of the branch, then the reason for its end."""
    here = first
    side = np.sign(to - start)
    step = 0.01
    low, high = sorted((start / curve.span, to / curve.span))
    for _ in range(most):
        while True:
            guess = here.scaled + step * here.tangent
            point = None
            try:
                point = curve.correct(guess, here.tangent, here.tangent, 0.5 * step)
            except InputError:
                point = None  # the step left the parameter's range
            if point is not None and point.tangent @ here.tangent > 0.9:
                break
            step *= 0.5
            if step < SHORTEST_STEP:
                yield "no further orbit within the shortest step"
                return
        turn = float(point.tangent @ here.tangent)
        value = float(point.scaled[2])
        if not low <= value <= high:
            inside = _land(curve, here, point, low if value < low else high)
            if inside is not None:
                yield inside
            out = (value > high) == (side > 0)
            yield "reached the end" if out else "left the range where it began"
            return
        yield point
        here = point
        if turn > 0.98:
            step = min(LONGEST_STEP, 1.5 * step)
        elif turn < 0.95:
            step *= 0.7


def _land(curve: _Curve, a: Point, b: Point, value: float) -> Point | None:
    """The orbit exactly at the border value of the parameter."""
    weight = (value - a.scaled[2]) / (b.scaled[2] - a.scaled[2])
    guess = a.scaled + weight * (b.scaled - a.scaled)
    guess[2] = value
    return curve.correct(guess, np.array([0.0, 0.0, 1.0]), a.tangent)


def _events(curve: _Curve, a: Point, b: Point) -> list[Bifurcation]:
    """Bifurcations between two neighbouring points, in the order of the walk."""
    length = float((b.scaled - a.scaled) @ a.tangent)
    events: list[tuple[float, Bifurcation]] = []

    def locate(name: str) -> float:
        return float(
            brentq(
                lambda s: getattr(curve.between(a, s), name),
                0.0,
                length,
                xtol=1e-14,
                rtol=8.9e-16,
            )
        )

    def at(step: float, kind: str, note: str = "") -> None:
        orbit = curve.orbit(curve.between(a, step))
        value = float(curve.between(a, step).scaled[2] * curve.span)
        events.append((step, Bifurcation(kind, curve.parameter, value, orbit, note)))

    if a.fold * b.fold < 0.0:
        at(locate("fold"), FOLD)
    if a.flip * b.flip < 0.0:
        at(locate("flip"), FLIP)
    if a.contacts != b.contacts:
        low, high = 0.0, length
        before, after = a.contacts, b.contacts
        while high - low > 1e-13:
            middle = 0.5 * (low + high)
            seen = curve.between(a, middle).contacts
            if seen == before:
                low = middle
            else:
                high, after = middle, seen
            if middle in (low, high) and high - low <= np.spacing(high):
                break
        at(0.5 * (low + high), GRAZING, _grazed(before, after))
    return [event for _, event in sorted(events, key=lambda pair: pair[0])]


def _halved(curve: _Curve, point: Point) -> bool:
    """Whether the orbit closes after half its period already."""
    if curve.period % 2:
        return False
    points = point.visit.points
    gap = (points[curve.period // 2] - points[0]) / curve.unit[:2]
    return bool(np.max(np.abs(gap)) < 1e-9)


def _birth(curve: _Curve, a: Point, b: Point) -> Bifurcation:
    """The flip of the mother orbit between a doubled orbit ``a`` and ``b`` on the mother."""
    half = curve.period // 2

    def mother(value: float) -> Orbit:
        model = curve.family(value)
        weight = (value / curve.span - b.scaled[2]) / (a.scaled[2] - b.scaled[2])
        centre = 0.5 * (a.visit.points[0] + a.visit.points[half])
        guess = b.visit.points[0] + weight * (centre - b.visit.points[0])
        orbit = shoot(ReturnMap(lanes_of(model)), guess, half, model=model)
        if orbit is None:
            raise ConvergenceError(
                f"continuation in {curve.parameter}: no orbit of period {half} at {value!r}, "
                f"where one of period {curve.period} ends"
            )
        return orbit

    def flip(value: float) -> float:
        orbit = mother(value)
        return float(1.0 + np.trace(orbit.jacobian) + orbit.determinant)

    ends = [float(p.scaled[2] * curve.span) for p in (a, b)]
    value = float(brentq(flip, *ends, xtol=1e-14)) if flip(ends[0]) * flip(ends[1]) < 0 else ends[1]
    return Bifurcation(BIRTH, curve.parameter, value, mother(value))


def _grazed(before: tuple[int, int], after: tuple[int, int]) -> str:
    parts = []
    for name, old, new in zip(("contact losses", "back-side impacts"), before, after, strict=True):
        if old != new:
            parts.append(f"{name} per orbit {old} -> {new}")
    return ", ".join(parts)


@dataclass(frozen=True)
class Doubled:
    """An orbit of twice the period beside a flip: its parameter ``value``, scaled ``direction``."""

    orbit: Orbit
    value: float
    direction: Floats


def switch_branch(bifurcation: Bifurcation, family: Family | None = None) -> Doubled:
    """An orbit of twice the period beside a flip, and the direction away from it.

    The doubled orbit starts along the eigenvector of the multiplier -1; hand its parts to
    :func:`continuation` as ``orbit``, ``start`` (with a ``family``) and ``direction``.
    """
    if bifurcation.kind != FLIP:
        raise InputError("bifurcation", bifurcation.kind, allowed=FLIP)
    orbit = bifurcation.orbit
    if family is None:
        family, _ = family_of(orbit.model, bifurcation.parameter)
    value = bifurcation.value
    span = max(abs(value), 1e-3)
    curve = _Curve(family, bifurcation.parameter, 2 * orbit.period, value, span)
    two = curve.unit[:2]
    matrix = orbit.jacobian / two[:, None] * two
    direction = np.linalg.svd(matrix + np.eye(2))[2][1]
    normal = np.append(direction, 0.0)
    centre = np.append(orbit.state, value) / curve.unit
    for amplitude in (1e-3, 3e-4, 3e-3, 1e-4, 1e-2):
        point = curve.correct(centre + amplitude * normal, normal, normal, 10.0 * amplitude)
        if point is not None:
            value = float(point.scaled[2] * curve.unit[2])
            return Doubled(curve.orbit(point), value, normal)
    raise ConvergenceError(
        f"no orbit of period {2 * orbit.period} found beside the flip at "
        f"{bifurcation.parameter} = {value!r}"
    )


@dataclass(frozen=True)
class Cascade:
    """Successive period doublings of one branch: ``flips`` and the branches walked."""

    parameter: str
    flips: tuple[Bifurcation, ...]
    branches: tuple[Branch, ...]

    @property
    def ratios(self) -> Floats:
        """(p_k - p_k-1)/(p_k+1 - p_k); they tend to Feigenbaum's 4.669."""
        gaps = np.diff([b.value for b in self.flips])
        return np.asarray(gaps[:-1] / gaps[1:])


def cascade(
    orbit: Orbit,
    parameter: str,
    to: float,
    *,
    flips: int = 4,
    family: Family | None = None,
    start: float | None = None,
    progress: Callable[[int, float], None] | None = None,
) -> Cascade:
    """Follow ``orbit`` to its first period doubling, switch, and so on ``flips`` times.

    Arguments as in :func:`continuation`; fewer flips come back when a branch reaches ``to``
    (or ends) without one.
    """
    branch = continuation(
        orbit, parameter, to, family=family, start=start, stop_at=FLIP, progress=progress
    )
    branches = [branch]
    found: list[Bifurcation] = []
    while branch.of_kind(FLIP):
        flip = branch.of_kind(FLIP)[0]
        found.append(flip)
        if len(found) == flips:
            break
        doubled = switch_branch(flip, branch.family)
        branch = continuation(
            doubled.orbit,
            parameter,
            to,
            family=branch.family,
            start=doubled.value,
            stop_at=FLIP,
            direction=doubled.direction,
            progress=progress,
        )
        branches.append(branch)
    return Cascade(parameter, tuple(found), tuple(branches))
