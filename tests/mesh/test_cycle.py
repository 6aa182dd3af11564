"""The quasi-static cycle: cold and uniform limits, balances, hot backlash and jam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from conftest import Compared
from thermogear import Gear, GearPair, InputError, MeshModel, Operating, Temperatures, mesh_cycle
from thermogear.base.materials import ZERO_CELSIUS, lubricant
from thermogear.base.vocabulary import FLAGS, QUANTITIES, STATUS
from thermogear.gears.deviations import FlankTable, PitchError
from thermogear.mesh.elastic import LoadedPair, MeshCurves
from thermogear.mesh.thermal import HotPair

T0 = ZERO_CELSIUS + 20.0
BUNDLES = [MeshModel.consistent(), MeshModel.thesis()]


def at(operating: Operating, temperatures: Temperatures) -> Operating:
    return replace(operating, temperatures=temperatures)


def gears_at(addendum: float, drop: float, housing: float) -> Temperatures:
    """Both gears alike [C], bores ``drop`` below the addendum."""
    hot = ZERO_CELSIUS + addendum
    return Temperatures(
        reference=T0,
        pinion_addendum=hot,
        pinion_bore=hot - drop,
        wheel_addendum=hot,
        wheel_bore=hot - drop,
        housing=ZERO_CELSIUS + housing,
    )


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_cold_gears_have_no_deformation_no_thermal_spring_and_all_their_backlash(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    cold = mesh_cycle(rig, at(hot_rig, hot_rig.temperatures.cold()), model)
    for name in ("pinion_deformation", "wheel_deformation", "thermal_stiffness", "kinematic_error"):
        assert float(np.abs(cold[name]).max()) == 0.0
    assert np.all(cold["half_backlash_curve"].values == hot_rig.half_backlash)
    assert np.all(cold["mesh_stiffness"].values == cold["elastic_stiffness"].values)
    assert np.all(cold["status"].values == STATUS.index("ok"))


def test_everything_uniformly_hot_changes_no_backlash_at_all(
    rig: GearPair, hot_rig: Operating, compared: Compared
) -> None:
    warm = at(hot_rig, Temperatures.uniform(ZERO_CELSIUS + 130.0, reference=T0))
    cycle = mesh_cycle(rig, warm, mesh_positions=240)
    change = cycle["half_backlash_curve"].values - hot_rig.half_backlash
    compared(
        "half backlash over the mesh, everything at 130 °C",
        "the cold one, exactly",
        change,
        0.0,
        "m",
    )
    assert np.all(cycle["half_backlash"].values == hot_rig.half_backlash)
    assert np.all(cycle["kinematic_error"].values == 0.0)
    # the flanks did grow: an involute of the larger base circle, lambda tau rho
    rise = 110.0 * rig.pinion.material.thermal_expansion
    s = cycle["path_position"].values
    np.testing.assert_allclose(cycle["pinion_deformation"].values[0], rise * s, rtol=1e-12)


def test_uniform_heat_moves_the_elastic_stiffness_by_the_modulus_alone(
    rig: GearPair, hot_rig: Operating
) -> None:
    softer = 1.0 - 3.3e-4 * 110.0
    linear = MeshModel.consistent().override(stiffness="textbook-30-degree")
    # the loaded contact hardens with load over modulus: a little less than proportional
    for model, tolerance in ((linear, 1e-12), (MeshModel.consistent(), 3e-3)):
        cold = mesh_cycle(rig, at(hot_rig, hot_rig.temperatures.cold()), model)
        state = at(hot_rig, Temperatures.uniform(ZERO_CELSIUS + 130.0, reference=T0))
        warm = mesh_cycle(rig, state, model)
        for name in ("mean_stiffness", "rim_stiffness", "bore_clamped_stiffness"):
            ratio = warm[name].values / cold[name].values
            if name == "mean_stiffness":
                np.testing.assert_allclose(ratio, softer, rtol=tolerance)
            assert np.all(ratio <= softer * (1.0 + 3e-3))
        rigid = mesh_cycle(rig, state, model.override(modulus="constant"))
        np.testing.assert_allclose(
            rigid["elastic_stiffness"].values, cold["elastic_stiffness"].values, rtol=1e-12
        )


@pytest.mark.parametrize("temperature", [100.0, 120.0, 140.0, 160.0])
def test_heat_softens_the_mesh_by_two_to_five_per_cent(
    rig: GearPair, hot_rig: Operating, temperature: float
) -> None:
    cold = mesh_cycle(rig, at(hot_rig, hot_rig.temperatures.cold()))
    hot = mesh_cycle(rig, at(hot_rig, gears_at(temperature, 20.0, temperature - 40.0)))
    change = hot["mean_stiffness"].values / cold["mean_stiffness"].values - 1.0
    assert np.all((change > -0.046) & (change < -0.02))
    stiffer = mesh_cycle(rig, at(hot_rig, gears_at(temperature, 20.0, 60.0)), MeshModel.thesis())
    assert np.all(
        stiffer["mean_stiffness"].values > stiffer["elastic_stiffness"].mean("mesh_phase")
    )


def test_the_thesis_spring_grows_with_load_and_falls_with_heat(
    rig: GearPair, hot_rig: Operating
) -> None:
    def spring(addendum: float, torque: float) -> float:
        state = at(hot_rig, gears_at(addendum, 20.0, 60.0))
        state = replace(state, torque=np.full(3, torque))
        return float(mesh_cycle(rig, state, MeshModel.thesis())["thermal_stiffness"].mean())

    assert spring(140.0, 200.0) == pytest.approx(2.0 * spring(140.0, 100.0), rel=1e-12)
    assert spring(160.0, 100.0) < spring(100.0, 100.0)


def test_equal_fields_leave_the_sum_of_the_growths_constant_along_the_path(
    hot_rig: Operating,
) -> None:
    for bores in ((25e-3, 80e-3), (20e-3, 60e-3)):
        pair = GearPair(Gear(25, 5e-3, bore_radius=bores[0]), Gear(75, 5e-3, bore_radius=bores[1]))
        cycle = mesh_cycle(pair, at(hot_rig, gears_at(140.0, 20.0, 100.0)))
        total = cycle["deformation_sum"].values[0]
        assert np.ptp(total) < 1e-6


def test_backlash_lost_with_and_without_the_housing(hot_rig: Operating) -> None:
    # free bores 25/40 mm, 20 K gradient, addenda 100 .. 160 C
    pair = GearPair(Gear(25, 5e-3, bore_radius=25e-3), Gear(75, 5e-3, bore_radius=40e-3))

    def lost(addendum: float, housing: float, model: MeshModel) -> float:
        cycle = mesh_cycle(pair, at(hot_rig, gears_at(addendum, 20.0, housing)), model)
        return 1e6 * float((cycle["cold_half_backlash"] - cycle["half_backlash"])[0])

    alone = MeshModel.consistent().override(housing="rigid")
    # published for the mean along the path; the tightest pair lies within the sum's 0.9 um of it
    assert lost(100.0, 20.0, alone) == pytest.approx(72.0, abs=0.9)
    assert lost(160.0, 20.0, alone) == pytest.approx(132.0, abs=0.9)
    # the housing 20 K and 50 K below the addendum, whatever the level
    for addendum in (100.0, 160.0):
        assert lost(addendum, addendum - 20.0, MeshModel.consistent()) == pytest.approx(14, abs=0.7)
        assert lost(addendum, addendum - 50.0, MeshModel.consistent()) == pytest.approx(43, abs=0.7)


def test_a_pair_with_94_um_of_backlash_jams_48_kelvin_over_a_cold_steel_housing(
    rig: GearPair, hot_rig: Operating, compared: Compared
) -> None:
    tight = replace(hot_rig, half_backlash=47e-6)
    warm = mesh_cycle(rig, at(tight, gears_at(21.0, 0.0, 20.0)))
    jam = float(warm["jam_temperature"][0])
    # 2 a_w sin(alpha) lambda = 1.967 um/K of total normal backlash
    slope = 2.0 * rig.centre_distance * np.sin(np.radians(20.0)) * 11.5e-6
    compared(
        "jam temperature of the mesh cycle",
        "2 a sin α λ = 1.967 µm/K",
        (jam - T0) * slope / 94e-6 - 1.0,
        1e-9,
    )
    assert jam - T0 == pytest.approx(48.0, abs=0.5)
    for offset, status in ((-0.01, "ok"), (0.01, "jammed")):
        state = at(tight, gears_at(jam - ZERO_CELSIUS + offset, 0.0, 20.0))
        cycle = mesh_cycle(rig, state)
        assert np.all(cycle["status"].values == STATUS.index(status))
        assert float(cycle["jam_temperature"][0]) == pytest.approx(jam, abs=1e-6)


def test_gears_colder_than_the_reference_never_jam(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, at(hot_rig, gears_at(-20.0, 0.0, 20.0)))
    assert np.all(cycle["half_backlash"].values > hot_rig.half_backlash)


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_shares_of_the_pairs_in_contact_sum_to_one(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    cycle = mesh_cycle(rig, hot_rig, model, path_positions=1201)
    s, share = cycle["path_position"].values, cycle["load_share"].values[0]
    # A itself has its partner at D, where the share jumps between two positions
    inside = (s > rig.path.a + 1e-5) & (s + rig.base_pitch < rig.path.e)
    partner = np.interp(s[inside] + rig.base_pitch, s, share)
    single = (s > rig.path.b) & (s < rig.path.d)
    if model.sharing == "loaded":
        # corner contact lends a little to a third pair near both ends
        middle = slice(round(0.2 * partner.size), round(0.8 * partner.size))
        np.testing.assert_allclose((share[inside] + partner)[middle], 1.0, atol=2e-6)
        assert share[single].max() == pytest.approx(1.0, abs=1e-12)
        assert share[inside].min() > 0.2
        return
    np.testing.assert_allclose(share[inside] + partner, 1.0, atol=2e-6)
    assert np.all(share[single] == 1.0)


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_flash_vanishes_at_the_pitch_point_at_rest_and_without_load(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    c = (rig.path.c - rig.path.a) / (rig.path.e - rig.path.a)
    cycle = mesh_cycle(rig, hot_rig, model)
    near = cycle["flash_temperature"].values[:, round(c * 200)]
    assert np.all(near < 0.02 * cycle["flash_temperature"].values.max(axis=1))
    idle = replace(hot_rig, torque=np.zeros(3))
    still = replace(hot_rig, speed=np.zeros(3))
    for state in (idle, still):
        assert float(mesh_cycle(rig, state, model)["flash_temperature"].max()) == 0.0
    assert float(mesh_cycle(rig, idle, model)["hertz_half_width"].max()) == 0.0


def test_dry_friction_is_hotter_than_mixed_and_flash_grows_with_speed_and_torque(
    rig: GearPair, hot_rig: Operating
) -> None:
    cycle = mesh_cycle(rig, hot_rig)
    dry, mixed = cycle["flash_temperature_dry"], cycle["flash_temperature_mixed"]
    assert bool((dry >= mixed).all())
    greatest = dry.max("path_position").values
    assert np.all(np.diff(greatest) > 0.0)
    # w^(3/4) at constant friction, where the shares do not depend on the load
    equal = MeshModel.consistent().override(sharing="equal", flash="blok")
    single, double = (
        mesh_cycle(rig, replace(hot_rig, torque=np.full(3, torque)), equal)["flash_temperature_dry"]
        for torque in (100.0, 200.0)
    )
    np.testing.assert_allclose(double.values, 2.0**0.75 * single.values, rtol=1e-12)


@pytest.mark.parametrize("model", BUNDLES, ids=lambda m: m.name)
def test_a_batch_of_operating_points_equals_one_by_one(
    rig: GearPair, hot_rig: Operating, model: MeshModel
) -> None:
    whole = mesh_cycle(rig, hot_rig, model)
    for point in range(3):
        one = replace(hot_rig, speed=hot_rig.speed[point : point + 1], torque=hot_rig.torque[:1])
        alone = mesh_cycle(rig, one, model)
        for name, values in alone.data_vars.items():
            other = whole[name]
            if "operating" in other.dims:
                other = other.isel(operating=[point])
            np.testing.assert_array_equal(values.values, other.values, err_msg=str(name))


def test_temperatures_may_differ_between_operating_points(
    rig: GearPair, hot_rig: Operating
) -> None:
    addenda = ZERO_CELSIUS + np.array([100.0, 120.0, 140.0])
    warm = Temperatures(
        reference=T0,
        pinion_addendum=addenda,
        pinion_bore=addenda - 20,
        wheel_addendum=addenda,
        wheel_bore=addenda - 20,
        housing=addenda - 40,
    )
    cycle = mesh_cycle(rig, at(hot_rig, warm))
    for point, addendum in enumerate((100.0, 120.0, 140.0)):
        alone = mesh_cycle(rig, at(hot_rig, gears_at(addendum, 20.0, addendum - 40.0)))
        for name in ("half_backlash", "mean_stiffness", "jam_temperature", "contact_temperature"):
            np.testing.assert_allclose(
                cycle[name].values[point], alone[name].values[point], rtol=1e-14, err_msg=name
            )


def test_two_equal_gears_keep_their_own_temperatures(hot_rig: Operating) -> None:
    gear = Gear(30, 3e-3)
    warm = Temperatures(
        reference=T0,
        pinion_addendum=T0 + 100.0,
        pinion_bore=T0 + 80.0,
        wheel_addendum=T0 + 40.0,
        wheel_bore=T0 + 20.0,
        housing=T0 + 20.0,
    )
    once = mesh_cycle(GearPair(gear, gear), at(hot_rig, warm))
    apart = mesh_cycle(GearPair(Gear(30, 3e-3), Gear(30, 3e-3)), at(hot_rig, warm))
    xr.testing.assert_identical(once, apart)
    assert np.all(once["pinion_base_growth"] > 1.5 * once["wheel_base_growth"])


def test_a_row_of_temperatures_makes_as_many_operating_points(
    rig: GearPair, hot_rig: Operating
) -> None:
    one = replace(hot_rig, speed=np.array(100.0), torque=np.array(100.0))
    housing = T0 + np.array([0.0, 30.0, 60.0])
    row = at(one, replace(one.temperatures, housing=housing))
    assert row.speed.shape == row.torque.shape == (3,)
    lost = 125e-6 - mesh_cycle(rig, row)["half_backlash"].values
    slope = 11.5e-6 * rig.centre_distance * np.sin(rig.operating_pressure_angle)
    np.testing.assert_allclose(np.diff(lost), -30.0 * slope, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "got"),
    [
        ({"torque": np.ones(2)}, "speed (3,), torque (2,)"),
        ({"oil_temperature": np.full(2, 350.0)}, "speed (3,), torque (3,), oil_temperature (2,)"),
        ({"speed": np.ones((3, 1))}, "speed (3, 1), torque (3,)"),
    ],
)
def test_operating_arrays_of_different_lengths_are_one_line(
    hot_rig: Operating, change: dict[str, object], got: str
) -> None:
    with pytest.raises(InputError) as caught:
        replace(hot_rig, **change)  # type: ignore[arg-type]
    assert str(caught.value) == f"operating: got {got}; allowed numbers and arrays of one length"


def test_a_pitch_circle_outside_the_teeth_leaves_the_cycle_whole(hot_rig: Operating) -> None:
    far = GearPair(Gear(80, 3e-3, profile_shift=1.2), Gear(90, 3e-3, profile_shift=-1.2))
    assert far.wheel.tip_radius < far.wheel.pitch_radius
    cold = mesh_cycle(far, at(hot_rig, hot_rig.temperatures.cold()))["mean_stiffness"].values
    uniform = at(hot_rig, Temperatures.uniform(T0 + 110.0, reference=T0))
    warm = mesh_cycle(far, uniform)["mean_stiffness"].values
    np.testing.assert_allclose(warm / cold, 1.0 - 3.3e-4 * 110.0, rtol=4e-3)


def test_one_pitch_error_of_all_teeth_shifts_and_changes_nothing(
    rig: GearPair, hot_rig: Operating
) -> None:
    whole = PitchError("pinion", (1e-6,) * 25)
    shifted = mesh_cycle(rig, hot_rig, deviations=[whole])
    np.testing.assert_allclose(
        shifted["mesh_stiffness"].values, mesh_cycle(rig, hot_rig)["mesh_stiffness"], rtol=1e-9
    )
    assert "mesh_periods" not in shifted.attrs


def test_a_contact_that_does_not_settle_is_a_status(
    rig: GearPair, hot_rig: Operating, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(self: LoadedPair, phase: np.ndarray) -> MeshCurves:
        k = np.full((3, phase.size), 4e8)
        k[1, 0] = np.nan
        return MeshCurves(k, np.zeros_like(k), np.zeros_like(k), np.zeros(len(k)))

    monkeypatch.setattr(LoadedPair, "over", lost)
    status = mesh_cycle(rig, hot_rig)["status"].values
    assert [STATUS[i] for i in status] == ["ok", "not_converged", "ok"]


def test_the_printed_stiffness_curve_within_half_a_per_cent(hot_rig: Operating) -> None:
    pair = GearPair(
        Gear(25, 5e-3, bore_radius=30e-3, face_width=23.54e-3),
        Gear(75, 5e-3, bore_radius=100e-3, face_width=23.54e-3),
    )
    cold = at(hot_rig, hot_rig.temperatures.cold())
    k = mesh_cycle(pair, cold, MeshModel.thesis(), mesh_positions=2000)["mesh_stiffness"].values
    assert k.min() == pytest.approx(3.494e8, rel=5e-3)
    assert k.max() == pytest.approx(6.255e8, rel=5e-3)
    assert 0.5 * (k.min() + k.max()) == pytest.approx(4.875e8, rel=5e-3)
    assert np.ptp(k) == pytest.approx(2.75e8, rel=5e-3)


def test_heat_alike_on_both_gears_changes_nothing_but_the_modulus_in_the_loaded_contact(
    rig: GearPair, hot_rig: Operating
) -> None:
    stiff = MeshModel.consistent().override(modulus="constant")
    cold = mesh_cycle(rig, at(hot_rig, hot_rig.temperatures.cold()), stiff)
    # gears 80 K above a cold housing: a shift of some 50 um on every flank
    warm = mesh_cycle(rig, at(hot_rig, gears_at(100.0, 0.0, 20.0)), stiff)
    for name in ("mesh_stiffness", "load_share"):
        np.testing.assert_allclose(warm[name].values, cold[name].values, rtol=1e-9, atol=1e-9)


def test_a_hotter_pinion_and_a_hotter_wheel_are_not_mirror_images(
    rig: GearPair, hot_rig: Operating
) -> None:
    def entering(pinion: float, wheel: float) -> float:
        warm = Temperatures(
            reference=T0,
            pinion_addendum=ZERO_CELSIUS + pinion,
            pinion_bore=ZERO_CELSIUS + pinion,
            wheel_addendum=ZERO_CELSIUS + wheel,
            wheel_bore=ZERO_CELSIUS + wheel,
            housing=ZERO_CELSIUS + 60.0,
        )
        share = mesh_cycle(rig, at(hot_rig, warm))["load_share"].values[0]
        return float(share[20])

    equal = entering(90.0, 90.0)
    assert entering(110.0, 90.0) < equal - 0.05
    assert entering(90.0, 110.0) > equal + 0.05


def test_secant_and_tangent_springs_differ_by_the_hardening_of_the_contact(
    rig: GearPair, hot_rig: Operating
) -> None:
    tangent = mesh_cycle(rig, hot_rig)
    secant = mesh_cycle(rig, hot_rig, MeshModel.consistent().override(spring="secant"))
    ratio = (tangent["mean_stiffness"] / secant["mean_stiffness"]).values
    assert np.all((ratio > 1.005) & (ratio < 1.08))
    # both carry the mean load at the same deflection
    for cycle in (tangent, secant):
        shared = cycle["transmission_error"] - cycle["spring_error"]
        carried = cycle["mesh_stiffness"] * (shared - shared.mean("mesh_phase"))
        assert float(np.abs(carried).max()) < float(cycle["normal_force"].max())


def test_every_stored_name_carries_its_unit_and_words(rig: GearPair, hot_rig: Operating) -> None:
    cycle = mesh_cycle(rig, hot_rig)
    for name, values in cycle.variables.items():
        if name not in FLAGS:
            assert values.attrs["units"] == QUANTITIES[str(name)].unit
        assert values.attrs["long_name"]


def test_too_few_positions_are_refused(rig: GearPair, hot_rig: Operating) -> None:
    with pytest.raises(InputError, match=r"^path_positions: got 1; allowed >= 2$"):
        mesh_cycle(rig, hot_rig, path_positions=1)


def test_an_unknown_choice_says_the_nearest() -> None:
    with pytest.raises(InputError, match=r"model.flank: got 'grwth'.*did you mean 'growth'"):
        MeshModel.consistent().override(flank="grwth")
    with pytest.raises(InputError, match="did you mean 'flank'"):
        MeshModel.thesis().override(flnk="growth")
    assert MeshModel.thesis().override(flank="growth").name == "thesis + flank=growth"


def test_a_cycle_says_where_a_corner_carries_along_the_path(
    rig: GearPair, hot_rig: Operating
) -> None:
    """Material left standing at the wheel's tip lets its corner touch between A and E."""
    tip, model = rig.wheel.tip_radius, MeshModel.consistent()
    left = FlankTable("wheel", radius=[tip - 3e-3, tip - 2e-4, tip], added=[0.0, 0.0, 8e-6])
    cycle = mesh_cycle(rig, hot_rig, model, deviations=[left], path_positions=201)
    edge, pressure = cycle["edge_contact"].values, cycle["hertz_pressure"].values
    assert np.all((edge == 1).sum(axis=1) > 1)
    assert np.all(edge[:, 20:180] == 0)
    np.testing.assert_array_equal(np.isnan(pressure), edge > 0)
    meanings = cycle["edge_contact"].attrs["flag_meanings"].split()
    assert meanings[:2] == ["no_edge_contact", "wheel_tip_corner"]
    # and over the mesh period, beyond A and E too, as the loaded contact has it
    elastic = LoadedPair(HotPair(rig, hot_rig, model), [left])
    phase = cycle["mesh_phase"].values
    np.testing.assert_array_equal(cycle["edge_contact_share"], elastic.solve(phase).edge_share)
    assert float(cycle["edge_contact_share"].min()) > 0.03
    # a model of uncoupled springs knows no corner
    assert np.isnan(mesh_cycle(rig, hot_rig, MeshModel.thesis())["edge_contact_share"]).all()


def test_the_cycle_itself_says_where_no_oil_bath_exists() -> None:
    """One rule for runs, surveys and sweeps: hotter than its flash point no bath of oil is kept."""
    oil = replace(lubricant("FVA3"), flash_point=ZERO_CELSIUS + 200.0)
    pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    for oil_temperature, status in ((199.0, "ok"), (201.0, "no_oil_bath")):
        point = Operating(
            speed=[100.0],
            torque=[200.0],
            lubricant=oil,
            oil_temperature=ZERO_CELSIUS + oil_temperature,
            temperatures=Temperatures.uniform(353.15, reference=293.15),
            half_backlash=60e-6,
        )
        cycle = mesh_cycle(pair, point, mesh_positions=8, path_positions=5, want=["mean_stiffness"])
        assert STATUS[int(cycle["status"][0])] == status
