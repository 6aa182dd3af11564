"""``thermogear new``: a short case of one's own, from options or asked at a terminal."""

from __future__ import annotations

import math
import os
import pty
import sys
import time
from pathlib import Path

import pytest

from thermogear.case.case import GearCase, load_case
from thermogear.front.cli import main
from thermogear.gears.deviations import PitchError
from thermogear.gears.population import drawn_pair
from thermogear.gears.turn import Eccentricity

NEEDED = {
    "--teeth": ["20", "40"],
    "--module": ["3 mm"],
    "--face-width": ["30 mm"],
    "--torque": ["80 N m"],
    "--speed": ["3000 rpm"],
}
ALL = {
    "--title": ["My pair"],
    "--profile-shift": ["0.2", "0.1"],
    "--centre-distance": ["91 mm"],
    "--material": ["18CrNiMo7-6", "16MnCr5"],
    "--oil": ["ISO VG 220"],
    "--oil-temperature": ["70 degC"],
    "--backlash": ["0.2 mm"],
    "--accuracy": ["5"],
}


def options(given: dict[str, list[str]]) -> list[str]:
    return [word for name, values in given.items() for word in (name, *values)]


def written(path: Path, given: dict[str, list[str]]) -> tuple[str, GearCase]:
    assert main(["new", *options(given), "-o", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    case = load_case(path)
    assert isinstance(case, GearCase)
    return text, case


def test_undercut_that_shortens_the_contact_is_taken_on_request(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    few = NEEDED | {"--teeth": ["13", "40"]}
    path = tmp_path / "mine.toml"
    assert main(["new", *options(few), "-o", str(path)]) == 2
    assert capsys.readouterr().err == (
        "error: gears.pinion.profile_shift: got 0 for 13 teeth; undercut takes 1.87468 mm of the "
        "path of contact; use x >= 0.16 or >= 16 teeth, where what is cut lies below the flank "
        "in use, or allow_undercut (`new --allow-undercut`) to have the rest of the path\n"
    )
    assert not path.exists()
    text, case = written(path, few | {"--allow-undercut": []})
    line = "allow_undercut = true   # may shorten the contact"
    assert text.splitlines().count(line) == 2
    assert case.pair.cut_short
    assert case.pair.start_radii[0] == pytest.approx(case.pair.pinion.form_radius, rel=1e-14)


@pytest.mark.parametrize("edge", ["tip-rounding", "tip-chamfer"])
def test_the_edge_of_the_tips_arrives_at_both_gears(edge: str, tmp_path: Path) -> None:
    text, case = written(tmp_path / "mine.toml", NEEDED | {f"--{edge}": ["0.2 mm"]})
    name = edge.replace("-", "_")
    assert text.count(f'{name} = "0.2 mm"') == 2
    for gear in (case.pair.pinion, case.pair.wheel):
        assert getattr(gear, name) == pytest.approx(0.2e-3, rel=1e-15)
        assert gear.tip_form_radius < gear.tip_radius


def test_run_outs_and_drawn_teeth_arrive_at_the_gears(tmp_path: Path) -> None:
    text, case = written(tmp_path / "out.toml", NEEDED | {"--run-out": ["20 um", "0.03 mm"]})
    assert text.count("run_out") == 2
    amounts = [one.amount for one in case.deviations if isinstance(one, Eccentricity)]
    assert amounts == pytest.approx([10e-6, 15e-6], rel=1e-14)
    _, drawn = written(tmp_path / "drawn.toml", NEEDED | {"--drawn-teeth": []})
    assert drawn.deviations == drawn_pair(drawn.pair, 6, seed=1)


def test_pitch_errors_arrive_at_their_teeth(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    errors = [0.5 * n - 4.0 for n in range(20)]
    listed = ", ".join(f"{error} um" for error in errors)
    _, case = written(tmp_path / "mine.toml", NEEDED | {"--pitch-errors": [listed, ""]})
    (index,) = [one for one in case.deviations if isinstance(one, PitchError)]
    assert index.gear == "pinion"
    assert index.errors == pytest.approx([1e-6 * error for error in errors], rel=1e-14)
    assert case.period.mesh_periods == 20
    given = NEEDED | {"--pitch-errors": ["", listed]}
    capsys.readouterr()
    assert main(["new", *options(given), "-o", str(tmp_path / "no.toml")]) == 2
    assert capsys.readouterr().err == (
        "error: gears.wheel.pitch_errors: got 20 values; allowed one for each of the 40 teeth\n"
    )


def test_an_edge_that_no_tip_has_room_for_is_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    given = NEEDED | {"--tip-chamfer": ["2 mm"]}
    assert main(["new", *options(given), "-o", str(tmp_path / "mine.toml")]) == 2
    assert capsys.readouterr().err == "".join(
        f"error: gears.{name}.tip_chamfer: got 2 mm; allowed < {largest} mm; no tip land or no "
        "involute flank is left; make the edge smaller\n"
        for name, largest in (("pinion", "1.04232"), ("wheel", "1.141"))
    )


def test_five_options_make_a_case_of_at_most_thirty_lines(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    text, case = written(path, NEEDED)
    assert len(text.splitlines()) <= 30
    assert capsys.readouterr().out.splitlines() == [str(path), f"next: thermogear answers {path}"]
    assert (case.pair.pinion.teeth, case.pair.wheel.teeth) == (20, 40)
    assert case.pair.pinion.module == pytest.approx(3e-3, rel=1e-15)
    assert case.pair.face_width == pytest.approx(30e-3, rel=1e-15)
    assert case.torques == pytest.approx([80.0], rel=1e-15)
    assert case.speeds == pytest.approx([100.0 * 3.141592653589793], rel=1e-12)


def test_every_option_at_once_stays_within_thirty_lines_and_arrives(tmp_path: Path) -> None:
    text, case = written(tmp_path / "mine.toml", NEEDED | ALL)
    assert len(text.splitlines()) <= 30
    assert all(len(line) <= 100 for line in text.splitlines())
    pinion, wheel = case.pair.pinion, case.pair.wheel
    assert case.title == "My pair"
    assert (pinion.profile_shift, wheel.profile_shift) == (0.2, 0.1)
    assert case.pair.centre_distance == pytest.approx(0.091, rel=1e-15)
    assert (pinion.material.name, wheel.material.name) == ("18CrNiMo7-6", "16MnCr5")
    assert case.accuracy == 5
    assert float(case.stated.half_backlash) == pytest.approx(1e-4, rel=1e-12)


def test_without_a_file_the_case_is_printed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["new", *options(NEEDED)]) == 0
    assert isinstance(load_case(capsys.readouterr().out), GearCase)


@pytest.mark.parametrize("left_out", NEEDED)
def test_a_missing_option_is_named_with_an_example(
    left_out: str, capsys: pytest.CaptureFixture[str]
) -> None:
    given = {name: values for name, values in NEEDED.items() if name != left_out}
    assert main(["new", *options(given)]) == 2
    example = NEEDED[left_out][0]
    example = "20 40" if left_out == "--teeth" else f'"{example}"'
    assert capsys.readouterr().err.splitlines() == [
        f"error: {left_out}: got nothing; a gear pair needs module, teeth, face width, torque and "
        f"speed; write {left_out} {example}"
    ]


def test_no_option_without_a_terminal_names_all_that_is_needed(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["new"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: --teeth, --module, --face-width, --torque, --speed: got nothing")


def test_an_existing_file_is_left_as_it_is(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("kept\n", encoding="utf-8")
    assert main(["new", *options(NEEDED), "-o", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "mine.toml" in line
    assert path.read_text(encoding="utf-8") == "kept\n"


@pytest.mark.parametrize("pitch", ["8 1/in", "8 DP"])
def test_a_pair_by_its_diametral_pitch(pitch: str, tmp_path: Path) -> None:
    """28 teeth of 8 to the inch: a pitch circle of 3.5 in, and so a centre distance."""
    given = {**NEEDED, "--module": [pitch], "--teeth": ["28", "28"], "--pressure-angle": ["25 deg"]}
    pair = written(tmp_path / "inch.toml", given)[1].pair
    assert pair.centre_distance == pytest.approx(3.5 * 25.4e-3, rel=1e-12)
    assert pair.pinion.pressure_angle == pytest.approx(math.radians(25.0), rel=1e-15)


@pytest.mark.parametrize(
    ("option", "values", "said"),
    [
        ("--module", ["3,5 mm"], "gears.module: got '3,5 mm'; allowed 0.05..100 mm; decimals "
         'follow a point, not a comma; did you mean "3.5 mm"?'),
        ("--module", ["0.125 in"], "gears.module: got '0.125 in'; allowed 0.05..100 mm; a module "
         "in inches; in inches gears are named by the diametral pitch, here 8 1/in; write the "
         'metric module "3.175 mm"'),
        ("--speed", ["0 rpm"], "operating.speed: got '0 rpm'; allowed 0.1..500000 rpm; a gear at "
         'rest has no motion; write for instance "1000 rpm"'),
    ],
)  # fmt: skip
def test_what_makes_no_case_writes_no_file(
    option: str,
    values: list[str],
    said: str,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = tmp_path / "mine.toml"
    assert main(["new", *options(NEEDED | {option: values}), "-o", str(path)]) == 2
    assert capsys.readouterr().err.splitlines() == [f"error: {said}"]
    assert not path.exists()


def asked(folder: Path, typed: str) -> tuple[int, str]:
    """(exit code, what the terminal showed) of ``new`` with no option, ``typed`` at its prompts."""
    child, terminal = pty.fork()
    if child == 0:  # pragma: no cover - the other process
        os.chdir(folder)
        os.execv(sys.executable, [sys.executable, "-m", "thermogear", "new"])
    os.write(terminal, typed.encode())
    shown, until = b"", time.monotonic() + 60.0
    while time.monotonic() < until:
        try:
            part = os.read(terminal, 4096)
        except OSError:  # the other end is closed
            break
        if not part:
            break
        shown += part
    _, status = os.waitpid(child, 0)
    os.close(terminal)
    return os.waitstatus_to_exitcode(status), shown.decode()


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are of POSIX")
def test_a_person_at_a_terminal_is_asked(tmp_path: Path) -> None:
    code, shown = asked(tmp_path, "21:43\n2.5 mm\n25 mm\n\n\nown.toml\n")
    assert code == 0, shown
    for question in ("Teeth of pinion", "Module", "Face width", "Torque", "Speed", "File to write"):
        assert question in shown
    case = load_case(tmp_path / "own.toml")
    assert isinstance(case, GearCase)
    assert (case.pair.pinion.teeth, case.pair.wheel.teeth) == (21, 43)
    assert case.torques == pytest.approx([80.0], rel=1e-15)  # the example, by return alone


@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals are of POSIX")
def test_a_bad_answer_at_the_terminal_is_one_line(tmp_path: Path) -> None:
    code, shown = asked(tmp_path, "20 40\n2,5 mm\n25 mm\n\n\nown.toml\n")
    assert code == 2
    assert '"2.5 mm"?' in shown
    assert "Traceback" not in shown
    assert not (tmp_path / "own.toml").exists()


def test_faults_are_written_and_refused_under_their_field(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    crack = ["--fault", "crack, gear=pinion, tooth=3, depth=2 mm"]
    spall = ["--fault", "spall,gear=wheel,length=2 mm,depth=0.1 mm,width_share=0.5"]
    path = tmp_path / "mine.toml"
    assert main(["new", *options(NEEDED), *crack, *spall, "-o", str(path)]) == 0
    case = load_case(path)
    assert isinstance(case, GearCase)
    kinds = [(fault.kind, fault.gear, fault.place) for fault in case.file.faults]
    assert kinds == [("crack", "pinion", 2), ("spall", "wheel", 0)]
    assert (case.file.faults[0].depth, case.file.faults[1].width_share) == (2e-3, 0.5)
    assert main(["new", *options(NEEDED), "--fault", "crak, gear=pinion"]) == 2
    assert "faults[0].kind: got 'crak'" in capsys.readouterr().err
