"""Flanks out of an accuracy grade: bounded by their tolerances, seeded, and what they excite."""

from __future__ import annotations

import math

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.gears.accuracy import flank_tolerances
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import active_profile
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import (
    USED,
    WavyProfile,
    graded_flanks,
    hand_over,
    profile_figures,
)
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.touch import first_touch

PAIR = GearPair(Gear(25, 3e-3, face_width=30e-3), Gear(75, 3e-3, face_width=30e-3))
ROLL = np.linspace(0.0, 1.0, 2001)
PHASE = np.linspace(0.0, 1.0, 401)[:-1]


@pytest.mark.parametrize("waves", [1.0, 2.5, 3.5, 7.3])
def test_a_profile_is_measured_as_it_was_made(waves: float) -> None:
    rng, fine = np.random.default_rng(17), np.linspace(0.0, 1.0, 20001)
    for _ in range(20):
        slope, form = rng.uniform(-20e-6, 20e-6), rng.uniform(1e-6, 20e-6)
        made = WavyProfile(
            "pinion", slope=slope, form=form, waves=waves, phase=rng.uniform(0.0, 6.3)
        )
        found = profile_figures(fine, added=made.added(fine))
        # samples weigh the two ends by h/2 too much: 12 (h/2) (1/2) form on either side,
        # which tilts the line that the form is read from by as much
        assert found.slope == pytest.approx(slope, abs=6.0 / 20000 * form)
        assert found.form == pytest.approx(form, rel=2.0 * 6.0 / 20000)
        assert max(abs(slope), form) * 0.5 < found.total < (abs(slope) + form) * (1.0 + 1e-3)


@pytest.mark.parametrize("edition", ["2013", "1995"])
@pytest.mark.parametrize("grade", [3, 6, 9, 11])
def test_every_flank_keeps_its_tolerances(grade: int, edition: str) -> None:
    for seed in range(40):
        for flank in graded_flanks(PAIR, grade, seed=seed, edition=edition):
            gear = PAIR.pinion if flank.gear == "pinion" else PAIR.wheel
            limit = flank_tolerances(gear.teeth, gear.module, grade=grade, edition=edition)
            found = profile_figures(ROLL, added=flank.added(ROLL))
            assert abs(found.slope) <= limit.profile_slope
            assert found.form <= limit.profile_form * (1.0 + 1e-5)
            assert found.total <= limit.profile_total * (1.0 + 1e-5)
            # and is a flank of this grade, not of one two grades better
            assert found.total > 0.5 * limit.profile_total


def test_seeds_and_sides_differ_and_a_better_grade_is_the_same_flank_smaller() -> None:
    six, again, other, four = (
        graded_flanks(PAIR, grade, seed=seed) for grade, seed in ((6, 1), (6, 1), (6, 2), (4, 1))
    )
    assert six == again
    assert six != other
    assert [(f.gear, f.flank) for f in six] == [
        (gear, flank) for gear in ("pinion", "wheel") for flank in ("drive", "back")
    ]
    assert len({(f.slope, f.phase) for f in six}) == 4
    for coarse, fine in zip(six, four, strict=True):
        assert fine.added(ROLL) == pytest.approx(0.5 * coarse.added(ROLL), rel=1e-12, abs=1e-18)
    signs = {math.copysign(1.0, f.slope) for s in range(20) for f in graded_flanks(PAIR, 6, seed=s)}
    assert signs == {-1.0, 1.0}
    assert USED[1] <= 1.0


def test_material_outside_closes_the_gap_at_the_tip() -> None:
    at = mesh_points(PAIR, PHASE, extended=False).contacts
    for name in ("pinion", "wheel"):
        start, middle, tip = active_profile(PAIR, name)
        flank = WavyProfile(name, slope=10e-6)
        ends = flank.taken_off(PAIR, np.array([start, 0.5 * (start + tip), tip]))
        assert ends == pytest.approx([5e-6, 0.0, -5e-6], abs=1e-15)
        assert start < middle < tip
        assert np.polyfit(at.string(name).ravel(), flank.gap(at).ravel(), 1)[0] < 0.0
        one_side = WavyProfile(name, slope=10e-6, flank="back")
        assert np.array_equal(one_side.gap(at), np.zeros_like(at.s))


