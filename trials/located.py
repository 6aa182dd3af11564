"""Random drive trains: located bifurcations against a fine settled sweep, and what a proof costs.

``make trial NAME=located`` moves six random drive trains (seed fixed before the first run) over
their
mesh frequency, in steps from one settled motion to the next, follows their periodic motion with
:func:`continuation`, and asks of every located fold, period doubling and torus of a stable orbit
whether the settled label changes between the two neighbouring values of the sweep. It then measures
processor time of a settled motion, a closed orbit with multipliers and a located event for trains
of 6, 12, 30 and 60 coordinates. It writes trials/records/located.md;
``python trials/located.py 2`` prints a short one.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.any_motion import settle
from thermogear.analysis.bifurcations import FLIP, FOLD, TORUS, Bifurcation
from thermogear.analysis.continuation import Branch, continuation
from thermogear.analysis.orbits import Orbit, periodic_orbit, shoot
from thermogear.analysis.walk import Search
from thermogear.base.errors import ThermogearError
from thermogear.base.excitation import Periodic
from thermogear.dynamics.geared import GearedModel, LocalBearing
from thermogear.dynamics.return_map import return_map

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 22_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "located.md"
VALUES = 81
"""Values of the sweep."""
SIZES = (6, 12, 30, 60)
ENDS = (FOLD, FLIP, TORUS)
SEARCH = Search(first=128, cap=4096, max_period=8, starts=1)


def drawn(random: Random, size: int) -> GearedModel:
    """A train of ``size`` coordinates: modes of random frequency that teeth and bearings feel.

    Its softest mode with closed teeth and the mesh frequency are near, so that contact is lost.
    """
    drive = random.normal(size=size)
    drive /= np.linalg.norm(drive)
    back = -0.9 * drive + 0.3 * random.normal(size=size) / np.sqrt(size)
    mean, backlash = 4e8, 4e-5
    mass = 1.0 + random.uniform(0.0, 1.0, size)
    # shafts hold all but what the teeth close, which the torque pulls at
    beside = np.eye(size) - np.outer(drive, drive)
    stiffness = beside @ np.diag(4e8 * random.uniform(0.02, 3.0, size)) @ beside
    pull = float(random.uniform(0.5, 2.0)) * 0.05 * mean * backlash
    directions = [beside @ random.normal(size=(size, 2)) / np.sqrt(size) for _ in range(2)]
    bearings = tuple(
        LocalBearing(
            directions=one, coefficient=3e8, exponent=1.0, clearance=2e-6, base=1e8 * np.eye(2)
        )
        for one in directions
    )
    whole = stiffness + mean * np.outer(drive, drive)
    for one in directions:
        whole = whole + 1e8 * one @ one.T
    omega = np.sqrt(np.linalg.eigvalsh(whole / np.sqrt(np.outer(mass, mass))))
    damping = 0.03 * np.diag(mass) * float(omega.mean())
    mesh_damping = 0.02 * float(np.sqrt(mean))
    felt = float(np.sqrt(drive @ whole @ drive / (drive @ (mass * drive))))
    return GearedModel(
        mass=np.diag(mass),
        damping=damping + mesh_damping * np.outer(drive, drive),
        stiffness=stiffness,
        force=pull * drive,
        drive=drive,
        back=back,
        mesh_stiffness=Periodic(mean, (complex(0.3 * mean),)),
        error=Periodic(0.0, (complex(0.3 * backlash * random.uniform(0.3, 1.0)),)),
        half_backlash=backlash,
        mesh_damping=mesh_damping,
        mesh_frequency=felt / (2.0 * np.pi) * float(random.uniform(0.75, 0.9)),
        bearings=bearings,
    )


@dataclass(frozen=True)
class Compared:
    """One train: its first event, the sweep's labels around, by how many steps they lie apart."""

    number: int
    event: str
    labels: str
    steps: int


def compared(number: int, model: GearedModel) -> Compared | None:
    """The sweep of one train beside its branch, both from one settled motion upwards."""
    low = model.mesh_frequency
    values = np.linspace(low, 1.35 * low, VALUES)

    def family(value: float) -> GearedModel:
        return replace(model, mesh_frequency=value)

    section = return_map(model)
    found = settle(section, section.plane.rest, SEARCH)  # type: ignore[attr-defined]
    if found.orbit is None:
        return None
    orbit = shoot(section, found.orbit.state, found.period, model=model)
    if orbit is None:
        return None
    branch = continuation(
        orbit, "mesh_frequency", float(values[-1]), family=family, start=low, most_points=400,
        stop_at=ENDS,
    )  # fmt: skip
    first = next((b for b in branch.bifurcations if b.kind in ENDS), None)
    if first is None:
        return None
    label, labels, state = found.name, [found.name], found.state
    place = VALUES
    for i in range(1, VALUES):
        found = settle(return_map(family(float(values[i]))), state, SEARCH)
        label, state = found.name, found.state
        labels.append(label)
        if found.orbit is None or not _on(branch, float(values[i]), found.orbit):
            place = i
            break
    where = int(np.searchsorted(values, first.value))
    told = f"{first.kind} at {first.value / low:.7f}"
    return Compared(number, told, " -> ".join(dict.fromkeys(labels)), place - where)


