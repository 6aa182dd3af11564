"""Order slices of a run as labelled datasets: what a page draws and a later fit takes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.vocabulary import label
from thermogear.measured.changing import OrderSlices
from thermogear.measured.quantities import quantities

if TYPE_CHECKING:
    import xarray as xr


def slice_groups(found: OrderSlices) -> dict[str, xr.Dataset]:
    """Groups ``slices`` (channel, slice, step), ``map`` (row, map_column) and ``resonances``.

    A fit of a model to a run-up takes ``slice_speed`` [rad/s], ``slice_speed_rate``, the name of
    the order, and ``slice_acceleration`` [m/s^2] or ``slice_displacement`` [m] with the relative
    half width of its 95 % interval.
    """
    omega = 2.0 * np.pi * found.frequency
    si = found.reading * found.si[:, None, None]
    moved = [quantities(a, omega=omega, kind=kind) for a, kind in zip(si, found.kinds, strict=True)]
    axes = ("channel", "slice", "step")
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = found.half_width / found.reading
    slices = label(
        {
            "slice_reading": (axes, found.reading),
            "slice_reading_half_width": (axes, found.half_width),
            "slice_acceleration": (axes, np.stack([a for a, _ in moved])),
            "slice_displacement": (axes, np.stack([x for _, x in moved])),
            "slice_half_width": (axes, relative),
            "slice_phase": (axes, found.phase),
            "slice_turns": (axes, found.block),
            "slice_frequency": (("slice", "step"), found.frequency),
            "slice_order": (("slice",), found.orders),
            "slice_time": (("step",), found.time),
            "slice_speed": (("step",), found.speed),
            "slice_speed_rate": (("step",), found.acceleration),
        }
    ).assign_coords(channel=list(found.channels), name=("slice", list(found.names)))
    slices.attrs["of_mesh"] = int(found.of_mesh)
    shown = found.map
    groups = {
        "slices": slices,
        "map": label(
            {
                "map_reading": (("row", "map_column"), shown.amplitude),
                "map_order": (("map_column",), shown.order),
                "map_speed": (("row",), shown.speed),
                "map_time": (("row",), shown.time),
            }
        ),
    }
    if found.resonances:
        groups["resonances"] = label(
            {
                f"resonance_{name}": (
                    ("resonance",),
                    np.array([getattr(one, name) for one in found.resonances], dtype=float),
                )
                for name in ("frequency", "half_width", "damping", "speed")
            }
        ).assign_coords(
            kind=("resonance", [one.kind for one in found.resonances]),
            seen=("resonance", [", ".join(one.seen) for one in found.resonances]),
        )
    return groups
