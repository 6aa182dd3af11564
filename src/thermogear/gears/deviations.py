"""What makes a flank deviate from the perfect involute: relief, pitch, profile, wear, heat.

Signs: S > 0 is added material on a flank, measured along the line of action; the gap of a
tooth pair is e = -(S_1 + S_2), so that relief makes a positive gap. A deviation answers for
every tooth pair of a mesh at once; several add up. What is a shape of one flank says so as a
:class:`FlankShape`: flanks that deviate touch next to the nominal point of contact.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass
from typing import ClassVar, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import GeometryError, InputError, require_choice
from thermogear.gears.pair import GearPair

GEARS = ("pinion", "wheel")
FLANKS = ("drive", "back", "both")
_BETWEEN = 9


class Contacts(NamedTuple):
    """Where the tooth pairs of a mesh touch, arrays of shape (position, pair).

    s: distance [m] from N1 of the involutes' meeting point; pinion, wheel: string lengths
    rho_1, rho_2 [m] of the points that touch (a tip corner off the path); pinion_tooth,
    wheel_tooth: numbers of the teeth, 0 .. z - 1; flank: "drive" or "back"; phase (position,): mesh
    phase [periods], at which each gear has turned by 2 pi phase/z.
    """

    pair: GearPair
    s: Floats
    pinion: Floats
    wheel: Floats
    pinion_tooth: NDArray[np.int64]
    wheel_tooth: NDArray[np.int64]
    flank: str
    phase: Floats

    def string(self, name: str) -> Floats:
        """rho [m] on the named gear."""
        return self.pinion if name == "pinion" else self.wheel

    def tooth(self, name: str) -> NDArray[np.int64]:
        """Numbers of the named gear's teeth."""
        return self.pinion_tooth if name == "pinion" else self.wheel_tooth


def active_profile(pair: GearPair, name: str) -> tuple[float, float, float]:
    """rho [m] of the named gear at the start of contact, the pitch point and the tip.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [f"{1e3 * rho:.2f} mm" for rho in active_profile(pair, "pinion")]
    ['3.56 mm', '13.68 mm', '22.87 mm']
    """
    path, length = pair.path, pair.line_of_action
    if name == "pinion":
        return path.a, path.c, path.e
    return length - path.e, length - path.c, length - path.a


class Deviation(Protocol):
    """Anything that says the gap [m] it makes at the contacts, shape (..., position, pair).

    One that differs from tooth to tooth is a :class:`ToothDeviation` beside it; all others are
    alike on every tooth, so that they repeat in each mesh period.
    """

    def gap(self, at: Contacts) -> Floats:
        """e [m], > 0 where material is missing; leading axes are operating points."""


class ToothDeviation(ABC):
    """A deviation of one ``gear`` that may differ from tooth to tooth, or over its turn.

    ``listed``: its kind and the field that has one value for each tooth.
    """

    gear: str
    listed: ClassVar[str] = ""

    @abstractmethod
    def gap(self, at: Contacts) -> Floats:
        """e [m] of each pair by the numbers of its teeth, or by the turn of its gear."""

    @property
    @abstractmethod
    def differs(self) -> bool:
        """Whether it makes the teeth of its gear differ."""

    @abstractmethod
    def mean(self) -> Deviation:
        """What is alike on all teeth: its mean over them."""

    def require_fits(self, pair: GearPair) -> None:
        """Refuse what is listed for each tooth of its gear and has not as many values."""
        values = getattr(self, self.listed.rpartition(".")[2], None)
        teeth = pair.gear(self.gear).teeth
        if values is not None and len(values) != teeth:
            raise InputError(
                f"{self.gear}.{self.listed}",
                f"{len(values)} values",
                allowed=f"one for each of the {teeth} teeth",
            )


class FlankShape(ABC):
    """A deviation that is the shape of one gear's flanks, on the side ``flank``."""

    gear: str
    flank: str

    def acts_on(self, flank: str) -> bool:
        """Whether the flanks of that side, "drive" or "back", have this shape."""
        return self.flank in ("both", flank)

    @abstractmethod
    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e [m] at the string lengths ``rho`` [m] of the gear, any shape: (..., *rho.shape)."""

    @classmethod
    def each(
        cls, shapes: Sequence[FlankShape], pair: GearPair, rho: Floats, *, weights: Floats
    ) -> Floats:
        """Weighted means over the last axis of ``rho`` [m] of what each shape takes off [m].

        The shapes first, then their operating points, then the other axes of ``rho``.
        """
        means = [shape.taken_off(pair, rho) @ weights for shape in shapes]
        return np.stack(np.broadcast_arrays(*means))

    def borders(self, pair: GearPair) -> Floats:
        """String lengths [m], shape (n,), between which a polynomial of fifth degree will do.

        Its corners, and so many places in between that it turns once from one to the next.
        """
        return np.empty(0)

    def gap(self, at: Contacts) -> Floats:
        """e [m] at the points named; 0 on the other side's flanks."""
        rho = at.string(self.gear)
        return self.taken_off(at.pair, rho) if self.acts_on(at.flank) else np.zeros_like(rho)


