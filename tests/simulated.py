"""Records that a simulation would have given."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from thermogear.measured.record import Channel, Record

Floats = NDArray[np.float64]


def simulated_record(
    displacement: Floats, periods: int, *, mesh_frequency: float, rate: float, samples: int
) -> Record:
    """A periodic motion as the acceleration record that a sensor would give of it [m/s^2].

    ``displacement`` [m]: uniform samples over ``periods`` whole mesh periods, the first at phase
    0; ``mesh_frequency`` [Hz]; ``rate`` [1/s] and ``samples`` those of the record it is to be
    compared with: then ``measure`` with that record's chain reads like from like. Lines above
    half the rate do not reach the record, as behind an anti-alias filter.
    """
    x = np.asarray(displacement, dtype=float)
    lines = np.fft.rfft(x) * (2.0 / x.size)
    t = np.arange(samples) / rate
    total = np.zeros(samples)
    strongest = float(np.max(np.abs(lines[1:])))
    for rank in range(1, (x.size + 1) // 2):
        frequency = rank * mesh_frequency / periods
        if frequency >= 0.5 * rate or abs(lines[rank]) <= 1e-12 * strongest:
            continue
        omega = 2.0 * np.pi * frequency
        total -= omega**2 * np.real(lines[rank] * np.exp(1j * omega * t))
    return Record((Channel("simulated", total, "m/s^2"),), "simulation", rate, "simulated")
