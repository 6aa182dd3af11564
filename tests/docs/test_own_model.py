"""The page on a model of one's own: its code runs, and what it finds is the closed form."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Compared
from thermogear import IteratedMap, label
from thermogear.analysis.bifurcations import FLIP, FOLD
from thermogear.base.errors import InputError
from thermogear.dynamics.return_map import return_map

PAGE = Path(__file__).parents[2] / "docs" / "howto" / "own_model.md"


@pytest.fixture(scope="module")
def names() -> dict[str, Any]:
    found: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL):
        exec(compile(block, str(PAGE), "exec"), found)
    return found


def test_henons_map(names: dict[str, Any], compared: Compared) -> None:
    """Fixed points b x = y, a x^2 + (1 - b) x = 1; flip at a = 3 (1 - b)^2/4, then 0.9125."""
    a, b = 0.2, 0.3
    x = (b - 1.0 + np.sqrt((1.0 - b) ** 2 + 4.0 * a)) / (2.0 * a)
    orbit = names["orbit"]
    compared("fixed point of Hénon's map", "closed form", orbit.state - [x, b * x], 1e-12)
    both = np.sort(np.roots([1.0, 2.0 * a * x, -b]))
    found = np.sort(orbit.multipliers.real)
    compared("its multipliers", "closed form", found - both, 1e-12)
    flip = 0.75 * (1.0 - b) ** 2
    (located,) = names["branch"].of_kind(FLIP)
    compared("flip of Hénon's map", "closed form", located.value - flip, 1e-8)
    assert names["diagram"]["bifurcation_value"].values == pytest.approx([flip], abs=1e-8)
    assert np.isnan(names["diagram"]["contact_losses"].values).all()
    exponent = names["exponent"]
    compared("exponent at a = 1.4", "0.4192, published", exponent.value - 0.4192, 0.01)
    assert exponent.sum == pytest.approx(np.log(b), rel=1e-12)
    # flips at 0.48 for b = 0.2 and at 0.3675
    assert names["regimes"]["period"].values.tolist() == [[1, 1], [2, 2]]
    assert names["settled"].name == "period-1"
    assert names["ends"].sizes["attractor_number"] == 1
    assert (names["shares"]["motion_count"][:, 0] + names["shares"]["diverged"] == 100).all()


def test_a_ball_on_a_shaking_floor(names: dict[str, Any], compared: Compared) -> None:
    """One impact a period: u = pi, cos t = pi (1 - e)/((1 + e) G); det e^2, trace below.

    Holmes, J. Sound Vib. 84 (1982) 173, with the exact flight: trace 1 + e^2 - (1 + e)^2 G sin t.
    """
    e, g = 0.8, 0.6
    t = np.arccos(np.pi * (1.0 - e) / ((1.0 + e) * g))
    orbit = names["bouncing"]
    compared("impact of a ball", "closed form", orbit.state - [t, np.pi], 1e-10)
    trace = 1.0 + e * e - (1.0 + e) ** 2 * g * np.sin(t)
    known = np.roots([1.0, -trace, e * e])
    found = orbit.multipliers
    compared(
        "its multipliers", "closed form", np.sort_complex(found) - np.sort_complex(known), 1e-8
    )
    rest = np.pi * (1.0 - e) / (1.0 + e)
    flip = np.hypot(rest, 2.0 * (1.0 + e * e) / (1.0 + e) ** 2)
    compared("flip of a ball", "closed form", names["up"].of_kind(FLIP)[0].value - flip, 1e-7)
    compared("fold of a ball", "closed form", names["down"].of_kind(FOLD)[0].value - rest, 1e-7)


def test_the_jacobian_of_the_ball_is_its_derivative(names: dict[str, Any]) -> None:
    ball, state, small = names["Ball"](), np.array([0.7, 2.9]), 1e-6
    _, jacobian = ball.iterate(state)
    for k, way in enumerate(np.eye(2)):
        ends = [ball.iterate(state + sign * small * way)[0] for sign in (1.0, -1.0)]
        assert (ends[0] - ends[1]) / (2.0 * small) == pytest.approx(jacobian[:, k], abs=1e-7)


def test_duffings_equation(names: dict[str, Any], compared: Compared) -> None:
    """The product of the multipliers is exp(-0.3 T); small forces give the linear response."""
    driven = names["driven"]
    area = np.exp(-0.3 * 2.0 * np.pi / 1.2)
    product = np.prod(driven.multipliers) / area - 1.0
    compared("product of the multipliers", "Liouville", abs(product), 1e-10)
    force, w = 1e-4, 1.2
    orbit = names["periodic_orbit"](names["Duffing"](force), guess=(1.0, 0.0))
    linear = force / complex(2.0 - w * w, 0.3 * w)  # about x = 1, x'' + 0.3 x' + 2 x
    away = (orbit.state - [1.0 + linear.real, -w * linear.imag]) / force
    compared("small motion of Duffing's equation", "linear response", away, 1e-3)
    assert names["calm"].name == "period-1"
    assert return_map(names["Duffing"]()).determinant(1) == pytest.approx(area, rel=1e-12)


class Logistic(IteratedMap):
    """x' = r x (1 - x); ``row`` gives its Jacobian another shape."""

    unit = np.ones(1)

    def __init__(self, r: float, row: bool = False) -> None:
        self.r, self.row = r, row

    def iterate(self, state: Any) -> tuple[Any, Any]:
        slope = self.r * (1.0 - 2.0 * state)
        return self.r * state * (1.0 - state), slope if self.row else slope[None]


def test_what_leaves_every_bound_has_diverged_and_a_wrong_shape_is_told() -> None:
    """Beyond r = 4 almost every start of the logistic map leaves [0, 1] and runs to -infinity."""
    assert label(Logistic(3.2), initial_state=(0.3,)).name == "period-2"
    assert label(Logistic(4.5), initial_state=(0.3,)).name == "diverged"
    with pytest.raises(InputError, match=r"iterate.*\(1,\) and \(1,\).*\(1, 1\)"):
        label(Logistic(3.2, row=True), initial_state=(0.3,))
