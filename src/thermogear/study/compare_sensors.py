"""``compare`` for drive trains: accelerometers of a record against a train in motion."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.units import RPM, STANDARD_GRAVITY
from thermogear.case.base import Case
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import ThermalState
from thermogear.measured.comparison import Comparison, Implied
from thermogear.measured.lines import MeasuredLine
from thermogear.measured.reduction import Measurement
from thermogear.measured.verdicts import Row, verdict
from thermogear.results.result import Notice
from thermogear.shafts.reduction import interface_of
from thermogear.study.case_runs import CaseRuns
from thermogear.study.shafts.motion import moved
from thermogear.study.shafts.moving import HELD_MODES
from thermogear.study.shafts.record import SAMPLES, lines
from thermogear.study.shafts.sensed import Accelerometer, accelerometer, sensed
from thermogear.study.shafts.state import STATES, plan_of, settled

NEAR = 0.05
"""How far the record's speed may be off an operating point of the case, relative."""
AGREES = 2.0
"""Errors within so many u_val are told as agreement."""
ORDERS = (1, 2, 3)
"""Harmonics of the mesh line that are compared, where the record has them."""


@dataclass(frozen=True, kw_only=True)
class _Line:
    """A measured line with the sensor it belongs to: a row of the comparison."""

    sensor: Accelerometer
    order: int
    found: MeasuredLine


def compare_sensors(
    case: Case | str | Path,
    measured: Measurement,
    at: Sequence[str],
    *,
    u_data: float | None = None,
    u_num: float | None = None,
    tolerances: Mapping[str, float] | None = None,
    samples: int = 12,
    seed: int = 0,
) -> Comparison:
    """Mesh lines of accelerometers against those of the case's drive train at the same place.

    ``at`` says where each channel sits (:func:`~thermogear.study.shafts.sensed.accelerometer`). The
    train moves at the record's own speed, cold and hot, with the torque of the operating point next
    to it. Uncertainties are relative and standard, per line: ``u_data`` of the measurement (left
    out: as the record tells), ``u_num`` (left out: by twice as many modes), ``tolerances`` of
    fields of the case, sampled ``samples`` times from ``seed``.

    Raises InputError for a case without shafts, a place, direction or channel that is none, a place
    that cannot move, and a speed that the case does not have.
    """
    runs = CaseRuns.of(case)
    base, drawings = runs.case({}), runs.drawings()
    series = base.series > 1
    if series:  # modes and tolerances are tried on one part
        runs = replace(runs, kept={**runs.kept, **drawings[0]})
        base = runs.case({})
    bearings = plan_of(base).bearing_names
    rows = _rows(
        measured,
        [accelerometer(text, bearings=bearings, channels=measured.channels) for text in at],
    )
    speed = _speed(measured, base)
    place = _place(base, speed)
    own = tuple(dict.fromkeys(row.sensor for row in rows))
    sensors = own + tuple(_turned(one) for one in own)
    found, notices = _simulated(base, place, speed, sensors)
    last = list(found)[-1]
    alone = _picked(found[last], rows, sensors)
    parts = [
        _simulated(runs.case(each), place, speed, sensors, only=None if series else last)[0]
        for each in drawings
    ]
    if series:
        found = {
            state: np.median([part[state] for part in parts if state in part], axis=0)
            for state in found
        }
    real = np.array([row.found.acceleration for row in rows])
    told = {state.words: _picked(table, rows, sensors) for state, table in found.items()}
    numeric = np.full(real.size, u_num or 0.0)
    if u_num is None:
        finer, _ = _simulated(base, place, speed, sensors, held=2 * HELD_MODES, only=last)
        numeric = np.abs(_picked(finer[last], rows, sensors) - alone) / real
        notices.append(Notice.of("u_num_of_modes", modes=HELD_MODES, more=2 * HELD_MODES))

    def changed(tables: Iterable[Mapping[ThermalState, Floats]], middle: Floats) -> Floats:
        """Changes of every line, (run, line), relative to what is measured."""
        moved = [_picked(table[last], rows, sensors) - middle for table in tables if last in table]
        return np.asarray(np.reshape(moved, (-1, real.size)) / real)

    within = (
        _simulated(runs.case(each), place, speed, sensors, only=last)[0]
        for each in runs.sampled(tolerances or {}, count=samples, seed=seed)
    )
    sampled = changed(within, alone)
    spread = np.std(sampled, axis=0, ddof=1) if len(sampled) else 0.0
    drawn = np.abs(changed(parts, told[last.words])).max(axis=0, initial=0.0)
    entered = np.hypot(spread, drawn)
    notices += runs.told(tolerances or {}, len(drawings))
    names = tuple(told)
    made = [
        _row(
            row,
            speed,
            {name: float(values[number]) for name, values in told.items()},
            u_num=float(numeric[number]),
            u_input=float(entered[number]),
            u_data=u_data,
        )
        for number, row in enumerate(rows)
    ]
    counts = [
        f"{name} {sum(abs(one.errors[k]) <= AGREES * one.u_val for one in made)}"
        for k, name in enumerate(names)
    ]
    notices += _exchanged(made, rows, found[last], sensors)
    return Comparison(
        measured.record.source,
        names,
        tuple(made),
        (_implied(measured, rows, base, place, speed),),
        (*_seen(own), *measured.findings, *notices),
        f"within {AGREES:g} u_val: {', '.join(counts)} of {len(made)}",
    )


