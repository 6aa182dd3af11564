"""Diagrams, maps and basins of drive trains: against the pair, each other, and ``run``."""

from __future__ import annotations

import pickle
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import xarray as xr

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.plan import gather, keep_going, keys_of, region_of
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import ASSUMED
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.study.diagrams import Train, case_basins, case_diagram, case_map, train_maps
from thermogear.study.notices import finished
from thermogear.study.shafts.motion import train_motion
from thermogear.views.pages.findings import lost_rows, lost_words
from thermogear.views.plots.lost_contact import lost_contact_picture, lost_of
from thermogear.views.write import page_of

pytestmark = pytest.mark.filterwarnings("ignore:.*foundation of the gear")
PAIR = """
[gears]
module = "3 mm"
face_width = "{width}"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[oil]
name = "ISO VG 100"
temperature = "60 degC"
[temperatures]
pinion_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_addendum = "85 degC"
wheel_bore = "75 degC"
housing = "55 degC"
[operating]
speed = "{speed}"
torque = "{torque}"
[dynamics]
damping_ratio = 0.08
[transmission_error]
harmonics = [{{ order = 1, amplitude = "6 um", phase = "0 deg" }}]
[model]
stiffness = "textbook-30-degree"
sharing = "equal"
friction = "dry"
dry_coefficient = {friction}
[train]
elements = 2
gravity = false
"""
NOTHING = "Nothing loses contact."
UNKNOWN = "Of no point it is known what loses contact."
SCATTERED = "The drive flank parts at 17 % of the points."
SAID = (
    "The drive flank parts from 3000 to 3300 rpm (last computed), from 80 to 100 °C (last "
    "computed); the back flank is hit at 3300 rpm (last computed), at 100 °C (last computed); "
    "bearing pinion right is unloaded at times at 40 °C (first computed)."
)
CLASSES = [
    "unloaded at times: pinion left",
    "unloaded at times: pinion left, pinion right",
    "not known",
]
FEW = Train(coordinates=13)


def shaft(gear: str, length: str, diameter: str, bearings: str) -> str:
    return (
        f'\n[[shafts]]\ngear = "{gear}"\nlength = "{length}"\ndiameter = "{diameter}"\n{bearings}\n'
    )


@cache
def stiff() -> GearCase:
    """Heavy gears, narrow as they are, between bearings of 1e13 N/m: the pair alone moves."""
    text = PAIR.format(width="4 mm", speed="220 rpm", torque="3 N m", friction=0.001)
    text += '\n[inertia]\nmodel = "given"\npinion = "2e-2 kg m^2"\nwheel = "2e-1 kg m^2"\n'
    for gear in ("pinion", "wheel"):
        text += shaft(gear, "10 mm", "28 mm", "")
        for at in ("2.6 mm", "7.4 mm"):
            text += f'\n[[bearings]]\nshaft = "{gear}"\nposition = "{at}"\nstiffness = "1e7 N/um"\n'
    return gear_case(load_case(text))


@cache
def own(torque: str = "60 N m") -> GearCase:
    """A pair in four ball bearings."""
    text = PAIR.format(width="30 mm", speed="3000 rpm", torque=torque, friction=0.05)
    text += shaft("pinion", "120 mm", "25 mm", 'bearings = "6205"')
    text += shaft("wheel", "120 mm", "30 mm", 'bearings = "6206"')
    return gear_case(load_case(text))


AXES = {
    "pinion_speed": np.array([2000.0, 3000.0, 3300.0]) * RPM,
    "gear_temperature": np.array([40.0, 90.0]) + ZERO_CELSIUS,
}


@cache
def mapped() -> xr.Dataset:
    return gather(case_map(own(), AXES, refine=False, train=FEW), threads=1)


def equal(one: xr.Dataset, other: xr.Dataset) -> None:
    assert set(one.variables) == set(other.variables)
    for name in one.variables:
        assert one[name].values.tobytes() == other[name].values.tobytes(), name


