"""``measure``: from a record to lines with amplitude, order, uncertainty and the settings used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import MOST_TEETH, PULSES, SPEED
from thermogear.base.errors import InputError, short
from thermogear.measured.chain import METHODS, Chain
from thermogear.measured.changing import (
    Changing,
    harmonics_told,
    order_lines,
    read_in_angle,
    require_orders,
)
from thermogear.measured.choosing import chosen_channels
from thermogear.measured.contradictions import of_speed
from thermogear.measured.gate import (
    Passed,
    passed,
    require_samples,
    require_sampling_rate,
)
from thermogear.measured.gearing import Gearing
from thermogear.measured.impacts import (
    BAND_SAMPLES,
    HEARD,
    BearingLine,
    BearingRates,
    Swelling,
    clearest_line,
    impacts,
)
from thermogear.measured.lines import (
    Doubts,
    MeasuredLine,
    Wanted,
    channel_lines,
    wanted_lines,
)
from thermogear.measured.over_speed import OrderSlices
from thermogear.measured.quantities import of_velocity
from thermogear.measured.rate_check import check_rate
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.stated import expected_mesh, speed_undecided, stated_gearing
from thermogear.measured.traps import unknown_unit
from thermogear.measured.turns import MeshTurns, few_turns, mesh_turns
from thermogear.signals.orders import resample_by_angle
from thermogear.signals.tracking import samples_per_turn
from thermogear.signals.windows import Window

LONGEST = 1 << 21
"""Samples per channel reduced at once; a longer record is cut there with a notice."""


FIRST = "first shaft"
_MOST = 64
"""Harmonics, sidebands and orders that may be asked for."""
_HIGHEST_ORDER = 10_000.0


@dataclass(frozen=True)
class Measurement:
    """A record reduced: lines, gearing with evidence, settings and notices.

    ``teeth``: those orders are counted with, given or found; ``given``: what the user said (teeth,
    speed [rad/s]), None where he said nothing.
    ``findings``: damage of the record and what was done about it; ``values`` (channel, sample):
    what the lines were read from, in the file's unit; ``swellings``: the clearest line of the
    envelope, () where noise may have it, and ``defects``: its lines at rates of bearings named.
    """

    record: Record
    channels: tuple[str, ...]
    samples: int
    chain: Chain
    gearing: Gearing | None
    teeth: int | None
    lines: tuple[MeasuredLine, ...]
    notices: tuple[Notice, ...]
    start: int
    findings: tuple[Notice, ...] = ()
    values: NDArray[np.float64] = field(default_factory=lambda: np.empty((0, 0)), repr=False)
    slices: OrderSlices | None = None
    given: tuple[int | None, float | None] = (None, None)
    swellings: tuple[Swelling, ...] = ()
    defects: tuple[BearingLine, ...] = ()

    @property
    def readings(self) -> tuple[MeasuredLine, ...]:
        """The lines that are told: those asked for, and those known to better than 100 %."""
        return tuple(line for line in self.lines if line.is_reading)

    @property
    def settings(self) -> dict[str, str]:
        """What must be told with every amplitude: rate, N, bin width, window, ENBW, filter."""
        rate, window = self.record.rate, Window(self.chain.window)
        unit = "cycles/sample" if rate is None else "Hz"
        band, taps = self.chain.band, self.chain.taps
        origin = ", ".join(t for t in (self.record.rate_origin, self.record.rate_note) if t)
        return {
            "rate": "unknown" if rate is None else f"{rate:.9g} /s ({origin})",
            "samples": str(self.samples),
            "bin width": f"{(rate or 1.0) / self.samples:.6g} {unit}",
            "window": f"{window.name}, noise bandwidth {window.noise_bandwidth:.4g} bins, "
            f"of the displacement; amplitudes are fitted by least squares to all samples",
            "method": METHODS[self.chain.method],
            "band": "none" if band is None else f"{band[0]:.6g}..{band[1]:.6g} {unit}",
            "taps": "none" if taps is None else str(taps),
            "amplitudes": "peak",
        }


def measure(
    record: Record | str | Path,
    *,
    channels: Sequence[str | int] = (),
    teeth: int | None = None,
    speed: float | None = None,
    harmonics: int = 3,
    sidebands: int = 2,
    chain: Chain | None = None,
    sensor_tolerance: float | None = None,
    pulses_per_turn: float | None = None,
    tacho: Record | None = None,
    orders: Sequence[float] = (),
    bearings: Sequence[BearingRates] = (),
) -> Measurement:
    """Lines of a record: mesh harmonics, sidebands, further meshes, with their uncertainty.

    ``record`` a Record or a file (``read_record``); ``channels`` those to reduce (default: all
    that vibrate); ``teeth`` and ``speed`` [rad/s] of the first shaft where they are known: they
    are checked against what the lines say; ``sensor_tolerance`` the sensor's relative standard
    uncertainty; ``pulses_per_turn`` of the tacho channel, or of that of another record ``tacho``;
    ``orders`` of the first shaft to read beside; ``bearings`` on it, against whose rates those of
    the envelope are held. A tacho, or a channel of speed, is always used:
    lines are read in angle. Without one a speed that wanders is followed by the mesh line's phase,
    one that changes by a line tracked through the spectrum. Where the speed changes by more than
    3 % orders are read slice by slice over it (``slices``). Without a rate the lines are given in
    orders and cycles per sample, without a unit in the file's own numbers.

    Before any number the record passes the gate (:mod:`~thermogear.measured.gate`): damage is in
    ``findings``, and the uncertainty holds it or the number is withheld.

    Raises InputError for a record without a line, a channel without a signal, a rate so low that
    it may be a shaft's.
    """
    if not isinstance(record, Record):
        record = read_record(record)
    require_sampling_rate(record)
    require_samples(record)
    _require(harmonics, sidebands, orders, sensor_tolerance, pulses_per_turn)
    require_teeth(teeth)
    notices = list(record.notices)
    chosen = chosen_channels(record, channels, notices)
    through = passed(chosen, LONGEST)
    notices += _beyond(record)
    given = teeth, speed
    speed = _known_speed(record, speed, notices)
    expected = expected_mesh(record, teeth, speed)
    changing, said = read_in_angle(
        record,
        through,
        teeth=teeth,
        speed=speed,
        harmonics=harmonics,
        sidebands=sidebands,
        orders=orders,
        pulses_per_turn=pulses_per_turn,
        tacho=tacho,
        sensor_tolerance=sensor_tolerance,
    )
    notices += said
    turns: MeshTurns | None = None
    if changing is not None:
        gearing, teeth, turns = changing.gearing, changing.teeth, changing.turns
    else:
        gearing = stated_gearing(
            through.table,
            notices,
            expected=expected,
            teeth=teeth,
            rate=record.rate,
            shaft=_turns(record, speed),
        )
        teeth = teeth or (gearing.teeth if gearing else None)
    if changing is not None and changing.slices is not None:
        return _of_slices(record, through, chain, changing, notices, given)
    chosen, start, table = through.channels, through.start, through.table
    doubt, undecided = record.rate_doubt, None
    if gearing is not None and turns is None:
        turns = mesh_turns(table, gearing, teeth=teeth, harmonics=harmonics)
        # in a resampled record the lines stand at multiples of this mean and nowhere else
        gearing = gearing.at(turns.frequency)
        turns = replace(turns, half_width=turns.half_width + through.turned)
    if gearing is not None:
        few = few_turns(gearing, teeth=teeth, samples=table.shape[-1])
        notices += few
        sidebands = 0 if few else sidebands
        undecided = speed_undecided(gearing, given[0], speed=speed)
        doubt = check_rate(
            record,
            gearing,
            notices,
            teeth=teeth,
            speed=speed,
            undecided=undecided is not None,
        )
        notices += [undecided] if undecided else []
    if doubt:
        through.findings.append(Notice.of("rate_or_speed_doubtful"))
    notices += through.findings
    rate = record.rate or 1.0
    mesh = (gearing.mesh_frequency if gearing else 0.05) * rate
    wanted = (chain or Chain()).settled(rate=rate, samples=table.shape[-1], mesh=mesh)
    lines: list[MeasuredLine] = []
    for channel, values in zip(chosen, table, strict=True):
        lines += channel_lines(
            record,
            channel,
            values,
            gearing,
            teeth,
            wanted,
            _with_orders(
                wanted_lines(
                    gearing, values, harmonics=harmonics, sidebands=sidebands, teeth=teeth
                ),
                orders,
                gearing,
                values.size,
            ),
            sensor_tolerance,
            turns,
            Doubts(
                extra=through.extra.get(channel.name, 0.0),
                clipped=through.clipped.get(channel.name, 0.0),
                withheld=through.withheld.get(channel.name, ""),
                rate=doubt,
                speed=undecided is not None,
            ),
        )
    notices += harmonics_told(
        gearing.mesh_frequency if gearing else None, asked=harmonics, rate=record.rate
    )
    notices += dict.fromkeys(turns.told) if turns is not None else []
    lines = [of_velocity(line, record.channel(line.channel)) for line in lines]
    notices += [*_hidden(lines), *_untold(record, chosen, sensor_tolerance)]
    notices += _filtered(wanted, rate, mesh, gearing)
    swellings, defects = _heard(record, through, gearing, turns, speed, bearings)
    return Measurement(
        record,
        tuple(c.name for c in chosen),
        int(table.shape[-1]),
        wanted,
        gearing,
        gearing.teeth if gearing else None,
        tuple(lines),
        tuple(notices),
        start,
        tuple(through.findings),
        table,
        given=given,
        swellings=swellings,
        defects=defects,
    )


def _beyond(record: Record) -> list[Notice]:
    """What of a long record is not read."""
    if record.samples <= LONGEST:
        return []
    seconds = None if record.rate is None else LONGEST / record.rate
    return [Notice.of("record_cut", used=LONGEST, samples=record.samples, seconds=seconds)]


def _known_speed(record: Record, given: float | None, notices: list[Notice]) -> float | None:
    """The speed given [rad/s], else the one that the file states, which is told."""
    if given is not None or record.speed is None or not 0.0 < record.speed <= SPEED.most:
        return given
    notices.append(Notice.of("speed_of_file", speed=record.speed))
    return record.speed


def _turns(record: Record, speed: float | None) -> float | None:
    """The shaft's turns per sample at the ``speed`` said [rad/s]; None: not known."""
    return None if speed is None or not record.rate else speed / (2.0 * np.pi * record.rate)


