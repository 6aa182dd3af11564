"""The motor's curve, damper and lag against its equivalent circuit, at rest and in motion."""

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.shafts.drive_ends import InductionMotor

RPM = np.pi / 30.0
RATED = 1454.3 * RPM
LINE, PAIRS, PHASE = 100.0 * np.pi, 2, 400.0 / np.sqrt(3.0)
HOT = (234.5 + 95.0) / (234.5 + 20.0)
STATOR, ROTOR = 0.615 * HOT, 0.395 * HOT
LEAK_1, LEAK_2, MAIN = 1.41, 1.95, 42.8
"""7.5 kW, 4 poles, 400 V star, of a public library: resistances [ohm] at 95 C, reactances [ohm]."""


def circuit(slip: np.ndarray) -> np.ndarray:
    """Steady torque [N m] by the circuit of one phase."""
    rotor = ROTOR / slip + 1j * LEAK_2
    both = 1j * MAIN * rotor / (1j * MAIN + rotor)
    current = PHASE / (STATOR + 1j * LEAK_1 + both) * 1j * MAIN / (1j * MAIN + rotor)
    return np.asarray(3.0 * np.abs(current) ** 2 * ROTOR / slip / (LINE / PAIRS))


def moving_circuit(slip: float, frequency: float) -> complex:
    """-dT/dw [N m s] of the circuit at ``frequency`` [Hz], by flux equations in the field's frame.

    psi' = -R i - j (w1, s w1) psi + V, a speed step dw adding j p dw psi_r to the rotor's.
    """
    inductance = np.array([[MAIN + LEAK_1, MAIN], [MAIN, MAIN + LEAK_2]]) / LINE
    inverse = np.linalg.inv(inductance)
    own = -np.diag([STATOR, ROTOR]) @ inverse - 1j * np.diag([LINE, slip * LINE])
    flux = np.linalg.solve(own, [-np.sqrt(2.0) * PHASE, 0.0])
    current = inverse @ flux
    apart = np.block([[own.real, -own.imag], [own.imag, own.real]])
    push = np.array([0.0, 1j * PAIRS * flux[1]])
    moved = np.linalg.solve(2j * np.pi * frequency * np.eye(4) - apart, np.r_[push.real, push.imag])
    with_it = np.kron(np.eye(2), inverse) @ moved
    return complex(
        -1.5 * PAIRS * (
            moved[0] * current[0].imag - moved[2] * current[0].real
            + flux[0].real * with_it[2] - flux[0].imag * with_it[0]
        )
    )  # fmt: skip


def motor(overload: float = 114.8 / 49.25) -> InductionMotor:
    return InductionMotor(
        rated_torque=49.25, rated_speed=RATED, overload=overload, pole_pairs=PAIRS
    )


def test_kloss_passes_the_rated_point_and_its_breakdown(compared: Compared) -> None:
    rng = np.random.default_rng(71)
    away = []
    for _ in range(50):
        pairs, slip = int(rng.integers(1, 5)), rng.uniform(0.005, 0.08)
        top = 100.0 * np.pi / pairs
        one = InductionMotor(
            rated_torque=10 ** rng.uniform(0, 4), rated_speed=(1 - slip) * top,
            overload=rng.uniform(1.5, 4.0), pole_pairs=pairs,
        )  # fmt: skip
        speeds = top * np.array([1.0 - slip, 1.0 - one.breakdown_slip, 1.0])
        known = one.rated_torque * np.array([1.0, one.overload, 0.0])
        away.append((one.torque(speeds) - known) / one.rated_torque)
        step = 1e-6 * top
        slope = (one.torque(one.rated_speed - step) - one.torque(one.rated_speed + step)) / (
            2 * step
        )
        q = slip / one.breakdown_slip
        tangent = one.slip_damping * (1 - q**2) / (1 + q**2)
        assert float(slope) == pytest.approx(tangent, rel=1e-7)
        assert one.torque(1.01 * top) < 0.0
    compared("Kloss at rated, breakdown and no load", "the plate", away, 1e-11)


def test_the_circuit_of_a_public_motor(compared: Compared) -> None:
    """Its own figures, and how far Kloss through (s_k, T_k) falls short at the rated slip."""
    slips = np.linspace(1e-3, 1.0, 100_001)
    torque = circuit(slips)
    found = [torque.max() / 114.8, slips[torque.argmax()] / 0.150, torque[-1] / 38.5]
    compared("breakdown and start of the circuit", "published", np.array(found) - 1.0, 2e-3)
    one = motor()
    rated = float(circuit(np.array([one.rated_slip]))[0])
    compared("circuit at rated slip", "49.25 N m of the plate", rated / 49.25 - 1.0, 0.025)
    through = 2.0 * 114.8 / (one.rated_slip / 0.15 + 0.15 / one.rated_slip)
    assert through / rated - 1.0 == pytest.approx(-0.11, abs=0.005)
    near = np.linspace(0.2, 1.3, 12) * one.rated_slip
    kloss = one.torque((1.0 - near) * one.synchronous_speed)
    compared("Kloss up to 1.3 of the rated slip", "circuit", kloss / circuit(near) - 1.0, 0.11)


def test_damper_behind_a_lag_is_the_circuit_in_motion(compared: Compared) -> None:
    """Complex -dT/dw from standstill to mesh frequency; the damper itself vanishes there."""
    one = motor()
    away = []
    for frequency in (0.01, 1.0, 4.0, 8.0, 16.0, 200.0, 1000.0):
        known = moving_circuit(one.rated_slip, frequency)
        found = one.slip_damping / (1.0 + 2j * np.pi * frequency * one.lag)
        away.append(abs(found - known) / abs(known))
    compared("damper behind a lag", "circuit in motion", away, 0.16)
    slow = moving_circuit(one.rated_slip, 0.01).real
    step = 1e-6
    around = circuit(one.rated_slip + np.array([step, -step]))
    static = (around[0] - around[1]) / (2.0 * step) / one.synchronous_speed
    compared("circuit in slow motion", "slope of the steady circuit", slow / static - 1.0, 1e-5)
    assert abs(moving_circuit(one.rated_slip, 1000.0)) < 0.01 * one.slip_damping


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"rated_torque": 0.0}, "rated_torque"),
        ({"line_frequency": float("nan")}, "line_frequency"),
        ({"pole_pairs": 0}, "pole_pairs"),
        ({"pole_pairs": 3}, "rated_speed"),
        ({"rated_speed": 1454.3}, "rated_speed"),
        ({"rated_speed": 600.0 * RPM}, "breakdown"),
        ({"overload": 1.0}, "overload"),
    ],
)
def test_impossible_motors_are_refused(changes: dict[str, float], field: str) -> None:
    plate = {"rated_torque": 49.25, "rated_speed": RATED, "overload": 2.3, "pole_pairs": PAIRS}
    with pytest.raises(InputError, match=field) as told:
        InductionMotor(**{**plate, **changes})  # type: ignore[arg-type]
    assert "\n" not in str(told.value)
