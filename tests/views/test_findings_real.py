"""The sentence of a page on what was found, on gears: two cases with two outcomes each."""

from __future__ import annotations

import re

import numpy as np
import pytest
import xarray as xr

import thermogear as tg
from thermogear.base.units import RPM
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.views.pages.findings import SAME, finding

pytestmark = [
    pytest.mark.slow,
    pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning"),
]
PAIR = """
[gears]
module = "2.5 mm"
face_width = "28 mm"
[gears.pinion]
teeth = 19
[gears.wheel]
teeth = 53
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[temperatures]
pinion_addendum = "90 degC"
wheel_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_bore = "80 degC"
housing = "60 degC"
[flanks]
accuracy = 6
parts = 16
[operating]
speed = "2400 rpm"
torque = "60 N m"
[grid]
path_positions = 41
mesh_positions = 48
harmonics = 12
"""


@pytest.fixture(scope="module")
def pair() -> GearCase:
    return gear_case(load_case(PAIR))


def apart(data: xr.Dataset) -> np.ndarray:
    """Speeds [rpm] at which the error up and down differs by more than 1 um, by the stored data."""
    error = data["dte_peak_to_peak"]
    up, down = (error.isel(direction=i) for i in (0, 1))
    differs = (np.abs(up - down) > 1e-6).any("state").values
    return np.asarray(data["pinion_speed"].values[differs] / RPM)


def test_a_run_up_says_where_up_and_down_differ(pair: GearCase) -> None:
    """Of two ranges one has two motions and the other one: both sentences are there."""
    found = []
    for speeds in ([3000.0, 4000.0, 5000.0], np.linspace(8800.0, 10200.0, 8)):
        data = tg.run_up(pair, np.array(speeds) * RPM, branch_period=0).data
        said, differing = finding(data), apart(data)
        found.append(differing.size)
        if not differing.size:
            assert SAME in said
            continue
        named = [float(n) for n in re.findall(r"\d+(?:\.\d+)?", said.partition(";")[0])]
        assert min(named) == pytest.approx(differing.min(), abs=0.01)
        assert max(named) == pytest.approx(differing.max(), abs=0.01)
    assert found[0] == 0
    assert found[1] > 1


@pytest.mark.parametrize("torques", [[20.0, 60.0], [1.0, 2.0]])
def test_a_sweep_names_the_greatest_dynamic_factor(pair: GearCase, torques: list[float]) -> None:
    speeds = np.array([2400.0, 6000.0, 11000.0]) * RPM
    data = tg.sweep(pair, {"speed": speeds, "torque": torques}).data
    said = finding(data)
    values = data["dynamic_factor"]
    place = values.argmax(...)  # type: ignore[arg-type]
    at = data.isel({str(k): int(v) for k, v in place.items()})
    assert f"{float(at['pinion_speed']) / RPM:.0f} rpm" in said
    assert f"{float(at['pinion_torque']):g} N m" in said
    top = re.search(r"dynamic factor is ([\d.]+)", said)
    assert top
    assert float(top[1]) == pytest.approx(float(values.max()), rel=5e-3)
    kinds = {int(n) for n in data["label"].values.ravel()}
    assert len(re.findall(r"[a-z0-9, ]+ at \d+", said.partition(";")[0])) >= len(kinds) - 1
