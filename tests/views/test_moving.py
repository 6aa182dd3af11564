"""Pictures that move: what the page holds for its script, and what a browser makes of it."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
from collections.abc import Iterator
from importlib.resources import files
from itertools import chain
from pathlib import Path
from typing import Any

import browser
import numpy as np
import pytest
import synthetic_pictures
import synthetic_results as synthetic
from markupsafe import Markup, escape

from thermogear.results.result import Result
from thermogear.views import page as pages
from thermogear.views.moving import (
    Dial,
    attribute,
    compact,
    distinct,
    moves,
    moving,
    policy,
    script,
)
from thermogear.views.page import Gallery, Page, Section, Shown, render
from thermogear.views.pages import dial as dial_plot
from thermogear.views.picture import Axis, Contours, Field, Hatch, Panel, Picture, Points
from thermogear.views.write import write_report

HOSTILE = """</script><img src=x onerror="window.bad=1"> '"]]>&lt; \\$ $_{<b>}$"""


def arrays(said: dict[str, Any]) -> list[list[float | None]]:
    """The arrays of a picture as the script spreads them."""
    return [
        one if isinstance(one, list) else np.linspace(one["from"], one["to"], one["n"]).tolist()
        for one in said["arrays"]
    ]


def spread(mark: dict[str, Any], name: str, known: list[list[float | None]]) -> list[Any]:
    value = mark.get(name, [])
    return known[value["in"]] if isinstance(value, dict) else value


def test_the_script_gets_every_place_of_every_picture() -> None:
    worst, seen = 0.0, 0
    for name, picture in synthetic_pictures.every().items():
        said = moving(picture)
        if not said:
            continue
        seen += 1
        told = json.loads(said)
        known = arrays(told)
        for panel, given in zip(chain(*picture.panels), chain(*told["panels"]), strict=True):
            assert len(panel.marks) == len(given["marks"])
            for mark, one in zip(panel.marks, given["marks"], strict=True):
                assert one["kind"] == type(mark).__name__.lower()
                for axis in ("x", "y"):
                    values = getattr(mark, axis, None)
                    if not isinstance(values, np.ndarray) or values.ndim != 1 or not values.size:
                        continue
                    shown = np.array(spread(one, axis, known), dtype=float)
                    finite = np.isfinite(values)
                    assert np.array_equal(finite, np.isfinite(shown)), name
                    if finite.any():
                        size = float(np.abs(values[finite]).max())
                        scale = (float(np.ptp(values[finite])) if values.size >= 8 else size) or 1.0
                        off = float(np.abs(shown - values)[finite].max())
                        worst = max(worst, off / scale)
    print(f"{seen} pictures, worst place off by {worst:.1e} of its range")
    assert seen >= 20
    assert worst <= 1e-4


def test_numbers_over_decades_keep_their_digits() -> None:
    panel = Panel(y=Axis(log="decades"))
    values = np.geomspace(1e-12, 1.0, 30)
    panel.curve(np.arange(30.0), values, colour="#000000")
    told = json.loads(moving(Picture([[panel]])))
    assert arrays(told)[told["panels"][0][0]["marks"][0]["y"]["in"]] == pytest.approx(
        values, rel=1e-6
    )


def test_contours_hatches_turned_axes_and_clouds_stay_still() -> None:
    grid = {"x": [0, 1], "y": [0, 1], "values": [[0, 1], [1, 2]]}
    still = [
        Contours(**grid, levels=[0.5], words=["half"]),  # type: ignore[arg-type]
        Hatch(**grid),  # type: ignore[arg-type]
        Field(**grid, colours=["#000000"], levels=[0, 1]),  # type: ignore[arg-type]
    ]
    for mark in still:
        assert moving(Picture([[Panel(marks=[mark])]])) == ""
    assert not moves(Picture([[Panel(Axis(low=1.0, high=0.0))]]))
    assert not moves(Picture([[Panel(Axis(slant=30.0))]]))
    many = Panel()
    many.curve(np.zeros(40_000), np.zeros(40_000), colour="#000000")
    assert not moves(Picture([[many]]))


