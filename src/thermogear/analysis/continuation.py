"""Continuation of periodic orbits in one parameter: branches, branch switching, cascades."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import (
    BIRTH,
    FLIP,
    FOLD,
    GRAZING,
    LONGEST_STEP,
    Bifurcation,
    Curve,
    Family,
    Point,
    birth_of,
    locate,
    passed_mother,
)
from thermogear.analysis.orbits import Orbit, closed, multipliers
from thermogear.analysis.section import ReturnMap, lanes_of
from thermogear.base.errors import ConvergenceError, InputError, nearest

__all__ = [
    "BIRTH",
    "FLIP",
    "FOLD",
    "GRAZING",
    "Bifurcation",
    "Branch",
    "Cascade",
    "Doubled",
    "cascade",
    "continuation",
    "family_of",
    "switch_branch",
]

Floats = NDArray[np.float64]

SHRUNK = "the orbit shrank into one of half its period"
SHORTEST_STEP = 1e-7


@dataclass(frozen=True, kw_only=True)
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

    def dataset(self) -> xr.Dataset:
        """The branch over ``point``, its bifurcations over ``event``."""
        events = self.bifurcations
        text = {"long_name": "kind of bifurcation"}
        return xr.Dataset(
            {
                "value": ("point", self.values, {"long_name": self.parameter}),
                "section_x": ("point", self.states[:, 0], {"long_name": "displacement at phase 0"}),
                "section_v": ("point", self.states[:, 1], {"long_name": "velocity at phase 0"}),
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

    def of_kind(self, kind: str) -> tuple[Bifurcation, ...]:
        """The bifurcations of one kind."""
        return tuple(b for b in self.bifurcations if b.kind == kind)

    def orbit(self, index: int) -> Orbit:
        """The orbit at one point."""
        model = self.family(float(self.values[index]))
        return closed(ReturnMap(lanes_of(model)), self.states[index], self.period, model=model)


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
    keep_on_interrupt: bool = False,
) -> Branch:
    """Walk the branch of ``orbit`` in ``parameter`` until it reaches ``to``.

    States, parameter and ``to`` are in the units of the model: pure numbers for
    :class:`TorsionalModel`, SI for a model in SI. Pseudo-arclength continuation of stable and
    unstable orbits alike, around folds; it ends at ``to``, or where the branch leaves the range
    on the side it came from, shrinks into an orbit of half its period, or after ``most_points``.
    On the way folds (multiplier +1), period doublings (-1) and grazing (an extremum touches an
    edge of the backlash) are located.

    ``parameter`` is a number field of the orbit's model; for anything else (rpm, temperature)
    give ``family``, a function value -> model, and its present value ``start``. ``stop_at`` a
    kind of bifurcation to stop at. ``progress`` is called with the points so far and the
    parameter. With ``keep_on_interrupt`` Ctrl+C returns what is done, ``ended`` "interrupted".

    Raises InputError for an unknown parameter or ``to`` equal to the present value,
    ConvergenceError when the first orbit is none.
    """
    if family is None:
        family, start = family_of(orbit.model, parameter)
    if start is None:
        raise InputError("start", None, why="a family of models needs the present value")
    if not np.isfinite(start):
        raise InputError("start", start, allowed="finite")
    if not np.isfinite(to) or to == start:
        raise InputError("to", to, allowed=f"a finite number other than {start}")
    span = abs(to - start)
    curve = Curve(family, parameter, orbit.period, start=start, span=span)
    guess = np.append(orbit.state, start) / curve.unit
    heading = np.array([0.0, 0.0, float(np.sign(to - start))])
    if direction is None:
        first = curve.correct(guess, normal=heading)
    else:
        toward = np.asarray(direction, dtype=float)
        first = curve.correct(guess, normal=toward, old=toward)
    if first is None:
        raise ConvergenceError(f"continuation in {parameter}: the first orbit does not close")
    points = [first]
    found: list[Bifurcation] = []
    ended = f"{most_points} points"
    try:
        for point in _walk(
            curve, first, start, to, most_points, 0.01 if direction is None else 5e-4
        ):
            if isinstance(point, str):
                ended = point
                break
            if passed_mother(curve, points[-1], point):
                birth = birth_of(curve, points[-1])
                found += [] if birth is None else [birth]
                ended = SHRUNK
                break
            fresh = locate(curve, points[-1], point)
            found += fresh
            points.append(point)
            if progress is not None:
                progress(len(points), float(point.scaled[2] * span))
            if stop_at is not None and any(b.kind == stop_at for b in fresh):
                ended = f"stopped at a {stop_at}"
                break
    except KeyboardInterrupt:
        if not keep_on_interrupt:
            raise
        ended = "interrupted"
    scaled = np.array([p.scaled for p in points])
    return Branch(
        parameter=parameter,
        period=orbit.period,
        family=family,
        values=scaled[:, 2] * span,
        states=scaled[:, :2] * curve.unit[:2],
        multipliers=np.array([multipliers(p.visit.jacobian, p.determinant) for p in points]),
        contact_losses=np.array([p.contacts[0] for p in points]),
        back_impacts=np.array([p.contacts[1] for p in points]),
        bifurcations=tuple(found),
        ended=ended,
    )


def _walk(
    curve: Curve, first: Point, start: float, to: float, most: int, step: float
) -> Iterator[Point | str]:
    """Points of the branch, then the reason for its end."""
    here = first
    side = np.sign(to - start)
    low, high = sorted((start / curve.span, to / curve.span))
    for _ in range(most):
        while True:
            guess = here.scaled + step * here.tangent
            point = None
            try:
                point = curve.correct(
                    guess, normal=here.tangent, old=here.tangent, reach=0.5 * step
                )
            except InputError:
                point = None  # the step left the parameter's range
            # near its birth a doubled orbit's corrector may slide onto the mother or the
            # half-shifted side: such a step must be short to be believed
            if (
                point is not None
                and point.tangent @ here.tangent > 0.9
                and (step < 2e-4 or not passed_mother(curve, here, point))
            ):
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


def _land(curve: Curve, a: Point, b: Point, value: float) -> Point | None:
    """The orbit exactly at the border value of the parameter."""
    weight = (value - a.scaled[2]) / (b.scaled[2] - a.scaled[2])
    guess = a.scaled + weight * (b.scaled - a.scaled)
    guess[2] = value
    return curve.correct(guess, normal=np.array([0.0, 0.0, 1.0]), old=a.tangent)


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
    curve = Curve(family, bifurcation.parameter, 2 * orbit.period, start=value, span=span)
    two = curve.unit[:2]
    matrix = orbit.jacobian / two[:, None] * two
    direction = np.linalg.svd(matrix + np.eye(2))[2][1]
    normal = np.append(direction, 0.0)
    centre = np.append(orbit.state, value) / curve.unit
    for amplitude in (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-3, 1e-2):
        point = curve.correct(
            centre + amplitude * normal, normal=normal, old=normal, reach=10.0 * amplitude
        )
        if point is None:
            continue
        doubled = curve.orbit(point)
        # half way round, a doubled orbit stands on the other side of the flipping one; the
        # flipping orbit itself, elsewhere on its branch, stands where it started
        across = (doubled.points[orbit.period] - doubled.points[0]) / two
        if np.linalg.norm(across) > amplitude:
            return Doubled(doubled, float(point.scaled[2] * curve.unit[2]), normal)
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
