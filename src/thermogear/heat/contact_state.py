"""What a friction law needs to know of a contact: arrays over any positions and points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError

FILMS = ("film_parameter", "central_film_parameter")
"""What is infinite where a pair carries nothing."""
POSITIVE = (
    "reduced_radius", "viscosity", "kinematic_viscosity", "bath_viscosity", "pressure_viscosity",
)  # fmt: skip
"""What is never zero."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PitchPoint:
    """The pair at its operating pitch circle (SI), what laws of mean friction are stated for.

    ``line_load`` whole normal load per face width [N/m], ``sum_speed`` v1 + v2 there [m/s],
    ``reduced_radius`` there [m], ``face_width`` [m]. Numbers, or arrays over operating points
    that broadcast against the contact's other fields (shape (operating, 1)).

    >>> point = PitchPoint(line_load=200e3, sum_speed=5.0, reduced_radius=10e-3, face_width=20e-3)
    >>> float(point.sum_speed)
    5.0
    """

    line_load: ArrayLike
    sum_speed: ArrayLike
    reduced_radius: ArrayLike
    face_width: ArrayLike

    def __post_init__(self) -> None:
        for name in ("line_load", "sum_speed", "reduced_radius", "face_width"):
            values = np.asarray(getattr(self, name), dtype=float)
            object.__setattr__(self, name, values)
            good = values >= 0.0 if name in ("line_load", "sum_speed") else values > 0.0
            if not np.all(good & np.isfinite(values)):
                raise InputError(f"pitch point.{name}", values, allowed="positive, finite")


@dataclass(frozen=True, eq=False, kw_only=True)
class ContactState:
    """The contact of one tooth pair (SI), every field a number or an array that broadcasts.

    ``line_load`` w [N/m] of this pair; ``speed_1``, ``speed_2`` [m/s] rolling speeds of pinion
    and wheel flank; ``reduced_radius`` R [m]; ``pressure`` greatest Hertz pressure [Pa];
    ``viscosity`` eta [Pa s] of the oil that enters the contact, at ambient pressure;
    ``bath_viscosity`` [Pa s] at the temperature of the oil supply, which Benedict and Kelley's
    law and the laws of mean friction take (left out: as ``viscosity``); ``kinematic_viscosity``
    nu [m^2/s] as ``viscosity``; ``roughness`` Ra [m], the mean of both flanks;
    ``film_parameter`` Lambda [-], least film over combined rms roughness;
    ``central_film_parameter`` [-], central film over mean Ra, for Doleschel's share;
    ``pressure_viscosity`` alpha [1/Pa]; ``pitch_point`` for laws of mean friction;
    ``lubricant_kind`` the base oil's family.

    >>> state = ContactState(
    ...     line_load=200e3, speed_1=6.0, speed_2=4.0, reduced_radius=10e-3,
    ...     pressure=0.9e9, viscosity=0.02, roughness=0.4e-6,
    ... )
    >>> f"{state.sum_speed:.1f} m/s"
    '10.0 m/s'
    """

    line_load: ArrayLike
    speed_1: ArrayLike
    speed_2: ArrayLike
    reduced_radius: ArrayLike
    pressure: ArrayLike
    viscosity: ArrayLike
    roughness: ArrayLike
    kinematic_viscosity: ArrayLike | None = None
    film_parameter: ArrayLike | None = None
    central_film_parameter: ArrayLike | None = None
    bath_viscosity: ArrayLike | None = None
    pressure_viscosity: ArrayLike | None = None
    pitch_point: PitchPoint | None = None
    lubricant_kind: str = "mineral"

    def __post_init__(self) -> None:
        for name, values in vars(self).copy().items():
            if values is not None and name not in ("pitch_point", "lubricant_kind"):
                self._check(name, positive=name in POSITIVE)

    def needed(self, name: str, law: str) -> Floats:
        """An optional field as an array, or an error that says which law needs it."""
        value = getattr(self, name)
        if value is None:
            raise InputError(f"contact.{name}", "nothing", why=f"the law {law!r} needs it")
        return np.asarray(value)

    def pitch(self, law: str) -> PitchPoint:
        """The pitch point, or an error that says which law needs it."""
        if self.pitch_point is None:
            raise InputError(
                "contact.pitch_point", "nothing", why=f"the law {law!r} is stated for it"
            )
        return self.pitch_point

    def _check(self, name: str, *, positive: bool) -> None:
        values = np.asarray(getattr(self, name), dtype=float)
        object.__setattr__(self, name, values)
        good = values > 0.0 if positive else values >= 0.0
        if not np.all(good & (np.isfinite(values) | (name in FILMS))):
            worst = values[~good].flat[0] if np.any(~good) else "a value that is not finite"
            raise InputError(
                f"contact.{name}", worst, allowed="> 0, finite" if positive else ">= 0, finite"
            )

    @property
    def oil_viscosity(self) -> Floats:
        """eta [Pa s] of the supplied oil: ``bath_viscosity``, or ``viscosity`` where left out."""
        given = self.viscosity if self.bath_viscosity is None else self.bath_viscosity
        return np.asarray(given)

    @property
    def sliding(self) -> Floats:
        """v1 - v2 [m/s], signed: positive where the pinion flank is the faster."""
        return np.asarray(np.asarray(self.speed_1) - np.asarray(self.speed_2))

    @property
    def sum_speed(self) -> Floats:
        """v1 + v2 [m/s]."""
        return np.asarray(np.asarray(self.speed_1) + np.asarray(self.speed_2))

    @property
    def entrainment(self) -> Floats:
        """(v1 + v2)/2 [m/s]."""
        return np.asarray(0.5 * self.sum_speed)

    @property
    def shape(self) -> tuple[int, ...]:
        """The common shape of all fields."""
        given = [np.shape(v) for v in vars(self).values() if isinstance(v, np.ndarray)]
        if self.pitch_point is not None:
            given += [np.shape(v) for v in vars(self.pitch_point).values()]
        return np.broadcast_shapes(*given)
