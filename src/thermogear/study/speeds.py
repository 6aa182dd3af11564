"""A coarse look over the speeds: where a pair resonates, loses contact, hits back and may jump.

The mesh is that of one hot operating point; its speed alone varies, in steps of 2.5 %. Motions are
handed on from speed to speed until nothing new turns up; branches between the steps are not
followed (:func:`~thermogear.study.run_up.run_up` does, with the heat of each speed's state).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.settle import CHAOTIC, PERIODIC, UNDECIDED, WATCHED
from thermogear.analysis.side_by_side import APART, Motions, motions_along
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.excitation import Excitations
from thermogear.base.units import RPM
from thermogear.base.vocabulary import NO_COUNT, label
from thermogear.case.points import Points, points_of
from thermogear.case.response import Recording, respond
from thermogear.case.turn_response import DIGITS, turn_lanes, turn_tables
from thermogear.dynamics.turns import STEPS, UNBOUNDED, follow_turns

LOWEST, HIGHEST, STEP = 0.05, 1.8, 0.025
"""Mesh over natural frequency, and the step of it. At the lowest the twentieth harmonic of the
mesh meets the natural frequency: what those above it do, dies out within a mesh period."""
RECORD = Recording(periods=8, samples=STEPS)
LONG = replace(RECORD, periods=2 * WATCHED)
"""As many samples of a mesh period as a turn is followed in: 64 of them read dynamic factors of a
pair at a seventh of its resonance speed 1.2 % too low, which a turn of the same pair does not. Of a
chaotic motion: its greatest force at five loads a ten-thousandth apart differed by .7 % in
records of 256 periods, by 3 % in those of 128; in those of eight by some ten percent."""
FARTHEST = 10.0
"""How far the case's own speeds may widen that range."""
PEAK = 1.05
"""A peak stands out by this factor from the least between it and the next."""
LEAST_FACTOR = 0.99
"""Dynamic factor [-] below which a record has not seen its motion: 1 less what samples may miss of
a peak (ours)."""
TURN_STEP = 0.05
"""Of a mesh whose teeth differ, which costs a turn of both gears at every speed (chosen)."""
ALIKE = 1e-2
"""Of their greatest force: motions over several turns that differ by less are one (chosen)."""
LOST = 1e-3
"""Share of time out of contact below which contact is kept."""

VALUES = {
    "frequency_ratio": ("1", "mesh frequency over natural frequency"),
    "dynamic_factor": ("1", "dynamic factor: greatest mesh force over its mean"),
    "dte_peak_to_peak": ("m", "dynamic transmission error, peak to peak"),
    "contact_loss_share": ("1", "share of time out of drive-side contact"),
    "mesh_force_min": ("N", "dynamic mesh force, least; below 0 on the back flank"),
}
MOTIONS = {
    "period": ("1", "mesh periods of the motion, 0: none"),
    "label_code": ("1", "kind of the motion"),
}


