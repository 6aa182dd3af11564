"""Traps of real files, recognised and named: zeros, gaps, doubled variables, broken time."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import RATE
from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.units import factor_of, kind_of, unit

Floats = NDArray[np.float64]

_TIME = re.compile(r"^(x[_ ]?value|time|zeit|temps|tijd|时间|t)(?:[ _]?(?:stamp|axis))?$", re.I)
_TACHO = re.compile(r"tach|key[ _-]?phas|once[ _-]?per|转速脉冲|键相", re.I)
_RATE = re.compile(
    r"^(fs|f_s|sr|samp(?:ling|le)?[ _-]?(?:rate|freq(?:uency)?)|rate|采样频率|采样率)"
    r"(?:[ _]?(?:\[?\(?hz\)?\]?))?$",
    re.I,
)


_DT = re.compile(
    r"^(dt|delta[ _]?t|[td][ _]?step|samp(?:ling|le)?[ _-]?(?:interval|period))$", re.I
)
_SUFFIX = re.compile(r"^(.*?)[ _](s|sec|ms|us|rpm|hz)$", re.I)
"""A unit behind an underscore: of times and speeds alone, where nothing else can be meant."""

_LONGEST = 200  # characters of a name that are looked at and kept

_FEW = 0.05  # of the steps may be jumps
_EVEN, _EXACT = 0.25, 0.02  # of a step: how far stamps may be off where blocks are dropped
HUGE = 1e30
"""No sensor reads this: beyond it a file is damaged or read in the wrong type."""


MOST_STAMPS = 1 << 23
"""Rows of a time column that its rate is taken from."""


def is_time_name(name: str) -> bool:
    """Whether a column's name (without its unit) says time.

    >>> is_time_name("Time"), is_time_name("a1")
    (True, False)
    """
    return bool(_TIME.match(name.strip()[:_LONGEST]))


def is_step_name(name: str) -> bool:
    """Whether a variable's name says the time between two samples.

    >>> is_step_name("dt"), is_step_name("date")
    (True, False)
    """
    return bool(_DT.match(name.strip()[:_LONGEST]))


def is_tacho_name(name: str) -> bool:
    """Whether a column's name says tacho or keyphasor."""
    return bool(_TACHO.search(name[:_LONGEST]))


def is_rate_name(name: str) -> bool:
    """Whether a variable's name says sampling rate."""
    return bool(_RATE.match(name.strip()[:_LONGEST]))


def is_possible_rate(rate: float) -> bool:
    """Whether a rate [samples/s] that a file states can be one."""
    return RATE.least <= rate <= RATE.most


def split_unit(name: str) -> tuple[str, str | None]:
    """A header cell as (name, known unit): "a1 [g]", "Time(ms)", "acc / m/s²", "加速度(m/s²)".

    >>> split_unit("Time(ms)"), split_unit("time_s")
    (('Time', 'ms'), ('time', 's'))
    """
    text = name.strip()[:_LONGEST].strip("\"'").strip()
    for pattern in (r"^(.*?)\s*[\[(（{]([^\])）}]*)[\])）}]\s*$", r"^(.*?)\s+(?:/|in)\s+(.+)$"):
        found = re.match(pattern, text)
        if found and found.group(1).strip():
            known = unit(found.group(2))
            if known is not None:
                return found.group(1).strip(), known
    found = _SUFFIX.match(text)
    if found and (known := unit(found.group(2))):
        turns = kind_of(known) in ("speed", "frequency") and not is_rate_name(text)
        if turns or is_time_name(found.group(1)):
            return found.group(1), known
    return text, None


def unknown_unit(name: str) -> str:
    """What is in brackets behind a channel's name as its unit and is none; "" where nothing.

    >>> unknown_unit("acc [furlong]"), unknown_unit("acc"), unknown_unit("a[2]")
    ('furlong', '', '')
    """
    found = re.search(r"[\[(（]([^\])）]{1,20})[\])）]\s*$", name[:_LONGEST])
    text = found.group(1).strip() if found else ""
    return text if re.search(r"[^\W\d]", text) and unit(text) is None else ""


@dataclass(frozen=True, kw_only=True)
class TimeBase:
    """What a time column says: rate [1/s] (None: it cannot be told), start, rows to drop."""

    rate: float | None
    start: float
    origin: str
    drop: tuple[int, ...] = ()
    notices: tuple[Notice, ...] = ()
    gaps: tuple[tuple[int, int], ...] = ()


