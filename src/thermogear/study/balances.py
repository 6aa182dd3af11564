"""The computed temperatures of a case as a labelled Dataset, and in words."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.base.vocabulary import STATUS, dressed, label, labelled
from thermogear.case.case import GearCase
from thermogear.mesh.balance import HeatBalance
from thermogear.mesh.clearance import clearance
from thermogear.mesh.thermal import HotPair

Floats = NDArray[np.float64]

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


def status_of(balance: HeatBalance) -> xr.Variable:
    """ok, or not_converged where the loop did not settle, (operating,)."""
    values = np.where(balance.settled, STATUS.index("ok"), STATUS.index("not_converged"))
    return labelled("status", (("operating",), values))


def balance_dataset(balance: HeatBalance) -> xr.Dataset:
    """Node temperatures, losses, iterations, residual and status, axis ``operating`` first."""
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
    described = {name: (*entry, *_MEANING[name]) for name, entry in values.items()}
    return label(
        described | {"status": status_of(balance)},
        {
            "node": list(nodes),
            "loss_kind": list(LOSSES),
            "pinion_speed": ("operating", balance.operating.speed),
            "pinion_torque": ("operating", balance.operating.torque),
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
)
"""What of an undeformed pair depends on the oil's temperature."""


def blanked(
    data: xr.Dataset, lost: NDArray[np.bool_], names: Sequence[str] | None = None
) -> xr.Dataset:
    """``data`` with nan in the numbers ``names`` (all) of the operating points that are ``lost``.

    Positions, phases and what else belongs to no point stay, and so do flags: the status says
    what they are worth.
    """
    if not lost.any():
        return data
    asked = set(map(str, data.data_vars) if names is None else names) - set(STATED)
    known = xr.DataArray(~lost, dims="operating")
    numbers = {
        str(name): values.where(known).transpose(*values.dims).assign_attrs(values.attrs)
        for name, values in data.data_vars.items()
        if str(name) in asked and "operating" in values.dims and values.dtype.kind == "f"
    }
    return data.assign(numbers)


def reasons(balance: xr.Dataset, bundle: str) -> str:
    """Why points have no value at all, each reason once."""
    why = json.loads(balance.attrs.get("lost", "{}")).get(bundle, {})
    return f" No value: {'; '.join(dict.fromkeys(why.values()))}." if why else ""


def several_words(*, several: int, count: int, hotter: float) -> str:
    """That points have two steady states, and which one is told; ``hotter`` [K], nan: unknown."""
    some = "1 point has" if several == 1 else f"{several} points have"
    some = "The point has" if count == 1 else f"Of {count} points, {some}"
    far = f", up to {hotter:.1f} K hotter" if np.isfinite(hotter) else ""
    return (
        f"{some} another steady state when they come from hot{far}: thinner oil lets the layer on "
        "the gears turn turbulent, which drags more. All figures are those of the state reached "
        "from cold."
    ).replace("when they come", "when it comes" if several == 1 else "when they come")


def balances(case: GearCase) -> xr.Dataset:
    """The heat balance of every bundle of a case whose temperatures are computed."""
    each = [balance_dataset(case.balance(model)) for model in case.models]
    axis = xr.DataArray([model.name for model in case.models], dims="bundle", name="bundle")
    why = [json.loads(data.attrs.pop("lost")) for data in each]
    lost = dict(zip((model.name for model in case.models), why, strict=True))
    whole = xr.concat(each, axis).assign_attrs(lost=json.dumps(lost))
    readings = [
        {
            "node": one.node,
            "kind": one.kind,
            "indicated_K": one.indicated,
            "temperature_K": one.temperature,
            "uncertainty_K": one.uncertainty,
        }
        for one in case.readings
    ]
    held = {name: float(np.ravel(t)[0]) for name, t in case.gearbox.measured.items()}
    if case.readings:
        whole["half_backlash_uncertainty"] = dressed(
            ("operating",),
            carried_uncertainty(case),
            "m",
            "standard uncertainty of the half backlash from the readings",
        )
    return whole.assign_attrs(readings=json.dumps(readings), held=json.dumps(held))


def carried_uncertainty(case: GearCase) -> Floats:
    """Standard uncertainty [m] of the mean half backlash from the readings' own, (operating,).

    Each reading is moved by its standard uncertainty up and down, the heat balance solved anew,
    and the differences added in squares: first order, independent readings, the first model.
    0 without readings.
    """
    model, at = case.models[0], case.stated
    square = np.zeros(at.speed.size)
    phase = np.arange(16) / 16.0
    for one in case.readings:
        if one.uncertainty == 0.0:
            continue
        ends = []
        for sign in (1.0, -1.0):
            held = {**case.gearbox.measured, one.node: one.temperature + sign * one.uncertainty}
            box = replace(case.gearbox, measured=held)
            moved = case.balance_of(model, at.speed, at.torque, gearbox=box, from_hot=False)
            hot = HotPair(case.pair, moved.operating, model)
            gap = clearance(hot, phase, case.deviations)
            ends.append(gap.half_backlash.mean(axis=1))
        square += (0.5 * (ends[0] - ends[1])) ** 2
    return np.sqrt(square)
