"""Several records: what changed beyond its uncertainty, trends, refusals; through the command."""

from __future__ import annotations

import json
import os
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from thermogear.base.errors import InputError
from thermogear.base.units import RPM
from thermogear.front.measure_commands import measure
from thermogear.front.measuring import measured_among
from thermogear.measured import at_once, reduction
from thermogear.measured.at_once import rows_of
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import Measurement
from thermogear.measured.several import Several, result_of_several, several
from thermogear.views.write import page_of

pytestmark = pytest.mark.usefixtures("looked_once")

RATE = 5120.0
WORDS = (
    "rate", "unit", "scale", "teeth", "speed", "tacho", "tacho_scale", "pulses", "harmonics",
    "sidebands", "decimal", "limit", "sensor_tolerance",
)  # fmt: skip


def write(path: Path, size: float, seed: int) -> None:
    t = np.arange(8000) / RATE
    random = np.random.default_rng(seed)
    x = size * np.cos(2 * np.pi * 400 * t) + 0.5 * np.cos(2 * np.pi * 800 * t + 1)
    x += 0.3 * np.cos(2 * np.pi * 1200 * t) + 0.05 * random.standard_normal(t.size)
    np.savetxt(path, np.column_stack([t, x]), "%.7g", ",", header="time [s],acc [g]", comments="")


def test_a_line_that_grew_is_named_and_the_others_are_not(tmp_path: Path) -> None:
    folder = tmp_path / "runs"
    folder.mkdir()
    for number, size in enumerate([1.0, 1.0, 1.05, 1.1, 1.2]):
        write(folder / f"r{number}.csv", size, number)
    (folder / "notes.txt").write_text("no numbers here\n", encoding="utf-8")
    words = [str(folder), "--teeth", "20", "--sidebands", "0", "--baseline", "first", "--json"]
    done = CliRunner().invoke(measure, [*words, "-o", str(tmp_path / "out")])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    assert found["baseline"] == "r0.csv"
    assert [name for name, _ in found["refused"]] == ["notes.txt"]
    changed = {(one["record"], one["name"]): one["change"] for one in found["changed"]}
    for record, size in (("r2.csv", 0.05), ("r3.csv", 0.1), ("r4.csv", 0.2)):
        assert abs(changed[record, "line x 1"] - size) < 0.01
    assert ("r1.csv", "line x 1") not in changed
    (trend,) = [one for one in found["trends"] if one["name"] == "line x 1"]
    assert trend["trend"] > 0.02
    assert (tmp_path / "out" / "records.html").is_file()


def test_damage_of_one_of_several_records_is_told(tmp_path: Path) -> None:
    """Clipped readings are withheld and say so; spikes are a finding; what is whole is compared."""
    for number in range(4):
        write(tmp_path / f"r{number}.csv", 1.0, number)
    table = np.loadtxt(tmp_path / "r1.csv", delimiter=",", skiprows=1)
    table[:, 1] = np.clip(table[:, 1], -0.8, 0.8)
    np.savetxt(tmp_path / "r1.csv", table, "%.7g", ",", header="time [s],acc [g]", comments="")
    table = np.loadtxt(tmp_path / "r2.csv", delimiter=",", skiprows=1)
    table[[1000, 4000, 6000], 1] = 40.0
    np.savetxt(tmp_path / "r2.csv", table, "%.7g", ",", header="time [s],acc [g]", comments="")
    words = [str(tmp_path), "--teeth", "20", "--sidebands", "0", "--json"]
    done = CliRunner().invoke(measure, words)
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    told = [one["text"] for one in found["notices"] if one["level"] in ("important", "warning")]
    assert [("r1.csv" in line, "r2.csv" in line) for line in told] == [(True, False), (False, True)]
    assert [name for name, _ in found["withheld"]] == ["r1.csv"]
    assert [name for name, _ in found["findings"]] == ["r1.csv", "r2.csv"]
    assert found["compared"] == 6
    for name in ("r0.csv", "r2.csv", "r3.csv"):
        (tmp_path / name).unlink()
    write(tmp_path / "r3.csv", 1.0, 3)
    done = CliRunner().invoke(measure, [str(tmp_path), "--teeth", "20", "--sidebands", "0"])
    assert "clipping" in str(done.exception)  # of the baseline: why nothing can be compared


def test_one_record_has_no_baseline(tmp_path: Path) -> None:
    write(tmp_path / "a.csv", 1.0, 1)
    done = CliRunner().invoke(measure, [str(tmp_path / "a.csv"), "--baseline", "first"])
    assert done.exit_code != 0
    assert "there is one record" in str(done.exception)


