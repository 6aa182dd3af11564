"""Formats of the extra ``[measure]``: TDMS, UFF 58 and MDF 4; their readers load when used."""

from __future__ import annotations

import contextlib
import gc
import importlib.util
import io
import json
import logging
import os
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from thermogear.base.errors import of_extra
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.tables import agreed, of_one_length
from thermogear.measured.traps import is_tacho_name, without_doubles
from thermogear.measured.units import unit


def _load(module: str, path: Path, kind: str) -> ModuleType:
    package: ModuleType = of_extra(
        module, "measure", field="file", got=path.name, use=f"reading {kind}"
    )
    return package


class _Parts:
    """What a foreign reader found, before it becomes a record."""

    def __init__(self) -> None:
        self.channels: list[Channel] = []
        self.rates: list[tuple[float, str]] = []
        self.notes: list[Notice] = []


def _guarded(
    path: Path, kind: str, module: str, read: Callable[[ModuleType, Path, _Parts], None]
) -> Record:
    """Run a foreign reader: whatever it raises, logs, prints or leaves in its destructors on a
    malformed file becomes one refusal."""
    foreign = _load(module, path, kind)
    parts, reason = _Parts(), ""
    hook, disabled = sys.unraisablehook, logging.root.manager.disable
    sys.unraisablehook = lambda _: None
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            try:
                read(foreign, path, parts)
            except Exception as error:  # a foreign reader's failures are of any type
                reason = str(error) or type(error).__name__
            gc.collect()  # half-built readers fail again when they are taken away: here, unheard
    finally:
        sys.unraisablehook = hook
        logging.disable(disabled)
    if reason:
        raise refused(path, kind, reason)
    return _record(path, kind, parts.channels, parts.rates, parts.notes)


def read_tdms(path: Path, options: ReadOptions) -> Record:
    """TDMS: every channel of numbers; rate from wf_increment, unit from unit_string."""
    return _guarded(path, "TDMS", "nptdms", _tdms)


class _Clipped(io.BufferedReader):
    """A file that never makes room for more bytes than it has."""

    def __init__(self, path: Path) -> None:
        super().__init__(io.FileIO(path))
        self._size = path.stat().st_size

    def read(self, size: int | None = -1, /) -> bytes:
        left = max(0, self._size - self.tell())
        return super().read(left if size is None or size < 0 else min(size, left))


def _tdms(nptdms: ModuleType, path: Path, parts: _Parts) -> None:
    size = path.stat().st_size
    with _Clipped(path) as file:
        stated = nptdms.TdmsFile.read_metadata(file)
        count = sum(len(item) for group in stated.groups() for item in group.channels())
        if count > size:  # a value takes a byte or more
            raise ValueError(f"it states {count} values and has {size} bytes")
        file.seek(0)
        groups = nptdms.TdmsFile.read(file).groups()
    for group in groups:
        for item in group.channels():
            values = np.asarray(item[:])
            if values.dtype.kind not in "iuf" or values.size < 2:
                continue
            said = item.properties
            step = said.get("wf_increment")
            if isinstance(step, float) and step > 0:
                parts.rates.append((1.0 / step, f"wf_increment of {item.name}"))
            name = unit(str(said.get("unit_string", said.get("NI_UnitDescription", ""))))
            parts.channels.append(Channel(f"{group.name}/{item.name}", values, name))


def read_uff(path: Path, options: ReadOptions) -> Record:
    """Universal file, data sets 58 that are time responses; step and unit as stored."""
    return _guarded(path, "UFF", "pyuff", _uff)


def _uff(pyuff: ModuleType, path: Path, parts: _Parts) -> None:
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
            parts.rates.append((1.0 / step, f"abscissa of set {number}"))
        name = str(item.get("id1", "")).strip() or f"set {number}"
        label = str(item.get("ordinate_axis_units_lab", "")).strip()
        parts.channels.append(Channel(f"{name} {number}", values, unit(label)))


def read_mdf(path: Path, options: ReadOptions) -> Record:
    """MDF 4 (and 3): the channels of the longest common time base; unit as stored.

    It is read in a process of its own, for asammdf may crash on a damaged file.
    """
    if importlib.util.find_spec("asammdf") is None:
        _load("asammdf", path, "MDF")
    parts = _Parts()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        found = _apart(path, folder, options)
        if "error" in found:
            raise refused(path, "MDF", found["error"])
        for number, one in enumerate(found["channels"]):
            samples = np.load(folder / f"{number}.npy", allow_pickle=False)
            parts.channels.append(Channel(one["name"], samples, unit(one["unit"])))
        parts.rates += [(rate, where) for rate, where in found["rates"]]
        parts.notes += [Notice.of("time_base_uneven", channel=name) for name in found["uneven"]]
    return _record(path, "MDF", parts.channels, parts.rates, parts.notes)


def _apart(path: Path, folder: Path, options: ReadOptions) -> dict[str, Any]:
    """What the reader of MDF found; a refusal where it crashed or took more than it may."""
    # asammdf copies a file that was not closed properly to the folder of temporary files
    held = dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(folder))
    seconds = 30 + path.stat().st_size // 1_000_000
    words = [str(path.absolute()), str(folder), str(2 * options.limit), str(seconds)]
    code = _run(words, held)
    try:
        found: dict[str, Any] = json.loads((folder / "parts.json").read_text("utf-8"))
    except (OSError, ValueError):
        text = f"its reader ended with code {code}: it is damaged, or too large"
        raise refused(path, "MDF", text) from None
    return found


def _run(words: list[str], environment: dict[str, str]) -> int:
    """The exit code of the reader of MDF, run with these ``words``."""
    return subprocess.run(
        [sys.executable, str(Path(__file__).with_name("mdf_process.py")), *words],
        env=os.environ | environment | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        check=False,
    ).returncode


def _record(
    path: Path,
    kind: str,
    channels: list[Channel],
    rates: list[tuple[float, str]],
    notes: list[Notice],
) -> Record:
    if not channels:
        raise refused(path, kind, "it holds no channel of numbers")
    said = list(notes)
    kept, doubled = without_doubles(of_one_length(channels, said), path.name)
    rate, origin = agreed(rates, said)
    tacho = next((c.name for c in kept if is_tacho_name(c.name)), None)
    return Record(tuple(kept), path.name, rate, origin, 0.0, tacho, (*said, *doubled))
