"""The app's page in a real browser: dials, keys, bad values, narrow and dark, server gone."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from importlib.resources import files
from pathlib import Path

import browser
import pytest
from served import Served, served

from thermogear.case.case import load_case
from thermogear.front.cli import main

pytestmark = pytest.mark.slow

CHANGES = (
    "operating.speed=4500 rpm", "grid.mesh_positions=48", "grid.path_positions=41",
    "grid.harmonics=12",
)  # fmt: skip
RIG = ("rig", *(word for change in CHANGES for word in ("--set", change)))
"""The case of the page: on coarser grids than its own, so that the tests are quick."""
STATE = "document.getElementById('state').textContent"
COUNT = 6
RANGE = (4400, 5200)
"""Speeds of the run-up, and from where to where [rpm]: few, and off the resonances, whose many
branches take a hundred times as long, so that the tests are quick."""


@pytest.fixture(scope="module")
def server() -> Iterator[Served]:
    with served(*RIG) as one:
        yield one


@pytest.fixture(scope="module")
def shared() -> Iterator[browser.Browser | None]:
    with browser.maybe() as one:
        yield one


@pytest.fixture(scope="module")
def opened(server: Served, shared: browser.Browser | None) -> browser.Browser | None:
    """The page, few speeds asked for, everything there."""
    if shared is not None:
        shared.go(server.address)
        ready(shared)
    return shared


@pytest.fixture
def page(opened: browser.Browser | None, capsys: pytest.CaptureFixture[str]) -> browser.Browser:
    """The page as the case has it; the answers, which take a second, folded."""
    one = browser.there(opened, capsys)
    fold(one, "answers", False)
    one.value("document.getElementById('back').click()")
    done(one)
    return one


def fold(one: browser.Browser, part: str, open_: bool) -> None:
    said = "true" if open_ else "false"
    one.value(f"document.querySelector('[data-part=\"{part}\"]').open = {said}")


def ready(one: browser.Browser, count: int = COUNT) -> None:
    one.until("!!document.getElementById('count')?.value")
    between(one, *RANGE)
    put(one, "count", count)
    done(one)


def between(one: browser.Browser, low: float, high: float) -> None:
    """The ends of the run-up from the next wish on."""
    for name, value in (("low", low), ("high", high)):
        one.value(f"document.getElementById('{name}').value = '{value}'")


def put(one: browser.Browser, name: str, value: object) -> None:
    """Write a value into a field as a person does who leaves it then."""
    one.value(
        f"(() => {{ const e = document.getElementById({json.dumps(name)}); e.focus();"
        f"e.value = {json.dumps(str(value))}; e.dispatchEvent(new Event('change')); }})()"
    )


def done(one: browser.Browser) -> None:
    """Wait for the end of what was asked for last."""
    one.value(
        "new Promise(r => requestAnimationFrame(() => requestAnimationFrame(r))).then(() => 1)"
    )
    one.until("document.body.dataset.done === document.body.dataset.asked", 120)


def lines(one: browser.Browser, part: str) -> list[str]:
    found = one.value(
        f"[...document.querySelectorAll('[data-part=\"{part}\"] .lines li')]"
        ".map(e => e.textContent)"
    )
    return list(found)


def axe(one: browser.Browser) -> list[str]:
    one.value(f"{(files('axe_core_python') / 'axe.min.js').read_text('utf-8')};1")
    return list(
        one.value(
            "axe.run({resultTypes: ['violations']}).then(r => r.violations.map(v =>"
            "v.id + ': ' + v.nodes.map(n => n.target.join(' ')).slice(0, 3).join(', ')))"
        )
    )


BOXES = """(() => {
  const seen = [...document.querySelectorAll(
    ".bar > *, .knob, .part, .field, .panel, .legend button, #dials button, .range label")]
    .filter((e) => e.checkVisibility() && e.getBoundingClientRect().width);
  const found = [];
  for (let i = 0; i < seen.length; i++) for (let j = i + 1; j < seen.length; j++) {
    const a = seen[i], b = seen[j];
    if (a.contains(b) || b.contains(a)) continue;
    if (a.closest(".bar, #dials") !== b.closest(".bar, #dials")) continue;
    const p = a.getBoundingClientRect(), q = b.getBoundingClientRect();
    const w = Math.min(p.right, q.right) - Math.max(p.left, q.left);
    const h = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    if (w > 1 && h > 1) found.push(`${a.className || a.id} on ${b.className || b.id}`);
  }
  const wide = document.documentElement.scrollWidth - document.documentElement.clientWidth;
  return {found, wide};
})()"""


def test_the_page_shows_every_part_and_asks_nobody_else(
    opened: browser.Browser | None, server: Served, capsys: pytest.CaptureFixture[str]
) -> None:
    page = browser.there(opened, capsys)
    assert not page.errors
    assert {url.split("/")[2] for url in page.asked() if "//" in url} == {server.host}
    for part in ("mesh", "gap", "run-up", "orbit"):
        assert page.value(f"!!document.querySelector('[data-part=\"{part}\"] canvas')"), part
    assert page.value("document.querySelectorAll('[data-part=answers] tbody tr').length") > 10
    assert page.value("document.querySelectorAll('[data-part=gears] svg path').length") > 10
    assert page.value("document.title").startswith(load_case("rig").title)
    # what a canvas shows stands beside it as text
    assert all(lines(page, part) for part in ("mesh", "run-up", "orbit"))


def test_what_the_page_shows_is_what_the_commands_print(
    page: browser.Browser, capsys: pytest.CaptureFixture[str]
) -> None:
    """Digit for digit, after a dial was turned: orbit, answers, and the command beside them."""
    fold(page, "answers", True)
    put(page, "dial-gears-number", 127.3)
    done(page)
    words = shlex.split(page.value("document.getElementById('command').textContent"))
    assert words[:3] == ["thermogear", "run", "rig"]
    assert words[-2:] == ["-o", "results"]
    changes = words[3:-2]
    assert "temperatures.pinion_addendum=127.3 degC" in changes
    capsys.readouterr()
    assert main(["orbit", "rig", *changes]) == 0
    printed = capsys.readouterr().out.splitlines()
    shown = page.value("document.querySelector('[data-part=orbit] pre').textContent").splitlines()
    assert [one for one in printed if not one.startswith("- ")] == [
        one for one in shown if not one.startswith("- ")
    ]
    assert len(shown) > 8
    assert main(["answers", "rig", *changes, "--json"]) == 0
    answers = {one["sentence"] for one in json.loads(capsys.readouterr().out)["answers"]}
    rows = page.value(
        "[...document.querySelectorAll('[data-part=answers] tbody tr')]"
        ".map(r => r.children[2].textContent)"
    )
    assert len(rows) > 10
    assert set(rows) <= answers


def test_a_bad_value_is_told_and_nothing_is_lost(page: browser.Browser) -> None:
    before = lines(page, "mesh")
    put(page, "dial-backlash-number", -1)
    page.until(f"{STATE}.startsWith('backlash.value')")
    assert page.value(STATE) == (
        "backlash.value: got '-1 mm'; allowed 1e-5..50 mm; a pair without backlash jams as soon as "
        'it warms up; write for instance "0.25 mm"'
    )
    assert page.value("document.getElementById('dial-backlash-number').ariaInvalid") == "true"
    assert lines(page, "mesh") == before
    assert page.value("!!document.querySelector('[data-part=mesh] canvas')")
    put(page, "dial-backlash-number", 0.3)
    done(page)
    assert lines(page, "mesh") != before
    assert "150.0 µm" in lines(page, "mesh")[0]
    assert page.value("document.getElementById('dial-backlash-number').ariaInvalid") is None
    # a field of the file below the dials is refused where it stands
    page.value("document.getElementById('every').open = true")
    put(page, "field-gears.module", "5")
    page.until(f"{STATE}.startsWith('gears.module')")
    assert page.value("document.getElementById('field-gears.module-wrong').textContent")
    put(page, "field-gears.module", "5 mm")
    put(page, "field-gears.pinion.roughness", "0.5 um")
    done(page)
    assert "gears.pinion.roughness=0.5 um" in page.value(
        "document.getElementById('command').textContent"
    )
    assert page.value("document.getElementById('field-gears.module-wrong').textContent") == ""


def test_ten_fast_moves_end_with_the_last(page: browser.Browser) -> None:
    first = int(page.value("document.body.dataset.asked"))
    between(page, 4000, 8000)  # long enough that no move of the ten has ended before the next
    page.value(
        """(async () => {
          const range = document.getElementById("dial-gears");
          for (let k = 1; k <= 10; k++) {
            range.value = 100 + k;
            range.dispatchEvent(new Event("input"));
            await new Promise((r) => setTimeout(r, 60));
          }
        })()"""
    )
    done(page)
    last = int(page.value("document.body.dataset.asked"))
    assert last - first <= 10
    assert page.value("document.getElementById('dial-gears-number').value") == "110"
    assert "110 degC" in page.value("document.getElementById('command').textContent")
    finished = json.loads(page.value("document.body.dataset.ends"))
    assert [one for one in finished if one > first] == [last]
    between(page, *RANGE)


def test_everything_by_keyboard_alone(page: browser.Browser) -> None:
    """Reach the gear temperature by Tab, turn it by arrows, type a number, pin, fold a part."""
    page.value("document.body.tabIndex = -1; document.body.focus(); 1")
    for _ in range(60):
        page.press("Tab")
        if page.value("document.activeElement.id") == "dial-gears":
            break
    assert page.value("document.activeElement.id") == "dial-gears"
    page.press("ArrowRight", 3)
    done(page)
    assert page.value("document.getElementById('dial-gears-number').value") == "143"
    page.press("Tab")
    page.value("document.activeElement.select()")
    page.write("120")
    page.press("Enter")
    done(page)
    assert "120 degC" in page.value("document.getElementById('command').textContent")
    page.value("document.getElementById('pin').focus()")
    page.press(" ")
    done(page)
    assert "120 °C" in page.value("document.getElementById('pinned').textContent")
    assert page.value(
        "[...document.querySelectorAll('[data-part=mesh] .legend button')]"
        ".some(b => b.textContent === 'pinned')"
    )
    page.value("document.querySelector('[data-part=gears] > summary').focus()")
    page.press("Enter")
    assert not page.value("document.querySelector('[data-part=gears]').open")
    assert page.value("getComputedStyle(document.activeElement).outlineStyle") != "none"


def test_a_click_on_the_run_up_shows_the_orbit_of_that_speed(page: browser.Browser) -> None:
    page.value(
        "document.querySelector('[data-part=\"run-up\"] .u-over')"
        ".scrollIntoView({block: 'center', behavior: 'instant'})"
    )
    box = page.value(
        "(() => { const r = document.querySelector('[data-part=\"run-up\"] .u-over')"
        ".getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()"
    )
    page.click(box[0] + 0.7 * box[2], box[1] + 0.5 * box[3])
    done(page)
    speed = float(page.value("document.getElementById('dial-speed-number').value"))
    assert 4600.0 < speed < 9000.0
    assert f"operating.speed={speed:g} rpm" in page.value(
        "document.getElementById('command').textContent"
    )
    assert f"{speed:.6g} rpm" in page.value(
        "document.querySelector('[data-part=orbit] pre').textContent"
    ) or "undecided" in " ".join(lines(page, "orbit"))


@pytest.mark.parametrize(("width", "colours"), [(1400, "light"), (390, "dark")])
def test_readers_of_any_kind_can_use_it(
    page: browser.Browser, width: int, colours: str, tmp_path: Path
) -> None:
    """axe-core finds nothing and nothing lies on anything, the form and every group open."""
    page.scheme(colours)
    page.ask("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1.0,
             mobile=width < 600)  # fmt: skip
    for form in (False, True):
        said = "true" if form else "false"
        page.value(
            f"for (const e of document.querySelectorAll('#dials details')) e.open = {said}; 1"
        )
        page.value("new Promise(r => setTimeout(r, 250)).then(() => 1)")
        boxes = page.value(BOXES)
        assert boxes == {"found": [], "wide": 0}, (width, form)
        assert axe(page) == [], (width, form)
    page.scheme("light")


def test_files_and_a_second_window(
    page: browser.Browser, server: Served, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The case file of what is shown gives the same case; another window is another state."""
    put(page, "dial-torque-number", 77)
    done(page)
    page.value(
        "window.kept = []; HTMLAnchorElement.prototype.click = function () {"
        "fetch(this.href).catch(() => 0); window.kept.push(this.download); }; 1"
    )
    page.value(
        "URL.createObjectURL = (b) => { b.text().then(t => { window.text = t; }); return '#'; }; 1"
    )
    page.value("document.getElementById('case').click()")
    page.until("window.text !== undefined")
    assert page.value("window.kept[0]") == "case.toml"
    (tmp_path / "mine.toml").write_text(page.value("window.text"), "utf-8")
    words = shlex.split(page.value("document.getElementById('command').textContent"))
    capsys.readouterr()
    assert main(["check", str(tmp_path / "mine.toml"), "--json"]) == 0
    own = json.loads(capsys.readouterr().out)
    assert main(["check", "rig", *words[3:-2], "--json"]) == 0
    assert own["facts"] == json.loads(capsys.readouterr().out)["facts"]
    program = browser.find()
    assert program is not None
    with browser.opened(program) as other:
        other.go(server.address)
        for part in ("gap", "run-up", "orbit", "answers", "gears"):
            fold(other, part, False)
        ready(other)
        assert other.value("document.getElementById('dial-torque-number').value") == "100"
        put(other, "dial-torque-number", 50)
        done(other)
    assert page.value("document.getElementById('dial-torque-number').value") == "77"


