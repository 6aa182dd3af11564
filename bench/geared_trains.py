"""Drive trains as plain arrays for the table of rivals: two lumped gears, and a rig in three sizes.

The rig is the one of the public truth: two shafts of eight Timoshenko elements, motor and load on
torsion springs, four bearings. It is reduced by Craig and Bampton's method: boundary x, y and tz of
both gears and x, y of bearings with clearance, static modes, and the lowest modes with the boundary
held; then the rigid rotation is dropped, mass-orthogonally.
"""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse.csgraph
from numpy.typing import NDArray

TESTS = Path(__file__).resolve().parent.parent / "tests"
for folder in ("shafts", "dynamics"):
    sys.path.insert(0, str(TESTS / folder))

from drive_reference import Plain, Ring  # noqa: E402
from trains import elastic, six  # noqa: E402

from thermogear.base.excitation import Periodic  # noqa: E402
from thermogear.shafts.assembly import Assembly, assemble  # noqa: E402
from thermogear.shafts.bearings.laws import LinearLaw, RingLaw  # noqa: E402
from thermogear.shafts.linear import LinearTrain  # noqa: E402
from thermogear.shafts.mesh_lines import MeshFrame  # noqa: E402
from thermogear.shafts.train import (  # noqa: E402
    SHAFTS,
    Bearing,
    Damping,
    DriveEnd,
    DriveTrain,
    GearBody,
    Section,
    Shaft,
)

Floats = NDArray[np.float64]
TRUTH = json.loads((TESTS / "dynamics" / "drive_truth.json").read_text(encoding="utf-8"))


def rig(p: dict[str, Any], *, linear: bool = False) -> Assembly:
    """The truth's rig; ``linear``: its bearings without clearance, springs of the same k."""
    z = np.r_[0.0, np.cumsum(p["lengths"])]
    made = elastic(p["mat"]["E"], p["mat"]["G"], p["mat"]["rho"])
    law: Any = RingLaw(coefficient=p["kb"], exponent=p["exponent"], clearance=p["clearance"])
    if linear:
        law = LinearLaw(stiffness_matrix=((p["kb"], 0.0), (0.0, p["kb"])))
    shafts, bodies, bearings = [], [], []
    for name, diameter, gear in zip(SHAFTS, (p["d1"], p["d2"]), ("pinion", "wheel"), strict=True):
        sections = tuple(
            Section(length=one, outer_diameter=diameter, material=made) for one in p["lengths"]
        )
        shafts.append(Shaft(sections=sections, gear_position=float(z[p["gear_node"]])))
        own = p[gear]
        bodies.append(GearBody(mass=own["m"], diametral_inertia=own["Id"], polar_inertia=own["Ip"]))
        for node in p["bearing_nodes"]:
            place = float(z[node])
            where = {"name": f"{name} {node}", "shaft": name, "position": place}
            bearings.append(Bearing(**where, law=law, damping=p["cb"]))
    frame = MeshFrame(
        base_radii=(p["rb1"], p["rb2"]),
        teeth=(p["z1"], p["z2"]),
        pressure_angle=np.radians(p["alpha_deg"]),
        centre_line=np.radians(p["phi_deg"]),
    )
    return assemble(
        DriveTrain(
            frame=frame,
            shafts=(shafts[0], shafts[1]),
            gears=(bodies[0], bodies[1]),
            bearings=tuple(bearings),
            motor=DriveEnd(position=0.0, inertia=p["J_motor"], stiffness=p["k_motor"]),
            load=DriveEnd(position=float(z[-1]), inertia=p["J_load"], stiffness=p["k_load"]),
            damping=Damping(shafts=p["beta"], mesh=p["zeta_mesh"]),
            least_elements=1,
        )
    )


def modes_by_part(stiffness: Floats, mass: Floats) -> tuple[Floats, Floats]:
    """Squares of frequencies and mass-normed shapes, each of one uncoupled part of the system.

    Both planes of a shaft have the same frequencies: shapes of one plane keep the zeros.
    """
    joined = np.abs(stiffness) > 1e-12 * np.abs(stiffness).max()
    size = np.sqrt(np.outer(np.diag(mass), np.diag(mass)))
    joined |= np.abs(mass) > 1e-12 * size
    _, part = scipy.sparse.csgraph.connected_components(joined, directed=False)
    squares, shapes = [], []
    for one in range(part.max() + 1):
        at = np.flatnonzero(part == one)
        square, shape = scipy.linalg.eigh(stiffness[np.ix_(at, at)], mass[np.ix_(at, at)])
        whole = np.zeros((len(mass), at.size))
        whole[at] = shape
        squares.append(square)
        shapes.append(whole)
    order = np.argsort(np.concatenate(squares), kind="stable")
    return np.concatenate(squares)[order], np.hstack(shapes)[:, order]


def craig_bampton(parts: Assembly, *, rings: bool, modes: int) -> Floats:
    """The basis (n, kept): boundary first, then the lowest ``modes`` with the boundary held."""
    columns = [parts.at_gear(name)[:, [0, 1, 4]] for name in SHAFTS]
    stiff = parts.stiffness
    for one in parts.bearings:
        if rings:
            columns.append(one.directions)
        else:
            law = one.bearing.law
            stiff = stiff + one.directions @ law.stiffness([0.0, 0.0]) @ one.directions.T
    held = [int(np.argmax(column)) for column in np.hstack(columns).T]
    free = np.setdiff1d(np.arange(parts.size), held)
    inner = stiff[np.ix_(free, free)]
    _, shape = modes_by_part(inner, parts.mass[np.ix_(free, free)])
    basis = np.zeros((parts.size, len(held) + modes))
    basis[held, np.arange(len(held))] = 1.0
    basis[free, : len(held)] = -np.linalg.solve(inner, stiff[np.ix_(free, held)])
    basis[free, len(held) :] = shape[:, :modes]
    basis[np.abs(basis) < 1e-13] = 0.0
    return basis


