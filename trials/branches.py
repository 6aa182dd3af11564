"""Random branches against small steps, random run-ups against finer ones: no event missed.

``make trial NAME=branches`` follows 60 branches (seed fixed before the first run) with
:func:`continuation` and again with a plain walker of its own in steps ten times as short, and runs
40 random gear pairs up and down in steps of 100 and of 12.5 rpm; it writes
trials/records/branches.md. ``python trials/branches.py 5 3`` prints a short one: 5 branches, 3
pairs.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import BIRTH, FLIP, FOLD, GRAZING, PITCHFORK, Bifurcation
from thermogear.analysis.continuation import GAP, Branch, continuation, family_of
from thermogear.analysis.labels import label
from thermogear.analysis.orbits import Orbit
from thermogear.analysis.section import lanes_of
from thermogear.base.errors import InputError, ThermogearError
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import Visit, return_map

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 14_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "branches.md"
SHORT_STEP = 0.005
"""Arclength of the plain walker; the continuation's longest is 0.05."""
SHORTEST = 1e-6
MOST_POINTS = 400
SILENT = 1e-7
"""Orbits that float in the gap or stay in contact at a linear instability have a multiplier +1 of
rounding: what changes sign there is no event."""
SAME = 1e-6
"""Parameter (of its range) within which an event lies in the step where it was seen."""
RANGES = {
    "frequency": 0.25,
    "damping_ratio": 0.6,
    "stiffness_amplitude": 0.6,
    "mean_force": 0.6,
    "force_amplitude": 0.4,
}
"""How far a branch is followed, as a share of the value it starts from."""


@dataclass(frozen=True)
class Drawn:
    """One branch: an orbit, the parameter, where to."""

    orbit: Orbit
    parameter: str
    to: float
    symmetric: bool


def draw_branch(rng: Random, symmetric: bool) -> Drawn | None:
    """A settled motion of up to 4 periods and a way to go; None where it settles on none."""
    model = TorsionalModel(
        damping_ratio=float(rng.uniform(0.02, 0.15)),
        frequency=float(rng.uniform(0.35, 2.2)),
        stiffness_amplitude=0.0 if symmetric else float(rng.uniform(0.05, 0.6)),
        mean_force=0.0 if symmetric else float(rng.uniform(0.05, 0.5)),
        force_amplitude=float(rng.uniform(0.3, 1.5) if symmetric else rng.uniform(0.05, 1.0)),
    )
    names = ["frequency", "damping_ratio", "force_amplitude"] if symmetric else list(RANGES)
    parameter = str(rng.choice(names))
    sign = float(rng.choice([-1.0, 1.0]))
    start = tuple(rng.uniform(-1.5, 2.0, 2).tolist())
    found = label(model, initial_state=start, cap=4000, max_period=4, batches=4, batch_periods=100)
    if found.orbit is None or not found.name.startswith("period"):
        return None
    value = float(getattr(model, parameter))
    return Drawn(found.orbit, parameter, value * (1.0 + sign * RANGES[parameter]), symmetric)


@dataclass(frozen=True)
class Seen:
    """What changed between two points of the plain walk."""

    kind: str
    low: float
    high: float


