"""One pitch of a gear with a finely divided flank, condensed to the flank for the whole gear.

The sector is assembled by scikit-fem, its bore is held, and its sides are joined to those of all
other pitches by a Fourier series over the teeth (Thomas 1979): with w = exp(2 pi i n/z),
K_n = K_LL + K_RR + w K_LR + K_RL/w is the stiffness of harmonic n at a side.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from finite_elements.elements import ReferencePatch
from thermogear.base.arrays import Floats
from thermogear.gears.elements import Integers, quadratic
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth_mesh import (
    Density,
    Foot,
    Profile,
    Tooth,
    foot_mesh,
    graded,
    tooth_mesh,
)

MATES = 5
"""Farthest neighbours, in pitches, whose coupling is kept."""
FINER = 4.0
"""How much shorter the element at the tip is: a corner's pressure is narrow."""
TIP = 0.3
"""Length [modules] below the tip where forces may be turned out of the flank's normal."""


def unknowns_of(nodes: Integers) -> Integers:
    """Numbers of the two displacements of each node, node by node."""
    return np.asarray((2 * nodes[:, None] + np.arange(2)).ravel())


def united(foot: Foot, tooth: Tooth) -> tuple[ReferencePatch, Integers]:
    """Foot and tooth as one patch, and the numbers of the tooth's nodes in it."""
    below = foot.patch.nodes.shape[0]
    rest = np.setdiff1d(np.arange(tooth.patch.nodes.shape[0]), tooth.joint)
    number = np.empty(tooth.patch.nodes.shape[0], dtype=np.int64)
    number[tooth.joint] = foot.joint
    number[rest] = below + np.arange(rest.size)
    nodes = np.concatenate([foot.patch.nodes, tooth.patch.nodes[rest]])
    cells = np.concatenate([foot.patch.cells, number[tooth.patch.cells]])
    return ReferencePatch(nodes, cells, foot.patch.poisson), number