def _on(branch: Branch, value: float, orbit: Orbit) -> bool:
    """Whether a settled orbit is one of the branch's stable ones."""
    if orbit.period != branch.period:
        return False
    section = orbit.section
    for i in range(branch.values.size - 1):
        a, b = branch.values[i], branch.values[i + 1]
        if branch.stable[i] and (a - value) * (b - value) <= 0.0 and a != b:
            share = (value - a) / (b - a)
            guess = branch.states[i] + share * (branch.states[i + 1] - branch.states[i])
            found = shoot(section, guess, branch.period)
            if found is not None and section.distance(orbit.points, found.state).min() < 1e-6:
                return True
    return False


@dataclass(frozen=True)
class Cost:
    """Processor seconds: a settled motion, an orbit with multipliers, a located event; periods."""

    size: int
    settled: float
    periods: int
    proof: float
    event: float
    kind: str


def costs(size: int, random: Random) -> Cost:
    """One train of each size; times are of processor, the engine compiled before."""
    while True:
        model = drawn(random, size)
        section = return_map(model)
        rest = section.plane.rest  # type: ignore[attr-defined]
        begun = time.process_time()
        found = settle(section, rest, replace(SEARCH, exponent=False))
        settled = time.process_time() - begun
        if found.orbit is None:
            continue
        start = section.carry(rest, found.discarded)[-1]
        begun = time.process_time()
        orbit = periodic_orbit(model, found.period, start)
        _ = orbit.multipliers
        proof = time.process_time() - begun
        event = one_event(model, orbit)
        if event is None:
            continue
        return Cost(size, settled, found.discarded, proof, event[0], event[1].kind)


def one_event(model: GearedModel, orbit: Orbit) -> tuple[float, Bifurcation] | None:
    """Processor seconds from an orbit to the first located event upwards in speed."""
    low = model.mesh_frequency
    begun = time.process_time()
    try:
        branch = continuation(
            orbit, "mesh_frequency", 1.35 * low, start=low, stop_at=ENDS, most_points=200,
            family=lambda value: replace(model, mesh_frequency=value),
        )  # fmt: skip
    except ThermogearError:
        return None
    found = [b for b in branch.bifurcations if b.kind in ENDS]
    return (time.process_time() - begun, found[0]) if found else None


HEAD = f"""# Random drive trains: located bifurcations against a fine sweep


Made by `make trial NAME=located`, seed {SEED}: {VALUES} settled values of the mesh frequency a
train, each from the last state of the one before. The branch is followed to its first fold, period
doubling or torus; the sweep until its label, or its orbit, is another. *Steps apart*: by how many
steps later (above 0) or earlier the sweep leaves the branch than in the step with the event.

| train | first event, over the first frequency | settled labels | steps apart |
|---|---|---|---|
"""
COST = """
## What a proof costs

Processor seconds of one core on a shared machine.

| coordinates | settled motion (periods) | orbit and multipliers | one located event | it is |
|---|---|---|---|---|
"""


def main() -> None:
    """Print, and without a number of trains write, both tables."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 6
    random = np.random.default_rng(SEED)
    text, worst, seen, number = HEAD, 0, 0, 0
    while seen < count and number < 10 * count:
        number += 1
        found = compared(number, drawn(random, 6))
        if found is None:
            continue
        seen += 1
        worst = max(worst, abs(found.steps))
        row = f"| {number} | {found.event} | {found.labels} | {found.steps} |"
        print(row, flush=True)
        text += row + "\n"
    text += (
        f"\nWorst: {worst} steps of {VALUES - 1}; {number} trains drawn, the others do not begin "
    )
    text += "with a periodic motion or have no such event.\n" + COST
    for size in SIZES if count > 2 else SIZES[:1]:
        one = costs(size, random)
        row = (
            f"| {one.size} | {one.settled:.3f} ({one.periods}) | {one.proof:.3f} | {one.event:.2f} "
            f"| {one.kind} |"
        )
        print(row, flush=True)
        text += row + "\n"
    if len(sys.argv) == 1:
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
