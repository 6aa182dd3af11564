"""Published gear and roller contacts that the heat formulas stand on."""

import numpy as np
import pytest
from test_losses import fzg_c

from conftest import Compared
from thermogear.gears.contact import (
    hertz_half_width,
    hertz_pressure,
    reduced_modulus,
    reduced_radius,
)

STEEL = float(reduced_modulus(206e9, 0.3, 206e9, 0.3))


def test_fzg_c_geometry_and_contact(compared: Compared) -> None:
    """r_b 33.829/50.743, r_a 41.318/59.272, T1T2 34.93, AB 6.14, AC 9.68, AD 13.28, AE 19.43.

    Contact ratio 1.46, F_bt 5912.1 N, p_0 1347.3 MPa and half width 199.567 um at the pitch
    point.
    """
    pair = fzg_c()
    pinion, wheel, path = pair.pinion, pair.wheel, pair.path
    assert pinion.base_radius * 1e3 == pytest.approx(33.829, abs=6e-4)
    assert wheel.base_radius * 1e3 == pytest.approx(50.743, abs=6e-4)
    assert pinion.tip_radius * 1e3 == pytest.approx(41.318, abs=6e-4)
    assert wheel.tip_radius * 1e3 == pytest.approx(59.272, abs=6e-4)
    assert pair.line_of_action * 1e3 == pytest.approx(34.93, abs=6e-3)
    distances = [1e3 * (p - path.a) for p in (path.b, path.c, path.d, path.e)]
    assert distances == pytest.approx([6.14, 9.68, 13.28, 19.43], abs=6e-3)
    assert pair.contact_ratio == pytest.approx(1.46, abs=5e-3)
    force = 200.0 / pinion.base_radius
    assert force == pytest.approx(5912.1, abs=0.1)
    radius = reduced_radius(pair, path.c)
    assert hertz_pressure(force / 0.014, radius, STEEL) * 1e-6 == pytest.approx(1347.3, abs=0.3)
    width = hertz_half_width(force / 0.014, radius, STEEL) * 1e6
    compared(
        "Hertzian half width of the FZG C gears",
        "GEARpie's result, 199.567 µm",
        width - 199.567,
        0.05,
        "µm",
    )


def test_nasa_standard_gear(compared: Compared) -> None:
    """28/28, 8 pitch, 20 deg, 10 000 1/min, 5784 N/cm tangential: 46.55 m/s, 1.71 GPa."""
    radius = 14.0 * 25.4e-3 / 8.0
    assert radius * 10000.0 * np.pi / 30.0 == pytest.approx(46.55, abs=5e-3)
    alpha = np.radians(20.0)
    pressure = hertz_pressure(578400.0 / np.cos(alpha), radius * np.sin(alpha) / 2.0, STEEL)
    compared(
        "Hertzian pressure of the NASA test gear",
        "published 1.71 GPa",
        pressure * 1e-9 - 1.71,
        3e-3,
        "GPa",
    )


def test_textbook_roller_contact(compared: Compared) -> None:
    """1500 lb on rollers of 2.5 and 5.0 in over 0.625 in: half width 0.0177 in."""
    inch, pound = 0.0254, 4.4482216
    modulus = reduced_modulus(30e6 * 6894.757, 0.28, 30e6 * 6894.757, 0.28)
    radius = 2.5 * 5.0 / 7.5 * inch
    width = hertz_half_width(1500.0 * pound / (0.625 * inch), radius, modulus)
    compared(
        "half width of two rollers",
        "textbook example, 0.0177 in",
        width / inch - 0.0177,
        5e-5,
        "in",
    )
