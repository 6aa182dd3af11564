"""``measure``: from a record to lines with amplitude, order, uncertainty and the settings used."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import MOST_TEETH, PULSES, SPEED
from thermogear.base.errors import InputError
from thermogear.measured.chain import METHODS, Chain
from thermogear.measured.evidence import Stated
from thermogear.measured.gate import Finding, Passed, passed, require_sampling_rate
from thermogear.measured.gearing import Gearing, find_gearing
from thermogear.measured.lines import Doubts, MeasuredLine, channel_lines, wanted_lines
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.traps import HUGE, health
from thermogear.measured.turns import MeshTurns, clearest, mesh_turns
from thermogear.signals.quality import phase_jumps
from thermogear.signals.windows import Window

Floats = NDArray[np.float64]

LONGEST = 1 << 21
"""Samples per channel reduced at once; a longer record is cut there with a notice."""

_NEAR = 0.1  # a stated speed is nominal: motors slip
_JUMP_TURNS = 3  # of the shaft in a piece whose phase is looked at

_FACTORS = {
    10.0: "ten times too high",
    0.1: "ten times too low",
    100.0: "a hundred times too high",
    0.01: "a hundred times too low",
    1000.0: "a thousand times too high (milliseconds read as seconds?)",
    0.001: "a thousand times too low (seconds read as milliseconds?)",
    2.0: "twice too high",
    0.5: "twice too low",
    2.56: "2.56 times too high (bandwidth and rate exchanged?)",
    1 / 2.56: "2.56 times too low (bandwidth and rate exchanged?)",
    60.0: "sixty times too high (turns per minute and per second exchanged?)",
    1 / 60.0: "sixty times too low (turns per minute and per second exchanged?)",
}


@dataclass(frozen=True)
class Measurement:
    """A record reduced: lines, gearing with evidence, settings and notices.

    ``teeth``: those orders are counted with, given or found; ``given``: what the user said (teeth,
    speed [rad/s]), None where he said nothing.
    ``findings``: damage of the record and what was done about it; ``values`` (channel, sample):
    what the lines were read from, in the file's unit.
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
    findings: tuple[Finding, ...] = ()
    values: Floats = field(default_factory=lambda: np.empty((0, 0)), repr=False)
    given: tuple[int | None, float | None] = (None, None)

    @property
    def damage(self) -> tuple[tuple[str, str], ...]:
        """Level and text of every finding."""
        return tuple((one.notice.level, one.notice.text) for one in self.findings)

    @property
    def settings(self) -> dict[str, str]:
        """What must be told with every amplitude: rate, N, bin width, window, ENBW, filter."""
        rate, window = self.record.rate, Window(self.chain.window)
        unit = "cycles/sample" if rate is None else "Hz"
        band, taps = self.chain.band, self.chain.taps
        return {
            "rate": "unknown" if rate is None else f"{rate:g} /s ({self.record.rate_origin})",
            "samples": str(self.samples),
            "bin width": f"{(rate or 1.0) / self.samples:.6g} {unit}",
            "window": f"{window.name}, noise bandwidth {window.noise_bandwidth:.4g} bins, "
            f"line at the interpolated frequency",
            "method": METHODS[self.chain.method],
            "band": "none" if band is None else f"{band[0]:.6g}..{band[1]:.6g} {unit}",
            "taps": "none" if taps is None else str(taps),
            "low cut": "none" if self.chain.low_cut is None else f"{self.chain.low_cut:.6g} {unit}",
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
) -> Measurement:
    """Lines of a record: mesh harmonics, sidebands, further meshes, with their uncertainty.

    ``record`` a Record or a file (``read_record``); ``channels`` those to reduce (default: all
    that vibrate); ``teeth`` and ``speed`` [rad/s] of the first shaft where they are known: they
    are checked against what the lines say; ``sensor_tolerance`` the sensor's relative standard
    uncertainty; ``pulses_per_turn`` of the tacho channel, where there is one. Where the speed
    wanders enough to smear the lines they are read in angle: by the tacho, else by the phase of
    the mesh line. Without a rate the lines are given in orders and cycles per sample, without a
    unit in the file's own numbers.

    Before any number the record passes the gate (:mod:`~thermogear.measured.gate`): damage is in
    ``findings``, and the uncertainty holds it or the number is withheld.

    Raises InputError for a record without a line, a channel without a signal, a rate so low that
    it may be a shaft's.
    """
    if not isinstance(record, Record):
        record = read_record(record)
    require_sampling_rate(record)
    if harmonics < 1 or sidebands < 0:
        raise InputError("harmonics, sidebands", f"{harmonics}, {sidebands}", allowed=">= 1, >= 0")
    if sensor_tolerance is not None and not 0 <= sensor_tolerance < 1:
        raise InputError("sensor_tolerance", sensor_tolerance, allowed="0..1 (relative)")
    if pulses_per_turn is not None:
        PULSES.require("pulses_per_turn", pulses_per_turn)
    require_teeth(teeth)
    notices = list(record.notices)
    chosen = _chosen(record, channels, notices)
    through = passed(chosen, LONGEST)
    if len(chosen[0]) > LONGEST:
        notices.append(
            Notice("info", f"the first {LONGEST} of {len(chosen[0])} samples are reduced to lines")
        )
    given = teeth, speed
    expected, stated = _expected(record, teeth, speed), _stated(record, teeth, speed)
    gearing = _gearing(through.table, notices, expected, stated)
    if _whole_turns(through, gearing, teeth):
        gearing = _gearing(through.table, [], expected, stated)
    chosen, start, table = through.channels, through.start, through.table
    teeth = _teeth(gearing, teeth, notices)
    turns: MeshTurns | None = None
    doubt = record.rate_doubt
    if gearing is not None:
        turns = mesh_turns(
            record,
            table,
            gearing,
            teeth=teeth,
            harmonics=harmonics,
            pulses_per_turn=pulses_per_turn,
            start=start,
        )
        # in a resampled record the lines stand at multiples of this mean and nowhere else
        gearing = replace(gearing, mesh_frequency=turns.frequency)
    if gearing is not None:
        doubt = _check_rate(record, gearing, teeth, given[0], speed, notices)
    if doubt:
        through.findings.append(
            Finding(
                kind=f"the rate is doubtful: {doubt}",
                done="frequencies, speed and displacements are withheld",
                effect="they would be wrong by the rate's factor; orders and accelerations stand",
                withholds=True,
            )
        )
    notices += [one.notice for one in through.findings]
    if turns is not None and turns.said:
        notices.append(Notice("info", turns.said))
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
            wanted_lines(gearing, values, harmonics=harmonics, sidebands=sidebands),
            sensor_tolerance,
            turns,
            Doubts(
                extra=through.extra.get(channel.name, 0.0),
                withheld=through.withheld.get(channel.name, ""),
                rate=doubt,
            ),
        )
    notices += _untold(record, chosen, sensor_tolerance)
    notices += _filtered(wanted, rate, mesh, gearing)
    return Measurement(
        record,
        tuple(c.name for c in chosen),
        int(table.shape[-1]),
        wanted,
        gearing,
        teeth,
        tuple(lines),
        tuple(notices),
        start,
        tuple(through.findings),
        table,
        given,
    )


