"""Processor time of a sweep point whose temperatures are computed, old tree beside new.

Run as ``python bench/sweep_heat.py OLD/src NEW/src``: the trees take turns, five times, every time
at other torques; the medians [ms of user and system time a point] are printed, and how far the
stored numbers of both trees are apart, against the greatest of their kind.
"""

from __future__ import annotations

import os
import pickle
import statistics
import subprocess
import sys

import numpy as np

TURNS, POINTS = 5, 64
WORK = f"""
import pickle, sys, time, warnings
import numpy as np
import thermogear as tg
from thermogear.study.sweep import sweep_plan
warnings.simplefilter("ignore")
case = tg.load_case(\"\"\"
[gears]
module = "3 mm"
[gears.pinion]
teeth = 23
face_width = "30 mm"
[gears.wheel]
teeth = 41
face_width = "28 mm"
[oil]
name = "ISO VG 220"
[backlash]
value = "0.2 mm"
direction = "normal"
extent = "total"
[operating]
speed = "1700 rpm"
torque = "100 N m"
\"\"\")
turn = int(sys.argv[1])
go = lambda low: sweep_plan(case, {{"pinion_torque": np.linspace(low, 2 * low, {POINTS})}})._rows(
    np.linspace(low, 2 * low, {POINTS})[:, None], lambda *_: None)
go(40.0)
begun = time.process_time()
found = go(50.0 + turn)
took = time.process_time() - begun
sys.stdout.buffer.write(pickle.dumps((took / {POINTS}, found)))
"""


def difference(one: np.ndarray, other: np.ndarray) -> float:
    """The greatest difference over the greatest number; infinite where other ones are finite."""
    known = np.isfinite(one)
    if not np.array_equal(known, np.isfinite(other)):
        return float("inf")
    first, second = one[known].astype(float), other[known].astype(float)
    scale = np.max(np.abs(first), initial=1e-300)
    return float(np.max(np.abs(first - second), initial=0.0) / scale)


def main(trees: list[str]) -> None:
    """Print the medians and the ratio."""
    took: dict[str, list[float]] = {tree: [] for tree in trees}
    apart = 0.0
    for turn in range(TURNS):
        results = []
        for tree in trees:
            environment = {**os.environ, "PYTHONPATH": tree}
            command = [sys.executable, "-c", WORK, str(turn)]
            raw = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
            seconds, found = pickle.loads(raw.stdout)
            took[tree].append(seconds)
            results.append(found)
        for found in results[1:]:
            apart = max(apart, *(difference(results[0][name], found[name]) for name in found))
    for tree, seconds in took.items():
        print(f"{1e3 * statistics.median(seconds):8.2f} ms a point  {tree}")
    print(f"{apart:8.1e} apart at most, all numbers")


if __name__ == "__main__":
    main(sys.argv[1:])
