"""What a page is made of: sections of texts, tables and pictures, and the figures behind them."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from importlib.resources import files
from itertools import chain, groupby, zip_longest
from textwrap import wrap
from typing import Any

from markupsafe import Markup

from thermogear.base.arrays import Dataset
from thermogear.results.files import finite
from thermogear.results.result import Notice, Result
from thermogear.views.heading import who
from thermogear.views.moving import Dial, attribute, compact, moving, policy, script, sheet
from thermogear.views.picture import Picture
from thermogear.views.svg import draw, shared_styles
from thermogear.views.typesetting import prose

Cell = str | Markup


@dataclass(frozen=True)
class Text:
    """A paragraph; ``tone`` is "plain", "note", "jam" or "title"."""

    words: Cell
    tone: str = "plain"
    kind: str = "text"


@dataclass(frozen=True)
class Table:
    """A table; the first ``names`` columns hold words, the others numbers.

    ``marked`` are the rows that want attention. ``figures`` are the same rows in full: words, and
    numbers in the units of the head.
    """

    caption: str
    head: Sequence[Cell]
    rows: Sequence[Sequence[Cell]]
    names: int = 1
    marked: frozenset[int] = frozenset()
    wordy: bool = False
    figures: Sequence[Sequence[Any]] = ()
    kind: str = "table"


@dataclass(frozen=True)
class Shown:
    """A picture with its heading and a caption that says what one should see.

    ``name`` is that of its file; it is made when it is first drawn. On a page ``dial`` turns it,
    or ``gears``, the drawings that the script turns through a mesh period.
    """

    name: str
    heading: str
    caption: Cell
    make: Callable[[], Picture] = field(repr=False)
    wide: bool = False
    dial: Dial | None = field(default=None, repr=False)
    gears: Callable[[], Any] | None = field(default=None, repr=False)

    @cached_property
    def picture(self) -> Picture:
        """What is seen, as data: axes with words and units, curves, marks; ``to_json()`` of it."""
        return self.make()

    @property
    def svg(self) -> Markup:
        """The picture as a piece of a page."""
        return draw(self.picture, f"fig-{self.name}", self.heading)

    @property
    def data(self) -> tuple[str, Markup] | None:
        """What the page's script draws it from, its kind first; None where it stays still."""
        if self.gears is not None:
            return "gears", attribute(compact(self.gears()))
        told = moving(self.picture, self.dial)
        return ("picture", attribute(told)) if told else None


@dataclass(frozen=True)
class Gallery:
    """Pictures side by side where there is room."""

    pictures: Sequence[Shown]
    kind: str = "gallery"


@dataclass(frozen=True)
class Code:
    """A text shown letter by letter."""

    words: str
    kind: str = "code"


Block = Text | Table | Gallery | Code


def shown_in(blocks: Iterable[Block]) -> list[Shown]:
    """The pictures among ``blocks``, in their order."""
    return [one for block in blocks if isinstance(block, Gallery) for one in block.pictures]


TYPEWRITTEN = str.maketrans(
    {"µ": "u", "±": "+-", "−": "-", "–": "-", "→": "->", "°": "deg", "′": "'", "⁻": "-"}
    | dict(zip("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789", strict=True))
)
"""Letters of a page as any terminal has them."""


def typed(text: Cell) -> str:
    """A cell of a page as any terminal shows it: no marks, no letters that may be missing."""
    words = text.striptags() if isinstance(text, Markup) else text
    return words.replace("·10", "e").replace("10⁸", "1e8").translate(TYPEWRITTEN)


def lines_of(*blocks: Block) -> list[str]:
    """Texts, codes and tables as lines of a terminal: words to the left, numbers to the right.

    Heads are folded over their columns; what is neither is left out.
    """
    lines: list[str] = []
    for block in blocks:
        if isinstance(block, Text):
            lines.append(typed(block.words))
        elif isinstance(block, Code):
            lines += block.words.splitlines()
        elif isinstance(block, Table):
            lines += [*[typed(block.caption)] * bool(block.caption), *_grid(block)]
    return lines


