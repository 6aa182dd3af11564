"""A sweep over gear parameters: every point from the case's own start, any number of axes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.family import axis_values
from thermogear.analysis.maps import grid_of
from thermogear.analysis.outcome import outcome_variables
from thermogear.analysis.settle import Rule
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.notice import stored_notices
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Variable,
    axis_coordinates,
    every,
    keep_going,
    ranges_of,
)
from thermogear.case.allowed import gear_parameter
from thermogear.case.case import GearCase, gear_case
from thermogear.case.family import GearFamily
from thermogear.case.response import RECORD, RULE, Recording, response_variables
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.case.turn_response import over_turn, settled_response
from thermogear.results.result import Result
from thermogear.results.work import Report, carry_out
from thermogear.study.answers.points import answer_numbers, answer_variables
from thermogear.study.notices import finished, range_notices
from thermogear.study.series_along import (
    FEW_PARTS,
    at_points,
    parts_taken,
    point_variables,
    sweep_notice,
)

CHUNK_POINTS, SERIES_POINTS = 128, 8
"""Points of a chunk, and of one whose points are of a series each."""


@dataclass(frozen=True, kw_only=True)
class SweepPlan:
    """A sweep over ``axes``, ``parts`` of a series at each point; see :func:`sweep`."""

    family: GearFamily
    axes: tuple[tuple[float, ...], ...]
    start: tuple[float, float]
    rule: Rule = RULE
    record: Recording = RECORD
    parts: int = 1
    kind: str = "sweep"

    @property
    def sizes(self) -> dict[str, int]:
        found = dict(zip(self.family.names, map(len, self.axes), strict=True))
        return found | {"order": self.record.orders.size}

    @property
    def cuts(self) -> dict[str, int]:
        """Whole inner axes as long as a chunk stays short."""
        room = CHUNK_POINTS if self.parts == 1 else SERIES_POINTS
        found: dict[str, int] = {}
        for name, values in reversed(list(zip(self.family.names, self.axes, strict=True))):
            found[name] = max(1, min(len(values), room))
            room //= found[name]
        return {name: found[name] for name in self.family.names}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family.inputs(),
            "axes": {n: list(v) for n, v in zip(self.family.names, self.axes, strict=True)},
            "initial_state": list(self.start),
            "rule": asdict(self.rule),
            "record": asdict(self.record),
        } | ({"parts": self.parts} if self.parts > 1 else {})

    def variables(self) -> dict[str, Variable]:
        dims = self.family.names
        one_pair = outcome_variables(dims) | response_variables(dims)
        of_parts = point_variables(dims) if self.parts > 1 else {}
        return one_pair | answer_variables(dims) | of_parts

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        found = axis_coordinates(self.family.names, self.family.units, self.axes)
        return found | {"order": self.record.coordinate}

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Compute about a ``share`` of the points, spread over the grid; what share it was."""
        some = grid_of(self.axes, share=share, turn=turn)
        rows = np.stack(np.meshgrid(*map(np.array, some), indexing="ij"), -1)
        self._rows(rows.reshape(-1, len(some)), keep_going)
        return int(rows[..., 0].size) / math.prod(map(len, self.axes))

    def thinned(self, step: int) -> tuple[SweepPlan, Mapping[str, NDArray[np.int64]]]:
        """The sweep over every ``step``-th value of each axis."""
        some = [every(len(values), step=step) for values in self.axes]
        axes = tuple(
            tuple(values[i] for i in places) for values, places in zip(self.axes, some, strict=True)
        )
        return replace(self, axes=axes), dict(zip(self.family.names, some, strict=True))

    def _rows(self, rows: Floats, alive: Alive) -> Arrays:
        points = self.family(rows)
        start = np.broadcast_to(np.array(self.start), (len(rows), 2)).copy()
        _, found = settled_response(points, start, self.rule, self.record, alive=alive)
        of_parts = at_points(self.family, rows, self.parts, alive) if self.parts > 1 else {}
        return found | answer_numbers(self.family, rows) | of_parts

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        ranges = ranges_of(self, key)
        values = [np.array(v)[ranges[n]] for n, v in zip(self.family.names, self.axes, strict=True)]
        grid = np.stack(np.meshgrid(*values, indexing="ij"), -1)
        shape = grid.shape[:-1]
        flat = self._rows(grid.reshape(-1, len(values)), alive)
        return {name: a.reshape(*shape, *a.shape[1:]) for name, a in flat.items()}

    def finish(self, data: Dataset) -> Dataset:
        case = self.family.case
        of_series = [sweep_notice(case, self.parts, self.family.names)] if self.parts > 1 else []
        return over_turn(data, case).assign_attrs(
            bundle=self.family.bundle,
            state=self.family.state.stored,
            notices=stored_notices([*of_series, *range_notices(case, data)]),
        )


def _by_long_names(axes: Mapping[str, ArrayLike]) -> dict[str, Floats]:
    """Axes under the long names of their parameters, values as given (SI)."""
    found: dict[str, Floats] = {}
    for name, values in axes.items():
        full = gear_parameter(name).name
        if full in found:
            raise InputError("parameter", repr(name), allowed="different parameters")
        found[full] = np.atleast_1d(np.asarray(values, dtype=float))
    return found


def sweep_plan(
    case: GearCase,
    axes: Mapping[str, ArrayLike],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    rule: Rule = RULE,
    record: Recording = RECORD,
    parts: int | None = None,
) -> SweepPlan:
    """The plan of :func:`sweep`."""
    whole = gear_case(case)
    case = whole.over_speeds()
    if not axes:
        raise InputError("axes", "none", allowed="at least one parameter")
    named = _by_long_names(axes)
    values = tuple(tuple(axis_values(n, v).tolist()) for n, v in named.items())
    family = GearFamily(case, tuple(named), bundle, ThermalState.of(state))
    family.require(named)
    return SweepPlan(
        family=family,
        axes=values,
        start=case.simulation.initial_state,
        rule=rule,
        record=record.in_orders_of(case.period.mesh_periods),
        parts=parts_taken(whole, family, parts, usual=FEW_PARTS),
    )


def sweep(
    case: GearCase,
    axes: Mapping[str, ArrayLike],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    rule: Rule = RULE,
    parts: int | None = None,
    store: str | Path | None = None,
    threads: int | None = None,
    report: Report | None = None,
    alive: Alive = keep_going,
) -> Result:
    """Settled motion and every number of the answers over any grid of gear parameters.

    ``axes`` map names to SI values: pinion_speed [rad/s], pinion_torque [N m], gear_temperature
    [K], cold_half_backlash [m], damping_ratio, or a dotted field of the case file. Every point
    starts from the case's initial state. ``bundle`` one of the case's (the first by default),
    ``state`` "hot" or "undeformed" where the temperature is no axis. With a ``store`` directory the
    same call resumes. Jammed and diverged points are a status. A case in series has
    ``series_...`` columns of the first ``parts`` parts (16..1024, default 16; 1: none) of the gears
    of each point, at its load, speed and damping.
    """
    plan = sweep_plan(case, axes, bundle=bundle, state=state, rule=rule, parts=parts)
    data = carry_out(
        plan,
        store,
        threads=threads,
        report=report,
        alive=alive,
        title=case.title,
    )
    return finished(data, case.title)
