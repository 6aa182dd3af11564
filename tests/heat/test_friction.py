"""Friction laws: the sources' statements on sign and limits, and the thesis's printed form."""

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.heat.contact_state import ContactState, PitchPoint
from thermogear.heat.friction import (
    LAWS,
    BenedictKelley,
    ConstantDry,
    benedict_kelley,
    benedict_kelley_as_printed,
    constant_dry,
    friction_law,
)

BASE = {
    "line_load": 2e5,
    "sliding_speed": 1.0,
    "sum_speed": 5.0,
    "viscosity": 0.034,
    "roughness": 0.4e-6,
}


def test_benedict_kelley_in_the_source_units() -> None:
    """0.0127 * 1.13/(1.13 - S) log10(29660 w/(eta vs vsum^2)), N/mm, mPa s, m/s, um."""
    expected = 0.0127 * 1.13 / (1.13 - 0.4) * np.log10(29660 * 200 / (34 * 1.0 * 5.0**2))
    assert benedict_kelley(**BASE, pitch_floor=1e-9) == pytest.approx(expected, rel=1e-12)


def test_constant_converts_from_us_units() -> None:
    """3.17e8 w/(eta vs vsum^2) with lb/in, cP and in/s is 29660 with N/mm, mPa s and m/s."""
    pound_per_inch, inch = 4.4482216152605 / 25.4, 0.0254  # N/mm, m
    assert 3.17e8 / pound_per_inch * inch**3 == pytest.approx(29660, rel=2e-4)


@pytest.mark.parametrize(
    ("field", "sign"),
    [
        ("line_load", 1),
        ("sliding_speed", -1),
        ("sum_speed", -1),
        ("viscosity", -1),
        ("roughness", 1),
    ],
)
def test_trends_of_the_1961_abstract(field: str, sign: int) -> None:
    """mu falls with sum speed, sliding speed and viscosity, rises with load and roughness."""
    values = BASE[field] * np.linspace(0.5, 2.0, 9)
    mu = benedict_kelley(**{**BASE, field: values})
    assert np.all(sign * np.diff(mu) > 0.0)


def test_pitch_point_is_finite_and_even_in_the_sliding_direction() -> None:
    slide = np.array([-0.5, -1e-9, 0.0, 1e-9, 0.5])
    mu = benedict_kelley(**{**BASE, "sliding_speed": slide})
    assert np.array_equal(mu, mu[::-1])
    at_pitch = benedict_kelley(**{**BASE, "sliding_speed": 0.01 * 2.5}, pitch_floor=1e-12)
    assert mu[2] == pytest.approx(float(at_pitch), rel=1e-9)
    assert np.argmax(mu) in (1, 2, 3)


def test_floor_is_invisible_away_from_the_pitch_point() -> None:
    slide = np.linspace(0.25, 2.0, 20)
    with_floor = benedict_kelley(**{**BASE, "sliding_speed": slide})
    without = benedict_kelley(**{**BASE, "sliding_speed": slide}, pitch_floor=1e-12)
    assert np.max(np.abs(with_floor - without)) < 1e-4


def test_clipped_at_light_load_high_speed_and_at_no_load() -> None:
    assert benedict_kelley(**{**BASE, "line_load": np.array([0.0, 1e-6])}).tolist() == [0.0, 0.0]
    assert benedict_kelley(**{**BASE, "sum_speed": 1e4, "sliding_speed": 1e3}) == 0.0


def test_at_rest_the_ceiling_holds() -> None:
    assert benedict_kelley(**{**BASE, "sliding_speed": 0.0, "sum_speed": 0.0}) == 0.5
    rest = {**BASE, "sliding_speed": 0.0, "sum_speed": 0.0}
    assert benedict_kelley(**rest, ceiling=0.3) == 0.3


def test_roughness_beyond_the_factor_is_refused() -> None:
    with pytest.raises(InputError, match=r"^roughness: got 1.2 um; allowed < 1.13 um; "):
        benedict_kelley(**{**BASE, "roughness": 1.2e-6})


