"""What is not decided: a jammed pair's contact, motions that are not steady, an oil too cold."""

from __future__ import annotations

import re

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.limits import OPEN, Limit
from thermogear.base.progress import silent
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.thermal_state import HOT
from thermogear.heat.convection import MOST_PRANDTL
from thermogear.heat.gearbox import fluid_from, oil_prandtl
from thermogear.study.answers import moving
from thermogear.study.answers.asked import OF_HOT, Asked
from thermogear.study.answers.survey import answers
from thermogear.study.speeds import LEAST_FACTOR

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
PAIR = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""
SMALL = (
    "grid.path_positions=41", "grid.mesh_positions=48", "grid.harmonics=12", "flanks.parts=16",
)  # fmt: skip
WHOLE = ("backlash.direction=normal", "backlash.extent=total")


def pair(*changes: str) -> GearCase:
    return gear_case(load_case(PAIR, [*SMALL, *changes]))


def test_a_jammed_pair_has_no_answer_of_a_running_contact() -> None:
    """Film, scuffing and static error belong to flanks that run: jammed, none is decided."""
    jammed = {one.name: one for one in answers(pair("backlash.value=10 um", *WHOLE)).answers}
    for name in ("film", "scuffing_margin", "scuffing_safety", "transmission_error", "relief"):
        one = jammed[name]
        assert (one.verdict, one.value) == (OPEN, None), one
    assert "flash" not in jammed["tooth_temperature"].figures


def test_a_motion_that_is_not_steady_has_no_dynamic_factor() -> None:
    """Of a steady motion the mean mesh force is the load: no dynamic factor is below 1."""
    case = pair("operating.torque=0.001 N m", "gears.wheel.teeth=20")
    hot = HOT.quantities(case, case.models[0], OF_HOT)
    asked = Asked(case, case.models[0], hot, hot, silent)
    factors = asked.motion["dynamic_factor"]
    assert not np.any(factors < LEAST_FACTOR)
    (one,) = moving.loads(asked)
    if not np.isfinite(factors).any():
        assert (one.verdict, one.value) == (OPEN, None)
    known = asked.speeds.column("dynamic_factor") if asked.speeds else factors
    assert not np.any(known < LEAST_FACTOR)


@pytest.mark.parametrize(
    ("value", "bound", "words"),
    [
        (1.0034, 1.002, "at most 1.002, here 1.003"),
        (90.00004, 90.0, "at most 90 K, here 90.00004 K"),
        (1.5, 1.002, "at most 1.002"),
        (2.0, 2.0, "at most 2"),
        (0.01, 0.0, "at most 0, here 0.01"),
    ],
)
def test_a_limit_has_the_value_beside_it_where_rounding_hides_which_is_more(
    value: float, bound: float, words: str
) -> None:
    limit = Limit("K" if "K" in words else "", most=bound, source="a test")
    assert limit.beside(value) == words
    near = re.findall(r"\d[\d.]*", limit.beside(value))
    assert len(near) == 1 or (float(near[0]) < float(near[1])) == (bound < value)


def test_an_oil_too_cold_for_convection_is_refused_by_its_field() -> None:
    with pytest.raises(InputError, match=r"^oil\.temperature: got -28 °C; allowed this oil from "):
        answers(pair("oil.temperature=-28 degC"))
    oil = pair().stated.lubricant
    assert oil_prandtl(oil, fluid_from(oil)) == pytest.approx(MOST_PRANDTL)


def test_what_never_closes_is_recorded_long_enough_to_be_told_again() -> None:
    """Near no load flanks bounce: a load a ten-thousandth higher has the same dynamic factor, and
    a second motion that does not settle leaves a jump open."""
    found = []
    for torque in ("0.01 N m", "0.010001 N m"):
        changes = [f'operating.torque=["{torque}"]', 'operating.speed=["1000 rpm"]']
        case = load_example("rig", changes)
        assert isinstance(case, GearCase)
        found.append({one.name: one for one in answers(case).answers})
    factors = [one["dynamic_factor"].value for one in found]
    assert factors[0] == pytest.approx(factors[1], rel=0.02)
    for one in found:
        assert one["coexisting"].verdict == OPEN
        assert one["coexisting"].figures["open"] > 0
