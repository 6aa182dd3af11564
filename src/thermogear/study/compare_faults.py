"""``compare --baseline``: what the faults of a case do to the indicators, beside what records show.

Indicators of :mod:`~thermogear.study.diagnosis` of healthy and suspect records and of the motion
without the case's faults and with them. The teeth's own acceleration is not that of a housing: the
changes are held beside each other, and no verdict is made of them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import lcm

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.measured.diagnosis import SHAFTS
from thermogear.measured.impacts import BearingRates
from thermogear.results.result import Result
from thermogear.signals.indicators import gear_indicators, na4_of_moments
from thermogear.signals.synchronous import shared_step
from thermogear.study.declared import fault_notices
from thermogear.study.diagnosis import Source, diagnose
from thermogear.study.faults import TurnMotion, fault_motions

ROUNDING = 1e-9
"""Share of the rms below which a residual is rounding: chosen, above that of a motion."""
OF_MESH = ("rms", "fm0", "kurtosis", "crest")
"""Indicators of a motion that has lines of the mesh alone; all others are of the residual."""


def compare_faults(
    case: GearCase,
    records: Sequence[Source],
    baseline: Sequence[Source],
    *,
    bearings: Sequence[tuple[str, BearingRates]] = (),
    progress: Progress = silent,
) -> Result:
    """The diagnosis of ``records`` with a group ``simulated``: indicators of a computed motion.

    The motion is at the mean speed of the last record, where its rate is known, else of the case.
    Raises InputError for a case without faults, or with several torques.
    """
    if not case.faults():
        raise InputError("faults", "none", fix="state [[faults]] in the case")
    teeth = case.pair.pinion.teeth, case.pair.wheel.teeth
    diagnosed = diagnose(records, baseline, teeth=teeth, bearings=bearings, progress=progress)
    figures = diagnosed.table("figures")
    motions = fault_motions(case, figures["speed"])
    if len(motions) != 1:
        raise InputError("operating", f"{len(motions)} points", allowed="one, as of the records")
    sides = {
        name: _indicators((motions[0].sound, getattr(motions[0], name)), figures["shafts"])
        for name in ("sound", "faulty")
    }
    groups = {**diagnosed.groups, "simulated": _beside(diagnosed.groups["indicators"], sides)}
    return replace(diagnosed, groups=groups, notices=(*diagnosed.notices, *fault_notices(case)))


def _indicators(
    motions: tuple[TurnMotion, TurnMotion], shafts: Sequence[dict[str, int]]
) -> dict[tuple[str, str], float]:
    """Indicators by shaft and name of the second of two ``motions``; NA4 over the first's."""
    values: dict[tuple[str, str], float] = {}
    for shaft in shafts:
        of, z = SHAFTS.index(str(shaft["shaft"])), shaft["teeth"]
        turns = np.stack([turn_of(motion, of) for motion in motions])
        rows = gear_indicators(
            turns,
            mesh_order=z,
            highest=min(shaft["highest"], turns.shape[-1] // 2 - 1),
            step=shared_step(mesh_order=z, mate_order=motions[0].teeth[1 - of]),
        )
        spread = rows["residual_rms"] ** 2
        rows["na4"] = na4_of_moments(
            fourth=rows["residual_fourth"], variance=spread, healthy=float(spread[0])
        )
        bare = rows["residual_rms"][1] < ROUNDING * rows["rms"][1]
        values |= {
            (SHAFTS[of], name): np.nan if bare and name not in OF_MESH else float(row[1])
            for name, row in rows.items()
        }
    return values


def turn_of(motion: TurnMotion, shaft: int) -> Floats:
    """The acceleration averaged over all turns of ``shaft`` 0 or 1 of the motion: (sample,)."""
    if not np.isfinite(motion.acceleration).all():
        raise InputError("operating", motion.status, why="no motion at the speed of the record")
    periods, z = motion.mesh_periods * motion.turns, motion.teeth[shaft]
    whole = np.tile(motion.acceleration, lcm(periods, z) // periods)
    return np.asarray(whole.reshape(-1, z * motion.samples).mean(axis=0))


def _beside(indicators: Dataset, sides: dict[str, dict[tuple[str, str], float]]) -> Dataset:
    """Each row of a diagnosis, measured and simulated, with the change of both."""
    keys = list(zip(indicators["shaft"].values, indicators["indicator"].values, strict=True))
    columns = {
        "measured_healthy": indicators["healthy_median"].values,
        "measured_suspect": indicators["indicator_value"].values[-1],
        "simulated_healthy": np.array([sides["sound"].get(key, np.nan) for key in keys]),
        "simulated_fault": np.array([sides["faulty"].get(key, np.nan) for key in keys]),
    }
    for side, other in (("measured", "suspect"), ("simulated", "fault")):
        healthy = columns[f"{side}_healthy"]
        ratio = columns[f"{side}_{other}"] / np.where(healthy > 0.0, healthy, np.nan)
        columns[f"{side}_change"] = ratio - 1.0
    data = label({name: (("row",), values, "", name) for name, values in columns.items()})
    return data.assign_coords(
        {name: indicators[name] for name in ("channel", "shaft", "indicator")}
    )
