"""Accuracy class and backlash of a stage, out of a REXS model."""

from __future__ import annotations

import re

from thermogear.base.errors import InputError
from thermogear.case.rexs.attributes import Read, Reader, plain
from thermogear.case.rexs.draft import Draft
from thermogear.case.rexs.lines import DERIVED, READ
from thermogear.case.rexs.model import Component
from thermogear.gears.backlash_standards import centre_distance_tolerance, thickness_limits

_CLASS = "tolerance_class_according_to_iso_1328_2013"
_SERIES = "tooth_thickness_deviation_tolerance_series_din_3967_1978"
_FIELD = "center_distance_tolerance_field_din_3964_1980"


def accuracy_lines(reader: Reader, made: Draft) -> None:
    """The class of ISO 1328-1:2013, the coarser one where the gears have two."""
    found = {}
    for name, gear in made.both:
        says = reader.words(gear, _CLASS)
        if number := re.fullmatch(r"[A-Za-z_]*\s*(\d{1,2})(?:\.0)?", says):
            found[name] = int(number[1])
        elif says:
            made.unused.append(f"{gear.called}.{_CLASS}: got {says[:40]!r}; allowed 1..11")
    if not found:
        return
    worst = max(found.values())
    if len(set(found.values())) > 1:
        both = " and ".join(f"{name} {grade}" for name, grade in found.items())
        made.put("flanks.accuracy", worst, DERIVED, f"the coarser of {both}")
    else:
        made.put("flanks.accuracy", worst, READ, f"ISO 1328-1:2013, {' and '.join(found)}")


def backlash_lines(reader: Reader, made: Draft) -> None:
    """The backlash the file gives, else that of the tooth thicknesses it allows."""
    stage = made.stage.component
    for direction, kind in (("normal", "normal"), ("transverse", "circumferential")):
        names = (f"minimum_{direction}_backlash", f"maximum_{direction}_backlash")
        ends = [reader.number(stage, one) for one in names]
        known = [one.si for one in ends if one is not None]
        if known and sum(known) > 0.0:
            origin = DERIVED if len(known) > 1 else READ
            said = "middle of the least and the most" if len(known) > 1 else "of the stage"
            mean = _um(sum(known) / len(known))
            made.put("backlash.value", mean, origin, f"{direction} backlash, {said}")
            for key, value in (("direction", kind), ("extent", "total")):
                made.put(f"backlash.{key}", value, origin)
            return
    thin = {name: _thickness(reader, made, gear) for name, gear in made.both}
    if not all(thin.values()):
        if any(thin.values()):
            made.unused.append("tooth thickness of one gear alone: no backlash follows from it")
        return
    for name, _ in made.both:
        limits, origin, note = thin[name] or ((), "", "")
        made.put(
            f"backlash.tolerances.{name}_tooth_thickness",
            [_um(one) for one in limits],
            origin,
            note,
        )
    play, origin, note = _distance(reader, made)
    texts = [_um(one) for one in play]
    made.put("backlash.tolerances.centre_distance", texts, origin, note)


def _thickness(
    reader: Reader, made: Draft, gear: Component
) -> tuple[tuple[float, ...], str, str] | None:
    """Allowances [m] of a gear's tooth thickness, where they are from; None without any."""
    ends = [
        reader.number(gear, f"chordal_tooth_thickness_{end}_deviation")
        for end in ("upper", "lower")
    ]
    known = [one.si for one in ends if one is not None]
    if known:
        return tuple(sorted(known)), READ, "chordal tooth thickness deviations"
    series = reader.words(gear, _SERIES)
    if not series:
        return None
    module = reader.number(gear, "normal_module")
    teeth = reader.whole(gear, "number_of_teeth") or 0
    try:
        if module is None:
            raise InputError("normal_module", "nothing")
        upper, lower = thickness_limits(module.si * teeth, series)
    except InputError as error:
        made.unused.append(f"{gear.called}.{_SERIES}: {error}")
        return None
    return (lower, upper), DERIVED, f"{series} of DIN 3967"


def _um(value: float) -> str:
    """A length [m] as a case file holds it, without the last digits of a conversion."""
    return f"{plain(float(f'{1e6 * value:.14g}'))} um"


def _distance(reader: Reader, made: Draft) -> tuple[tuple[float, ...], str, str]:
    """Deviations [m] of the centre distance."""
    stage = made.stage.component
    ends: list[Read | None] = [
        reader.number(stage, f"{end}_center_distance_allowance") for end in ("lower", "upper")
    ]
    known = [one.si for one in ends if one is not None]
    if known:
        return tuple(sorted(known)), READ, "center distance allowances"
    says = re.fullmatch(r"(?:js)?\s*(\d{1,2})", reader.words(stage, _FIELD), re.IGNORECASE)
    given = reader.number(stage, "center_distance")
    apart = given.si if given is not None else None
    if apart is None:
        texts = [one.value for one in made.lines if one.path == "gears.centre_distance"]
        apart = 1e-3 * float(str(texts[0]).split()[0]) if texts else None
    if says and apart:
        try:
            play = centre_distance_tolerance(apart, int(says[1]))
            return (-play, play), DERIVED, f"js{says[1]} of DIN 3964"
        except InputError as error:
            made.unused.append(f"{stage.called}.{_FIELD}: {error}")
    return (0.0,), DERIVED, "no deviation in the file"