def test_a_cloud_keeps_a_point_for_every_place_one_can_see() -> None:
    rng = np.random.default_rng(5)
    x = np.repeat(np.linspace(0.0, 1.0, 200), 100)
    y = np.where(x < 0.5, np.sin(9.0 * x), rng.uniform(-1.0, 1.0, x.size))
    y[::777] = np.nan
    cloud = distinct(Points(x, y, colour="#000000"))
    assert isinstance(cloud, Points)
    kept = {(a, b) for a, b in zip(cloud.x, cloud.y, strict=True)}  # type: ignore[arg-type]
    assert kept <= {(a, b) for a, b in zip(x, y, strict=True)}
    assert len(kept) == np.size(cloud.x) < 0.6 * x.size
    known = np.isfinite(y)
    places = np.stack([np.asarray(cloud.x), np.asarray(cloud.y)], axis=1)
    for a, b in zip(x[known][::50], y[known][::50], strict=True):
        assert np.abs(places - [a, b]).max(axis=1).min() < 2.0 / 2000


def test_one_script_by_its_hash_and_nothing_else_is_allowed() -> None:
    known = base64.b64encode(hashlib.sha256(script().encode()).digest()).decode()
    assert policy().startswith(f"default-src 'none'; script-src 'sha256-{known}';")
    folder = files("thermogear.views") / "script"
    for name in ("gears.js", "marks.js", "pictures.js"):
        text = (folder / name).read_text("utf-8")
        for word in ("innerHTML", "insertAdjacent", "document.write", "eval(", "fetch(", "import "):
            assert word not in text, (name, word)
    assert "]]>" not in script()[:-3]
    assert "</script" not in script()
    assert (folder / "uplot.LICENSE").read_text("utf-8").strip() in script()


def test_words_in_attributes_end_nowhere() -> None:
    said = attribute(compact({"words": HOSTILE}))
    assert not set("<>'") & set(said)
    assert json.loads(html.unescape(said)) == {"words": HOSTILE}


# --- in a browser ---------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def chromium() -> Iterator[browser.Browser | None]:
    with browser.maybe() as one:
        yield one


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run's page with all its pictures, and with texts that try to get out."""
    place = tmp_path_factory.mktemp("moving")
    return write_report(synthetic.build(place, title="A pair " + HOSTILE))


CANVAS = """[...document.querySelectorAll("#fig-dial canvas")].filter(c => c.closest(".plot"))
  .map(c => [...c.toDataURL()].reduce((h, l) => (31 * h + l.charCodeAt(0)) % 1e9, 7)).join()"""
TURN = """(() => { const r = document.querySelector("#fig-dial input[type=range]");
  const start = performance.now(); r.value = PLACE; r.dispatchEvent(new Event("input"));
  return [performance.now() - start, document.querySelector("#fig-dial output").textContent,
    r.getAttribute("aria-valuetext")]; })()"""
FRAME = "new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(1))))"


