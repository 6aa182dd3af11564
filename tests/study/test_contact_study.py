"""Relief and loaded contact of a case: never worse than before, the loop back into the file."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_example
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.gears.loaded import LoadedModel, loaded_contact
from thermogear.study.contact import loaded_survey
from thermogear.study.relief import UNIFORM, relief_survey
from thermogear.views.pages.relief import page


def rig(*changes: str) -> GearCase:
    case = load_example("rig", changes)
    assert isinstance(case, GearCase)
    return case


@pytest.fixture(scope="module")
def relief() -> xr.DataTree:
    return relief_survey(rig())


@pytest.fixture(scope="module")
def contact() -> xr.DataTree:
    return loaded_survey(rig("temperatures.row=[]"), (20.0, 100.0))


def test_relief_evens_the_loaded_mesh(relief: xr.DataTree) -> None:
    assert relief.attrs["relieved"] < 0.2 * relief.attrs["unrelieved"]
    error = relief["error"]["transmission_error"].values
    # drawn on finer positions than the search used
    np.testing.assert_allclose(np.ptp(error[0]), relief.attrs["unrelieved"], rtol=0.02)
    assert np.ptp(error[1]) < 0.25 * np.ptp(error[0])


def test_the_relief_put_into_the_case_gives_the_transmission_error_found(
    relief: xr.DataTree,
) -> None:
    changes = []
    for gear, one in json.loads(relief.attrs["reliefs"]).items():
        amount, length = f"{1e6 * one['amount_m']:.6f} um", f"{1e3 * one['length_m']:.9f} mm"
        changes.append(f'gears.{gear}.tip_relief={{amount="{amount}", length="{length}"}}')
    pasted = loaded_survey(rig("temperatures.row=[]", *changes), (100.0,))
    error = pasted["contact"]["transmission_error"].sel(temperature="hot").isel(load=0).values
    own = relief["error"]["transmission_error"].sel(pair_kind="relieved").values
    np.testing.assert_allclose(np.ptp(error), np.ptp(own), rtol=1e-4)
    assert relief.attrs["paste"].count("tip_relief]") == 2


def test_a_symmetric_relief_is_alike_on_both_gears_and_no_better(relief: xr.DataTree) -> None:
    both = relief_survey(rig(), symmetric=True)
    one, two = json.loads(both.attrs["reliefs"]).values()
    assert one == two
    assert relief.attrs["relieved"] <= 1.05 * both.attrs["relieved"]
    assert both.attrs["relieved"] < both.attrs["unrelieved"]
    bodies = [n.data["body"] for n in both.notices if n.code == "loaded_contact_unchecked"]
    assert bodies == ["rim"]  # of the model that it is computed with


def test_a_relief_needs_a_load() -> None:
    with pytest.raises(InputError, match=r"torque: got 0 N m; allowed > 0 N m"):
        relief_survey(rig("operating.torque=0 N m"))


def test_cold_contact_is_the_plain_loaded_contact(contact: xr.DataTree) -> None:
    case = rig()
    plain = loaded_contact(case.pair, 100.0 / case.pair.pinion.base_radius, UNIFORM)
    here = contact["contact"].sel(temperature="undeformed").isel(load=1)
    for name in ("tangent_stiffness", "secant_stiffness", "load_share"):
        np.testing.assert_allclose(here[name].values, plain[name].values, rtol=1e-9, atol=1e-12)


def test_function_command_and_case_file_read_the_hub_alike() -> None:
    case = rig("temperatures.row=[]", "model.bundle=consistent", "grid.mesh_positions=200")
    torque = case.torques[0]
    force = torque / case.pair.pinion.base_radius
    cold = case.cycle(UNDEFORMED.operating(case, case.models[0]), case.models[0])
    here = loaded_survey(case, (torque,))
    stiffness = [
        float(loaded_contact(case.pair, force, UNIFORM).mean_stiffness),
        float(here["contact"]["mean_stiffness"].sel(temperature="undeformed")[0]),
        float(cold["mean_stiffness"][0]),
    ]
    assert stiffness == pytest.approx([stiffness[-1]] * 3, rel=1e-9)
    # a case that holds its bodies at the bore is drawn so without an option
    held = loaded_survey(rig("temperatures.row=[]", 'model.body="bore-clamped"'), (torque,))
    assert (here.attrs["body"], held.attrs["body"]) == ("rim", "bore-clamped")
    softer = float(held["contact"]["mean_stiffness"].sel(temperature="undeformed")[0])
    clamped = LoadedModel(body="bore_clamped")
    assert softer == pytest.approx(
        float(loaded_contact(case.pair, force, UNIFORM, model=clamped).mean_stiffness), rel=1e-9
    )


def test_shares_add_up_and_tangent_is_the_stiffer(contact: xr.DataTree) -> None:
    data = contact["contact"]
    np.testing.assert_allclose(data["load_share"].sum("pair").values, 1.0, rtol=1e-9)
    assert np.all(data["tangent_stiffness"].values >= data["secant_stiffness"].values * (1 - 1e-9))
    assert list(data["temperature"].values) == ["undeformed", "hot"]


def test_double_contact_is_lost_at_light_load_between_unequally_hot_gears(
    contact: xr.DataTree,
) -> None:
    length = contact["base_pitch"]["double_contact_length"]
    equal = length.sel(temperature_difference=0.0)
    for kelvin in (-40.0, 40.0):
        uneven = length.sel(temperature_difference=kelvin)
        assert float(uneven[0]) < 0.05 * float(equal[0])
        assert float(uneven[-1]) > 0.9 * float(equal[-1])
    # 40 K hold the pairs apart up to a greater load than 20 K
    half = 0.5 * float(equal[0])
    reached = [
        int((length.sel(temperature_difference=kelvin).values > half).argmax())
        for kelvin in (20.0, 40.0)
    ]
    assert reached[0] < reached[1]
    # a hotter pinion and a hotter wheel are not mirror images
    error = contact["base_pitch"]["peak_to_peak_error"]
    one, two = (error.sel(temperature_difference=kelvin).values for kelvin in (-40.0, 40.0))
    assert np.max(np.abs(one - two) / two) > 0.02


def test_iso_stands_beside_the_model_within_its_usual_distance(contact: xr.DataTree) -> None:
    compared = contact["iso_6336"].isel(load=1)
    ratio = float(compared["iso_stiffness"]) / float(compared["loaded_stiffness"])
    assert 0.8 < ratio < 1.25


def test_a_pressure_on_a_tip_corner_is_left_out_with_its_reason(contact: xr.DataTree) -> None:
    data = contact["contact"]
    flags = data["edge_contact"].values
    assert np.array_equal(np.isnan(data["contact_pressure"].values), flags > 0)
    shares = (flags > 0).any(axis=-1).mean(axis=-1)
    np.testing.assert_array_equal(data["edge_contact_share"].values, shares)
    # heavier load, longer contact on the corners; the same over the light loads
    assert np.all(np.diff(shares, axis=1) > 0.0)
    light = contact["base_pitch"]["edge_contact_share"].sel(temperature_difference=0.0).values
    assert np.all(np.diff(light) >= 0.0)
    state, load = np.unravel_index(shares.argmax(), shares.shape)
    shares_of = {
        gear: float(data["load_share"].values[flags == bit].max())
        for gear, bit in (("wheel", 1), ("pinion", 2))
    }
    assert coded(str(contact.attrs["notices"]))["edge_contact_at_most"] == [
        {
            "state": str(data["temperature"].values[state]),
            "share": shares.max(),
            "torque": data["load"].values[load],
            "gear": "wheel" if shares_of["wheel"] > shares_of["pinion"] else "pinion",
            "load": max(shares_of.values()),
        }
    ]


def test_where_no_relief_helps_none_is_proposed(relief: xr.DataTree) -> None:
    result: Any = relief
    plain = json.loads(relief.attrs["reliefs"])
    none = {gear: row | {"amount_m": 0.0} for gear, row in plain.items()}
    told = "\n".join(page(result.with_(reliefs=none)).lines())
    assert "0.000" not in told
    assert "tip_relief" not in told
    assert "tip_relief" in "\n".join(page(result).lines())


def test_relief_takes_load_off_the_corners(relief: xr.DataTree) -> None:
    data = relief["error"]
    flags = data["edge_contact"].values
    assert np.array_equal(np.isnan(data["greatest_pressure"].values), flags > 0)
    plain, relieved = data["edge_contact_share"].values
    assert plain == np.mean(flags[0] > 0)
    assert 0.0 <= relieved < 0.5 * plain
    over = relief["loads"]["edge_contact_share"].values
    assert np.all(over[1] <= over[0])
    (told,) = coded(str(relief.attrs["notices"]))["edge_contact_of_relief"]
    assert told == {"without": plain, "relieved": relieved}
