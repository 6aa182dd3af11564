"""The script that turns the gears on a page: in a browser, against the places Python computes."""

from __future__ import annotations

import cmath
import json
from pathlib import Path
from typing import Any

import browser
import numpy as np
import pytest

import thermogear as tg
from own_pair import OWN_PAIR
from said import numbers
from thermogear.views import page as pages
from thermogear.views.gears import GearDrawing, gear_drawing

SCRIPT = Path(pages.__file__).parent / "script" / "gears.js"
POLICY = "default-src 'none'; script-src 'unsafe-inline'"
HTML = """<!doctype html><html lang="en"><head><meta charset="utf-8"><title>Gears</title>
<meta http-equiv="Content-Security-Policy" content="{policy}"></head><body><main><h1>Gears</h1>
<div id="g"></div></main><script>{script}
drawGears(document.getElementById("g"), {data});</script></body></html>"""
TEETH = """[...document.querySelectorAll("g.wheel.hot")].map(g => {
  const m = g.transform.baseVal.consolidate().matrix; return [m.a, m.b, m.e, m.f]; })"""
MOVE = """(() => { const s = document.querySelector("input[type=range]"); s.value = PLACE;
  s.dispatchEvent(new Event("input")); return s.getAttribute("aria-valuetext"); })()"""


def test_the_script_makes_no_html_and_asks_for_nothing() -> None:
    text = SCRIPT.read_text("utf-8")
    assert text.startswith('"use strict";')
    for word in ("innerHTML", "insertAdjacentHTML", "document.write", "eval(", "fetch(", "import "):
        assert word not in text


@pytest.fixture(scope="module")
def drawing() -> GearDrawing:
    return gear_drawing(tg.drawing(tg.load_case(OWN_PAIR)).data, factor=10.0)


@pytest.mark.slow
def test_the_page_turns_the_gears_as_python_places_them(
    drawing: GearDrawing, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program = browser.find()
    if program is None:
        with capsys.disabled():
            print("\nno browser (package chromium): the script of the gears is not run")
        return
    page = tmp_path / "gears.html"
    told: dict[str, Any] = drawing.to_json()
    page.write_text(
        HTML.format(policy=POLICY, script=SCRIPT.read_text("utf-8"), data=json.dumps(told)), "utf-8"
    )
    hot = drawing.state("hot")
    with browser.opened(program) as one:
        for width in browser.WIDTHS:
            sight = one.look(page, width)
            assert sight.sound, sight.faults
        for place in (0, 7, 47):
            said = one.value(MOVE.replace("PLACE", str(place)))
            assert numbers(said) == [round(float(drawing.phase[place]), 2)]
            first, *_ = one.value(TEETH)
            turn, at = complex(first[0], first[1]), complex(first[2], first[3])
            assert at == pytest.approx(drawing.centre(hot, 1), abs=1e-4)
            step = 2.0 * np.pi / drawing.teeth[1]
            teeth = (cmath.phase(turn) - drawing.axis(hot, 1, phase=place)) / step
            assert teeth == pytest.approx(round(teeth), abs=1e-4)
            dots = one.value(
                "[...document.querySelectorAll('svg text')].map(t => t.textContent).join(' ')"
            )
            shares = [f"{100 * s:.0f} %" for s in hot.share[place] if s > 0.0]
            assert all(share in dots for share in shares)
        names = one.value(
            "[...document.querySelectorAll('input,select')].every(c => c.labels.length === 1)"
        )
        assert names
        hidden = one.value(
            "(() => { const b = document.querySelectorAll('input[type=checkbox]')[1]; b.click();"
            " return [...document.querySelectorAll('g.hot')]"
            ".every(g => g.style.display === 'none'); })()"
        )
        assert hidden
