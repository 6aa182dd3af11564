"""The page's pictures as files."""

from __future__ import annotations

from pathlib import Path

import pytest

from thermogear import InputError, run
from thermogear.study.case import load_example
from thermogear.study.results import write_results
from thermogear.views.pictures import write_pictures


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("pictures")
    write_results(run(load_example("section-4.1")), directory)
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
