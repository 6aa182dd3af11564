"""Records with known teeth, or with none: what ``make trial-teeth`` scores ``measure`` by.

Kinds, seeds and laws were fixed before the first record was scored. Everything is drawn from
``default_rng([seed, number])``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import signal

Floats = NDArray[np.float64]
Random = np.random.Generator

DEVELOPMENT = 11_2026
HELD_BACK = 47_2026
"""Held back for the finder as it is; 292026, 532026, 742026, 952026 and 612026 were for earlier
ones."""
GEARED = ("pinion", "wheel", "both", "first harmonic", "two stages", "product", "swing")
BEARINGS = ("periodic impacts", "slipping impacts", "motor")
RATES = (25_600.0, 12_800.0, 5120.0)
MOST = 400_000  # samples of a record


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A true mesh: ``position`` [cycles/sample] and the teeth of its two gears."""

    position: float
    teeth: tuple[int, int]


@dataclass(frozen=True, kw_only=True)
class Made:
    """A record (channel, sample) and its truth.

    ``modulation``: of the gear that is modulated most, ``level`` [dB]: the first mesh line's
    power over that of all the noise, ``unbalance``: shaft line over mesh line, ``impacts``: their
    rate [cycles/sample].
    """

    kind: str
    number: int
    rate: float
    table: Floats
    meshes: tuple[Mesh, ...]
    shaft: float
    modulation: float = 0.0
    level: float = 0.0
    unbalance: float = 0.0
    wander: float = 0.0
    impacts: float = float("nan")

    @property
    def clear(self) -> bool:
        """Sidebands of 3 % or more, 20 dB between line and noise."""
        return bool(self.meshes) and self.modulation >= 0.03 and self.level >= 20.0


def made(kind: str, number: int, seed: int) -> Made:
    """Record ``number`` of a kind."""
    random = np.random.default_rng([seed, number])
    own = {"product": _product, "swing": _product, "motor": _motor}
    if kind in own:
        return own[kind](kind, number, random)
    return _bearing(kind, number, random) if kind in BEARINGS else _geared(kind, number, random)


def drawn(seed: int, geared: int, bearings: int) -> list[tuple[str, int, int]]:
    """Kinds and numbers of a set: ``geared`` and ``bearings`` records, the kinds in turn."""
    kinds = [GEARED[i % len(GEARED)] for i in range(geared)]
    kinds += [BEARINGS[i % len(BEARINGS)] for i in range(bearings)]
    return [(kind, i, seed) for i, kind in enumerate(kinds)]


def _between(random: Random, low: float, high: float) -> float:
    """Log-uniform."""
    return float(np.exp(random.uniform(np.log(low), np.log(high))))


def _clock(random: Random) -> tuple[float, int]:
    seconds = _between(random, 3.0, 60.0)
    fitting = [rate for rate in RATES if rate * seconds <= MOST]
    rate = float(random.choice(fitting)) if fitting else RATES[-1]
    return rate, int(min(seconds * rate, MOST))


def _wandering(random: Random, count: int) -> tuple[Floats, float]:
    """Samples of a time that runs 0 or 0.01 to 0.1 % (rms) fast and slow."""
    place = np.arange(count, dtype=float)
    if random.uniform() < 0.5:
        return place, 0.0
    rms = _between(random, 1e-4, 1e-3)
    slow = np.zeros(count)
    for rank in range(1, 4):
        turn = 2 * np.pi * rank / count
        slow += random.normal() / turn * np.sin(turn * place + random.uniform(0, 2 * np.pi))
    return place + slow * rms / np.std(np.diff(slow)), rms


def _swinging(random: Random, count: int, rate: float) -> tuple[Floats, float]:
    """Samples of a time that swings by 0.05 to 2 % (amplitude) at 0.2 to 3 Hz, as a speed control
    or a slow torsional mode makes it."""
    place = np.arange(count, dtype=float)
    size = _between(random, 5e-4, 2e-2)
    turn = 2 * np.pi * _between(random, 0.2, 3.0) / rate
    swing = size / turn * np.sin(turn * place + random.uniform(0, 2 * np.pi))
    return place + swing, size / float(np.sqrt(2.0))


