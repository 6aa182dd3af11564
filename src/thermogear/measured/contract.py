"""What a file states of each channel, the same for every format, and the record made of it.

Every reader states of a channel its samples, its time base, what its x axis counts, its unit as
written, how many samples the file promises and whether its scaling was applied; what the file does
not state stays None or empty. :func:`record_of_channels` alone joins them: channels of one time
base stand side by side, cut to the time that they have in common; lost samples become samples
without a number; those of another time base are kept beside as records of their own.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from pathlib import Path

import numpy as np

from thermogear.base.errors import InputError
from thermogear.measured.choosing import is_time_column, time_column
from thermogear.measured.options import places_of, refused
from thermogear.measured.parts import common_span, cut, with_gaps
from thermogear.measured.record import OTHER, Channel, Notice, Record
from thermogear.measured.traps import (
    MOST_STAMPS,
    SpeedFact,
    TimeBase,
    is_possible_rate,
    is_tacho_name,
    longest_even,
    without_doubles,
)
from thermogear.measured.units import counts_turns, kind_of

MOST_IN_ALL = 4096
"""Channels of a whole file."""
UNSTATED = TimeBase(rate=None, start=0.0, origin="")
"""The time base of a channel of which the file states none."""
_LEAF = re.compile(r"[./]?[^./]*$")
"""The name of a channel in its structure or group, with the sign before it."""
_SAME = 1e-3  # relative difference of two statements of one rate
_OVERLAP = 0.5  # of the longer of two channels, from which they are cut to their common time


@dataclass(frozen=True)
class Stated:
    """What a file states of one ``channel``: its time ``base`` and what its x ``axis`` counts
    (time, angle, frequency or another quantity; of an angle the base counts samples per turn).

    ``count``: samples promised, None where the file does not say; ``unscaled``: the scaling that
    the file asks for is not known here, so that the samples are the converter's numbers;
    ``block``: which of several under one header; ``speeds`` of a shaft that the file states.
    """

    channel: Channel
    base: TimeBase = UNSTATED
    _: KW_ONLY
    axis: str = "time"
    count: int | None = None
    unscaled: bool = False
    block: int = 1
    speeds: tuple[SpeedFact, ...] = ()


def agreed(bases: Sequence[TimeBase], notices: list[Notice]) -> TimeBase:
    """The time base that all places of a file agree on: the rate best known, start, gaps and
    jitter of the stamps. Rates that differ by more than 0.1 % and their half widths are used by
    none."""
    stamped = next((base for base in bases if base.by_stamps), UNSTATED)
    notes = tuple(notice for base in bases for notice in base.notices)
    unsaid = replace(stamped, rate=None, origin="", half_width=0.0, note="", notices=notes)
    known = [base for base in bases if base.rate is not None]
    if not known:
        return unsaid if stamped.by_stamps or notes else UNSTATED
    best = known[0]
    for other in known[1:]:
        rate, second = best.rate or np.nan, other.rate or np.nan
        if abs(second / rate - 1.0) > _SAME + (best.half_width + other.half_width) / rate:
            notices.append(
                Notice.of(
                    "rate_stated_twice",
                    origin=best.origin,
                    rate=rate,
                    other_origin=other.origin,
                    other_rate=second,
                    ratio=rate / second,
                )
            )
            return unsaid
        if other.by_stamps and max(best.half_width, abs(second - rate)) > other.half_width:
            best = other
    if not stamped.by_stamps:
        return replace(best, notices=notes)
    return replace(
        stamped,
        rate=best.rate,
        origin=best.origin,
        half_width=best.half_width,
        note=best.note,
        notices=notes,
    )


def stated_rate(rate: float, origin: str, notices: list[Notice]) -> TimeBase:
    """The time base by a ``rate`` [1/s] that a file states; one that no converter has is told."""
    if is_possible_rate(rate):
        return TimeBase(rate=rate, start=0.0, origin=origin)
    notices.append(Notice.of("rate_impossible", origin=origin, rate=rate))
    return UNSTATED


def timed(stated: Sequence[Stated], notices: list[Notice]) -> list[Stated]:
    """The channels without the times among them, which give their base to those as long as they in
    the same structure or group, else in the whole file."""
    leaves = [_LEAF.search(signal.channel.name)[0] for signal in stated]  # type: ignore[index]
    times = [
        i
        for i, signal in enumerate(stated)
        if is_time_column(leaves[i].strip("./"), signal.channel.unit)
    ]
    known = any(signal.base.rate is not None for signal in stated)
    by_times: dict[tuple[int, ...], TimeBase] = {}
    # what all channels of one base share is agreed on once
    settled: dict[tuple[int, tuple[int, ...]], TimeBase] = {}
    signals = []
    for place, signal in enumerate(stated):
        if place in times:
            continue
        same = [i for i in times if len(stated[i].channel) == len(signal.channel)]
        parent = signal.channel.name.removesuffix(leaves[place])
        in_group = [i for i in same if stated[i].channel.name == parent + leaves[i]]
        those = tuple(in_group or same)
        if those not in by_times:
            by_times[those] = _by_time([stated[i].channel for i in those], known, notices)
        key = id(signal.base), those
        if key not in settled:
            settled[key] = agreed([signal.base, by_times[those]], notices) if those else signal.base
        signals.append(replace(signal, base=settled[key]))
    return signals


def _by_time(times: Sequence[Channel], known: bool, notices: list[Notice]) -> TimeBase:
    """The time base by the best of several times; a rate may be ``known`` from elsewhere."""
    best = time_column(
        [(_LEAF.search(c.name)[0].strip("./"), c.unit, c.samples) for c in times]  # type: ignore[index]
    )
    if best is None:
        return UNSTATED
    time = times[best]
    t = np.asarray(time.samples[0 : min(len(time), MOST_STAMPS)], dtype=float)
    if t.size < len(time):
        notices.append(Notice.of("rate_of_first_rows", rows=t.size, column=time.name))
    if len(times) > 1:
        notices.append(Notice.of("several_time_columns", columns=len(times), used=time.name))
    return longest_even(time.name, time.unit, t, stated=known)


def record_of_channels(
    path: Path,
    kind: str,
    stated: Sequence[Stated],
    notices: Sequence[Notice] = (),
    *,
    keep: tuple[str, ...] = (),
) -> Record:
    """The record of the channels ``stated`` in the file ``path`` of this ``kind``.

    It holds those that are sampled together with the first to ``keep``, else with the longest that
    may vibrate; those at another rate, or mostly at another time, are in ``Record.others``.

    Raises InputError where no channel is left.
    """
    notes = list(notices)
    of_time = [
        signal for signal in stated if signal.axis != "frequency" and len(signal.channel) > 0
    ]
    spectra = [signal.channel.name for signal in stated if signal.axis == "frequency"]
    if spectra and not of_time:
        why = f"it holds spectra, as {spectra[0]!r}, and no samples over time"
        raise refused(path, kind, why, "export the time record that they were computed from")
    if not 0 < len(of_time) <= MOST_IN_ALL:
        why = f"{len(of_time)} channels; allowed 1..{MOST_IN_ALL}" if of_time else (
            "it holds no channel of numbers"
        )  # fmt: skip
        raise refused(path, kind, why)
    if spectra:
        notes.append(Notice.of("spectra_left_aside", channels=spectra))
    if any(signal.count is not None and signal.count > len(signal.channel) for signal in of_time):
        notes.append(Notice.of("data_cut_off"))
    notes += [notice for signal in of_time for notice in signal.base.notices]
    raw = [signal.channel.name for signal in of_time if signal.unscaled]
    if raw:
        notes.append(Notice.of("scaling_not_applied", channels=raw))
    of_time = [_as_read(signal) for signal in of_time]
    channels, doubled = without_doubles([signal.channel for signal in of_time], path.name)
    by_samples = {id(signal.channel.samples): signal for signal in of_time}
    of_time = [replace(by_samples[id(c.samples)], channel=c) for c in channels]
    kept, first = _kept(of_time, keep)
    groups = _groups(kept)
    chosen = next((g for g in groups if first in g), None) or max(groups, key=_weight)
    record = _joined(path, chosen, notes)
    speed = _speed_of(stated, notes)
    others = [g for g in groups if g is not chosen and _own_time(g[0], chosen[0])]
    _tell_of_rest(groups, chosen, others, notes)
    return replace(
        record,
        notices=tuple(dict.fromkeys((*notes, *doubled))),
        others=tuple(_joined(path, group, []) for group in others),
        speed=speed,
    )


def _speed_of(stated: Sequence[Stated], notes: list[Notice]) -> float | None:
    """The one speed of a shaft [rad/s] that a file states; what is not used is told."""
    facts = dict.fromkeys(fact for signal in stated for fact in signal.speeds)
    notes += [
        Notice.of("speed_without_unit", name=fact.name, value=fact.value)
        for fact in facts
        if fact.speed is None
    ]
    known = {fact.speed: fact.name for fact in facts if fact.speed is not None}
    if len(known) > 1:
        notes.append(Notice.of("speeds_stated", names=[*known.values()], speeds=[*known]))
        return None
    return next(iter(known), None)


def _as_read(signal: Stated) -> Stated:
    """The channel between pauses, lost samples put in; of one not scaled the unit is withheld."""
    channel = signal.channel
    if signal.base.stretch is not None:
        first, stop = signal.base.stretch
        channel = cut(channel, first=first, count=stop - first)
    if signal.base.gaps:
        channel = with_gaps(channel, signal.base.gaps)
    if signal.unscaled:
        channel = replace(channel, needs_scale=True, unit=None)
    return replace(signal, channel=channel)


def _kept(stated: list[Stated], keep: tuple[str, ...]) -> tuple[list[Stated], Stated | None]:
    """The channels to keep, what tells a shaft's angle with them; and the first that is named."""
    if not keep:
        return stated, None
    places = places_of(keep, [signal.channel.name for signal in stated])
    wanted = {*places, *(i for i, signal in enumerate(stated) if _tells_angle(signal.channel))}
    return [signal for i, signal in enumerate(stated) if i in wanted], stated[places[0]]


