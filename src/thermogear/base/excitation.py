"""All that dynamics knows of a gear pair: periodic stiffness and error, half backlash, force."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Periodic:
    """A real periodic function of the phase as a finite Fourier series.

    p(phi) = mean + Re sum_{q=1..Q} harmonics[q-1] exp(2 pi i q phi),   phi in periods.

    A cosine of amplitude a and phase angle beta, a cos(2 pi phi + beta), is the one
    harmonic a exp(i beta). ``mean`` and ``harmonics`` share one unit.
    """

    mean: float
    harmonics: tuple[complex, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", float(self.mean))
        object.__setattr__(self, "harmonics", tuple(complex(c) for c in self.harmonics))
        if not np.all(np.isfinite([self.mean, *self.harmonics])):
            raise InputError("periodic", self.mean, allowed="finite numbers")

    @classmethod
    def from_samples(cls, samples: ArrayLike, harmonics: int | None = None) -> Periodic:
        """The series through uniform ``samples`` [any unit] over one period, phase 0 first.

        ``harmonics`` keeps the first so many; the default keeps all below the Nyquist
        limit, floor((n - 1)/2), so that the series passes through an odd number of
        samples exactly.
        """
        values = np.asarray(samples, dtype=float)
        if values.ndim != 1 or values.size < 1 or not np.all(np.isfinite(values)):
            raise InputError("samples", values.shape, allowed="a finite 1-D array, one period")
        spectrum = np.fft.rfft(values) / values.size
        most = (values.size - 1) // 2
        kept = most if harmonics is None else min(harmonics, most)
        return cls(float(spectrum[0].real), tuple(2.0 * spectrum[1 : kept + 1]))

    def __call__(self, phase: ArrayLike) -> Floats:
        """Values at ``phase`` (in periods, any shape)."""
        phi = np.asarray(phase, dtype=float)
        total = np.full(phi.shape, self.mean)
        for order, amplitude in enumerate(self.harmonics, start=1):
            if amplitude != 0.0:
                total = total + (amplitude * np.exp(2j * np.pi * order * phi)).real
        return total

    def samples(self, count: int) -> Floats:
        """``count`` uniform samples over one period, phase 0 first."""
        return self(np.arange(count) / count)

    def derivative(self, order: int = 1) -> Periodic:
        """d^order p/d phi^order, phase in periods."""
        ranks = np.arange(1, len(self.harmonics) + 1)
        return Periodic(0.0, tuple(np.asarray(self.harmonics) * (2j * np.pi * ranks) ** order))

    def __add__(self, other: Periodic | float) -> Periodic:
        if not isinstance(other, Periodic):
            return Periodic(self.mean + float(other), self.harmonics)
        width = max(len(self.harmonics), len(other.harmonics))
        mine = np.zeros(width, complex)
        mine[: len(self.harmonics)] = self.harmonics
        mine[: len(other.harmonics)] += other.harmonics
        return Periodic(self.mean + other.mean, tuple(mine))

    def __mul__(self, factor: float) -> Periodic:
        return Periodic(self.mean * factor, tuple(c * factor for c in self.harmonics))

    __rmul__ = __mul__


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """One operating point of a gear pair as its vibration sees it (SI).

    m_e x'' + c x' + k(t) f(x; b') = F + m_e * (-e''),   x = r_b1 theta_1 - r_b2 theta_2 - e(t),

    f the dead zone of half width b' = ``half_backlash``. ``stiffness`` k [N/m] and ``error`` e
    [m] are periodic in the mesh phase; e is the unloaded (kinematic) error, never the loaded
    transmission error; for perfect gears e = 0. ``reference_half_backlash`` b_c [m] (the cold
    one) is the length scale of the dimensionless equation. ``mean_force`` F [N],
    ``mesh_frequency`` [rad/s], ``inertias`` [kg m^2], ``base_radii`` [m] and ``torques`` [N m]
    of pinion and wheel. ``damping_ratio`` zeta refers to omega_n = sqrt(k_m/m_e), k_m the time
    mean of k.
    """

    stiffness: Periodic
    error: Periodic
    half_backlash: float
    reference_half_backlash: float
    mean_force: float
    mesh_frequency: float
    inertias: tuple[float, float]
    base_radii: tuple[float, float]
    torques: tuple[float, float]
    damping_ratio: float

    def __post_init__(self) -> None:
        positive = {
            "stiffness": self.stiffness.mean,
            "half_backlash": self.half_backlash,
            "reference_half_backlash": self.reference_half_backlash,
            "mesh_frequency": self.mesh_frequency,
            "inertias": min(self.inertias),
            "base_radii": min(self.base_radii),
        }
        for name, value in positive.items():
            if not (np.isfinite(value) and value > 0):
                raise InputError(name, value, allowed="> 0")
        if not (np.isfinite(self.damping_ratio) and self.damping_ratio >= 0):
            raise InputError("damping_ratio", self.damping_ratio, allowed=">= 0")

    @property
    def equivalent_mass(self) -> float:
        """m_e = I1 I2/(I1 r_b2^2 + I2 r_b1^2) [kg]."""
        (i1, i2), (r1, r2) = self.inertias, self.base_radii
        return i1 * i2 / (i1 * r2**2 + i2 * r1**2)

    @property
    def natural_frequency(self) -> float:
        """omega_n = sqrt(k_m/m_e) [rad/s]."""
        return float(np.sqrt(self.stiffness.mean / self.equivalent_mass))
