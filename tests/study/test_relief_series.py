"""A tip relief of many parts at several loads: its figure, its steps, and parts it has not seen."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

import said
from thermogear.analysis.order_statistics import proportion
from thermogear.base.errors import InputError
from thermogear.case.case import GearCase, load_case
from thermogear.case.thermal_state import HOT
from thermogear.gears.deviations import GEARS, Relief
from thermogear.mesh.series import series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Result
from thermogear.study import relief_series
from thermogear.study.declared import _torques
from thermogear.study.relief import one_point, relief_survey
from thermogear.study.relief_series import (
    GRIND,
    Ground,
    PartErrors,
    drawn_periods,
    ground_length,
    ratios,
    search,
    start_of_relief,
)
from thermogear.study.series import series_parts
from thermogear.views.pages.relief import page

TORQUES = (90.0, 150.0)
DEEP = [f'gears.{g}.tip_relief={{amount="60 um", length="4 mm"}}' for g in GEARS]
TEXT = """[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 18
[gears.wheel]
teeth = 18
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[flanks]
accuracy = 5
[operating]
speed = "1500 rpm"
torque = "150 N m"
"""


def case_of(*changes: str) -> GearCase:
    case = load_case(TEXT, changes)
    assert isinstance(case, GearCase)
    return case


def hot_pairs(case: GearCase) -> list[HotPair]:
    model, state = case.models[0].override(stiffness="loaded"), HOT
    at = state.operating(case, case.models[0])
    return [HotPair(case.pair, one_point(at, torque), model) for torque in TORQUES]


@cache
def designed() -> Result:
    """Of a case with a relief that is far too deep, which is replaced."""
    return relief_survey(case_of(*DEEP), torque=TORQUES)


def reliefs(result: Result) -> list[Relief]:
    rows = result.table("reliefs")
    return [Relief(g, amount=rows[g]["amount_m"], length=rows[g]["length_m"]) for g in GEARS]


def test_the_figure_is_that_of_the_loaded_mesh_of_each_part() -> None:
    """All periods of the turn in order, each part with the relief as a deviation of its own."""
    case = case_of()
    cut = (Relief("pinion", amount=9e-6, length=2.3e-3), Relief("wheel", amount=5e-6, length=3e-3))
    parts = series_parts(case, 2)
    errors = PartErrors(hot_pairs(case), parts, periods=np.arange(18.0), positions=24)
    for with_these in ((), cut):
        got = errors.rms(with_these)
        for place, hot in enumerate(hot_pairs(case)):
            mesh = series_mesh(hot, [(*part, *with_these) for part in parts], 18, positions=24)
            curves = mesh.transmission_error.reshape(2, 18, 24)
            within = curves - curves.mean(axis=-1, keepdims=True)
            np.testing.assert_allclose(
                got[place], np.sqrt((within**2).mean(axis=(1, 2))), rtol=1e-9
            )


def test_a_relief_of_a_class_holds_for_parts_it_has_not_seen() -> None:
    """Designed on 16, judged by 64: 24 more of the series agree within their errors."""
    case, result = case_of(), designed()
    gain = result.table("gains")["series"]
    fresh = PartErrors(
        hot_pairs(case), series_parts(case, 128)[104:], periods=np.arange(0.0, 18.0, 2.0),
        positions=32,
    )  # fmt: skip
    ratio = ratios(fresh.rms(()), after=fresh.rms(reliefs(result)))
    error = np.hypot(gain["standard_error"], ratio.std(ddof=1) / ratio.size**0.5)
    assert abs(1.0 - ratio.mean() - gain["gain"]) < 3.0 * error
    assert gain["gain"] > 3.0 * gain["standard_error"]
    worse = proportion(int(np.count_nonzero(ratio > 1.0)), of=ratio.size)
    assert worse.low <= gain["worse_high"]
    assert worse.high >= gain["worse_low"]
    assert gain["worse_low"] <= gain["worse"] / 64 <= gain["worse_high"]
    stored = result.groups["parts"]
    values = stored["ratio"].sel(relief="series").values
    assert values.size == 64
    assert gain["worst"] == values.max()
    assert 1.0 - values.mean() == pytest.approx(gain["gain"], rel=1e-12)
    assert (stored["ratio"].sel(relief="none").values == 1.0).all()


def test_what_is_judged_can_be_ground_and_stands_in_the_case_file() -> None:
    result = designed()
    for gear, row in result.table("reliefs").items():
        for size, step in ((row["amount_m"], GRIND), (row["length_m"], 1e-4)):
            assert size / step == pytest.approx(round(size / step), abs=1e-6)
        assert f'amount = "{1e6 * row["amount_m"]:.3f} um"' in result.text("paste")
        taken = result.groups["profile"].sel(gear=gear)
        assert taken["taken_off"].values[1] == 0.0
        assert taken["diameter"].values[1] == pytest.approx(row["start_diameter_m"], rel=1e-12)
        assert taken["roll_angle"].values[1] == pytest.approx(row["start_roll_angle_rad"])
        assert taken["taken_off"].values[-1] == pytest.approx(row["amount_m"], rel=1e-12)
    told = page(result).summary
    assert said.numbers(told)[:2] == pytest.approx([90.0, 150.0])


def test_a_relief_that_the_case_has_is_judged_beside() -> None:
    """One that is far too deep makes every part worse; the design does not feel it."""
    gains = designed().table("gains")
    assert list(gains) == ["series", "perfect", "case"]
    assert gains["case"]["worse"] == 64
    assert gains["case"]["worse_high"] == 1.0
    assert gains["series"]["gain"] >= gains["perfect"]["gain"] - 0.02


def test_a_relief_that_gains_next_to_nothing_is_not_proposed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(relief_series, "LEAST_GAIN", 0.999)
    result = relief_survey(case_of("flanks.seed=3"), torque=TORQUES)
    assert [row["amount_m"] for row in result.table("reliefs").values()] == [0.0, 0.0]
    assert result.table("gains")["series"]["gain"] == 0.0
    assert said.numbers(page(result).summary)[-1] == 99.9


def test_several_loads_of_one_part_are_judged_by_it() -> None:
    result = relief_survey(case_of("flanks.seed=3"), torque=TORQUES)
    (gain, perfect) = result.table("gains").values()
    assert set(gain) == {"gain", "worst", "worse"}
    assert gain["gain"] >= perfect["gain"] - 0.02  # designed on the part itself
    assert gain["gain"] == pytest.approx(1.0 - gain["worst"])


def test_a_search_on_steps_finds_the_least_of_a_bowl() -> None:
    pair = case_of().pair
    ground = Ground(pair, shape="linear", largest=40e-6, symmetric=False)
    aim = np.array([13e-6, 21e-6, 1.7e-3, 2.9e-3])

    def bowl(cut: tuple[Relief, Relief]) -> float:
        sizes = np.array([*(r.amount for r in cut), *(r.length for r in cut)])
        return float((((sizes - aim) / aim) ** 2).sum()) / 10.0

    cut = ground.reliefs(search(ground, bowl, bowl))
    np.testing.assert_allclose([*(r.amount for r in cut), *(r.length for r in cut)], aim, rtol=1e-9)
    none = ground.reliefs(search(ground, lambda _: 1.5, lambda _: 1.5))
    assert [r.amount for r in none] == [0.0, 0.0]
    assert ground_length(0.9e-3) == 1e-5


def test_a_relief_of_no_length_starts_at_the_tip() -> None:
    pair = case_of().pair
    for gear in GEARS:
        diameter, roll = start_of_relief(pair, Relief(gear, amount=0.0, length=1e-5))
        drawn = pair.gear(gear)
        assert diameter == pytest.approx(2.0 * drawn.tip_radius, rel=1e-3)
        assert roll == pytest.approx(
            np.sqrt(4.0 * drawn.tip_radius**2 - 4.0 * drawn.base_radius**2)
            / (2.0 * drawn.base_radius), rel=1e-3
        )  # fmt: skip


def test_periods_are_those_of_the_turn_each_once() -> None:
    pair = case_of("gears.wheel.teeth=31").pair
    periods = drawn_periods(pair, 5)
    assert periods.size == np.unique(periods).size == 40
    assert periods.min() >= 0
    assert periods.max() < 18 * 31
    assert (periods == drawn_periods(pair, 5)).all()


def test_an_option_may_be_given_again_and_with_its_unit() -> None:
    assert _torques("--torque", ["660 N m", "1100"]) == [660.0, 1100.0]
    assert _torques("--torque", ["0.66 kN m"]) == pytest.approx(660.0)
    assert _torques("--torque", []) is None
    with pytest.raises(InputError, match=r"^--torque: got "):
        _torques("--torque", ["660 mm"])
