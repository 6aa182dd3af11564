"""The page of case against case: whole, safe, and nothing drawn twice."""

from __future__ import annotations

import csv
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
import synthetic_results as synthetic

from thermogear.base.errors import InputError, UnsealedWarning
from thermogear.results.result import Result, open_results, read_results
from thermogear.study.versus import Stored, versus
from thermogear.study.versus import stored as stored_result
from thermogear.views.write import page_of, write


def stored(directory: Path, name: str) -> Stored:
    return stored_result(read_results(directory), name)


def write_versus(place: Path) -> list[Path]:
    return write(page_of(open_results(place, "versus")), place)


def read_versus(place: Path) -> Result:
    return open_results(place, "versus")


def built(place: Path, **first: object) -> Path:
    """A comparison of two synthetic cases, the second with one operating point more."""
    one = synthetic.build(place / "one", title="One & <i>only</i>", **first)  # type: ignore[arg-type]
    two = synthetic.build(
        place / "two", title="=Two", torques=(100.0,) * 3,
        case="title = 'B'\n[gears]\nmodule = \"<b>5</b> mm\"\n",
    )  # fmt: skip
    versus([stored(one, "one"), stored(two, "two")]).put(place)
    return place


def words_of(text: str) -> str:
    root = ElementTree.fromstring(text.removeprefix("<!DOCTYPE html>").strip())
    return " ".join("".join(root.find("body").itertext()).split())  # type: ignore[union-attr]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return built(tmp_path_factory.mktemp("versus"))


@pytest.fixture(scope="module")
def text(place: Path) -> str:
    return write_versus(place)[0].read_text(encoding="utf-8")


def test_the_page_is_whole_and_needs_nothing_else(text: str) -> None:
    words = words_of(text)
    sections = ["What differs", "Key figures", "Curves, consistent", "Curves, thesis"]
    for said in [*sections, "gears.module", "<b>5</b> mm", "this case only", "One & <i>only</i>"]:
        assert said in words, said
    page = text.replace("http://www.w3.org/2000/svg", "")
    assert not re.search(r"<link|(?:src|href)=\"(?!#)|url\((?!#)|https?:", page)
    assert text.count("<script") == 1
    assert "<i>only" not in text
    ids = re.findall(r'\bid="([^"]+)"', text)
    assert len(ids) == len(set(ids))


def test_every_axis_has_a_unit_and_every_case_its_name(text: str) -> None:
    figures = re.findall(r"<figure.*?</figure>", text, flags=re.DOTALL)
    assert len(figures) >= 10
    for figure in figures:
        # an index in the symbol shuffles the letters of an axis, so brackets are counted
        words = "".join(re.sub(r"<[^>]*>", "", figure).split())
        assert words.count("[") == words.count("]") == 2, words[:200]
        assert "=Two" in words


def test_the_same_results_give_the_same_page(place: Path, text: str) -> None:
    assert write_versus(place)[0].read_text(encoding="utf-8") == text


def test_tables_are_files_that_a_spreadsheet_reads_safely(place: Path, text: str) -> None:
    path = place / "versus_figures_by_bundle_case_operating_state.csv"
    rows = list(csv.DictReader(path.read_text("utf-8").splitlines()))
    assert {"case", "bundle", "point", "state", "label"} <= set(rows[0])
    assert len(rows) == 2 * 2 * 2 * 3
    assert {row["case"] for row in rows} == {"One & <i>only</i>", "'=Two"}
    assert text


def test_jammed_points_and_cases_without_motion_are_drawn(tmp_path: Path) -> None:
    page = write_versus(built(tmp_path, jammed=True, without=("motion",)))[0]
    words = words_of(page.read_text(encoding="utf-8"))
    assert "→ none" in words
    assert "Spectrum" in words


def test_what_is_missing_damaged_or_foreign_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="there is no such file"):
        read_versus(tmp_path)
    (tmp_path / "versus.nc").write_bytes(b"CDF")
    with pytest.raises(InputError, match="damaged"):
        read_versus(tmp_path)
    other = synthetic.build(tmp_path / "run")
    (other / "results.nc").rename(tmp_path / "versus.nc")
    with (
        pytest.warns(UnsealedWarning, match=r"no versus\.nc\.sha256 beside it"),
        pytest.raises(InputError, match="not written by thermogear"),
    ):
        read_versus(tmp_path)
