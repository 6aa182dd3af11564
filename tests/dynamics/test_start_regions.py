"""Where a start on an edge of the dead zone goes: its velocity says it, on both sides alike."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.dynamics.exact import State


@pytest.mark.parametrize("b", [1.0, 2.5e-4])
def test_regions_of_starts_about_both_edges(b: float) -> None:
    cases = [  # x/b, velocity, region: 1 drive, 0 free, -1 back
        (1.5, -1.0, 1),
        (1.0, 1.0, 1),
        (1.0, 0.0, 0),
        (1.0, -1.0, 0),
        (0.0, 5.0, 0),
        (-1.0, 1.0, 0),
        (-1.0, 0.0, 0),
        (-1.0, -1.0, -1),
        (-1.5, 1.0, -1),
    ]
    x, v, region = (np.array(column, dtype=float) for column in zip(*cases, strict=True))
    state = State.start(x=b * x, y=v, backlash=np.full(x.size, b))
    assert state.region.tolist() == region.tolist()
    mirrored = State.start(x=-b * x, y=-v, backlash=np.full(x.size, b))
    assert mirrored.region.tolist() == (-region).tolist()
