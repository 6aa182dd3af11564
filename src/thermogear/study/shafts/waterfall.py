"""Run-up and run-down of a drive train: forces and sound over speed and order.

The speed rises, or falls, steadily from one speed of the list to the next while the train vibrates
with clearance: d(phase)/dt = n(t). Samples are uniform in the phase, so that orders stay lines.
"""

from __future__ import annotations

import json
import math
import os
import threading
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.analysis.family import axis_values
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.bounds import floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.notice import Notice, stored_notices
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
    spread,
)
from thermogear.base.vocabulary import STATUS, moves
from thermogear.case.case import GearCase
from thermogear.case.one_point import counted
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.dynamics.geared_map import GearedMap
from thermogear.dynamics.ladder import Engine, Steps
from thermogear.results.result import Result
from thermogear.results.work import Report, carry_out
from thermogear.study.declared import fault_notices
from thermogear.study.notices import finished
from thermogear.study.shafts.campbell import critical_speeds
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.record import HARMONICS, SAMPLES, lines, shown
from thermogear.study.shafts.state import plan_of, settled

KIND = "waterfall"
DIRECTIONS = (1, -1)
BLOCK = 8
WINDOW = 64
"""Mesh periods that the lines of one speed are taken from."""
SETTLING = 768
"""Mesh periods at the first speed before the run begins."""
FURTHEST = 0.05
"""Share of the speed over which one set of tables, and the gyroscopic matrix, is kept."""
APART = 1.2
"""Factor between the vibration up and down that is told."""
HELD = 4000
"""Mesh periods at a steady speed after which two motions are two."""
LOOK = 200
"""Mesh periods after which they are looked at in between."""
MET = 1e-6
"""Half backlashes between two states that are one motion."""
TWO = 1.02
"""Factor between their vibrations then, from which they are."""
APART_TOLD = {
    "state": ("state of heat", ""),
    "from": ("first speed of the stretch", "rad/s"),
    "to": ("last speed of the stretch", "rad/s"),
    "at": ("speed at which up and down differ most", "rad/s"),
    "part": ("what differs most: 0 the mesh force, 1, 2, ... a bearing", ""),
    "up": ("its vibration running up, rms", "N"),
    "down": ("and running down", "N"),
    "held": ("1: two motions at a steady speed too, 0: the difference is the rate's", ""),
}
DURATION = 20.0


