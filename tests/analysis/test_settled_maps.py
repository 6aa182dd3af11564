"""What a start settles on, by maps whose answer is known: slow spirals, locked circles, thresholds.

z' = z e^{2 pi i nu} (rho + a |z|^2) + b conj(z)^(p - 1) in the plane: the normal form of a pair of
multipliers that leaves the unit circle, with its resonance p.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from conftest import Compared
from said import numbers
from thermogear.analysis.agreement import End, beside, judged
from thermogear.analysis.any_motion import settle
from thermogear.analysis.labels import label
from thermogear.analysis.walk import Motion, Search
from thermogear.base.errors import ConvergenceError
from thermogear.dynamics.return_map import Stretch, Visit, stretched

Floats = Any


@dataclass(frozen=True, kw_only=True)
class Turning:
    """The map of this file; ``slowest``: what it decays by at rest, 0: it does not say."""

    nu: float
    rho: float
    a: float = 0.0
    b: float = 0.0
    p: int = 2
    slowest: float = 0.0
    dimension: int = 2
    period: float = 1.0

    @property
    def unit(self) -> Floats:
        return np.ones(2)

    def determinant(self, periods: int) -> float:
        return float("nan")

    def distance(self, one: Floats, other: Floats) -> Floats:
        return np.asarray(np.max(np.abs(one - other), axis=-1))

    def step(self, z: complex) -> complex:
        turn = np.exp(2j * np.pi * self.nu)
        found = z * turn * (self.rho + self.a * abs(z) ** 2) + self.b * np.conj(z) ** (self.p - 1)
        if not abs(found) < 1e3:
            raise ConvergenceError("it runs away")
        return complex(found)

    def slope(self, z: complex) -> Floats:
        """d(x', y')/d(x, y) by the derivatives with respect to z and its conjugate."""
        turn = np.exp(2j * np.pi * self.nu)
        by_z = turn * (self.rho + 2.0 * self.a * abs(z) ** 2)
        by_other = turn * self.a * z * z + self.b * (self.p - 1) * np.conj(z) ** (self.p - 2)
        one, two = by_z + by_other, 1j * (by_z - by_other)
        return np.array([[one.real, two.real], [one.imag, two.imag]])

    def carry(self, start: Floats, periods: int) -> Floats:
        z, found = complex(*start), []
        for _ in range(periods):
            z = self.step(z)
            found.append((z.real, z.imag))
        return np.array(found)

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        return stretched(self, start, direction=direction, periods=periods)  # type: ignore[arg-type]

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        jacobian, points = np.eye(2), [np.asarray(start, dtype=float)]
        for _ in range(periods):
            jacobian = self.slope(complex(*points[-1])) @ jacobian
            points.append(self.carry(points[-1], 1)[0])
        return Visit(
            points=np.array(points), jacobian=jacobian, contact_losses=0, back_impacts=0,
            shares=np.zeros(3), samples=np.zeros((0, 2)),
        )  # fmt: skip


@pytest.mark.parametrize("decay", [1e-3, 2e-4, 3e-5])
def test_a_slow_spiral_is_told_by_its_multipliers(decay: float) -> None:
    """A model that decays slowly at rest is not near a bifurcation because of it."""
    rho = 1.0 - decay
    start = np.array([0.8, 0.1])
    found = settle(Turning(nu=0.1234, rho=rho, slowest=rho), start)
    assert (found.name, found.period) == ("period-1", 1)
    # long before it has come near by itself
    assert found.discarded <= 2048
    assert found.away > 0.1
    assert abs(abs(found.multiplier) - rho) < 1e-9
    # the same decay of a model that decays fast at rest is near one
    fast = settle(Turning(nu=0.1234, rho=rho, slowest=0.9), start)
    assert fast.name == "undecided"
    assert "bifurcation" in fast.reason


def test_outside_a_threshold_nothing_is_neared() -> None:
    """A stable point with an unstable circle of radius 0.04 around it, all within a return."""
    limit = 0.04
    decay = 1e-3
    one = Turning(nu=0.31, rho=1.0 - decay, a=decay / limit**2, slowest=1.0 - decay)
    inside = settle(one, np.array([0.9 * limit, 0.0]))
    assert inside.name == "period-1"
    outside = settle(one, np.array([1.02 * limit, 0.0]))
    assert outside.name == "diverged"


def test_a_circle_that_locks_has_a_long_period(compared: Compared) -> None:
    """Random resonances p: nu within the tongue of k/p."""
    rng = np.random.default_rng(20261125)
    worst, seen = 0.0, []
    for p in (17, 23, 31):
        k = int(rng.integers(2, p // 2))
        while np.gcd(k, p) > 1:
            k += 1
        # radius 1; half width of the tongue b/2 pi in nu
        b = 0.02 / p
        nu = k / p + float(rng.uniform(-0.4, 0.4)) * b / (2.0 * np.pi)
        one = Turning(nu=nu, rho=1.1, a=-0.1, b=b, p=p)
        start = rng.uniform(-0.5, 0.5, 2)
        found = settle(one, start, Search(cap=1024, sections=1024))
        seen.append((found.name, found.period))
        assert seen[-1] == (f"period-{p}", p)
        assert found.orbit is not None
        late = one.carry(start, 60 * p)[-1]
        worst = max(worst, float(np.min(one.distance(found.orbit.points, late))))
    compared("orbits of locked tori", "followed long", worst, 1e-6)


def test_a_circle_that_does_not_lock() -> None:
    nu = (np.sqrt(5.0) - 1.0) / 2.0 / 2.0
    one = Turning(nu=nu, rho=1.1, a=-0.1, b=0.004, p=17)
    found = settle(one, np.array([0.3, 0.2]), Search(cap=512, sections=1024))
    assert found.name == "quasi-periodic"
    assert found.torus is not None
    assert found.orbit is None


def test_a_small_period_2_is_not_taken_for_a_point() -> None:
    """A motion smaller than what counts as a return, about a point that is unstable."""
    one = Turning(nu=0.5, rho=1.002, a=-0.002 / 0.01**2, slowest=0.99)
    found = settle(one, np.array([0.012, 0.0]))
    assert found.period == 2
    assert found.name in ("period-2", "undecided")


@dataclass(frozen=True, kw_only=True)
class Quadratic:
    """x' = r x (1 - x): at most one stable orbit, which almost every start ends on (Singer)."""

    r: float
    dimension: int = 1
    period: float = 1.0

    @property
    def unit(self) -> Floats:
        return np.ones(1)

    def determinant(self, periods: int) -> float:
        return float("nan")

    def distance(self, one: Floats, other: Floats) -> Floats:
        return np.asarray(np.max(np.abs(one - other), axis=-1))

    def carry(self, start: Floats, periods: int) -> Floats:
        x, r, found = float(start[0]), self.r, []
        for _ in range(periods):
            x = r * x * (1.0 - x)
            found.append(x)
        return np.array(found)[:, None]

    def slopes(self, start: Floats, periods: int) -> tuple[Floats, Floats]:
        path = np.vstack([start[None], self.carry(start, periods)])
        return path, self.r * (1.0 - 2.0 * path[:-1, 0])

    def stretch(self, start: Floats, *, direction: Floats, periods: int) -> Stretch:
        path, slopes = self.slopes(start, periods)
        return Stretch(state=path[-1], direction=direction, growth=np.log(np.abs(slopes)))

    def visit(self, start: Floats, periods: int = 1, *, sampled: bool = False) -> Visit:
        path, slopes = self.slopes(start, periods)
        with np.errstate(over="ignore"):
            slope = np.prod(slopes)
        return Visit(
            points=path, jacobian=np.array([[slope]]), contact_losses=0, back_impacts=0,
            shares=np.zeros(3), samples=np.zeros((0, 1)),
        )  # fmt: skip


