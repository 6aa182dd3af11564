"""One tooth that differs from all others: cracked at its root, its tip broken off, or missing.

The gear is a ring of equal sectors, solved as in :mod:`thermogear.gears.tooth_table`, of which one
has another tooth; only that sector is solved again. With K_s the stiffness of a sector at its two
sides and K_n that of the ring's harmonic n, the whole ring yields there by

    G = (1/z) sum over n of T K_n^-1 T^H,   T = [1; exp(2 pi i n/z)],

so that all other sectors resist with K_rest = G^-1 - K_s, and a damaged one moves by
(K_s' + K_rest)^-1. What a crack adds is taken between two meshes that differ by it alone. Damage
goes through the whole face width but where a crack says so; a crack does not grow. Several damaged
teeth of a gear add up, each as if all others were sound.
Checked by ``tests/gears/test_tooth_damage.py``: no depth, reciprocity, energy, growth with the
depth, the edge crack of a half plane, and finite elements not written here.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import KW_ONLY, dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import GeometryError, InputError, require_choice
from thermogear.gears.candidates import MeshPoints
from thermogear.gears.corner import contact_point, off_path
from thermogear.gears.deviations import GEARS, Contacts, Deviation, ToothDeviation
from thermogear.gears.elements import Integers
from thermogear.gears.geometry import Gear, millimetres
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density, Profile, foot_mesh, graded, halved, tooth_mesh
from thermogear.gears.tooth_table import (
    COUPLED,
    MATES,
    ROWS,
    STATIONS,
    Sector,
    Shape,
    ToothTable,
    joined,
    tooth_table,
)

MESH = Density(growth=1.5, below=6)
FINEST = 0.04
"""Elements at a crack's tip, in half lengths of the line from fillet to fillet through it: a crack
of 0.3 modules adds 3 to 4 % less than on a mesh a quarter as large, one of 0.9 modules 0.8 %."""
DEEPEST = 0.51
"""Part of the way across the tooth, and half of it of that down to the bore, that a crack goes."""


@dataclass(frozen=True, eq=False)
class DamagedTable:
    """Compliances of a gear with one damaged tooth, times E b, like those of a ToothTable.

    ``sound``: of the other teeth; ``alike``: of the tooth itself, were the gear without a crack;
    ``added`` (tooth, tooth, degree, degree): Chebyshev series of what a crack adds to the
    deflection of a tooth (first) under the load on another, both counted from ``-MATES`` pitches
    behind the damaged one to ``MATES`` ahead, towards the loaded flank.
    """

    sound: ToothTable
    alike: ToothTable
    added: Floats
    width_share: float = 1.0

    def more(self, t: Floats, pitches: Integers) -> Floats:
        """What the crack adds between places ``t`` of teeth so many ``pitches`` ahead of it.

        Shapes (..., place) -> (..., place, place); 0 beyond :data:`MATES`. A crack through a share
        w of the face width: slices in parallel, cracked and sound ones, yield C more with

            1/(C_s + C) = (1 - w)/C_s + w/(C_s + C_w),

        C_s the sound tooth's own compliance, C_w what the crack adds through the whole width. That
        is the most it can be: slices that hold on to each other yield less. What it adds on
        neighbours falls with the root of both teeth's own parts, so that it stays reciprocal.
        """
        series = chebyshev.chebvander(self.alike.place(t), COUPLED)
        at, near = np.clip(pitches + MATES, 0, 2 * MATES), abs(pitches) <= MATES
        between = self.added[at[..., :, None], at[..., None, :]]
        out = np.einsum("...ja,...jkab,...kb->...jk", series, between, series)
        if (w := self.width_share) < 1.0:
            whole = np.einsum("...a,ab,...b->...", series, self.added[MATES, MATES], series)
            sound = sum(self.alike.self_compliance(t))
            part = np.sqrt(w * sound / (sound + (1.0 - w) * np.maximum(whole, 0.0)))
            out *= part[..., :, None] * part[..., None, :]
        return np.asarray(out * near[..., :, None] * near[..., None, :])

    def self_compliance(self, t: ArrayLike) -> tuple[Floats, Floats]:
        """(tooth's part, body's part) of the damaged tooth under its load at t = tan(alpha_k).

        A crack starts where the tooth meets the body and counts with the body's modulus.
        """
        tooth, body = self.alike.self_compliance(t)
        there = np.asarray(t, dtype=float)[..., None]
        return tooth, body + self.more(there, np.zeros(there.shape, dtype=np.int64))[..., 0, 0]

    def coupled(self, t: Floats, *, loaded: Floats, lag: int) -> Floats:
        """Deflection at ``t`` of the tooth ``lag`` pitches ahead of the damaged, loaded one.

        By reciprocity that of the damaged tooth at ``loaded`` under a load on its neighbour.
        """
        both = np.stack(np.broadcast_arrays(t, loaded), axis=-1)
        pitches = np.broadcast_to([lag, 0], both.shape)
        return self.sound.coupled(t, loaded=loaded, lag=lag) + self.more(both, pitches)[..., 0, 1]


@dataclass(frozen=True)
class Damage(ToothDeviation):
    """What differs at one ``tooth`` of one ``gear``, "pinion" or "wheel".

    Teeth are numbered as in a mesh: number 0 enters at phase 0, number n at phase n. Among the
    deviations of a mesh it acts whenever that tooth, or one up to ``MATES`` pitches from it, does.
    """

    gear: str
    _: KW_ONLY
    tooth: int = 0

    def __post_init__(self) -> None:
        require_choice("damage.gear", self.gear, GEARS)
        if not isinstance(self.tooth, int | np.integer):
            raise InputError("damage.tooth", repr(self.tooth), allowed="a whole number")

    def gap(self, at: Contacts) -> Floats:
        """None: the flank is where it was."""
        return np.zeros_like(at.s)

    def mean(self) -> Deviation:
        """A whole tooth: damage of one tooth is no mean of all."""
        return Chip(self.gear, height=0.0)

    def touching(self, points: MeshPoints, extended: bool) -> MeshPoints:
        """The candidates as they are: the flank is whole."""
        return points

    def softer(
        self, contacts: Contacts, t: Floats, angle: Floats, plane: str
    ) -> tuple[Floats, Floats]:
        """What the gear yields more, times E b: (position, pair) and (position, pair, pair)."""
        return np.zeros_like(t), np.zeros((*t.shape, t.shape[-1]))

    def pitches(self, contacts: Contacts) -> Integers:
        """(position, pair): how many pitches ahead of this tooth, towards its loaded flank."""
        teeth = contacts.pair.gear(self.gear).teeth
        behind = (contacts.tooth(self.gear) - self.tooth + teeth // 2) % teeth - teeth // 2
        return np.asarray(-behind if self.gear == "pinion" else behind)


def damages_of(deviations: Iterable[Deviation]) -> tuple[Damage, ...]:
    """The damaged teeth among ``deviations``.

    >>> damages_of([Chip("pinion", height=0.0), Crack("wheel", depth=1e-3)])[0].gear
    'wheel'
    """
    return tuple(d for d in deviations if isinstance(d, Damage) and d.differs)


def as_damaged(
    points: MeshPoints, deviations: Iterable[Deviation], extended: bool = True
) -> MeshPoints:
    """The candidates where damaged teeth among ``deviations`` touch; as they are if they do so.

    ``extended``: edges touch off the path too. Only chips move a point.

    >>> from thermogear.gears.candidates import mesh_points
    >>> points = mesh_points(GearPair(Gear(20, 4e-3), Gear(40, 4e-3)), [1.4])
    >>> chipped = as_damaged(points, [Chip("pinion", height=2e-3)])
    >>> (points.broken, int(chipped.broken.max()))  # 2: on the pinion's edge
    (None, 2)
    """
    for damage in damages_of(deviations) if points.broken is None else ():
        points = damage.touching(points, extended)
    return points


@dataclass(frozen=True)
class ShapedDamage(Damage):
    """Damage whose tooth is solved by finite elements of its own shape."""

    @abstractmethod
    def table(self, gear: Gear, plane: str = "stress") -> DamagedTable:
        """The compliances of the tooth and of its neighbours."""

    def softer(
        self, contacts: Contacts, t: Floats, angle: Floats, plane: str
    ) -> tuple[Floats, Floats]:
        """What the gear yields more, times E b: (position, pair) and (position, pair, pair)."""
        table, pitches = self.table(contacts.pair.gear(self.gear), plane), self.pitches(contacts)
        body = table.more(t, pitches)
        # a crack at the root of the other flank is pressed shut
        body *= contacts.flank == "drive"
        alike, sound = table.alike.under(t, angle), table.sound.under(t, angle)
        here = pitches == 0
        body += (here * (alike[1] - sound[1]))[..., None] * np.eye(t.shape[-1])
        return here * (alike[0] - sound[0]), body


@dataclass(frozen=True)
class Crack(ShapedDamage):
    """A straight, open crack from the 30-degree point of the drive flank's fillet into the gear.

    depth: its length [m] >= 0; angle [rad] to the tooth's axis, 45 to 90 degrees, by default 45:
    90 goes straight across the tooth. Under a load on the back flank it is shut and does nothing.
    Refused beyond 0.51 of the way across the tooth or 0.255 of that down to the bore,
    and where no sound mesh follows it (long ones at 45 degrees below about 20 teeth). width_share:
    of the face width it goes through, 0 to 1; below 1 it adds no more than
    :meth:`DamagedTable.more` says.

    >>> gear = Gear(20, 4e-3)
    >>> t = math.tan(gear.pressure_angle)
    >>> sound, cracked = tooth_table(gear), Crack("pinion", depth=2e-3).table(gear)
    >>> f"{sum(sound.self_compliance(t)):.2f} {sum(cracked.self_compliance(t)):.2f}"
    '6.31 8.10'
    """

    _: KW_ONLY
    depth: float
    angle: float = math.radians(45.0)
    width_share: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        bounds.DEPTH.require("crack.depth", self.depth)
        bounds.CRACK_ANGLE.require("crack.angle", self.angle)
        bounds.SHARE.require("crack.width_share", self.width_share)

    @property
    def differs(self) -> bool:
        """Whether there is any."""
        return self.depth > 0.0 and self.width_share > 0.0

    def table(self, gear: Gear, plane: str = "stress") -> DamagedTable:
        """The compliances of the tooth and its neighbours, remembered by the gear's shape."""
        sound = tooth_table(gear, plane)
        depth = float(f"{self.depth / gear.module:.12g}")
        added = _added(Shape.of(gear, plane), depth, self.angle)
        return DamagedTable(sound, sound, added, self.width_share)


