"""The linear drive train: natural frequencies, critical speeds, response to harmonic forces.

The mesh and every bearing act as springs at one equilibrium: M q'' + (C + Omega G) q' + K q = f,
Omega the pinion's speed about +z, sigma times its amount. The rigid rotation of the train is
projected out, mass-orthogonally, so that every frequency is one of a vibration.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.shafts.assembly import Assembly, across, linear_stiffness
from thermogear.shafts.train import SHAFTS

FREE = 1e-9
"""A frequency below this share of the middle one is a free motion."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Modes:
    """Modes at one speed, (modes,), by rising frequency.

    ``frequency`` w [rad/s]; ``shape`` q (n, modes) complex, the motion is Re(q e^{iwt}), scaled to
    w^2 q^H M q + q^H K q = 1 J; ``damping_ratio`` [-].
    """

    frequency: Floats
    shape: Complexes
    damping_ratio: Floats


@dataclass(frozen=True, eq=False, kw_only=True)
class LinearTrain:
    """A drive train with its contacts as springs.

    ``mesh`` k of the drive flank [N/m], ``back`` of the back flank where it is closed too,
    ``bearings`` (count, 2, 2) [N/m].
    """

    assembly: Assembly
    mesh: float
    bearings: Floats
    back: float = 0.0

    @cached_property
    def stiffness(self) -> Floats:
        """K with every closed contact, (n, n) [N/m]."""
        return linear_stiffness(
            self.assembly, mesh=self.mesh, bearings=self.bearings, back=self.back
        )

    @cached_property
    def basis(self) -> Floats:
        """A basis (n, n - 1) of all motions M-orthogonal to the rigid rotation."""
        return across(self.assembly.mass @ self.assembly.rotation)

    @cached_property
    def damping(self) -> Floats:
        """C of the named kind, (n, n) [N s/m], without gyroscopics."""
        model, train = self.assembly.damping, self.assembly
        if model.kind == "modal":
            modes = self.modes(0.0)
            m = train.mass @ _scaled(modes, train.mass)
            return np.asarray(m @ np.diag(2.0 * model.ratio * modes.frequency) @ m.T)
        mesh = self.mesh_damping * np.outer(train.drive, train.drive)
        if model.kind == "proportional":
            bare = linear_stiffness(train, mesh=0.0, bearings=self.bearings)
            return np.asarray(model.mass * self._moving_mass + model.shafts * bare + mesh)
        if model.kind != "bearings":
            raise InputError("damping", repr(model.kind), allowed="bearings | proportional | modal")
        return np.asarray(train.viscous + model.shafts * train.elastic + mesh)

    def slip_damping(self, frequency: ArrayLike) -> Complexes:
        """d/(1 + i w T) of the motor's characteristic [N m s] at ``frequency`` w [rad/s].

        Its real part takes energy; beyond 1/T little of it is left.
        """
        size, lag = self.assembly.slip
        return np.asarray(size / (1.0 + 1j * np.asarray(frequency, dtype=float) * lag))

    @cached_property
    def _moving_mass(self) -> Floats:
        """M without the rigid rotation, which no damping of the train may brake."""
        train = self.assembly
        pull = train.mass @ train.rotation
        return np.asarray(train.mass - np.outer(pull, pull) / (train.rotation @ pull))

    @property
    def mesh_damping(self) -> float:
        """c_m = 2 zeta sqrt(k m_e) [N s/m], m_e of the two gears alone; modal damping has none."""
        own = self.assembly.damping
        zeta = 0.0 if own.kind == "modal" else own.mesh
        return float(2.0 * zeta * np.sqrt(self.mesh * self.assembly.mesh_mass))

    def bearing_damping(self, place: int) -> Floats:
        """c (2, 2) [N s/m] of one bearing by the named kind; modal damping has no place."""
        kind, own = self.assembly.damping.kind, self.assembly.bearings[place].bearing
        if kind == "bearings":
            return np.asarray(own.damping * np.eye(2))
        beta = self.assembly.damping.shafts if kind == "proportional" else 0.0
        return np.asarray(beta * self.bearings[place])

    @property
    def symmetric(self) -> bool:
        """Whether K is symmetric, so that undamped modes keep their energy."""
        k = self.stiffness
        return bool(np.allclose(k, k.T, rtol=1e-12, atol=1e-12 * np.abs(k).max()))

    def modes(self, speed: float, *, damped: bool = False, count: int | None = None) -> Modes:
        """The modes at ``speed`` [rad/s] of the pinion, (n - 1,), rising; the first ``count``.

        Undamped: lambda A z = -B z with A = diag(M, K), B = ((Omega G, K), (-K, 0)), Hermitian once
        A is reduced. ``damped``, or with bearings whose K is not symmetric: the eigenvalues of the
        state matrix, the motor's characteristic left out; a ratio below zero is unstable,
        over-damped pairs are left out. Raises InputError where a motion is free besides the
        rotation.
        """
        if damped or not self.symmetric:
            return self._damped_modes(speed, damped, count)
        t, train = self.basis, self.assembly
        mass, stiff = self.held
        omega = train.frame.sense * speed
        n = t.shape[1]
        wanted = n if count is None else min(count, n)
        if omega == 0.0:
            square, shape = scipy.linalg.eigh(stiff, mass, subset_by_index=(0, wanted - 1))
            return Modes(
                frequency=np.sqrt(square),
                shape=(t @ shape / np.sqrt(2.0 * square)).astype(complex),
                damping_ratio=np.zeros(square.size),
            )
        gyro, cross, lowk = self._reduced
        whole = np.block([[omega * gyro, cross], [-cross.T, np.zeros((n, n))]])
        found, vectors = scipy.linalg.eigh(1j * whole, subset_by_index=(n, n + wanted - 1))
        shape = scipy.linalg.solve_triangular(lowk, vectors[n:], lower=True, trans="T")
        return Modes(frequency=found, shape=t @ shape, damping_ratio=np.zeros(wanted))

    @cached_property
    def _reduced(self) -> tuple[Floats, Floats, Floats]:
        """L^-1 G L^-T, L^-1 L_k and L_k of M = L L^T and K = L_k L_k^T, rotation left out."""
        mass, stiff = self.held
        low, lowk = np.linalg.cholesky(mass), np.linalg.cholesky(stiff)
        turned = self.basis.T @ self.assembly.gyroscopic @ self.basis
        solve = scipy.linalg.solve_triangular
        half = solve(low, turned, lower=True)
        gyro, cross = solve(low, half.T, lower=True).T, solve(low, lowk, lower=True)
        return np.asarray(gyro, float), np.asarray(cross, float), np.asarray(lowk, float)

    @cached_property
    def held(self) -> tuple[Floats, Floats]:
        """M and K of the motions besides the rotation; refused where one of them is free."""
        t = self.basis
        mass, stiff = t.T @ self.assembly.mass @ t, t.T @ self.stiffness @ t
        square = scipy.linalg.eigvalsh(stiff, mass)
        free = int(np.sum(square <= FREE**2 * np.median(np.abs(square))))
        if free:
            raise InputError(
                "bearings",
                f"{free} free motion{'s' if free > 1 else ''} of the shafts",
                allowed="none besides the rotation of the train",
                why="nothing holds the shafts against it",
                fix="give each shaft two bearings that are loaded, or preload them",
            )
        return mass, stiff

    def _damped_modes(self, speed: float, damped: bool, count: int | None) -> Modes:
        t, train = self.basis, self.assembly
        mass, stiff = self.held
        omega = train.frame.sense * speed
        loss = omega * train.gyroscopic + (self.damping if damped else 0.0)
        n = t.shape[1]
        right = np.linalg.solve(mass, np.hstack([stiff, t.T @ loss @ t]))
        state = np.block([[np.zeros((n, n)), np.eye(n)], [-right]])
        found, vectors = np.linalg.eig(state)
        keep = found.imag > FREE * np.median(np.abs(found))
        order = np.argsort(found[keep].imag)[:count]
        value, shape = found[keep][order], t @ vectors[:n, keep][:, order]
        energy = np.einsum("im,ij,jm->m", shape.conj(), self.stiffness, shape).real
        kinetic = np.einsum("im,ij,jm->m", shape.conj(), train.mass, shape).real
        return Modes(
            frequency=np.asarray(value.imag),
            shape=shape / np.sqrt(np.abs(energy) + np.abs(value) ** 2 * kinetic),
            damping_ratio=np.asarray(-value.real / np.abs(value)),
        )

    def critical(self, order: float) -> tuple[Floats, Complexes]:
        """Speeds at which ``order`` times the speed is a natural frequency: [rad/s], and shapes.

        With Omega = omega/order the gyroscopic term joins the mass: K q = omega^2 (M - i sigma G /
        order) q, one Hermitian eigenproblem without a sweep over speed. (found,), (n, found),
        rising; an order may miss a mode that stiffens faster than it turns.
        """
        if not order > 0.0:
            raise InputError("order", order, allowed="> 0")
        t, train = self.basis, self.assembly
        stiff = t.T @ self.stiffness @ t
        sense = train.frame.sense
        moving = t.T @ (train.mass - 1j * sense * train.gyroscopic / order) @ t
        if not self.symmetric:
            square, vectors = scipy.linalg.eig(stiff, moving)
            real = (square.real > 0.0) & (np.abs(square.imag) < 1e-6 * np.abs(square))
            value, shape = np.sqrt(square[real].real), vectors[:, real]
        else:
            inverse, vectors = scipy.linalg.eigh(moving, stiff)
            real = inverse > 1e-14 * inverse.max()
            value, shape = 1.0 / np.sqrt(inverse[real]), vectors[:, real]
        rising = np.argsort(value)
        return np.asarray(value[rising] / order), (t @ shape[:, rising]).astype(complex)

    def respond(self, frequency: ArrayLike, *, speed: ArrayLike, force: ArrayLike) -> Complexes:
        """q of M q'' + (C + Omega G) q' + K q = Re(``force`` e^{i w t}), (..., n) complex [m, rad].

        ``frequency`` w [rad/s] and ``speed`` [rad/s] of one shape (...), ``force`` (..., n) [N,
        N m]. The rigid rotation, which would run away with a force that drives it, is left out.
        """
        w, omega = np.broadcast_arrays(np.asarray(frequency, float), np.asarray(speed, float))
        t, train = self.basis, self.assembly
        parts = [t.T @ one @ t for one in (train.mass, self.damping, train.gyroscopic)]
        stiff = t.T @ self.stiffness @ t
        motor = t[train.index["motor.tz"]] if self.assembly.slip[0] else np.zeros(t.shape[1])
        slips = self.slip_damping(w)
        pushed = np.broadcast_to(np.asarray(force, complex), (*w.shape, train.size)) @ t
        found = np.empty((*w.shape, t.shape[1]), complex)
        for at in np.ndindex(w.shape):
            turning = train.frame.sense * omega[at] * parts[2]
            loss = parts[1] + turning + slips[at] * np.outer(motor, motor)
            dynamic = stiff - w[at] ** 2 * parts[0] + 1j * w[at] * loss
            found[at] = np.linalg.solve(dynamic, pushed[at])
        return np.asarray(found @ t.T, dtype=complex)


