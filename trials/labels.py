"""Random motions that lose contact: every label of the settled motion put to another test.

``make trial NAME=labels`` draws until 2 000 motions lose contact (seed fixed before the first run),
labels them, closes every labelled orbit anew by multiple shooting on an adaptive integrator, sends
other starts beside each to see whether they end there too, follows every chaotic motion to 200 000
periods, and writes trials/records/labels.md. ``python trials/labels.py 50`` prints a short one.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear import TorsionalModel, simulate
from thermogear.analysis.labels import labels
from thermogear.analysis.maps import MAP_RULE
from thermogear.analysis.proof import Label
from thermogear.analysis.settle import CHAOTIC, PERIODIC, settle
from thermogear.dynamics.adaptive import Gap, follow
from thermogear.dynamics.exact_map import Ensemble

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]

SEED = 14_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "labels.md"
RANGES = {
    "damping_ratio": (0.01, 0.15),
    "frequency": (0.3, 2.2),
    "stiffness_amplitude": (0.0, 0.9),
    "mean_force": (0.02, 0.4),
    "force_amplitude": (-1.2, 1.2),
    "half_backlash": (0.4, 1.6),
    "thermal_stiffness": (-0.03, 0.03),
}
STARTS = (-2.0, 2.0)
FAR = 200_000
"""Periods every chaotic motion is followed."""
BESIDE = 8
"""Starts beside each labelled one, drawn anew, within :data:`APART` of it."""
APART = 1e-13
LONGEST = 512
"""Longest return that ends a chaotic motion; beyond it the last exponent tells."""
BATCH = 25


@dataclass(frozen=True)
class Drawn:
    """Random motions, one a row: the parameters in the order of RANGES, and the starts."""

    columns: Floats
    start: Floats

    def part(self, rows: Whole) -> Drawn:
        return Drawn(self.columns[rows], self.start[rows])

    @property
    def model(self) -> TorsionalModel:
        return TorsionalModel(**dict(zip(RANGES, self.columns.T, strict=True)))

    @property
    def unit(self) -> Floats:
        """Scales of (x, x'): the half backlash, and that times the frequency."""
        b, w = self.columns[:, list(RANGES).index("half_backlash")], self.columns[:, 1]
        return np.stack([b, b * w], axis=1)


@dataclass
class Found:
    """What some motions showed."""

    counts: Counter[str] = field(default_factory=Counter)
    notes: list[str] = field(default_factory=list)
    worst: dict[str, float] = field(default_factory=dict)
    seconds: dict[str, float] = field(default_factory=dict)

    def see(self, what: str, value: float) -> None:
        self.worst[what] = max(self.worst.get(what, 0.0), value)

    def add(self, other: Found) -> None:
        self.counts += other.counts
        self.notes += other.notes
        for what, value in other.worst.items():
            self.see(what, value)
        for what, value in other.seconds.items():
            self.seconds[what] = self.seconds.get(what, 0.0) + value


def draws(count: int, seed: int = SEED) -> tuple[Drawn, int]:
    """``count`` motions that lose contact after 500 periods, and how many were drawn for it."""
    rng = np.random.default_rng(seed)
    low, high = np.array(list(RANGES.values())).T
    kept: list[Drawn] = []
    asked = have = 0
    while have < count:
        drawn = Drawn(rng.uniform(low, high, (200, low.size)), rng.uniform(*STARTS, (200, 2)))
        run = simulate(
            drawn.model, initial_state=drawn.start, discard=500, periods=64, samples_per_period=0
        )
        losing = np.flatnonzero((run["contact_losses"].values > 0) & (run["status"].values == 0))
        room = losing[: count - have]
        asked += 200 if room.size == losing.size else int(room[-1]) + 1
        have += room.size
        kept.append(drawn.part(room))
    return Drawn(
        np.concatenate([one.columns for one in kept]), np.concatenate([one.start for one in kept])
    ), asked


def trial(job: tuple[int, Drawn]) -> Found:
    """All that some motions are put through; the job says the number of the first."""
    first, drawn = job
    found = Found()
    began = time.process_time()

    def lap(what: str) -> None:
        nonlocal began
        found.seconds[what] = time.process_time() - began
        began = time.process_time()

    told = labels(drawn.model, initial_state=drawn.start, threads=1)
    lap("labels")
    for one in told:
        found.counts[one.name] += 1
    right = np.ones(len(told), bool)
    for row, one in enumerate(told):
        if one.name.startswith("period-"):
            complaint = confirm(drawn, row, one, found)
            if complaint:
                found.counts["orbits not confirmed"] += 1
                found.notes.append(f"{first + row}: {one.name}: {complaint}")
                right[row] = False
    lap("orbits")
    for row, words in elsewhere(drawn, told, first, found):
        found.counts["period labels whose neighbours end elsewhere"] += 1
        found.notes.append(f"{first + row}: {told[row].name}: {words}")
        right[row] = False
    lap("starts beside")
    chaotic = np.array([i for i, one in enumerate(told) if one.name == "chaotic"], dtype=int)
    for row, words in zip(chaotic, ends(drawn.part(chaotic)), strict=True):
        if words:
            found.counts["chaotic motions that end"] += 1
            found.notes.append(f"{first + row}: {told[row]}: {words}")
            right[row] = False
    lap("chaos")
    for row, one in enumerate(told):
        if one.name == "undecided":
            found.notes.append(f"{first + row}: undecided: {one.reason}")
    faster(drawn, told, right, found)
    lap("faster rule")
    return found


def confirm(drawn: Drawn, row: int, one: Label, found: Found) -> str:
    """What is wrong with a labelled orbit, closed anew by multiple shooting; "" if nothing."""
    if one.orbit is None:
        return "no orbit"
    zeta, w, eps, mean, force, b, heat = drawn.columns[row].tolist()
    period, unit = 2.0 * np.pi / w, drawn.unit[row]

    def rate(t: float, y: Floats, region: int) -> Floats:
        k = 0.0 if region == 0 else 1.0 + heat + eps * np.cos(w * t)
        push = mean + force * np.cos(w * t) - 2.0 * zeta * y[1] - k * (y[0] - region * b)
        turned = [-2.0 * zeta * y[3 + 2 * i] - k * y[2 + 2 * i] for i in (0, 1)]
        return np.array([y[1], push, y[3], turned[0], y[5], turned[1]])

    gap = Gap(value=lambda _, y: float(y[0]), speed=lambda _, y: float(y[1]), half_backlash=b)
    points = one.orbit.points.copy()
    n = len(points)
    size = np.inf
    for steps in range(6):
        blocks, miss = np.zeros((n, 2, n, 2)), np.empty((n, 2))
        product = np.eye(2)
        for k in range(n):
            begin = np.array([*points[k], 1.0, 0.0, 0.0, 1.0])
            end = follow(rate, gap, period, begin, periods=1, samples=0)[0][1]
            turn = end[2:].reshape(2, 2).T
            product = turn @ product
            miss[k] = end[:2] - points[(k + 1) % n]
            blocks[k, :, k] += turn
            blocks[k, :, (k + 1) % n] -= np.eye(2)
        size = float(np.max(np.abs(miss) / unit))
        # at least one step of our own
        if steps and size < 1e-10:
            break
        step = np.linalg.solve(blocks.reshape(2 * n, 2 * n), -miss.ravel())
        points += step.reshape(n, 2)
    if not size < 1e-8:
        return f"multiple shooting does not close: {size:.1e}"
    found.see("residual of the closed orbits, half backlashes", size)
    apart = float(np.max(np.abs(points - one.orbit.points) / unit))
    found.see("closed orbits from the labelled ones, half backlashes", apart)
    if apart > 1e-6:
        return f"another orbit, {apart:.1e} away"
    for lag in range(1, n):
        if n % lag == 0 and np.max(np.abs(np.roll(points, lag, axis=0) - points) / unit) < 1e-6:
            return f"closes after {lag} periods already"
    mu = np.linalg.eigvals(product)
    largest = float(np.max(np.abs(mu)))
    if not largest < 1.0:
        return f"unstable: {largest:.6f}"
    away = abs(largest - float(np.max(np.abs(one.orbit.multipliers))))
    found.see("largest multipliers apart", away)
    return f"multiplier {largest:.6f} is another" if away > 1e-4 else ""


def elsewhere(
    drawn: Drawn, told: Sequence[Label], first: int, found: Found
) -> Iterator[tuple[int, str]]:
    """Period labels with a start beside them that does not end on their orbit."""
    periodic = np.array([i for i, one in enumerate(told) if one.orbit is not None], dtype=int)
    periodic = periodic[[told[i].name != "undecided" for i in periodic]]
    rng = np.random.default_rng([SEED, first])
    owner = np.repeat(periodic, BESIDE)
    state = drawn.start[owner] + APART * rng.uniform(-1.0, 1.0, (owner.size, 2))
    waiting = np.arange(owner.size)
    lost: Counter[int] = Counter()
    lanes, elapsed, length = drawn.model.lanes(), 0, 1000
    while waiting.size and elapsed < FAR:
        group = Ensemble(lanes.take(owner[waiting]), state[waiting], threads=1)
        window = group.run(length, keep=128) / drawn.unit[owner[waiting], None]
        state[waiting] = group.state
        elapsed += length
        length = min(2 * length, FAR - elapsed)
        left = []
        for row, place in enumerate(waiting):
            lane = int(owner[place])
            orbit = told[lane].orbit
            assert orbit is not None
            points = orbit.points / drawn.unit[lane]
            near = np.abs(window[row, -len(points) :, None] - points).max(axis=2).min(axis=1)
            if near.max() < 1e-6:
                continue
            if any(np.abs(window[row, lag:] - window[row, :-lag]).max() < 1e-9 for lag in RETURNS):
                lost[lane] += 1
            else:
                left.append(place)
        waiting = np.array(left, dtype=int)
    for place in waiting:
        lost[int(owner[place])] += 1
    found.counts["starts beside them"] += owner.size
    for lane, many in sorted(lost.items()):
        yield lane, f"{many} of {BESIDE} starts beside it end elsewhere"


RETURNS = range(1, 65)


def ends(drawn: Drawn) -> list[str]:
    """How each motion ends within :data:`FAR` periods: "" where it stays chaotic."""
    if not len(drawn.start):
        return []
    lanes = drawn.model.lanes()
    group = Ensemble(lanes, drawn.start, threads=1)
    group.run(FAR - 10_000)
    last = Ensemble(lanes, group.state, threads=1, parting=True)
    window = last.run(10_000, keep=2 * LONGEST) / drawn.unit[:, None]
    found = []
    for row in range(len(lanes)):
        words = ""
        for lag in range(1, LONGEST + 1):
            if np.abs(window[row, lag:] - window[row, :-lag]).max() < 1e-5:
                words = f"period {lag} by {FAR} periods"
                break
        if not words and not last.level[row] > 0.0:
            words = f"exponent {last.level[row] / 1e4:.2g} a period at the end"
        found.append(words)
    return found


def faster(drawn: Drawn, told: Sequence[Label], right: NDArray[np.bool_], found: Found) -> None:
    """The rule of maps on the same motions, against the labels that stood."""
    settled = settle(drawn.model.lanes(), drawn.start, MAP_RULE)
    for row, one in enumerate(told):
        code, period = int(settled.label[row]), int(settled.period[row])
        kind = {PERIODIC: "periodic", CHAOTIC: "chaotic"}.get(code, "undecided")
        found.counts[f"faster rule: {kind}"] += 1
        if kind == "undecided" or one.name == "undecided" or one.name == "diverged":
            continue
        truth = f"period-{one.period}" if one.period else "chaotic"
        if not right[row] or truth != (f"period-{period}" if kind == "periodic" else kind):
            found.counts[f"faster rule: {kind}, another by the full one"] += 1


WRONG = (
    "orbits not confirmed",
    "period labels whose neighbours end elsewhere",
    "chaotic motions that end",
)
"""What must not happen once."""


def all_trials(drawn: Drawn, workers: int = 2) -> Iterator[Found]:
    """The trials in order, by several processes."""
    count = len(drawn.start)
    jobs = [
        (first, drawn.part(np.arange(first, min(first + BATCH, count))))
        for first in range(0, count, BATCH)
    ]
    if workers < 2:
        yield from map(trial, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(partial(trial), jobs)


WHY = {
    "within 0.002 of a bifurcation": "of a bifurcation",
    "starts 1e-13 apart end apart": "depends on rounding",
    "some starts end, the others go on": "the others not in",
}
"""Why a motion is undecided, and the words of its reason."""


def why(notes: Sequence[str]) -> Counter[str]:
    """How often each reason of :data:`WHY` stands in the notes, and what is left."""
    told = [note for note in notes if ": undecided: " in note]
    found = Counter({name: sum(part in note for note in told) for name, part in WHY.items()})
    found["not settled in time"] = len(told) - found.total()
    return found


def page(count: int, asked: int, found: Found) -> str:
    """The table of trials/records/labels.md."""
    counts = found.counts
    periods = Counter({k: n for k, n in counts.items() if k.startswith("period-")})
    undecided = counts["undecided"]
    seen = [("period label", periods.total()), ("chaotic", counts["chaotic"])]
    seen += [(word, counts[word]) for word in ("diverged", "undecided")]
    asserted = sum(counts[what] for what in WRONG)
    names = sorted(periods, key=lambda name: int(name.removeprefix("period-")))
    spans = [
        f"{name.replace('_', ' ')} {low:g} to {high:g}" for name, (low, high) in RANGES.items()
    ]
    lines = [
        "# Trial of labels",
        "",
        f"Made by `make trial NAME=labels` (seed {SEED}): {count} random motions that "
        f"lose contact,",
        f"of {asked} drawn: " + ", ".join(spans[:4]) + ",",
        ", ".join(spans[4:]) + f"; starts {STARTS[0]:g} to {STARTS[1]:g} in x and x'.",
        "",
        "- Every orbit of a period label is closed anew by multiple shooting on the adaptive",
        "  integrator: it must close, not sooner, be stable, and have the multiplier of the label.",
        f"- {BESIDE} new starts within {APART:g} of each must end on that orbit.",
        f"- Every chaotic motion is followed to {FAR} periods: no return up to {LONGEST} of them",
        "  may close, and neighbours must still part.",
        "",
        "| label | motions |",
        "|---|---:|",
        *(f"| {word} | {n} |" for word, n in seen),
        "",
        "| wrong | times |",
        "|---|---:|",
        *(f"| {what} | {counts[what]} |" for what in WRONG),
        f"| asserted labels wrong | {asserted} of {count - undecided} |",
        f"| undecided | {100.0 * undecided / count:.2f} % |",
        *(f"| undecided: {name} | {n} |" for name, n in why(found.notes).items()),
        "",
        "| beside it | |",
        "|---|---:|",
        *(f"| {name} | {periods[name]} |" for name in names),
        f"| starts beside period labels | {counts['starts beside them']} |",
        *(f"| worst {what} | {value:.1e} |" for what, value in sorted(found.worst.items())),
        "",
        "The faster rule of `map` (one start, one rounding, left as soon as it holds) on the same",
        "motions, where the full rule decides:",
        "",
        "| faster rule | motions | another label by the full rule |",
        "|---|---:|---:|",
        *(
            f"| {kind} | {counts[f'faster rule: {kind}']} "
            f"| {counts[f'faster rule: {kind}, another by the full one']} |"
            for kind in ("periodic", "chaotic")
        ),
        f"| undecided | {counts['faster rule: undecided']} | |",
        "",
    ]
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    count = int(words[0]) if words else 2000
    began = time.perf_counter()
    drawn, asked = draws(count)
    found = Found()
    for number, one in enumerate(all_trials(drawn)):
        found.add(one)
        for note in one.notes:
            print(note, flush=True)
        if sys.stderr.isatty() or (number + 1) % 8 == 0:
            done = min((number + 1) * BATCH, count)
            print(f"\r{done} of {count}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    text = page(count, asked, found)
    parts = ", ".join(f"{what} {s:.0f}" for what, s in found.seconds.items())
    print(f"{time.perf_counter() - began:.0f} s; of a core: {parts}")
    if words:
        print(text)
    else:
        PAGE.write_text(text, "utf-8")
        print(PAGE.relative_to(Path.cwd()) if PAGE.is_relative_to(Path.cwd()) else PAGE)
    return int(any(found.counts[what] for what in WRONG))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
