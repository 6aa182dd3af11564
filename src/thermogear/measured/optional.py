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
from thermogear.measured.contract import UNSTATED, Stated, record_of_channels, timed
from thermogear.measured.options import ReadOptions, refused
from thermogear.measured.record import Channel, Notice, Record, Samples
from thermogear.measured.traps import (
    TimeBase,
    is_time_name,
    longest_even,
    speed_fact,
    step_base,
)
from thermogear.measured.units import factor_of, kind_of, unit, unknown

_UFF_AXES = {18: "frequency", 19: "speed", 20: "order"}
"""What an abscissa counts by its data type, where that is no time."""


def _load(module: str, path: Path, kind: str) -> ModuleType:
    package: ModuleType = of_extra(
        module, "measure", field="file", got=path.name, use=f"reading {kind}"
    )
    return package


def _guarded(
    path: Path, kind: str, module: str, read: Callable[[ModuleType, Path], list[Stated]]
) -> list[Stated]:
    """What a foreign reader finds: whatever it raises, logs, prints or leaves in its destructors on
    a malformed file becomes one refusal."""
    foreign = _load(module, path, kind)
    stated, reason = list[Stated](), ""
    hook, disabled = sys.unraisablehook, logging.root.manager.disable
    sys.unraisablehook = lambda _: None
    logging.disable(logging.CRITICAL)
    try:
        with warnings.catch_warnings(), contextlib.redirect_stdout(io.StringIO()):
            warnings.simplefilter("ignore")
            try:
                stated = read(foreign, path)
            except Exception as error:  # a foreign reader's failures are of any type
                reason = str(error) or type(error).__name__
            gc.collect()  # half-built readers fail again when they are taken away: here, unheard
    finally:
        sys.unraisablehook = hook
        logging.disable(disabled)
    if reason:
        raise refused(path, kind, reason)
    return stated


def _channel(name: str, samples: Samples, label: str) -> Channel:
    """A channel with its unit as the file writes it; "NONE" is UFF's for none."""
    label = "" if label.strip().upper() == "NONE" else label
    return Channel(name, samples, unit(label), strange=unknown(label))


def read_tdms(path: Path, options: ReadOptions) -> Record:
    """TDMS: every channel of numbers; step and start as wf_increment, wf_start_offset and
    wf_start_time state them, unit from unit_string."""
    stated = _guarded(path, "TDMS", "nptdms", _tdms)
    notices: list[Notice] = []
    return record_of_channels(path, "TDMS", timed(stated, notices), notices, keep=options.keep)


def _tdms(nptdms: ModuleType, path: Path) -> list[Stated]:
    size = path.stat().st_size
    with path.open("rb") as file:
        promised = nptdms.TdmsFile.read_metadata(file)
        count = sum(len(item) for group in promised.groups() for item in group.channels())
        if count > size:  # a value takes a byte or more
            raise ValueError(f"it states {count} values and has {size} bytes")
        file.seek(0)
        whole = nptdms.TdmsFile.read(file)
    items = [(group, item) for group in whole.groups() for item in group.channels()]
    times = [item.properties.get("wf_start_time") for _, item in items]
    first = min((t for t in times if isinstance(t, np.datetime64)), default=None)
    cut = whole.file_status.incomplete_final_segment
    stated = []
    for (group, item), time in zip(items, times, strict=True):
        values, facts = np.asarray(item[:]), item.properties
        if values.dtype.kind not in "iuf" or values.size < 2:
            continue
        start = float(facts.get("wf_start_offset", 0.0))
        if first is not None and isinstance(time, np.datetime64):
            start += float((time - first) / np.timedelta64(1, "s"))
        step, origin = facts.get("wf_increment"), f"wf_increment of {item.name}"
        axis, factor = _axis(str(facts.get("wf_xunit_string", "")), str(facts.get("wf_xname", "")))
        base = UNSTATED
        if isinstance(step, float) and step > 0:
            base = step_base(step * factor, channel=item.name, start=start, origin=origin)
        name, label = f"{group.name}/{item.name}", facts.get("unit_string", "")
        told = (whole.properties | group.properties | facts).items()
        speeds = [speed_fact(key, one) for key, one in told if isinstance(one, (int, float))]
        stated.append(
            Stated(
                _channel(name, values, str(label or facts.get("NI_UnitDescription", ""))),
                base,
                axis=axis,
                count=values.size + 1 if cut else None,
                unscaled=_unscaled(nptdms, facts, group.properties, whole.properties),
                speeds=tuple(filter(None, speeds)),
            )
        )
    return stated


