"""A run-up: speed up and down, undeformed and hot, what is felt and heard, and where it jumps."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from thermogear.analysis.bifurcations import FLIP, FOLD
from thermogear.analysis.branches import with_branches, with_branches_of_states
from thermogear.analysis.family import axis_values
from thermogear.analysis.follow import Leap, follow
from thermogear.analysis.outcome import outcome_arrays, outcome_variables, settle_with_status
from thermogear.analysis.settle import PERIODIC, Rule, Settled
from thermogear.base.arrays import Floats, Whole
from thermogear.base.errors import InputError
from thermogear.base.notice import stored_notices
from thermogear.base.plan import (
    Alive,
    Arrays,
    Key,
    Variable,
    before_along,
    empty_arrays,
    keep_going,
    ranges_of,
    real,
    stretches,
)
from thermogear.base.vocabulary import NO_COUNT, moves
from thermogear.case.case import GearCase, gear_case
from thermogear.case.family import GearFamily, Tabulated
from thermogear.case.points import Points
from thermogear.case.response import RECORD, RULE, Recording, respond, response_variables
from thermogear.case.thermal_state import HOT, UNDEFORMED, StateLike, ThermalState
from thermogear.case.turn_response import over_turn, settled_response
from thermogear.dynamics.return_map import ReturnMap
from thermogear.results.result import Result
from thermogear.results.work import Report, carry_out
from thermogear.study.notices import difference_notices, finished, range_notices
from thermogear.study.series_along import band_notices, over_speeds, parts_taken

DIRECTIONS = (1, -1)
BLOCK = 32
KEEP = 16
LEAPS = 16
"""Jumps kept of one step of speed."""
STRIDE = 0.005
"""Where no orbit can be followed the run goes on in steps of this share of the speed, which stand
on a grid of their own."""
LISTED_PERIOD = 4
"""Jumps of longer orbits, which live in windows of chaos, are not listed."""
LISTED = 1e-3
"""A jump that changes the transmission error by less than this share is not listed."""
ENDS = ("end_x", "end_v", "end_speed", "end_period")
"""What is stored of the motion that is carried on to the next speed."""
LEAP_KINDS = (FOLD, FLIP)
LEAP = {
    "leap_fold": ("speed at which the followed motion leaves its branch", "rad/s"),
    "leap_to": ("speed just behind, where the new motion stands", "rad/s"),
    "leap_before": ("transmission error before, peak to peak", "m"),
    "leap_after": ("transmission error after, peak to peak", "m"),
    "leap_kind": ("0: at a fold, 1: at a subcritical period doubling", "1"),
    "leap_x": ("displacement of the new motion, in half backlashes", "1"),
    "leap_v": ("its velocity", "1"),
    "leap_period": ("periods of the new motion, 0: no orbit", "1"),
}
JUMP = {
    "state": ("thermal state of the jump", "", ""),
    "direction": ("1 up, -1 down", "", ""),
    "kind": (LEAP["leap_kind"][0], "", "leap_kind"),
    "from": ("last speed before the jump", "rad/s", "leap_fold"),
    "to": ("first speed after it", "rad/s", "leap_to"),
    "fold": (LEAP["leap_fold"][0], "rad/s", "leap_fold"),
    "return": (
        "speed at which a run back from there jumps again; NaN: not in this range, or "
        "it runs into chaos before",
        "rad/s",
        "",
    ),
    "into": (LEAP["leap_period"][0], "", "leap_period"),
    "before": (LEAP["leap_before"][0], "m", "leap_before"),
    "after": (LEAP["leap_after"][0], "m", "leap_after"),
}
"""What is stored of a jump: in words, its unit, and what of the leap it is."""


@dataclass(frozen=True, kw_only=True)
class RunUpPlan:
    """A run-up over ``speeds`` [rad/s], ``parts`` of a series behind it; see :func:`run_up`."""

    case: GearCase
    speeds: tuple[float, ...]
    states: tuple[ThermalState, ...]
    bundle: str
    torque: float
    rule: Rule = RULE
    record: Recording = RECORD
    block: int = BLOCK
    branch_period: int = 2
    parts: int = 1
    kind: str = "run-up"
    _families: dict[int, GearFamily] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    @property
    def sizes(self) -> dict[str, int]:
        return {
            "state": len(self.states),
            "direction": len(DIRECTIONS),
            "pinion_speed": len(self.speeds),
            "section": KEEP,
            "leap": LEAPS,
            "order": self.record.orders.size,
        }

    @property
    def cuts(self) -> dict[str, int]:
        return {"state": 1, "direction": 1, "pinion_speed": min(self.block, len(self.speeds))}

    def inputs(self) -> dict[str, Any]:
        return {
            "model": self.family(0).inputs(),
            "speeds": list(self.speeds),
            "temperatures": [state.stored for state in self.states],
            "torque": self.torque,
            "rule": asdict(self.rule),
            "record": asdict(self.record),
            "block": self.block,
            "branch_period": self.branch_period,
        } | ({"parts": self.parts} if self.parts > 1 else {})

    def family(self, state: int) -> GearFamily:
        """Speed -> lanes in one thermal state."""
        if state not in self._families:
            case, heat = replace(self.case, torques=(self.torque,)), self.states[state]
            self._families[state] = GearFamily(case, ("pinion_speed",), self.bundle, heat)
        return self._families[state]

    def variables(self) -> dict[str, Variable]:
        dims = ("state", "direction", "pinion_speed")

        number = partial(real, dims)
        of_axes = {
            name: variable
            for axis in "xv"
            for name, variable in (
                (f"section_{axis}", number("Poincare section in half backlashes", "1", "section")),
                (f"end_{axis}", number("state carried on", "1")),
            )
        }
        words = "periods of the orbit that is followed, 0: none"
        ends = {
            "end_speed": number("speed of the state carried on", "rad/s"),
            "end_period": Variable(dims, "int32", 0, {"long_name": words} | NO_COUNT),
        }
        leaps = {name: number(*told, "leap") for name, told in LEAP.items()}
        felt = outcome_variables(dims) | response_variables(dims)
        return felt | of_axes | ends | leaps

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        cold = self.case.stated.temperatures.reference
        shown = np.array([cold if s.temperature is None else s.temperature for s in self.states])
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
            "order": self.record.coordinate,
        }

    def needs(self, key: Key) -> Key | None:
        return before_along(self, key, "pinion_speed")

    def pilot(self, share: float, *, turn: int) -> float:
        """Follow about a ``share`` of the speeds, in fours of neighbours; what share it was."""
        whole = len(self.states) * len(DIRECTIONS) * len(self.speeds)
        some = stretches(self.speeds, count=round(share * whole), turn=turn)
        state, direction = turn % len(self.states), turn // len(self.states) % len(DIRECTIONS)
        replace(self, speeds=some, block=len(some)).compute((state, direction, 0), None, keep_going)
        return len(some) / whole

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        up = key[1] == 0
        every = np.array(self.speeds)
        mine = np.arange(every.size)[ranges_of(self, key)["pinion_speed"]]
        order = np.arange(mine.size) if up else np.arange(mine.size)[::-1]
        found = empty_arrays(self, key)
        ends = None
        if before is not None:
            ends = {name: before[name][0, 0, -1 if up else 0] for name in ENDS}
        rows = (self._of_turns if self.turn > 1 else self._of_orbits)(key, mine, order, ends, alive)
        for place, row in rows:
            for name, value in row.items():
                found[name][0, 0, place] = value
        return found

    @property
    def turn(self) -> int:
        """After how many mesh periods the gears repeat themselves."""
        return self.case.period.mesh_periods

    def _of_turns(
        self, key: Key, mine: Whole, order: Whole, ends: Arrays | None, alive: Alive
    ) -> Iterator[tuple[int, Arrays]]:
        """What is felt over the turn at each speed, carried on from the speed before."""
        speeds, carried = np.array(self.speeds)[mine], ends is not None
        points = self.family(key[0])(speeds[:, None])
        first = self.case.simulation.initial_state
        state = np.array(first if ends is None else (ends["end_x"], ends["end_v"]), dtype=float)
        for place in order:
            here = points.take(np.array([place]))
            settled, arrays = settled_response(
                here, state[None], self.rule, self.record, carried=carried, alive=alive
            )
            state, carried = settled.state[0], carried or not here.still[0]
            row = {name: values[0] for name, values in arrays.items()}
            section = np.full((2, KEEP), np.nan)
            section[:, -1] = settled.point[0]
            yield (
                int(place),
                row
                | dict(zip(("section_x", "section_v"), section, strict=True))
                | dict(zip(ENDS, (*state, self.speeds[place], row["period"]), strict=True)),
            )

    def _of_orbits(
        self, key: Key, mine: Whole, order: Whole, ends: Arrays | None, alive: Alive
    ) -> Iterator[tuple[int, Arrays]]:
        """What is felt at each speed of teeth that are alike, on orbits that are followed."""
        # the step from the speed before the block belongs to it; with another one beyond, slopes
        # there are those of any other block
        every = np.array(self.speeds)
        wide = np.arange(max(mine[0] - 2, 0), min(mine[-1] + 3, every.size))
        whole = self.family(key[0])(every[wide][:, None])
        points = whole.take(np.searchsorted(wide, mine))
        table = Tabulated(self.family(key[0]), every[wide], whole) if wide.size > 1 else None
        run = _Run(self, table, alive)
        if ends is not None:
            run.at = float(ends["end_speed"])
            run.state = np.array([ends["end_x"], ends["end_v"]])
            run.period = int(ends["end_period"])
        states = np.full((mine.size, 2), np.nan)
        for place in order:
            one = np.array([place])
            settled = run.step(points.take(one), float(every[mine[place]]))
            states[place] = np.where(np.isfinite(settled.state).all(), settled.state[0], np.nan)
            outcome = outcome_arrays(settled, points.status[one])
            row = {name: values[0] for name, values in outcome.items()} | {
                "section_x": settled.sections[0, :, 0],
                "section_v": settled.sections[0, :, 1],
            }
            row |= dict(zip(ENDS, (*run.state, run.at, run.period), strict=True))
            for name in LEAP if run.leaps else ():
                leaps = [leap[name] for leap in run.leaps[:LEAPS]]
                row[name] = np.array(leaps + [np.nan] * (LEAPS - len(leaps)))
            yield int(place), row
        for name, values in respond(points, states, self.record, lines=True, alive=alive).items():
            for place, value in enumerate(values):
                yield place, {name: value}

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        if self.branch_period > 0 and self.turn == 1:
            data = _with_folds(self, data)
        data = over_turn(data, self.case)
        data.attrs |= {
            "bundle": self.bundle,
            "pinion_torque": self.torque,
            "pinion_teeth": self.case.pair.pinion.teeth,
            "total_periods": int(data["used_periods"].sum()),
        }
        data = _with_jumps(self, data)
        told = [*range_notices(self.case, data), *difference_notices(data)]
        if self.parts > 1:
            families = [self.family(state) for state in range(len(self.states))]
            data = data.merge(over_speeds(self.case, self.parts, families, np.array(self.speeds)))
            told = [*band_notices(self.case, self.parts, data), *told]
        return data.assign_attrs(notices=stored_notices(told))


def _with_folds(plan: RunUpPlan, data: xr.Dataset) -> xr.Dataset:
    """Branches and bifurcations of every thermal state, side by side."""
    found: dict[int, xr.Dataset] = {}
    speeds = np.array(plan.speeds)
    for state in range(len(plan.states) if speeds.size > 1 else 0):
        here = data.isel(state=state).expand_dims(start=1)
        if moves(here["status"].values).any():
            family = Tabulated.of(plan.family(state), speeds)
            found[state] = with_branches(here, family, "pinion_speed", plan.branch_period)
    return with_branches_of_states(data, found, "rad/s")


def _period(settled: Settled) -> int:
    """Periods of the orbit a motion settled on; 0: no orbit."""
    return int(settled.period[0]) if int(settled.label[0]) == PERIODIC else 0


class _Run:
    """A run through the speeds: the motion it carries on, and how the last step went.

    It stands at ``at`` with ``state``. An orbit of ``period`` periods is followed slowly
    (:func:`follow`), so that the run leaves its branch at the fold and not where a step happens
    to be long enough; everything else (``period`` 0) settles anew from one speed of a fixed grid
    to the next. The speeds asked for are looked at and change nothing on the way.
    """

    def __init__(self, plan: RunUpPlan, table: Tabulated | None, alive: Alive) -> None:
        self.plan = plan
        self.table = table
        self.alive = alive
        self.at = float("nan")
        self.state = np.array(plan.case.simulation.initial_state, dtype=float)
        self.period = 0
        self.leaps: list[dict[str, float]] = []
        self.maps: dict[float, ReturnMap] = {}

    def step(self, point: Points, speed: float) -> Settled:
        """What is felt at ``speed``, coming from where the last step ended."""
        self.leaps = []
        first = not np.isfinite(self.at)
        if self.table is None or first or point.still[0]:
            self.period = 0
        else:
            self._walk(self.table, speed)
        found = self._settled(point, self.state[None])
        if first:
            self._stand(speed, found)
        return found

    def _walk(self, table: Tabulated, speed: float) -> None:
        """Carry the motion on to ``speed``; where it is none that can be followed, towards it."""
        way = 1.0 if speed > self.at else -1.0
        do = partial(follow, self._single, "pinion_speed", settle=self._settle, maps=self.maps)
        while True:
            if self.period > 0:
                followed = do(start=self.at, to=speed, state=self.state, period=self.period)
                self._keep(followed.leaps)
                self.at, self.state, self.period = followed.value, followed.state, followed.period
                if self.period > 0:
                    return
            # the next of the speeds exp(k STRIDE)
            place = way * np.log(self.at) / STRIDE
            there = float(np.exp(way * STRIDE * (np.floor(place + 1e-6) + 1.0)))
            if way * (speed - there) < 0.0:
                return
            self._stand(there, self._settled(table(np.array([[there]])), self.state[None]))

    def _stand(self, speed: float, settled: Settled) -> None:
        if bool(np.isfinite(settled.state).all()):
            self.state = settled.state[0]
        self.at = speed
        self.period = _period(settled)

    def _single(self, speed: float) -> Points:
        assert self.table is not None
        return self.table(np.array([[speed]]))

    def _settled(self, point: Points, states: Floats) -> Settled:
        return settle_with_status(
            point.flat, point.status, states, self.plan.rule, KEEP, self.alive
        )

    def _settle(self, speed: float, state: Floats) -> tuple[Floats, int]:
        settled = self._settled(self._single(speed), state[None])
        return settled.state[0], _period(settled)

    def returned(self, leap: Mapping[str, float], end: float) -> float:
        """Where a run from behind a jump back towards ``end`` first jumps; NaN: nowhere."""
        period = int(leap["leap_period"])
        if period == 0 or leap["leap_to"] == end:
            return float("nan")
        followed = follow(
            self._single,
            "pinion_speed",
            start=leap["leap_to"],
            to=end,
            state=np.array([leap["leap_x"], leap["leap_v"]]),
            period=period,
            settle=self._settle,
            most_leaps=1,
        )
        return followed.leaps[0].value if followed.leaps else float("nan")

    def _keep(self, leaps: Sequence[Leap]) -> None:
        for leap in leaps:
            if leap.period > LISTED_PERIOD:
                continue
            sizes = [self._size(leap.value, leap.state), self._size(leap.landed, leap.found)]
            if abs(sizes[1] - sizes[0]) < LISTED * min(sizes):
                continue
            new = (*leap.found, leap.found_period)
            row = (leap.value, leap.landed, *sizes, LEAP_KINDS.index(leap.kind), *new)
            self.leaps.append(dict(zip(LEAP, map(float, row), strict=True)))

    def _size(self, speed: float, state: Floats) -> float:
        """Peak to peak transmission error of the motion at ``state``."""
        record = replace(self.plan.record, periods=LISTED_PERIOD * 4)
        found = respond(self._single(speed), state[None], record, lines=False)
        return float(found["dte_peak_to_peak"][0])


def _with_jumps(plan: RunUpPlan, data: xr.Dataset) -> xr.Dataset:
    """Where the followed motion left its branch, on the way up or down, and where it returns."""
    rows: list[dict[str, float]] = []
    speeds = np.array(plan.speeds)
    for state in range(data.sizes["state"]):
        back: _Run | None = None
        for direction, sign in enumerate(DIRECTIONS):
            here = data.isel(state=state, direction=direction)
            for place, number in np.argwhere(np.isfinite(here["leap_fold"].values))[::sign]:
                leap = {name: float(here[name].values[place, number]) for name in LEAP}
                if back is None:
                    back = _Run(plan, Tabulated.of(plan.family(state), speeds), keep_going)
                again = back.returned(leap, float(speeds[0 if sign > 0 else -1]))
                own = {"state": state, "direction": sign, "return": again}
                rows.append(own | {n: leap[of] for n, (_, _, of) in JUMP.items() if of})
    for name, (words, unit, _) in JUMP.items():
        values = np.array([row[name] for row in rows], float if unit else np.int32)
        attributes = {"long_name": words} | ({"units": unit} if unit else {})
        data[f"jump_{name}"] = (("jump",), values, attributes)
    return data


def run_up_plan(
    case: GearCase,
    speeds: ArrayLike,
    *,
    temperatures: Sequence[StateLike] | None = None,
    bundle: str = "",
    torque: float | None = None,
    rule: Rule = RULE,
    branch_period: int = 2,
    block: int = BLOCK,
    parts: int | None = None,
) -> RunUpPlan:
    """The plan of :func:`run_up`; ``block`` speeds are computed, and given out, together."""
    whole = gear_case(case)
    case = whole.over_speeds()
    axis = np.sort(axis_values("speeds", speeds))
    given = (UNDEFORMED, HOT) if temperatures is None else map(ThermalState.of, temperatures)
    states = tuple(_held(case, state) for state in given)
    if not states:
        raise InputError("temperatures", "none", allowed="at least one state")
    load = float(case.torques[0] if torque is None else torque)
    family = GearFamily(case, ("pinion_speed",), bundle)
    hot = [state.temperature for state in states if state.temperature is not None]
    family.require({"pinion_speed": axis, "pinion_torque": load, "gear_temperature": hot})
    return RunUpPlan(
        case=case,
        speeds=tuple(axis.tolist()),
        states=states,
        bundle=family.bundle,
        torque=load,
        rule=rule,
        record=RECORD.in_orders_of(case.period.mesh_periods),
        branch_period=branch_period,
        block=block,
        parts=parts_taken(whole, family, parts, usual=whole.series),
    )


def _held(case: GearCase, state: ThermalState) -> ThermalState:
    """The state all through a run: as hot as the case is at its first operating point.

    InputError where its heat did not settle.
    """
    if state == UNDEFORMED or state.temperature is not None:
        return state
    state.require_settled(case, case.models[0])
    hot = state.operating(case, case.models[0]).temperatures.pinion_addendum
    return ThermalState.of(float(np.ravel(np.asarray(hot, dtype=float))[0]))


def run_up(
    case: GearCase,
    speeds: ArrayLike,
    *,
    temperatures: Sequence[StateLike] | None = None,
    bundle: str = "",
    torque: float | None = None,
    rule: Rule = RULE,
    branch_period: int = 2,
    parts: int | None = None,
    store: str | Path | None = None,
    threads: int | None = None,
    report: Report | None = None,
    alive: Alive = keep_going,
) -> Result:
    """Run the gears up and down over ``speeds`` [rad/s], undeformed and hot.

    ``temperatures`` [K] of both addenda, None or "undeformed" for undeformed gears (default: these,
    and "hot", as the case is at its first operating point); bores, housing and oil go along by the
    case's rule. Each speed starts from the motion at the speed before. Over (state, direction,
    pinion_speed): dynamic transmission error (mean, rms, peak to peak), dynamic mesh force, dynamic
    factor, contact loss, label and multipliers; ``dte_line`` over order as well, the waterfall.
    Between two speeds the orbit is followed slowly, and what is no orbit of up to 16 periods is
    carried on in steps of 0.5 % of the speed that stand still, so that jumps do not depend on the
    step of ``speeds``. ``jump_...``: where the motion leaves its branch (``fold``, of orbits of up
    to 4 periods), and where a run back jumps (``return``);
    ``bifurcation_...`` and ``branch_...``: the folds behind it, from continuation of the orbits of
    up to ``branch_period`` mesh periods (0: none).
    Of a case whose period is a turn of many mesh periods the motion is followed in fixed steps from
    each of the ``speeds`` to the next, its lines at all orders of the turn; no orbit is located.
    A case in series has a band of its first ``parts`` behind that motion (default: as many as it
    states; 1: none), as hot as its first speed is: ``series_dynamic_factor`` (state, quantile,
    damping, pinion_speed), ``series_parting_share``
    (:func:`~thermogear.study.series_along.over_speeds`).
    """
    plan = run_up_plan(
        case,
        speeds,
        temperatures=temperatures,
        bundle=bundle,
        torque=torque,
        rule=rule,
        branch_period=branch_period,
        parts=parts,
    )
    how: dict[str, Any] = {"threads": threads, "report": report}
    return finished(carry_out(plan, store, **how, alive=alive, title=case.title), case.title)
