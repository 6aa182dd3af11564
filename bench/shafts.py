"""Matrices of two geared shafts beside ROSS 2.3: mass, gyroscopics, damping and stiffness.

Random trains, drawn from a seed before anything is compared. ROSS counts the driven shaft's twist
the other way and has axial motion besides; both are put in our coordinates. Frequencies of the
whole train follow from the matrices and are compared too.
"""

from __future__ import annotations

import contextlib
import io
import sys
import time
from typing import Any

import numpy as np
import scipy.linalg

from thermogear.base.materials import material
from thermogear.shafts.assembly import Assembly, assemble, linear_stiffness
from thermogear.shafts.bearings.laws import LinearLaw
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    Damping,
    Disc,
    DriveTrain,
    GearBody,
    Section,
    Shaft,
)

SEED, TRAINS = 20, 12
MESH = 3e8


def drawn(rng: np.random.Generator) -> DriveTrain:
    """A train whose sections are its elements: gear, bearings and disc at their ends."""
    steel = material("steel")
    module, teeth = rng.uniform(2e-3, 6e-3), rng.integers(17, 60, 2)
    shafts, bearings, bodies, discs = [], [], [], []
    for name, z in zip(SHAFTS, teeth, strict=True):
        radius = 0.5 * module * z
        sections = tuple(
            Section(
                length=float(rng.uniform(0.5, 2.0) * radius),
                outer_diameter=float(rng.uniform(0.5, 1.2) * radius),
                inner_diameter=float(rng.choice([0.0, 0.2]) * radius),
                material=steel,
            )
            for _ in range(6)
        )
        places = np.cumsum([one.length for one in sections])
        shafts.append(Shaft(sections=sections, gear_position=float(places[2])))
        for number, place in enumerate((places[0], places[4])):
            kx, ky = 10 ** rng.uniform(7.5, 9.0, 2)
            law = LinearLaw(stiffness_matrix=((kx, 0.0), (0.0, ky)))
            bearings.append(
                Bearing(
                    name=f"{name} {number + 1}",
                    shaft=name,
                    position=float(place),
                    law=law,
                    damping=float(rng.uniform(100.0, 2000.0)),
                )
            )
        mass = 7850.0 * np.pi * radius**2 * 10.0 * module
        polar = 0.5 * mass * radius**2
        body = {"mass": mass, "polar_inertia": polar, "diametral_inertia": 0.6 * polar}
        bodies.append(GearBody(**body))
        discs.append(Disc(shaft=name, position=float(places[5]), **body))
    alpha = np.radians(20.0)
    radii = 0.5 * module * teeth * np.cos(alpha)
    frame = MeshFrame(
        base_radii=(float(radii[0]), float(radii[1])),
        teeth=(int(teeth[0]), int(teeth[1])),
        pressure_angle=alpha,
        centre_line=float(rng.uniform(-np.pi, np.pi)),
    )
    return DriveTrain(
        frame=frame,
        shafts=(shafts[0], shafts[1]),
        gears=(bodies[0], bodies[1]),
        bearings=tuple(bearings),
        discs=tuple(discs),
        damping=Damping(shafts=0.0, mesh=0.0),
        least_elements=1,
    )


def theirs(train: DriveTrain) -> Any:
    """The same train in ROSS."""
    import ross

    steel = material("steel")
    shear = 0.5 * steel.youngs_modulus / (1.0 + steel.poisson_ratio)
    made = ross.Material(name="bench", rho=steel.density, E=steel.youngs_modulus, G_s=shear)
    rotors = []
    for number, name in enumerate(SHAFTS):
        shaft, gear = train.shafts[number], train.gears[number]
        places = np.r_[0.0, np.cumsum([one.length for one in shaft.sections])]
        pieces = [
            ross.ShaftElement(
                L=one.length, idl=one.inner_diameter, odl=one.outer_diameter, material=made
            )
            for one in shaft.sections
        ]
        discs = [
            ross.GearElement(
                n=3,
                m=gear.mass,
                Id=gear.diametral_inertia,
                Ip=gear.polar_inertia,
                n_teeth=train.frame.teeth[number],
                base_diameter=2.0 * train.frame.base_radii[number],
                pr_angle=train.frame.pressure_angle,
            )
        ]
        discs += [
            ross.DiskElement(n=6, m=d.mass, Id=d.diametral_inertia, Ip=d.polar_inertia)
            for d in train.discs
            if d.shaft == name
        ]
        rings = []
        for one in train.bearings:
            if one.shaft == name:
                assert isinstance(one.law, LinearLaw)
                (kx, _), (_, ky) = one.law.stiffness_matrix
                node = int(np.argmin(np.abs(places - one.position)))
                rings.append(
                    ross.BearingElement(n=node, kxx=kx, kyy=ky, cxx=one.damping, cyy=one.damping)
                )
        rotors.append(ross.Rotor(pieces, discs, rings))
    return ross.MultiRotor(
        *rotors,
        coupled_nodes=(3, 3),
        gear_mesh_stiffness=MESH,
        orientation_angle=train.frame.centre_line,
    )


def compared(train: DriveTrain) -> dict[str, float]:
    """Worst difference of every matrix over its largest entry, and of the frequencies."""
    parts: Assembly = assemble(train)
    other = theirs(train)
    keep = [i for i in range(other.ndof) if i % 6 != 2]
    sign = np.ones(parts.size)
    half = parts.size // 2
    sign[half + 4 :: 5] = -1.0
    springs = np.array([b.bearing.law.stiffness([0.0, 0.0]) for b in parts.bearings])
    ours = {
        "M": parts.mass,
        "K": linear_stiffness(parts, mesh=MESH, bearings=springs),
        "C": parts.viscous,
        "G": parts.gyroscopic,
    }
    found = {}
    flipped = sign[:, None] * sign
    for name, own in ours.items():
        matrix = getattr(other, name)
        known = (matrix() if name == "G" else matrix(0.0))[np.ix_(keep, keep)] * flipped
        found[name] = float(np.abs(own - known).max() / np.abs(known).max())
        ours[name] = known
    w, known_w = (
        np.sqrt(np.abs(scipy.linalg.eigh(k, m, eigvals_only=True)[1:13]))
        for k, m in (
            (linear_stiffness(parts, mesh=MESH, bearings=springs), parts.mass),
            (ours["K"], ours["M"]),
        )
    )
    found["frequencies"] = float(np.abs(w / known_w - 1.0).max())
    return found


def main() -> int:
    """Print the worst of every matrix over the random trains, and what building them takes."""
    rng = np.random.default_rng(SEED)
    trains = [drawn(rng) for _ in range(TRAINS)]
    worst: dict[str, float] = {}
    times = [0.0, 0.0]
    for train in trains:
        with contextlib.redirect_stdout(io.StringIO()):
            found = compared(train)
            for place, make in enumerate((assemble, theirs)):
                begun = time.process_time()
                make(train)
                times[place] += time.process_time() - begun
        worst = {name: max(value, worst.get(name, 0.0)) for name, value in found.items()}
    print(f"{TRAINS} trains of seed {SEED}, {assemble(trains[0]).size} coordinates")
    for name, value in worst.items():
        print(f"  {name:<12} {value:.1e} of its largest")
    ours, others = (t / TRAINS * 1e3 for t in times)
    print(f"  assembling   {ours:.1f} ms ours, {others:.1f} ms theirs (processor time)")
    return 0 if max(worst.values()) < 1e-9 else 1


if __name__ == "__main__":
    sys.exit(main())
