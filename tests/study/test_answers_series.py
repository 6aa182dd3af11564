"""Answers of a series: quantiles of drawn pairs, their verdict at the bad end and lower damping."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats.mstats import hdquantiles
from scripts import script

from coded import coded
from said import numbers
from thermogear.base.limits import LOOK, OPEN
from thermogear.base.units import RPM
from thermogear.case.case import gear_case, load_case
from thermogear.case.family import GearFamily
from thermogear.mesh.elastic import TURN_POSITIONS
from thermogear.results.answer import Answer
from thermogear.results.result import Result
from thermogear.study.answers.series import Spread, _by_damping, _unsure
from thermogear.study.answers.survey import answers
from thermogear.study.series_along import over_speeds
from thermogear.views.write import page_of

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
CASE = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 20
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[flanks]
parts = 16
[operating]
speed = "7000 rpm"
torque = "80 N m"
"""
SMALL = ("grid.path_positions=41", "grid.mesh_positions=48", "grid.harmonics=12")

HELD = (
    "temperatures.pinion_addendum='90 degC'", "temperatures.pinion_bore='80 degC'",
    "temperatures.wheel_addendum='90 degC'", "temperatures.wheel_bore='80 degC'",
    "temperatures.housing='60 degC'",
)  # fmt: skip


def result_of(*changes: str) -> Result:
    return answers(gear_case(load_case(CASE, [*SMALL, *changes])))


@pytest.fixture(scope="module")
def series() -> Result:
    return result_of()


def test_the_band_of_a_run_is_that_of_the_answers(series: Result) -> None:
    """At the same state, over the same speeds, to the last bit."""
    stored, case = series.group("series"), gear_case(load_case(CASE, SMALL))
    assert stored is not None
    speeds = stored["pinion_speed"].values[::9]
    band = over_speeds(case, case.series, [GearFamily(case, ("pinion_speed",))], speeds)
    # at the bounds of the damping the answers go up to the own speed alone
    up_to = speeds <= stored["own_speed"].values[0]
    for place, some in enumerate([np.ones_like(up_to), *[up_to] * (len(case.dampings) - 1)]):
        factor = band["series_dynamic_factor"].values[0][[0, 1, 3]][:, place, some]
        answered = stored["dynamic_factor"].values[0][:, place, ::9][:, some]
        assert np.array_equal(factor, answered, equal_nan=True)
        share = band["series_parting_share"].values[0][place, some]
        assert np.array_equal(share, stored["parting_share"].values[0][place, ::9][some])


@pytest.fixture(scope="module")
def told(series: Result) -> dict[str, Answer]:
    return {one.name: one for one in series.answers}


def test_quantiles_are_those_of_the_parts_that_are_stored(
    series: Result, told: dict[str, Answer]
) -> None:
    data = series["series"].isel(operating=0)
    assert dict(data.sizes) == {"damping": 3, "part": 16, "speed": data.speed.size, "quantile": 3}
    factor, mesh = data["own_dynamic_factor"].values, data["mesh_error"].values
    figures = told["dynamic_factor"].figures
    for name, share in (("low", 0.05), ("middle", 0.5), ("high", 0.95), ("bad", 0.9)):
        (there,) = hdquantiles(factor[0], [share])
        assert figures[f"part_{name}"] == pytest.approx(there, rel=1e-9)
        (there,) = 1e6 * hdquantiles(mesh, [share])
        assert told["transmission_error"].figures[f"mesh_{name}"] == pytest.approx(there, rel=1e-9)
    # ranks 4 to 12 of 16 hold the median with 95 %
    ordered = np.sort(factor[0])
    low, high = figures["part_middle_interval"]
    assert (low, high) == (ordered[3], ordered[11])
    assert "part_high_interval" not in figures  # 16 do not bound the 95 % quantile
    place = int(np.argmin(np.abs(data["pinion_speed"].values - 7000.0 * RPM)))
    np.testing.assert_allclose(data["dynamic_factor"].values[1, 0, place], hdquantiles(
        factor[0], [0.5]
    )[0])  # fmt: skip
    assert list(script("trials/answers").contradictions(series)) == []


def test_a_relief_of_true_flanks_is_no_verdict_on_a_class(told: dict[str, Answer]) -> None:
    assert told["relief"].verdict == OPEN
    assert told["relief"].figures["after"] < told["relief"].figures["before"]


