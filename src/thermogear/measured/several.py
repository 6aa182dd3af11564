"""Several records: what changed against a baseline beyond its uncertainty, and trends."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.base.vocabulary import label
from thermogear.measured.reduction import Measurement
from thermogear.results.result import Notice, Result, now

Floats = NDArray[np.float64]

MOST = 10_000
_HALF = 1.959964


@dataclass(frozen=True, kw_only=True)
class Several:
    """Lines of records: ``reading`` (record, line) with ``half_width`` of its 95 % interval, nan
    where a record has no such line; ``keys`` (channel, name) of the lines; ``refused`` why a file
    gave none; ``baseline`` the record that others are compared with."""

    names: tuple[str, ...]
    keys: tuple[tuple[str, str], ...]
    reading: Floats
    half_width: Floats
    baseline: int
    refused: tuple[tuple[str, str], ...]
    unit: str

    @property
    def change(self) -> Floats:
        """(reading - baseline)/baseline, (record, line)."""
        return np.asarray(self.reading / self.reading[self.baseline] - 1.0)

    @property
    def change_half_width(self) -> Floats:
        """Half width of its 95 % interval: both readings' intervals, as independent."""
        base = self.reading[self.baseline]
        own = self.half_width / base
        ratio = self.reading / base * self.half_width[self.baseline] / base
        return np.asarray(np.hypot(own, ratio))

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
            good = np.flatnonzero(np.isfinite(self.reading[:, k]) & (self.half_width[:, k] > 0.0))
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
    """The files that are named, and of every directory those in it, by name.

    Raises InputError for none, or for more than 10 000.
    """
    found: list[Path] = []
    for one in map(Path, named):
        if one.is_dir():
            found += sorted(p for p in one.iterdir() if p.is_file() and not p.name.startswith("."))
        else:
            found.append(one)
    if not 1 <= len(found) <= MOST:
        raise InputError("file", f"{len(found)} files", allowed=f"1..{MOST}")
    return found


def several(
    files: Sequence[Path],
    read: Callable[[Path], Measurement],
    baseline: str = "first",
) -> Several:
    """Measure ``files`` one after another by ``read``; a file that is refused is told and left out.

    ``baseline``: "first", "last", or the name of a file. Readings are in each record's own unit;
    records of another unit than the baseline's are refused.
    """
    rows: list[dict[tuple[str, str], tuple[float, float]]] = []
    names: list[str] = []
    units: list[str] = []
    refused: list[tuple[str, str]] = []
    for file in files:
        try:
            found = read(file)
        except InputError as error:
            refused.append((file.name, str(error)))
            continue
        names.append(file.name)
        units.append(found.record.channel(found.channels[0]).unit or "")
        rows.append(
            {
                (one.channel, one.name): (one.reading, one.reading * one.half_width)
                for one in found.lines
                if np.isfinite(one.reading)
            }
        )
    if not rows:
        raise InputError("file", refused[0][0], why=f"no record could be read: {refused[0][1]}")
    place = {"first": 0, "last": len(names) - 1}.get(baseline)
    if place is None:
        if Path(baseline).name not in names:
            raise InputError("--baseline", baseline, allowed="first, last or one of the files")
        place = names.index(Path(baseline).name)
    kept = [i for i, unit in enumerate(units) if unit == units[place]]
    refused += [
        (names[i], f"its unit is {units[i] or 'unknown'}, the baseline's {units[place]}")
        for i in range(len(names))
        if i not in kept
    ]
    keys = tuple(dict.fromkeys(key for i in kept for key in rows[i]))
    blank = (float("nan"), float("nan"))
    table = np.array([[rows[i].get(key, blank) for key in keys] for i in kept]).reshape(
        len(kept), len(keys), 2
    )
    return Several(
        names=tuple(names[i] for i in kept),
        keys=keys,
        reading=table[..., 0],
        half_width=table[..., 1],
        baseline=kept.index(place),
        refused=tuple(refused),
        unit=units[place],
    )


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
        }
    ).assign_coords(
        record=list(found.names),
        channel=("line", [channel for channel, _ in found.keys]),
        name=("line", [name for _, name in found.keys]),
    )
    notices = [Notice("warning", f"{name} is left out: {why}") for name, why in found.refused]
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
    rows = []
    for k, (channel, name) in enumerate(found.keys):
        for i in np.flatnonzero(beyond[:, k]):
            rows.append(
                {
                    "record": found.names[i],
                    "channel": channel,
                    "name": name,
                    "reading": float(found.reading[i, k]),
                    "change": float(change[i, k]),
                    "half_width": float(width[i, k]),
                }
            )
    trends = [
        {"channel": c, "name": n, "trend": float(slope[k]), "half_width": float(half[k])}
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
        "refused": [list(pair) for pair in found.refused],
    }
