"""The pictures of a page by themselves: as files, or in a notebook."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import xarray as xr
from markupsafe import Markup

from thermogear.base.errors import InputError
from thermogear.base.files import require_directory
from thermogear.results.result import KINDS as RUNS
from thermogear.results.result import read_results, results_of
from thermogear.views import picture as data
from thermogear.views.drawing import image
from thermogear.views.page import Picture, Pictures
from thermogear.views.report import ORDER, with_hot_temperature
from thermogear.views.survey_sections import SURVEYS
from thermogear.views.svg import put_picture

KINDS = ("png", "svg", "pdf")
RESOLUTION = 130
"""Dots per inch of the PNG files."""


@dataclass(frozen=True)
class ReportPicture:
    """A picture of a report; a notebook shows it where it stands last in a cell.

    ``heading`` and ``caption`` say what one should see. It is made when first asked for.
    """

    name: str
    heading: str
    caption: str
    make: Callable[[], data.Picture] = field(repr=False)

    @cached_property
    def picture(self) -> data.Picture:
        """What is seen, as data: axes with words and units, curves, marks; ``to_json()`` of it."""
        return self.make()

    @cached_property
    def image(self) -> bytes:
        """Its PNG file, on white."""
        return image(self.picture, "png", dpi=RESOLUTION, facecolor="white")

    def _repr_png_(self) -> bytes:
        """For the notebook."""
        return self.image


@dataclass
class _Shown(Pictures):
    """Keeps every picture, to be drawn when it is asked for."""

    found: dict[str, ReportPicture] = field(default_factory=dict)

    def keep(self, name: str, picture: Picture, make: Callable[[], data.Picture]) -> None:
        caption = picture.caption
        words = caption.striptags() if isinstance(caption, Markup) else caption
        self.found[name] = ReportPicture(name, picture.heading, words, make)


def pictures(results: xr.DataTree | str | Path) -> dict[str, ReportPicture]:
    """Every picture of a report by its name, in page order.

    ``results``: what :func:`~thermogear.run` or :func:`~thermogear.relief_survey` returns, or a
    directory that holds a run's. The names are those of the files that the command line writes.
    Raises InputError where they are neither.
    """
    held = results_of(results) if isinstance(results, xr.DataTree) else read_results(Path(results))
    kind = held.texts.get("kind")
    if kind in SURVEYS:
        survey = SURVEYS[kind](held.texts, held.groups)
        return {
            one.name: ReportPicture(one.name, one.heading, one.caption, one.make)
            for one in survey.pictures
        }
    if kind not in RUNS:
        raise InputError("results", "no tree of a run", fix="give what run(case) returns")
    shown = _Shown()
    held = with_hot_temperature(held)
    for make in ORDER:
        make(held, shown)
    return shown.found


@dataclass
class _Files(Pictures):
    """Saves every picture instead of putting it into a page."""

    folder: Path = Path()
    kind: str = "png"
    written: list[Path] = field(default_factory=list)

    def keep(self, name: str, picture: Picture, make: Callable[[], data.Picture]) -> None:
        path = self.folder / f"{name}.{self.kind}"
        self.written.append(put_picture(make(), path, resolution=RESOLUTION))


def write_pictures(directory: Path, folder: Path, kind: str = "png") -> list[Path]:
    """Save every picture of the page of ``directory`` to ``folder``; the paths, in page order.

    ``kind`` is png, svg or pdf. Existing files of the same names are replaced. Raises InputError,
    in one line, where the results are missing or damaged or the kind is unknown.
    """
    if kind not in KINDS:
        raise InputError("kind", repr(kind), allowed=" | ".join(KINDS))
    results = with_hot_temperature(read_results(Path(directory)))
    folder = Path(folder)
    require_directory(folder, "pictures")
    folder.mkdir(parents=True, exist_ok=True)
    files = _Files(folder=folder, kind=kind)
    for make in ORDER:
        make(results, files)
    return files.written
