"""The drive train as numbers to draw, to scale: sections, gears, bearings, discs and ends."""

from __future__ import annotations

from typing import Any

from thermogear.gears.pair import GearPair
from thermogear.shafts.train import SHAFTS, DriveTrain


def sketch(train: DriveTrain, pair: GearPair) -> dict[str, Any]:
    """Everything along z [m], the gears' plane at 0, and its diameters [m], for the page's file."""
    shafts = []
    for name, shaft, gear in zip(SHAFTS, train.shafts, (pair.pinion, pair.wheel), strict=True):
        start, at = -shaft.gear_position, -shaft.gear_position
        sections = []
        for one in shaft.sections:
            sections.append([at, at + one.length, one.outer_diameter, one.inner_diameter])
            at += one.length
        shafts.append(
            {
                "name": name,
                "sections": sections,
                "gear": [gear.face_width, 2.0 * gear.tip_radius],
                "bearings": [
                    [one.name, start + one.position] for one in train.bearings if one.shaft == name
                ],
                "discs": [
                    [one.name, start + one.position] for one in train.discs if one.shaft == name
                ],
                "end": _end(train, name, start),
            }
        )
    frame = train.frame
    return {
        "shafts": shafts,
        "centre_distance": pair.centre_distance,
        "centre_line": frame.centre_line,
        "sense": frame.sense,
    }


def _end(train: DriveTrain, shaft: str, start: float) -> list[Any] | None:
    name, end = ("motor", train.motor) if shaft == SHAFTS[0] else ("load", train.load)
    return None if end is None else [name, start + end.position]