class Plain:
    """The same branch in short steps: secant predictor, Newton with differences, nothing else."""

    def __init__(self, drawn: Drawn) -> None:
        self.family, self.start = family_of(drawn.orbit.model, drawn.parameter)
        self.n = drawn.orbit.period
        self.span = abs(drawn.to - self.start)
        self.to = drawn.to
        self.unit = np.append(lanes_of(self.family(self.start)).unit[0], self.span)
        self.state = drawn.orbit.state

    def gap(self, u: Floats) -> tuple[Floats, Visit]:
        z = u * self.unit
        visit = return_map(lanes_of(self.family(float(z[2])))).visit(z[:2], self.n)
        return (visit.points[-1] - visit.points[0]) / self.unit[:2], visit

    def closed(self, guess: Floats, normal: Floats) -> tuple[Floats, Visit] | None:
        """Newton in the plane through ``guess``; the best of 12 iterates when it is good."""
        u = guess.copy()
        best: tuple[float, Floats, Visit] | None = None
        two = self.unit[:2]
        matrix = np.zeros((3, 3))
        matrix[2] = normal
        for count in range(12):
            gap, visit = self.gap(u)
            size = float(np.max(np.abs(gap)))
            if not np.isfinite(size):
                return None
            if best is None or size < best[0]:
                best = (size, u, visit)
            elif best[0] < 1e-10:
                break
            matrix[:2, :2] = visit.jacobian / two[:, None] * two - np.eye(2)
            if count == 0:
                ends = []
                for sign in (1.0, -1.0):
                    moved = u.copy()
                    moved[2] += sign * 1e-7
                    ends.append(self.gap(moved)[0])
                matrix[:2, 2] = (ends[0] - ends[1]) / 2e-7
            try:
                u = u + np.linalg.solve(matrix, [*-gap, -normal @ (u - guess)])
            except np.linalg.LinAlgError:
                return None
        assert best is not None
        return (best[1], best[2]) if best[0] < 1e-9 else None

    def tests(self, u: Floats, visit: Visit) -> tuple[float, float, tuple[int, int]]:
        lanes = lanes_of(self.family(float(u[2] * self.span)))
        det = float(np.exp(-lanes.damping[0] * lanes.period[0] * self.n))
        trace = float(np.trace(visit.jacobian))
        return 1 - trace + det, 1 + trace + det, (visit.contact_losses, visit.back_impacts)

    def walk(self, guess: Floats, toward: Floats, length: float) -> tuple[list[Seen], float]:
        """Events on the way over an arclength, or to the end of the range; how far it came."""
        here = self.closed(guess, toward)
        assert here is not None
        after = self.closed(guess + 1e-5 * toward, toward)
        assert after is not None
        tangent = after[0] - here[0]
        tangent /= np.linalg.norm(tangent)
        seen: list[Seen] = []
        u, visit = here
        low, high = sorted((self.start / self.span, self.to / self.span))
        gone, step = 0.0, SHORT_STEP
        heading = np.sign(tangent[2])
        old = self.tests(u, visit)
        while gone < length:
            try:
                there = self.closed(u + step * tangent, tangent)
            except InputError:  # beyond what the parameter may be
                there = None
            if there is None or (there[0] - u) @ tangent < 0.9 * np.linalg.norm(there[0] - u):
                step *= 0.5
                if step < SHORTEST:
                    break
                continue
            chord = there[0] - u
            if not low - SAME <= there[0][2] <= high + SAME:
                return seen, length
            gone += float(np.linalg.norm(chord))
            new = self.tests(*there)
            tangent = chord / np.linalg.norm(chord)
            p, q = sorted((float(u[2] * self.span), float(there[0][2] * self.span)))
            # a turn of the parameter inside a step reaches beyond both ends
            slack = self.span * SAME
            turned = heading * tangent[2] < 0.0
            heading = np.sign(tangent[2])
            if old[0] * new[0] < 0.0 and min(abs(old[0]), abs(new[0])) > SILENT:
                beyond = 0.5 * step * self.span
                seen.append(Seen(FOLD, p - beyond, q + beyond))
            elif turned:
                seen.append(Seen("turn", p - slack, q + slack))
            if old[1] * new[1] < 0.0:
                seen.append(Seen(FLIP, p - slack, q + slack))
            if old[2] != new[2]:
                seen.append(Seen(GRAZING, p - slack, q + slack))
            u, old = there[0], new
            step = min(SHORT_STEP, 2.0 * step)
        return seen, gone


@dataclass
class Found:
    """What the trial counted, and notes on what must not happen."""

    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)

    def bad(self, what: str, note: str) -> None:
        self.counts[what] += 1
        self.notes.append(f"{what}: {note}")
        tell(self.notes[-1])


NEVER = (
    "branches raised",
    "branches with a gap",
    "events missed",
    "events invented",
    "folds where the parameter runs on",
    "events that are none",
    "jumps only in coarse steps",
    "jumps only in fine steps",
)
"""What must not happen once."""


def edge_distance(orbit: Orbit) -> float:
    """How near an extreme of x comes to an edge of the backlash, in half backlashes."""
    per = 512
    _, x, v = orbit.samples(per)
    b = float(orbit.lanes.half_backlash[0])
    step = float(orbit.lanes.period[0]) / per
    x1, v1 = np.roll(x, -1), np.roll(v, -1)
    at = np.flatnonzero(v * v1 <= 0.0)
    turn = np.clip(v[at] / np.where(v[at] == v1[at], 1.0, v[at] - v1[at]), 0.0, 1.0)
    d = x1[at] - x[at]
    c2, c3 = 3 * d - step * (2 * v[at] + v1[at]), step * (v[at] + v1[at]) - 2 * d
    extreme = x[at] + turn * (step * v[at] + turn * (c2 + turn * c3))
    return float(np.min(np.minimum(abs(extreme - b), abs(extreme + b)))) / b


