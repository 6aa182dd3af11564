"""Basins along a parameter: the share of random starts that ends on each motion, and its safety.

Starts are drawn evenly in a box of the plane, the same at every value; where each ends is found as
for :mod:`~thermogear.analysis.basins`. Of ``n`` starts ``k`` end on a motion: the share k/n has the
exact interval of a binomial count (Clopper and Pearson, Biometrika 26 (1934) 404), which holds in
at least 95 % of all draws; that of motions none of the starts reached begins at 0. A motion is
called the same at two values when its sections are near each other.
Checked by ``tests/analysis/test_basin_shares.py`` (basins with a border in closed form) and by
``trials/basins.py`` (10 000 other starts at five values).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import linear_sum_assignment
from scipy.spatial.distance import cdist
from scipy.special import betaincinv

from thermogear.analysis.attractors import Attractor, Field, attractors_from, trapped
from thermogear.analysis.basins import BASIN_RULE
from thermogear.analysis.family import Family, axis_values, family_for, unpacked
from thermogear.analysis.outcome import require_free
from thermogear.analysis.settle import Rule
from thermogear.base.arrays import Dataset, Floats, Whole
from thermogear.base.bounds import whole
from thermogear.base.errors import InputError
from thermogear.base.plan import (
    Alive,
    Arrays,
    Coordinate,
    Key,
    Progress,
    Variable,
    axis_coordinates,
    empty_arrays,
    gather,
    keep_going,
    real,
)
from thermogear.base.vocabulary import FASTER_RULE, moves, status_attributes
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.plane import plane_of

STARTS = 400
"""Random starts at a value: a share of a half is known to 5 % of all starts (chosen)."""
SURVEY_STARTS = 64
"""Starts settled one by one before the others only fall into what they found (chosen)."""
TRAP_PERIODS = 512
"""Periods after which a start that fell into no trap is settled by itself (chosen)."""
MOST_ATTRACTORS = 24
"""Attractors kept at a value, those with most starts; further ones count as undecided (chosen)."""
SECTION_POINTS = 32
"""Section points kept of an attractor: all of an orbit that is found, some of chaos."""
SAME_MOTION = 0.5
"""Mean distance of two sections, in units of the plane (of one mass half backlashes), below which
two motions of neighbouring values may be one: a quarter of the way across the backlash (chosen)."""
RAY_STEPS = 64
"""Starts along each ray from an orbit, evenly to the width of the box (chosen)."""
BISECTIONS = 12
"""Halvings of the step in which a ray leaves a basin: to 1/262 144 of the box."""
CONFIDENCE = 0.95
"""Of the interval of a share (convention)."""


@dataclass(frozen=True, kw_only=True)
class SharePlan:
    """Shares of the basins over one parameter; see :func:`basin_shares`."""

    family: Family
    values: tuple[float, ...]
    box: tuple[tuple[float, float], tuple[float, float]]
    starts: int = STARTS
    seed: int = 0
    rule: Rule = BASIN_RULE
    kind: str = "basin-shares"

    @property
    def parameter(self) -> str:
        return self.family.names[0]

    @property
    def sizes(self) -> dict[str, int]:
        kept = {"attractor": MOST_ATTRACTORS, "section": SECTION_POINTS, "axis": 2}
        return {self.parameter: len(self.values), **kept}

    @property
    def cuts(self) -> dict[str, int]:
        return {self.parameter: 1}

    def inputs(self) -> dict[str, Any]:
        about = {"box": [list(ends) for ends in self.box], "starts": self.starts, "seed": self.seed}
        model, rule = self.family.inputs(), asdict(self.rule)
        return {"model": model, self.parameter: list(self.values), **about, "rule": rule}

    def variables(self) -> dict[str, Variable]:
        at = (self.parameter,)
        each = (*at, "attractor")
        count = {"units": "1", "comment": FASTER_RULE}
        words = {"long_name": "mesh periods of the motion, 0: chaotic", "units": "1"}
        return {
            "status": Variable(at, "int8", 0, status_attributes()),
            "undecided": Variable(at, "int32", 0, count | {"long_name": "starts left undecided"}),
            "diverged": Variable(at, "int32", 0, count | {"long_name": "starts that diverge"}),
            "plane_unit": real(at, "scales of the plane of starts", "1", "axis"),
            "plane_scale": real(
                at, "metres, and metres a second, of one in the plane", "1", "axis"
            ),
            "attractor_count": Variable(
                each, "int32", 0, count | {"long_name": "starts that end here"}
            ),
            "attractor_period": Variable(each, "float64", np.nan, words),
            "attractor_multiplier": real(each, "modulus of the largest Floquet multiplier", "1"),
            "attractor_lyapunov": real(each, "largest Lyapunov exponent", "1"),
            "attractor_section": real(
                each, "section at phase 0, in the plane", "1", "section", "axis"
            ),
            "attractor_least": real(
                each, "least disturbance seen to leave the motion, along one axis", "1", "axis"
            ),
        }

    def coordinates(self) -> dict[str, Coordinate]:
        return axis_coordinates(self.family.names, self.family.units, [self.values])

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Do one value, however small a ``share`` is asked for: rays cost as much as starts."""
        self.compute((turn % len(self.values),), None, keep_going)
        return 1.0 / len(self.values)

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        arrays = empty_arrays(self, key)
        made = self.family(np.array([[self.values[key[0]]]]))
        lane, status = unpacked(made, 1)
        arrays["status"][:] = status
        if not moves(status).all():
            return arrays
        plane = plane_of(lane if isinstance(lane, Lanes) else lane[0])
        low, high = np.transpose(self.box)
        drawn = np.random.default_rng(self.seed).uniform(low, high, (self.starts, 2))
        known, where = ends_of(lane, plane.starts(drawn), self.rule, alive=alive)
        counts = np.bincount(where[where >= 0], minlength=len(known))
        order = np.argsort(-counts, kind="stable")[:MOST_ATTRACTORS]
        arrays["diverged"][:] = np.count_nonzero(where == -2)
        arrays["undecided"][:] = self.starts - arrays["diverged"] - counts[order].sum()
        arrays["plane_unit"][:] = plane.unit
        arrays["plane_scale"][:] = getattr(made, "plane_scale", plane.scale)
        widths = np.ptp(self.box, axis=1)
        least = least_disturbances(lane, known, self.rule, widths=widths, alive=alive)
        for place, number in enumerate(order):
            attractor = known[number]
            points = plane.of(attractor.points[:SECTION_POINTS])
            arrays["attractor_section"][0, place, : len(points)] = points
            arrays["attractor_count"][0, place] = counts[number]
            arrays["attractor_period"][0, place] = attractor.period
            arrays["attractor_multiplier"][0, place] = abs(attractor.multiplier)
            arrays["attractor_lyapunov"][0, place] = attractor.lyapunov
            arrays["attractor_least"][0, place] = least[number]
        return arrays

    def finish(self, data: Dataset) -> Dataset:
        """Name motions along the parameter; shares with their intervals, the least disturbance."""
        import xarray as xr

        sections = data["attractor_section"].values / data["plane_unit"].values[:, None, None]
        present = data["attractor_count"].values > 0
        motion = np.full(present.shape, -1)
        last: list[Floats] = []
        for value, here in enumerate(present):
            each = [points[np.isfinite(points[:, 0])] for points in sections[value, here]]
            motion[value, here] = matched(each, last=last)
            for number, section in zip(motion[value, here], each, strict=True):
                last[number : number + 1] = [section]
        total = np.bincount(motion[present], data["attractor_count"].values[present], len(last))
        order = np.argsort(-total, kind="stable")
        # of each motion, the place among the attractors of every value
        place = np.where(motion[:, None] == order[:, None], np.arange(present.shape[1]), -1).max(2)
        where = xr.DataArray(place, dims=(self.parameter, "motion"))
        along = data[[name for name in data if "attractor" in data[name].dims]]
        moved = along.isel(attractor=where).where(where >= 0)
        moved["attractor_count"] = moved["attractor_count"].fillna(0).astype(np.int32)
        new = {name: str(name).replace("attractor", "motion") for name in along}
        return self._described(data.drop_vars(list(along)).merge(moved.rename(new)))

    def _described(self, data: Dataset) -> Dataset:
        """With shares, their intervals, and the least disturbances in SI where these are known."""
        ways, count = (self.parameter, "motion"), data["motion_count"].values
        moving = moves(data["status"].values)
        low, high = interval(count, of=self.starts)
        known = {
            "motion_share": ("share of the starts", count / self.starts),
            "motion_share_low": ("low end of the interval of the share", low),
            "motion_share_high": ("high end of the interval of the share", high),
        }
        for name, (words, values) in known.items():
            about = {"long_name": words, "units": "1"}
            data[name] = (ways, np.where(moving[:, None], values, np.nan), about)
        for name in ("undecided", "diverged"):
            data[f"{name}_share"] = data[name].where(moving) / self.starts
        for place, (axis, name, unit) in enumerate(
            (("x", "displacement", "m"), ("v", "velocity", "m/s"))
        ):
            least, words = data["motion_least"][..., place], f"least {name} that leaves the motion"
            data[f"least_{axis}"] = least.assign_attrs(long_name=words, units="1")
            about = {"long_name": words, "units": unit}
            data[f"least_{name}"] = (least * data["plane_scale"][:, place]).assign_attrs(about)
        box = np.ravel(self.box).tolist()
        data.attrs |= {"parameter": self.parameter, "starts": self.starts, "box": box}
        numbers = np.arange(1, count.shape[1] + 1)
        return data.drop_vars("motion_least").assign_coords(motion=numbers)


