"""What damage of a record does to its lines, and what ``measure`` makes of it.

``make trial NAME=defects`` draws records of a known gear train, damages each in one way, and
tells the
error of the mesh line's amplitude without the gate and with it, or that it is withheld, beside
the stated interval. It also counts undamaged records of which anything is withheld: drawn ones and,
where they are at hand, real ones. It writes trials/records/defects.md; ``python trials/defects.py
3`` prints a table of three records for each defect.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.signals.filters import without_trend
from thermogear.signals.lines import line_in, line_spectrum

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 41_2026
RECORDS = 12
UNDAMAGED = 50
"""Undamaged records of each kind."""
PAGE = Path(__file__).parents[1] / "trials" / "records" / "defects.md"
REAL = Path(__file__).parents[2] / "shared" / "data"
RATE, TEETH, COUNT = 2560.0, 25, 10240


@dataclass(frozen=True, kw_only=True)
class Made:
    """One channel and its truth."""

    values: Floats
    mesh: float
    bits: int


def made(random: Random) -> Made:
    """A gear train's channel [m/s^2]: two harmonics, sidebands, noise, converted to some bits."""
    mesh = float(random.uniform(300.0, 450.0))
    cycles = mesh * np.arange(COUNT) / RATE
    x = float(random.uniform(0.05, 0.6)) * random.normal(size=COUNT)
    for rank, height in ((1, 1.0), (2, float(random.uniform(0.2, 0.7)))):
        swing = np.ones(COUNT)
        for n in (1, 2):
            depth = float(random.uniform(0.02, 0.25)) / n
            swing += depth * np.cos(2 * np.pi * n * cycles / TEETH + random.uniform(0, 6.3))
        x += height * swing * np.cos(2 * np.pi * rank * cycles + random.uniform(0, 6.3))
    bits = int(random.choice([12, 16, 24]))
    step = 16.0 * 2.0**-bits
    return Made(values=np.round((x + float(random.normal())) / step) * step, mesh=mesh, bits=bits)


def _clipped(x: Floats, share: float) -> Floats:
    middle = float(np.mean(x))
    limit = float(np.quantile(np.abs(x - middle), 1.0 - share))
    return np.clip(x, middle - limit, middle + limit)


def _block(x: Floats, random: Random, share: float, value: float | None) -> Floats:
    size = int(share * x.size)
    first = int(random.integers(size, x.size - 2 * size))
    y = x.copy()
    y[first : first + size] = x[first] if value is None else value
    return y


def _scattered(x: Floats, random: Random, count: int, value: Callable[[int], Floats]) -> Floats:
    y = x.copy()
    y[random.choice(x.size, count, replace=False)] = value(count)
    return y


DEFECTS: dict[str, Callable[[Floats, Random], Floats]] = {
    "clipping of 1 % of the samples": lambda x, r: _clipped(x, 0.01),
    "clipping of 4 %": lambda x, r: _clipped(x, 0.04),
    "clipping of 20 %": lambda x, r: _clipped(x, 0.20),
    "held for 3 % of the record": lambda x, r: _block(x, r, 0.03, None),
    "held for 15 % of the record": lambda x, r: _block(x, r, 0.15, None),
    "zeros for 3 %": lambda x, r: _block(x, r, 0.03, 0.0),
    "zeros for 30 %": lambda x, r: _block(x, r, 0.30, 0.0),
    "12 spikes of 20 amplitudes": lambda x, r: _scattered(
        x, r, 12, lambda n: 20.0 * r.choice([-1.0, 1.0], n)
    ),
    "40 times -9999": lambda x, r: _scattered(x, r, 40, lambda n: np.full(n, -9999.0)),
    "1 % NaN, one by one": lambda x, r: _scattered(x, r, 102, lambda n: np.full(n, np.nan)),
    "NaN for 4 %": lambda x, r: _block(x, r, 0.04, float("nan")),
    "NaN for 20 %": lambda x, r: _block(x, r, 0.20, float("nan")),
    "a mean of 200 amplitudes": lambda x, r: x + 200.0,
    "a trend of 200 amplitudes": lambda x, r: x + 200.0 * np.arange(x.size) / x.size,
}


def before(x: Floats, mesh: float) -> float:
    """Relative error of the flat-top line of the samples as they stand, NaN: longest piece."""
    bad = np.flatnonzero(~np.isfinite(x))
    if bad.size:
        edges = np.concatenate([[-1], bad, [x.size]])
        place = int(np.argmax(np.diff(edges)))
        x = x[edges[place] + 1 : edges[place + 1]]
    if x.size < 256:
        return float("nan")
    width = 3.0 * RATE / x.size
    return (
        line_in(line_spectrum(without_trend(x), RATE), near=mesh, half_width=width).amplitude - 1.0
    )


def measured(x: Floats, mesh: float) -> Measurement:
    """The channel through ``measure``."""
    return measured_record(Record((Channel("a", x, "m/s^2"),), "drawn", RATE, "made"), mesh)


