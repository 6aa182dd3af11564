"""Pages, pictures and CSV files of the gear surveys, each drawn from one stored file."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.base.files import put
from thermogear.results.result import Results, read_tree
from thermogear.views.page import Block, Code, Gallery, Picture, Section, render
from thermogear.views.survey_sections import SURVEYS, Drawn, Survey
from thermogear.views.svg import draw, put_picture
from thermogear.views.words import prose

RESOLUTION = 160
"""Dots per inch of the PNG files."""


def write_survey(directory: Path, kind: str) -> list[Path]:
    """Draw everything of ``directory/kind.nc`` beside it; the files, the page first.

    ``kind.html`` needs no other file; every picture stands beside it as SVG and PNG, every
    table of numbers as CSV. Raises InputError where the file is missing, damaged or not ours.
    """
    directory = Path(directory)
    stored = read_survey(directory / f"{kind}.nc")
    survey = SURVEYS[stored.kind](stored.texts, stored.groups)
    written = [put(directory / f"{kind}.html", page(stored.texts, survey))]
    for one in survey.pictures:
        written += _files(directory, kind, one)
    for name, data in stored.groups.items():
        written += _tables(directory, f"{kind}_{name}", data)
    return written


def read_survey(path: Path) -> Results:
    """A stored survey, in memory."""
    found = read_tree(path)
    if "thermogear" not in found.texts or found.texts.get("kind") not in SURVEYS:
        raise InputError("results", str(path), why="it was not written by thermogear")
    return found


def page(texts: Mapping[str, Any], survey: Survey) -> str:
    """The whole page as text."""
    pictures: list[Block] = [Gallery([_picture(one)]) for one in survey.pictures if one.wide]
    small = [_picture(one) for one in survey.pictures if not one.wide]
    if small:
        pictures.append(Gallery(small))
    sections = [Section("pictures", "Pictures", pictures)]
    if survey.code:
        sections.append(Section("paste", "For the case file", [Code(survey.code)]))
    sections.append(Section("numbers", "Numbers", list(survey.tables)))
    sections.append(Section("case", "The case", [Code(_case_text(texts))]))
    return render(
        title=str(texts["title"]),
        summary=prose(survey.summary),
        notices=json.loads(str(texts["notices"])),
        sections=sections,
        version=texts["thermogear"],
    )


def _case_text(texts: Mapping[str, Any]) -> str:
    """The file as read, and below it what the command line put in its place."""
    changes = json.loads(str(texts.get("overrides", "[]")))
    notes = "".join(f"\n# on the command line: {path} = {value}" for path, value in changes)
    return str(texts["case"]).rstrip() + notes


def _picture(one: Drawn) -> Picture:
    svg = draw(one.make, f"fig-{one.name}", one.heading)
    return Picture(f"fig-{one.name}", one.heading, prose(one.caption), svg, one.wide)


def _files(directory: Path, kind: str, one: Drawn) -> list[Path]:
    """SVG and PNG of a picture, on white."""
    written = []
    drawn = one.make()
    for ending in ("svg", "png"):
        path = directory / f"{kind}_{one.name}.{ending}"
        written.append(put_picture(drawn, path, resolution=RESOLUTION))
    return written


def _in_words(data: xr.Dataset) -> xr.Dataset:
    """The same with the words of its flags in place of their numbers."""
    words = {}
    for name, variable in data.data_vars.items():
        if "flag_meanings" in variable.attrs:
            meanings = np.array(str(variable.attrs["flag_meanings"]).split())
            words[name] = (variable.dims, meanings[variable.values.astype(int)])
    return data.assign(words)


def _tables(directory: Path, stem: str, data: xr.Dataset) -> list[Path]:
    """One CSV file for each set of dimensions; the header names the units."""
    families: dict[tuple[str, ...], list[str]] = {}
    for name, variable in data.data_vars.items():
        dims = tuple(str(d) for d in variable.dims)
        families.setdefault(tuple(sorted(dims)), []).append(str(name))
    written = []
    for dims, names in families.items():
        if not dims:
            continue
        frame = _in_words(data[names]).to_dataframe().reset_index()
        units = {
            str(column): f"{column} [{data[column].attrs['units']}]"
            for column in frame.columns
            if column in data.variables and data[column].attrs.get("units")
        }
        tail = "" if len(families) == 1 else f"_by_{'_'.join(dims)}"
        text = frame.rename(columns=units).to_csv(
            index=False, float_format="%.9g", lineterminator="\n"
        )
        written.append(put(directory / f"{stem}{tail}.csv", text))
    return written
