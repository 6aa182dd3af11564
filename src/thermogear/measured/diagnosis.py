"""A record as diagnosis needs it: in the pinion's angle, averaged over turns of each shaft."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.measured.choosing import chosen_channels
from thermogear.measured.gate import Passed, passed, require_samples, require_sampling_rate
from thermogear.measured.impacts import HIGHEST
from thermogear.measured.order_angle import order_angle
from thermogear.measured.record import Notice, Record
from thermogear.measured.reduction import LONGEST, require_teeth
from thermogear.measured.shaft import locked, tracked_shaft, usable_shaft
from thermogear.measured.stated import expected_mesh, stated_gearing
from thermogear.measured.turns import mesh_turns
from thermogear.measured.units import kind_of
from thermogear.signals.indicators import crest_factor, normalised_moment
from thermogear.signals.integration import velocity_rms
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.synchronous import (
    comb_gain,
    repeating_turns,
    shared_step,
    synchronous_averages,
)
from thermogear.signals.tracking import samples_per_turn

PINION, WHEEL = SHAFTS = ("pinion", "wheel")
LEAST_TURNS = 8
"""Turns of the pinion in a record at least: fewer are no average (chosen)."""
BLOCKS = (4, 8)
"""Averages that a record is cut into, at least and at most: chosen. Fewer say little of the
scatter, more leave few turns in each."""
SLOW = 600.0 * RPM
"""Speed [rad/s] below which velocities count from 2 Hz on: ISO 20816-3."""
_ORDERS = np.arange(1.0, 11.0)  # of the mate, whose leakage is told


@dataclass(frozen=True, kw_only=True)
class InAngle:
    """A record with the pinion's angle: ``table`` (channel, sample) in the channel's unit,
    ``turns`` of the pinion at each sample, ``origin`` of the angle, ``marked``: a tacho marks its
    zero; ``mesh``: the order of the mesh line; ``noise`` of the angle [turns, rms];
    ``withheld`` why a channel is not to be trusted."""

    record: Record
    channels: tuple[str, ...]
    table: Floats = field(repr=False)
    turns: Floats = field(repr=False)
    origin: str
    marked: bool
    mesh: float
    noise: float
    notices: tuple[Notice, ...]
    withheld: dict[str, str]

    @property
    def length(self) -> int:
        """Whole turns of the pinion, from its first zero on."""
        return int(np.floor(self.turns[-1]) - np.ceil(self.turns[0]))

    @property
    def pace(self) -> float:
        """Mean turns per sample."""
        return float(self.turns[-1] - self.turns[0]) / (self.turns.size - 1)

    @cached_property
    def straightened(self) -> tuple[Floats, int]:
        """The table at even steps of the pinion's angle, whole turns, and its samples per turn."""
        per_turn = samples_per_turn(self.turns)
        return resample_by_angle(self.table, self.turns, samples_per_turn=per_turn), per_turn

    @property
    def speed(self) -> float:
        """Mean speed of the pinion [rad/s]; nan where the rate is not known."""
        return 2.0 * np.pi * self.pace * (self.record.rate or float("nan"))


