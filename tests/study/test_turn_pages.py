"""The whole turn as a reader sees it: lines by their names, every tooth, the assemblies, pages."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
import xarray as xr

from said import numbers
from thermogear.base.period import Period
from thermogear.base.progress import silent
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.one_point import of_case
from thermogear.results.result import Result
from thermogear.study.contact import loaded_survey
from thermogear.study.notices import turn_notices
from thermogear.study.orbit import orbit_results
from thermogear.study.run import MOST_KEPT, _bounded, _cycles
from thermogear.views.pages.turn import error_of_turn, orders_of_turn, teeth_of_turn
from thermogear.views.picture import Band, Curve, Panel, Text
from thermogear.views.plots.curves import MOST_POINTS, draw_phase
from thermogear.views.plots.one_motion import orbit_picture
from thermogear.views.write import page_of

TEXT = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = {pinion}
profile_shift = 0.3
[gears.wheel]
teeth = {wheel}
profile_shift = 0.2
[oil]
name = "FVA3"
temperature = "60 degC"
[temperatures]
pinion_addendum = "60 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[operating]
speed = "1500 rpm"
torque = "60 N m"
"""
# a tooth without finite elements is there at once
PERFECT = ("transmission_error.harmonics=[]", "model.tooth=beam")


def case(teeth: tuple[int, int], *changes: str) -> GearCase:
    text = TEXT.format(pinion=teeth[0], wheel=teeth[1])
    return gear_case(load_case(text, [*PERFECT, *changes]))


def pitches(gear: str, teeth: int, size: float = 4.0) -> tuple[str, list[float]]:
    """A field with index errors of a gear, and these [um]."""
    values = [round(size * math.sin(1.0 + 7.3 * n * n), 3) for n in range(teeth)]
    return f"gears.{gear}.pitch_errors={[f'{v} um' for v in values]}", values


@pytest.fixture(scope="module")
def small() -> Result:
    """18 and 24 teeth, whose errors are listed: a turn of 72 mesh periods, 6 assemblies."""
    changes = [pitches("pinion", 18)[0], pitches("wheel", 24)[0]]
    return loaded_survey(case((18, 24), *changes), (60.0,))


def test_every_line_of_a_turn_has_the_name_of_its_shaft_or_of_the_mesh() -> None:
    """Against all sums of the mesh's orders and a shaft's, the fewest orders of a shaft first."""
    period = Period.of((18, 24), pinion=True, wheel=True)
    of, shafts = period.mesh_periods, (4, 3)
    assert (of, period.orders["pinion"], period.orders["wheel"]) == (72, *shafts)
    for order in range(1, 3 * of):
        parts = period.line(order).replace("− ", "-").replace("+ ", "").split()
        total, sign = 0, 1
        for part in parts:
            if part.strip("-").isdigit():
                sign = int(part)
            elif part.startswith("-"):
                sign, part = -1, part[1:]
            if part in ("mesh", "pinion", "wheel"):
                total += sign * {"mesh": of, "pinion": 4, "wheel": 3}[part]
                sign = 1
            elif part == "tooth":
                total += sign
                sign = 1
        assert total == order, period.line(order)


def test_shafts_of_one_speed_are_named_together_and_a_lone_gear_by_itself() -> None:
    both = Period.of((28, 28), pinion=True, wheel=True)
    names = [both.line(n) for n in (1, 27, 28)]
    assert names[0] in names[1]
    assert names[2] == "mesh"
    assert Period.of((20, 31), wheel=True).line(33) == "mesh + 2 wheel"


@pytest.mark.parametrize(("gear", "order"), [("pinion", 18), ("wheel", 24)])
def test_an_eccentric_perfect_gear_has_the_line_of_its_shaft_alone(gear: str, order: int) -> None:
    """Its amplitude is e at any load, and no side line stands beside the mesh."""
    change = f'gears.{gear}.eccentricity={{amount="8 um", angle="20 deg"}}'
    turn = loaded_survey(case((18, 24), change), (60.0,)).groups["turn"]
    names = [Period(order, (18, 24)).line(round(q * order)) for q in turn["order"].values]
    assert turn.attrs["mesh_periods"] == order
    loaded, unloaded = turn["line_amplitude"].values, turn["unloaded_line"].values
    shaft = names.index(gear)
    assert loaded[shaft] == pytest.approx(8e-6, rel=1e-9)
    assert unloaded[shaft] == pytest.approx(8e-6, rel=1e-9)
    of_mesh = np.array([name.endswith("mesh") for name in names])
    for lines in (loaded, unloaded):
        lines[shaft] = 0.0
        assert lines[~of_mesh].max() < 1e-14
    assert unloaded.max() < 1e-10  # the gears' heat alone: 40 K
    assert loaded.max() > 1e-7


