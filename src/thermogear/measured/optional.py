"""Formats of the extra ``[measure]``: TDMS, UFF 58 and MDF 4; their readers load when used."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from thermogear.base.errors import InputError
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.tables import agreed
from thermogear.measured.traps import is_tacho_name, without_doubles
from thermogear.measured.units import unit


def _load(module: str, path: Path, kind: str) -> ModuleType:
    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise InputError(
            "file",
            path.name,
            why=f"reading {kind} needs {module}",
            fix="install thermogear with the extra: pip install 'thermogear[measure]'",
        ) from error


def read_tdms(path: Path, options: ReadOptions) -> Record:
    """TDMS: every channel of numbers; rate from wf_increment, unit from unit_string."""
    nptdms = _load("nptdms", path, "TDMS")
    channels: list[Channel] = []
    rates: list[tuple[float, str]] = []
    try:
        file = nptdms.TdmsFile.read(path)
        for group in file.groups():
            for item in group.channels():
                values = np.asarray(item[:])
                if values.dtype.kind not in "iuf" or values.size < 2:
                    continue
                said = item.properties
                step = said.get("wf_increment")
                if isinstance(step, float) and step > 0:
                    rates.append((1.0 / step, f"wf_increment of {item.name}"))
                name = unit(str(said.get("unit_string", said.get("NI_UnitDescription", ""))))
                channels.append(Channel(f"{group.name}/{item.name}", values, name))
    except Exception as error:  # a foreign reader's failures are of any type
        raise refused(path, "TDMS", error) from error
    return _record(path, "TDMS", channels, rates)


def read_uff(path: Path, options: ReadOptions) -> Record:
    """Universal file, data sets 58 that are time responses; step and unit as stored."""
    pyuff = _load("pyuff", path, "UFF")
    channels: list[Channel] = []
    rates: list[tuple[float, str]] = []
    try:
        sets = pyuff.UFF(str(path)).read_sets()
        for number, item in enumerate([sets] if isinstance(sets, dict) else sets, start=1):
            if item.get("type") != 58 or item.get("func_type") != 1:
                continue
            values = np.asarray(item["data"])
            x = np.asarray(item["x"], dtype=float)
            if values.dtype.kind not in "iuf" or values.size < 2:
                continue
            step = float(item.get("abscissa_inc", 0.0) or 0.0) or float(x[1] - x[0])
            if step > 0:
                rates.append((1.0 / step, f"abscissa of set {number}"))
            name = str(item.get("id1", "")).strip() or f"set {number}"
            label = str(item.get("ordinate_axis_units_lab", "")).strip()
            channels.append(Channel(f"{name} {number}", values, unit(label)))
    except Exception as error:  # a foreign reader's failures are of any type
        raise refused(path, "UFF", error) from error
    return _record(path, "UFF", channels, rates)


def read_mdf(path: Path, options: ReadOptions) -> Record:
    """MDF 4 (and 3): the channels of the longest common time base; unit as stored."""
    asammdf = _load("asammdf", path, "MDF")
    channels: list[Channel] = []
    rates: list[tuple[float, str]] = []
    notes: list[Notice] = []
    try:
        with asammdf.MDF(str(path)) as file:
            signals: list[Any] = [s for s in file.iter_channels() if s.samples.dtype.kind in "iuf"]
            for item in signals:
                stamps = np.asarray(item.timestamps, dtype=float)
                if stamps.size < 3:
                    continue
                steps = np.diff(stamps)
                step = (stamps[-1] - stamps[0]) / steps.size
                if step > 0 and np.max(np.abs(steps - step)) <= 0.5 * step:
                    rates.append((1.0 / step, f"time base of {item.name}"))
                else:
                    notes.append(Notice("important", f"{item.name}: its time base is not uniform"))
                channels.append(Channel(item.name, np.asarray(item.samples), unit(item.unit or "")))
    except Exception as error:  # a foreign reader's failures are of any type
        raise refused(path, "MDF", error) from error
    return _record(path, "MDF", channels, rates, notes)


def _record(
    path: Path,
    kind: str,
    channels: list[Channel],
    rates: list[tuple[float, str]],
    notes: list[Notice] | None = None,
) -> Record:
    if not channels:
        raise refused(path, kind, "it holds no channel of numbers")
    said = list(notes or [])
    longest = max(map(len, channels))
    aside = [c.name for c in channels if len(c) != longest]
    if aside:
        said.append(Notice("warning", f"of another length, left aside: {', '.join(aside[:5])}"))
    kept, doubled = without_doubles([c for c in channels if len(c) == longest], path.name)
    rate, origin = agreed(rates, said)
    tacho = next((c.name for c in kept if is_tacho_name(c.name)), None)
    return Record(tuple(kept), path.name, rate, origin, 0.0, tacho, (*said, *doubled))
