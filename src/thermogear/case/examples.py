"""The case files that come with the package."""

from __future__ import annotations

from importlib.resources import files

from thermogear.base.errors import InputError, nearest

EXAMPLES = {
    "rig": "the gear pair of the thesis's test rig, 25:75, from friction to vibration",
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