def test_teeth_stand_where_the_case_puts_them(small: Result) -> None:
    teeth = small.groups["teeth"]
    for gear, count in (("pinion", 18), ("wheel", 24)):
        here = teeth.isel(tooth=np.flatnonzero(teeth["gear"].values == gear))
        values = 1e-6 * np.array(pitches(gear, count)[1])
        assert here["number"].values.tolist() == list(range(1, count + 1))
        np.testing.assert_allclose(here["index_error"].values, values - values.mean(), atol=1e-15)
        assert here["load_carried"].values.mean() == pytest.approx(1.0, rel=1e-12)
        # a tooth that stands early carries more than one that stands back
        assert np.corrcoef(values, here["load_carried"].values)[0, 1] > 0.6


def test_other_marks_renumber_the_rows_and_change_none(small: Result) -> None:
    """The same teeth meet: marks [5, 5] name the assembly of [1, 1] from another tooth on."""
    changes = [pitches("pinion", 18)[0], pitches("wheel", 24)[0], "gears.marks=[5, 5]"]
    other = loaded_survey(case((18, 24), *changes), (60.0,)).groups
    for name, rows in small.groups["teeth"].data_vars.items():
        if rows.dtype.kind == "f":
            np.testing.assert_allclose(other["teeth"][name].values, rows.values, rtol=1e-9)
    assert other["turn"].attrs["first"] == [5, 5]
    assert "assemblies" not in other  # the case says which teeth meet


def test_the_spread_over_assemblies_is_told_with_its_values(small: Result) -> None:
    ways = small.groups["assemblies"]
    assert (ways.attrs["of"], ways["wheel_tooth"].values.tolist()) == (6, [1, 2, 3, 4, 5, 6])
    swings = ways["peak_to_peak_error"].values
    own = np.ptp(small.groups["turn"]["transmission_error"].values)
    assert swings[0] == pytest.approx(own, rel=1e-12)
    (notice,) = [one for one in small.notices if one.code == "assembly_not_stated"]
    assert numbers(notice.text) == pytest.approx(
        [6, 6, 1e6 * swings.min(), 1e6 * swings.max()], rel=5e-3
    )


def test_json_and_page_hold_what_is_stored(small: Result) -> None:
    page = page_of(small)
    told = page.figures["turn"]
    turn = small.groups["turn"]
    assert told["mesh_periods"] == 72
    assert told["transmission_error_peak_to_peak_m"] == np.ptp(turn["transmission_error"].values)
    assert len(told["teeth"]) == 18 + 24
    assert told["lines"][0]["amplitude_m"] == turn["line_amplitude"].values.max()
    swings = small.groups["assemblies"]["peak_to_peak_error"].values
    rows = told["assemblies"]
    assert [(row["pinion_tooth"], row["wheel_tooth"]) for row in rows] == [
        (1, n) for n in range(1, 7)
    ]
    assert [row["transmission_error_peak_to_peak_m"] for row in rows] == swings.tolist()


@pytest.mark.parametrize("teeth", [(28, 28), (27, 35)])
def test_pictures_of_short_and_long_turns_are_small_and_numbered(teeth: tuple[int, int]) -> None:
    changes = [pitches("pinion", teeth[0])[0], pitches("wheel", teeth[1])[0]]
    found = loaded_survey(case(teeth, *changes), (60.0,))
    turn, of = found.groups["turn"], math.lcm(*teeth)
    picture = error_of_turn(turn)
    axis = picture.panels[0][0].x
    ticks = np.asarray(axis.ticks, dtype=int)
    assert (axis.low, axis.high) == (0, of)
    assert list(axis.names) == [f"{n % teeth[0] + 1}/{n % teeth[1] + 1}" for n in ticks]
    assert ticks.size <= 15
    for one in (picture, orders_of_turn(turn), teeth_of_turn(found.groups["teeth"])):
        curves = [m for row in one.panels for p in row for m in p.marks if isinstance(m, Curve)]
        assert all(np.size(curve.x) <= MOST_POINTS for curve in curves)
    for panel in orders_of_turn(turn).panels[0]:
        names = [m for m in panel.marks if isinstance(m, Text)]
        ends = sorted((n.x, 0.5 * 0.014 * len(n.words) * float(panel.x.high or 1.0)) for n in names)
        level = {n.x: math.log10(n.y) for n in names}
        for (x, half), (other, room) in pairwise(ends):
            assert other - x > half + room or abs(level[x] - level[other]) > 0.25
    # nothing of the error is lost in the picture
    drawn = [np.asarray(m.y) for p in picture.panels[0] for m in p.marks if isinstance(m, Curve)]
    error = 1e6 * turn["transmission_error"].values
    assert max(d.max() for d in drawn) == pytest.approx(error.max(), abs=0.05 * np.ptp(error))