@pytest.mark.slow
def test_the_dial_turns(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, data = browser.there(chromium, capsys), synthetic.dial_group()
    sight = one.look(page, 1400)
    assert sight.sound, sight.faults
    seen, times = set(), []
    for place, kelvin in enumerate(data["gear_temperature"].values):
        took, said, value = one.value(TURN.replace("PLACE", str(place)))
        one.value(FRAME)
        seen.add(one.value(CANVAS))
        times.append(took)
        assert value == f"{kelvin - 273.15:.4g} °C"
        assert said == f"{value}: {dial_plot.told(data, place)}"
        half = re.search(r"half backlash ([\d.]+) µm", said)
        assert half
        assert float(half[1]) == pytest.approx(1e6 * float(data["half_backlash"][place]), 5e-3)
    with capsys.disabled():
        print(f"\ndial: script of a turn at most {max(times):.1f} ms")
    assert len(seen) == data.sizes["gear_temperature"]


def empty_box(picture: Picture, name: str, title: str) -> Markup:
    """In place of what matplotlib draws of a picture: its size alone."""
    width, height = (72.0 * one for one in picture.size)
    return Markup(
        f'<svg viewBox="0 0 {width:g} {height:g}" role="img" aria-labelledby="{name}-title">'
        f'<title id="{name}-title">{escape(title)}</title></svg>'
    )


@pytest.mark.slow
def test_every_picture_is_drawn(
    chromium: browser.Browser | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Those of every study, and one without a single number; by the script alone.

    What matplotlib draws of them, the script puts its own in place of: `test_picture.py`.
    """
    one = browser.there(chromium, capsys)
    monkeypatch.setattr(pages, "draw", empty_box)
    empty = Panel(Axis("speed [rpm]"), Axis("λ [–]", log="decades"))
    empty.curve([1.0] * 9, [np.nan] * 9, colour="#0072B2", label="nothing")
    empty.points([], [], colour="#0072B2", label="no place")
    every = {**synthetic_pictures.every(), "empty": Picture([[empty]])}
    shown = [
        Shown(re.sub(r"\W", "-", name), name, "", lambda picture=picture: picture)  # type: ignore[misc]
        for name, picture in every.items()
    ]
    result = Result.of("gear", "Every picture", {}, [])
    page = tmp_path / "every.html"
    page.write_text(render(Page(result, "", [Section("s", "s", [Gallery(shown)])])), "utf-8")
    sight = one.look(page, 1400)
    assert not sight.faults["errors"], sight.faults
    moving_ = page.read_text("utf-8").count("data-picture='")
    assert one.value("document.querySelectorAll('.live').length") == moving_ > 20


@pytest.mark.slow
def test_curves_go_and_come_and_zoom_goes_back(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = browser.there(chromium, capsys)
    one.look(page, 1400)
    press = """(() => { const b = [...document.querySelectorAll("#fig-dial button")]
      .find(b => (b.getAttribute("aria-label") || b.textContent) === NAME); b.click();
      return b.getAttribute("aria-pressed"); })()"""

    def pressed(name: str) -> tuple[Any, str]:
        state = one.value(press.replace("NAME", json.dumps(name)))
        one.value(FRAME)
        return state, one.value(CANVAS)

    home = one.value(CANVAS)
    off, without = pressed("hottest")
    on, again = pressed("hottest")
    assert (off, on) == ("false", "true")
    assert without != home
    assert again == home
    _, near = pressed("zoom in")
    assert not set(near.split(",")) & set(home.split(","))
    assert pressed("show all")[1] == home
    key = """(() => { document.querySelector("#fig-dial .live")
      .dispatchEvent(new KeyboardEvent("keydown", {key: KEY, bubbles: true})); })()"""
    for name, same in (("+", False), ("0", True), ("ArrowLeft", False), ("0", True)):
        one.value(key.replace("KEY", json.dumps(name)))
        one.value(FRAME)
        assert (one.value(CANVAS) == home) is same, name


@pytest.mark.slow
def test_the_pointer_reads_values_with_units(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In the middle of the backlash's panel: what is told is a point of the stored data."""
    one = browser.there(chromium, capsys)
    one.look(page, 1400)
    said = one.value(
        """(() => { const over = document.querySelectorAll("#fig-dial .u-over")[1];
        const box = over.getBoundingClientRect();
        over.dispatchEvent(new MouseEvent("mouseenter", {clientX: box.left, clientY: box.top}));
        over.dispatchEvent(new MouseEvent("mousemove", {bubbles: true,
          clientX: box.left + box.width / 2, clientY: box.top + box.height * 0.2}));
        return new Promise(r => setTimeout(() => r(
          [...over.querySelectorAll(".tip span")].map(s => s.textContent)), 100)); })()"""
    )
    data = synthetic.dial_group()
    values = {
        (f"{t - 273.15:.4g}\u00a0°C", f"{1e6 * b:.4g}\u00a0µm")
        for t, b in zip(data["gear_temperature"].values, data["half_backlash"].values, strict=True)
    }
    assert tuple(re.sub(r"^.*\] |^\D*(?=\d)", "", s) for s in said) in values


@pytest.mark.slow
def test_a_link_opens_the_part_it_leads_to(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = browser.there(chromium, capsys)
    one.look(page, 1400)
    opened = one.value(
        """(async () => {
          const folds = [...document.querySelectorAll("details")];
          folds.forEach(fold => { fold.open = false; });
          const found = [];
          for (const link of document.querySelectorAll("nav a")) {
            link.click();
            await new Promise(r => setTimeout(r, 30));
            found.push(document.getElementById(link.hash.slice(1)).getClientRects().length > 0);
          }
          return found; })()"""
    )
    assert len(opened) > 5
    assert all(opened)


@pytest.mark.slow
def test_hostile_words_stay_words_and_the_policy_holds(
    chromium: browser.Browser | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = browser.there(chromium, capsys)
    panel = Panel(Axis(HOSTILE + " [µm]"), Axis("y [–]"), HOSTILE)
    panel.curve([0.0, 1.0], [0.0, 1.0], colour="#0072B2", label=HOSTILE)
    panel.text(0.5, 0.5, HOSTILE)
    picture = Picture([[panel]])
    turned = Dial(HOSTILE, ["a", HOSTILE], [HOSTILE, HOSTILE], 0, lambda place: picture)
    shown = Shown("hostile", HOSTILE, HOSTILE, lambda: picture, dial=turned)
    result = Result.of("gear", HOSTILE, {}, [])
    bad = tmp_path / "bad.html"
    bad.write_text(
        render(Page(result, HOSTILE, [Section("s", HOSTILE, [Gallery([shown])])])), "utf-8"
    )
    for width in browser.WIDTHS:
        sight = one.look(bad, width)
        assert not sight.faults["errors"], sight.faults
        assert not sight.faults["wide"], sight.faults
    assert one.value("document.querySelectorAll('.live').length") == 1
    assert one.value("document.querySelectorAll('img,b,script').length") == 1
    assert one.value("window.bad === undefined")
    assert '</script><img src=x onerror="window.bad=1">' in one.value(
        "document.querySelector('.legend button').textContent"
    )
    one.value(
        "(() => { const s = document.createElement('script'); s.textContent = 'window.bad = 2';"
        "document.body.append(s); })()"
    )
    assert one.value("window.bad === undefined")


@pytest.mark.slow
def test_nobody_else_is_asked_and_without_script_the_still_picture_shows(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one = browser.there(chromium, capsys)
    one.look(page, 1400)
    assert one.value("document.querySelectorAll('.live').length") > 10
    assert {url.partition(":")[0] for url in one.asked()} <= {"file", "data"}
    one.ask("Emulation.setScriptExecutionDisabled", value=True)
    try:
        one._events.clear()
        one.ask("Page.navigate", url=page.resolve().as_uri())
        one._wait("Page.loadEventFired")
        count = "[...document.querySelectorAll('.canvas svg')].filter(s => s.clientWidth).length"
        still, live = one.value(count), one.value("document.querySelectorAll('.live').length")
    finally:
        one.ask("Emulation.setScriptExecutionDisabled", value=False)
    assert live == 0
    assert still == page.read_text("utf-8").count('<div class="canvas"')


@pytest.mark.slow
def test_readers_of_any_kind_can_use_the_page(
    chromium: browser.Browser | None, page: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the rules of axe-core: wide and light, narrow and dark, every fold open."""
    one = browser.there(chromium, capsys)
    axe = (files("axe_core_python") / "axe.min.js").read_text("utf-8")
    found = {}
    for width, colours in zip(browser.WIDTHS, ("light", "dark"), strict=True):
        one.scheme(colours)
        sight = one.look(page, width)
        assert sight.sound, sight.faults
        one.value(f"{axe};1")
        found[width] = one.value(
            "axe.run({resultTypes: ['violations']}).then(r => r.violations.map(v =>"
            "v.id + ': ' + v.nodes.map(n => n.target.join(' ')).slice(0, 3).join(', ')))"
        )
    one.scheme("light")
    assert not any(found.values()), found
