"""Continuation of periodic orbits in one parameter: branches, branch switching, cascades.

Predictor and corrector along the arc of the branch (pseudo-arclength continuation): a step goes
ahead by the tangent and the bend of the last step, Newton's method brings it back onto the branch
across the tangent. The arc, not the parameter, is stepped, so that the walk goes round a fold. A
step is halved where the corrector fails, turns too far or lands on a neighbouring branch, and
grows where the branch is nearly straight. A step costs a few runs of the orbit's period with its
variational equations. A branch ends in a gap where no step as short as SHORTEST_STEP succeeds;
islands without a connection to the first orbit are not seen.
Checked by ``tests/analysis/test_continuation.py`` (closed forms, independent folds and doublings),
and by ``trials/branches.py`` against a walker in steps ten times as short.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import (
    BIRTH,
    FLIP,
    LONGEST_STEP,
    PITCHFORK,
    Bifurcation,
    birth_of,
    crossed,
    doubled_beside,
    locate,
    looked_closer,
    passed_mother,
)
from thermogear.analysis.curve import Curve, Family, Point, mirrored
from thermogear.analysis.orbits import Orbit, closed, multipliers
from thermogear.analysis.section import lanes_of
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError, nearest
from thermogear.dynamics.return_map import return_map

SHRUNK = {
    BIRTH: "the orbit shrank into one of half its period",
    PITCHFORK: "the orbit became its own mirror image",
}
GAP = "a gap"
REACHED = "reached the end"
LEFT = "left the range where it began"
FLOATS = "the orbit floats in the gap without touching a tooth: any shift of it is one too"
SHORTEST_STEP = 1e-7
LARGE = 5.0
"""Beyond so many half backlashes steps grow with the orbit, though not in the parameter."""
STRAIGHT = 1e-4
"""Steps shorter than this are believed whatever their chord says."""
ASTRAY = 0.1
"""Radians by which a chord may leave the angle between the tangents of its ends."""


@dataclass(frozen=True, kw_only=True)
class Branch:
    """A branch of periodic orbits, stable and unstable, in the order it was walked.

    ``values`` of the parameter, ``states`` (point, d), ``multipliers`` (point, d),
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

    def dataset(self) -> xr.Dataset:
        """The branch over ``point``, its bifurcations over ``event``."""
        events = self.bifurcations
        text = {"long_name": "kind of bifurcation"}
        return xr.Dataset(
            {
                "value": ("point", self.values, {"long_name": self.parameter}),
                **self._sections(),
                "multiplier_real": (
                    ("point", "multiplier"),
                    self.multipliers.real,
                    {"long_name": "Floquet multiplier, real part", "units": "1"},
                ),
                "multiplier_imag": (
                    ("point", "multiplier"),
                    self.multipliers.imag,
                    {"long_name": "Floquet multiplier, imaginary part", "units": "1"},
                ),
                "stable": ("point", self.stable, {"long_name": "all multipliers below 1"}),
                "contact_losses": ("point", self.contact_losses, {"units": "1"}),
                "back_impacts": ("point", self.back_impacts, {"units": "1"}),
                "event_kind": ("event", [e.kind for e in events], text),
                "event_value": ("event", [e.value for e in events], {"long_name": self.parameter}),
                "event_note": ("event", [e.note for e in events]),
            },
            attrs={"parameter": self.parameter, "period": self.period, "ended": self.ended},
        )

    def _sections(self) -> dict[str, Any]:
        if self.states.shape[1] != 2:
            text = {"long_name": "state at phase 0"}
            return {"section": (("point", "coordinate"), self.states, text)}
        return {
            "section_x": ("point", self.states[:, 0], {"long_name": "displacement at phase 0"}),
            "section_v": ("point", self.states[:, 1], {"long_name": "velocity at phase 0"}),
        }

    def of_kind(self, kind: str) -> tuple[Bifurcation, ...]:
        """The bifurcations of one kind."""
        return tuple(b for b in self.bifurcations if b.kind == kind)

    def orbit(self, index: int) -> Orbit:
        """The orbit at one point."""
        model = self.family(float(self.values[index]))
        return closed(return_map(model), self.states[index], self.period, model=model)


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
    back_to: float | None = None,
    span: float | None = None,
    most_points: int = 2000,
    stop_at: str | Collection[str] | None = None,
    direction: Floats | None = None,
    progress: Callable[[int, float], None] | None = None,
    keep_on_interrupt: bool = False,
) -> Branch:
    """Walk the branch of ``orbit`` in ``parameter`` until it reaches ``to``.

    States, parameter and ``to`` are in the model's units: numbers of :class:`TorsionalModel`, else
    SI. Pseudo-arclength continuation of stable and unstable orbits alike, around folds. It ends
    at ``to``, or where the branch leaves the range behind it, shrinks into an orbit of half its
    period, becomes symmetric, or after ``most_points``. On the way folds (multiplier +1), period
    doublings (-1), grazing (an extremum touches an edge of the backlash) and pitchforks (+1
    where a symmetric orbit of a symmetric equation loses it) are located, of states longer than
    (x, x') or of unknown determinant the torus too (a complex pair crosses the unit circle). Where
    no further orbit is found the branch comes back as far as it goes; ``ended`` names the gap.

    ``parameter`` is a number field of the orbit's model; for anything else (rpm, temperature)
    give ``family``, a function value -> model, and its present value ``start``. The range lies
    between ``to`` and ``back_to`` or, where that lies further back, ``start``, so that a doubled
    branch may run back through a fold first. ``span`` of the parameter counts as much as a half
    backlash in the length of a step (default: the whole range). ``stop_at`` a kind of bifurcation
    (or several) to stop at. ``progress`` is called with the points so far and the parameter. With
    ``keep_on_interrupt`` Ctrl+C returns what is done, ``ended`` "interrupted".

    Raises InputError for an unknown parameter or ``to`` equal to the present value,
    ConvergenceError when the first orbit is none.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> branch = continuation(periodic_orbit(model, guess=(1.1, 0.0)), "frequency", 0.52)
    >>> branch.ended, bool(branch.stable.all())
    ('reached the end', True)
    """
    if not (span is None or 0.0 < span < np.inf):
        raise InputError("span", span, allowed="> 0, finite")
    family, start, behind = _range(orbit, parameter, to, family, start, back_to)
    mirrors, symmetric = _symmetry(orbit, family, start, to)
    curve = Curve(
        family, parameter, orbit.period, start=start, mirrors=mirrors, symmetric=symmetric,
        span=abs(to - behind) if span is None else span,
    )  # fmt: skip
    ahead = curve.upright * float(np.sign(to - start))
    heading, step = (ahead, 0.01) if direction is None else (np.asarray(direction, float), 5e-4)
    first = curve.correct(np.append(orbit.state, start) / curve.unit, normal=heading)
    if first is None:
        raise ConvergenceError(f"continuation in {parameter}: the first orbit does not close")
    course = _Course(curve, [first], progress)
    stops = {stop_at} if isinstance(stop_at, str) else set(stop_at or ())
    # a surface of orbits has no direction to go in
    ended = FLOATS if first.floats and not symmetric else ""
    try:
        for point in () if ended else _walk(curve, first, (behind, to), most_points, step):
            ended = point if isinstance(point, str) else course.add(point, stops)
            if ended or len(course.points) > most_points:
                break
    except KeyboardInterrupt:
        if not keep_on_interrupt:
            raise
        ended = "interrupted"
    return course.branch(ended or f"{most_points} points")


