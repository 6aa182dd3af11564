"""Steps of a drive train with local contacts: exponential collocation with located events.

In a step every force f is the polynomial through s Gauss nodes: the modes are then exact, and the
outputs at the nodes y_i = g_i + sum_j W_ij f_j are solved for. Flanks are linear in y within a step
and solved directly, bearings by sweeps.

Within a step every contact keeps its state, its linear law continued beyond the border; where its
gap changes sign the step ends, at the root, and the next begins there with the contact changed.
Steps h, h/2, h/4 ... have tables. The residual of the collocation at the end of a step is the first
Legendre coefficient that the polynomial lacks, so that the error is known mode by mode; a step with
too much of it is taken again on the next rung.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Whole
from thermogear.dynamics.kernels.calculus import flows, gather
from thermogear.dynamics.kernels.compiled import kernel, part
from thermogear.dynamics.kernels.drive import (
    BASE,
    BEARINGS,
    FELT,
    FREQUENCY,
    FRICTION,
    INPUTS,
    METRE,
    MODES,
    NODES,
    OUTPUTS,
    PITCH,
    RAMP,
    ROUGH,
    SPAN,
    STIFFNESS,
    SWEEP,
    TOLERANCE,
    TURN,
    WIDE,
    Train,
    bearing_force,
    excite,
    flank_forces,
    outer_force,
    outputs_of,
    phase_at,
)
from thermogear.dynamics.kernels.vector import EIGHT

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

STEPS, REJECTED, EVENTS, SWEEPS, LOSSES, IMPACTS, LIFTS, FORCED = range(8)
"""Places in ``Work.counts``: LOSSES of the drive flank, IMPACTS closings of the back flank, LIFTS
of bearings, FORCED steps taken on the last rung with an error above the allowed one."""
MOST_SWEEPS = 40
HUGE = 1e300
UNSEEN = 0.03
"""Share of the error beside a cut that a step with a border within it is held against."""


class Ladder(NamedTuple):
    """Tables of the steps.

    ``nodes`` c_i and the Lagrange polynomials' ``powers`` (power, node), values ``at_end`` and
    barycentric ``weights`` over ``places`` = (0, c_i, 1); ``legendre`` the powers of P_s; all over
    the share of a step. ``lengths`` (rung) [s]; flat: ``reach`` (rung, 2 modes, wide): y (node,
    output) at the nodes from the state; ``couple`` (rung, input node, wide): from the forces;
    ``decay`` (rung, 2 modes) and ``push`` (rung, input node, span): the state at the end; ``miss``
    (rung, inputs): error of the outputs [m] per unit of the coefficient of P_s of a force. A force
    has its nodes side by side, an output its node's outputs. Within a step the forces are the
    polynomials through start, nodes and end, of powers ``wider``, which lack P_(s+1) and more:
    ``miss_within``. One rung more than there are steps is for one of any length. ``graded``:
    shares and weights of a rule over (0, 1) whose places crowd at 0.
    """

    nodes: Real
    powers: Real
    factorial: Real
    legendre: Real
    at_end: Real
    places: Real
    weights: Real
    lengths: Real
    reach: Real
    couple: Real
    decay: Real
    push: Real
    miss: Real
    wider: Real
    miss_within: Real
    graded: Real


class Work(NamedTuple):
    """Room to work in, and what is counted."""

    counts: Whole
    spent: Real
    closed: Whole
    held: Whole
    phi: Complex
    weight: Complex
    base: Real
    y: Real
    before: Real
    ends: Real
    force: Real
    end_force: Real
    shape: Real
    values: Real
    matrix: Real
    gaps: Real
    added: Real
    kept: Real
    pace: Real
    start_force: Real
    lacking: Real
    trial: Real
    full: Real
    right: Real
    pushed: Real
    slope: Real
    sample: Real
    journal_x: Real
    journal_y: Real
    pieces: Real
    moments: Real
    local: Real


@kernel
def fill(train: Train, ladder: Ladder, work: Work, rung: int, h: float) -> None:
    """Tables of a step of length ``h`` [s] as rung ``rung``."""
    sizes, lam, into, out = train.sizes, train.lam, train.into, train.out
    modes, nodes, outputs, inputs = sizes[MODES], sizes[NODES], sizes[OUTPUTS], sizes[INPUTS]
    wide, span, felt = sizes[WIDE], sizes[SPAN], sizes[FELT]
    factorial, powers, phi, weight = ladder.factorial, ladder.powers, work.phi, work.weight
    ladder.lengths[rung] = h
    rows = nodes * inputs
    for j in range(rows * wide):
        ladder.couple[rung * rows * wide + j] = 0.0
    for c in range(inputs):
        ladder.miss[rung * inputs + c] = 0.0
        ladder.miss_within[rung * inputs + c] = 0.0
    for k in range(modes):
        largest = 0.0
        real_row, imaginary_row = 2 * k * felt, (2 * k + 1) * felt
        for o in range(outputs):
            a, b = out[real_row + o], out[imaginary_row + o]
            largest = max(largest, math.sqrt(a * a + b * b))
        for i in range(nodes):
            share = ladder.nodes[i]
            flows(lam[k] * (share * h), nodes, factorial, phi)
            for o in range(outputs):
                a, b = out[real_row + o], out[imaginary_row + o]
                at = (rung * 2 * modes + 2 * k) * wide + i * outputs + o
                ladder.reach[at] = a * phi[0].real + b * phi[0].imag
                ladder.reach[at + wide] = b * phi[0].real - a * phi[0].imag
            for j in range(nodes):
                total = 0.0j
                scale = h
                for q in range(nodes):
                    scale *= share
                    total += scale * factorial[q] * powers[q, j] * phi[q + 1]
                weight[j] = total
            for c in range(inputs):
                for j in range(nodes):
                    pushed = weight[j] * into[k, c]
                    at = (rung * rows + c * nodes + j) * wide + i * outputs
                    for o in range(outputs):
                        ladder.couple[at + o] += (
                            out[real_row + o] * pushed.real + out[imaginary_row + o] * pushed.imag
                        )
        flows(lam[k] * h, nodes + 1, factorial, phi)
        ladder.decay[(rung * modes + k) * 2] = phi[0].real
        ladder.decay[(rung * modes + k) * 2 + 1] = phi[0].imag
        for j in range(nodes):
            total = 0.0j
            for q in range(nodes):
                total += h * factorial[q] * powers[q, j] * phi[q + 1]
            for c in range(inputs):
                pushed = total * into[k, c]
                at = (rung * rows + c * nodes + j) * span + 2 * k
                ladder.push[at] = pushed.real
                ladder.push[at + 1] = pushed.imag
        lacking = 0.0j
        for q in range(nodes + 1):
            lacking += h * factorial[q] * ladder.legendre[q] * phi[q + 1]
        # beside a cut P_(s+1) is not integrated away: |int P_n| <= 1/(2 n) over the share
        slack = h / (2.0 * nodes + 2.0) / max(1.0, abs(lam[k]) * h)
        for c in range(inputs):
            size = abs(into[k, c]) * largest
            ladder.miss[rung * inputs + c] += abs(lacking) * size
            ladder.miss_within[rung * inputs + c] += slack * size


@part
def coefficients(train: Train, ladder: Ladder, work: Work, first: int, last: int) -> None:
    """Powers over the share of a step, (row, power), of the forces ``first`` to ``last``."""
    nodes, wider, force = train.sizes[NODES], ladder.wider, work.force
    order = nodes + 2
    for row in range(first, last):
        start, end = work.start_force[row], work.end_force[row]
        for q in range(order):
            total = wider[q * order] * start + wider[q * order + order - 1] * end
            for j in range(nodes):
                total += wider[q * order + 1 + j] * force[row * nodes + j]
            work.shape[row * order + q] = total


@part
def within(
    train: Train, ladder: Ladder, work: Work, share: float, h: float, state: Real, found: Real
) -> None:
    """The state at ``share`` of the step: exact for the forces' polynomials ``work.shape``."""
    sizes, into, phi = train.sizes, train.into, work.phi
    order = sizes[NODES] + 2
    for k in range(sizes[MODES]):
        flows(train.lam[k] * (share * h), order, ladder.factorial, phi)
        scale = h
        for q in range(order):
            scale *= share
            phi[q + 1] *= scale * ladder.factorial[q]
        value = phi[0] * complex(state[2 * k], state[2 * k + 1])
        for c in range(sizes[INPUTS]):
            total = 0.0j
            for q in range(order):
                total += phi[q + 1] * work.shape[c * order + q]
            value += into[k, c] * total
        found[2 * k] = value.real
        found[2 * k + 1] = value.imag


