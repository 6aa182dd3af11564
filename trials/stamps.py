"""Sampling rates from rounded and jittering time stamps, on trial: do their intervals hold?

    python trials/stamps.py             2 000 time columns, 120 records; trials/records/stamps.md
    python trials/stamps.py 100 6       100 columns, 6 records, printed
    python trials/stamps.py 100 6 2027  of another seed, printed

Columns are read as those of files are; records hold a sine in noise beside such a column.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure
from thermogear.measured.traps import TimeBase, read_time

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 2026
COLUMNS, RECORDS = 2000, 120
MOST = 60_000  # stamps of a column
PAGE = Path(__file__).parents[1] / "trials" / "records" / "stamps.md"
RATES = (1000.0, 2048.0, 4096.0, 5000.0, 12_800.0, 25_600.0, 44_100.0)
DECIMALS = (2, 3, 4, 5, 6)


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A time column [s], what it is of, and samples' true places (in steps)."""

    rate: float
    usual: bool
    decimals: int
    jitter: float
    lost: int
    first_lost: int
    place: Floats
    stamps: Floats


def drawn(random: Random, most: int = MOST, lost: bool = False) -> Drawn:
    """A rate of RATES or any of 500..50 000, 2..6 decimals, 0.5..20 s, jitter up to 0.2 step."""
    kind = int(random.integers(len(RATES) + 1))
    usual = kind < len(RATES)
    rate = RATES[kind] if usual else float(np.exp(random.uniform(np.log(500.0), np.log(5e4))))
    decimals = int(random.choice(DECIMALS))
    jitter = float(random.uniform(0.0, 0.2)) if random.random() < 0.6 else 0.0
    seconds = float(np.exp(random.uniform(np.log(0.5), np.log(20.0))))
    count = min(int(seconds * rate), most)
    block = int(random.integers(1, 600)) if lost else 0
    at = int(random.integers(count // 10, 9 * count // 10))
    steps = np.arange(count, dtype=float)
    steps[at:] += block
    place = steps + random.uniform(-jitter, jitter, count)
    exact = place / rate + random.uniform(0.0, 1.0)
    rounded = np.round(exact, decimals)
    if random.random() < 0.3:  # a clock that is cut
        rounded = np.floor(exact * 10.0**decimals) / 10.0**decimals
    return Drawn(
        rate=rate,
        usual=usual,
        decimals=decimals,
        jitter=jitter,
        lost=block,
        first_lost=at,
        place=place,
        stamps=rounded,
    )


def off(one: Drawn, found: TimeBase) -> float:
    """Error of the rate in half widths; a rate taken as exact is right or infinitely off."""
    if found.rate is None:
        return float("nan")
    error = abs(found.rate - one.rate)
    if found.half_width == 0.0:
        return 0.0 if error <= 1e-9 * one.rate else float("inf")
    return error / found.half_width


def line_off(one: Drawn, random: Random, *, even: bool) -> tuple[float, float]:
    """A sine in such a record through ``measure``: errors of frequency and amplitude in half
    widths. ``even``: only the stamps jitter, not the samples."""
    base = read_time("t", "s", one.stamps)
    frequency = one.rate * random.uniform(0.03, 0.3)
    place = np.arange(one.place.size) if even else one.place
    values = np.cos(2.0 * np.pi * frequency / one.rate * place + random.uniform(0.0, 6.0))
    values += random.normal(0.0, 0.05, values.size)
    record = Record((Channel("a", values, "g"),), "drawn", base.rate, base.origin)
    record = replace(record, rate_half_width=base.half_width, jitter=base.jitter)
    found = measure(record)
    line = min(found.lines, key=lambda each: abs(each.frequency - frequency))
    wrong = abs(line.frequency - frequency) / line.frequency_half_width
    return wrong, abs(line.reading - 1.0) / (line.half_width * line.reading)


def told(name: str, errors: Floats) -> str:
    """A row of the page's table of rates; those without a rate are counted apart."""
    known = errors[np.isfinite(errors) | np.isinf(errors)]
    if known.size == 0:
        return f"| {name} | {errors.size} | {errors.size} | – | – |"
    share = 100.0 * float(np.mean(known <= 1.0))
    refused = errors.size - known.size
    return f"| {name} | {errors.size} | {refused} | {share:.2f} | {known.max():.2f} |"


def rates(count: int, seed: int) -> Iterator[str]:
    """Rows: whole columns by what they are, then columns with a block lost."""
    random = np.random.default_rng([seed, 1])
    whole = [drawn(random) for _ in range(count)]
    bases = [read_time("t", "s", one.stamps) for one in whole]
    errors = np.array([off(one, base) for one, base in zip(whole, bases, strict=True)])
    finite = np.array([10.0**-one.decimals * one.rate for one in whole])
    jitters = np.array([one.jitter > 0.0 for one in whole])
    usual = np.array([one.usual for one in whole])
    exact = np.array([base.rate is not None and base.half_width == 0.0 for base in bases])
    yield told("all", errors)
    yield told("even clock", errors[~jitters])
    yield told("jitter up to 0.2 step", errors[jitters])
    yield told("stamps finer than a step", errors[finite < 1.0])
    yield told("stamps that repeat", errors[finite >= 1.0])
    yield told("usual rate, taken as exact", errors[usual & exact])
    yield told("usual rate, with a half width", errors[usual & ~exact])
    yield told("any rate, taken for a usual one", errors[~usual & exact])
    yield told("any rate, with a half width", errors[~usual & ~exact])


def blocks(count: int, seed: int) -> Iterator[str]:
    """Rows: columns with a block of 1..599 samples lost, by how many samples a stamp stands for."""
    random = np.random.default_rng([seed, 2])
    table: dict[str, list[int]] = {}
    for _ in range(count):
        one = drawn(random, lost=True)
        base = read_time("t", "s", one.stamps)
        ratio = 10.0**-one.decimals * one.rate
        size = "one" if ratio < 1.0 else "more" if ratio < one.lost else "more than are lost"
        row = table.setdefault(size, [0, 0, 0, 0, 0])
        row[0] += 1
        if base.rate is None:
            row[1] += 1
        elif sum(more for _, more in base.gaps) == one.lost:
            row[2] += 1
        else:
            row[3 if base.gaps else 4] += 1
    for name, row in sorted(table.items()):
        yield f"| {name} | " + " | ".join(str(n) for n in row) + " |"


def lines(count: int, seed: int) -> Iterator[str]:
    """Rows: a sine's frequency and amplitude through ``measure``."""
    random = np.random.default_rng([seed, 3])
    for even in (True, False):
        errors = []
        while len(errors) < count:
            one = drawn(random, most=30_000)
            if read_time("t", "s", one.stamps).rate is not None:
                errors.append(line_off(one, random, even=even))
        table = np.array(errors)
        for name, own in (("frequency", table[:, 0]), ("amplitude", table[:, 1])):
            where = "samples even" if even else "samples taken when the stamps say"
            share = 100.0 * float(np.mean(own <= 1.0))
            yield f"| {name}, {where} | {count} | {share:.1f} | {own.max():.2f} |"


HEAD = """# Sampling rates from rounded and jittering time stamps: do their intervals hold?

Made by `make trial NAME=stamps`. Each draw is a time column: the rate 1 000, 2 048, 4 096, 5 000,
12 800, 25 600 or 44 100 samples/s, or any of 500 to 50 000; stamps of 2 to 6 decimals, rounded or
(30 %) cut; 0.5 to 20 s, at most 60 000 stamps; in 60 % jitter, even within up to 0.2 step to both
sides. An error is told in half widths of the 95 % interval; a usual rate that is taken as exact
and is wrong counts as infinite.
"""


def page(count: int, records: int, seed: int) -> str:
    """The page."""
    begun = time.process_time()
    parts = [
        HEAD,
        "| columns | draws | no rate | inside [%] | worst [half widths] |",
        "|---|---:|---:|---:|---:|",
        *rates(count, seed),
        "",
        "Columns with one block of 1 to 599 samples lost, by the samples that a stamp stands for:",
        "",
        "| samples to a stamp | draws | no rate | found, length right | length wrong | missed |",
        "|---|---:|---:|---:|---:|---:|",
        *blocks(count // 4, seed),
        "",
        "A sine at 0.03 to 0.3 of the rate, noise of rms 0.05, through `measure`, at most 30 000",
        "samples:",
        "",
        "| what | records | inside [%] | worst [half widths] |",
        "|---|---:|---:|---:|",
        *lines(records // 2, seed),
        "",
        "Where a stamp stands for many samples nothing tells whether the samples jitter: then an",
        "amplitude may be lower than its half width says.",
        "",
    ]
    spent = (time.process_time() - begun) / 60.0
    return "\n".join([*parts, f"Seed {seed}. Processor time {spent:.1f} min.", ""])


def main(count: int, records: int, seed: int, write: bool) -> None:
    """Draw, read, print; write the page."""
    text = page(count, records, seed)
    print(text)
    if write:
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    given = [int(one) for one in sys.argv[1:]]
    columns, measured, start = (given + [COLUMNS, RECORDS, SEED][len(given) :])[:3]
    main(columns, measured, start, write=not given)
