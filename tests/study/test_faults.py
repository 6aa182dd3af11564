"""Motion with faults beside that without: exact orbits, shifts, none, parts of a series."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.family import family
from thermogear.case.points import points_of
from thermogear.mesh.elastic import TURN_POSITIONS, LoadedPair, turn_phases
from thermogear.mesh.series import series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Result
from thermogear.study import faults
from thermogear.study.declared import ReliefSurvey, Sensitivity, declared
from thermogear.study.faults import FaultMotion, fault_motions, resolving
from thermogear.study.friction import friction_survey
from thermogear.study.series import Series, series_parts

TEXT = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 14
[gears.wheel]
teeth = 28
[flanks]
accuracy = 6
seed = 1
[oil]
temperature = "60 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[gears.rack]
dedendum = 1.25
"""
SPEEDS = np.array([300.0, 900.0])


def faulty(tooth: int = 1, kind: str = "crack", size: str = 'depth = "1 mm"') -> GearCase:
    text = TEXT.replace("[gears]", "[gears]", 1).replace(
        "[gears.pinion]\nteeth = 14", "[gears.pinion]\nteeth = 14\nprofile_shift = 0.3"
    )
    fault = f'[[faults]]\nkind = "{kind}"\ngear = "pinion"\ntooth = {tooth}\n{size}'
    slope = '\nangle = "60 deg"' if kind == "crack" else ""
    return gear_case(load_case(text + fault + slope))


@pytest.fixture(scope="module")
def motions() -> tuple[FaultMotion, ...]:
    return fault_motions(faulty(), SPEEDS, 80.0)


@pytest.mark.parametrize(
    ("kind", "size"), [("crack", 'depth = "1e-9 mm"'), ("pitch", 'amount = "1e-6 um"')]
)
def test_a_vanishing_fault_adds_nothing(kind: str, size: str) -> None:
    """The sound pair is on the positions of the turn: its own of one mesh period added 5 to 60 %.

    What is left is that of rounded Fourier coefficients.
    """
    for motion in fault_motions(faulty(kind=kind, size=size), SPEEDS, 80.0, state="undeformed"):
        added = motion.faulty.acceleration - motion.sound.acceleration
        assert np.std(added) < 1e-4 * np.std(motion.sound.acceleration)


