"""Cold half backlash on the line of action out of what a drawing or a measurement gives."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError
from thermogear.gears.backlash import backlash_span, normal_from_circumferential
from thermogear.gears.backlash_standards import recommended_normal_backlash
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


def require_room(field: str, half: ArrayLike, pair: GearPair, *, of_half: float = 2.0) -> None:
    """Refuse a ``half`` backlash [m] along the line of action that leaves teeth no thickness.

    The teeth of both gears and the gap share a pitch, along the line of action the base pitch.
    What is given as ``field`` is ``of_half`` times the half backlash.
    """
    room, most = 0.5 * pair.base_pitch * of_half, float(np.max(half)) * of_half
    if most >= room:
        raise InputError(
            field,
            f"{1e3 * most:.6g} mm",
            allowed=f"< {1e3 * room:.4g} mm",
            why="the teeth of both gears share the pitch with the gap and would have no thickness",
            fix="a smaller backlash or a larger module",
        )


def cold_from_soaked(
    half: ArrayLike, rise: float, pair: GearPair, housing_expansion: float
) -> NDArray[np.float64]:
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
    moved = growth - housing_expansion * pair.centre_distance * math.sin(angle)
    return np.asarray(half, dtype=float) + moved * rise


def normal_half(
    value: ArrayLike, direction: str, extent: str, pair: GearPair
) -> NDArray[np.float64]:
    """Half backlash [m] along the line of action of a backlash ``value`` [m] of a named kind."""
    given = np.asarray(value, dtype=float)
    normal = given if direction == "normal" else normal_from_circumferential(given, pair)
    return np.asarray(normal if extent == "half" else 0.5 * normal)


def from_value(
    value: float,
    direction: str,
    extent: str,
    rise: float,
    pair: GearPair,
    housing_expansion: float,
) -> Backlash:
    """A given backlash [m] of a named kind, measured ``rise`` [K] above the reference."""
    half = float(normal_half(value, direction, extent, pair))
    cold = float(cold_from_soaked(half, rise, pair, housing_expansion))
    origin = f"a {extent} {direction} backlash of {1e3 * value:.6g} mm"
    if rise:
        origin += f" measured {rise:+.6g} K from the reference temperature"
    return Backlash(half=cold, least=cold, most=cold, origin=origin)


def recommended(pair: GearPair) -> Backlash:
    """The least normal backlash of ISO/TR 10064-2, of the whole gap at the drawing temperature.

    >>> from thermogear import Gear, GearPair
    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * recommended(pair).half:.0f} um"
    '80 um'
    """
    total = recommended_normal_backlash(pair)
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
    try:
        span = backlash_span(pinion=pinion, wheel=wheel, distance=distance, pair=pair).half
    except InputError as error:
        raise error.under("backlash.tolerances") from error
    return Backlash(
        half=span.middle,
        least=span.least,
        most=span.most,
        origin="tooth-thickness allowances and centre-distance tolerance",
    )
