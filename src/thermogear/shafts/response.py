"""Forced vibration of the linear drive train: transmission error, unbalance and run-out.

Amplitudes are complex, the motion is Re(a e^{iwt}) with w = order times the pinion's speed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Complexes, Floats
from thermogear.base.errors import InputError
from thermogear.shafts.assembly import Assembly
from thermogear.shafts.linear import LinearTrain
from thermogear.shafts.train import SHAFTS, RunOut, Unbalance


@dataclass(frozen=True, eq=False, kw_only=True)
class Response:
    """Response over the pinion's speed, arrays ``(speed,)`` first, complex amplitudes.

    ``frequency`` w [rad/s]; ``displacement`` (speed, n) [m, rad]; ``mesh_force`` (speed,) [N], the
    dynamic part along the drive flank; ``bearing_force`` (speed, count, 2) [N] from the journal on
    its ring; ``ring_acceleration`` (speed, count, 2) [m/s^2] of the outer rings, zero where they
    are fixed; ``casing_acceleration`` (speed, 2) [m/s^2].
    """

    speed: Floats
    frequency: Floats
    displacement: Complexes
    mesh_force: Complexes
    bearing_force: Complexes
    ring_acceleration: Complexes
    casing_acceleration: Complexes


def loaded_error(
    stiffness: ArrayLike, error: ArrayLike, *, mean_stiffness: float, mean_force: float
) -> Complexes:
    """Harmonics of the error that a linear mesh is driven by [m], first order.

    k(t) = k + Re sum k_h e^{ihwt} under the mean force F moves the flanks as an error does: e_h -
    k_h F/k^2. ``stiffness`` k_h [N/m] and ``error`` e_h [m], orders 1, 2, ... along the last axis,
    padded with zeros to one length; ``mean_force`` F [N].
    """
    k, e = np.asarray(stiffness, dtype=complex), np.asarray(error, dtype=complex)
    found = np.zeros(max(k.shape[-1], e.shape[-1]), complex)
    found[: e.shape[-1]] += e
    found[: k.shape[-1]] -= k * mean_force / mean_stiffness**2
    return found


def error_response(
    train: LinearTrain, speed: ArrayLike, *, order: float, error: complex
) -> Response:
    """Response to an error e = Re(``error`` e^{iwt}) [m] in the mesh.

    It pushes with (k + i w c_m) e along the drive flank. ``speed`` (speed,) [rad/s]; w is
    ``order`` times it, h z1 for mesh harmonic h.
    """
    omega = _rising(speed)
    w = order * omega
    push = (train.mesh + 1j * w * train.mesh_damping) * error
    return _outputs(train, omega, w, np.multiply.outer(push, train.assembly.drive), error)


def unbalance_response(
    train: LinearTrain, speed: ArrayLike, shaft: str, unbalances: Sequence[Unbalance]
) -> Response:
    """Response to the ``unbalances`` of one shaft, at its own speed.

    m e_c W^2 (cos, sin) of the angle that turns with the shaft, W the shaft's speed. ``speed``
    (speed,) [rad/s] of the pinion.
    """
    omega = _rising(speed)
    ratio = 1.0 if shaft == SHAFTS[0] else train.assembly.frame.ratio
    w = abs(ratio) * omega
    pull = unbalance_pull(train.assembly, shaft, unbalances)
    return _outputs(train, omega, w, np.multiply.outer(w**2, pull), 0.0)


def unbalance_pull(assembly: Assembly, shaft: str, unbalances: Sequence[Unbalance]) -> Complexes:
    """Complex force (n,) of one shaft's ``unbalances`` over the square of its speed [kg m]."""
    ratio = 1.0 if shaft == SHAFTS[0] else assembly.frame.ratio
    pull = np.zeros(assembly.size, complex)
    for one in unbalances:
        if one.shaft == shaft:
            pull += _turning(assembly, one, ratio)
    return pull


def run_out_error(assembly: Assembly, run_out: RunOut) -> complex:
    """Amplitude e [m] at the shaft's own order of the error that an eccentric gear makes.

    The gear's centre, moved by ``eccentricity``, pushes its flank along the drive normal; the
    other gear sees it as an error of that size.
    """
    return run_out_errors(assembly, run_out)[0]


def run_out_errors(assembly: Assembly, run_out: RunOut) -> tuple[complex, complex]:
    """:func:`run_out_error` as the drive flank and as the back flank see it, each closing less."""
    pinion = run_out.shaft == SHAFTS[0]
    moved = _circle(run_out.angle, 1.0 if pinion else assembly.frame.ratio, assembly.frame.sense)
    size = run_out.eccentricity * (-1.0 if pinion else 1.0)
    drive, back = (complex(size * (normal @ moved)) for normal in assembly.frame.normals)
    return drive, back


def _rising(speed: ArrayLike) -> Floats:
    omega = np.atleast_1d(np.asarray(speed, dtype=float))
    if not np.all(np.isfinite(omega) & (omega >= 0.0)):
        raise InputError("speed", f"{omega.min()} rad/s", allowed=">= 0 rad/s, finite")
    return omega


def _circle(angle: float, ratio: float, sense: int) -> Complexes:
    """(x, y) of a unit vector that turns with a shaft: Re(found e^{iwt})."""
    forward = ratio * sense > 0.0
    first = np.exp(1j * angle if forward else -1j * angle)
    return np.array([first, -1j * first if forward else 1j * first], dtype=complex)


def _turning(assembly: Assembly, one: Unbalance, ratio: float) -> Complexes:
    """Force (n,) per (rad/s)^2."""
    at = assembly.at(one.shaft, one.position)[:, :2]
    return np.asarray(one.moment * (at @ _circle(one.angle, ratio, assembly.frame.sense)))


def _outputs(
    train: LinearTrain, omega: Floats, w: Floats, force: ArrayLike, error: complex
) -> Response:
    own = train.assembly
    q = train.respond(w, speed=omega, force=force)
    through = train.mesh + 1j * w * train.mesh_damping
    pushed, shaken = [], []
    for number, (place, k) in enumerate(zip(own.bearings, train.bearings, strict=True)):
        u = q @ place.directions
        lost = u @ train.bearing_damping(number).T
        pushed.append(u @ np.asarray(k).T + 1j * w[:, None] * lost)
        shaken.append(-(w[:, None] ** 2) * (q @ place.ring))
    casing = (
        -(w[:, None] ** 2) * q[:, [own.index["casing.x"], own.index["casing.y"]]]
        if "casing.x" in own.index
        else np.zeros((omega.size, 2), complex)
    )
    count = len(own.bearings)
    return Response(
        speed=omega,
        frequency=w,
        displacement=q,
        mesh_force=through * (q @ own.drive - error),
        bearing_force=np.asarray(pushed).reshape(count, omega.size, 2).swapaxes(0, 1),
        ring_acceleration=np.asarray(shaken).reshape(count, omega.size, 2).swapaxes(0, 1),
        casing_acceleration=casing,
    )
