"""All that dynamics knows of a gear pair: periodic stiffness and error, half backlash, force."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base import fourier
from thermogear.base.arrays import Floats, rows_at
from thermogear.base.errors import InputError
from thermogear.base.period import Period
from thermogear.base.pieces import Pieces
from thermogear.base.vocabulary import moves

_FAR = 1e9
"""Periods: phases beyond, inf and nan too, go the way of arrays."""


@dataclass(frozen=True)
class Periodic:
    """A real periodic function of the phase as a finite Fourier series.

    p(phi) = mean + Re sum_{q=1..Q} harmonics[q-1] exp(2 pi i q phi),   phi in periods.

    A cosine of amplitude a and phase angle beta, a cos(2 pi phi + beta), is the one
    harmonic a exp(i beta). ``mean`` and ``harmonics`` share one unit.

    >>> stiffness = Periodic(3e8, (5e7,))
    >>> stiffness([0.0, 0.5])
    array([3.5e+08, 2.5e+08])
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
        row = fourier_rows(values[None], values.size if harmonics is None else harmonics)[0]
        return cls(float(row[0].real), tuple(row[1:]))

    @staticmethod
    def columns(rows: Sequence[Periodic]) -> NDArray[np.complex128]:
        """The coefficients of several series, (row, 1 + harmonic), the mean first."""
        found = np.zeros((len(rows), 1 + max(len(one.harmonics) for one in rows)), complex)
        for place, one in enumerate(rows):
            found[place, : 1 + len(one.harmonics)] = [one.mean, *one.harmonics]
        return found

    def __call__(self, phase: ArrayLike) -> Floats:
        """Values at ``phase`` (in periods, any shape)."""
        phi = np.asarray(phase, dtype=float)
        if len(self.harmonics) > fourier.MANY:
            return np.asarray(fourier.values(self.columns([self]), phi)[0])[()]
        if phi.ndim == 0 and self.harmonics and abs(phi) < _FAR:
            return self._one(float(phi))
        total = np.full(phi.shape, self.mean)
        for order, amplitude in enumerate(self.harmonics, start=1):
            if amplitude != 0.0:
                total = total + (amplitude * np.exp(2j * np.pi * order * phi)).real
        return total

    def _one(self, phi: float) -> Floats:
        """The value at one phase, to the last digit that of arrays, in a tenth of their time."""
        total = self.mean
        for order, amplitude in enumerate(self.harmonics, start=1):
            if amplitude != 0.0:
                angle = 2.0 * math.pi * order * phi
                total += amplitude.real * math.cos(angle) - amplitude.imag * math.sin(angle)
        value: Floats = np.asarray(total)[()]
        return value

    def derivative(self, order: int = 1) -> Periodic:
        """d^order p/d phi^order, phase in periods."""
        ranks = np.arange(1, len(self.harmonics) + 1)
        return Periodic(0.0, tuple(np.asarray(self.harmonics) * (2j * np.pi * ranks) ** order))

    def __add__(self, other: Periodic | float) -> Periodic:
        if not isinstance(other, Periodic):
            return Periodic(self.mean + float(other), self.harmonics)
        mine = np.zeros(max(len(self.harmonics), len(other.harmonics)), complex)
        mine[: len(self.harmonics)] = self.harmonics
        mine[: len(other.harmonics)] += other.harmonics
        return Periodic(self.mean + other.mean, tuple(mine))

    def __mul__(self, factor: float) -> Periodic:
        return Periodic(self.mean * factor, tuple(c * factor for c in self.harmonics))

    __rmul__ = __mul__


@dataclass(frozen=True, kw_only=True)
class FrictionSplit:
    """Friction of the teeth per unit of the drive flank's force, over the mesh phase.

    chi_0 = sum of share mu sign over the tooth pairs, ``at_pitch`` [-], and chi_1 = sum of share mu
    sign s, ``per_metre`` [m], with s [m] from the pitch point, + in recess, and sign +1 there. The
    generalised friction force of a mesh under F_d is F_d (chi_0 p_0 + chi_1 p_1), p_0 and p_1
    the columns of :attr:`~thermogear.shafts.mesh_lines.MeshFrame.friction_columns`. Both functions
    have the same starts of pieces. chi_0 jumps where a pair passes the pitch point, and where one
    enters or leaves under load; elsewhere two pieces meet within the accuracy of their fit.

    >>> none = Pieces.constant(starts=[0.0], values=[0.0])
    >>> FrictionSplit(at_pitch=none, per_metre=none).at_pitch.mean
    0.0
    """

    at_pitch: Pieces
    per_metre: Pieces

    def __post_init__(self) -> None:
        if self.at_pitch.starts != self.per_metre.starts:
            raise InputError("friction.starts", "two lists", allowed="the same for both functions")


