"""The drive train in heyoka: Taylor integration stopped at every change of contact."""

from __future__ import annotations

from typing import Any

import numpy as np
from geared_compiled import Modal
from numpy.typing import NDArray

Floats = NDArray[np.float64]

COOLDOWN = 1e-4
"""Share of a period in which heyoka does not look for the same event again. Its own choice, by
tolerance and speed, misses a flank that touches for a moment and parts again."""


class Taylor:
    """One compiled integrator of a train; contacts are flags that terminal events switch."""

    def __init__(self, modal: Modal, tolerance: float) -> None:
        import heyoka as hy

        self.modal = modal
        n, m = modal.square.size, len(modal.outputs)
        z = hy.make_vars(*[f"z{i}" for i in range(n)])
        v = hy.make_vars(*[f"v{i}" for i in range(n)])
        turn = 2.0 * np.pi * modal.frequency

        def wave(series: NDArray[np.complex128], rate: bool = False) -> Any:
            terms = [] if rate else [hy.expression(float(series[0].real))]
            for order, c in enumerate(series[1:], start=1):
                if c == 0.0:
                    continue
                w = turn * order
                cos, sin = hy.cos(w * hy.time), hy.sin(w * hy.time)
                if rate:
                    terms += [float(-c.real * w) * sin, float(-c.imag * w) * cos]
                else:
                    terms += [float(c.real) * cos, float(-c.imag) * sin]
            return hy.sum(terms) if terms else hy.expression(0.0)

        def along(row: Floats, of: Any) -> Any:
            least = 1e-13 * np.abs(row).max()
            return hy.sum(
                [float(a) * one for a, one in zip(row, of, strict=True) if abs(a) > least]
            )

        k, e, slope = wave(modal.k), wave(modal.e), wave(modal.e, rate=True)
        y = [along(row, z) for row in modal.outputs]
        drive, back = y[0] - e - modal.half_backlash, y[1] + e - modal.half_backlash
        push = [modal.mesh_damping * slope - hy.par[0] * k * drive, -hy.par[1] * k * back]
        gaps = [drive, back]
        for i, (size, exponent, clearance) in enumerate(modal.rings):
            x1, x2, flag = y[2 + 2 * i], y[3 + 2 * i], hy.par[2 + i]
            square = x1 * x1 + x2 * x2
            # away from contact the radius is not needed: no root near zero
            r = hy.sqrt(flag * square + (1.0 - flag) * clearance**2)
            deep = r - clearance
            load = -size * flag * (deep if exponent == 1.0 else deep**exponent) / r
            push += [load * x1, load * x2]
            gaps.append(square - clearance**2)
        damping, vectors = self._thinned()
        rates = [along(w, v) for _, w in vectors]
        equations = [(a, b) for a, b in zip(z, v, strict=True)]
        for j in range(n):
            terms = [float(modal.force[j]), float(-modal.square[j]) * z[j]]
            least = 1e-13 * np.abs(damping).max()
            terms += [float(-c) * v[i] for i, c in enumerate(damping[j]) if abs(c) > least]
            for (c, w), rate in zip(vectors, rates, strict=True):
                if abs(w[j]) > 1e-13 * np.abs(w).max():
                    terms.append(float(-c * w[j]) * rate)
            for i in range(m):
                if abs(modal.outputs[i, j]) > 1e-13 * np.abs(modal.outputs[i]).max():
                    terms.append(float(modal.outputs[i, j]) * push[i])
            equations.append((v[j], hy.sum([hy.expression(0.0) + one for one in terms])))
        self.count = len(gaps)
        events = [
            hy.t_event(gap, callback=self._switch(i), cooldown=COOLDOWN / modal.frequency)
            for i, gap in enumerate(gaps)
        ]
        self.changes = 0
        self.integrator = hy.taylor_adaptive(
            equations,
            [0.0] * (2 * n),
            t_events=events,
            pars=[0.0] * self.count,
            tol=tolerance,
            compact_mode=n > 20,
        )

    def _switch(self, place: int) -> Any:
        def callback(ta: Any, sign: int) -> bool:
            ta.pars[place] = 1.0 if sign > 0 else 0.0
            self.changes += 1
            return True

        return callback

    def _thinned(self) -> tuple[Floats, list[tuple[float, Floats]]]:
        """C as a sparse rest and rank-one parts along the outputs (mesh and bearings)."""
        own = self.modal
        even, odd = 0.5 * (own.damping + own.damping.T), 0.5 * (own.damping - own.damping.T)
        columns = [np.outer(w, w) for w in own.outputs if np.any(w)]
        columns += [np.diag(own.square)]
        table = np.stack([one.ravel() for one in columns], axis=1)
        scale = np.maximum(np.linalg.norm(table, axis=0), 1e-300)
        found = np.linalg.lstsq(table / scale, even.ravel(), rcond=1e-14)[0] / scale
        left = even.ravel() - table @ found
        if np.abs(left).max() > 1e-9 * np.abs(even).max():
            return own.damping, []
        rest = (found[-1] * np.diag(own.square)) + odd
        pairs = zip(found[:-1], own.outputs, strict=True)
        # what the parts leave stays in the rest where it is more than rounding
        extra = np.where(np.abs(left) > 1e-15 * np.abs(even).max(), left, 0.0)
        return rest + extra.reshape(rest.shape), [
            (float(c), w) for c, w in pairs if abs(c) > 1e-9 * np.abs(found[:-1]).max()
        ]

    def begin(self, start: Floats) -> None:
        """Set the state (z, z') at phase 0."""
        own, ta = self.modal, self.integrator
        n = own.square.size
        y = own.outputs @ start[:n]
        _, (e, *_), _ = own.tables(1)
        b = own.half_backlash
        radius = np.hypot(y[2::2], y[3::2]) - own.rings[:, 2]
        ta.pars[:] = np.r_[y[0] - e - b, y[1] + e - b, radius] > 0.0
        ta.state[:] = start
        ta.time = 0.0
        ta.reset_cooldowns()

    def run(self, start: Floats, periods: int) -> Floats:
        """The end state, time set back every period so that its rounding does not grow."""
        self.begin(start)
        period = 1.0 / self.modal.frequency
        for _ in range(periods):
            self.integrator.time = 0.0
            self.integrator.propagate_until(period)
        return np.array(self.integrator.state)

    def track(self, start: Floats, periods: int, kept: int = 16) -> Floats:
        """delta_d at ``kept`` phases a period."""
        self.begin(start)
        period, n, found = 1.0 / self.modal.frequency, self.modal.square.size, []
        for _ in range(periods):
            self.integrator.time = 0.0
            for i in range(kept):
                if i:
                    self.integrator.propagate_until(i * period / kept)
                found.append(float(self.modal.outputs[0] @ self.integrator.state[:n]))
            self.integrator.propagate_until(period)
        return np.array(found)
