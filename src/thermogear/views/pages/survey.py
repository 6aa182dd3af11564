"""The page of a gear survey: pictures, numbers, the case, and every table as CSV."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from thermogear.base.arrays import Dataset
from thermogear.base.display import SPEED
from thermogear.results.result import Result
from thermogear.results.tables import csv_tables
from thermogear.views.columns import in_full, key, rows_along
from thermogear.views.page import (
    LEAD,
    Block,
    Code,
    Gallery,
    Page,
    Section,
    Shown,
    Table,
    Text,
)
from thermogear.views.pages.background import case_file


def survey(
    result: Result,
    summary: str,
    pictures: Sequence[Shown],
    tables: Sequence[Table],
    *,
    numbers: Callable[[], Mapping[str, Any]],
    told: Sequence[Block] = (),
    code: str = "",
) -> Page:
    """Wide pictures come first; ``code`` is what may be copied into a case file.

    A terminal shows the summary, then what is ``told``, without it the tables.
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
        numbers=numbers,
        told=lambda: [Text(summary), *(told or tables)],
        tables=lambda: csv_tables(result.groups, f"{result.kind}_"),
        files=("svg", "png"),
    )


# --- figures as JSON wants them ---------------------------------------------------------------


OPERATING = (
    key("pinion_speed_rpm", "pinion_speed", SPEED),
    key("pinion_torque_Nm", "pinion_torque"),
)


def operating_rows(data: Dataset) -> list[dict[str, Any]]:
    """Speed and torque of every operating point."""
    return [in_full(OPERATING, row) for row in rows_along(data, "operating")]
