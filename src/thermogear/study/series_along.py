"""A series of pairs in long work: its band over the speeds of a run, its columns in a sweep."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.notice import Notice
from thermogear.base.plan import Alive, Arrays, Variable, real
from thermogear.base.vocabulary import label, moves
from thermogear.case.allowed import LANE
from thermogear.case.case import GearCase
from thermogear.case.family import GearFamily
from thermogear.study.series import BAD, BAND, Series, SeriesPoint, Spread, series_motion
from thermogear.study.speeds import LOST

FEW_PARTS, MOST_PARTS = 16, 1024
"""Parts at each point of a sweep by default, and at most; the fewest of a series, as of a case."""
QUANTILES = {"low": BAND[0], "median": BAND[1], "bad": BAD, "high": BAND[2]}
"""Shares of parts that do not exceed a value, by what they are called."""
IN_COLUMNS = {
    "static_error": ("static error of the mean tooth, peak to peak", "m"),
    "dynamic_factor": ("dynamic factor", "1"),
    "contact_loss_share": ("share of time out of drive-side contact", "1"),
}
"""What of the parts stands at each point of a sweep as :data:`QUANTILES`."""


def parts_taken(case: GearCase, family: GearFamily, parts: int | None, *, usual: int) -> int:
    """How many parts of the series of ``case`` are followed: ``parts``, or ``usual``; 1: none.

    ``family`` of what varies. InputError for a number that no series has, and where the case is
    one part.
    """
    loaded = family.model.stiffness == "loaded" and not set(LANE) & set(family.names)
    in_series = case.series > 1 and loaded
    if parts is None:
        return usual if in_series else 1
    if parts != 1 and not FEW_PARTS <= parts <= MOST_PARTS:
        raise InputError("parts", parts, allowed=f"1 | {FEW_PARTS}..{MOST_PARTS}")
    if parts > 1 and not in_series:
        raise InputError(
            "parts", parts, allowed="1",
            why="the case is one part, its springs do not feel the flanks, or a number of the "
            "equation varies",
            fix="leave it out, or state a class without flanks.seed",
        )  # fmt: skip
    return parts


def _quantiles(values: Floats) -> Floats:
    """:data:`QUANTILES` of ``values`` (..., part) of the parts that are known, (quantile, ...)."""
    spreads = [Spread.of(row) for row in values.reshape(-1, values.shape[-1])]
    names = ("low", "middle", "bad", "high")
    each = [[getattr(spread, name).value for spread in spreads] for name in names]
    return np.reshape(each, (len(names), *values.shape[:-1]))


# --- over the speeds of a run ---------------------------------------------------------------------


def over_speeds(
    case: GearCase, count: int, families: Sequence[GearFamily], speeds: Floats
) -> Dataset:
    """The band of a series over ``speeds`` [rad/s] in each state of heat.

    ``families`` over the speed, one for each state: the mesh is that at the first speed of
    ``case``, where a run takes its heat from. ``series_dynamic_factor`` (state, quantile, damping,
    pinion_speed) and ``series_parting_share`` (state, damping, pinion_speed) of the first ``count``
    parts, each from rest at each speed, at the dampings of the case; nan where none is followed.
    ``series_parts`` that are followed and ``series_parting_parts`` that lose contact at a speed or
    more, (state, damping).
    """
    series, dampings = Series.of(case, count), np.array(case.dampings)
    shape = (len(families), dampings.size)
    factor = np.full((shape[0], len(QUANTILES), shape[1], speeds.size), np.nan)
    parting = np.full((*shape, speeds.size), np.nan)
    parts, lose = np.zeros((2, *shape), np.int32)
    at = np.array([[case.speeds[0]]])
    for state, family in enumerate(families):
        excited, hot = family.excitations(at), family.hot_pairs(at)[0]
        if hot is None or not moves(excited.status[0]):
            continue
        point = series.followed(hot[1], excited, speeds, own_speed=case.speeds[0])
        every, lost = point.motion.dynamic_factor, point.motion.contact_loss_share > LOST
        factor[state] = _quantiles(every.swapaxes(1, 2))
        there = np.isfinite(every).sum(axis=1)
        np.divide(lost.sum(axis=1), there, out=parting[state], where=there > 0)
        parts[state], lose[state] = point.counts, lost.any(axis=2).sum(axis=1)
    along = ("damping", "pinion_speed")
    return label(
        {
            "series_dynamic_factor": (
                ("state", "quantile", *along), factor, "1",
                "dynamic factor that a share of parts does not exceed",
            ),
            "series_parting_share": (
                ("state", *along), parting, "1", "share of parts that lose contact"
            ),
            "series_parts": (("state", "damping"), parts, "1", "parts that are followed"),
            "series_parting_parts": (
                ("state", "damping"), lose, "1", "parts that lose contact at one speed or more"
            ),
        },
        {
            "quantile": ("quantile", np.array([*QUANTILES.values()]), "1", "share of parts"),
            "damping_ratio": ("damping", dampings, "1", "damping ratio of the series"),
        },
    )  # fmt: skip


def band_notices(case: GearCase, parts: int, data: Dataset) -> Iterator[Notice]:
    """What the series behind a run is, its bad end, and what of the run is not of it."""
    bad = data["series_dynamic_factor"].values[:, [*QUANTILES].index("bad")]
    speeds, dampings = data["pinion_speed"].values, data["damping_ratio"].values
    if not moves(data["status"].values).any():
        return
    figures: dict[str, Any] = {}
    for place, name in enumerate(("", "_least")[: dampings.size]):
        here = bad[:, place]
        if np.isfinite(here).any():
            figures[f"bad{name}"] = float(np.nanmax(here))
            figures[f"speed{name}"] = float(speeds[np.nanargmax(here) % speeds.size])
            figures[f"pairs{name}"] = int(data["series_parting_parts"].values[:, place].max())
            figures[f"of{name}"] = int(data["series_parts"].values[:, place].max())
            figures[f"damping{name}"] = float(dampings[place])
    slow = np.isnan(bad[:, 0]).all(axis=0)
    yield Notice.of(
        "run_of_a_series",
        **figures,
        parts=parts,
        accuracy=case.accuracy,
        seed=case.seed,
        own=case.period.mesh_periods,
        slow=float(speeds[slow].max()) if slow.any() else None,
    )


# --- at the points of a sweep ---------------------------------------------------------------------


def point_variables(dims: tuple[str, ...]) -> dict[str, Variable]:
    """How :func:`at_points` is stored over ``dims``."""
    columns = {
        f"series_{name}_{which}": real(
            dims, f"{words}: {100.0 * share:.0f} % of parts do not exceed it", unit
        )
        for name, (words, unit) in IN_COLUMNS.items()
        for which, share in QUANTILES.items()
    }
    columns["series_parting_share"] = real(dims, "share of parts that lose contact", "1")
    return columns | {"series_parts": real(dims, "parts whose motion is followed", "1")}


def at_points(family: GearFamily, rows: Floats, parts: int, alive: Alive) -> Arrays:
    """:func:`point_variables` of every row of ``family``, SI, (row,); nan where nothing moves.

    Of the first ``parts`` parts of the gears, and the flanks, that the row has, at its load, speed
    and damping, as hot as its own motion is. ``series_parts`` is 0 where no motion is followed.
    """
    columns = {name: np.full(len(rows), np.nan) for name in point_variables(())}
    columns["series_parts"] = np.zeros(len(rows))
    excited = family.excitations(rows)
    every: dict[int, Series] = {}
    for place, heated in enumerate(family.hot_pairs(rows)):
        alive()
        if heated is None or not moves(excited.status[place]):
            continue
        case, hot = heated
        if id(case) not in every:
            every[id(case)] = Series.of(case, parts)
        here = excited.take(np.array([place]))
        mesh = every[id(case)].mesh(hot)
        motion = series_motion(mesh, here, hot.operating.speed, here.damping_ratio)
        point = SeriesPoint(mesh, motion, 0)
        lost = motion.contact_loss_share[0, :, 0]
        of_parts = (point.errors[1], motion.dynamic_factor[0, :, 0], lost)
        for name, values in zip(IN_COLUMNS, of_parts, strict=True):
            for which, value in zip(QUANTILES, _quantiles(values), strict=True):
                columns[f"series_{name}_{which}"][place] = value
        count = columns["series_parts"][place] = point.counts[0]
        if count:
            columns["series_parting_share"][place] = (lost > LOST).sum() / count
    return columns


def sweep_notice(case: GearCase, parts: int) -> Notice:
    """What the columns of a series are, and what the others are of."""
    return Notice.of(
        "sweep_of_a_series",
        parts=parts,
        accuracy=case.accuracy,
        seed=case.seed,
        own=case.period.mesh_periods,
    )
