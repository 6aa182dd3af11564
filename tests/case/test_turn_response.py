"""Run-ups and sweeps over a turn: fixed steps against the event-exact engine and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.period import Period, line_names
from thermogear.base.vocabulary import label_words
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.family import family
from thermogear.case.one_point import of_case
from thermogear.case.response import RECORD, respond
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.results.result import Result
from thermogear.study.branches import branch_results
from thermogear.study.orbit import orbit_results
from thermogear.study.run_up import run_up
from thermogear.study.sweep import sweep
from thermogear.views.pages import sweeps as page
from thermogear.views.plots import one_motion
from thermogear.views.plots.sweeps import waterfall_picture

RPM = np.pi / 30.0
PITCHES = str([f"{error:.3f} um" for error in 3.0 * np.sin(2.3 * np.arange(25) ** 2)])


def rig(*changes: str) -> GearCase:
    """The rig of 25 and 75 teeth, over the turn of its pinion where that is not perfect."""
    return gear_case(
        load_case(load_example("rig").text, ["gears.period=turn"] * bool(changes) + [*changes])
    )


@pytest.fixture(scope="module")
def eccentric() -> Result:
    case = rig("gears.pinion.eccentricity={amount='10 um'}")
    speeds = np.array([300.0, 2000.0, 3500.0]) * RPM
    return run_up(case, speeds, temperatures=(None,))


def test_nearly_perfect_gears_jump_where_the_mean_tooth_jumps() -> None:
    speeds = np.linspace(4300.0, 5000.0, 15) * RPM
    turn = rig("gears.pinion.eccentricity={amount='1 nm'}")
    assert turn.period.mesh_periods == 25
    alike = run_up(rig(), speeds, temperatures=("hot",), branch_period=0).data
    data = run_up(turn, speeds, temperatures=("hot",)).data
    swing = alike["dte_peak_to_peak"].values[0]
    # up and down differ by nearly a factor of two between the jumps
    assert (swing[1] / swing[0]).max() > 1.8
    np.testing.assert_allclose(data["dte_peak_to_peak"].values[0], swing, rtol=1e-2)
    assert (data["period"].values == 1).all()
    assert data["used_periods"].max() < alike["used_periods"].max()


def test_a_slow_eccentric_pinion_has_its_run_out_as_first_order(eccentric: Result) -> None:
    data = eccentric.data
    assert data["order"].values[:3].tolist() == [1 / 25, 2 / 25, 3 / 25]
    names = line_names(data.attrs, data["order"].values)
    assert [names[n - 1] for n in (1, 25, 26)] == [
        Period.of((25, 75), pinion=True).line(n) for n in (1, 25, 26)
    ]
    slow = data["dte_line"].values[0, 0, 0]
    assert slow[0] == pytest.approx(10e-6, rel=1e-3)
    # nothing else turns with the shaft alone
    assert slow[1:12].max() < 1e-3 * slow[0]


def test_lines_of_a_turn_are_those_of_the_exact_orbit() -> None:
    case = rig(f"gears.pinion.pitch_errors={PITCHES}")
    speeds = np.array([2000.0, 3500.0]) * RPM
    data = run_up(case, speeds, temperatures=(None,)).data.isel(state=0, direction=0)
    points = family(case, ["rpm"], state=UNDEFORMED)(speeds[:, None])
    start = np.stack([data["point_x"].values, data["point_v"].values], axis=1)
    states = np.array([
        periodic_orbit(points.model(place), 1, start[place]).state for place in range(2)
    ])  # fmt: skip
    assert (data["period"].values == 1).all()
    assert data["contact_loss_share"].values.max() > 0.01
    record = replace(RECORD.in_orders_of(25), periods=1, samples=128 * 25)
    exact = respond(points, states, record, lines=True)
    apart = np.abs(data["dte_line"].values - exact["dte_line"]).max()
    assert apart < 1e-3 * exact["dte_line"].max()
    for name, least in (("dte_mean", 1e-5), ("dte_rms", 1e-3), ("mesh_force_rms", 1e-3)):
        np.testing.assert_allclose(data[name].values, exact[name], rtol=least)
    lost = np.abs(data["contact_loss_share"].values - exact["contact_loss_share"]).max()
    assert lost < 2e-3
    # a sweep from the case's own start meets the same motion
    same = sweep(case, {"rpm": speeds}, state=UNDEFORMED).data
    np.testing.assert_allclose(same["dte_line"].values, data["dte_line"].values, atol=1e-9)


def test_the_waterfall_shows_orders_of_the_shaft(eccentric: Result) -> None:
    data = eccentric.data
    mesh, shaft = (row[0] for row in waterfall_picture(data).panels)
    assert "mesh" in mesh.y.words
    assert "pinion" in shaft.y.words
    (field,) = shaft.marks
    np.testing.assert_allclose(field.y, np.arange(0.5, 13.0))
    np.testing.assert_allclose(field.values[0], 1e6 * data["dte_line"].values[0, 0, :, 0])
    first = page.numbers(eccentric)["lines"][0]
    assert first["line"] == "pinion"
    assert first["amplitude_m"] == data["dte_line"].values[..., 0].max()
    assert list(page.numbers(eccentric)["labels"].values()) == [6]


def test_orbits_and_branches_count_turns_and_show_orders_of_the_shaft() -> None:
    point = of_case(rig("gears.pinion.eccentricity={amount='10 um'}", "operating.speed=300 rpm"))
    branch = branch_results(point, "pinion_speed", 303.0 * RPM)
    ((panel,),) = one_motion.branch_picture(list(branch.groups.values())).panels
    turns = label_words("period-1", followed=0, starts=1, mesh_periods=25)
    assert {mark.label for mark in panel.marks} == {turns}
    _, _, (mesh, shaft) = one_motion.orbit_picture(orbit_results(point).data).panels
    assert "mesh" in mesh.x.words
    assert "pinion" in shaft.x.words
    (lines,) = shaft.marks
    np.testing.assert_allclose(lines.x, [1.0])
