"""The line below a page's title: which study, at which point, what was fixed, when, what with."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE, celsius, number, span
from thermogear.base.parameters import PARAMETERS
from thermogear.base.toml import told
from thermogear.results.result import Result

STUDIES = {
    "gear": "Run", "dimensionless": "Run", "answers": "Answers", "diagram": "Orbit diagram",
    "map": "Map of regimes", "basins": "Basins of attraction",
    "basin-shares": "Basins along a parameter", "sweep": "Sweep",
    "run-up": "Run-up and run-down", "waterfall": "Run-up of the drive train",
    "warmup": "Warm-up", "temperature": "Heat balance",
    "relief": "Tip relief", "contact": "Loaded contact", "friction": "Friction laws",
    "orbit": "Orbit", "lyapunov": "Lyapunov exponent", "branch": "Branches of orbits",
    "shared": "Two forms of the mesh force",
    "drawing": "Drawing", "versus": "Comparison of cases", "thesis": "The thesis's claims",
    "measurement": "Measurement", "comparison": "Comparison with a record",
    "detect": "Detection of faults",
    "sensitivity": "Sensitivity", "statics": "Loads of shafts and bearings",
    "modes": "Modes of the drive train", "campbell": "Campbell diagram",
}  # fmt: skip
MODEL = {
    "damping_ratio": "ζ", "frequency": "mesh over natural frequency",
    "half_backlash": "half backlash", "stiffness_amplitude": "ε", "mean_force": "mean force",
    "force_amplitude": "force amplitude",
}  # fmt: skip
MOST_CHANGES = 6


def who(result: Result) -> str:
    """Study, operating point, fixed parameters, version and date of the run, as one line.

    All of it is stored: a page drawn again says the same.
    """
    parts = [
        STUDIES.get(result.kind, result.kind.replace("-", " ").capitalize()),
        *dict.fromkeys(_fixed(result)),
        f"thermogear {result.text('thermogear')}" if result.text("thermogear") else "",
        _date(result.text("created")),
    ]
    return " · ".join(part for part in parts if part)


def _date(created: str) -> str:
    """Day and minute of the run, as stored: universal time."""
    if not created:
        return "date not stored"
    day, _, time = created.partition("T")
    return f"{day} {time[:5]} UTC" if time else day


def _fixed(result: Result) -> Iterator[str]:
    data = next((g for n in ("mesh", "path", "map", "steady", "speeds", "")
                 if (g := result.group(n)) is not None), None)  # fmt: skip
    if data is not None:
        yield from _points(data)
    torque = result.text("torque") or result.text("pinion_torque")
    if torque:
        yield f"{float(torque):.6g} N m"
    if data is not None and result.stored:
        yield from _of_the_case(result, data)
    yield from _heat(result)
    bundles = result.table("bundles")
    bundle = " and ".join(bundles) if bundles else result.text("bundle")
    if bundle:
        yield f"{bundle} bundle"
    model = result.table("model")
    if "mesh_frequency" in model:  # a drive train, in SI
        yield f"mesh frequency {number(float(model['mesh_frequency']), 4)} Hz"
        yield f"half backlash {number(MICROMETRE(float(model['half_backlash'])), 4)} µm"
        model = {}
    for name, value in model.items():
        if name in MODEL and isinstance(value, int | float):
            yield f"{MODEL[name]} {number(float(value), 4)}"
    changes = [told(str(path), str(text)) for path, text in result.values("overrides")]
    yield from changes[:MOST_CHANGES]
    if len(changes) > MOST_CHANGES:
        yield f"{len(changes) - MOST_CHANGES} more changes (see the case file)"


def _of_the_case(result: Result, data: Dataset) -> Iterator[str]:
    """Speed and torque as the case file gives them, where they are no axis: the first of each."""
    try:
        given = tomllib.loads(result.text("case")).get("operating", {})
    except tomllib.TOMLDecodeError:
        return
    changed = {str(path) for path, _ in result.values("overrides")}
    for name in ("speed", "torque"):
        asked = name == "torque" and result.text("torque")
        if f"pinion_{name}" in data.dims or f"operating.{name}" in changed or asked:
            continue
        value = given.get(name)
        value = value[0] if isinstance(value, list) and value else value
        if isinstance(value, str):
            yield value


def _points(data: Dataset) -> Iterator[str]:
    """Speeds, torques and the other axes, each a value or a span."""
    names = ["pinion_speed", "pinion_torque"]
    names += [str(n) for n in data.dims if str(n) in PARAMETERS and str(n) not in names]
    for name in names:
        if name not in data.variables:
            continue
        values = np.unique(np.asarray(data[name].values, dtype=float))
        values = values[np.isfinite(values)]
        if not values.size:
            continue
        parameter = PARAMETERS[name]
        words = "" if name in ("pinion_speed", "pinion_torque") else parameter.words
        shown = span(np.asarray(parameter.show(values)), 5)
        yield f"{words} {shown} {parameter.shown}".strip()


def _heat(result: Result) -> Iterator[str]:
    state: Any = result.text("state")
    if state:
        try:
            yield f"gears at {celsius(float(state))}"
        except ValueError:
            yield state if state == "undeformed" else f"gears {state}"
