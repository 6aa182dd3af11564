"""Commands for diagrams, maps, basins, run-ups and sweeps: from words to stores and pages."""

import json
import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from click.testing import CliRunner

from own_trains import TRAIN
from thermogear import basin_shares, family, load_case
from thermogear.base.display import number
from thermogear.base.errors import InputError
from thermogear.base.vocabulary import contact_name
from thermogear.case.examples import example_text
from thermogear.dynamics.models import TorsionalModel
from thermogear.front.sweep_commands import COMMANDS
from thermogear.results.result import open_results
from thermogear.results.store import RESULT
from thermogear.study import diagrams
from thermogear.study.notices import finished
from thermogear.views.write import page_of

FEW = "[train]\nelements = 4\n[grid]\nmesh_positions = 32\nharmonics = 6\n[transmission_error]\n"
FEW += 'harmonics = [{ order = 1, amplitude = "3 um", phase = "0 deg" }]\n'
GRID = ("--over", "zeta=0.1:0.2:3", "--over", "w=1:2:3")
BY_NAME = {command.name: command for command in COMMANDS}


@pytest.fixture(scope="module")
def cases(tmp_path_factory):
    place = tmp_path_factory.mktemp("cases")
    for name in ("rig", "table-4.2"):
        (place / f"{name}.toml").write_text(example_text(name), encoding="utf-8")
    return place


def call(name, *words):
    result = CliRunner().invoke(BY_NAME[name], [str(w) for w in words], catch_exceptions=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout) if "--json" in words else result.stdout


def test_names_of_the_commands():
    assert list(BY_NAME) == [
        "bifurcation",
        "map",
        "basins",
        "runup",
        "waterfall",
        "sweep",
        "detect",
    ]


@pytest.mark.slow
def test_bifurcation_with_and_without_heat(cases, tmp_path):
    """(b, F) scaled alike changes nothing; eps_T moves the flip as its scaling says."""
    for but, flip in (
        ((), 0.17004302692235368), (("--but", "eps_T=0.02", "--but", "b=0.8"), 0.174447855),
    ):  # fmt: skip
        place = tmp_path / f"d{len(but)}"
        found = call(
            "bifurcation", cases / "table-4.2.toml", "--over", "zeta=0.165:0.18:3",
            "--branch-period", 1, *but, "-o", place, "--json", "--csv", tmp_path / "points.csv",
        )  # fmt: skip
        kept = [row["value"] for row in found["bifurcations"]
                if row["kind"] == "period doubling" and row["period"] == 1]  # fmt: skip
        assert kept == pytest.approx([flip], abs=1e-8)
        assert found["points"] == len(pd.read_csv(tmp_path / "points.csv")) == 6
        page = (place / "report.html").read_text(encoding="utf-8")
        assert page.count("<figure") == 1
        lines = page_of(open_results(place)).lines()
        table = [line for line in lines if re.match(r" .*doubling", line)]
        assert f"{flip:.8g}"[:8] in table[0]


def test_play_of_a_train_is_swept_in_one_command(tmp_path):
    """Every play with its motion both ways, what loses contact, and the greatest force."""
    words = [tmp_path / "train.toml", "--state", "undeformed", "--coordinates", 15, "--threads", 1]
    words += ["--over", "bearings.all.play=5 um:25 um:2", "--branch-period", 0, "--json"]
    (tmp_path / "train.toml").write_text(FEW + TRAIN, encoding="utf-8")
    found = call("bifurcation", *words, "-o", tmp_path / "play")
    assert found["labels"] == {"period-1": 4}
    assert (found["lost_contact"], found["ways_apart"]) == ([], [])
    data = open_results(tmp_path / "play").data
    assert data["bearings.all.play"].values == pytest.approx([5e-6, 25e-6])
    table = page_of(finished(data, "play")).sections[1].blocks[0]
    assert str(table.head[0]).split() == ["bearings.all.play", "[µm]"]
    greatest = data["greatest_mesh_force"].values[0, 0]
    shown = [["5", "0", number(greatest[0], 4)], ["25", "0", number(greatest[1], 4)]]
    assert [[row[k] for k in (0, 4, 5)] for row in table.rows] == shown


