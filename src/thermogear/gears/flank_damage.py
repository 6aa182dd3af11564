"""Flanks that are damaged: pockets broken out of one tooth, and wear.

A pocket as wide as the face is a shape of that tooth's flank. In a narrower one the floor is not
reached: the rest of the width carries alone, which presses deeper (:class:`Spall`). The loaded
contact is plane, so that where across the face a pocket lies does not count.
Checked by ``tests/gears/test_flank_damage.py``: a pocket of the whole flank is a pitch error, two
rows of springs side by side, wear at the pitch point and by hand.
"""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import KW_ONLY, dataclass

import numpy as np

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import GeometryError, InputError, require_choice
from thermogear.gears.contact import pair_reduced_modulus
from thermogear.gears.corner import flank_ends
from thermogear.gears.deviations import (
    FLANKS,
    GEARS,
    Contacts,
    FlankShape,
    FlankTable,
)
from thermogear.gears.geometry import millimetres
from thermogear.gears.loaded import solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import Damage
from thermogear.gears.turn import ToothShapes

WIDEST_SPALL = 0.9
"""Of the face width: beside a wider pocket too little is left to carry alone (chosen)."""
_PHASES = 48
"""Of a mesh period, at which the share of the load that wears a flank is taken."""


def spalled(pair: GearPair, name: str, *, radius: float, length: float) -> tuple[float, float]:
    """String lengths [m] between which the named gear's flank is broken out.

    radius [m]: of the middle; length [m]: along the flank, whose arc from the base circle is
    rho^2/(2 r_b). Cut off where the flank ends. GeometryError for a middle beside the flank.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> ends = spalled(pair, "pinion", radius=40e-3, length=2e-3)
    >>> [f"{1e3 * rho:.2f} mm" for rho in ends]
    ['10.58 mm', '16.20 mm']
    """
    gear, ends = pair.gear(name), flank_ends(pair)[GEARS.index(name)]
    low, high = (math.hypot(gear.base_radius, rho) for rho in ends)
    if not low <= radius <= high:
        raise GeometryError(
            "spall.radius",
            millimetres(radius),
            allowed=f"{millimetres(low)}..{millimetres(high)}, from form to tip circle",
        )
    middle = (radius - gear.base_radius) * (radius + gear.base_radius)
    squares = (middle + side * gear.base_radius * length for side in (-1.0, 1.0))
    start, end = (math.sqrt(max(square, 0.0)) for square in squares)
    return max(start, ends[0]), min(end, ends[1])


