"""A case file comes out as SI dataclasses, its assumptions declared, its schema true to it."""

from __future__ import annotations

import math
import re
import tomllib
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from conftest import Compared
from thermogear.base.errors import GeometryError, InputError, ValidityWarning
from thermogear.base.materials import ZERO_CELSIUS, material
from thermogear.base.memory import free_bytes
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase, load_case, load_example
from thermogear.case.derived import facts
from thermogear.case.examples import EXAMPLES, example_text
from thermogear.case.schema import ModelTable, json_schema
from thermogear.case.size import estimated_bytes, require_room
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.mesh.model import CHOICES, MeshModel

STATED_BY_THE_THESIS = {
    "gears.module",
    "gears.pressure_angle",
    "gears.pinion.teeth",
    "gears.wheel.teeth",
    "operating.speed",
    "temperatures.row",
}
NO_ASSUMPTION = {"title", "kind", "model.bundle", "draw.pictures", "draw.base_sets"}


def rig(*overrides: str) -> GearCase:
    case = load_example("rig", overrides)
    assert isinstance(case, GearCase)
    return case


def leaves(table: dict[str, Any], above: str = "") -> list[str]:
    found = []
    for key, value in table.items():
        path = f"{above}.{key}" if above else key
        found += leaves(value, path) if isinstance(value, dict) else [path]
    return found


# --- the rig ----------------------------------------------------------------------------
def test_rig_is_what_the_thesis_states() -> None:
    case = rig()
    pinion, wheel = case.pair.pinion, case.pair.wheel
    assert (pinion.teeth, wheel.teeth) == (25, 75)
    assert pinion.module == pytest.approx(5e-3, rel=1e-15)
    assert pinion.pressure_angle == pytest.approx(math.radians(20.0), rel=1e-15)
    np.testing.assert_allclose(case.operating.speed * 30 / np.pi, [1000, 2000, 3000], rtol=1e-14)
    celsius = np.array(case.gear_temperatures) - ZERO_CELSIUS
    np.testing.assert_allclose(celsius, [100, 120, 140, 160], rtol=1e-14)
    assert case.kind == "gear"


def test_rig_has_the_published_equivalent_mass(compared: Compared) -> None:
    # solid discs 1.227 kg; tip radius 1.633 kg; bored 1.195 kg
    masses = [
        rig(*said).equivalent_mass
        for said in ((), ("inertia.radius=tip",), ("inertia.bored=true",))
    ]
    compared(
        "equivalent mass of the rig, three discs",
        "1.227, 1.633, 1.195 kg, computed apart",
        np.array(masses) - (1.227, 1.633, 1.195),
        5e-4,
        "kg",
    )


def test_given_inertias_are_taken_as_they_are() -> None:
    text = re.sub(
        r"\[inertia\].*?\n\n",
        '[inertia]\nmodel = "given"\npinion = "0.01 kg m^2"\nwheel = "4000 kg cm^2"\n\n',
        example_text("rig"),
        flags=re.DOTALL,
    )
    text = re.sub(r'"inertia\..*\n', "", text)
    case = load_case(text)
    assert isinstance(case, GearCase)
    assert case.inertias == pytest.approx((0.01, 0.4), rel=1e-14)
    assert case.inertia_kind == "given"


def test_every_value_the_thesis_does_not_state_is_declared_ours() -> None:
    data = tomllib.loads(example_text("rig"))
    declared = set(data.pop("ours"))
    stated = set(leaves(data)) - NO_ASSUMPTION
    covered = {
        path for path in stated if any(path == d or path.startswith(f"{d}.") for d in declared)
    }
    assert stated - covered == STATED_BY_THE_THESIS
    assert declared == {a.field for a in rig().assumptions}


@pytest.mark.parametrize("name", EXAMPLES)
def test_every_value_of_ours_says_so_on_its_line(name: str) -> None:
    text = example_text(name)
    body, _, _ = text.partition("[ours]")
    declared = tomllib.loads(text).get("ours", {})
    table = ""
    for line in body.splitlines():
        if match := re.match(r"\[(.+?)\]", line):
            table = match[1]
        elif match := re.match(r"(\w+) = ", line):
            path = f"{table}.{match[1]}".removeprefix(".")
            ours = any(path == d or path.startswith(f"{d}.") for d in declared)
            if ours and not path.endswith((".expected", ".harmonics")):
                assert "# " in line, line
                assert "ours" in line, line