def _range(
    orbit: Orbit,
    parameter: str,
    to: float,
    family: Family | None,
    start: float | None,
    back_to: float | None,
) -> tuple[Family, float, float]:
    """The family of models, where its walk starts and how far it may run back; refusals."""
    if family is None:
        family, start = family_of(orbit.model, parameter)
    if start is None:
        raise InputError("start", None, why="a family of models needs the present value")
    if not np.isfinite(start):
        raise InputError("start", start, allowed="finite")
    if not np.isfinite(to) or to == start:
        raise InputError("to", to, allowed=f"a finite number other than {start}")
    behind = start if back_to is None else back_to
    if not np.isfinite(behind):
        raise InputError("back_to", behind, allowed="finite")
    return family, start, start if (behind - start) * (to - start) > 0.0 else behind


@dataclass
class _Course:
    """A walk along ``curve`` so far: its points, and the bifurcations between them."""

    curve: Curve
    points: list[Point]
    progress: Callable[[int, float], None] | None
    found: list[Bifurcation] = field(default_factory=list)

    def add(self, point: Point, stops: Collection[str]) -> str:
        """Go on to ``point``, finely enough; why the branch ends there, "" where it does not."""
        curve, here = self.curve, self.points[-1]
        if point.floats and not curve.symmetric:
            return FLOATS
        mother = passed_mother(curve, here, point)
        if mother:
            birth = birth_of(curve, here, mother)
            self.found += [] if birth is None else [birth]
            return SHRUNK[mother]
        try:
            before = self.points[-2] if len(self.points) > 1 else None
            fine = looked_closer(curve, before, here, point)
            fresh = [b for one, two in pairwise([here, *fine]) for b in locate(curve, one, two)]
        except ConvergenceError as error:
            return f"{GAP}: {error}"
        self.found += fresh
        turned = [k for k, pair in enumerate(pairwise([here, *fine])) if crossed(*pair)]
        if turned:
            self.points += fine[: turned[0]]
            return SHRUNK[PITCHFORK]
        self.points += fine
        if self.progress is not None:
            self.progress(len(self.points), float(point.scaled[-1] * curve.span))
        last = next((b.kind for b in fresh if b.kind in stops), "")
        return f"stopped at a {last}" if last else ""

    def branch(self, ended: str) -> Branch:
        """The course as a branch in units of the model."""
        curve, points = self.curve, self.points
        scaled = np.array([p.scaled for p in points])
        return Branch(
            parameter=curve.parameter,
            period=curve.period,
            family=curve.family,
            values=scaled[:, -1] * curve.span,
            states=scaled[:, :-1] * curve.unit[:-1],
            multipliers=np.array([multipliers(p.visit.jacobian, p.determinant) for p in points]),
            contact_losses=np.array([p.contacts[0] for p in points]),
            back_impacts=np.array([p.contacts[1] for p in points]),
            bifurcations=tuple(self.found),
            ended=ended,
        )


