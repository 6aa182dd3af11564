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
from thermogear.gears.loaded import LoadedMesh, LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import (
    Eccentricity,
    ToothShapes,
    mean_tooth,
    tooth_angle,
    turn_period,
)

LINES = {
    "shaft_1": 35, "shaft_2": 27, "mesh": 945, "mesh_2": 1890, "mesh-shaft_1": 910,
    "mesh+shaft_1": 980, "mesh-shaft_2": 918, "mesh+shaft_2": 972,
}  # fmt: skip
"""Orders of the turn of 27 and 35 teeth."""
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


def pitch_errors(pair: GearPair, pinion: float, wheel: float) -> list[Deviation]:
    """Errors of both gears of so many um, rounded to a nanometre."""
    i, j = np.arange(pair.pinion.teeth), np.arange(pair.wheel.teeth)
    return [
        PitchError("pinion", tuple(1e-6 * np.round(pinion * np.sin(2.3 * i**2), 3))),
        PitchError("wheel", tuple(1e-6 * np.round(wheel * np.cos(1.7 * j**2), 3))),
    ]


def error_of_wheel(pair: GearPair, phase: np.ndarray, devices: list[Deviation]) -> np.ndarray:
    """Unloaded error [um] as the turn of the wheel, which the truth was computed with.

    Beyond E the pinion's advance is that of the wheel over the lever of the corner.
    """
    points = mesh_points(pair, phase)
    point = points.point
    lost = np.where(np.isfinite(point.gap), point.gap, 0.0) * (1.0 - point.lever)
    return np.asarray(1e6 * (first_touch(points, devices).gap - lost).min(axis=-1))


def test_unloaded_error_of_a_hunting_pair() -> None:
    """Pitch errors of 27 and 35 teeth over 945 mesh periods: values, extent, lines."""
    given = TRUTH["T6_unloaded_te_hunting"]
    pair = truth_pair("T6_unloaded_te_hunting")
    devices = pitch_errors(pair, 4.0, 5.0)
    error = error_of_wheel(pair, np.array(given["phases"]), devices)
    assert error == pytest.approx(np.array(given["unloaded_te_um"]), abs=given["tolerance_um"])
    samples = given["samples_per_period"]
    error = error_of_wheel(pair, np.arange(945 * samples) / samples, devices)
    figures = {"peak_to_peak_um": np.ptp(error), "mean_um": error.mean(), "rms_um": error.std()}
    assert figures == pytest.approx({name: given[name] for name in figures}, abs=1e-4)
    lines = 2.0 * np.abs(np.fft.rfft(error)) / error.size
    assert {n: lines[k] for n, k in LINES.items()} == pytest.approx(given["lines_um"], abs=1e-4)


def test_loaded_error_of_pitch_errors_of_both_gears() -> None:
    """12.184 um without load, 13.73 um under 80 N m: 20 and 40 teeth, tooth as a beam."""
    pair = GearPair(Gear(20, 3e-3, face_width=30e-3), Gear(40, 3e-3, face_width=30e-3))
    mesh = solve_mesh(
        pair,
        80.0 / pair.pinion.base_radius,
        np.arange(40 * 96) / 96,
        deviations=pitch_errors(pair, 3.0, 3.5),
        model=LoadedModel(tooth="beam"),
    )
    assert 1e6 * np.ptp(mesh.unloaded) == pytest.approx(12.184, abs=1e-9)
    assert 1e6 * np.ptp(mesh.deflection) == pytest.approx(13.73, abs=0.005)


def test_an_eccentricity_moves_the_loaded_error_alone() -> None:
    """At any load, with any other deviation: forces, edges and stiffness are those without."""
    phase = np.arange(40 * 24) / 24
    others = [*pitch_errors(PAIR, 3.0, 3.5), Relief("pinion", amount=8e-6, length=3e-3)]
    run_out = [
        Eccentricity("pinion", amount=12e-6, angle=0.4),
        Eccentricity("wheel", amount=20e-6, angle=2.0),
    ]
    plain, moved = (
        solve_mesh(PAIR, [100.0, 4e3], phase, deviations=d) for d in (others, [*others, *run_out])
    )
    gap = sum(e.gap(plain.points.contacts)[:, 0] for e in run_out)
    assert moved.deflection - plain.deflection == pytest.approx(
        np.broadcast_to(gap, (2, phase.size)), abs=1e-15
    )
    assert moved.force == pytest.approx(plain.force, rel=1e-9, abs=1e-6)
    assert moved.tangent == pytest.approx(plain.tangent, rel=1e-9)
    assert np.array_equal(moved.edge, plain.edge)


