"""Thermoelastic growth of a flank by finite elements: one sector of the gear, tooth included.

The annulus solution of the model knows no teeth: here body, fillets and tooth are one piece
with the field T(r) running on to the tip, and the sector's edges are planes of symmetry.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu
from skfem import LinearForm, helpers

from finite_elements.elements import ReferencePatch
from finite_elements.sector import united
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.elements import Integers
from thermogear.gears.geometry import Gear
from thermogear.gears.tooth_mesh import (
    Density,
    Foot,
    Profile,
    foot_mesh,
    halved,
    plain_across,
    tooth_mesh,
)
from thermogear.heat.expansion import BORES, RadialField


def flank_radii(gear: Gear, count: int = 7) -> Floats:
    """``count`` radii [m] from the form circle to the tip, evenly apart."""
    return np.linspace(gear.form_radius, gear.tip_radius, count)


def _arcs(gear: Gear, radius: Floats, density: Density) -> tuple[Floats, Integers]:
    """Corners of the flank's mesh with one at each asked radius, and which those are."""
    profile = Profile(gear)
    low, high = profile.ends
    asked = 0.5 * (radius**2 / gear.base_radius - gear.base_radius)
    stops = np.unique(np.concatenate([[low], np.clip(asked, low, high), [high]]))
    # rounding may set two stops a hair apart, which would leave an element without area
    stops = stops[np.concatenate([[True], np.diff(stops) > 1e-6 * (high - low)])]
    stops[-1] = high
    size = (high - low) / density.count(8)
    pieces = [
        np.linspace(a, b, max(int(np.ceil((b - a) / size)), 1) + 1)[:-1] for a, b in pairwise(stops)
    ]
    arcs = np.concatenate([*pieces, [high]])
    return arcs, np.argmin(np.abs(arcs - asked[:, None]), axis=-1)


def thermal_load(patch: ReferencePatch, strain: Callable[[Floats, Floats], Floats]) -> Floats:
    """Nodal forces of a free thermal strain, ``strain(x, y)``, unit modulus, plane stress."""
    stress = 1.0 / (1.0 - patch.poisson)

    def work(v: Any, w: Any) -> Any:
        return stress * strain(w.x[0], w.x[1]) * helpers.div(v)

    return patch._ours(LinearForm(work).assemble(patch._basis))


def finite_flank_growth(
    gear: Gear,
    field: RadialField,
    radius: ArrayLike,
    bore: str = "free",
    density: Density | None = None,
) -> Floats:
    """Normal growth [m] of one flank at ``radius`` [m] relative to its tooth's centre line.

    Plane stress, T(r) of ``field`` in body and teeth, rim and teeth free. field: of one state
    (numbers, no arrays); radius: from the form circle to the tip, any shape; bore: "free",
    "rigid" (not moved) or "shaft" (moved by lambda t_x r_x), free to slide around. Raises
    InputError for radii off the flank, an unknown bore and when scikit-fem is missing.
    """
    require_choice("bore", bore, BORES)
    if field.gradient.size != 1:
        raise InputError("field", f"{field.gradient.size} states", allowed="one state")
    r = np.asarray(radius, dtype=float)
    slack = 1e-9 * gear.tip_radius
    if np.any((r < gear.form_radius - slack) | (r > gear.tip_radius + slack)):
        raise InputError(
            "radius",
            f"{1e3 * r.min():.6g} .. {1e3 * r.max():.6g} mm",
            allowed=f"{1e3 * gear.form_radius:.6g} .. {1e3 * gear.tip_radius:.6g} mm",
            why="the flank lies between form circle and tip",
        )
    mesh = density or Density(refinement=2)
    across = plain_across(mesh)
    foot = foot_mesh(gear, across, mesh)
    arcs, asked = _arcs(gear, r.ravel(), mesh)
    tooth = tooth_mesh(gear, across=across, arcs=arcs, density=mesh)
    patch, of_tooth = united(foot, tooth)
    expansion = gear.material.thermal_expansion
    moved = _displacement(patch, foot, field, expansion, bore)

    # the tooth's flank begins with the fillet's rows; the asked corners count from the tip
    flank = of_tooth[tooth.flank]
    spots = flank[flank.size - halved(arcs).size + 2 * asked]
    t = np.sqrt(np.maximum((np.hypot(*patch.nodes[spots].T) / gear.base_radius) ** 2 - 1.0, 0.0))
    beta = t - gear.base_half_angle
    normal = np.stack([np.cos(beta), np.sin(beta)], axis=-1)
    return np.asarray(np.sum(moved[spots] * normal, axis=-1).reshape(r.shape))


def _displacement(
    patch: ReferencePatch, foot: Foot, field: RadialField, expansion: float, bore: str
) -> Floats:
    """Displacement (node, 2) [m] of the sector under the field."""

    def strain(x: Floats, y: Floats) -> Floats:
        return expansion * np.asarray(field.rise(np.hypot(x, y))).reshape(np.shape(x))

    # radial and hoop unknowns on the edges and on the bore, x and y elsewhere
    radial = np.unique(np.concatenate([foot.left, foot.right, foot.bore]))
    count = patch.nodes.shape[0]
    x, y = patch.nodes[radial].T
    r = np.hypot(x, y)
    plain = np.setdiff1d(np.arange(2 * count), np.concatenate([2 * radial, 2 * radial + 1]))
    rows = np.concatenate([plain, 2 * radial, 2 * radial, 2 * radial + 1, 2 * radial + 1])
    columns = np.concatenate([plain, 2 * radial, 2 * radial + 1, 2 * radial, 2 * radial + 1])
    values = np.concatenate([np.ones(plain.size), x / r, y / r, y / r, -x / r])
    turn = coo_matrix((values, (rows, columns)), shape=(2 * count, 2 * count)).tocsr()
    stiffness = (turn.T @ patch.stiffness() @ turn).tocsc()
    load = turn.T @ thermal_load(patch, strain)

    edges = np.concatenate([foot.left, foot.right, foot.bore[[0, -1]]])
    unknown = np.zeros(2 * count)
    held = 2 * edges + 1
    if bore != "free":
        inner = float(np.hypot(*patch.nodes[foot.bore[0]]))
        unknown[2 * foot.bore] = 0.0 if bore == "rigid" else expansion * field.bore_rise * inner
        held = np.concatenate([held, 2 * foot.bore])
    free = np.setdiff1d(np.arange(2 * count), held)
    unknown[free] = splu(stiffness[free][:, free].tocsc()).solve((load - stiffness @ unknown)[free])
    return np.asarray((turn @ unknown).reshape(count, 2))