def holds(event: Bifurcation) -> bool:
    """Whether the orbit there is what the event says, by another way than it was located."""
    mu = event.orbit.multipliers
    if event.kind in (FOLD, PITCHFORK):
        return bool(np.min(np.abs(mu - 1.0)) < 1e-5)
    if event.kind == FLIP:
        return bool(np.min(np.abs(mu + 1.0)) < 1e-5)
    return edge_distance(event.orbit) < 1e-5 if event.kind == GRAZING else True


def compare(drawn: Drawn, branch: Branch, found: Found, name: str) -> None:
    """The located events against those that short steps see."""
    plain = Plain(drawn)
    scaled = np.column_stack([branch.states, branch.values]) / plain.unit
    length = float(np.linalg.norm(np.diff(scaled, axis=0), axis=1).sum())
    seen, gone = plain.walk(
        scaled[0], np.array([0.0, 0.0, np.sign(drawn.to - plain.start)]), length
    )
    if gone < length:
        # its differences straddle a grazing that turns sharply: the rest from the other end
        found.counts["plain walks that stopped and went on from the other end"] += 1
        home = (scaled[-2] - scaled[-1]) / np.linalg.norm(scaled[-2] - scaled[-1])
        seen += plain.walk(scaled[-1], home, length - gone - SHORT_STEP)[0]
    events = [b for b in branch.bifurcations if b.kind != BIRTH]
    left = list(events)
    for one in seen:
        kinds = (FOLD, PITCHFORK) if one.kind == FOLD else (one.kind,)
        match = [b for b in left if b.kind in kinds and one.low <= b.value <= one.high]
        if match:
            left.remove(match[0])
        elif one.kind != "turn":
            found.bad("events missed", f"{name}: {one}")
    found.counts["events seen by short steps"] += sum(one.kind != "turn" for one in seen)
    near = 2.0 * SHORT_STEP * plain.span
    for one in left:
        twins = [b for b in left if b is not one and b.kind == one.kind]
        if any(abs(b.value - one.value) < near for b in twins) and holds(one):
            found.counts["events in pairs nearer than the short step"] += 1
        else:
            found.bad("events invented", f"{name}: {one.kind} at {one.value!r}")
    for one in events:
        if not holds(one):
            found.bad("events that are none", f"{name}: {one.kind} at {one.value!r}")
    turns = int(np.count_nonzero(np.diff(np.sign(np.diff(branch.values))) != 0))
    folds = len(branch.of_kind(FOLD))
    if folds > turns:
        found.bad("folds where the parameter runs on", f"{name}: {folds} folds, {turns} turns")


