"""The few numbers of a gear case that one turns to understand it: where they stand, how far.

A dial is one quantity of the first operating point with the fields of the case file that it means.
Turning it is putting text into these fields, as ``--set`` does, so that a dialled case is a case
like any other.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from thermogear.base.errors import InputError, nearest
from thermogear.base.toml import held, literal
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import STILL
from thermogear.case.case import GearCase
from thermogear.case.fault_schema import FaultTable
from thermogear.case.flank_schema import PARTS
from thermogear.case.thermal_state import HOT
from thermogear.gears.tooth_damage import way_across

Changes = tuple[tuple[str, str], ...]
"""Dotted fields of the file and what is put there; nothing: the field is left out."""

GIVEN = (
    "temperatures.pinion_addendum", "temperatures.wheel_addendum",
    "temperatures.pinion_bore", "temperatures.pinion_bore_below_addendum",
    "temperatures.wheel_bore", "temperatures.wheel_bore_below_addendum",
    "temperatures.housing", "temperatures.housing_below_addendum",
    "oil.temperature", "oil.temperature_below_addendum",
)  # fmt: skip
"""Fields that give a temperature which the heat balance could compute."""


@dataclass(frozen=True)
class _Kind:
    """What a dial is, before anything is computed of it."""

    name: str
    title: str
    unit: str
    fields: tuple[str, ...]
    held: str = ""


@dataclass(frozen=True, kw_only=True)
class Dial(_Kind):
    """A quantity one turns, in ``unit``: ``value`` now, from ``low`` to ``high`` by ``step``.

    ``fields`` are those of the case file that it puts; ``held`` says why it cannot be turned now.
    """

    value: float
    low: float
    high: float
    step: float

    @property
    def row(self) -> dict[str, Any]:
        """For a page; the value None where the heat balance found none."""
        found = {one: getattr(self, one) for one in self.__dataclass_fields__}
        return found | {"value": self.value if math.isfinite(self.value) else None}


def _kinds(case: GearCase) -> dict[str, _Kind]:
    held = "the heat balance computes it" if case.computed else ""
    if not HOT.settled(case, case.models[0]):
        held = STILL["heat_not_settled"]
    below = not case.computed and _given(case, "temperatures.housing_below_addendum")
    housing = ("housing below the gears", "K") if below else ("housing temperature", "degC")
    field = "temperatures.housing_below_addendum" if below else "temperatures.housing"
    table = case.file.backlash
    kind = f"{table.extent}, {table.direction}" if table.value is not None else "total, normal"
    speed, torque = (
        f"pinion {name}"
        + (f" (the first of {len(row)}; turned, the only one)" if len(row) > 1 else "")
        for name, row in (("speed", case.speeds), ("torque", case.torques))
    )
    found = (
        _Kind("speed", speed, "rpm", ("operating.speed",)),
        _Kind("torque", torque, "N m", ("operating.torque",)),
        _Kind("gears", "gear temperature", "degC", GIVEN[:2], held),
        _Kind("housing", *housing, (field,), held),
        _Kind("backlash", f"cold backlash ({kind})", "mm", ("backlash.value",)),
        _Kind("damping", "damping ratio", "", ("dynamics.damping_ratio",)),
    )  # fmt: skip
    kinds = {kind.name: kind for kind in found}
    _, crack = _crack(case)
    title = f"crack of {crack.gear} tooth {crack.place + 1}, share of the way across its root"
    kinds["crack"] = _Kind("crack", title, "", ("faults",))
    if drawing(case) is not None:
        title = "pair of the class, its drawing (-1: all of them)"
        kinds["part"] = _Kind("part", title, "", ("flanks.drawing", "flanks.teeth"))
    return kinds


def drawing(case: GearCase) -> int | None:
    """Which drawing of its class a ``case`` is: -1 of a series, which is many; None of no drawing.

    None too where flanks are measured.
    """
    table = case.file.flanks
    if case.series > 1:
        return -1
    drawn = table is not None and table.teeth == "drawn" and not case.charts
    return table.drawing if table is not None and drawn else None


def dials(case: GearCase) -> list[Dial]:
    """The dials of the first operating point of ``case``, in the order of use.

    Temperatures are those of the case's first model; of a case whose temperatures the heat balance
    computes they are results, and ``held``.
    """
    at = case.operating_of(case.models[0])
    gears, housing = (
        float(np.ravel(one)[0]) - ZERO_CELSIUS
        for one in (at.temperatures.pinion_addendum, at.temperatures.housing)
    )
    kinds = _kinds(case)
    ends = _warm(housing)
    if kinds["housing"].unit == "K":
        rule = case.temperature_rule
        housing = 0.0 if rule is None else float(np.ravel(rule.housing.value)[0])
        ends = (-100.0, 200.0)
    speed, torque = float(case.speeds[0]) / RPM, float(case.torques[0])
    half, table = float(np.ravel(case.stated.half_backlash)[0]), case.file.backlash
    backlash = 2e3 * half if table.value is None else 1e3 * table.value
    zeta = case.damping_ratio
    values = {
        "speed": (speed, _wide(speed)),
        "torque": (torque, _wide(torque)),
        "gears": (gears, _warm(gears)),
        "housing": (housing, ends),
        "backlash": (backlash, (0.02 * backlash, 5.0 * backlash)),
        "damping": (zeta, (0.0, max(0.3, 2.0 * zeta))),
    }
    crack = _crack(case)[1]
    deep = (crack.depth or 0.0) / way_across(case.pair.gear(crack.gear), crack.slope)
    values["crack"] = (deep if crack.share is None else crack.share, (0.0, 0.5))
    every = [_dial(kinds[name], value, ends) for name, (value, ends) in values.items()]
    if (place := drawing(case)) is not None:
        high = float(max(parts_of(case) - 1, place))
        every.append(Dial(**vars(kinds["part"]), value=float(place), low=-1.0, high=high, step=1.0))
    return every


def parts_of(case: GearCase) -> int:
    """How many pairs its series has, also of a case that is one of them."""
    stated = None if case.file.flanks is None else case.file.flanks.parts
    return stated if stated and stated > 1 else PARTS


def turned(case: GearCase, values: Mapping[str, float]) -> Changes:
    """What turning dials of ``case`` to ``values`` (in their units) puts into its file.

    Raises InputError for an unknown dial, for one that is held, and for a number that is none.
    """
    known = _kinds(case)
    found: list[tuple[str, str]] = []
    for name, value in values.items():
        if name not in known:
            raise InputError("dial", repr(name), fix=nearest(name, known))
        dial = known[name]
        if not math.isfinite(value):
            raise InputError(dial.fields[0], f"{value}", allowed="a finite number")
        if dial.held:
            raise InputError(
                dial.fields[0], f"{value:g} {dial.unit}", why=dial.held,
                fix="switch the heat balance off to turn it",
            )  # fmt: skip
        text = f"{_text(value)} {dial.unit}".strip()
        if name == "part":
            if value >= 0.0:
                found += [(dial.fields[0], text), (dial.fields[1], "drawn")]
            elif case.series == 1:
                left = [(field, "") for field in dial.fields]
                found += [*left, ("flanks.parts", f"{parts_of(case)}")]
        elif name == "crack":
            found.append((dial.fields[0], _cracked(case, value)))
        elif name == "backlash" and not _given(case, "backlash.value"):
            said = {"value": text, "direction": "normal", "extent": "total"}
            found.append(("backlash", literal(said)))
        else:
            found += [(field, text) for field in dial.fields]
    return tuple(found)


def balanced(case: GearCase, on: bool) -> Changes:
    """What puts the temperatures of ``case`` into the heat balance's hands, or takes them out.

    Taken out, the gears stay as hot as the balance has found them at the first operating point;
    bores, housing and oil keep their distance in kelvins from the pinion's teeth.
    """
    if on == case.computed:
        return ()
    if on:
        return tuple((field, "") for field in GIVEN if _given(case, field))
    HOT.require_settled(case, case.models[0])
    at = case.operating_of(case.models[0])
    body = at.temperatures
    first = {
        name: float(np.ravel(getattr(body, name))[0])
        for name in ("pinion_addendum", "wheel_addendum", "pinion_bore", "wheel_bore", "housing")
    }
    oil = float(np.ravel(at.oil_temperature)[0])
    tips = {n: round(first[n] - ZERO_CELSIUS, 2) for n in ("pinion_addendum", "wheel_addendum")}
    found = [(f"temperatures.{name}", f"{value!r} degC") for name, value in tips.items()]
    for name in ("pinion_bore", "wheel_bore", "housing"):
        own = "wheel_addendum" if name == "wheel_bore" else "pinion_addendum"
        found.append(
            (f"temperatures.{name}_below_addendum", f"{round(first[own] - first[name], 2)!r} K")
        )
    found.append(
        ("oil.temperature_below_addendum", f"{round(first['pinion_addendum'] - oil, 2)!r} K")
    )
    left = [(field, "") for field in GIVEN if _given(case, field)]
    return (*(one for one in left if one[0] not in dict(found)), *found)


def _text(value: float) -> str:
    """A number to the last bit, a whole one without its point."""
    return repr(float(value)).removesuffix(".0")


def _dial(kind: _Kind, value: float, ends: tuple[float, float]) -> Dial:
    low, high = ends
    step = 10.0 ** math.floor(math.log10(max(high - low, 1e-9) / 200.0))
    low, high = step * math.floor(low / step), step * math.ceil(high / step)
    return Dial(
        **vars(kind),
        value=float(f"{value:.10g}"),
        low=float(f"{low:.6g}"),
        high=float(f"{high:.6g}"),
        step=float(f"{step:.6g}"),
    )


def _wide(value: float) -> tuple[float, float]:
    return 0.05 * value, 5.0 * value


def _warm(celsius: float) -> tuple[float, float]:
    return (
        (-20.0, 250.0) if math.isfinite(celsius) and -20.0 <= celsius <= 250.0 else (-40.0, 400.0)
    )


def _given(case: GearCase, field: str) -> bool:
    """Whether the file itself says a field."""
    return held(case.data, field)[0] == len(field.split("."))


def _crack(case: GearCase) -> tuple[int, FaultTable]:
    """The first crack of the file and its place there; else one of no depth, pinion tooth 1."""
    for place, fault in enumerate(case.file.faults):
        if fault.kind == "crack":
            return place, fault
    return len(case.file.faults), FaultTable(kind="crack", gear="pinion", share=0.0)


def _cracked(case: GearCase, share: float) -> str:
    """The file's faults with the first crack at another ``share``, or one more."""
    rows: list[dict[str, Any]] = list(case.data.get("faults", []))
    place, fault = _crack(case)
    row = rows[place] if place < len(rows) else {"kind": fault.kind, "gear": fault.gear}
    row = {field: text for field, text in row.items() if field != "depth"} | {"share": share}
    return literal([*rows[:place], row, *rows[place + 1 :]])
