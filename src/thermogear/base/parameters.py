"""Everything that can be varied, named once: for fields, options, sweeps, axes and pictures.

A parameter has one long name, the names a person may write for it, its SI unit and the unit it is
shown in. Gear parameters are fields of a case file; the others are the numbers of the
dimensionless equation. A field of the case file that has no name here is a parameter too
(:func:`thermogear.case.allowed.gear_parameter`).
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from thermogear.base.errors import InputError, nearest
from thermogear.base.units import RPM, ZERO_CELSIUS

EQUATION = "base"
"""The table of a dimensionless case that holds the numbers of the equation."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """A parameter: shown is ``factor * (value - zero)`` in ``shown``, the value in ``unit`` (SI).

    ``words`` and ``symbol`` name it on an axis. ``fields`` of a gear case it means, all with
    the same value; ``number``: a number of the dimensionless equation. ``aliases`` are the other
    names a person may write.
    """

    name: str
    words: str
    symbol: str = ""
    unit: str = "1"
    shown: str = ""
    factor: float = 1.0
    zero: float = 0.0
    fields: tuple[str, ...] = ()
    number: bool = False
    aliases: tuple[str, ...] = ()

    def show(self, value: Any) -> Any:
        """A value [SI], or an array of them, in the shown unit."""
        return self.factor * (value - self.zero)

    def told(self, value: float) -> str:
        """A value [SI] in a sentence: name = number and shown unit."""
        return f"{self.name} = {self.show(value):.6g} {self.shown}".strip()

    def read(self, number: float) -> float:
        """A bare number in the shown unit as SI."""
        return number / self.factor + self.zero

    @property
    def label(self) -> str:
        """Words, symbol and [unit]: the label of an axis."""
        unit = f"[{self.shown}]" if self.shown else ""
        return " ".join(part for part in (self.words, self.symbol, unit) if part)


_ALL = (
    # gears
    Parameter(
        name="pinion_speed", words="pinion speed", unit="rad/s", shown="rpm", factor=1.0 / RPM,
        fields=("operating.speed",), aliases=("rpm", "speed"),
    ),
    Parameter(
        name="pinion_torque", words="pinion torque", unit="N m", shown="N m",
        fields=("operating.torque",), aliases=("torque",),
    ),
    Parameter(
        name="gear_temperature", words="gear temperature", unit="K", shown="°C",
        zero=ZERO_CELSIUS, fields=("temperatures.pinion_addendum", "temperatures.wheel_addendum"),
        aliases=("temperature",),
    ),
    Parameter(
        name="cold_half_backlash", words="cold half backlash", unit="m", shown="µm", factor=1e6,
        fields=("backlash.value",), aliases=("backlash",),
    ),
    Parameter(
        name="face_width", words="face width", unit="m", shown="mm", factor=1e3,
        fields=("gears.pinion.face_width", "gears.wheel.face_width"),
    ),
    Parameter(
        name="roughness", words="roughness Ra", unit="m", shown="µm", factor=1e6,
        fields=("gears.pinion.roughness", "gears.wheel.roughness"),
    ),
    Parameter(
        name="housing_below_gears", words="housing below the gears", unit="K", shown="K",
        fields=("temperatures.housing_below_addendum",),
    ),
    Parameter(
        name="shafts_below_gears", words="shafts below the gears", unit="K", shown="K",
        fields=(
            "temperatures.pinion_bore_below_addendum", "temperatures.wheel_bore_below_addendum",
        ),
    ),
    Parameter(
        name="oil_below_gears", words="oil below the gears", unit="K", shown="K",
        fields=("oil.temperature_below_addendum",),
    ),
    # what no single field says: the sensitivity study alone
    Parameter(
        name="oil_viscosity", words="oil viscosity at 40 °C", unit="m^2/s", shown="mm²/s",
        factor=1e6,
    ),
    Parameter(
        name="cold_backlash", words="cold backlash (total, normal)", unit="m", shown="mm",
        factor=1e3,
    ),
    Parameter(
        name="error_amplitude", words="kinematic error amplitude", unit="m", shown="µm",
        factor=1e6,
    ),
    Parameter(
        name="stiffness_fluctuation", words="factor on the fluctuation of the mesh stiffness",
        aliases=("fluctuation",),
    ),
    # gears and the equation alike
    Parameter(
        name="damping_ratio", words="damping ratio", symbol="ζ", number=True,
        fields=("dynamics.damping_ratio",), aliases=("zeta", "damping"),
    ),
    # the equation
    Parameter(
        name="frequency", words="frequency ratio", symbol="ω_h", number=True,
        aliases=("w", "omega", "omega_h"),
    ),
    Parameter(
        name="stiffness_amplitude", words="stiffness amplitude", symbol="ε", number=True,
        aliases=("eps", "epsilon"),
    ),
    Parameter(
        name="mean_force", words="mean force", symbol="F_m", number=True, aliases=("fm", "f_m"),
    ),
    Parameter(
        name="force_amplitude", words="force amplitude", symbol="F_h", number=True,
        aliases=("fh", "f_h"),
    ),
    Parameter(
        name="half_backlash", words="half backlash", symbol="b′", number=True,
        aliases=("b", "b_prime"),
    ),
    Parameter(
        name="thermal_stiffness", words="thermal stiffness", symbol="ε_T", number=True,
        aliases=("eps_t", "epsilon_t"),
    ),
)  # fmt: skip

PARAMETERS: dict[str, Parameter] = {one.name: one for one in _ALL}
"""The table, by the long names."""
NUMBERS: tuple[str, ...] = tuple(one.name for one in _ALL if one.number)
"""The numbers of the dimensionless equation, in the order of its keywords."""
GEARS: tuple[str, ...] = tuple(one.name for one in _ALL if one.fields)
"""The parameters that are fields of a gear case."""

_LONG = {alias: one.name for one in _ALL for alias in (one.name, *one.aliases)}


def long_name(name: str) -> str:
    """The long name of a parameter; a name that is none is itself.

    Hyphen and underscore are alike, and so are capitals and small letters.
    """
    return _LONG.get(name.replace("-", "_").lower(), name)


def named(name: str, among: Iterable[str] = PARAMETERS, option: str = "parameter") -> Parameter:
    """The parameter that ``name`` or one of its aliases means, out of ``among``.

    InputError, under the name of ``option``, for an unknown one: the nearest is said.
    """
    full, known = long_name(name), tuple(among)
    if full in known:
        return PARAMETERS[full]
    names = [alias for one in known for alias in (one, *PARAMETERS[one].aliases)]
    why = None
    if full in PARAMETERS:
        of_gears = "a parameter of gears, and none of these"
        why = "a number of the dimensionless equation" if full in NUMBERS else of_gears
    raise InputError(option, repr(name), why=why, fix=nearest(name, names))
