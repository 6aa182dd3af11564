"""The page of a diagnosis: verdict, indicators beside their limits, teeth, envelope, cepstrum."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import (
    DEGREE,
    MILLIMETRE_PER_SECOND,
    PERCENT,
    SPEED,
    exactly,
    number,
)
from thermogear.results.result import Result
from thermogear.results.tables import csv_text, rows_along
from thermogear.views.columns import PLAIN, Column, Row, declared
from thermogear.views.page import Page, Pictures, Section, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, OKABE_ITO, QUIET, WIDE

KINDS = ("diagnosis",)

WORDS = {
    "fm0": "FM0",
    "fm4": "FM4",
    "m6a": "M6A",
    "m8a": "M8A",
    "na4": "NA4",
    "energy_ratio": "energy ratio",
    "energy_operator": "energy operator (EOP)",
    "sideband_ratio": "sideband ratio",
    "sideband_index": "sideband index",
    "amplitude_depth": "amplitude modulation",
    "phase_depth": "phase modulation",
    "rms": "rms",
    "residual_rms": "rms of the residual",
    "kurtosis": "kurtosis",
    "crest": "crest factor",
}
"""Indicators as a reader knows them."""
OPEN = ("verdict", "where", "simulated")
"""Tables that are unfolded."""
_ORDERS = 8  # of those removed that are told


def page(result: Result) -> Page:
    """Verdict first, then where, the indicators, and what they were read from."""
    figures = result.table("figures")
    pictures = Pictures()
    for shaft in ("pinion", "wheel"):
        data = result.group(shaft)
        if data is None:
            continue
        pictures.add(
            f"turn_{shaft}",
            f"One turn of the {shaft}",
            "Synchronous average of the last record, and its difference signal: mean, shaft "
            "orders, mesh harmonics and their first sidebands taken out. The axis counts teeth.",
            data,
            ["average", "difference"],
            partial(turn, data, result.text("unit")),
        )
        pictures.add(
            f"teeth_{shaft}",
            f"Mesh harmonics over the {shaft}'s turn",
            "Demodulated amplitude over its mean, and phase over the harmonic's number, tooth by "
            "tooth: a tooth that yields has a dip and the same delay in every harmonic.",
            data,
            ["mesh_amplitude", "mesh_phase_error"],
            partial(demodulated, data),
        )
    pictures.add(
        "envelope",
        "Squared envelope",
        "What is no line of a gear, in the band told below: lines of its squared envelope over "
        "noise. Upright: rates of the bearings named.",
        result.groups["envelope"],
        ["envelope_amplitude"],
        partial(envelope, result.groups["envelope"], figures["bearings"]),
    )
    pictures.add(
        "cepstrum",
        "Cepstrum",
        "A family of lines at one distance is a peak at the quefrency of its turn.",
        result.groups["cepstrum"],
        ["cepstrum"],
        partial(cepstrum, result.groups["cepstrum"]),
    )
    tables = _tables(result, figures)
    sections = [
        Section("pictures", "In pictures", pictures.take(), folded=False),
        *(
            Section(
                name,
                name.capitalize(),
                [table],
                folded=name not in ("verdict", "where", "simulated"),
            )
            for name, table in tables.items()
        ),
    ]
    return Page(
        result,
        summary(figures),
        sections,
        numbers=lambda: {
            **figures,
            "indicators": rows_along(result.groups["indicators"], "record", "row"),
            "simulated": _simulated(result),
        },
        tables=lambda: {
            f"csv/{name}.csv": csv_text(data.to_dataframe())
            for name, data in result.groups.items()
            if name == "simulated"
        },
        told=lambda: [Text(summary(figures)), *_tables(result, figures, last=True).values()],
    )


def summary(figures: dict[str, Any]) -> str:
    """The verdict on the last record in two or three sentences."""
    last = figures["verdicts"][-1]
    value, healthy = last["unlike"]
    of = f"{last['above']} of {last['indicators']} indicators are above every healthy average"
    scatter = (
        f" and {last['below']} below. A fault seldom lowers them: is it this machine, with these "
        "gears?"
        if last["below"]
        else ", and none is beyond what records of this baseline may scatter. Further healthy "
        "records narrow that."
    )
    rest = {
        "no baseline": "No verdict: no indicator has a limit that holds for every machine. Give "
        "healthy records of this machine by --baseline.",
        "one baseline record": f"Undecided: {of}. One record of the baseline does not tell how "
        "much one assembly, or one day, differs from the next; give further ones.",
        "undecided": f"Undecided: {of}{scatter}",
        "another level": f"Undecided: its rms is {value:.2g} times that of the baseline, so that "
        "load, gain or noise are others. Give a baseline like it.",
        "another speed": f"Undecided: it turns at {SPEED(value):.0f} rpm, the baseline at "
        f"{SPEED(healthy):.0f} rpm, so that what differs is not the gears' alone. Give a baseline "
        "like it.",
        "other gears": f"Undecided: its mesh line is order {value:.4g} of the shaft, that of the "
        f"baseline order {healthy:.4g}: other gears, or the tacho on another shaft. Give a "
        "baseline of this machine.",
        "no change": "No change: no indicator is above or below every healthy average.",
        "changed": f"Changed: {last['beyond']} of {last['indicators']} indicators are beyond their "
        f"limits, most on the {last['shaft']}.",
    }[last["verdict"]]
    spare = ""
    if len(figures["baseline"]) > 1 and last["verdict"] in ("undecided", "no change", "changed"):
        spare = (
            f" In at most {PERCENT(figures['alarm']):g} % of healthy records would any of them be "
            "beyond its limit, where logarithms scatter normally from record to record."
        )
    heard = [
        f"T{row['words'][1:]}; the baseline has not."
        for row in figures["bearings"]
        if row["record"] == last["record"] and figures["baseline"] and not row["in_baseline"]
    ]
    parts = (f"{last['record']}: {rest}{spare}", _where(figures, last), *heard)
    return " ".join(part for part in parts if part)


def _where(figures: dict[str, Any], last: dict[str, Any]) -> str:
    """The tooth of the shaft that changed, in a sentence; "" where none is named."""
    for place in figures["places"]:
        if place["record"] == last["record"] and place["shaft"] == last["shaft"] and place["named"]:
            alike = " Its delay is alike in two mesh harmonics or more." if place["alike"] else ""
            zero = (
                "tooth 1 is arbitrary"
                if not place["marked"]
                else "from the tacho's pulse on"
                if place["shaft"] == "pinion"
                else "from the first pulse of this record on"
            )
            return (
                f"The difference signal is greatest at tooth {place['tooth']} of the "
                f"{place['shaft']} ({zero}), in {place['agreeing']} of {place['averages']} "
                f"averages.{alike}"
            )
    return ""


def _tables(result: Result, figures: dict[str, Any], *, last: bool = False) -> dict[str, Table]:
    """Verdicts, places, indicators (of the ``last`` record alone), bearings, trends, channels,
    averages: as far as there are."""
    unit = result.text("unit") or "file's unit"
    indicators = result.groups["indicators"]
    rows = rows_along(indicators.isel(record=[-1]) if last else indicators, "record", "row")
    record = Column("record", "record")
    listed = {
        "verdict": declared(
            "Of each record: how many indicators are beyond their limits, and above and below all "
            "of the baseline.",
            (
                record,
                Column("verdict", "verdict"),
                Column("shaft", lambda row: row["shaft"] or "–"),
                Column("beyond", "beyond"),
                Column("above", "above"),
                Column("below", "below"),
                Column("of", "indicators"),
            ),
            figures["verdicts"],
            names=3,
        ),
        "where": declared(
            "The tooth at which the difference signal is greatest, in how many averages, and the "
            "chance of as many in noise. A sound gear has such a tooth, too: teeth differ. It is "
            "a fault's only where the verdict names its shaft. Change of amplitude and delay "
            "there, of mesh harmonics 1, 2, 3 (0: not clear of the other teeth), and modulation of "
            "amplitude and timing over the turn; after ± what noise may make of either, 95 %.",
            (
                record,
                Column("shaft", "shaft"),
                Column("channel", "channel"),
                *(
                    Column(head, partial(_listed, name=name, wide=f"{wide}_half_width"))
                    for head, name, wide in (
                        ("amplitude [%]", "amplitude", "amplitude"),
                        ("delay [% of a pitch]", "delay", "delay"),
                        ("modulation [%]", "depth", "amplitude"),
                        ("of timing [% of a pitch]", "timing", "delay"),
                    )
                ),
                Column("tooth", "tooth"),
                Column("averages", lambda row: f"{row['agreeing']} of {row['averages']}"),
                Column("chance", "chance", 2),
            ),
            figures["places"],
            names=5,
            marked=lambda row: row["named"],
        ),
        "indicators": declared(
            f"Medians over the averages; rms and sideband index in {unit}, phase modulation in "
            "degrees of the mesh order. Those without a limit decide nothing. Gaussian noise has "
            "FM4 3, M6A 15, M8A 105, EOP 9.",
            (
                record,
                Column("shaft", "shaft"),
                Column("indicator", lambda row: WORDS[row["indicator"]]),
                Column("channel", "channel"),
                *(
                    Column(head, partial(_value, name=name), 4, PLAIN)
                    for head, name in (
                        ("value", "indicator_value"),
                        ("healthy from", "healthy_least"),
                        ("to", "healthy_greatest"),
                        ("limit", "indicator_limit"),
                    )
                ),
            ),
            rows,
            names=4,
            marked=lambda row: bool(row["indicator_beyond"]),
        ),
        "simulated": declared(
            "The same of the computed acceleration of the teeth, with all faults of the case at "
            "once and without, beside what was measured: compare the changes. The motion has no "
            "noise and no way to a sensor, which make a record's changes less; no verdict is made.",
            (
                Column("shaft", "shaft"),
                Column("indicator", lambda row: WORDS[row["indicator"]]),
                Column("channel", "channel"),
                *(
                    Column(f"{side} {name}", partial(_value, name=f"{side}_{name}"), 4, PLAIN)
                    for side, other in (("measured", "suspect"), ("simulated", "fault"))
                    for name in ("healthy", other)
                ),
                *(
                    Column(f"change {side}", f"{side}_change", "+.3g", PERCENT)
                    for side in ("measured", "simulated")
                ),
            ),
            _simulated(result),
            names=3,
        ),
        "bearings": declared(
            "Lines of the envelope within 2 % of a bearing's rate; orders of the bearing's shaft.",
            (
                record,
                Column("bearing", "bearing"),
                Column("shaft", "shaft"),
                Column("part", "part"),
                Column("in baseline", lambda row: "yes" if row["in_baseline"] else "no"),
                Column("rate", "expected", ".4f", PLAIN),
                Column("line", "order", ".4f", PLAIN),
                Column("over noise", "level", 3),
                Column("chance", "chance", 2),
            ),
            figures["bearings"],
            names=5,
        ),
        "trends": declared(
            "Over the records in their order: what rises or falls with a chance of at most 5 %, "
            "counted over all indicators.",
            (
                Column("channel", "channel"),
                Column("shaft", "shaft"),
                Column("indicator", lambda row: WORDS[row["indicator"]]),
                Column("from record to record", "trend", "+.2f", PERCENT),
                Column("chance", "chance", 2),
            ),
            figures["trends"],
            names=3,
        ),
        "channels": declared(
            "Of the whole record: kurtosis, crest factor, velocity (rms, 10 to 1000 Hz, from 2 Hz "
            "below 600 rpm)"
            + (f", zone of ISO 10816-3, {figures['machine']}." if figures["machine"] else "."),
            (
                record,
                Column("channel", "channel"),
                Column("zone", lambda row: row["zone"] or "–"),
                Column("kurtosis", "raw_kurtosis", 4, PLAIN),
                Column("crest factor", "raw_crest", 4, PLAIN),
                Column("velocity", "velocity_rms", 3, MILLIMETRE_PER_SECOND),
            ),
            figures["raw"],
            names=3,
        ),
        "averages": declared(
            f"How the averages were made; angle by {figures['angle']}, its noise "
            f"{number(figures['angle_noise'], 2)} turns. Removed: orders taken out of the "
            "residual, and with their sidebands out of the difference.",
            AVERAGES,
            figures["shafts"],
            names=3,
        ),
        "bands": declared(
            "Orders of the pinion between which the envelope was taken.",
            (
                Column("channel", "channel"),
                Column("chosen by", lambda row: _chosen(row)),
                Column("from", "low", 4, PLAIN),
                Column("to", "high", 4, PLAIN),
                Column("spectral kurtosis", "kurtosis", 3, PLAIN),
            ),
            figures["bands"],
            names=2,
        ),
    }
    return {name: table for name, table in listed.items() if table.rows}


def _simulated(result: Result) -> Sequence[Row]:
    """Rows of the group ``simulated``, which a comparison alone has."""
    data = result.group("simulated")
    return () if data is None else rows_along(data, "row")


def _chosen(row: Row) -> str:
    if not row["chosen"]:
        return "none stands out"
    return "kurtogram" if np.isfinite(row["kurtosis"]) else "given"


def _removed(row: Row, name: str) -> str:
    orders = [f"{order}" for order in row[name][:_ORDERS]]
    return ", ".join(orders) + ", ..." * (len(row[name]) > _ORDERS)


AVERAGES = (
    Column("shaft", "shaft"),
    Column("removed", partial(_removed, name="removed")),
    Column("sidebands", partial(_removed, name="removed_sidebands")),
    Column("teeth", "teeth"),
    Column("turns", "turns"),
    Column("turns of one of several", "block_turns"),
    Column("averages", "blocks"),
    Column("leakage of the other shaft", "leakage", 2, PERCENT),
    Column("highest order", "highest"),
    Column("FM4 of noise ±", "scatter", 2, PLAIN),
)


def _value(row: Row, name: str) -> float:
    """An indicator as shown: the phase's depth in degrees."""
    value = float(row[name])
    return DEGREE(value) if row["indicator"] == "phase_depth" else value