@dataclass(frozen=True)
class Pocket(FlankShape):
    """A pocket as wide as the face: ``depth`` [m] taken off, with walls that fall at 45 degrees.

    radius [m]: of its middle; length [m]: along the flank, from rim to rim. A pocket that is longer
    than the flank takes the depth off the whole of it.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> pocket = Pocket("pinion", radius=40e-3, length=2e-3, depth=0.1e-3)
    >>> (1e6 * pocket.taken_off(pair, pair.path.c + np.array([0.0, 2.5e-3, 4e-3]))).round(1)
    array([100. ,   6.9,   0. ])
    """

    gear: str
    _: KW_ONLY
    radius: float
    length: float
    depth: float
    flank: str = "drive"

    def __post_init__(self) -> None:
        require_choice("spall.gear", self.gear, GEARS)
        require_choice("spall.flank", self.flank, FLANKS)
        bounds.PROFILE_RADIUS.require("spall.radius", self.radius)
        bounds.RELIEF_LENGTH.require("spall.length", self.length)
        bounds.RELIEF_AMOUNT.require("spall.depth", self.depth)

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = the depth on the floor, the distance from the nearer rim on the walls."""
        base = pair.gear(self.gear).base_radius
        middle = (self.radius - base) * (self.radius + base)
        inside = 0.5 * self.length - np.abs(rho**2 - middle) / (2.0 * base)
        return np.clip(inside, 0.0, self.depth)

    def borders(self, pair: GearPair) -> Floats:
        """Both rims and where the walls end on the floor."""
        lengths = (self.length, max(self.length - 2.0 * self.depth, 0.0))
        ends = [spalled(pair, self.gear, radius=self.radius, length=each) for each in lengths]
        return np.unique(ends)


@dataclass(frozen=True)
class OneTooth(ToothShapes):
    """Shapes of which one tooth alone has another than all others: a fault, which no mean has.

    >>> whole, pocket = (Pocket("pinion", radius=4e-2, length=2e-3, depth=d) for d in (0.0, 1e-4))
    >>> OneTooth("pinion", (pocket, *[whole] * 19)).mean() == whole
    True
    """

    def mean(self) -> FlankShape:
        """The shape of the other teeth."""
        return Counter(self.shapes).most_common(1)[0][0]


@dataclass(frozen=True)
class Spall(Damage):
    """A pocket of one tooth's drive flank that takes ``width_share`` of the face width, up to 0.9.

    radius, length as of :class:`Pocket`. The rest of the width carries under the higher pressure:
    of two rows of springs side by side one is not reached, so that the flanks approach by
    2 F/(pi b E*) times w/(1 - w) more, w the share. Derived here; the same as b - w_s in place of
    the width b in the contact's stiffness, as published models have it (recalled: Chaari 2006).
    Holds for pockets deeper than :func:`floor_reached`. What the tooth bends more beside a pocket
    is left out, and so is the pocket's place across the face.

    >>> Spall("pinion", tooth=2, radius=40e-3, length=2e-3, width_share=0.5).differs
    True
    """

    _: KW_ONLY
    radius: float
    length: float
    width_share: float

    def __post_init__(self) -> None:
        super().__post_init__()
        bounds.PROFILE_RADIUS.require("spall.radius", self.radius)
        bounds.RELIEF_LENGTH.require("spall.length", self.length)
        if not 0.0 <= self.width_share <= WIDEST_SPALL:
            raise InputError("spall.width_share", self.width_share, allowed=f"0..{WIDEST_SPALL:g}")

    @property
    def differs(self) -> bool:
        """Whether there is any."""
        return self.width_share > 0.0

    def require_fits(self, pair: GearPair) -> None:
        """Refuse a middle beside the flank."""
        spalled(pair, self.gear, radius=self.radius, length=self.length)

    def softer(
        self, contacts: Contacts, t: Floats, angle: Floats, plane: str
    ) -> tuple[Floats, Floats]:
        """What the contact yields more where it meets the pocket, times E b of its gear."""
        pair, gear = contacts.pair, contacts.pair.gear(self.gear)
        low, high = spalled(pair, self.gear, radius=self.radius, length=self.length)
        rho = t * gear.base_radius
        inside = (self.pitches(contacts) == 0) & (rho >= low) & (rho <= high)
        inside &= contacts.flank == "drive"
        modulus = gear.material.youngs_modulus / pair_reduced_modulus(pair)
        more = 2.0 * modulus / np.pi * self.width_share / (1.0 - self.width_share)
        return inside * more, np.zeros((*t.shape, t.shape[-1]))


def floor_reached(pair: GearPair, normal_force: float, *, width_share: float) -> float:
    """Depth [m] down to which a pocket's floor carries too: 2 F/(pi b E*)/(1 - w).

    normal_force F [N] on one tooth pair; ``width_share`` w < 1 of the face width.

    >>> pair = GearPair(Gear(20, 4e-3, face_width=20e-3), Gear(40, 4e-3, face_width=20e-3))
    >>> f"{1e6 * floor_reached(pair, 4e3, width_share=0.5):.2f} um"
    '2.25 um'
    """
    approach = 2.0 * normal_force / (np.pi * pair.face_width * pair_reduced_modulus(pair))
    return float(approach / (1.0 - width_share))


def wear_work(pair: GearPair, name: str, normal_force: float) -> tuple[Floats, Floats]:
    """Radius [m] and what wears the named gear's drive flank there in one mesh [N/m], (point,).

    Archard's dh = k p ds over the passage of the contact: integral p ds = w |1 - v_mate/v_own|, w
    [N/m] the line load of that pair and v the rolling velocities; for a mean pressure p over a
    width 2 a it is 2 a p |1 - v_mate/v_own|, as models of mild wear have it. Share of the load
    of sound, perfect flanks under ``normal_force`` [N]: wear that changes the share is left out.
    0 at the pitch point.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> radius, work = wear_work(pair, "pinion", 4e3)
    >>> f"{1e3 * radius[work.argmin()]:.1f} mm"
    '40.0 mm'
    """
    phase = (np.arange(_PHASES) + 0.5) / _PHASES
    mesh = solve_mesh(pair, normal_force, phase)
    s, share = mesh.points.s, mesh.share.reshape(mesh.points.s.shape)
    on_path = (s >= pair.path.a) & (s <= pair.path.e)
    pinion = s[on_path]
    strings = {"pinion": pinion, "wheel": pair.line_of_action - pinion}
    ratio = pair.wheel.teeth / pair.pinion.teeth
    # the wheel turns slower by the ratio
    mate = strings["wheel"] / (strings["pinion"] * ratio)
    slip = np.abs(1.0 - (mate if name == "pinion" else 1.0 / mate))
    radius = np.hypot(pair.gear(name).base_radius, strings[name])
    order = np.argsort(radius)
    work = share[on_path] * slip * normal_force / pair.face_width
    return radius[order], work[order]


def worn(
    pair: GearPair,
    name: str,
    normal_force: float,
    *,
    depth: float | None = None,
    coefficient: float = 0.0,
    meshes: float = 0.0,
) -> FlankTable:
    """The named gear's drive flanks worn: h = k n times :func:`wear_work` after n meshes.

    ``coefficient`` k [m^2/N] >= 0 and ``meshes`` n of each tooth, one a turn of the gear; or
    ``depth`` [m], where it is greatest. Proportional to n: the shape is not worn on.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * worn(pair, 'pinion', 4e3, coefficient=1e-17, meshes=1e6).added.min():.2f} um"
    '-3.22 um'
    """
    radius, work = wear_work(pair, name, normal_force)
    scale = coefficient * meshes if depth is None else depth / float(work.max())
    return FlankTable(name, radius=radius, added=-scale * work, flank="drive")
