"""Points of a family: lanes of the equation, and what turns their numbers back into SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base import fourier
from thermogear.base.arrays import Dataset, Floats, Whole, by_row, rows_at
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations, Periodic
from thermogear.base.vocabulary import moves
from thermogear.case.allowed import FLUCTUATION
from thermogear.case.case import GearCase
from thermogear.dynamics.lanes import Lanes
from thermogear.dynamics.models import DeadZoneModel, TorsionalModel
from thermogear.mesh.excite import excitations as mesh_excitations


@dataclass(frozen=True, eq=False)
class Points:
    """Lanes of operating points; the first axis of every array is the point.

    ``status`` as :data:`~thermogear.base.vocabulary.STATUS`; where it is one of ``STILL`` the lane
    is a placeholder. ``length`` b_c [m], ``rate`` omega_n [rad/s], ``stiffness`` mean k_m [N/m],
    ``force`` mean F [N], ``error`` Fourier coefficients of e [m] (point, harmonic),
    ``mesh_frequency`` [rad/s], ``half_backlash`` hot b' [m]; the tables repeat after
    :attr:`mesh_periods`. Without gears (:meth:`plain`) lengths, rates and stiffness are 1, the mesh
    frequency 0.
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

    @property
    def mesh_periods(self) -> int:
        """After so many mesh periods stiffness and error repeat."""
        return self.flat.mesh_periods

    def lanes(self) -> Lanes:
        """The dimensionless lanes."""
        return self.flat

    def model(self, place: int = 0) -> DeadZoneModel:
        """The dimensionless equation of one point."""
        lane, stiffness, force = self.flat, self.flat.stiffness[place], self.flat.force[place]
        return DeadZoneModel(
            damping_ratio=0.5 * float(lane.damping[place]),
            frequency=2.0 * np.pi / float(lane.period[place]),
            stiffness=Periodic(float(stiffness[0].real), tuple(stiffness[1:])),
            force=Periodic(float(force[0].real), tuple(force[1:])),
            half_backlash=float(lane.half_backlash[place]),
            mesh_periods=lane.mesh_periods,
        )

    @property
    def gears(self) -> bool:
        """Whether gears give the numbers their units."""
        return bool(np.any(self.mesh_frequency != 0.0))

    @property
    def plane_scale(self) -> Floats:
        """[m] and [m/s] of one in (x, x'), (point, 2); nan without gears."""
        both = np.stack([self.length, self.length * self.rate], axis=1)
        return both if self.gears else np.full_like(both, np.nan)

    @property
    def still(self) -> NDArray[np.bool_]:
        """Where nothing moves: jammed, or no state is known to move in."""
        return ~moves(self.status)

    def kinematic(self, phase: Floats) -> Floats:
        """e [m] at ``phase`` [periods of the tables], (point, phase)."""
        if self.flat.by_fft:
            return fourier.values(self.error, phase)
        waves = np.exp(2j * np.pi * np.multiply.outer(np.arange(self.error.shape[1]), phase))
        # one product a point: the same to the last bit in every batch
        return np.asarray((self.error[:, None] @ waves)[:, 0].real)

    def take(self, index: Whole) -> Points:
        """Some of the points."""
        return Points(
            self.flat.take(index),
            self.status[index],
            self.length[index],
            self.rate[index],
            self.stiffness[index],
            self.force[index],
            rows_at(self.error, index),
            self.mesh_frequency[index],
            self.half_backlash[index],
        )


def excitations(
    case: GearCase, cycle: Dataset | Mapping[str, NDArray[Any]], harmonics: int | None = None
) -> Excitations:
    """The excitation of every operating point of ``cycle``, of ``case``.

    ``harmonics`` replaces the case's number.
    """
    return mesh_excitations(
        cycle,
        case.pair,
        damping_ratio=case.damping_ratio,
        inertias=case.inertias,
        transmission_error=case.transmission_error,
        harmonics=case.harmonics if harmonics is None else harmonics,
    )