def _listed(row: Row, name: str, wide: str) -> str:
    pairs = zip(row[name], row[wide], strict=True)
    shown = [f"{exactly(PERCENT(v), 2)} ± {exactly(PERCENT(w), 1)}" for v, w in pairs]
    return ", ".join(shown) or "–"


# --- pictures -----------------------------------------------------------------------------------


def turn(data: Dataset, unit: str) -> Picture:
    """The average of the first channel over a turn, and its difference signal below."""
    x = data["teeth_turned"].values + 1.0
    panels = []
    for name, colour in (("average", COLD), ("difference", HOT)):
        panel = Panel(Axis("tooth [–]"), Axis(f"{name} [{unit or 'unit of the file'}]"))
        panel.curve(x, data[name].values[0], colour=colour, width=0.9)
        panels.append([panel])
    return Picture(panels, size=(WIDE / 2, 4.4), share_x="column")


def demodulated(data: Dataset) -> Picture:
    """Amplitude and phase of the mesh harmonics over a turn, of the first channel."""
    x = data["teeth_turned"].values + 1.0
    amplitude = Panel(Axis("tooth [–]"), Axis("amplitude over its mean [–]"))
    phase = Panel(Axis("tooth [–]"), Axis("phase over the harmonic [°]"))
    for place, k in enumerate(data["harmonic"].values):
        a = data["mesh_amplitude"].values[place, 0]
        turned = DEGREE(data["mesh_phase_error"].values[place, 0]) / k
        colour = OKABE_ITO[place]
        amplitude.curve(x, a / max(float(a.mean()), 1e-300), colour=colour, label=f"mesh × {k}")
        phase.curve(x, turned, colour=colour)
    return Picture([[amplitude], [phase]], size=(WIDE / 2, 4.4), share_x="column")