def _heard(
    record: Record,
    through: Passed,
    gearing: Gearing | None,
    turns: MeshTurns | None,
    speed: float | None,
    bearings: Sequence[BearingRates],
) -> tuple[tuple[Swelling, ...], tuple[BearingLine, ...]]:
    """The clearest line of the envelope over the angle of the shaft, and those of ``bearings``, of
    the first samples; none without its speed, by the lines or as said [rad/s], and for a record too
    short to have a band."""
    shaft = gearing.shaft if gearing is not None else None
    shaft = _turns(record, speed) if shaft is None else shaft
    if shaft is None:
        return (), ()
    first, angle = 0, shaft * np.arange(min(BAND_SAMPLES, through.table.shape[-1]))
    if gearing is not None and turns is not None and turns.turning is not None:
        first, cycles = turns.turning.dropped, turns.turning.cycles[:BAND_SAMPLES]
        angle = cycles * (shaft / gearing.mesh_frequency)
    channels = [channel.name for channel in through.channels]
    try:
        table, per_turn = through.table[:, first : first + angle.size], samples_per_turn(angle)
        struck = impacts(
            resample_by_angle(table, angle, samples_per_turn=per_turn),
            angle=angle,
            channels=channels,
            ratios={FIRST: 1.0},
            bearings=[(FIRST, rates) for rates in bearings],
        )
    except InputError:
        return (), ()
    rate = None if record.rate_doubt else record.rate
    clear = clearest_line(struck, channels, shaft=shaft, rate=rate)
    heard = tuple(line for line in struck.lines if line.chance <= HEARD)
    return () if clear is None else (clear,), heard


