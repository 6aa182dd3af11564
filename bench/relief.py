"""Processor time of relieved and measured flanks and of the best tip relief, old tree beside new.

Run as ``python bench/relief.py OLD/src NEW/src``: the trees take turns, five times, every time at
other loads; medians of user and system time are printed [ms a mesh of 100 positions, s a search],
with the greatest difference between the trees' transmission errors [m] and the mean and greatest
ratio of what the searches leave, last tree over first. ``search`` is that of plain flanks, ``wavy``
that of inclined and wavy ones, ``drawn`` that of pairs drawn by seed 5110, other ones every turn.
"""

from __future__ import annotations

import os
import pickle
import statistics
import subprocess
import sys

TURNS, SOLVES = 5, 20
WORK = f"""
import pickle, sys, time
import numpy as np
from thermogear.gears.deviations import FlankTable, Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.loaded import solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.relief import optimise_tip_relief
turn = int(sys.argv[1])
pair = GearPair(Gear(23, 3e-3, face_width=30e-3), Gear(41, 3e-3, face_width=28e-3))
radius = np.linspace(pair.pinion.form_radius, pair.pinion.tip_radius, 60)
trace = 1e-6 * np.random.default_rng(51).normal(size=60)
flanks = {{
    "plain": lambda k: [],
    "relieved": lambda k: [Relief(g, amount=1e-5 + 1e-8 * k, length=4e-3)
                           for g in ("pinion", "wheel")],
    "measured": lambda k: [FlankTable("pinion", radius=radius, added=trace * (1 + 0.01 * k))],
}}
took, curves = {{}}, {{}}
for name, made in flanks.items():
    mesh = lambda k: solve_mesh(pair, 4e3 + k, np.arange(100) / 100, deviations=made(k)).deflection
    mesh(-1)
    begun = time.process_time()
    curves[name] = np.array([mesh({SOLVES} * turn + k) for k in range({SOLVES})])
    took[name] = 1e3 * (time.process_time() - begun) / {SOLVES}
optimise_tip_relief(pair, 3e3, positions=10, evaluations=5)
begun = time.process_time()
left = [optimise_tip_relief(pair, 4e3 + 100.0 * turn).relieved]
took["search"] = time.process_time() - begun
waves = [WavyProfile(g, slope=5e-6, form=4e-6, waves=3.0, phase=turn + k)
         for k, g in enumerate(("pinion", "wheel"))]
begun = time.process_time()
left.append(optimise_tip_relief(pair, 4e3, deviations=waves).relieved)
took["wavy"] = time.process_time() - begun
rng = np.random.default_rng([5110, turn])
begun = time.process_time()
for shape in ("linear", "parabolic", "linear"):
    module, width = rng.uniform(1e-3, 8e-3), rng.uniform(6.0, 14.0)
    drawn = GearPair(*(Gear(int(rng.integers(22, 70)), module, face_width=width * module)
                       for _ in range(2)))
    load = rng.uniform(150e3, 600e3) * width * module
    left.append(optimise_tip_relief(drawn, load, shape=shape).relieved)
took["drawn"] = (time.process_time() - begun) / 3
sys.stdout.buffer.write(pickle.dumps((took, curves, np.array(left))))
"""


def main(trees: list[str]) -> None:
    """Print medians, differences and the ratio."""
    took: dict[str, dict[str, list[float]]] = {tree: {} for tree in trees}
    apart: dict[str, float] = {}
    ratios: list[float] = []
    for turn in range(TURNS):
        results = []
        for tree in trees:
            environment = {**os.environ, "PYTHONPATH": tree}
            command = [sys.executable, "-c", WORK, str(turn)]
            raw = subprocess.run(command, env=environment, stdout=subprocess.PIPE, check=True)
            results.append(pickle.loads(raw.stdout))
            for name, spent in results[-1][0].items():
                took[tree].setdefault(name, []).append(spent)
        (_, before, old), (_, after, new) = results[0], results[-1]
        for name, curve in before.items():
            apart[name] = max(apart.get(name, 0.0), float(abs(curve - after[name]).max()))
        ratios.extend(new / old)
    for tree, spent in took.items():
        print("  ".join(f"{name} {statistics.median(s):.3f}" for name, s in spent.items()), tree)
    print("  ".join(f"{name} within {most:.1e} m" for name, most in apart.items()))
    mean = statistics.mean(ratios)
    print(f"error left by the searches: {mean:.4f} times as a mean, at most {max(ratios):.4f}")


if __name__ == "__main__":
    main(sys.argv[1:])
