"""The gate that a record passes before any number: damage found, what is done, what it may do.

Each finding is a notice: where, how much, what was done and what it may do to the result. Either
the stated uncertainty holds it, or the number is withheld with the reason.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.record import Channel, Notice, Record
from thermogear.signals.filters import without_trend
from thermogear.signals.quality import Damage, damages, filled

FILLED = 0.05
"""Largest share of a channel's samples that is filled in; above it the longest whole stretch is
used, or amplitudes are withheld."""

LEAST_RATE = 200.0
"""Samples a second below which no mesh line is sampled: the rate is taken for a shaft's."""

_SHORTEST = 256  # samples of a stretch
_LEAST_STRETCH = 0.1  # of the record
_PROPORTION = 20.0  # of a mean or trend to what vibrates
_UNSURE = 0.2  # of a filled share: how far its own line may differ from that of the rest


@dataclass(kw_only=True)
class Passed:
    """What came through: ``table`` (channel, sample) from sample ``start`` on, nothing missing.

    ``extra``: relative half width that damage adds to amplitudes, by channel (of withheld ones the
    share of samples that are damaged), ``clipped`` that part of it that counts in the
    channel's strongest line; ``withheld``: why a channel's amplitudes are.
    """

    channels: list[Channel]
    table: Floats
    start: int = 0
    findings: list[Notice] = field(default_factory=list)
    extra: dict[str, float] = field(default_factory=dict)
    clipped: dict[str, float] = field(default_factory=dict)
    withheld: dict[str, str] = field(default_factory=dict)

    @property
    def turned(self) -> float:
        """Half width that damage adds to a frequency, by the channel most damaged [cycles/sample].

        What is wrong of a line, e of its amplitude, turns its phase by e at most. Of all courses of
        that rms a straight one moves the frequency most: e sqrt(12)/(2 pi N).
        """
        return turned_by(max(self.extra.values(), default=0.0), samples=self.table.shape[-1])

    def cut(self, first: int, *, stop: int) -> None:
        """Keep samples ``first``..``stop`` of the table alone."""
        self.start += first
        self.table = self.table[:, first:stop]


def turned_by(share: float, *, samples: int) -> float:
    """Largest error of a line's frequency [cycles/sample] of N ``samples``, a ``share`` wrong.

    >>> f"{turned_by(0.01, samples=1000):.2e}"
    '5.51e-06'
    """
    return share * float(np.sqrt(12.0)) / (2.0 * np.pi * samples)


def require_sampling_rate(record: Record) -> None:
    """Refuse a rate so low that it may be a shaft's."""
    if record.rate is not None and record.rate < LEAST_RATE:
        fix = (
            "give the samples per second by --rate, the shaft's speed by --speed; if a time column "
            "counts milliseconds, name it 'time [ms]'"
        )
        raise InputError(
            "rate",
            f"{record.rate:g} samples/s",
            allowed=f">= {LEAST_RATE:g} samples/s for a mesh line",
            why=f"is {record.rate:g} the shaft's turns per second ({60 * record.rate:g} rpm)",
            fix=fix,
        )


def require_samples(record: Record) -> None:
    """Refuse a record in which no line can be told from its noise."""
    if record.samples < _SHORTEST:
        fix = f"record longer: {_SHORTEST} rows or more, one for each sample"
        got = f"{record.samples} sample{'s' if record.samples != 1 else ''} of {record.source}"
        raise InputError("record", got, allowed=f">= {_SHORTEST} samples", fix=fix)


def passed(channels: Sequence[Channel], longest: int) -> Passed:
    """The first ``longest`` samples of the channels through the gate.

    Up to FILLED of a channel's samples (missing, sentinels, zeros, held, spikes, clipped)
    are filled in by the channel's own strong lines. More missing: the longest whole stretch of all
    channels. More clipped: amplitudes are withheld.
    """
    count = len(channels[0])
    table = np.stack([c.values(0, stop=min(count, longest)) for c in channels])
    through = Passed(channels=list(channels), table=table)
    # spikes that are many are no spikes
    found = [
        [one for one in damages(x) if one.kind != "spikes" or one.count <= FILLED * x.size]
        for x in through.table
    ]
    gone = np.zeros(through.table.shape[-1], dtype=bool)
    for own in found:
        lost = _lost(own, gone.size)
        if np.mean(lost) > FILLED:
            gone |= lost
    first, stop = _longest(gone)
    least = max(_SHORTEST, int(_LEAST_STRETCH * gone.size))
    cut = bool(gone.any()) and stop - first >= least
    for place, (channel, own) in enumerate(zip(through.channels, found, strict=True)):
        whole = _Channel(through, place, channel, own)
        whole.repair((first, stop) if cut else None)
    if cut:
        through.cut(first, stop=stop)
    _proportions(through)
    return through


def _lost(own: Sequence[Damage], size: int) -> NDArray[np.bool_]:
    """Samples of which nothing is known."""
    kinds = [one.samples for one in own if one.kind in _GONE]
    return np.asarray(np.any([np.zeros(size, dtype=bool), *kinds], axis=0))


