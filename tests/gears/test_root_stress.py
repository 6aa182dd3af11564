"""Root stress: a hole in a plate, other elements, convergence, symmetry, and ISO 6336-3."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from finite_elements.elements import ReferencePatch
from thermogear.base.errors import InputError
from thermogear.gears.elements import Patch
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.iso6336 import root_factors, single_contact
from thermogear.gears.loaded import solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.root_stress import (
    COLUMNS,
    MESH,
    ROWS,
    _middle,
    root_stress,
    root_table,
    table_of,
)
from thermogear.gears.tooth import section_angle
from thermogear.gears.tooth_mesh import cells_of, halved
from thermogear.gears.tooth_table import MATES, Sector

RIG = GearPair(Gear(25, 5e-3, bore_radius=20e-3), Gear(75, 5e-3, bore_radius=60e-3))
SHIFTED = GearPair(Gear(25, 5e-3, profile_shift=0.8, bore_radius=20e-3), RIG.wheel)
THIN = GearPair(Gear(40, 5e-3), Gear(100, 5e-3, bore_radius=236.25e-3))
GEARS = (
    RIG.pinion,
    Gear(9, 2e-3, profile_shift=0.6, bore_radius=2e-3),
    Gear(14, 3e-3, tip_radius=23.5e-3, allow_undercut=True),
    Gear(40, 1e-3, pressure_angle=math.radians(28.0), profile_shift=0.4),
    THIN.wheel,
)


def flank(gear: Gear, count: int = 9) -> np.ndarray:
    tip = float(np.tan(gear.pressure_angle_at(gear.tip_radius)))
    return np.linspace(gear.junction[1], tip, count)


@pytest.mark.parametrize(("count", "error"), [(5, 0.025), (10, 0.006)])
def test_a_hole_in_a_pulled_plate_bears_three_times_the_stress(count: int, error: float) -> None:
    """Kirsch 1898: sigma_t = 1 - 2 cos(2 theta) along the hole; displacements given far off."""
    nu, far = 0.3, 4.0
    r = halved(np.geomspace(1.0, far, count + 1))[:, None]
    angle = halved(np.linspace(0.0, np.pi, 2 * count + 1))[None, :]
    nodes = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=-1).reshape(-1, 2)
    patch = Patch(nodes, cells_of(rows=count, columns=2 * count), nu)
    kappa, stiff = (3.0 - nu) / (1.0 + nu), 4.0 / (1.0 + nu)
    exact = (
        np.stack(
            [
                r * (kappa + 1.0) * np.cos(angle)
                + 2.0 / r * ((1.0 + kappa) * np.cos(angle) + np.cos(3.0 * angle))
                - 2.0 / r**3 * np.cos(3.0 * angle),
                r * (kappa - 3.0) * np.sin(angle)
                + 2.0 / r * ((1.0 - kappa) * np.sin(angle) + np.sin(3.0 * angle))
                - 2.0 / r**3 * np.sin(3.0 * angle),
            ],
            axis=-1,
        ).ravel()
        / stiff
    )
    number = np.arange(len(nodes)).reshape(2 * count + 1, -1)
    held = np.unique(np.concatenate([number[-1], number[1:, 0], number[1:, -1]]))
    known = np.sort(np.concatenate([2 * held, 2 * held + 1]))
    free = np.setdiff1d(np.arange(patch.unknowns), known)
    whole = patch.stiffness().toarray()
    u = exact.copy()
    u[free] = np.linalg.solve(whole[np.ix_(free, free)], -whole[np.ix_(free, known)] @ exact[known])
    strain, along = patch.edge_strains(number[0])
    theta = np.arctan2(along[:, 1], along[:, 0]) - 0.5 * np.pi
    law = 1.0 - 2.0 * np.cos(2.0 * theta)
    # the hole's ends at the held edges are corners
    inner = abs(np.cos(theta)) < 0.9
    assert (strain @ u)[inner] == pytest.approx(law[inner], abs=error)
    assert law.max() > 2.9


def test_a_stretch_strains_an_edge_by_its_direction() -> None:
    sector = Sector.of(RIG.pinion, 0.3, MESH, rows=ROWS, columns=COLUMNS)
    strain, along = sector.patch.edge_strains(sector.foot.fillet)
    stretch = np.array([[0.3, 0.1], [0.1, -0.2]])
    way = along / np.linalg.norm(along, axis=1)[:, None]
    wanted = np.einsum("pi,ij,pj->p", way, stretch, way)
    assert strain @ (sector.patch.nodes @ stretch).ravel() == pytest.approx(wanted, abs=1e-12)


@pytest.mark.parametrize("gear", GEARS, ids=lambda g: f"z{g.teeth}")
def test_elements_half_as_large_say_the_same(gear: Gear) -> None:
    t, nu = flank(gear)[3:], gear.material.poisson_ratio
    fine = Sector.of(gear, nu, replace(MESH, refinement=2), rows=ROWS, columns=COLUMNS)
    table, finer = root_table(gear), table_of(fine)
    wanted = finer.stress(t)
    assert table.stress(t).max(axis=-1) == pytest.approx(wanted.max(axis=-1), rel=7e-3)
    # the place: the greatest stress is a flat top
    place = table.stress(t[2]).argmax()
    near = abs(finer.slope - table.slope[place]).argmin()
    assert wanted[2, near] > 0.99 * wanted[2].max()


def test_another_library_assembles_the_same_stress() -> None:
    pytest.importorskip("skfem")
    sector = Sector.of(RIG.pinion, 0.3, MESH, rows=ROWS, columns=COLUMNS)
    other = table_of(replace(sector, patch=ReferencePatch.of(sector.patch)))
    assert other.series == pytest.approx(table_of(sector).series, abs=1e-9)


@pytest.mark.parametrize(
    ("pair", "place", "elements", "standard"),
    [(RIG, 0, 2.490, 2.502), (SHIFTED, 0, 2.085, 2.456), (THIN, 1, 2.190, 2.374)],
    ids=["25", "25 shifted", "100 on a rim of 1.5 modules"],
)
def test_elements_not_written_here_and_the_standard(
    pair: GearPair, place: int, elements: float, standard: float
) -> None:
    """sigma b m/F_n, the load at the outer point of single contact; triangles, computed apart."""
    gear, t = (pair.pinion, pair.wheel)[place], single_contact(pair)[place]
    table, (form, notch) = root_table(gear), root_factors(gear, t)
    stress = table.stress(t)
    assert stress.max() == pytest.approx(elements, rel=3e-3)
    assert 35.0 < math.degrees(table.slope[stress.argmax()]) < 45.0
    assert math.cos(gear.pressure_angle) * form * notch == pytest.approx(standard, abs=5e-4)


def own_way(gear: Gear, contact_ratio: float) -> tuple[float, float]:
    """Y_F and Y_S by the auxiliary values of ISO 6336-3, spur, without protuberance."""
    a, z, x = gear.pressure_angle, gear.teeth, gear.profile_shift
    high, rho = gear.rack.dedendum, gear.rack.fillet_radius
    e = math.pi / 4 - high * math.tan(a) - (1 - math.sin(a)) * rho / math.cos(a)
    g = rho - high + x
    h = 2 / z * (math.pi / 2 - e) - math.pi / 3
    theta = math.pi / 6
    for _ in range(60):
        theta = 2 * g / z * math.tan(theta) - h
    end = g / math.cos(theta) - rho
    chord = z * math.sin(math.pi / 3 - theta) + math.sqrt(3) * end
    curve = rho + 2 * g**2 / (math.cos(theta) * (z * math.cos(theta) ** 2 - 2 * g))
    tip, base = 2 * gear.tip_radius / gear.module, z * math.cos(a)
    way = math.sqrt(tip**2 - base**2) / 2 - math.pi * math.cos(a) * (contact_ratio - 1)
    loaded = 2 * math.hypot(way, base / 2)
    at = math.acos(base / loaded)
    inv = [math.tan(v) - v for v in (a, at)]
    half = (math.pi / 2 + 2 * math.tan(a) * x) / z + inv[0] - inv[1]
    force = at - half
    lever = (math.cos(half) - math.sin(half) * math.tan(force)) * loaded
    lever = 0.5 * (lever - z * math.cos(math.pi / 3 - theta) - end)
    form = 6 * lever * math.cos(force) / (chord**2 * math.cos(a))
    slim, notch = chord / lever, chord / (2 * curve)
    return form, (1.2 + 0.13 * slim) * notch ** (1 / (1.21 + 2.3 / slim))


@pytest.mark.parametrize("pair", [RIG, SHIFTED, THIN], ids=["rig", "shifted", "thin"])
def test_the_standards_factors_by_its_auxiliary_values(pair: GearPair) -> None:
    for gear, t in zip((pair.pinion, pair.wheel), single_contact(pair), strict=True):
        got = root_factors(gear, t)
        assert got == pytest.approx(own_way(gear, pair.contact_ratio), rel=1e-9)


def test_the_standard_is_not_asked_beyond_its_notches() -> None:
    gear = Gear(60, 5e-3, profile_shift=0.9, rack=Rack(fillet_radius=0.02))
    with pytest.raises(InputError) as caught:
        root_factors(gear, flank(gear)[-1])
    assert str(caught.value) == (
        "rack.fillet_radius: got 0.02 modules, q_s = 29.6; allowed 1 <= q_s < 8 in ISO 6336-3"
    )


def test_a_flank_steeper_than_the_section_begins_it_where_the_involute_ends() -> None:
    gear = Gear(
        82,
        3e-3,
        pressure_angle=math.radians(25.1),
        profile_shift=1.18,
        rack=Rack(dedendum=1.063, fillet_radius=0.3724),
    )
    assert section_angle(gear, math.radians(10.0)) == gear.junction[0]
    assert np.isfinite(root_table(gear).series).all()


def test_the_stress_is_that_of_the_shape_and_fades_from_tooth_to_tooth() -> None:
    small, large = Gear(31, 1e-3, profile_shift=0.2), Gear(31, 20e-3, profile_shift=0.2)
    table, t = root_table(small), flank(small)
    assert table is root_table(large)
    assert table is not root_table(small, "strain")
    own = table.stress(t).max()
    sizes = [abs(table.stress(t, lag)).max() / own for lag in range(MATES + 1)]
    assert sizes == sorted(sizes, reverse=True)
    assert 0.0 < sizes[MATES] < 0.05


def test_one_pair_alone_loads_its_own_roots() -> None:
    """Where one pair carries, the stress is that of its load; twice the load, twice the stress."""
    load, phase = np.array([5e3, 1e4]), np.linspace(0.0, 1.0, 40, endpoint=False)
    carried = (solve_mesh(RIG, load, phase).share > 0.0).sum(axis=-1)
    alone = phase[(carried == 1).all(axis=0)]
    mesh = solve_mesh(RIG, load, alone)
    place = mesh.share[0].argmax(axis=-1)
    points = (mesh.points.point.pinion, mesh.points.point.wheel)
    both = (RIG.pinion, RIG.wheel)
    for gear, got, string in zip(both, root_stress(RIG, mesh), points, strict=True):
        t = string[np.arange(alone.size), place] / gear.base_radius
        table = root_table(gear)
        wanted = table.stress(t).max() * load / (RIG.face_width * gear.module)
        assert got.stress == pytest.approx(wanted)
        at = np.unravel_index(table.stress(t).argmax(), (alone.size, table.slope.size))[1]
        # on a flat maximum the middle of the last percent lies beside its greatest element
        assert got.slope == pytest.approx([table.slope[at]] * 2, abs=math.radians(4.0))


def test_loads_shared_bear_less_and_what_did_not_settle_nothing() -> None:
    mesh = solve_mesh(RIG, 5e3, np.arange(30) / 30)
    lost = mesh._replace(settled=np.zeros_like(mesh.settled))
    for gear, got, none in zip(
        (RIG.pinion, RIG.wheel), root_stress(RIG, mesh), root_stress(RIG, lost), strict=True
    ):
        alone = root_table(gear).stress(flank(gear)[-1]).max() * 5e3
        assert 0.5 * alone < got.stress * RIG.face_width * gear.module < alone
        assert np.isnan(none.stress)


def test_a_gear_bears_the_same_driving_and_driven() -> None:
    """Without friction the mesh of exchanged gears is the same, run backwards."""
    phase = np.arange(200) / 200
    there, back = (
        root_stress(pair, solve_mesh(pair, 8e3, phase))
        for pair in (RIG, GearPair(RIG.wheel, RIG.pinion))
    )
    for gear, other in ((0, 1), (1, 0)):
        assert there[gear].stress == pytest.approx(back[other].stress, rel=4e-3)


def test_the_place_of_a_flat_maximum_does_not_jump_from_point_to_point() -> None:
    """A parabola about 37 degrees: its middle wherever the points are, and with rounding on it."""
    top = math.radians(37.0)
    for begin in np.radians(np.linspace(8.0, 11.0, 7)):
        slope = np.linspace(begin, math.radians(85.0), 18)
        stress = 2.0 - (slope - top) ** 2
        places = [_middle(stress + 1e-3 * np.sin(k * slope), slope) for k in (0, 37, 53)]
        assert places == pytest.approx([top] * 3, abs=math.radians(1.0))
