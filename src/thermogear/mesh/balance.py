"""The closed loop: friction -> heat -> body and oil temperatures -> viscosity -> friction.

The thermal network of the pair is solved with the losses of the mesh at its present
temperatures until nothing changes; every operating point goes its own way in one call. Where
more than one state is steady, the one reached from cold is the answer.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Flags, Floats
from thermogear.base.bounds import BODY
from thermogear.base.errors import InputError, ThermogearError, ValidityWarning
from thermogear.base.materials import MATERIALS, Lubricant, Material
from thermogear.gears.deviations import Deviation
from thermogear.gears.pair import GearPair
from thermogear.heat.gearbox import Losses, Surroundings, thermal_network
from thermogear.heat.losses import bearing_loss, churning_loss
from thermogear.heat.lubrication import density, kinematic_viscosity
from thermogear.heat.network import SteadyState, ThermalNetwork
from thermogear.mesh.elastic import ElasticPair, elastic_pair
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import MeshHeat, mesh_heat
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import ALIKE, Operating, Temperatures, Varied
from thermogear.mesh.thermal import HotPair

Indices = NDArray[np.int64]

HOTTEST = 700.0
"""Iterates [K] are held below it; a point that ends there has no steady state worth a name."""

FIRST, LARGEST, SHARE = 2.0, 8.0, 0.15
"""First step of a point [K]; largest one [K], or this share of the way it still has to go."""
CAREFUL = 0.8
"""Part of the step that would just keep the order of states by the last slope."""
NEAR, NEAREST = 0.5, 1.0
"""Change [K] below which steps are Newton's; how far [K] they then go."""
FAR = 0.1
"""While a point changes by more than this share of its way from the start [K/K], its tooth pairs
share the load as they last did: the contact is not solved again."""
WARMER, TRIALS = 5.0, 16
"""A start at which no law answers is made warmer by this [K], this often."""


class Response(NamedTuple):
    """What the network's steady state at the losses of a state is [K], whether it counts, and how
    the tooth pairs share the load (count, positions)."""

    reached: Floats
    known: Flags
    share: Floats


Respond = Callable[[Floats, Indices, Floats | None], Response]
"""The answer at states of the places of points, the load shared anew or as it is given."""


