"""Several records: what changed against a baseline beyond its uncertainty, and trends."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.measured.at_once import Row, rows_of
from thermogear.measured.joined import require_once, shown_names
from thermogear.measured.reduction import Measurement
from thermogear.measured.same_line import ALIKE, Turns, compare
from thermogear.results.result import Notice, Result, now

MOST = 10_000
_HALF = 1.959964
_Value = TypeVar("_Value")
_REASONS = 3  # files that a refusal tells of


@dataclass(frozen=True, kw_only=True)
class Several:
    """Lines of records: ``reading`` (record, line) with ``half_width`` of its 95 % interval, nan
    where a record has no such line; ``keys`` (channel, name) of the lines; ``refused`` why a file
    gave none; ``withheld`` why readings of a record are, and what damage was ``found`` in it, where
    there is any; ``baseline`` the record that others are compared with.
    ``same`` (record, line): whether it is the baseline's line, which its name alone does not say;
    ``apart`` why it is not, by record; ``turns`` what is known of a record's speed, ``ratio`` how
    many times as fast as the baseline it turns (nan: not known)."""

    names: tuple[str, ...]
    keys: tuple[tuple[str, str], ...]
    reading: Floats
    half_width: Floats
    baseline: int
    refused: tuple[tuple[str, str], ...]
    unit: str
    withheld: tuple[tuple[str, str], ...] = ()
    found: tuple[tuple[str, tuple[Notice, ...]], ...] = ()
    same: NDArray[np.bool_]
    apart: tuple[tuple[str, Notice], ...] = ()
    turns: tuple[Turns, ...]
    ratio: Floats

    @property
    def change(self) -> Floats:
        """(reading - baseline)/baseline, (record, line); nan where it is another line."""
        return np.where(self.same, self.reading / self.reading[self.baseline] - 1.0, np.nan)

    @property
    def change_half_width(self) -> Floats:
        """Half width of its 95 % interval: both readings' intervals, as independent."""
        base = self.reading[self.baseline]
        own = self.half_width / base
        ratio = self.reading / base * self.half_width[self.baseline] / base
        return np.where(self.same, np.hypot(own, ratio), np.nan)

    @property
    def beyond(self) -> NDArray[np.bool_]:
        """Whether a line changed by more than that."""
        found = np.abs(self.change) > self.change_half_width
        found[self.baseline] = False
        return np.asarray(found)

    def trends(self) -> tuple[Floats, Floats]:
        """Relative change from record to record by a weighted straight line, and the half width of
        its 95 % interval, the scatter about the line counted in; nan for fewer than three."""
        slope, half = (np.full(len(self.keys), np.nan) for _ in range(2))
        base = self.reading[self.baseline]
        for k in range(len(self.keys)):
            known = np.isfinite(self.reading[:, k]) & self.same[:, k]
            good = np.flatnonzero(known & (self.half_width[:, k] > 0.0))
            if good.size < 3 or not np.isfinite(base[k]):
                continue
            y = self.reading[good, k] / base[k]
            weight = (base[k] / (self.half_width[good, k] / _HALF)) ** 2
            x = good - np.average(good, weights=weight)
            spread = float(np.sum(weight * x**2))
            slope[k] = float(np.sum(weight * x * y)) / spread
            left = y - np.average(y, weights=weight) - slope[k] * x
            scatter = max(1.0, float(np.sum(weight * left**2)) / (good.size - 2))
            half[k] = _HALF * float(np.sqrt(scatter / spread))
        return slope, half


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


