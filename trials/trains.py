"""Random drive trains: is the label of a settled motion the same when it is asked otherwise?

``make trial NAME=trains`` draws 200 trains (seed fixed before the first run) and labels each four
times:
by the rule of the studies, after twice the transient, with finer steps, and in more coordinates.
Where rounding decides, two starts stand for the sixteen of the rule, for time. A label that
changed is put to tests that say why. 40 other trains are labelled on one thread of the linear
algebra and on two, and from starts beside (``train_rounding.py``). 40 labels are held against a
long integration by another rule, which shares nothing with the engine. Writes
trials/records/trains.md; what is done is kept until the code changes, so that a stopped trial goes
on. ``--count 20`` prints a short one.
"""

from __future__ import annotations

import argparse
import hashlib
import inspect
import json
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize_scalar

sys.path.insert(0, str(Path(__file__).parent))
from train_draws import ERRORS, IN_TURN, RATIO, SEED, UNIT_LOAD, Drawn, drawn
from train_reference import Independent
from train_rounding import COUNT as ROUNDED
from train_rounding import STARTS, ran
from train_rounding import complaints as differing_labels
from train_rounding import page as page_of_rounding

from thermogear.analysis.agreement import FOLLOW
from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Motion
from thermogear.dynamics.geared_map import GearedMap
from thermogear.dynamics.ladder import Steps
from thermogear.study.shafts.motion import search_of
from thermogear.study.shafts.moving import MovingTrain

Floats = NDArray[np.float64]
Record = dict[str, Any]

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "trials" / "records" / "trains.md"
KEPT = ROOT / ".trial"
COUNT, CHECKED = 200, 40
FINER = Steps(accuracy=1e-11, longest=16, rungs=12)
MODES, MORE_MODES = 6, 10
"""Modes kept beside the interface, and those added: then as many as the studies keep."""
MOVES = (1e-3, 3e-3, 0.01, 0.03)
"""Shares by which the speed is moved to look for the border of a label that changed."""
ONE_OPEN = "undecided in one of both"
WAYS = ("label", "transient", "steps", "reduction")
WORDS = {
    "transient": "twice the transient",
    "steps": "finer steps",
    "reduction": f"{MORE_MODES} more coordinates",
}


def label_of(section: GearedMap, start: Floats) -> tuple[Motion, float]:
    """What ``start`` settles on by the rule of the studies, and the processor time [s] it took."""
    began = time.process_time()
    found = settle(section, start, replace(search_of(section.model.cycle), starts=STARTS))
    return found, time.process_time() - began


def told(found: Motion, seconds: float) -> Record:
    """A label as the kept file holds it."""
    torus = found.torus
    return {
        "name": found.name,
        "period": found.period,
        "reason": found.reason,
        "used": found.discarded,
        "seconds": seconds,
        "state": found.state.tolist(),
        "multiplier": abs(found.multiplier),
        "orbit": found.orbit is not None,
        "lyapunov": found.lyapunov,
        "frequency": None if torus is None else torus.frequency,
        "curves": 1 if torus is None else torus.curves,
    }


def labelled(number: int) -> Record:
    """All four labels of a train, what it loses, and why a label changed."""
    one = drawn(number)
    train = one.train(MODES)
    section = GearedMap(model=train.model)
    first, seconds = label_of(section, train.start)
    found: Record = {
        "number": number,
        "kind": one.kind,
        "hot": one.hot,
        "cycle": train.model.cycle,
        "coordinates": train.model.size,
        "rpm": one.rest.speed * 30.0 / np.pi,
        "ratio": one.ratio,
        "label": told(first, seconds),
    }
    if first.name != "diverged":
        run = section.engine.run(first.state, max(64, train.model.cycle))
        found |= {what: run.counts[what] for what in ("losses", "impacts", "lifts")}
    late = train.start
    if first.name != "diverged":
        late = section.carry(train.start, 2 * first.discarded)[-1]
    found["transient"] = told(*label_of(section, late))
    found["steps"] = told(*label_of(GearedMap(model=train.model, how=FINER), train.start))
    other = one.train(MODES + MORE_MODES)
    found["reduction"] = told(*label_of(GearedMap(model=other.model), other.start))
    return found


