"""The filter of measured flanks against closed forms, its noise rule, and the class of figures."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.gears.accuracy import flank_class, flank_tolerances
from thermogear.gears.geometry import Gear
from thermogear.gears.measured_flanks import noise_of, quiet_cutoff, roll_path, smoothing


def test_a_straight_line_passes_the_filter_up_to_its_ends() -> None:
    rng = np.random.default_rng(3)
    x = np.sort(rng.uniform(0.0, 10e-3, 300))
    at = np.linspace(x[0], x[-1], 77)
    line = 4e-6 - 1e-3 * x
    np.testing.assert_allclose(
        smoothing(x, at=at, cutoff=0.5e-3) @ line, 4e-6 - 1e-3 * at, atol=1e-18
    )


@pytest.mark.parametrize("share", [0.5, 1.0, 2.0])
def test_a_wave_keeps_what_the_gaussian_filter_says(share: float) -> None:
    """2^-(cutoff/wavelength)^2, ISO 16610-21: a half at the cut-off."""
    x, cutoff = np.linspace(0.0, 10e-3, 4001), 0.5e-3
    at = np.linspace(3e-3, 7e-3, 201)
    wave = np.sin(2.0 * math.pi * x / (share * cutoff))
    kept = smoothing(x, at=at, cutoff=cutoff) @ wave
    expected = 2.0 ** -(share**-2) * np.sin(2.0 * math.pi * at / (share * cutoff))
    np.testing.assert_allclose(kept, expected, atol=2e-5)


def test_noise_is_told_from_any_cubic() -> None:
    rng = np.random.default_rng(7)
    x = np.sort(rng.uniform(0.0, 1.0, 4000))
    cubic = 3.0 - 2.0 * x + 5.0 * x**2 - 4.0 * x**3
    assert noise_of(x, rows=cubic[None]) < 1e-12
    noisy = cubic + 1e-3 * rng.standard_normal((5, x.size))
    assert noise_of(x, rows=noisy) == pytest.approx(1e-3, rel=0.05)


def test_the_quiet_cutoff_leaves_noise_the_curvature_it_says() -> None:
    rng = np.random.default_rng(11)
    noise, spacing, curvature = 0.3e-6, 20e-6, 2.0
    cutoff = quiet_cutoff(noise, spacing=spacing, curvature=curvature)
    x = np.arange(4000) * spacing
    step = cutoff / 40.0
    at = np.arange(2.0 * cutoff, x[-1] - 2.0 * cutoff, step)
    weights = smoothing(x, at=at, cutoff=cutoff)
    bends = [
        np.diff(weights @ (noise * rng.standard_normal(x.size)), 2) / step**2 for _ in range(4)
    ]
    assert float(np.std(bends)) == pytest.approx(curvature, rel=0.06)


@pytest.mark.parametrize(
    ("teeth", "module", "grade"), [(16, 4.5e-3, 5), (50, 3e-3, 6), (30, 2e-3, 8), (20, 3e-3, 11)]
)
def test_figures_at_their_tolerance_have_its_class(teeth: int, module: float, grade: int) -> None:
    limits = flank_tolerances(teeth, module, grade=grade).rounded()[2:]
    assert flank_class(teeth, module, figures=limits) == grade
    assert flank_class(teeth, module, figures=(-limits[0], 0.0, 0.0)) == grade
    worse = flank_class(teeth, module, figures=(limits[0], limits[1], 1.0001 * limits[2]))
    assert worse == (grade + 1 if grade < 11 else None)


def test_there_is_no_class_outside_the_standard() -> None:
    assert flank_class(4, 3e-3, figures=(0.0, 0.0, 0.0)) is None
    assert flank_class(20, 0.4e-3, figures=(0.0, 0.0, 0.0)) is None


def test_the_roll_path_of_angle_and_diameter() -> None:
    gear = Gear(20, 3e-3, face_width=0.03)
    angle = np.array([0.1, 0.3, 0.6])
    rho = roll_path(gear, angle=angle)
    np.testing.assert_allclose(rho, gear.base_radius * angle, rtol=1e-15)
    diameter = 2.0 * gear.base_radius * np.sqrt(1.0 + angle**2)
    np.testing.assert_allclose(roll_path(gear, diameter=diameter), rho, rtol=1e-13)
    assert np.isnan(roll_path(gear, diameter=1.99 * gear.base_radius))
