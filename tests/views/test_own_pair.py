"""Pages of somebody's own gear pair: every word and figure is this pair's, none the thesis's."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterator
from functools import cache
from html import unescape

import numpy as np
import pytest
import xarray as xr

from coded import coded
from in_words import in_words
from own_pair import OWN_PAIR
from thermogear.case.case import GearCase, load_case, load_example
from thermogear.results.result import Result
from thermogear.study.contact import loaded_survey
from thermogear.study.friction import friction_survey
from thermogear.study.relief import relief_survey
from thermogear.study.run import run
from thermogear.study.temperature import thermal_map
from thermogear.thesis.errata import with_errata
from thermogear.views.drawing import draw
from thermogear.views.page import render
from thermogear.views.pages import captions
from thermogear.views.pages import temperature as map_plots
from thermogear.views.write import page_of

pytestmark = pytest.mark.filterwarnings("ignore:foundation of the gear")
SMALL = ["grid.path_positions=41", "grid.mesh_positions=48", "simulation.periods=16",
         "simulation.samples=32", "grid.harmonics=12", "simulation.discard=100"]  # fmt: skip
FOREIGN = re.compile(
    r"thesis|\brigs?\b|table 4|section 4\.1|errat|as printed|repaired|bifurcation study"
    r"|\b(25:75|20/60|1\.227|46 to 49|14 %|8315|9827|413|419\.7)\b",
    re.IGNORECASE,
)
"""Words and figures of the thesis, of its rig, and of the pairs of the finite elements."""


def own(*changes: str) -> GearCase:
    case = load_case(OWN_PAIR, [*SMALL, *changes])
    assert isinstance(case, GearCase)
    return case


def prose(html: str) -> str:
    """What a reader reads, pictures' labels included; the case file and sources left out."""
    text = re.sub(r"<style.*?</style>|<pre.*?</pre>", "", html, flags=re.DOTALL)
    text = re.sub(r'<section id="(sources|version)".*?</section>', "", text, flags=re.DOTALL)
    return " ".join(unescape(re.sub(r"<[^>]+>", " ", text)).split())


@pytest.fixture(autouse=True, scope="module")
def _told() -> Iterator[None]:
    """Pages are read for their words: those of their pictures are the same drawn or not."""
    with in_words():
        yield


@pytest.fixture(scope="module")
def results() -> Result:
    return run(own('temperatures.row=["60 degC", "100 degC"]'))


def page(result: Result) -> str:
    return render(page_of(result))


@pytest.fixture(scope="module")
def told(results: Result) -> str:
    """What the page of the run says."""
    return prose(page(results))


def test_the_page_of_a_run_is_this_pairs(results: Result, told: str) -> None:
    assert FOREIGN.findall(told) == []
    assert "Errata" not in told
    assert not any(name.startswith("base_sets") for name in results.groups)
    assert json.loads(results.text("errata") or "[]") == []
    assert "thesis" not in results.text("citations")
    assert "printed_x" not in results.groups["profile"]


def test_the_regime_is_the_films_and_not_the_laws(results: Result, told: str) -> None:
    film = results.groups["path"]["film_parameter"].values
    assert film.max() < 1.0  # boundary lubrication, whatever the law is made for
    assert "boundary" in told
    assert "mixed" not in told.partition("choices")[0]
    assert "lubricated" in told


@pytest.mark.parametrize("bundle", ["thesis", "both"])
def test_the_textbook_stiffness_is_held_against_this_pair(bundle: str) -> None:
    tree = run(own(f"model.bundle={bundle}", 'draw.pictures=["path"]'))
    cold = tree["mesh"].to_dataset().sel(bundle="thesis", state="undeformed").isel(operating=0)
    over = [
        float(cold["mean_stiffness"] / cold[f"{body}_stiffness"]) - 1.0
        for body in ("rim", "bore_clamped")
    ]
    (told,) = coded(tree.notices)["stiffness_is_textbook_sum"]
    assert [told["over_rim"], told["over_clamped"]] == over
    text = prose(page(tree))
    # the bundle is called by its name; nothing is said of the thesis's claims
    for found in FOREIGN.findall(text):
        assert found in ("", "thesis"), found
    for claim in ("thesis's bifurcation", "Errata", "Two regimes"):
        assert claim not in text