def _symmetry(orbit: Orbit, family: Family, start: float, to: float) -> tuple[bool, bool]:
    """Whether the equation is symmetric all the way, and the orbit its own mirror image."""
    try:
        lanes = [lanes_of(family(start + part * (to - start))) for part in (0.0, 0.37, 1.0)]
    except InputError:
        return False, False
    if not all(mirrored(one, orbit.period) for one in lanes):
        return False, False
    section = lanes[0].return_map()
    end, _ = section.flow(orbit.state, orbit.period)
    return True, float(section.distance(-end, orbit.state)) < 1e-8


def _walk(
    curve: Curve, first: Point, limits: tuple[float, float], most: int, step: float
) -> Iterator[Point | str]:
    """Points of the branch between two ``limits``, the end last; then the reason for its end."""
    here, last = first, first
    behind, to = limits
    side = np.sign(to - behind)
    low, high = sorted((behind / curve.span, to / curve.span))
    for _ in range(most):
        while True:
            guess = here.scaled + step * here.tangent
            near, slope = _ahead(last, here, step)
            try:
                point = curve.correct(
                    guess, normal=here.tangent, old=here.tangent, reach=0.5 * step, near=near,
                    slope=slope,
                )  # fmt: skip
            except InputError:
                # the step left what the parameter may be; the walk's end may lie right there
                point = None
                border = low if guess[-1] < low else high
                if not low <= guess[-1] <= high:
                    inside = _reach(curve, here, border)
                    if inside is not None:
                        yield inside
                        out = (border == high) == (side > 0)
                        yield REACHED if out else LEFT
                        return
            # near its birth a doubled orbit's corrector may slide onto the mother or the
            # half-shifted side: such a step must be short to be believed
            if (
                point is not None
                and point.tangent @ here.tangent > 0.9
                and (step < STRAIGHT or _follows(here, point))
                and (step < 2e-4 or not passed_mother(curve, here, point))
                # a branch that turns and leaves the range in one step shows no fold in it
                and (
                    step < STRAIGHT
                    or low <= point.scaled[-1] <= high
                    or point.tangent[-1] * here.tangent[-1] > 0.0
                )
            ):
                break
            step *= 0.5
            if step < SHORTEST_STEP:
                yield (
                    f"{GAP}: no further orbit within the shortest step beyond "
                    f"{curve.parameter} = {float(here.scaled[-1] * curve.span)!r}"
                )
                return
        turn = float(point.tangent @ here.tangent)
        value = float(point.scaled[-1])
        if not low <= value <= high:
            inside = _land(curve, here, point, low if value < low else high)
            if inside is not None:
                yield inside
            out = (value > high) == (side > 0)
            yield REACHED if out else LEFT
            return
        yield point
        last, here = here, point
        longest = (
            LONGEST_STEP
            * np.sqrt(0.5 * curve.dimension)
            * max(1.0, float(np.max(np.abs(here.scaled[:-1]))) / LARGE)
        )
        if turn > 0.98:
            step = min(longest, LONGEST_STEP / max(abs(here.tangent[-1]), 1e-9), 1.5 * step)
        elif turn < 0.95:
            step *= 0.7


