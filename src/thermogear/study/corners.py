"""Tip corners that carry: whose, how much of the load, for how long, from which torque on."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.case.case import GearCase
from thermogear.gears.contact import hertz_pressure
from thermogear.gears.loaded import LEAST_LINE_LOAD, LoadedMesh, solve_mesh
from thermogear.gears.stiffness import Moduli
from thermogear.mesh.elastic import LoadedPair
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair, ThermalDeviation
from thermogear.study.relief import Seen

UNIFORM = np.arange(200) / 200
"""Positions of a mesh period [periods] at which the contact is solved."""
EDGE_YIELD = 4e9
"""Pressure [Pa] of a line contact that leaves a lasting mark in hardened bearing steel, as hard as
gears are made: ISO 76, static load rating of roller bearings, 4000 MPa."""
HALVINGS = 14
"""Of the logarithm of the torque at which a corner begins to carry: under 0.1 % of four decades."""
ENDS = {"pinion": "beyond E, in recess", "wheel": "before A, in approach"}
"""Where a gear's tip corner carries, the pinion driving."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HotContact:
    """The loaded contact of a case's pair in the states of ``operating``, at any loads."""

    case: GearCase
    model: MeshModel
    operating: Operating

    @cached_property
    def hot(self) -> HotPair:
        """The pair at the temperatures of every state."""
        return HotPair(self.case.pair, self.operating, self.model)

    @cached_property
    def arguments(self) -> dict[str, Any]:
        """Of :func:`~thermogear.gears.loaded.solve_mesh` for loads of shape (state, load)."""
        pinion, wheel = (
            Moduli(tooth=np.reshape(m.tooth, (-1, 1)), body=np.reshape(m.body, (-1, 1)))
            for m in LoadedPair(self.hot).moduli
        )
        return {
            "pinion": pinion,
            "wheel": wheel,
            "deviations": [*self.case.deviations, Seen(ThermalDeviation(self.hot), np.s_[:, None])],
            "model": self.model.loaded,
        }

    def force(self, torque: Floats) -> Floats:
        """Normal force [N] of pinion torques (state, load) or (load,), shape (state, load)."""
        load = np.asarray(torque / self.case.pair.pinion.base_radius)
        return np.broadcast_to(load, (self.hot.count, load.shape[-1]))

    def solve(self, torque: Floats, phase: Floats) -> LoadedMesh:
        """The mesh at ``phase``, leading axes (state, load)."""
        return solve_mesh(self.case.pair, self.force(torque), phase, **self.arguments)

    def onset(self, greatest: float) -> Floats:
        """Pinion torque [N m] from which on the corners of pinion and wheel carry, (state, gear).

        The gap of a corner grows from that of its flank's last point: it carries as soon as the
        pair there does, at E for the pinion, at A for the wheel; or where the shape of a flank lets
        it touch first. 0 where that is so at any load (1 N/mm), nan where up to the ``greatest``
        torque it is not. Halved between the two.
        """
        pair = self.case.pair
        ends = np.array([pair.path.e, pair.path.a])
        phase = np.concatenate([((ends - pair.path.a) / pair.base_pitch) % 1.0, UNIFORM])

        def carry(torque: Floats) -> NDArray[np.bool_]:
            mesh = self.solve(torque, phase)
            place = np.abs(mesh.points.s[:2] - ends[:, None]).argmin(axis=-1)
            both = [
                (mesh.force[:, i, i, place[i]] > 0.0) | (mesh.corner_load[:, i, i] > 0.0)
                for i in range(2)
            ]
            return np.stack(both, axis=-1)

        least = LEAST_LINE_LOAD * pair.face_width * pair.pinion.base_radius
        low = np.full((self.hot.count, 2), min(least, greatest))
        high = np.full(low.shape, greatest)
        always, ever = carry(low), carry(high)
        for _ in range(HALVINGS):
            middle = np.sqrt(low * high)
            there = carry(middle)
            low, high = np.where(there, low, middle), np.where(there, middle, high)
        return np.where(always, 0.0, np.where(ever, high, np.nan))

    def yields(self, mesh: LoadedMesh) -> NDArray[np.bool_]:
        """Whether the rounding of a corner that carries is pressed above :data:`EDGE_YIELD`.

        p = 2 F/(pi a), a = sqrt(4 F rho/(pi E*)), 1/rho = 1/r_e + 1/q with q the mate's string:
        Hertz's pressure of the edge circle on the flank, within a factor of 2 of finite elements
        (lower while the flank beside it carries too). Of pinion and wheel, (state, load, gear);
        False where the edge has no rounding, whose pressure has no bound.
        """
        pair, modulus = self.case.pair, LoadedPair(self.hot).contact_modulus[:, :, None, None]
        strings, line = mesh.points.point, mesh.force / pair.face_width
        found = []
        for gear, mate, bit in ((pair.pinion, strings.wheel, 2), (pair.wheel, strings.pinion, 1)):
            radius = 1.0 / (1.0 / max(gear.tip_rounding, 1e-12) + 1.0 / np.maximum(mate, 1e-12))
            pressed = hertz_pressure(line, radius, modulus) > EDGE_YIELD
            found.append(((mesh.edge & bit) > 0) & pressed & (gear.tip_rounding > 0.0))
        return np.stack([corner.any(axis=(-2, -1)) for corner in found], axis=-1)


def told(
    case: GearCase, *, load: Floats, part: Floats, onset: Floats, yields: NDArray[np.bool_]
) -> tuple[str, dict[str, float]]:
    """What corners carry in words, and their figures: [%] of the load and period, [N m].

    ``load``, ``part`` (shares), ``onset`` [N m] and ``yields`` of pinion and wheel; empty words
    where no corner carries.
    """
    words, figures, notes = list[str](), dict[str, float](), dict[str, None]()
    for gear, place in (("wheel", 1), ("pinion", 0)):
        if not load[place] > 0.0:
            continue
        carries, whole, period = ("", "", "") if words else (" tip corner carries", *_WHOLE)
        begins = f"from {{{gear}_onset:.3g N m}} on" if onset[place] > 0.0 else "at any load"
        words.append(
            f"{ENDS[gear]}, the {gear}'s{carries} up to {{{gear}_load:.0f %}}{whole} during "
            f"{{{gear}_part:.1f %}}{period}, {begins}"
        )
        figures |= {f"{gear}_load": 100.0 * load[place], f"{gear}_part": 100.0 * part[place]}
        figures |= {f"{gear}_onset": onset[place]} if onset[place] > 0.0 else {}
        if getattr(case.pair, gear).tip_rounding == 0.0:
            notes["no pressure is known on a sharp edge"] = None
        elif yields[place]:
            notes["a rounded edge is pressed above what any steel bears and will settle"] = None
    return "; ".join([*words, *notes]), {name: float(value) for name, value in figures.items()}


_WHOLE = (" of the load", " of the mesh period")
