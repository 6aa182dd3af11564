"""Deviations of the flanks out of the case file, checked against the pair before a run."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from functools import lru_cache, partial

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.display import in_words
from thermogear.base.errors import InputError
from thermogear.case.charts import Chart
from thermogear.case.faults import fault_deviations
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
from thermogear.gears.turn import (
    Eccentricity,
    ToothShapes,
    mean_tooth,
    numbered_from,
    turn_period,
)

OF_METAL, OF_PLASTICS = 6, 9
"""Accuracy classes of ISO 1328-1 taken where none is given: ground steel 4 to 6, plastic cut 8 to
9, moulded 9 to 11 (usual, unconfirmed)."""
PLASTIC = 30e9
"""Young's modulus [Pa] below which a gear is one of plastic."""


_drawn_pair = lru_cache(maxsize=256)(drawn_pair)
"""Remembered: a dial, a sweep, a run-up ask for the same parts at each of their points."""
CLOSED = 0.5e-6
"""What single pitch deviations may add up to, for each tooth [m]: they are rounded (ours)."""


def deviations(
    file: GearFile, pair: GearPair, measured: Sequence[Chart] = ()
) -> tuple[Deviation, ...]:
    """The deviations that the file takes, of those in :func:`all_deviations`.

    With ``gears.period`` "mesh" those of the mean tooth, with ``gears.part`` "nominal" reliefs.
    """
    taken = all_deviations(file, pair, measured)
    if file.gears.part == "nominal":
        taken = tuple(deviation for deviation in taken if isinstance(deviation, Relief))
    return mean_tooth(pair, taken) if file.gears.period == "mesh" else taken


def all_deviations(
    file: GearFile, pair: GearPair, measured: Sequence[Chart] = ()
) -> tuple[Deviation, ...]:
    """Every deviation that the file gives, pinion's first, ``measured`` flanks and faults too.

    Teeth are numbered as they mesh, from the one that is marked. What
    does not fit the gears (a relief longer than the active profile, pitch errors that are not one
    for each tooth) is refused under its field of the file.
    """
    contacts = mesh_points(pair, [0.0]).contacts
    given: list[Deviation] = []
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
            given.append(deviation)
    if file.flanks is not None and file.flanks.teeth == "measured" and not measured:
        raise InputError(
            "flanks.teeth", "'measured'", why="no chart of every tooth is given",
            fix="name the charts in flanks.pinion and flanks.wheel",
        )  # fmt: skip
    for chart in measured:
        try:
            given += _charted(file, pair, chart)
        except InputError as error:
            of_case = error.field.startswith(("gears.", "flanks."))
            raise error.named(error.field if of_case else f"flanks.{chart.gear}") from error
    given += [*_graded(file, pair), *fault_deviations(file, pair)]
    first = {gear: first_tooth(file, gear) for gear in GEARS}
    return tuple(numbered_from(pair, deviation, **first) for deviation in given)


def without_effect(
    file: GearFile, pair: GearPair, every: Sequence[Deviation]
) -> Iterator[tuple[str, str]]:
    """(field and value, why) of what the file states of flanks and ``every`` deviation ignores."""
    tables = [getattr(file.gears, gear) for gear in GEARS]
    graded = bool(unmeasured(file))
    drawn = file.flanks is not None and file.flanks.teeth == "drawn"
    of_its_own = "both gears have flanks of their own"
    alike = turn_period(pair, every).mesh_periods == 1
    for idle, fields, why in (
        (all(table.pitch_errors is None for table in tables),
         ("gears.pitch_errors_are", "gears.pitch_errors_along"), "no pitch_errors are given"),
        (alike, ("gears.marks",), "the teeth of each gear are alike"),
        # of a class it may mean the part alone, and no series
        (alike and file.flanks is None, ("gears.period",), "the teeth of each gear are alike"),
        (all(isinstance(deviation, Relief) for deviation in every), ("gears.part",),
         "no flank deviates but by reliefs"),
        (not graded, ("flanks.accuracy", "flanks.edition", "flanks.seed"), of_its_own),
        (drawn and not graded, ("flanks.teeth",), of_its_own),
        (not (drawn and graded), ("flanks.drawing",), 'it is one of teeth = "drawn"'),
    ):  # fmt: skip
        for field in fields if idle else ():
            name, _, key = field.partition(".")
            table = getattr(file, name)
            if table is not None and key in table.model_fields_set:
                yield f"{field}: {in_words(getattr(table, key))}", why


MOST_MESHED = 4000
"""Mesh periods over which teeth out of their places are held against the backlash."""