@dataclass(frozen=True, kw_only=True)
class WaterfallPlan:
    """A run over ``speeds`` [rad/s] at one operating point; see :func:`waterfall`.

    ``place`` of the operating point, ``duration`` [s] of one way, ``size`` of the reduced train, 0:
    the interface and 16 modes; ``threads`` of what comes last (all cores if left out).
    """

    case: GearCase
    speeds: tuple[float, ...]
    states: tuple[ThermalState, ...]
    place: int
    duration: float
    size: int = 0
    block: int = BLOCK
    threads: int | None = field(default=None, compare=False)
    kind: str = KIND
    _trains: dict[int, MovingTrain | None] = field(repr=False, compare=False, default_factory=dict)

    @property
    def orders(self) -> Floats:
        """Orders of the mesh frequency whose lines are kept: halves, and those of the shafts."""
        pair = self.case.pair
        turns = {k / z for z in (pair.pinion.teeth, pair.wheel.teeth) for k in (1, 2)}
        halves = set((np.arange(1, 2 * HARMONICS + 1) / 2.0).tolist())
        return np.array(sorted(halves | turns))

    @property
    def sizes(self) -> dict[str, int]:
        count, first = len(plan_of(self.case).bearings), self._first
        return {
            "state": len(self.states),
            "direction": len(DIRECTIONS),
            "pinion_speed": len(self.speeds),
            "bearing": count,
            "order": self.orders.size,
            "coordinate": 1 if first is None else first.model.dimension,
        }

    @property
    def _first(self) -> MovingTrain | None:
        """The train in the first state of heat in which it moves."""
        return next(filter(None, map(self.train, range(len(self.states)))), None)

    @property
    def cuts(self) -> dict[str, int]:
        return {"state": 1, "direction": 1, "pinion_speed": min(self.block, len(self.speeds))}

    def inputs(self) -> dict[str, Any]:
        return {
            "case": self.case.text,
            "overrides": [list(pair) for pair in self.case.overrides],
            "speeds": list(self.speeds),
            "states": [state.stored for state in self.states],
            "place": self.place,
            "duration": self.duration,
            "size": self.size,
            "block": self.block,
            "steps": asdict(_how()),
        }

    def train(self, state: int) -> MovingTrain | None:
        """The train in one state of heat, at the operating point; None where nothing moves."""
        with _MAKING:
            if state not in self._trains:
                ((one,),) = settled(self.case, [self.place], states=[self.states[state]])
                self._trains[state] = (
                    moving(
                        self.case,
                        one,
                        coordinates=self.size or None,
                        friction=rubbing(self.case, one),
                    )
                    if moves(one.status)
                    else None
                )
            return self._trains[state]

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_trains": {}}

    def variables(self) -> dict[str, Variable]:
        dims = ("state", "direction", "pinion_speed")

        number = partial(real, dims)
        flags = {"long_name": "whether it moved", "flag_meanings": " ".join(STATUS)}
        return {
            "status": Variable(dims, "int8", STATUS.index("not_converged"), flags),
            "mesh_force_rms": number("vibration of the drive flanks' force, rms", "N"),
            "mesh_force_max": number("greatest force of the drive flanks", "N"),
            "back_force_max": number("greatest force of the back flanks", "N"),
            "contact_loss_share": number("share of time out of drive contact", "1"),
            "deflection_peak_to_peak": number("approach of the drive flanks, peak to peak", "m"),
            "bearing_force_max": number("greatest force on the bearing", "N", "bearing"),
            "bearing_force_rms": number("vibration of the bearing's force, rms", "N", "bearing"),
            "housing_rms": number("acceleration of the housing, rms of x and y", "m/s^2"),
            "mesh_force_line": number("line of the drive flanks' force (peak)", "N", "order"),
            "bearing_force_line": number(
                "line of the bearing force, larger of x and y (peak)", "N", "bearing", "order"
            ),
            "housing_line": number(
                "line of the housing's acceleration, larger of x and y (peak)", "m/s^2", "order"
            ),
            "end_state": number("state carried on", "1", "coordinate"),
            "end_turn": number("mesh periods since the run began", "1"),
        }

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        speed = {"units": "rad/s", "long_name": "pinion speed"}
        order = {"units": "1", "long_name": "order of the mesh frequency"}
        way = {"long_name": "direction of the run: 1 up, -1 down"}
        names = json.dumps(plan_of(self.case).bearing_names)
        bearings = np.arange(1, self.sizes["bearing"] + 1)
        return {
            "bearing": (("bearing",), bearings, {"long_name": "bearing", "names": names}),
            "direction": (("direction",), np.array(DIRECTIONS, np.int8), way),
            "pinion_speed": (("pinion_speed",), np.array(self.speeds), speed),
            "order": (("order",), self.orders, order),
        }

    def needs(self, key: Key) -> Key | None:
        return before_along(self, key, "pinion_speed")

    def pilot(self, share: float, *, turn: int) -> float:
        """Settle at some of the speeds; what share of the mesh periods of all runs it was.

        What ``finish`` tries is not in it.
        """
        each, teeth = SETTLING + WINDOW, self.case.pair.pinion.teeth
        passed = self.duration * teeth * float(np.mean(self.speeds)) / math.tau
        ways = len(self.states) * len(DIRECTIONS)
        whole = ways * (each + max(passed, WINDOW * len(self.speeds)))
        some = spread(len(self.speeds), some=round(share * whole / each), turn=turn)
        for place in some:
            one = replace(self, speeds=(self.speeds[place],), block=1)
            one.compute((turn % len(self.states), 0, 0), None, keep_going)
        return some.size * each / whole

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        up = key[1] == 0
        every = np.array(self.speeds)
        mine = np.arange(every.size)[ranges_of(self, key)["pinion_speed"]]
        found = empty_arrays(self, key)
        train = self.train(key[0])
        if train is None:
            ((rest,),) = settled(self.case, [self.place], states=[self.states[key[0]]])
            found["status"][...] = rest.status
            return found
        order = np.arange(mine.size) if up else np.arange(mine.size)[::-1]
        state, turn, at = train.start, 0.0, float("nan")
        if before is not None:
            last = 0, 0, -1 if up else 0
            state, turn = before["end_state"][last], float(before["end_turn"][last])
            at = float(every[mine[0] - 1] if up else every[mine[-1] + 1])
        for place in order.tolist():
            alive()
            try:
                state, turn = self._step(
                    train, state, turn, at, float(every[mine[place]]), found, place
                )
            except ConvergenceError:
                found["status"][0, 0, place] = STATUS.index("diverged")
                break
            at = float(every[mine[place]])
        return found

    def _step(
        self,
        train: MovingTrain,
        state: Floats,
        turn: float,
        at: float,
        speed: float,
        found: Arrays,
        place: int,
    ) -> tuple[Floats, float]:
        """From the speed ``at`` to ``speed``; what is felt at its end goes to ``found``."""
        if not np.all(np.isfinite(state)):
            raise ConvergenceError("the run ended before")
        here = train.at_speed(self.case, speed)
        if np.isnan(at):
            engine = Engine(here.model, _how())
            state = engine.run(state, SETTLING, turn=turn).state
            turn += SETTLING
            run = engine.run(state, WINDOW, samples=SAMPLES, turn=turn)
            passed = WINDOW
        else:
            pieces = max(1, int(np.ceil(abs(np.log(speed / at)) / FURTHEST)))
            edges = np.linspace(at, speed, pieces + 1)
            seconds = self.duration / max(len(self.speeds) - 1, 1) / pieces
            for number, (a, b) in enumerate(pairwise(edges.tolist())):
                there = train.at_speed(self.case, 0.5 * (a + b))
                f = np.array([a, b]) / (2.0 * np.pi) * self.case.pair.pinion.teeth
                last = number == pieces - 1
                passed = max(round(float(f.mean()) * seconds), WINDOW if last else 1)
                ramp = (f[1] ** 2 - f[0] ** 2) / (2.0 * passed)
                kept = WINDOW if last else 0
                first = passed - kept
                model = replace(there.model, mesh_frequency=float(f[0]))
                if first:
                    run = Engine(model, _how(), ramp=ramp).run(state, first, turn=turn)
                    state, turn = run.state, turn + first
                if kept:
                    middle = float(np.sqrt(f[0] ** 2 + 2.0 * ramp * first))
                    model = replace(here.model, mesh_frequency=middle)
                    engine = Engine(model, _how(), ramp=ramp)
                    run = engine.run(state, kept, samples=SAMPLES, turn=turn)
                    passed = kept
            here = replace(here, model=model)
        seen = shown(here, run, turn)
        spread = seen.bearing_force - seen.bearing_force.mean(axis=0)
        felt = np.linalg.norm(seen.bearing_force, axis=2)
        orders = self.orders
        values: dict[str, Any] = {
            "status": train.state.status,
            "mesh_force_rms": seen.mesh_force.std(),
            "mesh_force_max": seen.mesh_force.max(),
            "back_force_max": seen.back_force.max(),
            "contact_loss_share": 1.0 - run.shares[2],
            "deflection_peak_to_peak": np.ptp(seen.deflection),
            "bearing_force_max": felt.max(axis=0),
            "bearing_force_rms": np.sqrt((spread**2).sum(axis=2).mean(axis=0)),
            "housing_rms": np.sqrt((seen.housing**2).sum(axis=1).mean()),
            "mesh_force_line": lines(seen.mesh_force, orders=orders),
            "bearing_force_line": lines(seen.bearing_force, orders=orders).max(axis=2).T,
            "housing_line": lines(seen.housing, orders=orders).max(axis=1),
            "end_state": run.state,
            "end_turn": turn + passed,
        }
        for name, value in values.items():
            found[name][0, 0, place] = value
        return run.state, turn + passed

    def _stretches(self, data: Dataset, state: int) -> list[dict[str, float]]:
        """Stretches of speed on which up and down differ, and where they do most."""
        rms = np.concatenate(
            [data["mesh_force_rms"].values[state][..., None], data["bearing_force_rms"][state]], -1
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            ratio = np.nan_to_num(np.abs(np.log(rms[0] / rms[1])))
        wide = ratio.max(axis=1) > np.log(APART)
        edges = np.flatnonzero(np.diff(np.r_[False, wide, False].astype(int)))
        rows: list[dict[str, float]] = []
        for first, after in edges.reshape(-1, 2).tolist():
            place = first + int(ratio[first:after].max(axis=1).argmax())
            which = int(ratio[place].argmax())
            rows.append(
                {
                    "state": state,
                    "from": self.speeds[first],
                    "to": self.speeds[after - 1],
                    "at": self.speeds[place],
                    "part": which,
                    "up": float(rms[0, place, which]),
                    "down": float(rms[1, place, which]),
                }
            )
        return rows

    def _held(self, row: dict[str, float], states: Floats) -> int:
        """1 where the two ``states`` (2, d) of a stretch stay apart at a steady speed."""
        train = self.train(int(row["state"]))
        there = None if train is None else train.at_speed(self.case, row["at"])
        return int(there is not None and _held_apart(there, states, int(row["part"])))

    def _critical(self, state: int) -> list[dict[str, Any]]:
        """Critical speeds in one state of heat; none where nothing moves."""
        one = self.train(state)
        found = () if one is None else critical_speeds(self.case, one.state, max(self.speeds))
        return [asdict(speed) for speed in found]

    def finish(self, data: Dataset) -> Dataset:
        """The stretches, held at a steady speed side by side, and the critical speeds."""
        kinds = range(len(self.states))
        rows = [row for state in kinds for row in self._stretches(data, state)]
        ends = data["end_state"].values
        pool = ThreadPoolExecutor(max(1, self.threads or os.cpu_count() or 1))
        try:
            asked = [pool.submit(self._critical, state) for state in kinds]
            places = [(int(r["state"]), self.speeds.index(r["at"])) for r in rows]
            tried = [
                pool.submit(self._held, row, ends[state, :, place])
                for row, (state, place) in zip(rows, places, strict=True)
            ]
            critical = [one.result() for one in asked]
            for row, one in zip(rows, tried, strict=True):
                row["held"] = one.result()
        finally:
            pool.shutdown(cancel_futures=True)
        data = data.drop_vars(["end_state", "end_turn"])
        for name, (words, unit) in APART_TOLD.items():
            attributes = {"long_name": words} | ({"units": unit} if unit else {})
            values = np.array([row[name] for row in rows], float if unit else np.int32)
            data[f"apart_{name}"] = (("stretch",), values, attributes)
        first = self._first
        size = 0 if first is None else first.model.size
        error = (
            float(np.abs(first.reduction.frequency_errors(first.state.linear)).max())
            if first is not None
            else float("nan")
        )
        of_series = [Notice.of("train_of_one_pair", parts=self.case.series)]
        notices = [
            *fault_notices(self.case),
            *of_series * (self.case.series > 1),
            Notice.of("one_point_all_through", duration=self.duration),
            Notice.of("train_reduced", coordinates=size, error=error),
            Notice.of(
                "ways_differ", stretches=len(rows), held=sum(int(row["held"]) for row in rows)
            )
            if rows
            else Notice.of("ways_agree", speeds=[[min(self.speeds), max(self.speeds)]]),
        ]
        return data.assign_attrs(
            state_names=json.dumps([one.kind for one in self.states]),
            bearing_names=json.dumps(list(plan_of(self.case).bearing_names)),
            critical=json.dumps(critical),
            torque=float("nan") if first is None else first.state.torque,
            duration=self.duration,
            train_coordinates=size,
            notices=stored_notices(notices),
        )


_MAKING = threading.RLock()


def _held_apart(train: MovingTrain, both: Floats, part: int) -> bool:
    """Whether two states (2, d) still vibrate apart after a while at a steady speed.

    ``part`` 0: by the mesh force, 1, 2, ...: by that bearing's.
    """
    motion = GearedMap(model=train.model, how=_how())
    engine, states, turn = motion.engine, list(both), 0.0
    while turn < HELD:
        states = [engine.run(state, LOOK, turn=turn).state for state in states]
        turn += LOOK
        if motion.distance(states[0], states[1]) < MET:
            return False
    seen = []
    for state in states:
        run = engine.run(state, WINDOW, samples=SAMPLES, turn=turn)
        felt = shown(train, run, turn)
        values = felt.mesh_force[:, None] if part == 0 else felt.bearing_force[:, part - 1]
        seen.append(float(np.sqrt(((values - values.mean(axis=0)) ** 2).sum(axis=1).mean())))
    return bool(abs(np.log(seen[0] / seen[1])) > np.log(TWO))


def _how() -> Steps:
    """Errors of 1e-7 half backlashes a step: far below what a line of the picture shows."""
    return Steps(accuracy=1e-7)


def waterfall_plan(
    case: GearCase,
    speeds: ArrayLike,
    *,
    states: Sequence[ThermalState] = (UNDEFORMED, HOT),
    operating: int | None = None,
    duration: float = DURATION,
    coordinates: int | None = None,
    block: int = BLOCK,
    threads: int | None = None,
) -> WaterfallPlan:
    """The plan of :func:`waterfall`; ``block`` speeds are computed, and given out, together."""
    plan_of(case)
    case = case.mean_tooth()
    axis = np.sort(axis_values("speeds", speeds))
    if axis[0] <= 0.0:
        raise InputError("speeds", f"{axis[0] * 30.0 / np.pi:.6g} rpm", allowed="> 0 rpm")
    if not 0.0 < floats("duration", duration, "s") <= 3600.0:
        raise InputError("duration", f"{duration:.6g} s", allowed="0..3600 s")
    at = case.stated
    place = (
        counted("operating", operating, most=at.speed.size)
        if operating is not None
        else int(np.argmax(at.speed * at.torque))
    )
    return WaterfallPlan(
        case=case, speeds=tuple(axis.tolist()), states=tuple(states), place=place,
        duration=float(duration), size=coordinates or 0, block=block, threads=threads,
    )  # fmt: skip


def waterfall(
    case: GearCase,
    speeds: ArrayLike,
    *,
    states: Sequence[ThermalState] = (UNDEFORMED, HOT),
    operating: int | None = None,
    duration: float = DURATION,
    coordinates: int | None = None,
    store: str | Path | None = None,
    threads: int | None = None,
    report: Report | None = None,
    alive: Alive = keep_going,
) -> Result:
    """Run a case's drive train up and down over ``speeds`` [rad/s], undeformed and hot.

    Each way takes ``duration`` [s] at a rate of speed that is even between neighbours; heat, mesh
    and clearances are those of one ``operating`` point (from 1, the hardest if left out). Over
    (state, direction, pinion_speed): vibration of mesh and bearing forces, acceleration of the
    housing, and their lines over order; ``apart_...``: stretches on which up and down differ, and
    whether two motions exist there at a steady speed, between which a run jumps. Of gears whose
    teeth differ the mean tooth. Raises InputError for a case without shafts.
    """
    plan = waterfall_plan(
        case, speeds, states=states, operating=operating, duration=duration,
        coordinates=coordinates, threads=threads,
    )  # fmt: skip
    how: dict[str, Any] = {"threads": threads, "report": report}
    return finished(carry_out(plan, store, **how, alive=alive, title=case.title), case.title)