def _row(
    line: _Line,
    speed: float,
    simulated: Mapping[str, float],
    *,
    u_num: float,
    u_input: float,
    u_data: float | None,
) -> Row:
    """One line beside those ``simulated`` [m/s^2], by thermal state, with its verdict."""
    row = Row(
        speed=speed,
        quantity="acceleration",
        where=f"{line.sensor.channel}: {line.sensor.words}; mesh x {line.order}",
        measured=line.found.acceleration,
        simulated=tuple(simulated.values()),
        u_num=u_num,
        u_input=u_input,
        u_data=line.found.uncertainty if u_data is None else u_data,
        computed=True,
    )
    return replace(row, verdict=_verdict(row, tuple(simulated)))


def _rows(measured: Measurement, sensors: Sequence[Accelerometer]) -> list[_Line]:
    """Every mesh line of every sensor's channel."""
    names = [one.channel for one in sensors]
    for name in names:
        if names.count(name) > 1:
            raise InputError(
                "--at",
                f"channel {name!r} twice",
                allowed="one place a channel",
                fix="leave one out",
            )
    found = []
    for sensor in sensors:
        mine = [one for one in measured.lines if one.channel == sensor.channel]
        own = {f"mesh x {order}": order for order in ORDERS}
        lines = [one for one in mine if one.name in own]
        if not lines:
            raise InputError(
                "measured", measured.record.source, why="no mesh line was found", fix="--speed"
            )
        withheld = next((one.withheld for one in lines if one.withheld), "")
        if withheld:
            raise InputError(
                f"channel {sensor.channel!r}",
                measured.record.source,
                why=f"its lines are withheld: {withheld}",
                fix="leave its place out, or read another piece of the record",
            )
        if not all(np.isfinite(one.acceleration) for one in lines):
            unit = measured.record.channel(sensor.channel).unit or "no unit"
            raise InputError(
                f"channel {sensor.channel!r}",
                unit,
                allowed="an acceleration",
                fix="give it, for example --unit g or --unit m/s^2",
            )
        found += [_Line(sensor=sensor, order=own[one.name], found=one) for one in lines]
    return found


def _speed(measured: Measurement, case: GearCase) -> float:
    """Speed of the pinion [rad/s] by the record's mesh line and the case's teeth."""
    if measured.record.rate is None or measured.gearing is None:
        missing = "--rate" if measured.record.rate is None else "--speed"
        raise InputError("measured", "no speed", why="the record does not tell it", fix=missing)
    turns = measured.gearing.mesh_frequency * measured.record.rate / case.pair.pinion.teeth
    return float(2.0 * np.pi * turns)


def _place(case: GearCase, speed: float) -> int:
    known = case.stated.speed
    near = int(np.argmin(np.abs(known - speed)))
    if abs(float(known[near]) - speed) > NEAR * speed:
        told = ", ".join(f"{one / RPM:.6g}" for one in dict.fromkeys(known.tolist()))
        raise InputError(
            "operating.speed",
            f"{told} rpm",
            why=f"the record's mesh line makes {speed / RPM:.6g} rpm",
            fix="add that speed to the case, or say --speed, --rate and --teeth of the record",
        )
    return near


