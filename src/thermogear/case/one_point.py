"""One point of a case: what an orbit, an exponent or a branch is computed at.

An operating point of a gear case under one bundle in one state of heat, a point of a dimensionless
row, or plain numbers. Its motion is that of a family with one row (:attr:`OnePoint.points`), a
branch runs along a family of one parameter through it (:meth:`OnePoint.along`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, require_choice
from thermogear.base.excitation import Excitation
from thermogear.base.parameters import NUMBERS, PARAMETERS, long_name
from thermogear.base.units import RPM
from thermogear.case.allowed import (
    dimensionless_reader,
    gear_parameter,
    gear_reader,
    number_parameter,
    positive_stiffness,
    read_value,
    require_numbers,
)
from thermogear.case.base import Case, Simulation
from thermogear.case.case import DimensionlessCase, GearCase, gear_case
from thermogear.case.dimensionless import Point
from thermogear.case.family import GearFamily, NumberFamily, along, family, moving
from thermogear.case.points import Points
from thermogear.case.thermal_state import HOT, StateLike, ThermalState
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating

MOTION = Simulation(
    periods=256,
    discard=500,
    most_discarded=32_000,
    steps_per_period=512,
    samples=256,
    sample_periods=8,
    initial_state=(0.0, 0.0),
)
"""How the motion of plain numbers is followed."""


@dataclass(frozen=True, eq=False)
class OnePoint:
    """``case`` holds one point and one bundle; ``operating`` that of its gears, in ``state``.

    Along speed and torque the gears stay as hot as they are here.
    """

    case: GearCase | DimensionlessCase
    state: ThermalState = HOT
    operating: Operating | None = None

    @property
    def title(self) -> str:
        """The case, and which of its points."""
        return self.case.title

    @property
    def simulation(self) -> Simulation:
        """Where the motion starts and how long it is followed."""
        return self.case.simulation

    @property
    def gears(self) -> GearCase:
        """The gears behind the point; InputError without any."""
        return gear_case(self.case)

    @cached_property
    def points(self) -> Points:
        """The one point; InputError where nothing moves."""
        return moving(self._family(np.empty((1, 0))), self._family)

    @property
    def bundle(self) -> MeshModel:
        """The choices of the gears behind the point."""
        return self.gears.models[0]

    def excitation(self) -> Excitation:
        """k(t), e(t), backlash and force in SI; InputError where nothing moves."""
        _ = self.points
        whole = GearFamily(self.gears, (), state=self._held)
        found = whole.excitations(np.empty((1, 0))).one(0)
        assert found is not None  # the point moves
        return found

    def along(self, parameter: str) -> Callable[[float], Points]:
        """value -> the point with ``parameter`` put to it; temperature is both addenda's."""
        return along(self._over((parameter,)))

    def over(self, first: str, second: str) -> Callable[[float, float], Points]:
        """(p, q) -> the point with two parameters put to them, as :meth:`along`."""
        whole = self._over((first, second))
        return lambda p, q: moving(whole(np.array([[p, q]])), whole)

    def _over(self, names: tuple[str, ...]) -> GearFamily | NumberFamily:
        if "gear_temperature" not in map(long_name, names):
            return family(self.case, names, state=self._held)
        if self.state != HOT:
            raise InputError(
                "--state",
                f"{self.state.words}, with a temperature to vary",
                why="it says the temperature already",
                fix="use --state hot and --from '20 degC'",
            )
        return family(self.case, names)

    @property
    def _held(self) -> ThermalState:
        """The state, the heat of this operating point kept at every speed and torque."""
        return self.state if self.operating is None else replace(self.state, held=self.operating)

    @cached_property
    def _family(self) -> GearFamily | NumberFamily:
        return family(self.case, state=self._held)

    @property
    def parameters(self) -> dict[str, float]:
        """The numbers of the equation, by name."""
        if isinstance(self.case, DimensionlessCase):
            return self.case.points[0].model_arguments()
        points = self.points
        return {
            "damping_ratio": 0.5 * float(points.flat.damping[0]),
            "frequency": float(points.mesh_frequency[0] / points.rate[0]),
            "half_backlash": float(points.flat.half_backlash[0]),
        }

    def value(self, parameter: str) -> float:
        """The present value [SI] of a parameter; InputError of one that only the file knows."""
        name = long_name(parameter)
        numbers = self.parameters
        if name in numbers:
            return numbers[name]
        gears = self.gears
        at = self.operating or gears.stated
        here = {
            "pinion_speed": at.speed,
            "pinion_torque": at.torque,
            "gear_temperature": at.temperatures.pinion_addendum,
            "cold_half_backlash": at.half_backlash,
        }
        if name not in here:
            raise InputError(
                "--from",
                "nothing",
                why=f"{name} stands in the file alone",
                fix="say where to begin",
            )
        return float(np.ravel(here[name])[0])


