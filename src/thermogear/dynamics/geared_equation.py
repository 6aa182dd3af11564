"""Two geared shafts as their vibration sees them: matrices, two flanks, bearings with clearance.

M q'' + C q' + K q = f0 - F_d g_d + c_m e' g_d - F_b g_b + F_d (chi_0 p_0 + chi_1 p_1) + bearings,
F_d = k <g_d.q - e - b'>+, F_b = k <g_b.q + e - b'>+ with k, e, chi_0, chi_1 functions of the mesh
phase. C holds the mesh damping c_m g_d g_d^T. Plain arrays in SI: nothing here knows of shafts.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from math import lcm
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import Periodic
from thermogear.dynamics.tables import Pieces

Function = Periodic | Pieces

LOCKED = 256
"""Mesh periods within which elements that pass at a whole ratio come again: chosen, as long as an
orbit's multipliers are asked for."""
WHOLE = 1e-12
"""Elements that pass in a mesh period may differ by it from a whole ratio: rounding of it; over
10 000 periods an element is out of place by 1e-8 of a pitch."""


@dataclass(frozen=True, eq=False, kw_only=True)
class LocalBearing:
    """A bearing with clearance or a power law between two directions of the train.

    ``directions`` (n, 2): u = their transpose times q [m]. ``elements`` 0: a ring, F = -k <|u| -
    c>^n u/|u|; else the sum over so many rolling elements, the first at ``angle`` [rad] at
    the phase 0. ``order``: turns of the cage about +z in a mesh period, 0: held.
    ``coefficient`` k [N/m^n], ``exponent`` n, ``clearance`` c [m]. ``base`` (2, 2) [N/m]: stiffness
    of the linear system behind, best the tangent at rest; it changes the cost, not the result.
    """

    directions: Floats
    coefficient: float
    exponent: float = 1.0
    clearance: float = 0.0
    elements: int = 0
    angle: float = 0.0
    order: float = 0.0
    base: Floats = field(default_factory=lambda: np.zeros((2, 2)))

    @property
    def rays(self) -> Floats:
        """Unit vectors from the centre to every rolling element at phase 0, (elements, 2)."""
        psi = self.angle + 2.0 * np.pi * np.arange(self.elements) / max(self.elements, 1)
        return np.stack([np.cos(psi), np.sin(psi)], axis=-1)

    def depth(self, displacement: Floats, *, phase: Floats) -> Floats:
        """How deep the ring, or the deepest element, is pressed in [m] at (..., 2) [m]; < 0: open.

        The bearing bears nothing where it is open. ``phase`` (...): mesh periods since the cage was
        at its angle.
        """
        if self.elements == 0:
            return np.asarray(np.linalg.norm(displacement, axis=-1) - self.clearance)
        seen = turned(displacement, turns=-self.order * phase)
        return np.asarray((seen @ self.rays.T).max(axis=-1) - self.clearance)

    def force(self, displacement: Floats, *, phase: Floats) -> Floats:
        """Force (..., 2) [N] on the journal at ``displacement`` (..., 2) [m], ``phase`` (...)."""
        if self.elements == 0:
            r = np.linalg.norm(displacement, axis=-1)[..., None]
            deep = np.maximum(r - self.clearance, 0.0)
            towards = np.divide(displacement, r, out=np.zeros_like(displacement), where=r > 0.0)
            return np.asarray(-self.coefficient * deep**self.exponent * towards)
        seen = turned(displacement, turns=-self.order * phase)
        deep = np.maximum(seen @ self.rays.T - self.clearance, 0.0)
        force = -(self.coefficient * deep**self.exponent) @ self.rays
        return turned(force, turns=self.order * phase)


def turned(vectors: Floats, *, turns: Floats) -> Floats:
    """``vectors`` (..., 2) turned on by so many ``turns`` (...) about +z; 0 leaves them as is."""
    cos, sin = np.cos(2.0 * np.pi * turns), np.sin(2.0 * np.pi * turns)
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)


@dataclass(frozen=True, eq=False, kw_only=True)
class OuterForce:
    """A force on ``vector`` (n,) that turns with a shaft: cos(2 pi order phase + shift) of it.

    ``order`` in turns per mesh period, ``shift`` [rad]. ``rotating``: times the square of the
    angular frequency 2 pi order n(t), with the term of its rate in a run-up, as of an unbalance.
    """

    vector: Floats
    order: float
    shift: float = 0.0
    rotating: bool = False


@dataclass(frozen=True, kw_only=True)
class Wobble:
    """Teeth that turn about another centre than the shaft's: errors Re(a e^{2 pi i order phase}).

    ``order`` in turns per mesh period; complex amplitudes [m] of the error that the ``drive`` and
    that the ``back`` flank see: each closes less by it.
    """

    order: float
    drive: complex
    back: complex

    @property
    def row(self) -> tuple[float, ...]:
        """Order and both amplitudes as plain numbers."""
        return (self.order, self.drive.real, self.drive.imag, self.back.real, self.back.imag)


