"""Plane-stress finite elements on curved nine-node quadrilaterals, by scikit-fem.

Everything is for unit modulus and unit width; compliances are divided by E b afterwards.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
import skfem
from scipy.sparse import csc_matrix
from skfem import helpers

from thermogear.base.arrays import Floats
from thermogear.gears.elements import Integers, Patch


class ReferencePatch(Patch):
    """A plane region whose matrices scikit-fem assembles."""

    @classmethod
    def of(cls, patch: Patch) -> ReferencePatch:
        """The same nodes and elements."""
        return cls(patch.nodes, patch.cells, patch.poisson)

    @cached_property
    def _mesh(self) -> Any:
        corners = self.cells[:, [0, 0, 2, 2], [0, 2, 2, 0]]
        used, flat = np.unique(corners, return_inverse=True)
        linear = skfem.MeshQuad(self.nodes[used].T.copy(), flat.reshape(corners.shape).T.copy())
        mesh = skfem.MeshQuad2.from_mesh(linear)
        places = np.array(mesh.doflocs)
        for local, column in enumerate(self._local_order().T):
            places[:, mesh.dofs.element_dofs[local]] = self.nodes[column].T
        return replace(mesh, doflocs=places)

    def _local_order(self) -> Integers:
        """Node numbers (element, 9) in the library's order: corners, sides, centre."""
        corner = {0: (0, 0), 1: (0, 2), 2: (2, 2), 3: (2, 0)}
        sides = [
            ((corner[a][0] + corner[b][0]) // 2, (corner[a][1] + corner[b][1]) // 2)
            for a, b in skfem.MeshQuad.elem.refdom.facets
        ]
        rows, columns = zip(*corner.values(), *sides, (1, 1), strict=True)
        return np.asarray(self.cells[:, rows, columns])

    @cached_property
    def _basis(self) -> Any:
        return skfem.Basis(self._mesh, skfem.ElementVector(skfem.ElementQuad2()), intorder=4)

    @cached_property
    def _places(self) -> Integers:
        """Library's numbers of the two displacements of each node, (node, 2)."""
        out = np.full((self.nodes.shape[0], 2), -1, dtype=np.int64)
        ours = self._local_order()
        theirs = self._basis.element_dofs.reshape(9, 2, -1)
        for local in range(9):
            out[ours[:, local]] = theirs[local].T
        return out

    def _ours(self, vector: Floats) -> Floats:
        return np.asarray(vector[self._places.ravel()])

    def stiffness(self, strained: tuple[float, float, float] | None = None) -> csc_matrix:
        """Stiffness matrix of unit modulus and width, plane stress.

        ``strained`` (x, y, radius) [m]: a disc that stands in plane strain instead.
        """
        nu = self.poisson
        stress, shear = nu / (1.0 - nu**2), 0.5 / (1.0 + nu)
        strain = nu / ((1.0 + nu) * (1.0 - 2.0 * nu))
        x, y, radius = (0.0, 0.0, -1.0) if strained is None else strained

        at = self._basis.global_coordinates()
        first = np.where(np.hypot(at[0] - x, at[1] - y) < radius, strain, stress)
        # every field of an element meets every other: what is one's own is worked out once
        fields = {id(one[0]): helpers.sym_grad(one[0]) for one in self._basis.basis}
        traces = {key: helpers.trace(one) for key, one in fields.items()}
        parts = {key: first * one for key, one in traces.items()}

        def energy(u: Any, v: Any, w: Any) -> Any:
            one, other = id(u), id(v)
            shape = helpers.ddot(fields[one], fields[other])
            return parts[one] * traces[other] + 2.0 * shear * shape

        theirs = skfem.BilinearForm(energy).assemble(self._basis).tocsr()
        order = self._places.ravel()
        return csc_matrix(theirs[order][:, order])
