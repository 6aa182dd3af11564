"""Few turns of a shaft, a shaft that is not known: do stated intervals hold?

``make trial NAME=shafts`` draws records of each of SORTS (seed fixed before the first), gives
each to :func:`measure` with the teeth of one gear, and writes trials/records/shafts.md;
``python trials/shafts.py 20`` prints a table of 20 of each.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 61_2026
RUNS = 40
"""Records of each of SORTS."""
SORTS = (
    "few turns, steady",
    "few turns, speed changes",
    "unknown shaft, steady",
    "unknown shaft, speed walks",
    "known shaft, speed changes",
    "unknown slower mate, steady",
)
PAGE = Path(__file__).parents[1] / "trials" / "records" / "shafts.md"
RATE = 4_000.0
SPANS = (1.5, 3.0, 4.0, 8.0, 24.0, 60.0)
"""Turns of the shaft, between which the table tells apart."""
LINES = ("mesh line", "sidebands", "frequency")


@dataclass(frozen=True)
class Made:
    """A record with its truth: ``shaft`` mean [turns/s], ``amplitudes`` of lines by their names,
    ``span`` turns of the shaft in it."""

    teeth: int
    shaft: float
    span: float
    amplitudes: dict[str, float]
    values: Floats
    words: str

    @property
    def record(self) -> Record:
        """As a record."""
        return Record((Channel("a", self.values, "g"),), "made", RATE, "made")


def between(random: Random, low: float, high: float) -> float:
    """Drawn evenly in the logarithm."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def changes(random: Random, sort: str, time_of: Floats, span: float) -> tuple[Floats, str]:
    """Relative change of the speed at each sample, and in words."""
    how = str(random.choice(["walks", "oscillates", "drifts"]))
    if "steady" in sort:
        return np.zeros(time_of.size), "steady"
    if "walks" in sort:
        how = "walks"
    size, end = between(random, 3e-4, 1e-2), float(time_of[-1])
    if how == "walks":
        constant = between(random, 0.2, 5.0)
        pole = float(np.exp(-1.0 / (RATE * constant)))
        noise = random.standard_normal(time_of.size) * np.sqrt(1.0 - pole**2)
        noise[0] = random.standard_normal()
        words = f"walks by {100 * size:.2f} %, {constant:.2g} s"
        return size * signal.lfilter([1.0], [1.0, -pole], noise), words
    if how == "oscillates":
        rate = random.uniform(0.3, min(3.0, 0.5 * span)) / end
        wave = np.sin(2 * np.pi * rate * time_of + random.uniform(0.0, 2 * np.pi))
        return size * wave, f"oscillates by {100 * size:.2f} % at {rate:.2g} Hz"
    return size * random.choice([-1.0, 1.0]) * (
        time_of / end - 0.5
    ), f"drifts by {100 * size:.2f} %"


def drawn(random: Random, sort: str) -> Made:
    """A gear of 12 to 90 teeth, mesh line of 150 to 700 Hz and its double, two pairs of sidebands
    of 1 to 15 %, noise of rms 0.3 to 30 % of the mesh line, over 1.5 to 60 turns of the shaft.

    An unknown shaft turns a half or a third as fast, or has one to three teeth more or less, its
    sidebands of 1 to 30 %; it is two turns or more from the known one's. An unknown slower mate
    turns 1 to 4.5 times, its first sidebands of 1 to 15 % and its second lower.
    """
    few = sort.startswith("few")
    teeth, mesh = int(random.integers(12, 91)), between(random, 150.0, 700.0)
    span = between(
        random, *((SPANS[0], 8.0) if few else (4.0 if sort.startswith("known") else 12.0, 60.0))
    )
    mate = 0
    if "mate" in sort:
        teeth = int(random.integers(12, 61))
        mate = max(teeth + 1, int(teeth * random.uniform(1.0, 3.0)))
        span = random.uniform(1.0, 4.5) * mate / teeth
    count = max(400, int(span * teeth / mesh * RATE))
    t = np.arange(count) / RATE
    change, words = changes(random, sort, t, span)
    cycles = np.cumsum(mesh * (1.0 + change)) / RATE
    sides = [(1 / teeth, between(random, 0.01, 0.15)), (2 / teeth, between(random, 0.01, 0.15))]
    if mate:
        first = between(random, 0.01, 0.15)
        sides += [(1 / mate, first), (2 / mate, first * random.uniform(0.0, 1.0))]
        words += f", unknown mate of {mate} teeth with {100 * first:.0f} %"
    elif "unknown" in sort:
        others = [2 * teeth, 3 * teeth, *(teeth + n for n in (-3, -2, -1, 1, 2, 3))]
        apart = [one for one in others if abs(1 / one - 1 / teeth) * mesh * t[-1] > 2.0]
        other = int(random.choice(apart))
        sides.append((1 / other, between(random, 0.01, 0.3)))
        words += f", unknown {other} teeth with {100 * sides[-1][1]:.0f} %"
    values = between(random, 3e-3, 0.3) * random.standard_normal(count)
    amplitudes = {}
    for rank, height in ((1, 1.0), (2, float(random.uniform(0.2, 0.8)))):
        amplitudes[f"mesh x {rank}"] = height
        values += height * np.cos(2 * np.pi * rank * cycles + random.uniform(0.0, 2 * np.pi))
        for place, share in sides:
            for sign, mark in ((-1, "-"), (1, "+")):
                turn = 2 * np.pi * (rank + sign * place) * cycles
                values += height * share * np.cos(turn + random.uniform(0.0, 2 * np.pi))
                if place == 1 / teeth:
                    amplitudes[f"mesh x {rank} {mark} 1 shaft/{teeth}"] = height * share
    mean = (cycles[-1] - cycles[0]) / (count - 1) * RATE
    span = mean * count / RATE / teeth
    words = f"{teeth} teeth, {mesh:.0f} Hz, {span:.1f} turns, {words}"
    return Made(teeth, float(mean) / teeth, span, amplitudes, values, words)


