"""Independent checks of the models by finite elements (extra ``[fe]``).

Meshes, condensation and contact are of this floor alone; of the models it takes the drawing of
a gear, and the figures it checks. scikit-fem is imported when the first mesh is made.
"""

from thermogear.gears.tooth_mesh import Density
from thermogear.verify.checks import StiffnessCheck, check_stiffness, inner_phases
from thermogear.verify.stiffness import FinitePair, pair_stiffness

__all__ = [
    "Density",
    "FinitePair",
    "StiffnessCheck",
    "check_stiffness",
    "inner_phases",
    "pair_stiffness",
]
