"""A pair of one's own and inspection charts of it, as CSV texts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.case.case import GearCase, load_case

Floats = NDArray[np.float64]

CASE = """
[gears]
module = "3 mm"
[gears.pinion]
teeth = 20
face_width = "30 mm"
[gears.wheel]
teeth = 40
[oil]
temperature = "80 degC"
[temperatures]
pinion_addendum = "90 degC"
wheel_addendum = "85 degC"
pinion_bore = "80 degC"
wheel_bore = "80 degC"
housing = "60 degC"
[grid]
path_positions = 21
mesh_positions = 64
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""
BASE, TIP = 0.5 * 56.381557247154504e-3, 33e-3
"""Base and tip radius [m] of the pinion."""
START, END = 0.0026727395886184738, 0.017154591239562075
"""Roll path [m] of its active profile."""


def chart(
    columns: dict[str, Floats], position: Floats, over: str = "diameter [mm]", *lines: str
) -> str:
    """A CSV text: what a line says, the header, the rows (numbers as they are, to 12 digits)."""
    head = ",".join([over, *columns])
    table = np.column_stack([position, *columns.values()])
    rows = [",".join(f"{value:.12g}" for value in row) for row in table]
    return "\n".join([*(f"# {line}" for line in lines), head, *rows]) + "\n"


def diameter(rho: Floats) -> Floats:
    """Diameter [mm] of the pinion at the roll path rho [m]."""
    return np.asarray(2e3 * np.hypot(BASE, rho))


def case(folder: Path, pinion: str, wheel: str = "", more: str = "") -> GearCase:
    """The pair with its charts, written into ``folder``."""
    (folder / "pinion.csv").write_text(pinion, encoding="utf-8")
    names = 'pinion = "pinion.csv"\n'
    if wheel:
        (folder / "wheel.csv").write_text(wheel, encoding="utf-8")
        names += 'wheel = "wheel.csv"\n'
    file = folder / "mine.toml"
    file.write_text(f"{CASE}\n[flanks]\n{names}{more}", encoding="utf-8")
    found = load_case(file)
    assert isinstance(found, GearCase)
    return found
