"""Wear of flanks by hand; what pockets refuse."""

from __future__ import annotations

import numpy as np
import pytest

from thermogear.base.errors import GeometryError, InputError
from thermogear.gears.contact import rolling_velocities
from thermogear.gears.flank_damage import Pocket, Spall, spalled, wear_work, worn
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

PAIR = GearPair(Gear(23, 3e-3, face_width=20e-3), Gear(47, 3e-3, face_width=20e-3))
EQUAL = GearPair(Gear(30, 3e-3, face_width=20e-3), Gear(30, 3e-3, face_width=20e-3))


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_wear_is_the_pressure_along_the_way_slid(gear: str) -> None:
    """Pressure of Hertz's ellipse, summed while the contact passes a point of the flank."""
    force, k, meshes = 100.0, 1e-17, 1e6  # so light that no edge of a tip takes load
    radius, added = (np.asarray(x) for x in wear_work(PAIR, gear, force))
    string = np.sqrt(radius**2 - PAIR.gear(gear).base_radius ** 2)
    s = string if gear == "pinion" else PAIR.line_of_action - string
    first, last = PAIR.path.e - PAIR.base_pitch, PAIR.path.a + PAIR.base_pitch
    alone = (s > first + 0.4e-3) & (s < last - 0.4e-3)
    v = rolling_velocities(PAIR, 100.0, s[alone])
    own, mate = v if gear == "pinion" else v[::-1]
    half = 0.2e-3
    x = np.linspace(-half, half, 20001)
    pressure = 2.0 * force / PAIR.face_width / (np.pi * half) * np.sqrt(1.0 - (x / half) ** 2)
    seconds = (x[1] - x[0]) / own
    slid = np.abs(own - mate) * seconds
    by_hand = k * pressure.sum() * slid * meshes
    table = worn(PAIR, gear, force, coefficient=k, meshes=meshes)
    assert -np.asarray(table.added)[alone] == pytest.approx(by_hand, rel=1e-4)
    assert added[np.argmin(abs(s - PAIR.path.c))] < 0.05 * added.max()


def test_wear_is_proportional_and_of_equal_gears_the_same() -> None:
    once, ten = (
        np.asarray(worn(EQUAL, "pinion", 3e3, coefficient=1e-17, meshes=n).added)
        for n in (1e6, 1e7)
    )
    assert ten == pytest.approx(10.0 * once, rel=1e-12)
    wheel = np.asarray(worn(EQUAL, "wheel", 3e3, coefficient=1e-17, meshes=1e6).added)
    at, along = (wear_work(EQUAL, name, 3e3)[0] for name in ("wheel", "pinion"))
    middle = abs(at - EQUAL.pinion.pitch_radius) < 0.4e-3  # between the jumps of the share
    assert wheel[middle] == pytest.approx(
        np.interp(at, along, once)[middle], abs=0.02 * abs(once).max()
    )
    stated = np.asarray(worn(EQUAL, "wheel", 3e3, depth=8e-6).added)
    assert stated.min() == pytest.approx(-8e-6, rel=1e-12)
    assert stated / stated.min() == pytest.approx(wheel / wheel.min(), rel=1e-9)


def test_the_arc_of_a_pocket() -> None:
    """Arc of the involute between its rims, summed along the curve."""
    low, high = spalled(PAIR, "pinion", radius=34.5e-3, length=2e-3)
    roll = np.linspace(low, high, 20001) / PAIR.pinion.base_radius
    curve = PAIR.pinion.base_radius * (1.0 - 1j * roll) * np.exp(1j * roll)
    assert np.abs(np.diff(curve)).sum() == pytest.approx(2e-3, rel=1e-6)
    pocket = Pocket("pinion", radius=34.5e-3, length=2e-3, depth=50e-6)
    assert pocket.taken_off(PAIR, np.array([low, high])) == pytest.approx(0.0, abs=1e-12)


def test_refusals() -> None:
    with pytest.raises(GeometryError, match=r"spall\.radius: got 50 mm; allowed 32\.\d+ mm\.\."):
        spalled(PAIR, "pinion", radius=50e-3, length=1e-3)
    with pytest.raises(InputError, match=r"spall\.width_share: got 0\.95; allowed 0\.\.0\.9"):
        Spall("pinion", radius=34.5e-3, length=1e-3, width_share=0.95)
