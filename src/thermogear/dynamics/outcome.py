"""What a run leaves behind: the arrays the kernels fill, and the labelled dataset of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import STATUS

DIVERGED = STATUS.index("diverged")
SIDES = ("back", "free", "drive")


class Result:
    """What the kernels fill, one row per lane."""

    def __init__(self, *, lanes: int, periods: int, samples: int) -> None:
        self.sections = np.full((lanes, 2, periods + 1), np.nan)
        self.samples = np.full((lanes, 2, periods * samples), np.nan)
        self.losses = np.full(lanes, -1, np.int64)
        self.impacts = np.full(lanes, -1, np.int64)
        self.shares = np.full((lanes, 3), np.nan)
        self.substeps = np.zeros(lanes, np.int64)


def dataset(
    result: Result,
    *,
    period: NDArray[np.float64],
    periods: int,
    discard: int,
    samples: int,
    mesh_periods: int = 1,
) -> Dataset:
    """The arrays of ``result`` with their names; ``periods``, ``discard`` and ``samples`` of them
    are of the model, which repeats after ``mesh_periods``; stored phases count mesh periods."""
    import xarray as xr

    lanes = period.size
    period, discard, samples = (
        period / mesh_periods,
        discard * mesh_periods,
        samples // mesh_periods,
    )
    good = np.all(np.isfinite(result.sections), axis=(1, 2))
    phase = np.arange(periods * mesh_periods * samples) / samples if samples else np.empty(0)
    turns = np.arange(periods + 1) * mesh_periods
    data = xr.Dataset(
        {
            "x": (
                ("point", "sample"),
                result.samples[:, 0],
                {"long_name": "relative displacement along the line of action"},
            ),
            "v": (
                ("point", "sample"),
                result.samples[:, 1],
                {"long_name": "relative velocity along the line of action"},
            ),
            "section_x": (
                ("point", "section"),
                result.sections[:, 0],
                {"long_name": "Poincare section, displacement"},
            ),
            "section_v": (
                ("point", "section"),
                result.sections[:, 1],
                {"long_name": "Poincare section, velocity"},
            ),
            "status": (
                "point",
                np.where(good, 0, DIVERGED).astype(np.int8),
                {
                    "long_name": "outcome",
                    "flag_values": np.arange(len(STATUS), dtype=np.int8),
                    "flag_meanings": " ".join(STATUS),
                },
            ),
        },
        coords={
            "point": ("point", np.arange(lanes), {"long_name": "parameter point"}),
            "section": (
                "section",
                discard + turns,
                {"long_name": "mesh periods since the start", "units": "1"},
            ),
            "phase": (
                "sample",
                discard + phase,
                {"long_name": "mesh phase since the start", "units": "1"},
            ),
            "time": (
                ("point", "sample"),
                period[:, None] * (discard + phase),
                {"long_name": "time"},
            ),
            "section_time": (
                ("point", "section"),
                period[:, None] * (discard + turns),
                {"long_name": "time of the section"},
            ),
            "period": ("point", period, {"long_name": "mesh period"}),
        },
    )
    if np.all(result.losses >= 0):
        data["contact_losses"] = (
            "point",
            result.losses,
            {"long_name": "losses of drive contact in the kept periods", "units": "1"},
        )
        data["back_impacts"] = (
            "point",
            result.impacts,
            {"long_name": "back-side impacts in the kept periods", "units": "1"},
        )
        data["time_share"] = (
            ("point", "side"),
            result.shares,
            {
                "long_name": "share of time in back contact, free flight, drive contact",
                "units": "1",
            },
        )
        data = data.assign_coords(side=list(SIDES))
    data["substeps"] = (
        "point",
        result.substeps,
        {"long_name": "sub-steps a period (0: adaptive)", "units": "1"},
    )
    return data
