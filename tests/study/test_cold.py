"""Cold is cold: at the drawing temperature every study finds the pair that is drawn."""

from __future__ import annotations

import json
import re
from functools import partial

import numpy as np
import pytest

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import ZERO_CELSIUS
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.case.examples import example_text
from thermogear.case.family import GearFamily
from thermogear.case.one_point import of_case
from thermogear.case.thermal_state import ThermalState
from thermogear.gears.candidates import mesh_points
from thermogear.gears.relief import optimise_tip_relief
from thermogear.mesh.operating import Temperatures
from thermogear.mesh.thermal import HotPair, ThermalDeviation
from thermogear.study import relief
from thermogear.study.relief import relief_survey

T0 = ZERO_CELSIUS + 20.0
GIVEN = r"(pinion|wheel)_(addendum|bore_below_addendum)|housing_below_addendum|row"


def own_pair(*changes: str) -> GearCase:
    """Not the rig: another module, angle, ratio and shift, the oil held, gears of two heats."""
    text = example_text("rig")
    for old, new in (
        ("teeth = 25 ", "teeth = 19 "),
        ("teeth = 75 ", "teeth = 47 "),
        ('module = "5 mm" ', 'module = "3 mm" '),
        ('pressure_angle = "20 deg" ', 'pressure_angle = "25 deg" '),
        ('temperature_below_addendum = "40 K"', 'temperature = "95 degC"'),
        ('"oil.temperature_below_addendum"', '"oil.temperature"'),
        ('bore_radius = "25 mm"', 'bore_radius = "12 mm"'),
        ('bore_radius = "80 mm"', 'bore_radius = "30 mm"'),
        ("fillet_radius = 0.38 ", "fillet_radius = 0.25 "),
        ('bundle = "both"', 'bundle = "consistent"'),
    ):
        assert old in text, old
        text = text.replace(old, new)
    text = re.sub(r"(?m)^(tip_diameter|\"gears\.\w+\.tip_diameter\").*\n", "", text)
    return load_example_text(text, "temperatures.wheel_addendum=120 degC", *changes)


def load_example_text(text: str, *changes: str) -> GearCase:
    case = load_case(text, changes)
    assert isinstance(case, GearCase)
    return case


STILL = 'operating.speed="0.1 rpm"'
"""So slow that nothing is pulled outward: what is not hot is as drawn."""


def test_a_sweep_over_temperature_begins_at_the_cold_backlash() -> None:
    case = own_pair(STILL)
    points = GearFamily(case, ("gear_temperature",))(np.array([[T0], [T0 + 60.0], [T0 + 120.0]]))
    cold = GearFamily(case, (), state="undeformed")(np.empty((1, 0)))
    assert points.half_backlash[0] == pytest.approx(case.stated.half_backlash, rel=1e-12)
    assert points.stiffness[0] == pytest.approx(cold.stiffness[0], rel=1e-9)
    # the loss grows in proportion to the excess
    lost = case.stated.half_backlash - points.half_backlash
    assert lost[2] == pytest.approx(2.0 * lost[1], rel=2e-3)
    assert lost[1] > 0.0


def test_a_continuation_over_temperature_passes_the_drawn_pair_and_the_stated_one() -> None:
    case = own_pair("temperatures.wheel_addendum=140 degC", STILL)
    subject = of_case(case)
    models, present = subject.along("temperature"), subject.value("temperature")
    assert present == pytest.approx(ZERO_CELSIUS + 140.0)
    drawn, stated = models(T0).flat, models(present).flat
    cold = of_case(case, state="undeformed").points.flat
    assert cold.half_backlash[0] == 1.0
    assert drawn.half_backlash[0] == pytest.approx(1.0, rel=1e-12)
    here = subject.points.flat.half_backlash
    assert stated.half_backlash == pytest.approx(here, rel=1e-12)


