"""A measurement as labelled datasets: what a page is drawn from and what is stored."""

from __future__ import annotations

import numpy as np
import pandas as pd
import xarray as xr

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.vocabulary import label
from thermogear.measured.figures import evidence, figures
from thermogear.measured.lines import MeasuredLine
from thermogear.measured.over_speed import OrderSlices
from thermogear.measured.quantities import quantities
from thermogear.measured.reduction import Measurement
from thermogear.results.result import Result, now
from thermogear.signals.lines import line_spectrum


def slice_groups(found: OrderSlices) -> dict[str, Dataset]:
    """Groups ``slices`` (channel, slice, step) and ``map`` (row, map_column).

    A fit of a model to a run-up takes ``slice_speed`` [rad/s], ``slice_speed_rate``, the name of
    the order, and ``slice_acceleration`` [m/s^2] or ``slice_displacement`` [m] with the relative
    half width of its 95 % interval.
    """
    omega = 2.0 * np.pi * found.frequency
    si = found.reading * found.si[:, None, None]
    moved = [quantities(a, omega=omega, kind=kind) for a, kind in zip(si, found.kinds, strict=True)]
    axes = ("channel", "slice", "step")
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = found.half_width / found.reading
    slices = label(
        {
            "slice_reading": (axes, found.reading),
            "slice_reading_half_width": (axes, found.half_width),
            "slice_acceleration": (axes, np.stack([a for a, _ in moved])),
            "slice_displacement": (axes, np.stack([x for _, x in moved])),
            "slice_half_width": (axes, relative),
            "slice_phase": (axes, found.phase),
            "slice_turns": (axes, found.block),
            "slice_frequency": (("slice", "step"), found.frequency),
            "slice_order": (("slice",), found.orders),
            "slice_time": (("step",), found.time),
            "slice_speed": (("step",), found.speed),
            "slice_speed_rate": (("step",), found.acceleration),
        }
    ).assign_coords(channel=list(found.channels), name=("slice", list(found.names)))
    slices.attrs["of_mesh"] = int(found.of_mesh)
    shown = found.map
    return {
        "slices": slices,
        "map": label(
            {
                "map_reading": (("row", "map_column"), shown.amplitude),
                "map_order": (("map_column",), shown.order),
                "map_speed": (("row",), shown.speed),
                "map_time": (("row",), shown.time),
            }
        ),
    }


_DRAWN = 4096  # points of a curve kept for pictures
_LONGEST = 1 << 20
_PIECES = 600  # of the whole record


def result_of(found: Measurement) -> Result:
    """Groups ``record`` (an excerpt), ``whole`` (the extremes of pieces of a longer one),
    ``spectrum`` (its peaks), ``lines``; settings, gearing and
    notices as texts, :func:`~thermogear.measured.figures.figures` as a table. Rates and units that
    are unknown stay empty."""
    channels = [found.record.channel(name) for name in found.channels]
    table = found.values[:, :_LONGEST]
    amplitudes = np.stack([line_spectrum(values, 1.0).hann for values in table])
    place, peaks = _peaks(np.arange(amplitudes.shape[-1]) / table.shape[-1], amplitudes)
    excerpt = min(_DRAWN, table.shape[-1])
    names = np.asarray(found.channels)
    # made by hand: xarray would load pint to see whether the names are numbers with units
    index = xr.indexes.PandasIndex(
        pd.Index(names, dtype=object), "channel", coord_dtype=names.dtype
    )
    by_channel = xr.Coordinates.from_xindex(index)
    groups = {
        "record": label(
            {"record_reading": (("channel", "sample"), table[:, :excerpt])},
            {"record_sample": (("sample",), found.start + np.arange(excerpt))},
        ).assign_coords(by_channel),
        "spectrum": label(
            {"spectrum_reading": (("channel", "bin"), peaks)},
            {"spectrum_position": (("bin",), place)},
        ).assign_coords(by_channel),
    }
    if found.values.shape[-1] > excerpt:
        groups["whole"] = _pieces(found.values, found.start).assign_coords(by_channel)
    if found.readings:
        groups["lines"] = _lines(found.readings)
    if found.slices is not None:
        groups |= slice_groups(found.slices)
    gearing = found.gearing
    return Result.of(
        "measured",
        f"Record {found.record.source}",
        groups,
        found.notices,
        created=now(),
        settings=found.settings,
        evidence=evidence(found),
        findings=[one.text for one in found.findings],
        rate="" if found.record.rate is None else repr(found.record.rate),
        unit=channels[0].unit or "",
        teeth="" if found.teeth is None else str(found.teeth),
        mesh_position="" if gearing is None else repr(gearing.mesh_frequency),
        figures=figures(found),
    )


def _pieces(table: Floats, start: int) -> Dataset:
    """Lowest and highest reading of each of some hundred pieces of the record."""
    first = np.unique(np.linspace(0, table.shape[-1], _PIECES + 1).astype(int)[:-1])
    axes = ("channel", "piece")
    return label(
        {
            "piece_lowest": (axes, np.minimum.reduceat(table, first, axis=-1)),
            "piece_highest": (axes, np.maximum.reduceat(table, first, axis=-1)),
        },
        {"piece_sample": (("piece",), start + first)},
    )


def _lines(lines: tuple[MeasuredLine, ...]) -> Dataset:
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
    texts = ("channel", "kind", "name", "withheld")
    return label(values, {own: (("line",), [getattr(one, own) for one in lines]) for own in texts})


def _peaks(place: Floats, amplitudes: Floats) -> tuple[Floats, Floats]:
    """The highest of each run of bins, so that a picture of few points keeps every line."""
    run = max(1, -(-place.size // _DRAWN))
    if run == 1:
        return place, amplitudes
    count = place.size // run
    shaped = amplitudes[:, : count * run].reshape(amplitudes.shape[0], count, run)
    highest = np.argmax(shaped.max(axis=0), axis=-1) + run * np.arange(count)
    return place[highest], shaped.max(axis=-1)
