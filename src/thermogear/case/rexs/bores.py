"""Bores of a REXS stage: the sections of the shafts under its gears."""

from __future__ import annotations

from thermogear.base.errors import InputError
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.lines import DERIVED
from thermogear.case.rexs.model import Component


def bore_lines(reader: Reader, made: Draft, module: float) -> None:
    """Put the bores: the diameter of the shaft's section under each gear, below its root circle."""
    values = {one.path: one.value for one in made.lines}
    of_gear = gearbox.shafts_of_gears(reader.model)
    for name, gear in made.both:
        shaft = reader.model.at(of_gear.get(gear.id))
        parts = [] if shaft is None else _sections(reader, shaft)
        if shaft is None or not parts:
            continue
        cut = values.get(f"gears.{name}.rack.dedendum", values.get("gears.rack.dedendum", 1.25))
        depth = cut - values.get(f"gears.{name}.profile_shift", 0.0)
        root = module * (values[f"gears.{name}.teeth"] - 2.0 * depth)
        try:
            u = _place_of(reader, shaft, gear)
            under = [one for one in _pieces(reader, parts) if one[0] <= u <= one[0] + one[1]]
            if not under:
                raise InputError(shaft.called, f"no section at {_mm(u)}, where the gear is")
            diameter = under[0][2]
            if diameter >= root:
                raise InputError(
                    shaft.called, _mm(diameter), allowed=f"< {_mm(root)}, the root circle"
                )
        except InputError as error:
            made.unused.append(f"bore of the {name}: {error}")
            continue
        note = f"half the diameter of {shaft.called} under the gear"
        made.put(f"gears.{name}.bore_radius", _mm(0.5 * diameter), DERIVED, note)
        made.seats += parts


def _sections(reader: Reader, shaft: Component) -> list[Component]:
    return [
        part
        for whole, part in gearbox.assembled(reader.model)
        if whole.id == shaft.id and part.type == "shaft_section"
    ]


def _pieces(reader: Reader, parts: list[Component]) -> list[tuple[float, float, float]]:
    """Start u, length and mean diameter [m] of all sections along the shaft."""
    found = []
    at = 0.0
    for part in parts:
        length = _needed(reader, part, "length")
        start = reader.number(part, "u_coordinate_on_shaft")
        at = at if start is None else start.si
        first = _needed(reader, part, "outer_diameter_begin")
        last = reader.number(part, "outer_diameter_end")
        found.append((at, length, first if last is None else 0.5 * (first + last.si)))
        at += length
    return sorted(found, key=lambda one: one[0])


def _place_of(reader: Reader, shaft: Component, gear: Component) -> float:
    """u [m] of a gear on its shaft: by the support vectors, which are in the middle, else read."""
    points = [reader.vector(one, "support_vector") for one in (shaft, gear)]
    axis = reader.vector(shaft, "u_axis_vector") or (1.0, 0.0, 0.0)
    origins = {reader.words(one, "reference_component_for_position") for one in (shaft, gear)}
    size = sum(a * a for a in axis) ** 0.5
    if points[0] is not None and points[1] is not None and len(origins) == 1 and size > 0.0:
        apart = [b - a for a, b in zip(points[0], points[1], strict=True)]
        return float(f"{sum(a * b for a, b in zip(apart, axis, strict=True)) / size:.12g}")
    return _needed(reader, gear, "u_coordinate_on_shaft")


def _needed(reader: Reader, part: Component, name: str) -> float:
    found = reader.number(part, name)
    if found is None:
        raise InputError(f"{part.called}.{name}", "nothing", why="needed")
    return found.si


def _mm(length: float) -> str:
    return f"{plain(float(f'{1e3 * length:.12g}'))} mm"
