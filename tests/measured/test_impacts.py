"""What is no line of a gear: the threshold under noise, rates of bearings, as ``measure`` has them.

Seeds were fixed before anything was compared.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import signal, stats
from struck_bearings import BEARINGS, PARTS, RATE, drawn_defects, order, record

from thermogear.measured.figures import figures
from thermogear.measured.impacts import HEARD, Impacts, clearest_line, impacts
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.signals.kurtogram import without_lines
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.tracking import samples_per_turn
from thermogear.study.bearing_rates import bearing_rates


def heard(x: np.ndarray, speed: float, bearing: str) -> Impacts:
    """By the known angle of the shaft."""
    angle = speed / RATE * np.arange(x.size)
    straight = resample_by_angle(x[None], angle, samples_per_turn=samples_per_turn(angle))
    rates = [("first shaft", bearing_rates([bearing])[0])]
    return impacts(
        straight, angle=angle, channels=["a"], ratios={"first shaft": 1.0}, bearings=rates
    )


def measured(seed: int, bearing: str, part: str, *, known: bool = True) -> Measurement:
    x, speed, teeth = record(seed, bearing, part)
    facts = {"speed": 2 * np.pi * speed, "teeth": teeth} if known else {}
    source = Record((Channel("cap", x, "g"),), "x", RATE, "given")
    return measure(source, bearings=bearing_rates([bearing]), **facts)  # type: ignore[arg-type]


def test_drawn_defects_are_named_and_seldom_others() -> None:
    """By the way before, of these 24 records 20 were named right and 8 false beside."""
    right, false = 0, 0
    for seed, bearing, part in drawn_defects(24):
        x, speed, _ = record(seed, bearing, part)
        told = [line.part for line in heard(x, speed, bearing).lines if line.chance <= HEARD]
        right, false = right + (part in told), false + len(set(told) - {part})
    print(f"{right} of 24 named right, {false} false names")
    assert right >= 23
    assert false <= 3


def test_sound_records_name_no_bearing_more_often_than_is_said() -> None:
    names, rates = 0, 0
    for number in range(40):
        bearing = list(BEARINGS)[number % 3]
        x, speed, _ = record(82_000 + number, bearing, "")
        found = heard(x, speed, bearing)
        names += any(line.chance <= HEARD for line in found.lines)
        rates += clearest_line(found, ["a"], shaft=speed / RATE, rate=RATE) is not None
    print(f"{names} names and {rates} rates in 40 sound records")
    for count in (names, rates):
        assert stats.binomtest(count, 40, HEARD, alternative="greater").pvalue > 0.01


def test_measure_names_a_defect_in_turns_and_hertz() -> None:
    seed, bearing, part = 83_001, "6305", PARTS[1]
    found = measured(seed, bearing, part)
    speed = record(seed, bearing, part)[1]
    line = found.defects[0]
    assert (line.part, line.bearing) == (part, bearing)
    assert line.order == pytest.approx(order(bearing, part), rel=0.02)
    told = figures(found)
    assert line.words in told["evidence"]
    assert told["defects"][0]["part"] == part
    (clear,) = found.swellings
    assert clear.frequency == pytest.approx(clear.order * speed, rel=2e-3)
    assert clear.words in told["evidence"]


def test_without_a_shaft_nothing_is_said_of_bearings() -> None:
    found = measured(83_000, "6305", PARTS[0], known=False)
    assert found.gearing is None or found.gearing.shaft is None
    assert found.defects == found.swellings == ()


def test_one_knock_a_turn_is_one_rate_and_no_bearing() -> None:
    """Of a bearing whose outer race (3.05) has the third order in its window."""
    drawn = np.random.default_rng(84_000)
    speed, train = 20.0, np.zeros(int(5 * RATE))
    at = (np.arange(99) + 0.3) / speed
    train[(at * RATE).astype(int)] = 1.0 + 0.5 * drawn.normal(size=at.size)
    pole = np.exp(2 * np.pi * 0.3 * (-0.03 + 1j))
    ringing = signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], train)
    x = ringing / np.std(ringing) + drawn.normal(size=train.size)
    found = heard(x, speed, "6204")
    clear = clearest_line(found, ["a"], shaft=speed / RATE, rate=RATE)
    assert clear is not None
    assert clear.order == pytest.approx(1.0, abs=0.02)
    assert min(line.chance for line in found.lines) > HEARD


def test_lines_are_taken_out_and_noise_stays() -> None:
    drawn = np.random.default_rng(84_001)
    noise, turn = drawn.normal(size=40_000), 2 * np.pi * np.arange(40_000) / 40_000
    lines = sum(size * np.cos(f * turn) for size, f in ((30.0, 2400), (5.0, 5700), (0.3, 90.4)))
    left = without_lines(noise + lines)
    assert np.std(left - noise) < 0.1
    # a tenth of all bins, as asked
    assert np.var(without_lines(noise, spacings=[30.0]) - noise) == pytest.approx(0.1, abs=0.01)
