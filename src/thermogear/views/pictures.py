"""The pictures of a page as files of their own, for a paper or a slide."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from matplotlib.figure import Figure

from thermogear.base.errors import InputError
from thermogear.views.page import Picture, Pictures
from thermogear.views.report import ORDER
from thermogear.views.results import read_results
from thermogear.views.style import styled

KINDS = ("png", "svg", "pdf")


@dataclass
class _Files(Pictures):
    """Saves every picture instead of putting it into a page."""

    folder: Path = Path()
    kind: str = "png"
    written: list[Path] = field(default_factory=list)

    def keep(self, name: str, picture: Picture, make: Callable[[], Figure]) -> None:
        path = self.folder / f"{name}.{self.kind}"
        with styled():
            make().savefig(path, dpi=130, facecolor="white")
        self.written.append(path)


def write_pictures(directory: Path, folder: Path, kind: str = "png") -> list[Path]:
    """Save every picture of the page of ``directory`` to ``folder``; the paths, in page order.

    ``kind`` is png, svg or pdf. Existing files of the same names are replaced. Raises InputError,
    in one line, where the results are missing or damaged or the kind is unknown.
    """
    if kind not in KINDS:
        raise InputError("kind", repr(kind), allowed=" | ".join(KINDS))
    results = read_results(Path(directory))
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    files = _Files(folder=folder, kind=kind)
    for make in ORDER:
        make(results, files)
    return files.written
