"""Numbers and units as a person reads them: one way for pages, pictures, notices, terminals."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass
from string import Formatter
from typing import Any, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import short
from thermogear.base.units import RPM, STANDARD_GRAVITY, ZERO_CELSIUS
from thermogear.base.vocabulary import QUANTITIES


@dataclass(frozen=True)
class Display:
    """How an SI number is shown: ``scale * (value - zero) / per`` in ``unit``.

    ``per``: the size of the unit in SI where that is the exact number, as of rpm or minutes.
    """

    unit: str
    scale: float = 1.0
    _: KW_ONLY
    zero: float = 0.0
    per: float = 1.0

    @overload
    def __call__(self, values: float) -> float: ...

    @overload
    def __call__(self, values: ArrayLike) -> NDArray[np.float64]: ...

    def __call__(self, values: ArrayLike) -> float | NDArray[np.float64]:
        if isinstance(values, float | int):
            return self.scale * (values - self.zero) / self.per
        return np.asarray(self.scale * (np.asarray(values, dtype=float) - self.zero) / self.per)

    def stored(self, shown: ArrayLike) -> NDArray[np.float64]:
        """The SI numbers of what is ``shown``."""
        return np.asarray(np.asarray(shown, dtype=float) * self.per / self.scale + self.zero)

    def text(self, value: float, digits: int) -> str:
        """``value`` with its unit, to so many places behind the point."""
        return f"{self(value):.{digits}f} {self.unit}"


MICROMETRE = Display("µm", 1e6)
MILLIMETRE = Display("mm", 1e3)
KELVIN = Display("K")
CELSIUS = Display("°C", 1.0, zero=ZERO_CELSIUS)
NEWTON = Display("N")
KILONEWTON = Display("kN", 1e-3)
STIFFNESS = Display("10⁸ N/m", 1e-8)
PER_MICROMETRE = Display("N/µm", 1e-6)
HERTZ = Display("Hz", per=2.0 * math.pi)
"""Of an angular frequency."""
SPEED = Display("rpm", per=RPM)
GRAVITY = Display("g", per=STANDARD_GRAVITY)
LINE_LOAD = Display("N/mm", 1e-3)
MILLIMETRE_PER_SECOND = Display("mm/s", 1e3)
NANOMETRE = Display("nm", 1e9)
MILLISECOND = Display("ms", 1e3)
MEGAPASCAL = Display("MPa", 1e-6)
MINUTE = Display("min", per=60.0)
HOUR = Display("h", per=3600.0)
PERCENT = Display("%", 100.0)
DEGREE = Display("°", per=math.radians(1.0))

_BY_UNIT = {
    "1": Display("–"),
    "m": MICROMETRE,
    "N/m": STIFFNESS,
    "Pa": MEGAPASCAL,
    "K": CELSIUS,
    "rad/s": SPEED,
    "m/s": Display("m/s"),
    "s": MILLISECOND,
}
_DIFFERENCE = re.compile("flash|margin|residual|difference|below_(gears|addendum)")
"""Names of kelvins that are a difference, no temperature."""
_BY_NAME = {
    "path_position": MILLIMETRE,
    "pinion_radius": MILLIMETRE,
    "wheel_radius": MILLIMETRE,
    "reduced_radius": MILLIMETRE,
    "line_load": LINE_LOAD,
    "velocity": MILLIMETRE_PER_SECOND,
    "section_velocity": MILLIMETRE_PER_SECOND,
    "least_velocity": MILLIMETRE_PER_SECOND,
}


def display(name: str, unit: str | None = None) -> Display:
    """How the stored quantity ``name`` is shown; ``unit`` as stored, if it differs from usual."""
    if unit is None:
        unit = QUANTITIES[name].unit
    elif name in QUANTITIES and unit != QUANTITIES[name].unit:
        return _BY_UNIT.get(unit, Display(unit))
    if unit == "K" and _DIFFERENCE.search(name):
        return KELVIN
    return _BY_NAME.get(name) or _BY_UNIT.get(unit) or Display(unit)


def number(value: float, digits: int = 3) -> str:
    """A number to ``digits`` significant figures, with a true minus and powers of ten.

    A whole number that is longer keeps all its places; what is not finite is a dash.
    """
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    size = math.floor(math.log10(abs(value)))
    if -4 <= size < 6:
        text = f"{value:.{max(digits - 1 - size, 0)}f}"
    else:
        mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
        text = f"{mantissa}·10{raised(int(exponent))}"
    return text.replace("-", "−")


def shared(value: float, *, error: float, digits: int = 6) -> str:
    """The figures of ``value`` >= 0, of ``digits`` at most, that all within ``error`` of it share.

    Rounded; where not even the first is shared, the least power of ten that none of them exceeds;
    a dash where the error is not finite.

    >>> shared(0.874_43, error=5e-5), shared(3e-9, error=4e-9), shared(3e-9, error=1e-11)
    ('0.874', 'below 10⁻⁸', '3.0·10⁻⁹')
    """
    if not math.isfinite(error):
        return "–"
    low, high = value - error, value + error
    for count in range(digits, 0, -1):
        if number(low, count) == number(high, count):
            return number(value, count)
    return f"below 10{raised(math.ceil(math.log10(high)))}"


_SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def raised(exponent: int) -> str:
    """A whole number as superscript."""
    return str(exponent).translate(_SUPERSCRIPTS)


def percent(ratio: float) -> str:
    """A relative change as a signed percentage."""
    return "–" if not math.isfinite(ratio) else f"{100.0 * ratio:+.1f} %".replace("-", "−")


def celsius(kelvin: float) -> str:
    """A temperature in whole degrees Celsius; "none" where there is no such temperature."""
    if not math.isfinite(kelvin):
        return "none"
    return f"{kelvin - ZERO_CELSIUS:.0f} °C".replace("-", "−")


def exactly(value: float, digits: int = 6) -> str:
    """A given value without zeros it was not given with."""
    text = number(value, digits)
    return text.rstrip("0").rstrip(".") if "." in text and "·" not in text else text


def rounded(value: float, *, digits: int) -> str:
    """A number to ``digits`` significant figures, the rest zeros, without a power of ten."""
    return f"{float(f'{value:.{digits - 1}e}'):.10g}"


class _Words(Formatter):
    """Fields as ``{name:.1f µm}``: a format, or ~3 for so many figures, and perhaps a unit."""

    def format_field(self, value: Any, format_spec: str) -> str:
        form, _, unit = format_spec.partition(" ")
        text = rounded(value, digits=int(form[1:])) if form.startswith("~") else format(value, form)
        return f"{text} {unit}".rstrip()


def worded(words: str, figures: Mapping[str, Any]) -> tuple[str, dict[str, str]]:
    """``words`` with their ``figures`` in place of ``{name:.1f µm}``, and the unit of each name.

    A figure is a number in the unit of its last place, or a list of them: ``{name[0]:.1f}``; after
    a tilde comes the number of significant figures. Without figures the words stay as they are.

    >>> worded("Of {gap[0]:.0f} or {gap[1]:.1f µm}.", {"gap": [129.7, 112.34]})
    ('Of 130 or 112.3 µm.', {'gap': 'µm'})
    """
    if not figures:
        return words, {}
    units = dict(re.findall(r"{(\w+)[^:}]*(?::\S*?(?: ([^}]*))?)?}", words))
    return _Words().vformat(words, (), figures), units


def span(values: ArrayLike, digits: int = 3) -> str:
    """The range of ``values`` as one number, or "low to high"."""
    found = np.asarray(values, dtype=float)
    found = found[np.isfinite(found)]
    if not found.size:
        return "–"
    low, high = exactly(float(found.min()), digits), exactly(float(found.max()), digits)
    return low if low == high else f"{low} to {high}"


def stretches(values: ArrayLike, flags: NDArray[np.bool_], most: int = 3) -> str:
    """Where ``flags`` hold along an axis of rising ``values``, in words: "3 to 5.5, 7".

    An end of the axis says that it is one: what lies beyond was not computed. Of more than ``most``
    stretches their number of values and whole reach.

    >>> stretches([1.0, 2.0, 3.0, 4.0], np.array([True, True, False, True]))
    '1 (first computed) to 2, 4 (last computed)'
    """
    at = np.asarray(values, dtype=float)
    edges = np.flatnonzero(np.diff(np.concatenate([[0], flags.astype(int), [0]]))).reshape(-1, 2)
    if len(edges) > most:
        return f"{int(flags.sum())} values, {span(at[flags], 6)}"
    marks = {0: " (first computed)", at.size - 1: " (last computed)"}
    words = [exactly(float(value)) + marks.get(place, "") for place, value in enumerate(at)]
    return ", ".join(words[a] if b - a == 1 else f"{words[a]} to {words[b - 1]}" for a, b in edges)


def kind_in_words(thing: object) -> str:
    """The class of ``thing`` in words: a PitchError is a "pitch error"."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(thing).__name__).lower()


def in_words(value: object) -> str:
    """A value of a case file as a reader would write it on one line, without quotes."""
    if isinstance(value, dict):
        return ", ".join(f"{key} = {in_words(each)}" for key, each in value.items())
    if isinstance(value, list | tuple):
        return ", ".join(map(in_words, value))
    if value is None:
        return "none"
    return " ".join(value.split()) if isinstance(value, str) else short(value)
