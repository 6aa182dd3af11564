"""Results as pandas frames and CSV: a row for each point, units in the heads, words for codes."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr

import thermogear as tg
from own_pair import OWN_PAIR
from thermogear.base.display import display
from thermogear.base.errors import InputError
from thermogear.base.netcdf import read_tree, write_tree
from thermogear.results.result import Notice, Result
from thermogear.results.tables import csv_text, frames

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")
SCALES = {"µm": 1e6, "rpm": 30.0 / np.pi, "10⁸ N/m": 1e-8, "MPa": 1e-6, "–": 1.0, "K": 1.0}


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> tuple[Result, Path]:
    """Torque x temperature of an own pair; the hottest points jam."""
    place = tmp_path_factory.mktemp("swept") / "store"
    case = tg.load_case(OWN_PAIR)
    axes = {"torque": [10.0, 30.0], "temperature": [330.0, 390.0, 800.0]}
    return tg.sweep(case, axes, store=place), place


def test_a_sweep_becomes_a_row_for_each_point(swept: tuple[Result, Path]) -> None:
    result, place = swept
    frame = result.to_frame()
    assert len(frame) == 6
    assert list(frame.columns[:4]) == [
        "pinion_torque [N m]", "gear_temperature [K]", "status", "label"
    ]  # fmt: skip
    assert set(frame["status"]) == {"ok", "jammed"}
    jammed = frame[frame["status"] == "jammed"]
    assert set(jammed["label"]) == {"jammed"}
    assert jammed["dynamic_factor [1]"].isna().all()
    again = tg.open_results(place).to_frame()
    pd.testing.assert_frame_equal(frame, again)
    every = xr.Dataset.to_dataframe(result.data[["dynamic_factor"]])["dynamic_factor"]
    assert np.array_equal(frame["dynamic_factor [1]"], every, equal_nan=True)


def test_shown_units_are_si_times_a_scale(swept: tuple[Result, Path]) -> None:
    result, _ = swept
    si, shown = result.to_frame(), result.to_frame(units="display")
    assert si.attrs["units"] == "si"
    assert shown.attrs["units"] == "display"
    unit = re.compile(r" \[(.+)\]$")
    for one, other in zip(si.columns, shown.columns, strict=True):
        assert unit.sub("", one) == unit.sub("", other)
        if not (found := unit.search(other)):
            continue
        less = 273.15 if found[1] == "°C" else 0.0
        times = SCALES.get(found[1], 1.0)
        np.testing.assert_allclose(shown[other], times * (si[one] - less), rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize("name", ["greatest_flash", "scuffing_margin", "jam_margin", "residual"])
def test_differences_of_temperature_stay_kelvins(name: str) -> None:
    assert display(name, "K").unit == "K"
    assert display("jam_temperature", "K").unit == "°C"


def test_a_run_has_a_row_for_each_operating_point_with_its_motion() -> None:
    result = tg.run(tg.load_case(OWN_PAIR))
    frame = result.to_frame()
    mesh = result.groups["mesh"]
    assert len(frame) == mesh.sizes["bundle"] * mesh.sizes["state"] * mesh.sizes["operating"]
    for column in ("half_backlash [m]", "contact_loss_share [1]", "status"):
        assert column in frame.columns
    answers = result.to_frame("answers")
    assert list(answers["name"]) == [one.name for one in result.answers]
    assert isinstance(result._repr_html_(), str)
    assert len(repr(result)) < 2000


def test_a_period_that_is_none_is_missing_in_every_file(
    swept: tuple[Result, Path], tmp_path: Path
) -> None:
    """In frames, CSV and netCDF as others read it; we read back what was stored."""
    result, _ = swept
    frame = result.to_frame()
    jammed = frame["status"] == "jammed"
    assert 0 < jammed.sum() < len(frame)
    assert (frame["period [1]"].isna() == jammed).all()
    rows = csv_text(frame).splitlines()
    place = rows[0].split(",").index("period [1]")
    assert {row.split(",")[place] for row in rows[1:]} == {"", "1"}
    made = write_tree(result.tree, tmp_path / "results.nc")
    name = next(group for group in result.tree.subtree if "period" in group.data_vars).path
    with xr.open_datatree(made, engine="h5netcdf") as theirs:
        assert (theirs[name]["period"].isnull() == (theirs[name]["status"] == 1)).all()
    ours = read_tree(made)[name]["period"]
    assert ours.dtype.kind == "i"
    assert (ours == result.tree[name]["period"]).all()
    words = {result.data[f"multiplier_{part}"].attrs["long_name"] for part in ("real", "imag")}
    assert all("chaos" in told for told in words)


def test_a_count_stays_beside_coordinates_that_become_words() -> None:
    runs = xr.Dataset(
        {"period": ("direction", [2, 0], {"missing_value": 0})}, {"direction": [1, -1]}
    )
    (frame,) = frames(runs).values()
    assert frame["direction"].tolist() == ["up", "down"]
    np.testing.assert_array_equal(frame["period"], [2.0, np.nan])


def test_a_code_without_a_word_is_no_other_word() -> None:
    codes = xr.Dataset({"regime": ("point", np.array([0, 1, -1]))})
    codes["regime"].attrs["flag_meanings"] = "boundary mixed"
    (frame,) = frames(codes).values()
    assert list(frame["regime"]) == ["boundary", "mixed", "unknown"]


def test_what_is_not_there_is_refused_in_one_line(swept: tuple[Result, Path]) -> None:
    result, _ = swept
    for wrong in ({"group": "mash"}, {"along": ["torque"]}, {"units": "imperial"}):
        with pytest.raises(InputError) as error:
            result.to_frame(**wrong)  # type: ignore[arg-type]
        assert "\n" not in str(error.value)
    with pytest.raises(InputError):
        Result.of("gear", "empty", {}).to_frame()


def test_no_text_is_a_formula_or_a_tag() -> None:
    frame = pd.DataFrame({"label": ["=1+1", "-x", "plain", "+2", "@a"], "value": [-1.0] * 5})
    assert csv_text(frame).splitlines()[1:] == [
        "'=1+1,-1", "'-x,-1", "plain,-1", "'+2,-1", "'@a,-1"
    ]  # fmt: skip
    shown = Result.of("gear", "<script>x</script>", {}, [Notice("info", "<b>")])._repr_html_()
    assert not re.search(r"<script|<b>(?!&lt;)(?=<)", shown)
    assert "&lt;script&gt;" in shown


def test_sums_of_flags_and_bearings_are_words_and_columns() -> None:
    import xarray as xr

    from thermogear.results.tables import frames, spread

    lost = ("speed", [0, 5, -1], {"flags": "drive back left", "flag_masks": [1, 2, 4]})
    force = (("speed", "bearing"), [[1.0], [2.0], [3.0]], {"units": "N"})
    bearing = ("bearing", [1], {"names": '["left end"]'})
    data = xr.Dataset(
        {"lost": lost, "force": force}, {"speed": [1.0, 2.0, 3.0], "bearing": bearing}
    )
    table = frames(spread(data))[("speed",)]
    assert [one.split() for one in table["lost"]] == [["none"], ["drive", "left"], ["unknown"]]
    assert table["force_left_end [N]"].tolist() == [1.0, 2.0, 3.0]