@dataclass(frozen=True, eq=False, kw_only=True)
class GearedEquation:
    """The equation of motion of a drive train without its rigid rotation, n coordinates, SI.

    ``mass``, ``damping`` (gyroscopics and the mesh's c_m included), ``stiffness`` (n, n) without
    the mesh and without ``bearings``; ``force`` f0 (n,). ``drive`` and ``back`` g_d, g_b (n,);
    ``friction`` p_0, p_1 (2, n) with ``friction_at_pitch`` chi_0 and ``friction_per_metre`` chi_1
    [m]. ``mesh_stiffness`` k [N/m] and ``error`` e [m] over the mesh phase, ``half_backlash`` b'
    [m], ``mesh_damping`` c_m [N s/m], ``mesh_frequency`` [Hz]. No step reaches over a start of a
    piece of a function. ``outer`` forces and ``wobbles`` turn with a shaft. ``slip`` (vector (n,),
    d [N m s], lag [s]): a motor whose torque falls with its speed. ``cycle``: mesh periods after
    which all forces come again. ``seen`` (n, 2): directions of the journal that is drawn in its
    plane; left out, the teeth are.
    """

    mass: Floats
    damping: Floats
    stiffness: Floats
    force: Floats
    drive: Floats
    back: Floats
    mesh_stiffness: Function
    error: Function
    half_backlash: float
    mesh_damping: float
    mesh_frequency: float
    bearings: tuple[LocalBearing, ...] = ()
    friction: Floats | None = None
    friction_at_pitch: Function | None = None
    friction_per_metre: Function | None = None
    outer: tuple[OuterForce, ...] = ()
    wobbles: tuple[Wobble, ...] = ()
    slip: tuple[Floats, float, float] | None = None
    cycle: int = 1
    mesh_periods: int = 1
    seen: Floats | None = None

    def __post_init__(self) -> None:
        for name in ("half_backlash", "mesh_frequency"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0.0):
                raise InputError(name, value, allowed="> 0, finite")
        n = self.size
        for name in ("mass", "damping", "stiffness"):
            value = getattr(self, name)
            if value.shape != (n, n) or not np.all(np.isfinite(value)):
                raise InputError(name, f"shape {value.shape}", allowed=f"({n}, {n}) finite numbers")

    @cached_property
    def cage_cycle(self) -> int:
        """Mesh periods after which all elements are in the places of others again; 0: never.

        Never: not within :data:`LOCKED`.
        """
        found = 1
        for one in self.bearings:
            passed = one.elements * one.order
            ratio = Fraction(passed).limit_denominator(LOCKED)
            if abs(passed - ratio) > WHOLE:
                return 0
            found = lcm(found, ratio.denominator)
        return found if found <= LOCKED else 0

    @property
    def jumps(self) -> tuple[float, ...]:
        """Phases in [0, 1) at which pieces of a function meet: no step reaches over them."""
        own = self.mesh_stiffness, self.error, self.friction_at_pitch, self.friction_per_metre
        starts = [one.starts for one in own if isinstance(one, Pieces)]
        return tuple(sorted({0.0}.union(*starts)))

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return int(self.drive.size)

    @property
    def dimension(self) -> int:
        """Length of a state: (q, q') and, with ``slip``, the motor's torque."""
        return 2 * self.size + (1 if self.slip is not None else 0)

    @property
    def period(self) -> float:
        """One mesh period [s]."""
        return 1.0 / self.mesh_frequency

    @property
    def base_stiffness(self) -> float:
        """Mean of k [N/m], which the linear system behind has on the drive flank."""
        return float(self.mesh_stiffness.mean)

    @cached_property
    def state_matrix(self) -> Floats:
        """A of x' = A x + B f for the base: the drive flank and the bearings closed."""
        n = self.size
        stiff = self.stiffness + self.base_stiffness * np.outer(self.drive, self.drive)
        for one in self.bearings:
            stiff = stiff + one.directions @ one.base @ one.directions.T
        matrix = np.zeros((self.dimension, self.dimension))
        matrix[:n, n : 2 * n] = np.eye(n)
        matrix[n : 2 * n, : 2 * n] = -np.linalg.solve(self.mass, np.hstack([stiff, self.damping]))
        if self.slip is not None:
            vector, fall, lag = self.slip
            matrix[n : 2 * n, 2 * n] = np.linalg.solve(self.mass, vector)
            matrix[2 * n, n : 2 * n] = -fall / lag * vector
            matrix[2 * n, 2 * n] = -1.0 / lag
        return matrix

    @property
    def inputs(self) -> Floats:
        """Directions of the local forces (n, inputs): flanks, friction, bearings, outer forces."""
        columns = [self.drive, self.back]
        if self.friction is not None:
            columns += [*self.friction]
        columns += [column for one in self.bearings for column in one.directions.T]
        columns += [one.vector for one in self.outer]
        return np.stack(columns, axis=1)

    @property
    def outputs(self) -> Floats:
        """What the contacts feel, (outputs, n): both flanks' deflections, (x, y) of bearings."""
        bearings = (row for one in self.bearings for row in one.directions.T)
        return np.stack([self.drive, self.back, *bearings])

    def with_cages_on(self, share: float) -> Self:
        """The same with the rolling elements ``share`` of their own pitch further on."""
        turned = tuple(
            replace(bearing, angle=bearing.angle + 2.0 * np.pi * share / max(bearing.elements, 1))
            for bearing in self.bearings
        )
        return replace(self, bearings=turned)

    def determinant(self, periods: int = 1) -> float:
        """det of the Jacobian of ``periods`` mesh periods: exp(T tr A), with any contacts."""
        return float(np.exp(periods * self.period * np.trace(self.state_matrix)))

    def errors_at(self, phase: ArrayLike) -> tuple[Floats, Floats]:
        """Errors [m] that the drive and the back flank see at ``phase``, mesh periods since 0."""
        phi = np.asarray(phase, dtype=float)
        drive = np.asarray(self.error(phi), dtype=float)
        back = -drive
        for one in self.wobbles:
            turn = np.exp(2j * np.pi * one.order * phi)
            drive, back = drive + (one.drive * turn).real, back + (one.back * turn).real
        return drive, back

    def depths(self, displacements: Floats, phase: Floats) -> Floats:
        """Depths (..., 2 + bearings) [m] of flanks and bearings; > 0: in contact.

        ``displacements`` (..., outputs) [m] as :attr:`outputs` gives them, at mesh ``phase`` (...).
        """
        errors = np.stack(self.errors_at(phase), axis=-1)
        pairs = (displacements[..., 2 * n + 2 : 2 * n + 4] for n in range(len(self.bearings)))
        rings = [
            b.depth(u, phase=phase)[..., None] for b, u in zip(self.bearings, pairs, strict=True)
        ]
        flanks = displacements[..., :2] - errors - self.half_backlash
        return np.concatenate([flanks, *rings], axis=-1)

    def _error_rate(self, phase: Floats) -> Floats:
        """de/dphase [m] of the drive flank's error."""
        rate = np.asarray(self.error.derivative()(phase), dtype=float)
        for one in self.wobbles:
            turn = 2j * np.pi * one.order
            rate = rate + (turn * one.drive * np.exp(turn * phase)).real
        return rate

    def forces(self, phase: ArrayLike, *, states: ArrayLike) -> dict[str, Floats]:
        """Every contact force at ``phase`` (S,) along ``states`` (S, d), at constant speed.

        "drive" and "back" [N] (S,), "bearings" (S, count, 2) [N] on the journals, damping not in
        it; "acceleration" (S, n) of the coordinates [m/s^2].
        """
        phi, x = np.asarray(phase, dtype=float), np.asarray(states, dtype=float)
        n = self.size
        q, v = x[:, :n], x[:, n : 2 * n]
        drive_error, back_error = self.errors_at(phi)
        k = np.asarray(self.mesh_stiffness(phi))
        drive = k * np.maximum(q @ self.drive - drive_error - self.half_backlash, 0.0)
        back = k * np.maximum(q @ self.back - back_error - self.half_backlash, 0.0)
        rate = self._error_rate(phi)
        pushed = self.force - v @ self.damping.T - q @ self.stiffness.T
        pushed = pushed + np.multiply.outer(
            self.mesh_damping * rate * self.mesh_frequency - drive, self.drive
        )
        pushed = pushed - np.multiply.outer(back, self.back)
        if self.friction is not None:
            for column, one in zip(
                self.friction, (self.friction_at_pitch, self.friction_per_metre), strict=True
            ):
                if one is not None:
                    pushed = pushed + np.multiply.outer(drive * np.asarray(one(phi)), column)
        rings = np.zeros((phi.size, len(self.bearings), 2))
        for place, bearing in enumerate(self.bearings):
            rings[:, place] = bearing.force(q @ bearing.directions, phase=phi)
            pushed = pushed + rings[:, place] @ bearing.directions.T
        for outer in self.outer:
            turn = 2.0 * np.pi * outer.order
            size = (turn * self.mesh_frequency) ** 2 if outer.rotating else 1.0
            wave = size * np.cos(turn * phi + outer.shift)
            pushed = pushed + np.multiply.outer(wave, outer.vector)
        if self.slip is not None:
            pushed = pushed + np.multiply.outer(x[:, 2 * n], self.slip[0])
        return {
            "drive": np.asarray(drive),
            "back": np.asarray(back),
            "bearings": rings,
            "acceleration": np.asarray(np.linalg.solve(self.mass, pushed.T).T, dtype=float),
        }
