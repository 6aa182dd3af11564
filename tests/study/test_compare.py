"""Comparisons: the thesis's own table recomputed, verdicts by u_val, like compared with like."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats.mstats import hdquantiles

from coded import coded
from conftest import Compared
from said import numbers
from thermogear.base.errors import InputError
from thermogear.case.case import load_case, load_example
from thermogear.gears.turn import mean_tooth
from thermogear.measured.chain import Chain
from thermogear.measured.comparison import figures, result_of
from thermogear.measured.published import (
    RPM,
    LineTable,
    SpeedLine,
    read_lines,
    unstated_processing,
)
from thermogear.measured.record import Channel, Record
from thermogear.measured.reduction import measure
from thermogear.measured.verdicts import HEAT, LACKING, Row, heat_of, verdict
from thermogear.study import compare as study
from thermogear.study.case_runs import DRAWINGS, PARTS, CaseRuns, scaled
from thermogear.study.compare import compare
from thermogear.study.series import series_parts
from thermogear.views.write import page_of

WITH = HEAT["without heat"]


def test_the_thesis_table_recomputed(compared: Compared) -> None:
    found = compare("thesis-5.2")
    errors = {
        (round(row.speed / RPM), row.quantity): [round(-100 * e, 2) for e in row.errors]
        for row in found.rows
    }
    known = {
        (1000, "frequency"): [1.60, 2.07],
        (1000, "displacement"): [16.35, 21.44],
        (2000, "frequency"): [0.79, 1.15],
        (2000, "displacement"): [17.62, 21.50],
        (3000, "frequency"): [0.29, 0.53],
        (3000, "displacement"): [15.46, 18.35],
    }
    assert errors.keys() == known.keys()
    gaps = [np.subtract(errors[key], known[key]) for key in known]
    compared(
        "errors of the thesis's experiment table, recomputed to 0.01 %",
        "its own entries",
        gaps,
        0.0,
        "%",
    )


def test_the_entry_that_no_rounding_explains_and_nothing_else_is_named() -> None:
    wrong = [n.data for n in compare("thesis-5.2").notices if n.code == "printed_error_wrong"]
    assert [one["speed"] / RPM for one in wrong] == pytest.approx([2000.0])
    shares = [[one[k] for k in ("printed", "error", "least", "greatest")] for one in wrong]
    assert shares == [pytest.approx([0.185, 0.215, 0.2127, 0.2173], abs=5e-5)]


def test_what_its_lines_imply() -> None:
    implied = compare("thesis-5.2").implied
    assert [round(item.acceleration_g, 1) for item in implied] == [7.4, 53.9, 305.9]
    speeds = [round((item.shaft_speed or 0.0) / RPM, 1) for item in implied]
    assert speeds == [1007.3, 1998.2, 3003.8]
    assert [round(item.offset_hertz or 0.0, 2) for item in implied] == [3.03, -0.75, 1.60]


def test_its_frequency_column_is_impossible() -> None:
    found = compare("thesis-5.2")
    verdict, _, why = found.row(1000 * RPM, "frequency").verdict.partition(":")
    assert (verdict, numbers(why)) == ("impossible", [413.0, 411.0, 416.667, 0.72])
    told = {notice.code: notice.data for notice in found.notices}
    assert 1000 * RPM in told["frequency_impossible"]["speeds"]
    high = told["acceleration_implausible"]
    assert np.array(high["speeds"]) / RPM == pytest.approx([2000.0, 3000.0])
    assert np.array(high["accelerations"]) / 9.80665 == pytest.approx([53.9, 305.9], abs=0.05)


def test_its_conclusion_is_not_resolvable_by_u_val() -> None:
    found = compare("thesis-5.2")
    rows = [row for row in found.rows if row.quantity == "displacement"]
    assert {row.verdict for row in rows} == {"not resolvable"}
    for row in rows:
        assert abs(row.errors[1]) - abs(row.errors[0]) < row.u_val
    (heat,) = found.heat
    assert (heat.verdict, heat.nearer, heat.rows) == ("undecided", 3, 3)
    gains = [abs(row.errors[1]) - abs(row.errors[0]) for row in rows]
    assert heat.gain == pytest.approx(np.mean(gains), rel=1e-12)
    assert heat.u_val == pytest.approx(np.mean([row.u_val for row in rows]), rel=1e-12)
    told = [3.0, 3.0, round(100 * heat.gain, 2), round(100 * heat.u_val, 2), 3.0, 3.0]
    assert numbers(found.conclusion) == told


def test_with_a_good_measurement_the_same_figures_would_be_resolvable() -> None:
    found = compare("thesis-5.2", u_data=0.01)
    rows = [row for row in found.rows if row.quantity == "displacement"]
    assert {row.verdict for row in rows} == {f"{found.models[0]} better"}
    assert rows[0].u_val == pytest.approx(0.01)


def test_the_verdict_turns_exactly_at_u_val() -> None:
    names = ("A", "B")
    assert verdict(row_of(-0.10, 0.13, u_data=0.0299), names) == "A better"
    assert verdict(row_of(-0.10, 0.13, u_data=0.0301), names) == "not resolvable"
    assert verdict(row_of(0.2, -0.1, u_data=0.05), names) == "B better"
    assert verdict(row_of(0.04, u_data=0.05), ("A",)) == "within u_val"


@pytest.mark.parametrize(("u_data", "u_input", "lacking"), [
    (0.0, 0.1, "u_data"), (0.1, 0.0, "u_input"), (0.1, 0.1, None),
])  # fmt: skip
def test_nothing_is_better_where_an_uncertainty_is_stated_as_zero(
    u_data: float, u_input: float, lacking: str | None
) -> None:
    names = ("undeformed", "hot")
    row = replace(row_of(0.9, 0.1, u_data=u_data), u_input=u_input, computed=True)
    (heat,) = heat_of([row], names)
    if lacking is None:
        assert (verdict(row, names), heat.verdict, heat.rows) == (f"{names[1]} better", WITH, 1)
    else:
        assert verdict(row, names) == heat.verdict == LACKING[lacking]
        assert (heat.rows, heat.gain, heat.u_val) == (0, 0.0, 0.0)


@pytest.mark.parametrize("shift", [-0.2, -0.05, 0.0, 0.05, 0.2])
def test_the_verdict_on_heat_turns_at_the_mean_uncertainty(shift: float) -> None:
    """Both errors exchanged, the verdict is the other one; rows far off say nothing."""
    names = ("b undeformed", "b hot")
    rows = [row_of(0.3 + shift + d, 0.3, u_data=0.1 + d) for d in (-0.02, 0.0, 0.02)]
    rows.append(row_of(5.0, 4.0, u_data=0.1))
    (heat,) = heat_of(rows, names)
    (other,) = heat_of([replace(r, simulated=r.simulated[::-1]) for r in rows], names)
    assert (heat.rows, heat.gain, heat.u_val) == pytest.approx((3, shift, 0.1))
    assert other.gain == pytest.approx(-heat.gain, abs=1e-15)
    turned = {WITH: "without heat", "without heat": WITH}
    assert other.verdict == turned.get(heat.verdict, "undecided")
    assert (heat.verdict == "undecided") == (abs(shift) <= 0.1)


def row_of(*errors: float, u_data: float) -> Row:
    simulated = tuple(1.0 + error for error in errors)
    return Row(speed=1.0, quantity="displacement", measured=1.0, simulated=simulated, u_data=u_data)


def one_line(name: str, *, rpm: float, hertz: float, micrometres: float = 10.0) -> LineTable:
    line = SpeedLine(speed=rpm * RPM, frequency=hertz, displacement=1e-6 * micrometres)
    return LineTable(name, (line,), 25, name, 0.1, processing_stated=True)


def test_no_drawing_of_the_flanks_reverses_the_verdict_of_another(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Flanks of a class are known as a class: what is measured lies between the two models."""
    swings = np.random.default_rng(7).uniform(0.95, 1.05, DRAWINGS + 1)

    def drawn(runs: CaseRuns, changes: dict[str, str]) -> dict[str, LineTable]:
        number = int({**runs.kept, **changes}["flanks.seed"])
        return {
            name: one_line(name, rpm=3000.0, hertz=1250.0, micrometres=size * swings[number])
            for name, size in (("undeformed", 10.0), ("hot", 9.0))
        }

    monkeypatch.setattr(study, "_tables", drawn)
    cases = [
        load_example("fzg-a", {"flanks.seed": str(number), "flanks.accuracy": "6"})
        for number in range(1, DRAWINGS + 1)
    ]
    said, better = [], [f"{name} better" for name in ("hot", "undeformed")]
    for measured in np.linspace(8.0, 11.0, 7):
        table = one_line("rig", rpm=3000.0, hertz=1250.0, micrometres=float(measured))
        found = [compare(case, table, u_num=0.0, u_data=0.001) for case in cases]
        verdicts = {one.row(3000 * RPM, "displacement").verdict for one in found}
        assert not set(better) <= verdicts, measured
        said.append(verdicts)
    assert (said[0], said[-1]) == ({better[0]}, {better[1]})
    (told,) = coded(found[0].notices)["u_input_of_drawings"]
    assert told == {"drawings": 8, "accuracy": 6}
    row = found[0].row(3000 * RPM, "displacement")
    most = np.abs(swings[1:] / swings[1] - 1.0).max()
    assert row.u_input == pytest.approx(most * max(row.simulated) / row.measured, rel=1e-9)


