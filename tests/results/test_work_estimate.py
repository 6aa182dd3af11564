"""What an estimate says of work whose cost is known, for a twentieth of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from thermogear.base.plan import Variable
from thermogear.results import work
from thermogear.results.work import BRIEF, LONG, SPENT, estimate


@dataclass
class Costly:
    """Work of ``points`` that take ``each`` [s] on a clock of its own; ``compile`` [s] at first."""

    points: int
    each: float
    compile: float = 0.0
    now: float = 0.0
    compiled: float = 0.0
    asked: list[int] = field(default_factory=list)
    kind: str = "costly"

    @property
    def sizes(self) -> dict[str, int]:
        return {"x": self.points}

    @property
    def cuts(self) -> dict[str, int]:
        return {"x": self.points}

    def variables(self) -> dict[str, Variable]:
        return {"status": Variable(("x",), "int8", 0)}

    def needs(self, key: object) -> None:
        return None

    def pilot(self, share: float, turn: int) -> float:
        count = min(max(1, round(share * self.points)), self.points)
        self.asked.append(count)
        if len(self.asked) == 1:
            self.now, self.compiled = self.now + self.compile, self.compile
            self.now += 0.3 * LONG * (self.each < 0.1)  # kernels and tables are loaded
        self.now += count * self.each
        return count / self.points


@pytest.fixture
def clocked(monkeypatch: pytest.MonkeyPatch) -> Callable[[Costly], Any]:
    """``estimate`` of one thread by the clock of the work."""

    def found(plan: Costly) -> Any:
        @contextmanager
        def timer(_: str, told: Callable[[float], None]) -> Iterator[None]:
            before = len(plan.asked)
            yield
            told(plan.compiled if before == 0 else 0.0)

        monkeypatch.setattr(work, "install_timer", timer)
        monkeypatch.setattr(work, "time", SimpleNamespace(perf_counter=lambda: plan.now))
        return estimate(plan, threads=1)  # type: ignore[arg-type]

    return found


@pytest.mark.parametrize("compile_time", [0.0, 90.0])
@pytest.mark.parametrize(("points", "each"), [(10_000, 1e-3), (400, 5e-3), (48, 130.0), (3, 2.0)])
def test_an_estimate_is_the_cost_of_the_work_without_what_is_compiled_once(
    clocked: Callable[[Costly], Any], points: int, each: float, compile_time: float
) -> None:
    plan = Costly(points, each, compile_time)
    assert clocked(plan).seconds == pytest.approx(points * each, rel=1e-9)
    spent = sum(plan.asked) * each
    # less than one point cannot be computed, and the first of short ones loads what it needs
    assert spent <= max(BRIEF, SPENT * points * each, each) + each * (each < LONG) + 1e-9


def test_compiling_is_told_apart_by_numba_itself() -> None:
    """The timer that an estimate installs hears of what numba compiles, and of nothing else."""
    from numba import njit

    heard: list[float] = []
    made = njit(lambda x: x + 1.0)
    with work.install_timer("numba:compile", heard.append):
        made(1.0)
    assert heard[0] > 0.0
    with work.install_timer("numba:compile", heard.append):
        made(2.0)
    assert np.allclose(heard[1:], 0.0)
