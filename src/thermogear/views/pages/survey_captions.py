"""What the pictures of the gear surveys show, in words: taken from what is drawn."""

from __future__ import annotations

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import SPEED, exactly, span
from thermogear.base.vocabulary import is_known


def several(count: int, noun: str) -> str:
    """ "1 point", "3 points"."""
    return f"{count} {noun}{'s' * (count != 1)}"


# --- friction -----------------------------------------------------------------------------


LAWS = (
    "Solid: local laws; dashed: one value for the mesh; dotted: outside the law's range. The band "
    "on top is the lubrication regime by the film parameter."
)


# --- temperature --------------------------------------------------------------------------


def running(data: Dataset) -> list[str]:
    """The axes of the map along which there is more than one value."""
    axes = {"pinion_speed": "speed", "pinion_torque": "torque"}
    return [words for name, words in axes.items() if data.sizes[name] > 1]


def held(data: Dataset) -> str:
    """The one value of the axis that does not run."""
    if data.sizes["pinion_speed"] > 1:
        return f"{exactly(float(data['pinion_torque'][0]))} N m"
    return f"{exactly(SPEED(float(data['pinion_speed'][0])))} rpm"


def thermal_map(data: Dataset, safe: float) -> str:
    """Of the map of everything hot, or of its line over one axis."""
    settled = is_known(data["status"].values)
    beyond = settled & (data["within_oil_range"].values == 0)
    words = []
    if len(running(data)) == 1:
        words.append(f"At {held(data)}.")
        words += ["Gaps: no steady temperature."] * bool((~settled).any())
    else:
        words += ["Hatched: the oil is beyond its viscosity line."] * bool(beyond.any())
        words += ["White: no steady temperature."] * bool((~settled).any())
        words.append("Lines in the first map: least film parameter Λ.")
    if np.isfinite(data["scuffing_margin"].values[settled]).any():
        words.append(f"At least {safe:.0f} K of scuffing margin are advised.")
    return " ".join(words)


# --- tip relief ---------------------------------------------------------------------------


def relief_loads(data: Dataset) -> str:
    """Of the error over other loads than the design load."""
    load = data["load"].values
    without, with_it = data["peak_to_peak_error"].values
    worse = with_it > without
    if not worse.any():
        return "At every load drawn the relieved pair runs at least as evenly."
    if worse.all():
        return "At every load drawn the relieved pair runs less evenly."
    runs = np.split(np.arange(load.size), np.flatnonzero(np.diff(worse)) + 1)
    told = [f"{span(load[run], 3)} N m" for run in runs if worse[run[0]]]
    return f"Less even with relief than without at {' and at '.join(told)}; else more even."


# --- loaded contact -----------------------------------------------------------------------


CONTACT_PATH = (
    "Thin at the least load, broad at the greatest. Where the teeth give way the corner of a tip, "
    "or the edge of an undercut, touches: there (shaded) the Hertzian pressure is not valid and is "
    "left out."
)
