"""Models beside finite elements: published table, own pairs, thermal growth."""

from __future__ import annotations

import numpy as np
import pytest

from checked_pairs import CheckedPair, far_pairs, own_pairs, published_pair, root_pairs
from conftest import Compared
from finite_elements import Density, check_stiffness, inner_phases, pair_stiffness
from finite_elements.sector import FlankSector
from finite_growth import finite_flank_growth, flank_radii
from gear_compliance import gear_compliance
from thermogear.base.errors import InputError
from thermogear.gears.deviations import GEARS
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.iso6336 import single_contact
from thermogear.gears.mesh_system import LoadedModel
from thermogear.gears.pair import GearPair
from thermogear.gears.root_stress import root_table
from thermogear.heat.expansion import RadialField, flank_growth

pytestmark = pytest.mark.slow

PUBLISHED = published_pair()
FORCE = PUBLISHED.line_load * PUBLISHED.pair.face_width


def test_published_table_of_finite_elements(compared: Compared) -> None:
    """Secant stiffness and shares printed for m 5, 25/75 at 200 N/mm: met within 0.4 %."""
    phase = np.array([0.030, 0.245, 0.460, 0.674, 0.724, 0.857, 0.990])
    got = pair_stiffness(PUBLISHED.pair, FORCE, phase)
    printed = np.array([15.09, 15.41, 15.42, 15.13, 11.13, 11.26, 11.26])
    compared(
        "own finite elements, secant stiffness",
        "finite elements computed apart",
        got.secant / 20e-3 / 1e9 / printed - 1.0,
        4e-3,
    )
    assert got.share[:4, 1] == pytest.approx([0.401, 0.457, 0.516, 0.580], abs=3e-3)
    # a pressure beside the nominal point has a lever a little off the base radius
    assert np.allclose(got.share.sum(axis=-1), 1.0, rtol=0, atol=3e-4)
    assert np.all(got.share[4:, 2] == 0.0)


# the plane state varies fastest: one pair's elements are solved once for both
@pytest.mark.parametrize(("near", "limit"), [("strain", 0.01), ("stress", 0.035)])
@pytest.mark.parametrize("checked", [PUBLISHED, *own_pairs()], ids=lambda c: c.name)
def test_own_pairs_within_three_per_cent(
    checked: CheckedPair, near: str, limit: float, compared: Compared
) -> None:
    force = checked.line_load * checked.pair.face_width
    got = check_stiffness(checked.pair, force, near=near)
    compared(
        f"loaded contact over the mesh, five pairs, plane {near} near the contact",
        "own finite elements of whole gears",
        got.difference,
        limit,
    )
    compared(
        "shares of the load, five pairs",
        "own finite elements of whole gears",
        got.worst_share,
        0.015,
    )


@pytest.mark.parametrize("checked", far_pairs(), ids=lambda c: c.name)
def test_where_the_model_leaves_three_per_cent(checked: CheckedPair) -> None:
    """25 deg, large profile shifts and sharp fillets: the beam is 4.3 .. 4.9 % too soft."""
    load = checked.line_load * checked.pair.face_width
    for tooth, apart in (("solved", 0.01), ("beam", 0.05)):
        model = LoadedModel(tooth=tooth, body="bore_clamped", extended=False)
        got = check_stiffness(checked.pair, load, model=model)
        assert np.max(np.abs(got.difference)) < apart
        assert got.worst_share < 0.015


def test_splitting_every_element() -> None:
    coarse, fine = (
        pair_stiffness(PUBLISHED.pair, FORCE, [0.3, 0.8], Density(refinement=n)) for n in (1, 2)
    )
    assert coarse.secant == pytest.approx(fine.secant, rel=1.2e-3)
    assert coarse.share == pytest.approx(fine.share, abs=2e-4)


def test_exchanged_gears_mirror_the_mesh() -> None:
    """The pairs at s_A + (phi + j) p_b stand as far from the other gear's s_E."""
    pair = own_pairs()[0].pair
    phase = np.array([0.1, 0.4, 0.75])
    one = pair_stiffness(pair, 2e3, phase)
    other = pair_stiffness(pair.swapped(), 2e3, np.mod(pair.contact_ratio - phase, 1.0))
    assert one.secant == pytest.approx(other.secant, rel=1e-3)
    assert one.share[:2, 1:3] == pytest.approx(other.share[:2, 2:0:-1], abs=1e-3)


def test_only_the_contact_knows_the_load() -> None:
    """a grows with the root of F: d(b/k)/d ln F = -(1/2) sum_i 2 (1 - nu^2)/(pi E)."""
    loads = np.array([0.25, 1.0, 4.0]) * FORCE
    compliance = np.array(
        [20e-3 / pair_stiffness(PUBLISHED.pair, f, [0.85]).secant[0] for f in loads]
    )
    slope = 2.0 * (1.0 - 0.3**2) / (np.pi * 206e9)
    assert np.diff(compliance) == pytest.approx([-slope * np.log(4.0)] * 2, rel=0.02)


def test_three_pairs_in_contact() -> None:
    high = Rack(addendum=1.25, dedendum=1.5, fillet_radius=0.3)
    pair = GearPair(Gear(40, 3e-3, rack=high), Gear(60, 3e-3, rack=high))
    got = check_stiffness(pair, 200e3 * pair.face_width, inner_phases(pair, 1))
    assert got.pairs.tolist() == [3, 2]
    assert np.max(np.abs(got.difference)) < 0.01
    assert got.worst_share < 0.015