def test_the_heat_balance_turns_dials_into_results(page: browser.Browser) -> None:
    assert not page.value("document.getElementById('dial-gears').disabled")
    page.value("document.getElementById('heat').click()")
    done(page)
    assert page.value("document.getElementById('dial-gears').disabled")
    found = page.value("document.getElementById('dial-gears-number').value")
    assert found != "140"
    page.value("document.getElementById('heat').click()")
    done(page)
    assert not page.value("document.getElementById('dial-gears').disabled")


def test_a_server_that_ends_is_told_and_one_that_comes_back_is_used(
    page: browser.Browser, server: Served
) -> None:
    """The last test: it ends the server of the others."""
    assert server.end() in (0, 130)
    page.until(f"{STATE}.startsWith('the server does not answer')")
    assert page_kept(page)
    before = page.value("document.body.dataset.asked")
    same = (
        "import sys, thermogear.front.app.guard as g; g.new_token = lambda: "
        f"{server.token!r}; from thermogear.front.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    port = server.host.rpartition(":")[2]
    with served(*RIG, "--port", port, code=same):
        page.until(f"document.body.dataset.asked !== {before!r}", 60)
        done(page)
        assert page.value("document.getElementById('count').value") == str(COUNT)


def page_kept(one: browser.Browser) -> bool:
    return bool(one.value("!!document.querySelector('[data-part=mesh] canvas')"))