def _untold(
    record: Record, channels: list[Channel], sensor_tolerance: float | None
) -> Iterator[Notice]:
    """What neither the record nor the user says, and what it means for the lines."""
    if record.rate is None:
        yield Notice("important", "no rate is known: lines are in orders and cycles per sample")
    if any(c.unit is None for c in channels):
        yield Notice("important", "no unit is known: amplitudes are the file's own numbers")
    if sensor_tolerance is None:
        yield Notice("info", "no sensor tolerance is stated: u_D holds noise and scatter alone")


def _filtered(chain: Chain, rate: float, mesh: float, gearing: Gearing | None) -> Iterator[Notice]:
    """Whether the band's filter weakens the line at ``mesh`` [Hz] by more than 1 %."""
    band = chain.filter(rate)
    if band is not None and gearing is not None and abs(float(band.gain(mesh)) - 1) > 0.01:
        kept = "not divided out" if chain.method == "trapezoid" else "divided out"
        yield Notice(
            "warning",
            f"{band.taps} taps: the filter passes {float(band.gain(mesh)):.3f} of the mesh "
            f"line ({kept})",
        )


def _chosen(record: Record, channels: Sequence[str | int], notices: list[Notice]) -> list[Channel]:
    if channels:
        picked = [record.channel(name) for name in channels]
        for channel in picked:
            found = health(channel)
            if found.constant or found.missing == len(channel) or found.peak >= HUGE:
                raise InputError("channel", repr(channel.name), why="it holds no signal")
        return picked
    alive = []
    for channel in record.signals():
        found = health(channel)
        if found.constant or found.missing == len(channel) or found.peak >= HUGE:
            notices.append(Notice("warning", f"channel {channel.name!r} holds no signal: left out"))
        else:
            alive.append(channel)
    if not alive:
        raise InputError("record", record.source, why="no channel holds a signal")
    if len({c.unit for c in alive}) > 1:
        first = alive[0].unit
        notices.append(Notice("info", f"channels of several units; those in {first} are reduced"))
        alive = [c for c in alive if c.unit == first]
    return alive


