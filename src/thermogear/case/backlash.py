"""Cold half backlash on the line of action out of what a drawing or a measurement gives."""

from __future__ import annotations

import math
from dataclasses import dataclass

from thermogear.base.errors import InputError
from thermogear.gears.geometry import involute
from thermogear.gears.pair import GearPair


@dataclass(frozen=True, kw_only=True)
class Backlash:
    """Cold half backlash along the line of action [m], and the span its tolerances leave it.

    ``half`` is the one that is computed with; ``least`` and ``most`` equal it where a single
    value was given. ``origin`` says in words where it comes from.
    """

    half: float
    least: float
    most: float
    origin: str

    def __post_init__(self) -> None:
        if not (math.isfinite(self.half) and self.half > 0.0):
            raise InputError(
                "backlash",
                f"a cold half backlash of {1e3 * self.half:.6g} mm",
                allowed="> 0 mm",
                why=f"from {self.origin}",
                fix="thinner teeth or a larger centre distance",
            )


def normal_from_circumferential(circumferential: float, pair: GearPair) -> float:
    """j_n = j_t cos(alpha_w) [m]: backlash on the operating pitch circle, on the line of action.

    Source: ISO 21771-1, spur gears.
    """
    return circumferential * math.cos(pair.operating_pressure_angle)


def normal_from_thickness(allowance: float, pair: GearPair) -> float:
    """j_n = -E_s cos(alpha) [m] that a tooth-thickness allowance E_s [m] (< 0 thinner) opens.

    E_s is measured along the reference circle: the flank turns by E_s/r, and its normal on the
    line of action moves by r_b E_s/r, at whatever centre distance.
    """
    return -allowance * math.cos(pair.pinion.pressure_angle)


def normal_from_distance(distance: float, pair: GearPair) -> float:
    """j_n = 2 (r_b1 + r_b2) [inv(alpha_w) - inv(alpha_0)] [m] at a centre ``distance`` [m].

    alpha_0 is the operating angle of the mesh without backlash; a smaller distance gives a
    negative value. Derivative: dj_n/da = 2 sin(alpha_w).
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
            "backlash.tolerances.centre_distance",
            f"a centre distance of {1e3 * distance:.6g} mm",
            allowed=f"> {1e3 * both:.6g} mm, the sum of the base radii",
        )
    return 2.0 * both * (float(involute(math.acos(both / distance))) - tight)


def cold_from_soaked(half: float, rise: float, pair: GearPair, housing_expansion: float) -> float:
    """Half backlash [m] at T0 of a pair: ``half`` [m] with everything ``rise`` [K] above T0.

    b_cold = b + [lambda_1 rho_C1 + lambda_2 rho_C2 - lambda_h a_w sin(alpha_w)] rise: uniform
    heat turns each flank into a larger involute, growing by lambda tau rho along its normal, taken
    at the pitch point; the housing moves the axes apart. Equal expansions: b_cold = b.
    """
    angle = pair.operating_pressure_angle
    growth = sum(
        gear.material.thermal_expansion * gear.base_radius * math.tan(angle)
        for gear in (pair.pinion, pair.wheel)
    )
    return half + (growth - housing_expansion * pair.centre_distance * math.sin(angle)) * rise


def from_value(
    value: float,
    direction: str,
    extent: str,
    rise: float,
    pair: GearPair,
    housing_expansion: float,
) -> Backlash:
    """A given backlash [m] of a named kind, measured ``rise`` [K] above the reference."""
    normal = value if direction == "normal" else normal_from_circumferential(value, pair)
    half = normal if extent == "half" else 0.5 * normal
    cold = cold_from_soaked(half, rise, pair, housing_expansion)
    origin = f"a {extent} {direction} backlash of {1e3 * value:.6g} mm"
    if rise:
        origin += f" measured {rise:+.6g} K from the reference temperature"
    return Backlash(half=cold, least=cold, most=cold, origin=origin)


def recommended(pair: GearPair) -> Backlash:
    """The least normal backlash of ISO/TR 10064-2, of the whole gap at the drawing temperature.

    j_bn,min = 2/3 (0.06 mm + 0.0005 a + 0.03 m).
    """
    total = 2.0 / 3.0 * (0.06e-3 + 0.0005 * pair.centre_distance + 0.03 * pair.pinion.module)
    origin = f"the least normal backlash of ISO/TR 10064-2, {1e3 * total:.4g} mm"
    return Backlash(half=0.5 * total, least=0.5 * total, most=0.5 * total, origin=origin)


def from_tolerances(
    *,
    pinion: tuple[float, ...],
    wheel: tuple[float, ...],
    distance: tuple[float, ...],
    pair: GearPair,
) -> Backlash:
    """The backlash of the middles of the tolerances, and of their corners.

    ``pinion`` and ``wheel``: tooth-thickness allowances [m] (one, or lower and upper, in any
    order); ``distance``: deviations of the centre distance [m].
    """

    def total(thickness: float, deviation: float) -> float:
        return normal_from_thickness(thickness, pair) + normal_from_distance(
            pair.centre_distance + deviation, pair
        )

    def middle(ends: tuple[float, ...]) -> float:
        return 0.5 * (min(ends) + max(ends))

    return Backlash(
        half=0.5 * total(middle(pinion) + middle(wheel), middle(distance)),
        least=0.5 * total(max(pinion) + max(wheel), min(distance)),
        most=0.5 * total(min(pinion) + min(wheel), max(distance)),
        origin="tooth-thickness allowances and centre-distance tolerance",
    )
