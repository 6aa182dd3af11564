"""Every slip a user can make: one line with field, value and fix, exit code 2, no traceback."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from thermogear.base.materials import MATERIALS
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.front.cli import main

Run = Callable[..., str]

NO_UNIT = "a bare number has no unit"

# what is put in place of the rig's value, and the whole message
BAD_VALUES: list[tuple[str, str]] = [
    # lengths
    (
        "gears.module=5",
        f'gears.module: got 5; allowed 0.05..100 mm; {NO_UNIT}; write for instance "5 mm"',
    ),
    (
        "gears.module='5'",
        "gears.module: got '5'; allowed 0.05..100 mm; the unit is missing; "
        'write for instance "5 mm"',
    ),
    (
        "gears.module=-5 mm",
        "gears.module: got '-5 mm'; allowed 0.05..100 mm; write for instance \"5 mm\"",
    ),
    (
        "gears.module=0 mm",
        "gears.module: got '0 mm'; allowed 0.05..100 mm; write for instance \"5 mm\"",
    ),
    (
        "gears.module=nan mm",
        "gears.module: got 'nan mm'; allowed 0.05..100 mm; not finite; write for instance \"5 mm\"",
    ),
    (
        "gears.module=nan",
        f'gears.module: got nan; allowed 0.05..100 mm; {NO_UNIT}; write for instance "5 mm"',
    ),
    (
        "gears.module=five mm",
        "gears.module: got 'five mm'; allowed 0.05..100 mm; no number at its start; "
        'write for instance "5 mm"',
    ),
    (
        "gears.module=5 kg",
        "gears.module: got '5 kg'; allowed 0.05..100 mm; 'kg' is no unit of length; "
        'write for instance "5 mm"',
    ),
    (
        "gears.module=5,0 mm",
        "gears.module: got '5,0 mm'; allowed 0.05..100 mm; "
        'decimals follow a point, not a comma; did you mean "5.0 mm"?',
    ),
    (
        "gears.module=true",
        "gears.module: got true; allowed 0.05..100 mm; "
        'not a text with number and unit of length; write for instance "5 mm"',
    ),
    (
        "gears.module=5 9**9**9**9**9",
        "gears.module: got '5 9**9**9**9**9'; allowed 0.05..100 mm; "
        'what follows the number is no unit of length; write for instance "5 mm"',
    ),
    (
        "gears.pinion.face_width=1 fm",
        "gears.pinion.face_width: got '1 fm'; allowed 0.01..10000 mm; write for instance \"5 mm\"",
    ),
    # gears
    (
        "gears.pressure_angle=0.35",
        "gears.pressure_angle: got 0.35; allowed 10..35 deg; a bare number has no unit; "
        'write for instance "0.35 deg"',
    ),
    (
        "gears.pressure_angle=60 deg",
        "gears.pressure_angle: got '60 deg'; allowed 10..35 deg; write for instance \"20 deg\"",
    ),
    (
        "gears.helix_angle=10 deg",
        "gears.helix_angle: got a helix angle; thermogear treats spur gears only; leave it out",
    ),
    (
        "gears.pinion.helix_angle=0",
        "gears.pinion.helix_angle: got a helix angle; thermogear treats spur gears only; "
        "leave it out",
    ),
    (
        "gears.pinion.teeth=25.5",
        "gears.pinion.teeth: got 25.5; allowed 5..2000, whole; "
        "a value where a whole number is needed; write for instance 25",
    ),
    (
        "gears.pinion.teeth=many",
        "gears.pinion.teeth: got 'many'; allowed 5..2000, whole; "
        "text where a whole number is needed; write for instance 25",
    ),
    (
        "gears.pinion.teeth=0",
        "gears.pinion.teeth: got 0; allowed 5..2000; write for instance 25",
    ),
    (
        "gears.pinion.profile_shift=inf",
        "gears.pinion.profile_shift: got inf; allowed -2..2; write for instance 0.2",
    ),
    (
        "gears.pinion.bore_radius=60 mm",
        "gears.pinion.bore_radius: got 60 mm; allowed < root radius 56.25 mm; "
        "the body must be a ring",
    ),
    (
        "gears.pinion.bore_radius=0 mm",
        "gears.pinion.bore_radius: got '0 mm'; allowed 0.01..10000 mm; write for instance \"5 mm\"",
    ),
    (
        "gears.pinion.tip_diameter=150 mm",
        "gears.pinion.tip_diameter: got a radius of 75 mm; allowed < 70.4872 mm; the tooth is "
        "pointed at that radius (tip thickness -6.79076 mm, x = 0); "
        "lower the tip radius or the profile shift",
    ),
    (
        "gears.wheel.tip_diameter=391 mm",
        "gears.wheel.tip_diameter: got a radius of 195.5 mm; allowed <= 192.989 mm; interference: "
        "the tip reaches below the pinion's form circle; "
        "lower the tip radius or raise pinion.profile_shift",
    ),
    (
        "gears.centre_distance=249 mm",
        "gears.centre_distance: got 249 mm; allowed >= 250 mm; "
        "the teeth would wedge (no backlash left)",
    ),
    (
        "gears.centre_distance=256 mm",
        "gears.centre_distance: got 256 mm, a contact ratio of 0.6158; allowed a contact ratio "
        ">= 1; the gears stand too far apart for their teeth; "
        "leave it out for the mesh without backlash, or shift the profiles",
    ),
    (
        "gears.pinion.material=stele",
        f"gears.pinion.material: got 'stele'; allowed {' | '.join(MATERIALS)}; "
        "did you mean 'steel'? "
        "Or describe it in [materials.stele]",
    ),
    (
        "gears.pinion.tooth=3",
        "gears.pinion.tooth: got an unknown key; [gears.pinion] does not have it; "
        "did you mean 'teeth'?",
    ),
    ("gears.pinion=3", "gears.pinion: got 3; allowed a table; write [gears.pinion]"),
    # operating points
    (
        "operating.speed=0 rpm",
        "operating.speed: got '0 rpm'; allowed 0.1..500000 rpm; a gear at rest has no motion; "
        'write for instance "1000 rpm"',
    ),
    (
        "operating.speed=['1000 rpm', 2000]",
        f"operating.speed[1]: got 2000; allowed 0.1..500000 rpm; {NO_UNIT}; "
        'write for instance "2000 rpm"',
    ),
    (
        "operating.speed=50 Hz",
        "operating.speed: got '50 Hz'; allowed 0.1..500000 rpm; "
        '\'Hz\' is no unit of rotational speed; did you mean "50 rps" or "50 rad/s"?',
    ),
    (
        "operating.speed=[]",
        "operating.speed: got a list of 0; allowed 1..100000 entries; "
        'write for instance ["1000 rpm"]',
    ),
    (
        "operating.torque=-5 N m",
        "operating.torque: got '-5 N m'; allowed 0..1e7 N m; write for instance \"100 N m\"",
    ),
    (
        "operating.torque=100 J",
        "operating.torque: got '100 J'; allowed 0..1e7 N m; 'J' is no unit of torque; "
        'did you mean "100 N m"?',
    ),
    # temperatures
    (
        "temperatures.reference=-300 degC",
        "temperatures.reference: got '-300 degC'; allowed -70..600 degC; "
        'nothing is colder than 0 K (-273.15 degC); write for instance "100 degC"',
    ),
    (
        "temperatures.pinion_addendum=100 C",
        "temperatures.pinion_addendum: got '100 C'; allowed -70..600 degC; "
        "'C' is no unit of temperature; did you mean \"100 degC\"?",
    ),
    (
        "temperatures.pinion_bore=100 degC",
        "temperatures: got both pinion_bore and pinion_bore_below_addendum; "
        "allowed exactly one of the two; leave one out",
    ),
    (
        "temperatures.housing_below_addendum=20 degC",
        "temperatures.housing_below_addendum: got '20 degC'; allowed -400..400 K; "
        "'degC' has its zero elsewhere, a difference has none; did you mean \"20 K\"?",
    ),
    (
        "temperatures.housing_below_addendum=390 K",
        "temperatures.housing_below_addendum: got 390 K below 140 degC = -250 degC; "
        "allowed -70..600 degC",
    ),
    (
        "temperatures.row=['100 degC', '100 degC']",
        "temperatures.row: got '100 degC' twice; allowed each value once",
    ),
    *(
        (
            f"{field}=140 K",
            f"{field}: got '140 K'; allowed -70..600 degC; that is -133.15 degC; "
            'did you mean "140 degC"?',
        )
        for field in ("temperatures.pinion_addendum", "temperatures.row", "oil.temperature")
    ),
    (
        "temperatures.pinion_addendum=140",
        "temperatures.pinion_addendum: got 140; allowed -70..600 degC; "
        f'{NO_UNIT}; write for instance "140 degC"',
    ),
    # oil, inertia, backlash
    (
        "oil.name=M10",
        "oil.name: got 'M10'; allowed ",
    ),
    (
        "oil.viscosity_40=100 cSt",
        "oil: got a part of an oil; "
        "allowed viscosity_40, viscosity_100 and density_15 together, or the name alone",
    ),
    (
        "inertia.model=given",
        'inertia.pinion: got nothing; needed with model = "given"; write pinion = "0.01 kg m^2"',
    ),
    (
        "inertia.pinion=1 kg m^2",
        'inertia: got numbers beside model = "solid disc"; write model = "given"',
    ),
    ("inertia.bored=0", "inertia.bored: got 0; allowed true or false"),
    (
        "backlash.value=0 mm",
        "backlash.value: got '0 mm'; allowed 1e-5..50 mm; "
        'a pair without backlash jams as soon as it warms up; write for instance "0.25 mm"',
    ),
    (
        "backlash.direction=radial",
        "backlash.direction: got 'radial'; allowed normal | circumferential; "
        "did you mean 'normal'?",
    ),
    # dynamics, model, numbers of the simulation
    (
        "dynamics.damping_ratio=-0.1",
        "dynamics.damping_ratio: got -0.1; allowed 0..2; write for instance 0.07",
    ),
    (
        "dynamics.damping_ratio=7 percent",
        "dynamics.damping_ratio: got '7 percent'; allowed 0..2; "
        "text where a pure number is needed; write for instance 0.07, without quotes and unit",
    ),
    (
        "transmission_error.harmonics=[{order=0, amplitude='5 um'}]",
        "transmission_error.harmonics[0].order: got 0; allowed 1..1000; write for instance 1",
    ),
    (
        "transmission_error.harmonics=[{order=1, amplitud='5 um'}]",
        "transmission_error.harmonics[0].amplitud: got an unknown key; "
        "[transmission_error.harmonics[0]] does not have it; "
        "did you mean 'amplitude'?",
    ),
    (
        "transmission_error.harmonics=3",
        "transmission_error.harmonics: got 3; allowed a list",
    ),
    (
        "model.bundle=thesys",
        "model.bundle: got 'thesys'; allowed both | consistent | thesis; did you mean 'thesis'?",
    ),
    (
        "model.dry_coefficient=2",
        "model.dry_coefficient: got 2; allowed 0.001..1; write for instance 0.2",
    ),
    (
        "model.frictio=dry",
        "model.frictio: got an unknown key; [model] does not have it; did you mean 'friction'?",
    ),
    (
        "grid.harmonics=500",
        "grid.harmonics: got 500; allowed 1..119; 240 mesh positions resolve no more; "
        "use 119, or more mesh_positions",
    ),
    (
        "simulation.most_discarded=3",
        "simulation.most_discarded: got 3; allowed >= discard = 400; use 400 or more",
    ),
    (
        "simulation.initial_state=[0.0]",
        "simulation.initial_state: got a list of 1; allowed 2 entries; "
        "write for instance [0.0, 0.0]",
    ),
    (
        f"simulation.periods=1{'0' * 47}",
        "simulation.periods: got a whole number of about 48 digits; allowed 8..1000000; "
        "write for instance 256",
    ),
    (
        "draw.pictures=['pth']",
        "draw.pictures: got 'pth'; "
        "allowed path | profile | stiffness | motion | temperature | base-sets; "
        "did you mean 'path'?",
    ),
    # the file as a whole
    (
        "geras.module=5 mm",
        "geras: got an unknown key; the case file does not have it; did you mean 'gears'?",
    ),
    ("title=3", 'title: got 3; allowed a text; write "my gear pair"'),
    ("title.x=3", "title.x: got an unknown path; title is a value, not a table"),
    ("kind=gears", "kind: got 'gears'; allowed gear | dimensionless; did you mean 'gear'?"),
    ("ours.nothing=why", "ours: got 'nothing'; no such field; did you mean 'operating'?"),
    (
        "ours.title=3",
        "ours.title: got 3; a reason holds for one value: an entry needs a value and a reason; "
        'write "title" = { value = ..., reason = "..." }',
    ),
    ("gears.module", "--set: got 'gears.module'; allowed PATH=VALUE; write gears.pinion.teeth=30"),
    ("a b=3", "'a b': got no path; allowed dotted names: gears.pinion.teeth"),
]


@pytest.fixture
def rig(tmp_path: Path) -> Path:
    path = tmp_path / "rig.toml"
    path.write_text(example_text("rig"), encoding="utf-8")
    return path


@pytest.fixture
def failing(capsys: pytest.CaptureFixture[str]) -> Run:
    """Run the command line, which must fail with one line; return that line."""

    def run(*arguments: str) -> str:
        assert main(arguments) == 2
        caught = capsys.readouterr()
        assert caught.out == ""
        assert caught.err.startswith("error: ")
        assert caught.err.count("\n") == 1
        assert caught.err.endswith("\n")
        assert "Traceback" not in caught.err
        return caught.err.removeprefix("error: ").removesuffix("\n")

    return run


def test_there_are_more_than_forty() -> None:
    assert len(BAD_VALUES) > 60


@pytest.mark.parametrize(("change", "message"), BAD_VALUES, ids=[c for c, _ in BAD_VALUES])
def test_bad_values(change: str, message: str, rig: Path, failing: Run) -> None:
    said = failing("check", str(rig), "--set", change)
    assert said == message or (message.endswith("allowed ") and said.startswith(message))


BAD_FILES: dict[str, tuple[bytes, str]] = {
    "empty": (
        b"",
        "case.toml: got an empty file; `thermogear example rig` shows a case file",
    ),
    "blank": (
        b" \n\n",
        "case.toml: got an empty file; `thermogear example rig` shows a case file",
    ),
    "syntax": (
        b"title = 'x'\n[gears]\nmodule = 5 mm\n",
        "case.toml: got invalid TOML at line 3, column 12; "
        "Expected newline or end of document after a statement; "
        'a value with its unit stands in quotes: "5 mm"',
    ),
    "half a string": (
        b'title = "x\n',
        "case.toml: got invalid TOML at line 1, column 11; Illegal character '\\n'; "
        "a text ends with the quote it began with",
    ),
    "twice": (
        b'title = "x"\ntitle = "y"\n',
        "case.toml: got invalid TOML at line 2, column 12; Cannot overwrite a value",
    ),
    "binary": (
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
        "case.toml: got binary data; allowed UTF-8 text (TOML); it holds zero bytes",
    ),
    "UTF-16 without its mark": (
        "title = 'x'".encode("utf-16-le"),
        "case.toml: got binary data; allowed UTF-8 text (TOML); it holds zero bytes",
    ),
    "UTF-32": (
        "title = 'x'".encode("utf-32"),
        "case.toml: got binary data; allowed UTF-8 text (TOML); it holds zero bytes",
    ),
    "half of UTF-16": (
        "title = 'x'".encode("utf-16")[:-1],
        "case.toml: got binary data; allowed UTF-8 text (TOML); it holds zero bytes",
    ),
    "latin-1": (
        "title = 'Getriebe'\n# Prüfstand\n".encode("latin-1"),
        "case.toml: got byte 0xfc in line 2; allowed UTF-8 text (TOML); another encoding; "
        "save the file as UTF-8",
    ),
    "huge": (
        b"#" * 1_000_001,
        "case.toml: got more than 1000000 bytes; allowed 0..1000000 bytes; no case file",
    ),
    "deep": (
        b"a = " + b"[" * 5000 + b"]" * 5000,
        "case.toml: got a number or a nesting beyond reason; allowed TOML",
    ),
    "endless number": (
        b"a = " + b"9" * 5000,
        "case.toml: got a number or a nesting beyond reason; allowed TOML",
    ),
}

SEVERAL = {
    "no tables": (
        "title = 'x'\n",
        [
            "gears: got nothing; needed; add the table [gears]",
            "operating: got nothing; needed; add the table [operating]",
        ],
    ),
    "no rows": (
        "title = 'x'\nkind = 'dimensionless'\n",
        [
            "base: got nothing; needed; add the table [base]",
            "rows: got nothing; needed; add the table [rows]",
        ],
    ),
    "a key with a line break": (
        "title = 'x'\n\"a\\nb\" = 3\n",
        [
            "line 2: 'a\\nb': got an unknown key; the case file does not have it; known: backlash, "
            "bearings, discs, draw, dynamics, faults, flanks, gearbox, gears, grid, housing, "
            "inertia, kind, load, materials, model, motor, oil, operating, ours, sensors, shafts, "
            "simulation, temperatures, title, train, transmission_error",
            "gears: got nothing; needed; add the table [gears]",
            "operating: got nothing; needed; add the table [operating]",
        ],
    ),
    "a bad start": (
        """[gears]
