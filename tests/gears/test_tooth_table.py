"""The tooth solved by finite elements: closed forms, symmetries, limits, and another assembly."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest
from scipy.sparse import csc_matrix

from thermogear.gears import tooth_table as module
from thermogear.gears.elements import Patch
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.loaded import LoadedModel, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density, foot_mesh, plain_across
from thermogear.gears.tooth_table import MATES, ToothTable, indentation, tooth_table

WHEEL = Gear(75, 5e-3, bore_radius=60e-3)
GEARS = (
    Gear(25, 5e-3, bore_radius=20e-3),
    WHEEL,
    Gear(9, 2e-3, profile_shift=0.6, bore_radius=2e-3),
    Gear(14, 3e-3, tip_radius=23.5e-3, allow_undercut=True),
    Gear(30, 3e-3, rack=Rack(fillet_radius=0.47)),
    Gear(98, 4e-3, bore_radius=185e-3),
    Gear(40, 1e-3, pressure_angle=math.radians(28.0), profile_shift=0.4),
)


def places(gear: Gear, count: int = 9) -> np.ndarray:
    tip = float(np.tan(gear.pressure_angle_at(gear.tip_radius)))
    return np.linspace(gear.junction[1], tip, count)


def whole(table: ToothTable, t: np.ndarray) -> np.ndarray:
    return np.asarray(sum(table.self_compliance(t)))


@pytest.mark.parametrize("gear", GEARS)
def test_a_patch_feels_no_rigid_motion_and_carries_a_constant_strain(gear: Gear) -> None:
    patch = foot_mesh(gear, plain_across(Density()), Density()).patch
    x, y = patch.nodes.T
    stiffness = patch.stiffness()
    for u in (np.stack([1.0 + 0 * x, 0 * x]), np.stack([-y, x])):
        assert abs(stiffness @ u.T.ravel()).max() < 1e-12 * abs(u).max() * abs(stiffness).max()
    strain, area = patch.strains()
    stretch = np.stack([0.3 * x + 0.1 * y, 0.1 * x - 0.2 * y], axis=-1)[patch.cells.reshape(-1, 9)]
    got = np.einsum("eqsu,eu->eqs", strain, stretch.reshape(len(stretch), 18))
    assert got == pytest.approx(np.broadcast_to([0.3, -0.2, 0.2], got.shape), abs=1e-10)
    polygon = np.arctan2(np.sin(math.pi / gear.teeth), 1.0)
    assert area.sum() < polygon * (gear.form_radius**2 - gear.bore_radius**2) * 1.05


def test_an_element_turned_inside_out_is_refused() -> None:
    patch = foot_mesh(WHEEL, plain_across(Density()), Density()).patch
    nodes = patch.nodes.copy()
    nodes[patch.cells[0, 0, 0]] = nodes[patch.cells[0, 2, 2]] * 1.2
    with pytest.raises(ValueError, match="inside out"):
        Patch(nodes, patch.cells, patch.poisson).stiffness()


@pytest.mark.parametrize("gear", GEARS)
def test_what_a_tooth_does_to_another_is_what_the_other_does_to_it(gear: Gear) -> None:
    """C_k(t, t') = C_-k(t', t)."""
    table, t = tooth_table(gear), places(gear)
    for lag in range(1, MATES + 1):
        there = table.coupled(t, loaded=t[::-1], lag=lag)
        assert table.coupled(t[::-1], loaded=t, lag=-lag) == pytest.approx(
            there, abs=1e-11 * there.max()
        )
    assert table.coupled(t, loaded=t, lag=MATES + 1).max() == 0.0


@pytest.mark.parametrize("bores", [(4e-3, 3e-3), (4e-3, 2.5e-3)])
def test_all_teeth_loaded_alike_turn_the_ring(bores: tuple[float, float]) -> None:
    """Sum over all teeth of C_k changes by z r_b^2 (1 + nu)/(2 pi) (1/r_x^2 - 1/r_x'^2).

    Near the base circle, where the force has no radial part that would press the ring together.
    """
    gears = [Gear(9, 2e-3, profile_shift=0.6, bore_radius=bore) for bore in bores]
    t = np.array([0.1, 0.15, 0.2])
    sums = []
    for gear in gears:
        table = tooth_table(gear)
        others = sum(table.coupled(t, loaded=t, lag=lag) for lag in range(-MATES, MATES + 1) if lag)
        sums.append(whole(table, t) + others)
    base, nu = gears[0].base_radius, gears[0].material.poisson_ratio
    turned = 9 * base**2 * (1 + nu) / (2 * math.pi) * (bores[1] ** -2 - bores[0] ** -2)
    assert sums[1] - sums[0] == pytest.approx(np.full(t.size, turned), rel=1e-3)


def test_the_table_is_that_of_the_shape() -> None:
    """Any module, load and modulus; the same gear twice is solved once."""
    small = Gear(31, 1e-3, profile_shift=0.2)
    large = Gear(31, 20e-3, profile_shift=0.2)
    assert tooth_table(small) is tooth_table(large)
    assert tooth_table(small) is not tooth_table(small, "strain")
    t = places(small)
    assert np.all(whole(tooth_table(small, "strain"), t) < whole(tooth_table(small), t))


@pytest.mark.parametrize("gear", GEARS)
def test_the_pressure_of_the_loads_leaves_nothing_behind(
    gear: Gear, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A pressure half as wide, with its own indentation taken off, gives the same compliance."""
    t = places(gear, 12)[2:-3]
    nu = gear.material.poisson_ratio
    wide = module.Sector.of(gear, nu).table()
    monkeypatch.setattr(module, "PATCH", 0.75 * module.PATCH)
    assert whole(module.Sector.of(gear, nu).table(), t) == pytest.approx(whole(wide, t), abs=0.04)


def test_indentation_of_a_deep_body_is_that_of_the_half_plane() -> None:
    """(2/pi)(ln(2 h/a) - nu/2) with h far from the surface (Johnson, section 5.6)."""
    eta, nu = 1e4, 0.3
    assert indentation(eta, poisson=nu) == pytest.approx(
        2 / math.pi * (math.log(2 * eta) - nu / 2), rel=1e-8
    )


def test_body_and_neighbours_are_those_of_the_ring() -> None:
    """The ring of the beam's model is within a tenth for a solid body, its coupling within 3 %."""
    pair = GearPair(GEARS[0], WHEEL)
    phase = np.array([0.2, 0.5, 0.9])
    stiff = [
        solve_mesh(pair, 4e3, phase, model=LoadedModel(tooth=tooth, body="bore_clamped"))
        for tooth in ("solved", "beam")
    ]
    assert stiff[0].secant == pytest.approx(stiff[1].secant, rel=0.02)
    # plane strain stiffens by less than 1 - nu^2
    strain = solve_mesh(
        pair, 4e3, phase, model=LoadedModel(tooth="solved", plane="strain", body="bore_clamped")
    )
    ratio = strain.secant / stiff[0].secant
    assert np.all((ratio > 1.02) & (ratio < 1 / (1 - 0.3**2)))


class Softer(Patch):
    """A sector whose cells above the foot have another modulus."""

    above: Patch
    part: float

    def stiffness(self) -> csc_matrix:
        return csc_matrix(super().stiffness() + (self.part - 1.0) * self.above.stiffness())


@pytest.mark.parametrize(("modulus", "apart"), [(0.98, 2e-4), (0.9, 4e-3)])
def test_a_softer_tooth_on_the_same_body(
    modulus: float, apart: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Energies of tooth and body over their moduli: exact to first order in the difference."""
    monkeypatch.setattr(module, "indentation", lambda eta, poisson: 0.5 / math.pi + 0.0 * eta)
    gear = GEARS[0]
    sector = module.Sector.of(gear, 0.3)
    split = sector.table()
    patch = Softer(sector.patch.nodes, sector.patch.cells, 0.3)
    cells = sector.patch.cells[len(sector.foot.patch.cells) :]
    object.__setattr__(patch, "above", Patch(patch.nodes, cells, 0.3))
    object.__setattr__(patch, "part", modulus)
    soft = dataclasses.replace(sector, patch=patch).table()
    t = places(gear)
    tooth, body = split.self_compliance(t)
    exact = tooth / modulus + body
    assert whole(soft, t) / exact == pytest.approx(np.ones(t.size), abs=apart)
    assert np.abs(whole(soft, t) / whole(split, t) - 1.0).min() > 3.0 * apart


def test_a_chamfered_tooth_is_one_whose_flank_ends_lower() -> None:
    """What the chamfer takes off carries nothing: the table is that of the lower tip."""
    gear = Gear(25, 5e-3)
    chamfered = dataclasses.replace(gear, tip_chamfer=0.5e-3)
    lower = dataclasses.replace(gear, tip_radius=gear.tip_radius - 0.5e-3)
    assert tooth_table(chamfered) is tooth_table(lower)
    assert tooth_table(chamfered) is not tooth_table(gear)