@dataclass(frozen=True)
class Relief(FlankShape):
    """Material taken off one gear's flanks towards the tip or the root.

    amount: at the very tip (at the start of active profile) [m], >= 0; length: how far it
    reaches from there [m], measured along the line of action like the path of contact; shape:
    "linear" C x or "parabolic" C x^2 with x from 0 at its start to 1.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> relief = Relief("pinion", amount=20e-6, length=4e-3)
    >>> (1e6 * relief.taken_off(pair, pair.path.e - np.array([0.0, 2e-3, 4e-3]))).round(1)
    array([20., 10.,  0.])
    """

    gear: str
    _: KW_ONLY
    amount: float
    length: float
    end: str = "tip"
    shape: str = "linear"
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("relief.gear", self.gear, GEARS)
        require_choice("relief.end", self.end, ("tip", "root"))
        require_choice("relief.shape", self.shape, ("linear", "parabolic"))
        require_choice("relief.flank", self.flank, FLANKS)
        bounds.RELIEF_AMOUNT.require("relief.amount", self.amount)
        bounds.RELIEF_LENGTH.require("relief.length", self.length)

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = C x or C x^2; GeometryError for a relief longer than the active profile."""
        start, _, tip = active_profile(pair, self.gear)
        if self.length > (tip - start) * (1.0 + 1e-12):
            raise GeometryError(
                f"{self.gear}.relief.length",
                f"{1e3 * self.length:.6g} mm",
                allowed=f"<= {1e3 * (tip - start):.6g} mm",
                why=f"the {self.end} relief is longer than the active profile",
            )
        depth = rho - (tip - self.length) if self.end == "tip" else start + self.length - rho
        x = np.minimum(np.maximum(depth / self.length, 0.0), 1.0)
        return self.amount * (x if self.shape == "linear" else x * x)

    def borders(self, pair: GearPair) -> Floats:
        """Where it begins and where it has its whole amount."""
        start, _, tip = active_profile(pair, self.gear)
        ends = (tip, tip - self.length) if self.end == "tip" else (start, start + self.length)
        return np.array(ends)


@dataclass(frozen=True)
class PitchError(ToothDeviation):
    """Index errors of the teeth of one gear, one per tooth.

    errors [m] along the line of action: > 0 puts a whole tooth towards its drive side, which
    is added material on the drive flank and missing on the back flank.

    >>> PitchError("wheel", errors=(4e-6, -2e-6)).gear
    'wheel'
    """

    gear: str
    errors: tuple[float, ...]
    listed: ClassVar[str] = "pitch_error.errors"

    def __post_init__(self) -> None:
        require_choice("pitch_error.gear", self.gear, GEARS)
        object.__setattr__(self, "errors", tuple(float(e) for e in self.errors))
        bounds.PITCH_ERROR.require("pitch_error.errors", self.errors)

    @property
    def differs(self) -> bool:
        """Whether the errors are not all the same."""
        return len(set(self.errors)) > 1

    def mean(self) -> PitchError:
        """All teeth with the mean error."""
        return PitchError(self.gear, (float(np.mean(self.errors)),) * len(self.errors))

    def gap(self, at: Contacts) -> Floats:
        """e = -error on the drive flank, +error on the back flank."""
        self.require_fits(at.pair)
        sign = -1.0 if at.flank == "drive" else 1.0
        return np.asarray(sign * np.asarray(self.errors)[at.tooth(self.gear)])


@dataclass(frozen=True)
class PressureAngleError(FlankShape):
    """A flank cut with a pressure angle that is off by ``error`` [rad].

    Its base radius is r_b (1 - tan(alpha) error): S = -tan(alpha) error (rho - rho_C), 0 at the
    pitch point. A larger pressure angle takes material off the tip.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> error = PressureAngleError("pinion", 1e-3)
    >>> f"{1e6 * error.taken_off(pair, np.array(pair.path.c + 5e-3)):.2f} um"
    '1.82 um'
    """

    gear: str
    error: float
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("pressure_angle_error.gear", self.gear, GEARS)
        require_choice("pressure_angle_error.flank", self.flank, FLANKS)
        bounds.ANGLE_ERROR.require("pressure_angle_error.error", self.error)

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = tan(alpha) error (rho - rho_C)."""
        _, pitch, _ = active_profile(pair, self.gear)
        return math.tan(pair.pinion.pressure_angle) * self.error * (rho - pitch)


