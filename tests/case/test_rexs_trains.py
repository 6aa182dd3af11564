"""Speed and torque of a stage out of the whole train that a REXS model holds."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from own_rexs import case_of, json_text, one_stage, put, refused, replaced, two_stages, xml
from said import numbers
from thermogear import read_rexs
from thermogear.case.case import gear_case, load_case
from thermogear.case.rexs.attributes import Reader
from thermogear.case.rexs.drive import Drive
from thermogear.case.rexs.importing import imported

REVOLUTION = 2.0 * math.pi / 60.0


def test_speed_and_torque_run_through_the_stages(tmp_path: Path) -> None:
    path = put(tmp_path, xml(*two_stages()))
    for number, teeth, rpm, moment in ((1, (20, 60), 1200.0, 12.0), (2, (25, 50), 400.0, 36.0)):
        case, _ = case_of(path, number)
        assert (case.pair.pinion.teeth, case.pair.wheel.teeth) == teeth
        assert case.stated.speed == pytest.approx([rpm * REVOLUTION], rel=1e-13)
        assert case.torques == pytest.approx([moment], rel=1e-13)


@pytest.mark.parametrize(
    ("cones", "sense"), [(("positive", "negative"), 1), (("positive",) * 2, -1)]
)
def test_bevel_gears_turn_as_their_cones_point(
    cones: tuple[str, str], sense: int, tmp_path: Path
) -> None:
    """Cone along +x on a shaft along x, cone along -z on one along z: omega x r at the contact."""
    parts, links = two_stages()
    parts.append((60, "bevel_stage", []))
    for gear, cone, teeth, shaft in ((61, cones[0], 20, 14), (62, cones[1], 40, 11)):
        rows = [("number_of_teeth", "none", teeth), ("bevel_cone_orientation", "none", cone)]
        parts.append((gear, "bevel_gear", rows))
        links.append(("assembly", [("assembly", shaft), ("part", gear)]))
    parts.append((14, "shaft", [("rotational_speed", "1 / min", 2400.0)]))
    parts = replaced(parts, 11, drop=("rotational_speed",))
    links.append(("stage", [("stage", 60), ("gear_1", 61), ("gear_2", 62)]))
    model = read_rexs(put(tmp_path, xml(parts, links)))
    speeds, _, signed = Drive(Reader(model)).speeds({})
    assert speeds[11] == pytest.approx(sense * 1200.0 * REVOLUTION, rel=1e-13)
    assert signed == {11, 12, 13, 14}


def test_a_load_at_the_output_drives_backwards_through_the_train(tmp_path: Path) -> None:
    parts, links = two_stages()
    parts = replaced(parts, 31, ("defines_torque", "none", False), drop=("torque_around_u_axis",))
    parts.append(
        (
            32,
            "external_load",
            [("torque_around_u_axis", "N m", -72.0), ("defines_torque", "none", True)],
        )
    )
    links.append(("assembly", [("assembly", 13), ("part", 32)]))
    case, _ = case_of(put(tmp_path, xml(parts, links)), 1)
    # the output turns with +200 rpm, so -72 N m brake and the input drives with 12 N m
    assert (case.pair.pinion.teeth, case.torques[0]) == (20, pytest.approx(12.0, rel=1e-13))


def test_load_cases_of_one_speed_are_a_list(tmp_path: Path) -> None:
    loads = [
        [(31, "external_load", [("torque_around_u_axis", "N m", torque)])]
        for torque in (12.0, 24.0)
    ]
    case, found = case_of(put(tmp_path, xml(*two_stages(), loads=loads)), 2)
    assert case.torques == pytest.approx([36.0, 72.0], rel=1e-13)
    assert case.stated.speed.size == 2
    assert found.duty == ""


def test_a_spectrum_gives_the_greatest_power_and_a_duty(tmp_path: Path) -> None:
    rows = ((543.0, 10.0, 20.0), (3456.0, 8.0, 30.0), (1234.0, 9.0, 50.0))
    loads = [
        [
            (1, "gear_unit", [("operating_time_fraction", "%", share)]),
            (11, "shaft", [("rotational_speed", "1 / min", speed)]),
            (31, "external_load", [("torque_around_u_axis", "N m", torque)]),
        ]
        for speed, torque, share in rows
    ]
    for text in (xml, json_text):
        case, found = case_of(put(tmp_path, text(*two_stages(), loads=loads)), 1)
        assert case.stated.speed == pytest.approx([3456.0 * REVOLUTION], rel=1e-13)
        assert case.torques == pytest.approx([8.0], rel=1e-13)
        assert found.duty.splitlines() == [
            "time [h],speed [rpm],torque [N m]",
            "0,543,10",
            "0.2,3456,8",
            "0.5,1234,9",
            "1,1234,9",
        ]


def test_what_no_load_says_is_asked_for_and_may_be_given(tmp_path: Path) -> None:
    parts, links = two_stages()
    path = put(tmp_path, xml(replaced(parts, 31, drop=("torque_around_u_axis",)), links))
    assert refused(path, 1) == (
        "stage 1.operating.torque: got nothing; allowed a torque of a shaft, in the model or a "
        'load case; the file says none that reaches this stage; fix: add --torque "100 N m"'
    ).replace("fix: ", "")
    found = imported(read_rexs(path), 1, torque="15 N m")
    case = gear_case(load_case(found.text))
    assert case.torques == pytest.approx([15.0], rel=1e-15)
    assert case.stated.speed == pytest.approx([1200.0 * REVOLUTION], rel=1e-13)
    assert 'torque = "15 N m"   # given: --torque' in found.text


def test_couplings_turn_shafts_alike_in_their_gear(tmp_path: Path) -> None:
    """Two loose gears on one shaft: which stage carries is told by gear_shift_index."""
    rows = [("gear_shift_index", "none", 2), ("number_of_gears", "none", 2)]
    parts = [(1, "gear_unit", rows)]
    links = []
    for k, (first, second) in enumerate(((20, 60), (40, 40))):
        loose, stage, one, two = 12 + k, 3 + k, 21 + 2 * k, 22 + 2 * k
        parts += [(stage, "cylindrical_stage", []), (loose, "shaft", [])]
        for gear, teeth, shaft in ((one, first, 11), (two, second, loose)):
            size = [("normal_module", "mm", 2.0), ("face_width", "mm", 15.0)]
            parts.append((gear, "cylindrical_gear", [("number_of_teeth", "none", teeth), *size]))
            links.append(("assembly", [("assembly", shaft), ("part", gear)]))
        links.append(("stage", [("stage", stage), ("gear_1", one), ("gear_2", two)]))
        parts.append((41 + k, "switchable_coupling", [("is_engaged", "none", f"GEAR{k}")]))
        parts.append((51 + k, "rolling_bearing_with_detailed_geometry", []))
        for by in (41 + k, 51 + k):
            refs = [("inner_part", 14), ("outer_part", loose), ("assembly", by)]
            links.append(("side", refs))
    parts += [(14, "shaft", []), (11, "shaft", [("rotational_speed", "1 / min", 1500.0)])]
    parts += [(31, "external_load", [("torque_around_u_axis", "N m", 10.0)])]
    parts += [(32, "external_load", [("transmits_torque", "none", True)])]
    links += [("assembly", [("assembly", 11), ("part", 31)])]
    links += [("assembly", [("assembly", 14), ("part", 32)])]
    text = xml(parts, links)
    for k, states in enumerate(("<c>true</c><c>false</c>", "<c>false</c><c>true</c>")):
        text = text.replace(f"GEAR{k}", f"<array>{states}</array>")
    path = put(tmp_path, text)
    case, _ = case_of(path, 2)
    assert case.torques == pytest.approx([10.0], rel=1e-13)
    assert "operating.torque: got nothing" in refused(path, 1)
    path = put(tmp_path, text.replace('unit="none">2<', 'unit="none">1<', 1))
    case, _ = case_of(path, 1)
    assert (case.pair.pinion.teeth, case.torques[0]) == (20, pytest.approx(10.0, rel=1e-13))


def test_a_stage_without_a_ratio_takes_what_it_takes(tmp_path: Path) -> None:
    """A worm without teeth on the middle shaft: the first stage is known, the second is not."""
    parts, links = two_stages()
    parts += [(70, "worm_stage", []), (71, "worm_wheel", []), (72, "worm_gear", [])]
    links += [("assembly", [("assembly", 12), ("part", 71)])]
    links += [("stage", [("stage", 70), ("gear_1", 72), ("gear_2", 71)])]
    path = put(tmp_path, xml(parts, links))
    assert case_of(path, 1)[0].torques == pytest.approx([12.0], rel=1e-13)
    assert "operating.torque: got nothing" in refused(path, 2)


def test_a_planetary_stage_takes_what_it_takes(tmp_path: Path) -> None:
    parts, links = two_stages()
    parts += [(80, "planetary_stage", []), (81, "planet_carrier", [])]
    links += [("central_shaft", [("planetary_stage", 80), ("shaft", 13)])]
    path = put(tmp_path, xml(parts, links))
    assert case_of(path, 2)[0].torques == pytest.approx([36.0], rel=1e-13)
    links += [("assembly", [("assembly", 81), ("part", 12)])]
    path = put(tmp_path, xml(parts, links))
    assert case_of(path, 1)[0].torques == pytest.approx([12.0], rel=1e-13)
    assert "operating.torque: got nothing" in refused(path, 2)


def test_a_load_case_where_the_other_gear_drives_is_told(tmp_path: Path) -> None:
    loads = [
        [(31, "external_load", [("torque_around_u_axis", "N m", torque)])]
        for torque in (-5.0, 24.0, 12.0)
    ]
    case, found = case_of(put(tmp_path, xml(*two_stages(), loads=loads)), 1)
    assert case.pair.pinion.teeth == 20
    assert case.torques == pytest.approx([24.0, 12.0], rel=1e-13)
    assert [1.0] in [numbers(one.partition(":")[0]) for one in found.unused]


def test_lengths_of_a_tool_are_in_its_modules(tmp_path: Path) -> None:
    parts, links = one_stage()
    rows = [("addendum_reference_profile", "mm", 3.25), ("tip_radius", "mm", 0.75)]
    parts = replaced(
        parts, 17, *rows, drop=("addendum_coefficient_reference_profile", "tip_radius_factor")
    )
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.rack.dedendum == pytest.approx(1.3, rel=1e-13)
    assert case.pair.pinion.rack.fillet_radius == pytest.approx(0.3, rel=1e-13)