def test_where_one_pair_carries_the_error_moves_by_those_of_its_teeth() -> None:
    phase = np.arange(40 * 24) / 24
    devices = pitch_errors(PAIR, 3.0, 3.5)
    plain, moved = (solve_mesh(PAIR, 4e3, phase, deviations=d) for d in ((), devices))
    alone = (plain.share > 0.999999) & (moved.share > 0.999999)
    position, pair = np.nonzero(alone)
    assert position.size > 100
    gaps = [d.gap(plain.points.contacts) for d in devices]
    expected = (gaps[0] + gaps[1])[position, pair]
    found = (moved.deflection - plain.deflection)[position]
    assert found == pytest.approx(expected, abs=1e-12)


def whole_turn(devices: list[Deviation]) -> LoadedMesh:
    periods = turn_period(PAIR, devices).mesh_periods
    return solve_mesh(PAIR, 4e3, np.arange(24 * periods) / 24, deviations=devices)


def test_renumbering_the_teeth_is_the_same_assembly_or_another() -> None:
    """20 and 40 teeth: the same where 20 divides k_1 - k_2; here 27 mesh periods later."""
    rng = np.random.default_rng(7)
    pitch = [1e-6 * rng.normal(0.0, 3.0, z) for z in (20, 40)]
    slopes = [1e-6 * rng.normal(0.0, 4.0, z) for z in (20, 40)]

    def numbered(*steps: int) -> LoadedMesh:
        devices: list[Deviation] = []
        for name, k, errors, slope in zip(NAMES, steps, pitch, slopes, strict=True):
            z = PAIR.gear(name).teeth
            angle = 0.3 + 2.0 * np.pi * k / z
            shapes = [WavyProfile(name, slope=float(x), form=4e-6) for x in np.roll(slope, k)]
            devices.append(PitchError(name, tuple(np.roll(errors, k))))
            devices.append(Eccentricity(name, amount=9e-6, angle=angle))
            devices.append(ToothShapes(name, tuple(shapes)))
        return whole_turn(devices)

    def figures(mesh: LoadedMesh) -> list[float]:
        error = mesh.deflection
        values = np.ptp(error), error.std(), mesh.tangent.mean(), np.nanmax(mesh.pressure)
        return [float(x) for x in values]

    first, same, other = numbered(0, 0), numbered(7, 27), numbered(5, 0)
    assert figures(same) == pytest.approx(figures(first), rel=1e-9)
    assert same.deflection == pytest.approx(np.roll(first.deflection, 27 * 24), rel=1e-9, abs=1e-15)
    assert abs(np.ptp(other.deflection) / np.ptp(first.deflection) - 1.0) > 0.01


def test_teeth_that_are_all_alike_repeat_one_mesh_period() -> None:
    profile = WavyProfile("wheel", slope=5e-6, form=6e-6, phase=1.0)
    phase = np.arange(24) / 24
    once = solve_mesh(PAIR, 4e3, phase, deviations=[profile])
    alike = [ToothShapes("wheel", (profile,) * 40), PitchError("pinion", (2e-6,) * 20)]
    turn = solve_mesh(PAIR, 4e3, np.arange(24 * 40) / 24, deviations=alike)
    assert turn.deflection.reshape(40, 24) == pytest.approx(
        np.broadcast_to(once.deflection - 2e-6, (40, 24)), rel=1e-9
    )
    assert turn.tangent.reshape(40, 24) == pytest.approx(
        np.broadcast_to(once.tangent, (40, 24)), rel=1e-9
    )
    again = solve_mesh(PAIR, 4e3, phase, deviations=[ToothShapes("wheel", (profile,) * 40)])
    assert np.array_equal(again.deflection, once.deflection)


