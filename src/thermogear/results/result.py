"""Stored results as the views see them: one file, read whole, refused in one line."""

from __future__ import annotations

import json
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import xarray as xr

from thermogear.base import netcdf
from thermogear.base.errors import InputError

RESULTS = "results.nc"
KINDS = ("gear", "dimensionless")

_FIX = "name a directory that this command, or `thermogear run CASE -o DIR`, has written"


@dataclass(frozen=True, eq=False)
class Results:
    """Everything one ``results.nc`` holds: root attributes as text, groups as Datasets."""

    texts: Mapping[str, str]
    groups: Mapping[str, xr.Dataset]

    @property
    def kind(self) -> str:
        """``gear`` or ``dimensionless``."""
        return self.texts["kind"]

    def text(self, name: str) -> str:
        """A root attribute, empty where it is absent."""
        return self.texts.get(name, "")

    def group(self, name: str) -> xr.Dataset | None:
        """A group by its path, None where it is absent."""
        return self.groups.get(name)

    def rows(self, name: str) -> list[dict[str, Any]]:
        """A root attribute that holds a JSON list of objects; empty where it is absent."""
        found = self._json(name, "[]")
        if not isinstance(found, list) or not all(isinstance(row, dict) for row in found):
            raise InputError(f"{RESULTS} attribute {name}", "no list of rows", fix=_FIX)
        return found

    def table(self, name: str) -> dict[str, Any]:
        """A root attribute that holds a JSON object; empty where it is absent."""
        found = self._json(name, "{}")
        if not isinstance(found, dict):
            raise InputError(f"{RESULTS} attribute {name}", "no table", fix=_FIX)
        return found

    def _json(self, name: str, absent: str) -> Any:
        try:
            return json.loads(self.texts.get(name, absent))
        except ValueError as error:
            raise InputError(
                f"{RESULTS} attribute {name}", "text that is not JSON", fix=_FIX
            ) from error


def read_results(directory: Path, kinds: Collection[str] = KINDS) -> Results:
    """All of ``directory/results.nc`` in memory; its kind is one of ``kinds``.

    Raises InputError, in one line, where the file is missing, unreadable or not ours.
    """
    path = Path(directory) / RESULTS
    found = read_tree(path, _FIX)
    if "thermogear" not in found.texts or found.texts.get("kind") not in kinds:
        raise InputError("results", str(path), why="it was not written by thermogear", fix=_FIX)
    return found


def read_tree(path: Path, fix: str = "") -> Results:
    """All of a stored netCDF file in memory, its seal checked; the root's own group is "".

    Raises InputError, in one line with ``fix``, where the file is missing or damaged.
    """
    return results_of(netcdf.read_tree(path, fix))


def results_of(tree: xr.DataTree) -> Results:
    """What ``tree`` holds, every group in memory."""
    texts = {str(name): str(value) for name, value in tree.attrs.items()}
    groups = {
        node.path.strip("/"): node.to_dataset(inherit=True).load()
        for node in tree.subtree
        if node.has_data
    }
    return Results(texts, groups)
