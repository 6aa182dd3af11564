"""Published figures beside ours: part of ``make trial NAME=anchors``."""

from __future__ import annotations

import math

import pytest
from scripts import script

from conftest import Compared

anchors = script("trials/anchors")


@pytest.mark.parametrize("group", ["elements", "three_harmonics", "contact_ratio_rule"])
@pytest.mark.filterwarnings("ignore:contact_ratio")
def test_published_figures(group: str, compared: Compared) -> None:
    rows = list(getattr(anchors, group)())
    assert [row.what for row in rows if not row.holds] == []
    strain = [row for row in rows if "stress" not in row.what]
    limit = max(abs(end) for row in strain for end in row.allowed)
    compared(strain[0].what, strain[0].source, [row.difference for row in strain], limit)


@pytest.mark.parametrize(("torque", "ratio", "jumps"), [(340.0, 0.03, True), (340.0, 0.07, False)])
def test_a_rig_that_jumps_with_little_damping(torque: float, ratio: float, jumps: bool) -> None:
    """Softening: a rising speed jumps above a falling one, below the natural frequency."""
    row = anchors.jumps(torque, ratio)
    assert row.loses == jumps
    if jumps:
        assert 0.55 < row.down < row.up < 1.0
    else:
        assert math.isnan(row.up)
        assert math.isnan(row.down)