def interval(count: ArrayLike, *, of: int, confidence: float = CONFIDENCE) -> tuple[Floats, Floats]:
    """The exact interval (low, high) of a share, of which ``count`` of so many draws are seen.

    B(a/2; k, n - k + 1) to B(1 - a/2; k + 1, n - k), quantiles of the beta distribution,
    a = 1 - confidence; 0 below none and 1 above all. Clopper and Pearson, Biometrika 26 (1934) 404.

    >>> [float(end[0].round(4)) for end in interval([0], of=100)]
    [0.0, 0.0362]
    """
    k, tail = np.asarray(count, dtype=float), 0.5 * (1.0 - confidence)
    low = np.where(k > 0, betaincinv(np.maximum(k, 1.0), of - k + 1.0, tail), 0.0)
    high = np.where(k < of, betaincinv(k + 1.0, np.maximum(of - k, 1.0), 1.0 - tail), 1.0)
    return low, high


def ends_of(
    lanes: Lanes | Sequence[object],
    starts: Floats,
    rule: Rule,
    *,
    known: Sequence[Attractor] = (),
    alive: Alive = keep_going,
) -> tuple[list[Attractor], Whole]:
    """The attractors of one lane, those ``known`` first, and where each of ``starts`` (start, d)
    ends: its place among them, -1 undecided, -2 diverged.
    """
    first = 0 if known else SURVEY_STARTS
    attractors, where = attractors_from(lanes, starts[:first], rule, known=known, alive=alive)
    rest = starts[first:]
    trap, _, _ = trapped(Field(lanes), rest, attractors, cap=TRAP_PERIODS, alive=alive)
    late = trap == -1
    attractors, trap[late] = attractors_from(lanes, rest[late], rule, known=attractors, alive=alive)
    return attractors, np.append(where, trap)


