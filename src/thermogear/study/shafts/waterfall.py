"""Run-up and run-down of a drive train: forces and sound over speed and order.

The speed rises, or falls, steadily from one speed of the list to the next while the train vibrates
with clearance: d(phase)/dt = n(t). Samples are uniform in the phase, so that orders stay lines.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.family import axis_values
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.plan import Alive, Arrays, Key, Variable, keep_going, ranges_of
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.dynamics.ladder import Engine
from thermogear.results.result import Result
from thermogear.results.work import Report, carry_out
from thermogear.study.notices import finished
from thermogear.study.shafts.campbell import critical_speeds
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.record import HARMONICS, SAMPLES, lines, shown
from thermogear.study.shafts.state import plan_of, settled

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]
KIND = "waterfall"
DIRECTIONS = (1, -1)
BLOCK = 8
WINDOW = 64
"""Mesh periods that the lines of one speed are taken from."""
SETTLING = 768
"""Mesh periods at the first speed before the run begins."""
FURTHEST = 0.05
"""Share of the speed over which one set of tables, and the gyroscopic matrix, is kept."""
JUMP = 1.5
"""Factor of the mesh force's rms from one speed to the next that may be a jump."""
APART = 1.2
"""Factor between up and down that shows two motions."""
DURATION = 20.0


