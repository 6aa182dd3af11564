"""The page of a detection table: what sees which fault, from which size on, hot and undeformed."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, SPEED
from thermogear.results.result import Result
from thermogear.results.tables import csv_text, frames
from thermogear.views.columns import Column, declared, rows_along
from thermogear.views.page import LEAD, Gallery, Page, Section, Shown, Table, Text
from thermogear.views.pages.background import case_file
from thermogear.views.pages.diagnosis import WORDS
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, WIDE, names_of, scale

KINDS = ("detect",)
SEEN = 0.95
"""Share of the parts from which a fault counts as seen, as it was counted."""
COUNTED = (
    "detected", "judged", "detected_share", "detected_low", "detected_high", "shift",
)  # fmt: skip
ALONG = ("question", "state", "pinion_speed", "pinion_torque")
STATES = {"hot": HOT, "undeformed": COLD}


def page(result: Result) -> Page:
    """Smallest sizes first, the shares as a heat table, shares over size hot and cold."""
    data = result.data
    at = data.isel(pinion_speed=0, pinion_torque=(data.sizes["pinion_torque"] - 1) // 2)
    where = (
        f"At {SPEED(float(at['pinion_speed'])):.6g} rpm and {float(at['pinion_torque']):.4g} N m, "
        "relative acceleration of the flanks."
    )
    shares = (
        f"{where} Share of parts beyond a limit that healthy ones keep in 95 of 100 cases; first "
        "row: false alarms. Last column: the loudest tooth is the faulty one or a neighbour."
    )
    curves = (
        f"{where} Same machine, the indicator that sees most of each fault; bands hold the share "
        "with a confidence of 95 %. Dashed: another machine of the class."
    )
    pictures = [
        Shown("shares", "What sees what", shares, partial(heat_table, at), wide=True),
        Shown("sizes", "Over the size, hot and undeformed", curves, partial(over_size, at)),
    ]
    tables = [smallest(data), hot_or_cold(data)]
    told = [smallest(at), tables[1]]
    return Page(
        result,
        summary(data),
        [
            Section(LEAD, "In pictures", [Gallery([one]) for one in pictures], folded=False),
            Section("smallest", "Smallest sizes seen", list(tables), folded=False),
            case_file(result),
        ],
        numbers=lambda: {
            "parts": int(data.attrs["parts"]),
            "noise": dict(
                zip(names_of(data, "signal"), data["noise"].values.tolist(), strict=True)
            ),
            "smallest": first_seen(data),
            "shares": rows_along(data[[*COUNTED]], *ALONG, "variant", "signal", "sight"),
        },
        told=lambda: [Text(summary(data)), *told],
        tables=lambda: {
            f"detect_{'smallest' if 'fault' in dims else 'shares'}.csv": csv_text(frame)
            for dims, frame in frames(data[[*COUNTED, "smallest"]]).items()
        },
        files=("svg", "png"),
    )


def first_seen(data: Dataset) -> list[dict[str, Any]]:
    """Of each fault, question, state, load and signal: the smallest size, and what sees it there.

    ``tooth``: the smallest size from which on the tooth is found; over the largest, like ``size``.
    """
    faults, dims = names_of(data, "fault"), [dim for dim in ALONG if dim in data.dims]
    ends = np.cumsum(np.atleast_1d(data.attrs["families"]))
    variants = np.split(np.array(names_of(data, "variant"))[1:], ends[:-1])
    sizes = np.split(data["relative_size"].values[1:], ends[:-1])
    rows = []
    for row in rows_along(data[["smallest"]].isel(sight=0, drop=True), *dims, "fault", "signal"):
        place = {name: row[name] for name in (*dims, "fault", "signal")}
        values = data["smallest"].sel(place).values
        least = np.fmin.reduce(values[:-1])
        of = faults.index(row["fault"])
        words = dict(zip(sizes[of].tolist(), variants[of].tolist(), strict=True))
        by = np.array(names_of(data, "sight"))[:-1][values[:-1] == least]
        rows.append(
            place
            | {
                "size": float(least), "seen": words.get(float(least), ""),
                "by": [str(name) for name in by], "tooth": float(values[-1]),
                "tooth_seen": words.get(float(values[-1]), ""),
            }
        )  # fmt: skip
    return rows


def smallest(data: Dataset) -> Table:
    """The smallest size of every fault that is seen, by what, and that whose tooth is found."""
    parts = int(data.attrs["parts"])
    rows = first_seen(data)
    columns = (
        Column("fault", "fault"),
        Column("compared with", "question"),
        Column("state", "state"),
        Column("signal", lambda row: row["signal"].replace("_", " ")),
        Column("seen from", lambda row: _size(row["seen"], row["fault"])),
        Column("by", lambda row: ", ".join(WORDS[name] for name in row["by"][:4]) or "–"),
        Column("tooth from", lambda row: _size(row["tooth_seen"], row["fault"])),
    )
    several = [dim for dim in ("pinion_speed", "pinion_torque") if dim in data.dims]
    heads = {"pinion_speed": Column("speed", "pinion_speed", ".6g", SPEED),
             "pinion_torque": Column("torque", "pinion_torque", ".4g")}  # fmt: skip
    least = PERCENT(0.05 ** (1.0 / parts))
    return declared(
        f"Seen: {SEEN:.0%} or more of {parts} parts beyond the limit (all of fewer than 20: the "
        f"share of all parts is then {least:.0f} to 100 %, 95 %), at this size and the larger "
        "ones. Tooth from: the loudest tooth is the faulty one or a neighbour in as many.",
        (*columns, *(heads[dim] for dim in several)),
        rows,
        names=len(columns),
    )


def _size(words: str, fault: str) -> str:
    """The size out of the words of a fault."""
    kind, _, where = fault.rpartition(", ")
    return words.removeprefix(f"{kind} of ").removesuffix(f", {where}") or "not seen"


def hot_or_cold(data: Dataset) -> Table:
    """What is seen in one state of heat and not in the other."""
    seen = data["detected_share"].isel(variant=slice(1, None)) >= SEEN
    hot, cold = (seen.sel(state=state) for state in STATES)
    rows = [
        {
            "question": question, "hot": int((one & ~other).sum()),
            "cold": int((other & ~one).sum()), "both": int((one & other).sum()),
            "neither": int((~one & ~other).sum()),
        }
        for question in names_of(data, "question")
        for one, other in [(hot.sel(question=question), cold.sel(question=question))]
    ]  # fmt: skip
    return declared(
        "Faults, sizes, loads, signals and sights that see them: hot and undeformed compared, the "
        "same parts and the same noise.",
        (
            Column("compared with", "question"),
            Column("seen hot alone", "hot"),
            Column("seen undeformed alone", "cold"),
            Column("seen in both", "both"),
            Column("in neither", "neither"),
        ),
        rows,
    )


def summary(data: Dataset) -> str:
    """The smallest sizes at the middle load, hot, in a sentence for each question."""
    at = data.isel(pinion_speed=0, pinion_torque=(data.sizes["pinion_torque"] - 1) // 2, signal=[0])
    sentences = []
    for question in names_of(at, "question"):
        rows = [
            row for row in first_seen(at) if row["question"] == question and row["state"] == "hot"
        ]
        words = [
            f"{row['seen']} ({WORDS[row['by'][0]]})" if row["by"] else f"{row['fault']}: not seen"
            for row in rows
        ]
        sentences.append(f"{question.capitalize()}, hot: {'; '.join(words)}.")
    return " ".join(sentences)


# --- pictures -----------------------------------------------------------------------------------


def heat_table(data: Dataset) -> Picture:
    """Shares of every fault and sight, hot and undeformed, of both questions."""
    sights, variants = names_of(data, "sight"), names_of(data, "variant")
    rows = []
    for question in names_of(data, "question"):
        panels: list[Panel] = []
        for state in STATES:
            shares = data["detected_share"].sel(question=question, state=state).values[:, 0]
            x, y = np.arange(len(sights)), np.arange(len(variants))
            panel = Panel(
                Axis("", ticks=x, names=[WORDS.get(name, name) for name in sights], slant=60.0,
                     low=-0.5, high=x[-1] + 0.5, grid=False),
                Axis("", ticks=-y[::-1], names=variants[::-1] if not panels else [""] * y.size,
                     low=-y[-1] - 0.5, high=0.5, grid=False),
                f"{question}, {state}",
            )  # fmt: skip
            panel.field(
                np.append(x - 0.5, x[-1] + 0.5), np.append(-y[::-1] - 0.5, 0.5),
                PERCENT(shares[::-1]), low=0.0, high=100.0, colours=scale("viridis"),
                words="parts detected [%]" if panels else "",
            )  # fmt: skip
            panels.append(panel)
        rows.append(panels)
    return Picture(rows, size=(1.6 * WIDE, 8.4), share_x="column")


def over_size(data: Dataset) -> Picture:
    """Share detected over the size of each fault, hot and undeformed, with intervals."""
    ends = np.cumsum([1, *np.atleast_1d(data.attrs["families"])])
    panels = []
    for place, fault in enumerate(names_of(data, "fault")):
        some = slice(int(ends[place]), int(ends[place + 1]))
        shares = data["detected_share"].isel(signal=0, variant=some, sight=slice(0, -1))
        best = int(np.argmax(shares.isel(question=0).sum(["state", "variant"]).values))
        name = names_of(data, "sight")[best]
        x = PERCENT(data["relative_size"].values[some])
        panel = Panel(
            Axis("size, of the largest [%]", low=0.0),
            Axis("parts detected [%]", low=0.0, high=105.0),
            f"{fault}: {WORDS[name]}",
        )  # fmt: skip
        for state, colour in STATES.items():
            here = data.isel(signal=0, variant=some, sight=best).sel(state=state)
            for question, dash in ((0, ()), (1, (4, 2))):
                low, share, high = (
                    PERCENT(here[f"detected_{end}"].values[question])
                    for end in ("low", "share", "high")
                )
                if not question:
                    panel.band(x, low=low, high=high, colour=colour, opacity=0.2)
                words = f"{state}, {names_of(data, 'question')[question]}" if not place else ""
                panel.curve(x, share, colour=colour, dash=dash, marker="circle", label=words)
        panels.append(panel)
    return Picture(
        [panels[first : first + 2] for first in range(0, len(panels), 2)],
        size=(WIDE, 3.6 * ((len(panels) + 1) // 2)), legend=4,
    )  # fmt: skip
