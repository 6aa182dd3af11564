"""Back flanks of the load-shared model: the mirror image, and the one spring's counts."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic
from thermogear.base.pair_springs import PairSprings
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.load_shared import LoadSharedModel
from thermogear.dynamics.models import DeadZoneModel

FINE = np.linspace(0.0, 1.0, 4097)
LINE = Periodic(1.0, (0.3,))


def springs(scale: float, added: float) -> PairSprings:
    """One lasting pair, k = scale (1 + 0.3 cos), thicker by ``added``."""
    return PairSprings(scale * LINE(FINE)[None], np.full((1, FINE.size), added))


@pytest.mark.parametrize("start", [(2.0, -1.5), (-1.5, 0.4)])
def test_a_mirrored_pair_makes_the_mirrored_motion(start: tuple[float, float]) -> None:
    """x -> -x, F -> -F, drive and back flanks exchanged: the same equation."""
    one, two = springs(1.0, 0.1), springs(0.6, -0.2)
    force = Periodic(0.1, (0.4,))
    other = Periodic(-0.1, (-0.4,))
    run = {"periods": 12, "samples_per_period": 32, "steps_per_period": 256}
    there = simulate(
        LoadSharedModel(1.0, 0.05, 0.7, 1.0, force, one, two),
        initial_state=start,
        **run,  # type: ignore[arg-type]
    )
    back = simulate(
        LoadSharedModel(1.0, 0.05, 0.7, 1.0, other, two, one),
        initial_state=(-start[0], -start[1]),
        **run,  # type: ignore[arg-type]
    )
    assert np.ptp(there["x"].values) > 2.0  # both sides are met
    assert back["time_share"].values[0] == pytest.approx(there["time_share"].values[0, ::-1])
    for name in ("x", "v", "section_x", "section_v"):
        assert back[name].values == pytest.approx(-there[name].values, rel=1e-13, abs=1e-13)


def test_impacts_on_both_sides_are_those_of_the_one_spring() -> None:
    """m = 1, nothing added: motion, losses, back-side impacts and shares of time."""
    force = Periodic(0.02, (0.5,))
    shared = LoadSharedModel(1.0, 0.1, 0.6, 1.0, force, springs(1.0, 0.0), springs(1.0, 0.0))
    run = {"periods": 12, "samples_per_period": 16, "initial_state": (2.5, -1.0)}
    ours = simulate(shared, steps_per_period=8192, **run)  # type: ignore[arg-type]
    one = simulate(
        DeadZoneModel(
            damping_ratio=0.05, frequency=0.6, stiffness=LINE, force=force, half_backlash=1.0
        ),
        **run,
    )  # type: ignore[arg-type]
    assert int(one["back_impacts"][0]) > 0
    for name in ("contact_losses", "back_impacts"):
        assert int(ours[name][0]) == int(one[name][0])
    shares = ours["time_share"].values[0]
    assert shares == pytest.approx(one["time_share"].values[0], abs=1e-3)
    assert shares.min() > 0.05
    assert shares.sum() == pytest.approx(1.0, abs=1e-12)


def test_an_excitation_gives_mass_damping_and_inertial_force() -> None:
    """c = 2 zeta sqrt(k_m m_e); -m e'' of e = e_1 cos(w t) is m e_1 w^2 cos(w t)."""
    error = Periodic(0.0, (2e-6,))
    excitation = Excitation(
        stiffness=Periodic(4e8, (6e7,)),
        error=error,
        half_backlash=50e-6,
        reference_half_backlash=60e-6,
        mean_force=2000.0,
        mesh_frequency=9000.0,
        inertias=(0.001, 0.02),
        base_radii=(0.05, 0.15),
        torques=(100.0, 300.0),
        damping_ratio=0.07,
    )
    mass = 0.001 * 0.02 / (0.001 * 0.15**2 + 0.02 * 0.05**2)
    model = LoadSharedModel.from_excitation(excitation, springs(4e8, 0.0), springs(4e8, 0.0), error)
    assert model.mass == pytest.approx(mass, rel=1e-14)
    assert model.damping == pytest.approx(2.0 * 0.07 * np.sqrt(4e8 * mass), rel=1e-12)
    assert model.half_backlash == 60e-6
    assert model.period == pytest.approx(2.0 * np.pi / 9000.0)
    phase = np.array([0.0, 0.1, 0.37, 0.5])
    inertial = mass * 2e-6 * 9000.0**2 * np.cos(2.0 * np.pi * phase)
    assert model.force(phase) == pytest.approx(2000.0 + inertial, rel=1e-12)


@pytest.mark.parametrize("damping", [-1.0, -1e-9, np.nan, np.inf])
def test_damping_that_feeds_the_motion_is_refused(damping: float) -> None:
    one = springs(1.0, 0.0)
    with pytest.raises(InputError, match=r"^damping: got .*; allowed >= 0, finite"):
        LoadSharedModel(1.0, damping, 1.0, 1.0, Periodic(0.1), one, one)
    assert LoadSharedModel(1.0, 0.0, 1.0, 1.0, Periodic(0.1), one, one).damping == 0.0
