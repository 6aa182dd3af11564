"""Materials and lubricants: named sets against published values, refusals in one line."""

import dataclasses

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import (
    LUBRICANTS,
    MATERIALS,
    ZERO_CELSIUS,
    Lubricant,
    lubricant,
    material,
)


def walther(oil: Lubricant, celsius: float) -> float:
    """nu [mm^2/s], written out from the standard."""
    return 10 ** (10 ** (oil.walther_a - oil.walther_b * np.log10(celsius + 273.15))) - 0.7


@pytest.mark.parametrize(
    ("name", "grade"), [(n, float(n[1:])) for n in LUBRICANTS if n[0] in "MP"] + [("FVA3", 100.0)]
)
def test_every_named_oil_lies_within_its_iso_grade(name: str, grade: float) -> None:
    """ISO 3448: the viscosity at 40 C is within 10 % of the grade's number."""
    assert walther(lubricant(name), 40.0) == pytest.approx(grade, rel=0.1)
    assert lubricant(name).name == name
    assert lubricant(name).source


def test_two_point_oil_passes_through_its_points() -> None:
    oil = Lubricant.from_two_points("mine", (313.15, 100e-6), (373.15, 11e-6))
    assert walther(oil, 40.0) == pytest.approx(100.0, rel=1e-12)
    assert walther(oil, 100.0) == pytest.approx(11.0, rel=1e-12)
    assert oil.density_15 == pytest.approx(43.37 * 2.0 + 805.5, rel=1e-12)
    swapped = Lubricant.from_two_points("mine", (373.15, 11e-6), (313.15, 100e-6))
    assert swapped == oil


def test_two_points_of_a_named_oil_give_it_back() -> None:
    known = lubricant("M100")
    points = [(ZERO_CELSIUS + c, walther(known, c) * 1e-6) for c in (40.0, 100.0)]
    again = Lubricant.from_two_points("again", points[0], points[1], density_15=902.0)
    assert again.walther_a == pytest.approx(known.walther_a, rel=1e-10)
    assert again.walther_b == pytest.approx(known.walther_b, rel=1e-10)


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (((313.15, 100e-6), (313.15, 11e-6)), "lubricant.temperatures: got 313.15 and 313.15 K"),
        (((313.15, 11e-6), (373.15, 100e-6)), "lubricant.viscosities: got 11 mm^2/s at 313.15 K"),
        (((-5.0, 100e-6), (373.15, 11e-6)), "lubricant.temperatures: got -5 K (-278.15 degC)"),
        (
            ((313.15, 100e-6), (373.15, 0.1e-6)),
            "lubricant.viscosities: got 1e-07 m^2/s (0.1 mm^2/s)",
        ),
    ],
)
def test_impossible_points_are_refused(
    points: tuple[tuple[float, float], tuple[float, float]], message: str
) -> None:
    with pytest.raises(InputError) as caught:
        Lubricant.from_two_points("bad", *points)
    assert str(caught.value).startswith(message)
    assert "\n" not in str(caught.value)


def test_unknown_names_say_the_nearest() -> None:
    with pytest.raises(
        InputError, match=r"^lubricant: got 'M1000'; grades of mineral base oil: M32"
    ):
        lubricant("M1000")
    with pytest.raises(InputError, match=r"^material: got 'stel'; did you mean 'steel'\?$"):
        material("stel")
    with pytest.raises(InputError, match=r"did you mean 'mineral'\?$"):
        dataclasses.replace(lubricant("M100"), kind="minerl")


@pytest.mark.parametrize("field", ["walther_b", "specific_heat"])
def test_an_oil_refuses_the_impossible(field: str) -> None:
    with pytest.raises(InputError, match=rf"^lubricant\.{field}: got -1\.0; allowed > 0, finite$"):
        dataclasses.replace(lubricant("M100"), **{field: -1.0})


def test_modulus_of_carbon_steel_meets_roarks_table_within_its_fit(compared: Compared) -> None:
    """E(T)/E(21 C) against 202.0, 197.2, 193.7, 189.6 GPa at 21, 93, 149, 204 C."""
    steel = MATERIALS["steel"]
    kelvin = ZERO_CELSIUS + np.array([21.0, 93.0, 149.0, 204.0])
    ratio = steel.youngs_modulus_at(kelvin) / steel.youngs_modulus_at(kelvin[0])
    table = np.array([202.0, 197.2, 193.7, 189.6]) / 202.0
    compared("E(T) over E(21 °C), 21 to 204 °C", "Roark's table", ratio - table, 0.0015)


def test_thermal_contact_coefficient() -> None:
    steel = MATERIALS["steel"]
    assert steel.thermal_contact_coefficient == pytest.approx((46.0 * 7850.0 * 470.0) ** 0.5)


@pytest.mark.parametrize(
    "name", ["ISO VG 100", "ISO-VG-100", "ISO VG100", "ISOVG100", "VG 100", "vg100", " iso vg 100 "]
)
def test_a_viscosity_grade_alone_is_the_mineral_oil_of_that_grade(name: str) -> None:
    assert lubricant(name) is lubricant("M100")


MINERAL = "grades of mineral base oil: M32, M46, M68, M100, M150, M220, M320"


@pytest.mark.parametrize(
    ("name", "fix"),
    [
        ("ISO VG 460", MINERAL),
        ("VG 10", MINERAL),
        ("M460", MINERAL),
        ("m100", "did you mean 'M100' (mineral base oil)?"),
        ("P46", "grades of polyalphaolefin: P68, P100, P150, P220, P320"),
        ("PAO 100", "did you mean 'M100' (mineral base oil) or 'P100' (polyalphaolefin)?"),
        ("FVA 3", "did you mean 'FVA3' (mineral base oil)?"),
        ("75W-90", "did you mean '75W90' (polyalphaolefin)?"),
        ("CLP 220", "did you mean 'M220' (mineral base oil) or 'P220' (polyalphaolefin)?"),
        ("butter", f"known: {', '.join(LUBRICANTS)}"),
    ],
)
def test_an_unknown_oil_is_answered_with_its_own_kind_or_the_kind_is_said(
    name: str, fix: str
) -> None:
    with pytest.raises(InputError) as caught:
        lubricant(name)
    assert str(caught.value) == f"lubricant: got {name!r}; {fix}"
