"""Bifurcations in two parameters: a scaling law, Hill's equation, and drive trains."""

from __future__ import annotations

import copy
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.bifurcations import BIRTH, FLIP, FOLD, GRAZING, PITCHFORK, TORUS
from thermogear.analysis.continuation import SHRUNK, Branch, continuation, family_of
from thermogear.analysis.event_curve import REACHED, event_curve
from thermogear.analysis.orbits import periodic_orbit, shoot
from thermogear.base.errors import InputError
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map
from thermogear.dynamics.smooth_map import SmoothModel

FORCED = TorsionalModel(
    damping_ratio=0.05,
    frequency=1.1,
    stiffness_amplitude=0.2,
    mean_force=0.1,
    force_amplitude=0.15,
)
DOUBLING = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.3,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)


def followed(model: TorsionalModel, start: tuple[float, float], to: float) -> Branch:
    return continuation(periodic_orbit(model, 1, start), "frequency", to)


@pytest.mark.parametrize(
    ("model", "start", "to", "kind"),
    [
        (DOUBLING, (1.08, -0.25), 1.1, FLIP),
        (FORCED, (1.1, 0.0), 0.45, FOLD),
        (FORCED, (1.1, 0.0), 0.45, GRAZING),
    ],
)
def test_thermal_stiffness_is_removed_by_scaling(
    model: TorsionalModel, start: tuple[float, float], to: float, kind: str, compared: Compared
) -> None:
    """zeta s, w s, eps s^2, F s^2 with s^2 = 1 + eps_T is one equation in another time."""
    event = followed(model, start, to).of_kind(kind)[0]

    def scaled(w: float, heat: float) -> TorsionalModel:
        s = np.sqrt(1.0 + heat)
        return model.replace(
            frequency=w,
            thermal_stiffness=heat,
            damping_ratio=s * model.damping_ratio,
            stiffness_amplitude=s * s * model.stiffness_amplitude,
            mean_force=s * s * model.mean_force,
            force_amplitude=s * s * model.force_amplitude,
        )

    curve = event_curve(
        event, scaled, ("frequency", "thermal_stiffness"), start=0.0,
        asked=[0.0, 0.1, 0.25, 0.4], limits=(0.3, 2.0),
    )  # fmt: skip
    assert curve.ended == REACHED
    assert curve.values[curve.asked, 1].tolist() == [0.0, 0.1, 0.25, 0.4]
    law = event.value * np.sqrt(1.0 + curve.values[:, 1])
    worst = float(np.abs(curve.values[:, 0] / law - 1.0).max())
    compared(f"a {kind} in two parameters", "the law of scaling", worst, 1e-9)


def test_the_first_tongue_of_hills_equation(compared: Compared) -> None:
    """In lasting contact a flip is the border of a tongue; its tip lies near eps = 4 zeta."""
    model = TorsionalModel(
        damping_ratio=0.02,
        frequency=2.4,
        stiffness_amplitude=0.2,
        mean_force=1.0,
        force_amplitude=0.01,
    )
    flip = followed(model, (2.0, 0.0), 1.9).of_kind(FLIP)[0]
    curve = event_curve(
        flip, lambda w, eps: model.replace(frequency=w, stiffness_amplitude=eps),
        ("frequency", "stiffness_amplitude"), start=0.2, asked=[0.05], limits=(1.7, 2.4),
    )  # fmt: skip
    assert len(curve.turns) == 1
    assert curve.values[-1, 1] == pytest.approx(0.2)
    tip = float(curve.values[:, 1].min())
    # the next term is of the order zeta^2
    assert tip == pytest.approx(4.0 * model.damping_ratio, rel=0.01)
    worst = 0.0
    for w, eps in curve.values[::4]:
        ends = [
            solve_ivp(
                lambda t, y, w=w, eps=eps: [
                    y[1], -2 * model.damping_ratio * y[1] - (1 + eps * np.cos(w * t)) * y[0],
                ],
                (0.0, 2.0 * np.pi / w), start, method="DOP853", rtol=1e-12, atol=1e-13,
            ).y[:, -1]
            for start in ([1.0, 0.0], [0.0, 1.0])
        ]  # fmt: skip
        trace = ends[0][0] + ends[1][1]
        worst = max(worst, abs(1.0 + trace + np.exp(-4.0 * np.pi * model.damping_ratio / w)))
    compared("border of Hill's first tongue", "1 + tr + det, integrated", worst, 1e-9)


def test_folds_that_meet_in_a_cusp_are_one_curve() -> None:
    lower, upper = followed(FORCED, (1.1, 0.0), 0.45).of_kind(FOLD)
    curve = event_curve(
        lower, lambda w, zeta: FORCED.replace(frequency=w, damping_ratio=zeta),
        ("frequency", "damping_ratio"), start=0.05, asked=[0.05, 0.08, 0.12], limits=(0.3, 1.0),
    )  # fmt: skip
    assert curve.values[-1, 1] == pytest.approx(0.05)
    assert len(curve.turns) == 1
    assert curve.values[-1, 0] == pytest.approx(upper.value, rel=1e-9)
    assert np.count_nonzero(curve.values[:, 1] == 0.08) == 2