def _whole_turns(through: Passed, gearing: Gearing | None, teeth: int | None) -> bool:
    """Cut to the longest stretch between jumps of the mesh line's phase; whether there were any."""
    if gearing is None:
        return False
    values = clearest(through.table, gearing.mesh_frequency)[0]
    piece = _JUMP_TURNS * (teeth or gearing.teeth or 20)
    jumps = phase_jumps(values, gearing.mesh_frequency, cycles=piece)
    if not jumps:
        return False
    around = int(np.ceil(piece / gearing.mesh_frequency))  # a jump is placed so well
    edges = [-around, *jumps, values.size + around]
    first, stop = max(
        ((a + around, b - around) for a, b in pairwise(edges)), key=lambda pair: pair[1] - pair[0]
    )
    least = max(256, int(np.ceil(20.0 / gearing.mesh_frequency)))
    if stop - first < least:
        return False
    places = ", ".join(str(through.start + at) for at in jumps[:5])
    through.findings.append(
        Finding(
            kind=f"the mesh line's phase jumps near sample {places}: samples are lost there",
            done=f"only the longest stretch between is used, samples {through.start + first}.."
            f"{through.start + stop - 1}",
            effect="none on that stretch",
        )
    )
    through.cut(first, stop=stop)
    return True


def require_teeth(teeth: int | None) -> None:
    """Refuse a number of ``teeth`` (None: unknown) that no gear has."""
    if teeth is not None and not 1 <= teeth <= MOST_TEETH:
        got = teeth if abs(teeth) < 10**12 else "a number of more than twelve digits"
        raise InputError("teeth", got, allowed=f"1..{MOST_TEETH}")


def _expected(record: Record, teeth: int | None, speed: float | None) -> float | None:
    if speed is not None:
        SPEED.require("speed", speed)
        if speed == 0.0:
            raise InputError("speed", "0 rad/s", why="a gear that stands still has no line")
    if record.rate is None or teeth is None or speed is None:
        return None
    return teeth * speed / (2.0 * np.pi) / record.rate


def _stated(record: Record, teeth: int | None, speed: float | None) -> Stated:
    if speed is None or record.rate is None:
        return Stated(teeth=teeth)
    return Stated(teeth=teeth, shaft=speed / (2.0 * np.pi) / record.rate)


