"""A case: the file read, checked and turned into frozen SI dataclasses.

Read it with :func:`load_case`; a ready-made one with :func:`load_example`. What leaves knows
nothing of TOML, texts or units any more.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from pydantic import ValidationError

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.excitation import Periodic
from thermogear.base.materials import MATERIALS, Material
from thermogear.base.parameters import NUMBERS
from thermogear.base.period import Period
from thermogear.base.toml import overridden, pairs, tables
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.case import build as parts
from thermogear.case.allowed import gear_parameter, gear_reader
from thermogear.case.assumptions import LEFT, Assumption, assumptions
from thermogear.case.backlash import Backlash
from thermogear.case.base import Case, Simulation
from thermogear.case.build import TemperatureRule
from thermogear.case.charts import Chart, charts, enclosed
from thermogear.case.dimensionless import Point, points_of
from thermogear.case.dimensionless_schema import DimensionlessFile
from thermogear.case.examples import example_text
from thermogear.case.fault_schema import FaultTable
from thermogear.case.faults import fault_words, whole_turn
from thermogear.case.flanks import (
    accuracy,
    all_deviations,
    deviations,
    first_tooth,
    population,
    require_meshing,
    series,
    unmeasured,
    without_effect,
)
from thermogear.case.gearbox import Reading, gearbox, heated
from thermogear.case.ranges import in_proportion, warn_of_temperatures, warn_of_torque
from thermogear.case.refusals import complaints, together
from thermogear.case.schema import OF_BUNDLE, PICTURES, GearFile
from thermogear.case.sensor_schema import SensorsTable
from thermogear.case.shaft_plan import TrainPlan
from thermogear.case.shafts import train_plan
from thermogear.case.source import case_text, folder_of
from thermogear.case.units import shown
from thermogear.gears.accuracy import flank_class
from thermogear.gears.deviations import Deviation
from thermogear.gears.pair import GearPair
from thermogear.gears.population import Population, measured
from thermogear.gears.turn import turn_period
from thermogear.heat.gearbox import Surroundings, fluid_from
from thermogear.mesh.balance import Gearbox, HeatBalance, heat_balance
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import ALIKE, Operating, Temperatures, Varied


def decided(
    pair: GearPair,
    backlash: Backlash,
    around: Surroundings,
    accuracy: int | None,
    graded: list[str],
) -> dict[str, str]:
    """Field -> the value that replaces it, with its unit."""
    found = {
        "gears.centre_distance": shown(pair.centre_distance, "length"),
        "backlash.value": f"{shown(2.0 * backlash.half, 'length')}, total, normal",
    }
    known = "" if accuracy is None else f"{accuracy}, {' and '.join(graded)}"
    found["flanks.accuracy"] = known or "none acts: nominal flanks, or gears beyond ISO 1328-1"
    found |= {
        "gearbox.housing_area": shown(around.housing_area, "area", 3),
        "gearbox.housing_coefficient": shown(
            around.housing_coefficient, "heat transfer coefficient"
        ),
        "gearbox.housing_mass": shown(around.housing_mass, "mass", 3),
        "gearbox.oil_mass": shown(around.oil_mass, "mass", 3),
        "gearbox.housing_specific_heat": shown(around.housing_specific_heat, "specific heat"),
    }
    if around.train is not None:
        drawn = "none: the shafts are drawn"
        found |= {"gearbox.shaft_length": drawn, "gearbox.bearing_conductance": drawn}
        if all(one.size is not None for one in around.train.bearings):
            found["gearbox.bearing_coefficient"] = "none: the bearings have laws of their own"
    for name, gear in (("pinion", pair.pinion), ("wheel", pair.wheel)):
        found |= {
            f"gears.{name}.{field}": shown(value, "length")
            for field, value in (
                ("face_width", gear.face_width),
                ("bore_radius", gear.bore_radius),
                ("tip_diameter", 2.0 * gear.tip_radius),
            )
        }
    return found


__all__ = [
    "PICTURES",
    "Assumption",
    "Backlash",
    "DimensionlessCase",
    "GearCase",
    "Point",
    "TemperatureRule",
    "load_case",
    "load_example",
]

MOST_POINTS = 1_000_000
"""Speeds times torques, at most."""


@dataclass(frozen=True, kw_only=True, repr=False)
class GearCase(Case):
    """A gear pair with its operating points, from friction to vibration (SI, K, rad).

    ``stated`` holds every speed with every torque, the speed the slow axis, in the hot state;
    where the temperatures are left out (``computed``) it is all at the reference temperature, and
    :meth:`operating_of` computes the hot state from the heat balance of ``gearbox``.
    ``gear_temperatures`` [K] is the row of addendum temperatures of both gears; ``follow`` says how
    the other temperatures go along with it (:data:`~thermogear.case.fields.FOLLOW`).
    ``deviations`` of the flanks, their ``accuracy`` class where they follow from one, the
    ``series``: how many parts of it the answers are of (1: the part of the case alone), the
    ``charts`` they were measured in; ``readings`` of thermometers; ``sensors`` that watch a
    warm-up; ``train`` of shafts, if drawn; ``scuffing_load_stage`` of the oil in the FZG test, None
    where unknown. ``inertias`` [kg m^2]; ``transmission_error`` the kinematic one [m] over the mesh
    phase; ``models`` the bundles to compute with. ``data``: the tables of the file with the
    overrides in them, ``file``: what was read in them.
    """

    kind = "gear"
    pair: GearPair
    stated: Operating
    temperature_rule: TemperatureRule | None
    gear_temperatures: tuple[float, ...]
    inertias: tuple[float, float]
    inertia_kind: str
    damping_ratio: float
    transmission_error: Periodic
    cold_backlash: Backlash
    models: tuple[MeshModel, ...]
    speeds: tuple[float, ...]
    torques: tuple[float, ...]
    harmonics: int
    mesh_positions: int
    path_positions: int
    pictures: tuple[str, ...] = PICTURES
    base_sets: tuple[str, ...] = ()
    deviations: tuple[Deviation, ...] = ()
    accuracy: int | None = None
    series: int = 1
    charts: tuple[Chart, ...] = ()
    gearbox: Gearbox = field(default_factory=Gearbox)
    readings: tuple[Reading, ...] = ()
    sensors: SensorsTable = field(default_factory=SensorsTable)
    train: TrainPlan | None = None
    scuffing_load_stage: float | None = None
    computed: bool = False
    follow: str = "proportional"
    file: GearFile = field(repr=False, compare=False)
    data: dict[str, Any] = field(repr=False, compare=False, default_factory=dict)
    _balances: dict[tuple[MeshModel, bytes | None], HeatBalance] = field(
        init=False, repr=False, compare=False, default_factory=dict
    )

    @property
    def figures(self) -> dict[str, str]:
        """What the case is, in a few values with their units by name."""
        pair = self.pair
        return {
            "teeth": f"{pair.pinion.teeth}:{pair.wheel.teeth}",
            "module": shown(pair.pinion.module, "length", 4),
            "centre distance": shown(pair.centre_distance, "length", 6),
            "contact ratio": f"{pair.contact_ratio:.4g}",
            "speed": ", ".join(f"{speed / RPM:.6g} rpm" for speed in self.speeds),
            "torque": ", ".join(f"{torque:.6g} N m" for torque in self.torques),
            "shafts": "none" if self.train is None else "two, on bearings",
            "faults": "; ".join(self.all_faults) or "none",
            "assumptions": f"{len(self.assumptions)}, see `thermogear check`",
        }

    def with_values(self, values: Mapping[str, float], *, told: bool = True) -> GearCase:
        """The case with numbers put to other SI ``values``, no text read again.

        The names are those of :data:`~thermogear.base.parameters.GEARS` or dotted fields of the
        file. The same as :func:`load_case` with these values as overrides, which are in its
        ``overrides``. ``told`` as in :func:`case_of`. Raises InputError for an unknown field, and
        where no case file could hold a value.
        """
        changes = tuple(
            (place, text) for name, value in values.items() for place, text in _written(name, value)
        )
        data = overridden(self.data, changes)
        kept = tuple(pair for pair in self.overrides if pair[0] not in dict(changes))
        return gear_case(case_of(data, self.text, (*kept, *changes), told=told))

    @cached_property
    def period(self) -> Period:
        """After how many mesh periods the deviations come again."""
        return turn_period(self.pair, self.deviations)

    @cached_property
    def all_deviations(self) -> tuple[Deviation, ...]:
        """Those of the whole turn and of all flanks, whatever period and part are taken."""
        whole = (self.file.gears.period, self.file.gears.part) == ("turn", "case")
        return self.deviations if whole else all_deviations(self.file, self.pair, self.charts)

    @property
    def population(self) -> Population:
        """How the gears of a class differ."""
        return population(self.file)

    @property
    def seed(self) -> int:
        """The seed of flanks that are drawn."""
        return 1 if self.file.flanks is None else self.file.flanks.seed

    @property
    def dampings(self) -> tuple[float, ...]:
        """Damping ratios [-] of a series: the case's own first, then two others or none."""
        return self.file.dynamics.dampings

    def tooth_number(self, gear: str, place: int) -> int:
        """The number, from 1, in the file of the ``place``-th tooth, from 0, that meshes."""
        teeth = (self.pair.pinion if gear == "pinion" else self.pair.wheel).teeth
        return (first_tooth(self.file, gear) + place) % teeth + 1

    def faults(self) -> list[str]:
        """The faults that act in this case, in words.

        A mean tooth has no fault of one tooth, nominal flanks have none at all.
        """
        gears = self.file.gears
        return [
            fault_words(fault)
            for fault in self._acting
            if gears.part == "case" and not (whole_turn(fault) and gears.period == "mesh")
        ]

    @property
    def all_faults(self) -> list[str]:
        """Every fault that the file states, in words; one of no size is none."""
        return [fault_words(fault) for fault in self._acting]

    @property
    def _acting(self) -> list[FaultTable]:
        return [fault for fault in self.file.faults if fault.acts]

    def sound(self) -> GearCase:
        """The case without its faults; the case itself where it has none."""
        return self._with("faults", "[]") if self.file.faults else self

    def mean_tooth(self) -> GearCase:
        """The case over one mesh period, with the deviations that all teeth share.

        It stays so in whatever is read from its tables and overrides; the case itself where its
        period is one mesh.
        """
        return self if self.period.mesh_periods == 1 else self._with("gears.period", "mesh")

    def unless_stated(self, field: str, value: str) -> GearCase:
        """The case with ``gears.period`` or ``gears.part`` put to what a study takes by itself.

        The case as it is where its file or an option states the field, or nothing would change.
        """
        same = field == "period" and self.period.mesh_periods == 1
        if same or not self.deviations or field in self.file.gears.model_fields_set:
            return self
        return self._with(f"gears.{field}", value)

    def over_speeds(self) -> GearCase:
        """The case as run-ups and sweeps take it: over one mesh period unless it states otherwise.

        Over the turn with a fault of one tooth, which is stated to be seen.
        """
        faulty = any(whole_turn(fault) for fault in self._acting)
        return self if faulty else self.unless_stated("period", "mesh")

    def assemblies(self) -> tuple[GearCase, ...]:
        """The case put together in every way that makes a difference, its own marks first.

        gcd(z1, z2) ways where the teeth of both gears differ; one else: all teeth meet anyhow.
        """
        first = self.tooth_number("pinion", 0)
        marks = [f"[{first}, {self.tooth_number('wheel', k)}]" for k in range(self.assembly_count)]
        return (self, *(self._with("gears.marks", one) for one in marks[1:]))

    @property
    def assembly_count(self) -> int:
        """How many assemblies of the gears differ."""
        teeth = (self.pair.pinion.teeth, self.pair.wheel.teeth)
        return math.gcd(*teeth) if "hunting_tooth" in self.period.orders else 1

    def _with(self, field: str, value: str) -> GearCase:
        """The case with a field put to the ``value`` that a file would hold."""
        changes = (*(pair for pair in self.overrides if pair[0] != field), (field, value))
        made = case_of(overridden(self.data, ((field, value),)), self.text, changes, told=False)
        kept = tuple(one for one in self.assumptions if one.field != field)
        return replace(gear_case(made), assumptions=kept)

    @cached_property
    def turn_class(self) -> int | None:
        """The worse class of ISO 1328-1:2013 of both gears as they are over a turn.

        Of the drive flanks about the bore, all deviations in it; None where one has none.
        """
        grades = [
            flank_class(
                gear.teeth, gear.module, rounded=False,
                figures=measured(self.pair, name, self.deviations, "drive"),
            )
            for name, gear in (("pinion", self.pair.pinion), ("wheel", self.pair.wheel))
        ]  # fmt: skip
        return None if None in grades else max(filter(None, grades))

    @property
    def measured_class(self) -> int | None:
        """The worst class of ISO 1328-1:2013 of measured drive flanks; None where none has one."""
        flanks = [one for chart in self.charts for one in chart.flanks if one.flank == "drive"]
        return max((grade for one in flanks for grade in one.grades if grade), default=None)

    @property
    def housing(self) -> Material:
        """The material of the housing."""
        return self.stated.housing

    @property
    def operating(self) -> Operating:
        """The hot state of every operating point, by the first model where it is computed."""
        return self.operating_of(self.models[0])

    def operating_of(self, model: MeshModel) -> Operating:
        """The hot state of every operating point under ``model``."""
        return self.balance(model).operating if self.computed else self.stated

    def cycle(
        self, operating: Operating, model: MeshModel, path_positions: int | None = None
    ) -> Dataset:
        """The mesh cycle at ``operating`` under ``model``: the case's housing, flanks and grids.

        ``path_positions`` replaces the case's number along the path of contact.
        """
        return mesh_cycle(
            self.pair,
            replace(operating, housing=self.housing),
            model,
            deviations=self.deviations,
            path_positions=path_positions or self.path_positions,
            mesh_positions=self.mesh_positions,
        )

    def balance(
        self,
        model: MeshModel,
        gear_temperature: ArrayLike | None = None,
        *,
        from_hot: bool = True,
    ) -> HeatBalance:
        """The heat balance of every operating point, computed once.

        ``gear_temperature`` [K] holds the teeth of both gears there; ``from_hot`` seeks a second
        steady state too, as the first call says.
        """
        held = None if gear_temperature is None else np.asarray(gear_temperature, dtype=float)
        key = (model, None if held is None else held.tobytes())
        if key not in self._balances:
            at, box = self.stated, self.gearbox
            if held is not None:
                teeth = dict.fromkeys(("pinion_tooth", "wheel_tooth"), held)
                box = replace(box, measured={**box.measured, **teeth})
            try:
                self._balances[key] = self.balance_of(
                    model,
                    at.speed,
                    at.torque,
                    gearbox=box,
                    varied=at.varied,
                    from_hot=from_hot,
                )
            except InputError as error:
                if error.field != "prandtl":
                    raise
                least = fluid_from(at.lubricant) - ZERO_CELSIUS
                oil, got = "oil", f"a Prandtl number of {error.got}"
                if "oil" in self.gearbox.measured:
                    kelvin = np.ravel(self.gearbox.measured["oil"]).min()
                    oil, got = "oil.temperature", f"{kelvin - ZERO_CELSIUS:.5g} °C"
                raise InputError(
                    oil,
                    got,
                    allowed=f"this oil from {least:.1f} °C on",
                    why="so cold the oil is too stiff for the laws of convection",
                    fix="take a warmer, or a thinner, oil",
                ) from error
        return self._balances[key]

    def balance_of(
        self,
        model: MeshModel,
        speed: ArrayLike,
        torque: ArrayLike,
        *,
        gearbox: Gearbox | None = None,
        varied: Varied = ALIKE,
        from_hot: bool = True,
    ) -> HeatBalance:
        """The heat balance at other points: ``speed`` [rad/s] and ``torque`` [N m], (operating,).

        ``gearbox`` in place of the case's own; ``varied`` of the pair at these points;
        ``from_hot`` seeks a second steady state too.
        """
        at = self.stated
        return heat_balance(
            self.pair,
            speed,
            torque,
            at.lubricant,
            at.half_backlash,
            model,
            varied=varied,
            gearbox=gearbox or self.gearbox,
            reference=at.temperatures.reference,
            housing=at.housing,
            deviations=self.deviations,
            from_hot=from_hot,
        )

    @property
    def equivalent_mass(self) -> float:
        """m_e = I1 I2/(I1 r_b2^2 + I2 r_b1^2) [kg]."""
        (i1, i2), r1, r2 = self.inertias, self.pair.pinion.base_radius, self.pair.wheel.base_radius
        return i1 * i2 / (i1 * r2**2 + i2 * r1**2)

    def operating_at(
        self, gear_temperature: ArrayLike, model: MeshModel | None = None
    ) -> Operating:
        """The operating points with both addenda at ``gear_temperature`` [K], one or for each.

        ``follow`` "proportional": every excess over the drawing temperature keeps its proportion
        to the gears' in the hot state under ``model`` (default: the first), so that at the drawing
        temperature all is as it is drawn. "fixed": distances in kelvins and temperatures given
        outright stay, and the heat balance computes what is left out. Raises InputError where a
        body or the oil would leave the range of a case file.
        """
        chosen = model or self.models[0]
        if self.follow == "proportional":
            return in_proportion(self.operating_of(chosen), gear_temperature)
        if self.temperature_rule is None:
            return self.balance(chosen, gear_temperature).operating
        return replace(
            self.stated,
            oil_temperature=self.temperature_rule.oil_at(gear_temperature),
            temperatures=self.temperature_rule.at(
                pinion_addendum=gear_temperature, wheel_addendum=gear_temperature
            ),
        )


