"""A case through its duty: the answer, sensors against their rules, factors out of a record."""

from __future__ import annotations

import json
import warnings
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from coded import coded
from own_pair import OWN_PAIR
from said import numbers
from thermogear.base.errors import InputError
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.case.duty import Measured, chosen_point
from thermogear.case.sensors import flank_area, shaft_share
from thermogear.heat.measured_temperature import InfraredReading, surface_temperature
from thermogear.mesh.warm_up import Duty
from thermogear.study.warm_up import warm_up_survey
from thermogear.views.page import Table
from thermogear.views.pages.warm_up import answer, page

QUICK = [
    'model.bundle="consistent"', 'model.friction="benedict-kelley"',
    'model.stiffness="textbook-30-degree"', 'model.sharing="equal"',
]  # fmt: skip
AMBIENT = 293.15


def rig(*changes: str) -> GearCase:
    case = load_example("rig", [*QUICK, *changes])
    assert isinstance(case, GearCase)
    return case


WORK = Duty(
    time=60.0 * np.array([0.0, 12.0, 16.0, 20.0]),
    speed=np.array([314.0, 314.0, 0.0]),
    torque=np.array([150.0, 0.0, 0.0]),
    ambient=np.array([AMBIENT, AMBIENT, AMBIENT - 10.0]),
)


@pytest.fixture(scope="module")
def tree() -> xr.DataTree:
    return warm_up_survey(rig(), WORK, moments=90)


def test_the_worst_moment_stands_in_its_own_curve(tree: xr.DataTree) -> None:
    worst, data = json.loads(tree.attrs["worst"]), tree["course"].to_dataset()
    left = data["half_backlash"].values
    assert worst["half_backlash_m"] <= left.min() + 1e-12
    assert worst["time_s"] == pytest.approx(float(data["time"][int(np.argmin(left))]), abs=2.0)
    steady = float(tree["steady"]["half_backlash"][worst["piece"]])
    assert worst["below_steady_m"] == pytest.approx(steady - worst["half_backlash_m"])
    assert data["jam_margin"].values.min() == pytest.approx(worst["margin_K"], abs=0.05)
    assert float(data["imbalance"].max()) < 1e-6
    assert tree.attrs["greatest_imbalance"] < 1e-6


def test_a_jam_beyond_what_the_gears_bear_is_told_by_what_they_bear(tree: xr.DataTree) -> None:
    """Hotter by 2000 K no steel is a gear: the words end at the tempering, 180 degC."""
    worst = json.loads(tree.attrs["worst"])
    tooth = worst["temperatures_K"]["pinion_tooth"] - ZERO_CELSIUS
    assert worst["borne_K"] == pytest.approx(180.0 - tooth)
    far = answer(worst | {"margin_K": 2000.0, "half_backlash_m": 1e-4}, 1e-4)
    near = answer(worst | {"margin_K": 20.0, "half_backlash_m": 1e-4}, 1e-4)
    assert (180.0 in numbers(far), 2000.0 in numbers(far)) == (True, False)
    assert (180.0 in numbers(near), 20.0 in numbers(near)) == (False, True)


def test_a_stop_has_no_flash_no_film_and_no_stiffness(tree: xr.DataTree) -> None:
    data = tree["course"].to_dataset()
    idle, still = data["pinion_torque"].values == 0.0, data["pinion_speed"].values == 0.0
    np.testing.assert_array_equal(data["greatest_flash"].values[idle], 0.0)
    for name in ("least_film_parameter", "mean_stiffness", "mean_friction"):
        assert np.isnan(data[name].values[idle]).all()
        assert np.isfinite(data[name].values[~idle]).all()
    assert np.all(data["loss"].sel(loss_kind="churning").values[still] == 0.0)
    assert "free_convection_at_rest" in coded(str(tree.attrs["notices"]))


def test_each_piece_held_for_good_is_the_heat_balance(tree: xr.DataTree) -> None:
    steady = tree["steady"].to_dataset()
    assert steady["settled"].values.tolist() == [1, 1, 1]
    # at rest everything is as warm as the ambient: 10 K below the drawing, all alike
    node = steady["node_temperature"].isel(piece=2).values
    np.testing.assert_allclose(node, AMBIENT - 10.0, atol=1e-3)
    assert float(steady["half_backlash"][2]) == pytest.approx(125e-6, rel=1e-4)


