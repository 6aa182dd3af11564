"""Shafts and bearings out of REXS files, and what happens where a file lacks them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from own_rexs import Link, Part, Row, case_of, json_text, one_stage, put, replaced, xml
from thermogear.shafts.bearings.laws import ElementLaw, LinearLaw


def section(start: float, length: float, diameter: float, *more: Row) -> list[Row]:
    return [
        ("u_coordinate_on_shaft", "mm", start),
        ("length", "mm", length),
        ("outer_diameter_begin", "mm", diameter),
        ("outer_diameter_end", "mm", diameter),
        *more,
    ]


def ball(at: float, name: str = "6205", *more: Row) -> list[Row]:
    return [
        ("catalogue_designation", "none", name),
        ("u_coordinate_on_shaft_inner_side", "mm", at),
        ("radial_stiffness", "N / m", 1e15),
        *more,
    ]


CATALOGUE = "rolling_bearing_with_catalog_geometry"


def with_shafts(version: str = "1.7") -> tuple[list[Part], list[Link]]:
    """The stage of own_rexs on a stepped and a plain shaft, three types and one stiffness."""
    parts, links = one_stage(version)
    parts = replaced(parts, 7, ("u_coordinate_on_shaft", "mm", 60.0))
    parts = replaced(parts, 9, ("u_coordinate_on_shaft", "mm", 50.0))
    parts += [
        (41, "shaft_section", section(100.0, 20.0, 25.0)),
        (40, "shaft_section", section(0.0, 100.0, 30.0, ("inner_diameter_begin", "mm", 10.0))),
        (42, "shaft_section", section(0.0, 110.0, 25.0)),
        (51, CATALOGUE, ball(10.0, "6206-2Z")),
        (
            52,
            CATALOGUE,
            ball(110.0, "6205", ("operating_radial_bearing_clearance", "mum", 8.0)),
        ),
        (
            53,
            "concept_bearing",
            [("u_coordinate_on_shaft_inner_side", "mm", 8.0), ("radial_stiffness", "N / m", 3e8)],
        ),
        (54, CATALOGUE, ball(100.0)),
        (55, CATALOGUE, [*ball(70.0), ("radial_force_absorption", "none", False)]),
    ]
    links += [("assembly", [("assembly", 4), ("part", 40), ("part", 41)])]
    links += [("assembly", [("assembly", 5), ("part", 42)])]
    for bearing, shaft in ((51, 4), (52, 4), (53, 5), (54, 5), (55, 5)):
        links.append(("side", [("assembly", bearing), ("inner_part", shaft), ("outer_part", 2)]))
    return parts, links


@pytest.mark.parametrize("version", ["1.0", "1.4", "1.7", "2.0.0"])
@pytest.mark.parametrize("text", [xml, json_text])
def test_sections_and_bearings_become_a_train(version: str, text: Any, tmp_path: Path) -> None:
    case, found = case_of(put(tmp_path, text(*with_shafts(version), version)))
    plan = case.train
    assert plan is not None
    assert [one.length for one in plan.shafts] == pytest.approx([0.12, 0.11])
    assert [one.gear_position for one in plan.shafts] == pytest.approx([0.06, 0.05])
    assert plan.shafts[0].sections[0].inner_diameter == pytest.approx(0.01)
    assert [one.position for one in plan.bearings] == pytest.approx([0.01, 0.11, 0.008, 0.1])
    names = [one.rolling.designation for one in plan.bearings if one.rolling is not None]
    assert names == ["6206", "6205", "6205"]
    built = plan.drive_train(pair=case.pair).bearings
    assert isinstance(built[1].law, ElementLaw)
    assert built[1].law.clearance == pytest.approx(4e-6)
    assert isinstance(built[2].law, LinearLaw)
    assert built[2].law.stiffness_matrix[0][0] == 3e8
    assert not [line for line in found.unused if line.startswith(("shafts", "shaft_section"))]


def test_places_count_along_one_axis_where_the_shafts_point_against_each_other(
    tmp_path: Path,
) -> None:
    parts, links = with_shafts()
    for shaft, way in ((4, 1.0), (5, -1.0)):
        parts = replaced(parts, shaft, ("u_axis_vector", "mm", [way, 0.0, 0.0]))
    parts = replaced(parts, 4, ("rotational_speed", "1 / min", 1450.0))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.train is not None
    assert case.train.shafts[1].gear_position == pytest.approx(0.06)
    assert [one.position for one in case.train.bearings[2:]] == pytest.approx([0.102, 0.01])


def test_support_vectors_go_before_coordinates(tmp_path: Path) -> None:
    parts, links = with_shafts()
    for part, at in ((4, 100.0), (7, 165.0)):
        parts = replaced(parts, part, ("support_vector", "mm", [at, 0.0, 0.0]))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.train is not None
    assert case.train.shafts[0].gear_position == pytest.approx(0.065)


def test_a_cone_is_a_cylinder_of_its_mean_diameter(tmp_path: Path) -> None:
    parts, links = with_shafts()
    parts = replaced(parts, 42, ("outer_diameter_end", "mm", 27.0))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.train is not None
    assert case.train.shafts[1].sections[0].outer_diameter == pytest.approx(0.026)


@pytest.mark.parametrize(
    ("part", "row", "said"),
    [
        (54, ("catalogue_designation", "none", "K 45x52x18"), "got 'K 45x52x18'; allowed a type"),
        (54, ("u_coordinate_on_shaft_inner_side", "mm", 300.0), "got 300 mm; allowed 0..110 mm"),
        (41, ("u_coordinate_on_shaft", "mm", 105.0), "sections that meet at 100 mm and 105 mm"),
        (40, ("outer_diameter_begin", "mm", 90.0), "allowed <= "),
        (54, ("radial_force_absorption", "none", False), "got 1 radial bearing in the casing"),
    ],
)
def test_what_no_train_comes_of_is_said_and_the_gears_stay(
    part: int, row: Row, said: str, tmp_path: Path
) -> None:
    parts, links = with_shafts()
    case, found = case_of(put(tmp_path, xml(replaced(parts, part, row), links)))
    assert case.train is None
    lines = [one for one in found.unused if one.startswith("shafts and bearings: ")]
    assert len(lines) == 1
    assert said in lines[0]


def test_a_rigid_concept_bearing_is_very_stiff(tmp_path: Path) -> None:
    parts, links = with_shafts()
    parts = replaced(parts, 53, ("radial_stiffness", "N / m", 1e20))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.train is not None
    law = case.train.bearings[2].law
    assert isinstance(law, LinearLaw)
    assert law.stiffness_matrix[0][0] == 1e10


def test_the_section_under_a_gear_is_its_bore(tmp_path: Path) -> None:
    """30 mm under the pinion, 25 mm under the wheel; bearings are not asked for."""
    parts, links = with_shafts()
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert [g.bore_radius for g in (case.pair.pinion, case.pair.wheel)] == [0.015, 0.0125]
    line = 'bore_radius = "15 mm"   # derived: half the diameter of shaft 4 under the gear'
    assert line in found.text.splitlines()
    alone = [one for one in links if one[0] != "side"]
    case, found = case_of(put(tmp_path, xml(parts, alone)))
    assert case.train is None
    assert [g.bore_radius for g in (case.pair.pinion, case.pair.wheel)] == [0.015, 0.0125]
    assert not [line for line in found.unused if "shaft_section" in line]


def test_a_pinion_cut_from_its_shaft_or_beside_the_sections_keeps_the_default(
    tmp_path: Path,
) -> None:
    parts, links = with_shafts()
    thick = replaced(parts, 40, ("outer_diameter_begin", "mm", 60.0))
    thick = replaced(thick, 40, ("outer_diameter_end", "mm", 60.0))
    thick = replaced(thick, 9, ("u_coordinate_on_shaft", "mm", 150.0))
    case, found = case_of(put(tmp_path, xml(thick, links)))
    root = case.pair.pinion.root_radius
    assert case.pair.pinion.bore_radius == pytest.approx(0.3 * root)
    lost = [line for line in found.unused if line.startswith("bore of")]
    assert lost == [
        f"bore of the pinion: shaft 4: got 60 mm; allowed < {2e3 * root:.12g} mm, the root circle",
        "bore of the wheel: shaft 5: got no section at 150 mm, where the gear is",
    ]


def test_a_module_stated_in_inches_is_read(tmp_path: Path) -> None:
    """A tenth of an inch; the axes of 2.54/2.5 times the distance."""
    parts, links = one_stage()
    for gear in (7, 9):
        parts = replaced(parts, gear, ("normal_module", "in", 0.1))
    parts = replaced(parts, 3, ("center_distance", "mm", 80.9 * 2.54 / 2.5))
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.module == pytest.approx(2.54e-3, rel=1e-15)
    line = 'module = "2.54 mm"   # read: normal_module of cylindrical_gear 7, 0.1 in'
    assert line in found.text.splitlines()