@dataclass(frozen=True, eq=False)
class Speeds:
    """What a look over the speeds found: ``columns`` over (motion), and what is read off it.

    Among them the ``state`` (motion, 2) that a motion goes on from, which is not stored. Over a
    turn those that do not settle have figures too, of the later half of what was followed.
    """

    columns: Mapping[str, ArrayLike]
    step: float
    own: Floats = field(default_factory=lambda: np.empty(0))

    def column(self, name: str) -> Floats:
        """One of ``columns``."""
        return np.asarray(self.columns[name])

    @cached_property
    def data(self) -> Dataset:
        """The columns with their units, and the case's own speeds [rad/s]."""
        words = VALUES | MOTIONS
        found = {name: (("motion",), self.columns[name], *words[name]) for name in words}
        speed = {
            "pinion_speed": (("motion",), self.columns["pinion_speed"], "rad/s", "pinion speed")
        }
        data = label(found, speed, {"own_speeds": self.own})
        data["period"].attrs |= NO_COUNT
        return data

    @property
    def grid(self) -> Floats:
        """Every speed [rad/s], rising."""
        return np.unique(self.column("pinion_speed"))

    def ranges(self, where: NDArray[np.bool_]) -> list[tuple[float, float]]:
        """Connected ranges of speed [rad/s] in which a motion of those ``where`` lives."""
        hit = np.isin(self.grid, self.column("pinion_speed")[where])
        edges = np.flatnonzero(np.diff(np.concatenate(([0], hit.astype(int), [0]))))
        return [
            (float(self.grid[a]), float(self.grid[b - 1]))
            for a, b in zip(edges[::2], edges[1::2], strict=True)
        ]

    def beside(self, speed: Floats, *, start: Floats) -> Floats:
        """States (speed, k, 2) of the motions within a step of each ``speed`` [rad/s].

        Where a speed has fewer than others, its own ``start`` (speed, 2) fills up.
        """
        away = np.abs(np.log(speed[:, None] / self.column("pinion_speed")))
        near = away <= 1.01 * np.log1p(self.step)
        nearest = np.argsort(away, axis=1)[:, : int(near.sum(axis=1).max())]
        there = np.take_along_axis(near, nearest, axis=1)[..., None]
        return np.where(there, self.column("state")[nearest], start[:, None])

    @property
    def lost(self) -> list[tuple[float, float]]:
        """Ranges [rad/s] in which the flanks part."""
        return self.ranges(self.column("contact_loss_share") > LOST)

    @property
    def back(self) -> list[tuple[float, float]]:
        """Ranges [rad/s] in which a tooth hits the back side."""
        return self.ranges(self.column("mesh_force_min") < 0.0)

    @property
    def several(self) -> list[tuple[float, float]]:
        """Ranges [rad/s] in which two motions or more exist: a run-up may jump there."""
        speed = self.column("pinion_speed")
        _, place = np.unique(speed, return_inverse=True)
        count = np.bincount(place, self.settled)
        return self.ranges(count[place] > 1)

    @property
    def unsettled(self) -> int:
        """At how many speeds no motion settles."""
        return self.grid.size - np.unique(self.column("pinion_speed")[self.settled]).size

    @property
    def settled(self) -> NDArray[np.bool_]:
        """Of each motion whether it is known and more than what was followed of it."""
        known = np.isfinite(self.column("contact_loss_share"))
        return np.asarray(known & (self.column("label_code") != UNDECIDED))

    @property
    def open(self) -> int:
        """At how many speeds some start's motion does not settle: there may be another one."""
        waiting = self.column("label_code") == UNDECIDED
        return np.unique(self.column("pinion_speed")[waiting]).size

    def peaks(self) -> list[tuple[float, float]]:
        """:func:`peaks` of the greatest motions."""
        speed, factor = self.column("pinion_speed"), self.column("dynamic_factor")
        top = np.array([np.nanmax(factor[speed == one], initial=0.0) for one in self.grid])
        return peaks(self.grid, top=top)


def peaks(speed: Floats, *, top: Floats) -> list[tuple[float, float]]:
    """(speed [rad/s], dynamic factor) of the resonances of a curve ``top``, the greatest first."""
    inner = np.arange(1, top.size - 1)
    tops = inner[(top[inner] >= top[inner - 1]) & (top[inner] > top[inner + 1])]
    resonances = [
        (float(speed[i]), float(top[i]))
        for i in tops
        if top[i] > PEAK * max(_valley(top, i, -1), _valley(top, i, 1))
    ]
    return sorted(resonances, key=lambda one: -one[1])


def _valley(top: Floats, place: int, way: int) -> float:
    """The least on one side before something higher than the peak, the end's where none is."""
    side = top[place + way :: way] if way > 0 else top[place - 1 :: -1]
    higher = np.flatnonzero(side > top[place])
    return float(side[: higher[0] if higher.size else side.size].min())