def changed(record: Record) -> list[str]:
    """The ways to ask that gave another label than the first."""
    return [way for way in WAYS[1:] if record[way]["name"] != record["label"]["name"]]


def explained(record: Record) -> dict[str, str]:
    """Which test explains each label that changed; "unexplained" where none does."""
    one = drawn(record["number"])
    train, other = one.train(MODES), one.train(MODES + MORE_MODES)
    here = GearedMap(model=train.model)
    maps = {
        "transient": here,
        "steps": GearedMap(model=train.model, how=FINER),
        "reduction": GearedMap(model=other.model),
    }
    found = {
        way: why(one, here, train, maps[way], other if way == "reduction" else train, record, way)
        for way in changed(record)
    }
    if "reduction" in found:
        few, many = (each.reduction.frequencies(one.rest.linear, 12) for each in (train, other))
        apart = 100.0 * float(np.max(np.abs(few[: many.size] / many[: few.size] - 1.0)))
        found["reduction"] += f" (12 lowest frequencies up to {apart:.2g} % apart)"
    return found


def why(
    one: Drawn,
    here: GearedMap,
    train: MovingTrain,
    there: GearedMap,
    other: MovingTrain,
    record: Record,
    way: str,
) -> str:
    """Which test explains that the label ``there`` is another than ``here``."""
    names = (record["label"]["name"], record[way]["name"])
    if "undecided" in names:
        return ONE_OPEN
    state = np.array(record["label"]["state"])
    back = across(np.array(record[way]["state"]), other, train)
    if (
        label_of(there, across(state, train, other))[0].name == names[0]
        or label_of(here, back)[0].name == names[1]
    ):
        return "both motions exist there"
    both = (
        (train, here, state, names[0]),
        (other, there, np.array(record[way]["state"]), names[1]),
    )
    for share in MOVES:
        for turn in (1.0 - share, 1.0 + share):
            for own, section, begun, name in both:
                moved = own.at_speed(one.case, one.rest.speed * turn)
                beside = GearedMap(model=moved.model, how=section.how)
                if label_of(beside, begun)[0].name not in (name, "undecided"):
                    return f"border within {100.0 * share:g} % of the speed"
    return "unexplained"


def across(state: Floats, one: MovingTrain, other: MovingTrain) -> Floats:
    """``state`` of a train in the coordinates of another reduction of it."""
    if one is other:
        return state
    whole = state.reshape(2, -1) @ one.reduction.basis.T
    return np.asarray(other.reduction.coordinates(whole)).ravel()


# --- a long integration by another rule -----------------------------------------------------------

APART = 1e-9
"""How far apart neighbours begin, in units of the map."""
LONG = 2000
"""Mesh periods at least that a motion is followed."""
LONGER = 8000
"""On a torus, and at most in chaos."""
SLOWEST = 80_000
"""At most, beside an orbit: one that is neared slowly is followed until the start's distance has
shrunk by 1000, as its multiplier says."""
LONGEST = 512
CLOSES = 1e-4
"""Units of the map within which a motion has returned."""
LINEAR = (1e-7, 1e-3)
"""Returns between which the rate is measured: above rounding, and the multipliers' own."""
RATE = 0.2
"""Share by which the rate may be another than the multiplier says."""
SLOW = 0.99
"""Of a largest multiplier above it the end of the motion is this one's alone."""


def chosen(records: Sequence[Record], count: int) -> list[Record]:
    """Motions to be checked: of every label in turn, by their numbers."""
    groups: dict[str, list[Record]] = {}
    for one in records:
        name = one["label"]["name"]
        if name in ("undecided", "diverged"):
            continue
        kind = "period-n" if name.startswith("period-") and name != "period-1" else name
        groups.setdefault(kind if one["cycle"] == 1 else "shaft orders", []).append(one)
    found: list[Record] = []
    for place in range(len(records)):
        found += [group[place] for group in groups.values() if place < len(group)]
    return sorted(found[:count], key=lambda one: int(one["number"]))


def checked(record: Record, seed: int = SEED) -> str:
    """What a long independent integration has against the label of ``record``; "" for nothing."""
    one = drawn(record["number"], seed)
    model = one.train(MODES).model
    section, other = GearedMap(model=model), Independent(model)
    label = record["label"]
    state = np.array(label["state"])
    rng = np.random.default_rng([seed, record["number"], 1])
    aside = rng.uniform(-1.0, 1.0, state.size) * section.unit
    if label["name"].startswith("period-"):
        return _closes(section, other, state, aside, label)
    return _stays_open(section, other, state, aside, record)


