"""A picture as data: panels, their axes and what stands in them. Nothing here draws.

Lengths are in points, sizes of pictures in inches, values in the unit that the axis names. A text
holds an index as ``$_{f}$`` and a dollar sign as ``\\$``; a colour is ``#rrggbb``, "white", or ""
for that of the text.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, field, fields, is_dataclass
from typing import Any, Concatenate, ParamSpec

import numpy as np
from numpy.typing import ArrayLike

from thermogear.views.style import ABOVE, BETWEEN, BOTTOM, LEFT, QUIET, RIGHT, SINGLE, TOP

Dash = tuple[float, ...]
"""Lengths [pt] of strokes and gaps; () is a solid line."""
_UNIT = re.compile(r"\[([^\[\]]+)\]")
_P = ParamSpec("_P")


class Mark:
    """One thing in a panel. ``order``: what is higher lies over what is lower."""

    def __post_init__(self) -> None:
        for one in fields(self):  # type: ignore[arg-type]
            if one.type == "ArrayLike":
                values = np.asarray(getattr(self, one.name), dtype=float)
                object.__setattr__(self, one.name, values)


@dataclass(frozen=True, eq=False)
class Curve(Mark):
    """A line through points, broken where one is not finite; without points an entry of the legend.

    ``pixels``: it has so many points that a file keeps it as pixels.
    """

    x: ArrayLike
    y: ArrayLike
    _: KW_ONLY
    colour: str
    width: float = 1.7
    dash: Dash = ()
    marker: str = ""
    size: float = 6.0
    opacity: float = 1.0
    order: float = 2.0
    label: str = ""
    pixels: bool = False


@dataclass(frozen=True, eq=False)
class Points(Mark):
    """Markers without a line, ``open`` or filled; ``edge`` is the rim's colour, else their own."""

    x: ArrayLike
    y: ArrayLike
    _: KW_ONLY
    colour: str
    marker: str = "circle"
    size: float = 6.0
    open: bool = False
    edge: str = ""
    edge_width: float = 1.0
    opacity: float = 1.0
    order: float = 2.0
    label: str = ""
    pixels: bool = False


@dataclass(frozen=True, eq=False)
class Stems(Mark):
    """Spectral lines: a stem from ``low`` up to each (x, y) and a head on it."""

    x: ArrayLike
    y: ArrayLike
    _: KW_ONLY
    low: float
    colour: str
    size: float
    open: bool = False
    order: float = 2.0
    label: str = ""


@dataclass(frozen=True, eq=False)
class Band(Mark):
    """The area between two curves over ``x``; ``at`` = "x": their y are parts of the height."""

    x: ArrayLike
    _: KW_ONLY
    low: ArrayLike
    high: ArrayLike
    colour: str
    opacity: float = 1.0
    step: bool = False
    at: str = "data"
    order: float = 1.0
    label: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Span(Mark):
    """The stretch of one axis over the whole panel: ``x`` or ``y`` = (from, to)."""

    x: tuple[float, float] | None = None
    y: tuple[float, float] | None = None
    colour: str
    opacity: float = 1.0
    order: float = 1.0
    label: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Line(Mark):
    """A straight line over the whole panel at ``x`` (upright) or at ``y``."""

    x: float | None = None
    y: float | None = None
    colour: str
    width: float
    dash: Dash = ()
    opacity: float = 1.0
    order: float = 2.0
    label: str = ""


@dataclass(frozen=True, eq=False)
class Text(Mark):
    """Words at a place: in "data", in parts of the "panel", or one of both ("x" or "y" in data).

    ``across`` and ``up`` say which side of the words is there, moved on by ``offset`` [pt].
    """

    x: float
    y: float
    words: str
    _: KW_ONLY
    at: str = "data"
    across: str = "center"
    up: str = "center"
    offset: tuple[float, float] = (0.0, 0.0)
    size: float = 8.5
    colour: str = ""
    bold: bool = False
    box: bool = False
    wrap: bool = False
    order: float = 3.0


@dataclass(frozen=True, eq=False)
class Bars(Mark):
    """Bars from 0 up to ``y``, centred at ``x``, each with its own of ``words`` on top."""

    x: ArrayLike
    y: ArrayLike
    _: KW_ONLY
    width: float
    colour: str
    words: Sequence[str] = ()
    order: float = 1.0
    label: str = ""


@dataclass(frozen=True, eq=False)
class Field(Mark):
    """Colours over two axes by ``values`` of shape (y, x), with a colour bar where it has words.

    Cells between the borders ``x`` and ``y``; with ``levels``, filled contours over the places
    ``x`` and ``y``. ``colours`` run evenly from ``low`` to ``high``; with ``classes`` each whole
    number has a colour and a name of its own.
    """

    x: ArrayLike
    y: ArrayLike
    values: ArrayLike
    _: KW_ONLY
    colours: Sequence[str]
    classes: Sequence[str] = ()
    levels: ArrayLike = ()
    low: float | None = None
    high: float | None = None
    log: bool = False
    words: str = ""


