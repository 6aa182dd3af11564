"""One record: channels with their units, the rate where it is known, and what was noticed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import FULL_SCALE, RATE
from thermogear.base.errors import InputError, printable
from thermogear.base.notice import Notice as Notice
from thermogear.measured.options import no_tacho, places_of
from thermogear.measured.units import UNITS, factor_of, kind_of, known_unit

OTHER = {"time", "speed", "torque", "temperature", "angle", "frequency"}
"""Kinds of quantity that are no vibration."""
_MOST_RPM = 1e9  # in one unit of a speed channel

BLOCK = 1 << 20
"""Samples read at once from a channel that stays on disk."""


def _keep_printable(thing: object, *names: str) -> None:
    """Texts of a foreign file as they may leave the program: :func:`printable`."""
    for name in names:
        object.__setattr__(thing, name, printable(getattr(thing, name)))


class Samples(Protocol):
    """What a channel needs of its store: an array in memory, a memory map, a stored data set."""

    def __len__(self) -> int:
        """How many samples."""

    def __getitem__(self, key: slice, /) -> Any:
        """Some of them."""


@dataclass(frozen=True)
class Channel:
    """One signal: ``unit`` a known name or None (the file does not say), ``samples`` its store.

    A value is ``scale`` x sample + ``offset`` in ``unit``. ``file``: of a run that lies in several
    files the one it is from. ``strange``: what the file states as the unit and is none known.
    """

    name: str
    samples: Samples = field(repr=False)
    unit: str | None = None
    _: KW_ONLY
    scale: float = 1.0
    offset: float = 0.0
    needs_scale: bool = False  # integer full scale: a unit alone does not calibrate it
    file: str = ""
    strange: str = ""

    def __post_init__(self) -> None:
        _keep_printable(self, "name", "file", "strange")

    def __len__(self) -> int:
        return len(self.samples)

    def values(self, start: int = 0, *, stop: int | None = None) -> NDArray[np.float64]:
        """Samples start..stop in the channel's own unit, as floats."""
        raw = np.asarray(self.samples[start : len(self) if stop is None else stop], dtype=float)
        return raw if self.scale == 1.0 and self.offset == 0.0 else raw * self.scale + self.offset

    def blocks(self, size: int = BLOCK) -> Iterator[NDArray[np.float64]]:
        """The whole channel block by block: no more than ``size`` samples in memory."""
        for start in range(0, len(self), size):
            yield self.values(start, stop=min(start + size, len(self)))

    @property
    def si_factor(self) -> float:
        """SI units in one of the channel's; refused when the unit is unknown."""
        if self.unit is None:
            raise InputError(
                f"channel {self.name!r}.unit",
                "none",
                why="the file states no unit and none is guessed",
                fix="give it, for example --unit g or --unit m/s^2",
            )
        if self.needs_scale:
            raise InputError(
                f"channel {self.name!r}.scale",
                "none",
                why=f"samples are fractions of full scale, so {self.unit} alone does not "
                "calibrate them",
                fix=f"give --scale, the {self.unit} at full scale",
            )
        return factor_of(self.unit)