def _transfer(random: Random, channels: int) -> list[list[tuple[float, float, complex]]]:
    """Modes of each channel: frequency [cycles/sample], damping, share."""
    modes = [(random.uniform(0.02, 0.45), _between(random, 0.01, 0.05)) for _ in range(3)]
    return [
        [(f, d, 0.5 * complex(*random.normal(size=2))) for f, d in modes] for _ in range(channels)
    ]


def _gain(modes: list[tuple[float, float, complex]], position: float) -> complex:
    total = 1.0 + 0.0j
    for f, damping, share in modes:
        ratio = position / f
        total += share * ratio**2 / (1.0 - ratio**2 + 2j * damping * ratio)
    return total


def _mesh_lines(
    random: Random, mesh: float, depths: dict[float, float], only_first: bool
) -> list[tuple[float, complex]]:
    """Lines (position, amplitude) of a mesh line of 1 whose shafts modulate by ``depths``."""
    lines: list[tuple[float, complex]] = []
    for rank in range(1, 7):
        height = 1.0 if rank == 1 else float(np.exp(random.normal(-0.7 * (rank - 1), 0.5)))
        turned = np.exp(2j * np.pi * random.uniform())
        lines.append((rank * mesh, height * turned))
        if only_first and rank > 1:
            continue
        for shaft, depth in depths.items():
            for n, share in ((1, 1.0), (2, random.uniform(0, 0.6)), (3, random.uniform(0, 0.4))):
                lean = random.uniform(-0.5, 0.5)
                for side in (-1, 1):
                    phase = np.exp(2j * np.pi * random.uniform())
                    one = 0.5 * height * depth * share * (1 + side * lean)
                    lines.append((rank * mesh + side * n * shaft, one * phase))
        shafts = list(depths.items())
        if len(shafts) == 2:
            (one, a), (two, b) = shafts
            for s in (-1, 1):
                for t in (-1, 1):
                    phase = np.exp(2j * np.pi * random.uniform())
                    lines.append((rank * mesh + s * one + t * two, 0.25 * height * a * b * phase))
    return lines


def _shaft_lines(random: Random, shaft: float, height: float) -> list[tuple[float, complex]]:
    shares = (1.0, random.uniform(0, 0.5), random.uniform(0, 0.3))
    return [
        (n * shaft, height * share * np.exp(2j * np.pi * random.uniform()))
        for n, share in enumerate(shares, 1)
    ]


def _teeth(random: Random) -> tuple[int, int]:
    one = int(random.integers(15, 46))
    return one, max(one, min(120, int(one * random.uniform(1.0, 4.0))))


def _swapped(random: Random, depths: dict[float, float]) -> dict[float, float]:
    """The two depths as they are, or exchanged."""
    if random.uniform() < 0.5:
        return depths
    return dict(zip(depths, reversed(depths.values()), strict=True))


def _geared(kind: str, number: int, random: Random) -> Made:
    rate, count = _clock(random)
    teeth = _teeth(random)
    shaft = random.uniform(10.0, 50.0)
    shaft = min(shaft, 0.2 * rate / teeth[0]) / rate
    mesh = shaft * teeth[0]
    slow = mesh / teeth[1]
    depth = _between(random, 0.01, 0.20)
    other = depth * _between(random, 0.1, 1.0)
    unbalance = _between(random, 0.01, 10.0)
    depths = {
        "pinion": {shaft: depth},
        "wheel": {slow: depth},
        "both": {shaft: depth, slow: other}
        if random.uniform() < 0.5
        else {shaft: other, slow: depth},
        "first harmonic": {(shaft if random.uniform() < 0.5 else slow): depth},
        "two stages": {shaft: depth, slow: other},
    }[kind]
    lines = _mesh_lines(random, mesh, depths, kind == "first harmonic")
    lines += _shaft_lines(random, shaft, unbalance)
    lines += _shaft_lines(random, slow, unbalance * _between(random, 0.03, 1.0))
    meshes = [Mesh(position=mesh, teeth=teeth)]
    if kind == "two stages":
        third = _teeth(random)
        second = slow * third[0]
        last = second / third[1]
        height = _between(random, 0.3, 2.0)
        own = {slow: other, last: _between(random, 0.01, 0.2)}
        lines += [(p, height * a) for p, a in _mesh_lines(random, second, own, False)]
        lines += _shaft_lines(random, last, 0.3 * unbalance * random.uniform())
        meshes.append(Mesh(position=second, teeth=third))
    level = random.uniform(20.0, 30.0) if random.uniform() < 0.6 else random.uniform(-10.0, 20.0)
    angle, wander = _wandering(random, count)
    channels = int(random.integers(1, 3))
    table = np.zeros((channels, count))
    for modes, row in zip(_transfer(random, channels), table, strict=True):
        for position, amplitude in lines:
            if 0.0 < position < 0.48:
                put = amplitude * _gain(modes, position)
                if abs(put) > 1e-5:
                    turn = 2 * np.pi * position * angle + float(np.angle(put))
                    row += abs(put) * np.cos(turn)
        line = abs(_gain(modes, mesh)) / np.sqrt(2.0)
        row += line * 10 ** (-level / 20) * _coloured(random, count)
    mean_rate = float((angle[-1] - angle[0]) / (count - 1))
    return Made(
        kind=kind,
        number=number,
        rate=rate,
        table=table,
        meshes=tuple(Mesh(position=m.position * mean_rate, teeth=m.teeth) for m in meshes),
        shaft=shaft * mean_rate,
        modulation=depth,
        level=level,
        unbalance=unbalance,
        wander=wander,
    )


