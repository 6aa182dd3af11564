"""From files and options to measurements: one record, or one run in several files."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from thermogear.base.errors import InputError, nearest
from thermogear.base.progress import Progress
from thermogear.base.units import RPM

if TYPE_CHECKING:
    from thermogear.measured.diagnosis import InAngle
    from thermogear.measured.record import Record
    from thermogear.measured.reduction import Measurement
    from thermogear.study.diagnosis import Source

SIGN = "::"


def measured_by(file: str, options: dict[str, Any]) -> Measurement:
    """One file with the options of the command."""
    return _reduced(*read_by(file, options), options)


def read_by(file: str, options: dict[str, Any]) -> tuple[Record, Record | None]:
    """One file by the options that supply what it does not state, and the file of ``--tacho``."""
    from thermogear.measured.readers import read_record

    named, most = options["tacho"], _limit(options)
    _apart(options)
    other = None if named is None else tacho_file(named, options["decimal"], most)
    record = read_record(
        file,
        rate=options["rate"],
        unit=options["unit"],
        scale=options["scale"],
        channels=options["channels"],
        tacho=None if other else named,
        decimal=options["decimal"],
        limit=most,
    )
    if options["tacho_scale"] is not None:
        return _as_speed(record, other, options["tacho_scale"])
    return record, other


def in_angles(
    records: Sequence[str], baseline: Sequence[str], teeth: int, options: dict[str, Any]
) -> tuple[list[Source], list[Source]]:
    """What reads each record, and each of a baseline, into the angle of a pinion of so many teeth;
    files or folders of them, of which none may be in both."""
    from thermogear.measured.joined import files_of

    if not records:
        raise InputError("RECORD", "none", fix="name a record to hold against the baseline")
    tested, healthy = files_of(records), files_of(baseline) if baseline else []
    resolved = {file.resolve() for file in healthy}
    for file in tested:
        if file.resolve() in resolved:
            why = "the record is in the baseline that it is held against"
            raise InputError("--baseline", file.name, why=why, fix="leave it out of one")
    return tuple(
        [(file.name, partial(_in_angle, str(file), teeth, options)) for file in files]
        for files in (tested, healthy)
    )  # type: ignore[return-value]


def _in_angle(file: str, teeth: int, options: dict[str, Any]) -> InAngle:
    """A file in the angle of its pinion."""
    from thermogear.measured.diagnosis import in_angle

    record, other = read_by(file, options)
    speed = options["speed"]
    return in_angle(
        record,
        channels=options["channels"],
        teeth=teeth,
        speed=None if speed is None else speed * RPM,
        pulses_per_turn=options["pulses"],
        tacho=other,
    )


def measured_among(file: str | Path, options: dict[str, Any]) -> Measurement:
    """One of several records: of its channels those that ``--channel`` names here.

    ``FILE::CHANNEL`` is said of that file alone; a file of which nothing is named is refused.
    """
    wanted = options["channels"]
    known = ("", Path(file).name, str(file))
    here = [own for place, own in map(_parted, wanted) if place in known]
    if wanted and not here:
        raise InputError("--channel", wanted[0], why="it names no channel of this file")
    return measured_by(str(file), {**options, "channels": tuple(here)})


def measured_run(
    files: Sequence[Path], how: str, options: dict[str, Any], progress: Progress
) -> Measurement:
    """The files of one run, joined ``how`` "channels" or "time"."""
    from thermogear.measured.joined import join_records, named, only

    _apart(options)
    if len(files) < 2:
        why = "there is one file" if files else "there is no file"
        raise InputError("--join", how, why=why, fix="name the files of the run, or leave it out")
    records, other = _read_all(files, how, options, progress)
    record = join_records(list(records.values()), how, names=[str(file) for file in records])
    record = record.supplied(None, None, options["scale"])
    tacho = options["tacho"]
    if tacho is not None and other is None:
        found = named(record, tacho)
        if len(found) > 1:
            fix = f"--tacho {tacho}{SIGN}CHANNEL"
            raise InputError("--tacho", tacho, why=f"it has {len(found)} channels", fix=fix)
        record = record.supplied(tacho=found[0])
    if options["channels"] and how == "channels":
        record = only(record, options["channels"])
    if options["tacho_scale"] is not None:
        record, other = _as_speed(record, other, options["tacho_scale"])
    return _reduced(record, other, options)


def _read_all(
    files: Sequence[Path], how: str, options: dict[str, Any], progress: Progress
) -> tuple[dict[Path, Record], Record | None]:
    """The records by file; and of ``--tacho FILE`` what does not join: a file beside them, or
    one of them whose rate is another."""
    from thermogear.measured.readers import read_record

    most, decimal, named = _limit(options), options["decimal"], options["tacho"]
    place = "" if named is None else named.rpartition(SIGN)[0] or named
    records: dict[Path, Record] = {}
    keep = list(options["channels"]) if how == "time" else []
    if keep and named is not None and not Path(place).is_file():
        keep.append(named)
    for number, file in enumerate(files):
        try:
            one = read_record(file, channels=keep, decimal=decimal, limit=most)
            own = _is_named(file, place) and one.rate is not None
            one = one.supplied(None if own else options["rate"])
            if options["unit"] is not None and one.vibrating():
                one = one.supplied(None, options["unit"])
        except InputError as error:
            if error.field == "file":
                raise
            raise InputError("file", file.name, why=str(error)) from error
        records[file] = one
        progress("files", number + 1, len(files))
    if named is None:
        return records, None
    tachos = [file for file in files if _is_named(file, place)]
    if not tachos:
        return records, tacho_file(named, decimal, most)
    rates = {one.rate for file, one in records.items() if file not in tachos}
    if how == "time" or records[tachos[0]].rate in rates or len(records) < 3:
        return records, None
    del records[tachos[0]]
    return records, tacho_file(f"{tachos[0]}{SIGN}{_parted(named)[1]}" if SIGN in named
                               else str(tachos[0]), decimal, most)  # fmt: skip


def _is_named(file: Path, place: str) -> bool:
    return bool(place) and (file == Path(place) or file.name == place)


def _parted(key: str) -> tuple[str, str]:
    """File and channel of ``FILE::CHANNEL``; a channel alone has no file."""
    place, _, own = key.rpartition(SIGN)
    return place, own


def require_channels(files: Sequence[Path], channels: Sequence[str]) -> None:
    """Refuse ``--channel FILE::CHANNEL`` of a file that is not among those that are named."""
    known = {file.name for file in files} | {str(file) for file in files}
    for key in channels:
        place = _parted(key)[0]
        if place and place not in known:
            fix = nearest(place, [file.name for file in files])
            raise InputError("--channel", repr(key), why=f"no file is {place}", fix=fix)


def measured_files(
    named: Sequence[str], join: str | None, options: dict[str, Any], report: Progress
) -> Measurement:
    """One record, or the files of one run that are joined; more that are not are refused."""
    from thermogear.measured.joined import files_of

    files = files_of(named)
    if join is not None:
        require_channels(files, options["channels"])
        return measured_run(files, join, options, report)
    if len(files) > 1:
        why = "each is a record of its own"
        fix = "give --join for one run in several files; diagnose --baseline compares records"
        raise InputError("file", f"{len(files)} files", allowed="one record", why=why, fix=fix)
    return measured_by(str(files[0]), options)


def _reduced(record: Record, other: Record | None, options: dict[str, Any]) -> Measurement:
    from thermogear.measured.chain import Chain
    from thermogear.measured.parts import later
    from thermogear.measured.reduction import measure as reduce
    from thermogear.study.bearing_rates import bearing_rates

    speed = options["speed"]
    if options.get("start") is not None:
        record = later(record, options["start"])
    return reduce(
        record,
        teeth=options["teeth"],
        speed=None if speed is None else speed * RPM,
        chain=Chain(options["method"]),
        sensor_tolerance=options["sensor_tolerance"],
        pulses_per_turn=options["pulses"],
        tacho=other,
        orders=options["orders"],
        bearings=bearing_rates(options["bearings"]),
        harmonics=3 if options["harmonics"] is None else options["harmonics"],
        sidebands=2 if options["sidebands"] is None else options["sidebands"],
    )


def _apart(options: dict[str, Any]) -> None:
    """Refuse a channel that is to be read and to be its own tacho."""
    if options["tacho"] is not None and options["tacho"] in options["channels"]:
        why = "--channel names it as well"
        raise InputError("--tacho", options["tacho"], why=why, fix="name another channel")


def _as_speed(record: Record, other: Record | None, rpm: float) -> tuple[Record, Record | None]:
    """The records with the tacho, this one's or the ``other``'s, as a speed."""
    if other is not None:
        return record, other.with_speed(other.tacho or other.names[0], rpm)
    if record.tacho is None:
        why = "no tacho is named"
        raise InputError("--tacho-scale", f"{rpm:g} rpm", why=why, fix="--tacho CHANNEL")
    return record.with_speed(record.tacho, rpm), None


def _limit(options: dict[str, Any]) -> int | None:
    from thermogear.measured.options import bytes_of_gibibytes

    return None if options["limit"] is None else bytes_of_gibibytes(options["limit"])


def tacho_file(named: str, decimal: str | None, limit: int | None) -> Record | None:
    """The record that ``--tacho FILE`` or ``FILE::CHANNEL`` names; None: a channel's name."""
    from thermogear.measured.readers import read_record

    place, sign, channel = named.rpartition(SIGN)
    file = Path(place if sign else named)
    if not file.is_file():
        if sign:
            raise InputError("--tacho", repr(named), why=f"there is no file {place}")
        return None
    return read_record(file, tacho=channel if sign else None, decimal=decimal, limit=limit)
