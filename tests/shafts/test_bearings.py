"""Rolling bearings against published numbers, closed forms, limits and seeded random ones."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import fsolve
from trains import TRUTH

from conftest import Compared
from sjovall import load_zone_integral
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS, material
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing
from thermogear.shafts.bearings.clearance import (
    CLASSES,
    Fit,
    class_clearance,
    mounted_clearance,
    ring_growth,
    thermal_clearance,
)
from thermogear.shafts.bearings.friction import F0, PalmgrenFriction, SkfFriction, has_skf
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.bearings.hertz import (
    ball_coefficient,
    ellipse_ratio,
    race_contact,
    roller_coefficient,
)
from thermogear.shafts.bearings.laws import BearingLaw, ElementLaw, LinearLaw, RingLaw
from thermogear.shafts.bearings.life import least_load, rating_life, static_safety

STEEL = material("steel")


def at_load(law: BearingLaw, load: float, start: float = 2e-5) -> np.ndarray:
    """(x, y) [m] under (load, 0)."""
    found = fsolve(
        lambda u: 1e-3 * (law.force(1e-5 * u) + np.array([load, 0.0])),
        [1e5 * start, 0.0],
        xtol=1e-11,
    )
    return np.asarray(1e-5 * found)


def test_rolling_elements_as_truth_b1(compared: Compared) -> None:
    p, values = TRUTH["B1"]["params"], TRUTH["B1"]["values"]
    step = np.pi / p["elements"]
    away = []
    for name, angle in (
        ("element_under_load", 0.0),
        ("gap_under_load", step),
        ("quarter", 0.5 * step),
    ):
        law = ElementLaw(
            elements=p["elements"],
            coefficient=p["K"],
            exponent=p["exponent"],
            clearance=p["radial_clearance"],
            cage_angle=angle,
        )
        u = np.array(values[name])
        for _ in range(20):
            step_of = np.linalg.solve(law.stiffness(u), law.force(u) + np.array([p["load"], 0.0]))
            u = u + step_of
        away.append(np.abs(u - values[name]).max())
    compared("journal in its elements", "Newton; least energy", away, 1e-10 * 2.7e-5, "m")


def test_hot_clearance_as_truth_t1(compared: Compared) -> None:
    for name in ("T1", "T1u"):
        p, values = TRUTH[name]["params"], TRUTH[name]["values"]
        rises = [p[f"T_{one}"] - p["T_ref"] for one in ("inner", "ball", "outer")]
        found = [
            float(
                thermal_clearance(
                    inner_raceway=p["inner_raceway"],
                    outer_raceway=p["outer_raceway"],
                    element_diameter=p["ball"],
                    expansions=tuple(p[f"expansion_{o}"] for o in ("inner", "ball", "outer")),
                    temperatures=warm,
                )
            )
            for warm in ([0.0] * 3, rises)
        ]
        away = np.array(found) - [values["cold"], values["hot"]]
        compared(f"radial clearance, {name}", "rings as grown circles", away, 1e-10 * 1e-5, "m")


def test_ball_stiffness_of_a_6305(compared: Compared) -> None:
    """K_b, and the deflection without and with 10 um of play, f 0.52/0.53, 210 GPa."""
    one = catalogue_bearing("6305")
    k = ball_coefficient(one.element_diameter, diameter_ratio=one.ratio)
    compared("K_b of a 6305", "333 592 N/mm^1.5", k * 1e-3**1.5 / 333592.0 - 1.0, 2e-6)
    for clearance, known in ((0.0, 15.1102e-6), (5e-6, 21.2228e-6)):
        law = ElementLaw(elements=7, coefficient=k, clearance=clearance)
        compared(
            f"6305 under 1000 N, c_r {1e6 * clearance:.0f} um",
            "a public example",
            at_load(law, 1000.0)[0] / known - 1.0,
            1e-5,
        )


def test_stiffness_of_a_6205_over_load_and_clearance(compared: Compared) -> None:
    """Displacement [um] and both tangent stiffnesses [N/um] of a table recomputed elsewhere."""
    table = {
        (500, 0, 0): (9.17, 82, 61), (500, 0, 1): (9.13, 82, 51),
        (500, 5, 0): (15.00, 81, 28), (500, 5, 1): (15.16, 81, 41),
        (500, 10, 0): (20.73, 81, 26), (500, 10, 1): (20.95, 77, 23),
        (2000, 0, 0): (23.1, 130, 97), (2000, 0, 1): (23.0, 130, 81),
        (2000, 5, 0): (29.1, 129, 51), (2000, 5, 1): (29.1, 130, 76),
        (2000, 10, 0): (34.8, 129, 44), (2000, 10, 1): (35.1, 130, 69),
    }  # fmt: skip
    one = catalogue_bearing("6205")
    moved, stiff = [], []
    for (load, clearance, gap), (x, along, across) in table.items():
        law = one.law(1e-6 * clearance, gap * np.pi / one.elements)
        u = at_load(law, load)
        k = 1e-6 * law.stiffness(u)
        moved.append(1e6 * u[0] / x - 1.0)
        stiff += [k[0, 0] / along - 1.0, k[1, 1] / across - 1.0]
    compared("6205 under load", "a table rounded to 3 digits", moved, 6e-3)
    compared("6205's stiffness", "a table rounded to 2 digits", stiff, 3e-2)


def test_load_zone_and_catalogue_closures(compared: Compared) -> None:
    """Sjovall's integrals, and C0 by 4200 MPa under the heaviest ball (Q = 5 C0/Z)."""
    away = [
        load_zone_integral(0.5, exponent=1.5) - 0.2288,
        load_zone_integral(0.5, exponent=10 / 9) - 0.2448,
    ]
    compared("load zone integral", "Sjovall", away, 5e-5)
    found = []
    for name in ("6203", "6204", "6205", "6206", "6208", "6305", "6306", "6308"):
        one = catalogue_bearing(name)
        q = 5.0 * float(one.static_rating or 0.0) / one.elements
        inner = race_contact(
            one.element_diameter,
            diameter_ratio=one.ratio,
            conformity=0.52,
            inner=True,
            youngs_modulus=207e9,
        )
        found.append(inner.pressure(q) / 4200e6 - 1.0)
    compared("pressure at 5 C0/Z", "4200 MPa", found, 0.012)
    rollers = [
        44.0 * (1 - one.ratio) * one.elements * float(one.element_length or 0) * 1e3
        * one.element_diameter * 1e3 / float(one.static_rating or 1) - 1.0
        for one in CATALOGUE.values() if one.kind == "roller"
    ]  # fmt: skip
    compared("C0 of rollers", "44 (1 - g) Z L D_w", rollers, 0.011)


