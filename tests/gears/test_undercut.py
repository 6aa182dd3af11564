"""Undercut: what a rack cuts away, point by point, against what pairs are refused and why."""

from __future__ import annotations

import math
import re
import warnings

import numpy as np
import pytest

from thermogear.base.errors import GeometryError, ValidityWarning
from thermogear.gears.corner import contact_point, flank_ends, pinion_point, wheel_point
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.pair import GearPair, tight_distance

MODULE = 3e-3
RACKS = {
    "ISO 53 A": (20.0, Rack()),
    "ISO 53 C": (20.0, Rack(fillet_radius=0.25)),
    "ISO 53 D": (20.0, Rack(dedendum=1.4, fillet_radius=0.39)),
    "14.5 deg": (14.5, Rack(dedendum=1.157, fillet_radius=0.209)),
    "25 deg": (25.0, Rack(fillet_radius=0.3)),
    "stub": (20.0, Rack(addendum=0.8, dedendum=1.0, fillet_radius=0.3)),
    "DIN 58400": (20.0, Rack(addendum=1.1, dedendum=1.6, fillet_radius=0.05)),
}


def cut_away(gear: Gear, radius: float, half: float) -> float:
    """How deep [m] the cutting rack goes into the point at ``radius`` and the angle ``half``.

    The rack rolls on the pitch circle; its tooth is the next space of the basic rack, straight
    flanks down to where the round of its tip begins. < 0: the point is left standing.
    """
    m, rack, alpha = gear.module, gear.rack, gear.pressure_angle
    depth, rho = rack.dedendum * m, rack.fillet_radius * m
    roll = np.linspace(-1.2, 1.2, 24001)
    r = 0.5 * m * gear.teeth
    x, y = radius * np.sin(half + roll), radius * np.cos(half + roll)
    below = r + gear.profile_shift * m - y
    centre = 0.25 * math.pi * m - (depth - rho) * math.tan(alpha) - rho / math.cos(alpha)
    round_ = rho**2 - (below - (depth - rho)) ** 2
    straight = 0.25 * math.pi * m - below * math.tan(alpha)
    tip = np.where(round_ > 0.0, centre + np.sqrt(np.maximum(round_, 0.0)), -1.0)
    width = np.where(below <= depth - rho * (1.0 - math.sin(alpha)), straight, tip)
    return float(np.max(width - np.abs(x - (r * roll + 0.5 * math.pi * m))))


def gear(teeth: int, rack: str, **more: object) -> Gear:
    angle, basic = RACKS[rack]
    return Gear(teeth, MODULE, pressure_angle=math.radians(angle), rack=basic, **more)  # type: ignore[arg-type]


def paired(first: Gear, second: Gear) -> GearPair:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ValidityWarning)
        return GearPair(first, second)


@pytest.mark.parametrize("rack", RACKS)
def test_pairs_are_refused_where_the_rack_cuts_the_flank_in_use_and_only_there(rack: str) -> None:
    """The flank in use begins where the other tip first touches; the cutter is ours, by points."""
    taken = refused = 0
    for first in (10, 12, 14, 16, 17, 20, 24, 26, 28, 31):
        for second in (first, 32, 60, 200):
            one, other = gear(first, rack), gear(second, rack)
            if second < first or not one.undercut:
                continue
            # by the triangle of the base circles, without the pair
            base, apart = one.base_radius + other.base_radius, one.pitch_radius + other.pitch_radius
            start = math.sqrt(apart**2 - base**2)
            start -= math.sqrt(other.tip_radius**2 - other.base_radius**2)
            radius = math.hypot(one.base_radius, start)
            deep = math.inf
            if start > 0.0:
                deep = cut_away(one, radius, float(one.half_thickness_angle(radius)))
            if deep > 1e-8 * MODULE:
                with pytest.raises(GeometryError, match=r"profile_shift: .* or allow_undercut "):
                    paired(one, other)
                refused += 1
            else:
                assert paired(one, other).path.a == pytest.approx(start, rel=1e-12)
                taken += 1
    assert taken > 0
    assert refused > 5 or rack in ("25 deg", "stub")


