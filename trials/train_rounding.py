"""Random drive trains: is the label of one state the same on other threads, from starts beside it?

The order in which a library of linear algebra adds numbers changes with its threads, and with it
the last digit of a train's matrices. Each train is labelled with one thread and with two, and with
one thread from starts that differ by rounding. ``trial_trains.py`` runs this file once for each
number of threads, which must be set before numpy is loaded, and makes the page.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from train_draws import drawn

from thermogear.analysis.agreement import FOLLOW, beside
from thermogear.analysis.any_motion import settle
from thermogear.dynamics.geared_map import GearedMap
from thermogear.study.shafts.motion import search_of

Record = dict[str, Any]

SEED = 19_2026
COUNT = 40
BEGUN = 5
"""Starts 1e-13 apart that one state is labelled from."""
STARTS = 2
"""Starts that each of these labels follows, the rule's 16 are too many for so many labels."""
MODES = 6


def labelled(number: int, begun: int = BEGUN, starts: int = STARTS) -> list[Record]:
    """Labels of train ``number`` from ``begun`` starts that differ by rounding, by the rule."""
    one = drawn(number, SEED)
    train = one.train(MODES)
    section = GearedMap(model=train.model)
    search = replace(search_of(train.model.cycle), starts=starts)
    found = []
    for start in [train.start, *beside(train.start, unit=section.unit, count=begun - 1)]:
        clock = time.process_time()
        motion = settle(section, start, search)
        found.append(
            {
                "name": motion.name,
                "reason": motion.reason,
                "mesh_periods": motion.discarded * train.model.cycle,
                "followed": motion.followed * train.model.cycle,
                "starts": motion.starts,
                "exponent": motion.lyapunov if np.isfinite(motion.lyapunov) else None,
                "seconds": time.process_time() - clock,
                "kind": one.kind,
            }
        )
    return found


def differing(names: Sequence[str]) -> bool:
    """Whether two of the labels that decide are not the same."""
    return len({name for name in names if name != "undecided"}) > 1


def complaints(records: dict[int, list[Record]]) -> list[str]:
    """What is against the rule: labels that differ, chaos that was not followed long enough."""
    found = []
    for number, labels in records.items():
        names = [label["name"] for label in labels]
        if differing(names):
            found.append(f"train {number}: {', '.join(names)}")
        short = [
            label["followed"]
            for label in labels
            if label["name"] == "chaotic" and label["followed"] < FOLLOW
        ]
        if short:
            found.append(f"train {number}: called chaotic after {min(short)} mesh periods")
    return found


def ran(folder: Path, count: int = COUNT) -> dict[int, list[Record]]:
    """Labels of every train with one thread and with two, each made in a process of its own."""
    found: dict[int, list[Record]] = {}
    folder.mkdir(parents=True, exist_ok=True)
    for threads, begun in ((1, BEGUN), (2, 1)):
        out = folder / f"threads-{threads}.jsonl"
        command = [sys.executable, "-W", "ignore", __file__, str(out), "--begun", str(begun)]
        environment = os.environ | {"OPENBLAS_NUM_THREADS": str(threads)}
        subprocess.run([*command, "--count", str(count)], env=environment, check=True)
        add(found, out)
    return found


def add(found: dict[int, list[Record]], path: Path) -> None:
    """The labels kept in a file, added to those of the same trains in ``found``."""
    for line in path.read_text("utf-8").splitlines():
        record = json.loads(line)
        found.setdefault(record["number"], []).extend(record["labels"])


def page(found: dict[int, list[Record]]) -> list[str]:
    """What the page says of them."""
    both = {number: labels for number, labels in found.items() if len(labels) > 1}
    if not both:
        return []
    names = {number: [label["name"] for label in labels] for number, labels in both.items()}
    left = sum("undecided" in own for own in names.values())
    chaotic = [x for own in both.values() for x in own if x["name"] == "chaotic"]
    least = min((label["followed"] for label in chaotic), default=0)
    wrong = complaints(both)
    kinds = Counter(own[0] for own in names.values())
    return [
        "## Threads and rounding",
        "",
        f"{len(both)} of {COUNT} other trains (seed {SEED}), each labelled with one thread of the "
        "linear algebra and",
        f"with two, and with one thread from up to {BEGUN} starts 1e-13 apart: "
        f"{sum(map(len, both.values()))} labels, {STARTS} starts each where rounding decides.",
        f"First labels: {', '.join(f'{n} {name}' for name, n in sorted(kinds.items()))}.",
        "",
        f"**{len(wrong)} of {len(both)} trains have labels that differ** or chaos followed too "
        f"shortly; {left} have an undecided one.",
        *([f"Every chaotic one was followed for {least} mesh periods or more."] * bool(chaotic)),
        *(f"- {words}" for words in wrong),
        "",
    ]


def main(words: Sequence[str]) -> None:
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("out", type=Path, help="file that a line is added to for each train")
    reader.add_argument("--begun", type=int, default=BEGUN)
    reader.add_argument("--count", type=int, default=COUNT)
    asked = reader.parse_args(words)
    done = set()
    if asked.out.exists():
        done = {json.loads(line)["number"] for line in asked.out.read_text("utf-8").splitlines()}
    for number in range(asked.count):
        if number not in done:
            record = {"number": number, "labels": labelled(number, asked.begun)}
            with asked.out.open("a", encoding="utf-8") as out:
                out.write(json.dumps(record) + "\n")
            print(number, [label["name"] for label in record["labels"]], file=sys.stderr)


if __name__ == "__main__":
    main(sys.argv[1:])
