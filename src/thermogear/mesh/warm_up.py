"""Warm-up of a gear pair from the ambient: the closed loop in time."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import ConvergenceError, InputError, ValidityWarning
from thermogear.gears.deviations import Deviation
from thermogear.gears.geometry import GearPair
from thermogear.heat.gearbox import thermal_network
from thermogear.mesh.balance import NODES, Gearbox, node_temperatures, pair_losses
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class WarmUp:
    """Node temperatures [K] over ``time`` [s], shape (time,) each, and the mesh loss [W]."""

    time: Floats
    temperatures: dict[str, Floats]
    mesh_loss: Floats


def warm_up(
    pair: GearPair,
    operating: Operating,
    times: ArrayLike,
    model: MeshModel | None = None,
    *,
    gearbox: Gearbox | None = None,
    deviations: Sequence[Deviation] = (),
) -> WarmUp:
    """Temperatures of every node from the start at the ambient's temperature.

    Between two of the ``times`` [s], rising from 0, losses and conductances stay those of the
    interval's beginning and the network is solved exactly; so the viscosity follows the oil from
    interval to interval. The error is of first order in the intervals: halve them to see it.

    ``operating``: one operating point (its temperatures are not used); ``gearbox`` with measured
    nodes held from the start; the rest as :func:`heat_balance`. Raises InputError for more than
    one operating point and for times that do not rise from 0.
    """
    time = np.asarray(times, dtype=float)
    if time.ndim != 1 or time.size < 2 or time[0] != 0.0 or not np.all(np.diff(time) > 0.0):
        raise InputError("times", f"{time.size} values", allowed="two or more, rising from 0 s")
    if operating.speed.size != 1:
        raise InputError("operating", f"{operating.speed.size} points", allowed="one")
    box = Gearbox() if gearbox is None else gearbox
    choice = MeshModel.consistent() if model is None else model
    held = {name: float(np.ravel(t)[0]) for name, t in box.measured.items()}
    cold = box.surroundings.ambient
    state: dict[str, float] = {}
    found: dict[str, list[float]] = {}
    losses: list[float] = []
    reference = operating.temperatures.reference
    with warnings.catch_warnings():
        # a cold start lies below the oil's line: said once, by the caller's steady state
        warnings.simplefilter("ignore", ValidityWarning)
        for place, now in enumerate(time):
            at = {name: held.get(name, state.get(name, cold)) for name in NODES}
            here = replace(
                operating,
                oil_temperature=at["oil"],
                temperatures=node_temperatures(at, reference),
            )
            elastic = elastic_pair(HotPair(pair, here, choice), deviations)
            sources, known = pair_losses(pair, here, elastic, box)
            if not known.all():
                raise ConvergenceError("loaded contact: 1 of 1 operating points did not settle")
            network = thermal_network(
                pair.pinion,
                pair.wheel,
                here.speed,
                sources,
                here.lubricant,
                here.oil_temperature,
                box.surroundings,
                dict(held),
            )
            if not state:
                state = {name: held.get(name, cold) for name in network.nodes}
                state |= {n: float(np.ravel(t)[0]) for n, t in network.fixed.items()}
            for name in network.nodes:
                found.setdefault(name, []).append(state[name])
            losses.append(float(np.ravel(sources.mesh)[0]))
            if place + 1 < time.size:
                step = network.transient([time[place + 1] - now], state)
                state = {name: float(np.ravel(values)[-1]) for name, values in step.items()}
    return WarmUp(time, {k: np.asarray(v) for k, v in found.items()}, np.asarray(losses))