def _longest(gone: NDArray[np.bool_]) -> tuple[int, int]:
    edges = np.concatenate([[-1], np.flatnonzero(gone), [gone.size]])
    longest = int(np.argmax(np.diff(edges)))
    return int(edges[longest]) + 1, int(edges[longest + 1])


@dataclass
class _Channel:
    """One channel on its way through."""

    through: Passed
    place: int
    channel: Channel
    own: list[Damage]

    def repair(self, stretch: tuple[int, int] | None) -> None:
        """Fill, cut or withhold, and say so. ``stretch``: the samples that are kept, if cut."""
        values = self.through.table[self.place]
        inside = slice(*stretch) if stretch else slice(0, values.size)
        size = inside.stop - inside.start
        kept = [(one, int(np.count_nonzero(one.samples[inside]))) for one in self.own]
        total = sum(count for _, count in kept) / size
        # what alone is too much, or all that are too much together
        most = max((count for _, count in kept), default=0) / size
        missing = np.zeros(values.size, dtype=bool)
        withhold = self.through.withheld.get(self.channel.name, "")
        for one, count in kept:
            share = count / size
            if stretch and count == 0:
                self.through.findings.append(
                    Notice.of(
                        "damage_cut_away",
                        value=one.value,
                        stretch_first=stretch[0],
                        stretch_last=stretch[1] - 1,
                        **self.where(one),
                    )
                )
                continue
            if total <= FILLED or one.kind != "clipping":  # a number must stand there
                missing |= one.samples
            if total <= FILLED or most > FILLED >= share:
                continue
            withhold = withhold or f"{one.kind}, {100 * share:.2g} % of the samples"
            self.through.findings.append(
                Notice.of("amplitudes_withheld", value=one.value, **self.where(one))
            )
        if stretch:
            missing[: stretch[0]] = missing[stretch[1] :] = False
            outside = np.ones(values.size, dtype=bool)
            outside[inside] = False
            values = np.where(outside & ~np.isfinite(values), 0.0, values)
        if missing.any():
            limits = [
                (one.samples[inside], one.value)
                for one in self.own
                if one.kind == "clipping" and one.value is not None
            ]
            part, explained = filled(values[inside], missing[inside], limits)
            values = values.copy()
            values[inside] = part
            if not withhold:
                self.filled_in(kept, size, explained)
        self.through.table[self.place] = values
        if withhold:
            self.through.withheld[self.channel.name] = withhold
            self.add(self.through.extra, total)

    def add(self, shares: dict[str, float], own: float) -> None:
        """Add to the relative half width of the channel's amplitudes (``extra``), or to the part of
        it that counts in its strongest line (``clipped``)."""
        shares[self.channel.name] = shares.get(self.channel.name, 0.0) + own

    def filled_in(self, kept: Sequence[tuple[Damage, int]], size: int, explained: float) -> None:
        """What filled samples may do: the share that the channel's lines do not explain, and how
        far the line may change there; at a limit the samples are the line's own peaks, and the
        highest of them where sidebands make them so: what is wrong is wrong by a share of the
        strongest line, in every line alike."""
        extra = 0.0
        for one, count in kept:
            if not count:
                continue
            share = count / size * (2.0 if one.kind == "clipping" else 1.0)
            own = share * (_UNSURE + (1.0 - _UNSURE) * (1.0 - explained))
            extra += own
            clipped = one.kind == "clipping"
            if clipped:
                self.add(self.through.clipped, own)
            self.through.findings.append(
                Notice.of(
                    "clipping_filled_in" if clipped else "damage_filled_in",
                    adds=own,
                    value=one.value,
                    **self.where(one),
                )
            )
        self.add(self.through.extra, extra)

    def where(self, one: Damage) -> dict[str, Any]:
        """Which damage of which samples of the channel."""
        return {
            "channel": self.channel.name,
            "damage": one.kind,
            "samples": one.count,
            "share": one.count / one.samples.size,
            "first": one.first,
            "last": one.last,
        }


_GONE = ("missing", "sentinel", "zeros", "held")


def _proportions(through: Passed) -> None:
    """Means, and trends of more than the rms that vibrates, taken away; told where far larger."""
    for place, (channel, values) in enumerate(zip(through.channels, through.table, strict=True)):
        straight = without_trend(values)
        moving = float(np.std(straight))
        mean = float(np.mean(values))
        line = values[[0, -1]] - straight[[0, -1]]
        span = abs(float(line[1] - line[0]))
        through.findings += [
            Notice.of(
                "mean_taken_away" if name == "mean" else "trend_taken_away",
                channel=channel.name,
                ratio=size / moving,
            )
            for name, size in (("mean", abs(mean)), ("trend", span))
            if size > _PROPORTION * moving > 0.0
        ]
        through.table[place] = straight if span > moving else values - mean
