"""Extremes of contacts' depths against closed forms."""

from __future__ import annotations

import numpy as np
from tests.conftest import Compared

from thermogear.analysis.orbits import periodic_orbit
from thermogear.dynamics.extremes import extremes_of
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map


def test_a_linear_oscillator_has_its_amplitude(compared: Compared) -> None:
    """At drawn frequencies: depth F_m -+ |response| of the drive flank, less 2 b of the back."""
    worst = 0.0
    for w in np.random.default_rng(41).uniform(0.3, 0.6, 5):
        model = TorsionalModel(
            damping_ratio=0.05, frequency=float(w), stiffness_amplitude=0.0, mean_force=0.1,
            force_amplitude=0.04,
        )  # fmt: skip
        orbit = periodic_orbit(model, 1, (1.1, 0.0))
        section = return_map(model.lanes())
        seen = section.extremes(orbit.state, 1)  # type: ignore[attr-defined]
        size = 0.04 / abs(1.0 - w**2 + 0.1j * w)
        known = [0.1 + size, 0.1 - size, -2.1 - size, -2.1 + size]
        assert seen.depth.size == len(known)
        worst = max(worst, float(np.abs(np.sort(seen.depth) - np.sort(known)).max()))
        assert seen.losses == (0, 0)
    compared("extremes of a depth", "linear response", worst, 1e-11)


def test_a_kink_between_two_elements_is_located(compared: Compared) -> None:
    """The deeper of cos and -cos is least, 0, where they exchange: a kink, by its slope alone."""
    phase = np.arange(64) / 64
    turn = 2.0 * np.pi / 64
    u = np.cos(2.0 * np.pi * phase + 0.3)
    motion = np.stack([u, -turn * np.sin(2.0 * np.pi * phase + 0.3), -(turn**2) * u])[..., None]
    seen = extremes_of(motion, lambda u, _: np.abs(u) - 0.5, periods=1)
    assert seen.losses == (2,)
    least = seen.depth[~seen.deepest]
    compared("a kink of a depth", "closed form", np.abs(least + 0.5), 1e-8)