def test_map_resumes_and_refuses_other_words(cases, tmp_path):
    words = [cases / "table-4.2.toml", "--over", "omega=1.1:1.3:8", "--over", "eps=0.1:0.9:8",
             "-o", tmp_path / "m", "--json"]  # fmt: skip
    one = call("map", *words)
    again = call("map", *words)
    assert one["labels"] == again["labels"]
    assert one["points"] == 64
    words[2] = "omega=1.1:1.4:8"
    with pytest.raises(InputError, match=r"axes\.frequency\[1\]: got"):
        call("map", *words)


def test_a_map_tells_what_it_assumes_apart_from_what_it_computed(cases, tmp_path, monkeypatch):
    """Rows, page, headline and sums hold what was computed apart from the rest."""
    axes = ("--over", "zeta=0.5:0.9:9", "--over", "w=0.5:0.6:6")
    words = [cases / "table-4.2.toml", *axes, "-o"]
    whole = call("map", *words, tmp_path / "whole", "--json")
    assert (whole["labels"], whole["assumed"]) == ({"period-1": 54}, {})
    assert whole["computed_points"] == whole["points"] == 54

    monkeypatch.setattr(diagrams, "WHOLE", 0.0)
    lines = call("map", *words, tmp_path / "some", "--csv", tmp_path / "some.csv")
    # the first lattice: rows 0, 4, 8 and columns 0, 4, 5
    (motions,) = (line.split() for line in lines.splitlines() if line.startswith("  period-1 "))
    assert motions == ["period-1", "9", "45"]
    table = pd.read_csv(tmp_path / "some.csv")
    assert dict(table["status"].value_counts()) == {"assumed": 45, "ok": 9}
    there = table["status"] == "assumed"
    numbers = table.select_dtypes("number").iloc[:, 3:]  # behind both axes and the period
    assert len(numbers.columns) == 11
    assert numbers[there].isna().all(axis=None)
    assert numbers[~there].notna().all(axis=None)
    page = (tmp_path / "some" / "report.html").read_text(encoding="utf-8")
    told = (
        "Of 54 points 9 were computed: period 1 at 9; equal neighbours speak for the others, "
        "which are assumed and not computed: period 1 at 45.",
        "Hatched: assumed, not computed",
    )
    assert all(words in page for words in told)


def test_basins_and_page(cases, tmp_path):
    found = call(
        "basins", cases / "table-4.2.toml", "--but", "zeta=0.05", "--but", "omega=0.7",
        "--but", "eps=0.1", "--but", "F_m=0.1", "--but", "F_h=0.05",
        "--x=-2:2:21", "--v=-2:2:21", "-o", tmp_path / "b", "--json",
    )  # fmt: skip
    assert sum(row["count"] for row in found["attractors"]) == 441
    page = (tmp_path / "b" / "report.html").read_text(encoding="utf-8")
    assert page.count("<figure") >= 1
    assert "<svg" in page
    assert "http" not in page.replace("http-equiv", "").replace("http://www.w3.org/2000/svg", "")


def test_basins_along_a_parameter(cases, tmp_path):
    """As the function of Python says; the page is drawn from what is stored."""
    words = [cases / "table-4.2.toml", "--but", "zeta=0.05", "--but", "eps=0.1", "--but", "F_m=0.1",
             "--but", "F_h=0.05", "--along", "omega=0.65:0.75:2", "--x=-2:2:10", "--v=-2:2:8",
             "-o", tmp_path / "along"]  # fmt: skip
    found = call("basins", *words, "--json")
    model = TorsionalModel(
        damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1,
        force_amplitude=0.05,
    )  # fmt: skip
    same = basin_shares(model, "frequency", [0.65, 0.75], x=(-2, 2), v=(-2, 2), starts=80)
    rows = {(row["value"], row["motion"]): row for row in found["motions"]}
    for value, motion in rows:
        here = same.sel(frequency=value, motion=motion)
        row = rows[value, motion]
        assert row["motion_count"] == int(here["motion_count"])
        assert row["least_x"] == pytest.approx(float(here["least_x"]), rel=1e-12)
        assert row["motion_share_low"] < row["motion_share"] < row["motion_share_high"]
    assert found["starts"] == 80
    assert sum(row["motion_count"] for row in rows.values()) == 160
    assert (tmp_path / "along" / "report.html").read_text("utf-8").count("<figure") == 1
    assert len(call("basins", *words).splitlines()) > 6