def test_a_verdict_rests_on_the_bad_end_at_the_worst_damping(told: dict[str, Answer]) -> None:
    factor = told["dynamic_factor"]
    assert factor.value == max(factor.figures["bad"]) > factor.figures["part_bad"]
    assert factor.verdict == LOOK
    assert factor.figures["dampings"] == pytest.approx([0.07, 0.02, math.sqrt(0.0014)])
    error = told["transmission_error"]
    assert error.value == error.figures["mesh_bad"] > error.figures["mesh_middle"]
    assert error.figures["turn_middle"] > 2.0 * error.figures["mesh_middle"]
    apart = told["coexisting"]  # 7000 rpm: contact is lost
    assert apart.figures["parts"] == 16
    assert apart.value == max(apart.figures["shares"])


def test_pairs_that_part_are_counted(series: Result, told: dict[str, Answer]) -> None:
    data = series["series"].isel(operating=0)
    onset, lost = data["contact_loss_onset"].values / RPM, told["contact_loss"]
    hits = (onset <= 7000.0 * (1.0 + 1e-9)).sum(axis=1)
    assert lost.figures["shares"] == pytest.approx((100.0 * hits / 16.0).tolist())
    assert lost.value == max(lost.figures["shares"]) > 10.0
    assert lost.verdict == LOOK
    assert (lost.figures["pairs"], lost.figures["parts"]) == (hits[0], 16)
    assert lost.figures["first"] == np.nanmin(onset[0])
    assert {float(hits[0]), 16.0, 7000.0} <= set(numbers(lost.sentence))
    back = told["back_contact"]
    # none of 16 does not exclude that more than one pair in ten does: 1 - 0.05^(1/16)
    assert (back.verdict, back.value, back.figures["pairs"]) == (OPEN, 0.0, 0)
    assert back.figures["possible"] == pytest.approx(100.0 * (1.0 - 0.05 ** (1.0 / 16.0)))


def test_what_is_assumed_is_told_once_with_the_median_and_the_worst_part(series: Result) -> None:
    notices = coded(series.notices)
    (notice,) = notices["answers_of_a_series"]
    assert "flanks_are_one_drawing" not in notices
    assert "speeds_looked_at" not in notices
    factor = series["series"]["own_dynamic_factor"].values[0, 0]
    assert (notice["parts"], notice["seed"], notice["accuracy"]) == (16, 1, 6)
    assert notice["worst"] == np.argmax(factor)
    assert notice["median"] == np.argsort(factor)[7]


def test_a_part_of_the_series_is_the_case_with_its_drawing() -> None:
    """Drawing n asked for alone at the same temperatures: its error, and its motion by other steps.

    Else a part alone has the losses, and so the temperatures, of its own flanks.
    """
    data = result_of(*HELD)["series"].isel(operating=0)
    for place in (0, 5):
        drawn = f"flanks.drawing={place}"
        alone = result_of(
            "flanks.parts=1", "flanks.teeth=drawn", drawn, "gears.marks=[1, 1]", *HELD,
            f"grid.mesh_positions={TURN_POSITIONS}",  # those of a series
        )  # fmt: skip
        figures = {one.name: one.figures for one in alone.answers}
        error = 1e-6 * figures["transmission_error"]["hot"]
        assert data["turn_error"].values[place] == pytest.approx(error, rel=1e-9)
        factor = figures["dynamic_factor"]["own"]
        assert data["own_dynamic_factor"].values[0, place] == pytest.approx(factor, rel=2e-3)


def test_a_stated_damping_and_a_stated_seed_narrow_the_answers() -> None:
    damped = result_of("dynamics.damping_ratio=0.05", "operating.speed=3000 rpm")
    by = {one.name: one for one in damped.answers}
    assert by["dynamic_factor"].figures["dampings"] == [0.05]
    assert damped["series"].sizes["damping"] == 1
    seeded = result_of("flanks.parts=1")
    assert "series" not in seeded.groups
    assert "flanks_are_one_drawing" in coded(seeded.notices)
    assert not any("parts" in one.figures for one in seeded.answers)


def test_a_bound_is_met_between_two_dampings_that_were_computed() -> None:
    words, figures = _by_damping(np.array([0.07, 0.02, 0.04]), np.array([8.0, 60.0, 30.0]), 10.0)
    assert figures == {"from_damping": 0.04, "to_damping": 0.07}
    assert words
    for values in ([8.0, 9.0, 8.5], [80.0, 60.0, 30.0]):
        assert _by_damping(np.array([0.07, 0.02, 0.04]), np.array(values), 10.0) == ("", {})


def test_no_verdict_is_fine_where_the_interval_reaches_beyond_the_bound() -> None:
    verdicts = [_unsure(0.0, high, 10.0) for high in (9.0, 10.0, 17.1, math.inf)]
    assert verdicts == ["", "", OPEN, OPEN]
    assert _unsure(12.5, 30.0, 10.0) == ""  # which is no less beyond it