modul = "3 mm"
helix = "10 deg"
[gears.pinion]
teeth = 20.5
face_width = "30,5 mm"
material = "steeel"
[gears.wheel]
[operating]
speed = "3000"
torque = "80 N m"
""",
        [
            "line 3: gears.helix: got a helix angle; thermogear treats spur gears only; "
            "leave it out",
            "line 2: gears.modul: got an unknown key; [gears] does not have it; "
            "did you mean 'module'?",
            "line 5: gears.pinion.teeth: got 20.5; allowed 5..2000, whole; "
            "a value where a whole number is needed; write for instance 25",
            "line 6: gears.pinion.face_width: got '30,5 mm'; allowed 0.01..10000 mm; "
            'decimals follow a point, not a comma; did you mean "30.5 mm"?',
            "line 10: operating.speed: got '3000'; allowed 0.1..500000 rpm; the unit is missing; "
            'write for instance "3000 rpm"',
            "line 8: gears.wheel.teeth: got nothing; needed; write teeth = 25",
            "line 7: gears.pinion.material: got 'steeel'; ",
        ],
    ),
    "two gears that cannot be": (
        """[gears]
module = "3 mm"
[gears.pinion]
teeth = 18
face_width = "30 mm"
bore_radius = "30 mm"
[gears.wheel]
teeth = 19
bore_radius = "30 mm"
[oil]
name = "ISO VG 101"
[operating]
speed = "3000 rpm"
torque = "80 N m"
""",
        [
            "line 6: gears.pinion.bore_radius: got 30 mm; ",
            "line 9: gears.wheel.bore_radius: got 30 mm; ",
            "line 11: oil.name: got 'ISO VG 101'; ",
        ],
    ),
}
"""Text -> every line that is told, the last one's beginning alone where it ends so."""


