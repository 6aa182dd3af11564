"""What a drive train loses contact at, in words: from the stored flags alone."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.display import PERCENT, exactly, stretches
from thermogear.base.vocabulary import ASSUMED
from thermogear.views.plots.lost_contact import has_lost, lost_of, things
from thermogear.views.plots.parameters import each_state, parameter_of, shown

if TYPE_CHECKING:
    import xarray as xr

FILLED = 0.75
"""A stretch of the map is called by its ends alone where so much of it is meant."""


def lost_words(data: xr.Dataset) -> str:
    """A sentence or several: what loses contact where; "" where nothing says."""
    if not has_lost(data):
        return ""
    told = []
    for state, here in each_state(data):
        if (lost_of(here) < 0).all():
            words = "of no point it is known what loses contact"
        else:
            parts = [f"{what} {where(here, flags)}" for what, flags in things(here).items()
                     if flags.any()]  # fmt: skip
            words = "; ".join(parts) if parts else "nothing loses contact"
        begun = f"{state}: {words}" if state else words
        told.append(f"{begun[0].upper()}{begun[1:]}.")
    if (data["status"].values == ASSUMED).any():
        told.append("Where the motion is assumed, so is this.")
    return " ".join(told)


def lost_rows(data: xr.Dataset) -> list[dict[str, Any]]:
    """The same as rows: state, what, points, of so many, where."""
    rows = []
    for state, here in each_state(data):
        for what, flags in things(here).items():
            if flags.any():
                known = here["status"].values != ASSUMED
                row = {
                    "what": what, "points": int((flags & known).sum()), "of": int(known.sum()),
                    "assumed": int((flags & ~known).sum()), "where": where(here, flags),
                }  # fmt: skip
                rows.append({"state": state, **row} if state else row)
    return rows


def where(data: xr.Dataset, flags: NDArray[np.bool_]) -> str:
    """Where on the axes of the result ``flags`` are set: ranges in the units shown."""
    axes = [str(n) for n in data["label"].dims if n not in ("direction", "start")]
    rest = tuple(i for i, n in enumerate(data["label"].dims) if str(n) not in axes)
    here = np.asarray(flags.any(axis=rest))
    if here.all():
        return "everywhere"
    units = [parameter_of(name, data[name]).shown for name in axes]
    alike = len(set(units)) < len(units)
    if here.ndim == 1:
        values = shown(axes[0], data[axes[0]])
        return _named(
            axes[0], units[0], f"at {stretches(values, here)} {units[0]}".rstrip(), alike=False
        )
    inside = [np.flatnonzero(here.any(axis=1 - axis)) for axis in (0, 1)]
    box = here[inside[0][0] : inside[0][-1] + 1, inside[1][0] : inside[1][-1] + 1]
    words = [
        _named(name, unit, _range(shown(name, data[name]), on, unit), alike=alike)
        for name, unit, on in zip(axes, units, inside, strict=True)
    ]
    found = ", ".join(one for one in words if one)
    share = PERCENT(float(here.mean()))
    if box.mean() >= FILLED and found:
        return found
    return f"at {exactly(share, 2)} % of the points{f', {found}' * bool(found)}"


def _named(name: str, unit: str, words: str, *, alike: bool) -> str:
    """A range behind the parameter's name where its unit does not tell which one it is."""
    if not words or (unit and not alike):
        return words
    return f"{parameter_of(name).words} {words}"


def _range(values: NDArray[np.float64], on: NDArray[np.int64], unit: str) -> str:
    """From the first to the last of some places of an axis; nothing where these are its ends."""
    order = np.argsort(values)
    places = np.flatnonzero(np.isin(order, on))
    low, high = (exactly(float(values[order[places[end]]])) for end in (0, -1))
    whole = f" {unit}".rstrip()
    first = " (first computed)" * bool(places[0] == 0)
    last = " (last computed)" * bool(places[-1] == values.size - 1)
    apart = f"from {low}{first} to {high}{whole}{last}"
    words = f"at {low}{whole}{first}{last}" if low == high else apart
    return "" if first and last else words
