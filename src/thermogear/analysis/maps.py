"""Maps of the settled motion over two parameters: early exit, and work only near borders."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.ndimage import binary_dilation

from thermogear.analysis.bordered import Sheet
from thermogear.analysis.borders import MOST_CURVES, expected, with_borders
from thermogear.analysis.family import (
    Family,
    Watching,
    axis_values,
    dimension_of,
    family_for,
    lanes_and_status,
    watched_arrays,
    watched_axes,
    watched_variables,
)
from thermogear.analysis.outcome import (
    begun,
    outcome_arrays,
    outcome_variables,
    require_free,
    settle_with_status,
    start_of,
)
from thermogear.analysis.settle import CHAOTIC, PERIODIC, Rule
from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Progress,
    Variable,
    axis_coordinates,
    empty_arrays,
    every,
    gather,
    keep_going,
    ranges_of,
    spread,
)
from thermogear.base.progress import Progress as Stages
from thermogear.base.progress import duration, silent
from thermogear.base.vocabulary import ASSUMED

MAP_RULE = Rule(chaos_periods=1000)
TILE = 64
STRIDE = 4


@dataclass(frozen=True, kw_only=True)
class MapPlan:
    """A map over ``axes``, two of them; see :func:`parameter_map`."""

    family: Family
    axes: tuple[tuple[float, ...], tuple[float, ...]]
    start: tuple[float, ...] = (0.0, 0.0)
    rule: Rule = MAP_RULE
    refine: bool = False
    tile: int = TILE
    stride: int = STRIDE
    sheet: Sheet | None = None
    """(p, q) -> model, where borders of contact loss are followed."""
    stages: Stages = silent
    """Told of the borders, which follow behind all chunks."""
    kind: str = "map"

    def __post_init__(self) -> None:
        if len(self.family.names) != 2:
            raise InputError("axes", list(self.family.names), allowed="two parameters")
        require_free(self.family.names, self.variables())
        if self.stride < 1 or self.stride & (self.stride - 1):
            raise InputError("stride", self.stride, allowed="1, 2, 4, 8, ...")
        if self.tile < 2:
            raise InputError("tile", self.tile, allowed=">= 2")

    @property
    def sizes(self) -> dict[str, int]:
        inner = {n: len(np.asarray(v)) for n, (_, v, _) in watched_axes(self.family).items()}
        return dict(zip(self.family.names, map(len, self.axes), strict=True)) | inner

    @property
    def cuts(self) -> dict[str, int]:
        named = zip(self.family.names, self.axes, strict=True)
        return {name: min(self.tile, len(values)) for name, values in named}

    @property
    def _kinds(self) -> tuple[str, ...]:
        """What tells motions apart, beside label and period."""
        return self.family.kinds if isinstance(self.family, Watching) else ()

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family.inputs(),
            "axes": {n: list(v) for n, v in zip(self.family.names, self.axes, strict=True)},
            "initial_state": list(self.start),
            "rule": asdict(self.rule),
            "refine": self.refine,
            "tile": self.tile,
            "stride": self.stride,
            **({} if self.sheet is None else {"borders": True}),
        }

    def variables(self) -> dict[str, Variable]:
        found = outcome_variables(self.family.names)
        return found | watched_variables(self.family, self.family.names)

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        own = axis_coordinates(self.family.names, self.family.units, self.axes)
        return own | watched_axes(self.family)

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Compute about a ``share`` of the points, spread over the map; what share it was."""
        some = grid_of(self.axes, share=share, turn=turn)
        small = replace(self, axes=some, refine=False, tile=max(2, *map(len, some)))
        small.compute((0, 0), None, keep_going)
        return math.prod(map(len, some)) / math.prod(map(len, self.axes)) / self.visited

    @property
    def visited(self) -> float:
        """Share of the points that is computed; where some are spared a guess.

        The middle between the first lattice alone and all, by their ratio.
        """
        stride = self.stride if self.refine else 1
        return math.prod(_lattice(len(v), stride).size / len(v) for v in self.axes) ** 0.5

    def sparing(self) -> MapPlan:
        """The same with points spared where neighbours are alike."""
        return replace(self, refine=True)

    def thinned(self, step: int) -> tuple[MapPlan, Mapping[str, NDArray[np.int64]]]:
        """The map of every ``step``-th value of both axes."""
        some = [every(len(values), step=step) for values in self.axes]
        one, two = (
            tuple(values[i] for i in places) for values, places in zip(self.axes, some, strict=True)
        )
        names = self.family.names
        return replace(self, axes=(one, two), refine=False), dict(zip(names, some, strict=True))

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        one, two = (
            np.array(values)[part]
            for values, part in zip(self.axes, ranges_of(self, key).values(), strict=True)
        )
        shape = (one.size, two.size)
        found = empty_arrays(self, key)
        stride = self.stride if self.refine else 1
        done = np.zeros(shape, bool)
        wanted = np.zeros(shape, bool)
        wanted[np.ix_(_lattice(one.size, stride), _lattice(two.size, stride))] = True
        while True:
            places = np.flatnonzero(wanted & ~done)
            if places.size:
                self._settle(one, two, places, found, alive)
                done.flat[places] = True
            if stride == 1:
                found["status"][~done] = ASSUMED
                return found
            wanted = _refined(found, done, stride, self._kinds)
            stride //= 2
            inside = np.zeros(shape, bool)
            inside[np.ix_(_lattice(one.size, stride), _lattice(two.size, stride))] = True
            wanted &= inside

    def _settle(
        self,
        one: NDArray[np.float64],
        two: NDArray[np.float64],
        places: NDArray[np.int64],
        found: Arrays,
        alive: Alive,
    ) -> None:
        i, j = np.unravel_index(places, (one.size, two.size))
        points = np.stack([one[i], two[j]], axis=1)
        lanes, status = lanes_and_status(self.family, points)
        start = np.broadcast_to(np.array(self.start), (len(lanes), len(self.start))).copy()
        start = begun(start, lanes, dimension_of(self.family))
        settled = settle_with_status(lanes, status, start, self.rule, alive=alive)
        for name, values in outcome_arrays(settled, status, lanes).items():
            found[name][i, j] = values
        for name, values in watched_arrays(self.family, points, settled).items():
            found[name][i, j] = values

    def finish(self, data: Dataset) -> Dataset:
        points = int(np.prod([len(a) for a in self.axes]))
        data.attrs |= {
            "total_periods": int(data["used_periods"].sum()),
            "full_periods": points * self.rule.cap,
            "computed_points": int((data["status"] != ASSUMED).sum()),
            "initial_state": list(self.start),
        }
        return self.bordered(data, (self,))

    def bordered(self, data: Dataset, plans: Sequence[MapPlan]) -> Dataset:
        """With borders of contact loss, of one plan for each state of heat, where wanted."""
        sheets = [plan.sheet for plan in plans if plan.sheet is not None]
        if not sheets:
            return data
        axes = [np.array(values) for values in self.axes]
        start = np.array(self.start)
        return with_borders(data, sheets, axes=axes, start=start, progress=self.stages)

    def telling(self, stages: Stages) -> MapPlan:
        """The same that tells ``stages`` what it does behind its chunks."""
        return replace(self, stages=stages)

    def behind(self) -> str:
        """How long each border takes, in words; the map alone tells how many there are."""
        if self.sheet is None:
            return ""
        axes = [np.array(values) for values in self.axes]
        each = duration(expected(self.sheet, axes=axes, start=np.array(self.start)))
        return f"; then about {each} for each border, up to {MOST_CURVES} of a state"


