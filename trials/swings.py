"""How often stated intervals hold where the speed swings: records drawn with a known truth.

``make trial NAME=swings`` draws 200 records whose speed swings, and 100 each of a small fast
oscillation of the phase and of a load that oscillates (seed fixed before the first), gives each to
:func:`measure` with its teeth, and writes trials/records/swings.md;
``python trials/swings.py 20`` prints a table of 20 of each.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

Floats = NDArray[np.float64]

SEED = 41_2026
RUNS = (200, 100, 100)
"""Records of each of SORTS."""
SORTS = ("speed", "phase", "load")
PAGE = Path(__file__).parents[1] / "trials" / "records" / "swings.md"
RATE = 5_000.0
HEIGHTS = {1: 1.0, 2: 0.3}
"""Mesh line and its double."""
RATIOS = (0.25, 0.5)
"""Upper ends of the first two kinds: periods of the swing in a turn of the shaft."""
KINDS = (
    "speed, slower than a fourth of the shaft",
    "speed, up to half of it",
    "speed, faster",
    "phase, 0.3 to 3 times as fast as the shaft",
    "load, 1.5 to 12 periods in the record",
)
LINES = ("mesh line", "sidebands", "frequency")


@dataclass(frozen=True)
class Swing:
    """A record of cosines in the angle of a gear, each times (1 + m cos) of its shaft, and its
    truth: ``turns`` of the shaft at the samples; ``size`` of the swing, relative, and its ``rate``
    [Hz]; ``sort`` of SORTS; ``load``: root of the mean square of the load that oscillates."""

    teeth: int
    modulation: float
    size: float
    rate: float
    turns: Floats
    values: Floats
    sort: str = "speed"
    load: float = 1.0

    @property
    def shaft(self) -> float:
        """Mean turns/s over the record."""
        return float((self.turns[-1] - self.turns[0]) / (self.turns.size - 1)) * RATE

    @property
    def kind(self) -> int:
        """Which of KINDS."""
        if self.sort != "speed":
            return len(RATIOS) + SORTS.index(self.sort)
        return int(np.searchsorted(RATIOS, self.rate / self.shaft))

    @property
    def amplitudes(self) -> dict[str, float]:
        """Of the lines, by their names."""
        found = {f"mesh x {rank}": height * self.load for rank, height in HEIGHTS.items()}
        for rank, height in HEIGHTS.items():
            for sign in "-+":
                name = f"mesh x {rank} {sign} 1 shaft/{self.teeth}"
                found[name] = 0.5 * self.modulation * height * self.load
        return found

    @property
    def record(self) -> Record:
        """As a record."""
        return Record((Channel("a", self.values, "g"),), "made", RATE, "made")


def drawn(random: np.random.Generator, sort: str = "speed") -> Swing:
    """A gear of 12 to 80 teeth, mesh line 200 to 900 Hz, 2 to 8 s; a swing of 0.1 to 3 % at 0.05 to
    8 Hz, sidebands of 1 to 7.5 %, noise of rms 0.3 to 16 % of the mesh line.

    By its ``sort`` a mesh line's phase of 0.02 to 0.25 rad that oscillates at 0.3 to 3 times the
    shaft, or a load of 2 to 10 % with 1.5 to 12 periods in the record, instead of that swing.
    """

    def between(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    teeth = int(random.integers(12, 81))
    shaft = random.uniform(200.0, 900.0) / teeth
    t = np.arange(int(RATE * random.uniform(2.0, 8.0))) / RATE
    size, rate, load = between(1e-3, 3e-2), between(0.05, 8.0), 0.0
    if sort == "phase":
        rate = shaft * random.uniform(0.3, 3.0)
        size = between(0.02, 0.25) * rate / (teeth * shaft)
    elif sort == "load":
        size, rate, load = 0.0, random.uniform(1.5, 12.0) * RATE / t.size, between(0.02, 0.1)
    lag = random.uniform(0.0, 2 * np.pi)
    turns = shaft * (t + size / (2 * np.pi * rate) * np.sin(2 * np.pi * rate * t + lag))
    force = 1.0 + load * np.cos(2 * np.pi * rate * t + lag)
    modulation, noise = random.uniform(0.02, 0.15), between(3e-3, 0.16)
    values = noise * random.standard_normal(t.size)
    for rank, height in HEIGHTS.items():
        by = 1.0 + modulation * np.cos(2 * np.pi * turns + random.uniform(0.0, 2 * np.pi))
        turn = 2 * np.pi * rank * teeth * turns + random.uniform(0.0, 2 * np.pi)
        values += height * force * by * np.cos(turn)
    rms = float(np.sqrt(np.mean(force**2)))
    return Swing(teeth, modulation, size, rate, turns, values, sort, rms)


def errors(made: Swing) -> dict[str, list[float]]:
    """Errors of ``measure`` in half widths, by LINES; of a line that is not found, infinite."""
    speed = 2.0 * np.pi * made.shaft
    lines = measure(made.record, teeth=made.teeth, speed=speed).lines
    found = {line.name: line for line in lines}
    told: dict[str, list[float]] = {name: [] for name in LINES}
    for name, truth in made.amplitudes.items():
        line = found.get(name)
        off = np.inf if line is None else (1.0 - truth / line.reading) / line.half_width
        told["mesh line" if name in ("mesh x 1", "mesh x 2") else "sidebands"].append(float(off))
    line = found.get("mesh x 1")
    if line is not None and np.isfinite(line.frequency_half_width):
        off = (line.frequency - made.teeth * made.shaft) / line.frequency_half_width
        told["frequency"].append(float(off))
    return told


def run(case: tuple[str, int]) -> tuple[int, dict[str, list[float]] | str, float, str]:
    """One record by its sort and number: its kind, its errors or why there are none, processor
    time, what it is."""
    start = time.process_time()
    sort, number = case
    seed = [SEED, number] if sort == "speed" else [SEED, SORTS.index(sort), number]
    made = drawn(np.random.default_rng(seed), sort)
    words = (
        f"{sort}, record {number}: {made.teeth} teeth, shaft {made.shaft:.2f} Hz, speed "
        f"{100 * made.size:.2f} % at {made.rate:.2f} Hz, {made.turns.size / RATE:.1f} s"
    )
    try:
        told: dict[str, list[float]] | str = errors(made)
    except ValueError as error:
        told = str(error)
    return made.kind, told, time.process_time() - start, words


def table(rows: list[tuple[int, dict[str, list[float]] | str, float, str]]) -> list[str]:
    """The table, and each record that is more than three half widths off or refused."""
    lines = [
        "| oscillates | line | intervals | inside [%] | worst [half widths] |",
        "|---|---|---:|---:|---:|",
    ]
    for kind, name in enumerate(KINDS):
        own = [told for of, told, _, _ in rows if of == kind and not isinstance(told, str)]
        for line in LINES:
            off = np.abs([one for told in own for one in told[line]])
            if off.size:
                share, worst = 100 * np.mean(off <= 1.0), off.max()
                lines.append(f"| {name} | {line} | {off.size} | {share:.1f} | {worst:.2f} |")
    lines.append("")
    for _, told, _, words in rows:
        if isinstance(told, str):
            lines.append(f"- refused, {words}: {told}")
        else:
            worst = max(abs(one) for line in told.values() for one in line)
            if worst > 3.0:
                lines.append(f"- {worst:.3g} half widths, {words}")
    minutes = sum(seconds for _, _, seconds, _ in rows) / 60
    return [*lines, "", f"Seed {SEED}; {len(rows)} records; processor time {minutes:.0f} min."]


HEAD = """# Do stated intervals hold where the speed swings?

