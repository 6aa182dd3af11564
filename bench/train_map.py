"""A drive train's map on one thread and on two: ``make bench NAME=train_map``.

Prints the table of bench/records/train_map.md and writes it with ``--write``. ``--grid 6x4`` takes
another grid than 64 speeds by 24 gear temperatures. Every way computes the whole map anew, into
a store of its own.
"""

from __future__ import annotations

import argparse
import os
import platform
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.case.case import load_case
from thermogear.results.work import carry_out
from thermogear.study.diagrams import Train, case_map

if TYPE_CHECKING:
    import xarray as xr

    from thermogear.analysis.maps import MapPlan

PAGE = Path(__file__).parents[1] / "bench" / "records" / "train_map.md"
GRID = (64, 24)
COORDINATES = 13
CASE = """
title = "A lightly loaded pair on two shafts"
[gears]
module = "2.5 mm"
face_width = "24 mm"
[gears.pinion]
teeth = 27
[gears.wheel]
teeth = 44
[oil]
name = "ISO VG 100"
temperature = "60 degC"
[temperatures]
pinion_addendum = "90 degC"
pinion_bore = "80 degC"
wheel_addendum = "85 degC"
wheel_bore = "75 degC"
housing = "55 degC"
[operating]
speed = "2300 rpm"
torque = "8 N m"
[dynamics]
damping_ratio = 0.12
[transmission_error]
harmonics = [{ order = 1, amplitude = "3 um", phase = "0 deg" }]
[model]
stiffness = "textbook-30-degree"
sharing = "equal"
[train]
elements = 4
[[shafts]]
gear = "pinion"
length = "100 mm"
diameter = "30 mm"
bearings = "6206"
[[shafts]]
gear = "wheel"
length = "100 mm"
diameter = "30 mm"
bearings = "6206"
"""


def plan(grid: tuple[int, int]) -> MapPlan:
    """The map of so many speeds and temperatures."""
    axes = {
        "pinion_speed": np.linspace(1000.0, 6000.0, grid[0]) * RPM,
        "gear_temperature": np.linspace(30.0, 110.0, grid[1]) + ZERO_CELSIUS,
    }
    return case_map(load_case(CASE), axes, train=Train(coordinates=COORDINATES))


def timed(work: Callable[[], xr.Dataset]) -> tuple[xr.Dataset, str]:
    """What ``work`` computes, and a row's seconds of the clock and of all processors."""
    own, begun = time.process_time(), time.perf_counter()
    found = work()
    wall = time.perf_counter() - begun
    return found, f"{wall:.0f} | {time.process_time() - own:.0f}"


def equal(one: xr.Dataset, other: xr.Dataset) -> str:
    """How many stored arrays are equal to the last bit, and which are not."""
    names = [str(name) for name in one.variables]
    same = [n for n in names if one[n].values.tobytes() == other[n].values.tobytes()]
    rest = sorted(set(names) - set(same))
    return f"{len(same)} of {len(names)}" + (f", not {', '.join(rest)}" if rest else "")


def table(grid: tuple[int, int], show: Callable[[str], None] = print) -> list[str]:
    """Carry the map out in both ways; the rows, and what they found."""
    made = plan(grid)
    made.pilot(2)  # loads the compiled kernels
    rows = [
        "| computed by | seconds | processor seconds | equal to the last bit |",
        "|---|---|---|---|",
    ]
    for row in rows:
        show(row)
    with tempfile.TemporaryDirectory() as place:
        stores = Path(place)
        first: xr.Dataset | None = None

        def put(words: str, found: xr.Dataset, seconds: str) -> None:
            nonlocal first
            told = "" if first is None else equal(first, found)
            first = found if first is None else first
            rows.append(f"| {words} | {seconds} | {told} |")
            show(rows[-1])

        for count, words in ((1, "1 thread"), (2, "2 threads")):
            work = _threaded(made, stores / words, count)
            put(words, *timed(work))
    assert first is not None
    lost = first["lost_contact"].values
    drive, back = (100.0 * float(np.mean((lost & flag) > 0)) for flag in (1, 2))
    bearing = 100.0 * float(np.mean(lost >= 4))
    rows += [
        "",
        f"{lost.size} points, {int(first['computed'].values.sum())} of them computed, the others "
        f"spoken for by equal neighbours. The drive flank parts at {drive:.3g} % of them, the back "
        f"flank is hit at {back:.3g} %, a bearing is unloaded at times at {bearing:.3g} %.",
    ]  # fmt: skip
    show(rows[-1])
    return rows


def _threaded(made: MapPlan, store: Path, count: int) -> Callable[[], xr.Dataset]:
    return lambda: carry_out(made, store, threads=count)


def page(grid: tuple[int, int], rows: list[str]) -> str:
    """bench/records/train_map.md."""
    cores = os.cpu_count()
    return "\n".join(
        [

            "# A map of a drive train on threads", "",
            f"Made by `make bench NAME=train_map`: a map of {grid[0]} speeds (1000 to 6000 rpm) by "
            f"{grid[1]} gear temperatures",
            f"(30 to 110 °C) of a 27:44 pair on two shafts in four ball bearings, {COORDINATES} "
            "coordinates. Each way computes",
            f"everything anew; {cores} cores, {platform.machine()}. Seconds are of the clock, with "
            "whatever else the machine", "does; processor seconds are of the map alone.", "",
            *rows, "",
        ]
    )  # fmt: skip


def main() -> None:
    """Print the table, write the page where asked."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--grid", default=f"{GRID[0]}x{GRID[1]}")
    asked.add_argument("--write", action="store_true")
    said = asked.parse_args()
    one, _, two = said.grid.partition("x")
    grid = int(one), int(two)
    rows = table(grid, lambda row: print(row, flush=True))
    if said.write:
        PAGE.write_text(page(grid, rows))


if __name__ == "__main__":
    main()