def branches(count: int, found: Found) -> None:
    """``count`` branches, every fifth symmetric, a third of them at least with grazings."""
    rng = np.random.default_rng(SEED)
    done = 0
    while done < count:
        symmetric = done % 5 == 4
        drawn = draw_branch(rng, symmetric)
        if drawn is None:
            continue
        name = f"branch {done}"
        try:
            branch = continuation(drawn.orbit, drawn.parameter, drawn.to, most_points=MOST_POINTS)
        except InputError:
            raise
        except ThermogearError as error:
            found.bad("branches raised", f"{name}: {error}")
            done += 1
            continue
        grazing = bool(branch.of_kind(GRAZING))
        # the last ones must graze if too few did so far
        missing = -(-count // 3) - found.counts["branches with grazings"]
        if count - done <= missing and not grazing:
            found.counts["branches drawn again for their grazings"] += 1
            continue
        found.counts["branches"] += 1
        found.counts["branches with grazings"] += grazing
        found.counts["symmetric branches"] += symmetric
        found.counts["orbits on them"] += branch.values.size
        for event in branch.bifurcations:
            found.counts[f"{event.kind}s located"] += 1
            if event.kind in (FLIP, PITCHFORK):
                found.counts[f"{event.kind}s {event.note.split(':')[0] or 'undetermined'}"] += 1
        if branch.ended.startswith(GAP):
            found.bad("branches with a gap", f"{name}: {branch.ended}")
        compare(drawn, branch, found, name)
        done += 1
        tell(f"branch {done} of {count}")


def tell(text: str) -> None:
    if sys.stderr.isatty():
        print(f"\r{text:<30}", end="", file=sys.stderr, flush=True)
    else:
        print(text, file=sys.stderr, flush=True)


# --- run-ups ------------------------------------------------------------------------------------

RPM = np.pi / 30.0
COARSE, FINE = 100.0, 12.5
WIDTH = 600.0
"""Speeds of a run-up, from its first to its last [rpm]."""
ALIKE = 0.05
"""Jumps of two lists nearer than this [rpm] are one."""


def draw_pair(rng: Random) -> tuple[dict[str, str], float]:
    """A variant of the rig, and the speed [rpm] where its run-up begins: about a resonance."""
    fields = {
        "operating.torque": f"{rng.uniform(20.0, 200.0):.6g} N m",
        "dynamics.damping_ratio": f"{rng.uniform(0.02, 0.08):.6g}",
        "gears.pinion.face_width": f"{rng.uniform(15.0, 40.0):.6g} mm",
        "gears.wheel.face_width": f"{rng.uniform(15.0, 40.0):.6g} mm",
        "backlash.value": f"{rng.uniform(0.1, 0.4):.6g} mm",
        "transmission_error.harmonics": (
            f'[{{ order = 1, amplitude = "{rng.uniform(2.0, 12.0):.6g} um", phase = "0 deg" }}]'
        ),
    }
    low, high = ((1900.0, 2300.0), (4000.0, 4600.0))[int(rng.integers(2))]
    return fields, float(rng.uniform(low, high))


def run_ups(count: int, found: Found) -> None:
    """``count`` pairs up and down, undeformed, in coarse and in fine steps."""
    from thermogear.case.case import load_case
    from thermogear.study.run_up import run_up

    rng = np.random.default_rng(SEED + 1)
    for number in range(count):
        fields, first = draw_pair(rng)
        case = load_case("rig", fields)
        lists = []
        for step in (COARSE, FINE):
            speeds = (first + np.arange(0.0, WIDTH + 0.5 * step, step)) * RPM
            data = run_up(case, speeds, temperatures=(None,), branch_period=0).data
            folds = data["jump_fold"].values / RPM
            kinds = data["jump_kind"].values
            lists.append(
                [
                    (int(d), int(k), float(f))
                    for d, k, f in zip(data["jump_direction"].values, kinds, folds, strict=True)
                ]
            )
            size = "coarse" if step == COARSE else "fine"
            found.counts[f"chaotic or undecided motions, {size}"] += int(
                (data["label"].values != 1).sum()
            )
        coarse, fine = lists
        found.counts["run-ups"] += 1
        found.counts["run-ups with jumps"] += bool(fine)
        found.counts["jumps in fine steps"] += len(fine)
        for one in list(coarse):
            same = [o for o in fine if o[:2] == one[:2] and abs(o[2] - one[2]) < ALIKE]
            if same:
                coarse.remove(one)
                fine.remove(same[0])
        for what, rest in (("coarse", coarse), ("fine", fine)):
            for one in rest:
                found.bad(f"jumps only in {what} steps", f"pair {number}, {first:.6g} rpm: {one}")
        tell(f"run-up {number + 1} of {count}")


def page(found: Found) -> str:
    """The table of trials/records/branches.md."""
    beside: list[tuple[str, int]] = [
        (what, n) for what, n in sorted(found.counts.items()) if what not in NEVER
    ]
    lines = [
        "# Trial of branches and run-ups",
        "",
        f"Made by `make trial NAME=branches` (seed {SEED}). {found.counts['branches']} "
        f"random branches,",
        "every fifth of the symmetric equation (no mean force, constant stiffness), are followed",
        "over up to 60 % of a parameter by the continuation, and again by a plain walker (secant",
        f"predictor, derivatives by differences of the map, steps of {SHORT_STEP} at most against",
        "0.05), which sees a fold, a doubling or a grazing as a change of sign or count between",
        "two of its points. Every located event is also confirmed on its own orbit: by the",
        "multiplier, or by an extreme of x at an edge of the backlash.",
        "",
        f"{found.counts['run-ups']} variants of the rig (torque, damping, widths, backlash, error)",
        f"run up and down over {WIDTH:g} rpm about a resonance in steps of {COARSE:g} and of",
        f"{FINE:g} rpm; two jumps are one where kind, direction and fold (to {ALIKE} rpm) agree.",
        "",
        "| what must not happen | times |",
        "|---|---:|",
        *(f"| {what} | {found.counts[what]} |" for what in NEVER),
        "",
        "| beside it | |",
        "|---|---:|",
        *(f"| {what} | {n} |" for what, n in beside),
        "",
        *(f"- {note}" for note in found.notes),
        *([""] if found.notes else []),
    ]
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    began = time.perf_counter()
    count, pairs = (int(words[0]), int(words[1])) if len(words) > 1 else (60, 40)
    found = Found()
    branches(count, found)
    run_ups(pairs, found)
    text = page(found)
    if words:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
        print(PAGE)
    print(f"{time.perf_counter() - began:.0f} s", file=sys.stderr)
    return int(any(found.counts[what] for what in NEVER))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
