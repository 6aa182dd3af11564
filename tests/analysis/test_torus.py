"""Two base frequencies: closed forms, and a drive train beyond its Neimark-Sacker point."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH
from tests.said import numbers

from thermogear.analysis.any_motion import settle
from thermogear.analysis.bifurcations import TORUS
from thermogear.analysis.continuation import continuation
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.torus import smooth_window, torus
from thermogear.dynamics.return_map import Visit, return_map, stretched

ONE = np.ones(3)
K = np.arange(2048)


def curve(rng: np.random.Generator, nu: float) -> Any:
    """Sections on a random closed curve: harmonics that fall by a half and more."""
    found = np.zeros((K.size, 3))
    for m in range(1, 8):
        size = rng.normal(size=(2, 3)) * rng.uniform(0.1, 0.5) ** (m - 1)
        turn = 2.0 * np.pi * m * nu * K
        found += np.outer(np.cos(turn), size[0]) + np.outer(np.sin(turn), size[1])
    return found


class Turning:
    """r' = 1 + 0.3 (r - 1), theta' = theta + 2 pi nu - pull sin(q theta) of (x, y)."""

    dimension, period, unit = 2, 1.0, np.ones(2)

    def __init__(self, nu: float, *, pull: float = 0.0, times: int = 1) -> None:
        self.nu, self.pull, self.times = nu, pull, times

    def determinant(self, periods: int) -> float:
        return float("nan")

    def distance(self, one: Any, other: Any) -> Any:
        return np.max(np.abs(one - other), axis=-1)

    def _once(self, z: Any) -> tuple[Any, Any]:
        r, angle = np.hypot(*z), np.arctan2(z[1], z[0])
        own, turned = 1.0 + 0.3 * (r - 1.0), angle + 2.0 * np.pi * self.nu
        turned -= self.pull * np.sin(self.times * angle)
        rate = 1.0 - self.pull * self.times * np.cos(self.times * angle)
        c, s = np.cos(turned), np.sin(turned)
        out = np.array([[c, -own * s], [s, own * c]])
        inner = np.array([z / r, [-z[1] / r**2, z[0] / r**2]])
        return own * np.array([c, s]), out @ np.diag([0.3, rate]) @ inner

    def carry(self, start: Any, periods: int) -> Any:
        found, z = np.empty((periods, 2)), start
        for k in range(periods):
            z, _ = self._once(z)
            found[k] = z
        return found

    def visit(self, start: Any, periods: int = 1, *, sampled: bool = False) -> Visit:
        points, jacobian = [start], np.eye(2)
        for _ in range(periods):
            end, one = self._once(points[-1])
            points.append(end)
            jacobian = one @ jacobian
        return Visit(
            points=np.array(points), jacobian=jacobian, contact_losses=0, back_impacts=0,
            shares=np.zeros(3), samples=np.empty((0, 2)),
        )  # fmt: skip

    def stretch(self, start: Any, *, direction: Any, periods: int) -> Any:
        return stretched(self, start, direction=direction, periods=periods)


def test_a_rational_order_is_a_long_period() -> None:
    """7/37 turns a period, held there: periodic, and said so."""
    found = settle(Turning(7.0 / 37.0, pull=0.01, times=37), np.array([1.4, 0.2]))
    assert (found.name, found.period) == ("period-37", 37)
    assert numbers(found.reason)[-1] == 37
    # all exponents of the orbit, in closed form; 0.3^37 is beyond the rounding of an eigenvalue
    assert found.exponents[0] == pytest.approx(np.log(1.0 - 0.37), abs=1e-6)
    assert found.exponents[1] == pytest.approx(np.log(0.3), abs=1e-4)


def test_an_irrational_order_is_a_torus_of_two_exponents(compared: Compared) -> None:
    found = settle(Turning(0.5 * (3.0 - np.sqrt(5.0))), np.array([1.4, 0.2]))
    assert found.name == "quasi-periodic"
    worst = float(np.abs(found.exponents - [0.0, np.log(0.3)]).max())
    compared("two leading exponents on a torus", "0 and ln 0.3", worst, 1e-9)


def folded(nu: float) -> float:
    """A frequency as sections see it."""
    away = nu % 1.0
    return min(away, 1.0 - away)


def test_the_frequency_of_random_curves(compared: Compared) -> None:
    rng = np.random.default_rng(20261124)
    worst, undecided = 0.0, 0
    for _ in range(40):
        nu = rng.uniform(0.02, 0.48)
        found = torus(curve(rng, nu), unit=ONE)
        assert found is not None
        if not found.proven:
            # harmonics that fold to nearly one frequency are not told apart in so few sections
            near = min(abs(nu - round(nu * q) / q) * q for q in range(1, 8))
            assert near < 12.0 / K.size
            undecided += 1
            continue
        away = min(abs(found.frequency - folded(m * nu)) for m in range(1, 8))
        worst = max(worst, away / found.error)
    assert undecided <= 2
    # what the rule against short ratios relies on
    compared("second base frequency over its stated error", "random closed curves", worst, 4.0)


def in_turn(rng: np.random.Generator, nu: float, curves: int) -> Any:
    """Sections that visit so many random closed curves one after the other."""
    found = np.zeros((K.size, 3))
    for c in range(curves):
        mine = curve(rng, nu) + 5.0 * rng.normal(size=3)
        found[c::curves] = mine[c::curves]
    return found


@pytest.mark.parametrize("curves", [2, 3, 5, 8])
def test_a_torus_may_be_a_few_curves_in_turn(curves: int) -> None:
    """As it is where it began at an orbit of so many periods."""
    nu = 0.5 * (np.sqrt(5.0) - 1.0) / curves
    sections = in_turn(np.random.default_rng([20261125, curves]), nu, curves)
    found = torus(sections, unit=ONE)
    assert found is not None
    assert found.proven
    assert found.curves == curves
    # a frequency counts up to a whole turn of every curve, and its harmonics
    turns = curves * found.frequency
    away = min(abs(folded(turns) - folded(m * curves * nu)) for m in range(1, 8)) / curves
    assert away < 1e-7
    which = curves - 1
    angle = np.mod(found.frequency * K[which::curves], 1.0)
    away = found.curve(sections, angle=angle, which=which) - sections[which::curves]
    # the error of the frequency, 2048 periods later
    assert np.abs(away).max() < 1e-4


def test_a_curve_with_corners_is_one() -> None:
    """Harmonics that fall as slowly as 1/m^2: |sin|, as contact that is lost leaves it."""
    turn = 2.0 * np.pi * 0.5 * (3.0 - np.sqrt(5.0)) * K
    sections = np.stack([np.abs(np.sin(0.5 * turn)), np.cos(turn), np.sin(turn)], axis=1)
    found = torus(sections * np.array([9.0, 1.0, 1.0]), unit=ONE)
    assert found is not None
    assert found.proven
    assert found.curves == 1


def test_a_smooth_mean_is_near_its_limit() -> None:
    """The mean of cos(2 pi nu k) is zero; a plain one falls with the length alone."""
    wave = np.cos(2.0 * np.pi * 0.5 * (3.0 - np.sqrt(5.0)) * K)
    assert abs(float(smooth_window(K.size) @ wave)) < 1e-12
    assert smooth_window(K.size).sum() == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("kind", ["ratio", "noise", "fading", "growing", "still"])
def test_what_is_no_torus(kind: str) -> None:
    rng = np.random.default_rng(7)
    sections = {
        "ratio": curve(rng, 7.0 / 50.0),
        "noise": rng.normal(size=(K.size, 3)),
        "fading": curve(rng, 0.1234567) * np.exp(-K / 4000.0)[:, None],
        "growing": curve(rng, 0.1234567) * np.exp(K / 4000.0)[:, None],
        "still": np.full((K.size, 3), 0.3),
    }[kind]
    found = torus(sections, unit=ONE)
    assert found is None or not found.proven


def train(eps: float, name: str = "Q1") -> Any:
    params = copy.deepcopy(TRUTH[name]["params"])
    params["k_re"], params["k_im"] = [eps * params["k_mean"]], [0.0]
    return moving_six(params)


def test_where_a_pair_of_multipliers_leaves_the_unit_circle(compared: Compared) -> None:
    """Truth Q1: mesh frequency = lowest + highest natural frequency."""
    case = TRUTH["Q1"]["values"]
    model, start, _ = train(0.04)
    orbit = periodic_orbit(model, 1, start)
    branch = continuation(orbit, "eps", 0.07, family=lambda eps: train(eps)[0], start=0.04)
    assert [one.kind for one in branch.bifurcations] == [TORUS]
    found = branch.bifurcations[0]
    compared("Neimark-Sacker point of a train", "truth Q1", found.value - case["eps"], 1e-6)
    mu = complex(found.multipliers[0])
    away = complex(mu.real, abs(mu.imag)) - complex(*case["multiplier"])
    compared("its multiplier", "truth Q1", abs(away), 1e-5)


def test_a_train_on_a_torus(compared: Compared) -> None:
    """Truth Q2, 1.1 times beyond: bounded by loss of contact."""
    case = TRUTH["Q2"]
    known, within = case["values"], case["tolerance"]
    model, start, _ = moving_six(case["params"])
    section = return_map(model)
    found = settle(section, 1.05 * start)
    assert found.name == "quasi-periodic"
    assert found.torus is not None
    assert found.exponents[1] < 0.0
    assert abs(found.lyapunov) < 4.0 * found.lyapunov_error < 0.01 / section.period
    away = found.torus.frequency - known["frequency"]
    compared("second frequency of a torus", "truth Q2", away, within["frequency"])
    path = section.carry(found.state, 3000)[:, : model.size] @ model.drive
    compared("range on a torus", "truth Q2", np.ptp(path) / known["range"] - 1, within["range"])
    on = section.carry(found.state, 600)
    angle = np.mod(found.torus.frequency * np.arange(600), 1.0)
    away = np.abs(found.torus.curve(on, angle=angle) - on) / on.std(axis=0)
    compared("sections beside their closed curve", "their spread", away, 0.02)
    compared("deviation on a torus", "truth Q2", path.std() / known["std"] - 1, within["std"])


def test_a_torus_begins_at_the_angle_of_its_multipliers(compared: Compared) -> None:
    """A limit: close behind the bifurcation the second frequency is arg(mu)/2 pi."""
    mu = complex(*TRUTH["Q1"]["values"]["multiplier"])
    model, start, _ = train(1.05 * TRUTH["Q1"]["values"]["eps"])
    section = return_map(model)
    found = torus(section.carry(1.05 * start, 20_000)[-2048:], unit=section.unit)
    assert found is not None
    assert found.proven
    away = found.frequency - float(np.angle(mu)) / (2.0 * np.pi)
    compared("second frequency near its birth", "arg(mu)/2 pi", away, 3e-5)