def _scaled(modes: Modes, mass: Floats) -> Floats:
    """Real shapes at rest with unit modal mass, (n, modes)."""
    shape = modes.shape.real
    return np.asarray(shape / np.sqrt(np.einsum("im,ij,jm->m", shape, mass, shape)))


def strain_shares(train: LinearTrain, shape: ArrayLike) -> dict[str, Floats]:
    """Where the strain energy of ``shape`` (n, modes) sits: part -> share of all [-], (modes,).

    Parts: "mesh", each shaft's "bending" and "torsion", every "bearing ..." by name, each coupling,
    each seat, "housing feet". The shares of a symmetric K sum to 1.
    """
    own, q = train.assembly, np.asarray(shape)
    found = {"mesh": train.mesh * np.abs(own.drive @ q) ** 2}
    if train.back:
        found["mesh, back flank"] = train.back * np.abs(own.back @ q) ** 2
    owners = np.array([name.split(".")[0] for name in own.coordinates])
    turns = np.array([name.endswith(".tz") for name in own.coordinates])
    for shaft in SHAFTS:
        for what, kind in (("bending", ~turns), ("torsion", turns)):
            mine = (owners == shaft) & kind
            found[f"{shaft} shaft, {what}"] = _energy(own.elastic[np.ix_(mine, mine)], q[mine])
    for end in ("motor", "load"):
        if end in owners:
            row = own.index[f"{end}.tz"]
            others = np.flatnonzero(own.elastic[row])
            found[f"{end} coupling"] = sum(
                (-own.elastic[row, j] * np.abs(q[row] - q[j]) ** 2 for j in others[others != row]),
                np.zeros(q.shape[1]),
            )
            mine = (owners == ("pinion" if end == "motor" else "wheel")) & turns
            shaft = f"{'pinion' if end == 'motor' else 'wheel'} shaft, torsion"
            both = mine | (np.arange(own.size) == row)
            whole = _energy(own.elastic[np.ix_(both, both)], q[both])
            found[shaft] = whole - found[f"{end} coupling"]
    for place, k in zip(own.bearings, train.bearings, strict=True):
        found[f"bearing {place.bearing.name}"] = _energy(k, place.directions.T @ q)
    rest = own.stiffness - own.elastic
    found["seats and feet"] = _energy(rest, q)
    if not np.any(rest):
        del found["seats and feet"]
    total = sum(found.values())
    return {name: np.asarray(value / total) for name, value in found.items()}


