"""Processor time of a warm-up from cold to steady, old tree beside new, and how far they differ.

Run as ``python bench/warm_up.py OLD/src NEW/src``: the trees take turns, five times, every time
with another torque (no earlier result is read); printed are the medians [ms of user and system
time] of one warm-up as ``answers`` asks for it (0.1 K) and as ``warmup`` does (1 mK), and the
greatest difference of a temperature from the course of the first tree at 1e-6 K.
"""

from __future__ import annotations

import os
import pickle
import statistics
import subprocess
import sys

import numpy as np

TURNS = 5
WORK = """
import pickle, sys, time, warnings
import numpy as np
import thermogear as tg
from thermogear.mesh.warm_up import Duty, warm_up
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
at, turn, tolerance = case.stated, int(sys.argv[1]), float(sys.argv[2])
def go(torque):
    duty = Duty.steady(float(at.speed[0]), torque, ambient=case.gearbox.surroundings.ambient)
    return warm_up(case.pair, duty, at.lubricant, at.half_backlash, case.models[0],
                   gearbox=case.gearbox, reference=at.temperatures.reference, housing=at.housing,
                   deviations=case.deviations, moments=40, tolerance=tolerance)
go(80.0)
begun = time.process_time()
found = go(90.0 + 4.0 * turn)
took = time.process_time() - begun
# every course lasts longer than the last moment
states = found.course.at(np.geomspace(1.0, 15e3, 200))
sys.stdout.buffer.write(pickle.dumps((took, states)))
"""


def main(trees: list[str]) -> None:
    """Print the medians and the worst differences."""

    def asked(tree: str, turn: int, tolerance: float) -> tuple[float, dict[str, np.ndarray]]:
        command = [sys.executable, "-c", WORK, str(turn), str(tolerance)]
        environment = {**os.environ, "PYTHONPATH": tree}
        raw = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
        seconds, states = pickle.loads(raw.stdout)
        return seconds, states

    for tolerance in (0.1, 1e-3):
        took: dict[str, list[float]] = {tree: [] for tree in trees}
        worst = dict.fromkeys(trees, 0.0)
        for turn in range(TURNS):
            exact = asked(trees[0], turn, 1e-6)[1]
            for tree in trees:
                seconds, states = asked(tree, turn, tolerance)
                took[tree].append(seconds)
                apart = max(float(np.abs(states[node] - exact[node]).max()) for node in exact)
                worst[tree] = max(worst[tree], apart)
        for tree in trees:
            median = 1e3 * statistics.median(took[tree])
            print(f"{tolerance:g} K: {median:8.1f} ms, off by {worst[tree]:.4f} K at most  {tree}")


if __name__ == "__main__":
    main(sys.argv[1:])
