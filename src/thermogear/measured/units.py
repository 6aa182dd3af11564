"""Units that records carry, as one table: what kind of quantity and how many SI units."""

from __future__ import annotations

import re

from thermogear.base.errors import InputError, nearest
from thermogear.base.units import STANDARD_GRAVITY

_TABLE: dict[str, tuple[str, float]] = {
    "m/s^2": ("acceleration", 1.0),
    "mm/s^2": ("acceleration", 1e-3),
    "cm/s^2": ("acceleration", 1e-2),
    "g": ("acceleration", STANDARD_GRAVITY),
    "mg": ("acceleration", 1e-3 * STANDARD_GRAVITY),
    "m/s": ("velocity", 1.0),
    "mm/s": ("velocity", 1e-3),
    "cm/s": ("velocity", 1e-2),
    "um/s": ("velocity", 1e-6),
    "in/s": ("velocity", 0.0254),
    "m": ("displacement", 1.0),
    "mm": ("displacement", 1e-3),
    "um": ("displacement", 1e-6),
    "nm": ("displacement", 1e-9),
    "s": ("time", 1.0),
    "ms": ("time", 1e-3),
    "us": ("time", 1e-6),
    "ns": ("time", 1e-9),
    "min": ("time", 60.0),
    "h": ("time", 3600.0),
    "d": ("time", 86400.0),
    "V": ("voltage", 1.0),
    "mV": ("voltage", 1e-3),
    "rpm": ("speed", 1.0 / 60.0),
    "Hz": ("frequency", 1.0),
    "kHz": ("frequency", 1e3),
    "N m": ("torque", 1.0),
    "degC": ("temperature", 1.0),
    "deg": ("angle", 1.0 / 360.0),
    "rad": ("angle", 0.15915494309189535),
}
_VIBRATES = ("acceleration", "velocity", "displacement", "voltage")
_OF_RECORDS = tuple(name for name, (kind, _) in _TABLE.items() if kind in _VIBRATES)
UNITS = ", ".join(_OF_RECORDS)
"""Known units of what vibrates, in words."""
_SPELLINGS = {
    "m/s2": "m/s^2",
    "m/s**2": "m/s^2",
    "m/s/s": "m/s^2",
    "ms^-2": "m/s^2",
    "m s^-2": "m/s^2",
    "m*s^-2": "m/s^2",
    "m/sec^2": "m/s^2",
    "mm/s2": "mm/s^2",
    "mm/s**2": "mm/s^2",
    "cm/s2": "cm/s^2",
    "gn": "g",
    "g_n": "g",
    "grav": "g",
    "gs": "g",
    "ips": "in/s",
    "inch/s": "in/s",
    "mm/sec": "mm/s",
    "mum": "um",
    "micron": "um",
    "microns": "um",
    "sec": "s",
    "secs": "s",
    "second": "s",
    "seconds": "s",
    "msec": "ms",
    "millisecond": "ms",
    "milliseconds": "ms",
    "usec": "us",
    "microsecond": "us",
    "microseconds": "us",
    "nsec": "ns",
    "nanosecond": "ns",
    "nanoseconds": "ns",
    "minute": "min",
    "minutes": "min",
    "hr": "h",
    "hrs": "h",
    "hour": "h",
    "hours": "h",
    "day": "d",
    "days": "d",
    "volt": "V",
    "volts": "V",
    "v": "V",
    "mv": "mV",
    "hz": "Hz",
    "khz": "kHz",
    "1/min": "rpm",
    "r/min": "rpm",
    "rev/min": "rpm",
    "u/min": "rpm",
    "min-1": "rpm",
    "min^-1": "rpm",
    "n m": "N m",
    "n*m": "N m",
    "n·m": "N m",
    "°c": "degC",
    "deg c": "degC",
}
_LONGEST = 100  # characters of a text that may be a unit
_SIGNS = str.maketrans(
    {"²": "2", "µ": "u", "μ": "u", "−": "-", "\u00a0": " ", "⁻": "-", "¹": "1", "㎡": "2"}
)


def unit(text: str) -> str | None:
    """The known name of a unit as written in a file ("m/s²", "[g]", "G", "msec"), else None.

    >>> unit("msec"), unit("furlong")
    ('ms', None)
    """
    bare = text.strip()[:_LONGEST].strip("[](){}").strip().translate(_SIGNS)
    if bare in _TABLE:
        return bare
    low = re.sub(r"\s+", " ", bare.lower())
    if low in _SPELLINGS:
        return _SPELLINGS[low]
    return low if low in _TABLE else None


def unknown(text: str) -> str:
    """What is written as a unit and is none that is known; "" where nothing is, or a known one.

    >>> unknown("[furlong]"), unknown("g"), unknown("2")
    ('furlong', '', '')
    """
    bare = text.strip()[:_LONGEST].strip("[](){}").strip()
    return bare if re.search(r"[^\W\d]", bare) and unit(bare) is None else ""


def says_seconds(text: str) -> bool:
    """Whether a text is a unit of time in a word of its own: no sign that means other things too.

    >>> says_seconds("Seconds"), says_seconds("S"), says_seconds("min")
    (True, False, False)
    """
    known = _SPELLINGS.get(text.strip()[:_LONGEST].lower())
    return known is not None and kind_of(known) == "time"


def known_unit(text: str, field: str = "unit") -> str:
    """The unit a user gave; an unknown one is refused with the units of what vibrates."""
    found = unit(text)
    if found is None:
        raise InputError(field, repr(text), fix=nearest(text, _OF_RECORDS))
    return found


def kind_of(name: str) -> str:
    """The kind of quantity of a known unit: acceleration, displacement, time, ...

    >>> kind_of("mm")
    'displacement'
    """
    return _TABLE[name][0]


def counts_turns(name: str | None) -> bool:
    """Whether a known unit counts turns of a shaft in time.

    >>> counts_turns("rpm"), counts_turns("V"), counts_turns(None)
    (True, False, False)
    """
    return name is not None and kind_of(name) in ("speed", "frequency")


def factor_of(name: str) -> float:
    """SI units (turns per second for rpm, turns for angles) in one of a known unit.

    >>> factor_of("mm")
    0.001
    """
    return _TABLE[name][1]