@dataclass(frozen=True)
class Chip(ShapedDamage):
    """A tooth whose tip is broken off, flat, ``height`` [m] below the tip circle.

    Its flanks end there in a sharp edge, which touches the mate like that of a tip; nothing above
    carries. Refused where less than a tenth of the involute's height would be left.

    >>> gear = Gear(20, 4e-3)
    >>> f"{1e3 * Chip('pinion', height=2e-3).left(gear).tip_radius:.1f} mm"
    '42.0 mm'
    """

    _: KW_ONLY
    height: float

    def __post_init__(self) -> None:
        super().__post_init__()
        bounds.DEPTH.require("chip.height", self.height)

    @property
    def differs(self) -> bool:
        """Whether there is any."""
        return self.height > 0.0

    def left(self, gear: Gear) -> Gear:
        """A gear whose teeth all are as this one; GeometryError where no flank would be left."""
        most = 0.9 * (gear.tip_radius - gear.form_radius)
        if not self.height <= most:
            raise GeometryError(
                "chip.height",
                millimetres(self.height),
                allowed=f"<= {millimetres(most)}",
                why="too little of the flank would be left",
            )
        if self.height == 0.0:
            return gear
        return replace(
            gear, tip_radius=gear.tip_radius - self.height, tip_rounding=0.0, tip_chamfer=0.0
        )

    def table(self, gear: Gear, plane: str = "stress") -> DamagedTable:
        """The tooth yields as if all were broken; its neighbours feel no difference."""
        none = np.zeros((2 * MATES + 1, 2 * MATES + 1, COUPLED + 1, COUPLED + 1))
        return DamagedTable(tooth_table(gear, plane), tooth_table(self.left(gear), plane), none)

    def touching(self, points: MeshPoints, extended: bool) -> MeshPoints:
        """The candidates, those of this tooth beyond the break on its edge."""
        contacts, before = points.contacts, points.broken
        gears = [contacts.pair.gear(name) for name in GEARS]
        i = GEARS.index(self.gear)
        gears[i] = self.left(gears[i])
        broken = _Meshing(gears[0], gears[1], contacts.pair.centre_distance)
        whole = np.zeros(contacts.s.shape, np.int8) if before is None else before
        # two broken teeth that meet: the edge of the one that was looked at first
        here = (self.pitches(contacts) == 0) & (whole == 0)
        s = contacts.s[here]
        there = contact_point(broken, s, extended)
        point = type(there)(*(np.array(values) for values in points.point))
        for values, new in zip(point, there, strict=True):
            values[here] = new
        beyond = whole.copy()
        beyond[here] = off_path(broken, s)[1 - i] * (2 - i)
        return points._replace(
            point=point,
            contacts=contacts._replace(pinion=point.pinion, wheel=point.wheel),
            broken=beyond,
        )