@pytest.mark.slow
def test_processes_give_the_same_rows_and_one_that_ends_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [tmp_path / f"r{number}.csv" for number in range(3)]
    for number, file in enumerate(files):
        write(file, 1.0, number)
    files[1].write_text("nothing\n", encoding="utf-8")
    options = dict.fromkeys(WORDS) | {
        "channels": (), "orders": (), "method": "line", "bearings": (),
    }  # fmt: skip
    read = partial(measured_among, options=options)
    told: list[tuple[int, int]] = []
    serial = rows_of(read, files, cores=1, progress=lambda _, done, total: None)
    monkeypatch.setattr(at_once, "_FEW", 0)
    both = rows_of(read, files, cores=2, progress=lambda _, done, total: told.append((done, total)))
    assert both == serial
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert [bool(row.refused) for row in both] == [False, True, False]
    with pytest.raises(InputError, match=r"^file: got r\d\.csv; a process ended: "):
        rows_of(ends, files, cores=2, progress=lambda _, done, total: None)


def ends(path: Path) -> Measurement:
    """Refuses, and ends the process for r1."""
    if path.name == "r1.csv":
        os._exit(1)
    raise InputError("file", path.name, why="refused")


# --- one line or two ------------------------------------------------------------------------------


def signal(
    random: np.random.Generator,
    stages: list[tuple[tuple[int, int], float]],
    rpm: float,
    harmonics: tuple[float, ...] = (1.0, 0.4, 0.2),
    swell: float = 0.05,
) -> np.ndarray:
    """Stages of (teeth, size) one after another, the first shaft at ``rpm``; 4 s."""
    turns = rpm / 60.0 * np.arange(4 * 8192) / 8192.0
    x = 0.05 * random.standard_normal(turns.size)
    for (one, other), size in stages:
        swelling = np.ones(turns.size)
        for z in (one, other):
            swelling += swell * np.cos(2 * np.pi * turns * one / z + random.uniform(0.0, 6.0))
        for rank, part in enumerate(harmonics, start=1):
            wave = np.cos(2 * np.pi * rank * one * turns + random.uniform(0.0, 6.0))
            x += size * part * swelling * wave
        turns = turns * one / other
    return x


def compared(
    signals: list[np.ndarray], tacho: list[np.ndarray] | None = None, **options: float
) -> Several:
    """The signals as records r0, r1, ... against the first."""
    records = {}
    for k, x in enumerate(signals):
        channels = [Channel("acc", x, "g")]
        channels += [Channel("tacho", tacho[k], "V")] if tacho else []
        name = "tacho" if tacho else None
        records[Path(f"r{k}")] = Record(tuple(channels), f"r{k}", 8192.0, "made", tacho=name)

    def read(path: Path) -> Measurement:
        return reduction.measure(records[path], sidebands=0, **options)  # type: ignore[arg-type]

    return several(list(records), read)


def mesh_change(found: Several, record: int = 1) -> float:
    """Of the first harmonic; nan: withheld."""
    names = [name for _, name in found.keys]
    place = next(
        k for k, name in enumerate(names) if name in ("mesh x 1", "line x 1", "shaft x 23")
    )
    return float(found.change[record, place])


TRAINS = [((17, 43), (22, 61)), ((37, 53), (15, 44))]


@pytest.mark.parametrize(("first", "second"), TRAINS)
def test_a_second_stage_that_grew_is_no_change_of_the_first(
    first: tuple[int, int], second: tuple[int, int]
) -> None:
    """At one speed stage 1 is as before and stage 2 four times as loud: the mesh line found is
    another one, both are told, and what is stated of a line is true of it."""
    random = np.random.default_rng(sum(first) + sum(second))
    rpm = float(random.uniform(1200.0, 1500.0))
    runs = [signal(random, [(first, 1.0), (second, size)], rpm) for size in (0.4, 1.6, 0.4)]
    found = compared(runs)
    hertz = [turns.hertz for turns in found.turns]
    meshes = rpm / 60.0 * first[0] * np.array([1.0, second[0] / first[1]])
    assert hertz[:2] == pytest.approx(meshes, rel=1e-4)
    assert np.isnan(found.change[1, :]).all()
    assert not found.beyond[1].any()
    assert abs(mesh_change(found, 2)) < 0.01
    ((name, why),) = found.apart
    assert name == "r1"
    assert (why.code, why.data["baseline"]) == ("mesh_line_may_be_another", "r0")
    assert [why.data["base_frequency"], why.data["frequency"]] == hertz[:2]
    result = result_of_several(found)
    assert why in result.notices
    figures = page_of(result).figures
    assert [name for name, _ in figures["apart"]] == ["r1"]
    assert [one["mesh_frequency"] for one in figures["speeds"]] == pytest.approx(hertz)
    # the teeth of stage 1 given: it is read in both, and is as before
    stated = compared(runs, teeth=first[0])
    assert stated.turns[1].hertz == pytest.approx(hertz[0], rel=1e-4)
    assert abs(mesh_change(stated)) < 0.02


