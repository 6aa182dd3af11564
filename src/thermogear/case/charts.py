"""Measured flanks of a case: its charts' files, read into the text, held against the gears."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.enclosed import with_files
from thermogear.base.errors import InputError, short
from thermogear.base.files import decoded, require_regular
from thermogear.base.units import ROUNDED
from thermogear.case.flank_file import LARGEST, SIDES, FlankFile, read_flanks
from thermogear.case.schema import GearFile
from thermogear.gears.deviations import FlankTable
from thermogear.gears.geometry import Gear
from thermogear.gears.measured_flanks import MeasuredFlank, ProfileTraces, roll_path
from thermogear.gears.pair import GearPair
from thermogear.gears.turn import ToothShapes

GEARS = ("pinion", "wheel")
PITCHES = ("cumulative pitch", "single pitch")
"""Pitch deviations that act, each along the arc of the reference circle, in the order of the teeth;
what adds up over many teeth is known best from the first."""
_CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


@dataclass(frozen=True, eq=False, kw_only=True)
class Chart:
    """One gear's measured flanks: what was ``read``, its ``traces``, what acts on each side."""

    gear: str
    names: tuple[str, ...]
    read: FlankFile
    traces: ProfileTraces
    range: tuple[float, float]
    flanks: tuple[MeasuredFlank, ...]
    deviations: tuple[FlankTable, ...]

    def hand(self, trace: int) -> str:
        """A trace's name: tooth and side as the file has them, and what the side does."""
        side, acts = self.read.side[trace], self.traces.flank[trace]
        return f"tooth {self.read.tooth[trace]} {side}" + (f" ({acts})" if acts != side else "")

    @property
    def acting_pitch(self) -> str | None:
        """The column of pitch deviations that acts, the drive flank's first; None without one."""
        hands = (self.read.drive, "drive", "", *SIDES)
        names = (f"{kind} {hand}".strip() for kind in PITCHES for hand in hands)
        return next((name for name in names if name in self.read.pitch), None)

    def every_tooth(self, pair: GearPair) -> tuple[ToothShapes, ...]:
        """Each side that was measured, every tooth by itself.

        A single trace is smoothed more than the mean of all: its noise is greater. Refused where a
        tooth is missing.
        """
        body, traces = pair.pinion if self.gear == "pinion" else pair.wheel, self.traces
        sides = []
        for side in sorted(set(traces.flank), reverse=True):  # drive first
            rows = {n: k for k, n in enumerate(traces.tooth) if traces.flank[k] == side}
            if len(rows) < body.teeth:
                raise InputError(
                    f"flanks.{self.gear}",
                    f"traces of {len(rows)} teeth, {side} flank",
                    allowed=f'all {body.teeth} teeth with flanks.teeth = "measured"',
                    fix='write teeth = "alike" to take the mean of these',
                )
            each = (
                replace(traces, added=traces.added[[rows[n]]], flank=(side,), tooth=(n,))
                for n in sorted(rows)
            )
            shapes = (trace.flanks(pair)[0].table(self.gear, body.base_radius) for trace in each)
            sides.append(ToothShapes(self.gear, tuple(shapes)))
        return tuple(sides)


def enclosed(text: str, data: dict[str, Any], folder: Path) -> str:
    """``text`` with the files of ``[flanks]`` at its end, put into ``data`` too.

    A result keeps the text, so that neither a page nor a run from it needs the files. What
    ``[files]`` holds already is not read again; ``folder`` is where names count from.
    """
    contents: dict[str, str] = {}
    table = data.get("flanks")
    files = data.get("files", {})
    if not isinstance(table, dict) or not isinstance(files, dict):
        return text
    for gear in GEARS:
        given = table.get(gear)
        names = [given] if isinstance(given, str) else given if isinstance(given, list) else []
        for name in dict.fromkeys(names):
            if not isinstance(name, str) or name in files:
                continue
            content = _content(name, folder, f"flanks.{gear}")
            files = data["files"] = {**files, name: {"text": content}}
            contents[name] = content
    return with_files(text, contents)


def _content(name: str, folder: Path, field: str) -> str:
    """The text of a file that a case names."""
    path = folder / name
    got = short(name)
    example = "a CSV file of an inspection chart"
    if path.is_dir():
        raise InputError(field, got, allowed=example, why="it is a directory")
    require_regular(path, field)
    try:
        with path.open("rb") as file:
            raw = file.read(4 * LARGEST + 1)
    except FileNotFoundError as cause:
        why = f"there is no such file in {folder.resolve()}"
        raise InputError(field, got, why=why, fix="name it relative to the case file") from cause
    except (OSError, ValueError) as cause:
        reason = getattr(cause, "strerror", None) or str(cause)
        raise InputError(field, got, why=f"it cannot be read: {reason}") from cause
    try:
        text = decoded(raw[: 4 * LARGEST])
    except UnicodeDecodeError:
        text = raw.decode("latin-1")
    if len(raw) > 4 * LARGEST or len(text) > LARGEST:
        raise InputError(
            field,
            got,
            allowed=f"a text of at most {LARGEST} characters",
            why="a chart has some hundred points for each tooth",
            fix="leave points or teeth out",
        )
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if _CONTROL.search(text):
        raise InputError(field, got, allowed=example, why="it holds binary data")
    if not text.strip():
        raise InputError(field, got, allowed=example, why="it is empty")
    return text if text.endswith("\n") else text + "\n"