Made by `make trial NAME=swings` (`trials/swings.py`). Each record is a gear's mesh line and its
double, with sidebands of its shaft, while the speed swings as a sine: a control that hunts, a slow
torsional mode. Nothing but the teeth is stated. Drawn are 12 to 80 teeth, a mesh line of 200 to
900 Hz, 2 to 8 s at 5000 samples/s, a swing of 0.1 to 3 % at 0.05 to 8 Hz, sidebands of 1 to 7.5 %
and noise of 0.3 to 16 % of the mesh line. The truth of the amplitudes is that in the gear's own
angle; that of the frequency is turns over time. A swing faster than half of the shaft is not told
from the shaft's own sidebands and is not followed: the lines are then those of the spectrum, and
what is at equal distances to both sides of the mesh line, but is no sideband of its shaft, is in
its intervals. Two further sorts are small oscillations: of the mesh line's phase by 0.02 to
0.25 rad at 0.3 to 3 times the shaft, and of the load by 2 to 10 %, 1.5 to 12 periods in the record,
whose truth is the root of the mean square. Where an oscillation is as fast as the shaft or a whole
multiple, within a bin of the spectrum, nothing tells it from sidebands: those records are the ones
far outside. Before any of it was so, 26.9 % of the mesh lines of the third kind were inside, the
worst 5907 half widths off.
"""


def main(count: int | None) -> None:
    """All onto the page, or a few printed."""
    with ProcessPoolExecutor(2) as pool:
        runs = RUNS if count is None else [count] * len(SORTS)
        cases = [(sort, i) for sort, most in zip(SORTS, runs, strict=True) for i in range(most)]
        rows = list(pool.map(run, cases))
    lines = table(rows)
    if count is None:
        PAGE.write_text("\n".join([HEAD, *lines, ""]), encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else None)
