"""Body temperatures as the ISO reports estimate them, to compare with the heat balance."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.gears.contact import reduced_radius
from thermogear.gears.pair import GearPair
from thermogear.heat.laws import ISO_LUBRICANT_FACTOR, iso_13989_2
from thermogear.heat.losses import gear_loss_factor, mesh_loss
from thermogear.heat.lubrication import dynamic_viscosity
from thermogear.heat.scuffing import (
    body_temperature_13989_1,
    body_temperature_13989_2,
    body_temperature_15144,
)
from thermogear.mesh.operating import Operating
from thermogear.mesh.scuffing_rating import integral_flash

ESTIMATES = ("ISO/TR 13989-1", "ISO/TR 13989-2", "ISO/TR 15144-1")


def body_estimates(
    pair: GearPair, operating: Operating, mean_flash: NDArray[np.float64], dipped: bool = True
) -> NDArray[np.float64]:
    """Body temperature [K] by each of :data:`ESTIMATES`, shape (estimate, operating).

    ``mean_flash`` [K] along the path, (operating,), for part 1; the oil's temperature is that of
    ``operating``; X_S is 1.0 dipped, 1.2 sprayed. Parts 2 and 15144 take the friction of
    Michaelis. nan where an estimate has no value (contact ratio from 2 on).
    """
    oil = np.broadcast_to(np.asarray(operating.oil_temperature, dtype=float), operating.speed.shape)
    supply = 1.0 if dipped else 1.2
    speed = operating.speed * pair.pinion.pitch_radius
    tangential = operating.torque / pair.pinion.pitch_radius / pair.face_width
    alpha, working = pair.pinion.pressure_angle, pair.operating_pressure_angle
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        # the heat balance has said already where the oil leaves its line
        friction = iso_13989_2(
            tangential,
            2.0 * speed * np.tan(working) * np.cos(alpha),
            float(reduced_radius(pair, np.array([pair.path.c]))[0]),
            dynamic_viscosity(operating.lubricant, oil),
            0.5 * (pair.pinion.roughness + pair.wheel.roughness),
            factor=ISO_LUBRICANT_FACTOR.get(operating.lubricant.kind, 1.0),
        )
    path = pair.path
    approach = (path.c - path.a) / pair.base_pitch
    recess = (path.e - path.c) / pair.base_pitch
    loss = mesh_loss(
        operating.speed * operating.torque,
        friction,
        gear_loss_factor(
            teeth_1=pair.pinion.teeth, ratio=pair.ratio, approach=approach, recess=recess
        ),
    )
    first = body_temperature_13989_1(oil_temperature=oil, mean_flash=mean_flash, lubrication=supply)
    third = body_temperature_15144(
        oil,
        loss,
        centre_distance=pair.centre_distance,
        face_width=pair.face_width,
        lubrication=supply,
    )
    try:
        mean = integral_flash(pair, friction, tangential, speed)
    except InputError:
        return np.stack([first, np.full_like(first, np.nan), third])
    second = body_temperature_13989_2(oil_temperature=oil, integral_flash=mean, lubrication=supply)
    return np.stack([first, second, third])
