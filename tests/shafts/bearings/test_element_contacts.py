"""Contacts and laws of rolling elements: Hertz's integrals, ISO 281's ratings, random laws."""

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad

from conftest import Compared
from sjovall import load_zone_integral
from thermogear.base.errors import InputError
from thermogear.shafts.bearings.catalogue import CATALOGUE, catalogue_bearing
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.bearings.hertz import (
    ball_coefficient,
    race_contact,
    roller_coefficient,
)
from thermogear.shafts.bearings.laws import ElementLaw

CASES = json.loads((Path(__file__).parents[1] / "truth.json").read_text())
RADIAL = [one for one in CATALOGUE.values() if one.kind == "ball" and one.contact_angle == 0.0]


def random_law(rng: np.random.Generator, clearance: float) -> ElementLaw:
    return ElementLaw(
        elements=int(rng.integers(5, 20)),
        coefficient=10 ** rng.uniform(8.5, 10.5),
        exponent=float(rng.choice([1.5, 10 / 9])),
        clearance=clearance,
        cage_angle=rng.uniform(0.0, 7.0),
    )


def test_truth_b1_from_far_away(compared: Compared) -> None:
    """Newton from 60 um beside the load, at the three cage angles."""
    case = CASES["B1"]
    p, away = case["params"], []
    push = np.array([p["load"], 0.0])
    for name, share in (("element_under_load", 0.0), ("gap_under_load", 1.0), ("quarter", 0.5)):
        law = ElementLaw(
            elements=p["elements"], coefficient=p["K"], exponent=p["exponent"],
            clearance=p["radial_clearance"], cage_angle=share * np.pi / p["elements"],
        )  # fmt: skip
        u = np.array([5e-5, 3e-5])
        for _ in range(60):
            u = u + np.linalg.solve(law.stiffness(u), law.force(u) + push)
        away.append((u - case["values"][name]) / np.linalg.norm(u))
    compared("journal in its elements, from afar", "truth B1", away, case["tolerance"])


def test_races_hold_hertz_by_quadrature(compared: Compared) -> None:
    """Both curvatures and the approach by their integrals over s, of principal radii, no F, no k.

    delta - A x^2 - B y^2 = p0 a b/(2 E*) int (1 - x^2/(a^2+s) - y^2/(b^2+s))
    /sqrt((a^2+s)(b^2+s)s) ds; with s = b^2 tan^2 u all three are smooth.
    """
    rng = np.random.default_rng(51)
    away = []
    for _ in range(25):
        ball, g, f = 10 ** rng.uniform(-2.6, -1.3), rng.uniform(0.08, 0.34), rng.uniform(0.505, 0.6)
        load, inner = 10 ** rng.uniform(0, 4), bool(rng.integers(2))
        race = ball / g * (1.0 - g if inner else -(1.0 + g)) / 2.0
        narrow, wide = 0.5 * (2 / ball + 1 / race), 0.5 * (2 / ball - 1 / (f * ball))
        one = race_contact(ball, diameter_ratio=g, conformity=f, inner=inner)
        a = one.half_length(load)
        b, p0 = a / one.ratio, one.pressure(load)
        whole = [
            quad(_kernel, 0.0, 0.5 * np.pi, args=(a, b, n), epsabs=0, epsrel=1e-12)[0]
            for n in range(3)
        ]
        size = p0 * a * b / (2.0 * one.modulus)
        known = np.array([one.deflection(load), wide, narrow])
        away.append(size * np.array(whole) / known - 1.0)
        assert p0 == pytest.approx(1.5 * load / (np.pi * a * b), rel=1e-12)
    compared("ball on a race", "Hertz's integrals by quadrature", away, 1e-9)


def _kernel(u: float, a: float, b: float, which: int) -> float:
    """ds/sqrt((a^2+s)(b^2+s)s), over nothing, a^2+s or b^2+s, with s = b^2 tan^2 u."""
    cos2 = np.cos(u) ** 2
    long = a**2 * cos2 + b**2 * np.sin(u) ** 2  # (a^2 + s) cos^2 u
    return float(2.0 / np.sqrt(long) * (1.0, cos2 / long, cos2 / b**2)[which])


