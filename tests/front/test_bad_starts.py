"""How a new user goes wrong first: each told in one line, with its line of the file."""

from __future__ import annotations

from pathlib import Path

import pytest

from thermogear import load_case
from thermogear.front.cli import main

FIVE = """[gears]
module = "3 mm"
[gears.pinion]
teeth = 20
face_width = "30 mm"
[gears.wheel]
teeth = 40
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""
NARROW = "allowed 0.05..100 mm"

# what is written, in place of what; the whole message behind "error: ", or its beginning with ...
STARTS: dict[str, tuple[str, str, str]] = {
    "a German decimal comma": (
        '"3 mm"', '"3,5 mm"',
        f"line 2: gears.module: got '3,5 mm'; {NARROW}; decimals follow a point, not a comma; "
        'did you mean "3.5 mm"?',
    ),
    "a helix angle": (
        "[gears]\n", '[gears]\nhelix_angle = "15 deg"\n',
        "line 2: gears.helix_angle: got a helix angle; thermogear treats spur gears only; "
        "leave it out",
    ),
    "a pinion of four teeth": (
        "teeth = 20", "teeth = 4",
        "line 4: gears.pinion.teeth: got 4; allowed 5..2000; write for instance 25",
    ),
    "a centre distance too small": (
        "[gears]\n", '[gears]\ncentre_distance = "70 mm"\n',
        "line 2: gears.centre_distance: got 70 mm; allowed >= 90 mm; "
        "the teeth would wedge (no backlash left)",
    ),
    "a centre distance too large": (
        "[gears]\n", '[gears]\ncentre_distance = "120 mm"\n',
        "line 2: gears.centre_distance: got 120 mm, a contact ratio of ...",
    ),
    "a module in inches": (
        '"3 mm"', '"0.125 in"',
        f"line 2: gears.module: got '0.125 in'; {NARROW}; a module in inches; in inches gears are "
        'named by the diametral pitch, here 8 1/in; write the metric module "3.175 mm"',
    ),
    "a module in inches, by their mark": (
        '"3 mm"', "'.125\"'",
        f"line 2: gears.module: got '.125\"'; {NARROW}; a module in inches; in inches gears are "
        'named by the diametral pitch, here 8 1/in; write the metric module "3.175 mm"',
    ),
    "a diametral pitch of nothing": (
        '"3 mm"', '"0.1 1/in"',
        f"line 2: gears.module: got '254 mm'; {NARROW}; write for instance \"5 mm\"",
    ),
    "a diametral pitch by name": (
        'module = "3 mm"', "diametral_pitch = 8",
        "line 2: gears.diametral_pitch: got a diametral pitch; the field is module; "
        'write module = "8 1/in" for a diametral pitch of 8',
    ),
    "a text without unit": (
        '"3 mm"', '"3"',
        f"line 2: gears.module: got '3'; {NARROW}; the unit is missing; "
        'write for instance "3 mm"',
    ),
    "a bare number": (
        '"3 mm"', "3",
        f"line 2: gears.module: got 3; {NARROW}; a bare number has no unit; "
        'write for instance "3 mm"',
    ),
    "an unknown oil": (
        "[operating]", '[oil]\nname = "M10"\n[operating]',
        "line 9: oil.name: got 'M10'; allowed M32 | ...",
    ),
    "an unknown material": (
        "teeth = 20", 'teeth = 20\nmaterial = "stel"',
        "line 5: gears.pinion.material: got 'stel'; allowed steel | ...",
    ),
    "a value without quotes": (
        '"3 mm"', "3 mm",
        "bad.toml: got invalid TOML at line 2, column 12; Expected newline or end of document "
        'after a statement; a value with its unit stands in quotes: "5 mm"',
    ),
    "a bracket left open": (
        "[gears.wheel]", "[gears.wheel", "bad.toml: got invalid TOML at line 6, column 13; ...",
    ),
    "a table twice": (
        "[operating]", "[gears]\n[operating]",
        "bad.toml: got invalid TOML at line 8, column 7; ...",
    ),
    "a key twice": (
        "teeth = 40", "teeth = 40\nteeth = 41",
        "bad.toml: got invalid TOML at line 8, column 11; ...",
    ),
    "a pair at rest": (
        "3000 rpm", "0 rpm",
        "line 9: operating.speed: got '0 rpm'; allowed 0.1..500000 rpm; a gear at rest has no "
        'motion; write for instance "1000 rpm"',
    ),
}  # fmt: skip


def told(path: Path, capsys: pytest.CaptureFixture[str], command: str = "check") -> list[str]:
    """Lines of the terminal; the exit code is 2 and nothing stands on the standard output."""
    assert main([command, str(path)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert "Traceback" not in err
    return err.splitlines()


def agrees(line: str, expected: str) -> bool:
    line = line.removeprefix("error: ")
    if expected.endswith("..."):
        return line.startswith(expected.removesuffix("..."))
    return line == expected


@pytest.mark.parametrize("start", STARTS)
def test_a_bad_start_is_told_in_its_line(
    start: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old, new, expected = STARTS[start]
    assert old in FIVE
    path = tmp_path / "bad.toml"
    path.write_text(FIVE.replace(old, new), encoding="utf-8")
    for command in ("check", "answers"):
        (line,) = told(path, capsys, command)
        assert agrees(line, expected), line


def test_an_empty_file_and_a_directory(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "empty.toml"
    path.write_text("", encoding="utf-8")
    (line,) = told(path, capsys)
    assert line.startswith("error: empty.toml: got an empty file; ")
    (tmp_path / "cases").mkdir()
    (line,) = told(tmp_path / "cases", capsys)
    assert line == "error: cases: got a directory; allowed a case file (TOML)"


def test_several_bad_values_are_told_at_once_the_misspelt_key_first(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "bad.toml"
    text = FIVE.replace('"3 mm"', '"3,5 mm"').replace("teeth = 40", 'teeth = "x"')
    path.write_text(text.replace('"80 N m"', "80").replace("face_width", "face_widht"), "utf-8")
    lines = told(path, capsys)
    assert [line.split(":")[1:3] for line in lines] == [
        [" line 5", " gears.pinion.face_widht"],  # a misspelt key may explain the others
        [" line 2", " gears.module"],
        [" line 7", " gears.wheel.teeth"],
        [" line 10", " operating.torque"],
    ]


def test_a_metric_module_reads_as_before() -> None:
    for text, value in (("3 mm", 0.003), ("0.3 cm", 0.003), ("3000 um", 0.003)):
        case = load_case(FIVE.replace("3 mm", text))
        assert case.pair.pinion.module == pytest.approx(value, rel=1e-15)  # type: ignore[union-attr]
