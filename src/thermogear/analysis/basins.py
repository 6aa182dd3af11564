"""Basins of attraction: which start ends where, how much of the plane, how safely."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt

from thermogear.analysis.attractors import (
    Attractor,
    Field,
    attractors_from,
    chaotic_index,
    matched,
    periodic_index,
    trapped,
)
from thermogear.analysis.family import ModelFamily, axis_values
from thermogear.analysis.outcome import LABEL_ATTRIBUTES
from thermogear.analysis.section import lanes_of
from thermogear.analysis.settle import CHAOTIC, DIVERGED, PERIODIC, UNDECIDED, Rule, settle
from thermogear.base.errors import InputError
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Progress,
    Variable,
    every,
    gather,
    keep_going,
    ranges_of,
)
from thermogear.base.vocabulary import STATUS, label, status_attributes

Floats = NDArray[np.float64]

BASIN_RULE = Rule(first=256, cap=8192, settled=1e-6, chaos_periods=1000)
CHUNK_POINTS = 8192
SURVEY = 24
BOX = 5


@dataclass(frozen=True, eq=False, kw_only=True)
class BasinPlan:
    """Basins of one parameter point over a grid of starts; see :func:`basins`."""

    model: Any
    x: tuple[float, ...]
    v: tuple[float, ...]
    attractors: tuple[Attractor, ...]
    seeds: tuple[tuple[float, float], ...] = ()
    rule: Rule = BASIN_RULE
    kind: str = "basins"

    @property
    def sizes(self) -> dict[str, int]:
        return {"x": len(self.x), "v": len(self.v)}

    @property
    def cuts(self) -> dict[str, int]:
        return {"x": max(1, min(len(self.x), CHUNK_POINTS // len(self.v)))}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": ModelFamily(self.model, ()).inputs(),
            "x": list(self.x),
            "v": list(self.v),
            "seeds": [list(s) for s in self.seeds],
            "rule": asdict(self.rule),
        }

    def variables(self) -> dict[str, Variable]:
        dims = ("x", "v")
        nan = float("nan")
        return {
            "reached": Variable(
                dims, "int16", -1, {"long_name": "attractor of the survey, -1: none of them"}
            ),
            "label": Variable(dims, "int8", 0, LABEL_ATTRIBUTES),
            "period": Variable(dims, "int32", 0, {"long_name": "period", "units": "1"}),
            "point_x": Variable(
                dims, "float64", nan, {"long_name": "orbit that the survey missed", "units": "1"}
            ),
            "point_v": Variable(
                dims, "float64", nan, {"long_name": "orbit that the survey missed", "units": "1"}
            ),
            "used_periods": Variable(
                dims, "int32", 0, {"long_name": "mesh periods run", "units": "1"}
            ),
            "status": Variable(dims, "int8", 0, status_attributes()),
        }

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        return {
            "x": (("x",), np.array(self.x), {"units": "1", "long_name": "start displacement"}),
            "v": (("v",), np.array(self.v), {"units": "1", "long_name": "start velocity"}),
        }

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, points: int) -> int:
        """Follow about ``points`` starts spread over the grid; how many."""
        starts = _spread(self.x, self.v, max(2, round(points**0.5)))
        self._ends(starts, keep_going)
        return len(starts)

    def _ends(self, starts: Floats, alive: Alive) -> dict[str, NDArray[Any]]:
        """Where ``starts`` lead, as flat arrays."""
        lanes = lanes_of(self.model)
        field = Field(lanes)
        where, used, _ = trapped(field, starts, self.attractors, alive=alive)
        periods = np.array([a.period for a in self.attractors] or [0])
        period = np.where(where >= 0, periods[np.maximum(where, 0)], 0)
        label = np.where(where == -2, DIVERGED, PERIODIC)
        point = np.full((len(starts), 2), np.nan)
        rest = np.flatnonzero(where == -1)
        if rest.size:
            many = lanes.take(np.zeros(rest.size, int))
            slow = settle(many, starts[rest], self.rule, alive=alive)
            label[rest], period[rest] = slow.label, slow.period
            used[rest] += slow.used
            for row, place in enumerate(rest):
                if slow.label[row] == DIVERGED:
                    where[place] = -2
                elif slow.label[row] == CHAOTIC:
                    where[place] = chaotic_index(self.attractors, field, slow.state[row])
                    point[place] = slow.state[row]
                elif slow.period[row] > 0:
                    n = int(slow.period[row])
                    where[place] = periodic_index(self.attractors, slow.point[row], n, field.unit)
                    point[place] = slow.point[row]
        point[where != -1] = np.nan
        status = np.zeros(len(starts), np.int8)
        status[label == DIVERGED] = STATUS.index("diverged")
        status[(label == UNDECIDED) & (where == -1)] = STATUS.index("not_converged")
        return {
            "reached": where,
            "label": label,
            "period": period,
            "point_x": point[:, 0],
            "point_v": point[:, 1],
            "used_periods": used,
            "status": status,
        }

    def thinned(self, step: int) -> tuple[BasinPlan, Mapping[str, NDArray[np.int64]]]:
        """The basins of every ``step``-th start of both axes."""
        x, v = every(len(self.x), step=step), every(len(self.v), step=step)
        thin = replace(self, x=tuple(self.x[i] for i in x), v=tuple(self.v[i] for i in v))
        return thin, {"x": x, "v": v}

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        x = np.array(self.x)[ranges_of(self, key)["x"]]
        v = np.array(self.v)
        starts = np.stack(np.meshgrid(x, v, indexing="ij"), axis=-1).reshape(-1, 2)
        return {n: a.reshape(x.size, v.size) for n, a in self._ends(starts, alive).items()}

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        """Add attractors that the survey missed, fractions and robustness."""
        where = data["reached"].values.astype(np.int64)
        known = list(self.attractors)
        known, where = _late(self, data, known, where)
        order = sorted(range(len(known)), key=lambda n: (-int(np.count_nonzero(where == n)), n))
        place = np.empty(len(known) + 2, np.int64)
        place[order] = np.arange(len(known))
        place[-1], place[-2] = -1, -2
        where = place[where]
        known = [known[n] for n in order]
        data["attractor"] = (
            ("x", "v"),
            where.astype(np.int16),
            {"long_name": "attractor reached, -1: undecided, -2: diverged"},
        )
        return _described(data, known, where, Field(lanes_of(self.model)).unit)


def _spread(x: Sequence[float], v: Sequence[float], side: int) -> Floats:
    """About ``side`` x ``side`` starts of the grid."""
    xs = np.array(x)[np.unique(np.linspace(0, len(x) - 1, min(side, len(x))).round().astype(int))]
    vs = np.array(v)[np.unique(np.linspace(0, len(v) - 1, min(side, len(v))).round().astype(int))]
    return np.stack(np.meshgrid(xs, vs, indexing="ij"), axis=-1).reshape(-1, 2)


def _late(
    plan: BasinPlan, data: xr.Dataset, known: list[Attractor], where: NDArray[np.int64]
) -> tuple[list[Attractor], NDArray[np.int64]]:
    """Attractors that only single starts of the grid found, in the grid's order."""
    lanes = lanes_of(plan.model)
    field = Field(lanes)
    points = np.stack([data["point_x"].values, data["point_v"].values], axis=-1)
    period, label = data["period"].values, data["label"].values
    for i, j in np.argwhere((where == -1) & np.isfinite(points[..., 0])):
        point, n = points[i, j], int(period[i, j])
        if label[i, j] == CHAOTIC:
            number = chaotic_index(known, field, point)
        else:
            number = periodic_index(known, point, n, field.unit)
        if number < 0:
            fresh, landed = attractors_from(lanes, point[None], plan.rule)
            if landed[0] < 0:
                continue
            number = len(known)
            known.append(fresh[0])
        where[i, j] = number
    return known, where