def measured_record(record: Record, mesh: float) -> Measurement:
    """The record through ``measure``, told its teeth and speed."""
    speed = 2.0 * np.pi * mesh / TEETH
    return measure(record, teeth=TEETH, speed=speed, sidebands=0, harmonics=2)


def _file(time: Floats, x: Floats, rate: float | None = None) -> Record:
    """A record read from a file with a column of time stamps."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.csv"
        table = np.column_stack([time, x])
        np.savetxt(path, table, "%.9g", ",", header="time (s),a (m/s^2)", comments="")
        return read_record(path, rate=rate)


def _stamped(x: Floats, random: Random) -> Record:
    kept = np.arange(x.size)
    first = int(random.integers(x.size // 4, x.size // 2))
    kept = np.delete(kept, np.arange(first, first + int(random.integers(30, 1000))))
    return _file(kept / RATE, x[kept])


def _two(x: Floats, other: Floats, rate: float = RATE) -> Record:
    channels = Channel("a", x, "m/s^2"), Channel("b", other, "m/s^2")
    return Record(channels, "drawn", rate, "made")


FAULTS: dict[str, tuple[str, Callable[[Floats, Random], Record]]] = {
    "a block lost, time stamps jump": ("dropped there", _stamped),
    "an empty channel": ("no signal", lambda x, r: _two(x, np.zeros(x.size))),
    "a rate ten times that of the time stamps": (
        "is not the file's",
        lambda x, r: _file(np.arange(x.size) / RATE, x, 10.0 * RATE),
    ),
    "25 samples/s, a shaft's rate": (
        "samples/s",
        lambda x, r: _two(x, r.normal(size=x.size), 25.0),
    ),
}
"""Faults around the samples: words that tell of each, and how it is made."""


def _impacts(one: Made, random: Random) -> Floats:
    """With impacts of a bearing, 3.57 a turn, 1 % slip, that ring at 900 Hz up to 10 amplitudes."""
    turns = RATE * TEETH / one.mesh
    gaps = turns / 3.57 * (1.0 + 0.01 * random.normal(size=int(4 * COUNT / turns)))
    struck = np.zeros(COUNT)
    places = np.cumsum(gaps).astype(int)
    struck[places[places < COUNT]] = 1.0
    n = np.arange(200)
    ring = np.exp(-n / 25.0) * np.sin(2.0 * np.pi * 900.0 / RATE * n)
    return one.values + float(random.uniform(1.0, 10.0)) * np.convolve(struck, ring)[:COUNT]


def _run_up(random: Random) -> Floats:
    """A run-up of the same train from half the speed on, over the record."""
    top = float(random.uniform(300.0, 450.0))
    speed = np.linspace(0.5 * top, top, COUNT)
    cycles = np.cumsum(speed) / RATE
    x = float(random.uniform(0.05, 0.3)) * random.normal(size=COUNT)
    for rank, height in ((1, 1.0), (2, 0.4)):
        x += height * np.cos(2 * np.pi * rank * cycles + random.uniform(0, 6.3))
    return np.asarray(x + 0.2 * np.cos(2 * np.pi * cycles / TEETH))


def _counts(one: Made) -> Floats:
    """Whole numbers of a converter of 12 bits, driven to a third of its range."""
    return np.rint(one.values / float(np.max(np.abs(one.values))) * 2047.0 / 3.0)


UNHURT: dict[str, Callable[[Made, Random], Floats]] = {
    "as above": lambda one, r: one.values,
    "run-up to twice the speed": lambda one, r: _run_up(r),
    "strong impacts of a bearing": _impacts,
    "whole numbers of 12 bits": lambda one, r: _counts(one),
}
"""Undamaged records that might be taken for damaged ones."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One record: error before and now (NaN: withheld), stated half width, whether it was seen."""

    before: float
    now: float
    half_width: float
    frequency_held: bool
    seen: bool


def run(name: str, number: int) -> Row:
    """One record with one defect."""
    random = np.random.default_rng([SEED, list(DEFECTS).index(name), number])
    one = made(random)
    x = DEFECTS[name](one.values, random)
    mesh = one.mesh
    first = before(x, mesh)
    try:
        found = measured(x, mesh)
    except InputError:
        return _refused(first)
    return _row(found, mesh, first, seen=bool(found.findings))


def fault(name: str, number: int) -> Row:
    """One record with one fault around its samples."""
    words, make = FAULTS[name]
    random = np.random.default_rng([SEED, 2000 + list(FAULTS).index(name), number])
    one = made(random)
    try:
        found = measured_record(make(one.values, random), one.mesh)
    except InputError as error:
        return replace(_refused(float("nan")), seen=words in str(error))
    said = any(words in notice.text for notice in found.notices)
    return _row(found, one.mesh, float("nan"), seen=said)