def read_time(
    name: str, unit_name: str | None, t: Floats, *, repeats: NDArray[np.bool_] | None = None
) -> TimeBase:
    """Rate and start from a time column, or why it gives none.

    ``t`` in the column's own unit; ``repeats``: of each row, whether its every value repeats the
    row before. A time without a unit gives no rate. A doubled stamp on a row that is doubled as a
    whole is one row written twice and is dropped. Jumps by whole numbers of steps are dropped
    blocks: ``gaps`` (before which row, how many samples). Any other irregularity gives no rate.
    """
    notes: list[Notice] = []
    label = f"time column {name!r}"
    if unit_name is None or kind_of(unit_name) != "time":
        notes.append(
            Notice("important", f"{label} states no unit: no rate is taken from it (give --rate)")
        )
        return TimeBase(rate=None, start=0.0, origin="", drop=(), notices=tuple(notes))
    with np.errstate(over="ignore"):
        seconds = t * factor_of(unit_name)
    if t.size < 3 or not np.all(np.isfinite(seconds)):
        notes.append(Notice("important", f"{label} holds gaps: no rate is taken from it"))
        return TimeBase(rate=None, start=0.0, origin="", drop=(), notices=tuple(notes))
    what = ""
    if np.max(np.abs(seconds)) > HUGE:  # their differences would overflow
        what = f"holds stamps up to {np.max(np.abs(seconds)):.3g} s"
    elif np.all(seconds == seconds[0]):
        what = "stands still"
    if what:
        notes.append(Notice("important", f"{label} {what}: no rate is taken from it (give --rate)"))
        return TimeBase(rate=None, start=0.0, origin="", drop=(), notices=tuple(notes))
    steps = np.diff(seconds)
    twice = np.flatnonzero(steps == 0.0) + 1
    drop = tuple(int(i) for i in twice[repeats[twice]]) if repeats is not None else ()
    if drop:
        keep = np.ones(seconds.size, bool)
        keep[list(drop)] = False
        seconds = seconds[keep]
        steps = np.diff(seconds)
        notes.append(
            Notice(
                "warning",
                f"{label}: {_count(len(drop), 'row')} written twice (first: row {drop[0] + 1}), "
                "the repetition dropped",
            )
        )
    mean = float(seconds[-1] - seconds[0]) / (seconds.size - 1)
    if mean <= 0.0 or np.any(steps < 0):
        place = int(np.argmax(steps < 0)) + 2
        notes.append(
            Notice("important", f"{label} does not rise (row {place}): no rate is taken from it")
        )
        return TimeBase(
            rate=None, start=float(seconds[0]), origin="", drop=drop, notices=tuple(notes)
        )
    if not RATE.least <= 1.0 / max(mean, 1e-300) <= RATE.most:
        notes.append(Notice("important", f"{label}: steps of {mean:.3g} s give no rate"))
        return TimeBase(
            rate=None, start=float(seconds[0]), origin="", drop=drop, notices=tuple(notes)
        )
    # stamps written with few digits wander by half a digit around a straight line; anything
    # more than half a step off is a missing, extra or irregular sample
    line = seconds[0] + mean * np.arange(seconds.size)
    wander = float(np.max(np.abs(seconds - line))) / mean
    step = float(np.median(steps))
    bad = np.flatnonzero(np.abs(steps - step) > 0.5 * step)
    gaps = _dropped(seconds, steps, bad)
    if gaps:
        lost = sum(missing for _, missing in gaps)
        mean = float(seconds[-1] - seconds[0]) / (seconds.size - 1 + lost)
        notes.append(_told(label, gaps, drop))
    elif wander > 0.5 or (bad.size and bad.size < 0.01 * steps.size):
        first = int(bad[0]) + 2 if bad.size else int(np.argmax(np.abs(seconds - line))) + 1
        doubled = np.flatnonzero(steps == 0.0)
        what = (
            f"a time stamp appears twice (row {int(doubled[0]) + 2}) with other values"
            if doubled.size
            else f"steps are not uniform (row {first}: off by up to {wander:.3g} steps)"
        )
        notes.append(
            Notice("important", f"{label}: {what}; no rate is taken from it (give --rate)")
        )
        return TimeBase(
            rate=None, start=float(seconds[0]), origin="", drop=drop, notices=tuple(notes)
        )
    if unit_name != "s":
        notes.append(Notice("info", f"{label} is in {unit_name}"))
    return TimeBase(
        rate=1.0 / mean,
        start=float(seconds[0]),
        origin=label,
        drop=drop,
        notices=tuple(notes),
        gaps=gaps,
    )


def _told(label: str, gaps: tuple[tuple[int, int], ...], drop: tuple[int, ...]) -> Notice:
    """Where blocks are dropped, in rows of the file: those written twice count there."""
    first = gaps[0][0] + 1
    for row in drop:
        first += row < first
    lost = _count(sum(missing for _, missing in gaps), "sample")
    return Notice(
        "warning",
        f"{label} jumps at {_count(len(gaps), 'place')} (first: row {first}): {lost} dropped "
        "there; they are put in without a number",
    )


def _dropped(seconds: Floats, steps: Floats, bad: NDArray[np.intp]) -> tuple[tuple[int, int], ...]:
    """Dropped blocks: few jumps by whole numbers of steps between stamps that are even else."""
    few = 0 < bad.size <= max(1, _FEW * steps.size)
    if not few or np.any(steps[bad] <= 0.0):
        return ()
    others = np.delete(steps, bad)
    step = float(np.mean(others))
    jumps = steps[bad] / step
    missing = np.rint(jumps) - 1.0
    # as whole as the stamps are even: a pause of any length is no dropped block
    even = min(_EVEN, max(_EXACT, 3.0 * float(np.max(np.abs(others / step - 1.0)))))
    whole = np.abs(jumps - np.rint(jumps)) < even
    if not np.all(whole & (missing >= 1.0)) or missing.sum() > seconds.size:
        return ()
    place = np.arange(seconds.size, dtype=float)
    for row, more in zip(bad, missing, strict=True):
        place[row + 1 :] += more
    slope, start = np.polyfit(place, seconds, 1)
    if np.max(np.abs(seconds - start - slope * place)) > _EVEN * slope:
        return ()
    return tuple((int(row) + 1, int(more)) for row, more in zip(bad, missing, strict=True))