def test_sensors_follow_their_rules_backwards(tree: xr.DataTree) -> None:
    case, data = rig(), tree["course"].to_dataset()
    pinion = case.pair.pinion
    shown, true = data["sensor_temperature"], data["true_temperature"]
    loss = data["loss"].sel(loss_kind="mesh").values
    thermocouple = shown.sel(sensor="thermocouple").values
    # T = T_tc + q d/k with the flux of the mesh loss over the flanks
    share = (true.sel(sensor="thermocouple").values - thermocouple) / np.where(loss > 0, loss, 1.0)
    share *= pinion.material.thermal_conductivity / 2e-3 * flank_area(case.pair, pinion)
    assert np.all((share[loss > 0.0] > 0.3) & (share[loss > 0.0] < 0.8))
    flux = share * loss / flank_area(case.pair, pinion)
    back = surface_temperature(thermocouple, flux, 2e-3, pinion.material.thermal_conductivity)
    np.testing.assert_allclose(back, true.sel(sensor="thermocouple").values, rtol=1e-12)
    # the camera: what the correction makes of its reading is the flank
    for place in (0, 40, -1):
        here = data.isel(moment=place)
        reading = InfraredReading(
            indicated=float(here["sensor_temperature"].sel(sensor="infrared")),
            emissivity=0.9,
            transmission=0.93,
            surroundings=float(here["node_temperature"].sel(node="housing")),
            path=float(here["node_temperature"].sel(node="ambient")),
            band=(8e-6, 14e-6),
        )
        assert reading.temperature() == pytest.approx(
            float(here["node_temperature"].sel(node="pinion_tooth")), abs=1e-6
        )
    # the ring lies between shaft and housing
    ring = shown.sel(sensor="ring").values
    shaft = data["node_temperature"].sel(node="pinion_shaft").values
    housing = data["node_temperature"].sel(node="housing").values
    fall = shaft_share(pinion, case.gearbox.surroundings, 0.02)
    np.testing.assert_allclose(ring, shaft - fall * (shaft - housing), rtol=1e-12)
    assert 0.0 < fall < 1.0
    assert shaft_share(pinion, case.gearbox.surroundings, 0.0) == 0.0


def test_the_thermocouple_of_the_fzg_test_is_off_by_the_known_kelvins() -> None:
    """Known: about 1.5 K for each millimetre at 200 N m, the heat spread over the whole flank.

    Over the part that touches, 8.0 mm of some 10 mm, it is a quarter more.
    """
    from thermogear import Gear, GearPair

    pair = GearPair(
        Gear(16, 4.5e-3, profile_shift=0.1817, face_width=14e-3, bore_radius=15e-3),
        Gear(24, 4.5e-3, profile_shift=0.1715, face_width=14e-3, bore_radius=15e-3),
    )
    flux = 0.5 * 316.0 / flank_area(pair, pair.pinion)
    per_millimetre = 1e-3 * flux / pair.pinion.material.thermal_conductivity
    assert 1.5 < per_millimetre < 2.0
    whole = (pair.pinion.tip_radius - pair.pinion.root_radius) / (8.0e-3)
    assert per_millimetre / whole == pytest.approx(1.5, rel=0.07)


def test_the_case_says_how_the_sensors_look() -> None:
    case = rig(
        'sensors.thermocouple={gear="wheel", depth="0 mm"}', 'sensors.ring.distance="0 mm"',
        "sensors.infrared={emissivity=1.0, transmission=1.0}",
    )  # fmt: skip
    short = Duty(
        time=np.array([0.0, 60.0]), speed=np.array([200.0]), torque=np.array([100.0]),
        ambient=np.array([AMBIENT]),
    )  # fmt: skip
    data = warm_up_survey(case, short, moments=12)["course"].to_dataset()
    np.testing.assert_allclose(
        data["sensor_temperature"].values, data["true_temperature"].values, atol=1e-6
    )
    np.testing.assert_array_equal(
        data["true_temperature"].sel(sensor="thermocouple").values,
        data["node_temperature"].sel(node="wheel_tooth").values,
    )
    far = rig('sensors.ring.distance="90 mm"')
    with pytest.raises(
        InputError, match=r"^sensors\.ring\.distance: got 90 mm; allowed 0\.\.60 mm"
    ):
        warm_up_survey(far, short)
    with pytest.raises(InputError, match=r"^sensors\.infrared\.wavelengths: got 14 um before 8 um"):
        rig('sensors.infrared.wavelengths=["14 um", "8 um"]')
    with pytest.raises(InputError, match=r"^sensors\.ring\.depth: got an unknown key; "):
        rig('sensors.ring.depth="2 mm"')


def test_without_a_table_the_strongest_point_is_held_until_steady() -> None:
    case = rig('operating.torque=["50 N m", "120 N m"]', 'operating.speed=["500 rpm", "1500 rpm"]')
    speed, torque = chosen_point(case)
    assert (speed, torque) == (pytest.approx(1500.0 * np.pi / 30.0), 120.0)


