"""Files of one run as one record: each file some of its channels, or a piece of its time."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from thermogear.base.errors import InputError, nearest
from thermogear.measured.options import place_of
from thermogear.measured.parts import Joined, Part, common_span, cut
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.units import counts_turns

JOINS = ("channels", "time")
SIGN = "::"
"""Between a file and a channel of it: ``left.csv::a1``."""

MOST = 10_000
"""Files that are named at once."""
_CUT = 0.01  # of the longest file: a shorter one within it lost its last block
_LONGEST_GAP = 1.0  # of the samples of all pieces


def join_records(records: Sequence[Record], how: str, *, names: Sequence[str] = ()) -> Record:
    """One record of those of ``names`` (default: their sources), as they follow one another.

    ``how`` "channels": each file holds channels of one run, at one rate; files that start apart
    by their time stamps, or are up to 1 % shorter than the longest, are cut to the time they have
    in common. A name that two files have becomes ``FILE::CHANNEL``.
    ``how`` "time": consecutive pieces of one run in the order given, with the same channels, units
    and rate. Where time stamps go on from file to file they are checked: a gap becomes
    samples without a number, which the gate finds
    (:mod:`~thermogear.measured.gate`).

    Raises InputError for fewer than two records, for one that is named twice, for rates that
    drift apart by half a sample, lengths, channels or units that differ, pieces that overlap or
    lie further apart than all are long.
    """
    if how not in JOINS:
        raise InputError("join", repr(how), allowed=" or ".join(JOINS))
    if len(records) < 2:
        raise InputError("join", f"{len(records)} record", allowed="two files or more of one run")
    paths = [Path(name) for name in names or [one.source for one in records]]
    require_once(paths)
    files = shown_names(paths)
    rate = _one_rate(records, files)
    join = _channels if how == "channels" else _pieces
    found = join(records, files, rate)
    doubt = next((one.rate_doubt for one in records if one.rate_doubt), "")
    return replace(found, notices=(*_merged(records, files), *found.notices), rate_doubt=doubt)


def files_of(named: Sequence[str | Path]) -> list[Path]:
    """The files that are named, and of every directory those in it, by name, numbers counted:
    r2 before r10.

    Raises InputError for none, for more than 10 000, for one that is named twice.
    """
    found: list[Path] = []
    for one in map(Path, named):
        if one.is_dir():
            inside = [p for p in one.iterdir() if p.is_file() and not p.name.startswith(".")]
            found += sorted(inside, key=_counted)
        else:
            found.append(one)
    if not found:
        where = ", ".join(map(str, named))
        raise InputError("file", where, why="no file is in it", fix="name files, or their folder")
    if len(found) > MOST:
        raise InputError("file", f"{len(found)} files", allowed=f"1..{MOST}")
    require_once(found)
    return found


def _counted(path: Path) -> tuple[list[tuple[int, str]], str]:
    """Sorts names by their numbers."""
    parts = re.split(r"([0-9]+)", path.name)
    number = [(int(part[:18]), "") if k % 2 else (0, part) for k, part in enumerate(parts)]
    return number, path.name


def require_once(files: Sequence[Path]) -> None:
    """Refuse a file that is named twice."""
    twice = [str(path) for path, count in Counter(files).items() if count > 1]
    if twice:
        raise InputError("file", twice[0], why="it is named twice", fix="name every file once")


def shown_names(files: Sequence[Path]) -> list[str]:
    """The files' names, with their folders where two are alike."""
    alike = len({file.name for file in files}) < len(files)
    return [str(file) if alike else file.name for file in files]


def _merged(records: Sequence[Record], files: Sequence[str]) -> list[Notice]:
    """The records' notices with the files of each; what several files have is told once."""
    places: dict[Notice, list[str]] = {}
    for file, record in zip(files, records, strict=True):
        for notice in dict.fromkeys(record.notices):
            places.setdefault(notice, []).append(file)
    return [notice.of_files(those) for notice, those in places.items()]


