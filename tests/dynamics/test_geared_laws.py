"""Laws that a drive train in motion keeps, on seeded random trains with contact changes."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import expm
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.any_motion import settle
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.pieces import Pieces
from thermogear.dynamics.geared import GearedModel
from thermogear.dynamics.geared_map import GearedMap
from thermogear.dynamics.ladder import Engine, Steps

FINE = Steps(accuracy=1e-11)
BASE: dict[str, Any] = TRUTH["N2"]["params"]


def rattling(rng: np.random.Generator, **changes: Any) -> dict[str, Any]:
    """A six that loses flank and bearing contact, near the truth's."""
    found = copy.deepcopy(BASE)
    found.update(
        rpm=rng.uniform(6500.0, 9000.0), T1=rng.uniform(25.0, 60.0),
        e_re=[rng.uniform(1.5e-5, 3e-5)], e_im=[rng.uniform(-1.5e-5, 0.0)],
        kb=rng.uniform(0.8e8, 2e8), clearance=rng.uniform(3e-6, 10e-6),
        cb=rng.uniform(600.0, 1500.0), b=rng.uniform(3e-5, 6e-5),
    )  # fmt: skip
    return found | changes


def run_of(params: dict[str, Any], periods: int = 6, **changes: Any) -> tuple[Any, GearedModel]:
    model, start, _ = moving_six(params, **changes)
    return Engine(model, FINE).run(start, periods, tangent=True, samples=16), model


def test_the_motions_of_these_tests_lose_contact() -> None:
    rng = np.random.default_rng(11)
    counts = [run_of(rattling(rng), 12)[0].counts for _ in range(4)]
    assert sum(one["losses"] for one in counts) > 4
    assert sum(one["lifts"] for one in counts) > 2


def test_the_determinant_is_that_of_the_trace(compared: Compared) -> None:
    rng = np.random.default_rng(1)
    off = []
    for _ in range(4):
        model, start, _ = moving_six(rattling(rng))
        engine = Engine(model, FINE)
        state = engine.run(start, 5).state
        for _ in range(3):
            # one period at a time: the determinant of more is lost to rounding
            run = engine.run(state, 1, tangent=True)
            off.append(np.linalg.slogdet(run.jacobian)[1] - np.log(model.determinant()))
            state = run.state
    compared("determinant of a rattling train", "exp of the trace", off, 1e-6)


def test_the_jacobian_is_the_derivative(compared: Compared) -> None:
    rng = np.random.default_rng(2)
    worst = []
    for _ in range(3):
        model, start, _ = moving_six(rattling(rng))
        engine = Engine(model, FINE)
        at = engine.run(start, 10).state
        scale = np.r_[np.full(model.size, 1e-10), np.full(model.size, 1e-6)]
        scale[2] = scale[4] = 1e-9
        true = engine.run(at, 2, tangent=True).jacobian
        for column in range(at.size):
            step = np.zeros(at.size)
            step[column] = scale[column]
            ends = [engine.run(at + sign * step, 2).state for sign in (1.0, -1.0)]
            slope = (ends[0] - ends[1]) / (2.0 * scale[column])
            worst.append(np.abs(slope - true[:, column]).max() / np.abs(true[:, column]).max())
    compared("Jacobian of a rattling train", "central differences", worst, 2e-4)


def test_scaling(compared: Compared) -> None:
    rng = np.random.default_rng(3)
    worst = []
    for _ in range(3):
        params = rattling(rng)
        c = rng.uniform(0.3, 3.0)
        other = params | {
            "T1": c * params["T1"], "b": c * params["b"], "clearance": c * params["clearance"],
            "e_re": [c * v for v in params["e_re"]], "e_im": [c * v for v in params["e_im"]],
        }  # fmt: skip
        one, model = run_of(params)
        two, _ = run_of(other)
        deflection = [run.samples[:, : model.size] @ model.drive for run in (one, two)]
        worst.append(np.abs(deflection[1] / c - deflection[0]).max() / np.abs(deflection[0]).max())
    compared("torque, backlash, error and clearance scaled", "the motion scaled", worst, 1e-9)


