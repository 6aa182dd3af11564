"""Film thickness: published figures, limits, spread between the formulas."""

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import ZERO_CELSIUS, Lubricant, lubricant
from thermogear.heat.film import (
    FILM_LAWS,
    dowson_higginson_minimum,
    film_parameter,
    film_thickness,
    grubin_central,
    iso_15144_film,
    pressure_viscosity,
    pressure_viscosity_gold,
    pressure_viscosity_iso,
    regime,
    regime_shares,
    thermal_reduction,
)

EP = 206e9 / (1.0 - 0.3**2)
FZG = {  # FZG C pitch point, VG 100 mineral at 60 C: U 3.92e-11, G 3740, W 2.23e-4
    "line_load": 422.29e3,
    "entrainment": 2.19446,
    "viscosity": 0.033865,
    "coefficient": 3735.4 / EP,
    "reduced_radius": 8.38224e-3,
    "modulus": EP,
}


def test_published_groups_and_films_of_fzg_c(compared: Compared) -> None:
    """h_min 0.292 um by Dowson and Higginson, h_c 0.376 um by Grubin."""
    speed = FZG["viscosity"] * FZG["entrainment"] / (EP * FZG["reduced_radius"])
    load = FZG["line_load"] / (EP * FZG["reduced_radius"])
    assert speed == pytest.approx(3.92e-11, rel=2e-3)
    assert load == pytest.approx(2.23e-4, rel=3e-3)
    films = [
        dowson_higginson_minimum(**FZG) / 0.292e-6 - 1.0,
        grubin_central(**FZG) / 0.376e-6 - 1.0,
    ]
    compared("film thickness of the FZG C gears, two laws", "computed apart", films, 2e-3)


@pytest.mark.parametrize(
    ("law", "speed", "load"),
    [("dowson-higginson", 0.70, 0.13), ("grubin", 8 / 11, 1 / 11), ("iso-15144", 0.70, 0.13)],
)
def test_powers_of_speed_and_load(law: str, speed: float, load: float) -> None:
    base = film_thickness(**FZG, law=law)
    faster = film_thickness(**{**FZG, "entrainment": 2.0 * FZG["entrainment"]}, law=law)
    heavier = film_thickness(**{**FZG, "line_load": 2.0 * FZG["line_load"]}, law=law)
    assert faster / base == pytest.approx(2.0**speed, rel=1e-12)
    assert heavier / base == pytest.approx(2.0**-load, rel=1e-12)


def test_grubin_in_textbook_form() -> None:
    """h/R = 1.95 (eta v alpha/R)^(8/11) (E' R/w)^(1/11)."""
    radius = FZG["reduced_radius"]
    group = FZG["viscosity"] * FZG["entrainment"] * FZG["coefficient"] / radius
    expected = 1.95 * group ** (8 / 11) * (EP * radius / FZG["line_load"]) ** (1 / 11) * radius
    assert grubin_central(**FZG) == pytest.approx(expected, rel=1e-12)


def test_iso_film_in_the_units_of_the_standard() -> None:
    """h um = 1600 rho G^0.6 U^0.7 W^-0.13 S^0.22, rho mm, W = 2 pi p^2/E'^2."""
    radius_mm, modulus = FZG["reduced_radius"] * 1e3, EP * 1e-6
    u = FZG["viscosity"] * 2.0 * FZG["entrainment"] / (2000.0 * modulus * radius_mm)
    g = FZG["coefficient"] * 1e6 * modulus
    pressure = np.sqrt(FZG["line_load"] * (EP / 2.0) / (np.pi * FZG["reduced_radius"])) * 1e-6
    w = 2.0 * np.pi * pressure**2 / modulus**2
    expected = 1600.0 * radius_mm * g**0.6 * u**0.7 * w**-0.13 * 0.5**0.22
    assert iso_15144_film(**FZG, sliding_parameter=0.5) * 1e6 == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("law", FILM_LAWS)
def test_no_speed_no_film_and_no_load_no_end_of_it(law: str) -> None:
    assert film_thickness(**{**FZG, "entrainment": 0.0}, law=law) == 0.0
    assert film_thickness(**{**FZG, "line_load": 0.0}, law=law) == np.inf
    assert film_thickness(**{**FZG, "line_load": 0.0, "entrainment": 0.0}, law=law) == 0.0


def test_batch_and_thermal_factor() -> None:
    speeds = np.array([[0.5], [1.0]]) * np.array([1.0, 2.0, 3.0])
    batch = film_thickness(**{**FZG, "entrainment": speeds}, thermal_factor=0.9)
    single = [
        [0.9 * float(film_thickness(**{**FZG, "entrainment": v})) for v in row] for row in speeds
    ]
    assert batch == pytest.approx(np.array(single), rel=1e-13)


def test_unknown_film_law_says_the_nearest() -> None:
    with pytest.raises(InputError, match=r"did you mean 'dowson-higginson'\?$"):
        film_thickness(**FZG, law="dowson-higinson")


