"""Sidebands of a further shaft, beside the stated gear's and beside the mesh line alone."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal

from thermogear.measured.lines import MeasuredLine
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

RATE, MESH, TEETH = 5000.0, 410.3, 29


def lines_of(x: NDArray[np.float64]) -> dict[str, MeasuredLine]:
    record = Record((Channel("a", x, "g"),), "made", RATE, "made")
    speed = 2.0 * np.pi * MESH / TEETH
    found = measure(record, teeth=TEETH, speed=speed, sidebands=1, harmonics=1)
    return {line.name: line for line in found.lines}


@pytest.mark.parametrize("bins", [0.3, 0.5, 0.8, 1.1, 1.5, 2.5])
def test_sidebands_beside_another_gears_are_in_their_interval(bins: float) -> None:
    """The other shaft turns 0.7 to 6 % faster: its sidebands lie 0.3 to 2.5 bins beside."""
    random = np.random.default_rng([18, round(10 * bins)])
    t = np.arange(15000) / RATE
    shaft = MESH / TEETH
    other = shaft + bins * RATE / t.size
    own, others = (
        size * np.cos(2 * np.pi * turn * t + random.uniform(0.0, 2 * np.pi))
        for size, turn in ((0.1, shaft), (0.12, other))
    )
    noise = 0.01 * random.standard_normal(t.size)
    lines = lines_of((1.0 + own + others) * np.cos(2 * np.pi * MESH * t) + noise)
    for sign in "-+":
        line = lines[f"mesh x 1 {sign} 1 shaft/{TEETH}"]
        off = (line.reading - 0.05) / (line.half_width * line.reading)
        print(f"{bins} bins, {sign}: {off:.2f} half widths of {100 * line.half_width:.2g} %")
        assert abs(off) < 1.5
        place = MESH + (1 if sign == "+" else -1) * shaft
        assert abs(line.frequency - place) < 2.0 * line.frequency_half_width
        if bins > 1.2:  # told apart
            assert line.half_width < 0.05


@pytest.mark.parametrize(("teeth", "other"), [(17, 45), (15, 76), (46, 113), (29, 31)])
def test_sidebands_of_an_unknown_slower_shaft_or_a_swing_are_both_in_the_interval(
    teeth: int, other: int
) -> None:
    """Pairs of lines at equal distances are either: the mesh line of a steady record, followed by
    them, was up to 52 half widths too high."""
    random = np.random.default_rng([19, teeth, other])
    t = np.arange(20_000) / RATE
    values = 0.01 * random.standard_normal(t.size)
    for rank, height in ((1, 1.0), (2, 0.5)):
        for size, side in ((1.0, 0.0), (0.03, 1 / teeth), (0.12, 1 / other)):
            for sign in (-1, 1) if side else (1,):
                turn = 2 * np.pi * MESH * (rank + sign * side) * t
                values += height * size * np.cos(turn + random.uniform(0.0, 2 * np.pi))
    record = Record((Channel("a", values, "g"),), "made", RATE, "made")
    speed = 2.0 * np.pi * MESH / teeth
    found = measure(record, teeth=teeth, speed=speed, sidebands=1, harmonics=2)
    lines = {line.name: line for line in found.lines}
    for rank, height in ((1, 1.0), (2, 0.5)):
        for name, size in ((f"mesh x {rank}", 1.0), (f"mesh x {rank} + 1 shaft/{teeth}", 0.03)):
            line = lines[name]
            off = (line.reading - size * height) / (line.half_width * line.reading)
            print(f"{name}: {off:.2f} half widths of {100 * line.half_width:.2g} %")
            assert abs(off) < 1.5
    assert abs(lines["mesh x 1"].frequency - MESH) < 1.5 * lines["mesh x 1"].frequency_half_width


@pytest.mark.parametrize("number", range(4))
def test_an_unknown_shaft_does_not_turn_the_path_of_a_line_that_walks(number: int) -> None:
    """Half of its sidebands went with the phase, and the mesh line was read with them."""
    random = np.random.default_rng([20, number])
    teeth, mesh, rate, seconds = 24, 300.0, 2000.0, 10.0
    size = int(seconds * rate)
    walk = np.exp(-1.0 / rate)  # 1 s
    steps = np.sqrt(1.0 - walk**2) * random.standard_normal(size)
    speed = mesh * (1.0 + 0.002 * signal.lfilter([1.0], [1.0, -walk], steps))
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / rate
    values = 0.01 * random.standard_normal(size)
    for order, amplitude in ((1.0, 1.0), (1 / teeth, 0.05), (1 / (3 * teeth), 0.15)):
        for sign in (1.0,) if order == 1.0 else (-1.0, 1.0):
            place = order if order == 1.0 else 1.0 + sign * order
            values += amplitude * np.cos(2 * np.pi * place * cycles + random.uniform(0.0, 6.3))
    record = Record((Channel("a", values, "g"),), "made", rate, "made")
    own = 2.0 * np.pi * mesh / teeth
    found = measure(record, teeth=teeth, speed=own, sidebands=1, harmonics=1)
    lines = {line.name: line for line in found.lines}
    line = lines["mesh x 1"]
    assert abs(line.reading - 1.0) < 1.5 * line.half_width
    assert line.half_width < 0.04
    for mark in "-+":
        side = lines[f"mesh x 1 {mark} 1 shaft/{teeth}"]
        assert abs(side.reading - 0.05) < 1.5 * side.half_width * side.reading


@pytest.mark.parametrize("bins", [1.2, 1.6, 1.8, 2.0, 2.6])
def test_a_line_next_to_a_sideband_is_no_change_of_the_mesh_line(bins: float) -> None:
    """The mesh line was read with it."""
    random = np.random.default_rng([21, round(10 * bins)])
    t = np.arange(20 * TEETH * int(RATE / MESH)) / RATE
    x = 0.01 * random.standard_normal(t.size) + np.cos(2 * np.pi * MESH * t)
    shaft = MESH / TEETH
    for away in (shaft, shaft + bins * RATE / t.size):
        for side in (-1, 1):
            turn = 2 * np.pi * (MESH + side * away) * t
            x += 0.1 * np.cos(turn + random.uniform(0.0, 6.3))
    line = lines_of(x)["mesh x 1"]
    print(f"{bins} bins: {(line.reading - 1.0) / line.half_width:.2f} of {line.half_width:.4f}")
    assert abs(line.reading - 1.0) < 1.5 * line.half_width
