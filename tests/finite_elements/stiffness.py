"""Mesh stiffness, deflection and load shares of a pair from finite elements of both whole gears.

Both gears are sectors with finely divided flanks (:mod:`finite_elements.sector`) in frictionless
contact (:mod:`finite_elements.contact`). Body and tooth stand in plane stress. A line contact is
far wider than deep, so that the material around it stands in plane strain, by default as far as
the tooth's axis: the state that Weber and Banaschek's law supposes, whose difference between both
plane states is added to each pair of teeth. ``near="stress"`` leaves that out; it makes steel
pairs 1.5 .. 2.5 % softer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from finite_elements.contact import NEAR, FlankContact
from finite_elements.sector import FlankSector
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.contact import hertz_half_width
from thermogear.gears.deviations import FlankShape
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density

_MOST_ROWS = 900
"""Elements along a flank that a mesh may have."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FinitePair:
    """Deflection [m] and secant stiffness [N/m], (position,), and shares (position, pair).

    ``phase`` in periods from A. Pair 0 has not yet entered, pair 1 is the last that did; shares of
    pairs that do not touch are 0.
    """

    phase: Floats
    deflection: Floats
    secant: Floats
    share: Floats


@lru_cache(maxsize=2)
def _sectors(pair: GearPair, line_load: float, density: Density) -> tuple[FlankSector, FlankSector]:
    """Meshes whose elements are a part of the half width of one pair at the pitch point.

    Remembered with what was solved on them, which is most of the work: the plane state around the
    contacts and the model beside play no part in it.
    """
    materials = (pair.pinion.material, pair.wheel.material)
    modulus = 1.0 / sum((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in materials)
    rho = pair.path.c * (1.0 - pair.path.c / pair.line_of_action)
    half_width = float(hertz_half_width(line_load, rho, modulus))
    step = half_width / (density.per_half_width * density.refinement)

    def sector(gear: Gear) -> FlankSector:
        low, high = FlankSector(gear, step).ends
        return FlankSector(gear, min(max(step, (high - low) / _MOST_ROWS), (high - low) / 20))

    return sector(pair.pinion), sector(pair.wheel)


def pair_stiffness(
    pair: GearPair,
    normal_force: float,
    phase: ArrayLike,
    density: Density | None = None,
    near: str = "strain",
    *,
    deviations: Sequence[FlankShape] = (),
    corners: bool = False,
    edge_radius: tuple[float, float] = (0.0, 0.0),
) -> FinitePair:
    """Secant stiffness and load shares at ``phase`` (periods from A) by finite elements.

    Both gears whole, plane stress, bores held, frictionless contact. normal_force: F_n [N] > 0, of
    the pinion's torque over r_b1; density: of the meshes; near: plane state around the contacts;
    deviations: of the drive flanks; corners: contact beyond A and E too, of tip edges rounded by
    ``edge_radius`` [m] of pinion and wheel. The deflection counts from the touch of perfect
    involutes. Raises InputError for a load that is not positive.
    """
    if not (np.isfinite(normal_force) and normal_force > 0.0):
        raise InputError("normal_force", f"{normal_force} N", allowed="> 0, finite")
    phi = np.atleast_1d(np.asarray(phase, dtype=float))
    if not np.all((phi >= 0.0) & (phi < 1.0)):
        raise InputError("phase", phi, allowed="0 <= phase < 1")
    require_choice("near", near, tuple(NEAR))
    line_load = normal_force / pair.face_width
    contact = FlankContact(
        pair,
        _sectors(pair, line_load, density or Density()),
        deviations=deviations,
        edge_radius=edge_radius,
        corners=corners,
        near=near,
    )
    solved = [contact.solve(line_load, float(at)) for at in phi]
    deflection = np.array([at.deflection for at in solved])
    numbers = range(-1, int(np.ceil(pair.contact_ratio)) + 1)
    return FinitePair(
        phase=phi,
        deflection=deflection,
        secant=normal_force / deflection,
        share=np.array([[at.force.get(n, 0.0) for n in numbers] for at in solved]) / line_load,
    )
