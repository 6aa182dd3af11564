"""Points of a family: lanes of the equation, and what turns their numbers back into SI."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from thermogear.base.excitation import Excitation, Periodic
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import GearCase
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel, from_excitation
from thermogear.dynamics.tables import Lanes
from thermogear.mesh.excite import excitation

Floats = NDArray[np.float64]
Whole = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Points:
    """Lanes of operating points; the first axis of every array is the point.

    ``status`` 1 where the pair is jammed (its lane is a placeholder). ``length`` b_c [m], ``rate``
    omega_n [rad/s], ``stiffness`` mean k_m [N/m], ``force`` mean F [N], ``error`` Fourier
    coefficients of e [m] (point, harmonic), ``mesh_frequency`` [rad/s], ``half_backlash`` hot b'
    [m]. Without gears (:meth:`plain`) lengths, rates and stiffness are 1, the mesh frequency 0.
    """

    flat: Lanes
    status: NDArray[np.int8]
    length: Floats
    rate: Floats
    stiffness: Floats
    force: Floats
    error: NDArray[np.complex128]
    mesh_frequency: Floats
    half_backlash: Floats

    @classmethod
    def plain(cls, lanes: Lanes) -> Points:
        """Lanes of pure numbers."""
        one, none = np.ones(len(lanes)), np.zeros(len(lanes))
        return cls(
            lanes, none.astype(np.int8), one, one, one, lanes.force[:, 0].real,
            np.zeros((len(lanes), 1), complex), none, lanes.half_backlash,
        )  # fmt: skip

    def lanes(self) -> Lanes:
        """The dimensionless lanes."""
        return self.flat

    def model(self, place: int = 0) -> DeadZoneModel:
        """The dimensionless equation of one point."""
        lane = self.flat
        stiffness, force = lane.stiffness[place], lane.force[place]
        return DeadZoneModel(
            damping_ratio=0.5 * float(lane.damping[place]),
            frequency=2.0 * np.pi / float(lane.period[place]),
            stiffness=Periodic(float(stiffness[0].real), tuple(stiffness[1:])),
            force=Periodic(float(force[0].real), tuple(force[1:])),
            half_backlash=float(lane.half_backlash[place]),
        )

    @property
    def gears(self) -> bool:
        """Whether gears give the numbers their units."""
        return bool(np.any(self.mesh_frequency != 0.0))

    @property
    def jammed(self) -> NDArray[np.bool_]:
        """Where no clearance is left to move in."""
        return np.asarray(self.status != 0)

    def take(self, index: Whole) -> Points:
        """Some of the points."""
        return Points(
            self.flat.take(index),
            self.status[index],
            self.length[index],
            self.rate[index],
            self.stiffness[index],
            self.force[index],
            self.error[index],
            self.mesh_frequency[index],
            self.half_backlash[index],
        )


def excitations(
    case: GearCase, cycle: xr.Dataset, harmonics: int | None = None
) -> list[Excitation | None]:
    """The excitation of every operating point of ``cycle``, of ``case``; None where it is jammed.

    ``harmonics`` replaces the case's number.
    """
    return excitation(
        cycle.drop_dims("path_position", errors="ignore"),
        case.pair,
        damping_ratio=case.damping_ratio,
        inertias=case.inertias,
        transmission_error=case.transmission_error,
        harmonics=case.harmonics if harmonics is None else harmonics,
    )


def points_of(found: Sequence[Excitation | None]) -> Points:
    """The points of excitations, those of a jammed pair as placeholders."""
    jammed = np.array([one is None for one in found])
    moving = [one for one in found if one is not None]
    count = len(found)
    nan = np.full(count, np.nan)
    if not moving:
        idle = TorsionalModel(
            damping_ratio=0.1,
            frequency=np.ones(count),
            stiffness_amplitude=0.0,
            mean_force=0.1,
            force_amplitude=0.0,
        ).lanes()
        status = np.full(count, STATUS.index("jammed"), np.int8)
        none = np.full((count, 1), np.nan, complex)
        return Points(idle, status, nan, nan, nan, nan, none, nan, nan)
    # a jammed point borrows the lane of a moving one; its status keeps it still
    place = np.where(jammed, 0, np.cumsum(~jammed) - 1)
    width = 1 + max(len(one.error.harmonics) for one in moving)
    error = np.zeros((len(moving), width), complex)
    for row, one in enumerate(moving):
        error[row, 0] = one.error.mean
        error[row, 1 : 1 + len(one.error.harmonics)] = one.error.harmonics
    values = np.array(
        [
            (
                one.reference_half_backlash,
                one.natural_frequency,
                one.stiffness.mean,
                one.mean_force,
                one.mesh_frequency,
                one.half_backlash,
            )
            for one in moving
        ]
    )[place]
    length, rate, stiffness, force, mesh, hot = values.T.copy()
    return Points(
        from_excitation(moving).lanes().take(place),
        np.where(jammed, STATUS.index("jammed"), 0).astype(np.int8),
        length,
        rate,
        stiffness,
        force,
        error[place],
        mesh,
        hot,
    )


def on_numbers(points: Points, numbers: dict[str, Floats]) -> Points:
    """``points`` with numbers of the equation in place of the gears' own, the force as it is."""
    flat, mesh, hot = points.flat, points.mesh_frequency, points.half_backlash
    if "frequency" in numbers:
        flat = replace(flat, period=2.0 * np.pi / numbers["frequency"])
        mesh = numbers["frequency"] * points.rate
    if "half_backlash" in numbers:
        flat = replace(flat, half_backlash=numbers["half_backlash"].copy())
        hot = numbers["half_backlash"] * points.length
    return replace(points, flat=flat, mesh_frequency=mesh, half_backlash=hot)
