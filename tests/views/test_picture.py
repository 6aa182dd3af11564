"""Pictures as data: they need no matplotlib, say their units, survive JSON and draw the same."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from itertools import chain
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest
import synthetic_pictures
import synthetic_results as synthetic
from test_versus_report import built, read_versus

from thermogear import pictures
from thermogear.views import drawing
from thermogear.views.pages import versus
from thermogear.views.picture import Axis, Mark, Panel, Picture, Top
from thermogear.views.style import COLD, INK, ramp
from traits import traits

UNIT = re.compile(r"\[[^\[\]]+\]")
FUNCTION = re.compile(r"^def ([a-z]\w*)\([^)]*\) -> Picture:", re.MULTILINE)


def of_json(said: dict[str, Any]) -> Picture:
    """The picture that its JSON tells of."""
    return Picture(**{**said, "panels": [[panel_of(one) for one in row] for row in said["panels"]]})


def panel_of(said: dict[str, Any]) -> Panel:
    def axis(words: dict[str, Any]) -> Axis:
        return Axis(**{name: value for name, value in words.items() if name != "unit"})

    kinds = {kind.__name__.lower(): kind for kind in drawing.DRAWN}
    marks = [
        kinds[mark["kind"]](**{name: value for name, value in mark.items() if name != "kind"})
        for mark in said["marks"]
    ]
    top = Top(**said["top"]) if said["top"] else None
    return Panel(**{**said, "x": axis(said["x"]), "y": axis(said["y"]), "top": top, "marks": marks})


def of_runs(place: Path) -> dict[str, Picture]:
    """Of pages of a gear pair, of a jammed one, of rows alone, and of two cases side by side."""
    shown = {
        "gear": pictures(synthetic.build(place / "gear", torques=(50.0, 100.0))),
        "jammed": pictures(synthetic.build(place / "jammed", jammed=True)),
        "rows": pictures(synthetic.build_dimensionless(place / "rows")),
    }
    found = {f"{run}/{n}": p.picture for run, every in shown.items() for n, p in every.items()}
    stored = read_versus(built(place / "versus"))
    both = stored.data.assign_attrs(stored.attrs)
    for name in ("deformation_sum", "half_backlash_curve"):
        found[f"versus/{name}"] = versus.curve(both, name, bundle=0, operating=0)
    return found | {"versus/spectrum": versus.spectrum(both, bundle=0, operating=0)}


MAKERS: set[tuple[str, str]] = set()
"""File and name of every function that has returned a picture."""


def watch(frame: FrameType, event: str, value: object) -> None:
    if event == "return" and isinstance(value, Picture):
        MAKERS.add((Path(frame.f_code.co_filename).stem, frame.f_code.co_name))


@pytest.fixture(scope="module")
def every(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Picture]:
    place, before = tmp_path_factory.mktemp("pictures"), sys.getprofile()
    sys.setprofile(watch)
    try:
        return of_runs(place) | synthetic_pictures.every()
    finally:
        sys.setprofile(before)


def svg(picture: Picture) -> bytes:
    return drawing.image(picture, "svg", salt="same")


def needed(every: dict[str, Picture]) -> list[str]:
    """The names of a few pictures that have all traits of ``every`` among them."""
    left = {name: set(traits(one.to_json())) for name, one in every.items()}
    found = []
    while any(left.values()):
        found.append(max(left, key=lambda name: len(left[name])))
        shown = left[found[-1]].copy()
        for rest in left.values():
            rest -= shown
    return found


def test_every_function_that_makes_a_picture_is_called(every: dict[str, Picture]) -> None:
    assert all(isinstance(one, Picture) for one in every.values())
    folder = Path(versus.__file__).parent
    texts = {path.stem: path.read_text("utf-8") for path in folder.glob("*.py")}
    assert {(n, one) for n, text in texts.items() for one in FUNCTION.findall(text)} <= MAKERS
    kinds = {type(m) for one in every.values() for panel in chain(*one.panels) for m in panel.marks}
    assert kinds == set(drawing.DRAWN)


def test_every_axis_has_words_and_a_unit_in_brackets(every: dict[str, Picture]) -> None:
    """Or names at its ticks, or the same axis as a panel below or beside it that has."""
    for name, one in every.items():
        for row, panels in enumerate(one.panels):
            for column, panel in enumerate(panels):
                x, y = panel.x, panel.y
                if one.share_x == "column":
                    x = one.panels[-1][column].x
                if one.share_y == "row":
                    y = one.panels[row][0].y
                for axis in (x, y):
                    assert len(axis.names) or UNIT.search(axis.words), (name, axis)


def test_json_holds_everything_and_draws_the_same(every: dict[str, Picture]) -> None:
    for name, one in every.items():
        text = json.dumps(one.to_json(), allow_nan=False)
        said = json.loads(text)
        for panel, told in zip(chain(*one.panels), chain(*said["panels"]), strict=True):
            for axis in ("x", "y"):
                assert told[axis]["words"] == getattr(panel, axis).words
                assert told[axis]["unit"] == getattr(panel, axis).unit
                assert told[axis]["unit"] in told[axis]["words"]
            labels = [getattr(mark, "label", "") for mark in panel.marks]
            assert [mark.get("label", "") for mark in told["marks"]] == labels
        assert of_json(said).to_json() == said, name
    alone = {name: one for name, one in every.items() if "/" not in name}
    for name in needed(alone):
        again = of_json(json.loads(json.dumps(alone[name].to_json())))
        assert svg(again) == svg(alone[name]), name


def test_values_are_told_as_they_are_and_gaps_as_nothing() -> None:
    panel = Panel(Axis("time t [ms]", low=0.0), Axis("force F [kN]", ticks=[1.0, 2.0]))
    panel.curve([0.0, 1.0, 2.0], np.array([1.0, np.nan, np.inf]), colour=COLD, dash=(5, 2))
    panel.field([0, 1], [0, 1], np.array([[3]]), colours=ramp(2), words="u [–]")
    panel.text(np.float64(1.0), 2, "here", at="data")
    told = Picture([[panel]], title="A title").to_json()
    (one,) = told["panels"][0]
    curve, field, text = one["marks"]
    assert (curve["kind"], curve["x"], curve["y"]) == ("curve", [0.0, 1.0, 2.0], [1.0, None, None])
    assert (curve["dash"], curve["colour"]) == ([5, 2], COLD)
    assert (field["values"], field["words"], text["x"]) == ([[3.0]], "u [–]", 1.0)
    assert (one["x"]["unit"], one["y"]["unit"], one["y"]["ticks"]) == ("ms", "kN", [1.0, 2.0])
    assert told["title"] == "A title"


def test_what_is_seen_of_the_data_is_what_matplotlib_shows() -> None:
    curves: list[Mark] = []
    for values in ([1.0, 3.0, np.nan], [2.0, 2.0, 2.0], [0.0, 0.0, 0.0]):
        panel = Panel(Axis("x [–]"), Axis("y [–]"))
        panel.curve([0.0, 1.0, 4.0], values, colour=INK)
        (axes,) = drawing.draw(Picture([[panel]])).axes
        np.testing.assert_allclose(axes.get_ylim(), panel.extent("y"))
        np.testing.assert_allclose(axes.get_xlim(), panel.extent("x"))
        curves += panel.marks
    assert len(curves) == 3


def test_pictures_are_made_without_matplotlib(tmp_path: Path) -> None:
    """Importing every plot, and making pictures and pages ready, loads none of it."""
    code = (
        "import sys, importlib, pkgutil\n"
        "import thermogear.views.plots as plots\n"
        "for one in pkgutil.iter_modules(plots.__path__):\n"
        "    importlib.import_module(f'thermogear.views.plots.{one.name}')\n"
        "import thermogear.views.write\n"
        f"sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "import synthetic_pictures\n"
        "[one.to_json() for one in synthetic_pictures.every().values()]\n"
        "print([name for name in sys.modules if name.startswith('matplotlib')])\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
