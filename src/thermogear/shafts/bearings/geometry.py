"""The inside of a rolling bearing: elements, raceways, rings, and what follows from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thermogear.base.errors import InputError
from thermogear.shafts.bearings.hertz import ball_coefficient, roller_coefficient
from thermogear.shafts.bearings.laws import ElementLaw

STEEL = 7800.0
"""Density of the rings [kg/m^3]."""
KINDS = ("ball", "roller")
MOST_ANGLE = np.pi / 4.0
"""Greatest contact angle [rad] of a radial bearing."""


@dataclass(frozen=True, kw_only=True)
class RollingBearing:
    """A radial ball or cylindrical roller bearing (SI).

    ``bore`` d, ``outside_diameter`` D, ``width`` B; ``elements`` Z of ``element_diameter`` D_w on
    the ``pitch_diameter`` d_m; ``element_length`` L of rollers; ``contact_angle`` [rad];
    ``conformities`` f of inner and outer race, r/D_w, of balls; ``dynamic_rating`` C and
    ``static_rating`` C0 [N], None where unknown.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> one = catalogue_bearing("6205")
    >>> f"{one.outer_order:.4f}"
    '3.5722'
    """

    designation: str = ""
    kind: str
    bore: float
    outside_diameter: float
    width: float
    elements: int
    element_diameter: float
    pitch_diameter: float
    element_length: float | None = None
    contact_angle: float = 0.0
    conformities: tuple[float, float] = (0.52, 0.53)
    dynamic_rating: float | None = None
    static_rating: float | None = None

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError("kind", repr(self.kind), allowed=" | ".join(KINDS))
        for name in ("bore", "outside_diameter", "width", "element_diameter", "pitch_diameter"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(name, f"{1e3 * value:.6g} mm", allowed="> 0 mm")
        if not 3 <= self.elements <= 200:
            raise InputError("elements", self.elements, allowed="3..200")
        room = self.pitch_diameter * np.sin(np.pi / self.elements)
        if self.element_diameter >= room:
            raise InputError(
                "element_diameter",
                _mm(self.element_diameter),
                allowed=f"< {_mm(room)}",
                why=f"{self.elements} elements do not fit on the pitch circle",
                fix="give fewer or smaller elements, or another pitch_diameter",
            )
        if self.inner_raceway <= self.bore or self.outer_raceway >= self.outside_diameter:
            raise InputError(
                "pitch_diameter",
                _mm(self.pitch_diameter),
                allowed="raceways inside the rings: bore < d_m - D_w and d_m + D_w < outside",
                why=f"raceways of {_mm(self.inner_raceway)} and {_mm(self.outer_raceway)} in rings "
                f"of {_mm(self.bore)} and {_mm(self.outside_diameter)}",
            )
        self._require_elements()

    def _require_elements(self) -> None:
        if not 0.0 <= self.contact_angle <= MOST_ANGLE:
            raise InputError(
                "contact_angle",
                f"{np.degrees(self.contact_angle):.6g} deg",
                allowed=f"0..{np.degrees(MOST_ANGLE):.0f} deg, a radial bearing",
            )
        if self.element_diameter > self.width and self.kind == "ball":
            raise InputError(
                "element_diameter",
                _mm(self.element_diameter),
                allowed=f"<= {_mm(self.width)}",
                why="a ball is no wider than its rings",
            )
        if self.kind == "roller":
            length = self.element_length
            if length is None:
                raise InputError("element_length", "nothing", why="a roller needs its length")
            if not 0.0 < length <= self.width:
                raise InputError(
                    "element_length", _mm(length), allowed=f"0..{_mm(self.width)}, the width"
                )
        for name in ("dynamic_rating", "static_rating"):
            value = getattr(self, name)
            if value is not None and not (np.isfinite(value) and value > 0.0):
                raise InputError(name, f"{value:.6g} N", allowed="> 0 N")
        if self.kind == "ball" and not all(0.5 < f < 0.7 for f in self.conformities):
            raise InputError("conformities", list(self.conformities), allowed="0.5 < f < 0.7")

    @property
    def ratio(self) -> float:
        """g = D_w cos a/d_m [-]."""
        return float(self.element_diameter * np.cos(self.contact_angle) / self.pitch_diameter)

    @property
    def inner_raceway(self) -> float:
        """F_i = d_m - D_w cos a [m], a diameter."""
        return self.pitch_diameter * (1.0 - self.ratio)

    @property
    def outer_raceway(self) -> float:
        """F_o = d_m + D_w cos a [m], a diameter."""
        return self.pitch_diameter * (1.0 + self.ratio)

    @property
    def exponent(self) -> float:
        """n of Q = K delta^n: 1.5 balls, 10/9 rollers."""
        return 1.5 if self.kind == "ball" else 10.0 / 9.0

    @cached_property
    def element_coefficient(self) -> float:
        """K of Q = K delta^n between both races [N/m^n]."""
        if self.kind == "ball":
            return ball_coefficient(
                self.element_diameter, diameter_ratio=self.ratio, conformities=self.conformities
            )
        return roller_coefficient(float(self.element_length or 0.0))

    @property
    def cage_order(self) -> float:
        """Turns of the cage in one of the inner ring, (1 - g)/2: elements that roll (Harris)."""
        return 0.5 * (1.0 - self.ratio)

    @property
    def outer_order(self) -> float:
        """Elements passing a point of the outer ring, Z (1 - g)/2: varying compliance, BPFO."""
        return self.elements * self.cage_order

    @property
    def outer_ring_mass(self) -> float:
        """Mass [kg] of a steel ring from the outer raceway to the outside."""
        area = 0.25 * np.pi * (self.outside_diameter**2 - self.outer_raceway**2)
        return float(STEEL * area * self.width)

    def law(self, clearance: float, cage_angle: float = 0.0) -> ElementLaw:
        """Force of its elements over the displacement.

        ``clearance`` radial [m], half of the play, below zero a preload; ``cage_angle`` [rad] of
        the first element. A contact angle widens the stiffness by cos a to the power n + 1.
        """
        share = float(np.cos(self.contact_angle)) ** (self.exponent + 1.0)
        return ElementLaw(
            elements=self.elements,
            coefficient=self.element_coefficient * share,
            exponent=self.exponent,
            clearance=clearance,
            cage_angle=cage_angle,
        )


def _mm(value: float) -> str:
    return f"{1e3 * value:.6g} mm"
