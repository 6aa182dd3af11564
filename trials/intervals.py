"""How often stated 95 % intervals of a measured line hold: records drawn with a known truth.

``make trial NAME=intervals`` draws 500 records for each scenario (seed fixed before the first
run), gives
each to :func:`measure`, and counts how often the interval of the mesh line's amplitude, of its
frequency and of the shaft speed holds the truth. It writes trials/records/coverage.md;
``python trials/intervals.py 40`` prints a table of 40 records each, with ``--write`` after it
it writes the page.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import signal

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 31_2026
RUNS = 500
PAGE = Path(__file__).parents[1] / "trials" / "records" / "coverage.md"
TEETH = 25
HARMONICS = ((1, 1.0), (2, 0.5))
SIDES = ((1, 0.12), (2, 0.05))
"""Sidebands n shaft turns from every harmonic, relative to it."""


@dataclass(frozen=True)
class Scenario:
    """What one record is drawn from; amplitudes relative to the mesh line's.

    ``noise`` rms; ``colour`` pole of its first-order filter (0: white) or "resonance"; ``load`` and
    ``wander`` relative rms of amplitude and speed with their correlation times [s]; ``offset`` and
    ``fade``: change of the offset and of the amplitude over the record; ``neighbour``: (distance
    [Hz], amplitude) of a line beside the mesh line; ``sides``: whether it has sidebands.
    """

    name: str
    seconds: float = 4.0
    rate: float = 2560.0
    mesh: float = 400.0
    noise: float = 0.1
    colour: float = 0.0
    resonance: bool = False
    load: float = 0.0
    load_time: float = 1.0
    wander: float = 0.0
    wander_time: float = 1.0
    offset: float = 0.0
    fade: float = 0.0
    neighbour: tuple[float, float] | None = None
    sides: bool = True


SCENARIOS = (
    Scenario("white noise, rms 0.1"),
    Scenario("white noise, rms 4", noise=4.0),
    Scenario("red noise (pole 0.95), rms 0.3", noise=0.3, colour=0.95),
    Scenario("noise of a resonance 1 % above the line, rms 0.3", noise=0.3, resonance=True),
    Scenario("load wanders 5 %, 0.1 s", load=0.05, load_time=0.1),
    Scenario("load wanders 5 %, 1 s", load=0.05, load_time=1.0),
    Scenario("load wanders 5 %, 10 s", load=0.05, load_time=10.0),
    Scenario("speed wanders 0.1 %, 1 s", wander=1e-3),
    Scenario("speed wanders 1 %, 1 s", wander=1e-2),
    Scenario("load wanders 5 % and speed 0.1 %, 1 s", load=0.05, wander=1e-3),
    Scenario("offset drifts by 5 amplitudes", offset=5.0),
    Scenario("amplitude drifts by 20 %", fade=0.2),
    Scenario("neighbour 0.4 Hz away, 0.3 amplitudes", neighbour=(0.4, 0.3)),
    Scenario("neighbour 0.4 Hz away, 0.3, record of 10 s", neighbour=(0.4, 0.3), seconds=10.0),
    Scenario("record of 2 s", seconds=2.0),
    Scenario("record of 50 mesh periods", seconds=0.125),
    Scenario("record of 12 mesh periods, no sidebands", seconds=0.1, mesh=120.0, sides=False),
)
NUMBERS = ("amplitude", "amplitude, 2nd harmonic", "frequency", "shaft speed")
HOLDS = (0.92, 0.99)
WIDEST = 2.5
"""Median half width of the amplitude over the standard deviation of its error, at most."""


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A record and its truth: mesh lines' rms amplitudes, mean mesh frequency [Hz]."""

    record: Record
    amplitudes: tuple[float, ...]
    frequency: float
    nominal: float


def wandering(random: Random, count: int, *, rate: float, time_constant: float) -> Floats:
    """A stationary process of unit variance with correlation exp(-|t|/time_constant).

    Exact at the samples: x_j = r x_(j-1) + sqrt(1 - r^2) e_j, r = exp(-1/(rate time constant)).
    """
    r = float(np.exp(-1.0 / (rate * time_constant)))
    steps = np.sqrt(1.0 - r * r) * random.normal(size=count)
    steps[0] = random.normal()
    return np.asarray(signal.lfilter([1.0], [1.0, -r], steps))


