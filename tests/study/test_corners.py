"""Tip corners under load: limits, symmetry, and the torque at which a relief is used up."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from thermogear.case.case import GearCase, load_case
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.gears.deviations import Relief
from thermogear.mesh.thermal import HotPair
from thermogear.study.contact import loaded_survey
from thermogear.study.corners import HotContact
from thermogear.study.relief import UNIFORM, one_point

TEXT = """
[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 24
[gears.wheel]
teeth = 24
[operating]
speed = "1000 rpm"
torque = "100 N m"
"""
MOST = 400.0


def read(*changes: str) -> GearCase:
    case = load_case(TEXT, changes)
    assert isinstance(case, GearCase)
    return case


def contact(*changes: str) -> HotContact:
    """Of two equal cold gears without the errors of a class."""
    case = read(*changes)
    reliefs = tuple(one for one in case.deviations if isinstance(one, Relief))
    case = replace(case, deviations=reliefs)
    model = case.models[0].override(stiffness="loaded")
    at = one_point(UNDEFORMED.operating(case, case.models[0]), 100.0)
    return HotContact(HotPair(case.pair, at, model), case.deviations)


def relieved(amount: float, gear: str = "pinion") -> str:
    return f"gears.{gear}.tip_relief={{amount='{amount} um', length='2 mm'}}"


def test_at_light_load_the_effective_contact_ratio_is_the_nominal_one() -> None:
    at = contact()
    torques = np.array([0.02, 2.0, 20.0, 100.0])
    ratio = at.under(torques[None, :], phase=UNIFORM).effective_ratio[0]
    nominal = at.pair.contact_ratio
    # each end of the path to one of the positions
    assert abs(ratio[0] - nominal) < 2.5 / UNIFORM.size
    assert np.all(np.diff(ratio) >= 0.0)
    assert ratio[-1] > nominal + 0.02


def test_the_effective_contact_ratio_is_the_loaded_length_over_the_base_pitch() -> None:
    at = contact(relieved(12.0))
    mesh = at.under(np.array([[60.0]]), phase=UNIFORM)
    s = np.where(mesh.force[0, 0] > 0.0, mesh.points.s, np.nan)
    step = at.pair.base_pitch / UNIFORM.size
    length = np.nanmax(s) - np.nanmin(s) + step
    assert mesh.effective_ratio[0, 0] == pytest.approx(length / at.pair.base_pitch, rel=1e-9)


def test_corners_of_equal_gears_carry_alike() -> None:
    at = contact()
    mesh = at.under(np.array([[100.0]]), phase=np.arange(201) / 201)
    pinion, wheel = mesh.corner_load[0, 0]
    # but for the lever of the pinion's edge, whose torque is given
    assert pinion == pytest.approx(wheel, abs=0.02)
    assert 0.2 < pinion < 0.6
    assert np.ptp(mesh.corner_part[0, 0]) <= 1.0 / 200
    assert at.onset(MOST).tolist() == [[0.0, 0.0]]


def test_a_corner_carries_from_where_the_relief_is_used_up() -> None:
    """The same torque for either gear's relief; below it the pair at the flank's end is free."""
    found = []
    for place, gear in enumerate(("pinion", "wheel")):
        at = contact(relieved(10.0, gear))
        pair, onset = at.pair, at.onset(MOST)[0]
        end = np.array([pair.contact_ratio % 1.0 if gear == "pinion" else 0.0])
        ends = at.under(onset[place] * np.array([[0.99, 1.01]]), phase=end)
        pairs = (ends.force > 0.0).sum(axis=-1)
        assert pairs.ravel().tolist() == [1, 2]
        later = at.under(onset[place] * np.array([[0.99, 1.5]]), phase=UNIFORM).corner_load[
            0, :, place
        ]
        assert later[0] == 0.0 < later[1]
        assert onset[1 - place] == 0.0
        assert math.isnan(at.onset(0.9 * onset[place])[0, place])
        found.append(onset[place])
    assert found[0] == pytest.approx(found[1], rel=1e-3)
    deeper = contact(relieved(15.0)).onset(MOST)[0, 0]
    assert 1.5 * found[0] < deeper < 1.7 * found[0]  # the contact hardens with load


def test_a_rounded_corner_yields_where_its_circle_is_pressed_too_hard() -> None:
    sizes = [f"gears.{gear}.tip_rounding=0.1 mm" for gear in ("pinion", "wheel")]
    at = contact(*sizes)
    torques = np.array([0.5, 5.0, 400.0])
    mesh = at.under(torques[None, :], phase=UNIFORM)
    found = at.yields(mesh)
    assert found[0, 0].tolist() == [False, False]
    assert found[0, -1].tolist() == [True, True]
    sharp = contact()
    assert not sharp.yields(sharp.under(torques[None, :], phase=UNIFORM)).any()


def test_an_edge_of_plastic_is_not_held_to_the_limit_of_steel() -> None:
    """Neither below it, where steel would bear, nor above: what it bears is not known."""
    sizes = [f"gears.{gear}.tip_rounding=0.1 mm" for gear in ("pinion", "wheel")]
    at = contact(*sizes, "gears.pinion.material=POM")
    assert not at.yields(at.under(np.array([[400.0]]), phase=UNIFORM))[..., 0].any()
    words = at.told(5.0)[1]
    assert "POM" in words
    assert "known" not in contact(*sizes).told(5.0)[1]


def test_a_survey_tells_of_the_hot_pair_what_is_told_of_one_load() -> None:
    """Temperatures of a heat balance, six loads: shares, ratio and onset are those of each."""
    case = read()
    model = case.models[0].override(stiffness="loaded")
    hot = loaded_survey(case, (20.0, 40.0, 60.0, 80.0, 100.0, 200.0))["contact"].sel(
        temperature="hot", load=100.0
    )
    at = HotContact(
        HotPair(case.pair, one_point(HOT.operating(case, case.models[0]), 100.0), model),
        case.deviations,
    )
    mesh = at.under(np.array([[100.0]]), phase=UNIFORM)
    for name, expected in (
        ("corner_load_share", mesh.corner_load[0, 0]),
        ("corner_period_share", mesh.corner_part[0, 0]),
        ("effective_contact_ratio", mesh.effective_ratio[0, 0]),
        ("corner_onset_torque", at.onset(100.0)[0]),
    ):
        np.testing.assert_allclose(hot[name].values, expected, rtol=2e-3, atol=1e-12)
    np.testing.assert_allclose(hot["load_share"].values, mesh.share[0, 0], atol=1e-6)


def test_the_edge_of_an_undercut_is_not_told_from_a_tip_corner() -> None:
    case = read("gears.pinion.teeth=12", "gears.pinion.allow_undercut=true")
    assert case.pair.cut_short
    found = loaded_survey(case, (100.0,))
    for name in ("corner_load_share", "corner_period_share", "corner_onset_torque"):
        assert np.isnan(found["contact"][name].values).all()
    codes = [one.code for one in found.notices]
    assert "edge_of_undercut" in codes
    assert "edge_contact_at_most" not in codes
