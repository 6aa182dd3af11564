"""The traps met in real files: each is recognised, named, and never read silently wrong."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import io

from thermogear.base.errors import InputError
from thermogear.measured.choosing import chosen_channels, counts
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Notice, Record
from thermogear.measured.traps import split_unit
from thermogear.measured.units import unit


def read(tmp_path: Path, text: str | bytes, name: str = "r.csv", **said: object) -> Record:
    path = tmp_path / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return read_record(path, **said)  # type: ignore[arg-type]


def told(record: Record) -> list[tuple[str, dict[str, Any]]]:
    """Code and data of every notice."""
    return [(n.code, dict(n.data)) for n in record.notices]


def rows(count: int = 30, time: str | None = "s", step: float = 0.001) -> list[str]:
    head = f"time [{time}],a [g]" if time else "a [g]"
    body = [f"{j * step:.6f},{np.sin(j):.6f}" if time else f"{np.sin(j):.6f}" for j in range(count)]
    return [head, *body]


def lines(rows: list[str]) -> str:
    return "\n".join(rows) + "\n"


def test_nothing_is_guessed_where_nothing_is_stated(tmp_path: Path) -> None:
    record = read(tmp_path, lines(["a1,a2"] + [f"{j}.5,{j}.25" for j in range(20)]))
    assert (record.rate, record.channels[0].unit) == (None, None)
    assert record.channels[1].values()[3] == 3.25


def test_time_in_milliseconds(tmp_path: Path) -> None:
    record = read(tmp_path, lines(rows(time="ms", step=0.5)))
    assert record.rate == pytest.approx(2000.0)
    assert told(record) == [("time_unit", {"column": "time", "unit": "ms"})]


def test_time_without_a_unit_gives_no_rate(tmp_path: Path) -> None:
    text = lines(["time,a"] + [f"{j},{j * j}.0" for j in range(20)])
    record = read(tmp_path, text)
    assert record.rate is None
    assert told(record) == [("time_unit_not_known", {"column": "time", "unit": None})]
    assert record.names == ("a",)


@pytest.mark.parametrize("value", ["0.123456", None])
def test_a_stamp_written_twice_gives_no_rate(tmp_path: Path, value: str | None) -> None:
    """With another value, or the same: nothing tells a row written twice from a lost stamp."""
    text = rows()
    stamp, same = text[10].split(",")
    text[11] = f"{stamp},{value or same}"
    record = read(tmp_path, lines(text))
    assert record.rate is None
    assert told(record) == [("time_stamp_twice", {"column": "time", "row": 11})]


def test_a_missing_row_is_seen_in_the_time_column(tmp_path: Path) -> None:
    text = rows(200)
    del text[50]
    record = read(tmp_path, lines(text))
    assert record.rate == pytest.approx(1000.0, rel=1e-6)
    assert record.samples == 200
    values = record.channels[0].values()
    assert np.flatnonzero(np.isnan(values)).tolist() == [49]
    lost = {"column": "time", "places": 1, "first": 50, "samples": 1}
    assert told(record)[0] == ("samples_lost", lost)


def test_time_running_backwards_gives_no_rate(tmp_path: Path) -> None:
    text = rows()
    text[10], text[11] = text[11], text[10]
    record = read(tmp_path, lines(text))
    assert record.rate is None
    assert told(record) == [("time_falls", {"column": "time", "row": 11})]


def test_a_rate_off_by_ten_in_the_header_is_used_by_neither(tmp_path: Path) -> None:
    text = lines(["Sampling rate: 10000 Hz", *rows()])
    record = read(tmp_path, text)
    assert record.rate is None
    ((code, data),) = told(record)
    assert (code, data["rate"]) == ("rate_stated_twice", 10000.0)
    assert data["other_rate"] == pytest.approx(1000.0)
    assert data["ratio"] == pytest.approx(10.0)
    given = read(tmp_path, text, rate=1000.0)
    assert given.rate == 1000.0


def test_a_header_rate_needs_its_unit(tmp_path: Path) -> None:
    body = [f"{np.sin(j):.6f}" for j in range(20)]
    stated = read(tmp_path, lines(["fs: 25.6 kHz", "a [g]", *body]))
    assert (stated.rate, stated.rate_origin) == (25600.0, "header")
    bare = read(tmp_path, lines(["fs: 25600", "a [g]", *body]))
    assert bare.rate is None
    assert told(bare) == [("rate_without_unit", {"name": "fs", "value": 25600.0})]


def test_a_contradicted_rate_is_said(tmp_path: Path) -> None:
    record = read(tmp_path, lines(rows()), rate=10000.0)
    assert record.rate == 10000.0
    ((code, data),) = told(record)
    assert (code, data["given"]) == ("rate_given_differs", 10000.0)
    assert (data["stated"], data["ratio"]) == pytest.approx((1000.0, 10.0))


def test_truncated_last_row(tmp_path: Path) -> None:
    whole = lines(rows())
    few_fields = read(tmp_path, whole + "0.03")
    assert few_fields.samples == 30
    assert told(few_fields) == [("last_row_dropped", {})]
    cut_number = read(tmp_path, whole[:-4])
    assert cut_number.samples == 29
    no_end = read(tmp_path, whole[:-1])
    assert no_end.samples == 30
    assert told(no_end) == [("last_row_unended", {})]


def test_a_short_row_inside_is_refused(tmp_path: Path) -> None:
    text = rows()
    text[12] = "0.011"
    with pytest.raises(InputError, match=r"line 13 has 1 fields, the others 2$"):
        read(tmp_path, lines(text))
    text[12] = "0.011,x7"
    with pytest.raises(InputError, match=r"line 13: 'x7' is not a number$"):
        read(tmp_path, lines(text))


def test_gaps_are_counted_and_not_filled(tmp_path: Path) -> None:
    text = rows()
    text[5], text[6], text[20] = "0.004,", "0.005,NaN", "0.019,n/a"
    record = read(tmp_path, lines(text))
    assert told(record) == [("samples_missing", {"channel": "a", "samples": 3})]
    assert np.isnan(record.channels[0].values()[[4, 5, 19]]).all()


def test_decimal_comma_with_semicolons_and_with_blanks(tmp_path: Path) -> None:
    text = "t (s);a (m/s²)\n" + "".join(f"{j / 10:.1f};{j}.25\n" for j in range(20))
    record = read(tmp_path, text.replace(".", ","))
    np.testing.assert_allclose(record.channels[0].values(), np.arange(20) + 0.25)
    assert record.channels[0].unit == "m/s^2"
    assert record.rate == pytest.approx(10.0)
    blank = read(tmp_path, "".join(f"{j},5   -{j},75\n" for j in range(20)))
    np.testing.assert_allclose(blank.channels[1].values(), -np.arange(20) - 0.75)


def test_comma_decimals_with_comma_separators(tmp_path: Path) -> None:
    body = [f"{j},25,-{j},0{j % 7}" for j in range(20)]
    paired = read(tmp_path, lines(["a [g],b [g]", *body]))
    assert paired.names == ("a", "b")
    np.testing.assert_allclose(paired.channels[0].values(), np.arange(20) + 0.25)
    assert told(paired) == [("commas_ambiguous", {})]
    with pytest.raises(InputError, match=r"may be 4 integers or 2 numbers with a decimal comma"):
        read(tmp_path, lines(body))
    given = read(tmp_path, lines(body), decimal=",")
    np.testing.assert_allclose(given.channels[0].values(), np.arange(20) + 0.25)
    whole = read(tmp_path, lines(body), decimal=".")
    assert len(whole.channels) == 4


def test_a_mixture_of_whole_and_comma_numbers_is_refused(tmp_path: Path) -> None:
    body = [f"{j},25,{j}" for j in range(20)]
    with pytest.raises(InputError, match=r"2 names over rows of 3 fields: some commas part"):
        read(tmp_path, lines(["a,b", *body]))


def test_both_decimals_in_one_file_are_refused(tmp_path: Path) -> None:
    body = [f"{j}.5;{j},5" for j in range(20)]
    with pytest.raises(InputError, match=r"it holds both 1,2 and 1\.2: give --decimal$"):
        read(tmp_path, lines(body))


@pytest.mark.parametrize("empty", ["", '""', "nan", "-"])
@pytest.mark.parametrize(("column", "width"), [(0, 2), (1, 2), (0, 3), (1, 3), (2, 3)])
@pytest.mark.parametrize(("parted", "decimal"), [(",", "."), (";", ","), ("\t", ".")])
@pytest.mark.parametrize("first", [[0], [1], [0, 1, 2], list(range(0, 450, 3)), list(range(440))])
def test_an_empty_cell_is_one_in_the_first_row_as_in_any_other(
    tmp_path: Path,
    empty: str,
    column: int,
    width: int,
    parted: str,
    decimal: str,
    first: list[int],
) -> None:
    table = np.column_stack([np.arange(450) / 1000.0, np.cos(np.arange(450.0)), np.ones(450)])
    body = [[f"{v:.6f}".replace(".", decimal) for v in row[:width]] for row in table]
    for row in first:
        body[row][column] = empty
    text = [parted.join(one) for one in [["time [s]", "a [g]", "b [g]"][:width], *body]]
    found = read(tmp_path, lines(text))
    assert found.names == ("a", "b")[: width - 1]
    assert {c.unit for c in found.channels} == {"g"}
    assert found.samples == 450
    assert (found.rate is None) == (column == 0)
    for k, channel in enumerate(found.channels, start=1):
        missing = first if k == column else []
        assert list(np.flatnonzero(np.isnan(channel.values()))) == missing


def test_rows_without_a_number_are_rows(tmp_path: Path) -> None:
    body = [f"{j}.5,{j % 7}.25" for j in range(40)]
    found = read(tmp_path, lines(["a [g],b [g]", "nan,NaN", *body]))
    assert (found.names, found.samples) == (("a", "b"), 41)
    # a line of separators is none, wherever it is
    for place in (0, 3):
        split = [*body[:place], ",", *body[place:]]
        found = read(tmp_path, lines(["a [g],b [g]", *split]))
        assert (found.names, found.samples) == (("a", "b"), 40)


def test_a_separator_at_the_end_of_every_line_parts_nothing(tmp_path: Path) -> None:
    for head in ("time [s];a [g];", "time [s];a [g]"):
        found = read(tmp_path, lines([head, *(f"{j / 100:.2f};{j % 7}.5;" for j in range(40))]))
        assert (found.names, found.rate, found.notices) == (("a",), pytest.approx(100.0), ())


def test_points_are_named_where_commas_are_asked_for(tmp_path: Path) -> None:
    body = [f"{j}.5,{j % 7}.25" for j in range(40)]
    with pytest.raises(InputError, match=r"decimal comma: '0\.5' holds a point; --decimal \.$"):
        read(tmp_path, lines(["a,b", *body]), decimal=",")


@pytest.mark.parametrize(
    ("encoding", "codes"),
    [
        ("utf-8", []),
        ("utf-8-sig", []),
        ("utf-16", ["text_utf_16"]),
        ("utf-16-le", ["text_utf_16_unmarked"]),
        ("gbk", ["text_not_utf_8"]),
    ],
)
def test_encodings(tmp_path: Path, encoding: str, codes: list[str]) -> None:
    text = "时间(s),加速度(m/s²)\n".replace("²", "2")
    text += "".join(f"{j / 1000:.4f},{j}.5\n" for j in range(40))
    record = read(tmp_path, text.encode(encoding))
    assert record.names == ("加速度",)
    assert record.channels[0].unit == "m/s^2"
    assert record.rate == pytest.approx(1000.0)
    assert [code for code, _ in told(record)] == codes


def test_units_row_and_comment_lines(tmp_path: Path) -> None:
    text = "% rig 7\n% a note\ntime\ta1\ta2\ns\tg\tm/s^2\n"
    text += "".join(f"{j / 100:.2f}\t{j}.5\t{j}.25\n" for j in range(20))
    record = read(tmp_path, text, "r.txt")
    assert [c.unit for c in record.channels] == ["g", "m/s^2"]
    assert record.rate == pytest.approx(100.0)


def test_more_channels_than_the_text_says(tmp_path: Path) -> None:
    names = ",".join(f"c{i}" for i in range(27))
    body = [",".join(f"{i + j}.5" for i in range(28)) for j in range(20)]
    record = read(tmp_path, lines([names, *body]))
    assert len(record.channels) == 28
    assert record.names[0] == "column 1"
    assert told(record) == [("names_do_not_fit", {"names": 27, "columns": 28})]


def test_a_variable_stored_twice_the_first_all_zeros(tmp_path: Path) -> None:
    zeros, data = np.zeros(100), np.sin(np.arange(100.0))
    one, two = tmp_path / "one.mat", tmp_path / "two.mat"
    io.savemat(one, {"acc": zeros}, do_compression=False)
    io.savemat(two, {"acc": data}, do_compression=False)
    both = tmp_path / "both.mat"
    both.write_bytes(one.read_bytes() + two.read_bytes()[128:])
    record = read_record(both, rate=1000, unit="g")
    assert record.names == ("acc",)
    np.testing.assert_array_equal(record.channels[0].values(), data)
    assert told(record) == [("twin_zero", {"channel": "acc"})]
    both.write_bytes(two.read_bytes() + one.read_bytes()[128:])
    np.testing.assert_array_equal(read_record(both).channels[0].values(), data)
    io.savemat(one, {"acc": data + 1.0}, do_compression=False)
    both.write_bytes(one.read_bytes() + two.read_bytes()[128:])
    differing = read_record(both)
    assert differing.names == ("acc", "acc (2)")
    assert told(differing) == [("twin_renamed", {"channel": "acc", "renamed": "acc (2)"})]


def test_zero_and_constant_channels_are_named(tmp_path: Path) -> None:
    text = lines(["a,b,c"] + [f"0.0,3.5,{j}.5" for j in range(20)])
    record = read(tmp_path, text)
    assert told(record) == [
        ("channel_zero", {"channel": "a"}),
        ("channel_constant", {"channel": "b"}),
    ]


def test_two_rates_in_one_file_are_used_by_neither(tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    np.savez(path, a=np.arange(50.0), fs=1000.0, rate=10000.0)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        record = read_record(path)
    assert record.rate is None
    ((code, data),) = told(record)
    assert code == "rate_stated_twice"
    assert (data["rate"], data["other_rate"], data["ratio"]) == (1000.0, 10000.0, 0.1)


def test_arrays_of_other_lengths_are_left_aside_by_name(tmp_path: Path) -> None:
    path = tmp_path / "r.npz"
    np.savez(path, a=np.arange(50.0), b=np.arange(20.0))
    record = read_record(path)
    assert record.names == ("a",)
    assert told(record) == [("shorter_left_aside", {"samples": 50, "channels": ["b"]})]


@pytest.mark.parametrize(
    ("cell", "expected"),
    [
        ("a1 [g]", ("a1", "g")),
        ("Time(ms)", ("Time", "ms")),
        ("acc / m/s²", ("acc", "m/s^2")),
        ('"Speed (rpm)"', ("Speed", "rpm")),
        ("a [left]", ("a [left]", None)),
    ],
)
def test_units_in_names(cell: str, expected: tuple[str, str | None]) -> None:
    assert split_unit(cell) == expected


def test_spellings_of_units() -> None:
    assert [unit(u) for u in ("m/s²", "G", "[g]", "µm", "msec", "furlong")] == [
        "m/s^2",
        "g",
        "g",
        "um",
        "ms",
        None,
    ]


def test_a_supplied_unit_that_contradicts_is_said(tmp_path: Path) -> None:
    record = read(tmp_path, lines(rows()), unit="m/s^2")
    assert record.channels[0].unit == "m/s^2"
    assert told(record) == [
        ("unit_replaced", {"given": "m/s^2", "channels": ["a"], "units": ["g"]})
    ]


def test_tacho_is_recognised_by_name_and_can_be_named(tmp_path: Path) -> None:
    text = lines(["acc [g],Tacho [V]"] + [f"{j}.5,{j % 2}" for j in range(20)])
    record = read(tmp_path, text)
    assert record.tacho == "Tacho"
    assert [c.name for c in record.signals()] == ["acc"]


STAMPS = np.arange(200) / 1000.0
WAVE = np.sin(STAMPS * 700.0)


def columns(head: str, *values: np.ndarray) -> str:
    """A text of columns, their numbers to 17 digits."""
    return lines([head, *(",".join(f"{v:.17g}" for v in row) for row in zip(*values, strict=True))])


def chosen(record: Record) -> tuple[list[str], list[Notice]]:
    """The channels that are reduced, and the notices with what is left out."""
    notices = list(record.notices)
    return [c.name for c in chosen_channels(record, (), notices)], notices


@pytest.mark.parametrize(
    ("head", "in_one"),
    [
        *(("time [h]", 3600.0), ("Zeit (d)", 86400.0), ("time [ns]", 1e-9), ("Seconds", 1.0)),
        *(("Elapsed Time (s)", 1.0), ("Relative time [s]", 1.0), ("X [s]", 1.0), ("ti [ms]", 1e-3)),
        *(("tiempo [minutes]", 60.0), ("time_s", 1.0)),
    ],
)
def test_a_column_of_a_unit_of_time_is_the_time(tmp_path: Path, head: str, in_one: float) -> None:
    first = read(tmp_path, columns(f"{head},acc [g]", STAMPS / in_one, WAVE))
    last = read(tmp_path, columns(f"acc [g],{head}", WAVE, STAMPS / in_one), channels=[1])
    for record in (first, last):
        assert record.names == ("acc",)
        assert record.rate == pytest.approx(1000.0)


def test_of_several_times_the_one_that_tells_the_rate_is_used(tmp_path: Path) -> None:
    noise = np.cos(7.0 * STAMPS) + 20.0
    heads = "T [degC],delay [ms],time,run [ms],acc [g]"
    text = columns(heads, noise, noise, STAMPS, 1000.0 * STAMPS, WAVE)
    record = read(tmp_path, text)
    assert (record.names, record.rate) == (("T", "acc"), pytest.approx(1000.0))
    assert ("several_time_columns", {"columns": 3, "used": "run"}) in told(record)
    unsaid = read(tmp_path, columns("delay [ms],acc [g]", noise, WAVE))
    assert (unsaid.names, unsaid.rate) == (("acc",), None)
    assert [code for code, data in told(unsaid) if data.get("column") == "delay"] == ["time_falls"]


def test_an_unknown_unit_of_time_is_named(tmp_path: Path) -> None:
    record = read(tmp_path, columns("time [weeks],T [K],acc (h)", STAMPS, WAVE, WAVE))
    assert (record.names, record.rate) == (("T [K]", "acc (h)"), None)
    assert told(record) == [("time_unit_not_known", {"column": "time [weeks]", "unit": "weeks"})]


def test_a_unit_of_time_is_told(tmp_path: Path) -> None:
    plain = read(tmp_path, columns("time [us],acc [g]", STAMPS * 1e6, WAVE))
    assert told(plain) == [("time_unit", {"column": "time", "unit": "us"})]


@pytest.mark.parametrize("index", [np.arange(200.0), np.arange(1.0, 201.0), 200.0 - np.arange(200)])
@pytest.mark.parametrize("rate", [None, 1000.0])
def test_an_index_is_no_vibration(tmp_path: Path, index: np.ndarray, rate: float | None) -> None:
    record = read(tmp_path, columns("sample,raw,acc [m/s^2]", index, WAVE, WAVE), rate=rate)
    names, notices = chosen(record)
    assert names == ["acc"]
    assert [n.code for n in notices] == ["channel_counts", "several_units"]
    assert notices[0].data == {"channel": "sample"}
    assert notices[1].data == {"unit": "m/s^2", "channels": ["raw"], "units": None}
    with pytest.raises(InputError, match=r"^channel: got 'sample'; channel 'sample' .*--rate\)$"):
        chosen_channels(record, ["sample"], [])


def test_a_drift_of_a_known_unit_is_a_channel() -> None:
    drift = 3.0 * np.arange(200) + WAVE
    assert [counts(Channel("a", drift, one)) for one in ("g", None)] == [False, True]
    rounded = np.round(np.arange(200) * 0.97, 1)
    jitters = STAMPS + 2e-4 * np.cos(np.arange(200) ** 2)
    assert all(counts(Channel("a", one)) for one in (rounded, jitters, -STAMPS))
    assert counts(Channel("a", rounded, "mm"))
    steps = np.arange(200) // 100
    assert not any(counts(Channel("a", one)) for one in (WAVE, steps, 0.0 * WAVE))


def test_volts_do_not_take_the_place_of_a_channel_without_a_unit() -> None:
    channels = Channel("acc", WAVE), Channel("trigger", 2.0 * WAVE, "V")
    names, notices = chosen(Record(channels, "x"))
    assert names == ["acc"]
    assert (notices[0].code, notices[0].data["channels"]) == ("several_units", ["trigger"])


def test_a_dead_channel_is_told_once(tmp_path: Path) -> None:
    nothing = np.full(200, np.nan)
    text = columns("time [s],acc [g],b [g],c [g]", STAMPS, WAVE, nothing, 0.0 * WAVE)
    names, notices = chosen(read(tmp_path, text))
    assert names == ["acc"]
    assert [(n.code, n.data["channel"]) for n in notices] == [
        ("channel_empty", "b"),
        ("channel_zero", "c"),
    ]
