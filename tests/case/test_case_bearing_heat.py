"""Shafts and bearings of a case file in its heat balance."""

from __future__ import annotations

import numpy as np
import pytest

from own_pair import OWN_PAIR
from thermogear.case.case import GearCase, load_case
from thermogear.case.gearbox import housing_box
from thermogear.heat.shaft_heat import CoefficientFriction

BEGIN = OWN_PAIR.index("[temperatures]")
END = OWN_PAIR.index("[backlash]")
COMPUTED = (OWN_PAIR[:BEGIN] + OWN_PAIR[END:]).replace('temperature = "70 degC"\n', "")
SHAFTS = """
[[shafts]]
gear = "pinion"
length = "120 mm"
diameter = "25 mm"
bearings = "6205"
[[shafts]]
gear = "wheel"
gear_position = "40 mm"
sections = [{ length = "50 mm", diameter = "40 mm" }, { length = "60 mm", diameter = "30 mm" }]
"""
OF_WHEEL = """
[[bearings]]
shaft = "wheel"
end = "left"
type = "6208"
seat_conductance = "20 W/K"
[[bearings]]
shaft = "wheel"
end = "right"
"""


def case_of(more: str) -> GearCase:
    found = load_case(COMPUTED + SHAFTS + OF_WHEEL + more)
    assert isinstance(found, GearCase)
    return found


def test_a_case_with_shafts_has_their_bearings_in_its_balance() -> None:
    case = case_of('type = "6206"\nfriction = "palmgren"\nlubrication = "grease"\n')
    train = case.gearbox.surroundings.train
    assert train is not None
    assert train.named["wheel_bearing_1"].seat == 20.0
    # by the levers, 31 of 93 mm from the left bearing
    assert train.shares["wheel_bearing_2"] == pytest.approx((40.0 - 9.0) / (102.0 - 9.0))
    # what no longer decides anything says so; the housing is as wide as the pinion's shaft
    said = {one.field: one.value for one in case.assumptions}
    for name in ("shaft_length", "bearing_conductance", "bearing_coefficient"):
        assert said[f"gearbox.{name}"].startswith("none: the ")
    apart = 105e-3 - case.pair.face_width
    walls = housing_box(case.pair, 0.5 * apart, case.gearbox.immersion)
    assert case.gearbox.surroundings.housing_area == pytest.approx(walls.area, rel=1e-12)
    assert case.computed
    balance = case.balance(case.models[0])
    assert balance.settled.all()
    force = case.stated.torque / case.pair.pinion.base_radius
    speeds = {"pinion": case.stated.speed, "wheel": case.stated.speed / case.pair.ratio}
    for name, one in train.named.items():
        loss = balance.losses.bearings[name]
        moment = one.friction.moment(
            force=train.shares[name] * force, speed=speeds[one.shaft], viscosity=loss.viscosity
        )
        np.testing.assert_allclose(loss.loss, moment * speeds[one.shaft], rtol=1e-6)
    made = sum(
        np.asarray(getattr(balance.losses, n))
        for n in ("mesh", "churning", "bearing_1", "bearing_2")
    )
    np.testing.assert_allclose(balance.steady.heat_out["ambient"], made, rtol=1e-9)


def test_a_bearing_known_by_its_stiffness_alone_keeps_the_coefficient_of_the_gearbox() -> None:
    case = case_of('stiffness = ["100 N/um", "100 N/um"]\nname = "plain"\n')
    train = case.gearbox.surroundings.train
    assert train is not None
    plain = train.named["wheel_bearing_2"]
    assert plain.size is None
    assert plain.friction == CoefficientFriction(
        coefficient=case.gearbox.bearing_coefficient, diameter=30e-3
    )
    balance = case.balance(case.models[0])
    assert balance.settled.all()
    rings = case.train.bearing_temperatures(balance.operating, balance)  # type: ignore[union-attr]
    inner = balance.steady["wheel_bearing_2_inner"]
    place = case.train.bearing_names.index("plain")  # type: ignore[union-attr]
    np.testing.assert_allclose(rings[:, place, 0], inner, rtol=1e-12)
    np.testing.assert_allclose(rings[:, place, 2], inner, rtol=1e-12)
