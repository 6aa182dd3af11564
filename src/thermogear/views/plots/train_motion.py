"""Settled motion of a drive train: forces of its flanks, section, lines, the housing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import MICROMETRE, MILLIMETRE_PER_SECOND
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, STATES, WIDE, names_of

if TYPE_CHECKING:
    import xarray as xr

HIGHEST = 12.0
MANY = 128
"""Sections from which their dots are small."""


def four_panels(data: xr.Dataset, operating: int) -> Picture:
    """Mesh force over time and order, section, largest bearing lines of one operating point."""
    here = data.isel(operating=operating)
    phase = here["phase"].values
    teeth = Panel(Axis("time [mesh periods]"), Axis("force of the flanks [N]"), "Flanks")
    plane = Panel(
        Axis("approach along the drive flank [µm]"), Axis("its rate [mm/s]"), "Section, once a mesh"
    )
    states = names_of(here, "state")
    for s, state in enumerate(states):
        one = here.isel(state=s)
        colour = STATES.get(state, INK)
        teeth.curve(phase, one["mesh_force"].values, colour=colour, label=f"drive, {state}")
        if np.nanmax(one["back_force"].values, initial=0.0) > 0.0:
            teeth.curve(
                phase, -one["back_force"].values, colour=colour, dash=(3.0, 2.0),
                label=f"back, {state}",
            )  # fmt: skip
        places = one["section_deflection"].values
        many = np.isfinite(places).sum() > MANY
        plane.points(
            MICROMETRE(places),
            MILLIMETRE_PER_SECOND(one["section_rate"].values),
            colour=colour,
            open=s == 0 and not many,
            size=2.4 if many else 6.4 if s == 0 else 4.2,
            label=state,
        )
    order = here["line_order"].values
    mesh = _lines(here, order, here["mesh_force_line"].values, "line of the flanks' force [N]")
    mesh.title = "Lines of the drive flanks' force"
    felt = _lines(
        here, order, here["bearing_force_line"].values.max(axis=1), "line of bearing force [N]"
    )
    felt.title = "Largest line of any bearing"
    return Picture([[teeth, mesh], [plane, felt]], size=(WIDE, 6.6), legend=4)


def _lines(
    here: xr.Dataset, order: NDArray[np.float64], amplitude: NDArray[np.float64], words: str
) -> Panel:
    """A spectrum (state, order) over orders of the mesh frequency."""
    floor, top = floor_of(amplitude, order=order, highest=HIGHEST)
    panel = over_orders(
        "order of the mesh frequency [–]", words, floor=floor, top=top, highest=HIGHEST
    )
    for s, state in enumerate(names_of(here, "state")):
        draw_lines(
            panel, order=order, amplitude=amplitude[s], colour=STATES.get(state, INK), label=state,
            filled=s > 0,
        )  # fmt: skip
    return panel


def sound(data: xr.Dataset, operating: int) -> Picture:
    """Lines of the housing's acceleration at one operating point."""
    here = data.isel(operating=operating)
    order, lines = here["line_order"].values, here["housing_line"].values
    panel = _lines(here, order, lines, "acceleration of the housing [m/s²]")
    return Picture([[panel]], size=(WIDE, 3.4))
