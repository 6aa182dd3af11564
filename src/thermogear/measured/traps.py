"""Traps of real files, recognised and named: zeros, gaps, doubled variables, broken time."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.bounds import RATE
from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.units import factor_of, kind_of, says_seconds, unit, unknown
from thermogear.signals.stamps import Pace, grain_of, jumps_of, pace_of, usual_rate

_TIME = re.compile(r"^(x[_ ]?value|time|zeit|temps|tijd|时间|t)(?:[ _]?(?:stamp|axis))?$", re.I)
_OF_TIME = re.compile(r"time|zeit|temps|tijd|时间", re.I)
_TACHO = re.compile(r"tach|key[ _-]?phas|once[ _-]?per|转速脉冲|键相", re.I)
_RATE = re.compile(
    r"^(fs|f_s|sr|samp(?:ling|le)?[ _-]?(?:rate|freq(?:uency)?)|rate|采样频率|采样率)"
    r"(?:[ _]?(?:\[?\(?hz\)?\]?))?$",
    re.I,
)


_DT = re.compile(
    r"^(dt|delta[ _]?t|[td][ _]?step|samp(?:ling|le)?[ _-]?(?:interval|period))$", re.I
)
_CODE = re.compile(r"^X\d+(?=RPM$)")  # of a record, before the name
_SPEED = re.compile(
    r"^(X\d+rpm|((shaft|motor|input|rotor|rotation(al)?|nominal|mean|pinion)[ _-]?)?"
    r"(speed|rpm|rps|drehzahl|转速))$",
    re.I,
)
_SUFFIX = re.compile(r"^(.*?)[ _](s|sec|ms|us|rpm|hz)$", re.I)
"""A unit behind an underscore: of times and speeds alone, where nothing else can be meant."""
_LETTERS = ("h", "d")
"""Units of time that mean other things behind any other name: (h) is horizontal."""

_LONGEST = 200  # characters of a name that are looked at and kept

_FEW, _SOME = 0.05, 3  # of the steps may be jumps; so many are few in any record
_EVEN, _EXACT = 0.25, 0.02  # of a step: how far stamps may be off where blocks are dropped
HUGE = 1e30
TINY = 1e-30
"""No sensor reads this: beyond it a file is damaged or read in the wrong type."""


MOST_STAMPS = 1 << 23
"""Rows of a time column that its rate is taken from."""

_OFF = 0.5  # of a step: farthest of a stamp from an even clock, beside rounding
_JITTER = 0.02  # of a step: jitter, or rounding, that is told
_EXACTLY = 1e-8  # relative half width that is not told


def is_time_name(name: str) -> bool:
    """Whether a column's name says time: without its unit, or before one that is not known.

    >>> [is_time_name(one) for one in ("Time", "time [weeks]", "a1", "T [K]")]
    [True, True, False, False]
    """
    text = name.strip()[:_LONGEST]
    if unknown_unit(text):
        text = re.split(r"\s*[\[(（]", text)[0]
        return len(text) > 1 and bool(_TIME.match(text))
    return bool(_TIME.match(text))


def is_step_name(name: str) -> bool:
    """Whether a variable's name says the time between two samples.

    >>> is_step_name("dt"), is_step_name("date")
    (True, False)
    """
    return bool(_DT.match(name.strip()[:_LONGEST]))


def is_tacho_name(name: str) -> bool:
    """Whether a column's name says tacho or keyphasor."""
    return bool(_TACHO.search(name[:_LONGEST]))


@dataclass(frozen=True, kw_only=True)
class SpeedFact:
    """What a file states of a shaft's speed: the ``name`` of the field, its ``value``, the speed
    [rad/s] where its unit is known."""

    name: str
    value: float
    speed: float | None


def speed_fact(name: str, value: float, said: str | None = None) -> SpeedFact | None:
    """The speed that a field states, None where its name says no speed; ``said``: its unit.

    >>> speed_fact("rpm", 60.0).speed.__round__(3), speed_fact("shaft_speed", 1500.0).speed
    (6.283, None)
    """
    bare, known = split_unit(name)
    known = known or said or unit(_CODE.sub("", bare))
    if value <= 0.0 or not _SPEED.match(bare):
        return None
    turns = known is not None and kind_of(known) in ("speed", "frequency")
    speed = 2.0 * np.pi * value * factor_of(known) if known and turns else None
    return SpeedFact(name=name, value=value, speed=speed)


