"""Motion at one operating point, without heat and hot: history, phase plane, section, spectrum."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import display, number
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.views.picture import Axis, Panel, Picture, Top
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, QUIET, STATES, WIDE, names_of
from thermogear.views.typesetting import axis_label, label_text, plain

HIGHEST_ORDER = 8.0
"""Spectra are drawn up to this order of the mesh frequency."""
HISTORY = 4
"""Mesh periods of a drawn time history, or twice those of the motion."""

BEYOND = "beyond the gap's edge x − b′ [µm]"
SPEED = axis_label("velocity")
HALF_ORDERS = axis_label("order") + ", half orders dotted"


@dataclass(frozen=True, eq=False, kw_only=True)
class Orbit:
    """A motion in display units: ``t`` [ms], ``x`` - b' [um], ``v`` [mm/s], and its section.

    ``loop`` samples of it are one whole orbit where it is periodic, else all.
    """

    t: Floats
    x: Floats
    v: Floats
    loop: int
    section_x: Floats
    section_v: Floats


def moving(one: Dataset) -> bool:
    """Whether this point has a motion to draw: neither jammed nor diverged."""
    return bool(np.isfinite(one["displacement"].values).all())


def label_of(one: Dataset) -> str:
    """The label of a point, in words a title can hold."""
    return plain(label_text(one))


def orbit_of(one: Dataset) -> Orbit:
    """The orbit of one point; x counts from the drive-side edge of its own gap."""
    edge = float(one["half_backlash"]) if "half_backlash" in one else 0.0
    t, x, v = (one[name].values for name in ("time", "displacement", "velocity"))
    mesh = mesh_frequency(one)
    samples = max(1, round(1.0 / (mesh * float(t[1] - t[0])))) if mesh > 0.0 else t.size
    of = int(one.attrs.get("mesh_periods", 1))
    label = str(one["label"].item())
    loop = periods_to_draw(label, samples_per_period=samples * of, stored=t.size)
    loop = loop if of == 1 else min(loop, HISTORY * samples + 1)
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
        section_x=section_x,
        section_v=section_v,
    )


def draw_loop(
    panel: Panel, orbit: Orbit, *, colour: str, width: float, opacity: float = 1.0
) -> None:
    """Speed over displacement of one whole orbit."""
    loop = slice(0, orbit.loop)
    panel.curve(orbit.x[loop], orbit.v[loop], colour=colour, width=width, opacity=opacity)


def four_panels(data: Dataset, *, bundle: int, operating: int) -> Picture:
    """Time history, phase plane, Poincare section and spectrum, undeformed and hot together.

    ``data`` is the group ``motion`` with ``half_backlash`` of the same points beside it.
    """
    here = data.isel(bundle=bundle, operating=operating)
    states = names_of(data, "state")
    points = [here.isel(state=i) for i in range(len(states))]
    of = int(here.attrs.get("mesh_periods", 1))
    shown, every = ("", "mesh period") if of == 1 else (f", part of the turn of {of}", "turn")
    history = Panel(Axis(axis_label("time"), margin=0.01), Axis(BEYOND), f"Time history{shown}")
    phase = Panel(Axis(BEYOND), Axis(SPEED), f"Phase plane{shown}")
    section = Panel(Axis(BEYOND), Axis(SPEED), f"Poincaré section, once a {every}")
    labels = ", ".join(f"{s}: {label_of(p)}" for s, p in zip(states, points, strict=True))

    orbits = []
    for state, one in zip(states, points, strict=True):
        if not moving(one):
            continue
        colour, orbit = STATES.get(state, INK), orbit_of(one)
        orbits.append(orbit)
        history.curve(orbit.t, orbit.x, colour=colour, width=1.3, label=plain(state))
        draw_loop(phase, orbit, colour=colour, width=1.2)
        draw_loop(section, orbit, colour=colour, width=0.7, opacity=0.3)
        section.points(
            orbit.section_x, orbit.section_v, colour=colour, edge="white", edge_width=0.6
        )
    if orbits and min(float(o.x.min()) for o in orbits) < 0.25 * max(o.x.max() for o in orbits):
        history.line(y=0.0, colour=QUIET, width=1.0, dash=(4, 2))
        for panel in (phase, section):
            panel.line(x=0.0, colour=QUIET, width=1.0, dash=(4, 2))
    if not orbits:
        for panel in (history, phase, section):
            panel.note(plain(labels))
    return Picture(
        [[history, phase], [section, _spectra(here, states, points)]],
        size=(WIDE, 7.1), title=labels, top=0.66, above=1.12, between=0.9,
    )  # fmt: skip


def _spectra(here: Dataset, states: list[str], points: list[Dataset]) -> Panel:
    """Amplitude over order, with the frequency in Hz along the top."""
    order = here["order"].values
    of = int(here.attrs.get("mesh_periods", 1))
    width = float(here.attrs.get("bin_width_orders", order[1] - order[0]))
    # a motion that repeats after a turn has no line between those of the turn
    step = max(1, round(1.0 / (of * width))) if of > 1 else 1
    scale = display("line_amplitude")
    floor, top = floor_of(scale(here["line_amplitude"].values), order=order, highest=HIGHEST_ORDER)
    words = axis_label("line_amplitude", "amplitude of displacement")
    panel = over_orders(HALF_ORDERS, words, floor=floor, top=top, highest=HIGHEST_ORDER)
    for state, one in zip(states, points, strict=True):
        if moving(one):
            kept = slice(None, None, step if str(one["label"].item()) == "period-1" else 1)
            draw_lines(
                panel, order=order[kept], amplitude=scale(one["line_amplitude"].values)[kept],
                colour=STATES.get(state, INK), label=plain(state), filled=state != UNDEFORMED,
            )  # fmt: skip
    mesh = mesh_frequency(here)
    panel.title = f"Spectrum, bin width {number(width)} orders"
    if mesh > 0.0:
        panel.title += f" = {number(width * mesh)} Hz"
        panel.top = Top("frequency f [Hz]", mesh)
    return panel


def mesh_frequency(here: Dataset) -> float:
    """Mesh frequency [Hz] of one operating point, 0 where it is not stored."""
    if "line_frequency" not in here:
        return 0.0
    order, frequency = here["order"].values, here["line_frequency"].values
    return float(frequency[-1] / order[-1])


def needed(data: Dataset, *, bundle: int, operating: int) -> bool:
    """Whether any state of this point moves at all."""
    here = data.isel(bundle=bundle, operating=operating)
    return any(moving(here.isel(state=i)) for i in range(data.sizes["state"]))


# --- pictures -----------------------------------------------------------------------------------


SMOOTH = 640
"""Points wanted in a mesh period of a drawn curve."""


def refined(t: Floats, *, x: Floats, v: Floats, times: int) -> tuple[Floats, Floats, Floats]:
    """Smooth (t, x, v) through every sample, ``times`` as many points.

    ``t``, ``x`` and ``v`` = dx/dt in units that belong together: x by cubics with the slope v,
    v by cubics with the slope of its neighbours.
    """
    if times <= 1 or t.size < 3:
        return t, x, v
    u = np.arange(times) / times
    h = np.diff(t)[:, None]

    def through(y: Floats, slope: Floats) -> Floats:
        y0, y1, s0, s1 = y[:-1, None], y[1:, None], slope[:-1, None] * h, slope[1:, None] * h
        a, b = 2.0 * (y0 - y1) + s0 + s1, 3.0 * (y1 - y0) - 2.0 * s0 - s1
        return np.append((y0 + u * (s0 + u * (b + u * a))).ravel(), y[-1])

    fine = np.append((t[:-1, None] + u * h).ravel(), t[-1])
    return fine, through(x, v), through(v, np.gradient(v, t, edge_order=2))


def periods_to_draw(label: str, *, samples_per_period: int, stored: int, least: int = 1) -> int:
    """How many stored samples show the whole orbit: n periods where the label says so."""
    found = re.match(r"period-(\d+)$", label)
    if not found:
        return stored
    return int(min(stored, max(int(found[1]), least) * samples_per_period + 1))


def thinned(
    *, x: Floats, y: Floats, scale: tuple[float, float], cells: float = 400.0
) -> tuple[Floats, Floats]:
    """Points that a reader can tell apart: one for each cell of a grid over the picture.

    ``scale`` is the picture's extent in x and y, ``cells`` the grid's fineness: a settled
    motion keeps a point per period. Points that are not finite are left out.
    """
    kept = np.isfinite(x) & np.isfinite(y)
    x, y = x[kept], y[kept]
    steps = [size / cells if size > 0.0 else 1.0 for size in scale]
    places = np.stack([np.round(v / step) for v, step in zip((x, y), steps, strict=True)])
    _, first = np.unique(places, axis=1, return_index=True)
    first.sort()
    return x[first], y[first]
