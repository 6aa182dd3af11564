"""The thesis's experiment once more: on drive trains that its rig could have been.

Every sampled train is moved hot at the document's three speeds. What an accelerometer shows on each
bearing's cap and on the housing, integrated twice, is held at the mesh line against the printed
displacements; beside it the journals and the deflection of the teeth, which none shows.
"""

from __future__ import annotations

import csv
import io
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files

import numpy as np

from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Search
from thermogear.base.arrays import Floats
from thermogear.base.display import SPEED
from thermogear.base.errors import ThermogearError, ValidityWarning
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import gear_case, load_case
from thermogear.case.thermal_state import HOT
from thermogear.dynamics.ladder import Engine
from thermogear.measured.published import THESIS_5_2
from thermogear.shafts.reduction import interface_of
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.record import SAMPLES, lines
from thermogear.study.shafts.state import TrainState, settled
from thermogear.thesis.rig_trains import ASSUMED, DIGITS, SPEEDS, case_text, drawn

TABLE = "experiment.csv"
SAMPLES_STORED, SEED = 256, 22
HELD_MODES = 8
"""Modes of the reduced train beside its interface; with 24 displacements changed by 6 % at most in
the first eight stored trains."""
PERIODS, LONGER = 16, 64
"""Mesh periods of a record: of a proven orbit, of any other motion."""
SEARCH = Search(first=64, cap=2048, exponent=False, starts=1)
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
        return float(_factors(found[:, None])[0])


def _factors(amplitudes: Floats) -> Floats:
    """Largest ratio to the printed values, either way, of every channel: (speed, channel)."""
    with np.errstate(divide="ignore"):
        far = np.abs(np.log(amplitudes / np.asarray(PRINTED)[:, None]))
    return np.asarray(np.exp(far.max(axis=0)))


def shown(values: Mapping[str, float], *, held: int = HELD_MODES) -> Shown:
    """What the train of ``values`` shows; ``held``: modes beside its interface."""
    nothing = dict.fromkeys(SEEN, (float("nan"),) * len(SPEEDS))
    try:
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            case = gear_case(load_case(case_text(values)))
            ((state,),) = settled(case, [0], states=(HOT,))
            if state.status != STATUS.index("ok"):
                return _without(values, STATUS[state.status], nothing)
            wanted = len(interface_of(state.assembly)) - 1 + held
            train = moving(case, state, coordinates=wanted, friction=rubbing(case, state))
            trains = [train.at_speed(case, float(SPEED.stored(rpm))) for rpm in SPEEDS]
    except ThermogearError:
        return _without(values, "not_converged", nothing)
    labels, found = [], []
    for one in trains:
        motion = settle(one.model.return_map(), one.start, SEARCH)
        labels.append(motion.name)
        if motion.name == "diverged":
            return _without(values, "diverged", nothing)
        proven = 0 < motion.period <= PERIODS // 2 and motion.name.startswith("period")
        found.append(_amplitudes(one, motion.state, PERIODS if proven else LONGER))
    names = _channels(state)
    channels, amplitudes, most = {}, {}, {}
    for place in SEEN:
        table = np.stack([one[place] for one in found])
        best = int(np.argmin(_factors(table)))
        channels[place] = names[place][best]
        amplitudes[place] = tuple(_rounded(v) for v in table[:, best])
        most[place] = tuple(_rounded(v) for v in table.max(axis=1))
    return Shown(
        values=values, labels=tuple(labels), channels=channels, amplitudes=amplitudes, most=most
    )


def _without(
    values: Mapping[str, float], status: str, nothing: dict[str, tuple[float, ...]]
) -> Shown:
    labels = (status,) * len(SPEEDS)
    none = dict.fromkeys(SEEN, "")
    return Shown(values=values, labels=labels, channels=none, amplitudes=nothing, most=nothing)


def _rounded(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")


def _channels(state: TrainState) -> dict[str, list[str]]:
    both = [f"{place.bearing.name} {axis}" for place in state.assembly.bearings for axis in "xy"]
    return {"cap": both, "housing": ["x", "y"], "journal": both, "teeth": ["line of action"]}


def _amplitudes(train: MovingTrain, start: Floats, periods: int) -> dict[str, Floats]:
    """Amplitude [m] at the mesh line of every channel, by what is seen."""
    model, own = train.model, train.state.assembly
    run = Engine(model).run(start, periods, samples=SAMPLES)
    felt = model.forces(run.sample_phase, states=run.samples)["acceleration"]
    twice = (2.0 * np.pi * model.mesh_frequency) ** 2
    columns = {
        "cap": np.concatenate([one.ring for one in own.bearings], axis=1),
        "housing": np.stack([own.unit(f"casing.{axis}") for axis in "xy"], axis=1),
        "journal": np.concatenate([one.journal for one in own.bearings], axis=1),
    }
    found = {
        name: lines(felt @ train.reduction.vector(vectors), orders=[1.0])[0] / twice
        for name, vectors in columns.items()
    }
    teeth = run.samples[:, : model.size] @ model.drive - model.errors_at(run.sample_phase)[0]
    return {**found, "teeth": lines(teeth, orders=[1.0])[0].reshape(1)}


def trains(count: int = SAMPLES_STORED) -> Iterator[Shown]:
    """``count`` sampled trains, one after the other."""
    yield from map(shown, drawn(count, seed=SEED))


# --- the table that is stored -------------------------------------------------------------------


def stored() -> list[Shown]:
    """The sampled trains that come with the package; `make trial NAME=experiment` computes them."""
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
