"""A series of 64 parts beside one ``answers`` of an old tree, processor time.

Run as ``python bench/series.py OLD/src NEW/src``: for pairs of 28, 40, 48, 945 and 1890 mesh
periods the medians [ms of user and system time] of the old tree's ``answers`` for the pair with
flanks of class 6, and of the new tree's 64 parts: what draws them, their loaded contact, and their
motions at 45 speeds, of 16 of them at both bounds of the damping too; and the ratio of the whole.
"""

from __future__ import annotations

import sys

from old_beside_new import TURNS, asked, median
from turn import PAIR

PAIRS = ((28, 28, 3.175), (20, 40, 3.0), (16, 24, 4.5), (27, 35, 3.0), (35, 54, 3.0))
OLD = f"""{PAIR}
from thermogear.study.answers.survey import answers
def go(turn, *pair_of):
    answers(pair(turn, *pair_of, ""))
go(-3, 21, 43, 2.5)
"""
NEW = f"""{PAIR}
from dataclasses import replace
from thermogear.case.points import excitations
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.mesh.excite import EXCITES
from thermogear.mesh.series import followed_periods, series_mesh
from thermogear.mesh.thermal import HotPair
from thermogear.study.series import series_motion, series_parts
def followed(case, point, count):
    steps = [time.process_time()]
    parts = series_parts(case, count)
    steps.append(time.process_time())
    at = replace(UNDEFORMED.operating(case, case.models[0]), housing=case.housing)
    start = np.random.default_rng(1).integers(0, 10_000, count).tolist()
    hot = HotPair(case.pair, at, case.models[0])
    mesh = series_mesh(hot, parts, followed_periods(case.pair), start=start)
    steps.append(time.process_time())
    natural = np.sqrt(mesh.stiffness.mean() / point.equivalent_mass[0])
    speeds = np.geomspace(0.1, 1.4, 45) * natural / case.pair.pinion.teeth
    series_motion(mesh, point, speeds, np.array([0.07, 0.02, 0.05]))
    steps.append(time.process_time())
    return np.diff(steps)
def go(turn, *pair_of):
    case, point = ready.pop()
    return followed(case, point, 64)
def made(turn, *pair_of):
    case = pair(turn, *pair_of, "")
    cycle = UNDEFORMED.quantities(case, case.models[0], EXCITES)
    return case, excitations(case, cycle)
def told(found):
    return found
followed(*made(-3, 21, 43, 2.5), 2)
ready = [made(*map(float, sys.argv[1:]))]
"""
STEPS = ("drawing", "contact", "motion")


def main(old: str, new: str) -> None:
    """Print the medians and their ratio."""
    for z1, z2, module in PAIRS:
        took: list[float] = []
        steps: list[list[float]] = []
        for turn in range(TURNS):
            took.append(asked(old, OLD, turn, z1, z2, module)[0])
            steps.append(asked(new, NEW, turn, z1, z2, module)[1])
        answered, whole = median(took), median([sum(one) for one in steps])
        parts = ", ".join(
            f"{name} {median(column):.0f} ms"
            for name, column in zip(STEPS, zip(*steps, strict=True), strict=True)
        )
        print(
            f"{z1}/{z2}: answers {answered:.0f} ms, 64 parts {whole:.0f} ms ({parts}), "
            f"{whole / answered:.2f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
