"""What changes over a whole turn of the gears: eccentricity, teeth that differ from each other.

Teeth are numbered as in a mesh: number 0 enters at mesh phase 0, number n at phase n, so that a
tooth lies one pitch behind the one before it in the sense of turning. Tooth n of the pinion drives
tooth n of the wheel (mod their numbers of teeth) in the n-th mesh period: that is the mark which
says what meets what. Renumbering the pinion's teeth by k_1 and the wheel's by k_2 leaves the same
assembly where gcd(z_1, z_2) divides k_1 - k_2, and is another one where not.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from typing import ClassVar, TypeVar

import numpy as np

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.base.period import Period
from thermogear.gears.deviations import (
    FLANKS,
    GEARS,
    Contacts,
    Deviation,
    FlankShape,
    PitchError,
    ToothDeviation,
)
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import Damage

T = TypeVar("T")


def tooth_angle(pair: GearPair, name: str) -> float:
    """Where the axis of tooth 0 of the named gear lies at mesh phase 0 [rad].

    Seen from the gear's own axis, from the line to the other axis in the gear's sense of turning:
    s_A/r_b1 - alpha_w - psi_1 of the pinion, alpha_w - (N1N2 - s_A)/r_b2 + psi_2 of the wheel, psi
    the half angle of a tooth on its base circle. Tooth n lies n pitches behind it.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [f"{math.degrees(tooth_angle(pair, name)):.2f} deg" for name in ("pinion", "wheel")]
    ['-19.92 deg', '-5.46 deg']
    """
    angle, start = pair.operating_pressure_angle, pair.path.a
    if name == "pinion":
        return start / pair.pinion.base_radius - angle - pair.pinion.base_half_angle
    string = (pair.line_of_action - start) / pair.wheel.base_radius
    return angle - string + pair.wheel.base_half_angle


@dataclass(frozen=True)
class Eccentricity(ToothDeviation):
    """A gear whose teeth run about a centre beside its axis of rotation: radial run-out 2 e.

    amount: e [m] >= 0; angle [rad]: where the gear's own centre lies, seen from the axis of
    rotation, from the axis of tooth 0 towards tooth 1, so that an angle of 2 pi n/z puts tooth n
    farthest out, and renumbering the teeth by k adds 2 pi k/z. Seen from the line to the other axis
    in the gear's sense of turning the centre lies at theta + gamma, theta = 2 pi phase/z and
    gamma = tooth_angle - ``angle`` (:func:`tooth_angle`).

    All tooth pairs are moved at once: added material along the line of action

        S = e sin(theta + gamma + alpha_w) of the pinion, -e sin(theta + gamma - alpha_w) of the
        wheel, drive flanks; back flanks -e sin(theta + gamma - alpha_w), e sin(theta + gamma +
        alpha_w),

    the part of the gear's shift along the line of action of that flank. Exact to the second order
    in e over the centre distance; the ends of the path move too, which is left out. The half
    backlash varies by -e sin(alpha_w) cos(theta + gamma), least where the gear is nearest to its
    mate. Derived here.

    >>> Eccentricity("wheel", amount=20e-6, angle=0.0).differs
    True
    """

    gear: str
    _: KW_ONLY
    amount: float
    angle: float

    def __post_init__(self) -> None:
        require_choice("eccentricity.gear", self.gear, GEARS)
        bounds.ECCENTRICITY.require_number("eccentricity.amount", self.amount)
        if not math.isfinite(self.angle):
            raise InputError("eccentricity.angle", self.angle, allowed="a finite number [rad]")

    @property
    def differs(self) -> bool:
        """Whether there is any."""
        return self.amount > 0.0

    def mean(self) -> Eccentricity:
        """None: over the turn its mean is 0."""
        return replace(self, amount=0.0)

    def gap(self, at: Contacts) -> Floats:
        """e = -S, the same for all pairs of a position."""
        turned = 2.0 * np.pi * at.phase / at.pair.gear(self.gear).teeth
        turned += tooth_angle(at.pair, self.gear) - self.angle
        # the pinion's drive flank and the wheel's back flank face one way
        side = 1.0 if (self.gear == "pinion") == (at.flank == "drive") else -1.0
        added = side * self.amount * np.sin(turned + side * at.pair.operating_pressure_angle)
        return np.broadcast_to(-added[:, None], at.s.shape)


@dataclass(frozen=True)
class ToothShapes(ToothDeviation):
    """A flank shape for each tooth of a gear: profiles of single teeth, a chart for each tooth.

    shapes: one for each tooth, tooth 0 first, all of this ``gear`` and of the same flank, "drive",
    "back" or "both"; shapes that all teeth have are given once, beside it.

    >>> worn = Relief("pinion", amount=8e-6, length=2e-3)
    >>> ToothShapes("pinion", (replace(worn, amount=20e-6), *[worn] * 19)).differs
    True
    """

    gear: str
    shapes: tuple[FlankShape, ...]
    listed: ClassVar[str] = "tooth_shapes.shapes"

    def __post_init__(self) -> None:
        require_choice("tooth_shapes.gear", self.gear, GEARS)
        object.__setattr__(self, "shapes", tuple(self.shapes))
        for name, allowed in (("gear", (self.gear,)), ("flank", FLANKS)):
            values = {getattr(shape, name) for shape in self.shapes}
            if len(values) != 1 or not values <= set(allowed):
                raise InputError(
                    f"tooth_shapes.{name}",
                    ", ".join(sorted(map(str, values))) or "no shapes",
                    allowed=" | ".join(allowed) + ", the same for all teeth",
                )

    @property
    def differs(self) -> bool:
        """Whether the shapes are not all the same."""
        return any(shape != self.shapes[0] for shape in self.shapes)

    def acts_on(self, flank: str) -> bool:
        """Whether the flanks of that side, "drive" or "back", have these shapes."""
        return self.shapes[0].acts_on(flank)

    def mean(self) -> FlankShape:
        """The mean shape of all teeth."""
        return MeanShape(self.gear, self.shapes) if self.differs else self.shapes[0]

    def gap(self, at: Contacts) -> Floats:
        """e [m] of each pair's tooth at its nominal point."""
        self.require_fits(at.pair)
        tooth = at.tooth(self.gear)
        return np.asarray(
            sum(np.where(tooth == n, self.shapes[n].gap(at), 0.0) for n in np.unique(tooth))
        )


