"""Modulations and dips of known size in noise: what comes back of them.

Averages are drawn here, without code of the package. Seeds were fixed before anything was compared.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from thermogear.measured.diagnosis import ShaftAverage
from thermogear.study.diagnosis import Place, place_of

TEETH, COUNT, BLOCKS, TURNS = 19, 256, 8, 40
ANGLE = 2 * np.pi * np.arange(COUNT) / COUNT
SETS = 60


def averages(
    drawn: np.random.Generator, noise: float, amplitude: np.ndarray, late: np.ndarray
) -> ShaftAverage:
    """An average of 320 turns with eight of 40; ``late`` [pitches]; ``noise`` of a sample."""
    x = sum(
        size * amplitude * np.cos(2 * np.pi * k * (TEETH * ANGLE / (2 * np.pi) - late) + k)
        for k, size in ((1, 1.0), (2, 0.5), (3, 0.3))
    )
    blocks = x + noise / np.sqrt(TURNS) * drawn.normal(size=(1, BLOCKS, COUNT))
    return ShaftAverage(
        name="pinion", teeth=TEETH, held=TURNS * BLOCKS, turns=TURNS * BLOCKS, block_turns=TURNS,
        average=blocks.mean(axis=1), blocks=blocks, highest=100, step=None, leakage=(),
    )  # fmt: skip


def found(drawn: np.random.Generator, noise: float, dip: float, m: float, b: float) -> Place:
    """Of a dip of tooth 8, or an amplitude modulation m and a timing modulation b [pitches]."""
    off = TEETH * ANGLE / (2 * np.pi) - 7.5
    where = drawn.uniform(0, 6.0, size=2)
    amplitude = (1 + m * np.cos(ANGLE + where[0])) * (1 - dip * np.exp(-0.5 * (off / 0.7) ** 2))
    return place_of(averages(drawn, noise, amplitude, b * np.cos(ANGLE + where[1])), 0, "a")


@pytest.mark.parametrize("noise", [0.1, 0.3, 1.0, 3.0])
def test_modulation_of_known_depth_is_within_its_interval(noise: float) -> None:
    drawn = np.random.default_rng(int(90_000 + 10 * noise))
    m, b = 0.2, 0.01
    missed, widths = np.zeros(2), []
    for _ in range(SETS):
        place = found(drawn, noise, 0.0, m, b)
        off = np.abs(place.depth[0] - m), np.abs(place.swing[0] - b)
        widths.append((place.amplitude_half_width[0], place.delay_half_width[0]))
        missed += np.array(off) > widths[-1]
    print(f"noise {noise:g}: missed {missed} of {SETS}, half widths {np.mean(widths, axis=0)}")
    for count in missed:
        assert stats.binomtest(int(count), SETS, 0.05, alternative="greater").pvalue > 0.01
    # no wider than needed: Rice's level of three standard deviations of the in-phase noise
    sigma = noise * np.sqrt(TEETH / COUNT * 2 / (TURNS * BLOCKS))
    assert np.mean(widths, axis=0)[0] == pytest.approx(3.3 * sigma, rel=0.15)


@pytest.mark.parametrize("noise", [0.1, 0.3, 1.0, 2.0])
def test_a_dip_of_known_size_is_within_its_interval(noise: float) -> None:
    drawn = np.random.default_rng(int(91_000 + 10 * noise))
    dip, missed = 0.4, 0
    off = TEETH * ANGLE / (2 * np.pi) - 7.5
    lines = np.fft.fft(1 - dip * np.exp(-0.5 * (off / 0.7) ** 2))
    # what is resolved: orders below z/2 of the turn
    lines[np.abs(np.fft.fftfreq(COUNT, 1 / COUNT)) > (TEETH - 1) // 2] = 0.0
    curve = np.fft.ifft(lines).real
    tooth = np.floor(TEETH * ANGLE / (2 * np.pi) + 1e-9).astype(int)
    by_tooth = np.array([curve[tooth == j].mean() for j in range(TEETH)]) / np.median(curve)
    true = by_tooth[7] - np.median(by_tooth)
    for _ in range(SETS):
        place = found(drawn, noise, dip, 0.0, 0.0)
        missed += place.tooth != 8 or abs(place.amplitude[0] - true) > place.amplitude_half_width[0]
    print(f"noise {noise:g}: dip of {true:.3f} missed in {missed} of {SETS}")
    assert stats.binomtest(missed, SETS, 0.05, alternative="greater").pvalue > 0.01
