"""The engine of drive trains against the public truth cases U1, H1, N1 to N3."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.special import erf
from tests.conftest import Compared
from tests.dynamics.geared_trains import from_outputs, moving, moving_six, rig

from thermogear.analysis.orbits import periodic_orbit
from thermogear.base.excitation import Periodic
from thermogear.dynamics.geared import GearedModel, OuterForce
from thermogear.dynamics.ladder import Engine, Steps

TRUTH = json.loads((Path(__file__).parent / "drive_truth.json").read_text())
FINE = Steps(accuracy=1e-12)
SAMPLES = 128
U1 = {
    "lam": complex(-30.0, 900.0), "w0": 400.0, "rate": 4000.0,
    "times": [0.05, 0.1, 0.15, 0.2, 0.25, 0.3],
    "u": [
        0.0006553594084614963 + 0.001731055177360689j,
        -0.0005604344437270059 - 0.004191334767198884j,
        -0.010015697807848594 - 0.006571164885898188j,
        0.0011768897048176756 - 0.0004937578188603094j,
        -0.000652415527622581 - 0.0003863790986678954j,
        -0.0008482658416857859 + 6.929618074688078e-05j,
    ],
}  # fmt: skip
"""One mode u' = lam u + cos(w0 t + rate t^2/2) from rest, and u at six times."""


def case_model(name: str) -> tuple[GearedModel, np.ndarray]:
    params = TRUTH[name]["params"]
    if params.get("system") == "rig30":
        model, start, _ = moving(rig(params), params, 30)
    else:
        model, start, _ = moving_six(params)
    return model, start


@pytest.mark.parametrize("name", ["N1", "N2", "N3"])
def test_periodic_motions_of_the_truth(name: str, compared: Compared) -> None:
    case = TRUTH[name]
    told, allowed = case["values"], case["tolerance"]
    model, start = case_model(name)
    y, rates = told["section"]["y"], told["section"]["ydot"]
    if name != "N3":
        # the state of the section fixes which motion; a little beside it
        start = from_outputs(model, y, rates) * (1.0 + 1e-6)
    orbit = periodic_orbit(model, told["periods"], start, tolerance=1e-12)
    n = model.size
    assert orbit.minimal_period == told["periods"]
    outputs = model.outputs
    compared(
        f"section of {name}", "truth", outputs @ orbit.state[:n] - y, allowed["section_y"], "m"
    )
    away = outputs @ orbit.state[n:] - rates
    compared(f"its rates, {name}", "truth", away, allowed["section_ydot"], "m/s")
    known = np.array([complex(*one) for one in told["multipliers_largest"]])
    found = orbit.multipliers[:4]
    nearest = np.abs(known[:, None] - found[None]).min(axis=1)
    compared(f"multipliers of {name}", "truth", nearest, allowed["multipliers"])
    whole = Engine(model, FINE).run(orbit.state, told["periods"], tangent=True).jacobian
    away = np.linalg.slogdet(whole)[1] - np.log(told["det_exact"])
    compared(f"determinant, {name}", "exp of the trace", away, 1e-6)
    run = Engine(model, FINE).run(orbit.state, told["periods"], samples=SAMPLES)
    x = run.samples[:, :n]
    free = x @ model.drive - model.errors_at(run.sample_phase)[0]
    seen = {"mean": free.mean(), "max": free.max(), "min": free.min(), "std": free.std()}
    off = [seen[key] / told["delta_minus_e"][key] - 1.0 for key in seen]
    compared(f"deflection of {name}", "truth, 128 samples", off, 1e-6)
    forces = model.forces(run.sample_phase, states=run.samples)
    drive = forces["drive"]
    off = [drive.mean() / told["mesh_force"]["mean"] - 1.0]
    off += [drive.max() / told["mesh_force"]["max"] - 1.0, forces["back"].max()]
    compared(f"mesh force of {name}", "truth", off, allowed["forces"])
    for place, ring in enumerate(told["bearings"]):
        force = -forces["bearings"][:, place]
        off = (force.mean(axis=0) - ring["force_mean"]) / np.linalg.norm(ring["force_mean"])
        compared(f"bearing {place + 1} of {name}", "truth", off, allowed["forces"])
        off = [np.linalg.norm(force, axis=1).max() / ring["force_max"] - 1.0]
        compared(f"its greatest force, {name}", "truth", off, allowed["forces"])
    changes = run.counts["events"] - 2 * run.counts["losses"]
    assert run.counts["losses"] == told["contact_changes_flank"] == 0
    assert changes == told["contact_changes_bearing"]


def test_harmonic_balance_with_friction(compared: Compared) -> None:
    case = TRUTH["H1"]
    model, start = case_model("H1")
    state = Engine(model).run(start, 4000).state
    orbit = periodic_orbit(model, 1, state, tolerance=1e-12)
    count = 256
    run = Engine(model, FINE).run(orbit.state, 1, samples=count)
    rows = np.stack(
        [
            model.drive, model.back,
            *(column for one in model.bearings for column in one.directions.T),
        ]
    )  # fmt: skip
    spectrum = np.fft.rfft(run.samples[:, : model.size] @ rows.T, axis=0) / count
    spectrum[1:] *= 2.0
    known = np.array([[complex(*one) for one in case["values"][str(o)]] for o in range(9)])
    compared("H1, orders 0 to 8", "20 harmonics", np.abs(spectrum[:9] - known), 1e-11, "m")


def closed_form(t: float, lam: complex, w0: float, rate: float) -> complex:
    """u of one mode under a chirp, by error functions."""
    total = 0j
    for sign in (1.0, -1.0):
        a, b = sign * 0.5j * rate, -lam + sign * 1j * w0
        root = np.sqrt(-a)
        ends = erf(root * t - b / (2.0 * root)) - erf(-b / (2.0 * root))
        total += np.exp(lam * t - b * b / (4.0 * a)) * np.sqrt(np.pi) / (2.0 * root) * ends
    return complex(0.5 * total)


def test_a_run_up_through_a_resonance(compared: Compared) -> None:
    lam, w0, rate = U1["lam"], U1["w0"], U1["rate"]
    own = [closed_form(t, lam, w0, rate) for t in U1["times"]]  # type: ignore[attr-defined]
    compared("chirp by error functions", "40 digits", np.array(own) - U1["u"], 1e-12)
    model = GearedModel(
        mass=np.eye(1), damping=np.array([[-2.0 * lam.real]]),
        stiffness=np.array([[abs(lam) ** 2]]), force=np.zeros(1), drive=np.zeros(1),
        back=np.zeros(1), mesh_stiffness=Periodic(1.0), error=Periodic(0.0), half_backlash=1e-4,
        mesh_damping=0.0, mesh_frequency=w0 / (2.0 * np.pi),
        outer=(OuterForce(vector=np.ones(1), order=1.0),),
    )  # fmt: skip
    # nothing is felt here, so that no error is seen: fine steps throughout
    engine = Engine(model, Steps(longest=32), ramp=rate / (2.0 * np.pi))
    run = engine.run(np.zeros(2), 40)
    at = np.cumsum(run.times)
    u = engine.modal(run.sections)
    # the mode's own scale: u' = lam u + beta f
    beta = complex(engine.into[0, -1])
    found = (u[:, 0] + 1j * u[:, 1]) / beta
    true = np.array([closed_form(t, lam, w0, rate) for t in at])
    compared("one mode under a chirp", "error functions", found - true, 1e-10)
