"""Pictures that move: the data and the one script by which a page draws them in the browser."""

from __future__ import annotations

import base64
import hashlib
import json
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields, replace
from functools import cache
from importlib.resources import files
from itertools import chain
from typing import Any

import numpy as np
from markupsafe import Markup

from thermogear.views.picture import Contours, Field, Hatch, Mark, Panel, Picture, Points

SCRIPTS = ("uplot.js", "gears.js", "marks.js", "pictures.js")
PAGE = "page.js"
SHEETS = ("uplot.css", "pictures.css")
DIGITS = 5
"""Significant digits of a place in a picture: a hundredth of a pixel and finer."""
DENSE, CELLS = 2000, 2000
"""From so many points on a cloud is thinned, to so many cells across and up."""
SHORT = 8
"""An array of fewer numbers is written where it stands, in full."""
NUMBERS = ("x", "y", "values")
"""What holds the numbers of a mark."""
MOST = 40_000
"""Numbers of one picture; with more it stays still, so that the page stays light."""


@dataclass(frozen=True)
class Dial:
    """A quantity one turns: the picture at each of its values.

    ``words`` name it, ``values`` are what each place says, ``told`` what was found there;
    ``start`` is the place that the still picture shows. All pictures have the same panels.
    """

    words: str
    values: Sequence[str]
    told: Sequence[str]
    start: int
    make: Callable[[int], Picture] = field(repr=False)


def moves(picture: Picture) -> bool:
    """Whether the script can draw it: no contours, hatches, turned axes or slanted names."""
    panels = [*chain(*picture.panels)]
    marks = [mark for panel in panels for mark in panel.marks]
    fixed = any(
        isinstance(mark, Contours | Hatch) or (isinstance(mark, Field) and np.size(mark.levels))
        for mark in marks
    ) or any(
        axis.slant or (axis.low is not None and axis.high is not None and axis.low > axis.high)
        for panel in panels
        for axis in (panel.x, panel.y)
    )
    numbers = (np.size(getattr(m, n, ())) for m in map(distinct, marks) for n in NUMBERS)
    return not fixed and sum(numbers) <= MOST


def moving(picture: Picture, dial: Dial | None = None) -> str:
    """``picture`` as the script takes it: JSON without defaults; "" where it stays still.

    Numbers have :data:`DIGITS` significant digits within the extent of their axis.
    """
    if not moves(picture):
        return ""
    said: dict[str, Any] = {
        "panels": [[_panel(one) for one in row] for row in picture.panels],
        "size": list(picture.size),
    }
    more = {name: getattr(picture, name) for name in ("heights", "share_x", "share_y")}
    said |= {name: value for name, value in more.items() if len(value)}
    if dial is not None:
        pictures = [dial.make(place) for place in range(len(dial.values))]
        said["dial"] = {
            "words": dial.words,
            "values": list(dial.values),
            "told": list(dial.told),
            "start": dial.start,
            "frames": [
                [[_marks(panel) for panel in row] for row in one.panels] for one in pictures
            ],
        }
    arrays: dict[str, int] = {}
    return _written({**_plain(said, arrays), "arrays": [json.loads(one) for one in arrays]})


def compact(said: Any) -> str:
    """JSON in few letters; what is not finite is null."""
    return _written(_plain(said))


def attribute(words: str) -> Markup:
    """``words`` as the value of an attribute between single quotes."""
    return Markup(
        words.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;").replace("'", "&#39;")
    )


