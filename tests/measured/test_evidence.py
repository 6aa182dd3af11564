"""Hypotheses on teeth: the likelihood recomputed, and what must and must not be decided."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, stats

from thermogear.measured.evidence import Evidence, weigh
from thermogear.measured.groups import falling, seen, some_of
from thermogear.measured.hypotheses import Hypothesis
from thermogear.measured.meshes import Gears, Stated, whole
from thermogear.measured.peaks import Peaks, peaks_of
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure
from thermogear.measured.straight import sharp_peaks

COUNT = 1 << 16


def lines_at(places: list[float], levels: list[float]) -> Peaks:
    """Lines of given levels over a threshold of 1, a hundredth of them per bin."""
    return Peaks(
        place=np.array(places),
        error=np.full(len(places), 2e-6),
        level=np.array(levels) + 1.0,
        density=np.full(len(places), 0.01),
        least=1.0,
        bin_width=1e-5,
        bins=50_000,
    )


def test_the_evidence_of_a_group_is_its_integral_over_the_level() -> None:
    """One line there, one missing: against scipy's densities, integrated over the level."""
    peaks = lines_at([0.1, 0.2, 0.3], [2.0, 1.0, 3.0])
    found = seen(peaks, np.zeros(3, bool), np.array([[0.1 + 1e-6, 0.15]]), error=0.0, spread=1.2)
    mean = 2.0

    def both(level: float) -> float:
        place = 0.8 * stats.norm.pdf(0.1, scale=0.2)
        place += 0.2 * stats.norm.pdf(0.1, scale=np.hypot(0.2, 0.12))
        there = place / 0.01 * stats.norm.pdf(2.0, level, 1.2)
        return float(there / stats.expon.pdf(2.0, scale=mean) * stats.norm.cdf(-level / 1.2))

    expected = np.log(integrate.quad(both, -3.0, 10.0)[0] / 13.0)
    assert found.evidence[0] == pytest.approx(expected, abs=0.05)
    assert found.lines.tolist() == [[0, -1]]


def test_groups_up_to_an_order_are_those_of_its_members() -> None:
    peaks = lines_at([0.1, 0.2], [2.0, 1.0])
    place, order = np.array([[0.1, 0.2]]), np.array([1, 2])
    none, trend = np.zeros(2, bool), np.array([0.0, -0.7])
    one, two = falling(
        peaks, none, position=place, order=order, error=0.0, spread=1.0, trend=trend, top=np.inf
    )
    alone = seen(peaks, none, place[:, :1], error=0.0, spread=1.0)
    both = seen(peaks, none, place, error=0.0, spread=1.0, trend=trend)
    assert one.evidence[0] == pytest.approx(alone.evidence[0], abs=1e-12)
    assert two.evidence[0] == pytest.approx(both.evidence[0], abs=1e-12)
    assert (one.lines.tolist(), two.lines.tolist()) == ([[0, -1]], [[0, 1]])
    assert some_of(np.zeros(5)) == pytest.approx(0.0, abs=1e-12)


def test_a_line_is_placed_to_its_stated_error() -> None:
    """Drawn lines in white noise: normal of no more than the stated deviation, none far out."""
    random = np.random.default_rng(77)
    n = np.arange(8192)
    off = []
    for _ in range(150):
        place = random.uniform(0.05, 0.4)
        wave = np.cos(2 * np.pi * place * n + random.uniform(0, 6))
        found = peaks_of(wave[None] + random.uniform(0.05, 2.0) * random.normal(size=(1, n.size)))
        nearest, _ = found.nearest(np.array([place]))
        off.append(float((found.place[nearest[0]] - place) / found.error[nearest[0]]))
    assert 0.5 < np.std(off) < 1.2
    assert np.max(np.abs(off)) < 4.5


def test_first_sidebands_alone_are_teeth_where_the_shaft_shows() -> None:
    """A textbook's gear: one sideband to each side and the shaft's own line."""
    n = np.arange(COUNT)
    mesh = 0.0394
    for teeth in (25, 31):
        swing = 1.0 + 0.05 * np.cos(2 * np.pi * mesh / teeth * n)
        x = 0.05 * np.random.default_rng(teeth).normal(size=n.size)
        x += swing * sum(0.5**k * np.cos(2 * np.pi * (k + 1) * mesh * n + k) for k in range(3))
        bare = weigh(sharp_peaks(x[None]))
        assert bare.gears[0].teeth == teeth
        assert bare.hypotheses[0].gears
        x += 0.1 * np.cos(2 * np.pi * mesh / teeth * n)
        assert weigh(sharp_peaks(x[None])).teeth == (teeth,)


def test_noise_alone_has_a_line_in_a_tenth_of_the_spectra() -> None:
    random = np.random.default_rng(5)
    counts = [peaks_of(random.normal(size=(1, 4096))).size for _ in range(200)]
    # Poisson of mean 0.1 each: 20 of 200, and the floor's own scatter
    assert stats.poisson.ppf(1e-4, 20) <= sum(counts) <= 2.5 * stats.poisson.ppf(0.9999, 20)


