"""Compiled kernel: forces of the tooth pairs that carry one load, for many positions at once.

Minimises the elastic energy of the mesh over F_j >= 0 with sum F_j = F_n: the conditions are

    sum_k C_jk F_k + delta_H(F_j) + e_j = delta   where F_j > 0,
    sum_k C_jk F_k + e_j >= delta                 where F_j = 0

(or, for a prescribed delta, over F_j >= 0 alone, with the same conditions). The approach
delta_H(F) rises with F whatever the law. Pairs enter one by one where they would overlap and
leave where Newton's step would pull (Lawson and Hanson's scheme); the energy is convex, so
the answer is unique and does not depend on the order. Each test is worded so that a NaN fails
it: nothing settles that is not a number.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.kernel_cache import compiled

MOST_STEPS = 200
_TOLERANCE = 1e-12
NOUGHT: Any = np.int64(0)  # a plain 0 would have numba compile what takes it for itself


@compiled
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


@compiled
def _approach(force: float, first: float, second: float, law: Floats) -> tuple[float, float]:
    """delta_H [m] at ``force`` > 0 and its slope [m/N]; ``first``, ``second``: (h_i/a)^2 F [N].

    ``law``: factors of both gears' logarithmic approach, their nu/(1 - nu), K of K F^0.9 and a
    constant compliance.
    """
    mean, slope = law[5], law[5]
    if law[4] != 0.0:
        tenth = law[4] * force**-0.1
        mean += tenth
        slope += 0.9 * tenth
    for i in range(2):
        if law[i] != 0.0:
            eta = np.sqrt((first if i == 0 else second) / force)
            root = np.sqrt(1.0 + eta * eta)
            narrow = 1.0 / (root + eta)
            # asinh(eta)
            bracket = np.log(eta + root) - law[2 + i] * eta * narrow
            mean += law[i] * bracket
            # eta falls with the root of the force
            slope += law[i] * (bracket - 0.5 * eta * (1.0 - law[2 + i] * narrow * narrow) / root)
    return force * mean, slope


@compiled
def _unsettled(force: Floats) -> tuple[float, float, bool]:
    """What a position gives that has no answer."""
    force[:] = np.nan
    return np.nan, np.nan, False


@compiled
def _share_one(
    asked: float,
    by_load: bool,
    gap: Floats,
    compliance: Floats,
    reach: Floats,
    law: Floats,
    force: Floats,
) -> tuple[float, float, bool]:
    """Forces of one position into ``force``; returns (delta, tangent stiffness, settled).

    ``asked`` is the load F_n > 0, or delta where ``by_load`` is false; ``reach`` [2, pair] and
    ``law`` as :func:`_approach` takes them. ``force`` holds forces to begin with, whose sum is the
    load, or nothing above 0: then the nearest pair begins alone. A gap of inf never closes. nan
    everywhere and not settled where a gap is nan or the steps find no balance of finite numbers.
    """
    count = gap.size
    index = np.empty(count, dtype=np.int64)
    room = np.empty((count, count + 2))
    matrix, right = room[:, 2:], room[:, :2]
    first = 0
    for j in range(count):
        if np.isnan(gap[j]):
            return _unsettled(force)
        if gap[j] < gap[first]:
            first = j
    # gaps are counted from the nearest pair, before anything is added to them: a common shift
    # would round the balance at its own size
    origin = gap[first]
    load, delta, stiffness = asked, 0.0, 0.0
    if not by_load:
        delta = asked - origin
        if delta <= 0.0:
            return asked, 0.0, True
        # a first guess, and the scale of the tolerances
        load = delta / compliance[first, first]
        contact, _ = _approach(load, reach[0, first], reach[1, first], law)
        load = delta / (compliance[first, first] + contact / load)
    least = 1e-14 * load
    carried = 0.0
    for j in range(count):
        # a pair carries where its force is not 0
        if not (by_load and force[j] > least and gap[j] < np.inf):
            force[j] = 0.0
        carried += force[j]
    if carried == 0.0:
        force[first] = load
    for _ in range(MOST_STEPS):
        size = NOUGHT
        for j in range(count):
            if force[j] != 0.0:  # or no number
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
            contact, slope = _approach(f, reach[0, j], reach[1, j], law)
            matrix[a, a] += slope
            compliant = max(compliant, matrix[a, a])
            right[a, 0] = delta - (body + contact + (gap[j] - origin))
            right[a, 1] = 1.0
        _solve_spd(matrix, size, right)
        stiffness, slack = 0.0, load - total
        for a in range(size):
            stiffness += right[a, 1]
            slack -= right[a, 0]
        advance = slack / stiffness if by_load else 0.0
        step, leaving, at_rest = 1.0, -1, True
        for a in range(size):
            j = index[a]
            right[a, 0] += advance * right[a, 1]
            at_rest = at_rest and abs(right[a, 0]) <= _TOLERANCE * load
            if force[j] + right[a, 0] < least:
                part = (force[j] - least) / -right[a, 0]
                if part < step:
                    step, leaving = part, j
        delta += step * advance
        for a in range(size):
            force[index[a]] += step * right[a, 0]
        if leaving >= 0:
            force[leaving] = 0.0
            continue
        if not at_rest:
            continue
        # settled on these pairs: does one of the others overlap?
        worst, entering = _TOLERANCE * load * compliant, -1
        for j in range(count):
            if force[j] == 0.0 and gap[j] < np.inf:
                overlap = delta - (gap[j] - origin)
                for a in range(size):
                    overlap -= compliance[j, index[a]] * force[index[a]]
                if not overlap <= worst:
                    worst, entering = overlap, j
        if entering < 0:
            return delta + origin, stiffness, True
        # enough to give the contact a finite slope, too little to matter
        force[entering] = min(1e-3 * load, 0.5 * worst / compliant)
    return _unsettled(force)


@compiled
def share_many(
    asked: Floats,
    by_load: bool,
    gap: Floats,
    tooth: Floats,
    body: Floats,
    depth: Floats,
    tooth_softness: Floats,
    body_softness: Floats,
    flattening: Floats,
    law: Floats,
    force: Floats,
    delta: Floats,
    stiffness: Floats,
    settled: NDArray[np.bool_],
) -> None:
    """All cases x positions into ``force``, ``delta``, ``stiffness``, ``settled``.

    asked [case]: loads, or deflections where ``by_load`` is false; gap [case or 1, position,
    pair]; tooth [2, position, pair] and body [2, position, pair, pair]: compliances of both
    gears for unit modulus and width; depth [2, position, pair]: h_i^2/(4 rho*) [m];
    tooth_softness, body_softness [case, 2]: 1/(E b); flattening [case]: pi b E* [N/m], so that
    their product is (h_i/a)^2 F; law [case, 6]: see :func:`_approach`.
    """
    cases, positions, count = force.shape
    compliance = np.empty((count, count))
    reach = np.empty((2, count))
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
                reach[0, j] = depth[0, p, j] * flattening[c]
                reach[1, j] = depth[1, p, j] * flattening[c]
                # from the positions before: forces change slowly along the path
                before = force[c, p - 1, j] if p > 0 else 0.0
                gained = before - force[c, p - 2, j] if p > 1 else 0.0
                force[c, p, j] = max(before + gained, 0.0) if before > 0.0 else 0.0
            delta[c, p], stiffness[c, p], settled[c, p] = _share_one(
                asked[c],
                by_load,
                gap[own, p],
                compliance,
                reach,
                law[c],
                force[c, p],
            )
