"""A whole turn of both gears: eccentricity, teeth that differ, and what repeats when."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation, PitchError, Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.pair import GearPair
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import (
    Eccentricity,
    ToothShapes,
    mean_tooth,
    tooth_angle,
    turn_period,
)

TRUTH = json.loads((Path(__file__).parent / "turn_truth.json").read_text())
PAIR = GearPair(Gear(20, 3e-3), Gear(40, 3e-3))
NAMES = ("pinion", "wheel")


def truth_pair(case: str) -> GearPair:
    given = TRUTH[case]
    pinion, wheel = (Gear(z, 1e-3 * given["module_mm"]) for z in given["teeth"])
    return GearPair(pinion, wheel)


def centred_at(pair: GearPair, name: str, *, amount: float, from_line: float) -> Eccentricity:
    """Eccentricity whose centre is seen from the line of centres at mesh phase 0."""
    return Eccentricity(name, amount=amount, angle=tooth_angle(pair, name) - from_line)


def eccentric(case: str) -> tuple[GearPair, list[Eccentricity]]:
    given, pair = TRUTH[case], truth_pair(case)
    both = zip(NAMES, given["eccentricity_um"], given["angle_rad"], strict=True)
    return pair, [centred_at(pair, n, amount=1e-6 * e, from_line=a) for n, e, a in both]


@pytest.mark.parametrize("case", [name for name in TRUTH if "eccentric" in name])
def test_displaced_involutes(case: str) -> None:
    """Transmission errors of exact involutes about displaced axes."""
    given = TRUTH[case]
    pair, devices = eccentric(case)
    phase = np.array(given["pinion_angle_rad"]) * pair.pinion.teeth / (2.0 * np.pi)
    error = first_touch(mesh_points(pair, phase), devices).gap.min(axis=-1)
    assert 1e6 * error == pytest.approx(np.array(given["te_um"]), abs=given["tolerance_um"])


@pytest.mark.parametrize("name", NAMES)
def test_the_half_backlash_is_least_where_the_centre_is_nearest_to_the_mate(name: str) -> None:
    pair = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
    teeth, start = pair.gear(name).teeth, 0.4
    device = centred_at(pair, name, amount=20e-6, from_line=start)
    phase = np.linspace(0.0, teeth, 101)
    drive, back = (
        device.gap(mesh_points(pair, phase, side).contacts) for side in ("drive", "back")
    )
    expected = -6.840403 * np.cos(2.0 * np.pi * phase / teeth + start)
    assert 0.5e6 * (drive + back)[:, 0] == pytest.approx(expected, abs=1e-6)
    assert np.ptp(drive, axis=1) == pytest.approx(0.0, abs=0.0)


def test_the_axis_of_tooth_0_lies_half_a_tooth_from_its_flank_at_the_start_of_contact() -> None:
    pair = GearPair(Gear(25, 5e-3, profile_shift=0.3), Gear(75, 5e-3), 251.5e-3)
    start, turn = pair.path.a, pair.operating_pressure_angle
    for name, string, side in (
        ("pinion", start, 1.0),
        ("wheel", pair.line_of_action - start, -1.0),
    ):
        gear = pair.gear(name)
        seen = side * (math.atan2(string, gear.base_radius) - turn)
        half = float(gear.half_thickness_angle(math.hypot(gear.base_radius, string)))
        assert tooth_angle(pair, name) == pytest.approx(seen - side * half, abs=1e-12)


def test_periods_of_what_differs() -> None:
    errors = PitchError("pinion", (0.0,) * 19 + (2e-6,))
    run_out = Eccentricity("wheel", amount=10e-6, angle=0.0)
    alike: list[Deviation] = [
        Relief("pinion", amount=5e-6, length=2e-3),
        PitchError("pinion", (3e-6,) * 20),
        Eccentricity("wheel", amount=0.0, angle=1.0),
        ToothShapes("wheel", (WavyProfile("wheel", slope=3e-6),) * 40),
    ]
    cases: list[tuple[list[Deviation], int]] = [
        ([], 1),
        (alike, 1),
        ([*alike, errors], 20),
        ([*alike, run_out], 40),
        ([errors, run_out], 40),
    ]
    for devices, mesh_periods in cases:
        assert turn_period(PAIR, devices).mesh_periods == mesh_periods
        assert turn_period(PAIR, mean_tooth(PAIR, devices)).mesh_periods == 1
    assert mean_tooth(PAIR, alike) == tuple(alike)
    assert (
        turn_period(
            truth_pair("T3_both_eccentric_hunting"), eccentric("T3_both_eccentric_hunting")[1]
        ).mesh_periods
        == 945
    )


def test_the_mean_tooth_is_the_mean_over_the_teeth() -> None:
    slopes = 1e-6 * np.cos(1.3 * np.arange(20) ** 2)
    shapes = ToothShapes(
        "pinion", tuple(WavyProfile("pinion", slope=x, flank="drive") for x in slopes)
    )
    mean = mean_tooth(PAIR, [shapes])[0]
    contacts = mesh_points(PAIR, [0.1, 0.7]).contacts
    expected = WavyProfile("pinion", slope=float(slopes.mean()), flank="drive").gap(contacts)
    assert mean.gap(contacts) == pytest.approx(expected, abs=1e-15)
    at = shapes.gap(contacts)
    tooth = contacts.pinion_tooth[1, 2]
    assert at[1, 2] == shapes.shapes[tooth].gap(contacts)[1, 2]


def test_what_does_not_fit_is_refused() -> None:
    short = ToothShapes("wheel", (WavyProfile("wheel", slope=1e-6),) * 39)
    for ask in (
        lambda: turn_period(PAIR, [short]),
        lambda: short.gap(mesh_points(PAIR, [0.0]).contacts),
    ):
        with pytest.raises(
            InputError,
            match=r"^wheel.tooth_shapes.shapes: got 39 values; allowed one for each of the 40",
        ):
            ask()
    with pytest.raises(
        InputError, match=r"^tooth_shapes.gear: got pinion; allowed wheel, the same for all teeth$"
    ):
        ToothShapes("wheel", (WavyProfile("pinion", slope=1e-6),) * 40)
    with pytest.raises(
        InputError, match=r"^eccentricity.angle: got inf; allowed a finite number \[rad\]$"
    ):
        Eccentricity("wheel", amount=1e-6, angle=math.inf)
