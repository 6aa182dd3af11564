"""The closed loop: friction -> heat -> body and oil temperatures -> viscosity -> friction.

The thermal network of the pair is solved with the losses of the mesh at its present
temperatures until nothing changes; every operating point goes its own way in one call.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.bounds import BODY
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.materials import MATERIALS, Lubricant, Material
from thermogear.gears.contact import path_of_contact
from thermogear.gears.deviations import Deviation
from thermogear.gears.geometry import GearPair
from thermogear.heat.gearbox import Losses, Surroundings, thermal_network
from thermogear.heat.losses import bearing_loss, churning_loss
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.heat.network import SteadyState, ThermalNetwork
from thermogear.mesh.elastic import elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating, Temperatures
from thermogear.mesh.thermal import HotPair

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

HOTTEST = 700.0
"""Iterates [K] are held below it; a point that ends there has no steady state worth a name."""


@dataclass(frozen=True, kw_only=True)
class Gearbox:
    """What heats and cools the pair besides its mesh; every default is ours.

    ``surroundings`` of the network; ``immersion`` of the wheel, depth over tip radius (0: spray);
    ``bearing_coefficient`` of the four shaft bearings, each of the bore's diameter and carrying
    half the normal force; ``measured`` temperatures [K] that hold single nodes of the network
    ("oil", "housing", "pinion_tooth", ...), numbers or arrays over operating points.
    """

    surroundings: Surroundings = field(default_factory=Surroundings)
    immersion: float = 0.3
    bearing_coefficient: float = 0.0015
    measured: Mapping[str, ArrayLike] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if not 0.0 <= self.immersion <= 1.0:
            raise InputError("gearbox.immersion", self.immersion, allowed="0 .. 1")
        if not 0.0 <= self.bearing_coefficient < 0.1:
            raise InputError(
                "gearbox.bearing_coefficient", self.bearing_coefficient, allowed="0 .. 0.1"
            )
        for node, values in self.measured.items():
            BODY.require(f"gearbox.measured.{node}", values)


@dataclass(frozen=True, eq=False, kw_only=True)
class HeatBalance:
    """A settled (or not) thermal state of every operating point, arrays (count,).

    ``operating`` carries the computed temperatures; ``steady`` the network's nodes and heat
    flows; ``losses`` [W]; ``iterations``, ``residual`` [K] (greatest change of a node in the last
    iteration) and ``settled``.
    """

    operating: Operating
    network: ThermalNetwork
    steady: SteadyState
    losses: Losses
    iterations: NDArray[np.int64]
    residual: Floats
    settled: NDArray[np.bool_]


PATIENCE = 30
"""Iterations after which a point that has not settled takes smaller steps."""

NODES = ("pinion_tooth", "pinion_shaft", "wheel_tooth", "wheel_shaft", "housing", "oil")


def heat_balance(
    pair: GearPair,
    speed: ArrayLike,
    torque: ArrayLike,
    lubricant: Lubricant,
    half_backlash: float,
    model: MeshModel | None = None,
    *,
    gearbox: Gearbox | None = None,
    reference: float = 293.15,
    housing: Material = MATERIALS["steel"],
    deviations: Sequence[Deviation] = (),
    path_positions: int = 101,
    tolerance: float = 1e-6,
    most_iterations: int = 100,
) -> HeatBalance:
    """Steady temperatures of gears, shafts, oil and housing from the losses they cause.

    T = N(losses(T)), N the steady :func:`~thermogear.heat.gearbox.thermal_network`; fixed-point
    iteration, each operating point relaxed by Aitken's factor, until no node changes by more
    than ``tolerance`` [K].

    ``speed`` [rad/s] and ``torque`` [N m] of the pinion, one axis or numbers that broadcast;
    ``half_backlash`` [m] cold; ``reference`` [K] of the drawing; ``model`` gives friction law,
    inlet and sharing. The tooth nodes become the addendum temperatures, the shaft nodes the bore
    temperatures of the radial fields. A point that does not settle keeps its last iterate with
    ``settled`` False, and so does one that would run above 700 K; nothing is raised for it. Warns
    once, at the result, where the oil, or the film at the flanks, leaves the range of its
    viscosity line.
    """
    if not tolerance > 0.0:
        raise InputError("tolerance", f"{tolerance} K", allowed="> 0 K")
    if most_iterations < 1:
        raise InputError("most_iterations", most_iterations, allowed=">= 1")
    box = Gearbox() if gearbox is None else gearbox
    given = dict(box.measured)
    choice = MeshModel.consistent() if model is None else model
    omega, moment = np.broadcast_arrays(
        np.atleast_1d(np.asarray(speed, dtype=float)),
        np.atleast_1d(np.asarray(torque, dtype=float)),
    )
    count = omega.size
    start = box.measured.get("oil", box.surroundings.ambient + 30.0)
    state = np.broadcast_to(np.asarray(start, dtype=float), (count,))
    nodes = np.array(np.repeat(state[:, None], len(NODES), axis=1))

    def operating(at: Floats, index: Indices) -> Operating:
        t = dict(zip(NODES, at.T, strict=True))
        return Operating(
            omega[index],
            moment[index],
            lubricant,
            t["oil"],
            Temperatures(
                reference=reference,
                pinion_addendum=t["pinion_tooth"],
                pinion_bore=t["pinion_shaft"],
                wheel_addendum=t["wheel_tooth"],
                wheel_bore=t["wheel_shaft"],
                housing=t["housing"],
            ),
            half_backlash,
            housing,
        )

    def respond(
        at: Floats, index: Indices
    ) -> tuple[ThermalNetwork, SteadyState, Losses, Floats, NDArray[np.bool_]]:
        here = operating(at, index)
        hot = HotPair(pair, here, choice)
        elastic = elastic_pair(hot, deviations)
        path = FrictionPath(elastic, path_of_contact(pair, path_positions))
        path.warn_beyond_oil()
        losses = pair_losses(pair, here, path, box)
        network = thermal_network(
            pair.pinion,
            pair.wheel,
            omega[index],
            losses,
            lubricant,
            here.oil_temperature,
            box.surroundings,
            {name: np.broadcast_to(np.asarray(t), (count,))[index] for name, t in given.items()},
        )
        steady = network.steady()
        found = [np.broadcast_to(steady[name], (index.size,)) for name in NODES]
        reached = np.minimum(np.stack(found, axis=1), HOTTEST)
        return network, steady, losses, reached, path.settled

    everything = np.arange(count)
    factor = np.ones(count)
    before = np.full((count, len(NODES)), np.nan)
    iterations = np.zeros(count, np.int64)
    residual = np.full(count, np.inf)
    going = everything
    with warnings.catch_warnings():
        # iterates on the way may leave an oil's range; the result is asked once more below
        warnings.simplefilter("ignore", ValidityWarning)
        for turn in range(most_iterations):
            change = respond(nodes[going], going)[3] - nodes[going]
            residual[going] = np.abs(change).max(axis=1)
            iterations[going] += 1
            # a point that circles is slowed down
            most = 1.5 if turn < PATIENCE else 0.3
            factor[going] = np.clip(_aitken(factor[going], before[going], change), 0.05, most)
            before[going] = change
            still = residual[going] > tolerance
            going = going[still]
            if not going.size:
                break
            moved = nodes[going] + (factor[going, None] * change[still])
            nodes[going] = np.clip(moved, BODY.least, BODY.most)
    settled = residual <= tolerance
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", ValidityWarning)
        network, steady, losses, _, contact = respond(nodes, everything)
    for text in dict.fromkeys(str(one.message) for one in told):
        warnings.warn(text, ValidityWarning, stacklevel=2)
    settled = settled & contact & (nodes < HOTTEST).all(axis=1)
    return HeatBalance(
        operating=operating(nodes, everything),
        network=network,
        steady=steady,
        losses=losses,
        iterations=iterations,
        residual=residual,
        settled=settled,
    )


def _aitken(factor: Floats, before: Floats, change: Floats) -> Floats:
    """Aitken's relaxation factor of each point from its last two changes."""
    turn = change - before
    square = np.einsum("ij,ij->i", turn, turn)
    along = np.einsum("ij,ij->i", before, turn)
    known = np.isfinite(square) & (square > 0.0)
    return np.asarray(-factor * np.divide(along, square, out=-np.ones_like(factor), where=known))


def pair_losses(pair: GearPair, operating: Operating, path: FrictionPath, box: Gearbox) -> Losses:
    """Mesh, churning and bearing losses [W] at the present temperatures, (count,)."""
    mesh, share = path.power()
    oil = operating.lubricant
    wheel_speed = operating.speed / pair.ratio
    churning = (
        churning_loss(
            wheel_speed,
            pair.wheel.tip_radius,
            density(oil, operating.oil_temperature),
            kinematic_viscosity(oil, operating.oil_temperature),
            box.immersion,
        )
        if box.immersion > 0.0
        else np.zeros_like(mesh)
    )
    half = 0.5 * path.elastic.force
    first, second = (
        2.0 * bearing_loss(half, 2.0 * gear.bore_radius, omega, box.bearing_coefficient)
        for gear, omega in ((pair.pinion, operating.speed), (pair.wheel, wheel_speed))
    )
    return Losses(
        mesh=mesh, partition_1=share, churning=churning, bearing_1=first, bearing_2=second
    )
