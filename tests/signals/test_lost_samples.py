"""Samples lost: a step of the mesh line's phase, beside sidebands of shafts known and not."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import signal

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure


RATE = 4000.0
MESH = 400.0
Floats = NDArray[np.float64]


def mesh_line(random: np.random.Generator, teeth: int, cycles: Floats) -> Floats:
    """A mesh line of amplitude 1 with two pairs of sidebands, in noise."""
    made = random.uniform(0.01, 0.3) * random.standard_normal(cycles.size)
    made += np.cos(2 * np.pi * cycles)
    for n in (1, 2):
        size = random.uniform(0.01, 0.12)
        for sign in (-1, 1):
            turn = 2 * np.pi * (1 + sign * n / teeth) * cycles
            made += size * np.cos(turn + random.uniform(0.0, 6.3))
    return made


def cycles_of(kind: str, random: np.random.Generator, count: int) -> tuple[Floats, int]:
    """Cycles at each sample, and where samples are lost (0: nowhere)."""
    t = np.arange(count) / RATE
    if kind == "lost":
        at = int(count * random.uniform(0.3, 0.7))
        return MESH * (t + (np.arange(count) >= at) * random.integers(23, 400) / RATE), at
    size = np.exp(random.uniform(np.log(1e-4), np.log(2e-2)))
    change = np.zeros(count)
    if kind == "walks":
        pole = np.exp(-1.0 / (RATE * random.uniform(0.05, 2.0)))
        change = signal.lfilter([1.0], [1.0, -pole], random.standard_normal(count))
        change *= size * np.sqrt(1.0 - pole**2)
    if kind == "oscillates":
        change = size * np.sin(2 * np.pi * random.uniform(0.3, 3.0) * t / t[-1])
    if kind == "drifts":
        change = size * (t / t[-1] - 0.5)
    return np.cumsum(MESH * (1.0 + change)) / RATE, 0


@pytest.mark.parametrize("kind", ["steady", "walks", "oscillates", "drifts", "lost"])
def test_a_step_is_seen_where_samples_are_lost_and_nowhere_else(kind: str) -> None:
    seen = placed = 0
    for number in range(40):
        random = np.random.default_rng([28, number])
        teeth, turns = int(random.integers(12, 90)), random.uniform(4.0, 45.0)
        cycles, at = cycles_of(kind, random, int(turns * teeth / MESH * RATE))
        x = mesh_line(random, teeth, cycles)
        mean = (cycles[-1] - cycles[0]) / (cycles.size - 1)
        found = phase_step(x, mean, [float(teeth)])
        seen += found is not None
        placed += found is not None and abs(found[0] - at) <= found[1]
    print(f"{kind}: {seen} of 40, {placed} where they are")
    if kind == "lost":
        assert seen >= 28
        assert placed == seen
    else:
        assert seen == 0


@pytest.mark.parametrize("teeth", [(17.0, 34.0, 51.0), (40.0, 80.0, 160.0), (20.0, 40.0)])
def test_shafts_in_whole_ratios_turn_the_phase_alike(teeth: tuple[float, ...]) -> None:
    """Their waves are the same: a step's error was no number."""
    random = np.random.default_rng(30)
    t = np.arange(int(12 * max(teeth) / MESH * RATE)) / RATE
    for lost in (0, 53):
        x = mesh_line(random, int(min(teeth)), MESH * (t + (t > 0.5 * t[-1]) * lost / RATE))
        assert (phase_step(x, MESH / RATE, teeth) is not None) == (lost > 0)


def test_lost_samples_are_told_over_eight_turns() -> None:
    """Below 24 turns of the shaft they were not: the shaft was up to 67 half widths off."""
    random = np.random.default_rng(29)
    teeth = 40
    t = np.arange(int(8 * teeth / MESH * RATE)) / RATE
    x = mesh_line(random, teeth, MESH * (t + (t > 0.3) * 53 / RATE))
    found = measure(Record((Channel("a", x, "g"),), "made", RATE, "made"), teeth=teeth)
    assert len(found.findings) == 1
    line = next(one for one in found.lines if one.name == "mesh x 1")
    assert abs(line.frequency - MESH) < 1.5 * line.frequency_half_width
    assert abs(line.reading - 1.0) < 1.5 * line.half_width * line.reading


def test_two_losses_are_both_left_out() -> None:
    """The smaller one, a tenth of a cycle, does not show beside the other."""
    random = np.random.default_rng(32)
    teeth = 23
    t = np.arange(int(60 * teeth / MESH * RATE)) / RATE
    for _ in range(4):
        places = random.uniform(0.15, 0.3), random.uniform(0.65, 0.8)
        lost = (41 * (t > places[0] * t[-1]) + 65 * (t > places[1] * t[-1])) / RATE
        x = mesh_line(random, teeth, MESH * (t + lost))
        found = measure(Record((Channel("a", x, "g"),), "made", RATE, "made"), teeth=teeth)
        assert all(
            not found.start < place * t.size < found.start + found.samples for place in places
        )
        line = next(one for one in found.lines if one.name == "mesh x 1")
        assert abs(line.frequency - MESH) < 1.5 * line.frequency_half_width
