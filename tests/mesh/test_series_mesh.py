"""The loaded contact of many parts at once, against each of them alone and known populations."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from thermogear import Gear, GearPair, MeshModel, Operating, Temperatures
from thermogear.base.materials import lubricant
from thermogear.gears.deviations import Deviation, PitchError, Relief
from thermogear.gears.population import drawn_pair
from thermogear.gears.turn import Eccentricity
from thermogear.mesh import series
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.series import SELDOM, followed_periods, series_mesh
from thermogear.mesh.thermal import HotPair

CURVES = ("transmission_error", "spring_error", "stiffness", "half_backlash")
EVEN = GearPair(Gear(12, 3e-3, profile_shift=0.4), Gear(18, 3e-3, profile_shift=0.2))
HUNTING = GearPair(Gear(13, 3e-3, profile_shift=0.4), Gear(19, 3e-3, profile_shift=0.2))
WARM = Temperatures(
    reference=293.15,
    pinion_addendum=350.0,
    pinion_bore=345.0,
    wheel_addendum=348.0,
    wheel_bore=344.0,
    housing=330.0,
)
COLD = Temperatures.uniform(293.15, reference=293.15)


def hot_pair(
    pair: GearPair,
    torque: float = 60.0,
    model: MeshModel | None = None,
    temperatures: Temperatures = WARM,
) -> HotPair:
    operating = Operating(
        speed=[300.0], torque=[torque], lubricant=lubricant("FVA3"), oil_temperature=333.15,
        temperatures=temperatures, half_backlash=60e-6,
    )  # fmt: skip
    return HotPair(pair, operating, model or MeshModel.consistent())


def drawn(pair: GearPair, count: int) -> list[tuple[Deviation, ...]]:
    return [drawn_pair(pair, 6, seed=5, place=place) for place in range(count)]


def mixed(pair: GearPair) -> list[Sequence[Deviation]]:
    """Parts with and without reliefs and profiles, one of them with a relief that others share."""
    relief = Relief("pinion", amount=8e-6, length=2e-3)
    errors = PitchError("wheel", tuple(3e-6 * np.sin(2.3 * np.arange(pair.wheel.teeth) ** 2)))
    first, second = drawn(pair, 2)
    return [(*first, relief), (relief, errors), second, (relief, *second), (errors,)]


@pytest.mark.parametrize("spring", ["tangent", "secant"])
def test_every_part_is_what_it_is_alone(spring: str, compared) -> None:
    hot = hot_pair(EVEN, model=MeshModel.consistent().override(spring=spring))
    parts, phase = mixed(EVEN), np.arange(16) / 16
    several = series_mesh(hot, parts, 36, positions=16)
    assert several.whole
    for place, part in enumerate(parts):
        curves, gap = elastic_pair(hot, part).over(phase), Clearance(hot, phase, part)
        alone = (*curves[2:0:-1], curves.stiffness, gap.half_backlash)
        for name, curve in zip(CURVES, alone, strict=True):
            there = np.resize(curve[0], 36 * 16)
            there = there[::SELDOM] if name == "half_backlash" else there
            there = there - there.mean() if name == "transmission_error" else there
            apart = getattr(several, name)[place] - there
            compared(name, "the part alone", apart / np.abs(curve).max(), 1e-9)


def test_no_digit_hangs_on_the_other_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    hot, parts = hot_pair(EVEN), [*mixed(EVEN), *drawn(EVEN, 5)]
    whole = series_mesh(hot, parts, 36, positions=8)
    monkeypatch.setattr(series, "BLOCK", 3 * 36 * 8)
    for some in (parts, parts[:4]):
        again = series_mesh(hot, some, 36, positions=8)
        for name in CURVES:
            assert np.array_equal(getattr(again, name), getattr(whole, name)[: len(some)])


def test_a_stretch_is_a_part_of_the_turn(compared) -> None:
    hot, parts = hot_pair(HUNTING), drawn(HUNTING, 4)
    turn, start = 13 * 19, [0, 100, 150, 230]
    whole = series_mesh(hot, parts, turn, positions=12)
    stretch = series_mesh(hot, parts, 60, positions=12, start=start)
    assert (whole.whole, stretch.whole) == (True, False)
    ahead = stretch.stiffness.shape[1] // 12 - 60
    assert ahead == stretch.ahead
    for place, first in enumerate(start):
        period = (np.arange(first - ahead, first + 60) % turn)[:, None]
        at = (12 * period + np.arange(12)).ravel()
        k = stretch.stiffness[place] / whole.stiffness[place, at] - 1.0
        compared("stiffness of a stretch", "that of the whole turn", k, 1e-9)
        seen = at[12 * ahead :]
        for name, at in zip(CURVES[::3], (seen, seen[::SELDOM] // SELDOM), strict=True):
            apart = np.ptp(getattr(stretch, name)[place] - getattr(whole, name)[place, at])
            compared(f"{name} of a stretch", "that of the whole turn", apart, 1e-14, "m")


def test_the_error_of_the_turn_follows_from_a_stretch_of_it(compared) -> None:
    hot, parts = hot_pair(HUNTING, 300.0), drawn(HUNTING, 6)
    whole = series_mesh(hot, parts, 13 * 19, positions=12)
    stretch = series_mesh(hot, parts, 60, positions=12, start=range(0, 240, 40))
    assert np.array_equal(whole.peak_to_peak, np.ptp(whole.transmission_error, axis=1))
    seen = np.ptp(stretch.transmission_error, axis=1) / whole.peak_to_peak
    assert seen.min() < 0.95
    compared("error of the turn from 60 of 247 periods", "the whole turn",
             stretch.peak_to_peak / whole.peak_to_peak - 1.0, 0.01)  # fmt: skip
    # of too short a stretch nothing is said
    assert np.isnan(replace(stretch, transmission_error=stretch.transmission_error[:, :240],
                            mesh_periods=20).peak_to_peak).all()  # fmt: skip


def test_eccentric_gears_of_every_turn_add_up(compared) -> None:
    """Where z1 and z2 have no divisor in common the swing is 2 (e1 + e2), whatever their angles."""
    rng = np.random.default_rng(3)
    parts = [
        [Eccentricity(gear, amount=e, angle=angle)
         for gear, e, angle in zip(("pinion", "wheel"), rng.rayleigh(5e-6, 2), rng.uniform(0, 6, 2),
                                   strict=True)]
        for _ in range(8)
    ]  # fmt: skip
    amounts = np.array([sum(one.amount for one in part) for part in parts])
    hot = hot_pair(HUNTING, 1e-3, temperatures=COLD)
    swing = series_mesh(hot, parts, 60, positions=16).peak_to_peak
    # what tip corners add at next to no load is on top
    compared("swing of two eccentric gears", "2 (e1 + e2)", swing / (2.0 * amounts) - 1.0, 4e-3)


def test_a_known_population_has_its_quantiles() -> None:
    """Equal gears, coordinates of both centres N(0, 5 um): a Rayleigh swing of median 16.65 um."""
    pair = GearPair(Gear(14, 3e-3, profile_shift=0.3), Gear(14, 3e-3, profile_shift=0.3))
    xy = np.random.default_rng(15).normal(0.0, 5e-6, (64, 2, 2)) @ [1.0, 1j]
    parts = [
        [Eccentricity(gear, amount=abs(z), angle=float(np.angle(z)))
         for gear, z in zip(("pinion", "wheel"), row, strict=True)]
        for row in xy
    ]  # fmt: skip
    hot = hot_pair(pair, 1e-3, temperatures=COLD)
    swing = 1e6 * series_mesh(hot, parts, 14, positions=12).peak_to_peak
    assert np.median(swing) == pytest.approx(16.651, abs=4 * 0.9)
    # of 64 the greatest bounds the 95 % quantile in 96 of 100 series
    assert swing.max() > 34.6


def test_how_much_of_a_turn_is_followed() -> None:
    assert [followed_periods(pair) for pair in (EVEN, HUNTING)] == [36, 140]
    assert followed_periods(GearPair(Gear(20, 3e-3), Gear(151, 3e-3))) == 171


def test_textbook_springs_feel_no_deviation() -> None:
    pair = GearPair(Gear(30, 3e-3), Gear(30, 3e-3))
    hot = hot_pair(pair, model=MeshModel.consistent().override(stiffness="textbook-root-circle"))
    mesh = series_mesh(hot, drawn(pair, 2), 30, positions=8)
    assert np.array_equal(mesh.stiffness[0], mesh.stiffness[1])
    gap = Clearance(hot, np.arange(8) / 8, drawn(pair, 2)[1])
    assert mesh.spring_error[1] == pytest.approx(gap.error[0], abs=1e-15)