def test_thermal_factor_is_one_formula_in_two_prints() -> None:
    """0.1 with the sum speed is 0.243 (printed 0.241) with the mean speed."""
    speed, slip, eta, beta, k = 10.0, 0.4, 0.03, 0.04, 0.14
    mean = 1.0 + 14.8 * slip**0.83
    mean = 1.0 / (1.0 + 0.1 * 4.0**0.64 * mean * (beta * eta * speed**2 / k) ** 0.64)
    assert thermal_reduction(speed, slip, eta, beta, k) == pytest.approx(mean, rel=1e-12)
    by_mean_speed = 0.1 * 4.0**0.64
    assert by_mean_speed == pytest.approx(0.243, abs=5e-4)
    assert thermal_reduction(0.0, slip, eta, beta, k) == 1.0


MEASURED = [  # eta mPa s at 30, 60, 100 C; alpha 1e-9/Pa (Stachowiak and Batchelor, table 2.3)
    ((18.6, 6.3, 2.4), (20, 16, 13)),
    ((45, 12, 3.9), (28, 20, 16)),
    ((107, 23.3, 6.4), (29.6, 22.8, 17.8)),
    ((122, 26.3, 7.3), (27, 21.6, 17.5)),
    ((171, 31, 7.5), (28, 23, 18)),
    ((30.7, 8.6, 3.1), (25.7, 20.3, 15.4)),
    ((165, 30, 6.8), (33, 23.8, 16)),
    ((310, 44.2, 9.4), (34.6, 26.3, 19.5)),
    ((2000, 180, 24), (41.5, 29.4, 25)),
]


def test_pressure_viscosity_against_measured_mineral_oils() -> None:
    """Both correlations are about a quarter low, hence 15 % in the film."""
    gold, iso, found = [], [], []
    for viscosities, alphas in MEASURED:
        points = [
            (t + 273.15, v * 1e-3 / 870.0) for t, v in zip((30, 100), viscosities[::2], strict=True)
        ]
        line = Lubricant.from_two_points("oil", points[0], points[1], density_15=870.0)
        eta_38 = 870e-6 * (
            10 ** (10 ** (line.walther_a - line.walther_b * np.log10(273.15 + 38.0))) - 0.7
        )
        for celsius, eta, alpha in zip((30, 60, 100), viscosities, alphas, strict=True):
            gold.append(float(pressure_viscosity_gold(eta * 1e-3 / 870.0)))
            iso.append(float(pressure_viscosity_iso(eta_38, celsius + 273.15)))
            found.append(alpha * 1e-9)
    for computed in (gold, iso):
        error = np.array(computed) / np.array(found) - 1.0
        assert -0.30 < float(np.mean(error)) < -0.19
        assert float(np.sqrt(np.mean(error**2))) < 0.30


def test_pressure_viscosity_of_named_oils() -> None:
    warm = ZERO_CELSIUS + 60.0
    mineral, pao = (float(pressure_viscosity(lubricant(n), warm)) for n in ("M100", "P100"))
    assert 1.0e-8 < pao < mineral < 2.2e-8
    assert pressure_viscosity_iso(0.05, 311.0) == pytest.approx(2.657e-8 * 0.05**0.1348)
    with pytest.raises(InputError, match=r"^lubricant.kind: got 'water'; allowed mineral"):
        pressure_viscosity_gold(1e-5, "water")


def test_pressure_viscosity_in_the_units_of_its_sources() -> None:
    """Gold: s nu^t 1e-9 with mm^2/s. ISO: alpha_38 [1 + 516 (1/T - 1/311)]."""
    gold = {"mineral": (9.904, 0.1390), "pao": (7.382, 0.1335)}
    gold |= {"pag": (5.489, 0.1485), "ester": (6.605, 0.1360)}
    for kind, (s, t) in gold.items():
        assert pressure_viscosity_gold(39.2e-6, kind) == pytest.approx(s * 39.2**t * 1e-9)
    for kind, (c, e) in {"pao": (1.466e-8, 0.0507), "pag": (1.392e-8, 0.1572)}.items():
        expected = c * 0.08**e * (1.0 + 516.0 * (1.0 / 350.0 - 1.0 / 311.0))
        assert pressure_viscosity_iso(0.08, 350.0, kind) == pytest.approx(expected, rel=1e-12)
    assert pressure_viscosity_iso(0.08, 800.0) == 0.0


def test_film_parameter_and_regime() -> None:
    values = film_parameter([0.2e-6, 1e-6, 3e-6], roughness_1=0.3e-6, roughness_2=0.4e-6)
    assert values == pytest.approx([0.4, 2.0, 6.0])
    assert regime(values).tolist() == [0, 1, 2]
    assert regime([1.0, 3.0, 1e9, np.inf]).tolist() == [1, 2, 2, 3]
    with pytest.raises(InputError, match=r"^roughness: got 0.0; allowed > 0 m"):
        film_parameter(1e-6, roughness_1=0.0, roughness_2=0.0)


def test_shares_of_the_path() -> None:
    shares = regime_shares([[0.5, 0.6, 1.5, 4.0], [5.0, 5.0, 5.0, np.inf]])
    assert shares.tolist() == [[0.5, 0.25, 0.25, 0.0], [0.0, 0.0, 0.75, 0.25]]
