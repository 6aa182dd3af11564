"""Statics, modes, Campbell diagram and answers of a case with shafts: against what they rest on."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from coded import coded
from conftest import Compared
from said import numbers
from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.results.result import Result
from thermogear.study.answers.survey import answers
from thermogear.study.shafts import state
from thermogear.study.shafts.campbell import campbell, orders_of
from thermogear.study.shafts.modes import modes
from thermogear.study.shafts.state import Meshing, moved_apart, places_of, settled
from thermogear.study.shafts.statics import statics
from thermogear.views.pages.shafts import page
from thermogear.views.write import save

CASE = """
[gears]
module = "2.5 mm"
face_width = "24 mm"
pressure_angle = "20 deg"
[gears.pinion]
teeth = 26
profile_shift = 0.15
[gears.wheel]
teeth = 41
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
speed = ["1500 rpm", "3000 rpm"]
torque = "60 N m"
[flanks]
accuracy = 5
[[shafts]]
gear = "pinion"
gear_position = "50 mm"
sections = [{ length = "60 mm", diameter = "28 mm" }, { length = "80 mm", diameter = "25 mm" }]
unbalance = "15 g mm"
[[shafts]]
gear = "wheel"
gear_position = "55 mm"
length = "140 mm"
diameter = "30 mm"
bearings = "6206"
eccentricity = "8 um"
[[bearings]]
shaft = "pinion"
name = "ball"
position = "10 mm"
type = "6305"
seat_stiffness = "400 N/um"
[[bearings]]
shaft = "pinion"
position = "130 mm"
stiffness = "150 N/um"
[motor]
inertia = "0.02 kg m^2"
coupling_stiffness = "4000 N m/rad"
coupling_damping = "0.02 N m s/rad"
[housing]
mass = "30 kg"
mount_stiffness = ["60 N/um", "90 N/um"]
[train]
centre_line = "35 deg"
elements = 6
"""


@cache
def case() -> GearCase:
    return gear_case(load_case(CASE))


@cache
def made(kind: str) -> Result:
    if kind == "campbell":
        return campbell(case(), speeds=(0.0, 12_000 * RPM))
    return {"statics": statics, "modes": modes}[kind](case())


def test_bearing_loads_follow_from_levers_and_weight(compared: Compared) -> None:
    """The wheel's two bearings: moments of mesh force and weight about each other."""
    result = made("statics")
    rings, mesh = result.groups["bearings"], result.groups["statics"]
    force = 60.0 / case().pair.pinion.base_radius
    assert mesh["mesh_force"].values == pytest.approx(force, rel=1e-9)
    one = settled(case(), [0])[1][0]
    normal = one.assembly.frame.normals[0]
    positions = {b.name: b.position for b in case().train.bearings if b.shaft == "wheel"}  # type: ignore[union-attr]
    span = positions["wheel right"] - positions["wheel left"]
    rows = [n for n in one.assembly.coordinates if n.startswith("wheel") and n.endswith(".y")]
    weight = one.assembly.weight[[one.assembly.index[n] for n in rows]].sum()
    share = (positions["wheel right"] - 0.055) / span
    left = rings.sel(bearing="wheel left").isel(state=1, operating=0)
    found = np.array([float(left["bearing_load_x"]), float(left["bearing_load_y"])])
    expected = share * force * normal
    away = np.abs(found - expected).max() / force
    compared("bearing load beside the lever arm's", "levers, within the weight", away,
             abs(weight) / force)  # fmt: skip


def test_centre_distance_closes_on_its_own_mesh(compared: Compared) -> None:
    """The last round changes nothing: the mesh at the actual distance deflects to that distance."""
    for row in settled(case(), [0, 1]):
        for one in row:
            assert one.status == STATUS.index("ok")
            assert 2 <= len(one.growths) <= 6
            assert one.growths[-1] > 0.0
            pair = moved_apart(case().pair, one.growths[-1])
            away = pair.centre_distance - one.mesh.pair.centre_distance
            compared("centre distance of the last round", "the deflected one", away, 2e-9, "m")
    mesh = made("statics").groups["statics"]
    lost = mesh["contact_ratio"].values - case().pair.contact_ratio
    assert np.all((lost < 0.0) & (lost > -0.03))


