"""Shafts and bearings for a pair that has none: sized by its torque, out of the catalogue."""

from __future__ import annotations

import math

from thermogear.base.errors import InputError
from thermogear.base.toml import line, table
from thermogear.case.case import GearCase
from thermogear.gears.geometry import Gear
from thermogear.shafts.bearings.catalogue import CATALOGUE
from thermogear.shafts.bearings.geometry import RollingBearing
from thermogear.shafts.bearings.life import rating_life
from thermogear.shafts.train import SHAFTS

SHEAR, MOST_SHEAR = 20e6, 40e6
"""Shear stress [Pa] of the torque that a first draft of a shaft takes; the most it may take."""
LIFE = 10_000 * 3600.0
"""L10 [s] that bearings are chosen for where the catalogue has such."""
AIR = 5e-3
"""Between gear and bearing [m]."""


def shaft_lines(case: GearCase) -> list[str]:
    """Tables of two shafts with a ball bearing at each end, the gear between them.

    Diameter d = (16 T/(pi tau))^(1/3) at least, T the greatest torque of the shaft and tau
    :data:`SHEAR`, up to the next bore of the catalogue; the bearing the lightest of those that
    live :data:`LIFE` under half the mesh force, else the strongest. InputError where none fits.
    """
    found: list[str] = []
    torque, speed = max(case.torques), max(case.speeds)
    force = torque / case.pair.pinion.base_radius
    for name, gear in zip(SHAFTS, (case.pair.pinion, case.pair.wheel), strict=True):
        ratio = gear.teeth / case.pair.pinion.teeth
        turns = speed / ratio / (2.0 * math.pi)
        one = _bearing(name, gear, torque * ratio, 0.5 * force, turns)
        stress = 16.0 * torque * ratio / (math.pi * one.bore**3)
        hours = float(rating_life(one, 0.5 * force)) / turns / 3600.0
        length = 1e3 * (gear.face_width + 2.0 * (one.width + AIR))
        found += table(
            "[shafts]",
            line("gear", name),
            line("length", f"{math.ceil(length - 1e-6)} mm", "the gear in the middle"),
            line("diameter", f"{1e3 * one.bore:.6g} mm", f"{1e-6 * stress:.3g} MPa by the torque"),
            line("bearings", one.designation, f"one at each end; L10 {hours:.2g} h"),
        )
    return found


def _bearing(name: str, gear: Gear, torque: float, load: float, turns: float) -> RollingBearing:
    """The ball bearing of a shaft: ``torque`` [N m], ``load`` [N], ``turns`` [1/s]."""
    least = (16.0 * torque / (math.pi * SHEAR)) ** (1.0 / 3.0)
    bare = (16.0 * torque / (math.pi * MOST_SHEAR)) ** (1.0 / 3.0)
    root = 2.0 * gear.root_radius
    fits = [
        one
        for one in CATALOGUE.values()
        if one.kind == "ball" and one.contact_angle == 0.0 and bare <= one.bore < root
    ]
    if not fits:
        bores = sorted({one.bore for one in CATALOGUE.values()})
        raise InputError(
            "--shafts",
            f"{torque:.6g} N m on the {name}'s shaft",
            allowed=f"a bore of {1e3 * bores[0]:.6g}..{1e3 * bores[-1]:.6g} mm, over "
            f"{1e3 * bare:.4g} mm for the torque and inside the root circle of {1e3 * root:.4g} mm",
            why="the catalogue has no ball bearing of that size",
            fix="leave --shafts out and describe the bearings by inside = {...}",
        )
    fits.sort(key=lambda one: (one.bore < least, one.bore, one.dynamic_rating or 0.0))
    lasting = (one for one in fits if float(rating_life(one, load)) >= LIFE * turns)
    return next(lasting, max(fits, key=lambda one: one.dynamic_rating or 0.0))
