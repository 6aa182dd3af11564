"""The tutorials as executed notebooks: ``python checks/notebooks.py [NAME...]`` writes notebooks/.

The pages under docs/tutorials are the source: a notebook has their cells and text, with what a run
of it printed and drew. It needs what `make docs` installs.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGES, TARGET = ROOT / "docs" / "tutorials", ROOT / "notebooks"
TIMEOUT = 900
"""Seconds that one cell may take, as `make docs` has it."""
DPI = 60
"""Dots per inch of a picture; chosen so that a notebook stays below 300 kB."""
CELL = re.compile(r"^```\{code-cell\}[^\n]*\n(.*?)^```[ \t]*$", re.MULTILINE | re.DOTALL)
LINK = re.compile(r"\]\((?!https?:|#)([^)\s]+)\)")


def code_of(block: str) -> str:
    """The code of a cell without its options."""
    lines = block.splitlines()
    while lines and lines[0].startswith(":"):
        del lines[0]
    return "\n".join(lines)


def notebook_of(page: Path) -> Any:
    """The cells of ``page``, not yet executed; links lead to the pages from where notebooks lie."""
    from nbformat import v4

    body = page.read_text("utf-8").split("---\n", 2)[2].strip()
    cells, end = [], 0

    def add_text(text: str) -> None:
        if text.strip():
            linked = LINK.sub(r"](../docs/tutorials/\1)", text.strip())
            cells.append(v4.new_markdown_cell(linked))

    for match in CELL.finditer(body):
        add_text(body[end : match.start()])
        cells.append(v4.new_code_cell(code_of(match[1])))
        end = match.end()
    add_text(body[end:])
    for number, cell in enumerate(cells):
        cell["id"] = f"cell-{number}"
    kernel = {"display_name": "Python 3", "language": "python", "name": "python3"}
    return v4.new_notebook(cells=cells, metadata={"kernelspec": kernel})


def executed(notebook: Any) -> Any:
    """``notebook`` after a run in an empty folder; only text and PNG of its outputs are kept."""
    from nbclient import NotebookClient
    from nbformat import v4

    setting = v4.new_code_cell(
        f"import matplotlib as mpl\nmpl.rcParams['figure.dpi'] = {DPI}\n"
        "%config InlineBackend.rc = {}\n%config InlineBackend.print_figure_kwargs = {}"
    )
    notebook.cells.insert(0, setting)
    with tempfile.TemporaryDirectory() as folder:
        client = NotebookClient(notebook, timeout=TIMEOUT, resources={"metadata": {"path": folder}})
        client.execute()
    del notebook.cells[0]
    count = 0
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
        if cell.cell_type != "code":
            continue
        count += 1
        cell.execution_count = count
        for output in cell.outputs:
            if "execution_count" in output:
                output.execution_count = count
            for kind in set(output.get("data", ())) - {"text/plain", "image/png"}:
                del output.data[kind]
    return notebook


def main(names: list[str]) -> int:
    """Write a notebook for each page named, or for all that have cells."""
    import nbformat

    TARGET.mkdir(exist_ok=True)
    pages = [page for page in sorted(PAGES.glob("*.md")) if CELL.search(page.read_text("utf-8"))]
    for page in pages:
        if names and page.stem not in names:
            continue
        path = TARGET / f"{page.stem}.ipynb"
        nbformat.write(executed(notebook_of(page)), path)
        print(f"{path.relative_to(ROOT)}: {path.stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
