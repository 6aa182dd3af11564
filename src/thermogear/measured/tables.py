"""From named arrays (MAT, NPZ, HDF5) to one record: which are channels, time, rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from thermogear.measured.choosing import is_time_column, time_column
from thermogear.measured.options import ReadOptions, places_of, refused
from thermogear.measured.parts import with_gaps
from thermogear.measured.record import Channel, Notice, Record, Samples
from thermogear.measured.traps import (
    MOST_STAMPS,
    TimeBase,
    is_possible_rate,
    is_rate_name,
    is_step_name,
    is_tacho_name,
    read_time,
    split_unit,
    without_doubles,
)
from thermogear.measured.units import counts_turns, factor_of, kind_of, unit, unknown

MOST_CHANNELS = 512
MOST_IN_ALL = 4096
"""Channels of one table, and of a whole file."""
SHORTEST = 8  # samples: shorter arrays are parameters, not records


@dataclass(frozen=True)
class Named:
    """One stored array: 1-D or 2-D, in memory or on disk; ``attributes`` as the file has them."""

    name: str
    data: Any
    shape: tuple[int, ...]
    attributes: dict[str, Any] = field(default_factory=dict)


class Column:
    """One column or row of a stored 2-D array, read slice by slice."""

    def __init__(self, data: Any, index: int, *, axis: int) -> None:
        self._data, self._index, self._axis = data, index, axis

    def __len__(self) -> int:
        return int(self._data.shape[self._axis])

    def __getitem__(self, key: slice) -> Any:
        where = (key, self._index) if self._axis == 0 else (self._index, key)
        return np.asarray(self._data[where])


def text_of(value: Any) -> str | None:
    """An attribute as text, where it is text."""
    if isinstance(value, bytes):
        return value.decode("utf-8", "replace")
    if isinstance(value, np.ndarray) and value.size == 1:
        return text_of(value.reshape(-1)[0])
    return str(value) if isinstance(value, str) else None


def number_of(value: Any) -> float | None:
    """An attribute or array as one finite number, where it is one."""
    try:
        array = np.asarray(value)
        if array.size != 1 or array.dtype.kind not in "iuf":
            return None
        number = float(array.reshape(-1)[0])
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) else None


def record_of(
    path: Path, kind: str, arrays: Sequence[Named], options: ReadOptions, common: dict[str, Any]
) -> Record:
    """One record from a file's arrays.

    The longest arrays are the channels, shorter ones are left aside with a notice; an array
    named time gives the rate (if it states its unit), a number named fs, rate, ... likewise. A
    rate told twice in two ways is used by neither.
    """
    told = _Told()
    for place in (common, *(a.attributes for a in arrays)):
        for key, value in place.items():
            told.number(str(key), value, f"attribute {key}")
    for array in arrays:
        told.array(array)
    if told.complex:
        aside = Notice.of("complex_left_aside", arrays=told.complex)
        if not told.channels:
            fix = "save what was sampled: real numbers"
            raise refused(path, kind, f"{aside.text}; no other array is as long as one", fix)
        told.notes.append(aside)
    if not told.channels:
        raise refused(path, kind, "it holds no array of numbers as long as a record")
    notes = told.notes
    channels = of_one_length(told.channels, notes)
    if len(channels) > MOST_IN_ALL:
        raise refused(path, kind, f"{len(channels)} channels; allowed 1..{MOST_IN_ALL}")
    longest = len(channels[0])
    channels, doubled = without_doubles(channels, path.name)
    if options.keep:
        channels = _kept(channels, options.keep)
    base = told.time_base(longest)
    channels = [with_gaps(one, base.gaps) for one in channels] if base.gaps else channels
    units = [v for k, v in common.items() if str(k).lower() in ("unit", "units")]
    of_all = unit(text_of(units[-1]) or "") if units else None
    if of_all is not None:
        channels = [c if c.unit else Channel(c.name, c.samples, of_all) for c in channels]
    rate, origin = agreed(told.rates, notes)
    by_stamps = rate is not None and origin == base.origin
    tacho = next((c.name for c in channels if is_tacho_name(c.name)), None)
    return Record(
        tuple(channels),
        path.name,
        rate,
        origin,
        base.start,
        tacho,
        (*notes, *doubled),
        rate_half_width=base.half_width if by_stamps else 0.0,
        rate_note=base.note if by_stamps else "",
        jitter=base.jitter,
    )


@dataclass
class _Told:
    """What a file's arrays and attributes turn out to be; ``rates`` [1/s] with their origins."""

    channels: list[Channel] = field(default_factory=list)
    times: list[Channel] = field(default_factory=list)
    rates: list[tuple[float, str]] = field(default_factory=list)
    notes: list[Notice] = field(default_factory=list)
    complex: list[str] = field(default_factory=list)

    def number(self, name: str, value: Any, origin: str, factor: float = 1.0) -> None:
        """A rate, where ``name`` says so and ``value`` is a number of ``factor`` [1/s]."""
        number = number_of(value)
        if number is None or number <= 0:
            return
        if is_rate_name(name):
            self.rates.append((number * factor, origin))
        elif is_step_name(name):
            self.rates.append((1.0 / max(number, 1e-300), f"{origin} (a step, in seconds)"))

    def array(self, array: Named) -> None:
        """A number, a time, one channel or several, by its shape and name."""
        bare, said = split_unit(array.name)
        leaf = bare.rsplit("/", 1)[-1].rsplit(".", 1)[-1]
        if said is None:  # "time_s" tells its unit wherever it is
            head, (leaf, said) = bare.removesuffix(leaf), split_unit(leaf)
            bare = head + leaf
        strange = ""
        for key in ("units", "unit", "Unit", "Units", "unit_string"):
            text = text_of(array.attributes.get(key)) or ""
            said, strange = said or unit(text), strange or unknown(text)
        sizes = [n for n in array.shape if n != 1]
        if not sizes:
            factor = factor_of(said) if said and kind_of(said) == "frequency" else 1.0
            value = array.data[()] if hasattr(array.data, "shape") else array.data
            self.number(leaf, value, f"variable {array.name}", factor)
        elif len(sizes) > 2 or max(sizes) < SHORTEST:
            return
        elif np.iscomplexobj(array.data):
            self.complex.append(array.name)
        elif len(sizes) == 1:
            kind = self.times if is_time_column(leaf, said) else self.channels
            kind.append(Channel(bare, _flat(array), said, strange=strange))
        elif min(sizes) > MOST_CHANNELS or len(array.shape) != 2:
            self.notes.append(
                Notice.of("array_left_aside", array=array.name, shape=list(array.shape))
            )
        else:
            axis = 0 if sizes[0] >= sizes[1] else 1
            self.channels += [
                Channel(
                    f"{bare}[{index + 1}]",
                    Column(array.data, index, axis=axis),
                    said,
                    strange=strange,
                )
                for index in range(min(sizes))
            ]

    def time_base(self, longest: int) -> TimeBase:
        """What the time as long as the channels says; nothing where there is none.

        What it says of the rate goes to the others.
        """
        times = [one for one in self.times if len(one) == longest]
        leaves = [one.name.rsplit("/", 1)[-1].rsplit(".", 1)[-1] for one in times]
        columns = [(leaf, one.unit, one.samples) for leaf, one in zip(leaves, times, strict=True)]
        best = time_column(columns)
        if best is None:
            return TimeBase(rate=None, start=0.0, origin="")
        time = times[best]
        t = np.asarray(time.samples[0 : min(longest, MOST_STAMPS)], dtype=float)
        if t.size < longest:
            self.notes.append(Notice.of("rate_of_first_rows", rows=t.size, column=time.name))
        base = read_time(time.name, time.unit, t, stated=bool(self.rates))
        self.notes += base.notices
        if base.rate is not None:
            self.rates.append((base.rate, base.origin))
        return base