def test_rows_after_the_end_are_left_out_with_a_word() -> None:
    record = Measured(
        time=np.array([30.0, 60.0, 1e4]), names=("oil",), values=np.full((3, 1), 300.0)
    )
    short = Duty(
        time=np.array([0.0, 60.0]), speed=WORK.speed[:1], torque=WORK.torque[:1],
        ambient=WORK.ambient[:1],
    )  # fmt: skip
    tree = warm_up_survey(rig(), short, measured=record, moments=12)
    assert tree["record"].sizes["row"] == 2
    assert coded(tree.notices)["rows_after_end"] == [{"rows": 1}]
    late = Measured(time=np.array([1e4]), names=("oil",), values=np.full((1, 1), 300.0))
    with pytest.raises(InputError, match=r"^measured: got no row within the course"):
        warm_up_survey(rig(), short, measured=late)


def test_the_least_lies_between_the_moments_that_are_told(tree: xr.DataTree) -> None:
    worst, data = json.loads(tree.attrs["worst"]), tree["course"].to_dataset()
    begin, end = worst["between_s"]
    assert begin <= worst["time_s"] <= end
    time, left = data["time"].values, data["half_backlash"].values
    inside = (time >= begin) & (time <= end)
    assert np.all(left[inside] <= worst["half_backlash_m"] + worst["flat_m"])
    for edge in (time[time < begin].max(initial=-1.0), time[time > end].min(initial=np.inf)):
        assert np.all(left[time == edge] > worst["half_backlash_m"] + worst["flat_m"])


def test_a_pair_without_backlash_jams_from_the_start() -> None:
    """Text, data and JSON tell one moment, 0."""
    duty = replace(WORK, time=np.array([0.0, 30.0, 60.0, 90.0]))
    found = warm_up_survey(rig('backlash.value="0.01 um"'), duty, moments=12)
    assert float(found.groups["course"]["half_backlash"][0]) <= 0.0
    assert found.values("jams")[0] == 0.0
    assert coded(found.notices)["pair_jams"] == [{"time": 0.0}]
    assert page(found).figures["jams_s"][0] == 0.0


def test_a_course_says_from_when_on_it_has_no_oil_bath() -> None:
    """The crossing between two stored moments stands in the notice, however many are stored."""
    case = load_case(OWN_PAIR, [*QUICK[1:2], "oil.flash_point=40 degC"])
    assert isinstance(case, GearCase)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        some, more = (warm_up_survey(case, moments=n) for n in (30, 75))
    told, again = (coded(found.notices)["no_bath_from"][0] for found in (some, more))
    assert told["hottest"] == pytest.approx(313.15)
    course = some.groups["course"]
    time, oil = course["time"].values, course["node_temperature"].sel(node="oil").values
    place = int(np.argmax(oil > 313.15))
    assert time[place - 1] < told["time"] < time[place]
    straight = np.interp(313.15, oil[place - 1 : place + 1], time[place - 1 : place + 1])
    assert told["time"] == pytest.approx(straight, abs=0.05 * (time[place] - time[place - 1]))
    assert told["time"] == pytest.approx(again["time"], rel=1e-3)


# --- in words, and another pair --------------------------------------------------------------


def test_the_page_of_another_pair_speaks_of_it() -> None:
    case = load_case(OWN_PAIR, QUICK[1:2])
    assert isinstance(case, GearCase)
    work = Duty(
        time=np.array([0.0, 900.0, 1800.0]), speed=np.array([157.0, 157.0]),
        torque=np.array([80.0, 20.0]), ambient=np.array([AMBIENT, AMBIENT]),
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        tree = warm_up_survey(case, work, moments=30)
    shown = page(tree)
    assert 75.0 in numbers(shown.summary)
    assert "25:75" not in shown.summary
    for one in shown.pictures:
        one.make()
    blocks = [block for section in shown.sections for block in section.blocks]
    assert sum(isinstance(block, Table) for block in blocks) == 3


def test_answers_in_words() -> None:
    known = {
        "half_backlash_m": 60e-6, "time_s": 1020.0, "margin_K": 61.0,
        "between_s": [960.0, 1140.0], "flat_m": 5e-8,
        "steady_half_backlash_m": 70e-6, "below_steady_m": 10e-6, "loss_above_steady": 0.25,
        "pinion_speed_rpm": 3000.0, "pinion_torque_Nm": 100.0,
        "at_the_end": False, "at_the_start": False,
    }  # fmt: skip
    said = [3000.0, 100.0, 60.0, 110.0, 10.0, 70.0, 25.0, 61.0]
    assert numbers(answer(known, 110e-6)) == [16.0, 19.0, 0.05, *said]
    assert numbers(answer(known | {"between_s": [1020.0, 1020.0]}, 110e-6)) == [17.0, *said]
    jammed = answer(known | {"half_backlash_m": -1e-6, "margin_K": -2.0}, 110e-6)
    assert "jammed" in jammed
    assert "hotter" not in jammed
    start = answer(known | {"at_the_start": True}, 110e-6)
    assert 17.0 not in numbers(start)
    end = answer(known | {"at_the_end": True, "below_steady_m": -1e-6}, 110e-6)
    assert numbers(end)[0] == 17.0
    assert 70.0 in numbers(end)
