"""From named arrays (MAT, NPZ, HDF5) to one record: which are channels, time, rate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, nearest
from thermogear.measured.options import ReadOptions, place_of, refused
from thermogear.measured.record import Channel, Notice, Record, Samples
from thermogear.measured.traps import (
    MOST_STAMPS,
    is_possible_rate,
    is_rate_name,
    is_tacho_name,
    is_time_name,
    read_time,
    split_unit,
    without_doubles,
)
from thermogear.measured.units import factor_of, kind_of, unit

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
    notes: list[Notice] = []
    rates: list[tuple[float, str]] = []
    unit_of_all: str | None = None
    for place in (common, *(a.attributes for a in arrays)):
        for key, value in place.items():
            number = number_of(value)
            if number is not None and number > 0 and is_rate_name(str(key)):
                rates.append((number, f"attribute {key}"))
            if str(key).lower() in ("unit", "units") and place is common:
                unit_of_all = unit(text_of(value) or "")
    channels: list[Channel] = []
    times: list[tuple[str, str | None, Named]] = []
    for array in arrays:
        bare, said = split_unit(array.name)
        leaf = bare.rsplit("/", 1)[-1].rsplit(".", 1)[-1]
        for key in ("units", "unit", "Unit", "Units", "unit_string"):
            said = said or unit(text_of(array.attributes.get(key)) or "")
        sizes = [n for n in array.shape if n != 1]
        if not sizes:
            number = number_of(array.data[()] if hasattr(array.data, "shape") else array.data)
            if number is not None and number > 0 and is_rate_name(leaf):
                factor = factor_of(said) if said and kind_of(said) == "frequency" else 1.0
                rates.append((number * factor, f"variable {array.name}"))
            continue
        if len(sizes) > 2 or max(sizes) < SHORTEST:
            continue
        if len(sizes) == 1:
            flat = _flat(array)
            if is_time_name(leaf):
                times.append((bare, said, Named(bare, flat, (sizes[0],))))
            else:
                channels.append(Channel(bare, flat, said))
            continue
        axis = 0 if sizes[0] >= sizes[1] else 1
        if min(sizes) > MOST_CHANNELS or len(array.shape) != 2:
            notes.append(Notice("warning", f"{array.name!r} of shape {array.shape} is left aside"))
            continue
        for index in range(min(sizes)):
            name = f"{bare}[{index + 1}]"
            channels.append(Channel(name, Column(array.data, index, axis=axis), said))
    if not channels:
        raise refused(path, kind, "it holds no array of numbers as long as a record")
    longest = max(len(c) for c in channels)
    aside = [c.name for c in channels if len(c) != longest]
    if aside:
        shown = ", ".join(aside[:5]) + (", ..." if len(aside) > 5 else "")
        notes.append(Notice("warning", f"shorter than {longest} samples, left aside: {shown}"))
    channels = [c for c in channels if len(c) == longest]
    if len(channels) > MOST_IN_ALL:
        raise refused(path, kind, f"{len(channels)} channels; allowed 1..{MOST_IN_ALL}")
    channels, doubled = without_doubles(channels, path.name)
    if options.keep:
        channels = _kept(channels, options.keep)
    start = 0.0
    for name, said, time in times:
        if time.shape[0] != longest:
            continue
        t = np.asarray(time.data[0 : min(longest, MOST_STAMPS)], dtype=float)
        if t.size < longest:
            notes.append(
                Notice("info", f"the rate is taken from the first {t.size} samples of {name!r}")
            )
        base = read_time(name, said, t)
        notes += base.notices
        start = base.start
        if base.rate is not None:
            rates.append((base.rate, base.origin))
        break
    if unit_of_all is not None:
        channels = [c if c.unit else Channel(c.name, c.samples, unit_of_all) for c in channels]
    rate, origin = agreed(rates, notes)
    tacho = next((c.name for c in channels if is_tacho_name(c.name)), None)
    return Record(tuple(channels), path.name, rate, origin, start, tacho, (*notes, *doubled))


def agreed(rates: list[tuple[float, str]], notes: list[Notice]) -> tuple[float | None, str]:
    """The one rate that every place in the file agrees on, else None with a notice."""
    for rate, origin in rates:
        if not is_possible_rate(rate):
            notes.append(Notice("important", f"{origin} says {rate:g} samples/s: it is not used"))
    rates = [one for one in rates if is_possible_rate(one[0])]
    if not rates:
        return None, ""
    rate, origin = rates[0]
    for other, where in rates[1:]:
        if abs(other / rate - 1.0) > 1e-3:
            notes.append(
                Notice(
                    "important",
                    f"{origin} says {rate:g} samples/s, {where} {other:g} (factor "
                    f"{rate / other:.4g}): neither is used (give --rate)",
                )
            )
            return None, ""
    notes.append(Notice("info", f"rate {rate:g} samples/s from {origin}"))
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
    wanted = set()
    for key in keep:
        if key in names:
            wanted.add(names.index(key))
        elif (place := place_of(key, len(names))) is not None:
            wanted.add(place)
        else:
            raise InputError("channel", repr(key), fix=nearest(key, names))
    special = {i for i, name in enumerate(names) if is_tacho_name(name)}
    return [channels[i] for i in sorted(wanted | special)]
