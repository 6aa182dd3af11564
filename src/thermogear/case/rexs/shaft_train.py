"""Shafts and bearings of a REXS stage: sections, places, types, as far as the file has them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

from thermogear.base.errors import InputError
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.lines import DERIVED, READ
from thermogear.case.rexs.model import Component
from thermogear.shafts.bearings.catalogue import catalogue_bearing

RIGID, STIFF = 1e12, 1e10
"""A radial stiffness [N/m] from which a file means a rigid bearing, and what such one has here."""
_GAP = 1e-7
"""Sections [m] may miss each other by as much."""


@dataclass(frozen=True)
class _Found:
    """A shaft as a case holds it: ``rows`` of its table and of its bearings' with their notes."""

    rows: list[tuple[str, object, str, str]]
    bearings: list[list[tuple[str, object, str, str]]]
    used: list[Component]


def train_lines(reader: Reader, made: Draft) -> None:
    """Put both shafts and their bearings; what is missing is said, and then neither is put."""
    of_gear = gearbox.shafts_of_gears(reader.model)
    shafts = [reader.model.at(of_gear.get(gear.id)) for _, gear in made.both]
    if not any(one is not None and _sections(reader, one) for one in shafts):
        return  # a file without shafts' sections says nothing of them
    turned = _against(reader, shafts)
    both = []
    for (name, gear), shaft, mirror in zip(made.both, shafts, (False, turned), strict=True):
        try:
            if shaft is None:
                raise InputError(f"{name}'s shaft", "nothing")
            both.append(_shaft(reader, name, gear, shaft, mirror=mirror))
        except InputError as error:
            made.unused.append(f"shafts and bearings: {error}")
            return
    number = 0
    for place, one in enumerate(both):
        for key, value, origin, note in one.rows:
            made.put(f"shafts[{place}].{key}", value, origin, note)
        for bearing in one.bearings:
            for key, value, origin, note in bearing:
                made.put(f"bearings[{number}].{key}", value, origin, note)
            number += 1
        made.train += one.used


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
            u = _place_of(reader, shaft, gear, "u_coordinate_on_shaft")
            under = [one for one in _pieces(reader, parts) if one[0] <= u <= one[0] + one[1]]
            if not under:
                raise InputError(shaft.called, f"no section at {_mm(u)}, where the gear is")
            diameter = 1e-3 * float(under[0][2]["diameter"].removesuffix(" mm"))
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


def without_train(made: Draft, error: InputError) -> None:
    """Take shafts and bearings out again, with what was wrong with them."""
    made.lines = [one for one in made.lines if not one.path.startswith(("shafts[", "bearings["))]
    made.train = []
    made.unused.append(f"shafts and bearings: {error}")


def _against(reader: Reader, shafts: list[Component | None]) -> bool:
    """Whether the u axes of both shafts point against each other."""
    axes = [reader.vector(one, "u_axis_vector") for one in shafts]
    if axes[0] is None or axes[1] is None:
        return False
    return sum(a * b for a, b in zip(axes[0], axes[1], strict=True)) < 0.0


def _sections(reader: Reader, shaft: Component) -> list[Component]:
    return [
        part
        for whole, part in gearbox.assembled(reader.model)
        if whole.id == shaft.id and part.type == "shaft_section"
    ]


def _shaft(reader: Reader, name: str, gear: Component, shaft: Component, *, mirror: bool) -> _Found:
    """The shaft from its least u on; with ``mirror`` from its greatest."""
    parts = _sections(reader, shaft)
    pieces = _pieces(reader, parts)
    if not pieces:
        raise InputError(f"{shaft.called}", "no section", allowed="one or more")
    for one, following in pairwise(pieces):
        if abs(one[0] + one[1] - following[0]) > _GAP:
            raise InputError(
                f"{shaft.called}",
                f"sections that meet at {_mm(one[0] + one[1])} and {_mm(following[0])}",
                allowed="sections one after the other",
            )
    first, total = pieces[0][0], sum(one[1] for one in pieces)

    def place(u: float) -> str:
        return _mm(total - (u - first) if mirror else u - first)

    cones = ", cones as cylinders of their mean diameter" if any(one[3] for one in pieces) else ""
    ways = ", its u axis turned around" if mirror else ""
    tables = [one[2] for one in pieces]
    rows: list[tuple[str, object, str, str]] = [
        ("gear", name, READ, shaft.called),
        (
            "sections",
            tables[::-1] if mirror else tables,
            DERIVED if cones or mirror else READ,
            f"shaft_section{cones}{ways}",
        ),
    ]
    centre = _place_of(reader, shaft, gear, "u_coordinate_on_shaft")
    rows.append(("gear_position", place(centre), DERIVED, f"middle of {gear.called} on its shaft"))
    bearings, used = [], [*parts]
    for bearing in _bearings(reader, shaft):
        u = _place_of(reader, shaft, bearing, "u_coordinate_on_shaft_inner_side")
        head: list[tuple[str, object, str, str]] = [
            ("shaft", name, READ, bearing.called),
            ("position", place(u), DERIVED, "its place on the shaft"),
        ]
        bearings.append(head + _law(reader, bearing))
        used.append(bearing)
    if len(bearings) < 2:
        raise InputError(
            shaft.called,
            f"{len(bearings) or 'no'} radial bearing{'s' * (len(bearings) != 1)} in the casing",
            allowed="two or more",
        )
    return _Found(rows, bearings, used)


