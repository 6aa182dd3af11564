"""Plane-stress finite elements on curved nine-node quadrilaterals.

Displacements are interpolated by the products of quadratic Lagrange polynomials that map the
element too, and its stiffness is integrated by Gauss's rule of three points each way. Everything
is for unit modulus and unit width. Checked by ``tests/gears/test_tooth_table.py``: rigid motions,
the constant strain of the patch test, and scikit-fem's matrix of the same mesh.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix, csr_matrix

Integers = NDArray[np.int64]


def quadratic(x: Floats) -> tuple[Floats, Floats]:
    """Lagrange polynomials of the nodes -1, 0, 1 at ``x`` and their slopes, each (3, *x.shape).

    >>> values, slopes = quadratic(np.array([0.0]))
    >>> values.ravel().tolist(), slopes.ravel().tolist()
    ([-0.0, 1.0, 0.0], [-0.5, -0.0, 0.5])
    """
    values = np.stack([0.5 * x * (x - 1.0), 1.0 - x * x, 0.5 * x * (x + 1.0)])
    return values, np.stack([x - 0.5, -2.0 * x, x + 0.5])


def _rule() -> tuple[Floats, Floats]:
    """Slopes (2, point, 9) of the nine shape functions along both parameters; weights (point,)."""
    points, weights = np.polynomial.legendre.leggauss(3)
    values, slopes = quadratic(points)
    along = np.einsum("ip,jq->pqij", values, slopes).reshape(9, 9)
    across = np.einsum("ip,jq->pqij", slopes, values).reshape(9, 9)
    return np.stack([along, across]), np.outer(weights, weights).ravel()


_SLOPES, _WEIGHTS = _rule()


@dataclass(frozen=True, eq=False)
class Patch:
    """Nodes and nine-node elements of a plane region.

    ``nodes`` (node, 2) [m]; ``cells`` (element, 3, 3): node numbers, rows along the second
    parameter, columns along the first; corners, mid-sides and centre.
    """

    nodes: Floats
    cells: Integers
    poisson: float

    @property
    def unknowns(self) -> int:
        """Two displacements at each node, numbered 2 node, 2 node + 1."""
        return 2 * int(self.nodes.shape[0])

    def strains(self) -> tuple[Floats, Floats]:
        """Strains (e_x, e_y, 2 e_xy) by the elements' unknowns, and the areas of Gauss's points.

        Shapes (element, point, 3, 18) and (element, point); the 18 unknowns of an element are x
        and y of its nodes in turn. Raises ValueError for an element that is turned inside out.
        """
        corners = self.nodes[self.cells.reshape(-1, 9)]
        frame = np.einsum("aqn,enc->eqac", _SLOPES, corners)
        area = frame[..., 0, 0] * frame[..., 1, 1] - frame[..., 0, 1] * frame[..., 1, 0]
        if not np.all(area * np.sign(area[0, 0]) > 0.0):
            raise ValueError("an element is turned inside out")
        # the inverse of the 2 x 2 frame, written out
        inverse = np.empty_like(frame)
        inverse[..., 0, 0], inverse[..., 1, 1] = frame[..., 1, 1], frame[..., 0, 0]
        inverse[..., 0, 1], inverse[..., 1, 0] = -frame[..., 0, 1], -frame[..., 1, 0]
        slopes = np.einsum("eqca,aqn->eqcn", inverse / area[..., None, None], _SLOPES)
        strain = np.zeros((*area.shape, 3, 18))
        strain[..., 0, 0::2] = strain[..., 2, 1::2] = slopes[..., 0, :]
        strain[..., 1, 1::2] = strain[..., 2, 0::2] = slopes[..., 1, :]
        return strain, np.abs(area) * _WEIGHTS

    def stiffness(self) -> csc_matrix:
        """Stiffness matrix of unit modulus and width, plane stress.

        sum over elements of the integral of B^T D B, with D = 1/(1 - nu^2) [[1, nu, 0],
        [nu, 1, 0], [0, 0, (1 - nu)/2]].
        """
        from scipy.sparse import coo_matrix

        nu = self.poisson
        law = np.array([[1.0, nu, 0.0], [nu, 1.0, 0.0], [0.0, 0.0, 0.5 * (1.0 - nu)]])
        strain, area = self.strains()
        stress = np.matmul(law / (1.0 - nu * nu), strain * area[..., None, None])
        count = len(self.cells)
        parts = np.matmul(
            strain.reshape(count, -1, 18).transpose(0, 2, 1), stress.reshape(count, -1, 18)
        )
        places = (2 * self.cells.reshape(-1, 9, 1) + np.arange(2)).reshape(-1, 18)
        rows, columns = np.broadcast_arrays(places[:, :, None], places[:, None, :])
        return coo_matrix(
            (parts.ravel(), (rows.ravel(), columns.ravel())), shape=(self.unknowns,) * 2
        ).tocsc()

    def edge_strains(self, edge: Integers) -> tuple[csr_matrix, Floats]:
        """Strain along the boundary ``edge``, its nodes in order, by the displacements.

        e_t = x' . u'/|x'|^2 at the two points of Gauss's rule of each side, where the slopes of a
        quadratic interpolation err least (Barlow 1976). Returns the matrix (point, unknown) and the
        tangents x' (point, 2). On an edge without load E e_t is the whole stress there.
        """
        from scipy.sparse import csr_matrix

        sides = np.stack([edge[:-2:2], edge[1:-1:2], edge[2::2]], axis=1)
        _, slope = quadratic(np.polynomial.legendre.leggauss(2)[0])
        along = np.einsum("kq,skc->sqc", slope, self.nodes[sides])
        parts = np.einsum("kq,sqc->sqkc", slope, along / np.sum(along**2, axis=-1, keepdims=True))
        unknowns = 2 * sides[:, None, :, None] + np.arange(2)
        rows = np.arange(2 * len(sides)).reshape(-1, 2, 1, 1)
        places = [np.broadcast_to(n, parts.shape).ravel() for n in (rows, unknowns)]
        strain = csr_matrix((parts.ravel(), places), shape=(2 * len(sides), self.unknowns))
        return strain, along.reshape(-1, 2)
