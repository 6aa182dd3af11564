"""Stress along the loaded fillet of a tooth, from finite elements of one sector of the gear.

The sector is that of :mod:`thermogear.gears.tooth_table`, with smaller elements along the fillet
and its two grids meeting at the fillet's 10-degree tangent: where they meet the stress is a few
percent off, and at 30 degrees it would be near its greatest. On an edge without load the strain
along it says the whole stress, sigma = E e_t, with E/(1 - nu^2) in plane strain. The modulus does
not matter, nor the temperature but by the load's shares; tooth and body are of one modulus here.
Checked by ``tests/gears/test_root_stress.py``: a hole in a plate, convergence, another assembly,
and figures of finite elements not written here.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.gears.geometry import Gear
from thermogear.gears.loaded import LoadedMesh
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density, Profile
from thermogear.gears.tooth_table import MATES, Flank, Sector, Shape

MESH = Density(growth=1.8, sides=9, below=4, inward=1.8, joint=float(np.radians(10.0)))
"""The greatest stress is within 0.7 % of that of elements half as large, on eleven gears of 9 to
120 teeth, 14.5 to 28 degrees, shifts of -0.5 to 0.8 and rims from 0.8 modules on. Sharp fillets of
shifted teeth lose more: 1 % at a rack's tip radius of 0.1 modules, 3 % at 0.05."""
ROWS, COLUMNS = 8, 5
"""Elements along the flank and across the tooth."""
STATIONS = 9
"""Chebyshev points of the loads along a flank."""


@dataclass(frozen=True, eq=False, kw_only=True)
class RootTable(Flank):
    """Stress along the fillet of a gear's loaded flanks, times b m/F, by the load's place.

    ``slope`` (point,): angle [rad] of the fillet's tangent to the tooth's axis, from the fillet's
    10-degree tangent down to the middle of the gap; ``series`` (degree, lag, point): Chebyshev
    series in the load's place, of the tooth ``lag - MATES`` pitches ahead of the loaded one,
    towards the loaded flank.
    """

    slope: Floats
    series: Floats

    def stress(self, t: ArrayLike, lag: int = 0) -> Floats:
        """sigma b m/F [-] along the fillet under a load at t = tan(alpha_k), (*shape of t, point).

        Positive where pulled; of the tooth ``lag`` pitches ahead of the loaded one, at most
        :data:`~thermogear.gears.tooth_table.MATES` to either side.

        >>> gear = Gear(25, 5e-3)
        >>> f"{root_table(gear).stress(np.tan(np.radians(20))).max():.2f}"
        '2.41'
        """
        values = chebyshev.chebval(self.place(t), self.series[:, lag + MATES])
        return np.moveaxis(np.asarray(values), 0, -1)


def root_table(gear: Gear, plane: str = "stress") -> RootTable:
    """The stresses of ``gear``, remembered by its shape in modules and its Poisson's ratio.

    plane: "stress" or "strain", as of :func:`~thermogear.gears.tooth_table.tooth_table`.

    >>> root_table(Gear(25, 5e-3)).slope.size
    18
    """
    return _table(Shape.of(gear, plane))


@lru_cache(maxsize=64)
def _table(shape: Shape) -> RootTable:
    return table_of(Sector.of(shape.gear, shape.poisson, MESH, rows=ROWS, columns=COLUMNS))


def table_of(sector: Sector) -> RootTable:
    """The stresses of one mesh of a gear.

    >>> coarse = Sector.of(Gear(25, 5e-3), 0.3)
    >>> f"{table_of(coarse).stress(np.tan(np.radians(20))).max():.2f}"
    '2.38'
    """
    gear, m = sector.gear, sector.gear.module
    arcs, widths = sector.stations(STATIONS)
    strain, along = sector.patch.edge_strains(sector.foot.fillet)
    stress = m * sector.solved(sector.loads(arcs=arcs, widths=widths)).felt(strain)
    low, high = Profile(gear).ends
    place = (2.0 * arcs - low - high) / (high - low)
    fit = np.linalg.inv(chebyshev.chebvander(place, STATIONS - 1))
    return RootTable(
        ends=(low / m, high / m),
        base=gear.base_radius / m,
        slope=np.arctan2(along[:, 0], -along[:, 1]),
        series=np.einsum("ds,kps->dkp", fit, stress),
    )


