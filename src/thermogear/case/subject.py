"""What an engine command works on: one equation of motion, and what stands behind it.

A subject is a model with a start and its scales: a gear pair at one operating point, bundle and
state of heat, a point of a dimensionless row, or plain numbers. :func:`family` turns a parameter's
name into the models along it; speed, torque and temperature compute the mesh anew.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property, lru_cache

import numpy as np
import xarray as xr

from thermogear.analysis.continuation import family_of
from thermogear.base.errors import InputError, nearest
from thermogear.base.excitation import Excitation
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STATES, UNDEFORMED
from thermogear.case.allowed import (
    dimensionless_reader,
    gear_reader,
    positive_stiffness,
    read_value,
    require_numbers,
)
from thermogear.case.case import Case, DimensionlessCase, GearCase, Simulation, gear_case
from thermogear.case.dimensionless import Point
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel, from_excitation
from thermogear.mesh.excite import excitation
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating

Model = TorsionalModel | DeadZoneModel
Family = Callable[[float], object]

SHORT = {
    "zeta": "damping_ratio",
    "w": "frequency",
    "eps": "stiffness_amplitude",
    "fm": "mean_force",
    "fh": "force_amplitude",
    "b": "half_backlash",
    "eps-t": "thermal_stiffness",
}
"""The symbols of the dimensionless equation as a command line writes them."""

GEAR_PARAMETERS = ("speed", "torque", "temperature")
"""What can be varied on a gear pair; temperature is both addenda's."""

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


@dataclass(frozen=True, eq=False, kw_only=True)
class Scale:
    """Dimensionless to SI: ``length`` b_c [m], ``rate`` omega_n [rad/s], ``mesh`` [Hz].

    All 1 (mesh 0) where no gear stands behind the numbers.
    """

    length: float = 1.0
    rate: float = 1.0
    mesh: float = 0.0

    @property
    def gear(self) -> bool:
        """Whether a gear gives the numbers their units."""
        return self.mesh > 0.0


@dataclass(frozen=True, eq=False)
class Gears:
    """One operating point of a gear case under one bundle, with the state of its heat."""

    case: GearCase
    bundle: MeshModel
    operating: Operating
    state: str

    def cycle(self) -> xr.Dataset:
        """The mesh cycle there, a few positions along the path alone."""
        return self.case.cycle(self.operating, self.bundle, path_positions=3)

    def excitation(self) -> Excitation:
        """k(t), e(t), backlash and force there; InputError where the pair is jammed."""
        (found,) = excitation(
            self.cycle(),
            self.case.pair,
            damping_ratio=self.case.damping_ratio,
            inertias=self.case.inertias,
            transmission_error=self.case.transmission_error,
            harmonics=self.case.harmonics,
        )
        if found is None:
            raise InputError(
                "operating",
                f"a jammed pair ({self.state})",
                why="the half backlash is used up: no clearance is left to move in",
                fix="lower the temperature or raise the backlash",
            )
        return found

    def value(self, parameter: str) -> float:
        """The present value of ``speed``, ``torque`` or ``temperature`` (SI)."""
        if parameter == "speed":
            return float(np.ravel(self.operating.speed)[0])
        if parameter == "torque":
            return float(np.ravel(self.operating.torque)[0])
        return float(np.ravel(self.operating.temperatures.pinion_addendum)[0])

    @cached_property
    def _alone(self) -> GearCase:
        """The case with this operating point as its only one."""
        here = self.operating
        return replace(
            self.case, stated=replace(self.case.stated, speed=here.speed, torque=here.torque)
        )

    def at(self, parameter: str, value: float) -> Gears:
        """The same pair with one of :data:`GEAR_PARAMETERS` changed; temperature of both gears."""
        if parameter == "temperature":
            operating = self._alone.operating_at(value, self.bundle)
        else:
            values = np.array([value])
            operating = (
                replace(self.operating, speed=values)
                if parameter == "speed"
                else replace(self.operating, torque=values)
            )
        return replace(self, operating=operating)


@dataclass(frozen=True, eq=False)
class Subject:
    """A model of one lane, where its motion starts, and what its numbers mean in SI."""

    title: str
    model: Model
    simulation: Simulation
    scale: Scale
    gears: Gears | None = None

    @property
    def parameters(self) -> dict[str, float]:
        """The numbers of the equation, by name."""
        names = [f.name for f in fields(self.model)]
        values = {name: getattr(self.model, name) for name in names}
        return {name: float(v) for name, v in values.items() if isinstance(v, float | int)}

    def names(self) -> list[str]:
        """The parameters that :func:`family` knows."""
        own = list(self.parameters)
        return own + (list(GEAR_PARAMETERS) if self.gears is not None else [])


def of_numbers(numbers: Mapping[str, float], start: tuple[float, float] | None = None) -> Subject:
    """Plain dimensionless numbers, by their long names; b' defaults to 1 and eps_T to 0."""
    given = {"half_backlash": 1.0, "thermal_stiffness": 0.0, **numbers}
    missing = [short for short, name in SHORT.items() if name not in given]
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
    return Subject("Plain numbers", TorsionalModel(**given), simulation, Scale())


