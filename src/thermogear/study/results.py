"""Stored results: one netCDF file of labelled groups, written whole or not at all."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import xarray as xr

from thermogear.base.errors import InputError
from thermogear.base.files import beside, put, require_directory

RESULTS = "results.nc"
SUMMARY = "summary.json"
MARK = ".thermogear"
"""Stands in every directory of ours from before the first result is written."""


def write_results(tree: xr.DataTree, directory: Path, name: str = RESULTS) -> Path:
    """Write ``tree`` as ``directory/name`` (netCDF-4); an older file stays until then."""
    path = directory / name
    with beside(path) as temporary:
        tree.to_netcdf(temporary, engine="h5netcdf")
    return path


def write_summary(summary: Mapping[str, Any], directory: Path, name: str = SUMMARY) -> Path:
    """Write ``directory/name`` as JSON."""
    return put(directory / name, json_text(summary))


def json_text(summary: Mapping[str, Any]) -> str:
    """A summary as a JSON text of lines."""
    return json.dumps(summary, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def claim_directory(directory: Path, ours: Sequence[str] = ()) -> None:
    """Make ``directory`` ours: new, empty, or claimed earlier; else refuse it.

    The mark is written at once, so that what an interrupted run leaves is still ours.
    """
    require_directory(directory)
    foreign = directory.is_dir() and any(
        not (ours and path.name.lstrip(".").startswith(tuple(ours))) for path in directory.iterdir()
    )
    if foreign and not is_ours(directory):
        raise InputError(
            "output",
            str(directory),
            why="the directory holds files that are not results of thermogear",
            fix="name a new or an empty directory",
        )
    directory.mkdir(parents=True, exist_ok=True)
    if not (directory / MARK).exists():
        put(directory / MARK, "results of thermogear\n")


def is_ours(directory: Path) -> bool:
    """Whether a run wrote here: its mark or its summary is there."""
    try:
        if (directory / MARK).read_bytes().startswith(b"results of thermogear"):
            return True
    except OSError:
        pass  # results of older versions carry no mark
    try:
        summary = json.loads((directory / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(summary, dict) and "thermogear" in summary