def _lattice(size: int, stride: int) -> NDArray[np.int64]:
    """Every stride-th place and the last one."""
    return np.unique(np.append(np.arange(0, size, stride), size - 1))


def grid_of(axes: Sequence[Sequence[float]], *, share: float, turn: int) -> Any:
    """About a ``share`` of a grid's points, of each axis the same share of its values."""
    each = share ** (1.0 / len(axes))
    return tuple(
        tuple(v[i] for i in spread(len(v), some=round(len(v) * each), turn=turn * math.pi**axis))
        for axis, v in enumerate(axes)
    )


def _refined(
    found: Arrays, done: NDArray[np.bool_], stride: int, kinds: tuple[str, ...] = ()
) -> NDArray[np.bool_]:
    """Places inside or next to cells whose corners differ; equal cells take their corners' label.

    Corners differ in label, period or one of the ``kinds``. ``done``: what is computed.

    A cell counts as equal only when its neighbours are equal too, and never when undecided.
    """
    shape = found["label"].shape
    rows, columns = _lattice(shape[0], stride), _lattice(shape[1], stride)
    # one number for label and period, and then for all
    code = found["label"].astype(np.int64) * 2**31 + found["period"]
    for name in kinds:
        both = np.stack([code.ravel(), np.nan_to_num(found[name].ravel(), nan=-1.0)])
        code = np.unique(both, axis=1, return_inverse=True)[1].reshape(shape)
    corner = code[np.ix_(rows, columns)]
    first = corner[:-1, :-1]
    same = (first == corner[1:, :-1]) & (first == corner[:-1, 1:]) & (first == corner[1:, 1:])
    label = found["label"][np.ix_(rows, columns)][:-1, :-1]
    same &= (label == PERIODIC) | (label == CHAOTIC) | (label > CHAOTIC)
    near = binary_dilation(~same, np.ones((3, 3), bool))
    wanted = np.zeros(shape, bool)
    for i, j in np.argwhere(near):
        wanted[rows[i] : rows[i + 1] + 1, columns[j] : columns[j + 1] + 1] = True
    for i, j in np.argwhere(~near):
        place = (
            slice(int(rows[i]), int(rows[i + 1]) + 1),
            slice(int(columns[j]), int(columns[j + 1]) + 1),
        )
        fresh = ~done[place] & ~wanted[place]
        for name in ("label", "period", *kinds):
            found[name][place][fresh] = found[name][rows[i], columns[j]]
    return wanted