def test_an_overridden_value_is_no_longer_ours() -> None:
    fields = {
        a.field for a in rig("operating.torque=150 N m", "gears.rack.dedendum=1.2").assumptions
    }
    assert "operating.torque" not in fields
    assert "gears.pinion.face_width" in fields
    assert rig("operating.torque=150 N m").overrides == (("operating.torque", "150 N m"),)


def test_a_default_left_to_act_is_an_assumption_with_its_value() -> None:
    text = re.sub(
        r'profile_shift = 0.0 .*\n|"gears.wheel.profile_shift".*\n', "", example_text("rig")
    )
    text = text.replace('"gears.pinion.profile_shift"', '"gears.wheel.profile_shift"')
    found = {a.field: a for a in load_case(text).assumptions}
    assert found["gears.pinion.profile_shift"].value == "0"
    assert "default" in found["gears.pinion.profile_shift"].reason
    assert found["gears.wheel.profile_shift"].value == "left out"


def test_speed_is_the_slow_axis_of_the_grid() -> None:
    case = rig('operating.torque=["50 N m", "200 N m"]')
    np.testing.assert_array_equal(case.operating.torque, [50, 200] * 3)
    np.testing.assert_array_equal(case.operating.speed, np.repeat(case.speeds, 2))
    assert case.torques == (50.0, 200.0)


@pytest.mark.parametrize(
    "given", [(), ('oil.temperature="95 degC"',), ('temperatures.wheel_addendum="110 degC"',)]
)
def test_gears_at_the_drawing_temperature_are_as_drawn(given: tuple[str, ...]) -> None:
    """Shafts, housing and oil keep their proportion to the gears, whatever was held where."""
    text = example_text("rig")
    if given and given[0].startswith("oil"):
        text = text.replace('temperature_below_addendum = "40 K"', 'temperature = "95 degC"')
        text = text.replace('"oil.temperature_below_addendum"', '"oil.temperature"')
    case = load_case(text, given)
    assert isinstance(case, GearCase)
    assert case.follow == "proportional"
    drawn = case.operating_at(ZERO_CELSIUS + 20.0)
    for temperature in (*drawn.temperatures.bodies.values(), drawn.oil_temperature):
        assert np.all(np.asarray(temperature) == ZERO_CELSIUS + 20.0)
    if any("wheel_addendum" in one for one in given):
        return
    # and at the stated temperature all is as stated
    stated, hot = case.operating_at(ZERO_CELSIUS + 140.0), case.operating
    for name, body in hot.temperatures.bodies.items():
        np.testing.assert_allclose(stated.temperatures.bodies[name], body, rtol=1e-15)
    np.testing.assert_allclose(stated.oil_temperature, hot.oil_temperature, rtol=1e-15)


def test_excesses_scale_with_the_gears() -> None:
    case = rig('temperatures.wheel_addendum="100 degC"')
    warm = case.operating_at(ZERO_CELSIUS + 60.0)
    # 40 K of 120 K at the pinion, of 80 K at the wheel, of 100 K between them
    expected = {"pinion_bore": 40.0 / 120.0 * 100.0, "wheel_bore": 40.0 / 80.0 * 60.0}
    expected |= {"housing": 40.0 / 100.0 * 80.0, "pinion_addendum": 40.0, "wheel_addendum": 40.0}
    for name, excess in expected.items():
        body = warm.temperatures.bodies[name]
        assert float(body) - ZERO_CELSIUS - 20.0 == pytest.approx(excess, rel=1e-12)


@pytest.mark.filterwarnings("ignore:temperatures.pinion_bore. stands")
def test_a_proportion_that_no_case_could_hold_is_one_line() -> None:
    # gears hardly warm over a housing far warmer
    with pytest.raises(InputError) as caught:
        rig(
            'temperatures.pinion_addendum="60 degC"',
            'temperatures.pinion_bore_below_addendum="80 K"',
        )
    assert str(caught.value) == (
        "temperatures.row[1]: got 120 degC; pinion_bore in proportion to it would be at 193.15 K "
        "(-80 degC); allowed -70..600 degC; give the addenda other temperatures, "
        'or write temperatures.follow = "fixed"'
    )
    with pytest.raises(InputError) as caught:
        rig('temperatures.pinion_addendum="25 degC"', 'temperatures.wheel_addendum="25 degC"')
    assert str(caught.value) == (
        "temperatures.row[0]: got 100 degC; pinion_bore in proportion to it would be at 53.15 K "
        "(-220 degC); allowed -70..600 degC; give the addenda other temperatures, "
        'or write temperatures.follow = "fixed"'
    )
    with pytest.raises(InputError) as caught:
        rig('temperatures.pinion_addendum="20 degC"', 'temperatures.wheel_addendum="20 degC"')
    assert str(caught.value) == (
        "temperatures.row[0]: got 100 degC; in the hot state the pinion's addendum stands at the "
        "reference temperature, which gives no proportion; give the addenda other temperatures, or "
        'write temperatures.follow = "fixed"'
    )