def test_a_push_of_gears_has_units(cases, tmp_path):
    """In metres by the half backlash of the point, in m/s by its natural frequency, too."""
    words = [cases / "rig.toml", "--set", "operating.torque=20 N m", "--along", "rpm=6000:6000:1"]
    call("basins", *words, "--x=-2:2:8", "--v=-2:2:8", "-o", tmp_path / "g")
    data = open_results(tmp_path / "g").data
    points = family(load_case(str(cases / "rig.toml"), {"operating.torque": "20 N m"}), ["rpm"])
    made = points(data["pinion_speed"].values[:, None])
    assert np.isfinite(data["least_x"]).any()
    for axis, name, scale in (
        ("x", "displacement", made.length),
        ("v", "velocity", made.length * made.rate),
    ):
        assert data[f"least_{name}"].values == pytest.approx(
            data[f"least_{axis}"].values * scale[0], nan_ok=True, rel=1e-12
        )


def test_run_up_and_sweep_of_the_rig(cases, tmp_path):
    run = call(
        "runup", cases / "rig.toml", "--rpm", "4200:5200:6", "--branch-period", 0,
        "-o", tmp_path / "r", "--json",
    )  # fmt: skip
    assert [j["direction"] for j in run["jumps"] if j["gears_degC"] == 20.0] == ["up", "down"]
    swept = call(
        "sweep", cases / "rig.toml", "--over", "rpm=1000:2000:2", "--over", "temperature=100:140:2",
        "-o", tmp_path / "s", "--json",
    )  # fmt: skip
    assert swept["labels"] == {"period-1": 4}
    assert (tmp_path / "s" / "report.html").exists()


SERIES = """[gears]
module = "3 mm"
face_width = "30 mm"
pinion = { teeth = 20 }
wheel = { teeth = 20 }
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[temperatures]
pinion_addendum = "90 degC"
wheel_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_bore = "80 degC"
housing = "60 degC"
[grid]
mesh_positions = 32
harmonics = 6
[operating]
speed = "4000 rpm"
torque = "80 N m"
"""


@pytest.mark.filterwarnings("ignore::thermogear.base.errors.ValidityWarning")
def test_a_sweep_has_columns_of_a_series(tmp_path):
    case = tmp_path / "series.toml"
    case.write_text(SERIES, encoding="utf-8")
    words = ("sweep", case, "--over", "damping=0.02:0.07:2", "--state", "undeformed")
    call(*words, "-o", tmp_path / "s", "--csv", tmp_path / "s.csv")
    table = pd.read_csv(tmp_path / "s.csv")
    assert table["series_parts [–]"].tolist() == [16.0] * 2
    # the static error knows no damping
    assert table["series_static_error_bad [µm]"].nunique() == 1
    assert table["series_dynamic_factor_bad [–]"].nunique() == 2
    with pytest.raises(InputError, match=r"^parts: got 3; allowed 1 \| 16..1024$"):
        call(*words, "--parts", 3, "-o", tmp_path / "w")


def test_a_run_up_is_run_in_the_state_it_is_given(cases, tmp_path):
    words = [cases / "rig.toml", "--rpm", "4200:4400:2", "--branch-period", 0]
    states = {"hot": [20.0, 140.0], "60": [20.0, 60.0], "undeformed": [20.0]}
    for state, expected in states.items():
        call("runup", *words, "--state", state, "-o", tmp_path / state)
        with xr.open_zarr(tmp_path / state / RESULT, consolidated=False) as data:
            kelvins = data["gear_temperature"].values
        assert kelvins - 273.15 == pytest.approx(expected)
    with pytest.raises(InputError, match=r"--state: got 60; beside --hot; leave one out"):
        call("runup", *words, "--state", "60", "--hot", "80", "-o", tmp_path / "both")


