"""The closed loop over a grid, its cross-checks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from coded import coded
from said import numbers
from thermogear.base.display import span
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase, load_example
from thermogear.case.size import require_points
from thermogear.heat.scuffing import scuffing_temperature
from thermogear.mesh.balance import heat_balance
from thermogear.mesh.cycle import mesh_cycle
from thermogear.study.notices import heat_notices
from thermogear.study.scuffing import load_stage, not_steel
from thermogear.study.temperature import MESH_POSITIONS, PATH_POSITIONS, thermal_map
from thermogear.views.pages.temperature import page
from thermogear.views.pages.temperature import thermal_map as drawn

RPM = np.pi / 30.0
STEEL = MATERIALS["steel"]
SPEEDS = tuple(RPM * np.array([500.0, 1500.0, 2500.0]))
TORQUES = (50.0, 100.0)


def rig(*changes: str) -> GearCase:
    case = load_example("rig", ['model.bundle="consistent"', *changes])
    assert isinstance(case, GearCase)
    return case


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    return thermal_map(rig(), SPEEDS, TORQUES)


def test_a_point_of_the_map_is_the_point_alone(tree: xr.DataTree) -> None:
    case = rig()
    alone = heat_balance(
        case.pair,
        SPEEDS[1],
        TORQUES[1],
        case.stated.lubricant,
        case.cold_backlash.half,
        gearbox=case.gearbox,
    )
    cycle = mesh_cycle(
        case.pair,
        alone.operating,
        path_positions=PATH_POSITIONS,
        mesh_positions=MESH_POSITIONS,
    )
    here = tree["map"].isel(pinion_speed=1, pinion_torque=1)
    node = here["node_temperature"]
    for name in ("oil", "pinion_tooth", "housing"):
        assert float(node.sel(node=name)) == pytest.approx(
            float(np.ravel(alone.steady[name])[0]), abs=1e-5
        )
    assert float(here["greatest_flash"]) == pytest.approx(
        float(cycle["flash_temperature"].max()), rel=1e-6
    )
    assert float(here["least_half_backlash"]) == pytest.approx(
        float(cycle["half_backlash_curve"].min()), rel=1e-6
    )
    assert int(here["status"]) == STATUS.index("ok")
    assert float(here["residual"]) <= 1e-6


def test_the_scuffing_margin_is_what_the_contact_leaves_of_the_limit(tree: xr.DataTree) -> None:
    grid = tree["map"]
    left = scuffing_temperature(12.0) - grid["greatest_contact_temperature"].values
    np.testing.assert_allclose(grid["scuffing_margin"].values, left, rtol=1e-12)


def test_without_a_load_stage_the_margin_is_that_of_the_stage_the_answers_assume() -> None:
    case = replace(rig(), scuffing_load_stage=None)
    bare = thermal_map(case, SPEEDS[:1], TORQUES[:1])
    grid = bare["map"]
    left = scuffing_temperature(load_stage(case).stage) - grid["greatest_contact_temperature"]
    np.testing.assert_allclose(grid["scuffing_margin"].values, left.values, rtol=1e-12)
    assert coded(bare.notices)["scuffing_stage_assumed"] == [{"stage": 12}]
    # the stage is one of steel on steel
    soft = replace(case.pair.wheel, material=replace(STEEL, youngs_modulus=3e9))
    other = replace(case, pair=replace(case.pair, wheel=soft))
    assert load_stage(other).assumed
    assert not_steel(other) == STEEL.name
    assert not_steel(case) == ""


def test_a_map_without_a_margin_keeps_its_axes(tree: xr.DataTree) -> None:
    """They run over the speeds and torques of the map, as those of the other panels do."""
    data = tree["map"].to_dataset()
    empty = drawn(data.assign(scuffing_margin=data["scuffing_margin"] * np.nan)).panels[1][1]
    speed, torque = data["pinion_speed"].values / RPM, data["pinion_torque"].values
    assert (empty.x.low, empty.x.high) == pytest.approx((speed.min(), speed.max()))
    assert (empty.y.low, empty.y.high) == (torque.min(), torque.max())


@pytest.mark.slow
def test_a_tight_pair_jams_where_the_teeth_pass_the_jam_temperature() -> None:
    # the housing held cold: hot gears close the gap
    case = rig('gearbox.measured.housing="20 degC"', 'backlash.value="0.014 mm"')
    grid = thermal_map(case, SPEEDS, (50.0, 200.0))["map"]
    jammed = grid["status"].values == STATUS.index("jammed")
    assert jammed.any()
    assert not jammed.all()
    np.testing.assert_array_equal(jammed, grid["least_half_backlash"].values <= 0.0)
    teeth = grid["node_temperature"].sel(node="pinion_tooth").values
    np.testing.assert_array_equal(jammed, teeth >= grid["jam_temperature"].values - 1e-6)


@pytest.mark.slow
def test_a_cooler_keeps_the_oil_on_its_line_and_flash_then_falls_with_speed() -> None:
    # by this law; the film-weighted one rises with speed here
    case = rig('gearbox.oil_flow="5 l/min"', 'model.friction="benedict-kelley"')
    cooled = thermal_map(case, tuple(RPM * np.array([1000.0, 3500.0, 6000.0])), (100.0, 300.0))
    assert np.all(cooled["map"]["within_oil_range"].values == 1)
    flash = cooled["map"]["greatest_flash"].values
    assert np.diff(flash, axis=0).min() < 0.0
    assert np.diff(flash, axis=1).min() > 0.0


def test_a_huge_map_is_refused_before_it_runs() -> None:
    with pytest.raises(InputError, match=r"map: got about 37.3 GiB for 1000000 operating points"):
        require_points(10**6, free=8 * 2**30)
    assert require_points(10**6, forced=True, free=8 * 2**30) == 40_000_000_000


def test_one_point_that_cannot_be_computed_does_not_cost_the_map() -> None:
    case = rig('gearbox.ambient="-40 degC"')
    tree = thermal_map(case, tuple(RPM * np.array([10.0, 2000.0])), (10.0, 200.0))
    grid = tree["map"]
    lost = STATUS.index("heat_not_settled")
    np.testing.assert_array_equal(grid["status"].values == lost, [[True, True], [False, False]])
    for name in ("greatest_flash", "least_half_backlash", "mean_friction"):
        np.testing.assert_array_equal(np.isnan(grid[name].values), grid["status"].values == lost)
    (told,) = coded(tree.notices)["heat_not_settled"]
    assert (told["lost"], told["points"]) == (2, 4)
    assert {reason.partition(":")[0] for reason in told["reasons"]} == {"prandtl"}


def test_reasons_alike_but_for_their_numbers_are_one() -> None:
    """Count and range; what is said once, or always the same, stays as it is."""
    settled = np.array([True, *[False] * 6])
    data = xr.Dataset({"several": ("point", np.zeros(7, np.int8))})
    why = [f"prandtl: got {got}; allowed 0.1 .. 1e6" for got in ("1.2e6", "8e6", "2.5e6")]
    why += ["a node: {mesh} stays", "oil: got 5", "oil: got 5"]
    (told,) = heat_notices(data, settled, why)
    assert told.data["reasons"] == [
        "prandtl: got 1.2e6 to 8e6; allowed 0.1 .. 1e6 (3 points)",
        "a node: {mesh} stays",
        "oil: got 5",
    ]
    assert numbers(told.text)[:2] == [6.0, 7.0]
    assert "points" in told.text
    (one,) = heat_notices(data.isel(point=[1]), settled[1:2], why[-1:])
    assert numbers(one.text)[:2] == [1.0, 1.0]
    assert "points" not in one.text
    assert "motion" not in one.text


def test_the_map_says_where_two_states_are_steady() -> None:
    case = rig('model.friction="benedict-kelley"', 'model.inlet="oil"')
    tree = thermal_map(case, tuple(RPM * np.array([1000.0, 4085.0])), (20.0,))
    assert tree["map"]["several"].values.tolist() == [[0], [1]]
    (told,) = coded(tree.notices)["second_steady_state"]
    assert (told["several"], told["points"]) == (1, 2)


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
def test_a_point_that_does_not_settle_has_a_status_and_no_number() -> None:
    case = rig(
        'gearbox.housing_coefficient="1 W/(m^2 K)"', 'gearbox.housing_area="0.1 m^2"',
        'gearbox.ambient="40 degC"',
    )  # fmt: skip
    tree = thermal_map(case, tuple(RPM * np.array([100.0, 6000.0])), (10.0, 5000.0))
    grid = tree["map"]
    lost = grid["status"].values == STATUS.index("heat_not_settled")
    assert lost.any()
    assert not lost.all()
    for name, values in grid.data_vars.items():
        if values.dtype.kind != "f":
            continue
        known = np.isfinite(values.transpose("pinion_speed", "pinion_torque", ...).values)
        assert not known[lost].any(), name
        if name not in ("hot_node_temperature", "proportional_jam_temperature"):
            assert known[~lost].any(), name
    assert not (grid["tempered"].values[lost] | grid["within_oil_range"].values[lost]).any()
    frame = tree.to_frame()
    rows = frame["status"] == "heat_not_settled"
    assert int(rows.sum()) == int(lost.sum())
    assert frame.loc[rows, "greatest_flash [K]"].isna().all()
    (line,) = (one for one in page(tree).lines() if one.startswith("  greatest flash"))
    assert line.endswith(span(grid["greatest_flash"].values[~lost]))


@pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")
def test_a_point_without_an_oil_bath_has_its_status() -> None:
    """The survey's rows, its notices and the warm-up tell one and the same bath."""
    case = rig("oil.flash_point=40 degC", "operating.speed=1500 rpm", "operating.torque=200 N m")
    result = thermal_map(case, (SPEEDS[1],), (200.0,))
    there = result.groups["map"]
    oil = there["node_temperature"].sel(node="oil").values
    assert np.all(oil > case.stated.lubricant.hottest_bath)
    assert np.all(there["status"].values == STATUS.index("no_oil_bath"))
    assert coded(result.notices)["no_oil_bath"] == [{"hot": 1, "points": 1, "hottest": 423.15}]
