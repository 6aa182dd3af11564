"""Flash temperature, heat partition and the radial field: closed forms and limits."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize_scalar

from conftest import Compared
from thermogear.base.errors import InputError
from thermogear.base.materials import MATERIALS
from thermogear.heat.temperature import (
    FLASH_FACTORS,
    blok_as_printed,
    blok_flash,
    conduction_power,
    contact_temperature,
    flash_factor,
    frictional_heat,
    heat_partition,
    radial_temperature,
)

STEEL = MATERIALS["steel"].thermal_contact_coefficient

SHAPES = {
    "ellipse": lambda s: 2.0 / np.pi * np.sqrt(max(0.0, 1.0 - s * s)),
    "uniform": lambda s: 0.5,
    "parabola": lambda s: 0.75 * (1.0 - s * s),
}


@pytest.mark.parametrize(
    ("name", "published"), [("ellipse", 0.78598), ("uniform", 0.79788), ("parabola", 0.82919)]
)
def test_factors_are_the_maxima_of_the_moving_source_integral(
    name: str, published: float, compared: Compared
) -> None:
    """sqrt(1/pi) int q(s)/sqrt(x - s) ds for a fast source, greatest over the band."""

    def rise(x: float) -> float:  # s = x - t^2 takes the root's singularity away
        value, _ = quad(lambda t: 2.0 * SHAPES[name](x - t * t), 0.0, np.sqrt(x + 1.0))
        return float(value / np.sqrt(np.pi))

    found = minimize_scalar(lambda x: -rise(x), bounds=(0.0, 1.0), method="bounded")
    highest = max(-found.fun, rise(1.0))
    compared(
        "Blok's factor u for three distributions of heat",
        "maximum of the moving-source integral",
        highest / FLASH_FACTORS[name] - 1.0,
        2e-6,
    )
    assert FLASH_FACTORS[name] == pytest.approx(published, abs=5e-6)
    assert flash_factor(name) == FLASH_FACTORS[name]


def example() -> dict[str, float]:
    """w 200 N/mm, 3 against 2 m/s, mu 0.076, steel, radii 21.4 and 64.1 mm."""
    reduced = 21.4e-3 * 64.1e-3 / (21.4e-3 + 64.1e-3)
    width = np.sqrt(8.0 * 2e5 * reduced * (1.0 - 0.3**2) / (np.pi * 206e9))
    assert width == pytest.approx(190e-6, rel=2e-3)
    return {
        "friction": 0.076,
        "line_load": 2e5,
        "speed_1": 3.0,
        "speed_2": 2.0,
        "half_width": width,
        "contact_coefficient_1": STEEL,
        "contact_coefficient_2": STEEL,
    }


def test_published_flash_example(compared: Compared) -> None:
    """21.2 K the consistent way, 0.0024 "K" as printed."""
    flash = blok_flash(**example(), factor=flash_factor("ellipse"))
    compared(
        "flash temperature of the worked example",
        "21.2 K, computed apart",
        float(flash) - 21.2,
        0.06,
        "K",
    )
    by_hand = 0.83 * 0.076 * 2e5 / ((3**0.5 + 2**0.5) * STEEL * example()["half_width"] ** 0.5)
    assert blok_flash(**example(), factor=0.83) == pytest.approx(by_hand, rel=1e-12)
    assert blok_as_printed(**example()) == pytest.approx(0.0024, abs=5e-5)


def test_flash_vanishes_at_the_pitch_point_at_no_load_and_at_rest() -> None:
    given = example()
    assert blok_flash(**{**given, "speed_1": 2.0}) == 0.0
    assert blok_flash(**{**given, "line_load": 0.0, "half_width": 0.0}) == 0.0
    assert blok_flash(**{**given, "speed_1": 0.0, "speed_2": 0.0}) == 0.0


def test_flash_grows_as_load_to_three_quarters() -> None:
    """Half width as the square root of the load leaves w^(3/4)."""
    given = example()
    load = 2e5 * np.array([1.0, 16.0, 81.0])
    width = given["half_width"] * np.sqrt(load / 2e5)
    flash = blok_flash(**{**given, "line_load": load, "half_width": width})
    assert flash / flash[0] == pytest.approx([1.0, 8.0, 27.0], rel=1e-12)


def test_both_flanks_reach_the_same_flash_with_their_shares_of_the_heat() -> None:
    v1, v2, b1, b2 = 3.0, 0.7, 12e3, 15e3
    heat = frictional_heat(0.05, 1e5, speed_1=v1, speed_2=v2)
    share = heat_partition(
        speed_1=v1, speed_2=v2, contact_coefficient_1=b1, contact_coefficient_2=b2
    )
    # u q_i/(B_i sqrt(v_i) sqrt(B)), of the heat q_i that enters one flank
    factor = FLASH_FACTORS["ellipse"]
    first = factor * share * heat / (b1 * np.sqrt(v1 * 1e-4))
    second = factor * (1.0 - share) * heat / (b2 * np.sqrt(v2 * 1e-4))
    whole = blok_flash(
        0.05,
        1e5,
        speed_1=v1,
        speed_2=v2,
        half_width=1e-4,
        contact_coefficient_1=b1,
        contact_coefficient_2=b2,
    )
    assert first == pytest.approx(second, rel=1e-14)
    assert first == pytest.approx(whole, rel=1e-14)


def test_partition_limits_and_symmetry() -> None:
    assert (
        heat_partition(
            speed_1=2.0, speed_2=2.0, contact_coefficient_1=STEEL, contact_coefficient_2=STEEL
        )
        == 0.5
    )
    assert (
        heat_partition(
            speed_1=0.0, speed_2=0.0, contact_coefficient_1=STEEL, contact_coefficient_2=STEEL
        )
        == 0.5
    )
    assert (
        heat_partition(
            speed_1=3.0, speed_2=0.0, contact_coefficient_1=STEEL, contact_coefficient_2=STEEL
        )
        == 1.0
    )
    one = heat_partition(
        speed_1=3.0, speed_2=1.0, contact_coefficient_1=12e3, contact_coefficient_2=15e3
    )
    assert one + heat_partition(
        speed_1=1.0, speed_2=3.0, contact_coefficient_1=15e3, contact_coefficient_2=12e3
    ) == pytest.approx(1.0, abs=1e-15)


def test_bodies_of_unequal_heat_meet_at_the_weighted_mean() -> None:
    assert contact_temperature(20.0, 0.5, bulk_1=350.0, bulk_2=350.0) == 370.0
    share = heat_partition(
        speed_1=3.0, speed_2=2.0, contact_coefficient_1=STEEL, contact_coefficient_2=STEEL
    )
    met = contact_temperature(0.0, share, bulk_1=380.0, bulk_2=350.0)
    # heat given by one flank is taken by the other
    given = STEEL * np.sqrt(3.0) * (380.0 - met)
    assert given == pytest.approx(STEEL * np.sqrt(2.0) * (met - 350.0), rel=1e-12)


def test_radial_field_meets_its_ends_and_conducts_a_constant_flux() -> None:
    radii = np.linspace(0.025, 0.0675, 201)
    field = radial_temperature(
        radii,
        bore_radius=0.025,
        tip_radius=0.0675,
        bore_temperature=353.15,
        addendum_temperature=373.15,
    )
    assert field[0] == 353.15
    assert field[-1] == pytest.approx(373.15, abs=1e-12)
    flux = radii[1:-1] * np.gradient(field, radii)[1:-1]
    expected = 20.0 / np.log(0.0675 / 0.025)
    assert flux == pytest.approx(np.full(199, expected), rel=1e-4)


def test_equal_ends_are_a_uniform_field_exactly() -> None:
    radii = np.linspace(0.025, 0.0675, 7)
    assert np.all(
        radial_temperature(
            radii,
            bore_radius=0.025,
            tip_radius=0.0675,
            bore_temperature=360.0,
            addendum_temperature=360.0,
        )
        == 360.0
    )


def test_operating_points_broadcast_against_radii() -> None:
    bore = np.array([[350.0], [360.0]])
    field = radial_temperature(
        np.linspace(0.03, 0.06, 4),
        bore_radius=0.025,
        tip_radius=0.0675,
        bore_temperature=bore,
        addendum_temperature=bore + 20.0,
    )
    assert field.shape == (2, 4)
    assert field[1] - field[0] == pytest.approx(np.full(4, 10.0), abs=1e-11)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"bore_radius": 0.07}, "bore_radius: got 0.07 m with tip_radius 0.0675 m"),
        ({"bore_radius": 0.0}, "bore_radius: got 0.0 m with tip_radius 0.0675 m"),
        ({"radius": 0.02}, "radius: got 0.02 .. 0.02 m"),
        ({"bore_temperature": -1.0}, "bore_temperature: got -1.0 K; allowed > 0 K"),
        ({"addendum_temperature": 0.0}, "addendum_temperature: got 0.0 K; allowed > 0 K"),
    ],
)
def test_impossible_fields_are_refused(wrong: dict[str, float], message: str) -> None:
    good = {"radius": 0.05, "bore_radius": 0.025, "tip_radius": 0.0675}
    good |= {"bore_temperature": 350.0, "addendum_temperature": 370.0}
    with pytest.raises(InputError) as caught:
        radial_temperature(**good | wrong)
    assert str(caught.value).startswith(message)


def test_conduction_into_the_shaft() -> None:
    """20 K over the pinion send 145 W into its shaft, 92 W over the wheel of bore 40 mm."""
    pinion = conduction_power(
        bore_radius=0.025,
        tip_radius=0.0675,
        bore_temperature=353.15,
        addendum_temperature=373.15,
        conductivity=46.0,
        face_width=0.025,
    )
    wheel = conduction_power(
        bore_radius=0.040,
        tip_radius=0.1925,
        bore_temperature=353.15,
        addendum_temperature=373.15,
        conductivity=46.0,
        face_width=0.025,
    )
    assert pinion == pytest.approx(145.0, abs=0.6)
    assert wheel == pytest.approx(92.0, abs=0.4)
    assert (
        conduction_power(
            bore_radius=0.025,
            tip_radius=0.0675,
            bore_temperature=353.15,
            addendum_temperature=353.15,
            conductivity=46.0,
            face_width=0.025,
        )
        == 0.0
    )


def test_unknown_distribution_says_the_nearest() -> None:
    with pytest.raises(InputError, match=r"did you mean 'ellipse'\?$"):
        flash_factor("elipse")