def is_rate_name(name: str) -> bool:
    """Whether a variable's name says sampling rate."""
    return bool(_RATE.match(name.strip()[:_LONGEST]))


def is_possible_rate(rate: float) -> bool:
    """Whether a rate [samples/s] that a file states can be one."""
    return RATE.least <= rate <= RATE.most


def split_unit(name: str) -> tuple[str, str | None]:
    """A header cell as (name, known unit): "a1 [g]", "Time(ms)", "acc / m/s²", "加速度(m/s²)".

    >>> split_unit("Time(ms)"), split_unit("time_s"), split_unit("Seconds")
    (('Time', 'ms'), ('time', 's'), ('Seconds', 's'))
    """
    text = name.strip()[:_LONGEST].strip("\"'").strip()
    for pattern in (r"^(.*?)\s*[\[(（{]([^\])）}]*)[\])）}]\s*$", r"^(.*?)\s+(?:/|in)\s+(.+)$"):
        found = re.match(pattern, text)
        if found and found.group(1).strip():
            known = unit(found.group(2))
            if known in _LETTERS and not _OF_TIME.search(found.group(1)):
                known = None
            if known is not None:
                return found.group(1).strip(), known
    found = _SUFFIX.match(text)
    if found and (known := unit(found.group(2))):
        turns = kind_of(known) in ("speed", "frequency") and not is_rate_name(text)
        if turns or is_time_name(found.group(1)):
            return found.group(1), known
    return text, unit(text) if says_seconds(text) else None


def unknown_unit(name: str) -> str:
    """What is in brackets behind a channel's name as its unit and is none; "" where nothing.

    >>> unknown_unit("acc [furlong]"), unknown_unit("acc"), unknown_unit("a[2]")
    ('furlong', '', '')
    """
    found = re.search(r"[\[(（]([^\])）]{1,20})[\])）]\s*$", name[:_LONGEST])
    return unknown(found.group(1)) if found else ""


@dataclass(frozen=True, kw_only=True)
class TimeBase:
    """What a time column says: rate [1/s] (None: it cannot be told) and the half width of its 95 %
    interval, 0 where it is a usual rate; start, the stamps' ``jitter`` [steps rms];
    ``note``: how well they tell the rate; ``by_stamps``: each sample has its own;
    ``stretch``: the rows that it is of, None for all."""

    rate: float | None
    start: float
    origin: str
    notices: tuple[Notice, ...] = ()
    gaps: tuple[tuple[int, int], ...] = ()
    half_width: float = 0.0
    jitter: float = 0.0
    note: str = ""
    by_stamps: bool = False
    stretch: tuple[int, int] | None = None


def read_time(name: str, unit_name: str | None, t: Floats, *, stated: bool = False) -> TimeBase:
    """Rate and start from a time column, or why it gives none.

    ``t`` in the column's own unit; ``stated``: the file states its rate elsewhere. A time without
    a unit gives no rate.
    Jumps by whole numbers of steps are dropped blocks: ``gaps`` (before which row, how many
    samples). Stamps may be rounded, also so that they repeat, and may jitter by half a step; any
    other irregularity gives no rate. The rate is that of
    :func:`~thermogear.signals.stamps.pace_of`, or the one usual rate in its interval.
    """
    none = TimeBase(rate=None, start=0.0, origin="")
    if unit_name is None or kind_of(unit_name) != "time":
        told = Notice.of(
            "time_unit_not_needed" if stated else "time_unit_not_known",
            column=name,
            unit=unknown_unit(name) or None,
        )
        return replace(none, notices=(told,))
    with np.errstate(over="ignore"):
        seconds = t * factor_of(unit_name)
    if t.size < 3 or not np.all(np.isfinite(seconds)):
        return replace(none, notices=(Notice.of("time_holds_gaps", column=name),))
    if (farthest := np.max(np.abs(seconds))) > HUGE:  # differences would overflow
        told = Notice.of("time_too_large", column=name, largest=farthest)
        return replace(none, notices=(told,))
    if np.all(seconds == seconds[0]):
        return replace(none, notices=(Notice.of("time_stands_still", column=name),))
    grain = grain_of(t) * factor_of(unit_name)
    steps = np.diff(seconds)
    mean = float(seconds[-1] - seconds[0]) / (seconds.size - 1)
    found = TimeBase(rate=None, start=float(seconds[0]), origin="", by_stamps=True)
    if mean <= 0.0 or np.any(steps < 0):
        row = int(np.argmax(steps < 0)) + 2
        return replace(found, notices=(Notice.of("time_falls", column=name, row=row),))
    if not RATE.least <= 1.0 / max(mean, 1e-300) <= RATE.most:
        return replace(found, notices=(Notice.of("time_step_impossible", column=name, step=mean),))
    return _paced(found, name, seconds, grain, unit_name)