@dataclass(frozen=True)
class Record:
    """Channels sampled together. ``rate`` [samples/s] is None where the file does not tell it.

    ``rate_origin`` says where the rate is from; ``start`` [s] is the time of the first sample;
    ``tacho`` names the tacho channel; ``notices`` are the traps met while reading; ``rate_doubt``:
    what contradicts the rate; ``rate_half_width`` [samples/s] of its 95 % interval, 0 where it is
    stated, ``rate_note``: how well time stamps tell it, and their ``jitter`` [rms, steps].
    ``speed`` [rad/s] of a shaft that the file states;
    ``per_turn`` [samples/turn] where they are taken at even angles; ``others``:
    what the same file holds at other rates or times.
    """

    channels: tuple[Channel, ...]
    source: str
    rate: float | None = None
    rate_origin: str = ""
    start: float = 0.0
    tacho: str | None = None
    notices: tuple[Notice, ...] = ()
    rate_doubt: str = ""
    rate_half_width: float = 0.0
    rate_note: str = ""
    jitter: float = 0.0
    per_turn: float | None = None
    speed: float | None = None
    others: tuple[Record, ...] = ()

    def __post_init__(self) -> None:
        _keep_printable(self, "source", "rate_origin", "rate_doubt", "rate_note")
        if not self.channels:
            raise InputError("record", self.source, why="it holds no channel of numbers")
        lengths = {len(c) for c in self.channels}
        if len(lengths) != 1:
            raise InputError("record", f"channels of {sorted(lengths)} samples", allowed="one")
        if self.rate is not None:
            RATE.require("rate", self.rate)
            object.__setattr__(self, "rate", float(self.rate))
        if self.tacho is not None:
            self.channel(self.tacho)

    @property
    def rate_share(self) -> float:
        """Half width of the rate's 95 % interval over the rate; 0 while it is unknown."""
        return 0.0 if self.rate is None else self.rate_half_width / self.rate

    @property
    def samples(self) -> int:
        """Samples of each channel."""
        return len(self.channels[0])

    @property
    def names(self) -> tuple[str, ...]:
        """Channel names in the file's order."""
        return tuple(c.name for c in self.channels)

    def channel(self, name: str | int) -> Channel:
        """A channel by name, or by its number counted from 1."""
        (place,) = places_of([str(name)], self.names)
        return self.channels[place]

    def vibrating(self) -> tuple[Channel, ...]:
        """The channels that are not the tacho, time, speed, torque or temperature; may be none."""
        return tuple(
            c
            for c in self.channels
            if c.name != self.tacho and (c.unit is None or kind_of(c.unit) not in OTHER)
        )

    def signals(self) -> tuple[Channel, ...]:
        """The vibration channels, of which there must be one."""
        found = self.vibrating()
        if not found and replace(self, tacho=None).vibrating():
            why = "no other channel is left to read"
            raise InputError("tacho", self.tacho, why=why, fix="name another, or leave it out")
        if not found:
            raise InputError(
                "channel", ", ".join(self.names), why="none of them is a vibration", fix="--channel"
            )
        return found

    def _with_tacho(self, tacho: str | int) -> Record:
        others = tuple(
            replace(other, tacho=str(tacho) if tacho in other.names else None)
            for other in self.others
        )
        if any(other.tacho for other in others):
            return replace(self, tacho=None, others=others)
        try:
            named = self.channel(tacho).name
        except InputError as error:
            raise no_tacho(error) from error
        return replace(self, tacho=named)

    def supplied(
        self,
        rate: float | None = None,
        unit: str | None = None,
        scale: float | None = None,
        tacho: str | int | None = None,
    ) -> Record:
        """The record with what the file lacks. What the file states and the user contradicts is
        kept as the user says, with an important notice."""
        record = self if tacho is None else self._with_tacho(tacho)
        if rate is not None:
            RATE.require("rate", rate)
            if self.rate is not None and abs(rate / self.rate - 1.0) > 1e-3 + self.rate_share:
                record = record.noting(
                    Notice.of(
                        "rate_given_differs",
                        given=rate,
                        stated=self.rate,
                        origin=self.rate_origin,
                        ratio=rate / self.rate,
                    )
                )
                text = f"{rate:g}/s is given, the file says {self.rate:g}/s"
                record = replace(record, rate_doubt=text)
            record = replace(
                record, rate=float(rate), rate_origin="given", rate_half_width=0.0, rate_note=""
            )
        if unit is not None or scale is not None:
            name = None if unit is None else known_unit(unit)
            if name is not None and kind_of(name) in OTHER:
                why = f"it counts {kind_of(name)}, which does not vibrate"
                raise InputError("unit", repr(unit), why=why, fix=f"one of {UNITS}")
            vibrating = {c.name for c in record.signals()}
            new, contradicted = [], []
            for c in record.channels:
                if c.name in vibrating:
                    if name is not None and c.unit not in (None, name):
                        contradicted.append(c)
                    c = replace(c, unit=name or c.unit)
                    if scale is not None:
                        FULL_SCALE.require("scale", abs(scale))
                        c = replace(
                            c,
                            scale=c.scale * float(scale),
                            offset=c.offset * float(scale),
                            needs_scale=False,
                        )
                new.append(c)
            record = replace(record, channels=tuple(new))
            if contradicted:
                record = record.noting(
                    Notice.of(
                        "unit_replaced",
                        given=name,
                        channels=[c.name for c in contradicted],
                        units=[c.unit for c in contradicted],
                    )
                )
        return record

    def with_speed(self, name: str, rpm: float) -> Record:
        """The record with the channel ``name`` as a speed, ``rpm`` in one of its units."""
        if not 0.0 < rpm <= _MOST_RPM:
            got = f"{rpm:g} rpm"
            fix = "give the rpm in one unit of the channel, as 300 for 300 rpm/V"
            raise InputError("tacho_scale", got, allowed=f"> 0 .. {_MOST_RPM:g} rpm", fix=fix)
        speed = self.channel(name)
        scaled = replace(speed, unit="rpm", scale=speed.scale * rpm, offset=speed.offset * rpm)
        return replace(self, channels=tuple(scaled if c is speed else c for c in self.channels))

    def noting(self, notice: Notice) -> Record:
        """The record with one more notice."""
        return replace(self, notices=(*self.notices, notice))
