"""Deviations of the flanks out of the case file, checked against the pair before a run."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial

from thermogear.base.errors import InputError
from thermogear.case.charts import Chart
from thermogear.case.flank_schema import ReliefTable
from thermogear.case.schema import GearFile, GearTable
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import (
    Deviation,
    FlankTable,
    PitchError,
    PressureAngleError,
    Relief,
)
from thermogear.gears.graded_flanks import graded_flanks
from thermogear.gears.pair import GearPair

OF_METAL, OF_PLASTICS = 6, 9
"""Accuracy classes of ISO 1328-1 taken where none is given: ground steel 4 to 6, plastic cut 8 to
9, moulded 9 to 11 (usual, unconfirmed)."""
PLASTIC = 30e9
"""Young's modulus [Pa] below which a gear is one of plastic."""


def deviations(
    file: GearFile, pair: GearPair, measured: Sequence[Chart] = ()
) -> tuple[Deviation, ...]:
    """Every deviation that the file gives, pinion's first, ``measured`` flanks among them.

    What does not fit the gears (a relief longer than the active profile, pitch errors that are
    not one for each tooth) is refused under its field of the file.
    """
    contacts = mesh_points(pair, [0.0]).contacts
    found: list[Deviation] = []
    for gear, table in (("pinion", file.gears.pinion), ("wheel", file.gears.wheel)):
        for field, make in _given(gear, table):
            try:
                deviation = make()
                deviation.gap(contacts)
            except InputError as error:
                inner = error.field.rsplit(".", 1)[-1]
                part = f".{inner}" if inner in ("amount", "length", "radius", "added") else ""
                raise type(error)(
                    f"gears.{gear}.{field}{part}",
                    error.got,
                    allowed=error.allowed,
                    why=error.why,
                    fix=error.fix,
                ) from error
            found.append(deviation)
    found += [one for chart in measured for one in chart.deviations]
    return (*found, *_graded(file, pair))


def accuracy(file: GearFile, pair: GearPair) -> int | None:
    """The accuracy class of flanks that no profile describes; None where none acts.

    Left out it is 6 for metal, 9 for plastics, and none where the tables of ISO 1328-1 end.
    """
    table = file.flanks
    if table is None or not _unmeasured(file):
        return None
    if table.accuracy is not None:
        return table.accuracy
    stiff = min(gear.material.youngs_modulus for gear in (pair.pinion, pair.wheel))
    usual = OF_METAL if stiff > PLASTIC else OF_PLASTICS
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
    try:
        profiles = graded_flanks(pair, grade, seed=table.seed, edition=table.edition)
    except InputError as error:
        inner = error.field.rpartition(".")[2]
        field = {"grade": "flanks.accuracy", "edition": "flanks.edition"}.get(inner, "flanks")
        got = error.got if field != "flanks" else f"{inner} {error.got}"
        raise InputError(
            field,
            got,
            allowed=error.allowed,
            why=error.why,
            fix="give [transmission_error] harmonics, or measured profiles, instead",
        ) from error
    return tuple(one for one in profiles if one.gear in _unmeasured(file))


def _unmeasured(file: GearFile) -> list[str]:
    """The gears whose flanks neither a table nor a chart gives."""
    return [
        name
        for name in ("pinion", "wheel")
        if getattr(file.gears, name).profile is None and getattr(file.flanks, name, None) is None
    ]


def _given(gear: str, table: GearTable) -> Iterator[tuple[str, Callable[[], Deviation]]]:
    """(field, maker) of what one gear's table holds."""
    for end, relief in (("tip", table.tip_relief), ("root", table.root_relief)):
        if relief is not None:
            yield f"{end}_relief", partial(_relief, gear, end, relief)
    if table.pitch_errors is not None:
        yield "pitch_errors", partial(PitchError, gear, table.pitch_errors)
    if table.pressure_angle_error is not None:
        yield "pressure_angle_error", partial(PressureAngleError, gear, table.pressure_angle_error)
    if table.profile is not None:
        flank = table.profile
        yield (
            "profile",
            partial(FlankTable, gear, radius=flank.radius, added=flank.added, flank=flank.flank),
        )


def _relief(gear: str, end: str, table: ReliefTable) -> Relief:
    return Relief(
        gear,
        amount=table.amount,
        length=table.length,
        end=end,
        shape=table.shape,
        flank=table.flank,
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