def noise_of(random: Random, scenario: Scenario, count: int, mesh: float) -> Floats:
    """Noise of the scenario's colour and rms."""
    burn = 2000
    white = random.normal(size=count + burn)
    if scenario.resonance:
        # a mode with 2 % damping, one per cent above the mesh line
        turn = 2.0 * np.pi * 1.01 * mesh / scenario.rate
        pole = np.exp((-0.02 + 1j) * turn)
        white = signal.lfilter([1.0], [1.0, -2.0 * pole.real, abs(pole) ** 2], white)
    elif scenario.colour:
        white = signal.lfilter([1.0], [1.0, -scenario.colour], white)
    kept = white[burn:]
    return np.asarray(scenario.noise * kept / np.std(white))


def drawn(scenario: Scenario, random: Random) -> Drawn:
    """One record of the scenario."""
    count = round(scenario.seconds * scenario.rate)
    t = np.arange(count) / scenario.rate
    mesh = scenario.mesh * float(random.uniform(0.98, 1.02))
    speed = np.full(count, mesh)
    if scenario.wander:
        path = wandering(random, count, rate=scenario.rate, time_constant=scenario.wander_time)
        speed = mesh * (1.0 + scenario.wander * path)
    # the trapezoidal rule keeps phase and mean speed one path
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / scenario.rate
    amplitude = np.ones(count)
    if scenario.load:
        path = wandering(random, count, rate=scenario.rate, time_constant=scenario.load_time)
        amplitude = amplitude * (1.0 + scenario.load * path)
    if scenario.fade:
        way = random.choice([-1.0, 1.0])
        amplitude = amplitude * (1.0 + way * scenario.fade * (t / t[-1] - 0.5))
    phase = random.uniform(0.0, 2.0 * np.pi, (len(HARMONICS), 2 * len(SIDES) + 1))
    x = noise_of(random, scenario, count, mesh)
    for (rank, height), own in zip(HARMONICS, phase, strict=True):
        line = np.cos(2 * np.pi * rank * cycles + own[0])
        for place, (n, share) in enumerate(SIDES if scenario.sides else ()):
            for side, turned in ((-1, own[2 * place + 1]), (1, own[2 * place + 2])):
                line += share * np.cos(2 * np.pi * (rank + side * n / TEETH) * cycles + turned)
        x += height * amplitude * line
    if scenario.neighbour is not None:
        away, height = scenario.neighbour
        side = random.choice([-1.0, 1.0])
        x += height * np.cos(2 * np.pi * (mesh + side * away) * t + random.uniform(0, 2 * np.pi))
    x += scenario.offset * random.normal() * (t / t[-1]) ** 2
    record = Record((Channel("a", x, "m/s^2"),), scenario.name, scenario.rate, "made")
    rms = float(np.sqrt(np.mean(amplitude**2)))
    return Drawn(
        record=record,
        amplitudes=tuple(height * rms for _, height in HARMONICS),
        frequency=float((cycles[-1] - cycles[0]) / t[-1]),
        nominal=2.0 * np.pi * scenario.mesh / TEETH,
    )


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One scenario: errors of the four NUMBERS and their stated half widths, (number, run).

    Of ``drawn`` records those in which a mesh line was found.
    """

    name: str
    errors: Floats
    half_widths: Floats
    drawn: int
    seconds: float

    @property
    def held(self) -> Floats:
        """Share of runs whose interval holds the truth, of each number."""
        return np.asarray(np.mean(np.abs(self.errors) <= self.half_widths, axis=-1))

    @property
    def widths(self) -> Floats:
        """Median half width over the errors' standard deviation."""
        return np.asarray(np.median(self.half_widths, axis=-1) / np.std(self.errors, axis=-1))

    @property
    def spreads(self) -> Floats:
        """Median half width over half the range that holds the middle 68.3 % of the errors.

        Of normal errors that is the standard deviation; a few records far off do not count.
        """
        low, high = np.quantile(self.errors, [0.1587, 0.8413], axis=-1)
        return np.asarray(np.median(self.half_widths, axis=-1) / (0.5 * (high - low)))


