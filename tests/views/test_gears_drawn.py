"""The drawing as data, as a picture and as a file for a drawing program."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

import thermogear as tg
from own_pair import OWN_PAIR
from thermogear.base.errors import InputError
from thermogear.views.cad import put_dxf
from thermogear.views.gears import PINION, WHEEL, GearDrawing, gear_drawing
from thermogear.views.picture import Curve, Field, Points
from thermogear.views.plots.gears import MOST_TEETH, in_mesh
from thermogear.views.write import page_of


@pytest.fixture(scope="module")
def result() -> tg.Result:
    found = tg.drawing(tg.load_case(OWN_PAIR))
    assert isinstance(found, tg.Result)
    return found


@pytest.fixture(scope="module")
def drawing(result: tg.Result) -> GearDrawing:
    return gear_drawing(result.data)


def test_it_is_told_as_json_of_a_few_kilobytes(drawing: GearDrawing) -> None:
    told = drawing.to_json()
    text = json.dumps(told, separators=(",", ":"), allow_nan=False)
    assert len(text) < 30_000
    again = json.loads(text)
    assert [one["name"] for one in again["states"]] == ["undeformed", "hot"]
    assert [one["teeth"] for one in again["gears"]] == [19, 47]
    flat = np.array(again["states"][1]["outlines"][PINION])
    points = flat[0::2] + 1j * flat[1::2]
    assert points == pytest.approx(drawing.states[1].outlines[PINION], abs=1e-5)
    assert len(again["states"][0]["share"]) == len(again["phase"]) == 48


def test_the_factor_is_round_and_what_is_asked_for(result: tg.Result, drawing: GearDrawing) -> None:
    first = drawing.factor
    assert first / 10 ** np.floor(np.log10(first)) in (1.0, 2.0, 5.0)
    assert gear_drawing(result.data, factor=50.0).factor == 50.0


def test_the_picture_shows_what_it_says(drawing: GearDrawing) -> None:
    picture = in_mesh(drawing, 0.25)
    whole, mesh = picture.panels[0]
    assert whole.equal
    assert mesh.equal
    assert f"× {drawing.factor:g}" in mesh.title
    points = [m for m in mesh.marks if isinstance(m, Points) and m.size == 9.0]
    place = drawing.nearest(0.25)
    assert len(points) == int((drawing.states[1].share[place] > 0.0).sum())
    assert [m.words for m in mesh.marks if isinstance(m, Field)] == [
        "share of the load on a contact point"
    ]
    labels = [m.label for m in mesh.marks if isinstance(m, Curve) and m.label]
    assert [label.split(",")[0] for label in labels[:2]] == ["cold", "hot"]
    only = in_mesh(drawing, 0.25, "hot").panels[0][1]
    assert not any(m.label.startswith("cold") for m in only.marks if isinstance(m, Curve))


def test_the_picture_is_drawn_without_a_word(
    drawing: GearDrawing, caplog: pytest.LogCaptureFixture
) -> None:
    from thermogear.views.drawing import image

    assert image(in_mesh(drawing), "svg").startswith(b"<?xml")
    assert not caplog.records


def test_very_many_teeth_are_drawn_near_the_mesh_alone() -> None:
    case = tg.load_case(OWN_PAIR, ["gears.wheel.teeth=400", "gears.wheel.bore_radius=100 mm"])
    drawing = gear_drawing(tg.drawing(case, phase=0.0).data)
    whole = in_mesh(drawing, 0.0).panels[0][0]
    corners = [np.column_stack([m.x, m.y]) for m in whole.marks if isinstance(m, Curve)]
    wheel = np.concatenate([one for one in corners if one[:, 0].min() > 0.0])
    nearest = abs(wheel[:, 0] - drawing.pitch_point).min()
    assert nearest < drawing.module
    assert sum(len(one) for one in corners) < 40 * MOST_TEETH


def test_the_page_of_a_drawing(result: tg.Result, tmp_path: Path) -> None:
    page = page_of(result)
    assert any(line.lstrip().startswith("span") for line in page.lines())
    written = tg.save(result, tmp_path / "drawn")
    assert {"drawing.html", "drawing.nc", "drawing_gears.svg", "drawing_gears.png"} <= {
        path.name for path in written
    }
    assert tg.open_results(tmp_path / "drawn").kind == "drawing"


def test_what_cannot_be_drawn_is_refused_in_one_line() -> None:
    case = tg.load_case(OWN_PAIR)
    with pytest.raises(InputError, match=r"^phase: got 1\.5; allowed 0\.\.1; a part of one mesh"):
        tg.drawing(case, phase=1.5)
    with pytest.raises(InputError, match=r"^operating: got 2; allowed 1\.\.1$"):
        tg.drawing(case, operating=2)
    with pytest.raises(InputError, match=r"^bundle: got 'no'; allowed consistent"):
        tg.drawing(case, bundle="no")


def test_a_drawing_program_gets_true_outlines(tmp_path: Path) -> None:
    """Read back by the library itself: millimetres, layers, closed lines, their area and reach."""
    import ezdxf

    found = tg.drawing(tg.load_case(OWN_PAIR), phase=0.25, fineness=5)
    drawing = gear_drawing(found.data, factor=20.0)
    path = put_dxf(drawing, tmp_path / "a.dxf", place=0, shown=("undeformed", "hot"))
    document = ezdxf.readfile(path)
    assert document.units == ezdxf.units.MM
    lines = list(document.modelspace().query("LWPOLYLINE"))
    assert [line.dxf.layer for line in lines] == ["cold", "cold", "hot", "hot"]
    assert all(line.closed for line in lines)
    for line, gear, state in zip(lines, (0, 1, 0, 1), (0, 0, 1, 1), strict=True):
        points = np.array([complex(x, y) for x, y in line.get_points("xy")])
        one = drawing.states[state]
        about = points - drawing.centre(one, gear, factor=1.0)
        assert np.abs(about).max() == pytest.approx(np.abs(one.outlines[gear]).max(), abs=1e-9)
        assert points.size == drawing.teeth[gear] * (one.outlines[gear].size - 1)
    assert np.abs(np.abs(about).max() - 1e3 * found.data["tip_radius"].values[WHEEL]) < 0.2


def test_without_the_library_one_line_says_what_to_install(
    drawing: GearDrawing, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    with pytest.raises(
        InputError, match=r"checkout of thermogear: python -m pip install '.\[cad\]'"
    ):
        put_dxf(drawing, tmp_path / "a.dxf", place=0, shown=("hot",))
    assert not list(tmp_path.iterdir())