def train(teeth: int, modulation: float) -> np.ndarray:
    """A mesh line with four harmonics and one modulating shaft; noise 30 dB below."""
    n = np.arange(COUNT)
    mesh = 0.0613
    x = 0.03 * np.random.default_rng(1).normal(size=COUNT)
    swing = 1.0 + modulation * np.cos(2 * np.pi * mesh / teeth * n)
    for rank, height in ((1, 1.0), (2, 0.5), (3, 0.3), (4, 0.2)):
        x += height * swing * np.cos(2 * np.pi * rank * mesh * n + rank)
    return x[None, :]


@pytest.mark.parametrize("teeth", [19, 38])
def test_a_tooth_number_and_its_double_are_told_apart(teeth: int) -> None:
    found = weigh(sharp_peaks(train(teeth, 0.06)))
    assert (found.verdict, found.teeth) == ("decided", (teeth,))
    assert found.mesh == pytest.approx(0.0613, rel=1e-5)
    assert sum(one.weight for one in found.hypotheses) == pytest.approx(1.0, abs=1e-9)
    assert (found.gears[0].teeth, found.gears[0].weight) == (teeth, found.weights[0])


def test_impacts_are_no_gear() -> None:
    """A comb whose heights follow a resonance: any tooth number would fit its places."""
    n = np.arange(COUNT)
    x = 0.05 * np.random.default_rng(2).normal(size=COUNT)
    for rank in range(1, 40):
        step = 0.0117
        height = 1.0 / abs(1.0 - (rank * step / 0.2) ** 2 + 0.1j * rank * step / 0.2)
        x += height * np.cos(2 * np.pi * rank * step * n + rank**2)
    found = weigh(sharp_peaks(x[None, :]))
    assert found.teeth == ()
    assert not any(one.teeth for one in found.hypotheses[0].gears)


def test_what_is_stated_is_evidence_and_no_more() -> None:
    peaks = sharp_peaks(train(31, 0.05))
    wrong = weigh(peaks, Stated(teeth=25))
    assert wrong.teeth == (31,)
    right = weigh(peaks, Stated(teeth=31, shaft=0.0613 / 31))
    assert right.teeth == (31,)
    assert right.hypotheses[0].evidence > wrong.hypotheses[0].evidence
    assert right.fits(0.0613 / 31 * 1.02, teeth=31, tolerance=0.1)
    assert not right.fits(0.0613 / 62, teeth=None, tolerance=0.1)


def test_no_line_no_gear() -> None:
    found = weigh(peaks_of(np.random.default_rng(3).normal(size=(1, 2048))))
    assert found.teeth == ()
    assert not any(one.teeth for one in found.hypotheses[0].gears)


def test_rounding_that_repeats_each_turn_is_no_comb() -> None:
    """17 teeth at 20 turns/s, five decimals, no noise: it was no gear, weight 1."""
    turns = 20.0 * np.arange(8_000) / 4_000.0
    by = 1.0 + 0.1 * np.cos(2 * np.pi * turns)
    values = by * (np.cos(34 * np.pi * turns) + 0.3 * np.cos(68 * np.pi * turns))
    assert weigh(sharp_peaks(np.round(values, 5)[None, :]), Stated()).teeth == (17,)


def test_an_inverter_is_no_gear_of_twenty_teeth() -> None:
    """2 kHz +- 100, +- 200 Hz: 20 teeth at 100 turns/s or an inverter at 50 Hz."""
    rng = np.random.default_rng(25112029)
    t = np.arange(25_000) / 10_000.0
    lines = {2000.0: 1.0, 1900.0: 0.3, 2100.0: 0.3, 1800.0: 0.1, 2200.0: 0.1, 24.7: 0.3}
    values = sum(
        (a * np.cos(2 * np.pi * f * t + rng.uniform(0.0, 6.0)) for f, a in lines.items()),
        0.05 * rng.standard_normal(t.size),
    )
    found = weigh(sharp_peaks(values[None, :]), Stated(mains=(0.005, 0.006)))
    assert found.verdict == "undecided"
    assert any(one.carrier is not None for one in found.told)
    assert weigh(sharp_peaks(values[None, :]), Stated()).teeth == (20,)  # of what lines alone say
    wandering = replace(sharp_peaks(values[None, :]), steady=False)
    assert weigh(wandering, Stated(mains=(0.005, 0.006))).teeth == (20,)  # no inverter does so


def test_a_gear_of_few_teeth_is_found_where_it_is_stated() -> None:
    rng = np.random.default_rng(25112030)
    turns = 30.0 * np.arange(12_000) / 4_000.0
    by = 1.0 + 0.1 * np.cos(2 * np.pi * turns)
    values = by * (np.cos(22 * np.pi * turns) + 0.3 * np.cos(44 * np.pi * turns))
    peaks = sharp_peaks((values + 0.05 * rng.standard_normal(turns.size))[None, :])
    assert weigh(peaks, Stated(teeth=11)).teeth == (11,)
    assert 11 not in weigh(peaks, Stated()).teeth


