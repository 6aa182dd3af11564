"""Sixty drawn records of gear trains through ``measure``: what is named, and what is named wrongly.

    python trials/drawn.py            printed
    python trials/drawn.py --write    trials/records/drawn.md anew

The generator shares no code with the package. Every record is read three times: without any fact,
with the nominal speed of the first shaft alone, and with its teeth too (where the header's rate is
wrong, that is what the facts must tell). A tooth number is asserted where ``teeth`` is not None.
"""

from __future__ import annotations

import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

sys.path.insert(0, str(Path(__file__).parents[1] / "src"))

from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure

PAGE = Path(__file__).parents[1] / "trials" / "records" / "drawn.md"
SEED = 20261128
RATE, SECONDS = 10_240.0, 10.0
KINDS = {
    "one stage": 10, "two stages": 10, "hunting ratio": 6, "planetary": 6, "wandering speed": 8,
    "run-up, 1 pulse": 3, "run-up, 20 pulses": 3, "run-up, 60 pulses": 3, "gap": 3, "clipping": 3,
    "wrong header rate": 5,
}  # fmt: skip


@dataclass
class Drawn:
    """A record with its truth: ``teeth`` of the gear on the first shaft, ``shaft`` [turns/s],
    ``mesh`` amplitudes by rank, ``mean`` mesh frequency [Hz] over the record."""

    kind: str
    record: Record
    teeth: int
    shaft: float
    mean: float
    mesh: dict[int, float]
    pulses: float | None = None
    wrong: float = 1.0
    lines: list[tuple[float, float, bool]] = field(default_factory=list)


def train(
    random: np.random.Generator, turns: NDArray[np.float64], stages: list[tuple[int, int]]
) -> tuple[NDArray[np.float64], dict[int, float]]:
    """Signal of a train and the amplitudes of the first mesh's harmonics."""
    x = np.zeros(turns.size)
    first: dict[int, float] = {}
    shaft = turns
    for number, (pinion, wheel) in enumerate(stages):
        slow = shaft * pinion / wheel
        swell = np.ones(turns.size)
        for angle in (shaft, slow):
            for n in (1, 2, 3):
                a = random.uniform(0.05, 0.25) / n
                swell = swell + a * np.cos(2 * np.pi * n * angle + random.uniform(0, 6.28))
        top = random.uniform(0.4, 1.0) if number else 1.0
        for rank in (1, 2, 3):
            a = top * random.uniform(0.5, 1.2) / rank
            wave = np.cos(2 * np.pi * rank * pinion * shaft + random.uniform(0, 6.28))
            x += a * swell * wave
            if not number:
                first[rank] = a
        x += random.uniform(0.02, 0.4) * np.cos(2 * np.pi * shaft + random.uniform(0, 6.28))
        shaft = slow
    return x, first


def planets(
    random: np.random.Generator, carrier: NDArray[np.float64]
) -> tuple[NDArray[np.float64], int]:
    """A planetary set heard at its ring: the planets pass, so that the mesh swells with them."""
    count = int(random.integers(3, 6))
    ring = int(random.integers(20, 35)) * count
    x = np.zeros(carrier.size)
    for planet in range(count):
        passing = np.maximum(np.cos(2 * np.pi * (carrier - planet / count)), 0.0)
        for rank in (1, 2, 3):
            x += passing / rank * np.cos(2 * np.pi * rank * ring * (carrier - planet / count))
    return x, ring // count


