"""The page of a sensitivity study: which input that nobody stated decides which conclusion."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import SPEED
from thermogear.results.result import Result
from thermogear.views.columns import Column, Row, declared, rows_along
from thermogear.views.page import Block, Page, Pictures, Section, Text
from thermogear.views.pages.background import background
from thermogear.views.plots import claims as plots
from thermogear.views.typesetting import prose

if TYPE_CHECKING:
    import xarray as xr

KINDS = ("sensitivity",)


def page(result: Result) -> Page:
    """What decides what, the ranges, the indices."""
    sections = [sensitivity_section(result, Pictures()), *background(result)]
    data = result.groups["sensitivity"]
    return Page(
        result,
        _study_words(result),
        sections,
        numbers=lambda: _numbers(result),
        lines=lambda: [
            *(f"- {text}" for text in data["sentence"].values),
            f"{data.attrs['evaluations']} evaluations in {data.attrs['seconds']:.1f} s",
        ],
    )


def _study_words(results: Result) -> str:
    data = results.groups["sensitivity"]
    return (
        f"{int(data.attrs['evaluations'])} evaluations of the chain from friction to vibration at "
        f"{SPEED(float(data.attrs['speed'])):.0f} rpm in {float(data.attrs['seconds']):.0f} s; "
        f"intervals at {100 * float(data.attrs['confidence']):.0f} %. Every input runs through "
        "its whole range, independently of the others."
    )


def sensitivity_section(results: Result, pictures: Pictures) -> Section:
    data = results.groups["sensitivity"]
    blocks: list[Block] = [Text(_study_words(results))]
    blocks += [Text(prose(_capital(str(text)))) for text in data["sentence"].values]
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


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


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


def _strongest(data: xr.Dataset) -> list[Row]:
    """The strongest inputs of every result; one row without an index where none changes it."""
    rows: list[Row] = []
    for place in range(data.sizes["output"]):
        inputs = sorted(rows_along(data.isel(output=place), "input"), key=lambda row: -row["total"])
        nothing = {**inputs[0], "input_words": "none changes it"}
        found = [row for row in inputs[:4] if row["total"] >= 5e-4]
        rows += found or [{name: nothing[name] for name in ("output_words", "input_words")}]
    return rows


# --- figures as JSON wants them ---------------------------------------------------------------


def _numbers(result: Result) -> dict[str, Any]:
    """The study JSON-ready: settings, and for every output its spread, conclusion and ranking."""
    data = result.groups["sensitivity"]
    names = ("evaluations", "samples", "confidence", "seconds", "jammed", "speed", "seed")
    found: dict[str, Any] = {
        "thermogear": result.text("thermogear"),
        "title": result.title,
        "kind": result.kind,
        **{name: _number(data.attrs[name]) for name in names},
    }
    found["outputs"] = [
        {
            "output": str(output),
            "mean": float(here["mean"]),
            "low": float(here["low"]),
            "high": float(here["high"]),
            "unit": str(here["output_unit"].item()),
            "conclusion": str(here["conclusion"].item()),
            "holds": float(here["holds"]) if here["conclusion"].item() else None,
            "inputs": [
                {
                    "input": str(name),
                    "first_order": float(here["first_order"].sel(input=name)),
                    "first_order_conf": float(here["first_order_conf"].sel(input=name)),
                    "total": float(here["total"].sel(input=name)),
                    "total_conf": float(here["total_conf"].sel(input=name)),
                }
                for name in data["input"].values
            ],
        }
        for output in data["output"].values
        for here in (data.sel(output=output),)
    ]
    return found


def _number(value: object) -> float | int:
    number = float(np.asarray(value))
    return int(number) if number.is_integer() else number
