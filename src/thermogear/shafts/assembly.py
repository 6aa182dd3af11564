"""The matrices of a drive train with named coordinates: what is linear, and the contacts apart.

M q'' + (C + Omega_1 G) q' + K q + sum of contact forces = f, with the contacts - the mesh and the
bearings - left out of K and listed by the directions they act in.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.shafts.beam import NODE, BeamElements
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    Casing,
    Damping,
    Disc,
    DriveEnd,
    DriveTrain,
    GearBody,
    Section,
    Shaft,
)

SNAP = 1e-9
"""Places on a shaft [m] that are one place."""
CROSS = ("x", "y")
ENDS = {"motor": "pinion", "load": "wheel"}
"""What drives and what is driven, by the shaft each turns."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BearingPlace:
    """A bearing in the coordinates of the train.

    ``directions`` (n, 2): the displacement of the journal against the outer ring is its transpose
    times q [m]; ``ring`` (n, 2): that of the outer ring itself (zero where it is fixed).
    """

    bearing: Bearing
    directions: Floats
    journal: Floats
    ring: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class Assembly:
    """Matrices over the named ``coordinates``, (n, n), SI; the mesh and the bearings apart.

    ``mass``, ``stiffness`` (shafts, couplings, seats, feet), ``elastic`` (shafts and couplings),
    ``gyroscopic`` per rad/s of the pinion's speed about +z, ``viscous`` damping of couplings, seats
    and feet; ``drive`` and ``back`` (n,) are the gradients of delta_d and delta_b; ``weight`` (n,)
    is the force of gravity [N]. ``nodes`` are the positions [m] of the nodes of both shafts from
    their left ends, ``gear_nodes`` the gears' among them. ``mesh_mass`` m_e = I1 I2/(I1 r_b2^2 +
    I2 r_b1^2) [kg] of the two gears alone. ``slip`` (d [N m s], T [s]): the motor's torque falls
    by d with its speed, behind a lag T.
    """

    frame: MeshFrame
    damping: Damping
    coordinates: tuple[str, ...]
    mass: Floats
    stiffness: Floats
    elastic: Floats
    gyroscopic: Floats
    viscous: Floats
    drive: Floats
    back: Floats
    weight: Floats
    bearings: tuple[BearingPlace, ...]
    nodes: tuple[Floats, Floats]
    gear_nodes: tuple[int, int]
    mesh_mass: float
    slip: tuple[float, float] = (0.0, 0.0)

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return len(self.coordinates)

    @cached_property
    def index(self) -> dict[str, int]:
        """Place of every coordinate by its name."""
        return {name: place for place, name in enumerate(self.coordinates)}

    def unit(self, name: str) -> Floats:
        """The unit vector of a coordinate, (n,)."""
        found = np.zeros(self.size)
        found[self.index[name]] = 1.0
        return found

    def at_gear(self, shaft: str) -> Floats:
        """Unit vectors (n, 5) of the gear's node: x, y, tx, ty, tz."""
        return self.at_node(shaft, self.gear_nodes[SHAFTS.index(shaft)])

    def node_of(self, shaft: str, position: float) -> int:
        """Number of the node of ``shaft`` at ``position`` [m] from its left end."""
        return int(np.argmin(np.abs(self.nodes[SHAFTS.index(shaft)] - position)))

    def at(self, shaft: str, position: float) -> Floats:
        """Unit vectors (n, 5) of the node of ``shaft`` at ``position`` [m] from its left end."""
        return self.at_node(shaft, self.node_of(shaft, position))

    def at_node(self, shaft: str, node: int) -> Floats:
        """Unit vectors (n, 5) of a node by its number; zero for a coordinate it lacks."""
        found = np.zeros((self.size, len(NODE)))
        for place, one in enumerate(NODE):
            row = self.index.get(f"{shaft}.{node}.{one}")
            if row is not None:
                found[row, place] = 1.0
        return found

    @property
    def rotation(self) -> Floats:
        """The rigid rotation of the train, (n,): 1 on the pinion's side, -r_b1/r_b2 on the wheel's.

        Neither the mesh nor shafts resist it.
        """
        r1, r2 = self.frame.base_radii
        sides = {"pinion": 1.0, "wheel": -r1 / r2}
        found = np.zeros(self.size)
        for place, name in enumerate(self.coordinates):
            owner, *_, kind = name.split(".")
            if kind == "tz":
                found[place] = sides[ENDS.get(owner, owner)]
        return found

    def end_torques(self, torque: float) -> Floats:
        """Static forces of drive and load (n,) for ``torque`` [N m] of the pinion's side.

        They act at motor and load, or at the shafts' gears where those are not there.
        """
        r1, r2 = self.frame.base_radii
        found = np.zeros(self.size)
        for (owner, shaft), moment in zip(ENDS.items(), (torque, torque * r2 / r1), strict=True):
            own = f"{owner}.tz"
            at = self.unit(own) if own in self.index else self.at_gear(shaft)[:, 4]
            found += self.frame.sense * moment * at
        return found