def _one_rate(records: Sequence[Record], files: Sequence[str]) -> float | None:
    """The rate of all; those that drift apart by half a sample are refused."""
    first = records[0].rate
    for file, one in zip(files[1:], records[1:], strict=True):
        if first is None and one.rate is None:
            continue
        known = [rate for rate in (first, one.rate) if rate is not None]
        if len(known) == 1:
            mute = file if one.rate is None else files[0]
            why = f"it states no rate, {files[0] if mute == file else file} states {known[0]:g}/s"
            raise InputError("file", mute, why=why, fix=f"--rate {known[0]:g} if that is its own")
        unsure = records[0].rate_share + one.rate_share
        if (abs(known[1] / known[0] - 1.0) - unsure) * max(one.samples, records[0].samples) > 0.5:
            raise InputError(
                "file",
                file,
                why=f"its rate is {known[1]:g}/s, that of {files[0]} {known[0]:g}/s",
                fix="leave it out, or resample it first (a tacho may have a rate of its own: "
                "--tacho FILE)",
            )
    return first


# --- files that are channels ---------------------------------------------------------------------


def _channels(records: Sequence[Record], files: Sequence[str], rate: float | None) -> Record:
    """Every file's channels side by side, over the time that all files have."""
    notes: list[Notice] = []
    begin, shifts, count = common_span(
        [one.start for one in records], [one.samples for one in records], rate=rate
    )
    left = [one.samples - shift for one, shift in zip(records, shifts, strict=True)]
    if count < 2:
        place = int(np.argmin(left))
        last = files[int(np.argmax([one.start for one in records]))]
        raise InputError(
            "file",
            files[place],
            why=f"by its time stamps it ends before {last} starts",
            fix="leave one out, or join pieces with --join time",
        )
    if any(shifts):
        notes.append(Notice.of("cut_to_common_start", samples=max(shifts)))
    most = max(left)
    if count < most:
        short, long = files[left.index(count)], files[left.index(most)]
        if count < (1.0 - _CUT) * most:
            raise InputError(
                "file",
                short,
                why=f"it holds {records[files.index(short)].samples} samples, {long} "
                f"{records[files.index(long)].samples}: channels of one run are equally long",
                fix="leave it out, or join pieces with --join time",
            )
        notes.append(Notice.of("cut_to_shortest", file=short, longest=long, samples=most - count))
    names = Counter(c.name for one in records for c in one.channels)
    channels: list[Channel] = []
    tacho = None
    for file, one, shift in zip(files, records, shifts, strict=True):
        for c in one.channels:
            name = c.name if names[c.name] == 1 else f"{file}{SIGN}{c.name}"
            channels.append(replace(cut(c, first=shift, count=count), name=name, file=file))
            if tacho is None and c.name == one.tacho:
                tacho = name
    origin = next((one.rate_origin for one in records if one.rate is not None), "")
    notes.insert(0, Notice.of("joined_as_channels", files=len(files)))
    return Record(
        tuple(channels),
        _source(files),
        rate,
        origin,
        begin,
        tacho=tacho,
        notices=tuple(notes),
        rate_half_width=records[0].rate_half_width,
        rate_note=records[0].rate_note,
        jitter=max(one.jitter for one in records),
        others=tuple(other for one in records for other in one.others),
    )


def _source(files: Sequence[str]) -> str:
    return f"{files[0]} and {len(files) - 1} more" if len(files) > 2 else " and ".join(files)


# --- files that are pieces of time ---------------------------------------------------------------


def _pieces(records: Sequence[Record], files: Sequence[str], rate: float | None) -> Record:
    """The pieces one after another, gaps between them as samples without a number."""
    first = records[0]
    for file, one in zip(files, records, strict=True):
        _require_alike(first, one, files[0], file)
    gaps, notes = _gaps(records, files, rate)
    parts: dict[str, list[Part]] = {name: [] for name in first.names}
    for gap, one in zip(gaps, records, strict=True):
        for name, own in parts.items():
            if gap:
                own.append(Part(None, first=0, stop=gap))
            own.append(Part(one.channel(name), first=0, stop=one.samples))
    channels = tuple(
        replace(c, samples=Joined(parts[c.name]), scale=1.0, offset=0.0) for c in first.channels
    )
    notes.insert(0, Notice.of("joined_as_pieces", files=len(files)))
    return replace(first, channels=channels, source=_source(files), notices=tuple(notes))