def least_disturbances(
    lanes: Lanes | Sequence[object],
    known: Sequence[Attractor],
    rule: Rule,
    *,
    widths: Floats,
    alive: Alive = keep_going,
) -> Floats:
    """How far each attractor must be pushed to leave it, along either axis alone: (attractor, 2).

    From every section point of an orbit (mesh phase 0) rays go both ways along each axis of the
    plane, the other coordinate unchanged, to the ``widths`` of the box. The first start along them
    that is seen to end elsewhere, or to diverge, is drawn nearer by bisection. That is an upper
    bound of the least disturbance: a part of another basin thinner than a step of the rays may lie
    before. In units of the plane; nan where no ray leaves, and of chaos.
    """
    single_model = lanes if isinstance(lanes, Lanes) else lanes[0]
    orbits = [n for n, attractor in enumerate(known) if not attractor.chaotic]
    owner = np.repeat(orbits, [4 * len(known[n].points) for n in orbits]).astype(int)
    least = np.full((len(known), 2), np.inf)
    if not owner.size:
        return np.full((len(known), 2), np.nan)
    home = np.repeat(np.concatenate([known[n].points for n in orbits]), 4, axis=0)
    axis = np.tile([0, 0, 1, 1], len(owner) // 4)
    length = np.tile([1.0, -1.0], len(owner) // 2) * widths[axis]
    way = length[:, None] * plane_of(single_model).lift.T[axis]

    def leaves(along: Floats, rays: Whole) -> Any:
        starts = home[rays] + along[:, None] * way[rays]
        _, where = ends_of(lanes, starts, rule, known=known, alive=alive)
        return (where != owner[rays]) & (where != -1)

    every = np.arange(len(owner))
    steps = np.tile(np.arange(1, RAY_STEPS + 1) / RAY_STEPS, len(owner))
    gone = leaves(steps, np.repeat(every, RAY_STEPS)).reshape(-1, RAY_STEPS)
    rays = every[gone.any(axis=1)]
    high = (1.0 + gone[rays].argmax(axis=1)) / RAY_STEPS
    low = high - 1.0 / RAY_STEPS
    for _ in range(BISECTIONS if rays.size else 0):
        middle = 0.5 * (low + high)
        out = leaves(middle, rays)
        low, high = np.where(out, low, middle), np.where(out, middle, high)
    np.minimum.at(least, (owner[rays], axis[rays]), high * np.abs(length[rays]))
    return np.where(np.isfinite(least), least, np.nan)


def matched(here: Sequence[Floats], *, last: Sequence[Floats]) -> Whole:
    """The number of each section ``here`` (point, 2) among those seen ``last``; new ones go on.

    Pairs have the least sum of mean distances (Kuhn, Naval Research Logistics 2 (1955) 83), each
    below :data:`SAME_MOTION`; sections are in units of the plane.
    """
    gap = np.array([_section_distance(before, now) for before in last for now in here])
    gap = np.minimum(gap, SAME_MOTION).reshape(len(last), len(here))
    rows, columns = linear_sum_assignment(gap)
    near = gap[rows, columns] < SAME_MOTION
    numbers = np.full(len(here), -1)
    numbers[columns[near]] = rows[near]
    numbers[numbers < 0] = len(last) + np.arange(np.count_nonzero(numbers < 0))
    return numbers


def _section_distance(first: Floats, second: Floats) -> float:
    """The larger of the mean distances of the points of each section from the other."""
    gaps = cdist(first, second, "chebyshev")
    return float(max(gaps.min(axis=0).mean(), gaps.min(axis=1).mean()))


def basin_shares(
    model: object,
    parameter: str,
    values: ArrayLike,
    *,
    x: tuple[float, float],
    v: tuple[float, float],
    starts: int = STARTS,
    seed: int = 0,
    rule: Rule = BASIN_RULE,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Dataset:
    """Shares of random starts that end on each motion over ``values`` of a ``parameter``.

    ``model`` as of :func:`~thermogear.analysis.diagram.orbit_diagram`; ``starts`` are drawn evenly
    with ``x`` and ``v`` between their ends, in the plane of the model
    (:func:`~thermogear.dynamics.plane.plane_of`), by ``seed``, the same at every value. Returns
    over (parameter, motion) ``motion_share`` with the ends of its 95 % interval, count, period
    (nan: not found there), multiplier, exponent, section, ``least_x`` and ``least_v``: the least
    displacement and the least change of velocity seen to leave the motion, upper bounds
    (:func:`least_disturbances`; of gears ``least_displacement`` [m] and ``least_velocity`` [m/s],
    too); motions with most starts first. Over the parameter the counts
    ``undecided`` and ``diverged``. Alike for any ``threads``.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> shares = basin_shares(model, "frequency", [0.7], x=(-2, 2), v=(-2, 2), starts=100)
    >>> shares.motion_share.values.round(2).tolist()
    [[0.75, 0.25]]
    """
    plan = share_plan(model, parameter, values, x=x, v=v, starts=starts, seed=seed, rule=rule)
    return gather(plan, threads=threads, progress=progress)


def share_plan(
    model: object,
    parameter: str,
    values: ArrayLike,
    *,
    x: tuple[float, float],
    v: tuple[float, float],
    starts: int = STARTS,
    seed: int = 0,
    rule: Rule = BASIN_RULE,
) -> SharePlan:
    """The plan of :func:`basin_shares`."""
    for name, ends in (("x", x), ("v", v)):
        if not -np.inf < ends[0] < ends[1] < np.inf:
            raise InputError(name, list(ends), allowed="two finite numbers, the lower first")
    whole("starts", starts, least=1)
    axis = tuple(np.sort(axis_values(parameter, values)).tolist())
    plan = SharePlan(
        family=family_for(model, (parameter,)), values=axis, box=(x, v), starts=starts, seed=seed,
        rule=rule,
    )  # fmt: skip
    require_free(plan.family.names, (*plan.variables(), "attractor", "motion", "axis"))
    return plan
