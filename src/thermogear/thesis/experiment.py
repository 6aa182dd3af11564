"""The thesis's experiment once more: on drive trains that its rig could have been.

Every sampled train is moved hot at the document's three speeds. What an accelerometer shows on each
bearing's cap and on the housing, integrated twice, is held at the mesh line against the printed
displacements; beside it the journals and the deflection of the teeth, which none shows.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.measured.published import THESIS_5_2
from thermogear.thesis.rig_trains import ASSUMED, SPEEDS

TABLE = "experiment.csv"
SAMPLES_STORED, SEED = 256, 22
PRINTED = tuple(line.displacement for line in THESIS_5_2.measured.lines)
"""Measured displacements [m] as printed, by speed."""
SEEN = ("cap", "housing", "journal", "teeth")
"""What is looked at: bearing caps and the housing by an accelerometer, the others by none."""
WORDS = {
    "cap": "accelerometer on a cap",
    "housing": "accelerometer on the housing",
    "journal": "journal in its bearing",
    "teeth": "deflection of the teeth",
}


@dataclass(frozen=True, kw_only=True)
class Shown:
    """One sampled train: its ``values``, and what it shows.

    ``labels`` of its motions by speed, or the status instead of a motion. For each of
    :data:`SEEN`: the ``channel`` (place and axis) that comes nearest to the printed displacements
    at all three speeds, and its ``amplitudes`` [m]; the ``most`` any channel shows at each speed.
    Without a motion they are nan.
    """

    values: Mapping[str, float]
    labels: tuple[str, ...]
    channels: Mapping[str, str]
    amplitudes: Mapping[str, tuple[float, ...]]
    most: Mapping[str, tuple[float, ...]]

    @property
    def moves(self) -> bool:
        """Whether there is a motion at every speed."""
        return bool(np.all(np.isfinite(self.amplitudes["teeth"])))

    def factor(self, seen: str) -> float:
        """The largest ratio, either way, of the best channel to the printed values; inf: none."""
        found = np.asarray(self.amplitudes[seen])
        if not np.all(np.isfinite(found)):
            return float("inf")
        return float(factors(found[:, None])[0])


def factors(amplitudes: Floats) -> Floats:
    """Largest ratio to the printed values, either way, of every channel: (speed, channel)."""
    with np.errstate(divide="ignore"):
        far = np.abs(np.log(amplitudes / np.asarray(PRINTED)[:, None]))
    return np.asarray(np.exp(far.max(axis=0)))


# --- the table that is stored -------------------------------------------------------------------


def stored() -> list[Shown]:
    """The sampled trains that come with the package; `make trial-experiment` computes them."""
    text = (files("thermogear.thesis") / TABLE).read_text(encoding="utf-8")
    return [_read(line) for line in csv.DictReader(io.StringIO(text))]


def _read(line: Mapping[str, str]) -> Shown:
    def three(name: str) -> tuple[float, ...]:
        return tuple(1e-6 * float(line[f"{name}_{rpm:.0f}"]) for rpm in SPEEDS)

    return Shown(
        values={one.name: float(line[one.name]) for one in ASSUMED},
        labels=tuple(line[f"label_{rpm:.0f}"] for rpm in SPEEDS),
        channels={place: line[f"{place}_channel"] for place in SEEN},
        amplitudes={place: three(place) for place in SEEN},
        most={place: three(f"{place}_most") for place in SEEN},
    )