def test_one_gear_scales_with_size() -> None:
    """A plane compliance per width is free of length: the scaled gear is as soft."""
    gear, twice = Gear(25, 5e-3, face_width=20e-3), Gear(25, 10e-3, face_width=20e-3)
    t = [0.3, 0.4]
    one, other = gear_compliance(gear, t, 1e-4), gear_compliance(twice, t, 2e-4)
    assert one == pytest.approx(other, rel=1e-8)
    assert one[1] > one[0] > 0.0


class TestGrowth:
    @pytest.mark.parametrize(
        ("teeth", "bore", "radii", "limit"),
        [
            (25, 25e-3, [60.0, 62.5, 65.0, 67.5], 0.2e-6),
            (75, 40e-3, [183.1, 185.0, 187.5, 190.0, 192.5], 0.7e-6),
        ],
    )
    @pytest.mark.parametrize("addendum", [373.15, 413.15])
    def test_field_of_the_table(
        self,
        teeth: int,
        bore: float,
        radii: list[float],
        limit: float,
        addendum: float,
        compared: Compared,
    ) -> None:
        gear = Gear(teeth, 5e-3, bore_radius=bore)
        field = RadialField(
            bore_radius=bore,
            tip_radius=gear.tip_radius,
            bore_temperature=addendum - 20.0,
            addendum_temperature=addendum,
            reference=293.15,
        )
        at = 1e-3 * np.array(radii)
        off = flank_growth(gear, field, at) - finite_flank_growth(gear, field, at)
        compared(
            "growth of the flank in a temperature gradient",
            "own finite elements",
            1e6 * off,
            min(1e6 * limit, 0.1),
            "µm",
        )

    @pytest.mark.parametrize("support", ["rigid", "shaft"])
    def test_held_bores(self, support: str, compared: Compared) -> None:
        gear = Gear(25, 5e-3, bore_radius=25e-3)
        field = RadialField(
            bore_radius=25e-3,
            tip_radius=gear.tip_radius,
            bore_temperature=393.15,
            addendum_temperature=413.15,
            reference=293.15,
        )
        at = np.array([60e-3, 65e-3, 67.5e-3])
        finite = finite_flank_growth(gear, field, at, support)
        off = flank_growth(gear, field, at, support) - finite
        compared(
            "growth of the flank, bore held by its shaft",
            "own finite elements",
            1e6 * off,
            0.3,
            "µm",
        )

    @pytest.mark.parametrize("gear", [Gear(25, 5e-3), Gear(16, 2e-3, profile_shift=0.3)])
    def test_uniform_heat_keeps_the_involute(self, gear: Gear, compared: Compared) -> None:
        """delta_n = lambda tau rho_k, exactly: the displacement is in the elements' space."""
        field = RadialField.uniform(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            temperature=393.15,
            reference=293.15,
        )
        radii = flank_radii(gear)
        got = finite_flank_growth(gear, field, radii)
        expected = 100.0 * gear.material.thermal_expansion * gear.curvature_radius(radii)
        compared(
            "finite elements under a uniform rise",
            "involute of a larger base circle",
            (got - expected) / expected.max(),
            1e-9,
        )

    def test_linear_in_the_field(self) -> None:
        gear = Gear(25, 5e-3)

        def growth(bore: float, tip: float) -> np.ndarray:
            field = RadialField(
                bore_radius=gear.bore_radius,
                tip_radius=gear.tip_radius,
                bore_temperature=bore,
                addendum_temperature=tip,
                reference=300.0,
            )
            return finite_flank_growth(gear, field, 65e-3)

        parts = growth(310.0, 300.0) + growth(300.0, 320.0)
        assert growth(310.0, 320.0) == pytest.approx(parts, rel=1e-10)

    def test_refusals(self) -> None:
        gear = Gear(25, 5e-3)
        field = RadialField.uniform(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            temperature=393.15,
            reference=293.15,
        )
        with pytest.raises(InputError, match=r"radius: got 50 \.\. 50 mm; allowed 59\.1183"):
            finite_flank_growth(gear, field, 50e-3)
        with pytest.raises(InputError, match=r"bore: got 'fre'; .* did you mean 'free'"):
            finite_flank_growth(gear, field, 65e-3, "fre")
        many = RadialField.uniform(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            temperature=np.array([[300.0], [310.0]]),
            reference=293.15,
        )
        with pytest.raises(InputError, match="field: got 2 states; allowed one state"):
            finite_flank_growth(gear, many, 65e-3)


@pytest.mark.parametrize(
    ("force", "phase", "message"),
    [
        (0.0, [0.5], r"normal_force: got 0\.0 N; allowed > 0, finite"),
        (float("nan"), [0.5], "normal_force: got nan N; allowed > 0, finite"),
        (1e3, [1.0], r"phase: got \[1\.\]; allowed 0 <= phase < 1"),
    ],
)
def test_refused_loads_and_positions(force: float, phase: list[float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        pair_stiffness(PUBLISHED.pair, force, phase)


@pytest.mark.parametrize(("place", "known"), [(0, 2.490), (1, 2.085), (2, 2.190)])
def test_the_stress_of_a_root_is_that_of_elements_not_written_here(
    place: int, known: float
) -> None:
    """The model's and the finer elements' within 0.3 % of triangles computed apart."""
    checked, name = root_pairs()[place]
    gear: Gear = getattr(checked.pair, name)
    # the outer point of single contact
    t = single_contact(checked.pair)[GEARS.index(name)]
    assert root_table(gear).stress(t).max() == pytest.approx(known, rel=3e-3)
    sector = FlankSector(gear, 0.05 * gear.module, 3)
    load = sector.pressed(0.5 * gear.base_radius * t**2, half_width=0.12 * gear.module)
    assert gear.module * sector.root_stress(load)[0].max() == pytest.approx(known, rel=3e-3)
