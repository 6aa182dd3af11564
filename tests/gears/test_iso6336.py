"""ISO 6336-1 method B against worked examples and limits."""

from __future__ import annotations

import math
import warnings

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import ValidityWarning
from thermogear.gears.geometry import Gear
from thermogear.gears.iso6336 import (
    iso6336_stiffness,
    single_stiffness,
    theoretical_single_stiffness,
)
from thermogear.gears.pair import GearPair

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
    # z_n = z/(cos^2(beta_b) cos(beta)), sin(beta_b) = sin(beta) cos(alpha_n), ISO 21771-1
    virtual = 1.0 / ((1.0 - (math.sin(beta) * math.cos(alpha)) ** 2) * math.cos(beta))
    theory = theoretical_single_stiffness(
        teeth1=17 * virtual,
        teeth2=103 * virtual,
        shift1=0.145,
        shift2=0.0,
    )
    single = float(single_stiffness(theory, dedendum=1.4, pressure_angle=alpha, helix_angle=beta))
    compared(
        "ISO 6336 stiffness",
        "ISO/TR 6336-30, example 1",
        [float(theory) / 17.8558e9 - 1.0, single / 12.3705e9 - 1.0],
        5e-6,
    )


def test_low_load() -> None:
    high, at, low, none = iso6336_stiffness(RIG, np.array([500e3, 100e3, 6.25e3, 0.0])).single
    assert high == at
    assert low == pytest.approx(0.5 * at, rel=1e-12)
    assert none == 0.0


def shifted(teeth: tuple[int, int], x1: float, x2: float) -> GearPair:
    return GearPair(Gear(teeth[0], 5e-3, profile_shift=x1), Gear(teeth[1], 5e-3, profile_shift=x2))


def mesh_of(pair: GearPair) -> float:
    """c_gamma_alpha, the warnings of the range left aside."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        return float(iso6336_stiffness(pair).mesh)


def test_the_first_gear_is_the_pinion_whatever_the_shifts() -> None:
    """The published example with its gears' shifts the other way round: z1 stays the smaller."""
    pair = shifted((25, 75), 0.0, 0.2)
    with pytest.warns(ValidityWarning, match="profile_shift"):
        got = iso6336_stiffness(pair)
    assert float(got.theoretical) == float(
        theoretical_single_stiffness(teeth1=25, teeth2=75, shift1=0.0, shift2=0.2)
    )


@pytest.mark.parametrize("seed", range(3))
def test_stiffness_runs_on_where_one_shift_passes_the_other(seed: int) -> None:
    """The formula is a polynomial in the shifts: no step in x2 may exceed its slope."""
    rng = np.random.default_rng(seed)
    for _ in range(25):
        teeth = tuple(int(z) for z in rng.integers(20, 120, 2))
        if seed == 0:
            teeth = (teeth[0], teeth[0])
        x1, step = rng.uniform(0.0, 0.5), 1e-6
        below, at, above = (mesh_of(shifted(teeth, x1, x1 + d)) for d in (-step, 0.0, step))
        assert abs(at / below - 1.0) < 5.0 * step
        assert abs(above / at - 1.0) < 5.0 * step


def test_exchanging_the_gears_changes_nothing() -> None:
    rng = np.random.default_rng(5)
    for equal in (False, True):
        for _ in range(40):
            first, second = (int(z) for z in rng.integers(20, 120, 2))
            teeth = (first, first if equal else second)
            x1, x2 = rng.uniform(-0.2, 0.6, 2)
            pair = shifted(teeth, x1, x2)
            assert mesh_of(pair) == pytest.approx(mesh_of(pair.swapped()), rel=1e-12)


def test_of_two_gears_with_as_many_teeth_the_larger_shift_stands_first() -> None:
    """Neither is the pinion, and the source's range x1 >= x2 leaves one order."""
    for pair in (shifted((40, 40), 0.4, -0.1), shifted((40, 40), -0.1, 0.4)):
        got = iso6336_stiffness(pair)
        assert float(got.theoretical) == float(
            theoretical_single_stiffness(teeth1=40, teeth2=40, shift1=0.4, shift2=-0.1)
        )


def test_shifts_outside_the_source() -> None:
    with pytest.warns(ValidityWarning) as told:
        iso6336_stiffness(shifted((80, 90), -0.3, -0.3))
    assert [str(one.message) for one in told] == [
        "profile_shift: x1 = -0.3 (80 teeth), x2 = -0.3 (90 teeth): x1 + x2 = -0.6; "
        "range of ISO 6336-1 -0.5 <= x1 + x2 <= 2"
    ]
    with pytest.warns(ValidityWarning) as told:
        iso6336_stiffness(shifted((75, 25), 0.2, 0.05))
    assert [str(one.message) for one in told] == [
        "profile_shift: x1 = 0.05 (25 teeth), x2 = 0.2 (75 teeth): x1 < x2; "
        "range of ISO 6336-1 x1 >= x2"
    ]
