"""Mesh stiffness beside ROSS: element values, whole mesh, time per 1000 positions."""

from __future__ import annotations

import time
from typing import Any

import numpy as np

from thermogear.gears import ring
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.stiffness import mesh_stiffness, sainsot_compliance
from thermogear.gears.tooth import tooth_compliances

WIDTH, MODULE, E, NU = 20e-3, 5e-3, 206e9, 0.3
TEETH, BORES = (25, 75), (20e-3, 60e-3)
POSITIONS = 1000
ELEMENTS = {"two pairs": 15.26e9 * WIDTH, "one pair": 11.22e9 * WIDTH}
"""Means of plane-stress finite elements over each region, secant at 200 N/mm [N/m]."""


def regions(curve: np.ndarray) -> dict[str, float]:
    """Mean stiffness of the double- and of the single-pair region of a curve."""
    middle = 0.5 * (curve.min() + curve.max())
    return {"two pairs": curve[curve > middle].mean(), "one pair": curve[curve <= middle].mean()}


def our_pair() -> GearPair:
    from dataclasses import replace

    from thermogear.base.materials import MATERIALS

    steel = replace(MATERIALS["steel"], youngs_modulus=E, poisson_ratio=NU)
    gears = [
        Gear(z, MODULE, face_width=WIDTH, bore_radius=bore, material=steel)
        for z, bore in zip(TEETH, BORES, strict=True)
    ]
    return GearPair(*gears)


def ross_gears() -> tuple[Any, Any, Any]:
    import contextlib
    import io
    import warnings

    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import ross
        from ross.gear_element import GearElementTVMS, Mesh

        steel = ross.Material(name="bench", rho=7850, E=E, Poisson=NU)
        gears = [
            GearElementTVMS(
                n=0, material=steel, width=WIDTH, bore_diameter=2 * bore, module=MODULE, n_teeth=z
            )
            for z, bore in zip(TEETH, BORES, strict=True)
        ]
    return gears[0], gears[1], Mesh


def compare(rounds: int) -> dict[str, Any]:
    """Element values at the pitch point, the mesh over a period, and times, interleaved."""
    pair = our_pair()
    pinion, wheel, mesh = ross_gears()
    elements = []
    for name, ours, theirs in (("pinion", pair.pinion, pinion), ("wheel", pair.wheel, wheel)):
        t = np.array([np.tan(ours.pressure_angle)])
        beam = tooth_compliances(ours, t, "root-circle")
        body = sainsot_compliance(ours, t)
        beta = theirs._to_tau(theirs.pr_angle)
        for part, own, other in (
            ("k_b", beam.bending[0], theirs._inv_kb(beta)),
            ("k_s", beam.shear[0], theirs._inv_ks(beta)),
            ("k_a", beam.axial[0], theirs._inv_ka(beta)),
            ("k_f Sainsot", float(np.ravel(body)[0]), theirs._inv_kf(beta)),
        ):
            elements.append({
                "gear": name, "part": part, "ours": 1 / own, "ross": 1 / other,
                "difference": float(other / own - 1.0),
            })  # fmt: skip

    phase = np.arange(POSITIONS) / POSITIONS
    force = 200e3 * WIDTH
    model = LoadedModel(body="bore_clamped")
    solve_mesh(pair, force, phase[:2], model=model)  # loads the compiled code
    first = []
    for _ in range(rounds):
        ring._foot_matrices.cache_clear()
        before = time.perf_counter()
        solved = solve_mesh(pair, force, phase, model=model)
        first.append(time.perf_counter() - before)
    cold = float(np.median(first))
    textbook = mesh_stiffness(pair, phase, "root-circle")
    times: dict[str, list[float]] = {"ross": [], "ours_loaded": [], "ours_textbook": []}
    curve = np.empty(0)
    for _ in range(rounds):
        before = time.perf_counter()
        built = mesh(pinion, wheel)  # its constructor computes the 1000 positions
        times["ross"].append(time.perf_counter() - before)
        curve = np.asarray(built.stiffness_range)
        before = time.perf_counter()
        solve_mesh(pair, force, phase, model=model)
        times["ours_loaded"].append(time.perf_counter() - before)
        before = time.perf_counter()
        mesh_stiffness(pair, phase, "root-circle")
        times["ours_textbook"].append(time.perf_counter() - before)
    ratio = np.array(times["ross"]) / np.array(times["ours_loaded"])
    tangent = solved.tangent
    against = {
        name: {
            region: float(value / ELEMENTS[region] - 1.0)
            for region, value in regions(np.ravel(values)).items()
        }
        for name, values in (
            ("ross", curve),
            ("ours_loaded", solved.secant),
            ("ours_textbook", textbook),
        )
    }
    return {
        "against_elements": against,
        "elements": elements,
        "positions": POSITIONS,
        "mean": {
            "ross": curve.mean(), "ours_loaded": tangent.mean(), "ours_textbook": textbook.mean(),
        },
        "max": {
            "ross": curve.max(), "ours_loaded": tangent.max(), "ours_textbook": textbook.max(),
        },
        "first_call_s": cold,
        "seconds": {name: float(np.median(values)) for name, values in times.items()},
        "ratio_to_ross": [float(ratio.min()), float(np.median(ratio)), float(ratio.max())],
        "first_call_ratio": float(np.median(times["ross"]) / cold),
    }  # fmt: skip