def _simulated(
    case: GearCase,
    place: int,
    speed: float,
    sensors: Sequence[Accelerometer],
    *,
    held: int = HELD_MODES,
    only: ThermalState | None = None,
) -> tuple[dict[ThermalState, Floats], list[Notice]]:
    """Line amplitudes (order, sensor) [m/s^2] of every state that moves, and what is to be told."""
    found: dict[ThermalState, Floats] = {}
    notices = []
    states = STATES if only is None else (only,)
    for state, (there,) in zip(states, settled(case, [place], states=states), strict=True):
        vectors = np.stack([one.vector(there.assembly) for one in sensors], axis=-1)
        wanted = len(interface_of(there.assembly)) - 1 + held
        one = moved(case, replace(there, speed=speed), coordinates=wanted)
        if one.train is None or one.record is None or one.motion is None:
            notices.append(Notice.of("train_without_motion", about=state.words))
            continue
        notices.append(
            Notice.of(
                "train_moves", about=state.words, label=one.motion.name, reason=one.motion.reason
            )
        )
        periods = one.record.phase.size // SAMPLES
        turn = float(one.record.phase[0])
        felt = sensed(one.train, one.motion.state, vectors=vectors, periods=periods, turn=turn)
        found[state] = lines(felt, orders=np.array(ORDERS, dtype=float))
    if not found:
        raise InputError(
            "simulated",
            "no line",
            why="the drive train has no motion at this speed",
            fix="see why by `thermogear run`, or name a record of another speed",
        )
    return found, notices


def _picked(table: Floats, rows: Sequence[_Line], sensors: Sequence[Accelerometer]) -> Floats:
    """The amplitudes of ``rows`` out of a table (order, sensor)."""
    return np.array([table[ORDERS.index(one.order), sensors.index(one.sensor)] for one in rows])


def _turned(sensor: Accelerometer) -> Accelerometer:
    """The same accelerometer a quarter turn on."""
    turned = sensor.direction + 0.5 * np.pi
    return replace(sensor, direction=turned if turned < np.pi else turned - np.pi)


def _exchanged(
    made: Sequence[Row], rows: Sequence[_Line], table: Floats, sensors: Sequence[Accelerometer]
) -> Iterator[Notice]:
    """Channels that would agree along the other axis on their strongest line, and do not here."""
    for sensor in dict.fromkeys(row.sensor for row in rows):
        mine = [k for k, row in enumerate(rows) if row.sensor == sensor]
        k = max(mine, key=lambda k: rows[k].found.acceleration)
        other = replace(rows[k], sensor=_turned(sensor))
        error = float(_picked(table, [other], sensors)[0]) / made[k].measured - 1.0
        allowed = AGREES * made[k].u_val
        if abs(error) <= allowed < abs(made[k].errors[-1]):
            yield Notice.of(
                "axes_exchanged",
                channel=sensor.channel,
                along=sensor.words,
                instead=other.sensor.words,
            )


def _verdict(row: Row, names: Sequence[str]) -> str:
    """Which model is better, and which agree."""
    agree = [
        name
        for name, error in zip(names, row.errors, strict=True)
        if abs(error) <= AGREES * row.u_val
    ]
    said = f"{' and '.join(agree) or 'none'} within {AGREES:g} u_val"
    return said if len(names) < 2 else f"{verdict(row, names)}; {said}"


def _implied(
    measured: Measurement, rows: Sequence[_Line], case: GearCase, place: int, speed: float
) -> Implied:
    nominal = float(case.stated.speed[place])
    offset = case.pair.pinion.teeth * (speed - nominal) / (2.0 * np.pi)
    width = (measured.record.rate or 1.0) / measured.samples
    return Implied(
        speed=nominal,
        acceleration_g=max(one.found.acceleration for one in rows) / STANDARD_GRAVITY,
        shaft_speed=speed,
        offset_hertz=offset,
        offset_bins=offset / width,
    )


def _seen(sensors: Sequence[Accelerometer]) -> Iterator[Notice]:
    """What the accelerometers see, where it is easily taken for something else."""
    kinds = {one.kind for one in sensors}
    if "bearing" in kinds:
        yield Notice.of("cap_moves_with_seat")
    if kinds & {"journal", "gear"}:
        yield Notice.of("shaft_centre_not_seen")