@dataclass(frozen=True, eq=False)
class FlankSector:
    """Compliance of a gear at the nodes of its flanks, times E b, plane stress.

    Elements of the length ``step`` [m] along the involute, shorter at the tip; degrees of
    freedom: forces into the flank along its normal at all nodes, then forces along the flank
    towards the tip at the last ``turned`` nodes; last the strain along the edge of the fillet of
    the loaded flank, at its elements' Gauss points. ``foot``: refinement below the tooth;
    ``core``: arc and half length [m] of the only stretch with elements so short, by default all.
    """

    gear: Gear
    step: float
    foot: int = 1
    core: tuple[float, float] | None = None

    @cached_property
    def ends(self) -> tuple[float, float]:
        """Arcs [m] of the involute from the base circle at form circle and tip."""
        return Profile(self.gear).ends

    @cached_property
    def arcs(self) -> Floats:
        """Arcs [m] of the elements' vertices, upward."""
        low, high = self.ends
        centre, core = (high, 0.0) if self.core is None else self.core
        at_tip = self.core is None
        return graded(
            low=low,
            high=high,
            centre=centre,
            core=core,
            fine=self.step / FINER if at_tip else self.step,
            rate=1.15 if at_tip else 1.5,
            coarse=self.step if at_tip else 0.15 * self.gear.module,
        )

    @property
    def rows(self) -> int:
        """Number of elements along the involute."""
        return self.arcs.size - 1

    @cached_property
    def turned(self) -> int:
        """Number of nodes below the tip whose force may be turned."""
        return 2 * int(np.sum(self.arcs[:-1] > self.ends[1] - TIP * self.gear.module)) + 1

    @cached_property
    def _meshed(self) -> tuple[ReferencePatch, Foot, Integers]:
        """The sector, its foot, and the nodes of the loaded side from the gap to the tip."""
        gear = self.gear
        half = 0.25 * np.pi * gear.module
        density = Density(growth=1.5, refinement=self.foot)
        across = graded(
            low=-1.0,
            high=1.0,
            centre=1.0,
            core=0.0,
            fine=self.step / half,
            rate=1.5,
            coarse=0.2 * gear.module / half,
        )
        foot = foot_mesh(gear, across, density)
        tooth = tooth_mesh(gear, across=across, arcs=self.arcs, density=density)
        patch, number = united(foot, tooth)
        below = np.arange(foot.right[-1], foot.joint[-1], -1)
        return patch, foot, np.concatenate([below, number[tooth.flank]])

    @cached_property
    def _solved(self) -> tuple[Floats, Floats, Floats]:
        patch, foot, edge = self._meshed
        nodes = edge[-(2 * self.rows + 1) :]
        loads = np.concatenate(
            [self._loads(patch.nodes, nodes), self._strains(patch.nodes)[0]], axis=1
        )
        whole = patch.stiffness()
        sides = unknowns_of(np.concatenate([foot.left, foot.right]))
        inner = np.setdiff1d(
            np.arange(patch.unknowns), np.concatenate([sides, unknowns_of(foot.bore)])
        )
        factor = splu(
            csc_matrix(whole[inner][:, inner]),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        coupling = whole[inner][:, sides].toarray()
        own_motion = factor.solve(loads[inner])
        by_side = -factor.solve(coupling)
        frame = np.zeros((sides.size,) * 2)
        for side, angle in ((0, -foot.half_angle), (1, foot.half_angle)):
            s, c = np.sin(angle), np.cos(angle)
            part = slice(2 * foot.left.size * side, 2 * foot.left.size * (side + 1))
            frame[part, part] = np.kron(np.eye(foot.left.size), np.array([[s, c], [c, -s]]))
        stiffness = frame.T @ (whole[sides][:, sides].toarray() + coupling.T @ by_side) @ frame
        own = loads[inner].T @ own_motion
        return 0.5 * (own + own.T), loads[inner].T @ by_side @ frame, self._ring(stiffness)

    def _loads(self, places: Floats, nodes: Integers) -> Floats:
        """Unit forces of all degrees of freedom, (unknown, degree)."""
        r = np.hypot(*places[nodes].T)
        t = np.sqrt(np.maximum((r / self.gear.base_radius) ** 2 - 1.0, 0.0))
        beta = t - self.gear.base_half_angle
        count, turned = nodes.size, self.turned
        out = np.zeros((2 * places.shape[0], count + turned))
        out[2 * nodes, np.arange(count)] = -np.cos(beta)
        out[2 * nodes + 1, np.arange(count)] = -np.sin(beta)
        last = np.arange(count, count + turned)
        out[2 * nodes[-turned:], last] = -np.sin(beta[-turned:])
        out[2 * nodes[-turned:] + 1, last] = np.cos(beta[-turned:])
        return out

    def _strains(self, places: Floats) -> tuple[Floats, Floats]:
        """Strain along the fillet's edge by the unknowns, (unknown, point); points (point, 2)."""
        edge = self._meshed[2]
        # the first element ends on the sector's side, whose motion is not a load case's
        edge = edge[2 : edge.size - 2 * self.rows]
        sides = np.stack([edge[:-2:2], edge[1:-1:2], edge[2::2]], axis=1)
        values, slopes = quadratic(np.array([-1.0, 1.0]) / np.sqrt(3.0))
        along = np.einsum("kp,skc->spc", slopes, places[sides])
        length = np.sum(along**2, axis=-1, keepdims=True)
        by_node = np.einsum("kp,spc->spkc", slopes, along / length)
        point = np.arange(2 * sides.shape[0]).reshape(-1, 2, 1)
        out = np.zeros((2 * places.shape[0], point.size))
        for axis in (0, 1):
            out[2 * sides[:, None, :] + axis, point] = by_node[..., axis]
        return out, np.einsum("kp,skc->spc", values, places[sides]).reshape(-1, 2)

    def root_stress(self, weights: Floats) -> tuple[Floats, Floats]:
        """Stress sigma b/F along the fillet's edge [1/m] by the load cases; its points (point, 2).

        weights (case, degree) of unit loads; > 0 is tension, from the gap's middle upward.
        """
        places = self._strains(self._meshed[0].nodes)[1]
        strains = np.zeros((places.shape[0], self.degrees))
        strains[:, -places.shape[0] :] = np.eye(places.shape[0])
        first, second = (strains, self.felt(strains)), (weights, self.felt(weights))
        return self.compliance(first, second=second, lag=0).T, places

    def pressed(self, arc: float, *, half_width: float) -> Floats:
        """Weights (1, degree) of a unit force of elliptic pressure about ``arc`` [m]."""
        angle = np.pi * np.arange(1, 80) / 80
        nodes, shape = self.shapes(arc + half_width * np.cos(angle))
        out = np.zeros((1, self.degrees))
        np.add.at(out[0], nodes, shape * np.sin(angle) ** 2 / 40)
        return out

    def _ring(self, stiffness: Floats) -> Floats:
        """Motion of both sides of a tooth ``lag`` pitches ahead by forces there, (lag, side, side).

        Lags -MATES .. MATES.
        """
        z, half = self.gear.teeth, stiffness.shape[0] // 2
        left, right = slice(None, half), slice(half, None)
        order = np.arange(z // 2 + 1)
        w = np.exp(2j * np.pi * order / z)[:, None, None]
        harmonic = np.linalg.inv(
            stiffness[left, left]
            + stiffness[right, right]
            + w * stiffness[left, right]
            + stiffness[right, left] / w
        )
        often = np.where((order == 0) | (2 * order == z), 1.0, 2.0) / z
        lags = np.arange(-MATES - 1, MATES + 2)
        weight = often * w[:, 0, 0] ** lags[:, None]
        by_lag = np.einsum("kn,nst->kst", weight, harmonic).real
        return np.block([[by_lag[1:-1], by_lag[:-2]], [by_lag[2:], by_lag[1:-1]]])

    @property
    def degrees(self) -> int:
        """Number of load cases and of strains."""
        return int(self._solved[1].shape[0])

    def shapes(self, arc: Floats) -> tuple[Integers, Floats]:
        """Nodes (3, point) of the elements at ``arc`` [m] and their shape functions there."""
        element = np.clip(np.searchsorted(self.arcs, arc, "right") - 1, 0, self.rows - 1)
        start = self.arcs[element]
        values, _ = quadratic(2.0 * (arc - start) / (self.arcs[element + 1] - start) - 1.0)
        return 2 * element + np.arange(3)[:, None], values

    def felt(self, weights: Floats) -> Floats:
        """What the sides feel of the load cases ``weights`` (case, degree)."""
        return np.asarray(weights @ self._solved[1])

    def compliance(
        self, first: tuple[Floats, Floats], *, second: tuple[Floats, Floats], lag: int
    ) -> Floats:
        """Work of the loads ``first`` on the motion by ``second``, ``lag`` pitches behind.

        Both (weights, felt).
        """
        out = first[1] @ self._solved[2][lag + MATES] @ second[1].T
        if lag == 0:
            used = np.flatnonzero(np.any(first[0] != 0.0, axis=0))
            loaded = np.flatnonzero(np.any(second[0] != 0.0, axis=0))
            own = self._solved[0][np.ix_(used, loaded)]
            out = out + first[0][:, used] @ own @ second[0][:, loaded].T
        return np.asarray(out)