def test_hot_bearings_have_less_clearance_and_given_rings_show() -> None:
    rings = made("statics").groups["bearings"]
    ball = rings["radial_internal_clearance"].sel(bearing="ball").values
    assert np.all(ball[1] < ball[0])
    assert np.isnan(rings["radial_internal_clearance"].sel(bearing="pinion 2").values).all()
    assert rings["inner_ring_temperature"].sel(bearing="ball").values[1] == pytest.approx(353.15)
    assert np.all(rings["static_safety"].sel(bearing="ball").values > 1.0)


def test_modes_add_up_and_name_what_gives() -> None:
    table = made("modes").groups["modes"]
    assert table["energy_share"].sum("part").values == pytest.approx(1.0)
    assert np.all(np.diff(table["natural_frequency"].values, axis=1) >= 0.0)
    names = {str(v) for v in table["mode_name"].values.ravel()}
    assert any("coupling" in name for name in names)
    shapes = made("modes").groups["shapes"]
    largest = np.max([np.abs(shapes[name].values).max() for name in shapes.data_vars])
    assert largest == pytest.approx(1.0, abs=1e-9)
    assert np.all(table["modal_damping_ratio"].values > 0.0)


def test_critical_speeds_are_where_lines_cross_the_orders(compared: Compared) -> None:
    result = made("campbell")
    grid, critical = result.groups["campbell"], result.groups["critical"]
    speed = grid["pinion_speed"].values
    mean = grid["natural_frequency"].values[1, 1]
    worst = 0.0
    for line in range(critical.sizes["line"]):
        order = float(critical["order"].values[line])
        for met in critical["critical_speed"].values[1, 1, line]:
            if np.isfinite(met) and speed[0] < met < speed[-1]:
                curves = [np.interp(met, speed, curve) for curve in mean.T]
                worst = max(worst, np.abs(np.array(curves) / (order * met) - 1.0).min())
    compared("critical speeds", "curves of the diagram, interpolated", worst, 2e-3)
    low, mid, high = (critical["critical_speed"].values[1, level] for level in range(3))
    known = np.isfinite(low) & np.isfinite(high)
    assert np.all(low[known] <= mid[known] * (1 + 1e-9))
    assert np.all(mid[known] <= high[known] * (1 + 1e-9))


def test_the_response_peaks_at_critical_speeds() -> None:
    result = made("campbell")
    answer, critical = result.groups["response"], result.groups["critical"]
    speed = answer["response_speed"].values
    force = answer["dynamic_mesh_force"].values[1, 0]
    gain = critical["amplification"].values[1, 1, 0]
    met = critical["critical_speed"].values[1, 1, 0]
    inside = (met > speed[2]) & (met < speed[-3]) & (gain > 0.2)
    assert inside.any()
    peaks = speed[1:-1][(force[1:-1] > force[:-2]) & (force[1:-1] > force[2:])]
    ran_out = answer["dynamic_mesh_force"].sel(source="run-out of the wheel").values[1]
    assert np.all(ran_out > 0.0)
    assert np.all(answer["dynamic_mesh_force"].sel(source="run-out of the pinion").values == 0.0)
    shaken = np.hypot(*(answer[f"bearing_force_{c}"].values[1, 0] for c in "xy"))
    alone = critical["resonant_force"].values[1, 1, 0]
    for one, force_alone in zip(met[inside], alone[inside], strict=True):
        near = np.abs(speed / one - 1.0) < 0.03
        # the grid may miss the top of a narrow peak, other modes add a little
        assert 0.2 < shaken[near].max() / force_alone < 1.5
    step = speed[1] - speed[0]
    for one in met[inside]:
        assert np.abs(peaks - one).min() < 3.0 * step + 0.02 * one


