"""The mesh cycle over a turn: renumbering, the tightest tooth pairs, means over all of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from thermogear import Gear, GearPair, InputError, MeshModel, Operating, Temperatures, mesh_cycle
from thermogear.base.excitation import Periodic
from thermogear.base.materials import lubricant
from thermogear.case.points import points_of
from thermogear.gears.deviations import Deviation, PitchError, Relief
from thermogear.gears.turn import Eccentricity
from thermogear.mesh import cycle as of_cycle
from thermogear.mesh import elastic
from thermogear.mesh.balance import heat_balance
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.cycle import Cycle
from thermogear.mesh.elastic import (
    BLOCK,
    TURN_POSITIONS,
    PathShare,
    elastic_pair,
    loaded_pair,
    turn_phases,
)
from thermogear.mesh.excite import EXCITES, excitations
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import mesh_heat
from thermogear.mesh.thermal import HotPair
from thermogear.mesh.turn_spread import OF_TURN
from thermogear.mesh.warm_up import Duty, warm_up

OIL = lubricant("FVA3")
MODEL = MeshModel.consistent()
PAIR = GearPair(Gear(20, 3e-3, face_width=20e-3), Gear(40, 3e-3, face_width=20e-3))
SMALL = GearPair(Gear(12, 3e-3, profile_shift=0.4), Gear(18, 3e-3, profile_shift=0.2))
WARM = Temperatures(
    reference=293.15,
    pinion_addendum=350.0,
    pinion_bore=345.0,
    wheel_addendum=348.0,
    wheel_bore=344.0,
    housing=330.0,
)


def at(torque: Sequence[float] = (80.0,), speed: float = 300.0) -> Operating:
    return Operating(
        speed=[speed] * len(torque),
        torque=torque,
        lubricant=OIL,
        oil_temperature=333.15,
        temperatures=WARM,
        half_backlash=60e-6,
    )


def errors(
    pair: GearPair, deviation: float = 3e-6, *, turned: Sequence[int] = (0, 0)
) -> list[PitchError]:
    """Pitch errors of both gears, numbered from other teeth where they are ``turned``."""
    rng = np.random.default_rng(18)
    return [
        PitchError(name, tuple(np.roll(deviation * rng.standard_normal(gear.teeth), k)))
        for (name, gear), k in zip(
            {"pinion": pair.pinion, "wheel": pair.wheel}.items(), turned, strict=True
        )
    ]


def figures(turned: Sequence[int]) -> np.ndarray:
    """Oil temperature, losses and the mesh of the 20:40 pair with its heat balance, one row."""
    flanks = errors(PAIR, turned=turned)
    balance = heat_balance(PAIR, 300.0, 80.0, OIL, 60e-6, MODEL, deviations=flanks, from_hot=False)
    hot = balance.operating
    cycle = mesh_cycle(PAIR, hot, MODEL, deviations=flanks, path_positions=21)
    worst = [
        cycle[f"{name}_of_turn"].item()
        for name in (
            "flash_temperature_median", "flash_temperature_decile", "flash_temperature_greatest",
            "hertz_pressure_greatest", "film_parameter_least",
        )
    ]  # fmt: skip
    named = ("half_backlash", "least_half_backlash", "mean_stiffness", "frictional_power")
    swings = [float(np.ptp(cycle[name].values)) for name in ("spring_error", "transmission_error")]
    teeth = [cycle[f"flash_temperature_{gear}_tooth"].item() for gear in ("pinion", "wheel")]
    return np.array(
        [
            float(hot.oil_temperature[0]),
            float(balance.losses.mesh[0]),
            *worst,
            *(cycle[name].item() for name in named),
            *swings,
            *(np.subtract(teeth, 1 + np.array(turned)) % (20, 40)),
        ]
    )


def test_a_renumbered_assembly_is_the_same_and_another_assembly_is_not() -> None:
    """Teeth 20 and 40: renumbered by k1, k2 it is the same where 20 divides k1 - k2."""
    plain = figures((0, 0))
    for turned in ((3, 3), (7, 27), (19, -1), (0, 20)):
        np.testing.assert_allclose(figures(turned), plain, rtol=1e-9)
    other = figures((5, 0))
    assert np.all(np.abs(other[:-2] / plain[:-2] - 1.0) > 1e-6)


def test_heat_is_that_of_all_tooth_pairs_one_by_one() -> None:
    """Few loads at each position and 48 phases, beside all loads at 144 phases."""
    flanks = errors(SMALL)
    for torque in (10.0, 60.0):
        elastic = elastic_pair(HotPair(SMALL, at([torque]), MODEL), flanks)
        found = mesh_heat(elastic)
        phase = np.arange(144) / 144
        solved = loaded_pair(elastic).solve(turn_phases(36, phase))
        s, share = solved.points.s.ravel(), solved.share.reshape(1, -1)
        on = (s > 0.0) & (s < SMALL.line_of_action) & (share[0] > 0.0)
        path = FrictionPath(
            elastic, s[on], PathShare(share[:, on], np.zeros((1, on.sum()), np.int8))
        )
        weight = SMALL.face_width / phase.size / 36
        assert found.power[0] == pytest.approx(path.heat.sum() * weight, rel=2e-3)
        assert found.conductance[0] == pytest.approx(path.exchange.sum() * weight, rel=2e-3)
        again = mesh_heat(elastic, share=found.share)
        for one, other in zip(found, again, strict=True):
            np.testing.assert_array_equal(one, other)


def test_a_warm_up_ends_at_the_balance_and_its_clearance_is_the_tightest() -> None:
    flanks = errors(SMALL, 6e-6)
    duty = Duty.steady(300.0, 40.0, ambient=293.15)
    course = warm_up(SMALL, duty, OIL, 60e-6, deviations=flanks, moments=6)
    balance = heat_balance(SMALL, 300.0, 40.0, OIL, 60e-6, deviations=flanks, from_hot=False)
    end = course.temperatures["oil"][-1]
    assert end == pytest.approx(balance.operating.oil_temperature[0], abs=0.1)
    hot = HotPair(SMALL, course.operating.point(course.time.size - 1), MODEL)
    gap = Clearance(hot, np.arange(240) / 240, flanks)
    assert course.half_backlash[-1] == pytest.approx(gap.half_backlash.min(), rel=1e-12)
    alike = warm_up(SMALL, duty, OIL, 60e-6, deviations=flanks[:0], moments=6)
    assert end > alike.temperatures["oil"][-1] + 0.1


def test_the_least_clearance_is_that_of_the_tightest_pair_and_jams_where_it_is_said_to() -> None:
    flanks: list[Deviation] = [
        *errors(SMALL, 8e-6),
        Eccentricity("wheel", amount=15e-6, angle=1.0),
        Relief("pinion", amount=10e-6, length=2e-3),
    ]
    phase = np.arange(48) / 48
    gap = Clearance(HotPair(SMALL, at([10.0, 60.0]), MODEL), phase, flanks)
    assert gap.half_backlash.shape == (2, 36 * 48)
    np.testing.assert_allclose(gap.least, gap.half_backlash.min(axis=1), rtol=1e-12)
    np.testing.assert_allclose(sum(gap.parts.values()), gap.least - 60e-6, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(
        gap.parts["deviations"] + 60e-6,
        Clearance(HotPair(SMALL, at([10.0, 60.0]).as_drawn(), MODEL), phase, flanks).least,
        rtol=1e-12,
    )
    hot = HotPair(SMALL, at(), MODEL)
    jam = Clearance(hot, phase, flanks).jam_temperature[0]
    jammed = Clearance(hot.warmed(float(jam) - 350.0), phase, flanks)
    assert jammed.least[0] == pytest.approx(0.0, abs=1e-15)


def test_eccentric_perfect_gears_move_the_error_alone() -> None:
    """All tooth pairs at once: the shafts' orders in the error, nothing else changed."""
    flanks = [
        Eccentricity("pinion", amount=20e-6, angle=0.3),
        Eccentricity("wheel", amount=10e-6, angle=0.0),
    ]
    plain, cycle = (
        Cycle(HotPair(SMALL, at(), MODEL), tuple(d), np.array([SMALL.path.c]), TURN_POSITIONS)
        for d in ((), flanks)
    )
    names = ("mesh_stiffness", "transmission_error", "half_backlash_curve")
    one, turn = (c.quantities((*names, "frictional_power")) for c in (plain, cycle))
    repeated = {name: np.tile(one[name], 36) for name in names}
    np.testing.assert_allclose(turn["mesh_stiffness"], repeated["mesh_stiffness"], rtol=1e-9)
    assert turn["frictional_power"] == pytest.approx(one["frictional_power"], rel=3e-4)
    moved = turn["transmission_error"] - repeated["transmission_error"]
    lines = 2.0 / moved.size * np.abs(np.fft.rfft(moved[0]))
    # 12 and 18 teeth: three and two turns in 36 mesh periods
    assert lines[[3, 2]] == pytest.approx([20e-6, 10e-6], rel=1e-9)
    assert np.max(np.delete(lines, [0, 2, 3])) < 1e-12
    gap = turn["half_backlash_curve"] - repeated["half_backlash_curve"]
    lines = 2.0 / gap.size * np.abs(np.fft.rfft(gap[0]))
    angle = SMALL.operating_pressure_angle
    assert lines[[3, 2]] == pytest.approx([20e-6 * np.sin(angle), 10e-6 * np.sin(angle)], rel=1e-9)


