"""Standard gears and housings in a case file: roundings, undercut, metals known by name."""

from __future__ import annotations

import math

import pytest

from thermogear.base.errors import GeometryError
from thermogear.base.materials import material
from thermogear.case.case import gear_case, load_case
from thermogear.case.derived import facts
from thermogear.study.answers.steady import unrated


@pytest.mark.parametrize(
    ("distance", "taken"),
    [
        ("91.5 mm", True),
        ("91.50 mm", True),
        ("91.500 mm", True),
        ("0.0915 m", True),
        ("3.6024 in", True),  # 91.50096 mm: above
        ("91.50007 mm", False),
        ("91.4 mm", False),  # half a unit of its last digit is 0.05 mm, the rest is too little
        ("92 mm", True),
    ],
)
def test_a_distance_that_misses_by_the_rounding_of_its_digits_is_taken(
    distance: str, taken: bool
) -> None:
    """The shifts of FZG A need 91.500081 mm, its rig has 91.5 mm."""
    change = f"gears.centre_distance={distance}"
    if not taken:
        with pytest.raises(GeometryError, match=r"allowed >= 91\.5001 mm; the teeth would wedge"):
            load_case("fzg-a", [change])
        return
    case, exact = (gear_case(load_case("fzg-a", changes)) for changes in ([change], []))
    tight, given = exact.pair.centre_distance, case.file.gears.centre_distance
    assert given is not None
    assert case.pair.centre_distance == max(tight, given)
    said = [one.value for one in facts(case) if one.name == "centre distance given"]
    words = "91.5 mm, rounded: the mesh without backlash is taken"
    assert said == ([words] if given < tight else [])


@pytest.mark.parametrize(
    ("module", "distance", "taken"),
    [
        ("3.175 mm", "96.8 mm", True),  # 96.8375 mm
        ("3.175 mm", "3.8 in", True),  # 3.8125 in, half a unit is 0.05 in
        ("3.175 mm", "96.7 mm", False),  # more than half a unit of its last digit
        ("3.175 mm", "0.096 m", False),  # the tips hit the roots 0.79 mm below 96.8375 mm
        ("3.175 mm", "9e1 mm", False),
        ("10.01 mm", "305 mm", True),  # 305.305 mm
        ("0.5 mm", "15 mm", False),  # 15.25 mm: the tips hit the roots at 15.125 mm
    ],
)
def test_the_digits_of_a_distance_decide_as_long_as_the_tips_clear_the_roots(
    module: str, distance: str, taken: bool
) -> None:
    text = f"""[gears]
module = "{module}"
face_width = "10 mm"
centre_distance = "{distance}"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 41
[oil]
name = "ISO VG 100"
[operating]
speed = "100 rpm"
torque = "0.1 N m"
"""
    if not taken:
        with pytest.raises(GeometryError, match=r"centre_distance: .*the teeth would wedge"):
            load_case(text)
        return
    pair = gear_case(load_case(text)).pair
    assert pair.centre_distance == pair.pinion.pitch_radius + pair.wheel.pitch_radius


def test_undercut_is_told_with_how_far_below_the_flank_in_use_it_ends() -> None:
    case = load_case("bgu-17-38", ["gears.pinion.profile_shift=0"])
    found = {(one.group, one.name): one.value for one in facts(case)}
    pair = gear_case(case).pair
    below = 1e6 * (pair.start_radii[0] - pair.pinion.form_radius)
    words = f"ends {below:.4g} um below the flank in use"
    assert found["pinion", "undercut"] == words
    assert ("wheel", "undercut") not in found
    short = load_case(
        "bgu-17-38",
        [
            "gears.pinion.profile_shift=0",
            "gears.pinion.teeth=14",
            "gears.pinion.allow_undercut=true",
        ],
    )
    told = [one.value for one in facts(short) if one.name == "undercut"]
    words = "shortens the contact"
    assert told == [words]


@pytest.mark.parametrize("housing", ["aluminium", "GJL-250", "EN-GJS-400-15", "magnesium"])
def test_a_housing_known_by_name_opens_the_gap_by_its_own_growth(housing: str) -> None:
    """2 (j/2) grows by a sin(alpha_w) (lambda - lambda_steel)(T_h - T_0) against steel."""
    warm, steel = (
        gear_case(
            load_case(
                "bgu-17-38",
                {
                    "housing.material": name,
                    "oil.temperature": "60 degC",
                    "temperatures": "{pinion_addendum = '80 degC', wheel_addendum = '70 degC', "
                    "pinion_bore = '75 degC', wheel_bore = '65 degC', housing = '55 degC'}",
                },
            )
        )
        for name in (housing, "steel")
    )
    halves = [
        float(case.cycle(case.operating, case.models[0])["half_backlash"].values.min())
        for case in (warm, steel)
    ]
    pair, apart = warm.pair, warm.housing.thermal_expansion - steel.housing.thermal_expansion
    grows = pair.centre_distance * math.sin(pair.operating_pressure_angle) * apart * 35.0
    assert halves[0] - halves[1] == pytest.approx(grows, rel=0.02)
    around, walls = warm.gearbox.surroundings, steel.gearbox.surroundings
    assert around.housing_specific_heat == material(housing).specific_heat
    ratio = material(housing).density / material("steel").density
    assert around.housing_mass / walls.housing_mass == pytest.approx(ratio, rel=1e-12)


def test_a_gear_of_iron_is_computed_and_what_is_unknown_of_it_is_said() -> None:
    case = gear_case(load_case("bgu-17-38", {"gears.wheel.material": "ductile iron"}))
    assert case.pair.wheel.material is material("EN-GJS-400-15")
    why = "the rating is for steel on steel, not EN-GJS-400-15"
    assert unrated(case, 80.0, 350.0) == why
