"""Five verdicts on the thesis, recomputed in two ways by code that is not the package's.

``make trial NAME=verdicts`` writes trials/records/verdicts.md. The equation is

    x'' + 2 zeta x' + [1 + eps cos(w t) + eps_T] f(x; b) = F_m + F_h cos(w t)

with f = 0 inside the backlash. Between two edges of the backlash it is linear. A motion and its two
variations are followed from edge to edge: by ``scipy.integrate.solve_ivp`` with events, and piece
by piece by the power series in time that solves the linear equation. Exit code 1: a column differs
from another by more than the last digit shown.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import product
from pathlib import Path

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from thermogear.analysis.labels import label
from thermogear.case.case import DimensionlessCase, load_example
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map
from thermogear.measured.published import rounded_error
from thermogear.study.run import run
from thermogear.thesis import motions

Floats = NDArray[np.float64]
PAGE = Path(__file__).parents[1] / "trials" / "records" / "verdicts.md"
REST = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
"""x and x' of the motion, at rest, and of its two variations."""
PIECES, ORDER = 24, 24
"""Pieces of a period at least, and terms of a series: round-off decides."""
SETTLING = 400
"""Periods from rest before a closed orbit is looked for [1]."""


@dataclass(frozen=True)
class Equation:
    """The dimensionless numbers; the base set of the ready-made table 4.2."""

    zeta: float = 0.1535
    w: float = 1.245
    eps: float = 0.335
    mean: float = 0.017
    swing: float = -1.16
    b: float = 1.0
    eps_t: float = 0.0

    @property
    def period(self) -> float:
        """Of the excitation."""
        return 2.0 * np.pi / self.w

    def model(self) -> TorsionalModel:
        """The same for the package."""
        return TorsionalModel(
            damping_ratio=self.zeta, frequency=self.w, stiffness_amplitude=self.eps,
            mean_force=self.mean, force_amplitude=self.swing, half_backlash=self.b,
            thermal_stiffness=self.eps_t,
        )  # fmt: skip

    def side(self, x: float, v: float) -> int:
        """1 drive side, -1 back side, 0 in the backlash; on an edge where the motion goes."""
        gap = abs(x) - self.b
        outside = gap > 1e-12 or (abs(gap) <= 1e-12 and x * v > 0.0)
        return int(np.sign(x)) if outside else 0


Piece = tuple[float, float, Callable[[Floats], Floats]]
"""Begin, end, and x over time from the begin."""
Follow = Callable[[Equation, Floats], tuple[Floats, list[Piece]]]
"""State (2, 3) at t = 0 -> that after a period, and the pieces between."""


def by_scipy(q: Equation, state: Floats) -> tuple[Floats, list[Piece]]:
    """A period by DOP853, restarted at every edge."""
    t, pieces = 0.0, []
    while t < q.period:
        side = q.side(state[0, 0], state[1, 0])

        def slope(at: float, y: Floats, side: int = side) -> Floats:
            x, v = y.reshape(2, 3)
            stiffness = abs(side) * (1.0 + q.eps * np.cos(q.w * at) + q.eps_t)
            force = np.array([q.mean + q.swing * np.cos(q.w * at) + stiffness * side * q.b, 0, 0])
            return np.concatenate([v, force - 2.0 * q.zeta * v - stiffness * x])

        def leaves(_: float, y: Floats, side: int = side) -> float:
            return float(side * y[0] - q.b if side else q.b - abs(y[0]))

        leaves.terminal, leaves.direction = True, -1  # type: ignore[attr-defined]
        found = solve_ivp(
            slope, (t, q.period), state.ravel(), "DOP853", rtol=1e-12, atol=1e-13,
            events=leaves, dense_output=True,
        )  # fmt: skip
        end = float(found.t[-1])
        pieces.append((t, end, lambda h, s=found.sol, t=t: s(t + h)[0]))
        state, t = found.y[:, -1].reshape(2, 3), end
    return state, pieces


