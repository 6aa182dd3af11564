"""The page of a sensitivity study: which input that nobody stated decides which conclusion."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import PERCENT, SPEED
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, declared, in_full, key, rows_along
from thermogear.views.page import Block, Page, Pictures, Section, Text
from thermogear.views.pages.background import background
from thermogear.views.plots import claims as plots
from thermogear.views.typesetting import prose

KINDS = ("sensitivity",)


def page(result: Result) -> Page:
    """What decides what, the ranges, the indices."""
    sections = [sensitivity_section(result, Pictures()), *background(result)]
    data = result.groups["sensitivity"]
    return Page(
        result,
        _study_words(result),
        sections,
        numbers=lambda: _numbers(data),
        told=lambda: map(Text, [_study_words(result), *data["sentence"].values.tolist()]),
    )


def _study_words(results: Result) -> str:
    data = results.groups["sensitivity"]
    return (
        f"{int(data.attrs['evaluations'])} evaluations of the chain from friction to vibration at "
        f"{SPEED(float(data.attrs['speed'])):.0f} rpm in {float(data.attrs['seconds']):.0f} s; "
        f"intervals at {PERCENT(float(data.attrs['confidence'])):.0f} %. Every input runs through "
        "its whole range, independently of the others."
    )


def sensitivity_section(results: Result, pictures: Pictures) -> Section:
    data = results.groups["sensitivity"]
    blocks: list[Block] = [Text(_study_words(results))]
    blocks += [
        Text(prose(f"{text[:1].upper()}{text[1:]}")) for text in data["sentence"].values.tolist()
    ]
    pictures.add(
        "sensitivity", "What decides what",
        "Total index [%] with its confidence interval: the share of a result's variance that goes "
        "with an input, alone and together with others. Cells without a number are below 1 %.",
        data, ("total",), lambda: plots.sensitivity(data), wide=True,
    )  # fmt: skip
    blocks += pictures.take()
    blocks.append(declared("The ranges, all ours.", RANGES, rows_along(data, "input")))
    caption = "The strongest inputs of every result, at most four, as indices between 0 and 1."
    blocks.append(declared(caption, INDICES, _strongest(data), names=2))
    return Section("sensitivity", "Which unstated inputs decide", blocks)


RANGES = (
    Column("input", "input_words"),
    Column("from", "input_low", 4),
    Column("to", "input_high", 4),
    Column("unit", "input_unit"),
)


def _index(name: str) -> Callable[[Row], str]:
    """A sensitivity index with its confidence interval; a dash for a result that none changes."""

    def words(row: Row) -> str:
        if name not in row:
            return "–"
        return f"{row[name] + 0.0:.3f} ± {row[f'{name}_conf']:.3f}".replace("-", "−")

    return words


INDICES = (
    Column("result", "output_words"),
    Column("input", "input_words"),
    Column("first order", _index("first_order")),
    Column("total", _index("total")),
)


def _strongest(data: Dataset) -> list[Row]:
    """The strongest inputs of every result; one row without an index where none changes it."""
    rows: list[Row] = []
    for place in range(data.sizes["output"]):
        inputs = sorted(rows_along(data.isel(output=place), "input"), key=lambda row: -row["total"])
        nothing = {**inputs[0], "input_words": "none changes it"}
        found = [row for row in inputs[:4] if row["total"] >= 5e-4]
        rows += found or [{name: nothing[name] for name in ("output_words", "input_words")}]
    return rows


# --- figures as JSON wants them ---------------------------------------------------------------

OF_OUTPUT = (
    key("output"),
    key("mean"),
    key("low"),
    key("high"),
    key("unit", "output_unit"),
    key("conclusion"),
    key("holds", lambda row: row["holds"] if row["conclusion"] else None),
)
OF_INPUT = tuple(map(key, ("input", "first_order", "first_order_conf", "total", "total_conf")))
SETTINGS = ("evaluations", "samples", "confidence", "seconds", "jammed", "speed", "seed")


def _numbers(data: Dataset) -> dict[str, Any]:
    """The study: settings, and for every output its spread, conclusion and ranking."""
    outputs = [
        {
            **in_full(OF_OUTPUT, row),
            "inputs": [
                in_full(OF_INPUT, each) for each in rows_along(data.isel(output=k), "input")
            ],
        }
        for k, row in enumerate(rows_along(data, "output"))
    ]
    return {**{name: np.asarray(data.attrs[name]).item() for name in SETTINGS}, "outputs": outputs}
