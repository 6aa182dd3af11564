"""From a case to stored results: the whole chain, its statuses and what it says."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from coded import coded
from thermogear import InputError, run
from thermogear.base.vocabulary import FLAGS, STATUS
from thermogear.case.case import gear_case, load_example
from thermogear.results.files import RESULTS, SUMMARY
from thermogear.results.result import Result
from thermogear.study.notices import jam_notices
from thermogear.study.run_notices import _deviations
from thermogear.thesis.errata import with_errata
from thermogear.views.pages.run import page
from thermogear.views.plots import temperature
from thermogear.views.tables import key_results
from thermogear.views.write import save_results

SMALL = [
    "grid.path_positions=41",
    "grid.mesh_positions=96",
    "simulation.periods=16",
    "simulation.samples=32",
    'operating.speed=["1000 rpm", "3000 rpm"]',
]


@pytest.fixture(scope="module")
def stages() -> list[str]:
    """What the run of ``small`` said it was doing."""
    return []


@pytest.fixture(scope="module")
def small(stages: list[str]) -> Result:
    case = load_example("rig", SMALL)
    return run(case, progress=lambda stage, done, total: stages.append(stage))


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("results") / "out"
    save_results(run(load_example("rig", SMALL)), directory)  # a second run gives the same
    return directory


def test_the_whole_chain_is_there_in_both_bundles_cold_and_hot(small: Result) -> None:
    assert set(small.tree.children) == {
        "path",
        "mesh",
        "profile",
        "drawing",
        "dial",
        "motion",
        "temperature",
        "base_sets",
        "speeds",
    }
    mesh = small["mesh"]
    assert list(mesh["bundle"].values) == ["consistent", "thesis"]
    assert list(mesh["state"].values) == ["undeformed", "hot"]
    assert np.all(mesh["status"].values == STATUS.index("ok"))
    assert set(small["motion"]["label"].values.ravel()) <= {"period-1", "undecided"}


def test_every_stored_variable_has_units_and_words(small: Result) -> None:
    texts = {"label", "label_reason", "row", "parameter", "expected", "value", "value_unit"}
    for node in small.tree.subtree:
        for name, values in node.data_vars.items():
            if name in texts or name in FLAGS:
                continue
            assert values.attrs.get("units"), f"{node.path}/{name}"
            assert values.attrs.get("long_name"), f"{node.path}/{name}"


def test_dimensionless_numbers_close_with_the_stored_si_values(small: Result) -> None:
    mesh = small["mesh"]
    np.testing.assert_allclose(
        mesh["frequency_ratio"].values,
        (mesh["mesh_frequency"] / mesh["natural_frequency"]).values,
        rtol=1e-12,
    )
    # F_h = (e_a/b) omega_h^2 with e_a = 5 um and b = 125 um
    np.testing.assert_allclose(
        mesh["force_amplitude"].values, 0.04 * mesh["frequency_ratio"].values ** 2, rtol=1e-12
    )
    mean_deflection = mesh["mean_force"] * mesh["cold_half_backlash"]
    np.testing.assert_allclose(
        (mean_deflection * mesh["mean_stiffness"]).values, mesh["normal_force"].values, rtol=1e-12
    )
    assert np.all(mesh["thermal_stiffness_ratio"].sel(state="undeformed").values == 0.0)


def test_steady_motion_carries_the_load(small: Result) -> None:
    # without contact loss <k f> = F_n, so the mean deflection is close to F_n/k_m
    motion, mesh = small["motion"], small["mesh"]
    x = motion["displacement"].mean("sample") - mesh["half_backlash"]
    ratio = (x * mesh["mean_stiffness"] / mesh["normal_force"]).values
    assert np.all((ratio > 0.95) & (ratio < 1.1))


def test_results_are_read_back_as_they_were(written: Path, small: Result) -> None:
    stored = xr.open_datatree(written / RESULTS, engine="h5netcdf")
    for node in small.tree.subtree:
        for name, values in node.data_vars.items():
            other = stored[node.path][str(name)]
            none = values.attrs.get("missing_value", np.nan)  # others read a missing number
            wanted = values.where(values != none) if none == none else values
            np.testing.assert_array_equal(wanted.values, other.values)
            assert other.attrs.get("units") == values.attrs.get("units")
    told = json.loads((written / SUMMARY).read_text(encoding="utf-8"))
    fresh = page(small).figures
    assert told["operating"] == json.loads(json.dumps(fresh["operating"]))
    stored.close()


def test_a_second_run_replaces_our_own_results_and_refuses_foreign_files(
    written: Path, tmp_path: Path
) -> None:
    case = load_example("section-4.1")
    save_results(run(case), written)
    assert json.loads((written / SUMMARY).read_text(encoding="utf-8"))["kind"] == "dimensionless"
    (tmp_path / "thesis.doc").write_text("mine", encoding="utf-8")
    with pytest.raises(InputError, match="not results of thermogear; name a new or an empty"):
        save_results(run(case), tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["thesis.doc"]


def test_jammed_points_are_a_status_and_the_rest_goes_on() -> None:
    tight = [*SMALL, 'backlash.value="0.06 mm"', 'draw.pictures=["path","motion","temperature"]']
    tree = run(load_example("rig", tight))
    hot = tree["mesh"].sel(state="hot", bundle="consistent")
    assert np.all(hot["status"].values == STATUS.index("jammed"))
    motion = tree["motion"].sel(bundle="consistent")
    assert np.all(motion["label"].sel(state="hot").values == "jammed")
    assert np.all(motion["label"].sel(state="undeformed").values == "period-1")
    assert np.all(np.isnan(motion["displacement"].sel(state="hot").values))
    row = tree["temperature"].sel(bundle="consistent")
    jam = float(hot["proportional_jam_temperature"].min())
    codes = coded(str(tree.attrs["notices"]))
    both = {"about": "consistent", "jammed": 2, "points": 2}
    assert both in codes["jammed_hot"]
    (told,) = (data for data in codes["jam_in_proportion"] if data["about"] == "consistent")
    assert told["temperature"] == jam
    beyond = row["gear_temperature"].values > jam
    assert 0 < beyond.sum() < beyond.size
    assert np.all((row["label"].values == "jammed") == beyond[:, None])


def test_a_pair_that_is_jammed_everywhere_still_gives_a_tree() -> None:
    changes = [
        *SMALL,
        'backlash.value="0.02 mm"',
        'model.bundle="consistent"',
        'temperatures.reference="20 degC"',
        'draw.pictures=["path","temperature"]',
    ]
    tree = run(load_example("rig", changes))
    assert np.all(tree["temperature"]["label"].values == "jammed")


def test_table_4_2_and_section_4_1_as_their_files_expect() -> None:
    for name in ("table-4.2", "section-4.1"):
        points = run(load_example(name))["points"]
        for label, expected in zip(points["label"].values, points["expected"].values, strict=True):
            assert str(label) in str(expected).split(" or ")
        assert "quasi" not in " ".join(points["label"].values)
        if name == "section-4.1":
            # the thesis's direction of heat: first row, 125 C and 140 C
            first = points["row"].values == points["row"].values[0]
            half = dict(
                zip(
                    points["value"].values[first] - 273.15,
                    points["half_order_amplitude"].values[first],
                    strict=True,
                )
            )
            assert half[125.0] == pytest.approx(0.0044, abs=5e-5)
            assert half[140.0] == pytest.approx(0.0088, abs=5e-5)


def test_notices_name_the_regime(small: Result) -> None:
    codes = coded(small.notices)
    assert {"two_regimes", "stiffness_is_textbook_sum"} <= set(codes)
    (film,) = codes["film_beyond_oil"]
    assert (film["about"], film["hot"]) == ("consistent", False)
    assert film["range"] == [pytest.approx([253.15, 423.15])]
    assert film["temperatures"] == pytest.approx([433.15])


def test_a_law_outside_its_range_says_so() -> None:
    changes = ('model.bundle="consistent"', 'gears.pinion.roughness="1.7 um"')
    quiet = ("temperatures.row=[]", "draw.base_sets=[]", 'model.friction="xu-kahraman"')
    case = load_example("rig", [*SMALL, *changes, *quiet])
    codes = coded(run(case).notices)
    (outside,) = codes["friction_law_outside"]
    assert (outside["law"], outside["share"]) == ("xu-kahraman", 1.0)
    (band,) = codes["friction_laws_left_out"]
    assert "xu-kahraman" in band["laws"]


def test_errata_carry_both_values_of_the_flash_temperature(small: Result) -> None:
    told = with_errata(small, load_example("rig", SMALL))
    rows = {row["number"]: row for row in told.rows("errata")}
    assert sorted(rows) == list(range(1, 21))
    assert rows[1]["value_repaired"] > 1e3 * rows[1]["value_as_printed"] > 0.0
    assert rows[12]["value_repaired"] == pytest.approx(21.5, abs=0.005)
    assert rows[16]["value_as_printed"] == pytest.approx(7.4, abs=0.05)


def test_progress_names_its_stages(small: Result, stages: list[str]) -> None:
    named = {stage.partition(" ")[0] for stage in stages}
    assert {"mesh", "motion"} <= named
    assert any(stage.endswith("temperature") for stage in stages)


def test_both_jams_are_those_of_the_points() -> None:
    """In proportion the jam nearest to the drawing counts, on whichever side it lies."""

    def jams(alone: list[float], together: list[float]) -> dict[str, float]:
        data = xr.Dataset(
            {
                "jam_temperature": ("operating", np.array(alone)),
                "proportional_jam_temperature": ("operating", np.array(together)),
            }
        )
        codes = coded(jam_notices(data, 293.15))
        return {code: told[0].get("temperature", nan) for code, told in codes.items()}

    nan = float("nan")
    assert jams([678.0, 554.0], [nan, 231.0]) == {
        "jam_of_gears_alone": 554.0,
        "jam_in_proportion": 231.0,
    }
    assert jams([473.0, 473.0], [403.0, 453.0])["jam_in_proportion"] == 403.0
    assert set(jams([473.0, 473.0], [nan, nan])) == {"jam_of_gears_alone", "no_jam_in_proportion"}
    assert jams([nan], [nan]) == {}


def test_the_figures_of_a_series_stand_beside_the_part_that_is_run(small: Result) -> None:
    """At each operating point that it answers, and beside the first bundle alone."""
    mesh = small.groups["mesh"]
    speed, torque = (mesh[name].values for name in ("pinion_speed", "pinion_torque"))
    factor = np.linspace(1.2, 2.0, 16)
    series = xr.Dataset(
        {
            "dynamic_factor": (("operating", "quantile", "damping", "speed"),
                               np.arange(12.0).reshape(1, 3, 1, 4)),
            "own_dynamic_factor": (("operating", "damping", "part"), factor[None, None]),
            "contact_loss_onset": (("operating", "damping", "part"),
                                   np.where(factor > 1.8, speed[1], np.nan)[None, None]),
            "own_speed": ("operating", speed[1:]),
            "pinion_torque": ("operating", torque[1:]),
            "pinion_speed": ("speed", speed[1] * np.array([0.2, 0.7, 1.0, 1.2])),
        }
    )  # fmt: skip
    table = key_results(mesh, None, series)
    cells = [list(row[-2:]) for row in table.rows]
    counted = f"{np.count_nonzero(factor > 1.8)} of 16"
    assert cells == [["–", "–"], ["6.0 (2.0 to 10)", counted], ["–", "–"], ["–", "–"]]
    assert len(table.head) == len(key_results(mesh, None).head) + 2


def test_a_run_says_which_part_of_a_series_it_is_of() -> None:
    for changes, drawing in (({}, None), ({"flanks.teeth": "drawn"}, 0)):
        case = gear_case(load_example("fzg-a", {"flanks.parts": "64", **changes}))
        (told,) = coded(list(_deviations(case)))["one_part_run"]
        assert (told["parts"], told["seed"], told.get("drawing")) == (64, 1, drawing)
    alone = gear_case(load_example("fzg-a", {"flanks.parts": "1"}))
    assert "one_part_run" not in coded(list(_deviations(alone)))


def test_every_temperature_has_its_four_views(small: Result) -> None:
    row = small.groups["temperature"]
    history, phase, section, lines = temperature.views(row, bundle=0, operating=0).panels
    for place, panels in enumerate(zip(history, phase, section, lines, strict=True)):
        one = row.isel(bundle=0, operating=0, gear_temperature=place)
        x = 1e6 * (one["displacement"].values - float(one["half_backlash"]))
        drawn = [panel.marks[0] for panel in panels]
        assert drawn[0].y[0] == pytest.approx(x[0], rel=1e-12)
        assert drawn[0].x[0] == 0.0
        assert drawn[1].x[0] == pytest.approx(x[0], rel=1e-12)
        dots = panels[2].marks[-1]
        first = 1e6 * float(one["section_displacement"].values[0] - one["half_backlash"])
        assert np.any(np.isclose(dots.x, first, rtol=1e-3))
        kept = one["order"].values > 0.0
        greatest = 1e6 * float(one["line_amplitude"].values[kept].max())
        stems = next(mark for mark in panels[3].marks if type(mark).__name__ == "Stems")
        assert max(stems.y) == pytest.approx(greatest, rel=1e-12)
