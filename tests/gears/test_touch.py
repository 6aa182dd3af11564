"""First touch of flanks with a shape of their own, against flanks drawn as point sets."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import GeometryError
from thermogear.gears.candidates import MeshPoints, mesh_points
from thermogear.gears.corner import flank_ends, pinion_point
from thermogear.gears.deviations import (
    BasePitchDifference,
    Deviation,
    FlankShape,
    FlankTable,
    PathTable,
    PressureAngleError,
    Relief,
)
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import WavyProfile
from thermogear.gears.pair import GearPair
from thermogear.gears.touch import first_touch

RIG = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
Shape = Callable[[np.ndarray], np.ndarray]


def shape_of(pair: GearPair, devices: list[Deviation], gear: str) -> Shape:
    own = [d for d in devices if isinstance(d, FlankShape) and d.gear == gear]
    return lambda rho: np.asarray(sum((d.taken_off(pair, rho) for d in own), start=0.0 * rho))


def drawn_gap(pair: GearPair, s: float, one: Shape, two: Shape, count: int = 20_001) -> float:
    """Both flanks drawn point by point; the least turn of the wheel until they touch, times r_b2.

    The pinion stands where its flank ``one`` would meet at ``s``. Polar angles about the wheel's
    centre at equal radii: no string of the wheel is used. What is taken off turns a point about
    its own gear.
    """
    r1, r2, length = pair.pinion.base_radius, pair.wheel.base_radius, pair.line_of_action
    centre = r1 + r2 + 1j * length
    rho_2 = np.linspace(r2 * pair.wheel.junction[1], length - pair.path.a, 10 * count)
    back = length - s - two(rho_2) - rho_2
    driven = centre - (r2 + 1j * rho_2) * np.exp(1j * back / r2)
    radius, angle = np.abs(driven - centre), np.unwrap(np.angle(centre - driven))
    low, high = r1 * pair.pinion.junction[1], pair.path.e
    least = float("inf")
    for _ in range(2):  # the whole flank, then the neighbourhood of the least turn
        rho = np.linspace(low, high, count)
        driver = (r1 + 1j * rho) * np.exp(1j * (s - one(rho) - rho) / r1)
        there = np.abs(driver - centre)
        inside = (there >= radius.min()) & (there <= radius.max())
        if not inside.any():
            break
        turn = np.full(count, np.inf)
        turn[inside] = np.angle(centre - driver[inside]) - np.interp(there[inside], radius, angle)
        place = int(np.argmin(turn))
        least = r2 * float(turn[place])
        low, high = rho[max(place - 2, 0)], rho[min(place + 2, count - 1)]
    return least


def closed(pair: GearPair, s: float, gap: float) -> float:
    """Where the pinion stands when a gap is closed: at E where it stood, at A ahead by it."""
    share = np.clip((pair.path.e - s) / (pair.path.e - pair.path.a), 0.0, 1.0)
    return float(s + share * gap)


def opened(points: MeshPoints, gap: np.ndarray) -> np.ndarray:
    """Gaps that the mate closes, which beyond E is the wheel, from those that the pinion does."""
    point = points.point
    return gap - np.where(np.isfinite(point.gap), point.gap, 0.0) * (1.0 - point.lever)


def random_cases() -> list[tuple[GearPair, list[Deviation]]]:
    """Pairs and flanks drawn once, by a seed fixed before the first comparison."""
    rng = np.random.default_rng(20261122)
    found: list[tuple[GearPair, list[Deviation]]] = []
    while len(found) < 12:
        module = rng.uniform(0.5e-3, 20e-3)
        angle = np.radians(rng.uniform(14.5, 28.0))
        shifts, teeth = rng.uniform(-0.6, 0.9, 2), rng.integers(10, 150, 2)
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                pair = GearPair(
                    *(
                        Gear(int(z), module, pressure_angle=angle, profile_shift=float(x))
                        for z, x in zip(teeth, shifts, strict=True)
                    )
                )
        except GeometryError:
            continue
        active = pair.path.e - pair.path.a
        devices: list[Deviation] = []
        for gear in ("pinion", "wheel"):
            for end in ("tip", "root"):
                amount, part = module * rng.uniform(0.001, 0.012), rng.uniform(0.1, 0.6)
                shape = ("linear", "parabolic")[int(rng.integers(2))]
                devices.append(
                    Relief(gear, amount=amount, length=part * active, end=end, shape=shape)
                )
            devices.append(PressureAngleError(gear, rng.uniform(-0.005, 0.005)))
        body = pair.wheel
        radius = np.linspace(body.form_radius, body.tip_radius, 9)
        devices.append(
            FlankTable("wheel", radius=radius, added=module * rng.uniform(-2e-3, 2e-3, 9))
        )
        found.append((pair, devices))
    return found


def test_the_gap_is_the_turn_until_the_drawn_flanks_touch(compared: Compared) -> None:
    phase, worst = np.array([0.0, 0.13, 0.37, 0.52, 0.81]), 0.0
    for pair, devices in random_cases():
        one, two = (shape_of(pair, devices, gear) for gear in ("pinion", "wheel"))
        points = mesh_points(pair, phase)
        gap = opened(points, first_touch(points, devices).gap)
        drawn = np.full(gap.shape, np.inf)
        for place in zip(*np.nonzero(gap < 0.05 * pair.pinion.module), strict=True):
            stands = closed(pair, float(points.s[place]), float(gap[place]))
            drawn[place] = drawn_gap(pair, stands, one, two)
        known = np.isfinite(drawn)
        assert known.sum() > phase.size
        apart = np.abs(gap[known] - drawn[known]) / pair.pinion.module
        worst = max(worst, float(apart.max()))
    compared("gap of flanks with any shape", "flanks drawn point by point", worst, 1e-7, "modules")


def least_of_samples(pair: GearPair, s: float, gap: float, one: Shape, two: Shape) -> float:
    """Least advance that 10 001 points of the pinion's flank ask for where a gap is closed."""
    (low, high), (lowest, highest) = flank_ends(pair)
    stands = closed(pair, s, gap)
    for _ in range(3):  # the whole flank, then the neighbourhood of the least advance
        rho = np.linspace(low, high, 10_001)
        string, advance, *_ = pinion_point(pair, stands - one(rho), rho=rho)
        total = advance + one(rho) + two(string)
        total[(string < lowest * (1.0 - 1e-14)) | (string > highest * (1.0 + 1e-14))] = np.inf
        place = int(np.argmin(total))
        low, high = rho[max(place - 2, 0)], rho[min(place + 2, rho.size - 1)]
    return float(total[place])