def longest_even(name: str, unit_name: str | None, t: Floats, *, stated: bool = False) -> TimeBase:
    """The time base by stamps, as :func:`read_time`; where these pause up to three times, by no
    whole number of steps, that of the longest stretch between pauses."""
    base = read_time(name, unit_name, t, stated=stated)
    if base.rate is not None or not base.by_stamps:
        return base
    rows, ahead = jumps_of(t, grain=grain_of(t))
    if not 0 < rows.size <= _SOME or np.any(ahead <= 0.0):
        return base
    edges = np.concatenate([[0], rows, [t.size]])
    longest = int(np.argmax(np.diff(edges)))
    first, stop = int(edges[longest]), int(edges[longest + 1])
    part = read_time(name, unit_name, t[first:stop], stated=stated)
    notice = Notice.of(
        "time_pauses",
        column=name,
        places=rows.size,
        row=int(rows[0]) + 1,
        first=first,
        last=stop - 1,
    )
    stretch = replace(part, stretch=(first, stop), notices=(notice, *part.notices))
    return base if part.rate is None else stretch


def _paced(found: TimeBase, name: str, seconds: Floats, grain: Floats, unit_name: str) -> TimeBase:
    """What rising stamps [s], rounded to ``grain``, say: gaps, jitter and the rate, or none."""
    steps = np.diff(seconds)
    notes: list[Notice] = []
    jumps, ahead = jumps_of(seconds, grain=grain)
    gaps = _dropped(jumps, ahead, steps)
    place = np.arange(seconds.size, dtype=float)
    for row, missing in gaps:
        place[row:] += missing
    pace = pace_of(seconds, grain=grain, place=place)
    uneven = pace.farthest > max(_OFF, 6.0 * pace.jitter) or pace.jitter > 0.5 * _OFF
    if uneven or (not gaps and 0 < jumps.size <= max(_SOME, _FEW * steps.size)):
        doubled = np.flatnonzero(steps == 0.0)
        if 0 < doubled.size <= _FEW * steps.size:
            told = Notice.of("time_stamp_twice", column=name, row=int(doubled[0]) + 2)
        else:
            told = Notice.of(
                "time_not_uniform",
                column=name,
                row=int(jumps[0]) + 1 if jumps.size else pace.place + 1,
                off=max(pace.farthest, float(np.max(np.abs(ahead), initial=0.0))),
            )
        return replace(found, notices=(*notes, told))
    if gaps:
        samples = sum(missing for _, missing in gaps)
        first = gaps[0][0] + 1
        notes.append(
            Notice.of("samples_lost", column=name, places=len(gaps), first=first, samples=samples)
        )
    if pace.jitter > _JITTER:
        notes.append(
            Notice.of(
                "time_jitters",
                column=name,
                jitter=pace.jitter,
                farthest=pace.farthest,
                loss=0.5 * (2.0 * np.pi * 0.1 * pace.jitter) ** 2,
            )
        )
    if unit_name != "s":
        notes.append(Notice.of("time_unit", column=name, unit=unit_name))
    origin = f"time column {name!r}"
    return _with_rate(replace(found, gaps=gaps, origin=origin, notices=tuple(notes)), pace)


def step_base(
    step: float, *, channel: str, start: float, origin: str, half_width: float = 0.0
) -> TimeBase:
    """The time base by a ``step`` [s] that a file states of a channel.

    The digits it is printed with leave +- ``half_width`` [s] open: the rate is the one usual rate
    in there, else has its half width.

    >>> step_base(1.95313e-5, channel="a", start=0.0, origin="x", half_width=5e-11).rate
    51200.0
    """
    base = TimeBase(rate=None, start=start, origin=origin)
    if not (step > 0.0 and is_possible_rate(1.0 / step)):
        told = Notice.of("step_gives_no_rate", channel=channel, step=step)
        return replace(base, origin="", notices=(told,))
    low, high = max(step - half_width, 0.1 * step), step + half_width
    return _with_rate(base, Pace(step=step, low=low, high=high, grain=2.0 * half_width))


