"""Fresh random drive trains: what share of labels is undecided, and are the others right?

``make trial NAME=train_fresh`` draws 200 trains of a seed that no rule has seen and labels each
from rest, in one start; as many of them as ``--ruled`` names (20) by the rule of the studies, too,
with two starts where rounding decides. 40 labels are held against the long independent integration
of ``train_reference.py``. Writes trials/records/train_fresh.md with intervals of the shares. What
is done is kept until the code changes, so that a stopped trial goes on. ``--seed`` draws others.
"""

from __future__ import annotations

import argparse
import signal
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).parent))
from train_draws import drawn
from train_rounding import STARTS
from trains import (
    CHECKED,
    FINER,
    KEPT,
    LONG,
    MODES,
    ROOT,
    SLOWEST,
    Record,
    checked,
    chosen,
    code,
    each,
    kept,
    told,
)

from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Motion
from thermogear.dynamics.geared_map import GearedMap
from thermogear.study.shafts.motion import search_of

SEED = 66_2026
COUNT, RULED = 200, 20
LIMIT = 120
"""Processor time of a label [s], chosen: a train that takes longer counts as undecided."""
PAGE = ROOT / "trials" / "records" / "train_fresh.md"


def labelled(number: int, seed: int = SEED, starts: int = 1) -> Record:
    """The label of train ``number`` from rest; a torus by finer steps, too."""
    one = drawn(number, seed)
    train = one.train(MODES)
    search = replace(search_of(train.model.cycle), starts=starts)

    def label(section: GearedMap) -> Motion:
        return settle(section, train.start, search)

    def stop(*_: object) -> None:
        raise TimeoutError

    began = time.process_time()
    signal.signal(signal.SIGVTALRM, stop)
    signal.setitimer(signal.ITIMER_VIRTUAL, LIMIT)
    try:
        first = label(GearedMap(model=train.model))
    except TimeoutError:
        words = f"no label within {LIMIT} s of processor time"
        first = Motion("undecided", 0, words, 0, state=np.asarray(train.start))
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    seconds = time.process_time() - began
    found: Record = {
        "number": number, "kind": one.kind, "cycle": train.model.cycle,
        "label": told(first, seconds),
    }  # fmt: skip
    if first.name == "quasi-periodic":
        found["steps"] = told(label(GearedMap(model=train.model, how=FINER)), seconds)
    return found


def share(hits: int, of: int) -> str:
    """So many of so many, with the exact interval of 95 % (Clopper and Pearson)."""
    ends = binomtest(hits, of).proportion_ci(confidence_level=0.95, method="exact")
    low, high = 100.0 * ends.low, 100.0 * ends.high
    return f"{hits} of {of}, {100.0 * hits / of:.2g} % ({low:.2g} to {high:.2g} %)"


def page(
    records: Sequence[Record], ruled: Sequence[Record], complaints: dict[int, str], seed: int
) -> str:
    """The text of trials/records/train_fresh.md."""
    names = Counter(one["label"]["name"] for one in records)
    slow = sum(0.998 < one["label"]["multiplier"] < 1.0 for one in records)
    both = {one["number"]: one["label"]["name"] for one in records}
    other = [one for one in ruled if one["label"]["name"] != both.get(one["number"])]
    open_ = [one for one in (*records, *ruled) if one["label"]["name"] == "undecided"]
    wrong = {number: words for number, words in complaints.items() if words}
    seconds = np.array([one["label"]["seconds"] for one in records])
    order = sorted(names, key=lambda name: (not name.startswith("period-"), len(name), name))
    lines = [

        "# Fresh drive trains",
        "",
        f"Made by `make trial NAME=train_fresh` (seed {seed}, fixed before the first run): "
        f"{len(records)} random drive trains,",
        "drawn as those of [the trial of drive trains](trains.md), each labelled from rest. "
        "Shares with their exact interval of 95 %.",
        *[f"**Only {len(records)} of {COUNT} have run.**"] * (len(records) < COUNT),
        "",
        f"- **Undecided: {share(names['undecided'], len(records))}** from one start.",
        f"- Undecided by the rule of the studies, {STARTS} starts for its 16: "
        f"{share(sum(one['label']['name'] == 'undecided' for one in ruled), len(ruled))} "
        "of the first ones.",
        f"- Another label by that rule than from one start: {share(len(other), len(ruled))}.",
        f"- **Wrong: {share(len(wrong), len(complaints))}** held against the long integration by "
        "another rule",
        f"  (DOP853, {LONG} to {SLOWEST} mesh periods).",
        "",
        "| label | trains |", "|---|---:|",
        *(f"| {name} | {names[name]} |" for name in order),
        f"| with a largest multiplier of 0.998 to 1 | {slow} |",
        "",
        *(f"- {one['number']}: undecided: {one['label']['reason']}" for one in open_),
        *(f"- {number}: {words}" for number, words in wrong.items()),
        "",
        f"Processor time of a label from one start: median {np.median(seconds):.2g} s, the longest "
        f"{seconds.max():.2g} s.",
        "",
    ]  # fmt: skip
    return "\n".join(lines)


def main(words: Sequence[str]) -> int:
    reader = argparse.ArgumentParser(description=__doc__)
    for name, value in (("seed", SEED), ("count", COUNT), ("ruled", RULED), ("checked", CHECKED)):
        reader.add_argument(f"--{name}", type=int, default=value, help="default: %(default)s")
    reader.add_argument("--write", action="store_true", help="the page, of however many trains")
    asked = reader.parse_args(words)
    seed = asked.seed
    path, more = (KEPT / f"{name}-{seed}-{code()}.jsonl" for name in ("fresh", "ruled"))
    done, also = kept(path), kept(more)
    try:
        records = [
            one
            for _, one in each(
                "labelled", range(asked.count), done["labelled"], path,
                lambda number: labelled(number, seed),
            )
        ]  # fmt: skip
        by_number = {one["number"]: one for one in records}
        numbers = [one["number"] for one in chosen(records, min(asked.checked, asked.count))]
        complaints = dict(
            each(
                "checked", numbers, done["checked"], path,
                lambda number: checked(by_number[number], seed),
            )
        )  # fmt: skip
        ruled = [
            one
            for _, one in each(
                "labelled", range(min(asked.ruled, asked.count)), also["labelled"], more,
                lambda number: labelled(number, seed, STARTS),
            )
        ]  # fmt: skip
    except KeyboardInterrupt:
        print(f"\nstopped; what is done is kept in {path.relative_to(ROOT)}", file=sys.stderr)
        return 130
    text = page(records, ruled, complaints, seed)
    if seed == SEED and (asked.count == COUNT or asked.write):
        PAGE.write_text(text, "utf-8")
    print(text)
    return int(any(complaints.values()))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
