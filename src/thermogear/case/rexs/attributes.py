"""The attributes that are used: what each measures, its unit and name version by version.

A value is converted by the unit written with it. The unit is checked against the schema: another
unit of the same kind counts and is said, one of another kind is refused.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from thermogear.base.errors import InputError, short
from thermogear.case.rexs.model import Attribute, Component, Model
from thermogear.case.units import KINDS, convert

PURE = "number"
"""The kind of a pure number; counts, texts and truths have no kind."""

_SPELLED: dict[str, tuple[float, str]] = {
    "mm": (1.0, "mm"),
    "m": (1.0, "m"),
    "mum": (1.0, "um"),
    "µm": (1.0, "um"),
    "um": (1.0, "um"),
    "deg": (1.0, "deg"),
    "°": (1.0, "deg"),
    "rad": (1.0, "rad"),
    "C": (1.0, "degC"),
    "°C": (1.0, "degC"),
    "K": (1.0, "K"),
    "1 / min": (1.0, "rpm"),
    "1/min": (1.0, "rpm"),
    "rad / s": (1.0, "rad/s"),
    "N m": (1.0, "N m"),
    "N mm": (1e-3, "N m"),
    "kN m": (1e3, "N m"),
    "N / mm^2": (1.0, "MPa"),
    "MPa": (1.0, "MPa"),
    "GPa": (1.0, "GPa"),
    "kg / dm^3": (1e3, "kg/m^3"),
    "kg / m^3": (1.0, "kg/m^3"),
    "1e-6 / C": (1e-6, "1/K"),
    "1e-6 / K": (1e-6, "1/K"),
    "W / (m K)": (1.0, "W/(m K)"),
    "J / (kg K)": (1.0, "J/(kg K)"),
    "mm^2 / s": (1.0, "mm^2/s"),
    "h": (1.0, "h"),
    "min": (1.0, "min"),
    "s": (1.0, "s"),
    "kW": (1e3, "W"),
    "W": (1.0, "W"),
    "%": (0.01, ""),
    "none": (1.0, ""),
}
"""Units as REXS spells them: a factor and the unit as a case file has it."""


@dataclass(frozen=True)
class Meaning:
    """What an attribute measures and the unit the schemas have: ``unit`` up to the version before
    ``since``, ``then`` from there on."""

    kind: str
    unit: str
    then: str = ""
    since: tuple[int, ...] = ()

    def unit_in(self, version: tuple[int, ...]) -> str:
        """The unit of the schema of a version."""
        return self.then if self.then and version >= self.since else self.unit


_LENGTH = Meaning("length", "mm")
_MICRO = Meaning("length", "mum")
_ANGLE = Meaning("angle", "°", "deg", (1, 4))
_STRESS = Meaning("pressure", "N / mm^2", "MPa", (2,))
_NUMBER = Meaning(PURE, "none")
_TEMPERATURE = Meaning("temperature", "C")
_SHARE = Meaning(PURE, "%")
_HOURS = Meaning("time", "h")

MEANINGS: dict[str, Meaning] = (
    dict.fromkeys(
        (
            "normal_module",
            "transverse_module",
            "face_width",
            "common_face_width",
            "tip_diameter",
            "tip_form_diameter",
            "tooth_tip_chamfer",
            "root_diameter",
            "addendum_modification",
            "addendum_reference_profile",
            "tip_radius",
            "chordal_tooth_thickness_upper_deviation",
            "chordal_tooth_thickness_lower_deviation",
            "center_distance",
            "support_vector",
            "u_axis_vector",
            "minimum_normal_backlash",
            "maximum_normal_backlash",
            "minimum_transverse_backlash",
            "maximum_transverse_backlash",
            "tip_relief_depth",
            "tip_relief_datum_length",
            "tip_relief_datum_diameter",
            "tip_relief_evaluation_reference",
            "root_relief_depth",
            "root_relief_datum_length",
            "root_relief_datum_diameter",
            "root_relief_evaluation_reference",
            "u_coordinate_on_shaft",
            "u_coordinate_on_shaft_inner_side",
            "length",
            "outer_diameter_begin",
            "outer_diameter_end",
            "inner_diameter_begin",
            "inner_diameter_end",
        ),
        _LENGTH,
    )
    | dict.fromkeys(
        (
            "arithmetic_average_roughness_flank",
            "averaged_peak_to_valley_height_flank",
            "upper_center_distance_allowance",
            "lower_center_distance_allowance",
            "operating_radial_bearing_clearance",
        ),
        _MICRO,
    )
    | dict.fromkeys(
        (
            "helix_angle_reference_diameter",
            "normal_pressure_angle",
        ),
        _ANGLE,
    )
    | dict.fromkeys(
        (
            "addendum_modification_coefficient",
            "generated_addendum_modification_coefficient",
            "addendum_coefficient_reference_profile",
            "tip_radius_factor",
            "poisson_ratio",
        ),
        _NUMBER,
    )
    | dict.fromkeys(("temperature_lubricant",), _TEMPERATURE)
    | dict.fromkeys(("operating_time_fraction", "load_duration_fraction"), _SHARE)
    | dict.fromkeys(("operating_time", "load_duration"), _HOURS)
    | {
        "elastic_modulus": _STRESS,
        "density": Meaning("density", "kg / dm^3"),
        "density_at_15_degree_celsius": Meaning("density", "kg / dm^3"),
        "thermal_expansion_coefficient_plus": Meaning("thermal expansion", "1e-6 / C"),
        "thermal_conductivity": Meaning("thermal conductivity", "W / (m K)"),
        "thermal_capacity": Meaning("specific heat", "J / (kg K)"),
        "viscosity_at_40_degree_celsius": Meaning("kinematic viscosity", "mm^2 / s"),
        "viscosity_at_100_degree_celsius": Meaning("kinematic viscosity", "mm^2 / s"),
        "rotational_speed": Meaning("rotational speed", "1 / min"),
        "torque_around_u_axis": Meaning("torque", "N m"),
        "torque": Meaning("torque", "N m"),
        "power": Meaning("power", "kW"),
        "radial_stiffness": Meaning("stiffness", "N / m"),
    }
)
"""Attributes that are numbers with a kind, by the name of REXS 1.x."""

LATER: dict[str, tuple[str, ...]] = {
    "arithmetic_average_roughness_flank": ("arithmetic_mean_roughness_flank_iso_4287_1997",),
    "averaged_peak_to_valley_height_flank": ("mean_peak_to_valley_roughness_flank_iso_4287_1997",),
    "tip_radius_factor": ("tip_corner_radius_factor_reference_profile",),
    "tolerance_class_according_to_iso_1328_2013": ("global_tolerance_class_iso_1328_2013",),
    "tooth_thickness_deviation_tolerance_series_din_3967_1978": (
        "din_3967_deviation_tolerance_series",
    ),
    "center_distance_tolerance_field_din_3964_1980": ("din_3964_center_distance_tolerance_field",),
    "operating_time_fraction": ("load_duration_fraction", "custom_load_duration_fraction"),
    "operating_time": ("load_duration", "custom_load_duration"),
}
"""Names the same thing has in other versions."""

WORDS = (
    "is_driving_gear",
    "defines_torque",
    "transmits_torque",
    "defines_speed",
    "radial_force_absorption",
    "number_of_teeth",
    "tolerance_class_according_to_iso_1328_2013",
    "tooth_thickness_deviation_tolerance_series_din_3967_1978",
    "center_distance_tolerance_field_din_3964_1980",
    "shape_of_relief",
    "bevel_cone_orientation",
    "is_engaged",
    "gear_shift_index",
    "catalogue_designation",
    "name",
    "material_designation",
    "reference_component_for_position",
)
"""Attributes that are counts, texts and truths."""

USED = {*MEANINGS, *WORDS}.union(*LATER.values())
"""Every attribute that is read."""

_NUMBER_TEXT = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?")


@dataclass(frozen=True, kw_only=True)
class Read:
    """A number as it was read: ``si``, and as a case file holds it, ``number`` ``unit``."""

    si: float
    number: float
    unit: str

    @property
    def text(self) -> str:
        """As a case file holds it, in the unit of the REXS file."""
        return f"{plain(self.number)} {self.unit}"


def plain(number: float) -> str:
    """A number to its last bit, whole ones without a point."""
    return repr(int(number)) if abs(number) < 1e15 and number == int(number) else repr(number)


class Reader:
    """Values of one model's components; doubtful units are in ``said``."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self._doubts: dict[tuple[str, str], dict[str, None]] = {}

    def attribute(
        self, component: Component | None, name: str, over: dict[str, Attribute] | None = None
    ) -> Attribute | None:
        """The attribute under any of its names; those of a load case, ``over``, go before."""
        if component is None:
            return None
        for table in (over or {}, component.attributes):
            for one in (name, *LATER.get(name, ())):
                if one in table and table[one].value not in (None, "", []):
                    return table[one]
        return None

    def number(
        self, component: Component | None, name: str, over: dict[str, Attribute] | None = None
    ) -> Read | None:
        """A number in SI; None where the file has none."""
        if (found := self.attribute(component, name, over)) is None:
            return None
        where = _where(component, found)
        return self._converted(found, finite(found.value, where), MEANINGS[name], where)

    def vector(self, component: Component | None, name: str) -> tuple[float, ...] | None:
        """Three numbers in SI; None where the file has none."""
        if (found := self.attribute(component, name)) is None:
            return None
        where = _where(component, found)
        if not isinstance(found.value, list) or len(found.value) != 3:
            raise InputError(where, short(found.value), allowed="three numbers")
        return tuple(
            self._converted(found, finite(one, where), MEANINGS[name], where).si
            for one in found.value
        )

    def words(
        self, component: Component | None, name: str, over: dict[str, Attribute] | None = None
    ) -> str:
        """A text, empty where the file has none."""
        found = self.attribute(component, name, over)
        return "" if found is None else str(found.value).strip()

    def truth(
        self, component: Component | None, name: str, over: dict[str, Attribute] | None = None
    ) -> bool | None:
        """A truth; None where the file has none."""
        if (found := self.attribute(component, name, over)) is None:
            return None
        text = str(found.value).strip().lower()
        if text not in ("true", "false", "0", "1"):
            raise InputError(_where(component, found), short(found.value), allowed="true or false")
        return text in ("true", "1")

    def whole(
        self, component: Component, name: str, over: dict[str, Attribute] | None = None
    ) -> int | None:
        """A whole number; None where the file has none."""
        if (found := self.attribute(component, name, over)) is None:
            return None
        where = _where(component, found)
        value = finite(found.value, where)
        if value != int(value):
            raise InputError(where, short(found.value), allowed="a whole number")
        return int(value)

    def _converted(self, found: Attribute, value: float, means: Meaning, where: str) -> Read:
        schema = means.unit_in(self.model.after)
        unit = (found.unit or "").strip()
        if not unit or (unit == "none" and means.kind != PURE):
            if schema != "none":
                self._doubts.setdefault(("", schema), {})[where] = None
            unit = schema
        elif unit != schema:
            self._judge(unit, schema, value, means, where)
        return in_si(value, unit, means, where)

    def _judge(self, unit: str, schema: str, value: float, means: Meaning, where: str) -> None:
        """Refuse a unit of another kind; say one that REXS has elsewhere."""
        in_si(value, unit, means, where)
        if not {unit, schema} <= {"%", "none", ""}:
            self._doubts.setdefault((unit, schema), {})[where] = None

    @property
    def said(self) -> list[str]:
        """A line for each unit that is not the schema's."""
        lines = []
        for (unit, schema), where in self._doubts.items():
            first = next(iter(where))
            count = f" and {len(where) - 1} more" if len(where) > 1 else ""
            if unit:
                lines.append(
                    f"{first}{count}: got the unit {short(unit)}; REXS {self.model.version} has "
                    f"{schema!r}; converted by the unit written"
                )
            else:
                lines.append(f"{first}{count}: got no unit; taken as {schema!r}, that of REXS")
        return lines


