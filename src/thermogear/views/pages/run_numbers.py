"""The figures of a run that a script wants: one row for each bundle, state and point."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from thermogear.base.units import RPM
from thermogear.base.vocabulary import DIMENSIONLESS, STATUS
from thermogear.results.result import Result

if TYPE_CHECKING:
    import xarray as xr


def numbers(result: Result) -> dict[str, Any]:
    """The figures a script wants, JSON-ready (non-finite numbers are None)."""
    found: dict[str, Any] = {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": result.kind,
        "answers": [one.row for one in result.answers],
        "notices": [one._asdict() for one in result.notices],
    }
    groups = result.groups
    if "mesh" in groups:
        found["operating"] = _operating_summary(groups)
    if "temperature" in groups:
        found["temperature_row"] = _temperature_summary(groups["temperature"])
    sets = {
        name: data for name, data in groups.items() if name.split("/")[0] in ("points", "base_sets")
    }
    if sets:
        found["points"] = {name.split("/")[-1]: _point_summary(data) for name, data in sets.items()}
    return found


FIGURES = (
    "mean_stiffness",
    "peak_to_peak_stiffness",
    "half_backlash",
    "least_half_backlash",
    "cold_half_backlash",
    "jam_temperature",
    "proportional_jam_temperature",
    "edge_contact_share",
    "natural_frequency",
    *DIMENSIONLESS[1:],
)
FOLLOWED = ("followed_periods", "followed_starts")
MOTION_FIGURES = (
    "dte_peak_to_peak",
    "peak_to_peak_displacement",
    "half_order_amplitude",
    "contact_loss_share",
    *FOLLOWED,
)


def _operating_summary(groups: Mapping[str, xr.Dataset]) -> list[dict[str, Any]]:
    mesh, path, motion = groups["mesh"], groups["path"], groups.get("motion")
    rows = []
    for b, bundle in enumerate(mesh["bundle"].values):
        for s, state in enumerate(mesh["state"].values):
            for o in range(mesh.sizes["operating"]):
                at = {"bundle": b, "state": s, "operating": o}
                here, along = mesh.isel(at), path.isel(at)
                row: dict[str, Any] = {
                    "bundle": str(bundle),
                    "state": str(state),
                    "pinion_speed_rpm": float(here["pinion_speed"]) / RPM,
                    "pinion_torque_Nm": float(here["pinion_torque"]),
                    "status": STATUS[int(here["status"])],
                    "greatest_flash_temperature_K": float(along["flash_temperature"].max()),
                    "greatest_friction": float(along["friction_coefficient"].max()),
                }
                row |= {name: float(here[name]) for name in FIGURES if name in here}
                if motion is not None and "label" in motion:
                    moving = motion.isel(at)
                    row["label"] = str(moving["label"].values)
                    row |= {n: float(moving[n]) for n in MOTION_FIGURES if n in moving}
                rows.append(row)
    return rows


def _temperature_summary(row: xr.Dataset) -> list[dict[str, Any]]:
    rows = []
    for b, bundle in enumerate(row["bundle"].values):
        for t, temperature in enumerate(row["gear_temperature"].values):
            for o in range(row.sizes["operating"]):
                here = row.isel(bundle=b, gear_temperature=t, operating=o)
                found: dict[str, Any] = {
                    "bundle": str(bundle),
                    "gear_temperature_K": float(temperature),
                    "pinion_speed_rpm": float(here["pinion_speed"]) / RPM,
                    "status": STATUS[int(here["status"])],
                    "label": str(here["label"].values),
                }
                names = FIGURES + MOTION_FIGURES
                found |= {name: float(here[name]) for name in names if name in here}
                rows.append(found)
    return rows


def _point_summary(points: xr.Dataset) -> list[dict[str, Any]]:
    rows = []
    for place in range(points.sizes["point"]):
        here = points.isel(point=place)
        rows.append(
            {
                "row": str(here["row"].values),
                "parameter": str(here["parameter"].values),
                "value": float(here["value"]),
                "unit": str(here["value_unit"].values),
                "label": str(here["label"].values),
                "reason": str(here["label_reason"].values),
                **{name: int(here[name]) for name in FOLLOWED if name in here},
                "expected": str(here["expected"].values),
                "half_order_amplitude": float(here["half_order_amplitude"]),
            }
        )
    return rows
