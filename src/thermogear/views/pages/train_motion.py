"""The section of a run that shows its drive train in motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import number
from thermogear.base.vocabulary import told_labels
from thermogear.results.result import Result
from thermogear.views.moving import Dial
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.picture import Picture
from thermogear.views.plots import bearings
from thermogear.views.plots import train_motion as plots
from thermogear.views.plots.shafts import internal_clearance
from thermogear.views.style import names_of
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
    blocks += [_table(data, names), _rings(data, names)]
    worst = float(np.nanmax(data["reduction_error"].values, initial=0.0))
    size = int(data["coordinates"].values.max())
    if size:
        blocks.append(
            Text(
                f"{size} coordinates of the reduced train change its 12 lowest natural "
                f"frequencies by at most {100.0 * worst:.2g} %.",
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


def _table(data: xr.Dataset, names: list[str]) -> Table:
    head = [
        "state", "operating point", "motion", "mean force [N]", "greatest force [N]",
        "over that at rest", "contact losses per mesh period", "back-side impacts",
        "largest multiplier",
    ]  # fmt: skip
    rows = []
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            one = data.isel(state=s, operating=o)
            rows.append(
                [
                    state,
                    name,
                    str(told_labels(one)),
                    _told(one["mean_mesh_force"], "{:.0f}"),
                    _told(one["greatest_mesh_force"], "{:.0f}"),
                    _told(one["train_dynamic_factor"], "{:.3f}"),
                    _told(one["losses_per_period"], "{:.2f}"),
                    _told(one["back_impacts_per_period"], "{:.2f}"),
                    _told(one["multiplier_modulus"], "{:.4f}"),
                ]
            )
    return Table("Flanks of the drive train.", head, rows, names=3)


def _rings(data: xr.Dataset, names: list[str]) -> Table:
    head = [
        "state", "operating point", "bearing", "mean force [N]", "greatest force [N]",
        "radial internal clearance [µm]", "carries load [% of time]",
        "contact losses per mesh period",
    ]  # fmt: skip
    rows = []
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            for b, bearing in enumerate(names_of(data, "bearing")):
                one = data.isel(state=s, operating=o, bearing=b)
                mean, most = one["mean_bearing_force"], one["greatest_bearing_force"]
                told = [_told(mean, "{:.0f}"), _told(most, "{:.0f}")]
                if "journal_path" in data:
                    told += [
                        _told(1e6 * internal_clearance(one), "{:.1f}"),
                        _told(100.0 * one["bearing_contact_share"], "{:.1f}"),
                        _told(one["bearing_contact_losses"], "{:.2f}"),
                    ]
                rows.append([state, name, bearing, *told])
    caption = "The bearings in motion; a clearance below zero is a preload, a spring has none."
    return Table(caption, head[: len(rows[0])] if rows else head, rows, names=3)


def _told(value: Any, form: str) -> str:
    found = float(value)
    return form.format(found) if np.isfinite(found) else "–"


def numbers(result: Result) -> dict[str, Any]:
    """The figures of the drive train's motion for the JSON file; empty where there is none."""
    data = result.group("train_motion")
    if data is None:
        return {}
    names = operating_names(data)
    found: dict[str, Any] = {}
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            one = data.isel(state=s, operating=o)
            found[f"{state}, {name}"] = {
                "motion": str(told_labels(one)),
                "reason": str(one["label_reason"].values),
                "mean_mesh_force_N": _plain(one["mean_mesh_force"]),
                "greatest_mesh_force_N": _plain(one["greatest_mesh_force"]),
                "dynamic_factor": _plain(one["train_dynamic_factor"]),
                "contact_losses_per_mesh_period": _plain(one["losses_per_period"]),
                "greatest_bearing_force_N": {
                    bearing: _plain(one["greatest_bearing_force"][b])
                    for b, bearing in enumerate(names_of(data, "bearing"))
                },
                **_contact(one, names_of(data, "bearing")),
            }
    return found


def _contact(one: xr.Dataset, names: list[str]) -> dict[str, Any]:
    """How long each bearing carries; the second base frequency of a motion on a torus."""
    if "bearing_contact_share" not in one:
        return {}
    share = one["bearing_contact_share"].values
    found: dict[str, Any] = {
        "bearing_contact_share": {b: _plain(s) for b, s in zip(names, share, strict=True)}
    }
    if np.isfinite(one["second_frequency"].values):
        found["second_frequency_of_mesh"] = _plain(one["second_frequency"])
    return found


def _plain(value: Any) -> float | None:
    found = float(value)
    return found if np.isfinite(found) else None


def lines(result: Result) -> list[str]:
    """What the terminal tells of the drive train's motion."""
    data = result.group("train_motion")
    if data is None:
        return []
    found = []
    for o, name in enumerate(operating_names(data)):
        told = []
        for s, state in enumerate(names_of(data, "state")):
            one = data.isel(state=s, operating=o)
            force = _told(one["greatest_mesh_force"], "{:.0f}")
            ring = float(np.nanmax(one["greatest_bearing_force"].values, initial=0.0))
            told.append(
                f"{state}: {told_labels(one)}, mesh up to {force} N, bearings up to "
                f"{number(ring)} N"
            )
        found.append(f"train, {name}: " + "; ".join(told))
    return found
