"""What more coordinates change in a motion with impacts, and cost: ``make bench NAME=coordinates``.

``motor-train`` with 4 N m, undeformed, 1 500 mesh periods from rest, then 64 that are measured.
Periods a second are of processor time on one core.
"""

from __future__ import annotations

import resource
import time

import numpy as np

from thermogear.case.case import gear_case, load_example
from thermogear.dynamics.ladder import Engine, Steps
from thermogear.study.shafts.record import shown
from thermogear.study.shafts.waterfall import waterfall_plan

SPEEDS = (2350.0, 3143.0)
COORDINATES = (24, 31, 40, 60, 80, 100)
SETTLING, SEEN = 1500, 64


def main() -> None:
    """Print a row for each number of coordinates."""
    case = gear_case(load_example("motor-train", {"operating.torque": "4 N m"}))
    turns = np.array(SPEEDS) * np.pi / 30.0
    print("| coordinates | rpm | greatest mesh force, N | out of contact, % | periods a second |")
    print("|---|---|---|---|---|")
    for count in COORDINATES:
        train = waterfall_plan(case, turns, coordinates=count).train(0)
        if train is None:
            print(f"| {count} | | jammed | | |")
            continue
        for rpm, turn in zip(SPEEDS, turns.tolist(), strict=True):
            engine = Engine(train.at_speed(case, turn).model, Steps(accuracy=1e-7))
            begun = time.process_time()
            state = engine.run(train.start, SETTLING).state
            pace = SETTLING / (time.process_time() - begun)
            run = engine.run(state, SEEN, samples=64, turn=float(SETTLING))
            force = shown(train, run, float(SETTLING)).mesh_force.max()
            lost = 100.0 * (1.0 - run.shares[2])
            print(f"| {count} | {rpm:.0f} | {force:.1f} | {lost:.1f} | {pace:.0f} |")
    most = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    print(f"\nmemory of the whole process at most: {most:.0f} MiB")


if __name__ == "__main__":
    main()
