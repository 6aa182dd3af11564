"""The page of a survey of friction laws: every law along the path, with its range."""

from __future__ import annotations

from functools import partial
from typing import Any

from thermogear.base.arrays import Dataset
from thermogear.base.display import Display, number
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, by_name, declared, key
from thermogear.views.page import Page, Shown
from thermogear.views.pages import captions
from thermogear.views.pages import survey_captions as words
from thermogear.views.pages.survey import operating_rows, survey
from thermogear.views.plots import laws
from thermogear.views.style import names_of
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
            words.LAWS,
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
    outside = data["outside_range"].mean("path_position").values > 0.0
    laws_found = [
        row | {"mean": mean, "outside": beyond}
        for row, mean, beyond in zip(rows, data["mean_friction"].values, outside, strict=True)
    ]
    by_point = [Column(name, partial(_mean, place=place)) for place, name in enumerate(names)]
    law = Column("law", "law")
    about = (
        Column("regime", "regime"),
        Column("range", lambda row: row["range"] or "none given"),
        Column("source", "source"),
    )
    caption = "Every law: regime it is made for, range its source gives, mean by sliding power."
    table = declared(
        caption,
        [law, *about, *by_point],
        laws_found,
        names=4,
        marked=lambda row: row["law"] == data.attrs["chosen"],
        wordy=True,
    )
    regimes = declared(
        "Share of the path in each regime [%].",
        [
            Column("operating point", "operating"),
            *(
                Column(name, name, ".1f", Display("", 100.0))
                for name in names_of(data, "regime_name")
            ),
        ],
        [{"operating": n, **row} for n, row in zip(names, _regime_shares(data), strict=True)],
    )
    summary = (
        f"{len(rows)} laws at {words.several(len(names), 'operating point')}; the case computes "
        f"with {data.attrs['chosen']}."
    )
    if len(names) > MOST_PICTURES:
        summary += f" The first {MOST_PICTURES} points have a picture of their own."
    means_alone = declared(
        "Mean friction coefficient by sliding power.", [law, *by_point], laws_found
    )
    return survey(
        result,
        summary,
        pictures,
        [table, regimes],
        numbers=partial(_numbers, data),
        told=[means_alone, regimes],
    )


def _mean(row: Row, place: int) -> str:
    """The mean coefficient of a law at an operating point; "outside" its source's range."""
    return number(row["mean"][place]) + " (outside)" * bool(row["outside"][place])


def _regime_shares(data: Dataset) -> list[dict[str, float]]:
    """The share of the path in each regime, by its name, of every operating point."""
    names = names_of(data, "regime_name")
    return [dict(zip(names, row.tolist(), strict=True)) for row in data["regime_share"].values]


def _numbers(data: Dataset) -> dict[str, Any]:
    return {
        "operating": operating_rows(data),
        "laws": [by_name(data.sel(law=law), OF_LAW) for law in names_of(data, "law")],
        "regime_share": _regime_shares(data),
    }


OF_LAW = (key("law"), key("mean_friction"))
