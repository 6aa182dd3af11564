"""What makes a flank deviate from the perfect involute: relief, pitch, profile, wear, heat.

Signs: S > 0 is added material on a flank, measured along the line of action; the gap of a
tooth pair is e = -(S_1 + S_2), so that relief makes a positive gap. A deviation answers for
every tooth pair of a mesh at once; several add up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import GeometryError, InputError, nearest
from thermogear.gears.geometry import Gear, GearPair

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]

GEARS = ("pinion", "wheel")
FLANKS = ("drive", "back", "both")


class Contacts(NamedTuple):
    """Where the tooth pairs of a mesh touch, arrays of shape (position, pair).

    s: distance [m] from N1 of the involutes' meeting point; pinion, wheel: string lengths
    rho_1, rho_2 [m] of the points that touch (a tip corner off the path); pinion_tooth,
    wheel_tooth: numbers of the teeth, 0 .. z - 1; flank: "drive" or "back".
    """

    pair: GearPair
    s: Floats
    pinion: Floats
    wheel: Floats
    pinion_tooth: Integers
    wheel_tooth: Integers
    flank: str

    def gear(self, name: str) -> Gear:
        """The named gear of the pair."""
        return self.pair.pinion if name == "pinion" else self.pair.wheel

    def string(self, name: str) -> Floats:
        """rho [m] on the named gear."""
        return self.pinion if name == "pinion" else self.wheel

    def active_profile(self, name: str) -> tuple[float, float, float]:
        """rho [m] of the named gear at the start of contact, the pitch point and the tip."""
        path, length = self.pair.path, self.pair.line_of_action
        if name == "pinion":
            return path.a, path.c, path.e
        return length - path.e, length - path.c, length - path.a


class Deviation(Protocol):
    """Anything that says the gap [m] it makes at the contacts, shape (..., position, pair)."""

    def gap(self, at: Contacts) -> Floats:
        """e [m], > 0 where material is missing; leading axes are operating points."""
        ...


def _choice(field: str, value: str, known: tuple[str, ...]) -> None:
    if value not in known:
        raise InputError(
            field, repr(value), allowed=" | ".join(known), fix=nearest(str(value), known)
        )


def _applies(own: str, at: Contacts) -> bool:
    return own in ("both", at.flank)


@dataclass(frozen=True)
class Relief:
    """Material taken off one gear's flanks towards the tip or the root.

    amount: at the very tip (at the start of active profile) [m], >= 0; length: how far it
    reaches from there [m], measured along the line of action like the path of contact; shape:
    "linear" C x or "parabolic" C x^2 with x from 0 at its start to 1.
    """

    gear: str
    amount: float
    length: float
    end: str = "tip"
    shape: str = "linear"
    flank: str = "both"

    def __post_init__(self) -> None:
        _choice("relief.gear", self.gear, GEARS)
        _choice("relief.end", self.end, ("tip", "root"))
        _choice("relief.shape", self.shape, ("linear", "parabolic"))
        _choice("relief.flank", self.flank, FLANKS)
        if not (math.isfinite(self.amount) and self.amount >= 0.0):
            raise InputError("relief.amount", f"{1e6 * self.amount:g} um", allowed=">= 0, finite")
        if not (math.isfinite(self.length) and self.length > 0.0):
            raise InputError("relief.length", f"{1e3 * self.length:g} mm", allowed="> 0, finite")

    def gap(self, at: Contacts) -> Floats:
        """e = C x or C x^2; GeometryError for a relief longer than the active profile."""
        start, _, tip = at.active_profile(self.gear)
        if self.length > (tip - start) * (1.0 + 1e-12):
            raise GeometryError(
                f"{self.gear}.relief.length",
                f"{1e3 * self.length:.6g} mm",
                allowed=f"<= {1e3 * (tip - start):.6g} mm",
                why=f"the {self.end} relief is longer than the active profile",
            )
        rho = at.string(self.gear)
        if not _applies(self.flank, at):
            return np.zeros_like(rho)
        depth = rho - (tip - self.length) if self.end == "tip" else start + self.length - rho
        x = np.clip(depth / self.length, 0.0, 1.0)
        return self.amount * (x if self.shape == "linear" else x * x)


@dataclass(frozen=True)
class PitchError:
    """Index errors of the teeth of one gear, one per tooth.

    errors [m] along the line of action: > 0 stands a whole tooth towards its drive side, which
    is added material on the drive flank and missing on the back flank.
    """

    gear: str
    errors: tuple[float, ...]

    def __post_init__(self) -> None:
        _choice("pitch_error.gear", self.gear, GEARS)
        object.__setattr__(self, "errors", tuple(float(e) for e in self.errors))
        if not np.all(np.isfinite(self.errors)):
            raise InputError("pitch_error.errors", self.errors, allowed="finite numbers [m]")

    def gap(self, at: Contacts) -> Floats:
        """e = -error on the drive flank, +error on the back flank."""
        teeth = at.gear(self.gear).teeth
        if len(self.errors) != teeth:
            raise InputError(
                f"{self.gear}.pitch_error.errors",
                f"{len(self.errors)} values",
                allowed=f"one for each of the {teeth} teeth",
            )
        tooth = at.pinion_tooth if self.gear == "pinion" else at.wheel_tooth
        sign = -1.0 if at.flank == "drive" else 1.0
        return np.asarray(sign * np.asarray(self.errors)[tooth])


@dataclass(frozen=True)
class PressureAngleError:
    """A flank cut with a pressure angle that is off by ``error`` [rad].

    Its base radius is r_b (1 - tan(alpha) error): S = -tan(alpha) error (rho - rho_C), 0 at the
    pitch point. A larger pressure angle takes material off the tip.
    """

    gear: str
    error: float
    flank: str = "both"

    def __post_init__(self) -> None:
        _choice("pressure_angle_error.gear", self.gear, GEARS)
        _choice("pressure_angle_error.flank", self.flank, FLANKS)
        if not (math.isfinite(self.error) and abs(self.error) < 0.02):
            raise InputError(
                "pressure_angle_error.error", f"{self.error:g} rad", allowed="-0.02 .. 0.02 rad"
            )

    def gap(self, at: Contacts) -> Floats:
        """e = tan(alpha) error (rho - rho_C)."""
        rho = at.string(self.gear)
        if not _applies(self.flank, at):
            return np.zeros_like(rho)
        _, pitch, _ = at.active_profile(self.gear)
        return math.tan(at.gear(self.gear).pressure_angle) * self.error * (rho - pitch)


@dataclass(frozen=True, eq=False)
class FlankTable:
    """Added material S over the radius of one gear's flank: wear, measured profiles, heat.

    radius [m]: rising, shape (n,); added [m]: S, shape (..., n), leading axes are operating
    points (a thermal field each). Linear between the points, constant beyond them.
    """

    gear: str
    radius: ArrayLike
    added: ArrayLike
    flank: str = "both"

    def __post_init__(self) -> None:
        _choice("flank_table.gear", self.gear, GEARS)
        _choice("flank_table.flank", self.flank, FLANKS)
        radius, added = _table("flank_table", "radius", self.radius, self.added)
        object.__setattr__(self, "radius", radius)
        object.__setattr__(self, "added", added)

    def gap(self, at: Contacts) -> Floats:
        """e = -S(r), r = sqrt(r_b^2 + rho^2)."""
        rho = at.string(self.gear)
        if not _applies(self.flank, at):
            return np.zeros_like(rho)
        return -_interpolate(
            np.hypot(at.gear(self.gear).base_radius, rho),
            np.asarray(self.radius),
            np.asarray(self.added),
        )


@dataclass(frozen=True, eq=False)
class PathTable:
    """Added material S of a pair over its position on the path of contact.

    s [m] from N1: rising, shape (n,); added [m]: shape (..., n), leading axes are operating
    points. Linear between the points, constant beyond them.
    """

    s: ArrayLike
    added: ArrayLike
    flank: str = "both"

    def __post_init__(self) -> None:
        _choice("path_table.flank", self.flank, FLANKS)
        s, added = _table("path_table", "s", self.s, self.added)
        object.__setattr__(self, "s", s)
        object.__setattr__(self, "added", added)

    def gap(self, at: Contacts) -> Floats:
        """e = -S(s)."""
        if not _applies(self.flank, at):
            return np.zeros_like(at.s)
        return -_interpolate(at.s, np.asarray(self.s), np.asarray(self.added))


@dataclass(frozen=True, eq=False)
class BasePitchDifference:
    """Two gears of different temperature: base pitches differ by strain x p_b.

    strain = lambda_1 t_1 - lambda_2 t_2, t_i the effective temperature rise u_b/(lambda r_b):
    S = strain (s - s_C) [m], strain [-]. A number or an array over operating points.
    """

    strain: ArrayLike

    def gap(self, at: Contacts) -> Floats:
        """e = -strain (s - s_C)."""
        strain = np.asarray(self.strain, dtype=float)[..., None, None]
        return np.asarray(-strain * (at.s - at.pair.path.c))


def _table(kind: str, axis: str, knots: ArrayLike, added: ArrayLike) -> tuple[Floats, Floats]:
    """Checked float arrays of a table: knots (n,) that rise, values (..., n) that are finite."""
    at, values = np.asarray(knots, dtype=float), np.asarray(added, dtype=float)
    if at.ndim != 1 or at.size < 2 or not np.all(np.diff(at) > 0.0):
        raise InputError(
            f"{kind}.{axis}", f"{at.size} values", allowed="two or more, strictly rising"
        )
    if values.shape[-1:] != at.shape or not np.all(np.isfinite(values)):
        raise InputError(
            f"{kind}.added", f"shape {values.shape}", allowed=f"(..., {at.size}), finite"
        )
    return at, values


def _interpolate(x: Floats, knots: Floats, values: Floats) -> Floats:
    """Linear interpolation of values (..., n) at x of any shape: (..., *x.shape)."""
    at = np.clip(x, knots[0], knots[-1])
    low = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, knots.size - 2)
    weight = (at - knots[low]) / (knots[low + 1] - knots[low])
    return np.asarray(values[..., low] * (1.0 - weight) + values[..., low + 1] * weight)
