"""The gears in mesh: a section of a run's page, and the page of a drawing by itself."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MILLIMETRE, number
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.results.result import Result
from thermogear.views.columns import Column, declared
from thermogear.views.gears import NEEDS, PINION, WHEEL, GearDrawing, gear_drawing
from thermogear.views.page import Page, Pictures, Section, Shown, Table
from thermogear.views.pages.survey import survey
from thermogear.views.plots.gears import in_mesh

KINDS = ("drawing",)
NAME, HEADING = "gears", "The gears in mesh, hot over cold"
PHASE = 0.25
"""Where in the mesh period a picture shows them: two pairs carry in most gears."""


def section(results: Result, pictures: Pictures) -> Section | None:
    """The gears in mesh with their sizes; None where the run has stored no drawing."""
    data = results.group("drawing")
    if data is None or not all(name in data for name in NEEDS):
        return None
    drawing = gear_drawing(data)
    pictures.add(
        NAME, HEADING, caption(drawing), data, NEEDS,
        partial(in_mesh, drawing, PHASE), wide=True,
        gears=partial(_data, data),
    )  # fmt: skip
    return Section("drawing", "The gears, drawn", [*pictures.take(), table(results, drawing)])


def page(result: Result) -> Page:
    """Both gears in mesh at one operating point."""
    drawing = gear_drawing(result.groups["drawing"])
    place = drawing.nearest(PHASE)
    shown = Shown(
        NAME, HEADING, caption(drawing), partial(in_mesh, drawing, PHASE), wide=True,
        gears=partial(_data, result.groups["drawing"]),
    )  # fmt: skip
    return survey(
        result,
        f"{drawing.words}, {result.text('state')}; mesh phase {drawing.phase[place]:.3g}.",
        [shown],
        [table(result, drawing)],
        numbers=lambda: {"drawing": drawing.to_json()},
    )


def _data(data: Dataset) -> list[dict[str, Any]]:
    """Every operating point's drawing as the page's script takes it."""
    return [gear_drawing(data, place).to_json() for place in range(data.sizes["operating"])]


def caption(drawing: GearDrawing) -> str:
    """What the picture shows and by how much it exaggerates."""
    cold, hot = (drawing.state(name) for name in (UNDEFORMED, "hot"))
    enlarged = (
        f"gaps, growth and deviations are drawn {drawing.factor:g} times as large"
        if drawing.factor != 1.0
        else "everything is to scale"
    )
    over = " over the period" if drawing.phase.size > 1 else ""
    return (
        f"True flanks at {drawing.words}: trochoid, shift and deviations, the pinion driving. On "
        f"the left everything is to scale; on the right {enlarged}. The drive flanks touch without "
        f"load; between the back flanks at least {_least(cold)} µm are left cold and "
        f"{_least(hot)} µm hot{over}. The colour of a contact point is its share of the "
        "hot load."
    )


def _least(state: Any) -> str:
    return number(MILLIMETRE(float(np.nanmin(state.back_gap))))


SIZES = (
    Column("", "name"),
    Column("pinion", lambda row: row["sizes"][PINION], 6),
    Column("wheel", lambda row: row["sizes"][WHEEL], 6),
)


def table(result: Result, drawing: GearDrawing) -> Table:
    """Sizes to lay beside a workshop drawing: words, pinion's and wheel's value."""
    data = result.groups["drawing"]
    cold, hot = (drawing.state(name) for name in (UNDEFORMED, "hot"))
    clearance = MILLIMETRE(data["tip_clearance"].isel(operating=0).values)
    sizes = {
        "teeth": drawing.teeth,
        **{
            f"{name} diameter [mm]": [2.0 * drawing.circles[g][name] for g in (PINION, WHEEL)]
            for name in ("tip", "pitch", "base", "root")
        },
        "tip diameter, hot [mm]": [2.0 * np.abs(hot.outlines[g]).max() for g in (PINION, WHEEL)],
        "tooth thickness on the pitch circle [mm]": MILLIMETRE(data["thickness"].values),
        "teeth of the span": [int(count) for count in data["span_teeth"].values],
        "span over these teeth [mm]": MILLIMETRE(data["span"].values),
        "tip clearance, cold [mm]": clearance[0],
        "tip clearance, hot [mm]": clearance[-1],
        "centre distance, cold and hot [mm]": (cold.centre_distance, hot.centre_distance),
        "least gap between the back flanks, cold and hot [µm]": (_least(cold), _least(hot)),
    }
    return declared(
        "Sizes as drawn, the backlash taken off both gears' flanks alike; hot where it says so. "
        "The span is the base tangent length.",
        SIZES,
        [{"name": name, "sizes": values} for name, values in sizes.items()],
    )