def assemble(train: DriveTrain) -> Assembly:
    """The matrices of ``train``.

    Every shaft is cut at its sections, gear, bearings, discs, ends and unbalances, then finer to at
    least ``train.least_elements`` elements. Raises InputError where a place is off its shaft.
    """
    nodes = tuple(
        _nodes(train, name, shaft) for name, shaft in zip(SHAFTS, train.shafts, strict=True)
    )
    names = [
        f"{s}.{i}.{c}"
        for s, z in zip(SHAFTS, nodes, strict=True)
        for i in range(z.size)
        for c in NODE
    ]
    names += [f"{n}.tz" for n, end in (("motor", train.motor), ("load", train.load)) if end]
    names += [f"{b.name} seat.{c}" for b in train.bearings if b.seat for c in CROSS]
    names += [f"casing.{c}" for c in CROSS] if train.casing else []
    n = len(names)
    empty = Assembly(
        frame=train.frame,
        damping=train.damping,
        coordinates=tuple(names),
        **_empty(n),
        bearings=(),
        nodes=(nodes[0], nodes[1]),
        gear_nodes=(_nearest(nodes[0], train.shafts[0]), _nearest(nodes[1], train.shafts[1])),
        mesh_mass=mesh_mass(
            train.frame,
            pinion=train.gears[0].polar_inertia,
            wheel=train.gears[1].polar_inertia,
        ),
    )
    start = 0
    for name, shaft, z in zip(SHAFTS, train.shafts, nodes, strict=True):
        _put_shaft(empty, shaft, z, start, 1.0 if name == SHAFTS[0] else train.frame.ratio)
        start += z.size * len(NODE)
    _put_bodies(empty, train)
    for name, end in zip(ENDS, (train.motor, train.load), strict=True):
        if end is not None:
            _put_end(empty, name, end)
    empty.stiffness[...] = empty.elastic
    six = np.concatenate([empty.at_gear(name)[:, [0, 1, 4]] for name in SHAFTS], axis=-1)
    drive, back = (six @ column for column in train.frame.columns)
    casing = _put_casing(empty, train.casing)
    places = tuple(_put_bearing(empty, one, casing) for one in train.bearings)
    _weigh(empty, train.gravity)
    slip = (0.0, 0.0) if train.motor is None else (train.motor.slip_damping, train.motor.lag)
    return replace(empty, drive=drive, back=back, bearings=places, slip=slip)


def mesh_mass(frame: MeshFrame, *, pinion: float, wheel: float) -> float:
    """m_e = I1 I2/(I1 r_b2^2 + I2 r_b1^2) [kg] of two polar inertias [kg m^2]."""
    r1, r2 = frame.base_radii
    return pinion * wheel / (pinion * r2**2 + wheel * r1**2)


def _nearest(positions: Floats, shaft: Shaft) -> int:
    return int(np.argmin(np.abs(positions - shaft.gear_position)))


def _empty(size: int) -> dict[str, Any]:
    """Zeros for every matrix and vector."""
    square = {name: np.zeros((size, size)) for name in _MATRICES}
    return square | {name: np.zeros(size) for name in ("drive", "back", "weight")}


_MATRICES = ("mass", "stiffness", "elastic", "gyroscopic", "viscous")


def _nodes(train: DriveTrain, name: str, shaft: Shaft) -> Floats:
    """Positions [m] of a shaft's nodes from its left end."""
    wanted = [0.0, *np.cumsum([one.length for one in shaft.sections]).tolist()]
    total = wanted[-1]
    for what, other in _places(train, name, shaft):
        if not -SNAP <= other <= total + SNAP:
            raise InputError(
                f"{what}.position",
                f"{1e3 * other:.6g} mm",
                allowed=f"0..{1e3 * total:.6g} mm",
                why=f"the {name}'s shaft ends there",
            )
        wanted.append(min(max(other, 0.0), total))
    borders = np.unique(np.asarray(wanted))
    borders = borders[np.r_[True, np.diff(borders) > SNAP]]
    longest = total / train.least_elements
    pieces = [
        np.linspace(a, b, max(int(np.ceil((b - a) / longest - 1e-9)), 1), endpoint=False)
        for a, b in pairwise(borders)
    ]
    return np.concatenate([*pieces, borders[-1:]])


def _places(train: DriveTrain, name: str, shaft: Shaft) -> list[tuple[str, float]]:
    """What sits on a shaft, and where [m]."""
    found = [("gear", shaft.gear_position)]
    found += [(one.name, one.position) for one in train.bearings if one.shaft == name]
    found += [(one.name, one.position) for one in train.discs if one.shaft == name]
    found += [("unbalance", one.position) for one in train.unbalances if one.shaft == name]
    ends = zip(ENDS.items(), (train.motor, train.load), strict=True)
    return found + [(what, e.position) for (what, shaft), e in ends if e and shaft == name]