def refused_for(first: Gear, second: Gear) -> str:
    """The field and the message of a pair that is refused; empty where it meshes."""
    try:
        paired(first, second)
    except GeometryError as error:
        return f"{error.field}: {error}"
    return ""


@pytest.mark.parametrize("rack", RACKS)
def test_the_shift_and_the_teeth_of_the_message_are_the_least_that_mesh(rack: str) -> None:
    told = 0
    for first, second in ((10, 32), (12, 200), (14, 40), (16, 60), (20, 30)):
        other = gear(second, rack)
        refused = refused_for(gear(first, rack), other)
        shift = re.search(r"use x >= ([0-9.]+) or", refused)
        teeth = re.search(r">= (\d+) teeth, where", refused)
        for x in [float(shift[1])] if shift else ():
            # the mate may be cut too, and is named then
            taken, less = (
                gear(first, rack, profile_shift=x),
                gear(first, rack, profile_shift=x - 0.01),
            )
            assert "pinion.profile_shift" not in refused_for(taken, other)
            assert "pinion.profile_shift" in refused_for(less, other)
        for z in [int(teeth[1])] if teeth else ():
            assert "pinion.profile_shift" not in refused_for(gear(z, rack), other)
            assert "pinion.profile_shift" in refused_for(gear(z - 1, rack), other)
        told += bool(shift) + bool(teeth)
    assert told > 2 or rack in ("25 deg", "stub")


def test_standard_gears_with_a_cut_below_the_flank_in_use_mesh() -> None:
    """17 teeth at 20 deg: 27 um of involute are left below the flank in use; 26 at 14.5 deg."""
    pair = GearPair(Gear(17, MODULE), Gear(40, MODULE))
    assert pair.pinion.undercut
    assert 1e6 * (pair.start_radii[0] - pair.pinion.form_radius) == pytest.approx(26.79, abs=0.01)
    assert not pair.cut_short
    steep = [Gear(26, MODULE, pressure_angle=math.radians(14.5)) for _ in range(2)]
    assert GearPair(*steep).pinion.undercut


@pytest.mark.parametrize(
    ("rack", "first", "second"),
    [
        ("ISO 53 A", 13, 24),
        ("ISO 53 A", 14, 14),
        ("ISO 53 A", 16, 200),
        ("ISO 53 D", 15, 40),
        ("14.5 deg", 24, 40),
        ("DIN 58400", 16, 30),
    ],
)
def test_on_request_contact_begins_where_the_undercut_ends(
    rack: str, first: int, second: int
) -> None:
    one, other = (gear(z, rack, allow_undercut=True) for z in (first, second))
    pair = paired(one, other)
    assert pair.cut_short
    assert pair.start_radii[0] == pytest.approx(one.form_radius, rel=1e-14)
    # the involute stands from there on and is gone below
    for by, stands in ((1.0 + 1e-6, True), (1.0 - 1e-4, False)):
        radius = by * one.form_radius
        deep = cut_away(one, radius, float(one.half_thickness_angle(radius)))
        assert (deep < 1e-8 * MODULE) == stands
    with pytest.raises(GeometryError, match="allow_undercut"):
        GearPair(gear(first, rack), gear(second, rack))
    turned = paired(other, one)
    assert turned.path.e == pytest.approx(pair.line_of_action - pair.path.a, rel=1e-12)
    assert turned.contact_ratio == pytest.approx(pair.contact_ratio, rel=1e-12)


def test_where_undercut_leaves_too_little_of_the_path_the_shift_is_named() -> None:
    eight = Gear(8, MODULE, allow_undercut=True)
    with pytest.raises(GeometryError) as caught:
        GearPair(eight, Gear(40, MODULE))
    assert str(caught.value) == (
        "contact_ratio: got 0.9128; allowed >= 1; the next pair enters after the last one has "
        "left; lengthen the teeth, take more teeth or a smaller centre distance, or raise the "
        "profile shift of undercut ones"
    )


