"""Every stored curve as CSV: SI units in the header, one file for each group of variables."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS
from thermogear.results.result import Result
from thermogear.results.tables import harmless, stretched

CURVES = {
    "path_position": "path",
    "mesh_phase": "mesh",
    "profile_point": "profile",
    "sample": "time",
    "section": "section",
    "order": "spectrum",
    "flank_point": "flanks",
}
"""The dimension a curve runs along, and the word its file carries."""

ROWS = ("operating", "point", "trace")
"""Dimensions whose places stand below each other in one file."""

Column = tuple[str, list[str]]


def curve_tables(result: Result) -> dict[str, str]:
    """Every curve of a run as CSV texts by their file names, below ``csv/``.

    A file holds one bundle and one state (or gear, or gear temperature), such as
    ``path_consistent_hot.csv``; operating points stand below each other, named by columns of
    their own. Figures without a curve stand in ``..._figures.csv``.
    """
    return {
        f"csv/{_slug(stem)}.csv": lined(
            [quoted(head) for head, _ in columns],
            *zip(*(cells for _, cells in columns), strict=True),
        )
        for name, data in result.groups.items()
        for stem, columns in _files(name, data)
    }


def _files(group: str, data: Dataset) -> Iterator[tuple[str, list[Column]]]:
    """(name without ending, columns) of every file that a group becomes."""
    short = group.removeprefix("base_sets/")
    figures = _along(data, "")
    if figures:
        used = {d for n in figures for d in data[n].dims}
        outer = [str(d) for d in data.dims if d in used]
        yield f"{short}_figures", _columns(data[figures], outer)
    for curve, word in CURVES.items():
        names = _along(data, curve)
        if not names:
            continue
        apart = [d for d in data[names].dims if d not in {*ROWS, curve}]
        stem = short if word in {"path", "mesh", "profile"} and word == short else f"{short}_{word}"
        for place in np.ndindex(*(data.sizes[d] for d in apart)):
            here = data[names].isel(dict(zip(apart, place, strict=True)))
            labels = [_place_name(data, str(d), i) for d, i in zip(apart, place, strict=True)]
            inner = [str(d) for d in here.dims if d != curve]
            yield "_".join([stem, *labels]), _columns(here, [*inner, curve])


def _along(data: Dataset, curve: str) -> list[str]:
    """The variables that run along ``curve``; with "" those that run along none."""
    return [
        str(name)
        for name, v in data.data_vars.items()
        if (curve in v.dims if curve else not set(CURVES) & {str(d) for d in v.dims})
    ]


def _place_name(data: Dataset, dimension: str, place: int) -> str:
    if dimension not in data.coords:
        return f"{dimension}{place}"
    value = data[dimension].values[place]
    if dimension == "gear_temperature":
        return f"{CELSIUS(float(value)):.4g}degC"
    return str(value)


def _columns(data: Dataset, dims: list[str]) -> list[Column]:
    """Every coordinate and variable of ``data`` as cells, stretched over ``dims`` and laid flat."""
    numbered = {d: np.arange(data.sizes[d]) for d in dims if d not in data.coords}
    # a number is written once, however many rows repeat it
    cells = stretched(
        data.assign(numbered),
        dims,
        lambda v: np.array([*map(cell_text, v.ravel().tolist())], object).reshape(v.shape),
    )
    axes = [str(name) for name, axis in data.coords.items() if axis.dims]
    return [
        (head_text(data, name), cells[name].tolist())
        for name in (*numbered, *axes, *map(str, data.data_vars))
    ]


def head_text(data: Dataset, name: str) -> str:
    """The name of a column with the unit it is stored in, if there is one."""
    unit = data[name].attrs.get("units", "") if name in data.variables else ""
    return f"{name} [{unit}]" if unit else name


def cell_text(value: object) -> str:
    """A number to all fifteen digits of a decimal, nothing where there is none; a word, quoted."""
    if isinstance(value, float):
        return f"{value:.15g}" if value == value else ""
    return "" if value is None else quoted(str(value))


def table_text(head: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """A CSV text: one header line, then a line for each row, its numbers in full."""
    return lined(*(map(cell_text, line) for line in (head, *rows)))


def lined(*lines: Iterable[str]) -> str:
    """A CSV text of lines of cells."""
    return "".join(f"{','.join(line)}\n" for line in lines)


def quoted(text: str) -> str:
    """A field as a spreadsheet reads it safely: quoted where needed, never a formula."""
    flat = str(harmless(" ".join(text.split())))
    return '"' + flat.replace('"', '""') + '"' if re.search(r'[",;\n]', flat) else flat


def _slug(text: str) -> str:
    """A file name of plain letters."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", text).strip("_.")[:120] or "unnamed"