def test_printed_formula_gives_its_impossible_value_and_trends() -> None:
    """Literally in SI: 0.55..0.61 on the rig; rises with viscosity, the reverse of the source."""
    given = {k: BASE[k] for k in ("line_load", "viscosity", "roughness")}
    given |= {"sliding_speed": 1.0, "entrainment_speed": 2.5}
    assert 0.55 < benedict_kelley_as_printed(**given) < 0.61
    thicker = benedict_kelley_as_printed(**{**given, "viscosity": 0.068})
    assert thicker > benedict_kelley_as_printed(**given)
    both = benedict_kelley_as_printed(**{**given, "sliding_speed": np.array([-1.0, 0.0, 1.0])})
    assert both[0] == -both[2]
    assert both[1] == 0.0


def test_constant_dry() -> None:
    assert np.array_equal(constant_dry(np.zeros((2, 3)), 0.3), np.full((2, 3), 0.3))
    with pytest.raises(InputError, match=r"^dry_coefficient: got -0.1; allowed 0 < mu <= 1$"):
        ConstantDry(-0.1)


def state(**changed: object) -> ContactState:
    fields: dict[str, object] = {
        "line_load": np.full((2, 5), 2e5),
        "speed_1": np.linspace(1.0, 4.0, 5),
        "speed_2": np.linspace(3.0, 2.0, 5),
        "reduced_radius": 0.016,
        "pressure": 0.7e9,
        "viscosity": 0.034,
        "roughness": 0.4e-6,
        "kinematic_viscosity": 39e-6,
        "film_parameter": 0.8,
        "central_film_parameter": 1.8,
        "pressure_viscosity": 1.8e-8,
        "pitch_point": PitchPoint(
            line_load=2e5, sum_speed=5.0, reduced_radius=0.016, face_width=0.025
        ),
    }
    return ContactState(**(fields | changed))  # type: ignore[arg-type]


@pytest.mark.parametrize("name", LAWS)
def test_every_law_gives_a_magnitude_in_the_shape_of_its_state(name: str) -> None:
    mu = friction_law(name)(state())
    assert mu.shape == (2, 5)
    assert np.all(np.isfinite(mu) & (mu >= 0.0) & (mu <= 0.5))
    assert friction_law(name).name == name


@pytest.mark.parametrize("name", LAWS)
def test_batch_is_one_by_one(name: str) -> None:
    law, whole = friction_law(name), state()
    batch = law(whole)[0]
    for i in range(5):
        single = law(state(line_load=2e5, speed_1=whole.speed_1[i], speed_2=whole.speed_2[i]))  # type: ignore[index]
        assert single == pytest.approx(batch[i], rel=1e-14)


@pytest.mark.parametrize("name", LAWS)
def test_swapping_the_flanks_changes_nothing(name: str) -> None:
    law, one = friction_law(name), state()
    other = state(speed_1=one.speed_2, speed_2=one.speed_1)
    assert np.array_equal(law(one), law(other))


def test_law_object_carries_its_own_parameters() -> None:
    one = state()
    mine = BenedictKelley(pitch_floor=0.05)(one)
    table = benedict_kelley(
        one.line_load,
        sliding_speed=one.sliding,
        sum_speed=one.sum_speed,
        viscosity=one.viscosity,
        roughness=one.roughness,
        pitch_floor=0.05,
    )
    assert np.array_equal(mine, table)


def test_unknown_law_says_the_nearest() -> None:
    with pytest.raises(InputError, match=r"did you mean 'benedict-kelley'\?$"):
        friction_law("benedict-kelly")


def test_contact_state_refuses_the_impossible() -> None:
    with pytest.raises(InputError, match=r"^contact.viscosity: got 0.0; allowed > 0, finite$"):
        state(viscosity=0.0)
    with pytest.raises(InputError, match=r"^contact.line_load: got -1.0; allowed >= 0, finite$"):
        state(line_load=-1.0)
    with pytest.raises(InputError, match=r"^contact.speed_1: got nan; allowed >= 0, finite$"):
        state(speed_1=np.nan)


def test_contact_state_speeds() -> None:
    one = state()
    assert np.array_equal(one.entrainment * 2.0, one.sum_speed)
