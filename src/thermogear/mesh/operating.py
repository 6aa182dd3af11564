"""The state a pair is operated in: speeds, torques, oil, temperatures, cold backlash."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import MATERIALS, Lubricant, Material

LEADERS = {
    "pinion_bore": "the pinion's addendum",
    "pinion_body": "the pinion's addendum",
    "wheel_bore": "the wheel's addendum",
    "wheel_body": "the wheel's addendum",
    "housing": "the mean of both addenda",
}
"""Whose excess over the reference a body's excess goes along with."""
PROPORTION = (0.0, 1.5)
"""Excesses over the gears' that a linear heat network of bodies warmed by the gears can have."""


@dataclass(frozen=True, kw_only=True)
class Temperatures:
    """Given body temperatures [K]; each a number or an array over operating points.

    ``reference`` T0 is where the drawing's dimensions and the cold backlash hold.
    ``pinion_body`` and ``wheel_body``: the body nodes of a heat balance
    (:func:`~thermogear.heat.gearbox.body_radius`), through which the radial field then passes;
    None: the field is logarithmic from bore to addendum.

    >>> Temperatures.uniform(353.15, reference=293.15).wheel_bore
    353.15
    """

    reference: float
    pinion_addendum: ArrayLike
    pinion_bore: ArrayLike
    wheel_addendum: ArrayLike
    wheel_bore: ArrayLike
    housing: ArrayLike
    pinion_body: ArrayLike | None = None
    wheel_body: ArrayLike | None = None

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if value is not None:
                bounds.BODY.require(f"temperatures.{field.name}", value)

    @classmethod
    def uniform(cls, temperature: ArrayLike, *, reference: float) -> Temperatures:
        """Gears and housing all at ``temperature``: nothing but size changes."""
        outer = [f.name for f in fields(cls) if f.name != "reference" and f.default is not None]
        return cls(reference=reference, **dict.fromkeys(outer, temperature))

    def cold(self) -> Temperatures:
        """Every body that is known at the reference temperature."""
        return replace(self, **dict.fromkeys(self.bodies, self.reference))

    @property
    def bodies(self) -> dict[str, Floats]:
        """Every known body's temperature [K] by its field's name; the reference is no body."""
        names = (f.name for f in fields(self) if f.name != "reference")
        known = {name: getattr(self, name) for name in names}
        return {name: np.asarray(t, dtype=float) for name, t in known.items() if t is not None}


@dataclass(frozen=True, kw_only=True, eq=False)
class Varied:
    """What of a pair differs between its operating points, SI, each (operating,); None: alike.

    ``half_backlash`` cold, ``face_width`` the common one, roughness Ra, Young's modulus at 20 C and
    thermal expansion of each gear, the housing's expansion. Everything else of the pair, its
    geometry above all, is one for all points.
    """

    half_backlash: Floats | None = None
    face_width: Floats | None = None
    pinion_roughness: Floats | None = None
    wheel_roughness: Floats | None = None
    pinion_modulus: Floats | None = None
    wheel_modulus: Floats | None = None
    pinion_expansion: Floats | None = None
    wheel_expansion: Floats | None = None
    housing_expansion: Floats | None = None

    @property
    def grows(self) -> bool:
        """Whether the points' gears or housing expand differently."""
        given = (self.pinion_expansion, self.wheel_expansion, self.housing_expansion)
        return any(one is not None for one in given)

    def part(self, places: slice | NDArray[np.int64]) -> Varied:
        """Some of the operating points alone."""
        given = {f.name: getattr(self, f.name) for f in fields(self)}
        return Varied(**{k: None if v is None else v[places] for k, v in given.items()})


ALIKE = Varied()
"""Nothing of the pair differs."""