@dataclass(frozen=True)
class MissingTooth(Damage):
    """A tooth broken off at its root: neither of its flanks touches anything.

    Its neighbours carry for it, off the path on their tips' edges: the gears fall behind by as
    much as an edge is open there. They yield as if the stump were a whole tooth.

    >>> MissingTooth("pinion", tooth=3).differs
    True
    """

    @property
    def differs(self) -> bool:
        """Always."""
        return True

    def gap(self, at: Contacts) -> Floats:
        """e = inf: it never touches."""
        return np.where(self.pitches(at) == 0, np.inf, 0.0)


class _Meshing(GearPair):
    """Two gears as they mesh in one tooth pair: they need no contact ratio above 1."""

    def __post_init__(self) -> None:
        """Both gears are those of a pair that was looked at."""


def way_across(gear: Gear, angle: float) -> float:
    """Way [m] across a tooth at its root between the 30-degree points, 2 x_root/sin(angle).

    ``angle`` [rad] to the tooth's axis: 100 % of a crack.

    >>> f"{1e3 * way_across(Gear(20, 4e-3), math.radians(45.0)):.2f} mm"
    '11.00 mm'
    """
    profile = Profile(gear)
    r, phi = (float(at) for at in profile.fillet(np.asarray(profile.start)))
    return 2.0 * r * math.sin(phi) / math.sin(angle)


