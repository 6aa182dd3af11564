"""A drive train as it is drawn: two shafts with their gears, discs, bearings, ends and housing.

One right-handed frame, z along both shafts, every angle about +z, also of the driven shaft, which
turns the other way. Both gears lie in the plane z = 0. SI.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from thermogear.base.materials import Material
from thermogear.shafts.bearings.laws import BearingLaw
from thermogear.shafts.mesh_lines import MeshFrame

SHAFTS = ("pinion", "wheel")
"""The two shafts, by the gear each carries; the pinion drives."""


@dataclass(frozen=True, kw_only=True)
class Section:
    """A piece of a shaft: a hollow cylinder of one material.

    ``length``, ``outer_diameter``, ``inner_diameter`` [m].
    """

    length: float
    outer_diameter: float
    inner_diameter: float = 0.0
    material: Material


@dataclass(frozen=True, kw_only=True)
class Shaft:
    """A shaft of ``sections`` from its left end on.

    ``gear_position`` [m] from the left end to the middle of the gear's face.
    """

    sections: tuple[Section, ...]
    gear_position: float

    @property
    def length(self) -> float:
        """Length of the whole shaft [m]."""
        return sum(one.length for one in self.sections)


@dataclass(frozen=True, kw_only=True)
class GearBody:
    """What a gear adds to its shaft: ``mass`` [kg], polar and diametral inertia [kg m^2]."""

    mass: float
    polar_inertia: float
    diametral_inertia: float


@dataclass(frozen=True, kw_only=True)
class Disc:
    """A rigid disc on a shaft: a flange, a coupling half, a pulley.

    ``position`` [m] from the shaft's left end, ``mass`` [kg], inertias [kg m^2].
    """

    shaft: str
    position: float
    mass: float
    polar_inertia: float
    diametral_inertia: float
    name: str = "disc"


@dataclass(frozen=True, kw_only=True)
class Seat:
    """The seat of an outer ring in the housing: ``mass`` [kg] on springs in x and y [N/m].

    ``damping`` [N s/m] in both directions.
    """

    mass: float
    stiffness: tuple[float, float]
    damping: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Bearing:
    """A radial bearing: ``law`` between journal and outer ring, ``damping`` [N s/m] beside it.

    ``position`` [m] from the shaft's left end. Without a ``seat`` the outer ring is fixed to the
    housing.
    """

    name: str
    shaft: str
    position: float
    law: BearingLaw
    damping: float = 0.0
    seat: Seat | None = None


@dataclass(frozen=True, kw_only=True)
class Casing:
    """The housing as one mass that moves across the shafts and does not tilt.

    ``mass`` [kg] on feet of ``stiffness`` in x and y [N/m] with ``damping`` [N s/m].
    """

    mass: float
    stiffness: tuple[float, float]
    damping: float = 0.0


@dataclass(frozen=True, kw_only=True)
class DriveEnd:
    """A motor on the pinion's shaft, a load on the wheel's: ``inertia`` [kg m^2] on a coupling.

    ``position`` [m] from the shaft's left end; ``stiffness`` [N m/rad] and ``damping`` [N m s] of
    the coupling. ``slip_damping`` [N m s]: how the torque falls with speed (0: constant torque),
    behind a ``lag`` [s].
    """

    position: float
    inertia: float
    stiffness: float
    damping: float = 0.0
    slip_damping: float = 0.0
    lag: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Unbalance:
    """``moment`` m e_c [kg m] at ``position`` [m] of a shaft, ``angle`` [rad] from the x axis."""

    shaft: str
    position: float
    moment: float
    angle: float = 0.0


@dataclass(frozen=True, kw_only=True)
class RunOut:
    """A gear whose teeth turn about another centre than its shaft's.

    ``eccentricity`` [m] at ``angle`` [rad] from the x axis: a line of the transmission error at
    shaft order; where the mass sits off the axis too, :class:`Unbalance` says so.
    """

    shaft: str
    eccentricity: float
    angle: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Damping:
    """How the train loses energy; what is left out is zero.

    ``kind`` "bearings": what bearings, seats and couplings have, plus ``shafts`` beta [s] times the
    stiffness of the shafts. "proportional": ``mass`` alpha [1/s] M + ``shafts`` beta [s] K of all
    but the mesh. "modal": ``ratio`` zeta [-] of every mode at mean stiffness. The mesh has its own
    damping ratio ``mesh`` in the first two.
    """

    kind: str = "bearings"
    shafts: float = 2e-6
    mass: float = 0.0
    ratio: float = 0.01
    mesh: float = 0.07


@dataclass(frozen=True, kw_only=True)
class TrainParts:
    """Two geared shafts and what hangs on them; the first carries the pinion, which drives.

    ``gravity`` [m/s^2] along -y; ``least_elements`` of each shaft.
    """

    shafts: tuple[Shaft, Shaft]
    gears: tuple[GearBody, GearBody]
    discs: tuple[Disc, ...] = ()
    motor: DriveEnd | None = None
    load: DriveEnd | None = None
    casing: Casing | None = None
    unbalances: tuple[Unbalance, ...] = ()
    run_outs: tuple[RunOut, ...] = ()
    damping: Damping = field(default_factory=Damping)
    gravity: float = 0.0
    least_elements: int = 12


@dataclass(frozen=True, kw_only=True)
class DriveTrain(TrainParts):
    """Two geared shafts in their bearings.

    ``frame``: base radii, teeth, pressure angle, place and sense of the mesh.
    """

    frame: MeshFrame
    bearings: tuple[Bearing, ...]