@dataclass(frozen=True)
class Operating:
    """Operating points of a gear pair (SI), arrays of one shape ``(operating,)``.

    Speed, torque and all temperatures are numbers or arrays that broadcast to that shape.

    ``speed`` pinion speed [rad/s] > 0, ``torque`` pinion torque [N m] >= 0 (the wheel carries
    torque x ratio), ``half_backlash`` cold half backlash b [m] along the line of action,
    ``oil_temperature`` [K] of the oil supply; ``housing`` the material that moves the axes apart
    when it is warm. ``flank_temperature`` [K] where the film forms, for a model whose inlet is the
    body's; left out, the mean of both addenda. ``varied``: what of the pair itself differs between
    the points, in place of the pair's and of ``half_backlash``. ``pulled``: 1 where the gears grow
    by the centrifugal pull of their speed, 0 where they have the drawing's sizes.

    >>> from thermogear import lubricant
    >>> warm = Temperatures.uniform(353.15, reference=293.15)
    >>> point = Operating(
    ...     speed=[100.0], torque=[200.0], lubricant=lubricant("FVA3"), oil_temperature=353.15,
    ...     temperatures=warm, half_backlash=60e-6,
    ... )
    >>> point.speed.shape
    (1,)
    """

    speed: Floats
    torque: Floats
    lubricant: Lubricant
    oil_temperature: ArrayLike
    temperatures: Temperatures
    half_backlash: float
    housing: Material = MATERIALS["steel"]
    flank_temperature: ArrayLike | None = None
    varied: Varied = ALIKE
    pulled: ArrayLike = 1.0

    def __post_init__(self) -> None:
        t = self.temperatures
        shapes = {name: np.shape(getattr(self, name)) for name in ("speed", "torque")}
        shapes["oil_temperature"] = np.shape(self.oil_temperature)
        shapes |= {name: np.shape(body) for name, body in t.bodies.items()}
        if self.flank_temperature is not None:
            shapes["flank_temperature"] = np.shape(self.flank_temperature)
            bounds.BODY.require("operating.flank_temperature", self.flank_temperature)
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
        bounds.SPEED.require("operating.speed", speed)
        bounds.BODY.require("operating.oil_temperature", self.oil_temperature)
        bounds.TORQUE.require("operating.torque", torque)
        bounds.HALF_BACKLASH.require("operating.half_backlash", self.half_backlash)

    @property
    def no_bath(self) -> NDArray[np.bool_]:
        """Where the oil is hotter than any bath of it, (operating,)."""
        hot = np.asarray(self.oil_temperature) > self.lubricant.hottest_bath
        return np.broadcast_to(hot, self.speed.shape)

    def point(self, place: int) -> Operating:
        """The operating point ``place`` alone."""
        return self.part(slice(place, place + 1))

    def part(self, places: slice | NDArray[np.int64]) -> Operating:
        """Some of the operating points alone."""

        def at(values: ArrayLike) -> ArrayLike:
            array = np.asarray(values, dtype=float)
            return array[places] if array.ndim and array.size > 1 else values

        bodies: dict[str, Any] = {n: at(body) for n, body in self.temperatures.bodies.items()}
        return replace(
            self,
            speed=self.speed[places],
            torque=self.torque[places],
            oil_temperature=at(self.oil_temperature),
            temperatures=replace(self.temperatures, **bodies),
            flank_temperature=None if self.flank_temperature is None else at(self.flanks),
            lubricant=self.lubricant.part(places),
            pulled=at(self.pulled),
            varied=self.varied.part(places),
        )

    @property
    def flanks(self) -> Floats:
        """Temperature [K] of the flanks where the film forms: as given, or both addenda's mean."""
        t = self.temperatures.bodies
        mean = 0.5 * (t["pinion_addendum"] + t["wheel_addendum"])
        return np.asarray(mean if self.flank_temperature is None else self.flank_temperature, float)

    def as_drawn(self) -> Operating:
        """The same points with the drawing's sizes, oil and film unchanged: nothing has grown."""
        cold = self.temperatures.cold()
        return replace(self, temperatures=cold, flank_temperature=self.flanks, pulled=0.0)

    def with_gears_at(self, gear_temperature: ArrayLike) -> Operating:
        """The same points with both addenda at ``gear_temperature`` [K], the rest in proportion.

        A number, or one for each point. Every excess over the reference scales with the gears': a
        bore's with its own addendum's, housing's and oil's with the mean of both addenda. At the
        reference all is as it is drawn.
        Raises InputError where the gears are at the reference: they give no proportion. Warns
        (ValidityWarning) where a body or the oil lies outside 0 to 1.5 times the gears' excess:
        drawn out to other temperatures it would run away from them.
        """
        t, base = self.temperatures, self.temperatures.reference
        bodies = t.bodies
        pinion, wheel = bodies["pinion_addendum"] - base, bodies["wheel_addendum"] - base
        leading = {"pinion": pinion, "wheel": wheel, "housing": 0.5 * (pinion + wheel)}
        followed = {
            name: leading[name.partition("_")[0]]
            for name in ("pinion_bore", "wheel_bore", "housing", "pinion_body", "wheel_body")
            if name in bodies
        }
        wanted = np.asarray(gear_temperature, dtype=float)
        rise = wanted - base
        still = [LEADERS[name] for name, excess in followed.items() if np.any(excess == 0.0)]
        if np.any(rise != 0.0) and still:
            raise InputError(
                "gear temperature",
                f"{wanted[rise != 0.0].flat[0]:.6g} K",
                allowed=f"{base:.6g} K",
                why=f"{still[0]} stands at the reference temperature, which gives no proportion",
                fix="give the addenda other temperatures",
            )
        oil_now = np.asarray(self.oil_temperature, dtype=float)

        def beside(temperature: Floats, excess: Floats) -> Floats:
            beyond = np.where(excess == 0.0, 0.0, temperature - base - excess)
            # counted from the gears, so that what is as warm as they are stays so to the last bit
            return np.asarray(wanted + rise * (beyond / np.where(excess == 0.0, 1.0, excess)))

        changed: dict[str, Any] = {n: beside(bodies[n], excess) for n, excess in followed.items()}
        for name in ("pinion_addendum", "wheel_addendum"):
            changed[name] = np.broadcast_to(
                wanted, np.broadcast_shapes(bodies[name].shape, wanted.shape)
            )
        oil = beside(oil_now, followed["housing"])
        there = replace(
            self,
            oil_temperature=oil,
            temperatures=replace(t, **changed),
            flank_temperature=None,
        )
        if np.any(rise != 0.0):
            for name, excess in followed.items():
                _warn_of_proportion(f"temperatures.{name}", bodies[name] - base, excess)
            _warn_of_proportion("oil.temperature", oil_now - base, followed["housing"])
        return there


def _warn_of_proportion(field: str, excess: Floats, leader: Floats) -> None:
    """Warn where ``excess`` [K] is no sensible part of the gears' ``leader`` [K]."""
    low, high = PROPORTION
    ratio = excess / leader
    strange = (ratio < low) | (ratio > high)
    if np.any(strange):
        place = int(np.flatnonzero(np.ravel(strange))[0])
        own, gears = (np.broadcast_to(x, strange.shape).ravel()[place] for x in (excess, leader))
        warnings.warn(
            f"{field}: stands {own:.4g} K over the reference temperature where the gears stand "
            f"{gears:.4g} K over it; in proportion, which is meant for {low:g} to {high:g} times "
            'the gears\' excess, it runs away from them; temperatures.follow = "fixed" keeps its '
            "distance",
            ValidityWarning,
            stacklevel=4,
        )