def in_angle(
    record: Record,
    *,
    channels: Sequence[str | int] = (),
    teeth: int,
    speed: float | None = None,
    pulses_per_turn: float | None = None,
    tacho: Record | None = None,
) -> InAngle:
    """The record through the gate, with the angle of its pinion.

    ``teeth`` and ``speed`` [rad/s] of the pinion; the angle is that of a tacho (of the record or of
    another one, ``tacho``), of a speed channel, of a line followed, else of the mesh line that
    ``teeth`` and ``speed`` or its sidebands confirm. Raises InputError, which says what to give,
    where nothing tells the pinion's angle, and for fewer than 8 turns.
    """
    require_teeth(teeth)
    require_sampling_rate(record)
    require_samples(record)
    notices = list(record.notices)
    through = passed(chosen_channels(record, channels, notices), LONGEST)
    table = through.table
    shaft = usable_shaft(
        record, through, pulses_per_turn=pulses_per_turn, tacho=tacho, notices=notices
    )
    marked = shaft is not None and not shaft.by_speed
    if shaft is not None and shaft.by_speed:
        shaft = locked(shaft, table, teeth)
    if shaft is None and speed is None:
        shaft = tracked_shaft(table)
    if shaft is None:
        turns, first, noise = _by_mesh_line(record, through, teeth, speed, notices)
        origin, mesh = "the mesh line", float(teeth)
    else:
        notices += shaft.told
        angle = order_angle(
            shaft, table, teeth=teeth, speed=speed, rate=record.rate, notices=notices
        )
        if angle.of_mesh or (not shaft.sure and angle.teeth is None and speed is None):
            why = "the turns of the pinion are not told"
            field = "--speed" if shaft.line else "--pulses"
            raise InputError(field, "none", why=why, fix=f"give {field} and --teeth")
        turns, first, noise, origin = angle.turns, angle.first, angle.noise, shaft.origin
        mesh = float(teeth) if angle.mesh is None else angle.mesh
    table = table[:, first : first + turns.size]
    notices += through.findings
    angle_record = InAngle(
        record=record,
        channels=tuple(c.name for c in through.channels),
        table=table,
        turns=turns,
        origin=origin,
        marked=marked,
        mesh=mesh,
        noise=noise,
        notices=tuple(dict.fromkeys(notices)),
        withheld=dict(through.withheld),
    )
    if angle_record.length < LEAST_TURNS:
        got = f"{angle_record.turns[-1] - angle_record.turns[0]:.3g} turns of the pinion"
        allowed = f">= {LEAST_TURNS} turns"
        raise InputError("record", got, allowed=allowed, fix="record for longer")
    return angle_record


def _by_mesh_line(
    record: Record, through: Passed, teeth: int, speed: float | None, notices: list[Notice]
) -> tuple[Floats, int, float]:
    """Turns of the pinion by the phase of its mesh line, from which sample on, and their noise."""
    gearing = stated_gearing(
        through.table,
        notices,
        expected=expected_mesh(record, teeth, speed),
        teeth=teeth,
        rate=record.rate,
        shaft=None if speed is None or record.rate is None else speed / (2.0 * np.pi * record.rate),
    )
    if gearing is None or gearing.teeth != teeth:
        need = "--speed" if record.rate is not None else "--rate and --speed"
        raise InputError(
            "--speed",
            "none" if speed is None else f"no mesh line of {teeth} teeth at it",
            why="nothing tells which line is the mesh line, and so the pinion's angle",
            fix=f"give {need} of the pinion, or --tacho with --pulses" if speed is None
            else "check --speed, --teeth and --rate, or give --tacho with --pulses",
        )  # fmt: skip
    line = mesh_turns(through.table, gearing, teeth=teeth, harmonics=3)
    noise = line.phase_noise / (2.0 * np.pi * teeth)
    if line.turning is not None:
        return line.turning.cycles / teeth, line.turning.dropped, noise
    return line.frequency * np.arange(through.table.shape[-1]) / teeth, 0, noise


@dataclass(frozen=True, kw_only=True)
class ShaftAverage:
    """Averages of one shaft: ``average`` (channel, sample) over ``turns`` turns, ``blocks``
    (channel, block, sample) over ``block_turns`` each; ``highest`` order that counts.

    ``step``: multiples of it are orders of the mate, too (None: its teeth are not known);
    ``leakage``: the largest share of a line of the mate's first ten orders that the average and a
    block hold, () where these are not known; ``held``: whole turns in the record.
    """

    name: str
    teeth: int
    held: int
    turns: int
    block_turns: int
    average: Floats = field(repr=False)
    blocks: Floats = field(repr=False)
    highest: int
    step: int | None
    leakage: tuple[float, ...]


