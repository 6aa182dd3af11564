"""Lines of a record whose speed wanders: they are read in angle, at their mean frequency."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure


@pytest.mark.parametrize("wander", [3e-4, 1e-3, 3e-3])
def test_lines_of_a_wandering_speed_are_read_in_angle(wander: float) -> None:
    rate, seconds, mesh = 25_600.0, 4.0, 1247.375
    t = np.arange(int(rate * seconds)) / rate
    slow = 2 * np.pi / seconds
    turns = mesh * (t + wander / slow * np.sin(slow * t))
    put_in = (10.0, 37.0, 48.0)
    a = sum(x * np.cos(2 * np.pi * k * turns + k) for k, x in enumerate(put_in, 1))
    a = a + np.random.default_rng(1).normal(0.0, 0.2, t.size)
    speed = 2.0 * np.pi * mesh / 25.0
    found = measure(Record((Channel("a", a, "g"),), "wander", rate, "made"), teeth=25, speed=speed)
    lines = [line for line in found.lines if line.kind == "mesh"]
    assert [line.acceleration_g for line in lines] == pytest.approx(put_in, rel=2e-3)
    assert lines[0].frequency == pytest.approx(mesh, rel=wander / 10)
    assert lines[2].order == pytest.approx(75.0, abs=1e-3)
    assert "phase_wanders" in [n.code for n in found.notices]
