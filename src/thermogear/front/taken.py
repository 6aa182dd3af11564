"""The defaults a case has taken, as lines for a terminal: what each decides, one line each."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from thermogear.case.assumptions import Assumption

GROUPS = {
    "gears": ("gears",),
    "oil": ("oil",),
    "heat": ("temperatures", "gearbox", "housing"),
    "backlash": ("backlash",),
    "flanks": ("flanks", "transmission_error"),
    "motion": ("inertia", "dynamics"),
    "model": ("model",),
    "other": (),
}
NUMERICAL = ("grid", "simulation")
"""Tables that decide how finely is computed, summed up in one line."""
_WIDE = 31


def defaults(assumptions: Iterable[Assumption]) -> Iterator[str]:
    """The lines: a head for each group, under it ``field  value  reason``.

    What pinion and wheel have alike is one line. Nothing where no default was taken.
    """
    left = [one for one in assumptions if one.default]
    tables = {one.field: one.field.split(".")[0] for one in left}
    named = {table for group in GROUPS.values() for table in group} | {*NUMERICAL}
    for head, own in GROUPS.items():
        here = [
            one
            for one in left
            if tables[one.field] in own or (not own and tables[one.field] not in named)
        ]
        if here:
            yield f"{head}, left to defaults"
            yield from _lines(here)
    count = sum(tables[one.field] in NUMERICAL for one in left)
    if count:
        yield f"numerics: {count} defaults of [grid] and [simulation], listed with --json"


def _lines(found: list[Assumption]) -> Iterator[str]:
    """One line per field and reason, gears' values side by side."""
    merged: dict[tuple[str, str], list[Assumption]] = {}
    for one in found:
        merged.setdefault((_of_both(one.field), one.default), []).append(one)
    for (both, reason), several in merged.items():
        name = both if len(several) > 1 else several[0].field
        values = dict.fromkeys(one.value for one in several if one.value != "left out")
        text = " and ".join(values)
        said = reason.removeprefix("left out: ")
        if text and not said.startswith(text):
            said = f"{text}: {said}"
        yield f"  {name:<{_WIDE}} {said}"


def _of_both(field: str) -> str:
    return field.replace("gears.pinion.", "gears.").replace("gears.wheel.", "gears.")
