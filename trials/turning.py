"""Runs whose speed changes, on trial: are order amplitudes within their stated intervals?

    python trials/turning.py              20 draws of each kind; trials/records/turning.md
    python trials/turning.py 3            3 draws of each, printed
    python trials/turning.py 20 2027      20 draws of another seed, printed

Each draw is a run of a shaft with 25 teeth, an unbalance, three mesh harmonics and two sidebands,
in noise. Amplitude and phase of mesh and sidebands follow one resonance, so that the truth is known
at every speed. Shapes of runs and what tells the angle: KINDS.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 2026
DRAWS = 20
PAGE = Path(__file__).parents[1] / "trials" / "records" / "turning.md"
RATE = 12_800.0
TEETH = 25
MARKS = 12
"""Marks of a toothed wheel, one of them missing."""
SECOND = 10.3
"""Order of a second stage's mesh line; its harmonic stands at twice that."""
KINDS = (
    "tacho, 10 % lost",
    "no tacho",
    "speed channel",
    "free coast-down, tacho",
    "stop in between, tacho",
    "second gear stage, tacho",
    "12 marks, one missing",
    "speed channel in volts",
)
WIDEST = 2.5
"""Half width over standard deviation of the error, at most; 1.96 where both are normal."""


@dataclass(frozen=True)
class Run:
    """A drawn run: ``turns`` and ``speed`` [turns/s] at every sample, amplitudes by order."""

    time: Floats
    values: Floats
    turns: Floats
    speed: Floats
    truth: dict[float, Floats]
    natural: float
    damping: float
    down: bool


def course(t: Floats, kind: str, first: float, last: float) -> Floats:
    """The shaft's speed [turns/s] over the run, without its ripple."""
    seconds = t.size / RATE
    if kind == KINDS[3]:  # friction in proportion to the speed
        return np.asarray(first * (last / first) ** (t / seconds))
    if kind == KINDS[4]:  # down to rest, a tenth of the time at rest, up again
        share = np.clip(np.abs(t / seconds - 0.45) / 0.45 - 1.0 / 9.0, 0.0, 1.0)
        return np.asarray(first * np.sin(0.5 * np.pi * np.minimum(share * 9.0 / 8.0, 1.0)) ** 2)
    return np.asarray(first + (last - first) * t / seconds)


def drawn(random: Random, seconds: float = 20.0, noise: float = 0.05, kind: str = "") -> Run:
    """One run between 8..14 and 38..50 turns/s past a resonance at 500..900 Hz."""
    low, high = random.uniform(8.0, 14.0), random.uniform(38.0, 50.0)
    down = bool(random.random() < 0.5) or kind in KINDS[3:5]
    first, last = (high, low) if down else (low, high)
    t = np.arange(int(seconds * RATE)) / RATE
    ripple = 0.1 * np.sin(0.8 * np.pi * t + random.uniform(0.0, 6.0))
    speed = course(t, kind, first, last)
    speed = speed + ripple * (np.minimum(speed, 1.0) if kind == KINDS[4] else 1.0)
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / RATE
    turns += random.uniform(0.0, 1.0)
    natural, damping = random.uniform(500.0, 900.0), random.uniform(0.02, 0.05)
    x = random.normal(0.0, noise, t.size)
    truth: dict[float, Floats] = {}
    sizes = [(1.0, 0.2), (24.0, 0.15), (25.0, 1.0), (26.0, 0.2), (50.0, 0.5), (75.0, 0.25)]
    if kind == KINDS[5]:
        sizes += [(SECOND, 0.4), (2.0 * SECOND, 0.2)]
    for order, size in sizes:
        ratio = order * speed / natural
        answer = np.ones(t.size, complex)
        if order > 1:
            answer = 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)
        angle = 2.0 * np.pi * order * turns + random.uniform(0.0, 6.0)
        x += size * np.real(answer * np.exp(1j * angle))
        truth[order] = size * np.abs(answer)
    return Run(t, x, turns, speed, truth, natural, damping, down)