@part
def flank_factors(train: Train, ladder: Ladder, work: Work, rung: int) -> int:
    """Factors of I - W a of the flanks' own equations into ``work.matrix``; its size."""
    sizes, couple, matrix = train.sizes, ladder.couple, work.matrix
    nodes, outputs, inputs, wide = sizes[NODES], sizes[OUTPUTS], sizes[INPUTS], sizes[WIDE]
    drive, back = work.closed[0], work.closed[1]
    size = 2 * nodes if back == 1 else nodes
    table = rung * nodes * inputs * wide
    for j in range(nodes):
        k = work.values[EIGHT * j + STIFFNESS]
        slope = train.numbers[BASE] - (k if drive == 1 else 0.0)
        pitch = k * work.values[EIGHT * j + PITCH]
        metre = k * work.values[EIGHT * j + METRE]
        for i in range(size):
            at = table + (i * outputs if i < nodes else (i - nodes) * outputs + 1)
            total = couple[at + j * wide] * slope
            if drive == 1 and sizes[FRICTION] == 1:
                total += couple[at + (2 * nodes + j) * wide] * pitch
                total += couple[at + (3 * nodes + j) * wide] * metre
            matrix[i, j] = (1.0 if i == j else 0.0) - total
            if back == 1:
                total = -couple[at + (nodes + j) * wide] * k
                matrix[i, nodes + j] = (1.0 if i == nodes + j else 0.0) - total
    for p in range(size):
        pivot = 1.0 / matrix[p, p]
        for i in range(p + 1, size):
            factor = matrix[i, p] * pivot
            for j in range(p + 1, size):
                matrix[i, j] -= factor * matrix[p, j]
            matrix[i, p] = factor
        matrix[p, p] = pivot
    return int(size)


