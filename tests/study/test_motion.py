"""The proof that travels with every stored motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from said import numbers
from thermogear.base.excitation import Excitations
from thermogear.case.base import Simulation
from thermogear.case.case import gear_case, load_example
from thermogear.case.points import excitations, points_of
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.dynamics.models import TorsionalModel
from thermogear.study.motion import PROOFS, follow, follow_gears

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


def test_motion_of_both_bundles_is_static_towards_standstill_and_none_far_above() -> None:
    """x + e: what a bundle calls error and what deflection is its own, the sum is the gears'."""
    changes = {
        "transmission_error.harmonics": '[{order=1, amplitude="6 um", phase="40 deg"}]',
        "dynamics.damping_ratio": "0.9",
        "grid.mesh_positions": "64",
        "model.bundle": "both",
    }
    case = gear_case(load_example("rig", changes))
    phase = np.arange(64) / 64
    static, every = [], []
    for model in case.models:
        cycle = case.cycle(UNDEFORMED.operating(case, model), model)
        static.append(cycle["transmission_error"].values[0] + case.transmission_error(phase))
        one = excitations(case, cycle).take([0, 0])
        every.append(replace(one, mesh_frequency=one.natural_frequency * [1 / 60, 60.0]))
    found = follow_gears(points_of(Excitations.joined(every)), SIMULATION)
    assert found is not None
    swings = np.reshape(found.values["dte_peak_to_peak"], (2, 2))
    first = int(np.argmin(np.abs(found.motion.order - 1.0)))
    lines = found.values["dte_line"][:, first].reshape(2, 2)
    for swing, line, curve in zip(swings, lines, static, strict=True):
        assert swing[0] == pytest.approx(np.ptp(curve), rel=0.03)
        assert line[0] == pytest.approx(2.0 * abs(np.fft.rfft(curve)[1]) / 64, rel=0.01)
        # the damper alone still pulls: 2 zeta e omega_n/omega
        assert swing[1] < 2.5 * 0.9 / 60.0 * np.ptp(curve)
        assert line[1] < 2.5 * 0.9 / 60.0 * line[0]