def test_estimate_alone_writes_nothing(cases, tmp_path):
    call("map", cases / "table-4.2.toml", "--over", "omega=1.1:1.3:8", "--over", "eps=0.1:0.9:8",
         "-o", tmp_path / "e", "--estimate")  # fmt: skip
    assert not (tmp_path / "e").exists()


@pytest.mark.parametrize(
    ("name", "words", "message"),
    [
        ("bifurcation", ["--over", "zeta=a:b:c"], r"over: got 'zeta=a:b:c'; allowed NAME=FROM:TO"),
        ("bifurcation", ["--over", "zetta=0.1:0.2:3"], "did you mean 'zeta'"),
        ("map", ["--over", "zeta=0.1:0.2:3"], "over: got 1 parameters; allowed two for a map"),
        ("sweep", ["--over", "zeta=0.1:0.2:3"], "allowed kind = 'gear'"),
        ("runup", [], "allowed kind = 'gear'"),
        ("basins", ["--x", "1:2"], "x: got '1:2'; allowed FROM:TO:COUNT"),
        ("basins", ["--along", "zetta=0.1:0.2:2"], "did you mean 'zeta'"),
        ("basins", ["--along", "zeta=0.1:0.2:2", "--x=2:-2:5"], "x: got .* the lower first"),
        (
            "map",
            [*GRID, "--bundle", "thesis", "--estimate"],
            "--bundle: got thesis; a dimensionless case has no gears",
        ),
        (
            "map",
            [*GRID, "--state", "hot", "--estimate"],
            "--state: got hot; a dimensionless case has no gears",
        ),
        ("map", [*GRID, "--estimate", "--json"], "--json: got beside --estimate"),
    ],
)
def test_wrong_words_are_one_line(cases, tmp_path, name, words, message):
    with pytest.raises(InputError, match=message) as caught:
        call(name, cases / "table-4.2.toml", *words, "-o", tmp_path / "x")
    assert "\n" not in str(caught.value)


def test_numbers_beside_a_gear_case_are_refused(cases, tmp_path):
    words = [cases / "rig.toml", "--over", "rpm=4200:4400:2", "-o", tmp_path / "x"]
    with pytest.raises(InputError, match="damping_ratio: got a number beside a gear case"):
        call("bifurcation", *words, "--but", "zeta=0.1")


def test_a_run_up_over_the_turn_writes_its_lines_by_name(cases, tmp_path):
    path, lines = tmp_path / "points.csv", tmp_path / "points_lines.csv"
    call("runup", cases / "rig.toml", "--turn", "--rpm", "300:400:2", "--csv", path,
         "--set", "gears.pinion.eccentricity={amount='10 um'}", "-o", tmp_path / "up")  # fmt: skip
    rows = pd.read_csv(lines)
    # states, directions, speeds and orders 1/25 to 10
    assert len(rows) == 2 * 2 * 2 * 250
    largest = rows.loc[rows["dte_line [µm]"].idxmax()]
    assert largest["line"] == "pinion"
    assert largest["order [–]"] == 1 / 25
    assert largest["dte_line [µm]"] == pytest.approx(10.0, rel=1e-3)
    assert len(path.read_text().splitlines()) == 1 + 2 * 2 * 2


def test_a_map_with_borders(cases, tmp_path):
    """Stored with the map, drawn by name; another start or base set may have none."""
    call(
        "map", cases / "table-4.2.toml", "--over", "w=0.4:0.6:2", "--over", "F_h=0.02:0.09:2",
        "--but", "eps=0", "--but", "F_m=0.1", "--but", "zeta=0.2", "--borders",
        "-o", tmp_path / "borders",
    )  # fmt: skip
    result = open_results(tmp_path / "borders")
    assert result.data["border_contact"].values.tolist() == [0]
    assert contact_name(0) in "\n".join(page_of(result).lines())
