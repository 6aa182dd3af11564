"""Small REXS models of our own, for every version and container."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import pytest

from thermogear import InputError, read_rexs
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.rexs.importing import Imported, imported

Row = tuple[str, str | None, Any]
Part = tuple[int, str, list[Row]]
Link = tuple[str, list[tuple[str, int]]]

ANGLES = {"1.0": "°", "1.1": "°", "1.2": "°", "1.3": "°"}


def angle(version: str) -> str:
    return ANGLES.get(version, "deg")


def stress(version: str) -> str:
    return "MPa" if version.startswith("2") else "N / mm^2"


def flank(version: str) -> str:
    return "flank_geometry" if version in ("1.0", "1.1", "1.2") else "cylindrical_gear_flank"


def gear_rows(version: str, teeth: int, *, helix: float = 0.0, width: float = 22.5) -> list[Row]:
    return [
        ("number_of_teeth", "none", teeth),
        ("normal_module", "mm", 2.5),
        ("face_width", "mm", width),
        ("helix_angle_reference_diameter", angle(version), helix),
    ]


def flank_rows(version: str, shift: float) -> list[Row]:
    return [
        ("normal_pressure_angle", angle(version), 20.0),
        ("addendum_modification_coefficient", "none", shift),
    ]


def steel(version: str) -> list[Row]:
    return [
        ("elastic_modulus", stress(version), 205000.0),
        ("poisson_ratio", "none", 0.29),
        ("density", "kg / dm^3", 7.8),
        ("thermal_expansion_coefficient_plus", "1e-6 / C", 12.5),
        ("thermal_conductivity", "W / (m K)", 44.0),
        ("thermal_capacity", "J / (kg K)", 460.0),
        ("material_designation", "none", "my steel"),
    ]


def one_stage(version: str = "1.7") -> tuple[list[Part], list[Link]]:
    """21:43 teeth, module 2.5 mm, x = 0.2 and 0.1; gear_1 drives with 1450 rpm and 30 N m."""
    old = version in ("1.0", "1.1", "1.2")
    parts: list[Part] = [
        (1, "gear_unit", [("operating_time", "h", 100.0)]),
        (2, "gear_casing", [("temperature_lubricant", "C", 65.0)]),
        (3, "cylindrical_stage", [("center_distance", "mm", 80.9)]),
        (
            4,
            "shaft",
            [("rotational_speed", "1 / min", 1450.0), ("defines_speed", "none", True)],
        ),
        (5, "shaft", []),
        (7, "cylindrical_gear", gear_rows(version, 21)),
        (9, "cylindrical_gear", gear_rows(version, 43, width=20.0)),
        (
            11,
            "external_load",
            [
                ("torque_around_u_axis", "N m", 30.0),
                ("defines_torque", "none", True),
                ("transmits_torque", "none", True),
            ],
        ),
        (12, "external_load", [("transmits_torque", "none", True)]),
        (13, flank(version), flank_rows(version, 0.2)),
        (14, flank(version), flank_rows(version, 0.2)),
        (15, flank(version), flank_rows(version, 0.1)),
        (16, flank(version), flank_rows(version, 0.1)),
        (
            17,
            "rack_shaped_tool",
            [
                ("addendum_coefficient_reference_profile", "none", 1.3),
                (
                    "tip_corner_radius_factor_reference_profile"
                    if version.startswith("2")
                    else "tip_radius_factor",
                    "none",
                    0.3,
                ),
            ],
        ),
        (18, "material", steel(version)),
        (
            19,
            "lubricant",
            [
                ("viscosity_at_40_degree_celsius", "mm^2 / s", 95.0),
                ("viscosity_at_100_degree_celsius", "mm^2 / s", 11.0),
                ("density_at_15_degree_celsius", "kg / dm^3", 0.885),
                ("name", "none", "my oil"),
            ],
        ),
    ]
    links: list[Link] = [
        ("stage", [("stage", 3), ("gear_1", 7), ("gear_2", 9)]),
        ("assembly", [("assembly", 4), ("part", 7)]),
        ("assembly", [("part", 9), ("assembly", 5)]),
        ("assembly", [("assembly", 4), ("part", 11)]),
        ("assembly", [("assembly", 5), ("part", 12)]),
        ("flank", [("gear", 7), ("left", 13), ("right", 14)]),
        ("flank", [("right", 16), ("gear", 9), ("left", 15)]),
        ("reference", [("origin", 7), ("referenced", 18)]),
        ("reference", [("referenced", 18), ("origin", 9)]),
        ("reference", [("origin", 2), ("referenced", 19)]),
    ]
    if old:
        links += [("ordered_reference", [("origin", gear), ("referenced", 17)]) for gear in (7, 9)]
    else:
        links += [
            ("manufacturing_step", [("workpiece", one), ("tool", 17)]) for one in (13, 14, 15, 16)
        ]
    return parts, links


def two_stages() -> tuple[list[Part], list[Link]]:
    """20:60 and 25:50 in a row, 1200 rpm and 12 N m at the input, no load at the other end."""
    parts: list[Part] = [(1, "gear_unit", []), (2, "gear_casing", [])]
    links: list[Link] = []
    for stage, gears in ((3, (21, 22)), (4, (23, 24))):
        parts.append((stage, "cylindrical_stage", []))
        links.append(("stage", [("stage", stage), ("gear_1", gears[0]), ("gear_2", gears[1])]))
    for gear, teeth, shaft in ((21, 20, 11), (22, 60, 12), (23, 25, 12), (24, 50, 13)):
        rows: list[Row] = [
            ("number_of_teeth", "none", teeth),
            ("normal_module", "mm", 2.0),
            ("face_width", "mm", 15.0),
        ]
        parts.append((gear, "cylindrical_gear", rows))
        links.append(("assembly", [("assembly", shaft), ("part", gear)]))
    parts += [(shaft, "shaft", []) for shaft in (11, 12, 13)]
    parts = replaced(parts, 11, ("rotational_speed", "1 / min", 1200.0))
    parts.append((31, "external_load", [("torque_around_u_axis", "N m", 12.0)]))
    links.append(("assembly", [("assembly", 11), ("part", 31)]))
    return parts, links


# --- containers -----------------------------------------------------------------------------


def _text(value: Any) -> str:
    if isinstance(value, list):
        return f"<array>{''.join(f'<c>{_text(one)}</c>' for one in value)}</array>"
    return str(value).lower() if isinstance(value, bool) else escape(str(value))


def _rows(rows: list[Row]) -> str:
    return "".join(
        f"<attribute id={quoteattr(name)}"
        + ("" if unit is None else f" unit={quoteattr(unit)}")
        + f">{_text(value)}</attribute>"
        for name, unit, value in rows
    )


def _order(kind: str) -> str:
    return ' order="1"' if kind in ("manufacturing_step", "ordered_reference") else ""


def xml(
    parts: list[Part],
    links: list[Link],
    version: str = "1.7",
    loads: list[list[Part]] | None = None,
) -> str:
    relations = "".join(
        f'<relation id="{k}" type="{kind}"{_order(kind)}>'
        + "".join(f'<ref id="{found}" role="{role}" hint="x"/>' for role, found in refs)
        + "</relation>"
        for k, (kind, refs) in enumerate(links, start=1)
    )

    def components(of: list[Part]) -> str:
        return "".join(
            f'<component id="{found}" type="{kind}">{_rows(rows)}</component>'
            for found, kind, rows in of
        )

    cases = "".join(
        f'<load_case id="{k}">{components(of)}</load_case>' for k, of in enumerate(loads or [], 1)
    )
    spectrum = f'<load_spectrum id="1">{cases}</load_spectrum>' if loads else ""
    return (
        f'<?xml version="1.0" encoding="UTF-8"?><model version="{version}" applicationId="tests" '
        f'applicationVersion="1" date="2026-01-31T12:00:00+01:00">'
        f"<relations>{relations}</relations><components>{components(parts)}</components>"
        f"{spectrum}</model>"
    )


def _key(value: Any) -> str:
    if isinstance(value, list):
        return "floating_point_array"
    kinds = {bool: "boolean", int: "integer", float: "floating_point", str: "string"}
    return kinds[type(value)]


def _entry(row: Row) -> dict[str, Any]:
    name, unit, value = row
    return {"id": name, **({} if unit is None else {"unit": unit}), _key(value): value}


def json_text(
    parts: list[Part],
    links: list[Link],
    version: str = "1.7",
    loads: list[list[Part]] | None = None,
) -> str:
    def components(of: list[Part]) -> list[dict[str, Any]]:
        return [
            {"id": found, "type": kind, "attributes": [_entry(row) for row in rows]}
            for found, kind, rows in of
        ]

    relations = [
        {
            "id": k,
            "type": kind,
            **({"order": 1} if _order(kind) else {}),
            "refs": [{"id": found, "role": role} for role, found in refs],
        }
        for k, (kind, refs) in enumerate(links, start=1)
    ]
    model: dict[str, Any] = {
        "version": version,
        "applicationId": "tests",
        "applicationVersion": "1",
        "date": "2026-01-31T12:00:00+01:00",
        "relations": relations,
        "components": components(parts),
    }
    if loads:
        cases = [{"id": k, "components": components(of)} for k, of in enumerate(loads, 1)]
        model["load_spectrum"] = {"id": 1, "load_cases": cases}
    return json.dumps({"model": model}, ensure_ascii=False)


def put(folder: Path, text: str, name: str = "gearbox.rexs") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def replaced(parts: list[Part], found: int, *rows: Row, drop: tuple[str, ...] = ()) -> list[Part]:
    """``parts`` with rows of one component put, replaced or dropped."""
    new = []
    for part, kind, old in parts:
        if part == found:
            names = {row[0] for row in rows} | set(drop)
            new.append((part, kind, [row for row in old if row[0] not in names] + list(rows)))
        else:
            new.append((part, kind, old))
    return new


# --- what becomes of them -----------------------------------------------------------------


def case_of(path: Path, stage: int | None = None) -> tuple[GearCase, Imported]:
    found = imported(read_rexs(path), stage)
    return gear_case(load_case(found.text)), found


def refused(path: Path, stage: int | None = None) -> str:
    with pytest.raises(InputError) as error:
        imported(read_rexs(path), stage)
    assert "\n" not in str(error.value)
    return str(error.value)
