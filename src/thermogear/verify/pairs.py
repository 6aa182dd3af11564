"""The pairs on which the loaded contact is held against finite elements, fixed beforehand."""

from __future__ import annotations

import math
from typing import NamedTuple

from thermogear.gears.geometry import Gear, Rack
from thermogear.gears.pair import GearPair

_MM = 1e-3


class CheckedPair(NamedTuple):
    """A pair and the line load F_n/b [N/m] of its check."""

    name: str
    pair: GearPair
    line_load: float


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
    """Pairs far from the usual tooth: the model is up to 4.4 % too soft for them."""
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
