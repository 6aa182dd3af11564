"""Results and stores of earlier versions open; those of newer ones are refused in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.base.files import SCHEMA
from thermogear.base.netcdf import write_tree
from thermogear.base.stores import FORMAT, require_schema
from thermogear.results.files import json_text
from thermogear.results.result import Result, open_results

BEFORE = {
    "thermogear": "0.1.0",
    "created": "2026-11-01T00:00:00+00:00",
    "title": "rig",
    "notices": '[{"level": "info", "text": "kept"}]',
}
"""Root attributes as 0.1.0 wrote them, before results had a schema."""


def tree(kind: str, **attrs: str | int) -> xr.DataTree:
    found = xr.DataTree.from_dict({"/": xr.Dataset({"speed": ("n", [1.0, 2.0])})})
    found.attrs = {**BEFORE, "kind": kind, **attrs}
    return found


@pytest.mark.parametrize("kind", ["gear", "friction", "statics", "orbit"])
def test_results_without_a_schema_open_and_are_stored_with_it(kind: str, tmp_path: Path) -> None:
    path = write_tree(tree(kind), tmp_path / "results.nc")
    result = Result.read(path)
    assert (result.kind, result.title) == (kind, "rig")
    assert [notice.text for notice in result.notices] == ["kept"]
    assert "schema" not in result.provenance
    again = result.write(tmp_path / "again")
    assert result.attrs["schema"] == SCHEMA
    assert open_results(again).attrs == result.attrs


def test_results_of_a_newer_schema_are_refused_by_their_version(tmp_path: Path) -> None:
    newer = tree("gear", schema=SCHEMA + 1, thermogear="9.9.0")
    path = write_tree(newer, tmp_path / "results.nc")
    with pytest.raises(InputError) as refused:
        Result.read(path)
    assert refused.value.told == (
        f"results: got schema {SCHEMA + 1}; allowed at most {SCHEMA}; thermogear 9.9.0 wrote it; "
        "read it with that version, or a newer one"
    )


def test_a_store_of_a_newer_format_is_refused_as_its_own() -> None:
    for known in (None, FORMAT - 1, FORMAT):
        require_schema(known, newest=FORMAT, what="store", version="0.1.0")
    with pytest.raises(InputError, match=rf"store: got schema {FORMAT + 1}.*thermogear 9\.9"):
        require_schema(FORMAT + 1, newest=FORMAT, what="store", version="9.9")


def test_every_json_output_carries_its_schema() -> None:
    assert json.loads(json_text({"a": 1.5})) == {"schema": SCHEMA, "a": 1.5}
