"""Deviations of the flanks out of the case file, checked against the pair before a run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np

from thermogear.base.errors import InputError
from thermogear.case.charts import Chart
from thermogear.case.flank_schema import PARTS, ToothProfilesTable, ToothTable
from thermogear.case.schema import GearFile, GearTable
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import (
    FLANKS,
    GEARS,
    Deviation,
    FlankShape,
    FlankTable,
    PitchError,
    PressureAngleError,
    Relief,
)
from thermogear.gears.graded_flanks import WavyProfile, graded_flanks
from thermogear.gears.pair import GearPair
from thermogear.gears.population import Population, drawn_pair
from thermogear.gears.turn import Eccentricity, ToothShapes, mean_tooth, numbered_from

OF_METAL, OF_PLASTICS = 6, 9
"""Accuracy classes of ISO 1328-1 taken where none is given: ground steel 4 to 6, plastic cut 8 to
9, moulded 9 to 11 (usual, unconfirmed)."""
PLASTIC = 30e9
"""Young's modulus [Pa] below which a gear is one of plastic."""


CLOSED = 0.5e-6
"""What single pitch deviations may add up to, for each tooth [m]: they are rounded (ours)."""


def deviations(
    file: GearFile, pair: GearPair, measured: Sequence[Chart] = ()
) -> tuple[Deviation, ...]:
    """Every deviation that the file gives, pinion's first, ``measured`` flanks among them.

    Teeth are numbered as they mesh, from the one that is marked. What
    does not fit the gears (a relief longer than the active profile, pitch errors that are not one
    for each tooth) is refused under its field of the file. With ``gears.period`` "mesh" the
    deviations of the mean tooth, with ``gears.part`` "nominal" reliefs alone.
    """
    contacts = mesh_points(pair, [0.0]).contacts
    found: list[Deviation] = []
    for gear in GEARS:
        for field, make in _given(gear, file, pair):
            try:
                deviation = make()
                deviation.gap(contacts)
            except InputError as error:
                inner = error.field.rsplit(".", 1)[-1]
                parts = ("amount", "length", "radius", "added", "slope", "form", "phase")
                raise type(error)(
                    f"gears.{gear}.{field}{f'.{inner}' if inner in parts else ''}",
                    error.got,
                    allowed=error.allowed,
                    why=error.why,
                    fix=error.fix,
                ) from error
            found.append(deviation)
    if file.flanks is not None and file.flanks.teeth == "measured" and not measured:
        raise InputError(
            "flanks.teeth", "'measured'", why="no chart of every tooth is given",
            fix="name the charts in flanks.pinion and flanks.wheel",
        )  # fmt: skip
    found += [one for chart in measured for one in _charted(file, pair, chart)]
    found += _graded(file, pair)
    first = {gear: first_tooth(file, gear) for gear in GEARS}
    found = [numbered_from(pair, deviation, **first) for deviation in found]
    if file.gears.part == "nominal":
        found = [deviation for deviation in found if isinstance(deviation, Relief)]
    return tuple(mean_tooth(pair, found) if file.gears.period == "mesh" else found)


def first_tooth(file: GearFile, gear: str) -> int:
    """Which tooth, from 0, of the named gear is marked: number 0 of the mesh."""
    return 0 if file.gears.marks is None else file.gears.marks[GEARS.index(gear)] - 1


def _of_teeth(
    gear: str, file: GearFile, pair: GearPair
) -> Iterator[tuple[str, Callable[[], Deviation]]]:
    """(field, maker) of what may differ from tooth to tooth of one gear."""
    table: GearTable = getattr(file.gears, gear)
    _require_differing(gear, table.teeth_differ)
    if table.pitch_errors is not None or any(one.index for one in table.teeth_differ):
        field = "pitch_errors" if table.pitch_errors is not None else "teeth_differ"
        yield field, partial(_index, gear, file, pair)
    if (one := table.eccentricity) is not None:
        amount = one.amount if one.amount is not None else 0.5 * (one.run_out or 0.0)
        yield "eccentricity", partial(Eccentricity, gear, amount=amount, angle=one.angle)
    for place, profiles in enumerate(table.tooth_profiles):
        yield f"tooth_profiles[{place}]", partial(_every_tooth, gear, profiles, table.teeth)
    for flank in FLANKS:
        single = [one for one in table.teeth_differ if one.flank == flank]
        if any(one.slope or one.form for one in single):
            yield "teeth_differ", partial(_single_teeth, gear, single, table.teeth)


