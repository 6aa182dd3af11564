"""Frictionless contact of two gears on the nodes of their flanks, tip corners with it.

The slave of a pair of teeth is the gear whose tip is nearer, so that its corner is a node; the
master is the mate's exact involute: a point of the slave at the distance R from the mate's centre
and the polar angle theta has the gap

    g = q - q_i,   q = sqrt(R^2 - r_b^2),   q_i = r_b (theta_b - theta + arctan(q/r_b)),

along the mate's normal, which it meets at the string q_i. Pressures are linear between the
vertices of the slave's elements; the gaps weighted by their hats close:

    w = G + C p - lambda delta >= 0,   p >= 0,   w p = 0,   sum lambda m p = F_n/b,

lambda: lever of the force on the pinion over r_b1. Solved by a primal-dual active set.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from finite_elements.sector import FlankSector
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError
from thermogear.gears.deviations import GEARS, FlankShape
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth import flank_point
from thermogear.gears.tooth_table import indentation

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
_ROUNDS = 60
"""Changes of the active set; a handful is usual."""
_SETTLED = 1e-3
"""Relative change of what plane strain holds in, itself 2 % of the deflection."""
_REACH = 3.0
"""Candidates reach to this multiple of the deflection of a mesh of 6 N/(mm um)."""
_SOFTEST = 6e9
_WINDOW = 3e-4
"""Gaps [m] beyond a flank's least that are looked at: m 10 at 2000 N/mm deflects 0.15 mm."""

NEAR = {
    "strain": "plane strain as far from the contact as the tooth's axis, along the force",
    "stress": "plane stress up to the contact",
}
"""Plane state around a contact: its material is held in by the rest of the tooth's width."""


class ToothContact(NamedTuple):
    """A pair of teeth at one position: load cases of both gears, gaps, areas and levers."""

    number: int
    cases: tuple[tuple[Floats, Floats], tuple[Floats, Floats]]
    gap: Floats
    area: Floats
    lever: Floats
    arc: Floats
    strings: Floats


class _Points(NamedTuple):
    """Points of a slave: arcs [m] on it and on its mate, gap [m], and where the mate's flank is.

    angle [rad]: from the slave's normal to the force; lever: on the pinion, over r_b1.
    """

    arc: Floats
    arc_mate: Floats
    gap: Floats
    angle: Floats
    lever: Floats
    valid: NDArray[np.bool_]


class Solved(NamedTuple):
    """One position: deflection [m], force per width [N/m] by number of the pair, pressure [Pa]."""

    deflection: float
    force: dict[int, float]
    pressure: float
    half_width: dict[int, float]