@dataclass(frozen=True, kw_only=True, repr=False)
class DimensionlessCase(Case):
    """Rows of points of the dimensionless equation; they come from no gear.

    ``base``: the numbers that the rows start from, one or several of each.
    """

    kind = "dimensionless"
    points: tuple[Point, ...]
    base: Mapping[str, tuple[float, ...]]

    @property
    def figures(self) -> dict[str, str]:
        """The numbers that its rows start from, and how many points they have."""
        base = {name: ", ".join(f"{value:g}" for value in row) for name, row in self.base.items()}
        return base | {"points": str(len(self.points))}


def _written(name: str, value: float) -> tuple[tuple[str, str], ...]:
    """The fields of a parameter with its SI ``value`` as a file holds it."""
    one, text = gear_parameter(name), str(gear_reader(name).written(float(value)))
    if one.name == "cold_half_backlash":  # whatever kind the file gives
        return (("backlash", f'{{value = "{text}", direction = "normal", extent = "half"}}'),)
    return tuple((place, text) for place in one.fields)


def load_case(
    source: str | Path,
    overrides: Mapping[str, str] | Sequence[str] = (),
    *,
    folder: Path | None = None,
) -> GearCase | DimensionlessCase:
    """The case in the file ``source``, or in the text itself, with ``overrides`` put in.

    Files that it names count from ``folder`` (default: where the case file is, of a text the
    working directory) and are in its ``text`` afterwards.

    ``overrides`` map dotted fields to values as a file would hold them, or are texts
    ``"gears.pinion.teeth=30"``. Raises :class:`InputError` in one line; warns with
    :class:`ValidityWarning` where a value leaves the range of its data.

    >>> load_case("rig").pair.pinion.teeth
    25
    """
    name, text = case_text(source)
    changes = pairs(overrides)
    data = overridden(tables(name, text), changes)
    try:
        text = enclosed(text, data, folder or folder_of(source))
    except InputError as error:
        raise together([error], text, changes) from error
    return case_of(data, text, changes)


