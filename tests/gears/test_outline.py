"""The outline of a tooth against a caliper, a rack's envelope and the involute's own law."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import Compared
from thermogear import Gear, GearPair, Relief
from thermogear.base.errors import GeometryError
from thermogear.gears.deviations import FlankTable
from thermogear.gears.outline import Outline, outline, span_over_teeth, whole

Floats = NDArray[np.float64]


def random_gears(count: int = 24, seed: int = 7) -> list[Gear]:
    """Gears that can be made, of 7 to 150 teeth: undercut, large shift, steep angle."""
    draw, found = np.random.default_rng(seed), list[Gear]()
    fixed = [
        Gear(7, 2e-3, profile_shift=0.0, allow_undercut=True),
        Gear(9, 3e-3, profile_shift=0.2, allow_undercut=True),
        Gear(16, 4.5e-3, profile_shift=0.8635, tip_radius=44.385e-3),
        Gear(150, 1e-3, profile_shift=-0.6),
    ]
    while len(found) < count:
        try:
            found.append(
                Gear(
                    int(draw.integers(7, 151)),
                    float(draw.uniform(0.5e-3, 8e-3)),
                    pressure_angle=math.radians(float(draw.choice([14.5, 17.5, 20.0, 25.0]))),
                    profile_shift=float(draw.uniform(-0.6, 0.9)),
                    allow_undercut=True,
                )
            )
        except GeometryError:
            continue
    return fixed + found


GEARS = random_gears()


def on_flank(found: Outline, side: int) -> NDArray[np.bool_]:
    return ~np.isnan(found.string) & (np.sign(found.angle) == side)


def cutter_distance(gear: Gear, u: Floats, v: Floats) -> Floats:
    """Distance [m] of places from a tooth of the basic rack, < 0 inside it.

    ``u`` from its axis, ``v`` below the rack's reference line: two straight flanks and a flat tip,
    their corners rounded. Nothing of the package's fillet enters.
    """
    m, rack, alpha = gear.module, gear.rack, gear.pressure_angle
    rho, tip = rack.fillet_radius * m, rack.dedendum * m
    flank = (np.abs(u) - 0.25 * math.pi * m + v * math.tan(alpha)) * math.cos(alpha) + rho
    flat = v - tip + rho
    corner = 0.25 * math.pi * m - (tip - rho) * math.tan(alpha) - rho / math.cos(alpha)
    # beyond the corner of the lines that the round's centre rides on
    du, dv = np.abs(u) - corner, flat
    round_ = (du > 0.0) & (dv > 0.0) & (dv * math.cos(alpha) > du * math.sin(alpha) - 1e-300)
    along = -du * math.sin(alpha) + dv * math.cos(alpha)
    return np.where(round_ & (along > 0.0), np.hypot(du, dv), np.maximum(flank, flat)) - rho


@pytest.mark.parametrize("gear", GEARS, ids=lambda g: f"{g.teeth}x{g.profile_shift:.2f}")
def test_the_outline_is_the_envelope_of_its_rack(gear: Gear, compared: Compared) -> None:
    """Rolled over every point, the rack's tooth touches it and never goes deeper."""
    found = outline(gear)
    drive = found.angle > 1e-12
    x, y = found.points.imag[drive], found.points.real[drive]
    cut = y < gear.tip_radius * 0.999999 * np.cos(np.arctan2(x, y))
    x, y = x[cut], y[cut]
    r = gear.pitch_radius
    roll = np.linspace(-1.0, 1.0, 20001) * 20.0 / gear.teeth
    cosine, sine = np.cos(roll), np.sin(roll)
    nearest = [
        cutter_distance(
            gear,
            one * cosine + other * sine - 0.5 * math.pi * gear.module - r * roll,
            r + gear.profile_shift * gear.module - (other * cosine - one * sine),
        ).min()
        / gear.module
        for one, other in zip(x, y, strict=True)
    ]
    compared(
        "tooth outline [modules]",
        "the envelope of the rack, found by rolling it",
        nearest,
        1e-6,
    )


