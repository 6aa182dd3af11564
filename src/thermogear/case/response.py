"""What a settled motion means for the gears: transmission error, mesh force, dynamic factor."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.settle import Rule
from thermogear.base.arrays import Floats
from thermogear.base.plan import Alive, Arrays, Variable, keep_going
from thermogear.base.vocabulary import moves
from thermogear.case.points import Points
from thermogear.dynamics import exact
from thermogear.signals.spectra import order_amplitudes

VALUES: dict[str, tuple[str, str]] = {
    "dte_mean": ("m", "dynamic transmission error, mean"),
    "dte_rms": ("m", "dynamic transmission error, rms about its mean"),
    "dte_peak_to_peak": ("m", "dynamic transmission error, peak to peak"),
    "mesh_force_max": ("N", "dynamic mesh force, greatest"),
    "mesh_force_min": ("N", "dynamic mesh force, least; below 0 on the back flank"),
    "mesh_force_rms": ("N", "dynamic mesh force, rms about its mean"),
    "dynamic_factor": ("1", "dynamic factor: greatest mesh force over its mean"),
    "mesh_frequency": ("Hz", "mesh frequency"),
    "frequency_ratio": ("1", "mesh frequency over natural frequency"),
    "half_backlash": ("m", "hot half backlash"),
    "contact_loss_share": ("1", "share of time out of drive-side contact"),
}


@dataclass(frozen=True, kw_only=True)
class Recording:
    """How a settled motion is recorded: ``periods`` of ``samples`` points each.

    ``order_step`` and ``highest_order`` of the spectral lines kept.
    """

    periods: int = 32
    samples: int = 128
    order_step: float = 0.5
    highest_order: float = 10.0

    def in_orders_of(self, mesh_periods: int) -> Recording:
        """The same record with every line of a turn of ``mesh_periods``, as high as it has room.

        That is with steps of 1/L, the orders of both shafts, their side lines at the mesh and the
        hunting tooth among them, up to order :data:`LEAST_HIGHEST` of the mesh at least.
        """
        if mesh_periods == 1:
            return self
        highest = max(LEAST_HIGHEST, MOST_LINES // mesh_periods)
        return replace(
            self,
            order_step=1.0 / mesh_periods,
            highest_order=min(self.highest_order, float(highest)),
        )

    @property
    def orders(self) -> Floats:
        """Orders of the mesh frequency, from the first step on."""
        count = round(self.highest_order / self.order_step)
        return np.arange(1, count + 1) / round(1.0 / self.order_step)

    @property
    def coordinate(self) -> tuple[tuple[str, ...], Floats, dict[str, Any]]:
        """:attr:`orders` as the axis of stored lines."""
        return ("order",), self.orders, {"units": "1", "long_name": "order of the mesh frequency"}


RECORD = Recording()
RULE = Rule(first=128, cap=8192, settled=1e-6, chaos_periods=1000)
"""How long the motion of gears is followed in run-ups and sweeps."""
ROUNDING = 1e-12
MOST_LINES, LEAST_HIGHEST = 4000, 3
"""Lines of a turn that are kept, and the order of the mesh up to which they are at least."""


def response_variables(dims: tuple[str, ...]) -> dict[str, Variable]:
    """The stored variables over ``dims``, with spectral lines over ``order``."""
    found = {
        name: Variable(dims, "float64", float("nan"), {"units": unit, "long_name": words})
        for name, (unit, words) in VALUES.items()
    }
    found["dte_line"] = Variable(
        (*dims, "order"),
        "float64",
        float("nan"),
        {"units": "m", "long_name": "amplitude of a line of the transmission error (peak)"},
    )
    return found


def lost_share(drive_share: Floats) -> Floats:
    """Share of time out of drive-side contact [-], 0 where contact lasts but for rounding."""
    free = np.clip(1.0 - np.asarray(drive_share, dtype=float), 0.0, 1.0)
    return np.where(free < ROUNDING, 0.0, free)


def respond(
    points: Points,
    state: Floats,
    record: Recording,
    *,
    lines: bool,
    alive: Alive = keep_going,
) -> Arrays:
    """Figures of the motion that goes on from ``state`` (point, 2) at phase 0; NaN where jammed.

    DTE = x + e with x the relative displacement of the flanks from the middle of the gap; the
    mesh force is the elastic one, k f(x), over its mean for the dynamic factor. ``record`` counts
    periods of the tables and samples of one.
    """
    count = len(points.status)
    found: dict[str, NDArray[Any]] = {name: np.full(count, np.nan) for name in VALUES}
    if lines:
        found["dte_line"] = np.full((count, record.orders.size), np.nan)
    moving = np.flatnonzero(moves(points.status) & np.isfinite(state).all(axis=1))
    for part, borders, marks in exact.layouts(points.flat.take(moving), samples=record.samples):
        alive()
        index = moving[part]
        lanes = points.flat.take(index)
        maps = exact.prepare_maps(lanes, borders, marks)
        run = exact.State.start(x=state[index, 0], y=state[index, 1], backlash=lanes.half_backlash)
        _, _, samples = exact.advance(maps, run, record.periods, sampled=True)
        x = np.ascontiguousarray(samples[:, 0].T)
        each = figures_of_record(points.take(index), x, record, lines=lines)
        for name, values in each.items():
            found[name][index] = values
        drive = run.spent[2] / (record.periods * lanes.period)
        found["contact_loss_share"][index] = lost_share(drive)
    here = moves(points.status)
    found["mesh_frequency"][here] = points.mesh_frequency[here] / (2.0 * np.pi)
    found["frequency_ratio"][here] = (points.mesh_frequency / points.rate)[here]
    found["half_backlash"][here] = points.half_backlash[here]
    return found


def figures_of_record(
    points: Points, x: Floats, record: Recording, *, lines: bool
) -> dict[str, Floats]:
    """The figures of motions ``x`` (point, sample) from phase 0 of the tables on, as ``record``.

    With ``lines`` those of its orders.
    """
    phase = np.arange(record.samples) / record.samples
    length, b = points.length[:, None], points.flat.half_backlash[:, None]
    periods = 1, record.periods
    dte = length * x + np.tile(points.kinematic(phase), periods)
    stiffness = np.tile(points.flat.values("stiffness", phase).T, periods)
    force = (points.stiffness[:, None] * length) * stiffness * (x - np.clip(x, -b, b))
    loaded, greatest = points.force > 0.0, np.abs(force).max(axis=1)
    found = {
        "dte_mean": dte.mean(axis=1),
        "dte_rms": dte.std(axis=1),
        "dte_peak_to_peak": np.ptp(dte, axis=1),
        "mesh_force_max": force.max(axis=1),
        "mesh_force_min": force.min(axis=1),
        "mesh_force_rms": force.std(axis=1),
        "dynamic_factor": np.divide(
            greatest, points.force, out=np.full(greatest.shape, np.inf), where=loaded
        ),
    }
    if lines:
        found["dte_line"] = order_amplitudes(
            dte,
            samples_per_period=record.samples,
            periods=record.periods,
            orders=record.orders * points.mesh_periods,
        )
    return found
