"""A drive train as its kernels see it: modes of a linear base, periodic functions, contacts.

Modes u_k' = lam_k u_k + beta_k . f, outputs y = y0 + sum Re(c_k u_k), and a few local forces f that
stand for all that the base lacks. Inputs f: 0 drive flank, 1 back flank, then two of friction where
there is any, two of every bearing, those of outer forces. Outputs y [m]: 0 and 1 the flanks'
deflections, then two of every bearing. Contacts: 0 and 1 the flanks, then the bearings.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Whole
from thermogear.dynamics.kernels.calculus import gather
from thermogear.dynamics.kernels.compiled import part, small
from thermogear.dynamics.kernels.vector import EIGHT, load, store

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]

MODES, NODES, OUTPUTS, INPUTS, FRICTION, BEARINGS, RUNGS, SPAN, WIDE, FELT, ORDERS, ROUGH = range(
    12
)
"""Places in ``Train.sizes``; padded to eights: SPAN 2 modes, WIDE nodes outputs, FELT outputs.
ROUGH: 1 where a bearing's law has a border that is not located."""
STIFFNESS, ERROR, RATE, PITCH, METRE, BACK_ERROR = range(6)
"""Rows of the table of periodic functions; RATE is de/dphase, PITCH chi_0, METRE chi_1,
BACK_ERROR what the back flank sees, -e."""
BASE, BACKLASH, DAMPING, FREQUENCY, RAMP, TOLERANCE, TURN, SWEEP = range(8)
"""Places in ``Train.numbers``: base stiffness of the drive flank [N/m], b' [m], c_m [N s/m], mesh
frequency [Hz] and its rate [Hz/s], allowed error of a step [m], whole periods since the outer
forces began, share of the tolerance at which sweeps end."""
RING, ELEMENTS = 1, 2
KIND, COUNT, FIRST = range(3)
COEFFICIENT, EXPONENT, CLEARANCE, XX, XY, YX, YY, CAGE = range(8)
"""Places in a row of ``Train.laws``; XX to YY are the base's stiffness [N/m], CAGE the turn of the
cage [rad] in a mesh period."""
ORDER, SHIFT, POWER = range(3)
TWO_PI = 2.0 * math.pi


class Train(NamedTuple):
    """The equations, read only but for ``numbers`` [FREQUENCY] and [TURN].

    Flat: ``out`` (2 modes, felt): Re c and -Im c, ``offset`` y0 (felt), ``table``. ``lam`` (modes)
    [1/s], ``into`` beta (modes, inputs); ``kinds`` (bearings, 3), ``laws`` (bearings, 8), ``rays``
    cos and sin of every element at the phase 0, ``outer`` (forces, 3), ``wobbles`` (run-outs, 5).
    ``edges`` of the panels of ``table`` (panel, power of the phase from the panel's middle, 8
    functions), ``guide`` the panel at k/size of the period; ``borders``: phases in (0, 1], the last
    1, where a step must end; ``broken`` (8): 1 for a function that jumps there.
    """

    sizes: Whole
    numbers: Real
    lam: Complex
    into: Complex
    out: Real
    offset: Real
    kinds: Whole
    laws: Real
    rays: Real
    outer: Real
    wobbles: Real
    edges: Real
    guide: Whole
    table: Real
    borders: Real
    broken: Whole