def test_a_closed_gap_is_the_least_advance_over_all_of_the_flank(compared: Compared) -> None:
    """No valley is missed, in gaps of many times the amount too, where the pinion moves far."""
    phase, apart = np.array([0.04, 0.62, 0.9]), []
    wavy = [
        WavyProfile("pinion", slope=12e-6, form=60e-6, waves=7.3, phase=1.0),
        WavyProfile("wheel", slope=-30e-6, form=50e-6, waves=4.1, phase=2.0),
    ]
    for pair, devices in [*random_cases(), (RIG, wavy)]:
        one, two = (shape_of(pair, devices, gear) for gear in ("pinion", "wheel"))
        points = mesh_points(pair, phase)
        gap = opened(points, first_touch(points, devices).gap)
        for place in zip(*np.nonzero(gap < 0.05 * pair.pinion.module), strict=True):
            e = float(gap[place])
            apart.append(e - least_of_samples(pair, float(points.s[place]), e, one, two))
    compared("gap of flanks with any shape", "least advance of samples", apart, 1e-11, "m")


def test_steep_relief_opens_the_mesh_by_half_of_what_the_nominal_point_says(
    compared: Compared,
) -> None:
    """60 um over 6 mm on both tips: the point of contact slides off the relief."""
    devices: list[Deviation] = [
        Relief("pinion", amount=60e-6, length=6e-3),
        Relief("wheel", amount=60e-6, length=6e-3),
    ]
    points = mesh_points(RIG, np.arange(25) / 25)
    least = first_touch(points, devices).gap.min(axis=1)
    nominal = points.point.gap + sum(d.gap(points.contacts) for d in devices)
    one, two = (shape_of(RIG, devices, gear) for gear in ("pinion", "wheel"))
    drawn = [
        min(drawn_gap(RIG, closed(RIG, float(s), e), one, two) for s in row)
        for row, e in zip(points.s, least, strict=True)
    ]
    compared("unloaded error of steep relief", "drawn flanks", least - drawn, 2e-10, "m")
    assert np.ptp(least) < 0.55 * np.ptp(nominal.min(axis=1))


def test_a_shift_of_the_whole_flank_is_a_shift_of_the_gap() -> None:
    points = mesh_points(RIG, np.arange(40) / 40)
    plain = points.point.gap
    radius = [RIG.pinion.form_radius, RIG.pinion.tip_radius]
    for device in (
        PathTable(s=[0.0, 0.1], added=[60e-6] * 2),
        FlankTable("pinion", radius=radius, added=[60e-6] * 2),
    ):
        touched = first_touch(points, [device]).gap
        finite = np.isfinite(plain)
        np.testing.assert_allclose(touched[finite], plain[finite] - 60e-6, rtol=0, atol=1e-18)
        assert np.all(np.isinf(touched[~finite]))


def test_gentle_relief_touches_where_the_involutes_do() -> None:
    """The gap falls short of the nominal one by e'^2 rho*/(2 t^2), second order in the slope."""
    points = mesh_points(RIG, np.array([0.1]))
    s = float(points.s[0, 1])
    tan_1, reduced = s / RIG.pinion.base_radius, s * (1.0 - s / RIG.line_of_action)
    for error in (1e-4, 2e-4):
        device = PressureAngleError("pinion", error)
        slope = np.tan(RIG.pinion.pressure_angle) * error
        nominal = float(device.gap(points.contacts)[0, 1])
        short = nominal - float(first_touch(points, [device]).gap[0, 1])
        assert short == pytest.approx(slope**2 * reduced / (2.0 * tan_1**2), rel=0.01)


