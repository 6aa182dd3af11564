"""Basins of attraction over a parameter: which attractor is which, and how its share changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.attractors import (
    Attractor,
    Field,
    attractors_from,
    chaotic_index,
    matched,
    periodic_index,
)
from thermogear.analysis.basins import BASIN_RULE, SURVEY, basin_plan, single
from thermogear.analysis.family import ModelFamily, axis_values
from thermogear.analysis.settle import Rule
from thermogear.base.plan import Progress, gather
from thermogear.base.vocabulary import label

Floats = NDArray[np.float64]


def basins_along(
    model: object,
    parameter: str,
    *,
    values: ArrayLike,
    x: ArrayLike,
    v: ArrayLike,
    rule: Rule = BASIN_RULE,
    survey: int = SURVEY,
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Basin fractions over a parameter, the attractors matched from value to value.

    A trajectory from each attractor is carried on to the next value; where it lands is the same
    attractor. Returns fraction (parameter, attractor_number), 0 where one does not exist, its
    period, first section point and distance to the border, and the basin entropies.
    """
    points = axis_values(parameter, values)
    family = ModelFamily(model, (parameter,))
    rows: list[dict[int, tuple[float, int, Floats, float]]] = []
    entropies: list[tuple[float, float]] = []
    last: list[tuple[int, Attractor]] = []
    fresh = 0
    for done, value in enumerate(points):
        here = replace(family.model, **{parameter: float(value)})
        seeds = [one.points[0] for _, one in last]
        plan = basin_plan(here, x=x, v=v, rule=rule, seeds=seeds or (), survey=survey)
        data = gather(plan, threads=threads)
        lanes = single(here)
        field = Field(lanes)
        now = _read(data)
        landed = [-1] * len(last)
        if last:
            found, ends = attractors_from(lanes, np.array(seeds), rule)
            for number, end in enumerate(ends):
                if end >= 0:
                    landed[number] = _same(now, found[int(end)], field)
        numbers = matched([a for _, a in last], now, landed=landed, unit=field.unit)
        row: dict[int, tuple[float, int, Floats, float]] = {}
        named: list[tuple[int, Attractor]] = []
        for n, one in enumerate(now):
            number = last[numbers[n]][0] if numbers[n] >= 0 else fresh
            fresh += numbers[n] < 0
            named.append((number, one))
            row[number] = (
                float(data["fraction"].values[n]),
                one.period,
                np.array([data[f"attractor_{k}"].values[n, 0] for k in "xv"]),
                float(data["border_distance"].values[n]),
            )
        rows.append(row)
        entropies.append((data.attrs["basin_entropy"], data.attrs["boundary_basin_entropy"]))
        last = named
        if progress is not None:
            progress(done + 1, points.size)
    return _along(parameter, points, rows, entropies, fresh)


def _read(data: xr.Dataset) -> list[Attractor]:
    found = []
    for n in range(data.sizes["attractor_number"]):
        points = np.stack([data["attractor_x"].values[n], data["attractor_v"].values[n]], axis=1)
        if "attractor_state" in data:
            points = data["attractor_state"].values[n]
        points = points[np.isfinite(points[:, 0])]
        found.append(
            Attractor(
                period=int(data["attractor_period"].values[n]),
                points=points,
                multiplier=complex(data["attractor_multiplier"].values[n]),
                lyapunov=float(data["attractor_lyapunov"].values[n]),
                trap=0.0,
            )
        )
    return found


def _same(known: Sequence[Attractor], one: Attractor, field: Field) -> int:
    if one.chaotic:
        return chaotic_index(known, field, one.points[-1])
    return periodic_index(known, one.points[0], one.period, field.unit)


def _along(
    parameter: str,
    points: Floats,
    rows: Sequence[dict[int, tuple[float, int, Floats, float]]],
    entropies: Sequence[tuple[float, float]],
    count: int,
) -> xr.Dataset:
    fraction = np.zeros((points.size, count))
    period = np.full((points.size, count), np.nan)
    section = np.full((points.size, count, 2), np.nan)
    safe = np.full((points.size, count), np.nan)
    for i, row in enumerate(rows):
        for n, (share, n_period, point, away) in row.items():
            fraction[i, n], period[i, n], section[i, n], safe[i, n] = share, n_period, point, away
    dims = (parameter, "attractor_number")
    return label(
        {
            "fraction": (dims, fraction, "1", "share of the starts"),
            "attractor_period": (
                dims, period, "1", "mesh periods, 0: chaotic"
            ),
            "attractor_x": (dims, section[..., 0], "1", "section point"),
            "attractor_v": (dims, section[..., 1], "1", "section point"),
            "border_distance": (
                dims, safe, "1", "least distance to another basin"
            ),
            "basin_entropy": (
                (parameter,), np.array([e[0] for e in entropies]),
                "1", "basin entropy",
            ),
            "boundary_basin_entropy": (
                (parameter,), np.array([e[1] for e in entropies]),
                "1", "boundary basin entropy",
            ),
        },
        {parameter: xr.Variable((parameter,), points)},
        {"kind": "basins-along"},
    )  # fmt: skip
