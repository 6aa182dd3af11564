"""The elastic side of a mesh cycle: hot moduli in, stiffness, error and load shares out."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.candidates import mesh_points
from thermogear.gears.contact import curvature_radii, hertz_half_width, reduced_radius
from thermogear.gears.contact import reduced_modulus as _reduced_modulus
from thermogear.gears.corner import FREE, contact_point
from thermogear.gears.deviations import Deviation
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LEAST_LINE_LOAD, LoadedMesh, solve_mesh
from thermogear.gears.pair import GearPair
from thermogear.gears.ring import ring_compliance
from thermogear.gears.sharing import equal_share, stiffness_share
from thermogear.gears.stiffness import Moduli, mesh_stiffness, pair_compliances, weber_approach
from thermogear.gears.tooth import ToothCompliances, flank_point, tooth_compliances
from thermogear.gears.tooth_table import tooth_table
from thermogear.gears.touch import first_touch
from thermogear.gears.turn import turn_period
from thermogear.mesh.thermal import HotPair, ThermalDeviation

STARTS = {
    "textbook-root-circle": "root-circle",
    "textbook-30-degree": "30-degree",
    "loaded": "30-degree",
}
"""Where the beam integrals begin, by the model's choice of stiffness."""
TURN_POSITIONS = 96
"""Positions of every mesh period of a turn of a series, and of its loaded contact's page. The
greatest dynamic force over a turn at a natural over a mesh frequency of .15 moves by .3 % (median
of 64 drawings of four pairs, at most 4 %) from there to 192, by 1 % at most above; 64 positions
move it by 3 %."""
BLOCK = 40_000
"""Positions of all operating points over a turn that are solved at once: about 30 MB."""
KEPT = 200_000
"""Positions of all operating points over a turn whose shares are kept at once: about 30 MB."""


def turn_phases(mesh_periods: int, phase: Floats) -> Floats:
    """The ``phase`` of one mesh period in each of ``mesh_periods``, one after the other.

    >>> turn_phases(2, np.array([0.0, 0.5]))
    array([0. , 0.5, 1. , 1.5])
    """
    return np.asarray((np.arange(mesh_periods)[:, None] + phase).ravel())