def of_case(
    case: Case,
    *,
    row: str | None = None,
    point: int = 1,
    operating: int = 1,
    bundle: str | None = None,
    state: str = "hot",
    numbers: Mapping[str, float] | None = None,
    start: tuple[float, float] | None = None,
) -> Subject:
    """One motion of a case: ``point`` of a ``row``, or ``operating`` point, bundle and state.

    Points count from 1 in the order of the file (speeds times torques, torque the fast one).
    ``numbers`` replace those of a dimensionless point. ``start`` replaces the case's (X, X').
    """
    simulation = case.simulation if start is None else replace(case.simulation, initial_state=start)
    if isinstance(case, DimensionlessCase):
        points = rows_of(case)[named("--row", row, list(rows_of(case)))]
        chosen = points[counted("--point", point, most=len(points))]
        given = {**chosen.model_arguments(), **(numbers or {})}
        require_numbers(given)
        model = TorsionalModel(**given)
        title = f"{case.title}: row {chosen.row}, point {point}"
        return Subject(title, model, simulation, Scale())
    case = gear_case(case)
    if numbers:
        raise InputError(
            f"--{next(s for s, name in SHORT.items() if name in numbers)}",
            "a number beside a gear case",
            why="the gears decide the numbers of their equation",
            fix="use --set, for instance --set dynamics.damping_ratio=0.1",
        )
    if state not in STATES:
        fix = '"cold" is now called "undeformed"' if state == "cold" else None
        raise InputError("--state", repr(state), allowed=" | ".join(STATES), fix=fix)
    names = [m.name for m in case.models]
    model_of = dict(zip(names, case.models, strict=True))[named("--bundle", bundle, names)]
    here = counted("--operating", operating, most=len(case.speeds) * len(case.torques))
    one = case.operating_of(model_of).point(here)
    if state == UNDEFORMED:
        one = one.as_drawn()
    gears = Gears(case, model_of, one, state)
    return _of_gears(gears, simulation)


def _of_gears(gears: Gears, simulation: Simulation) -> Subject:
    found = gears.excitation()
    rpm = gears.value("speed") / RPM
    title = (
        f"{gears.case.title}: {rpm:.6g} rpm, {gears.value('torque'):.6g} N m, "
        f"{gears.bundle.name}, {gears.state}"
    )
    scale = Scale(
        length=found.reference_half_backlash,
        rate=found.natural_frequency,
        mesh=found.mesh_frequency / (2.0 * np.pi),
    )
    return Subject(title, from_excitation(found), simulation, scale, gears)


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
    if name not in known:
        raise InputError(option, repr(name), allowed=" | ".join(known), fix=nearest(name, known))
    return name


def counted(option: str, number: int, *, most: int) -> int:
    """Place of the ``number``-th, counted from 1."""
    if not 1 <= number <= most:
        raise InputError(option, number, allowed=f"1..{most}")
    return number - 1


def parameter_name(subject: Subject, name: str) -> str:
    """The long name of ``name``, which may be a symbol of the equation."""
    full = SHORT.get(name, name.replace("-", "_"))
    if full not in subject.names():
        known = subject.names() + ([] if subject.gears else list(SHORT))
        raise InputError(
            "--parameter", repr(name), allowed=" | ".join(known), fix=nearest(name, known)
        )
    return full


def parameter_value(option: str, subject: Subject, parameter: str, text: str) -> float:
    """A value of ``parameter`` as SI; gear parameters are written with their unit.

    Refused, under the name of ``option``, where no case file could hold it.
    """
    gears = parameter in GEAR_PARAMETERS
    reader = gear_reader(parameter) if gears else dimensionless_reader(parameter)
    value = read_value(option, reader, text)
    numbers = subject.parameters | {parameter: value}
    if "stiffness_amplitude" in numbers:
        positive_stiffness(
            "stiffness_amplitude",
            numbers["stiffness_amplitude"],
            thermal=numbers["thermal_stiffness"],
        )
    return value


def family(subject: Subject, parameter: str) -> tuple[Family, float]:
    """value -> model along ``parameter``, and its present value; see :func:`parameter_name`."""
    gears = subject.gears
    if gears is None or parameter not in GEAR_PARAMETERS:
        return family_of(subject.model, parameter)

    if parameter == "temperature" and gears.state == UNDEFORMED:
        raise InputError(
            "--state",
            f"{UNDEFORMED}, with a temperature to vary",
            why="that is everything at the reference temperature",
            fix="use --state hot and --from '20 degC'",
        )
    here = gears.excitation()

    @lru_cache(maxsize=256)
    def models(value: float) -> DeadZoneModel:
        if parameter == "speed":
            # temperatures are given: neither springs nor backlash know the speed
            turning = replace(here, mesh_frequency=gears.case.pair.pinion.teeth * value)
            return from_excitation(turning)
        return from_excitation(gears.at(parameter, value).excitation())

    return models, gears.value(parameter)


def shown_value(parameter: str, value: float) -> tuple[float, str]:
    """The value as a gear engineer reads it, and its unit."""
    if parameter == "speed":
        return value * 30.0 / float(np.pi), "rpm"
    if parameter == "torque":
        return value, "N m"
    if parameter == "temperature":
        return value - ZERO_CELSIUS, "°C"
    return value, ""
