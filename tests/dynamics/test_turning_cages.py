"""Cages that turn with the mesh: own equations in time, limits, balances of force and power."""

from __future__ import annotations

import copy
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_laws import BASE

from thermogear.dynamics.geared import GearedModel, LocalBearing
from thermogear.dynamics.ladder import Engine, Steps

FINE = Steps(accuracy=1e-11)
STRONG = 1.5e8 * 1e-5**-0.5
"""As stiff at ten micrometres as the rings of the truth [N/m^1.5]."""


@cache
def trains(**changes: Any) -> tuple[GearedModel, np.ndarray]:
    """The truth's six coordinates on balls, ``changes`` in their bearings, and a start."""
    model, start, _ = moving_six(copy.deepcopy(BASE) | {"e_re": [2e-5], "rpm": 7000.0})
    own = {"coefficient": STRONG * 0.4, "exponent": 1.5, "elements": 8, "angle": 0.3} | changes
    rings = (LocalBearing(**({"directions": b.directions, "base": b.base, "clearance": b.clearance}
                             | own)) for b in model.bearings)  # fmt: skip
    return replace(model, bearings=tuple(rings)), start


def rate(model: GearedModel, t: float, x: np.ndarray) -> np.ndarray:
    """x' as the equations are written, element by element."""
    n, phase = model.size, t * model.mesh_frequency
    q, v = x[:n], x[n:]
    k, e = (float(f(np.array([phase % 1.0]))[0]) for f in (model.mesh_stiffness, model.error))
    slope = float(model.error.derivative()(np.array([phase % 1.0]))[0]) * model.mesh_frequency
    f = model.force - model.damping @ v - model.stiffness @ q
    f = f - k * max(q @ model.drive - e - model.half_backlash, 0.0) * model.drive
    f = f - k * max(q @ model.back + e - model.half_backlash, 0.0) * model.back
    f = f + model.mesh_damping * slope * model.drive
    for one in model.bearings:
        x_, y_ = q @ one.directions
        for j in range(one.elements):
            psi = one.angle + 2.0 * np.pi * (j / one.elements + one.order * phase)
            deep = x_ * np.cos(psi) + y_ * np.sin(psi) - one.clearance
            if deep > 0.0:
                load = one.coefficient * deep**one.exponent
                f = f - load * (one.directions @ [np.cos(psi), np.sin(psi)])
    return np.r_[v, np.linalg.solve(model.mass, f)]


def test_an_integration_of_our_own(compared: Compared) -> None:
    model, start = trains(order=0.0537)
    run = Engine(model, FINE).run(start, 3, turn=11)
    span = np.array([11.0, 14.0]) * model.period
    true = solve_ivp(
        lambda t, x: rate(model, t, x), span, start, method="DOP853", rtol=1e-10, atol=1e-14,
        max_step=model.period / 150.0,
    ).y[:, -1]  # fmt: skip
    n = model.size
    size = np.abs(true[:n] @ model.outputs.T).max()
    away = np.abs((run.state - true)[:n] @ model.outputs.T) / size
    # not restarted where balls touch
    compared("train on turning cages", "DOP853, element by element", away, 1e-6)
    still = Engine(trains()[0], FINE).run(start, 3, turn=11).state
    assert np.abs((still - true)[:n] @ model.outputs.T).max() > 1e-3 * size
    backward = Engine(trains(order=-0.0537)[0], FINE).run(start, 3, turn=11).state
    assert np.abs((backward - true)[:n] @ model.outputs.T).max() > 1e-3 * size


def test_tangents_follow_the_turning_cages(compared: Compared) -> None:
    """The Jacobian by central differences, and its determinant exp(T tr A)."""
    model, start = trains(order=0.0537)
    # the differences are of 1e-5: what a border within a step takes must be less
    engine = Engine(model, Steps(accuracy=1e-13, longest=32, rungs=14))
    at = engine.run(start, 20).state
    run = engine.run(at, 2, tangent=True, turn=20)
    unit = model.return_map().unit
    rng = np.random.default_rng(4)
    away = []
    for _ in range(3):
        step = 1e-5 * unit * rng.uniform(-1.0, 1.0, unit.size)
        ends = [engine.run(at + sign * step, 2, turn=20).state for sign in (1.0, -1.0)]
        true = 0.5 * (ends[0] - ends[1])
        away.append(np.abs((run.jacobian @ step - true) / unit).max() / np.abs(true / unit).max())
    compared("tangent on turning cages", "central differences", away, 2e-4)
    logs = np.linalg.slogdet(run.jacobian)[1] - np.log(model.determinant(2))
    compared("ln det of two periods", "-2 T tr(M^-1 C)", logs, 1e-6)


