"""Processor time of warm-ups from cold to steady, old tree beside new, and how far they differ.

Run as ``python bench/warm_up.py OLD/src NEW/src``: printed are the medians [ms of user and system
time] of one warm-up as ``answers`` asks for it (0.1 K) and as ``warmup`` does (1 mK), and of 100
warm-ups of samples of speed, torque and ambient at 0.1 K, with losses, worst moment, jams and
margins and without; and the greatest difference of a temperature from the course of the first tree
at 1e-6 K (of five of the samples, at 0.1 mK).
"""

from __future__ import annotations

import sys

import numpy as np
from old_beside_new import TURNS, asked, median

WORK = """
from thermogear.mesh.warm_up import Duty, warm_up
at = case.stated
def duties(turn, samples):
    ambient = case.gearbox.surroundings.ambient
    if samples == 1:
        return [Duty.steady(float(at.speed[0]), 90.0 + 4.0 * turn, ambient=ambient)]
    drawn = np.random.default_rng(int(turn)).uniform(-1.0, 1.0, (int(samples), 3))
    speed = float(at.speed[0])
    return [
        Duty.steady(speed * (1.0 + 0.3 * a), 100.0 + 40.0 * b, ambient=ambient + 10.0 * c)
        for a, b, c in drawn
    ]
def go(turn, tolerance, samples, first, whole):
    how = dict(
        gearbox=case.gearbox, reference=at.temperatures.reference, housing=at.housing,
        deviations=case.deviations, moments=40, tolerance=tolerance,
    )
    some = duties(turn, samples)[:int(first)]
    each = (at.lubricant, at.half_backlash, case.models[0])
    found = [warm_up(case.pair, duty, *each, **how) for duty in some]
    # a tree may compute them only now
    for one in found if whole else []:
        one.worst, one.jams, one.losses, one.margin
    return found
# every course lasts longer than the last moment
def told(found):
    return [one.course.at(np.geomspace(1.0, 15e3, 200)) for one in found[:5]]
go(-2.5, 0.1, 1, 1, 1)
"""


def main(trees: list[str]) -> None:
    """Print the medians and the worst differences."""
    for tolerance, samples, whole in ((0.1, 1, 1), (1e-3, 1, 1), (0.1, 100, 1), (0.1, 100, 0)):
        took: dict[str, list[float]] = {tree: [] for tree in trees}
        worst = dict.fromkeys(trees, 0.0)
        for turn in range(TURNS if samples == 1 else 3):
            exact = asked(trees[0], WORK, turn, 1e-6 if samples == 1 else 1e-4, samples, 5, 0)[1]
            for tree in trees:
                seconds, found = asked(tree, WORK, turn, tolerance, samples, samples, whole)
                took[tree].append(seconds)
                for states, known in zip(found, exact, strict=False):
                    apart = max(float(np.abs(states[node] - known[node]).max()) for node in known)
                    worst[tree] = max(worst[tree], apart)
        for tree in trees:
            row = f"{samples:3d} to {tolerance:g} K" + ("" if whole else ", courses alone")
            off = f"off by {worst[tree]:.4f} K at most"
            print(f"{row}: {median(took[tree]):8.1f} ms, {off}  {tree}")


if __name__ == "__main__":
    main(sys.argv[1:])