def drawn(random: np.random.Generator, kind: str) -> Drawn:
    """One record of a kind."""
    t = np.arange(int(RATE * SECONDS)) / RATE
    shaft = random.uniform(18.0, 32.0)
    speed = np.full(t.size, shaft)
    if kind == "wandering speed":
        pole = np.exp(-1.0 / (RATE * random.uniform(0.5, 3.0)))
        steps = np.sqrt(1.0 - pole**2) * random.normal(size=t.size)
        walk = lfilter([1.0], [1.0, -pole], steps)
        speed = shaft * (1.0 + random.choice([0.0005, 0.001, 0.003]) * walk)
    if kind.startswith("run-up"):
        speed = shaft * np.linspace(0.5, 1.2, t.size)
    turns = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1])) / RATE])
    teeth = int(random.integers(17, 45))
    stages = [(teeth, int(random.integers(45, 95)))]
    if kind == "two stages":
        stages.append((int(random.integers(17, 45)), int(random.integers(45, 95))))
    if kind == "hunting ratio":
        stages = [(teeth, next(z for z in range(2 * teeth + 1, 200) if np.gcd(z, teeth) == 1))]
    if kind == "planetary":
        x, teeth = planets(random, 0.2 * turns)
        first: dict[int, float] = {}
        shaft, speed = 0.2 * shaft, 0.2 * speed
    else:
        x, first = train(random, turns, stages)
    x = x + random.uniform(0.05, 0.3) * random.normal(size=t.size)
    if kind == "gap":
        place = int(random.integers(t.size // 10, t.size // 2))
        x[place : place + int(random.integers(100, 3000))] = np.nan
    if kind == "clipping":
        x = np.clip(x, -0.85 * np.abs(x).max(), 0.85 * np.abs(x).max())
    channels = [Channel("a", x, "g")]
    pulses = None
    if kind.startswith("run-up"):
        pulses = float(kind.split()[1])
        channels.append(Channel("tacho", 5.0 * ((turns * pulses) % 1.0 < 0.4), "V"))
    wrong = float(random.choice([2.0, 0.5])) if kind == "wrong header rate" else 1.0
    made = Record(tuple(channels), kind, RATE * wrong, "made", tacho="tacho" if pulses else None)
    mean = teeth * float(turns[-1] - turns[0]) / (t[-1] - t[0])
    return Drawn(kind, made, teeth, shaft, mean, first, pulses, wrong)


def read(one: Drawn, facts: str, slip: float) -> Measurement | None:
    """The record with the facts: "none", "speed", or "speed, teeth"."""
    more: dict[str, float] = {} if one.pulses is None else {"pulses_per_turn": one.pulses}
    if "speed" in facts:
        more["speed"] = 2.0 * np.pi * one.shaft * slip
    if "teeth" in facts:
        more["teeth"] = one.teeth
    try:
        return measure(one.record, **more)  # type: ignore[arg-type]
    except InputError as error:
        print(f"{one.kind}, {facts}: {error}", file=sys.stderr)
        return None


def count_lines(one: Drawn, found: Measurement, held: Counter[str], why: str) -> None:
    """Which intervals hold what was put in: amplitudes and frequency of the first mesh."""
    if found.slices is not None or found.teeth is None:
        return
    for line in found.readings:
        rank = int(line.name[7:]) if line.kind == "mesh" else 0
        if rank not in one.mesh:
            continue
        held[f"{why} amplitude"] += abs(line.reading - one.mesh[rank]) <= (
            line.half_width * line.reading
        )
        held[f"{why} amplitudes"] += 1
        if rank == 1 and np.isfinite(line.frequency):
            held[f"{why} frequency"] += abs(line.frequency - one.mean) <= line.frequency_half_width
            held[f"{why} frequencies"] += 1


def page() -> str:
    """The table."""
    random = np.random.default_rng(SEED)
    named: dict[tuple[str, str], Counter[str]] = {}
    held: Counter[str] = Counter()
    for kind, number in KINDS.items():
        for _ in range(number):
            one = drawn(random, kind)
            slip = float(random.uniform(0.985, 1.015))
            for facts in ("none", "speed", "speed, teeth"):
                tally = named.setdefault((kind, facts), Counter())
                found = read(one, facts, slip)
                if found is None:
                    tally["refused"] += 1
                    continue
                told = {n.code for n in found.notices if n.level == "important"}
                tally["contradiction told"] += bool(
                    told & {"shaft_by_lines", "speed_contradicts_rate", "mesh_line_does_not_fit"}
                ) or "mesh_line_does_not_fit" in {n.code for n in found.notices}
                if found.teeth is None:
                    tally["undecided"] += 1
                elif found.teeth == one.teeth and one.wrong == 1.0 and kind != "planetary":
                    tally["right"] += 1
                elif "teeth" in facts and found.gearing is not None and found.gearing.confirmed:
                    tally["right"] += 1  # the teeth that were given, by their sidebands
                else:
                    tally["false"] += 1
                    print(f"{kind}, {facts}: {found.teeth} for {one.teeth}", file=sys.stderr)
                if one.wrong == 1.0:
                    count_lines(one, found, held, "all")
    columns = ("right", "undecided", "false", "refused", "contradiction told")
    lines = ["# Drawn records of gear trains", "",
             "Made by `python trials/drawn.py --write`: sixty records of a generator that",
             f"shares no code with the package (seed {SEED}), {SECONDS:g} s at {RATE:g} samples/s;",
             "the speed that is told is within 1.5 % of the true one. A planetary set's teeth, its",
             "ring over its planets, are to stay undecided without teeth told.", "",
             f"| records | facts told | {' | '.join(columns)} |",
             "|---|---|" + "---:|" * len(columns)]  # fmt: skip
    for (kind, facts), tally in named.items():
        cells = " | ".join(str(tally[name]) for name in columns)
        lines.append(f"| {kind} | {facts} | {cells} |")
    for facts in ("none", "speed", "speed, teeth"):
        sums = Counter[str]()
        for (_, own), tally in named.items():
            sums += tally if own == facts else Counter()
        cells = " | ".join(f"**{sums[name]}**" for name in columns)
        lines.append(f"| **all** | {facts} | {cells} |")
    share = [held["all amplitude"], held["all amplitudes"], held["all frequency"],
             held["all frequencies"]]  # fmt: skip
    lines += ["", "Intervals of 95 % that hold what was put in: amplitudes "
              f"{share[0]} of {share[1]}, frequencies {share[2]} of {share[3]}.", ""]  # fmt: skip
    return "\n".join(lines)


def main(words: list[str]) -> int:
    text = page()
    if words == ["--write"]:
        PAGE.write_text(text, "utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
