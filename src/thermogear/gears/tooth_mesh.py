"""Mapped, graded meshes of one tooth and of the body's sector below it.

Tooth frame: origin at the gear centre, y along the tooth axis, x towards the loaded flank;
polar angle phi from the y axis towards x. Two structured grids meet on the arc through the
30-degree points of the fillets: the tooth above it, the foot (fillets, gaps and the body down
to the bore) below.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.gears.elements import Integers, Patch
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth import CRITICAL_SLOPE, section_angle

_FINE_SAMPLES = 2001


@dataclass(frozen=True, kw_only=True)
class Density:
    """How fine the mesh is: counts are multiplied by ``refinement``.

    ``per_half_width`` elements along the Hertzian half width; into the body they grow by
    ``growth`` from one to the next. ``sides`` elements along a fillet with half of the gap,
    ``below`` from the root half a module down, each ``inward`` times as thick as the last.
    ``joint``: angle [rad] of the fillet's tangent to the tooth's axis where tooth and foot meet.
    """

    refinement: int = 1
    per_half_width: float = 3.0
    growth: float = 1.6
    sides: int = 5
    below: int = 3
    inward: float = 1.0
    joint: float = CRITICAL_SLOPE

    @property
    def rate(self) -> float:
        """Growth that keeps the picture when every element is split."""
        return float(self.growth ** (1.0 / self.refinement))

    def count(self, number: int) -> int:
        """``number`` of elements at this refinement."""
        return number * self.refinement


def graded(
    *, low: float, high: float, centre: float, core: float, fine: float, rate: float, coarse: float
) -> Floats:
    """Ascending nodes from ``low`` to ``high``: steps ``fine`` within ``core`` of ``centre``.

    Away from the core the steps grow by ``rate`` up to ``coarse``; each stretch is scaled to
    end where it must.

    >>> graded(low=0.0, high=1.0, centre=1.0, core=0.1, fine=0.05, rate=2.0, coarse=0.4).round(2)
    array([0.  , 0.51, 0.77, 0.9 , 0.95, 1.  ])
    """

    def outward(start: float, end: float, first: float) -> Floats:
        length = abs(end - start)
        if length <= 0.0:
            return np.array([start])
        steps = [min(first, length)]
        while sum(steps) < length:
            steps.append(min(steps[-1] * rate, coarse))
        # a last step that hardly fits is shared out among the others
        if len(steps) > 1 and sum(steps) - length > 0.5 * steps[-1]:
            steps.pop()
        way = np.concatenate([[0.0], np.cumsum(steps)]) * (length / sum(steps))
        return np.asarray(start + np.sign(end - start) * way)

    left, right = max(centre - core, low), min(centre + core, high)
    inner = np.linspace(left, right, max(int(np.ceil((right - left) / fine)), 1) + 1)
    nodes = np.concatenate(
        [outward(left, low, fine * rate)[::-1], inner[1:-1], outward(right, high, fine * rate)]
    )
    nodes[[0, -1]] = low, high
    # a core without width is one node, not two
    return np.asarray(nodes[np.concatenate([[True], np.diff(nodes) > 0.0])])


def halved(nodes: Floats) -> Floats:
    """The nodes with the middles of all steps between them.

    >>> halved(np.array([0.0, 1.0, 3.0]))
    array([0. , 0.5, 1. , 2. , 3. ])
    """
    out = np.empty(2 * nodes.size - 1)
    out[::2] = nodes
    out[1::2] = 0.5 * (nodes[1:] + nodes[:-1])
    return out


def cells_of(*, rows: int, columns: int) -> Integers:
    """Nine-node elements of a structured grid of (2 rows + 1, 2 columns + 1) nodes.

    >>> cells_of(rows=1, columns=2)[1].tolist()
    [[2, 3, 4], [7, 8, 9], [12, 13, 14]]
    """
    number = np.arange((2 * rows + 1) * (2 * columns + 1)).reshape(2 * rows + 1, -1)
    blocks = [
        number[2 * i : 2 * i + 3, 2 * j : 2 * j + 3] for i in range(rows) for j in range(columns)
    ]
    return np.array(blocks, dtype=np.int64)


def _plane(r: Floats, phi: Floats) -> Floats:
    return np.stack([r * np.sin(phi), r * np.cos(phi)], axis=-1)


@dataclass(frozen=True, eq=False)
class Profile:
    """One flank of a gear, from the bottom of the gap to the tip, with the joint of a mesh."""

    gear: Gear
    joint: float = CRITICAL_SLOPE

    @cached_property
    def start(self) -> float:
        """Rack normal angle of the point where tooth and foot meet."""
        return section_angle(self.gear, self.joint)

    def fillet(self, gamma: Floats) -> tuple[Floats, Floats]:
        """(r, phi) on the fillet."""
        x, y = self.gear.fillet.point(gamma)
        return np.hypot(x, y), np.arctan2(x, y)

    def involute(self, arc: Floats) -> tuple[Floats, Floats]:
        """(r, phi) at the length ``arc`` of the involute from the base circle."""
        base = self.gear.base_radius
        t = np.sqrt(2.0 * np.maximum(arc, 0.0) / base)
        return base * np.sqrt(1.0 + t * t), self.gear.base_half_angle - (t - np.arctan(t))

    def arc(self, t: float) -> float:
        """Length of the involute from the base circle to t = tan(alpha_k)."""
        return 0.5 * self.gear.base_radius * t * t

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Lengths of the involute at the form circle and at the tip."""
        gear = self.gear
        tip = float(np.tan(gear.pressure_angle_at(gear.tip_radius - gear.tip_chamfer)))
        return self.arc(gear.junction[1]), self.arc(tip)

    def bottom(self, part: Floats) -> tuple[Floats, Floats]:
        """(r, phi) from the meeting point (part 0) to the middle of the gap (1), by length."""
        gear = self.gear
        r, phi = self.fillet(np.linspace(self.start, 0.5 * np.pi, _FINE_SAMPLES))
        floor = np.linspace(gear.root_half_angle, np.pi / gear.teeth, _FINE_SAMPLES)[1:]
        r = np.concatenate([r, np.full(floor.size, gear.root_radius)])
        phi = np.concatenate([phi, floor])
        step = np.hypot(np.diff(r), 0.5 * (r[1:] + r[:-1]) * np.diff(phi))
        way = np.concatenate([[0.0], np.cumsum(step)])
        way /= way[-1]
        return np.interp(part, way, r), np.interp(part, way, phi)


