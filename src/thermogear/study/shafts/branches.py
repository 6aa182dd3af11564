"""Branches of a drive train's periodic motions along a parameter, and in a second one."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from thermogear.analysis.any_motion import settle
from thermogear.analysis.continuation import Branch
from thermogear.analysis.event_curve import EventCurve
from thermogear.analysis.orbits import Orbit, periodic_orbit, shoot
from thermogear.analysis.walk import Motion, Search
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.notice import Notice
from thermogear.base.parameters import Parameter
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.case.case import GearCase
from thermogear.case.one_point import OnePoint
from thermogear.dynamics.between import between
from thermogear.dynamics.geared import GearedModel
from thermogear.dynamics.ladder import Engine
from thermogear.dynamics.plane import plane_of
from thermogear.dynamics.return_map import return_map
from thermogear.results.result import Result
from thermogear.study.branches import (
    Leg,
    dataset,
    lost_notices,
    parameter_of,
    require_depth,
    summary_of,
    walked,
)
from thermogear.study.event_plane import Plane
from thermogear.study.orbit import found
from thermogear.study.shafts.family import TrainFamily
from thermogear.study.shafts.state import plan_of

BEYOND = 0.5
"""Cells of the grid by which a walk's steps may reach beyond its ends."""


@dataclass(frozen=True, eq=False)
class TrainGrid:
    """``family`` (of trains) at the corners of ``axes`` (ascending), straight between them."""

    family: Any
    axes: tuple[Floats, ...]
    _kept: dict[tuple[int, ...], Any] = field(init=False, repr=False, default_factory=dict)

    def __call__(self, *values: float) -> Any:
        """The train in motion at one value of each parameter.

        InputError beyond the grid, or where the train has no motion.
        """
        places = [self._cell(axis, at) for axis, at in zip(self.axes, values, strict=True)]
        return self._mixed((), places)

    def _cell(self, axis: Floats, value: float) -> tuple[int, float]:
        """The cell that a value lies in, and where in it."""
        place = int(np.clip(np.searchsorted(axis, value, side="right") - 1, 0, axis.size - 2))
        weight = float((value - axis[place]) / (axis[place + 1] - axis[place]))
        if not -BEYOND <= weight <= 1.0 + BEYOND:
            number = next(i for i, one in enumerate(self.axes) if one is axis)
            raise InputError(
                self.family.names[number], value, allowed=f"{axis[0]:.6g}..{axis[-1]:.6g}"
            )
        return place, weight

    def _mixed(self, corner: tuple[int, ...], rest: list[tuple[int, float]]) -> Any:
        if not rest:
            return self._corner(corner)
        (place, weight), *others = rest
        low = self._mixed((*corner, place), others)
        if weight == 0.0:
            return low
        high = self._mixed((*corner, place + 1), others)
        return high if weight == 1.0 else self.between(low, high, weight)

    def _corner(self, corner: tuple[int, ...]) -> Any:
        model = self._kept.get(corner)
        if model is None:
            row = [float(axis[place]) for axis, place in zip(self.axes, corner, strict=True)]
            model = self._kept[corner] = self.model(row)
        return model

    def between(self, low: Any, high: Any, weight: float) -> Any:
        """Straight between two corners."""
        return between(low, high, weight)

    def model(self, row: list[float]) -> Any:
        """What a corner holds, by its values of the parameters."""
        train = self.family.train(row)
        if train is None:
            rest = self.family.at_rest(row)[0]
            words = ", ".join(
                f"{name} {value:.6g}" for name, value in zip(self.family.names, row, strict=True)
            )
            raise InputError(
                "parameter",
                f"{words} (SI): {STATUS[rest.status].replace('_', ' ')}",
                why=STILL[STATUS[rest.status]],
                fix="choose a smaller range",
            )
        return train.model


