"""A case with shafts over its parameters: rows of values -> drive trains in motion."""

from __future__ import annotations

import json
import threading
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, fields, replace
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.analysis.family import Models
from thermogear.analysis.settle import CHAOTIC, PERIODIC, UNDECIDED, Settled
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ThermogearError, nearest
from thermogear.base.plan import Arrays, Coordinate, Variable, real
from thermogear.base.vocabulary import STATUS, moves, still
from thermogear.case.allowed import LANE
from thermogear.case.case import GearCase
from thermogear.case.family import GearFamily
from thermogear.case.samples import GEARS_AT
from thermogear.case.thermal_state import HOT, ThermalState
from thermogear.dynamics.between import between
from thermogear.dynamics.geared import GearedModel
from thermogear.dynamics.ladder import Engine
from thermogear.shafts.assembly import Assembly
from thermogear.shafts.reduction import Reduction, reduced, usual
from thermogear.study.shafts.moving import HELD_MODES, MovingTrain, moving, rubbing, shaft_orders
from thermogear.study.shafts.record import SAMPLES, shown
from thermogear.study.shafts.state import TrainState, plan_of, require_standing, settled

KEPT = 80
"""Cases, trains at rest and trains in motion that a family remembers, of each, for every thread:
more than a chunk of a map has."""
WATCHED = 32
"""Mesh periods at most of a settled motion that its forces are read from."""
IMPOSSIBLE = STATUS.index("impossible")
LOST_FLAGS = ("drive_flank", "back_flank")
"""The first flags of what loses contact; the bearings follow, one by one."""
MOVING = (UNDECIDED, PERIODIC, CHAOTIC)
"""Labels of motions whose forces are read."""