def _meshed(gear: Gear, poisson: float, depth: float, angle: float) -> tuple[Sector, Sector]:
    """A sector with a crack [m, rad] shut and open.

    The joint of tooth and foot runs along the crack, then straight to the other side. Both grids
    are bent with it, less and less towards tip and bore.
    """
    profile = Profile(gear)
    r, phi = (float(at) for at in profile.fillet(np.asarray(profile.start)))
    mouth = r * np.array([math.sin(phi), math.cos(phi)])
    across, down = math.sin(angle), max(math.cos(angle), 1e-9)
    most = DEEPEST * min(way_across(gear, angle), 0.5 * (r - gear.bore_radius) / down)
    # a share of the way across is a depth but for rounding
    if not depth <= most * (1.0 + 1e-12):
        raise GeometryError(
            "crack.depth",
            millimetres(depth),
            allowed=f"<= {millimetres(most)}",
            why="the crack would leave too little of the tooth or of the body",
        )
    tip = mouth - depth * np.array([across, math.cos(angle)])
    line = np.stack([mouth * [-1.0, 1.0], tip, mouth])
    middle = 1.0 - 2.0 * depth / (depth + math.dist(line[0], tip))
    fine = min(FINEST, 0.25 * (1.0 - middle)) or FINEST
    columns = graded(low=-1.0, high=1.0, centre=middle, core=0.0, fine=fine, rate=1.5, coarse=0.3)
    place = halved(columns)
    arcs = np.linspace(*profile.ends, ROWS + 1)
    foot = foot_mesh(gear, columns, MESH)
    tooth = tooth_mesh(gear, across=columns, arcs=arcs, density=MESH)
    bend = np.stack([np.interp(place, [-1.0, middle, 1.0], x) for x in line.T], axis=-1)
    bend -= foot.patch.nodes[foot.joint]
    reach = min(2.5 * depth * down + gear.module, r - gear.bore_radius)
    first = (foot.bore.size - place.size) // 2
    grids = []
    for patch, start, row, end in (
        (foot.patch, first, foot.bore.size, r - reach),
        (tooth.patch, 0, place.size, gear.tip_radius - gear.tip_chamfer),
    ):
        nodes = patch.nodes.reshape(-1, row, 2).copy()
        bent = nodes[:, start : start + place.size]
        part = (np.linalg.norm(bent, axis=-1) - end) / (r - end)
        bent += np.maximum(part, 0.0)[..., None] * bend
        grids.append(replace(patch, nodes=nodes.reshape(-1, 2)))
    below, above = replace(foot, patch=grids[0]), replace(tooth, patch=grids[1])
    opened = int(np.count_nonzero(place > middle))
    shut = Sector.assembled(gear, below, above, poisson)
    return shut, Sector.assembled(gear, below, above, poisson, opened=opened)