def pulses(run: Run, random: Random, lost: float = 0.10, extra: float = 0.02) -> Floats:
    """A tacho, one pulse a turn: 10 % lost, 2 % added anywhere, noise on its level."""
    whole = np.arange(np.ceil(run.turns[0]), run.turns[-1])
    at = np.interp(whole, run.turns, run.time)
    at = at[random.random(at.size) > lost]
    at = np.append(at, random.uniform(0.0, run.time[-1], int(extra * whole.size)))
    return _levels(run, at, random, 20)


def marks(run: Run, random: Random) -> Floats:
    """A toothed wheel of MARKS marks, one of them missing."""
    whole = np.arange(np.ceil(MARKS * run.turns[0]), MARKS * run.turns[-1])
    whole = whole[whole % MARKS != 0]
    return _levels(run, np.interp(whole, MARKS * run.turns, run.time), random, 8)


def _levels(run: Run, at: Floats, random: Random, wide: int) -> Floats:
    found = random.normal(0.0, 0.05, run.time.size)
    for one in at:
        place = int(np.ceil(one * RATE))
        found[place : place + wide] += 5.0
    return found


def read(run: Run, kind: str, random: Random) -> Measurement:
    """The run read as a record of one kind."""
    a = Channel("a", run.values, "g")
    asked = [1.0, SECOND, 2.0 * SECOND] if kind == KINDS[5] else [1.0]
    if kind == KINDS[1]:
        nominal = 2.0 * np.pi * float(np.mean(run.speed))
        record = Record((a,), "made", RATE, "made")
        return measure(record, teeth=TEETH, speed=nominal, orders=asked)
    if kind in (KINDS[2], KINDS[7]):
        rpm = 60.0 * run.speed * 1.004 + random.normal(0.0, 5.0, run.time.size)
        speed = Channel("n", rpm, "rpm")
        if kind == KINDS[7]:  # 300 rpm/V from 0.5 V on, a converter of 12 bits over 10 V
            volts = np.rint((0.5 + rpm / 300.0) * 409.6) / 409.6
            speed = Channel("n", volts, "rpm", scale=300.0, offset=-150.0)
        record = Record((a, speed), "made", RATE, "made")
        return measure(record, teeth=TEETH, orders=asked)
    several = kind == KINDS[6]
    tacho = Channel("tacho", marks(run, random) if several else pulses(run, random), "V")
    record = Record((a, tacho), "made", RATE, "made", tacho="tacho")
    per_turn = float(MARKS) if several else 1.0
    return measure(record, teeth=TEETH, pulses_per_turn=per_turn, orders=asked)


def judged(run: Run, found: Measurement) -> Floats:
    """(order, off over half width) of every amplitude that is read; empty: no slices."""
    slices = found.slices
    rows: list[tuple[float, float]] = []
    for place, order in enumerate(slices.orders if slices else ()):
        known = min(run.truth, key=lambda one: abs(one - order))
        if slices is None or abs(known - order) > 0.02:
            continue
        true = np.interp(slices.time, run.time, run.truth[known])
        off = (slices.reading[0, place] - true) / slices.half_width[0, place]
        rows += [(known, float(one)) for one in off[np.isfinite(off)]]
    return np.asarray(rows).reshape(-1, 2)


@dataclass(frozen=True, kw_only=True)
class Row:
    """What came of one kind: ``off`` (order, off over half width), largest error of the speed,
    runs not read in angle."""

    kind: str
    draws: int
    off: Floats
    speeds: list[float]
    unread: int
    seconds: float

    def cells(self) -> Iterator[tuple[str, Floats]]:
        """All orders, then each."""
        yield "all", self.off[:, 1]
        for order in np.unique(self.off[:, 0]):
            yield f"{order:g}", self.off[self.off[:, 0] == order, 1]