def _where(component: Component | None, found: Attribute) -> str:
    return f"{component.called if component else ''}.{found.id}"


def finite(value: object, where: str) -> float:
    """``value`` as a finite number; refused where it is a text, a truth or a list."""
    if isinstance(value, str) and _NUMBER_TEXT.fullmatch(value.strip()):
        value = float(value)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise InputError(where, short(value), allowed="a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise InputError(where, short(value), allowed="a finite number")
    return number


def in_si(value: float, unit: str, means: Meaning, where: str) -> Read:
    """``value`` in a REXS ``unit`` as SI; refused where the unit is of another kind."""
    factor, ours = _SPELLED.get(unit, (1.0, unit))
    if not math.isfinite(factor * value):
        raise InputError(where, f"{value:g} {unit}", allowed="a finite number")
    if means.kind in (PURE, "power"):
        if ours != ("" if means.kind == PURE else "W"):
            raise InputError(where, f"{value:g} {unit}", allowed=f"a number in {means.unit!r}")
        return Read(si=factor * value, number=factor * value, unit=ours)
    try:
        si = convert(factor * value, ours, KINDS[means.kind])
    except InputError as error:
        raise InputError(
            where,
            f"{value:g} {short(unit).strip(chr(39))}",
            allowed=f"a unit of {means.kind}, such as {means.then or means.unit!r}",
            why=f"{short(unit)} is none",
        ) from error
    return Read(si=si, number=factor * value, unit=ours)