def test_stiffness_follows_the_root_of_the_ball(compared: Compared) -> None:
    """98 430 sqrt(D_w) N/mm^1.5 at f 0.52/0.53 and 210 GPa; what conformity changes."""

    def scaled(one: RollingBearing, f: tuple[float, float] = (0.52, 0.53)) -> float:
        k = ball_coefficient(
            one.element_diameter, diameter_ratio=one.ratio, conformities=f, youngs_modulus=210e9
        )
        return k * 1e-3**1.5 / np.sqrt(1e3 * one.element_diameter)

    compared(
        "K_b of the radial balls",
        "98 430 sqrt(D_w)",
        [scaled(one) / 98430.0 - 1.0 for one in RADIAL if one.ratio > 0.2],
        1e-3,
    )
    base = catalogue_bearing("6205")
    shares = [scaled(base, f) / scaled(base) - 1.0 for f in ((0.515, 0.525), (0.53, 0.53))]
    compared("K_b by conformity", "+8 and -7 %", np.array(shares) - [0.08, -0.07], 5e-3)


def test_ellipse_near_the_customary_fits(compared: Compared) -> None:
    """Brewe-Hamrock is +1.7 % off at the inner race in K, -0.2 % at the outer."""
    one, found = catalogue_bearing("6205"), []
    for inner, f in ((True, 0.52), (False, 0.53)):
        exact = race_contact(
            one.element_diameter, diameter_ratio=one.ratio, conformity=f, inner=inner
        )
        q = one.ratio / (1 - one.ratio) if inner else -one.ratio / (1 + one.ratio)
        r = 2.0 * (1.0 + q) / (2.0 - 1.0 / f)
        k, e, first = 1.0339 * r**0.636, 1.0003 + 0.5968 / r, 1.5277 + 0.6023 * np.log(r)
        a = np.cbrt(3.0 * k**2 * e / (np.pi * exact.curvature * exact.modulus))
        found.append((1.5 * first / (np.pi * exact.modulus * a) / exact.deflection(1.0)) ** -1.5)
    compared("K of a race", "Brewe and Hamrock", np.array(found) - [1.017, 0.998], 1e-3)


def rating_factor(g: float) -> float:
    """f_c of ISO 281 by Lundberg and Palmgren with 0.95."""
    other = 1.04 * ((1.0 - g) / (1.0 + g)) ** 1.72
    form = g**0.3 * (1.0 - g) ** 1.39 / (1.0 + g) ** (1 / 3)
    return float(0.95 * 39.9 * (1.0 + other ** (10 / 3)) ** -0.3 * form * (1.04 / 0.04) ** 0.41)


def maker_over_rated(one: RollingBearing) -> float:
    """Makers' C over ISO 281's 1.3 f_c Z^(2/3) D_w^1.8, D_w in mm."""
    rated = 1.3 * rating_factor(one.ratio) * one.elements ** (2 / 3)
    return float(one.dynamic_rating or 0.0) / (rated * (1e3 * one.element_diameter) ** 1.8)


def test_ratings_close_by_iso_281(compared: Compared) -> None:
    """Makers' C lies above 1.3 f_c Z^(2/3) D_w^1.8."""
    table = {0.16: 59.1, 0.20: 59.5, 0.24: 58.5, 0.30: 55.5}
    compared("f_c", "ISO 281", [rating_factor(g) / v - 1.0 for g, v in table.items()], 2e-3)
    for one in RADIAL:
        assert 1.045 < maker_over_rated(one) < 1.067, one.designation


def test_both_ratings_leave_one_number_of_balls() -> None:
    """C and C0 of series 62 are met by one whole number of balls of a size in steps of 1/64 inch.

    A ball of 1/64 inch more changes C by some 5 %, one ball more by some 7 %: C alone is met by
    several, C0 (4200 MPa under 5 C0/Z) by others.
    """

    def closed(given: RollingBearing) -> list[tuple[int, float]]:
        found = []
        for balls, steps in itertools.product(range(7, 14), range(16, 80)):
            size = 25.4e-3 / 64 * steps
            if size >= 0.99 * given.pitch_diameter * np.sin(np.pi / balls):
                continue  # they do not fit on the circle
            if size >= min(0.45 * (given.outside_diameter - given.bore), given.width):
                continue  # no ring is left
            one = replace(given, elements=balls, element_diameter=size)
            if not 1.045 < maker_over_rated(one) < 1.067:
                continue
            heaviest = race_contact(
                size, diameter_ratio=one.ratio, conformity=0.52, inner=True, youngs_modulus=207e9
            ).pressure(5.0 * float(one.static_rating or 0.0) / balls)
            if abs(heaviest / 4200e6 - 1.0) < 3e-3:
                found.append((balls, round(1e3 * size, 2)))
        return found

    series = [one for one in RADIAL if one.designation.startswith("62")]
    assert [one.bore for one in series][-1] == pytest.approx(100e-3)
    for one in series:
        known = (one.elements, round(1e3 * one.element_diameter, 2))
        assert closed(one) == [pytest.approx(known, abs=0.011)], one.designation


