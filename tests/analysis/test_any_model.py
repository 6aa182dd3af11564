"""Analysis of models that are no single mass, against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.analysis.attractors import attractors_from
from thermogear.analysis.bifurcations import FLIP, FOLD, SUPERCRITICAL, TORUS
from thermogear.analysis.continuation import continuation, switch_branch
from thermogear.analysis.labels import label
from thermogear.analysis.lyapunov import lyapunov_exponent
from thermogear.analysis.orbits import periodic_orbit
from thermogear.analysis.settle import PERIODIC, Rule, settle
from thermogear.analysis.torus import torus
from thermogear.dynamics.return_map import return_map
from thermogear.dynamics.smooth_map import SmoothModel

OMEGA = 2.0 * np.pi


def turning(mu, d=2, rate=0.7, tolerance=1e-11):
    """A normal form with a torus: z' = (mu + i rate) z - |z|^2 z, driven, and d - 2 that decay.

    In w = z - p(t), p of the mesh period, w' is the right side at w: the orbit of one period is
    z = p and has the multipliers exp((mu +- i rate) T), whatever mu is.
    """
    fall = -1.0 - np.arange(d - 2)
    decays = np.diag(np.concatenate([[0.0, 0.0], fall]))

    def apart(t, y):
        c, s = 0.3 * math.cos(OMEGA * t), 0.3 * math.sin(OMEGA * t)
        x, z = y[:2].tolist()  # plain numbers: asked for a million times
        return x - c, z - s, -OMEGA * s, OMEGA * c

    def rates(t, y):
        a, b, p, q = apart(t, y)
        left = mu - a * a - b * b
        inner = [left * a - rate * b + p, left * b + rate * a + q]
        if d == 2:
            return np.array(inner)
        return np.concatenate([inner, fall * y[2:] + math.sin(OMEGA * t)])

    def matrix(t, y):
        a, b, _, _ = apart(t, y)
        left, both = mu - a * a - b * b, -2.0 * a * b
        out = decays.copy()
        out[0, 0], out[0, 1] = left - 2.0 * a * a, both - rate
        out[1, 0], out[1, 1] = both + rate, left - 2.0 * b * b
        return out

    return SmoothModel(
        derivative=rates, jacobian=matrix, period=1.0, unit=np.ones(d), tolerance=tolerance
    )


@pytest.mark.parametrize("d", [2, 4])
def test_a_pair_that_leaves_the_unit_circle_is_located_as_a_torus(d):
    """The closed form: |mu| = exp(mu T) passes 1 at mu = 0, at an angle of rate T."""
    orbit = periodic_orbit(turning(-0.5, d), 1, np.append([0.2, 0.1], np.zeros(d - 2)))
    assert orbit.state[:2] == pytest.approx([0.3, 0.0], abs=1e-9)
    branch = continuation(orbit, "mu", 0.4, family=lambda mu: turning(mu, d), start=-0.5)
    assert branch.values[-1] == pytest.approx(0.4)
    assert [b.kind for b in branch.bifurcations] == [TORUS]
    found = branch.bifurcations[0]
    assert found.value == pytest.approx(0.0, abs=1e-8)
    assert found.multipliers[0] == pytest.approx(np.exp(0.7j), abs=1e-8)
    assert branch.stable.tolist() == (branch.values < 0.0).tolist()
    assert np.abs(branch.multipliers[:, 0]) == pytest.approx(np.exp(branch.values), abs=1e-7)
    assert branch.states.shape == (branch.values.size, d)
    assert branch.dataset().sizes["multiplier"] == d


def stepped(value, kind, d=3):
    """Equations y' = f(y) t-periodic in name, whose maps have a fold or a flip at value 0.

    fold: x' = value - x^2. flip: a plane that turns by pi in a period, in which one direction
    that turns along has the rate (value - s^2) and the other -1.
    """
    if kind == FOLD:

        def rates(t, y):
            return np.append(value - y[0] ** 2, -y[1:])

        def matrix(t, y):
            return np.diag(np.append(-2.0 * y[0], -np.ones(d - 1)))

    else:

        def rates(t, y):
            along, beside, turn = _frame(t)
            s, r = along @ y[:2], beside @ y[:2]
            inner = (value * s - s**3) * along - r * beside + turn @ y[:2]
            return np.append(inner, -y[2:])

        def matrix(t, y):
            along, beside, turn = _frame(t)
            s = along @ y[:2]
            out = -np.eye(d)
            out[:2, :2] = (value - 3.0 * s**2) * np.outer(along, along)
            out[:2, :2] += turn - np.outer(beside, beside)
            return out

    return SmoothModel(
        derivative=rates, jacobian=matrix, period=1.0, unit=np.ones(d), tolerance=1e-11
    )


def _frame(t):
    c, s = np.cos(np.pi * t), np.sin(np.pi * t)
    return np.array([c, s]), np.array([-s, c]), np.pi * np.array([[0.0, -1.0], [1.0, 0.0]])


def test_a_fold_of_a_state_of_three_is_where_the_closed_form_has_it():
    """x = +-sqrt(value): the branch turns at 0, with the multiplier exp(-2 sqrt(value) T)."""
    orbit = periodic_orbit(stepped(0.25, FOLD), 1, (0.4, 0.0, 0.0))
    assert orbit.state[0] == pytest.approx(0.5, abs=1e-9)
    branch = continuation(
        orbit, "value", -0.2, family=lambda v: stepped(v, FOLD), start=0.25, back_to=0.3
    )
    assert [b.kind for b in branch.bifurcations] == [FOLD]
    assert branch.bifurcations[0].value == pytest.approx(0.0, abs=1e-9)
    assert branch.states[:, 0] ** 2 == pytest.approx(branch.values, abs=1e-8)


def test_a_flip_of_a_state_of_three_and_the_doubled_orbit_beside_it():
    """The doubled orbit has s^2 = value: it lives above 0 and is stable."""

    def family(value):
        return stepped(value, FLIP)

    orbit = periodic_orbit(family(-0.3), 1, (0.1, 0.1, 0.0))
    branch = continuation(orbit, "value", 0.3, family=family, start=-0.3)
    assert [b.kind for b in branch.bifurcations] == [FLIP]
    flip = branch.bifurcations[0]
    assert flip.value == pytest.approx(0.0, abs=1e-8)
    assert flip.note == SUPERCRITICAL
    doubled = switch_branch(flip, family)
    assert doubled.orbit.state[0] ** 2 == pytest.approx(doubled.value, abs=1e-8)
    onward = continuation(
        doubled.orbit,
        "value",
        0.3,
        family=family,
        start=doubled.value,
        direction=doubled.direction,
    )
    assert onward.values[-1] == pytest.approx(0.3)
    assert onward.states[-1, 0] ** 2 == pytest.approx(0.3, abs=1e-8)
    assert onward.stable[-1]


def test_many_models_of_any_dimension_settle_side_by_side():
    """Below 0 on the orbit of one period; above on a torus, which is undecided."""
    values = (-0.6, -0.3, 0.4)
    start = np.tile([0.5, 0.1, 0.0, 0.0], (3, 1))
    rule = Rule(first=16, cap=64, max_period=4, chaos_periods=40, batches=4, settled=1e-3)
    found = settle([turning(mu, 4) for mu in values], start, rule, keep=4)
    assert (found.label == PERIODIC).tolist() == [True, True, False]
    assert np.abs(found.multiplier[:2, 0]) == pytest.approx(np.exp(values[:2]), rel=1e-6)
    assert found.label[2] == 0
    assert found.point[0, :2] == pytest.approx([0.3, 0.0], abs=1e-6)
    assert found.sections.shape == (3, 4, 4)


def test_attractors_of_a_model_that_is_no_single_mass():
    """x' = x - x^3: starts on either side of 0 go to -1 and 1."""
    model = SmoothModel(
        derivative=lambda t, y: np.array([y[0] - y[0] ** 3, -y[1], -y[2]]),
        jacobian=lambda t, y: np.diag([1.0 - 3.0 * y[0] ** 2, -1.0, -1.0]),
        period=1.0,
        unit=np.ones(3),
    )
    starts = np.array([[0.4, 0.1, 0.0], [-0.3, 0.0, 0.2], [0.9, 0.0, 0.1]])
    rule = Rule(first=16, cap=64, max_period=2, chaos_periods=40, batches=4)
    found, where = attractors_from([model], starts, rule)
    assert where.tolist() == [0, 1, 0]
    assert [one.points[0, 0] for one in found] == pytest.approx([1.0, -1.0], abs=1e-8)
    assert found[0].multiplier == pytest.approx(np.exp(-1.0), rel=1e-8)
    assert found[0].lyapunov == pytest.approx(-1.0, rel=1e-8)