def _tells_angle(channel: Channel) -> bool:
    return is_tacho_name(channel.name) or counts_turns(channel.unit)


def _groups(stated: list[Stated]) -> list[list[Stated]]:
    """Channels that were sampled together: of one rate and mostly at one time.

    One of which the file states no time joins the first group as long as it.
    """
    groups: list[list[Stated]] = []
    for signal in sorted(stated, key=lambda each: each.base is UNSTATED):
        group = next((g for g in groups if _together(g[0], signal)), None)
        if group is None:
            groups.append([signal])
        else:
            group.append(signal)
    order = {id(signal): place for place, signal in enumerate(stated)}
    return [sorted(group, key=lambda each: order[id(each)]) for group in groups]


def _together(first: Stated, second: Stated) -> bool:
    bases, lengths = (first.base, second.base), (len(first.channel), len(second.channel))
    if second.base is UNSTATED or first.base is second.base:
        return lengths[0] == lengths[1] and first.block == second.block
    if first.axis != second.axis or first.block != second.block:
        return False
    if bases[0].rate is None or bases[1].rate is None:
        return bases[0] == bases[1] and lengths[0] == lengths[1]
    unsure = sum(base.half_width for base in bases) / bases[0].rate
    if (abs(bases[1].rate / bases[0].rate - 1.0) - unsure) * max(lengths) > 0.5:
        return False  # they drift apart by half a sample
    _, _, count = common_span([base.start for base in bases], lengths, rate=bases[0].rate)
    return count >= _OVERLAP * max(lengths)


