"""Numbers, units and symbols as a reader sees them; curves between stored samples."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr
from hypothesis import given
from hypothesis import strategies as st

from said import numbers
from thermogear.analysis.outcome import outcome_variables
from thermogear.base import display
from thermogear.base.vocabulary import FASTER_RULE, QUANTITIES, told_labels
from thermogear.views import typesetting as words
from thermogear.views.plots.motion import periods_to_draw, refined, thinned
from thermogear.views.plots.spectrum import floor_of
from thermogear.views.plots.sweeps import CLASSES


@pytest.mark.parametrize(
    ("value", "digits", "shown"),
    [
        (93.139, 3, "93.1"),
        (-0.0377, 3, "−0.0377"),
        (0.0, 3, "0"),
        (3462.6, 3, "3463"),
        (5.81e8, 3, "5.81·10⁸"),
        (4.4e-22, 2, "4.4·10⁻²²"),
        (float("nan"), 3, "–"),
        (float("inf"), 3, "–"),
    ],
)
def test_numbers_have_significant_figures(value: float, digits: int, shown: str) -> None:
    assert display.number(value, digits) == shown


def test_given_values_carry_no_zeros_of_ours() -> None:
    assert display.exactly(100.0) == "100"
    assert display.exactly(0.18) == "0.18"
    assert display.exactly(250000.0) == "250000"


@given(st.floats(1e-3, 1e5))
def test_a_shown_number_is_the_number_to_its_digits(value: float) -> None:
    assert float(display.number(value, 4)) == pytest.approx(value, rel=5.001e-4)


def test_temperatures_and_jams() -> None:
    assert display.celsius(413.15) == "140 °C"
    assert display.celsius(263.15) == "−10 °C"
    assert re.fullmatch(r"jammed: .* 68 °C", words.jam_words(341.15))
    assert words.jam_at(1200.0) == "> 400 °C"
    assert words.jam_at(np.inf) == "never"


@pytest.mark.parametrize("name", sorted(QUANTITIES))
def test_every_stored_quantity_has_a_label_with_its_unit(name: str) -> None:
    label = words.axis_label(name)
    assert label.endswith("]")
    assert QUANTITIES[name].long_name in label


def test_display_units_follow_the_stored_unit() -> None:
    assert display.display("displacement").unit == "µm"
    assert display.display("displacement", "1").unit == "–"
    assert float(display.display("pinion_speed")(np.pi)) == pytest.approx(30.0)
    assert float(display.display("gear_temperature")(373.15)) == pytest.approx(100.0)
    assert float(display.display("flash_temperature")(20.0)) == 20.0


def test_prose_is_escaped_before_it_is_polished() -> None:
    assert words.prose("<b>k_T</b> -3 um") == "&lt;b&gt;k<sub>T</sub>&lt;/b&gt; −3\u00a0µm"
    assert words.prose("2.5e-07 m^2 at 20 C") == "2.5·10⁻⁷ m² at 20\u00a0°C"
    assert words.prose("lambda_h, omega_h^2") == "λ<sub>h</sub>, ω<sub>h</sub>²"
    assert words.prose("k_T = F_n/Delta f, sqrt(B)") == ("k<sub>T</sub> = F<sub>n</sub>/Δf, √B")
    assert words.field_name("a.b_<c>") == "a.<wbr/>b_<wbr/>&lt;c&gt;"
    assert words.html_symbol("δ_n1 + δ_n2") == "δ<sub>n1</sub> + δ<sub>n2</sub>"


def test_refined_curves_are_exact_for_cubics_and_keep_every_sample() -> None:
    t = np.linspace(-1.0, 2.0, 7)
    x, v = t**3 - 2.0 * t, 3.0 * t**2 - 2.0
    fine, place, slope = refined(t, x=x, v=v, times=5)
    np.testing.assert_allclose(place, fine**3 - 2.0 * fine, atol=1e-12)
    np.testing.assert_allclose(slope, 3.0 * fine**2 - 2.0, atol=1e-12)
    np.testing.assert_array_equal(place[::5], x)


def test_a_settled_section_keeps_a_point_per_period() -> None:
    x = np.tile([0.0, 1.0], 50) + 1e-9 * np.arange(100)
    kept, _ = thinned(x=x, y=x, scale=(1.0, 1.0))
    assert kept.size == 2
    spread, _ = thinned(x=np.linspace(0.0, 1.0, 100), y=np.zeros(100), scale=(1.0, 0.0))
    assert spread.size == 100
    assert thinned(x=np.full(3, np.nan), y=np.zeros(3), scale=(1.0, 1.0))[0].size == 0


def test_an_orbit_is_drawn_once_and_closes() -> None:
    assert periods_to_draw("period-2", samples_per_period=64, stored=512) == 129
    assert periods_to_draw("period-8", samples_per_period=64, stored=512) == 512
    assert periods_to_draw("chaotic", samples_per_period=64, stored=512) == 512


def test_the_floor_of_a_spectrum_lies_below_its_greatest_line() -> None:
    order = np.array([0.0, 0.5, 1.0, 9.0])
    floor, top = floor_of(np.array([50.0, 0.1, 2.0, 8.0]), order=order, highest=8.0)
    assert floor == pytest.approx(2e-5)
    assert top > 2.0
    assert floor_of(np.full(4, np.nan), order=order, highest=8.0) == (1e-6, 1.0)


def test_chaos_is_told_with_how_long_and_from_how_many_starts() -> None:
    data = xr.Dataset(
        {
            "label": ("point", ["period-2", "chaotic"]),
            "followed_periods": ("point", [0, 32268]),
            "followed_starts": ("point", [2, 16]),
        }
    )
    two, chaotic = told_labels(data).tolist()
    assert two == "period-2"
    assert (chaotic.split()[0], numbers(chaotic)) == ("chaotic", [32268.0, 16.0])
    assert words.label_text(data.isel(point=1)) == chaotic
    # results stored before say no more than they know
    assert words.label_text(data[["label"]].isel(point=1)) == "chaotic"


def test_the_faster_rule_says_that_it_is_an_estimate() -> None:
    assert "estimate" in FASTER_RULE
    assert outcome_variables(("a", "b"))["label"].attributes["comment"] == FASTER_RULE
    assert sum("estimate" in name for name, _ in CLASSES) == 1