def test_cages_at_no_speed_stand(compared: Compared) -> None:
    """To the last bit at none; what is left of a slow cage falls with its speed."""
    model, start = trains()
    assert np.array_equal(
        Engine(model).run(start, 4, turn=7).state, Engine(trains(order=0.0)[0]).run(start, 4).state
    )
    ends = [Engine(trains(order=s)[0], FINE).run(start, 4).state for s in (0.0, 1e-5, 2e-5)]
    unit = model.return_map().unit
    apart = [np.abs((end - ends[0]) / unit).max() for end in ends[1:]]
    compared("distance over cage speed", "in proportion", apart[1] / apart[0] - 2.0, 0.02)


@pytest.mark.parametrize("which", ["preloaded", "many"])
def test_what_no_cage_can_change(which: str, compared: Compared) -> None:
    """Elements of a linear law that all carry are a spring Z k/2; so many are a ring."""
    alone: dict[str, Any] = (
        {"exponent": 1.0, "clearance": -60e-6, "coefficient": 4e7}
        if which == "preloaded"
        else {"elements": 256, "coefficient": STRONG * 0.4 * 8 / 256}
    )
    ends = [
        Engine(trains(**alone, order=order)[0], FINE).run(trains()[1], 6).state
        for order in (0.0, 0.0537)
    ]
    unit = trains()[0].return_map().unit
    away = np.abs((ends[1] - ends[0]) / unit).max()
    compared(f"turning beside standing cages, {which}", "the same", away,
             1e-7 if which == "preloaded" else 1e-4)  # fmt: skip


def test_power_and_momentum_close(compared: Compared) -> None:
    """dE/dt = power of loads, error and stiffness less damping, plus what the cages do.

    Energy of masses, springs, flanks and elements; a cage that turns by psi' works on its journal
    with psi' dV/dpsi = -psi' (u_y F_x - u_x F_y), V the energy of its elements.
    """
    model, start = trains(order=0.0537)
    n, samples = model.size, 512
    engine = Engine(model, FINE)
    at = engine.run(start, 20).state
    run = engine.run(at, 4, samples=samples, turn=20)
    phase = 20.0 + run.sample_phase
    x = np.vstack([run.samples, run.state])
    phase = np.append(phase, 24.0)
    q, v = x[:, :n], x[:, n:]
    forces = model.forces(phase, states=x)
    k, error = model.mesh_stiffness(phase), model.error(phase)
    slopes = [f.derivative()(phase) * model.mesh_frequency
              for f in (model.mesh_stiffness, model.error)]  # fmt: skip
    gaps = (q @ model.drive - error - model.half_backlash,
            q @ model.back + error - model.half_backlash)  # fmt: skip
    deep = [np.maximum(gap, 0.0) for gap in gaps]
    energy = 0.5 * np.einsum("si,ij,sj->s", v, model.mass, v)
    energy += 0.5 * np.einsum("si,ij,sj->s", q, model.stiffness, q)
    energy += 0.5 * k * (deep[0] ** 2 + deep[1] ** 2)
    power = v @ model.force - np.einsum("si,ij,sj->s", v, model.damping, v)
    power += model.mesh_damping * slopes[1] * (v @ model.drive)
    power += 0.5 * slopes[0] * (deep[0] ** 2 + deep[1] ** 2)
    power += k * slopes[1] * (deep[1] - deep[0])
    worked = np.zeros(phase.size)
    momentum = model.force - v @ model.damping.T - q @ model.stiffness.T
    momentum += np.outer(model.mesh_damping * slopes[1] - forces["drive"], model.drive)
    momentum -= np.outer(forces["back"], model.back)
    for place, one in enumerate(model.bearings):
        u, f = q @ one.directions, forces["bearings"][:, place]
        psi = 2.0 * np.pi * (np.arange(8) / 8 + one.order * phase[:, None])
        psi = psi + one.angle
        pressed = np.maximum(u[:, :1] * np.cos(psi) + u[:, 1:] * np.sin(psi) - one.clearance, 0.0)
        energy += (one.coefficient * pressed**2.5 / 2.5).sum(axis=1)
        turning = 2.0 * np.pi * one.order * model.mesh_frequency
        worked -= turning * (u[:, 1] * f[:, 0] - u[:, 0] * f[:, 1])
        momentum += f @ one.directions.T
    step = model.period / samples
    total = power + worked
    gained = step * (total.sum() - 0.5 * (total[0] + total[-1]))
    traded = step * np.abs(total).sum()
    compared("energy over four periods", "power, the cages' with it",
             (energy[-1] - energy[0] - gained) / traded, 1e-5)  # fmt: skip
    assert abs(step * worked.sum()) > 1e-4 * traded
    held = step * (momentum.sum(axis=0) - 0.5 * (momentum[0] + momentum[-1]))
    kept = model.mass @ (v[-1] - v[0])
    compared("momentum over four periods", "all forces",
             np.abs(kept - held) / np.abs(model.mass @ np.ptp(v, axis=0)), 1e-5)  # fmt: skip
