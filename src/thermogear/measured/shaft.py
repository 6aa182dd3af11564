"""The angle of a shaft through a record: by tacho pulses, by a speed channel, by a line's phase."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.measured.gate import Passed
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.traps import is_tacho_name
from thermogear.measured.units import counts_turns, kind_of
from thermogear.signals.orders import resample_by_angle, rising_edges
from thermogear.signals.tacho import Pulses, numbered, pulse_turns, speed_turns
from thermogear.signals.tracking import (
    LINES,
    Tracked,
    paths,
    samples_per_turn,
    sharpness,
    track,
)

VARIES = 1.03
"""Highest over lowest speed from which a record is read slice by slice."""

_AS_SHARP = 0.8  # of the sharpness before: then a line's own phase is as good an angle
_MOST_NOISE = 0.05  # cycles: of a phase with more no line is followed, but noise
_LEAST_PART = 0.2  # of the record, that an angle must cover to be used
_SHARPER = 1.3  # times more power in the strongest lines: then an angle is believed
_LEAST_SHARP = 0.05
_NARROW = 0.25  # of the whole range, between the percentiles: less is beside the pulses


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """``turns`` of a shaft at samples ``first`` on of the stretch, with rms ``noise`` [turns].

    ``line``: the turns are cycles of a line that was tracked and no shaft's; ``origin`` says by
    what, ``channel`` by which, where one says it (``by_speed``: as a speed); ``sure``: pulses per
    turn are known, ``pulses`` those given. ``told`` what should be known of it.
    """

    turns: Floats
    first: int
    noise: float
    origin: str
    channel: str | None = None
    by_speed: bool = False
    line: bool = False
    sure: bool = True
    pulses: float | None = None
    told: tuple[Notice, ...] = ()

    @property
    def speeds(self) -> tuple[float, float]:
        """Lowest and highest speed [turns/sample], of means over hundredths of the record."""
        marks = np.linspace(0, self.turns.size - 1, min(101, self.turns.size // 2)).astype(int)
        speeds = np.diff(self.turns[marks]) / np.diff(marks)
        return float(speeds.min()), float(speeds.max())

    @property
    def span(self) -> float:
        """Highest over lowest speed."""
        low, high = self.speeds
        return high / max(low, 1e-300)


def given_shaft(
    record: Record,
    *,
    samples: int,
    start: int,
    pulses_per_turn: float | None,
    tacho: Record | None = None,
) -> Shaft | None:
    """The shaft's angle by what the record, or another ``tacho`` record, has for it.

    First pulses (the tacho channel), then a channel of speed. What is there and cannot be used is
    told: then ``turns`` is empty. None where there is nothing.
    """
    if record.per_turn is not None:
        turns = (start + np.arange(samples)) / record.per_turn
        return Shaft(turns=turns, first=0, noise=0.0, origin="the x axis, an angle")
    if record.rate is None:
        return None
    told: list[Notice] = []
    for source, channel, speed in _sources(record, tacho):
        if source.rate is None:
            told.append(Notice.of("tacho_without_rate", channel=channel.name))
            continue
        at = start / record.rate + (record.start - source.start if source is not record else 0.0)
        try:
            found = (
                _by_speed(channel, source.rate, record.rate, samples, at)
                if speed
                else _by_pulses(channel, source.rate, record.rate, samples, at, pulses_per_turn)
            )
        except InputError as error:
            told.append(
                Notice.of(
                    "tacho_not_used",
                    channel=channel.name,
                    reason=str(error),
                    unit=None if speed else _unit_if_speed(channel),
                )
            )
            continue
        if found.turns.size < _LEAST_PART * samples:
            share = found.turns.size / samples
            told.append(Notice.of("tacho_too_short", channel=channel.name, share=share))
            continue
        if source is tacho:
            told.append(
                Notice.of(
                    "tacho_by_start_times"
                    if record.start or source.start
                    else "tacho_starts_together",
                    file=source.source,
                )
            )
        return replace(found, told=(*told, *found.told, *_missing(found, samples)))
    if not told:
        return None
    return Shaft(turns=np.zeros(0), first=0, noise=0.0, origin="", told=tuple(told))


def usable_shaft(
    record: Record,
    through: Passed,
    *,
    pulses_per_turn: float | None,
    tacho: Record | None,
    notices: list[Notice],
) -> Shaft | None:
    """:func:`given_shaft` over what came ``through`` the gate, None where nothing is of use: why
    goes to ``notices``."""
    shaft = given_shaft(
        record,
        samples=through.table.shape[-1],
        start=through.start,
        pulses_per_turn=pulses_per_turn,
        tacho=tacho,
    )
    if shaft is None and pulses_per_turn is not None:
        notices.append(Notice.of("pulses_without_tacho", given=pulses_per_turn))
    if shaft is not None and not shaft.turns.size:
        notices += shaft.told
        return None
    return shaft


def _sources(record: Record, tacho: Record | None) -> list[tuple[Record, Channel, bool]]:
    """(record, channel, whether it is a speed) of everything that may tell the angle."""
    found: list[tuple[Record, Channel, bool]] = []
    for one in (tacho, record, *record.others):
        if one is None:
            continue
        speeds = [c for c in one.channels if _is_speed(c)]
        named = [one.channel(one.tacho)] if one.tacho is not None else []
        if one is tacho and not named and not speeds:
            named = [c for c in one.channels if is_tacho_name(c.name)] or [one.channels[0]]
        found += [(one, c, _is_speed(c)) for c in named]
        found += [(one, c, True) for c in speeds if c not in named]
    return found


def _is_speed(channel: Channel) -> bool:
    return counts_turns(channel.unit)


def _unit_if_speed(channel: Channel) -> str | None:
    """The unit of a channel without pulses that may be a speed, None of any other."""
    may_be = channel.unit is None or kind_of(channel.unit) == "voltage"
    return (channel.unit or "unit") if may_be else None


def _missing(shaft: Shaft, samples: int) -> list[Notice]:
    if shaft.turns.size >= 0.98 * samples:
        return []
    last = shaft.first + shaft.turns.size - 1
    return [Notice.of("angle_incomplete", first=shaft.first, last=last, samples=samples)]


def _by_pulses(
    channel: Channel,
    own: float,
    rate: float,
    samples: int,
    at: float,
    pulses_per_turn: float | None,
) -> Shaft:
    values = channel.values()
    good = np.isfinite(values)
    if not good.any():
        raise InputError("tacho", "no number at all", allowed="a signal with pulses")
    pulses = _counted(np.where(good, values, np.nanmin(values)), own)
    turns = pulse_turns(pulses, pulses_per_turn or 1.0, rate=rate, samples=samples, start=at)
    told = []
    if pulses.lost or pulses.extra or pulses.aside:
        told.append(
            Notice.of(
                "pulses_lost",
                channel=channel.name,
                pulses=pulses.times.size,
                lost=pulses.lost,
                extra=pulses.extra,
                aside=pulses.aside,
            )
        )
    return Shaft(
        turns=turns.turns,
        first=turns.first,
        noise=turns.noise,
        origin=f"tacho {channel.name!r}",
        channel=channel.name,
        sure=pulses_per_turn is not None,
        pulses=pulses_per_turn,
        told=tuple(told),
    )


def _counted(values: Floats, rate: float) -> Pulses:
    """The pulses through the level midway between percentiles, or between the extremes.

    Pulses narrower than the percentiles see none of are far higher than what these see; so is a
    single spike, through whose level nothing else goes.
    """
    low, high = float(values.min()), float(values.max())
    levels = None, 0.5 * (low + high)
    tried = [rising_edges(values, rate=rate, level=level) for level in levels]
    if np.ptp(np.percentile(values, [2.0, 98.0])) < _NARROW * (high - low):
        tried.reverse()
    for times in tried:
        with suppress(InputError):
            return numbered(times, grain=1.0 / rate)
    return numbered(max(tried, key=len), grain=1.0 / rate)


def _by_speed(channel: Channel, own: float, rate: float, samples: int, at: float) -> Shaft:
    values = channel.values()
    if not np.all(np.isfinite(values)):
        raise InputError("speed", "gaps", allowed="finite samples")
    turns = speed_turns(
        np.abs(values) * channel.si_factor,
        rate=own,
        samples=samples,
        sample_rate=rate,
        start=at,
    )
    return Shaft(
        turns=turns.turns,
        first=turns.first,
        noise=turns.noise,
        origin=f"speed channel {channel.name!r}",
        channel=channel.name,
        by_speed=True,
    )


def locked(shaft: Shaft, table: Floats, teeth: int | None) -> Shaft:
    """The shaft of a speed channel, its angle corrected by the phase of the mesh line of the
    ``teeth`` given.

    A speed is read with errors that add up over the turns. Where the line at that order can be
    followed by its own phase, that phase is the angle, and how far the speed channel reads off is
    told; not where noise is followed, or lines become less sharp.
    """
    inside = table[:, shaft.first : shaft.first + shaft.turns.size]
    rough = shaft.turns
    before = _sharp_by(inside[0], rough)
    cycles = rough * teeth if teeth else rough[:0]
    tracked = [track(channel, cycles=cycles) for channel in inside[:2]] if teeth else []
    best = max(filter(None, tracked), key=lambda line: line.sharp, default=None)
    clear = best is not None and best.noise < _MOST_NOISE and best.sharp >= _AS_SHARP * before
    if teeth is None or best is None or not clear:
        rough_angle = Notice.of("angle_as_sharp_as_speed", channel=shaft.channel)
        return replace(shaft, told=(*shaft.told, rough_angle))
    corrected = Notice.of(
        "speed_corrected",
        channel=shaft.channel,
        off=(rough[-1] - rough[0]) * teeth / best.cycles[-1] - 1.0,
        order=float(teeth),
        lines=LINES,
        share=best.sharp,
        share_before=before,
    )
    return replace(
        shaft,
        turns=best.cycles / teeth,
        noise=best.noise / teeth,
        told=(*shaft.told, corrected),
    )


def _sharp_by(values: Floats, turns: Floats) -> float:
    per_turn = samples_per_turn(turns)
    return sharpness(resample_by_angle(values, turns, samples_per_turn=per_turn))


def tracked_shaft(table: Floats) -> Shaft | None:
    """A line that runs through the spectrum as the angle, where it makes the spectrum sharp.

    Paths of a line with harmonics are looked for in all channels together; each is followed by
    its phase in the channel in which it is clearest, and the one that puts most power into few
    lines is taken, if that is more than without it.
    """
    best: Tracked | None = None
    ends = 0, table.shape[-1]
    loudest = table[np.argsort(-np.std(table, axis=-1))[:2]]
    for path in paths(table):
        if path.span < VARIES or path.height < 1.0:
            continue
        cycles = path.cycles(table.shape[-1])
        for channel in loudest:
            found = track(channel, cycles=cycles)
            if found is None or found.span < VARIES:
                continue
            if found.sharp >= max(_SHARPER * found.blunt, _LEAST_SHARP) and (
                best is None or found.sharp > best.sharp
            ):
                ends, best = (int(path.at[1]), int(path.at[-2]) + 1), found
        if best is not None:
            break
    if best is None:
        return None
    told = Notice.of("speed_tracked", lines=LINES, share=best.sharp, share_in_time=best.blunt)
    # near its ends a path is less sure: a frame of each is left out
    cycles = best.cycles[ends[0] : ends[1]]
    shaft = Shaft(
        turns=cycles - cycles[0],
        first=ends[0],
        noise=best.noise,
        origin="the tracked line",
        line=True,
    )
    return replace(shaft, told=(told, *_missing(shaft, table.shape[-1])))