def case_of(
    data: dict[str, Any], text: str, changes: tuple[tuple[str, str], ...], *, told: bool = True
) -> GearCase | DimensionlessCase:
    """The case of a file's tables ``data``, with ``changes`` in them; ``text`` as it was read.

    ``told`` False leaves out its assumptions and warnings, for a case that nobody sees.
    """
    kind = data.get("kind", "gear")
    file = DimensionlessFile if kind == "dimensionless" else GearFile
    try:
        read: GearFile | DimensionlessFile = file.model_validate(data)
    except ValidationError as error:
        raise together(
            [*complaints(error, file), *parts.unknown_names(data)], text, changes
        ) from error
    common: dict[str, Any] = {
        "title": read.title or _named(read),
        "text": text,
        "simulation": Simulation(**read.simulation.model_dump()),
        "overrides": changes,
    }
    if isinstance(read, DimensionlessFile):
        base = {name: tuple(getattr(read.base, name)) for name in NUMBERS}
        found = assumptions(data, read)
        return DimensionlessCase(points=points_of(read), base=base, assumptions=found, **common)
    try:
        case = _gear_case(read, common | {"data": data})
        if told:  # where backlash or errors are varied a jam is a result
            require_meshing(read, case.pair, case.deviations, 2.0 * case.cold_backlash.half)
            _warn_of(case)
    except InputError as error:
        others = [one for one in parts.faults(read) if str(one) != str(error)]
        raise together([error, *others], text, changes) from error
    if not told:
        return case
    found = assumptions(data, read, _decided(case))
    if case.assembly_count > 1 and read.gears.marks is None:
        found += (
            Assumption(
                "gears.marks",
                "1, 1",
                f"{LEFT}tooth 1 meets tooth 1 at mesh phase 0. One of "
                f"{case.assembly_count} assemblies; decides which errors meet",
            ),
        )
    one_part = case.series == 1
    drawn = read.flanks is not None and read.flanks.teeth == "drawn"
    unused = {
        "flanks.parts": one_part,
        "flanks.population": one_part and not drawn,
        "dynamics.damping_ratio_least": one_part or len(case.dampings) == 1,
        "dynamics.damping_ratio_most": one_part or len(case.dampings) == 1,
    }
    found = tuple(each for each in found if not unused.get(each.field))
    if read.gears.face_width is not None:  # one for both is no default of each
        found = tuple(one for one in found if not one.field.endswith(".face_width"))
    if "bundle" in read.model.model_fields_set:  # who names a bundle names its choices
        found = tuple(one for one in found if not one.default.startswith(OF_BUNDLE))
    return replace(case, assumptions=found)