def block_lengths(turns: int, *, period: int) -> tuple[int, int]:
    """Turns of the longest average and of each block of a record of ``turns`` turns.

    Multiples of ``period`` where the record holds one, of blocks where it holds four; else all
    turns, and a fourth of them. At most eight blocks.

    >>> block_lengths(500, period=48), block_lengths(60, period=48), block_lengths(40, period=48)
    ((480, 96), (48, 15), (40, 10))
    """
    least, most = BLOCKS
    periods = turns // period
    longest = periods * period or turns
    if periods >= least:
        return longest, -(-periods // most) * period
    return longest, max(1, turns // least)


def shaft_average(
    record: InAngle, name: str, *, teeth: tuple[int, int | None], turns: int | None = None
) -> ShaftAverage:
    """The averages of the shaft ``name``; ``teeth`` of pinion and wheel (None: not known).

    ``turns``: of the shaft in the record that sets how long a block is, here itself.
    Raises InputError where this record holds no such block.
    """
    straight, per_turn = record.straightened
    shaft_teeth, mate, ratio = teeth[0], teeth[1], 1.0
    if name == WHEEL and mate is not None:
        shaft_teeth, mate, ratio = mate, shaft_teeth, shaft_teeth / mate
        turned = record.turns * ratio
        per_turn = samples_per_turn(turned)
        straight = resample_by_angle(record.table, turned, samples_per_turn=per_turn)
    held = straight.shape[-1] // per_turn
    period = 1 if mate is None else repeating_turns(mesh_order=shaft_teeth, mate_order=mate)
    longest, _ = block_lengths(held, period=period)
    _, block = block_lengths(turns or held, period=period)
    fastest = float(np.percentile(np.diff(record.turns), 99.0)) * ratio
    leakage: list[float] = []
    if mate is not None:
        places = _ORDERS * shaft_teeth / mate
        alone = places[np.abs(places - np.rint(places)) > 1e-9]
        gains = (comb_gain(alone, turns=count) for count in (longest, block))
        leakage = [float(np.max(gain, initial=0.0)) for gain in gains]
    blocks = synchronous_averages(straight, samples_per_turn=per_turn, turns=block)
    return ShaftAverage(
        name=name,
        teeth=shaft_teeth,
        held=held,
        turns=longest,
        block_turns=block,
        average=synchronous_averages(straight, samples_per_turn=per_turn, turns=longest)[:, 0],
        blocks=blocks[:, : BLOCKS[1]],
        highest=min(int(HIGHEST / fastest), per_turn // 2 - 1),
        step=None if mate is None else shared_step(mesh_order=shaft_teeth, mate_order=mate),
        leakage=tuple(leakage),
    )


def raw_values(record: InAngle) -> dict[str, Floats]:
    """Rms, kurtosis, crest factor and velocity rms [m/s] from 10 to 1000 Hz, by channel.

    From 2 Hz below 600 rpm, as ISO 20816-3 has it. The velocity is nan where rate or unit are not
    known, or the rate is below 2.56 times 1000 Hz.
    """
    low, high = (2.0 if record.speed < SLOW else 10.0), 1000.0
    rate = record.record.rate
    speeds = []
    for name, values in zip(record.channels, record.table, strict=True):
        channel = record.record.channel(name)
        known = channel.unit is not None and not channel.needs_scale and rate is not None
        power = {"acceleration": 1, "velocity": 0, "displacement": -1}.get(
            kind_of(channel.unit) if channel.unit else ""
        )
        if not known or rate is None or power is None or rate < 2.56 * high:
            speeds.append(float("nan"))
            continue
        si = values * channel.si_factor
        speeds.append(velocity_rms(si, rate=rate, low=low, high=high, integrations=power))
    centred = record.table - record.table.mean(axis=-1, keepdims=True)
    return {
        "raw_rms": centred.std(axis=-1),
        "raw_kurtosis": normalised_moment(record.table, power=4),
        "raw_crest": crest_factor(centred),
        "velocity_rms": np.array(speeds),
    }