def look(mesh: Excitations, *, teeth: int, own: Floats) -> Speeds:
    """Motions of a ``mesh`` of one point over the speed of its pinion of so many ``teeth``.

    Each of about 150 speeds is started as :func:`starts_of` has it. ``own``: the case's own
    speeds [rad/s], kept beside.
    """
    natural = float(mesh.natural_frequency[0])
    high = max(HIGHEST, min(1.1 * teeth * own.max() / natural, FARTHEST))
    step = STEP if mesh.mesh_periods == 1 else TURN_STEP
    count = int(np.ceil(np.log(high / LOWEST) / np.log1p(step)))
    ratio = np.geomspace(LOWEST, high, count + 1)
    along = mesh.take(np.zeros(ratio.size, int))
    lanes = points_of(replace(along, mesh_frequency=natural * ratio))
    motions, found = motions_of(lanes, starts_of(lanes), handed_on=True)
    columns: dict[str, ArrayLike] = dict(found)
    closed = motions.period * lanes.mesh_periods
    columns |= {"period": closed, "label_code": motions.label, "state": motions.state}
    columns["pinion_speed"] = lanes.mesh_frequency[motions.lane] / teeth
    return Speeds(columns, float(ratio[1] / ratio[0] - 1.0), np.unique(own))


def motions_of(
    points: Points, starts: Floats, *, handed_on: bool = False
) -> tuple[Motions, dict[str, Floats]]:
    """What ``points`` settle on from ``starts`` (point, start, 2), and their figures, (motion,).

    Of teeth that are alike: :func:`~thermogear.analysis.side_by_side.motions_along` and
    :func:`figures_of`. Where they differ the motion over the turn of the gears is followed, each
    start by itself, their states at the mesh period of the greatest error; where motions are
    ``handed_on`` the neighbours' are starts too.
    """
    if points.mesh_periods == 1:
        motions = motions_along(points.flat, starts)
        return motions, figures_of(points, motions)
    rows = _over_the_turn(points, starts)
    if handed_on:
        lane, state = rows["lane"].astype(int), np.stack([rows["x"], rows["v"]], axis=1)
        first = state[np.searchsorted(lane, np.arange(len(points.status)))]
        beside = np.stack([np.roll(first, 1, axis=0), np.roll(first, -1, axis=0)], axis=1)
        rows = _over_the_turn(points, np.concatenate([first[:, None], beside, starts], axis=1))
    motions = Motions(
        rows["lane"].astype(np.int64), np.stack([rows["x"], rows["v"]], axis=1),
        rows["label"].astype(np.int8), rows["period"].astype(np.int32),
    )  # fmt: skip
    return motions, {name: rows[name] for name in VALUES}


def _over_the_turn(points: Points, starts: Floats) -> dict[str, Floats]:
    """Every motion over a turn that the ``starts`` (point, start, 2) lead to, in columns."""
    count = starts.shape[1]
    rows: list[dict[str, float]] = []
    for index, tables in turn_tables(points):
        here = points.take(index)
        each = np.repeat(np.arange(index.size), count)
        begun = np.round(starts[index].reshape(-1, 2), DIGITS)
        motions = follow_turns(tables, turn_lanes(here).take(each), begun)
        newton = here.stiffness[each] * here.length[each]
        force = newton[:, None] * motions.force
        factor = np.abs(force).max(axis=1) / here.force[each]
        endless = (motions.period == 0) & (factor > UNBOUNDED)
        columns = {
            "lane": index[each],
            "frequency_ratio": (here.mesh_frequency / here.rate)[each],
            "dynamic_factor": np.where(endless, np.nan, factor),
            "dte_peak_to_peak": here.length[each] * np.ptp(motions.travel, axis=1),
            "contact_loss_share": motions.lost,
            "mesh_force_min": force[:, 1],
            "period": motions.period,
            "label": np.where(motions.period > 0, PERIODIC, UNDECIDED),
            "x": motions.state[:, 0],
            "v": motions.state[:, 1],
        }
        several: list[dict[str, float]] = []
        for values in zip(*columns.values(), strict=True):
            row = dict(zip(columns, map(float, values), strict=True))
            if not any(_alike(row, other) for other in several):
                several.append(row)
        rows += several
    rows.sort(key=lambda row: row["lane"])
    return {name: np.array([row[name] for row in rows]) for name in rows[0]}


