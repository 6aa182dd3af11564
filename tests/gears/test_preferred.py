"""ISO 53 and ISO 54: racks that can be cut, modules that are only suggested."""

from __future__ import annotations

import math

import pytest

from thermogear.base.errors import InputError
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.preferred import (
    FIRST_CHOICE,
    PROFILES,
    SECOND_CHOICE,
    nearest_module,
    profile,
)


def test_profiles() -> None:
    assert profile("A") == Rack()
    for rack in PROFILES.values():
        # the largest round: within the clearance, or a full one
        sine = math.sin(math.radians(20.0))
        clearance = rack.dedendum - rack.addendum
        full = rack.largest_fillet_radius(math.radians(20.0))
        largest = clearance / (1.0 - sine) if clearance <= 0.295 else full
        assert rack.fillet_radius <= round(largest, 2)
        Gear(20, 3e-3, rack=rack)
    assert 0.25 / (1.0 - math.sin(math.radians(20.0))) == pytest.approx(0.380, abs=5e-4)
    assert PROFILES["D"].largest_fillet_radius(math.radians(20.0)) == pytest.approx(0.394, abs=5e-4)
    with pytest.raises(InputError, match=r"^profile: got 'E'; allowed A \| B \| C \| D"):
        profile("E")


def test_every_module_of_the_series_is_its_own_nearest() -> None:
    for series, sizes in (("I", FIRST_CHOICE), ("II", SECOND_CHOICE)):
        for size in sizes:
            found = nearest_module(1e-3 * size)
            assert found == (1e-3 * size, series, True)
    assert set(FIRST_CHOICE).isdisjoint(SECOND_CHOICE)


def test_a_module_between_is_told_and_not_changed() -> None:
    eight_per_inch = 25.4e-3 / 8
    found = nearest_module(eight_per_inch)
    assert found == (3e-3, "I", False)
    assert nearest_module(3.21e-3) == (3e-3, "I", False)
    assert nearest_module(3.26e-3) == (3.5e-3, "II", False)
    with pytest.raises(InputError, match=r"^module: got 3 m "):
        nearest_module(3.0)