def several(
    files: Sequence[Path],
    read: Callable[[Path], Measurement],
    baseline: str = "first",
    *,
    cores: int = 1,
    progress: Progress = silent,
) -> Several:
    """Measure ``files`` by ``read``; a file that is refused is told and left out.

    ``baseline``: "first", "last", or the name of a file. Readings are in each record's own unit;
    records of another unit than the baseline's are refused. A line is compared where it is the
    baseline's (:mod:`~thermogear.measured.same_line`). Raises InputError where none is left to
    compare with the baseline. ``cores``: processes to measure in;
    with more than one ``read`` must be a function that a new process can import, and a script
    needs its ``if __name__ == "__main__":``.
    """
    shown = shown_names(files)
    if baseline not in ("first", "last") and _place(baseline, files, shown) is None:
        fix = nearest(baseline, [*shown, "first", "last"])
        raise InputError("--baseline", baseline, allowed="first, last or one of the files", fix=fix)
    rows = rows_of(read, files, cores=cores, progress=progress)
    names = dict(zip(files, shown, strict=True))
    refused = [(names[row.file], row.refused) for row in rows if row.refused]
    good = [row for row in rows if not row.refused]
    if not good:
        raise InputError("file", refused[0][0], why=f"no record could be read: {refused[0][1]}")
    place = {"first": 0, "last": len(good) - 1}.get(baseline)
    if place is None:
        place = _place(baseline, [row.file for row in good], [names[row.file] for row in good])
    if place is None:
        why = dict(refused)[shown[_place(baseline, files, shown) or 0]]
        raise InputError("--baseline", baseline, why=f"it could not be read: {why}")
    unit = good[place].unit
    kept = [row for row in good if row.unit == unit]
    refused += [
        (
            names[row.file],
            f"its unit is {row.unit or 'unknown'}, the baseline's {unit or 'unknown'}",
        )
        for row in good
        if row.unit != unit
    ]
    kept = [_named_as(row, good[place]) for row in kept]
    withheld = tuple((names[row.file], row.withheld) for row in kept if row.withheld)
    keys = tuple(dict.fromkeys(key for row in kept for key in row.readings))
    blank = (float("nan"), float("nan"))
    table = np.array([[row.readings.get(key, blank) for key in keys] for row in kept])
    table = table.reshape(len(kept), len(keys), 2)
    both = np.isfinite(table[kept.index(good[place]), :, 0]) & np.isfinite(table[..., 0])
    if int(np.sum(both.any(axis=1))) < 2:
        lost = [*refused, *((name, f"readings are withheld: {why}") for name, why in withheld)]
        raise _nothing_compared(names[good[place].file], lost, len(files))
    first = kept.index(good[place])
    compared = [compare(row.places, kept[first].places, keys) for row in kept]
    return Several(
        names=tuple(names[row.file] for row in kept),
        keys=keys,
        reading=table[..., 0],
        half_width=table[..., 1],
        baseline=first,
        same=np.array([one.same for one in compared], dtype=bool).reshape(len(kept), len(keys)),
        apart=tuple(
            (names[row.file], told)
            for row, one in zip(kept, compared, strict=True)
            if (told := one.told(names[row.file], names[good[place].file])) is not None
        ),
        turns=tuple(one.turns for one in compared),
        ratio=np.array([one.ratio for one in compared]),
        refused=tuple(refused),
        unit=unit,
        withheld=withheld,
        found=tuple((names[row.file], row.found) for row in kept if row.found),
    )


def _named_as(row: Row, base: Row) -> Row:
    """The row with its harmonics named as those of the baseline: whether they are the same lines
    their places tell."""
    names = dict(zip(row.harmonics, base.harmonics, strict=False))

    def renamed(values: dict[tuple[str, str], _Value]) -> dict[tuple[str, str], _Value]:
        named = {}
        for (channel, name), value in values.items():
            line, sign, side = name.partition(" - " if " - " in name else " + ")
            named[channel, names.get(line, line) + sign + side] = value
        return named

    return replace(row, readings=renamed(row.readings), places=renamed(row.places))


def _nothing_compared(baseline: str, refused: Sequence[tuple[str, str]], files: int) -> InputError:
    """No other record has a line of the baseline: why."""
    why = "; ".join(f"{name} is left out: {reason}" for name, reason in refused[:_REASONS])
    why += f"; and {len(refused) - _REASONS} more" if len(refused) > _REASONS else ""
    return InputError(
        "file",
        f"{files} file{'s' if files != 1 else ''}",
        allowed="two records or more with a line of the same channel and name",
        why=f"nothing can be compared with {baseline}" + (f": {why}" if why else ""),
        fix="name records of one unit whose channels are named alike, or one file alone; channels "
        "of one run are read by --join channels",
    )


def _place(baseline: str, files: Sequence[Path], shown: Sequence[str]) -> int | None:
    """The place of the file that is named: by path, else by name where one alone has it."""
    if Path(baseline) in files:
        return list(files).index(Path(baseline))
    name = Path(baseline).name
    found = [k for k, file in enumerate(files) if name == file.name or baseline == shown[k]]
    return found[0] if len(found) == 1 else None


