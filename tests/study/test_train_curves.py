"""A bifurcation of a real drive train, followed in temperature, beside points located afresh."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from tests.conftest import Compared

from thermogear.analysis.bifurcations import TORUS
from thermogear.analysis.continuation import Branch, continuation
from thermogear.analysis.event_curve import REACHED, event_curve
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.case.one_point import of_case
from thermogear.front.delivery import load_gears
from thermogear.study.shafts.branches import Trains, train_orbit

LIGHT = """
[gears]
module = "2.5 mm"
face_width = "25 mm"
[gears.pinion]
teeth = 23
[gears.wheel]
teeth = 58
[oil]
name = "ISO VG 100"
[operating]
speed = "3350 rpm"
torque = "4 N m"
[[shafts]]
gear = "pinion"
length = "85 mm"
diameter = "25 mm"
bearings = "6205"
[[shafts]]
gear = "wheel"
length = "90 mm"
diameter = "30 mm"
bearings = "6206"
"""


def test_a_torus_of_a_train_is_followed_to_the_last_temperature(
    tmp_path: Path, compared: Compared
) -> None:
    """Rolling elements that come to bear give its multipliers kinks, and the engine's leaps."""
    path = tmp_path / "light.toml"
    path.write_text(LIGHT)
    case = load_gears(str(path), ())
    first, last, far = (degrees + ZERO_CELSIUS for degrees in (60.0, 62.5, 70.0))
    drawn = np.sort(np.random.default_rng(41).uniform(first, last, 2))
    low, high = 3320.0 * RPM, 3345.0 * RPM
    trains = Trains.of(case, of_case(case), operating=None, coordinates=16)
    grid = trains.over(
        ("pinion_speed", "gear_temperature"), (np.array([low, high]), np.array([first, far]))
    )

    def located(temperature: float) -> Branch:
        orbit, _ = train_orbit(grid(high, temperature), None, 1)
        return continuation(
            orbit, "speed", low, family=lambda speed: grid(speed, temperature), start=high,
            stop_at=TORUS,
        )  # fmt: skip

    event = located(first).of_kind(TORUS)[0]
    curve = event_curve(
        event, grid, ("speed", "temperature"), start=first, asked=[*drawn, last],
        limits=(low, high),
    )  # fmt: skip
    assert curve.ended == REACHED
    assert curve.values[curve.asked, 1].tolist() == [*drawn, last]
    worst = max(
        abs(located(float(there)).of_kind(TORUS)[0].value / speed - 1.0)
        for speed, there in curve.values[curve.asked]
    )
    # where multipliers leap by 3e-4 an event is known to some 3e-6 of its speed
    compared("torus curve of a train in temperature", "located afresh", worst, 5e-6)
