"""The section of measured flanks: the chart's traces, their figures, what of them acts."""

from __future__ import annotations

from typing import TYPE_CHECKING

from thermogear.base.display import MICROMETRE, MILLIMETRE
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared, rows_along
from thermogear.views.page import Block, Pictures, Section, Table
from thermogear.views.plots import flanks

if TYPE_CHECKING:
    import xarray as xr

FIGURES = ("profile_slope", "profile_form", "profile_total")


def measured(results: Result, pictures: Pictures) -> Section | None:
    """Traces, fit and what acts of each gear that was measured; None where none was."""
    found: list[Block] = []
    for gear in ("pinion", "wheel"):
        data = results.group(f"flanks/{gear}")
        if data is None:
            continue
        pictures.add(
            f"flanks-{gear}", f"Measured flanks of the {gear}", caption(data), data,
            flanks.NEEDS, lambda data=data: flanks.traces(data),  # type: ignore[misc]
            wide=len(flanks.sides(data)) > 1,
        )  # fmt: skip
        found += pictures.take()
        if all(name in data for name in FIGURES):
            found.append(table(data, gear))
    return Section("flanks", "Measured flanks", found) if found else None


def first(results: Result) -> list[tuple[str]]:
    """The pictures that a page shows unasked: those of each gear that was measured."""
    gears = ("pinion", "wheel")
    return [(f"flanks-{gear}",) for gear in gears if results.group(f"flanks/{gear}") is not None]


def caption(data: xr.Dataset) -> str:
    """What the picture shows and what of it the mesh feels."""
    sides = flanks.sides(data)
    cut = ", ".join(f"{MILLIMETRE(float(data[f'{side}_cutoff'])):.2g} mm" for side in sides)
    scatter = ", ".join(f"{MICROMETRE(float(data[f'{side}_scatter'])):.2g} µm" for side in sides)
    return (
        f"Read from {data.attrs.get('files', 'a chart')}; {' and '.join(sides)} flank. "
        f"What acts is the mean of the teeth below a cut-off of {cut} along the roll path: shorter "
        "waves cannot be told from noise. It is zero at the pitch circle and constant beyond the "
        f"evaluated range, at most {MICROMETRE(flanks.peak(data)):.2g} µm peak to peak. Scatter "
        f"between the teeth, which no mesh period holds: {scatter}."
    )


COLUMNS = (
    Column("trace", "trace_name"),
    Column("f_Hα", "profile_slope", ".2f", MICROMETRE),
    Column("f_fα", "profile_form", ".2f", MICROMETRE),
    Column("F_α", "profile_total", ".2f", MICROMETRE),
    Column("class", lambda row: str(row["iso_class"] or "none")),
)


def table(data: xr.Dataset, gear: str) -> Table:
    """Slope, form and total deviation of each trace with its class."""
    words = (
        f"Each trace of the {gear} over the evaluated range, and the class of ISO 1328-1:2013 that "
        "all three figures keep."
    )
    return declared(words, COLUMNS, rows_along(data, *map(str, data["iso_class"].dims)))
