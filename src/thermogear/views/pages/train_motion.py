"""The section of a run that shows its drive train in motion."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import number
from thermogear.results.result import Result
from thermogear.views.page import Block, Pictures, Section, Table, Text
from thermogear.views.plots import train_motion as plots
from thermogear.views.style import names_of
from thermogear.views.typesetting import operating_names

if TYPE_CHECKING:
    import xarray as xr

CAPTION = (
    "Settled motion with clearance in the teeth and in the bearings. Flanks: force of the drive "
    "flanks, 0 where they part. Bearings: amount of the force, damping not in it. Section: one dot "
    "for each mesh period; one dot in all means that every tooth pair sees the same."
)
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
    for o, name in enumerate(names):
        here = data.isel(operating=o)
        if np.isnan(here["mesh_force"].values).all():
            continue
        pictures.add(
            f"train-motion-{o}", f"The train in motion, {name}", CAPTION, data,
            ("mesh_force", "bearing_force", "bearing_force_line"),
            partial(plots.four_panels, data, o), wide=True,
        )  # fmt: skip
        if np.isfinite(here["housing_line"].values).any():
            pictures.add(
                f"train-sound-{o}", f"Acceleration of the housing, {name}", SOUND, data,
                ("housing_line",), partial(plots.sound, data, o), wide=True,
            )  # fmt: skip
    blocks: list[Block] = [*pictures.take(), _table(data, names), _rings(data, names)]
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
                    str(one["label"].values),
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
    head = ["state", "operating point", "bearing", "mean force [N]", "greatest force [N]"]
    rows = []
    for s, state in enumerate(names_of(data, "state")):
        for o, name in enumerate(names):
            for b, bearing in enumerate(names_of(data, "bearing")):
                one = data.isel(state=s, operating=o, bearing=b)
                mean, most = one["mean_bearing_force"], one["greatest_bearing_force"]
                told = [_told(mean, "{:.0f}"), _told(most, "{:.0f}")]
                rows.append([state, name, bearing, *told])
    return Table("Forces on the bearings.", head, rows, names=3)


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
                "motion": str(one["label"].values),
                "reason": str(one["label_reason"].values),
                "mean_mesh_force_N": _plain(one["mean_mesh_force"]),
                "greatest_mesh_force_N": _plain(one["greatest_mesh_force"]),
                "dynamic_factor": _plain(one["train_dynamic_factor"]),
                "contact_losses_per_mesh_period": _plain(one["losses_per_period"]),
                "greatest_bearing_force_N": {
                    bearing: _plain(one["greatest_bearing_force"][b])
                    for b, bearing in enumerate(names_of(data, "bearing"))
                },
            }
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
                f"{state}: {one['label'].values!s}, mesh up to {force} N, bearings up to "
                f"{number(ring)} N"
            )
        found.append(f"train, {name}: " + "; ".join(told))
    return found