def _coloured(random: Random, count: int) -> Floats:
    """Noise of unit power: white, or half of it through a mode."""
    white = random.normal(size=count)
    if random.uniform() < 0.5:
        return white
    f, damping = random.uniform(0.05, 0.4), _between(random, 0.02, 0.1)
    pole = np.exp(2 * np.pi * f * (-damping + 1j))
    ringing = signal.lfilter(
        [1.0], [1.0, -2 * pole.real, abs(pole) ** 2], random.normal(size=count)
    )
    return np.asarray((white + ringing / np.std(ringing)) / np.sqrt(2.0))


def _bearing(kind: str, number: int, random: Random) -> Made:
    rate, count = _clock(random)
    shaft = random.uniform(10.0, 50.0) / rate
    balls, g = int(random.integers(7, 17)), random.uniform(0.12, 0.3)
    inner = random.uniform() < 0.5
    order = 0.5 * balls * (1 + g if inner else 1 - g)
    if random.uniform() < 0.2:
        order = 1.0  # a rub once a turn
    period = 1.0 / (order * shaft)
    number_of = int(count / period) + 2
    slip = _between(random, 0.003, 0.02) if kind == "slipping impacts" else 0.0
    times = period * (random.uniform() + np.cumsum(1.0 + slip * random.normal(size=number_of)))
    times = times[times < count - 2]
    swing = random.uniform(0.0, 0.8) if inner else 0.0
    strength = 1.0 + swing * np.cos(2 * np.pi * shaft * times)
    strength *= 1.0 + 0.1 * random.normal(size=times.size)
    train = np.zeros(count)
    whole = times.astype(int)
    share = times - whole
    # an impact between two samples is parted on both
    np.add.at(train, whole, strength * (1 - share))
    np.add.at(train, whole + 1, strength * share)
    ringing = np.zeros(count)
    for _ in range(int(random.integers(1, 4))):
        f, damping = random.uniform(0.08, 0.42), _between(random, 0.01, 0.06)
        pole = np.exp(2 * np.pi * f * (-damping + 1j))
        mode = signal.lfilter([0, pole.imag], [1.0, -2 * pole.real, abs(pole) ** 2], train)
        ringing += random.uniform(0.3, 1.0) * mode
    power = float(np.std(ringing))
    x = ringing / power
    unbalance = _between(random, 0.01, 10.0)
    place = np.arange(count)
    for position, amplitude in _shaft_lines(random, shaft, unbalance):
        x = x + abs(amplitude) * np.cos(2 * np.pi * position * place + float(np.angle(amplitude)))
    level = random.uniform(-5.0, 25.0)
    x = x + 10 ** (-level / 20) * _coloured(random, count)
    return Made(
        kind=kind,
        number=number,
        rate=rate,
        table=x[None, :],
        meshes=(),
        shaft=shaft,
        level=level,
        unbalance=unbalance,
        impacts=1.0 / period,
    )