def test_both_motions_are_orbits_of_the_exact_engine(motions: tuple[FaultMotion, ...]) -> None:
    """Events to rounding, one shooting over the turn, the sound pair over one mesh period."""
    for case, name in ((faulty(), "faulty"), (faulty().sound(), "sound")):
        for place, motion in enumerate(getattr(one, name) for one in motions):
            # the first is at 1/14 of the speed at which the mesh meets the natural frequency
            fine = resolving(case, 1 - place)
            point = family(fine, ("pinion_speed", "pinion_torque"))(
                np.array([[SPEEDS[place], 80.0]])
            )
            assert motion.samples == (192, 96)[place]
            own, k = motion.samples, point.mesh_periods
            assert motion.mesh_periods == 14
            assert motion.repeats
            assert motion.turns == 1
            orbit = periodic_orbit(point, 1, [1.0, 0.0])
            phase, x, _ = orbit.samples(own)
            dte = point.length[0] * x + point.kinematic(phase / k)[0]
            error = np.abs(motion.error - np.tile(dte, 14 // k)).max() / np.ptp(dte)
            print(f"{name}, {SPEEDS[place]} rad/s: {error:.1e} of the travel")
            assert error < 1e-3
            b = point.flat.half_backlash[0]
            stiffness = point.flat.values("stiffness", phase / k)[:, 0]
            force = point.stiffness[0] * point.length[0] * stiffness * (x - np.clip(x, -b, b))
            assert motion.mesh_force == pytest.approx(
                np.tile(force, 14 // k), abs=1e-3 * point.force[0]
            )


def test_a_slow_pair_is_followed_up_to_its_natural_frequency(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Twice as many positions change nothing; 24 harmonics hold no line of the natural vibration.

    96 positions with 24 harmonics were 50 to 90 % off such an acceleration.
    """
    case = faulty()
    alike = family(case.sound().mean_tooth(), ("pinion_speed",), state="undeformed")
    natural = float(alike(np.array([[120.0]])).rate[0]) / 14 / 120.0
    found = []
    for positions in (10, 20):
        monkeypatch.setattr(faults, "POSITIONS", positions)
        found += fault_motions(case, 120.0, 80.0, state="undeformed")
    for name in ("faulty", "sound"):
        one, two = (getattr(motion, name) for motion in found)
        off = np.std(one.acceleration - two.acceleration) / np.std(two.acceleration)
        print(f"{name}: twice the positions change {off:.1e}")
        assert off < 0.05
        spectrum = one.lines()
        ringing = abs(spectrum.frequencies / natural - 1.0) < 0.1
        assert 0.9 * natural > 24.0
        assert spectrum.frequencies[-1] > 2.0 * natural
        assert spectrum.amplitudes[ringing].max() > 0.5 * spectrum.amplitudes.max()


def test_acceleration_is_the_second_derivative(motions: tuple[FaultMotion, ...]) -> None:
    for motion in (one for pair in motions for one in (pair.faulty, pair.sound)):
        seconds = 2.0 * np.pi / (motion.speed * 14 * motion.samples)
        rates = 2j * np.pi * np.fft.rfftfreq(motion.error.size, seconds)
        bent = np.fft.irfft(np.fft.rfft(motion.error) * rates**2, motion.error.size)
        assert np.std(bent - motion.acceleration) < 5e-3 * np.std(bent)
        assert abs(motion.acceleration.mean()) < 1e-4 * np.std(bent)
        assert motion.pinion_angle[-1] == pytest.approx(2 * np.pi, rel=1e-3)
        assert motion.wheel_angle[-1] == pytest.approx(np.pi, rel=1e-3)
        spectrum = motion.lines()
        assert spectrum.amplitudes @ spectrum.amplitudes / 2 == pytest.approx(
            motion.acceleration.var(), rel=1e-6
        )
    faults, none = motions[0].faulty.lines(), motions[0].sound.lines()
    between = np.flatnonzero(abs(none.frequencies - np.round(none.frequencies)) > 0.01)
    # a sound pair has lines of the mesh alone, the fault puts shaft orders between them
    assert none.amplitudes[between].max() < 1e-6 * none.amplitudes.max()
    assert faults.amplitudes[between].max() > 1e-3 * none.amplitudes.max()


def test_another_tooth_is_the_same_motion_later(motions: tuple[FaultMotion, ...]) -> None:
    later = fault_motions(faulty(tooth=6), SPEEDS, 80.0)
    for one, two in zip(motions, later, strict=True):
        moved = np.roll(one.faulty.mesh_force, 5 * one.faulty.samples)
        assert two.faulty.mesh_force == pytest.approx(moved, rel=1e-5)
        assert np.array_equal(two.sound.mesh_force, one.sound.mesh_force)


def test_no_size_is_the_sound_motion_to_the_last_digit() -> None:
    (one,) = fault_motions(faulty(size='depth = "0 mm"'), 900.0, 80.0, samples=32)
    for name in ("acceleration", "mesh_force", "error"):
        assert np.array_equal(getattr(one.faulty, name), getattr(one.sound, name))


def test_every_part_of_a_series_has_the_fault() -> None:
    """Parts side by side, engines of series and of single pairs, one tooth and the whole turn."""
    case = faulty()
    hot = HotPair(case.pair, replace(case.operating, housing=case.housing), case.models[0])
    parts = series_parts(case, 2)
    mesh = Series.of(case, 2).mesh(hot)
    phase = turn_phases(28, np.arange(TURN_POSITIONS) / TURN_POSITIONS)
    for number, part in enumerate(parts):
        alone = LoadedPair(hot, part).over(phase[:TURN_POSITIONS])
        assert mesh.stiffness[number] == pytest.approx(alone.stiffness[0], rel=1e-9)
        error = alone.transmission_error[0]
        assert mesh.transmission_error[number] == pytest.approx(
            error - error.mean(), abs=1e-9 * np.ptp(error) + 1e-14
        )
    # another start is another tooth of the fault in each part
    two = series_mesh(hot, [parts[0], parts[0]], 28, start=[0, 3])
    assert two.stiffness[1] == pytest.approx(
        np.roll(two.stiffness[0], -3 * TURN_POSITIONS), rel=1e-9
    )
    points = points_of(family(case, ("pinion_speed",)).excitations(np.array([[900.0]])))
    assert points.mesh_periods == 14
    motion = fault_motions(case, 900.0, 80.0, part=1)[0]
    assert motion.faulty.mesh_periods == motion.sound.mesh_periods == 28
    point = family(case, ("pinion_speed",)).excitations(np.array([[900.0]]))
    followed = Series.of(case, 2).followed(hot, point, np.array([900.0]), own_speed=900.0)
    factor = np.abs(motion.faulty.mesh_force).max() / motion.faulty.mesh_force.mean()
    assert followed.motion.dynamic_factor[0, 1, 0] == pytest.approx(factor, rel=0.02)


def test_what_studies_say_of_faults() -> None:
    case = faulty()
    taken = friction_survey(case).notices[0]
    assert taken.code == "fault_taken"
    assert case.faults()[0] in taken.text
    for study in (ReliefSurvey, Sensitivity):
        given: list[GearCase] = []

        @declared(study)
        def asked(case: GearCase, given: list[GearCase] = given) -> Result:
            given.append(case)
            return Result.of("asked", "", {})

        told = asked(case).notices
        assert [one.code for one in told if one.code.startswith("fault")] == ["fault_left_out"]
        assert given[0].all_faults == []


def test_refusals_and_points_that_do_not_move() -> None:
    case = faulty()
    with pytest.raises(InputError, match=r"faults: got none; state \[\[faults\]\]"):
        fault_motions(case.sound())
    with pytest.raises(InputError, match="samples: got 100; allowed a divisor of 192"):
        fault_motions(case, samples=100)
    textbook = gear_case(load_case(case.text, {"model.stiffness": "textbook-30-degree"}))
    with pytest.raises(InputError, match=r"model\.stiffness: got textbook-30-degree"):
        fault_motions(textbook)
    tight = {"backlash": '{value = "1 um", direction = "normal", extent = "total"}'}
    (jammed,) = fault_motions(gear_case(load_case(case.text, tight)), samples=16)
    assert jammed.faulty.status == "jammed"
    assert np.isnan(jammed.faulty.acceleration).all()