def _refused(first: float) -> Row:
    nan = float("nan")
    return Row(before=first, now=nan, half_width=nan, frequency_held=True, seen=True)


def _row(found: Measurement, mesh: float, first: float, seen: bool) -> Row:
    line = next(line for line in found.lines if line.name == "mesh x 1")
    # by the share of sidebands and a steady line the amplitude put in is 1
    return Row(
        before=first,
        now=line.reading - 1.0,
        half_width=line.half_width * line.reading,
        frequency_held=not abs(line.frequency - mesh) > line.frequency_half_width,
        seen=seen,
    )


def withheld(found: Measurement) -> bool:
    """Whether any number of a record is."""
    return any(one.level == "important" for one in found.findings)


def undamaged(kind: str, count: int, first: int = 0) -> tuple[int, int, int]:
    """Undamaged records of a kind: how many, with a finding, with anything withheld."""
    seen = held_back = 0
    for number in range(first, first + count):
        random = np.random.default_rng([SEED + 1, 1000 + list(UNHURT).index(kind), number])
        one = made(random)
        x = UNHURT[kind](one, random)
        if kind == "run-up to twice the speed":
            found = measure(Record((Channel("a", x, "m/s^2"),), "drawn", RATE, "made"), teeth=TEETH)
        else:
            found = measured(x, one.mesh)
        seen += bool(found.findings)
        held_back += withheld(found)
    return count, seen, held_back


def real() -> list[tuple[str, list[str]]]:
    """Findings of the real records at hand, each whole and in eighths."""
    told = []
    for path in sorted(REAL.glob("**/*.csv.gz")):
        record = read_record(path)
        size = record.samples // 8
        for part in range(8):
            channels = tuple(
                Channel(c.name, c.values(part * size, stop=(part + 1) * size))
                for c in record.channels
            )
            found = measure(replace(record, channels=channels), sidebands=0)
            told.append((f"{path.name} {part}", [one.text for one in found.findings]))
    return told


def told(count: int, undamaged_count: int) -> list[str]:
    """The page's tables."""
    lines = [
        "| defect | seen | error before, median, worst [%] | withheld "
        "| error now, median, worst [%] | stated half width, median [%] "
        "| interval holds | frequency's holds |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    all_now = all_held = 0
    for name in [*DEFECTS, *FAULTS]:
        rows = [(run if name in DEFECTS else fault)(name, number) for number in range(count)]
        old = 100.0 * np.abs([row.before for row in rows])
        stands = [row for row in rows if np.isfinite(row.now)]
        now = 100.0 * np.abs([row.now for row in stands])
        holds = sum(abs(row.now) <= row.half_width for row in stands)
        all_now, all_held = all_now + len(stands), all_held + holds
        known = old[np.isfinite(old)]
        first = f"{np.median(known):.2g}, {known.max():.2g}" if known.size else "–"
        latter, half = "–", "–"
        if stands:
            latter = f"{np.median(now):.2g}, {now.max():.2g}"
            half = f"{100.0 * np.median([row.half_width for row in stands]):.2g}"
        lines.append(
            f"| {name} | {sum(row.seen for row in rows)} of {count} | {first} | "
            f"{count - len(stands)} | {latter} | {half} | {holds} of {len(stands)} | "
            f"{sum(row.frequency_held for row in rows)} of {count} |"
        )
        print(lines[-1], flush=True)
    parts = real()
    sound = {kind: undamaged(kind, undamaged_count) for kind in UNHURT}
    lines += [
        "",
        f"Of the amplitudes that are not withheld {all_held} of {all_now} intervals hold "
        f"({100 * all_held / max(all_now, 1):.1f} %).",
        "",
        "| undamaged records | drawn | with a finding | with anything withheld |",
        "|---|---:|---:|---:|",
        *(f"| {kind} | {n} | {seen} | {back} |" for kind, (n, seen, back) in sound.items()),
        "",
        (
            f"Of {len(parts)} parts of real records (eighths of {len(parts) // 8} files) "
            f"{sum(bool(texts) for _, texts in parts)} have a finding."
            if parts
            else "Real records were not at hand."
        ),
    ]
    return lines


HEAD = """# Damaged records


Made by `make trial NAME=defects`. Each record is a drawn gear train of 4 s (mesh line of
amplitude 1 at
300 to 450 Hz, sidebands, noise of rms 0.05 to 0.6, a converter of 12, 16 or 24 bits) with one
defect. Before: the flat-top line of the samples as they stand, of NaN the longest piece. Now: what
`measure` states, or that it is withheld; a frequency that is withheld counts as held. The last
four rows are faults around the samples: seen is whether a notice or the refusal tells of it.
"""


def main(count: int, write: bool) -> None:
    """Run every defect and print or write the page."""
    lines = told(count, UNDAMAGED if write else 3 * count)
    page = "\n".join([HEAD, *lines, "", f"{count} records a defect, seed {SEED}.", ""])
    if write:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else RECORDS, len(sys.argv) < 2)
