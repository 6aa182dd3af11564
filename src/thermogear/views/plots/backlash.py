"""The gap between the teeth: over the mesh phase, and over the gears' temperature."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import CELSIUS, MICROMETRE
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.picture import Panel, Picture, Text
from thermogear.views.plots.curves import axis_of, draw_by_bundle, phase_panel
from thermogear.views.style import COLD, FAINT, HOT, INK, QUIET, STATES, bundle_line, names_of
from thermogear.views.typesetting import FAR, plain, shown


def over_phase(data: Dataset) -> Picture:
    """Half backlash over the mesh phase, undeformed and hot, at the first operating point."""
    panel = phase_panel(data, axis_of("half_backlash_curve", "half backlash"))
    x = shown(data, "mesh_phase")
    for place, state in enumerate(names_of(data, "state")):
        here, colour = data.isel(state=place), STATES.get(state, INK)
        draw_by_bundle(panel, here, "half_backlash_curve", x, colour=colour, what=state)
    panel.line(y=0.0, colour=INK, width=0.9)
    low, high = panel.extent("y")
    low = min(low, -0.12 * high)
    panel.span(y=(low, 0.0), colour=FAINT, opacity=0.5)
    panel.y.low, panel.y.high = low, high + 0.05 * (high - low)
    panel.text(0.99, 0.5 * low, "jammed", at="y", across="right", colour=QUIET)
    return Picture([[panel]], legend=2)


WAYS: dict[str, tuple[tuple[float, ...], str]] = {
    "jam_temperature": ((1, 2), "gears alone hotter"),
    "proportional_jam_temperature": ((6, 2, 1, 2), "all in proportion"),
}
"""Ways to the jam by the stored temperature at their end: line and words."""


def over_temperature(row: Dataset, mesh: Dataset | None) -> Picture:
    """Half backlash over the gears' temperature, with the line at which the pair jams.

    ``mesh`` adds both ways to the jam: the gears alone get hotter and the housing stays, and all
    bodies rise on in proportion.
    """
    panel = Panel(axis_of("gear_temperature"), axis_of("half_backlash", "half backlash"))
    x, bundles = shown(row, "gear_temperature"), names_of(row, "bundle")
    cold = (
        MICROMETRE(float(mesh["half_backlash"].isel(state=0, operating=0).max()))
        if mesh is not None
        else MICROMETRE(float(row["cold_half_backlash"].max()))
    )
    panel.line(y=cold, colour=COLD, width=1.2, label=UNDEFORMED)
    for place, bundle in enumerate(bundles):
        values = shown(row.isel(bundle=place, operating=0), "half_backlash")
        panel.curve(
            x, values, colour=HOT, marker="circle", size=4.5, dash=bundle_line(bundles, place),
            label=plain(f"{bundle}, both gears"),
        )  # fmt: skip
        for jam, (dash, words) in WAYS.items():
            way = None if mesh is None else _way_to_jam(mesh, bundle, jam)
            if way is not None:
                label = plain(f"{bundle}, {words}")
                panel.curve(*way, colour=INK, width=1.1, dash=dash, label=label)
                _mark_jam(panel, way[0][1], left=way[0][1] > float(x.mean()))
    panel.line(y=0.0, colour=INK, width=0.9)
    low, high = panel.extent("y")
    panel.y.low, panel.y.high = min(low, -0.16 * abs(cold)), max(1.08 * cold, high)
    panel.span(y=(panel.y.low, 0.0), colour=FAINT, opacity=0.5)
    return Picture([[panel]], legend=2)


def _mark_jam(panel: Panel, jam: float, *, left: bool) -> None:
    """A cross where the backlash is used up, its temperature [degC] once beside it."""
    panel.points([jam], [0.0], marker="cross", colour=INK, size=7)
    words = f"jams at {jam:.0f} °C"
    if not any(isinstance(mark, Text) and mark.words == words for mark in panel.marks):
        across, away = ("right", -9) if left else ("left", 9)
        panel.text(jam, 0.0, words, offset=(away, -5), across=across, up="top")


def _way_to_jam(mesh: Dataset, bundle: str, jam: str) -> tuple[list[float], list[float]] | None:
    """From the hot state to the jam [degC], [um]; None where the jam is out of reach."""
    bundles = names_of(mesh, "bundle")
    if bundle not in bundles or "hot_temperature" not in mesh or jam not in mesh:
        return None
    here = mesh.isel(bundle=bundles.index(bundle), state=-1, operating=0)
    end = float(CELSIUS(here[jam].item()))
    start = float(CELSIUS(here["hot_temperature"].item()))
    if not np.isfinite(end) or end > FAR:
        return None
    return [start, end], [MICROMETRE(float(here["half_backlash"])), 0.0]