def _require(
    harmonics: int,
    sidebands: int,
    orders: Sequence[float],
    sensor_tolerance: float | None,
    pulses_per_turn: float | None,
) -> None:
    """Refuse numbers that ask for nothing, or for more than a record can hold."""
    for name, number, least in (("harmonics", harmonics, 1), ("sidebands", sidebands, 0)):
        if not least <= number <= _MOST:
            fix = f"as --{name} {least + 1}, or leave it out"
            raise InputError(name, short(number), allowed=f"{least}..{_MOST}", fix=fix)
    wrong = [o for o in orders if not 0.0 < o <= _HIGHEST_ORDER]
    if wrong or len(orders) > _MOST:
        got = f"{wrong[0]:g}" if wrong else f"{len(orders)} of them"
        allowed = f"> 0 .. {_HIGHEST_ORDER:g}, at most {_MOST}"
        fix = "an order counts per turn of the first shaft, as --orders 1"
        raise InputError("orders", got, allowed=allowed, fix=fix)
    if sensor_tolerance is not None and not 0 <= sensor_tolerance < 1:
        raise InputError("sensor_tolerance", sensor_tolerance, allowed="0..1 (relative)")
    if pulses_per_turn is not None:
        PULSES.require("pulses_per_turn", pulses_per_turn)


