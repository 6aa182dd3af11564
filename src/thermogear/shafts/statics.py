"""The static equilibrium of a drive train under torque and weight, every contact as it is.

K q + sum over bearings + mesh forces = f: flanks with backlash on their own lines of action,
bearings with clearance and power laws. All contacts pull with a convex potential, so that there is
one equilibrium; what nothing holds - an idle journal within its clearance - stays where it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.shafts.assembly import Assembly
from thermogear.shafts.bearings.laws import BearingLaw
from thermogear.shafts.linear import LinearTrain
from thermogear.shafts.train import SHAFTS

TOLERANCE = 1e-12
"""Of the residual over the load."""
MOST_STEPS = 400


@dataclass(frozen=True, eq=False, kw_only=True)
class Equilibrium:
    """A drive train at rest under load (SI); directions in the frame of the shafts.

    ``displacement`` q (n,), the rigid rotation left out. ``mesh_force``, ``back_force`` [N] and
    penetrations ``drive``, ``back`` [m] of both flanks, backlash not subtracted. Per bearing:
    ``bearing_force`` (count, 2) on the housing [N], ``bearing_displacement`` of the journal against
    its ring (count, 2) [m], ``bearing_stiffness`` tangent (count, 2, 2) [N/m]. ``mesh_stiffness``
    [N/m] it holds for.
    """

    assembly: Assembly
    displacement: Floats
    mesh_stiffness: float
    mesh_force: float
    back_force: float
    drive: float
    back: float
    bearing_force: Floats
    bearing_displacement: Floats
    bearing_stiffness: Floats
    steps: int

    def centre(self, shaft: str) -> Floats:
        """Displacement (x, y) [m] of a gear's centre."""
        return np.asarray(self.assembly.at_gear(shaft)[:, :2].T @ self.displacement)

    @property
    def shift(self) -> Floats:
        """(x, y) [m] of the wheel's centre against the pinion's."""
        return self.centre("wheel") - self.centre("pinion")

    @property
    def centre_distance_growth(self) -> float:
        """c.(u2 - u1) [m], growth along the line of centres, first order."""
        return float(self.assembly.frame.along @ self.shift)

    @property
    def flank_openings(self) -> tuple[float, float]:
        """How far the shift alone opens the drive and the back flank [m], exact."""
        drive, back = -self.assembly.frame.gaps(self.shift)
        return float(drive), float(back)

    @property
    def tilts(self) -> dict[str, Floats]:
        """Slopes (x', y') = (ty, -tx) [rad] of each shaft at its gear."""
        found = {}
        for shaft in SHAFTS:
            tx, ty = self.assembly.at_gear(shaft)[:, 2:4].T @ self.displacement
            found[shaft] = np.array([ty, -tx])
        return found

    @property
    def misalignment(self) -> float:
        """n.(slope1 - slope2) [rad]: how fast the drive flanks part across the face width."""
        both = self.tilts
        return float(self.assembly.frame.normals[0] @ (both["pinion"] - both["wheel"]))

    def linear(self, mesh: float | None = None) -> LinearTrain:
        """The train linear about this equilibrium; ``mesh`` [N/m] in place of its stiffness.

        A back flank that carries, as of a jammed pair, is a spring as stiff as the drive flank.
        """
        k = self.mesh_stiffness if mesh is None else mesh
        return LinearTrain(
            assembly=self.assembly,
            mesh=k,
            bearings=self.bearing_stiffness,
            back=k if self.back_force > 0.0 else 0.0,
        )


def equilibrium(
    assembly: Assembly,
    torque: float,
    *,
    mesh: float,
    half_backlash: float,
    back: float | None = None,
    start: ArrayLike | None = None,
) -> Equilibrium:
    """The equilibrium under ``torque`` [N m] >= 0 of the pinion.

    ``mesh`` k of the drive flank and ``back`` of the back flank [N/m] (left out: alike),
    ``half_backlash`` b' [m]: the drive flank bears k <delta_d - b'>+. ``start`` (n,), a first q.
    Newton's rule with a Levenberg shift and a line search on the potential's slope. Raises
    InputError where nothing holds the shafts, ConvergenceError where the steps do not settle.
    """
    if not (np.isfinite(torque) and torque >= 0.0):
        raise InputError("torque", f"{torque} N m", allowed=">= 0 N m")
    problem = _Problem(assembly, torque, mesh, mesh if back is None else back, half_backlash)
    p = problem.beginning() if start is None else problem.basis.T @ np.asarray(start, float)
    force = problem.residual(p)
    shift = 0.0
    for step in range(MOST_STEPS):
        allowed = problem.allowed(p)
        if np.abs(force).max() <= allowed:
            return problem.found(p, step)
        tangent = problem.tangent(p)
        while True:
            move = _solved(tangent, force, shift * problem.spring)
            slope = force @ move
            if move.size and np.all(np.isfinite(move)) and slope < 0.0:
                break
            shift = max(10.0 * shift, 1e-12)
            if shift > 1e12:
                raise ConvergenceError(
                    "static equilibrium: no direction lowers the residual; the stiffness of the "
                    "mesh or of a bearing is no number"
                )
        share = 1.0
        for _ in range(60):
            after = problem.residual(p + share * move)
            if after @ move <= 0.5 * abs(slope):
                break
            share *= 0.5
        p, force = p + share * move, after
        shift = 0.0 if share == 1.0 and shift < 1e-11 else 0.1 * shift if share == 1.0 else shift
    raise ConvergenceError(
        f"static equilibrium: residual {np.abs(force).max():.3g} N after {MOST_STEPS} steps, "
        f"allowed {allowed:.3g} N"
    )


