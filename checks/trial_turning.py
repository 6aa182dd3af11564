"""Runs whose speed changes, on trial: are order amplitudes within their stated intervals?

    python checks/trial_turning.py        20 draws of each kind, printed
    python checks/trial_turning.py 3      3 draws of each

Each draw is a run-up or a coast-down of a shaft with 25 teeth, an unbalance, three mesh harmonics
and two sidebands, in noise. Amplitude and phase of mesh and sidebands follow one resonance, so that
the truth is known at every speed. The records are read with a tacho of which 10 % of the
pulses are lost and 2 % added, without a tacho, and with a speed channel that reads 0.4 % too high.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure

Floats = NDArray[np.float64]

SEED = 2026
RATE = 12_800.0
TEETH = 25
KINDS = ("tacho, 10 % lost", "no tacho", "speed channel")


@dataclass(frozen=True)
class Run:
    """A drawn run: ``turns`` and ``speed`` [turns/s] at every sample, amplitudes by order."""

    time: Floats
    values: Floats
    turns: Floats
    speed: Floats
    truth: dict[int, Floats]
    natural: float
    damping: float
    down: bool


def drawn(random: np.random.Generator, seconds: float = 20.0, noise: float = 0.05) -> Run:
    """One run between 8..14 and 38..50 turns/s past a resonance at 500..900 Hz."""
    low, high = random.uniform(8.0, 14.0), random.uniform(38.0, 50.0)
    down = bool(random.random() < 0.5)
    first, last = (high, low) if down else (low, high)
    t = np.arange(int(seconds * RATE)) / RATE
    speed = first + (last - first) * t / seconds
    speed += 0.1 * np.sin(0.8 * np.pi * t + random.uniform(0.0, 6.0))
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) / RATE
    turns += random.uniform(0.0, 1.0)
    natural, damping = random.uniform(500.0, 900.0), random.uniform(0.02, 0.05)
    x = random.normal(0.0, noise, t.size)
    truth = {}
    for order, size in ((1, 0.2), (24, 0.15), (25, 1.0), (26, 0.2), (50, 0.5), (75, 0.25)):
        ratio = order * speed / natural
        answer = np.ones(t.size, complex)
        if order > 1:
            answer = 1.0 / (1.0 - ratio**2 + 2j * damping * ratio)
        angle = 2.0 * np.pi * order * turns + random.uniform(0.0, 6.0)
        x += size * np.real(answer * np.exp(1j * angle))
        truth[order] = size * np.abs(answer)
    return Run(t, x, turns, speed, truth, natural, damping, down)


def pulses(run: Run, random: np.random.Generator) -> Floats:
    """A tacho, one pulse a turn: 10 % lost, 2 % added anywhere, noise on its level."""
    whole = np.arange(np.ceil(run.turns[0]), run.turns[-1])
    at = np.interp(whole, run.turns, run.time)
    at = at[random.random(at.size) > 0.10]
    at = np.append(at, random.uniform(0.0, run.time[-1], int(0.02 * whole.size)))
    found = random.normal(0.0, 0.05, run.time.size)
    for one in at:
        place = int(np.ceil(one * RATE))
        found[place : place + 20] += 5.0
    return found


def read(run: Run, kind: str, random: np.random.Generator) -> Measurement:
    """The run read as a record of one kind."""
    a = Channel("a", run.values, "g")
    if kind == KINDS[0]:
        record = Record(
            (a, Channel("tacho", pulses(run, random), "V")), "made", RATE, "made", tacho="tacho"
        )
        return measure(record, teeth=TEETH, pulses_per_turn=1.0, orders=[1.0])
    if kind == KINDS[1]:
        return measure(Record((a,), "made", RATE, "made"), teeth=TEETH, orders=[1.0])
    rpm = 60.0 * run.speed * 1.004 + random.normal(0.0, 5.0, run.time.size)
    record = Record((a, Channel("n", rpm, "rpm")), "made", RATE, "made")
    return measure(record, teeth=TEETH, orders=[1.0])


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
        rows += [(float(known), float(one)) for one in off[np.isfinite(off)]]
    return np.asarray(rows).reshape(-1, 2)


def main(draws: int) -> None:
    """Draw, read, print a row for each kind."""
    for number, kind in enumerate(KINDS):
        begun, unread, speeds, natural = time.process_time(), 0, [], []
        every: list[Floats] = []
        for draw in range(draws):
            random = np.random.default_rng([SEED, number, draw])
            run = drawn(random)
            found = read(run, kind, random)
            rows = judged(run, found)
            unread += rows.size == 0
            every.append(rows)
            if found.slices is not None:
                true = 2.0 * np.pi * np.interp(found.slices.time, run.time, run.speed)
                speeds.append(float(np.max(np.abs(found.slices.speed / true - 1.0))))
                near = [r for r in found.slices.resonances if r.kind == "resonance"]
                best = min(near, key=lambda r: abs(r.frequency - run.natural), default=None)
                if best is not None:
                    natural.append((best.frequency - run.natural) / best.half_width)
        table = np.concatenate(every)
        off = np.abs(table[:, 1])
        print(f"{kind}: {draws} runs, {unread} not read in angle, {off.size} amplitudes")
        print(f"  inside {100 * np.mean(off <= 1):.2f} %, worst {off.max():.2f} half widths")
        for order in np.unique(table[:, 0]):
            own = off[table[:, 0] == order]
            print(f"    order {order:g}: {100 * np.mean(own <= 1):.2f} %, worst {own.max():.2f}")
        print(f"  speed off by at most {max(speeds, default=np.nan):.2g} (relative)")
        inside = np.mean(np.abs(natural) <= 1.0) if natural else np.nan
        print(f"  resonance found in {len(natural)} runs, {100 * inside:.0f} % inside its interval")
        print(f"  {(time.process_time() - begun) / draws:.1f} processor seconds a run", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
