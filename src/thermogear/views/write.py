"""Files of a result: its page, pictures, tables and figures, each drawn from the result alone."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from markupsafe import Markup

from thermogear.base.errors import InputError
from thermogear.base.files import put, require_directory
from thermogear.results.files import RESULTS, SUMMARY, claimed, json_text
from thermogear.results.result import Result, open_results
from thermogear.views.page import Page, Shown, render
from thermogear.views.pages import PAGES
from thermogear.views.picture import Picture
from thermogear.views.svg import put_picture

KINDS = ("png", "svg", "pdf")
RESOLUTION = 160
"""Dots per inch of the PNG files."""
IN_NOTEBOOK = 130
_OURS = re.compile(r".+_by_[a-z_]+")
"""Tables that earlier runs may have left behind in ``csv``."""


def page_of(result: Result) -> Page:
    """The page of ``result``; InputError where its kind has none, or where it is no result."""
    if not isinstance(result, Result):
        got = type(result).__name__
        raise InputError("results", got, fix="give what run(case), or another study, returns")
    if result.kind not in PAGES:
        raise InputError("results", f"kind {result.kind!r}", allowed=" | ".join(PAGES))
    return PAGES[result.kind](result)


def names(result: Result) -> tuple[str, str]:
    """The file names of the page and of the figures of ``result``."""
    if result.file == RESULTS or result.stored:
        return "report.html", SUMMARY
    return f"{result.kind}.html", f"{result.kind}.json"


def write(page: Page, folder: Path, *, tables: bool = True) -> list[Path]:
    """The page, its pictures, ``tables`` and figures in ``folder``; the files, the page first.

    The page needs no other file, no script and no network; the same result gives the same page.
    """
    html, figures = names(page.result)
    written = [put(folder / html, render(page))]
    numbers = page.figures
    if numbers:
        written.append(put(folder / figures, json_text(numbers)))
    for one in page.pictures if page.files else ():
        for ending in page.files:
            path = folder / f"{_stem(page, one)}.{ending}"
            written.append(put_picture(one.picture, path, resolution=RESOLUTION))
    return written + (write_tables(page, folder) if tables else [])


def write_tables(page: Page, folder: Path) -> list[Path]:
    """The tables of ``page`` in ``folder``, as CSV; the files."""
    texts = page.tables()
    for name in texts:
        (folder / name).parent.mkdir(exist_ok=True)
    return [put(folder / name, text) for name, text in texts.items()]


def _stem(page: Page, one: Shown) -> str:
    """The name of a picture's file beside the page."""
    kind = page.result.kind
    return kind if one.name == kind else f"{kind}_{one.name}"


def clear_tables(directory: Path, kept: list[Path]) -> None:
    """Remove what earlier runs left in ``directory/csv``: tables of ours not among ``kept``."""
    stay = {path.name for path in kept}
    for old in (directory / "csv").glob("*.csv"):
        if old.name not in stay and _OURS.fullmatch(old.stem):
            old.unlink()


def save(result: Result, directory: str | Path) -> list[Path]:
    """Store ``result`` in ``directory`` with its page, pictures, tables and figures; the files.

    The directory is made if new; one that holds anything else than results of ours is refused
    with an InputError. All of it is written, or after an error or Ctrl+C nothing.
    """
    directory = Path(directory)
    page = page_of(result)
    with claimed(directory) as folder:
        written = [result.put(folder), *write(page, folder)]
    clear_tables(directory, written)
    return [directory / path.relative_to(folder) for path in written]


def save_results(result: Result, directory: str | Path) -> dict[str, Any]:
    """Store ``result`` in ``directory`` with its figures as JSON, without a page; the figures."""
    numbers = page_of(result).figures
    with claimed(Path(directory)) as folder:
        result.put(folder)
        put(folder / names(result)[1], json_text(numbers))
    return numbers


def write_report(directory: str | Path, kind: str = "", *, hidden: Collection[str] = ()) -> Path:
    """Draw the page of what is stored in ``directory`` anew; its path.

    ``kind`` chooses where results of several studies stand there; notices of the codes ``hidden``
    are left out. Raises InputError, in one line,
    where the results are missing, damaged or not ours.
    """
    directory = Path(directory)
    result = open_results(directory, kind).hiding(hidden)
    return put(directory / names(result)[0], render(page_of(result)))


@dataclass(frozen=True)
class ReportPicture:
    """A picture of a page; a notebook shows it where it stands last in a cell.

    ``heading`` and ``caption`` say what one should see. It is drawn when first asked for.
    """

    shown: Shown

    @property
    def name(self) -> str:
        """The name of its file."""
        return self.shown.name

    @property
    def heading(self) -> str:
        """What it shows."""
        return self.shown.heading

    @property
    def caption(self) -> str:
        """What one should see in it."""
        words = self.shown.caption
        return words.striptags() if isinstance(words, Markup) else words

    @property
    def picture(self) -> Picture:
        """What is seen, as data; ``to_json()`` of it."""
        return self.shown.picture

    @cached_property
    def image(self) -> bytes:
        """Its PNG file, on white."""
        from thermogear.views.drawing import image

        return image(self.picture, "png", dpi=IN_NOTEBOOK, facecolor="white")

    def _repr_png_(self) -> bytes:
        """For the notebook."""
        return self.image


def pictures(results: Result | str | Path) -> dict[str, ReportPicture]:
    """Every picture of a page by its name, in page order.

    ``results``: what any study returns, or a directory that holds such. The names are those of
    the files that the command line writes. Raises InputError where they are neither.
    """
    result = open_results(results) if isinstance(results, str | Path) else results
    return {one.name: ReportPicture(one) for one in page_of(result).pictures}


def write_pictures(directory: Path, folder: Path, kind: str = "png", of: str = "") -> list[Path]:
    """Save every picture of the page of ``directory`` to ``folder``; the paths, in page order.

    ``kind`` is png, svg or pdf; ``of`` chooses where results of several studies stand there.
    Existing files of the same names are replaced. Raises InputError, in one line, where the
    results are missing or damaged or the kind is unknown.
    """
    if kind not in KINDS:
        raise InputError("kind", repr(kind), allowed=" | ".join(KINDS))
    page = page_of(open_results(directory, of))
    folder = Path(folder)
    require_directory(folder, "pictures")
    folder.mkdir(parents=True, exist_ok=True)
    written = []
    for one in page.pictures:
        path = folder / f"{one.name}.{kind}"
        written.append(put_picture(one.picture, path, resolution=IN_NOTEBOOK))
    return written
