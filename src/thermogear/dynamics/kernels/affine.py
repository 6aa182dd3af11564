"""The affine maps of a piecewise-linear oscillator on the sub-steps of its period.

Between contact changes x'' + c x' + k(t) (x - r b) = F(t) is linear, r = 1 on the drive side,
0 inside the backlash (where k acts on nothing), -1 on the back side. On a sub-step of half
width h, u in [-1, 1],

    x(u) - r b = phi(u) (x_0 - r b) + psi(u) y_0 + nu(u),     y = dx/dt,

with polynomials centred on the sub-step that depend on parameters only. ``maps`` holds their
values at u = 1, ``polys`` the coefficients.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Real = NDArray[np.float64]

PHI, PSI, NU, FREE_PSI, FREE_NU = 0, 1, 2, 3, 4


@njit(nogil=True, cache=True, error_model="numpy")
def prepare(
    damping: Real,
    half: Real,
    stiffness: Real,
    force: Real,
    maps: Real,
    polys: Real,
) -> None:
    """Fill ``maps`` (N, 10, lane) and ``polys`` (N, lane, 5, K + 1).

    ``damping`` (lane), ``half`` (N, lane) half widths in time, ``stiffness`` and ``force``
    (N, lane, K + 1): Taylor coefficients in u of k and F about the centre of each sub-step.
    """
    count, lanes, width = stiffness.shape
    order = width - 1
    work = np.empty((5, width))
    for n in range(count):
        for lane in range(lanes):
            h = half[n, lane]
            ch = damping[lane] * h
            hh = h * h
            # from the centre: cosine-like, sine-like and forced solution, contact then free
            work[:] = 0.0
            work[0, 0] = 1.0
            work[1, 1] = 1.0
            work[3, 1] = 1.0
            for m in range(order - 1):
                s0 = 0.0
                s1 = 0.0
                s2 = 0.0
                for i in range(m + 1):
                    k = stiffness[n, lane, i]
                    s0 += k * work[0, m - i]
                    s1 += k * work[1, m - i]
                    s2 += k * work[2, m - i]
                scale = 1.0 / ((m + 2.0) * (m + 1.0))
                drag = ch * (m + 1.0)
                push = hh * force[n, lane, m]
                work[0, m + 2] = -(drag * work[0, m + 1] + hh * s0) * scale
                work[1, m + 2] = -(drag * work[1, m + 1] + hh * s1) * scale
                work[2, m + 2] = (push - (drag * work[2, m + 1] + hh * s2)) * scale
                work[3, m + 2] = -drag * work[3, m + 1] * scale
                work[4, m + 2] = (push - drag * work[4, m + 1]) * scale
            # values and slopes at the left end u = -1
            left = np.zeros(5)
            slope = np.zeros(5)
            for q in range(5):
                value = 0.0
                rate = 0.0
                for m in range(order, 0, -1):
                    sign = -1.0 if m % 2 else 1.0
                    value += sign * work[q, m]
                    rate -= sign * m * work[q, m]
                left[q] = value + work[q, 0]
                slope[q] = rate
            # hand the free constants to the left end: phi, psi, nu
            det = left[0] * slope[1] - left[1] * slope[0]
            a = slope[1] / det
            b = -slope[0] / det
            c = -h * left[1] / det
            d = h * left[0] / det
            e = (left[1] * slope[2] - slope[1] * left[2]) / det
            f = (slope[0] * left[2] - left[0] * slope[2]) / det
            g = h / slope[3]
            r = -slope[4] / slope[3]
            for m in range(width):
                polys[n, lane, PHI, m] = a * work[0, m] + b * work[1, m]
                polys[n, lane, PSI, m] = c * work[0, m] + d * work[1, m]
                polys[n, lane, NU, m] = work[2, m] + (e * work[0, m] + f * work[1, m])
                polys[n, lane, FREE_PSI, m] = g * work[3, m]
                polys[n, lane, FREE_NU, m] = work[4, m] + r * work[3, m]
            polys[n, lane, FREE_PSI, 0] -= g * left[3]
            polys[n, lane, FREE_NU, 0] -= left[4] + r * left[3]
            for q in range(5):
                value = 0.0
                rate = 0.0
                for m in range(order, 0, -1):
                    value += polys[n, lane, q, m]
                    rate += m * polys[n, lane, q, m]
                maps[n, 2 * q, lane] = value + polys[n, lane, q, 0]
                maps[n, 2 * q + 1, lane] = rate / h


@njit(nogil=True, cache=True, error_model="numpy")
def add_harmonics(
    real: Real,
    imag: Real,
    cosine: Real,
    sine: Real,
    even: Real,
    odd: Real,
    which: NDArray[np.int64],
    out: Real,
) -> None:
    """Add the Taylor coefficients of harmonics to ``out`` (N, lane, K + 1).

    ``real``, ``imag`` (rank, lane) of their coefficients, ``cosine``, ``sine`` (rank, N) of their
    angles at the centres; ``even``, ``odd`` (width, rank, K + 1) the derivatives of a cosine over
    the factorials where half a sub-step is one of several widths, ``which`` (N) of them.
    """
    for n in range(out.shape[0]):
        for lane in range(out.shape[1]):
            row = out[n, lane]
            for k in range(real.shape[0]):
                whole = real[k, lane] * cosine[k, n] - imag[k, lane] * sine[k, n]
                turned = real[k, lane] * sine[k, n] + imag[k, lane] * cosine[k, n]
                some = even[which[n], k]
                rest = odd[which[n], k]
                for m in range(row.size):
                    row[m] += whole * some[m] + turned * rest[m]