@pytest.mark.parametrize(
    ("mu", "name"), [(-0.5, "period-1"), (-0.001, "undecided"), (0.3, "quasi-periodic")]
)
def test_a_label_of_any_model_never_calls_a_torus_settled_or_chaotic(mu, name):
    """|mu| = exp(mu T): near 1 nothing is decided; a pair off the circle leaves a torus."""
    model = turning(mu, tolerance=1e-8)
    found = label(model, initial_state=(0.35, 0.0), discard=16, cap=128, max_period=4, starts=1)
    assert found.name == name
    if name == "period-1":
        assert found.orbit.model is model
        assert found.multipliers[0] == pytest.approx(np.exp(mu + 0.7j), rel=1e-6)
    if name == "quasi-periodic":
        lines = torus(return_map(model).carry(np.array([0.8, 0.0]), 1024), unit=np.ones(2))
        assert lines.frequency == pytest.approx(0.7 / OMEGA, abs=4.0 * lines.error)


def test_a_label_of_a_chaotic_model_carries_its_exponent():
    """Duffing's equation with c = 0.3, F = 0.5, a known case."""
    model = SmoothModel(
        derivative=lambda t, y: np.array(
            [y[1], -0.3 * y[1] + y[0] - y[0] ** 3 + 0.5 * np.cos(1.2 * t)]
        ),
        jacobian=lambda t, y: np.array([[0.0, 1.0], [1.0 - 3.0 * y[0] ** 2, -0.3]]),
        period=2.0 * np.pi / 1.2,
        unit=np.ones(2),
        divergence=-0.3,
        tolerance=1e-8,
    )
    found = label(model, initial_state=(1.0, 0.0), discard=32, cap=96, starts=1)
    assert (found.name, found.followed, found.starts) == ("chaotic", 646, 1)
    assert found.lyapunov.sum == pytest.approx(-0.3)
    assert found.lyapunov.value == pytest.approx(found.lyapunov.batches.mean())


def test_the_exponent_of_a_linear_model_is_its_slowest_rate():
    matrix = np.diag([-0.2, -0.5, -1.1])
    model = SmoothModel(
        derivative=lambda t, y: matrix @ y + np.sin(OMEGA * t),
        jacobian=lambda t, y: matrix,
        period=1.0,
        unit=np.ones(3),
        divergence=float(np.trace(matrix)),
    )
    found = lyapunov_exponent(
        model, initial_state=(0.1, 0.2, 0.3), discard=5, batches=4, batch_periods=5
    )
    assert found.value == pytest.approx(-0.2, abs=1e-6)
    assert found.sum == pytest.approx(-1.8, rel=1e-12)
    assert found.state.shape == (3,)