@dataclass(frozen=True, eq=False)
class TrainFamily:
    """Parameters of a gear case -> its drive train in motion, in one ``state`` of heat.

    ``case`` with [[shafts]]; of many operating points ``operating`` is meant, from 0. Every row has
    its own mesh, clearances and friction of the teeth, as a case with these values; all rows are in
    the same coordinates. ``seen`` names the bearing whose journal is drawn, "" the teeth.
    """

    case: GearCase
    names: tuple[str, ...]
    bundle: str = ""
    state: ThermalState = HOT
    _: KW_ONLY
    operating: int = 0
    coordinates: int | None = None
    seen: str = ""
    _kept: dict[str, dict[Any, Any]] = field(init=False, repr=False, default_factory=dict)

    def __post_init__(self) -> None:
        plan = plan_of(self.case)
        require_standing(self.case, "over parameters")
        gears = GearFamily(self.case, self.names, self.bundle, self.state)
        object.__setattr__(self, "names", gears.names)
        object.__setattr__(self, "bundle", gears.bundle)
        object.__setattr__(self, "state", gears.state)
        for name in set(self.names) & set(LANE):
            raise InputError(
                "over", name, why="a drive train has no such number", fix="vary a gear parameter"
            )
        if self.seen and self.seen not in plan.bearing_names:
            known = ["teeth", *plan.bearing_names]
            raise InputError(
                "--plane", repr(self.seen), allowed=" | ".join(known),
                fix=nearest(self.seen.lower(), known),
            )  # fmt: skip

    def __getstate__(self) -> dict[str, Any]:
        return {**self.__dict__, "_kept": {}}

    @cached_property
    def gears(self) -> GearFamily:
        """The same parameters of the gears alone: their names, units and ranges."""
        return GearFamily(self.case, self.names, self.bundle, self.state)

    @property
    def units(self) -> tuple[str, ...]:
        return self.gears.units

    def inputs(self) -> dict[str, Any]:
        return self.gears.inputs() | {
            "equations": "drive train",
            "operating": self.operating,
            "coordinates": self.coordinates,
            "seen": self.seen,
        }

    def require(self, axes: Mapping[str, ArrayLike]) -> None:
        """Refuse ``axes`` that no case file could hold."""
        self.gears.require(axes)

    @property
    def dimension(self) -> int:
        """Length of a state."""
        return 2 * self._reference.size + (1 if self._slips else 0)

    @property
    def _slips(self) -> bool:
        fall, lag = self._reference.assembly.slip
        return fall > 0.0 and lag > 0.0

    @cached_property
    def _alone(self) -> GearCase:
        """The case with one operating point and one bundle."""
        at, case = self.case.stated, self.case
        if at.speed.size > 1:
            here = {"pinion_speed": at.speed, "pinion_torque": at.torque}
            case = case.with_values(
                {name: float(v[self.operating]) for name, v in here.items()}, told=False
            )
        (model,) = (one for one in case.models if one.name == self.bundle)
        return replace(case, models=(model,))

    @cached_property
    def _reference(self) -> Reduction:
        """The coordinates of every row: those of the case as it stands."""
        assembly = self._at_rest({}, self.state).assembly
        wanted = self.coordinates
        return reduced(assembly, usual(assembly, HELD_MODES) if wanted is None else wanted)

    def _case_with(self, values: Mapping[str, float]) -> GearCase:
        """The one-point case with parameters put to other ``values`` [SI]."""
        if not values:
            return self._alone
        found: GearCase | None = self._known("case", *values.items())
        if found is None:
            index = [m.name for m in self.case.models].index(self.bundle)
            whole = replace(self._alone, models=self.case.models)
            made = whole.with_values(dict(values), told=False)
            found = replace(made, models=(made.models[index],))
            self._keep(found, "case", *values.items())
        return found

    def _at_rest(self, values: dict[str, float], state: ThermalState) -> TrainState:
        key = (*values.items(), state.stored)
        found: TrainState | None = self._known("rest", *key)
        if found is None:
            case = self._case_with(values)
            # what is reached from hot is asked of no motion
            state.balance(case, case.models[0], from_hot=False)
            found = settled(case, [0], states=[state])[0][0]
            self._keep(found, "rest", *key)
        return found

    def _known(self, kind: str, *key: object) -> Any:
        return self._kept.setdefault(kind, {}).get(key)

    def _keep(self, value: object, kind: str, *key: object) -> None:
        kept = self._kept.setdefault(kind, {})
        over = len(kept) + 1 - KEPT * threading.active_count()
        for old in list(kept)[: max(over, 0)]:
            kept.pop(old, None)
        kept[key] = value

    def at_rest(self, row: Sequence[float]) -> tuple[TrainState, GearCase]:
        """The train of one row at rest under its load, and its case."""
        values = dict(zip(self.names, map(float, row), strict=True))
        whole = {name: value for name, value in values.items() if name != GEARS_AT}
        state = ThermalState.at(values[GEARS_AT]) if GEARS_AT in values else self.state
        # where the heat is given, neither mesh nor bearings know the speed
        known = dict(whole)
        speed = (
            known.pop("pinion_speed", None) if not state.hangs_on_the_load(self._alone) else None
        )
        found = self._at_rest(known, state)
        return found if speed is None else replace(found, speed=speed), self._case_with(whole)

    def train(self, row: Sequence[float]) -> MovingTrain | None:
        """The train of one row in motion; None where it has no motion."""
        key = tuple(map(float, row))
        made: tuple[MovingTrain | None] | None = self._known("motion", *key)
        if made is None:
            made = (self._moving(row),)
            self._keep(made, "motion", *key)
        return made[0]

    def _moving(self, row: Sequence[float]) -> MovingTrain | None:
        found, case = self.at_rest(row)
        if not moves(found.status):
            return None
        made = moving(
            case, found, reduction=self._coordinates(found.assembly), friction=rubbing(case, found)
        )
        if not self.seen:
            return made
        place = plan_of(case).bearing_names.index(self.seen)
        vectors = made.reduction.vector(found.assembly.bearings[place].directions)
        return replace(made, model=replace(made.model, seen=vectors))

    def _coordinates(self, assembly: Assembly) -> Reduction:
        """The reference's coordinates of another assembly.

        Shafts of other sizes bend in other shapes: the reference's, seen from their own.
        """
        one = self._reference
        if assembly.coordinates != one.assembly.coordinates:
            return reduced(assembly, one.size)
        if _alike(assembly, one.assembly):
            return Reduction(assembly=assembly, basis=one.basis)
        own = reduced(assembly, one.size)
        return Reduction(assembly=assembly, basis=own.basis @ own.coordinates(one.basis.T).T)

    @property
    def model(self) -> GearedModel:
        """The train at the case's own values; InputError where it has no motion."""
        one = self if not self.names else replace(self, names=())
        found = one.train(())
        if found is None:
            rest = one.at_rest(())[0]
            raise still(rest.status, rest.state.words)
        return found.model

    @property
    def cycle(self) -> int:
        """Mesh periods after which all forces at shaft orders come again."""
        one = self._reference
        return shaft_orders(plan_of(self.case), one.assembly, one)[2]

    def __call__(self, points: Floats) -> Models:
        rows = np.asarray(points, dtype=float)
        found: list[GearedModel | None] = []
        status = np.zeros(len(rows), np.int8)
        refused: list[ThermogearError] = []
        for place, row in enumerate(rows):
            try:
                model, status[place] = self._model(tuple(row.tolist()))
            except ThermogearError as error:
                refused.append(error)
                model, status[place] = None, IMPOSSIBLE
            found.append(model)
        if refused and len(refused) == len(rows):
            raise refused[0]
        return Models(tuple(found), status)

    def _model(self, row: tuple[float, ...]) -> tuple[GearedModel | None, int]:
        train = self.train(row)
        return None if train is None else train.model, self.at_rest(row)[0].status

    # --- what else is seen of a settled motion ----------------------------------------------

    kinds = ("lost_contact",)

    def watched(self, dims: tuple[str, ...]) -> dict[str, Variable]:
        """The stored variables of :meth:`watch` over ``dims``."""
        number = partial(real, dims)
        bearings = range(1, len(plan_of(self.case).bearing_names) + 1)
        flags = (*LOST_FLAGS, *(f"bearing_{number}" for number in bearings))
        lost = {
            "long_name": "what loses contact, the sum of its flags; 0: nothing",
            "flag_masks": 2 ** np.arange(len(flags), dtype=np.int32),
            "flags": " ".join(flags),
        }
        return {
            "greatest_mesh_force": number("greatest force of the drive flanks", "N"),
            "drive_free_share": number("share of time in which no drive flank carries", "1"),
            "back_share": number("share of time in contact of the back flanks", "1"),
            "greatest_bearing_force": number("greatest force on the bearing", "N", "bearing"),
            "average_bearing_force": number(
                "mean amount of the force on the bearing", "N", "bearing"
            ),
            "bearing_free_share": number(
                "share of time in which a bearing bears nothing", "1", "bearing"
            ),
            "lost_contact": Variable(dims, "float64", float("nan"), lost),
        }

    def watched_coordinates(self) -> dict[str, Coordinate]:
        """The axis of the bearings."""
        names = plan_of(self.case).bearing_names
        about = {"long_name": "bearing", "names": json.dumps(list(names))}
        return {"bearing": (("bearing",), np.arange(1, len(names) + 1), about)}

    def watch(self, points: Floats, found: Settled) -> Arrays:
        """Forces and losses of contact of the settled motions of rows ``points``.

        A bearing lifts off where it bears nothing at one of 64 samples a mesh period.
        """
        rows = np.asarray(points, dtype=float)
        count = len(plan_of(self.case).bearing_names)
        values: Arrays = {
            name: np.full(
                (len(rows), count) if "bearing" in variable.dims else len(rows),
                variable.fill,
                np.dtype(variable.dtype),
            )
            for name, variable in self.watched(("row",)).items()
        }
        for place, row in enumerate(rows):
            if found.label[place] not in MOVING or not np.all(np.isfinite(found.state[place])):
                continue
            train = self.train(row)
            if train is None:
                continue
            periods = (
                WATCHED
                if found.period[place] == 0
                else min(max(int(found.period[place]), 1) * train.model.cycle, WATCHED)
            )
            run = Engine(train.model).run(found.state[place], periods, samples=SAMPLES)
            record = shown(train, run, 0.0)
            force = np.linalg.norm(record.bearing_force, axis=2)
            free = (force == 0.0).mean(axis=0)
            apart = run.shares[0] + run.shares[1]
            values["greatest_mesh_force"][place] = record.mesh_force.max()
            values["drive_free_share"][place] = apart
            values["back_share"][place] = run.shares[0]
            values["greatest_bearing_force"][place] = force.max(axis=0)
            values["average_bearing_force"][place] = force.mean(axis=0)
            values["bearing_free_share"][place] = free
            lost = np.array([apart, run.shares[0], *free]) > 0.0
            values["lost_contact"][place] = int(lost @ 2 ** np.arange(lost.size))
        return values


