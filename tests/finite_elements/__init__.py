"""Finite elements that the tests hold the models against.

Meshes, condensation and contact are of this package alone; of the models it takes the drawing of
a gear, and the figures it checks.
"""

from finite_elements.checks import StiffnessCheck, check_stiffness, inner_phases
from finite_elements.stiffness import FinitePair, pair_stiffness
from thermogear.gears.tooth_mesh import Density

__all__ = [
    "Density",
    "FinitePair",
    "StiffnessCheck",
    "check_stiffness",
    "inner_phases",
    "pair_stiffness",
]
