"""Stored results: one netCDF file of labelled groups, written whole or not at all."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from thermogear.base.errors import InputError

RESULTS = "results.nc"
SUMMARY = "summary.json"
MARK = ".thermogear"
"""Stands in every directory of ours from before the first result is written."""


def write_atomically(path: Path, data: bytes) -> None:
    """Write ``data`` beside ``path``, flush it to the disk, then put it in place."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def write_results(tree: xr.DataTree, directory: Path, name: str = RESULTS) -> Path:
    """Write ``tree`` as ``directory/name`` (netCDF-4); an older file stays until then."""
    path = directory / name
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        tree.to_netcdf(temporary, engine="h5netcdf")
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)
    return path


def write_summary(summary: Mapping[str, Any], directory: Path) -> Path:
    """Write ``directory/summary.json``."""
    path = directory / SUMMARY
    text = json.dumps(summary, indent=2, ensure_ascii=False, allow_nan=False)
    write_atomically(path, (text + "\n").encode())
    return path


def claim_directory(directory: Path) -> None:
    """Make ``directory`` ours: new, empty, or claimed earlier; else refuse it.

    The mark is written at once, so that what an interrupted run leaves is still ours.
    """
    if directory.exists() and not directory.is_dir():
        raise InputError("output", str(directory), why="it is a file", fix="name a directory")
    if directory.is_dir() and any(directory.iterdir()) and not is_ours(directory):
        raise InputError(
            "output",
            str(directory),
            why="the directory holds files that are not results of thermogear",
            fix="name a new or an empty directory",
        )
    directory.mkdir(parents=True, exist_ok=True)
    if not (directory / MARK).exists():
        write_atomically(directory / MARK, b"results of thermogear\n")


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
