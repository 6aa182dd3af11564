"""`continue` of a case with shafts, whose train is one with a known torus point."""

from __future__ import annotations

import copy
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from tests.conftest import Compared
from tests.dynamics.geared_trains import moving_six
from tests.dynamics.test_geared_truth import TRUTH

from thermogear.analysis.bifurcations import TORUS
from thermogear.analysis.continuation import REACHED
from thermogear.analysis.curve import JUMP, Stretch
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.case.case import GearCase, load_example
from thermogear.case.one_point import of_case
from thermogear.study.shafts.branches import TrainGrid, Trains, train_branch_results, train_orbit
from thermogear.views.write import page_of

TRUE = float(TRUTH["Q1"]["values"]["eps"])
KELVIN = 300.0


@dataclass(frozen=True, eq=False)
class Known:
    """Truth Q1: its modulation stands for the speed, its speed for the temperature."""

    names: tuple[str, ...]
    cycle: int = 1

    def train(self, row: list[float]) -> Any:
        params = copy.deepcopy(TRUTH["Q1"]["params"])
        params["k_re"], params["k_im"] = [row[0] * params["k_mean"]], [0.0]
        params["rpm"] *= row[1] / KELVIN if len(row) > 1 else 1.0
        return SimpleNamespace(model=moving_six(params)[0])


@pytest.fixture
def trains(monkeypatch: pytest.MonkeyPatch) -> Trains:
    case = load_example("motor-train")
    assert isinstance(case, GearCase)
    found = Trains.of(case, of_case(case), operating=None, coordinates=None)

    def over(_: Trains, names: tuple[str, ...], axes: tuple[Any, ...]) -> TrainGrid:
        family: Any = Known(names)
        return TrainGrid(family, tuple(np.unique(axis) for axis in axes))

    monkeypatch.setattr(Trains, "over", over)
    return found


def test_a_torus_point_of_a_train_is_the_known_one(trains: Trains, compared: Compared) -> None:
    low, high = 0.8 * TRUE, 1.2 * TRUE
    temperatures = np.array([KELVIN, 1.002 * KELVIN])
    result = train_branch_results(
        trains, "pinion_speed", high, begin=low, count=3,
        second=("gear_temperature", temperatures),
    )  # fmt: skip
    events = [one for one in result.summary["bifurcations"] if one["kind"] == TORUS]
    assert len(events) == 1
    compared("torus point of a train by continue", "truth Q1", abs(events[0]["value"] - TRUE), 1e-6)
    assert result.summary["branches"][0]["ended"] == REACHED
    # settled by itself on either side, at the last temperature too, a pair crosses the circle
    curve = result.summary["curves"][0]
    assert [one["second"] for one in curve["asked"]] == temperatures.tolist()
    grid = trains.over(("pinion_speed", "gear_temperature"), (np.array([low, high]), temperatures))
    for one in curve["asked"]:
        sizes = [
            float(np.abs(train_orbit(grid(share * one["first"], one["second"]), period=1,
                                     transient=False)[0].multipliers).max())
            for share in (0.99, 1.01)
        ]  # fmt: skip
        assert sizes[0] < 1.0 < sizes[1]
    lines = page_of(result).lines()
    assert any(TORUS in line for line in lines)


def test_beyond_the_grid_is_refused(trains: Trains) -> None:
    grid = trains.over(("pinion_speed",), (np.array([0.8, 1.2]) * TRUE,))
    with pytest.raises(InputError, match="pinion_speed"):
        grid(2.0 * TRUE)
    with pytest.raises(InputError, match="--values"):
        train_branch_results(trains, "pinion_speed", TRUE, begin=0.5 * TRUE, count=1)


class Holed(Stretch):
    """Steps of which those within a hole hold no orbit; contact changes in it."""

    def __init__(self, low: float, high: float) -> None:
        self.hole = (low, high)
        self.points: Any = {0.0: SimpleNamespace(before=True), 1.0: SimpleNamespace(before=False)}

    def at(self, step: float) -> Any:
        low, high = self.hole
        if low < step < high:
            raise ConvergenceError(f"no orbit at {step}")
        self.points[step] = SimpleNamespace(before=step <= low)
        return self.points[step]


@pytest.mark.parametrize("size", [1e-9, 1e-6, 2e-5])
def test_a_change_of_contact_in_a_small_hole_is_found_beside_it(size: float) -> None:
    low = 1.0 / 3.0
    found = Holed(low, low + size).narrowed(lambda point: point.before, 0.0)  # type: ignore[attr-defined]
    assert low < found <= low + size + JUMP


def test_a_wide_hole_is_a_gap() -> None:
    with pytest.raises(ConvergenceError, match="no orbit"):
        Holed(0.3, 0.31).narrowed(lambda point: point.before, 0.0)  # type: ignore[attr-defined]
