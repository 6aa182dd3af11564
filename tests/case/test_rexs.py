"""REXS models read: units of every version, containers, gears of a stage, speeds and torques."""

from __future__ import annotations

import base64
import io
import math
import re
import struct
import zipfile
from pathlib import Path

import pytest

from own_rexs import case_of, flank, json_text, one_stage, put, refused, replaced, two_stages, xml
from said import numbers
from thermogear import read_rexs
from thermogear.case.rexs.importing import listed
from thermogear.case.rexs.model import VERSIONS

REVOLUTION = 2.0 * math.pi / 60.0


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("container", ["xml", "json", "zip"])
def test_every_unit_arrives_in_si(version: str, container: str, tmp_path: Path) -> None:
    parts, links = one_stage(version)
    text = (json_text if container == "json" else xml)(parts, links, version)
    path = put(tmp_path, text)
    if container == "zip":
        path = tmp_path / "gearbox.rexsz"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("__MACOSX/._model.rexs", "x")
            archive.writestr("data/table.csv", "1,2")
            archive.writestr("model.rexs", text)
    case, found = case_of(path)
    assert found.notes == ()
    pair = case.pair
    assert (pair.pinion.teeth, pair.wheel.teeth) == (21, 43)
    assert pair.pinion.module == pytest.approx(0.0025, rel=1e-15)
    assert pair.pinion.pressure_angle == pytest.approx(math.pi / 9.0, rel=1e-15)
    assert (pair.pinion.profile_shift, pair.wheel.profile_shift) == (0.2, 0.1)
    assert pair.pinion.face_width == pytest.approx(0.0225, rel=1e-15)
    assert pair.wheel.face_width == pytest.approx(0.02, rel=1e-15)
    assert pair.centre_distance == pytest.approx(0.0809, rel=1e-15)
    assert (pair.pinion.rack.dedendum, pair.pinion.rack.fillet_radius) == (1.3, 0.3)
    steel = pair.wheel.material
    assert steel.youngs_modulus == pytest.approx(2.05e11, rel=1e-15)
    assert steel.poisson_ratio == 0.29
    assert steel.density == pytest.approx(7800.0, rel=1e-15)
    assert steel.thermal_expansion == pytest.approx(1.25e-5, rel=1e-15)
    assert (steel.thermal_conductivity, steel.specific_heat) == (44.0, 460.0)
    assert case.stated.speed == pytest.approx([1450.0 * REVOLUTION], rel=1e-14)
    assert case.torques == pytest.approx([30.0], rel=1e-14)
    assert case.stated.oil_temperature == pytest.approx(338.15, rel=1e-15)
    assert case.stated.lubricant.density_15 == pytest.approx(885.0, rel=1e-15)
    assert case.file.oil.viscosity_40 == pytest.approx(95e-6, rel=1e-15)


@pytest.mark.parametrize(
    ("unit", "value"),
    [("mm", 2.5), ("m", 0.0025), ("mum", 2500.0)],
)
def test_a_value_counts_in_the_unit_written_and_another_unit_is_said(
    unit: str, value: float, tmp_path: Path
) -> None:
    parts, links = one_stage()
    for gear in (7, 9):
        parts = replaced(parts, gear, ("normal_module", unit, value))
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.module == pytest.approx(0.0025, rel=1e-15)
    said = (
        f"cylindrical_gear 7.normal_module and 1 more: got the unit '{unit}'; REXS 1.7 has 'mm'; "
        "converted by the unit written"
    )
    assert found.notes == (() if unit == "mm" else (said,))


def test_units_of_another_version_are_converted_and_said(tmp_path: Path) -> None:
    parts, links = one_stage("2.0.0")
    found = case_of(put(tmp_path, xml(parts, links, "1.3")))[1]
    for unit, schema in (("MPa", "N / mm^2"), ("deg", "°")):
        assert (
            sum(f"got the unit '{unit}'; REXS 1.3 has '{schema}'" in one for one in found.notes)
            == 1
        )
    assert len(found.notes) == 2


@pytest.mark.parametrize("unit", [None, ""])
def test_a_missing_unit_is_that_of_the_schema_and_said(unit: str | None, tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 3, ("center_distance", unit, 80.9))
    case, found = case_of(put(tmp_path, json_text(parts, links)))
    assert case.pair.centre_distance == pytest.approx(0.0809, rel=1e-15)
    assert found.notes == (
        "cylindrical_stage 3.center_distance: got no unit; taken as 'mm', that of REXS",
    )


