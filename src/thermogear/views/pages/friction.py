"""The page of a survey of friction laws: every law along the path, with its range."""

from __future__ import annotations

from functools import partial
from typing import Any

from thermogear.base.display import number
from thermogear.results.result import Result
from thermogear.views.page import Page, Shown, Table
from thermogear.views.pages import captions
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import (
    digits,
    operating_rows,
    survey,
)
from thermogear.views.plots import laws
from thermogear.views.typesetting import operating_names

MOST_PICTURES = 4
"""Operating points that get a picture of their own."""


KINDS = ("friction",)


def page(result: Result) -> Page:
    """All friction laws with their ranges."""
    data = result.groups["laws"]
    rows = result.rows("laws")
    means = frozenset(row["law"] for row in rows if "mean of the mesh" in row["regime"])
    names = operating_names(data)
    pictures = [
        Shown(
            f"laws_{place + 1}",
            f"Friction laws at {names[place]}",
            words.laws(data, place, means),
            partial(laws.laws, data, place, means),
            wide=True,
        )
        for place in range(min(len(names), MOST_PICTURES))
    ]
    pictures.append(
        Shown(
            "film",
            "Film parameter along the path",
            "Least film thickness over the combined rms roughness; below 1 boundary, from 3 on a "
            f"full film. {captions.regimes(data)}".strip(),
            partial(laws.film, data),
        )
    )
    mean = data["mean_friction"].values
    share = 100.0 * data["outside_range"].mean("path_position").values
    table = Table(
        "Every law: regime it is made for, range its source gives, mean by sliding power.",
        ["law", "regime", "range", "source", *names],
        [
            [
                row["law"],
                row["regime"],
                row["range"] or "none given",
                row["source"],
                *(
                    number(float(mean[i, o])) + (" (outside)" if share[i, o] > 0.0 else "")
                    for o in range(len(names))
                ),
            ]
            for i, row in enumerate(rows)
        ],
        names=4,
        marked=frozenset(i for i, row in enumerate(rows) if row["law"] == data.attrs["chosen"]),
        wordy=True,
    )
    regimes = Table(
        "Share of the path in each regime [%].",
        ["operating point", *(str(n) for n in data["regime_name"].values)],
        [
            [name, *(f"{100.0 * float(v):.1f}" for v in data["regime_share"].values[o])]
            for o, name in enumerate(names)
        ],
    )
    summary = (
        f"{len(rows)} laws at {words.several(len(names), 'operating point')}; the case computes "
        f"with {data.attrs['chosen']} (marked)."
    )
    if len(names) > MOST_PICTURES:
        summary += f" The first {MOST_PICTURES} points have a picture of their own."
    return survey(result, summary, pictures, [table, regimes], numbers=_numbers, lines=_lines)


def _numbers(result: Result) -> dict[str, Any]:
    data = result.groups["laws"]
    rows: list[dict[str, Any]] = []
    for law in data["law"].values:
        mean = data["mean_friction"].sel(law=law).values
        rows.append({"law": str(law), "mean_friction": [float(v) for v in mean]})
    return {
        "operating": operating_rows(data),
        "laws": rows,
        "regime_share": [
            dict(zip(map(str, data["regime_name"].values), map(float, shares), strict=True))
            for shares in data["regime_share"].values
        ],
    }


def _lines(result: Result) -> list[str]:
    found = _numbers(result)
    names = [
        f"{one['pinion_speed_rpm']:.0f} rpm {one['pinion_torque_Nm']:.4g} N m"
        for one in found["operating"]
    ]
    lines = [f"{'law':<18}" + "".join(f"{name:>22}" for name in names)]
    for row in found["laws"]:
        cells = "".join(f"{digits(v):>22}" for v in row["mean_friction"])
        lines.append(f"{row['law']:<18}{cells}")
    for name, shares in zip(names, found["regime_share"], strict=True):
        told = ", ".join(f"{100.0 * v:.0f} % {k}" for k, v in shares.items())
        lines.append(f"{name}: {told}")
    return lines