def test_fixed_distances_are_kept_where_asked() -> None:
    case = rig('oil.temperature_below_addendum="50 K"', 'temperatures.follow="fixed"')
    warm = case.operating_at(400.0)
    assert warm.temperatures.pinion_addendum == warm.temperatures.wheel_addendum == 400.0
    assert warm.temperatures.pinion_bore == warm.temperatures.wheel_bore == 380.0
    assert warm.temperatures.housing == 360.0
    assert warm.oil_temperature == 350.0
    assert warm.temperatures.reference == pytest.approx(ZERO_CELSIUS + 20.0)
    np.testing.assert_array_equal(warm.speed, case.operating.speed)


def test_bodies_given_outright_stay() -> None:
    text = example_text("rig").replace('housing_below_addendum = "40 K"', 'housing = "60 degC"')
    text = text.replace('"temperatures.housing_below_addendum"', '"temperatures.housing"')
    text = text.replace('follow = "proportional"', 'follow = "fixed"')
    case = load_case(text)
    assert isinstance(case, GearCase)
    assert case.operating_at(430.0).temperatures.housing == pytest.approx(333.15)


def test_transmission_error_is_the_series_of_its_harmonics() -> None:
    case = rig(
        'transmission_error.harmonics=[{order=1, amplitude="5 um"},'
        '{order=3, amplitude="2 um", phase="90 deg"}]'
    )
    phase = np.linspace(0.0, 1.0, 17)
    expected = 5e-6 * np.cos(2 * np.pi * phase) + 2e-6 * np.cos(6 * np.pi * phase + np.pi / 2)
    np.testing.assert_allclose(case.transmission_error(phase), expected, atol=1e-20)


def test_no_error_at_all_is_allowed() -> None:
    assert rig("transmission_error.harmonics=[]").transmission_error.harmonics == ()


def test_models_are_bundles_with_single_choices_in_their_place() -> None:
    assert rig().models == (MeshModel.consistent(), MeshModel.thesis())
    assert rig("model.bundle=thesis").models == (MeshModel.thesis(),)
    dry = rig("model.friction=dry").models
    assert [m.friction for m in dry] == ["dry", "dry"]
    assert dry[0].flank == "growth"
    assert dry[1].flank == "thesis"


def test_the_file_knows_every_choice_of_the_mesh_model() -> None:
    assert set(ModelTable.model_fields) == set(CHOICES) | {"bundle", "dry_coefficient"}


def test_backlash_from_tolerances() -> None:
    text = re.sub(
        r"\[backlash\].*?\n\n",
        '[backlash.tolerances]\npinion_tooth_thickness = ["-0.06 mm", "-0.10 mm"]\n'
        'wheel_tooth_thickness = "-0.1 mm"\ncentre_distance = ["-20 um", "20 um"]\n\n',
        example_text("rig"),
        flags=re.DOTALL,
    )
    case = load_case(re.sub(r'"backlash\..*\n', "", text))
    assert isinstance(case, GearCase)
    half = 0.5 * 180e-6 * math.cos(math.radians(20.0))
    assert case.cold_backlash.half == pytest.approx(half, rel=1e-12)
    assert case.operating.half_backlash == case.cold_backlash.half
    assert case.cold_backlash.least < half < case.cold_backlash.most
    least = round(1e6 * case.cold_backlash.least, 3)
    assert any(isinstance(f.value, float) and round(f.value, 3) == least for f in facts(case))


def test_an_oil_of_two_viscosities_passes_through_them() -> None:
    case = rig(
        "oil.name=mine",
        "oil.viscosity_40=100 cSt",
        "oil.viscosity_100=11 cSt",
        "oil.density_15=885 kg/m^3",
    )
    oil = case.operating.lubricant
    at = np.array([40.0, 100.0]) + ZERO_CELSIUS
    np.testing.assert_allclose(kinematic_viscosity(oil, at), [1e-4, 1.1e-5], rtol=1e-9)
    assert oil.density_15 == pytest.approx(885.0)


