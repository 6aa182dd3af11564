"""Backlash of every kind comes down to one half backlash on the line of action."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS
from thermogear.case.backlash import (
    cold_from_soaked,
    from_tolerances,
    from_value,
    require_room,
)
from thermogear.case.case import load_case
from thermogear.gears.backlash import (
    normal_from_circumferential,
    normal_from_distance,
    normal_from_thickness,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

PINION = Gear(25, 5e-3, profile_shift=0.3)
WHEEL = Gear(75, 5e-3, profile_shift=-0.1)
PAIR = GearPair(PINION, WHEEL)


@pytest.mark.parametrize("opening", [0.0, 1e-5, 1e-4, 1e-3])
def test_centre_distance_opens_what_the_geometry_says(opening: float) -> None:
    wide = GearPair(PINION, WHEEL, PAIR.centre_distance + opening)
    assert normal_from_distance(wide.centre_distance, PAIR) == pytest.approx(
        wide.normal_backlash, abs=1e-14
    )


def test_slope_of_the_centre_distance_is_twice_the_sine() -> None:
    step = 1e-6
    ends = [normal_from_distance(PAIR.centre_distance + s, PAIR) for s in (-step, step)]
    slope = 2.0 * math.sin(PAIR.operating_pressure_angle)
    assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(slope, rel=1e-8)


def test_thinner_teeth_open_the_same_gap_as_less_profile_shift() -> None:
    # a profile shift changes the tooth thickness by 2 x m tan(alpha) at the reference circle
    less = replace(WHEEL, profile_shift=-0.12, tip_radius=WHEEL.tip_radius)
    thinner = -0.02 * 2.0 * 5e-3 * math.tan(WHEEL.pressure_angle)
    opened = GearPair(PINION, less, PAIR.centre_distance).normal_backlash
    assert normal_from_thickness(thinner, PAIR) == pytest.approx(opened, rel=1e-9)


def test_kinds_agree() -> None:
    expansion = MATERIALS["steel"].thermal_expansion
    angle = PAIR.operating_pressure_angle
    kinds = [
        (0.25e-3, "normal", "total"),
        (0.125e-3, "normal", "half"),
        (0.25e-3 / math.cos(angle), "circumferential", "total"),
        (0.125e-3 / math.cos(angle), "circumferential", "half"),
    ]
    for value, direction, extent in kinds:
        given = from_value(value, direction, extent, 0.0, PAIR, expansion)
        assert given.half == pytest.approx(0.125e-3, rel=1e-14)
        assert given.least == given.half == given.most
    assert normal_from_circumferential(1.0, PAIR) == math.cos(angle)


def test_soaked_pair_of_one_material_keeps_its_backlash() -> None:
    expansion = MATERIALS["steel"].thermal_expansion
    assert cold_from_soaked(1e-4, 80.0, PAIR, expansion) == pytest.approx(1e-4, rel=1e-12)


def test_rigid_housing_eats_the_backlash_as_published() -> None:
    # module 5, 25:75: the total normal backlash falls by 2 a sin(alpha) lambda = 1.967 um/K
    rig = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
    cold = cold_from_soaked(0.0, 1.0, rig, housing_expansion=0.0)
    assert 2e6 * cold == pytest.approx(1.967, abs=5e-4)


def test_tolerances_give_middle_and_corners() -> None:
    given = from_tolerances(
        pinion=(-60e-6, -100e-6), wheel=(-80e-6, -140e-6), distance=(-20e-6, 20e-6), pair=PAIR
    )
    assert given.least < given.half < given.most
    cosine = math.cos(PINION.pressure_angle)
    assert given.half == pytest.approx(0.5 * 190e-6 * cosine, rel=1e-9)
    sine = math.sin(PAIR.operating_pressure_angle)
    assert given.most == pytest.approx(0.5 * (240e-6 * cosine + 2 * 20e-6 * sine), rel=1e-4)
    assert given.least == pytest.approx(0.5 * (140e-6 * cosine - 2 * 20e-6 * sine), rel=1e-4)


@pytest.mark.parametrize(
    ("kind", "room"),
    [(("normal", "total"), PAIR.base_pitch), (("normal", "half"), 0.5 * PAIR.base_pitch),
     (("circumferential", "total"), PAIR.base_pitch / math.cos(PAIR.operating_pressure_angle))],
)  # fmt: skip
def test_a_gap_as_wide_as_the_pitch_is_refused(kind: tuple[str, str], room: float) -> None:
    """Teeth and gap share the base pitch on the line of action, its own on the rolling circle."""
    text = """[gears]
module = "5 mm"
face_width = "50 mm"
[gears.pinion]
teeth = 25
profile_shift = 0.3
[gears.wheel]
teeth = 75
profile_shift = -0.1
[oil]
name = "ISO VG 100"
[operating]
speed = "1000 rpm"
torque = "100 N m"
[backlash]
value = "{value!r} mm"
direction = "{kind[0]}"
extent = "{kind[1]}"
"""
    load_case(text.format(value=999.0 * room, kind=kind))
    allowed = rf"backlash.value: .*got {1001.0 * room:.6g} mm; allowed < {1e3 * room:.4g} mm; "
    with pytest.raises(InputError, match=allowed):
        load_case(text.format(value=1001.0 * room, kind=kind))
    thin = "\n".join(
        f'{name} = "{size} mm"'
        for name, size in (
            ("pinion_tooth_thickness", -8), ("wheel_tooth_thickness", -8), ("centre_distance", 0)
        )
    )  # fmt: skip
    wide = text.partition("[backlash]")[0] + f"[backlash.tolerances]\n{thin}\n"
    with pytest.raises(InputError, match=r"backlash.tolerances: got .* mm; allowed < 14.76 mm; "):
        load_case(wide)
    with pytest.raises(
        InputError, match=r"cold_half_backlash: got 7\.3818 mm; allowed < 7\.38 mm;"
    ):
        require_room("cold_half_backlash", [1e-4, 0.5001 * PAIR.base_pitch], PAIR, of_half=1.0)


def test_thick_teeth_are_refused() -> None:
    with pytest.raises(InputError, match=r"^backlash: got a cold half backlash of -0\.0187939 mm"):
        from_tolerances(pinion=(20e-6,), wheel=(20e-6,), distance=(0.0,), pair=PAIR)


def test_a_distance_within_the_base_circles_is_refused() -> None:
    with pytest.raises(InputError, match="the sum of the base radii"):
        normal_from_distance(0.2, PAIR)