def _of_slices(
    record: Record,
    through: Passed,
    chain: Chain | None,
    found: Changing,
    notices: list[Notice],
    given: tuple[int | None, float | None],
) -> Measurement:
    """The measurement of a run whose speed changes: its lines are means of the slices."""
    run = found.slices
    if run is not None and not run.of_mesh and record.rate is not None:
        notices += of_speed(given[1], lowest=float(run.speed.min()), highest=float(run.speed.max()))
    return Measurement(
        record,
        tuple(c.name for c in through.channels),
        int(through.table.shape[-1]),
        chain or Chain(method="line"),
        found.gearing,
        found.teeth,
        found.lines,
        (*notices, *_hidden(found.lines), *_untold(record, through.channels, None)),
        through.start,
        tuple(through.findings),
        through.table,
        run,
        given,
    )


def _hidden(lines: Sequence[MeasuredLine]) -> list[Notice]:
    """How many lines are no readings."""
    hidden = sum(not line.is_reading for line in lines)
    return [Notice.of("lines_hidden", lines=hidden, of=len(lines))] if hidden else []


def _with_orders(
    wanted: list[Wanted],
    orders: Sequence[float],
    gearing: Gearing | None,
    samples: int,
) -> list[Wanted]:
    """The lines with those at ``orders`` of the first shaft, which must be known for them.

    Refused is an order that turns less than once in the ``samples`` or is above half the rate.
    """
    if not orders:
        return wanted
    if gearing is None or gearing.shaft is None:
        got = ", ".join(f"{o:g}" for o in orders)
        raise InputError("orders", got, why="no shaft's speed is known", fix="--speed or --tacho")
    shaft = gearing.shaft
    require_orders(orders, lowest=1.0 / (samples * shaft), highest=(0.5 - 2.0 / samples) / shaft)
    return wanted + order_lines(orders, shaft, wanted)


def _untold(
    record: Record, channels: list[Channel], sensor_tolerance: float | None
) -> Iterator[Notice]:
    """What neither the record nor the user says, and what it means for the lines."""
    if record.rate is None:
        yield Notice.of("rate_not_known")
    bare = [c for c in channels if c.unit is None]
    if bare:
        strange = next((u for c in bare if (u := c.strange or unknown_unit(c.name))), None)
        yield Notice.of("unit_not_known", unit=strange)
    if sensor_tolerance is None:
        yield Notice.of("sensor_tolerance_not_stated")


def _filtered(chain: Chain, rate: float, mesh: float, gearing: Gearing | None) -> Iterator[Notice]:
    """Whether the band's filter weakens the line at ``mesh`` [Hz] by more than 1 %."""
    band = chain.filter(rate)
    if band is not None and gearing is not None and abs(float(band.gain(mesh)) - 1) > 0.01:
        yield Notice.of("filter_weakens_mesh_line", taps=band.taps, gain=float(band.gain(mesh)))


def require_teeth(teeth: int | None) -> None:
    """Refuse a number of ``teeth`` (None: unknown) that no gear has."""
    if teeth is not None and not 1 <= teeth <= MOST_TEETH:
        got = teeth if abs(teeth) < 10**12 else "a number of more than twelve digits"
        raise InputError("teeth", got, allowed=f"1..{MOST_TEETH}")
