"""All friction laws of a case: the very values of each law, ranges kept, shares that add up."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear.case.case import GearCase, load_example
from thermogear.heat.friction import LAWS
from thermogear.mesh.cycle import mesh_cycle
from thermogear.study.friction import friction_survey


def rig(*changes: str) -> GearCase:
    case = load_example("rig", ["grid.path_positions=41", *changes])
    assert isinstance(case, GearCase)
    return case


@pytest.fixture(scope="module")
def laws() -> xr.Dataset:
    return friction_survey(rig())["laws"].to_dataset()


def test_every_law_of_the_table_is_there(laws: xr.Dataset) -> None:
    assert [str(n) for n in laws["law"].values] == list(LAWS)
    assert np.isfinite(laws["friction_coefficient"].values).all()
    np.testing.assert_allclose(laws["friction_coefficient"].sel(law="dry").values, 0.2)


@pytest.mark.parametrize("law", ["benedict-kelley", "lambda-blend", "schlenk"])
def test_a_law_has_the_value_that_the_mesh_cycle_computes_with(law: str, laws: xr.Dataset) -> None:
    case = rig(f"model.friction={law}")
    cycle = mesh_cycle(case.pair, case.operating, case.models[0], path_positions=41)
    np.testing.assert_allclose(
        laws["friction_coefficient"].sel(law=law).values,
        cycle["friction_coefficient"].values,
        rtol=1e-12,
    )


def test_regimes_cover_the_path_and_follow_the_film(laws: xr.Dataset) -> None:
    np.testing.assert_allclose(laws["regime_share"].sum("regime_name").values, 1.0, atol=1e-12)
    film = laws["film_parameter"].values
    np.testing.assert_array_equal(laws["regime"].values == 0, film < 1.0)


def test_the_mean_lies_between_least_and_greatest(laws: xr.Dataset) -> None:
    mu, mean = laws["friction_coefficient"], laws["mean_friction"].values
    assert np.all(mean >= mu.min("path_position").values - 1e-15)
    assert np.all(mean <= mu.max("path_position").values + 1e-15)


def test_a_law_without_a_value_says_why_and_the_others_stay() -> None:
    rough = ['gears.pinion.roughness="1.2 um"', 'gears.wheel.roughness="1.2 um"']
    tree = friction_survey(rig("model.friction=dry", *rough))
    data = tree["laws"]
    assert np.isnan(data["friction_coefficient"].sel(law="benedict-kelley").values).all()
    assert np.isfinite(data["friction_coefficient"].sel(law="iso-13989-2").values).all()
    assert np.all(data["outside_range"].sel(law="xu-kahraman").values == 1)
    told = coded(str(tree.attrs["notices"]))["law_without_value"]
    (reason,) = (one["reason"] for one in told if one["about"] == "benedict-kelley")
    assert reason.startswith("roughness: got 1.2 um")