def over_turn(
    law: Callable[[Floats], Sequence[NDArray[Any]]],
    phase: Floats,
    mesh_periods: int,
    *,
    count: int = 1,
) -> list[NDArray[Any]]:
    """The arrays that ``law`` makes of phases, (..., positions, ...) with that axis second.

    :data:`BLOCK` positions of ``count`` operating points of a turn at a time; those of the first
    mesh period are asked for with all others, since their places are those of all.

    >>> over_turn(lambda here: [np.floor(here)[None]], np.array([0.0, 0.5, 1.0, 1.5]), 2)[0]
    array([[0., 0., 1., 1.]])
    """
    if mesh_periods == 1:
        return list(law(phase))
    first = phase.size // mesh_periods
    step = max(BLOCK // count, 8 * first)
    whole: list[NDArray[Any]] = []
    for start in range(0, phase.size, step):
        some = law(np.concatenate([phase[:first], phase[start : start + step]]))
        if not whole:
            whole = [np.empty((len(v), phase.size, *v.shape[2:]), v.dtype) for v in some]
        for values, part in zip(whole, some, strict=True):
            values[:, start : start + step] = part[:, first:]
    return whole


class MeshCurves(NamedTuple):
    """Over the mesh phase, all mesh periods one after the other, (count, phases): stiffness
    [N/m], the error [m] that belongs to it (mean removed; None: heat's alone), the static
    transmission error under load [m], and the share of the phase in which a tip corner carries,
    (count,); nan where nothing says.
    """

    stiffness: Floats
    spring_error: Floats | None
    transmission_error: Floats
    edge_share: Floats


class PathShare(NamedTuple):
    """Of one tooth pair along its path, (count, positions): its share of the load, and the tip
    corner that carries there, a place in :data:`~thermogear.base.vocabulary.EDGE_CONTACT`.
    """

    share: Floats
    edge: NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class ElasticPair(ABC):
    """The springs of a pair at its temperatures; results are (count, positions), SI."""

    hot: HotPair
    deviations: Sequence[Deviation] = ()

    @property
    def pair(self) -> GearPair:
        """The gears."""
        return self.hot.pair

    @cached_property
    def mesh_periods(self) -> int:
        """L, after which everything comes again: 1 where the teeth of each gear are alike."""
        return turn_period(self.pair, self.deviations).mesh_periods

    def blocks(self, positions: int) -> Iterator[ElasticPair]:
        """The same pair at some of its operating points after others, :data:`KEPT` of
        ``positions`` at a time; at all of them where one mesh period is all.
        """
        step, count = max(KEPT // positions, 1), self.hot.count
        whole = self.mesh_periods == 1 or step >= count
        # a deviation may differ between the points itself
        if whole or first_touch(mesh_points(self.pair, [0.0]), self.deviations).gap.ndim > 2:
            yield self
            return
        for first in range(0, count, step):
            some = self.hot.operating.part(slice(first, first + step))
            yield replace(self, hot=replace(self.hot, operating=some))

    @property
    def start(self) -> str:
        """Section at which the teeth's beams begin."""
        return STARTS[self.hot.model.stiffness]

    @cached_property
    def moduli(self) -> tuple[Moduli, Moduli]:
        """Of pinion and wheel, arrays (count, 1)."""
        first, second = (self.hot.moduli(gear) for gear in (self.pair.pinion, self.pair.wheel))
        return (
            Moduli(tooth=first[0][:, None], body=first[1][:, None]),
            Moduli(tooth=second[0][:, None], body=second[1][:, None]),
        )

    @cached_property
    def contact_modulus(self) -> Floats:
        """E* [Pa], (count, 1)."""
        pinion, wheel = self.moduli
        return _reduced_modulus(
            pinion.tooth,
            self.pair.pinion.material.poisson_ratio,
            wheel.tooth,
            self.pair.wheel.material.poisson_ratio,
        )

    @property
    def force(self) -> Floats:
        """Normal force F_n [N], (count,)."""
        return np.asarray(self.hot.operating.torque / self.pair.pinion.base_radius)

    def pair_stiffness(self, s: Floats) -> Floats:
        """Stiffness of one tooth pair at ``s`` [m], [N/m]: its :meth:`parts` in series."""
        return in_series(self.parts(s))

    def share(self, s: Floats) -> PathShare:
        """Share of the load on the pair at ``s`` [m], by the model's rule.

        The rules of thumb know no corner: they say "no_edge_contact" all along.
        """
        if self.hot.model.sharing == "loaded":
            return loaded_share(self, s)
        shares = (
            np.broadcast_to(equal_share(self.pair, s), (self.hot.count, s.size))
            if self.hot.model.sharing == "equal"
            else stiffness_share(self.pair, s[None, :], self.start, *self.moduli)
        )
        return PathShare(shares, np.zeros(shares.shape, np.int8))

    @abstractmethod
    def parts(self, s: Floats, shares: PathShare | None = None) -> dict[str, Floats]:
        """Every spring of one tooth pair at ``s`` [m], [N/m], by its stored name.

        ``shares`` of the load at ``s`` where they are known already; else :meth:`share` says.
        """

    @abstractmethod
    def over(self, phase: Floats) -> MeshCurves:
        """Stiffness and errors at the ``phase`` of every mesh period of the turn."""

    def _stiffnesses(self, compliances: dict[str, Floats], s: Floats) -> dict[str, Floats]:
        shape = (self.hot.count, s.size)
        return {name: np.broadcast_to(1.0 / c, shape) for name, c in compliances.items()}


def _named(gear: str, tooth: ToothCompliances, body: Floats) -> dict[str, Floats]:
    """The compliances of one gear by the stored names of their springs."""
    return {
        f"{gear}_bending_stiffness": tooth.bending,
        f"{gear}_shear_stiffness": tooth.shear,
        f"{gear}_axial_stiffness": tooth.axial,
        f"{gear}_body_stiffness": body,
    }


@dataclass(frozen=True, eq=False)
class TextbookPair(ElasticPair):
    """Uncoupled springs of the teeth in contact, in parallel; deviations are not felt."""

    def parts(self, s: Floats, shares: PathShare | None = None) -> dict[str, Floats]:
        found = pair_compliances(self.pair, s, self.start, *self.moduli)
        parts = {"hertz_stiffness": found.contact}
        for name, gear in (("pinion", found.pinion), ("wheel", found.wheel)):
            parts |= _named(name, gear.tooth, gear.foundation)
        wider = self.hot.widened
        return self._stiffnesses({name: part / wider for name, part in parts.items()}, s)

    def over(self, phase: Floats) -> MeshCurves:
        k = mesh_stiffness(self.pair, phase[None, :], self.start, *self.moduli)
        k = np.tile(k * self.hot.widened, self.mesh_periods)
        unsaid = np.full(self.hot.count, np.nan)
        return MeshCurves(k, None, self.force[:, None] / k, unsaid)


@dataclass(frozen=True, eq=False)
class LoadedPair(ElasticPair):
    """The loaded contact: coupled teeth, deviations of the flanks and heat's among them.

    Stiffness and error are one of two consistent pairs, so that elasticity is counted once:
    tangent, F = k_t <y - b - e_0> with e_0 = delta - F_n/k_t at the mean load, or secant,
    F = F_n/(delta - e_u) <y - b - e_u> with e_u the unloaded error. They differ by the
    contact's hardening, 2 to 3 % in k.
    """

    def solve(self, phase: Floats) -> LoadedMesh:
        """The loaded contact at ``phase``, lead axis (count,).

        All compliances fall with the width alike: a pair b times as wide under F deflects as the
        pair itself under F/b, with b times the stiffness and the force of each tooth pair.
        """
        moduli = [Moduli(tooth=np.ravel(m.tooth), body=np.ravel(m.body)) for m in self.moduli]
        wider = np.ravel(self.hot.widened)
        solved = solve_mesh(
            self.pair,
            self.force / wider,
            phase,
            pinion=moduli[0],
            wheel=moduli[1],
            deviations=(*self.deviations, ThermalDeviation(self.hot)),
            model=self.hot.model.loaded,
        )
        return solved if self.hot.operating.varied.face_width is None else solved.wider(wider)

    def solved(self, phase: Floats, *names: str) -> list[NDArray[Any]]:
        """Arrays of :meth:`solve` by their ``names``, (count, positions, ...).

        Over a turn only what is asked for is kept, see :func:`over_turn`.
        """

        def some(here: Floats) -> list[NDArray[Any]]:
            mesh = self.solve(here)
            return [getattr(mesh, name) for name in names]

        return over_turn(some, phase, self.mesh_periods, count=self.hot.count)

    def parts(self, s: Floats, shares: PathShare | None = None) -> dict[str, Floats]:
        compliances: dict[str, Floats] = {}
        pair, width = self.pair, self.hot.face_width
        carried = (self.share(s) if shares is None else shares).share * self.force[:, None]
        load = np.maximum(carried, LEAST_LINE_LOAD * width)
        half_width = hertz_half_width(load / width, reduced_radius(pair, s), self.contact_modulus)
        near = contact_point(pair, s)
        edge = hertz_half_width(load / width, near.rounding, self.contact_modulus)
        # near a tip the contact narrows, see sharing_kernel
        lost = np.maximum((1.0 - 0.5 * FREE) * half_width - edge, 0.0)
        half_width = half_width - lost * np.maximum(1.0 - near.distance / half_width, 0.0) ** 2
        approach = np.zeros_like(load)
        for name, gear, rho, moduli in zip(
            ("pinion", "wheel"),
            (pair.pinion, pair.wheel),
            curvature_radii(pair, s),
            self.moduli,
            strict=True,
        ):
            t = rho / gear.base_radius
            point = flank_point(gear, t)
            approach += weber_approach(
                load,
                depth=point.x / np.cos(point.beta),
                half_width=half_width,
                modulus=moduli.tooth,
                poisson=gear.material.poisson_ratio,
                face_width=width,
            )
            compliances |= self._gear_parts(name, gear, t, moduli)
        return self._stiffnesses(compliances | {"hertz_stiffness": approach / load}, s)

    def _gear_parts(self, name: str, gear: Gear, t: Floats, moduli: Moduli) -> dict[str, Floats]:
        """Compliances of one gear without its contact: one where finite elements solve it."""
        model, width = self.hot.model, self.hot.face_width
        windup = model.body == "bore-clamped"
        if model.tooth == "solved":
            table = tooth_table(gear, model.plane)
            tooth, body = table.self_compliance(t)
            held = 0.0 if windup else table.windup
            parts = tooth / np.asarray(moduli.tooth) + (body - held) / np.asarray(moduli.body)
            return {f"{name}_gear_stiffness": np.asarray(parts / width)}
        return _named(
            name,
            tooth_compliances(gear, t, self.start, moduli.tooth, width),
            ring_compliance(gear, t, modulus=moduli.body, face_width=width, windup=windup),
        )

    def over(self, phase: Floats) -> MeshCurves:
        secant = self.hot.model.spring == "secant"
        k, deflection, unloaded, edge, settled = self.solved(
            turn_phases(self.mesh_periods, phase),
            *("secant" if secant else "tangent", "deflection", "unloaded", "edge", "settled"),
        )
        error = unloaded if secant else deflection - self.force[:, None] / k
        carried = (edge > 0).any(axis=-1).mean(axis=-1)
        # what is the same all along belongs to the backlash, not to the error
        return MeshCurves(
            k,
            error - error.mean(axis=-1, keepdims=True),
            deflection - unloaded.mean(axis=-1, keepdims=True),
            np.where(settled.all(axis=-1), carried, np.nan),
        )


def loaded_share(elastic: ElasticPair, s: Floats) -> PathShare:
    """Share of the pair at ``s`` [m] and its corners from the loaded contact, (count, positions).

    The share is nan where the contact does not settle. Plain involutes touch on their flanks from
    A to E, both included; a corner carries there only where the shape of a flank lets it touch
    first. Where teeth differ, the mean over all tooth pairs of the turn, and the corners that carry
    on any of them.
    """
    return mean_share(tooth_pair_shares(elastic, s))


def mean_share(every: PathShare) -> PathShare:
    """Over the tooth pairs of a turn, (count, tooth pair, positions): the one of all of them."""
    if every.share.shape[1] == 1:
        return PathShare(every.share[:, 0], every.edge[:, 0])
    return PathShare(every.share.mean(axis=1), np.bitwise_or.reduce(every.edge, axis=1))


def tooth_pair_shares(elastic: ElasticPair, s: Floats) -> PathShare:
    """:func:`loaded_share` of every tooth pair of the turn, (count, tooth pair, positions).

    Tooth pair m, the one that enters at A at the mesh phase m, joins the pinion's tooth m mod z1
    and the wheel's m mod z2, counted from 0.
    """
    pair, periods = elastic.pair, elastic.mesh_periods
    steps = (s - pair.path.a) / pair.base_pitch
    rank = np.floor(steps + 1e-9).astype(int)
    # rounding below a whole step would be the phase's other end
    phase = turn_phases(periods, np.maximum(steps - rank, 0.0))
    # a tooth pair is at its place so many mesh periods after it entered
    period = (np.arange(periods)[:, None] + rank) % periods
    place = np.arange(s.size)
    parts = []
    for part in elastic.blocks(phase.size):
        whole = (part.hot.count, periods, s.size, -1)
        # the candidates begin one pair before the one that entered last
        parts.append(
            [
                values.reshape(whole)[:, period, place, rank + 1]
                for values in loaded_pair(part).solved(phase, "share", "edge")
            ]
        )
    # in the order of their axes: sums along the path go by it
    share, edge = (
        np.ascontiguousarray(np.concatenate(values)) for values in zip(*parts, strict=True)
    )
    return PathShare(share, edge)


def in_series(parts: Mapping[str, Floats]) -> Floats:
    """Stiffness [N/m] of springs one after the other.

    >>> in_series({"tooth": np.array([2e8]), "body": np.array([2e8])})
    array([1.e+08])
    """
    return np.asarray(1.0 / sum(1.0 / k for k in parts.values()))


def elastic_pair(hot: HotPair, deviations: Sequence[Deviation] = ()) -> ElasticPair:
    """The springs that the model of ``hot`` chooses."""
    return (LoadedPair if hot.model.stiffness == "loaded" else TextbookPair)(hot, deviations)


def loaded_pair(elastic: ElasticPair) -> LoadedPair:
    """The loaded contact of the same teeth, itself where it is one."""
    if isinstance(elastic, LoadedPair):
        return elastic
    return LoadedPair(elastic.hot, elastic.deviations)


def mean_stiffness_of_body(elastic: ElasticPair, phase: Floats, body: str) -> Floats:
    """Mean tangent stiffness [N/m] of the loaded contact with one reading of the bore, (count,).

    Over the ``phase`` of every mesh period.
    """
    model = elastic.hot.model.override(stiffness="loaded", body=body, spring="tangent")
    pair = LoadedPair(replace(elastic.hot, model=model), elastic.deviations)
    return np.asarray(pair.over(phase).stiffness.mean(axis=-1))