def test_each_operating_point_of_computed_temperatures_is_its_own() -> None:
    text = re.sub(rf"(?m)^({GIVEN}) = .*\n", "", example_text("rig"))
    text = re.sub(rf"(?m)^\"temperatures\.({GIVEN})\".*\n", "", text)
    text = re.sub(r"(?m)^temperature_below_addendum = .*\n", "", text)
    text = re.sub(r"(?m)^\"oil\.temperature_below_addendum\".*\n", "", text)
    case = load_example_text(text)
    for bundle in case.models:
        whole = np.ravel(case.operating_of(bundle).temperatures.pinion_addendum)
        for place in range(3):
            point = of_case(case, operating=place + 1, bundle=bundle.name)
            assert point.operating is not None
            assert point.value("temperature") == whole[place]
            assert point.excitation().half_backlash < point.operating.half_backlash
    moved = ThermalState.at(T0).operating(point.gears, point.bundle)
    assert all(np.all(body == T0) for body in moved.temperatures.bodies.values())
    assert np.all(moved.oil_temperature == T0)


def test_the_relief_for_the_drawing_temperature_is_that_of_the_drawn_pair(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Heat takes nothing off there; of the same pair the same search finds the same.

    Rounding of the heat, 1e-16 m, decides where the search ends: its least is flat.
    """
    case = own_pair(STILL)
    short = partial(optimise_tip_relief, evaluations=40)
    monkeypatch.setattr(relief, "optimise_tip_relief", short)
    found = relief_survey(case, torque=60.0, gear_temperature=T0)
    model = case.models[0]
    at = relief.one_point(ThermalState.of(T0).operating(case, model), 60.0)
    heat = relief.Seen(ThermalDeviation(HotPair(case.pair, at, model)), 0)
    gap = heat.gap(mesh_points(case.pair, relief.UNIFORM).contacts)
    assert np.abs(gap).max() < 1e-15
    drawn = short(case.pair, 60.0 / case.pair.pinion.base_radius, deviations=[heat])
    designed = json.loads(found.attrs["reliefs"])
    for one in (drawn.pinion, drawn.wheel):
        assert designed[one.gear]["amount_m"] == pytest.approx(one.amount, rel=1e-9)
        assert designed[one.gear]["length_m"] == pytest.approx(one.length, rel=1e-9)
    assert drawn.relieved < drawn.unrelieved
    # the figures are those of the curve that is drawn, of finer positions
    swing = np.ptp(found["error"]["transmission_error"].values, axis=-1)
    assert [found.attrs["unrelieved"], found.attrs["relieved"]] == swing.tolist()
    assert swing[0] == pytest.approx(drawn.unrelieved, rel=0.03)


def test_with_fixed_distances_the_housing_cools_below_the_drawing() -> None:
    """What was done before, kept under its own name."""
    case = load_example("rig", ["temperatures.follow=fixed"])
    assert isinstance(case, GearCase)
    there = case.operating_at(T0).temperatures
    expected = Temperatures(
        reference=T0,
        pinion_addendum=T0,
        pinion_bore=T0 - 20.0,
        wheel_addendum=T0,
        wheel_bore=T0 - 20.0,
        housing=T0 - 40.0,
    )
    for name, body in expected.bodies.items():
        np.testing.assert_allclose(there.bodies[name], body)


def test_a_proportion_that_no_network_has_is_warned_of() -> None:
    far = (
        "temperatures.housing=150 degC",
        "temperatures.pinion_addendum=60 degC",
        "temperatures.wheel_addendum=60 degC",
        "draw.pictures=['path']",
    )
    text = re.sub(r"(?m)^housing_below_addendum = .*\n", "", example_text("rig"))
    text = re.sub(r"(?m)^\"temperatures\.housing_below_addendum\".*\n", "", text)
    case = load_example_text(text, *far)
    with pytest.warns(ValidityWarning, match=r"temperatures\.housing: stands 130 K over .* 40 K"):
        case.operating_at(T0 + 20.0)
    fixed = load_example_text(text, *far, "temperatures.follow=fixed")
    assert float(fixed.operating_at(T0 + 60.0).temperatures.housing) == T0 + 130.0


def test_a_temperature_of_the_row_that_gives_no_proportion_is_named_by_its_place() -> None:
    still = "temperatures.wheel_addendum=20 degC"
    with pytest.raises(InputError, match=r"^temperatures\.row\[0\]: .*the wheel's addendum stands"):
        load_example_text(example_text("rig"), still)
    # where the row is not drawn nothing asks for a proportion
    load_example_text(example_text("rig"), still, "draw.pictures=['path']")


def test_a_state_beside_a_varied_temperature_is_refused() -> None:
    with pytest.raises(InputError, match="the gear temperature itself is varied here"):
        GearFamily(own_pair(), ("gear_temperature",), state="undeformed")