def test_a_train_in_stiff_bearings_is_the_pair(compared: Compared) -> None:
    speeds = np.array([100.0, 220.0, 360.0, 500.0]) * RPM
    train = gather(case_diagram(stiff(), "pinion_speed", speeds, branch_period=0, train=FEW))
    pair = gather(case_diagram(stiff(), "pinion_speed", speeds, branch_period=0))
    for name in ("label", "period"):
        assert train[name].values.tolist() == pair[name].values.tolist()
    share = train["drive_share"].values - pair["drive_share"].values
    assert pair["drive_share"].values.min() < 0.5
    compared("share of time in drive contact, bearings of 1e13 N/m", "the pair alone", share, 5e-3)
    # the deflection of the train's teeth holds their error, the pair's does not
    away = train["point_x"].values - pair["point_x"].values
    held = pair["drive_share"].values > 0.999
    assert held.sum() >= 4
    assert np.ptp(away[held]) < 5e-3
    assert np.all(train["bearing_free_share"].values == 0.0)


def test_chunks_threads_and_workers_change_nothing() -> None:
    whole = mapped().isel(gear_temperature=[0])
    axes = AXES | {"gear_temperature": AXES["gear_temperature"][:1]}
    cut = replace(case_map(own(), axes, refine=False, train=FEW), tile=2)
    equal(whole, gather(cut, threads=2))
    variables = cut.variables()
    for key in reversed(keys_of(cut)):
        # a plan that went through bytes computes the same
        again = pickle.loads(pickle.dumps(cut))
        for name, values in again.compute(key, None, keep_going).items():
            there = whole[name].values[region_of(cut, key, variables[name])]
            assert values.tobytes() == there.tobytes(), name


def test_a_point_alone_is_the_point_of_the_map() -> None:
    axes = {name: values[1:2] for name, values in AXES.items()}
    alone = gather(case_map(own(), axes, train=FEW))
    for name in ("label", "period", "point_x", "greatest_mesh_force", "greatest_bearing_force"):
        assert np.array_equal(alone[name].values[0, 0], mapped()[name].values[1, 1]), name


def test_the_map_at_the_cases_own_values_is_its_run(compared: Compared) -> None:
    motion, _ = train_motion(own(), coordinates=13)
    hot = motion.isel(operating=0, state=1)
    axes = {"pinion_speed": AXES["pinion_speed"][1:2], "pinion_torque": np.array([60.0])}
    found = gather(train_maps(own(), axes, train=FEW)).isel(
        state=1, pinion_speed=0, pinion_torque=0
    )
    assert str(hot["label"].values) == f"period-{int(found['period'])}"
    for name in ("greatest_mesh_force", "greatest_bearing_force"):
        away = found[name].values / hot[name].values - 1.0
        compared(f"{name.replace('_', ' ')} of a map", "that of run", away, 1e-4)
    assert float(found["drive_free_share"]) == pytest.approx(
        1.0 - float(hot["time_share_of_flanks"].values[2]), abs=1e-6
    )


def test_a_row_of_a_map_is_a_diagram() -> None:
    speeds = AXES["pinion_speed"][:2]
    diagram = gather(
        case_diagram(
            own(), "pinion_speed", speeds, branch_period=0, train=FEW, state=90.0 + ZERO_CELSIUS
        )
    )
    row = mapped().isel(gear_temperature=1, pinion_speed=[0, 1])
    for name in ("label", "period", "lost_contact"):
        assert diagram[name].values[0, 0].tolist() == row[name].values.tolist()
    assert diagram["greatest_bearing_force"].values[0, 0] == pytest.approx(
        row["greatest_bearing_force"].values, rel=1e-4
    )
    page = page_of(finished(diagram, "own"))
    assert page.summary.startswith(f"{NOTHING} ")


def test_both_states_of_a_map_are_the_maps_of_each() -> None:
    axes = {"pinion_speed": AXES["pinion_speed"][:1], "pinion_torque": np.array([40.0])}
    both = gather(train_maps(own(), axes, train=FEW))
    for place, state in enumerate(("undeformed", "hot")):
        one = gather(case_map(own(), axes, train=FEW, state=state))
        here = both.isel(state=place).drop_vars("state")
        equal(one, here)


def test_what_loses_contact_is_flagged_by_its_share() -> None:
    axes = {"pinion_speed": np.array([5200.0]) * RPM, "pinion_torque": np.array([4.0])}
    found = gather(case_map(own(), axes, train=FEW)).isel(pinion_speed=0, pinion_torque=0)
    free = [found["drive_free_share"], found["back_share"], *found["bearing_free_share"]]
    flags = [float(share) > 0.0 for share in free]
    assert flags[0]
    assert int(found["lost_contact"]) == sum(1 << n for n, flag in enumerate(flags) if flag)
    assert found["lost_contact"].attrs["flags"].split()[-1] == "bearing_4"