def test_studies_say_over_which_period_they_are(small: Result) -> None:
    whole = case((18, 24), pitches("pinion", 18)[0])
    (notice,) = turn_notices(whole, alike="film and flash")
    assert (notice.code, numbers(notice.text)) == ("turn_taken", [18])
    assert list(turn_notices(whole.mean_tooth())) == []
    (told,) = [one for one in small.notices if one.code == "survey_of_mean_tooth"]
    assert numbers(told.text) == [72, 60]


def test_an_orbit_over_a_turn_names_its_lines_and_counts_turns() -> None:
    change = 'gears.wheel.eccentricity={amount="8 um", angle="20 deg"}'
    found = orbit_results(of_case(case((18, 24), change), operating=1))
    summary, data = found.summary, found.groups["orbit"]
    assert (summary["mesh_periods"], summary["period"]) == (24, 1)
    for line in summary["lines"]:
        assert line["name"] == Period(24, (18, 24)).line(round(24 * line["order"]))
        assert not line["half_order"]  # half of the mesh's order is the twelfth of the shaft
    for row in orbit_picture(data).panels:
        assert all(np.size(m.x) <= 8200 for p in row for m in p.marks if isinstance(m, Curve))


def test_eccentricity_leaves_the_amplitude_of_the_stiffness_at_the_mesh() -> None:
    """It moves all tooth pairs at once: the stiffness is that of the mean tooth."""
    change = 'gears.wheel.eccentricity={amount="8 um", angle="20 deg"}'
    whole = case((18, 24), change, "grid.mesh_positions=96")
    amplitudes = [
        next(iter(_cycles(one, silent).values()))["stiffness_amplitude"].values
        for one in (whole, whole.mean_tooth())
    ]
    np.testing.assert_allclose(*amplitudes, rtol=1e-6)
    assert amplitudes[0].min() > 0.05


@pytest.mark.parametrize(("of", "points", "each"), [(40, 1, 96), (945, 8, 96), (1890, 60, 8)])
def test_curves_that_are_kept_of_a_turn_are_bounded(of: int, points: int, each: int) -> None:
    """With as many positions of every mesh period, the first of each among them."""
    count = 96 * of
    rows = np.broadcast_to(np.int8(0), (points, count))
    mesh = xr.Dataset(
        {"mesh_stiffness": (("operating", "mesh_phase"), rows)},
        {"mesh_phase": np.arange(count) / 96},
        {"mesh_periods": of},
    )
    kept = _bounded(mesh)
    assert kept["mesh_stiffness"].size <= MOST_KEPT
    phase = kept["mesh_phase"].values.reshape(of, each)
    np.testing.assert_array_equal(phase[:, 0], np.arange(of))
    assert _bounded(mesh.drop_attrs()).sizes["mesh_phase"] == count


def test_a_curve_of_many_mesh_periods_is_drawn_as_its_extremes() -> None:
    phase = np.arange(96 * 1890) / 96
    values = np.sin(2.0 * np.pi * phase) + np.cos(2.0 * np.pi * phase / 1890)
    panel = Panel()
    draw_phase(panel, phase, values=values, colour="#000000")
    band, low, high = panel.marks
    assert isinstance(band, Band)
    assert isinstance(low, Curve)
    assert isinstance(high, Curve)
    assert np.size(low.x) <= MOST_POINTS / 2
    assert (np.min(low.y), np.max(high.y)) == (values.min(), values.max())
    assert (np.asarray(low.x)[0], np.asarray(low.x)[-1]) == pytest.approx((0.0, 1890.0), abs=1e-9)


def test_a_pair_whose_teeth_are_alike_has_no_turn() -> None:
    found = loaded_survey(case((18, 24)), (60.0,))
    assert set(found.groups) == {"contact", "base_pitch", "iso_6336"}
    assert "turn" not in page_of(found).figures