BLOCK = 10_000
"""Positions looked at together: some 10 MB."""
FLAT = 0.99
"""Part of the greatest stress that is reached where it is said to be: a maximum is flat, and which
point has it hangs on the elements."""


class RootStress(NamedTuple):
    """Greatest stress [Pa] in the fillets of a gear, and the angle ``slope`` [rad] of the fillet's
    tangent to the tooth's axis in the middle of where it is within 1 %.
    """

    stress: Floats
    slope: Floats


def _middle(stress: Floats, slope: Floats) -> float:
    """Middle [rad] of where a course along the fillet is within 1 % of its greatest."""
    fine = np.linspace(slope[0], slope[-1], 801)
    near = fine[np.interp(fine, slope, stress) >= FLAT * stress.max()]
    return float(0.5 * (near[0] + near[-1])) if near.size else float(slope[stress.argmax()])


def root_stress(
    pair: GearPair, mesh: LoadedMesh, plane: str = "stress"
) -> tuple[RootStress, RootStress]:
    """Greatest stress in the fillets of pinion and wheel under a loaded contact, shape ``lead``.

    sigma_j = sum_k S_(j-k)(t_k) F_k/(b m) over the tooth pairs, greatest over the mesh positions,
    the teeth j and along their fillets; b the pair's common face width, evenly loaded. A force on
    a tip corner counts as one along the involute's normal there. Static: no dynamic factor. nan
    where the contact did not settle at every position.

    >>> from thermogear.gears.loaded import solve_mesh
    >>> pair = GearPair(Gear(25, 5e-3), Gear(75, 5e-3))
    >>> pinion, wheel = root_stress(pair, solve_mesh(pair, 5e3, np.arange(20) / 20))
    >>> f"{1e-6 * pinion.stress:.0f} MPa, {1e-6 * wheel.stress:.0f} MPa"
    '96 MPa, 89 MPa'
    """
    (once, place), pairs = mesh.points.fractions, range(mesh.force.shape[-1])
    point = once.point
    load = mesh.force / (pair.face_width * pair.pinion.module)
    found = []
    # the pinion's load points against its rotation, the wheel's along it
    for gear, string, sign in ((pair.pinion, point.pinion, 1), (pair.wheel, point.wheel, -1)):
        table, t = root_table(gear, plane), string / gear.base_radius
        unit = {
            (j, k): table.stress(t[:, k], sign * (j - k))
            for j in pairs
            for k in pairs
            if abs(j - k) <= MATES
        }
        course = np.full((*load.shape[:-2], table.slope.size), -np.inf)
        for start in range(0, len(place), BLOCK):
            here = slice(start, start + BLOCK)
            felt = [
                sum(
                    load[..., here, k, None] * unit[j, k][place[here]]
                    for k in pairs
                    if (j, k) in unit
                )
                for j in pairs
            ]
            every = np.stack(felt, axis=-2).reshape(*load.shape[:-2], -1, table.slope.size)
            worst = every.max(axis=-1).argmax(axis=-1)[..., None, None]
            there = np.take_along_axis(every, worst, axis=-2)[..., 0, :]
            greater = ~(there.max(axis=-1, keepdims=True) <= course.max(axis=-1, keepdims=True))
            course = np.where(greater, there, course)
        slope = np.apply_along_axis(_middle, -1, course, table.slope)
        stress = np.where(mesh.settled.all(axis=-1), course.max(axis=-1), np.nan)
        found.append(RootStress(stress, slope))
    return found[0], found[1]
