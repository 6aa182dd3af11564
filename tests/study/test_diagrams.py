"""Two diagrams side by side: which bifurcation of one is which of the other."""

from __future__ import annotations

import numpy as np
import xarray as xr

from thermogear.analysis.branches import KINDS
from thermogear.study.diagrams import moved_points


def diagram(*values: float) -> xr.Dataset:
    """A diagram with flips of period 1 at ``values``."""
    count = len(values)
    return xr.Dataset(
        {
            "bifurcation_kind": ("bifurcation", np.zeros(count, int)),
            "bifurcation_period": ("bifurcation", np.ones(count, int)),
            "bifurcation_value": ("bifurcation", np.array(values)),
        }
    )


def test_points_are_matched_by_the_least_way_not_by_their_rank() -> None:
    rows = moved_points(diagram(1.2913), diagram(1.1428, 1.3042))
    assert [(row["one"], row["other"]) for row in rows] == [(None, 1.1428), (1.2913, 1.3042)]
    assert rows[1]["moved"] == 1.3042 - 1.2913
    assert rows[0]["moved"] is None
    assert {row["kind"] for row in rows} == {KINDS[0]}


def test_a_diagram_against_itself_moves_nothing() -> None:
    rows = moved_points(diagram(1.0, 2.0, 3.0), diagram(3.0, 1.0, 2.0))
    assert [row["moved"] for row in rows] == [0.0, 0.0, 0.0]


def test_diagrams_without_branches_have_no_points_that_moved():
    """A KeyError ended the command line with --against and --branch-period 0."""
    bare = xr.Dataset({"label": ("value", [1])})
    assert moved_points(bare, bare) == []
