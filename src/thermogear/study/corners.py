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

EDGE_YIELD = 4e9
"""Pressure [Pa] of a line contact that leaves a lasting mark in hardened bearing steel, as hard as
gears are made: ISO 76, static load rating of roller bearings, 4000 MPa."""
HALVINGS = 14
"""Of the logarithm of the torque at which a corner begins to carry: under 0.1 % of four decades."""
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

    def under(self, torque: Floats, *, phase: Floats, mean: float | None = None) -> LoadedMesh:
        """The mesh at ``phase``, axes (state, load) first: pinion torques [N m] of that shape.

        ``mean``: torque [N m] over whose contact the flanks are averaged, each its own if left out.
        """
        base = self.pair.pinion.base_radius
        load = None if mean is None else mean / base
        return solve_mesh(self.pair, torque / base, phase, mean_load=load, **self.arguments)

    def onset(self, greatest: float) -> Floats:
        """Pinion torque [N m] from which on the corners of pinion and wheel carry, (state, gear).

        The gap of a corner grows from that of its flank's last point: it carries as soon as the
        pair there does, at E for the pinion, at A for the wheel; or where the shape of a flank lets
        it touch first. 0 where that is so at any load (1 N/mm), nan where up to the ``greatest``
        torque it is not. Halved between the two; flanks averaged over the contact of the greatest.
        """
        pair = self.pair
        ends = np.array([pair.path.e, pair.path.a])
        phase = np.concatenate([((ends - pair.path.a) / pair.base_pitch) % 1.0, UNIFORM])

        def carry(torque: Floats) -> NDArray[np.bool_]:
            mesh, gear = self.under(torque, phase=phase, mean=greatest), np.arange(2)
            last = np.abs(mesh.points.s[:2] - ends[:, None]).argmin(axis=-1)
            touched = mesh.force[:, gear, gear, last] > 0.0
            return np.asarray(touched | (mesh.corner_load[:, gear, gear] > 0.0))

        least = min(LEAST_LINE_LOAD * pair.face_width * pair.pinion.base_radius, greatest)
        low, high = (np.full((self.hot.count, 2), torque) for torque in (least, greatest))
        always, ever = carry(low), carry(high)
        for _ in range(HALVINGS):
            there = carry(middle := np.sqrt(low * high))
            low, high = np.where(there, low, middle), np.where(there, middle, high)
        return np.where(always, 0.0, np.where(ever, high, np.nan))

    def yields(self, mesh: LoadedMesh) -> NDArray[np.bool_]:
        """Whether the rounding of a corner that carries is pressed above :data:`EDGE_YIELD`.

        p = 2 F/(pi a), a = sqrt(4 F rho/(pi E*)), 1/rho = 1/r_e + 1/q with q the mate's string:
        Hertz's pressure of the edge circle on the flank, within a factor of 2 of finite elements
        (lower while the flank beside it carries too; module 5 mm, 25:75, 200 N/mm, r_e 0.05 and
        0.2 mm: at most 7.7 and 3.9 GPa, finite elements 6.8 and 4.1). Of pinion and wheel, (state,
        load, gear); False where the edge has no rounding, whose pressure has no bound.
        """
        strings, modulus = mesh.points.point, self.contact_modulus[:, :, None, None]
        found = []
        for gear, mate, bit in (
            (self.pair.pinion, strings.wheel, 2),
            (self.pair.wheel, strings.pinion, 1),
        ):
            radius = gear.tip_rounding * mate / (gear.tip_rounding + mate)
            pressure = hertz_pressure(mesh.force / self.pair.face_width, radius, modulus)
            carries = (mesh.edge & bit > 0) & (gear.tip_rounding > 0.0)
            found.append((carries & (pressure > EDGE_YIELD)).any(axis=(-2, -1)))
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
        if any(getattr(self.pair, gear).tip_rounding == 0.0 for _, gear in carried):
            words.append("no pressure is known on a sharp edge")
        if yields.any():
            words.append("a rounded edge is pressed above what any steel bears and will settle")
        return mesh, "; ".join(words), figures
