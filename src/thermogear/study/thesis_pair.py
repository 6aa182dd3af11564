"""The steps of the thesis for any gear pair: heat, bifurcations, friction, records.

One operating point under one bundle: its motion over gear temperatures, its bifurcations over
damping, speed and stiffness fluctuation undeformed and hot, its friction mixed and dry, and its
records beside both states. The tree is that of a run of this point (:mod:`thermogear.study.run`)
and ``diagrams/PARAMETER``, ``comparison``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.parameters import PARAMETERS
from thermogear.base.plan import gather
from thermogear.base.progress import Progress, silent
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.allowed import FLUCTUATION
from thermogear.case.case import GearCase
from thermogear.case.family import GearFamily
from thermogear.case.points import Points, largest_fluctuation
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.measured.comparison import result_of
from thermogear.results.beside import from_data
from thermogear.results.result import Notice, Result
from thermogear.study.compare import compare
from thermogear.study.declared import fault_notices
from thermogear.study.diagrams import case_diagram, overlaid
from thermogear.study.notices import friction_notices
from thermogear.study.run import run

TEMPERATURES = tuple(ZERO_CELSIUS + t for t in (100.0, 120.0, 140.0, 160.0))
"""Gear temperatures [K] of section 4.1 of the thesis."""
DAMPING = (0.02, 0.18)
"""Damping ratios: from lightly damped gears in oil to the greatest of the thesis's table."""
SPEEDS = (0.25, 1.35)
"""Speeds, as parts of the one at which the mesh meets the natural frequency of the mean
stiffness: the second and third superharmonic resonance, the main one, and the thesis's 1.1 to
1.3 beyond it."""
PARTS = (0.1, 0.9)
"""Fluctuations of the mesh stiffness, as parts of the one at which it would reach zero: the
thesis's amplitudes 0.1 to 0.9, which reach zero at 1."""


def thesis_pair(
    case: GearCase,
    *,
    operating: int | None = None,
    bundle: str = "",
    temperatures: Sequence[float] = TEMPERATURES,
    values: int = 61,
    records: Mapping[Path, float | None] | None = None,
    progress: Progress = silent,
) -> Result:
    """The steps of the thesis for one ``operating`` point of ``case``, from 1, under one bundle.

    Left out, the point is the one nearest to the resonance of the mean stiffness, undeformed, and
    the bundle the first. ``temperatures`` [K] of the gears; ``values`` of each diagram.
    ``records``: file -> nominal speed [rad/s] of the pinion, None where the record says it; the
    case is simulated at these speeds beside them. After Ctrl+C what was finished, once the motion
    over temperature is there; ``interrupted`` says so.
    """
    alone, point = _alone(case, operating, bundle)
    kept, left_out = _possible(alone, temperatures)
    beside = Result.of("comparison", "", {})
    if records:
        progress("records", 0, 1)
        beside = result_of(compare(case, [*records], speed=[*records.values()]))
    ran = run(
        replace(alone, pictures=("motion", "temperature"), gear_temperatures=kept),
        progress=progress,
    )
    groups, cut = {**ran.groups, **beside.groups}, False
    computed: list[str] = []
    try:
        for name, axis in _axes(alone, point, values).items():
            groups[f"diagrams/{name}"] = _overlaid(alone, name, axis, progress)
            computed.append(name)
    except KeyboardInterrupt:
        cut = True
    told = [
        notice
        for name in computed
        for notice in from_data(groups[f"diagrams/{name}"][["status"]], PARAMETERS[name].words)
    ]
    if case.train is not None:
        told.insert(0, Notice.of("gears_on_rigid_bearings"))
    notices = (*fault_notices(alone), *told, *friction_notices(alone, groups))
    return replace(ran, kind="thesis-pair", groups=groups, notices=notices).with_(
        interrupted=cut, left_out=left_out, conclusion=beside.text("conclusion")
    )


def _alone(case: GearCase, operating: int | None, bundle: str) -> tuple[GearCase, Points]:
    """The case with the chosen bundle and point alone, and this point undeformed."""
    at = case.stated
    every = GearFamily(case, ("pinion_speed", "pinion_torque"), bundle, UNDEFORMED)
    points = every(np.stack([at.speed, at.torque], axis=1))
    far = np.where(points.still, np.inf, np.abs(points.mesh_frequency / points.rate - 1.0))
    place = int(np.argmin(far)) if operating is None else operating - 1
    if not 0 <= place < far.size:
        raise InputError("--operating", operating, allowed=f"1..{far.size}")
    speed, torque = float(at.speed[place]), float(at.torque[place])
    values = {"pinion_speed": speed, "pinion_torque": torque}
    alone = case.with_values(values, told=False) if far.size > 1 else case
    return replace(alone, models=(every.model,)), points.take(np.array([place]))


def _possible(
    case: GearCase, temperatures: Sequence[float]
) -> tuple[tuple[float, ...], list[dict[str, Any]]]:
    """The temperatures [K] that the materials have, and the others with the reason.

    Raises that of the last where they have none.
    """
    kept: list[float] = []
    left: list[dict[str, Any]] = []
    for value in temperatures:
        try:
            ThermalState.at(value).quantities(case, case.models[0], ("half_backlash",))
            kept.append(value)
        except InputError as error:
            why = f"{error.field}: allowed {error.allowed}, {error.why}"
            left.append({"gear_temperature_K": value, "why": why})
            if len(left) == len(temperatures):
                raise
    return tuple(kept), left


def _axes(case: GearCase, point: Points, count: int) -> dict[str, Floats]:
    """Parameter -> its values [SI]: the ranges above with the case's own value; none without gap.

    A stiffness that does not fluctuate has no axis of its fluctuation.
    """
    if point.still.any():
        return {}
    critical = float(np.copysign(point.rate[0], case.speeds[0])) / case.pair.pinion.teeth
    most = float(largest_fluctuation(point)[0])
    ends = {
        "damping_ratio": (*DAMPING, case.damping_ratio),
        "pinion_speed": (*(part * critical for part in SPEEDS), case.speeds[0]),
        FLUCTUATION: tuple(part * most for part in PARTS),
    }
    return {
        name: np.linspace(min(some), max(some), count)
        for name, some in ends.items()
        if np.isfinite(some).all()
    }


def _overlaid(case: GearCase, name: str, values: Floats, progress: Progress) -> Dataset:
    """The diagrams over one parameter, undeformed and hot."""
    states = (UNDEFORMED, HOT)
    plans = [case_diagram(case, name, values, state=state) for state in states]
    found = [
        gather(plan, progress=partial(progress, f"{PARAMETERS[name].words}, {state.words}"))
        for plan, state in zip(plans, states, strict=True)
    ]
    return overlaid([state.words for state in states], found)
