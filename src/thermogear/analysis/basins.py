"""Basins of attraction: which start ends where, how much of the plane, how safely."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import distance_transform_edt

from thermogear.analysis.attractors import (
    Attractor,
    Field,
    attractors_from,
    told_apart,
    trapped,
)
from thermogear.analysis.family import ModelFamily, axis_values, taken
from thermogear.analysis.outcome import LABEL_ATTRIBUTES
from thermogear.analysis.section import lanes_of
from thermogear.analysis.settle import CHAOTIC, DIVERGED, PERIODIC, UNDECIDED, Rule, settle
from thermogear.base.arrays import Floats
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
    spread,
)
from thermogear.base.vocabulary import NO_COUNT, STATUS, status_attributes
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import ClearanceModel
from thermogear.dynamics.plane import plane_of
from thermogear.dynamics.return_map import return_map

BASIN_RULE = Rule(first=256, cap=8192, settled=1e-6, chaos_periods=1000)
CHUNK_POINTS = 8192
SURVEY = 24
BOX = 5
_LOOKING = threading.RLock()


@dataclass(frozen=True, eq=False, kw_only=True)
class BasinPlan:
    """Basins of one parameter point over a grid of starts; see :func:`basins`."""

    model: Any
    x: tuple[float, ...]
    v: tuple[float, ...]
    seeds: tuple[tuple[float, ...], ...] = ()
    rule: Rule = BASIN_RULE
    survey: int = SURVEY
    kind: str = "basins"
    _survey: dict[str, tuple[Attractor, ...]] = field(
        repr=False, compare=False, default_factory=dict
    )

    @property
    def sizes(self) -> dict[str, int]:
        longer = {} if self.dimension == 2 else {"coordinate": self.dimension}
        return {"x": len(self.x), "v": len(self.v), **longer}

    @cached_property
    def dimension(self) -> int:
        """Length of a state."""
        return return_map(self.model).dimension

    @cached_property
    def _starts(self) -> Floats:
        """The starts of the survey: seeds and a coarse grid."""
        extra = np.array(self.seeds, dtype=float).reshape(-1, self.dimension)
        return np.concatenate(
            [extra, plane_of(self.model).starts(_spread(self.x, self.v, self.survey))]
        )

    @property
    def attractors(self) -> tuple[Attractor, ...]:
        """What the survey finds, looked for when first asked."""
        with _LOOKING:
            if "found" not in self._survey:
                self._survey["found"] = tuple(
                    attractors_from(single(self.model), self._starts, self.rule)[0]
                )
            return self._survey["found"]

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_survey": {"found": self.attractors}}

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
        words = {"long_name": "orbit that the survey missed, in the model's units"}
        longer = {"point": Variable((*dims, "coordinate"), "float64", nan, words)}
        return {
            **(longer if self.dimension != 2 else {}),
            "reached": Variable(
                dims, "float64", nan, {"long_name": "attractor of the survey", "units": "1"}
            ),
            "label": Variable(dims, "int8", 0, LABEL_ATTRIBUTES),
            "period": Variable(dims, "int32", 0, {"long_name": "period", "units": "1"} | NO_COUNT),
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
        plain = (("displacement", "1"), ("velocity", "1"))
        named = plain if self.dimension == 2 else plane_of(self.model).words
        return {
            name: ((name,), np.array(values), {"units": unit, "long_name": f"start {words}"})
            for name, values, (words, unit) in zip("xv", (self.x, self.v), named, strict=True)
        }

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Do about a ``share`` of the survey and of the grid; what share it was."""
        whole, points = self._starts, len(self.x) * len(self.v)
        some = whole[spread(len(whole), some=round(share * len(whole)), turn=turn)]
        found, _ = attractors_from(single(self.model), some, self.rule)
        share = len(some) / len(whole)
        places = spread(points, some=round(share * points), turn=turn)
        row, column = np.unravel_index(places, (len(self.x), len(self.v)))
        self._ends(
            np.stack([np.array(self.x)[row], np.array(self.v)[column]], 1), found, keep_going
        )
        return share

    def _ends(
        self, starts: Floats, attractors: Sequence[Attractor], alive: Alive
    ) -> dict[str, NDArray[Any]]:
        """Where ``starts`` (start, 2) in the plane lead, as flat arrays."""
        lanes = single(self.model)
        field = Field(lanes)
        starts = plane_of(self.model).starts(starts)
        where, used, _ = trapped(field, starts, attractors, alive=alive)
        periods = np.array([a.period for a in attractors] or [0])
        period = np.where(where >= 0, periods[np.maximum(where, 0)], 0)
        label = np.where(where == -2, DIVERGED, PERIODIC)
        point = np.full(starts.shape, np.nan)
        rest = np.flatnonzero(where == -1)
        if rest.size:
            many = taken(lanes, np.zeros(rest.size, int))
            slow = settle(many, starts[rest], self.rule, alive=alive)
            label[rest], period[rest] = slow.label, slow.period
            used[rest] += slow.used
            _, place = told_apart(slow, field, attractors)
            # what the survey missed is named when all starts are known
            where[rest] = np.where(place < len(attractors), place, -1)
            chaotic = slow.label[:, None] == CHAOTIC
            point[rest] = np.where(chaotic, slow.state, slow.point)
        point[where != -1] = np.nan
        status = np.zeros(len(starts), np.int8)
        status[label == DIVERGED] = STATUS.index("diverged")
        status[(label == UNDECIDED) & (where == -1)] = STATUS.index("not_converged")
        shown = plane_of(self.model).of(point)
        return {
            **({"point": point} if self.dimension != 2 else {}),
            "reached": np.where(where < 0, np.nan, where),
            "label": label,
            "period": period,
            "point_x": shown[:, 0],
            "point_v": shown[:, 1],
            "used_periods": used,
            "status": status,
        }

    def thinned(self, step: int) -> tuple[BasinPlan, Mapping[str, NDArray[np.int64]]]:
        """The basins of every ``step``-th start of both axes."""
        x, v = every(len(self.x), step=step), every(len(self.v), step=step)
        thin = replace(
            self,
            x=tuple(self.x[i] for i in x),
            v=tuple(self.v[i] for i in v),
            _survey={"found": self.attractors},  # that of the whole serves both
        )
        return thin, {"x": x, "v": v}

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        x = np.array(self.x)[ranges_of(self, key)["x"]]
        v = np.array(self.v)
        starts = np.stack(np.meshgrid(x, v, indexing="ij"), axis=-1).reshape(-1, 2)
        found = self._ends(starts, self.attractors, alive)
        return {n: a.reshape(x.size, v.size, *a.shape[1:]) for n, a in found.items()}

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        """Add attractors that the survey missed, fractions and robustness."""
        nowhere = np.where(data["label"].values == DIVERGED, -2, -1)
        reached = data["reached"].values
        where = np.where(np.isnan(reached), nowhere, np.nan_to_num(reached)).astype(np.int64)
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
            np.where(where < 0, np.nan, where),
            {"long_name": "attractor reached, the status says why none is", "units": "1"},
        )
        return _described(data, known, where, self.model)


