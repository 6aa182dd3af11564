"""From named arrays (MAT, NPZ, HDF5) to one record: which are channels, time, rate."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from thermogear.base.notice import catalogue
from thermogear.measured.contract import Stated, agreed, record_of_channels, stated_rate, timed
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Channel, Notice, Record, Samples
from thermogear.measured.traps import (
    SpeedFact,
    TimeBase,
    is_rate_name,
    is_step_name,
    is_time_name,
    speed_fact,
    split_unit,
)
from thermogear.measured.units import factor_of, kind_of, unit, unknown

MOST_CHANNELS = 512
"""Channels of one table."""
UNITS = ("unit", "units")
"""Names of fields and attributes that hold a unit."""
LONGEST_UNIT = 64
"""Bytes or characters of one."""
SHORTEST = 8  # samples: shorter arrays are parameters, not records


@dataclass(frozen=True)
class Named:
    """One stored array: 1-D or 2-D, in memory or on disk; ``attributes`` as the file has them.

    ``data`` a text: a variable of characters; None: an object of MATLAB, which is not read.
    """

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
    path: Path,
    kind: str,
    arrays: Sequence[Named],
    options: ReadOptions,
    groups: Mapping[str, dict[str, Any]],
) -> Record:
    """One record from a file's arrays; ``groups``: attributes of its groups, "" for the file.

    The longest arrays are the channels, shorter ones are left aside with a notice; an array
    named time gives the rate (if it states its unit), a number named fs, rate, ... likewise. What
    a structure or a group states of the rate is of its own channels. A rate told twice in two ways
    is used by neither.
    """
    contents = _Told()
    arrays = _with_units(arrays)
    for scope, facts in [*groups.items(), *((array.name, array.attributes) for array in arrays)]:
        for key, value in facts.items():
            contents.number(str(key), value, f"attribute {key}", scope=scope)
    for array in arrays:
        contents.array(array)
    asides = [Notice.of("complex_left_aside", arrays=contents.complex)] if contents.complex else []
    asides += [Notice.of("objects_left_aside", arrays=contents.objects)] if contents.objects else []
    if asides and not contents.channels:
        why = f"{asides[0].text}; no other array is as long as one"
        raise refused(path, kind, why, catalogue()[asides[0].code].to_do)
    contents.notes += asides
    if not contents.channels:
        raise refused(path, kind, "it holds no array of numbers as long as a record")
    units = [v for k, v in groups.get("", {}).items() if str(k).lower() in UNITS]
    of_all = unit(text_of(units[-1]) or "") if units else None
    if of_all is not None:
        contents.channels = [c if c.unit else replace(c, unit=of_all) for c in contents.channels]
    return record_of_channels(path, kind, contents.stated(), contents.notes, keep=options.keep)


@dataclass
class _Told:
    """What a file's arrays and attributes turn out to be; ``rates`` with the array, structure or
    group that each is of."""

    channels: list[Channel] = field(default_factory=list)
    rates: list[tuple[str, TimeBase]] = field(default_factory=list)
    speeds: list[SpeedFact] = field(default_factory=list)
    notes: list[Notice] = field(default_factory=list)
    complex: list[str] = field(default_factory=list)
    objects: list[str] = field(default_factory=list)

    def number(
        self, name: str, value: Any, origin: str, *, scope: str, said: str | None = None
    ) -> None:
        """A rate or a speed, where ``name`` says so and ``value`` is a number, of the unit ``said``
        where there is one."""
        number = number_of(value)
        if number is None or number <= 0:
            return
        if (fact := speed_fact(name, number, said)) is not None:
            self.speeds.append(fact)
            return
        rate = number * (factor_of(said) if said and kind_of(said) == "frequency" else 1.0)
        if is_step_name(name):
            rate, origin = 1.0 / max(number, 1e-300), f"{origin} (a step, in seconds)"
        elif not is_rate_name(name):
            return
        self.rates.append((scope, stated_rate(rate, origin, self.notes)))

    def array(self, array: Named) -> None:
        """A number, one channel or several, by its shape and name."""
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
        if array.data is None:
            self.objects.append(array.name)
        elif not sizes:
            value = array.data[()] if hasattr(array.data, "shape") else array.data
            origin = f"variable {array.name}"
            self.number(leaf, value, origin, scope=_parent(array.name), said=said)
        elif len(sizes) > 2 or max(sizes) < SHORTEST:
            return
        elif np.iscomplexobj(array.data):
            self.complex.append(array.name)
        elif len(sizes) == 1:
            self.channels.append(Channel(bare, _flat(array), said, strange=strange))
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

    def stated(self) -> list[Stated]:
        """The channels with the rates that are theirs: of what they are in, else of the file."""
        agreed_on: dict[tuple[str, ...], TimeBase] = {}
        stated = []
        for channel in self.channels:
            scopes = tuple(dict.fromkeys(s for s, _ in self.rates if _is_in(channel.name, s)))
            if scopes not in agreed_on:
                bases = [base for scope, base in self.rates if scope in scopes or not scopes]
                agreed_on[scopes] = agreed(bases, self.notes)
            stated.append(Stated(channel, agreed_on[scopes], speeds=tuple(self.speeds)))
        return timed(stated, self.notes)


def _with_units(arrays: Sequence[Named]) -> list[Named]:
    """The arrays with the units that their own structures state as texts; clocks and single numbers
    aside."""
    parted = [
        (*array.name.rpartition("."), array.data) for array in arrays if isinstance(array.data, str)
    ]
    units = {structure: text for structure, dot, leaf, text in parted
             if dot and leaf.lower() in UNITS and text}  # fmt: skip
    kept = []
    for array in arrays:
        if isinstance(array.data, str):
            continue
        structure, _, leaf = array.name.rpartition(".")
        label = units.get(structure)
        if label is not None and not is_time_name(leaf) and math.prod(array.shape) > 1:
            array = replace(array, attributes={"units": label} | array.attributes)
        kept.append(array)
    return kept


def _parent(name: str) -> str:
    """The structure or group that an array is in, "" for the file."""
    return re.sub(r"[./]?[^./]*$", "", name)


def _is_in(name: str, scope: str) -> bool:
    """Whether an array is the one named, or in the structure or group named; "" is the file."""
    return not scope or name == scope or name.startswith(tuple(scope + sign for sign in "./[{("))


def _flat(array: Named) -> Samples:
    if len(array.shape) == 1:
        return array.data  # type: ignore[no-any-return]
    if len(array.shape) == 2:
        axis = 0 if array.shape[0] != 1 else 1
        return Column(array.data, 0, axis=axis)
    return np.asarray(array.data).reshape(-1)
