"""The pairs on which the loaded contact is held against finite elements, fixed beforehand."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from thermogear.base.errors import GeometryError, InputError
from thermogear.gears.deviations import FlankShape, PressureAngleError, Relief
from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.pair import GearPair

_MM = 1e-3


class CheckedPair(NamedTuple):
    """A pair and the line load F_n/b [N/m] of its check, its flanks, and whether corners touch."""

    name: str
    pair: GearPair
    line_load: float
    deviations: tuple[FlankShape, ...] = ()
    corners: bool = False


def _gear(
    teeth: int,
    module: float,
    bore: float,
    width: float,
    shift: float = 0.0,
    rack: Rack | None = None,
    angle: float = 20.0,
) -> Gear:
    """Module, bore radius and face width in mm, pressure angle in degrees."""
    return Gear(
        teeth,
        module * _MM,
        pressure_angle=math.radians(angle),
        profile_shift=shift,
        face_width=width * _MM,
        bore_radius=bore * _MM,
        rack=rack or Rack(),
    )


def published_pair() -> CheckedPair:
    """m 5, 25/75, bores 20/60, 200 N/mm: the pair with a published finite-element table."""
    pair = GearPair(_gear(25, 5, 20, 20), _gear(75, 5, 60, 20))
    return CheckedPair("m 5, 25/75", pair, 200e3)


def own_pairs() -> tuple[CheckedPair, ...]:
    """Four pairs that differ in module, ratio, rim and load; one of 16 teeth, one thin rim."""
    return (
        CheckedPair(
            "m 2, 16/40, x 0.3/-0.3",
            GearPair(_gear(16, 2, 7, 20, 0.3), _gear(40, 2, 15, 20, -0.3)),
            100e3,
        ),
        CheckedPair("m 8, 30/45", GearPair(_gear(30, 8, 50, 80), _gear(45, 8, 70, 80)), 500e3),
        CheckedPair(
            "m 4, 28/98, wheel rim 1.5 m",
            GearPair(_gear(28, 4, 25, 30), _gear(98, 4, 185, 30)),
            300e3,
        ),
        CheckedPair("m 3, 40/40", GearPair(_gear(40, 3, 20, 30), _gear(40, 3, 20, 30)), 50e3),
    )


def far_pairs() -> tuple[CheckedPair, ...]:
    """Pairs far from the usual tooth: the beam on a ring is up to 4.9 % too soft for them."""
    sharp, wide = (
        Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.1),
        Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.3),
    )
    return (
        CheckedPair(
            "m 4, 20/35, 25 deg",
            GearPair(
                _gear(20, 4, 16, 24, rack=wide, angle=25.0),
                _gear(35, 4, 28, 24, rack=wide, angle=25.0),
            ),
            400e3,
        ),
        CheckedPair(
            "m 4, 25/40, x 0.8/0.6",
            GearPair(_gear(25, 4, 20, 24, 0.8), _gear(40, 4, 32, 24, 0.6)),
            200e3,
        ),
        CheckedPair(
            "m 4, 30/35, fillet 0.1 m",
            GearPair(_gear(30, 4, 24, 24, rack=sharp), _gear(35, 4, 28, 24, rack=sharp)),
            400e3,
        ),
    )


def warmer(pair: GearPair, gear: str, rise: float) -> PressureAngleError:
    """The gap of one gear that is ``rise`` [K] warmer all through, as an error of its angle.

    e = -lambda rise (rho - rho_C): the base circle is larger by lambda rise.
    """
    material = pair.pinion.material if gear == "pinion" else pair.wheel.material
    slope = -material.thermal_expansion * rise
    return PressureAngleError(gear, slope / math.tan(pair.pinion.pressure_angle))


def corner_pairs() -> tuple[CheckedPair, ...]:
    """Corners beyond A and E: perfect, relieved and hot flanks, and an effective ratio near 2."""
    pair, tall = published_pair().pair, Rack(addendum=1.25, dedendum=1.6, fillet_radius=0.25)
    relief = (
        Relief("pinion", amount=15e-6, length=5e-3),
        Relief("wheel", amount=15e-6, length=5e-3),
    )
    high = GearPair(_gear(36, 3, 18, 20, rack=tall), _gear(54, 3, 30, 20, rack=tall))
    return (
        CheckedPair("m 5, 25/75", pair, 200e3, (), True),
        CheckedPair("m 5, 25/75, tips relieved by 15 um", pair, 200e3, relief, True),
        CheckedPair(
            "m 5, 25/75, pinion 60 K warmer", pair, 200e3, (warmer(pair, "pinion", 60.0),), True
        ),
        CheckedPair("m 3, 36/54, addendum 1.25", high, 150e3, (), True),
    )


def root_pairs() -> tuple[tuple[CheckedPair, str], ...]:
    """Pairs with the gear whose root is checked: usual, highly shifted, on a rim of 1.5 modules."""
    usual = published_pair()
    shifted = GearPair(_gear(25, 5, 20, 20, 0.8), usual.pair.wheel)
    thin = GearPair(_gear(40, 5, 30, 20), _gear(100, 5, 236.25, 20))
    return (
        (usual, "pinion"),
        (CheckedPair("m 5, 25/75, x 0.8/0", shifted, usual.line_load), "pinion"),
        (CheckedPair("m 5, 40/100, wheel rim 1.5 m", thin, usual.line_load), "wheel"),
    )


_SEED = 20261127
"""Of :func:`drawn_pairs`, fixed before they were compared with anything."""
_KINDS = {
    "steep": 2,
    "shifted": 2,
    "thin rim": 2,
    "contact ratio above 2": 2,
    "few teeth": 1,
    "mate's tip at the form circle": 1,
    "usual": 2,
}
"""How many pairs of each kind: 25 degrees or more; both x above 0.6; rims below 1.5 m; below 15."""


def drawn_pairs() -> tuple[CheckedPair, ...]:
    """Twelve pairs drawn at random, corners on; every second and third with relief or heat."""
    rng = np.random.default_rng(_SEED)
    kinds = [kind for kind, count in _KINDS.items() for _ in range(count)]
    return tuple(_drawn(rng, kind, i) for i, kind in enumerate(kinds))


def _drawn(rng: np.random.Generator, kind: str, number: int) -> CheckedPair:
    """Draws until a pair of the kind can be made."""
    while True:
        try:
            pair = _draw(rng, kind)
        except (GeometryError, InputError):
            continue
        if (pair.contact_ratio > 2.0) == (kind == "contact ratio above 2"):
            break
    gear, module = ("pinion", "wheel")[int(rng.integers(2))], pair.pinion.module
    load = float(rng.uniform(15e6, 50e6)) * module
    rise, amount = float(rng.uniform(60.0, 120.0)), float(rng.uniform(1.0, 4.0)) * 1e-3 * module
    choice: tuple[tuple[FlankShape, ...], str] = (
        ((), ""),
        ((Relief(gear, amount=amount, length=0.6 * module),), f", {gear} relieved"),
        ((warmer(pair, gear, rise),), f", {gear} {rise:.0f} K warmer"),
    )[number % 3]
    name = f"m {1e3 * module:g}, {pair.pinion.teeth}/{pair.wheel.teeth}, {kind}{choice[1]}"
    return CheckedPair(name, pair, load, choice[0], True)


def _draw(rng: np.random.Generator, kind: str) -> GearPair:
    """One draw, rounded as a drawing would be; errors of geometry where it cannot be made."""
    module = float(rng.choice([1.5, 2.0, 3.0, 4.0, 6.0]))
    few = kind == "few teeth"
    teeth = int(rng.integers(12, 15) if few else rng.integers(18, 45))
    mate = int(teeth * rng.uniform(1.1, 3.0))
    angle = float(rng.choice([25.0, 27.5]) if kind == "steep" else rng.choice([17.5, 20.0, 22.5]))
    low, high = (0.6, 0.8) if kind == "shifted" else (0.4, 0.5) if few else (-0.2, 0.3)
    shifts = [round(float(x), 2) for x in rng.uniform(low, high, 2)]
    tall = kind == "contact ratio above 2"
    rack = Rack(addendum=1.3, dedendum=1.6, fillet_radius=0.2) if tall else Rack(fillet_radius=0.25)
    rim = rng.uniform(1.2, 1.5, 2) if kind == "thin rim" else rng.uniform(2.0, 5.0, 2)
    roots = [
        _gear(z, module, 0.1, 20, x, rack, angle).root_radius / _MM
        for z, x in zip((teeth, mate), shifts, strict=True)
    ]
    pinion, wheel = (
        _gear(z, module, root - float(wall) * module, 20, x, rack, angle)
        for z, x, root, wall in zip((teeth, mate), shifts, roots, rim, strict=True)
    )
    pair = GearPair(pinion, wheel)
    if kind != "mate's tip at the form circle":
        return pair
    form = pinion.base_radius * pinion.junction[1]
    tip = math.hypot(wheel.base_radius, pair.line_of_action - form) - 1e-3 * pinion.module
    return GearPair(pinion, replace(wheel, tip_radius=tip))
