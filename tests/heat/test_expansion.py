"""Thermal growth: boundary-value solver, published table, uniform limits, backlash and jam."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import ZERO_CELSIUS
from thermogear.gears.geometry import Gear
from thermogear.heat.expansion import (
    RadialField,
    base_circle_growth,
    centre_distance_growth,
    flank_growth,
    hot_half_backlash,
    radial_displacement,
)

LAM, NU, COLD = 11.5e-6, 0.3, ZERO_CELSIUS + 20.0
PINION = Gear(teeth=25, module=5e-3, bore_radius=0.025, face_width=0.025)
WHEEL = Gear(teeth=75, module=5e-3, bore_radius=0.040, face_width=0.025)
CENTRE, BASE_SUM = 0.25, 0.25 * math.sin(math.radians(20.0))


def field_of(gear: Gear, addendum: float, drop: float = 20.0) -> RadialField:
    """T_a [C] at the addendum, ``drop`` K less at the bore."""
    hot = ZERO_CELSIUS + addendum
    return RadialField(
        bore_radius=gear.bore_radius,
        tip_radius=gear.tip_radius,
        bore_temperature=hot - drop,
        addendum_temperature=hot,
        reference=COLD,
    )


@pytest.mark.parametrize("plane", ["stress", "strain"])
@pytest.mark.parametrize("bore", ["free", "rigid", "shaft"])
def test_annulus_against_a_boundary_value_solver(bore: str, plane: str, compared: Compared) -> None:
    """u'' + u'/r - u/r^2 = (1+nu) lambda tau', stress-free outside, bore free or given."""
    lam, nu = (LAM, NU) if plane == "stress" else (LAM * (1 + NU), NU / (1 - NU))
    field, outer = field_of(PINION, 120.0), PINION.root_radius
    rx, tx, g = field.bore_radius, float(field.bore_rise), float(field.gradient)
    given = {"rigid": 0.0, "shaft": lam * tx * rx}.get(bore)
    edge = rx / outer  # radii in units of the outer one, displacements of lam * 100 K * outer

    def tau(x: float) -> float:
        return (tx + g * float(np.log(x / edge))) / 100.0

    def slope(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return np.vstack([y[1], y[0] / x**2 - y[1] / x + (1 + nu) * g / 100.0 / x])

    def ends(left: np.ndarray, right: np.ndarray) -> np.ndarray:
        def stress(x: float, y: np.ndarray) -> float:
            return float(y[1] + nu * y[0] / x - (1 + nu) * tau(x))

        unit = lam * 100.0 * outer
        at_bore = stress(edge, left) if given is None else left[0] - given / unit
        return np.array([at_bore, stress(1.0, right)])

    mesh = np.linspace(edge, 1.0, 60)
    solved = solve_bvp(slope, ends, mesh, np.zeros((2, 60)), tol=1e-9, max_nodes=20000)
    assert solved.success
    probe = np.linspace(edge, 1.0, 17)
    ours = radial_displacement(
        field, probe * outer, root_radius=outer, expansion=LAM, poisson=NU, bore=bore, plane=plane
    )
    compared(
        "displacement of the ring, three bores, both plane states",
        "boundary-value solver",
        ours / (lam * 100.0 * outer) - solved.sol(probe)[0],
        1e-10,
    )


def literal(field: RadialField, r: np.ndarray, outer: float, bore: str) -> np.ndarray:
    """(A1) and (A2) as they are written in the docstring."""
    rx, tx, g = field.bore_radius, float(field.bore_rise), float(field.gradient)

    def moment(s):  # type: ignore[no-untyped-def]
        return tx * (s**2 - rx**2) / 2 + g * (s**2 * np.log(s / rx) / 2 - (s**2 - rx**2) / 4)

    if bore == "free":
        spread = ((1 - NU) * r**2 + (1 + NU) * rx**2) / (outer**2 - rx**2)
        return LAM / r * ((1 + NU) * moment(r) + spread * moment(outer))
    ua = 0.0 if bore == "rigid" else LAM * tx * rx
    c1 = ((1 - NU) * rx * ua + (1 - NU**2) * LAM * moment(outer)) / (
        (1 - NU) * rx**2 + (1 + NU) * outer**2
    )
    return (1 + NU) * LAM * moment(r) / r + c1 * r + (rx * ua - c1 * rx**2) / r


@pytest.mark.parametrize("bore", ["free", "rigid", "shaft"])
def test_annulus_is_the_textbook_form(bore: str) -> None:
    field, outer = field_of(WHEEL, 140.0), WHEEL.root_radius
    r = np.linspace(field.bore_radius, outer, 9)
    ours = radial_displacement(field, r, root_radius=outer, expansion=LAM, poisson=NU, bore=bore)
    assert ours == pytest.approx(literal(field, r, outer, bore), abs=1e-17)


def test_outer_edge_moves_by_the_area_mean() -> None:
    field, outer = field_of(PINION, 130.0, 35.0), PINION.root_radius
    mean = float(field.area_mean(outer)) - COLD
    edge = radial_displacement(field, outer, root_radius=outer, expansion=LAM, poisson=NU)
    assert edge == pytest.approx(LAM * outer * mean, rel=1e-13)


def test_displacement_is_continuous_at_the_root_circle_and_follows_its_integral() -> None:
    field, rf = field_of(PINION, 120.0), PINION.root_radius
    near = radial_displacement(
        field, rf * (1.0 + np.array([-1e-12, 1e-12])), root_radius=rf, expansion=LAM, poisson=NU
    )
    assert near[0] == pytest.approx(near[1], abs=1e-15)
    r, rx = 0.066, field.bore_radius
    tx, g = float(field.bore_rise), float(field.gradient)

    def primitive(s: float) -> float:
        return LAM * (tx * s + g * (s * np.log(s / rx) - s))

    free = radial_displacement(
        field, r, root_radius=rf, expansion=LAM, poisson=NU
    ) - radial_displacement(field, rf, root_radius=rf, expansion=LAM, poisson=NU)
    assert free == pytest.approx(primitive(r) - primitive(rf), rel=1e-11)


TABLE = [  # T_a C, gear, radii mm, delta_n um, u_b um
    (100.0, PINION, (60.0, 62.5, 65.0, 67.5), (10.3, 17.8, 23.1, 27.6), 47.7),
    (140.0, PINION, (60.0, 62.5, 65.0, 67.5), (16.0, 27.6, 35.9, 42.9), 74.7),
    (
        100.0,
        WHEEL,
        (181.25, 185.0, 187.5, 190.0, 192.5),
        (36.5, 48.3, 54.8, 60.8, 66.3),
        149.2,
    ),
    (
        140.0,
        WHEEL,
        (181.25, 185.0, 187.5, 190.0, 192.5),
        (56.0, 74.2, 84.3, 93.5, 102.0),
        230.3,
    ),
]


@pytest.mark.parametrize(("addendum", "gear", "radii", "growth", "base"), TABLE)
def test_published_flank_growth(
    addendum: float,
    gear: Gear,
    radii: tuple[float, ...],
    growth: tuple[float, ...],
    base: float,
    compared: Compared,
) -> None:
    """delta_n within 0.1 um, u_b too (bores 25/40 mm free, 20 K gradient)."""
    field = field_of(gear, addendum)
    ours = flank_growth(gear, field, np.array(radii) * 1e-3) * 1e6
    compared(
        "growth of the flank, 25 and 75 teeth, 100 and 140 °C",
        "computed apart",
        ours - growth,
        0.1,
        "µm",
    )
    compared(
        "growth of the base circle",
        "computed apart",
        base_circle_growth(gear, field) * 1e6 - base,
        0.1,
        "µm",
    )


@pytest.mark.parametrize("bore", ["free", "shaft"])
@pytest.mark.parametrize("gear", [PINION, WHEEL])
def test_uniform_rise_keeps_an_involute(gear: Gear, bore: str, compared: Compared) -> None:
    """delta_n = lambda tau rho_k to 1e-12: an involute of the larger base circle."""
    field = field_of(gear, 120.0, 0.0)
    r = np.linspace(gear.form_radius, gear.tip_radius, 33)
    rho = np.sqrt(r**2 - gear.base_radius**2)
    compared(
        "growth under a uniform rise",
        "involute of a larger base circle",
        flank_growth(gear, field, r, bore) / (LAM * 100.0 * rho) - 1.0,
        1e-12,
    )
    assert base_circle_growth(gear, field, bore) == pytest.approx(
        LAM * 100.0 * gear.base_radius, rel=1e-14
    )


def test_uniform_growth_carries_the_involute_onto_the_larger_base_circle() -> None:
    """Independent of (B): the scaled flank is the involute of r_b (1 + lambda tau)."""
    rise = 0.01  # so small that the second order vanishes
    bigger = Gear(teeth=25, module=5e-3 * (1.0 + LAM * rise), bore_radius=0.025)
    r = np.linspace(0.0595, 0.067, 9)
    turn = bigger.half_thickness_angle(r) - PINION.half_thickness_angle(r)
    normal = turn * r * (PINION.base_radius / r)  # to first order
    growth = flank_growth(PINION, field_of(PINION, 20.0 + rise, 0.0), r)
    assert normal == pytest.approx(growth, rel=1e-5)


def path_radii(count: int = 41) -> tuple[np.ndarray, np.ndarray]:
    """Radii of pinion and wheel flank along A..E of the rig."""
    s = np.linspace(7.9647e-3, 33.2708e-3, count)
    return np.hypot(PINION.base_radius, s), np.hypot(WHEEL.base_radius, BASE_SUM - s)


@pytest.mark.parametrize(("drop", "limit"), [(0.0, 1e-12), (10.0, 0.9e-6), (20.0, 0.9e-6)])
def test_equal_fields_shift_backlash_and_hardly_excite(drop: float, limit: float) -> None:
    """delta_n1 + delta_n2 is constant along the path to < 0.9 um for free bores, <= 20 K."""
    r1, r2 = path_radii()
    for addendum in (100.0, 130.0, 160.0):
        total = flank_growth(PINION, field_of(PINION, addendum, drop), r1)
        total = total + flank_growth(WHEEL, field_of(WHEEL, addendum, drop), r2)
        assert np.ptp(total) < limit


def test_unequal_gears_differ_by_a_base_pitch_error() -> None:
    """Slope of the sum along the path: lambda (T1 - T2), 3.4 um per 20 K and base pitch."""
    s = np.linspace(9e-3, 32e-3, 30)
    r1, r2 = np.hypot(PINION.base_radius, s), np.hypot(WHEEL.base_radius, BASE_SUM - s)
    total = flank_growth(PINION, field_of(PINION, 120.0, 0.0), r1)
    total = total + flank_growth(WHEEL, field_of(WHEEL, 100.0, 0.0), r2)
    slope = np.polyfit(s, total, 1)[0]
    assert slope == pytest.approx(LAM * 20.0, rel=1e-9)
    assert slope * PINION.base_pitch == pytest.approx(3.4e-6, abs=0.05e-6)


@pytest.mark.parametrize("rise", [7.3, 80.0, 140.0])
@pytest.mark.parametrize("bore", ["free", "shaft"])
def test_everything_uniform_keeps_the_backlash_exactly(
    rise: float, bore: str, compared: Compared
) -> None:
    r1, r2 = path_radii()
    hot = COLD + rise
    strain = PINION.material.thermal_expansion * (hot - COLD)
    beyond = [
        flank_growth(
            gear,
            RadialField.uniform(
                bore_radius=gear.bore_radius,
                tip_radius=gear.tip_radius,
                temperature=hot,
                reference=COLD,
            ),
            r,
            bore,
            strain_taken_off=strain,
        )
        for gear, r in ((PINION, r1), (WHEEL, r2))
    ]
    compared(
        "hot half backlash, everything equally warm",
        "the cold one, exactly",
        hot_half_backlash(125e-6, growth_1=beyond[0], growth_2=beyond[1]) - 125e-6,
        0.0,
        "m",
    )
    # the plain form says the same to rounding
    plain = [
        flank_growth(
            g,
            RadialField.uniform(
                bore_radius=g.bore_radius, tip_radius=g.tip_radius, temperature=hot, reference=COLD
            ),
            r,
            bore,
        )
        for g, r in ((PINION, r1), (WHEEL, r2))
    ]
    opening = centre_distance_growth(CENTRE, LAM, temperature=hot, reference=COLD) * math.sin(
        math.radians(20.0)
    )
    closed = hot_half_backlash(0.0, growth_1=plain[0], growth_2=plain[1], axis_opening=opening)
    assert closed == pytest.approx(np.zeros(41), abs=1e-17)


def test_both_ways_of_the_housing_agree_for_any_field() -> None:
    r1, r2 = path_radii()
    strain = LAM * 60.0
    fields = field_of(PINION, 120.0), field_of(WHEEL, 110.0)
    plain = flank_growth(PINION, fields[0], r1), flank_growth(WHEEL, fields[1], r2)
    opening = centre_distance_growth(
        CENTRE, LAM, temperature=COLD + 60.0, reference=COLD
    ) * math.sin(math.radians(20.0))
    beyond = (
        flank_growth(PINION, fields[0], r1, strain_taken_off=strain),
        flank_growth(WHEEL, fields[1], r2, strain_taken_off=strain),
    )
    first = hot_half_backlash(1e-4, growth_1=plain[0], growth_2=plain[1], axis_opening=opening)
    second = hot_half_backlash(1e-4, growth_1=beyond[0], growth_2=beyond[1])
    assert first == pytest.approx(second, abs=1e-17)


@pytest.mark.parametrize(
    ("addendum", "below", "lost", "tolerance"),
    [
        (100.0, None, 72.0, 1.0),
        (160.0, None, 132.0, 1.0),
        (130.0, 20.0, 14.0, 1.0),
        (130.0, 50.0, 43.0, 1.0),
    ],
)
def test_published_backlash_losses(
    addendum: float, below: float | None, lost: float, tolerance: float, compared: Compared
) -> None:
    """Half backlash lost [um], bores 25/40 free, 20 K gradient, housing none or below T_a."""
    r1, r2 = path_radii()
    total = flank_growth(PINION, field_of(PINION, addendum), r1)
    total = total + flank_growth(WHEEL, field_of(WHEEL, addendum), r2)
    opening = 0.0
    if below is not None:
        hot = ZERO_CELSIUS + addendum - below
        opening = (
            float(centre_distance_growth(CENTRE, LAM, temperature=hot, reference=COLD))
            * BASE_SUM
            / CENTRE
        )
    change = -hot_half_backlash(0.0, growth_1=total, growth_2=0.0, axis_opening=opening) * 1e6
    compared(
        "half backlash lost",
        "computed apart, four states",
        float(np.mean(change)) - lost,
        tolerance,
        "µm",
    )


def least_backlash(temperature: float) -> float:
    """94 um of total normal backlash; both gears uniformly hot, steel housing cold."""
    r1, r2 = path_radii()
    one, two = (
        flank_growth(
            g,
            RadialField.uniform(
                bore_radius=g.bore_radius,
                tip_radius=g.tip_radius,
                temperature=temperature,
                reference=COLD,
            ),
            r,
        )
        for g, r in ((PINION, r1), (WHEEL, r2))
    )
    return float(np.min(hot_half_backlash(47e-6, growth_1=one, growth_2=two)))


def test_uniformly_hot_gears_jam_over_a_cold_housing(compared: Compared) -> None:
    """1.967 um/K of total normal backlash, so 94 um are gone near +48 K."""
    jam = brentq(least_backlash, COLD, COLD + 120.0)
    closed = 94e-6 / (2.0 * BASE_SUM * LAM)
    compared(
        "temperature at which a pair jams",
        "closed form for uniform heat",
        (jam - COLD) / closed - 1.0,
        1e-6,
    )
    assert jam - COLD == pytest.approx(48.0, abs=0.3)
    lost = least_backlash(COLD) - least_backlash(COLD + 1.0)
    assert 2e6 * lost == pytest.approx(1.967, abs=5e-4)


def test_batch_over_operating_points_is_one_by_one() -> None:
    addenda = ZERO_CELSIUS + np.array([[100.0], [140.0]])
    r = np.linspace(0.0595, 0.067, 5)
    many = RadialField(
        bore_radius=PINION.bore_radius,
        tip_radius=PINION.tip_radius,
        bore_temperature=addenda - 20.0,
        addendum_temperature=addenda,
        reference=COLD,
    )
    for bore in ("free", "rigid", "shaft"):
        batch = flank_growth(PINION, many, r, bore)
        single = [flank_growth(PINION, field_of(PINION, t), r, bore) for t in (100.0, 140.0)]
        assert np.array_equal(batch, single)


def test_scaling_the_gear_scales_the_growth() -> None:
    twice = Gear(teeth=25, module=1e-2, bore_radius=0.050)
    r = np.linspace(0.0595, 0.067, 5)
    one = flank_growth(PINION, field_of(PINION, 120.0), r)
    two = flank_growth(twice, field_of(twice, 120.0), 2.0 * r)
    assert two == pytest.approx(2.0 * one, rel=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: RadialField(
                bore_radius=0.07,
                tip_radius=0.0675,
                bore_temperature=350.0,
                addendum_temperature=350.0,
                reference=COLD,
            ),
            "bore_radius: got 0.07 m with",
        ),
        (
            lambda: RadialField(
                bore_radius=0.025,
                tip_radius=0.0675,
                bore_temperature=-3.0,
                addendum_temperature=350.0,
                reference=COLD,
            ),
            "bore_temperature: got -3.0 K",
        ),
        (
            lambda: RadialField(
                bore_radius=0.025,
                tip_radius=0.0675,
                bore_temperature=350.0,
                addendum_temperature=350.0,
                reference=0.0,
            ),
            "reference temperature: got 0.0",
        ),
        (lambda: flank_growth(PINION, field_of(PINION, 90.0), 0.05), "radius: got 0.05 m"),
        (
            lambda: flank_growth(PINION, field_of(PINION, 90.0), 0.06, "fre"),
            "bore: got 'fre'; allowed free | rigid | shaft; did you mean 'free'?",
        ),
        (
            lambda: radial_displacement(
                field_of(PINION, 90.0), 0.03, root_radius=0.02, expansion=LAM, poisson=NU
            ),
            "bore_radius: got 0.025 m with root radius 0.02 m",
        ),
    ],
)
def test_impossible_input_is_refused_in_one_line(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)


def kinked(drop: float = 30.0) -> RadialField:
    """Bore, body, root circle and tooth at temperatures of their own."""
    hot = ZERO_CELSIUS + 120.0
    middle = math.sqrt(0.5 * (PINION.bore_radius**2 + PINION.root_radius**2))
    return RadialField(
        bore_radius=PINION.bore_radius,
        tip_radius=PINION.tip_radius,
        bore_temperature=hot - drop,
        addendum_temperature=hot,
        reference=COLD,
        between=((middle, hot - 0.7 * drop), (PINION.root_radius, hot - 0.2 * drop), (0.0625, hot)),
    )


def test_a_field_through_places_of_one_logarithm_is_that_logarithm() -> None:
    plain = field_of(PINION, 120.0)
    places = tuple((r, plain.temperature(r)) for r in (0.035, 0.05, 0.0625))
    through = RadialField(
        bore_radius=plain.bore_radius,
        tip_radius=plain.tip_radius,
        bore_temperature=plain.bore_temperature,
        addendum_temperature=plain.addendum_temperature,
        reference=COLD,
        between=places,
    )
    r = np.linspace(plain.bore_radius, plain.tip_radius, 41)
    np.testing.assert_allclose(through.temperature(r), plain.temperature(r), rtol=1e-13)
    np.testing.assert_allclose(through.area_mean(r[1:]), plain.area_mean(r[1:]), rtol=1e-12)
    for bore in ("free", "rigid", "shaft"):
        one, other = (
            radial_displacement(
                f, r, root_radius=PINION.root_radius, expansion=LAM, poisson=NU, bore=bore
            )
            for f in (through, plain)
        )
        np.testing.assert_allclose(one, other, rtol=1e-11, atol=1e-18)


def test_growth_of_a_kinked_field_is_the_integral_of_its_temperature() -> None:
    """(A1) with J by quadrature of T(r) itself, and a tooth that grows freely above the root."""
    field, root = kinked(), PINION.root_radius
    r = np.linspace(PINION.bore_radius, PINION.tip_radius, 400_001)
    rise = field.temperature(r) - COLD
    np.testing.assert_allclose(rise, field.rise(r), atol=1e-9)
    for radius, kelvin in field.between:
        assert field.temperature(radius) == pytest.approx(float(kelvin), abs=1e-9)
    moment = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(r) * (rise * r)[1:])])
    moment += np.concatenate([[0.0], np.cumsum(0.5 * np.diff(r) * (rise * r)[:-1])])
    rx = PINION.bore_radius
    whole = float(np.interp(root, r, moment))

    def ring(x: float) -> float:
        at = float(np.interp(x, r, moment))
        pulled = (1 + NU) * at + ((1 - NU) * x**2 + (1 + NU) * rx**2) / (root**2 - rx**2) * whole
        return LAM / x * pulled

    found = radial_displacement(
        field, [0.03, 0.045, root], root_radius=root, expansion=LAM, poisson=NU
    )
    assert found == pytest.approx([ring(x) for x in (0.03, 0.045, root)], rel=1e-8)
    above = r >= root
    tooth = ring(root) + LAM * np.trapezoid(rise[above], r[above])
    tip = radial_displacement(field, PINION.tip_radius, root_radius=root, expansion=LAM, poisson=NU)
    assert float(tip) == pytest.approx(tooth, rel=1e-4)
    inside = r <= root
    mean = np.trapezoid((rise * r)[inside], r[inside]) / (0.5 * (root**2 - rx**2)) + COLD
    assert float(field.area_mean(root)) == pytest.approx(mean, abs=1e-3)
    # uniform places grow nothing beyond size, exactly
    same = RadialField(
        bore_radius=rx,
        tip_radius=PINION.tip_radius,
        bore_temperature=400.0,
        addendum_temperature=400.0,
        reference=COLD,
        between=((0.04, 400.0), (0.0625, 400.0)),
    )
    assert all(float(change) == 0.0 for _, change in same.kinks)


@pytest.mark.parametrize("radii", [(0.06, 0.05), (0.02,), (0.07,)])
def test_places_that_do_not_rise_from_bore_to_tip_are_refused(radii: tuple[float, ...]) -> None:
    with pytest.raises(InputError, match=r"^between: got .* m; allowed rising between bore and"):
        RadialField(
            bore_radius=PINION.bore_radius,
            tip_radius=PINION.tip_radius,
            bore_temperature=350.0,
            addendum_temperature=370.0,
            reference=COLD,
            between=tuple((r, 360.0) for r in radii),
        )