def _require_differing(gear: str, given: Sequence[ToothTable]) -> None:
    """Refuse a tooth of a side named twice, or with nothing that differs."""
    named = [(one.tooth, one.flank) for one in given]
    for place, one in enumerate(given):
        field = f"gears.{gear}.teeth_differ[{place}]"
        if named.count(named[place]) > 1:
            raise InputError(
                field, f"tooth {one.tooth} twice", allowed="each tooth of a side once",
                fix="put what differs into one entry",
            )  # fmt: skip
        if not (one.index or one.slope or one.form):
            raise InputError(
                field, f"tooth {one.tooth} without a difference", fix="give index, slope or form"
            )


def _index(gear: str, file: GearFile, pair: GearPair) -> PitchError:
    """Index of every tooth along the line of action [m], in the order of the mesh."""
    table: GearTable = getattr(file.gears, gear)
    given = PitchError(gear, table.pitch_errors or (0.0,) * table.teeth)
    given.require_fits(pair)
    errors = np.array(given.errors)
    if file.gears.pitch_errors_are == "single pitch":
        left, most = float(errors.sum()), CLOSED * table.teeth
        if abs(left) > most:
            raise InputError(
                "",
                f"single pitch deviations that add up to {1e6 * left:.4g} um",
                allowed=f"{-1e6 * most:.4g}..{1e6 * most:.4g} um",
                why="after a whole turn the pitches close",
                fix='are they positions of the teeth? then gears.pitch_errors_are = "index"',
            )
        # a tooth farther from the one before lies farther back in the sense of turning
        index = np.cumsum(errors - errors.mean()) * (-1.0 if gear == "pinion" else 1.0)
        errors = index - index.mean()
    if file.gears.pitch_errors_along == "arc":
        errors = errors * math.cos(file.gears.pressure_angle)
    for one in table.teeth_differ:
        errors[_place(one, table.teeth)] += one.index
    return PitchError(gear, tuple(errors.tolist()))


def _place(one: ToothTable, teeth: int) -> int:
    if one.tooth > teeth:
        raise InputError("", f"tooth {one.tooth}", allowed=f"1..{teeth}")
    return one.tooth - 1


def _every_tooth(gear: str, table: ToothProfilesTable, teeth: int) -> ToothShapes:
    """Slope and form of every tooth of one side."""
    columns = {name: getattr(table, name) or (0.0,) for name in ("slope", "form", "phase")}
    for name, values in columns.items():
        if len(values) not in (1, teeth):
            each = f"one for each of the {teeth} teeth, or " * (teeth > 1)
            raise InputError(
                name, f"{len(values)} values", allowed=f"{each}one", fix="list them tooth by tooth"
            )
    rows = zip(*(np.broadcast_to(one, teeth).tolist() for one in columns.values()), strict=True)
    made = partial(WavyProfile, gear, waves=table.waves, flank=table.flank)
    return ToothShapes(gear, tuple(made(**dict(zip(columns, row, strict=True))) for row in rows))


def _single_teeth(gear: str, given: Sequence[ToothTable], teeth: int) -> ToothShapes:
    """Slope and form of the teeth that differ on one side, none of the others."""
    shapes: list[FlankShape] = [WavyProfile(gear, slope=0.0, flank=given[0].flank)] * teeth
    for one in given:
        (shapes[_place(one, teeth)],) = _every_tooth(gear, one, 1).shapes
    return ToothShapes(gear, tuple(shapes))


def _charted(file: GearFile, pair: GearPair, chart: Chart) -> tuple[Deviation, ...]:
    """What a chart's flanks are: the mean of the teeth, or each tooth by itself."""
    if file.flanks is None or file.flanks.teeth != "measured":
        return chart.deviations
    return chart.every_tooth(pair)


def accuracy(file: GearFile, pair: GearPair) -> int | None:
    """The accuracy class of flanks that no profile describes; None where none acts.

    Left out it is 6 for metal, 9 for plastics, and none where the tables of ISO 1328-1 end.
    """
    table = file.flanks
    if table is None or not unmeasured(file) or file.gears.part == "nominal":
        return None
    if table.accuracy is not None:
        return table.accuracy
    stiff = min(gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel))
    usual = OF_METAL if stiff > PLASTIC else OF_PLASTICS
    if table.teeth == "drawn":  # asked for, so refused where it cannot be
        return usual
    try:
        graded_flanks(pair, usual, seed=table.seed, edition=table.edition)
    except InputError:
        return None
    return usual


