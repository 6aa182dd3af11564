"""Drive trains that the thesis's rig could have been, drawn and moved: rows of the stored table.

Every sampled train is moved hot at the document's three speeds. What an accelerometer shows on each
bearing's cap and on the housing, integrated twice, is held at the mesh line against the printed
displacements; beside it the journals and the deflection of the teeth, which none shows.

The document states the gears, an induction motor, a magnetic powder brake and accelerometers. All
else is ours: every range is as wide as rigs of this kind are, and says where it comes from.
"""

from __future__ import annotations

import csv
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Search
from thermogear.base.arrays import Floats
from thermogear.base.display import MILLIMETRE, SPEED
from thermogear.base.errors import ThermogearError, ValidityWarning
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import gear_case, load_case
from thermogear.case.thermal_state import HOT
from thermogear.dynamics.ladder import Engine
from thermogear.measured.published import THESIS_5_2
from thermogear.shafts.bearings.catalogue import catalogue_bearing
from thermogear.shafts.reduction import interface_of
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.record import SAMPLES, lines
from thermogear.study.shafts.state import TrainState, settled

SPEEDS = (1000.0, 2000.0, 3000.0)
"""Speeds of the pinion [rpm] in the document."""
DIGITS = 5
"""Significant digits of a sampled value, as stored: a stored row can be computed again."""


@dataclass(frozen=True, kw_only=True)
class Assumed:
    """One assumed quantity: its range in ``unit``, why, and where the range comes from.

    ``logarithmic``: all decades alike. ``choices``: names instead of numbers, low to high.
    """

    name: str
    words: str
    unit: str
    low: float
    high: float
    why: str
    logarithmic: bool = False
    choices: tuple[str, ...] = ()

    @property
    def span(self) -> str:
        """The range as a reader sees it."""
        if self.choices:
            return ", ".join(self.choices)
        return f"{self.low:g} to {self.high:g} {self.unit}".strip()


def _of(
    name: str,
    words: str,
    span: tuple[float, float],
    unit: str,
    why: str,
    logarithmic: bool = False,
) -> Assumed:
    return Assumed(
        name=name,
        words=words,
        unit=unit,
        low=span[0],
        high=span[1],
        why=why,
        logarithmic=logarithmic,
    )


AS_BEFORE = "as in the sensitivity study of the pair"
ASSUMED: tuple[Assumed, ...] = (
    _of("face_width", "face width", (15.0, 40.0), "mm", AS_BEFORE),
    _of("torque", "torque of the pinion", (50.0, 200.0), "N m",
        f"{AS_BEFORE}; 16 to 63 kW at 3000 rpm"),
    _of("backlash", "backlash, normal, total", (0.20, 0.40), "mm", AS_BEFORE),
    _of("damping", "damping ratio of the mesh", (0.03, 0.17), "", AS_BEFORE),
    _of("error", "transmission error, amplitude of the first order", (1.0, 20.0), "um",
        "twice the range of the pair's study: up to accuracy class 8"),
    _of("gears", "temperature of the gears", (100.0, 160.0), "degC", "the document's"),
    _of("shafts_below", "shafts and inner rings colder than the gears by", (0.0, 40.0), "K",
        AS_BEFORE),
    _of("housing_below", "housing and outer rings colder than the shafts by", (0.0, 20.0), "K",
        "5 to 10 K between the rings are usual, 15 to 20 K in fast bearings (makers)"),
    Assumed(name="pinion_bearing", words="bearings of the pinion's shaft", unit="", low=0.0,
            high=3.0, why="deep groove balls on 30 and 40 mm, for this power",
            choices=("6206", "6306", "6208", "6308")),
    Assumed(name="wheel_bearing", words="bearings of the wheel's shaft", unit="", low=0.0,
            high=1.0, why="three times the torque: 40 mm", choices=("6208", "6308")),
    _of("thickness", "shaft between the bearings over the bearing's bore", (1.1, 1.5), "",
        "a shoulder for the bearing, and no thicker than the gear's bore"),
    _of("span", "distance of a shaft's bearings", (100.0, 250.0), "mm",
        "face width, walls, and room for the wheel of 385 mm"),
    _of("place", "gear's place between its bearings, as a share", (0.35, 0.65), "",
        "near the middle; 0.5 is the middle"),
    _of("play", "play of the bearings as delivered", (6.0, 33.0), "um",
        "classes CN and C3 of 30 to 40 mm bore (ISO 5753-1)"),
    _of("bearing_damping", "damping of a bearing", (150.0, 1000.0), "N s/m",
        "150 to 350 measured of small ball bearings; 2 to 5 µs times their stiffness of larger",
        True),
    _of("seat_stiffness", "stiffness of a bearing's seat in the wall", (100.0, 500.0), "N/um",
        "recalled for housings; 100 a thin wall", True),
    _of("seat_mass", "mass that moves with the seat: ring, cap, wall", (0.5, 5.0), "kg",
        "ring and cap alone to a piece of the wall", True),
    _of("seat_loss", "damping of the seat over its stiffness", (1.0, 10.0), "µs",
        "0.3 to 3 % at 1 kHz: bolted steel and cast iron", True),
    _of("housing_mass", "mass of the housing", (30.0, 150.0), "kg",
        "40 kg in the ready-made case rig; a base plate may add to it", True),
    _of("mount_stiffness", "stiffness of the housing's feet", (5.0, 500.0), "N/um",
        "rubber to bolts on a bed", True),
    _of("mount_damping", "damping ratio of the housing on its feet", (0.01, 0.10), "",
        "bolted steel to rubber", True),
    _of("centre_line", "line of centres from the level", (0.0, 90.0), "deg",
        "wheel beside or above the pinion"),
    _of("motor_inertia", "inertia of the motor", (0.02, 0.15), "kg m^2",
        "four poles, 7.5 to 22 kW", True),
    _of("brake_inertia", "inertia of the powder brake", (0.05, 0.50), "kg m^2",
        "rotors of 200 to 1000 N m brakes, a guess", True),
    _of("coupling", "stiffness of the couplings", (500.0, 20000.0), "N m/rad",
        "5 (rubber tyre) to 150 (jaw) times the torque", True),
)  # fmt: skip

