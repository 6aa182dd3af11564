"""Motion at one operating point, without heat and hot: history, phase plane, section, spectrum."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike, NDArray

from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.plots.orbits import SMOOTH, periods_to_draw, refined, thinned
from thermogear.views.plots.spectrum import draw_lines, floor_of, mark_half_orders
from thermogear.views.style import (
    INK,
    QUIET,
    STATES,
    WIDE,
    legend_below,
    log_axis,
    names_of,
    note,
    picture,
)
from thermogear.views.words import (
    axis_label,
    display,
    label_text,
    number,
    plain,
    shown,
)

Floats = NDArray[np.float64]

HIGHEST_ORDER = 8.0
"""Spectra are drawn up to this order of the mesh frequency."""
HISTORY = 4
"""Mesh periods of a drawn time history, or twice those of the motion."""

BEYOND = "beyond the gap's edge x − b′ [µm]"
SPEED = axis_label("velocity")


@dataclass(frozen=True, eq=False, kw_only=True)
class Orbit:
    """A motion in display units: ``t`` [ms], ``x`` - b' [um], ``v`` [mm/s], and its section.

    ``loop`` samples of it are one whole orbit where it is periodic, else all.
    """

    t: Floats
    x: Floats
    v: Floats
    loop: int
    history: int
    section_x: Floats
    section_v: Floats


def moving(one: xr.Dataset) -> bool:
    """Whether this point has a motion to draw: neither jammed nor diverged."""
    return bool(np.isfinite(one["displacement"].values).all())


def label_of(one: xr.Dataset) -> str:
    """The label of a point, in words a title can hold."""
    return plain(label_text(one))


def orbit_of(one: xr.Dataset) -> Orbit:
    """The orbit of one point; x counts from the drive-side edge of its own gap."""
    edge = float(one["half_backlash"]) if "half_backlash" in one else 0.0
    t, x, v = (one[name].values for name in ("time", "displacement", "velocity"))
    mesh = mesh_frequency(one)
    samples = max(1, round(1.0 / (mesh * float(t[1] - t[0])))) if mesh > 0.0 else t.size
    label = str(one["label"].item())
    loop = periods_to_draw(label, samples_per_period=samples, stored=t.size)
    history = max(min(t.size, HISTORY * samples + 1), min(t.size, 2 * loop))
    times = max(1, round(SMOOTH / samples)) if loop < t.size else 1
    t, x, v = refined(t[:history], x=x[:history], v=v[:history], times=times)
    x, v = display("displacement")(x - edge), display("velocity")(v)
    section_x, section_v = thinned(
        x=display("section_displacement")(one["section_displacement"].values - edge),
        y=display("section_velocity")(one["section_velocity"].values),
        scale=(float(np.ptp(x)), float(np.ptp(v))),
    )
    return Orbit(
        t=display("time")(t),
        x=x,
        v=v,
        loop=min((loop - 1) * times + 1, t.size),
        history=t.size,
        section_x=section_x,
        section_v=section_v,
    )


def four_panels(data: xr.Dataset, *, bundle: int, operating: int) -> Figure:
    """Time history, phase plane, Poincare section and spectrum, undeformed and hot together.

    ``data`` is the group ``motion`` with ``half_backlash`` of the same points beside it.
    """
    here = data.isel(bundle=bundle, operating=operating)
    states = names_of(data, "state")
    points = [here.isel(state=i) for i in range(len(states))]
    figure, axes = picture(2, 2, (WIDE, 7.1), top=0.66, above=1.12, between=0.9)
    history, phase, section, spectrum = axes.ravel()
    labels = ", ".join(f"{s}: {label_of(p)}" for s, p in zip(states, points, strict=True))
    figure.suptitle(labels, y=0.985, fontsize=11, fontweight="bold")

    orbits = []
    for state, one in zip(states, points, strict=True):
        if not moving(one):
            continue
        colour, orbit = STATES.get(state, INK), orbit_of(one)
        orbits.append(orbit)
        history.plot(orbit.t, orbit.x, color=colour, linewidth=1.3, label=plain(state))
        loop = slice(0, orbit.loop)
        phase.plot(orbit.x[loop], orbit.v[loop], color=colour, linewidth=1.2)
        section.plot(orbit.x[loop], orbit.v[loop], color=colour, linewidth=0.7, alpha=0.3)
        section.plot(
            orbit.section_x,
            orbit.section_v,
            linestyle="none",
            marker="o",
            markersize=6.0,
            markeredgecolor="white",
            markeredgewidth=0.6,
            color=colour,
        )
    _spectra(spectrum, here, states, points)
    if orbits and min(float(o.x.min()) for o in orbits) < 0.25 * max(o.x.max() for o in orbits):
        history.axhline(0.0, color=QUIET, linewidth=1.0, linestyle=(0, (4, 2)))
        for axis in (phase, section):
            axis.axvline(0.0, color=QUIET, linewidth=1.0, linestyle=(0, (4, 2)))
    history.set(title="Time history", xlabel=axis_label("time"), ylabel=BEYOND)
    history.margins(x=0.01)
    phase.set(title="Phase plane", xlabel=BEYOND, ylabel=SPEED)
    section.set(title="Poincaré section, once a mesh period", xlabel=BEYOND, ylabel=SPEED)
    if not orbits:
        for axis in (history, phase, section):
            note(axis, labels)
    legend_below(figure, history)
    return figure


def _spectra(axes: Axes, here: xr.Dataset, states: list[str], points: list[xr.Dataset]) -> None:
    """Amplitude over order, with the frequency in Hz along the top."""
    order = here["order"].values
    scale = display("line_amplitude")
    floor, top = floor_of(scale(here["line_amplitude"].values), order=order, highest=HIGHEST_ORDER)
    for state, one in zip(states, points, strict=True):
        if moving(one):
            draw_lines(
                axes, order=order, amplitude=scale(one["line_amplitude"].values),
                colour=STATES.get(state, INK),
                floor=floor, highest=HIGHEST_ORDER, label=plain(state), filled=state != UNDEFORMED,
            )  # fmt: skip
    log_axis(axes)
    axes.set_ylim(floor, top)
    mark_half_orders(axes, HIGHEST_ORDER)
    axes.set_xlabel(axis_label("order") + ", half orders dotted")
    axes.set_ylabel(axis_label("line_amplitude", "amplitude of displacement"))
    mesh = mesh_frequency(here)
    width = float(here.attrs.get("bin_width_orders", order[1] - order[0]))
    title = f"Spectrum, bin width {number(width)} orders"
    if mesh > 0.0:
        title += f" = {number(width * mesh)} Hz"
        above = axes.secondary_xaxis(
            "top", functions=(partial(np.multiply, mesh), partial(_divided, mesh))
        )
        above.set_xlabel("frequency f [Hz]")
    axes.set_title(title)


def _divided(by: float, values: ArrayLike) -> Floats:
    return np.asarray(np.asarray(values, dtype=float) / by)


def mesh_frequency(here: xr.Dataset) -> float:
    """Mesh frequency [Hz] of one operating point, 0 where it is not stored."""
    if "line_frequency" not in here:
        return 0.0
    order, frequency = here["order"].values, here["line_frequency"].values
    return float(frequency[-1] / order[-1])


def needed(data: xr.Dataset, *, bundle: int, operating: int) -> bool:
    """Whether any state of this point moves at all."""
    here = data.isel(bundle=bundle, operating=operating)
    return any(moving(here.isel(state=i)) for i in range(data.sizes["state"]))


__all__ = ["Orbit", "four_panels", "label_of", "moving", "needed", "orbit_of", "shown"]