def _weight(group: list[Stated]) -> tuple[bool, int]:
    """What ranks groups: whether one of the channels may vibrate, then how long they are."""
    vibrates = any(
        not is_tacho_name(c.name) and (c.unit is None or kind_of(c.unit) not in OTHER)
        for c in (signal.channel for signal in group)
    )
    return vibrates, len(group[0].channel)


def _own_time(signal: Stated, chosen: Stated) -> bool:
    """Whether a channel left out of the record has a time base of its own."""
    known = signal.base.rate is not None and signal.axis == "time"
    return known and signal.base is not chosen.base and signal.block == chosen.block


def _tell_of_rest(
    groups: list[list[Stated]],
    chosen: list[Stated],
    others: list[list[Stated]],
    notes: list[Notice],
) -> None:
    """Say which channels are not in the record, and why."""
    rest = [signal for g in groups if g is not chosen and g not in others for signal in g]
    blocks = [signal for signal in rest if signal.block != chosen[0].block]
    aside = [signal.channel.name for signal in rest if signal.block == chosen[0].block]
    if blocks:
        notes.append(
            Notice.of(
                "several_blocks",
                read=chosen[0].block,
                samples=len(chosen[0].channel),
                channels=[signal.channel.name for signal in blocks],
            )
        )
    if aside:
        longest = len(chosen[0].channel)
        notes.append(Notice.of("shorter_left_aside", samples=longest, channels=aside))
    if others:
        notes.append(
            Notice.of(
                "channels_of_own_time",
                channels=[signal.channel.name for g in others for signal in g],
                rates=[g[0].base.rate for g in others],
            )
        )


def _joined(path: Path, group: list[Stated], notes: list[Notice]) -> Record:
    """One record of channels sampled together, cut to the time that they have in common."""
    base = next((signal.base for signal in group if signal.base is not UNSTATED), UNSTATED)
    channels = [signal.channel for signal in group]
    starts = [base.start if signal.base is UNSTATED else signal.base.start for signal in group]
    begin, shifts, count = common_span(starts, [len(c) for c in channels], rate=base.rate)
    if count < 1:
        why = f"its channels have no time in common, as {channels[0].name!r} with the others"
        raise InputError("file", path.name, why=why, fix="name channels of one time by --channel")
    if any(shifts):
        notes.append(Notice.of("cut_to_common_start", samples=max(shifts)))
    short = min(channels, key=len)
    long = max(channels, key=len)
    if len(short) < len(long):
        more = len(long) - len(short)
        notes.append(Notice.of("cut_to_shortest", file=short.name, longest=long.name, samples=more))
    angle = group[0].axis == "angle" and base.rate is not None
    if angle:
        notes.append(Notice.of("x_is_angle", channel=channels[0].name, per_turn=base.rate))
    elif group[0].axis != "time":
        notice = Notice.of("step_is_no_time", dimension=group[0].axis, channel=channels[0].name)
        notes.append(notice)
    timely = base if group[0].axis == "time" else UNSTATED
    return Record(
        tuple(cut(c, first=shift, count=count) for c, shift in zip(channels, shifts, strict=True)),
        path.name,
        timely.rate,
        timely.origin,
        begin if timely is base else 0.0,
        next((c.name for c in channels if is_tacho_name(c.name)), None),
        rate_half_width=timely.half_width,
        rate_note=timely.note,
        jitter=timely.jitter,
        per_turn=base.rate if angle else None,
    )
