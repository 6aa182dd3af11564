"""A measurement as plain figures, for scripts: every number by a name, every name with its unit.

``NAME_half_width`` is the half width of the 95 % interval, in the unit of ``NAME``; what is a share
of ``NAME`` says relative.
"""

from __future__ import annotations

import math
from typing import Any

from thermogear.measured.lines import MeasuredLine
from thermogear.measured.over_speed import OrderSlices
from thermogear.measured.record import Record
from thermogear.measured.reduction import Measurement
from thermogear.signals.slices import greatest

_PLAIN = (
    "teeth order expected lines powers chance share "
    "relative_half_width relative_standard_uncertainty bin_offset prominence steps turns"
)
UNITS: dict[str, str] = {
    **dict.fromkeys(_PLAIN.split(), "1"),
    **dict.fromkeys(("first", "last", "count"), "samples"),
    **dict.fromkeys(("position", "mesh_position", "distance", "low", "high"), "cycles/sample"),
    **dict.fromkeys(("shaft_speed", "speed", "shaft_speed_range", "speed_range"), "rad/s"),
    "rate": "samples/s",
    "frequency": "Hz",
    "acceleration": "m/s^2",
    "displacement": "m",
    "speed_rate": "rad/s^2",
    "phase": "rad",
    "time": "s",
}
"""Unit of every number of the figures by its name, readings apart; ``_half_width`` has its own."""
_READINGS = ("reading", "greatest_low", "greatest_high")
_WITH_INTERVAL = (
    "rate",
    "position",
    "frequency",
    "shaft_speed",
    "acceleration",
    "displacement",
    "reading",
)


def figures(found: Measurement) -> dict[str, Any]:
    """The measurement as plain figures with their ``units``; what is not known is None."""
    gearing, run = found.gearing, found.slices
    first = found.lines[0] if found.lines else None
    turning = run is not None and not run.of_mesh and found.record.rate is not None
    return {
        "source": found.record.source,
        "rate": found.record.rate,
        "rate_half_width": found.record.rate_half_width if found.record.rate else None,
        "settings": _settings(found),
        "teeth": found.teeth,
        "mesh_position": gearing.mesh_frequency if gearing else None,
        "shaft_speed": _known(first.shaft_speed) if first else None,
        "shaft_speed_half_width": _known(first.speed_half_width) if first else None,
        "shaft_speed_range": _range(run) if turning and run is not None else None,
        "families": [vars(family) for family in gearing.families] if gearing else [],
        "evidence": evidence(found),
        "course": _course(found),
        "given": {"teeth": found.given[0], "speed": found.given[1]},
        "teeth_confirmed": gearing is not None and gearing.confirmed,
        "swellings": [vars(one) for one in found.swellings],
        "defects": [vars(one) for one in found.defects],
        "findings": [one.as_dict() for one in found.findings],
        "lines": [_line(line, found.record) for line in found.readings],
        "slices": None if run is None else _slices(run, found.record),
        "notices": [notice.as_dict() for notice in found.notices],
        "units": units(found.record, found.channels),
    }


def _course(found: Measurement) -> str:
    """How the speed goes over the record."""
    if found.slices is not None:
        return "its speed changes"
    followed = any(one.code in ("phase_wanders", "read_in_angle") for one in found.notices)
    return "its speed wanders" if followed else "steady"


def _settings(found: Measurement) -> dict[str, Any]:
    """The settings with numbers for those that are numbers."""
    chain, rate = found.chain, found.record.rate
    words = {name: found.settings[name] for name in ("rate", "window", "method", "amplitudes")}
    return words | {
        "samples": found.samples,
        f"bin_width_{'Hz' if rate else 'cycles_per_sample'}": (rate or 1.0) / found.samples,
        f"band_{'Hz' if rate else 'cycles_per_sample'}": chain.band,
        "taps": chain.taps,
    }


def units(record: Record, channels: tuple[str, ...]) -> dict[str, str]:
    """The unit of every number by its name; a reading's is "" where channels have several (then
    ``unit`` beside it says) or none is known."""
    own = {record.channel(name).unit or "" for name in channels}
    of_readings = dict.fromkeys(_READINGS, own.pop() if len(own) == 1 else "")
    every = UNITS | of_readings
    return every | {f"{name}_half_width": every[name] for name in _WITH_INTERVAL}


def evidence(found: Measurement) -> list[str]:
    """What was seen, in sentences."""
    told = list(found.gearing.evidence) if found.gearing else []
    told += [one.words for one in found.swellings]
    return told + [one.words for one in found.defects]


def _known(value: float) -> float | None:
    return float(value) if math.isfinite(value) else None


def _range(run: OrderSlices) -> list[float]:
    return [float(run.speed.min()), float(run.speed.max())]


def _line(line: MeasuredLine, record: Record) -> dict[str, Any]:
    """A line; its half widths in the unit of the value."""
    share = line.half_width
    numbers = {
        "order": line.order,
        "position": line.position,
        "position_half_width": line.position_half_width,
        "frequency": line.frequency,
        "frequency_half_width": line.frequency_half_width,
        "reading": line.reading,
        "reading_half_width": share * line.reading,
        "acceleration": line.acceleration,
        "acceleration_half_width": share * line.acceleration,
        "displacement": line.displacement,
        "displacement_half_width": share * line.displacement,
        "relative_half_width": share,
        "relative_standard_uncertainty": line.uncertainty,
        "bin_offset": line.bin_offset,
        "prominence": line.prominence,
        "shaft_speed": line.shaft_speed,
        "shaft_speed_half_width": line.speed_half_width,
    }
    return {
        "channel": line.channel,
        "kind": line.kind,
        "name": line.name,
        "unit": record.channel(line.channel).unit or "",
        **{name: _known(value) for name, value in numbers.items()},
        "withheld": line.withheld,
    }


def _slices(run: OrderSlices, record: Record) -> dict[str, Any]:
    """Of a run over speed: range of speed, the greatest amplitude of every order."""
    told = []
    for c, channel in enumerate(run.channels):
        for k, name in enumerate(run.names):
            top = greatest(run.reading[c, k], half_width=run.half_width[c, k])
            if top is None:
                continue
            told.append(
                {
                    "channel": channel,
                    "name": name,
                    "unit": record.channel(channel).unit or "",
                    "order": float(run.orders[k]),
                    "reading": top.amplitude,
                    "reading_half_width": float(run.half_width[c, k, top.step]),
                    "greatest_low": top.low,
                    "greatest_high": top.high,
                    "steps": top.steps,
                    "speed": _known(run.speed[top.step]),
                    "frequency": _known(run.frequency[k, top.step]),
                }
            )
    return {
        "of_mesh": run.of_mesh,
        "steps": int(run.time.size),
        "speed_range": _range(run),
        "greatest": told,
    }
