"""Samples in parts: pieces of stores one after another, and stretches of which nothing is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import Any

import numpy as np

from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Record, Samples


@dataclass(frozen=True)
class Part:
    """Samples ``first``..``stop`` of a store; a store of None: so many without a number."""

    samples: Any
    _: KW_ONLY
    first: int
    stop: int

    def __len__(self) -> int:
        return self.stop - self.first

    def values(self, start: int, *, stop: int) -> Any:
        if self.samples is None:
            return np.full(stop - start, np.nan)
        if isinstance(self.samples, Channel):
            return self.samples.values(self.first + start, stop=self.first + stop)
        return self.samples[self.first + start : self.first + stop]


class Joined:
    """Parts one after another, read slice by slice."""

    def __init__(self, parts: Sequence[Part]) -> None:
        self._parts = tuple(parts)
        self._edges = np.concatenate([[0], np.cumsum([len(one) for one in parts])]).tolist()

    def __len__(self) -> int:
        return int(self._edges[-1])

    def __getitem__(self, key: slice) -> Any:
        first, stop, step = key.indices(len(self))
        found = [
            np.asarray(part.values(max(first - edge, 0), stop=min(stop - edge, len(part))))
            for part, edge in zip(self._parts, self._edges, strict=False)
            if first < edge + len(part) and stop > edge
        ]
        return np.concatenate(found)[::step] if found else np.zeros(0)


def common_span(
    starts: Sequence[float], lengths: Sequence[int], *, rate: float | None
) -> tuple[float, list[int], int]:
    """The time that stretches of one rate have in common: its begin [s], how many samples of each
    lie before it, and how many are left of the shortest, 0 or less where there are none.

    ``starts`` [s] and ``lengths`` [samples] of the stretches; without a ``rate`` [1/s] all start
    together.
    """
    begin = max(starts)
    shifts = [0 if rate is None else round((begin - start) * rate) for start in starts]
    return begin, shifts, min(n - k for n, k in zip(lengths, shifts, strict=True))


def cut(channel: Channel, *, first: int, count: int) -> Channel:
    """The channel's ``count`` samples from ``first`` on."""
    if first == 0 and count == len(channel):
        return channel
    samples: Samples = Joined((Part(channel.samples, first=first, stop=first + count),))
    return replace(channel, samples=samples)


def later(record: Record, seconds: float) -> Record:
    """The record from so many ``seconds`` after its first sample on.

    Raises InputError where it has no rate or ends before.
    """
    if record.rate is None:
        raise InputError("start", f"{seconds:g} s", why="no rate is known", fix="give --rate")
    first = round(seconds * record.rate)
    if not 0 <= first < record.samples:
        length = record.samples / record.rate
        raise InputError("start", f"{seconds:g} s", allowed=f"0..{length:.6g} s")
    count = record.samples - first
    return replace(
        record,
        channels=tuple(cut(channel, first=first, count=count) for channel in record.channels),
        start=record.start + first / record.rate,
    )


def with_gaps(channel: Channel, gaps: Sequence[tuple[int, int]]) -> Channel:
    """The channel with samples without a number put in: (before which sample, how many)."""
    parts: list[Part] = []
    first = 0
    for place, missing in gaps:
        parts += [Part(channel.samples, first=first, stop=place), Part(None, first=0, stop=missing)]
        first = place
    parts.append(Part(channel.samples, first=first, stop=len(channel)))
    samples: Samples = Joined([one for one in parts if len(one)])
    return replace(channel, samples=samples)
