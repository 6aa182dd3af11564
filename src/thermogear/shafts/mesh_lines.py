"""The mesh seen from two shafts: both flanks, each on its own line of action.

With c = (cos phi, sin phi) from driver to driven centre, t = (-sin phi, cos phi), working pressure
angle alpha' and sigma = +1 where the driver turns about +z:

- n = sigma cos alpha' t + sin alpha' c, the drive flank's force on the driven gear,
- n_b = -sigma cos alpha' t + sin alpha' c, the back flank's.

Penetration [m] of the flanks without backlash: delta_d = n.(u1 - u2) + sigma (r_b1 th1 + r_b2 th2),
delta_b = n_b.(u1 - u2) - sigma (r_b1 th1 + r_b2 th2). The driven angle th2 counts about +z as
well.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.gears.geometry import involute


@dataclass(frozen=True, kw_only=True)
class MeshFrame:
    """Where the mesh lies in the frame of the shafts.

    ``base_radii`` r_b1, r_b2 [m], ``teeth`` z1, z2, ``pressure_angle`` alpha' [rad] at the working
    pitch circles, ``centre_line`` phi [rad] from the x axis to the line from the pinion's to the
    wheel's centre, ``sense`` sigma +1 or -1 of the pinion about +z.
    """

    base_radii: tuple[float, float]
    teeth: tuple[int, int]
    pressure_angle: float
    centre_line: float = 0.0
    sense: int = 1

    def __post_init__(self) -> None:
        if self.sense not in (-1, 1):
            raise InputError("sense", self.sense, allowed="+1 | -1")

    @property
    def ratio(self) -> float:
        """Speed of the wheel over that of the pinion, both about +z: -z1/z2."""
        return -self.teeth[0] / self.teeth[1]

    @property
    def centre_distance(self) -> float:
        """a' = (r_b1 + r_b2)/cos alpha' [m]."""
        return float(sum(self.base_radii) / np.cos(self.pressure_angle))

    @property
    def along(self) -> Floats:
        """c, from the pinion's centre to the wheel's."""
        return np.array([np.cos(self.centre_line), np.sin(self.centre_line)])

    @property
    def across(self) -> Floats:
        """t, a quarter turn about +z on from c."""
        return np.array([-np.sin(self.centre_line), np.cos(self.centre_line)])

    @property
    def normals(self) -> tuple[Floats, Floats]:
        """n of the drive flank, n_b of the back flank: forces on the wheel."""
        side = self.sense * np.cos(self.pressure_angle) * self.across
        out = np.sin(self.pressure_angle) * self.along
        return side + out, -side + out

    @property
    def columns(self) -> tuple[Floats, Floats]:
        """Gradients of delta_d and delta_b over (x1, y1, th1, x2, y2, th2): (6,) each."""
        r1, r2 = self.base_radii
        drive, back = (
            np.array([*normal, turn * r1, *-normal, turn * r2])
            for normal, turn in zip(self.normals, (self.sense, -self.sense), strict=True)
        )
        return drive, back

    @property
    def friction_columns(self) -> tuple[Floats, Floats]:
        """Generalised friction force over (x1, y1, th1, x2, y2, th2): at pitch, and per metre.

        For a pair at s [m] from the pitch point (+ in recess) under the drive flank's force F_d
        the friction is mu sign F_d (first + s second); sign +1 in recess. Unit of the moment
        rows: m, and 1 in the second. The pinion gets -mu F_d sign m with m = sigma e_z x n, the
        wheel the opposite.
        """
        n = self.normals[0]
        m = self.sense * np.array([-n[1], n[0]])
        arms = np.tan(self.pressure_angle) * np.asarray(self.base_radii)
        pitch = np.array([*-m, -self.sense * arms[0], *m, -self.sense * arms[1]])
        return pitch, np.array([0.0, 0.0, -self.sense, 0.0, 0.0, self.sense])

    def gaps(self, shift: ArrayLike, angles: ArrayLike = (0.0, 0.0)) -> Floats:
        """Exact (delta_d, delta_b) [m] where the wheel's centre moves by ``shift`` (..., 2) [m].

        ``angles`` (th1, th2) [rad]. With a' the actual centre distance, cos alpha'' =
        (r_b1 + r_b2)/a' and dphi the turn of the centre line: delta_d = sigma [r_b1 th1 + r_b2 th2
        - (r_b1 + r_b2) dphi] - (r_b1 + r_b2)(inv alpha'' - inv alpha'); delta_b with the first
        bracket negative. (..., 2). Nan where the base circles are closer than their line of
        action.
        """
        moved = np.asarray(shift, dtype=float)
        turned = np.asarray(angles, dtype=float)
        a, total = self.centre_distance, sum(self.base_radii)
        out, side = moved @ self.along, moved @ self.across
        distance = np.hypot(a + out, side)
        turn = np.arctan2(side, a + out)
        with np.errstate(invalid="ignore"):
            opened = total * (involute(np.arccos(total / distance)) - involute(self.pressure_angle))
        twist = self.sense * (turned @ np.asarray(self.base_radii) - total * turn)
        return np.asarray(np.stack(np.broadcast_arrays(twist - opened, -twist - opened), axis=-1))
