"""The page's pictures as files."""

from __future__ import annotations

from pathlib import Path

import pytest
import xarray as xr

from thermogear import InputError, load_case, pictures, run, save_results, write_report
from thermogear.case.case import load_example
from thermogear.views.write import write_pictures


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("pictures")
    save_results(run(load_example("section-4.1")), directory)
    return directory


def test_every_picture_becomes_a_file_of_its_kind(results: Path, tmp_path: Path) -> None:
    written = write_pictures(results, tmp_path / "new" / "folder")
    assert written
    assert len({path.name for path in written}) == len(written)
    for path in written:
        assert path.read_bytes().startswith(b"\x89PNG")
    (drawn,) = [p for p in write_pictures(results, tmp_path, "svg") if "half" in p.name]
    assert b"<svg" in drawn.read_bytes()


def test_an_unknown_kind_and_a_missing_file_are_one_line(results: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"kind: got 'gif'; allowed png \| svg \| pdf"):
        write_pictures(results, tmp_path, "gif")
    with pytest.raises(InputError):
        write_pictures(tmp_path, tmp_path)


def test_pictures_of_results_in_hand_are_those_of_the_stored_ones(
    results: Path, tmp_path: Path
) -> None:
    names = [path.stem for path in write_pictures(results, tmp_path)]
    tree = run(load_example("section-4.1"))
    shown = pictures(tree)
    assert list(shown) == names == list(pictures(results))
    for name, picture in shown.items():
        assert picture._repr_png_() == (tmp_path / f"{name}.png").read_bytes()
    one = shown["points-half"]
    assert {"half", "temperature"} <= set(one.heading.split())
    assert "<" not in one.caption


def test_the_pictures_say_where_the_pair_jams(tmp_path: Path) -> None:
    case = load_case(
        "rig",
        {"model.bundle": "consistent", "draw.pictures": '["temperature"]'}
        | {"operating.speed": "1000 rpm", "simulation.periods": "16", "simulation.discard": "16"},
    )
    save_results(run(case), tmp_path)
    (drawn,) = [p for p in write_pictures(tmp_path, tmp_path, "svg") if "gap-temp" in p.name]
    assert b"jams at 235" in drawn.read_bytes()


def test_saved_results_make_a_page(tmp_path: Path) -> None:
    tree = run(load_example("section-4.1"))
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
