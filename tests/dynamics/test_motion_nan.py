"""What is not a number never counts as a motion: integrators end with a status or an error."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import STATUS
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import TorsionalModel

BASE = TorsionalModel(
    damping_ratio=0.1535,
    frequency=1.245,
    stiffness_amplitude=0.335,
    mean_force=0.017,
    force_amplitude=-1.16,
)
NAN = float("nan")


@dataclass(frozen=True)
class Given:
    """A clearance model whose numbers nobody looked at."""

    table: Lanes

    def lanes(self) -> Lanes:
        return self.table


def lost(name: str) -> Given:
    """Two lanes, the second with a coefficient that is no number."""
    lanes = BASE.lanes().take([0, 0])
    values = np.array(getattr(lanes, name))
    values[(1, -1) if values.ndim == 2 else 1] = NAN
    return Given(replace(lanes, **{name: values}))


@pytest.mark.parametrize("name", ["stiffness", "force", "damping", "half_backlash"])
@pytest.mark.parametrize("method", ["exact", "rk4"])
def test_a_lane_without_numbers_is_refused_or_diverges_alone(method: str, name: str) -> None:
    if method == "exact":
        with pytest.raises(InputError, match=r"^frequency: got .* more than \d+ sub-steps"):
            simulate(lost(name), periods=2, method=method)
        return
    data = simulate(lost(name), periods=2, method=method, initial_state=(3.0, 0.0))
    assert data["status"].values.tolist() == [0, STATUS.index("diverged")]
    alone = simulate(BASE, periods=2, method=method, initial_state=(3.0, 0.0))
    assert np.array_equal(data["section_x"].values[0], alone["section_x"].values[0])


def test_a_start_must_be_a_number() -> None:
    with pytest.raises(InputError, match=r"^initial_state: got \[nan, 0\.0\]; allowed finite"):
        simulate(BASE, periods=2, initial_state=(NAN, 0.0))


@dataclass(frozen=True)
class Own:
    """A model of one's own whose derivative is lost from the time ``since`` on."""

    since: float
    half_backlash: float | None = None
    period: float = 1.0

    def derivative(self, t: float, y: np.ndarray) -> np.ndarray:
        return np.array([y[1], NAN if t >= self.since else -y[0]])


@pytest.mark.parametrize("backlash", [None, 1.0])
@pytest.mark.parametrize("since", [0.0, 0.3])
def test_the_adaptive_reference_does_not_step_where_nothing_is_known(
    since: float, backlash: float | None
) -> None:
    with pytest.raises(ConvergenceError, match=r"^adaptive reference: "):
        simulate(Own(since, backlash), periods=2, initial_state=(0.5, 0.0), method="adaptive")
