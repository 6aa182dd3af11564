"""Gears at rest: free convection against its similarity solution, and where it counts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_bvp

from thermogear import GearPair, Surroundings, thermal_network
from thermogear.base.materials import lubricant
from thermogear.heat.free_convection import oil_expansion, with_free_convection
from thermogear.heat.gearbox import Losses
from thermogear.heat.still_air import free_face_convection

OIL = lubricant("M100")
K, NU, PR = 0.135, 40e-6, 500.0


def nusselt(rayleigh: float, height: float = 0.2) -> float:
    beta = 7e-4
    drop = rayleigh * NU**2 / (9.80665 * beta * height**3 * PR)
    return float(free_face_convection(drop, height, NU, K, PR, expansion=beta)) * height / K


def similarity() -> float:
    """Nu/Ra^(1/4) of an isothermal vertical plate for Pr -> inf, solved here.

    f''' + theta = 0, theta'' + 3 f theta' = 0 with inertia gone: Nu_x = -theta'(0) (Ra_x/4)^(1/4),
    whose mean over the height is 4/3 of its end.
    """

    def slope(z, y):  # type: ignore[no-untyped-def]
        f, df, ddf, theta, dtheta = y
        return np.vstack([df, ddf, -theta, dtheta, -3.0 * f * dtheta])

    def ends(a, b):  # type: ignore[no-untyped-def]
        return np.array([a[0], a[1], b[2], a[3] - 1.0, b[3]])

    z = np.linspace(0.0, 12.0, 200)
    guess = np.vstack([0.3 * z, 0.3 + 0 * z, 0.5 * np.exp(-z), np.exp(-z), -0.5 * np.exp(-z)])
    solved = solve_bvp(slope, ends, z, guess, tol=1e-8)
    assert solved.success
    return float(4.0 / 3.0 * -solved.sol(0.0)[4] / 4.0**0.25)


def test_laminar_layers_are_those_of_the_similarity_solution() -> None:
    slope = similarity()
    assert slope == pytest.approx(0.670, abs=0.002)
    for rayleigh in (1e4, 1e5, 1e6):
        assert nusselt(rayleigh) == pytest.approx(slope * rayleigh**0.25, rel=0.06)
    # then it turns towards the turbulent Ra^(1/3)
    steep = np.log(nusselt(1e12) / nusselt(1e11)) / np.log(10.0)
    assert 0.30 < steep < 1.0 / 3.0


def test_without_a_difference_only_conduction_is_left() -> None:
    assert nusselt(0.0) == pytest.approx(0.825**2)
    warm = free_face_convection(12.0, 0.2, NU, K, PR, expansion=7e-4)
    assert warm == free_face_convection(-12.0, 0.2, NU, K, PR, expansion=7e-4)
    assert oil_expansion(OIL, 333.15) == pytest.approx(6.0e-4, rel=0.02)


@pytest.fixture
def gears(rig: GearPair) -> dict[str, object]:
    return {"pinion": rig.pinion, "wheel": rig.wheel}


def conductances(rig: GearPair, gears: dict[str, object], speed: float) -> list[dict[str, float]]:
    state = {"pinion_tooth": 360.0, "pinion_body": 355.0, "wheel_tooth": 350.0,
             "wheel_body": 345.0, "oil": 330.0}  # fmt: skip
    losses = Losses(mesh=100.0)
    bare = thermal_network(rig.pinion, rig.wheel, speed, losses, OIL, 330.0)
    rest = with_free_convection(bare, gears, OIL, Surroundings(), state)  # type: ignore[arg-type]
    return [
        {f"{link.first}-{link.second}": float(link.conductance) for link in one.links}
        for one in (bare, rest)
    ]


def test_a_gear_at_rest_still_gives_heat_to_its_oil(
    rig: GearPair, gears: dict[str, object]
) -> None:
    bare, rest = conductances(rig, gears, 0.0)
    for name in ("pinion_tooth-oil", "pinion_body-oil", "wheel_tooth-oil", "wheel_body-oil"):
        assert bare[name] == 0.0
        assert rest[name] > 0.1
    others = [name for name in bare if not name.endswith("-oil")]
    assert all(bare[name] == rest[name] for name in others)


def test_a_turning_gear_does_not_notice(rig: GearPair, gears: dict[str, object]) -> None:
    bare, rest = conductances(rig, gears, 20.0)
    assert bare == rest
