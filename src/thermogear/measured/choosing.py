"""Which column is the time, and which channels are reduced: by unit, by name and by course."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Notice, Record, Samples
from thermogear.measured.traps import MOST_STAMPS, health, is_time_name
from thermogear.measured.units import kind_of
from thermogear.signals.stamps import grain_of, pace_of

_FIRST = 1 << 10  # samples in which nearly every vibration turns back
_STRAIGHT = 0.05  # of its rise: how far a clock or a counter may be off a straight line
_MOTION = ("acceleration", "velocity", "displacement")


def is_time_column(name: str, unit: str | None) -> bool:
    """Whether a column is a time: by its known unit, by its name where none is known.

    >>> is_time_column("X", "s"), is_time_column("T", "degC"), is_time_column("time", None)
    (True, False, True)
    """
    return is_time_name(name) if unit is None else kind_of(unit) == "time"


def time_column(columns: Sequence[tuple[str, str | None, Samples]]) -> int | None:
    """Which of the (name, unit, samples) that are times is the time of the samples.

    One named time with its unit; else one whose unit is of time and that rises; else one named
    time. None where there is no column.
    """

    def rank(place: int) -> int:
        name, unit, samples = columns[place]
        if unit is not None and is_time_name(name):
            return 0
        if unit is not None and _turns_never(samples, up=True):
            return 1
        return 2 if unit is None else 3

    return min(range(len(columns)), key=rank, default=None)


def chosen_channels(
    record: Record, channels: Sequence[str | int], notices: list[Notice]
) -> list[Channel]:
    """The channels to reduce: those named, else all of one unit that hold a vibration.

    The unit is the first channel's, of those without one the first of motion. What is left out is
    told in ``notices``, once.
    """
    if channels:
        picked = [record.channel(name) for name in channels]
        for channel in picked:
            if (told := _nothing(channel)) is not None:
                raise InputError("channel", repr(channel.name), why=told.text)
        return picked
    alive, silent = [], []
    for channel in record.signals():
        if (told := _nothing(channel)) is None:
            alive.append(channel)
            continue
        silent.append(told)
        notices += [told] if told not in notices else []
    if not alive:
        why = "; ".join(told.text for told in silent[:3])
        raise InputError("record", record.source, why=why)
    moving = (c.unit for c in alive if c.unit is not None and kind_of(c.unit) in _MOTION)
    first = alive[0].unit or next(moving, None)
    others = [c for c in alive if c.unit != first]
    if others:
        units = [c.unit for c in others]
        notices.append(
            Notice.of(
                "several_units",
                unit=first,
                channels=[c.name for c in others],
                units=units if all(units) else None,
            )
        )
    return [c for c in alive if c.unit == first]


def _nothing(channel: Channel) -> Notice | None:
    """Why no vibration can be read from a channel, None where there may be one."""
    told = health(channel).told(channel.name)
    if told is None and counts(channel):
        return Notice.of("channel_counts", channel=channel.name)
    if told is None and is_digital(channel):
        return Notice.of("channel_digital", channel=channel.name)
    return told


def is_digital(channel: Channel) -> bool:
    """Whether a channel holds two values alone, as pulses or a switch do.

    >>> bits = np.arange(1000.0) % 2.0
    >>> is_digital(Channel("a", bits)), is_digital(Channel("a", np.append(bits, 0.5)))
    (True, False)
    """
    values = channel.values(0, stop=min(len(channel), MOST_STAMPS))
    good = values[np.isfinite(values)]
    return bool(np.all((good == good.min()) | (good == good.max())))


def counts(channel: Channel) -> bool:
    """Whether a channel is a clock or a counter: it never turns back and runs straight.

    In a known unit all of it is on a straight line up to rounding, so that no drift is taken for
    one; without a unit within 5 % of its rise.

    >>> index, x = np.arange(1000.0), np.cos(np.arange(1000.0))
    >>> [counts(Channel("a", one)) for one in (index, 5.0 * index + x, 100.0 * x)]
    [True, True, False]
    >>> [counts(Channel("a", one, "g")) for one in (index, 5.0 * index + x)]
    [True, False]
    """
    if not _turns_never(channel.samples, up=None):
        return False
    values = np.asarray(channel.samples[0 : min(len(channel), MOST_STAMPS)], dtype=float)
    place = np.flatnonzero(np.isfinite(values)).astype(float)
    values = values[np.isfinite(values)]
    if values.size < 3:
        return False
    if values[-1] < values[0]:
        values = -values
    if channel.unit is None:
        line = np.interp(place, place[[0, -1]], values[[0, -1]])
        return bool(np.max(np.abs(values - line)) <= _STRAIGHT * (values[-1] - values[0]))
    pace = pace_of(values, grain=grain_of(values), place=place)
    return pace.even and pace.grain <= pace.step


def _turns_never(samples: Samples, *, up: bool | None) -> bool:
    """Whether samples never fall (``up``), or never fall or never rise (None), and change."""
    for stop in (_FIRST, MOST_STAMPS):
        values = np.asarray(samples[0 : min(len(samples), stop)], dtype=float)
        values = values[np.isfinite(values)]
        with np.errstate(over="ignore"):
            steps = np.diff(values)
        never = bool(np.all(steps >= 0.0)) or (up is None and bool(np.all(steps <= 0.0)))
        if not never:
            return False
    return bool(np.any(steps != 0.0))