def _described(
    data: xr.Dataset, known: Sequence[Attractor], where: NDArray[np.int64], unit: Floats
) -> xr.Dataset:
    """The attractors, their fractions and how robust they are, with the grid."""
    count = len(known)
    counts = np.array([np.count_nonzero(where == n) for n in range(count)], np.int64)
    longest = max([1, *(a.period if not a.chaotic else 256 for a in known)])
    points = np.full((count, longest, 2), np.nan)
    for n, one in enumerate(known):
        kept = one.points[:longest]
        points[n, : len(kept)] = kept
    mixed, all_boxes, rough = basin_entropy(where)
    safe = border_distances(
        x=data["x"].values, v=data["v"].values, where=where, known=known, unit=unit
    )
    words = {
        "fraction": ("share of the starts", counts / max(where.size, 1)),
        "count": ("starts that end here", counts),
        "attractor_period": ("mesh periods, 0: chaotic", np.array([a.period for a in known])),
        "attractor_multiplier": (
            "modulus of the largest Floquet multiplier",
            np.array([abs(a.multiplier) for a in known]),
        ),
        "attractor_lyapunov": (
            "largest Lyapunov exponent", np.array([a.lyapunov for a in known])
        ),
        "border_distance": (
            "least distance from the attractor to another basin, in half backlashes; "
            "NaN where it stands outside the grid",
            safe,
        ),
    }  # fmt: skip
    for name, (long_name, values) in words.items():
        data[name] = (
            ("attractor_number",),
            np.asarray(values).reshape(count),
            {"long_name": long_name, "units": "1"},
        )
    for place, name in enumerate(("attractor_x", "attractor_v")):
        data[name] = (
            ("attractor_number", "attractor_point"),
            points[:, :, place],
            {"long_name": "section of the attractor", "units": "1"},
        )
    data.attrs |= {
        "basin_entropy": all_boxes,
        "boundary_basin_entropy": mixed,
        "boundary_fractal": int(mixed > np.log(2.0)),
        "boxes_with_borders": rough,
        "box_cells": BOX,
        "unassigned": float(np.mean(where < 0)) if where.size else 0.0,
        "total_periods": int(data["used_periods"].values.astype(np.int64).sum()),
    }
    return data