def _written(said: Any) -> str:
    return json.dumps(said, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


def _panel(panel: Panel) -> dict[str, Any]:
    found: dict[str, Any] = {
        name: {**_given(axis), "unit": axis.unit} for name, axis in (("x", panel.x), ("y", panel.y))
    } | {"marks": _marks(panel)}
    if panel.title:
        found["title"] = panel.title
    if panel.top:
        found["top"] = {"words": panel.top.words, "factor": panel.top.factor}
    if panel.equal:
        found["equal"] = True
    return found


def _marks(panel: Panel) -> list[dict[str, Any]]:
    return [{"kind": type(m).__name__.lower(), **_given(distinct(m))} for m in panel.marks]


def distinct(mark: Mark) -> Mark:
    """A cloud of points with one for each of :data:`CELLS` x :data:`CELLS` places of its extent.

    The sections of a settled motion lie on each other; marks of fewer points stay as they are.
    """
    if not isinstance(mark, Points) or np.size(mark.x) < DENSE:
        return mark
    places = np.stack([np.ravel(mark.x), np.ravel(mark.y)])
    places = places[:, np.isfinite(places).all(axis=0)]
    low = places.min(axis=1, keepdims=True, initial=np.inf)
    extent = places.max(axis=1, keepdims=True, initial=-np.inf) - low
    cells = np.round(CELLS * (places - low) / np.where(extent > 0.0, extent, 1.0))
    _, first = np.unique(cells, axis=1, return_index=True)
    x, y = places[:, np.sort(first)]
    return replace(mark, x=x, y=y)


def _given(one: Any) -> dict[str, Any]:
    """The fields of a mark or an axis that differ from their defaults."""
    found = {}
    for known in fields(one):
        value, default = getattr(one, known.name), known.default
        told = value.size if isinstance(value, np.ndarray) else value != default
        if known.name != "pixels" and (default is MISSING or told):
            found[known.name] = value
    return found


def _plain(value: Any, arrays: dict[str, int] | None = None) -> Any:
    """``value`` ready for JSON; with ``arrays``, long ones stand there once: {"in": place}."""
    if isinstance(value, np.ndarray):
        found = _row(value) if value.ndim == 1 else [_plain(one) for one in value]
        if arrays is None or value.ndim != 1 or value.size < SHORT:
            return found
        return {"in": arrays.setdefault(_written(_evenly(value) or found), len(arrays))}
    if isinstance(value, np.generic):
        return _plain(value.item(), arrays)
    if isinstance(value, Mapping):
        return {name: _plain(one, arrays) for name, one in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(one, arrays) for one in value]
    return _number(value) if isinstance(value, float) else value


def _row(values: Any) -> list[float | int | None]:
    return [_number(one) for one in _rounded(values).tolist()]


def _evenly(values: Any) -> dict[str, Any] | None:
    """The ends and the count of numbers in equal steps; None of others."""
    if not np.isfinite(values).all():
        return None
    room = 0.1**DIGITS * float(abs(values[-1] - values[0]))
    if not room or np.abs(values - np.linspace(values[0], values[-1], values.size)).max() > room:
        return None
    return {"from": _number(float(values[0])), "to": _number(float(values[-1])), "n": values.size}


def _rounded(values: Any) -> Any:
    """To the digits one can see: DIGITS of the range of the values; a few, or decades, in full."""
    known = values[np.isfinite(values)]
    if values.size < SHORT or not known.size:
        return values
    size = float(np.abs(known).max())
    spread = float(known.max() - known.min()) or size
    if size == 0.0:
        return values
    small = np.abs(known[known != 0.0]).min() if (known != 0.0).any() else size
    if size / small > 10.0**DIGITS:
        return values  # over decades each number keeps its own digits
    return np.round(values, DIGITS - 1 - math.floor(math.log10(spread)))


def _number(value: float) -> float | int | None:
    if not math.isfinite(value):
        return None
    short = float(f"{value:.{DIGITS + 4}g}")
    return int(short) if short.is_integer() and abs(short) < 1e15 else short


# --- the page's one script ------------------------------------------------------------------------


def _read(name: str) -> str:
    return (files("thermogear.views") / "script" / name).read_text("utf-8").strip()


def script_of(own: str) -> str:
    """Plots, gears and pictures with a page's ``own`` script behind them, in one closed piece."""
    licence = f"/*! uPlot 1.6.32\n{_read('uplot.LICENSE')}\n*/"
    pieces = "\n".join((licence, *(_read(name) for name in SCRIPTS), own))
    return f'(() => {{\n"use strict";\n{pieces}\n}})();'


@cache
def script() -> Markup:
    """The text of the script of a report."""
    return Markup(f"//<![CDATA[\n{script_of(_read(PAGE))}\n//]]>")


@cache
def sheet() -> Markup:
    """The style that the script's pictures need."""
    return Markup("\n".join(_read(name) for name in SHEETS))


@cache
def policy() -> str:
    """What the page may do: run this script alone, and ask for nothing from anywhere."""
    known = base64.b64encode(hashlib.sha256(script().encode()).digest()).decode()
    return (
        f"default-src 'none'; script-src 'sha256-{known}'; style-src 'unsafe-inline'; "
        "img-src data:; base-uri 'none'; form-action 'none'"
    )
