"""A series: many gear pairs of one drawing and class, what each of them does over its turn."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.order_statistics import Estimate, quantile
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations
from thermogear.case.case import GearCase
from thermogear.case.flanks import deviations
from thermogear.dynamics.turns import SLOWEST_PART, UNBOUNDED, PartTables, follow_parts
from thermogear.gears.deviations import Deviation
from thermogear.gears.tooth_damage import damages_of
from thermogear.gears.turn import turn_period
from thermogear.mesh.series import SeriesMesh, followed_periods, series_mesh
from thermogear.mesh.thermal import HotPair

AT_BOUNDS = 32
"""Parts of a series whose motions are followed at the bounds of the damping: what happens in none
of 29 happens in less than 10 % of all, with a confidence of 95 %."""

BAND = (0.05, 0.5, 0.95)
"""Quantiles that are told: the middle, and the ends of what holds 90 % of parts."""
BAD = 0.9
"""Quantile that a verdict rests on: nine of ten parts do better (ours)."""
CLOSE = 0.1
"""Width of a band over its middle below which three figures tell its ends apart, else two do."""


@dataclass(frozen=True)
class Spread:
    """Quantiles of some parts: 5, 50 and 95 %, and the one that a verdict rests on."""

    low: Estimate
    middle: Estimate
    high: Estimate
    bad: Estimate

    @classmethod
    def of(cls, values: Floats) -> Spread:
        """Of what is known of the parts; nan where nothing is."""
        known = values[np.isfinite(values)]
        if not known.size:
            return cls(*[Estimate(np.nan, np.nan, np.nan)] * 4)
        return cls(*(quantile(known, share=share) for share in (*BAND, BAD)))

    @property
    def digits(self) -> int:
        """Figures that its ends are told with."""
        return 3 if self.high.value - self.low.value < CLOSE * self.middle.value else 2

    def figures(self, name: str, scale: float = 1.0) -> dict[str, Any]:
        """The numbers times ``scale`` as figures of an answer, their 95 % intervals beside them."""
        figures: dict[str, Any] = {}
        for which, estimate in vars(self).items():
            value, *ends = (scale * number for number in estimate)
            figures[f"{name}_{which}"] = value
            if np.isfinite(ends).all():  # few parts do not bound a far quantile
                figures[f"{name}_{which}_interval"] = ends
        return figures | {"held": 100.0 * (BAND[2] - BAND[0])}


def middle_and_worst(values: Floats) -> tuple[int, int] | None:
    """Places of the median and the greatest of what is known of the parts; None where nothing is.

    >>> middle_and_worst(np.array([3.0, np.nan, 1.0, 2.0]))
    (3, 0)
    """
    order = np.argsort(values)[: np.count_nonzero(np.isfinite(values))]
    return (int(order[(order.size - 1) // 2]), int(order[-1])) if order.size else None


def series_parts(case: GearCase, count: int) -> tuple[tuple[Deviation, ...], ...]:
    """Deviations of the first ``count`` parts of the series of ``case``.

    Part n has the n-th drawing of the case's class and seed
    (:func:`~thermogear.gears.population.drawn_pair`), also where the flanks of the case itself are
    no drawing of whole gears or of its mean tooth alone, and what the case states beside it.
    InputError without a class.
    """
    flanks = case.file.flanks
    if flanks is None or case.accuracy is None:
        raise InputError(
            "flanks.accuracy", "none", allowed="a class of ISO 1328-1", fix="give the class"
        )

    gears = case.file.gears.model_copy(update={"period": "turn"})

    def part(place: int) -> tuple[Deviation, ...]:
        drawn = flanks.model_copy(update={"teeth": "drawn", "drawing": place})
        file = case.file.model_copy(update={"flanks": drawn, "gears": gears})
        return deviations(file, case.pair, case.charts)

    return tuple(part(place) for place in range(count))


@dataclass(frozen=True, eq=False, kw_only=True)
class SeriesMotion:
    """Motions of the parts of a series, (damping, part, speed).

    ``speed`` (speed,) [rad/s] of the pinion, ``damping_ratio`` (damping,). ``dynamic_factor``:
    greatest mesh force over its mean; ``contact_loss_share``: of time, out of drive-side contact;
    ``mesh_force_min`` [N], < 0 on the back flanks; each over the last turn that was followed, also
    where that does not repeat another: ``repeats``. ``alike``: both starts of a part end on one
    motion that repeats. All parts at the first damping ratio, the first :data:`AT_BOUNDS` at the
    others: nan for the rest, which does not repeat. A motion that grows without end has the dynamic
    factor :data:`~thermogear.dynamics.turns.UNBOUNDED`.
    """

    speed: Floats
    damping_ratio: Floats
    dynamic_factor: Floats
    contact_loss_share: Floats
    mesh_force_min: Floats
    repeats: NDArray[np.bool_]
    alike: NDArray[np.bool_]


def series_motion(
    mesh: SeriesMesh,
    point: Excitations,
    speed: Floats,
    damping_ratio: Floats,
    *,
    bounds_to: float = np.inf,
) -> SeriesMotion:
    """Motions of every part of ``mesh`` at each ``speed`` [rad/s] of the pinion.

    At the dampings after the first up to the speed ``bounds_to`` [rad/s] alone.

    ``point``: excitation of one operating point, of any part at any speed: inertias, base radii
    and mean force are taken from it, and how many harmonics of the mesh frequency are kept;
    stiffness, error and half backlash are the parts' own in ``mesh``. nan for parts that are jammed
    somewhere or whose contact does not settle, without load, and below :data:`SLOWEST_PART`.
    """
    mass, load = float(point.equivalent_mass[0]), float(point.mean_force[0])
    count = len(mesh.stiffness)
    moves = np.isfinite(mesh.stiffness).all(axis=1) & (mesh.half_backlash.min(axis=1) > 0.0)
    shape = (damping_ratio.size, count, speed.size)
    factor, lost, least = np.full((3, *shape), np.nan)
    repeats, alike = np.zeros((2, *shape), bool)
    mean = mesh.stiffness.mean(axis=1)
    natural = np.sqrt(mean / mass)
    harmonics = (point.stiffness.shape[1] - 1) // point.mesh_periods
    tables = PartTables.of(
        stiffness=mesh.stiffness / mean[:, None], error=mesh.spring_error,
        mesh_periods=mesh.mesh_periods, harmonics=harmonics, ahead=mesh.ahead, periodic=mesh.whole,
    )  # fmt: skip
    rate = 2.0 * np.pi * natural[:, None] / (mesh.pair.pinion.teeth * speed)
    # the least of the turn: a hit is told rather than missed, contact kept is the same with any
    backlash, deep = mesh.half_backlash.min(axis=1), load / mean
    within = int(np.count_nonzero(speed <= bounds_to * (1.0 + 1e-9)))
    for number, ratio in enumerate(damping_ratio):
        part = np.flatnonzero(moves[:AT_BOUNDS] if number else moves)
        count = within if number else speed.size
        if not part.size or not count or load <= 0.0:
            continue
        motions = follow_parts(
            tables.take(part), rate=rate[part, :count], damping_ratio=np.full(part.size, ratio),
            backlash=backlash[part], load=deep[part],
        )  # fmt: skip
        at, newton = (number, part, slice(count)), mean[part, None]
        most = newton * np.maximum(motions.greatest, -motions.least)
        factor[at], least[at] = most / load, newton * motions.least
        lost[at], repeats[at], alike[at] = motions.lost, motions.repeats, motions.alike
    factor[~repeats & (factor > UNBOUNDED)] = UNBOUNDED
    slow = rate > 2.0 * np.pi / SLOWEST_PART
    for figure in (factor, lost, least):
        figure[:, slow] = np.nan
    repeats[:, slow] = alike[:, slow] = False
    return SeriesMotion(
        speed=speed, damping_ratio=damping_ratio, dynamic_factor=factor, contact_loss_share=lost,
        mesh_force_min=least, repeats=repeats, alike=alike,
    )  # fmt: skip


@dataclass(frozen=True, eq=False)
class SeriesPoint:
    """The parts of a series at one operating point: their mesh, and their motions over speed.

    ``place`` of the own speed of the operating point among those of the motions.
    """

    mesh: SeriesMesh
    motion: SeriesMotion
    place: int

    @property
    def counts(self) -> NDArray[np.int64]:
        """How many pairs are followed at each damping."""
        return np.asarray(np.isfinite(self.motion.dynamic_factor).any(axis=2).sum(axis=1))

    @property
    def jammed(self) -> NDArray[np.bool_]:
        """Which parts jam somewhere in what is followed of their turn."""
        return np.asarray(self.mesh.half_backlash.min(axis=1) <= 0.0)

    @property
    def errors(self) -> tuple[Floats, Floats]:
        """Static errors [m] peak to peak, over the whole turn and repeated with the mesh.

        nan of parts that are jammed.
        """
        error = self.mesh.transmission_error
        mean = error.reshape(len(error), self.mesh.mesh_periods, -1).mean(axis=1)
        turn, mesh = self.mesh.peak_to_peak, np.ptp(mean, axis=1)
        return np.where(self.jammed, np.nan, turn), np.where(self.jammed, np.nan, mesh)


@dataclass(frozen=True, eq=False)
class Series:
    """The first parts of the series of a ``case``, and what of the turn of each is followed.

    ``periods`` mesh periods, from mesh period ``start`` of each part on: the whole turn, or a
    stretch of a longer one (:func:`~thermogear.mesh.series.followed_periods`).
    """

    case: GearCase
    parts: tuple[tuple[Deviation, ...], ...]
    periods: int
    start: tuple[int, ...] | None

    @classmethod
    def of(cls, case: GearCase, count: int | None = None) -> Series:
        """Of the first ``count`` parts; of as many as the case states by default."""
        parts = series_parts(case, case.series if count is None else count)
        turn = turn_period(case.pair, parts[0]).mesh_periods
        periods = min(turn, followed_periods(case.pair))
        if turn == periods:
            return cls(case, parts, periods, None)
        start = np.random.default_rng(case.seed).integers(turn, size=len(parts))
        if damages_of(parts[0]):  # the same tooth in all parts, which are solved together then
            start[:] = start[0]
        return cls(case, parts, periods, tuple(start.tolist()))

    def some(self, which: slice) -> Series:
        """Some of the parts."""
        return replace(self, parts=self.parts[which], start=self.start and self.start[which])

    def mesh(self, hot: HotPair) -> SeriesMesh:
        """The loaded mesh of every part at the one operating point of ``hot``."""
        return series_mesh(hot, self.parts, self.periods, start=self.start)

    def followed(
        self,
        hot: HotPair,
        excited: Excitations,
        speed: Floats,
        *,
        own_speed: float,
        bounds_to: float = np.inf,
    ) -> SeriesPoint:
        """Mesh and motions at ``hot``, whose mean tooth is ``excited``, at the case's dampings.

        ``speed`` (speed,) [rad/s] of the pinion, rising, ``own_speed`` the one of the operating
        point; ``bounds_to`` as of :func:`series_motion`.
        """
        mesh, dampings = self.mesh(hot), np.array(self.case.dampings)
        motion = series_motion(mesh, excited, speed, dampings, bounds_to=bounds_to)
        return SeriesPoint(mesh, motion, int(np.argmin(np.abs(speed - own_speed))))
