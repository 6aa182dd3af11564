"""The first lines of the page: one paragraph and the figures that matter."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, celsius, display, number, percent, span
from thermogear.base.vocabulary import STATUS, STILL, is_known, told_labels, told_operating
from thermogear.results.result import Result
from thermogear.views.columns import Row, rows_along
from thermogear.views.page import Tile
from thermogear.views.style import names_of
from thermogear.views.tables import JAMMED, jam_words
from thermogear.views.typesetting import jam_at

STUDIED = "1.1 to 1.3"
"""Frequency ratios of the thesis's bifurcation study."""


def summary(results: Result) -> str:
    """One paragraph with the key numbers."""
    mesh = results.group("mesh")
    if mesh is None:
        return _rows_summary(results.group("points"))
    speeds = span(np.unique(display("pinion_speed")(mesh["pinion_speed"].values)), 4)
    torques = span(np.unique(mesh["pinion_torque"].values), 4)
    count = mesh.sizes["operating"]
    points = f"{count} operating point" + ("s" if count > 1 else "")
    parts = [f"{points}: pinion at {speeds} rpm under {torques} N m{_heat(mesh)}."]
    parts += [_bundle(mesh, place) for place in range(mesh.sizes["bundle"])]
    parts.append(_regime(mesh, _studied(results)))
    motion = results.group("motion")
    if motion is not None:
        for state in names_of(motion, "state"):
            here = motion.isel(state=names_of(motion, "state").index(state))
            parts.append(f"Motion {state}: {_count(here)}.")
    return " ".join(part for part in parts if part)


def _heat(mesh: Dataset) -> str:
    if "hot_temperature" not in mesh:
        return ""
    cold, hot = (mesh["hot_temperature"].isel(state=i).values for i in (0, -1))
    drawn, pinion = celsius(float(cold.min())), celsius(float(hot.max()))
    wheel = (
        celsius(float(mesh["hot_wheel_temperature"].isel(state=-1).max()))
        if "hot_wheel_temperature" in mesh
        else pinion
    )
    gears = f"gears at {pinion}" if wheel == pinion else f"pinion at {pinion}, wheel at {wheel}"
    colder = "; the state of operation, here a cold one, is called hot" * bool(
        hot.max() < cold.min()
    )
    return f"; {gears} against {drawn} undeformed{colder}"


def _bundle(mesh: Dataset, place: int) -> str:
    name = names_of(mesh, "bundle")[place]
    here = mesh.isel(bundle=place)
    cold, hot = here.isel(state=0), here.isel(state=-1)
    status = hot["status"].values
    if not is_known(status).any():
        why = "; ".join(STILL[STATUS[code]] for code in np.unique(status))
        return f"In the {name} bundle nothing hot is known: {why}."
    change = hot["mean_stiffness"].values / cold["mean_stiffness"].values - 1.0
    stiffness = f"the mean mesh stiffness changes by {_percents(change)}"
    jammed = int((hot["status"] == JAMMED).sum())
    jam = hot["jam_temperature"].values
    if jammed:
        where = f"{jammed} of {hot.sizes['operating']} points"
        at = f"gap used up at {celsius(float(np.nanmin(jam)))}" if np.isfinite(jam).any() else ""
        if bool((cold["status"] == JAMMED).any()):
            at = "without heat already"
        at = f" ({at})" if at else ""
        return f"In the {name} bundle the hot pair is jammed at {where}{at}; {stiffness}."
    before = span(MICROMETRE(cold["half_backlash"].values))
    after = span(MICROMETRE(hot["half_backlash"].values))
    return (
        f"In the {name} bundle the temperatures take the half backlash from {before} to {after} µm "
        f"and {stiffness}."
    )