@dataclass(frozen=True, eq=False)
class FlankTable(FlankShape):
    """Added material S over the radius of one gear's flank: wear, measured profiles, heat.

    radius [m]: rising, shape (n,); added [m]: S, shape (..., n), leading axes are operating
    points (a thermal field each). Linear between the points, constant beyond them.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> worn = FlankTable("pinion", radius=[38e-3, 44e-3], added=[-10e-6, -10e-6])
    >>> f"{1e6 * worn.taken_off(pair, np.array(pair.path.c)):.1f} um"
    '10.0 um'
    """

    gear: str
    _: KW_ONLY
    radius: ArrayLike
    added: ArrayLike
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("flank_table.gear", self.gear, GEARS)
        require_choice("flank_table.flank", self.flank, FLANKS)
        radius, added = _table("flank_table", "radius", self.radius, self.added)
        bounds.PROFILE_RADIUS.require("flank_table.radius", radius)
        object.__setattr__(self, "radius", radius)
        object.__setattr__(self, "added", added)

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = -S(r), r = sqrt(r_b^2 + rho^2)."""
        gear = pair.gear(self.gear)
        radius = np.hypot(gear.base_radius, rho)
        return -_interpolate(radius, np.asarray(self.radius), np.asarray(self.added))

    def borders(self, pair: GearPair) -> Floats:
        """Its points, and places close enough to make r(rho) a polynomial to 1e-13 m."""
        gear = pair.gear(self.gear)
        radius = np.maximum(np.asarray(self.radius), gear.base_radius)
        points = np.sqrt((radius - gear.base_radius) * (radius + gear.base_radius))
        start, _, tip = active_profile(pair, self.gear)
        return np.concatenate([points, np.linspace(start, tip, _BETWEEN)])


@dataclass(frozen=True, eq=False, kw_only=True)
class PathTable:
    """Added material S of a pair over its position on the path of contact.

    s [m] from N1: rising, shape (n,); added [m]: shape (..., n), leading axes are operating
    points. Linear between the points, constant beyond them.
    """

    s: ArrayLike
    added: ArrayLike
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("path_table.flank", self.flank, FLANKS)
        s, added = _table("path_table", "s", self.s, self.added)
        object.__setattr__(self, "s", s)
        object.__setattr__(self, "added", added)

    def gap(self, at: Contacts) -> Floats:
        """e = -S(s)."""
        if self.flank not in ("both", at.flank):
            return np.zeros_like(at.s)
        return -_interpolate(at.s, np.asarray(self.s), np.asarray(self.added))


@dataclass(frozen=True, eq=False)
class BasePitchDifference:
    """Two gears of different temperature: base pitches differ by strain x p_b.

    strain = lambda_1 t_1 - lambda_2 t_2, t_i the effective temperature rise u_b/(lambda r_b):
    S = strain (s - s_C) [m], strain [-], off the path that of its end, whose tip touches there. A
    number or an array over operating points.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> strain = 11.5e-6 * (80.0 - 60.0)  # pinion 80 K, wheel 60 K above the drawing
    >>> f"{1e6 * strain * pair.base_pitch:.2f} um, {BasePitchDifference(strain).strain:.2e}"
    '2.72 um, 2.30e-04'
    """

    strain: ArrayLike

    def gap(self, at: Contacts) -> Floats:
        """e = -strain (s - s_C)."""
        strain, path = np.asarray(self.strain, dtype=float)[..., None, None], at.pair.path
        return np.asarray(-strain * (np.clip(at.s, path.a, path.e) - path.c))


def _table(kind: str, axis: str, knots: ArrayLike, added: ArrayLike) -> tuple[Floats, Floats]:
    """Checked float arrays of a table: knots (n,) that rise, values (..., n) that are finite."""
    at, values = np.array(knots, dtype=float), np.array(added, dtype=float)
    if at.ndim != 1 or at.size < 2 or not np.all(np.diff(at) > 0.0):
        raise InputError(
            f"{kind}.{axis}", f"{at.size} values", allowed="two or more, strictly rising"
        )
    if values.shape[-1:] != at.shape or not np.all(np.isfinite(values)):
        raise InputError(
            f"{kind}.added", f"shape {values.shape}", allowed=f"(..., {at.size}), finite"
        )
    bounds.ADDED.require(f"{kind}.added", values)
    # the table's own, for good: gaps are remembered by it
    at.setflags(write=False)
    values.setflags(write=False)
    return at, values


def _interpolate(x: Floats, knots: Floats, values: Floats) -> Floats:
    """Linear interpolation of values (..., n) at x of any shape: (..., *x.shape)."""
    at = np.clip(x, knots[0], knots[-1])
    low = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, knots.size - 2)
    weight = (at - knots[low]) / (knots[low + 1] - knots[low])
    return np.asarray(values[..., low] * (1.0 - weight) + values[..., low + 1] * weight)