def test_materials_of_the_users_own() -> None:
    own = (
        '[materials.aluminium]\nyoungs_modulus = "70 GPa"\npoisson_ratio = 0.33\n'
        'density = "2.7 g/cm^3"\nthermal_conductivity = "160 W/(m K)"\n'
        'specific_heat = "900 J/(kg K)"\nthermal_expansion = "23e-6 1/K"\n\n[oil]'
    )
    text = example_text("rig").replace("[oil]", own, 1)
    case = load_case(text, {"housing.material": "aluminium"})
    assert isinstance(case, GearCase)
    assert case.housing.thermal_expansion == pytest.approx(23e-6)
    assert case.housing.density == pytest.approx(2700.0)
    assert case.pair.pinion.material == material("steel")


# --- warnings ---------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("override", "message"),
    [
        (
            "temperatures.pinion_addendum=190 degC",
            r"^temperatures.pinion_addendum: got 190 degC; valid -60..180 degC; above the "
            r"tempering temperature of steel$",
        ),
        (
            "temperatures.row=['100 degC', '195 degC']",
            r"^temperatures.row\[1\].pinion_addendum: got 195 degC; valid -60..180 degC",
        ),
        (
            "temperatures.wheel_bore_below_addendum=195 K",
            r"^temperatures.row\[3\].wheel_bore: got -67.5 degC; valid -60..180 degC; below "
            r"the data of steel$",
        ),
        (
            "oil.temperature_below_addendum=-20 K",
            r"^oil.temperature: got 160 degC; valid -20..150 degC; outside the viscosity fit of "
            r"M100$",
        ),
    ],
)
def test_leaving_the_range_of_the_data_warns(override: str, message: str) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        rig(override)
    assert caught
    assert {w.category for w in caught} == {ValidityWarning}
    assert any(re.search(message, str(one.message)) for one in caught), caught


# --- dimensionless cases ------------------------------------------------------------------
def test_table_rows_start_from_the_base_set() -> None:
    case = load_example("table-4.2")
    assert isinstance(case, DimensionlessCase)
    assert case.kind == "dimensionless"
    assert len(case.points) == 12
    zeta = [p for p in case.points if p.row == "zeta"]
    assert [p.damping_ratio for p in zeta] == [0.18, 0.168, 0.114, 0.10]
    assert {p.frequency for p in zeta} == {1.245}
    assert [p.expected for p in zeta] == ["period-1", "period-2", "period-4", "chaotic"]
    assert zeta[0].model_arguments() == {
        "damping_ratio": 0.18,
        "frequency": 1.245,
        "stiffness_amplitude": 0.335,
        "mean_force": 0.017,
        "force_amplitude": -1.16,
        "half_backlash": 1.0,
        "thermal_stiffness": 0.0,
    }


def test_temperature_row_follows_its_two_laws() -> None:
    case = load_example("section-4.1")
    assert isinstance(case, DimensionlessCase)
    for point in case.points:
        warm = point.value - ZERO_CELSIUS - 20.0
        assert point.unit == "K"
        assert point.half_backlash == pytest.approx(1.0 - 0.2 * warm / 140.0, abs=1e-15)
        law = 0.02 * warm / 140.0 if point.row == "thesis" else -3.3e-4 * warm
        assert point.thermal_stiffness == pytest.approx(law, abs=1e-15)


@pytest.mark.parametrize(
    ("override", "message"),
    [
        ("rows.zeta.values=[0.18, -0.1]", "rows.zeta.values[1]: got -0.1; allowed 0..1000"),
        ("rows.zeta.values=['20 degC']", "rows.zeta.values[0]: got a temperature; allowed pure"),
        ("rows.zeta.damping_ratio=0.1", "rows.zeta.damping_ratio: got a value beside its own row"),
        ("rows.zeta.mean_force=[1, 2]", "rows.zeta.mean_force: got 2 entries; allowed one, or 4"),
        ("rows.zeta.expected=['a', 'b']", "rows.zeta.expected: got 2 entries; allowed one, or 4"),
        ("rows.zeta.parameter=dampin_ratio", "did you mean 'damping_ratio'?"),
        ("rows.zeta.parameter=temperature", "allowed temperatures with unit; the row runs through"),
        ("base.half_backlash=0", "base.half_backlash: got 0; allowed 1e-09..1e+06"),
        ("base.thermal_stiffness=-1", "base.thermal_stiffness: got -1; allowed -0.999..1000"),
        ("rows={}", "rows: got a table"),
    ],
)
def test_rows_that_contradict_themselves_are_refused(override: str, message: str) -> None:
    text = example_text("table-4.2").partition("[ours]")[0]
    with pytest.raises(InputError) as caught:
        load_case(text, [override])
    assert message in str(caught.value)