@pytest.mark.parametrize("name", ["pinion", "wheel"])
def test_slope_alone_hands_over_in_a_saw_tooth(name: str, compared: Compared) -> None:
    """25/75, m 3, grade 6: 4.4 um at light load, f_Ha p_b/g_a; tip corners round it by 7 %."""
    gear = PAIR.pinion if name == "pinion" else PAIR.wheel
    slope = flank_tolerances(gear.teeth, gear.module, grade=6).profile_slope
    closed = hand_over(PAIR, **{"pinion": 0.0, "wheel": 0.0, name: slope})
    assert 1e6 * closed == pytest.approx(4.4, abs=0.1)
    light, fine = 1.0, np.linspace(0.0, 1.0, 2001)[:-1]
    for sign in (1.0, -1.0):
        flank = [WavyProfile(name, slope=sign * slope)]
        sharp = solve_mesh(PAIR, light, fine, deviations=flank, model=LoadedModel(extended=False))
        compared(
            f"saw-tooth of a profile slope on the {name}",
            "f_Halpha over the contact ratio",
            np.ptp(sharp.deflection) / closed - 1.0,
            0.01,
        )
        rounded = solve_mesh(PAIR, light, PHASE, deviations=flank)
        assert 0.9 * closed < np.ptp(rounded.deflection) <= closed


def test_equal_slopes_of_both_gears_cancel() -> None:
    both = [WavyProfile(name, slope=7e-6) for name in ("pinion", "wheel")]
    met = solve_mesh(PAIR, 1.0, PHASE, deviations=both)
    assert np.ptp(met.deflection) < 0.1e-6
    assert hand_over(PAIR, pinion=7e-6, wheel=7e-6) == 0.0


def test_exchanging_the_gears_changes_nothing() -> None:
    rng = np.random.default_rng(3)
    slopes, forms = rng.uniform(-9e-6, 9e-6, 2), rng.uniform(2e-6, 9e-6, 2)
    pair = GearPair(Gear(23, 3e-3), Gear(31, 3e-3))

    def sides(first: str, second: str) -> list[WavyProfile]:
        return [
            WavyProfile(name, slope=float(s), form=float(f), phase=0.7)
            for name, s, f in zip((first, second), slopes, forms, strict=True)
        ]

    forth = first_touch(mesh_points(pair, PHASE), sides("pinion", "wheel")).gap
    back = first_touch(
        mesh_points(pair.swapped(), -PHASE + pair.contact_ratio), sides("wheel", "pinion")
    ).gap
    # an edge has the lever of its own gear: there the least gap moves by the second order
    assert np.sort(forth.min(axis=-1)) == pytest.approx(np.sort(back.min(axis=-1)), abs=4e-8)


@pytest.mark.parametrize(("module", "teeth", "edition"), [(0.6e-3, (19, 90), "1995"),
                                                      (12e-3, (31, 44), "2013")])  # fmt: skip
def test_no_drawing_leads_by_more_than_its_tolerances(
    module: float, teeth: tuple[int, int], edition: str
) -> None:
    """Unloaded, peak to peak: at most f_Halpha + f_falpha of both gears, whatever the seed."""
    pair = GearPair(*(Gear(z, module) for z in teeth))
    limits = [flank_tolerances(z, module, grade=7, edition=edition) for z in teeth]
    allowed = sum(one.profile_slope + one.profile_form for one in limits)
    points = mesh_points(pair, np.arange(60) / 60.0)
    swings = []
    for seed in range(10):
        flanks = graded_flanks(pair, 7, seed=seed, edition=edition)
        swings.append(float(np.ptp(first_touch(points, flanks).gap.min(axis=-1))))
    assert max(swings) <= allowed
    assert max(swings) > 0.3 * allowed


def test_what_is_refused() -> None:
    for call, message in (
        (
            lambda: WavyProfile("gear", slope=1e-6),
            "profile.gear: got 'gear'; allowed pinion | wheel; known: pinion, wheel",
        ),
        (
            lambda: WavyProfile("wheel", slope=7.0),
            "profile.slope: got 7 m (7e+06 um); allowed -2000..2000 um; did you mean 7e-06 (7 um)?",
        ),
        (
            lambda: WavyProfile("wheel", slope=0.0, waves=0.0),
            "profile.waves: got 0.0; allowed 1..20",
        ),
        (
            lambda: profile_figures([0.0, 0.0, 1.0], added=[0.0, 0.0, 0.0]),
            "profile: got 3 positions; allowed three or more, strictly rising, one trace",
        ),
        (
            lambda: graded_flanks(PAIR, 12, seed=0),
            "accuracy.grade: got 12; allowed a whole number, 1..11; the grades of ISO 1328-1:2013",
        ),
    ):
        with pytest.raises(InputError) as caught:
            call()  # type: ignore[no-untyped-call]
        assert str(caught.value) == message