def _grid(table: Table) -> Iterator[str]:
    columns = [[*map(typed, cells)] for cells in zip(table.head, *table.rows, strict=True)]
    widths = [max(map(len, [" ", *head.split(), *cells])) for head, *cells in columns]
    heads = [wrap(head, width) for (head, *_), width in zip(columns, widths, strict=True)]
    body = zip(*(cells[1:] for cells in columns), strict=True)
    for line in [*zip_longest(*heads, fillvalue=""), *body]:
        placed = zip(line, widths, range(len(widths)), strict=True)
        words = (c.ljust(w) if k < table.names else c.rjust(w) for c, w, k in placed)
        yield f"  {'  '.join(words)}".rstrip()


@dataclass(frozen=True)
class Section:
    """A part of the page with its place in the navigation; ``folded`` until a reader opens it."""

    name: str
    title: str
    blocks: Sequence[Block]
    folded: bool = True

    @property
    def inside(self) -> str:
        """What a reader finds in it: how many pictures and tables."""
        counts = {
            "picture": len(shown_in(self.blocks)),
            "table": sum(isinstance(one, Table) for one in self.blocks),
        }
        return ", ".join(f"{n} {word}{'s' * (n > 1)}" for word, n in counts.items() if n)


@dataclass
class Pictures:
    """Collects pictures while their data are there, each under a name of its own."""

    found: list[Shown] = field(default_factory=list)
    _names: set[str] = field(default_factory=set)

    def add(
        self,
        name: str,
        heading: str,
        caption: Cell,
        data: Dataset,
        needs: Iterable[str],
        make: Callable[[], Picture],
        wide: bool = False,
        *,
        dial: Dial | None = None,
        gears: Callable[[], Any] | None = None,
    ) -> None:
        """Keep the picture unless ``data`` lacks one of the variables it ``needs``."""
        if not all(need in data.variables for need in needs):
            return
        if name in self._names:
            raise ValueError(f"two pictures named {name}")
        self._names.add(name)
        self.found.append(Shown(name, heading, caption, make, wide, dial, gears))

    def take(self) -> list[Block]:
        """The pictures added since the last call, as galleries: wide ones by themselves."""
        blocks = galleries(self.found)
        self.found = []
        return blocks


def galleries(pictures: Iterable[Shown]) -> list[Block]:
    """Pictures as galleries in their order: wide ones by themselves."""
    blocks: list[Block] = []
    for wide, some in groupby(pictures, key=lambda one: one.wide):
        row = [*some]
        blocks += [Gallery([one]) for one in row] if wide else [Gallery(row)]
    return blocks


LEAD = "pictures"
"""The section of the pictures that carry the answer."""


class Made(Sequence[Section]):
    """Sections that are made when one first looks at them; a terminal does not."""

    def __init__(self, make: Callable[[], Sequence[Section]]) -> None:
        self._make = make

    @cached_property
    def _there(self) -> Sequence[Section]:
        return self._make()

    def __getitem__(self, place: Any) -> Any:
        return self._there[place]

    def __len__(self) -> int:
        return len(self._there)