def test_raceways_lie_where_the_rings_expect_them() -> None:
    for one in RADIAL:
        d, outside = one.bore, one.outside_diameter
        near = max(0.41e-3, 0.018 * (outside - d))
        assert one.inner_raceway == pytest.approx((4 * d + outside) / 5, abs=near)
        assert one.outer_raceway == pytest.approx((d + 4 * outside) / 5, abs=near)
    for one in CATALOGUE.values():
        # a ring of that size and steel weighs its share of a whole ring
        whole = 7800.0 * 0.25 * np.pi * one.width * (one.outside_diameter**2 - one.bore**2)
        assert 0.1 < one.outer_ring_mass / whole < 0.5


def test_many_elements_are_sjovalls_integral(compared: Compared) -> None:
    """F = Z K (x - c_r)^n J_r(eps), eps from a narrow zone to deep in preload."""
    rng = np.random.default_rng(52)
    away = []
    for _ in range(40):
        clearance, x = rng.uniform(-2e-5, 2e-5), rng.uniform(2.5e-5, 6e-5)
        law = ElementLaw(
            elements=4000, coefficient=1e9, exponent=float(rng.choice([1.5, 10 / 9])),
            clearance=clearance,
        )  # fmt: skip
        zone = 0.5 * (1.0 - clearance / x)
        known = (
            4000
            * 1e9
            * (x - clearance) ** law.exponent
            * load_zone_integral(zone, exponent=law.exponent)
        )
        away.append(-law.force([x, 0.0])[0] / known - 1.0)
    compared("4000 elements", "Sjovall's load zone", away, 2e-6)
    heaviest = [1.0 / load_zone_integral(0.5, exponent=n) for n in (1.5, 10 / 9)]
    compared("Q_max Z/F without clearance", "4.37, 4.08", np.array(heaviest) - [4.37, 4.08], 6e-3)


def test_direction_matters_less_the_more_elements(compared: Compared) -> None:
    """The spread of |F| over direction falls as Z^-(n+1): each element's force has a kink of n."""
    angles = np.linspace(0.0, 2.0 * np.pi, 500)
    u = 2.5e-5 * np.stack([np.cos(angles), np.sin(angles)], axis=-1)
    counts = np.array([9, 10, 18, 20, 36, 72, 144])
    finest = []
    for clearance in (0.0, 5e-6):
        spreads = []
        for count in counts:
            law = ElementLaw(elements=int(count), coefficient=1e9, clearance=clearance)
            size = np.linalg.norm(law.force(u), axis=-1)
            spreads.append(np.ptp(size) / size.mean())
        assert np.all(np.array(spreads) * counts**2.5 < 4.0)
        finest.append(spreads[-1])
    compared("force of 144 elements over direction", "one force", finest, 1e-5)


def test_random_tangents_are_derivatives_away_from_a_first_touch(compared: Compared) -> None:
    rng = np.random.default_rng(53)
    away, drawn = [], 0
    while drawn < 50:
        law = random_law(rng, rng.uniform(-2e-5, 2e-5))
        u = rng.uniform(-5e-5, 5e-5, 2)
        deep = law.directions @ u - law.clearance
        if np.abs(deep).min() < 3e-7 or deep.max() < 0.0:
            continue
        drawn += 1

        def slope(h: float, law: ElementLaw = law, u: np.ndarray = u) -> np.ndarray:
            sides = [law.force(u + h * e) - law.force(u - h * e) for e in np.eye(2)]
            return np.stack(sides, axis=-1) / (2.0 * h)

        h = 1e-8
        k = law.stiffness(u)
        away.append(np.abs((4.0 * slope(h) - slope(2.0 * h)) / 3.0 + k).max() / np.abs(k).max())
        assert k[0, 1] == pytest.approx(k[1, 0], abs=1e-12 * np.abs(k).max())
        assert np.linalg.eigvalsh(k).min() > -1e-12 * np.abs(k).max()
    compared("tangent of 50 random laws", "difference of the force", away, 1e-6)


