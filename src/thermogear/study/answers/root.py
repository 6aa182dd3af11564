"""The answer of the teeth's roots: the stress in their fillets, hot and undeformed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from thermogear.base.errors import ThermogearError
from thermogear.base.limits import LIMITS
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.gears.iso6336 import root_factors, single_contact
from thermogear.gears.pair import GearPair
from thermogear.gears.root_stress import RootStress, root_stress
from thermogear.mesh.elastic import loaded_pair
from thermogear.results.answer import Answer
from thermogear.study.answers.asked import Asked, answer, undecided

ROOT = "How much does the root carry?"
POSITIONS = 60
"""Mesh phases at which the stress is looked at."""


def answers(asked: Asked) -> Iterator[Answer]:
    """Of both gears, under the shares of the loaded contact over a mesh period."""
    pair, force = asked.case.pair, asked.hot["normal_force"]
    standard, words = _standard(pair)
    bound = _nearest(pair, [0.0, 0.0])[1]
    for point in asked.points:
        at, load = asked.at(point), float(force[point])
        why = asked.still(point) or "there is no load" * (not load > 0.0)
        if why:
            yield undecided(ROOT, "root_stress", why, limit=bound, at=at)
            continue
        hot, cold = (_greatest(asked, state, point) for state in (HOT, UNDEFORMED))
        stress, undeformed = ([1e-6 * float(one.stress) for one in both] for both in (hot, cold))
        if not np.isfinite(stress + undeformed).all():
            why = "the loaded contact did not settle"
            yield undecided(ROOT, "root_stress", why, limit=bound, at=at)
            continue
        nominal = 1e-6 * load * math.cos(pair.pinion.pressure_angle)
        nominal /= pair.face_width * pair.pinion.module
        factors = zip(standard.get("form", ()), standard.get("notch", ()), strict=True)
        value, limit = _nearest(pair, stress)
        strength = "" if math.isfinite(value) else "; no fatigue strength is known of a material"
        yield answer(
            ROOT,
            "root_stress",
            "Static, the pinion's fillet carries {hot[0]:.0f MPa} hot and {undeformed[0]:.0f MPa} "
            "undeformed, the wheel's {hot[1]:.0f MPa} and {undeformed[1]:.0f MPa}, where its "
            "tangent makes {slope[0]:.0f}° and {slope[1]:.0f}° with the tooth's axis; "
            f"{words}{strength}.",
            value,
            limit=limit,
            at=at,
            figures={
                "hot": stress,
                "undeformed": undeformed,
                "slope": [math.degrees(one.slope) for one in hot],
                "way": [1e3 * float(one.way) for one in hot],
                **standard,
                "standard": [nominal * form * notch for form, notch in factors],
            },
            units={"slope": "°", "way": "mm", "standard": "MPa"},
        )


def _greatest(asked: Asked, state: ThermalState, point: int) -> tuple[RootStress, RootStress]:
    """Greatest stresses over the mesh phase at an operating point."""
    elastic = asked.elastic(state, point, asked.case.deviations)
    mesh = loaded_pair(elastic).solve(np.arange(POSITIONS) / POSITIONS)
    pinion, wheel = root_stress(asked.case.pair, mesh, asked.model.loaded.plane)
    return pinion.greatest(0), wheel.greatest(0)


def _standard(pair: GearPair) -> tuple[dict[str, Any], str]:
    """Y_F and Y_S of ISO 6336-3 for both gears and how its stress is told, or why there is none."""
    gears = zip((pair.pinion, pair.wheel), single_contact(pair), strict=True)
    try:
        form, notch = zip(*(root_factors(gear, t) for gear, t in gears), strict=True)
    except ThermogearError as error:
        return {"why": str(error)}, "ISO 6336-3 does not cover it: {why}"
    words = "ISO 6336-3 has {standard[0]:.0f MPa} and {standard[1]:.0f MPa}"
    return {"form": list(form), "notch": list(notch)}, words


def _nearest(pair: GearPair, stress: list[float]) -> tuple[float, str]:
    """The stress [MPa] that is nearest to its limit, and the limit's name.

    One without a limit has no value here, and goes before those that keep theirs.
    """
    names = [f"root_{gear.material.name}" for gear in (pair.pinion, pair.wheel)]
    most = [LIMITS[name].most if name in LIMITS else math.inf for name in names]
    ranks = [s / m if math.isfinite(m) else 1.0 for s, m in zip(stress, most, strict=True)]
    worst = int(np.argmax(ranks))
    if math.isfinite(most[worst]):
        return stress[worst], names[worst]
    return math.nan, "root_unknown"
