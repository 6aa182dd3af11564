"""Records of a gear on a shaft whose bearing has a defect, or none; no code of the package.

Rolling elements strike a defect at the bearing's rate, which slips, and each strike rings. The load
zone swells those of an inner race once a turn, those of an element once a turn of the cage.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Floats = NDArray[np.float64]
RATE = 12_800.0
SECONDS = 5.0
BEARINGS = {"6205": (9, 7.938 / 38.5), "6208": (9, 12.303 / 60.0), "6305": (7, 11.5 / 43.5)}
"""Elements and the ratio of their diameter to the pitch diameter."""
PARTS = ("outer race", "inner race", "rolling element")


def order(bearing: str, part: str) -> float:
    """Strikes in a turn of the shaft."""
    count, ratio = BEARINGS[bearing]
    rates = 0.5 * count * (1 - ratio), 0.5 * count * (1 + ratio), (1 - ratio**2) / ratio
    return rates[PARTS.index(part)]


def record(seed: int, bearing: str, part: str) -> tuple[Floats, float, int]:
    """Samples, turns of the shaft a second, teeth of the gear on it; ``part`` "": sound. Its wheel,
    which nobody names, swings the mesh line, too."""
    drawn = np.random.default_rng(seed)
    time = np.arange(int(SECONDS * RATE)) / RATE
    speed, teeth = drawn.uniform(12.0, 28.0), int(drawn.integers(17, 41))
    turns = speed * time + drawn.uniform()
    x = np.zeros(time.size)
    wheel = turns * teeth / int(drawn.integers(teeth, 100))
    swing = 1.0 + drawn.uniform(0.05, 0.3) * np.cos(2 * np.pi * turns)
    swing += drawn.uniform(0.05, 0.3) * np.cos(2 * np.pi * wheel)
    for k in (1, 2, 3):
        phase = 2 * np.pi * k * teeth * turns + drawn.uniform(0.0, 6.0)
        x += drawn.uniform(0.3, 1.5) / k * swing * np.cos(phase)
    pole = np.exp(2 * np.pi * drawn.uniform(2500.0, 5500.0) / RATE * (-0.03 + 1j))
    size, slip = drawn.uniform(0.5, 1.5), drawn.uniform(0.003, 0.01)
    # the mean is off rolling by as much as bearings slip
    rate = order(bearing, part or PARTS[0]) * speed * drawn.uniform(0.99, 1.005)
    at = np.cumsum(1.0 + slip * drawn.normal(size=int(rate * SECONDS * 1.1))) / rate
    at = at[at < SECONDS - 2 / RATE]
    cage = 0.5 * (1.0 - BEARINGS[bearing][1])
    round_ = {"inner race": speed, "rolling element": cage * speed}.get(part, 0.0)
    strength = 1.0 + 0.1 * drawn.normal(size=at.size)
    if round_:
        strength *= np.maximum(0.2, np.cos(2 * np.pi * round_ * at))
    train = np.zeros(time.size)
    np.add.at(train, (at * RATE).astype(int), strength)
    ringing = signal.lfilter([1.0], [1.0, -2 * pole.real, abs(pole) ** 2], train)
    noise = drawn.normal(size=time.size)
    return x + noise + (size / np.std(ringing) * ringing if part else 0.0), speed, teeth


def drawn_defects(count: int) -> list[tuple[int, str, str]]:
    """Seed, bearing and part of each of so many records, parts in turn."""
    names = np.random.default_rng(20261128).choice(list(BEARINGS), size=count)
    return [(81_000 + k, str(name), PARTS[k % 3]) for k, name in enumerate(names)]
