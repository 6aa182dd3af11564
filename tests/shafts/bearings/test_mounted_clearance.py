"""Fits and hot clearance against thick cylinders solved afresh, and their limits."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import Material, material
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing
from thermogear.shafts.bearings.clearance import Fit, mounted_clearance, ring_growth
from thermogear.shafts.bearings.geometry import RollingBearing

CASES = json.loads((Path(__file__).parents[1] / "truth.json").read_text())
STEEL = material("steel")
ALUMINIUM = replace(
    STEEL, name="aluminium", youngs_modulus=70e9, poisson_ratio=0.34, thermal_expansion=23e-6
)
REFERENCE = 293.15


def random_material(rng: np.random.Generator) -> Material:
    return replace(
        STEEL,
        youngs_modulus=10 ** rng.uniform(10.7, 11.4),
        poisson_ratio=rng.uniform(0.2, 0.4),
        thermal_expansion=rng.uniform(8e-6, 25e-6),
    )


def pressed(
    radii: tuple[float, float, float],
    within: tuple[Material, float],
    around: tuple[Material, float],
    interference: float,
) -> tuple[float, float, float]:
    """Growth [m] of the innermost and outermost diameter of two cylinders, and their pressure.

    Four constants u = A r + B/r in plane stress from four conditions; a warm cylinder strains by
    a dT besides.
    """
    inner, fit, outer = radii

    def stress(of: tuple[Material, float], r: float) -> tuple[list[float], float]:
        (made, warm) = of
        e, nu = made.youngs_modulus, made.poisson_ratio
        free = made.thermal_expansion * warm
        return [e / (1 - nu), -e / (1 + nu) / r**2], e / (1 - nu) * free

    def moved(r: float) -> list[float]:
        return [r, 1.0 / r]

    in_fit, in_free = stress(within, fit)
    out_fit, out_free = stress(around, fit)
    edge, edge_free = stress(around, outer)
    if inner > 0.0:
        core, core_free = stress(within, inner)
    else:
        core, core_free = [0.0, 1.0], 0.0
    system = np.array(
        [
            [*core, 0.0, 0.0],
            [0.0, 0.0, *edge],
            [*in_fit, -out_fit[0], -out_fit[1]],
            [-fit, -1.0 / fit, *moved(fit)],
        ]
    )
    right = np.array([core_free, edge_free, in_free - out_free, 0.5 * interference])
    rows = np.abs(system).max(axis=1)
    columns = np.abs(system / rows[:, None]).max(axis=0)
    a = np.linalg.solve(system / rows[:, None] / columns, right / rows) / columns
    inside = 2.0 * (a[0] * inner + (a[1] / inner if inner > 0.0 else 0.0))
    outside = 2.0 * (a[2] * outer + a[3] / outer)
    return inside, outside, float(-(in_fit @ a[:2] - in_free))


def mounted(
    one: RollingBearing, play: float, fit: Fit, warm: np.ndarray, shaft: float, housing: float
) -> float:
    return float(
        mounted_clearance(
            one, play, fit, REFERENCE + warm, shaft_temperature=REFERENCE + shaft,
            housing_temperature=REFERENCE + housing, reference=REFERENCE,
        )
    )  # fmt: skip


def test_mounted_and_hot_as_thick_cylinders_solved_afresh(compared: Compared) -> None:
    """Random rings, shafts, housings, materials, temperatures; loose fits move nothing."""
    rng = np.random.default_rng(61)
    away, kinds = [], set()
    bearings = [one for one in CATALOGUE.values() if one.contact_angle == 0.0]
    for _ in range(120):
        one = bearings[rng.integers(len(bearings))]
        hole, play = one.bore * rng.choice([0.0, rng.uniform(0.1, 0.9)]), rng.uniform(0, 3e-5)
        around = one.outside_diameter * rng.uniform(1.1, 4.0)
        fit = Fit(
            ring=random_material(rng), shaft=random_material(rng), housing=random_material(rng),
            shaft_interference=rng.uniform(-2e-5, 4e-5),
            housing_interference=rng.uniform(-4e-5, 4e-5),
            shaft_bore=hole, housing_outside=around,
        )  # fmt: skip
        warm, shaft, housing = rng.uniform(0, 90, 3), rng.uniform(0, 90), rng.uniform(0, 90)
        own = fit.ring.thermal_expansion
        raceway = one.inner_raceway + 2.0 * one.element_diameter + play
        _, up, p_in = pressed(
            (0.5 * hole, 0.5 * one.bore, 0.5 * one.inner_raceway),
            (fit.shaft, shaft), (fit.ring, warm[0]), fit.shaft_interference,
        )  # fmt: skip
        down, _, p_out = pressed(
            (0.5 * one.outer_raceway, 0.5 * one.outside_diameter, 0.5 * around),
            (fit.ring, warm[2]), (fit.housing, housing), fit.housing_interference,
        )  # fmt: skip
        inner = up if p_in > 0.0 else own * warm[0] * one.inner_raceway
        if p_out > 0.0:  # the ring grows from its own raceway; the play widens that by a trifle
            outer = down + own * warm[2] * (raceway - one.outer_raceway)
        else:
            outer = own * warm[2] * raceway
        ball = own * warm[1] * one.element_diameter
        kinds.add((p_in > 0.0, p_out > 0.0))
        known = 0.5 * (play + outer - inner - 2.0 * ball)
        away.append(mounted(one, play, fit, warm, shaft, housing) - known)
    assert len(kinds) == 4
    compared("mounted and hot radial clearance", "thick cylinders solved afresh", away, 1e-15, "m")


def test_truth_t1_of_a_whole_bearing(compared: Compared) -> None:
    """The same circles as a bearing in loose fits."""
    for name in ("T1", "T1u"):
        p, values = CASES[name]["params"], CASES[name]["values"]
        one = RollingBearing(
            kind="ball", bore=35e-3, outside_diameter=80e-3, width=18e-3, elements=9,
            element_diameter=p["ball"], pitch_diameter=p["inner_raceway"] + p["ball"],
        )  # fmt: skip
        steel = replace(STEEL, thermal_expansion=p["expansion_inner"])
        play = p["outer_raceway"] - p["inner_raceway"] - 2.0 * p["ball"]
        warm = np.array([p[f"T_{part}"] - p["T_ref"] for part in ("inner", "ball", "outer")])
        loose = Fit(ring=steel, shaft=steel, housing=steel, shaft_interference=-1e-4,
                    housing_interference=-1e-4)  # fmt: skip
        found = [mounted(one, play, loose, at, at[0], at[2]) for at in (0.0 * warm, warm)]
        away = np.array(found) / [values["cold"], values["hot"]] - 1.0
        compared(f"clearance of a whole bearing, {name}", "truth", away, CASES[name]["tolerance"])


def test_fit_limits(compared: Compared) -> None:
    """Solid shaft k, thin ring 1, thin hollow shaft 0, rigid partners; the catalogue's range."""
    rng = np.random.default_rng(62)
    solid, thin, hollow = [], [], []
    for _ in range(30):
        fit, k = rng.uniform(10e-3, 80e-3), rng.uniform(0.5, 0.95)
        made = {"within": STEEL, "around": STEEL, "seen": "outer"}
        solid.append(ring_growth(inner=0.0, fit=fit, outer=fit / k, **made) - k)
        thin.append(ring_growth(inner=0.0, fit=fit, outer=fit * (1 + 1e-9), **made) - 1.0)
        hollow.append(ring_growth(inner=fit * (1 - 1e-9), fit=fit, outer=fit / k, **made))
        rigid, soft = (replace(STEEL, youngs_modulus=e) for e in (2e12, 1e7))
        # against a rigid shaft the ring takes all: 2 k/((1 + k^2) + nu (1 - k^2))
        found = ring_growth(
            inner=0.0, fit=fit, outer=fit / k, within=rigid, around=soft, seen="outer"
        )
        nu = STEEL.poisson_ratio
        assert found == pytest.approx(2 * k / (1 + k**2 + nu * (1 - k**2)), rel=1e-4)
    compared("solid shaft of the ring's steel", "k = d/F", solid, 1e-12)
    compared("thin ring", "takes all", thin, 1e-8)
    compared("thin hollow shaft", "gives all", hollow, 1e-7)
    for one in CATALOGUE.values():
        assert 0.75 < one.bore / one.inner_raceway < 0.885
        assert 0.85 < one.outer_raceway / one.outside_diameter < 0.925
    with pytest.raises(InputError, match="fit"):
        ring_growth(inner=26e-3, fit=25e-3, outer=30e-3, within=STEEL, around=STEEL, seen="outer")


