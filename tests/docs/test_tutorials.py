"""The tutorials run as plain Python, cell after cell, and their own assertions hold."""

from __future__ import annotations

import json
import re
from pathlib import Path

import matplotlib as mpl
import pytest

FOLDER = Path(__file__).parents[2] / "docs" / "tutorials"
NOTEBOOKS = sorted(FOLDER.glob("*.md"))
SMALL = 400e3
"""Bytes of a notebook in the tree; chosen, so that all seven stay below 2 MB."""
ASKED = ("bifurcation", "hot_backlash", "own_gear", "own_record", "rig", "tip_relief")

_CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```[ \t]*$", re.MULTILINE | re.DOTALL)


def cells(text: str) -> list[tuple[int, str]]:
    """The code of every cell with the line it begins at, options of the cell left out."""
    found = []
    for match in _CELL.finditer(text):
        lines = match[1].splitlines()
        options = 0
        while options < len(lines) and lines[options].startswith(":"):
            options += 1
        first = text.count("\n", 0, match.start(1)) + 1 + options
        found.append((first, "\n".join(lines[options:])))
    return found


def notebooks() -> list[Path]:
    """The tutorials that have cells; an index page has none."""
    return [path for path in NOTEBOOKS if cells(path.read_text(encoding="utf-8"))]


def test_every_tutorial_is_there() -> None:
    assert {path.stem for path in notebooks()} >= set(ASKED)


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_a_tutorial_is_a_notebook_with_assertions(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    assert text.startswith("---\n")
    assert re.search(r"format_name:\s*myst", text.split("---\n")[1])
    code = [source for _, source in cells(text)]
    assert text.count("```{code-cell}") == len(code)
    assert sum(source.count("assert ") for source in code) >= 3
    assert not re.search(r"thermogear\.\w+ import|import thermogear\.", "\n".join(code))


@pytest.mark.slow
@pytest.mark.usefixtures("warmed_once")
@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_a_tutorial_runs(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import matplotlib.pyplot as plt

    monkeypatch.chdir(tmp_path)
    before = mpl.get_backend()
    plt.switch_backend("agg")
    names: dict[str, object] = {"__name__": "__main__"}
    try:
        with mpl.rc_context():
            for line, source in cells(path.read_text(encoding="utf-8")):
                # as many empty lines before, so that a failure names the notebook's own line
                exec(compile("\n" * (line - 1) + source, str(path), "exec"), names)
                for number in plt.get_fignums():
                    _check_labels(plt.figure(number))
                plt.close("all")
    finally:
        plt.close("all")
        plt.switch_backend(before)
    capsys.readouterr()


def _check_labels(figure: mpl.figure.Figure) -> None:
    """Every axis that is drawn says what it shows; the picture can be drawn."""
    figure.canvas.draw()
    for axes in figure.axes:
        if not axes.axison:
            continue
        for axis in (axes.xaxis, axes.yaxis):
            shows = axis.get_visible() and any(t.get_visible() for t in axis.get_ticklabels())
            if shows and any(t.get_text() for t in axis.get_ticklabels()):
                assert axis.get_label_text(), f"an axis without a label in {axes}"


@pytest.mark.parametrize("path", notebooks(), ids=lambda path: path.stem)
def test_the_executed_notebook_is_that_of_the_page(path: Path) -> None:
    """`python checks/notebooks.py` wrote it: the cells, all run in order, none with an error."""
    stored = FOLDER.parents[1] / "notebooks" / f"{path.stem}.ipynb"
    assert stored.stat().st_size < SMALL
    code = [c for c in json.loads(stored.read_text("utf-8"))["cells"] if c["cell_type"] == "code"]
    assert ["".join(c["source"]) for c in code] == [source for _, source in cells(path.read_text())]
    assert [c["execution_count"] for c in code] == list(range(1, len(code) + 1))
    kinds = {output["output_type"] for c in code for output in c["outputs"]}
    assert kinds <= {"stream", "display_data", "execute_result"}
