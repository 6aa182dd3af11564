"""A case and what it amounts to, as a REXS model.

Every number is in the unit of REXS; the whole case is kept in ``custom_thermogear_case`` beside the
values that an import reads, so that it gives the same case and sees what another program changed.
"""

from __future__ import annotations

import json
import math
import warnings
from typing import Any

import numpy as np

from thermogear import __version__
from thermogear.base.display import kind_in_words
from thermogear.base.errors import InputError, ThermogearError, ValidityWarning
from thermogear.base.materials import Material
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import CASE, MEANINGS, OURS, Reader, from_si, spelled
from thermogear.case.rexs.model import (
    MOST_LOAD_CASES,
    Attribute,
    Component,
    LoadCase,
    Model,
    Relation,
    numbers,
)
from thermogear.case.rexs.values import values
from thermogear.case.thermal_state import HOT
from thermogear.gears.deviations import Relief, active_profile
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.heat.lubrication import kinematic_viscosity

WRITTEN = ("1.4", "1.5", "1.6", "1.7", "2.0.0")
"""Versions that are written."""
_UNIT, _CASING, _STAGE, _OIL = 1, 2, 3, 4
_SHAFTS, _GEARS, _DATA, _LOADS = (11, 12), (21, 22), (31, 32), (41, 42)
_TOOLS, _MATERIALS = (51, 52), (61, 62)
_FLANKS = ((71, 72), (73, 74))
_RELIEFS = 81
_KINDS = ("tip_relief", "root_relief")
_NAMES = ("pinion", "wheel")
_CLASS = "tolerance_class_according_to_iso_1328_2013"


def model_of_case(case: GearCase, version: str = "1.7", *, results: bool = True) -> Model:
    """The REXS model of a case with quasi-static ``results`` by its first model of the mesh."""
    if version not in WRITTEN:
        raise InputError("REXS version", repr(version), allowed=" | ".join(WRITTEN))
    points = case.stated.speed.size
    if points > MOST_LOAD_CASES:
        raise InputError(
            "operating",
            f"{points} points",
            allowed=f"1..{MOST_LOAD_CASES} load cases",
            fix="split the case, or --set operating.speed=...",
        )
    maker = _Maker(case, version)
    return maker.made(maker.computed() if results else None)


NAMELESS = (
    "shafts", "bearings", "discs", "inertia", "dynamics", "transmission_error", "gearbox",
    "housing", "sensors", "model",
)  # fmt: skip
"""Tables of a case that REXS has no names for."""


def kept_alone(case: GearCase) -> list[str]:
    """What of a case its REXS model has in ``custom_thermogear_case`` alone.

    Other programs do not see it: flanks that differ, but for reliefs and a class, and how the teeth
    meet; tables of :data:`NAMELESS` that it states.
    """
    known: tuple[type, ...] = (Relief,) if case.accuracy is None else (Relief, WavyProfile)
    kinds = {kind_in_words(d) for d in case.all_deviations if not isinstance(d, known)}
    marks = ["marks"] * (case.file.gears.marks is not None)
    return [*sorted(kinds), *marks, *(name for name in NAMELESS if name in case.data)]


