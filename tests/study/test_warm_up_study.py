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
from thermogear.mesh.warm_up_fit import Fit, fit_factors, require_factors, until
from thermogear.study.warm_up import warm_up_survey
from thermogear.views.page import Table
from thermogear.views.pages.warm_up import answer, fit_sentence, page

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


# --- factors ---------------------------------------------------------------------------------

FIT_DUTY = Duty(
    time=60.0 * np.array([0.0, 12.0]),
    speed=np.array([300.0]),
    torque=np.array([200.0]),
    ambient=np.array([AMBIENT]),
)


@pytest.mark.slow
def test_factors_come_back_out_of_a_record_made_with_them() -> None:
    truth = {"oil_housing": 0.5}
    case = rig('gearbox.oil_housing_coefficient="100 W/(m^2 K)"')
    data = warm_up_survey(case, FIT_DUTY, moments=60)["course"].to_dataset()
    when = np.linspace(30.0, 720.0, 24)
    noise = np.random.default_rng(7).normal(0.0, 0.3, (when.size, 3))
    nodes = ("pinion_tooth", "oil", "housing")
    clean = [
        np.interp(when, data["time"].values, data["node_temperature"].sel(node=n).values)
        for n in nodes
    ]
    record = Measured(time=when, names=nodes, values=np.stack(clean, axis=1) + noise)
    tree = warm_up_survey(rig(), FIT_DUTY, measured=record, fit=tuple(truth), moments=24)
    found = json.loads(tree.attrs["fit"])
    for one in found["factors"]:
        assert one["low"] < truth[one["name"]] < one["high"]
        assert one["value"] == pytest.approx(truth[one["name"]], rel=0.1)
    # what is left is the noise that was put in
    assert found["rms_after_K"] == pytest.approx(np.sqrt(np.mean(noise**2)), rel=0.05)
    assert found["rms_before_K"] > 1.5 * found["rms_after_K"]
    assert found["runs"] < 40
    difference = tree["record"]["difference"].values
    assert np.sqrt(np.mean(difference**2)) == pytest.approx(found["rms_after_K"], rel=0.02)
    figures = numbers(page(tree).summary)
    for one in found["factors"]:
        assert any(figure == pytest.approx(one["value"], abs=0.006) for figure in figures)


def line(x: dict[str, float]) -> np.ndarray:
    return np.log(x["housing"]) * TIMES[:, None]


TIMES = np.linspace(0.1, 1.0, 200)


def test_independent_scatter_gives_the_textbook_interval() -> None:
    """One straight line: variance s^2/sum t^2, by hand."""
    noise = np.random.default_rng(3).normal(0.0, 0.05, TIMES.size)[:, None]
    found = fit_factors(lambda x: line(x) - 0.4 * TIMES[:, None] - noise, ["housing"])
    one = found.factors[0]
    assert one.low < np.exp(0.4) < one.high
    assert found.effective == pytest.approx(found.count, rel=0.2)
    half = 1.96 * 0.05 / np.sqrt(np.sum(TIMES**2))
    assert np.log(one.high / one.low) / 2.0 == pytest.approx(half, rel=0.25)
    assert np.isnan(found.correlation)


def test_readings_that_follow_each_other_count_for_few() -> None:
    """With AR(1) scatter the interval covers the truth about as often as it says."""
    generator, inside, widths = np.random.default_rng(11), 0, []
    for _ in range(200):
        shocks = generator.normal(0.0, 0.05 * np.sqrt(1.0 - 0.9**2), TIMES.size)
        noise = np.empty(TIMES.size)
        last = generator.normal(0.0, 0.05)
        for i, shock in enumerate(shocks):
            noise[i] = last = 0.9 * last + shock

        def off(x: dict[str, float], noise: np.ndarray = noise) -> np.ndarray:
            return line(x) - (0.4 * TIMES + noise)[:, None]

        found = fit_factors(off, ["housing"])
        one = found.factors[0]
        inside += one.low < np.exp(0.4) < one.high
        widths.append(found.effective)
    assert np.median(widths) < 30.0
    assert 0.85 < inside / 200.0 <= 1.0


def test_what_a_record_cannot_tell_is_said() -> None:
    with pytest.raises(InputError, match=r"^fit: got 'shafts'; the record says nothing of it"):
        fit_factors(lambda x: np.ones((5, 1)), ["shafts"])
    few: Fit = fit_factors(lambda x: line(x)[:1] - 0.03, ["housing"])
    assert np.isnan(few.factors[0].low)
    with pytest.raises(
        InputError, match=r"^--fit: got 'houzing'; allowed .*; did you mean 'housing'"
    ):
        require_factors(["houzing"], "--fit")
    for names in ([], ["housing", "shafts", "wetted"], ["housing", "housing"]):
        with pytest.raises(InputError, match=r"^fit: got .*; allowed one or two different factors"):
            require_factors(names, "fit")
    message = r"^fit: got housing; there is no record to fit to; give measured too$"
    with pytest.raises(InputError, match=message):
        warm_up_survey(rig(), WORK, fit=["housing"])


def test_a_duty_is_cut_at_the_end_of_the_record() -> None:
    part = until(WORK, 900.0)
    assert part.time.tolist() == [0.0, 720.0, 900.0]
    assert part.torque.tolist() == [150.0, 0.0]
    assert until(WORK, 1e9).time.tolist() == WORK.time.tolist()


def test_rows_after_the_end_are_left_out_with_a_word() -> None:
    record = Measured(
        time=np.array([30.0, 60.0, 1e4]), names=("oil",), values=np.full((3, 1), 300.0)
    )
    short = until(WORK, 60.0)
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
    assert fit_sentence({}) == ""
