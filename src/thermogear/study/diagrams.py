"""Diagrams, maps and basins of a case: its words become plans."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np

from thermogear.analysis.basin_shares import SharePlan, share_plan
from thermogear.analysis.basins import BASIN_RULE, BasinPlan, basin_plan
from thermogear.analysis.diagram import BRANCH_PERIOD, DIAGRAM_RULE, DiagramPlan, diagram_plan
from thermogear.analysis.family import Family
from thermogear.analysis.maps import MAP_RULE, MapPlan, map_plan
from thermogear.analysis.settle import Rule
from thermogear.analysis.stacked import StackedPlan
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.stores import read_manifests
from thermogear.case.base import Case
from thermogear.case.case import GearCase, gear_case
from thermogear.case.family import (
    GearFamily,
    NumberFamily,
    Tabulated,
    between_points,
    family,
    moving,
)
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.results.work import Estimate, estimate
from thermogear.study.shafts.branches import TrainGrid
from thermogear.study.shafts.family import TabulatedTrains, TrainFamily
from thermogear.study.shafts.moving import LONGEST
from thermogear.study.shafts.state import STATES

AnyMap: TypeAlias = MapPlan | StackedPlan
WHOLE = 120.0
"""Seconds of estimated time below which every point of a map is computed."""
TRAIN_TILE, TRAIN_STRIDE = 8, 2
"""A train's point costs as much as thousands of lanes: small chunks, and few points spared."""


@dataclass(frozen=True, kw_only=True)
class Train:
    """That the drive train of a case moves, not its gears on rigid bearings.

    ``operating`` point, from 0; ``coordinates`` of the reduced train, the interface and 16 modes
    if left out; ``seen`` the bearing whose journal is drawn, "" the teeth.
    """

    operating: int = 0
    coordinates: int | None = None
    seen: str = ""


def case_family(
    case: Case,
    names: Sequence[str],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    train: Train | None = None,
) -> GearFamily | NumberFamily | TrainFamily:
    """The family of a case over ``names``: of its gears alone, or of its drive ``train``.

    Of gears whose teeth differ the mean tooth over one mesh period; without a train the whole turn
    where the case states ``gears.period``.
    """
    if isinstance(case, GearCase):
        case = case.unless_stated("period", "mesh") if train is None else case.mean_tooth()
    if train is None:
        return family(case, tuple(names), bundle, state, numbers=changes)
    if changes:
        raise InputError("--but", ", ".join(changes), why="the case has gears", fix="use --set")
    gears = gear_case(case)
    most = len(gears.speeds) * len(gears.torques)
    if not 0 <= train.operating < most:
        raise InputError("--operating", train.operating + 1, allowed=f"1..{most}")
    return TrainFamily(
        gears, tuple(names), bundle, ThermalState.of(state), operating=train.operating,
        coordinates=train.coordinates, seen=train.seen,
    )  # fmt: skip


def rule_of(family: TrainFamily, rule: Rule) -> Rule:
    """``rule``, its periods fewer where shafts turn forces with them: one is then many meshes.

    Raises InputError where all shafts come back in place too late to wait for it.
    """
    cycle = family.cycle
    if cycle == 1:
        return rule
    if cycle > LONGEST:
        raise InputError(
            "shafts",
            f"forces that come back after {cycle} mesh periods",
            allowed=f"up to {LONGEST}",
            why="unbalance, eccentricity or run-out turn with shafts of these teeth",
            fix="leave them out here; `waterfall` and `run` follow them",
        )
    return replace(rule, first=8, cap=64, max_period=2, chaos_periods=40)


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
    train: Train | None = None,
) -> DiagramPlan:
    """The orbit diagram of a case, or of its drive ``train``, over one parameter.

    Over a gear parameter the tables are computed at ``values`` and run straight between them,
    which is where bifurcations are located.
    """
    whole = case_family(case, (name,), bundle=bundle, state=state, changes=changes, train=train)
    whole.require({name: values})
    axis = np.sort(values)
    lanes: Family = whole
    rule = DIAGRAM_RULE
    if isinstance(whole, TrainFamily):
        rule = rule_of(whole, rule)
        lanes = TabulatedTrains.of(whole, axis)
    elif isinstance(whole, GearFamily) and axis.size > 1:
        lanes = Tabulated.of(whole, axis)
    begin = starts or (case.simulation.initial_state,)
    return diagram_plan(lanes, name, axis, starts=begin, branch_period=branch_period, rule=rule)


