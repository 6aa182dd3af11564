"""One damaged tooth: limits, symmetry, energy, an edge crack in closed form, other elements."""

from __future__ import annotations

import math

import numpy as np
import pytest

from thermogear.base.errors import GeometryError, InputError
from thermogear.gears.deviations import Relief
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LoadedMesh, LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.root_stress import root_table
from thermogear.gears.tooth_damage import Chip, Crack, Damage
from thermogear.gears.tooth_table import MATES, tooth_table

PINION, WHEEL = Gear(25, 5e-3, bore_radius=20e-3), Gear(75, 5e-3, bore_radius=60e-3)
PAIR = GearPair(PINION, WHEEL)
HALF_ROOT = 5.068e-3
"""Half thickness [m] of the pinion's tooth at the 30-degree points."""
T = np.linspace(PINION.junction[1], np.tan(PINION.pressure_angle_at(PINION.tip_radius)), 7)
PHASES = np.linspace(-0.5, 2.0, 11)


def crack(percent: float, degrees: float = 45.0, gear: str = "pinion") -> Crack:
    """Of so much of the way across the pinion's tooth."""
    angle = math.radians(degrees)
    return Crack(gear, depth=percent / 100 * 2 * HALF_ROOT / math.sin(angle), angle=angle)


def added(percent: float, degrees: float = 45.0) -> np.ndarray:
    """What the crack adds to the tooth under its load at T, times E b."""
    table = crack(percent, degrees).table(PINION)
    return np.asarray(sum(table.self_compliance(T)) - sum(tooth_table(PINION).self_compliance(T)))


def meshed(damage: Damage | None, pair: GearPair = PAIR, **more: object) -> LoadedMesh:
    model = LoadedModel(tooth="solved")
    load = 2e5 * pair.face_width
    return solve_mesh(pair, load, PHASES, model=model, damage=damage, **more)  # type: ignore[arg-type]


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_no_depth_is_no_damage(gear: str) -> None:
    sound = meshed(None)
    for damage in (Crack(gear, depth=0.0), Chip(gear, height=0.0)):
        assert meshed(damage).deflection == pytest.approx(sound.deflection, rel=1e-9)


def test_compliance_grows_with_the_depth() -> None:
    rows = np.array([added(percent) for percent in (0.0, 10.0, 30.0, 50.0)])
    assert abs(rows[0]).max() < 1e-9
    assert np.all(np.diff(rows, axis=0) > 0.0)
    # farther out the arm about the crack is longer
    assert np.all(np.diff(rows[1:, 1:], axis=1) > 0.0)


def test_the_energy_a_crack_adds_is_none_or_more_and_reciprocal() -> None:
    more = (
        crack(30.0)
        .table(PINION)
        .more(np.tile(T, 2 * MATES + 1), np.repeat(np.arange(-MATES, MATES + 1), T.size))
    )
    assert more == pytest.approx(more.T, abs=1e-10 * more.max())
    assert np.linalg.eigvalsh(more).min() > -1e-9 * more.max()
    # a neighbour feels the opening, two pitches on hardly
    here, next_one = (np.diag(more)[T.size * k : T.size * (k + 1)] for k in (MATES, MATES + 1))
    assert np.all(next_one < 0.1 * here)


def test_a_short_crack_opens_less_than_in_a_half_plane() -> None:
    """E b C = 1.1215^2 pi (sigma b m/F)^2 (q/m)^2 is not reached: K = 1.1215 sigma sqrt(pi q).

    At right angles to the fillet, sigma of the sound tooth there, which falls off into the tooth.
    Source: Tada, Paris and Irwin, edge crack; dC/dq = 2 K^2/E.
    """
    depth = crack(3.0, 60.0).depth / PINION.module
    root = root_table(PINION)
    stress = root.stress(T)[:, int(np.argmin(abs(root.slope - math.radians(30.0))))]
    ratio = added(3.0, 60.0) / (1.1215**2 * math.pi * (stress * depth) ** 2)
    assert np.all((ratio > 0.4) & (ratio < 0.8))


@pytest.mark.parametrize(
    ("percent", "degrees", "mm2_per_n"),
    [
        (10, 45, 3.46),
        (30, 45, 16.9),
        (50, 45, 34.4),
        (30, 60, 13.9),
        (50, 90, 22.3),
    ],
)
def test_other_finite_elements(percent: float, degrees: float, mm2_per_n: float) -> None:
    """Added compliance [1e-6 mm^2/N] at the pitch point: a thin notch in a whole gear, 206 GPa."""
    t = math.tan(PINION.pressure_angle)
    table = crack(percent, degrees).table(PINION)
    more = sum(table.self_compliance(t)) - sum(tooth_table(PINION).self_compliance(t))
    assert 1e6 * more / 206e3 == pytest.approx(mm2_per_n, rel=0.08)