def _gearing(
    table: Floats, notices: list[Notice], expected: float | None, stated: Stated
) -> Gearing | None:
    """What the lines say, with what is stated as evidence; the expected place only where a line
    is clear there as well."""
    try:
        free: Gearing | None = find_gearing(list(table), stated=stated)
    except InputError as error:
        notices.append(Notice("important", str(error)))
        free = None
    if expected is None or (free and abs(free.mesh_frequency / expected - 1.0) < 0.03):
        return free
    if 5.0 / table.shape[-1] < expected < 0.45:
        try:
            near = find_gearing(list(table), expected, stated)
        except InputError:
            return free  # nothing stands where teeth and speed put the mesh line
        heights = [float(np.mean(np.log(g.harmonics))) for g in (near, free) if g is not None]
        if len(heights) == 1 or heights[0] > 0.6 * heights[1]:
            return near
    return free


def _teeth(gearing: Gearing | None, teeth: int | None, notices: list[Notice]) -> int | None:
    if gearing is None:
        return teeth
    seen = [shaft.teeth for shaft in gearing.shafts]
    if teeth is None:
        return gearing.teeth
    if seen and teeth not in seen:
        notices.append(
            Notice(
                "important",
                f"the lines say {' and '.join(map(str, seen))} teeth, not the {teeth} given: "
                "mesh line over shaft line must be a whole number of teeth",
            )
        )
    return teeth


def _check_rate(
    record: Record,
    gearing: Gearing,
    teeth: int | None,
    given: int | None,
    speed: float | None,
    notices: list[Notice],
) -> str:
    """Why the rate is doubtful, "" where it is not: against teeth and speed where these are known.

    A rate given that contradicts the file's is kept where teeth and speed confirm it. The rate is
    blamed only where the teeth are decided and no reading of the lines with any weight fits the
    speed (and the teeth ``given``).
    """
    if teeth is None:
        return record.rate_doubt
    turns = gearing.mesh_frequency / teeth  # turns per sample
    if record.rate is None:
        if speed is not None:
            notices.append(
                Notice(
                    "info",
                    f"if the shaft turns at the {speed * 30 / np.pi:.6g} rpm given, the rate is "
                    f"{speed / (2 * np.pi) / turns:.6g} samples/s (not adopted)",
                )
            )
        return ""
    implied = turns * record.rate
    notices.append(
        Notice(
            "info",
            f"the rate {record.rate:g}/s and {teeth} teeth make the shaft turn at "
            f"{60 * implied:.6g} rpm",
        )
    )
    if 2.56 * gearing.mesh_frequency > 1.0:
        notices.append(
            Notice("warning", "the rate is below 2.56 times the mesh line: aliases are possible")
        )
    if speed is None:
        return record.rate_doubt
    shaft = speed / (2 * np.pi)
    ratio = implied / shaft
    if abs(ratio - 1.0) <= _NEAR:
        return ""
    weighed = gearing.weighed
    if weighed.fits(shaft / record.rate, given, _NEAR):
        return record.rate_doubt
    if weighed.verdict != "decided":
        # what the mesh line is, is open: it contradicts nobody
        notices.append(
            Notice(
                "warning",
                f"the mesh line read at {gearing.mesh_frequency:.6f} cycles/sample does not fit "
                f"the {speed * 30 / np.pi:.6g} rpm given, and the record does not decide that it "
                "is one",
            )
        )
        return record.rate_doubt
    named = min(_FACTORS, key=lambda factor: abs(np.log(ratio / factor)))
    what = (
        f"the rate looks {_FACTORS[named]}"
        if abs(ratio / named - 1.0) <= _NEAR
        else f"rate, teeth or speed is wrong by a factor {ratio:.4g}"
    )
    notices.append(
        Notice(
            "important",
            f"{what}: the mesh line at {gearing.mesh_frequency:.6f} cycles/sample over {teeth} "
            f"teeth makes {60 * implied:.6g} rpm at {record.rate:g} samples/s, the speed given is "
            f"{speed * 30 / np.pi:.6g} rpm (a rate of {record.rate / ratio:.6g} would fit)",
        )
    )
    return what