def test_exchanging_the_gears_exchanges_the_flanks() -> None:
    devices: list[Deviation] = [
        Relief("pinion", amount=40e-6, length=5e-3),
        Relief("wheel", amount=25e-6, length=7e-3, end="root", shape="parabolic"),
        PressureAngleError("pinion", 2e-3),
    ]
    other = {"pinion": "wheel", "wheel": "pinion"}
    swapped = [type(d)(**{**vars(d), "gear": other[d.gear]}) for d in devices]  # type: ignore[attr-defined]
    phase = np.linspace(0.02, 0.98, 25)
    here = mesh_points(RIG, phase)
    back = RIG.swapped()
    there = mesh_points(back, (RIG.line_of_action - here.s[:, 1] - back.path.a) / back.base_pitch)
    one, two = first_touch(here, devices), first_touch(there, swapped)
    closed_one, closed_two = opened(here, one.gap), opened(there, two.gap)
    for i in range(phase.size):
        for j, s in enumerate(here.s[i]):
            k = np.flatnonzero(np.abs(there.s[i] + s - RIG.line_of_action) < 1e-9)
            if k.size and one.gap[i, j] < 1e-4:
                assert closed_two[i, k[0]] == pytest.approx(closed_one[i, j], rel=0, abs=1e-11)
                assert two.edge[i, k[0]] == (0, 2, 1)[one.edge[i, j]]


def test_a_corner_is_told_from_a_relieved_flank() -> None:
    """Just off the path a long relief touches on its flank; a plain tooth on its corner."""
    late = (RIG.path.e - RIG.path.a) / RIG.base_pitch + np.array([0.01, 0.02]) - 1.0
    points = mesh_points(RIG, late)
    place = int(np.argmin(np.abs(points.s[0] - RIG.path.e)))
    assert np.all(first_touch(points).edge[:, place] == 2)
    relieved = first_touch(points, [Relief("pinion", amount=60e-6, length=6e-3)])
    assert not relieved.edge[:, place - 1 : place + 1].any()


def test_several_operating_points_are_each_their_own() -> None:
    radius = np.linspace(RIG.wheel.form_radius, RIG.wheel.tip_radius, 7)
    added = 1e-5 * np.array([[0, 1, 0, 2, 1, 0, -3.0], [3, 0, -1, 0, 0, 2, 0.0]])
    strain = np.array([1e-4, 3e-4])
    points = mesh_points(RIG, np.arange(16) / 16)
    both = first_touch(
        points, [FlankTable("wheel", radius=radius, added=added), BasePitchDifference(strain)]
    )
    assert both.gap.shape == both.edge.shape == (2, *points.s.shape)
    for row in range(2):
        devices = [
            FlankTable("wheel", radius=radius, added=added[row]),
            BasePitchDifference(strain[row]),
        ]
        alone = first_touch(points, devices)
        assert np.array_equal(both.gap[row], alone.gap)


def test_a_straight_flank_is_its_own_mean_and_a_corner_lies_below_it() -> None:
    """At a corner of slope k over the arc the mean is 2 k a/(3 pi), a the half width."""
    spread, active = 1.6e-5, RIG.path.e - RIG.path.a
    points = mesh_points(RIG, np.linspace(0.0, 1.0, 41))
    tilted: list[Deviation] = [PressureAngleError("pinion", 1e-3)]
    plain, mean = (first_touch(points, tilted, wide).gap for wide in (0.0, spread))
    inner = (points.s > RIG.path.a + 2e-3) & (points.s < RIG.path.e - 2e-3)
    s, base = points.s[inner], RIG.pinion.base_radius
    # a line over the string is bent over the arc by r_b^2/rho^3; x^2 has the mean a^2/4
    bent = np.tan(RIG.pinion.pressure_angle) * 1e-3 * base**2 / s**3
    square = 0.125 * spread * s * (1.0 - s / RIG.line_of_action)
    np.testing.assert_allclose(mean[inner] - plain[inner], -bent * square, rtol=0, atol=1e-8)
    relief: list[Deviation] = [Relief("pinion", amount=10e-6, length=0.5 * active)]
    corner = RIG.path.e - 0.5 * active
    at = mesh_points(RIG, [(corner - RIG.path.a) / RIG.base_pitch])
    place = np.argmin(np.abs(at.s[0] - corner))
    pressed = [first_touch(at, relief, wide).gap[0, place] for wide in (0.0, spread, 4.0 * spread)]
    half = np.sqrt(spread * corner * (1.0 - corner / RIG.line_of_action))
    slope = 10e-6 / (0.5 * active) * base / corner
    assert pressed[0] == pytest.approx(0.0, abs=1e-12)
    assert pressed[1] == pytest.approx(2.0 * slope * half / (3.0 * np.pi), rel=0.06)
    assert pressed[2] / pressed[1] == pytest.approx(2.0, rel=0.03)
