"""Viscosity and density of oils against the standard's line and published tables."""

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import ZERO_CELSIUS, Lubricant, lubricant
from thermogear.heat.lubrication import (
    density,
    dynamic_viscosity,
    kinematic_viscosity,
    walther_slope,
)

PUBLISHED = {  # mm^2/s at 40, 60, 80, 100 C
    "M68": (67.5, 28.2, 14.4, 8.47),
    "M100": (99.1, 39.2, 19.2, 10.95),
    "M150": (148.9, 55.9, 26.2, 14.45),
    "M220": (218.0, 78.3, 35.4, 18.91),
    "M320": (316.0, 103.3, 43.7, 22.23),
    "P68": (67.5, 32.0, 17.7, 10.96),
    "P100": (99.4, 45.1, 24.0, 14.46),
    "P150": (148.9, 64.5, 33.2, 19.33),
    "P220": (218.1, 90.8, 45.1, 25.58),
    "P320": (311.6, 125.0, 60.2, 33.23),
    "FVA3": (99.4, 39.4, 19.3, 10.99),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_named_oils_against_published_viscosities(name: str, compared: Compared) -> None:
    kelvin = ZERO_CELSIUS + np.array([40.0, 60.0, 80.0, 100.0])
    computed = kinematic_viscosity(lubricant(name), kelvin) * 1e6
    digits = np.array([0.1, 0.1, 0.1, 0.01])  # the table's last digit
    compared(
        "viscosity of the named oils at 40 to 100 °C, in printed digits",
        "computed apart",
        (computed - PUBLISHED[name]) / digits,
        0.6,
    )


def test_m32_at_60_c_of_the_published_fzg_case() -> None:
    """nu 15.12 mm^2/s and eta 13.28 mPa s."""
    oil, warm = lubricant("M32"), ZERO_CELSIUS + 60.0
    assert kinematic_viscosity(oil, warm) * 1e6 == pytest.approx(15.12, abs=0.005)
    assert dynamic_viscosity(oil, warm) * 1e3 == pytest.approx(13.28, abs=0.005)


def test_dynamic_is_kinematic_times_density() -> None:
    oil = lubricant("P220")
    kelvin = np.linspace(280.0, 400.0, 7)
    product = kinematic_viscosity(oil, kelvin) * density(oil, kelvin)
    assert np.array_equal(dynamic_viscosity(oil, kelvin), product)


def test_slope_is_the_logarithmic_derivative() -> None:
    oil, kelvin, step = lubricant("M150"), np.array([300.0, 350.0, 400.0]), 1e-3
    up = np.log(kinematic_viscosity(oil, kelvin + step))
    down = np.log(kinematic_viscosity(oil, kelvin - step))
    assert walther_slope(oil, kelvin) == pytest.approx((down - up) / (2 * step), rel=1e-8)


def test_batch_is_one_by_one() -> None:
    oil = lubricant("M100")
    grid = np.array([[300.0, 320.0], [340.0, 360.0]])
    batch = dynamic_viscosity(oil, grid)
    assert batch.shape == grid.shape
    single = [float(dynamic_viscosity(oil, t)) for t in grid.ravel()]
    assert batch.ravel() == pytest.approx(single, rel=1e-13)


def test_outside_the_fit_warns_with_the_range() -> None:
    oil = lubricant("M100")
    with pytest.warns(ValidityWarning, match=r"180 .. 180 C leaves the range -20 .. 150 C of M100"):
        kinematic_viscosity(oil, ZERO_CELSIUS + 180.0)
    thin = Lubricant.from_two_points("thin", (313.15, 5e-6), (373.15, 1.6e-6))
    with pytest.warns(ValidityWarning, match=r"1.6 mm\^2/s of thin lies below 2 mm\^2/s"):
        kinematic_viscosity(thin, 373.15)


@pytest.mark.parametrize("function", [kinematic_viscosity, density, walther_slope])
def test_negative_kelvin_is_refused(function) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError, match=r"^oil temperature: got -10.0 K; allowed > 0 K, finite$"):
        function(lubricant("M100"), -10.0)
    with pytest.raises(InputError, match=r"^oil temperature: got 0.0 K"):
        function(lubricant("M100"), 0.0)
