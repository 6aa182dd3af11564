"""Lumped thermal networks: nodes, conductances, heat sources; the steady state.

G T = q, with given temperatures on some nodes. Every conductance, source and given temperature may
be an array over operating points: one call solves them all, one linear solve for each point. What
depends on temperature is iterated by the caller; the course in time, C dT/dt = q - G T, is followed
by :mod:`~thermogear.heat.transient`.
Checked by ``tests/heat/test_network.py``: closed forms of one and two nodes, energy balance.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest


@dataclass(frozen=True, eq=False)
class Link:
    """A thermal conductance [W/K] between two named nodes; number or array, >= 0.

    >>> float(Link("housing", "ambient", 10.0).conductance)
    10.0
    """

    first: str
    second: str
    conductance: ArrayLike

    def __post_init__(self) -> None:
        values = np.asarray(self.conductance, dtype=float)
        object.__setattr__(self, "conductance", values)
        if self.first == self.second:
            raise InputError("link", f"{self.first} to itself", allowed="two different nodes")
        if not np.all(np.isfinite(values) & (values >= 0.0)):
            raise InputError(
                f"conductance {self.first}-{self.second}", values, allowed=">= 0 W/K, finite"
            )


@dataclass(frozen=True, eq=False)
class SteadyState:
    """Temperatures [K] by node, heat [W] that leaves through each given node, and the residual.

    ``residual`` is the greatest heat imbalance of a free node [W].

    >>> network = ThermalNetwork(
    ...     (Link("oil", "ambient", 10.0),), sources={"oil": 200.0}, fixed={"ambient": 293.15}
    ... )
    >>> f"{network.steady().heat_out['ambient']:.1f} W"
    '200.0 W'
    """

    temperatures: Mapping[str, Floats]
    heat_out: Mapping[str, Floats]
    residual: Floats

    def __getitem__(self, node: str) -> Floats:
        return self.temperatures[node]


@dataclass(frozen=True, eq=False)
class ThermalNetwork:
    """Nodes joined by conductances, heated by sources, some held at given temperatures.

    ``links``; ``sources`` [W] by node; ``fixed`` [K] by node (the ambient, a measured node);
    ``capacities`` [J/K] by node, needed for the time course only. Numbers or arrays of one
    broadcastable shape. Raises for unknown nodes, and when a node has no way to a given
    temperature.

    >>> network = ThermalNetwork(
    ...     (Link("oil", "ambient", 10.0),), sources={"oil": 200.0}, fixed={"ambient": 293.15}
    ... )
    >>> f"{network.steady().temperatures['oil']:.2f} K"
    '313.15 K'
    """

    links: tuple[Link, ...]
    sources: Mapping[str, ArrayLike]
    fixed: Mapping[str, ArrayLike]
    capacities: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        names = self.nodes
        for group in (self.sources, self.fixed, self.capacities):
            for name in group:
                if name not in names:
                    raise InputError("thermal node", repr(name), fix=nearest(name, names))
        for name, value in self.sources.items():
            watts = np.asarray(value, dtype=float)
            if not np.all(np.isfinite(watts)):
                raise InputError(f"source of {name}", f"{watts} W", allowed="finite")
        for name, value in self.fixed.items():
            kelvin = np.asarray(value, dtype=float)
            if not np.all(np.isfinite(kelvin) & (kelvin > 0.0)):
                raise InputError(f"temperature of {name}", f"{kelvin} K", allowed="> 0 K, finite")
        reached = self._reached()
        lost = [name for name in names if name not in reached]
        if lost:
            raise InputError(
                "thermal network",
                ", ".join(lost),
                why="no conductance leads from there to a given temperature",
                fix="give the ambient, or a temperature on that node",
            )

    def _reached(self) -> set[str]:
        """The nodes from which a way of conductances leads to a given temperature."""
        reached, before = set(self.fixed), -1
        carrying = [
            (link.first, link.second)
            for link in self.links
            if np.all(np.asarray(link.conductance) > 0.0)
        ]
        while len(reached) > before:
            before = len(reached)
            for first, second in carrying:
                if first in reached or second in reached:
                    reached |= {first, second}
        return reached

    @property
    def nodes(self) -> tuple[str, ...]:
        """All node names in the order the links name them."""
        return tuple(dict.fromkeys(end for one in self.links for end in (one.first, one.second)))

    @property
    def free(self) -> tuple[str, ...]:
        """The nodes whose temperature is computed."""
        return tuple(name for name in self.nodes if name not in self.fixed)

    @property
    def shape(self) -> tuple[int, ...]:
        """Common shape of all conductances, sources and given temperatures."""
        values = [link.conductance for link in self.links]
        values += [*self.sources.values(), *self.fixed.values()]
        return np.broadcast_shapes(*(np.shape(v) for v in values))

    def _matrices(self) -> tuple[Floats, Floats, Floats]:
        """(Laplacian over all nodes, sources, given temperatures or 0), batch axes first."""
        names, shape = self.nodes, self.shape
        index = {name: i for i, name in enumerate(names)}
        laplacian = np.zeros((*shape, len(names), len(names)))
        for link in self.links:
            i, j = index[link.first], index[link.second]
            conductance = np.asarray(link.conductance, dtype=float)
            laplacian[..., i, i] += conductance
            laplacian[..., j, j] += conductance
            laplacian[..., i, j] -= conductance
            laplacian[..., j, i] -= conductance
        heat = np.zeros((*shape, len(names)))
        for name, value in self.sources.items():
            heat[..., index[name]] += np.asarray(value, dtype=float)
        given = np.zeros((*shape, len(names)))
        for name, value in self.fixed.items():
            given[..., index[name]] = value
        return laplacian, heat, given

    def _indices(self) -> tuple[list[int], list[int]]:
        names = self.nodes
        free = [i for i, name in enumerate(names) if name not in self.fixed]
        return free, [i for i in range(len(names)) if i not in free]

    def steady(self) -> SteadyState:
        """The steady state; every array has the network's ``shape``."""
        laplacian, heat, given = self._matrices()
        free, held = self._indices()
        temperature = given.copy()
        inner = laplacian[..., free, :][..., :, free]
        if free:
            across = laplacian[..., free, :][..., :, held]
            # relative to one given temperature: no digits lost to the absolute scale
            datum = given[..., held[:1]]
            push = heat[..., free] - np.einsum("...ij,...j->...i", across, given[..., held] - datum)
            rise = np.linalg.solve(inner, push[..., None])[..., 0]
            temperature[..., free] = rise + datum
        datum = temperature[..., :1]
        flow = heat - np.einsum("...ij,...j->...i", laplacian, temperature - datum)
        names = self.nodes
        return SteadyState(
            {name: temperature[..., i] for i, name in enumerate(names)},
            {names[i]: flow[..., i] for i in held},
            np.asarray(np.max(np.abs(flow[..., free]), axis=-1) if free else np.zeros(self.shape)),
        )

    def laplacian(self) -> Floats:
        """G [W/K] over all :attr:`nodes`, given ones too; batch axes first."""
        return self._matrices()[0]

    def flows(self, temperatures: Mapping[str, ArrayLike]) -> tuple[Floats, Floats, Floats]:
        """What flows at given ``temperatures`` [K] of the free nodes, no steady state assumed [W].

        (heat that each free node keeps, last axis :attr:`free`; heat that the sources set free;
        heat that leaves through the given nodes). The first adds up to the second less the third.
        """
        laplacian, heat, given = self._matrices()
        free, held = self._indices()
        names = self.nodes
        own = [np.asarray(temperatures[names[i]], dtype=float) for i in free]
        shape = np.broadcast_shapes(self.shape, *(t.shape for t in own))
        at = np.array(np.broadcast_to(given, (*shape, len(names))))
        for i, values in zip(free, own, strict=True):
            at[..., i] = values
        # from one datum: a flow is a difference, and keeps its digits
        datum = at[..., held[:1]]
        flow = heat - np.einsum("...ij,...j->...i", laplacian, at - datum)
        source = np.broadcast_to(heat.sum(axis=-1), shape)
        return flow[..., free], np.asarray(source), np.asarray(flow[..., held].sum(axis=-1))