def test_no_linear_force_is_told_above_the_static_load() -> None:
    """There a bearing lifts off or the teeth part: at a resonance and anywhere on the way to it."""
    light = case().with_values({"torque": 4.0})
    result = campbell(light, speeds=(0.0, 6_000 * RPM))
    critical, answer = result.groups["critical"], result.groups["response"]
    at_rest = [row[0].rest for row in settled(light, [1])]
    load = np.array([np.linalg.norm(one.bearing_force, axis=-1) for one in at_rest])
    felt = np.hypot(*(answer[f"bearing_force_{c}"].values for c in "xy"))
    assert 0.5 < np.nanmax(felt / load[:, None, None]) <= 1.0
    teeth = np.array([one.mesh_force for one in at_rest])[:, None, None]
    assert 0.5 < np.nanmax(answer["dynamic_mesh_force"].values / teeth) <= 1.0
    force, lifts = critical["resonant_force"].values, critical["lift_off_speed"].values
    assert np.nanmax(force / load.max(axis=1)[:, None, None, None]) <= 1.0
    lifted = np.isfinite(lifts)
    assert np.isnan(force[lifted]).all()
    assert np.all(lifts[lifted] < critical["critical_speed"].values[lifted])
    # in the page, the terminal and the file the speed stands where the force would
    rows = page(result).figures["critical"]
    words = [line for line in page(result).lines() if "not valid:" in line]
    told = [one for one in rows if one["lifts_off_from_rpm"] is not None]
    assert len(words) == len(told) > 0
    for line, one in zip(words, told, strict=True):
        assert one["bearing_force_N"] is None
        assert round(one["lifts_off_from_rpm"]) in numbers(line)


def test_orders_name_mesh_shafts_and_elements() -> None:
    found = {one.name: one.order for one in orders_of(case())}
    assert found["mesh"] == 26.0
    assert found["wheel shaft"] == pytest.approx(26 / 41)
    assert found["elements of wheel left and wheel right"] == pytest.approx(
        0.5 * 9 * (1 - 9.525 / 46) * 26 / 41
    )


def test_answers_ask_about_the_shafts() -> None:
    asked = {
        one.name: one for one in answers(gear_case(load_case(CASE, ["flanks.seed=1"]))).answers
    }
    assert {"critical_speed", "bearing_safety", "bearing_clearance", "tilt"} <= set(asked)
    tilt = asked["tilt"]
    assert tilt.value is not None
    assert 0.0 < tilt.value < 1.0
    clearance = made("statics").groups["bearings"]["radial_internal_clearance"].values[1, 1]
    assert asked["bearing_clearance"].value == pytest.approx(1e6 * np.nanmin(clearance), abs=1e-6)


def test_a_case_without_shafts_says_what_to_write() -> None:
    bare = gear_case(load_case("rig"))
    for study in (statics, modes, campbell):
        with pytest.raises(InputError, match="new --shafts"):
            study(bare)
    assert "critical_speed" not in {one.name for one in answers(gear_case(load_case(
        CASE[: CASE.index("[[shafts]]")], ["flanks.seed=1"]))).answers}  # fmt: skip


def test_many_points_are_spread_with_the_hardest_among_them() -> None:
    many = gear_case(load_case(CASE.replace('["1500 rpm", "3000 rpm"]', str(
        [f"{v} rpm" for v in (500, 600, 700, 800, 5000, 900, 1000, 1100, 1200, 1300)]
    ).replace("'", '"'))))  # fmt: skip
    found = places_of(many)
    assert len(found) == 6
    assert 4 in found


