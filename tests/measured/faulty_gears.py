"""Vibration of a gear pair drawn tooth by tooth, healthy or with a fault; no code of the package.

Each mesh harmonic k has an amplitude and a phase that vary over both gears' turns: a run-out once a
turn and small differences from tooth to tooth. A fault of one tooth takes a share of the amplitude
away over its contact and delays it, alike at every k, as a tooth that yields does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
MESH = (1.0, 0.6, 0.35)
"""Amplitudes of the mesh harmonics [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class Gears:
    """A pair of ``teeth`` that turns ``speed`` [turns/s], sampled ``rate`` times a second."""

    teeth: tuple[int, int] = (19, 48)
    speed: float = 25.0
    rate: float = 8192.0
    noise: float = 0.3
    scatter: float = 0.01
    """Of the teeth: relative amplitude, and of a pitch."""
    assembly: float = 0.05
    """From record to record: of amplitudes, run-out and noise."""

    def record(
        self,
        seed: int,
        *,
        seconds: float = 4.0,
        shaft: int = 0,
        tooth: int = 0,
        dip: float = 0.0,
        lag: float = 0.0,
        gears: int = 0,
    ) -> tuple[Floats, Floats]:
        """Samples [m/s^2] and the pinion's turns; ``dip`` of the amplitude and ``lag`` [pitches] of
        the ``tooth`` of ``shaft`` 0 or 1; ``gears``: the seed of teeth and run-out."""
        drawn, same = np.random.default_rng(seed), np.random.default_rng(gears)
        time = np.arange(int(seconds * self.rate)) / self.rate
        turns = self.speed * (1.0 + 2e-4 * drawn.normal()) * time + drawn.uniform()
        turns = turns + 2e-4 * np.sin(2 * np.pi * 0.4 * time + drawn.uniform(0, 6.0))
        amplitude, delay = np.ones(time.size), np.zeros(time.size)
        for number, teeth in enumerate(self.teeth):
            place = (turns * self.teeth[0] / teeth) % 1.0
            depth = 0.04 * np.exp(self.assembly * drawn.normal())
            amplitude += depth * np.cos(2 * np.pi * place + same.uniform(0, 6.0))
            for target in (amplitude, delay):
                values = self.scatter * same.normal(size=teeth)
                target += np.interp(place * teeth, np.arange(teeth) + 0.5, values, period=teeth)
            if number == shaft:
                off = (place * teeth - tooth - 0.5 + teeth / 2) % teeth - teeth / 2
                bump = np.exp(-0.5 * (off / 0.5) ** 2)
                amplitude *= 1.0 - dip * bump
                delay += lag * bump
        x = self.noise * np.exp(self.assembly * drawn.normal()) * drawn.normal(size=time.size)
        gain = np.exp(self.assembly * drawn.normal())
        for k, size in enumerate(MESH, start=1):
            cycles = k * (self.teeth[0] * turns - delay)
            x += gain * size * amplitude * np.cos(2 * np.pi * cycles + 0.7 * k)
        return x, turns

    def tacho(self, turns: Floats) -> Floats:
        """One pulse a turn, of a twentieth of it."""
        return np.where(turns % 1.0 < 0.05, 5.0, 0.0)
