"""The section of a run that shows its drive train in motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.display import MICROMETRE, NEWTON, PERCENT
from thermogear.results.result import Result
from thermogear.views.columns import OF_STATE, Column, declared, rows_along
from thermogear.views.moving import Dial
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.picture import Picture
from thermogear.views.plots import bearings
from thermogear.views.plots import train_motion as plots
from thermogear.views.plots.shafts import internal_clearance
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
            partial(plots.four_panels, data, o), wide=True,
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
                ("housing_line",), partial(plots.sound, data, o), wide=True,
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
