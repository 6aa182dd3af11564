"""The writer of netCDF-4 against the one of xarray and h5netcdf: the same is read back."""

from __future__ import annotations

from pathlib import Path

import h5py
import numpy as np
import pytest
import synthetic_results
import xarray as xr

from thermogear.base.files import put_sealed
from thermogear.base.netcdf import read_tree, write_tree
from thermogear.results.result import Result


def every_kind() -> xr.DataTree:
    """Every kind of number, text and attribute, empty and inherited dimensions, odd names."""
    n, m = 3, 2
    root = xr.Dataset(
        {
            "force": (("place", "row"), [[0.0, -0.0], [np.nan, np.inf], [5e-324, 1.0]]),
            "count": ("place", np.array([1, -2, 3], "int32"), {"flag_values": np.array([1, 2])}),
            "word": ("row", ["", "Zähne µm"], {"units": "1", "words": ["a", "bc"], "one": ["a"]}),
            "text": ((), "alone"),
            "number": ((), 2.5, {"size": 3, "share": 0.1, "flag": np.int8(1), "nothing": ""}),
            "yes": ("place", [True, False, True]),
            "small": ("place", np.array([1, 2, 3], "int8")),
            "single": ("place", np.array([1.5, np.nan, 0], "float32")),
            "hidden": ("place", [1.0, np.nan, 2.0], {}, {"_FillValue": -1.0}),
            "wave": ("place", np.array([1, 2, 3], ">f8")),
        },
        {
            "place": ("place", np.linspace(0, 1, n), {"units": "m", "long_name": "place"}),
            "label": ("row", ["first", "second"]),
            "grid": (("place", "row"), np.arange(6.0).reshape(n, m), {"units": "K"}),
        },
        {"title": "Größe", "version": 3, "share": 0.25, "list": [1.5, 2.5], "none": ""},
    )
    child = xr.Dataset(
        {"force": (("place", "row"), np.ones((n, m))), "other": ("step", np.arange(4))},
        {"step": ("step", ["a", "b", "c", "d"])},
    )
    empty = xr.Dataset({"event": ("event", np.zeros(0)), "note": ("event", np.array([], "<U4"))})
    deep = xr.Dataset({"row": ("row", [1.0, 2.0]), "row_2": ("row_2", np.arange(1))})
    groups = {"/": root, "child": child, "child/b": empty, "a/deep/group": deep}
    return xr.DataTree.from_dict(groups)


def read_by_xarray(file: Path) -> xr.DataTree:
    with xr.open_datatree(file, engine="h5netcdf") as tree:
        return tree.load()


def assert_stored_alike(tree: xr.DataTree, path: Path) -> None:
    """Written by us or by xarray, read by us or by xarray: one and the same."""
    theirs = path.with_name("xarray.nc")
    tree.to_netcdf(theirs, engine="h5netcdf")
    wanted, ours = read_by_xarray(theirs), write_tree(tree, path)
    assert_same(read_by_xarray(ours), wanted, encodings=True)
    put_sealed(theirs, theirs.read_bytes())
    for file in (ours, theirs):
        assert_same(read_tree(file), wanted, encodings=False)


def assert_same(ours: xr.DataTree, theirs: xr.DataTree, encodings: bool) -> None:
    """Names and their order, dims, coords, attributes, types, every bit."""
    assert ours.identical(theirs)
    for one, two in zip(ours.subtree, theirs.subtree, strict=True):
        assert (one.path, repr(dict(one.attrs))) == (two.path, repr(dict(two.attrs)))
        a, b = one.to_dataset(inherit=False), two.to_dataset(inherit=False)
        assert list(a.variables) == list(b.variables)
        assert (list(a.coords), dict(a.sizes)) == (list(b.coords), dict(b.sizes))
        for name, variable in a.variables.items():
            other = b.variables[name]
            assert variable.dtype == other.dtype
            assert repr(variable.attrs) == repr(other.attrs)
            assert variable.values.tobytes() == other.values.tobytes()
            if encodings:
                assert repr(encoding(variable)) == repr(encoding(other))


def encoding(variable: xr.Variable) -> dict[str, object]:
    return {name: value for name, value in variable.encoding.items() if name != "source"}


def test_every_kind_of_number_text_and_group_is_stored_as_xarray_does(tmp_path: Path) -> None:
    assert_stored_alike(every_kind(), tmp_path / "results.nc")


def test_what_was_read_is_stored_alike_again(tmp_path: Path) -> None:
    first = read_tree(write_tree(every_kind(), tmp_path / "first.nc"))
    assert_stored_alike(first, tmp_path / "results.nc")
    assert read_tree(tmp_path / "results.nc").identical(first)


@pytest.mark.parametrize("kind", ["gear", "dimensionless"])
def test_a_result_is_stored_as_xarray_does(kind: str, tmp_path: Path) -> None:
    make = synthetic_results.build if kind == "gear" else synthetic_results.build_dimensionless
    found = Result.read(make(tmp_path / "made") / "results.nc")
    assert_stored_alike(found.tree, tmp_path / "results.nc")


def test_the_layout_is_that_of_netcdf(tmp_path: Path) -> None:
    """Dimension scales, their numbers and names, creation order: what netCDF-4 asks of HDF5."""
    with h5py.File(write_tree(every_kind(), tmp_path / "results.nc"), "r") as file:
        assert file.attrs["_NCProperties"].startswith(b"version=2,")
        assert list(file)[:3] == ["force", "count", "word"]
        assert file["place"].attrs["NAME"] == b"place"
        name = b"This is a netCDF dimension but not a netCDF variable.         2"
        assert (file["row"].attrs["CLASS"], file["row"].attrs["NAME"]) == (b"DIMENSION_SCALE", name)
        assert [scale.name for dim in file["force"].dims for scale in dim.values()] == [
            "/place",
            "/row",
        ]
        # a group below uses the dimensions above it
        assert [scale.name for dim in file["child/force"].dims for scale in dim.values()] == [
            "/place",
            "/row",
        ]
        ids: list[int] = []
        file.visititems(
            lambda _, item: (
                ids.append(int(item.attrs["_Netcdf4Dimid"]))
                if item.attrs.get("CLASS") == b"DIMENSION_SCALE"
                else None
            )
        )
        assert sorted(ids) == list(range(5))
