"""A case and what it amounts to, as a REXS model.

Every number is in the unit of REXS, and exactly, in SI, in ``custom_thermogear_*``;
the whole case is kept in ``custom_thermogear_case``, so that an import gives the same case.
"""

from __future__ import annotations

import json
import math
import warnings
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from thermogear import __version__
from thermogear.base.errors import InputError, ThermogearError, ValidityWarning
from thermogear.base.materials import Material
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.case.rexs.attributes import EXACT, MEANINGS, from_si, spelled
from thermogear.case.rexs.importing import CASE
from thermogear.case.rexs.model import (
    MOST_LOAD_CASES,
    Attribute,
    Component,
    LoadCase,
    Model,
    Relation,
    numbers,
)
from thermogear.case.units import KINDS
from thermogear.gears.deviations import Relief
from thermogear.gears.geometry import Gear
from thermogear.heat.lubrication import kinematic_viscosity

WRITTEN = ("1.4", "1.5", "1.6", "1.7", "2.0.0")
"""Versions that are written."""
_UNIT, _CASING, _STAGE, _OIL = 1, 2, 3, 4
_SHAFTS, _GEARS, _DATA, _LOADS = (11, 12), (21, 22), (31, 32), (41, 42)
_TOOLS, _MATERIALS = (51, 52), (61, 62)
_FLANKS = ((71, 72), (73, 74))
_RELIEFS = 81
_NAMES = ("pinion", "wheel")


def model_of_case(case: GearCase, version: str = "1.7") -> Model:
    """The REXS model of a case with its quasi-static results, by its first model of the mesh."""
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
    return _Maker(case, version).made()


