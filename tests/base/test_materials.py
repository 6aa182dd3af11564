"""Materials and lubricants: named sets against published values, refusals in one line."""

import dataclasses

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import (
    LUBRICANTS,
    MATERIALS,
    POLYMER_LIMITS,
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


MINERAL = "grades of mineral base oil: M32, M46, M68, M100, M150, M220, M320, M460"


@pytest.mark.parametrize(
    ("name", "fix"),
    [
        ("ISO VG 680", MINERAL),
        ("VG 10", MINERAL),
        ("M680", MINERAL),
        ("m100", "did you mean 'M100' (mineral base oil)?"),
        ("P46", "grades of polyalphaolefin: P68, P100, P150, P220, P320"),
        ("PAO 100", "did you mean 'M100' (mineral base oil) or 'P100' (polyalphaolefin)?"),
        ("FVA 3", "did you mean 'FVA3' (mineral base oil)?"),
        ("75W-90", "did you mean '75W90' (polyalphaolefin)?"),
        ("CLP 100", "did you mean 'M100' (mineral base oil) or 'P100' (polyalphaolefin)?"),
        (
            "PAG 220",
            "did you mean 'M220' (mineral base oil) or 'P220' (polyalphaolefin) or 'G220' "
            "(polyalkylene glycol)?",
        ),
        ("butter", f"known: {', '.join(LUBRICANTS)}"),
    ],
)
def test_an_unknown_oil_is_answered_with_its_own_kind_or_the_kind_is_said(
    name: str, fix: str
) -> None:
    with pytest.raises(InputError) as caught:
        lubricant(name)
    assert str(caught.value) == f"lubricant: got {name!r}; {fix}"


@pytest.mark.parametrize(
    ("name", "points"),
    [
        ("ISO VG 220", {20: 852.0, 60: 78.8, 80: 35.6, 100: 19.0, 120: 11.45}),
        ("ISO VG 100", {60: 40.2, 80: 19.9, 100: 11.4}),
    ],
)
def test_walthers_line_through_two_grades(name: str, points: dict[int, float]) -> None:
    """lg lg(nu + 0.7) = A - B lg T through 220/19.0 and 100/11.4; the named oils within 6 %."""
    grade, hot = float(name.split()[-1]), points[100]
    sheet = Lubricant.from_two_points(
        "sheet", (ZERO_CELSIUS + 40.0, grade * 1e-6), (ZERO_CELSIUS + 100.0, hot * 1e-6)
    )
    for celsius, nu in points.items():
        assert walther(sheet, celsius) == pytest.approx(nu, rel=2e-3)
        assert walther(lubricant(name), celsius) == pytest.approx(nu, rel=0.06)


def test_the_line_of_the_collection() -> None:
    one = Lubricant.from_two_points("220", (313.15, 220e-6), (373.15, 19.0e-6))
    two = Lubricant.from_two_points("100", (313.15, 100e-6), (373.15, 11.4e-6))
    assert (one.walther_a, one.walther_b) == pytest.approx((8.8222, 3.3867), abs=1e-4)
    assert (two.walther_a, two.walther_b) == pytest.approx((9.0593, 3.5090), abs=1e-4)


@pytest.mark.parametrize("grade", [32, 46, 68, 100, 150, 220, 320, 460])
def test_every_usual_grade_has_an_oil(grade: int) -> None:
    """At 100 C within 10 % of the usual mineral sheet of the grade."""
    sheet = {32: 5.5, 46: 6.8, 68: 8.7, 100: 11.2, 150: 14.7, 220: 19.0, 320: 24.1, 460: 30.6}
    oil = lubricant(f"ISO VG {grade}")
    assert oil.kind == "mineral"
    assert walther(oil, 100.0) == pytest.approx(sheet[grade], rel=0.1)


def test_a_glycol_thins_less_than_an_olefin_and_that_less_than_a_mineral_oil() -> None:
    mineral, olefin, glycol = (walther(lubricant(n), 100.0) for n in ("M220", "P220", "G220"))
    assert mineral < olefin < glycol
    assert glycol == pytest.approx(34.4, rel=1e-9)
    assert lubricant("G220").density_15 == 1074.0


@pytest.mark.parametrize("name", MATERIALS)
def test_every_material_has_a_source_and_plausible_values(name: str) -> None:
    found = material(name)
    assert found.name == name
    assert found.source
    polymer = name in POLYMER_LIMITS
    assert (found.youngs_modulus < 5e9) == polymer
    light = found.density < 3000.0
    if not polymer:
        # Dulong and Petit, 3 R over the mass of a mole of iron, aluminium, magnesium
        mole = 0.05585 if not light else 0.02698 if found.density > 2000.0 else 0.02431
        assert found.specific_heat == pytest.approx(3.0 * 8.314 / mole, rel=0.06)
        # and the sound of every metal for machines goes 3.7 to 5.3 km/s along a bar
        assert 3700.0 < np.sqrt(found.youngs_modulus / found.density) < 5300.0
        assert 9000.0 < found.thermal_contact_coefficient < 19000.0
    else:
        assert found.thermal_contact_coefficient < 1000.0
        lasting, short = POLYMER_LIMITS[name]
        assert ZERO_CELSIUS + 60.0 < lasting <= short


def test_a_hot_polymer_is_soft_and_then_refused() -> None:
    """POM: 3.2, 2.0 and 1.0 GPa at 20, 60 and 100 C, on one line within 6 %."""
    pom = material("POM")
    kelvin = ZERO_CELSIUS + np.array([20.0, 60.0, 100.0])
    assert pom.youngs_modulus_at(kelvin) == pytest.approx([3.2e9, 2.0e9, 1.0e9], rel=0.06)
    with pytest.raises(InputError) as caught:
        pom.youngs_modulus_at(ZERO_CELSIUS + 140.0)
    assert str(caught.value) == (
        "temperature of POM: got 140 degC; allowed < 133.6 degC; its modulus falls to nothing there"
    )


@pytest.mark.parametrize(
    ("written", "name"),
    [
        ("aluminium", "AlSi9Cu3"),
        ("Aluminum", "AlSi9Cu3"),
        ("EN AC-AlSi9Cu3(Fe)", "AlSi9Cu3"),
        ("EN AC-46000", "AlSi9Cu3"),
        ("EN AC-AlSi10Mg", "AlSi10Mg"),
        ("grey iron", "EN-GJL-250"),
        ("cast iron", "EN-GJL-250"),
        ("GJL-250", "EN-GJL-250"),
        ("gjl 200", "EN-GJL-200"),
        ("EN-GJS-400-15", "EN-GJS-400-15"),
        ("GJS-500", "EN-GJS-500-7"),
        ("ductile iron", "EN-GJS-400-15"),
        ("magnesium", "AZ91D"),
        ("Steel", "steel"),
        ("16mncr5", "16MnCr5"),
        ("18 CrNiMo 7-6", "18CrNiMo7-6"),
    ],
)
def test_materials_are_known_as_users_spell_them(written: str, name: str) -> None:
    assert material(written) is MATERIALS[name]


def test_no_two_materials_are_spelled_alike_and_what_is_none_is_refused() -> None:
    for name in MATERIALS:
        assert material(name.upper()) is material(name.lower()) is MATERIALS[name]
    for none in ("", "-", "EN", "aluminiumoxide", "GJL"):
        with pytest.raises(InputError, match=f"^material: got '{none}'; "):
            material(none)
