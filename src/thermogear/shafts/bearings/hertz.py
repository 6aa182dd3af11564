"""Point contact of a ball with its races and line contact of a roller: stiffness and pressure.

Hertz, by complete elliptic integrals. For the radii of a race with conformity f = r/D_w:
S = (4 - 1/f + 2 q)/D_w, F = (1/f + 2 q)/(4 - 1/f + 2 q), q = g/(1 - g) at the inner and -g/(1 + g)
at the outer race, g = D_w cos a/d_m. The ellipse's ratio k solves F = 1 - 2/(k^2 - 1) (K/E - 1)
with m = 1 - 1/k^2. Then a^3 = 3 k^2 E Q/(pi S E*), delta = 3 K Q/(2 pi E* a), p0 = 3 Q k/(2 pi
a^2), E* = Y/2(1 - nu^2) of two equal bodies.

Checked against the published stiffness of a 6305 and the closed form of two spheres.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

YOUNGS_MODULUS, POISSON_RATIO = 210e9, 0.3
"""Of bearing steel [Pa], [-]; customary values lie between 206 and 210 GPa."""


@dataclass(frozen=True, kw_only=True)
class PointContact:
    """A ball on one race (SI): curvature sum S [1/m] and the ellipse's ratio k >= 1.

    ``modulus`` E* [Pa].

    >>> contact = race_contact(11.5e-3, diameter_ratio=0.264, conformity=0.52, inner=True)
    >>> f"{contact.deflection(1000.0) * 1e6:.2f} um"
    '10.19 um'
    """

    curvature: float
    ratio: float
    modulus: float

    @property
    def _integrals(self) -> tuple[float, float]:
        return complete_integrals(self.ratio)

    def half_length(self, load: float) -> float:
        """a [m], the longer half axis, under ``load`` [N]."""
        _, e = self._integrals
        return float(
            np.cbrt(3.0 * self.ratio**2 * e * load / (np.pi * self.curvature * self.modulus))
        )

    def deflection(self, load: float) -> float:
        """delta [m] under ``load`` [N]."""
        if load == 0.0:
            return 0.0
        k, _ = self._integrals
        return 3.0 * k * load / (2.0 * np.pi * self.modulus * self.half_length(load))

    def pressure(self, load: float) -> float:
        """p0 [Pa] in the middle under ``load`` [N]."""
        return 3.0 * load * self.ratio / (2.0 * np.pi * self.half_length(load) ** 2)


def complete_integrals(ratio: float) -> tuple[float, float]:
    """K and E, the complete elliptic integrals of m = 1 - 1/k^2, of the ``ratio`` k."""
    from scipy.special import ellipe, ellipkm1

    rest = 1.0 / ratio**2
    return float(ellipkm1(rest)), float(ellipe(1.0 - rest))


def ellipse_ratio(difference: float) -> float:
    """k >= 1 of the contact ellipse for the curvature difference F in 0..1.

    >>> f"{ellipse_ratio(0.9):.3f}"
    '6.713'
    """

    from scipy.optimize import brentq

    def away(log_ratio: float) -> float:
        ratio = np.exp(log_ratio)
        k, e = complete_integrals(ratio)
        return float(1.0 - 2.0 / (ratio**2 - 1.0) * (k / e - 1.0) - difference)

    return 1.0 if difference < 1e-9 else float(np.exp(brentq(away, 1e-6, 12.0, xtol=1e-14)))


def race_contact(
    element_diameter: float,
    *,
    diameter_ratio: float,
    conformity: float,
    inner: bool,
    youngs_modulus: float = YOUNGS_MODULUS,
    poisson_ratio: float = POISSON_RATIO,
) -> PointContact:
    """The contact of a ball with one race.

    ``element_diameter`` D_w [m], ``diameter_ratio`` g = D_w cos a/d_m, ``conformity`` f = r/D_w of
    the race > 0.5.
    """
    g, f = diameter_ratio, conformity
    q = g / (1.0 - g) if inner else -g / (1.0 + g)
    total = 4.0 - 1.0 / f + 2.0 * q
    return PointContact(
        curvature=total / element_diameter,
        ratio=ellipse_ratio((1.0 / f + 2.0 * q) / total),
        modulus=0.5 * youngs_modulus / (1.0 - poisson_ratio**2),
    )


@lru_cache(maxsize=256)
def ball_coefficient(
    element_diameter: float,
    *,
    diameter_ratio: float,
    conformities: tuple[float, float] = (0.52, 0.53),
    youngs_modulus: float = YOUNGS_MODULUS,
    poisson_ratio: float = POISSON_RATIO,
) -> float:
    """K of Q = K delta^1.5 for a ball between both races [N/m^1.5].

    (d_i + d_o)^-1.5 with d = delta/Q^(2/3). ``conformities`` of inner and outer race.

    >>> k = ball_coefficient(11.5e-3, diameter_ratio=11.5 / 43.5)
    >>> f"{k * 1e-3**1.5:.0f} N/mm^1.5"
    '333592 N/mm^1.5'
    """
    total = sum(
        race_contact(
            element_diameter,
            diameter_ratio=diameter_ratio,
            conformity=f,
            inner=inner,
            youngs_modulus=youngs_modulus,
            poisson_ratio=poisson_ratio,
        ).deflection(1.0)
        for f, inner in zip(conformities, (True, False), strict=True)
    )
    return float(total**-1.5)


def roller_coefficient(length: float) -> float:
    """K of Q = K delta^(10/9) for a steel roller between both races [N/m^(10/9)].

    35 948 L^(8/9) N/mm^(10/9) with the effective ``length`` L in mm (here [m]). Source: ISO 16281.

    >>> f"{roller_coefficient(9e-3) * 1e-3 ** (10 / 9):.0f} N/mm^(10/9)"
    '253449 N/mm^(10/9)'
    """
    return float(35948.0 * (1e3 * length) ** (8.0 / 9.0) * 1e3 ** (10.0 / 9.0))
