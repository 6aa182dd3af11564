"""Figures of the cycle against the curves they are taken from, and the choices at work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating, mesh_cycle
from thermogear.base.materials import lubricant
from thermogear.gears.contact import path_of_contact
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.heat.friction import LAWS, friction_law
from thermogear.heat.losses import churning_loss
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.mesh.balance import Gearbox, _aitken, heat_balance
from thermogear.mesh.elastic import TextbookPair, elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.thermal import HotPair

TEXTBOOK = MeshModel.consistent().override(stiffness="textbook-30-degree", sharing="stiffness")


def test_figures_of_the_stiffness_are_those_of_its_curve(rig: GearPair, hot_rig: Operating) -> None:
    for model in (MeshModel.consistent(), MeshModel.thesis()):
        cycle = mesh_cycle(rig, hot_rig, model, mesh_positions=120)
        curve = cycle["mesh_stiffness"].values
        assert curve == pytest.approx(
            cycle["elastic_stiffness"].values + cycle["thermal_stiffness"].values, rel=1e-14
        )
        top, bottom = curve.max(axis=1), curve.min(axis=1)
        assert cycle["peak_to_peak_stiffness"].values == pytest.approx(top - bottom, rel=1e-12)
        assert cycle["mid_range_stiffness"].values == pytest.approx((top + bottom) / 2, rel=1e-12)
        assert cycle["mean_stiffness"].values == pytest.approx(curve.mean(axis=1), rel=1e-12)
        gap = cycle["half_backlash_curve"].values
        assert cycle["half_backlash"].values == pytest.approx(gap.mean(axis=1), rel=1e-12)


def test_springs_of_a_textbook_pair_in_series_are_its_stiffness(
    rig: GearPair, hot_rig: Operating
) -> None:
    pair = elastic_pair(HotPair(rig, hot_rig, TEXTBOOK))
    assert isinstance(pair, TextbookPair)
    s = path_of_contact(rig, 31)
    parts = pair.parts(s)
    assert len(parts) == 9
    series = sum(1.0 / k for k in parts.values())
    assert 1.0 / series == pytest.approx(pair.pair_stiffness(s), rel=1e-12)


def test_transmission_error_of_a_cold_pair_is_the_deflection_of_its_teeth(
    rig: GearPair, hot_rig: Operating
) -> None:
    """Nothing but elasticity: the loaded contact's deflection, or force over textbook stiffness."""
    cold = replace(hot_rig, temperatures=hot_rig.temperatures.cold())
    cycle = mesh_cycle(rig, cold, mesh_positions=60)
    phase = np.arange(60) / 60
    force = 100.0 / rig.pinion.base_radius
    solved = solve_mesh(rig, force, phase, model=LoadedModel(body="rim"))
    for row in cycle["transmission_error"].values:
        assert row == pytest.approx(solved.deflection, rel=1e-9)
    springs = mesh_cycle(rig, cold, TEXTBOOK, mesh_positions=60)
    product = springs["transmission_error"].values * springs["mesh_stiffness"].values
    assert product == pytest.approx(np.full_like(product, force), rel=1e-12)


@pytest.mark.parametrize("name", LAWS)
def test_the_chosen_friction_law_is_the_one_at_work(
    rig: GearPair, hot_rig: Operating, name: str
) -> None:
    path = FrictionPath(
        elastic_pair(HotPair(rig, hot_rig, TEXTBOOK.override(friction=name))),
        path_of_contact(rig, 21),
    )
    if name == "dry":
        assert np.all(path.friction == path.hot.model.dry_coefficient)
    else:
        assert np.array_equal(path.friction, friction_law(name)(path.state))
        assert not np.array_equal(path.friction, path.dry)


def test_churning_is_that_of_the_wheel_as_deep_as_it_dips(rig: GearPair) -> None:
    for depth in (0.0, 0.3, 0.6):
        found = heat_balance(
            rig,
            200.0,
            100.0,
            lubricant("M100"),
            125e-6,
            TEXTBOOK,
            gearbox=Gearbox(immersion=depth),
            path_positions=31,
        )
        warm = found.operating.oil_temperature
        expected = churning_loss(
            200.0 / 3.0,
            rig.wheel.tip_radius,
            density(found.operating.lubricant, warm),
            kinematic_viscosity(found.operating.lubricant, warm),
            depth,
        )
        assert np.asarray(found.losses.churning) == pytest.approx(expected, rel=1e-12)
        assert (float(expected[0]) > 0.0) == (depth > 0.0)


def test_relaxation_is_exact_for_one_straight_unknown_and_keeps_its_factor_on_no_news() -> None:
    """x' = x + f c with c = a (x* - x): Aitken's next factor is 1/a. Source: Aitken 1926."""
    slope = np.array([0.5, 1.6, -0.4])
    before = slope * 3.0
    after = before - slope * before  # after a full step
    found = _aitken(np.ones(3), before[:, None], after[:, None])
    assert found == pytest.approx(1.0 / slope, rel=1e-12)
    same = np.array([[1.0, 2.0], [0.0, 3.0]])
    assert _aitken(np.array([0.7, 1.2]), same, same).tolist() == [0.7, 1.2]
    unknown = np.full((2, 2), np.nan)
    assert _aitken(np.array([0.7, 1.2]), unknown, same).tolist() == [0.7, 1.2]
