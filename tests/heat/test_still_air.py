"""A warm wall in still air: tables of air, the two limits, and what a housing makes of it."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear import Surroundings
from thermogear.heat.still_air import EMISSIVITY, STEFAN_BOLTZMANN, still_air_coefficient

ROOM = 293.15


def radiated(wall: float) -> float:
    exchanged = EMISSIVITY * STEFAN_BOLTZMANN * (wall**4 - ROOM**4)
    return exchanged / (wall - ROOM) if wall > ROOM else 4 * EMISSIVITY * STEFAN_BOLTZMANN * ROOM**3


def test_without_a_difference_radiation_and_conduction_are_left() -> None:
    found = float(still_air_coefficient(ROOM, ambient=ROOM, height=0.3)) - radiated(ROOM)
    # 0.825^2 k/L, k of air in printed tables at 20 C: 0.0257 W/(m K)
    assert found == pytest.approx(0.825**2 * 0.0257 / 0.3, rel=0.01)


@pytest.mark.parametrize("wall", [313.15, 353.15, 453.15])
def test_free_convection_is_that_of_the_simplified_laws_of_air(wall: float) -> None:
    """Laminar vertical walls in air: 1.42 (dT/L)^(1/4) in textbooks, within its usual 15 %."""
    for height in (0.1, 0.3):
        free = float(still_air_coefficient(wall, ambient=ROOM, height=height)) - radiated(wall)
        assert free == pytest.approx(1.42 * ((wall - ROOM) / height) ** 0.25, rel=0.15)


def test_both_ways_the_same_and_growing_with_the_wall() -> None:
    walls = np.linspace(ROOM, 700.0, 60)
    found = still_air_coefficient(walls, ambient=ROOM, height=0.3)
    assert np.all(np.diff(found) > 0.0)
    assert still_air_coefficient(ROOM, ambient=walls, height=0.3) == pytest.approx(found, rel=1e-12)


def test_a_housing_has_its_coefficient_where_it_is_meant() -> None:
    around = Surroundings(housing_area=0.9)
    assert float(around.outside(333.15)) == pytest.approx(15.0, rel=1e-12)
    # the growth is that of the bare wall: twice as much near 300 C as at 60 C
    grown = np.divide(
        *(still_air_coefficient(t, ambient=ROOM, height=0.15**0.5) for t in (573.15, 333.15))
    )
    assert float(around.outside(573.15)) == pytest.approx(15.0 * float(grown), rel=1e-12)
    assert 2.0 < float(grown) < 2.5
    stays = Surroundings(housing_coefficient=12.0, housing_coefficient_at=None)
    assert stays.outside(np.array([300.0, 600.0])).tolist() == [12.0, 12.0]
