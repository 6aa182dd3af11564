"""The gate: each damage is seen, said, and filled, cut out or the number withheld."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.measured.comparison import table_of
from thermogear.measured.figures import figures
from thermogear.measured.gate import turned_by
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure
from thermogear.signals.quality import damages, filled

pytestmark = pytest.mark.usefixtures("looked_once")

RATE, TEETH, MESH, COUNT = 2560.0, 25, 401.3, 8192
SPEED = 2.0 * np.pi * MESH / TEETH


def channel(seed: int = 1, count: int = COUNT) -> NDArray[np.float64]:
    """A mesh line of amplitude 1 with sidebands, a second harmonic and noise."""
    cycles = MESH * np.arange(count) / RATE
    swing = 1.0 + 0.2 * np.cos(2 * np.pi * cycles / TEETH)
    x = swing * (np.cos(2 * np.pi * cycles + seed) + 0.5 * np.cos(4 * np.pi * cycles))
    return np.asarray(x + 0.1 * np.random.default_rng(seed).normal(size=count))


def measured(*values: NDArray[np.float64], rate: float = RATE) -> Measurement:
    channels = tuple(Channel(f"a{i}", x, "m/s^2") for i, x in enumerate(values))
    record = Record(channels, "made", rate, "made")
    return measure(record, teeth=TEETH, speed=SPEED, sidebands=0, harmonics=1)


def test_undamaged_records_pass_without_a_word() -> None:
    for bits in (24, 12, 8):
        step = 8.0 * 2.0**-bits
        assert damages(np.round(channel() / step) * step) == []
    tone = np.sin(0.371 * np.arange(5000))
    assert damages(np.round(tone * 100.0) / 100.0) == []
    ringing = channel()
    for at in range(500, COUNT - 100, 900):  # impacts of a damaged tooth
        ringing[at : at + 60] += 15.0 * np.exp(-np.arange(60) / 12.0) * np.cos(np.arange(60))
    assert [one.kind for one in damages(ringing)] == []


def test_every_limit_of_a_channel_is_found() -> None:
    """Of both signs; those of all the record."""
    x = 2.0 * channel()

    def found(values: NDArray[np.float64]) -> list[float | None]:
        return sorted(one.value for one in damages(values) if one.kind == "clipping")

    assert found(np.clip(x, -1.15, 2.0)) == [-1.15, 2.0]
    told = measured(np.clip(x, -2.2, 2.1)).findings
    assert [(one.data["damage"], one.data["value"]) for one in told] == [
        ("clipping", 2.1),
        ("clipping", -2.2),
    ]


@pytest.mark.parametrize("kind", ["missing", "sentinel", "zeros", "held", "spikes"])
def test_little_damage_is_filled_and_the_interval_holds_it(kind: str) -> None:
    x = channel()
    if kind == "spikes":
        x[[300, 2222, 7000]] = [30.0, -25.0, 28.0]
    else:
        stands = {"missing": np.nan, "sentinel": -9999.0, "zeros": 0.0, "held": x[2000]}
        x[2000:2200] = stands[kind]
    (damage,) = damages(x)
    assert (damage.kind, damage.count) == (kind, 3 if kind == "spikes" else damage.count)
    found = measured(x)
    line = found.lines[0]
    assert line.reading == pytest.approx(1.0, abs=1.5 * line.half_width)
    assert line.half_width < 0.02
    assert line.withheld == ""
    (finding,) = found.findings
    assert finding.code == "damage_filled_in"
    assert (finding.data["channel"], finding.data["damage"]) == ("a0", kind)
    assert (finding.data["first"], finding.data["samples"]) == (damage.first, damage.count)


def test_filled_samples_are_those_of_the_lines() -> None:
    x = np.cos(0.371 * np.arange(4000)) + 3.0
    missing = np.zeros(4000, dtype=bool)
    missing[1000:1150] = True
    y, explained = filled(np.where(missing, np.nan, x), missing)
    np.testing.assert_allclose(y, x, atol=5e-3)
    assert explained > 0.999


def test_much_clipping_withholds_amplitudes_and_keeps_the_frequency() -> None:
    found = measured(np.clip(channel(), -0.9, 0.9))
    line = found.lines[0]
    assert np.isnan([line.reading, line.acceleration, line.displacement, line.uncertainty]).all()
    assert line.frequency == pytest.approx(MESH, abs=2.0 * line.frequency_half_width)
    assert line.withheld.startswith("clipping")
    told = figures(found)
    assert told["lines"][0]["reading"] is None
    assert told["findings"][0]["code"] == "amplitudes_withheld"
    with pytest.raises(InputError, match="its lines are withheld: clipping"):
        table_of(found)


def test_a_small_gap_is_not_blamed_for_what_clipping_withholds() -> None:
    """Each damage that alone is too much, or all that are so together, and no other."""
    x = np.clip(channel(), -0.9, 0.9)
    x[1000:1003] = np.nan
    found = measured(x)
    blamed = [one for one in found.findings if one.code == "amplitudes_withheld"]
    assert [one.data["damage"] for one in blamed] == ["clipping", "clipping"]
    assert all(one.data["share"] > 0.02 for one in blamed)
    assert found.lines[0].withheld.startswith("clipping")


def test_damage_turns_a_frequency_by_what_is_wrong_of_the_line_at_most() -> None:
    """The slope that least squares give a phase of rms e: largest for a straight one."""
    count, share = 2000, 0.03
    n = np.arange(count)
    centred = n - n.mean()
    straight = share * centred / np.sqrt(np.mean(centred**2))
    slope = float(np.polyfit(n, straight, 1)[0]) / (2.0 * np.pi)
    assert turned_by(share, samples=count) == pytest.approx(slope, rel=1e-6)
    random = np.random.default_rng(94)
    for _ in range(50):
        phase = random.normal(size=count).cumsum()
        phase *= share / np.sqrt(np.mean(phase**2))
        assert abs(np.polyfit(n, phase, 1)[0]) / (2.0 * np.pi) <= slope * (1.0 + 1e-9)


def test_means_are_named() -> None:
    x = channel()
    found = measured(x, channel(2) + 1e3)
    assert [(one.code, one.data["channel"]) for one in found.findings] == [
        ("mean_taken_away", "a1"),
    ]


def test_a_shaft_rate_is_no_sampling_rate() -> None:
    with pytest.raises(
        InputError, match=r"^rate: got 25 samples/s; .* is 25 the shaft's turns per"
    ):
        measured(channel(), rate=25.0)


def test_a_doubtful_rate_withholds_hertz() -> None:
    # long enough that the lines decide the teeth: of an undecided record the rate is not blamed
    line = measured(channel(count=4 * COUNT), rate=10.0 * RATE).lines[0]
    assert np.isnan([line.frequency, line.shaft_speed, line.displacement]).all()
    assert line.reading == pytest.approx(1.0, abs=0.02)
    assert line.withheld
    given = Record((Channel("a", channel(), "m/s^2"),), "made", 10.0 * RATE, "header")
    right = measure(given.supplied(rate=RATE), teeth=TEETH, speed=SPEED, sidebands=0)
    assert right.lines[0].frequency == pytest.approx(MESH, rel=1e-4)
    doubted = measure(given.supplied(rate=RATE), teeth=TEETH, sidebands=0)
    assert np.isnan(doubted.lines[0].frequency)


@pytest.mark.parametrize("away", [0.4, 0.9])
def test_a_beat_is_no_damage(away: float) -> None:
    """Two lines nearly as high: the phase of both together leaps where they are low."""
    t = np.arange(16384) / RATE
    for height in (0.6, 0.8, 0.95):
        second = height * np.cos(2 * np.pi * (MESH + away) * t + 2.0)
        found = measured(channel(5, t.size) + second)
        assert not found.findings
        assert abs(found.lines[0].reading - 1.0) < 1.5 * found.lines[0].half_width


def test_sidebands_of_clipped_peaks_are_within_their_intervals() -> None:
    """The highest peaks are cut, where the sidebands make them so: all four lose the same way."""
    for seed in (11, 12, 13):
        x = channel(seed)
        found = measure(
            Record(
                (Channel("a", np.minimum(x, np.quantile(x, 0.97)), "m/s^2"),), "x", RATE, "made"
            ),
            teeth=TEETH,
            speed=SPEED,
            sidebands=1,
            harmonics=2,
        )
        assert found.findings
        true = {"mesh x 1": 1.0, "mesh x 2": 0.5}
        for line in found.lines:
            if line.kind in ("mesh", "sideband"):
                size = true[line.name[:8]] * (1.0 if line.kind == "mesh" else 0.1)
                assert abs(line.reading - size) <= line.half_width * line.reading


def test_peaks_of_undamaged_lines_are_no_limit() -> None:
    """Sines, peaks as flat as x^4, lines in step with the rate, coarse steps, impacts."""
    random = np.random.default_rng(72)
    n = np.arange(COUNT)
    for pace in (0.2, 0.1, 0.0371, 1 / 12.8, 0.25):
        turn = 2 * np.pi * pace * n
        for third in (0.0, -1 / 9, 0.5):
            for noise in (0.0, 1e-4, 1e-2):
                x = np.cos(turn) + third * np.cos(3 * turn) + noise * random.normal(size=n.size)
                for step in (1e-6, 1e-3, 1e-2):
                    told = damages(np.round(x / step) * step)
                    assert not any(one.kind == "clipping" for one in told)
    rings = np.exp(-(n % 300) / 30.0) * np.cos(2 * np.pi * 0.21 * (n % 300))
    assert damages(rings + 1e-3 * random.normal(size=n.size)) == []


@pytest.mark.parametrize("trend", [3.0, 40.0, 1300.0])
def test_a_trend_changes_no_line(trend: float) -> None:
    """It was taken away from what lines are read in, but not from what they are found in."""
    n = np.arange(COUNT)
    cycles = MESH * n / RATE + 0.4 * np.sin(2 * np.pi * n / COUNT)
    x = (1.0 + 0.1 * np.cos(2 * np.pi * cycles / TEETH)) * np.cos(2 * np.pi * cycles)
    x += 0.05 * np.random.default_rng(73).normal(size=COUNT)
    plain = measured(x)
    found = measured(x + trend * (n / COUNT + 1.0))
    for one, other in zip(plain.lines, found.lines, strict=True):
        assert other.reading == pytest.approx(one.reading, rel=0.1 * one.half_width)
        assert other.half_width == pytest.approx(one.half_width, rel=0.1)
        assert other.frequency_half_width == pytest.approx(one.frequency_half_width, rel=0.1)


def test_a_burst_makes_no_sideband() -> None:
    """2 rms of noise for 1 % of the record: of sidebands more comes and goes than stays, and what
    is read where none is may be nothing."""
    random = np.random.default_rng(8)
    for first in (1500, 4000, 6500):
        x = channel(first)
        x[first : first + 80] += 2.0 * random.normal(size=80)
        record = Record((Channel("a", x, "m/s^2"),), "made", RATE, "made")
        found = measure(record, teeth=TEETH, speed=SPEED, sidebands=3, harmonics=1)
        for line in found.lines:
            if line.kind == "sideband":
                true = 0.1 if " 1 shaft" in line.name else 0.0
                assert abs(line.reading - true) < 2.0 * line.half_width * line.reading