@dataclass
class _Maker:
    """A model in the making."""

    case: GearCase
    version: str
    model: Model = field(init=False)

    def __post_init__(self) -> None:
        self.model = Model(self.version, f"thermogear {__version__}", "")

    # --- pieces ---------------------------------------------------------------------------
    def exact(self, name: str, si: float) -> list[Attribute]:
        """A number in the unit of REXS, and also as it is."""
        means = MEANINGS[name]
        si = float(si)
        value, unit = from_si(si, means, numbers(self.version))
        there = spelled(name, self.version)
        return [
            Attribute(there, unit, value),
            Attribute(
                f"{EXACT}{there}", KINDS[means.kind].si if means.kind in KINDS else "none", si
            ),
        ]

    def add(self, found: int, kind: str, name: str, *parts: Any) -> None:
        """A component of attributes and lists of them."""
        flat: list[Attribute] = []
        for part in parts:
            flat += part if isinstance(part, list) else [part]
        self.model.add(Component(found, kind, name, {one.id: one for one in flat}))

    def relate(self, kind: str, *refs: tuple[str, int], order: int | None = None) -> None:
        """A relation with the next id."""
        self.model.relate(Relation(len(self.model.relations) + 1, kind, order, refs))

    # --- the whole ------------------------------------------------------------------------
    def made(self) -> Model:
        """Components, relations and load cases."""
        case, pair = self.case, self.case.pair
        kept = {"text": case.text, "overrides": [list(one) for one in case.overrides]}
        self.add(
            _UNIT,
            "gear_unit",
            case.title,
            _text("custom_thermogear_version", __version__),
            _text(CASE, json.dumps(kept)),
        )
        self.add(_CASING, "gear_casing", "housing")
        self.relate("assembly", ("assembly", _UNIT), ("part", _CASING))
        least, most = (2.0 * one for one in (case.cold_backlash.least, case.cold_backlash.most))
        self.add(
            _STAGE,
            "cylindrical_stage",
            case.title,
            self.exact("center_distance", pair.centre_distance),
            self.exact("minimum_normal_backlash", least),
            self.exact("maximum_normal_backlash", most),
            [Attribute("rotating_angle_around_neg_u_axis", "deg", 0.0)],
        )
        self.relate("assembly", ("assembly", _UNIT), ("part", _STAGE))
        self.relate("stage", ("stage", _STAGE), ("gear_1", _GEARS[0]), ("gear_2", _GEARS[1]))
        for place, gear in enumerate((pair.pinion, pair.wheel)):
            self._shaft(place)
            self._gear(place, gear)
        self._oil()
        self._loads()
        return self.model

    def _shaft(self, place: int) -> None:
        name, shaft = _NAMES[place], _SHAFTS[place]
        apart = 1e3 * self.case.pair.centre_distance if place else 0.0
        position = [
            Attribute("support_vector", "mm", [0.0, 0.0, apart]),
            Attribute("u_axis_vector", "mm", [1.0, 0.0, 0.0]),
            Attribute("w_axis_vector", "mm", [0.0, 0.0, 1.0]),
            Attribute("reference_component_for_position", "none", _UNIT),
        ]
        driving = place == 0
        self.add(shaft, "shaft", name, position, [Attribute("defines_speed", "none", driving)])
        self.add(
            _LOADS[place],
            "external_load",
            "input" if driving else "output",
            [Attribute("defines_torque", "none", driving)],
            [Attribute("transmits_torque", "none", True)],
        )
        self.relate("assembly", ("assembly", _UNIT), ("part", shaft))
        self.relate("assembly", ("assembly", shaft), ("part", _LOADS[place]))
        self.relate("assembly", ("assembly", shaft), ("part", _GEARS[place]))
        self.add(
            _DATA[place],
            "cylindrical_stage_gear_data",
            name,
            [Attribute("is_driving_gear", "none", driving)],
        )
        self.relate(
            "stage_gear_data",
            ("stage", _STAGE),
            ("gear", _GEARS[place]),
            ("stage_gear_data", _DATA[place]),
        )

    def _gear(self, place: int, gear: Gear) -> None:
        name, found = _NAMES[place], _GEARS[place]
        accuracy = []
        if self.case.accuracy is not None:
            there = spelled("tolerance_class_according_to_iso_1328_2013", self.version)
            edition = self.case.file.flanks.edition if self.case.file.flanks else ""
            if edition == "2013":
                accuracy = [Attribute(there, "none", int(self.case.accuracy))]
        self.add(
            found,
            "cylindrical_gear",
            name,
            [Attribute("number_of_teeth", "none", int(gear.teeth))],
            [Attribute("helix_angle_reference_diameter", "deg", 0.0)],
            self.exact("normal_module", gear.module),
            self.exact("face_width", gear.face_width),
            self.exact("tip_diameter", 2.0 * gear.tip_radius),
            self.exact("root_diameter", 2.0 * gear.root_radius),
            self.exact("arithmetic_average_roughness_flank", gear.roughness),
            [Attribute(f"{EXACT}bore_diameter", "m", 2.0 * gear.bore_radius)],
            accuracy,
        )
        self._material(place, gear.material)
        self.add(
            _TOOLS[place],
            "rack_shaped_tool",
            f"hob of the {name}",
            self.exact("normal_module", gear.module),
            self.exact("addendum_coefficient_reference_profile", gear.rack.dedendum),
            self.exact("tip_radius_factor", gear.rack.fillet_radius),
        )
        left, right = _FLANKS[place]
        for flank in (left, right):
            self.add(
                flank,
                "cylindrical_gear_flank",
                "",
                self.exact("normal_pressure_angle", gear.pressure_angle),
                self.exact("addendum_modification_coefficient", gear.profile_shift),
            )
        self.relate("flank", ("gear", found), ("left", left), ("right", right))
        for flank in (left, right):
            self.relate(
                "manufacturing_step", ("workpiece", flank), ("tool", _TOOLS[place]), order=1
            )
        self._reliefs(place, gear)

    def _reliefs(self, place: int, gear: Gear) -> None:
        """The pinion turns about +u: its right flanks lead and carry, and those of the wheel."""
        left, right = _FLANKS[place]
        for one in self.case.deviations:
            if not isinstance(one, Relief) or one.gear != _NAMES[place]:
                continue
            at = {"drive": (right,), "back": (left,)}.get(one.flank, (left, right))
            limit, start = _relief_ends(self.case, gear, one)
            found = _RELIEFS + len(self.model.of_type("tip_relief", "root_relief"))
            self.add(
                found,
                f"{one.end}_relief",
                f"{one.end} relief of the {one.gear}",
                self.exact(f"{one.end}_relief_depth", one.amount),
                self.exact(f"{one.end}_relief_datum_diameter", start),
                self.exact(f"{one.end}_relief_evaluation_reference", limit),
                [Attribute("shape_of_relief", "none", one.shape)],
            )
            for flank in at:
                self.relate("reference", ("origin", flank), ("referenced", found))

    def _material(self, place: int, material: Material) -> None:
        found = _MATERIALS[place]
        self.add(
            found,
            "material",
            material.name,
            _text("material_designation", material.name),
            self.exact("elastic_modulus", material.youngs_modulus),
            self.exact("poisson_ratio", material.poisson_ratio),
            self.exact("density", material.density),
            self.exact("thermal_conductivity", material.thermal_conductivity),
            self.exact("thermal_capacity", material.specific_heat),
            self.exact("thermal_expansion_coefficient_plus", material.thermal_expansion),
        )
        self.relate("reference", ("origin", _GEARS[place]), ("referenced", found))

    def _oil(self) -> None:
        oil = self.case.stated.lubricant
        cold, hot = (
            float(np.ravel(kinematic_viscosity(oil, ZERO_CELSIUS + t))[0]) for t in (40.0, 100.0)
        )
        self.add(
            _OIL,
            "lubricant",
            oil.name,
            _text("name", oil.name),
            self.exact("viscosity_at_40_degree_celsius", cold),
            self.exact("viscosity_at_100_degree_celsius", hot),
            self.exact("density_at_15_degree_celsius", float(np.ravel(oil.density_15)[0])),
        )
        for one in (_STAGE, _CASING):
            self.relate("reference", ("origin", one), ("referenced", _OIL))

    # --- loads and results ----------------------------------------------------------------
    def _computed(self) -> tuple[Any, Any] | None:
        """Temperatures [K] of oil and addenda, (3, operating), and the mesh cycle.

        None, with a warning, where the pair has no hot state to compute.
        """
        case, model = self.case, self.case.models[0]
        try:
            operating = case.operating_of(model)
            cycle = case.cycle(operating, model)
        except ThermogearError as error:
            warnings.warn(f"written without results: {error}", ValidityWarning, stacklevel=2)
            return None
        at = operating.temperatures
        rows = (operating.oil_temperature, at.pinion_addendum, at.wheel_addendum)
        shape = case.stated.speed.shape
        return np.stack([np.broadcast_to(row, shape) for row in rows]), cycle

    def _loads(self) -> None:
        """A load case for every operating point with what is computed there."""
        case, pair = self.case, self.case.pair
        computed = self._computed()
        ratio = pair.ratio
        for k in range(case.stated.speed.size):
            speed, torque = float(case.stated.speed[k]), float(case.stated.torque[k])
            parts = {
                _SHAFTS[0]: self.exact("rotational_speed", speed),
                _SHAFTS[1]: self.exact("rotational_speed", -speed / ratio),
                _LOADS[0]: self.exact("torque_around_u_axis", torque),
                _LOADS[1]: self.exact("torque_around_u_axis", torque * ratio),
            }
            if computed is not None:
                hot, cycle = computed
                for found, attribute, kelvin in zip(_HOT, _TEMPERATURES, hot[:, k], strict=True):
                    parts[found] = self.exact(attribute, float(kelvin))
                parts[_STAGE] = _results(cycle.isel(operating=k), self.version)
            tables = {found: {one.id: one for one in rows} for found, rows in parts.items()}
            self.model.load(LoadCase(id=k + 1, spectrum=1, components=tables))
        length = 1e3 * (pair.path.e - pair.path.a)
        self.model.accumulation[_STAGE] = {
            one.id: one
            for one in (
                Attribute("total_contact_ratio", "none", pair.contact_ratio),
                Attribute("length_of_path_of_contact", "mm", length),
            )
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
    for name, values in point.data_vars.items():
        if values.ndim == 0:
            number, called = float(values.values), str(name)
        elif name in _EXTREMES:
            how = _EXTREMES[str(name)]
            number = float(getattr(np, how)(values.values))
            called = f"{'peak_to_peak' if how == 'ptp' else how}_{name}"
        else:
            continue
        if math.isfinite(number):
            unit = str(values.attrs.get("units", "none"))
            found.append(Attribute(f"{EXACT}{called}", unit, number))
    return found


def _relief_ends(case: GearCase, gear: Gear, one: Relief) -> tuple[float, float]:
    """Diameters [m] where a relief is deepest and where it starts."""
    from thermogear.gears.deviations import active_profile

    start, _, tip = active_profile(case.pair, one.gear)
    limit = tip if one.end == "tip" else start
    begins = tip - one.length if one.end == "tip" else start + one.length
    both = (2.0 * math.hypot(gear.base_radius, rho) for rho in (limit, begins))
    deepest, first = both
    return deepest, first


def _text(name: str, value: str) -> Attribute:
    return Attribute(name, "none", value)
