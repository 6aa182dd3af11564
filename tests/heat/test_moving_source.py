"""The exact moving source: published table, closed forms, two bodies against Blok."""

import dataclasses

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import k0e
from two_bodies import exact_flash, exact_two_body, kernel_integral

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS
from thermogear.heat.moving_source import (
    flash_temperature,
    moving_source_rise,
    peclet_factor,
    peclet_flash,
)
from thermogear.heat.temperature import (
    FLASH_FACTORS,
    blok_flash,
    flank_exchange,
)

STEEL = MATERIALS["steel"]
DIFFUSIVITY = STEEL.thermal_conductivity / (STEEL.density * STEEL.specific_heat)
PECLET = (0.1, 0.2, 0.5, 1, 5, 10, 20, 50, 100, 1000)
TABLE = {
    "uniform": (
        *(0.41534, 0.49201, 0.58931, 0.65209, 0.74560),
        *(0.76628, 0.77927, 0.78891, 0.79281, 0.79717),
    ),
    "ellipse": (
        *(0.43419, 0.51746, 0.62401, 0.69126, 0.77370),
        *(0.78279, 0.78527, 0.78588, 0.78596, 0.78598),
    ),
    "parabola": (
        *(0.44808, 0.53662, 0.65187, 0.72584, 0.81619),
        *(0.82563, 0.82830, 0.82905, 0.82915, 0.82919),
    ),
}


@pytest.mark.parametrize("distribution", TABLE)
def test_published_factors(distribution: str, compared: Compared) -> None:
    """C(Pe) over Pe 0.1 .. 1000, to the table's last digit."""
    compared(
        "flash factor C(Pe), Pe 0.1 to 1000",
        "computed apart",
        peclet_factor(PECLET, distribution) - np.array(TABLE[distribution]),
        6e-6,
    )


def test_the_stored_maxima_are_those_of_the_rise() -> None:
    from thermogear.heat import moving_source

    solved = moving_source._solved_maxima("ellipse")
    assert pytest.approx(solved, rel=1e-12) == moving_source._MAXIMA


@pytest.mark.parametrize("distribution", TABLE)
def test_the_spline_is_that_of_the_library(distribution: str) -> None:
    """A cubic with a continuous second derivative, not-a-knot at its ends."""
    from scipy.interpolate import CubicSpline

    from thermogear.heat import moving_source

    knots, probe = moving_source._KNOTS, np.geomspace(1e-4, 1e5, 301)
    spline = CubicSpline(knots, moving_source._solved_maxima(distribution))
    expected = spline(np.log(probe))
    np.testing.assert_allclose(peclet_factor(probe, distribution), expected, rtol=1e-13)


@pytest.mark.parametrize("distribution", TABLE)
def test_limits_of_the_factor(distribution: str) -> None:
    fast = peclet_factor([1e5, 1e9], distribution)
    assert fast == pytest.approx(np.full(2, FLASH_FACTORS[distribution]), rel=2e-5)
    assert peclet_factor(0.0, distribution) == 0.0
    # slow: C -> sqrt(Pe) (A - ln Pe)/pi, and the two branches meet
    slow = np.array([1e-8, 1e-6, 0.99e-4, 1.01e-4])
    level = np.pi * peclet_factor(slow, distribution) / np.sqrt(slow) + np.log(slow)
    assert np.ptp(level) < 2e-3
    grid = np.geomspace(1e-7, 1e6, 200)
    assert np.all(np.diff(peclet_factor(grid, distribution)) > -1e-9)


@pytest.mark.parametrize("peclet", [0.3, 4.0, 60.0])
@pytest.mark.parametrize("x", [-0.7, 0.1, 0.95, 1.0])
def test_rise_against_adaptive_quadrature(x: float, peclet: float, compared: Compared) -> None:
    """The ellipse with each side's singularities taken out by substitution."""

    def profile(s: float) -> float:
        return 2.0 / np.pi * np.sqrt(max(0.0, 1.0 - s * s))

    def behind(t: float) -> float:  # s = x - t^2
        return float(2.0 * t * profile(x - t * t) * k0e(0.5 * peclet * t * t))

    def ahead(t: float) -> float:
        d = t * t
        return float(2.0 * t * profile(x + d) * k0e(0.5 * peclet * d) * np.exp(-peclet * d))

    total = quad(behind, 0.0, np.sqrt(1.0 + x), epsabs=1e-12)[0]
    total += quad(ahead, 0.0, np.sqrt(1.0 - x), epsabs=1e-12)[0] if x < 1.0 else 0.0
    expected = np.sqrt(peclet) / np.pi * total
    compared(
        "rise under a moving source",
        "adaptive quadrature",
        float(moving_source_rise(x, peclet=peclet)) / expected - 1.0,
        1e-7,
    )