def test_a_high_tooth_is_the_one_that_is_pressed_most() -> None:
    """Material added to the pinion's tooth 5 alone: numbers count from the tooth at phase 0."""
    high = PitchError("pinion", tuple(8e-6 * (np.arange(12) == 4)))
    cycle = mesh_cycle(SMALL, at(), MODEL, deviations=[high], path_positions=41)
    assert cycle.attrs["mesh_periods"] == 12
    assert cycle.sizes["mesh_phase"] == 12 * 240
    for name in ("hertz_pressure", "flash_temperature"):
        assert cycle[f"{name}_pinion_tooth"].item() == 5.0
        low, middle, most = (
            cycle[f"{name}_{kind}_of_turn"].item() for kind in ("median", "decile", "greatest")
        )
        assert low <= middle < most
    alone = mesh_cycle(SMALL, at(), MODEL, path_positions=41)
    assert cycle["hertz_pressure_median_of_turn"].item() == pytest.approx(
        float(alone["hertz_pressure"].max()), rel=0.02
    )
    assert not set(OF_TURN) & set(alone)
    # the mean over the tooth pairs carries the load as one pair would
    share, phase = cycle["load_share"][0], cycle["path_position"].values
    inside = (phase > SMALL.path.a) & (phase + SMALL.base_pitch < SMALL.path.e)
    partner = np.interp(phase[inside] + SMALL.base_pitch, phase, share)
    np.testing.assert_allclose(share[inside] + partner, 1.0, atol=0.02)


