"""Clearance oscillators: the dimensionless equation, any periodic table, the pair of gears."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic, common_period
from thermogear.base.period import Period
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.tables import Pieces, Table, stack


def dead_zone(x: ArrayLike, *, half_backlash: ArrayLike = 1.0) -> Floats:
    """Deflection of the teeth behind the backlash.

    f(x; b) = x - min(max(x, -b), b)

    x relative displacement along the line of action [any length], positive on the drive side;
    half_backlash b >= 0 in the same unit. Returns the broadcast shape; 0 inside [-b, b] and on
    its edges.

    >>> dead_zone([-3.0, 0.5, 2.0], half_backlash=1.0)
    array([-2.,  0.,  1.])
    """
    b = np.asarray(half_backlash, dtype=float)
    here = np.asarray(x, dtype=float)
    return np.asarray(here - np.minimum(np.maximum(here, -b), b))


@runtime_checkable
class ClearanceModel(Protocol):
    """Anything the kernels can run: piecewise-linear force, coefficients of time alone."""

    def lanes(self) -> Lanes:
        """Flat parameter arrays, one entry per lane."""


def require_finite(
    owner: object, name: str, *, positive: bool = False, floor: bool = False
) -> None:
    """Hold that a field of ``owner`` is finite, and > 0 or >= 0 where asked; scalars stay scalars.

    >>> spring = Periodic(1.0)
    >>> require_finite(spring, "mean", positive=True)
    >>> spring.mean
    1.0
    """
    values = np.asarray(getattr(owner, name), dtype=float)
    allowed = "> 0, finite" if positive else ">= 0, finite" if floor else "finite"
    good = np.isfinite(values)
    if positive:
        good &= values > 0.0
    if floor:
        good &= values >= 0.0
    if not np.all(good):
        bad = values[~good].ravel()[0] if values.ndim else float(values)
        raise InputError(name, bad, allowed=allowed)
    object.__setattr__(owner, name, float(values) if values.ndim == 0 else values)


@dataclass(frozen=True, kw_only=True)
class TorsionalModel:
    """The dimensionless gear pair with one cosine in stiffness and force.

    X'' + 2 zeta X' + [1 + eps cos(w t) + eps_T] f(X; b') = F_m + F_h cos(w t)

    ``damping_ratio`` zeta >= 0, ``frequency`` w > 0 (mesh over natural frequency),
    ``stiffness_amplitude`` eps, ``mean_force`` F_m, ``force_amplitude`` F_h, ``half_backlash``
    b' > 0 over the cold one, ``thermal_stiffness`` eps_T > -1. Fields may be arrays that
    broadcast: every element is a lane.

    >>> model = TorsionalModel(
    ...     damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1,
    ...     mean_force=0.1, force_amplitude=0.05,
    ... )
    >>> f"{model.period:.4f}"
    '8.9760'
    """

    damping_ratio: ArrayLike
    frequency: ArrayLike
    stiffness_amplitude: ArrayLike
    mean_force: ArrayLike
    force_amplitude: ArrayLike
    half_backlash: ArrayLike = 1.0
    thermal_stiffness: ArrayLike = 0.0

    def __post_init__(self) -> None:
        require_finite(self, "damping_ratio", floor=True)
        require_finite(self, "frequency", positive=True)
        for name in ("stiffness_amplitude", "mean_force", "force_amplitude", "thermal_stiffness"):
            require_finite(self, name)
        require_finite(self, "half_backlash", positive=True)
        stiffness = np.asarray(self.thermal_stiffness, dtype=float)
        if np.any(stiffness <= -1.0):
            raise InputError(
                "thermal_stiffness",
                float(stiffness.min()),
                allowed="> -1",
                why="the mean stiffness 1 + eps_T must stay positive",
            )
        try:
            np.broadcast_shapes(*(np.shape(getattr(self, f.name)) for f in fields(self)))
        except ValueError:
            shapes = {f.name: np.shape(getattr(self, f.name)) for f in fields(self)}
            raise InputError("model", shapes, allowed="shapes that broadcast") from None

    @property
    def shape(self) -> tuple[int, ...]:
        """Common shape of the fields; () for one lane."""
        return np.broadcast_shapes(*(np.shape(getattr(self, f.name)) for f in fields(self)))

    @property
    def period(self) -> Floats | float:
        """2 pi/w."""
        value = 2.0 * np.pi / np.asarray(self.frequency, dtype=float)
        return float(value) if value.ndim == 0 else value

    def derivative(self, t: float, y: ArrayLike) -> Floats:
        """(X', X'') of the state ``y`` = (X, X'), first axis the component, then lanes."""
        x, v = np.asarray(y, dtype=float)
        zeta, frequency, eps, mean, amplitude, backlash, thermal = (
            np.asarray(getattr(self, f.name), dtype=float) for f in fields(self)
        )
        carrier = np.cos(frequency * t)
        spring = (1.0 + eps * carrier + thermal) * dead_zone(x, half_backlash=backlash)
        rate = mean + amplitude * carrier - 2.0 * zeta * v - spring
        return np.stack(np.broadcast_arrays(v, rate))

    def lanes(self) -> Lanes:
        """Flat parameter arrays, lanes in C order of the broadcast fields."""
        shape = self.shape
        zeta, frequency, eps, mean, amplitude, backlash, thermal = [
            np.broadcast_to(np.asarray(getattr(self, f.name), dtype=float), shape).ravel()
            for f in fields(self)
        ]
        none = (None,) * zeta.size
        return Lanes(
            period=2.0 * np.pi / frequency,
            damping=2.0 * zeta,
            half_backlash=backlash.copy(),
            stiffness=np.stack([1.0 + thermal, eps], axis=1).astype(complex),
            force=np.stack([mean, amplitude], axis=1).astype(complex),
            stiffness_pieces=none,
            force_pieces=none,
        )

    def replace(self, **changes: ArrayLike) -> TorsionalModel:
        """The same model with some fields changed."""
        return replace(self, **changes)


@dataclass(frozen=True, kw_only=True)
class DeadZoneModel:
    """A clearance oscillator with any periodic stiffness and force.

    x'' + 2 zeta x' + k(t) f(x; b) = F(t),   period 2 pi/w

    ``damping_ratio`` zeta >= 0 (the natural frequency is 1 when the mean of k is 1),
    ``frequency`` w > 0, ``stiffness`` and ``force``: :class:`Periodic` (any number of
    harmonics) or :class:`Pieces` (with jumps), ``half_backlash`` b > 0. Each may be a sequence;
    sequences of one common length are lanes. ``mesh_periods``: so many mesh periods are one
    period, 1 where all teeth are alike.

    >>> k, force = Periodic(1.0, (0.1,)), Periodic(0.1, (0.05,))
    >>> model = DeadZoneModel(damping_ratio=0.05, frequency=0.5, stiffness=k, force=force)
    >>> f"{model.period:.4f}"
    '12.5664'
    """

    damping_ratio: ArrayLike
    frequency: ArrayLike
    stiffness: Table | Sequence[Table]
    force: Table | Sequence[Table]
    half_backlash: ArrayLike = 1.0
    mesh_periods: int = 1

    def __post_init__(self) -> None:
        Period(self.mesh_periods)
        for name in ("damping_ratio", "frequency", "half_backlash"):
            require_finite(self, name, positive=name != "damping_ratio", floor=True)
            if np.ndim(getattr(self, name)) > 1:
                raise InputError(name, f"{np.ndim(getattr(self, name))} axes", allowed="0 or 1")
        for name in ("stiffness", "force"):
            value = getattr(self, name)
            if not isinstance(value, Periodic | Pieces):
                rows = tuple(value)
                if not rows or not all(isinstance(row, Periodic | Pieces) for row in rows):
                    raise InputError(name, type(value).__name__, allowed="Periodic or Pieces")
                object.__setattr__(self, name, rows)
        for table in self._tables("stiffness", 1):
            if table.mean <= 0.0:
                raise InputError("stiffness", table.mean, allowed="a mean > 0")
        sizes = {n for n in self._sizes() if n > 1}
        if len(sizes) > 1:
            raise InputError("model", sorted(sizes), allowed="one common number of lanes")

    def _sizes(self) -> list[int]:
        numbers = [np.size(v) for v in (self.damping_ratio, self.frequency, self.half_backlash)]
        return numbers + [len(self._tables(name, 1)) for name in ("stiffness", "force")]

    def _tables(self, name: str, count: int) -> tuple[Table, ...]:
        value = getattr(self, name)
        rows: tuple[Table, ...] = (value,) if isinstance(value, Periodic | Pieces) else value
        return rows * count if len(rows) == 1 else rows

    @property
    def shape(self) -> tuple[int, ...]:
        """() for one lane, else (lanes,)."""
        numbers = (self.damping_ratio, self.frequency, self.half_backlash)
        single = all(np.ndim(v) == 0 for v in numbers) and all(
            isinstance(t, Periodic | Pieces) for t in (self.stiffness, self.force)
        )
        return () if single else (max(self._sizes()),)

    @property
    def period(self) -> Floats | float:
        """2 pi/w."""
        value = 2.0 * np.pi / np.asarray(self.frequency, dtype=float)
        return float(value) if value.ndim == 0 else value

    def derivative(self, t: float, y: ArrayLike) -> Floats:
        """(x', x'') of the state ``y`` = (x, x'), first axis the component, then lanes."""
        x, v = np.asarray(y, dtype=float)
        phase = np.broadcast_to(t / np.asarray(self.period), (max(self._sizes()),))
        count = phase.size
        k = np.array(
            [float(p(s)) for p, s in zip(self._tables("stiffness", count), phase, strict=True)]
        )
        force = np.array(
            [float(p(s)) for p, s in zip(self._tables("force", count), phase, strict=True)]
        )
        if self.shape == ():
            k, force = k[0], force[0]
        damping = 2.0 * np.asarray(self.damping_ratio) * v
        return np.stack(
            np.broadcast_arrays(
                v, force - damping - k * dead_zone(x, half_backlash=self.half_backlash)
            )
        )

    def lanes(self) -> Lanes:
        """Flat parameter arrays."""
        count = max(self._sizes())
        stiffness, stiffness_pieces = stack(self._tables("stiffness", count))
        force, force_pieces = stack(self._tables("force", count))
        number = [
            np.broadcast_to(np.asarray(v, dtype=float), (count,)).copy()
            for v in (self.period, self.damping_ratio, self.half_backlash)
        ]
        return Lanes(
            period=number[0],
            damping=2.0 * number[1],
            half_backlash=number[2],
            stiffness=stiffness,
            force=force,
            stiffness_pieces=stiffness_pieces,
            force_pieces=force_pieces,
            mesh_periods=self.mesh_periods,
        )


def from_excitation(excitation: Excitation | Sequence[Excitation]) -> DeadZoneModel:
    """The dimensionless equation of one gear pair, or of several operating points as lanes.

    X = x/b_c, tau = omega_n t, omega_n = sqrt(k_m/m_e):
    k = k(t)/k_m, B' = b'/b_c, w = omega_mesh/(L omega_n) where stiffness and error repeat after
    L ``mesh_periods``, F = F_m^/(k_m b_c) - e''/b_c with ' = d/dtau, so that with L = 1
    e = e_a cos gives F_h = (e_a/b_c) w^2.

    Takes excitations in SI (``mesh_frequency`` [rad/s]); returns a model of one lane for one
    excitation, of as many lanes for a sequence.
    """
    rows = [excitation] if isinstance(excitation, Excitation) else list(excitation)
    stiffness: list[Table] = []
    force: list[Table] = []
    numbers: list[tuple[float, float, float]] = []
    for row in rows:
        frequency = row.mesh_frequency / row.mesh_periods / row.natural_frequency
        length = row.reference_half_backlash
        mean = row.stiffness.mean
        # d/dtau = (w/2 pi) d/dphi
        acceleration = row.error.derivative(2) * ((frequency / (2.0 * np.pi)) ** 2 / length)
        stiffness.append(row.stiffness * (1.0 / mean))
        force.append(acceleration * -1.0 + row.mean_force / (mean * length))
        numbers.append((row.damping_ratio, frequency, row.half_backlash / length))
    single = isinstance(excitation, Excitation)
    damping, omega, backlash = numbers[0] if single else np.array(numbers).T
    return DeadZoneModel(
        damping_ratio=damping,
        frequency=omega,
        stiffness=stiffness[0] if single else stiffness,
        force=force[0] if single else force,
        half_backlash=backlash,
        mesh_periods=common_period(rows),
    )


@dataclass(frozen=True)
class PairModel:
    """Two gears on rigid bearings (SI).

    I1 theta1'' + r_b1 (c x' + k(t) f(x; b')) = T1,
    I2 theta2'' - r_b2 (c x' + k(t) f(x; b')) = -T2,
    x = r_b1 theta1 - r_b2 theta2 - e(t)

    The angles are the vibration about the steady rotation. ``inertias`` [kg m^2],
    ``base_radii`` [m], ``torques`` T1 (driving the pinion) and T2 (load on the wheel) [N m],
    ``stiffness`` k [N/m] and ``error`` e [m] over the mesh phase, ``damping`` c [N s/m],
    ``half_backlash`` b' [m], ``mesh_frequency`` [rad/s]; tables repeat after ``mesh_periods``
    mesh periods. State (theta1, theta2, theta1', theta2'). With balanced torques,
    T1/r_b1 = T2/r_b2, the momentum I1 theta1'/r_b1 + I2 theta2'/r_b2 is constant.

    >>> pair = PairModel(
    ...     inertias=(2e-3, 2e-3), base_radii=(0.04, 0.04), torques=(100.0, 100.0),
    ...     stiffness=Periodic(3e8), error=Periodic(0.0), damping=2e3,
    ...     half_backlash=50e-6, mesh_frequency=2e3,
    ... )
    >>> f"{pair.equivalent_mass:.3f} kg, {pair.mean_force:.0f} N"
    '0.625 kg, 2500 N'
    """

    inertias: tuple[float, float]
    base_radii: tuple[float, float]
    torques: tuple[float, float]
    stiffness: Periodic
    error: Periodic
    damping: float
    half_backlash: float
    mesh_frequency: float
    mesh_periods: int = 1
    states: ClassVar[tuple[str, ...]] = ("theta1", "theta2", "omega1", "omega2")

    def __post_init__(self) -> None:
        for name in ("inertias", "base_radii", "torques"):
            pair = tuple(float(v) for v in getattr(self, name))
            object.__setattr__(self, name, pair)
            if len(pair) != 2 or not np.all(np.isfinite(pair)):
                raise InputError(name, pair, allowed="two finite numbers")
            if name != "torques" and min(pair) <= 0.0:
                raise InputError(name, pair, allowed="> 0")
        for name in ("damping", "half_backlash", "mesh_frequency"):
            require_finite(self, name, positive=name != "damping", floor=True)
        if self.stiffness.mean <= 0.0:
            raise InputError("stiffness", self.stiffness.mean, allowed="a mean > 0")

    @classmethod
    def from_excitation(cls, excitation: Excitation) -> PairModel:
        """The pair behind ``excitation``; c = 2 zeta sqrt(k_m m_e)."""
        mass = excitation.equivalent_mass
        return cls(
            excitation.inertias,
            excitation.base_radii,
            excitation.torques,
            excitation.stiffness,
            excitation.error,
            2.0 * excitation.damping_ratio * mass * excitation.natural_frequency,
            excitation.half_backlash,
            excitation.mesh_frequency,
            excitation.mesh_periods,
        )

    @property
    def period(self) -> float:
        """Period of the tables [s]: ``mesh_periods`` mesh periods."""
        return self.mesh_periods * (2.0 * np.pi / self.mesh_frequency)

    @property
    def equivalent_mass(self) -> float:
        """m_e = I1 I2/(I1 r_b2^2 + I2 r_b1^2) [kg]."""
        (i1, i2), (r1, r2) = self.inertias, self.base_radii
        return i1 * i2 / (i1 * r2**2 + i2 * r1**2)

    @property
    def mean_force(self) -> float:
        """Mean mesh force m_e (r_b1 T1/I1 + r_b2 T2/I2) [N]; T1/r_b1 when balanced."""
        (i1, i2), (r1, r2), (t1, t2) = self.inertias, self.base_radii, self.torques
        return self.equivalent_mass * (r1 * t1 / i1 + r2 * t2 / i2)

    @cached_property
    def _error_rate(self) -> Periodic:
        """e' [m/s] over the mesh phase."""
        return self.error.derivative() * (1.0 / self.period)

    def displacement(self, t: ArrayLike, state: ArrayLike) -> tuple[Floats, Floats]:
        """x and x' [m, m/s] along the line of action of ``state`` (first axis 4) at ``t``."""
        y = np.asarray(state, dtype=float)
        r1, r2 = self.base_radii
        phase = np.asarray(t, dtype=float) / self.period
        x = r1 * y[0] - r2 * y[1] - self.error(phase)
        return np.asarray(x), np.asarray(r1 * y[2] - r2 * y[3] - self._error_rate(phase))

    def momentum(self, state: ArrayLike) -> Floats:
        """I1 theta1'/r_b1 + I2 theta2'/r_b2 [kg m/s] of ``state`` (first axis 4)."""
        y = np.asarray(state, dtype=float)
        (i1, i2), (r1, r2) = self.inertias, self.base_radii
        return np.asarray(i1 * y[2] / r1 + i2 * y[3] / r2)

    def start(self, *, x: float, v: float) -> Floats:
        """The state with line-of-action displacement ``x`` and velocity ``v`` at phase 0.

        The wheel takes none of it in the rigid mode: the momentum is zero.
        """
        (i1, i2), (r1, r2) = self.inertias, self.base_radii
        weight = self.equivalent_mass * np.array([r1 / i1, -r2 / i2])
        rate = v + float(self.error.derivative()(0.0)) / self.period
        return np.concatenate([weight * (x + float(self.error(0.0))), weight * rate])

    def derivative(self, t: float, y: ArrayLike) -> Floats:
        """Time derivative of the state (theta1, theta2, theta1', theta2')."""
        state = np.asarray(y, dtype=float)
        x, v = self.displacement(t, state)
        (i1, i2), (r1, r2), (t1, t2) = self.inertias, self.base_radii, self.torques
        mesh = self.damping * v + self.stiffness(t / self.period) * dead_zone(
            x, half_backlash=self.half_backlash
        )
        return np.stack([state[2], state[3], (t1 - r1 * mesh) / i1, (r2 * mesh - t2) / i2])

    def reduced(self) -> DeadZoneModel:
        """The same relative motion as one oscillator per unit mass: x in [m], t in [s].

        x'' + (c/m_e) x' + (k/m_e) f(x; b') = F_m^/m_e - e''; DeadZoneModel's 2 zeta is c/m_e.
        """
        mass = self.equivalent_mass
        acceleration = self.error.derivative(2) * (1.0 / self.period**2)
        return DeadZoneModel(
            damping_ratio=self.damping / (2.0 * mass),
            frequency=self.mesh_frequency / self.mesh_periods,
            stiffness=self.stiffness * (1.0 / mass),
            force=acceleration * -1.0 + self.mean_force / mass,
            half_backlash=self.half_backlash,
            mesh_periods=self.mesh_periods,
        )

    def lanes(self) -> Lanes:
        """One lane: the relative motion (:meth:`reduced`)."""
        return self.reduced().lanes()
