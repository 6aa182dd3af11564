"""Tip corners that carry: whose, how much of the load, for how long, from which torque on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.gears.contact import hertz_pressure
from thermogear.gears.deviations import GEARS
from thermogear.gears.loaded import LEAST_LINE_LOAD, LoadedMesh, solve_mesh
from thermogear.mesh.elastic import LoadedPair
from thermogear.mesh.thermal import ThermalDeviation
from thermogear.study.relief import UNIFORM, Seen
from thermogear.study.scuffing import steel

EDGE_YIELD = 4e9
"""Pressure [Pa] of a line contact that leaves a lasting mark in hardened bearing steel, as hard as
gears are made: ISO 76, static load rating of roller bearings, 4000 MPa. Of steel alone."""
RUNG, HALVINGS = 4.0 / 3.0, 9
"""Ratio of the torques between which a corner begins to carry, and how often it is halved: to
0.06 % of the torque, flanks averaged over a contact at most 15 % wider than at the onset."""
ENDS = {"wheel": "before A, in approach", "pinion": "beyond E, in recess"}
"""Where a gear's tip corner carries, the pinion driving."""


@dataclass(frozen=True, eq=False)
class HotContact(LoadedPair):
    """The loaded contact of a pair in several hot states, each under several loads."""

    @cached_property
    def arguments(self) -> dict[str, Any]:
        """Of :func:`~thermogear.gears.loaded.solve_mesh` for loads of shape (state, load)."""
        return {
            **dict(zip(("pinion", "wheel"), self.moduli, strict=True)),
            "deviations": [*self.deviations, Seen(ThermalDeviation(self.hot), np.s_[:, None])],
            "model": self.hot.model.loaded,
        }

    def under(self, torque: Floats, *, phase: Floats, mean: Floats | None = None) -> LoadedMesh:
        """The mesh at ``phase``, axes (state, load) first: pinion torques [N m] of that shape.

        ``mean``: torques [N m] over whose contact the flanks are averaged, its own if left out.
        """
        base = self.pair.pinion.base_radius
        load = None if mean is None else mean / base
        return solve_mesh(self.pair, torque / base, phase, mean_load=load, **self.arguments)

    def onset(self, greatest: float) -> Floats:
        """Pinion torque [N m] from which on the corners of pinion and wheel carry, (state, gear).

        The gap of a corner grows from that of its flank's last point: it carries as soon as the
        pair there does, at E for the pinion, at A for the wheel; or where the shape of a flank lets
        it touch first. 0 where that is so at any load (1 N/mm), nan where up to the ``greatest``
        torque it is not, or undercut ends the path. On a ladder of loads, the same for every
        ``greatest``, then halved; flanks averaged over the contact of the upper one.
        """
        pair, gear = self.pair, np.arange(2)
        if pair.cut_short:
            return np.full((self.hot.count, 2), np.nan)
        ends = np.array([pair.path.e, pair.path.a])
        phase = np.concatenate([((ends - pair.path.a) / pair.base_pitch) % 1.0, UNIFORM])

        def carry(torque: Floats, mean: Floats | None = None) -> NDArray[np.bool_]:
            mesh = self.under(torque, phase=phase, mean=mean)
            last = np.abs(mesh.points.s[:2] - ends[:, None]).argmin(axis=-1)
            touched = mesh.force[:, :, gear, last] > 0.0
            return np.asarray(touched | (mesh.corner_load > 0.0))

        least = LEAST_LINE_LOAD * pair.face_width * pair.pinion.base_radius
        steps = max(int(np.ceil(np.log(greatest / least) / np.log(RUNG))), 0)
        rungs = np.minimum(least * RUNG ** np.arange(steps + 1), greatest)
        there = carry(np.tile(rungs, (self.hot.count, 1)))
        first = there.argmax(axis=1)
        low, high = rungs[np.maximum(first - 1, 0)], rungs[first]
        mean = high
        for _ in range(HALVINGS):
            reached = carry(middle := np.sqrt(low * high), mean)[:, gear, gear]
            low, high = np.where(reached, low, middle), np.where(reached, middle, high)
        return np.where(there[:, 0], 0.0, np.where(there.any(axis=1), high, np.nan))

    def yields(self, mesh: LoadedMesh) -> NDArray[np.bool_]:
        """Whether the rounding of a corner that carries is pressed above :data:`EDGE_YIELD`.

        p = 2 F/(pi a), a = sqrt(4 F rho/(pi E*)), 1/rho = 1/r_e + 1/q with q the mate's string:
        Hertz's pressure of the edge circle on the flank, within a factor of 2 of finite elements
        (lower while the flank beside it carries too; module 5 mm, 25:75, 200 N/mm, r_e 0.05 and
        0.2 mm: at most 7.7 and 3.9 GPa, finite elements 6.8 and 4.1). Of pinion and wheel, (state,
        load, gear); False where the edge has no rounding, whose pressure has no bound, and where
        it is not of steel, as what it bears is not known.
        """
        strings, modulus = mesh.points.point, self.contact_modulus[:, :, None, None]
        found = []
        for gear, mate, bit in (
            (self.pair.pinion, strings.wheel, 2),
            (self.pair.wheel, strings.pinion, 1),
        ):
            radius = gear.tip_rounding * mate / (gear.tip_rounding + mate)
            pressure = hertz_pressure(mesh.force / self.pair.face_width, radius, modulus)
            known = gear.tip_rounding > 0.0 and steel(gear.material)
            pressed = (mesh.edge & bit > 0) & (pressure > EDGE_YIELD)
            found.append(pressed.any(axis=(-2, -1)) & known)
        return np.stack(found, axis=-1)

    def told(self, torque: float) -> tuple[LoadedMesh, str, dict[str, float]]:
        """The mesh of one state under ``torque`` [N m], and what corners carry of it in words.

        Figures of the words: [%] of the load and of the period, [N m]. Empty words where no corner
        carries.
        """
        mesh = self.under(np.array([[torque]]), phase=UNIFORM)
        load, part, yields = mesh.corner_load[0, 0], mesh.corner_part[0, 0], self.yields(mesh)[0, 0]
        onset, words, figures = self.onset(torque)[0], list[str](), dict[str, float]()
        carried = [(place, GEARS[place]) for place in (1, 0) if load[place] > 0.0]
        for place, gear in carried:
            since = f"from {{{gear}_onset:.3g N m}} on" if onset[place] > 0.0 else "at any load"
            words.append(
                f"{ENDS[gear]}, the {gear}'s tip corner carries up to {{{gear}_load:.0f %}} of the "
                f"load during {{{gear}_part:.1f %}} of the mesh period, {since}"
            )
            figures |= {
                f"{gear}_load": 100.0 * float(load[place]),
                f"{gear}_part": 100.0 * float(part[place]),
                f"{gear}_onset": float(onset[place]),
            }
        edges = [getattr(self.pair, gear) for _, gear in carried]
        if any(gear.tip_rounding == 0.0 for gear in edges):
            words.append("no pressure is known on a sharp edge")
        if soft := {g.material.name for g in edges if not steel(g.material)}:
            words.append(f"what an edge of {' and '.join(sorted(soft))} bears is not known")
        if yields.any():
            words.append("a rounded edge is pressed above what any steel bears and will settle")
        return mesh, "; ".join(words), figures