def of_one_length(channels: list[Channel], notes: list[Notice]) -> list[Channel]:
    """The longest of the channels; those left aside are named in ``notes``."""
    longest = max(len(c) for c in channels)
    aside = [c.name for c in channels if len(c) != longest]
    if aside:
        notes.append(Notice.of("shorter_left_aside", samples=longest, channels=aside))
    return [c for c in channels if len(c) == longest]


def agreed(rates: list[tuple[float, str]], notes: list[Notice]) -> tuple[float | None, str]:
    """The one rate that every place in the file agrees on, else None with a notice."""
    notes += [
        Notice.of("rate_impossible", origin=origin, rate=rate)
        for rate, origin in rates
        if not is_possible_rate(rate)
    ]
    rates = [one for one in rates if is_possible_rate(one[0])]
    if not rates:
        return None, ""
    rate, origin = rates[0]
    for other, where in rates[1:]:
        if abs(other / rate - 1.0) > 1e-3:
            notes.append(
                Notice.of(
                    "rate_stated_twice",
                    origin=origin,
                    rate=rate,
                    other_origin=where,
                    other_rate=other,
                    ratio=rate / other,
                )
            )
            return None, ""
    notes.append(Notice.of("rate_read", rate=rate, origin=origin))
    return rate, origin


def _flat(array: Named) -> Samples:
    if len(array.shape) == 1:
        return array.data  # type: ignore[no-any-return]
    if len(array.shape) == 2:
        axis = 0 if array.shape[0] != 1 else 1
        return Column(array.data, 0, axis=axis)
    return np.asarray(array.data).reshape(-1)


def _kept(channels: list[Channel], keep: tuple[str, ...]) -> list[Channel]:
    names = [c.name for c in channels]
    wanted = set(places_of(keep, names))
    special = {i for i, c in enumerate(channels) if is_tacho_name(c.name) or counts_turns(c.unit)}
    return [channels[i] for i in sorted(wanted | special)]