def _pieces(
    reader: Reader, parts: list[Component]
) -> list[tuple[float, float, dict[str, str], bool]]:
    """Start u and length [m], sizes and whether it is a cone, of all sections along the shaft."""
    found = []
    at = 0.0
    for part in parts:
        length = _needed(reader, part, "length")
        start = reader.number(part, "u_coordinate_on_shaft")
        at = at if start is None else start.si
        sizes, cone = _sizes(reader, part)
        found.append((at, length, {"length": _mm(length), **sizes}, cone))
        at += length
    return sorted(found, key=lambda one: one[0])


def _sizes(reader: Reader, part: Component) -> tuple[dict[str, str], bool]:
    """Diameters of a section, and whether it is a cone."""
    outer = _needed(reader, part, "outer_diameter_begin")
    end = reader.number(part, "outer_diameter_end")
    inner = reader.number(part, "inner_diameter_begin")
    inner_end = reader.number(part, "inner_diameter_end")
    last = outer if end is None else end.si
    hole = 0.0 if inner is None else inner.si
    hole_last = hole if inner_end is None else inner_end.si
    found = {"diameter": _mm(0.5 * (outer + last))}
    if hole + hole_last > 0.0:
        found["inner_diameter"] = _mm(0.5 * (hole + hole_last))
    return found, outer != last or hole != hole_last


def _bearings(reader: Reader, shaft: Component) -> list[Component]:
    """Radial bearings between a shaft and the casing, in the file's order."""
    found = []
    for inner, outer, by in gearbox.sides(reader.model):
        if "bearing" not in by.type or inner.id != shaft.id or outer.type != "gear_casing":
            continue
        if reader.truth(by, "radial_force_absorption") is not False:
            found.append(by)
    return found


def _place_of(reader: Reader, shaft: Component, part: Component, name: str) -> float:
    """u [m] of a part on its shaft: by the support vectors, which are in the middle, else read."""
    points = [reader.vector(one, "support_vector") for one in (shaft, part)]
    axis = reader.vector(shaft, "u_axis_vector") or (1.0, 0.0, 0.0)
    origins = {reader.words(one, "reference_component_for_position") for one in (shaft, part)}
    size = sum(a * a for a in axis) ** 0.5
    if points[0] is not None and points[1] is not None and len(origins) == 1 and size > 0.0:
        apart = [b - a for a, b in zip(points[0], points[1], strict=True)]
        return float(f"{sum(a * b for a, b in zip(apart, axis, strict=True)) / size:.12g}")
    return _needed(reader, part, name)


def _law(reader: Reader, bearing: Component) -> list[tuple[str, object, str, str]]:
    """Type or stiffness of a bearing; InputError where the file has neither that is known."""
    name = reader.words(bearing, "catalogue_designation")
    if name:
        try:
            known = catalogue_bearing(name).designation
        except InputError:
            known = ""
        if known:
            rows: list[tuple[str, object, str, str]] = [
                ("type", known, READ, f"catalogue_designation {name[:80]}")
            ]
            play = reader.number(bearing, "operating_radial_bearing_clearance")
            if play is not None:
                rows.append(("play", play.text, READ, "operating_radial_bearing_clearance"))
                rows.append(("shaft_interference", "0 um", DERIVED, "that clearance is mounted"))
            return rows
    stiff = reader.number(bearing, "radial_stiffness")
    if stiff is not None and stiff.si >= RIGID:
        if bearing.type == "concept_bearing":
            text = f"{plain(STIFF)} N/m"
            return [("stiffness", text, DERIVED, f"{stiff.text} in the file is rigid")]
    elif stiff is not None and stiff.si >= 1.0:
        return [("stiffness", stiff.text, READ, "radial_stiffness")]
    raise InputError(
        bearing.called,
        repr(name) if name else "no type",
        allowed="a type of the catalogue, or a radial_stiffness",
    )


def _needed(reader: Reader, part: Component, name: str) -> float:
    found = reader.number(part, name)
    if found is None:
        raise InputError(f"{part.called}.{name}", "nothing", why="needed")
    return found.si


def _mm(length: float) -> str:
    return f"{plain(float(f'{1e3 * length:.12g}'))} mm"