def test_a_map_refines_where_contact_ends() -> None:
    from thermogear.analysis.maps import _refined

    size = (5, 5)
    found = {n: np.ones(size, np.int32) for n in ("label", "period")}
    found |= {"lost_contact": np.zeros(size, np.int32)}
    done = np.ones(size, bool)
    assert not _refined(found, done, 4, ("lost_contact",)).any()
    found["lost_contact"][4] = 1
    assert _refined(found, done, 4, ("lost_contact",)).all()
    assert not _refined(found, done, 4, ()).any()


def test_basins_of_a_journal_and_names_that_are_none() -> None:
    one = Train(coordinates=13, seen="pinion left")
    x = np.array([-2.0, 2.0])
    found = gather(case_basins(own(), x=x, v=x[:1], train=one))
    assert found.sizes["attractor_number"] == 1
    with pytest.raises(InputError, match=r"pinion lift.*pinion left"):
        case_basins(own(), x=x, v=x, train=replace(one, seen="pinion lift"))
    with pytest.raises(InputError, match=r"--operating.*allowed 1\.\.1"):
        case_map(own(), AXES, train=replace(one, operating=3))


# --- words and picture, from stored numbers alone ---------------------------------------------


def stored(lost: np.ndarray, label: int = 1) -> xr.Dataset:
    """A map of 3 speeds and 4 temperatures in which contact is lost as ``lost`` says."""
    data = mapped().isel(pinion_speed=[0, 1, 2], gear_temperature=[0, 1, 0, 1])
    axis = np.array([40.0, 60.0, 80.0, 100.0]) + ZERO_CELSIUS
    data = data.assign_coords(gear_temperature=("gear_temperature", axis, {"units": "K"}))
    data["lost_contact"] = (data["label"].dims, lost, mapped()["lost_contact"].attrs)
    data["label"] = data["label"].copy(data=np.full(lost.shape, label, np.int8))
    return data


def test_the_words_say_where_each_flank_and_bearing_loses_contact() -> None:
    lost = np.zeros((3, 4), np.int32)
    lost[1:, 2:] = 1  # the drive flank
    lost[2, 3] |= 2  # the back flank
    lost[:, 0] |= 8  # the second bearing
    data = stored(lost)
    said = lost_words(data)
    assert said == SAID
    assert [row["points"] for row in lost_rows(data)] == [4, 1, 3]
    # a file holds nothing where nothing is known, and no number for it
    missing = data.assign(lost_contact=data["lost_contact"].astype(float).where(lost != 8))
    assert lost_of(missing).min() == -1
    assert [row["points"] for row in lost_rows(missing)] == [4, 1]
    # what is assumed is told apart: the second and third speed at the last temperature
    status = np.zeros((3, 4), np.int8)
    status[1:, 3] = ASSUMED
    guessed = data.assign(status=(data["label"].dims, status))
    assert [(row["points"], row["assumed"]) for row in lost_rows(guessed)] == [
        (2, 2),
        (0, 1),
        (3, 0),
    ]
    more = " Where the motion is assumed, so is this."
    assert lost_words(guessed) == SAID + more
    assert lost_words(stored(np.zeros((3, 4), np.int32))) == NOTHING
    assert lost_words(stored(np.full((3, 4), -1, np.int32), 4)) == UNKNOWN
    scattered = np.zeros((3, 4), np.int32)
    scattered[0, 0] = scattered[2, 3] = 1
    assert lost_words(stored(scattered)) == SCATTERED


def test_the_picture_has_a_colour_for_every_kind() -> None:
    lost = np.zeros((3, 4), np.int32)
    lost[0, 0], lost[1, 1], lost[2, 2], lost[2, 3], lost[0, 3] = 1, 3, 4, 12, -1
    picture = lost_contact_picture(stored(lost))
    teeth, bearings = (panel.marks[0] for panel in picture.panels[0])
    assert teeth.values.T[[0, 1, 0], [0, 1, 3]].tolist() == [1, 2, 3]  # type: ignore[attr-defined]
    names = bearings.classes  # type: ignore[attr-defined]
    codes = bearings.values.T  # type: ignore[attr-defined]
    assert [names[int(codes[place])] for place in ((2, 2), (2, 3), (0, 3))] == CLASSES