@dataclass(frozen=True, eq=False)
class Contours(Mark):
    """Lines along which ``values`` of shape (y, x) have a level, each with its words on it."""

    x: ArrayLike
    y: ArrayLike
    values: ArrayLike
    _: KW_ONLY
    levels: ArrayLike
    words: Sequence[str]


@dataclass(frozen=True, eq=False)
class Hatch(Mark):
    """Hatches where ``values`` of shape (y, x) are above 0.5."""

    x: ArrayLike
    y: ArrayLike
    values: ArrayLike


@dataclass
class Axis:
    """Words with the [unit], and the ends; where there is none the data with ``margin`` say it.

    ``log``: "" is linear; else logarithmic with ticks at "decades" written as powers, at decades
    as "plain" numbers, or at decades and between ("full"). ``ticks`` may have ``names``; ``most``:
    at most so many, ``inner``: none at the ends. ``small``: its words stand small and close.
    """

    words: str = ""
    _: KW_ONLY
    low: float | None = None
    high: float | None = None
    log: str = ""
    ticks: ArrayLike = ()
    names: Sequence[str] = ()
    slant: float = 0.0
    most: int = 0
    inner: bool = False
    margin: float = 0.05
    small: bool = False
    grid: bool = True

    @property
    def unit(self) -> str:
        """What stands in the brackets."""
        return found[1] if (found := _UNIT.search(self.words)) else ""


@dataclass(frozen=True)
class Top:
    """A second horizontal axis on top of a panel: ``factor`` times the one below."""

    words: str
    factor: float


def _adds(kind: Callable[_P, Mark]) -> Callable[Concatenate[Panel, _P], None]:
    """A method of a panel that adds a mark of this kind."""

    def add(panel: Panel, /, *args: _P.args, **look: _P.kwargs) -> None:
        panel.marks.append(kind(*args, **look))

    add.__doc__ = f"Add {kind.__doc__}"
    return add


@dataclass
class Panel:
    """Two axes and what stands between them; ``equal``: both have one scale."""

    x: Axis = field(default_factory=Axis)
    y: Axis = field(default_factory=Axis)
    title: str = ""
    _: KW_ONLY
    top: Top | None = None
    equal: bool = False
    background: str = ""
    marks: list[Mark] = field(default_factory=list)

    curve = _adds(Curve)
    points = _adds(Points)
    stems = _adds(Stems)
    band = _adds(Band)
    span = _adds(Span)
    line = _adds(Line)
    text = _adds(Text)
    bars = _adds(Bars)
    field = _adds(Field)
    contours = _adds(Contours)
    hatch = _adds(Hatch)

    def note(self, words: str) -> None:
        """Add a sentence in the middle of a panel that has nothing to draw."""
        self.text(0.5, 0.5, words, at="panel", size=9.0, colour=QUIET, wrap=True)

    def extent(self, axis: str) -> tuple[float, float]:
        """(low, high) of curves, points and lines along "x" or "y", with the axis's margin."""
        found: list[Any] = []
        for mark in self.marks:
            if isinstance(mark, Curve | Points):
                x, y = np.ravel(mark.x), np.ravel(mark.y)
                found.extend((x if axis == "x" else y)[np.isfinite(x) & np.isfinite(y)])
            elif isinstance(mark, Line) and getattr(mark, axis) is not None:
                found.append(getattr(mark, axis))
        low, high = (float(min(found)), float(max(found))) if found else (0.0, 0.0)
        if low == high:
            room = 0.05 * abs(low) or 0.05
            low, high = low - room, high + room
        room = getattr(self, axis).margin * (high - low)
        return low - room, high + room


@dataclass(frozen=True, eq=False)
class Picture:
    """Panels in rows and columns, and the legend of everything that has a label below them.

    ``size`` is (width, height) without the legend, which has at most so many columns; ``top``,
    ``left``, ``right`` and ``bottom`` are margins, ``between`` columns and ``above`` each further
    row is room, ``heights`` the rows' shares, all [in]. ``share_x`` and ``share_y``: panels of a
    "row" or a "column" have the same axis. ``resolution`` [1/in] of what is kept as pixels.
    """

    panels: Sequence[Sequence[Panel]]
    _: KW_ONLY
    size: tuple[float, float] = SINGLE
    title: str = ""
    legend: int = 3
    top: float = TOP
    left: float = LEFT
    right: float = RIGHT
    bottom: float = BOTTOM
    between: float = BETWEEN
    above: float = ABOVE
    heights: Sequence[float] = ()
    share_x: str = ""
    share_y: str = ""
    resolution: float = 100.0

    def to_json(self) -> dict[str, Any]:
        """Everything as plain values, ready for JSON; what is not finite is None.

        Each mark says its ``kind``, each axis its ``unit``.
        """
        found = _plain(self)
        assert isinstance(found, dict)
        return found


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        found = {one.name: _plain(getattr(value, one.name)) for one in fields(value)}
        if isinstance(value, Mark):
            found = {"kind": type(value).__name__.lower(), **found}
        return {**found, "unit": value.unit} if isinstance(value, Axis) else found
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
