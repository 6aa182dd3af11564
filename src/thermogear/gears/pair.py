"""A driving pinion and a driven wheel: their path of contact, and pairs that cannot mesh.

Lengths are metres, angles radians.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from thermogear.base import bounds
from thermogear.base.errors import GeometryError, ValidityWarning
from thermogear.gears.geometry import LEFT_OUT, Gear, inverse_involute, involute, millimetres

_CLEAR = 1e-5
"""Modules by which a corner may seem to go into a tooth: what sampling leaves."""


class PathPoints(NamedTuple):
    """Distances [m] from the pinion's tangent point N1 along the line of action.

    a: contact starts (wheel tip); b: the leading pair leaves when this one is here;
    c: pitch point; d: the following pair enters; e: contact ends (pinion tip).

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [round(1e3 * s, 2) for s in pair.path]
    [3.56, 11.06, 13.68, 15.37, 22.87]
    """

    a: float
    b: float
    c: float
    d: float
    e: float


def tight_distance(pinion: Gear, wheel: Gear, shift: float | None = None) -> float:
    """Centre distance a_w [m] without backlash; nan where no position meshes.

    (r_b1 + r_b2)/cos(alpha_w), inv(alpha_w) = inv(alpha) + 2 tan(alpha)(x_1 + x_2)/(z_1 + z_2).
    ``shift`` x_1 + x_2 [modules] left out is that of the gears. Source: ISO 21771-1.

    >>> f"{1e3 * tight_distance(Gear(20, 4e-3), Gear(40, 4e-3)):.1f} mm"
    '120.0 mm'
    """
    total = pinion.profile_shift + wheel.profile_shift if shift is None else shift
    if total == 0.0:
        return pinion.pitch_radius + wheel.pitch_radius
    alpha = pinion.pressure_angle
    widened = 2.0 * math.tan(alpha) * total / (pinion.teeth + wheel.teeth)
    value = float(involute(alpha)) + widened
    if not value > 0.0:
        return math.nan
    return (pinion.base_radius + wheel.base_radius) / math.cos(float(inverse_involute(value)))


@dataclass(frozen=True)
class GearPair:
    """A driving pinion and a driven wheel; ``centre_distance`` a [m] left out is free of backlash.

    A centre distance above that opens a normal backlash; one below it jams and is refused.
    One gear given twice means two equal ones.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e3 * pair.centre_distance:.1f} mm, contact ratio {pair.contact_ratio:.3f}"
    '120.0 mm, contact ratio 1.635'
    """

    pinion: Gear
    wheel: Gear
    centre_distance: float = LEFT_OUT

    def __post_init__(self) -> None:
        if self.wheel is self.pinion:
            # each has temperatures of its own
            object.__setattr__(self, "wheel", replace(self.pinion))
        for name in ("module", "pressure_angle"):
            mine, other = getattr(self.pinion, name), getattr(self.wheel, name)
            if not math.isclose(mine, other, rel_tol=1e-12):
                shown = (
                    (millimetres(other), millimetres(mine))
                    if name == "module"
                    else (f"{math.degrees(other):.6g} deg", f"{math.degrees(mine):.6g} deg")
                )
                raise GeometryError(
                    f"wheel.{name}",
                    shown[0],
                    allowed=f"{shown[1]}, the pinion's",
                    why="both gears come from one rack",
                )
        tightest = tight_distance(self.pinion, self.wheel)
        if math.isnan(tightest):
            shift = self.pinion.profile_shift + self.wheel.profile_shift
            raise GeometryError(
                "wheel.profile_shift",
                f"{self.wheel.profile_shift:g}",
                why=f"the sum of the shifts {shift:g} leaves no meshing position",
                fix="raise a profile shift",
            )
        if self.centre_distance is LEFT_OUT:
            object.__setattr__(self, "centre_distance", tightest)
        bounds.CENTRE_DISTANCE.require_number("centre_distance", self.centre_distance)
        if not self.centre_distance >= tightest * (1.0 - 1e-12):
            raise GeometryError(
                "centre_distance",
                millimetres(self.centre_distance),
                allowed=f">= {millimetres(tightest)}",
                why="the teeth would wedge (no backlash left)",
            )
        self._check_tips()
        ratio = self.contact_ratio
        if not ratio >= 1.0:
            raise GeometryError(
                "contact_ratio",
                f"{ratio:.4f}",
                allowed=">= 1",
                why="the next pair enters after the last one has left",
                fix="lengthen the teeth, take more teeth or a smaller centre distance"
                + ", or raise the profile shift of undercut ones" * self.cut_short,
            )
        if ratio < 1.2:
            warnings.warn(
                f"contact_ratio: got {ratio:.4f}; recommended >= 1.2; little is left for "
                "tolerances and tip relief",
                ValidityWarning,
                stacklevel=3,
            )

    def _check_tips(self) -> None:
        length = self.line_of_action
        for name, mine, other, other_name in (
            ("wheel", self.wheel, self.pinion, "pinion"),
            ("pinion", self.pinion, self.wheel, "wheel"),
        ):
            reach = float(mine.curvature_radius(mine.tip_form_radius))
            lowest = other.base_radius * other.junction[1]
            # the tip may come down to the other's form circle, and never past its tangent point
            longest = length - lowest
            too_long = reach > longest * (1.0 + 1e-9)
            if too_long and other.undercut and not other.allow_undercut:
                raise GeometryError(
                    f"{other_name}.profile_shift",
                    f"{other.profile_shift:g} for {other.teeth} teeth",
                    why=f"undercut takes {millimetres(reach - longest)} of the path of contact",
                    fix=f"use {self._accepted(mine, other)}allow_undercut (`new --allow-undercut`) "
                    "to have the rest of the path",
                )
            if too_long and not (other.undercut and self._clears(mine, other)):
                where = "tangent point" if reach > length else "form circle"
                raise GeometryError(
                    f"{name}.tip_radius",
                    millimetres(mine.tip_radius),
                    allowed="<= "
                    + millimetres(
                        math.hypot(mine.base_radius, longest)
                        + (mine.tip_radius - mine.tip_form_radius)
                    ),
                    why=f"interference: the tip reaches below the {other_name}'s {where}",
                    fix=f"lower the tip radius or raise {other_name}.profile_shift",
                )
            gap = self.centre_distance - mine.tip_radius - other.root_radius
            if not gap > 0.0:
                raise GeometryError(
                    f"{name}.tip_radius",
                    millimetres(mine.tip_radius),
                    allowed=f"< {millimetres(self.centre_distance - other.root_radius)}",
                    why=f"the tip hits the {other_name}'s root (clearance {millimetres(gap)})",
                )

    def _accepted(self, mine: Gear, other: Gear) -> str:
        """Least profile shift to a hundredth, and least teeth, at which no contact is cut away.

        Of ``other`` beside ``mine`` as it is, at the centre distance given or, where that would
        be too close, without backlash; in words, empty where neither does it.
        """

        reach = float(mine.curvature_radius(mine.tip_form_radius))

        def whole(teeth: int, shift: float) -> bool:
            higher = 0.5 * (teeth - other.teeth) + shift - other.profile_shift
            tip = other.tip_radius + higher * other.module
            try:
                changed = replace(other, teeth=teeth, profile_shift=shift, tip_radius=tip)
                lowest = changed.base_radius * changed.junction[1]
            except GeometryError:
                return False
            both = mine.base_radius + changed.base_radius
            apart = max(self.centre_distance, tight_distance(mine, changed))
            return apart > both and reach <= (math.sqrt(apart**2 - both**2) - lowest) * (1.0 + 1e-9)

        x, z = other.profile_shift, other.teeth
        shifts = range(
            math.floor(100.0 * x) + 1, math.ceil(100.0 * other.minimum_profile_shift) + 1
        )
        numbers = range(z + 1, other.minimum_teeth + 1)
        ways = [f"x >= {0.01 * n:.2f}" for n in shifts if whole(z, 0.01 * n)][:1]
        ways += [f">= {n} teeth" for n in numbers if whole(n, x)][:1]
        return f"{' or '.join(ways)}, where what is cut lies below the flank in use, or " * bool(
            ways
        )

    def _clears(self, mine: Gear, other: Gear) -> bool:
        """Whether the tip corner of ``mine`` stays out of the undercut tooth of ``other``.

        The sharp corner, inside of which any edge lies. Its way past the tooth of ``other``, as
        :mod:`thermogear.gears.corner` has it, is held against flank and fillet at 2001 places.
        """
        reach = float(mine.curvature_radius(mine.tip_radius))
        r_1, r_2, a = other.base_radius, mine.base_radius, self.centre_distance
        # angle of the corner from the line of centres, as long as it is below the other's tip
        ends = (a**2 + mine.tip_radius**2 - other.tip_radius**2) / (2.0 * a * mine.tip_radius)
        beyond = math.acos(min(ends, 1.0)) * np.linspace(-1.0, 1.0, 2001)
        turned = math.atan2(reach, r_2) - self.operating_pressure_angle + beyond
        length = self.line_of_action
        point = r_1 + r_2 + 1j * length - (r_2 + 1j * reach) * np.exp(-1j * turned)
        axis = (length - reach + r_2 * turned) / r_1 - other.base_half_angle
        x, y = other.fillet.point(np.linspace(0.5 * math.pi, other.junction[0], 2001))
        radius = np.abs(point)
        half = np.where(
            radius < other.form_radius,
            np.interp(radius, np.hypot(x, y), np.arctan2(x, y)),
            other.half_thickness_angle(np.maximum(radius, other.form_radius)),
        )
        deepest = float(np.max(radius * (half - np.angle(point) + axis)))
        return deepest <= _CLEAR * other.module

    def gear(self, name: str) -> Gear:
        """The gear called "pinion" or "wheel"."""
        return self.pinion if name == "pinion" else self.wheel

    @property
    def ratio(self) -> float:
        """u = z2/z1."""
        return self.wheel.teeth / self.pinion.teeth

    @property
    def face_width(self) -> float:
        """The common face width [m]: the smaller of the two."""
        return min(self.pinion.face_width, self.wheel.face_width)

    @property
    def base_pitch(self) -> float:
        """p_b = pi m cos(alpha) [m]."""
        return self.pinion.base_pitch

    @property
    def operating_pressure_angle(self) -> float:
        """alpha_w = arccos((r_b1 + r_b2)/a_w) [rad]."""
        both = self.pinion.base_radius + self.wheel.base_radius
        return math.atan2(self.line_of_action, both)

    @cached_property
    def line_of_action(self) -> float:
        """Length N1 N2 = sqrt(a_w^2 - (r_b1 + r_b2)^2) [m] between the two tangent points."""
        both = self.pinion.base_radius + self.wheel.base_radius
        return math.sqrt((self.centre_distance - both) * (self.centre_distance + both))

    @cached_property
    def tip_ends(self) -> tuple[float, float]:
        """Where the tips' flanks alone would have the path begin and end [m]."""
        reach = [float(g.curvature_radius(g.tip_form_radius)) for g in (self.wheel, self.pinion)]
        return self.line_of_action - reach[0], reach[1]

    @cached_property
    def path(self) -> PathPoints:
        """The points A..E of the path of contact, which ends at a tip or where an undercut does."""
        (start, end), p, w = self.tip_ends, self.pinion, self.wheel
        if p.undercut:
            start = max(start, p.base_radius * p.junction[1])
        if w.undercut:
            end = min(end, self.line_of_action - w.base_radius * w.junction[1])
        pitch = self.pinion.base_radius * math.tan(self.operating_pressure_angle)
        return PathPoints(start, end - self.base_pitch, pitch, start + self.base_pitch, end)

    @property
    def cut_short(self) -> bool:
        """Whether undercut ends the path of contact before a tip does."""
        return (self.path.a, self.path.e) != self.tip_ends

    @property
    def start_radii(self) -> tuple[float, float]:
        """r_Nf [m] where the active profile begins: what the other gear's tip still touches.

        r_Nf1 = sqrt((N1N2 - sqrt(r_Fa2^2 - r_b2^2))^2 + r_b1^2), and the wheel's alike. Above each
        gear's form radius in every pair that can mesh. Source: ISO 21771-1.
        """
        return (
            math.hypot(self.pinion.base_radius, self.path.a),
            math.hypot(self.wheel.base_radius, self.line_of_action - self.path.e),
        )

    @property
    def tip_clearances(self) -> tuple[float, float]:
        """c = a - r_a1 - r_f2 and a - r_a2 - r_f1 [m]: from a tip to the other gear's root."""
        return (
            self.centre_distance - self.pinion.tip_radius - self.wheel.root_radius,
            self.centre_distance - self.wheel.tip_radius - self.pinion.root_radius,
        )

    @property
    def contact_ratio(self) -> float:
        """Length of the path of contact over the base pitch."""
        return (self.path.e - self.path.a) / self.base_pitch

    @property
    def operating_radii(self) -> tuple[float, float]:
        """Pitch radii [m] of the rolling circles at this centre distance."""
        first = self.centre_distance / (1.0 + self.ratio)
        return first, self.centre_distance - first

    @property
    def normal_backlash(self) -> float:
        """Total backlash [m] along the line of action that the centre distance opens.

        j_n = (p_w - s_w1 - s_w2) cos(alpha_w) = p_b - 2 r_b1 psi_1(r_w1) - 2 r_b2 psi_2(r_w2);
        0 for the zero-backlash mesh.
        """
        return self.base_pitch - sum(
            2.0 * gear.base_radius * float(gear.half_thickness_angle(radius))
            for gear, radius in zip((self.pinion, self.wheel), self.operating_radii, strict=True)
        )

    def swapped(self) -> GearPair:
        """The same two gears with the wheel driving."""
        return GearPair(self.wheel, self.pinion, self.centre_distance)
