"""Branches of orbits along a parameter, doubled branches, and whole cascades."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import FLIP, PITCHFORK, Bifurcation
from thermogear.analysis.continuation import GAP, Branch, continuation, switch_branch
from thermogear.analysis.event_curve import EventCurve
from thermogear.analysis.orbits import Orbit, periodic_orbit
from thermogear.base.arrays import Dataset
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.notice import Notice
from thermogear.base.parameters import NUMBERS, Parameter
from thermogear.base.progress import Progress, silent
from thermogear.case.allowed import gear_parameter, number_parameter
from thermogear.case.case import DimensionlessCase, GearCase
from thermogear.case.dimensionless import Point
from thermogear.case.one_point import OnePoint, of_numbers
from thermogear.results.result import Result
from thermogear.study.declared import fault_notices
from thermogear.study.event_plane import Plane, one_mass
from thermogear.study.orbit import complex_rows, found, orbit_of

STEPS = 1000
"""Progress of a branch counts in thousandths of the parameter's way."""
MOST_DEPTH = 6
INTERRUPTED = "interrupted"
Models = Callable[[float], object]
"""value -> what makes lanes."""


@dataclass(frozen=True)
class Leg:
    """A branch that was walked: how deep below the first one, and the row of its cascade."""

    branch: Branch
    level: int = 0
    row: str = ""


def branch_results(
    point: OnePoint,
    parameter: str,
    to: float,
    *,
    start: float | None = None,
    period: int | None = None,
    transient: bool = True,
    switch: int = 0,
    second: tuple[str, NDArray[np.float64]] | None = None,
    progress: Progress = silent,
) -> Result:
    """Follow the orbit of ``point`` in ``parameter`` to ``to``; at flips ``switch`` levels deeper.

    ``start`` a value of the parameter to begin at (default: the present one). Folds, flips,
    pitchforks and grazing are located; Ctrl+C keeps the branches walked so far. ``second``: a
    parameter and values of it; the branch is walked at the first of these, and all that can be are
    followed on to the last, as curves in the plane of both parameters.
    """
    varied = parameter_of(point, parameter)
    begin = point.value(varied.name) if start is None else start
    plane = None
    if second is not None:
        plane = Plane(parameter_of(point, second[0]), second[1], point.over(varied.name, second[0]))
    models = point.along(varied.name) if plane is None else plane.models
    require_depth(switch)
    orbit, _ = orbit_of(point, period, transient=transient, model=models(begin))
    legs, cut = walked(orbit, varied, models, begin=begin, to=to, switch=switch, progress=progress)
    curves: list[EventCurve] = []
    notices = [*(fault_notices(point.gears) if point.points.gears else ()), *lost_notices(legs)]
    if plane is not None and not cut:
        branches = [leg.branch for leg in legs]
        curves, told, cut = plane.followed(branches, varied, (begin, to), progress)
        notices += told
    summary = summary_of(point.title, varied, legs, (begin, to), cut)
    summary["parameters"] = point.parameters
    groups = {f"branch_{i}": dataset(leg, varied.unit) for i, leg in enumerate(legs)}
    if plane is not None:
        summary |= plane.summary(curves, varied)
        groups |= plane.groups(curves, varied)
    if point.points.mesh_periods > 1:
        summary["mesh_periods"] = point.points.mesh_periods
        for group in groups.values():
            group.attrs["mesh_periods"] = point.points.mesh_periods
    return found("branch", groups, summary, notices, interrupted=cut)


def lost_notices(legs: Sequence[Leg]) -> list[Notice]:
    """Which branches could not be followed further."""
    lost = [leg.branch for leg in legs if leg.branch.ended.startswith(GAP)]
    return [Notice.of("branch_lost", period=branch.period) for branch in lost]


def require_depth(switch: int) -> None:
    """Refuse more levels of doubled branches than are followed."""
    if not 0 <= switch <= MOST_DEPTH:
        raise InputError("--switch", switch, allowed=f"0..{MOST_DEPTH}")


