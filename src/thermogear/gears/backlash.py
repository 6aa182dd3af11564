"""Backlash of a pair: its kinds and what one is in another, and what tolerances leave of it.

One tooth pair's whole play along the line of action is the normal backlash j_n; the half
backlash j_n/2 is left on each side of a tooth in the middle. Lengths in metres.
"""

from __future__ import annotations

import math
from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.gears.geometry import involute
from thermogear.gears.pair import GearPair

_Lengths = TypeVar("_Lengths", float, NDArray[np.float64])


def normal_from_circumferential(circumferential: _Lengths, pair: GearPair) -> _Lengths:
    """j_n = j_t cos(alpha_w) [m]: backlash on the operating pitch circle, on the line of action.

    Source: ISO 21771-1, spur gears.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * normal_from_circumferential(100e-6, pair):.2f} um"
    '93.97 um'
    """
    return circumferential * math.cos(pair.operating_pressure_angle)


def normal_from_thickness(allowance: float, pair: GearPair) -> float:
    """j_n = -E_s cos(alpha) [m] that a tooth-thickness allowance E_s [m] (< 0 thinner) opens.

    E_s is measured along the reference circle: the flank turns by E_s/r, and its normal on the
    line of action moves by r_b E_s/r, at whatever centre distance.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * normal_from_thickness(-50e-6, pair):.2f} um"
    '46.98 um'
    """
    return -allowance * math.cos(pair.pinion.pressure_angle)


def normal_from_distance(distance: float, pair: GearPair) -> float:
    """j_n = 2 (r_b1 + r_b2) [inv(alpha_w) - inv(alpha_0)] [m] at a centre ``distance`` [m].

    alpha_0 is the operating angle of the mesh without backlash; a smaller distance gives a
    negative value. Derivative: dj_n/da = 2 sin(alpha_w).

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * normal_from_distance(120.1e-3, pair):.2f} um"
    '68.62 um'
    """
    pinion, wheel = pair.pinion, pair.wheel
    both = pinion.base_radius + wheel.base_radius
    shift = pinion.profile_shift + wheel.profile_shift
    teeth = pinion.teeth + wheel.teeth
    tight = float(involute(pinion.pressure_angle)) + 2.0 * shift / teeth * math.tan(
        pinion.pressure_angle
    )
    if distance <= both:
        raise InputError(
            "centre_distance",
            f"a centre distance of {1e3 * distance:.6g} mm",
            allowed=f"> {1e3 * both:.6g} mm, the sum of the base radii",
        )
    return 2.0 * both * (float(involute(math.acos(both / distance))) - tight)


class BacklashSpan(NamedTuple):
    """Normal backlash j_bn [m]: the least, that of the middles of the tolerances, the most.

    >>> f"{1e6 * BacklashSpan(80e-6, 120e-6, 160e-6).half.middle:.0f} um"
    '60 um'
    """

    least: float
    middle: float
    most: float

    @property
    def half(self) -> BacklashSpan:
        """The half backlashes j_bn/2 [m], to each side of a tooth in the middle."""
        return BacklashSpan(0.5 * self.least, 0.5 * self.middle, 0.5 * self.most)


def backlash_span(
    *,
    pinion: tuple[float, ...],
    wheel: tuple[float, ...],
    distance: tuple[float, ...],
    pair: GearPair,
) -> BacklashSpan:
    """j_bn [m] that tooth-thickness allowances and a centre-distance tolerance leave.

    j_bn = -(E_s1 + E_s2) cos(alpha) + j_n(a + deviation): least with both upper allowances and
    the smallest distance, most with both lower ones and the greatest, middle with the middles.

    ``pinion``, ``wheel``: allowances E_s [m] along the reference circle (one, or lower and upper,
    in any order); ``distance``: deviations [m] of the pair's centre distance. Raises where the
    axes come closer than the base circles. Source: ISO 21771-1, closed by involute geometry.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> span = backlash_span(pinion=(-40e-6,), wheel=(-60e-6,), distance=(0.0,), pair=pair)
    >>> f"{1e6 * span.middle:.2f} um"
    '93.97 um'
    """

    def total(thickness: float, deviation: float) -> float:
        return normal_from_thickness(thickness, pair) + normal_from_distance(
            pair.centre_distance + deviation, pair
        )

    def middle(ends: tuple[float, ...]) -> float:
        return 0.5 * (min(ends) + max(ends))

    return BacklashSpan(
        total(max(pinion) + max(wheel), min(distance)),
        total(middle(pinion) + middle(wheel), middle(distance)),
        total(min(pinion) + min(wheel), max(distance)),
    )