@small
def excite(train: Train, phase: float, turned: float, values: Real, place: int) -> None:
    """Write the periodic functions at ``phase`` (0..1) to eight ``place`` of ``values``.

    ``turned``: mesh periods since the shafts' own errors began.
    """
    uniform = train.guide.size
    panel = train.guide[min(max(int(phase * uniform), 0), uniform - 1)]
    last = train.edges.size - 2
    while panel < last and phase >= train.edges[panel + 1]:
        panel += 1
    x = phase - 0.5 * (train.edges[panel] + train.edges[panel + 1])
    powers = train.sizes[ORDERS]
    at = EIGHT * (panel * powers + powers - 1)
    total = load(train.table, at)
    for _ in range(powers - 1):
        at -= EIGHT
        total = total * x + load(train.table, at)
    store(values, EIGHT * place, total)
    at = EIGHT * place
    for row in range(train.wobbles.shape[0]):
        angle = TWO_PI * train.wobbles[row, 0]
        c, s = math.cos(angle * turned), math.sin(angle * turned)
        a, b = train.wobbles[row, 1], train.wobbles[row, 2]
        values[at + ERROR] += a * c - b * s
        values[at + RATE] -= angle * (a * s + b * c)
        values[at + BACK_ERROR] += train.wobbles[row, 3] * c - train.wobbles[row, 4] * s


@small
def phase_at(train: Train, t: float) -> float:
    """Mesh periods since the outer forces began, ``t`` [s] into this one."""
    numbers = train.numbers
    return float(numbers[TURN] + (numbers[FREQUENCY] + 0.5 * numbers[RAMP] * t) * t)


@small
def cage_axis(train: Train, row: int, turned: float) -> tuple[float, float]:
    """Cosine and sine of how far a bearing's cage has turned after ``turned`` mesh periods."""
    if train.laws[row, CAGE] == 0.0:
        return 1.0, 0.0
    angle = train.laws[row, CAGE] * turned
    return math.cos(angle), math.sin(angle)


@small
def bearing_force(
    train: Train, x: float, y: float, closed: int, row: int, turned: float, out: Real, at: int
) -> None:
    """Pseudo-force K_base u + F(u) at ``out[at]``, ``out[at + 1]``, after ``turned`` periods."""
    kinds, laws = train.kinds, train.laws
    fx = 0.0
    fy = 0.0
    k, n, c = laws[row, COEFFICIENT], laws[row, EXPONENT], laws[row, CLEARANCE]
    if kinds[row, KIND] == RING:
        r = math.sqrt(x * x + y * y)
        if n == 1.0:
            if closed == 1:
                share = k * (1.0 - c / max(r, 0.3 * c)) if c > 0.0 else k
                fx, fy = -share * x, -share * y
        elif r > c:
            size = k * (r - c) ** n / r
            fx, fy = -size * x, -size * y
    else:
        cos, sin = cage_axis(train, row, turned)
        # as the cage sees it, and back
        along, across = x * cos + y * sin, y * cos - x * sin
        u = 0.0
        v = 0.0
        for i in range(kinds[row, FIRST], kinds[row, FIRST] + kinds[row, COUNT]):
            cx, cy = train.rays[2 * i], train.rays[2 * i + 1]
            deep = along * cx + across * cy - c
            if deep > 0.0:
                load = k * deep * math.sqrt(deep) if n == 1.5 else k * deep**n
                u -= load * cx
                v -= load * cy
        fx, fy = u * cos - v * sin, u * sin + v * cos
    out[at] = fx + laws[row, XX] * x + laws[row, XY] * y
    out[at + 1] = fy + laws[row, YX] * x + laws[row, YY] * y