def walked(
    orbit: Orbit,
    varied: Parameter,
    models: Models,
    *,
    begin: float,
    to: float,
    switch: int,
    progress: Progress,
) -> tuple[list[Leg], bool]:
    """The branch of ``orbit`` from ``begin`` to ``to``, and at flips ``switch`` levels deeper.

    Whether Ctrl+C cut it short.
    """
    legs = [Leg(_walk(orbit, varied.name, to, models, begin, "branch", progress))]
    cut = legs[0].branch.ended == INTERRUPTED
    waiting = [(flip, 1) for flip in _forks(legs[0].branch)]
    try:
        while waiting and not cut:
            flip, level = waiting.pop(0)
            if level > switch:
                continue
            doubled = switch_branch(flip, models)
            # a doubled orbit lives on one side of its flip: to the end there, or to the start
            forth = (doubled.value - flip.value) * (to - flip.value) >= 0.0
            end, behind = (to, begin) if forth else (begin, to)
            if end == doubled.value:
                continue
            branch = _walk(
                doubled.orbit,
                varied.name,
                end,
                models,
                doubled.value,
                f"period {doubled.orbit.period}",
                progress,
                doubled.direction,
                back_to=behind,
            )
            legs.append(Leg(branch, level))
            cut = branch.ended == INTERRUPTED
            waiting += [(one, level + 1) for one in _forks(branch)]
    except KeyboardInterrupt:
        cut = True
    return legs, cut


def summary_of(
    title: str, varied: Parameter, legs: Sequence[Leg], ends: tuple[float, float], cut: bool
) -> dict[str, Any]:
    """What is told of branches: where they go, and their bifurcations."""
    begin, to = ends
    return {
        "title": title,
        "parameter": varied.name,
        "from": begin,
        "to": to,
        "unit": varied.shown,
        "branches": [_leg_summary(leg, varied) for leg in legs],
        "bifurcations": [_event(b, varied) for leg in legs for b in leg.branch.bifurcations],
        "interrupted": cut,
    }


def parameter_of(point: OnePoint, name: str) -> Parameter:
    """The parameter that ``name`` stands for where ``point`` is."""
    return gear_parameter(name) if isinstance(point.case, GearCase) else number_parameter(name)


def _forks(branch: Branch) -> tuple[Bifurcation, ...]:
    """Where other branches begin: period doublings, and pitchforks of one mass."""
    events = branch.bifurcations
    return tuple(b for b in events if b.kind == FLIP or (b.kind == PITCHFORK and one_mass(b)))


def _walk(
    orbit: Orbit,
    parameter: str,
    to: float,
    models: Models,
    begin: float,
    stage: str,
    progress: Progress,
    direction: Any = None,
    stop_at: str | None = None,
    back_to: float | None = None,
) -> Branch:
    span = abs(to - begin) or 1.0

    def told(_points: int, value: float) -> None:
        progress(stage, min(STEPS, round(STEPS * abs(value - begin) / span)), STEPS)

    progress(stage, 0, STEPS)
    branch = continuation(
        orbit,
        parameter,
        to,
        family=models,
        start=begin,
        back_to=back_to,
        direction=direction,
        stop_at=stop_at,
        progress=told,
        keep_on_interrupt=True,
    )
    if branch.ended != INTERRUPTED:
        progress(stage, STEPS, STEPS)
    return branch


def _event(b: Bifurcation, parameter: Parameter) -> dict[str, Any]:
    return {
        "kind": b.kind,
        "parameter": parameter.name,
        "value": b.value,
        "shown": float(parameter.show(b.value)),
        "shown_unit": parameter.shown,
        "period": b.period,
        "state": [float(c) for c in b.state],
        "multipliers": complex_rows(b.multipliers),
        "note": b.note,
    }


