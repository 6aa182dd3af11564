"""Friction moment of a rolling bearing under radial load: Palmgren's law and SKF's.

Viscosities are kinematic ones nu [m^2/s] of the oil at the bearing, speeds w [rad/s] of the inner
ring, loads [N]; results [N m]. Seals and drag of a drowned bearing are not in them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError
from thermogear.shafts.bearings.geometry import RollingBearing

LUBRICATIONS = ("bath", "grease", "jet")
F0 = {
    ("ball", "bath"): 2.0, ("ball", "grease"): 1.0, ("ball", "jet"): 4.0,
    ("angular", "bath"): 3.3, ("angular", "grease"): 2.0, ("angular", "jet"): 6.6,
    ("roller", "bath"): 3.0, ("roller", "grease"): 0.8, ("roller", "jet"): 6.0,
}  # fmt: skip
"""Palmgren's f0 [-] by kind and lubrication; a jet twice the bath's."""
F1 = {"ball": 0.0002, "angular": 0.0005, "roller": 0.0003}
"""Palmgren's f1 [-] at a tenth of the static rating."""
SERIES = {"60": (4.1e-7, 3.73e-3), "62": (3.9e-7, 3.23e-3), "63": (3.7e-7, 2.84e-3)}
"""SKF's R1 and S1 of deep groove bearings, N mm, mm, mm^2/s and rpm."""
STARVING = {"bath": 3e-8, "grease": 6e-8, "jet": 3e-8}
_MM2, _RPM = 1e6, 30.0 / np.pi


def _kind(bearing: RollingBearing) -> str:
    return "angular" if bearing.kind == "ball" and bearing.contact_angle > 0.0 else bearing.kind


@dataclass(frozen=True, kw_only=True)
class PalmgrenFriction:
    """M = M0 + M1: what the oil takes, and what the load takes.

    M0 = 1e-7 f0 (nu n)^(2/3) d_m^3 [N mm] where nu n >= 2000, else 160e-7 f0 d_m^3, with nu in
    mm^2/s, n in rpm, d_m in mm; M1 = f1 F d_m. f1 of balls is 0.0002 at a tenth of C0 whatever
    the load (a load-dependent one is recalled only and left out). The slow branch joins the fast
    one at nu n = 2000 to 1 %. Source: Palmgren by a public thermal library.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> law = PalmgrenFriction(bearing=catalogue_bearing("6205"))
    >>> m = law.moment(force=1000.0, speed=3000 * np.pi / 30, viscosity=20e-6)
    >>> f"{1e3 * float(m):.1f} N mm"
    '25.2 N mm'
    """

    bearing: RollingBearing
    lubrication: str = "bath"

    def __post_init__(self) -> None:
        _known(self.lubrication)

    def moment(
        self, *, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike
    ) -> NDArray[np.float64]:
        """M [N m] at ``force`` [N], ``speed`` [rad/s] and ``viscosity`` [m^2/s], any shape; 0 at
        rest."""
        kind, size = _kind(self.bearing), self.bearing.pitch_diameter
        turning = np.abs(np.asarray(speed, dtype=float))
        product = _MM2 * np.asarray(viscosity, dtype=float) * turning * _RPM
        factor = np.where(product >= 2000.0, np.maximum(product, 1.0) ** (2.0 / 3.0), 160.0)
        oil = 1e-7 * F0[kind, self.lubrication] * factor * (1e3 * size) ** 3 * 1e-3
        load = F1[kind] * np.abs(np.asarray(force, dtype=float)) * size
        return np.asarray(np.where(turning > 0.0, oil + load, 0.0))


@dataclass(frozen=True, kw_only=True)
class SkfFriction:
    """SKF's rolling and sliding moments of a deep groove bearing without axial load.

    M = p_i p_r R1 d_m^1.96 F^0.54 (nu n)^0.6 + mu S1 d_m^-0.26 F^(5/3) [N mm], p_i = 1/(1 +
    1.84e-9 (n d_m)^1.28 nu^0.64) for the heat of the inlet, p_r = exp(-K_rs nu n (d + D)
    sqrt(3.1/(2 (D - d)))) for the film that is used up, mu = w 0.12 + (1 - w) ``sliding`` with w =
    exp(-2.6e-8 (n nu)^1.4 d_m), d_m = (d + D)/2. mm, rpm, mm^2/s, N. Series 60, 62 and 63. Source:
    SKF's catalogue by public code.

    >>> from thermogear.shafts.bearings.catalogue import catalogue_bearing
    >>> law = SkfFriction(bearing=catalogue_bearing("6205"))
    >>> m = law.moment(force=1000.0, speed=3000 * np.pi / 30, viscosity=20e-6)
    >>> f"{1e3 * float(m):.1f} N mm"
    '20.6 N mm'
    """

    bearing: RollingBearing
    lubrication: str = "bath"
    sliding: float = 0.05

    def __post_init__(self) -> None:
        _known(self.lubrication)
        if not has_skf(self.bearing):
            raise InputError(
                "friction",
                f"skf for {self.bearing.designation or 'a bearing without designation'}",
                allowed="deep groove ball bearings of the series 60, 62 and 63",
                fix='write friction = "palmgren"',
            )

    def moment(
        self, *, force: ArrayLike, speed: ArrayLike, viscosity: ArrayLike
    ) -> NDArray[np.float64]:
        """M [N m] at ``force`` [N], ``speed`` [rad/s] and ``viscosity`` [m^2/s], any shape."""
        one = self.bearing
        rolling, sliding = SERIES[one.designation[:2]]
        d, outside = 1e3 * one.bore, 1e3 * one.outside_diameter
        dm = 0.5 * (d + outside)
        n = np.abs(np.asarray(speed, dtype=float)) * _RPM
        nu = _MM2 * np.asarray(viscosity, dtype=float)
        f = np.abs(np.asarray(force, dtype=float))
        inlet = 1.0 / (1.0 + 1.84e-9 * (n * dm) ** 1.28 * nu**0.64)
        left = np.exp(
            -STARVING[self.lubrication] * nu * n * (d + outside) * np.sqrt(3.1 / 2 / (outside - d))
        )
        weight = np.exp(-2.6e-8 * (n * nu) ** 1.4 * dm)
        friction = 0.12 * weight + self.sliding * (1.0 - weight)
        turned = inlet * left * rolling * dm**1.96 * f**0.54 * (nu * n) ** 0.6
        slid = friction * sliding * dm**-0.26 * f ** (5.0 / 3.0)
        return np.asarray(1e-3 * np.where(n > 0.0, turned + slid, 0.0))


def has_skf(bearing: RollingBearing) -> bool:
    """Whether :class:`SkfFriction` knows the bearing: a deep groove ball bearing by its series."""
    name = bearing.designation
    return len(name) == 4 and name.isdigit() and name[:2] in SERIES


def _known(lubrication: str) -> None:
    if lubrication not in LUBRICATIONS:
        raise InputError("lubrication", repr(lubrication), allowed=" | ".join(LUBRICATIONS))