def test_a_unit_of_another_kind_is_refused(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 7, ("face_width", "N m", 22.5))
    assert refused(put(tmp_path, xml(parts, links))) == (
        "cylindrical_gear 7.face_width: got 22.5 N m; allowed a unit of length, such as 'mm'; "
        "'N m' is none"
    )


# --- what a stage is made of ------------------------------------------------------------------


def test_the_gear_that_the_torques_drive_is_the_pinion(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 11, ("torque_around_u_axis", "N m", -30.0))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert (case.pair.pinion.teeth, case.pair.wheel.teeth) == (43, 21)
    assert case.torques == pytest.approx([30.0 * 43 / 21], rel=1e-13)
    assert case.stated.speed == pytest.approx([1450.0 * 21 / 43 * REVOLUTION], rel=1e-13)


def test_power_at_a_known_speed_is_a_torque(tmp_path: Path) -> None:
    parts, links = one_stage()
    power = 30.0 * 1450.0 * REVOLUTION / 1000.0
    parts = replaced(parts, 11, ("power", "kW", power), drop=("torque_around_u_axis",))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.torques == pytest.approx([30.0], rel=1e-13)


def test_a_gear_over_a_connection_turns_with_its_shaft(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts.append((30, "tapered_interference_fit", []))
    links = [one for one in links if one != ("assembly", [("assembly", 4), ("part", 7)])]
    links.append(("side", [("inner_part", 4), ("outer_part", 7), ("assembly", 30)]))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.stated.speed == pytest.approx([1450.0 * REVOLUTION], rel=1e-14)


def test_a_missing_centre_distance_is_that_of_the_axes(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 3, drop=("center_distance",))
    for shaft, place in ((4, [0.0, 0.0, 0.0]), (5, [7.0, 48.54, 64.72])):
        parts = replaced(
            parts,
            shaft,
            ("support_vector", "mm", place),
            ("u_axis_vector", "mm", [1.0, 0.0, 0.0]),
            ("reference_component_for_position", "none", 1),
        )
    case, found = case_of(put(tmp_path, json_text(parts, links)))
    assert case.pair.centre_distance == pytest.approx(0.0809, rel=1e-12)
    assert re.search(r'^centre_distance = "80\.9 mm" +# derived: ', found.text, re.MULTILINE)


def test_a_centre_distance_that_is_rounded_gives_way_to_the_shifts(tmp_path: Path) -> None:
    parts, links = one_stage()
    exact = case_of(put(tmp_path, xml(replaced(parts, 3, drop=("center_distance",)), links)))[0]
    tight = 1e3 * exact.pair.centre_distance
    rounded = math.floor(1e3 * tight) / 1e3
    assert 0.0 < tight - rounded < 1e-3
    path = put(tmp_path, xml(replaced(parts, 3, ("center_distance", "mm", rounded)), links))
    case, found = case_of(path)
    assert case.pair.centre_distance == pytest.approx(1e-3 * tight, rel=1e-12)
    assert "rounded" in found.text
    path = put(tmp_path, xml(replaced(parts, 3, ("center_distance", "mm", 80.0)), links))
    assert refused(path).startswith("stage 1.gears.centre_distance: got 80 mm; allowed >= ")


def test_the_root_circle_decides_the_dedendum_before_the_tool(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 7, ("root_diameter", "mm", 46.75))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert 2.0 * case.pair.pinion.root_radius == pytest.approx(0.04675, rel=1e-14)
    assert case.pair.wheel.rack.dedendum == 1.3


@pytest.mark.parametrize("attribute", ["tooth_tip_chamfer", "tip_form_diameter"])
def test_a_chamfer_of_the_tip_is_that_of_the_flanks_or_of_the_diameters(
    attribute: str, tmp_path: Path
) -> None:
    parts, links = relieved("linear", None)
    if attribute == "tip_form_diameter":
        parts = replaced(parts, 7, ("tip_diameter", "mm", 58.5), (attribute, "mm", 58.1))
    else:
        for flank in (13, 14):
            parts = replaced(parts, flank, (attribute, "mm", 0.2))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.tip_chamfer == pytest.approx(0.2e-3, rel=1e-12)
    assert case.pair.wheel.tip_chamfer == 0.0
    # the relief is deepest where the flank ends
    relief = case.file.gears.pinion.tip_relief
    assert relief is not None
    assert relief.length == pytest.approx(rolled(0.0581) - rolled(0.056), rel=1e-11)


def test_teeth_that_do_not_go_with_their_root_diameter_are_refused(tmp_path: Path) -> None:
    """Two teeth more by hand: the root diameter leaves a tool without room for its round."""
    parts, links = one_stage()
    parts = replaced(parts, 7, ("root_diameter", "mm", 46.75), ("number_of_teeth", "none", 23))
    # h_aP0 = z/2 - d_f/(2 m) + x = 11.5 - 9.35 + 0.2
    assert refused(put(tmp_path, xml(parts, links))) == (
        "cylindrical_gear 7.number_of_teeth: got 23 beside a root_diameter of 46.75 mm; a tool "
        "that reaches 2.35 modules has no room for its round of 0.3 modules; teeth and diameters "
        "that go together"
    )


def test_a_generated_shift_moves_the_root_and_not_the_flank(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts.append(
        (
            31,
            "cylindrical_gear_manufacturing_settings",
            [("generated_addendum_modification_coefficient", "none", 0.15)],
        )
    )
    links = [
        (kind, [*refs, ("manufacturing_settings", 31)])
        if kind == "manufacturing_step" and ("workpiece", 13) in refs
        else (kind, refs)
        for kind, refs in links
    ]
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.profile_shift == 0.2
    assert case.pair.pinion.rack.dedendum == pytest.approx(1.35, rel=1e-14)
    # root circle: d - 2 m (h_aP0 - x_E)
    assert case.pair.pinion.root_radius == pytest.approx(0.02625 - 0.0025 * 1.15, rel=1e-13)


def test_roughness_class_and_thickness(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(
        parts,
        7,
        ("arithmetic_average_roughness_flank", "mum", 0.5),
        ("tolerance_class_according_to_iso_1328_2013", "none", "5"),
        ("chordal_tooth_thickness_upper_deviation", "mm", -0.05),
        ("chordal_tooth_thickness_lower_deviation", "mm", -0.09),
    )
    parts = replaced(
        parts,
        9,
        ("averaged_peak_to_valley_height_flank", "mum", 3.0),
        ("tolerance_class_according_to_iso_1328_2013", "none", 7),
        ("tooth_thickness_deviation_tolerance_series_din_3967_1978", "none", "cd25"),
    )
    parts = replaced(
        parts,
        3,
        ("upper_center_distance_allowance", "mum", 20.0),
        ("lower_center_distance_allowance", "mum", -10.0),
    )
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.roughness == pytest.approx(0.5e-6, rel=1e-14)
    assert case.pair.wheel.roughness == pytest.approx(0.5e-6, rel=1e-14)
    assert case.accuracy == 7
    (accuracy,) = (line for line in found.text.splitlines() if line.startswith("accuracy = "))
    assert numbers(accuracy.partition("# derived: ")[2]) == [5.0, 7.0]
    thin = case.file.backlash.tolerances
    assert thin is not None
    assert sorted(thin.pinion_tooth_thickness) == pytest.approx([-90e-6, -50e-6], rel=1e-14)
    # DIN 3967, 50 < d <= 125 mm: the upper allowance of cd is -70 um
    assert max(thin.wheel_tooth_thickness) == pytest.approx(-70e-6, rel=1e-14)
    assert sorted(thin.centre_distance) == pytest.approx([-10e-6, 20e-6], rel=1e-14)


def test_a_backlash_of_the_stage_is_the_middle_of_its_ends(tmp_path: Path) -> None:
    parts, links = one_stage()
    ends = [("minimum_normal_backlash", "mm", 0.1), ("maximum_normal_backlash", "mm", 0.2)]
    case, _ = case_of(put(tmp_path, xml(replaced(parts, 3, *ends), links)))
    assert case.cold_backlash.half == pytest.approx(75e-6, rel=1e-13)


# --- relief ----------------------------------------------------------------------------------


def relieved(shape: str, evaluated: float | None, *, right_only: bool = False) -> tuple[list, list]:  # type: ignore[type-arg]
    """The pinion's tip relieved by 20 um from a diameter of 56 mm on; tip diameter 58.5 mm."""
    parts, links = one_stage()
    parts = replaced(parts, 7, ("tip_diameter", "mm", 58.5))
    rows = [
        ("tip_relief_depth", "mm", 0.02),
        ("tip_relief_datum_diameter", "mm", 56.0),
        ("shape_of_relief", "none", shape),
    ]
    if evaluated is not None:
        rows.append(("tip_relief_evaluation_reference", "mm", evaluated))
    parts.append((40, "tip_relief", rows))
    for one in (14,) if right_only else (13, 14):
        links.append(("reference", [("origin", one), ("referenced", 40)]))
    return parts, links


def rolled(diameter: float) -> float:
    base = 0.0025 * 21 * math.cos(math.pi / 9.0)
    return 0.5 * math.sqrt(diameter**2 - base**2)


def test_a_tip_relief_is_measured_along_the_line_of_action(tmp_path: Path) -> None:
    case, _ = case_of(put(tmp_path, xml(*relieved("linear", None))))
    relief = case.file.gears.pinion.tip_relief
    assert relief is not None
    assert relief.amount == pytest.approx(20e-6, rel=1e-13)
    assert relief.length == pytest.approx(rolled(0.0585) - rolled(0.056), rel=1e-11)
    assert (relief.shape, relief.flank) == ("linear", "both")


@pytest.mark.parametrize(("shape", "power"), [("linear", 1), ("parabolic", 2)])
def test_a_depth_at_another_diameter_is_carried_on_to_the_tip(
    shape: str, power: int, tmp_path: Path
) -> None:
    case, _ = case_of(put(tmp_path, xml(*relieved(shape, 57.5))))
    relief = case.file.gears.pinion.tip_relief
    assert relief is not None
    share = (rolled(0.0585) - rolled(0.056)) / (rolled(0.0575) - rolled(0.056))
    assert relief.amount == pytest.approx(20e-6 * share**power, rel=1e-9)


@pytest.mark.parametrize(("speed", "carries"), [(1450.0, True), (-1450.0, False)])
def test_a_relief_of_one_flank_counts_where_the_flank_carries(
    speed: float, carries: bool, tmp_path: Path
) -> None:
    """About +u the right flank leads, seen along u with the tooth up: it turns to the right."""
    parts, links = relieved("linear", None, right_only=True)
    parts = replaced(parts, 4, ("rotational_speed", "1 / min", speed))
    parts = replaced(parts, 11, ("torque_around_u_axis", "N m", math.copysign(30.0, speed)))
    case, found = case_of(put(tmp_path, xml(parts, links)))
    relief = case.file.gears.pinion.tip_relief
    assert (relief is not None) is carries
    if relief is not None:
        assert relief.flank == "drive"
    else:
        assert "tip_relief 40" in [one.partition(":")[0] for one in found.unused]


def test_shapes_that_a_case_does_not_know_are_told_and_left_out(tmp_path: Path) -> None:
    case, found = case_of(put(tmp_path, xml(*relieved("logarithmic", None))))
    assert case.file.gears.pinion.tip_relief is None
    said = "tip_relief 40.shape_of_relief: got 'logarithmic'; allowed linear | parabolic | circular"
    assert said in found.unused
    assert said in found.text


# --- no case ----------------------------------------------------------------------------------


def test_a_helix_angle_is_one_line_and_no_case(tmp_path: Path) -> None:
    parts, links = one_stage()
    for gear, helix in ((7, 15.0), (9, -15.0)):
        parts = replaced(parts, gear, ("helix_angle_reference_diameter", "deg", helix))
    path = put(tmp_path, xml(parts, links))
    said = refused(path)
    assert said == (
        "stage 1.cylindrical_gear 7.helix_angle_reference_diameter: got 15 deg; allowed 0 deg; "
        "helical gears are not computed yet; take a spur stage"
    )
    stages, _ = listed(read_rexs(path))
    assert [str(one.why) for one in stages] == [said]


def test_internal_gears_are_one_line(tmp_path: Path) -> None:
    parts, links = one_stage()
    inner = replaced(parts, 9, ("number_of_teeth", "none", -43))
    assert "got -43, an internal gear" in refused(put(tmp_path, xml(inner, links)))
    ring = [(i, "ring_gear" if i == 9 else kind, rows) for i, kind, rows in parts]
    assert "ring_gear 9: got a ring gear" in refused(put(tmp_path, xml(ring, links)))


def test_a_stage_on_a_carrier_is_one_line(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts.append((50, "planetary_stage", []))
    links.append(("assembly", [("assembly", 50), ("part", 3)]))
    assert "its axes turn with the carrier" in refused(put(tmp_path, xml(parts, links)))


def test_gears_that_are_not_cut_alike_are_one_line(tmp_path: Path) -> None:
    parts, links = one_stage()
    other = replaced(parts, 9, ("normal_module", "mm", 2.0))
    said = refused(put(tmp_path, xml(other, links)))
    assert "cylindrical_gear 9.normal_module: got 2 mm; allowed 2.5 mm" in said
    steep = replaced(parts, 14, ("normal_pressure_angle", "deg", 25.0))
    said = refused(put(tmp_path, xml(steep, links)))
    assert f"{flank('1.7')} 14.normal_pressure_angle: got 25 deg; allowed 20 deg" in said


def test_missing_attributes_fall_back_to_defaults_that_are_said(tmp_path: Path) -> None:
    parts, links = two_stages()
    case, found = case_of(put(tmp_path, xml(parts, links)), 1)
    assert case.pair.pinion.profile_shift == 0.0
    text = found.text
    for name in ("profile_shift", "material", "accuracy", "temperature"):
        assert re.search(rf"^# {name} .*; default: ", text, re.MULTILINE), name
    for line in text.splitlines():
        if " = " in line and not line.startswith("#"):
            assert any(f"# {how}" in line for how in ("read", "derived", "default", "given")), line


def test_values_of_a_material_that_cannot_be_give_way_to_steel(tmp_path: Path) -> None:
    parts, links = one_stage()
    parts = replaced(parts, 18, ("thermal_expansion_coefficient_plus", "1e-6 / C", -11.0))
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.material.thermal_expansion == pytest.approx(11.5e-6, rel=1e-14)
    assert any("material 18.thermal_expansion_coefficient_plus" in one for one in found.unused)
    assert re.search(r"# default: .*thermal_expansion_coefficient_plus", found.text)


def test_a_coded_array_is_passed_over(tmp_path: Path) -> None:
    """The distance of the axes is then that of the shifts."""
    parts, links = one_stage()
    parts = replaced(parts, 3, drop=("center_distance",))
    parts = replaced(parts, 4, ("support_vector", "mm", [3.0, 0.0, 0.0]))
    plain = case_of(put(tmp_path, xml(parts, links)))[0].pair.centre_distance
    parts = replaced(parts, 5, ("support_vector", "mm", "CODED"))
    code = base64.b64encode(struct.pack("<3d", 3.0, 48.54, 64.72)).decode()
    text = xml(parts, links).replace("CODED", f'<array code="float64">{code}</array>')
    assert case_of(put(tmp_path, text))[0].pair.centre_distance == plain
    text = json_text(parts, links).replace(
        '"string": "CODED"', f'"floating_point_array_coded": {{"code":"float64","value":"{code}"}}'
    )
    assert case_of(put(tmp_path, text))[0].pair.centre_distance == plain


def test_a_byte_order_mark_and_prefixes_are_read(tmp_path: Path) -> None:
    parts, links = one_stage()
    text = "\ufeff" + xml(parts, links)
    assert read_rexs(put(tmp_path, text)).version == "1.7"
    text = "\ufeff" + json_text(parts, links)
    assert read_rexs(put(tmp_path, text)).container == "JSON"


def test_the_only_model_of_a_zip_is_found(tmp_path: Path) -> None:
    parts, links = one_stage()
    held = io.BytesIO()
    with zipfile.ZipFile(held, "w") as archive:
        archive.writestr("notes.json", "{}")
        archive.writestr("a/gearbox.rexsj", json_text(parts, links))
    path = tmp_path / "gearbox.rexs.zip"
    path.write_bytes(held.getvalue())
    assert {"JSON", "zip"} <= set(read_rexs(path).container.split())