def _leg_summary(leg: Leg, parameter: Parameter) -> dict[str, Any]:
    branch = leg.branch
    ended = branch.ended
    if ended.startswith(GAP) and parameter.unit != "1":
        # the walk itself speaks SI
        ended = f"{GAP}: no further orbit found beyond {parameter.told(float(branch.values[-1]))}"
    return {
        "period": branch.period,
        "level": leg.level,
        "points": int(branch.values.size),
        "from": float(branch.values[0]),
        "to": float(branch.values[-1]),
        "stable_points": int(branch.stable.sum()),
        "ended": ended,
        "parameter": parameter.name,
    }


def dataset(leg: Leg, unit: str) -> Dataset:
    """A branch as it is stored: points along it, bifurcations beside them; with sections of one
    mass the displacement of each bifurcation."""
    data = leg.branch.dataset()
    data["stable"] = data["stable"].astype(np.int8)
    for name in ("value", "event_value"):
        data[name].attrs["units"] = unit
    for name in {"section", "section_x", "section_v"} & set(map(str, data.data_vars)):
        data[name].attrs["units"] = "1"
    for name in ("event_kind", "event_note"):
        data[name] = data[name].astype(str)
    if "section_x" in data:
        places = np.array([b.state[0] for b in leg.branch.bifurcations], dtype=float)
        data["event_x"] = ("event", places, {"units": "1", "long_name": "displacement at phase 0"})
    data.attrs.update({"level": leg.level, "row": leg.row})
    return data


# --- cascades -----------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """A row of a cascade table: the parameter from ``first`` to ``last`` on a base set."""

    row: str
    parameter: str
    first: float
    last: float
    base: dict[str, float]


def sweeps_of(case: DimensionlessCase, row: str | None = None) -> tuple[Sweep, ...]:
    """One sweep for every row of ``case`` that runs through a number of the equation."""
    rows: dict[str, list[Point]] = {}
    for point in case.points:
        if point.parameter in NUMBERS and row in (None, point.row):
            rows.setdefault(point.row, []).append(point)
    if not rows:
        raise InputError(
            "--row",
            repr(row),
            allowed=" | ".join({p.row: None for p in case.points if p.parameter in NUMBERS}),
            why="a cascade runs through a number of the equation",
        )
    return tuple(
        Sweep(
            row=name,
            parameter=own[0].parameter,
            first=own[0].value,
            last=own[-1].value,
            base=own[0].model_arguments(),
        )
        for name, own in rows.items()
    )


def on_numbers(sweeps: Sequence[Sweep], numbers: dict[str, float]) -> tuple[Sweep, ...]:
    """The same sweeps on another base set."""
    return tuple(
        replace(one, base={**one.base, **numbers, one.parameter: one.first}) for one in sweeps
    )


def cascade_results(
    sweeps: Sequence[Sweep],
    flips: int,
    *,
    title: str,
    start: tuple[float, float] | None = None,
    progress: Progress = silent,
) -> Result:
    """The first ``flips`` period doublings of every sweep.

    Each cascade starts from the orbit of period 1 at the sweep's first value. Where that one has
    doubled already, the walk begins where it is stable, beyond the sweep's end.
    """
    if not 1 <= flips <= MOST_DEPTH:
        raise InputError("--cascade", flips, allowed=f"1..{MOST_DEPTH}")
    legs: list[Leg] = []
    entries: list[dict[str, Any]] = []
    notices: list[Notice] = []
    cut = False
    for sweep in sweeps:
        if cut:
            break
        point = of_numbers(sweep.base, start)
        own: list[Leg] = []
        values: list[Bifurcation] = []
        try:
            cut = _cascade(point, sweep, flips, progress, own, values)
        except ConvergenceError as error:
            notices.append(Notice.of("cascade_not_found", about=sweep.row, reason=str(error)))
        except KeyboardInterrupt:
            cut = True
        if own:
            legs += [replace(leg, row=sweep.row) for leg in own]
            entries.append(_entry(sweep, values, own))
    if not legs and cut:
        raise KeyboardInterrupt
    if not legs:
        raise ConvergenceError("; ".join(n.text for n in notices) or "no cascade was found")
    if all(leg.branch.back_impacts.max() == 0 for leg in legs):
        notices.append(Notice.of("backlash_without_effect"))
    summary = {"title": title, "flips": flips, "cascades": entries, "interrupted": cut}
    groups = {f"branch_{i}": dataset(leg, "1") for i, leg in enumerate(legs)}
    return found("cascade", groups, summary, notices, interrupted=cut)


