"""Five fields are a case: what the rest is decided to be, and that it is said."""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_case
from thermogear.case.gearbox import CLEAR, housing_box
from thermogear.case.units import KINDS
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

SEED, PAIRS = 1704, 200


def five(teeth: tuple[int, int], *, module: float, width: float, torque: float, rpm: float) -> str:
    """A case of ``module`` and face ``width`` [mm], ``torque`` [N m]."""
    return f"""[gears]
module = "{module!r} mm"
face_width = "{width!r} mm"
[gears.pinion]
teeth = {teeth[0]}
[gears.wheel]
teeth = {teeth[1]}
[operating]
speed = "{rpm!r} rpm"
torque = "{torque!r} N m"
"""


def drawn() -> list[tuple[tuple[int, int], str]]:
    """Random pairs as one meets them, drawn before anything was run."""
    draw = np.random.default_rng(SEED)
    found = []
    for _ in range(PAIRS):
        first, second = (int(z) for z in draw.integers(12, 151, 2))
        module = float(np.exp(draw.uniform(np.log(0.5), np.log(20.0))))
        width = float(draw.uniform(3.0, 15.0)) * module
        load = float(draw.uniform(20.0, 600.0))  # N/mm
        torque = load * width * 0.5e-3 * module * first
        rpm = float(draw.uniform(100.0, 12000.0))
        text = five((first, second), module=module, width=width, torque=torque, rpm=rpm)
        found.append(((first, second), text))
    return found


@pytest.fixture(scope="module")
def read() -> list[tuple[tuple[int, int], GearCase | InputError]]:
    found: list[tuple[tuple[int, int], GearCase | InputError]] = []
    for teeth, text in drawn():
        try:
            case = load_case(text)
        except InputError as error:
            found.append((teeth, error))
        else:
            assert isinstance(case, GearCase)
            found.append((teeth, case))
    return found


@pytest.fixture(scope="module")
def cases(read: list[tuple[tuple[int, int], GearCase | InputError]]) -> list[GearCase]:
    return [case for _, case in read if isinstance(case, GearCase)]


def test_five_fields_are_enough_unless_teeth_are_undercut(
    read: list[tuple[tuple[int, int], GearCase | InputError]],
) -> None:
    """ISO 53 at 20 deg cuts no tooth under from z = 2 h / sin^2(20 deg) = 17.1 on, and fewer teeth
    are taken where what is cut lies below the flank in use."""
    least = 2.0 / math.sin(math.radians(20.0)) ** 2
    for teeth, found in read:
        if min(teeth) > least or isinstance(found, GearCase):
            assert isinstance(found, GearCase), (teeth, found)
            pair = found.pair
            assert (pair.pinion.undercut, pair.wheel.undercut) == tuple(z < least for z in teeth)
            assert pair.start_radii[0] >= pair.pinion.form_radius
            assert pair.start_radii[1] >= pair.wheel.form_radius
            continue
        assert isinstance(found, InputError)
        few = "pinion" if teeth[0] < least else "wheel"
        z = min(teeth) if teeth[0] >= least else teeth[0]
        assert found.field == f"gears.{few}.profile_shift"
        assert found.line == (4 if few == "pinion" else 6)
        assert f"got 0 for {z} teeth; undercut takes " in str(found)
        shift, number = re.findall(r"use x >= ([0-9.]+) or >= (\d+) teeth", str(found))[0]
        assert 0.0 < float(shift) <= math.ceil(100.0 * (1.0 - z / least)) / 100.0
        assert z < int(number) <= math.ceil(least)


def test_a_shift_as_the_message_says_makes_the_case() -> None:
    text = five((13, 40), module=2.0, width=20.0, torque=20.0, rpm=1000.0)
    with pytest.raises(InputError) as caught:
        load_case(text)
    said = re.search(r"use x >= ([0-9.]+)", str(caught.value))
    assert said is not None
    assert isinstance(load_case(text, [f"gears.pinion.profile_shift={said[1]}"]), GearCase)


LEFT_OUT = {"gears.rack", "inertia.radius", "inertia.bored", "backlash.temperature"}
"""Whose reason says what acts instead."""
SETTINGS = ("grid.", "simulation.")
PURE = re.compile(r"[0-9.e+-]+(, [0-9.e+-]+)*")
NAMES = {
    "gears.pinion.material", "gears.wheel.material", "housing.material", "oil.name",
    "inertia.model", "temperatures.follow", "flanks.accuracy", "flanks.population",
}  # fmt: skip
UNITLESS = {
    "gears.pinion.profile_shift", "gears.wheel.profile_shift", "gearbox.wetted_share",
    "gearbox.immersion", "gearbox.bearing_coefficient", "dynamics.damping_ratio", "flanks.seed",
    "dynamics.damping_ratio_least", "dynamics.damping_ratio_most", "flanks.parts",
}  # fmt: skip