def points_of(found: Excitations) -> Points:
    """The points of excitations, those that do not move as placeholders.

    The equation of :func:`~thermogear.dynamics.models.from_excitation`, all lanes at once.
    """
    still = ~moves(found.status)
    count = len(found)
    if still.all():
        idle = TorsionalModel(
            damping_ratio=0.1,
            frequency=np.ones(count),
            stiffness_amplitude=0.0,
            mean_force=0.1,
            force_amplitude=0.0,
        ).lanes()
        nan = np.full(count, np.nan)
        none = np.full((count, 1), np.nan, complex)
        idle = replace(idle, mesh_periods=found.mesh_periods)
        return Points(idle, found.status.astype(np.int8), nan, nan, nan, nan, none, nan, nan)
    status = found.status.astype(np.int8)
    if still.any():
        # a still point borrows the lane of a moving one; its status keeps it still
        found = found.take(np.where(still, int(np.argmin(still)), np.arange(count)))
    length, mean = found.reference_half_backlash, found.stiffness[:, 0].real
    rate = found.natural_frequency
    frequency = found.mesh_frequency / found.mesh_periods / rate
    # d/dtau = (w/2 pi) d/dphi
    ranks = np.arange(found.error.shape[1])
    bent = by_row(lambda error: error * (2j * np.pi * ranks) ** 2, found.error)
    scale = (frequency / (2.0 * np.pi)) ** 2 / length
    force: NDArray[np.complex128] = np.multiply(bent, scale[:, None])
    force *= -1.0
    force[:, 0] = found.mean_force / (mean * length)
    none_at_all = (None,) * count
    lanes = Lanes(
        period=2.0 * np.pi / frequency,
        damping=2.0 * found.damping_ratio,
        half_backlash=found.half_backlash / length,
        stiffness=by_row(lambda k: k * (1.0 / k[:, :1].real), found.stiffness),
        force=force,
        stiffness_pieces=none_at_all,
        force_pieces=none_at_all,
        mesh_periods=found.mesh_periods,
    )
    return Points(
        lanes,
        status,
        length,
        rate,
        mean,
        found.mean_force,
        found.error,
        found.mesh_frequency,
        found.half_backlash,
    )


def largest_fluctuation(points: Points) -> Floats:
    """The factor on the fluctuation of the mesh stiffness at which it would reach zero, (point,).

    k = k_m (1 + s w(t)) with the pair's own w: s = -1/min w; infinite without fluctuation.
    """
    rows = points.flat.stiffness
    mean = rows[:, 0].real
    least = fourier.sampled(rows, 8 * rows.shape[1]).min(axis=1) - mean
    return np.asarray(np.divide(mean, -least, out=np.full(mean.size, np.inf), where=least < 0.0))


def on_numbers(points: Points, numbers: dict[str, Floats]) -> Points:
    """``points`` with numbers of the equation in place of the gears' own, the force as it is."""
    if FLUCTUATION in numbers:
        factor, most = numbers[FLUCTUATION], largest_fluctuation(points)
        beyond = (factor >= most) & ~points.still
        if beyond.any():
            raise InputError(
                FLUCTUATION,
                f"{float(factor[beyond].max()):g}",
                allowed=f"below {float(most[beyond].min()):.4g}",
                why="the mesh stiffness would reach zero",
            )
        stiffness = points.flat.stiffness.copy()
        stiffness[:, 1:] *= factor[:, None]
        points = replace(points, flat=replace(points.flat, stiffness=stiffness))
    flat, mesh, hot = points.flat, points.mesh_frequency, points.half_backlash
    if "frequency" in numbers:
        flat = replace(flat, period=flat.mesh_periods * (2.0 * np.pi / numbers["frequency"]))
        mesh = numbers["frequency"] * points.rate
    if "half_backlash" in numbers:
        flat = replace(flat, half_backlash=numbers["half_backlash"].copy())
        hot = numbers["half_backlash"] * points.length
    return replace(points, flat=flat, mesh_frequency=mesh, half_backlash=hot)
