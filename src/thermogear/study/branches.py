"""Branches of orbits along a parameter, and the doubled branches behind their flips."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import FLIP, PITCHFORK, Bifurcation
from thermogear.analysis.continuation import GAP, Branch, continuation, switch_branch
from thermogear.analysis.event_curve import EventCurve
from thermogear.analysis.orbits import Orbit, multiplier_error
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.notice import Notice
from thermogear.base.parameters import Parameter
from thermogear.base.progress import Progress, silent
from thermogear.case.allowed import gear_parameter, number_parameter
from thermogear.case.case import GearCase
from thermogear.case.one_point import OnePoint
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
    """A branch that was walked, and how deep below the first one."""

    branch: Branch
    level: int = 0


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
        "multipliers": complex_rows(b.multipliers, multiplier_error(b.orbit)),
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
    data.attrs["level"] = leg.level
    return data


# --- cascades -----------------------------------------------------------------------------
