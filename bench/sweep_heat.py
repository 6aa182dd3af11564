"""Processor time of a sweep point whose temperatures are computed, old tree beside new.

Run as ``python bench/sweep_heat.py OLD/src NEW/src``: the medians [ms of user and system time a
point] are printed, and how far the stored numbers of both trees are apart, against the greatest of
their kind.
"""

from __future__ import annotations

import sys

from old_beside_new import TURNS, asked, difference, median

POINTS = 128
"""Of one chunk of a sweep."""
WORK = f"""
from thermogear.study.sweep import sweep_plan
def go(low):
    torques = np.linspace(low, 2 * low, {POINTS})
    return sweep_plan(case, {{"pinion_torque": torques}})._rows(torques[:, None], lambda *_: None)
told = dict
go(40.0)
"""


def main(trees: list[str]) -> None:
    """Print the medians and the greatest difference."""
    took: dict[str, list[float]] = {tree: [] for tree in trees}
    apart = 0.0
    for turn in range(TURNS):
        results = []
        for tree in trees:
            seconds, found = asked(tree, WORK, 50.0 + turn)
            took[tree].append(seconds)
            results.append(found)
        for found in results[1:]:
            apart = max(apart, *(difference(results[0][name], found[name]) for name in found))
    for tree, seconds in took.items():
        print(f"{median(seconds) / POINTS:8.2f} ms a point  {tree}")
    print(f"{apart:8.1e} apart at most, all numbers")


if __name__ == "__main__":
    main(sys.argv[1:])