def test_a_halving_is_refused() -> None:
    """It is the doubling of another orbit."""
    halving = replace(followed(FORCED, (1.1, 0.0), 0.45).of_kind(FOLD)[0], kind=BIRTH)
    with pytest.raises(InputError, match="fold"):
        event_curve(
            halving, lambda w, z: FORCED.replace(frequency=w, damping_ratio=z),
            ("frequency", "damping_ratio"), start=0.05, asked=[0.1], limits=(0.3, 1.0),
        )  # fmt: skip
    family, _ = family_of(FORCED, "frequency")
    fold = followed(FORCED, (1.1, 0.0), 0.45).of_kind(FOLD)[0]
    with pytest.raises(InputError, match="asked"):
        event_curve(
            fold, lambda w, _: family(w), ("frequency", "damping_ratio"), start=0.05,
            asked=[0.05], limits=(0.3, 1.0),
        )  # fmt: skip


def train(eps: float, rpm: float = 1.0) -> Any:
    """Truth Q1 with another modulation of its stiffness, and speed as a share of its own."""
    params = copy.deepcopy(TRUTH["Q1"]["params"])
    params["k_re"], params["k_im"] = [eps * params["k_mean"]], [0.0]
    params["rpm"] *= rpm
    return moving_six(params)


def test_a_neimark_sacker_point_in_a_second_parameter(compared: Compared) -> None:
    """Truth Q1 followed in speed, beside points located afresh at drawn speeds."""
    model, start, _ = train(0.05)
    speeds = np.sort(np.random.default_rng(22).uniform(1.0, 1.008, 2))
    branch = continuation(
        periodic_orbit(model, 1, start), "eps", 0.06, family=lambda e: train(e)[0], start=0.05
    )
    curve = event_curve(
        branch.of_kind(TORUS)[0], lambda e, rpm: train(e, rpm)[0], ("eps", "speed"), start=1.0,
        asked=speeds, limits=(0.03, 0.2),
    )  # fmt: skip
    assert curve.ended == REACHED
    assert curve.stable.all()
    first = curve.values[0, 0] - TRUTH["Q1"]["values"]["eps"]
    compared("Neimark-Sacker curve where it begins", "truth Q1", first, 1e-6)
    worst = 0.0
    for eps, speed in curve.values[curve.asked]:
        own = periodic_orbit(train(0.97 * eps, speed)[0], 1, start)
        there = continuation(
            own, "eps", 1.03 * eps, family=lambda e, at=speed: train(e, at)[0], start=0.97 * eps
        )
        worst = max(worst, abs(there.of_kind(TORUS)[0].value / eps - 1.0))
    compared("Neimark-Sacker curve at drawn speeds", "located afresh", worst, 1e-7)


def forked(p: float) -> SmoothModel:
    """v'' = -v' + p v - v^3 beside a forced oscillator: its mirror motions +-sqrt(p) meet at 0."""
    return SmoothModel(
        derivative=lambda t, y: np.array(
            [y[1], -0.5 * y[1] - y[0] + np.cos(1.3 * t), y[3], -y[3] + p * y[2] - y[2] ** 3]
        ),
        jacobian=lambda t, y: np.array(
            [[0, 1, 0, 0], [-1, -0.5, 0, 0], [0, 0, 0, 1], [0, 0, p - 3.0 * y[2] ** 2, -1.0]]
        ),
        period=2.0 * np.pi / 1.3,
        unit=np.ones(4),
        divergence=-1.5,
        tolerance=1e-10,
    )


@pytest.mark.parametrize("side", [0.0, 1.0])
def test_mirror_motions_of_a_long_state_meet_in_a_pitchfork(side: float) -> None:
    """Off the symmetric motion the branch turns there; along it one multiplier passes +1."""
    begin, end = (0.2, -0.1) if side else (-0.1, 0.1)
    model = forked(begin)
    orbit = shoot(return_map(model), np.array([0.5, 0.5, side * np.sqrt(begin or 0.0), 0.0])
                  if side else np.array([0.5, 0.5, 0.0, 0.0]), 1, model=model)  # fmt: skip
    assert orbit is not None
    branch = continuation(orbit, "p", end, family=forked, start=begin)
    assert [one.kind for one in branch.bifurcations] == [PITCHFORK]
    # v^3 closes to 1e-10, so that v is known to some 1e-3 there and p = v^2 to its square
    assert branch.bifurcations[0].value == pytest.approx(0.0, abs=1e-5)
    assert branch.ended == (SHRUNK[PITCHFORK] if side else REACHED)