VALUES = 9
"""Values of the parameter at which mesh, bearings and friction of a train are computed."""
SAMPLES = 128
"""Samples a mesh period that the greatest mesh force is read from."""
LONG = Search(first=8, cap=64, max_period=2, starts=1)
"""How a motion is followed whose forces come again after many mesh periods; an orbit is wanted
from this start, not a label that others share."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Trains:
    """The drive train at one ``point`` of its case, in the coordinates of ``family``.

    ``family`` has no parameter of its own; ``point`` is that of the gears, for its words and
    present values.
    """

    point: OnePoint
    family: TrainFamily

    @classmethod
    def of(
        cls, case: GearCase, point: OnePoint, *, operating: int | None, coordinates: int | None
    ) -> Trains:
        """The train of ``case`` where ``point`` is, its ``operating`` point counted from 1."""
        family = TrainFamily(
            case, (), point.bundle.name, point.state,
            operating=0 if operating is None else operating - 1, coordinates=coordinates,
        )  # fmt: skip
        return cls(point=point, family=family)

    def over(self, names: tuple[str, ...], axes: tuple[Floats, ...]) -> TrainGrid:
        """The train over parameters, computed at the values of ``axes``."""
        one = self.family
        whole = TrainFamily(
            one.case, names, one.bundle, one.state, operating=one.operating,
            coordinates=one.coordinates,
        )  # fmt: skip
        whole.require(dict(zip(names, axes, strict=True)))
        return TrainGrid(whole, tuple(np.unique(axis) for axis in axes))


def train_orbit(
    model: GearedModel,
    start: tuple[float, float] | None = None,
    period: int | None = None,
    *,
    transient: bool = True,
) -> tuple[Orbit, Motion | None]:
    """The closed orbit that a train's motion settles on, or the one of ``period`` near its end.

    ``start`` (x, v) in half backlashes of the teeth, the state at rest if left out. Without
    ``transient`` Newton starts there itself, which reaches unstable orbits. Raises ConvergenceError
    where no orbit is reached.
    """
    section, plane = return_map(model), plane_of(model)
    begin = plane.rest if start is None else plane.starts(start)
    if not transient:
        return periodic_orbit(model, 1 if period is None else period, begin), None
    motion = settle(section, begin, LONG if model.cycle > 1 else Search(starts=1))
    if motion.orbit is not None and period in (None, motion.period):
        orbit = shoot(section, motion.orbit.state, motion.period, model=model)
        if orbit is not None:
            return orbit, motion
    if period is None:
        raise ConvergenceError(
            f"no closed orbit: the drive train's motion is {motion.words} ({motion.reason}); begin "
            "at another value of the parameter, or give --period to look for an orbit inside it"
        )
    return periodic_orbit(model, period, motion.state), motion


def train_branch_results(
    trains: Trains,
    parameter: str,
    to: float,
    *,
    begin: float | None = None,
    start: tuple[float, float] | None = None,
    period: int | None = None,
    transient: bool = True,
    switch: int = 0,
    count: int = VALUES,
    second: tuple[str, Floats] | None = None,
    progress: Progress = silent,
) -> Result:
    """Follow the orbit of a drive train in ``parameter``, as ``branch_results`` does of a pair.

    Mesh, bearings and friction are computed at ``count`` values from ``begin`` to ``to``, in a
    ``second`` parameter at those asked for, and run straight between them.
    """
    if count < 2:
        raise InputError("--values", count, allowed=">= 2")
    point = trains.point
    varied = parameter_of(point, parameter)
    first = point.value(varied.name) if begin is None else begin
    if first == to:
        raise InputError("--to", varied.told(to), allowed="another value than that of --from")
    require_depth(switch)
    axis = np.linspace(first, to, count)
    plane = None
    if second is None:
        grid = trains.over((varied.name,), (axis,))
        models: Any = grid
    else:
        other = parameter_of(point, second[0])
        grid = trains.over((varied.name, other.name), (axis, second[1]))
        plane = Plane(other, second[1], grid, plan_of(trains.family.case).bearing_names)
        models = plane.models
    progress("settling", 0, 1)
    model = models(first)
    asked = trains.family.coordinates
    if asked is not None and asked > model.size:
        raise InputError("--coordinates", asked, allowed=f"{model.size} at most: the whole train")
    orbit, motion = train_orbit(model, start, period, transient=transient)
    progress("settling", 1, 1)
    legs, cut = walked(orbit, varied, models, begin=first, to=to, switch=switch, progress=progress)
    curves: list[EventCurve] = []
    told: list[Notice] = []
    if plane is not None and not cut:
        branches = [leg.branch for leg in legs]
        curves, told, cut = plane.followed(branches, varied, (first, to), progress)
    summary = summary_of(point.title, varied, legs, (first, to), cut)
    began = "Newton's method from the start itself"
    if motion is not None:
        wanted = f"; the orbit of period {orbit.period} was asked for"
        began = f"{motion.name}: {motion.reason}{wanted * (motion.period != orbit.period)}"
    summary |= {
        "train": {
            "coordinates": orbit.model.size if isinstance(orbit.model, GearedModel) else 0,
            "cycle": grid.family.cycle,
            "began": began,
            "values": count,
            "straight": straight_error(grid, legs[0].branch, plane),
        }
    }
    off = summary["train"]["straight"] or {"force": None, "multiplier": None}
    cycle = grid.family.cycle
    notices = [
        *lost_notices(legs),
        *told,
        Notice.of("straight_between_values", force=off["force"], multiplier=off["multiplier"]),
        *([Notice.of("period_of_all_shafts", cycle=cycle)] if cycle > 1 else []),
    ]
    groups = {f"branch_{i}": _stored(leg, varied) for i, leg in enumerate(legs)}
    if plane is not None:
        summary |= plane.summary(curves, varied)
        groups |= plane.groups(curves, varied)
    return found("branch", groups, summary, notices, interrupted=cut)


def straight_error(grid: TrainGrid, branch: Branch, plane: Plane | None) -> dict[str, Any] | None:
    """How far an orbit of the straight numbers is from that of the train computed there.

    Half way in the middle interval between computed values, at the first value of a second
    parameter: ``value`` [SI], ``multiplier`` the change of the largest modulus, ``force`` that of
    the greatest mesh force as a share. None where the branch or one of both orbits is not there.
    """
    axis = grid.axes[0]
    place = (axis.size - 1) // 2
    value = 0.5 * float(axis[place] + axis[place + 1])
    index = int(np.argmin(np.abs(branch.values - value)))
    if abs(branch.values[index] - value) > 0.5 * float(axis[place + 1] - axis[place]):
        return None
    rest = () if plane is None else (float(plane.values[0]),)
    computed = grid.family.train((value, *rest))
    if computed is None:
        return None
    found = []
    state = branch.states[index]
    for model in (grid(value, *rest), computed.model):
        orbit = shoot(return_map(model), state, branch.period, model=model)
        if orbit is None:
            return None
        state = orbit.state
        size = float(np.abs(orbit.multipliers).max())
        found.append((size, _greatest(model, state, branch.period)))
    (one, force), (other, own) = found
    return {"value": value, "multiplier": abs(one - other), "force": abs(force / own - 1.0)}


def _stored(leg: Leg, varied: Parameter) -> Dataset:
    """A branch as it is stored: points along it with their greatest force, and bifurcations."""
    branch, data = leg.branch, dataset(leg, varied.unit)
    forces = [
        _greatest(branch.family(float(value)), state, branch.period)
        for value, state in zip(branch.values, branch.states, strict=True)
    ]
    events = [
        _greatest(branch.family(one.value), one.state, branch.period) for one in branch.bifurcations
    ]
    words = {"long_name": "greatest force of the drive flanks", "units": "N"}
    data["mesh_force"] = ("point", np.array(forces, dtype=float), words)
    data["event_mesh_force"] = ("event", np.array(events, dtype=float), words)
    return data


def _greatest(model: object, state: Floats, period: int) -> float:
    """Greatest force of the drive flanks [N] on an orbit."""
    assert isinstance(model, GearedModel)
    run = Engine(model).run(state, period * model.cycle, samples=SAMPLES)
    return float(model.forces(run.sample_phase, states=run.samples)["drive"].max())