def _closes(
    section: GearedMap, other: Independent, state: Floats, aside: Floats, label: Record
) -> str:
    """A start beside the orbit must come back to it, close after that period and not sooner.

    As fast as its largest multiplier says.
    """
    cycle, n = section.model.cycle, int(label["period"])
    lag = n * cycle
    decay = -np.log(label["multiplier"]) if label["orbit"] else 1e-3 * lag
    periods = lag * int(np.ceil(np.clip(7.0 * lag / decay, LONG, SLOWEST) / lag) + 2)
    path = np.vstack([state, other.carry(state + 1e-3 * aside, periods)])
    gaps = section.distance(path[lag::lag], path[:-lag:lag])
    gap = [float(gaps[k]) for k in (len(gaps) // 2, -1)]
    if gap[1] > CLOSES or (gap[1] > 1e-7 and gap[1] > 0.7 * gap[0]):
        return f"does not close after {lag} mesh periods: {gap[0]:.1e}, later {gap[1]:.1e}"
    away = float(section.distance(path[-lag:], state).min())
    if away > 0.02:
        return f"ends {away:.1e} away from the orbit"
    for shorter in range(1, n):
        if n % shorter == 0:
            sooner = float(section.distance(path[-1], path[-1 - shorter * cycle]))
            if sooner < 10.0 * max(gap[1], CLOSES):
                return f"closes after {shorter} of {n} already: {sooner:.1e}"
    return _nears(gaps, decay) if label["orbit"] else ""


def _nears(gaps: Floats, decay: float) -> str:
    """The returns of one orbit after the other must shrink by exp(-decay) each."""
    low, high = LINEAR
    large = np.flatnonzero(gaps > high)
    own = gaps[int(large[-1]) + 1 if large.size else 0 :]
    rounded = np.flatnonzero(own < low)
    own = own[: int(rounded[0]) if rounded.size else own.size]
    own = own[own.size // 2 :]
    if own.size < 25:
        return ""
    rate = -float(np.polyfit(np.arange(own.size), np.log(own), 1)[0])
    fast = rate > (1.0 + RATE) * decay and np.exp(-decay) > SLOW
    if rate < (1.0 - RATE) * decay or fast:
        return f"nears by {np.exp(-rate):.6f} an orbit, its multiplier is {np.exp(-decay):.6f}"
    return ""


def _stays_open(
    section: GearedMap, other: Independent, state: Floats, aside: Floats, record: Record
) -> str:
    """No lag closes; neighbours part in chaos, and on a torus they do not."""
    label = record["label"]
    chaotic = label["name"] == "chaotic"
    periods = LONGER
    if chaotic:
        growth = max(label["lyapunov"] * section.period, 1e-9)
        periods = int(np.clip(60.0 / growth, LONG, LONGER))
    path = other.carry(state, periods)
    near = other.carry(state + APART * aside, periods)
    last = path[-LONGEST - 256 :]
    back = np.array(
        [section.distance(last[lag:], last[:-lag])[-256:].max() for lag in range(1, LONGEST + 1)]
    )
    parted = float(section.distance(path[-256:], near[-256:]).max())
    if chaotic:
        if back.min() < CLOSES:
            return f"closes after {back.argmin() + 1} periods within {back.min():.1e}"
        return "" if parted > 1e-3 else f"neighbours stay {parted:.1e} apart"
    if parted > 1e-3:
        return f"neighbours {APART:g} apart part to {parted:.1e}"
    nu, curves = float(label["frequency"]), int(label["curves"])
    # what finer steps change of the frequency is the label's own error
    finer = record["steps"]["frequency"]
    within = 1e-5 + (abs(nu - float(finer)) if finer is not None else 0.0)
    away = _turns_like(section, path, nu, curves)
    if away > within:
        return f"second frequency {away:.1e} away, allowed {within:.1e}"
    return _returns(path / section.unit, back, nu, curves)


def _returns(path: Floats, back: Floats, nu: float, curves: int) -> str:
    """On closed curves the return after q periods is as far as q nu is from a whole number.

    A curve of one line of size a comes back within 2 a |sin(pi q nu)|; here of all its lines,
    fitted to the sections themselves at the frequency that leaves least. A periodic motion of q
    periods would come back within nothing: q nu must not be whole within its error, and no return
    nearer than half of what is foretold.
    """
    path = path[len(path) % (2 * curves) :]
    half = len(path) // 2
    whole, first, second = (_frequency(p, nu, curves) for p in (path, path[:half], path[half:]))
    error = max(abs(first - second), abs(whole - first))
    count, lags = len(path) - LONGEST, np.arange(1, LONGEST + 1)
    model = _fitted(path, whole, curves)[0]
    here = _turned(whole, curves, np.arange(count)[-256:]) @ model
    for lag in lags:
        off = abs(lag * whole * curves - round(lag * whole * curves)) / curves
        if lag % curves == 0 and off < 4.0 * lag * error:
            return f"{lag} nu is whole within its error: {off:.1e} of {lag * error:.1e}"
        there = _turned(whole, curves, np.arange(count)[-256:] + lag) @ model
        told, found = float(np.abs(there - here).max()), float(back[lag - 1])
        if found < 0.5 * told:
            return f"comes back after {lag} periods within {found:.1e}, foretold {told:.1e}"
    return ""


LINES = 12
"""Harmonics of the second frequency, each way, that the check fits to sections on a torus."""
NEAR_NU = 4e-5
"""Cycles a period about the label's frequency in which the check looks for its own."""


def _turned(nu: float, curves: int, k: NDArray[np.int64]) -> Floats:
    """Lines at the multiples of ``nu``, another set on each of the curves visited in turn."""
    turn = 2.0 * np.pi * nu * np.multiply.outer(k, np.arange(1, LINES + 1))
    one = np.hstack([np.ones((k.size, 1)), np.cos(turn), np.sin(turn)])
    return np.hstack([one * (k % curves == c)[:, None] for c in range(curves)])


def _fitted(path: Floats, nu: float, curves: int) -> tuple[Floats, float]:
    """Least squares of the lines, and what they leave; both ends of the record count little."""
    t = (np.arange(len(path)) + 0.5) / len(path)
    weight = np.exp(-0.5 / (t * (1.0 - t)))[:, None]
    lines = weight * _turned(nu, curves, np.arange(len(path)))
    model = np.linalg.lstsq(lines.T @ lines, lines.T @ (weight * path), rcond=None)[0]
    return model, float(np.linalg.norm(lines @ model - weight * path))


def _frequency(path: Floats, nu: float, curves: int) -> float:
    """The frequency near ``nu`` that leaves least of the sections."""
    most = path[:, [int(path.std(axis=0).argmax())]]
    found = minimize_scalar(
        lambda one: _fitted(most, one, curves)[1],
        bounds=(nu - NEAR_NU, nu + NEAR_NU),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return float(found.x)


def _turns_like(section: GearedMap, path: Floats, frequency: float, curves: int) -> float:
    """How far the strongest line of the sections is from the nearest multiple of ``frequency``."""
    moved = path[len(path) % curves :] / section.unit
    turns = moved.reshape(-1, curves, moved.shape[1])
    moved = (turns - turns.mean(axis=0)).reshape(moved.shape)
    one = moved[:, int(moved.std(axis=0).argmax())] * np.hanning(len(moved))
    size = np.abs(np.fft.rfft(one))
    size[:4] = 0.0
    at = int(np.clip(size.argmax(), 1, size.size - 2))
    low, mid, high = np.log(size[at - 1 : at + 2])
    line = (at + 0.5 * (low - high) / (low - 2.0 * mid + high)) / len(moved)
    shifts = np.arange(curves) / curves
    multiples = np.mod(np.add.outer(frequency * np.arange(1, 13), shifts), 1.0)
    return float(np.abs(np.minimum(multiples, 1.0 - multiples) - line).min())


# --- what is kept, and the page ------------------------------------------------------------------


def code() -> str:
    """A mark of the code that labels and checks: records of another are not reused."""
    parts = [
        Path(__file__).parent / name
        for name in ("train_draws.py", "train_reference.py", "train_rounding.py")
    ]
    for floor in ("base", "gears", "shafts", "heat", "mesh", "case", "dynamics", "analysis"):
        parts += sorted((ROOT / "src" / "thermogear" / floor).rglob("*.py"))
    parts += sorted((ROOT / "src" / "thermogear" / "study" / "shafts").glob("*.py"))
    own = [label_of, told, labelled, explained, why, across]
    own += [checked, _closes, _nears, _stays_open, _returns, _turned, _fitted, _frequency]
    own += [_turns_like]
    text = "".join([*(one.read_text("utf-8") for one in parts), *map(inspect.getsource, own)])
    text += repr((FINER, MODES, MORE_MODES, MOVES, APART, LONG, LONGER, LONGEST, CLOSES))
    text += repr((SLOWEST, LINEAR, RATE, SLOW, LINES, NEAR_NU))
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def kept(path: Path) -> dict[str, dict[int, Any]]:
    """Records of an earlier run: what was done, by number; a torn last line is left."""
    found: dict[str, dict[int, Any]] = {"labelled": {}, "explained": {}, "checked": {}}
    if path.exists():
        for line in path.read_text("utf-8").splitlines():
            try:
                one = json.loads(line)
            except json.JSONDecodeError:
                continue
            found[one["what"]][int(one["number"])] = one["record"]
    return found


def each(
    what: str,
    numbers: Sequence[int],
    done: dict[int, Record],
    path: Path,
    make: Callable[[int], Any],
) -> Iterator[tuple[int, Any]]:
    """Records by number, made where they are missing and kept as soon as they are."""
    for place, number in enumerate(numbers):
        if number not in done:
            done[number] = make(number)
            path.parent.mkdir(exist_ok=True)
            with path.open("a", encoding="utf-8") as out:
                line = {"what": what, "number": number, "record": done[number]}
                out.write(json.dumps(line) + "\n")
        print(f"\r{what} {place + 1} of {len(numbers)}", end="", file=sys.stderr, flush=True)
        yield number, done[number]
    print(file=sys.stderr)


def reason_of(label: Record) -> str:
    """A kind of being undecided."""
    if label["orbit"]:
        return "an orbit whose multipliers are too near the border"
    if np.isfinite(label["lyapunov"]):
        return "no return, the exponent decides nothing"
    return "does not return in time"


def page(
    records: Sequence[Record],
    reasons: dict[int, dict[str, str]],
    complaints: dict[int, str],
    asked: int,
    rounding: dict[int, list[Record]] | None = None,
) -> str:
    """The table of trials/records/trains.md."""
    count = len(records)
    names = Counter(one["label"]["name"] for one in records)
    periods = sorted((n for n in names if n.startswith("period-")), key=lambda n: int(n[7:]))
    loses = sum(one.get("losses", 0) > 0 for one in records)
    hits = sum(one.get("impacts", 0) > 0 for one in records)
    lifts = sum(one.get("lifts", 0) > 0 for one in records)
    kinds = Counter(one["kind"] for one in records)
    orders = sum(one["cycle"] > 1 for one in records)
    sizes = [one["coordinates"] for one in records]
    undecided = {way: sum(one[way]["name"] == "undecided" for one in records) for way in WAYS}
    seconds = np.array([one[way]["seconds"] for one in records for way in WAYS])
    ran = "" if count == asked else f" **Only {count} of {asked} trains have run.**"
    wrong = {number: words for number, words in complaints.items() if words}
    lines = [
        "# Trial of drive trains",
        "",
        f"Made by `make trial NAME=trains` (seed {SEED}): {count} random drive trains "
        f"in motion.{ran}",
        f"Load {UNIT_LOAD[0]:g} to {UNIT_LOAD[1]:g} N/mm² over width and module, mesh frequency",
        f"{RATIO[0]:g} to {RATIO[1]:g} of the teeth's own, run-out of the teeth {ERRORS[0]:g} to "
        f"{ERRORS[1]:g} um,",
        "damping ratio of the mesh 0.01 to 0.1, friction of the teeth, "
        f"{100.0 * IN_TURN:g} % of draws with unbalance and",
        f"eccentric teeth. Each is labelled from rest, in the interface of contacts and {MODES} "
        "modes, and three times more.",
        "",
        "| trains | |",
        "|---|---:|",
        *(f"| {kind} bearings | {n} |" for kind, n in sorted(kinds.items())),
        f"| hot, the others undeformed | {sum(one['hot'] for one in records)} |",
        f"| with forces at shaft orders | {orders} |",
        f"| coordinates | {min(sizes)} to {max(sizes)} |",
        f"| lose contact of the drive flank | {loses} |",
        f"| strike the back flank | {hits} |",
        f"| lose contact of a bearing | {lifts} |",
        "",
        "| label | trains |",
        "|---|---:|",
        *(f"| {name} | {names[name]} |" for name in periods),
        *(f"| {n} | {names[n]} |" for n in ("quasi-periodic", "chaotic", "diverged", "undecided")),
        "",
        "| asked otherwise | undecided | another label | why |",
        "|---|---:|---:|---|",
        f"| from rest | {undecided['label']} of {count} | | |",
    ]
    for way in WAYS[1:]:
        said = [found[way].split(" (")[0] for found in reasons.values() if way in found]
        other = Counter(one for one in said if one != ONE_OPEN)
        words = "; ".join(f"{n} {what}" for what, n in sorted(other.items()))
        lines.append(f"| {WORDS[way]} | {undecided[way]} of {count} | {other.total()} | {words} |")
    open_labels = Counter(
        reason_of(one[way]) for one in records for way in WAYS if one[way]["name"] == "undecided"
    )
    lines += [
        "",
        f"Undecided: {sum(undecided.values())} of {4 * count} labels, "
        f"{100.0 * sum(undecided.values()) / (4 * count):.2f} %.",
        *(f"- {n}: {what}." for what, n in sorted(open_labels.items())),
        "",
        "A label counts as changed where both are decided and differ. *Both motions exist there*: "
        "started on the",
        f"other's motion, the train keeps it, from {STARTS} starts 1e-13 apart, chaos for {FOLLOW} "
        "periods. *Border*:",
        "at a speed as little away one of both has another label.",
        "",
        "Changed, by number:",
        "",
        *(
            f"- {one['number']}: {one['label']['name']}, {WORDS[way]}: {one[way]['name']}: {what}"
            for one in records
            for way, what in reasons.get(one["number"], {}).items()
        ),
        "",
        f"**Wrong: {len(wrong)} of {len(complaints)}** labels held against a long integration of "
        "the same equation by",
        f"another rule (DOP853, {LONG} to {SLOWEST} mesh periods): a start beside a periodic "
        "motion must come back to it",
        "as fast as its multiplier says, and close after that period, not sooner; in chaos "
        f"neighbours part and no return up to {LONGEST}",
        "closes; on a torus none comes nearer than its closed curve foretells, neighbours stay "
        "together and the sections turn at its second frequency.",
        "",
        *(f"- {number}: {words}" for number, words in wrong.items()),
        f"Processor time of a label: median {np.median(seconds):.2g} s, nine of ten below "
        f"{np.quantile(seconds, 0.9):.2g} s, the longest {seconds.max():.2g} s.",
        "",
        *page_of_rounding(rounding or {}),
    ]
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--count", type=int, default=COUNT, help="trains (default: %(default)s)")
    reader.add_argument("--write", action="store_true", help="the page, of however many trains")
    asked = reader.parse_args(words)
    path = KEPT / f"trains-{code()}.jsonl"
    done = kept(path)
    records: list[Record] = []
    try:
        numbers = range(asked.count)
        for _, one in each("labelled", numbers, done["labelled"], path, labelled):
            records.append(one)
        by_number = {one["number"]: one for one in records}
        others = [number for number, one in by_number.items() if changed(one)]
        reasons = dict(
            each("explained", others, done["explained"], path, lambda n: explained(by_number[n]))
        )
        some = [one["number"] for one in chosen(records, min(CHECKED, asked.count))]
        complaints = dict(
            each("checked", some, done["checked"], path, lambda n: checked(by_number[n]))
        )
    except KeyboardInterrupt:
        print(f"\nstopped; what is done is kept in {path.relative_to(ROOT)}", file=sys.stderr)
        return 130
    rounding = ran(KEPT / f"rounding-{code()}", min(asked.count, ROUNDED))
    text = page(records, reasons, complaints, COUNT, rounding)
    if asked.count == COUNT or asked.write:
        PAGE.write_text(text, "utf-8")
        print(PAGE.relative_to(ROOT))
    print(text)
    return int(any(complaints.values()) or bool(differing_labels(rounding)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