def _decided(case: GearCase) -> dict[str, str]:
    around = case.gearbox.surroundings
    graded = unmeasured(case.file)
    found = decided(case.pair, case.cold_backlash, around, case.accuracy, graded)
    choices = [model.choices() for model in case.models]
    found |= {
        f"model.{name}": " and ".join(dict.fromkeys(str(one[name]) for one in choices))
        for name in choices[0]
    }
    if case.series > 1:
        found["flanks.parts"] = str(case.series)
        found["flanks.population"] = "ours"
    if len(case.charts) == 2:
        found["flanks.accuracy"] = found["flanks.seed"] = "none: both gears are measured"
    return found


def _named(file: GearFile | DimensionlessFile) -> str:
    """A title for a case without one."""
    if isinstance(file, DimensionlessFile):
        return "Dimensionless case"
    gears = file.gears
    return (
        f"Gear pair {gears.pinion.teeth}:{gears.wheel.teeth}, "
        f"module {shown(gears.module, 'length')}"
    )


def gear_case(case: object) -> GearCase:
    """``case`` itself if it has gears; InputError otherwise."""
    if isinstance(case, GearCase):
        return case
    raise InputError(
        "case",
        f"kind = {getattr(case, 'kind', type(case).__name__)!r}",
        allowed="kind = 'gear'",
        why="there is no gear in it",
    )