def _ahead(last: Point, here: Point, step: float) -> tuple[Floats, Floats]:
    """A ``step`` on, where the branch bends off its tangent as it did since ``last``; dG/dp."""
    guess = here.scaled + step * here.tangent
    way = float(np.linalg.norm(here.scaled - last.scaled))
    if way == 0.0:
        return guess, here.slope
    bend = 0.5 * step**2 / way * (here.tangent - last.tangent)
    bend -= float(bend @ here.tangent) * here.tangent
    bend *= min(1.0, 0.2 * step / max(float(np.linalg.norm(bend)), 1e-300))
    return guess + bend, here.slope + step / way * (here.slope - last.slope)


def _follows(a: Point, b: Point) -> bool:
    """Whether ``b`` may lie on the branch of ``a``: the chord runs between both tangents.

    A corrector that fell onto a neighbouring branch leaves a chord across two parallel tangents.
    """
    chord = (b.scaled - a.scaled) / np.linalg.norm(b.scaled - a.scaled)
    across = float(np.arccos(np.clip(chord @ a.tangent, -1.0, 1.0)))
    across += float(np.arccos(np.clip(chord @ b.tangent, -1.0, 1.0)))
    return across <= 1.5 * float(np.arccos(np.clip(a.tangent @ b.tangent, -1.0, 1.0))) + ASTRAY


def _reach(curve: Curve, a: Point, value: float) -> Point | None:
    """The orbit at a border value ahead of ``a``, where no step beyond it can be tried."""
    far = (value - a.scaled[-1]) / a.tangent[-1]
    guess = a.scaled + far * a.tangent
    guess[-1] = value
    if far > LONGEST_STEP:
        return None
    found = curve.correct(guess, normal=curve.upright, old=a.tangent, reach=0.5 * max(far, 1e-9))
    return found if found is not None and found.tangent @ a.tangent > 0.9 else None


def _land(curve: Curve, a: Point, b: Point, value: float) -> Point | None:
    """The orbit exactly at the border value of the parameter."""
    weight = (value - a.scaled[-1]) / (b.scaled[-1] - a.scaled[-1])
    guess = a.scaled + weight * (b.scaled - a.scaled)
    guess[-1] = value
    return curve.correct(guess, normal=curve.upright, old=a.tangent)


@dataclass(frozen=True)
class Doubled:
    """An orbit near a flip or pitchfork: its parameter ``value``, scaled ``direction``."""

    orbit: Orbit
    value: float
    direction: Floats


def switch_branch(bifurcation: Bifurcation, family: Family | None = None) -> Doubled:
    """An orbit of twice the period near a flip, and the direction away from it.

    The doubled orbit starts along the eigenvector of the multiplier -1; hand its parts to
    :func:`continuation` as ``orbit``, ``start`` (with a ``family``) and ``direction``. Beside a
    pitchfork: one of the two orbits of the same period that mirror each other.
    """
    if bifurcation.kind not in (FLIP, PITCHFORK):
        raise InputError("bifurcation", bifurcation.kind, allowed=f"{FLIP} | {PITCHFORK}")
    if family is None:
        family, _ = family_of(bifurcation.orbit.model, bifurcation.parameter)
    curve, normal, point = doubled_beside(bifurcation, family)
    return Doubled(curve.orbit(point), float(point.scaled[-1] * curve.span), normal)


@dataclass(frozen=True)
class Cascade:
    """Period doublings of one branch, the branches walked, and why the next was ``lost``, if so."""

    flips: tuple[Bifurcation, ...]
    branches: tuple[Branch, ...]
    lost: str = ""


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

    Arguments as in :func:`continuation`. Where a doubling is subcritical the doubled branch runs
    back first, to a fold, and is followed there, as far back as where the cascade began. Fewer
    flips come back when a branch reaches ``to`` (or ends) without one (the last one's ``ended``).
    """
    branch = continuation(
        orbit, parameter, to, family=family, start=start, stop_at=FLIP, progress=progress
    )
    branches = [branch]
    found: list[Bifurcation] = []
    begin = float(branch.values[0])
    while branch.of_kind(FLIP):
        flip = branch.of_kind(FLIP)[0]
        found.append(flip)
        if len(found) == flips:
            break
        try:
            doubled = switch_branch(flip, branch.family)
            branch = continuation(
                doubled.orbit, parameter, to, family=branch.family, start=doubled.value,
                back_to=begin, stop_at=FLIP, direction=doubled.direction, progress=progress,
            )  # fmt: skip
        except ConvergenceError as error:
            return Cascade(tuple(found), tuple(branches), str(error))
        branches.append(branch)
    return Cascade(tuple(found), tuple(branches))
