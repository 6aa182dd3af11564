"""Samples of a case as columns: the numbers of each case read by itself, in any company."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.vocabulary import STATUS
from thermogear.case import samples
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.family import GearFamily
from thermogear.case.samples import quasi_static, sampled, takes
from thermogear.case.thermal_state import HOT, UNDEFORMED

OWN = """
[gears]
module = "2 mm"
[gears.pinion]
teeth = 23
profile_shift = 0.2
face_width = "22 mm"
material = "mine"
[gears.wheel]
teeth = 61
face_width = "20 mm"
[materials.mine]
youngs_modulus = "205 GPa"
poisson_ratio = 0.29
density = "7800 kg/m^3"
thermal_conductivity = "40 W/(m K)"
specific_heat = "480 J/(kg K)"
thermal_expansion = "12e-6 1/K"
modulus_slope = "3e-4 1/K"
[oil]
name = "of the sheet"
viscosity_40 = "150 mm^2/s"
viscosity_100 = "15 mm^2/s"
density_15 = "885 kg/m^3"
[backlash]
value = "0.2 mm"
direction = "circumferential"
extent = "total"
[operating]
speed = "2500 rpm"
torque = "40 N m"
[transmission_error]
harmonics = [{order = 1, amplitude = "3 um"}, {order = 2, amplitude = "1 um", phase = "40 deg"}]
"""
HEAT = """
[temperatures]
pinion_addendum = "110 degC"
wheel_addendum = "95 degC"
pinion_bore_below_addendum = "15 K"
wheel_bore = "70 degC"
housing = "60 degC"
"""
OIL = 'temperature_below_addendum = "25 K"\n'

WANT = (
    "mesh_stiffness", "spring_error", "half_backlash", "jam_temperature",
    "proportional_jam_temperature", "friction_coefficient", "flash_temperature_dry",
    "film_parameter", "deformation_sum", "pair_stiffness", "frictional_power",
)  # fmt: skip
WIDE = {
    "operating.speed": (100.0, 400.0),
    "operating.torque": (10.0, 90.0),
    "dynamics.damping_ratio": (0.03, 0.15),
    "backlash.value": (0.1e-3, 0.3e-3),
    "gears.pinion.roughness": (0.2e-6, 0.8e-6),
    "gears.wheel.roughness": (0.2e-6, 0.8e-6),
    "gears.pinion.face_width": (15e-3, 30e-3),
    "gears.wheel.face_width": (15e-3, 30e-3),
    "oil.viscosity_40": (100e-6, 300e-6),
    "oil.viscosity_100": (10e-6, 20e-6),
    "oil.density_15": (860.0, 910.0),
    "materials.mine.youngs_modulus": (195e9, 215e9),
    "materials.mine.thermal_expansion": (11e-6, 13e-6),
    "temperatures.pinion_addendum": (360.0, 420.0),
    "temperatures.wheel_addendum": (350.0, 400.0),
    "temperatures.pinion_bore_below_addendum": (0.0, 30.0),
    "temperatures.wheel_bore": (320.0, 360.0),
    "temperatures.housing": (300.0, 350.0),
    "oil.temperature_below_addendum": (0.0, 40.0),
}


def given() -> GearCase:
    return gear_case(load_case(OWN.replace("[backlash]", OIL + "[backlash]") + HEAT))


def computed() -> GearCase:
    return gear_case(load_case(OWN))


def drawn(case: GearCase, count: int, seed: int = 18) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(seed)
    found = {name: rng.uniform(*ends, count) for name, ends in WIDE.items()}
    return {name: values for name, values in found.items() if takes(case, name)}


@pytest.mark.filterwarnings("ignore:foundation")
@pytest.mark.parametrize("make", [given, computed])
@pytest.mark.parametrize("bundle", ["consistent", "thesis"])
def test_each_sample_is_the_case_so_written(make, bundle) -> None:
    case = make().with_values({})
    model = next(m for m in case.models if m.name == bundle) if bundle == "consistent" else None
    if model is None:
        case = gear_case(load_case(case.text, {"model.bundle": "thesis"}))
        model = case.models[0]
    columns = drawn(case, 6)
    assert len(columns) == (11 if case.computed else len(WIDE))
    together = quasi_static(case, columns, 6, model, HOT, WANT, path_positions=11)
    assert not together["status"].any()
    worst = 0.0
    for row in range(6):
        alone = case.with_values({name: values[row] for name, values in columns.items()})
        cycle = HOT.cycle(alone, alone.models[0])
        few = alone.cycle(HOT.operating(alone, alone.models[0]), alone.models[0], 11)
        for name in WANT:
            one, many = few[name].values[0], together[name][row]
            size = max(np.nanmax(np.abs(one), initial=0.0), 1e-300)
            far = np.nanmax(np.abs(many - one), initial=0.0) / size
            assert np.array_equal(np.isnan(one), np.isnan(many)), name
            worst = max(worst, far)
            # a balance computed in company stops within its tolerance of the same state
            assert far < (1e-6 if case.computed else 1e-12), (name, far)
        assert float(cycle["mean_stiffness"][0]) > 0.0
    print(f"worst {worst:.2e}")


def test_company_order_and_chunks_change_no_bit(monkeypatch: pytest.MonkeyPatch) -> None:
    case = given()
    columns = drawn(case, 37, seed=7)
    whole = quasi_static(case, columns, 37, case.models[0], HOT, WANT, path_positions=11)
    order = np.random.default_rng(3).permutation(37)
    turned = {name: values[order] for name, values in columns.items()}
    for size in (1, 5, 16):
        monkeypatch.setattr(samples, "BATCH", size)
        again = quasi_static(case, turned, 37, case.models[0], HOT, WANT, path_positions=11)
        for name in WANT:
            assert np.array_equal(whole[name][order], again[name], equal_nan=True), (name, size)


def test_only_what_is_asked_for_is_computed(monkeypatch: pytest.MonkeyPatch) -> None:
    case = given()
    monkeypatch.setattr("thermogear.mesh.cycle.FrictionPath", None)
    found = quasi_static(case, {}, 1, case.models[0], HOT, ("half_backlash", "mean_stiffness"))
    assert set(found) == {
        "half_backlash", "mean_stiffness", "status", "pinion_speed", "pinion_torque",
    }  # fmt: skip
    with pytest.raises(InputError, match=r"want: got 'stifness'; did you mean '"):
        quasi_static(case, {}, 1, case.models[0], HOT, ("stifness",))


def test_a_sample_that_no_case_could_have_is_a_status() -> None:
    case = given()
    below = np.array([10.0, 500.0, 20.0])
    columns = {"temperatures.pinion_bore_below_addendum": below}
    found = quasi_static(case, columns, 3, case.models[0], HOT, ("half_backlash",))
    assert found["status"].tolist() == [0, STATUS.index("impossible"), 0]
    assert np.isnan(found["half_backlash"]).tolist() == [False, True, False]
    with pytest.raises(InputError, match=r"temperatures\.pinion_bore_below_addendum: got 500 K"):
        quasi_static(case, {k: v[1:2] for k, v in columns.items()}, 1, case.models[0], HOT, ())


def test_the_family_gives_motion_of_the_case_so_written() -> None:
    case = given()
    names = ("dynamics.damping_ratio", "gears.pinion.face_width", "backlash.value", "rpm")
    rows = np.column_stack([WIDE_of(n, 5) for n in names])
    together = GearFamily(case, names)(rows)
    for place, row in enumerate(rows):
        alone = GearFamily(case.with_values(dict(zip(names, row, strict=True))), ())
        one = alone(np.empty((1, 0)))
        for name in ("period", "damping", "half_backlash", "stiffness", "force"):
            here, many = getattr(one.flat, name)[0], getattr(together.flat, name)[place]
            assert np.allclose(here, many, rtol=1e-12, atol=1e-12 * np.max(np.abs(here))), name
        assert one.rate[0] == pytest.approx(together.rate[place], rel=1e-13)


def WIDE_of(name: str, count: int) -> np.ndarray:
    low, high = WIDE["operating.speed" if name == "rpm" else name]
    return np.linspace(low, high, count)


def test_fields_of_geometry_make_cases_of_their_own() -> None:
    case = given()
    names = ("gears.pinion.profile_shift", "operating.torque")
    rows = np.array([[0.1, 30.0], [0.2, 30.0], [0.1, 50.0], [0.3, 20.0]])
    found = GearFamily(case, names).quasi_static(rows, ("mean_stiffness", "half_backlash"))
    for place, row in enumerate(rows):
        alone = case.with_values(dict(zip(names, row, strict=True)))
        cycle = alone.cycle(HOT.operating(alone, alone.models[0]), alone.models[0])
        for name in ("mean_stiffness", "half_backlash"):
            assert found[name][place] == pytest.approx(float(cycle[name][0]), rel=1e-12)


def test_values_put_in_are_the_overrides_of_a_file() -> None:
    case = given()
    put = case.with_values({"face_width": 0.025, "gears.module": 0.0025, "torque": 55.0})
    text = {
        "gears.pinion.face_width": "0.025 m",
        "gears.wheel.face_width": "0.025 m",
        "gears.module": "0.0025 m",
        "operating.torque": "55.0 N*m",
    }
    read = gear_case(load_case(OWN.replace("[backlash]", OIL + "[backlash]") + HEAT, text))
    assert put.pair == read.pair
    assert put.torques == read.torques
    assert put.assumptions == read.assumptions
    assert put.inertias == read.inertias
    twice = put.with_values({"torque": 60.0})
    assert twice.torques == (60.0,)
    assert dict(twice.overrides)["operating.torque"].startswith("60.0")
    assert len(twice.overrides) == len(put.overrides)
    with pytest.raises(InputError, match=r"gears\.modul"):
        case.with_values({"gears.modul": 0.002})
    with pytest.raises(InputError, match=r"gears\.module"):
        case.with_values({"gears.module": -1.0})


def test_what_goes_into_columns_depends_on_the_case() -> None:
    rig = gear_case(load_example("rig"))
    assert takes(rig, "temperatures.housing_below_addendum")
    assert not takes(rig, "temperatures.housing")
    assert not takes(rig, "gears.pinion.profile_shift")
    hot, own = given(), computed()
    assert takes(hot, "gears.pinion.face_width")
    # the heat balance knows one width
    assert not takes(own, "gears.pinion.face_width")
    assert not takes(own, "temperatures.pinion_addendum")
    assert takes(own, "materials.mine.thermal_expansion")
    assert not takes(own, "materials.mine.density")


def test_undeformed_gears_know_no_heat() -> None:
    case = given()
    columns = drawn(case, 4)
    del columns["backlash.value"]
    found = quasi_static(case, columns, 4, case.models[0], UNDEFORMED, ("half_backlash",))
    cold = case.cold_backlash.half
    assert found["half_backlash"] == pytest.approx(np.full(4, cold), rel=1e-12)


def test_an_error_scales_with_its_column() -> None:
    case = given()
    made = sampled(case, {"error_amplitude": np.array([3e-6, 6e-6])}, 2)
    assert made.error == pytest.approx([1.0, 2.0], rel=1e-15)


def test_a_half_backlash_put_in_is_one_whatever_the_file_gives() -> None:
    put = given().with_values({"cold_half_backlash": 80e-6})
    assert put.cold_backlash.half == pytest.approx(80e-6, rel=1e-12)
    assert put.stated.half_backlash == pytest.approx(80e-6, rel=1e-12)
    assert gear_case(load_case(put.text, dict(put.overrides))).cold_backlash == put.cold_backlash


def test_threads_share_what_a_family_keeps() -> None:
    """More keys than are kept, asked for by several threads at once."""
    family = GearFamily(given(), ("pinion_torque",))
    rows = np.linspace(20.0, 60.0, 40)[:, None]
    alone = [GearFamily(given(), ("pinion_torque",))(row[None]).stiffness[0] for row in rows]
    with ThreadPoolExecutor(4) as pool:
        found = list(pool.map(lambda row: family(row[None]).stiffness[0], np.repeat(rows, 3, 0)))
    assert np.array_equal(found, np.repeat(alone, 3))


def test_a_balance_in_company_is_the_balance_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    case = computed()
    columns = drawn(case, 9, seed=11)
    want = ("mesh_stiffness", "half_backlash", "friction_coefficient")
    whole = quasi_static(case, columns, 9, case.models[0], HOT, want)
    order = np.random.default_rng(2).permutation(9)
    monkeypatch.setattr(samples, "BATCH", 4)
    turned = {name: values[order] for name, values in columns.items()}
    again = quasi_static(case, turned, 9, case.models[0], HOT, want)
    for name in want:
        assert np.array_equal(whole[name][order], again[name]), name