def _put_shaft(into: Assembly, shaft: Shaft, z: Floats, start: int, speed: float) -> None:
    middles = 0.5 * (z[1:] + z[:-1])
    ends = np.cumsum([one.length for one in shaft.sections])
    which = np.minimum(np.searchsorted(ends, middles), ends.size - 1)
    mine: list[Section] = [shaft.sections[i] for i in which]
    mass, stiff, gyro = BeamElements(
        length=np.diff(z),
        outer_diameter=np.array([one.outer_diameter for one in mine]),
        inner_diameter=np.array([one.inner_diameter for one in mine]),
        youngs_modulus=np.array([one.material.youngs_modulus for one in mine]),
        poisson_ratio=np.array([one.material.poisson_ratio for one in mine]),
        density=np.array([one.material.density for one in mine]),
    ).matrices()
    for i in range(middles.size):
        at = slice(start + 5 * i, start + 5 * i + 10)
        into.mass[at, at] += mass[i]
        into.elastic[at, at] += stiff[i]
        into.gyroscopic[at, at] += speed * gyro[i]


def _put_bodies(into: Assembly, train: DriveTrain) -> None:
    bodies: list[tuple[str, float, GearBody | Disc]] = [
        (name, shaft.gear_position, gear)
        for name, shaft, gear in zip(SHAFTS, train.shafts, train.gears, strict=True)
    ]
    for name, position, body in (*bodies, *((d.shaft, d.position, d) for d in train.discs)):
        start = into.index[f"{name}.{into.node_of(name, position)}.x"]
        own = np.array([body.mass] * 2 + [body.diametral_inertia] * 2 + [body.polar_inertia])
        at = np.arange(start, start + 5)
        into.mass[at, at] += own
        speed = 1.0 if name == SHAFTS[0] else train.frame.ratio
        into.gyroscopic[start + 2, start + 3] += speed * body.polar_inertia
        into.gyroscopic[start + 3, start + 2] -= speed * body.polar_inertia


def _put_end(into: Assembly, name: str, end: DriveEnd) -> None:
    own = into.unit(f"{name}.tz")
    twist = own - into.at(ENDS[name], end.position)[:, 4]
    into.mass[...] += end.inertia * np.outer(own, own)
    into.elastic[...] += end.stiffness * np.outer(twist, twist)
    into.viscous[...] += end.damping * np.outer(twist, twist)


def _put_casing(into: Assembly, casing: Casing | None) -> Floats:
    """The casing's directions (n, 2); zero where it is fixed."""
    if casing is None:
        return np.zeros((into.size, 2))
    own = np.stack([into.unit(f"casing.{c}") for c in CROSS], axis=-1)
    into.mass[...] += casing.mass * own @ own.T
    into.stiffness[...] += own @ np.diag(casing.stiffness) @ own.T
    into.viscous[...] += casing.damping * own @ own.T
    return own


def _put_bearing(into: Assembly, bearing: Bearing, casing: Floats) -> BearingPlace:
    journal = into.at(bearing.shaft, bearing.position)[:, :2]
    ring = casing
    if bearing.seat is not None:
        ring = np.stack([into.unit(f"{bearing.name} seat.{c}") for c in CROSS], axis=-1)
        held = ring - casing
        into.mass[...] += bearing.seat.mass * ring @ ring.T
        into.stiffness[...] += held @ np.diag(bearing.seat.stiffness) @ held.T
        into.viscous[...] += bearing.seat.damping * held @ held.T
    across = journal - ring
    into.viscous[...] += bearing.damping * across @ across.T
    return BearingPlace(bearing=bearing, directions=across, journal=journal, ring=ring)


def _weigh(into: Assembly, gravity: float) -> None:
    down = np.array([name.endswith(".y") for name in into.coordinates], dtype=float)
    into.weight[...] = -gravity * (into.mass @ down)


def across(pull: Floats) -> Floats:
    """A basis (n, n - 1) of all that is orthogonal to ``pull`` (n,).

    Its Householder reflection leaves unit-like columns, so that nothing is lost in scale.
    """
    normal = pull / np.linalg.norm(pull)
    first = int(np.argmax(np.abs(normal)))
    normal[first] += np.copysign(1.0, normal[first])
    mirror = np.eye(normal.size) - 2.0 * np.outer(normal, normal) / (normal @ normal)
    return np.asarray(np.delete(mirror, first, axis=1))


def linear_stiffness(
    assembly: Assembly, *, mesh: float, bearings: ArrayLike, back: float = 0.0
) -> Floats:
    """K of the train with closed contacts, (n, n) [N/m].

    ``mesh`` k of the drive flank and ``back`` of the back flank [N/m]; ``bearings`` (count, 2, 2)
    [N/m] in the order of the assembly.
    """
    found = assembly.stiffness + mesh * np.outer(assembly.drive, assembly.drive)
    if back:
        found = found + back * np.outer(assembly.back, assembly.back)
    for place, k in zip(assembly.bearings, np.asarray(bearings, dtype=float), strict=True):
        found = found + place.directions @ k @ place.directions.T
    return np.asarray(found)
