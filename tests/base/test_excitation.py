"""Periodic functions as Fourier series."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from thermogear import InputError, Periodic
from thermogear.base.excitation import Excitation, Excitations


def test_a_cosine_is_one_harmonic() -> None:
    phase = np.linspace(-1.0, 2.0, 17)
    wave = Periodic(2.0, (0.5 * np.exp(0.3j),))
    np.testing.assert_allclose(wave(phase), 2.0 + 0.5 * np.cos(2 * np.pi * phase + 0.3), rtol=1e-14)


def test_the_series_passes_through_an_odd_number_of_samples() -> None:
    samples = np.random.default_rng(1).normal(size=31)
    np.testing.assert_allclose(
        Periodic.from_samples(samples)(np.arange(31) / 31), samples, atol=1e-13
    )


def test_derivatives_against_differences_and_closed_form() -> None:
    wave = Periodic(1.0, (0.2j, 0.0, 0.1))
    phase = np.linspace(0.0, 1.0, 11)
    h = 1e-6
    slope = (wave(phase + h) - wave(phase - h)) / (2 * h)
    np.testing.assert_allclose(wave.derivative()(phase), slope, atol=1e-8)
    cosine = Periodic(0.0, (3.0,)).derivative(2)
    np.testing.assert_allclose(cosine(phase), -3.0 * (2 * np.pi) ** 2 * np.cos(2 * np.pi * phase))


def test_sums_and_multiples() -> None:
    phase = np.linspace(0.0, 1.0, 7)
    a, b = Periodic(1.0, (1.0, 2j)), Periodic(0.5, (0.25,))
    np.testing.assert_allclose((a + b)(phase), a(phase) + b(phase))
    np.testing.assert_allclose((2.0 * a + 1.0)(phase), 2.0 * a(phase) + 1.0)


def test_non_finite_samples_are_refused() -> None:
    with pytest.raises(InputError, match="samples: got"):
        Periodic.from_samples([1.0, np.nan])
    with pytest.raises(InputError, match="periodic: got inf; allowed finite numbers"):
        Periodic(np.inf)


def test_columns_hold_what_single_ones_hold() -> None:
    one = Excitation(
        stiffness=Periodic(3e8, (1e7 + 2e6j,)),
        error=Periodic(0.0, (1e-6j, 2e-7)),
        half_backlash=9e-5,
        reference_half_backlash=1e-4,
        mean_force=2e3,
        mesh_frequency=5e3,
        inertias=(1e-3, 4e-2),
        base_radii=(0.03, 0.09),
        torques=(60.0, 180.0),
        damping_ratio=0.05,
    )
    other = replace(one, stiffness=Periodic(4e8, (1e7, 2e6, 3e5j)), error=Periodic(0.0))
    both = Excitations.of([one, other])
    for place, single in enumerate((one, other)):
        again = both.one(place)
        assert again is not None
        assert both.natural_frequency[place] == single.natural_frequency
        assert again.stiffness(np.arange(16) / 16) == pytest.approx(
            single.stiffness(np.arange(16) / 16), rel=1e-15
        )
        assert again.error(np.arange(16) / 16) == pytest.approx(
            single.error(np.arange(16) / 16), abs=1e-21
        )
        assert (again.torques, again.inertias) == (single.torques, single.inertias)
    twice = Excitations.joined([both, Excitations.of([one])])
    assert len(twice) == 3
    assert twice.take([2, 0]).stiffness[0] == pytest.approx(twice.stiffness[0])