def test_a_turn_without_load_or_at_rest_has_its_limits() -> None:
    still = mesh_cycle(SMALL, at(speed=0.0), MODEL, deviations=errors(SMALL), path_positions=11)
    idle = mesh_cycle(SMALL, at([0.0]), MODEL, deviations=errors(SMALL), path_positions=11)
    for cycle, film in ((still, 0.0), (idle, np.inf)):
        assert cycle["flash_temperature_greatest_of_turn"].item() == 0.0
        assert cycle["film_parameter_median_of_turn"].item() == film
        assert cycle["frictional_power"].item() == 0.0
        assert cycle["status"].item() == 0


def test_only_what_is_asked_of_a_turn_is_solved() -> None:
    cycle = Cycle(HotPair(SMALL, at(), MODEL), tuple(errors(SMALL)), np.array([SMALL.path.c]), 96)
    cycle.quantities(("least_half_backlash", "jam_temperature", "frictional_power"))
    assert not {"curves", "shares", "path"} & set(vars(cycle))
    rule = MODEL.override(sharing="equal")
    other = Cycle(HotPair(SMALL, at(), rule), tuple(errors(SMALL)), np.array([SMALL.path.c]), 96)
    assert not set(OF_TURN) & set(other.quantities())
    with pytest.raises(InputError, match="sharing = equal"):
        other.quantities(["hertz_pressure_wheel_tooth"])


def test_many_operating_points_of_a_turn_are_solved_in_blocks() -> None:
    count = BLOCK // (36 * TURN_POSITIONS) + 2
    flanks = tuple(errors(SMALL))
    whole = at(np.linspace(10.0, 60.0, count).tolist())
    cycle = Cycle(HotPair(SMALL, whole, MODEL), flanks, np.array([SMALL.path.c]), 96)
    last = Cycle(HotPair(SMALL, whole.point(count - 1), MODEL), flanks, cycle.s, 96)
    np.testing.assert_allclose(cycle.stiffness[-1], last.stiffness[0], rtol=1e-12)
    np.testing.assert_allclose(cycle.heat.power[-1], last.heat.power[0], rtol=1e-12)