def test_superposition_where_the_same_pairs_carry() -> None:
    """Linear contact law: errors twice as large move the loaded error twice as far."""
    pair = GearPair(Gear(20, 3e-3, face_width=30e-3), Gear(40, 3e-3, face_width=30e-3))
    phase = np.arange(40 * 24) / 24
    errors = pitch_errors(pair, 3.0, 3.0)
    sets: list[list[Deviation]] = [[], errors[:1], errors[1:], errors, [*errors, *errors]]
    model = LoadedModel(contact="yang-sun")
    solved = [solve_mesh(pair, 60e3, phase, deviations=d, model=model) for d in sets]
    carrying = [mesh.force > 0.0 for mesh in solved]
    same = np.all([c == carrying[0] for c in carrying], axis=(0, 2))
    assert same.mean() > 0.9
    moved = [(mesh.deflection - solved[0].deflection)[same] for mesh in solved]
    scale = float(np.abs(moved[3]).max())
    assert moved[1] + moved[2] == pytest.approx(moved[3], abs=1e-9 * scale)
    assert moved[4] == pytest.approx(2.0 * moved[3], abs=1e-9 * scale)


def test_perfect_eccentric_gears_have_lines_of_shafts_and_mesh_alone() -> None:
    pair = truth_pair("T3_both_eccentric_hunting")
    devices = eccentric("T3_both_eccentric_hunting")[1]
    mesh = solve_mesh(pair, 2e3, np.arange(945 * 16) / 16, deviations=devices)
    lines = 2e6 * np.abs(np.fft.rfft(mesh.deflection)) / mesh.deflection.size
    assert [lines[35], lines[27]] == pytest.approx([10.0, 14.0], abs=1e-9)
    lines[[0, 27, 35, *range(945, lines.size, 945)]] = 0.0
    assert lines.max() < 1e-6


UNDERCUT = GearPair(
    Gear(44, 3e-3, profile_shift=-0.1, tip_rounding=0.25e-3),
    Gear(15, 3e-3, profile_shift=-0.1, tip_rounding=0.25e-3, allow_undercut=True),
)


@pytest.mark.parametrize("pair", [PAIR, UNDERCUT], ids=["plain", "undercut, rounded tips"])
@pytest.mark.parametrize("load", [0.0, 4e3])
def test_teeth_that_differ_touch_as_first_touch_has_each_pair_of_teeth(
    pair: GearPair, load: float
) -> None:
    """Within 20 nm where a pair may carry; half a per cent of the whole error is twice that."""
    rng = np.random.default_rng(11)
    devices = []
    for name in NAMES:
        z = pair.gear(name).teeth
        slopes, phases = 1e-6 * rng.normal(2.0, 2.0, z), rng.normal(0.0, 0.75, z)
        profiles = [
            WavyProfile(name, slope=float(a), form=5e-6, waves=2.5, phase=float(b), flank="drive")
            for a, b in zip(slopes, phases, strict=True)
        ]
        devices.append(ToothShapes(name, tuple(profiles)))
    relief = Relief("wheel", amount=8e-6, length=2e-3)
    spread = 4.0 * load / (np.pi * pair.face_width * 115e9)
    phase, start = np.arange(24) / 24, 57
    found = first_touch(mesh_points(pair, start + phase), [*devices, relief], spread)
    several = mesh_points(pair, np.arange(2 * 24) / 24 + start - 1)
    assert np.array_equal(first_touch(several, [*devices, relief], spread).gap[24:], found.gap)
    for rank in range(found.gap.shape[1]):
        number = start + 1 - rank
        teeth = [d.shapes[number % len(d.shapes)] for d in devices]
        exact = first_touch(mesh_points(pair, phase), [*teeth, relief], spread).gap[:, rank]
        near = exact < 20e-6
        assert np.array_equal(np.isfinite(exact), np.isfinite(found.gap[:, rank]))
        assert found.gap[near, rank] == pytest.approx(exact[near], abs=20e-9)


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