@dataclass(frozen=True)
class Row:
    """What became of one record: errors in half widths by LINES, or why there are none."""

    sort: str
    span: float
    errors: dict[str, list[float]]
    refused: str
    withheld: int
    seconds: float
    words: str


def run(case: tuple[int, int]) -> Row:
    """One record by its sort and number."""
    start = time.process_time()
    made = drawn(np.random.default_rng([SEED, *case]), SORTS[case[0]])
    errors: dict[str, list[float]] = {name: [] for name in LINES}
    words = f"{SORTS[case[0]]}, record {case[1]}: {made.words}"
    refused, withheld = "", 0
    try:
        speed = 2.0 * np.pi * made.shaft
        result = measure(made.record, teeth=made.teeth, speed=speed, sidebands=1, harmonics=2)
    except ValueError as error:
        refused = str(error)
    else:
        open_line = {"followed_line_undecided", "few_turns"} & {one.code for one in result.notices}
        found = {line.name: line for line in result.lines}
        for name, truth in made.amplitudes.items():
            line = found.get(name)
            if line.withheld if line is not None else open_line and "shaft" in name:
                withheld += 1  # none are read of few turns, or where the line may be another gear's
                continue
            off = np.inf if line is None else (1.0 - truth / line.reading) / line.half_width
            errors["sidebands" if "shaft" in name else "mesh line"].append(float(off))
        line = found.get("mesh x 1")
        if line is not None and np.isfinite(line.frequency_half_width):
            off = (line.frequency - made.teeth * made.shaft) / line.frequency_half_width
            errors["frequency"].append(float(off))
    seconds = time.process_time() - start
    return Row(SORTS[case[0]], made.span, errors, refused, withheld, seconds, words)


def table(rows: list[Row]) -> list[str]:
    """The table, and each record that is more than three half widths off or refused."""
    lines = [
        "| record | turns | records | sidebands withheld | mesh line inside [%] | "
        "worst | sidebands [%] | worst | frequency [%] | worst |",
        "|---|---|---:|---:|---:|---:|---:|---:|---:|---:|",
    ]
    for sort in SORTS:
        for low, high in pairwise(SPANS):
            own = [row for row in rows if row.sort == sort and low <= row.span < high]
            if not own:
                continue
            cells = [sort, f"{low:g}..{high:g}", str(len(own))]
            cells.append(str(sum(row.withheld > 0 for row in own)))
            for name in LINES:
                off = np.abs([one for row in own for one in row.errors[name]])
                cells += (
                    [f"{100 * np.mean(off <= 1.0):.1f}", f"{off.max():.2f}"]
                    if off.size
                    else ["–", "–"]
                )
            lines.append("| " + " | ".join(cells) + " |")
    lines.append("")
    for row in rows:
        worst = max((abs(one) for line in row.errors.values() for one in line), default=0.0)
        if row.refused:
            lines.append(f"- refused, {row.words}: {row.refused}")
        elif worst > 3.0:
            lines.append(f"- {worst:.3g} half widths, {row.words}")
    minutes = sum(row.seconds for row in rows) / 60
    return [*lines, "", f"Seed {SEED}; {len(rows)} records; processor time {minutes:.0f} min."]


HEAD = """# Few turns of a shaft, a shaft that is not known: do stated intervals hold?

Made by `make trial NAME=shafts` (`trials/shafts.py`). Each record is a gear's mesh line of 150 to
700 Hz and its double, with two pairs of sidebands of 1 to 15 %, in noise of 0.3 to 30 %. Nothing
but the teeth of this gear is stated. A speed that changes walks (0.2 to 5 s), oscillates (0.3 to 3
periods in the record, at most half as fast as the shaft) or drifts, by 0.03 to 1 %. An unknown
shaft has sidebands of 1 to 30 %; it turns a half or a third as fast, or its gear has up to three
teeth more or less. An unknown slower mate has up to three times the teeth and turns 1 to 4.5 times
in the record, with sidebands of 1 to 15 % and second ones that are lower. The truth is that in the
gear's own angle, or turns over time.

Below four turns nothing tells sidebands from a speed that changes: they are withheld where it does,
and below two turns always. Where a slower mate is not known, that is told in words, and the mesh
lines' intervals hold what it may bring; those of sidebands do not where one of the mate stands
within a bin or so of them. The worst are in half widths. Sidebands of an unknown shaft that turn
the phase alone are not told from an oscillation of the speed: the intervals hold both.
"""


def main(count: int | None) -> None:
    """All onto the page, or a few printed."""
    cases = [(sort, i) for sort in range(len(SORTS)) for i in range(count or RUNS)]
    with ProcessPoolExecutor(2) as pool:
        rows = list(pool.map(run, cases, chunksize=4))
    lines = table(rows)
    if count is None:
        PAGE.write_text("\n".join([HEAD, *lines, ""]), encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else None)
