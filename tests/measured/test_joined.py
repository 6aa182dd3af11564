"""Files of one run: channels beside each other, pieces after one another; what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result
from numpy.typing import NDArray

from thermogear.base.errors import InputError
from thermogear.front.measure_commands import measure
from thermogear.measured.joined import files_of, join_records, named, only
from thermogear.measured.readers import read_record
from thermogear.measured.record import Channel, Notice, Record

Floats = NDArray[np.float64]

RATE = 5120.0
COUNT = 6000
WORDS = ["--teeth", "20", "--speed", "1200.9", "--sidebands", "0", "--harmonics", "1"]


def signal(seed: int, count: int = COUNT, size: float = 1.0) -> Floats:
    t = np.arange(count) / RATE
    x = size * np.cos(2 * np.pi * 400.3 * t) + 0.4 * np.cos(2 * np.pi * 800.6 * t + seed)
    return np.asarray(x + 0.05 * np.random.default_rng(seed).standard_normal(count))


def write(
    path: Path, x: Floats, *, start: float = 0.0, head: str = "acc [g]", rate: float = RATE
) -> Path:
    t = start + np.arange(x.size) / rate
    table = np.column_stack([t, x])
    np.savetxt(path, table, "%.9g", ",", header=f"time [s],{head}", comments="")
    return path


def asked(*words: object) -> Result:
    return CliRunner().invoke(measure, [*map(str, words), *WORDS])


def refusal(done: Result) -> str:
    assert isinstance(done.exception, InputError), (done.output, done.exception)
    text = str(done.exception)
    assert "\n" not in text
    return text


def found_in(done: Result) -> dict[str, object]:
    assert done.exit_code == 0, (done.output, done.exception)
    return json.loads(done.stdout)  # type: ignore[no-any-return]


def test_channels_of_one_run_read_as_if_they_stood_in_one_file(tmp_path: Path) -> None:
    a, b = signal(1), signal(2, size=0.5)
    one, two = write(tmp_path / "left.csv", a), write(tmp_path / "right.csv", b)
    whole = tmp_path / "whole.csv"
    t = np.arange(COUNT) / RATE
    head = "time [s],left.csv::acc [g],right.csv::acc [g]"
    np.savetxt(whole, np.column_stack([t, a, b]), "%.9g", ",", header=head, comments="")
    joined = found_in(asked(one, two, "--join", "channels", "--json"))
    same = found_in(asked(whole, "--json"))
    assert joined["lines"] == same["lines"]
    assert all(file.name in str(joined["source"]) for file in (one, two))
    assert joined["teeth"] == same["teeth"] == 20


def test_pieces_of_one_run_read_as_the_run(tmp_path: Path) -> None:
    x = signal(3)
    names = [tmp_path / f"p{number}.csv" for number in (2, 9, 10)]
    edges = [0, 1500, 4000, COUNT]
    for path, first, stop in zip(names, edges[:-1], edges[1:], strict=True):
        write(path, x[first:stop], start=first / RATE)
    whole = write(tmp_path / "whole.csv", x)
    same = found_in(asked(whole, "--json"))
    whole.unlink()
    joined = found_in(asked(tmp_path, "--join", "time", "--json"))
    assert "p2.csv" in str(joined["source"])
    for one, other in zip(joined["lines"], same["lines"], strict=True):  # type: ignore[call-overload]
        for key in ("frequency", "reading", "displacement", "reading_half_width"):
            assert one[key] == pytest.approx(other[key], rel=1e-7)  # stamps are rounded
    assert joined["findings"] == []


def test_a_gap_between_pieces_is_a_finding_of_the_gate(tmp_path: Path) -> None:
    x = signal(4)
    write(tmp_path / "a.csv", x[:3000])
    write(tmp_path / "b.csv", x[3100:], start=3100 / RATE)
    done = found_in(asked(tmp_path, "--join", "time", "--json"))
    (finding,) = done["findings"]  # type: ignore[misc]
    lost = finding["data"]
    assert (lost["first"], lost["last"], lost["samples"]) == (3000, 3099, 100)
    missing = {"samples": 100, "time": 100 / RATE, "before": "a.csv", "after": "b.csv"}
    assert missing in [one["data"] for one in done["notices"]]  # type: ignore[attr-defined]
    same = found_in(asked(tmp_path, "--join", "time", "--channel", "acc", "--json"))
    assert same["lines"] == done["lines"]
    (line,) = [one for one in done["lines"] if one["name"] == "mesh x 1"]  # type: ignore[attr-defined]
    assert abs(line["reading"] - 1.0) < line["reading_half_width"]


@pytest.mark.parametrize(
    ("how", "starts", "counts", "said"),
    [
        ("time", (1.0, 0.0), (3000, 3000), "before a.csv ends"),
        ("time", (0.0, 9e3), (3000, 3000), "longer than all pieces together"),
        ("channels", (0.0, 0.0), (3000, 2000), "b.csv holds"),
        ("channels", (0.0, 5.0), (3000, 3000), "it ends before b.csv starts"),
    ],
)
def test_pieces_and_channels_that_do_not_fit_are_refused(
    tmp_path: Path, how: str, starts: tuple[float, float], counts: tuple[int, int], said: str
) -> None:
    for name, start, count, seed in zip("ab", starts, counts, (5, 6), strict=True):
        write(tmp_path / f"{name}.csv", signal(seed, count), start=start)
    text = refusal(asked(tmp_path, "--join", how))
    assert said.replace("b.csv holds", "it holds 2000 samples, a.csv 3000") in text


def test_other_rates_units_channels_and_equal_files_are_refused(tmp_path: Path) -> None:
    a = write(tmp_path / "a.csv", signal(7))
    slow = write(tmp_path / "c.csv", signal(8), rate=2560.0)
    other = write(tmp_path / "d.csv", signal(8), head="acc [m/s^2]", start=COUNT / RATE)
    strange = write(tmp_path / "e.csv", signal(8), head="vib [g]")
    mute = tmp_path / "f.npy"
    np.save(mute, signal(9))
    empty = tmp_path / "g.csv"
    empty.write_text("", "utf-8")
    single = tmp_path / "h.csv"
    single.write_text("time [s],acc [g]\n0,1\n", "utf-8")
    assert "named twice" in refusal(asked(a, a, "--join", "channels"))
    for how in ("time", "channels"):
        assert "its rate is 2560/s, that of a.csv 5120/s" in refusal(asked(a, slow, "--join", how))
        assert "f.npy" in refusal(asked(a, mute, "--join", how))
        assert "it is empty" in refusal(asked(a, empty, "--join", how))
        assert "h.csv" in refusal(asked(a, single, "--join", how))
        assert "there is one file" in refusal(asked(a, "--join", how))
    assert "'acc' is in m/s^2, in a.csv in g" in refusal(asked(a, other, "--join", "time"))
    assert "it has no channel 'acc', a.csv has" in refusal(asked(a, strange, "--join", "time"))
    assert asked(a, slow, "--join", "tme").exit_code == 2


def test_channels_and_tacho_are_named_across_files(tmp_path: Path) -> None:
    for number in (1, 2):
        write(tmp_path / f"s{number}.csv", signal(number))
    turns = 20.015 * np.arange(COUNT) / RATE
    write(tmp_path / "key.csv", np.where(turns % 1.0 < 0.2, 5.0, 0.0), head="pulse [V]")
    # the tacho's box may run at a rate of its own
    fast = 10 * RATE
    pulses = np.where((20.015 * np.arange(10 * COUNT) / fast) % 1.0 < 0.2, 5.0, 0.0)
    write(tmp_path / "other_key.csv", pulses, head="pulse [V]", rate=fast)
    files = [tmp_path / name for name in ("s1.csv", "s2.csv", "key.csv")]
    for tacho in ("key.csv::pulse", "key.csv", "pulse", "key.csv::1"):
        done = found_in(
            asked(*files, "--join", "channels", "--tacho", tacho, "--pulses", "1", "--json",
                  "--channel", "s2.csv::acc")
        )  # fmt: skip
        assert {one["channel"] for one in done["lines"]} == {"s2.csv::acc"}  # type: ignore[attr-defined]
        assert abs(float(done["shaft_speed"]) / (2 * np.pi) - 20.015) < 2e-3  # type: ignore[arg-type]
    done = found_in(
        asked(*files[:2], tmp_path / "other_key.csv", "--join", "channels", "--json",
              "--pulses", "1", "--tacho", "other_key.csv::pulse")
    )  # fmt: skip
    assert abs(float(done["shaft_speed"]) / (2 * np.pi) - 20.015) < 2e-3  # type: ignore[arg-type]
    words = [*files, "--join", "channels"]
    assert "did you mean 's2.csv'" in refusal(asked(*words, "--channel", "s2.cs::acc"))
    assert "s1.csv has no ac" in refusal(asked(*words, "--channel", "s1.csv::ac"))
    assert "2 files have it" in refusal(asked(*words, "--channel", "acc"))
    assert "allowed 1..3" in refusal(asked(*words, "--channel", "9"))


def test_short_last_blocks_and_late_starts_are_cut(tmp_path: Path) -> None:
    x = signal(11)
    a = read_record(write(tmp_path / "a.csv", x))
    b = read_record(write(tmp_path / "b.csv", signal(12)[40:5990], start=40 / RATE))
    found = join_records([a, b], "channels")
    assert found.samples == 5950
    np.testing.assert_allclose(found.channel("a.csv::acc").values(), x[40:5990], rtol=1e-8)
    cut = {one.code: one.data for one in found.notices}
    assert cut["cut_to_common_start"] == {"samples": 40}
    assert cut["cut_to_shortest"] == {"file": "b.csv", "longest": "a.csv", "samples": 10}
    assert only(found, ["b.csv"]).names == ("b.csv::acc",)
    assert named(found, "2") == ["b.csv::acc"]


def test_what_several_files_tell_alike_is_told_once_with_their_names() -> None:
    silent = Notice.of("channel_constant", channel="b")
    lost = [Notice.of("samples_missing", channel="a", samples=n) for n in (2, 3, 2)]
    records = [
        Record((Channel(name, signal(k), "g"),), f"{name}.csv", RATE, notices=(lost[k], *more))
        for k, (name, more) in enumerate((("a", ()), ("b", (silent,)), ("c", (silent, silent))))
    ]
    told = join_records(records, "channels").notices
    assert [(n.code, n.data.get("in_files"), n.data.get("samples")) for n in told] == [
        ("samples_missing", ["a.csv", "c.csv"], 2),
        ("samples_missing", ["b.csv"], 3),
        ("channel_constant", ["b.csv", "c.csv"], None),
        ("joined_as_channels", None, None),
    ]


def test_joined_samples_are_read_slice_by_slice() -> None:
    random = np.random.default_rng(13)
    raw = random.integers(-99, 99, 700)
    parts = [
        Record((Channel("a", raw[i:j], "g", scale=0.5, offset=1.0),), f"{i}", RATE, "", i / RATE)
        for i, j in ((0, 200), (200, 201), (201, 700))
    ]
    channel = join_records(parts, "time").channel("a")
    for first, stop in random.integers(0, 701, (50, 2)):
        np.testing.assert_array_equal(
            channel.values(first, stop=stop), 0.5 * raw[first:stop].astype(float) + 1.0
        )
    with pytest.raises(InputError, match="join"):
        join_records(parts, "chanels")
    with pytest.raises(InputError, match="1 record"):
        join_records(parts[:1], "time")


def test_files_that_are_not_joined_are_refused_with_both_ways_on(tmp_path: Path) -> None:
    write(tmp_path / "r2.csv", signal(1))
    assert found_in(asked(tmp_path, "--json"))["lines"]
    write(tmp_path / "r10.csv", signal(2))
    text = refusal(asked(tmp_path))
    assert text.startswith("file: got 2 files; allowed one record; ")
    assert "--join" in text
    assert "diagnose --baseline" in text
    words = ["--join", "channels", "--channel", "r3.csv::acc"]
    assert "no file is r3.csv" in refusal(asked(tmp_path, *words))
    assert [one.name for one in files_of([tmp_path])] == ["r2.csv", "r10.csv"]