@dataclass(eq=False)
class Course:
    """Where the iteration from one start is, arrays (count, ...).

    ``nodes`` [K]; ``reached``, ``known`` and ``share`` of the last answer there; ``iterations``;
    ``residual`` [K] the greatest change of a node in the last one; ``lost``: in one line, by the
    place of the point, why it has no value.
    """

    nodes: Floats
    reached: Floats = field(init=False)
    known: Flags = field(init=False)
    iterations: NDArray[np.int64] = field(init=False)
    residual: Floats = field(init=False)
    share: dict[int, Floats] = field(default_factory=dict)
    lost: dict[int, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        count = len(self.nodes)
        self.reached, self.known = self.nodes.copy(), np.zeros(count, np.bool_)
        self.iterations, self.residual = np.zeros(count, np.int64), np.full(count, np.inf)

    def shares(self, index: Indices) -> Floats:
        """How the load was last shared at some points."""
        return np.stack([self.share[place] for place in index.tolist()])

    def ask(self, respond: Respond, index: Indices, *, anew: bool = True) -> None:
        """Set the answer at some points; those at which it raises are ``lost``.

        A batch that is refused is halved until the points that fail are alone.
        """
        if not index.size:
            return
        try:
            found = respond(self.nodes[index], index, None if anew else self.shares(index))
        except ThermogearError as error:
            if index.size == 1:
                self.lost[int(index[0])] = str(error)
            else:
                for half in np.array_split(index, 2):
                    self.ask(respond, half, anew=anew)
        else:
            self.reached[index], self.known[index] = found.reached, found.known
            self.share.update(zip(index.tolist(), found.share, strict=True))

    def settled(self, tolerance: float) -> Flags:
        """Whether a point ended at a steady state; one that is lost was still on its way."""
        return np.asarray((self.residual <= tolerance) & self.known)


def follow(
    respond: Respond, start: Floats, held: Flags, *, tolerance: float, most_iterations: int
) -> Course:
    """Iterate T <- T + w (N(T) - T) from ``start`` to a fixed point, every point by itself.

    Each step is a part w <= 1 of the way to the network's steady state N(T), so small that by
    the last slope of N it keeps the order of states (w < 1/(1 - N') where N falls), and never
    more than a few kelvins. Where N keeps the order, iterates from below all steady states rise
    to the lowest of them, and from above fall to the highest: the iteration cannot step over
    one. Near the end, within :data:`NEAR`, steps are Newton's with the inverse derivative of
    :func:`broyden`.

    While a point is :data:`FAR`, N takes the load as it was last shared; none settles by that.

    ``held`` (count, nodes): nodes of given temperature. A start that the laws refuse is made
    warmer, in steps of 5 K; a point that is refused later is lost, and stays where it was.
    """
    found, going = Course(start.copy()), np.arange(len(start))
    before, moved = np.full(start.shape, np.nan), np.full(start.shape, np.nan)
    inverse = np.tile(np.eye(start.shape[1]), (going.size, 1, 1))
    with warnings.catch_warnings(action="ignore", category=ValidityWarning):
        # iterates on the way may leave an oil's range; the result is asked once more
        _begin(respond, found, held)
        way = np.abs(found.reached - found.nodes).max(axis=1)
        begin, far = found.nodes.copy(), way > 0.0
        for _ in range(most_iterations):
            going = going[[place not in found.lost for place in going]]
            change = found.reached[going] - found.nodes[going]
            residual = np.abs(change).max(axis=1)
            found.residual[going] = residual
            found.iterations[going] += 1
            step, inverse[going] = _steps(change, before[going], moved[going], inverse[going])
            before[going], moved[going] = change, step
            going, step = going[residual > tolerance], step[residual > tolerance]
            if not going.size:
                break
            found.nodes[going] = np.clip(found.nodes[going] + step, BODY.least, BODY.most)
            rough = going[far[going]]
            found.ask(respond, rough, anew=False)
            reached = found.reached[rough]
            left, way = (np.abs(reached - at[rough]).max(axis=1) for at in (found.nodes, begin))
            far[rough] = left > FAR * way
            found.ask(respond, going[~far[going]])
            # the slope of a point whose load is shared anew is that of the answers before
            before[rough] += found.reached[rough] - reached
    return found


def _begin(respond: Respond, found: Course, held: Flags) -> None:
    """Ask at the start, which is made warmer where it is refused."""
    found.ask(respond, np.arange(len(found.nodes)))
    for _ in range(TRIALS):
        again, reasons = np.array(sorted(found.lost), dtype=np.int64), found.lost
        warm = np.minimum(found.nodes[again] + WARMER, BODY.most)
        found.nodes[again] = np.where(held[again], found.nodes[again], warm)
        found.lost = {}
        found.ask(respond, again)
        # the first refusal says why
        found.lost = {place: reasons[place] for place in found.lost}


def _steps(change: Floats, before: Floats, moved: Floats, inverse: Floats) -> tuple[Floats, Floats]:
    """The next step [K] of each point and its inverse derivative, from the last change and step."""
    residual = np.abs(change).max(axis=1)
    square = np.einsum("ij,ij->i", moved, moved)
    along = np.einsum("ij,ij->i", change - before, moved)
    known = np.isfinite(square) & (square > 0.0)
    # N' along the last step: change = N(T) - T
    slope = 1.0 + np.divide(along, square, out=np.zeros_like(residual), where=known)
    falling = np.minimum(1.0, CAREFUL / (1.0 + np.maximum(-slope, 0.0)))
    part = np.where((slope >= 0.0) & known, 1.0, falling)
    furthest = np.where(known, np.maximum(LARGEST, SHARE * residual), FIRST)
    careful = np.minimum(part, furthest / np.maximum(residual, 1e-300))[:, None] * change
    inverse = broyden(inverse, fell=before - change, moved=moved)
    newton = np.einsum("ijk,ik->ij", inverse, change)
    newton *= np.minimum(1.0, NEAREST / np.maximum(np.abs(newton).max(axis=1), 1e-300))[:, None]
    near = known & (residual <= NEAR) & (np.einsum("ij,ij->i", newton, change) > 0.0)
    return np.where(near[:, None], newton, careful), inverse


def broyden(inverse: Floats, *, fell: Floats, moved: Floats) -> Floats:
    """Broyden's inverse derivatives, (count, n, n), after a step by which each point ``moved``.

    H <- H + (s - H y) (s^T H)/(s^T H y), s the step and y = ``fell`` by how much the change has
    become less, both (count, n): then H y = s. A step that says nothing leaves H as it was.

    Source: C. G. Broyden, Mathematics of Computation 19 (1965) 577.
    """
    guess = np.einsum("ijk,ik->ij", inverse, fell)
    row = np.einsum("ij,ijk->ik", moved, inverse)
    scale = np.einsum("ij,ij->i", moved, guess)
    known = np.abs(scale) > 1e-6 * np.einsum("ij,ij->i", moved, moved)
    over = np.divide(1.0, scale, out=np.zeros_like(scale), where=known)[:, None]
    each = np.where(known[:, None], over * (moved - guess), 0.0)
    return np.asarray(inverse + each[:, :, None] * np.where(known[:, None], row, 0.0)[:, None, :])


SAME = 0.01
"""Two steady states that differ by less [K] at every node are one."""

STAND_IN, OVER = 313.15, 20.0
"""A point without a state is in ``operating`` at 40 C, or 20 K over a hotter reference [K]."""

NODES = (
    "pinion_tooth",
    "pinion_body",
    "pinion_shaft",
    "wheel_tooth",
    "wheel_body",
    "wheel_shaft",
    "housing",
    "oil",
)
"""The nodes of the network whose temperature is computed; a drawn train has more."""


@dataclass(frozen=True, kw_only=True)
class Gearbox:
    """What heats and cools the pair besides its mesh; every default is ours.

    ``surroundings`` of the network; ``immersion`` of the wheel, depth over tip radius (0: spray);
    ``bearing_coefficient`` of the four shaft bearings, each of the bore's diameter and carrying
    half the normal force, where ``surroundings`` have no drawn train; ``measured`` temperatures [K]
    that hold single nodes of the network ("oil", "housing", "pinion_tooth", ...), numbers or arrays
    over operating points.

    >>> Gearbox(immersion=0.5).bearing_coefficient
    0.0015
    """

    surroundings: Surroundings = field(default_factory=Surroundings)
    immersion: float = 0.3
    bearing_coefficient: float = 0.0015
    measured: Mapping[str, ArrayLike] = field(default_factory=dict)

    @property
    def nodes(self) -> tuple[str, ...]:
        """:data:`NODES` and the rings of the bearings of a drawn train."""
        train = self.surroundings.train
        return NODES if train is None else (*NODES, *train.nodes)

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

    The state reached from cold: ``operating`` carries the computed temperatures; ``steady`` the
    network's nodes and heat flows; ``losses`` [W]; ``iterations``, ``residual`` [K] (greatest
    change of a node in the last iteration) and ``settled``.

    ``hot`` are the node temperatures [K] of the state reached from hot, nan where none is (or
    none was asked for); ``several`` says where it is another state, by more than 0.01 K.

    ``lost``: place of a point -> in one line why it has no value, such as an oil too thick for
    the law of convection. Its numbers are nan; in ``operating`` and ``network`` it is at
    40 C (20 K over a hotter reference), because those hold numbers only.
    """

    operating: Operating
    network: ThermalNetwork
    steady: SteadyState
    losses: Losses
    iterations: NDArray[np.int64]
    residual: Floats
    settled: Flags
    several: Flags
    hot: Mapping[str, Floats]
    lost: Mapping[int, str] = field(default_factory=dict)

    @property
    def unknown(self) -> Flags:
        """Which points are ``lost``, (count,)."""
        return np.isin(np.arange(self.settled.size), list(self.lost))


def heat_balance(
    pair: GearPair,
    speed: ArrayLike,
    torque: ArrayLike,
    lubricant: Lubricant,
    half_backlash: float,
    model: MeshModel | None = None,
    *,
    varied: Varied = ALIKE,
    gearbox: Gearbox | None = None,
    reference: float = 293.15,
    housing: Material = MATERIALS["steel"],
    deviations: Sequence[Deviation] = (),
    tolerance: float = 1e-6,
    most_iterations: int = 200,
    from_hot: bool = True,
) -> HeatBalance:
    """Steady temperatures of gears, shafts, oil and housing from the losses they cause.

    T = N(losses(T)), N the steady :func:`~thermogear.heat.gearbox.thermal_network`, iterated
    until no node changes by more than ``tolerance`` [K]. More than one state may be steady:
    hotter oil is thinner, its layer on the gears turns turbulent and drags more. The iteration
    (:func:`~thermogear.mesh.balance.follow`) starts with everything at the ambient's
    temperature and rises to the state that is reached from cold: that is the answer. With
    ``from_hot`` it also starts at 700 K and falls to the one that is reached from hot, which
    ``hot`` and ``several`` tell.

    ``speed`` [rad/s] and ``torque`` [N m] of the pinion, one axis or numbers that broadcast;
    ``half_backlash`` [m] cold; ``varied``: what of the pair differs between the points, one width
    for all; ``reference`` [K] of the drawing; ``model`` gives friction law,
    inlet and sharing. The tooth nodes become the addendum temperatures, the shaft nodes the bore
    temperatures of the radial fields, which pass through the body nodes. A point that does not
    settle keeps its last iterate with ``settled`` False, and so does one that would run above
    700 K; a point at which a law has no value is ``lost``: nan, not settled, with the reason.
    Nothing is raised for either, and no other point notices. Warns once, at the result, where
    the oil, or the film at the flanks, leaves the range of the viscosity line. Raises for
    impossible arguments, and where no point has a value even with everything but the given nodes
    at 40 C.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> balance = heat_balance(pair, 100.0, 200.0, lubricant("FVA3"), 60e-6)
    >>> f"{balance.losses.mesh.item():.0f} W"
    '166 W'
    """
    if not tolerance > 0.0:
        raise InputError("tolerance", f"{tolerance} K", allowed="> 0 K")
    if most_iterations < 1:
        raise InputError("most_iterations", most_iterations, allowed=">= 1")
    box = Gearbox() if gearbox is None else gearbox
    omega, moment = np.broadcast_arrays(
        np.atleast_1d(np.asarray(speed, dtype=float)),
        np.atleast_1d(np.asarray(torque, dtype=float)),
    )
    loop = _Loop(
        pair=pair,
        speed=omega,
        torque=moment,
        lubricant=lubricant,
        half_backlash=half_backlash,
        varied=varied,
        model=MeshModel.consistent() if model is None else model,
        box=box,
        reference=reference,
        housing=housing,
        deviations=tuple(deviations),
    )
    stand_in, cold = max(STAND_IN, reference + OVER), np.arange(loop.count)
    loop.operating(loop.at(stand_in), cold)
    starts = [box.surroundings.ambient] + [HOTTEST] * from_hot
    # both ways at once: every point goes its own
    ways = follow(
        lambda nodes, index, share: loop.respond(nodes, index % loop.count, share),
        np.concatenate([loop.at(kelvin) for kelvin in starts]),
        np.concatenate([loop.held] * len(starts)),
        tolerance=tolerance,
        most_iterations=most_iterations,
    )
    reasons = {place: why for place, why in ways.lost.items() if place < loop.count}
    lost = np.isin(cold, list(reasons))
    if lost.all():
        loop.refuse_what_never_works(loop.at(stand_in))
    down, settled = ways.settled(tolerance)[loop.count :], ways.settled(tolerance)[cold]
    hot, several = np.full((loop.count, len(box.nodes)), np.nan), np.zeros(loop.count, np.bool_)
    if from_hot:
        hot[down] = ways.nodes[loop.count :][down]
        # a start from hot that does not settle shows no other state
        several = settled & (np.abs(hot - ways.nodes[cold]).max(axis=1) > SAME)
    nodes = np.where(lost[:, None], stand_in, ways.nodes[cold])
    # the load is shared as at these very states, but where a point stands in
    share = None if lost.any() else ways.shares(cold)
    with warnings.catch_warnings(record=True, action="always", category=ValidityWarning) as told:
        network, losses, means = loop.network(nodes, cold, share)
    for text in dict.fromkeys(str(one.message) for one in told):
        warnings.warn(text, ValidityWarning, stacklevel=2)
    return HeatBalance(
        operating=loop.operating(nodes, cold),
        network=network,
        steady=_unknown_where(lost, network.steady()),
        losses=losses.unknown_where(lost),
        iterations=ways.iterations[cold],
        residual=np.where(lost, np.nan, ways.residual[cold]),
        settled=settled & means.settled,
        several=several,
        hot={name: hot[:, place] for place, name in enumerate(box.nodes)},
        lost=dict(sorted(reasons.items())),
    )


def _unknown_where(lost: Flags, steady: SteadyState) -> SteadyState:
    """``steady`` with nan at the points that are lost."""

    def blanked(values: ArrayLike) -> Floats:
        return np.where(lost, np.nan, np.broadcast_to(np.asarray(values, float), lost.shape))

    return SteadyState(
        {name: blanked(t) for name, t in steady.temperatures.items()},
        {name: blanked(q) for name, q in steady.heat_out.items()},
        blanked(steady.residual),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class HeatedPair:
    """A pair in its gearbox, whatever it does there."""

    pair: GearPair
    lubricant: Lubricant
    half_backlash: float
    model: MeshModel
    box: Gearbox
    reference: float
    housing: Material
    deviations: Sequence[Deviation]

    def elastic(self, at: Operating) -> ElasticPair:
        """Its tooth pairs at operating points."""
        return elastic_pair(HotPair(self.pair, at, self.model), self.deviations)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Loop(HeatedPair):
    """What stays the same in the closed loop of a batch; states are (count, nodes) [K]."""

    speed: Floats
    torque: Floats
    varied: Varied

    @property
    def count(self) -> int:
        return self.speed.size

    @property
    def measured(self) -> dict[str, Floats]:
        """Given temperatures [K] of nodes, (count,)."""
        given = self.box.measured.items()
        return {name: np.broadcast_to(np.asarray(t, float), (self.count,)) for name, t in given}

    @property
    def held(self) -> Flags:
        """Which nodes are held at a given temperature, (count, nodes)."""
        row = np.array([name in self.box.measured for name in self.box.nodes])
        return np.broadcast_to(row, (self.count, row.size))

    def at(self, kelvin: float) -> Floats:
        """The state with every free node at one temperature."""
        names = self.box.nodes
        nodes = np.full((self.count, len(names)), float(kelvin))
        for name, values in self.measured.items():
            if name in names:
                nodes[:, names.index(name)] = values
        return nodes

    def refuse_what_never_works(self, nodes: Floats) -> None:
        """Raise what is wrong with the whole, where no point has a value at its ``nodes`` [K]."""
        found = Course(nodes)
        with warnings.catch_warnings(action="ignore", category=ValidityWarning):
            found.ask(self.respond, np.arange(self.count))
            if len(found.lost) == self.count:
                self.respond(nodes[:1], np.arange(1), None)

    def named(self, nodes: Floats) -> dict[str, Floats]:
        """The temperatures [K] of a state by node."""
        return dict(zip(self.box.nodes, nodes.T, strict=True))

    def operating(self, nodes: Floats, index: Indices) -> Operating:
        """The operating points ``index`` in the state ``nodes``."""
        t = self.named(nodes)
        return Operating(
            self.speed[index],
            self.torque[index],
            self.lubricant.part(index),
            t["oil"],
            node_temperatures(t, self.reference),
            self.half_backlash,
            self.housing,
            varied=self.varied.part(index),
        )

    def network(
        self, nodes: Floats, index: Indices, share: Floats | None
    ) -> tuple[ThermalNetwork, Losses, MeshHeat]:
        """The network with the losses of the state, and what the mesh makes of heat."""
        here, named = self.operating(nodes, index), self.named(nodes)
        elastic = self.elastic(here)
        means = mesh_heat(elastic, share=share)
        losses, _ = pair_losses(self.pair, here, elastic, self.box, named, means)
        network = thermal_network(
            self.pair.pinion,
            self.pair.wheel,
            here.speed,
            losses,
            here.lubricant,
            here.oil_temperature,
            self.box.surroundings,
            {name: values[index] for name, values in self.measured.items()},
            named["housing"],
        )
        return network, losses, means

    def respond(self, nodes: Floats, index: Indices, share: Floats | None) -> Response:
        """The steady state of that network; one beyond 700 K is none."""
        network, _, means = self.network(nodes, index, share)
        steady = network.steady()
        reached = np.stack(
            [np.broadcast_to(steady[name], index.shape) for name in self.box.nodes], axis=1
        )
        known = means.settled & (reached < HOTTEST).all(axis=1)
        return Response(np.minimum(reached, HOTTEST), known, means.share)


def node_temperatures(nodes: Mapping[str, ArrayLike], reference: float) -> Temperatures:
    """The body temperatures [K] that the ``nodes`` of the network give."""
    return Temperatures(
        reference=reference,
        pinion_addendum=nodes["pinion_tooth"],
        pinion_bore=nodes["pinion_shaft"],
        wheel_addendum=nodes["wheel_tooth"],
        wheel_bore=nodes["wheel_shaft"],
        housing=nodes["housing"],
        pinion_body=nodes["pinion_body"],
        wheel_body=nodes["wheel_body"],
    )


def pair_losses(
    pair: GearPair,
    operating: Operating,
    elastic: ElasticPair,
    box: Gearbox,
    nodes: Mapping[str, ArrayLike],
    means: MeshHeat | None = None,
) -> tuple[Losses, Flags]:
    """Mesh, churning and bearing losses [W] and the flanks' conductance [W/K], (count,).

    At the present temperatures, the rings' those of ``nodes`` [K]; with them whether the loaded
    contact is known, (count,). ``means`` of these points where the mesh is solved already.
    Warns where the film at the flanks leaves the range of the oil's viscosity line.
    """
    means = means or mesh_heat(elastic)
    FrictionPath(elastic, np.array([pair.path.c])).warn_beyond_oil()
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
        else np.zeros_like(means.power)
    )
    train = box.surroundings.train
    if train is None:
        half = 0.5 * elastic.force
        first, second = (
            2.0 * bearing_loss(half, 2.0 * gear.bore_radius, omega, box.bearing_coefficient)
            for gear, omega in ((pair.pinion, operating.speed), (pair.wheel, wheel_speed))
        )
        bearings: dict[str, Any] = {"bearing_1": first, "bearing_2": second}
    else:
        speeds = operating.speed, wheel_speed
        bearings = {"bearings": train.losses(nodes, oil, elastic.force, speeds)}
    return Losses(
        mesh=means.power,
        partition_1=means.partition,
        churning=churning,
        contact=means.conductance,
        **bearings,
    ), means.settled
