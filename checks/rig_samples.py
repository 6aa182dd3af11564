"""Drive trains that the thesis's rig could have been, drawn and moved: rows of the stored table.

Every sampled train is moved hot at the document's three speeds. What an accelerometer shows on each
bearing's cap and on the housing, integrated twice, is held at the mesh line against the printed
displacements; beside it the journals and the deflection of the teeth, which none shows.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping

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
from thermogear.shafts.bearings.catalogue import catalogue_bearing
from thermogear.shafts.reduction import interface_of
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.record import SAMPLES, lines
from thermogear.study.shafts.state import TrainState, settled
from thermogear.thesis.experiment import SAMPLES_STORED, SEED, SEEN, Shown, factors
from thermogear.thesis.rig_trains import ASSUMED, DIGITS, SPEEDS, Assumed

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