@dataclass(frozen=True, kw_only=True)
class WaterfallPlan:
    """A run over ``speeds`` [rad/s] at one operating point; see :func:`waterfall`.

    ``place`` of the operating point, ``duration`` [s] of one way, ``size`` of the
    reduced train, 0: the interface and 16 modes.
    """

    case: GearCase
    speeds: tuple[float, ...]
    states: tuple[ThermalState, ...]
    place: int
    duration: float
    size: int = 0
    block: int = BLOCK
    kind: str = KIND
    _trains: dict[int, MovingTrain | None] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    @property
    def orders(self) -> Floats:
        """Orders of the mesh frequency whose lines are kept: halves, and those of the shafts."""
        pair = self.case.pair
        turns = {k / z for z in (pair.pinion.teeth, pair.wheel.teeth) for k in (1, 2)}
        halves = set((np.arange(1, 2 * HARMONICS + 1) / 2.0).tolist())
        return np.array(sorted(halves | turns))

    @property
    def sizes(self) -> dict[str, int]:
        count = len(plan_of(self.case).bearings)
        return {
            "state": len(self.states),
            "direction": len(DIRECTIONS),
            "pinion_speed": len(self.speeds),
            "bearing": count,
            "order": self.orders.size,
            "coordinate": self._dimension,
        }

    @property
    def _dimension(self) -> int:
        first = next((t for t in map(self.train, range(len(self.states))) if t is not None), None)
        return 1 if first is None else first.model.dimension

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
        """The train in one state of heat, at the operating point; None where it is jammed."""
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
                    if one.status == 0
                    else None
                )
            return self._trains[state]

    def __getstate__(self) -> dict[str, Any]:
        return self.__dict__ | {"_trains": {}}

    def variables(self) -> dict[str, Variable]:
        dims = ("state", "direction", "pinion_speed")

        def real(words: str, units: str, *inner: str) -> Variable:
            attributes = {"long_name": words, "units": units}
            return Variable((*dims, *inner), "float64", float("nan"), attributes)

        flags = {"long_name": "0: moved, else as the flags of status say"}
        return {
            "status": Variable(dims, "int8", STATUS.index("not_converged"), flags),
            "mesh_force_rms": real("vibration of the drive flanks' force, rms", "N"),
            "mesh_force_max": real("greatest force of the drive flanks", "N"),
            "back_force_max": real("greatest force of the back flanks", "N"),
            "contact_loss_share": real("share of time out of drive contact", "1"),
            "deflection_peak_to_peak": real("approach of the drive flanks, peak to peak", "m"),
            "bearing_force_max": real("greatest force on the bearing", "N", "bearing"),
            "bearing_force_rms": real("vibration of the bearing's force, rms", "N", "bearing"),
            "housing_rms": real("acceleration of the housing, rms of x and y", "m/s^2"),
            "mesh_force_line": real("line of the drive flanks' force (peak)", "N", "order"),
            "bearing_force_line": real(
                "line of the bearing force, larger of x and y (peak)", "N", "bearing", "order"
            ),
            "housing_line": real(
                "line of the housing's acceleration, larger of x and y (peak)", "m/s^2", "order"
            ),
            "end_state": real("state carried on", "1", "coordinate"),
            "end_turn": real("mesh periods since the run began", "1"),
        }

    def coordinates(self) -> dict[str, tuple[tuple[str, ...], ArrayLike, dict[str, Any]]]:
        speed = {"units": "rad/s", "long_name": "pinion speed"}
        order = {"units": "1", "long_name": "order of the mesh frequency"}
        way = {"long_name": "direction of the run: 1 up, -1 down"}
        return {
            "direction": (("direction",), np.array(DIRECTIONS, np.int8), way),
            "pinion_speed": (("pinion_speed",), np.array(self.speeds), speed),
            "order": (("order",), self.orders, order),
        }

    def needs(self, key: Key) -> Key | None:
        state, direction, block = key
        blocks = -(-len(self.speeds) // self.cuts["pinion_speed"])
        before = block - 1 if direction == 0 else block + 1
        return (state, direction, before) if 0 <= before < blocks else None

    def pilot(self, points: int) -> int:
        """Run over the first few speeds, to tell how long all take; how many."""
        count = min(points, len(self.speeds), 4)
        replace(self, speeds=self.speeds[:count], block=count).compute((0, 0, 0), None, keep_going)
        return count

    def compute(self, key: Key, before: Arrays | None, alive: Alive) -> Arrays:
        up = key[1] == 0
        every = np.array(self.speeds)
        mine = np.arange(every.size)[ranges_of(self, key)["pinion_speed"]]
        found: Arrays = {}
        for name, variable in self.variables().items():
            inner = [self.sizes[d] for d in variable.dims[3:]]
            shape = (1, 1, mine.size, *inner)
            found[name] = np.full(shape, variable.fill, np.dtype(variable.dtype))
        train = self.train(key[0])
        if train is None:
            found["status"][...] = STATUS.index("jammed")
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
            "status": 0,
            "mesh_force_rms": seen.mesh_force.std(),
            "mesh_force_max": seen.mesh_force.max(),
            "back_force_max": seen.back_force.max(),
            "contact_loss_share": 1.0 - run.shares[2],
            "deflection_peak_to_peak": np.ptp(seen.deflection),
            "bearing_force_max": felt.max(axis=0),
            "bearing_force_rms": np.sqrt((spread**2).sum(axis=2).mean(axis=0)),
            "housing_rms": np.sqrt((seen.housing**2).sum(axis=1).mean()),
            "mesh_force_line": lines(seen.mesh_force, orders),
            "bearing_force_line": lines(seen.bearing_force, orders).max(axis=2).T,
            "housing_line": lines(seen.housing, orders).max(axis=1),
            "end_state": run.state,
            "end_turn": turn + passed,
        }
        for name, value in values.items():
            found[name][0, 0, place] = value
        return run.state, turn + passed

    def finish(self, data: xr.Dataset) -> xr.Dataset:
        data = data.drop_vars(["end_state", "end_turn"])
        rows = _jumps(data)
        words = {
            "state": "state of the jump",
            "direction": "1 up, -1 down",
            "from": "last speed before the jump",
            "to": "first speed after it",
            "before": "vibration of the drive flanks' force before, rms",
            "after": "and after",
        }
        units = {"from": "rad/s", "to": "rad/s", "before": "N", "after": "N"}
        for name, told in words.items():
            attributes = {"long_name": told} | ({"units": units[name]} if name in units else {})
            column = [row[name] for row in rows]
            values = np.array(column, float if name in units else np.int32)
            data[f"jump_{name}"] = (("jump",), values, attributes)
        trains = [self.train(state) for state in range(len(self.states))]
        critical = [
            []
            if one is None
            else [asdict(c) for c in critical_speeds(self.case, one.state, max(self.speeds))]
            for one in trains
        ]
        first = next((one for one in trains if one is not None), None)
        size = 0 if first is None else first.model.size
        error = float("nan")
        if first is not None:
            error = float(np.abs(first.reduction.frequency_errors(first.state.linear)).max())
        low, high = (30.0 / np.pi * v for v in (min(self.speeds), max(self.speeds)))
        told_all = [
            f"each way takes {self.duration:.4g} s; the train has the heat, mesh and clearances of "
            "one operating point all through",
            f"{size} coordinates; the 12 lowest natural frequencies are off by at most "
            f"{100.0 * error:.2g} %",
        ]
        if not rows:
            told_all.append(f"no jump between {low:.6g} and {high:.6g} rpm, up or down")
        return data.assign_attrs(
            state_names=json.dumps([one.kind for one in self.states]),
            bearing_names=json.dumps(list(plan_of(self.case).bearing_names)),
            critical=json.dumps(critical),
            torque=float("nan") if first is None else first.state.torque,
            duration=self.duration,
            train_coordinates=size,
            notices=json.dumps(told_all),
        )