def deepest(one: Gear, other: Gear) -> float:
    """How far [m] the tip corner of ``other`` goes into what the rack left of ``one``, at most.

    Both roll without backlash, a tooth in a space on the line of centres; places by plane polars.
    """
    apart, tip = tight_distance(one, other), other.tip_radius
    half = float(other.half_thickness_angle(tip))
    far = math.acos(min(1.0, (apart**2 + tip**2 - one.tip_radius**2) / (2.0 * apart * tip)))
    found = []
    for turn in far * np.linspace(-1.0, 1.0, 41):
        x, y = tip * math.sin(turn + half), apart - tip * math.cos(turn + half)
        around = math.atan2(x, y) - turn * other.teeth / one.teeth
        if math.hypot(x, y) < one.form_radius:
            found.append(-cut_away(one, math.hypot(x, y), math.pi / one.teeth - around))
    return max(found)


def test_on_request_a_tip_is_refused_where_it_cuts_into_the_tooth_and_only_there() -> None:
    """Racks of any height, round and clearance, wheels of any shift: our cutter decides."""
    draw = np.random.default_rng(4)
    counts = {True: 0, False: 0}
    while min(counts.values()) < 6:
        height, room, round_ = draw.uniform([0.5, 0.05, 0.0], [1.3, 0.5, 0.6])
        angle, shifts = math.radians(draw.uniform(14.5, 25.0)), draw.uniform(-0.5, 0.5, 2)
        teeth = int(draw.integers(6, 26)), int(draw.integers(20, 150))
        rack = Rack(addendum=height, dedendum=height + room, fillet_radius=round_)
        more = {"pressure_angle": angle, "rack": rack, "allow_undercut": True}
        try:
            one, other = (
                Gear(z, MODULE, profile_shift=x, **more)  # type: ignore[arg-type]
                for z, x in zip(teeth, shifts, strict=True)
            )
        except GeometryError:
            continue
        try:
            why = "" if paired(one, other).cut_short else "not cut short"
        except GeometryError as error:
            why = str(error)
        if one.undercut and (not why or "reaches below the pinion's" in why):
            goes_in = deepest(one, other) > 1e-4 * MODULE
            assert goes_in == bool(why), (teeth, shifts, rack)
            counts[goes_in] += 1


def test_a_fillet_that_is_too_round_by_its_last_digit_is_the_full_round() -> None:
    """25 deg: the full round is 0.317883 modules."""
    full = Rack(fillet_radius=0.0).largest_fillet_radius(math.radians(25.0))
    made = Gear(25, MODULE, pressure_angle=math.radians(25.0), rack=Rack(fillet_radius=0.318))
    assert made.rack.fillet_radius == full
    assert gear(25, "ISO 53 D", profile_shift=0.1).rack.fillet_radius == 0.39
    printed = Rack(dedendum=1.4, fillet_radius=0.394)
    assert Gear(25, MODULE, rack=printed).rack.fillet_radius == pytest.approx(0.39394, abs=1e-6)
    with pytest.raises(GeometryError, match=r"^rack.fillet_radius: got 0.319 modules; allowed <= "):
        Gear(25, MODULE, pressure_angle=math.radians(25.0), rack=Rack(fillet_radius=0.319))
    with pytest.raises(GeometryError, match=r"^rack.fillet_radius: got 0.31789 modules"):
        Gear(25, MODULE, pressure_angle=math.radians(25.0), rack=Rack(fillet_radius=0.31789))


@pytest.mark.parametrize(("first", "second"), [(13, 24), (14, 14), (30, 60)])
def test_off_the_path_the_gap_is_the_least_advance_of_any_point_of_the_flank(
    first: int, second: int
) -> None:
    """The edge of undercut or a tip corner: whichever of all points of both flanks is nearest."""
    for one, other in ((first, second), (second, first)):
        pair = paired(*(Gear(z, MODULE, allow_undercut=True) for z in (one, other)))
        (low, high), (lowest, highest) = flank_ends(pair)
        for s in (pair.path.a - 0.05 * MODULE, pair.path.e + 0.05 * MODULE):
            found = []
            # which of the gears advances changes the gap by the second order
            for corner, own, mate in (
                (pinion_point, (low, high), (lowest, highest)),
                (wheel_point, (lowest, highest), (low, high)),
            ):
                string, advance, *_ = corner(pair, s, rho=np.linspace(*own, 100001))
                found.append(float(np.min(advance[(string >= mate[0]) & (string <= mate[1])])))
            met = contact_point(pair, s)
            assert float(met.gap * met.lever) == pytest.approx(min(found), rel=0.01)
