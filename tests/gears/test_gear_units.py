"""Every public formula of the floor in two coherent systems of units: only the units differ.

Lengths, forces and times are counted in other units; a result must change by the factor of
its own dimension and by nothing else, which a missing or wrong unit cannot do.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from dataclasses import replace
from types import ModuleType
from typing import NamedTuple

import numpy as np
import pytest

from thermogear.base.materials import MATERIALS
from thermogear.gears import (
    contact,
    corner,
    loaded,
    ring,
    sharing,
    stiffness,
    tooth,
    touch,
    turn,
)
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import BasePitchDifference, Deviation, PitchError, Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair


class Units(NamedTuple):
    """How many new units one metre, newton and second are."""

    length: float = 1.0
    force: float = 1.0
    time: float = 1.0


OTHER = Units(7.3, 0.37, 60.0)

# powers of length, force and time
NUMBER, LENGTH, SPEED = (0, 0, 0), (1, 0, 0), (1, 0, -1)
COMPLIANCE, STIFFNESS, STRESS = (1, -1, 0), (-1, 1, 0), (-2, 1, 0)


def factor(dimension: tuple[int, int, int]) -> float:
    """By what a quantity of that dimension grows in the other units."""
    return float(np.prod([u**p for u, p in zip(OTHER, dimension, strict=True)]))


class Given(NamedTuple):
    """Arguments in one system of units."""

    pair: GearPair
    gear: Gear
    s: np.ndarray
    t: np.ndarray
    omega: float
    force: float
    width: float
    load: float
    radius: float
    half: float
    depth: float
    young: float
    phase: np.ndarray
    amount: float


def given(u: Units) -> Given:
    young = 206e9 * u.force / u.length**2
    steel = replace(MATERIALS["steel"], youngs_modulus=young)

    def gear(teeth: int, shift: float) -> Gear:
        m = 5e-3 * u.length
        return Gear(teeth, m, profile_shift=shift, face_width=4.0 * m, material=steel)

    pair = GearPair(gear(25, 0.2), gear(75, -0.1))
    s = np.linspace(pair.path.a, pair.path.e, 7)
    return Given(
        pair,
        pair.pinion,
        s,
        s / pair.pinion.base_radius,
        100.0 / u.time,
        4e3 * u.force,
        20e-3 * u.length,
        2e5 * u.force / u.length,
        15e-3 * u.length,
        0.2e-3 * u.length,
        4e-3 * u.length,
        young,
        np.array([0.03, 0.4, 0.8]),
        8e-6 * u.length,
    )


def solved(g: Given) -> loaded.LoadedMesh:
    flanks: list[Deviation] = [
        Relief("wheel", amount=g.amount, length=0.3 * g.pair.base_pitch),
        PitchError("pinion", tuple(0.1 * g.amount * np.cos(np.arange(25)))),
        BasePitchDifference(2e-4),
    ]
    return loaded.solve_mesh(g.pair, g.force, g.phase, deviations=flanks)


Formula = Callable[[Given], object]
FORMULAS: dict[str, tuple[tuple[int, int, int], Formula]] = {
    "path_of_contact": (LENGTH, lambda g: contact.path_of_contact(g.pair)),
    "pair_positions": (LENGTH, lambda g: contact.pair_positions(g.pair, g.phase)),
    "mirror_position": (LENGTH, lambda g: contact.mirror_position(g.pair)),
    "back_flank_position": (LENGTH, lambda g: contact.back_flank_position(g.pair, g.s)),
    "curvature_radii": (LENGTH, lambda g: contact.curvature_radii(g.pair, g.s)),
    "flank_radii": (LENGTH, lambda g: contact.flank_radii(g.pair, g.s)),
    "reduced_radius": (LENGTH, lambda g: contact.reduced_radius(g.pair, g.s)),
    "rolling_velocities": (SPEED, lambda g: contact.rolling_velocities(g.pair, g.omega, g.s)),
    "sliding_velocity": (SPEED, lambda g: contact.sliding_velocity(g.pair, g.omega, g.s)),
    "sum_velocity": (SPEED, lambda g: contact.sum_velocity(g.pair, g.omega, g.s)),
    "entrainment_velocity": (SPEED, lambda g: contact.entrainment_velocity(g.pair, g.omega, g.s)),
    "reduced_modulus": (STRESS, lambda g: contact.reduced_modulus(g.young, 0.3, g.young, 0.2)),
    "pair_reduced_modulus": (STRESS, lambda g: contact.pair_reduced_modulus(g.pair)),
    "hertz_half_width": (LENGTH, lambda g: contact.hertz_half_width(g.load, g.radius, g.young)),
    "hertz_pressure": (STRESS, lambda g: contact.hertz_pressure(g.load, g.radius, g.young)),
    "yang_sun_stiffness": (
        STIFFNESS,
        lambda g: stiffness.yang_sun_stiffness(g.young, g.width),
    ),
    "weber_approach": (
        LENGTH,
        lambda g: stiffness.weber_approach(
            g.force,
            depth=g.depth,
            half_width=g.half,
            modulus=g.young,
            poisson=0.3,
            face_width=g.width,
        ),
    ),
    "palmgren_approach": (
        LENGTH,
        lambda g: stiffness.palmgren_approach(g.force, g.young, g.width),
    ),
    "contact_point": (LENGTH, lambda g: corner.contact_point(g.pair, 1.02 * g.s)[:3]),
    "off_path": (NUMBER, lambda g: corner.off_path(g.pair, 1.02 * g.s)),
    "pinion_point": (LENGTH, lambda g: corner.pinion_point(g.pair, g.s, rho=1.02 * g.s)[:2]),
    "wheel_point": (LENGTH, lambda g: corner.wheel_point(g.pair, g.s, rho=1.02 * g.s)[:2]),
    "flank_ends": (LENGTH, lambda g: corner.flank_ends(g.pair)),
    "first_touch": (LENGTH, lambda g: touched(g, [relieved(g, 1.0)])),
    "first_touch of teeth that differ": (LENGTH, lambda g: touched(g, differing(g))),
    "touch_of_parts": (LENGTH, lambda g: touched_parts(g)),
    "tooth_angle": (NUMBER, lambda g: turn.tooth_angle(g.pair, "wheel")),
    "turn_period": (NUMBER, lambda g: turn.turn_period(g.pair, differing(g)).mesh_periods),
    "numbered_from": (
        LENGTH,
        lambda g: touched(g, [turn.numbered_from(g.pair, d, wheel=3) for d in differing(g)]),
    ),
    "mean_tooth": (LENGTH, lambda g: touched(g, turn.mean_tooth(g.pair, differing(g)))),
    "flank_point": (LENGTH, lambda g: tooth.flank_point(g.gear, g.t)[:2]),
    "start_angle": (NUMBER, lambda g: tooth.start_angle(g.gear, "30-degree")),
    "section_angle": (NUMBER, lambda g: tooth.section_angle(g.gear, 0.5)),
    "tooth_compliances": (COMPLIANCE, lambda g: tooth.tooth_compliances(g.gear, g.t)),
    "unit_compliance": (NUMBER, lambda g: tooth.unit_compliance(g.gear, g.t)),
    "sainsot_coefficients": (
        NUMBER,
        lambda g: list(
            stiffness.sainsot_coefficients(
                g.gear.root_half_angle, ratio=g.gear.root_radius / g.gear.bore_radius
            ).values()
        ),
    ),
    "sainsot_compliance": (COMPLIANCE, lambda g: stiffness.sainsot_compliance(g.gear, g.t)),
    "rim_compliance": (
        NUMBER,
        lambda g: ring.rim_compliance(
            [1, 2, 5], outer=g.gear.root_radius, inner=g.gear.bore_radius, poisson=0.3
        ),
    ),
    "foot_load": (NUMBER, lambda g: ring.foot_load(g.gear, g.t)),
    "body_matrices": (NUMBER, lambda g: ring.body_matrices(g.gear)[0]),
    "ring_compliance": (COMPLIANCE, lambda g: ring.ring_compliance(g.gear, g.t, pitches=1)),
    "pair_compliances": (
        COMPLIANCE,
        lambda g: stiffness.pair_compliances(g.pair, g.s).total,
    ),
    "pair_stiffness": (STIFFNESS, lambda g: stiffness.pair_stiffness(g.pair, g.s)),
    "mesh_stiffness": (STIFFNESS, lambda g: stiffness.mesh_stiffness(g.pair, g.phase)),
    "mesh_figures": (STIFFNESS, lambda g: stiffness.mesh_figures(g.pair)),
    "equal_share": (NUMBER, lambda g: sharing.equal_share(g.pair, g.s)),
    "stiffness_share": (NUMBER, lambda g: sharing.stiffness_share(g.pair, g.s)),
    "solve_mesh": (LENGTH, lambda g: solved(g).deflection),
    "solve_mesh forces": ((0, 1, 0), lambda g: solved(g).force),
    "solve_mesh pressure": (STRESS, lambda g: solved(g).pressure),
    "solve_mesh springs": (STIFFNESS, lambda g: (solved(g).tangent, solved(g).secant)),
    "loaded_contact": (
        LENGTH,
        lambda g: loaded.loaded_contact(g.pair, g.force, g.phase).transmission_error.values,
    ),
}
MODULES = (
    contact,
    corner,
    loaded,
    ring,
    sharing,
    stiffness,
    tooth,
    touch,
    turn,
)


def relieved(g: Given, times: float) -> Relief:
    """So many times a steep relief."""
    return Relief("pinion", amount=times * g.amount, length=0.3 * (g.pair.path.e - g.pair.path.a))


def differing(g: Given) -> list[Deviation]:
    """Reliefs that differ from tooth to tooth, and an eccentric wheel."""
    shapes = tuple(relieved(g, 1.0 + 0.01 * tooth) for tooth in range(25))
    run_out = turn.Eccentricity("wheel", amount=g.amount, angle=0.3)
    return [turn.ToothShapes("pinion", shapes), run_out]


def touched(g: Given, deviations: Sequence[Deviation]) -> np.ndarray:
    """Gaps at positions where every candidate is in reach."""
    gap = touch.first_touch(mesh_points(g.pair, g.phase), deviations).gap
    return np.where(gap < g.gear.module, gap, 0.0)


def touched_parts(g: Given) -> np.ndarray:
    """Gaps of a part whose teeth differ and of one whose teeth are alike."""
    parts = [differing(g), [relieved(g, 1.0)]]
    gap = touch.touch_of_parts(mesh_points(g.pair, g.phase), parts, 0.0)[0].gap
    return np.where(gap < g.gear.module, gap, 0.0)


@pytest.mark.parametrize("name", FORMULAS)
def test_formula_is_the_same_in_any_coherent_units(name: str) -> None:
    dimension, formula = FORMULAS[name]
    here, there = (np.asarray(formula(given(u)), dtype=float) for u in (Units(), OTHER))
    expected = factor(dimension) * here
    scale = float(np.nanmax(np.abs(expected)))
    np.testing.assert_allclose(there, expected, rtol=1e-9, atol=1e-12 * scale)


def formulas_of(module: ModuleType) -> set[str]:
    return {
        name
        for name, member in inspect.getmembers(module, inspect.isfunction)
        if member.__module__ == module.__name__ and not name.startswith("_")
    }


def test_no_public_formula_is_left_out() -> None:
    public = set().union(*(formulas_of(module) for module in MODULES))
    assert public == {name.split(" ")[0] for name in FORMULAS}