def _unscaled(nptdms: ModuleType, *properties: dict[str, Any]) -> bool:
    """Whether a channel, its group or its file states scales of which the library applies none."""
    scaled = any(
        "NI_Scale[0]_Scale_Type" in facts and facts.get("NI_Scaling_Status") != "scaled"
        for facts in properties
    )
    return scaled and nptdms.scaling.get_scaling(*properties) is None


def _axis(label: str, name: str = "") -> tuple[str, float]:
    """What an x axis counts, by its unit where that is known, else by its name; seconds, or turns,
    in one of its unit."""
    known = unit(label)
    if known is not None:
        return kind_of(known), factor_of(known)
    if not name or is_time_name(name):
        return "time", 1.0
    return "frequency" if "freq" in name.lower() else name, 1.0


def read_uff(path: Path, options: ReadOptions) -> Record:
    """Universal file, data sets 58 over time; abscissa and unit as stored."""
    stated = _guarded(path, "UFF", "pyuff", _uff)
    # the last set is not closed: what it states is not there
    closed = path.read_bytes()[-100:].rstrip().endswith(b"    -1")
    notices = [] if closed else [Notice.of("data_cut_off")]
    return record_of_channels(path, "UFF", stated, notices, keep=options.keep)


def _uff(pyuff: ModuleType, path: Path) -> list[Stated]:
    sets = pyuff.UFF(str(path)).read_sets()
    stated = []
    for number, item in enumerate([sets] if isinstance(sets, dict) else sets, start=1):
        values = np.asarray(item.get("data", ()))
        if item.get("type") != 58 or values.dtype.kind not in "iufc" or values.size < 2:
            continue
        axis = _UFF_AXES.get(item.get("abscissa_spec_data_type"), "")
        axis, factor = _axis(str(item.get("abscissa_axis_units_lab", "")), axis)
        if item.get("func_type") not in (0, 1):
            axis = "frequency"  # a spectrum, or another function of records
        name = str(item.get("id1", "")).strip()
        name = "" if name == "NONE" else name
        label = str(item.get("ordinate_axis_units_lab", "")).strip()
        stated.append(
            Stated(
                _channel(f"{name or 'set'} {number}", values, label),
                _abscissa(item, factor, f"set {number}"),
                axis=axis,
                count=int(item["num_pts"]),
            )
        )
    return stated


def _abscissa(item: dict[str, Any], factor: float, name: str) -> TimeBase:
    """The time base of a data set, ``factor`` [s] in one of its unit: by its step, which is printed
    with six digits, or by uneven stamps."""
    if item.get("abscissa_spacing") == 0:
        return longest_even(f"abscissa of {name}", "s", np.asarray(item["x"], dtype=float) * factor)
    step = float(item.get("abscissa_inc") or 0.0)
    half = 0.5 * 10.0 ** (np.floor(np.log10(step)) - 5.0) if step > 0.0 else 0.0
    start = float(item.get("abscissa_min") or 0.0) * factor
    origin = f"abscissa of {name}"
    return step_base(
        step * factor, channel=name, start=start, origin=origin, half_width=half * factor
    )


def read_mdf(path: Path, options: ReadOptions) -> Record:
    """MDF 4 (and 3): channels with the stamps of their own groups; unit as stored.

    It is read in a process of its own, for asammdf may crash on a damaged file.
    """
    if importlib.util.find_spec("asammdf") is None:
        _load("asammdf", path, "MDF")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        read = _apart(path, folder, options)
        if "error" in read:
            raise refused(path, "MDF", read["error"])
        bases: dict[int, TimeBase] = {}
        stated = []
        for number, facts in enumerate(read["channels"]):
            samples = np.load(folder / f"{number}.npy", allow_pickle=False)
            group, axis = facts["group"], facts["axis"]
            if group not in bases:
                stamps = np.load(folder / f"stamps{group}.npy", allow_pickle=False)
                label = facts["axis_unit"] or ("rad" if axis == "angle" else "s")
                name = f"master of {facts['name']}"
                bases[group] = longest_even(name, "s", stamps * _axis(label)[1])
            channel = _channel(facts["name"], samples, facts["unit"])
            stated.append(Stated(channel, bases[group], axis=axis, count=facts["count"]))
    return record_of_channels(path, "MDF", stated, keep=options.keep)


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
