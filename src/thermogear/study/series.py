"""A series: many gear pairs of one drawing and class, what each of them does over its turn."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations, fourier_rows
from thermogear.case.case import GearCase
from thermogear.case.flanks import deviations
from thermogear.dynamics.turns import TurnLanes, TurnTables, follow_turns
from thermogear.gears.deviations import Deviation
from thermogear.mesh.series import SeriesMesh

AT_BOUNDS = 16
"""Parts of a series whose motions are followed at the bounds of the damping."""
HARMONICS = 24
"""Of the mesh frequency, of stiffness and error, as in a case."""


def series_parts(case: GearCase, count: int) -> tuple[tuple[Deviation, ...], ...]:
    """Deviations of the first ``count`` parts of the series of ``case``.

    Part n has the n-th drawing of the case's class and seed
    (:func:`~thermogear.gears.population.drawn_pair`), also where the flanks of the case itself are
    no drawing of whole gears, and what the case states beside it. InputError without a class.
    """
    flanks = case.file.flanks
    if flanks is None or case.accuracy is None:
        raise InputError(
            "flanks.accuracy", "none", allowed="a class of ISO 1328-1", fix="give the class"
        )

    def part(place: int) -> tuple[Deviation, ...]:
        drawn = flanks.model_copy(update={"teeth": "drawn", "drawing": place})
        return deviations(case.file.model_copy(update={"flanks": drawn}), case.pair, case.charts)

    return tuple(part(place) for place in range(count))


@dataclass(frozen=True, eq=False)
class SeriesMotion:
    """Motions of the parts of a series, (damping, part, speed).

    ``speed`` (speed,) [rad/s] of the pinion, ``damping_ratio`` (damping,). ``dynamic_factor``:
    greatest mesh force over its mean; ``contact_loss_share``: of time, out of drive-side contact;
    ``mesh_force_min`` [N], < 0 on the back flanks; each over the last turn that was followed, also
    where that does not repeat another: ``repeats``. All parts at the first damping ratio, the
    first :data:`AT_BOUNDS` at the others: nan for the rest, which does not repeat.
    """

    speed: Floats
    damping_ratio: Floats
    dynamic_factor: Floats
    contact_loss_share: Floats
    mesh_force_min: Floats
    repeats: NDArray[np.bool_]


def series_motion(
    mesh: SeriesMesh, point: Excitations, speed: Floats, damping_ratio: Floats
) -> SeriesMotion:
    """Motions of every part of ``mesh`` at each ``speed`` [rad/s] of the pinion.

    ``point``: excitation of one operating point, of any part at any speed: inertias, base radii,
    mean force and cold half backlash are taken from it; stiffness, error and half backlash are the
    parts' own in ``mesh``.
    """
    mass, load = float(point.equivalent_mass[0]), float(point.mean_force[0])
    length = float(point.reference_half_backlash[0])
    shape = (damping_ratio.size, len(mesh.stiffness), speed.size)
    factor, lost, least = np.full((3, *shape), np.nan)
    repeats = np.zeros(shape, bool)
    orders = HARMONICS * mesh.mesh_periods
    for part in range(shape[1]):
        stiffness = fourier_rows(mesh.stiffness[[part]], orders)[0]
        error = fourier_rows(mesh.spring_error[[part]], orders)[0]
        mean = float(stiffness[0].real)
        tables = TurnTables(
            stiffness=stiffness / mean, error=error / length, mesh_periods=mesh.mesh_periods
        )
        rate = np.sqrt(mean / mass)
        period = 2.0 * np.pi * rate * mesh.mesh_periods / (mesh.pair.pinion.teeth * speed)
        backlash = float(mesh.half_backlash[part].mean()) / length
        for number, zeta in enumerate(damping_ratio[: None if part < AT_BOUNDS else 1]):
            full = np.ones(speed.size)
            force = full * load / (mean * length)
            lanes = TurnLanes(
                mean=force, damping=2.0 * zeta * full, backlash=backlash * full, period=period
            )
            start = np.stack([backlash + force, 0.0 * full], axis=1)
            motions = follow_turns(tables, lanes, start)
            at = number, part
            newton = mean * length * motions.force
            factor[at] = np.abs(newton).max(axis=1) / load
            lost[at], least[at] = motions.lost, newton[:, 1]
            repeats[at] = motions.period > 0
    return SeriesMotion(speed, damping_ratio, factor, lost, least, repeats)
