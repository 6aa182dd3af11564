"""Units as text, read once: ``"5 mm"`` becomes 0.005.

Below the case file every float is SI, every temperature K, every angle rad. pint is loaded when
a unit is read that is none of the usual ones, never on import.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

from thermogear.base.errors import InputError, short
from thermogear.base.units import ZERO_CELSIUS, half_digit

if TYPE_CHECKING:
    import pint


@dataclass(frozen=True)
class Kind:
    """A kind of quantity: its SI unit, the unit messages speak in, an example to copy.

    ``parts``: unit names one of which must occur. pint calls an angle a pure number and a joule
    a newton metre, so that 50 Hz would pass as 50 rad/s; a kind that suffers from this names the
    units it accepts.
    """

    name: str
    si: str
    shown: str
    example: str
    parts: tuple[str, ...] = ()


_ANGLES = ("radian", "degree", "turn", "revolution", "arcminute", "arcsecond", "grade")

KINDS: dict[str, Kind] = {
    kind.name: kind
    for kind in (
        Kind("length", "m", "mm", "5 mm"),
        Kind("time", "s", "min", "30 min"),
        Kind("angle", "rad", "deg", "20 deg", _ANGLES),
        Kind("temperature", "K", "degC", "100 degC"),
        Kind("temperature difference", "K", "K", "20 K"),
        Kind(
            "rotational speed",
            "rad/s",
            "rpm",
            "1000 rpm",
            (*_ANGLES, "revolutions_per_minute", "revolutions_per_second"),
        ),
        Kind("torque", "N m", "N m", "100 N m", ("newton", "pound", "force", "dyne", "kip")),
        Kind("moment of inertia", "kg m^2", "kg m^2", "0.01 kg m^2"),
        Kind("kinematic viscosity", "m^2/s", "mm^2/s", "100 mm^2/s"),
        Kind("density", "kg/m^3", "kg/m^3", "7850 kg/m^3"),
        Kind("pressure", "Pa", "GPa", "206 GPa"),
        Kind("thermal conductivity", "W/(m K)", "W/(m K)", "46 W/(m K)"),
        Kind("specific heat", "J/(kg K)", "J/(kg K)", "470 J/(kg K)"),
        Kind("thermal expansion", "1/K", "1/K", "11.5e-6 1/K"),
        Kind("area", "m^2", "m^2", "0.6 m^2"),
        Kind("heat transfer coefficient", "W/(m^2 K)", "W/(m^2 K)", "15 W/(m^2 K)"),
        Kind("thermal conductance", "W/K", "W/K", "10 W/K"),
        Kind("heat flux", "W/m^2", "kW/m^2", "20 kW/m^2"),
        Kind("mass", "kg", "kg", "3 kg"),
        Kind("volume flow", "m^3/s", "l/min", "2 l/min"),
        Kind("force", "N", "N", "1000 N"),
        Kind("stiffness", "N/m", "N/um", "200 N/um"),
        Kind("damping", "N s/m", "N s/m", "500 N s/m"),
        Kind("torsional stiffness", "N m/rad", "N m/rad", "20000 N m/rad", ("newton", "pound")),
        Kind("torsional damping", "N m s/rad", "N m s/rad", "1 N m s/rad", ("newton", "pound")),
        Kind("unbalance", "kg m", "g mm", "20 g mm"),
        Kind("wear coefficient", "m^2/N", "m^2/N", "1e-17 m^2/N"),
    )
}

_USUAL: dict[str, dict[str, float]] = {
    "length": {"m": 1.0, "mm": 1e-3, "um": 1e-6, "µm": 1e-6},
    "time": {"s": 1.0, "min": 60.0, "h": 3600.0},
    "angle": {"rad": 1.0, "deg": math.pi / 180.0},
    "temperature": {"K": 1.0},
    "temperature difference": {"K": 1.0},
    "rotational speed": {"rad/s": 1.0, "rpm": 2.0 * math.pi / 60.0},
    "torque": {"N m": 1.0},
    "moment of inertia": {"kg m^2": 1.0},
    "kinematic viscosity": {"m^2/s": 1.0, "mm^2/s": 1e-6},
    "density": {"kg/m^3": 1.0},
    "pressure": {"Pa": 1.0, "MPa": 1e6, "GPa": 1e9},
    "thermal conductivity": {"W/(m K)": 1.0},
    "specific heat": {"J/(kg K)": 1.0},
    "thermal expansion": {"1/K": 1.0},
    "area": {"m^2": 1.0},
    "heat transfer coefficient": {"W/(m^2 K)": 1.0},
    "thermal conductance": {"W/K": 1.0},
    "heat flux": {"W/m^2": 1.0, "kW/m^2": 1e3},
    "mass": {"kg": 1.0},
    "volume flow": {"m^3/s": 1.0, "l/min": 1.666666666666667e-05},
    "force": {"N": 1.0, "kN": 1e3},
    "stiffness": {"N/m": 1.0, "N/um": 1e6, "N/mm": 1e3},
    "damping": {"N s/m": 1.0},
    "torsional stiffness": {"N m/rad": 1.0},
    "torsional damping": {"N m s/rad": 1.0},
    "unbalance": {"kg m": 1.0, "g mm": 1e-6},
    "wear coefficient": {"m^2/N": 1.0, "mm^2/N": 1e-6},
}
"""Units of nearly every file, by their factor to SI: bit for bit what pint makes of
them, without loading it, which takes longer than many a command."""

_TEXT = re.compile(
    r"\s*(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|[+-]?(?:nan|inf(?:inity)?)(?![a-z]))"
    r"\s*(?P<unit>.*?)\s*",
    re.IGNORECASE | re.DOTALL,
)
# Names with small powers, multiplied and divided. pint itself would also work out arithmetic, such
# as 9**9**9**9, for as long as that takes.
_NAME = r"[A-Za-zµμ°Ω_]+(?:(?:\^|\*\*)?-?[0-9]{1,2}|[⁻¹²³]{1,2})?"
_UNIT = re.compile(rf"(?:1\s*/\s*)?\(?{_NAME}(?:(?:\s*[/*·]\s*|\s+)\(?{_NAME}\)?){{0,5}}\)?")
_SIGNS = str.maketrans({"º": "°", "˚": "°", "℃": "°C", "℉": "°F", "⋅": "*", "∙": "*", "•": "*"})
_OWN = (
    "newton_metre = newton * meter = Nm",  # a yarn count else
    "newton_centimetre = newton * centimeter = Ncm",
    "newton_millimetre = newton * millimeter = Nmm",
    "@alias turn = rev",
    "@alias revolutions_per_minute = RPM = Rpm = Upm",
)
"""What pint is taught."""
_SPELLINGS = {
    "temperature": {
        f"{degree} {name}": "degC"
        for degree in ("deg", "degree", "degrees", "°")
        for name in ("C", "Celsius", "celsius")
    }
    | {"Celsius": "degC"},
    "rotational speed": {
        f"{turn}/{time}": unit
        for turn in ("r", "U", "tr", "rot", "revs")
        for time, unit in (("min", "rpm"), ("s", "rps"))
    },
    "moment of inertia": {"kgm^2": "kg m^2", "kgm²": "kg m^2"},
    "thermal conductivity": {"W/mK": "W/(m K)"},
    "specific heat": {"J/kgK": "J/(kg K)"},
    "heat transfer coefficient": dict.fromkeys(("W/m2K", "W/m^2K", "W/m²K"), "W/(m^2 K)"),
}
"""Spellings of one kind of quantity that mean something else, or nothing, elsewhere."""
_DOUBTFUL = ("grad", "Grad", "grads", "gradi")
"""A degree in one language, a gon in another."""
_SLIPS = {
    "temperature": {"C": "degC", "c": "degC", "°": "degC", "F": "degF"},
    "temperature difference": {"C": "K", "degC": "K", "°C": "K", "°": "K"},
    "angle": {"°C": "deg", "degC": "deg"} | dict.fromkeys(_DOUBTFUL, "deg"),
    "torque": {"nm": "N m", "J": "N m"},
    "kinematic viscosity": {"cst": "cSt", "CST": "cSt"},
}


def _spelled(unit: str, kind: Kind) -> str:
    """``unit`` with other signs for degrees, products and powers put as pint reads them."""
    plain = " ".join(unit.translate(_SIGNS).split())
    plain = re.sub(r"^/", "1/", plain)
    plain = re.sub(r"(?<=[A-Za-zµμ])[-.](?=[A-Za-z])", "*", plain)  # N-m, N.m
    plain = re.sub(r"(?<=[A-Za-zµμ])(-?[1-4])(?![\w.])", r"^\1", plain)  # mm2/s, min-1
    return _SPELLINGS.get(kind.name, {}).get(plain, plain)


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(on_redefinition="ignore")
    for definition in _OWN:
        registry.define(definition)
    return registry


def convert(number: float, unit: str, kind: Kind) -> float:
    """``number`` in ``unit`` as an SI number of ``kind``.

    Raises :class:`InputError` (with an empty field; the reader knows which) where the unit is
    unknown or of another kind.
    """
    if unit in _USUAL.get(kind.name, {}):
        return _USUAL[kind.name][unit] * number
    if unit == "degC" and kind.name == "temperature":
        return number + ZERO_CELSIUS
    return _by_pint(number, unit, kind)


def _by_pint(number: float, unit: str, kind: Kind) -> float:
    meant = _SLIPS.get(kind.name, {}).get(unit)
    slip = f'did you mean "{number:g} {meant}"?' if meant else None
    got = f"{number:g} {unit}"
    if unit in _DOUBTFUL:
        raise _refused(kind, got, f"{unit!r} may be a degree or a gon", slip)
    plain = _spelled(unit, kind)
    if len(plain) > 40 or not _UNIT.fullmatch(plain):
        raise _refused(kind, got, f"what follows the number is no unit of {kind.name}", slip)
    registry = _registry()
    try:
        parsed = registry.parse_units(plain)
        if kind.name == "rotational speed" and parsed == registry.parse_units("1/minute"):
            parsed = registry.parse_units("rpm")
        fits = parsed.dimensionality == registry.parse_units(kind.si).dimensionality
    except Exception as cause:
        # pint answers nonsense with errors of many classes (lookup, syntax, tokens, arithmetic)
        raise _refused(kind, got, f"unit {unit!r} is not known", slip) from cause
    if kind.name == "rotational speed" and str(parsed) in ("hertz", "1 / second"):
        slip = f'did you mean "{number:g} rps" or "{number:g} rad/s"?'
    names = str(parsed)
    if kind.parts:
        fits = fits and any(part in names for part in kind.parts)
    if kind.name == "temperature":
        fits = fits and "delta" not in names
    if not fits:
        raise _refused(kind, got, f"{unit!r} is no unit of {kind.name}", slip)
    if kind.name == "temperature difference" and parsed != registry.kelvin and "delta" not in names:
        raise _refused(kind, got, f"{unit!r} has its zero elsewhere, a difference has none", slip)
    return float(registry.Quantity(number, parsed).to(kind.si).magnitude)


def _refused(kind: Kind, got: object, why: str, fix: str | None = None) -> InputError:
    example = f'write for instance "{kind.example}"'
    return InputError("", got, why=why, fix=fix or example)


def read_quantity(text: object, kind_name: str) -> float:
    """An SI number out of a text with a unit; a bare number is refused with an example.

    >>> read_quantity("4 mm", "length")
    0.004
    """
    kind = KINDS[kind_name]
    if isinstance(text, int | float) and not isinstance(text, bool):
        finite = math.isfinite(text)
        fix = f'write for instance "{short(text)} {kind.shown}"' if finite else None
        raise _refused(kind, short(text), "a bare number has no unit", fix)
    if not isinstance(text, str):
        raise _refused(kind, short(text), f"not a text with number and unit of {kind.name}")
    return _of_text(text, kind)


def rounding(text: str, kind_name: str) -> float:
    """Half a unit [SI] of the last digit of a quantity that :func:`read_quantity` reads.

    >>> f"{1e3 * rounding('91.50 mm', 'length'):.3f} mm"
    '0.005 mm'
    """
    match = _TEXT.fullmatch(text)
    return (
        0.0
        if match is None
        else convert(half_digit(match["number"]), match["unit"], KINDS[kind_name])
    )


@lru_cache(maxsize=4096)
def _of_text(text: str, kind: Kind) -> float:
    """Remembered: a batch of cases reads the same texts and bounds again and again."""
    if re.match(r"\s*[+-]?\d+,\d", text):
        raise _refused(
            kind, short(text), "decimals follow a point, not a comma", _with_point(text, kind)
        )
    match = _TEXT.fullmatch(text)
    if match is None:
        raise _refused(kind, short(text), "no number at its start")
    number, unit = float(match["number"]), match["unit"]
    if not math.isfinite(number):
        raise _refused(kind, short(text), "not finite")
    if not unit:
        raise _refused(
            kind,
            short(text),
            "the unit is missing",
            f'write for instance "{match["number"]} {kind.shown}"',
        )
    try:
        return convert(number, unit, kind)
    except InputError as error:
        raise InputError("", short(text), why=error.why, fix=error.fix) from error


def _with_point(text: str, kind: Kind) -> str:
    """What a number with one comma may have meant: three places behind it may be thousands."""
    match = re.fullmatch(r"\s*([+-]?\d+),(\d+)\s*([^\d,][^,]*)?", text)
    if match is None:
        return f'write for instance "{kind.example}"'
    whole, places, unit = match[1], match[2], match[3] or kind.shown
    pointed = f'"{whole}.{places} {unit}"'
    if len(places) == 3:
        return f'write {pointed} or "{whole}{places} {unit}"'
    return f"did you mean {pointed}?"


def shown(value: float, kind_name: str, digits: int = 6, unit: str = "") -> str:
    """An SI ``value`` as text in a usual ``unit``, else that of messages and tables.

    >>> shown(0.004, "length")
    '4 mm'
    """
    unit = unit if unit in _USUAL[kind_name] else KINDS[kind_name].shown
    return f"{number_in(value, kind_name, unit):.{digits}g} {unit}"


def number_in(value: float, kind_name: str, unit: str) -> float:
    """An SI ``value`` as a number of the usual ``unit`` (or degC).

    >>> number_in(373.15, "temperature", "degC")
    100.0
    """
    told = value - ZERO_CELSIUS if unit == "degC" else value
    return told / _USUAL[kind_name].get(unit, 1.0)
