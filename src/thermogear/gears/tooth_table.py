"""Compliance of a gear's teeth from finite elements of one sector: tooth, fillets and body.

One pitch of the gear is meshed once, in modules, and its sides are joined to those of all other
pitches by a Fourier series over the teeth: the compliance between a tooth and its neighbours of
the whole gear costs one sparse factorization. What belongs to the contact alone, the indentation
under a narrow pressure, is taken off, so that the compliance left does not depend on the pressure
of the mesh's loads; the law of the contact adds it again for the load at hand.
Source: cyclic symmetry as in Thomas, Dynamics of rotationally periodic structures, 1979.
Checked by ``tests/gears/test_tooth_table.py``: wind-up of the ring in closed form, reciprocity,
module and width of the pressure, and finite elements not written here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.elements import Integers, Patch, quadratic
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth import flank_point
from thermogear.gears.tooth_mesh import Density, Foot, Profile, Tooth, foot_mesh, tooth_mesh

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

PLANES = {
    "stress": "teeth and bodies in plane stress, the contact alone in plane strain",
    "strain": "plane strain everywhere, as in the middle of a wide gear",
}
MATES = 4
"""Farthest neighbours, in pitches, whose coupling is kept: a contact ratio below 4."""
PATCH = 0.12
"""Half width [modules] of the pressure of a load."""
STATIONS = 12
"""Chebyshev points of the loads along a flank; two more stand at its tip."""
MESH = Density(growth=1.5)
COUPLED = 6
"""Degree, in both places, of the coupling's polynomial."""
_PRESSURE = 40
"""Points of Gauss and Chebyshev's rule over an elliptic pressure."""
ROWS, COLUMNS = 22, 8
"""Elements along the flank and across the tooth."""


def indentation(depth_ratio: ArrayLike, *, poisson: float) -> Floats:
    """W: approach under a Hertzian pressure of half width a against a depth h, times E b/F.

    W(eta) = (2/pi) [arsinh(eta) - nu eta (sqrt(1 + eta^2) - eta)], eta = h/a, plane stress; the
    place where the force acts is measured at the mean over the pressure, 1/(2 pi) less.
    Source: Weber and Banaschek 1953, with the plane stress moduli.

    >>> f"{indentation(10.0, poisson=0.3):.3f}"
    '1.813'
    """
    eta = np.asarray(depth_ratio, dtype=float)
    root = np.sqrt(1.0 + eta * eta)
    return np.asarray(2.0 / np.pi * (np.arcsinh(eta) - poisson * eta / (root + eta)))


class TipCompliance(NamedTuple):
    """Tip station of a tooth under its load and the load turned by 90 deg: C_nn, C_nt, C_tt.

    Unit modulus and width, without the contact's indentation.
    """

    normal: float
    mixed: float
    tangential: float

    def turned(self, angle: ArrayLike) -> Floats:
        """c^2 C_nn + 2 c s C_nt + s^2 C_tt of a load turned by ``angle`` [rad] towards the tip."""
        c, s = np.cos(angle), np.sin(angle)
        return np.asarray(c * c * self.normal + 2.0 * c * s * self.mixed + s * s * self.tangential)