@dataclass(frozen=True)
class Page:
    """Everything a reader gets of one result, in a page, in a terminal, as files.

    ``numbers`` makes the figures a script wants (JSON-ready), ``told`` the texts and tables that a
    terminal shows, ``tables`` CSV texts by the names of their files. ``files`` are the kinds of
    picture that stand beside the page, ``most`` is how many notices a terminal shows at the most.
    ``first`` are the pictures that carry the answer, each by its names in order of preference: what
    a page shows that is asked for no more.
    """

    result: Result
    summary: Cell
    sections: Sequence[Section]
    numbers: Callable[[], Mapping[str, Any]] = dict
    told: Callable[[], Iterable[Block]] = tuple
    tables: Callable[[], Mapping[str, str]] = dict
    files: tuple[str, ...] = ()
    most: int | None = None
    first: Sequence[Sequence[str]] = ()

    def showing(self, which: str, every: str) -> Page:
        """The same page with the ``which`` of :data:`SHOWN` of its pictures, and no others drawn.

        The pictures kept stand together behind the first section, with ``every``: how to get all.
        """
        there = [one.name for one in self.pictures]
        if which == "all" or not self.first or not there:
            return self
        kept = self.leading if which == "first" else []
        told = Text(f"{len(kept)} of {len(there)} pictures. {every}", "note")
        shown = Section(LEAD, "In pictures", [*galleries(kept), told], folded=False)
        rest = [one for one in map(_without_pictures, self.sections) if one.blocks]
        return replace(self, sections=[*rest[:1], shown, *rest[1:]])

    @property
    def leading(self) -> list[Shown]:
        """The pictures that carry the answer."""
        there = {one.name: one for one in self.pictures}
        found = (next((n for n in names if n in there), "") for names in self.first)
        return [there[name] for name in found if name] or [*there.values()][: len(self.first)]

    @property
    def parts(self) -> list[Section]:
        """The sections as a reader meets them: the open ones, pictures first, then the folded."""
        sections = [one for one in self.sections if one.blocks]
        leading = self.leading if all(one.name != LEAD for one in sections) else []
        if leading:
            names = {one.name for one in leading}
            sections = [
                Section(LEAD, "In pictures", galleries(leading), folded=False),
                *(one for one in (without(part, names) for part in sections) if one.blocks),
            ]
        if sections and all(one.folded for one in sections):
            sections[0] = replace(sections[0], folded=False)
        return sorted(sections, key=lambda one: one.folded)

    @property
    def figures(self) -> dict[str, Any]:
        """The figures a script wants, with the notices; what is not finite is None."""
        numbers, result = self.numbers(), self.result
        head = {"thermogear": result.text("thermogear"), "title": result.title, "kind": result.kind}
        notices = [notice.as_dict() for notice in result.notices]
        return {**finite({**head, **numbers}), "notices": notices} if numbers else {}

    def lines(self) -> list[str]:
        """What a terminal shows, the notices last."""
        return [*lines_of(*self.told()), *notice_lines(self.result, self.most)]

    @property
    def pictures(self) -> Iterator[Shown]:
        """Every picture, in the order of the page."""
        return chain.from_iterable(shown_in(section.blocks) for section in self.sections)


def without(section: Section, names: Collection[str]) -> Section:
    """The section without the pictures of these ``names``."""
    kept = (
        galleries(one for one in block.pictures if one.name not in names)
        if isinstance(block, Gallery)
        else [block]
        for block in section.blocks
    )
    return replace(section, blocks=[*chain.from_iterable(kept)])


def _without_pictures(section: Section) -> Section:
    """Its tables and warnings; words that speak of its pictures go with them."""
    if not any(isinstance(block, Gallery) for block in section.blocks):
        return section
    return replace(
        section,
        blocks=[
            block
            for block in section.blocks
            if not isinstance(block, Gallery)
            and not (isinstance(block, Text) and block.tone != "jam")
        ],
    )


OPEN = 3
"""Notes above the first picture; the others fold."""
LEVELS = {"important": "Important", "warning": "Mind", "info": "Note"}


def told(notices: Iterable[Notice]) -> list[tuple[str, str, Markup]]:
    """(level, its word, text) of every notice, most important first."""
    found = sorted(notices, key=lambda one: [*LEVELS].index(one.level))
    return [(one.level, LEVELS[one.level], prose(one.text)) for one in found]


def notice_lines(result: Result, most: int | None = None) -> list[str]:
    """Notices as lines of a terminal: all, or the ``most`` important ones and how many more."""
    shown, more = result.notices, len(result.notices) - (most or len(result.notices))
    if more > 0:
        order = ["notices_hidden", *LEVELS]  # how many are hidden is always said
        ranked = sorted(shown, key=lambda n: order.index(n.code if n.code in order else n.level))
        shown = tuple(ranked[:most])
    lines = [f"- {' '.join(one.text.split())}" for one in shown]
    return [*lines, f"- {more} more note{'s' * (more > 1)} on the page"] if more > 0 else lines


@cache
def style() -> str:
    """The style sheet that pages share."""
    return (files("thermogear.views") / "templates" / "page.css").read_text("utf-8")


def render(page: Page) -> str:
    """The whole page as text: it needs no other file and no network.

    Its one script lets the pictures move; without it they are shown still.
    """
    import jinja2  # what only prints does without it

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("thermogear.views"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    parts = page.parts
    return shared_styles(
        environment.get_template("report.html").render(
            title=" ".join(page.result.title.split()) or "thermogear",
            who=who(page.result),
            style=Markup(style()) + sheet(),
            script=script() if any(page.pictures) else "",
            policy=policy(),
            summary=page.summary if isinstance(page.summary, Markup) else prose(page.summary),
            notices=told(page.result.notices),
            open=OPEN,
            sections=parts,
            folded=any(one.folded for one in parts),
            version=page.result.text("thermogear"),
        )
    )