def test_one_material_warmed_evenly_keeps_its_clearance(compared: Compared) -> None:
    """c scales by 1 + a dT without fits; with fits of that material the press is as before."""
    rng = np.random.default_rng(63)
    free, held = [], []
    for one in CATALOGUE.values():
        play, warm = rng.uniform(5e-6, 4e-5), rng.uniform(10.0, 100.0)
        even = np.full(3, warm)
        loose = Fit(ring=STEEL, shaft=STEEL, housing=STEEL)
        growth = 1.0 + STEEL.thermal_expansion * warm
        free.append(mounted(one, play, loose, even, warm, warm) - 0.5 * play * growth)
        tight = replace(loose, shaft_interference=15e-6, housing_interference=5e-6)
        cold = mounted(one, play, tight, 0.0 * even, 0.0, 0.0)
        hot = mounted(one, play, tight, even, warm, warm)
        held.append(hot - cold - 0.5 * play * (growth - 1.0))
    compared("clearance warmed evenly", "c (1 + a dT)", free, 1e-16, "m")
    compared("press warmed evenly", "unchanged", held, 1e-16, "m")


def test_clearance_over_a_run_of_temperatures() -> None:
    """Shape of the temperatures; hotter inside closes, hotter outside opens, aluminium lets go."""
    one = catalogue_bearing("6206")
    fit = Fit(ring=STEEL, shaft=STEEL, housing=ALUMINIUM, housing_interference=15e-6)
    rises = np.linspace(0.0, 80.0, 9)
    even = REFERENCE + np.repeat(rises[:, None], 3, axis=1)
    found = mounted_clearance(
        one, 2e-5, fit, even, shaft_temperature=even[:, 0], housing_temperature=even[:, 2],
        reference=REFERENCE,
    )  # fmt: skip
    assert found.shape == rises.shape
    single = [mounted(one, 2e-5, fit, np.full(3, t), t, t) for t in rises]
    assert found == pytest.approx(np.array(single), rel=1e-14)
    lets_go = 15e-6 / (one.outside_diameter * (23e-6 - STEEL.thermal_expansion))
    growing = rises < lets_go
    assert np.all(np.diff(found[growing]) > 1e-7)
    assert np.all(np.abs(np.diff(found[rises > lets_go])) < 1e-8)
    steps = [
        mounted(one, 2e-5, fit, np.array(warm, float), warm[0], warm[2]) - single[0]
        for warm in ((10, 0, 0), (0, 10, 0), (0, 0, 10))
    ]
    assert steps[0] < 0.0
    assert steps[1] < 0.0
    assert steps[2] > 0.0