@pytest.mark.parametrize("seed", range(4))
def test_a_drift_of_speed_still_compares(seed: int) -> None:
    random = np.random.default_rng(900 + seed)
    teeth = int(random.integers(18, 40)), int(random.integers(41, 90))
    rpm, drift = random.uniform(1000.0, 1400.0), random.uniform(-0.005, 0.005)
    swell = 0.05 if seed % 2 else 0.0  # with teeth that show and without
    runs = [
        signal(random, [(teeth, size)], rpm * more, swell=swell)
        for size, more in ((1.0, 1.0), (1.1, 1.0 + drift))
    ]
    found = compared(runs)
    assert found.apart == ()
    assert mesh_change(found) == pytest.approx(0.1, abs=0.01)
    assert [n for n in result_of_several(found).notices if n.level != "info"] == []


@pytest.mark.parametrize("ratio", [0.5, 1.31, 2.0])
def test_another_speed_is_told_where_the_teeth_decide_and_withheld_where_nothing_does(
    ratio: float,
) -> None:
    random = np.random.default_rng(round(1000 * ratio))
    for swell in (0.06, 0.0):
        runs = [
            signal(random, [((23, 57), size)], 900.0 * more, (1.0, 0.3), swell)
            for size, more in ((1.0, 1.0), (1.2, ratio))
        ]
        found = compared(runs, teeth=23)
        result = result_of_several(found)
        speeds = [one.data for one in result.notices if one.code == "speeds_differ"]
        if swell == 0.0:
            assert np.isnan(mesh_change(found))
            assert [name for name, _ in found.apart] == ["r1"]
            assert speeds == []
            continue
        assert mesh_change(found) == pytest.approx(0.2, abs=0.02)
        (told,) = speeds
        assert (told["baseline"], told["others"]) == ("r0", ["r1"])
        assert told["ratios"] == pytest.approx([ratio], rel=1e-4)
        both = [told["baseline_speed"], *told["speeds"]]
        assert np.array(both) / RPM == pytest.approx([900.0, 900.0 * ratio], rel=1e-4)
        assert f"{900 * ratio:.5g} rpm" in "\n".join(page_of(result).lines())


@pytest.mark.parametrize("rank", [2, 3])
def test_a_harmonic_taken_for_the_mesh_is_not_compared_with_it(rank: int) -> None:
    """The first harmonic is gone: what is found is a multiple of the mesh frequency."""
    random = np.random.default_rng(70 + rank)
    sizes = np.zeros(3 * rank)
    sizes[rank - 1 :: rank] = 1.0, 0.4, 0.2
    for swell in (0.05, 0.0):
        whole = signal(random, [((20, 47), 1.0)], 1000.0, (1.0, 0.4, 0.2), swell)
        taken = signal(random, [((20, 47), 1.0)], 1000.0, tuple(sizes), swell)
        found = compared([whole, taken])
        if abs(found.turns[1].hertz / found.turns[0].hertz - 1.0) > 0.02:
            assert np.isnan(mesh_change(found))


@pytest.mark.parametrize("ratio", [1.0, 1.5, 2.0])
def test_a_tacho_decides_whether_a_line_is_the_same(ratio: float) -> None:
    """One mesh line without sidebands and a pulse a turn; then the line is at another order."""
    random = np.random.default_rng(round(10 * ratio))
    turns = [rpm / 60.0 * np.arange(4 * 8192) / 8192.0 for rpm in (900.0, 900.0 * ratio)]
    pulses = [5.0 * (one % 1.0 < 0.2) for one in turns]
    lines = [
        size * np.cos(2 * np.pi * 23 * one) + 0.3 * np.cos(2 * np.pi * 46 * one + 1.0)
        for size, one in zip((1.0, 1.1), turns, strict=True)
    ]
    noise = [0.05 * random.standard_normal(one.size) for one in turns]
    runs = [line + more for line, more in zip(lines, noise, strict=True)]
    assert mesh_change(compared(runs, pulses)) == pytest.approx(0.1, abs=0.01)
    steady = compared(runs, [pulses[0], pulses[0]])
    assert np.isnan(mesh_change(steady)) == (ratio != 1.0)


def test_a_record_of_another_rate_is_at_its_own_speed_and_one_without_is_not_compared() -> None:
    random = np.random.default_rng(31)
    runs = [signal(random, [((23, 57), size)], 900.0) for size in (1.0, 1.2)]
    for rate, ratio in ((8192.0, 1.0), (4096.0, 0.5), (None, np.nan)):
        records = {
            Path(name): Record((Channel("acc", x, "g"),), name, own, "made")
            for name, x, own in zip("ab", runs, (8192.0, rate), strict=True)
        }
        found = several(
            list(records), lambda path, of=records: reduction.measure(of[path], teeth=23)
        )  # type: ignore[misc]
        assert found.ratio[1] == pytest.approx(ratio, rel=1e-3, nan_ok=True)
        assert np.isnan(mesh_change(found)) == (rate is None)
        apart = [told.data["frequency"] for _, told in found.apart]
        assert apart == [None] * (rate is None)
