"""Bores out of the shafts of REXS files, and what happens where a file lacks them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from own_rexs import Link, Part, Row, case_of, json_text, one_stage, put, replaced, xml


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
def test_shafts_and_bearings_are_listed_as_not_used(
    version: str, text: Any, tmp_path: Path
) -> None:
    case, found = case_of(put(tmp_path, text(*with_shafts(version), version)))
    assert case.train is None
    assert f"{CATALOGUE}: 4" in found.unused
    assert "concept_bearing: 1" in found.unused


def test_support_vectors_go_before_coordinates(tmp_path: Path) -> None:
    """The pinion at 105 mm of its shaft by the vectors, at 60 mm by the coordinate."""
    parts, links = with_shafts()
    for part, at in ((4, 100.0), (7, 205.0)):
        parts = replaced(parts, part, ("support_vector", "mm", [at, 0.0, 0.0]))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.pinion.bore_radius == 0.0125


def test_under_a_cone_counts_its_mean_diameter(tmp_path: Path) -> None:
    parts, links = with_shafts()
    parts = replaced(parts, 42, ("outer_diameter_end", "mm", 27.0))
    case, _ = case_of(put(tmp_path, xml(parts, links)))
    assert case.pair.wheel.bore_radius == pytest.approx(0.013)


def test_the_section_under_a_gear_is_its_bore(tmp_path: Path) -> None:
    """30 mm under the pinion, 25 mm under the wheel."""
    parts, links = with_shafts()
    case, found = case_of(put(tmp_path, xml(parts, links)))
    assert [g.bore_radius for g in (case.pair.pinion, case.pair.wheel)] == [0.015, 0.0125]
    line = 'bore_radius = "15 mm"   # derived: half the diameter of shaft 4 under the gear'
    assert line in found.text.splitlines()
    hollow = "shaft_section: 1 attribute: inner_diameter_begin"
    assert [line for line in found.unused if "shaft_section" in line] == [hollow]


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
