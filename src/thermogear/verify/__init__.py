"""Independent checks of the models by finite elements (extra ``[fe]``).

Meshes, condensation and contact are of this floor alone; of the models it takes the drawing of
a gear, and the figures it checks. scikit-fem is imported when the first mesh is made.
"""

from thermogear.gears.tooth_mesh import Density
from thermogear.verify.checks import (
    GrowthCheck,
    StiffnessCheck,
    check_growth,
    check_stiffness,
    inner_phases,
)
from thermogear.verify.growth import finite_flank_growth
from thermogear.verify.stiffness import FinitePair, pair_stiffness

__all__ = [
    "Density",
    "FinitePair",
    "GrowthCheck",
    "StiffnessCheck",
    "check_growth",
    "check_stiffness",
    "finite_flank_growth",
    "inner_phases",
    "pair_stiffness",
]
