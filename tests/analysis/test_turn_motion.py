"""Motions whose period is a turn of many mesh periods: truths, counts, alike teeth, long turns."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from said import numbers
from thermogear import (
    Excitation,
    Gear,
    GearPair,
    InputError,
    PairModel,
    Periodic,
    label,
    lyapunov_exponent,
    periodic_orbit,
    simulate,
)
from thermogear.analysis.labels import labels
from thermogear.analysis.orbits import multipliers
from thermogear.analysis.settle import PERIODIC, Rule, settle
from thermogear.base.excitation import Excitations
from thermogear.case.points import Points, on_numbers, points_of
from thermogear.case.response import Recording, respond
from thermogear.dynamics.models import DeadZoneModel, from_excitation
from thermogear.gears.deviations import PitchError
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.mesh.excite import disc_inertia, over_turn

TRUTH = json.loads((Path(__file__).parent / "turn_truth.json").read_text("utf-8"))
"""Orbits of DOP853 with located contact changes and shooting, by code that is not ours."""


def table(rows: dict[str, Any]) -> Periodic:
    found = np.zeros(max(map(int, rows["harmonics"])), complex)
    for order, (real, imaginary) in rows["harmonics"].items():
        found[int(order) - 1] = complex(real, imaginary)
    return Periodic(rows["mean"], tuple(found))


def model(name: str) -> DeadZoneModel:
    told = TRUTH[name]["model"]
    return DeadZoneModel(
        damping_ratio=told["damping_ratio"],
        frequency=told["turn_frequency"],
        stiffness=table(told["stiffness"]),
        force=table(told["force"]),
        half_backlash=told["half_backlash"],
        mesh_periods=told["mesh_periods"],
    )


def excited(mesh_periods: int = 1, **changes: Any) -> Excitation:
    """A pair whose teeth are all alike, its tables over so many mesh periods."""
    tables = np.array([[3e8, 5e7, 1e7j], [1e-6, 2e-6, 1e-6j]])
    k, e = (Periodic(row[0].real, tuple(row[1:])) for row in over_turn(tables, mesh_periods))
    values: dict[str, Any] = {
        "stiffness": k, "error": e, "half_backlash": 50e-6, "reference_half_backlash": 40e-6,
        "mean_force": 4e3, "mesh_frequency": 1.6e4, "inertias": (2e-3, 4e-3),
        "base_radii": (0.04, 0.06), "torques": (160.0, 240.0), "damping_ratio": 0.06,
        "mesh_periods": mesh_periods,
    }  # fmt: skip
    return Excitation(**(values | changes))


START = (1.3, 0.0)


@pytest.mark.parametrize("name", TRUTH)
def test_the_orbit_of_a_turn_is_that_of_another_integration(name: str) -> None:
    truth = TRUTH[name]
    orbit = periodic_orbit(model(name), guess=np.array(truth["start"]) + 1e-3)
    assert orbit.state == pytest.approx(truth["start"], abs=1e-8)
    ours = sorted(orbit.multipliers, key=lambda mu: (mu.real, mu.imag))
    theirs = sorted(
        (complex(*mu) for mu in truth["multipliers"]), key=lambda mu: (mu.real, mu.imag)
    )
    assert np.abs(np.array(ours) - theirs) == pytest.approx(0.0, abs=1e-6)
    assert orbit.dynamic_load_factor() == pytest.approx(truth["K_v"], rel=1e-5)
    assert orbit.shares[1] == pytest.approx(truth["free_share"], abs=1e-9)


def test_an_unstable_turn_settles_to_six_turns() -> None:
    """The orbit that closes after one turn of 35 mesh periods has a multiplier of -2.80."""
    truth = TRUTH["motion_hunting_loss"]
    found = label(model("motion_hunting_loss"), initial_state=(1.2, 0.0))
    assert (found.name, found.mesh_periods) == ("period-6", 35)
    # "period 6 of the turn", and not a period-6 of the mesh
    assert str(found) != found.name
    assert numbers(str(found)) == [6.0]
    assert numbers(found.reason) == pytest.approx([-0.306319, 6.0], abs=1e-6)
    orbit = found.orbit
    assert orbit is not None
    # maps of a turn are large: none are kept with a label
    assert "maps" not in vars(orbit.section)
    away = orbit.section.distance(orbit.points, np.array(truth["settled"]["start"]))
    assert float(away.min()) < 1e-7
    assert orbit.dynamic_load_factor() == pytest.approx(truth["settled"]["K_v"], rel=1e-5)
    # turns are counted in the orbit, mesh periods in what went by
    assert found.discarded % 35 == 0
    assert found.discarded >= 500


def test_tables_by_fft_and_term_by_term_move_alike() -> None:
    of_turn = model("motion_one_tooth_loss")
    plain = replace(of_turn, mesh_periods=1)
    one, other = (periodic_orbit(m, guess=(1.1, -0.03)) for m in (of_turn, plain))
    assert one.lanes.by_fft
    assert not other.lanes.by_fft
    assert one.state == pytest.approx(other.state, abs=1e-12)
    assert one.jacobian == pytest.approx(other.jacobian, abs=1e-11)


@pytest.mark.parametrize("mesh_periods", [7, 40])
def test_alike_teeth_move_as_in_one_mesh_period(mesh_periods: int) -> None:
    once, turn = from_excitation(excited()), from_excitation(excited(mesh_periods))
    one, other = (label(m, initial_state=START) for m in (once, turn))
    assert (str(one), one.name, other.name) == ("period-1", "period-1", "period-1")
    assert str(other) != other.name
    assert one.orbit is not None
    assert other.orbit is not None
    assert other.orbit.state == pytest.approx(one.orbit.state, abs=1e-9)
    assert other.orbit.shares == pytest.approx(one.orbit.shares, abs=1e-9)
    factors = [found.orbit.dynamic_load_factor() for found in (one, other)]
    assert factors[1] == pytest.approx(factors[0], rel=1e-5)
    # per unit of time the exponents are the same
    rates = [
        np.log(abs(found.orbit.multipliers[0])) / found.orbit.section.period
        for found in (one, other)
    ]
    assert rates[1] == pytest.approx(rates[0], rel=1e-6)
    run = {"periods": 10, "discard": 5, "samples_per_period": 16, "initial_state": START}
    first, second = simulate(once, **run), simulate(turn, **run)
    # whole turns: at least as many mesh periods, in the same units
    assert second.sizes["sample"] == 16 * mesh_periods * -(-10 // mesh_periods)
    count = mesh_periods * -(-5 // mesh_periods)
    late = simulate(once, **(run | {"discard": count, "periods": second.attrs["periods"]}))
    assert second.attrs["discard"] == count
    for name in ("phase", "time"):
        assert second[name].values == pytest.approx(late[name].values, rel=1e-12)
    for name in ("x", "v"):
        assert second[name].values == pytest.approx(late[name].values, abs=1e-9)
    assert first["section"].values.tolist() == list(range(5, 16))
    assert set(np.diff(second["section"].values)) == {mesh_periods}


def test_figures_of_alike_teeth_are_those_of_one_mesh_period() -> None:
    points = [points_of(Excitations.of([excited(count)])) for count in (1, 9)]
    rule = Rule(settled=1e-6)
    ends = [settle(one.flat, np.array([START]), rule) for one in points]
    assert [int(one.label[0]) for one in ends] == [PERIODIC, PERIODIC]
    records = [
        Recording(periods=periods, samples=64 * count, highest_order=3.0)
        for count, periods in ((1, 4), (9, 2))
    ]
    found = [
        respond(one, end.state, record, lines=True)
        for one, end, record in zip(points, ends, records, strict=True)
    ]
    for name, values in found[0].items():
        assert found[1][name] == pytest.approx(values, rel=1e-6, abs=1e-12), name
    # the settled motion was followed for whole turns, told in mesh periods
    assert ends[1].used[0] % 9 == 0


def test_the_frequency_of_the_tables_is_that_of_the_turn() -> None:
    at = excited(12)
    found = from_excitation(at)
    assert found.frequency == pytest.approx(at.mesh_frequency / at.natural_frequency / 12)
    assert PairModel.from_excitation(at).period == pytest.approx(
        2.0 * np.pi * 12 / at.mesh_frequency
    )
    columns = Excitations.of([at, replace(at, mesh_frequency=2e4)])
    assert columns.take([1]).one(0) == replace(at, mesh_frequency=2e4)
    assert Excitations.joined([columns, columns]).mesh_periods == 12
    with pytest.raises(
        InputError, match=r"gears.period: got .* \[1, 12\] mesh periods; allowed one number"
    ):
        Excitations.of([at, excited()])
    with pytest.raises(InputError, match="mesh_periods"):
        replace(at, mesh_periods=1.5)  # type: ignore[arg-type]
    points = points_of(columns)
    assert points.mesh_periods == 12
    moved = on_numbers(points, {"frequency": np.array([0.5, 0.6])})
    assert moved.flat.period == pytest.approx(12 * 2.0 * np.pi / np.array([0.5, 0.6]))
    assert moved.mesh_frequency / moved.rate == pytest.approx([0.5, 0.6])
    phase = np.arange(12 * 8) / (12 * 8)
    assert points.kinematic(phase)[0] == pytest.approx(at.error(phase), abs=1e-18)


def test_a_turn_of_two_thousand_mesh_periods_runs_whole() -> None:
    """Its multipliers lie at the least number: 0, and an exponent that is finite."""
    turn = from_excitation(excited(2000))
    orbit = periodic_orbit(turn, guess=START)
    assert np.abs(orbit.multipliers) == pytest.approx(0.0, abs=1e-300)
    once = periodic_orbit(from_excitation(excited()), guess=START)
    assert orbit.state == pytest.approx(once.state, abs=1e-9)
    lanes = turn.lanes()
    found = settle(lanes, np.array([START]), Rule(settled=1e-6))
    assert int(found.label[0]) == PERIODIC
    assert np.isfinite(found.lyapunov[0])
    assert found.lyapunov[0] < 0.0
    assert multipliers(np.zeros((2, 2)), 0.0).tolist() == [0.0, 0.0]
    # its exponent by the tangent needs no multiplier
    exponent = lyapunov_exponent(turn, initial_state=orbit.state, discard=0, batches=2,
                                 batch_periods=1)  # fmt: skip
    assert exponent.value == pytest.approx(-0.06, rel=0.02)


def test_lanes_of_a_turn_do_not_depend_on_their_company() -> None:
    rows = [excited(5, mesh_frequency=w) for w in (0.8e4, 1.2e4, 1.6e4)]
    together = labels(from_excitation(rows), initial_state=START)
    for one, row in zip(together, rows, strict=True):
        alone = label(from_excitation(row), initial_state=START)
        assert one.orbit is not None
        assert alone.orbit is not None
        assert np.array_equal(one.orbit.points, alone.orbit.points)


def test_several_periods_are_refused_in_one_line() -> None:
    for several in ([1, 2], np.arange(100)):
        with pytest.raises(InputError) as refused:
            periodic_orbit(model("motion_one_tooth"), several, (1.1, 0.0))  # type: ignore[arg-type]
        assert str(refused.value) == (
            f"period: got {len(several)} values; allowed a whole number >= 1"
        )


def test_pitch_errors_raise_the_dynamic_factor_of_a_pair() -> None:
    """20/40 teeth with 3 um errors: an own integration, 512 points a mesh period, beams for teeth.

    1.745 1.81 2.92 2.72 at four speeds, contact lost 0 0 10 3.7 % of the time; perfect gears
    1.318 1.297 2.08 1.65. Within 6 %: its beams are not quite ours.
    """
    gears = [Gear(z, 3e-3, face_width=30e-3) for z in (20, 40)]
    pair = GearPair(*gears)
    sizes = (3.0 * np.sin(2.3 * np.arange(20) ** 2), 3.5 * np.cos(1.7 * np.arange(40) ** 2))
    errors = [
        PitchError(name, tuple(1e-6 * np.round(size, 3)))
        for name, size in zip(("pinion", "wheel"), sizes, strict=True)
    ]
    speeds, force = np.array([3e3, 6e3, 10e3, 16e3]) * np.pi / 30, 80.0 / pair.pinion.base_radius
    for deviations, count, factors, losses in (
        (errors, 40, [1.745, 1.81, 2.92, 2.72], [0.0, 0.0, 0.1, 0.037]),
        ([], 1, [1.318, 1.297, 2.08, 1.65], None),
    ):
        mesh = solve_mesh(
            pair, force, np.arange(96 * count) / 96, deviations=deviations,
            model=LoadedModel(tooth="beam"),
        )  # fmt: skip
        k, delta = np.ravel(mesh.tangent), np.ravel(mesh.deflection)
        at = excited(
            mesh_periods=1, stiffness=Periodic.from_samples(k, 40 * count), damping_ratio=0.07,
            error=Periodic.from_samples(delta - force / k, 40 * count), mean_force=force,
            inertias=tuple(disc_inertia(g, radius=g.pitch_radius) for g in gears),
            base_radii=(pair.pinion.base_radius, pair.wheel.base_radius),
        )  # fmt: skip
        rows = [replace(at, mesh_periods=count, mesh_frequency=20 * speed) for speed in speeds]
        start = (at.half_backlash + force / at.stiffness.mean) / at.reference_half_backlash
        found = [one.orbit for one in labels(from_excitation(rows), initial_state=(start, 0.0))]
        assert [orbit.dynamic_load_factor() for orbit in found] == pytest.approx(factors, rel=0.06)
        if losses is not None:
            assert [1.0 - orbit.shares[2] for orbit in found] == pytest.approx(losses, abs=0.02)
            assert Points.plain(found[0].lanes).mesh_periods == 40
