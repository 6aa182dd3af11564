"""Compiled kernel: least advance of flanks of polynomial pieces until they touch.

The point of the pinion at string length rho is at S = s + c g, c its part of the advance g. It lies
on the wheel's involute of string sigma at W, so that this point asks for the advance

    E(rho, g) = S - W + e_2(sigma),   e_1 turns the point back about its gear,

and the gap is the g = min over rho of E(rho, g). Between the borders of the pieces of both flanks E
is smooth: its least value is at a border or where dE/drho = 0, known in closed form. dg = dE/dg of
that point alone, because it is stationary: Newton's step in g is exact to second order.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.kernel_cache import compiled

_MOST_TURNS = 60
_PLACE = 1e-12
"""String [m] to which borders of the wheel are found on the pinion."""
_LEVEL = 1e-8
"""dE/drho counted as 0: with d2E/drho2 > 1 /m the gap is exact to 1e-16 m."""
_LAST = 1e-9
"""Newton's step of the gap [m] after which the next would be below its rounding, 1e-16 m."""


@compiled
def _piece(borders: Floats, at: float) -> int:
    """Index of the piece that holds ``at``; the first or last one beyond them."""
    return min(max(int(np.searchsorted(borders, at, side="right")) - 1, 0), borders.size - 2)


@compiled
def _off(borders: Floats, powers: Floats, piece: int, at: float) -> tuple[float, float]:
    """What is taken off [m] at string length ``at`` [m] by one piece, and its slope."""
    width = borders[piece + 1] - borders[piece]
    x = (at - borders[piece]) / width
    value, slope = 0.0, 0.0
    for m in range(powers.shape[1] - 1, -1, -1):
        slope = slope * x + value
        value = value * x + powers[piece, m]
    return value, slope / width


@compiled
def _meet(
    rho: float, stands: float, mesh: Floats, borders: Floats, powers: Floats, piece: int
) -> tuple[complex, complex, complex, float]:
    """The pinion's point seen from the wheel, its move with rho and with S, and sigma^2 [m^2]."""
    off, slope = _off(borders, powers, piece, rho)
    angle = (stands - off - rho) / mesh[0]
    turn = complex(math.cos(angle), math.sin(angle))
    point = complex(mesh[0], rho) * turn
    along = complex(rho * (1.0 + slope) / mesh[0], -slope) * turn
    seen = (complex(mesh[0] + mesh[1], mesh[2]) - point).conjugate()
    square = seen.real**2 + seen.imag**2 - mesh[1] ** 2
    return seen, -along.conjugate(), 1j * point.conjugate() / mesh[0], square


@compiled
def _advance(
    rho: float,
    stands: float,
    mesh: Floats,
    one: Floats,
    first: Floats,
    i: int,
    two: Floats,
    second: Floats,
    j: int,
) -> tuple[float, float, float, float]:
    """E [m] on the pieces i and j of both flanks, dE/drho, dE/dS at one rho and at one sigma."""
    seen, along, ahead, square = _meet(rho, stands, mesh, one, first, i)
    string = math.sqrt(max(square, 1e-30))
    off, slope = _off(two, second, j, string)
    unit = (seen / complex(mesh[1], -string)).conjugate()
    place = mesh[2] - string + mesh[1] * math.atan2(-unit.imag, unit.real)
    back = seen.conjugate() / string
    moved, turned = (back * along).real, (back * ahead).real
    down = slope * moved - (along * unit).imag
    by = 1.0 - (ahead * unit).imag + slope * turned
    return stands - place + off, down, by, by - down * turned / moved


@compiled
def _reached(
    string: float, begin: float, stands: float, mesh: Floats, borders: Floats, powers: Floats
) -> float:
    """rho [m] of the pinion's point that lies at ``string`` [m] of the wheel, or the nearer end."""
    rho, low, high = begin, -math.inf, math.inf
    for _ in range(_MOST_TURNS):
        seen, along, _, square = _meet(rho, stands, mesh, borders, powers, _piece(borders, rho))
        # sigma falls along the pinion's flank
        if square > string**2:
            low = rho
        else:
            high = rho
        slope = 2.0 * (seen.conjugate() * along).real
        goal = rho - (square - string**2) / min(slope, -1e-30)
        goal = float(min(max(goal, borders[0]), borders[-1]))
        if abs(goal - rho) < _PLACE:
            return goal
        if not low < goal < high:
            goal = 0.5 * (max(low, borders[0]) + min(high, borders[-1]))
        rho = goal
    return rho


