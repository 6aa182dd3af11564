"""Compiled kernel: forces of the tooth pairs that carry one load, for many positions at once.

Minimises the elastic energy of the mesh over F_j >= 0 with sum F_j = F_n: the conditions are

    sum_k C_jk F_k + delta_H(F_j) + e_j = delta   where F_j > 0,
    sum_k C_jk F_k + e_j >= delta                 where F_j = 0

(or, for a prescribed delta, over F_j >= 0 alone, with the same conditions),
delta_H(F) = F (A_j - C ln F) + K F^0.9. Pairs enter one by one where they would overlap and
leave where Newton's step would pull (Lawson and Hanson's scheme); the energy is convex, so
the answer is unique and does not depend on the order.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar, cast

import numba
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Function = TypeVar("Function", bound=Callable[..., object])

MOST_STEPS = 200
_TOLERANCE = 1e-12


def _compiled(function: Function) -> Function:
    """numba's decorator with a type; no fast math, so that results do not depend on the lane."""
    return cast(Function, numba.njit(cache=True)(function))


@_compiled
def _solve_spd(matrix: Floats, size: int, right: Floats) -> None:
    """Overwrite the two columns of ``right`` by matrix^-1 right (Cholesky, in place)."""
    for i in range(size):
        for j in range(i + 1):
            total = matrix[i, j]
            for k in range(j):
                total -= matrix[i, k] * matrix[j, k]
            if i == j:
                matrix[i, i] = np.sqrt(total)
            else:
                matrix[i, j] = total / matrix[j, j]
    for column in range(2):
        for i in range(size):
            total = right[i, column]
            for k in range(i):
                total -= matrix[i, k] * right[k, column]
            right[i, column] = total / matrix[i, i]
        for i in range(size - 1, -1, -1):
            total = right[i, column]
            for k in range(i + 1, size):
                total -= matrix[k, i] * right[k, column]
            right[i, column] = total / matrix[i, i]


@_compiled
def _share_one(
    asked: float,
    by_load: bool,
    gap: Floats,
    compliance: Floats,
    linear: Floats,
    logarithm: float,
    power: float,
    force: Floats,
) -> tuple[float, float, bool]:
    """Forces of one position into ``force``; returns (delta, tangent stiffness, settled).

    ``asked`` is the load F_n > 0, or delta where ``by_load`` is false.
    """
    count = gap.size
    force[:] = 0.0
    active = np.zeros(count, dtype=np.bool_)
    index = np.empty(count, dtype=np.int64)
    matrix = np.empty((count, count))
    right = np.empty((count, 2))
    first = 0
    for j in range(1, count):
        if gap[j] < gap[first]:
            first = j
    # gaps are counted from the nearest pair: a common shift changes no bit of the forces
    origin = gap[first]
    load, delta, stiffness = asked, 0.0, 0.0
    if not by_load:
        delta = asked - origin
        if not delta > 0.0:
            return asked, 0.0, True
        # a first guess, and the scale of the tolerances
        load = delta / (compliance[first, first] + abs(linear[first]))
    active[first] = True
    force[first] = load
    least = 1e-14 * load
    for _ in range(MOST_STEPS):
        size = 0
        for j in range(count):
            if active[j]:
                index[size] = j
                size += 1
        total, compliant = 0.0, 0.0
        for a in range(size):
            j = index[a]
            f = force[j]
            total += f
            body = 0.0
            for b in range(size):
                k = index[b]
                body += compliance[j, k] * force[k]
                matrix[a, b] = compliance[j, k]
            log_f = np.log(f)
            tenth = f**-0.1
            matrix[a, a] += linear[j] - logarithm * (log_f + 1.0) + 0.9 * power * tenth
            compliant = max(compliant, matrix[a, a])
            contact = f * (linear[j] - logarithm * log_f + power * tenth)
            right[a, 0] = delta - (body + contact + gap[j] - origin)
            right[a, 1] = 1.0
        _solve_spd(matrix, size, right)
        stiffness, slack = 0.0, load - total
        for a in range(size):
            stiffness += right[a, 1]
            slack -= right[a, 0]
        advance = slack / stiffness if by_load else 0.0
        step, leaving, largest = 1.0, -1, 0.0
        for a in range(size):
            j = index[a]
            right[a, 0] += advance * right[a, 1]
            largest = max(largest, abs(right[a, 0]))
            if force[j] + right[a, 0] < least:
                part = (force[j] - least) / -right[a, 0]
                if part < step:
                    step, leaving = part, j
        delta += step * advance
        for a in range(size):
            force[index[a]] += step * right[a, 0]
        if leaving >= 0:
            active[leaving] = False
            force[leaving] = 0.0
            continue
        if largest > _TOLERANCE * load:
            continue
        # settled on these pairs: does one of the others overlap?
        worst, entering = _TOLERANCE * load * compliant, -1
        for j in range(count):
            if not active[j] and np.isfinite(gap[j]):
                overlap = delta - (gap[j] - origin)
                for a in range(size):
                    overlap -= compliance[j, index[a]] * force[index[a]]
                if overlap > worst:
                    worst, entering = overlap, j
        if entering < 0:
            return delta + origin, stiffness, True
        active[entering] = True
        # enough to give the contact a finite slope, too little to matter
        force[entering] = min(1e-3 * load, 0.5 * worst / compliant)
    return np.nan, np.nan, False


@_compiled
def share_many(
    asked: Floats,
    by_load: bool,
    gap: Floats,
    tooth: Floats,
    body: Floats,
    depth: Floats,
    curvature: Floats,
    tooth_softness: Floats,
    body_softness: Floats,
    contact: Floats,
    force: Floats,
    delta: Floats,
    stiffness: Floats,
    settled: NDArray[np.bool_],
) -> None:
    """All cases x positions into ``force``, ``delta``, ``stiffness``, ``settled``.

    asked [case]: loads, or deflections where ``by_load`` is false; gap [case or 1, position,
    pair]; tooth [2, position, pair] and body [2, position, pair, pair]: compliances of both
    gears for unit modulus and width; depth [2, position, pair]: ln(2 h_i) - nu/(2 (1 - nu));
    curvature [position, pair]: ln(4 rho*); tooth_softness, body_softness [case, 2]: 1/(E b);
    contact [case, 6]: factors of the two depths, C, ln(pi b E*), K, and a constant compliance.
    """
    cases, positions, count = force.shape
    compliance = np.empty((count, count))
    linear = np.empty(count)
    for c in range(cases):
        own = c if gap.shape[0] > 1 else 0
        for p in range(positions):
            for j in range(count):
                for k in range(count):
                    compliance[j, k] = (
                        body[0, p, j, k] * body_softness[c, 0]
                        + body[1, p, j, k] * body_softness[c, 1]
                    )
                compliance[j, j] += (
                    tooth[0, p, j] * tooth_softness[c, 0] + tooth[1, p, j] * tooth_softness[c, 1]
                )
                linear[j] = (
                    depth[0, p, j] * contact[c, 0]
                    + depth[1, p, j] * contact[c, 1]
                    - contact[c, 2] * (curvature[p, j] - contact[c, 3])
                    + contact[c, 5]
                )
            delta[c, p], stiffness[c, p], settled[c, p] = _share_one(
                asked[c],
                by_load,
                gap[own, p],
                compliance,
                linear,
                contact[c, 2],
                contact[c, 4],
                force[c, p],
            )
