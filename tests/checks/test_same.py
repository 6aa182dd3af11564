"""``make same``: what is equal, what is not, and what has another name, on small files."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scripts import ROOT, script

digests = script("same_digest")
cases = script("same_cases")
same = script("same")

NAMES = np.array(["up", "down"])
FORCE = np.array([[1.0, -0.0, 3.0], [4.0, np.nan, 6.0]])


def tree(force: Any = FORCE, **attributes: str) -> xr.DataTree:
    force = xr.Variable(("direction", "time"), force, {"units": "N"})
    data = xr.Dataset({"force": force, "count": ((), 3)}, {"direction": NAMES})
    made: xr.DataTree = xr.DataTree.from_dict({"motion": data})
    made.attrs = {"kind": "gear", **attributes}
    return made


def written(folder: Path, made: xr.DataTree) -> Path:
    """The tree as a netCDF file and as a zarr store, and tables and texts beside them."""
    folder.mkdir()
    made.to_netcdf(folder / "results.nc", engine="h5netcdf")
    numbers = made["motion"].to_dataset().drop_vars("direction")  # texts have no place in zarr 3
    numbers.to_zarr(folder / "result.zarr", zarr_format=3, consolidated=False)
    (folder / "curve.csv").write_text("t,x\n0,1.5\n1,2.5\n", "utf-8")
    (folder / "summary.json").write_text(
        json.dumps({"found": [{"x": 1.5}, {"x": 2.5}], "seconds": 3.1}), "utf-8"
    )
    (folder / "said-1.txt").write_text("done in 3.1 s\n", "utf-8")
    return folder


def verdict(one: Path, two: Path, renamed: Mapping[str, str] | None = None) -> Any:
    def how(old: str, new: str) -> str:
        a = digests.values(one, old.removeprefix("case/"))
        return str(same.apart(a, digests.values(two, new.removeprefix("case/"))))

    of = partial(digests.digest, name="case")
    return same.compare("case", of(one), of(two), renamed or {}, how)


@pytest.fixture
def before(tmp_path: Path) -> Path:
    return written(tmp_path / "before", tree(created="2026-01-01"))


def test_equal_but_for_date_and_seconds(before: Path, tmp_path: Path) -> None:
    after = written(tmp_path / "after", tree(created="2026-01-02"))
    (after / "said-1.txt").write_text("done in 4 s\n", "utf-8")
    (after / "summary.json").write_text(
        json.dumps({"found": [{"x": 1.5}, {"x": 2.5}], "seconds": 4.0}), "utf-8"
    )
    found = verdict(before, after)
    assert found.equal == found.variables == 5
    assert found.told == found.told_equal > 8
    assert not found.differences
    assert not found.otherwise


def test_one_bit_is_a_difference_and_its_size_is_said(before: Path, tmp_path: Path) -> None:
    force = FORCE.copy()
    force[0, 2] = np.nextafter(3.0, 4.0)
    found = verdict(before, written(tmp_path / "after", tree(force)))
    assert found.differences == [
        f"case/{file}force: 1 of 6 numbers differ, by up to 4.44e-16, relative 1.48e-16"
        for file in ("result.zarr:", "results.nc:motion/")
    ]
    assert found.equal == found.variables - 2


def test_signs_of_zero_kinds_shapes_and_missing_ones_are_differences(
    before: Path, tmp_path: Path
) -> None:
    for name, force, words in (
        ("zero", np.where(FORCE == 0.0, 0.0, FORCE), "1 of 6 numbers differ, by up to 0, rel"),
        ("kind", FORCE.astype("f4"), "<f8 is <f4 now"),
        ("shape", FORCE[:, :2], "(motion/direction 2, motion/time 3) is (motion/direction 2, "),
    ):
        found = verdict(before, written(tmp_path / name, tree(force)))
        assert sum(words in text for text in found.differences) >= 1, found.differences
    made = tree()
    made["motion"] = made["motion"].to_dataset().drop_vars("count")
    found = verdict(before, written(tmp_path / "missing", made))
    places = [one.rpartition(": ")[0] for one in found.differences]
    assert places == ["case/result.zarr:count", "case/results.nc:motion/count"]


def test_what_is_renamed_is_compared_by_its_new_name(before: Path, tmp_path: Path) -> None:
    made = tree()
    data = made["motion"].to_dataset().rename(force="mesh_force", time="moment")
    after = written(tmp_path / "after", xr.DataTree.from_dict({"motion": data}))
    assert len(verdict(before, after).differences) == 4
    renamed = {"*:*force": "*:*mesh_force", "*:*time": "*:*moment"}
    found = verdict(before, after, renamed)
    assert not found.differences
    assert found.equal == found.variables
    assert found.renamed["case/results.nc:motion/force"] == "case/results.nc:motion/mesh_force"


def test_told_differences_are_counted_apart(before: Path, tmp_path: Path) -> None:
    made = tree()
    made["motion"]["force"].attrs["units"] = "kN"
    after = written(tmp_path / "after", made)
    (after / "curve.csv").write_text("t,x\n0,1.5\n1,2.6\n2,3\n", "utf-8")
    found = verdict(before, after)
    assert not found.differences
    assert found.otherwise == [
        "case/curve.csv:t: nothing is '2' now",
        "case/curve.csv:x: '2.5' is '2.6' now",
        "case/curve.csv:x: nothing is '3' now",
        "case/result.zarr:force@units: 'N' is 'kN' now",
        "case/results.nc:motion/force@units: 'N' is 'kN' now",
    ]
    assert found.told - found.told_equal == 5


def test_a_digest_survives_its_file(before: Path) -> None:
    made = digests.digest(before, "case")
    assert digests.Digest.of_plain(json.loads(json.dumps(made.plain()))) == made


def test_cases_have_names_of_their_own_and_reach_every_command() -> None:
    from thermogear.front.cli import cli

    names = [case.name for case in cases.CASES]
    assert len(set(names)) == len(names)
    carried_out = {
        step.split()[0] for case in cases.CASES if case.name != "help" for step in case.steps
    }
    # the app serves until it is ended; its own tests do
    assert set(cli.commands) - {"thesis", "app"} <= carried_out
    assert set(cases.COMMANDS) == set(cli.commands) - {"app"}


def test_steps_run_apart_and_their_ends_are_known(tmp_path: Path) -> None:
    steps = [["-c", "import sys; sys.one = 1; print('said')"], ["-c", "import sys; sys.one"]]
    steps += [["--version"], ["run", "nowhere.toml", "-o", "out"]]
    done = subprocess.run(
        [sys.executable, "-P", ROOT / "checks" / "same_run.py"],
        input=json.dumps({"folder": str(tmp_path), "steps": steps}) + "\n",
        env=os.environ | {"PYTHONPATH": str(ROOT / "src")},
        capture_output=True,
        text=True,
        check=True,
    )
    assert [code for code, _ in json.loads(done.stdout)] == [0, 1, 0, 2]
    assert (tmp_path / "said-1.txt").read_text("utf-8") == "said\n"
    assert "AttributeError" in (tmp_path / "complained-2.txt").read_text("utf-8")
    assert (tmp_path / "said-3.txt").read_text("utf-8").startswith("thermogear")
    assert (tmp_path / "complained-4.txt").read_text("utf-8").startswith("error: nowhere.toml")


def test_compiled_sources_are_known_with_what_they_import(tmp_path: Path) -> None:
    package = tmp_path / "thermogear"
    package.mkdir()
    (package / "kernel.py").write_text("import numba\nfrom thermogear.numbers import TEN\n")
    (package / "numbers.py").write_text("TEN = 10\n")
    (package / "other.py").write_text("x = 1\n")
    first = same.kernels(tmp_path)
    (package / "other.py").write_text("x = 2\n")
    assert same.kernels(tmp_path) == first
    (package / "numbers.py").write_text("TEN = 11\n")
    assert same.kernels(tmp_path) != first
