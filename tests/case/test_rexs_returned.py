"""Exported files that were changed: each change is named, the file is read like any other."""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from thermogear import InputError, read_rexs
from thermogear.case.case import GearCase, gear_case, load_case, load_example
from thermogear.case.examples import EXAMPLES
from thermogear.case.rexs import exporting
from thermogear.case.rexs.attributes import CASE, LATER, USED
from thermogear.case.rexs.exporting import kept_alone, model_of_case
from thermogear.case.rexs.importing import Imported, imported
from thermogear.case.rexs.model import Attribute, Component, Model
from thermogear.case.rexs.writing import write_rexs

GEARS = [name for name in EXAMPLES if load_example(name).kind == "gear"]
LIKE_ANY = (
    f"{CASE}: the file was changed and is read like any other, oil and materials by their "
    "constants; left out beside them: "
)

pytestmark = pytest.mark.filterwarnings("ignore::thermogear.ValidityWarning")  # hot oil of FZG A

Place = tuple[dict[str, Attribute], str]


@cache
def case_of(name: str, *changes: str) -> GearCase:
    return gear_case(load_example(name, list(changes)))


def exported(name: str, *changes: str, version: str = "1.7") -> Model:
    """The model of a case as it is in a file, without what takes a computation."""
    return model_of_case(case_of(name, *changes), version, results=False)


def places(model: Model) -> Iterator[Place]:
    """Every attribute that an import reads, in the model and in its load cases."""
    tables = [one.attributes for one in model.components.values()]
    tables += [table for load in model.load_cases for table in load.components.values()]
    for table in tables:
        for name in list(table):
            if name in USED:
                yield table, name


def other(value: Any) -> Any:
    """A value of the same kind, but another."""
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        return value + 1
    if isinstance(value, float):
        return 1.01 * value or 0.1
    if isinstance(value, list):
        return [1.03 * one + 1.0 for one in value]
    return {"linear": "parabolic", "parabolic": "linear"}.get(value, f"{value}x")


def edited(table: dict[str, Attribute], name: str, way: str) -> None:
    if way == "removed":
        del table[name]
    else:
        value = "" if way == "emptied" else other(table[name].value)
        table[name] = replace(table[name], value=value)


def named_or_refused(model: Model, place: Place, way: str) -> bool:
    """Whether an edited file is read, and the edit named; else it is refused in one line."""
    table, name = place
    kept = dict(table)
    edited(table, name, way)
    found, said = None, ""
    try:
        found = imported(model)
    except InputError as error:
        said = str(error)
    table.clear()
    table.update(kept)
    if found is None:
        assert "\n" not in said
        return False
    assert any(name in note.partition(": got")[0] for note in found.notes), (name, found.notes)
    return True


def swept(name: str, every: int) -> dict[str, int]:
    """How many edits of a case's file are taken, each ``every``-th of them."""
    model = exported(name)
    assert tomllib.loads(imported(model).text) == case_of(name).data
    edits = [(place, way) for place in places(model) for way in ("changed", "emptied", "removed")]
    return {
        way: sum(named_or_refused(model, place, way) for place, how in some if how == way)
        for some in [edits[GEARS.index(name) % every :: every]]
        for way in ("changed", "emptied", "removed")
    }


@pytest.mark.parametrize("name", ["fzg-c", "pom-steel"])
def test_some_values_changed_one_by_one_are_named_or_refused(name: str) -> None:
    assert swept(name, 7)["changed"] > 1


@pytest.mark.slow
@pytest.mark.parametrize("name", GEARS)
def test_every_value_changed_one_by_one_is_named_or_refused(name: str) -> None:
    taken = swept(name, 1)
    assert taken["changed"] > 20
    assert taken["removed"] == taken["emptied"]


# --- what is no change -----------------------------------------------------------------------


def renumbered(model: Model) -> Model:
    """The same with other ids, every list the other way round, and without our twins of names."""
    new = {ident: 1000 + 7 * k for k, ident in enumerate(sorted(model.components))}

    def rows(table: dict[str, Attribute]) -> dict[str, Attribute]:
        found = {}
        for one in reversed(table.values()):
            refers = one.id == "reference_component_for_position"
            found[one.id] = replace(one, value=new[int(str(one.value))]) if refers else one
        return found

    again = Model(model.version, "another program", "")
    for one in reversed(model.components.values()):
        again.add(Component(new[one.id], one.type, "", rows(one.attributes)))
    for relation in reversed(model.relations):
        refs = tuple((role, new[ident]) for role, ident in reversed(relation.refs))
        again.relate(replace(relation, id=relation.id + 50, refs=refs))
    for load in model.load_cases:
        parts = {new[ident]: rows(table) for ident, table in reversed(load.components.items())}
        again.load(replace(load, id=load.id + 3, components=parts))
    return again


UNITS = {
    "mm": (1e-3, "m"),
    "mum": (1e-3, "mm"),
    "deg": (math.pi / 180.0, "rad"),
    "1 / min": (math.pi / 30.0, "rad / s"),
    "N m": (1e3, "N mm"),
    "N / mm^2": (1e-3, "GPa"),
    "kg / dm^3": (1e3, "kg / m^3"),
}


def in_other_units(model: Model) -> Model:
    for table, name in places(model):
        one = table[name]
        factor, unit = UNITS.get(one.unit or "", (1.0, one.unit))
        if isinstance(one.value, float):
            table[name] = Attribute(name, unit, f"{factor * one.value:.15e}")
    return model


def in_later_names(model: Model) -> Model:
    """As REXS 2.0.0 has it: other names, MPa."""
    model.version = "2.0.0"
    for table, name in places(model):
        one = table.pop(name)
        later = LATER[name][0] if "iso" in str(LATER.get(name)) else name
        unit = "MPa" if one.unit == "N / mm^2" else one.unit
        table[later] = Attribute(later, unit, one.value)
    return model


