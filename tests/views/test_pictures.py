"""The page's pictures as files."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from thermogear import InputError, load_case, pictures, run, save_results, write_report
from thermogear.case.case import load_example
from thermogear.results.result import Result
from thermogear.views import drawing
from thermogear.views.write import write_pictures


@pytest.fixture(scope="module")
def tree() -> Result:
    return run(load_example("section-4.1"))


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory, tree: Result) -> Path:
    directory = tmp_path_factory.mktemp("pictures")
    save_results(tree, directory)
    return directory


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory, results: Path) -> list[Path]:
    return write_pictures(results, tmp_path_factory.mktemp("drawn") / "new" / "folder")


def test_every_picture_becomes_a_file_of_its_kind(results: Path, written: list[Path]) -> None:
    assert written
    assert len({path.name for path in written}) == len(written)
    for path in written:
        assert path.read_bytes().startswith(b"\x89PNG")
    (one,) = [shown for name, shown in pictures(results).items() if name == "points-0"]
    assert b"<svg" in drawing.image(one.picture, "svg")


def test_an_unknown_kind_and_a_missing_file_are_one_line(results: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"kind: got 'gif'; allowed png \| svg \| pdf"):
        write_pictures(results, tmp_path, "gif")
    with pytest.raises(InputError):
        write_pictures(tmp_path, tmp_path)


def test_pictures_of_results_in_hand_are_those_of_the_stored_ones(
    results: Path, tree: Result, written: list[Path]
) -> None:
    shown, stored = pictures(tree), pictures(results)
    assert list(shown) == [path.stem for path in written] == list(stored)
    for name, picture in shown.items():
        assert picture.picture.to_json() == stored[name].picture.to_json()
    # the same data draw the same: of two of them
    for name, path in list(zip(shown, written, strict=True))[:2]:
        assert shown[name]._repr_png_() == path.read_bytes()
    one = shown["points-0"]
    assert one.heading.startswith("Row ")
    assert "<" not in one.caption


def test_the_pictures_say_where_the_pair_jams() -> None:
    case = load_case(
        "rig",
        {"model.bundle": "consistent", "draw.pictures": '["temperature"]'}
        | {"operating.speed": "1000 rpm", "simulation.periods": "16", "simulation.discard": "16"},
    )
    (one,) = [shown for name, shown in pictures(run(case)).items() if "gap-temp" in name]
    assert b"jams at 235" in drawing.image(one.picture, "svg")


def test_saved_results_make_a_page(tree: Result, tmp_path: Path) -> None:
    summary = save_results(tree, str(tmp_path / "new"))
    assert summary["kind"] == "dimensionless"
    assert write_report(str(tmp_path / "new")).name == "report.html"
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "thing.txt").touch()
    with pytest.raises(InputError, match="not results of thermogear"):
        save_results(tree, tmp_path / "full")


def test_what_no_run_returned_is_refused(tmp_path: Path) -> None:
    stranger = xr.DataTree.from_dict({"a": xr.Dataset({"x": 1.0})})
    with pytest.raises(InputError, match=r"give what run\(case\)"):
        pictures(stranger)
    with pytest.raises(InputError, match=r"give what run\(case\)"):
        save_results(stranger, tmp_path)
