"""Random diagrams with heat on and off: pairs by order against pairs found by following.

``make trial-matched`` draws 20 diagrams (seed fixed before the first run), ten of the dimensionless
equation and ten of gear pairs over the speed, each undeformed and hot, and writes
docs/trial_matched.md. A pair by order is the first fold with the first fold, the second with the
second, and so on, of one kind and period. Where both ways differ the row is listed. A followed pair
is confirmed at a third value: half way between both states the diagram is computed afresh, and the
way over its own located bifurcations must lead to the same partner. Exit code 1: one leads to
another. ``python checks/trial_matched.py 2`` prints a short one.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.branches import KINDS
from thermogear.analysis.diagram import DiagramPlan, diagram_plan
from thermogear.analysis.matched import MATCHED, UNKNOWN, matches
from thermogear.base.errors import ThermogearError
from thermogear.base.plan import gather
from thermogear.base.units import RPM
from thermogear.case.case import load_case, load_example
from thermogear.case.points import Points
from thermogear.dynamics.lanes import mixed
from thermogear.study.diagrams import case_diagram

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 48_2026
PAGE = Path(__file__).parents[1] / "docs" / "trial_matched.md"
GEARS = """\
title = "A drawn pair"
[gears]
module = "{module} mm"
face_width = "{width} mm"
[gears.pinion]
teeth = {z1}
[gears.wheel]
teeth = {z2}
[oil]
name = "ISO VG 100"
[operating]
speed = "3000 rpm"
torque = "{torque} N m"
[dynamics]
damping_ratio = {damping}
"""
PERIOD, MOST = 2, 8
"""Mesh periods of the branches, and bifurcations followed of each diagram."""
CONTRADICTED = "contradicted"
NEAR = 1e-6
"""Of the range: two values this near are one."""


@dataclass(frozen=True)
class Halfway:
    """The family half way between two others."""

    one: Any
    other: Any

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.one.names)

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(self.one.units)

    def inputs(self) -> dict[str, Any]:
        return {"one": self.one.inputs(), "other": self.other.inputs()}

    def __call__(self, points: Floats) -> Points:
        one, other = (family(points) for family in (self.one, self.other))
        return Points.plain(mixed(one.lanes(), other.lanes(), 0.5))


@dataclass
class Found:
    """What the trial counted, and the rows where both ways differ."""

    counts: Counter[str] = field(default_factory=Counter)
    rows: list[str] = field(default_factory=list)
    bad: list[str] = field(default_factory=list)


def draw_numbers(rng: Random) -> tuple[str, tuple[DiagramPlan, DiagramPlan]]:
    """A base set near that of table 4.2, over its frequency, without heat and with some."""
    case = load_example("table-4.2")
    numbers = {
        "damping_ratio": float(rng.uniform(0.08, 0.2)),
        "stiffness_amplitude": float(rng.uniform(0.1, 0.5)),
        "mean_force": float(rng.uniform(0.01, 0.2)),
        "force_amplitude": -float(rng.uniform(0.2, 1.2)),
    }
    heat = {
        "thermal_stiffness": float(rng.uniform(-0.05, 0.03)),
        "half_backlash": float(rng.uniform(0.75, 0.97)),
    }
    low = float(rng.uniform(0.5, 1.2))
    values = np.linspace(low, 1.35 * low, 13)
    plans = [
        case_diagram(case, "frequency", values, changes={**numbers, **change}, branch_period=PERIOD)
        for change in ({}, heat)
    ]
    told = ", ".join(f"{k} {v:.4g}" for k, v in (numbers | heat).items())
    return f"{told}; frequency {values[0]:.4g} to {values[-1]:.4g}", (plans[0], plans[1])


def draw_gears(rng: Random) -> tuple[str, tuple[DiagramPlan, DiagramPlan]]:
    """A pair over a stretch of speed, undeformed and hot."""
    drawn = {
        "module": float(rng.choice([2.0, 3.0, 4.0])),
        "width": float(np.round(rng.uniform(15.0, 40.0))),
        "z1": int(rng.integers(18, 32)),
        "z2": int(rng.integers(33, 70)),
        "torque": float(np.round(rng.uniform(20.0, 90.0))),
        "damping": float(np.round(rng.uniform(0.01, 0.05), 3)),
    }
    case = load_case(GEARS.format(**drawn))
    low = float(rng.uniform(4000.0, 9000.0))
    values = np.linspace(low, 1.5 * low, 13) * RPM
    plans = [
        case_diagram(case, "pinion_speed", values, state=state, branch_period=PERIOD)
        for state in ("undeformed", "hot")
    ]
    told = ", ".join(f"{k} {v:g}" for k, v in drawn.items())
    return f"{told}; {low:.0f} to {1.5 * low:.0f} rpm", (plans[0], plans[1])


def by_order(one: Any, other: Any) -> dict[tuple[int, int, float], float]:
    """(kind, period, value in one) -> the value of the same place in the other's list."""
    lists: list[dict[tuple[int, int], list[float]]] = []
    for data in (one, other):
        found: dict[tuple[int, int], list[float]] = {}
        names = ("kind", "period", "value")
        columns = [data[f"bifurcation_{name}"].values.tolist() for name in names]
        for kind, period, value in zip(*columns, strict=True):
            found.setdefault((kind, period), []).append(value)
        lists.append(found)
    return {
        (*key, first): second
        for key, firsts in lists[0].items()
        for first, second in zip(sorted(firsts), sorted(lists[1].get(key, [])), strict=False)
    }


