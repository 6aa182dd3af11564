"""Measured flanks in the results of a run: traces, fit and what acts, and what to know of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import NO_COUNT, label
from thermogear.case.case import GearCase
from thermogear.case.charts import Chart
from thermogear.gears.deviations import Relief, active_profile
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.results.result import Notice


def measured_flanks(case: GearCase) -> dict[str, Dataset]:
    """A group ``flanks/GEAR`` for each gear that was measured."""
    return {f"flanks/{chart.gear}": _group(chart, case.pair) for chart in case.charts}


def _group(chart: Chart, pair: GearPair) -> Dataset:
    gear = _gear(pair, chart.gear)
    traces, flanks = chart.traces, chart.flanks
    rho = traces.rho
    start, pitch, tip = active_profile(pair, chart.gear)
    low, high = chart.range
    entries: dict[str, Any] = {}
    for measured in flanks:
        rows = [k for k, side in enumerate(traces.flank) if side == measured.flank]
        inside = (rho >= measured.rho[0]) & (rho <= measured.rho[-1])
        acts = np.interp(rho, measured.rho, measured.acting)
        # the fit stands where the mean trace does, as the chart has it
        level = float(np.mean(traces.added[rows].mean(axis=0)[inside] - acts[inside]))
        on_flank = (rho >= start) & (rho <= tip)
        curves = {
            "fit": (np.where(inside, acts + level, np.nan), "mean of the teeth, smoothed"),
            "acting": (np.where(on_flank, acts, np.nan), "what acts, zero at the pitch circle"),
        }
        figures_ = {
            "cutoff": (measured.cutoff, "cut-off of the low-pass along the roll path"),
            "noise": (measured.noise, "noise of one trace"),
            "scatter": (measured.scatter, "scatter between the teeth"),
        }
        for name, (values, text) in curves.items():
            meaning = f"{measured.flank} flank, {text}"
            entries[f"{measured.flank}_{name}"] = (("flank_point",), values, "m", meaning)
        for name, (value, text) in figures_.items():
            entries[f"{measured.flank}_{name}"] = (
                (),
                np.array(value),
                "m",
                f"{measured.flank}, {text}",
            )
    figures = {side.flank: iter(zip(side.figures, side.grades, strict=True)) for side in flanks}
    rows_ = [next(figures[side]) for side in traces.flank]
    words = {
        "profile_slope": "profile slope deviation f_Hα, > 0 outside at the tip",
        "profile_form": "profile form deviation f_fα",
        "profile_total": "total profile deviation F_α",
    }
    entries |= {
        "trace_deviation": (
            ("trace", "flank_point"),
            traces.added,
            "m",
            "measured deviation, > 0 outside",
        ),
        "trace_name": (("trace",), [chart.hand(k) for k in range(len(traces.flank))]),
        "trace_flank": (("trace",), list(traces.flank)),
        "trace_tooth": (("trace",), np.array(traces.tooth), "1", "number of the tooth"),
        "iso_class": (
            ("trace",),
            np.array([grade or 0 for _, grade in rows_]),
            "1",
            "class of ISO 1328-1:2013, 0: none",
        ),
    }
    for place, (name, text) in enumerate(words.items()):
        values = np.array([figure[place] for figure, _ in rows_])
        entries[name] = (("trace",), values, "m", text)
    for place, (name, values) in enumerate(chart.read.pitch.items(), 1):
        use = "acts" if name == chart.acting_pitch else "kept and not used"
        entries[f"pitch_{place}"] = (("tooth",), values, "m", f"{name}, {use}")
    coordinates: dict[str, Any] = {
        "roll_path": (("flank_point",), rho, "m", "roll path from the base circle"),
        "diameter": (("flank_point",), 2.0 * np.hypot(gear.base_radius, rho), "m", "diameter"),
    }
    ends = 2.0 * np.hypot(gear.base_radius, np.array([low, high]))
    about = {
        "gear": chart.gear,
        "files": ", ".join(chart.names),
        "evaluated_from": float(ends[0]),
        "evaluated_to": float(ends[1]),
        "pitch_diameter": 2.0 * float(np.hypot(gear.base_radius, pitch)),
    }
    data = label(entries, coordinates, about)
    data["iso_class"].attrs |= NO_COUNT
    return data


def measured_notices(case: GearCase) -> Iterator[Notice]:
    """What of a chart acts, what was decided for it, and what is left out."""
    for chart in case.charts:
        gear, name = _gear(case.pair, chart.gear), f"{chart.gear} flanks"
        for measured in chart.flanks:
            yield Notice.of(
                "flank_as_measured",
                about=name,
                flank=measured.flank,
                traces=chart.traces.flank.count(measured.flank),
                cutoff=measured.cutoff,
                part=(measured.rho[-1] - measured.rho[0]) / measured.cutoff,
                noise=measured.noise,
            )
        ends, stated = (
            None if range_ is None else [2.0 * np.hypot(gear.base_radius, range_)]
            for range_ in (chart.range, chart.traces.range)
        )
        yield Notice.of(
            "flanks_evaluated",
            about=name,
            files=list(chart.names),
            diameters=ends,
            stated=stated,
        )
        if not chart.read.signed:
            yield Notice.of("sign_not_stated", about=name)
        limited = [measured.flank for measured in chart.flanks if measured.limited]
        if limited:
            yield Notice.of("traces_noisy", about=name, flanks=limited)
        for flank in {"drive", "back"} - {measured.flank for measured in chart.flanks}:
            yield Notice.of("flank_not_measured", about=name, flank=flank)
        if any(
            isinstance(deviation, Relief) and deviation.gear == chart.gear
            for deviation in case.deviations
        ):
            yield Notice.of("relief_on_traces", about=name)
        if chart.acting_pitch is not None:
            yield Notice.of("pitch_as_measured", about=name, deviations=chart.acting_pitch)
        if others := [column for column in chart.read.pitch if column != chart.acting_pitch]:
            yield Notice.of("pitch_not_used", about=name, deviations=others)


def _gear(pair: GearPair, name: str) -> Gear:
    return pair.pinion if name == "pinion" else pair.wheel