def run(number: int, draws: int, seed: int) -> Row:
    """Draw and read runs of one kind."""
    kind, begun, unread = KINDS[number], time.process_time(), 0
    every: list[Floats] = [np.empty((0, 2))]
    speeds: list[float] = []
    for draw in range(draws):
        random = np.random.default_rng([seed, number, draw])
        one = drawn(random, kind=kind)
        try:
            found = read(one, kind, random)
        except InputError as error:
            print(f"{kind}, draw {draw}: {error}", flush=True)
            unread += 1
            continue
        rows = judged(one, found)
        unread += rows.size == 0
        every.append(rows)
        if found.slices is None:
            continue
        true = 2.0 * np.pi * np.interp(found.slices.time, one.time, one.speed)
        off = np.abs(found.slices.speed - true) / np.maximum(true, 1e-3)
        speeds.append(float(np.max(off)))
        worst = float(np.max(np.abs(rows[:, 1]), initial=0.0))
        if worst > 3.0:
            print(f"{kind}, draw {draw}: worst {worst:.2f} half widths", flush=True)
    return Row(
        kind=kind,
        draws=draws,
        off=np.concatenate(every),
        speeds=speeds,
        unread=unread,
        seconds=time.process_time() - begun,
    )


def told(row: Row) -> list[str]:
    """Rows of the page's table of one kind."""
    lines = []
    for order, off in row.cells():
        if off.size == 0:
            lines.append(f"| {row.kind} | {order} | 0 | – | – | – |")
            continue
        size = np.abs(off)
        ratio = 1.0 / max(float(np.sqrt(np.mean(off**2))), 1e-9)
        lines.append(
            f"| {row.kind} | {order} | {off.size} | {100.0 * np.mean(size <= 1.0):.2f} "
            f"| {size.max():.2f} | {ratio:.2f} |"
        )
    return lines


def runs_told(row: Row) -> str:
    """The row of the page's table of runs."""
    speed = f"{100.0 * max(row.speeds, default=float('nan')):.2g}"
    return f"| {row.kind} | {row.draws} | {row.unread} | {speed} |"


HEAD = f"""# Orders of runs whose speed changes: do the stated intervals hold?

Made by `make trial NAME=turning`. Each draw is a run of 20 s at 12 800 samples/s of a shaft of 25
teeth
between 8..14 and 38..50 turns/s, with an unbalance (order 1), mesh lines (25, 50, 75), sidebands
(24, 26) and noise of rms 0.05. Mesh lines and sidebands pass a resonance at 500..900 Hz with 2 to
5 % damping, so the truth is known at every speed. A tacho has one pulse a turn, of which 10 % are
lost and 2 % added; a speed channel reads 0.4 % too high, that in volts is rounded to 12 bits too;
a free coast-down falls exponentially; a stop is at rest for a tenth of the time; a second stage has
mesh lines at orders {SECOND:g} and {2 * SECOND:g}.

The table says how often the 95 % interval of an order's amplitude at one place of the run holds the
truth, the worst error in half widths, and the half width over the standard deviation of the
error (1.96 for an interval that is exact; more: the interval is wider than it need be).
"""


def page(rows: list[Row], draws: int, seed: int) -> str:
    """The page."""
    lines = [
        HEAD,
        "| run | order | amplitudes | inside [%] | worst [half widths] | half width/sd |",
        "|---|---:|---:|---:|---:|---:|",
        *(line for row in rows for line in told(row)),
        "",
        "| run | draws | not read in angle | speed off, at most [%] |",
        "|---|---:|---:|---:|",
        *(runs_told(row) for row in rows),
        "",
        f"{draws} draws of each, seed {seed}. Processor time "
        f"{sum(row.seconds for row in rows) / 60:.0f} min.",
        "",
    ]
    return "\n".join(lines)


def main(draws: int, seed: int, write: bool) -> None:
    """Draw, read, print; write the page."""
    rows = []
    for number in range(len(KINDS)):
        rows.append(run(number, draws, seed))
        print("\n".join([*told(rows[-1]), runs_told(rows[-1])]), flush=True)
    if write:
        PAGE.write_text(page(rows, draws, seed), encoding="utf-8")


if __name__ == "__main__":
    given = [int(one) for one in sys.argv[1:]]
    count, start = (given + [DRAWS, SEED][len(given) :])[:2]
    main(count, start, write=not given)