def test_a_cracked_tooth_softens_its_passage_alone() -> None:
    sound, cracked = meshed(None), meshed(crack(30.0))
    ratio = cracked.secant / sound.secant
    there = (PHASES >= 0.0) & (PHASES < 2.0)  # with the corners beyond A and E
    assert ratio[there].max() < 0.99
    assert ratio[~there] == pytest.approx(1.0, abs=0.01)
    assert 0.85 < ratio.min() < 0.95
    # on the way back the crack is shut
    assert meshed(crack(30.0), flank="back").deflection == pytest.approx(
        meshed(None, flank="back").deflection, rel=1e-12
    )
    # one turn on the same tooth enters again
    turns = [PHASES + n for n in (0, PINION.teeth)]
    model = LoadedModel(tooth="solved")
    again = [solve_mesh(PAIR, 1e4, turn, model=model, damage=crack(30.0)) for turn in turns]
    assert again[1].deflection == pytest.approx(again[0].deflection, rel=1e-9)


def test_pinion_and_wheel_change_places() -> None:
    """The same crack in the wheel of the swapped pair, passed the other way."""
    pair, swapped = GearPair(PINION, WHEEL), GearPair(WHEEL, PINION)
    model, load = LoadedModel(tooth="solved"), 1e4
    phases = np.array([0.1, 0.4, 1.2])  # no corner carries
    # the tooth's passage begins at A of one pair and ends at E of the other
    there = pair.contact_ratio - phases
    one = solve_mesh(pair, load, phases, model=model, damage=crack(30.0))
    two = solve_mesh(swapped, load, there, model=model, damage=crack(30.0, gear="wheel"))
    assert two.deflection == pytest.approx(one.deflection, rel=1e-6)


@pytest.mark.parametrize("gear", ["pinion", "wheel"])
def test_the_contact_ends_where_the_chip_begins(gear: str) -> None:
    chip = Chip(gear, height=2e-3)
    whole = PAIR.pinion if gear == "pinion" else PAIR.wheel
    end = float(whole.curvature_radius(whole.tip_radius - 2e-3))
    plain = meshed(chip)
    for mesh in (plain, meshed(chip, deviations=(Relief("pinion", amount=2e-5, length=4e-3),))):
        contacts = mesh.points.contacts
        number = contacts.pinion_tooth if gear == "pinion" else contacts.wheel_tooth
        assert contacts.string(gear)[number == 0].max() <= end * (1 + 1e-12)
        beyond = mesh.points.broken
        assert beyond is not None
        assert np.all(mesh.force[(beyond > 0) & ~np.isfinite(mesh.points.point.gap)] == 0.0)
        assert np.all(mesh.edge[(beyond > 0) & (mesh.force > 0)] == beyond.max())
    assert np.all(plain.deflection >= meshed(None).deflection * (1 - 1e-3))


def test_neighbours_of_a_chipped_tooth_feel_no_difference() -> None:
    """A load moves the next tooth as before: what is above it carries nothing."""
    chip = Chip("pinion", height=2e-3)
    short, sound = tooth_table(chip.left(PINION)), tooth_table(PINION)
    t = T[1:4]
    assert short.coupled(t, loaded=t, lag=1) == pytest.approx(
        sound.coupled(t, loaded=t, lag=1), rel=2e-3
    )


def test_refusals() -> None:
    with pytest.raises(InputError, match=r"damage\.gear: got 'rack'; allowed pinion \| wheel"):
        Crack("rack", depth=1e-3)
    with pytest.raises(
        InputError, match=r"crack\.angle: got 0\.349066 rad \(20 deg\); allowed 45\.\.90 deg"
    ):
        crack(10.0, 20.0)
    with pytest.raises(
        GeometryError, match=r"crack\.depth: got 11\.\d+ mm; allowed <= 7\.27\d* mm"
    ):
        crack(80.0).table(PINION)
    with pytest.raises(GeometryError, match=r"chip\.height: got 12 mm; allowed <= 7\.54354 mm"):
        Chip("pinion", height=12e-3).table(PINION)
    narrow = Gear(9, 3e-3, allow_undercut=True)
    with pytest.raises(GeometryError, match=r"crack\.depth: got 1\.7 mm; no sound mesh follows it"):
        Crack("pinion", depth=1.7e-3).table(narrow)
