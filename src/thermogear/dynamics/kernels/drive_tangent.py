"""The variational equations of a drive train through a step just solved."""

from __future__ import annotations

import math

from thermogear.dynamics.kernels.calculus import along, gather, root_between, solve_lu
from thermogear.dynamics.kernels.compiled import part
from thermogear.dynamics.kernels.drive import (
    BASE,
    BEARINGS,
    CLEARANCE,
    COUNT,
    FELT,
    FIRST,
    FRICTION,
    INPUTS,
    METRE,
    MODES,
    NODES,
    OUTPUTS,
    PITCH,
    SPAN,
    STIFFNESS,
    WIDE,
    Real,
    Train,
    bearing_slope,
    cage_axis,
    located,
    phase_at,
)
from thermogear.dynamics.kernels.ladder import Ladder, Work
from thermogear.dynamics.kernels.vector import EIGHT

MOST_PIECES = 16
"""Of a step between borders of one bearing: more have never been met, their borders are passed
over."""


@part
def slopes_at(train: Train, work: Work, node: int, turned: float, slope: Real) -> None:
    """Derivatives of the forces at a node: drive, back, friction, four of every bearing."""
    count, y = train.sizes[BEARINGS], work.y
    o = node * train.sizes[OUTPUTS]
    k = work.values[EIGHT * node + STIFFNESS]
    pressed = k if work.closed[0] == 1 else 0.0
    at = node * (4 + 4 * count)
    slope[at] = train.numbers[BASE] - pressed
    slope[at + 1] = -k if work.closed[1] == 1 else 0.0
    slope[at + 2] = pressed * work.values[EIGHT * node + PITCH]
    slope[at + 3] = pressed * work.values[EIGHT * node + METRE]
    for b in range(count):
        x, z = y[o + 2 + 2 * b], y[o + 3 + 2 * b]
        bearing_slope(train, x, z, work.closed[2 + b], b, turned, slope, at + 4 + 4 * b)


@part
def borders_within(
    train: Train, ladder: Ladder, work: Work, bearing: int, t: float, h: float
) -> int:
    """Shares of the step at which an element begins or ceases to carry; how many pieces they make.

    In ``work.pieces``, from 0 to 1 in order. ``work.journal_x`` and ``journal_y`` are the bearing's
    x and y at start, nodes and end.
    """
    count, gaps, pieces = train.sizes[NODES] + 2, work.gaps, work.pieces
    c = train.laws[bearing, CLEARANCE]
    elements, first = train.kinds[bearing, COUNT], train.kinds[bearing, FIRST]
    number = 1
    pieces[0], pieces[1] = 0.0, 1.0
    for i in range(max(elements, 1)):
        for m in range(count):
            x, z = work.journal_x[m], work.journal_y[m]
            if elements > 0:
                at = 2 * (first + i)
                cos, sin = cage_axis(train, bearing, phase_at(train, t + ladder.places[m] * h))
                gaps[m] = (x * cos + z * sin) * train.rays[at] - c
                gaps[m] += (z * cos - x * sin) * train.rays[at + 1]
            else:
                gaps[m] = math.sqrt(x * x + z * z) - c
        for m in range(count - 1):
            if (gaps[m] > 0.0) == (gaps[m + 1] > 0.0) or number == MOST_PIECES:
                continue
            low, high = ladder.places[m], ladder.places[m + 1]
            border = root_between(low, high, count, ladder.places, ladder.weights, gaps, 0.0)
            place = number
            while pieces[place - 1] > border:
                pieces[place] = pieces[place - 1]
                place -= 1
            pieces[place] = border
            number += 1
            pieces[number] = 1.0
    return int(number)


