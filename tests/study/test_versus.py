"""Cases side by side: matched points, fields that differ, and what one case has alone."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import xarray as xr
from scipy.stats import binomtest
from scipy.stats.mstats import hdquantiles

from coded import coded
from said import numbers
from thermogear import InputError, run
from thermogear.base.vocabulary import STATUS
from thermogear.case.case import load_example
from thermogear.study.versus import (
    MOST_CASES,
    OWN,
    Stored,
    flat,
    of_series,
    stored,
    unique_titles,
    versus,
)
from thermogear.views.pages.versus import page

SMALL = [
    "grid.path_positions=41",
    "grid.mesh_positions=96",
    "simulation.periods=16",
    "simulation.samples=32",
    'draw.pictures=["path","motion"]',
    'operating.speed=["1000 rpm", "3000 rpm"]',
]
OTHER = [
    *SMALL,
    "grid.path_positions=31",
    'operating.speed=["3000 rpm", "4000 rpm"]',
    'gears.pinion.roughness="0.8 um"',
]


def made(overrides: list[str], name: str) -> Stored:
    return stored(run(load_example("rig", overrides)), name)


@pytest.fixture(scope="module")
def first() -> Stored:
    return made(SMALL, "first")


@pytest.fixture(scope="module")
def second() -> Stored:
    return made(OTHER, "second")


def test_points_are_matched_by_speed_and_figures_are_those_of_each_run(
    first: Stored, second: Stored
) -> None:
    data = versus([first, second])
    np.testing.assert_allclose(
        data["pinion_speed"].values * 30.0 / np.pi, [1000.0, 3000.0, 4000.0], rtol=1e-8
    )
    assert data["present"].isel(bundle=0).values.tolist() == [[1, 1, 0], [0, 1, 1]]
    for name in ("half_backlash", "mean_stiffness", "natural_frequency", "frequency_ratio"):
        one, other = first.groups["mesh"][name], second.groups["mesh"][name]
        joined = data[name].transpose("case", *one.dims)
        np.testing.assert_array_equal(joined[0].isel(operating=[0, 1]), one)
        np.testing.assert_array_equal(joined[1].isel(operating=[1, 2]), other)
        assert np.isnan(joined[0].isel(operating=2)).all()
    swing = data["dte_peak_to_peak"].sel(case=data["case"][1]).isel(operating=[1, 2])
    np.testing.assert_array_equal(swing, second.groups["motion"]["dte_peak_to_peak"])
    assert np.all(data["label"].isel(case=0, operating=2).values == "")
    assert np.all(data["status"].isel(case=0, operating=2).values == len(STATUS))
    assert data["status"].attrs["flag_meanings"].split()[len(STATUS)] == "absent"


def test_curves_keep_their_own_positions(first: Stored, second: Stored) -> None:
    data = versus([first, second])
    place = {"bundle": 1, "state": 1}
    for c, (case, o) in enumerate(((first, 1), (second, 0))):
        path = case.groups["path"]
        size = path.sizes["path_position"]
        np.testing.assert_array_equal(data["path_position"][c, :size], path["path_position"])
        friction = data["friction_coefficient"].isel(case=c, operating=1, **place)
        np.testing.assert_array_equal(
            friction[:size], path["friction_coefficient"].isel(operating=o, **place)
        )
        assert np.isnan(friction[size:]).all()
        greatest = data["greatest_flash_temperature"].isel(case=c, operating=1, **place)
        assert float(greatest) == float(path["flash_temperature"].isel(operating=o, **place).max())
    assert data["order"].max() <= 8.5


def test_fields_that_differ_are_named_with_both_values(first: Stored, second: Stored) -> None:
    data = versus([first, second])
    rows = {r["field"]: r["values"] for r in json.loads(data.attrs["differences"])}
    assert set(rows) == {"grid.path_positions", "operating.speed", "gears.pinion.roughness"}
    more = [*json.loads(first.texts["overrides"]), ["ours.gears", "a reason"]]
    ours = replace(first, texts={**first.texts, "overrides": json.dumps(more)})
    told = json.loads(versus([ours, second]).attrs["differences"])
    assert {row["field"] for row in told} == set(rows)
    assert rows["grid.path_positions"] == [41, 31]
    assert rows["operating.speed"] == [["1000 rpm", "3000 rpm"], ["3000 rpm", "4000 rpm"]]
    assert rows["gears.pinion.roughness"][1] == "0.8 um"
    alone = coded(str(data.attrs["notices"]))["operating_in_one_case"]
    assert [row["case"] for row in alone] == [str(title) for title in data["case"].values]
    for row, speed in zip(alone, ("1000 rpm", "4000 rpm"), strict=True):
        assert all(name.startswith(speed) for name in row["names"])


def test_a_case_against_itself_differs_in_nothing(first: Stored) -> None:
    found = versus([first, replace(first, name="again")])
    assert found.rows("differences") == []
    assert found.notices == ()
    data = found.data
    one, other = data.isel(case=0, drop=True), data.isel(case=1, drop=True)
    assert one.identical(other)
    told = page(found).figures
    assert len(told["figures"]) == 2 * 2 * 2 * 2
    json.dumps(told, allow_nan=False)


def test_the_order_of_the_cases_changes_nothing_but_the_order(
    first: Stored, second: Stored
) -> None:
    ahead, back = versus([first, second]).data, versus([second, first]).data
    for name in ahead.data_vars:
        there = ahead[name].isel(case=[1, 0]).values
        np.testing.assert_array_equal(there, back[name].values, err_msg=str(name))


def test_lone_bundles_of_different_names_stand_beside_each_other(first: Stored) -> None:
    parts = [
        replace(
            first,
            name=name,
            groups={
                key: data.sel(bundle=[name]) if "bundle" in data.dims else data
                for key, data in first.groups.items()
            },
        )
        for name in ("consistent", "thesis")
    ]
    data = versus(parts)
    assert list(data["bundle"].values) == [OWN]
    np.testing.assert_array_equal(
        data["mean_stiffness"].isel(bundle=0).values,
        first.groups["mesh"]["mean_stiffness"].transpose("bundle", "state", "operating").values,
    )


def test_numbers_and_kinds_that_cannot_stand_together_are_refused(first: Stored) -> None:
    with pytest.raises(InputError, match=r"versus: got 1 case; allowed 2\.\.6 cases"):
        versus([first])
    with pytest.raises(InputError, match=r"got 7 cases; allowed 2\.\.6 cases; more colours"):
        versus([first] * (MOST_CASES + 1))
    other = Stored("row", {"kind": "dimensionless", "case": "a = 1"}, {})
    with pytest.raises(InputError, match=r"got row \(dimensionless\); allowed cases of gear pairs"):
        versus([first, other])
    with pytest.raises(InputError, match="the group mesh is missing; run the case anew"):
        versus([first, replace(first, groups={})])
    with pytest.raises(InputError, match="attribute assumptions is damaged"):
        versus([first, replace(first, texts={**first.texts, "assumptions": "{"})])


def test_flat_names_and_unique_titles() -> None:
    table = {"a": {"b": 1, "c": [1, 2]}, "row": [{"x": 1}, {"x": 2}]}
    assert flat(table) == {"a.b": 1, "a.c": [1, 2], "row[0].x": 1, "row[1].x": 2}
    cases = [
        Stored(n, {"title": t}, {}) for n, t in (("p", "T"), ("q", "T"), ("q", "T"), ("r", ""))
    ]
    assert unique_titles(cases) == ["T [p]", "T [q]", "T [q] (2)", "r"]


def test_the_command_line_of_a_stored_case_counts_as_its_own() -> None:
    text = load_example("rig").text
    one = Stored("x", {"case": text, "overrides": '[["gears.pinion.teeth", "30"]]'}, {})
    assert one.table()["gears.pinion.teeth"] == 30


def in_series(name: str, factor: np.ndarray, *, seed: int = 1) -> Stored:
    """A case of one operating point whose parts have a dynamic factor; some lose contact."""
    count = factor.size
    onset = np.where(np.arange(count) < 5, 100.0, np.where(np.arange(count) < 9, 400.0, np.nan))
    along, each = ("operating", "part"), ("operating", "damping", "part")
    data = xr.Dataset(
        {
            "own_dynamic_factor": (each, np.stack([factor, 9.0 * factor])[None]),
            "contact_loss_onset": (each, np.stack([onset, np.zeros(count)])[None]),
            "turn_error": (along, 1e-5 * factor[None]),
            "mesh_error": (along, 1e-6 * factor[None]),
            "own_speed": ("operating", [314.159265359]),
            "pinion_torque": ("operating", [80.0]),
        },
        attrs={"seed": seed},
    )
    return Stored(name, {}, {"series": data})


def test_series_are_compared_part_by_part_by_the_binomial_interval() -> None:
    rng = np.random.default_rng(11)
    parts = rng.uniform(1.2, 2.0, 64)
    other = parts * np.where(rng.random(64) < 0.8, 0.95, 1.05)
    other[:3] = parts[:3]
    cases = [in_series("a", parts), in_series("b", other), in_series("c", other, seed=2)]
    first, second, third = of_series([*cases, Stored("d", {}, {})], ["A", "B", "C", "D"])
    assert (first["point"], first["parts"], first["parting"]) == ("3000 rpm, 80 N m", 64, 5)
    for name, share in (("low", 0.05), ("middle", 0.5), ("high", 0.95)):
        assert first[f"dynamic_factor_{name}"] == pytest.approx(hdquantiles(parts, [share])[0])
    assert first["mesh_error_bad"] == pytest.approx(1e-6 * first["dynamic_factor_bad"])
    better = int((other < parts).sum())
    assert (second["dynamic_factor_pairs"], second["dynamic_factor_better"]) == (61, better)
    known = binomtest(better, 61).proportion_ci(0.95, "exact")
    ends = [second[f"dynamic_factor_{end}_share"] for end in ("least", "greatest")]
    assert ends == pytest.approx([known.low, known.high])
    # neither the first nor a series of another seed is compared part by part
    assert "dynamic_factor_pairs" not in first.keys() | third.keys()
    alike = list(of_series(cases[:1] * 2, ["A", "A"]))[1]
    assert (alike["dynamic_factor_pairs"], alike["dynamic_factor_better"]) == (0, 0)


def test_the_page_says_what_decides_between_series(first: Stored) -> None:
    factor = np.linspace(1.2, 2.0, 64)
    signs = np.where(np.arange(64) % 2, 1.0, -1.0)
    cases = [
        in_series(str(k), f) for k, f in enumerate([factor, factor - 0.1, factor + 0.1 * signs])
    ]
    rows = list(of_series(cases, ["A", "B", "C"]))
    found = versus([first, replace(first, name="again")])
    assert found.rows("series") == []
    whole = page(found.with_(series=rows))
    (section,) = [one for one in whole.sections if one.name == "series"]
    cells = [row[3] for row in section.blocks[0].rows]
    assert len({cell.partition(":")[0] for cell in cells}) == 3
    assert [numbers(cell)[:2] for cell in cells[1:]] == [[64.0, 64.0], [32.0, 64.0]]
    assert whole.figures["series"] == rows
