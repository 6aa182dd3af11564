"""Friction of the teeth as two functions of the mesh phase, as a drive train feels it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import FrictionSplit
from thermogear.base.pieces import Pieces
from thermogear.gears.deviations import Deviation
from thermogear.gears.pair import GearPair
from thermogear.gears.turn import mean_tooth
from thermogear.mesh.elastic import ElasticPair, LoadedPair, PathShare, elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

DEGREE = 8
"""Degree of the polynomial of every piece."""
LEAST_SHARE, CUT = 2.0**-8, 0.25
"""Width of a piece that is not cut again, as a share of its interval between two borders, and where
a piece is cut, from the end near which it misses [1], chosen: on a piece from d to 4 d what rises
like a power of the distance from a border is met within 3^-9 (its ellipse of Bernstein has 3)."""
GRID = 96
"""Phases between which changes of the carrying pairs are looked for."""
PARTS, ROUNDS = 32, 6
"""Each of so many rounds cuts the place of a change into so many parts: what a phase costs is
mostly the call."""
LEAST_PIECE = 1e-7
"""Distance of borders that are one, in periods."""


class Rubbing(NamedTuple):
    """Tooth friction of one operating point at some phases.

    ``values`` (2, phases): chi_0 [-] and chi_1 [m]. ``carrying`` (phases, pairs): 0 where a pair
    carries nothing, 1 on its flanks, more on a tip corner.
    """

    values: Floats
    carrying: NDArray[np.int64]


def friction_split(
    pair: GearPair,
    operating: Operating,
    model: MeshModel | None = None,
    *,
    deviations: Sequence[Deviation] = (),
    accuracy: float = 1e-4,
) -> tuple[FrictionSplit | None, ...]:
    """chi_0 and chi_1 of every operating point over the mesh phase, 0 where a pair enters at A.

    The sums over all tooth pairs of share, |mu| and position that the mesh cycle has along its
    path, tip corners beyond A and E included where the model's load sharing knows them. Borders of
    pieces: where a pair enters, leaves, or passes the pitch point, and where a corner begins or
    ceases to carry; between them polynomials, cut until they are within ``accuracy`` of the
    greatest value, or the piece is 1/256 of its interval (laws that rise without bound towards the
    pitch point). Where two pieces meet, both are within ``accuracy`` of the value, not the same.
    ``model`` defaults to :meth:`MeshModel.consistent`. Friction of the back flank is not in them.
    Where teeth differ or a gear is eccentric they are those of the mean tooth
    (:func:`~thermogear.gears.turn.mean_tooth`) over one mesh period. None where the loaded contact
    does not settle. Raises InputError at a speed of 0, where the sense of sliding is not known.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> warm = Temperatures.uniform(353.15, reference=293.15)
    >>> point = Operating(
    ...     speed=[100.0], torque=[200.0], lubricant=lubricant("FVA3"), oil_temperature=353.15,
    ...     temperatures=warm, half_backlash=60e-6,
    ... )
    >>> model = MeshModel.consistent().override(friction="dry", sharing="equal")
    >>> (found,) = friction_split(pair, point, model)
    >>> [f"{found.at_pitch(phase):.1f}" for phase in (0.1, 0.9)]
    ['0.0', '0.2']
    """
    if np.any(operating.speed <= 0.0):
        raise InputError(
            "operating.speed",
            "0 rpm",
            allowed="> 0 rpm for friction of the teeth",
            why="the sense of sliding is not known at rest",
        )
    if not 0.0 < accuracy < 1.0:
        raise InputError("accuracy", accuracy, allowed="0 < accuracy < 1")
    chosen = MeshModel.consistent() if model is None else model
    alike = mean_tooth(pair, deviations)
    return tuple(
        _split(elastic_pair(HotPair(pair, operating.point(place), chosen), alike), accuracy)
        for place in range(operating.speed.size)
    )


def rubbing(elastic: ElasticPair, phase: Floats) -> Rubbing | None:
    """chi_0 and chi_1 of the one operating point of ``elastic`` at ``phase``; None: not settled.

    A phase on a border belongs to neither side: ask beside it.
    """
    pair = elastic.pair
    if elastic.hot.model.sharing == "loaded":
        solved = LoadedPair(elastic.hot, elastic.deviations).solve(phase)
        if not np.all(solved.settled):
            return None
        every, share, edge = solved.points.s, solved.share[0], solved.edge[0]
        # beyond the tangent points there is no flank: no candidate carries there
        margin = 1e-3 * pair.base_pitch
        there = (every > margin) & (every < pair.line_of_action - margin)
        carrying = np.where(there & (share > 0.0), 1 + edge, 0)
    else:
        ranks = np.arange(int(np.ceil(pair.contact_ratio)))
        turned = np.asarray(np.mod(phase, 1.0), dtype=np.float64)
        every = np.asarray(pair.path.a + (turned[:, None] + ranks) * pair.base_pitch, np.float64)
        carrying = np.asarray(every < pair.path.e, dtype=np.int64)
        share = edge = None
    on = carrying > 0
    s = every[on]
    shares = None if share is None else PathShare(share[on][None], edge[on][None])
    path = FrictionPath(elastic, s, shares)
    if not np.all(path.settled):
        return None
    beyond = s - pair.path.c
    each = np.zeros((2, *every.shape))
    each[0][on] = (path.share * path.friction)[0] * np.sign(beyond)
    each[1][on] = each[0][on] * beyond
    return Rubbing(each.sum(axis=-1), np.asarray(carrying, dtype=np.int64))


def _split(elastic: ElasticPair, accuracy: float) -> FrictionSplit | None:
    """Pieces of one operating point."""
    pair = elastic.pair
    ends = [(mark - pair.path.a) / pair.base_pitch for mark in (pair.path.c, pair.path.e)]
    pitch, leaving = (float(np.mod(end, 1.0)) for end in ends)
    borders = [0.0, pitch, leaving]
    if elastic.hot.model.sharing == "loaded":
        more = _changes(lambda phase: rubbing(elastic, phase))
        if more is None:
            return None
        borders += more
    kept = [0.0]
    for one in sorted(borders):
        if LEAST_PIECE < one < 1.0 - LEAST_PIECE and one - kept[-1] > LEAST_PIECE:
            kept.append(one)
    made = _fitted(lambda phase: rubbing(elastic, phase), [*kept, 1.0], accuracy)
    if made is None:
        return None
    starts, tables = made
    first, second = (
        Pieces(starts=starts, coefficients=tuple(tuple(row) for row in table)) for table in tables
    )
    return FrictionSplit(at_pitch=first, per_metre=second)


Asked = Callable[[Floats], Rubbing | None]


def _changes(ask: Asked) -> list[float] | None:
    """Phases at which a pair begins or ceases to carry, or changes from flank to corner."""
    grid = np.linspace(LEAST_PIECE, 1.0 - LEAST_PIECE, GRID + 1)
    seen = ask(grid)
    if seen is None:
        return None
    states = seen.carrying
    changed = np.flatnonzero(np.any(states[1:] != states[:-1], axis=1))
    low, high, left = grid[changed], grid[changed + 1], states[changed]
    inner = np.arange(1, PARTS) / PARTS
    for _ in range(ROUNDS if changed.size else 0):
        marks = low[:, None] + (high - low)[:, None] * inner
        found = ask(marks.ravel())
        if found is None:
            return None
        same = np.all(found.carrying.reshape(*marks.shape, -1) == left[:, None], axis=-1)
        part = np.logical_and.accumulate(same, axis=1).sum(axis=1)
        ends = np.column_stack([low, marks, high])
        low, high = (ends[np.arange(part.size), part + side] for side in (0, 1))
    return [float(one) for one in 0.5 * (low + high)]


def _fitted(
    ask: Asked, borders: list[float], accuracy: float
) -> tuple[tuple[float, ...], Floats] | None:
    """Starts of pieces, and both functions' coefficients (2, piece, power) from each start on."""
    nodes = np.polynomial.chebyshev.chebpts1(DEGREE + 1)
    checks = np.cos(np.pi * np.arange(DEGREE + 2) / (DEGREE + 1)) * (1.0 - 1e-6)
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(nodes, DEGREE))
    between = np.polynomial.chebyshev.chebvander(checks, DEGREE)
    open_ = [(a, b, (b - a) * LEAST_SHARE) for a, b in pairwise(borders)]
    done: list[tuple[float, Floats]] = []
    scale = np.zeros(2)
    while open_:
        low, high = (np.array([one[i] for one in open_]) for i in (0, 1))
        half, middle = 0.5 * (high - low)[:, None], 0.5 * (high + low)[:, None]
        found = ask((middle + half * np.r_[nodes, checks]).ravel())
        if found is None or not np.all(np.isfinite(found.values)):
            return None
        values = found.values.reshape(2, low.size, -1)
        scale = np.maximum(scale, np.abs(values).max(axis=(1, 2)))
        fit = values[..., : nodes.size] @ inverse.T
        missed = np.abs(fit @ between.T - values[..., nodes.size :])
        bad = np.any(missed > accuracy * scale[:, None, None], axis=0)
        share = np.where(bad @ checks < 0.0, CUT, 1.0 - CUT)
        cut = []
        for i, (a, b, least) in enumerate(open_):
            if b - a <= least or not np.any(bad[i]):
                done.append((a, np.stack([_powers(row, b - a) for row in fit[:, i]])))
            else:
                at = a + (b - a) * float(share[i])
                cut += [(a, at, least), (at, b, least)]
        open_ = cut
    done.sort(key=lambda one: one[0])
    tables = np.stack([table for _, table in done], axis=1)
    return tuple(a for a, _ in done), tables


def _powers(chebyshev: Floats, width: float) -> Floats:
    """Coefficients of (phase - start)^m of a Chebyshev series over a piece of ``width``."""
    local = np.polynomial.Chebyshev(chebyshev, domain=[0.0, width])
    powers = np.zeros(DEGREE + 1)
    found = local.convert(domain=[0.0, 1.0], kind=np.polynomial.Polynomial, window=[0.0, 1.0])
    powers[: found.coef.size] = found.coef
    return powers
