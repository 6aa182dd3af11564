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
_AHEAD = 1e-4
"""Move of the place [r_b1] over which slopes of an advance are taken."""
_PARABOLAS = 2
"""Through the nodes about the least of them."""
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


@compiled
def advance_many(
    s: Floats,
    middle: Floats,
    near: NDArray[np.bool_],
    reach: Floats,
    mesh: Floats,
    one: Floats,
    two: Floats,
    nodes: Floats,
    edge: NDArray[np.int8],
) -> None:
    """Advances of plain involutes at many points of their flanks into ``nodes`` and ``edge``.

    s, middle, near, reach [candidate] and mesh as :func:`touch_many` takes them; one, two: both
    ends [m] of the flanks. nodes [candidate, node, 7]: string rho and sigma [m] of the points that
    meet, their advance [m], its slope and bend [1/m] by the place s, the slopes of rho and sigma;
    edge [candidate, 2]: whose tip the first and the last node is. Both ends come twice, outermost
    as those of the flank that ends there. Candidates that are not near stay as they come.
    """
    plain, count, move = np.zeros((1, 1)), nodes.shape[1], _AHEAD * mesh[0]
    for q in range(s.size):
        if not near[q]:
            continue
        begin, end = max(middle[q] - reach[q], one[0]), min(middle[q] + reach[q], one[-1])
        tip = _reached(two[-1], begin, s[q], mesh, one, plain)
        foot = _reached(two[0], end, s[q], mesh, one, plain)
        low, high = max(begin, tip), min(end, foot)
        edge[q, 1] = 2 * (end == one[-1] <= foot)
        edge[q, 0] = edge[q, 1] if low == high else 1 * (low > begin)
        for k in range(count):
            rho = low + (high - low) * min(max(k - 1, 0), count - 3) / (count - 3)
            value, _, by, kept = _advance(rho, s[q], mesh, one, plain, 0, two, plain, 0)
            string = math.sqrt(max(_meet(rho, s[q], mesh, one, plain, 0)[3], 0.0))
            moved, ahead = rho, s[q] + move
            wheels = (k == 0 and low > begin) or (k == count - 1 and high < end)
            if wheels:  # the end of its flank stays its own, along the pinion's
                moved = _reached(string, rho, ahead, mesh, one, plain)
            _, _, later, later_kept = _advance(moved, ahead, mesh, one, plain, 0, two, plain, 0)
            after = math.sqrt(max(_meet(moved, ahead, mesh, one, plain, 0)[3], 0.0))
            if wheels:
                by, later = kept, later_kept
            nodes[q, k] = rho, string, value, by, later - by, moved - rho, after - string
            nodes[q, k, 4:] /= move
            if low > high:
                nodes[q, k, 2] = np.inf


@compiled
def _between(table: Floats, place: float, tooth: int) -> float:
    """One tooth's column of ``table`` at ``place``, a number of steps, linear in between."""
    k = min(max(int(place), 0), table.shape[0] - 2)
    low = table[k, tooth]
    return float(low + (place - k) * (table[k + 1, tooth] - low))


@compiled
def _gap_at(
    nodes: Floats, n: int, part: float, e1: Floats, i: int, e2: Floats, j: int, gap: float
) -> float:
    """Gap [m] at which the points of node n of the teeth i and j touch.

    e = [a + (1 - a') e_1 + a'' x^2/2 + e_2]/(1 - part a'), a the advance, a' and a'' its slope and
    bend by the place, e_1 and e_2 by the tables ``e1`` and ``e2`` where the points are when the
    pinion's has moved on by x = part ``gap`` - e_1 [m].
    """
    by = nodes[n, 3]
    shift = part * gap - _between(e1, nodes[n, 0], i)
    off = _between(e1, nodes[n, 0] + nodes[n, 5] * shift, i)
    taken = (1.0 - by) * off + _between(e2, nodes[n, 1] + nodes[n, 6] * shift, j)
    return float((nodes[n, 2] + taken + 0.5 * nodes[n, 4] * shift * shift) / (1.0 - part * by))


@compiled
def _at_nodes(
    table: Floats, nodes: Floats, known: int, part: float, column: int, out: Floats
) -> None:
    """What each tooth adds to the gap at ``known`` of the ``nodes``, to first order [m], into out.

    table [step, tooth] of the gear whose string is in that ``column`` of ``nodes``; out [node,
    tooth].
    """
    for k in range(known):
        by, place = nodes[k, 3], nodes[k, column]
        weight = (1.0 - by if column == 0 else 1.0) / (1.0 - part * by)
        low = min(max(int(place), 0), table.shape[0] - 2)
        after = weight * (place - low)
        before = weight - after
        for tooth in range(table.shape[1]):
            out[k, tooth] = before * table[low, tooth] + after * table[low + 1, tooth]


