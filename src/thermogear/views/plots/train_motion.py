"""Settled motion of a drive train: forces over the mesh phase, section, lines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, OKABE_ITO, STATES, WIDE, names_of

if TYPE_CHECKING:
    import xarray as xr

HIGHEST = 12.0
DASHES: tuple[tuple[float, ...], ...] = ((), (6.0, 3.0), (2.0, 2.0), (8.0, 2.0, 2.0, 2.0))


def four_panels(data: xr.Dataset, operating: int) -> Picture:
    """Mesh force, bearing forces, section and lines of one operating point, undeformed and hot."""
    here = data.isel(operating=operating)
    phase = here["phase"].values
    teeth = Panel(Axis("time [mesh periods]"), Axis("force of the flanks [N]"), "Flanks")
    rings = Panel(Axis("time [mesh periods]"), Axis("force on the bearing [N]"), "Bearings")
    plane = Panel(
        Axis("approach along the drive flank [µm]"), Axis("its rate [mm/s]"), "Section, once a mesh"
    )
    states = names_of(here, "state")
    bearings = names_of(here, "bearing")
    for s, state in enumerate(states):
        one = here.isel(state=s)
        colour = STATES.get(state, INK)
        teeth.curve(phase, one["mesh_force"].values, colour=colour, label=f"drive, {state}")
        if np.nanmax(one["back_force"].values, initial=0.0) > 0.0:
            teeth.curve(
                phase, -one["back_force"].values, colour=colour, dash=(3.0, 2.0),
                label=f"back, {state}",
            )  # fmt: skip
        plane.points(
            1e6 * one["section_deflection"].values,
            1e3 * one["section_rate"].values,
            colour=colour,
            open=s == 0,
            size=6.4 if s == 0 else 4.2,
            label=state,
        )
    last = here.isel(state=len(states) - 1)
    for b, name in enumerate(bearings):
        rings.curve(
            phase,
            last["bearing_force"].values[b],
            colour=OKABE_ITO[b % len(OKABE_ITO)],
            dash=DASHES[(b // len(OKABE_ITO)) % len(DASHES)],
            label=f"{name}, {states[-1]}",
        )
    order = here["line_order"].values
    felt = here["bearing_force_line"].values.max(axis=1)
    floor, top = floor_of(felt, order=order, highest=HIGHEST)
    spectrum = over_orders(
        "order of the mesh frequency [–]", "line of bearing force [N]", floor=floor, top=top,
        highest=HIGHEST,
    )  # fmt: skip
    spectrum.title = "Largest line of any bearing"
    for s, state in enumerate(states):
        draw_lines(
            spectrum, order=order, amplitude=felt[s], colour=STATES.get(state, INK), label=state,
            filled=s > 0,
        )  # fmt: skip
    return Picture([[teeth, rings], [plane, spectrum]], size=(WIDE, 6.6))


def sound(data: xr.Dataset, operating: int) -> Picture:
    """Lines of the housing's acceleration at one operating point."""
    here = data.isel(operating=operating)
    order, lines = here["line_order"].values, here["housing_line"].values
    floor, top = floor_of(lines, order=order, highest=HIGHEST)
    panel = over_orders(
        "order of the mesh frequency [–]", "acceleration of the housing [m/s²]", floor=floor,
        top=top, highest=HIGHEST,
    )  # fmt: skip
    for s, state in enumerate(names_of(here, "state")):
        draw_lines(
            panel, order=order, amplitude=lines[s], colour=STATES.get(state, INK), label=state,
            filled=s > 0,
        )  # fmt: skip
    return Picture([[panel]], size=(WIDE, 3.4))
