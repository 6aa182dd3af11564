"""Facts that a user gives fix the lines; what nothing decides is undecided."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from said import numbers
from thermogear.measured.figures import figures
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.views.pages.measured import headline

RATE, SHAFT, TEETH = 8192.0, 29.667, 32
SPEED = 2.0 * np.pi * SHAFT


def read(x: NDArray[np.float64], rate: float = RATE, **facts: float) -> Measurement:
    record = Record((Channel("a", x, "g"),), "made", rate, "made")
    return measure(record, sidebands=1, harmonics=2, **facts)  # type: ignore[arg-type]


def unbalance() -> NDArray[np.float64]:
    """A strong unbalance beside a weak mesh line without harmonics or sidebands."""
    turns = SHAFT * np.arange(16_384) / RATE
    x = 1.5 * np.cos(2 * np.pi * turns) + 0.3 * np.cos(2 * np.pi * TEETH * turns + 1.0)
    return x + 0.05 * np.random.default_rng(5).standard_normal(turns.size)


def gear() -> NDArray[np.float64]:
    """The gear with sidebands of its shaft, and an unbalance."""
    turns = SHAFT * np.arange(46_000) / RATE
    swell = 1.0 + 0.2 * np.cos(2 * np.pi * turns) + 0.1 * np.cos(4 * np.pi * turns + 1.0)
    x = sum(
        a * np.cos(2 * np.pi * k * TEETH * turns + k) for k, a in ((1, 1.0), (2, 0.6), (3, 0.4))
    )
    x = swell * x + 0.5 * np.cos(2 * np.pi * turns)
    return np.asarray(x + 0.1 * np.random.default_rng(6).standard_normal(turns.size))


def test_facts_place_the_line_however_high_the_unbalance_is() -> None:
    found = read(unbalance(), teeth=TEETH, speed=SPEED)
    (line,) = [one for one in found.lines if one.name == "mesh x 1"]
    assert line.frequency == pytest.approx(TEETH * SHAFT, rel=1e-5)
    assert line.reading == pytest.approx(0.3, rel=0.01)
    assert found.teeth == TEETH
    (own,) = [one for one in found.readings if one.name == "shaft x 1"]
    assert own.reading == pytest.approx(1.5, rel=0.01)
    assert numbers(headline(figures(found)))[:2] == pytest.approx([32.0, 949.34], abs=0.01)


def test_without_facts_nothing_is_said_of_gears() -> None:
    for facts in ({}, {"teeth": TEETH}):
        found = read(unbalance(), **facts)
        assert found.teeth is None
        assert not [one for one in found.lines if one.kind == "mesh"]
        assert np.isnan(found.lines[0].shaft_speed)


def test_multiples_of_a_known_shaft_are_its_lines() -> None:
    found = read(unbalance(), speed=1.01 * SPEED)
    names = {one.name: one for one in found.readings}
    assert found.teeth is None
    assert names["shaft x 1"].order == pytest.approx(1.0, rel=1e-4)
    assert names["shaft x 32"].reading == pytest.approx(0.3, rel=0.01)


@pytest.mark.parametrize("slip", [0.985, 1.015])
def test_a_known_speed_names_the_teeth_where_no_other_number_fits(slip: float) -> None:
    found = read(gear(), speed=slip * SPEED)
    assert (found.teeth, found.gearing is not None and found.gearing.confirmed) == (TEETH, False)
    assert found.lines[0].shaft_speed == pytest.approx(SPEED, rel=1e-4)


@pytest.mark.parametrize("wrong", [2.0, 0.5])
def test_a_header_s_rate_that_is_wrong_is_told_by_the_speed_alone(wrong: float) -> None:
    found = read(gear(), rate=wrong * RATE, speed=SPEED)
    assert found.teeth is None
    (told,) = [one.data for one in found.notices if one.code == "shaft_by_lines"]
    assert told["ratio"] == pytest.approx(wrong)


def test_a_comb_of_a_shaft_names_no_teeth() -> None:
    """A rub makes every order of the shaft: each has the next ones for sidebands."""
    random = np.random.default_rng(8)
    turns = SHAFT * np.arange(46_000) / RATE
    x = 0.05 * random.standard_normal(turns.size)
    for order in range(1, 120):
        size = random.uniform(0.7, 1.3) / (1.0 + 0.02 * order)
        x += size * np.cos(2 * np.pi * order * turns + random.uniform(0.0, 6.3))
    assert read(x, speed=SPEED).teeth is None