def test_orders_of_known_bearings(compared: Compared) -> None:
    drive = replace(
        catalogue_bearing("6205"), element_diameter=0.3126 * 25.4e-3, pitch_diameter=39.04e-3
    )
    away = [
        drive.outer_order - 3.5848,
        catalogue_bearing("NU206E").outer_order - 5.242,
    ]
    compared("passing orders", "published orders of the same bearings", away, 6e-4)


def test_friction_of_a_6205(compared: Compared) -> None:
    one, speed = catalogue_bearing("6205"), 3000.0 * np.pi / 30.0
    skf = SkfFriction(bearing=one)
    found = [
        1e3 * float(skf.moment(force=f, speed=speed, viscosity=20e-6)) for f in (500.0, 1000.0)
    ]
    away = np.array(found) / [11.8, 20.6] - 1.0
    compared("SKF's friction of a 6205", "recomputed figures", away, 5e-3)
    bath, thin = (PalmgrenFriction(bearing=one, lubrication=how) for how in ("bath", "grease"))
    # the load part with the constant f1 = 0.0002 is 7.7 N mm
    values = [
        1e3 * float(law.moment(force=0.0, speed=speed, viscosity=20e-6)) for law in (bath, thin)
    ]
    si = [4501.0 * f0 * (20e-6 * speed) ** (2 / 3) * one.pitch_diameter**3 for f0 in (2.0, 1.0)]
    compared(
        "Palmgren's M0 in SI", "4501 f0 (nu w)^(2/3) d_m^3", np.array(values) / si / 1e3 - 1, 1e-3
    )
    assert float(skf.moment(force=0.0, speed=speed, viscosity=20e-6)) == 0.0
    assert float(bath.moment(force=1e3, speed=0.0, viscosity=20e-6)) == 0.0
    slow = [float(bath.moment(force=0.0, speed=w, viscosity=1e-4)) for w in (2.05, 2.2)]
    assert slow[1] == pytest.approx(slow[0], rel=0.06)
    assert not has_skf(catalogue_bearing("NU206E"))
    assert set(F0) == {
        (k, how) for k in ("ball", "angular", "roller") for how in ("bath", "grease", "jet")
    }


