"""The page of a sensitivity study: which input that nobody stated decides which conclusion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from thermogear.base.display import number
from thermogear.base.units import RPM
from thermogear.results.result import Result
from thermogear.views.page import Block, Cell, Page, Pictures, Section, Table, Text
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
        f"{float(data.attrs['speed']) / RPM:.0f} rpm in {float(data.attrs['seconds']):.0f} s; "
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
    blocks.append(_ranges(data))
    blocks.append(_indices(data))
    return Section("sensitivity", "Which unstated inputs decide", blocks)


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _ranges(data: xr.Dataset) -> Table:
    rows = [
        [str(w), number(float(low), 4), number(float(high), 4), str(u)]
        for w, low, high, u in zip(
            data["input_words"].values, data["input_low"].values, data["input_high"].values,
            data["input_unit"].values, strict=True,
        )
    ]  # fmt: skip
    return Table("The ranges, all ours.", ["input", "from", "to", "unit"], rows)


def _indices(data: xr.Dataset) -> Table:
    rows: list[Sequence[Cell]] = []
    for o in range(data.sizes["output"]):
        one = data.isel(output=o)
        words = str(one["output_words"].item())
        strongest = np.argsort(-one["total"].values, kind="stable")[:4]
        told = [k for k in strongest if one["total"].values[k] >= 5e-4]
        for k in told:
            pair = [
                f"{float(one[n][k]) + 0.0:.3f} ± {float(one[f'{n}_conf'][k]):.3f}".replace("-", "−")
                for n in ("first_order", "total")
            ]
            rows.append([words, str(data["input_words"].values[k]), *pair])
        if not told:
            rows.append([words, "none changes it", "–", "–"])
    head = ["result", "input", "first order", "total"]
    return Table(
        "The strongest inputs of every result, at most four, as indices between 0 and 1.",
        head,
        rows,
        names=2,
    )


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
