"""Which cases are the thesis's own: only with them anything is said of the thesis."""

from __future__ import annotations

import warnings
from functools import lru_cache
from typing import Any

from thermogear.base.errors import ValidityWarning
from thermogear.case.assumptions import same
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase, load_example
from thermogear.case.schema import BASE_SETS

RIG = "rig"


def of_the_thesis(case: Case) -> bool:
    """Whether ``case`` is the ready-made rig, or one of the ready-made dimensionless cases.

    Told by its values: gears, oil, housing, heat, masses, backlash and error are the rig's, and
    every speed, torque and gear temperature is one of the rig's. Title, bundle, choices, grids
    and pictures are free. A dimensionless case has the points of a ready-made one.
    """
    if isinstance(case, GearCase):
        return _is_rig(case)
    return isinstance(case, DimensionlessCase) and any(
        same(case.points, _example(name).points) for name in BASE_SETS
    )


@lru_cache(maxsize=8)
def _example(name: str) -> Any:
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        return load_example(name)


def _is_rig(case: GearCase) -> bool:
    rig: GearCase = _example(RIG)
    axes = ("speeds", "torques", "gear_temperatures")
    return same(_stated(case), _stated(rig)) and all(
        any(same(value, known) for known in getattr(rig, name))
        for name in axes
        for value in getattr(case, name)
    )


def _stated(case: GearCase) -> tuple[object, ...]:
    """What a gear case says besides its operating points and its choices."""
    at = case.stated
    return (
        case.pair,
        at.lubricant,
        at.oil_temperature,
        at.temperatures,
        at.housing,
        at.half_backlash,
        case.temperature_rule,
        case.gearbox,
        case.readings,
        case.inertias,
        case.damping_ratio,
        case.transmission_error,
        case.deviations,
        case.scuffing_load_stage,
        case.computed,
    )