@pytest.mark.parametrize("gear", GEARS, ids=lambda g: f"{g.teeth}x{g.profile_shift:.2f}")
def test_span_thickness_and_normals_are_those_of_a_gear(gear: Gear, compared: Compared) -> None:
    set_back = 0.01 * gear.module
    found = outline(gear, set_back=set_back, fineness=40)
    span = span_over_teeth(gear, set_back)
    turn = 2.0 * math.pi * (span.teeth - 1) / gear.teeth
    # a caliper: two parallel jaws square to the middle of the teeth they hold
    across = 1j * np.exp(0.5j * turn)
    last = found.points[on_flank(found, 1)] * np.exp(1j * turn)
    first = found.points[on_flank(found, -1)]
    jaws = (last * np.conj(across)).real.max() - (first * np.conj(across)).real.min()
    if gear.form_radius < span.radius < gear.tip_radius:
        compared("span over teeth", "jaws laid on the outline", (jaws - span.length) / gear.module,
                 1e-6)  # fmt: skip
    flank = on_flank(found, 1)
    if gear.form_radius < gear.pitch_radius < gear.tip_radius:
        half = np.interp(gear.pitch_radius, found.radius[flank][::-1], found.angle[flank][::-1])
        thick = gear.module * (
            0.5 * math.pi + 2.0 * gear.profile_shift * math.tan(gear.pressure_angle)
        ) - 2.0 * set_back / math.cos(gear.pressure_angle)
        compared("tooth thickness on the pitch circle", "m (pi/2 + 2 x tan a)",
                 (2.0 * gear.pitch_radius * half - thick) / gear.module, 1e-6)  # fmt: skip
    points = found.points[flank]
    chord = np.diff(points)
    middle = 0.5 * (points[1:] + points[:-1])
    lever = (middle * np.conj(chord)).real / np.abs(chord)
    compared("normals of the flank", "tangent to the base circle",
             lever / gear.base_radius + np.sign(lever.mean()) * -1.0, 2e-5)  # fmt: skip


def test_a_deviation_turns_the_flank_by_what_it_takes_off() -> None:
    pair = GearPair(Gear(19, 3e-3, profile_shift=0.3), Gear(47, 3e-3))
    relief = Relief("pinion", amount=40e-6, length=3e-3)
    bump = FlankTable("wheel", radius=[0.06, 0.09], added=[25e-6, 25e-6], flank="back")
    plain, relieved = (
        outline(pair.pinion, pair=pair, deviations=one) for one in ((), (relief, bump))
    )
    moved = (plain.angle - relieved.angle) * np.sign(plain.angle) * pair.pinion.base_radius
    tip = np.argmax(np.where(on_flank(plain, 1), plain.radius, 0.0))
    assert moved[tip] == pytest.approx(40e-6, rel=1e-9)
    inner = plain.string < pair.path.e - 3e-3
    assert np.all(np.abs(moved[inner]) < 1e-15)
    first, second = (outline(pair.wheel, pair=pair, deviations=one) for one in ((), (relief, bump)))
    more = (second.angle - first.angle) * pair.wheel.base_radius
    assert np.all(np.abs(more[on_flank(first, 1)]) < 1e-15)
    assert more[on_flank(first, -1)] == pytest.approx(-25e-6, rel=1e-9)
    # the root circle keeps its place
    assert more[0] == 0.0


@pytest.mark.parametrize(("rounding", "chamfer"), [(0.6e-3, 0.0), (0.0, 0.5e-3)])
def test_an_edge_joins_flank_and_tip_circle(rounding: float, chamfer: float) -> None:
    gear = Gear(20, 4e-3, tip_rounding=rounding, tip_chamfer=chamfer)
    found = outline(gear, fineness=8)
    inside = outline(Gear(20, 4e-3), fineness=8)
    assert found.radius.max() == gear.tip_radius
    land = np.abs(found.angle[found.radius > gear.tip_radius * (1.0 - 1e-12)])
    assert 2.0 * gear.tip_radius * land.max() == pytest.approx(gear.tip_land, rel=1e-12)
    # the edge lies inside the sharp tooth and goes down to where the involute ends
    edge = (found.radius > gear.tip_form_radius) & (found.angle > land.max())
    assert np.all(found.angle[edge] < gear.half_thickness_angle(found.radius[edge]))
    assert found.radius[~np.isnan(found.string)].min() == pytest.approx(gear.form_radius)
    turn = np.angle(np.diff(found.points)[edge[:-1]])
    bend = np.abs(np.diff(turn)).max()
    assert bend < 0.1 if rounding > 0.0 else bend < 0.5
    area = [np.sum((np.conj(one.points[:-1]) * one.points[1:]).imag) for one in (found, inside)]
    assert area[0] < area[1]


def test_all_teeth_close_the_line() -> None:
    gear = Gear(23, 2e-3)
    line = whole(outline(gear).points, gear.teeth)
    assert line[0] == line[-1]
    turned = np.angle(line[1:] / line[:-1])
    assert turned.sum() == pytest.approx(2.0 * math.pi)
    assert np.abs(line).max() == pytest.approx(gear.tip_radius)
    assert np.abs(line).min() == pytest.approx(gear.root_radius)
    area = 0.5 * np.sum((np.conj(line[:-1]) * line[1:]).imag)
    assert math.pi * gear.root_radius**2 < area < math.pi * gear.tip_radius**2


def test_chords_of_a_fine_outline_stay_near_the_curve(compared: Compared) -> None:
    """What a DXF file promises: 0.3 um off, for each mm of module."""
    worst = []
    for gear in GEARS:
        points = outline(gear, fineness=10).points
        first, middle, last = points[:-2:2], points[1:-1:2], points[2::2]
        chord = (last - first) / np.maximum(np.abs(last - first), 1e-15)
        worst.append(np.abs(((middle - first) * np.conj(chord)).imag).max() / gear.module)
    compared("chords of the outline for drawing programs", "the curve between", worst, 3e-4)