FIXED = (
    "Fixed: tooth numbers, module and pressure angle of the document; no profile shift; mineral "
    "oil 40 K colder than the gears; gears as solid discs; steel; an induction motor whose torque "
    "falls by 33 N m per rad/s behind 20 ms; couplings that lose 0.5 ms times their stiffness; a "
    "brake of constant torque; shafts balanced and gears centred: their errors give lines at shaft "
    "order beside the mesh line."
)


TABLE = Path(__file__).parent / "experiment.csv"
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
    """The sampled trains that were computed last; `make trial NAME=experiment` computes them."""
    with TABLE.open(encoding="utf-8", newline="") as file:
        return [_read(line) for line in csv.DictReader(file)]


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


# --- trains drawn and moved ------------------------------------------------------------------

HELD_MODES = 8
"""Modes of the reduced train beside its interface; with 24 displacements changed by 6 % at most in
the first eight stored trains."""
PERIODS, LONGER = 16, 64
"""Mesh periods of a record: of a proven orbit, of any other motion."""
SEARCH = Search(first=64, cap=2048, exponent=False, starts=1)
_TEXT = """\
title = "A drive train of the rig"
[gears]
module = "5 mm"
pressure_angle = "20 deg"
face_width = "{face_width!r} mm"
[gears.pinion]
teeth = 25
bore_radius = "{pinion_bore!r} mm"
[gears.wheel]
teeth = 75
bore_radius = "{wheel_bore!r} mm"
[oil]
name = "M100"
temperature_below_addendum = "40 K"
[operating]
speed = "2000 rpm"
torque = "{torque!r} N m"
[temperatures]
pinion_addendum = "{gears!r} degC"
wheel_addendum = "{gears!r} degC"
pinion_bore_below_addendum = "{shafts_below!r} K"
wheel_bore_below_addendum = "{shafts_below!r} K"
housing_below_addendum = "{box_below!r} K"
[backlash]
value = "{backlash!r} mm"
direction = "normal"
extent = "total"
[dynamics]
damping_ratio = {damping!r}
[transmission_error]
harmonics = [{{ order = 1, amplitude = "{error!r} um", phase = "0 deg" }}]
[model]
bundle = "consistent"
[grid]
mesh_positions = 64
harmonics = 12
[[shafts]]
gear = "pinion"
gear_position = "{pinion_gear!r} mm"
sections = [{pinion_sections}]
[[shafts]]
gear = "wheel"
gear_position = "{wheel_gear!r} mm"
sections = [{wheel_sections}]
{bearings}
[motor]
inertia = "{motor_inertia!r} kg m^2"
coupling_stiffness = "{coupling!r} N m/rad"
coupling_damping = "{coupling_damping!r} N m s/rad"
slip_damping = "33 N m s/rad"
lag = "0.02 s"
[load]
inertia = "{brake_inertia!r} kg m^2"
coupling_stiffness = "{coupling!r} N m/rad"
coupling_damping = "{coupling_damping!r} N m s/rad"
[housing]
mass = "{housing_mass!r} kg"
mount_stiffness = "{mount_stiffness!r} N/um"
mount_damping = "{feet!r} N s/m"
[train]
centre_line = "{centre_line!r} deg"
elements = 6
"""
_BEARING = """\
[[bearings]]
shaft = "{shaft}"
name = "{name}"
position = "{position!r} mm"
type = "{kind}"
play = "{play!r} um"
damping = "{bearing_damping!r} N s/m"
seat_stiffness = "{seat_stiffness!r} N/um"
seat_mass = "{seat_mass!r} kg"
seat_damping = "{seat_damping!r} N s/m"
"""
_OVERHANG = 50.0
_WALL = 5.0
"""Shaft outside a bearing towards its coupling, and beyond the other bearing [mm]."""


