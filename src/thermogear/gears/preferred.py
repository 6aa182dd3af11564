"""What is usual before a gear is drawn: the basic racks of ISO 53 and the modules of ISO 54.

They are offered, never put in a given value's place: gears by diametral pitch lie between them.
"""

from __future__ import annotations

from typing import NamedTuple

from thermogear.base import bounds
from thermogear.base.errors import InputError, nearest
from thermogear.gears.geometry import Rack

PROFILES: dict[str, Rack] = {
    "A": Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.38),
    "B": Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.30),
    "C": Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.25),
    "D": Rack(addendum=1.0, dedendum=1.40, fillet_radius=0.39),
}
"""Basic rack tooth profiles of ISO 53 at 20 degrees: A for high torques (DIN 867), B and C for
ordinary use, D for ground teeth with a full round. Source: ISO 53 as public codes carry it."""

# fmt: off
FIRST_CHOICE = (
    1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 25.0, 32.0, 40.0,
    50.0,
)
SECOND_CHOICE = (
    1.125, 1.375, 1.75, 2.25, 2.75, 3.5, 4.5, 5.5, 6.5, 7.0, 9.0, 11.0, 14.0, 18.0, 22.0, 28.0,
    36.0, 45.0,
)
# fmt: on
"""Modules of ISO 54 [mm], series I and II; of II, 6.5 should be avoided."""


class ModuleAdvice(NamedTuple):
    """The module of ISO 54 nearest to a given one [m], its series, and whether it is the same.

    >>> nearest_module(4e-3).preferred
    True
    """

    module: float
    series: str
    preferred: bool


def profile(name: str) -> Rack:
    """The basic rack ``name`` of ISO 53, or an error that says which there are.

    >>> profile("A")
    Rack(addendum=1.0, dedendum=1.25, fillet_radius=0.38)
    """
    if name not in PROFILES:
        raise InputError(
            "profile", repr(name), allowed=" | ".join(PROFILES), fix=nearest(name, PROFILES)
        )
    return PROFILES[name]


def nearest_module(module: float) -> ModuleAdvice:
    """The module of ISO 54 next to ``module`` [m], by ratio; of two as near the first choice.

    ``preferred`` where it is the given one: nothing needs to be said then. A diametral pitch, m =
    25.4 mm/DP, mostly is not.

    >>> nearest_module(4.1e-3)
    ModuleAdvice(module=0.004, series='I', preferred=False)
    """
    bounds.MODULE.require_number("module", module)
    table = [(m, "I") for m in FIRST_CHOICE] + [(m, "II") for m in SECOND_CHOICE]

    def apart(entry: tuple[float, str]) -> float:
        ratio = 1e3 * module / entry[0]
        return max(ratio, 1.0 / ratio)

    size, series = min(table, key=apart)
    return ModuleAdvice(1e-3 * size, series, apart((size, series)) < 1.0 + 1e-9)
