"""Answers of the shafts and bearings: critical speeds, loads, hot clearance, tilt."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided

if TYPE_CHECKING:
    from thermogear.study.shafts.campbell import Critical
    from thermogear.study.shafts.state import TrainState

CRITICAL, LOADS = "Which speeds are critical on the shafts?", "How large are the bearing loads?"
CLEARANCE = "Does a bearing lose its clearance when hot?"
TILT = "How much do the gears tilt?"
STRONG = 0.1
"""Dynamic force on a bearing over the greatest static load, from which a critical speed counts."""
TOLD = 4


def answers(asked: Asked) -> Iterator[Answer]:
    """At the operating point of the greatest power; nothing for a case without shafts."""
    case = asked.case
    if case.train is None:
        return
    from thermogear.study.shafts.state import settled

    at = asked.at(asked.hardest)
    try:
        found = settled(case, [asked.hardest], model=asked.model, progress=asked.progress)
        cold, hot = (row[0] for row in found)
        rest = hot.rest
        if why := asked.still(asked.hardest):
            raise InputError("oil.temperature", why)
    except InputError as error:
        for question, name in (
            (CRITICAL, "critical_speed"),
            (LOADS, "bearing_safety"),
            (CLEARANCE, "bearing_clearance"),
            (TILT, "tilt"),
        ):
            yield undecided(question, name, str(error.why or error.got), at=at)
        return
    yield _critical(asked, hot, at)
    loads = np.linalg.norm(rest.bearing_force, axis=-1)
    yield _loads(asked, hot, loads, at)
    yield _clearance(asked, cold, hot, at)
    width = min(case.pair.pinion.face_width, case.pair.wheel.face_width)
    parted = abs(rest.misalignment) * width
    share = parted / (rest.mesh_force / hot.band[1]) if rest.mesh_force > 0.0 else np.nan
    yield answer(
        TILT,
        "tilt",
        f"Across the face the flanks part by {1e6 * parted:.2f} µm, where the teeth give "
        f"{1e6 * rest.mesh_force / hot.band[1]:.2f} µm.",
        share,
        at=at,
    )


def _critical(asked: Asked, hot: TrainState, at: str) -> Answer:
    from thermogear.study.shafts.campbell import critical_speeds

    own = np.unique(asked.case.stated.speed)
    found = critical_speeds(asked.case, hot, 1.5 * float(own.max()))
    loads = np.linalg.norm(hot.rest.bearing_force, axis=-1)
    # a resonance that lifts a bearing off is one of the strongest, however strong it is
    least = STRONG * float(loads.max())
    strong = [one for one in found if one.force >= least or np.isfinite(one.lift_off)]
    if not strong:
        return answer(
            CRITICAL,
            "critical_speed",
            f"Up to {1.5 * own.max() / RPM:.0f} rpm no resonance of the shafts shakes a bearing "
            f"with {100.0 * STRONG:.0f} % of the greatest static load, {loads.max():.0f} N.",
            100.0,
            at=at,
        )
    away = np.abs(own[:, None] / np.array([one.speed for one in strong]) - 1.0)
    ranked = sorted(strong, key=lambda one: -np.nan_to_num(one.force, nan=np.inf))[:TOLD]
    told = ", ".join(
        f"{one.speed / RPM:.0f} rpm ({one.order} meets {one.frequency / (2.0 * np.pi):.0f} Hz, "
        f"{one.mostly}, {_felt(one)})"
        for one in sorted(ranked, key=lambda one: one.speed)
    )
    return answer(CRITICAL, "critical_speed", f"Critical: {told}.", 100.0 * away.min(), at=at)


def _felt(met: Critical) -> str:
    if np.isfinite(met.lift_off):
        return f"a bearing lifts off or the teeth part from {met.lift_off / RPM:.0f} rpm on"
    return f"{met.force:.0f} N on a bearing" if np.isfinite(met.force) else "undamped"


def _loads(asked: Asked, hot: TrainState, loads: np.ndarray, at: str) -> Answer:
    plan = asked.case.train
    assert plan is not None
    ratio = asked.case.pair.pinion.teeth / asked.case.pair.wheel.teeth
    limits = plan.limits(loads, hot.speed, ratio)
    most = int(np.argmax(loads))
    name = plan.bearing_names[most]
    words = f"Bearing {name} carries most, {loads[most]:.0f} N"
    if np.isnan(limits["static_safety"]).all():
        return undecided(LOADS, "bearing_safety", f"no rating is known; {words}", at=at)
    lasting = float(np.nanmin(limits["life"])) / 3600.0
    return answer(
        LOADS,
        "bearing_safety",
        f"{words}; the least rating life L10 is {lasting:.0f} h.",
        float(np.nanmin(limits["static_safety"])),
        at=at,
    )


def _clearance(asked: Asked, cold: TrainState, hot: TrainState, at: str) -> Answer:
    if np.isnan(hot.half_plays).all():
        return undecided(CLEARANCE, "bearing_clearance", "no bearing says its clearance", at=at)
    least = int(np.nanargmin(hot.half_plays))
    play, before = 2e6 * hot.half_plays[least], 2e6 * cold.half_plays[least]
    assert asked.case.train is not None
    name = asked.case.train.bearing_names[least]
    return answer(
        CLEARANCE,
        "bearing_clearance",
        f"Bearing {name} has least radial internal clearance: of {before:.1f} µm mounted cold "
        f"{play:.1f} µm are left hot" + ("; it is preloaded." if play < 0.0 else "."),
        play,
        at=at,
    )