def test_tangents_are_derivatives_of_the_force(compared: Compared) -> None:
    rng = np.random.default_rng(41)
    worst = 0.0
    for _ in range(60):
        law: BearingLaw = rng.choice(
            [
                ElementLaw(
                    elements=int(rng.integers(5, 16)),
                    coefficient=10 ** rng.uniform(8.5, 10.5),
                    exponent=float(rng.choice([1.5, 10 / 9])),
                    clearance=rng.uniform(-2e-5, 2e-5),
                    cage_angle=rng.uniform(0, 1),
                ),
                RingLaw(
                    coefficient=10 ** rng.uniform(8, 11),
                    exponent=rng.uniform(1.0, 1.6),
                    clearance=rng.uniform(0, 1e-5),
                ),
                LinearLaw(stiffness_matrix=((3e8, 1e7), (1e7, 2e8))),
            ]
        )
        u = rng.uniform(1.1e-5, 6e-5) * np.array([np.cos(a := rng.uniform(0, 7)), np.sin(a)])
        h = 1e-9
        slopes = np.stack(
            [(law.force(u + h * e) - law.force(u - h * e)) / (2 * h) for e in np.eye(2)], axis=-1
        )
        k = law.stiffness(u)
        worst = max(worst, float(np.abs(slopes + k).max() / max(np.abs(k).max(), 1e6)))
    compared("tangent stiffness of a bearing", "difference of its force", worst, 2e-3)


def test_many_elements_are_isotropic_and_turn_with_the_load(compared: Compared) -> None:
    law = ElementLaw(elements=120, coefficient=1e9, clearance=5e-6)
    forces = [law.force(2.5e-5 * np.array([np.cos(a), np.sin(a)])) for a in np.linspace(0, 0.05, 9)]
    size = np.linalg.norm(forces, axis=1)
    compared("force of 120 elements over direction", "one force", np.ptp(size) / size.mean(), 1e-4)


def test_preload_holds_the_journal_in_its_centre(compared: Compared) -> None:
    """n K |c|^(n-1) Z/2 at u = 0: 132 N/um of a 6205 at -5 um."""
    k = catalogue_bearing("6205").law(-5e-6).stiffness([0.0, 0.0])
    assert abs(k[0, 1]) < 1e-6 * k[0, 0]
    compared("6205 preloaded by 5 um", "132 N/um", 1e-6 * k[0, 0] / 132.0 - 1.0, 5e-3)
    with pytest.raises(InputError, match="preload"):
        RingLaw(coefficient=1e8, clearance=-1e-6)


def test_clearance_of_a_mounted_6205(compared: Compared) -> None:
    """k5, smoothed by d/(d + 2): 2 to 21 um lose 1.5 to 16 um; 10 K across the rings 5.8."""
    one = catalogue_bearing("6205")
    even = np.full(3, 293.15)

    def mounted(interference: float, warm: np.ndarray = even) -> float:
        fit = Fit(ring=STEEL, shaft=STEEL, housing=STEEL, shaft_interference=interference)
        found = mounted_clearance(
            one, 12.5e-6, fit, warm, shaft_temperature=warm[0], housing_temperature=warm[2],
            reference=293.15,
        )  # fmt: skip
        return 2e6 * float(found)

    lost = [12.5 - mounted(1e-6 * i * 25.0 / 27.0) for i in (2.0, 11.5, 21.0)]
    compared(
        "loss of play by k5 on a 6205",
        "1.5, 8.7 and 16 um",
        np.array(lost) - [1.5, 8.7, 16.0],
        0.2,
        "um",
    )
    across = mounted(0.0) - mounted(0.0, np.array([303.15, 303.15, 293.15]))
    expected = 1e7 * STEEL.thermal_expansion * one.outer_raceway
    compared("10 K across the rings", "alpha dT F_o", across / expected - 1.0, 2e-2)


def test_fits_keep_lames_limits(compared: Compared) -> None:
    """One material: k (1 - k0^2)/(1 - k^2 k0^2); a soft housing hardly presses the ring."""
    rng = np.random.default_rng(43)
    worst = 0.0
    for _ in range(50):
        bore, fit, raceway = np.sort(rng.uniform(10e-3, 60e-3, 3))
        k, k0 = fit / raceway, bore / fit
        found = ring_growth(
            inner=bore, fit=fit, outer=raceway, within=STEEL, around=STEEL, seen="outer"
        )
        worst = max(worst, abs(found / (k * (1 - k0**2) / (1 - k**2 * k0**2)) - 1.0))
        shrunk = ring_growth(
            inner=bore, fit=fit, outer=raceway, within=STEEL, around=STEEL, seen="inner"
        )
        worst = max(worst, abs(shrunk / (k0 * (1 - k**2) / (1 - k**2 * k0**2)) - 1.0))
    compared("fit of rings of one material", "Lame, closed form", worst, 1e-12)
    soft = replace(STEEL, youngs_modulus=2e9)
    into_soft = ring_growth(
        inner=40e-3, fit=52e-3, outer=np.inf, within=STEEL, around=soft, seen="inner"
    )
    into_steel = ring_growth(
        inner=40e-3, fit=52e-3, outer=np.inf, within=STEEL, around=STEEL, seen="inner"
    )
    assert into_soft < 0.1 * into_steel


