"""The section of a run that shows its drive train in motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import MICROMETRE, MILLIMETRE_PER_SECOND, NEWTON, PERCENT
from thermogear.results.result import Result
from thermogear.views.columns import OF_STATE, Column, declared, rows_along
from thermogear.views.moving import Dial
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.plots import bearings
from thermogear.views.plots.shafts import internal_clearance
from thermogear.views.plots.spectrum import draw_lines, floor_of, over_orders
from thermogear.views.style import INK, STATES, WIDE, names_of
from thermogear.views.tables import labelled
from thermogear.views.typesetting import operating_names

if TYPE_CHECKING:
    import xarray as xr

CAPTION = (
    "Settled motion with clearance in the teeth and in the bearings. Flanks: force of the drive "
    "flanks, 0 where they part. Section: one dot for each mesh period; one dot in all means that "
    "every tooth pair sees the same. Lines are peak values."
)
ORBITS = (
    "Above: where each journal is in its outer ring, seen along the shafts. Inside the dashed "
    "circle, as wide across as the radial internal clearance of that state of heat, nothing holds "
    "it; what reaches beyond is the contact's deflection. Of rolling elements the free space is "
    "the polygon around the circle, a side for each element. A preloaded bearing has none. The "
    "arrow is the mean force on the ring. Below: the same paths, each about its mean, enlarged; "
    "the arrow is the way it goes, the dot its place at mesh phase 0, which the dial turns on."
)
FORCES = (
    "Amount of the force on each bearing's ring, damping not in it. Dashed: the amount of the "
    "mean force, as a vector."
)
ORDERS = (
    "Lines of the force on each bearing, the larger of x and y, peak values. Whole orders come "
    "from every tooth alike, halves from a motion that repeats after two mesh periods, what lies "
    "beside them from the shafts or from a second base frequency."
)
TORUS = (
    "The motion never returns: it has two base frequencies, and its sections fill a closed curve, "
    "or a few that they visit in turn, where the torus began at an orbit of so many periods. "
    "The colour is the second phase at the section, once around from 0 over a half to 1; marked on "
    "a single curve are its quarters. A second frequency is known but for whole multiples of the "
    "mesh's and for its sign: the one below half the mesh frequency is told."
)
FRAMES = 16
"""Moments of a mesh period."""
FEW = 2
"""Up to so many operating points the bearings of each are shown."""
SOUND = (
    "Lines of the housing's acceleration, the larger of x and y: what a sensor on the housing sees "
    "of the mesh and of both shafts."
)


def section(result: Result, pictures: Pictures) -> Section | None:
    """Forces, sections and lines of every operating point; None where nothing moved."""
    data = result.group("train_motion")
    if data is None:
        return None
    names = operating_names(data)
    closer = _closer(data)
    for o, name in enumerate(names):
        here = data.isel(operating=o)
        if np.isnan(here["mesh_force"].values).all():
            continue
        pictures.add(
            f"train-motion-{o}", f"The train in motion, {name}", CAPTION, data,
            ("mesh_force", "mesh_force_line", "bearing_force_line"),
            partial(four_panels, data, o), wide=True,
        )  # fmt: skip
        if o in closer:
            _of_bearings(data, o, name, pictures)
        if bearings.turning(data, o):
            pictures.add(
                f"train-torus-{o}", f"Section of the torus, {name}", TORUS, data,
                ("torus_deflection", "second_frequency"), partial(bearings.torus_section, data, o),
                wide=True,
            )  # fmt: skip
        if np.isfinite(here["housing_line"].values).any():
            pictures.add(
                f"train-sound-{o}", f"Acceleration of the housing, {name}", SOUND, data,
                ("housing_line",), partial(sound, data, o), wide=True,
            )  # fmt: skip
    blocks: list[Block] = [*pictures.take()]
    if closer and len(closer) < len(names):
        told = f"Bearings are shown at {names[closer[0]]}, where one carries most."
        blocks.append(Text(told, "note"))
    blocks += _tables(data)
    worst = float(np.nanmax(data["reduction_error"].values, initial=0.0))
    size = int(data["coordinates"].values.max())
    if size:
        blocks.append(
            Text(
                f"{size} coordinates of the reduced train change its 12 lowest natural "
                f"frequencies by at most {PERCENT(worst):.2g} %.",
                "note",
            )
        )
    return Section("train-motion", "The drive train in motion", blocks)


def _closer(data: xr.Dataset) -> list[int]:
    """Operating points whose bearings are shown: all of a few, of more the hardest on them."""
    count = data.sizes["operating"]
    if count <= FEW:
        return list(range(count))
    force = data["greatest_bearing_force"].max(["state", "bearing"]).values
    return [] if np.isnan(force).all() else [int(np.nanargmax(force))]


def _of_bearings(data: xr.Dataset, place: int, name: str, pictures: Pictures) -> None:
    """Orbits with a dial of the phase, forces over time and over order."""
    path = ("journal_path", "mean_bearing_load")
    phases = [f"{f / FRAMES:.3f}" for f in range(FRAMES)]
    turned = Dial("mesh phase", phases, [""] * FRAMES, 0, partial(_frame, data, place))
    pictures.add(
        f"bearing-orbits-{place}", f"Journals in their bearings, {name}", ORBITS, data, path,
        partial(_frame, data, place, 0), wide=True, dial=turned,
    )  # fmt: skip
    pictures.add(
        f"bearing-force-{place}", f"Force on each bearing over time, {name}", FORCES, data, path,
        partial(bearings.bearing_force_time, data, place), wide=True,
    )  # fmt: skip
    pictures.add(
        f"bearing-orders-{place}", f"Force on each bearing over order, {name}", ORDERS, data, path,
        partial(bearings.bearing_force_order, data, place), wide=True,
    )  # fmt: skip


def _frame(data: xr.Dataset, place: int, frame: int) -> Picture:
    phase = data["phase"].values
    sample = round(frame / FRAMES / float(phase[1] - phase[0]))
    return bearings.bearing_orbits(data, place, sample=sample)


FLANKS = (
    *OF_STATE,
    Column("motion", "motion"),
    Column("mean force", "mean_mesh_force", ".0f", NEWTON),
    Column("greatest force", "greatest_mesh_force", ".0f", NEWTON),
    Column("over that at rest", "train_dynamic_factor", ".3f"),
    Column("contact losses per mesh period", "losses_per_period", ".2f"),
    Column("back-side impacts", "back_impacts_per_period", ".2f"),
    Column("largest multiplier", "multiplier_modulus", ".4f"),
)
RINGS = (
    *OF_STATE,
    Column("bearing", "bearing"),
    Column("mean force", "mean_bearing_force", ".0f", NEWTON),
    Column("greatest force", "greatest_bearing_force", ".0f", NEWTON),
)
PATHS = (
    Column("radial internal clearance", "clearance", ".1f", MICROMETRE),
    Column("carries load [% of time]", lambda row: PERCENT(row["bearing_contact_share"]), ".1f"),
    Column("contact losses per mesh period", "bearing_contact_losses", ".2f"),
)


def _tables(data: xr.Dataset) -> list[Table]:
    """Flanks and bearings in motion; of bearings stored without their paths the forces alone."""
    columns: tuple[Column, ...] = RINGS
    if "journal_path" in data:
        columns += PATHS
        data = data.assign(clearance=internal_clearance(data))
    caption = "The bearings in motion; a clearance below zero is a preload, a spring has none."
    flanks = rows_along(labelled(data), "state", "operating")
    rings = rows_along(data, "state", "operating", "bearing")
    return [
        declared("Flanks of the drive train.", FLANKS, flanks, names=3),
        declared(caption, columns, rings, names=3),
    ]


def told(result: Result) -> list[Table]:
    """What the terminal tells of the drive train's motion."""
    data = result.group("train_motion")
    return [] if data is None else _tables(data)


# --- pictures -----------------------------------------------------------------------------------


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
