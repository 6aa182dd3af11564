"""The page of a gear survey: pictures, numbers, the case, and every table as CSV."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from thermogear.base.display import SPEED
from thermogear.results.result import Result
from thermogear.results.tables import csv_text, frames
from thermogear.views.columns import lines_of, typed
from thermogear.views.page import (
    LEAD,
    Block,
    Code,
    Gallery,
    Page,
    Section,
    Shown,
    Table,
    notice_lines,
)
from thermogear.views.pages.background import case_file

if TYPE_CHECKING:
    import xarray as xr

Lines = Sequence[str]


def survey(
    result: Result,
    summary: str,
    pictures: Sequence[Shown],
    tables: Sequence[Table],
    *,
    numbers: Callable[[Result], dict[str, Any]],
    lines: Callable[[Result], Lines] | None = None,
    code: str = "",
) -> Page:
    """Wide pictures come first; ``code`` is what may be copied into a case file.

    Without ``lines`` of its own a terminal shows the summary and the tables.
    """
    small = [one for one in pictures if not one.wide]
    drawn: list[Block] = [Gallery([one]) for one in pictures if one.wide]
    drawn += [Gallery(small)] * bool(small)
    sections = [Section(LEAD, "In pictures", drawn, folded=False)]
    if code:
        sections.append(Section("paste", "For the case file", [Code(code)], folded=False))
    sections.append(Section("numbers", "Numbers", list(tables)))
    sections.append(case_file(result))
    return Page(
        result,
        summary,
        sections,
        numbers=lambda: {"title": result.title, **numbers(result)},
        lines=lambda: [
            *(lines(result) if lines else [typed(summary), *lines_of(*tables)]),
            *notice_lines(result),
        ],
        tables=lambda: csv_tables(result),
        files=("svg", "png"),
    )


def csv_tables(result: Result) -> dict[str, str]:
    """One CSV text for each group and set of dimensions; the heads name the units."""
    found = {}
    for group, data in result.groups.items():
        families = frames(data)
        whole = any(not v.dims for v in data.data_vars.values()) + len(families)
        for dims, frame in families.items():
            tail = "" if whole == 1 else f"_by_{'_'.join(dims)}"
            found[f"{result.kind}_{group}{tail}.csv"] = csv_text(frame)
    return found


# --- figures as the terminal and JSON want them -----------------------------------------------


def operating_rows(data: xr.Dataset) -> list[dict[str, float]]:
    """Speed and torque of every operating point."""
    pairs = zip(data["pinion_speed"].values, data["pinion_torque"].values, strict=True)
    return [{"pinion_speed_rpm": SPEED(float(s)), "pinion_torque_Nm": float(t)} for s, t in pairs]


def table_of(data: xr.DataArray) -> list[list[float]]:
    """A grid as rows of numbers."""
    return [[float(v) for v in row] for row in data.values]