def result_of_several(found: Several) -> Result:
    """The table as a labelled dataset, what changed as figures, refusals as notices."""
    axes = ("record", "line")
    slope, half = found.trends()
    data = label(
        {
            "record_line_reading": (axes, found.reading),
            "record_line_half_width": (axes, found.half_width),
            "record_line_change": (axes, found.change),
            "record_line_change_half_width": (axes, found.change_half_width),
            "record_line_beyond": (axes, found.beyond.astype(float)),
            "record_line_trend": (("line",), slope),
            "record_line_trend_half_width": (("line",), half),
            "record_mesh_frequency": (
                ("record",),
                np.array([one.hertz for one in found.turns]),
                "Hz",
                "mesh line found",
            ),
            "record_shaft_speed": (
                ("record",),
                np.array([one.shaft for one in found.turns]),
                "rad/s",
                "speed of the first shaft",
            ),
        }
    ).assign_coords(
        record=list(found.names),
        channel=("line", [channel for channel, _ in found.keys]),
        name=("line", [name for _, name in found.keys]),
    )
    notices = [Notice.of("record_left_out", record=name, reason=why) for name, why in found.refused]
    notices += [
        Notice.of("readings_withheld", record=name, reason=why) for name, why in found.withheld
    ]
    damaged = [name for name, _ in found.found if name not in dict(found.withheld)]
    if damaged:
        notices.append(
            Notice.of(
                "records_damaged",
                number=len(damaged),
                records=len(found.names),
                damaged=damaged,
            )
        )
    notices += [told for _, told in found.apart]
    off = [k for k, ratio in enumerate(found.ratio) if abs(ratio - 1.0) > ALIKE]
    if off:
        speeds = [found.turns[k].shaft for k in off]
        notices.append(
            Notice.of(
                "speeds_differ",
                number=len(off),
                records=len(found.names),
                baseline=found.names[found.baseline],
                baseline_speed=found.turns[found.baseline].shaft,
                others=[found.names[k] for k in off],
                speeds=speeds if np.all(np.isfinite(speeds)) else None,
                ratios=[found.ratio[k] for k in off],
            )
        )
    return Result.of(
        "records",
        f"{len(found.names)} records against {found.names[found.baseline]}",
        {"records": data},
        notices,
        created=now(),
        unit=found.unit,
        figures=figures_of_several(found),
    )


def figures_of_several(found: Several) -> dict[str, Any]:
    """Plain figures: of every line that changed where, by how much, and its trend."""
    slope, half = found.trends()
    change, width, beyond = found.change, found.change_half_width, found.beyond
    speeds = [
        {
            "record": name,
            "shaft_speed": _known(turns.shaft),
            "mesh_frequency": _known(turns.hertz),
            "speed_ratio": _known(ratio),
            "compared": int(np.sum(np.isfinite(row))),
        }
        for name, turns, ratio, row in zip(
            found.names, found.turns, found.ratio, found.change, strict=True
        )
    ]
    rows = [
        {
            "record": found.names[i],
            "shaft_speed": speeds[i]["shaft_speed"],
            "mesh_frequency": speeds[i]["mesh_frequency"],
            "channel": channel,
            "name": name,
            "reading": float(found.reading[i, k]),
            "change": float(change[i, k]),
            "change_half_width": float(width[i, k]),
        }
        for k, (channel, name) in enumerate(found.keys)
        for i in np.flatnonzero(beyond[:, k])
    ]
    trends = [
        {"channel": c, "name": n, "trend": float(slope[k]), "trend_half_width": float(half[k])}
        for k, (c, n) in enumerate(found.keys)
        if np.isfinite(slope[k]) and abs(slope[k]) > half[k]
    ]
    return {
        "records": list(found.names),
        "baseline": found.names[found.baseline],
        "lines": len(found.keys),
        "compared": int(np.sum(np.isfinite(np.delete(change, found.baseline, axis=0)))),
        "changed": rows,
        "trends": trends,
        "speeds": speeds,
        "apart": [[name, told.text] for name, told in found.apart],
        "refused": [list(pair) for pair in found.refused],
        "withheld": [list(pair) for pair in found.withheld],
        "findings": [[name, [one.as_dict() for one in told]] for name, told in found.found],
        "units": {
            "reading": found.unit,
            "shaft_speed": "rad/s",
            "mesh_frequency": "Hz",
            "speed_ratio": "1",
            **dict.fromkeys(("change", "change_half_width", "lines", "compared"), "1"),
            **dict.fromkeys(("trend", "trend_half_width"), "1/record"),
        },
    }


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
