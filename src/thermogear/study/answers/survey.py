"""Answers first: does it mesh, how hot, what backlash is left, film, speeds, dynamic factor, error.

Each question has one sentence, one number with its limit, and a verdict by the table of
:mod:`thermogear.base.limits`. What costs long work is answered from a short own survey.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.errors import ValidityWarning
from thermogear.base.progress import Progress, silent
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.mesh.model import MeshModel
from thermogear.results.answer import Answer
from thermogear.results.result import Later, Notice, Result
from thermogear.study.answers import moving, series, shafts, sharing, steady
from thermogear.study.answers.asked import MOST_POINTS, MOVES, OF_COLD, OF_HOT, Asked
from thermogear.study.declared import Answers, declared

MAKERS = (
    steady.mesh,
    steady.heat,
    steady.gap,
    steady.film,
    sharing.answers,
    moving.speeds,
    moving.loads,
    moving.errors,
    steady.root,
    shafts.answers,
)
"""What answers each question, in the order of the page."""


OF_A_SERIES = {
    steady.gap: series.gap, moving.speeds: series.speeds, moving.loads: series.loads,
    moving.errors: series.errors,
}  # fmt: skip
"""What answers in their place where the case is one of a series."""


@declared(Answers)
def answers(case: GearCase, *, progress: Progress = silent) -> Result:
    """The answers of a gear case by its first model: ``result.answers``, the ``speeds`` behind.

    Each answer names the unit of its value; ``speeds`` is in SI, the speed in [rad/s].

    Raises InputError where the case as a whole is impossible; what fails at one point is a verdict
    "not decided" with its reason.
    """
    model = case.models[0]
    progress("mesh cycle", 0, 2)
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "(oil temperature|viscosity|film):", ValidityWarning)
        hot = HOT.quantities(case, model, OF_HOT)
        progress("mesh cycle", 1, 2)
        cold = UNDEFORMED.quantities(case, model, OF_COLD)
    progress("mesh cycle", 2, 2)
    found, asked = answered(case, model, cold, hot, progress)
    return Result.of(
        Answers.kind,
        case.title,
        Later(**groups(asked)),
        notices(case, asked),
        **case.provenance,
        bundle=model.name,
        choices=model.choices(),
        assumptions=[
            {"field": a.field, "value": a.value, "reason": a.reason} for a in case.assumptions
        ],
        answers=[one.row for one in found],
    )


def groups(asked: Asked) -> dict[str, Callable[[], Dataset]]:
    """What makes the groups behind the answers: ``series``, or the ``speeds`` of one part."""
    if asked.series:
        return {"series": partial(series.data, asked)}
    speeds = None if asked.in_series else asked.speeds
    return {} if speeds is None else {"speeds": lambda: speeds.data}


def notices(case: GearCase, asked: Asked) -> Iterator[Notice]:
    """What limits the answers as a whole, and the look over speeds."""
    count = case.stated.speed.size
    if count > MOST_POINTS:
        yield Notice.of("some_points_answered", answered=MOST_POINTS, points=count)
    if asked.series:
        yield series.notice(asked)
    elif case.accuracy is not None and not asked.in_series:
        yield Notice.of("flanks_are_one_drawing", accuracy=case.accuracy)
    if not asked.in_series and asked.speeds is not None:
        looked = asked.speeds.column("pinion_speed")
        yield Notice.of(
            "speeds_looked_at", least=looked.min(), greatest=looked.max(), step=asked.speeds.step
        )


def answered(
    case: GearCase,
    model: MeshModel,
    cold: Dataset | Mapping[str, NDArray[Any]],
    hot: Dataset | Mapping[str, NDArray[Any]],
    progress: Progress = silent,
) -> tuple[tuple[Answer, ...], Asked]:
    """Every answer from the mesh cycles undeformed and ``hot`` under ``model``; what they share."""
    first = {name: np.asarray(cold[name]) for name in OF_COLD}
    then = {name: np.asarray(hot[name]) for name in (*OF_HOT, *MOVES)}
    asked = Asked(case, model, first, then, progress)
    found: list[Answer] = []
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        for make in MAKERS:
            found += (OF_A_SERIES.get(make, make) if asked.in_series else make)(asked)
    return tuple(found), asked