@dataclass(frozen=True, kw_only=True)
class Health:
    """Facts about one channel found in a single pass: gaps, zeros, constancy, clipping."""

    missing: int
    longest_gap: int
    zeros: bool
    constant: bool
    rms: float
    peak: float


def health(channel: Channel) -> Health:
    """One pass over a channel, block by block."""
    missing = gap = longest = count = 0
    total = square = 0.0
    low, high = np.inf, -np.inf
    for block in channel.blocks():
        good = np.isfinite(block)
        values = block
        if not good.all():
            bad = np.flatnonzero(~good)
            missing += bad.size
            values = block[good]
            edges = np.flatnonzero(np.diff(bad) > 1)
            firsts = bad[np.concatenate([[0], edges + 1])]
            lasts = bad[np.concatenate([edges, [bad.size - 1]])]
            runs = lasts - firsts + 1
            if firsts[0] == 0:
                runs[0] += gap
            longest = max(longest, int(runs.max()))
            gap = int(runs[-1]) if lasts[-1] == block.size - 1 else 0
        else:
            gap = 0
        if values.size:
            count += values.size
            with np.errstate(over="ignore", invalid="ignore"):
                total += float(values.sum())
                square += float(np.dot(values, values))
            low, high = min(low, float(values.min())), max(high, float(values.max()))
    mean = total / count if count else 0.0
    peak = float(max(abs(low), abs(high))) if count else 0.0
    rms = float(np.sqrt(max(square / count - mean**2, 0.0))) if count and peak < HUGE else peak
    return Health(
        missing=missing,
        longest_gap=longest,
        zeros=count > 0 and low == high == 0.0,
        constant=count > 0 and low == high,
        rms=rms,
        peak=peak,
    )


def examined(record: Record) -> Record:
    """The record with a notice for every channel that is zero, constant or has gaps."""
    for channel in record.channels:
        found = health(channel)
        if found.missing == len(channel):
            record = record.noting("important", f"channel {channel.name!r} holds no number at all")
        elif found.missing:
            record = record.noting(
                "important",
                f"channel {channel.name!r}: {_count(found.missing, 'sample')} missing (NaN), the "
                f"longest gap {found.longest_gap}",
            )
        if found.peak >= HUGE:
            record = record.noting(
                "important",
                f"channel {channel.name!r} holds values up to {found.peak:.3g}: damaged or of "
                "another type",
            )
        if found.zeros:
            record = record.noting("important", f"channel {channel.name!r} is zero throughout")
        elif found.constant:
            record = record.noting("important", f"channel {channel.name!r} is constant")
    return record


def without_doubles(
    channels: list[Channel], source: str
) -> tuple[list[Channel], tuple[Notice, ...]]:
    """Channels with the doubled names resolved: an all-zero twin is left aside, never chosen.

    Twins that hold the same samples are one; twins that differ both stay, numbered.
    """
    notes: list[Notice] = []
    kept: list[Channel] = []
    places: dict[str, int] = {}
    numbers: dict[str, int] = {}
    for channel in channels:
        if channel.name not in places:
            places[channel.name] = len(kept)
            kept.append(channel)
            continue
        place = places[channel.name]
        first = kept[place]
        if health(first).zeros:
            kept[place] = channel
            notes.append(
                Notice(
                    "warning",
                    f"{channel.name!r} is stored twice; the first is zero throughout and is left "
                    "aside",
                )
            )
        elif health(channel).zeros:
            notes.append(
                Notice(
                    "warning",
                    f"{channel.name!r} is stored twice; the second is zero throughout and is left "
                    "aside",
                )
            )
        elif len(first) == len(channel) and _same(first, channel):
            notes.append(Notice("info", f"{channel.name!r} is stored twice, the same; one is kept"))
        else:
            number = numbers[channel.name] = numbers.get(channel.name, 1) + 1
            while f"{channel.name} ({number})" in places:
                number += 1
            places[f"{channel.name} ({number})"] = len(kept)
            kept.append(replace(channel, name=f"{channel.name} ({number})"))
            notes.append(
                Notice(
                    "important",
                    f"{channel.name!r} is stored twice with other values; the second is called "
                    f"'{channel.name} ({number})'",
                )
            )
    if not kept:
        raise InputError("file", source, why="it holds no channel of numbers")
    return kept, tuple(notes)


def _same(one: Channel, other: Channel) -> bool:
    return all(
        np.array_equal(a, b, equal_nan=True)
        for a, b in zip(one.blocks(), other.blocks(), strict=True)
    )


def _count(number: int, noun: str) -> str:
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"