def plain(parts: Assembly, p: dict[str, Any], basis: Floats | None = None) -> Plain:
    """The equation of ``parts`` in ``basis``, its rigid rotation dropped."""
    k = Periodic(p["k_mean"], tuple(np.asarray(p["k_re"]) + 1j * np.asarray(p["k_im"])))
    e = Periodic(0.0, tuple(np.asarray(p["e_re"]) + 1j * np.asarray(p["e_im"])))
    rings = isinstance(parts.bearings[0].bearing.law, RingLaw)
    stiff = parts.stiffness
    springs = np.zeros((len(parts.bearings), 2, 2))
    if not rings:
        springs = np.array([one.bearing.law.stiffness([0.0, 0.0]) for one in parts.bearings])
        for one, spring in zip(parts.bearings, springs, strict=True):
            stiff = stiff + one.directions @ spring @ one.directions.T
    train = LinearTrain(assembly=parts, mesh=k.mean, bearings=springs)
    omega = parts.frame.sense * p["rpm"] * np.pi / 30.0
    whole = np.eye(parts.size) if basis is None else basis
    pull = whole.T @ parts.mass @ parts.rotation
    pull = pull / np.linalg.norm(pull)
    first = int(np.argmax(np.abs(pull)))
    pull[first] += np.copysign(1.0, pull[first])
    mirror = np.eye(pull.size) - 2.0 * np.outer(pull, pull) / (pull @ pull)
    t = whole @ np.delete(mirror, first, axis=1)
    made = Plain(
        mass=t.T @ parts.mass @ t,
        damping=t.T @ (train.damping + omega * parts.gyroscopic) @ t,
        stiffness=t.T @ stiff @ t,
        force=t.T @ parts.end_torques(p["T1"]),
        drive=t.T @ parts.drive,
        back=t.T @ parts.back,
        mesh_stiffness=k,
        error=e,
        half_backlash=p["b"],
        mesh_damping=train.mesh_damping,
        mesh_frequency=p["z1"] * p["rpm"] / 60.0,
        bearings=tuple(
            Ring(
                directions=t.T @ one.directions,
                coefficient=p["kb"],
                exponent=p["exponent"],
                clearance=p["clearance"],
            )
            for one in parts.bearings
            if rings
        ),
    )
    if not p.get("chi0"):
        return made
    pitch, metre = parts.frame.friction_columns
    six_rows = np.concatenate([parts.at_gear(name)[:, [0, 1, 4]] for name in SHAFTS], axis=-1)
    series = []
    for rows in (p["chi0"], p["chi1"]):
        found = np.zeros(1 + max(row[0] for row in rows), complex)
        for order, re, im in rows:
            found[order] += re + 1j * im
        series.append(Periodic(found[0].real, tuple(found[1:])))
    return replace(
        made,
        friction=np.stack([t.T @ six_rows @ pitch, t.T @ six_rows @ metre]),
        friction_at_pitch=series[0],
        friction_per_metre=series[1],
    )


def train_of(size: int, p: dict[str, Any]) -> Plain:
    """The lumped train (6), the rig with linear bearings (12), with four rings (30, 60)."""
    if size == 6:
        return plain(six(p), p)
    parts = rig(p, linear=size == 12)
    boundary = 6 if size == 12 else 14
    basis = craig_bampton(parts, rings=size != 12, modes=size + 1 - boundary)
    return plain(parts, p, basis)


def equilibrium(p: Plain) -> Floats:
    """At rest under the mean stiffness with the drive flank and the bearings in contact, (2n,)."""
    g, q = p.drive, np.zeros(p.drive.size)
    k = p.mesh_stiffness.mean
    tangent = p.stiffness + k * np.outer(g, g)
    start = tangent + sum((b.coefficient * b.directions @ b.directions.T for b in p.bearings), 0.0)
    q = np.linalg.solve(start, p.force + k * p.half_backlash * g)
    for _ in range(200):
        left, slope = p.force - p.stiffness @ q - k * max(g @ q - p.half_backlash, 0.0) * g, tangent
        for b in p.bearings:
            u = b.directions.T @ q
            r = float(np.hypot(*u))
            deep = max(r - b.clearance, 1e-3 * b.clearance)
            towards = u / r
            size = b.coefficient * deep**b.exponent
            own = b.exponent * size / deep * np.outer(towards, towards)
            own = own + size / r * (np.eye(2) - np.outer(towards, towards))
            slope = slope + b.directions @ own @ b.directions.T
            left = left - b.directions @ (size * towards)
        step = np.linalg.solve(slope, left)
        q = q + step
        if np.abs(step).max() < 1e-14 * np.abs(q).max():
            break
    return np.r_[q, np.zeros(q.size)]


def state_of(p: Plain, section: dict[str, list[float]]) -> Floats:
    """The state of the lumped train with the truth's section (delta_d, delta_b, x1, y1, x2, y2)."""
    rows = np.vstack([p.drive, p.back, *(b.directions.T for b in p.bearings)])
    both = [np.linalg.lstsq(rows, np.asarray(section[k]), rcond=None)[0] for k in ("y", "ydot")]
    return np.concatenate(both)


__all__ = ["TRUTH", "Plain", "equilibrium", "state_of", "train_of"]
