"""A whole gear from condensed sectors: every tooth and gap, at the price of a few.

A sector's stiffness is reduced to the edges it shares with others; sectors that carry no load
are all alike and are joined by doubling. What remains is a small matrix at the joints of the
teeth that may carry load.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.sparse.linalg import splu

from thermogear.verify.elements import Floats, Integers, Patch
from thermogear.verify.tooth_mesh import Foot, Tooth


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
        whole = patch.stiffness(strained)
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
