"""The tip relief that evens the mesh: never worse, a true minimum, and where heat moves it."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.case.flanks import relief_text
from thermogear.gears.deviations import BasePitchDifference, Contacts, Relief, active_profile
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import loaded_contact
from thermogear.gears.pair import GearPair
from thermogear.gears.relief import ReliefDesign, optimise_tip_relief

PAIR = GearPair(
    Gear(25, 5e-3, face_width=20e-3, bore_radius=20e-3),
    Gear(75, 5e-3, face_width=20e-3, bore_radius=60e-3),
)
LOAD = 4e3


def peak(*deviations: object) -> float:
    got = loaded_contact(PAIR, LOAD, 100, deviations=deviations)  # type: ignore[arg-type]
    return float(np.ptp(got.transmission_error.to_numpy()))


@cache
def cold(shape: str = "linear") -> ReliefDesign:
    """The best relief of the pair without heat."""
    return optimise_tip_relief(PAIR, LOAD, shape=shape)


@pytest.mark.parametrize("shape", ["linear", "parabolic"])
def test_relief_removes_most_of_the_error_of_a_cold_pair(shape: str) -> None:
    design = cold(shape)
    assert design.unrelieved == pytest.approx(peak(), rel=1e-12)
    assert design.relieved == pytest.approx(peak(design.pinion, design.wheel), rel=1e-9)
    assert design.relieved < 0.2 * design.unrelieved
    # neighbours are no better: a minimum, not only an improvement
    for change in (0.9, 1.1):
        other = Relief(
            "pinion", amount=design.pinion.amount * change, length=design.pinion.length, shape=shape
        )
        assert peak(other, design.wheel) > design.relieved


def test_hot_pinion_wants_more_relief_on_its_own_tip() -> None:
    """It stands proud at its tip; relief made for the cold pair no longer fits."""
    hot = BasePitchDifference(11.5e-6 * 20.0)
    warm = optimise_tip_relief(PAIR, LOAD, deviations=[hot], evaluations=60)
    assert warm.relieved < peak(hot, cold().pinion, cold().wheel)
    assert warm.pinion.amount / warm.wheel.amount > cold().pinion.amount / cold().wheel.amount


def test_a_search_asks_what_no_relief_moves_once_for_each_set_of_phases() -> None:
    """Heat counts at the nominal point: however long the search, its gap stays as it is."""

    @dataclass(frozen=True, eq=False)
    class Counted(BasePitchDifference):
        asked: list[int]

        def gap(self, at: Contacts) -> Floats:
            self.asked.append(at.s.shape[0])
            return super().gap(at)

    hot = Counted(11.5e-6 * 20.0, [])
    design = optimise_tip_relief(
        PAIR, LOAD, deviations=[hot], positions=100, symmetric=True, evaluations=8
    )
    # without a relief, and then at all phases and at every other one
    assert hot.asked == [100, 100, 50]
    left = peak(hot, design.pinion, design.wheel)
    assert design.relieved == pytest.approx(left, rel=1e-12)


def test_a_relief_known_beforehand_is_little_better() -> None:
    """Among many minima; a simplex from four fixed places ends 11 and 20 % above it."""
    pair = GearPair(Gear(23, 3e-3, face_width=30e-3), Gear(41, 3e-3, face_width=28e-3))
    known = (
        Relief("pinion", amount=11.25e-6, length=4.046e-3),
        Relief("wheel", amount=13.21e-6, length=4.784e-3),
    )
    for load in (4000.0, 4100.0):
        scaled = [replace(r, amount=r.amount * load / 4100.0) for r in known]
        error = loaded_contact(pair, load, 100, deviations=scaled).transmission_error
        design = optimise_tip_relief(pair, load)
        assert design.relieved < 1.08 * float(np.ptp(error.to_numpy()))


def test_nothing_to_take_off_leaves_the_pair_as_it_is() -> None:
    design = optimise_tip_relief(PAIR, LOAD, largest=1e-12, evaluations=12)
    assert design.relieved <= design.unrelieved
    with pytest.raises(InputError, match=r"normal_force: got 0\.0 N; allowed > 0, finite"):
        optimise_tip_relief(PAIR, 0.0)


@pytest.mark.parametrize("shift", [0.0, 0.1])
def test_a_relief_at_the_end_of_its_range_is_one_that_a_case_takes(
    shift: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As long as the active profile, to the nanometre of a file; deflections of millimetres."""

    def at_the_end(_: object, start: Floats, **__: object) -> SimpleNamespace:
        return SimpleNamespace(x=np.ones_like(start), fun=0.0)

    screened = SimpleNamespace(population=np.ones((1, 2)), population_energies=np.zeros(1))
    monkeypatch.setattr("scipy.optimize.minimize", at_the_end)
    monkeypatch.setattr("scipy.optimize.differential_evolution", lambda *_, **__: screened)
    gears = [Gear(z, 5e-3, face_width=20e-3, profile_shift=shift) for z in (25, 41)]
    pair = GearPair(*gears)
    design = optimise_tip_relief(pair, 4e6, positions=4, symmetric=True)
    for one in (design.pinion, design.wheel):
        assert 0.99e-3 < one.amount <= 1e-3
        told = re.findall(r'"([\d.]+) ', relief_text(one.gear, one))
        read = replace(one, amount=1e-6 * float(told[0]), length=1e-3 * float(told[1]))
        start, _, tip = active_profile(pair, one.gear)
        assert read.length == pytest.approx(tip - start, abs=1.1e-9)
        assert read.taken_off(pair, np.array([tip]))[0] == pytest.approx(read.amount)