@part
def periodic_values(
    train: Train, ladder: Ladder, work: Work, t: float, h: float, begin: float, border: float
) -> None:
    """The periodic functions at the nodes, the start and the end of a step to ``work.values``."""
    nodes = train.sizes[NODES]
    f0, ramp = train.numbers[FREQUENCY], train.numbers[RAMP]
    jumps = train.borders.size > 1
    for i in range(nodes + 2):
        share = ladder.nodes[i] if i < nodes else (0.0 if i == nodes else 1.0)
        now = t + share * h
        phase = (f0 + 0.5 * ramp * now) * now
        turned = train.numbers[TURN] + phase
        inside = max(min(phase, border - 1e-13), begin)
        excite(train, phase - math.floor(phase), turned, work.values, i)
        if jumps and inside != phase:
            # what jumps goes on as it is at the border
            for row in range(EIGHT):
                work.kept[row] = work.values[EIGHT * i + row]
            excite(train, inside, turned, work.values, i)
            for row in range(EIGHT):
                if train.broken[row] == 0:
                    work.values[EIGHT * i + row] = work.kept[row]


@part
def guess(train: Train, ladder: Ladder, work: Work, lead: float, stretch: float) -> None:
    """First guess of the bearings' forces: the last step's polynomials, or the present forces."""
    sizes, force = train.sizes, work.force
    nodes = sizes[NODES]
    first = 4 if sizes[FRICTION] == 1 else 2
    order = nodes + 2
    for b in range(sizes[BEARINGS]):
        c = first + 2 * b
        row, at = c * nodes, c * order
        if lead < 0.0:
            for j in range(nodes):
                force[row + j] = work.start_force[c]
                force[row + nodes + j] = work.start_force[c + 1]
            continue
        for j in range(nodes):
            place = min(lead + ladder.nodes[j] * stretch, 2.5)
            one = work.shape[at + order - 1]
            two = work.shape[at + 2 * order - 1]
            for q in range(order - 2, -1, -1):
                one = one * place + work.shape[at + q]
                two = two * place + work.shape[at + order + q]
            force[row + j] = one
            force[row + nodes + j] = two