def basin_entropy(where: NDArray[np.int64], box: int = BOX) -> tuple[float, float, float]:
    """Boundary basin entropy S_bb, basin entropy S_b and the share of boxes with a border.

    S = -sum p ln p over the attractors inside a box of ``box`` x ``box`` starts; S_b its mean
    over all boxes, S_bb over those with more than one attractor. S_bb > ln 2 proves a fractal
    border. Source: Daza, Wagemakers, Georgeot, Guery-Odelin, Sanjuan, Sci. Rep. 6 (2016) 31416.
    """
    rows, columns = where.shape[0] // box, where.shape[1] // box
    if rows == 0 or columns == 0:
        return 0.0, 0.0, 0.0
    whole = where[: rows * box, : columns * box].reshape(rows, box, columns, box)
    cells = whole.transpose(0, 2, 1, 3).reshape(rows * columns, box * box)
    entropy = np.zeros(rows * columns)
    for value in np.unique(cells):
        share = np.mean(cells == value, axis=1)
        some = share > 0.0
        entropy[some] -= share[some] * np.log(share[some])
    border = np.array([np.unique(row).size > 1 for row in cells])
    mixed = float(entropy[border].mean()) if border.any() else 0.0
    return mixed, float(entropy.mean()), float(border.mean())


def border_distances(
    *,
    x: Floats,
    v: Floats,
    where: NDArray[np.int64],
    known: Sequence[Attractor],
    unit: Floats,
) -> Floats:
    """Least distance of every attractor's section points to a start of another basin.

    Euclidean in (x, v) over half backlash and its rate; the grid's spacing bounds the error.
    """
    found = np.full(len(known), np.nan)
    if x.size < 2 or v.size < 2:
        return found
    steps = (float(x[1] - x[0]) / unit[0], float(v[1] - v[0]) / unit[1])
    for n, one in enumerate(known):
        mine = where == n
        if not mine.any() or mine.all():
            continue
        away = distance_transform_edt(mine, sampling=np.abs(steps))
        i = np.round((one.points[:, 0] - x[0]) / (x[1] - x[0])).astype(int)
        j = np.round((one.points[:, 1] - v[0]) / (v[1] - v[0])).astype(int)
        inside = (i >= 0) & (i < x.size) & (j >= 0) & (j < v.size)
        if inside.any():
            found[n] = float(away[i[inside], j[inside]].min())
    return found


def basin_plan(
    model: object,
    *,
    x: ArrayLike,
    v: ArrayLike,
    rule: Rule = BASIN_RULE,
    seeds: ArrayLike = (),
    survey: int = SURVEY,
) -> BasinPlan:
    """The plan of :func:`basins`; looks for the attractors from ``survey`` x ``survey`` starts."""
    lanes = lanes_of(model)
    if len(lanes) != 1:
        raise InputError("model", f"{len(lanes)} lanes", allowed="one lane")
    xs, vs = axis_values("x", x), axis_values("v", v)
    extra = np.asarray(seeds, dtype=float).reshape(-1, 2)
    starts = np.concatenate([extra, _spread(xs.tolist(), vs.tolist(), survey)])
    found, _ = attractors_from(lanes, starts, rule)
    return BasinPlan(
        model=model,
        x=tuple(xs.tolist()),
        v=tuple(vs.tolist()),
        attractors=tuple(found),
        seeds=tuple((float(a), float(b)) for a, b in extra),
        rule=rule,
    )


def basins(
    model: object,
    *,
    x: ArrayLike,
    v: ArrayLike,
    rule: Rule = BASIN_RULE,
    seeds: ArrayLike = (),
    survey: int = SURVEY,
    threads: int | None = None,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Which attractor every start (x, x') of a grid at phase 0 ends on.

    ``model`` of one lane; ``x`` and ``v`` the axes, in the units of the model. The attractors are
    found first, from a coarse grid of starts and from ``seeds``. Then every start runs until it
    comes close to one; how close was tried out. Starts that reach none are labelled one by one,
    and so late attractors are found. Returns the number of the attractor over (x, v), the largest
    basin first (-1: undecided, -2: diverged); fractions and counts; the attractors' sections,
    multipliers and distance to the nearest border; the basin entropies. Alike for any ``threads``.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> found = basins(model, x=[1.0, 1.2], v=[0.0, 0.1])
    >>> found.attractor_x.values.round(3)
    array([[1.166]])
    """
    plan = basin_plan(model, x=x, v=v, rule=rule, seeds=seeds, survey=survey)
    return gather(plan, threads=threads, progress=progress)


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
        lanes = lanes_of(here)
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
                one.points[0],
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
    period = np.full((points.size, count), -1)
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
                dims, period, "1", "mesh periods, 0: chaotic, -1: absent"
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