def _with_rate(base: TimeBase, pace: Pace) -> TimeBase:
    """The rate by a pace [s]: the usual rate that alone fits it, else with its half width."""
    low, high = 1.0 / pace.high, 1.0 / pace.low
    usual = usual_rate(low, high=high)
    rounded = pace.grain > _JITTER * pace.step
    rate = 1.0 / pace.step if usual is None else usual
    half = max(high - rate, rate - low) if usual is None else 0.0
    width = max(high - rate, rate - low) / rate
    note = ""
    if width > _EXACTLY or rounded:
        what = "stamps of" if base.by_stamps else f"{pace.step:g} s, rounded to"
        note = f"{what} {pace.grain:.3g} s, allow +- {width * rate:.2g} samples/s"
        note += "" if usual is None else ": the usual rate there is taken"
    return replace(
        base,
        rate=rate,
        start=base.start + (pace.begin if rounded else 0.0),
        half_width=half,
        jitter=pace.jitter,
        note=note,
    )


def _dropped(jumps: NDArray[np.intp], ahead: Floats, steps: Floats) -> tuple[tuple[int, int], ...]:
    """Dropped blocks: few jumps by whole numbers of steps between stamps that are even else."""
    if not 0 < jumps.size <= max(1, _FEW * steps.size) or np.any(steps[jumps - 1] <= 0.0):
        return ()
    missing = np.rint(ahead)
    others = np.delete(steps, jumps - 1)
    # as whole as the stamps are even: a pause of any length is no dropped block
    uneven = float(np.max(np.abs(others / np.mean(others) - 1.0)))
    even = min(_EVEN, max(_EXACT, 3.0 * uneven))
    if not np.all((np.abs(ahead - missing) < even) & (missing >= 1.0)):
        return ()
    if missing.sum() > steps.size + 1:
        return ()
    return tuple((int(row), int(more)) for row, more in zip(jumps, missing, strict=True))


@dataclass(frozen=True, kw_only=True)
class Health:
    """Facts about one channel found in a single pass: samples missing, zeros, constancy, size."""

    missing: int
    zeros: bool
    constant: bool
    peak: float

    def told(self, channel: str) -> Notice | None:
        """Why nothing can be read from the ``channel``; None where it holds a signal."""
        if self.zeros:
            return Notice.of("channel_zero", channel=channel)
        if self.constant:
            return Notice.of("channel_constant", channel=channel)
        if self.peak == 0.0:
            return Notice.of("channel_empty", channel=channel)
        if TINY <= self.peak < HUGE:
            return None
        return Notice.of(
            "channel_out_of_range", channel=channel, largest=self.peak, least=TINY, most=HUGE
        )


def health(channel: Channel) -> Health:
    """One pass over a channel, block by block."""
    missing = 0
    low, high = np.inf, -np.inf
    for block in channel.blocks():
        values = block[np.isfinite(block)]
        missing += block.size - values.size
        if values.size:
            low, high = min(low, float(values.min())), max(high, float(values.max()))
    return Health(
        missing=missing,
        zeros=low == high == 0.0,
        constant=low == high,
        peak=float(max(abs(low), abs(high))) if low <= high else 0.0,
    )


def examined(record: Record) -> Record:
    """The record with a notice for every channel that holds no signal or has gaps."""
    for channel in record.channels:
        found = health(channel)
        if 0 < found.missing < len(channel):
            record = record.noting(
                Notice.of(
                    "samples_missing",
                    channel=channel.name,
                    samples=found.missing,
                )
            )
        if (told := found.told(channel.name)) is not None:
            record = record.noting(told)
    return record


def without_doubles(
    channels: list[Channel], source: str
) -> tuple[list[Channel], tuple[Notice, ...]]:
    """Channels with the doubled names resolved: an all-zero twin is left aside, never chosen.

    Other twins both stay, numbered.
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
        if (zeros := health(first).zeros) or health(channel).zeros:
            kept[place] = channel if zeros else first
            notes.append(Notice.of("twin_zero", channel=channel.name))
        else:
            number = numbers[channel.name] = numbers.get(channel.name, 1) + 1
            while f"{channel.name} ({number})" in places:
                number += 1
            renamed = f"{channel.name} ({number})"
            places[renamed] = len(kept)
            kept.append(replace(channel, name=renamed))
            notes.append(Notice.of("twin_renamed", channel=channel.name, renamed=renamed))
    if not kept:
        raise InputError("file", source, why="it holds no channel of numbers")
    return kept, tuple(notes)
