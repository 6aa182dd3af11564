"""Printed coefficients read back one by one, contact at its edges, and what a search counts."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.gears.contact import hertz_pressure
from thermogear.gears.geometry import Gear
from thermogear.gears.iso6336 import theoretical_single_stiffness
from thermogear.gears.pair import GearPair
from thermogear.gears.relief import optimise_tip_relief
from thermogear.gears.sharing_kernel import _share_one

# ISO 6336-1:2006, table of C1..C9 as printed
PRINTED = [0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182]


def test_the_nine_coefficients_of_iso_6336_are_the_printed_ones() -> None:
    """q' is linear in them: nine gear pairs tell all nine."""
    rng = np.random.default_rng(0)
    z1, z2 = rng.uniform(12.0, 120.0, (2, 40))
    x1, x2 = rng.uniform(-0.6, 1.0, (2, 40))
    terms = np.stack([np.ones(40), 1 / z1, 1 / z2, x1, x1 / z1, x2, x2 / z2, x1**2, x2**2], axis=1)
    flexibility = 1e9 / theoretical_single_stiffness(teeth1=z1, teeth2=z2, shift1=x1, shift2=x2)
    found, *_ = np.linalg.lstsq(terms, flexibility, rcond=None)
    assert found == pytest.approx(PRINTED, abs=1e-10)


def test_no_load_presses_nothing_even_on_an_edge() -> None:
    assert hertz_pressure([0.0, 0.0, 1.0], [0.01, 0.0, 0.0], 1e11).tolist() == [0.0, 0.0, np.inf]


def test_relief_counts_every_contact_it_solves() -> None:
    pair = GearPair(
        Gear(25, 5e-3, face_width=20e-3, bore_radius=20e-3),
        Gear(75, 5e-3, face_width=20e-3, bore_radius=60e-3),
    )
    counts: list[int] = []
    design = optimise_tip_relief(pair, 4e3, symmetric=True, progress=counts.append)
    assert counts == list(range(2, design.evaluations + 1))


@pytest.mark.parametrize("run", [_share_one, _share_one.py_func], ids=["compiled", "python"])
def test_a_pair_that_another_unloads_leaves_the_contact(run) -> None:  # type: ignore[no-untyped-def]
    """Strongly coupled bodies: the nearest pair touches first and others may lift it off.

    What must hold is that no pair pulls, none overlaps, and loaded pairs touch.
    """
    found = 0
    for seed in range(400):
        rng = np.random.default_rng(seed)
        root = rng.normal(size=(4, 4))
        compliance = root @ root.T + 0.05 * np.eye(4)
        gap, linear = rng.uniform(0.0, 1.0, 4), np.full(4, 0.05)
        force = np.zeros(4)
        springs = compliance + np.diag(linear)
        delta, _, settled = run(1.0, gap, springs, 1.0, np.ones((4, 7)), np.zeros(6), force)
        assert settled
        assert force.sum() == pytest.approx(1.0, rel=1e-9)
        slack = springs @ force + gap - delta
        assert np.all(force >= 0.0)
        assert np.all(slack >= -1e-9)
        assert np.abs(slack[force > 0.0]).max() < 1e-9
        found += int(force[np.argmin(gap)] == 0.0)
    assert found > 0