def test_the_excitation_of_a_turn_keeps_the_harmonics_of_every_mesh_period() -> None:
    flanks = [*errors(SMALL), Eccentricity("pinion", amount=5e-6, angle=0.0)]
    cycle = mesh_cycle(SMALL, at(), MODEL, deviations=flanks, want=EXCITES)
    given = Periodic(0.0, (1e-6, 0.5e-6j))
    bare, found = (
        excitations(cycle, SMALL, damping_ratio=0.05, transmission_error=error, harmonics=4)
        for error in (Periodic(0.0), given)
    )
    assert found.mesh_periods == 36
    assert found.stiffness.shape == found.error.shape == (1, 1 + 4 * 36)
    more = found.error[0] - bare.error[0]
    assert more[[36, 72]] == pytest.approx([1e-6, 0.5e-6j], rel=1e-12)
    assert np.count_nonzero(np.abs(more) > 1e-18) == 2
    assert found.stiffness[0, 0].real == pytest.approx(float(cycle["mesh_stiffness"].mean()))
    assert found.mesh_frequency[0] == pytest.approx(12 * 300.0)
    replaced = replace(at(), speed=np.array([300.0]))
    alike = [PitchError("pinion", (2e-6,) * 12), Eccentricity("wheel", amount=0.0, angle=1.0)]
    plain = mesh_cycle(SMALL, replaced, MODEL, deviations=alike, want=EXCITES)
    assert "mesh_periods" not in plain.attrs
    assert excitations(plain, SMALL, damping_ratio=0.05).mesh_periods == 1


@pytest.mark.parametrize("teeth", ["alike", "differ"])
def test_a_cycle_solves_its_shares_once(monkeypatch: pytest.MonkeyPatch, teeth: str) -> None:
    """Load, springs and the spread over the turn stand on one solution at the path's places."""
    flanks = tuple(errors(SMALL)) if teeth == "differ" else ()
    cycle = Cycle(HotPair(SMALL, at(), MODEL), flanks, np.linspace(*SMALL.path[::4], 7), 8)
    seen: list[int] = []
    solve = elastic.tooth_pair_shares
    for module in (elastic, of_cycle):
        monkeypatch.setattr(module, "tooth_pair_shares", lambda *a: (seen.append(1), solve(*a))[1])
    values = cycle.quantities()
    assert len(seen) == 1
    np.testing.assert_array_equal(
        values["pair_stiffness"], elastic_pair(cycle.hot, flanks).pair_stiffness(cycle.s)
    )


def test_stretches_of_a_turn_change_no_number(monkeypatch: pytest.MonkeyPatch) -> None:
    def figures_of() -> dict[str, np.ndarray]:
        cycle = mesh_cycle(
            SMALL, at(), MODEL, deviations=errors(SMALL), path_positions=7, mesh_positions=96
        )
        return {str(name): values.values for name, values in cycle.data_vars.items()}

    whole = figures_of()
    monkeypatch.setattr(elastic, "BLOCK", 900)
    sizes: list[int] = []
    solve = elastic.solve_mesh
    monkeypatch.setattr(
        elastic, "solve_mesh", lambda p, f, x, **k: (sizes.append(len(x)), solve(p, f, x, **k))[1]
    )
    for name, values in figures_of().items():
        np.testing.assert_allclose(values, whole[name], rtol=1e-12, atol=1e-18, err_msg=name)
    # 900 positions and the first mesh period, but eight periods and it at least
    assert max(sizes) <= 900 + 96


def test_the_tables_of_a_turn_are_held_once_along_a_row_of_speeds() -> None:
    cycle = mesh_cycle(SMALL, at(), MODEL, deviations=errors(SMALL), want=EXCITES)
    mesh = excitations(
        cycle, SMALL, damping_ratio=0.05, transmission_error=Periodic(0.0), harmonics=4
    )
    speeds = np.linspace(1e3, 2e3, 5)
    along = replace(mesh.take(np.zeros(5, int)), mesh_frequency=speeds)
    points = points_of(along)
    apart = points_of(replace(along, stiffness=along.stiffness.copy(), error=along.error.copy()))
    for tables in (
        along.stiffness,
        along.error,
        points.flat.stiffness,
        points.take(np.arange(5)).error,
    ):
        assert tables.strides[0] == 0
    np.testing.assert_array_equal(points.flat.stiffness, apart.flat.stiffness)
    np.testing.assert_array_equal(points.flat.force, apart.flat.force)