_MAKING = threading.RLock()


def _how() -> Any:
    from thermogear.dynamics.ladder import Steps

    return Steps(accuracy=1e-7)


def _jumps(data: xr.Dataset) -> list[dict[str, float]]:
    """Steps of speed over which the vibration jumps, where up and down are two motions.

    Only there: a resonance that both ways pass alike is no jump, however steep.
    """
    rms, speeds = data["mesh_force_rms"].values, data["pinion_speed"].values
    rows: list[dict[str, float]] = []
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.abs(np.log(rms[:, 0] / rms[:, 1])) > np.log(APART)
        leaps = np.abs(np.diff(np.log(rms), axis=2)) > np.log(JUMP)
    for s, d, i in np.argwhere(leaps):
        if apart[s, i] or apart[s, i + 1]:
            a, b = (i, i + 1) if d == 0 else (i + 1, i)
            rows.append(
                {
                    "state": int(s),
                    "direction": DIRECTIONS[d],
                    "from": float(speeds[a]),
                    "to": float(speeds[b]),
                    "before": float(rms[s, d, a]),
                    "after": float(rms[s, d, b]),
                }
            )
    return rows


def waterfall_plan(
    case: GearCase,
    speeds: ArrayLike,
    *,
    states: Sequence[ThermalState] = (UNDEFORMED, HOT),
    operating: int | None = None,
    duration: float = DURATION,
    coordinates: int | None = None,
    block: int = BLOCK,
) -> WaterfallPlan:
    """The plan of :func:`waterfall`; ``block`` speeds are computed, and given out, together."""
    plan_of(case)
    axis = np.sort(axis_values("speeds", speeds))
    if axis[0] <= 0.0:
        raise InputError("speeds", f"{axis[0] * 30.0 / np.pi:.6g} rpm", allowed="> 0 rpm")
    if not (np.isfinite(duration) and 0.0 < duration <= 3600.0):
        raise InputError("duration", f"{duration:.6g} s", allowed="0..3600 s")
    at = case.stated
    most = at.speed.size
    place = int(np.argmax(at.speed * at.torque))
    if operating is not None:
        if not 1 <= operating <= most:
            raise InputError("operating", operating, allowed=f"1..{most}")
        place = operating - 1
    return WaterfallPlan(
        case=case,
        speeds=tuple(axis.tolist()),
        states=tuple(states),
        place=place,
        duration=float(duration),
        size=coordinates or 0,
        block=block,
    )


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
    scheduler: str | None = None,
    report: Report | None = None,
    alive: Alive = keep_going,
) -> Result:
    """Run a case's drive train up and down over ``speeds`` [rad/s], undeformed and hot.

    Each way takes ``duration`` [s] at a rate of speed that is even between neighbours; heat, mesh
    and clearances are those of one ``operating`` point (from 1, the hardest if left out). Over
    (state, direction, pinion_speed): vibration of mesh and bearing forces, acceleration of the
    housing, and their lines over order; ``jump_...``: where the vibration jumps and up and down are
    two motions. Raises InputError for a case without shafts.
    """
    plan = waterfall_plan(
        case,
        speeds,
        states=states,
        operating=operating,
        duration=duration,
        coordinates=coordinates,
    )
    how: dict[str, Any] = {"threads": threads, "scheduler": scheduler, "report": report}
    data = carry_out(plan, store, **how, alive=alive, title=case.title)
    return finished(data, case.title)