def charts(file: GearFile, pair: GearPair) -> tuple[Chart, ...]:
    """The measured flanks of both gears; what does not fit them is refused under its field."""
    read = []
    for gear in GEARS:
        names = None if file.flanks is None else getattr(file.flanks, gear)
        if names is None:
            continue
        try:
            for field in ("profile", "tooth_profiles"):
                if getattr(getattr(file.gears, gear), field):
                    raise InputError(
                        "",
                        ", ".join(names),
                        why=f"[gears.{gear}.{field}] gives the same flanks",
                        fix="leave one out",
                    )
            texts = tuple((name, file.files[name].text) for name in names)
            read.append(_chart(gear, names, _read(texts), pair))
        except InputError as error:
            raise error.named(f"flanks.{gear}") from error
    return tuple(read)


@lru_cache(maxsize=8)
def _read(texts: tuple[tuple[str, str], ...]) -> FlankFile:
    """A file is read once, however often a sweep loads its case."""
    return read_flanks(dict(texts))


def _chart(gear: str, names: tuple[str, ...], read: FlankFile, pair: GearPair) -> Chart:
    body = pair.pinion if gear == "pinion" else pair.wheel
    name = names[0]
    counts = {"# teeth": read.teeth} | {k: v.size for k, v in read.pitch.items()}
    for what, count in counts.items():
        if count not in (None, body.teeth):
            raise InputError(
                "", f"{name}: {count} teeth ({what})", allowed=f"{body.teeth}, as the {gear} has"
            )
    if max(read.tooth) > body.teeth or min(read.tooth) < 1:
        most = max(read.tooth, key=lambda one: abs(one - 1))
        raise InputError("", f"{name}: tooth {most}", allowed=f"1..{body.teeth}")
    rho = _inside(name, read, body, gear)
    step = np.diff(rho)
    order = slice(None)
    if np.all(step < 0.0):
        order = slice(None, None, -1)
    elif not np.all(step > 0.0):
        wrong = int(np.argmax(step * np.sign(np.sum(np.sign(step)) or 1.0) <= 0.0)) + 1
        twice = step[wrong - 1] == 0.0
        at = _shown(read, wrong)
        raise InputError(
            "",
            f"{read.places[wrong]}: {read.over} {at}" + (" twice" if twice else " out of order"),
            allowed="points in order along the flank, each once",
        )
    traces = ProfileTraces(
        gear=gear,
        rho=np.ascontiguousarray(rho[order]),
        added=np.ascontiguousarray(read.added[:, order]),
        flank=tuple(
            side if side in ("drive", "back") else "drive" if side == read.drive else "back"
            for side in read.side
        ),
        tooth=read.tooth,
        range=_evaluated(name, read, body),
    )
    try:
        span = traces.evaluated(pair)
        flanks = traces.flanks(pair)
    except InputError as error:
        raise InputError(
            "", f"{name}: {error.got}", allowed=error.allowed, why=error.why, fix=error.fix
        ) from error
    return Chart(
        gear=gear,
        names=names,
        read=read,
        traces=traces,
        range=span,
        flanks=flanks,
        deviations=tuple(flank.table(gear, body.base_radius) for flank in flanks),
    )


def _roll(over: str, position: NDArray[np.float64], gear: Gear) -> NDArray[np.float64]:
    """Roll path [m] of positions on the flank; nan below the base circle."""
    if over == "roll angle":
        return roll_path(gear, angle=position)
    if over in ("roll length", "roll path"):
        return np.asarray(position, dtype=float)
    return roll_path(gear, diameter=position if over == "diameter" else 2.0 * position)


def _shown(read: FlankFile, place: int) -> str:
    value = read.position[place]
    return f"{np.degrees(value):.6g} deg" if read.over == "roll angle" else f"{1e3 * value:.6g} mm"


def _inside(name: str, read: FlankFile, gear: Gear, which: str) -> NDArray[np.float64]:
    """Roll path [m] of the points; refused where they leave the involute, from base circle to tip.

    One that leaves it by the rounding of its digits alone is taken at its end.
    """
    rho = _roll(read.over, read.position, gear)
    tip = float(gear.curvature_radius(gear.tip_radius))
    most = ROUNDED * gear.module
    slack = min(read.rounding, most / gear.base_radius if read.over == "roll angle" else most)
    inward, outward = (_roll(read.over, read.position + off, gear) for off in (-slack, slack))
    rho = np.where((rho > tip) & (inward <= tip * (1.0 + 1e-6)), tip, rho)
    rho = np.where(~(rho >= 0.0) & (outward >= 0.0), 0.0, rho)
    wrong = ~((rho >= 0.0) & (rho <= tip))
    if not wrong.any():
        return rho
    place = int(np.argmax(wrong))
    below = not rho[place] > tip
    edge = "below the base circle" if below else "above the tip"
    raise InputError(
        "",
        f"{read.places[place]}: {read.over} {_shown(read, place)}",
        allowed=f"diameters {2e3 * gear.base_radius:.6g}..{2e3 * gear.tip_radius:.6g} mm",
        why=f"it lies {edge} of the {which}",
        fix="end the trace there, or is it the other gear's, or a radius for a diameter?",
    )


def _evaluated(name: str, read: FlankFile, gear: Gear) -> tuple[float, float] | None:
    """The stated range [m] of the roll path."""
    if read.evaluate is None:
        return None
    over, *ends = read.evaluate
    low, high = _roll(over, np.array(ends), gear)
    if not (np.isfinite(low) and low < high):
        raise InputError(
            "",
            f"{name}: a range to evaluate that starts below the base circle",
            allowed=f"from {2e3 * gear.base_radius:.6g} mm of diameter",
        )
    return float(low), float(high)
