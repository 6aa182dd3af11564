"""Modulations and dips of known size in noise: what comes back; and faults of a case beside.

Averages are drawn here, without code of the package. Seeds were fixed before anything was compared.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from scipy import stats

from thermogear.base.errors import InputError
from thermogear.case.case import gear_case, load_case
from thermogear.front.measure_commands import compare
from thermogear.measured.diagnosis import ShaftAverage
from thermogear.study.diagnosis import INDICATORS, Place, place_of
from thermogear.study.faults import fault_motions

sys.path.insert(0, str(Path(__file__).parents[1] / "measured"))
from faulty_gears import Gears

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
        off = np.abs(place.depth[0] - m), np.abs(place.timing[0] - b)
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


CASE = """
[gears]
module = "3 mm"
face_width = "20 mm"
[gears.pinion]
teeth = 14
profile_shift = 0.3
[gears.wheel]
teeth = 28
[oil]
temperature = "60 degC"
[operating]
speed = "1500 rpm"
torque = "80 N m"
[temperatures]
pinion_addendum = "70 degC"
wheel_addendum = "60 degC"
pinion_bore_below_addendum = "0 K"
wheel_bore_below_addendum = "0 K"
housing_below_addendum = "0 K"
[[faults]]
kind = "pitch"
gear = "wheel"
tooth = 9
amount = "15 um"
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A case with a pitch error of the wheel; records of its gears, of a tooth that yields, too."""
    folder = tmp_path_factory.mktemp("faults")
    (folder / "case.toml").write_text(CASE)
    gears = Gears(teeth=(14, 28), speed=25.0, rate=4096.0)
    for number, (name, fault) in enumerate(
        {"h1": {}, "h2": {}, "h3": {}, "suspect": {"dip": 0.5, "lag": 0.02}}.items()
    ):
        x, turns = gears.record(95_000 + number, seconds=8.0, shaft=1, tooth=8, **fault)
        np.savez(folder / f"{name}.npz", a=x, pulse=gears.tacho(turns))
    return folder


OPTIONS = ["--rate", "4096", "--unit", "m/s^2", "--tacho", "pulse", "--pulses", "1"]


def test_a_simulated_fault_stands_beside_a_measured_one(files: Path) -> None:
    """Indicators of the motion by hand: its mean over the turns, orders by numpy's DFT."""
    healthy = [part for k in (1, 2, 3) for part in ("--baseline", str(files / f"h{k}.npz"))]
    words = ["compare", str(files / "case.toml"), str(files / "suspect.npz"), *OPTIONS, *healthy]
    done = CliRunner().invoke(compare, [*words[1:], "--json", "-o", str(files / "out")])
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    rows = told["simulated"]
    assert {row["indicator"] for row in rows} == set(INDICATORS)
    by = {(row["shaft"], row["indicator"]): row for row in rows}
    case = gear_case(load_case(CASE))
    (motion,) = fault_motions(case, told["speed"])
    z, samples = 28, motion.faulty.samples
    highest = next(row["highest"] for row in told["shafts"] if row["shaft"] == "wheel")
    for name, side in (("simulated_fault", motion.faulty), ("simulated_healthy", motion.sound)):
        whole = np.tile(side.acceleration, z // side.mesh_periods)
        assert by["wheel", "rms"][name] == pytest.approx(np.std(whole), rel=1e-9)
        lines = np.abs(np.fft.rfft(whole))[: highest + 1 : z][:6]
        fm0 = np.ptp(whole) * whole.size / (2.0 * lines[1:].sum())
        assert by["wheel", "fm0"][name] == pytest.approx(fm0, rel=1e-9)
    assert z * samples == whole.size
    # the sound motion has lines of the mesh alone: nothing to have a ratio to
    assert by["wheel", "fm4"]["simulated_healthy"] is None
    assert by["wheel", "amplitude_depth"]["measured_change"] > 0.3
    text = (files / "out" / "csv" / "simulated.csv").read_text().splitlines()
    assert len(text) == len(rows) + 1
    assert "Simulated" in (files / "out" / "diagnosis.html").read_text()


@pytest.mark.parametrize(
    ("words", "refused"),
    [
        ([], "RECORD: got none"),
        (["suspect.npz", "--at", "a=housing:y"], "--at: got a=housing:y; beside --baseline"),
        (["suspect.npz", "--set", "faults=[]"], "faults: got none; state"),
        (["h1.npz"], "--baseline: got h1.npz; the record is in the baseline"),
    ],
)
def test_what_cannot_be_compared_is_one_line(files: Path, words: list[str], refused: str) -> None:
    named = [str(files / word) if word.endswith("npz") else word for word in words]
    given = [str(files / "case.toml"), *named, *OPTIONS, "--baseline", str(files / "h1.npz")]
    with pytest.raises(InputError, match=f"^{refused}"):
        compare.main(given, standalone_mode=False)