# --- reading ------------------------------------------------------------------------------
@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_load_from_text_and_from_file_alike(name: str, tmp_path: Path) -> None:
    path = tmp_path / f"{name}.toml"
    path.write_text(example_text(name), encoding="utf-8")
    from_text, from_file = load_case(example_text(name)), load_case(path)
    assert from_text.text == from_file.text == path.read_text(encoding="utf-8")
    assert from_text.assumptions == from_file.assumptions == load_case(str(path)).assumptions
    assert isinstance(from_text, Case)
    assert from_text.simulation == from_file.simulation
    assert facts(from_text) == facts(from_file)
    assert all(a.reason.strip() and a.value for a in from_text.assumptions)


def test_a_byte_order_mark_does_no_harm(tmp_path: Path) -> None:
    path = tmp_path / "rig.toml"
    path.write_bytes(b"\xef\xbb\xbf" + example_text("rig").encode())
    assert load_case(path).title == rig().title


def test_overrides_come_as_mapping_or_as_texts() -> None:
    mapped = load_example(
        "rig", {"gears.pinion.teeth": "30", "gears.pinion.tip_diameter": "160 mm"}
    )
    listed = rig("gears.pinion.teeth=30", 'gears.pinion.tip_diameter = "160 mm"')
    assert isinstance(mapped, GearCase)
    assert mapped.pair == listed.pair
    assert mapped.pair.pinion.teeth == 30


def test_an_override_may_make_a_table() -> None:
    assert rig("gears.rack.addendum=1.0").pair == rig().pair


def test_geometry_errors_keep_their_class_and_speak_of_the_file() -> None:
    with pytest.raises(GeometryError) as caught:
        rig("gears.pinion.bore_radius=60 mm")
    assert str(caught.value) == (
        "gears.pinion.bore_radius: got 60 mm; allowed < root radius 56.25 mm; "
        "the body must be a ring"
    )


def test_undercut_is_made_on_request() -> None:
    undercut = rig(
        "gears.pinion.teeth=16",
        "gears.pinion.tip_diameter=90 mm",
        "gears.wheel.tip_diameter=382 mm",
        "gears.pinion.allow_undercut=true",
    )
    assert undercut.pair.pinion.teeth == 16


@pytest.mark.parametrize("junk", ["nan", "-1", "1e308", '"1e308 km"', '"-5 mm"', "[[1]]", "{a=1}"])
def test_any_value_anywhere_is_read_or_refused(junk: str) -> None:
    data = tomllib.loads(example_text("rig"))
    del data["ours"]
    refused = 0
    for path in leaves(data):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                rig(f"{path}={junk}")
            except InputError as error:
                refused += error.field.startswith(path.split(".")[0])
    assert refused > 0.75 * len(leaves(data))


# --- facts and size -------------------------------------------------------------------------
def test_facts_of_the_rig_are_the_published_ones() -> None:
    found = {(f.group, f.name): f.value for f in facts(rig())}
    path = "path of contact from the pinion's tangent point"
    published = {
        ("pair", "centre distance"): 250.0,
        ("pair", "base pitch"): 14.760657,
        ("pair", "contact ratio"): 1.714426,
        ("pinion", "base radius"): 58.731,
        ("wheel", "base radius"): 176.192,
        (path, "A"): 7.9647,
        (path, "B"): 18.5101,
        (path, "C"): 21.3763,
        (path, "D"): 22.7254,
        (path, "E"): 33.2708,
        ("mesh frequency", "at 1000 rpm"): 416.667,
        ("mesh frequency", "at 2000 rpm"): 833.333,
        ("mesh frequency", "at 3000 rpm"): 1250.0,
    }
    for key, value in published.items():
        assert found[key] == pytest.approx(value, abs=6e-4 if value > 100 else 5e-5 * value)