@pytest.mark.parametrize("name", SEVERAL)
def test_everything_wrong_in_a_file_is_told_at_once(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text, lines = SEVERAL[name]
    path = tmp_path / "case.toml"
    path.write_text(text)
    assert main(["check", str(path)]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == len(lines)
    for mine, expected in zip(said, lines, strict=True):
        assert mine == f"error: {expected}" or (
            expected.endswith("; ") and mine.startswith(f"error: {expected}")
        )


@pytest.mark.parametrize("name", BAD_FILES)
def test_bad_files(name: str, tmp_path: Path, failing: Run) -> None:
    content, message = BAD_FILES[name]
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    said = failing("check", str(path))
    assert said == message or (message.endswith("; ") and said.startswith(message))


def test_missing_file(tmp_path: Path, failing: Run) -> None:
    said = failing("check", str(tmp_path / "rigg.toml"))
    assert said == ("rigg.toml: got no such file; `thermogear example rig -o rig.toml` writes one")


def test_missing_file_beside_a_similar_one(rig: Path, failing: Run) -> None:
    said = failing("check", str(rig.parent / "rgi.toml"))
    assert said == "rgi.toml: got no such file; did you mean 'rig.toml'?"


def test_directory_as_a_case(tmp_path: Path, failing: Run) -> None:
    folder = tmp_path / "cases"
    folder.mkdir()
    assert failing("check", str(folder)) == "cases: got a directory; allowed a case file (TOML)"


def test_path_with_a_zero_byte(failing: Run) -> None:
    assert "a file that cannot be read" in failing("check", "a\0b")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("rn",), "unknown command 'rn'; did you mean 'run'?"),
        (("frobnicate",), "unknown command 'frobnicate'; did you mean 'friction'?"),
        (
            ("run", "x.toml", "--forced"),
            "No such option '--forced'. Did you mean '--force'?",
        ),
        (("run", "x.toml"), "Missing option '-o' / '--output'."),
        (("run",), "Missing argument 'CASE'."),
        (
            ("example", "rigg"),
            f"example: got 'rigg'; allowed {' | '.join(EXAMPLES)}; did you mean 'rig'?",
        ),
        (("schema", "x"), "Got unexpected extra argument (x)"),
    ],
)
def test_bad_commands(arguments: tuple[str, ...], message: str, failing: Run) -> None:
    assert failing(*arguments) == message


def test_roughness_beyond_the_friction_law(rig: Path, failing: Run) -> None:
    said = failing("check", str(rig), "--set", "gears.pinion.roughness=2 um")
    assert said == (
        "gears.pinion.roughness: got 1.2 um, the mean of both flanks; allowed < 1.13 um; "
        "the friction law of Benedict and Kelley ends there; "
        'use smoother flanks, or model.friction = "lambda-blend"'
    )


def test_output_that_is_not_ours_is_refused(rig: Path, tmp_path: Path, failing: Run) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / "thesis.docx").write_text("years of work", encoding="utf-8")
    said = failing("run", str(rig), "-o", str(home))
    why = "the directory holds files that are not results of thermogear"
    assert said == f"output: got {home}; {why}; name a new or an empty directory"
    assert [p.name for p in home.iterdir()] == ["thesis.docx"]


def test_output_that_is_a_file_is_refused(rig: Path, failing: Run) -> None:
    assert "name a directory" in failing("run", str(rig), "-o", str(rig))
