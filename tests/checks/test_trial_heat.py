"""Some of the points of ``make trial NAME=heat``: no steady state is left untold."""

import warnings

import numpy as np
from scripts import script

from thermogear.base.errors import ValidityWarning
from thermogear.case.case import gear_case, load_example


def test_both_ends_and_the_warm_up_agree_on_a_few_points() -> None:
    trial = script("trials/heat")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        rig = trial.on_the_rig(gear_case(load_example("rig")), "lambda-blend", 1, warm=True)
        pairs = trial.random_pairs("lambda-blend", 2)
    assert (rig.points, rig.settled, rig.warm_ups) == (1, 1, 1)
    assert rig.warm_up_gap < trial.SAME
    assert pairs.points == 2 * trial.POINTS
    for found in (rig, pairs):
        assert found.untold == 0
        assert found.apart < trial.SAME


def test_what_differs_and_is_not_told_is_counted() -> None:
    trial = script("trials/heat")
    found = trial.Found(several=[(4000.0, 20.0, 76.0, 90.0), (4100.0, 20.0, 77.0, np.nan)])
    row = trial.table("rig", found)
    assert row.startswith("| rig | 0 | 0 | 0.0e+00 K | 0 | 2 | 14.0 K |")
    text = trial.page([("rig", found)], 30)
    assert "| rig | 4000 | 20.0 | 76.0 | 90.0 |" in text