def _percents(ratios: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> str:
    low, high = percent(float(ratios.min())), percent(float(ratios.max()))
    return low if low == high else f"{low} to {high}"


def _studied(results: Result) -> bool:
    """Whether the thesis's bifurcation study is about this case."""
    return results.text("thesis_case") == "1"


def _regime(mesh: Dataset, studied: bool) -> str:
    ratio = mesh["frequency_ratio"].isel(bundle=0, state=0).values
    frequency = span(mesh["natural_frequency"].isel(bundle=0, state=0).values, 4)
    place = "below" if ratio.max() < 0.9 else "above" if ratio.min() > 1.1 else "around"
    return (
        f"The mesh frequency lies at {span(ratio)} of the natural frequency of the "
        f"undeformed mean stiffness ({frequency} Hz), "
        f"{place} the resonance"
        + (f"; the thesis's bifurcation study speaks of {STUDIED}." if studied else ".")
    )


def _count(motion: Dataset) -> str:
    found = Counter(map(str, told_labels(motion).flat))
    if len(found) == 1:
        name = next(iter(found))
        return f"{name} throughout"
    return ", ".join(f"{count} × {name}" for name, count in found.most_common())


def _rows_summary(points: Dataset | None) -> str:
    if points is None:
        return "These results hold no group that could be drawn."
    return (
        f"{points.sizes['point']} points of the dimensionless equation of motion; found: "
        f"{_count(points)}. These numbers are not derived from any gear pair."
    )


def _rising(hot: Row) -> str:
    """Where the pair jams with shafts and housing rising in proportion to the gears."""
    jam = hot.get("proportional_jam_temperature", math.nan)
    return f"; all bodies in proportion: {jam_at(jam)}" if math.isfinite(jam) else ""


def tiles(results: Result) -> list[Tile]:
    """The figures that matter, of the first bundle, the others beside them."""
    mesh = results.group("mesh")
    if mesh is None:
        return []
    names = names_of(mesh, "bundle")
    told = mesh.isel(operating=told_operating(mesh))
    cold, hot = (rows_along(told.isel(state=end), "bundle") for end in (0, -1))
    gaps = [
        "jammed" if row["status"] == "jammed" else f"{number(MICROMETRE(row['half_backlash']))} µm"
        for row in hot
    ]
    change = [
        percent(row["mean_stiffness"] / bare["mean_stiffness"] - 1.0)
        for row, bare in zip(hot, cold, strict=True)
    ]
    jam = [jam_words("jam_temperature", row, bare) for row, bare in zip(hot, cold, strict=True)]
    found = [
        Tile(
            "hot half backlash",
            gaps[0],
            f"undeformed {number(MICROMETRE(cold[0]['half_backlash']))} µm" + _beside(names, gaps),
        ),
        Tile(
            "mean mesh stiffness, hot against undeformed",
            change[0],
            names[0] + _beside(names, change),
        ),
        Tile(
            "backlash used up at", jam[0], f"housing as it is{_beside(names, jam)}{_rising(hot[0])}"
        ),
    ]
    path = results.group("path")
    if path is not None and "flash_temperature" in path:
        top = path["flash_temperature"].isel(state=-1).max(["operating", "path_position"]).values
        text = [f"{number(float(t))} K" for t in top]
        if math.isfinite(float(top[0])):
            found.append(
                Tile("highest flash temperature", text[0], names[0] + _beside(names, text))
            )
    ratio = mesh["frequency_ratio"].isel(bundle=0, state=0).values
    found.append(
        Tile(
            "mesh over natural frequency of the undeformed mean stiffness",
            span(ratio, 2),
            f"thesis's study {STUDIED}" if _studied(results) else "1 is the resonance",
        )
    )
    motion = results.group("motion")
    if motion is not None:
        here = motion.isel(bundle=0, state=-1)
        found.append(
            Tile(
                "motion, hot",
                _count(here).removesuffix(" throughout"),
                f"{names[0]}, every operating point",
            )
        )
    return found


def _beside(names: list[str], values: list[str]) -> str:
    return "".join(f"; {n} {v}" for n, v in zip(names[1:], values[1:], strict=True))
