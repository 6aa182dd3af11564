"""Diagrams, maps and basins of a case: its words become plans, two states become one table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from thermogear.analysis.basins import BasinPlan, basin_plan
from thermogear.analysis.branches import KINDS
from thermogear.analysis.diagram import BRANCH_PERIOD, DiagramPlan, diagram_plan
from thermogear.analysis.family import Family
from thermogear.analysis.maps import MapPlan, map_plan
from thermogear.case.base import Case
from thermogear.case.family import GearFamily, Tabulated, family, moving
from thermogear.case.thermal_state import HOT, StateLike

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]


def case_diagram(
    case: Case,
    name: str,
    values: Floats,
    *,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    branch_period: int = BRANCH_PERIOD,
    starts: tuple[tuple[float, float], ...] = (),
) -> DiagramPlan:
    """The orbit diagram of a case over one parameter.

    Over a gear parameter the tables are computed at ``values`` and run straight between them,
    which is where bifurcations are located.
    """
    whole = family(case, (name,), bundle, state, numbers=changes)
    whole.require({name: values})
    axis = np.sort(values)
    lanes: Family = whole
    if isinstance(whole, GearFamily) and axis.size > 1:
        lanes = Tabulated.of(whole, axis)
    begin = starts or (case.simulation.initial_state,)
    return diagram_plan(lanes, name, axis, starts=begin, branch_period=branch_period)


def case_map(
    case: Case,
    axes: Mapping[str, Floats],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    refine: bool = True,
) -> MapPlan:
    """The map of regimes of a case over two parameters."""
    whole = family(case, tuple(axes), bundle, state, numbers=changes)
    whole.require(axes)
    return map_plan(whole, axes, initial_state=case.simulation.initial_state, refine=refine)


def case_basins(
    case: Case,
    *,
    x: Floats,
    v: Floats,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
) -> BasinPlan:
    """The basins of a case at its base set, or at its first speed and torque."""
    whole = family(case, (), bundle, state, numbers=changes)
    points = moving(whole(np.empty((1, 0))), whole)
    return basin_plan(points.model() if points.gears else whole.model, x=x, v=v)


def _nearest_pairs(
    first: list[float], second: list[float]
) -> list[tuple[float | None, float | None]]:
    """Both lists paired with the least total distance, in ascending order; the rest alone."""
    distance = np.abs(np.subtract.outer(first, second))
    rows, columns = linear_sum_assignment(distance)
    found: list[tuple[float | None, float | None]] = [
        (first[i], second[j]) for i, j in zip(rows, columns, strict=True)
    ]
    found += [(value, None) for i, value in enumerate(first) if i not in rows]
    found += [(None, value) for j, value in enumerate(second) if j not in columns]
    return sorted(found, key=lambda pair: next(v for v in pair if v is not None))


def moved_points(one: xr.Dataset, other: xr.Dataset) -> list[dict[str, Any]]:
    """Bifurcations of two diagrams side by side: kind, period, both values, what moved.

    Within each kind and period the pairs are those that move the least in all; one that the
    other diagram lacks has None there. Without branches nothing is located: no rows.
    """
    if any("bifurcation_kind" not in data for data in (one, other)):
        return []

    def sorted_values(data: xr.Dataset, kind: int, period: int) -> list[float]:
        chosen = (data["bifurcation_kind"].values == kind) & (
            data["bifurcation_period"].values == period
        )
        return sorted(map(float, data["bifurcation_value"].values[chosen]))

    pairs = {
        (int(k), int(n))
        for data in (one, other)
        for k, n in zip(
            data["bifurcation_kind"].values, data["bifurcation_period"].values, strict=True
        )
    }
    rows: list[dict[str, Any]] = []
    for kind, period in sorted(pairs, key=lambda p: (p[1], p[0])):
        first, second = sorted_values(one, kind, period), sorted_values(other, kind, period)
        for a, b in _nearest_pairs(first, second):
            rows.append(
                {
                    "kind": KINDS[kind],
                    "period": period,
                    "one": a,
                    "other": b,
                    "moved": None if a is None or b is None else b - a,
                }
            )
    return rows