def test_no_part_of_a_series_makes_another_model_the_better_one(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """What is measured is a part of the class under one model: the other is never nearer."""
    swings = np.random.default_rng(8).lognormal(0.0, 0.5, PARTS)
    sizes = {"undeformed": 10.0, "hot": 8.0}

    def drawn(runs: CaseRuns, changes: dict[str, str]) -> dict[str, LineTable]:
        part = swings[int({**runs.kept, **changes}["flanks.drawing"])]
        return {
            name: one_line(name, rpm=3000.0, hertz=1250.0, micrometres=size * part)
            for name, size in sizes.items()
        }

    monkeypatch.setattr(study, "_tables", drawn)
    case = load_example("fzg-a", {"flanks.parts": "64", "flanks.accuracy": "6"})
    for other, size in zip(sizes, reversed(sizes.values()), strict=True):
        for part in swings:
            table = one_line("rig", rpm=3000.0, hertz=1250.0, micrometres=size * part)
            found = compare(case, table, u_num=0.0, u_data=0.001)
            row = found.row(3000 * RPM, "displacement")
            assert row.verdict != f"{other} better"
    # a line that no part shows tells the models apart
    far = one_line("rig", rpm=3000.0, hertz=1250.0, micrometres=25.0 * swings.max())
    outside = compare(case, far, u_num=0.0, u_data=0.001).row(3000 * RPM, "displacement")
    assert abs(outside.errors[0]) > outside.u_input
    middle = hdquantiles(swings, [0.05, 0.5, 0.95])
    assert outside.simulated == pytest.approx([1e-6 * size * middle[1] for size in sizes.values()])
    most = np.abs(swings / middle[1] - 1.0).max()
    assert row.u_input == pytest.approx(most * max(row.simulated) / row.measured, rel=1e-9)
    notices = coded(found.notices)
    (told,) = notices["measured_part_of_class"]
    assert told["bands"] == [pytest.approx(8e-6 * middle[::2])]
    assert notices["u_input_of_drawings"] == [{"drawings": PARTS, "accuracy": 6}]


PAIR = """[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = {}
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""


@pytest.mark.parametrize(("teeth", "periods"), [(40, 40), (47, 1)])
def test_the_parts_compared_are_those_of_the_series(teeth: int, periods: int) -> None:
    """Over the turn of 40 mesh periods; of one of 940 the mean tooth."""
    runs = CaseRuns.of(load_case(PAIR.format(teeth)))
    whole, part = runs.case({}), runs.case(runs.drawings()[3])
    assert (whole.series, part.series, part.period.mesh_periods) == (64, 1, periods)
    known = series_parts(whole, 4)[3]
    assert part.deviations == (known if periods > 1 else mean_tooth(part.pair, known))


@pytest.mark.parametrize(
    ("rpm", "hertz", "said"),
    [
        (1000.14, 25 * 1000.14 / 60, "set by the speed, not by the model"),  # its own speed
        (1000.0, 25 * 1000.14 / 60, "set by the speed, not by the model"),  # 0.014 % off
        (1000.0, 25 * 1000.00 / 120, "set by the speed, not by the model"),  # a half order
        (1000.0, 25 * 1003.00 / 60, "impossible: A (417.917 Hz) is no line j/n of the 416.667 Hz "
         "that forces the model, known to 0.02 %"),
    ],
)  # fmt: skip
def test_a_line_is_impossible_only_beyond_what_the_speeds_are_known_to(
    rpm: float, hertz: float, said: str
) -> None:
    """The measured line is 0.02 % off the speed stated for it."""
    measured = one_line("rig", rpm=1000.0, hertz=25 * 1000.2 / 60)
    models = {
        "A": one_line("A", rpm=rpm, hertz=hertz),
        "B": one_line("B", rpm=1000.0, hertz=25 * 1000.0 / 60),
    }
    assert compare(models, measured).row(1000 * RPM, "frequency").verdict == said


def test_unstated_processing_is_the_spread_of_a_uniform_loss() -> None:
    parts = unstated_processing(419.7, highest=1251.6)
    assert parts["window"] == pytest.approx(0.1512 / np.sqrt(12), abs=1e-4)
    assert parts["integration"] == pytest.approx(0.1106 / np.sqrt(12), abs=1e-3)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
def test_a_table_file_against_tables(encoding: str, tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    path.write_text(
        "speed [1/min];frequency [Hz];displacement [µm];uncertainty [%]\n"
        "1000;416.667;10.0;2\n2000;833.333;20.0;2\n",
        encoding=encoding,
    )
    table = read_lines(path, 25)
    assert [line.speed / RPM for line in table.lines] == pytest.approx([1000.0, 2000.0])
    a = LineTable("A", (SpeedLine(speed=1000 * RPM, frequency=416.667, displacement=9.9e-6),))
    b = LineTable("B", (SpeedLine(speed=1000 * RPM, frequency=416.667, displacement=9.0e-6),))
    found = compare({"A": a, "B": b}, path, teeth=25)
    row = found.row(1000 * RPM, "displacement")
    assert row.verdict == "A better"
    assert row.u_val == pytest.approx(0.02)
    skipped = [n.data["speed"] for n in found.notices if n.code == "speed_not_simulated"]
    assert skipped == pytest.approx([2000.0 * RPM])
    assert all(row.speed == pytest.approx(1000.0 * RPM) for row in found.rows)
    assert set(found.row(1000 * RPM, "frequency").errors) == {0.0}
    assert figures(found)["rows"][1]["verdict"] == "A better"


def test_refusals_of_tables(tmp_path: Path) -> None:
    path = tmp_path / "rig.csv"
    path.write_text("speed,frequency [Hz],displacement [um]\n1000,416,10\n")
    with pytest.raises(InputError, match=r"^table\.speed: got no unit; state it: speed \[\.\.\.\]"):
        read_lines(path)
    with pytest.raises(InputError, match=r"^measured: got nothing; a record, a table or thesis-5"):
        compare({"A": LineTable("A", (SpeedLine(speed=1.0, frequency=1.0, displacement=1.0),))})
    with pytest.raises(
        InputError,
        match=r"^measured: got thesis-5\.3; there is no such file; did you mean 'thesis-5\.2'",
    ):
        compare("thesis-5.2", "thesis-5.3")
    with pytest.raises(InputError, match=r"^line\.displacement: got -1; allowed > 0$"):
        SpeedLine(speed=1.0, frequency=1.0, displacement=-1)


def test_a_motion_goes_through_the_records_own_chain() -> None:
    mesh, rate = 416.667, 12_800.0
    turn = 2.0 * np.pi * mesh * np.arange(1 << 15) / rate
    swing = 10e-6 * np.cos(turn + 0.4) + 4.0 * 2e-6 * np.cos(2.0 * turn)
    channel = Channel("made", -((2.0 * np.pi * mesh) ** 2) * swing, "m/s^2")
    record = Record((channel,), "made", rate, "made")
    for method in ("frequency", "line"):
        found = measure(record, teeth=25, chain=Chain(method), sidebands=0)
        line = found.lines[0]
        assert line.frequency == pytest.approx(mesh, rel=1e-7)
        assert line.displacement == pytest.approx(10e-6, rel=2e-4)
        assert found.lines[1].displacement == pytest.approx(2e-6, rel=1e-3)


def made_record(name: str, rpm: float, micrometres: float, swells: float = 0.1) -> Record:
    """A shaft of 25 teeth at ``rpm``, its mesh line with sidebands and its own."""
    rate, mesh = 12_800.0, 25 * rpm / 60.0
    turn = 2.0 * np.pi * mesh * np.arange(1 << 13) / rate
    swell = 1.0 + swells * np.cos(turn / 25.0)
    waves = np.cos(turn + 0.4) + 0.1 * np.cos(3.0 * turn)
    swing = micrometres * (swell * waves + 0.5 * np.cos(turn / 25.0))
    noise = np.random.default_rng(3).normal(0.0, 0.5, turn.size)
    readings = -((2.0 * np.pi * mesh) ** 2) * 1e-6 * swing + noise
    return Record((Channel("a", readings, "m/s^2"),), name, rate, "made")


@pytest.mark.parametrize("given", [None, (1010.0 * RPM, 2020.0 * RPM)])
def test_a_case_runs_at_the_speed_of_every_record_with_its_own_teeth(
    given: tuple[float, float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Records at 1000.5 and 2001 rpm, of a case at 1500 rpm: one table, one verdict on heat."""
    ran: list[float] = []

    def moved(runs: CaseRuns, changes: dict[str, str]) -> dict[str, LineTable]:
        case = runs.case(changes)
        ran.extend(speed / RPM for speed in case.speeds)
        # the torque of the case decides: its tolerance is an uncertainty of the inputs
        size = 1e-7 * case.torques[0]
        return {
            name: LineTable(name, tuple(
                SpeedLine(speed=n, frequency=25 * n / 2 / np.pi, displacement=k * size)
                for n in case.speeds
            ))
            for name, k in (("b undeformed", 0.5), ("b hot", 0.9))
        }  # fmt: skip

    monkeypatch.setattr(study, "_tables", moved)
    case = load_example("rig", {"operating.speed": '"1500 rpm"'})
    records = [made_record("low", 1000.5, 10.0), made_record("high", 2001.0, 20.0)]
    found = compare(
        case, records, speed=given, u_num=0.0, tolerances={"operating.torque": 0.01}, samples=2
    )
    known = [1000.5, 2001.0] if given is None else [one / RPM for one in given]
    assert sorted(set(np.round(ran, 2))) == pytest.approx(sorted(set(known)), abs=0.02)
    assert [round(row.speed / RPM, 1) for row in found.rows[1::2]] == pytest.approx(known, abs=0.1)
    assert [row.record.split(",")[0] for row in found.rows] == ["low", "low", "high", "high"]
    assert all(item.shaft_speed is not None for item in found.implied)  # of 25 teeth
    (heat,) = found.heat
    assert (heat.bundle, heat.rows, heat.verdict) == ("b", 2, WITH)
    assert heat.gain == pytest.approx(np.mean([0.5 - 0.1, 0.75 - 0.55]), abs=2e-3)
    page = page_of(result_of(found))
    (section,) = [one for one in page.sections if one.name == "comparison"]
    bundle, nearer, share, *_ = section.blocks[0].rows[0]
    assert (bundle, nearer, numbers(share)) == ("b", WITH, [2.0, 2.0])
    assert section.blocks[1].head[0] == "record"


def test_speeds_are_one_for_all_or_one_of_each() -> None:
    with pytest.raises(InputError, match=r"^speed: got 2 speeds of 3 records; allowed one, or one"):
        compare("thesis-5.2", ["thesis-5.2"] * 3, speed=(100.0, 200.0))


def test_a_record_of_another_speed_is_not_judged() -> None:
    record = made_record("low", 1000.5, 10.0, swells=0.0)
    with pytest.raises(InputError) as refused:
        compare("thesis-5.2", record, teeth=25, speed=2000.0 * RPM)
    assert numbers(str(refused.value))[:1] == [2000.0]
    assert "is that of 1000.5 rpm and 25 teeth; leave the speed out" in str(refused.value)


def test_a_toleranced_value_keeps_its_unit() -> None:
    assert scaled("100 N m", 1.1) == "110.00000000000001 N m"
    assert scaled("0.07", 2.0) == "0.14"
    with pytest.raises(InputError, match=r"it is no number with a unit$"):
        scaled("steel", 2.0)


@pytest.mark.slow
def test_a_case_is_compared_with_numerical_and_input_uncertainty() -> None:
    case = load_example(
        "rig",
        {
            "model.bundle": '"consistent"',
            "operating.speed": '"1000 rpm"',
            "simulation.steps_per_period": "128",
            "simulation.discard": "100",
            "simulation.most_discarded": "400",
            "simulation.periods": "32",
            "grid.mesh_positions": "96",
        },
    )
    found = compare(case, "thesis-5.2")
    row = found.row(1000 * RPM, "displacement")
    assert [model.split() for model in found.models] == [
        ["consistent", "undeformed"],
        ["consistent", "hot"],
    ]
    assert 0.0 <= row.u_num < 0.01
    sampled = compare(case, "thesis-5.2", tolerances={"dynamics.damping_ratio": 0.2}, samples=3)
    assert sampled.row(1000 * RPM, "displacement").u_input > 0.0