@dataclass(frozen=True, eq=False, kw_only=True)
class Flank:
    """Places on a loaded flank.

    ``ends``: arcs of the involute [modules] from the base circle at form circle and tip; ``base``:
    r_b [modules].
    """

    ends: tuple[float, float]
    base: float

    def place(self, t: ArrayLike) -> Floats:
        """-1 at the form circle .. 1 at the tip, by arc, for t = tan(alpha_k)."""
        arc = 0.5 * self.base * np.asarray(t, dtype=float) ** 2
        low, high = self.ends
        return np.asarray(np.clip((2.0 * arc - low - high) / (high - low), -1.0, 1.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class ToothTable(Flank):
    """Compliances of a gear's loaded flanks, times E b, by place and by distance in pitches.

    ``tooth``, ``body``: compliance of a tooth under its load at the ``stations``
    (-1 at the form circle .. 1 at the tip), by where the energy sits; ``coupling`` (lag, degree,
    degree): Chebyshev series of the deflection of the tooth ``lag - MATES`` pitches ahead of the
    loaded one, towards the loaded flank; ``tip_tooth``, ``tip_body``: at the tip; ``windup``: of
    the ring between bore and root circle, in every entry. Bore held.
    """

    stations: Floats
    tooth: Floats
    body: Floats
    coupling: Floats
    tip_tooth: TipCompliance
    tip_body: TipCompliance
    windup: float

    def self_compliance(self, t: ArrayLike) -> tuple[Floats, Floats]:
        """(tooth's part, body's part) at t = tan(alpha_k) of a tooth under its load, times E b.

        The sum of both and the contact's law of approach is the deflection along the force. Near
        the root of a thick tooth the tooth's part may be below 0, for the contact's law counts
        material that the tooth does not have. Shape of ``t``.
        """
        place = self.place(t)
        return _cubic(place, self.stations, self.tooth), _cubic(place, self.stations, self.body)

    def under(self, t: Floats, angle: Floats) -> tuple[Floats, Floats]:
        """:meth:`self_compliance` of a load turned by ``angle`` [rad] >= 0 towards the root."""
        tooth, body = self.self_compliance(t)
        return (
            tooth + self.tip_tooth.turned(-angle) - self.tip_tooth.normal,
            body + self.tip_body.turned(-angle) - self.tip_body.normal,
        )

    def coupled(self, t: Floats, *, loaded: Floats, lag: int) -> Floats:
        """Deflection at ``t`` of the tooth ``lag`` pitches ahead of one loaded at ``loaded``."""
        if abs(lag) > MATES:
            return np.zeros(np.broadcast_shapes(t.shape, loaded.shape))
        return np.asarray(
            chebyshev.chebval2d(self.place(t), self.place(loaded), self.coupling[lag + MATES])
        )


def tooth_table(gear: Gear, plane: str = "stress") -> ToothTable:
    """The table of ``gear``, remembered by its shape in modules and its Poisson's ratio.

    plane: a key of :data:`PLANES`. In plane strain E/(1 - nu^2) and nu/(1 - nu) take the places of
    E and nu.

    >>> table = tooth_table(Gear(20, 4e-3))
    >>> tooth, body = table.self_compliance(math.tan(math.radians(20)))
    >>> f"{tooth:.2f} {body:.2f}"
    '1.71 4.60'
    """
    return _table(Shape.of(gear, plane))


@dataclass(frozen=True)
class Shape:
    """What a gear's finite elements depend on, and a gear that has it."""

    teeth: int
    plane: str
    numbers: tuple[float, ...]
    gear: Gear = field(compare=False)

    @classmethod
    def of(cls, gear: Gear, plane: str) -> Shape:
        """In modules, to the digits in which modules of the same drawing agree."""
        m, rack = gear.module, gear.rack
        top = gear.tip_radius - gear.tip_chamfer
        key = (top / m, gear.bore_radius / m, rack.dedendum, rack.fillet_radius)
        numbers = (gear.pressure_angle, gear.profile_shift, *key, gear.material.poisson_ratio)
        return cls(gear.teeth, plane, tuple(float(f"{n:.12g}") for n in numbers), gear)

    @property
    def poisson(self) -> float:
        """Of the plane state: nu, or nu/(1 - nu) in plane strain."""
        nu = self.gear.material.poisson_ratio
        return nu if self.plane == "stress" else nu / (1.0 - nu)

    @property
    def softness(self) -> float:
        """What compliances are multiplied by, 1 - nu^2 in plane strain."""
        return 1.0 if self.plane == "stress" else 1.0 - self.gear.material.poisson_ratio**2


@lru_cache(maxsize=64)
def _table(shape: Shape) -> ToothTable:
    return Sector.of(shape.gear, shape.poisson).table(shape.softness)


def _pressure_load(gear: Gear, tooth: Tooth, centre: float, half_width: float) -> Floats:
    """Nodal forces (node, 2) of a unit force of elliptic pressure about the arc ``centre``.

    The pressure acts along the involute's normal; what overhangs the tip is left out and the rest
    is scaled to a unit force. Arcs in metres.
    """
    profile = Profile(gear)
    low, high = profile.ends
    angle = np.pi * np.arange(1, _PRESSURE + 1) / (_PRESSURE + 1)
    arc, weight = centre + half_width * np.cos(angle), np.sin(angle) ** 2
    weight = np.where((arc >= low) & (arc <= high), weight, 0.0)
    weight /= weight.sum()
    beta = np.sqrt(2.0 * np.maximum(arc, 0.0) / gear.base_radius) - gear.base_half_angle
    force = -weight[:, None] * np.stack([np.cos(beta), np.sin(beta)], axis=-1)
    step = (high - low) / tooth.rows
    element = np.clip(((arc - low) / step).astype(int), 0, tooth.rows - 1)
    shape, _ = quadratic(2.0 * ((arc - low) / step - element) - 1.0)
    first = tooth.flank.size - (2 * tooth.rows + 1)
    out = np.zeros(tooth.patch.nodes.shape)
    for node in range(3):
        np.add.at(out, tooth.flank[first + 2 * element + node], shape[node][:, None] * force)
    return out


class Condensed(NamedTuple):
    """A sector with its inner unknowns eliminated, under loads on its tooth.

    Unknowns ``inner`` and at the ``sides``; ``inside`` (inner, load) with the sides held,
    ``by_side`` (inner, side); ``frame`` turns radial and hoop motions of the sides into x and y; by
    these motions ``stiffness`` (side, side) and ``pushed`` (load, side), the deflection at the
    loads;
    ``held`` (load, load): that with the sides held.
    """

    inner: Integers
    sides: Integers
    inside: Floats
    by_side: Floats
    frame: Floats
    stiffness: Floats
    pushed: Floats
    held: Floats


class Solved(NamedTuple):
    """Motion of the sectors under unit forces on the tooth of one, unit modulus and width.

    Unknowns ``inner`` and at the ``sides``; ``inside`` (inner, load) with the sides held,
    ``by_side`` (inner, side); ``moved`` (lag, side, load): the sides of the sector ``lag - MATES``
    pitches ahead; ``lags`` (lag, load, load): deflections at the loads' places there.
    """

    inner: Integers
    sides: Integers
    inside: Floats
    by_side: Floats
    moved: Floats
    lags: Floats

    def felt(self, operator: csr_matrix) -> Floats:
        """(lag, row, load): what ``operator`` (row, unknown) makes of the motion."""
        by_side = operator[:, self.sides].toarray() + operator[:, self.inner] @ self.by_side
        out = np.asarray(by_side @ self.moved)
        out[MATES] += operator[:, self.inner] @ self.inside
        return out


@dataclass(frozen=True, eq=False)
class Sector:
    """One pitch of a gear in finite elements, its bore held, unit modulus and width."""

    gear: Gear
    foot: Foot
    mesh: Tooth
    patch: Patch
    number: Integers

    @classmethod
    def of(
        cls,
        gear: Gear,
        poisson: float,
        density: Density = MESH,
        *,
        rows: int = ROWS,
        columns: int = COLUMNS,
    ) -> Sector:
        """The mesh of ``gear``; ``poisson`` of plane stress, or nu/(1 - nu) of plane strain."""
        across = _graded_columns(density.count(columns))
        low, high = Profile(gear).ends
        foot = foot_mesh(gear, across, density)
        arcs = np.linspace(low, high, density.count(rows) + 1)
        mesh = tooth_mesh(gear, across=across, arcs=arcs, density=density)
        return cls.assembled(gear, foot, mesh, poisson)

    @classmethod
    def assembled(
        cls, gear: Gear, foot: Foot, mesh: Tooth, poisson: float, *, opened: int = 0
    ) -> Sector:
        """Foot and tooth share the nodes of their joint but the last ``opened`` ones."""
        kept = mesh.joint.size - opened
        rest = np.setdiff1d(np.arange(mesh.patch.nodes.shape[0]), mesh.joint[:kept])
        below = foot.patch.nodes.shape[0]
        number = np.empty(mesh.patch.nodes.shape[0], dtype=np.int64)
        number[mesh.joint[:kept]] = foot.joint[:kept]
        number[rest] = below + np.arange(rest.size)
        nodes = np.concatenate([foot.patch.nodes, mesh.patch.nodes[rest]])
        cells = np.concatenate([foot.patch.cells, number[mesh.patch.cells]])
        above = replace(mesh, patch=replace(mesh.patch, poisson=poisson))
        return cls(gear, foot, above, Patch(nodes, cells, poisson), number)

    def loads(self, *, arcs: Floats, widths: Floats) -> Floats:
        """(unknown, load) of unit forces at the lengths ``arcs`` of the involute [m].

        Of elliptic pressures of the half ``widths`` [m].
        """
        loads = np.zeros((self.patch.nodes.shape[0], 2, arcs.size))
        for i, (arc, width) in enumerate(zip(arcs, widths, strict=True)):
            loads[self.number, :, i] = _pressure_load(self.gear, self.mesh, arc, width)
        return loads.reshape(-1, arcs.size)

    def stations(self, count: int) -> tuple[Floats, Floats]:
        """(arc, half width) [m] of ``count`` Chebyshev points of the flank; shape (count,)."""
        low, high = Profile(self.gear).ends
        patch = PATCH * self.gear.module
        first, last = low + 0.5 * patch, high - 0.5 * patch
        arcs = 0.5 * (first + last) + 0.5 * (last - first) * chebyshev.chebpts2(count)
        return arcs, np.clip(np.minimum(arcs - low, high - arcs), 0.5 * patch, patch)

    def condensed(self, loads: Floats) -> Condensed:
        """Factorize; ``loads`` (unknown, load) between bore and sides."""
        from scipy.sparse.linalg import splu

        whole, foot = self.patch.stiffness(), self.foot
        sides = _unknowns(np.concatenate([foot.left, foot.right]))
        held = np.concatenate([sides, _unknowns(foot.bore)])
        inner = np.setdiff1d(np.arange(self.patch.unknowns), held)
        columns = whole[:, sides]
        factor = splu(
            whole[inner][:, inner].tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        coupling = columns[inner].toarray()
        moved = factor.solve(np.concatenate([loads[inner], -coupling], axis=1))
        count = loads.shape[1]
        inside, by_side = moved[:, :count], moved[:, count:]
        frame = _polar_frame(foot)
        pushed = loads[inner].T @ by_side @ frame
        stiffness = frame.T @ (columns[sides].toarray() + coupling.T @ by_side) @ frame
        held = loads[inner].T @ inside
        return Condensed(inner, sides, inside, by_side, frame, stiffness, pushed, held)

    def solved(self, loads: Floats) -> Solved:
        """Condense and join the sectors, ``loads`` as in :meth:`condensed`."""
        part = self.condensed(loads)
        shifted = joined(part.stiffness, pushed=part.pushed, teeth=self.gear.teeth)
        lags = part.pushed @ shifted
        lags[MATES] += part.held
        return Solved(*part[:4], part.frame @ shifted, lags)

    def table(self, softness: float = 1.0) -> ToothTable:
        """Factorize, join the sectors, take the indentation off, and fit.

        ``softness``: what the compliances are multiplied by, 1 - nu^2 in plane strain.
        """
        gear, patch = self.gear, self.patch
        arcs, widths = self.stations(STATIONS)
        low, high = Profile(gear).ends
        wide = PATCH * gear.module
        arcs = np.concatenate([arcs, [high - 0.25 * wide, high]])
        widths = np.concatenate([widths, [0.5 * wide, 0.7 * wide]])
        loads = self.loads(arcs=arcs, widths=widths)
        # turned by a right angle: from into the flank to along it, towards the tip
        turned = loads[:, -1].reshape(-1, 2) @ np.array([[0.0, -1.0], [1.0, 0.0]])
        solved = self.solved(np.column_stack([loads, turned.ravel()]))
        count = arcs.size + 1

        # the energy of the tooth above its foot, under its load
        motion = np.zeros((patch.unknowns, count))
        motion[solved.inner] = solved.inside + solved.by_side @ solved.moved[MATES]
        motion[solved.sides] = solved.moved[MATES]
        above = motion.reshape(-1, 2, count)[self.number].reshape(-1, count)
        tooth = above.T @ (self.mesh.patch.stiffness() @ above)
        at = flank_point(gear, np.sqrt(2.0 * arcs / gear.base_radius))
        nu = patch.poisson
        local = indentation(at.x / np.cos(at.beta) / widths, poisson=nu) - 0.5 / np.pi
        body = softness * (solved.lags[MATES] - tooth)
        tooth[np.diag_indices(count)] -= np.append(local, local[-1])
        tooth *= softness
        place = (2.0 * arcs - low - high) / (high - low)
        order = np.argsort(place)
        fit = np.linalg.pinv(chebyshev.chebvander(place, COUPLED))
        return ToothTable(
            ends=(low / gear.module, high / gear.module),
            base=gear.base_radius / gear.module,
            stations=place[order],
            tooth=np.diag(tooth)[order],
            body=np.diag(body)[order],
            coupling=np.einsum(
                "is,kst,jt->kij",
                fit,
                softness * solved.lags[:, : arcs.size, : arcs.size],
                fit,
                optimize=True,
            ),
            tip_tooth=TipCompliance(tooth[-2, -2], tooth[-2, -1], tooth[-1, -1]),
            tip_body=TipCompliance(body[-2, -2], body[-2, -1], body[-1, -1]),
            windup=softness
            * gear.base_radius**2
            * (1.0 + nu)
            / (2.0 * np.pi)
            * (gear.bore_radius**-2 - gear.root_radius**-2),
        )


def _cubic(place: Floats, nodes: Floats, values: Floats) -> Floats:
    """Cubic pieces through ``values`` with the slopes of parabolas through three; flat beyond."""
    slopes = np.gradient(values, nodes, edge_order=2)
    x = np.clip(place, nodes[0], nodes[-1])
    i = np.clip(np.searchsorted(nodes, x) - 1, 0, nodes.size - 2)
    step = nodes[i + 1] - nodes[i]
    u = (x - nodes[i]) / step
    tangents = u * (1.0 - u) * step * ((1.0 - u) * slopes[i] - u * slopes[i + 1])
    right = u * u * (3.0 - 2.0 * u)
    return np.asarray((1.0 - right) * values[i] + right * values[i + 1] + tangents)


def _graded_columns(count: int) -> Floats:
    """Corners across the tooth in -1 .. 1, narrower towards the loaded flank by 1.5 in all."""
    steps = 1.5 ** -np.linspace(0.0, 1.0, count)
    return np.asarray(np.concatenate([[0.0], np.cumsum(steps)]) / steps.sum() * 2.0 - 1.0)


def _unknowns(nodes: Integers) -> Integers:
    """Numbers of the two displacements of each node, node by node."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


def _polar_frame(foot: Foot) -> Floats:
    """Displacements in x and y of the left, then the right side by radial and hoop ones."""
    frame = np.zeros((4 * foot.left.size,) * 2)
    for side, angle in ((0, -foot.half_angle), (1, foot.half_angle)):
        s, c = np.sin(angle), np.cos(angle)
        part = slice(2 * foot.left.size * side, 2 * foot.left.size * (side + 1))
        frame[part, part] = np.kron(np.eye(foot.left.size), np.array([[s, c], [c, -s]]))
    return frame


def joined(stiffness: Floats, *, pushed: Floats, teeth: int) -> Floats:
    """Motion of the sides of the sectors about the loaded one, (lag, side, load).

    stiffness (side, side), left before right: of the sector at its sides; pushed (load, side): the
    deflection at the loads by a unit motion of the sides, which is the force of the loads on them.
    With w = exp(2 pi i n/z) the left sides' equation of harmonic n is K_n u_n = V^H f,
    K_n = K_LL + K_RR + w K_LR + K_RL/w, V = P_L + w P_R; k pitches ahead they move by
    (1/z) sum over n of w^k u_n, and their right sides as the next sector's left ones.

    >>> joined(np.eye(2), pushed=np.ones((1, 2)), teeth=9)[MATES].ravel().round(3)
    array([0.5, 0.5])
    """
    half = stiffness.shape[0] // 2
    left, right = slice(None, half), slice(half, None)
    order = np.arange(teeth // 2 + 1)
    turn = np.exp(2j * np.pi * order / teeth)[:, None, None]
    ring = (
        stiffness[left, left]
        + stiffness[right, right]
        + turn * stiffness[left, right]
        + np.conj(turn) * stiffness[right, left]
    )
    felt = pushed[:, left] + turn * pushed[:, right]
    moved = np.linalg.solve(ring, np.conj(np.swapaxes(felt, 1, 2)))
    often = np.where((order == 0) | (2 * order == teeth), 1.0, 2.0) / teeth
    lag = np.arange(-MATES, MATES + 2)
    weight = often * turn[:, 0, 0] ** lag[:, None]
    shifted = np.tensordot(weight, moved, 1).real
    return np.concatenate([shifted[:-1], shifted[1:]], axis=1)