def resonant_forces(
    train: LinearTrain, shape: ArrayLike, *, frequency: ArrayLike, force: ArrayLike
) -> Floats:
    """Force on each bearing, and last that of the teeth [N], of every mode alone at its resonance.

    (count + 1, modes). q = phi (phi^H f)/(i w phi^H C phi): ``shape`` phi (n, modes), ``frequency``
    w [rad/s] and ``force`` f (modes, n) [N, N m] at it. Infinite where nothing damps.
    """
    q, w = np.asarray(shape), np.asarray(frequency, dtype=float)
    push = np.sum(q.conj() * np.asarray(force, dtype=complex).T, axis=0)
    loss = _energy(train.damping, q) + train.slip_damping(w).real * _motor_turn(train, q)
    felt = [
        np.linalg.norm(np.asarray(k) @ (place.directions.T @ q), axis=0)
        for place, k in zip(train.assembly.bearings, train.bearings, strict=True)
    ]
    felt.append(np.abs(train.mesh * (train.assembly.drive @ q)))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(np.array(felt) * np.abs(push) / (w * loss))


def lift_off(
    speed: ArrayLike, *, ratio: ArrayLike, excess: ArrayLike, unbalance: bool = False
) -> Floats:
    """Speed below a resonance at which the force of its mode alone reaches ``1/excess`` of its top.

    2 zeta G/sqrt((1 - r^2)^2 + (2 zeta r)^2) = 1/excess at r = lift-off over resonance ``speed``;
    ``ratio`` zeta [-]. The push G is 1 at every speed, of an ``unbalance`` r^2, which gives the
    same quadratic in 1/r^2. 0 where it is as large at rest, nan where ``excess`` is below 1.
    """
    wide, high = 2.0 * np.asarray(ratio), np.asarray(excess, dtype=float)
    y = 1.0 - 0.5 * wide**2
    with np.errstate(invalid="ignore"):
        root = np.sqrt(y**2 - 1.0 + (wide * high) ** 2)
        share = np.sqrt(1.0 / (y + root) if unbalance else np.maximum(y - root, 0.0))
    return np.where(high >= 1.0, np.asarray(speed) * share, np.nan)


