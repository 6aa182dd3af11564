"""CSV: every number of the store comes back, with its unit in the header."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import synthetic_results as synthetic
import xarray as xr

from plain_numbers import told_in_csv
from thermogear.base.errors import InputError
from thermogear.results.result import open_results
from thermogear.views import write as files
from thermogear.views.write import clear_tables, page_of, write, write_tables


def write_csv(place: Path) -> list[Path]:
    files = [p for p in write(page_of(open_results(place)), place) if p.suffix == ".csv"]
    clear_tables(place, files)
    return files


def read(path: Path) -> dict[str, list[str]]:
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def chosen(table: dict[str, list[str]], **cells: str) -> dict[str, list[str]]:
    """The rows of a table that have these cells."""
    wanted = [place for place, row in enumerate(zip(*(table[name] for name in cells), strict=True))
              if row == tuple(cells.values())]  # fmt: skip
    return {name: [column[place] for place in wanted] for name, column in table.items()}


@pytest.fixture(scope="module", autouse=True)
def undrawn() -> Iterator[None]:
    """Of a page its tables alone: drawing its pictures takes most of the time of writing it."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(files, "render", lambda page: "")
        yield


@pytest.fixture(scope="module")
def whole(undrawn: None, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """The tables of a run with everything, beside its results."""
    place = tmp_path_factory.mktemp("whole")
    synthetic.build(place)
    return write_csv(place)


def test_curves_come_back_with_units_and_operating_points(whole: list[Path]) -> None:
    files = {path.name: path for path in whole}
    table = chosen(
        read(files["path_by_bundle_operating_path_position_state.csv"]),
        bundle="consistent", state="hot",
    )  # fmt: skip
    data = synthetic.path_group(("consistent", "thesis"), (100.0, 100.0))
    here = data.isel(bundle=0, state=1)
    positions = here.sizes["path_position"]
    for name, unit in (("hertz_pressure", "Pa"), ("sliding_velocity", "m/s"), ("load_share", "1")):
        found = np.array(table[f"{name} [{unit}]"], float)
        np.testing.assert_allclose(found, here[name].values.ravel(), rtol=1e-8)
    np.testing.assert_allclose(
        np.array(table["path_position [m]"], float), np.tile(here["path_position"], 2), rtol=1e-8
    )
    np.testing.assert_allclose(
        np.array(table["pinion_speed [rad/s]"], float),
        np.repeat(here["pinion_speed"].values, positions),
        rtol=1e-8,
    )


def test_every_variable_of_the_store_stands_in_some_file(whole: list[Path]) -> None:
    columns = {
        name.split(" [")[0]
        for path in whole
        for name in path.read_text(encoding="utf-8").partition("\n")[0].split(",")
    }
    with xr.open_datatree(whole[0].parents[1] / "results.nc", engine="h5netcdf") as tree:
        stored = {str(n) for node in tree.subtree for n in node.data_vars}
    assert stored <= columns


def test_jammed_points_are_words_and_empty_cells(tmp_path: Path) -> None:
    synthetic.build(tmp_path, jammed=True, without=("temperature",))
    files = {path.name: path for path in write_csv(tmp_path)}
    figures = read(files["motion_by_bundle_operating_state.csv"])
    assert set(figures["status"]) == {"ok", "jammed"}
    swing = dict(zip(figures["status"], figures["peak_to_peak_displacement [m]"], strict=True))
    assert swing == {"ok": "2e-06", "jammed": ""}
    motion = read(files["motion_by_bundle_operating_sample_state.csv"])
    hot = chosen(motion, bundle="consistent", state="hot")
    assert set(hot["displacement [m]"]) == {""}


def test_names_make_safe_files_and_safe_cells(tmp_path: Path) -> None:
    synthetic.build(tmp_path, bundles=('../=1+1, "x"',), without=("temperature",))
    files = write_csv(tmp_path)
    assert {path.parent for path in files} == {tmp_path / "csv"}
    figures = read(
        next(path for path in files if path.name == "mesh_by_bundle_operating_state.csv")
    )
    assert set(figures["bundle"]) == {'../=1+1, "x"'}
    synthetic.build(tmp_path, bundles=("=1+1",), without=("temperature",))
    figures = read(
        next(p for p in write_csv(tmp_path) if p.name == "mesh_by_bundle_operating_state.csv")
    )
    assert set(figures["bundle"]) == {"'=1+1"}


def test_files_of_an_earlier_run_go_and_others_stay(tmp_path: Path) -> None:
    synthetic.build(tmp_path)
    write_csv(tmp_path)
    assert (tmp_path / "csv" / "temperature_by_bundle_gear_temperature_operating.csv").is_file()
    (tmp_path / "csv" / "mine.csv").write_text("a,b\n", encoding="utf-8")
    synthetic.build(tmp_path, bundles=("consistent",), without=("temperature",))
    write_csv(tmp_path)
    names = {path.name for path in (tmp_path / "csv").iterdir()}
    assert "mine.csv" in names
    assert "mesh_by_bundle_operating_state.csv" in names
    assert not [name for name in names if name.startswith("temperature")]


def test_curves_are_written_when_they_are_asked_for_and_then_the_same(whole: list[Path]) -> None:
    place = whole[0].parents[1]
    page = page_of(open_results(place))
    files = write(page, place, tables=False)
    assert [path.name for path in files] == ["report.html", "summary.json"]
    before = {path: path.read_bytes() for path in whole}
    for path in whole:
        path.unlink()
    assert {path: path.read_bytes() for path in write_tables(page, place)} == before


def test_missing_results_are_an_error(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        write_csv(tmp_path)
    assert not (tmp_path / "csv").exists()


def test_a_number_in_words_or_for_none_is_found_in_a_table() -> None:
    """What looks through every CSV text of the tests finds what is planted, and no more."""
    text = "name,force,count [1],direction,x [m]\nrow 1,1.23·10⁶,-1,-1,-1\n2 rpm,7,3,1,0.5\n"
    found = ["name: '2 rpm'", "force: '1.23·10⁶'", "count [1]: -1 among [-1.0, 3.0]"]
    assert list(told_in_csv(text)) == found