@part
def projected_slopes(
    train: Train, ladder: Ladder, work: Work, bearing: int, t: float, h: float, slope: Real
) -> None:
    """Derivatives of a power law at the nodes, of the polynomial that is nearest over the step.

    An element that begins to carry has a derivative like the (n - 1)th power of time, which no
    polynomial is: its values at the nodes miss much of what it does to a tangent. Those of its
    projection onto the polynomials through the nodes have the same integrals against them, which
    is what a tangent, being smooth, is pushed by: J_j = int J l_j / int l_j over the step (product
    integration). The integrals go from border to border in powers of the distance from it.
    """
    nodes, outputs, felt = train.sizes[NODES], train.sizes[OUTPUTS], train.sizes[FELT]
    stride = 4 + 4 * train.sizes[BEARINGS]
    places, weights, order, o = ladder.places, ladder.weights, nodes + 2, 2 + 2 * bearing
    path_x, path_y = work.journal_x, work.journal_y
    path_x[0], path_y[0] = work.ends[o], work.ends[o + 1]
    path_x[nodes + 1], path_y[nodes + 1] = work.ends[felt + o], work.ends[felt + o + 1]
    for j in range(nodes):
        path_x[1 + j], path_y[1 + j] = work.y[j * outputs + o], work.y[j * outputs + o + 1]
    number = borders_within(train, ladder, work, bearing, t, h)
    moments, local = work.moments, work.local
    for q in range(4 * nodes):
        moments[q] = 0.0
    for half in range(2 * number):
        border, other = work.pieces[half // 2], work.pieces[half // 2 + 1]
        if half % 2 == 1:
            border, other = other, border
        width = 0.5 * (other - border)
        for i in range(ladder.graded.shape[1]):
            share = border + width * ladder.graded[0, i]
            x = along(share, order, places, weights, path_x)
            y = along(share, order, places, weights, path_y)
            bearing_slope(train, x, y, 1, bearing, phase_at(train, t + share * h), local, 0)
            weight = abs(width) * ladder.graded[1, i]
            for q in range(nodes):
                for part_of in range(4):
                    moments[4 * q + part_of] += weight * local[part_of]
                weight *= share
    for j in range(nodes):
        whole = 0.0
        for q in range(nodes):
            whole += ladder.powers[q, j] / (q + 1.0)
        for part_of in range(4):
            total = 0.0
            for q in range(nodes):
                total += ladder.powers[q, j] * moments[4 * q + part_of]
            slope[j * stride + 4 + 4 * bearing + part_of] = total / whole


@part
def node_equations(train: Train, ladder: Ladder, work: Work, rung: int) -> int:
    """I - W J of all outputs at the nodes into ``work.full``; its size."""
    sizes, couple, slope = train.sizes, ladder.couple, work.slope
    nodes, outputs, inputs, wide = sizes[NODES], sizes[OUTPUTS], sizes[INPUTS], sizes[WIDE]
    first = 4 if sizes[FRICTION] == 1 else 2
    size = nodes * outputs
    table = rung * nodes * inputs * wide
    for i in range(size):
        row = i * size
        for j in range(nodes):
            at, s = table + j * wide + i, j * (4 + 4 * sizes[BEARINGS])
            here = couple[at] * slope[s]
            for extra in range(2, first):
                here += couple[at + extra * nodes * wide] * slope[s + extra]
            work.full[row + j * outputs] = -here
            work.full[row + j * outputs + 1] = -couple[at + nodes * wide] * slope[s + 1]
            for b in range(sizes[BEARINGS]):
                x = couple[at + (first + 2 * b) * nodes * wide]
                z = couple[at + (first + 2 * b + 1) * nodes * wide]
                o, p = row + j * outputs + 2 + 2 * b, s + 4 + 4 * b
                work.full[o] = -(x * slope[p] + z * slope[p + 2])
                work.full[o + 1] = -(x * slope[p + 1] + z * slope[p + 3])
        work.full[row + i] += 1.0
    return int(size)


@part
def carry_tangent(
    train: Train, ladder: Ladder, work: Work, tangent: Real, columns: int, rung: int, t: float
) -> None:
    """Carry the columns of ``tangent`` (columns, span) through the whole step just solved.

    It began ``t`` [s] into the mesh period.
    """
    h = ladder.lengths[rung]
    sizes, right, pushed, slope = train.sizes, work.right, work.pushed, work.slope
    modes, nodes, outputs, inputs = sizes[MODES], sizes[NODES], sizes[OUTPUTS], sizes[INPUTS]
    wide, span = sizes[WIDE], sizes[SPAN]
    first = 4 if sizes[FRICTION] == 1 else 2
    for j in range(nodes):
        slopes_at(train, work, j, phase_at(train, t + ladder.nodes[j] * h), slope)
    for b in range(sizes[BEARINGS]):
        if not located(train, 2 + b):
            projected_slopes(train, ladder, work, b, t, h, slope)
    size = node_equations(train, ladder, work, rung)
    for column in range(columns):
        for i in range(wide):
            right[column * wide + i] = 0.0
        row = column * span
        gather(ladder.reach, rung * 2 * modes, 2 * modes, wide, tangent, row, right, column * wide)
    solve_lu(size, columns, work.full, right, wide)
    rows = nodes * inputs
    for column in range(columns):
        for j in range(rows):
            pushed[j] = 0.0
        for j in range(nodes):
            o, s = column * wide + j * outputs, j * (4 + 4 * sizes[BEARINGS])
            pushed[j] = slope[s] * right[o]
            pushed[nodes + j] = slope[s + 1] * right[o + 1]
            for extra in range(2, first):
                pushed[extra * nodes + j] = slope[s + extra] * right[o]
            for b in range(sizes[BEARINGS]):
                c, p = (first + 2 * b) * nodes + j, s + 4 + 4 * b
                x, z = right[o + 2 + 2 * b], right[o + 3 + 2 * b]
                pushed[c] = slope[p] * x + slope[p + 1] * z
                pushed[c + nodes] = slope[p + 2] * x + slope[p + 3] * z
        row = column * span
        for k in range(modes):
            real, imaginary = tangent[row + 2 * k], tangent[row + 2 * k + 1]
            at = (rung * modes + k) * 2
            c, s = ladder.decay[at], ladder.decay[at + 1]
            tangent[row + 2 * k] = c * real - s * imaginary
            tangent[row + 2 * k + 1] = c * imaginary + s * real
        gather(ladder.push, rung * rows, rows, span, pushed, 0, tangent, row)
