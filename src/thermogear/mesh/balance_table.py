"""The heat balance of a pair as a labelled Dataset, and what is not known where it has none."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.vocabulary import HEAT_NOT_SETTLED, STATUS, label
from thermogear.heat.gearbox import Losses
from thermogear.mesh.balance import HeatBalance
from thermogear.mesh.turn_spread import OF_TURN, OF_WORST_PAIR

LOSSES = ("mesh", "churning", "bearing_1", "bearing_2")

_MEANING = {
    "node_temperature": ("K", "temperature of a node of the heat balance"),
    "loss": ("W", "heat that a loss sets free"),
    "heat_to_ambient": ("W", "heat that leaves the housing"),
    "iterations": ("1", "iterations of the closed loop"),
    "residual": ("K", "greatest change of a node in the last iteration"),
    "hot_node_temperature": (
        "K",
        "temperature of a node in the steady state reached from hot, nan where there is none",
    ),
    "several": ("1", "1 where from hot another steady state is reached than from cold"),
}


def of_bearings(
    losses: Losses, along: str, count: int
) -> tuple[dict[str, tuple[Any, ...]], dict[str, list[str]]]:
    """Loss, temperature and viscosity of every bearing over (``along``, bearing), for ``label``.

    With the coordinate of their names; nothing without a drawn train.
    """
    if not losses.bearings:
        return {}, {}

    def stacked(name: str) -> NDArray[np.float64]:
        each = [getattr(one, name) for one in losses.bearings.values()]
        return np.stack([np.broadcast_to(np.asarray(v, float), (count,)) for v in each], axis=-1)

    found = {
        f"bearing_{name}": ((along, "bearing"), stacked(name), unit, words)
        for name, unit, words in (
            ("loss", "W", "friction of a bearing"),
            ("temperature", "K", "mean temperature of both rings of a bearing"),
            ("viscosity", "m^2/s", "kinematic viscosity of the oil at a bearing's temperature"),
        )
    }
    return found, {"bearing": list(losses.bearings)}


def balance_dataset(balance: HeatBalance) -> Dataset:
    """Node temperatures, losses, iterations, residual and status, axis ``operating`` first.

    Of each bearing of a drawn train its loss, temperature and viscosity. Status heat_not_settled
    where the loop did not settle.
    """
    count = balance.operating.speed.size
    nodes = {
        name: np.broadcast_to(values, (count,))
        for name, values in balance.steady.temperatures.items()
    }
    losses = [np.broadcast_to(getattr(balance.losses, name), (count,)) for name in LOSSES]
    heat = np.broadcast_to(balance.steady.heat_out["ambient"], (count,))
    values: Mapping[str, tuple[tuple[str, ...], ArrayLike]] = {
        "node_temperature": (("operating", "node"), np.stack(list(nodes.values()), axis=-1)),
        "loss": (("operating", "loss_kind"), np.stack(losses, axis=-1)),
        "heat_to_ambient": (("operating",), heat),
        "iterations": (("operating",), balance.iterations),
        "residual": (("operating",), balance.residual),
        "hot_node_temperature": (
            ("operating", "node"),
            np.stack([balance.hot.get(name, held) for name, held in nodes.items()], axis=-1),
        ),
        "several": (("operating",), balance.several.astype(np.int8)),
    }
    described: dict[str, Any] = {n: (*entry, *_MEANING[n]) for n, entry in values.items()}
    bearings, names = of_bearings(balance.losses, "operating", count)
    status = np.where(balance.settled, STATUS.index("ok"), HEAT_NOT_SETTLED)
    return label(
        described | bearings | {"status": (("operating",), status)},
        {
            "node": list(nodes),
            "loss_kind": list(LOSSES),
            "pinion_speed": ("operating", balance.operating.speed),
            "pinion_torque": ("operating", balance.operating.torque),
            **names,
        },
        {"lost": json.dumps({str(place): why for place, why in balance.lost.items()})},
    )


STATED = ("normal_force", "cold_half_backlash")
"""What an operating point has without any temperature."""
OF_OIL = (
    "dynamic_viscosity",
    "film_thickness",
    "film_parameter",
    "friction_coefficient",
    "friction_coefficient_mixed",
    "flash_temperature",
    "flash_temperature_mixed",
    "contact_temperature",
    "frictional_power",
    "pinion_share_of_heat",
    "power_off_the_path",
    "mesh_efficiency",
    *OF_WORST_PAIR,
    *(name for name, of in OF_TURN.items() if of != "hertz_pressure"),
)
"""What of an undeformed pair depends on the oil's temperature."""


def blanked(data: Dataset, lost: NDArray[np.bool_], names: Sequence[str] | None = None) -> Dataset:
    """``data`` with nan in the numbers ``names`` (all) of the points that are ``lost``.

    Positions, phases and what else belongs to no point stay, and so do flags: the status says
    what they are worth.
    """
    if not lost.any():
        return data
    import xarray as xr

    known = xr.DataArray(~lost, dims="operating")
    asked = set(map(str, data.data_vars) if names is None else names) - set(STATED)
    numbers = {
        str(name): values.where(known).transpose(*values.dims).assign_attrs(values.attrs)
        for name, values in data.data_vars.items()
        if str(name) in asked and "operating" in values.dims and values.dtype.kind == "f"
    }
    return data.assign(numbers)