def _motor_turn(train: LinearTrain, q: NDArray[np.complex128] | Floats) -> Floats:
    """|motor's angle|^2 of every mode where it has a characteristic, else 0."""
    if not train.assembly.slip[0]:
        return np.zeros(q.shape[1])
    return np.asarray(np.abs(q[train.assembly.index["motor.tz"]]) ** 2)


def damping_ratios(train: LinearTrain, shape: ArrayLike, *, frequency: ArrayLike) -> Floats:
    """Damping ratio of every undamped mode (n, modes) by its own loss [-], (modes,).

    w q^H C q/(w^2 q^H M q + q^H K q), exact for light damping; ``frequency`` w [rad/s].
    """
    q, w = np.asarray(shape), np.asarray(frequency, dtype=float)
    energy = w**2 * _energy(train.assembly.mass, q) + _energy(train.stiffness, q)
    loss = _energy(train.damping, q) + train.slip_damping(w).real * _motor_turn(train, q)
    return np.asarray(w * loss / energy)


def _energy(stiffness: Floats, q: NDArray[np.complex128] | Floats) -> Floats:
    return np.asarray(np.sum(q.conj() * (stiffness @ q), axis=0).real)


def whirl(train: Assembly, shape: ArrayLike) -> dict[str, Floats]:
    """How each shaft whirls in ``shape`` (n, modes): +1 with its own sense, -1 against, 0 in line.

    w = sum of m 2 Im(x* y)/sum of m (|x|^2 + |y|^2), times the sense in which the shaft turns;
    nan where it does not move across. (modes,) per shaft.
    """
    q = np.asarray(shape)
    found = {}
    for shaft, turns in zip(SHAFTS, (1.0, -1.0), strict=True):
        rows = [
            [train.index[f"{shaft}.{i}.{c}"] for i in range(train.nodes[SHAFTS.index(shaft)].size)]
            for c in ("x", "y")
        ]
        weight = train.mass[rows[0], rows[0]][:, None]
        x, y = q[rows[0]], q[rows[1]]
        amount = np.sum(weight * (np.abs(x) ** 2 + np.abs(y) ** 2), axis=0)
        sense = 2.0 * np.sum(weight * np.imag(x.conj() * y), axis=0)
        still = amount <= 1e-16 * np.sum(np.abs(q) ** 2, axis=0) * weight.max()
        with np.errstate(invalid="ignore", divide="ignore"):
            found[shaft] = np.where(still, np.nan, -turns * train.frame.sense * sense / amount)
    return found
