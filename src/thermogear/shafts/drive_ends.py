"""What an induction motor does to the train: its torque over speed, a damper behind a lag.

Kloss: T = 2 T_k/(s/s_k + s_k/s), slip s = 1 - w/w_s. Near the rated speed the motor is a damper
T_N/(s_N w_s) behind a lag T_el = 1/(w_1 s_k): T_el T' + T = T(s). Far above 1/T_el, as at mesh
frequency, next to nothing but its inertia is left.

Checked against the equivalent circuit of a 7.5 kW motor with public data, at rest and in motion:
from 0 to 1 kHz damper and lag together are within 16 % of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError


@dataclass(frozen=True, kw_only=True)
class InductionMotor:
    """A motor by its plate (SI): ``rated_torque`` T_N [N m] at ``rated_speed`` w [rad/s].

    ``overload`` l = T_k/T_N > 1, usually 2 to 3.5; ``line_frequency`` [Hz]; ``pole_pairs``. The
    breakdown slip s_k = s_N (l + sqrt(l^2 - 1)) puts Kloss's curve through the rated point; through
    the true (s_k, T_k) it would be some 10 % low there. A starting torque needs the circuit.

    >>> motor = InductionMotor(
    ...     rated_torque=49.25, rated_speed=1454.3 * np.pi / 30, overload=2.33, pole_pairs=2)
    >>> f"{motor.slip_damping:.1f} N m s behind {1e3 * motor.lag:.0f} ms"
    '10.3 N m s behind 24 ms'
    """

    rated_torque: float
    rated_speed: float
    overload: float
    pole_pairs: int
    line_frequency: float = 50.0

    def __post_init__(self) -> None:
        for name, unit in (("rated_torque", "N m"), ("line_frequency", "Hz")):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(name, f"{value:.6g} {unit}", allowed=f"> 0 {unit}")
        if not 1 <= self.pole_pairs <= 100:
            raise InputError("pole_pairs", self.pole_pairs, allowed="1..100")
        if not (np.isfinite(self.overload) and self.overload > 1.0):
            raise InputError(
                "overload", self.overload, allowed="> 1", why="the motor pulls out below its rating"
            )
        if not 0.0 < self.rated_speed < self.synchronous_speed:
            rpm = 30.0 / np.pi
            raise InputError(
                "rated_speed",
                f"{rpm * self.rated_speed:.6g} rpm",
                allowed=f"0..{rpm * self.synchronous_speed:.6g} rpm, below synchronous speed",
                fix="check pole_pairs and line_frequency",
            )
        if self.breakdown_slip >= 1.0:
            raise InputError(
                "rated_speed",
                f"a slip of {self.rated_slip:.3g}",
                allowed="breakdown slip < 1",
                why=f"with overload {self.overload:.4g} it would be {self.breakdown_slip:.3g}",
                fix="check pole_pairs and line_frequency",
            )

    @property
    def synchronous_speed(self) -> float:
        """w_s = 2 pi f/p [rad/s]."""
        return 2.0 * np.pi * self.line_frequency / self.pole_pairs

    @property
    def rated_slip(self) -> float:
        """s_N = 1 - w_N/w_s [-]."""
        return 1.0 - self.rated_speed / self.synchronous_speed

    @property
    def breakdown_slip(self) -> float:
        """s_k = s_N (l + sqrt(l^2 - 1)) [-]: Kloss's curve passes the rated point."""
        return float(self.rated_slip * (self.overload + np.sqrt(self.overload**2 - 1.0)))

    @property
    def slip_damping(self) -> float:
        """T_N/(s_N w_s) [N m s]: fall of the torque per speed, by the chord to no load.

        The tangent at the rated point is (1 - q^2)/(1 + q^2) of it, q = s_N/s_k; 0.9 at l = 2.3.
        """
        return self.rated_torque / (self.rated_slip * self.synchronous_speed)

    @property
    def lag(self) -> float:
        """T_el = 1/(w_1 s_k) [s], w_1 = 2 pi ``line_frequency``."""
        return 1.0 / (2.0 * np.pi * self.line_frequency * self.breakdown_slip)

    def torque(self, speed: ArrayLike) -> NDArray[np.float64]:
        """Steady torque [N m] at ``speed`` [rad/s], any shape; negative above synchronous speed."""
        slip = 1.0 - np.asarray(speed, dtype=float) / self.synchronous_speed
        scaled = slip / self.breakdown_slip
        return np.asarray(2.0 * self.overload * self.rated_torque * scaled / (1.0 + scaled**2))