@dataclass(frozen=True, eq=False)
class FlankContact:
    """Two gears in contact; ``edge_radius`` [m] of pinion's and wheel's tip edge."""

    pair: GearPair
    sectors: tuple[FlankSector, FlankSector]
    deviations: Sequence[FlankShape] = ()
    edge_radius: tuple[float, float] = (0.0, 0.0)
    corners: bool = True
    near: str = "strain"

    def solve(self, load: float, phase: float) -> Solved:
        """Deflection and shares under ``load`` F_n/b [N/m] at ``phase`` in periods from A."""
        pair = self.pair
        window = _REACH * load / _SOFTEST
        reach = int(np.ceil(pair.contact_ratio)) + 1
        touching = []
        for k in range(-1 if self.corners else 0, reach):
            s = pair.path.a + (phase + k) * pair.base_pitch
            if not self.corners and s > pair.path.e:
                continue
            touching.append(self._teeth(k, s))
        nearest = min(float(np.min(t.gap, initial=np.inf)) for t in touching)
        touching = [t for t in (_only(t, t.gap < nearest + window) for t in touching) if t.gap.size]
        return self._balance(load, touching)

    def _teeth(self, number: int, s: float) -> ToothContact:
        """Hats of the slave of the pair ``number`` that touches at ``s`` [m] from N1."""
        pair, total = self.pair, self.pair.line_of_action
        which = 1 if s < 0.5 * (pair.path.a + pair.path.e) else 0
        slave, mate = self.sectors[which], self.sectors[1 - which]
        points = self._points(which, (s, total - s)[which])

        weight = 0.5 * np.diff(slave.arcs)[:, None] * _WEIGHTS
        part = np.broadcast_to(0.5 + 0.5 * _POINTS, points.arc.shape)
        hats = np.stack([1.0 - part, part]) * weight
        vertex = np.broadcast_to(np.arange(slave.rows)[:, None], part.shape)
        into = np.stack([vertex, vertex + 1])

        def summed(values: Floats) -> Floats:
            parts = (hats * values).ravel()
            return np.bincount(into.ravel(), parts, minlength=slave.rows + 1).astype(float)

        area = summed(np.ones_like(part))
        gap = np.where(
            summed((~points.valid).astype(float)) == 0.0, summed(points.gap) / area, np.inf
        )
        use = np.flatnonzero(gap < np.min(gap) + _WINDOW)
        # the load cases of the hats in use alone
        row = np.full(slave.rows + 1, -1)
        row[use] = np.arange(use.size)
        slave_case = np.zeros((use.size, slave.degrees))
        mate_case = np.zeros((use.size, mate.degrees))
        for half in range(2):
            keep = row[into[half]] >= 0
            case, force = row[into[half]][keep], hats[half][keep]
            nodes, shape = slave.shapes(points.arc[keep])
            tilt = points.angle[keep]
            np.add.at(slave_case, (case, nodes), shape * force * np.cos(tilt))
            tip = nodes >= 2 * slave.rows + 1 - slave.turned
            sideways = np.where(tip, shape * force * np.sin(tilt), 0.0)
            np.add.at(slave_case, (case, np.where(tip, nodes + slave.turned, 0)), sideways)
            nodes, shape = mate.shapes(points.arc_mate[keep])
            np.add.at(mate_case, (case, nodes), shape * force)
        cases = [(slave_case, slave.felt(slave_case)), (mate_case, mate.felt(mate_case))]
        return ToothContact(
            number=number,
            cases=(cases[which], cases[1 - which]),
            gap=gap[use],
            area=area[use],
            lever=(summed(points.lever) / area)[use],
            arc=slave.arcs[use],
            strings=np.array([s, total - s]),
        )

    def _points(self, which: int, string: float) -> _Points:
        """Gauss points of the slave ``which``, whose involute touches at the length ``string``."""
        pair, total = self.pair, self.pair.line_of_action
        slave, mate = self.sectors[which], self.sectors[1 - which]
        r_s, r_m = slave.gear.base_radius, mate.gear.base_radius
        arc = slave.arcs[:-1, None] + np.diff(slave.arcs)[:, None] * (0.5 + 0.5 * _POINTS)
        q = np.sqrt(2.0 * r_s * arc)
        turned = (string - q) / r_s
        own = r_s + 1j * q
        # seen from the mate, whose frame is turned by half a turn
        place = (r_s + r_m) + 1j * total - np.exp(1j * turned) * own
        with np.errstate(invalid="ignore"):
            q_mate = np.sqrt(np.abs(place) ** 2 - r_m**2)
            psi = np.angle(place / (r_m + 1j * q_mate))
        touched = total - string - r_m * psi
        gap = q_mate - touched + self._rounded(slave, which, arc, q)
        for shape in self.deviations:
            if shape.acts_on("drive"):
                on_slave = GEARS.index(shape.gear) == which
                gap = gap + shape.taken_off(pair, q if on_slave else touched)
        arc_mate = touched**2 / (2.0 * r_m)
        low, high = mate.ends
        valid = np.isfinite(gap) & (touched > 0.0) & (arc_mate >= low) & (arc_mate <= high)
        angle = np.where(valid, psi - turned, 0.0)
        # the pinion's lever over r_b1: a force along its own flank's normal has r_b1
        lever = np.real(np.conj(own) * np.exp(1j * angle)) / r_s if which == 0 else np.ones_like(q)
        return _Points(
            arc=arc,
            arc_mate=np.where(valid, arc_mate, low),
            gap=np.where(valid, gap, 0.0),
            angle=angle,
            lever=lever,
            valid=valid,
        )

    def _rounded(self, slave: FlankSector, which: int, arc: Floats, q: Floats) -> Floats:
        """Gap by the rounded edge of the slave's tip; nan where the edge has left the flank."""
        radius = self.edge_radius[which]
        if radius == 0.0:
            return np.zeros_like(arc)
        gear = slave.gear
        sine = np.sin(gear.pressure_angle_at(gear.tip_radius))
        tip = np.sqrt(gear.tip_radius**2 - gear.base_radius**2)
        start = (tip - radius * (1.0 - sine) / sine) ** 2 / (2.0 * gear.base_radius)
        beyond = np.maximum(arc - start, 0.0)
        relative = 1.0 / (1.0 / radius - 1.0 / q)
        with np.errstate(invalid="ignore"):
            return np.where(
                beyond < 0.9 * radius, relative - np.sqrt(relative**2 - beyond**2), np.nan
            )

    def _compliance(self, touching: list[ToothContact]) -> Floats:
        """Gap opened at each hat by unit pressures at all, [m3/N]."""
        signs = (1, -1)

        def block(first: ToothContact, second: ToothContact) -> Floats:
            ahead = first.number - second.number
            parts = [
                sector.compliance(first.cases[g], second=second.cases[g], lag=signs[g] * ahead)
                / sector.gear.material.youngs_modulus
                for g, sector in enumerate(self.sectors)
            ]
            return parts[0] + parts[1]

        return np.block([[block(first, second) for second in touching] for first in touching])

    def _balance(self, load: float, touching: list[ToothContact]) -> Solved:
        """Pressures and deflection; the plane state's difference follows the half widths."""
        compliance = self._compliance(touching)
        gap = np.concatenate([t.gap for t in touching])
        area = np.concatenate([t.area for t in touching])
        lever = np.concatenate([t.lever for t in touching])
        owner = np.repeat(np.arange(len(touching)), [t.gap.size for t in touching])
        held = np.zeros(len(touching))
        for _ in range(_ROUNDS):
            same = (owner[:, None] == owner) * held[owner]
            pressure, deflection = closed(
                compliance + same * np.outer(area, area),
                gap=gap * area,
                area=area,
                lever=lever,
                load=load,
            )
            carried = pressure * area
            force = np.bincount(owner, carried, minlength=len(touching))
            widths = [_half_width(t, carried[owner == i]) for i, t in enumerate(touching)]
            new = np.array([self._held_in(t, a) for t, a in zip(touching, widths, strict=True)])
            if self.near == "stress" or np.allclose(new, held, rtol=_SETTLED, atol=0.0):
                numbers = [t.number for t in touching]
                return Solved(
                    deflection,
                    dict(zip(numbers, force.tolist(), strict=True)),
                    float(pressure.max()),
                    dict(zip(numbers, widths, strict=True)),
                )
            held = new
        raise ConvergenceError(f"half widths: still changing after {_ROUNDS} rounds")

    def _held_in(self, touch: ToothContact, half_width: float) -> float:
        """Both gears' :func:`held_in` by force [m2/N]; ``half_width`` in plane stress."""
        total = 0.0
        for sector, string in zip(self.sectors, touch.strings, strict=True):
            gear = sector.gear
            low, high = np.sqrt(2.0 * np.array(sector.ends) / gear.base_radius)
            t = float(np.clip(string / gear.base_radius, low, high))
            narrow = half_width * float(np.sqrt(1.0 - gear.material.poisson_ratio**2))
            total += (
                held_in(gear, t, in_stress=half_width, in_strain=narrow)
                / gear.material.youngs_modulus
            )
        return total