class _Maker:
    """A model in the making."""

    def __init__(self, case: GearCase, version: str) -> None:
        self.case, self.version = case, version
        self.model = Model(version, f"thermogear {__version__}", "")

    # --- pieces ---------------------------------------------------------------------------
    def numbers(self, **si: float) -> list[Attribute]:
        """Numbers by their names in REXS 1.x, each in the unit of REXS."""
        after = numbers(self.version)
        both = {name: from_si(float(size), MEANINGS[name], after) for name, size in si.items()}
        return [
            Attribute(spelled(name, self.version), unit, value)
            for name, (value, unit) in both.items()
        ]

    def add(
        self, ident: int, kind: str, name: str, /, *attributes: Attribute, **values: Any
    ) -> None:
        """A component of attributes and, by their names, ``values`` without a unit."""
        every = [*attributes, *(Attribute(key, "none", value) for key, value in values.items())]
        self.model.add(Component(ident, kind, name, {row.id: row for row in every}))

    def relate(self, kind: str, order: int | None = None, **refs: int) -> None:
        """A relation with the next id; references by their roles."""
        ident = len(self.model.relations) + 1
        self.model.relate(Relation(ident, kind, order, tuple(refs.items())))

    # --- the whole ------------------------------------------------------------------------
    def made(self, computed: tuple[Any, Any] | None) -> Model:
        """Components, relations, load cases with what is ``computed``, and the case itself."""
        case, pair = self.case, self.case.pair
        self.add(_UNIT, "gear_unit", case.title)
        self.add(_CASING, "gear_casing", "housing")
        lengths = self.numbers(
            center_distance=pair.centre_distance,
            minimum_normal_backlash=2.0 * case.cold_backlash.least,
            maximum_normal_backlash=2.0 * case.cold_backlash.most,
        )
        self.add(_STAGE, "cylindrical_stage", "", *lengths)
        for part in (_CASING, _STAGE):
            self.relate("assembly", assembly=_UNIT, part=part)
        self.relate("stage", stage=_STAGE, gear_1=_GEARS[0], gear_2=_GEARS[1])
        for place, gear in enumerate((pair.pinion, pair.wheel)):
            self._shaft(place)
            self._gear(place, gear)
        self._oil()
        self._loads(computed)
        stage = gearbox.stages(self.model)[0]
        kept = {
            "text": case.text,
            "overrides": [list(one) for one in case.overrides],
            "values": [[*key, value] for key, value in values(Reader(self.model), stage).items()],
        }
        stage.component.attributes[CASE] = Attribute(CASE, "none", json.dumps(kept))
        return self.model

    def _shaft(self, place: int) -> None:
        name, shaft, driving = _NAMES[place], _SHAFTS[place], place == 0
        apart = 1e3 * self.case.pair.centre_distance if place else 0.0
        self.add(
            shaft,
            "shaft",
            name,
            Attribute("support_vector", "mm", [0.0, 0.0, apart]),
            Attribute("u_axis_vector", "mm", [1.0, 0.0, 0.0]),
            Attribute("w_axis_vector", "mm", [0.0, 0.0, 1.0]),
            reference_component_for_position=_UNIT,
            defines_speed=driving,
        )
        load = {"defines_torque": driving, "transmits_torque": True}
        self.add(_LOADS[place], "external_load", ("input", "output")[place], **load)
        self.add(_DATA[place], "cylindrical_stage_gear_data", name, is_driving_gear=driving)
        for whole, part in ((_UNIT, shaft), (shaft, _LOADS[place]), (shaft, _GEARS[place])):
            self.relate("assembly", assembly=whole, part=part)
        data = {"stage": _STAGE, "gear": _GEARS[place], "stage_gear_data": _DATA[place]}
        self.relate("stage_gear_data", **data)

    def _gear(self, place: int, gear: Gear) -> None:
        name, ident, table = _NAMES[place], _GEARS[place], self.case.file.flanks
        grade: dict[str, Any] = {}
        if self.case.accuracy is not None and table is not None and table.edition == "2013":
            grade[spelled(_CLASS, self.version)] = int(self.case.accuracy)
        sizes = self.numbers(
            normal_module=gear.module,
            face_width=gear.face_width,
            tip_diameter=2.0 * gear.tip_radius,
            root_diameter=2.0 * gear.root_radius,
            arithmetic_average_roughness_flank=gear.roughness,
            helix_angle_reference_diameter=0.0,
            **(
                {"tip_form_diameter": 2.0 * gear.tip_form_radius}
                if gear.tip_form_radius < gear.tip_radius
                else {}
            ),
        )
        self.add(ident, "cylindrical_gear", name, *sizes, number_of_teeth=int(gear.teeth), **grade)
        self._material(place, gear.material)
        rack = self.numbers(
            normal_module=gear.module,
            addendum_coefficient_reference_profile=gear.rack.dedendum,
            tip_radius_factor=gear.rack.fillet_radius,
        )
        self.add(_TOOLS[place], "rack_shaped_tool", f"hob of the {name}", *rack)
        involute = self.numbers(
            normal_pressure_angle=gear.pressure_angle,
            addendum_modification_coefficient=gear.profile_shift,
            **({"tooth_tip_chamfer": gear.tip_chamfer} if gear.tip_chamfer > 0.0 else {}),
        )
        left, right = _FLANKS[place]
        self.relate("flank", gear=ident, left=left, right=right)
        for flank in (left, right):
            self.add(flank, "cylindrical_gear_flank", "", *involute)
            self.relate("manufacturing_step", 1, workpiece=flank, tool=_TOOLS[place])
        self._reliefs(place, gear)

    def _reliefs(self, place: int, gear: Gear) -> None:
        """The pinion turns about +u: its right flanks lead and carry, and those of the wheel."""
        left, right = _FLANKS[place]
        for one in self.case.deviations:
            if not isinstance(one, Relief) or one.gear != _NAMES[place]:
                continue
            limit, start = _relief_ends(self.case, gear, one)
            ident, kind = _RELIEFS + len(self.model.of_type(*_KINDS)), f"{one.end}_relief"
            sizes = {
                f"{kind}_depth": one.amount,
                f"{kind}_datum_diameter": start,
                f"{kind}_evaluation_reference": limit,
            }
            name = f"{one.end} relief of the {one.gear}"
            self.add(ident, kind, name, *self.numbers(**sizes), shape_of_relief=one.shape)
            for flank in {"drive": (right,), "back": (left,)}.get(one.flank, (left, right)):
                self.relate("reference", origin=flank, referenced=ident)

    def _material(self, place: int, material: Material) -> None:
        """One material for both gears where it is the same."""
        ident = _MATERIALS[0 if material == self.case.pair.pinion.material else place]
        constants = self.numbers(
            elastic_modulus=material.youngs_modulus,
            poisson_ratio=material.poisson_ratio,
            density=material.density,
            thermal_conductivity=material.thermal_conductivity,
            thermal_capacity=material.specific_heat,
            thermal_expansion_coefficient_plus=material.thermal_expansion,
        )
        if ident not in self.model.components:
            self.add(
                ident, "material", material.name, *constants, material_designation=material.name
            )
        self.relate("reference", origin=_GEARS[place], referenced=ident)

    def _oil(self) -> None:
        oil = self.case.stated.lubricant
        cold, hot = kinematic_viscosity(oil.part(0), ZERO_CELSIUS + np.array([40.0, 100.0]))
        constants = self.numbers(
            viscosity_at_40_degree_celsius=cold,
            viscosity_at_100_degree_celsius=hot,
            density_at_15_degree_celsius=np.ravel(oil.density_15)[0],
        )
        self.add(_OIL, "lubricant", oil.name, *constants, name=oil.name)
        for one in (_STAGE, _CASING):
            self.relate("reference", origin=one, referenced=_OIL)

    # --- loads and results ----------------------------------------------------------------
    def computed(self) -> tuple[Any, Any] | None:
        """Temperatures [K] of oil and addenda, (3, operating), and the mesh cycle.

        None, with a warning, where the pair has no hot state to compute.
        """
        case, model = self.case, self.case.models[0]
        try:
            HOT.require_settled(case, model, np.s_[:])
            operating = case.operating_of(model)
            cycle = case.cycle(operating, model)
        except ThermogearError as error:
            warnings.warn(f"written without results: {error}", ValidityWarning, stacklevel=2)
            return None
        at = operating.temperatures
        rows = (operating.oil_temperature, at.pinion_addendum, at.wheel_addendum)
        return np.stack([np.broadcast_to(row, case.stated.speed.shape) for row in rows]), cycle

    def _loads(self, computed: tuple[Any, Any] | None) -> None:
        """A load case for every operating point with what is ``computed`` there."""
        case, pair = self.case, self.case.pair
        oil = np.broadcast_to(case.stated.oil_temperature, case.stated.speed.shape)
        stated = not case.computed or case.file.oil.temperature is not None
        for k, (speed, torque) in enumerate(
            zip(case.stated.speed, case.stated.torque, strict=True)
        ):
            parts = {
                _SHAFTS[0]: self.numbers(rotational_speed=speed),
                _SHAFTS[1]: self.numbers(rotational_speed=-speed / pair.ratio),
                _LOADS[0]: self.numbers(torque_around_u_axis=torque),
                _LOADS[1]: self.numbers(torque_around_u_axis=torque * pair.ratio),
            }
            if stated:
                parts[_CASING] = self.numbers(temperature_lubricant=oil[k])
            if computed is not None:
                hot, cycle = computed
                for part, name, kelvin in zip(_HOT, _TEMPERATURES, hot[:, k], strict=True):
                    parts[part] = self.numbers(**{name: kelvin})
                parts[_STAGE] = _results(cycle.isel(operating=k), self.version)
            tables = {part: {one.id: one for one in rows} for part, rows in parts.items()}
            self.model.load(LoadCase(id=k + 1, spectrum=1, components=tables))
        ratio, length = float(pair.contact_ratio), float(1e3 * (pair.path.e - pair.path.a))
        self.model.accumulation[_STAGE] = {
            "total_contact_ratio": Attribute("total_contact_ratio", "none", ratio),
            "length_of_path_of_contact": Attribute("length_of_path_of_contact", "mm", length),
        }