def test_a_copy_of_the_rig_with_other_gears_is_no_rig() -> None:
    changed = ["gears.wheel.teeth=60", "gears.wheel.tip_diameter=310 mm",
               "operating.speed=1000 rpm", 'draw.pictures=["base-sets"]']  # fmt: skip
    tree = run(load_example("rig", [*SMALL, *changed]))
    codes = coded(tree.notices)
    assert "base_sets_left_out" in codes
    assert "base_sets" not in tree.tree.children
    assert "two_regimes" not in codes


def test_the_rig_keeps_what_belongs_to_the_thesis() -> None:
    case = load_example("rig", [*SMALL, 'draw.pictures=["path", "profile", "base-sets"]',
                                "operating.speed=1000 rpm"])  # fmt: skip
    tree = with_errata(run(case), case)
    assert len(json.loads(tree.attrs["errata"])) == 20
    assert set(tree["base_sets"].children) == {"table-4.2", "section-4.1"}
    text = prose(page(tree))
    for said in ("Two regimes", "Errata of the thesis", "as printed"):
        assert said in text


# --- surveys ------------------------------------------------------------------------------


def survey_page(tree: Result) -> str:
    return prose(page(tree))


@cache
def surveyed(make: Callable[[GearCase], Result]) -> tuple[Result, str]:
    """A survey of the own pair, and what its page says."""
    tree = make(own())
    return tree, survey_page(tree)


@pytest.mark.parametrize("make", [friction_survey, loaded_survey, relief_survey])
def test_pages_of_surveys_are_this_pairs(make: Callable[[GearCase], Result]) -> None:
    _, text = surveyed(make)
    assert FOREIGN.findall(text) == []
    assert "second picture" not in text


def test_captions_of_the_relief_are_its_curves() -> None:
    tree, text = surveyed(relief_survey)
    loads = tree["loads"]
    without, with_it = loads["peak_to_peak_error"].values
    worse = loads["load"].values[with_it > without]
    assert re.search(rf"\b{worse[0]:.3g} \w+ {worse[-1]:.3g} N m", text)


def test_one_load_is_drawn_once() -> None:
    text = survey_page(loaded_survey(own(), [40.0]))
    assert "1 load" in text
    assert "hardens" not in text


@pytest.mark.parametrize("count", [1, 3])
def test_a_point_and_a_line_of_the_map(count: int) -> None:
    case = own("oil.scuffing_load_stage=12")
    speeds = np.linspace(100.0, 200.0, count)
    tree = thermal_map(case, speeds, case.torques)
    grid = tree["map"].to_dataset()
    text = survey_page(tree)
    assert FOREIGN.findall(text) == []
    assert ("over speed" in text) == (count > 1)
    assert "Hatched" not in text
    assert "White" not in text
    if count == 1:
        assert "1 operating" in text
        return
    for axes in draw(map_plots.thermal_map(grid)).axes:
        assert axes.get_xlabel().endswith("[rpm]")
        assert "torque" not in axes.get_ylabel()
        assert axes.get_ylabel().endswith("]")


# --- regimes ------------------------------------------------------------------------------


def test_regimes_are_those_of_the_path() -> None:
    s = np.linspace(0.0, 0.01, 101)
    rows = {
        "boundary": np.zeros(101),
        "boundary, mixed": np.where(s > 0.00501, 1, 0),
        "boundary, elastohydrodynamic": np.where(np.arange(101) % 2, 0, 2),
    }
    flags = {"flag_meanings": "boundary mixed elastohydrodynamic"}
    for words, index in rows.items():
        data = xr.Dataset(
            {
                "regime": (("operating", "path_position"), index[None].astype(np.int8), flags),
                "film_parameter": (("operating", "path_position"), 0.4 + index[None]),
            },
        )
        assert captions.regimes(data).endswith(f": {words}.")