def test_every_default_is_told_with_its_value_and_what_it_decides(cases: list[GearCase]) -> None:
    units = {"um"} | {kind.shown for kind in KINDS.values()}
    fields = {tuple(a.field for a in case.assumptions) for case in cases}
    assert len(fields) == 1  # the same defaults for every pair
    assert len(set(next(iter(fields)))) == len(next(iter(fields))) > 40
    for case in cases:
        for one in case.assumptions:
            assert "default" in one.reason
            if one.field.startswith(SETTINGS):
                assert PURE.fullmatch(one.value), one
                continue
            assert re.search(r"ecide|counts\b|scale\b", one.reason), one
            if one.field.startswith("model."):
                choice = one.field.removeprefix("model.")
                assert choice == "bundle" or one.value == str(case.models[0].choices()[choice])
            elif one.field in LEFT_OUT:
                assert one.value == "left out"
            elif one.field in UNITLESS:
                assert PURE.fullmatch(one.value), one
            elif one.field not in NAMES:
                unit = one.value.split(",")[0].partition(" ")[2]
                assert unit in units, one


def test_defaults_are_what_their_reasons_say(
    cases: list[GearCase], compared: Callable[..., None]
) -> None:
    bores, gaps, areas = [], [], []
    for case in cases:
        pair = case.pair
        assert math.degrees(pair.pinion.pressure_angle) == pytest.approx(20.0, rel=1e-15)
        bores += [
            gear.bore_radius / (0.3 * gear.root_radius) - 1.0 for gear in (pair.pinion, pair.wheel)
        ]
        # ISO/TR 10064-2: j_bn,min = 2/3 (0.06 + 0.0005 a + 0.03 m), all in mm
        module, distance = 1e3 * pair.pinion.module, 1e3 * pair.centre_distance
        least = 2.0 / 3.0 * (0.06 + 0.0005 * distance + 0.03 * module)
        gaps.append(2e3 * case.cold_backlash.half / least - 1.0)
        # a box 20 mm from the tips, as wide as the face and two shafts of 60 mm
        first, second = 1e3 * pair.pinion.tip_radius, 1e3 * pair.wheel.tip_radius
        box = (distance + first + second + 40.0, 2.0 * max(first, second) + 40.0,
               1e3 * pair.face_width + 120.0)  # fmt: skip
        surface = 2.0 * (box[0] * box[1] + box[0] * box[2] + box[1] * box[2])
        areas.append(1e6 * case.gearbox.surroundings.housing_area / surface - 1.0)
        assert case.accuracy == 6
    compared("bore of five-field cases", "0.3 of the root circle", bores, 1e-12)
    compared("backlash of five-field cases", "ISO/TR 10064-2's least", gaps, 1e-12)
    compared("housing of five-field cases", "a box around the gears", areas, 1e-12)


def test_values_told_are_the_values_that_act(cases: list[GearCase]) -> None:
    for case in cases[:20]:
        told = {a.field: a.value for a in case.assumptions}
        around = case.gearbox.surroundings
        for field, value, digits in (
            ("backlash.value", 2e3 * case.cold_backlash.half, 6),
            ("gears.pinion.bore_radius", 1e3 * case.pair.pinion.bore_radius, 6),
            ("gears.wheel.tip_diameter", 2e3 * case.pair.wheel.tip_radius, 6),
            ("gearbox.housing_area", around.housing_area, 3),
            ("gearbox.housing_mass", around.housing_mass, 3),
            ("gearbox.oil_mass", around.oil_mass, 3),
        ):
            assert told[field].split()[0] == f"{value:.{digits}g}", field


@pytest.mark.parametrize("scale", [0.3, 2.0, 7.0])
def test_the_box_grows_as_the_square_of_length(
    scale: float, monkeypatch: pytest.MonkeyPatch, compared: Callable[..., None]
) -> None:
    def box(by: float) -> tuple[float, float, float]:
        pair = GearPair(
            Gear(20, 3e-3 * by, face_width=30e-3 * by), Gear(40, 3e-3 * by, face_width=30e-3 * by)
        )
        monkeypatch.setattr("thermogear.case.gearbox.CLEAR", CLEAR * by)
        return housing_box(pair, 0.06 * by, 0.3)

    small, large = box(1.0), box(scale)
    # walls of one thickness: the mass goes with the area, the oil with the volume
    grown = [big / (one * scale**power) - 1.0
             for one, big, power in zip(small, large, (2, 2, 3), strict=True)]  # fmt: skip
    compared("housing of a scaled pair", "area and mass as length^2, oil as length^3", grown, 1e-12)
