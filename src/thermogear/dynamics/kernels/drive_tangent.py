"""The variational equations of a drive train through a step just solved."""

from __future__ import annotations

from thermogear.dynamics.kernels.calculus import gather, solve_lu
from thermogear.dynamics.kernels.compiled import part
from thermogear.dynamics.kernels.drive import (
    BASE,
    BEARINGS,
    FELT,
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
)
from thermogear.dynamics.kernels.ladder import (
    Ladder,
    Work,
    within,
)
from thermogear.dynamics.kernels.vector import EIGHT


@part
def slopes_at(train: Train, work: Work, y: Real, o: int, row: int, slope: Real) -> None:
    """Derivatives of the forces at outputs ``y[o:]``: drive, back, friction, four of every bearing.

    ``row`` of the periodic functions; to the place of that node in ``slope``.
    """
    count = train.sizes[BEARINGS]
    k = work.values[EIGHT * row + STIFFNESS]
    pressed = k if work.closed[0] == 1 else 0.0
    at = row * (4 + 4 * count) if row < train.sizes[NODES] else 0
    slope[at] = train.numbers[BASE] - pressed
    slope[at + 1] = -k if work.closed[1] == 1 else 0.0
    slope[at + 2] = pressed * work.values[EIGHT * row + PITCH]
    slope[at + 3] = pressed * work.values[EIGHT * row + METRE]
    for b in range(count):
        x, z = y[o + 2 + 2 * b], y[o + 3 + 2 * b]
        bearing_slope(train, x, z, work.closed[2 + b], b, slope, at + 4 + 4 * b)


@part
def edge_forces(train: Train, work: Work, state: Real, row: int, slope: Real, found: Real) -> None:
    """Derivatives of all forces at one end of a step along the column ``state[row:]``."""
    sizes = train.sizes
    first = 4 if sizes[FRICTION] == 1 else 2
    felt = sizes[FELT]
    for o in range(felt):
        work.edge[o] = 0.0
    gather(train.out, 0, 2 * sizes[MODES], felt, state, row, work.edge, 0)
    found[0] = slope[0] * work.edge[0]
    found[1] = slope[1] * work.edge[1]
    for extra in range(2, first):
        found[extra] = slope[extra] * work.edge[0]
    for b in range(sizes[BEARINGS]):
        c, p = first + 2 * b, 4 + 4 * b
        x, z = work.edge[2 + 2 * b], work.edge[3 + 2 * b]
        found[c] = slope[p] * x + slope[p + 1] * z
        found[c + 1] = slope[p + 2] * x + slope[p + 3] * z
    for c in range(first + 2 * sizes[BEARINGS], sizes[INPUTS]):
        found[c] = 0.0


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
    train: Train,
    ladder: Ladder,
    work: Work,
    tangent: Real,
    columns: int,
    rung: int,
    share: float,
) -> None:
    """Carry the columns of ``tangent`` (columns, span) through the step just solved."""
    sizes, right, pushed, slope = train.sizes, work.right, work.pushed, work.slope
    modes, nodes, outputs, inputs = sizes[MODES], sizes[NODES], sizes[OUTPUTS], sizes[INPUTS]
    wide, span = sizes[WIDE], sizes[SPAN]
    first = 4 if sizes[FRICTION] == 1 else 2
    for j in range(nodes):
        slopes_at(train, work, work.y, j * outputs, j, slope)
    size = node_equations(train, ladder, work, rung)
    for column in range(columns):
        for i in range(wide):
            right[column * wide + i] = 0.0
        row = column * span
        gather(ladder.reach, rung * 2 * modes, 2 * modes, wide, tangent, row, right, column * wide)
    solve_lu(size, columns, work.full, right, wide)
    rows = nodes * inputs
    for column in range(columns):
        at = column * rows
        for j in range(rows):
            pushed[at + j] = 0.0
        for j in range(nodes):
            o, s = column * wide + j * outputs, j * (4 + 4 * sizes[BEARINGS])
            pushed[at + j] = slope[s] * right[o]
            pushed[at + nodes + j] = slope[s + 1] * right[o + 1]
            for extra in range(2, first):
                pushed[at + extra * nodes + j] = slope[s + extra] * right[o]
            for b in range(sizes[BEARINGS]):
                c, p = at + (first + 2 * b) * nodes + j, s + 4 + 4 * b
                x, z = right[o + 2 + 2 * b], right[o + 3 + 2 * b]
                pushed[c] = slope[p] * x + slope[p + 1] * z
                pushed[c + nodes] = slope[p + 2] * x + slope[p + 3] * z
    kept = work.pushed_shape
    order = nodes + 2
    slopes_at(train, work, work.ends, 0, nodes, work.start_slope)
    slopes_at(train, work, work.whole_end, 0, nodes + 1, work.end_slope)
    for column in range(columns):
        row = column * span
        if share < 1.0:
            edge_forces(train, work, tangent, row, work.start_slope, work.start_force)
        for k in range(span):
            work.sample[k] = 0.0
        for k in range(modes):
            real, imaginary = tangent[row + 2 * k], tangent[row + 2 * k + 1]
            at = (rung * modes + k) * 2
            c, s = ladder.decay[at], ladder.decay[at + 1]
            work.sample[2 * k] = c * real - s * imaginary
            work.sample[2 * k + 1] = c * imaginary + s * real
        gather(ladder.push, rung * rows, rows, span, pushed, column * rows, work.sample, 0)
        if share < 1.0:
            edge_forces(train, work, work.sample, 0, work.end_slope, work.end_force)
            for c in range(inputs):
                for q in range(order):
                    total = ladder.wider[q * order] * work.start_force[c]
                    total += ladder.wider[q * order + order - 1] * work.end_force[c]
                    for j in range(nodes):
                        total += (
                            ladder.wider[q * order + 1 + j] * pushed[column * rows + c * nodes + j]
                        )
                    kept[(column * inputs + c) * order + q] = total
        else:
            for k in range(span):
                tangent[row + k] = work.sample[k]
    if share < 1.0:
        h = ladder.lengths[rung]
        within(train, ladder, work, share, h, columns, tangent, kept, tangent)
