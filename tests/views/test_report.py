"""The page: whole, self-contained, the same for the same results, safe against its contents."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import h5netcdf
import numpy as np
import pytest
import synthetic_results as synthetic
from markupsafe import Markup
from matplotlib.figure import Figure

from thermogear.base.errors import InputError, UnsealedWarning
from thermogear.views import drawing
from thermogear.views import page as pages
from thermogear.views.moving import script
from thermogear.views.picture import Picture
from thermogear.views.write import write_report

GROUPS = ("path", "mesh", "profile", "motion", "dial", "temperature",
          "base_sets/table-4.2", "base_sets/section-4.1")  # fmt: skip


def rendered(directory: Path) -> str:
    return write_report(directory).read_text(encoding="utf-8")


def tree_of(text: str) -> ElementTree.Element:
    """The page as a tree: it is written so that an XML reader takes it too."""
    return ElementTree.fromstring(text.removeprefix("<!DOCTYPE html>").strip())


def words_of(text: str) -> str:
    """What a reader reads: the body alone."""
    return " ".join("".join(tree_of(text).find("body").itertext()).split())  # type: ignore[union-attr]


@pytest.fixture(scope="module")
def text(tmp_path_factory: pytest.TempPathFactory) -> str:
    return rendered(synthetic.build(tmp_path_factory.mktemp("whole"), title="A pair"))


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> dict[str, Picture]:
    """Pictures that a page shows, by name; the page itself gets none."""
    found: dict[str, Picture] = {}

    def keep(picture: Picture, name: str, title: str) -> Markup:
        found[name] = picture
        return Markup("<svg></svg>")

    monkeypatch.setattr(pages, "draw", keep)
    return found


DRAWN: set[str] = set()
"""The data of the pictures whose layout was looked at."""


def axes_of(figure: Figure) -> Iterator[object]:
    for axes in figure.axes:
        yield axes
        yield from axes.child_axes


def test_the_page_asks_nothing_of_any_other_place(text: str) -> None:
    # SVG's name, which is no address one asks
    assert "://" not in text.replace("http://www.w3.org/2000/svg", "")
    assert "@import" not in text
    assert re.findall(r"<script\b[^>]*>", text) == ["<script>"]
    assert not re.search(r"<(link|iframe|object|embed|img)\b", text)
    assert set(re.findall(r'\bsrc="([^"]*)"', text)) == set()
    assert all(target[0] == "#" for target in re.findall(r'\bhref="([^"]*)"', text))
    assert all(target[0] == "#" for target in re.findall(r"url\(([^)]*)\)", text))


def test_the_page_is_well_formed_and_its_ids_are_unique_and_found(text: str) -> None:
    ids = [e.attrib["id"] for e in tree_of(text).iter() if "id" in e.attrib]
    assert len(ids) == len(set(ids))
    used = re.findall(r'(?:href="#|url\(#|aria-labelledby=")([^")]+)', text)
    assert set(used) <= set(ids)


def test_every_picture_has_a_heading_a_caption_and_a_title(text: str) -> None:
    drawn = list(tree_of(text).iter("figure"))
    assert len(drawn) > 20
    for one in drawn:
        assert "".join(one.find("h3").itertext()).strip()  # type: ignore[union-attr]
        assert len("".join(one.find("figcaption").itertext())) > 20  # type: ignore[union-attr]
        assert (one.find("div/svg/title").text or "").strip()  # type: ignore[union-attr]


def test_the_sections_stand_in_the_order_of_the_physics(text: str) -> None:
    names = [s.attrib["id"] for s in tree_of(text).iter("section")]
    assert names == [
        "pictures", "results", "friction", "heat", "backlash", "stiffness", "motion",
        "temperature", "base-sets", "choices", "assumptions", "errata", "facts",
        "case", "sources", "version",
    ]  # fmt: skip


def test_key_results_say_what_heat_does(text: str) -> None:
    words = words_of(text)
    assert "125 → 90" in words
    assert re.search(r"regimes, −3 µm", words)
    assert words.index("regimes") < words.index("quiet")


def test_a_natural_frequency_is_said_to_be_that_of_the_undeformed_mean_stiffness(text: str) -> None:
    assert re.search(r"f<sub>n</sub> .* \[Hz\]", text)


def test_base_sets_are_said_to_be_none_of_the_rig(text: str) -> None:
    words = words_of(text)
    (shown,) = (s for s in tree_of(text).iter("section") if s.attrib["id"] == "base-sets")
    said = " ".join(shown.itertext())
    assert re.search(r"\bnot\b", said)
    assert {"rig,", "consistent,", "hot"} <= set(words.split())


@pytest.mark.parametrize("jammed", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_every_axis_of_every_picture_is_labelled_and_nothing_is_cut_or_covered(
    jammed: bool, tmp_path: Path, shown: dict[str, Picture]
) -> None:
    write_report(synthetic.build(tmp_path, jammed=jammed, torques=(50.0, 100.0)))
    assert len(shown) > 20
    for name, picture in shown.items():
        said = json.dumps(picture.to_json())
        if said in DRAWN:
            continue  # a jam leaves it as it is
        DRAWN.add(said)
        figure = drawing.draw(picture)
        assert figure.axes, name
        with drawing.styled():
            figure.draw_without_rendering()
        for axes in axes_of(figure):
            assert axes.get_xlabel().strip(), name  # type: ignore[attr-defined]
            if axes in figure.axes:
                assert axes.get_ylabel().strip(), name  # type: ignore[attr-defined]
        frame = figure.bbox
        for axes in figure.axes:
            for label in (axes.xaxis.label, axes.yaxis.label, axes.title):
                box = label.get_window_extent()
                inside = frame.x0 - 1 <= box.x0 and box.x1 <= frame.x1 + 1
                assert inside, (name, label.get_text())
                inside = frame.y0 - 1 <= box.y0 and box.y1 <= frame.y1 + 1
                assert inside, (name, label.get_text())
            for legend in figure.legends:
                assert not legend.get_window_extent().overlaps(axes.bbox), name
                assert not legend.get_window_extent().overlaps(
                    axes.xaxis.label.get_window_extent()
                ), name


def test_the_same_results_give_the_same_page(tmp_path: Path) -> None:
    synthetic.build(tmp_path, without=(GROUPS[0], *GROUPS[2:-1]))
    assert rendered(tmp_path) == rendered(tmp_path)


@pytest.mark.parametrize("kept", GROUPS)
def test_a_group_that_is_absent_is_left_out_quietly(
    kept: str, tmp_path: Path, shown: dict[str, Picture]
) -> None:
    synthetic.build(tmp_path, without=tuple(g for g in GROUPS if g != kept))
    page = rendered(tmp_path)
    assert shown
    ids = [section.attrib["id"] for section in tree_of(page).iter("section")]
    assert ("results" in ids) == (kept == "mesh")
    assert "case" in ids


def test_a_variable_that_is_absent_costs_its_pictures_alone(
    tmp_path: Path, shown: dict[str, Picture]
) -> None:
    path = synthetic.path_group(("consistent",), (100.0,)).drop_vars("friction_coefficient_dry")
    synthetic.write(tmp_path, {"path": path}, title="t", kind="gear")
    write_report(tmp_path)
    assert "fig-friction" not in shown
    assert "fig-flash-mixed" in shown


def test_one_bundle_alone_makes_a_page(tmp_path: Path, shown: dict[str, Picture]) -> None:
    synthetic.build(tmp_path, bundles=("consistent",), torques=(100.0,))
    page = rendered(tmp_path)
    assert "choices" in [section.attrib["id"] for section in tree_of(page).iter("section")]
    assert "fig-stiffness-1" not in shown


def test_a_dimensionless_case_makes_a_page_of_its_rows(tmp_path: Path) -> None:
    page = rendered(synthetic.build_dimensionless(tmp_path, "Rows of zeta"))
    words = words_of(page)
    assert "not derived from any gear pair" in words
    assert "ζ = 0.18" in words
    assert "stiffness" not in [s.attrib["id"] for s in tree_of(page).iter("section")]
    agrees = [[*row.itertext()] for row in tree_of(page).iter("tr")]
    assert any("yes" in row and any(cell.startswith("period-1 ") for cell in row) for row in agrees)
    assert any("period-4" in row and "no" in row for row in agrees)


def test_a_jam_is_said_in_words_with_its_temperature(
    tmp_path: Path, shown: dict[str, Picture]
) -> None:
    words = words_of(rendered(synthetic.build(tmp_path, jammed=True)))
    assert re.search(r"jammed\b.* 68 °C", words)
    assert "there is no motion" in words
    assert "−10" not in words[: words.index("Friction")]
    assert "fig-motion-0-0" in shown


HOSTILE = '<script>alert("x")</script> $\\frac{a}$ & \'"><img src=x>'


def test_hostile_texts_are_shown_and_never_obeyed(tmp_path: Path) -> None:
    synthetic.build(
        tmp_path,
        title=HOSTILE,
        bundles=(HOSTILE, "thesis"),
        without=GROUPS[2:-1],
        notices='[{"level": "<b>", "text": "<img src=x onerror=y>"}]',
        facts='[{"group": "<i>", "name": "<u>", "value": "<s>", "unit": "<q>"}]',
    )
    page = rendered(tmp_path).replace(f"<script>{script()}</script>", "")
    assert not re.search(r"<(script|img|u|q|s)\b", page)
    assert 'alert("x")' in words_of(page)
    assert "onerror=y>" in words_of(page)


def test_points_in_plenty_are_thinned_and_said_to_be(
    tmp_path: Path, shown: dict[str, Picture]
) -> None:
    three = synthetic.motion_group(("c",), (1.0, 2.0, 3.0), ("undeformed", "hot"), "state", False)
    wide = three.isel(operating=[0, 1, 2, 0, 1, 2, 0, 1])
    synthetic.write(tmp_path, {"motion": wide}, title="t", kind="gear")
    assert re.search(r"\b6 of 8 \w+ points", rendered(tmp_path))


def test_pictures_touch_no_global_state(tmp_path: Path) -> None:
    synthetic.build(tmp_path, without=(*GROUPS[:2], *GROUPS[3:]))
    code = (
        "import sys, matplotlib\n"
        "names = ('font.size', 'svg.hashsalt', 'axes.grid', 'figure.facecolor')\n"
        "matplotlib.rcParams['font.size'] = 21\n"
        "before = [matplotlib.rcParams[n] for n in names]\n"
        "from pathlib import Path\n"
        "from thermogear.views.write import write_report\n"
        f"write_report(Path({str(tmp_path)!r}))\n"
        "after = [matplotlib.rcParams[n] for n in names]\n"
        "print('matplotlib.pyplot' in sys.modules, after == before)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "True"]


def test_missing_results_are_an_error_in_one_line(tmp_path: Path) -> None:
    with pytest.raises(InputError) as caught:
        write_report(tmp_path)
    assert str(caught.value) == (
        f"results: got {tmp_path / 'results.nc'}; there is no such file; "
        "name a directory that this command, or `thermogear run CASE -o DIR`, has written"
    )


@pytest.mark.parametrize("damage", ["text", "cut", "zeros"])
def test_damaged_results_are_an_error_in_one_line(damage: str, tmp_path: Path) -> None:
    synthetic.build(tmp_path, without=GROUPS[1:])
    path = tmp_path / "results.nc"
    whole = path.read_bytes()
    middle = len(whole) // 2
    path.write_bytes({
        "text": b"not a data file",
        "cut": whole[:middle],
        "zeros": whole[:100] + bytes(middle) + whole[100 + middle :],
    }[damage])  # fmt: skip
    with pytest.raises(InputError, match=r"^results: got .*results\.nc; it ") as caught:
        write_report(tmp_path)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "report.html").exists()


def test_foreign_results_are_an_error_in_one_line(tmp_path: Path) -> None:
    with h5netcdf.File(tmp_path / "results.nc", "w") as file:
        file.dimensions["x"] = 3
        file.create_variable("y", ("x",), data=np.arange(3.0))
    with (
        pytest.warns(UnsealedWarning, match=r"no results\.nc\.sha256 beside it"),
        pytest.raises(InputError, match="it was not written by thermogear"),
    ):
        write_report(tmp_path)


def test_broken_tables_are_an_error_in_one_line(tmp_path: Path) -> None:
    synthetic.build(tmp_path, without=GROUPS, notices="[1, 2")
    with pytest.raises(InputError, match=r"results attribute notices: got text that is not"):
        write_report(tmp_path)
    synthetic.build(tmp_path, without=GROUPS, facts="[1, 2]")
    with pytest.raises(InputError, match=r"results attribute facts: got no list of rows"):
        write_report(tmp_path)