@pytest.mark.parametrize("way", [renumbered, in_other_units, in_later_names])
@pytest.mark.parametrize("name", ["rig", "bgu-18-35"])
def test_the_same_values_written_otherwise_are_the_same_case(way: Any, name: str) -> None:
    found = imported(way(exported(name)))
    assert [note for note in found.notes if "got the unit" not in note] == []
    assert gear_case(load_case(found.text)).data == case_of(name).data


@pytest.mark.parametrize("ending", ["rexs", "rexsj", "rexsz"])
def test_a_change_counts_in_every_container(
    ending: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = exporting.model_of_case

    def changed(case: GearCase, version: str) -> Model:
        model = whole(case, version, results=False)
        table = model.components[21].attributes
        table["face_width"] = replace(table["face_width"], value=15.5)
        return model

    monkeypatch.setattr("thermogear.case.rexs.writing.model_of_case", changed)
    path = write_rexs(case_of("fzg-c"), tmp_path / f"gearbox.{ending}")
    found = imported(read_rexs(path))
    assert found.notes == (
        "cylindrical_gear 21 'pinion'.face_width: got 15.5 mm; it was 14 mm when exported",
        f"{LIKE_ANY}nothing",
    )
    assert gear_case(load_case(found.text)).pair.pinion.face_width == 0.0155


# --- what is one -----------------------------------------------------------------------------


def put(model: Model, ident: int, **values: Any) -> Model:
    table = model.components[ident].attributes
    for name, value in values.items():
        table[name] = replace(table[name], value=value)
    return model


def as_case(model: Model) -> tuple[GearCase, Imported]:
    found = imported(model)
    return gear_case(load_case(found.text)), found


@pytest.mark.parametrize(
    ("one", "two"), [("nasa-spur", "bgu-18-35"), ("fzg-c", "loaded-27-35"), ("fzg-a", "pom-steel")]
)
def test_a_file_with_all_values_of_another_case_becomes_that_case(one: str, two: str) -> None:
    """Teeth, sizes, materials, oil and loads of ``two``; nothing of ``one``."""
    model = exported(two)
    model.components[3].attributes[CASE] = exported(one).components[3].attributes[CASE]
    becomes = case_of(two)
    case, found = as_case(model)
    for name in ("pinion", "wheel"):
        made, gear = getattr(case.pair, name), getattr(becomes.pair, name)
        assert made.teeth == gear.teeth
        for size in ("module", "profile_shift", "face_width", "tip_radius", "root_radius"):
            assert getattr(made, size) == pytest.approx(getattr(gear, size), rel=1e-11), size
        for size in ("youngs_modulus", "density", "thermal_expansion"):
            assert getattr(made.material, size) == pytest.approx(
                getattr(gear.material, size), rel=1e-11
            )
    assert case.pair.centre_distance == pytest.approx(becomes.pair.centre_distance, rel=1e-11)
    assert case.stated.speed == pytest.approx(becomes.stated.speed, rel=1e-11)
    assert case.torques == pytest.approx(becomes.torques, rel=1e-11)
    assert case.cold_backlash.half == pytest.approx(becomes.cold_backlash.half, rel=1e-9)
    assert "dynamics" not in case.data
    assert any("number_of_teeth" in note for note in found.notes)


@pytest.mark.parametrize("kept", [True, False], ids=["exported", "without the case"])
def test_teeth_that_do_not_go_with_their_root_diameter_are_refused(kept: bool) -> None:
    """Two teeth more by hand: the root diameter leaves a tool without room for its round."""
    model = exported("rig")
    if not kept:
        for one in model.components.values():
            one.attributes.pop(CASE, None)
    table = model.components[21].attributes
    table["number_of_teeth"] = replace(table["number_of_teeth"], value=27)
    with pytest.raises(InputError) as caught:
        imported(model)
    assert str(caught.value) == (
        "cylindrical_gear 21 'pinion'.number_of_teeth: got 27 beside a root_diameter of 112.5 mm; "
        "a tool that reaches 2.25 modules has no room for its round of 0.38 modules; teeth and "
        "diameters that go together"
    )


def test_a_changed_file_is_read_as_if_it_held_no_case() -> None:
    model = put(exported("rig"), 21, face_width=26.0)
    case, found = as_case(model)
    assert case.pair.pinion.face_width == pytest.approx(0.026, rel=1e-12)
    lost = ", ".join(kept_alone(case_of("rig")))
    assert found.notes[-1] == f"{LIKE_ANY}{lost}"
    assert "dynamics" in lost
    del model.components[3].attributes[CASE]
    assert tomllib.loads(found.text) == tomllib.loads(imported(model).text)


def test_speed_and_torque_of_the_command_count() -> None:
    found = imported(exported("fzg-a"), speed="1234 rpm", torque="56 N m")
    case = gear_case(load_case(found.text))
    assert case.data["operating"] == {"speed": "1234 rpm", "torque": "56 N m"}
    assert case.data["gears"] == case_of("fzg-a").data["gears"]
    with pytest.raises(InputError, match=r"^stage 1\.operating\.speed: got 'fast'"):
        imported(exported("fzg-a"), speed="fast")


def test_a_kept_case_without_its_values_is_refused() -> None:
    """Whether anything was changed since cannot be known."""
    model = exported("fzg-a")
    kept = json.loads(str(model.components[3].attributes.pop(CASE).value))
    del kept["values"]
    model.components[1].attributes[CASE] = Attribute(CASE, "none", json.dumps(kept))
    with pytest.raises(InputError, match="no case of thermogear; take the attribute"):
        imported(model)
