"""One tooth of a gear under its own Hertzian load by finite elements."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from finite_elements.contact import NEAR, held_in
from finite_elements.sector import FlankSector
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth_mesh import Density


def gear_compliance(
    gear: Gear,
    t: ArrayLike,
    half_width: float,
    density: Density | None = None,
    near: str = "strain",
) -> Floats:
    """Deflection [m/N] of one tooth along its flank's normal under its own Hertzian load.

    Tooth, body with its bore held, and the local indentation, plane stress. t: tan(alpha_k) of
    the contacts, one axis; half_width: a [m] of the pressure; density: of the mesh; near:
    see :data:`~finite_elements.contact.NEAR`. The
    deflection is the mean over the contact, weighted by the pressure. Raises InputError for a
    contact nearer than a to an end of the flank, and when scikit-fem is missing.
    """
    require_choice("near", near, tuple(NEAR))
    mesh = density or Density()
    step = half_width / (mesh.per_half_width * mesh.refinement)
    values = []
    for at in np.atleast_1d(t):
        arc = 0.5 * gear.base_radius * float(at) ** 2
        sector = FlankSector(gear, step, mesh.refinement, (arc, 1.25 * half_width))
        room = min(arc - sector.ends[0], sector.ends[1] - arc)
        if not half_width <= room:
            raise InputError(
                "position",
                f"{1e3 * room:.4g} mm from the end of the flank",
                allowed=f"> {1e3 * half_width:.4g} mm, the Hertzian half width",
                fix="take a position farther inside the path of contact",
            )
        case = sector.pressed(arc, half_width=half_width)
        load = case, sector.felt(case)
        value = float(sector.compliance(load, second=load, lag=0)[0, 0])
        if near == "strain":
            # the mean over the same pressure is 1/(2 pi) less than at its middle
            value += held_in(gear, float(at), in_stress=half_width, in_strain=half_width)
            value += gear.material.poisson_ratio**2 / (2.0 * np.pi)
        values.append(value)
    return np.array(values) / (gear.material.youngs_modulus * gear.face_width)
