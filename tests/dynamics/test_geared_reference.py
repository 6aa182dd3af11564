"""The engine against DOP853 restarted at every contact change, which shares no code with it."""

from __future__ import annotations

import copy
from dataclasses import replace
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.conftest import Compared
from tests.dynamics.drive_reference import Plain, Reference, Ring
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_laws import BASE, rattling

from thermogear import Gear, GearPair, Operating, Temperatures
from thermogear.base.materials import lubricant
from thermogear.base.pieces import Pieces
from thermogear.dynamics.geared import GearedModel, LocalBearing
from thermogear.dynamics.ladder import Engine, Steps
from thermogear.mesh.tooth_friction import friction_split

FINE = Steps(accuracy=1e-10)
PERIODS = 3


def plain(model: GearedModel) -> Plain:
    """The same equation as plain arrays."""
    return Plain(
        mass=model.mass, damping=model.damping, stiffness=model.stiffness, force=model.force,
        drive=model.drive, back=model.back, mesh_stiffness=model.mesh_stiffness,
        error=model.error, half_backlash=model.half_backlash, mesh_damping=model.mesh_damping,
        mesh_frequency=model.mesh_frequency,
        bearings=tuple(
            Ring(directions=b.directions, coefficient=b.coefficient, exponent=b.exponent,
                 clearance=b.clearance)
            for b in model.bearings
        ),
    )  # type: ignore[arg-type]  # fmt: skip


def test_random_trains_that_lose_both_flanks(compared: Compared) -> None:
    rng = np.random.default_rng(21)
    fine = Steps(accuracy=1e-11)
    worst, counts = [], {"losses": 0, "impacts": 0, "lifts": 0}
    for _ in range(3):
        model, start, _ = moving_six(rattling(rng, e_re=[2.8e-5], e_im=[-1.3e-5]))
        at = Engine(model, FINE).run(start, 10).state
        run = Engine(model, fine).run(at, PERIODS)
        times = np.arange(1, PERIODS + 1) * model.period
        true = np.asarray(Reference(plain(model)).states(at, np.r_[0.0, times]))[-PERIODS:]
        n = model.size
        away = (run.sections[:, :n] - true[:, :n]) @ model.drive
        worst.append(np.abs(away).max() / np.abs(true[:, :n] @ model.drive).max())
        for key in counts:
            counts[key] += run.counts[key]
    assert min(counts.values()) > 1
    compared("trains that lose both flanks", "DOP853 restarted at changes", worst, 1e-7)


def follow(model: GearedModel, start: np.ndarray, periods: int, stops: Any = ()) -> np.ndarray:
    """DOP853 of the equation as written, restarted at the phases ``stops``."""
    n, period = model.size, model.period

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        phase = np.array([t / period])
        seen = model.forces(phase, states=x[None])
        return np.r_[x[n:], seen["acceleration"][0]]

    marks = sorted({0.0, *stops, 1.0})
    x = start
    for turn in range(periods):
        for a, b in pairwise(marks):
            span = (turn + a + 1e-12) * period, (turn + b - 1e-12) * period
            x = solve_ivp(
                rate, span, x, method="DOP853", rtol=1e-10, atol=1e-14, max_step=period / 150.0
            ).y[:, -1]
    return x


@pytest.mark.parametrize(("elements", "exponent"), [(0, 1.5), (8, 1.5), (9, 10.0 / 9.0)])
def test_bearings_by_a_power_law(elements: int, exponent: float, compared: Compared) -> None:
    params = copy.deepcopy(BASE) | {"e_re": [2e-5], "rpm": 7000.0}
    model, start, _ = moving_six(params)
    # as stiff as the rings of the truth at ten micrometres
    strong = 1.5e8 * 1e-5 ** (1.0 - exponent) * (0.4 if elements else 1.0)
    rings = tuple(
        LocalBearing(
            directions=b.directions, coefficient=strong, exponent=exponent, clearance=b.clearance,
            elements=elements, angle=0.3, base=b.base,
        )
        for b in model.bearings
    )  # fmt: skip
    other = replace(model, bearings=rings)
    run = Engine(other, FINE).run(start, 2)
    true = follow(other, start, 2)
    n = model.size
    away = (run.state - true)[:n] @ model.outputs.T
    size = np.abs(true[:n] @ model.outputs.T).max()
    # the reference is not restarted where balls touch
    compared(f"power {exponent:.3g}, {elements} elements", "DOP853", np.abs(away) / size, 1e-6)


def test_a_jump_of_friction_is_where_it_is_said(compared: Compared) -> None:
    params = copy.deepcopy(BASE)
    model, start, _ = moving_six(params)
    rows = np.stack([0.5 * model.back, model.drive])
    starts = [0.0, 0.37, 0.81]
    broken = replace(
        model, friction=rows,
        friction_at_pitch=Pieces.constant(starts=starts, values=[0.04, -0.03, 0.02]),
        friction_per_metre=Pieces.constant(starts=starts, values=[0.01, 0.02, -0.01]),
    )  # fmt: skip
    run = Engine(broken, FINE).run(start, 3)
    true = follow(broken, start, 3, starts)
    n = model.size
    away = (run.state - true)[:n] @ model.outputs.T / np.abs(true[:n] @ model.outputs.T).max()
    compared("friction that jumps", "DOP853 restarted there", away, 1e-7)


def test_friction_as_it_is_fitted_costs_no_accuracy(compared: Compared) -> None:
    """Pieces meet within 1e-3 only: a step over a place where they meet is wrong by 8e-6."""
    pair = GearPair(Gear(25, 3e-3), Gear(38, 3e-3))
    point = Operating(
        speed=[377.0], torque=[40.0], lubricant=lubricant("FVA3"), oil_temperature=353.15,
        temperatures=Temperatures.uniform(353.15, reference=293.15), half_backlash=40e-6,
    )  # fmt: skip
    (split,) = friction_split(pair, point, accuracy=1e-3)
    assert split is not None
    model, start, _ = moving_six(copy.deepcopy(BASE) | {"rpm": 7000.0})
    rubbed = replace(
        model, friction=np.stack([0.5 * model.back, model.drive]),
        friction_at_pitch=split.at_pitch, friction_per_metre=split.per_metre,
    )  # fmt: skip
    run = Engine(rubbed, Steps(accuracy=1e-9)).run(start, 1)
    true = follow(rubbed, start, 1, split.at_pitch.starts)
    away = (run.state - true)[: model.size] @ model.outputs.T / model.half_backlash
    assert len(split.at_pitch.starts) > 8
    compared("friction in pieces, half backlashes", "DOP853 restarted at each", away, 1e-8)
