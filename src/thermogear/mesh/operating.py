"""The state a pair is operated in: speeds, torques, oil, temperatures, cold backlash."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS, Lubricant, Material

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Temperatures:
    """Given body temperatures [K]; each a number or an array over operating points.

    ``reference`` T0 is where the drawing's dimensions and the cold backlash hold.
    """

    reference: float
    pinion_addendum: ArrayLike
    pinion_bore: ArrayLike
    wheel_addendum: ArrayLike
    wheel_bore: ArrayLike
    housing: ArrayLike

    def __post_init__(self) -> None:
        for field in fields(self):
            values = np.asarray(getattr(self, field.name), dtype=float)
            if not np.all(np.isfinite(values) & (values > 0.0)):
                raise InputError(
                    f"temperatures.{field.name}", f"{values} K", allowed="> 0 K, finite"
                )

    @classmethod
    def uniform(cls, temperature: ArrayLike, reference: float) -> Temperatures:
        """Gears and housing all at ``temperature``: nothing but size changes."""
        return cls(reference, *([temperature] * 5))

    def cold(self) -> Temperatures:
        """Everything at the reference temperature."""
        return Temperatures.uniform(self.reference, self.reference)


@dataclass(frozen=True)
class Operating:
    """Operating points of a gear pair (SI), arrays of one shape ``(operating,)``.

    Speed, torque and all temperatures are numbers or arrays that broadcast to that shape.

    ``speed`` pinion speed [rad/s] > 0, ``torque`` pinion torque [N m] >= 0 (the wheel carries
    torque x ratio), ``half_backlash`` cold half backlash b [m] along the line of action,
    ``oil_temperature`` [K] of the oil that enters the mesh; ``housing`` the material that moves
    the axes apart when it is warm.
    """

    speed: Floats
    torque: Floats
    lubricant: Lubricant
    oil_temperature: ArrayLike
    temperatures: Temperatures
    half_backlash: float
    housing: Material = MATERIALS["steel"]

    def __post_init__(self) -> None:
        t = self.temperatures
        shapes = {name: np.shape(getattr(self, name)) for name in ("speed", "torque")}
        shapes["oil_temperature"] = np.shape(self.oil_temperature)
        shapes |= {f.name: np.shape(getattr(t, f.name)) for f in fields(t) if f.name != "reference"}
        try:
            shape = np.broadcast_shapes((1,), *shapes.values())
        except ValueError:
            shape = ()
        if len(shape) != 1:
            given = ", ".join(f"{name} {s}" for name, s in shapes.items() if s)
            raise InputError("operating", given, allowed="numbers and arrays of one length")
        speed, torque = (
            np.broadcast_to(np.asarray(values, dtype=float), shape)
            for values in (self.speed, self.torque)
        )
        object.__setattr__(self, "speed", speed)
        object.__setattr__(self, "torque", torque)
        if not np.all(np.isfinite(speed) & (speed >= 0.0)):
            raise InputError("operating.speed", f"{speed} rad/s", allowed=">= 0, finite")
        oil = np.asarray(self.oil_temperature, dtype=float)
        if not np.all(np.isfinite(oil) & (oil > 0.0)):
            raise InputError("operating.oil_temperature", f"{oil} K", allowed="> 0 K, finite")
        if not np.all(np.isfinite(torque) & (torque >= 0.0)):
            raise InputError("operating.torque", f"{torque} N m", allowed=">= 0, finite")
        if not (np.isfinite(self.half_backlash) and self.half_backlash > 0.0):
            raise InputError(
                "operating.half_backlash", f"{self.half_backlash} m", allowed="> 0, finite"
            )
