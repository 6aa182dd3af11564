"""The proof that travels with every stored motion."""

from __future__ import annotations

import numpy as np
import pytest

from said import numbers
from thermogear.case.base import Simulation
from thermogear.dynamics.models import TorsionalModel
from thermogear.study.motion import PROOFS, follow

SIMULATION = Simulation(
    periods=8,
    discard=400,
    most_discarded=8000,
    steps_per_period=64,
    samples=32,
    sample_periods=2,
    initial_state=(0.0, 0.0),
)


def test_every_motion_carries_its_proof() -> None:
    """Published multipliers of the base set (period 2 and 1) and its exponent in chaos."""
    model = TorsionalModel(
        damping_ratio=np.array([0.1535, 0.18, 0.10]),
        frequency=1.245,
        stiffness_amplitude=0.335,
        mean_force=0.017,
        force_amplitude=-1.16,
    )
    values = follow(model, SIMULATION).values
    assert values["label"].tolist() == ["period-2", "period-1", "chaotic"]
    assert values["orbit_period"].tolist() == [2, 1, 0]
    assert values["multiplier_real"][:2] == pytest.approx(
        [0.5119189317744, -0.9421574129], abs=1e-7
    )
    assert values["multiplier_imag"][:2] == pytest.approx([0.0, 0.0])
    assert values["multiplier_modulus"][:2] == pytest.approx([0.5119189318, 0.9421574129], abs=1e-7)
    assert np.isnan(values["multiplier_modulus"][2])
    exponent, error = values["lyapunov_exponent"][2], values["lyapunov_error"][2]
    assert exponent == pytest.approx(0.0487557, abs=3.0 * float(error) + 2e-3)
    assert np.isnan(values["lyapunov_exponent"][:2]).all()
    assert set(PROOFS) <= set(values)
    assert values["followed_periods"][2] >= 32_000
    assert values["followed_periods"][:2].tolist() == [0, 0]
    assert values["followed_starts"][2] == 16
    assert 16.0 in numbers(values["label_reason"][2])


def test_a_complex_pair_is_stored_by_its_upper_half() -> None:
    """Lasting contact with eps = 0: mu = exp((-zeta + i sqrt(1 - zeta^2)) 2 pi/w)."""
    values = follow(
        TorsionalModel(
            damping_ratio=np.array([0.05]),
            frequency=0.7,
            stiffness_amplitude=0.0,
            mean_force=0.3,
            force_amplitude=0.05,
        ),
        SIMULATION,
    ).values
    turn = 2.0 * np.pi / 0.7
    expected = np.exp(turn * (-0.05 + 1j * np.sqrt(1.0 - 0.05**2)))
    assert values["multiplier_real"][0] == pytest.approx(expected.real, abs=1e-12)
    assert values["multiplier_imag"][0] == pytest.approx(abs(expected.imag), abs=1e-12)
    assert values["multiplier_modulus"][0] == pytest.approx(abs(expected), abs=1e-12)