def _entry(sweep: Sweep, values: Sequence[Bifurcation], legs: Sequence[Leg]) -> dict[str, Any]:
    gaps = np.diff(np.array([b.value for b in values]))
    return {
        "row": sweep.row,
        "parameter": sweep.parameter,
        "from": sweep.first,
        "to": sweep.last,
        "base": sweep.base,
        "flips": [
            {
                "from_period": b.period,
                "to_period": 2 * b.period,
                "value": b.value,
                "state": [float(c) for c in b.state],
                "multipliers": complex_rows(b.multipliers),
                "note": b.note,
            }
            for b in values
        ],
        "ratios": [float(r) for r in gaps[:-1] / gaps[1:]] if len(gaps) > 1 else [],
        "ended": legs[-1].branch.ended,
        "back_impacts": int(max(leg.branch.back_impacts.max() for leg in legs)),
    }


def _cascade(
    point: OnePoint,
    sweep: Sweep,
    flips: int,
    progress: Progress,
    legs: list[Leg],
    values: list[Bifurcation],
) -> bool:
    """Walk one sweep, filling ``legs`` and flips as they come; whether Ctrl+C cut it short."""
    models = point.along(sweep.parameter)
    orbit, begin = _mother(point, sweep, models)
    direction, first = None, begin
    while True:
        name = f"{sweep.row}: period {orbit.period}"
        branch = _walk(
            orbit, sweep.parameter, sweep.last, models, begin, name, progress, direction, FLIP,
            back_to=first,
        )  # fmt: skip
        legs.append(Leg(branch, len(legs)))
        if branch.ended == INTERRUPTED:
            return True
        if not branch.of_kind(FLIP):
            return False
        values.append(branch.of_kind(FLIP)[0])
        if len(values) == flips:
            return False
        doubled = switch_branch(values[-1], models)
        orbit, begin, direction = doubled.orbit, doubled.value, doubled.direction


def _mother(point: OnePoint, sweep: Sweep, models: Models) -> tuple[Orbit, float]:
    """A stable orbit of period 1 to start from: at the sweep's first value or beyond it."""
    orbit, _ = orbit_of(point)
    if orbit.period == 1:
        return orbit, sweep.first
    mother = periodic_orbit(models(sweep.first), 1, orbit.points.mean(axis=0))
    away = sweep.first + 0.5 * (sweep.first - sweep.last)
    if away <= 0.0:
        away = 0.5 * sweep.first
    branch = continuation(
        mother, sweep.parameter, away, family=models, start=sweep.first, stop_at=FLIP
    )
    if not bool(branch.stable[-1]):
        raise ConvergenceError(
            f"no stable orbit of period 1 between {sweep.parameter} = {sweep.first:.6g} and "
            f"{away:.6g}; start the sweep elsewhere"
        )
    return branch.orbit(-1), float(branch.values[-1])


def sweep_of_point(point: OnePoint, parameter: str, *, first: float, last: float) -> Sweep:
    """One sweep on the numbers of a dimensionless point."""
    if isinstance(point.case, GearCase):
        raise InputError(
            "--cascade",
            "a gear case",
            why="cascades are tabled for the dimensionless equation",
            fix="use --switch to follow doubled branches of a gear pair",
        )
    return Sweep(
        row=parameter,
        parameter=parameter,
        first=first,
        last=last,
        base={**point.parameters, parameter: first},
    )
