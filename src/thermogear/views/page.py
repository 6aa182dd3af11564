"""What a page is made of: sections of texts, tables and pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import jinja2
import xarray as xr
from markupsafe import Markup

from thermogear.views import picture
from thermogear.views.svg import draw
from thermogear.views.words import prose

Cell = str | Markup


@dataclass(frozen=True)
class Text:
    """A paragraph; ``tone`` is "plain", "note" or "jam"."""

    words: Cell
    tone: str = "plain"
    kind: str = "text"


@dataclass(frozen=True)
class Table:
    """A table; the first ``names`` columns hold words, the others numbers.

    ``marked`` are the rows that want attention.
    """

    caption: str
    head: Sequence[Cell]
    rows: Sequence[Sequence[Cell]]
    names: int = 1
    marked: frozenset[int] = frozenset()
    wordy: bool = False
    kind: str = "table"


@dataclass(frozen=True)
class Picture:
    """A drawn picture with its heading and a caption that says what one should see."""

    name: str
    heading: str
    caption: Cell
    svg: Markup
    wide: bool = False


@dataclass(frozen=True)
class Gallery:
    """Pictures side by side where there is room."""

    pictures: Sequence[Picture]
    kind: str = "gallery"


@dataclass(frozen=True)
class Code:
    """A text shown letter by letter."""

    words: str
    kind: str = "code"


Block = Text | Table | Gallery | Code


@dataclass(frozen=True)
class Section:
    """A part of the page with its place in the navigation."""

    name: str
    title: str
    blocks: Sequence[Block]


@dataclass
class Pictures:
    """Draws pictures while their data are there, each under a name of its own."""

    drawn: list[Picture] = field(default_factory=list)
    _names: set[str] = field(default_factory=set)

    def add(
        self,
        name: str,
        heading: str,
        caption: Cell,
        data: xr.Dataset,
        needs: Iterable[str],
        make: Callable[[], picture.Picture],
        wide: bool = False,
    ) -> None:
        """Draw ``make()`` unless ``data`` lacks one of the variables it ``needs``."""
        if not all(need in data.variables for need in needs):
            return
        own = f"fig-{name}"
        if own in self._names:
            raise ValueError(f"two pictures named {name}")
        self._names.add(own)
        self.keep(name, Picture(own, heading, caption, Markup(), wide), make)

    def keep(self, name: str, picture: Picture, make: Callable[[], picture.Picture]) -> None:
        """Draw the picture into the page."""
        svg = draw(make, picture.name, picture.heading)
        self.drawn.append(replace(picture, svg=svg))

    def take(self) -> list[Block]:
        """The pictures drawn since the last call, as galleries: wide ones by themselves."""
        blocks: list[Block] = []
        row: list[Picture] = []
        for one in self.drawn:
            if one.wide:
                if row:
                    blocks.append(Gallery(row))
                    row = []
                blocks.append(Gallery([one]))
            else:
                row.append(one)
        if row:
            blocks.append(Gallery(row))
        self.drawn = []
        return blocks


@dataclass(frozen=True)
class Tile:
    """One figure at the top of the page."""

    title: str
    value: str
    beside: Cell


LEVELS = {"important": "Important", "warning": "Mind", "info": "Note"}


def told(rows: Iterable[Mapping[str, Any]]) -> list[tuple[str, str, Markup]]:
    """(level, its word, text) of every stored notice, most important first."""
    order = list(LEVELS)
    known = [(level if (level := str(row.get("level"))) in LEVELS else "info", row) for row in rows]
    known.sort(key=lambda pair: order.index(pair[0]))
    return [(level, LEVELS[level], prose(row.get("text", ""))) for level, row in known]


def render(
    title: str,
    summary: Cell,
    sections: Sequence[Section],
    version: str,
    tiles: Sequence[Tile] = (),
    notices: Iterable[Mapping[str, Any]] = (),
) -> str:
    """The whole page as text: it needs no other file, no script and no network."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("thermogear.views"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    sheet, _, _ = environment.loader.get_source(environment, "page.css")  # type: ignore[union-attr]
    return environment.get_template("report.html").render(
        title=" ".join(title.split()),
        style=Markup(sheet),
        summary=summary if isinstance(summary, Markup) else prose(summary),
        tiles=tiles,
        notices=told(notices),
        sections=sections,
        version=version,
    )