def _solved(tangent: Floats, force: Floats, shift: Floats) -> Floats:
    try:
        return np.asarray(-np.linalg.solve(tangent + np.diag(shift), force))
    except np.linalg.LinAlgError:
        return np.full(force.size, np.nan)


class _Problem:
    """Residual and tangent of one equilibrium in the motions besides the rigid rotation."""

    def __init__(
        self, assembly: Assembly, torque: float, mesh: float, back: float, half_backlash: float
    ) -> None:
        self.assembly, self.torque = assembly, torque
        self.mesh, self.back, self.half_backlash = mesh, back, half_backlash
        reference = np.array([_closed(p.bearing.law) for p in assembly.bearings])
        closed = LinearTrain(assembly=assembly, mesh=mesh, bearings=reference)
        self.basis, self.whole = closed.basis, closed.held[1]
        self.spring = np.diag(self.whole)
        self.stiff = self.basis.T @ assembly.stiffness @ self.basis
        self.force = self.basis.T @ (assembly.end_torques(torque) + assembly.weight)
        self.lines = self.basis.T @ np.stack([assembly.drive, assembly.back], axis=1)
        self.across = [self.basis.T @ p.directions for p in assembly.bearings]
        self.load = max(
            torque / assembly.frame.base_radii[0], float(np.abs(assembly.weight).sum()), 1e-9
        )

    def beginning(self) -> Floats:
        """Where the drive flanks just touch, the shafts unloaded."""
        pull = np.linalg.solve(self.whole, self.lines[:, 0])
        return np.asarray(pull * self.half_backlash / (self.lines[:, 0] @ pull))

    def allowed(self, p: Floats) -> float:
        """The residual that ends the steps [N]: a share of the load, or what rounding leaves."""
        rounding = float((np.abs(self.whole) @ np.abs(p)).max()) * np.finfo(float).eps
        return TOLERANCE * self.load + 4.0 * rounding

    def residual(self, p: Floats) -> Floats:
        found = self.stiff @ p - self.force
        for place, across in zip(self.assembly.bearings, self.across, strict=True):
            found = found - across @ place.bearing.law.force(across.T @ p)
        deep = np.maximum(self.lines.T @ p - self.half_backlash, 0.0)
        return np.asarray(found + self.lines @ (deep * [self.mesh, self.back]))

    def tangent(self, p: Floats) -> Floats:
        found = self.stiff.copy()
        for place, across in zip(self.assembly.bearings, self.across, strict=True):
            found += across @ place.bearing.law.stiffness(across.T @ p) @ across.T
        closed = self.lines.T @ p > self.half_backlash
        return np.asarray(found + self.lines * (closed * [self.mesh, self.back]) @ self.lines.T)

    def found(self, p: Floats, steps: int) -> Equilibrium:
        own = self.assembly
        q = self.basis @ p
        drive, back = float(own.drive @ q), float(own.back @ q)
        moved = np.array([place.directions.T @ q for place in own.bearings]).reshape(-1, 2)
        laws = [place.bearing.law for place in own.bearings]
        return Equilibrium(
            assembly=own,
            displacement=q,
            mesh_stiffness=self.mesh,
            mesh_force=self.mesh * max(drive - self.half_backlash, 0.0),
            back_force=self.back * max(back - self.half_backlash, 0.0),
            drive=drive,
            back=back,
            bearing_force=np.array(
                [-law.force(u) for law, u in zip(laws, moved, strict=True)]
            ).reshape(-1, 2),
            bearing_displacement=moved,
            bearing_stiffness=np.array(
                [law.stiffness(u) for law, u in zip(laws, moved, strict=True)]
            ).reshape(-1, 2, 2),
            steps=steps,
        )


TYPICAL = 20e-6
"""Displacement [m] beyond the clearance at which a closed bearing's stiffness is looked at."""


def _closed(law: BearingLaw) -> Floats:
    """A stiffness (2, 2) [N/m] of a bearing that is closed in every direction."""
    deep = max(getattr(law, "clearance", 0.0), 0.0) + TYPICAL
    sides = deep * np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]])
    return np.asarray(law.stiffness(sides).mean(axis=0))