def _require_alike(first: Record, one: Record, leading: str, file: str) -> None:
    """Refuse a piece with other channels or units than the first."""
    lacks, has = (sorted(set(a) - set(b)) for a, b in
                  ((first.names, one.names), (one.names, first.names)))  # fmt: skip
    if lacks or has:
        why = f"it has no channel {lacks[0]!r}, {leading} has" if lacks else (
            f"it has a channel {has[0]!r}, {leading} has not"
        )  # fmt: skip
        fix = "name the channels that all pieces hold with --channel, or --join channels"
        raise InputError("file", file, why=why, fix=fix)
    for c in first.channels:
        unit = one.channel(c.name).unit
        if unit != c.unit:
            raise InputError(
                "file",
                file,
                why=f"channel {c.name!r} is in {unit or 'no known unit'}, in {leading} in "
                f"{c.unit or 'no known unit'}",
                fix="leave it out, or give --unit for all",
            )


def _gaps(
    records: Sequence[Record], files: Sequence[str], rate: float | None
) -> tuple[list[int], list[Notice]]:
    """Samples that are missing before each piece, by time stamps that go on; what to say."""
    gaps = [0] * len(records)
    starts = [one.start for one in records]
    if rate is None or len(set(starts)) == 1:
        return gaps, [Notice.of("pieces_without_time")]
    notes: list[Notice] = []
    total = sum(one.samples for one in records)
    for k in range(1, len(records)):
        end = starts[k - 1] + records[k - 1].samples / rate
        lost = (starts[k] - end) * rate
        if lost < -0.5:
            raise InputError(
                "file",
                files[k],
                why=f"it starts at {starts[k]:.9g} s, before {files[k - 1]} ends ({end:.9g} s)",
                fix="name the pieces in their order",
            )
        if lost > _LONGEST_GAP * total:
            raise InputError(
                "file",
                files[k],
                why=f"it starts {lost / rate:.4g} s after {files[k - 1]} ends, longer than all "
                "pieces together",
                fix="these are records of their own: leave out --join",
            )
        gaps[k] = max(0, round(lost))
        if gaps[k]:
            notes.append(
                Notice.of(
                    "samples_missing_between",
                    samples=gaps[k],
                    time=gaps[k] / rate,
                    before=files[k - 1],
                    after=files[k],
                )
            )
    if not any(gaps):
        notes.append(Notice.of("pieces_without_gap"))
    return gaps, notes


# --- channels by name ----------------------------------------------------------------------------


def only(record: Record, wanted: Sequence[str]) -> Record:
    """A joined record with the ``wanted`` channels (:func:`named`), its tacho and its speeds."""
    names = {name for key in wanted for name in named(record, key)}
    kept = tuple(
        c
        for c in record.channels
        if c.name in names or c.name == record.tacho or counts_turns(c.unit)
    )
    return replace(record, channels=kept)


def named(record: Record, key: str) -> list[str]:
    """The names of the channels of a joined record that ``key`` means.

    ``key``: a name, ``FILE::CHANNEL`` with the channel's name or its number in that file, ``FILE``
    for all channels of a file, or a number from 1 over all files. Refused where it means none,
    or the channels of several files.
    """
    if key in record.names:
        return [key]
    file, sign, own = key.rpartition(SIGN)
    if sign:
        here = _of_file(record, file)
        if not here:
            files = list(dict.fromkeys(c.file for c in record.channels if c.file))
            raise InputError(
                "channel", repr(key), why=f"no file is {file}", fix=nearest(file, files)
            )
        found = [c.name for c in here if own_name(c) == own]
        place = place_of(own, len(here))
        if not found and place is not None:
            found = [here[place].name]
        if not found:
            fix = nearest(own, [own_name(c) for c in here])
            raise InputError("channel", repr(key), why=f"{file} has no {own}", fix=fix)
        return found
    if here := _of_file(record, key):
        return [c.name for c in here]
    found = [c.name for c in record.channels if own_name(c) == key]
    if len(found) > 1:
        text = f"{len(found)} files have it"
        raise InputError("channel", repr(key), why=text, fix=f"{found[0]}, or another of them")
    return found or [record.channel(key).name]


def own_name(channel: Channel) -> str:
    """A channel's name in its own file."""
    return channel.name.removeprefix(f"{channel.file}{SIGN}") if channel.file else channel.name


def _of_file(record: Record, file: str) -> list[Channel]:
    """The channels of the file that is named, with its folder or without."""
    exact = [c for c in record.channels if c.file and c.file == file]
    return exact or [c for c in record.channels if c.file and Path(c.file).name == Path(file).name]
