"""The measuring commands: text, JSON, pages, one-line refusals."""

from __future__ import annotations

import json
from pathlib import Path

import click
import numpy as np
import pytest
from click.testing import CliRunner, Result

from said import numbers
from thermogear.base.errors import InputError
from thermogear.front.measure_commands import compare, measure
from thermogear.results.result import open_results

RATE, TEETH = 5120.0, 25


@pytest.fixture
def record(tmp_path: Path) -> Path:
    """A pinion of 25 teeth at 1000 rpm, first line 10 um, unit stated, rate in a time column."""
    t = np.arange(12_000) / RATE
    turns = 2 * np.pi * 1000 / 60 * t
    swing = 1 + 0.2 * np.cos(turns) + 0.1 * np.cos(2 * turns)
    peak = 10e-6 * (TEETH * 2 * np.pi * 1000 / 60) ** 2
    x = peak * swing * (np.cos(TEETH * turns) + 0.4 * np.cos(2 * TEETH * turns))
    x += 0.2 * peak * swing * np.cos(3 * TEETH * turns)
    x += 0.5 * np.random.default_rng(2).standard_normal(t.size)
    path = tmp_path / "rig.csv"
    table = np.column_stack([t, x])
    np.savetxt(path, table, "%.9g", ",", header="time [s],acc [m/s^2]", comments="")
    return path


def call(command: click.Command, *words: object) -> Result:
    return CliRunner().invoke(command, [str(word) for word in words], catch_exceptions=True)


def test_measure_prints_lines_settings_and_evidence(record: Path) -> None:
    done = call(measure, record, "--teeth", TEETH, "--speed", 1000)
    assert done.exit_code == 0, done.output
    assert float(TEETH) in numbers(done.output)
    (window,) = (line for line in done.output.splitlines() if "window:" in line)
    assert ("flattop" in window, numbers(window)[0]) == (True, 3.77)
    assert "mesh x 1" in done.output


def test_measure_as_json_and_as_a_page(record: Path, tmp_path: Path) -> None:
    done = call(measure, record, "--json", "--teeth", TEETH, "-o", tmp_path / "out")
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["teeth"] == TEETH
    assert found["lines"][0]["displacement"] == pytest.approx(10e-6, rel=0.01)
    page = (tmp_path / "out" / "measured.html").read_text(encoding="utf-8")
    for words in ("Time record", "Spectrum", "How the gearing was found", "Settings", "<svg"):
        assert words in page
    assert "http://" not in page.replace("http://www.w3.org", "")
    assert page.count("<script") == 1


def test_the_page_is_the_same_when_drawn_again(record: Path, tmp_path: Path) -> None:
    from thermogear.views.write import write_report

    call(measure, record, "-o", tmp_path / "out")
    first = (tmp_path / "out" / "measured.html").read_bytes()
    assert write_report(tmp_path / "out").read_bytes() == first
    with pytest.raises(InputError, match="it cannot be read as netCDF"):
        open_results(record)


def test_compare_prints_the_thesis_recomputed_and_draws_it(tmp_path: Path) -> None:
    done = call(compare, "thesis-5.2", "-o", tmp_path)
    assert done.exit_code == 0, done.output
    assert "printed 18.5 %, recomputed 21.50 %" in done.output
    told = [numbers(line) for line in done.output.splitlines()]
    assert [3000.0, 305.9, 3003.8, 1.6] in told
    assert [3.0, 3.0, 3.96, 13.92, 3.0, 3.0] in told
    page = (tmp_path / "comparison.html").read_text(encoding="utf-8")
    for words in ("not resolvable", "-21.50", "305.9", "3003.8"):
        assert words in page.replace("−", "-")


def test_compare_as_json() -> None:
    done = call(compare, "thesis-5.2", "--u-data", 1, "--json")
    found = json.loads(done.output)
    said = {row["verdict"] for row in found["rows"] if row["quantity"] == "displacement"}
    assert said == {f"{found['models'][0]} better"}


