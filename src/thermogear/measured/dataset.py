"""A measurement as labelled datasets: what a page is drawn from and what is stored."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.vocabulary import label
from thermogear.measured.gearing import Gearing
from thermogear.measured.lines import MeasuredLine
from thermogear.measured.reduction import Measurement
from thermogear.measured.slice_groups import slice_figures, slice_groups
from thermogear.results.result import Notice, Result, now
from thermogear.signals.spectra import amplitude_spectrum

if TYPE_CHECKING:
    import xarray as xr

Floats = NDArray[np.float64]

_DRAWN = 4096  # points of a curve kept for pictures
_LONGEST = 1 << 20


def result_of(found: Measurement) -> Result:
    """Groups ``record`` (an excerpt), ``spectrum`` (its peaks), ``lines``; settings, gearing and
    notices as texts. Rates and units that are unknown stay empty."""
    channels = [found.record.channel(name) for name in found.channels]
    table = found.values[:, :_LONGEST]
    spectrum = amplitude_spectrum(table - table.mean(axis=-1, keepdims=True), 1.0, "hann")
    place, peaks = _peaks(spectrum.frequencies, spectrum.amplitudes)
    excerpt = min(_DRAWN, table.shape[-1])
    names = ("channel",), np.asarray(found.channels)
    groups = {
        "record": label(
            {"record_reading": (("channel", "sample"), table[:, :excerpt])},
            {"record_sample": (("sample",), found.start + np.arange(excerpt))},
        ).assign_coords(channel=names),
        "spectrum": label(
            {"spectrum_reading": (("channel", "bin"), peaks)},
            {"spectrum_position": (("bin",), place)},
        ).assign_coords(channel=names),
    }
    if found.lines:
        groups["lines"] = _lines(found.lines)
    if found.slices is not None:
        groups |= slice_groups(found.slices)
    gearing = found.gearing
    return Result.of(
        "measured",
        f"Record {found.record.source}",
        groups,
        [Notice(n.level, n.text) for n in found.notices],
        created=now(),
        settings=found.settings,
        evidence=_evidence(found),
        findings=[one.text for one in found.findings],
        rate="" if found.record.rate is None else repr(found.record.rate),
        unit=channels[0].unit or "",
        teeth="" if found.teeth is None else str(found.teeth),
        mesh_position="" if gearing is None else repr(gearing.mesh_frequency),
        figures=figures(found),
    )


def figures(found: Measurement) -> dict[str, Any]:
    """The measurement as plain figures; what the record does not allow is None."""

    def plain(value: object) -> object:
        return None if isinstance(value, float) and not math.isfinite(value) else value

    gearing = found.gearing
    return {
        "source": found.record.source,
        "rate": found.record.rate,
        "rate_half_width": found.record.rate_half_width if found.record.rate else None,
        "settings": found.settings,
        "teeth": found.teeth,
        "mesh_position": gearing.mesh_frequency if gearing else None,
        "shaft_speed": plain(found.lines[0].shaft_speed) if found.lines else None,
        "shaft_speed_half_width": plain(found.lines[0].speed_half_width) if found.lines else None,
        "shafts": [vars(shaft) for shaft in gearing.shafts] if gearing else [],
        "meshes": [vars(mesh) for mesh in gearing.meshes] if gearing else [],
        "evidence": _evidence(found),
        "given": {"teeth": found.given[0], "speed": found.given[1]},
        "found": _found(gearing),
        "swelling": vars(found.swelling) if found.swelling else None,
        "findings": [{**vars(one), "text": one.text} for one in found.findings],
        "lines": [{k: plain(v) for k, v in vars(line).items()} for line in found.lines],
        "slices": None if found.slices is None else slice_figures(found.slices),
        "notices": [vars(notice) for notice in found.notices],
    }


def _evidence(found: Measurement) -> list[str]:
    told = list(found.gearing.evidence) if found.gearing else []
    return told + ([found.swelling.words] if found.swelling else [])


def _found(gearing: Gearing | None) -> dict[str, Any]:
    """The verdict on the teeth, with the hypotheses that carry weight."""
    if gearing is None:
        return {
            "verdict": "no gear found",
            "teeth": [],
            "gears": [],
            "hypotheses": [],
            "envelope": None,
        }
    return {
        "verdict": gearing.weighed.verdict,
        "teeth": [shaft.teeth for shaft in gearing.shafts],
        "gears": [
            {
                "mesh_position": one.mesh,
                "teeth": one.teeth,
                "weight": one.weight,
                "words": one.words,
            }
            for one in gearing.weighed.gears
        ],
        "hypotheses": [
            {
                "kind": one.kind,
                "weight": one.weight,
                "meshes": [
                    {"mesh_position": gears.mesh, "teeth": list(gears.teeth)} for gears in one.gears
                ],
                "combs": list(one.combs),
                "words": one.words,
            }
            for one in gearing.weighed.told
        ],
    }


def _lines(lines: tuple[MeasuredLine, ...]) -> xr.Dataset:
    names = {
        "line_order": "order",
        "line_position": "position",
        "line_frequency": "frequency",
        "line_reading": "reading",
        "line_acceleration": "acceleration",
        "line_displacement": "displacement",
        "line_uncertainty": "uncertainty",
        "line_half_width": "half_width",
        "line_position_half_width": "position_half_width",
        "line_frequency_half_width": "frequency_half_width",
        "line_bin_offset": "bin_offset",
        "line_prominence": "prominence",
        "implied_shaft_speed": "shaft_speed",
        "implied_shaft_speed_half_width": "speed_half_width",
    }
    values = {
        stored: (("line",), np.array([getattr(line, own) for line in lines], dtype=float))
        for stored, own in names.items()
    }
    return label(values).assign_coords(
        channel=("line", [line.channel for line in lines]),
        kind=("line", [line.kind for line in lines]),
        name=("line", [line.name for line in lines]),
        withheld=("line", [line.withheld for line in lines]),
    )


def _peaks(place: Floats, amplitudes: Floats) -> tuple[Floats, Floats]:
    """The highest of each run of bins, so that a picture of few points keeps every line."""
    run = max(1, -(-place.size // _DRAWN))
    if run == 1:
        return place, amplitudes
    count = place.size // run
    shaped = amplitudes[:, : count * run].reshape(amplitudes.shape[0], count, run)
    highest = np.argmax(shaped.max(axis=0), axis=-1) + run * np.arange(count)
    return place[highest], shaped.max(axis=-1)