@pytest.mark.parametrize("number", range(4))
def test_an_oscillation_beside_the_mesh_line_is_no_gear(number: int) -> None:
    """A mesh line whose phase oscillates, at any ratio: 8 of 100 drawn so were named, as 35 teeth
    for 37.68 or 140 for 139.96."""
    random = np.random.default_rng([25_112_500, number])
    n, mesh, ratio = np.arange(COUNT), random.uniform(0.04, 0.15), random.uniform(20.0, 140.0)
    turn = 2 * np.pi * mesh / ratio * n
    x = 0.02 * random.normal(size=COUNT)
    for rank in range(1, 4):
        phase = 2 * np.pi * rank * mesh * n + 0.15 * rank * np.sin(turn)
        x += 0.5 ** (rank - 1) * np.cos(phase + random.uniform(0, 6))
    found = weigh(sharp_peaks(x[None]))
    assert found.teeth == ()


@pytest.mark.parametrize(
    ("ratio", "error", "least", "most"),
    [(30.0, 0.05, 0.99, 1.0), (30.02, 0.05, 0.0, 0.3), (30.02, 0.5, 0.9, 1.0)],
)
def test_a_ratio_is_whole_as_far_as_its_lines_are_placed(
    ratio: float, error: float, least: float, most: float
) -> None:
    """Sidebands at 30 or 30.02 (0.14 bins off), each line told to ``error`` bins."""
    bins, mesh = 40_000, 0.08
    ranks, sides = np.array([1.0, 2.0]), np.array([-1.0, 0.0, 1.0])
    place = np.sort((ranks[:, None] + sides / ratio).ravel() * mesh)
    width = 0.5 / bins
    peaks = Peaks(
        place=place,
        error=np.full(place.size, error * width),
        level=np.full(place.size, 3.0),
        density=np.full(place.size, 1e-3),
        least=1.0,
        bin_width=width,
        bins=bins,
    )
    gears = Gears(mesh=mesh, level=3.0, teeth=(30,), sides=(9.0,))
    share, distance = whole(peaks, (gears,), 30, Stated())
    assert least <= share <= most
    assert distance == pytest.approx(mesh / ratio, abs=0.3 * error * width)


def test_the_line_of_a_stated_gear_has_the_weight_of_the_readings_that_put_it_there() -> None:
    """Teeth on a line count for it, two lines without them half each, a comb as a line if it is
    high enough; what has no line at all speaks against none."""

    def reading(
        weight: float, *meshes: tuple[float, tuple[int, ...]], combs: tuple[float, ...] = ()
    ) -> Hypothesis:
        gears = tuple(Gears(mesh=m, level=0.0, teeth=z, sides=(), free=()) for m, z in meshes)
        return Hypothesis(gears=gears, evidence=0.0, weight=weight, combs=combs)

    low, high = 0.02, 0.05
    for one, share in (
        (reading(1.0, (low, (23,)), (high, (31,))), 1.0),
        (reading(1.0, (low, (31,)), (high, (23,))), 0.0),
        (reading(1.0, (low, (31,)), (high, ())), 0.5),
        (reading(1.0, (low, ())), 1.0),
        (reading(1.0, combs=(low, high)), 0.5),
        (reading(1.0, combs=(low, 0.001)), 1.0),
        (reading(1.0), 1.0),
    ):
        found = Evidence(hypotheses=(one, reading(0.0, (high, ()))))
        assert found.share_of(low, teeth=23, least=0.01) == pytest.approx(share)
    both = Evidence(hypotheses=(reading(0.3, (low, ())), reading(0.7, (high, ()))))
    assert both.share_of(low, teeth=23, least=0.01) == pytest.approx(0.3)


def two_stages(random: np.random.Generator) -> tuple[Record, float]:
    """A pinion of 23 teeth with 57, and 31 with 44 behind, without sidebands; its speed [rad/s]."""
    turn = np.arange(16384) * random.uniform(20.0, 35.0) / 10240.0
    x = 0.03 * random.normal(size=turn.size)
    for teeth, size in ((23.0, random.uniform(0.3, 0.5)), (23.0 * 31.0 / 57.0, 1.0)):
        for rank in (1, 2, 3):
            phase = 2.0 * np.pi * rank * teeth * turn + random.uniform(0.0, 6.0)
            x += size / rank * np.cos(phase)
    speed = 2.0 * np.pi * 10240.0 * (turn[1] - turn[0])
    return Record((Channel("a", x, "g"),), "made", 10240.0, "made"), float(speed)


def test_a_speed_is_withheld_where_the_gear_s_mesh_line_is_not_decided() -> None:
    """The louder line is the second stage's: without a speed nothing tells which is the first's."""
    random = np.random.default_rng(26_11_2026)
    for _ in range(4):
        record, true = two_stages(random)
        line = measure(record, teeth=23, sidebands=0, harmonics=1).lines[0]
        held = abs(line.shaft_speed - true) < line.speed_half_width
        assert np.isnan(line.shaft_speed) or held
        said = measure(record, teeth=23, speed=1.01 * true, sidebands=0, harmonics=1).lines[0]
        assert abs(said.shaft_speed - true) < 3.0 * said.speed_half_width
