"""Small mathematics of the ladder: exponential integrals, roots of polynomials, linear systems."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from thermogear.dynamics.kernels.compiled import part
from thermogear.dynamics.kernels.vector import EIGHT, load, store

Real = NDArray[np.float64]
Complex = NDArray[np.complex128]


@part
def gather(
    table: Real, row: int, rows: int, width: int, weights: Real, at: int, found: Real, place: int
) -> None:
    """found[place:] += sum_r weights[at + r] table[row + r], rows of ``width``, a multiple of 8."""
    for block in range(0, width, EIGHT):
        one = load(found, place + block)
        two = one * 0.0
        three = two
        four = two
        r = 0
        base = row * width + block
        while r + 3 < rows:
            one = one + load(table, base) * weights[at + r]
            two = two + load(table, base + width) * weights[at + r + 1]
            three = three + load(table, base + 2 * width) * weights[at + r + 2]
            four = four + load(table, base + 3 * width) * weights[at + r + 3]
            base += 4 * width
            r += 4
        while r < rows:
            one = one + load(table, base) * weights[at + r]
            base += width
            r += 1
        store(found, place + block, (one + two) + (three + four))


@part
def flows(z: complex, count: int, factorial: Real, out: Complex) -> None:
    """phi_0(z) = e^z, phi_1 .. phi_count: phi_q = (phi_{q-1} - 1/(q-1)!)/z."""
    grown = math.exp(z.real)
    out[0] = complex(grown * math.cos(z.imag), grown * math.sin(z.imag))
    if abs(z.real) + abs(z.imag) >= 1.0:
        inverse = 1.0 / z
        for q in range(1, count + 1):
            out[q] = (out[q - 1] - 1.0 / factorial[q - 1]) * inverse
    else:
        term = 1.0 / factorial[count] + 0.0j
        total = term
        for j in range(1, 16):
            term = term * z / (count + j)
            total += term
        out[count] = total
        for q in range(count - 1, 0, -1):
            out[q] = z * out[q + 1] + 1.0 / factorial[q]


@part
def along(x: float, count: int, places: Real, weights: Real, values: Real) -> float:
    """The polynomial through ``values`` at ``places``, barycentric."""
    top = 0.0
    low = 0.0
    for i in range(count):
        d = x - places[i]
        if d == 0.0:
            return float(values[i])
        w = weights[i] / d
        top += w * values[i]
        low += w
    return top / low


@part
def root_between(
    low: float,
    high: float,
    count: int,
    places: Real,
    weights: Real,
    values: Real,
    rounding: float,
) -> float:
    """The root of the polynomial through ``values`` from ``low`` to ``high``; there signs differ.

    To 1e-13, or a value of ``rounding``. False position, the Illinois rule.
    """
    v_low = along(low, count, places, weights, values)
    v_high = along(high, count, places, weights, values)
    rising = v_high > 0.0
    side = 0
    for _ in range(60):
        if high - low < 1e-13:
            break
        x = (low * v_high - high * v_low) / (v_high - v_low)
        if not (low < x < high):
            x = 0.5 * (low + high)
        v = along(x, count, places, weights, values)
        if (v > 0.0) == rising:
            high, v_high = x, v
            if side == 1:
                v_low *= 0.5
            side = 1
        else:
            low, v_low = x, v
            if side == -1:
                v_high *= 0.5
            side = -1
        if abs(v) < rounding:
            return float(x)
    return float(0.5 * (low + high))


@part
def first_root(
    count: int, places: Real, weights: Real, values: Real, rounding: float, fresh: bool
) -> float:
    """First place in (0, 1] where ``values`` rise above zero; 2 where they do not; 0 at once."""
    if values[0] > rounding and not (fresh and values[1] <= rounding):
        return 0.0
    left = 0
    right = -1
    for i in range(1, count):
        if values[i] > rounding:
            right = i
            break
        left = i
    high = 0.0
    low = places[left]
    if right < 0:
        top = 1
        for i in range(1, count):
            if values[i] > values[top]:
                top = i
        if top == count - 1 or values[top] < -0.5 * abs(values[top - 1] - values[top + 1]):
            return 2.0
        a, b, c = places[top - 1], places[top], places[top + 1]
        va, vb, vc = values[top - 1], values[top], values[top + 1]
        p = (vb - va) / (b - a)
        q = ((vc - vb) / (c - b) - p) / (c - a)
        if q >= 0.0:
            return 2.0
        x = 0.5 * (a + b) - 0.5 * p / q
        if x <= a or x >= c or vb + abs(q) * (c - a) * (c - a) <= 0.0:
            return 2.0
        if along(x, count, places, weights, values) <= rounding:
            return 2.0
        low, high = a, x
        if a == 0.0 and va > -rounding:
            low = 0.5 * x
            while low > 1e-6 * x and along(low, count, places, weights, values) > 0.0:
                low *= 0.5
    else:
        high = places[right]
        if left == 0 and values[0] > -rounding:
            low = 0.5 * high
            while low > 1e-4 * high and along(low, count, places, weights, values) > 0.0:
                low *= 0.5
            if low <= 1e-4 * high:
                return 0.0
    return root_between(low, high, count, places, weights, values, 1e-4 * rounding)


@part
def solve_lu(size: int, columns: int, matrix: Real, right: Real, width: int) -> None:
    """matrix X = right in place, rows exchanged for size; columns ``width`` apart in ``right``."""
    for p in range(size):
        best = p
        for i in range(p + 1, size):
            if abs(matrix[i * size + p]) > abs(matrix[best * size + p]):
                best = i
        if best != p:
            for j in range(size):
                kept = matrix[p * size + j]
                matrix[p * size + j] = matrix[best * size + j]
                matrix[best * size + j] = kept
            for c in range(columns):
                kept = right[c * width + p]
                right[c * width + p] = right[c * width + best]
                right[c * width + best] = kept
        pivot = 1.0 / matrix[p * size + p]
        for i in range(p + 1, size):
            factor = matrix[i * size + p] * pivot
            if factor != 0.0:
                for j in range(p + 1, size):
                    matrix[i * size + j] -= factor * matrix[p * size + j]
                matrix[i * size + p] = factor
    for c in range(columns):
        at = c * width
        for i in range(size):
            total = right[at + i]
            for j in range(i):
                total -= matrix[i * size + j] * right[at + j]
            right[at + i] = total
        for i in range(size - 1, -1, -1):
            total = right[at + i]
            for j in range(i + 1, size):
                total -= matrix[i * size + j] * right[at + j]
            right[at + i] = total / matrix[i * size + i]
