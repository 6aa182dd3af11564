"""A Timoshenko beam element: one bending plane, torsion, the gyroscopic coupling of both planes.

Exact static shape functions with Phi = 12 E I/(kappa G A L^2); consistent translatory and rotary
mass. One plane has (w, w' ) at both ends; it serves (x, ty) as it is, since x' = ty, and (y, tx)
with the signs S = diag(1, -1, 1, -1), since y' = -tx.

Sources: Przemieniecki, Theory of Matrix Structural Analysis (1968), for the matrices; Cowper, J.
Appl. Mech. 33 (1966) 335, for the shear coefficient; checked against closed forms of beams and
against another package's matrices.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats

SIGNS = np.array([1.0, -1.0, 1.0, -1.0])
"""S: the plane (x, ty) turned into (y, tx)."""
NODE = ("x", "y", "tx", "ty", "tz")
"""Coordinates of a node: displacements [m], angles [rad]."""
PLANE_X = np.array([0, 3, 5, 8])
PLANE_Y = np.array([1, 2, 6, 7])
TWIST = np.array([4, 9])


@dataclass(frozen=True, eq=False, kw_only=True)
class BeamElements:
    """Elements of a shaft (SI), each field an array ``(elements,)``."""

    length: Floats
    outer_diameter: Floats
    inner_diameter: Floats
    youngs_modulus: Floats
    poisson_ratio: Floats
    density: Floats

    @property
    def area(self) -> Floats:
        """A [m^2]."""
        return np.asarray(0.25 * np.pi * (self.outer_diameter**2 - self.inner_diameter**2))

    @property
    def second_moment(self) -> Floats:
        """I about a diameter [m^4]; the polar one is 2 I."""
        return np.asarray(np.pi / 64.0 * (self.outer_diameter**4 - self.inner_diameter**4))

    @property
    def shear_modulus(self) -> Floats:
        """G = E/(2 (1 + nu)) [Pa]."""
        return np.asarray(0.5 * self.youngs_modulus / (1.0 + self.poisson_ratio))

    @property
    def shear_ratio(self) -> Floats:
        """Phi = 12 E I/(kappa G A L^2) [-]: 0 for a slender beam."""
        kappa = shear_coefficient(
            self.inner_diameter / self.outer_diameter, poisson_ratio=self.poisson_ratio
        )
        rigid = kappa * self.shear_modulus * self.area * self.length**2
        return np.asarray(12.0 * self.youngs_modulus * self.second_moment / rigid)

    def matrices(self) -> tuple[Floats, Floats, Floats]:
        """(M, K, G) of every element, (elements, 10, 10) over :data:`NODE` at both ends.

        M in kg, kg m, kg m^2; K in N/m, N, N m; G per rad/s of the shaft's speed about +z: the
        equation is M q'' + Omega G q' + K q = f.
        """
        across, turning = self._plane_mass()
        bent = self._plane_stiffness()
        count = self.length.size
        mass, stiff, gyro = (np.zeros((count, 10, 10)) for _ in range(3))
        flip = SIGNS[:, None] * SIGNS
        for plane, sign in ((PLANE_X, np.ones((4, 4))), (PLANE_Y, flip)):
            at = np.ix_(np.arange(count), plane, plane)
            mass[at] = (across + turning) * sign
            stiff[at] = bent * sign
        gyro[np.ix_(np.arange(count), PLANE_X, PLANE_Y)] = 2.0 * turning * SIGNS
        gyro[np.ix_(np.arange(count), PLANE_Y, PLANE_X)] = -2.0 * turning * SIGNS[:, None]
        polar = 2.0 * self.second_moment
        twist = np.ix_(np.arange(count), TWIST, TWIST)
        lumps = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6.0
        mass[twist] = (self.density * polar * self.length)[:, None, None] * lumps
        spring = np.array([[1.0, -1.0], [-1.0, 1.0]])
        stiff[twist] = (self.shear_modulus * polar / self.length)[:, None, None] * spring
        return mass, stiff, gyro

    def _plane_stiffness(self) -> Floats:
        phi, size = self.shear_ratio, self.length
        factor = self.youngs_modulus * self.second_moment / ((1.0 + phi) * size**3)
        return factor[:, None, None] * _plane(size, 12.0, 6.0, -12.0, 6.0, 4.0 + phi, 2.0 - phi)

    def _plane_mass(self) -> tuple[Floats, Floats]:
        """(translatory, rotary) mass of one plane."""
        phi, size = self.shear_ratio, self.length
        whole = (1.0 + phi) ** 2
        across = self.density * self.area * size / whole
        moving = _plane(
            size,
            13 / 35 + 7 * phi / 10 + phi**2 / 3,
            11 / 210 + 11 * phi / 120 + phi**2 / 24,
            9 / 70 + 3 * phi / 10 + phi**2 / 6,
            -(13 / 420 + 3 * phi / 40 + phi**2 / 24),
            1 / 105 + phi / 60 + phi**2 / 120,
            -(1 / 140 + phi / 60 + phi**2 / 120),
        )
        turning = _plane(
            size,
            6 / 5,
            1 / 10 - phi / 2,
            -6 / 5,
            1 / 10 - phi / 2,
            2 / 15 + phi / 6 + phi**2 / 3,
            -(1 / 30 + phi / 6 - phi**2 / 6),
        )
        rotary = self.density * self.second_moment / (size * whole)
        return across[:, None, None] * moving, rotary[:, None, None] * turning


def shear_coefficient(diameter_ratio: ArrayLike, *, poisson_ratio: ArrayLike) -> Floats:
    """Cowper's kappa of a hollow round section [-]; ``diameter_ratio`` inner over outer.

    kappa = 6 (1 + nu)(1 + r^2)^2/((7 + 6 nu)(1 + r^2)^2 + (20 + 12 nu) r^2).

    >>> f"{shear_coefficient(0.0, poisson_ratio=0.3):.4f}"
    '0.8864'
    """
    r, nu = np.asarray(diameter_ratio, dtype=float), np.asarray(poisson_ratio, dtype=float)
    ring = (1.0 + r**2) ** 2
    return np.asarray(
        6.0 * (1.0 + nu) * ring / ((7.0 + 6.0 * nu) * ring + (20.0 + 12.0 * nu) * r**2)
    )


def _plane(
    size: Floats,
    near: float | Floats,
    near_turn: float | Floats,
    far: float | Floats,
    far_turn: float | Floats,
    turn: float | Floats,
    turns: float | Floats,
) -> Floats:
    """A symmetric 4 x 4 over (w1, w1', w2, w2'), the second end the mirrored first.

    ``far_turn`` couples w1 with w2'.
    """
    found = np.zeros((size.size, 4, 4))
    found[:, 0, 0] = found[:, 2, 2] = near
    found[:, 0, 1] = near_turn * size
    found[:, 2, 3] = -near_turn * size
    found[:, 0, 2] = far
    found[:, 0, 3] = far_turn * size
    found[:, 1, 2] = -far_turn * size
    found[:, 1, 1] = found[:, 3, 3] = turn * size**2
    found[:, 1, 3] = turns * size**2
    lower = np.tril_indices(4, -1)
    found[:, lower[0], lower[1]] = found[:, lower[1], lower[0]]
    return found