@pytest.mark.parametrize(
    ("command", "words", "message"),
    [
        (measure, ["nowhere.csv"], r"^file: got nowhere\.csv; there is no such file$"),
        (measure, ["FILE", "--unit", "furlong"], r"^unit: got 'furlong'; "),
        (measure, ["FILE", "--rate", "-5"], r"^rate: got -5 samples/s; allowed 1e-6\.\.1e\+12"),
        (measure, ["FILE", "--rate", "1e308"], r"^rate: got 1e\+308 samples/s; allowed 1e-6"),
        (measure, ["FILE", "--rate", "1e-308"], r"^rate: got 1e-308 samples/s; allowed 1e-6"),
        (measure, ["FILE", "--limit", "nan"], r"^--limit: got nan GiB; allowed > 0 \.\. 1048576"),
        (measure, ["FILE", "--limit", "inf"], r"^--limit: got inf GiB"),
        (measure, ["FILE", "--limit", "1e300"], r"^--limit: got 1e\+300 GiB"),
        (measure, ["FILE", "--scale", "1e308"], r"^scale: got 1e\+308 units at full scale"),
        (measure, ["FILE", "--speed", "1e308"], r"^--speed: got 1e\+308 rpm; allowed > 0 \.\. 5"),
        (measure, ["FILE", "--pulses", "1e308"], r"^pulses_per_turn: got 1e\+308 pulses"),
        (measure, ["FILE", "--teeth", 10**20], r"^teeth: got a number of more than twelve digits"),
        (
            measure,
            ["FILE", "--channel", "²"],
            r"^channel: got '²'; allowed 1..1 or a name; known: ",
        ),
        (measure, ["FILE", "--channel", "9" * 5000], r"^channel: got '99999"),
        (
            measure,
            ["FILE", "--channel", "z"],
            r"^channel: got 'z'; allowed 1..1 or a name; known: ",
        ),
        (measure, ["FILE", "--method", "magic"], r"^method: got 'magic'; "),
        (measure, ["FILE", "--teeth", "0"], r"^teeth: got 0; allowed 1\.\.2000$"),
        (
            measure,
            ["FILE", "--teeth", "seventeen"],
            r"^--teeth: got 'seventeen'; allowed a whole n",
        ),
        (measure, ["FILE", "--rate", "fast"], r"^--rate: got 'fast'; allowed > 0 .*; as --rate "),
        (
            measure,
            ["FILE", "--harmonics", 0],
            r"^harmonics: got 0; allowed 1\.\.64; as --harmonics",
        ),
        (measure, ["FILE", "--sidebands", -1], r"^sidebands: got -1; allowed 0\.\.64; as --sideb"),
        (
            measure,
            ["FILE", "--orders", -1],
            r"^orders: got -1; allowed > 0 \.\. 10000.*; as|an order",
        ),
        (
            measure,
            ["FILE", "--teeth", TEETH, "--orders", 400],
            r"^orders: got 400; allowed 0\.02\d*\.\.153\.\d; from .* as --orders 153, or sample f",
        ),
        (
            measure,
            ["FILE", "--channel", 99],
            r"^channel: got '99'; allowed 1\.\.1 or a name; known: ",
        ),
        (measure, ["FILE", "--unit", "rpm"], r"^unit: got 'rpm'; .*; one of m/s\^2, "),
        (measure, ["FILE", "--tacho", "ac"], r"^tacho: got 'ac'; .*known: acc; did you mean 'acc'"),
        (
            measure,
            ["FILE", "--channel", "acc", "--tacho", "ac"],
            r"^tacho: got 'ac'; .*known: acc; did you mean 'acc'",
        ),
        (
            measure,
            ["FILE", "--channel", "acc", "--tacho", "acc"],
            r"^--tacho: got acc; --channel n",
        ),
        (measure, ["FILE", "--tacho", "acc"], r"^tacho: got acc; no other channel is left to read"),
        (
            measure,
            ["FILE", "--tacho-scale", 300],
            r"^--tacho-scale: got 300 rpm; no tacho is named",
        ),
        (measure, ["FILE", "nowhere.csv"], r"^file: got 2 files; allowed one record; .*--join"),
        (measure, ["FOLDER"], r"^file: got .*folder; no file is in it; name files"),
        (compare, ["thesis-5.2", "--tolerance", "x"], r"^--tolerance: got 'x'; allowed FIELD="),
        (
            compare,
            ["thesis-5.2", "--u-data", "1e308"],
            r"^u_data: got 1e\+308 %; allowed 0\.\.1000",
        ),
        (compare, ["rig", "thesis-5.2", "--tolerance", "x=1e308"], r"^tolerance of x: got 1e\+308"),
        (
            compare,
            ["rig", "thesis-5.2", "--tolerance", "x=1", "--samples", 10**9],
            r"^samples: got 1000000000; allowed 2\.\.10000$",
        ),
        (compare, ["thesis-5.2", "--teeth", 10**20], r"^teeth: got a number of more than"),
        (compare, ["nowhere", "thesis-5.2"], r"^"),
        (compare, ["rig", "thesis-5.2", "--set", "gears.pinion.teth=9"], r"did you mean 'teeth'"),
        (
            compare,
            ["thesis-5.2", "--set", "gears.pinion.teeth=9"],
            r"^--set: got gears\.pinion\.teeth=9; stored lines are not comp.*; name the case inst",
        ),
        (compare, ["rig", "--at", "a=housing:x"], r"^--at: got a=housing:x; there is no record"),
        (compare, ["rig", "FILE", "--at", "a=housing:x"], r"^shafts: got nothing; "),
        (compare, ["motor-train", "FILE", "--at", "a=housing"], r"^--at: got 'a=housing'; "),
    ],
)
def test_refusals_are_one_line(
    record: Path, command: click.Command, words: list[object], message: str
) -> None:
    (record.parent / "folder").mkdir()
    places = {"FILE": record, "FOLDER": record.parent / "folder"}
    done = call(command, *[places.get(str(word), word) for word in words])
    assert isinstance(done.exception, InputError)
    assert "\n" not in str(done.exception)
    with pytest.raises(InputError, match=message):
        raise done.exception


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "it is empty; a text holds a row of numbers for each sample"),
        (b"time [s],acc [g]\n", "no row of numbers in its first lines; a text holds a row"),
        (b"\0\1\2" * 4000, "it is binary: it holds zero bytes; a text holds a row"),
        (b"time [s],acc [g]\n0,1\n", "got 1 sample of bad.csv; allowed >= 256 samples; record lon"),
        (b"time [s],acc [g]\n0,1\n0.1,2\n", "got 2 samples of bad.csv; allowed >= 256 samples"),
    ],
)
def test_files_without_a_record_say_what_one_is(tmp_path: Path, content: bytes, said: str) -> None:
    (tmp_path / "bad.csv").write_bytes(content)
    done = call(measure, tmp_path / "bad.csv")
    assert isinstance(done.exception, InputError)
    assert said in str(done.exception)


def test_a_file_named_wrongly_is_answered_with_the_one_beside_it(record: Path) -> None:
    done = call(measure, record.with_name("rigg.csv"))
    assert str(done.exception).endswith("there is no such file; did you mean 'rig.csv'?")


def test_a_unit_that_is_none_is_told_with_those_that_are(record: Path) -> None:
    text = record.read_text(encoding="utf-8").replace("[m/s^2]", "[furlong]")
    record.write_text(text, encoding="utf-8")
    words = ("--teeth", TEETH, "--harmonics", 1, "--sidebands", 0, "--channel", 1)
    done = call(measure, record, *words)
    assert done.exit_code == 0, done.output
    assert "'furlong'" in done.output
