"""Compiled kernel: forces of the tooth pairs that carry one load, for many positions at once.

Minimises the elastic energy of the mesh over F_j >= 0 with sum F_j = F_n: the conditions are

    sum_k C_jk F_k + delta_H(F_j) + e_j = delta   where F_j > 0,
    sum_k C_jk F_k + e_j >= delta                 where F_j = 0

(or, for a prescribed delta, over F_j >= 0 alone, with the same conditions). The approach
delta_H(F) rises with F whatever the law: on a tip edge too, where the contact widens in proportion
to F at most. Pairs enter one by one where they would overlap and
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
from thermogear.gears.corner import FREE, TILTED

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
def _half_width(
    wide: float, radius: float, edge_radius: float, angle: float, distance: float
) -> tuple[float, float]:
    """Half width b [m] of a pair's contact and d ln b/d ln F at ``wide`` = 4 F/(pi b E*) [m].

    With a = sqrt(wide rho*) of the involutes, a_e = sqrt(wide r*) of the edge circle on its mate,
    l = wide/theta of a punch tilted by theta and d the distance along the flank to its end,

        b = a - (a - b_0)(1 - d/a)^2,   b_0 = a_e + w/2 <= a,   1/w = 1/(0.65 l) + 1/(0.6 a).

    On the path theta = 0: at the end of a sharp tip b = 0.3 a, and a from d = a on, without a kink
    in the stiffness; on an edge d = 0.
    Source: a and a_e Johnson, eq. 4.43; l the contact of a flat punch on its edge, whose pressure
    (E* theta/2) sqrt((l - x)/x) carries F/b = pi E* theta l/4; the factors 0.65 and 0.6 [-]
    measured here against plane finite elements, whose contacts on corners are as wide as w within
    25 %.
    """
    whole = np.sqrt(wide * radius)
    if distance >= whole:
        return whole, 0.5
    edge = np.sqrt(wide * edge_radius)
    tilted, free = angle / (TILTED * wide), 1.0 / (FREE * whole)
    punch = 1.0 / (tilted + free)
    lost = whole - edge - 0.5 * punch
    if lost <= 0.0:
        return whole, 0.5
    part = 1.0 - distance / whole
    half = whole - lost * part * part
    # 2 d/d ln F, of a alone times a: d/a falls as a rises
    lost_rate = whole - edge - punch * punch * (tilted + 0.5 * free)
    rate = whole - lost_rate * part * part - 2.0 * lost * part * (1.0 - part)
    return half, 0.5 * rate / half


@compiled
def _approach(
    force: float, soft: float, places: Floats, j: int, law: Floats
) -> tuple[float, float]:
    """delta_H/lever [m] at lever x F = ``force`` > 0, and its slope [m/N].

    ``soft`` 4/(pi b E*) [m/N]; ``places`` [j]: depths h_1 and h_2, rho*, r* [m], theta [rad], d [m]
    (see :func:`_half_width`), lever; ``law``: factors of both gears' logarithmic approach, their
    nu/(1 - nu), K of K F^0.9 and a constant compliance.
    """
    lever = places[j, 6]
    pressed = force / lever
    mean, slope = law[5], law[5]
    if law[4] != 0.0:
        tenth = law[4] * pressed**-0.1
        mean += tenth
        slope += 0.9 * tenth
    if law[0] != 0.0:
        half, power = _half_width(
            soft * pressed, places[j, 2], places[j, 3], places[j, 4], places[j, 5]
        )
        for i in range(2):
            eta = places[j, i] / half
            root = np.sqrt(1.0 + eta * eta)
            narrow = 1.0 / (root + eta)
            # asinh(eta)
            bracket = np.log(eta + root) - law[2 + i] * eta * narrow
            mean += law[i] * bracket
            # eta falls as the half width rises
            slope += law[i] * (bracket - power * eta * (1.0 - law[2 + i] * narrow * narrow) / root)
    return pressed * mean / lever, slope / (lever * lever)


@compiled
def _unsettled(force: Floats) -> tuple[float, float, bool]:
    """What a position gives that has no answer."""
    force[:] = np.nan
    return np.nan, np.nan, False


@compiled
def _share_one(
    load: float,
    gap: Floats,
    compliance: Floats,
    soft: float,
    places: Floats,
    law: Floats,
    force: Floats,
) -> tuple[float, float, bool]:
    """Forces of one position into ``force``; returns (delta, tangent stiffness, settled).

    ``load`` F_n > 0; ``soft``, ``places``
    [pair, 7] and ``law`` as :func:`_approach` takes them. ``force`` holds forces to begin with,
    whose sum is the load, or nothing above 0: then the nearest pair begins alone. A gap of inf
    never closes. nan everywhere and not settled where a gap is nan or the steps find no balance of
    finite numbers.
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
    delta, stiffness = 0.0, 0.0
    least = 1e-14 * load
    carried = 0.0
    for j in range(count):
        # a pair carries where its force is not 0
        if not (force[j] > least and gap[j] < np.inf):
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
            contact, slope = _approach(f, soft, places, j, law)
            matrix[a, a] += slope
            compliant = max(compliant, matrix[a, a])
            right[a, 0] = delta - (body + contact + (gap[j] - origin))
            right[a, 1] = 1.0
        _solve_spd(matrix, size, right)
        stiffness, slack = 0.0, load - total
        for a in range(size):
            stiffness += right[a, 1]
            slack -= right[a, 0]
        advance = slack / stiffness
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
    loads: Floats,
    gap: Floats,
    tooth: Floats,
    body: Floats,
    places: Floats,
    place: NDArray[np.int64],
    tooth_softness: Floats,
    body_softness: Floats,
    softness: Floats,
    law: Floats,
    force: Floats,
    delta: Floats,
    stiffness: Floats,
    settled: NDArray[np.bool_],
) -> None:
    """All cases x positions into ``force``, ``delta``, ``stiffness``, ``settled``.

    loads [case] F_n > 0; gap [case or 1, position,
    pair]; tooth [2, place, pair] and body [2, place, pair, pair]: compliances of both gears for
    unit modulus and width; places [place, pair, 7], softness [case]: 4/(pi b E*), law [case, 6]:
    see :func:`_approach`; place [position]: that of each position, the same in all mesh periods;
    tooth_softness, body_softness [case, 2]: 1/(E b).
    A pair whose force F has the lever lambda enters with compliances over lambda_j lambda_k, so
    that ``force`` is its part lambda F of the load, and gap and delta are advances of the pinion.
    """
    cases, positions, count = force.shape
    compliance = np.empty((count, count))
    for c in range(cases):
        own = c if gap.shape[0] > 1 else 0
        for p in range(positions):
            at = place[p]
            for j in range(count):
                for k in range(count):
                    compliance[j, k] = (
                        body[0, at, j, k] * body_softness[c, 0]
                        + body[1, at, j, k] * body_softness[c, 1]
                    )
                compliance[j, j] += (
                    tooth[0, at, j] * tooth_softness[c, 0] + tooth[1, at, j] * tooth_softness[c, 1]
                )
                # from the positions before: forces change slowly along the path
                before = force[c, p - 1, j] if p > 0 else 0.0
                gained = before - force[c, p - 2, j] if p > 1 else 0.0
                force[c, p, j] = max(before + gained, 0.0) if before > 0.0 else 0.0
            delta[c, p], stiffness[c, p], settled[c, p] = _share_one(
                loads[c],
                gap[own, p],
                compliance,
                softness[c],
                places[at],
                law[c],
                force[c, p],
            )
