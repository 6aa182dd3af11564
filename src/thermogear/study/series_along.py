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
BAD_PLACE = [*QUANTILES].index("bad")
HEATED = ("case", "hot_pair", "cold_half_backlash")
"""What is asked of a family; the last is the cheapest of a mesh cycle."""
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
    if parts != 1 and not (in_series and FEW_PARTS <= parts <= MOST_PARTS):
        raise InputError(
            "parts", parts, allowed=f"1 | {FEW_PARTS}..{MOST_PARTS}" if in_series else "1",
            why=None if in_series else "the case is one part, its springs do not feel the flanks, "
            "or a number of the equation varies",
        )  # fmt: skip
    return parts


def _quantiles(values: Floats) -> Floats:
    """:data:`QUANTILES` of ``values`` (..., part) of the parts that are known, (quantile, ...)."""
    spreads = [Spread.of(row) for row in values.reshape(-1, values.shape[-1])]
    each = [
        [getattr(spread, name).value for spread in spreads]
        for name in ("low", "middle", "bad", "high")
    ]
    return np.reshape(each, (len(QUANTILES), *values.shape[:-1]))


def _about(case: GearCase, parts: int) -> dict[str, Any]:
    """What is told of the first ``parts`` of the series of ``case``, and of its one pair."""
    series = Series.of(case, 1)
    return {
        "parts": parts, "accuracy": case.accuracy, "seed": case.seed,
        "periods": None if series.start is None else series.periods,
        "own": case.period.mesh_periods,
    }  # fmt: skip


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
    more, (state, damping); ``series_worst_...`` where one part in ten exceeds the most.
    """
    series, dampings = Series.of(case, count), np.array(case.dampings)
    shape = (len(families), dampings.size)
    factor = np.full((shape[0], len(QUANTILES), shape[1], speeds.size), np.nan)
    parting = np.full((*shape, speeds.size), np.nan)
    parts, lose = np.zeros((2, *shape), np.int32)
    at = np.array([[case.speeds[0]]])
    for state, family in enumerate(families):
        excited = family.excitations(at)
        if not moves(excited.status[0]):
            continue
        hot = family.quasi_static(at, HEATED)["hot_pair"][0]
        point = series.followed(hot, excited, speeds, own_speed=case.speeds[0])
        lost = point.motion.contact_loss_share > LOST
        parts[state], lose[state] = point.counts, lost.any(axis=2).sum(axis=1)
        factor[state] = _quantiles(point.motion.dynamic_factor.swapaxes(1, 2))
        share = lost.sum(axis=1) / np.maximum(point.counts, 1)[:, None]
        parting[state] = np.where(np.isnan(factor[state, 0]), np.nan, share)
    worst = np.argmax(np.nan_to_num(factor[:, BAD_PLACE]), axis=-1)
    along, of_quantiles = ("damping", "pinion_speed"), ("state", "quantile", "damping")
    return label(
        {
            "series_dynamic_factor": (
                (*of_quantiles, "pinion_speed"), factor, "1",
                "dynamic factor that a share of parts does not exceed",
            ),
            "series_parting_share": (
                ("state", *along), parting, "1", "share of parts that lose contact"
            ),
            "series_parts": (("state", "damping"), parts, "1", "parts that are followed"),
            "series_parting_parts": (
                ("state", "damping"), lose, "1", "parts that lose contact at one speed or more"
            ),
            "series_worst_speed": (
                ("state", "damping"), np.where(parts > 0, speeds[worst], np.nan), "rad/s",
                "speed at which one part in ten exceeds the most",
            ),
            "series_worst_dynamic_factor": (
                of_quantiles, np.take_along_axis(factor, worst[:, None, :, None], axis=-1)[..., 0],
                "1", "dynamic factor there",
            ),
        },
        {
            "quantile": ("quantile", np.array([*QUANTILES.values()]), "1", "share of parts"),
            "damping_ratio": ("damping", dampings, "1", "damping ratio of the series"),
        },
    )  # fmt: skip


def band_notices(case: GearCase, parts: int, data: Dataset) -> Iterator[Notice]:
    """What the series behind a run is, its bad end, and what of the run is not of it."""
    if not moves(data["status"].values).any():
        return
    bad = np.nan_to_num(data["series_worst_dynamic_factor"].values[:, BAD_PLACE, 0])
    worst = data.isel(state=int(np.argmax(bad)), damping=0)
    slow = data["pinion_speed"].values[np.isnan(worst["series_parting_share"].values)]
    known = bad.any()
    yield Notice.of(
        "run_of_a_series",
        **_about(case, parts),
        damping=case.dampings[0],
        bad=float(bad.max()) if known else None,
        speed=float(worst["series_worst_speed"]) if known else None,
        pairs=int(worst["series_parting_parts"]) if known else None,
        moving=int(worst["series_parts"]) if known else None,
        slow=float(slow.max()) if slow.size else None,
    )


# --- at the points of a sweep ---------------------------------------------------------------------


def point_variables(dims: tuple[str, ...]) -> dict[str, Variable]:
    """How :func:`at_points` is stored over ``dims``."""
    return {
        f"series_{name}_{which}": real(
            dims, f"{words}: {100.0 * share:.0f} % of parts do not exceed it", unit
        )
        for name, (words, unit) in IN_COLUMNS.items()
        for which, share in QUANTILES.items()
    } | {
        "series_parting_share": real(dims, "share of parts that lose contact", "1"),
        "series_parts": real(dims, "parts whose motion is followed", "1"),
    }


def at_points(family: GearFamily, rows: Floats, parts: int, alive: Alive) -> Arrays:
    """:func:`point_variables` of every row of ``family``, SI, (row,); nan where nothing moves.

    Of the first ``parts`` parts of the gears, and the flanks, that the row has, at its load, speed
    and damping, as hot as its own motion is. ``series_parts`` is 0 where no motion is followed.
    """
    names = list(point_variables(()))
    table = np.full((len(names), len(rows)), np.nan)
    table[-1] = 0.0
    excited, heated = family.excitations(rows), family.quasi_static(rows, HEATED)
    every: dict[int, Series] = {}
    for place in np.flatnonzero(moves(excited.status)).tolist():
        alive()
        case, hot = (heated[name][place] for name in ("case", "hot_pair"))
        if id(case) not in every:
            every[id(case)] = Series.of(case, parts)
        here, mesh = excited.take(np.array([place])), every[id(case)].mesh(hot)
        motion = series_motion(mesh, here, hot.operating.speed, here.damping_ratio)
        point = SeriesPoint(mesh, motion, 0)
        factor, lost = motion.dynamic_factor[0, :, 0], motion.contact_loss_share[0, :, 0]
        columns = _quantiles(np.stack([point.errors[1], factor, lost])).T
        count = int(point.counts[0])
        parting = (lost > LOST).sum() / count if count else np.nan
        table[:, place] = [*columns.ravel(), parting, count]
    return dict(zip(names, table, strict=True))


def sweep_notice(case: GearCase, parts: int, names: Sequence[str]) -> Notice:
    """What columns of a series over the parameters ``names`` are, and what the others are of."""
    varied = {name.removeprefix("flanks."): None for name in names if name.startswith("flanks.")}
    return Notice.of("sweep_of_a_series", **_about(case, parts) | varied)