def _product(kind: str, number: int, random: Random) -> Made:
    """The textbook's gear: harmonics times (1 + m cos) of one shaft or of both, nothing else but
    shaft lines in half of the records and white noise. "Swing": its speed swings."""
    rate, count = _clock(random)
    teeth = _teeth(random)
    shaft = min(random.uniform(10.0, 50.0), 0.2 * rate / teeth[0]) / rate
    mesh, slow = shaft * teeth[0], shaft * teeth[0] / teeth[1]
    if kind == "swing":
        angle, wander = _swinging(random, count, rate)
    else:
        angle, wander = _wandering(random, count)
    depth = _between(random, 0.01, 0.20)
    other = depth * _between(random, 0.1, 1.0) if random.uniform() < 0.5 else 0.0
    depths = [depth, other] if random.uniform() < 0.5 else [other, depth]
    factor = np.ones(count)
    phase = np.zeros(count)
    by_phase = random.uniform() < 0.3
    for position, m in zip((shaft, slow), depths, strict=True):
        turn = np.cos(2 * np.pi * position * angle + random.uniform(0, 2 * np.pi))
        if by_phase:
            phase += m * turn
        else:
            factor *= 1.0 + m * turn
    highest, fall = int(random.integers(1, 6)), random.uniform(0.2, 1.2)
    only_first = random.uniform() < 0.2
    x = np.zeros(count)
    for rank in range(1, highest + 1):
        if rank * mesh > 0.48:
            break
        modulated = rank == 1 or not only_first
        turn = 2 * np.pi * rank * mesh * angle + random.uniform(0, 2 * np.pi)
        wave = np.cos(turn + rank * phase) * factor if modulated else np.cos(turn)
        x += np.exp(-fall * (rank - 1)) * wave
    unbalance = _between(random, 0.01, 10.0) if random.uniform() < 0.5 else 0.0
    x += unbalance * np.cos(2 * np.pi * shaft * angle + random.uniform(0, 2 * np.pi))
    level = random.uniform(20.0, 30.0) if random.uniform() < 0.6 else random.uniform(-10.0, 20.0)
    x += 10 ** (-level / 20) / np.sqrt(2.0) * random.normal(size=count)
    mean_rate = float((angle[-1] - angle[0]) / (count - 1))
    return Made(
        kind=kind,
        number=number,
        rate=rate,
        table=x[None, :],
        meshes=(Mesh(position=mesh * mean_rate, teeth=teeth),),
        shaft=shaft * mean_rate,
        modulation=depth,
        level=level,
        unbalance=unbalance,
        wander=wander,
    )


def _motor(kind: str, number: int, random: Random) -> Made:
    """A bearing's record on a rig with an induction motor: even multiples of the mains, rotor bars
    with the mains beside, both with the slip's sidebands."""
    bearing = _bearing("slipping impacts", number, random)
    rate, count = bearing.rate, bearing.table.shape[-1]
    mains = float(random.choice([50.0, 60.0])) / rate
    slip = random.uniform(0.005, 0.05)
    shaft = mains / int(random.integers(1, 4)) * (1.0 - slip)
    bars = int(random.integers(26, 62))
    lines = [(2 * k * mains, _between(random, 0.02, 1.0)) for k in range(1, 6)]
    lines += [(n * shaft, _between(random, 0.05, 1.0)) for n in range(1, 9)]
    slots = _between(random, 0.1, 3.0)
    lines += [
        (bars * shaft + 2 * k * mains, slots * _between(random, 0.1, 1.0)) for k in range(-2, 3)
    ]
    beside = _between(random, 0.01, 0.2)
    lines += [(p + s * 2 * slip * mains, a * beside) for p, a in lines for s in (-1, 1)]
    x = bearing.table[0].copy()
    place = np.arange(count)
    for position, amplitude in lines:
        if 0.0 < position < 0.48:
            x += amplitude * np.cos(2 * np.pi * position * place + random.uniform(0, 2 * np.pi))
    return Made(
        kind=kind,
        number=number,
        rate=rate,
        table=x[None, :],
        meshes=(),
        shaft=shaft,
        level=bearing.level,
        impacts=bearing.impacts,
    )