def by_pieces(q: Equation, state: Floats) -> tuple[Floats, list[Piece]]:
    """A period by the power series of each piece."""
    t, pieces, k = 0.0, [], np.arange(ORDER)
    while q.period - t > 1e-13:
        side = q.side(state[0, 0], state[1, 0])
        c = np.cumprod(np.r_[1.0, q.w / k[1:]]) * np.cos(q.w * t + 0.5 * np.pi * k)
        stiffness = abs(side) * (q.eps * c + (1.0 + q.eps_t) * (k == 0))
        a, load = np.zeros((ORDER, 3)), q.swing * c + q.mean * (k == 0)
        a[:2], shift = state, side * q.b * np.array([1.0, 0.0, 0.0])
        for n in range(ORDER - 2):
            spring = stiffness[n::-1] @ a[: n + 1] - stiffness[n] * shift
            force = np.array([load[n], 0.0, 0.0]) - 2.0 * q.zeta * (n + 1) * a[n + 1] - spring
            a[n + 2] = force / ((n + 1) * (n + 2))
        h = min(q.period / PIECES, q.period - t)

        def inside(s: Floats, x: Floats = a[:, 0], side: int = side) -> Floats:
            return side * polyval(s, x) - q.b if side else q.b - np.abs(polyval(s, x))

        grid = np.linspace(0.0, h, 13)[1:]
        out = np.flatnonzero(inside(grid) < 0.0)
        if out.size:
            low = grid[out[0] - 1] if out[0] else 1e-9 * h
            h = brentq(inside, low, grid[out[0]], xtol=1e-15)
        pieces.append((t, t + h, lambda s, x=a[:, 0]: polyval(s, x)))
        powers = h**k
        state, t = np.stack([powers @ a, (k[1:] * powers[:-1]) @ a[1:]]), t + h
    return state, pieces


def periods(q: Equation, follow: Follow, at: Floats, count: int) -> tuple[Floats, list[Piece]]:
    """``count`` periods from (x, x') with fresh variations."""
    state, pieces = REST.copy(), []
    state[:, 0] = at
    for n in range(count):
        state, more = follow(q, state)
        pieces += [(a + n * q.period, b + n * q.period, x) for a, b, x in more]
    return state, pieces


def settled(q: Equation) -> Floats:
    """(x, x') after a run from rest, where an orbit is then looked for."""
    return periods(q, by_pieces, np.zeros(2), SETTLING)[0][:, 0]


def orbit(q: Equation, follow: Follow, near: Floats, count: int) -> tuple[Floats, Floats]:
    """(x, x') of the closed orbit by Newton's method, and its multipliers' matrix."""
    at = near
    for _ in range(12):
        end = periods(q, follow, at, count)[0]
        step = np.linalg.solve(end[:, 1:] - np.eye(2), at - end[:, 0])
        at = at + step
        if np.abs(step).max() < 1e-10:
            break
    return at, periods(q, follow, at, count)[0][:, 1:]


def flip(q: Equation, follow: Follow, near: float, count: int) -> float:
    """w at which an orbit of ``count`` periods has the multiplier -1, within .004 of ``near``."""
    start = {"at": settled(replace(q, w=near + 0.004))}

    def at_minus_one(w: float) -> float:
        start["at"], matrix = orbit(replace(q, w=w), follow, start["at"], count)
        return float(np.linalg.det(matrix + np.eye(2)))

    return float(brentq(at_minus_one, near + 0.004, near - 0.004, xtol=1e-9))


def half_line(q: Equation, follow: Follow, near: Floats) -> float:
    """Amplitude at half the mesh frequency of the closed orbit of two periods."""
    at, _ = orbit(q, follow, near, 2)
    nodes, weights = np.polynomial.legendre.leggauss(24)
    total = 0.0j
    for begin, end, x in periods(q, follow, at, 2)[1]:
        for a, b in zip(*(np.linspace(begin, end, 5)[k:][:4] for k in (0, 1)), strict=True):
            t = 0.5 * (b - a) * nodes + 0.5 * (a + b)
            total += 0.5 * (b - a) * weights @ (x(t - begin) * np.exp(-0.5j * q.w * t))
    return float(abs(total) / q.period)


def structure() -> tuple[list[str], ...]:
    """4.3.2 for the forces of section 4.1: the first two flips over w, without heat and with it."""
    cold = Equation(mean=0.0136, swing=-0.928)
    hot = replace(cold, b=1.0 - 0.2 * 120.0 / 140.0, eps_t=0.02 * 120.0 / 140.0)
    base = motions.rows(load_example("table-4.2"), load_example("section-4.1"))
    changed = replace(base, base={**base.base, "mean_force": 0.0136, "force_amplitude": -0.928})
    value = motions.flips(changed, 2)["value"].sel(row="omega")
    ours = [float(v) for heat in ("none", "thesis") for v in value.sel(heat=heat).values]
    near = [
        (q, round(w, 3), n)
        for q, w, n in zip((cold, cold, hot, hot), ours, (1, 2, 1, 2), strict=True)
    ]
    return [f"{w:.7f}" for w in ours], *(
        [f"{flip(q, way, w, n):.7f}" for q, w, n in near] for way in (by_scipy, by_pieces)
    )


def area() -> tuple[list[str], ...]:
    """4.2.2, 4.2.4, 4.2.9: what a period leaves of an area, by the variations of a chaotic run."""
    ends = (Equation(zeta=0.10), Equation(w=1.1), Equation(eps=0.9))
    ours = [f"{return_map(q.model()).determinant(1):.9f}" for q in ends]
    return ours, *(
        [f"{np.linalg.det(periods(q, way, np.array([0.3, 0.2]), 1)[0][:, 1:]):.9f}" for q in ends]
        for way in (by_scipy, by_pieces)
    )