def judge(name: str, plans: tuple[DiagramPlan, DiagramPlan], found: Found) -> None:
    """Both ways of one diagram, and the third value between."""
    one, other = (gather(plan, threads=1) for plan in plans)
    first, last = (plan.family for plan in plans)
    parameter = plans[0].parameter
    axis = one[parameter].values
    near = NEAR * float(np.ptp(axis))
    shown = RPM if parameter == "pinion_speed" else 1.0
    middle = Halfway(first, last)
    half = gather(diagram_plan(middle, parameter, axis, branch_period=PERIOD), threads=1)
    rows = matches(one, other, (first, last), most=MOST)
    there = matches(one, half, (first, middle), most=MOST)
    back = matches(half, other, (middle, last), most=MOST)
    order = by_order(one, other)
    for row in rows:
        found.counts[
            row["partner"] + ", not drawn" * (row["partner"] == MATCHED and not row["drawn"])
        ] += 1
        if row["one"] is None or row["partner"] == UNKNOWN:
            continue
        key = KINDS.index(row["kind"]), row["period"]
        paired = [
            v for (*k, at), v in order.items() if tuple(k) == key and close(at, row["one"], near)
        ]
        by_rank = paired[0] if paired else None
        if not close(by_rank, row["other"], near):
            found.counts["differ from the pairs by order"] += 1
            cells = ["none" if v is None else f"{v / shown:.6g}"
                     for v in (row["one"], by_rank, row["other"])]  # fmt: skip
            kind = f"{row['kind']}, period {row['period']}"
            found.rows.append(f"| {name} | {kind} | {' | '.join(cells)} | {row['partner']} |")
        if row["partner"] == MATCHED and row["drawn"]:
            value = led(led(row["one"], row, there, near), row, back, near)
            good = value is not None and close(value, row["other"], near)
            what = "confirmed" if good else "not confirmed" if value is None else CONTRADICTED
            found.counts[f"matched pairs {what} by a third value"] += 1
            if what == CONTRADICTED:
                found.bad.append(f"{name}: {row!r} against {value!r}")


def close(one: float | None, other: float | None, near: float) -> bool:
    """Whether two values are one, or both none."""
    if one is None or other is None:
        return one is other
    return abs(one - other) <= near


def led(
    value: float | None, row: dict[str, Any], rows: Sequence[dict[str, Any]], near: float
) -> float | None:
    """Where the bifurcation of a row's kind at ``value`` arrives by other rows; None: nowhere."""
    for other in rows:
        alike = (other["kind"], other["period"]) == (row["kind"], row["period"])
        if value is not None and alike and close(other["one"], value, near):
            return None if other["partner"] != MATCHED else float(other["other"])
    return None


def page(found: Found, count: int, seconds: float) -> str:
    """docs/trial_matched.md."""
    return "\n".join([
        "---",
        "orphan: true",
        "---",
        "# Trial of matched bifurcations",
        "",
        f"Made by `make trial-matched` (seed {SEED}, {seconds:.0f} s). {count} drawn diagrams,",
        "half of the dimensionless equation over its frequency and half of gear pairs over the",
        "speed, each without heat and with it. A pair by order is the first fold with the first",
        "fold, the second with the second, and so on, within one kind and period. A followed pair",
        "is confirmed where the way from the first diagram to one computed half way, and from",
        "there to the second, over bifurcations that the third one has located by itself, leads to",
        f"the same value. At most {MOST} bifurcations of a diagram are followed, grazings last.",
        "",
        "| bifurcations | |",
        "|---|---:|",
        *(f"| {what} | {n} |" for what, n in sorted(found.counts.items())),
        "",
        "Where both ways differ (values in rpm for gear pairs):",
        "",
        "| diagram | bifurcation | without heat | with heat, by order | followed | became |",
        "|---|---|---:|---:|---:|---|",
        *found.rows,
        "",
        *(f"- {one}" for one in found.bad),
    ]).rstrip("\n") + "\n"  # fmt: skip


def main(words: Sequence[str]) -> int:
    """The trial; exit code 1 where a third value contradicts a followed pair."""
    began = time.perf_counter()
    count = int(words[0]) if words else 20
    rng, found = np.random.default_rng(SEED), Found()
    warnings.simplefilter("ignore")
    done = 0
    while done < count:
        kind = "equation" if done % 2 == 0 else "gears"
        told, plans = draw_numbers(rng) if kind == "equation" else draw_gears(rng)
        try:
            judge(f"{done + 1}, {kind}", plans, found)
        except ThermogearError as error:
            found.counts["diagrams drawn again"] += 1
            print(f"{told}: {error}", file=sys.stderr)
            continue
        done += 1
        print(f"{done} of {count}: {told}", file=sys.stderr, flush=True)
    text = page(found, count, time.perf_counter() - began)
    if words:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
        print(PAGE)
    return int(bool(found.bad))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