def held_in(gear: Gear, t: float, *, in_stress: float, in_strain: float) -> float:
    """Approach of a flank in plane strain less that in plane stress, times E b/F.

    t: tan(alpha_k); half widths [m] of the pressure in both states. Source: Weber's law, see
    :func:`~thermogear.gears.tooth_table.indentation`.
    """
    at = flank_point(gear, t)
    depth, nu = float(at.x / np.cos(at.beta)), gear.material.poisson_ratio
    strain = (1.0 - nu * nu) * indentation(depth / in_strain, poisson=nu / (1.0 - nu))
    return float(strain - indentation(depth / in_stress, poisson=nu))


def _only(touch: ToothContact, keep: NDArray[np.bool_]) -> ToothContact:
    """The hats ``keep`` of a pair of teeth."""
    return touch._replace(
        cases=(
            (touch.cases[0][0][keep], touch.cases[0][1][keep]),
            (touch.cases[1][0][keep], touch.cases[1][1][keep]),
        ),
        gap=touch.gap[keep],
        area=touch.area[keep],
        lever=touch.lever[keep],
        arc=touch.arc[keep],
    )


def _half_width(touch: ToothContact, force: Floats) -> float:
    """Half width of the elliptic pressure with the same spread: a^2 = 4 <x^2>."""
    total = float(force.sum())
    least = 0.5 * float(touch.area.min())
    if total <= 0.0:
        return least
    place = touch.arc - force @ touch.arc / total
    return max(float(np.sqrt(4.0 * (force @ place**2) / total)), least)


def closed(
    compliance: Floats, *, gap: Floats, area: Floats, lever: Floats, load: float
) -> tuple[Floats, float]:
    """Pressures p >= 0 and deflection delta of w = gap + C p - area lambda delta >= 0, w p = 0."""
    along = area * lever
    active = gap / along <= np.min(gap / along) + 0.5 * load / 15e9
    for _ in range(_ROUNDS):
        n = int(active.sum())
        system = np.zeros((n + 1, n + 1))
        system[:n, :n] = compliance[np.ix_(active, active)]
        system[:n, n] = system[n, :n] = -along[active]
        found = np.linalg.solve(system, np.append(-gap[active], -load))
        pressure = np.zeros(gap.size)
        pressure[active] = found[:n]
        left = gap + compliance @ pressure - along * found[n]
        new = np.where(active, pressure > 0.0, left < 0.0)
        if np.array_equal(new, active):
            return pressure, float(found[n])
        active = new
    raise ConvergenceError(f"contact: still changing after {_ROUNDS} rounds of the active set")
