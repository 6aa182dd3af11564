"""What the JSON schema says of every field for a form: kind, unit, range, step, words, place."""

from __future__ import annotations

import re
from typing import Any

import pint
import pytest

from thermogear import InputError
from thermogear.case.fields import Measure, Several
from thermogear.case.refusals import reader_of
from thermogear.case.schema import GearFile, json_schema
from thermogear.case.table import Table
from thermogear.case.units import KINDS, read_quantity

WHOLE = json_schema()
FIELDS = {
    (table, name): about
    for table, schema in WHOLE["$defs"].items()
    for name, about in schema["properties"].items()
}
OTHERS = (
    "number", "count", "choice", "text", "yes/no", "number or temperature",
    "table", "tables", "named tables",
)  # fmt: skip


def tables(above: type[Table] = Table) -> list[type[Table]]:
    return [one for below in above.__subclasses__() for one in (below, *tables(below))]


def test_every_field_has_kind_title_order_and_group() -> None:
    for (_, name), about in FIELDS.items():
        assert about["x-kind"] in (*KINDS, *OTHERS)
        assert about["title"] == name.replace("_", " ")
        assert re.fullmatch(r"[a-z ]+", about["x-group"])
    for table, schema in WHOLE["$defs"].items():
        orders = [one["x-order"] for one in schema["properties"].values()]
        assert orders == list(range(len(orders))), table


def test_words_said_of_leaving_out_are_kept() -> None:
    """Every title written in the models is there, less the words that say nothing."""
    said = {
        field.title.removeprefix("left out: ")
        for table in tables()
        for field in table.model_fields.values()
        if field.title
    }
    told = {about["x-left-out"] for about in FIELDS.values() if "x-left-out" in about}
    assert len(told) > 40
    assert told == said


def test_measures_have_a_unit_and_ends_as_numbers_in_it() -> None:
    """Against pint, which our factors did not make."""
    registry = pint.UnitRegistry()
    checked = 0
    for table in tables():
        for field in table.model_fields.values():
            reader = reader_of(field)
            one = reader.one if isinstance(reader, Several) else reader
            if not isinstance(one, Measure):
                continue
            facts = one.facts()
            number, unit = one.example.strip('"').split(" ", 1)
            assert facts["x-unit"] == unit
            assert facts["x-step"] <= abs(float(number)) or float(number) == 0.0
            for key, end in (("x-minimum", one.low), ("x-maximum", one.high)):
                assert (key in facts) == (end is not None)
                if end is None:
                    continue
                size, written = end.split(" ", 1)
                theirs = registry.Quantity(float(size), written).to(unit).magnitude
                assert facts[key] == pytest.approx(theirs, rel=1e-11, abs=1e-9)
                again = read_quantity(f"{facts[key]!r} {unit}", one.kind)
                assert one.within(again) == again
                checked += 1
    assert checked > 150


def test_beyond_the_ends_is_refused() -> None:
    for table in tables():
        for field in table.model_fields.values():
            reader = reader_of(field)
            if not isinstance(reader, Measure):
                continue
            facts = reader.facts()
            span = facts["x-maximum"] - facts["x-minimum"]
            for end, way in (("x-minimum", -1.0), ("x-maximum", 1.0)):
                with pytest.raises(InputError):
                    reader.read(f"{facts[end] + way * 0.01 * span!r} {facts['x-unit']}")


@pytest.mark.parametrize(
    ("table", "field", "facts"),
    [
        ("GearsTable", "module", {"x-kind": "length", "x-unit": "mm", "x-step": 0.1}),
        ("GearsTable", "pressure_angle", {"x-kind": "angle", "x-unit": "deg", "x-step": 1.0}),
        ("GearTable", "teeth", {"x-kind": "count", "x-minimum": 5, "x-step": 1}),
        ("GearTable", "face_width", {"x-unit": "mm", "x-maximum": 10000.0}),
        ("GearTable", "allow_undercut", {"x-kind": "yes/no"}),
        ("GearTable", "tip_relief", {"x-kind": "table", "x-left-out": "no tip relief"}),
        ("GearTable", "pitch_errors", {"x-kind": "length", "x-list": True, "x-unit": "um"}),
        ("OperatingTable", "speed", {"x-unit": "rpm", "x-step": 100.0, "x-list": True}),
        ("TemperaturesTable", "housing", {"x-unit": "degC", "x-minimum": -70.0, "x-step": 1.0}),
        ("DynamicsTable", "damping_ratio", {"x-kind": "number", "x-maximum": 2.0}),
        ("InsideTable", "contact_angle", {"x-step": 1.0}),
        ("GearFile", "materials", {"x-kind": "named tables"}),
        ("GearFile", "shafts", {"x-kind": "tables", "x-group": "gear file"}),
        ("GearFile", "kind", {"x-choices": ["gear"]}),
        ("GearFile", "oil", {"x-kind": "table", "title": "oil"}),
        ("ModelTable", "friction", {"x-kind": "choice", "x-group": "model"}),
        ("TrainTable", "gravity", {"x-kind": "yes/no"}),
        ("BacklashTable", "value", {"x-about": "1e-5..50 mm; a pair without backlash jams as "
                                    "soon as it warms up"}),
    ],
)  # fmt: skip
def test_some_fields(table: str, field: str, facts: dict[str, Any]) -> None:
    about = FIELDS[table, field]
    assert {key: about.get(key) for key in facts} == facts


def test_one_table_alone_is_described_too() -> None:
    alone = GearFile.model_json_schema()["$defs"]["GearTable"]
    assert alone["properties"]["teeth"]["x-step"] == 1