def run(place: int, count: int, first: int = 0) -> Cell:
    """``count`` records of one scenario, from number ``first`` on, through ``measure``."""
    scenario, start = SCENARIOS[place], time.process_time()
    rows = []
    for number in range(first, first + count):
        made = drawn(scenario, np.random.default_rng([SEED, place, number]))
        found = measure(
            made.record, teeth=TEETH, speed=made.nominal, sidebands=0, harmonics=len(HARMONICS)
        )
        lines = {line.name: line for line in found.lines}
        if "mesh x 1" not in lines:  # no interval is stated
            continue
        one, two = (lines[f"mesh x {rank}"] for rank, _ in HARMONICS)
        turn = 2.0 * np.pi * made.frequency / TEETH
        rows.append(
            [
                (one.acceleration - made.amplitudes[0], one.half_width * one.acceleration),
                (two.acceleration - made.amplitudes[1], two.half_width * two.acceleration),
                (one.frequency - made.frequency, one.frequency_half_width),
                (one.shaft_speed - turn, one.speed_half_width),
            ]
        )
    table = np.asarray(rows).transpose(2, 1, 0)
    return Cell(
        name=scenario.name,
        errors=table[0],
        half_widths=table[1],
        drawn=count,
        seconds=time.process_time() - start,
    )


def outside(cells: list[Cell]) -> list[str]:
    """What lies outside the bounds asked for."""
    said = []
    for cell in cells:
        for name, held in zip(NUMBERS, cell.held, strict=True):
            if not HOLDS[0] <= held <= HOLDS[1]:
                said.append(f"{cell.name}, {name}: {100 * held:.1f} %")
        for name, width in zip(NUMBERS[:2], cell.widths, strict=False):
            if width > WIDEST:
                said.append(f"{cell.name}, {name}: median half width {width:.2f} of its sd")
    return said


def told(cells: list[Cell], count: int) -> list[str]:
    """The page's table and what lies outside."""
    low, high = (f"{100 * share:.0f}" for share in HOLDS)
    lines = [
        "| record | " + " | ".join(f"{name} [%]" for name in NUMBERS) + " | sd of amplitude [%] |"
        " half width/sd, amplitudes | half width/spread, amplitudes"
        " | records, without a mesh line |",
        "|---|" + "---:|" * (len(NUMBERS) + 4),
    ]
    for cell in cells:
        held = " | ".join(f"{100 * share:.1f}" for share in cell.held)
        sd = 100.0 * float(np.std(cell.errors[0]))
        widths = ", ".join(f"{one:.2f}" for one in cell.widths[:2])
        spreads = ", ".join(f"{one:.2f}" for one in cell.spreads[:2])
        runs = f"{cell.drawn}, {cell.drawn - cell.errors.shape[-1]}"
        lines.append(f"| {cell.name} | {held} | {sd:.3g} | {widths} | {spreads} | {runs} |")
    beyond = outside(cells)
    lines += [
        "",
        f"Asked for: {low} to {high} % in every cell, median half width of an amplitude at most "
        f"{WIDEST:g} standard deviations of its error. "
        + ("Outside: " + "; ".join(beyond) + "." if beyond else "Every cell is inside."),
        "",
        f"Seed {SEED}; a share of 95 % counted in {count} records scatters by "
        f"{100 * float(np.sqrt(0.95 * 0.05 / count)):.1f} %. Processor time "
        f"{sum(cell.seconds for cell in cells) / 60:.0f} min.",
    ]
    return lines


HEAD = """# Do the stated intervals of a line hold?

Made by `make trial NAME=intervals`. Every record has a mesh line of amplitude 1 near 400 Hz with a
second harmonic of 0.5, sidebands of 12 and 5 %, and white noise of rms 0.1 where nothing else is
said; 4 s at 2560 samples/s. Wandering quantities are stationary with an exponential correlation of
the time said. `measure` is told 25 teeth and the nominal speed; the mesh frequency lies up to 2 %
off.

What is measured: the amplitude over the record, root of the mean square of a(t) in
Re[a(t) exp(i phase)]; the mean frequency, turns over time; the shaft's mean speed. The table says
how often the 95 % interval holds the truth. Median half widths are given over the standard
deviation of the error and over its spread, half the range of the middle 68.3 % of the errors: equal
where errors are normal, while a few records far off make the first small.
"""


def main(count: int, write: bool) -> None:
    """Run every scenario, two at a time, and print or write the page."""
    places = range(len(SCENARIOS))
    with ProcessPoolExecutor(2) as pool:
        cells = []
        for cell in pool.map(run, places, [count] * len(places)):
            print(cell.name, cell.held.round(3), cell.widths.round(2), flush=True)
            cells.append(cell)
    page = "\n".join([HEAD, *told(cells, count), ""])
    if write:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page)


if __name__ == "__main__":
    given = [one for one in sys.argv[1:] if one != "--write"]
    main(int(given[0]) if given else RUNS, not given or "--write" in sys.argv)
