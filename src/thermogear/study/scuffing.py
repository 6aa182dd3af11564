"""Against which limits is judged: scuffing by the FZG load stage, a jam by what gears bear."""

from __future__ import annotations

from typing import NamedTuple

from thermogear.base.materials import Material
from thermogear.case.case import GearCase
from thermogear.gears.pair import GearPair

STAGE = 12.0
"""FZG load stage of an oil of which none is given: the least of CLP oils (DIN 51517-3; usual)."""


class LoadStage(NamedTuple):
    """The FZG load ``stage`` scuffing is judged by, and whether it is ``assumed``."""

    stage: float
    assumed: bool


def load_stage(case: GearCase) -> LoadStage:
    """The stage of the oil of ``case``; :data:`STAGE` where it gives none."""
    given = case.scuffing_load_stage
    return LoadStage(STAGE, True) if given is None else LoadStage(float(given), False)


def not_steel(case: GearCase) -> str:
    """The name of a gear's material the rating is not for; empty where it is steel on steel."""
    for gear in (case.pair.pinion, case.pair.wheel):
        if not steel(gear.material):
            return gear.material.name
    return ""


def steel(material: Material) -> bool:
    """Whether a material has the stiffness and the density of steel."""
    return 180e9 <= material.youngs_modulus <= 230e9 and 7500.0 <= material.density <= 8200.0


def borne_by(pair: GearPair) -> tuple[float, str]:
    """Temperature [K] beyond which nothing is said of a jam, and why: of both gears the lower."""
    return min(gear.material.bears for gear in (pair.pinion, pair.wheel))
