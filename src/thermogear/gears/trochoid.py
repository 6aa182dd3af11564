"""The fillet of a generated tooth: the curve a rack's rounded tip cuts into the root.

Tooth frame: origin at the gear centre, y along the tooth axis, x towards the flank.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Trochoid:
    """Envelope of a circle of ``radius`` rho whose centre rides on the rolling rack.

    The centre lies ``centre_depth`` a1 below the rolling line and ``centre_offset`` b1 beside
    the tooth axis. The contact normal goes through the pitch point at angle gamma to that
    line: gamma = pi/2 at the root circle, gamma = alpha where the rack's straight flank ends.
    """

    pitch_radius: float
    centre_depth: float
    centre_offset: float
    radius: float

    def roll(self, gamma: ArrayLike) -> Floats:
        """Roll angle phi = (a1/tan(gamma) + b1)/r [rad]."""
        g = np.asarray(gamma, dtype=float)
        cotangent = np.cos(g) / np.sin(g)
        return np.asarray((self.centre_depth * cotangent + self.centre_offset) / self.pitch_radius)

    def point(self, gamma: ArrayLike) -> tuple[Floats, Floats]:
        """(x, y) [m] of the fillet at the rack normal angle ``gamma`` [rad], any shape.

        x = r sin(phi) - l cos(gamma - phi), y = r cos(phi) - l sin(gamma - phi),
        l = a1/sin(gamma) + rho the distance from the pitch point.
        """
        g = np.asarray(gamma, dtype=float)
        phi = self.roll(g)
        lever = self.centre_depth / np.sin(g) + self.radius
        x = self.pitch_radius * np.sin(phi) - lever * np.cos(g - phi)
        y = self.pitch_radius * np.cos(phi) - lever * np.sin(g - phi)
        return x, y

    def height_rate(self, gamma: ArrayLike) -> Floats:
        """dy/dgamma [m/rad] along the fillet, the derivative of :meth:`point`."""
        g = np.asarray(gamma, dtype=float)
        sine, cosine = np.sin(g), np.cos(g)
        phi = self.roll(g)
        phi_rate = -self.centre_depth / (sine**2 * self.pitch_radius)
        lever = self.centre_depth / sine + self.radius
        lever_rate = -self.centre_depth * cosine / sine**2
        return np.asarray(
            -self.pitch_radius * np.sin(phi) * phi_rate
            - lever_rate * np.sin(g - phi)
            - lever * np.cos(g - phi) * (1.0 - phi_rate)
        )

    def section_at_slope(self, slope: float) -> float:
        """gamma [rad] where the fillet's tangent makes ``slope`` [rad] with the tooth axis.

        The tangent is normal to the contact normal: the angle is gamma - phi(gamma). It rises
        towards the root circle, with the centre above the rolling line only from
        sin^2(gamma) = -a1/r on.
        """
        from scipy.optimize import brentq  # half a second that checking a case need not spend

        turning = math.asin(math.sqrt(min(max(-self.centre_depth / self.pitch_radius, 0.0), 1.0)))
        low = max(turning, 1e-3)
        return float(
            brentq(lambda g: g - float(self.roll(g)) - slope, low, 0.5 * math.pi, xtol=1e-15)
        )

    def crossing(self, base_radius: float, base_half_angle: float) -> float | None:
        """gamma [rad] where an undercut fillet leaves the involute, None if it never meets it.

        Going up the fillet from the root circle, the first point outside the base circle at
        which the involute's half angle theta_b - inv(alpha_k) exceeds the fillet's no longer.
        """

        def excess(gamma: ArrayLike) -> Floats:
            x, y = self.point(gamma)
            r = np.hypot(x, y)
            t = np.sqrt(np.maximum((r / base_radius) ** 2 - 1.0, 0.0))
            return base_half_angle - (t - np.arctan(t)) - np.arctan2(x, y)

        gammas = np.linspace(0.5 * math.pi, 0.02, 4001)
        x, y = self.point(gammas)
        outside = np.hypot(x, y) > base_radius
        gap = excess(gammas)
        hits = np.nonzero(outside[1:] & (gap[:-1] > 0.0) & (gap[1:] <= 0.0))[0]
        if hits.size == 0:
            return None
        from scipy.optimize import brentq

        low, high = gammas[hits[0] + 1], gammas[hits[0]]
        return float(brentq(lambda g: float(excess(g)), low, high, xtol=1e-15))
