"""Faults out of the case file: what they are to the mesh, and in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from thermogear.base.errors import InputError
from thermogear.case.fault_schema import FaultTable
from thermogear.case.schema import GearFile
from thermogear.case.units import shown
from thermogear.gears.candidates import mesh_points
from thermogear.gears.deviations import Deviation, FlankTable, PitchError
from thermogear.gears.flank_damage import (
    OneTooth,
    Pocket,
    Spall,
    floor_reached,
    spalled,
    worn,
)
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_damage import Chip, Crack, Damage, MissingTooth, way_across
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import Eccentricity, turn_period

_ROOT_OR_TIP = {"crack", "chip", "missing"}
"""Kinds of which a tooth has one: each is solved on a tooth that is whole else."""
_BESIDE = "one of crack, chip and missing on a tooth, nothing on a missing one, spalls side by side"
EVERY = 8
"""Positions of a mesh period at which some tooth must touch."""
_NAMES = {"radius": "diameter", "error": "amount", "meshes": "revolutions", "added": "depth"}
"""Fields of the file by the names that the gears have for them."""


def fault_deviations(file: GearFile, pair: GearPair) -> Iterator[Deviation]:
    """What the faults of a file do to the teeth of ``pair``, numbered as in the file.

    A fault of no size is none. InputError under the field of the file for a tooth that there is
    not, a crack or break of a tooth that has one, and what the teeth cannot have.
    """
    seen: dict[tuple[str, int], list[FaultTable]] = {}
    damaged: list[Deviation] = []
    for number, fault in enumerate(file.faults):
        field, teeth = f"faults[{number}]", pair.gear(fault.gear).teeth
        if fault.place >= teeth:
            why = f"the {fault.gear} has no more teeth"
            raise InputError(f"{field}.tooth", fault.tooth, allowed=f"1..{teeth}", why=why)
        if not fault.acts:
            continue
        here = seen.setdefault((fault.gear, fault.place), [])
        if other := next((one.kind for one in here if _clash(fault, one, pair)), ""):
            raise InputError(
                field,
                f"{fault.kind} of tooth {fault.place + 1} of the {fault.gear}",
                allowed=_BESIDE,
                why=f"it has another, {other}, and the two together are not solved",
                fix="leave one out",
            )
        try:
            deviation = _deviation(fault, file, pair)
            if isinstance(deviation, Crack):
                deviation.table(pair.gear(fault.gear))
            elif isinstance(deviation, Damage):
                deviation.require_fits(pair)
        except InputError as error:
            inner = error.field.rpartition(".")[2]
            inner = "share" if inner == "depth" and fault.share is not None else inner
            error.got = f"a radius of {error.got}" if inner == "radius" else error.got
            raise error.named(f"{field}.{_NAMES.get(inner, inner)}") from error
        here += [fault] * (whole_turn(fault) and fault.kind != "eccentricity")
        if isinstance(deviation, Damage):
            damaged.append(deviation)
        if deviation is not None:
            yield deviation
    phases = np.arange(EVERY * turn_period(pair, damaged).mesh_periods) / EVERY
    touched = first_touch(mesh_points(pair, phases if damaged else [0.0]), damaged).gap.min(axis=1)
    if not np.isfinite(touched).all():
        raise InputError(
            "faults",
            "so many broken teeth side by side that none carries",
            allowed="a tooth that touches at every position of the turn",
            fix="leave one out",
        )


def _clash(fault: FaultTable, other: FaultTable, pair: GearPair) -> bool:
    """Whether two faults of one tooth are not solved together, or one of them is nowhere."""
    kinds, base = {fault.kind, other.kind}, 2.0 * pair.gear(fault.gear).base_radius
    # along the flank, whose arc from the base circle is rho^2/(2 r_b)
    apart = abs(_middle(fault, pair) ** 2 - _middle(other, pair) ** 2) / base
    over = apart < 0.5 * ((fault.length or 0.0) + (other.length or 0.0))
    return (kinds == {"spall"} and over) or "missing" in kinds or kinds <= _ROOT_OR_TIP


def _deviation(fault: FaultTable, file: GearFile, pair: GearPair) -> Deviation | None:
    gear, tooth = fault.gear, fault.place
    width = 1.0 if fault.width_share is None else fault.width_share
    if fault.kind == "missing":
        return MissingTooth(gear, tooth=tooth)
    if fault.kind == "eccentricity":
        return Eccentricity(gear, amount=fault.amount or 0.0, angle=fault.angle or 0.0)
    if fault.kind == "pitch":
        errors = [0.0] * pair.gear(gear).teeth
        errors[tooth] = fault.amount or 0.0
        return PitchError(gear, tuple(errors))
    if fault.kind == "crack":
        across = way_across(pair.gear(gear), fault.slope)
        depth = fault.depth if fault.share is None else fault.share * across
        return Crack(gear, tooth=tooth, depth=depth or 0.0, angle=fault.slope, width_share=width)
    if fault.kind == "chip":
        chip = Chip(gear, tooth=tooth, height=fault.height or 0.0)
        chip.left(pair.gear(gear))
        return chip
    force = max(file.operating.torque) / pair.pinion.base_radius
    return (_spall if fault.kind == "spall" else _wear)(fault, pair, force)


def _middle(fault: FaultTable, pair: GearPair) -> float:
    """Radius [m] of the middle of a spall, by default that of the operating pitch circle."""
    string = pair.path.c if fault.gear == "pinion" else pair.line_of_action - pair.path.c
    pitch = math.hypot(pair.gear(fault.gear).base_radius, string)
    return pitch if fault.diameter is None else 0.5 * fault.diameter


def _spall(fault: FaultTable, pair: GearPair, force: float) -> Deviation:
    """A pocket as wide as the face, or one beside which the rest of the face carries ``force``."""
    gear, depth, length = fault.gear, fault.depth or 0.0, fault.length or 0.0
    width = 1.0 if fault.width_share is None else fault.width_share
    radius = _middle(fault, pair)
    spalled(pair, gear, radius=radius, length=length)
    if width == 1.0:
        whole, pocket = (Pocket(gear, radius=radius, length=length, depth=d) for d in (0.0, depth))
        return _on_tooth(whole, pocket, fault, pair)
    spall = Spall(gear, tooth=fault.place, radius=radius, length=length, width_share=width)
    least = floor_reached(pair, force, width_share=width)
    if depth < least:
        raise InputError(
            "depth",
            shown(depth, "length"),
            allowed=f">= {shown(least, 'length', 3)}",
            why="under the greatest torque its floor would carry too",
            fix="leave width_share out, or make it smaller",
        )
    return spall


def _wear(fault: FaultTable, pair: GearPair, force: float) -> Deviation | None:
    if not force:
        return None
    made = worn(
        pair, fault.gear, force, depth=fault.depth,
        coefficient=fault.coefficient or 0.0, meshes=fault.revolutions or 0.0,
    )  # fmt: skip
    if fault.tooth is None:
        return made
    whole = FlankTable(
        fault.gear, radius=made.radius, added=np.zeros_like(made.added), flank="drive"
    )
    return _on_tooth(whole, made, fault, pair)


def _on_tooth(
    whole: FlankTable | Pocket, damaged: FlankTable | Pocket, fault: FaultTable, pair: GearPair
) -> OneTooth:
    shapes = [whole] * pair.gear(fault.gear).teeth
    shapes[fault.place] = damaged
    return OneTooth(fault.gear, tuple(shapes))


def fault_words(fault: FaultTable) -> str:
    """A fault with its size and place, as notices name it.

    >>> table = FaultTable(kind="crack", gear="pinion", tooth=3, depth="2 mm")
    >>> fault_words(table)
    'crack of 2 mm at 45 deg, pinion tooth 3'
    """

    def length(value: float | None) -> str:
        size = value or 0.0
        return shown(size, "length", 3, unit="um" if 0.0 < abs(size) < 1e-4 else "mm")

    wide = "" if fault.width_share in (None, 1.0) else f", {fault.width_share:g} of the face width"
    turns = f"over {fault.revolutions or 0.0:g} turns"
    of_share = None if fault.share is None else f"{fault.share:g} of the way across"
    angle = shown(fault.slope, "angle", 3)
    sizes = {
        "crack": f"{of_share or length(fault.depth)} at {angle}{wide}",
        "chip": length(fault.height),
        "missing": "",
        "spall": f"{length(fault.length)} x {length(fault.depth)}{wide}",
        "wear": length(fault.depth)
        if fault.depth is not None
        else f"{shown(fault.coefficient or 0.0, 'wear coefficient')} {turns}",
        "pitch": length(fault.amount),
        "eccentricity": length(fault.amount),
    }
    size = sizes[fault.kind]
    name = {"missing": "missing tooth", "pitch": "pitch error"}.get(fault.kind, fault.kind)
    every = fault.kind == "eccentricity" or not whole_turn(fault)
    where = fault.gear if every else f"{fault.gear} tooth {fault.place + 1}"
    return f"{name}{f' of {size}' if size else ''}, {where}"


def whole_turn(fault: FaultTable) -> bool:
    """Whether a fault is one tooth's, or the turn's, so that a mean tooth does not have it."""
    return not (fault.kind == "wear" and fault.tooth is None)
