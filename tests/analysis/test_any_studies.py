"""Diagrams, maps and basins of models by their return map alone, against those of one mass."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.basins import basins
from thermogear.analysis.diagram import orbit_diagram
from thermogear.analysis.maps import parameter_map
from thermogear.analysis.settle import CHAOTIC, PERIODIC
from thermogear.base.errors import InputError
from thermogear.dynamics.exact_map import ExactMap
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.plane import plane_of
from thermogear.dynamics.return_map import Stretch, Visit, stretched
from thermogear.dynamics.smooth_map import SmoothModel

BASE = TorsionalModel(
    damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.2, mean_force=0.1,
    force_amplitude=0.05,
)  # fmt: skip
FADE = 0.25


@dataclass(frozen=True)
class Longer:
    """One mass and a third number that fades by itself: (x, x', w), known by its map alone."""

    frequency: float
    force_amplitude: float = BASE.force_amplitude

    def return_map(self, samples: int = 0) -> LongerMap:
        changes: dict[str, Any] = {
            "frequency": self.frequency, "force_amplitude": self.force_amplitude,
        }  # fmt: skip
        return LongerMap(ExactMap(replace(BASE, **changes).lanes()))


class LongerMap:
    """The map of :class:`Longer`."""

    def __init__(self, inner: ExactMap) -> None:
        self.inner = inner
        self.dimension, self.period = 3, inner.period
        self.unit = np.append(inner.unit, 1.0)

    def determinant(self, periods: int) -> float:
        return self.inner.determinant(periods) * FADE**periods

    def distance(self, one: Any, other: Any) -> Any:
        return np.max(np.abs(one - other) / self.unit, axis=-1)

    def _faded(self, start: Any, periods: int) -> Any:
        return start[2] * FADE ** np.arange(1, periods + 1)

    def carry(self, start: Any, periods: int) -> Any:
        inner = self.inner.carry(start[:2], periods)
        return np.column_stack([inner, self._faded(start, periods)])

    def stretch(self, start: Any, *, direction: Any, periods: int) -> Stretch:
        return stretched(self, start, direction=direction, periods=periods)

    def visit(self, start: Any, periods: int = 1, *, sampled: bool = False) -> Visit:
        found = self.inner.visit(start[:2], periods)
        jacobian = np.zeros((3, 3))
        jacobian[:2, :2], jacobian[2, 2] = found.jacobian, FADE**periods
        last = np.append(start[2], self._faded(start, periods))
        return replace(found, points=np.column_stack([found.points, last]), jacobian=jacobian)


def test_a_diagram_and_its_branches() -> None:
    values = np.linspace(0.5, 1.1, 9)
    ours = orbit_diagram(Longer(0.7), "frequency", values, block=4)
    known = orbit_diagram(BASE, "frequency", values, block=4)
    for name in ("label", "period", "contact_losses", "back_impacts"):
        np.testing.assert_array_equal(ours[name], known[name])
    np.testing.assert_allclose(ours["section_x"], known["section_x"], atol=1e-7)
    np.testing.assert_allclose(ours["section_v"], known["section_v"], atol=1e-7)
    kinds, at = ours["bifurcation_kind"].values, ours["bifurcation_value"].values
    assert kinds.tolist() == known["bifurcation_kind"].values.tolist()
    assert kinds.size > 0
    np.testing.assert_allclose(at, known["bifurcation_value"], rtol=1e-6)
    assert ours["end"].shape[-1] == 3


def test_a_diagram_goes_on_whatever_its_blocks() -> None:
    values = np.linspace(0.6, 0.8, 6)
    one = orbit_diagram(Longer(0.7), "frequency", values, block=2, branch_period=0)
    other = orbit_diagram(Longer(0.7), "frequency", values, block=6, branch_period=0)
    np.testing.assert_array_equal(one["end"], other["end"])
    whole = orbit_diagram(
        Longer(0.7), "frequency", values, starts=[(0.0, 0.0, 5.0)], branch_period=0
    )
    np.testing.assert_array_equal(whole["period"], one["period"])


def test_a_map() -> None:
    axes = {"frequency": np.linspace(0.5, 2.2, 8), "force_amplitude": np.linspace(0.02, 0.4, 6)}
    ours, known = parameter_map(Longer(0.7), axes), parameter_map(BASE, axes)
    assert {1, 2, 4} <= set(known["period"].values.ravel().tolist())
    assert set(known["label"].values.ravel().tolist()) == {PERIODIC, CHAOTIC}
    for name in ("label", "period", "status"):
        np.testing.assert_array_equal(ours[name], known[name])
    np.testing.assert_allclose(ours["point_x"], known["point_x"], atol=1e-7)


def test_basins_of_two_orbits() -> None:
    model = replace(BASE, frequency=0.74)
    x, v = np.linspace(-1.5, 2.5, 9), np.linspace(-1.0, 1.0, 8)
    ours = basins(Longer(0.74), x=x, v=v, survey=5)
    known = basins(model, x=x, v=v, survey=5)
    np.testing.assert_array_equal(ours["attractor"], known["attractor"])
    np.testing.assert_allclose(ours["attractor_x"], known["attractor_x"], atol=1e-6)
    np.testing.assert_allclose(ours["border_distance"], known["border_distance"], rtol=1e-6)


def test_the_plane_of_a_train() -> None:
    """A start (x, v) is found again, and moves nothing that a blow of the teeth does not move."""
    model, _, _ = moving_six(TRUTH["N1"]["params"])
    plane = plane_of(model)
    pairs = np.array([[0.3, -0.2], [1.5, 0.7]])
    states = plane.starts(pairs)
    np.testing.assert_allclose(plane.of(states), pairs, atol=1e-12)
    n = model.size
    pushed = model.mass @ (states[:, :n] - plane.rest[:n]).T
    along = np.outer(model.drive, model.drive @ pushed / (model.drive @ model.drive))
    np.testing.assert_allclose(pushed, along, atol=1e-12 * np.abs(pushed).max())


def test_a_diagram_of_a_train_with_a_swinging_journal() -> None:
    """Truth N1: two mesh periods at its backlash, from rest."""
    model, _, _ = moving_six(TRUTH["N1"]["params"])
    b = model.half_backlash
    found = orbit_diagram(
        model, "half_backlash", [b, 1.01 * b], starts=[(1.0, 0.0)], branch_period=0, keep=4
    )
    assert found["period"].values.ravel().tolist() == [2, 2, 2, 2]


def test_starts_of_a_length_that_no_state_has_are_refused() -> None:
    with pytest.raises(InputError) as told:
        orbit_diagram(Longer(0.7), "frequency", [0.7, 0.8], starts=[(0.0,)])
    assert told.value.field == "starts"
    with pytest.raises(InputError) as told:
        parameter_map(
            Longer(0.7), {"frequency": [0.7], "force_amplitude": [0.1]}, initial_state=np.zeros(4)
        )
    assert told.value.field == "initial_state"


def test_a_parameter_that_the_result_has_already_is_refused() -> None:
    model = SmoothModel(
        derivative=lambda t, y: -y, jacobian=lambda t, y: -np.eye(2), period=1.0, unit=np.ones(2)
    )
    with pytest.raises(InputError) as told:
        orbit_diagram(model, "period", [1.0, 2.0])
    assert told.value.field == "parameter"
    with pytest.raises(InputError) as told:
        parameter_map(model, {"period": [1.0], "tolerance": [1e-9]})
    assert told.value.field == "parameter"
    found = parameter_map(model, {"divergence": [-2.0, -2.5], "tolerance": [1e-9]})
    assert found["period"].values.ravel().tolist() == [1, 1]