def printed_error() -> tuple[list[str], ...]:
    """5.2.313: 41 um beside 48.5 um as rounded: corners in fractions, random draws."""
    low, high = rounded_error(simulated=41e-6, measured=48.5e-6, quantity="displacement")
    corners = [
        100 * abs(s - m) / m
        for s, m in product(
            (Fraction("40.5"), Fraction("41.5")), (Fraction("48.45"), Fraction("48.55"))
        )
    ]
    drawn = np.random.default_rng(5).uniform((40.5, 48.45), (41.5, 48.55), (2_000_000, 2)).T
    errors = 100.0 * np.abs(drawn[0] / drawn[1] - 1.0)
    return tuple(
        [f"{float(v):.2f}" for v in ends]
        for ends in ((low, high), (min(corners), max(corners)), (errors.min(), errors.max()))
    )


def table_label() -> tuple[list[str], ...]:
    """4.2.8 at eps = .3: an orbit of two periods that does not close after one, multipliers."""
    q = Equation(eps=0.3)
    ours = label(q.model())
    assert ours.orbit is not None
    told = [f"period-{ours.period}", f"{np.abs(ours.orbit.multipliers).max():.6f}"]
    columns, near = [told], settled(q)
    for way in (by_scipy, by_pieces):
        at, matrix = orbit(q, way, near, 2)
        once = np.abs(periods(q, way, at, 1)[0][:, 0] - at).max()
        columns.append([
            f"period-{2 if once > 1e-3 else 1}",
            f"{np.abs(np.linalg.eigvals(matrix)).max():.6f}",
        ])  # fmt: skip
    return tuple(columns)


def line() -> tuple[list[str], ...]:
    """4.1.8 at 125, 140 and 160 degC, in half backlashes."""
    case = load_example("section-4.1")
    assert isinstance(case, DimensionlessCase)
    points = run(case).groups["points"]
    here = points.isel(point=np.flatnonzero(points["row"].values == "thesis"))
    ours = [f"{v:.6f}" for v in here["half_order_amplitude"].values[2:]]
    heated = [
        Equation(w=1.300551, mean=0.0136, swing=-0.928, b=1.0 - 0.2 * rise, eps_t=0.02 * rise)
        for rise in (105.0 / 140.0, 120.0 / 140.0, 1.0)
    ]
    near = [settled(q) for q in heated]
    return ours, *(
        [f"{half_line(q, way, at):.6f}" for q, at in zip(heated, near, strict=True)]
        for way in (by_scipy, by_pieces)
    )


VERDICTS = {
    "4.3.2, forces of section 4.1: flips over ω_h, periods 1, 2, without, with heat": structure,
    "4.2.2, 4.2.4, 4.2.9: area left after a period at ζ .1, ω_h 1.1, ε .9": area,
    "5.2.313: least and greatest error of 41 against 48.5 µm as rounded [%]": printed_error,
    "4.2.8: ε = .3, label and largest multiplier over two periods": table_label,
    "4.1.8: line at half the frequency at 125, 140, 160 °C [half backlashes]": line,
}


def agree(columns: tuple[list[str], ...]) -> bool:
    """Equal words; numbers to one unit of the last digit."""
    for cells in zip(*columns, strict=True):
        if len(set(cells)) > 1:
            values = [float(cell) for cell in cells]
            if max(values) - min(values) > 1.5 * 10.0 ** -len(cells[0].partition(".")[2]):
                return False
    return True


def main() -> int:
    began = time.process_time()
    found = {words: judge() for words, judge in VERDICTS.items()}
    rows = [
        "| " + " | ".join([words, *(", ".join(column) for column in columns)]) + " |"
        for words, columns in found.items()
    ]
    bad = [words for words, columns in found.items() if not agree(columns)]
    seconds = time.process_time() - began
    PAGE.write_text("\n".join([

        "# Five verdicts by other code", "",
        f"Made by `make trial NAME=verdicts` ({seconds:.0f} s of processor time). The "
        f"second and third",
        "way share no code with the package: scipy's DOP853, restarted at every edge of the",
        "backlash, and the power series in time that solves the linear equation of each piece.",
        "Both follow the two variations of a motion, so Newton's method finds a closed orbit and",
        "its multipliers. Of the printed error the second way takes the corners in exact",
        "fractions, the third two million random roundings.", "",
        "| claim | by the program | by scipy | by exact pieces |", "|---|---|---|---|",
        *rows, "",
        f"{len(found) - len(bad)} of {len(found)} agree to one unit of the last digit.",
    ]) + "\n", "utf-8")  # fmt: skip
    print("\n".join([*rows, *(f"differs: {words}" for words in bad)]))
    return int(bool(bad))


if __name__ == "__main__":
    sys.exit(main())