def _alike(one: Assembly, other: Assembly) -> bool:
    """Whether two trains bend and move alike with their contacts open."""

    def held(assembly: Assembly) -> list[Floats]:
        springs = [
            place.bearing.law.stiffness(np.zeros(2))
            for place in assembly.bearings
            if place.bearing.law.linear
        ]
        return [assembly.mass, assembly.stiffness, *springs]

    return all(np.array_equal(a, b) for a, b in zip(held(one), held(other), strict=True))


@dataclass(frozen=True, eq=False)
class TabulatedTrains(TrainFamily):
    """A family of one parameter computed at ``values``, ascending; straight between them."""

    values: Floats = field(kw_only=True)

    @classmethod
    def of(cls, family: TrainFamily, values: Floats) -> TabulatedTrains:
        """``family`` at ``values``."""
        kept = {entry.name: getattr(family, entry.name) for entry in fields(family) if entry.init}
        return cls(**kept, values=values)

    def _at(self, place: int) -> tuple[GearedModel | None, int]:
        kept = self._kept.setdefault("values", {})
        if place not in kept:
            made = super().__call__(self.values[place : place + 1, None])
            model: Any = made.models[0]
            kept[place] = (model, int(made.status[0]))
        model_and_status: tuple[GearedModel | None, int] = kept[place]
        return model_and_status

    def __call__(self, points: Floats) -> Models:
        models: list[GearedModel | None] = []
        status = []
        for at in np.asarray(points, dtype=float)[:, 0]:
            place = int(np.searchsorted(self.values, at, side="right")) - 1
            place = min(max(place, 0), self.values.size - 1)
            low, worst = self._at(place)
            if at == self.values[place] or self.values.size == 1:
                models.append(low)
                status.append(worst)
                continue
            if place == self.values.size - 1:
                place -= 1
                low, worst = self._at(place)
            high, other = self._at(place + 1)
            span = self.values[place + 1] - self.values[place]
            # a little beyond the ends too, so that it can be differentiated there
            weight = float(np.clip((at - self.values[place]) / span, -0.01, 1.01))
            status.append(max(worst, other))
            models.append(None if low is None or high is None else between(low, high, weight))
        return Models(tuple(models), np.array(status, np.int8))