@pytest.mark.parametrize(
    ("r", "n", "all_end"),
    [
        (3.813617278546642, 13, True),
        (3.96867318335792, 11, True),
        (3.9790291280644086, 11, True),
        (3.98027268283993, 12, False),
    ],
)
def test_a_transient_is_not_called_chaos(r: float, n: int, all_end: bool) -> None:
    """At these r the orbit of the maximum closes after n: it is stable, and nothing else is.

    One start is chaotic by its exponent for thousands of periods before it ends there.
    """
    one = Quadratic(r=r)
    assert abs(one.carry(np.array([0.5]), n)[-1, 0] - 0.5) < 1e-9
    start = np.array([0.3])
    assert settle(one, start, Search(starts=1)).name == "chaotic"
    names = set()
    for near in (start, *beside(start, unit=one.unit, count=4)):
        found = settle(one, near)
        names.add(found.name)
        if found.name == "undecided":
            assert found.period == n
            assert 16.0 in numbers(found.reason)
    assert names <= {f"period-{n}", "undecided"}
    assert not all_end or f"period-{n}" in names


def test_chaos_is_told_with_its_length_and_its_starts() -> None:
    """r = 4: chaotic for ever, ln 2 a period."""
    found = label(Quadratic(r=4.0), initial_state=(0.3,), discard=64, cap=1024, starts=4,
                  follow=2000)  # fmt: skip
    assert (found.name, found.followed, found.starts) == ("chaotic", 2000, 4)
    assert found.lyapunov is not None
    assert abs(found.lyapunov.value - np.log(2.0)) < 4.0 * found.lyapunov.error
    assert numbers(found.reason)[-2:] == [4.0, 2000.0]


def test_starts_that_end_apart_decide_nothing() -> None:
    ends = [Motion(name=name, period=n, reason="", state=np.zeros(1), discarded=9)
            for name, n in (("period-1", 1), ("period-2", 2))]  # fmt: skip
    proof = {"lyapunov": 0.1, "batches": np.full(8, 0.1), "exponents": np.array([0.1, 0.0])}
    wild = replace(ends[0], name="chaotic", period=0, **proof)
    found = judged(wild, [End(ends[0], 9), End(ends[1], 20), End(None, 30)])
    # nothing of what proved one of them is kept
    assert found.batches.size == found.exponents.size == 0
    assert found.state is wild.state
    assert (found.name, found.period, found.discarded) == ("undecided", 0, 30)
    assert numbers(found.reason)[-1] == 3.0
    assert np.isnan(found.lyapunov)
