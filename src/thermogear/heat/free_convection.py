"""Free convection from gears at rest: what conducts heat to the oil when nothing turns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.materials import Lubricant
from thermogear.gears.geometry import Gear
from thermogear.heat.gearbox import Surroundings, oil_prandtl
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.heat.network import ThermalNetwork
from thermogear.heat.still_air import free_face_convection


def oil_expansion(lubricant: Lubricant, temperature: ArrayLike) -> NDArray[np.float64]:
    """Volume expansion of an oil, beta = -(d rho/dT)/rho [1/K]; ``temperature`` [K], any shape.

    >>> oil = lubricant("FVA3")
    >>> f"{1e3 * oil_expansion(oil, 333.15):.3f} 1/kK"
    '0.813 1/kK'
    """
    return np.asarray(lubricant.density_slope / density(lubricant, temperature))


def with_free_convection(
    network: ThermalNetwork,
    gears: Mapping[str, Gear],
    lubricant: Lubricant,
    surroundings: Surroundings,
    temperatures: Mapping[str, ArrayLike],
) -> ThermalNetwork:
    """``network`` where teeth and faces give the oil at least what free convection carries.

    The convection of a rotating face is 0 at rest; a hot gear in its bath then still cools. Each
    conductance [W/K] between a gear's tooth or body and the oil is the greater of its own and of
    the wetted share of flanks and faces times
    :func:`~thermogear.heat.still_air.free_face_convection`, the tip diameter as height: the
    customary estimate where forced and free convection meet. Where a gear turns at more than a few
    rpm nothing changes. Shafts conduct into the housing, and the oil's walls keep the coefficient
    they are given.

    ``gears`` by "pinion" and "wheel", ``temperatures`` [K] by node, arrays over operating points.
    """
    oil = np.asarray(temperatures["oil"], dtype=float)
    known = (
        kinematic_viscosity(lubricant, oil),
        lubricant.thermal_conductivity,
        oil_prandtl(lubricant, oil),
    )
    least: dict[str, NDArray[np.float64]] = {}
    for (name, gear), share in zip(gears.items(), surroundings.wetted_share, strict=True):
        areas = {
            f"{name}_tooth": 2.0
            * gear.teeth
            * gear.face_width
            * (gear.tip_radius - gear.root_radius),
            f"{name}_body": 2.0 * np.pi * (gear.root_radius**2 - gear.bore_radius**2),
        }
        for node, area in areas.items():
            film = free_face_convection(
                np.asarray(temperatures[node], dtype=float) - oil,
                2.0 * gear.tip_radius,
                *known,
                expansion=oil_expansion(lubricant, oil),
            )
            least[node] = share * area * film
    links = tuple(
        replace(link, conductance=np.maximum(link.conductance, least[link.first]))
        if link.second == "oil" and link.first in least
        else link
        for link in network.links
    )
    return replace(network, links=links)
