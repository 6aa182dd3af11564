"""Run-ups of many samples of one pair side by side: every sample a lane, each speed from the last.

Where one run-up follows its orbits between the speeds (:mod:`thermogear.study.run_up`), these go
from speed to speed as a test rig does in steps: a jump is found where a step leads across it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.diagram import DIRECTIONS
from thermogear.analysis.family import axis_values
from thermogear.analysis.outcome import outcome_variables
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Variable,
    empty_arrays,
    every,
    keep_going,
    ranges_of,
    spread,
)
from thermogear.case.case import GearCase, gear_case
from thermogear.case.family import GearFamily
from thermogear.case.points import points_of
from thermogear.case.response import RECORD, RULE, Recording, response_variables
from thermogear.case.samples import fields_of
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.case.turn_response import over_turn, settled_response
from thermogear.results.work import Report, carry_out

LANES = 64
"""Samples in one chunk."""


@dataclass(frozen=True, kw_only=True)
class RunUpsPlan:
    """Run-ups over ``speeds`` [rad/s] of the ``rows`` of ``family``; see :func:`run_ups`."""

    family: GearFamily
    speeds: tuple[float, ...]
    rows: tuple[tuple[float, ...], ...]
    rule: Rule = RULE
    record: Recording = RECORD
    kind: str = "run-ups"
    _kept: dict[int, Excitations] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    @property
    def sizes(self) -> dict[str, int]:
        return {
            "direction": len(DIRECTIONS),
            "sample": len(self.rows),
            "pinion_speed": len(self.speeds),
        }

    @property
    def cuts(self) -> dict[str, int]:
        return {"direction": 1, "sample": min(LANES, len(self.rows))}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family.inputs(),
            "names": list(self.family.names),
            "rows": [list(row) for row in self.rows],
            "speeds": list(self.speeds),
            "rule": asdict(self.rule),
            "record": asdict(self.record),
        }

    def variables(self) -> dict[str, Variable]:
        dims = ("direction", "sample", "pinion_speed")
        return outcome_variables(dims) | response_variables(dims, lines=False)

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        columns = zip(self.family.names, self.family.units, np.array(self.rows).T, strict=True)
        way = {"long_name": "direction of the run: 1 up, -1 down"}
        speed = {"units": "rad/s", "long_name": "pinion speed"}
        return {name: (("sample",), values, {"units": unit}) for name, unit, values in columns} | {
            "direction": (("direction",), np.array(DIRECTIONS, np.int8), way),
            "pinion_speed": (("pinion_speed",), np.array(self.speeds), speed),
        }

    def needs(self, key: Key) -> Key | None:
        return None

    def pilot(self, share: float, *, turn: int) -> float:
        """Run a few samples over all speeds, about a ``share`` of the work; what share it was."""
        whole = len(DIRECTIONS) * len(self.rows)
        some = spread(len(self.rows), some=round(share * whole), turn=turn)
        rows = tuple(self.rows[i] for i in some)
        replace(self, rows=rows).compute((turn % len(DIRECTIONS), 0), None, keep_going)
        return some.size / whole

    def thinned(self, step: int) -> tuple[RunUpsPlan, Mapping[str, NDArray[np.int64]]]:
        """The run-ups of every ``step``-th sample over every ``step``-th speed."""
        some = every(len(self.rows), step=step), every(len(self.speeds), step=step)
        rows, speeds = tuple(self.rows[i] for i in some[0]), tuple(self.speeds[i] for i in some[1])
        places = dict(zip(self.sizes, (np.arange(len(DIRECTIONS)), *some), strict=True))
        return replace(self, rows=rows, speeds=speeds), places

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        mine = ranges_of(self, key)["sample"]
        alive()
        springs = self._springs(key[1], np.array(self.rows)[mine])
        count, teeth = len(springs), self.family.case.pair.pinion.teeth
        state = np.tile(np.array(self.family.case.simulation.initial_state), (count, 1))
        found = empty_arrays(self, key)
        order, carried = range(len(self.speeds)), False
        for place in order if key[0] == 0 else reversed(order):
            mesh = np.full(count, teeth * self.speeds[place])
            points = points_of(replace(springs, mesh_frequency=mesh))
            settled, arrays = settled_response(
                points, state, self.rule, self.record, lines=False, carried=carried, alive=alive
            )
            for name, values in arrays.items():
                found[name][0, :, place] = values
            there = np.asarray(np.isfinite(settled.state).all(axis=1))
            state, carried = np.where(there[:, None], settled.state, state), True
        return found

    def _springs(self, chunk: int, rows: NDArray[np.float64]) -> Excitations:
        """What moves the samples; up and down share it."""
        if chunk not in self._kept:
            self._kept[chunk] = self.family.excitations(rows)
        return self._kept[chunk]

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        return over_turn(data, self.family.case).assign_attrs(
            bundle=self.family.bundle,
            state=self.family.state.stored,
            total_periods=int(data["used_periods"].sum()),
        )


def run_ups_plan(
    case: GearCase,
    speeds: ArrayLike,
    samples: Mapping[str, ArrayLike],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    rule: Rule = RULE,
    record: Recording = RECORD,
) -> RunUpsPlan:
    """The plan of :func:`run_ups`."""
    case = gear_case(case)
    axis = np.sort(axis_values("speeds", speeds))
    if not samples:
        raise InputError("samples", "none", allowed="at least one field with its values")
    columns = {name: np.atleast_1d(np.asarray(v, dtype=float)) for name, v in samples.items()}
    sizes = {name: values.shape for name, values in columns.items()}
    shape = next(iter(sizes.values()))
    if len(shape) != 1 or any(size != shape for size in sizes.values()):
        given = ", ".join(f"{name} {size}" for name, size in sizes.items())
        raise InputError("samples", given, allowed="one value of each field for each sample")
    family = GearFamily(case, tuple(columns), bundle, ThermalState.of(state))
    if any("operating.speed" in fields_of(name) for name in family.names):
        raise InputError("samples", "the speed", why="every sample runs over all speeds")
    rows = np.stack(list(columns.values()), axis=1)
    return RunUpsPlan(
        family=family,
        speeds=tuple(axis.tolist()),
        rows=tuple(map(tuple, rows.tolist())),
        rule=rule,
        record=record,
    )


def run_ups(
    case: GearCase,
    speeds: ArrayLike,
    samples: Mapping[str, ArrayLike],
    *,
    bundle: str = "",
    state: StateLike = HOT,
    rule: Rule = RULE,
    store: str | Path | None = None,
    threads: int | None = None,
    report: Report | None = None,
    alive: Alive = keep_going,
) -> xr.Dataset:
    """Run every sample up and down over ``speeds`` [rad/s], all samples as lanes side by side.

    ``samples`` map gear parameters or dotted fields of the case file to SI values, one for each
    sample. The gears stay as hot, and grown by their speed, as at the case's first speed. Each
    speed starts from the motion at the speed before it; the first from the case's initial state.
    Over (direction, sample, pinion_speed): label, period, multiplier, dynamic transmission error
    [m], mesh force [N], dynamic factor, contact loss. A jammed sample, and one that no case could
    have, is a status. With a ``store`` directory the same call resumes; the result does not depend
    on ``threads``, nor on the company of a sample. ``alive`` raises to end the work.
    """
    plan = run_ups_plan(case, speeds, samples, bundle=bundle, state=state, rule=rule)
    return carry_out(plan, store, threads=threads, report=report, alive=alive)
