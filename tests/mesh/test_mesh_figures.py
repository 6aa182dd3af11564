"""Figures of the cycle against the curves they are taken from, and the choices at work."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import GearPair, MeshModel, Operating, mesh_cycle
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import ZERO_CELSIUS, lubricant
from thermogear.gears.contact import path_of_contact
from thermogear.gears.loaded import solve_mesh
from thermogear.heat.friction import LAWS, ROUGHNESS_LIMIT, friction_law
from thermogear.heat.losses import churning_loss
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.mesh.balance import Gearbox, broyden, heat_balance
from thermogear.mesh.elastic import TextbookPair, elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import mesh_heat
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
    solved = solve_mesh(rig, force, phase)
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


def test_broyden_meets_the_last_step_and_leaves_alone_what_it_says_nothing_about() -> None:
    """H y = s, and H u as it was for u at right angles to H^T s; no news changes nothing.

    Source: Broyden 1965.
    """
    random = np.random.default_rng(4)
    inverse = np.eye(3) + 0.2 * random.standard_normal((2, 3, 3))
    fell, moved = random.standard_normal((2, 2, 3))
    new = broyden(inverse, fell=fell, moved=moved)
    assert np.einsum("ijk,ik->ij", new, fell) == pytest.approx(moved, rel=1e-12)
    row = np.einsum("ij,ijk->ik", moved, inverse)
    aside = np.cross(row, fell)
    for matrix in (new, inverse):
        kept = np.einsum("ijk,ik->ij", matrix, aside)
        assert kept == pytest.approx(np.einsum("ijk,ik->ij", inverse, aside), rel=1e-10)
    still, unknown = np.zeros((2, 3)), np.full((2, 3), np.nan)
    assert np.array_equal(broyden(inverse, fell=fell, moved=still), inverse)
    assert np.array_equal(broyden(inverse, fell=unknown, moved=unknown), inverse)


@pytest.mark.parametrize("flank", ["growth", "thesis"])
def test_a_warm_housing_takes_what_it_opens_off_the_added_material(
    rig: GearPair, hot_rig: Operating, flank: str
) -> None:
    """Da sin(alpha_w), whether as a distance or as a strain of both flanks: 80 K on steel."""
    s = path_of_contact(rig, 11)
    rigid, warm = (
        HotPair(rig, hot_rig, MeshModel.consistent().override(flank=flank, housing=housing))
        for housing in ("rigid", "expands")
    )
    opening = 11.5e-6 * 80.0 * rig.centre_distance * np.sin(rig.operating_pressure_angle)
    assert warm.axis_opening() == pytest.approx(np.full(3, opening), rel=1e-12)
    assert rigid.axis_opening().tolist() == [0.0, 0.0, 0.0]
    gone = rigid.added_material(s) - warm.added_material(s)
    assert gone == pytest.approx(np.full((3, 11), opening), rel=1e-9)
    # the thesis counts half of each flank
    part = 0.5 if flank == "thesis" else 1.0
    assert rigid.added_material(s) == pytest.approx(part * np.add(*rigid.growth(s)), rel=1e-12)
    # both gears a kelvin hotter add the same everywhere, what they were before
    steps = [rigid.warmed(rise).added_material(s) - rigid.added_material(s) for rise in (1.0, 3.0)]
    assert steps[1] == pytest.approx(3.0 * steps[0], rel=1e-9)
    assert rigid.warmed(2.0).temperatures.housing == rigid.temperatures.housing


def test_mixed_friction_has_no_value_from_its_roughness_limit_on(
    rig: GearPair, hot_rig: Operating
) -> None:
    s = path_of_contact(rig, 11)
    for roughness, known in ((0.999, True), (1.0, False), (1.5, False)):
        gears = (replace(g, roughness=roughness * ROUGHNESS_LIMIT) for g in (rig.pinion, rig.wheel))
        path = FrictionPath(elastic_pair(HotPair(GearPair(*gears), hot_rig, TEXTBOOK)), s)
        assert np.isfinite(path.mixed).all() == known
        assert np.isnan(path.mixed).all() != known
        assert np.all(np.isfinite(path.flash(path.dry)))
        assert np.isnan(path.flash(path.mixed)).all() != known


def test_path_of_friction_by_hand(rig: GearPair, hot_rig: Operating) -> None:
    """Line load, Hertz, flash and power from the definitions; the mean over pairs by summing."""
    model = TEXTBOOK.override(friction="dry", sharing="equal")
    s = path_of_contact(rig, 2001)
    path = FrictionPath(elastic_pair(HotPair(rig, hot_rig, model)), s)
    force = 100.0 / rig.pinion.base_radius
    assert path.line_load == pytest.approx(path.share * force / rig.face_width, rel=1e-14)
    # Hertz: p B pi/2 is the line load, B = 4 p R/(2 E*)
    carried = path.line_load > 0.0
    assert (0.5 * np.pi * path.pressure * path.half_width) == pytest.approx(
        path.line_load, rel=1e-12
    )
    assert path.half_width[carried] == pytest.approx(
        (2.0 * path.pressure * path.radius / path.elastic.contact_modulus)[carried], rel=1e-12
    )
    omega = hot_rig.speed[:, None]
    sliding = np.abs(omega * s - omega / rig.ratio * (rig.line_of_action - s))
    mu = model.dry_coefficient
    assert path.heat == pytest.approx(mu * path.line_load * sliding, rel=1e-10)
    assert path.flash(2.0 * path.friction) == pytest.approx(2.0 * path.flash(path.friction))
    # the pairs in contact at a phase stand a base pitch apart: their mean heat is the power
    means = mesh_heat(path.elastic)
    power, share = means.power, means.partition
    phases = np.arange(4000) / 4000 * rig.base_pitch + rig.path.a
    at = phases[:, None] + rig.base_pitch * np.arange(2)
    for point in range(3):
        heat = np.interp(at, s, path.heat[point], right=0.0)
        assert power[point] == pytest.approx(heat.sum(axis=1).mean() * rig.face_width, rel=2e-3)
        into = np.interp(at, s, (path.heat * path.heat_share)[point], right=0.0)
        assert share[point] == pytest.approx(into.sum() / heat.sum(), rel=2e-3)
    assert np.all((path.heat_share > 0.0) & (path.heat_share < 1.0))
    # at the pitch point one pair carries all, both flanks roll at v_t sin(alpha_w)
    pitch = path.state.pitch_point
    assert pitch.line_load == pytest.approx(np.full((3, 1), force / rig.face_width), rel=1e-14)
    rolling = omega * rig.pinion.pitch_radius * np.sin(rig.operating_pressure_angle)
    assert pitch.sum_speed == pytest.approx(2.0 * rolling, rel=1e-12)
    c = rig.path.c
    assert pitch.reduced_radius == pytest.approx(
        c * (rig.line_of_action - c) / rig.line_of_action, rel=1e-12
    )
    assert pitch.face_width == rig.face_width
    still = mesh_heat(elastic_pair(HotPair(rig, replace(hot_rig, speed=np.zeros(3)), model)))
    assert (still.power.tolist(), still.partition.tolist()) == ([0.0] * 3, [0.5] * 3)
    assert still.conductance.tolist() == [0.0] * 3


def test_the_inlet_is_as_warm_as_its_choice_says(rig: GearPair, hot_rig: Operating) -> None:
    heat = replace(
        hot_rig.temperatures, pinion_addendum=np.array([400.0, 410.0, 420.0]), wheel_addendum=380.0
    )
    point = replace(hot_rig, temperatures=heat)
    s = path_of_contact(rig, 5)
    for inlet, expected in (
        ("body", [[390.0], [395.0], [400.0]]),
        ("oil", [[float(point.oil_temperature)]] * 3),  # type: ignore[arg-type]
    ):
        path = FrictionPath(elastic_pair(HotPair(rig, point, TEXTBOOK.override(inlet=inlet))), s)
        assert path.inlet_temperature.tolist() == expected
        rough = 1.25 * np.hypot(rig.pinion.roughness, rig.wheel.roughness)
        assert path.film_parameter == pytest.approx(path.film / rough, rel=1e-12)


def test_undeformed_the_film_is_as_warm_as_hot(rig: GearPair, hot_rig: Operating) -> None:
    """State undeformed: bodies as drawn, oil, film and friction those of operation."""
    s = path_of_contact(rig, 5)
    model = TEXTBOOK.override(sharing="equal", modulus="constant")
    drawn = hot_rig.as_drawn()
    assert drawn.flanks == hot_rig.flanks
    assert np.all(np.asarray(drawn.temperatures.pinion_addendum) == drawn.temperatures.reference)
    hot, cold = (FrictionPath(elastic_pair(HotPair(rig, o, model)), s) for o in (hot_rig, drawn))
    assert np.array_equal(hot.film, cold.film)
    assert np.array_equal(hot.friction, cold.friction)
    row = replace(hot_rig, flank_temperature=np.array([350.0, 360.0, 370.0]))
    assert row.point(1).flanks.tolist() == [360.0]
    assert row.with_gears_at(380.0).flank_temperature is None
    with pytest.raises(InputError, match=r"operating.flank_temperature: got 20"):
        replace(hot_rig, flank_temperature=20.0)


def test_a_film_beyond_the_oils_line_is_a_status_and_one_warning(
    rig: GearPair, hot_rig: Operating
) -> None:
    row = replace(hot_rig, flank_temperature=ZERO_CELSIUS + np.array([100.0, 150.0, 165.0]))
    cycle = mesh_cycle(rig, row, MeshModel.consistent(), path_positions=5, mesh_positions=8)
    assert cycle["film_outside_range"].values.tolist() == [0, 0, 1]
    path = FrictionPath(elastic_pair(HotPair(rig, row, MeshModel.consistent())), np.array([0.02]))
    with pytest.warns(ValidityWarning, match=r"film: flanks of 165 .. 165 C leave the range -20"):
        path.warn_beyond_oil()
    by_oil = mesh_cycle(rig, row, TEXTBOOK.override(inlet="oil"), path_positions=5)
    assert not by_oil["film_outside_range"].any()


def test_the_band_holds_the_chosen_law_where_that_is_valid(
    rig: GearPair, hot_rig: Operating
) -> None:
    cycle = mesh_cycle(rig, hot_rig, MeshModel.consistent(), path_positions=41, mesh_positions=8)
    low, high = cycle["friction_coefficient_least"], cycle["friction_coefficient_greatest"]
    mu = cycle["friction_coefficient"]
    assert not cycle["friction_outside_range"].any()
    assert bool(((low <= mu) & (mu <= high)).all())
    assert bool((high < cycle["friction_coefficient_dry"]).all())
    # the film is thin all along: boundary friction alone is in its range
    assert float(cycle["film_parameter"].max()) < 1.0
    assert bool((high >= 0.10).all())
