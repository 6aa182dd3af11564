"""What a reader of a sweep should know beside the numbers."""

from __future__ import annotations

import json
import math
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.analysis.settle import PERIODIC
from thermogear.base.display import reach
from thermogear.base.units import RPM
from thermogear.case.case import GearCase
from thermogear.results.result import Result, stored_dataset


def finished(data: xr.Dataset, title: str = "") -> Result:
    """What a store of long work holds, with what should be known beside it."""
    told = {} if "notices" in data.attrs else {"notices": json.dumps(back_side_notice(data))}
    return stored_dataset(data.assign_attrs(told), title)


NO_BACK_IMPACT = (
    "the teeth never reach the back flanks anywhere in this range: a wider or narrower gap would "
    "change nothing here but the place x is counted from"
)


def back_side_notice(data: xr.Dataset) -> list[str]:
    """Whether the half backlash has any effect."""
    if "back_impacts" not in data:
        return []
    impacts = data["back_impacts"].values
    known = impacts[impacts >= 0]
    chaotic = bool(np.any(data["label"].values == 2))
    if known.size and not np.any(known > 0) and not chaotic:
        return [NO_BACK_IMPACT]
    return []


def contact_notices(data: xr.Dataset) -> list[str]:
    """Over which speeds of a run-up contact is lost, and where the back flanks are hit."""
    if "contact_loss_share" not in data or "pinion_speed" not in data["label"].dims:
        return []
    moving = data["status"].values == 0
    speeds = data["pinion_speed"].values / RPM
    axis = data["label"].dims.index("pinion_speed")
    others = tuple(i for i in range(data["label"].ndim) if i != axis)
    lost = moving & (data["contact_loss_share"].values > 0.0)
    # of a motion that is not periodic the impacts are not counted; its least force tells
    hit = moving & ((data["back_impacts"].values > 0) | (data["mesh_force_min"].values < 0.0))
    found = []
    for flags, yes, no in (
        (lost, "contact is lost", "contact is never lost at these speeds"),
        (hit, "the back flanks are hit", ""),
    ):
        here = np.asarray(flags.any(axis=others))
        if here.any():
            found.append(f"{yes} at {_stretches(speeds, here)} rpm (in any state, up or down)")
        elif no:
            found.append(no)
    return found


def differing(data: xr.Dataset) -> NDArray[np.bool_]:
    """Where the runs up and down differ, (state, speed).

    Of orbits the period, or the transmission error by 0.1 % of its peak to peak; of chaos, whose
    extremes are chance, by a quarter of it; an orbit and chaos always.
    """
    both = (data["status"].values == 0).all(axis=1)
    size = data["dte_peak_to_peak"].values
    period = np.where(data["label"].values == PERIODIC, data["period"].values, 0)
    apart = np.abs(size[:, 0] - size[:, 1]) / np.maximum(size[:, 0], size[:, 1])
    least = np.where(period[:, 0] > 0, 1e-3, 0.25)
    return np.asarray(both & ((period[:, 0] != period[:, 1]) | (apart > least)))


def difference_notices(data: xr.Dataset) -> list[str]:
    """Over which speeds the runs up and down show different motions."""
    here = np.asarray(differing(data).any(axis=0))
    if not here.any():
        return []
    speeds = data["pinion_speed"].values / RPM
    return [f"up and down differ at {_stretches(speeds, here)} rpm (in any state)"]


def _stretches(values: NDArray[np.float64], flags: NDArray[np.bool_]) -> str:
    """The stretches of ascending values on which a flag holds, in words."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]])))
    words = []
    for first, last in edges.reshape(-1, 2):
        low, high = (f"{values[i]:.6g}" for i in (first, last - 1))
        words.append(low if low == high else f"{low} .. {high}")
    return ", ".join(words)


def range_notices(case: GearCase, data: xr.Dataset) -> dict[str, Any]:
    """Notices as an attribute: the back side, and where the case's speeds lie."""
    found = contact_notices(data) + back_side_notice(data)
    ratio = data["frequency_ratio"].values if "frequency_ratio" in data else np.empty(0)
    ratio = ratio[np.isfinite(ratio)]
    frequency = data["mesh_frequency"].values if "mesh_frequency" in data else np.empty(0)
    frequency = frequency[np.isfinite(frequency)]
    if ratio.size:
        natural = float(np.median(frequency / ratio))
        turns = 60.0 / case.pair.pinion.teeth
        speeds = np.array(case.speeds)
        tests = case.pair.pinion.teeth * speeds / (2.0 * math.pi) / natural
        shown = ", ".join(f"{s / RPM:.4g}" for s in speeds)
        found.append(
            f"the range covers omega_h {reach(ratio, '.3f')}; the mesh meets the "
            f"natural frequency of the mean stiffness, {natural:.0f} Hz, at "
            f"{natural * turns:.0f} rpm; the case's own speeds ({shown} rpm) lie at omega_h "
            f"{reach(tests, '.3f')}"
        )
    jammed = int(np.count_nonzero(data["status"].values == 1))
    if jammed:
        found.append(f"{jammed} of {data['status'].size} points are jammed and have no motion")
    return {"notices": json.dumps(found)}