def case_map(
    case: Case,
    axes: Mapping[str, Floats],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    refine: bool = False,
    train: Train | None = None,
    borders: bool = False,
) -> MapPlan:
    """The map of regimes of a case, or of its drive ``train``, over two parameters.

    With ``borders`` of contact loss; numbers of a train run straight between those of the map.
    """
    whole = case_family(
        case, tuple(axes), bundle=bundle, state=state, changes=changes, train=train
    )  # fmt: skip
    whole.require(axes)
    start = case.simulation.initial_state
    if isinstance(whole, TrainFamily):
        plan = map_plan(
            whole, axes, initial_state=start, refine=refine, rule=rule_of(whole, MAP_RULE),
            tile=TRAIN_TILE, stride=TRAIN_STRIDE,
        )  # fmt: skip
    else:
        plan = map_plan(whole, axes, initial_state=start, refine=refine)
    if not borders:
        return plan
    grid = TrainGrid if isinstance(whole, TrainFamily) else PairGrid
    return replace(plan, sheet=grid(whole, tuple(np.sort(values) for values in axes.values())))


class PairGrid(TrainGrid):
    """A pair's family, as a train's; plain numbers are put in as they are."""

    def __call__(self, *values: float) -> Any:
        plain = isinstance(self.family, NumberFamily)
        return self.model(list(values)) if plain else super().__call__(*values)

    def between(self, low: Any, high: Any, weight: float) -> Any:
        """Straight between two corners, the speed exactly."""
        return between_points(low, high, np.array([weight]))

    def model(self, row: list[float]) -> Any:
        """The gears at one value of every parameter; InputError where nothing moves."""
        return moving(self.family(np.array([row])), self.family)


def train_maps(
    case: Case,
    axes: Mapping[str, Floats],
    *,
    bundle: str = "",
    refine: bool = False,
    train: Train | None = None,
    borders: bool = False,
) -> StackedPlan:
    """The maps of a case's drive ``train`` undeformed and hot, side by side, over two parameters.

    None of them the temperature.
    """
    chosen = Train() if train is None else train
    plans = [
        case_map(
            case, axes, bundle=bundle, state=state, refine=refine, train=chosen, borders=borders
        )
        for state in STATES
    ]
    return StackedPlan(plans=tuple(plans), words=tuple(state.words for state in STATES))


def whole_or_spared(
    plan: AnyMap, directory: Path, *, threads: int | None = None
) -> tuple[AnyMap, Estimate | None]:
    """The map ``plan`` of every point, or sparing some where all take longer than :data:`WHOLE`.

    With its estimate, where one was made: a store in ``directory`` keeps what it was begun with.
    """
    spared = plan.sparing()
    for begun in read_manifests(directory).values():
        return spared if begun["inputs"] == json.loads(json.dumps(spared.inputs())) else plan, None
    found = estimate(plan, threads=threads)
    if found.seconds < WHOLE:
        return plan, found
    return spared, replace(found, seconds=found.seconds * spared.visited)


def case_basins(
    case: Case,
    *,
    x: Floats,
    v: Floats,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    train: Train | None = None,
) -> BasinPlan:
    """The basins of a case, or of its drive ``train``, at its base set or one operating point."""
    whole = case_family(case, (), bundle=bundle, state=state, changes=changes, train=train)
    if isinstance(whole, TrainFamily):
        return basin_plan(whole.model, x=x, v=v, rule=rule_of(whole, BASIN_RULE))
    points = moving(whole(np.empty((1, 0))), whole)
    return basin_plan(points.model() if points.gears else whole.model, x=x, v=v)


def case_basin_shares(
    case: Case,
    name: str,
    values: Floats,
    *,
    x: Floats,
    v: Floats,
    bundle: str = "",
    state: StateLike = HOT,
    changes: Mapping[str, float] | None = None,
    train: Train | None = None,
) -> SharePlan:
    """Shares of the basins of a case, or of its drive ``train``, over one parameter.

    As many random starts as a grid of ``x`` and ``v`` has places, between the ends of these axes.
    """
    whole = case_family(case, (name,), bundle=bundle, state=state, changes=changes, train=train)
    whole.require({name: values})
    rule = rule_of(whole, BASIN_RULE) if isinstance(whole, TrainFamily) else BASIN_RULE
    width, height = ((float(axis[0]), float(axis[-1])) for axis in (x, v))
    return share_plan(whole, name, values, x=width, v=height, starts=x.size * v.size, rule=rule)
