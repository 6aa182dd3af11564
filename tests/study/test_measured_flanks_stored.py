"""Measured flanks in the results: stored whole, told, and drawn from what is stored."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import own_chart
from coded import coded
from own_chart import END, START, chart, diameter
from said import numbers
from thermogear.case.case import GearCase, load_case
from thermogear.results.result import Result
from thermogear.study.measured_flanks import measured_flanks, measured_notices
from thermogear.study.run import run
from thermogear.study.versus import stored
from thermogear.views.page import Gallery, Pictures, Table
from thermogear.views.pages.background import case_file
from thermogear.views.pages.gear_sections import measured

RHO = np.linspace(START, END, 181)
SHARE = (RHO - START) / (END - START)

FEW = ["draw.pictures=[]"]


def charted(folder: Path, *lines: str) -> GearCase:
    rng = np.random.default_rng(2)
    columns = {
        f"tooth {tooth} {side} [um]": 5.0 * SHARE + 12.0 + 0.2 * rng.standard_normal(RHO.size)
        for tooth in (1, 8, 15)
        for side in ("left", "right")
    }
    lines = lines or ("drive: right",)
    pitch = "tooth,single pitch left [um]\n" + "".join(
        f"{k + 1},{1.5 * (-1) ** k}\n" for k in range(20)
    )
    return own_chart.case(folder, chart(columns, diameter(RHO), "diameter [mm]", *lines) + pitch)


def test_a_run_keeps_the_traces_and_computes_the_same_without_the_files(tmp_path: Path) -> None:
    case = charted(tmp_path)
    first = run(load_case(tmp_path / "mine.toml", FEW))
    (tmp_path / "pinion.csv").unlink()
    file = first.write(tmp_path / "out")
    stored = Result.read(file)
    again = load_case(stored.text("case"), dict(stored.values("overrides")))
    assert again.text == case.text
    assert isinstance(again, GearCase)
    one, other = (c.cycle(c.operating, c.models[0]) for c in (case, again))
    for name, values in one.variables.items():
        np.testing.assert_array_equal(values.values, other[name].values, err_msg=str(name))
    data = stored.groups["flanks/pinion"]
    np.testing.assert_array_equal(data["trace_deviation"].values, case.charts[0].traces.added)
    assert data["trace_name"].values[0].split() == ["tooth", "1", "left", "(back)"]
    assert list(data["iso_class"].values) == [5] * 6 or set(data["iso_class"].values) <= {4, 5, 6}
    assert all("units" in v.attrs for v in data.variables.values() if v.dtype.kind in "fi")


def test_what_acts_is_zero_at_the_pitch_circle_whatever_the_level_of_the_chart(
    tmp_path: Path,
) -> None:
    case = charted(tmp_path)
    data = measured_flanks(case)["flanks/pinion"]
    acting = data["drive_acting"].values
    at = np.interp(data.attrs["pitch_diameter"], data["diameter"].values, acting)
    assert at == pytest.approx(0.0, abs=2e-9)
    assert np.nanmean(data["drive_fit"].values) == pytest.approx(14.5e-6, abs=0.2e-6)


def test_the_notices_tell_what_was_decided(tmp_path: Path) -> None:
    told = coded(measured_notices(charted(tmp_path)))
    assert [(one["flank"], one["traces"]) for one in told["flank_as_measured"]] == [
        ("drive", 3),
        ("back", 3),
    ]
    assert told["flanks_evaluated"][0]["files"] == ["pinion.csv"]
    (pitch,) = told["pitch_as_measured"]
    assert pitch["deviations"].split() == ["single", "pitch", "left"]
    assert "sign_not_stated" in told
    assert "pitch_not_used" not in told
    assert told["flanks_evaluated"][0]["stated"] is None
    lines = ("drive: right", "sign: material outside is positive", "evaluate: 58..65 mm")
    told = coded(measured_notices(charted(tmp_path, *lines)))
    assert told["flanks_evaluated"][0]["diameters"] == [pytest.approx([58e-3, 65e-3])]
    assert "sign_not_stated" not in told
    lines = ("drive: right", "evaluate: 56.5..65 mm")
    told = coded(measured_notices(charted(tmp_path, *lines)))
    low, high = told["flanks_evaluated"][0]["diameters"][0]
    assert 56.5e-3 < low < high == pytest.approx(65e-3)  # the trace begins later
    assert told["flanks_evaluated"][0]["stated"] == [pytest.approx([56.5e-3, 65e-3])]
    only = own_chart.case(tmp_path, chart({"tooth 1 left [um]": SHARE}, diameter(RHO)))
    assert [one["flank"] for one in coded(measured_notices(only))["flank_not_measured"]] == ["back"]


def test_the_section_is_drawn_from_what_is_stored_alone(tmp_path: Path) -> None:
    case = charted(tmp_path)
    result = Result.of("gear", "own", measured_flanks(case), case=case.text)
    section = measured(result, Pictures())
    assert section is not None
    gallery, table = section.blocks
    assert isinstance(gallery, Gallery)
    assert isinstance(table, Table)
    assert len(table.rows) == 6
    picture = gallery.pictures[0].picture.to_json()
    panels = [panel for row in picture["panels"] for panel in row]
    assert [panel["title"].split()[0] for panel in panels] == ["drive", "back"]
    for panel in panels:
        assert (panel["x"]["unit"], panel["y"]["unit"]) == ("mm", "µm")
        labels = [mark.get("label") for mark in panel["marks"]]
        assert {"traces", "fit", "acts", "evaluated"} <= {str(one).split(":")[0] for one in labels}
    assert measured(Result.of("gear", "own", {}), Pictures()) is None


def test_a_page_shows_the_case_and_not_every_row_of_its_charts(tmp_path: Path) -> None:
    case = charted(tmp_path)
    (code,) = case_file(Result.of("gear", "own", {}, **case.provenance)).blocks
    words = code.words  # type: ignore[union-attr]
    assert words.count("\n") < own_chart.CASE.count("\n") + 10
    assert re.search(r"# pinion\.csv: 204 \w+, sha256 [0-9a-f]", words)


def test_a_relief_beside_a_chart_is_told(tmp_path: Path) -> None:
    assert "relief_on_traces" not in coded(measured_notices(charted(tmp_path)))
    relief = 'gears.pinion.tip_relief={amount="5 um", length="2 mm"}'
    case = load_case(tmp_path / "mine.toml", [relief])
    assert isinstance(case, GearCase)
    assert "relief_on_traces" in coded(measured_notices(case))


def test_charts_side_by_side_differ_by_their_digest(tmp_path: Path) -> None:
    tables = []
    for lines in (("drive: right",), ("drive: left",)):
        case = charted(tmp_path, *lines)
        tables.append(stored(Result.of("gear", "own", {}, **case.provenance)).table())
    one, other = tables
    (key,) = (key for key in one if one[key] != other[key])
    assert "pinion.csv" in str(key)
    assert numbers(str(one[key]))[0] == 204.0
