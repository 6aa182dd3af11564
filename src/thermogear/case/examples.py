"""The case files that come with the package."""

from __future__ import annotations

from importlib.resources import files

from thermogear.base.errors import InputError, nearest

EXAMPLES = {
    "rig": "gears of a rig, 25:75, from friction to vibration, every value with its reason",
    "rig-train": "the rig's pair on shafts in ball bearings, with motor and brake: bearing play",
    "fzg-a": "FZG type A, stage 12: scuffing, film, flash temperature of long sliding",
    "fzg-c": "FZG type C, 200 N m: losses, film, the heat balance of a known test",
    "nasa-spur": "28:28 at 10 000 rpm: high speed, thin and hot oil film",
    "bgu-17-38": "17:38, lightly loaded: rattle, records of a rig with public code",
    "bgu-18-35": "18:35, lightly loaded: the same rig, wider gears",
    "loaded-27-35": "27:35 at 80 kW: tip relief, heavy load",
    "rig-50-50": "50:50 of the rig whose measured pairs jump: ratios to hold against its curves",
    "fe-17-43": "17:43 of module 1 mm: teeth that another code solved by finite elements",
    "pom-steel": "POM on steel, 20:20: plastic that grows and softens as it warms",
    "motor-train": "motor, two shafts, four ball bearings, 23:47: critical speeds, bearings",
    "table-4.2": "the dimensionless rows of the thesis's table 4.2",
    "section-4.1": "the dimensionless temperature row of the thesis's section 4.1",
}


def example_text(name: str) -> str:
    """The text of a ready-made case; an unknown name says the nearest."""
    stem = name.removesuffix(".toml")
    if stem not in EXAMPLES:
        raise InputError(
            "example", repr(name), allowed=" | ".join(EXAMPLES), fix=nearest(stem, EXAMPLES)
        )
    return (files("thermogear.case") / "ready_made" / f"{stem}.toml").read_text(encoding="utf-8")