@pytest.mark.parametrize("turned", [37.0, 180.0])
def test_a_turned_frame(turned: float, compared: Compared) -> None:
    rng = np.random.default_rng(4)
    worst = []
    for _ in range(2):
        params = rattling(rng)
        one, model = run_of(params)
        two, there = run_of(params | {"phi_deg": params["phi_deg"] + turned})
        a = one.samples[:, : model.size] @ model.outputs[:2].T
        b = two.samples[:, : there.size] @ there.outputs[:2].T
        worst.append(np.abs(a - b).max() / np.abs(a).max())
    compared("isotropic bearings, centres turned", "the same motion", worst, 1e-8)


def test_a_train_in_a_mirror(compared: Compared) -> None:
    """Turned the other way about with its centres mirrored, the flanks feel the same."""
    rng = np.random.default_rng(8)
    worst = []
    for _ in range(3):
        params = rattling(rng, phi_deg=rng.uniform(-90.0, 90.0))
        one, model = run_of(params)
        two, there = run_of(params | {"phi_deg": -params["phi_deg"], "sense": -1})
        a = one.samples[:, : model.size] @ model.outputs[:2].T
        b = two.samples[:, : there.size] @ there.outputs[:2].T
        worst.append(np.abs(a - b).max() / np.abs(a).max())
    compared("a train in a mirror", "the same motion", worst, 1e-8)


def test_periods_one_by_one(compared: Compared) -> None:
    rng = np.random.default_rng(5)
    worst = []
    for _ in range(3):
        model, start, _ = moving_six(rattling(rng))
        engine = Engine(model, FINE)
        whole = engine.run(start, 5).sections
        state, single = start, []
        for _ in range(5):
            state = engine.run(state, 1).state
            single.append(state)
        both = (np.asarray(one)[:, : model.size] @ model.drive for one in (whole, single))
        a, b = both
        worst.append(np.abs(a - b).max() / np.abs(a).max())
    compared("five periods at once", "one by one", worst, 1e-8)


def test_power_of_a_period(compared: Compared) -> None:
    """What the torques put in is what the dampers and the error's motion take."""
    rng = np.random.default_rng(6)
    params = rattling(rng, e_re=[3e-5], e_im=[-1.5e-5], rpm=8500.0, T1=40.0)
    params.update({k: BASE[k] for k in ("kb", "clearance", "cb", "b")})
    model, start, _ = moving_six(params)
    engine = Engine(model, FINE)
    run = engine.run(engine.run(start, 3000).state, 1, samples=4096)
    n = model.size
    v = run.samples[:, n:]
    forces = model.forces(run.sample_phase, states=run.samples)
    q = run.samples[:, :n]
    rates = v @ model.drive, v @ model.back
    inner = forces["drive"] * rates[0] + forces["back"] * rates[1]
    inner -= sum(
        np.einsum("sa,sa->s", forces["bearings"][:, b], v @ one.directions)
        for b, one in enumerate(model.bearings)
    )
    step = 1e-5
    phase = run.sample_phase
    slope = (model.error(phase + step) - model.error(phase - step)) / (2.0 * step)
    pushed = model.mesh_damping * slope * model.mesh_frequency * rates[0]
    lost = np.einsum("si,ij,sj->s", v, model.damping, v)
    given = v @ model.force - np.einsum("si,ij,sj->s", v, model.stiffness, q)
    balance = (given + pushed - inner - lost).mean()
    assert run.counts["losses"] > 0
    compared("power over a period", "what is lost", balance / lost.mean(), 1e-4)


def test_stiff_bearings_move_as_one_mass(compared: Compared) -> None:
    from thermogear.dynamics.exact_map import ExactMap
    from thermogear.dynamics.models import DeadZoneModel

    params = copy.deepcopy(BASE) | {
        "clearance": 0.0, "kb": 1e18, "cb": 1e4, "rpm": 9000.0, "T1": 40.0,
        "k_re": [0.3 * BASE["k_mean"]], "k_im": [0.0],
    }  # fmt: skip
    model, start, _ = moving_six(params)
    i1, i2, r1, r2 = (params[k] for k in ("I1", "I2", "rb1", "rb2"))
    mass = i1 * i2 / (i1 * r2**2 + i2 * r1**2)
    f = model.mesh_frequency
    # x = delta_d - e: the error pushes with -e''
    one = DeadZoneModel(
        damping_ratio=0.5 * model.mesh_damping / mass,
        frequency=2.0 * np.pi * f,
        stiffness=model.mesh_stiffness * (1.0 / mass),
        force=model.error.derivative(2) * -(f**2) + params["T1"] / r1 / mass,  # type: ignore[operator]
        half_backlash=params["b"],
    )
    n, e = model.size, model.error
    begin = np.array([start[:n] @ model.drive - e(0.0), -f * e.derivative()(0.0)])
    # few periods: the motion is chaotic, and parts by ten thousand in twenty
    path = ExactMap(one.lanes()).carry(begin, 6)
    run = Engine(model, FINE).run(start, 6)
    own = run.sections[:, :n] @ model.drive - e(0.0)
    assert run.counts["losses"] > 3
    away = (own - path[:, 0]) / params["b"]
    compared("bearings of 1e18 N/m", "one mass, event-exact", away, 1e-8)