def test_what_moves_the_factor_most_is_told(series: Result, told: dict[str, Answer]) -> None:
    """The part by the band, the damping and the temperatures by the medians of the same parts."""
    figures = told["dynamic_factor"].figures
    own = series["series"]["own_dynamic_factor"].values[0]
    low, *medians, high = hdquantiles(own[0], [0.05, 0.5, 0.95])
    assert figures["by_part"] == pytest.approx(high - low, rel=1e-9)
    other = max(abs(hdquantiles(row, [0.5])[0] - medians[0]) for row in own[1:])
    assert figures["by_damping"] == pytest.approx(other, rel=1e-9)
    assert 0.0 < figures["by_temperature"] < 0.1 * other  # some kelvins


def test_a_band_is_told_with_no_more_digits_than_it_has() -> None:
    narrow, wide = np.linspace(1.22, 1.27, 16), np.linspace(1.4, 2.0, 16)
    assert (Spread.of(narrow).digits, Spread.of(wide).digits) == (3, 2)
    assert math.isnan(Spread.of(np.full(3, np.nan)).middle.value)


def test_every_operating_point_has_its_own_counts() -> None:
    """Where flanks part hangs on the load: each point says what it would say alone."""
    loads = ("80 N m", "4 N m")
    result = result_of("operating.torque=['80 N m', '4 N m']", "operating.speed='3000 rpm'", *HELD)
    data = result["series"]
    assert data["pinion_torque"].values.tolist() == [80.0, 4.0]
    assert data.attrs["gravest"] == 1
    parted = {one.operating: one for one in result.answers if one.name == "contact_loss"}
    counts = []
    for place, load in enumerate(loads):
        alone = result_of(f"operating.torque='{load}'", "operating.speed='3000 rpm'", *HELD)
        (lost,) = (one for one in alone.answers if one.name == "contact_loss")
        here = parted[f"3000 rpm, {load}"]
        assert here.figures["shares"] == lost.figures["shares"]
        np.testing.assert_allclose(
            data["own_dynamic_factor"].values[place],
            alone["series"]["own_dynamic_factor"].values[0], rtol=1e-12,
        )  # fmt: skip
        counts.append(here.figures["pairs"])
    assert counts[1] == 16 > counts[0]


def test_many_operating_points_are_answered_at_the_hardest_and_the_lightest() -> None:
    torques = "operating.torque=['80 N m', '10 N m']"
    result = result_of("operating.speed=['1000 rpm', '3000 rpm', '5000 rpm']", torques)
    factors = [one for one in result.answers if one.name == "dynamic_factor"]
    assert [one.operating for one in factors] == ["5000 rpm, 80 N m", "5000 rpm, 10 N m"]
    (notice,) = coded(result.notices)["answers_of_a_series"]
    assert (notice["answered"], notice["points"]) == (2, 6)


def test_a_jammed_series_is_not_decided() -> None:
    tight = ("backlash.value=0.005 mm", "backlash.direction=normal", "backlash.extent=total")
    for one in result_of(*tight).answers:
        if one.name in ("dynamic_factor", "contact_loss", "transmission_error", "relief"):
            assert (one.verdict, one.value) == (OPEN, None)


@pytest.mark.parametrize("change", ["operating.speed='300 rpm'", "operating.torque='0 N m'"])
def test_no_motion_is_stated_below_the_slowest_or_without_load(change: str) -> None:
    """Steps of a series are too coarse below .05 of the natural frequency."""
    result = result_of(change)
    every = {one.name: one for one in result.answers}
    for name in ("dynamic_factor", "contact_loss", "back_contact", "resonance"):
        assert (every[name].verdict, every[name].value) == (OPEN, None)
    reasons = [one.sentence for one in result.answers if one.verdict == OPEN]
    assert min(map(len, reasons)) > len("Not decided: .")


def test_the_page_shows_the_band_and_stores_it_in_si(series: Result) -> None:
    page = page_of(series)
    (picture,) = page.pictures
    factor, parting = picture.make().panels[0][0], picture.make().panels[1][0]
    kinds = [type(mark).__name__ for mark in factor.marks]
    assert kinds.count("Band") == 1
    assert kinds.count("Curve") == 3
    data = series["series"].isel(operating=0)
    stored = page.figures["series"]
    assert stored["pinion_speed"]["unit"] == "rad/s"
    assert stored["turn_error"]["unit"] == "m"
    assert stored["turn_error"]["values"] == [data["turn_error"].values.tolist()]
    assert set(page.tables()) > {"answers_series_by_operating_part.csv"} or page.tables()
    assert len(parting.marks) == 4