def test_elements_turn_with_the_cage_and_store_energy(compared: Compared) -> None:
    """Cage and displacement turned together turn the force; a closed path takes no work."""
    rng = np.random.default_rng(54)
    turned, work = [], []
    for _ in range(20):
        law, angle = random_law(rng, rng.uniform(-1e-5, 1e-5)), rng.uniform(0.0, 7.0)
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        other = ElementLaw(
            elements=law.elements, coefficient=law.coefficient, exponent=law.exponent,
            clearance=law.clearance, cage_angle=law.cage_angle + angle,
        )  # fmt: skip
        u = rng.uniform(-4e-5, 4e-5, 2)
        size = np.abs(law.loads(u)).sum() + 1e-12
        turned.append(np.abs(other.force(turn @ u) - turn @ law.force(u)).max() / size)
        t = np.linspace(0.0, 2.0 * np.pi, 4001)[:-1]
        path = 3e-5 * np.stack([np.cos(t), 0.5 * np.sin(t)], axis=-1) + u
        speed = 3e-5 * np.stack([-np.sin(t), 0.5 * np.cos(t)], axis=-1)
        power = np.sum(law.force(path) * speed, axis=-1)
        work.append(abs(power.mean()) / np.abs(power).max())
    compared("bearing turned as a whole", "its force turned", turned, 1e-9)
    compared("work around a closed path", "none", work, 1e-6)


def test_preload_is_even_and_leaves_no_dead_zone(compared: Compared) -> None:
    rng = np.random.default_rng(55)
    away = []
    for _ in range(30):
        law = random_law(rng, -(10 ** rng.uniform(-6.3, -4.7)))
        k = law.stiffness([0.0, 0.0])
        size = law.exponent * law.coefficient * (-law.clearance) ** (law.exponent - 1.0)
        away.append(np.abs(k / (0.5 * law.elements * size) - np.eye(2)).max())
        assert np.abs(law.force([0.0, 0.0])).max() < 1e-12 * law.loads([0.0, 0.0]).sum()
    compared("preloaded at rest", "n K |c|^(n-1) Z/2 in every direction", away, 1e-12)


def test_a_roller_bearing_over_its_cage(compared: Compared) -> None:
    """NU206E under 500 N: 427 N/um; with 10 um of radial clearance 347 and 267."""
    one = catalogue_bearing("NU206E")
    load, found = np.array([500.0, 0.0]), []
    for clearance, angle in ((0.0, 0.0), (1e-5, 0.0), (1e-5, np.pi / 13)):
        law, u = one.law(clearance, angle), np.array([clearance + 2e-6, 0.0])
        for _ in range(40):
            u = u + np.linalg.solve(law.stiffness(u), law.force(u) + load)
        assert np.abs(law.force(u) + load).max() < 1e-8
        found.append(1e-6 * law.stiffness(u)[0, 0])
    compared("NU206E, N/um", "a recomputed table", np.array(found) - [427, 347, 267], 0.6, "N/um")
    palmgren = (2.0 * 3.84e-5) ** (-10 / 9) * 9.0 ** (8 / 9) / (1e-3 ** (10 / 9))
    stiffer = palmgren / roller_coefficient(9e-3)
    # deflections are 3.4 % apart, stiffnesses their power 10/9
    compared("Palmgren's roller", "3.8 % stiffer than ISO 16281's", stiffer - 1.038, 5e-4)


def test_suffixes_do_not_hide_a_bearing() -> None:
    said = {
        "6205": "6205-2RS1/C3 6205ZZC3 6205.2RSR.C3 6205-2Z/C3WT 6205-2RSH/C3GJN 6205LLUC3/5K "
        "6205DDU 6205-2RS-P6 6205TN9 62052Z",
        "NU206E": "NU206ECP/C3 nu206e NU-206-E-TVP2 NU206ECML NU206",
        "NU2206E": "NU2206ECPH NU2206-E",
        "7206B": "7206B-TVP 7206-B",
    }
    for name, ways in said.items():
        for way in ways.split():
            assert catalogue_bearing(way).designation == name, way
    # another inside: reinforced, another angle or series, or nothing at all
    for other in ("6205ETN9", "7206", "7206C", "16205", "6302Z", "NU305ECP", "", "/C3"):
        with pytest.raises(InputError, match="type") as told:
            catalogue_bearing(other)
        assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("name", "changes", "field"),
    [
        ("6205", {"contact_angle": 1.0}, "contact_angle"),
        ("6205", {"contact_angle": float("nan")}, "contact_angle"),
        ("6205", {"width": 5e-3}, "element_diameter"),
        ("6205", {"dynamic_rating": -1.0}, "dynamic_rating"),
        ("6205", {"static_rating": float("inf")}, "static_rating"),
        ("6205", {"pitch_diameter": 45e-3}, "pitch_diameter"),
        ("6205", {"outside_diameter": float("nan")}, "outside_diameter"),
        ("NU206E", {"element_length": 17e-3}, "element_length"),
        ("NU206E", {"element_length": 0.0}, "element_length"),
    ],
)
def test_more_impossible_bearings(name: str, changes: dict[str, float], field: str) -> None:
    with pytest.raises(InputError, match=field) as told:
        replace(catalogue_bearing(name), **changes)  # type: ignore[arg-type]
    assert "\n" not in str(told.value)