def parameter_map(
    model: object,
    axes: Mapping[str, ArrayLike],
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    rule: Rule = MAP_RULE,
    refine: bool = False,
    tile: int = TILE,
    stride: int = STRIDE,
    threads: int | None = None,
    progress: Progress | None = None,
    alive: Alive = keep_going,
) -> Dataset:
    """What the motion from one start settles on over two parameters.

    ``model`` has one lane, or a return map of any dimension, and number fields named as the two
    ``axes``, or is a family of these parameters; axes and start are in the units of the model.
    ``initial_state`` is (x, x'), of a longer state in its plane
    (:func:`~thermogear.dynamics.plane.plane_of`), or the whole state. A point leaves as soon as
    its label is proven (:class:`Rule`); with ``refine`` the map starts on every ``stride``-th
    point and goes on only where neighbours differ, inside tiles of ``tile`` x ``tile`` points.
    ``rule.full()`` without ``refine`` is the full run.

    Labels are an estimate by this faster rule; :func:`~thermogear.analysis.labels.label` follows
    one point for longer and from several starts.

    Returns label, period, largest multiplier, Lyapunov exponent and counts over the two
    parameters; points that equal neighbours spoke for have the status "assumed" and NaN in every
    number, and their label may be wrong where a motion lives between the points computed. The
    attributes tell the periods run and those of the full run. The result does not depend on
    ``threads``. ``alive`` is called between rounds and raises to end the work.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> found = parameter_map(model, {"frequency": [0.4, 0.5], "force_amplitude": [0.02, 0.03]})
    >>> found.period.values.tolist()
    [[1, 1], [1, 1]]
    """
    return gather(
        map_plan(
            model,
            axes,
            initial_state=initial_state,
            rule=rule,
            refine=refine,
            tile=tile,
            stride=stride,
        ),
        threads=threads,
        progress=progress,
        alive=alive,
    )


def map_plan(
    model: object,
    axes: Mapping[str, ArrayLike],
    *,
    initial_state: ArrayLike = (0.0, 0.0),
    rule: Rule = MAP_RULE,
    refine: bool = False,
    tile: int = TILE,
    stride: int = STRIDE,
) -> MapPlan:
    """The plan of :func:`parameter_map`."""
    if len(axes) != 2:
        raise InputError("axes", list(axes), allowed="two parameters")
    values = [tuple(map(float, axis_values(name, v))) for name, v in axes.items()]
    family = family_for(model, tuple(axes))
    return MapPlan(
        family=family,
        axes=(values[0], values[1]),
        start=start_of(initial_state, dimension_of(family)),
        rule=rule,
        refine=refine,
        tile=tile,
        stride=stride,
    )