def _alike(row: Mapping[str, float], other: Mapping[str, float]) -> bool:
    """Whether two motions of a lane are one."""
    if any(row[name] != other[name] for name in ("lane", "period", "label")):
        return False
    if row["label"] == UNDECIDED:
        return True
    if row["period"] == 1.0:
        return abs(row["x"] - other["x"]) < APART
    # a longer motion may be met at another turn of it
    return abs(row["dynamic_factor"] / other["dynamic_factor"] - 1.0) < ALIKE


def figures_of(points: Points, motions: Motions) -> dict[str, Floats]:
    """:func:`~thermogear.case.response.respond` of ``motions`` of ``points``, (motion,).

    nan where a motion does not settle, and where the record lies within a flight longer than it:
    over a steady motion the mesh force has the load as its mean, so its greatest is no less. What
    closes after more periods than are recorded, or never, is recorded over :data:`LONG`.
    """
    lanes = points.take(motions.lane)
    found = respond(lanes, motions.state, RECORD, lines=False)
    long = (motions.label == CHAOTIC) | (motions.period > RECORD.periods)
    if long.any():
        record = replace(LONG, periods=max(LONG.periods, int(motions.period[long].max())))
        more = respond(lanes.take(np.flatnonzero(long)), motions.state[long], record, lines=False)
        for name, values in more.items():
            found[name][long] = values
    unknown = (motions.label == UNDECIDED) | (found["dynamic_factor"] < LEAST_FACTOR)
    return {
        name: values if name == "frequency_ratio" else np.where(unknown, np.nan, values)
        for name, values in found.items()
    }


def starts_of(points: Points) -> Floats:
    """States (point, 3, 2): at rest in static contact, a far throw, on the back side."""
    gap, force = points.flat.half_backlash, points.flat.force[:, 0].real
    at = np.stack([gap + force, gap + 3.0 * force, -gap], axis=1)
    return np.stack([at, np.zeros_like(at)], axis=-1)


def told(
    ranges: list[tuple[float, float]], *, ends: tuple[float, float], most: int = 3
) -> tuple[str, dict[str, Any]]:
    """The first few ``ranges`` of speed [rad/s] in words, with their figures [rpm].

    A range that reaches one of the ``ends`` [rad/s] of the look says so: what is beyond, no one
    has looked at. Words and figures as :func:`~thermogear.base.display.worded` takes them.
    """

    def one(place: int, low: float, high: float) -> str:
        if low <= ends[0] and high >= ends[1]:
            return "at every speed looked at, {looked[0]:~3 rpm} to {looked[1]:~3 rpm}"
        lower, upper = f"{{ranges[{place}][0]:~3}}", f"{{ranges[{place}][1]:~3 rpm}}"
        if high >= ends[1]:
            return f"from {lower} rpm to the highest speed looked at, {{looked[1]:~3 rpm}}"
        if low <= ends[0]:
            return f"from the lowest speed looked at, {{looked[0]:~3 rpm}}, to {upper}"
        return f"from {lower} to {upper}" if high > low else f"near {upper}"

    words = [one(place, *ends_of) for place, ends_of in enumerate(ranges[:most])]
    more = max(len(ranges) - most, 0)
    shown = [[low / RPM, high / RPM] for low, high in ranges[:most]]
    figures = {"ranges": shown, "looked": [end / RPM for end in ends], "more": more}
    return ", ".join(words) + " and {more} more" * (more > 0), figures
