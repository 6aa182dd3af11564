"""The temperature dial: one operating point at gear temperatures from cold to beyond hot."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.bounds import BODY
from thermogear.base.progress import Progress, silent
from thermogear.base.units import ZERO_CELSIUS
from thermogear.base.vocabulary import STATUS, attributes, label, moves
from thermogear.case.case import GearCase
from thermogear.case.family import GearFamily
from thermogear.case.thermal_state import HOT
from thermogear.study.motion import follow_gears

COUNT = 14
"""Temperatures of a dial."""
BEYOND = 40.0
"""How far [K] it goes at least beyond the hot gears."""
FAR = 150.0
"""A jam so far [K] beyond the hot gears is still on the dial."""
CURVES = ("mesh_stiffness", "mean_stiffness", "half_backlash", "half_backlash_curve")
MOVING = ("displacement", "velocity", "section_displacement", "section_velocity",
          "label", "label_reason", "contact_loss_share")  # fmt: skip


def dial(case: GearCase, cycle: Dataset, progress: Progress = silent) -> Dataset | None:
    """Stiffness, half backlash and motion of the first operating point over ``gear_temperature``.

    ``cycle`` is the hot cycle of the case's first model: its mesh phases, and where it jams. Both
    addenda are at each temperature [K], the rest as ``temperatures.follow`` says; the start is the
    temperature of the pinion's tips when hot. ``status`` of each point; None where the heat of the
    operating point did not settle. A turn at every temperature costs too much: give it the mean
    tooth of a case whose teeth differ.
    """
    model = case.models[0]
    if not HOT.settled(case, model):
        return None
    hot = float(np.ravel(case.operating_of(model).temperatures.pinion_addendum)[0])
    jam = "proportional_jam_temperature" if case.follow == "proportional" else "jam_temperature"
    temperatures = stops(
        reference=case.stated.temperatures.reference,
        hot=hot,
        jam=float(cycle[jam].isel(operating=0)),
    )
    points = GearFamily(case, ("gear_temperature",))
    rows = temperatures[:, None]
    found = points.quasi_static(rows, CURVES)
    moved = follow_gears(
        points(rows),
        case.simulation,
        lambda done, total: progress("motion over temperature", done, total),
    )
    by = ("gear_temperature",)
    variables: dict[str, Any] = {
        name: ((*by, "mesh_phase") if found[name].ndim == 2 else by, found[name]) for name in CURVES
    }
    status = found["status"].astype(np.int8)
    speed = float(np.ravel(case.stated.speed)[0])
    if moved is not None:
        status = np.where(moves(status), moved.values["status"], status).astype(np.int8)
        mesh = case.pair.pinion.teeth * speed / (2.0 * np.pi)
        variables["time"] = (("sample",), moved.motion.phase / mesh)
        variables["order"], variables["line_frequency"] = (("order",), [1.0]), (("order",), [mesh])
        for name in MOVING:
            values = moved.values[name]
            last = "section" if name.startswith("section") else "sample"
            variables[name] = ((*by, last) if values.ndim == 2 else by, values)
    variables["status"] = (by, status)
    data = label(variables, {"mesh_phase": cycle["mesh_phase"].values})
    data = data.assign_coords(gear_temperature=temperatures)
    data["gear_temperature"].attrs = attributes("gear_temperature")
    return data.assign_attrs(
        start=int(np.argmin(np.abs(temperatures - hot))),
        jam_temperature=float(cycle[jam].isel(operating=0)),
        pinion_speed=speed,
        pinion_torque=float(np.ravel(case.stated.torque)[0]),
        jammed=int(np.sum(status == STATUS.index("jammed"))),
        mean_tooth=int(case.file.gears.period == "mesh"),
    )


def stops(*, reference: float, hot: float, jam: float) -> NDArray[np.float64]:
    """The temperatures [K] of a dial, ascending, whole degrees Celsius and ``hot`` itself.

    From the ``reference`` at which the gears are as drawn to well beyond ``hot``, and past ``jam``
    where that is near. The least and the greatest are those of a case file at most.
    """
    low, high = min(reference, hot), max(reference, hot)
    high += max(BEYOND, 0.5 * (high - low))
    if high - 10.0 < jam < max(reference, hot) + FAR:
        high = jam + 10.0
    low, high = max(low, BODY.least), min(high, BODY.most)
    row = np.round(np.linspace(low, high, COUNT) - ZERO_CELSIUS) + ZERO_CELSIUS
    row = np.clip(np.unique(row), BODY.least, BODY.most)
    row[np.argmin(np.abs(row - hot))] = hot
    return np.asarray(np.unique(row))
