"""Tip and root relief of a gear's flanks, out of a REXS model.

A depth holds at its evaluation diameter, the tip where none is written; it starts at the datum
diameter or the datum (rolling) length. Along the line of action a diameter d lies at
rho = sqrt(d^2 - d_b^2)/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.rexs import gearbox
from thermogear.case.rexs.attributes import Reader, plain
from thermogear.case.rexs.draft import Draft, tightest
from thermogear.case.rexs.lines import DERIVED, Line
from thermogear.case.rexs.model import Component
from thermogear.case.units import read_quantity

_SHAPES = {"linear": "linear", "parabolic": "parabolic", "circular": "parabolic"}
"""Shapes of REXS as a case has them: an arc that leaves the involute along its tangent is a
parabola, but for (depth/length)^2."""


@dataclass(frozen=True)
class _Relief:
    """Amount at the end and length along the line of action [m], shape, and its component."""

    amount: float
    length: float
    shape: str
    source: Component

    @property
    def values(self) -> tuple[float, float, str]:
        return self.amount, self.length, self.shape


def relief_lines(
    reader: Reader,
    made: Draft,
    name: str,
    gear: Component,
    sense: float,
    basics: tuple[float, float],
) -> None:
    """The reliefs of the flank that carries, and of both where they are alike.

    ``sense`` of rotation about the gear's u axis, 0 where not known: the driving gear's leading
    and the driven gear's trailing flanks carry; the left flank is on the left seen along u with the
    tooth up, the trailing one of a gear that turns about +u.
    """
    flanks = gearbox.flanks_of(reader.model, gear)
    if not flanks:
        return
    carries = ""
    if sense:
        leading = "right" if sense > 0.0 else "left"
        trailing = "left" if sense > 0.0 else "right"
        carries = leading if name == "pinion" else trailing
    for end in ("tip", "root"):
        found = {
            side: _relief(reader, made, name, gear, flank, end, basics)
            for side, flank in flanks.items()
        }
        _put(made, name, end, found, carries)


def _put(made: Draft, name: str, end: str, found: dict[str, _Relief | None], carries: str) -> None:
    both = list(found.values())
    alike = len({one.values if one else None for one in both}) == 1
    chosen, flank = both[0], "both"
    if not alike or len(both) < 2:
        if not carries:
            if any(both):
                made.unused.append(
                    f"{end} relief of the {name}: its flanks differ and no speed says which carries"
                )
            return
        chosen, flank = found.get(carries), "drive"
        other = next((one for side, one in found.items() if side != carries and one), None)
        if other is not None:
            made.unused.append(f"{other.source.called}: on the {name}'s flank that does not carry")
    if chosen is None:
        return
    path = f"gears.{name}.{end}_relief"
    source = chosen.source.called
    values = (
        ("amount", f"{plain(round(1e6 * chosen.amount, 9))} um"),
        ("length", f"{plain(round(1e3 * chosen.length, 12))} mm"),
        ("shape", chosen.shape),
        ("flank", flank),
    )
    made.lines += [Line(f"{path}.{key}", value, DERIVED, source) for key, value in values]


def _relief(
    reader: Reader,
    made: Draft,
    name: str,
    gear: Component,
    flank: Component,
    end: str,
    basics: tuple[float, float],
) -> _Relief | None:
    """The relief of one flank; None without one, or where it cannot be one of ours (said)."""
    parts = reader.model.referenced(flank.id, f"{end}_relief")
    if not parts:
        return None
    one = parts[0]
    depth = reader.number(one, f"{end}_relief_depth")
    if depth is None or depth.si == 0.0:
        return None
    shape = reader.words(one, "shape_of_relief").lower() or "linear"
    try:
        if shape not in _SHAPES:
            raise InputError(
                f"{one.called}.shape_of_relief", repr(shape[:40]), allowed=" | ".join(_SHAPES)
            )
        shape = _SHAPES[shape]
        limit = _end(reader, made, name, gear, end, basics)
        start = _start(reader, one, gear, end, basics)
        evaluated = reader.number(one, f"{end}_relief_evaluation_reference")
        at = limit if evaluated is None else _rolled(reader, gear, evaluated.si, basics, one)
        length, reached = abs(limit - start), abs(at - start)
        if reached <= 1e-9 or length <= 1e-9:
            raise InputError(f"{one.called}", "a relief without a length", allowed="> 0 mm")
        share = length / reached
        amount = depth.si * (share if shape == "linear" else share * share)
        bounds.RELIEF_AMOUNT.require(f"{one.called}.{end}_relief_depth", amount)
        bounds.RELIEF_LENGTH.require(f"{one.called}.{end}_relief length", length)
    except InputError as error:
        said = str(error)
        if said not in made.unused:
            made.unused.append(said)
        return None
    return _Relief(amount, length, shape, one)


def _rolled(
    reader: Reader, gear: Component, diameter: float, basics: tuple[float, float], one: Component
) -> float:
    """rho [m] of a diameter [m]."""
    module, angle = basics
    base = module * (reader.whole(gear, "number_of_teeth") or 0) * math.cos(angle)
    if diameter < base:
        raise InputError(
            f"{one.called} diameter", f"{1e3 * diameter:.6g} mm", allowed=f">= {1e3 * base:.6g} mm"
        )
    return 0.5 * math.sqrt((diameter - base) * (diameter + base))


def _start(
    reader: Reader, one: Component, gear: Component, end: str, basics: tuple[float, float]
) -> float:
    diameter = reader.number(one, f"{end}_relief_datum_diameter")
    if diameter is not None:
        return _rolled(reader, gear, diameter.si, basics, one)
    length = reader.number(one, f"{end}_relief_datum_length")
    if length is None:
        raise InputError(f"{one.called}", "no datum diameter and no datum length", allowed="one")
    return length.si


def _end(
    reader: Reader, made: Draft, name: str, gear: Component, end: str, basics: tuple[float, float]
) -> float:
    """rho [m] where the relief is deepest: the tip form circle, or where the other's ends."""
    module, angle = basics
    values = {one.path: one.value for one in made.lines}

    def tip(of: str, component: Component) -> float:
        given = reader.number(component, "tip_diameter")
        teeth = reader.whole(component, "number_of_teeth") or 0
        shift = float(values.get(f"gears.{of}.profile_shift", 0.0))
        sharp = module * (teeth + 2.0 + 2.0 * shift) if given is None else given.si
        chamfer = read_quantity(values.get(f"gears.{of}.tip_chamfer", "0 mm"), "length")
        return _rolled(reader, component, sharp - 2.0 * chamfer, basics, component)

    if end == "tip":
        return tip(name, gear)
    other, component = next(one for one in made.both if one[0] != name)
    given = reader.number(made.stage.component, "center_distance")
    apart = given.si if given is not None else tightest(made, module=module, angle=angle)
    teeth = sum(reader.whole(one, "number_of_teeth") or 0 for _, one in made.both)
    base = 0.5 * module * teeth * math.cos(angle)
    if not apart > base:
        raise InputError("center_distance", "none above the base circles", allowed="> 0 mm")
    return math.sqrt((apart - base) * (apart + base)) - tip(other, component)