@dataclass(frozen=True, eq=False)
class Foot:
    """Sector of the body with the fillets of one tooth; ``across`` is the joint's grading.

    Node numbers of its edges: ``bore``, ``left`` and ``right`` (towards the neighbours, from
    the bore outward, bore left out), ``joint`` (towards the tooth, ascending phi) and ``fillet``
    (of the loaded flank, from the joint to the middle of the gap).
    """

    patch: Patch
    bore: Integers
    left: Integers
    right: Integers
    joint: Integers
    fillet: Integers
    half_angle: float


def _body_radii(*, low: float, high: float, size: float, rate: float, part: float) -> Floats:
    """Ascending radii from ``low`` to ``high`` [m]: steps of ``size`` there, growing inward.

    They grow by ``rate`` up to ``part`` of their radius, for the field of a ring varies with the
    logarithm of the radius; all are scaled to end where they must.
    """
    radii, step = [high], size
    while radii[-1] > low:
        radii.append(radii[-1] - step)
        step = min(step * rate, part * max(radii[-1], low))
    out = np.array(radii[::-1])
    return np.asarray(low + (out - out[0]) * (high - low) / (high - out[0]))


def foot_mesh(gear: Gear, across: Floats, density: Density) -> Foot:
    """The foot of a tooth whose joint has corners at ``across`` in -1 .. 1 of its half angle.

    >>> foot_mesh(Gear(20, 4e-3), plain_across(Density()), Density()).joint.size
    9
    """
    profile = Profile(gear, density.joint)
    m, half = gear.module, np.pi / gear.teeth
    r_joint, phi_joint = (float(at) for at in profile.fillet(np.asarray(profile.start)))
    r_low = gear.root_radius - min(0.5 * m, 0.5 * (gear.root_radius - gear.bore_radius))
    # the lines below the joint lean inward, so that three equal corners meet in the fillet
    phi_low = max(phi_joint - np.tan(np.pi / 6.0) * (r_joint - r_low) / r_joint, 0.5 * phi_joint)

    steps = density.count(density.sides)
    part = halved(np.linspace(0.0, 1.0, steps + 1))
    middle = halved(across)
    low_side = phi_low + part * (half - phi_low)
    low = np.concatenate([-low_side[::-1], phi_low * middle[1:-1], low_side])
    r_side, phi_side = profile.bottom(part)
    top_r = np.concatenate([r_side[::-1], np.full(middle.size - 2, r_joint), r_side])
    top_phi = np.concatenate([-phi_side[::-1], phi_joint * middle[1:-1], phi_side])

    body = _body_radii(
        low=gear.bore_radius,
        high=r_low,
        size=0.35 * m / density.refinement,
        rate=density.rate,
        part=0.25 / density.refinement,
    )
    body_rows = halved(body)
    rows = density.inward ** (-np.arange(density.count(density.below)) / density.refinement)
    lift = halved(np.append(0.0, np.cumsum(rows) / rows.sum()))[1:]
    r = np.concatenate(
        [
            np.broadcast_to(body_rows[:, None], (body_rows.size, low.size)),
            (1.0 - lift[:, None]) * r_low + lift[:, None] * top_r,
        ]
    )
    phi = np.concatenate(
        [
            np.broadcast_to(low, (body_rows.size, low.size)),
            (1.0 - lift[:, None]) * low + lift[:, None] * top_phi,
        ]
    )
    rows, columns = r.shape
    number = np.arange(r.size).reshape(r.shape)
    nodes = _plane(r, phi).reshape(-1, 2)
    cells = cells_of(rows=(rows - 1) // 2, columns=(columns - 1) // 2)
    return Foot(
        Patch(nodes, cells, gear.material.poisson_ratio),
        bore=number[0],
        left=number[1:, 0],
        right=number[1:, -1],
        joint=number[-1, 2 * steps : columns - 2 * steps],
        fillet=number[-1, columns - 2 * steps - 1 :],
        half_angle=half,
    )


@dataclass(frozen=True, eq=False)
class Tooth:
    """Mesh of a tooth above its joint; ``flank``: nodes of the loaded flank, upward.

    Their last ``rows`` elements are on the involute.
    """

    patch: Patch
    joint: Integers
    flank: Integers
    rows: int


def tooth_mesh(gear: Gear, *, across: Floats, arcs: Floats, density: Density) -> Tooth:
    """A tooth with corners at ``across`` (joint) and at the involute lengths ``arcs``.

    ``arcs`` ascend from the form circle to the tip.

    >>> gear, density = Gear(20, 4e-3), Density()
    >>> across, arcs = plain_across(density), np.linspace(0.1e-3, 6.9e-3, 5)
    >>> tooth_mesh(gear, across=across, arcs=arcs, density=density).patch.cells.shape
    (28, 3, 3)
    """
    profile = Profile(gear, density.joint)
    r, phi = profile.involute(halved(arcs))
    if abs(profile.start - gear.junction[0]) > 1e-9:
        gammas = halved(np.linspace(profile.start, gear.junction[0], density.count(3) + 1))
        r_fillet, phi_fillet = profile.fillet(gammas[:-1])
        r, phi = np.concatenate([r_fillet, r]), np.concatenate([phi_fillet, phi])
    columns = halved(across)
    grid_r = np.broadcast_to(r[:, None], (r.size, columns.size))
    nodes = _plane(grid_r, phi[:, None] * columns).reshape(-1, 2)
    number = np.arange(nodes.shape[0]).reshape(r.size, columns.size)
    cells = cells_of(rows=(r.size - 1) // 2, columns=(columns.size - 1) // 2)
    return Tooth(
        Patch(nodes, cells, gear.material.poisson_ratio), number[0], number[:, -1], arcs.size - 1
    )


def plain_across(density: Density) -> Floats:
    """The joint's corners under a tooth that nothing touches.

    >>> plain_across(Density())
    array([-1. , -0.5,  0. ,  0.5,  1. ])
    """
    return np.linspace(-1.0, 1.0, density.count(4) + 1)
