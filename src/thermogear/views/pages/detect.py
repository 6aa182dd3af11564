"""The page of a detection table: what sees which fault, from which size on, hot and undeformed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, SPEED
from thermogear.results.result import Result
from thermogear.results.tables import in_words
from thermogear.views.columns import Column, declared, rows_along
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages.diagnosis import WORDS
from thermogear.views.pages.survey import survey
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, HOT, WIDE, names_of, scale

KINDS = ("detect",)
SEEN = 0.95
"""Share of the parts beyond a limit from which a fault counts as seen."""
COUNTED = ("detected", "judged", "detected_share", "detected_low", "detected_high", "shift")
ALONG = ("question", "state", "pinion_speed", "pinion_torque")
STATES = {"hot": HOT, "undeformed": COLD}


def page(result: Result) -> Page:
    """Smallest sizes first, the shares as a heat table, shares over size hot and undeformed."""
    data = in_words(result.data)
    at = middle(data)
    where = (
        f"At {SPEED(at['pinion_speed'].item()):.6g} rpm and {at['pinion_torque'].item():.4g} N m, "
        "relative acceleration of the flanks."
    )
    shares = (
        f"{where} Share of parts above a limit that healthy ones keep (a fall does not count); "
        "rows without a fault are false alarms. Last columns: above any limit; the loudest tooth "
        "is the faulty one or a neighbour."
    )
    curves = (
        f"{where} The indicator that sees most of each fault; bands hold the share of all parts "
        "with a confidence of 95 %, of the same machine. Dashed: another machine of the class."
    )
    pictures = [
        Shown("shares", "What sees what", shares, partial(heat_table, at), wide=True),
        Shown("sizes", "Over the size, hot and undeformed", curves, partial(over_size, at)),
    ]
    counted = replace(result, groups={"": result.data[[*COUNTED, "relative_size", "noise"]]})
    return survey(
        counted,
        f"{summary(at)} {false_alarms(data)}",
        pictures,
        [smallest(data)],
        numbers=lambda: {
            "parts": int(data.attrs["parts"]),
            "noise": data["noise"].to_series().to_dict(),
            "smallest": first_seen(data),
            "shares": rows_along(at[[*COUNTED]], *ALONG, "variant", "signal", "sight"),
        },
        told=[smallest(at)],
    )


def middle(data: Dataset) -> Dataset:
    """What is shown of all speeds, loads and signals: the first, the middle, the acceleration."""
    load = (data.sizes["pinion_torque"] - 1) // 2
    return data.isel(pinion_speed=[0], pinion_torque=[load], signal=[0])


def first_seen(data: Dataset) -> list[dict[str, Any]]:
    """Of each fault, question, state, load and signal: the smallest size, and what sees it there.

    Seen are a size and all larger ones of the fault, by :data:`SEEN` of the parts or more.
    ``tooth``: the smallest size from which on the tooth is found. By "any" nothing counts as seen:
    it has too many false alarms.
    """
    sights, rows, dims = names_of(data, "sight"), [], (*ALONG, "signal")
    for fault, sizes in by_fault(data):
        seen = sizes["detected_share"].transpose("variant", *dims, "sight").values >= SEEN
        count = np.logical_and.accumulate(seen[::-1]).sum(axis=0)  # from the largest down
        words = [f"{fault}: not seen", *names_of(sizes, "variant")[::-1]]
        for place in np.ndindex(count.shape[:-1]):
            *each, _, tooth = count[place]
            by = [sights[n] for n in np.flatnonzero(each == max(each))] if any(each) else []
            at = {dim: data[dim].values[n].item() for dim, n in zip(dims, place, strict=True)}
            rows.append(
                {"fault": fault, **at, "seen": words[max(each)], "by": by, "tooth": words[tooth]}
            )
    return rows


def by_fault(data: Dataset) -> Iterator[tuple[str, Dataset]]:
    """Each fault with its variants, its sizes rising."""
    ends = np.cumsum([2, *np.ravel(data.attrs["families"])]).tolist()
    for name, first, end in zip(names_of(data, "fault"), ends, ends[1:], strict=False):
        yield name, data.isel(variant=slice(first, end))


def smallest(data: Dataset) -> Table:
    """The smallest size of every fault that is seen, by what, and that whose tooth is found."""
    parts = int(data.attrs["parts"])
    rows = first_seen(data)
    columns = (
        Column("compared with", "question"),
        Column("state", "state"),
        Column("signal", lambda row: row["signal"].replace("_", " ")),
        Column("seen from", "seen"),
        Column("by", lambda row: ", ".join(WORDS[name] for name in row["by"]) or "–"),
        Column("tooth from", "tooth"),
        Column("speed", "pinion_speed", ".6g", SPEED),
        Column("torque", "pinion_torque", ".4g"),
    )
    least = PERCENT(0.05 ** (1.0 / parts))
    return declared(
        f"Seen: above the limit of one indicator in 95 % or more of {parts} parts, all of fewer "
        f"than 20, at this size and the larger ones. All of {parts} say {least:.0f} to 100 % of "
        "all parts (95 %). Tooth from: the loudest tooth is the faulty one or a neighbour in as "
        "many; that raises no alarm, a sound gear has a loudest tooth, too.",
        columns,
        rows,
        names=6,
    )


def summary(data: Dataset) -> str:
    """The smallest sizes that are seen hot, in a sentence for each question, and the tooth of what
    is not seen."""
    rows = [row for row in first_seen(data) if row["state"] == "hot"]
    sizes = {
        question: "; ".join(
            row["seen"]
            + "".join(f" ({WORDS[name]})" for name in row["by"][:1])
            + f", its tooth found from {row['tooth'].partition(', ')[0]} on"
            * ("not seen" in row["seen"] and "not seen" not in row["tooth"])
            for row in rows
            if row["question"] == question
        )
        for question in names_of(data, "question")
    }
    return " ".join(f"{question.capitalize()}, hot: {words}." for question, words in sizes.items())


def false_alarms(data: Dataset) -> str:
    """How many sound averages are above any limit, at all speeds, loads and states, of both
    signals."""
    sound = (
        data[["detected", "judged"]]
        .isel(variant=slice(2), sight=-2)
        .sum(["state", "pinion_speed", "pinion_torque", "variant", "signal"])
    )
    low, high = sorted(PERCENT((sound["detected"] / sound["judged"]).values))
    return (
        f"Without a fault any of the {data.sizes['sight'] - 2} indicators is above its limit in "
        f"{low:.0f} to {high:.0f} % of the averages."
    )


# --- pictures -----------------------------------------------------------------------------------


def heat_table(data: Dataset) -> Picture:
    """Shares of every fault and sight, hot and undeformed, of both questions."""
    sights, variants = names_of(data, "sight"), names_of(data, "variant")
    x, y = np.arange(len(sights)), np.arange(len(variants))
    rows = []
    for question, shares in zip(
        names_of(data, "question"), data["detected_share"].values, strict=True
    ):
        rows.append([
            Panel(
                Axis(ticks=x, names=[WORDS.get(name, name) for name in sights], slant=90.0,
                     low=-0.5, high=x[-1] + 0.5, grid=False),
                Axis(ticks=y, names=variants[::-1] if state == "hot" else [""] * y.size,
                     low=-0.5, high=y[-1] + 0.5, grid=False),
                f"{question}, {state}",
            )
            for state in STATES
        ])  # fmt: skip
        for panel, values, words in zip(rows[-1], shares, ("", "parts detected [%]"), strict=True):
            panel.field(
                np.append(x, x.size) - 0.5, np.append(y, y.size) - 0.5,
                PERCENT(values[0, 0, ::-1, 0]), low=0.0, high=100.0, colours=scale("viridis"),
                words=words,
            )  # fmt: skip
    return Picture(rows, size=(1.5 * WIDE, 9.0), left=4.3, bottom=1.7, share_x="column")


def over_size(data: Dataset) -> Picture:
    """Share detected over the size of each fault, hot and undeformed, with intervals."""
    panels: list[Panel] = []
    for fault, sizes in by_fault(data.isel(pinion_speed=0, pinion_torque=0, signal=0)):
        best = int(np.argmax(sizes["detected_share"].values[0, ..., :-2].sum(axis=(0, 1))))
        low, share, high = (
            PERCENT(sizes[f"detected_{name}"].values[..., best])
            for name in ("low", "share", "high")
        )
        x, title = PERCENT(sizes["relative_size"].values), WORDS[names_of(data, "sight")[best]]
        panel = Panel(
            Axis("size, of the largest [%]"), Axis("parts detected [%]", low=0.0),
            f"{fault}: {title}",
        )  # fmt: skip
        for state, (words, colour) in enumerate(STATES.items()):
            panel.band(x, low=low[0, state], high=high[0, state], colour=colour, opacity=0.2)
            label = words * (not panels)
            panel.curve(x, share[0, state], colour=colour, marker="circle", label=label)
            panel.curve(x, share[1, state], colour=colour, marker="circle", dash=(4, 2))
        panels.append(panel)
    rows = [panels[first : first + 2] for first in range(0, len(panels), 2)]
    return Picture(rows, size=(WIDE, 3.6 * len(rows)), legend=2)
