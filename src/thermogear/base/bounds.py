"""How large the sizes of a gear pair may be, for case files and for numbers from Python alike.

A number from Python has no unit: whoever writes millimetres, degrees Celsius or gigapascals where
metres, kelvins and pascals are meant is refused, with the number that was probably meant. What
stays within the bounds all the same cannot be noticed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.units import RPM, ZERO_CELSIUS


@dataclass(frozen=True, kw_only=True)
class Bounds:
    """From ``low`` to ``high`` in ``unit``, the unit that people read.

    ``scale``: SI units in one ``unit``, ``zero``: the SI value of its 0. ``slips``: further units,
    with their SI values, in which the number is written by mistake.
    """

    low: float
    high: float
    unit: str
    si: str
    scale: float = 1.0
    zero: float = 0.0
    slips: dict[str, float] = field(default_factory=dict, hash=False)

    @property
    def least(self) -> float:
        """The lower end in SI."""
        return self.low * self.scale + self.zero

    @property
    def most(self) -> float:
        """The upper end in SI."""
        return self.high * self.scale + self.zero

    @property
    def ends(self) -> tuple[str, str]:
        """Both ends as texts with their unit."""
        return f"{_plain(self.low)} {self.unit}", f"{_plain(self.high)} {self.unit}"

    @cached_property
    def _reach(self) -> tuple[float, float]:
        """Both ends with what rounding may add."""
        slack = 1e-12 * max(abs(self.least), abs(self.most))
        below = 1e-12 * self.least if self.least > 0.0 else slack
        return self.least - below, self.most + slack

    def require(self, name: str, values: ArrayLike) -> None:
        """Refuse SI ``values`` of which one lies outside, or is no number."""
        floor, roof = self._reach
        if type(values) is float and floor <= values <= roof:
            return
        found = floats(name, values, self.si)
        good = (found >= floor) & (found <= roof)
        if not good.all():
            value = float(found[~good].flat[0])
            allowed = f"{_plain(self.low)}..{_plain(self.high)} {self.unit}".rstrip()
            raise InputError(name, self._shown(value), allowed=allowed, fix=self._meant(value))

    def require_number(self, name: str, value: Any) -> None:
        """Refuse a ``value`` that is not one SI number within the bounds."""
        if not _is_number(value):
            raise InputError(name, repr(value), allowed=f"a number [{self.si}]")
        self.require(name, value)

    def _shown(self, value: float) -> str:
        number = f"{value:.6g} {self.si}".rstrip()
        if self.unit == self.si or not math.isfinite(value):
            return number
        return f"{number} ({(value - self.zero) / self.scale:.6g} {self.unit})"

    def _meant(self, number: float) -> str | None:
        """What ``number`` would be were it written in a unit of people, where that is allowed."""
        if not math.isfinite(number):
            return None
        read = {self.unit: number * self.scale + self.zero}
        read |= {unit: number * scale for unit, scale in self.slips.items()}
        meant = [
            f"{value:.6g} ({number:g} {unit})"
            for unit, value in read.items()
            if value != number and self.least <= value <= self.most
        ]
        return f"did you mean {' or '.join(meant)}?" if meant else None


def floats(name: str, values: ArrayLike, unit: str = "") -> Floats:
    """``values`` as an array of floats; refused where texts or other things are among them."""
    try:
        found = np.asarray(values)
    except ValueError:  # rows of different lengths
        found = np.asarray(None)
    if found.dtype.kind not in "iuf":
        raise InputError(name, repr(values), allowed=f"numbers [{unit}]" if unit else "numbers")
    return found.astype(float)


def _is_number(value: object) -> bool:
    """Whether ``value`` is one real number; a truth value is none."""
    numeric = isinstance(value, int | float | np.integer | np.floating)
    return numeric and not isinstance(value, bool)


def whole(name: str, value: float, *, least: int) -> int:
    """``value`` as the whole number that it is; refused below ``least`` or where it is none."""
    if not (_is_number(value) and least <= value < np.inf and int(value) == value):
        got = value if np.ndim(value) == 0 else f"{np.size(value)} values"
        raise InputError(name, got, allowed=f"a whole number >= {least}")
    return int(value)


def require_share(name: str, value: float) -> None:
    """Refuse a share that is not above 0 and at most 1."""
    if not 0.0 < value <= 1.0:
        raise InputError(name, value, allowed="0 < value <= 1")


def _plain(number: float) -> str:
    return f"{number:g}".replace("e+0", "e").replace("e-0", "e-")


def _millimetres(low: float, high: float) -> Bounds:
    return Bounds(low=low, high=high, unit="mm", si="m", scale=1e-3)


def _micrometres(low: float, high: float) -> Bounds:
    return Bounds(low=low, high=high, unit="um", si="m", scale=1e-6, slips={"mm": 1e-3})


def _degrees(low: float, high: float) -> Bounds:
    return Bounds(low=low, high=high, unit="deg", si="rad", scale=math.pi / 180.0)


LEAST_TEETH, MOST_TEETH = 5, 2000
MODULE = _millimetres(0.05, 100.0)
LENGTH = _millimetres(0.01, 10000.0)
TIP_RADIUS = _millimetres(0.05, 10000.0)
CENTRE_DISTANCE = _millimetres(0.1, 20000.0)
DEPTH = _millimetres(0.0, 50.0)
HALF_BACKLASH = _millimetres(5e-6, 50.0)
RELIEF_LENGTH = _millimetres(0.01, 1000.0)
PROFILE_RADIUS = _millimetres(0.1, 10000.0)
ADDED = _micrometres(-2000.0, 2000.0)
RELIEF_AMOUNT = _micrometres(0.0, 1000.0)
PITCH_ERROR = _micrometres(-1000.0, 1000.0)
ECCENTRICITY = _micrometres(0.0, 1000.0)
ROUGHNESS = _micrometres(0.001, 100.0)
PROFILE_SHIFT = Bounds(low=-2.0, high=2.0, unit="modules", si="modules")
RACK = Bounds(low=0.0, high=5.0, unit="modules", si="modules")
PRESSURE_ANGLE = _degrees(10.0, 35.0)
ANGLE_ERROR = _degrees(-1.1, 1.1)
CRACK_ANGLE = _degrees(45.0, 90.0)
SHARE = Bounds(low=0.0, high=1.0, unit="", si="")

BODY = Bounds(low=-70.0, high=600.0, unit="degC", si="K", zero=ZERO_CELSIUS)
"""Gears, oil or housing. The bounds are ours: wide enough for any gearbox, narrow enough to notice
degrees Celsius written as kelvins."""
TEMPERING = Bounds(low=-70.0, high=3000.0, unit="degC", si="K", zero=ZERO_CELSIUS)

SPEED = Bounds(low=0.0, high=500000.0, unit="rpm", si="rad/s", scale=RPM)
TORQUE = Bounds(low=0.0, high=1e7, unit="N m", si="N m")

RATE = Bounds(low=1e-6, high=1e12, unit="samples/s", si="samples/s")
"""From one sample in eleven days to a thousand times what the fastest converters take."""
PULSES = Bounds(low=1e-6, high=1e7, unit="pulses per turn", si="pulses per turn")
FULL_SCALE = Bounds(low=1e-15, high=1e15, unit="units at full scale", si="units at full scale")

YOUNGS_MODULUS = Bounds(
    low=0.01, high=2000.0, unit="GPa", si="Pa", scale=1e9, slips={"N/mm^2": 1e6}
)
DENSITY = Bounds(low=100.0, high=30000.0, unit="kg/m^3", si="kg/m^3", slips={"g/cm^3": 1e3})
CONDUCTIVITY = Bounds(low=0.01, high=3000.0, unit="W/(m K)", si="W/(m K)")
SPECIFIC_HEAT = Bounds(
    low=10.0, high=10000.0, unit="J/(kg K)", si="J/(kg K)", slips={"kJ/(kg K)": 1e3}
)
EXPANSION = Bounds(low=1e-9, high=5e-4, unit="1/K", si="1/K", slips={"um/(m K)": 1e-6})
MODULUS_SLOPE = Bounds(low=-0.01, high=0.01, unit="1/K", si="1/K")
OIL_DENSITY = Bounds(low=500.0, high=2500.0, unit="kg/m^3", si="kg/m^3", slips={"g/cm^3": 1e3})
VISCOSITY = Bounds(low=0.3, high=1e6, unit="mm^2/s", si="m^2/s", scale=1e-6)
