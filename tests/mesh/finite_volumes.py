"""Gears and housing by finite volumes, to set the thermal network against: own code, own mesh.

Each gear is cut into rings: ``BODY`` of equal width from the bore to the root circle, with both
faces in the oil over the wetted share, and ``TEETH`` from there to the tip circle, of the teeth's
own cross-section z s(r) b, s(r) from the involute, with both flanks in the oil. Frictional heat
enters evenly over the part of the flank that touches. The shaft is one volume at the bore. The
housing is a plane wall of its mass and area, ``WALL`` layers, oil on one side and air on the other;
the bearings heat its inner layer. Oil is one volume. Conduction between centres, backward
differences in time. What a network of nodes lumps is resolved here; areas, film coefficients,
oil, shaft ends are the same.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.sparse import csr_matrix

from thermogear import Gear, GearPair, Surroundings
from thermogear.base.materials import Lubricant
from thermogear.gears.contact import flank_radii
from thermogear.heat.convection import rotating_face_convection
from thermogear.heat.gearbox import Losses, oil_prandtl
from thermogear.heat.lubrication import kinematic_viscosity

BODY, TEETH, WALL = 80, 24, 8
WALL_DENSITY, WALL_CONDUCTIVITY = 7850.0, 46.0


@dataclass
class Rings:
    """One gear: centres, capacities [J/K], conductances between neighbours [W/K], wetted areas."""

    radius: np.ndarray
    capacity: np.ndarray
    between: np.ndarray
    area: np.ndarray
    heated: np.ndarray
    to_bore: float
    shaft: float
    mount: float
    body: int


def rings(gear: Gear, touching: tuple[float, float], around: Surroundings, share: float) -> Rings:
    steel, b = gear.material, gear.face_width
    k, heat = steel.thermal_conductivity, steel.density * steel.specific_heat
    edges = np.concatenate(
        [
            np.linspace(gear.bore_radius, gear.root_radius, BODY + 1),
            np.linspace(gear.root_radius, gear.tip_radius, TEETH + 1)[1:],
        ]
    )
    r, dr = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    teeth = np.arange(r.size) >= BODY
    base = np.maximum(r, gear.base_radius)
    thick = 2.0 * r * np.asarray(gear.half_thickness_angle(base)) * gear.teeth
    across = np.where(teeth, thick, 2.0 * np.pi * r) * b
    resistance = 0.5 * dr / (k * across)
    wet = np.where(teeth, 2.0 * gear.teeth * b * dr, 4.0 * np.pi * r * dr)
    inside = teeth & (r > touching[0]) & (r < touching[1])
    along = k * np.pi * gear.bore_radius**2 / around.shaft_length
    return Rings(
        radius=r,
        capacity=heat * across * dr,
        between=1.0 / (resistance[1:] + resistance[:-1]),
        area=share * wet,
        heated=inside / inside.sum(),
        to_bore=1.0 / resistance[0],
        shaft=heat * np.pi * gear.bore_radius**2 * (b + 2.0 * around.shaft_length),
        mount=2.0 / (1.0 / along + 1.0 / around.bearing_conductance),
        body=BODY,
    )


def run(
    pair: GearPair,
    speed: float,
    losses: Losses,
    oil: Lubricant,
    around: Surroundings,
    times: np.ndarray,
) -> dict[str, np.ndarray]:
    """Temperatures [K] at ``times`` [s] from the ambient, by the names of the network's nodes.

    A tooth at its pitch circle, a body at the radius that halves its ring, the wall's mean.
    """
    ends = np.array([pair.path.a, pair.path.e])
    cells = [
        rings(gear, (float(np.min(radii)), float(np.max(radii))), around, share)
        for gear, radii, share in zip(
            (pair.pinion, pair.wheel), flank_radii(pair, ends), around.wetted_share, strict=True
        )
    ]
    speeds = speed, speed / pair.ratio
    part = float(np.asarray(losses.partition_1))
    mesh = float(np.asarray(losses.mesh))
    heats = mesh * part, mesh * (1.0 - part)
    bearings = float(np.asarray(losses.bearing_1)), float(np.asarray(losses.bearing_2))
    churning = float(np.asarray(losses.churning))
    sizes = [c.radius.size + 1 for c in cells]
    wall = around.housing_mass / WALL
    depth = around.housing_mass / (WALL_DENSITY * around.housing_area) / WALL
    layer = WALL_CONDUCTIVITY * around.housing_area / depth
    inner = 1.0 / (1.0 / (around.oil_housing_coefficient * around.housing_area) + 0.5 / layer)
    outer = 1.0 / (1.0 / (around.housing_coefficient * around.housing_area) + 0.5 / layer)
    at_oil, at_wall = sum(sizes), sum(sizes) + 1

    def slope(t: float, y: np.ndarray) -> np.ndarray:
        out = np.zeros_like(y)
        warm = y[at_oil]
        nu, pr = kinematic_viscosity(oil, warm), oil_prandtl(oil, warm)
        first = 0
        for c, gear, omega, heat, bearing in zip(
            cells, (pair.pinion, pair.wheel), speeds, heats, bearings, strict=True
        ):
            n = c.radius.size
            ring, shaft = y[first : first + n], y[first + n]
            r = np.where(np.arange(n) < c.body, c.radius, gear.pitch_radius)
            film = rotating_face_convection(omega, r, nu, oil.thermal_conductivity, pr)
            to_oil = film * c.area * (ring - warm)
            flow = c.between * np.diff(ring)
            net = heat * c.heated - to_oil
            net[:-1] += flow
            net[1:] -= flow
            into = c.to_bore * (ring[0] - shaft)
            net[0] -= into
            out[first : first + n] = net / c.capacity
            leaves = c.mount * (shaft - y[at_wall])
            out[first + n] = (into + bearing - leaves) / c.shaft
            out[at_oil] += to_oil.sum()
            out[at_wall] += leaves
            first += n + 1
        layers = y[at_wall:]
        to_wall = inner * (warm - layers[0])
        out[at_oil] = (out[at_oil] + churning - to_wall) / (around.oil_mass * oil.specific_heat)
        flow = layer * np.diff(layers)
        out[at_wall] += to_wall
        out[at_wall:-1] += flow
        out[at_wall + 1 :] -= flow
        out[-1] -= outer * (layers[-1] - around.ambient)
        out[at_wall:] /= wall * around.housing_specific_heat
        return out

    start = np.full(at_wall + WALL, around.ambient)
    pattern = _pattern(slope, start + np.linspace(0.0, 1.0, start.size))
    solved = solve_ivp(
        slope, (0.0, times[-1]), start, method="BDF", t_eval=times, rtol=1e-6, atol=1e-5,
        jac_sparsity=pattern,
    )  # fmt: skip
    assert solved.success
    found = {"oil": solved.y[at_oil], "housing": solved.y[at_wall:].mean(axis=0)}
    first = 0
    for name, c, gear in zip(("pinion", "wheel"), cells, (pair.pinion, pair.wheel), strict=True):
        n = c.radius.size
        ring = solved.y[first : first + n]
        middle = np.sqrt(0.5 * (gear.bore_radius**2 + gear.root_radius**2))
        for node, radius in (("tooth", gear.pitch_radius), ("body", middle)):
            found[f"{name}_{node}"] = np.array([np.interp(radius, c.radius, t) for t in ring.T])
        found[f"{name}_shaft"] = solved.y[first + n]
        first += n + 1
    return found


def _pattern(slope, y):  # type: ignore[no-untyped-def]
    """Which volume feels which, found by moving one after the other."""
    base, found = slope(0.0, y), np.eye(y.size)
    for i in range(y.size):
        moved = y.copy()
        moved[i] += 1.0
        found[:, i] += slope(0.0, moved) != base
    return csr_matrix(found > 0.0)