@dataclass(frozen=True, kw_only=True)
class Excitation:
    """One operating point of a gear pair as its vibration sees it (SI).

    m_e x'' + c x' + k(t) f(x; b') = F + m_e * (-e''),   x = r_b1 theta_1 - r_b2 theta_2 - e(t),

    f the dead zone of half width b' = ``half_backlash``. ``stiffness`` k [N/m] and ``error`` e
    [m] repeat after ``mesh_periods`` mesh periods, 1 where all teeth are alike; their phase counts
    these periods. e is the unloaded (kinematic) error, never the loaded transmission error; for
    perfect gears e = 0. ``reference_half_backlash`` b_c [m] (the cold
    one) is the length scale of the dimensionless equation. ``mean_force`` F [N],
    ``mesh_frequency`` [rad/s], ``inertias`` [kg m^2], ``base_radii`` [m] and ``torques`` [N m]
    of pinion and wheel. ``damping_ratio`` zeta refers to omega_n = sqrt(k_m/m_e), k_m the time
    mean of k. ``friction`` of the teeth where it was asked for; x itself does not feel it.
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
    friction: FrictionSplit | None = None
    mesh_periods: int = 1

    def __post_init__(self) -> None:
        Period(self.mesh_periods)
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


@dataclass(frozen=True, kw_only=True, eq=False)
class Excitations:
    """Operating points side by side as their vibration sees them: :class:`Excitation` in columns.

    The first axis of every array is the point. ``status`` as a mesh cycle's: 0 where the point
    moves, else its other numbers mean nothing. ``stiffness`` and ``error`` are Fourier
    coefficients (point, 1 + harmonic), the mean first, as :class:`Periodic` has them;
    ``inertias``, ``base_radii`` and ``torques`` (point, 2); everything in SI. ``friction``: one
    for each point, or None where it was not asked for. ``mesh_periods``, one number for all points:
    after so many mesh periods stiffness and error repeat.
    """

    status: NDArray[np.int8]
    stiffness: NDArray[np.complex128]
    error: NDArray[np.complex128]
    half_backlash: Floats
    reference_half_backlash: Floats
    mean_force: Floats
    mesh_frequency: Floats
    inertias: Floats
    torques: Floats
    damping_ratio: Floats
    base_radii: Floats
    friction: tuple[FrictionSplit | None, ...] | None = None
    mesh_periods: int = 1

    def __len__(self) -> int:
        return self.status.size

    @property
    def equivalent_mass(self) -> Floats:
        """m_e [kg], (point,)."""
        (i1, i2), (r1, r2) = self.inertias.T, self.base_radii.T
        return np.asarray(i1 * i2 / (i1 * r2**2 + i2 * r1**2))

    @property
    def natural_frequency(self) -> Floats:
        """omega_n [rad/s], (point,); nan where nothing moves."""
        mean = np.where(moves(self.status), self.stiffness[:, 0].real, np.nan)
        return np.sqrt(mean / self.equivalent_mass)

    def take(self, index: ArrayLike) -> Excitations:
        """Some of the points, in that order."""
        chosen = np.atleast_1d(np.asarray(index))
        rubbed = self.friction
        if rubbed is not None:
            rubbed = tuple(rubbed[i] for i in np.arange(len(self))[chosen])
        arrays = [field.name for field in fields(self) if field.name not in _OF_ALL]
        place = np.arange(len(self))[chosen]
        taken: dict[str, Any] = {name: rows_at(getattr(self, name), place) for name in arrays}
        return replace(self, **taken, friction=rubbed)

    @classmethod
    def of(cls, rows: Sequence[Excitation]) -> Excitations:
        """Single ones of one period side by side; all of them move."""

        def column(name: str) -> Floats:
            return np.array([getattr(one, name) for one in rows], dtype=float)

        return cls(
            status=np.zeros(len(rows), np.int8),
            stiffness=Periodic.columns([one.stiffness for one in rows]),
            error=Periodic.columns([one.error for one in rows]),
            half_backlash=column("half_backlash"),
            reference_half_backlash=column("reference_half_backlash"),
            mean_force=column("mean_force"),
            mesh_frequency=column("mesh_frequency"),
            inertias=column("inertias"),
            torques=column("torques"),
            damping_ratio=column("damping_ratio"),
            base_radii=column("base_radii"),
            friction=_asked([(one.friction,) for one in rows]),
            mesh_periods=common_period(rows),
        )

    @classmethod
    def joined(cls, parts: Sequence[Excitations]) -> Excitations:
        """All points of ``parts``, one after the other; they have one period."""
        if len(parts) == 1:
            return parts[0]
        spread = [one.friction or (None,) * len(one) for one in parts]
        made: dict[str, Any] = {"friction": _asked(spread), "mesh_periods": common_period(parts)}
        for field in fields(cls):
            if field.name in made:
                continue
            given = [getattr(one, field.name) for one in parts]
            if field.name in ("stiffness", "error"):
                width = max(one.shape[1] for one in given)
                made[field.name] = np.concatenate([padded(one, width) for one in given])
            else:
                made[field.name] = np.concatenate(given)
        return cls(**made)

    def one(self, place: int) -> Excitation | None:
        """One point by itself; None where it does not move."""
        if not moves(self.status[place]):
            return None
        stiffness, error = (
            Periodic(float(row[0].real), tuple(row[1:]))
            for row in (self.stiffness[place], self.error[place])
        )
        inertias, radii, torques = (
            (float(both[place, 0]), float(both[place, 1]))
            for both in (self.inertias, self.base_radii, self.torques)
        )
        return Excitation(
            stiffness=stiffness,
            error=error,
            half_backlash=float(self.half_backlash[place]),
            reference_half_backlash=float(self.reference_half_backlash[place]),
            mean_force=float(self.mean_force[place]),
            mesh_frequency=float(self.mesh_frequency[place]),
            inertias=inertias,
            base_radii=radii,
            torques=torques,
            damping_ratio=float(self.damping_ratio[place]),
            friction=None if self.friction is None else self.friction[place],
            mesh_periods=self.mesh_periods,
        )


_OF_ALL = ("friction", "mesh_periods")
"""Fields of :class:`Excitations` that are no arrays over the points."""


def common_period(rows: Sequence[Excitation] | Sequence[Excitations]) -> int:
    """The period that all ``rows`` have; InputError where they differ."""
    every = {one.mesh_periods for one in rows}
    if len(every) != 1:
        raise InputError(
            "gears.period",
            f"points that come again after {sorted(every)} mesh periods",
            allowed="one number for all points",
            why="teeth are alike at some of them and differ at others, as with a fault of no size",
            fix="leave the value out at which the teeth are alike",
        )
    return every.pop()


def _asked(
    parts: Sequence[tuple[FrictionSplit | None, ...]],
) -> tuple[FrictionSplit | None, ...] | None:
    """The friction of all points; None where none has any."""
    found = tuple(one for part in parts for one in part)
    return found if any(one is not None for one in found) else None


def padded(rows: NDArray[Any], width: int) -> NDArray[Any]:
    """``rows`` with columns of 0 up to ``width``."""
    return rows if rows.shape[1] == width else np.pad(rows, ((0, 0), (0, width - rows.shape[1])))


def fourier_rows(samples: Floats, harmonics: int) -> NDArray[np.complex128]:
    """:meth:`Periodic.from_samples` of every row: coefficients (row, 1 + harmonic)."""
    size = samples.shape[1]
    spectrum = np.fft.rfft(samples, axis=1) / size
    kept = min(harmonics, (size - 1) // 2)
    found = np.asarray(spectrum[:, : kept + 1] * 2.0)
    found[:, 0] = spectrum[:, 0].real
    return found
