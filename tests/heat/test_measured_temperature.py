"""Correcting thermometers: published error sizes, exact inverses, uncertainty."""

import math

import numpy as np
import pytest

from thermogear.base.errors import InputError
from thermogear.base.materials import ZERO_CELSIUS
from thermogear.heat.measured_temperature import (
    InfraredReading,
    ThermocoupleReading,
    band_radiance,
    infrared_signal,
    surface_temperature,
)

BANDS = {"4 um": (4e-6, 4e-6), "10 um": (10e-6, 10e-6), "total": None}
PUBLISHED = {  # K for 10 % of emissivity at 60, 100, 150 C
    "4 um": (3.1, 3.9, 5.0),
    "10 um": (7.7, 9.7, 12.4),
    "total": (8.3, 9.3, 10.6),
}


@pytest.mark.parametrize("name", BANDS)
def test_published_error_of_a_wrong_emissivity(name: str) -> None:
    """A radiance wrong by 10 % is a temperature wrong by 0.1/(d ln L/dT).

    The published figures for single wavelengths are Wien's, l T^2/c2; Planck's law makes them
    smaller by 1 - exp(-c2/(l T)).
    """
    for celsius, error in zip((60.0, 100.0, 150.0), PUBLISHED[name], strict=True):
        t, step = ZERO_CELSIUS + celsius, 1e-3
        up, down = (float(band_radiance(t + d, BANDS[name])) for d in (step, -step))
        slope = (math.log(up) - math.log(down)) / (2.0 * step)
        band = BANDS[name]
        wien = 1.0 if band is None else -math.expm1(-0.01438777 / (band[0] * t))
        assert 0.1 / slope / wien == pytest.approx(error, abs=0.06)


@pytest.mark.parametrize("band", [None, (3e-6, 5e-6), (8e-6, 14e-6), (4e-6, 4e-6)])
def test_correction_is_the_inverse_of_the_signal(
    band: tuple[float, float] | None,
) -> None:
    true = np.array([330.0, 380.0, 430.0])
    known = {"emissivity": 0.85, "transmission": 0.92, "surroundings": 300.0, "path": 310.0}
    signal = infrared_signal(true, **known, band=band)
    # what an instrument set to emissivity 1 says to that signal
    seen = [
        float(np.interp(s, band_radiance(grid, band), grid))
        for s in signal
        for grid in [np.linspace(250.0, 500.0, 200001)]
    ]
    corrected = [InfraredReading(indicated=t, band=band, **known).temperature() for t in seen]
    assert corrected == pytest.approx(true, abs=1e-3)


def test_perfect_conditions_need_no_correction() -> None:
    perfect = InfraredReading(indicated=400.0, emissivity=1.0, surroundings=300.0, path=300.0)
    assert perfect.temperature() == pytest.approx(400.0, abs=1e-8)
    # a surface as hot as its surroundings and the window looks black whatever its emissivity
    same = InfraredReading(
        indicated=400.0, emissivity=0.3, transmission=0.5, surroundings=400.0, path=400.0
    )
    assert same.temperature() == pytest.approx(400.0, abs=1e-8)


def test_narrow_band_tends_to_one_wavelength() -> None:
    ratio = band_radiance(400.0, (4e-6, 4.0001e-6)) / band_radiance(350.0, (4e-6, 4.0001e-6))
    single = band_radiance(400.0, (4e-6, 4e-6)) / band_radiance(350.0, (4e-6, 4e-6))
    assert ratio == pytest.approx(float(single), rel=1e-4)


def test_thermocouple_at_one_millimetre() -> None:
    """About 1.5 K per mm at FZG C and 200 Nm: q = 1.5 K * k/d."""
    flux = 1.5 * 46.0 / 1e-3
    assert surface_temperature(380.0, flux, 1e-3, 46.0) == pytest.approx(381.5)
    reading = ThermocoupleReading(
        indicated=380.0, flux=flux, depth=1e-3, conductivity=46.0, u_indicated=0.5, u_depth=2e-4
    )
    assert reading.temperature() == pytest.approx(381.5)
    expected = math.hypot(0.5, 2e-4 * flux / 46.0)
    assert reading.uncertainty() == pytest.approx(expected, rel=1e-6)


def test_infrared_uncertainty_is_the_sum_of_squares_and_short_waves_win() -> None:
    readings = {
        name: InfraredReading(
            indicated=380.0, emissivity=0.9, surroundings=300.0, band=band, u_emissivity=0.05
        )
        for name, band in BANDS.items()
    }
    spread = {name: reading.uncertainty() for name, reading in readings.items()}
    assert spread["4 um"] < 0.6 * spread["10 um"]
    one = readings["total"]
    both = InfraredReading(
        indicated=380.0, emissivity=0.9, surroundings=300.0, u_emissivity=0.05, u_indicated=1.0
    )
    alone = InfraredReading(indicated=380.0, emissivity=0.9, surroundings=300.0, u_indicated=1.0)
    total = math.hypot(one.uncertainty(), alone.uncertainty())
    assert both.uncertainty() == pytest.approx(total, rel=1e-9)
    # by hand: eps T^4 = S - (1 - eps) T_env^4
    t = one.temperature()
    slope = (300.0**4 - t**4) / (4.0 * 0.9 * t**3)
    assert one.uncertainty() == pytest.approx(abs(slope) * 0.05, rel=1e-5)
    black = InfraredReading(indicated=380.0, emissivity=1.0, surroundings=300.0, u_emissivity=0.05)
    assert black.uncertainty() == pytest.approx((380.0**4 - 300.0**4) / (4 * 380.0**3) * 0.05)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: InfraredReading(indicated=380.0, emissivity=1.2, surroundings=300.0),
            "emissivity: got 1.2; allowed 0 < value <= 1",
        ),
        (
            lambda: InfraredReading(indicated=300.0, emissivity=0.2, surroundings=400.0),
            "infrared reading: got",
        ),
        (
            lambda: InfraredReading(
                indicated=380.0, emissivity=0.9, transmission=0.0, surroundings=300.0
            ),
            "transmission: got 0.0",
        ),
        (
            lambda: InfraredReading(
                indicated=380.0, emissivity=1.01, transmission=1.0, surroundings=300.0
            ),
            "emissivity: got 1.01",
        ),
        (lambda: band_radiance(-5.0), "temperature: got -5.0 K; allowed > 0 K"),
        (lambda: band_radiance(300.0, (5e-6, 3e-6)), "band: got 5e-06 .. 3e-06 m"),
        (
            lambda: ThermocoupleReading(indicated=380.0, flux=1.0, depth=-1.0, conductivity=46.0),
            "thermocouple.depth: got -1 m (-1000 mm); allowed 0..50 mm",
        ),
    ],
)
def test_impossible_readings_are_refused(call, message: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(InputError) as caught:
        call()
    assert str(caught.value).startswith(message)
