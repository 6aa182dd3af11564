"""Deviations of the flanks: signs, shapes, teeth, and what does not fit."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.base.errors import GeometryError, InputError
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import (
    BasePitchDifference,
    FlankTable,
    PathTable,
    PitchError,
    PressureAngleError,
    Relief,
    active_profile,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import solve_mesh
from thermogear.gears.pair import GearPair

PAIR = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
PHASE = np.linspace(0.0, 0.99, 34)


def contacts(flank: str = "drive", phase: np.ndarray = PHASE):  # type: ignore[no-untyped-def]
    return mesh_points(PAIR, phase, flank).contacts


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
@pytest.mark.parametrize("end", ["tip", "root"])
def test_relief_is_full_at_its_end_and_nothing_at_its_start(gear: str, end: str) -> None:
    at = contacts()
    start, _, tip = active_profile(PAIR, gear)
    rho = at.string(gear)
    linear = Relief(gear, amount=12e-6, length=4e-3, end=end).gap(at)
    square = Relief(gear, amount=12e-6, length=4e-3, end=end, shape="parabolic").gap(at)
    inside = (rho > start + 4e-3) & (rho < tip - 4e-3)
    assert np.array_equal(linear[inside], np.zeros(inside.sum()))
    assert linear.max() <= 12e-6
    assert np.allclose(square, linear**2 / 12e-6)
    edge = tip if end == "tip" else start
    away = np.abs(rho - edge)
    near = (away < 4e-3) & (rho <= tip) & (rho >= start)
    assert np.allclose(linear[near], 12e-6 * (1 - away[near] / 4e-3))


def test_wheel_tip_relief_eases_the_entry_and_pinion_tip_relief_the_exit() -> None:
    plain = solve_mesh(PAIR, 5e3, np.array([0.05, 0.65]))
    wheel = solve_mesh(
        PAIR, 5e3, np.array([0.05, 0.65]), deviations=[Relief("wheel", amount=8e-6, length=4e-3)]
    )
    pinion = solve_mesh(
        PAIR, 5e3, np.array([0.05, 0.65]), deviations=[Relief("pinion", amount=8e-6, length=4e-3)]
    )
    entering, leaving = 1, 2
    assert wheel.share[0, entering] < plain.share[0, entering]
    assert pinion.share[1, leaving] < plain.share[1, leaving]


def test_flank_choice() -> None:
    only = Relief("pinion", amount=10e-6, length=4e-3, flank="back")
    assert np.array_equal(only.gap(contacts("drive")), np.zeros((34, 4)))
    assert only.gap(contacts("back")).max() > 5e-6


def test_a_deviation_of_the_other_flank_is_none() -> None:
    at, none = contacts("drive"), np.zeros((34, 4))
    radius = [PAIR.wheel.form_radius, PAIR.wheel.tip_radius]
    for device in (
        PressureAngleError("wheel", 1e-4, flank="back"),
        FlankTable("wheel", radius=radius, added=[1e-6, 2e-6], flank="back"),
        PathTable(s=[0.0, 0.1], added=[1e-6, 2e-6], flank="back"),
    ):
        assert np.array_equal(device.gap(at), none)
        assert np.abs(device.gap(contacts("back"))).max() > 0.0


def test_pitch_error_follows_its_tooth() -> None:
    """Tooth 3 of the pinion joins the mesh in period 3 and carries more while it is in."""
    errors = [0.0] * 25
    errors[3] = 5e-6
    device = PitchError("pinion", tuple(errors))
    for period in (3, 28, 3 - 25):
        at = contacts(phase=period + np.array([0.25]))
        assert at.pinion_tooth[0, 1] == 3
        assert np.allclose(device.gap(at), [[0.0, -5e-6, 0.0, 0.0]])
    plain = solve_mesh(PAIR, 5e3, np.array([3.25]))
    early = solve_mesh(PAIR, 5e3, np.array([3.25]), deviations=[device])
    assert early.share[0, 1] > plain.share[0, 1] + 0.1


def test_pitch_error_has_the_other_sign_on_the_back_flank() -> None:
    errors = tuple(1e-6 * k for k in range(75))
    drive = PitchError("wheel", errors).gap(contacts("drive"))
    back = PitchError("wheel", errors).gap(contacts("back"))
    assert drive.max() <= 0.0
    assert back.min() >= 0.0


def test_back_flank_of_a_tooth_mirrors_its_drive_flank() -> None:
    """The same pinion tooth stands at s on one line and at 2 s_C + p_b/2 - s on the other."""
    drive, back = contacts("drive"), contacts("back")
    for i in range(PHASE.size):
        for tooth in set(drive.pinion_tooth[i]) & set(back.pinion_tooth[i]):
            s = drive.s[i][drive.pinion_tooth[i] == tooth][0]
            mirrored = back.s[i][back.pinion_tooth[i] == tooth][0]
            assert s + mirrored == pytest.approx(2 * PAIR.path.c + 0.5 * PAIR.base_pitch, abs=1e-12)


def test_pressure_angle_error_is_another_base_circle() -> None:
    """S of the involute of r_b (1 + k) over that of r_b grows as k rho."""
    error = 1e-4
    at = contacts()
    gap = PressureAngleError("pinion", error).gap(at)
    slope = np.polyfit(at.pinion.ravel(), gap.ravel(), 1)[0]
    alpha = PAIR.pinion.pressure_angle
    ratio = math.cos(alpha + error) / math.cos(alpha) - 1.0
    assert slope == pytest.approx(-ratio, rel=2e-4)
    both = gap + PressureAngleError("wheel", error).gap(at)
    on_path = (at.s > PAIR.path.a) & (at.s < PAIR.path.e)
    # the same error on both gears cancels on the path of contact
    assert np.abs(both[on_path]).max() < 1e-15


def test_tables_reproduce_the_formulas_they_sample() -> None:
    at = contacts()
    strain = 2e-4
    s = np.linspace(-0.02, PAIR.line_of_action, 5)
    table = PathTable(s=s, added=strain * (s - PAIR.path.c))
    # off the path a tip touches, and nothing grows beyond it
    on = at._replace(s=np.clip(at.s, PAIR.path.a, PAIR.path.e))
    assert np.allclose(table.gap(on), BasePitchDifference(strain).gap(at), rtol=0, atol=1e-18)
    radius = np.linspace(PAIR.wheel.form_radius, PAIR.wheel.tip_radius, 400)
    added = 1e-6 * (radius / PAIR.wheel.tip_radius) ** 2
    flank = FlankTable("wheel", radius=radius, added=np.stack([added, 2 * added]))
    gap = flank.gap(at)
    r = np.hypot(PAIR.wheel.base_radius, at.wheel)
    exact = -1e-6 * (np.clip(r, radius[0], radius[-1]) / PAIR.wheel.tip_radius) ** 2
    assert gap.shape == (2, *at.s.shape)
    assert np.allclose(gap, np.stack([exact, 2 * exact]), rtol=1e-6)


def test_base_pitch_difference_takes_operating_points() -> None:
    gap = BasePitchDifference(np.array([[1e-4], [2e-4]])).gap(contacts())
    assert gap.shape == (2, 1, 34, 4)
    assert np.allclose(gap[1], 2 * gap[0])


def test_what_does_not_fit() -> None:
    with pytest.raises(GeometryError) as caught:
        Relief("pinion", amount=10e-6, length=30e-3).gap(contacts())
    assert str(caught.value) == (
        "pinion.relief.length: got 30 mm; allowed <= 25.3061 mm; "
        "the tip relief is longer than the active profile"
    )
    for call, text in (
        (
            lambda: Relief("gear", amount=1e-6, length=1e-3),
            "relief.gear: got 'gear'; allowed pinion | wheel",
        ),
        (
            lambda: Relief("wheel", amount=-1e-6, length=1e-3),
            "relief.amount: got -1e-06 m (-1 um); allowed 0..1000 um",
        ),
        (
            lambda: Relief("wheel", amount=1e-6, length=0.0),
            "relief.length: got 0 m (0 mm); allowed 0.01..1000 mm",
        ),
        (
            lambda: PitchError("wheel", (1e-6,)).gap(contacts()),
            "wheel.pitch_error.errors: got 1 values; allowed one for each of the 75 teeth",
        ),
        (
            lambda: PitchError("wheel", (math.nan,)),
            "pitch_error.errors: got nan m; allowed -1000..1000 um",
        ),
        (
            lambda: mesh_points(PAIR, np.zeros((2, 2))),
            "phase: got shape (2, 2); allowed one axis of finite numbers",
        ),
        (
            lambda: PressureAngleError("wheel", 1.0),
            "pressure_angle_error.error: got 1 rad (57.2958 deg); allowed -1.1..1.1 deg",
        ),
        (
            lambda: FlankTable("wheel", radius=[1.0, 0.5], added=[0.0, 0.0]),
            "flank_table.radius: got 2 values; allowed two or more, strictly rising",
        ),
        (
            lambda: FlankTable("wheel", radius=[0.5, 1.0], added=[0.0, math.nan]),
            "flank_table.added: got shape (2,); allowed (..., 2), finite",
        ),
    ):
        with pytest.raises(InputError) as error:
            call()  # type: ignore[no-untyped-call]
        assert str(error.value).startswith(text)
