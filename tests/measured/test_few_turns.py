"""Records that hold few turns of the shaft: sidebands stand near the line that is followed."""

import numpy as np
import pytest

from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement, measure

RATE = 4000.0
TEETH = 64


def drawn(
    turns: float, wander: float, seed: int, orders: tuple[float, ...] = ()
) -> tuple[Measurement, dict[str, float], float]:
    """A record of so many ``turns``, whose speed moves as half a sine; true lines, mean mesh."""
    random = np.random.default_rng([seed, round(10 * turns)])
    mesh = random.uniform(300.0, 600.0)
    seconds = turns * TEETH / mesh
    time = np.arange(int(seconds * RATE)) / RATE
    speed = 1.0 + wander * np.sin(np.pi * time / seconds + random.uniform(0.0, 6.3))
    cycles = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))]) * mesh / RATE
    truth = {"mesh x 1": 1.0, "mesh x 1 - 1 shaft/64": 0.12, "mesh x 1 + 1 shaft/64": 0.08}
    values = 0.03 * random.normal(size=time.size)
    for order, size in zip(
        (1.0, 1.0 - 1.0 / TEETH, 1.0 + 1.0 / TEETH), truth.values(), strict=True
    ):
        values += size * np.cos(2.0 * np.pi * order * cycles + random.uniform(0.0, 6.3))
    record = Record((Channel("a", values, "m/s^2"),), "made", RATE, "made")
    found = measure(
        record,
        teeth=TEETH,
        speed=2.0 * np.pi * mesh / TEETH,
        sidebands=0 if orders else 1,
        harmonics=1,
        orders=orders,
    )
    return found, truth, (cycles[-1] - cycles[0]) / time[-1]


@pytest.mark.parametrize("turns", [4.6, 7.3])
def test_lines_about_a_followed_one_are_in_their_intervals(turns: float) -> None:
    worst = []
    for seed in range(3):
        found, truth, mesh = drawn(turns, 0.006, seed)
        lines = {line.name: line for line in found.lines}
        for name, size in truth.items():
            line = lines[name]
            worst.append(abs(line.reading / size - 1.0) / line.half_width)
        line = lines["mesh x 1"]
        assert line.half_width < 0.02
        assert abs(line.frequency - mesh) < 1.5 * line.frequency_half_width
    assert np.mean(np.array(worst) < 1.0) > 0.85
    assert max(worst) < 1.8


@pytest.mark.parametrize("turns", [1.6, 3.3])
@pytest.mark.parametrize("wander", [0.0, 0.006])
def test_sidebands_of_few_turns_are_not_read(turns: float, wander: float) -> None:
    """They would not be told from a speed that wanders."""
    found, _, _ = drawn(turns, wander, 0)
    (few,) = [one.data for one in found.notices if one.code == "few_turns"]
    assert few["turns"] == pytest.approx(turns, rel=0.02)
    assert not [line for line in found.lines if line.kind == "sideband"]
    (line,) = [line for line in found.lines if line.name == "mesh x 1"]
    if wander == 0.0:
        assert abs(line.reading - 1.0) < 1.5 * line.half_width * line.reading
