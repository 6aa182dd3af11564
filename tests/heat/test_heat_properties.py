"""Laws of nature over random gears, fields and contacts."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from thermogear.gears.geometry import Gear
from thermogear.heat.expansion import RadialField, flank_growth, radial_displacement
from thermogear.heat.laws import doleschel_share
from thermogear.heat.moving_source import peclet_factor
from thermogear.heat.temperature import FLASH_FACTORS, blok_flash, heat_partition
from thermogear.heat.thesis_profile import deformed_profile

COLD = 293.15
gears = st.builds(
    lambda teeth, module, shift, bore: Gear(
        teeth=teeth,
        module=module,
        profile_shift=shift,
        bore_radius=bore * (0.5 * teeth - 2.0) * module,
    ),
    st.integers(20, 120),
    st.floats(0.5e-3, 20e-3),
    st.floats(0.0, 0.4),
    st.floats(0.15, 0.9),
)
kelvin = st.floats(230.0, 480.0)


@settings(max_examples=60, deadline=None)
@given(gears, kelvin, st.sampled_from(["free", "shaft"]))
def test_uniform_fields_only_scale(gear: Gear, hot: float, bore: str) -> None:
    field = RadialField.uniform(
        bore_radius=gear.bore_radius, tip_radius=gear.tip_radius, temperature=hot, reference=COLD
    )
    r = np.linspace(gear.form_radius, gear.tip_radius, 9)
    strain = gear.material.thermal_expansion * (hot - COLD)
    assert np.all(flank_growth(gear, field, r, bore, strain_taken_off=strain) == 0.0)
    moved, angle = deformed_profile(gear, field, r, bore)
    assert moved == pytest.approx(r * (1.0 + strain), rel=1e-13)
    assert angle == pytest.approx(gear.half_thickness_angle(r), rel=1e-12)


@settings(max_examples=60, deadline=None)
@given(gears, kelvin, kelvin, kelvin, kelvin)
def test_growth_is_linear_in_the_temperatures(
    gear: Gear, bore_1: float, tip_1: float, bore_2: float, tip_2: float
) -> None:
    """The sum of two fields' rises grows by the sum of their growths."""
    r = np.linspace(gear.form_radius, gear.tip_radius, 5)

    def growth(bore: float, tip: float) -> np.ndarray:
        field = RadialField(
            bore_radius=gear.bore_radius,
            tip_radius=gear.tip_radius,
            bore_temperature=bore,
            addendum_temperature=tip,
            reference=1000.0,
        )
        return flank_growth(gear, field, r, "rigid")

    both = growth(bore_1 + bore_2 - 1000.0 + 600.0, tip_1 + tip_2 - 1000.0 + 600.0)
    apart = growth(bore_1, tip_1) + growth(bore_2, tip_2) - growth(400.0, 400.0)
    assert both == pytest.approx(apart, rel=1e-9, abs=1e-15)


@settings(max_examples=60, deadline=None)
@given(gears, kelvin, kelvin)
def test_a_clamped_bore_never_grows_more_than_a_free_one_when_hot(
    gear: Gear, bore: float, tip: float
) -> None:
    field = RadialField(
        bore_radius=gear.bore_radius,
        tip_radius=gear.tip_radius,
        bore_temperature=max(bore, COLD),
        addendum_temperature=max(tip, COLD),
        reference=COLD,
    )
    rim = gear.root_radius
    body = {"root_radius": rim, "expansion": 11.5e-6, "poisson": 0.3}
    free = radial_displacement(field, rim, **body)
    assert radial_displacement(field, rim, **body, bore="rigid") <= free + 1e-15


@settings(max_examples=100, deadline=None)
@given(st.floats(0.01, 50.0), st.floats(0.01, 50.0), st.floats(0.1, 10.0))
def test_swapping_the_flanks_keeps_the_flash(v1: float, v2: float, ratio: float) -> None:
    one = blok_flash(
        0.05,
        1e5,
        speed_1=v1,
        speed_2=v2,
        half_width=1e-4,
        contact_coefficient_1=1e4,
        contact_coefficient_2=1e4 * ratio,
    )
    two = blok_flash(
        0.05,
        1e5,
        speed_1=v2,
        speed_2=v1,
        half_width=1e-4,
        contact_coefficient_1=1e4 * ratio,
        contact_coefficient_2=1e4,
    )
    assert one == pytest.approx(float(two), rel=1e-12)
    share = heat_partition(
        speed_1=v1, speed_2=v2, contact_coefficient_1=1e4, contact_coefficient_2=1e4 * ratio
    )
    assert share + heat_partition(
        speed_1=v2, speed_2=v1, contact_coefficient_1=1e4 * ratio, contact_coefficient_2=1e4
    ) == pytest.approx(1.0, abs=1e-14)


@settings(max_examples=100, deadline=None)
@given(st.floats(1e-9, 1e9), st.sampled_from(sorted(FLASH_FACTORS)))
def test_blok_is_never_below_the_exact_maximum(peclet: float, distribution: str) -> None:
    exact = float(peclet_factor(peclet, distribution))
    assert 0.0 < exact <= FLASH_FACTORS[distribution] * (1.0 + 1e-6)


@settings(max_examples=100, deadline=None)
@given(st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_thicker_films_carry_more_of_the_load(one: float, two: float) -> None:
    low, high = sorted([one, two])
    assert 0.0 <= doleschel_share(high) <= doleschel_share(low) <= 1.0
