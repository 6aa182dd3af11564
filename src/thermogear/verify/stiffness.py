"""Mesh stiffness and load shares of a pair from finite elements of both whole gears.

Contact is treated on the mesh itself: each flank carries the Hertzian pressure of its own
load, resolved by elements of a third of the half width, and deflects by the mean over that
pressure. With the curvature of the flanks the work of the pressure gives the approach

    delta_j = <u_1 + u_2>_p + <x^2>_p/(2 rho*),   <x^2>_p = a^2/4  for Hertz's pressure,

which is exact for the contact as long as a is small against rho*. Body and tooth stand in
plane stress. A line contact is far wider than deep, so that the material around it stands in
plane strain, by default as far as the tooth's axis: the state that Weber and Banaschek's law
supposes. ``near="stress"`` leaves that out; it makes steel pairs 1.5 .. 2.5 % softer.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.gears.contact import hertz_half_width
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth_mesh import Density
from thermogear.verify.compliance import ElasticGear, LoadedTooth

_ROUNDS = 30
_SETTLED = 1e-8


@dataclass(frozen=True, eq=False, kw_only=True)
class FinitePair:
    """Secant stiffness [N/m] (position,) and shares (position, pair), pair 0 the last to enter.

    ``phase`` in periods from A; shares of pairs off the path are 0.
    """

    phase: Floats
    secant: Floats
    share: Floats


def _contact_modulus(pair: GearPair, near: str) -> float:
    """E* [Pa] of the contact in its plane state."""
    materials = (pair.pinion.material, pair.wheel.material)
    held = 1.0 if near == "strain" else 0.0
    return 1.0 / sum((1.0 - held * m.poisson_ratio**2) / m.youngs_modulus for m in materials)


def gear_compliance(
    gear: Gear,
    t: ArrayLike,
    half_width: float,
    density: Density | None = None,
    near: str = "strain",
) -> Floats:
    """Deflection [m/N] of one tooth along its flank's normal under its own Hertzian load.

    Tooth, body with its bore held, and the local indentation, plane stress. t: tan(alpha_k) of
    the contacts, one axis; half_width: a [m] of the pressure; density: of the mesh; near:
    see :data:`~thermogear.verify.compliance.NEAR`. The
    deflection is the mean over the contact, weighted by the pressure. Raises InputError for a
    contact nearer than a to an end of the flank, and when scikit-fem is missing.
    """
    solid = ElasticGear(gear, 1, half_width, density or Density(), near)
    values = [
        solid.compliance([solid.tooth(float(at))], [half_width])[0, 0] for at in np.atleast_1d(t)
    ]
    return np.array(values) / (gear.material.youngs_modulus * gear.face_width)


def pair_stiffness(
    pair: GearPair,
    normal_force: float,
    phase: ArrayLike,
    density: Density | None = None,
    near: str = "strain",
) -> FinitePair:
    """Secant stiffness and load shares at ``phase`` (periods from A) by finite elements.

    Both gears whole, plane stress, bores held; frictionless contact on the path only (no tip
    corners), no deviations. normal_force: F_n [N] > 0; density: of the meshes; near: plane
    state around the contacts. Raises
    InputError for a load that is not positive, a position whose contact would overhang the end
    of a flank, and when scikit-fem is missing.
    """
    if not (np.isfinite(normal_force) and normal_force > 0.0):
        raise InputError("normal_force", f"{normal_force} N", allowed="> 0, finite")
    phi = np.atleast_1d(np.asarray(phase, dtype=float))
    if not np.all((phi >= 0.0) & (phi < 1.0)):
        raise InputError("phase", phi, allowed="0 <= phase < 1")
    mesh = density or Density()
    most = int(np.ceil(pair.contact_ratio - 1e-12))
    modulus, width = _contact_modulus(pair, near), pair.face_width
    pitch = pair.path.c
    usual = float(
        hertz_half_width(
            0.5 * normal_force / width, pitch * (1.0 - pitch / pair.line_of_action), modulus
        )
    )
    solids = [ElasticGear(gear, most, usual, mesh, near) for gear in (pair.pinion, pair.wheel)]
    secant = np.empty(phi.size)
    share = np.zeros((phi.size, most))
    for i, at in enumerate(phi):
        s = pair.path.a + (at + np.arange(most)) * pair.base_pitch
        s = s[s <= pair.path.e]
        position = _Position(pair, solids, s, modulus)
        force, deflection = position.solve(normal_force)
        secant[i] = normal_force / deflection
        share[i, : s.size] = force / normal_force
    return FinitePair(phase=phi, secant=secant, share=share)


class _Position:
    """One mesh position: the teeth that touch at the distances ``s`` [m] from N1."""

    def __init__(
        self, pair: GearPair, solids: list[ElasticGear], s: Floats, modulus: float
    ) -> None:
        self._width, self._modulus = pair.face_width, modulus
        self._solids = solids
        strings = (s, pair.line_of_action - s)
        self._radius = s * strings[1] / pair.line_of_action
        self._count = s.size
        self._teeth: list[list[LoadedTooth | None]] = []
        self._joints: list[Floats] = []
        for solid, string, turned in zip(solids, strings, (False, True), strict=True):
            loaded: list[LoadedTooth | None] = [
                solid.tooth(float(rho) / solid.gear.base_radius) for rho in string
            ]
            loaded += [None] * (solid.loaded - s.size)
            # later pairs stand ahead: on the pinion towards the loaded flanks' side, on the
            # wheel away from it
            teeth = loaded[::-1] if turned else loaded
            self._teeth.append(teeth)
            self._joints.append(solid.assembled(teeth))

    def _compliance(self, force: Floats) -> Floats:
        a = hertz_half_width(force / self._width, self._radius, self._modulus)
        # <x^2>/(2 rho*) = a^2/(8 rho*) per load
        total = np.eye(self._count) / (2.0 * np.pi * self._width * self._modulus)
        for which, solid in enumerate(self._solids):
            widths = list(a) + [0.0] * (solid.loaded - self._count)
            order = slice(None, None, -1 if which else 1)
            matrix = solid.compliance(
                self._teeth[which], widths[order], assembled=self._joints[which]
            )
            part = matrix[order, order][: self._count, : self._count]
            total += part / (solid.gear.material.youngs_modulus * self._width)
        return np.asarray(total)

    def solve(self, normal_force: float) -> tuple[Floats, float]:
        """Forces and common deflection; the widths of the contacts follow their forces."""
        force = np.full(self._count, normal_force / self._count)
        change = np.inf
        for _ in range(_ROUNDS):
            flexible = np.linalg.solve(self._compliance(force), np.ones(self._count))
            deflection = normal_force / float(flexible.sum())
            new = np.asarray(deflection * flexible, dtype=np.float64)
            change = float(np.max(np.abs(new - force))) / normal_force
            force = new
            if change < _SETTLED:
                return force, deflection
        raise ConvergenceError(
            f"shares: change {change:.3g} after {_ROUNDS} rounds; tolerance {_SETTLED:g}"
        )