def test_rise_of_a_fast_source_is_bloks_integral() -> None:
    """Uniform band, Pe -> infinity: sqrt((1+x)/pi)."""
    x = np.linspace(-0.9, 1.0, 9)
    exact = moving_source_rise(x, peclet=1e6, distribution="uniform")
    assert exact == pytest.approx(np.sqrt((1.0 + x) / np.pi), rel=1e-3)


TWO = [  # Pe of both flanks, Blok's error in percent (published)
    (20, 10, 0.21),
    (10, 5, 0.87),
    (10, 2, 2.2),
    (5, 2.5, 2.9),
    (50, 2, 0.86),
    (2, 1, 9.4),
    (1, 0.5, 19.0),
]


@pytest.mark.parametrize(("one", "two", "error"), TWO)
def test_blok_against_pointwise_equal_temperatures(
    one: float, two: float, error: float, compared: Compared
) -> None:
    peak, share = exact_two_body(peclet_1=one, peclet_2=two)
    blok = FLASH_FACTORS["ellipse"] / (np.sqrt(one) + np.sqrt(two))
    compared(
        "error of Blok's formula for two bodies",
        "boundary elements computed apart",
        blok / peak - 1.0 - 0.01 * error,
        2e-3,
    )
    if min(one, two) >= 5:
        simple = np.sqrt(one) / (np.sqrt(one) + np.sqrt(two))
        assert share == pytest.approx(simple, abs=1e-3)


def test_two_equal_bodies_halve_the_heat_and_meet_the_single_source() -> None:
    peak, share = exact_two_body(peclet_1=8.0, peclet_2=8.0)
    assert share == pytest.approx(0.5, abs=1e-12)
    single = float(peclet_factor(8.0)) / np.sqrt(8.0)
    assert peak == pytest.approx(0.5 * single, rel=1e-4)


def test_more_elements_change_nothing() -> None:
    coarse, fine = (
        exact_two_body(peclet_1=20.0, peclet_2=2.0, elements=200),
        exact_two_body(peclet_1=20.0, peclet_2=2.0, elements=800),
    )
    assert coarse[0] == pytest.approx(fine[0], rel=2e-4)
    assert coarse[1] == pytest.approx(fine[1], abs=1e-4)


def test_exchanging_the_bodies_exchanges_the_shares() -> None:
    one, two = (
        exact_two_body(peclet_1=12.0, peclet_2=3.0),
        exact_two_body(peclet_1=3.0, peclet_2=12.0),
    )
    assert one[0] == pytest.approx(two[0], rel=1e-10)
    assert one[1] + two[1] == pytest.approx(1.0, abs=1e-10)


def point(pe_1: float, pe_2: float) -> dict[str, object]:
    width = 190e-6
    return {
        "friction": 0.06,
        "line_load": 2e5,
        "speed_1": pe_1 * DIFFUSIVITY / width,
        "speed_2": pe_2 * DIFFUSIVITY / width,
        "half_width": width,
        "material_1": STEEL,
        "material_2": STEEL,
    }


@pytest.mark.parametrize(("one", "two"), [(200.0, 100.0), (20.0, 10.0), (10.0, 2.0), (2.0, 1.0)])
def test_three_methods_in_their_order(one: float, two: float) -> None:
    """Blok is on the safe side of the exact value; the correction lies close to it."""
    given = point(one, two)
    blok, corrected = (float(flash_temperature(**given, method=m)) for m in ("blok", "peclet"))
    exact = exact_flash(**given)  # type: ignore[arg-type]
    assert blok >= exact * (1.0 - 1e-4)
    assert corrected == pytest.approx(exact, rel=1.5e-2)
    if min(one, two) >= 10:
        assert blok == pytest.approx(exact, rel=1e-2)


