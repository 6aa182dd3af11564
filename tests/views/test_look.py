"""A page as a browser shows it: nothing is wider than the page, cut, covered or dead."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

import browser
import look
import pytest
import synthetic_results as synthetic

from thermogear.views.write import write_report

HELD = {"table": "scroll", "svg": "canvas"}
"""What may be wider than a phone, and the box in which it scrolls."""


def unheld(page: Path) -> list[str]:
    """Tables and pictures that stand outside a box of their own; references without an end."""
    root = ElementTree.fromstring(
        page.read_text(encoding="utf-8").removeprefix("<!DOCTYPE html>").strip()
    )
    parents = {child: one for one in root.iter() for child in one}
    found = [
        one.tag
        for one in root.iter()
        if one.tag in HELD and parents[one].get("class") != HELD[one.tag]
    ]
    names = {one.get("id") for one in root.iter()}
    targets = [one.get("href", "") for one in root.iter("a")]
    return found + [to for to in targets if to.startswith("#") and to[1:] not in names]


@pytest.mark.slow
def test_no_element_is_wider_than_the_page(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = write_report(synthetic.build(tmp_path, title="A" + "long" * 30, torques=(50.0, 100.0)))
    program = browser.find()
    assert unheld(page) == []
    if program is None:
        # without a browser the page's boxes alone are checked
        with capsys.disabled():
            print("\nno browser (package chromium): the page is checked by its elements alone")
        return
    with browser.opened(program) as one:
        for width in browser.WIDTHS:
            sight = one.look(page, width)
            assert sight.scroll <= width
            assert sight.sound, sight.faults


@pytest.mark.slow
def test_faults_are_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A page with one fault of each kind: what the checks are worth."""
    page = tmp_path / "bad.html"
    page.write_text(
        '<!DOCTYPE html><html><head><meta name="viewport" content="width=device-width"/></head>'
        '<body style="margin:0"><p id="broad" style="width:1500px">broad</p>'
        '<img src="none.png" alt=""/><a href="#nowhere">a</a><a href="none.html">b</a>'
        '<figure id="f"><svg viewBox="0 0 100 50" width="200"><text x="10" y="20" '
        'font-size="8">one</text><text x="11" y="20" font-size="8">two</text>'
        '<text x="10" y="40" font-size="2">tiny</text><text x="95" y="40" font-size="8">cut off'
        '</text></svg></figure><script>console.error("said"); none();</script></body></html>',
        encoding="utf-8",
    )
    program = browser.find()
    if program is None:
        with capsys.disabled():
            print("\nno browser (package chromium): that faults are found is not checked")
        assert look.main(["out", str(page)]) == 2
        return
    with browser.opened(program) as one:
        faults = one.look(page, 1400, tmp_path / "png").faults
    assert any("p#broad" in what for what in faults["wide"])
    assert faults["broken"] == ["none.png"]
    assert faults["dead"] == ["#nowhere", "none.html"]
    assert any("tiny" in what for what in faults["small"])
    assert any("cut" in what for what in faults["cut"])
    assert any('"one" on "two"' in what for what in faults["over"])
    assert any("said" in what for what in faults["errors"])
    assert (tmp_path / "png" / "bad-1400-01.png").read_bytes().startswith(b"\x89PNG")


def test_without_a_browser_the_package_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(browser, "find", lambda: None)
    assert look.main(["out", "page.html"]) == 2
    said = capsys.readouterr().out
    assert said.count("\n") == 1
    assert "chromium" in said
