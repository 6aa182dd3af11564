"""Motion of many operating points: label, history, section and spectrum, as arrays to store."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.labels import labels
from thermogear.analysis.proof import Label
from thermogear.base.arrays import Floats
from thermogear.base.period import turns
from thermogear.base.vocabulary import STATUS, STILL
from thermogear.case.base import Simulation
from thermogear.case.points import Points
from thermogear.case.response import lost_share
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import ClearanceModel
from thermogear.signals.spectra import amplitude_spectrum, order_amplitudes

Advance = Callable[[int, int], None]

HIGHEST_ORDER = 20.0
"""Spectral lines are kept up to this order of the mesh frequency."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """Settled motion of ``points`` lanes; numbers are dimensionless (X = x/b_c, omega_n t).

    Arrays have the lane first: ``displacement``, ``velocity`` (lane, sample) at ``phase`` (in
    mesh periods, of which the model repeats after ``mesh_periods``);
    ``section_displacement``, ``section_velocity`` (lane, section);
    ``line_amplitude`` (lane, order) at ``order``. Lanes that diverged are NaN.
    """

    phase: Floats
    order: Floats
    discarded: int
    periods: int
    mesh_periods: int
    values: dict[str, NDArray[np.generic]]

    @property
    def bin_width(self) -> float:
        """Distance of two spectral lines in orders."""
        return 1.0 / self.periods


def follow(
    model: ClearanceModel,
    simulation: Simulation,
    advance: Advance | None = None,
    error: Floats | None = None,
) -> Motion:
    """Label every lane of ``model``, then follow it long enough to draw it.

    The transient thrown away is the longest any lane's label needed, at least
    ``simulation.discard`` periods and at most ``most_discarded``. With ``error`` e (lane, sample)
    over one period of the model, a mesh period or a turn, the movement of one base circle against
    the other, x + e, is told too. All counts are of mesh periods, rounded up to whole turns.
    """
    state = simulation.initial_state
    found = labels(
        model,
        initial_state=state,
        discard=max(simulation.discard, 1),
        cap=max(simulation.most_discarded, simulation.discard, 1),
        progress=advance,
    )
    discard = max(
        simulation.discard,
        min(max(one.discarded for one in found), simulation.most_discarded),
    )
    # an even number of mesh periods, in whole turns, holds the half-order line exactly
    of = int(getattr(model, "mesh_periods", 1))
    periods = turns(simulation.periods, of=of) * of
    periods += periods % 2 * of
    data = simulate(
        model,
        periods=periods,
        discard=discard,
        steps_per_period=simulation.steps_per_period,
        samples_per_period=simulation.samples,
        initial_state=state,
    )
    x = data["x"].values
    spectrum = amplitude_spectrum(x, float(simulation.samples))
    kept = spectrum.frequencies <= HIGHEST_ORDER
    shown = simulation.samples * min(simulation.sample_periods, periods)
    diverged = data["status"].values != 0
    status = np.where(diverged, STATUS.index("diverged"), STATUS.index("ok")).astype(np.int8)
    share = data["time_share"].sel(side="drive").values if "time_share" in data else None
    impacts = data["back_impacts"].values / periods if "back_impacts" in data else None
    missing = np.full(x.shape[0], np.nan)
    values: dict[str, NDArray[np.generic]] = {
        "displacement": x[:, -shown:],
        "velocity": data["v"].values[:, -shown:],
        "section_displacement": data["section_x"].values[:, 1:],
        "section_velocity": data["section_v"].values[:, 1:],
        "line_amplitude": spectrum.amplitudes[:, kept],
        "half_order_amplitude": order_amplitudes(
            x, samples_per_period=simulation.samples, periods=periods, orders=[0.5]
        )[..., 0],
        "peak_to_peak_displacement": x.max(axis=1) - x.min(axis=1),
        "contact_loss_share": missing if share is None else lost_share(share),
        "back_impacts": missing if impacts is None else impacts,
        "status": status,
        "label": np.array([one.name for one in found]),
        "label_reason": np.array([one.reason for one in found]),
        **proofs(found),
    }
    if error is not None:
        whole = x + np.tile(error, periods // of)
        values["dte_peak_to_peak"] = np.ptp(whole, axis=1)
        values["dte_line"] = amplitude_spectrum(whole, float(simulation.samples)).amplitudes[
            :, kept
        ]
    return Motion(
        phase=np.arange(shown) / simulation.samples,
        order=spectrum.frequencies[kept],
        discarded=discard,
        periods=periods,
        mesh_periods=of,
        values=values,
    )


PROOFS = (
    "orbit_period",
    "multiplier_real",
    "multiplier_imag",
    "multiplier_modulus",
    "lyapunov_exponent",
    "lyapunov_error",
    "followed_periods",
    "followed_starts",
)
"""What a label rests on: n and the largest Floquet multiplier, or lambda_1 with its error and for
how many periods chaos was followed; and how many starts that differ by rounding share it."""


WHOLE = ("orbit_period", "followed_periods", "followed_starts")


def proofs(found: Sequence[Label]) -> dict[str, NDArray[np.generic]]:
    """:data:`PROOFS` of every label; a period of 0 and NaN where there is no such proof.

    The multiplier is the largest over the whole orbit, of a complex pair the one above the real
    axis; lambda_1 is per omega_n t.
    """
    rows = []
    for one in found:
        mu = complex(np.nan, np.nan) if one.orbit is None else complex(one.orbit.multipliers[0])
        rate = (np.nan, np.nan)
        if one.lyapunov is not None:
            rate = (one.lyapunov.value, one.lyapunov.error)
        rows.append((one.period, mu.real, mu.imag, abs(mu), *rate, one.followed, one.starts))
    columns = np.array(rows, dtype=float).reshape(-1, len(PROOFS)).T
    values: dict[str, NDArray[np.generic]] = dict(zip(PROOFS, columns, strict=True))
    for name in WHOLE:
        values[name] = values[name].astype(np.int32)
    return values


@dataclass(frozen=True, eq=False)
class GearMotion:
    """:class:`Motion` in SI over a whole array of points, those that do not move included.

    ``values`` map names to arrays of the points' shape, then sample, section or order;
    points that do not move are NaN, their label says why.
    """

    motion: Motion
    values: dict[str, NDArray[np.generic]]


def follow_gears(
    points: Points, simulation: Simulation, advance: Advance | None = None
) -> GearMotion | None:
    """Motion of every point that moves; None when none does."""
    alive = np.flatnonzero(~points.still)
    if not alive.size:
        return None
    present = points.take(alive)
    length, rate = present.length, present.rate
    count = simulation.samples * points.mesh_periods
    error = present.kinematic(np.arange(count) / count)
    motion = follow(present, simulation, advance, error / length[:, None])
    scales: dict[str, Any] = {"velocity": length * rate, "section_velocity": length * rate}
    plain = {"contact_loss_share", "back_impacts", "status", "label", "label_reason", *PROOFS}
    values: dict[str, NDArray[np.generic]] = {}
    missing = dict.fromkeys(WHOLE, 0) | still_values(points.status)
    for name, rows in motion.values.items():
        if name not in plain:
            rows = rows * scales.get(name, length).reshape(-1, *([1] * (rows.ndim - 1)))
        values[name] = _spread(rows, alive, len(points.status), missing.get(name, np.nan))
    return GearMotion(motion, values)


def still_values(status: NDArray[np.int8]) -> dict[str, NDArray[np.generic]]:
    """Status, label and reason of points that do not move, from their ``status``."""
    labels = np.array([word.replace("_", " ") for word in STATUS])
    reasons = np.array([STILL.get(word, "") for word in STATUS])
    return {"status": status, "label": labels[status], "label_reason": reasons[status]}


def _spread(
    rows: NDArray[np.generic], places: NDArray[np.int64], count: int, missing: object
) -> NDArray[np.generic]:
    """``rows`` put at ``places`` of ``count``, ``missing``, one or one each, elsewhere."""
    words = rows.dtype.kind == "U"
    spread = np.empty((count, *rows.shape[1:]), dtype=object if words else rows.dtype)
    spread[...] = missing
    spread[places] = rows
    return spread.astype(str) if words else spread
