"""The rows of a form: every field of a gear case once, and what is given written back."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests import own_chart
from tests.own_chart import END, START, chart, diameter
from tests.own_pair import OWN_PAIR
from tests.own_trains import OWN, TRAIN, random_train

from thermogear import InputError, load_case
from thermogear.base.toml import overridden, written
from thermogear.case.case import GearCase, gear_case
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.case.form import Entry, form

GEARS = [name for name in EXAMPLES if name not in ("table-4.2", "section-4.1")]
BRONZE = """
[materials.bronze]
youngs_modulus = "110 GPa"
poisson_ratio = 0.34
density = "8800 kg/m^3"
thermal_conductivity = "60 W/(m K)"
specific_heat = "380 J/(kg K)"
thermal_expansion = "18e-6 1/K"
"""
LAW = """
[model.friction]
law = "lambda-blend"
boundary = 0.08
[model.friction.film]
smooth = true
"""
RELIEF = '\n[gears.pinion.tip_relief]\namount = "20 um"\nlength = "3 mm"\n'
BRONZED = "a material, a law, a relief"
EMPTY = "\n[sensors]\n[gearbox]\n[gearbox.measured]\n"
CASES = {
    **{name: example_text(name) for name in GEARS},
    "own pair": OWN_PAIR,
    BRONZED: OWN_PAIR + BRONZE + LAW + RELIEF,
    "a name with a blank": OWN_PAIR + BRONZE.replace("bronze", '"my bronze"'),
    "empty tables": OWN_PAIR + EMPTY,
    "train": TRAIN,
    "own train": OWN,
    "random train": random_train(np.random.default_rng(11)),
}


def load(text: str, changes: Mapping[str, str] | None = None) -> GearCase:
    return gear_case(load_case(text, changes or {}))


def entry(text: str, path: str) -> Entry:
    [found] = [one for one in form(load(text).data) if one.path == path]
    return found


def filled(data: Mapping[str, Any]) -> dict[str, Any]:
    """The tables that hold something, less those that no form has."""
    return {
        key: filled(one) if isinstance(one, dict) else one
        for key, one in data.items()
        if key not in ("ours", "files") and not (isinstance(one, dict) and not filled(one))
    }


@pytest.mark.parametrize("text", CASES.values(), ids=CASES)
def test_what_is_given_written_back_is_the_same_case(text: str) -> None:
    case = load(text)
    given = {one.path: one.given for one in form(case.data) if one.given}
    again = load(text, given)
    assert again.data == case.data
    assert again.file == case.file
    assert again.assumptions == case.assumptions
    # and alone, without the text under it
    assert overridden({}, tuple(given.items())) == filled(tomllib.loads(text))


@pytest.mark.parametrize("text", [OWN_PAIR, TRAIN, OWN_PAIR + BRONZE + LAW])
def test_the_form_of_a_case_written_anew_is_the_same(text: str) -> None:
    data = load(text).data
    assert form(load(written(data)).data) == form(data)


def test_charts_stay_in_the_text(tmp_path: Path) -> None:
    rho = np.linspace(START, END, 40)
    case = own_chart.case(tmp_path, chart({"1 drive [um]": 0.0 * rho}, diameter(rho)))
    given = {one.path: one.given for one in form(case.data) if one.given}
    assert given["flanks.pinion"] == "pinion.csv"
    assert not [path for path in given if path.startswith("files")]
    assert load(case.text, given).data == case.data


def test_every_field_has_one_row_and_json_holds_it() -> None:
    rows = form(load(OWN_PAIR + LAW).data)
    paths = [one.path for one in rows]
    assert len(paths) == len(set(paths)) > 200
    assert form({})[0].path == "title"
    for one in rows:
        assert json.loads(json.dumps(one.row, allow_nan=False)) == one.row
        assert one.title
        assert one.group
        assert "_" not in one.group


def test_a_row_says_what_may_stand_there() -> None:
    assert entry(OWN_PAIR, "gears.pinion.tip_diameter") == Entry(
        path="gears.pinion.tip_diameter",
        title="tip diameter",
        group="gears, pinion",
        kind="length",
        unit="mm",
        minimum=0.1,
        maximum=20000.0,
        step=10.0,
        left_out="pitch diameter + 2 (addendum + profile shift) modules. Decides the contact ratio",
        about="0.1..20000 mm",
    )
    speed = entry(OWN_PAIR, "operating.speed")
    assert (speed.given, speed.unit, speed.several) == ("1500 rpm", "rpm", True)
    assert entry(OWN_PAIR, "backlash.extent").choices == ("total", "half")
    assert entry(OWN_PAIR, "title").given == "Pair 19:47"
    assert entry(OWN_PAIR, "title").group == "case"
    harmonics = entry(OWN_PAIR, "transmission_error.harmonics")
    assert harmonics.kind == "tables"
    assert harmonics.given == '[{ order = 1, amplitude = "3 um" }]'


@pytest.mark.parametrize(
    ("text", "path", "words"),
    [
        (OWN_PAIR, "gears.pinion.teeth", "needed"),
        (OWN_PAIR, "title", "teeth and module"),
        (OWN_PAIR, "gears.pinion.tip_relief.amount", "no tip relief"),
        (OWN_PAIR + RELIEF, "gears.pinion.tip_relief.amount", "needed"),
        (OWN_PAIR, "backlash.tolerances.centre_distance", "with its table"),
        (OWN_PAIR, "gearbox.readings.oil.kind", "no thermometer"),
        (OWN_PAIR, "shafts", "the gear pair alone"),
        (OWN_PAIR, "oil.viscosity_40", "from the named set"),
        (OWN_PAIR, "materials", "no materials of the user's own"),
    ],
)
def test_a_row_says_what_holds_without_it(text: str, path: str, words: str) -> None:
    assert entry(text, path).left_out == words


def test_what_is_needed_is_refused_without_it_and_nothing_else_given_is_needed() -> None:
    """Each given field left out by itself: only those told as needed are missed as needed."""
    case = load(OWN_PAIR)
    for one in form(case.data):
        if not one.given:
            continue
        try:
            load(OWN_PAIR, {one.path: ""})
            missed = False
        except InputError as error:
            missed = error.field == one.path and error.why == "needed"
        assert missed == (one.left_out == "needed"), one.path


def test_friction_is_a_name_or_a_table() -> None:
    paths = {one.path for one in form(load(OWN_PAIR).data)}
    assert {"model.friction", "model.friction.boundary"} <= paths
    assert "model.friction.law" not in paths
    named = load(OWN_PAIR + 'friction = "schlenk"\n')
    assert {one.path: one.given for one in form(named.data)}["model.friction"] == "schlenk"
    table = {one.path: one.given for one in form(load(OWN_PAIR + LAW).data)}
    assert table["model.friction.law"] == "lambda-blend"
    assert table["model.friction.film.smooth"] == "true"
    assert "model.friction" not in table


def test_tables_with_names_of_ones_own() -> None:
    paths = {one.path: one.given for one in form(load(OWN_PAIR + BRONZE).data)}
    assert paths["materials.bronze.poisson_ratio"] == "0.34"
    assert "materials" not in paths
    text = entry(CASES["a name with a blank"], "materials").given
    bronze = load(CASES[BRONZED]).data["materials"]["bronze"]
    [held] = tomllib.loads(f"m = {text}")["m"].values()
    assert held == bronze


def test_a_case_without_gears_has_no_such_form() -> None:
    with pytest.raises(InputError, match=r"case: got kind = 'dimensionless'; allowed kind"):
        form(tomllib.loads(example_text("table-4.2")))