def _spread(x: Sequence[float], v: Sequence[float], side: int) -> Floats:
    """About ``side`` x ``side`` starts of the grid."""
    some = (
        np.array(axis)[np.unique(np.linspace(0, size - 1, min(side, size)).round().astype(int))]
        for axis, size in ((x, len(x)), (v, len(v)))
    )
    return np.stack(np.meshgrid(*some, indexing="ij"), axis=-1).reshape(-1, 2)


def _late(
    plan: BasinPlan, data: xr.Dataset, known: list[Attractor], where: NDArray[np.int64]
) -> tuple[list[Attractor], NDArray[np.int64]]:
    """Attractors that only single starts of the grid found, in the grid's order."""
    points = (
        data["point"].values
        if "point" in data
        else np.stack([data["point_x"].values, data["point_v"].values], axis=-1)
    )
    late = (where == -1) & np.isfinite(points[..., 0])
    if late.any():
        known, where[late] = attractors_from(
            single(plan.model), points[late], plan.rule, known=known
        )
    return known, where


def single(model: object) -> Lanes | tuple[object, ...]:
    """The one lane of a one-mass model, else the model as one of one."""
    return lanes_of(model) if isinstance(model, Lanes | ClearanceModel) else (model,)


def _described(
    data: xr.Dataset, known: Sequence[Attractor], where: NDArray[np.int64], model: object
) -> xr.Dataset:
    """The attractors, their fractions and how robust they are, with the grid."""
    count = len(known)
    d, plane = return_map(model).dimension, plane_of(model)
    counts = np.array([np.count_nonzero(where == n) for n in range(count)], np.int64)
    longest = max([1, *(a.period if not a.chaotic else 256 for a in known)])
    points = np.full((count, longest, d), np.nan)
    for n, one in enumerate(known):
        kept = one.points[:longest]
        points[n, : len(kept)] = kept
    shown = plane.of(points)
    mixed, all_boxes, rough = basin_entropy(where)
    safe = border_distances(
        x=data["x"].values,
        v=data["v"].values,
        where=where,
        known=[replace(one, points=plane.of(one.points)) for one in known],
        unit=plane.unit,
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
    data["attractor_period"].attrs |= NO_COUNT
    for place, name in enumerate(("attractor_x", "attractor_v")):
        data[name] = (
            ("attractor_number", "attractor_point"),
            shown[:, :, place],
            {"long_name": "section of the attractor", "units": "1"},
        )
    if d != 2:
        data["attractor_state"] = (
            ("attractor_number", "attractor_point", "coordinate"),
            points,
            {"long_name": "section of the attractor, in the model's units"},
        )
    data.attrs |= {
        "basin_entropy": all_boxes,
        "boundary_basin_entropy": mixed,
        "boundary_fractal": int(mixed > np.log(2.0)),
        "boxes_with_borders": rough,
        "box_cells": BOX,
        "unassigned": float(np.mean(where < 0)) if where.size else 0.0,
        "total_periods": int(data["used_periods"].sum()),
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
    if len(single(model)) != 1:
        raise InputError("model", f"{len(single(model))} lanes", allowed="one lane")
    xs, vs = axis_values("x", x), axis_values("v", v)
    extra = np.asarray(seeds, dtype=float).reshape(-1, return_map(model).dimension)
    return BasinPlan(
        model=model,
        x=tuple(xs.tolist()),
        v=tuple(vs.tolist()),
        seeds=tuple(map(tuple, extra.tolist())),
        rule=rule,
        survey=survey,
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

    ``model`` of one lane, or with a return map of any dimension; ``x`` and ``v`` the axes, in the
    units of the model, of longer states in their plane
    (:func:`~thermogear.dynamics.plane.plane_of`); ``seeds`` are whole states. The attractors are
    found first, from a coarse grid of starts and from ``seeds``. Then every start runs until it
    comes close to one; how close was tried out. Starts that reach none are labelled one by one,
    and so late attractors are found. Returns the number of the attractor over (x, v), the largest
    basin first (NaN: none, the status says why); fractions and counts; the attractors' sections,
    multipliers and distance to the nearest border; the basin entropies. Alike for any ``threads``.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> found = basins(model, x=[1.0, 1.2], v=[0.0, 0.1])
    >>> found.attractor_x.values.round(3)
    array([[1.166]])
    """
    return gather(
        basin_plan(model, x=x, v=v, rule=rule, seeds=seeds, survey=survey),
        threads=threads,
        progress=progress,
    )