def require_meshing(
    file: GearFile, pair: GearPair, acting: Sequence[Deviation], backlash: float
) -> None:
    """Refuse stated pitch errors and eccentricities by which the cold pair jams.

    At a mesh phase the least gap of the drive flanks and that of the back flanks add up to what is
    left of the normal ``backlash`` [m]; over the turn it must stay above 0.
    """
    moved = [d for d in acting if isinstance(d, PitchError | Eccentricity)]
    reach = {
        d: float(np.ptp(d.errors) if isinstance(d, PitchError) else 2.0 * d.amount) for d in moved
    }
    # a drive flank early and a back flank late, each by the whole reach
    if not moved or 2.0 * sum(reach.values()) <= backlash:
        return
    periods = min(turn_period(pair, moved).mesh_periods, MOST_MESHED)
    left: Floats = np.full(8 * periods, backlash)
    for flank in ("drive", "back"):
        points = mesh_points(pair, np.arange(8 * periods) / 8, flank)
        gap = sum((d.gap(points.contacts) for d in moved), points.point.gap)
        left = left + np.nanmin(np.where(np.isfinite(gap), gap, np.inf), axis=-1)
    worst = max(reach, key=lambda d: reach[d])
    table: GearTable = getattr(file.gears, worst.gear)
    listed = ("pitch_errors", "teeth_differ")
    names = ("eccentricity",) if isinstance(worst, Eccentricity) else listed
    stated = [f"gears.{worst.gear}.{name}" for name in names if getattr(table, name)]
    if getattr(file.flanks, worst.gear, None):
        stated.append(f"flanks.{worst.gear}")
    stated += [
        f"faults[{number}].amount"
        for number, fault in enumerate(file.faults)
        if fault.amount and fault.gear == worst.gear
    ]
    if left.min() <= 0.0 and stated:  # what is drawn from a class may jam: the study says so
        raise InputError(
            stated[0],
            f"teeth that take {1e6 * (backlash - left.min()):.4g} um of the backlash",
            allowed=f"< {1e6 * backlash:.4g} um, the whole of it along the line of action",
            why="the cold pair would jam",
            fix="correct the unit, or open [backlash]",
        )


def first_tooth(file: GearFile, gear: str) -> int:
    """Which tooth, from 0, of the named gear is marked: number 0 of the mesh."""
    return 0 if file.gears.marks is None else file.gears.marks[GEARS.index(gear)] - 1


def _of_teeth(
    gear: str, file: GearFile, pair: GearPair
) -> Iterator[tuple[str, Callable[[], Deviation]]]:
    """(field, maker) of what may differ from tooth to tooth of one gear."""
    table: GearTable = getattr(file.gears, gear)
    _require_differing(gear, table.teeth_differ)
    if table.pitch_errors is not None or any(tooth.index for tooth in table.teeth_differ):
        field = "pitch_errors" if table.pitch_errors is not None else "teeth_differ"
        yield field, partial(_index, gear, file, pair)
    if (eccentricity := table.eccentricity) is not None:
        amount = (
            eccentricity.amount
            if eccentricity.amount is not None
            else 0.5 * (eccentricity.run_out or 0.0)
        )
        yield "eccentricity", partial(Eccentricity, gear, amount=amount, angle=eccentricity.angle)
    for place, profiles in enumerate(table.tooth_profiles):
        yield f"tooth_profiles[{place}]", partial(_every_tooth, gear, profiles, table.teeth)
    for flank in FLANKS:
        single = [tooth for tooth in table.teeth_differ if tooth.flank == flank]
        if any(tooth.slope or tooth.form for tooth in single):
            yield "teeth_differ", partial(_single_teeth, gear, single, table.teeth)


def _require_differing(gear: str, given: Sequence[ToothTable]) -> None:
    """Refuse a tooth of a side named twice, or with nothing that differs."""
    named = [(tooth.tooth, tooth.flank) for tooth in given]
    for place, tooth in enumerate(given):
        field = f"gears.{gear}.teeth_differ[{place}]"
        if named.count(named[place]) > 1:
            raise InputError(
                field, f"tooth {tooth.tooth} twice", allowed="each tooth of a side once",
                fix="put what differs into one entry",
            )  # fmt: skip
        if not (tooth.index or tooth.slope or tooth.form):
            raise InputError(
                field, f"tooth {tooth.tooth} without a difference", fix="give index, slope or form"
            )
        if tooth.flank != "both" and not (tooth.slope or tooth.form):
            raise InputError(
                f"{field}.flank", repr(tooth.flank), allowed="beside slope or form",
                why="an index moves the whole tooth", fix="leave it out",
            )  # fmt: skip


