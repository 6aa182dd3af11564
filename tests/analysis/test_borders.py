"""Borders of contact loss: a closed form, points located afresh, and a small map."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.bifurcations import GRAZING, Bifurcation
from thermogear.analysis.borders import STEPS
from thermogear.analysis.continuation import continuation
from thermogear.analysis.event_curve import (
    FOLDED,
    LEFT,
    LOST,
    OPENED,
    REACHED,
    VANISHED,
    EventCurve,
    event_curve,
)
from thermogear.analysis.maps import map_plan
from thermogear.analysis.orbits import periodic_orbit, shoot
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.excitation import Periodic
from thermogear.base.plan import gather
from thermogear.dynamics.extremes import Extremes, extremes_of
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel
from thermogear.dynamics.return_map import Stretch, Visit, stretched

LINEAR = TorsionalModel(
    damping_ratio=0.05, frequency=0.5, stiffness_amplitude=0.0, mean_force=0.1, force_amplitude=0.05
)


SECOND = 0.04 * np.exp(1j)
"""Amplitude of a second harmonic that opens the flank at another phase beyond w = .49."""


def sheet(w: float, force: float) -> TorsionalModel:
    return LINEAR.replace(frequency=w, force_amplitude=force)


def onset(w: Any) -> Any:
    """|response| = mean deflection: F_h = F_m |1 - w^2 + 2 i zeta w|."""
    return LINEAR.mean_force * np.abs(1.0 - w**2 + 2j * LINEAR.damping_ratio * w)


@pytest.fixture(scope="module")
def separation() -> Bifurcation:
    branch = continuation(periodic_orbit(LINEAR, 1, (1.1, 0.0)), "frequency", 0.8)
    return branch.of_kind(GRAZING)[0]


def test_onset_of_separation_of_a_linear_oscillator(
    separation: Bifurcation, compared: Compared
) -> None:
    """Around its least force, beside the resonance, and on to the range of the frequency."""
    curve = event_curve(
        separation, sheet, ("frequency", "force"), start=0.05, asked=[0.001], limits=(0.3, 1.25),
        within=(0.001, 0.07),
    )  # fmt: skip
    w, force = curve.values.T
    compared("onset of separation", "closed form", np.abs(force / onset(w) - 1.0), 1e-9)
    assert curve.contact == 0
    assert curve.stable.all()
    assert curve.ended.startswith(LEFT)
    assert w[-1] == pytest.approx(1.25)
    assert len(curve.turns) == 1
    zeta = LINEAR.damping_ratio
    least = LINEAR.mean_force * 2.0 * zeta * np.sqrt(1.0 - zeta**2)
    assert force.min() == pytest.approx(least, rel=0.01)


def test_a_border_ends_where_no_motion_exists(separation: Bifurcation) -> None:
    def refused(w: float, force: float) -> TorsionalModel:
        if force < 0.03:
            raise InputError("force", force, allowed=">= 0.03")
        return sheet(w, force)

    curve = event_curve(
        separation, refused, ("frequency", "force"), start=0.05, asked=[0.02], limits=(0.3, 1.3)
    )
    assert curve.ended.startswith(f"{LOST}: force: got 0.02")
    assert curve.values[-1, 1] == pytest.approx(0.03, rel=1e-4)


def test_a_map_has_its_border_once_by_name(compared: Compared) -> None:
    plan = map_plan(
        LINEAR,
        {"frequency": np.linspace(0.4, 1.6, 7), "force_amplitude": np.linspace(0.008, 0.09, 4)},
        initial_state=(1.1, 0.0),
    )
    seen: list[tuple[int, int]] = []
    made = replace(plan, sheet=sheet).telling(lambda _, done, total: seen.append((done, total)))
    data = gather(made)
    assert data["border_contact"].values.tolist() == [0]
    # it ends at the whole, and a border has parts
    assert seen == sorted(seen)
    assert seen[-1][0] == seen[-1][1]
    assert len({done % STEPS for done, _ in seen}) > 3
    first, second = (data[f"border_{name}"].values[0] for name in ("first", "second"))
    known = np.isfinite(first)
    away = np.abs(second[known] / onset(first[known]) - 1.0)
    compared("border on a map", "closed form", away, 1e-9)
    (about,) = json.loads(data.attrs["borders"])
    assert all(end[2].startswith(LEFT) for end in about["ends"])
    assert "sheet" not in json.dumps(plan.inputs())
    assert made.behind()
    assert not plan.behind()

    def stop(_: str, done: int, total: int) -> None:
        raise KeyboardInterrupt

    cut = made.telling(stop)
    rest = cut.bordered(data.drop_vars([n for n in data if str(n).startswith("border_")]), (cut,))
    assert (rest.attrs["borders_cut"], rest["border_contact"].size) == (1, 0)


def test_a_border_ends_where_another_opening_comes_first(compared: Compared) -> None:
    """Two harmonics: along the borders the least deflection of the whole period is zero."""
    model = DeadZoneModel(
        damping_ratio=0.05, frequency=0.5, stiffness=Periodic(1.0),
        force=Periodic(0.1, (0.03, SECOND)),
    )  # fmt: skip
    plan = map_plan(
        model,
        {"frequency": np.linspace(0.42, 0.56, 4), "damping_ratio": np.linspace(0.1, 0.3, 3)},
        initial_state=(1.1, 0.0),
    )
    made = replace(plan, sheet=lambda w, z: replace(model, frequency=w, damping_ratio=z))
    data = gather(made)
    whys = [end[2] for row in json.loads(data.attrs["borders"]) for end in row["ends"]]
    assert OPENED in whys
    phase = np.linspace(0.0, 1.0, 20001)
    worst = 0.0
    points = np.stack([data["border_first"].values, data["border_second"].values], axis=-1)
    for w, zeta in points.reshape(-1, 2):
        if np.isfinite(w):
            waves = sum(
                force * np.exp(2j * np.pi * n * phase) / (1.0 - (n * w) ** 2 + 2j * zeta * n * w)
                for n, force in ((1, 0.03), (2, SECOND))
            )
            worst = max(worst, abs(0.1 + waves.real.min()))
    # the samples of the phase miss the least value by 1e-8 of it
    compared("least deflection along a border", "two harmonics in closed form", worst, 1e-7)


def train(torque: float, rpm: float) -> Any:
    """Truth N1, on four ring bearings with clearance, at another torque and speed."""
    params = copy.deepcopy(TRUTH["N1"]["params"])
    params["T1"], params["rpm"] = torque, rpm
    return moving_six(params)


def lifting(orbit: Any, to: float, *, start: float, rpm: float) -> Bifurcation:
    branch = continuation(orbit, "torque", to, family=lambda t: train(t, rpm)[0], start=start)
    return branch.of_kind(GRAZING)[0]


def test_a_bearing_lifts_at_drawn_speeds(compared: Compared) -> None:
    """Followed in speed, beside torques located afresh at speeds that were drawn before."""
    model, start, _ = train(72.0, 5010.0)
    event = lifting(periodic_orbit(model, 1, start), 68.0, start=72.0, rpm=5010.0)
    speeds = np.sort(np.random.default_rng(28).uniform(4980.0, 5010.0, 2))[::-1]
    curve = event_curve(
        event, lambda t, rpm: train(t, rpm)[0], ("torque", "speed"), start=5010.0, asked=speeds,
        limits=(50.0, 90.0),
    )  # fmt: skip
    assert curve.ended == REACHED
    assert curve.contact == 2
    worst = 0.0
    for torque, rpm in curve.values[curve.asked]:
        high, low = 1.005 * torque, 0.995 * torque
        orbit = periodic_orbit(train(high, rpm)[0], 1, curve.states[-1])
        there = lifting(orbit, low, start=high, rpm=rpm)
        worst = max(worst, abs(there.value / torque - 1.0))
    compared("a bearing lifts, at drawn speeds", "located afresh", worst, 1e-7)


@dataclass(frozen=True, kw_only=True)
class Gauged:
    """z1 -> z1 + (p - z1^2)/4 where z1 >= 0: a fold at p = 0; a gap is read from it, none felt.

    ``gap`` (phases, z1) -> value over the period.
    """

    p: float
    gap: Callable[[Any, float], Any]
    dimension: int = 2
    period: float = 1.0
    unit: Any = field(default_factory=lambda: np.ones(2))

    def determinant(self, periods: int) -> float:
        return float("nan")

    def distance(self, one: Any, other: Any) -> Any:
        return np.max(np.abs(one - other), axis=-1)

    def carry(self, start: Any, periods: int) -> Any:
        return self.visit(start, periods).points[1:]

    def stretch(self, start: Any, *, direction: Any, periods: int) -> Stretch:
        return stretched(self, start, direction=direction, periods=periods)

    def visit(self, start: Any, periods: int = 1, *, sampled: bool = False) -> Visit:
        points, jacobian = [np.asarray(start, dtype=float)], np.eye(2)
        for _ in range(periods):
            one, two = points[-1]
            if one < 0.0:
                raise ConvergenceError("it runs away")
            points.append(np.array([one + 0.25 * (self.p - one**2), 0.5 * two]))
            jacobian = np.diag([1.0 - 0.5 * one, 0.5]) @ jacobian
        return Visit(
            points=np.array(points), jacobian=jacobian, contact_losses=0, back_impacts=0,
            shares=np.zeros(3), samples=np.zeros((0, 2)),
        )  # fmt: skip

    def extremes(self, start: Any, periods: int) -> Extremes:
        turn = 2.0 * np.pi / 256
        motion = np.stack([np.cos(turn * np.arange(256))] * 3)[..., None]
        return extremes_of(
            motion, lambda _, at: self.gap(at, float(start[0]))[..., None], periods=periods
        )


def gauged_curve(
    sheet: Callable[[float, float], Gauged], at: tuple[float, float], to: float
) -> EventCurve:
    """The grazing at (p, q), followed in q."""
    section = sheet(*at)
    orbit = shoot(section, np.array([np.sqrt(section.p), 0.0]), 1)
    assert orbit is not None
    event = Bifurcation(kind=GRAZING, parameter="p", value=at[0], orbit=orbit)
    return event_curve(event, sheet, ("p", "q"), start=at[1], asked=[to], limits=(-9.0, 9.0))


def test_a_border_ends_where_its_extreme_vanishes(compared: Compared) -> None:
    """p + cos t - q sin 2t: two extremes at sin t = (1 + sqrt(1 + 32 q^2))/8q meet at q = 1/2."""

    def level(q: Any) -> Any:
        sine = (1.0 + np.sqrt(1.0 + 32.0 * q**2)) / (8.0 * q)
        return np.sqrt(1.0 - sine**2) * (1.0 - 2.0 * q * sine)

    def sheet(p: float, q: float) -> Gauged:
        def gap(at: Any, _: float) -> Any:
            turn = 2.0 * np.pi * at
            return p + np.cos(turn) - q * np.sin(2.0 * turn)

        return Gauged(p=1.0, gap=gap)

    curve = gauged_curve(sheet, (-float(level(0.8)), 0.8), 0.3)
    p, q = curve.values.T
    assert curve.ended == f"{LOST}: {VANISHED}"
    assert q[-1] == pytest.approx(0.5, abs=2e-3)
    compared("border to where its extreme vanishes", "two harmonics", np.abs(p + level(q)), 1e-8)


def test_a_border_ends_where_its_orbit_folds(compared: Compared) -> None:
    """The orbit z = sqrt(p) touches at z = q: p = q^2, and behind the fold all motions run away."""

    def sheet(p: float, q: float) -> Gauged:
        return Gauged(p=p, gap=lambda at, z: z - q + 1.0 - np.cos(2.0 * np.pi * (at - 0.3)))

    curve = gauged_curve(sheet, (0.25, 0.5), -0.5)
    p, q = curve.values.T
    assert curve.ended == f"{LOST}: {FOLDED}"
    assert q[-1] == pytest.approx(0.0, abs=1e-3)
    compared("border to where its orbit folds", "z^2 = p", np.abs(p - q**2), 1e-9)