def test_no_clearance_and_lasting_contact_is_the_linear_train(compared: Compared) -> None:
    from tests.shafts.trains import six

    from thermogear.shafts.response import error_response
    from thermogear.shafts.statics import equilibrium

    error = 2e-6 - 1e-6j
    params = copy.deepcopy(BASE) | {
        "clearance": 0.0, "k_re": [], "k_im": [], "e_re": [error.real], "e_im": [error.imag],
    }  # fmt: skip
    model, start, kept = moving_six(params)
    engine = Engine(model, FINE)
    run = engine.run(engine.run(start, 3000).state, 1, samples=32)
    line = 2.0 * np.fft.fft(run.samples[:, : model.size] @ kept.basis.T, axis=0)[1] / 32
    assembly = six(params)
    rest = equilibrium(assembly, params["T1"], mesh=params["k_mean"], half_backlash=params["b"])
    speed = params["rpm"] * np.pi / 30.0
    true = error_response(rest.linear(), [speed], order=params["z1"], error=error).displacement[0]
    # the rotation is left out of both in its own way: compare what the teeth and centres do
    rows = [assembly.drive, *(c for place in assembly.bearings for c in place.directions.T)]
    a, b = (np.array(rows) @ one for one in (line, true))
    compared("contact kept, no clearance", "linear response", np.abs(a - b) / np.abs(b).max(), 1e-8)


def test_jumps_of_friction_and_staircases(compared: Compared) -> None:
    params = copy.deepcopy(BASE)
    model, start, _ = moving_six(params)
    rows = np.stack([model.back, model.drive])
    steps = Pieces.constant(starts=[0.0, 0.31, 0.72], values=[0.03, -0.02, 0.01])
    broken = replace(
        model, friction=rows, friction_at_pitch=steps, friction_per_metre=None,
        mesh_stiffness=Pieces.constant(starts=[0.0, 0.6], values=[3.9e8, 3.1e8]),
    )  # fmt: skip
    ends = [
        Engine(broken, how).run(start, 8).state[: model.size] @ model.drive
        for how in (Steps(accuracy=1e-9), Steps(accuracy=1e-12, longest=50, nodes=5, rungs=12))
    ]
    compared("steps in friction and stiffness", "finer steps", ends[0] / ends[1] - 1.0, 1e-8)


def test_what_cannot_move_is_refused() -> None:
    model, start, _ = moving_six(BASE)
    with pytest.raises(InputError, match="half_backlash"):
        replace(model, half_backlash=0.0)
    with pytest.raises(InputError, match="mass"):
        replace(model, mass=np.eye(2))
    with pytest.raises(InputError, match="free motion"):
        Engine(replace(model, bearings=(), stiffness=0.0 * model.stiffness))
    wild = replace(model, damping=-50.0 * np.abs(model.damping).max() * np.eye(model.size))
    with pytest.raises(ConvergenceError, match="runs away"):
        Engine(wild).run(start, 400)


def test_a_train_that_decays_slowly_has_a_label(compared: Compared) -> None:
    """Contact kept: an orbit decays as the train does at rest, which is no bifurcation."""
    params = copy.deepcopy(BASE) | {"rpm": 7200.0, "cb": 10.0, "T1": 80.0}
    model, start, _ = moving_six(params | {"e_re": [2e-7], "e_im": [0.0]})
    section = GearedMap(model=model)
    at_rest = np.abs(np.linalg.eigvals(expm(model.state_matrix * section.period))).max()
    compared("slowest decay of a train", "matrix exponential", section.slowest - at_rest, 1e-12)
    found = settle(section, start)
    assert found.name == "period-1"
    assert abs(found.multiplier) > 0.998