def of_numbers(numbers: Mapping[str, float], start: tuple[float, float] | None = None) -> OnePoint:
    """Plain dimensionless numbers, by their long names; b' defaults to 1 and eps_T to 0."""
    given = {"half_backlash": 1.0, "thermal_stiffness": 0.0, **numbers}
    missing = [PARAMETERS[name].aliases[0] for name in NUMBERS if name not in given]
    if missing:
        raise InputError(
            f"--{missing[0]}",
            "nothing",
            allowed="a number",
            why="neither a case nor this option gives it",
            fix="name a case, or give --zeta --w --eps --fm --fh",
        )
    require_numbers(given)
    simulation = MOTION if start is None else replace(MOTION, initial_state=start)
    case = DimensionlessCase(
        title="Plain numbers", text="", simulation=simulation, points=(), base={}
    )
    point = Point(row="", parameter="", value=0.0, unit="1", expected="", **given)
    return OnePoint(_of_point(case, point))


def of_case(
    case: Case,
    *,
    row: str | None = None,
    point: int | None = None,
    operating: int | None = None,
    bundle: str | None = None,
    state: StateLike = HOT,
    numbers: Mapping[str, float] | None = None,
    start: tuple[float, float] | None = None,
) -> OnePoint:
    """One point of a case: ``point`` of a ``row``, or ``operating`` point, bundle and state.

    Points count from 1 in the order of the file (speeds times torques, torque the fast one).
    ``numbers`` replace those of a dimensionless point. ``start`` replaces the case's (X, X').
    """
    state = ThermalState.of(state)
    simulation = case.simulation if start is None else replace(case.simulation, initial_state=start)
    if isinstance(case, DimensionlessCase):
        points = rows_of(case)[named("--row", row, list(rows_of(case)))]
        number = 1 if point is None else point
        chosen = points[counted("--point", number, most=len(points))]
        changes: dict[str, Any] = dict(numbers or {})
        chosen = replace(chosen, **changes)
        require_numbers(chosen.model_arguments())
        title = f"{case.title}: row {chosen.row}, point {number}"
        return OnePoint(_of_point(replace(case, title=title, simulation=simulation), chosen))
    case = gear_case(case)
    if numbers:
        raise InputError(
            f"--{PARAMETERS[next(iter(numbers))].aliases[0]}",
            "a number beside a gear case",
            why="the gears decide the numbers of their equation",
            fix="use --set, for instance --set dynamics.damping_ratio=0.1",
        )
    names = [m.name for m in case.models]
    model = dict(zip(names, case.models, strict=True))[named("--bundle", bundle, names)]
    most = len(case.speeds) * len(case.torques)
    here = counted("--operating", 1 if operating is None else operating, most=most)
    state.require_settled(case, model, here)
    one = state.operating(case, model).point(here)
    speed, torque = float(one.speed[0]), float(one.torque[0])
    alone = replace(
        case,
        title=f"{case.title}: {speed / RPM:.6g} rpm, {torque:.6g} N m, {model.name}, {state.words}",
        simulation=simulation,
        models=(model,),
        speeds=(speed,),
        torques=(torque,),
        stated=replace(case.stated, speed=one.speed, torque=one.torque),
    )
    found = OnePoint(alone, state, one)
    _ = found.points
    return found


def _of_point(case: DimensionlessCase, point: Point) -> DimensionlessCase:
    """The case with ``point`` as its only one and its base set."""
    base = {name: (value,) for name, value in point.model_arguments().items()}
    return replace(case, points=(point,), base=base)


def rows_of(case: DimensionlessCase) -> dict[str, list[Point]]:
    """Row -> its points, in the order of the file."""
    rows: dict[str, list[Point]] = {}
    for point in case.points:
        rows.setdefault(point.row, []).append(point)
    return rows


def named(option: str, name: str | None, known: list[str]) -> str:
    """``name`` if it is known, the first of the known without one."""
    if name is None:
        return known[0]
    require_choice(option, name, known)
    return name


def counted(option: str, number: int, *, most: int) -> int:
    """Place of the ``number``-th, counted from 1."""
    if isinstance(number, bool) or number not in range(1, most + 1):
        raise InputError(option, repr(number), allowed=f"1..{most}")
    return int(number) - 1


def parameter_name(point: OnePoint, name: str) -> str:
    """The long name of ``name``, as the case of ``point`` knows it."""
    of_kind = gear_parameter if isinstance(point.case, GearCase) else number_parameter
    return of_kind(name, "--parameter").name


def parameter_value(option: str, point: OnePoint, parameter: str, text: str) -> float:
    """A value of ``parameter`` as SI; gear parameters are written with their unit.

    Refused, under the name of ``option``, where no case file could hold it.
    """
    if isinstance(point.case, GearCase):
        return read_value(option, gear_reader(parameter), text)
    value = read_value(option, dimensionless_reader(parameter), text)
    numbers = point.parameters | {parameter: value}
    positive_stiffness(
        "stiffness_amplitude",
        numbers["stiffness_amplitude"],
        thermal=numbers["thermal_stiffness"],
    )
    return value