@part
def bearing_slope(
    train: Train, x: float, y: float, closed: int, row: int, turned: float, out: Real, at: int
) -> None:
    """Derivatives (xx, xy, yx, yy) of :func:`bearing_force` to ``out[at:]``."""
    kinds, laws = train.kinds, train.laws
    xx = 0.0
    xy = 0.0
    yy = 0.0
    k, n, c = laws[row, COEFFICIENT], laws[row, EXPONENT], laws[row, CLEARANCE]
    if kinds[row, KIND] == RING:
        r = math.sqrt(x * x + y * y)
        on = closed == 1 if n == 1.0 else r > c
        if on and (c == 0.0 and n == 1.0):
            xx = yy = -k
        elif on:
            deep = r - c
            size = math.copysign(abs(deep) ** n, deep) * k / r
            slope = n * k * abs(deep) ** (n - 1.0) - size
            ex, ey = x / r, y / r
            xx = -size - slope * ex * ex
            xy = -slope * ex * ey
            yy = -size - slope * ey * ey
    else:
        cos, sin = cage_axis(train, row, turned)
        for i in range(kinds[row, FIRST], kinds[row, FIRST] + kinds[row, COUNT]):
            cx = train.rays[2 * i] * cos - train.rays[2 * i + 1] * sin
            cy = train.rays[2 * i] * sin + train.rays[2 * i + 1] * cos
            deep = x * cx + y * cy - c
            if deep > 0.0:
                slope = n * k * deep ** (n - 1.0)
                xx -= slope * cx * cx
                xy -= slope * cx * cy
                yy -= slope * cy * cy
    out[at] = xx + laws[row, XX]
    out[at + 1] = xy + laws[row, XY]
    out[at + 2] = xy + laws[row, YX]
    out[at + 3] = yy + laws[row, YY]


@small
def outer_force(train: Train, t: float, row: int) -> float:
    """(Omega^2 cos + Omega' sin)(order phase) or cos(order phase), of one outer force."""
    numbers, outer = train.numbers, train.outer
    n = numbers[FREQUENCY] + numbers[RAMP] * t
    angle = TWO_PI * outer[row, ORDER] * phase_at(train, t) + outer[row, SHIFT]
    if outer[row, POWER] == 0.0:
        return math.cos(angle)
    turn = TWO_PI * outer[row, ORDER]
    return float(turn * turn * n * n * math.cos(angle) + turn * numbers[RAMP] * math.sin(angle))


@small
def outputs_of(train: Train, state: Real, found: Real, at: int) -> None:
    """y = y0 + C u of ``state`` (2 modes) to ``found[at:]``."""
    felt = train.sizes[FELT]
    for o in range(felt):
        found[at + o] = train.offset[o]
    gather(train.out, 0, 2 * train.sizes[MODES], felt, state, 0, found, at)


@small
def located(train: Train, contact: int) -> bool:
    """Whether the changes of a contact are located: its law has a kink there."""
    if contact < 2:
        return True
    b = contact - 2
    return bool(train.kinds[b, KIND] == RING and train.laws[b, EXPONENT] == 1.0)


@small
def gap_of(train: Train, contact: int, drive: float, back: float, error: float) -> float:
    """Penetration [m] of a contact, > 0 closed; a bearing's by (x, y) in place of both flanks'."""
    if contact == 0:
        return float(drive - error - train.numbers[BACKLASH])
    if contact == 1:
        return float(back - error - train.numbers[BACKLASH])
    return float(math.sqrt(drive * drive + back * back) - train.laws[contact - 2, CLEARANCE])


@small
def flank_forces(
    train: Train,
    values: Real,
    node: int,
    rate: float,
    deflections: Real,
    at: int,
    closed: Whole,
    force: Real,
    place: int,
    stride: int,
) -> None:
    """Inputs 0, 1 and those of friction at one node from ``deflections[at:]``.

    They go to ``force[place]``, ``stride`` apart. The law of a contact goes on in a straight line
    beyond its border; ``rate`` is the mesh frequency [Hz].
    """
    numbers, row = train.numbers, EIGHT * node
    k, e = values[row + STIFFNESS], values[row + ERROR]
    d, b = deflections[at], deflections[at + 1]
    pressed = k * (d - e - numbers[BACKLASH]) if closed[0] == 1 else 0.0
    force[place] = numbers[BASE] * d - pressed + numbers[DAMPING] * values[row + RATE] * rate
    other = values[row + BACK_ERROR]
    force[place + stride] = -k * (b - other - numbers[BACKLASH]) if closed[1] == 1 else 0.0
    if train.sizes[FRICTION] == 1:
        force[place + 2 * stride] = pressed * values[row + PITCH]
        force[place + 3 * stride] = pressed * values[row + METRE]