@compiled
def _least_near(
    nodes: Floats, best: int, bend: float, rise: float, part: float, e1: Floats, i: int,
    e2: Floats, j: int, gap: float, node: Floats,
) -> float:  # fmt: skip
    """Least gap [m] at node ``best`` and between its neighbours, from its ``gap`` to first order.

    By parabolas: the first of bend and rise [m] a node to first order, the second through what the
    gap is to second order at the node and at the least of the first.
    """
    start = least = _gap_at(nodes, best, part, e1, i, e2, j, gap)
    x, last = -rise / max(bend, 1e-30), 0.0
    for _ in range(_PARABOLAS):
        x = min(max(x, -1.0), 1.0)
        if x == last:
            break
        for n in range(node.shape[1]):
            before, here, after = nodes[best - 1, n], nodes[best, n], nodes[best + 1, n]
            node[0, n] = here + 0.5 * x * (after - before + x * (before - 2.0 * here + after))
        value = _gap_at(node, 0, part, e1, i, e2, j, least)
        least, last = min(least, value), x
        # through both values, with the bend of the first
        x = 0.5 * x - (value - start) / (max(bend, 1e-30) * x)
    return least


@compiled
def touch_teeth(
    nodes: Floats,
    edges: NDArray[np.int8],
    part: Floats,
    first: Floats,
    second: Floats,
    order: NDArray[np.int64],
    begin: NDArray[np.int64],
    pinion: NDArray[np.int64],
    wheel: NDArray[np.int64],
    gained: Floats,
    lost: Floats,
    gap: Floats,
    edge: NDArray[np.int8],
) -> None:
    """Gap [m] and edge [case, position, pair] of teeth that differ, the least over the nodes.

    nodes [place, pair, node, 7] and edges [place, pair, 2]: see :func:`advance_many`, strings in
    steps of the tables; part [place, pair]: of the advance, the pinion's; first, second [case,
    step, tooth]: what is taken off; order [position]: positions by their place, those of each from
    begin [place + 1] on; pinion, wheel [position, pair]: teeth of the tables; gained, lost [place,
    pair]: what is added, and taken off again on an edge. Gaps to first order at all nodes, to
    second order between the neighbours of the least.
    """
    count = nodes.shape[2]
    node = np.empty((1, nodes.shape[3]))
    e1, e2 = np.empty((count, first.shape[2])), np.empty((count, second.shape[2]))
    most = np.max(np.diff(begin))
    least, best = np.empty(most), np.empty(most, np.int64)
    # without a sign: an index from the end would be looked for at every one
    first_row, second_row = np.empty((2, most), np.uint64)
    advance = nodes[..., 2] / (1.0 - np.expand_dims(part, 2) * nodes[..., 3])
    # one place alone where the flanks are not near
    several = np.where(nodes[..., 0, 0] == nodes[..., count - 1, 0], 1, count)
    for c in range(gap.shape[0]):
        one, two = first[c], second[c]
        for q, r in np.ndindex(part.shape):
            these, share, known = nodes[q, r], float(part[q, r]), int(several[q, r])
            _at_nodes(one, these, known, share, 0, e1)
            _at_nodes(two, these, known, share, 1, e2)
            size = begin[q + 1] - begin[q]
            for n in range(size):
                p = order[begin[q] + n]
                i, j = pinion[p, r], wheel[p, r]
                first_row[n], second_row[n] = i, j
                least[n], best[n] = advance[q, r, 0] + e1[0, i] + e2[0, j], 0
            for k in range(2, known):
                if k == count - 2:  # the nodes next to the ends are those of the ends again
                    continue
                plain = advance[q, r, k]
                for n in range(size):
                    value = plain + e1[k, first_row[n]] + e2[k, second_row[n]]
                    nearer = value < least[n]
                    least[n] = value if nearer else least[n]
                    best[n] = k if nearer else best[n]
            for n in range(size):
                p, k, i, j, near = (
                    order[begin[q] + n],
                    best[n],
                    first_row[n],
                    second_row[n],
                    least[n],
                )
                edge[c, p, r] = 0 if 1 < k < count - 2 else edges[q, r, min(k, 1)]
                if 1 < k < count - 2:
                    low = advance[q, r, k - 1] + e1[k - 1, i] + e2[k - 1, j]
                    high = advance[q, r, k + 1] + e1[k + 1, i] + e2[k + 1, j]
                    near = _least_near(
                        these, k, low - 2.0 * near + high, 0.5 * (high - low), share,
                        one, i, two, j, near, node,
                    )  # fmt: skip
                elif near < math.inf:
                    near = _gap_at(these, k, share, one, i, two, j, near)
                gap[c, p, r] = near + gained[q, r] - lost[q, r] * (edge[c, p, r] > 0)
