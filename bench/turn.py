"""One drawing of flanks over a whole turn beside one ``answers`` of an old tree, processor time.

Run as ``python bench/turn.py OLD/src NEW/src``: for pairs of 28, 48, 945 and 1890 mesh periods the
medians [ms of user and system time] of the old tree's ``answers`` for the pair with flanks of class
6, and of the new tree's undeformed mesh cycle over the turn with drawn teeth (what moves the pair,
and its transmission error) with the motion from rest at the case's one speed; and their ratio.
"""

from __future__ import annotations

import sys

from old_beside_new import TURNS, asked, median

PAIRS = ((28, 28, 3.175), (16, 24, 4.5), (27, 35, 3.0), (35, 54, 3.0))
PAIR = """
def pair(turn, z1, z2, module, teeth):
    return tg.load_case(f\"\"\"
[gears]
module = "{module} mm"
face_width = "30 mm"
[gears.pinion]
teeth = {z1:.0f}
profile_shift = 0.18
[gears.wheel]
teeth = {z2:.0f}
profile_shift = 0.17
[flanks]
accuracy = 6
{teeth}
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[operating]
speed = "{2500 + 10 * turn} rpm"
torque = "{90 + turn} N m"
\"\"\")
def told(found):
    return None
"""
OLD = f"""{PAIR}
from thermogear.study.answers.survey import answers
def go(turn, *pair_of):
    answers(pair(turn, *pair_of, ""))
go(-3, 21, 43, 2.5)
"""
NEW = f"""{PAIR}
from thermogear.case.points import excitations, points_of
from thermogear.case.thermal_state import UNDEFORMED
from thermogear.mesh.excite import EXCITES
from thermogear.study.speeds import motions_of, starts_of
DRAWN = 'teeth = "drawn"'
def go(turn, *pair_of):
    drawn = pair(turn, *pair_of, DRAWN)
    cycle = UNDEFORMED.quantities(drawn, drawn.models[0], (*EXCITES, "transmission_error"))
    points = points_of(excitations(drawn, cycle))
    motions_of(points, starts_of(points)[:, :1])
go(-3, 21, 43, 2.5)
"""


def main(old: str, new: str) -> None:
    """Print the medians and their ratio."""
    for z1, z2, module in PAIRS:
        took: dict[str, list[float]] = {OLD: [], NEW: []}
        for turn in range(TURNS):
            for tree, work in ((old, OLD), (new, NEW)):
                took[work].append(asked(tree, work, turn, z1, z2, module)[0])
        answered, turned = median(took[OLD]), median(took[NEW])
        print(
            f"{z1}/{z2}: answers {answered:.0f} ms, turn {turned:.0f} ms, {turned / answered:.2f}"
        )


if __name__ == "__main__":
    main(*sys.argv[1:])