def envelope(data: Dataset, bearings: list[dict[str, Any]]) -> Picture:
    """The squared envelope's spectrum and the floor of noise, with the bearings' lines."""
    panel = Panel(Axis("order of the pinion [–]"), Axis("squared envelope over its mean [–]"))
    x = data["envelope_order"].values
    panel.curve(x, data["envelope_amplitude"].values, colour=COLD, width=0.8)
    panel.curve(x, data["envelope_floor"].values, colour=QUIET, width=0.8, label="noise")
    for place, row in enumerate(bearings[: len(OKABE_ITO) - 1], start=1):
        words = f"{row['bearing']} {row['part']}"
        if row["shaft"] == "pinion":
            panel.line(x=row["order"], colour=OKABE_ITO[place], width=0.9, label=words)
    return Picture([[panel]], size=(WIDE / 2, 3.4), legend=2)


def cepstrum(data: Dataset) -> Picture:
    """The cepstrum of the first channels over turns of the pinion."""
    panel = Panel(Axis("quefrency, turns of the pinion [–]"), Axis("cepstrum [–]"))
    for row, colour in zip(data["cepstrum"].values, OKABE_ITO, strict=False):
        panel.curve(data["turns"].values, row, colour=colour, width=0.8)
    near = np.abs(data["cepstrum"].values[:, data["turns"].values > 0.05])
    if near.size:
        top = 1.2 * float(near.max())
        panel.y.low, panel.y.high = -top, top
    return Picture([[panel]], size=(WIDE / 2, 3.4))
