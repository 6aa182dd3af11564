"""The drive train by ROSS's Newmark integrator, called as a library with its callback."""

from __future__ import annotations

from typing import Any

import numpy as np
from geared_compiled import Modal
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def _fading(tau: float) -> tuple[float, float, float]:
    """A factor from 1 at 0 to 0 at 1 without slope or curvature at both ends, and its rates."""
    if tau >= 1.0:
        return 0.0, 0.0, 0.0
    return (
        1.0 - tau**3 * (10.0 - 15.0 * tau + 6.0 * tau**2),
        -30.0 * tau**2 * (1.0 - tau) ** 2,
        -60.0 * tau * (1.0 - tau) * (1.0 - 2.0 * tau),
    )


def newmark(modal: Modal, start: Floats, periods: int, steps: int, tolerance: float) -> Floats:
    """delta_d at every step.

    ROSS's integrator starts at rest at zero, so it is given the difference to the start's parabola,
    which fades out over one period: an exact change of variable. In its callback the contacts at
    the end of the step are those of the predicted state, linearised there.
    """
    from ross.utils import newmark as integrate

    n = modal.square.size
    h = 1.0 / (modal.frequency * steps)
    k, e, slope = modal.tables(steps)
    rows, rings, b = modal.outputs, modal.rings, modal.half_backlash
    mass, stiff = np.eye(n), np.diag(modal.square)

    def contacts(z: Floats, at: int) -> tuple[Floats, Floats]:
        """Tangent (n, n), and the force on the right of it, of all contacts at ``z``."""
        y = rows @ z
        right = modal.force + modal.mesh_damping * slope[at] * rows[0]
        tangent = stiff
        if y[0] - e[at] - b > 0.0:
            tangent = tangent + k[at] * np.outer(rows[0], rows[0])
            right = right + k[at] * (e[at] + b) * rows[0]
        if y[1] + e[at] - b > 0.0:
            tangent = tangent + k[at] * np.outer(rows[1], rows[1])
            right = right + k[at] * (b - e[at]) * rows[1]
        for i, (size, exponent, clearance) in enumerate(rings):
            u, d = y[2 + 2 * i : 4 + 2 * i], rows[2 + 2 * i : 4 + 2 * i]
            r = float(np.hypot(*u))
            if r <= clearance:
                continue
            load = size * (r - clearance) ** exponent
            towards = u / r
            own = exponent * load / (r - clearance) * np.outer(towards, towards)
            own = own + load / r * (np.eye(2) - np.outer(towards, towards))
            tangent = tangent + d.T @ own @ d
            right = right + d.T @ (own @ u - load * towards)
        return tangent, right

    z0, v0 = start[:n], start[n:]
    tangent, right = contacts(z0, 0)
    a0 = right - tangent @ z0 - modal.damping @ v0
    period = steps * h

    def carried(t: float) -> tuple[Floats, Floats, Floats]:
        """The fading parabola and its rates."""
        w, w1, w2 = _fading(t / period)
        p, p1 = z0 + t * (v0 + 0.5 * t * a0), v0 + t * a0
        return (
            w * p,
            w1 / period * p + w * p1,
            w2 / period**2 * p + 2.0 * w1 / period * p1 + w * a0,
        )

    def system(step: int, **state: Any) -> tuple[Floats, Floats, Floats, Floats]:
        t = step * h
        q, q1, q2 = carried(t) if t < period else (np.zeros(n),) * 3
        ahead = state["y"] + h * state["ydot"] + 0.5 * h * h * state["y2dot"]
        tangent, right = contacts(ahead + q, step % steps)
        if t < period:
            right = right - q2 - modal.damping @ q1 - tangent @ q
        return mass, modal.damping, tangent, right

    times = h * np.arange(periods * steps + 1)
    found = integrate(system, times, n, tol=tolerance)
    delta = found @ rows[0]
    first = np.array([rows[0] @ carried(t)[0] for t in times[:steps]])
    delta[:steps] += first
    return np.asarray(delta[:-1])