@dataclass(frozen=True)
class MeanShape(FlankShape):
    """The mean of several shapes of one gear's flanks, all of the same side."""

    gear: str
    shapes: tuple[FlankShape, ...]

    @property
    def flank(self) -> str:  # type: ignore[override]
        """The side of the shapes."""
        return self.shapes[0].flank

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """The mean of what the shapes take off."""
        return np.asarray(
            sum(shape.taken_off(pair, rho) for shape in self.shapes) / len(self.shapes)
        )

    def borders(self, pair: GearPair) -> Floats:
        """Those of all shapes."""
        return np.unique(np.concatenate([shape.borders(pair) for shape in self.shapes]))


def numbered_from(
    pair: GearPair, deviation: Deviation, *, pinion: int = 0, wheel: int = 0
) -> Deviation:
    """The ``deviation`` with tooth ``pinion`` and ``wheel``, from 0, of their gears as tooth 0.

    Another assembly, unless gcd(z1, z2) divides the difference of both numbers.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(30, 4e-3))
    >>> errors = PitchError("pinion", (1e-6, 3e-6) * 10)
    >>> f"{1e6 * numbered_from(pair, errors, pinion=1).errors[0]:.1f} um"
    '3.0 um'
    """
    if not isinstance(deviation, ToothDeviation):
        return deviation
    first = pinion if deviation.gear == "pinion" else wheel
    if isinstance(deviation, PitchError):
        return replace(deviation, errors=_rolled(deviation.errors, first))
    if isinstance(deviation, Damage):
        return replace(deviation, tooth=(deviation.tooth - first) % pair.gear(deviation.gear).teeth)
    if isinstance(deviation, ToothShapes):
        return replace(deviation, shapes=_rolled(deviation.shapes, first))
    if isinstance(deviation, Eccentricity):
        step = 2.0 * math.pi / pair.gear(deviation.gear).teeth
        return replace(deviation, angle=deviation.angle - step * first)
    return deviation


def _rolled(values: tuple[T, ...], first: int) -> tuple[T, ...]:
    return values[first:] + values[:first]


def turn_period(pair: GearPair, deviations: Sequence[Deviation]) -> Period:
    """After how many mesh periods the pair with ``deviations`` repeats itself.

    One mesh period where all teeth of each gear are alike; the turn of a gear where its own differ
    or it is eccentric; the turn of the pair, lcm(z1, z2), where that holds for both.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(30, 4e-3))
    >>> turn_period(pair, [Eccentricity("wheel", amount=20e-6, angle=0.0)]).mesh_periods
    30
    """
    differing = {d.gear for d in _of_teeth(pair, deviations) if d.differs}
    return Period.of(
        (pair.pinion.teeth, pair.wheel.teeth),
        pinion="pinion" in differing,
        wheel="wheel" in differing,
    )


def mean_tooth(pair: GearPair, deviations: Sequence[Deviation]) -> tuple[Deviation, ...]:
    """The deviations that all teeth share: means over the teeth, no eccentricity.

    What is alike on all teeth stays as it is, so that without anything else nothing changes.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(30, 4e-3))
    >>> errors = PitchError("pinion", (1e-6,) * 10 + (3e-6,) * 10)
    >>> f"{1e6 * mean_tooth(pair, [errors])[0].errors[0]:.1f} um"
    '2.0 um'
    """
    _of_teeth(pair, deviations)
    return tuple(d.mean() if isinstance(d, ToothDeviation) and d.differs else d for d in deviations)


def _of_teeth(pair: GearPair, deviations: Sequence[Deviation]) -> list[ToothDeviation]:
    """Those that may differ from tooth to tooth; refused where they do not fit the gears."""
    several: list[ToothDeviation] = [d for d in deviations if isinstance(d, ToothDeviation)]
    for deviation in several:
        deviation.require_fits(pair)
    return several
