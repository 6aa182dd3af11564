"""The thesis's experiment on sampled drive trains: the sentence, shares, assumptions."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, PERCENT, SPEED
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, by_name, declared, key, rows_along
from thermogear.views.page import Block, Pictures, Table, Text
from thermogear.views.picture import Axis, Panel, Picture
from thermogear.views.style import COLD, FAINT, HOT, INK, WIDE
from thermogear.views.typesetting import prose


def blocks(results: Result, pictures: Pictures) -> list[Block]:
    """What comes of it on the page, nothing where it was not computed."""
    data = results.group("rig_trains")
    if data is None:
        return []
    pictures.add(
        "rig-trains", "The experiment once more, with shafts and bearings",
        "Displacements at the mesh line that accelerometers show after two integrations, one thin "
        "line for each sampled drive train; right, what no accelerometer sees.",
        data, ("nearest",), lambda: displacements(data), wide=True,
    )  # fmt: skip
    decides = f"What decides it, by rank correlation: {data.attrs['deciding']}."
    nearest = float(data.attrs["open_nearest"])
    near = f"; the nearest of them is off by a factor {nearest:.2f}" if nearest == nearest else ""
    how = (
        f"Motions: {data.attrs['motions']}. Lines of a motion that did not close within 2048 mesh "
        f"periods are read over 64 of them: so on {data.attrs['open']} trains{near}. Every train "
        "is followed from rest, hot, with friction of the teeth and clearance of the bearings. "
        f"{data.attrs['fixed']}"
    )
    said = [Text(prose(text)) for text in (str(data.attrs["sentence"]), decides)]
    caption = "What is assumed of the rig, all ours unless said."
    assumed = declared(caption, ASSUMED, rows_along(data, "input"), names=3, wordy=True)
    drawn = [*pictures.take(), _shares(data), assumed]
    return [*said, *drawn, Text(prose(how))]


def _shares(data: Dataset) -> Table:
    by_limit = {
        f"within {float(limit):g}": rows_along(data.isel(limit=k), "seen")
        for k, limit in enumerate(data["limit"].values)
    }
    rows = [dict(zip(by_limit, each, strict=True)) for each in zip(*by_limit.values(), strict=True)]
    columns = [
        Column("seen by", lambda row: next(iter(row.values()))["seen_words"]),
        *(Column(limit, partial(_share, limit=limit)) for limit in by_limit),
    ]
    caption = (
        f"Of {data.attrs['trains']} sampled drive trains so many show 10.4, 19.3 and 48.5 µm "
        "within a factor, growing; in brackets the 95 % interval of the share."
    )
    return declared(caption, columns, rows)


def _share(row: Row, limit: str) -> str:
    """How many trains come within a limit, and the share of all with its interval."""
    names = ("share", "share_low", "share_high")
    share, low, high = (PERCENT(row[limit][name]) for name in names)
    return f"{int(row[limit]['hits'])}: {share:.1f} % ({low:.1f} to {high:.1f} %)"


ASSUMED = (
    Column("quantity", lambda row: prose(row["input_words"])),
    Column("range", lambda row: prose(row["input_range"])),
    Column("reason or source", lambda row: prose(row["input_why"])),
)


IN_JSON = tuple(map(key, ("hits", "share", "share_low", "share_high")))


def numbers(data: Dataset) -> dict[str, Any]:
    """The answer JSON-ready, with shares by place and factor."""
    limits = [f"{float(limit):g}" for limit in data["limit"].values]
    told = ("answer", "sentence", "deciding", "motions")
    return {
        **{name: str(data.attrs[name]) for name in told},
        "trains": int(data.attrs["trains"]),
        "lost": int(data.attrs["lost"]),
        "nearest_factor": float(np.min(data["needed_factor"].sel(seen="either").values)),
        "shares": by_name(data.assign_coords(limit=limits), IN_JSON, "seen", "limit"),
    }


# --- pictures -----------------------------------------------------------------------------------


def displacements(data: Dataset) -> Picture:
    """Every train's nearest channel over speed, the spread of the largest, and the printed ones."""
    rpm = SPEED(data["rig_speed"].values)
    panels = []
    for place, words in zip(data["place"].values, data["place_words"].values, strict=True):
        one = data.sel(place=place)
        panel = Panel(
            Axis("pinion speed [rpm]", ticks=rpm, names=[f"{v:.0f}" for v in rpm]),
            Axis(log="plain", low=0.01, high=100.0),
            str(words),
        )
        low, middle, high = (MICROMETRE(one["spread"].values[:, k]) for k in range(3))
        panel.band(
            rpm, low=low, high=high, colour=FAINT, order=0.5,
            label="largest of all channels, 5 to 95 % of the trains",
        )  # fmt: skip
        for number, line in enumerate(MICROMETRE(one["nearest"].values)):
            label = "nearest channel of each train" if number == 0 else ""
            panel.curve(rpm, line, colour=COLD, width=0.25, opacity=0.6, label=label)
        panel.curve(rpm, middle, colour=INK, width=1.6, dash=(4, 3), label="its median")
        panel.curve(rpm, MICROMETRE(data["printed"].values), colour=HOT, width=1.6)
        panel.points(
            rpm, MICROMETRE(data["printed"].values), colour=HOT, label="measured, as printed"
        )
        panels.append(panel)
    panels[0].y.words = "displacement at the mesh line [µm]"
    return Picture([panels], size=(WIDE, 3.4), share_y="row", between=0.2, legend=4)