def _index(gear: str, file: GearFile, pair: GearPair) -> PitchError:
    """Index of every tooth along the line of action [m], in the order of the mesh."""
    table: GearTable = getattr(file.gears, gear)
    given = PitchError(gear, table.pitch_errors or (0.0,) * table.teeth)
    given.require_fits(pair)
    errors = np.array(given.errors)
    if file.gears.pitch_errors_are == "single pitch":
        errors = _from_pitches(gear, errors, 'gears.pitch_errors_are = "index"')
    if file.gears.pitch_errors_along == "arc":
        errors = errors * math.cos(file.gears.pressure_angle)
    for tooth in table.teeth_differ:
        errors[_place(tooth, table.teeth)] += tooth.index
    return PitchError(gear, tuple(errors.tolist()))


def _from_pitches(gear: str, pitches: Floats, instead: str) -> Floats:
    """Index [m] of every tooth from its single pitch; ``instead`` is to write for positions."""
    left, most = float(pitches.sum()), CLOSED * pitches.size
    if abs(left) > most:
        raise InputError(
            "",
            f"single pitch deviations that add up to {1e6 * left:.4g} um",
            allowed=f"{-1e6 * most:.4g}..{1e6 * most:.4g} um",
            why="after a whole turn the pitches close",
            fix=f"are they positions of the teeth? then {instead}",
        )
    return _from_places(gear, np.cumsum(pitches - pitches.mean()))


def _from_places(gear: str, behind: Floats) -> Floats:
    """Index [m] of teeth that lie so far behind their places, in the sense of turning."""
    return np.asarray((behind - behind.mean()) * (-1.0 if gear == "pinion" else 1.0))


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
    rows = np.transpose([np.broadcast_to(values, teeth) for values in columns.values()]).tolist()
    made = partial(WavyProfile, gear, waves=table.waves, flank=table.flank)
    return ToothShapes(gear, tuple(made(**dict(zip(columns, row, strict=True))) for row in rows))


def _single_teeth(gear: str, given: Sequence[ToothTable], teeth: int) -> ToothShapes:
    """Slope and form of the teeth that differ on one side, none of the others."""
    shapes: list[FlankShape] = [WavyProfile(gear, slope=0.0, flank=given[0].flank)] * teeth
    for tooth in given:
        (shapes[_place(tooth, teeth)],) = _every_tooth(gear, tooth, 1).shapes
    return ToothShapes(gear, tuple(shapes))


def _charted(file: GearFile, pair: GearPair, chart: Chart) -> tuple[Deviation, ...]:
    """What a chart's flanks are, the mean of the teeth or each tooth by itself, and its pitch."""
    single = file.flanks is not None and file.flanks.teeth == "measured"
    flanks = chart.every_tooth(pair) if single else chart.deviations
    if (name := chart.acting_pitch) is None:
        return flanks
    if getattr(file.gears, chart.gear).pitch_errors is not None:
        raise InputError(
            f"gears.{chart.gear}.pitch_errors",
            f"given beside {', '.join(chart.names)}",
            why=f"the chart's column '{name}' says where the teeth are",
            fix="leave one out",
        )
    index = chart.read.pitch[name]
    if name.startswith("single"):
        index = _from_pitches(chart.gear, index, f"name the column 'cumulative{name[6:]}'")
    else:
        index = _from_places(chart.gear, index)
    arc = math.cos(file.gears.pressure_angle)
    return (*flanks, PitchError(chart.gear, tuple((arc * index).tolist())))


def accuracy(file: GearFile, pair: GearPair) -> int | None:
    """The accuracy class of flanks that no profile describes; None where none acts.

    Left out it is 6 for metal, 9 for plastics, and none where the tables of ISO 1328-1 end.
    """
    table = file.flanks
    if table is None or not unmeasured(file):
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
            _drawn_pair(
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
    graded = unmeasured(file)
    return tuple(profile for profile in profiles if getattr(profile, "gear", None) in graded)


def population(file: GearFile) -> Population:
    """How the gears of a class differ, with what the file says of it."""
    table = None if file.flanks is None else file.flanks.population
    return Population() if table is None else Population(**table.model_dump())


def series(file: GearFile, grade: int | None, *, loaded: bool) -> int:
    """How many parts of the class ``grade`` the answers are of; 1: the part of the case alone.

    One where a seed or a drawing of whole teeth is stated, flanks or pitches are given, all teeth
    are taken alike, or the springs do not feel the flanks (not ``loaded``).
    """
    table = file.flanks
    if table is None or grade is None or file.gears.period == "mesh":
        return 1
    error = file.transmission_error
    given = [gear for gear in GEARS if _differing(getattr(file.gears, gear))]
    drawn = loaded and len(unmeasured(file)) == 2 and not given and not (error and error.harmonics)
    if "drawing" in table.model_fields_set and table.teeth == "drawn":
        return 1
    if table.parts is None:
        return PARTS if drawn and "seed" not in table.model_fields_set else 1
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
