"""ISO 6336-1 method B against worked examples and limits."""

from __future__ import annotations

import math

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import ValidityWarning
from thermogear.gears.geometry import Gear, GearPair
from thermogear.gears.iso6336 import (
    iso6336_stiffness,
    single_stiffness,
    theoretical_single_stiffness,
    virtual_teeth,
)

RIG = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))


def test_reference_pair(compared: Compared) -> None:
    got = iso6336_stiffness(RIG)
    assert 1e9 / float(got.theoretical) == pytest.approx(0.0568892, abs=1e-7)
    values = np.array([got.theoretical, got.single, got.mesh], dtype=float)
    compared(
        "ISO 6336 stiffness of the reference pair",
        "computed apart",
        values / (17.578e9, 13.711e9, 21.057e9) - 1.0,
        5e-5,
    )


def test_worked_example_of_the_technical_report(compared: Compared) -> None:
    """ISO/TR 6336-30 example 1: m_n 8, 17/103, x 0.145/0, beta 15.8 deg, h_fP 1.4."""
    alpha, beta = math.radians(20.0), math.radians(15.8)
    theory = theoretical_single_stiffness(
        virtual_teeth(17, beta, alpha), virtual_teeth(103, beta, alpha), 0.145, 0.0
    )
    single = float(single_stiffness(theory, 1.4, alpha, beta))
    compared(
        "ISO 6336 stiffness",
        "ISO/TR 6336-30, example 1",
        [float(theory) / 17.8558e9 - 1.0, single / 12.3705e9 - 1.0],
        5e-6,
    )
    assert float(virtual_teeth(17, 0.0, alpha)) == 17.0


def test_low_load_and_order_of_the_gears() -> None:
    high, at, low, none = iso6336_stiffness(RIG, np.array([500e3, 100e3, 6.25e3, 0.0])).single
    assert high == at
    assert low == pytest.approx(0.5 * at, rel=1e-12)
    assert none == 0.0
    shifted = GearPair(Gear(25, 5e-3), Gear(75, 5e-3, profile_shift=0.2))
    assert float(iso6336_stiffness(shifted).single) == pytest.approx(
        float(iso6336_stiffness(shifted.swapped()).single), rel=1e-12
    )


def test_shifts_outside_the_source() -> None:
    pair = GearPair(Gear(80, 5e-3, profile_shift=-0.3), Gear(90, 5e-3, profile_shift=-0.3))
    with pytest.warns(ValidityWarning, match=r"the sum is -0\.6; range of ISO 6336-1"):
        iso6336_stiffness(pair)