def test_methods_agree_for_fast_flanks_and_vanish_together() -> None:
    given = point(3e4, 2e4)
    blok, corrected = (float(flash_temperature(**given, method=m)) for m in ("blok", "peclet"))
    assert corrected == pytest.approx(blok, rel=1e-4)
    still = {**given, "speed_2": given["speed_1"]}
    for method in ("blok", "peclet"):
        assert flash_temperature(**still, method=method) == 0.0
        rest = {**given, "speed_1": 0.0, "speed_2": 0.0}
        assert flash_temperature(**rest, method=method) == 0.0
        assert flash_temperature(**{**given, "line_load": 0.0}, method=method) == 0.0


def test_unlike_materials_and_a_flank_at_rest() -> None:
    """Fast flanks of unlike thermal data follow Blok; one at rest leaves the heat to the other."""
    bronze = dataclasses.replace(STEEL, thermal_conductivity=90.0, density=8800.0)
    given = {**point(2000.0, 900.0), "material_2": bronze}
    blok, corrected = (float(flash_temperature(**given, method=m)) for m in ("blok", "peclet"))
    exact = exact_flash(**given)  # type: ignore[arg-type]
    assert corrected == pytest.approx(blok, rel=1e-3)
    assert exact == pytest.approx(blok, rel=2e-3)
    still = {**point(20.0, 1.0), "speed_2": 0.0}
    lone, pair = float(flash_temperature(**still)), exact_flash(**still)  # type: ignore[arg-type]
    single = float(peclet_factor(20.0)) / np.sqrt(20.0)
    heat = 0.06 * 2e5 * float(still["speed_1"])  # type: ignore[arg-type]
    assert lone == pytest.approx(single * heat / STEEL.thermal_conductivity, rel=1e-6)
    assert pair == pytest.approx(lone, rel=0.1)


def test_blok_method_is_bloks_formula() -> None:
    given = point(30.0, 20.0)
    plain = blok_flash(
        given["friction"],  # type: ignore[arg-type]
        given["line_load"],  # type: ignore[arg-type]
        speed_1=given["speed_1"],  # type: ignore[arg-type]
        speed_2=given["speed_2"],  # type: ignore[arg-type]
        half_width=given["half_width"],  # type: ignore[arg-type]
        contact_coefficient_1=STEEL.thermal_contact_coefficient,
        contact_coefficient_2=STEEL.thermal_contact_coefficient,
    )
    assert flash_temperature(**given, method="blok") == plain


def test_batch_is_one_by_one() -> None:
    v1 = np.linspace(0.5, 3.0, 4)
    heat = np.array([[1e4], [2e4]])
    batch = peclet_flash(
        heat, speed_1=v1, speed_2=1.5, half_width=190e-6, material_1=STEEL, material_2=STEEL
    )
    assert batch.shape == (2, 4)
    for i in range(2):
        for j in range(4):
            single = peclet_flash(
                heat[i, 0],
                speed_1=v1[j],
                speed_2=1.5,
                half_width=190e-6,
                material_1=STEEL,
                material_2=STEEL,
            )
            assert batch[i, j] == pytest.approx(float(single), rel=1e-12)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: peclet_factor(-1.0), "peclet: got -1.0; allowed >= 0"),
        (lambda: moving_source_rise(0.0, peclet=0.0), "peclet: got 0.0; allowed > 0"),
        (lambda: peclet_factor(1.0, "elipse"), "distribution: got 'elipse'"),
        (
            lambda: flash_temperature(**point(2.0, 1.0), method="bloc"),
            "method: got 'bloc'; allowed blok | peclet",
        ),
    ],
)
def test_impossible_input_is_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)


def test_exchange_of_two_flanks_against_boundary_elements() -> None:
    """A band held at one temperature between bodies a kelvin apart, finite Peclet numbers."""
    edges = -np.cos(np.linspace(0.0, np.pi, 401))
    centres, width = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)

    def rise(peclet: float) -> np.ndarray:
        reach = kernel_integral(centres[:, None] - edges[None, :], peclet)
        return (reach[:, :-1] - reach[:, 1:]) / np.pi

    for one, other, low in ((1000.0, 1000.0, 3e-4), (40.0, 40.0, 0.004), (5.0, 2.5, 0.04)):
        exact = np.sum(np.linalg.solve(rise(one) + rise(other), np.ones(400)) * width)
        # lengths in half widths, k = 1: B sqrt(v) is sqrt(Pe)
        found = flank_exchange(
            1.0, speed_1=one, speed_2=other, contact_coefficient_1=1.0, contact_coefficient_2=1.0
        )
        assert 1.0 - low < found / exact < 1.0 + 1e-4
