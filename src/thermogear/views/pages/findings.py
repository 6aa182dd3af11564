"""What a diagram, map, basin, sweep or run-up found, in one sentence, from its figures alone."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, exactly, number, stretches
from thermogear.base.vocabulary import ASSUMED
from thermogear.views.plots.lost_contact import has_lost, lost_of, things
from thermogear.views.plots.parameters import each_state, parameter_of, shown
from thermogear.views.plots.sweeps import CLASSES, class_words, classes_of

UNDECIDED, PERIODIC = 9, 7
"""Places of the classes: undecided, and the last of the periodic ones."""
APART = 1e-3
"""Two orbits of one kind differ by more than this part of the greatest value."""
SAME = "Up and down end on the same motion at every value"


def finding(data: Dataset) -> str:
    """One sentence; it says so where nothing was found."""
    kind = str(data.attrs["kind"])
    if kind in ("diagram", "run-up"):
        words = _two_ways(data)
    elif kind == "basins":
        words = _basins(data)
    else:
        words = _counts(data)
        if kind == "sweep":
            words += _greatest(data, "dynamic_factor", "the greatest dynamic factor is")
            if "series_dynamic_factor_bad" in data:
                words += _greatest(
                    data, "series_dynamic_factor_bad", "one pair in ten of the series exceeds up to"
                )
    return f"{words}{_undecided(data)}."


def _two_ways(data: Dataset) -> str:
    """Where the motions up and down differ in kind, and where they jump."""
    name, codes = _codes(data)
    if (codes > UNDECIDED).all():
        words = [CLASSES[code][0] for code in np.unique(codes)]
        return f"No value has a motion: {', '.join(words)}"
    known = (codes != UNDECIDED).all(axis=0)
    apart = ways_apart(data)
    values = shown(name, data[name])
    unit = _unit(data, name)
    parts = []
    if apart.any():
        parts.append(f"Up and down end on different motions at {stretches(values, apart)}{unit}")
    else:
        parts.append(SAME + (" decided both ways" if not known.all() else ""))
    if "jump_direction" in data:
        turns = data["jump_direction"].values
        up, down = int((turns > 0).sum()), int((turns < 0).sum())
        parts.append(f"{up} jumps up and {down} down" if up + down else "nothing jumps")
    return "; ".join(parts)


def _codes(data: Dataset) -> tuple[str, NDArray[np.int64]]:
    """The parameter, and the kinds of motion with both ways first."""
    name = str(data.attrs.get("parameter", "pinion_speed"))
    return name, np.moveaxis(classes_of(data), data["label"].dims.index("direction"), 0)


def ways_apart(data: Dataset) -> NDArray[np.bool_]:
    """Where, along the parameter, up and down end on different motions: between is a jump."""
    name, codes = _codes(data)
    rest = [str(n) for n in data["label"].dims if n != "direction"]
    other = tuple(i for i, n in enumerate(rest) if n != name)
    known = (codes != UNDECIDED).all(axis=0)
    apart = ((codes[0] != codes[1]) | _swings_apart(data, codes)) & known
    return np.asarray(apart.any(axis=other))


def _swings_apart(data: Dataset, codes: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Where both ways end on one kind of orbit, and yet on two orbits.

    By the peak-to-peak error where it is stored, else by the place at phase 0 of period 1.
    """
    name = "dte_peak_to_peak" if "dte_peak_to_peak" in data else "point_x"
    if name not in data:
        return np.zeros(codes.shape[1:], np.bool_)
    values = np.moveaxis(data[name].values, data["label"].dims.index("direction"), 0)
    periodic = codes <= (PERIODIC if name == "dte_peak_to_peak" else 0)
    both = periodic.all(axis=0) & (codes[0] == codes[1]) & np.isfinite(values).all(axis=0)
    size = float(np.nanmax(np.abs(values), initial=0.0))
    return np.asarray(both & (np.abs(values[0] - values[1]) > APART * size))


def _basins(data: Dataset) -> str:
    count = data.sizes["attractor_number"]
    if not count:
        return "No attractor was found"
    shares = [
        f"{f'period {int(p)}' if p else 'chaotic, estimate'}, "
        f"{number(PERCENT(float(f)))} % of the starts"
        for p, f in zip(data["attractor_period"].values, data["fraction"].values, strict=True)
    ]
    if count == 1:
        return f"One attractor was found: {shares[0]}"
    return f"{count} attractors exist side by side: {'; '.join(shares)}"


def _counts(data: Dataset) -> str:
    codes, assumed = classes_of(data), data["status"].values == ASSUMED
    names = class_words(data)

    def words(some: NDArray[np.int64]) -> str:
        found = Counter(int(n) for n in some if n != UNDECIDED)
        return ", ".join(f"{names[n]} at {c}" for n, c in found.most_common())

    told = words(codes[~assumed])
    if not told:
        return "No point is decided"
    if not assumed.any():
        return f"Of {codes.size} points: {told}"
    return (
        f"Of {codes.size} points {int((~assumed).sum())} were computed: {told}; equal neighbours "
        f"speak for the others, which are assumed and not computed: {words(codes[assumed])}"
    )


def _greatest(data: Dataset, name: str, words: str) -> str:
    values = data[name].values
    if not np.isfinite(values).any():
        return "; no point has a dynamic factor"
    place = np.unravel_index(int(np.nanargmax(values)), values.shape)
    at = [
        f"{exactly(float(shown(str(n), data[n][i])))}{_unit(data, str(n))}"
        for n, i in zip(data[name].dims, place, strict=True)
    ]
    return f"; {words} {number(float(values[place]))}, at {', '.join(at)}"


def _undecided(data: Dataset) -> str:
    if "label" not in data:
        return ""
    codes = classes_of(data)
    count = int((codes == UNDECIDED).sum())
    return f"; {count} of {codes.size} points are undecided" if count else ""


def _unit(data: Dataset, name: str) -> str:
    return f" {parameter_of(name, data[name]).shown}".rstrip()


# --- pictures -----------------------------------------------------------------------------------


FILLED = 0.75
"""A stretch of the map is called by its ends alone where so much of it is meant."""


def lost_words(data: Dataset) -> str:
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


def lost_rows(data: Dataset) -> list[dict[str, Any]]:
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


def where(data: Dataset, flags: NDArray[np.bool_]) -> str:
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