_HOT = (_CASING, *_GEARS)
_TEMPERATURES = ("temperature_lubricant", "bulk_temperature", "bulk_temperature")
"""Temperatures of a load case: the oil's, in the casing, and the addenda's."""
_EXTREMES = {
    "hertz_pressure": "max",
    "flash_temperature": "max",
    "contact_temperature": "max",
    "film_parameter": "min",
    "film_thickness": "min",
    "transmission_error": "ptp",
}
"""Curves of which one number is kept: the greatest, the least, from peak to peak."""


def _results(point: Any, version: str) -> list[Attribute]:
    """What the mesh cycle says of one operating point.

    The stiffness over a mesh period where REXS has a name for it, the rest under names of ours, in
    the units of stored results.
    """
    found = []
    stiffness = np.asarray(point["mesh_stiffness"].values, dtype=float)
    if np.all(np.isfinite(stiffness)) and numbers(version) >= (1, 5):
        curve: list[object] = [float(one) for one in 1e-3 * stiffness]
        found.append(Attribute("meshing_stiffness_characteristic", "N / mm", curve))
    for name, shape in point.data_vars.items():
        if shape.ndim == 0:
            number, called = float(shape.values), str(name)
        elif name in _EXTREMES:
            how = _EXTREMES[str(name)]
            number = float(getattr(np, how)(shape.values))
            called = f"{'peak_to_peak' if how == 'ptp' else how}_{name}"
        else:
            continue
        if math.isfinite(number):
            unit = str(shape.attrs.get("units", "none"))
            found.append(Attribute(f"{OURS}{called}", unit, number))
    return found


def _relief_ends(case: GearCase, gear: Gear, one: Relief) -> tuple[float, ...]:
    """Diameters [m] where a relief is deepest and where it starts."""
    start, _, tip = active_profile(case.pair, one.gear)
    both = (tip, tip - one.length) if one.end == "tip" else (start, start + one.length)
    return tuple(2.0 * math.hypot(gear.base_radius, rho) for rho in both)