def _graded(file: GearFile, pair: GearPair) -> tuple[Deviation, ...]:
    """Seeded profiles of the gears whose own are not given."""
    grade, table = accuracy(file, pair), file.flanks
    if grade is None or table is None:
        return ()
    edition, drawn = table.edition, table.teeth == "drawn"
    for gear in unmeasured(file) if drawn else ():
        for field in ("eccentricity", "pitch_errors"):
            if getattr(getattr(file.gears, gear), field) is not None:
                raise InputError(
                    f"gears.{gear}.{field}",
                    'given beside flanks.teeth = "drawn"',
                    why="a drawn gear has its own",
                    fix="leave one out, or give tooth_profiles, which are not drawn then",
                )
    try:
        profiles: tuple[Deviation, ...] = (
            drawn_pair(
                pair,
                grade,
                seed=table.seed,
                place=table.drawing,
                edition=edition,
                population=population(file),
            )
            if drawn
            else graded_flanks(pair, grade, seed=table.seed, edition=edition)
        )
    except InputError as error:
        inner = error.field.rpartition(".")[2]
        field = {"grade": "flanks.accuracy", "edition": "flanks.edition"}.get(inner, "flanks")
        raise InputError(
            field,
            error.got if field != "flanks" else f"{inner} {error.got}",
            allowed=error.allowed,
            why=error.why,
            fix="give [transmission_error] harmonics, or measured profiles, instead",
        ) from error
    return tuple(one for one in profiles if getattr(one, "gear", None) in unmeasured(file))


def population(file: GearFile) -> Population:
    """How the gears of a class differ, with what the file says of it."""
    table = None if file.flanks is None else file.flanks.population
    return Population() if table is None else Population(**table.model_dump())


def series(file: GearFile, grade: int | None, *, loaded: bool) -> int:
    """How many parts of the class ``grade`` the answers are of; 1: the part of the case alone.

    One where a seed is stated, flanks or pitches are given, all teeth are taken alike, or the
    springs do not feel the flanks (not ``loaded``).
    """
    table = file.flanks
    if table is None or grade is None or file.gears.period == "mesh":
        return 1
    error = file.transmission_error
    given = [gear for gear in GEARS if _differing(getattr(file.gears, gear))]
    drawn = loaded and len(unmeasured(file)) == 2 and not given and not (error and error.harmonics)
    if table.parts is None:
        return PARTS if drawn and not {"seed", "drawing"} & table.model_fields_set else 1
    if table.parts > 1 and not drawn:
        raise InputError(
            "flanks.parts", table.parts, allowed="1",
            why="a series is drawn of flanks that are not given, under the loaded contact",
            fix="leave it out",
        )  # fmt: skip
    return table.parts


def _differing(table: GearTable) -> bool:
    """Whether the teeth of a gear are given one by one."""
    return bool(table.pitch_errors or table.eccentricity or table.teeth_differ)


def unmeasured(file: GearFile) -> list[str]:
    """The gears whose flanks neither a table nor a chart gives."""
    tables = {"pinion": file.gears.pinion, "wheel": file.gears.wheel}
    return [
        name
        for name, table in tables.items()
        if table.profile is None
        and not table.tooth_profiles
        and getattr(file.flanks, name, None) is None
    ]


def _given(
    gear: str, file: GearFile, pair: GearPair
) -> Iterator[tuple[str, Callable[[], Deviation]]]:
    """(field, maker) of what one gear's table holds."""
    table: GearTable = getattr(file.gears, gear)
    for end, relief in (("tip", table.tip_relief), ("root", table.root_relief)):
        if relief is not None:
            yield f"{end}_relief", partial(Relief, gear, end=end, **relief.model_dump())
    yield from _of_teeth(gear, file, pair)
    if table.pressure_angle_error is not None:
        yield "pressure_angle_error", partial(PressureAngleError, gear, table.pressure_angle_error)
    if table.profile is not None:
        flank = table.profile
        yield (
            "profile",
            partial(FlankTable, gear, radius=flank.radius, added=flank.added, flank=flank.flank),
        )


def relief_text(gear: str, relief: Relief) -> str:
    """A tip relief as lines to paste into a case file; lengths to a nanometre."""
    return "\n".join(
        [
            f"[gears.{gear}.{relief.end}_relief]",
            f'amount = "{1e6 * relief.amount:.3f} um"',
            f'length = "{1e3 * relief.length:.6f} mm"',
            f'shape = "{relief.shape}"',
        ]
    )
