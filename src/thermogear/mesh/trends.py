"""The thesis's first conclusion, checked: do friction, flash and growth rise with speed and torque?

"The friction coefficient, flash temperature, and tooth profile thermal deformation are strongly
correlated, increase with speed and torque, and are lower in mixed lubrication than dry" - taken
as rank correlations and as the share of neighbouring points between which a quantity rises.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from scipy.stats import spearmanr

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.vocabulary import label

QUANTITIES = {
    "friction": "mean_friction",
    "flash": "greatest_flash",
    "growth": "thermal_growth",
}
"""Short name -> variable of the map."""

STRONG = 0.8
"""A rank correlation from which on this program calls it strong; ours."""


FEWEST = 3
"""Fewer points have no rank correlation worth a name."""


def conclusion(grids: Mapping[str, Dataset]) -> Dataset:
    """Rank correlations and monotonicity of each quantity, for each lubrication of ``grids``.

    ``rank_correlation`` (lubrication, quantity, with_what): Spearman's, with the other quantities
    over all valid points, with speed and torque along each line of the grid, their mean (over
    all points at once the outline of the valid region would speak too); nan where a quantity
    does not vary;
    ``rising_share`` (lubrication, quantity, axis): share of neighbouring valid points along the
    axis between which the quantity rises; ``rises_at_torque``, ``rises_at_speed``: the same line
    by line. ``mixed_below_dry`` (quantity): share of points where mixed lies below dry;
    ``mixed_below_dry_along``: the same over every position of the path, for friction and flash.
    """
    names = list(grids)
    first = grids[names[0]]
    points = np.zeros(len(names), dtype=int)
    changes = np.zeros((len(names), len(QUANTITIES)), dtype=np.int8)
    speed, torque = first["pinion_speed"].values, first["pinion_torque"].values
    columns = {"speed": speed[:, None] + 0.0 * torque, "torque": torque + 0.0 * speed[:, None]}
    others = [*columns, *QUANTITIES]
    rank = np.full((len(names), len(QUANTITIES), len(others)), np.nan)
    rising = np.full((len(names), len(QUANTITIES), 2), np.nan)
    by_torque = np.full((len(names), len(QUANTITIES), torque.size), np.nan)
    by_speed = np.full((len(names), len(QUANTITIES), speed.size), np.nan)
    for i, grid in enumerate(grids.values()):
        valid = grid["within_oil_range"].values == 1
        values = {name: np.where(valid, grid[of].values, np.nan) for name, of in QUANTITIES.items()}
        points[i] = int(valid.sum())
        for j, mine in enumerate(values.values()):
            known = mine[np.isfinite(mine)]
            changes[i, j] = known.size > 0 and not _constant(known)
            rank[i, j, :2] = [
                _rank_along(mine, columns[name], axis) for axis, name in enumerate(columns)
            ]
            rank[i, j, 2:] = [_rank(mine, other) for other in values.values()]
            rising[i, j] = [_rises(mine, axis) for axis in (0, 1)]
            by_torque[i, j] = [_rises(mine[:, t], 0) for t in range(torque.size)]
            by_speed[i, j] = [_rises(mine[s], 0) for s in range(speed.size)]
    below, along = _below(grids)
    return label(
        {
            "rank_correlation": (
                ("lubrication", "quantity", "with_what"),
                rank,
                "1",
                "Spearman's rank correlation",
            ),
            "rising_share": (
                ("lubrication", "quantity", "axis"),
                rising,
                "1",
                "share of neighbouring points between which it rises",
            ),
            "rises_at_torque": (
                ("lubrication", "quantity", "pinion_torque"),
                by_torque,
                "1",
                "share of steps in speed with which it rises, at one torque",
            ),
            "rises_at_speed": (
                ("lubrication", "quantity", "pinion_speed"),
                by_speed,
                "1",
                "share of steps in torque with which it rises, at one speed",
            ),
            "valid_points": (("lubrication",), points, "1", "points that are compared"),
            "changes": (
                ("lubrication", "quantity"),
                changes,
                "1",
                "1 where the quantity varies at all",
            ),
            "mixed_below_dry": (
                ("quantity",),
                below,
                "1",
                "share of points where mixed lies below dry",
            ),
            "mixed_below_dry_along": (
                ("quantity",),
                along,
                "1",
                "the same over every position of the path",
            ),
        },
        {
            "lubrication": names,
            "quantity": list(QUANTITIES),
            "with_what": others,
            "axis": ["speed", "torque"],
            "pinion_speed": first["pinion_speed"],
            "pinion_torque": first["pinion_torque"],
        },
    )


def _rank(first: Floats, second: Floats) -> float:
    known = np.isfinite(first) & np.isfinite(second)
    a, b = first[known], second[known]
    if a.size < FEWEST or _constant(a) or _constant(b):
        return float("nan")
    return float(spearmanr(a, b).statistic)


def _rank_along(values: Floats, along: Floats, axis: int) -> float:
    """Mean over the lines along ``axis`` of the rank correlation with ``along``."""
    lines = zip(np.moveaxis(values, axis, -1), np.moveaxis(along, axis, -1), strict=True)
    found = np.array([_rank(one, other) for one, other in lines])
    known = np.isfinite(found)
    return float(found[known].mean()) if known.any() else float("nan")


def _constant(values: Floats) -> bool:
    return bool(np.ptp(values) <= 1e-9 * np.max(np.abs(values)))


def _rises(values: Floats, axis: int) -> float:
    """Share of steps along ``axis`` that rise; nan without two valid neighbours."""
    steps = np.diff(values, axis=axis)
    known = np.isfinite(steps)
    level = 1e-9 * float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0
    return float(np.mean(steps[known] > level)) if known.any() else float("nan")


def _below(grids: Mapping[str, Dataset]) -> tuple[Floats, Floats]:
    mixed, dry = grids["mixed"], grids["dry"]
    valid = (mixed["within_oil_range"].values == 1) & (dry["within_oil_range"].values == 1)

    def share(first: Floats, second: Floats) -> float:
        known = np.isfinite(first) & np.isfinite(second)
        known &= valid.reshape(*valid.shape, *([1] * (first.ndim - 2)))
        return float(np.mean((first < second)[known])) if known.any() else float("nan")

    below = [share(mixed[of].values, dry[of].values) for of in QUANTITIES.values()]
    pitch = np.abs(mixed["flash_along"].values) + np.abs(dry["flash_along"].values) > 1e-9
    # at the pitch point nothing flashes: there is nothing to compare; growth has no path
    every = [
        share(np.where(pitch, mixed[name].values, np.nan), dry[name].values)
        for name in ("friction_along", "flash_along")
    ]
    return np.array(below), np.array([*every, np.nan])


def verdicts(checked: Dataset) -> list[dict[str, str]]:
    """What holds of the conclusion and what does not, one row each.

    What the points leave nothing to compare for has no row: no neighbour along an axis, fewer
    than :data:`FEWEST` points for a correlation.
    """
    found = []
    names = {"friction": "friction coefficient", "flash": "flash temperature", "growth": "growth"}
    for lubrication in checked["lubrication"].values:
        for quantity in checked["quantity"].values:
            here = checked.sel(lubrication=lubrication, quantity=quantity)
            for axis in ("speed", "torque"):
                share = float(here["rising_share"].sel(axis=axis))
                if not np.isfinite(share):
                    continue
                rank = float(here["rank_correlation"].sel(with_what=axis))
                text = f"{100 * share:.0f} % of steps rise"
                if np.isfinite(rank):
                    text += f"; rank correlation {rank:+.2f}"
                found.append(
                    {
                        "claim": f"{names[str(quantity)]} rises with {axis}, {lubrication}",
                        "found": text if int(here["changes"]) else "it does not change",
                        "verdict": _verdict(share),
                    }
                )
        if int(checked["valid_points"].sel(lubrication=lubrication)) < FEWEST:
            continue
        for one, two in (("friction", "flash"), ("flash", "growth"), ("friction", "growth")):
            rank = float(
                checked["rank_correlation"].sel(
                    lubrication=lubrication, quantity=one, with_what=two
                )
            )
            found.append(
                {
                    "claim": f"{names[one]} and {names[two]} are strongly correlated, "
                    f"{lubrication}",
                    "found": f"rank correlation {rank:+.2f}"
                    if np.isfinite(rank)
                    else "one of them does not change",
                    "verdict": "holds" if rank >= STRONG else "does not hold",
                }
            )
    for quantity in checked["quantity"].values:
        share = float(checked["mixed_below_dry"].sel(quantity=quantity))
        along = float(checked["mixed_below_dry_along"].sel(quantity=quantity))
        if not np.isfinite(share):
            continue
        text = f"{100 * share:.1f} % of points"
        if np.isfinite(along):
            text += f", {100 * along:.1f} % of all positions of their paths"
        worst = min(share, along) if np.isfinite(along) else share
        found.append(
            {
                "claim": f"{names[str(quantity)]}: mixed below dry at every point",
                "found": text,
                "verdict": _verdict(worst),
            }
        )
    return found


def _verdict(share: float) -> str:
    if not np.isfinite(share):
        return "nothing to compare"
    if share == 1.0:
        return "holds"
    return "does not hold" if share == 0.0 else "holds in part"