def test_a_point_that_did_not_settle_is_a_status_and_no_number(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made_of = state.meshing

    def lost(*given: Any) -> Meshing:
        found = made_of(*given)
        fast = float(given[3].speed[0]) > 2000 * RPM
        return replace(found, status=STATUS.index("not_converged")) if fast else found

    monkeypatch.setattr(state, "meshing", lost)
    result = statics(case())
    mesh = result.groups["statics"]
    assert mesh["status"].values[:, 1] == pytest.approx(STATUS.index("not_converged"))
    for group in result.groups.values():
        for name, values in group.data_vars.items():
            if "operating" in values.dims and name not in ("status", "radial_internal_clearance"):
                numbers = values.isel(operating=1).values
                assert not np.isfinite(numbers).any() or str(name).endswith("temperature"), name
    still = coded(result.notices)["train_without_rest"]
    assert [told["status"] for told in still] == ["not_converged"] * 2
    with pytest.raises(InputError, match="did not settle"):
        modes(case(), operating=2)


@pytest.mark.parametrize("kind", ["statics", "modes", "campbell"])
def test_every_study_is_stored_and_drawn(kind: str, tmp_path: Path) -> None:
    found = save(made(kind), tmp_path)
    page = (tmp_path / f"{kind}.html").read_text(encoding="utf-8")
    assert "nan" not in page.split("<main")[1].split("Case file")[0].replace("nano", "").lower()
    assert (tmp_path / f"{kind}_sketch.svg").exists()
    assert found


def test_speeds_and_counts_are_checked() -> None:
    with pytest.raises(InputError, match="LOW < HIGH"):
        campbell(case(), speeds=(3000 * RPM, 1000 * RPM))
    with pytest.raises(InputError, match=r"^count: got 0; allowed 1\.\.60$"):
        modes(case(), count=0)
    with pytest.raises(InputError):
        modes(case(), operating=9)


def test_more_modes_than_a_coarse_train_has_are_those_it_has() -> None:
    coarse = gear_case(load_case(CASE, ["train.elements=2"]))
    kept = campbell.__wrapped__(coarse, count=500)  # type: ignore[attr-defined]
    kept = kept.groups["campbell"].sizes["mode"]
    assert kept < 500
    assert modes.__wrapped__(coarse, count=500).groups["modes"].sizes["mode"] == kept


def test_a_train_without_damping_has_no_finite_resonance() -> None:
    bare = gear_case(load_case(CASE, ['train.damping="modal"', "train.modal_ratio=0.0"]))
    gain = campbell(bare, count=6).groups["critical"]["amplification"].values
    driven = np.isfinite(gain) & (gain > 0.0)
    assert not np.any(driven)


def test_a_jammed_pair_presses_its_shafts_apart() -> None:
    """Both flanks carry: F_d - F_b is the torque's force, the bearings feel the sum outwards."""
    small = '[backlash]\nvalue = "10 um"\ndirection = "normal"\nextent = "total"\n'
    hot = CASE.replace('housing = "55 degC"', 'housing = "-40 degC"') + small
    one = settled(gear_case(load_case(hot)), [0])[1][0]
    rest, frame = one.rest, one.assembly.frame
    assert STATUS[one.status] == "jammed"
    assert rest.back_force > 0.0
    force = 60.0 / frame.base_radii[0]
    assert rest.mesh_force - rest.back_force == pytest.approx(force, rel=1e-8)
    pinion = [n for n, b in enumerate(one.assembly.bearings) if b.bearing.shaft == "pinion"]
    outwards = -rest.bearing_force[pinion].sum(axis=0) @ frame.along
    pressed = (rest.mesh_force + rest.back_force) * np.sin(frame.pressure_angle)
    assert outwards == pytest.approx(pressed, rel=0.02)  # and a little weight
    assert one.linear.back > 0.0
    told = statics(gear_case(load_case(hot))).notices
    assert len(coded(told)["train_jammed"]) == 2


def test_a_stiffer_mesh_never_lowers_a_frequency() -> None:
    """Rayleigh: K grows, so does every natural frequency; the same for the bearings."""
    one = settled(case(), [1])[1][0].linear
    known = one.modes(0.0, count=12).frequency
    stiffer = replace(one, mesh=1.5 * one.mesh)
    assert np.all(stiffer.modes(0.0, count=12).frequency >= known * (1 - 1e-9))
    firmer = replace(one, bearings=1.5 * one.bearings)
    assert np.all(firmer.modes(0.0, count=12).frequency >= known * (1 - 1e-9))
