"""From a mesh cycle to what dynamics needs: one Excitation per operating point."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.excitation import (
    Excitation,
    Excitations,
    FrictionSplit,
    Periodic,
    fourier_rows,
    padded,
)
from thermogear.base.vocabulary import moves
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

NO_ERROR = Periodic(0.0)


def disc_inertia(gear: Gear, *, radius: float, bore_radius: float = 0.0) -> float:
    """I = pi rho b (R^4 - r_x^4)/2 [kg m^2] of a disc of the gear's material and face width.

    ``radius`` R [m] of the disc (pitch or tip radius), ``bore_radius`` r_x [m], 0 for a solid
    disc.
    """
    if not 0.0 <= bore_radius < radius:
        raise InputError("bore_radius", f"{bore_radius} m", allowed=f"0 <= r_x < {radius} m")
    density = gear.material.density
    return 0.5 * math.pi * density * gear.face_width * (radius**4 - bore_radius**4)


def excitation(
    cycle: Dataset,
    pair: GearPair,
    *,
    damping_ratio: float,
    inertias: tuple[float, float] | None = None,
    transmission_error: Periodic = NO_ERROR,
    harmonics: int = 24,
    friction: Sequence[FrictionSplit | None] | None = None,
) -> list[Excitation | None]:
    """The excitation of every operating point of ``cycle``; None where the pair is jammed.

    :func:`excitations` one by one: ``inertias`` [kg m^2], ``transmission_error`` e [m].

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> warm = Temperatures.uniform(353.15, reference=293.15)
    >>> point = Operating(
    ...     speed=[100.0], torque=[200.0], lubricant=lubricant("FVA3"), oil_temperature=353.15,
    ...     temperatures=warm, half_backlash=60e-6,
    ... )
    >>> cycle = mesh_cycle(pair, point, mesh_positions=32, path_positions=21)
    >>> (one,) = excitation(cycle, pair, damping_ratio=0.05)
    >>> f"{one.mean_force:.0f} N"
    '5321 N'
    """
    found = excitations(
        cycle,
        pair,
        damping_ratio=damping_ratio,
        inertias=inertias,
        transmission_error=transmission_error,
        harmonics=harmonics,
        friction=friction,
    )
    return [found.one(place) for place in range(len(found))]


EXCITES = ("mesh_stiffness", "spring_error", "half_backlash", "cold_half_backlash")
"""What :func:`excitations` takes from a mesh cycle."""


def excitations(
    cycle: Dataset | Mapping[str, NDArray[Any]],
    pair: GearPair,
    *,
    damping_ratio: ArrayLike,
    inertias: ArrayLike | None = None,
    transmission_error: Periodic = NO_ERROR,
    harmonics: int = 24,
    friction: Sequence[FrictionSplit | None] | None = None,
) -> Excitations:
    """The excitation of every operating point of ``cycle``, in columns.

    k(t) keeps ``harmonics`` harmonics of the mesh stiffness (thermal stiffness included where
    the model has one). e(t) is the kinematic ``transmission_error`` [m] plus the cycle's
    ``spring_error``, the error that belongs to that stiffness (deviations and heat in it), both
    over the mesh phase; the loaded transmission error never enters, so that elasticity is not
    counted twice. Harmonics are those of the mesh frequency: of a turn of L mesh periods the
    tables keep L times as many orders.
    The half backlash is its mean over the phase, the length scale the cold one. ``inertias``
    [kg m^2], two or (operating, 2), default to solid discs of pitch radius; ``damping_ratio`` is a
    number or one for each point. Torques balance: T2 = T1 z2/z1. ``friction`` of the teeth by
    :func:`~thermogear.mesh.tooth_friction.friction_split`, one for each point, is handed on.
    Raises for a speed of 0, where no mesh frequency exists.
    """
    speeds = np.asarray(cycle["pinion_speed"], dtype=float)
    if np.any(speeds <= 0.0):
        raise InputError(
            "operating.speed",
            "0 rpm",
            allowed="> 0 rpm for motion",
            why="nothing excites a pair that does not turn",
            fix="raise the speed or leave motion out",
        )
    if inertias is None:
        inertias = (
            disc_inertia(pair.pinion, radius=pair.pinion.pitch_radius),
            disc_inertia(pair.wheel, radius=pair.wheel.pitch_radius),
        )
    count = speeds.size
    if friction is not None and len(friction) != count:
        raise InputError("friction", f"{len(friction)} of them", allowed=f"{count}, as the points")
    status = np.asarray(cycle["status"], dtype=np.int8)
    moving = moves(status)
    told: Any = cycle if "mesh_periods" in cycle else getattr(cycle, "attrs", {})
    periods = int(np.nanmax(told.get("mesh_periods", 1)))
    springs, heat = (
        fourier_rows(
            np.where(moving[:, None], np.asarray(cycle[name], dtype=float), 1.0),
            harmonics * periods,
        )
        for name in ("mesh_stiffness", "spring_error")
    )
    given = over_turn(Periodic.columns([transmission_error]), periods)
    width = max(given.shape[1], heat.shape[1])
    torque = np.asarray(cycle["pinion_torque"], dtype=float)
    return Excitations(
        status=status,
        stiffness=springs,
        error=padded(given, width) + padded(heat, width),
        half_backlash=np.asarray(cycle["half_backlash"], dtype=float),
        reference_half_backlash=np.asarray(cycle["cold_half_backlash"], dtype=float),
        mean_force=torque / pair.pinion.base_radius,
        mesh_frequency=pair.pinion.teeth * speeds,
        inertias=np.broadcast_to(np.asarray(inertias, dtype=float), (count, 2)),
        torques=np.stack([torque, torque * pair.ratio], axis=1),
        damping_ratio=np.broadcast_to(np.asarray(damping_ratio, dtype=float), (count,)),
        base_radii=np.broadcast_to([pair.pinion.base_radius, pair.wheel.base_radius], (count, 2)),
        friction=None if friction is None else tuple(friction),
        mesh_periods=periods,
    )


def over_turn(rows: NDArray[np.complex128], mesh_periods: int) -> NDArray[np.complex128]:
    """Fourier coefficients (row, 1 + harmonic) of a mesh period as those of a turn of many.

    >>> over_turn(np.array([[5.0 + 0j, 1.0, 2.0]]), 2).real
    array([[5., 0., 1., 0., 2.]])
    """
    found = np.zeros((len(rows), 1 + mesh_periods * (rows.shape[1] - 1)), complex)
    found[:, ::mesh_periods] = rows
    return found
