"""What the last sections of one trajectory prove: a label, or that nothing closes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.agreement import Told
from thermogear.analysis.lyapunov import Lyapunov
from thermogear.analysis.orbits import Orbit, shoot
from thermogear.base.arrays import Floats
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.return_map import return_map

NEAR_BORDER = 0.998
SETTLED = 1e-7
CLOSE = 1e-5
SMALL = 1e-4
"""A multiplier below it is written as a power of ten: six decimals would leave little of it."""


@dataclass(frozen=True)
class Label(Told):
    """What a trajectory settles on.

    ``name`` is "period-n", "chaotic", "diverged" or "undecided"; ``period`` n (0: none found;
    also given for an undecided motion that seems to close). What proves it: ``orbit`` with
    its Floquet multipliers, or ``lyapunov`` with its error. ``reason`` says it in words,
    ``discarded`` how many periods went by before. ``starts`` that differ by rounding share the
    label; of a chaotic motion all of them were ``followed`` so many periods and none closed: an
    estimate, for chaos may end later.
    """

    lyapunov: Lyapunov | None = None

    @property
    def multipliers(self) -> NDArray[np.complex128] | None:
        """Floquet multipliers of the orbit, when there is one."""
        return None if self.orbit is None else self.orbit.multipliers

    def __str__(self) -> str:
        return self.words


def proves_chaos(proof: Lyapunov) -> bool:
    """Whether an exponent is above 0 by four standard errors, and in both halves of its record."""
    half = proof.batches.size // 2
    return (
        bool(np.all(np.isfinite(proof.batches)))
        and proof.value > 4.0 * proof.error
        and bool(proof.batches[:half].mean() > 0.0)
        and bool(proof.batches[half:].mean() > 0.0)
    )


def periodic(
    lane: Lanes, window: Floats, *, max_period: int, elapsed: int, near_border: float
) -> tuple[Label | None, bool]:
    """The label the last sections support, and whether no lag comes near closing."""
    if not np.all(np.isfinite(window)):
        return Label("diverged", 0, "|x| > 1e6 half backlashes or not finite", elapsed), False
    unit = lane.unit[0]
    scaled = window / unit
    gaps = [
        float(np.max(np.abs(scaled[-lag:] - scaled[-2 * lag : len(scaled) - lag])))
        for lag in range(1, max_period + 1)
    ]
    close = np.flatnonzero(np.array(gaps) < CLOSE)
    if close.size == 0:
        return None, min(gaps) > 10.0 * CLOSE
    lag = int(close[0]) + 1
    section = return_map(lane)
    orbit = shoot(section, window[-1], lag)
    if orbit is None or not orbit.stable:
        return None, False
    period = orbit.minimal_period
    if period != lag:
        # a spiral returns close after several of its periods
        shorter = shoot(section, orbit.state, period)
        if shorter is None:
            return None, False
        orbit = shorter
    if lane.mesh_periods > 1:
        # without its maps, which are large: they are made again where they are asked for
        orbit = replace(orbit, section=return_map(lane))
    points = orbit.points / unit
    largest = float(np.max(np.abs(orbit.multipliers)))
    shown = f"largest Floquet multiplier {_shown(orbit)} over {period} "
    shown += ("period" if lane.mesh_periods == 1 else "turn") + "s" * (period > 1)
    # the window against the orbit, in step: its last state is the orbit's first point
    if not _on(points, scaled):
        return None, False
    if period > 1:
        others = [np.max(np.abs(points[k] - points[0])) for k in range(1, period)]
        closure = max(orbit.residual, 1e-12)
        if not np.min(others) > 1e3 * closure:
            return Label("undecided", period, "shorter lags nearly close", elapsed, orbit), False
    if not largest <= near_border:
        reason = f"{shown}: within {1.0 - near_border:.2g} of a bifurcation"
        return Label("undecided", period, reason, elapsed, orbit), False
    return Label(f"period-{period}", period, shown, elapsed, orbit), False


def _shown(orbit: Orbit) -> str:
    mu = orbit.multipliers[0]
    value = mu.real if mu.imag == 0.0 else abs(mu)
    text = f"{value:.6f}" if abs(value) >= SMALL else f"{value:.5e}"
    return text if mu.imag == 0.0 else f"|{text}|"


def closing(scaled: Floats, max_period: int) -> bool:
    """Whether the whole window nearly repeats after some lag: one chance return does not."""
    return any(
        np.max(np.abs(scaled[lag:] - scaled[:-lag])) < 10.0 * CLOSE
        for lag in range(1, max_period + 1)
    )


def returned(lane: Lanes, window: Floats, first: Label, elapsed: int) -> Label | None:
    """The label ``first`` where the last sections lie on its orbit, in any of its phases."""
    if first.orbit is None:
        return None
    unit = lane.unit[0]
    scaled, points = window / unit, first.orbit.points / unit
    place = int(np.argmin(np.max(np.abs(points - scaled[-1]), axis=1)))
    turned = np.roll(points, -place, axis=0)
    return replace(first, discarded=elapsed) if _on(turned, scaled) else None


def _on(points: Floats, scaled: Floats) -> bool:
    """Whether sections are on an orbit and come nearer; the last is next to its first point."""
    turned = points[(np.arange(len(scaled)) - (len(scaled) - 1)) % len(points)]
    away = np.max(np.abs(scaled - turned), axis=1)
    early, late = float(away[: len(away) // 2].max()), float(away[len(away) // 2 :].max())
    return late <= SETTLED and (late <= 1e-10 or late < early)
