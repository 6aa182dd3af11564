"""A run-up: speed up and down, undeformed and hot, what is felt and heard, and where it jumps."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.branches import with_branches
from thermogear.analysis.family import axis_values
from thermogear.analysis.outcome import (
    outcome_arrays,
    outcome_variables,
    rule_inputs,
    settle_with_status,
)
from thermogear.analysis.plan import Alive, Arrays, Key, Variable, keep_going, ranges_of
from thermogear.analysis.settle import Rule
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import UNDEFORMED
from thermogear.study.case import GearCase, gear_case
from thermogear.study.gearwords import GearFamily, Tabulated
from thermogear.study.notices import range_notices
from thermogear.study.response import RECORD, Recording, respond, response_variables
from thermogear.study.work import Report, carry_out

Floats = NDArray[np.float64]

RUN_UP_RULE = Rule(first=128, cap=8192, settled=1e-6, chaos_periods=1000)
DIRECTIONS = (1, -1)
BLOCK = 24
KEEP = 16
JUMP = 0.15
"""A transmission error that changes by this share between two speeds has jumped ..."""
STEEP = 3.0
"""... when that is so many times what it changes by between the speeds beside."""


@dataclass(frozen=True, kw_only=True)
class RunUpPlan:
    """A run-up over ``speeds`` [rad/s]; see :func:`run_up`."""

    case: GearCase
    speeds: tuple[float, ...]
    temperatures: tuple[float | None, ...]
    bundle: str
    torque: float
    rule: Rule = RUN_UP_RULE
    record: Recording = RECORD
    block: int = BLOCK
    branch_period: int = 2
    kind: str = "run-up"

    @property
    def sizes(self) -> dict[str, int]:
        return {
            "state": len(self.temperatures),
            "direction": len(DIRECTIONS),
            "pinion_speed": len(self.speeds),
            "section": KEEP,
            "order": self.record.orders.size,
        }

    @property
    def cuts(self) -> dict[str, int]:
        return {"state": 1, "direction": 1, "pinion_speed": min(self.block, len(self.speeds))}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family(0).inputs(),
            "speeds": list(self.speeds),
            "temperatures": [UNDEFORMED if t is None else t for t in self.temperatures],
            "torque": self.torque,
            "rule": rule_inputs(self.rule),
            "record": {f.name: getattr(self.record, f.name) for f in fields(self.record)},
            "block": self.block,
            "branch_period": self.branch_period,
        }

    def family(self, state: int) -> GearFamily:
        """Speed -> lanes in one thermal state."""
        temperature = self.temperatures[state]
        case = replace(self.case, torques=(self.torque,))
        return GearFamily(
            case, ("pinion_speed",), self.bundle, UNDEFORMED if temperature is None else temperature
        )

    def variables(self) -> dict[str, Variable]:
        dims = ("state", "direction", "pinion_speed")
        nan = float("nan")
        found = outcome_variables(dims) | response_variables(dims, lines=True)
        for name in "xv":
            found[f"section_{name}"] = Variable(
                (*dims, "section"),
                "float64",
                nan,
                {"long_name": "Poincare section in half backlashes", "units": "1"},
            )
            found[f"end_{name}"] = Variable(
                dims, "float64", nan, {"long_name": "state carried on", "units": "1"}
            )
        return found

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        reference = self.case.stated.temperatures.reference
        shown = np.array([reference if t is None else t for t in self.temperatures])
        return {
            "gear_temperature": (
                ("state",),
                shown,
                {"units": "K", "long_name": "addendum temperature of both gears"},
            ),
            "direction": (
                ("direction",),
                np.array(DIRECTIONS, np.int8),
                {"long_name": "direction of the run: 1 up, -1 down"},
            ),
            "pinion_speed": (
                ("pinion_speed",),
                np.array(self.speeds),
                {"units": "rad/s", "long_name": "pinion speed"},
            ),
            "order": (
                ("order",),
                self.record.orders,
                {"units": "1", "long_name": "order of the mesh frequency"},
            ),
        }

    def needs(self, key: Key) -> Key | None:
        state, direction, block = key
        blocks = -(-len(self.speeds) // self.cuts["pinion_speed"])
        before = block - 1 if direction == 0 else block + 1
        return (state, direction, before) if 0 <= before < blocks else None

    def pilot(self, points: int) -> int:
        """Follow about ``points`` speeds spread over the range; how many."""
        count = min(points, len(self.speeds))
        some = np.unique(np.linspace(0, len(self.speeds) - 1, count).round().astype(int))
        small = replace(self, speeds=tuple(self.speeds[i] for i in some), block=len(some))
        small.compute((0, 0, 0), None, keep_going)
        return len(some)

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        up = key[1] == 0
        speeds = np.array(self.speeds)[ranges_of(self, key)["pinion_speed"]]
        order = np.arange(speeds.size) if up else np.arange(speeds.size)[::-1]
        points = self.family(key[0])(speeds[:, None])
        state = np.array([self.case.simulation.initial_state])
        if before is not None:
            last = -1 if up else 0
            state = np.array([[before["end_x"][0, 0, last], before["end_v"][0, 0, last]]])
        found: Arrays = {}
        for name, variable in self.variables().items():
            inner = [self.sizes[d] for d in variable.dims[3:]]
            shape = (1, 1, speeds.size, *inner)
            found[name] = np.full(shape, variable.fill, np.dtype(variable.dtype))
        ends = np.full((speeds.size, 2), np.nan)
        for place in order:
            one = np.array([place])
            settled = settle_with_status(
                points.flat.take(one), points.status[one], state, self.rule, KEEP, alive
            )
            for name, row in outcome_arrays(settled, points.status[one]).items():
                found[name][0, 0, place] = row[0]
            found["section_x"][0, 0, place] = settled.sections[0, :, 0]
            found["section_v"][0, 0, place] = settled.sections[0, :, 1]
            if bool(np.isfinite(settled.state).all()):
                state = settled.state
                ends[place] = state[0]
            found["end_x"][0, 0, place], found["end_v"][0, 0, place] = state[0]
        for name, values in respond(points, ends, self.record, lines=True, alive=alive).items():
            found[name][0, 0] = values
        return found

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        data = _with_folds(self, data) if self.branch_period > 0 else data
        data.attrs |= {
            "bundle": self.bundle,
            "pinion_torque": self.torque,
            "pinion_teeth": self.case.pair.pinion.teeth,
            "total_periods": int(data["used_periods"].values.astype(np.int64).sum()),
        }
        data.attrs |= range_notices(self.case, data)
        return _with_jumps(data)


def _with_folds(plan: RunUpPlan, data: xr.Dataset) -> xr.Dataset:
    """Branches and bifurcations of every thermal state, side by side."""
    parts: list[xr.Dataset] = []
    notes: list[str] = []
    speeds = np.array(plan.speeds)
    if speeds.size < 2:
        return data
    for state in range(len(plan.temperatures)):
        here = data.isel(state=state).expand_dims(start=1)
        if not np.any(here["status"].values == 0):
            continue
        family = Tabulated.of(plan.family(state), speeds)
        found = with_branches(here, family, "pinion_speed", plan.branch_period)
        names = [n for n in found.data_vars if str(n).startswith(("branch_", "bifurcation_"))]
        part = found[names].drop_vars(list(found.coords), errors="ignore")
        part["branch_state"] = (("branch",), np.full(part.sizes.get("branch", 0), state, np.int32))
        part["bifurcation_state"] = (
            ("bifurcation",),
            np.full(part.sizes.get("bifurcation", 0), state, np.int32),
        )
        parts.append(part)
        notes.append(str(found.attrs.get("branch_notes", "")))
    if not parts:
        return data
    longest = max(part.sizes.get("branch_point", 1) for part in parts)
    for name in parts[0].data_vars:
        rows = []
        for part in parts:
            values = part[name].values
            if "branch_point" in part[name].dims:
                gap = longest - values.shape[1]
                values = np.pad(values, ((0, 0), (0, gap)), constant_values=np.nan)
            rows.append(values)
        first = parts[0][name]
        data[str(name)] = (first.dims, np.concatenate(rows), first.attrs)
    for name in ("branch_value", "bifurcation_value"):
        data[name].attrs["units"] = "rad/s"
    data.attrs["branch_notes"] = "; ".join(n for n in notes if n)
    return data


def _with_jumps(data: xr.Dataset) -> xr.Dataset:
    """Where the motion jumps on the way up or down, and the fold it jumps at."""
    speeds = data["pinion_speed"].values
    rows: list[dict[str, float | int]] = []
    folds = _folds(data)
    for state in range(data.sizes["state"]):
        for direction, sign in enumerate(DIRECTIONS):
            here = data.isel(state=state, direction=direction)
            order = np.arange(speeds.size)[::sign]
            size = here["dte_peak_to_peak"].values
            # a chaotic motion fluctuates from speed to speed without jumping
            calm = here["period"].values > 0
            moves = np.full(speeds.size - 1, np.nan)
            for step, (a, b) in enumerate(pairwise(order.tolist())):
                if calm[a] and calm[b]:
                    moves[step] = abs(size[b] - size[a]) / min(size[a], size[b])
            for place in np.flatnonzero(moves > JUMP):
                around = np.delete(
                    moves[max(0, int(place) - 1) : int(place) + 2], min(1, int(place))
                )
                around = around[np.isfinite(around)]
                # growth behind a period doubling is steep too, but steep on both sides
                usual = float(around.max()) if around.size else 0.0
                if moves[place] < STEEP * usual:
                    continue
                first, then = int(order[place]), int(order[place + 1])
                low, high = sorted((float(speeds[first]), float(speeds[then])))
                between = [f for s, f in folds if s == state and low <= f <= high]
                rows.append(
                    {
                        "state": state,
                        "direction": sign,
                        "from": float(speeds[first]),
                        "to": float(speeds[then]),
                        "fold": between[0] if between else float("nan"),
                        "before": float(size[first]),
                        "after": float(size[then]),
                    }
                )
    units = {"from": "rad/s", "to": "rad/s", "fold": "rad/s", "before": "m", "after": "m"}
    words = {
        "state": "thermal state of the jump",
        "direction": "1 up, -1 down",
        "from": "last speed before the jump",
        "to": "first speed after it",
        "fold": "speed of the fold between them; NaN: none was located",
        "before": "transmission error before, peak to peak",
        "after": "transmission error after, peak to peak",
    }
    for name, long_name in words.items():
        kind = np.int32 if name in ("state", "direction") else float
        attributes = {"long_name": long_name} | ({"units": units[name]} if name in units else {})
        data[f"jump_{name}"] = (("jump",), np.array([r[name] for r in rows], kind), attributes)
    return data


def _folds(data: xr.Dataset) -> list[tuple[int, float]]:
    if "bifurcation_kind" not in data:
        return []
    kinds = data["bifurcation_kind"].values
    states, values = data["bifurcation_state"].values, data["bifurcation_value"].values
    return [(int(s), float(f)) for k, s, f in zip(kinds, states, values, strict=True) if k == 0]


def run_up_plan(
    case: GearCase,
    speeds: ArrayLike,
    *,
    temperatures: Sequence[float | None] | None = None,
    bundle: str = "",
    torque: float | None = None,
    rule: Rule = RUN_UP_RULE,
    branch_period: int = 2,
) -> RunUpPlan:
    """The plan of :func:`run_up`."""
    case = gear_case(case)
    axis = np.sort(axis_values("speeds", speeds))
    if temperatures is None:
        hot = np.asarray(case.operating.temperatures.pinion_addendum, dtype=float)
        temperatures = (None, float(hot.ravel()[0]))
    states = tuple(None if t is None else float(t) for t in temperatures)
    if not states:
        raise InputError("temperatures", "none", allowed="at least one state")
    load = float(case.torques[0] if torque is None else torque)
    family = GearFamily(case, ("pinion_speed",), bundle)
    hot_states = [t for t in states if t is not None]
    family.require({"pinion_speed": axis, "pinion_torque": load, "gear_temperature": hot_states})
    return RunUpPlan(
        case=case,
        speeds=tuple(axis.tolist()),
        temperatures=states,
        bundle=family.bundle,
        torque=load,
        rule=rule,
        branch_period=branch_period,
    )


def run_up(
    case: GearCase,
    speeds: ArrayLike,
    *,
    temperatures: Sequence[float | None] | None = None,
    bundle: str = "",
    torque: float | None = None,
    rule: Rule = RUN_UP_RULE,
    branch_period: int = 2,
    store: str | Path | None = None,
    threads: int | None = None,
    scheduler: str | None = None,
    report: Report | None = None,
) -> xr.Dataset:
    """Run the gears up and down over ``speeds`` [rad/s], undeformed and hot.

    ``temperatures`` [K] of both addenda, None for undeformed gears (default: these, and as hot
    as the case is); bores, housing and oil go along by the case's rule. Each speed starts from the
    motion at the speed before. Over (state, direction, pinion_speed): dynamic transmission
    error (mean, rms, peak to peak), dynamic mesh force, dynamic factor, contact loss, label and
    multipliers; ``dte_line`` over order as well, the waterfall. ``jump_...``: where the motion
    jumps; ``bifurcation_...`` and ``branch_...``: the folds behind it, from continuation of the
    orbits of up to ``branch_period`` mesh periods (0: none).
    """
    plan = run_up_plan(
        case,
        speeds,
        temperatures=temperatures,
        bundle=bundle,
        torque=torque,
        rule=rule,
        branch_period=branch_period,
    )
    return carry_out(plan, store, threads=threads, scheduler=scheduler, report=report)


def notices_of(data: xr.Dataset) -> list[str]:
    """The notices stored with a result."""
    found = json.loads(str(data.attrs.get("notices", "[]")))
    return [str(text) for text in found]