def load_example(
    name: str, overrides: Mapping[str, str] | Sequence[str] = ()
) -> GearCase | DimensionlessCase:
    """The ready-made case ``name``; an unknown name says the nearest."""
    return load_case(example_text(name), overrides)


def _gear_case(file: GearFile, common: dict[str, Any]) -> GearCase:
    materials = MATERIALS | parts.own_materials(file)
    housing = parts.named_material(file.housing.material, "housing.material", materials)
    pair = parts.pair_of(file, materials, common["data"])
    rule = parts.temperature_rule(file)
    given = file.temperatures
    if rule is None or given.pinion_addendum is None or given.wheel_addendum is None:
        cold = given.reference
        temperatures = Temperatures.uniform(cold, reference=cold)
        oil: ArrayLike = file.oil.temperature or cold
    else:
        temperatures = rule.at(
            pinion_addendum=given.pinion_addendum, wheel_addendum=given.wheel_addendum
        )
        oil = rule.oil_at(given.pinion_addendum)
    box, readings = gearbox(file, pair, housing)
    backlash = parts.cold_backlash(file, pair, housing)
    speeds, torques = file.operating.speed, file.operating.torque
    count = len(speeds) * len(torques)
    if count > MOST_POINTS:
        raise InputError(
            "operating",
            f"{len(speeds)} speeds x {len(torques)} torques = {count} points",
            allowed=f"1..{MOST_POINTS} points",
            fix="split the case",
        )
    inertias, inertia_kind = parts.inertias(file, pair)
    train = train_plan(file, pair, materials, inertias)
    if train is not None:
        box = heated(file, pair, box, train, housing)
    measured, models = charts(file, pair), parts.models(file, pair)
    grade = None if file.gears.part == "nominal" else accuracy(file, pair)
    return GearCase(
        pair=pair,
        stated=Operating(
            speed=np.repeat(speeds, len(torques)),
            torque=np.tile(torques, len(speeds)),
            lubricant=parts.lubricant(file),
            oil_temperature=oil,
            temperatures=temperatures,
            half_backlash=backlash.half,
            housing=housing,
        ),
        temperature_rule=rule,
        gear_temperatures=file.temperatures.row,
        inertias=inertias,
        inertia_kind=inertia_kind,
        damping_ratio=file.dynamics.damping_ratio,
        transmission_error=parts.transmission_error(file),
        cold_backlash=backlash,
        models=models,
        speeds=speeds,
        torques=torques,
        harmonics=file.grid.harmonics,
        mesh_positions=file.grid.mesh_positions,
        path_positions=file.grid.path_positions,
        pictures=file.draw.pictures,
        base_sets=file.draw.base_sets,
        deviations=deviations(file, pair, measured),
        accuracy=grade,
        series=series(file, grade, loaded=models[0].stiffness == "loaded"),
        charts=measured,
        gearbox=box,
        readings=readings,
        sensors=file.sensors or SensorsTable(),
        train=train,
        scuffing_load_stage=file.oil.scuffing_load_stage,
        computed=rule is None,
        follow=given.follow,
        file=file,
        **common,
    )


def _warn_of(case: GearCase) -> None:
    """Warn where the case leaves the range of its data, and of fields without effect."""
    for stated, why in without_effect(case.file, case.pair, case.all_deviations):
        warnings.warn(f"{stated} has no effect: {why}; leave it out", ValidityWarning, stacklevel=4)
    warn_of_torque(case.pair, case.torques)
    if not case.computed:
        warn_of_temperatures(case.pair, {"temperatures": case.stated} | _row_of(case))


def _row_of(case: GearCase) -> dict[str, Operating]:
    """The operating points of every temperature of the row by its field, where it is drawn."""
    found = {}
    for place, temperature in enumerate(case.gear_temperatures):
        field = f"temperatures.row[{place}]"
        if "temperature" in case.pictures:
            try:
                found[field] = case.operating_at(temperature)
            except InputError as error:
                raise error.named(field) from error
    return found