def test_an_aluminium_housing_loosens_the_outer_ring() -> None:
    one = catalogue_bearing("6206")
    fit = Fit(
        ring=STEEL,
        shaft=STEEL,
        housing=MATERIALS["aluminium"] if "aluminium" in MATERIALS
        else replace(STEEL, thermal_expansion=23e-6, youngs_modulus=70e9),
        housing_interference=20e-6,
    )  # fmt: skip

    def play(warm: float) -> float:
        found = mounted_clearance(
            one, 20e-6, fit, [warm] * 3, shaft_temperature=warm, housing_temperature=warm,
            reference=293.15,
        )  # fmt: skip
        return float(found)

    values = [play(293.15 + rise) for rise in (0.0, 15.0, 30.0, 60.0, 90.0)]
    assert np.all(np.diff(values[:3]) > 0.0)
    free = thermal_clearance(
        inner_raceway=one.inner_raceway,
        outer_raceway=one.inner_raceway + 2 * one.element_diameter + 20e-6,
        element_diameter=one.element_diameter,
        expansions=(STEEL.thermal_expansion,) * 3,
        temperatures=[90.0] * 3,
    )
    assert values[-1] == pytest.approx(float(free), rel=1e-9)  # loose: no influence left


def test_classes_rise_and_cover() -> None:
    for kind, bores in (
        ("ball", (12, 20, 25, 35, 45, 60, 75, 95)),
        ("roller", (25, 35, 45, 60, 75, 95)),
    ):
        for bore in bores:
            rows = np.array([class_clearance(kind, 1e-3 * bore, name) for name in CLASSES])
            assert np.all(np.diff(rows, axis=0) > 0.0)
            assert np.all(rows[:, 1] > rows[:, 0])
    assert class_clearance("ball", 30e-3, "CN") == pytest.approx((5e-6, 20e-6))
    assert class_clearance("ball", 30.1e-3, "CN") == pytest.approx((6e-6, 20e-6))
    assert class_clearance("ball", 100e-3, "C3") == pytest.approx((30e-6, 58e-6))
    for bad in ((8e-3, "CN"), (101e-3, "CN"), (25e-3, "CX")):
        with pytest.raises(InputError, match="clearance_class"):
            class_clearance("ball", *bad)


def test_contact_of_two_spheres_and_roller(compared: Compared) -> None:
    """A ball between two flats of the same law: k = 1 where both curvatures agree."""
    assert ellipse_ratio(0.0) == 1.0
    ratio = 8.0
    from scipy.special import ellipe, ellipk

    m = 1.0 - 1.0 / ratio**2
    difference = 1.0 - 2.0 / (ratio**2 - 1.0) * (ellipk(m) / ellipe(m) - 1.0)
    compared(
        "ratio of the ellipse", "its own equation", ellipse_ratio(difference) / ratio - 1, 1e-9
    )
    k = roller_coefficient(9e-3)
    palmgren = (3.84e-5 * 2.0) ** (-10 / 9) * 9.0 ** (8 / 9)
    compared(
        "roller between two races",
        "Palmgren, 3.8 % stiffer",
        k * 1e-3 ** (10 / 9) / palmgren - 1 / 1.038,
        0.02,
    )


def test_limits_of_a_bearing() -> None:
    one = catalogue_bearing("6205")
    assert float(rating_life(one, 1480.0)) == pytest.approx(1e9)
    assert float(rating_life(catalogue_bearing("NU206E"), 3900.0)) == pytest.approx(
        1e6 * 10 ** (10 / 3)
    )
    assert float(static_safety(one, 3900.0)) == pytest.approx(2.0)
    assert least_load(one) == pytest.approx(148.0)
    bare = replace(one, dynamic_rating=None, static_rating=None)
    assert np.isnan(float(rating_life(bare, 1.0)))
    assert np.isnan(float(static_safety(bare, 1.0)))
    assert np.isnan(least_load(bare))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"elements": 2}, "elements"),
        ({"elements": 20}, "element_diameter"),
        ({"pitch_diameter": 32e-3}, "pitch_diameter"),
        ({"kind": "needle"}, "kind"),
        ({"kind": "roller"}, "element_length"),
        ({"bore": -1.0}, "bore"),
        ({"conformities": (0.45, 0.53)}, "conformities"),
    ],
)
def test_impossible_bearings_are_refused(changes: dict[str, object], field: str) -> None:
    with pytest.raises(InputError, match=field):
        replace(catalogue_bearing("6205"), **changes)


def test_names_of_the_catalogue() -> None:
    for said in ("6205", "6205-2RS", "6205/C3", " 6205 2Z ", "nu206", "NU 206 E", "7206 B"):
        assert isinstance(catalogue_bearing(said), RollingBearing)
    with pytest.raises(InputError, match="6205"):
        catalogue_bearing("6250")
