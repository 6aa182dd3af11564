"""The elastic side of a mesh cycle: hot moduli in, stiffness of pairs and mesh and shares out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.gears.contact import reduced_modulus
from thermogear.gears.geometry import GearPair
from thermogear.gears.sharing import equal_share, stiffness_share
from thermogear.gears.stiffness import Moduli, mesh_stiffness, pair_compliances, pair_stiffness
from thermogear.mesh.thermal import HotPair

Floats = NDArray[np.float64]

STARTS = {"textbook-root-circle": "root-circle", "textbook-30-degree": "30-degree"}
"""Where the beam integrals begin, by the model's choice of stiffness."""


@dataclass(frozen=True, eq=False)
class ElasticPair:
    """The textbook springs of a pair at its temperatures; results are (count, positions)."""

    pair: GearPair
    start: str
    sharing: str
    pinion: Moduli
    wheel: Moduli

    @classmethod
    def of(cls, hot: HotPair) -> ElasticPair:
        """The springs that the model of ``hot`` chooses."""
        first, second = (
            Moduli(tooth[:, None], body[:, None])
            for tooth, body in (hot.moduli(gear) for gear in (hot.pair.pinion, hot.pair.wheel))
        )
        model = hot.model
        return cls(hot.pair, STARTS[model.stiffness], model.sharing, first, second)

    @property
    def count(self) -> int:
        """Number of operating points."""
        return int(np.shape(self.pinion.tooth)[0])

    @property
    def contact_modulus(self) -> Floats:
        """E* [Pa], (count, 1)."""
        return reduced_modulus(
            self.pinion.tooth,
            self.pair.pinion.material.poisson_ratio,
            self.wheel.tooth,
            self.pair.wheel.material.poisson_ratio,
        )

    def pair_stiffness(self, s: Floats) -> Floats:
        """Stiffness of one tooth pair at ``s`` [m], [N/m]."""
        return pair_stiffness(self.pair, s, self.start, self.pinion, self.wheel)

    def mesh_stiffness(self, phase: Floats) -> Floats:
        """Sum over the pairs in contact at mesh ``phase`` [N/m]."""
        return mesh_stiffness(self.pair, phase[None, :], self.start, self.pinion, self.wheel)

    def share(self, s: Floats) -> Floats:
        """Share of the load on the pair at ``s`` [m]."""
        if self.sharing == "equal":
            return np.broadcast_to(equal_share(self.pair, s), (self.count, s.size))
        return stiffness_share(self.pair, s[None, :], self.start, self.pinion, self.wheel)

    def parts(self, s: Floats) -> dict[str, Floats]:
        """Every spring of one tooth pair at ``s`` [N/m], by its stored name."""
        found = pair_compliances(self.pair, s, self.start, self.pinion, self.wheel)
        compliances = {"hertz_stiffness": found.contact}
        for name, gear in (("pinion", found.pinion), ("wheel", found.wheel)):
            compliances[f"{name}_bending_stiffness"] = gear.tooth.bending
            compliances[f"{name}_shear_stiffness"] = gear.tooth.shear
            compliances[f"{name}_axial_stiffness"] = gear.tooth.axial
            compliances[f"{name}_body_stiffness"] = gear.foundation
        shape = (self.count, s.size)
        return {name: 1.0 / np.broadcast_to(c, shape) for name, c in compliances.items()}
