"""Random drive trains: is the label of one state the same on other threads, from starts beside it?

The order in which a library of linear algebra adds numbers changes with its threads, and with it
the last digit of a train's matrices. Each train is labelled with one thread and with two, and with
one thread from starts that differ by rounding. ``trial_trains.py`` runs this file once for each
number of threads, which must be set before numpy is loaded, and makes the page.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
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
    for start in [train.start, *beside(train.start, section.unit, begun - 1)]:
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
