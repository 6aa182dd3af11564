"""Compliance of a whole gear under Hertzian pressure on its flanks, by finite elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.gears.elements import Integers, Patch
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth import flank_point
from thermogear.gears.tooth_mesh import (
    Density,
    Foot,
    Profile,
    Tooth,
    contact_across,
    contact_arcs,
    foot_mesh,
    plain_across,
    plain_arcs,
    tooth_mesh,
)
from thermogear.verify.elements import ReferencePatch


def unknowns_of(nodes: Integers) -> Integers:
    """Numbers of the two displacements of each node, node by node."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


class Condensed:
    """A patch reduced to the unknowns ``kept``; ``held`` are fixed at zero.

    ``strained``: see :meth:`Patch.stiffness`.
    """

    def __init__(
        self,
        patch: Patch,
        kept: Integers,
        held: Integers | None = None,
        strained: tuple[float, float, float] | None = None,
    ) -> None:
        whole = ReferencePatch.of(patch).stiffness(strained)
        held = np.empty(0, dtype=np.int64) if held is None else held
        inner = np.setdiff1d(np.arange(patch.unknowns), np.concatenate([kept, held]))
        self._inner, self._kept = inner, kept
        columns = whole[:, kept]
        self._coupling = columns[inner]
        self._factor: Any = splu(
            whole[inner][:, inner].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        through = self._factor.solve(self._coupling.toarray())
        stiffness = columns[kept].toarray() - self._coupling.T @ through
        self.stiffness: Floats = 0.5 * (stiffness + stiffness.T)

    def load(self, load: Floats) -> tuple[Floats, float]:
        """(load as the kept unknowns feel it, compliance of the load with those held)."""
        inner = load[self._inner]
        moved = self._factor.solve(inner)
        return load[self._kept] - self._coupling.T @ moved, float(inner @ moved)


def _turn(stiffness: Floats, foot: Foot, count: int) -> Floats:
    """The first 2 x ``count`` nodes' unknowns (left, then right edge) made radial and hoop."""
    out = stiffness.copy()
    for side, angle in ((0, -foot.half_angle), (1, foot.half_angle)):
        s, c = np.sin(angle), np.cos(angle)
        # columns: radial and hoop direction in x, y
        frame = np.kron(np.eye(count), np.array([[s, c], [c, -s]]))
        part = slice(2 * count * side, 2 * count * (side + 1))
        out[part] = frame.T @ out[part]
        out[:, part] = out[:, part] @ frame
    return out


def open_sector(foot: Foot) -> Floats:
    """Stiffness of a foot at its left edge, right edge (radial, hoop) and joint (x, y)."""
    kept = unknowns_of(np.concatenate([foot.left, foot.right, foot.joint]))
    reduced = Condensed(foot.patch, kept, unknowns_of(foot.bore))
    return _turn(reduced.stiffness, foot, foot.left.size)


def eliminate(stiffness: Floats, gone: Integers) -> Floats:
    """The matrix reduced to the other unknowns, which keep their order."""
    rest = np.setdiff1d(np.arange(stiffness.shape[0]), gone)
    through = np.linalg.solve(stiffness[np.ix_(gone, gone)], stiffness[np.ix_(gone, rest)])
    out = stiffness[np.ix_(rest, rest)] - stiffness[np.ix_(rest, gone)] @ through
    return np.asarray(0.5 * (out + out.T))


def closed_sector(foot: Foot, tooth: Tooth) -> Floats:
    """Stiffness at the left and right edge of a sector whose tooth nothing touches."""
    sector = open_sector(foot)
    above = Condensed(tooth.patch, unknowns_of(tooth.joint)).stiffness
    size = above.shape[0]
    sector[-size:, -size:] += above
    return eliminate(sector, np.arange(sector.shape[0] - size, sector.shape[0]))


def joined(*, first: Floats, second: Floats) -> Floats:
    """Two chains of sectors, the first's right edge on the second's left one."""
    n = first.shape[0] // 2
    whole = np.zeros((3 * n, 3 * n))
    whole[: 2 * n, : 2 * n] += first
    whole[n:, n:] += second
    return eliminate(whole, np.arange(n, 2 * n))


def chain(sector: Floats, count: int) -> Floats:
    """``count`` >= 1 equal sectors in a row."""
    power, result = sector, None
    while True:
        if count % 2:
            result = power if result is None else joined(first=result, second=power)
        count //= 2
        if count == 0:
            return result if result is not None else power
        power = joined(first=power, second=power)


def joint_stiffness(sector: Floats, *, others: Floats, edge: int, teeth: int) -> Floats:
    """Stiffness at the joints of ``teeth`` neighbours, the rest of the ring being ``others``.

    ``sector`` from :func:`open_sector` with ``edge`` unknowns on each side; the teeth stand in
    the order of ascending polar angle.
    """
    joint = sector.shape[0] - 2 * edge
    edges = (teeth + 1) * edge
    whole = np.zeros((edges + teeth * joint, edges + teeth * joint))
    for i in range(teeth):
        places = np.concatenate(
            [np.arange(i * edge, (i + 2) * edge), edges + np.arange(i * joint, (i + 1) * joint)]
        )
        whole[np.ix_(places, places)] += sector
    # the chain of the others starts on the last edge and ends on the first
    places = np.concatenate([np.arange(edges - edge, edges), np.arange(edge)])
    whole[np.ix_(places, places)] += others
    return eliminate(whole, np.arange(edges))


NEAR = {
    "strain": "plane strain as far from the contact as the tooth's axis, along the force",
    "stress": "plane stress up to the contact",
}
"""Plane state around a contact: its material is held in by the rest of the tooth's width."""


class LoadedTooth:
    """One tooth meshed for a contact at t = tan(alpha_k), reduced to its joint."""

    def __init__(
        self,
        gear: Gear,
        t: float,
        half_width: float,
        across: Floats,
        density: Density,
        near: str,
    ) -> None:
        profile = Profile(gear)
        self._arc = profile.arc(t)
        self._room = min(self._arc - profile.ends[0], profile.ends[1] - self._arc)
        self._base = gear.base_radius
        self._mesh = tooth_mesh(
            gear, across=across, arcs=contact_arcs(gear, t, half_width, density), density=density
        )
        at = flank_point(gear, t)
        # as far as the tooth's axis along the force
        depth = float(at.x / np.cos(at.beta)) if near == "strain" else -1.0
        self._reduced = Condensed(
            self._mesh.patch,
            unknowns_of(self._mesh.joint),
            strained=(float(at.x), float(at.y), depth),
        )
        self.stiffness = self._reduced.stiffness

    def pressed(self, half_width: float) -> tuple[Floats, float]:
        """Load at the joint and own compliance under a unit force of ``half_width`` a [m].

        p = 2/(pi a) sqrt(1 - (s/a)^2) along the flank, normal to it.
        """
        if not half_width <= self._room:
            raise InputError(
                "position",
                f"{1e3 * self._room:.4g} mm from the end of the flank",
                allowed=f"> {1e3 * half_width:.4g} mm, the Hertzian half width",
                fix="take a position farther inside the path of contact",
            )

        def pressure(x: Floats, y: Floats) -> Floats:
            arc = 0.5 * ((x * x + y * y) / self._base - self._base)
            inside = np.maximum(1.0 - ((arc - self._arc) / half_width) ** 2, 0.0)
            return np.asarray(2.0 / (np.pi * half_width) * np.sqrt(inside))

        load, total = ReferencePatch.of(self._mesh.patch).pressure_load(self._mesh.flank, pressure)
        return self._reduced.load(load / total)


@dataclass(frozen=True, eq=False)
class ElasticGear:
    """Plane-stress finite elements of a gear with all its teeth, its bore held.

    ``loaded`` neighbouring teeth may carry load on the same flank; ``half_width`` [m] is the
    size of the contacts the mesh is graded for; ``near`` the plane state around a contact, see
    :data:`NEAR`. Unit modulus and width.
    """

    gear: Gear
    loaded: int
    half_width: float
    density: Density = field(default_factory=Density)
    near: str = "strain"

    def __post_init__(self) -> None:
        if not 1 <= self.loaded < self.gear.teeth:
            raise InputError("loaded", self.loaded, allowed=f"1..{self.gear.teeth - 1} teeth")
        if not self.half_width > 0.0:
            raise InputError("half_width", f"{self.half_width} m", allowed="> 0")
        if self.near not in NEAR:
            raise InputError(
                "near", repr(self.near), allowed=" | ".join(NEAR), fix=nearest(self.near, NEAR)
            )

    @cached_property
    def across(self) -> Floats:
        """Corners of the joints of the teeth that may carry load."""
        return contact_across(self.gear, self.half_width, self.density)

    @cached_property
    def joints(self) -> Floats:
        """Stiffness of the body and of all other teeth at the joints of the loaded ones."""
        plain = plain_across(self.density)
        idle_foot = foot_mesh(self.gear, plain, self.density)
        idle = closed_sector(
            idle_foot,
            tooth_mesh(
                self.gear,
                across=plain,
                arcs=plain_arcs(self.gear, self.density),
                density=self.density,
            ),
        )
        foot = foot_mesh(self.gear, self.across, self.density)
        others = chain(idle, self.gear.teeth - self.loaded)
        return joint_stiffness(
            open_sector(foot), others=others, edge=2 * foot.left.size, teeth=self.loaded
        )

    def tooth(self, t: float) -> LoadedTooth:
        """A tooth touched at t = tan(alpha_k)."""
        return LoadedTooth(self.gear, t, self.half_width, self.across, self.density, self.near)

    @cached_property
    def _idle(self) -> Floats:
        mesh = tooth_mesh(
            self.gear,
            across=self.across,
            arcs=plain_arcs(self.gear, self.density),
            density=self.density,
        )
        return Condensed(mesh.patch, unknowns_of(mesh.joint)).stiffness

    def assembled(self, teeth: Sequence[LoadedTooth | None]) -> Floats:
        """Compliance at the joints with these teeth put on; None is a tooth without load."""
        if len(teeth) != self.loaded:
            raise InputError("teeth", len(teeth), allowed=f"{self.loaded}")
        whole = self.joints.copy()
        size = whole.shape[0] // self.loaded
        for (low, high), tooth in zip(
            pairwise(range(0, whole.shape[0] + 1, size)), teeth, strict=True
        ):
            whole[low:high, low:high] += self._idle if tooth is None else tooth.stiffness
        return np.asarray(np.linalg.inv(whole))

    def compliance(
        self,
        teeth: Sequence[LoadedTooth | None],
        half_widths: Sequence[float],
        *,
        assembled: Floats | None = None,
    ) -> Floats:
        """Matrix of the deflections along the flanks' normals under unit forces, times E b.

        Deflection is the mean over a contact, weighted by its pressure. teeth: in the order of
        ascending polar angle (the loaded flank faces that way); half_widths: of each contact
        [m]; rows and columns of teeth without load are 0.
        """
        joint = self.assembled(teeth) if assembled is None else assembled
        size = joint.shape[0] // self.loaded
        loads = np.zeros((self.loaded, joint.shape[0]))
        own = np.zeros(self.loaded)
        for i, (tooth, a) in enumerate(zip(teeth, half_widths, strict=True)):
            if tooth is not None:
                loads[i, i * size : (i + 1) * size], own[i] = tooth.pressed(a)
        return np.asarray(loads @ joint @ loads.T + np.diag(own))
