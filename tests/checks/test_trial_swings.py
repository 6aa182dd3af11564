"""Speeds that swing a few times in a record: the angle, the amplitudes. A few of the
trial's law; `make trial NAME=swings` runs it whole."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scripts import script

from thermogear.measured.reduction import measure
from thermogear.signals.following import follow_line

TRIAL = script("trials/swings")


def slow(seed: int) -> Any:
    """The first record drawn that swings slower than a fourth of its shaft."""
    random = np.random.default_rng(seed)
    return next(one for one in iter(lambda: TRIAL.drawn(random), None) if one.kind == 0)


@pytest.mark.parametrize("number", range(4))
def test_the_angle_of_a_followed_line_holds_to_the_ends_of_the_record(number: int) -> None:
    made = slow(25_112_026 + number)
    cycles = made.teeth * (made.turns - made.turns[0])
    mesh = made.teeth * made.shaft
    beside = mesh - made.shaft, mesh + made.shaft
    found = follow_line(
        made.values, TRIAL.RATE, frequency=mesh, half_width=0.1 * mesh, beside=beside
    )
    off = 2 * np.pi * (found.cycles - cycles)
    off -= off.mean()
    print(np.std(off), off[[0, -1]])
    assert np.abs(off[[0, -1]]).max() < 0.2  # it was 0.5 rad and more for a swing of 2 %
    assert np.std(off) < 0.05


@pytest.mark.parametrize("number", range(4))
def test_amplitudes_of_a_speed_that_swings_are_in_their_intervals(number: int) -> None:
    made = slow(25_112_126 + number)
    off = TRIAL.errors(made)
    lines = np.abs(off["mesh line"] + off["sidebands"])
    print(off)
    assert lines.size == 6
    assert lines.max() < 2.0
    assert np.mean(lines < 1.0) > 0.6
    assert max(np.abs(off["frequency"]), default=0.0) < 2.0


def test_a_swing_is_told() -> None:
    codes = [one.code for one in measure(slow(25_112_126).record).notices]
    assert {"phase_wanders", "speed_tracked"} & set(codes)


@pytest.mark.parametrize("number", [0, 1, 2])
def test_a_swing_too_fast_to_be_followed_is_told_and_in_the_intervals(number: int) -> None:
    """The line's own power stands beside it, to both sides: it was 60 to 1500 half widths off."""
    random = np.random.default_rng([25_112_726, number])
    t = np.arange(20_000) / TRIAL.RATE
    ratio, depth = random.uniform(0.6, 0.9), random.uniform(0.3, 1.2)
    turns = 9.0 * t + depth / (2 * np.pi * 40) * np.sin(2 * np.pi * 9.0 * ratio * t)
    values = 0.02 * random.standard_normal(t.size)
    by = 1.0 + 0.08 * np.cos(2 * np.pi * turns)
    values += by * np.cos(2 * np.pi * 40 * turns + random.uniform(0.0, 6.0))
    size = depth * 9.0 * ratio / (40 * 9.0)
    made = TRIAL.Swing(40, 0.08, size, 9.0 * ratio, turns, values)
    speed = 2.0 * np.pi * made.shaft
    found = measure(made.record, teeth=40, speed=speed, harmonics=1, sidebands=1)
    line = next(one for one in found.lines if one.name == "mesh x 1")
    assert line.reading * (1.0 + 1.1 * line.half_width) > 1.0 > line.reading
    assert line.half_width < 1.5 * (1.0 / line.reading - 1.0)
    assert abs(line.frequency - 40 * made.shaft) < line.frequency_half_width
    assert {"power_beside_mesh_line", "phase_wanders"} & {one.code for one in found.notices}


@pytest.mark.parametrize("sort", ["phase", "load"])
def test_small_oscillations_and_loads_are_in_the_intervals(sort: str) -> None:
    """They were up to 28 half widths off, untold. One as fast as the shaft, or a whole multiple,
    within three bins, may be sidebands: it is left out here."""
    off = list[float]()
    for number in range(3):
        made = TRIAL.drawn(np.random.default_rng([25_112_926, number]), sort)
        turns = made.rate / made.shaft
        bins = abs(turns - round(turns)) * made.shaft * made.turns.size / TRIAL.RATE
        if sort == "load" or bins > 3.0:
            off += [abs(one) for line in TRIAL.errors(made).values() for one in line]
    print(np.sort(off))
    assert len(off) >= 14
    assert max(off) < 3.0
    assert np.mean(np.array(off) < 1.0) > 0.8


def test_a_neighbour_on_one_side_is_no_swing() -> None:
    random = np.random.default_rng(25_112_826)
    t = np.arange(20_000) / TRIAL.RATE
    values = 0.02 * random.standard_normal(t.size) + np.cos(2 * np.pi * 360.0 * t)
    alone = TRIAL.Swing(40, 0.0, 0.0, 1.0, 9.0 * t, values)
    beside = TRIAL.Swing(40, 0.0, 0.0, 1.0, 9.0 * t, values + 0.3 * np.cos(2 * np.pi * 365.3 * t))
    widths = [measure(one.record, teeth=40).lines[0].half_width for one in (alone, beside)]
    assert widths[1] < 1.5 * widths[0]


def test_sidebands_keep_their_own_phase_where_the_speed_swings() -> None:
    """Uneven sidebands turn the mesh line's phase with the shaft: that is no swing of the speed.
    They were 30 to 60 % off where a filter took it into the angle."""
    random = np.random.default_rng(25_112_326)
    t = np.arange(20_000) / TRIAL.RATE
    turns = 9.0 * (t + 0.01 / (1.4 * np.pi) * np.sin(1.4 * np.pi * t))
    heights = {-1: 0.12, 0: 1.0, 1: 0.05}
    values = 0.03 * random.standard_normal(t.size)
    for side, height in heights.items():
        values += height * np.cos(2 * np.pi * (40 + side) * turns + random.uniform(0.0, 6.0))
    made = TRIAL.Swing(40, 0.0, 0.01, 0.7, turns, values)
    speed = 2.0 * np.pi * made.shaft
    lines = measure(made.record, teeth=40, speed=speed, harmonics=1).lines
    found = {line.name: line for line in lines}
    names = {-1: "mesh x 1 - 1 shaft/40", 0: "mesh x 1", 1: "mesh x 1 + 1 shaft/40"}
    for side, height in heights.items():
        line = found[names[side]]
        assert line.reading == pytest.approx(height, rel=2.0 * line.half_width)
        assert line.half_width < 0.1


def test_a_mesh_line_that_is_not_seen_is_not_read_while_teeth_are_undecided() -> None:
    """A mesh line's phase oscillates: half of it explains most lines, but none stands there."""
    kind, off, _, _ = TRIAL.run(("phase", 55))
    assert kind == len(TRIAL.RATIOS) + TRIAL.SORTS.index("phase")
    assert np.abs(off["mesh line"] + off["sidebands"]).max() < 1.5
