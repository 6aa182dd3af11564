"""Every steady state of the heat balance: from cold, from hot, and at the end of a warm-up.

``make trial NAME=heat`` asks the ready-made rig at 30 speeds x 30 torques and 60 random pairs at 20
points each (seed fixed before the first run), for two friction laws, and writes
trials/records/heat.md. ``python trials/heat.py 10`` prints one of 10 x 10 points.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear import Gear, GearPair, MeshModel
from thermogear.base.errors import ValidityWarning
from thermogear.base.materials import lubricant
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.case.case import GearCase, gear_case, load_example
from thermogear.mesh.balance import NODES, Gearbox, HeatBalance, heat_balance
from thermogear.mesh.operating import Operating
from thermogear.mesh.warm_up import Duty, warm_up

Floats = NDArray[np.float64]

SEED = 15_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "heat.md"
LAWS = {"lambda-blend": "body", "benedict-kelley": "oil"}
"""Friction laws, each with what its film forms of."""
SPEEDS, TORQUES = (500.0, 6000.0), (20.0, 500.0)
PAIRS, POINTS = 60, 20
SAME = 0.01
LONGEST = 3e6
"""Length [s] of a warm-up."""


@dataclass
class Found:
    """What one set of points gave."""

    points: int = 0
    settled: int = 0
    several: list[tuple[float, float, float, float]] = field(default_factory=list)
    apart: float = 0.0
    untold: int = 0
    warm_ups: int = 0
    warm_up_gap: float = 0.0
    seconds: float = 0.0

    def add(self, balance: HeatBalance) -> None:
        """Count one batch; what differs and is not told is wrong."""
        count = balance.settled.size
        gap = np.max([np.abs(balance.hot[n] - balance.steady[n]) for n in NODES], axis=0)
        single = balance.settled & ~balance.several
        self.points += count
        self.settled += int(balance.settled.sum())
        self.apart = max(self.apart, float(np.max(gap[single], initial=0.0)))
        self.untold += int(np.count_nonzero(~(gap[single] <= SAME)))
        at = balance.operating
        for place in np.flatnonzero(balance.settled & balance.several):
            self.several.append(
                (
                    float(at.speed[place]) / RPM,
                    float(at.torque[place]),
                    float(balance.steady["oil"][place]) - ZERO_CELSIUS,
                    float(balance.hot["oil"][place]) - ZERO_CELSIUS,
                )
            )


def on_the_rig(case: GearCase, law: str, side: int, *, warm: bool) -> Found:
    """The rig over ``side`` x ``side`` speeds and torques, with warm-ups to every point."""
    found, began = Found(), time.perf_counter()
    speed, torque = (
        axis.ravel()
        for axis in np.meshgrid(
            RPM * np.linspace(*SPEEDS, side), np.linspace(*TORQUES, side), indexing="ij"
        )
    )
    model = MeshModel.consistent().override(friction=law, inlet=LAWS[law])
    at = case.stated
    balance = heat_balance(
        case.pair, speed, torque, at.lubricant, at.half_backlash, model, gearbox=case.gearbox
    )
    found.add(balance)
    found.seconds = time.perf_counter() - began
    for place in np.flatnonzero(balance.settled) if warm else ():
        one = replace(
            at,
            speed=speed[place : place + 1],
            torque=torque[place : place + 1],
            temperatures=at.temperatures.cold(),
        )
        gap = end_of_warm_up(case.pair, one, model, case.gearbox, balance, int(place))
        found.warm_ups += 1
        found.warm_up_gap = max(found.warm_up_gap, gap)
        if gap > SAME:
            print(f"{speed[place] / RPM:.0f} rpm, {torque[place]:.0f} N m: {gap:.3f} K", flush=True)
    return found


def end_of_warm_up(
    pair: GearPair,
    at: Operating,
    model: MeshModel,
    box: Gearbox,
    balance: HeatBalance,
    place: int,
) -> float:
    """How far [K] a warm-up from the ambient ends from the state from cold."""
    duty = Duty(
        time=np.array([0.0, LONGEST]),
        speed=at.speed,
        torque=at.torque,
        ambient=np.array([box.surroundings.ambient]),
    )
    course = warm_up(
        pair, duty, at.lubricant, at.half_backlash, model, gearbox=box, moments=4
    ).temperatures
    return max(float(abs(course[n][-1] - balance.steady[n][place])) for n in NODES)


def random_pairs(law: str, count: int) -> Found:
    """Pairs, oils and loads drawn at random, from both ends."""
    random, found, began = np.random.default_rng(SEED), Found(), time.perf_counter()
    model = MeshModel.consistent().override(friction=law, inlet=LAWS[law])
    for _ in range(count):
        teeth = int(random.integers(18, 45)), int(random.integers(30, 100))
        module, width = float(random.uniform(1.5e-3, 8e-3)), float(random.uniform(6.0, 14.0))
        bore = float(random.uniform(0.2, 0.5))
        first, second = (
            Gear(z, module, face_width=width * module, bore_radius=bore * 0.5 * z * module)
            for z in sorted(teeth)
        )
        pair = GearPair(first, second)
        size = first.pitch_radius**2 * first.face_width
        rim = random.uniform(1.0, 25.0, POINTS)
        found.add(
            heat_balance(
                pair,
                rim / first.pitch_radius,
                size * random.uniform(2e5, 3e6, POINTS),
                lubricant(str(random.choice(["M68", "M100", "M220", "M320", "P68", "P220"]))),
                1e-4,
                model,
                gearbox=Gearbox(immersion=float(random.uniform(0.1, 0.6))),
            )
        )
    found.seconds = time.perf_counter() - began
    return found


def table(name: str, found: Found) -> str:
    """One row of the page."""
    far = max((hot - cold for _, _, cold, hot in found.several if np.isfinite(hot)), default=0.0)
    warm = f"{found.warm_up_gap:.1e} K of {found.warm_ups}" if found.warm_ups else "–"
    return (
        f"| {name} | {found.points} | {found.settled} | {found.apart:.1e} K | {found.untold} | "
        f"{len(found.several)} | {far:.1f} K | {warm} |"
    )


def page(rows: Sequence[tuple[str, Found]], side: int) -> str:
    """The page of the documentation."""
    several = [(name, *one) for name, found in rows for one in found.several]
    lines = [
        "# Trial of the heat balance",
        "",
        f"Made by `make trial NAME=heat` (seed {SEED}): the ready-made rig at {side} "
        f"speeds x {side}",
        f"torques, {SPEEDS[0]:.0f} to {SPEEDS[1]:.0f} rpm and {TORQUES[0]:.0f} to "
        f"{TORQUES[1]:.0f} N m, its oil as the ambient warms it, and random pairs.",
        "",
        "- Every point is iterated from cold (everything at the ambient) and from hot (700 K).",
        "- Both ends are the same state, or the balance says that there are several.",
        "- A warm-up from the ambient ends at the state from cold.",
        "",
        "| set | points | settled | greatest distance of states called one | "
        "different and not told | several states | furthest apart | end of a warm-up off |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
        *(table(name, found) for name, found in rows),
        "",
        "Points that do not settle run away beyond 700 K. Where there are several states, oil from",
        "cold and from hot:",
        "",
        "| set | rpm | N m | °C from cold | °C from hot |",
        "|---|---:|---:|---:|---:|",
        *(
            f"| {n} | {s:.0f} | {t:.1f} | {c:.1f} | {f'{h:.1f}' if h < np.inf else 'runs away'} |"
            for n, s, t, c, h in several
        ),
        "",
    ]
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    side = int(words[0]) if words else 30
    case = gear_case(load_example("rig"))
    rows: list[tuple[str, Found]] = []
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        for number, law in enumerate(LAWS):
            rows.append((f"rig, {law}", on_the_rig(case, law, side, warm=number == 0)))
            print(table(*rows[-1]), f"{rows[-1][1].seconds:.0f} s", flush=True)
            rows.append((f"random pairs, {law}", random_pairs(law, max(1, PAIRS * side // 30))))
            print(table(*rows[-1]), f"{rows[-1][1].seconds:.0f} s", flush=True)
    if words:
        print(page(rows, side))
    else:
        PAGE.write_text(page(rows, side), "utf-8")
        print(PAGE.relative_to(Path.cwd()) if PAGE.is_relative_to(Path.cwd()) else PAGE)
    return int(any(f.untold or f.warm_up_gap > SAME for _, f in rows))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
