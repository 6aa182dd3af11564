"""Permissible film parameter: the figures read, between and beyond them."""

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.heat.film import regime
from thermogear.heat.micropitting import (
    REGIME_LIMITS,
    micropitting_safety,
    permissible_film_parameter,
)


def test_the_figures() -> None:
    nu = np.array([32.0, 100.0, 220.0, 460.0])[:, None] * 1e-6
    found = permissible_film_parameter(nu, load_stage=[5.0, 10.0])
    assert found == pytest.approx(
        np.array([[0.13, 0.055], [0.25, 0.09], [0.40, 0.145], [0.57, 0.20]]), rel=1e-12
    )


def test_thicker_oil_and_a_worse_oil_need_more_film() -> None:
    nu = np.geomspace(29e-6, 500e-6, 40)
    stages = np.linspace(5.0, 10.0, 11)
    found = permissible_film_parameter(nu[:, None], load_stage=stages)
    assert np.all(np.diff(found, axis=0) >= 0.0)
    assert np.all(np.diff(found, axis=1) < 0.0)
    # the straight line in the logarithm: the middle stage is the geometric mean
    assert found[:, 5] == pytest.approx(np.sqrt(found[:, 0] * found[:, 10]), rel=1e-12)
    for one in (28e-6, 520e-6):
        with pytest.raises(InputError, match=r"^lubricant.viscosity_40: got "):
            permissible_film_parameter(one, load_stage=8)
    with pytest.raises(InputError, match=r"^micropitting.load_stage: got 11.0; allowed 5..10$"):
        permissible_film_parameter(100e-6, load_stage=11)


def test_safety() -> None:
    assert micropitting_safety(film_parameter=[[0.4, 0.2], [0.5, 0.6]], permissible=0.2) == (
        pytest.approx([1.0, 2.5])
    )


def test_limits_can_be_used() -> None:
    assert not REGIME_LIMITS["usual"].confirmed
    for limits in REGIME_LIMITS.values():
        low, high = limits.boundary_below, limits.full_film_above
        found = regime([0.9 * low, 1.01 * high], boundary_below=low, full_film_above=high)
        assert list(found) == [0, 2]