def value(one: Assumed, share: float) -> float:
    """The value at a place 0..1 of the range; of choices the number of one."""
    if one.choices:
        return float(min(int(share * len(one.choices)), len(one.choices) - 1))
    found = (
        one.low * (one.high / one.low) ** share
        if one.logarithmic
        else one.low + (one.high - one.low) * share
    )
    return float(f"{found:.{DIGITS}g}")


def case_text(values: Mapping[str, float]) -> str:
    """The case file of one sampled train; ``values`` by the names of :data:`ASSUMED`."""
    told: dict[str, object] = dict(values)
    bearings = []
    for shaft in ("pinion", "wheel"):
        kind = _chosen(f"{shaft}_bearing", values)
        size = catalogue_bearing(kind)
        bore, half = MILLIMETRE(size.bore), 500.0 * size.width
        middle = bore * values["thickness"]
        ends = (_OVERHANG + half, _WALL + half)
        # the coupling is on the left of the pinion's shaft, on the right of the wheel's
        before, after = ends if shaft == "pinion" else ends[::-1]
        span, place = values["span"], values["place"]
        lengths = (before + half, span - 2.0 * half, after + half)
        pieces = zip(lengths, (bore, middle, bore), strict=True)
        told[f"{shaft}_sections"] = ", ".join(
            f'{{ length = "{length!r} mm", diameter = "{diameter!r} mm" }}'
            for length, diameter in pieces
        )
        told[f"{shaft}_gear"] = before + place * span
        told[f"{shaft}_bore"] = 0.5 * middle
        bearings += [
            _BEARING.format(
                shaft=shaft,
                name=f"{shaft} {side}",
                position=position,
                kind=kind,
                seat_damping=values["seat_loss"] * values["seat_stiffness"],
                **{n: values[n] for n in _OF_BEARINGS},
            )
            for side, position in (("left", before), ("right", before + span))
        ]
    told["bearings"] = "".join(bearings)
    told["box_below"] = values["shafts_below"] + values["housing_below"]
    told["coupling_damping"] = 5e-4 * values["coupling"]
    told["feet"] = (
        2.0
        * values["mount_damping"]
        * float(np.sqrt(values["housing_mass"] * values["mount_stiffness"] * 1e6))
    )
    return _TEXT.format(**told)


_OF_BEARINGS = ("play", "bearing_damping", "seat_stiffness", "seat_mass")


def _chosen(name: str, values: Mapping[str, float]) -> str:
    (one,) = (a for a in ASSUMED if a.name == name)
    return one.choices[int(values[name])]


def drawn(count: int, *, seed: int) -> list[dict[str, float]]:
    """``count`` sampled trains, a latin hypercube: every range in ``count`` strips, one in each."""
    rng = np.random.default_rng(seed)
    strips = np.stack([rng.permutation(count) for _ in ASSUMED], axis=1)
    shares = (strips + rng.random(strips.shape)) / count
    return [
        {one.name: value(one, float(share)) for one, share in zip(ASSUMED, row, strict=True)}
        for row in shares
    ]


def shown(values: Mapping[str, float], *, held: int = HELD_MODES) -> Shown:
    """What the train of ``values`` shows; ``held``: modes beside its interface."""
    nothing = dict.fromkeys(SEEN, (float("nan"),) * len(SPEEDS))
    try:
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            case = gear_case(load_case(case_text(values)))
            ((state,),) = settled(case, [0], states=(HOT,))
            if state.status != STATUS.index("ok"):
                return without(values, STATUS[state.status], nothing)
            wanted = len(interface_of(state.assembly)) - 1 + held
            train = moving(case, state, coordinates=wanted, friction=rubbing(case, state))
            trains = [train.at_speed(case, float(SPEED.stored(rpm))) for rpm in SPEEDS]
    except ThermogearError:
        return without(values, "not_converged", nothing)
    labels, found = [], []
    for one in trains:
        motion = settle(one.model.return_map(), one.start, SEARCH)
        labels.append(motion.name)
        if motion.name == "diverged":
            return without(values, "diverged", nothing)
        proven = 0 < motion.period <= PERIODS // 2 and motion.name.startswith("period")
        found.append(_amplitudes(one, motion.state, PERIODS if proven else LONGER))
    names = _channels(state)
    channels, amplitudes, most = {}, {}, {}
    for place in SEEN:
        table = np.stack([one[place] for one in found])
        best = int(np.argmin(factors(table)))
        channels[place] = names[place][best]
        amplitudes[place] = tuple(_rounded(v) for v in table[:, best])
        most[place] = tuple(_rounded(v) for v in table.max(axis=1))
    return Shown(
        values=values, labels=tuple(labels), channels=channels, amplitudes=amplitudes, most=most
    )


def without(
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
