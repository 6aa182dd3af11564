"""The springs that the loaded contact stores: where one pair carries all, they are the mesh's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating
from thermogear.gears.contact import path_of_contact
from thermogear.gears.deviations import BasePitchDifference, Relief
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.stiffness import Moduli
from thermogear.mesh.elastic import LoadedPair, TextbookPair, elastic_pair
from thermogear.mesh.operating import Temperatures
from thermogear.mesh.thermal import HotPair, ThermalDeviation


@pytest.mark.parametrize("tooth", ["solved", "beam"])
def test_springs_of_the_loaded_pair(tooth: str, rig: GearPair, hot_rig: Operating) -> None:
    """A beam's springs are the textbook's; all in series are the secant stiffness of one pair."""
    cold = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    model = MeshModel.consistent().override(tooth=tooth)
    loaded = elastic_pair(HotPair(rig, cold, model))
    assert isinstance(loaded, LoadedPair)
    s = path_of_contact(rig, 41)
    parts = loaded.parts(s)
    textbook = TextbookPair(loaded.hot).parts(s)
    assert len(parts) == (3 if tooth == "solved" else 9)
    for name, k in parts.items():
        assert np.all(np.isfinite(k) & (k > 0.0))
        if not name.endswith(("body_stiffness", "hertz_stiffness", "gear_stiffness")):
            assert k == pytest.approx(textbook[name], rel=1e-12)
    series = loaded.pair_stiffness(s)
    assert series == pytest.approx(1.0 / sum(1.0 / k for k in parts.values()), rel=1e-12)
    # corner contact lets neighbours help a little outside the single contact's ends
    alone = np.flatnonzero(np.all(loaded.share(s).share > 1.0 - 1e-12, axis=0))
    assert alone.size >= 3
    secant = loaded.solve((s[alone] - rig.path.a) / rig.base_pitch).secant
    assert series[:, alone] == pytest.approx(secant, rel=1e-6)


def test_a_contact_narrows_near_a_tip_in_the_parts_too(rig: GearPair, hot_rig: Operating) -> None:
    """A hotter pinion alone to its tip, whose parts in series are then the mesh's secant."""
    hot = HotPair(rig, hot_rig, MeshModel.consistent())
    loaded = LoadedPair(hot, (BasePitchDifference(2e-3),))
    s = rig.path.e - np.array([0.0, 3e-5, 1e-4, 1e-3])
    assert np.all(loaded.share(s).share > 1.0 - 1e-12)
    secant = loaded.solve((s - rig.path.a) / rig.base_pitch).secant
    assert loaded.pair_stiffness(s) == pytest.approx(secant, rel=1e-9)


def test_each_gear_carries_its_own_modulus_and_deviations_into_the_loaded_contact(
    rig: GearPair, hot_rig: Operating
) -> None:
    """A hot wheel on a cold pinion: the loaded contact asked directly says the same."""
    warm = Temperatures(
        reference=293.15,
        pinion_addendum=293.15,
        pinion_bore=293.15,
        wheel_addendum=413.15,
        wheel_bore=393.15,
        housing=333.15,
    )
    hot = HotPair(rig, replace(hot_rig, temperatures=warm), MeshModel.consistent())
    crest = Relief("wheel", amount=20e-6, length=3e-3)
    loaded = LoadedPair(hot, (crest,))
    phase = np.array([0.1, 0.4, 0.8])
    cold, soft = (hot.moduli(gear) for gear in (rig.pinion, rig.wheel))
    assert np.all(cold[0] == rig.pinion.material.youngs_modulus)
    assert np.all(soft[0] < soft[1])  # the teeth are hotter than the body
    assert np.all(soft[1] < cold[1])
    exact = solve_mesh(
        rig,
        np.full(3, 100.0 / rig.pinion.base_radius),
        phase,
        pinion=Moduli(tooth=cold[0], body=cold[1]),
        wheel=Moduli(tooth=soft[0], body=soft[1]),
        deviations=(crest, ThermalDeviation(hot)),
        model=LoadedModel(body="rim"),
    )
    found = loaded.solve(phase)
    assert np.array_equal(found.deflection, exact.deflection)
    assert np.array_equal(found.share, exact.share)
    curves = loaded.over(phase)
    force = 100.0 / rig.pinion.base_radius
    # tangent: F = k (delta - e); the mean of e is the backlash's
    error = exact.deflection - force / exact.tangent
    assert curves.stiffness == pytest.approx(exact.tangent, rel=1e-12)
    assert curves.spring_error == pytest.approx(
        error - error.mean(axis=1, keepdims=True), abs=1e-15
    )
    shift = exact.unloaded.mean(axis=1, keepdims=True)
    assert curves.transmission_error == pytest.approx(exact.deflection - shift, abs=1e-15)


def test_the_share_goes_on_where_one_pair_enters_and_another_leaves(
    rig: GearPair, hot_rig: Operating
) -> None:
    """Exactly at A, and a base pitch on, it is what it is a hair before and after."""
    cold = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    loaded = elastic_pair(HotPair(rig, cold, MeshModel.consistent()))
    a, pitch = rig.path.a, rig.base_pitch
    for place in (a, a + pitch):
        near = loaded.share(place + pitch * np.array([-1e-7, -1e-11, 0.0, 1e-11, 1e-7])).share
        assert near == pytest.approx(np.broadcast_to(near[:, :1], near.shape), abs=1e-5)
        assert np.all(near > 0.1)
