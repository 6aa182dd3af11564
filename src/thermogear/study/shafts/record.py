"""What a settled drive train shows: forces, accelerations and their lines over its record."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.dynamics.ladder import Engine, Run
from thermogear.study.shafts.moving import MovingTrain

SAMPLES = 64
"""Samples a mesh period."""
PERIODS = 16
"""Mesh periods of a record without forces at shaft orders."""
HARMONICS = 12
SHOWN = 4
"""Mesh periods of the histories that are kept."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Record:
    """One settled motion at uniform phases, (sample,) [mesh periods].

    ``mesh_force`` and ``back_force`` [N], ``deflection`` of the drive flank less its error [m],
    ``bearing_force`` (sample, bearing, 2) [N] on the rings, damping not in it, ``housing`` (sample,
    2) acceleration [m/s^2], nan where the housing is fixed. ``sections`` (period, 2): delta_d [m]
    and its rate [m/s] at every mesh phase 0. ``counts`` and ``shares`` of the engine.
    ``journal_path`` (sample, bearing, 2) [m]: each journal against its outer ring; a force on the
    ring points the same way. ``bearing_contact`` (bearing,): the share of the samples in which a
    bearing carries; ``bearing_losses`` (bearing,): how often it ceases to from one sample to the
    next, the end of the record included.
    """

    phase: Floats
    mesh_force: Floats
    back_force: Floats
    deflection: Floats
    bearing_force: Floats
    housing: Floats
    sections: Floats
    counts: dict[str, int]
    shares: Floats
    state: Floats
    journal_path: Floats
    bearing_contact: Floats
    bearing_losses: NDArray[np.int64]


def recorded(train: MovingTrain, state: Floats, periods: int, *, turn: float = 0.0) -> Record:
    """``periods`` mesh periods from ``state`` (d,) on, ``turn`` mesh periods after the start."""
    return shown(train, Engine(train.model).run(state, periods, samples=SAMPLES, turn=turn), turn)


def shown(train: MovingTrain, run: Run, turn: float) -> Record:
    """Forces and accelerations along the samples of a ``run`` of ``train``."""
    model, own = train.model, train.state.assembly
    phase = turn + run.sample_phase
    n = model.size
    found = model.forces(phase, states=run.samples)
    q = run.samples[:, :n]
    rings = np.zeros((phase.size, len(own.bearings), 2))
    path = np.zeros((phase.size + 1, len(own.bearings), 2))
    held = np.ones((phase.size + 1, len(own.bearings)), dtype=bool)
    after = np.append(phase, phase[-1:] + 1.0 / SAMPLES)
    closed = np.vstack([run.samples, run.state])[:, :n]
    local = 0
    for number, place in enumerate(own.bearings):
        u = closed @ train.reduction.vector(place.directions)
        path[:, number] = u
        if place.bearing.law.linear:
            rings[:, number] = -place.bearing.law.force(u[:-1])
        else:
            rings[:, number] = -found["bearings"][:, local]
            held[:, number] = model.bearings[local].depth(u, phase=after) > 0.0
            local += 1
    housing = np.full((phase.size, 2), np.nan)
    for axis, name in enumerate(("casing.x", "casing.y")):
        if name in own.index:
            row = train.reduction.basis[own.index[name]]
            housing[:, axis] = found["acceleration"] @ row
    points = run.samples[::SAMPLES]
    return Record(
        phase=phase,
        mesh_force=found["drive"],
        back_force=found["back"],
        deflection=q @ model.drive - model.errors_at(phase)[0],
        bearing_force=rings,
        housing=housing,
        sections=np.stack([points[:, :n] @ model.drive, points[:, n : 2 * n] @ model.drive], 1),
        counts=run.counts,
        shares=run.shares,
        state=run.state,
        journal_path=path[:-1],
        bearing_contact=held[:-1].mean(axis=0),
        bearing_losses=(held[:-1] & ~held[1:]).sum(axis=0),
    )


def orders_of_lines(teeth: tuple[int, int], *, shafts: bool) -> Floats:
    """Orders of the mesh frequency whose lines are kept.

    Quarters up to the 12th harmonic; with ``shafts`` the harmonics, their halves and two sidebands
    of either shaft on both sides, and the shafts' own orders.
    """
    if not shafts:
        return np.arange(1, 4 * HARMONICS + 1) / 4.0
    beside = [k / z for z in teeth for k in (-2, -1, 1, 2)]
    found = {h + b for h in range(HARMONICS + 1) for b in [0.0, *beside]}
    found |= {h - 0.5 for h in range(1, HARMONICS + 1)}
    return np.array(sorted(one for one in {round(o, 9) for o in found} if one > 0.0))


def ball_pass_lines(passing: ArrayLike) -> Floats:
    """Orders of the mesh frequency of lines where elements pass at the orders ``passing``.

    m p and h -+ m p for m = 1, 2 and mesh harmonics h up to the 12th; nan: no element passes.
    """
    own = np.unique(np.asarray(passing, dtype=float))
    own = own[np.isfinite(own)]
    every = np.add.outer(np.arange(HARMONICS + 1.0), np.outer([-2.0, -1.0, 1.0, 2.0], own))
    return np.unique(np.round(every[(every > 0.0) & (every <= HARMONICS)], 9))


def torus_orders(second: float, *, curves: int = 1) -> Floats:
    """Orders k/n + m nu of a motion with the second frequency nu, in mesh frequencies.

    n closed ``curves``; k/n up to the 12th harmonic, m up to two either way.
    """
    own = np.arange(HARMONICS * curves + 1) / curves
    found = np.add.outer(own, second * np.arange(-2, 3)).ravel()
    return np.unique(np.round(found[(found > 1e-9) & (found <= HARMONICS + 1e-9)], 9))


def lines(values: ArrayLike, *, orders: ArrayLike) -> Floats:
    """Amplitudes (order, ...) of lines at any ``orders`` of samples (sample, ...), Hann window.

    Peak values; lines nearer than two over the periods of the record are not told apart.
    """
    x = np.asarray(values, dtype=float)
    count = x.shape[0]
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    window = window / window.sum()
    shape = x.shape[1:]
    flat = (x - x.mean(axis=0)).reshape(count, -1) * window[:, None]
    angle = -2j * np.pi / SAMPLES * np.arange(count)
    found = [np.exp(order * angle) @ flat for order in np.asarray(orders, dtype=float).ravel()]
    return np.asarray(2.0 * np.abs(np.array(found)).reshape(-1, *shape))