@lru_cache(maxsize=64)
def _added(shape: Shape, depth: float, angle: float) -> Floats:
    """``added`` of :class:`DamagedTable` for a crack of ``depth`` [modules] and ``angle`` [rad]."""
    gear = shape.gear
    meshes = _meshed(gear, shape.poisson, depth * gear.module, angle)
    arcs, widths = meshes[0].stations(STATIONS)
    try:
        shut, cracked = (mesh.condensed(mesh.loads(arcs=arcs, widths=widths)) for mesh in meshes)
    except ValueError as error:
        raise GeometryError(
            "crack.depth",
            millimetres(depth * gear.module),
            why="no sound mesh follows it in this tooth",
            fix="take a shorter crack or one at a larger angle to the tooth's axis",
        ) from error
    # the forces on the sides that loads on the teeth about this one come to
    moved = joined(shut.stiffness, pushed=shut.pushed, teeth=gear.teeth)[::-1].transpose(1, 0, 2)
    ring = joined(shut.stiffness, pushed=np.eye(len(shut.stiffness)), teeth=gear.teeth)[MATES]
    whole = np.linalg.inv(ring)
    before = np.einsum("st,tkl->skl", whole, moved)
    before[:, MATES] = shut.pushed.T
    after = before.copy()
    after[:, MATES] = cracked.pushed.T
    sound, damaged = before.reshape(len(ring), -1), after.reshape(len(ring), -1)
    changed = damaged.T @ np.linalg.solve(whole + cracked.stiffness - shut.stiffness, damaged)
    added = (changed - sound.T @ ring @ sound).reshape(2 * (2 * MATES + 1, arcs.size))
    added[MATES, :, MATES] += cracked.held - shut.held
    low, high = Profile(gear).ends
    fit = np.linalg.pinv(chebyshev.chebvander((2.0 * arcs - low - high) / (high - low), COUPLED))
    return np.asarray(
        np.einsum("is,jskt,lt->jkil", fit, shape.softness * added, fit, optimize=True)
    )