@part
def forces_at(train: Train, work: Work, row: int, at: int, t: float, found: Real) -> None:
    """All forces from the outputs ``work.ends[at:]`` and the functions in ``row`` at time ``t``."""
    sizes = train.sizes
    first = 4 if sizes[FRICTION] == 1 else 2
    outside = first + 2 * sizes[BEARINGS]
    rate = train.numbers[FREQUENCY] + train.numbers[RAMP] * t
    flank_forces(train, work.values, row, rate, work.ends, at, work.closed, found, 0, 1)
    turned = phase_at(train, t)
    for b in range(sizes[BEARINGS]):
        o = at + 2 + 2 * b
        x, z = work.ends[o], work.ends[o + 1]
        bearing_force(train, x, z, work.closed[2 + b], b, turned, found, first + 2 * b)
    for x in range(outside, sizes[INPUTS]):
        found[x] = outer_force(train, t, x - outside)


@part
def attempt(
    train: Train,
    ladder: Ladder,
    work: Work,
    state: Real,
    rung: int,
    t: float,
    lead: float,
    stretch: float,
) -> float:
    """Solve a step of ``rung`` from ``state`` at ``t``; an estimate of its error [m].

    ``lead`` and ``stretch``: where the step begins and how long it is on the polynomial of the last
    one; ``lead`` < 0: there is none. Leaves forces at the nodes, the state at the end in
    ``work.trial``, outputs at the nodes and the end, and in ``work.pace[1]`` the error that a cut
    within the step would have.
    """
    sizes, couple = train.sizes, ladder.couple
    modes, nodes, outputs, inputs = sizes[MODES], sizes[NODES], sizes[OUTPUTS], sizes[INPUTS]
    wide, span, felt = sizes[WIDE], sizes[SPAN], sizes[FELT]
    first = 4 if sizes[FRICTION] == 1 else 2
    outside = first + 2 * sizes[BEARINGS]
    h = ladder.lengths[rung]
    f0, ramp = train.numbers[FREQUENCY], train.numbers[RAMP]
    base, y, before, force, right = work.base, work.y, work.before, work.force, work.right
    table = rung * nodes * inputs
    for i in range(nodes):
        for o in range(outputs):
            base[i * outputs + o] = train.offset[o]
    gather(ladder.reach, rung * 2 * modes, 2 * modes, wide, state, 0, base, 0)
    y[0] = 0.0
    y[1] = 0.0
    for j in range(nodes):
        now = t + ladder.nodes[j] * h
        # the flanks' forces at no deflection, and outer forces
        rate = f0 + ramp * now
        flank_forces(train, work.values, j, rate, y, 0, work.closed, force, j, nodes)
        for x in range(outside, inputs):
            force[x * nodes + j] = outer_force(train, now, x - outside)
    gather(couple, table, nodes, wide, force, 0, base, 0)
    if work.closed[1] == 1:
        gather(couple, table + nodes, nodes, wide, force, nodes, base, 0)
    if first == 4 and work.closed[0] == 1:
        gather(couple, table + 2 * nodes, 2 * nodes, wide, force, 2 * nodes, base, 0)
    if inputs > outside:
        rows = (inputs - outside) * nodes
        gather(couple, table + outside * nodes, rows, wide, force, outside * nodes, base, 0)
    forces_at(train, work, nodes, 0, t, work.start_force)
    guess(train, ladder, work, lead, stretch)
    size = flank_factors(train, ladder, work, rung)
    matrix, added = work.matrix, work.added
    enough = train.numbers[TOLERANCE] * train.numbers[SWEEP]
    settled = 0
    last = 0.0
    for sweep in range(MOST_SWEEPS):
        work.counts[SWEEPS] += 1
        for i in range(wide):
            y[i] = base[i]
        rows = (outside - first) * nodes
        gather(couple, table + first * nodes, rows, wide, force, first * nodes, y, 0)
        for i in range(size):
            total = y[i * outputs if i < nodes else (i - nodes) * outputs + 1]
            for j in range(i):
                total -= matrix[i, j] * right[j]
            right[i] = total
        for i in range(size - 1, -1, -1):
            total = right[i]
            for j in range(i + 1, size):
                total -= matrix[i, j] * right[j]
            right[i] = total * matrix[i, i]
        # what the deflections add to the forces at none
        for j in range(nodes):
            row = EIGHT * j
            pressed = work.values[row + STIFFNESS] * right[j] if work.closed[0] == 1 else 0.0
            added[j] = train.numbers[BASE] * right[j] - pressed
            if work.closed[1] == 1:
                added[nodes + j] = -work.values[row + STIFFNESS] * right[nodes + j]
            if first == 4:
                added[2 * nodes + j] = pressed * work.values[row + PITCH]
                added[3 * nodes + j] = pressed * work.values[row + METRE]
        gather(couple, table, nodes, wide, added, 0, y, 0)
        if work.closed[1] == 1:
            gather(couple, table + nodes, nodes, wide, added, nodes, y, 0)
        if first == 4 and work.closed[0] == 1:
            gather(couple, table + 2 * nodes, 2 * nodes, wide, added, 2 * nodes, y, 0)
        if first == outside:
            settled = 1
            break
        change = 0.0
        for i in range(nodes):
            turned = phase_at(train, t + ladder.nodes[i] * h)
            for b in range(sizes[BEARINGS]):
                at = i * outputs + 2 + 2 * b
                moved = abs(y[at] - before[at]) + abs(y[at + 1] - before[at + 1])
                change = max(change, moved)
                before[at] = y[at]
                before[at + 1] = y[at + 1]
                row = (first + 2 * b) * nodes + i
                shut = work.closed[2 + b]
                bearing_force(train, y[at], y[at + 1], shut, b, turned, work.end_force, 0)
                force[row] = work.end_force[0]
                force[row + nodes] = work.end_force[1]
        if sweep == 0:
            continue
        if not change < HUGE or (sweep > 4 and change > 0.9 * last):
            break
        # the next change is less by the rate of the changes; at first, of the last step's
        if sweep > 1:
            work.pace[0] = change / last
        if change * min(2.0 * work.pace[0], 1.0) <= enough:
            settled = 1
            break
        last = change
    for j in range(nodes):
        rate = f0 + ramp * (t + ladder.nodes[j] * h)
        flank_forces(train, work.values, j, rate, y, j * outputs, work.closed, force, j, nodes)
    trial = work.trial
    for k in range(modes):
        real, imaginary = state[2 * k], state[2 * k + 1]
        c, s = ladder.decay[(rung * modes + k) * 2], ladder.decay[(rung * modes + k) * 2 + 1]
        trial[2 * k] = c * real - s * imaginary
        trial[2 * k + 1] = c * imaginary + s * real
    gather(ladder.push, table, nodes, span, force, 0, trial, 0)
    if work.closed[1] == 1:
        gather(ladder.push, table + nodes, nodes, span, force, nodes, trial, 0)
    rows = (inputs - 2) * nodes
    gather(ladder.push, table + 2 * nodes, rows, span, force, 2 * nodes, trial, 0)
    outputs_of(train, trial, work.ends, felt)
    if settled == 0:
        return HUGE
    # the residuals of the collocation at both ends
    forces_at(train, work, nodes + 1, felt, t + h, work.end_force)
    error = 0.0
    beside = 0.0
    for c in range(inputs):
        late, early = work.end_force[c], work.start_force[c]
        for j in range(nodes):
            late -= ladder.at_end[j] * force[c * nodes + j]
            early -= ladder.at_end[nodes - 1 - j] * force[c * nodes + j]
        even = early if nodes % 2 == 0 else -early
        work.lacking[c] = 0.5 * abs(late + even)
        error += ladder.miss[rung * inputs + c] * work.lacking[c]
        beside += ladder.miss_within[rung * inputs + c] * 0.5 * abs(late - even)
    work.pace[1] = beside
    if sizes[ROUGH] == 1:
        # a border within the step is seen in this one as well
        error = max(error, UNSEEN * beside)
    return error