def test_facts_of_rows_name_every_point() -> None:
    assert len(facts(load_example("section-4.1"))) == 10
    assert facts(load_example("section-4.1"))[1].name == "temperature 100 degC"


def test_memory_grows_with_the_grid_and_a_huge_one_is_refused() -> None:
    small = rig()
    wide = rig("operating.torque=[" + ", ".join(f'"{t} N m"' for t in range(1, 11)) + "]")
    assert estimated_bytes(wide) == 10 * estimated_bytes(small)
    assert free_bytes() > 0
    assert require_room(small) == estimated_bytes(small)
    with pytest.raises(InputError, match=r"^case: got about .* GiB .*; allowed 0\.\..* --force$"):
        require_room(wide, free=2**20)
    assert require_room(wide, free=2**20, forced=True) == estimated_bytes(wide)
    assert estimated_bytes(load_example("table-4.2")) > 0


def test_a_grid_is_counted_before_it_is_made() -> None:
    many = "[" + ", ".join(f'"{t} rpm"' for t in range(1, 2001)) + "]"
    with pytest.raises(InputError, match=r"^operating: got 2000 speeds x 2000 torques = 4000000"):
        rig(f"operating.speed={many}", f"operating.torque={many.replace('rpm', 'N m')}")


# --- the JSON schema --------------------------------------------------------------------------
def conforms(value: Any, schema: dict[str, Any], whole: dict[str, Any]) -> bool:
    """The part of JSON schema that the case file's schema uses."""
    if "$ref" in schema:
        return conforms(value, whole["$defs"][schema["$ref"].rsplit("/", 1)[1]], whole)
    if "anyOf" in schema:
        return any(conforms(value, one, whole) for one in schema["anyOf"])
    kinds = {
        "object": dict,
        "array": list,
        "string": str,
        "integer": int,
        "number": (int, float),
        "boolean": bool,
        "null": type(None),
    }
    kind = schema.get("type")
    if kind and (
        not isinstance(value, kinds[kind]) or (isinstance(value, bool) != (kind == "boolean"))
    ):
        return False
    if "enum" in schema and value not in schema["enum"]:
        return False
    if isinstance(value, str):
        return re.search(schema.get("pattern", ""), value) is not None
    if isinstance(value, list):
        return schema.get("minItems", 0) <= len(value) and all(
            conforms(item, schema.get("items", {}), whole) for item in value
        )
    if isinstance(value, dict):
        known, extra = schema.get("properties", {}), schema.get("additionalProperties", True)
        if set(schema.get("required", ())) - set(value):
            return False
        for key, entry in value.items():
            inner = known.get(key, extra)
            if inner is False or (inner is not True and not conforms(entry, inner, whole)):
                return False
        return True
    return schema.get("minimum", value) <= value <= schema.get("maximum", value)


@pytest.mark.parametrize("name", EXAMPLES)
def test_schema_accepts_the_examples(name: str) -> None:
    schema = json_schema()
    assert conforms(tomllib.loads(example_text(name)), schema, schema)


@pytest.mark.parametrize(
    "change",
    [
        ("gears.modul", "5 mm"),
        ("gears.module", 5),
        ("gears.pinion.teeth", 25.5),
        ("model.bundle", "thesys"),
        ("dynamics.damping_ratio", -1),
        ("kind", "dimensionless"),
    ],
)
def test_schema_refuses_what_the_loader_refuses(change: tuple[str, object]) -> None:
    data = tomllib.loads(example_text("rig"))
    *way, last = change[0].split(".")
    table = data
    for key in way:
        table = table[key]
    table[last] = change[1]
    schema = json_schema()
    assert not conforms(data, schema, schema)


def test_defaults_of_the_schema_can_be_written_in_a_file() -> None:
    def check(schema: dict[str, Any], whole: dict[str, Any]) -> None:
        for inner in schema.get("properties", {}).values():
            if "default" in inner:
                assert conforms(inner["default"], inner, whole), inner

    whole = json_schema()
    for schema in whole["$defs"].values():
        check(schema, whole)


def test_the_bare_name_of_a_ready_made_case_stands_for_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert load_case(Path("section-4.1")).text == example_text("section-4.1")
    (tmp_path / "section-4.1").write_text(example_text("table-4.2"), encoding="utf-8")
    assert load_case(Path("section-4.1")).text == example_text("table-4.2")