@compiled
def _least_on(
    low: float,
    high: float,
    stands: float,
    mesh: Floats,
    one: Floats,
    first: Floats,
    i: int,
    two: Floats,
    second: Floats,
    j: int,
    kept: tuple[bool, bool],
) -> tuple[float, float, float]:
    """Least E [m] between ``low`` and ``high`` on one piece of each flank, its dE/dS and rho [m].

    ``kept``: whether low and high are places of the wheel, which the pinion's point leaves with S.

    The secant of dE/drho, halved at the end that stays, so that both ends close in.
    """
    at_low, down, by_low, kept_low = _advance(low, stands, mesh, one, first, i, two, second, j)
    at_high, up, by_high, kept_high = _advance(high, stands, mesh, one, first, i, two, second, j)
    if not (down < 0.0 < up):
        if at_low <= at_high:
            return at_low, kept_low if kept[0] else by_low, low
        return at_high, kept_high if kept[1] else by_high, high
    value, by, rho = at_low, by_low, low
    for _ in range(_MOST_TURNS):
        rho = (low * up - high * down) / (up - down)
        value, slope, by, _ = _advance(rho, stands, mesh, one, first, i, two, second, j)
        if abs(slope) < _LEVEL:
            break
        if slope < 0.0:
            low, down, up = rho, slope, 0.5 * up
        else:
            high, up, down = rho, slope, 0.5 * down
    return value, by, rho


@compiled
def _least(
    begin: float,
    end: float,
    stands: float,
    mesh: Floats,
    one: Floats,
    first: Floats,
    two: Floats,
    second: Floats,
) -> tuple[float, float, int]:
    """Least E [m] over the flanks between ``begin`` and ``end``, its dE/dS and whose tip it is."""
    tip = _reached(two[-1], begin, stands, mesh, one, first)
    low, high = max(begin, tip), min(end, _reached(two[0], end, stands, mesh, one, first))
    best, by, edge = math.inf, 0.0, 0
    if low > high:
        return best, by, edge
    i, kept = _piece(one, low), tip > begin
    square = _meet(low, stands, mesh, one, first, i)[3]
    j = _piece(two, math.sqrt(max(square, 0.0)))
    following = _reached(two[j], low, stands, mesh, one, first)
    while True:
        upper = min(high, one[i + 1], following)
        value, slope, rho = _least_on(
            low, upper, stands, mesh, one, first, i, two, second, j, (kept, following <= upper)
        )
        if value < best:
            best, by = value, slope
            edge = 2 if rho == one[-1] else 1 if rho == tip > one[0] else 0
        low, kept = upper, following <= upper
        if low >= high or (kept and j == 0):
            return best, by, edge
        if one[i + 1] <= low:
            i += 1
        if kept:
            j -= 1
            following = _reached(two[j], low, stands, mesh, one, first)


@compiled
def _touch_one(
    s: float,
    middle: float,
    gap: float,
    reach: float,
    mesh: Floats,
    one: Floats,
    first: Floats,
    two: Floats,
    second: Floats,
) -> tuple[float, int]:
    """Gap [m] and edge of one candidate; ``gap`` and ``middle`` of its nominal point.

    ``reach`` [m]: the flank is looked at so far to both sides.
    """
    part = min(max((mesh[4] - s) / (mesh[4] - mesh[3]), 0.0), 1.0)
    begin, end = max(middle - reach, one[0]), min(middle + reach, one[-1])
    edge = 0
    for _ in range(_MOST_TURNS):
        value, by, edge = _least(begin, end, s + part * gap, mesh, one, first, two, second)
        if value == math.inf:
            return value, 0
        step = (value - gap) / (1.0 - part * by)
        gap += step
        if abs(step) < _LAST:
            break
    return gap, edge


@compiled
def touch_many(
    s: Floats,
    middle: Floats,
    near: NDArray[np.bool_],
    reach: Floats,
    mesh: Floats,
    one: Floats,
    first: Floats,
    two: Floats,
    second: Floats,
    gap: Floats,
    edge: NDArray[np.int8],
) -> None:
    """All cases and candidates into ``gap`` and ``edge`` [case, candidate].

    s, middle [candidate]: place and the pinion's rho of the nominal point [m]; near [case,
    candidate]: the others stay as they come; reach [case, candidate]: string [m] looked at to both
    sides; mesh: r_b1, r_b2, N1N2, s_A, s_E [m]; one, two: borders [m] of the pieces of pinion and
    wheel; first, second [case, piece, power]: what is taken off, in parts of the piece. ``gap``
    comes as that of the nominal point.
    """
    for case in range(gap.shape[0]):
        for k in range(s.size):
            if near[case, k]:
                gap[case, k], edge[case, k] = _touch_one(
                    s[k],
                    middle[k],
                    gap[case, k],
                    reach[case, k],
                    mesh,
                    one,
                    first[case],
                    two,
                    second[case],
                )
