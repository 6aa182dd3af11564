"""Fresh random drive trains: what share of labels is undecided, and are the others right?

``make trial NAME=train_fresh`` draws 200 trains of a seed that no rule has seen, labels each from
rest by the rule of the studies, holds 40 labels against the long independent integration of
``train_reference.py``, and writes docs/trial_train_fresh.md: each seed with its own share. What is
done is kept, so that a stopped trial goes on. ``ARGS="--seed 7"`` is a draw of one's own.
"""

from __future__ import annotations

import argparse
import json
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
from trains import CHECKED, FINER, KEPT, MODES, ROOT, Record, checked, chosen, each, kept, told

from thermogear.analysis.agreement import STARTS
from thermogear.analysis.any_motion import settle
from thermogear.dynamics.geared_map import GearedMap
from thermogear.study.shafts.motion import search_of

SEED = 66_2026
COUNT = 200
PAGE = ROOT / "docs" / "trial_train_fresh.md"


def labelled(number: int, seed: int = SEED, starts: int = STARTS) -> Record:
    """The label of a train from rest, by the rule of the studies; a torus by finer steps, too."""
    one = drawn(number, seed)
    train = one.train(MODES)
    section = GearedMap(model=train.model)
    search = replace(search_of(train.model.cycle), starts=starts)
    began = time.process_time()
    first = settle(section, train.start, search)
    found: Record = {
        "number": number,
        "kind": one.kind,
        "cycle": train.model.cycle,
        "starts": first.starts,
        "label": told(first, time.process_time() - began),
    }
    if first.name == "quasi-periodic":
        finer = GearedMap(model=train.model, how=FINER)
        found["steps"] = told(settle(finer, train.start, search), 0.0)
    return found


if __name__ == "__main__":
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--seed", type=int, default=SEED)
    reader.add_argument("--count", type=int, default=COUNT)
    reader.add_argument("--starts", type=int, default=STARTS)
    asked = reader.parse_args()
    path = KEPT / f"fresh-{asked.seed}-{asked.starts}.jsonl"
    done = kept(path)
    for n, r in each(
        "labelled",
        range(asked.count),
        done["labelled"],
        path,
        lambda n: labelled(n, asked.seed, asked.starts),
    ):
        print(
            n, r["label"]["name"], r["label"]["reason"], round(r["label"]["seconds"], 1), flush=True
        )
