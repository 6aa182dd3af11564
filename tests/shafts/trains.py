"""Drive trains for the tests: the public truth cases, and random ones."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from thermogear.base.materials import material
from thermogear.shafts import assembly
from thermogear.shafts.assembly import Assembly, mesh_mass
from thermogear.shafts.bearings.laws import LinearLaw, RingLaw
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    Damping,
    Disc,
    DriveEnd,
    DriveTrain,
    GearBody,
    Section,
    Shaft,
)

TRUTH = json.loads((Path(__file__).parent / "truth.json").read_text())


def elastic(modulus: float, shear: float, density: float) -> Any:
    """A stand-in for a material of any E, G [Pa] and density [kg/m^3], also one of no mass."""
    ratio = 0.5 * modulus / shear - 1.0
    return SimpleNamespace(youngs_modulus=modulus, poisson_ratio=ratio, density=density)


def stiff_bearing(name: str, shaft: str, position: float, kx: float, ky: float) -> Bearing:
    law = LinearLaw(stiffness_matrix=((kx, 0.0), (0.0, ky)))
    return Bearing(name=name, shaft=shaft, position=position, law=law)


def rao_train(params: dict[str, Any]) -> DriveTrain:
    """L4: two geared shafts by Rao, Shiau and Chang (1998)."""
    shafts, bearings, discs, bodies = [], [], [], []
    for name, one, gear in zip(
        SHAFTS, (params["sh1"], params["sh2"]), (params["g1"], params["g2"]), strict=True
    ):
        z = np.r_[0.0, np.cumsum(one["lengths"])]
        made = elastic(one["mat"]["E"], one["mat"]["G"], one["mat"]["rho"])
        sections = tuple(
            Section(length=a, outer_diameter=d, material=made)
            for a, d in zip(one["lengths"], one["d"], strict=True)
        )
        shafts.append(Shaft(sections=sections, gear_position=float(z[gear])))
        for node, (mass, diametral, polar) in one["discs"]:
            if node == gear:
                bodies.append(GearBody(mass=mass, polar_inertia=polar, diametral_inertia=diametral))
            else:
                discs.append(
                    Disc(
                        shaft=name,
                        position=float(z[node]),
                        mass=mass,
                        polar_inertia=polar,
                        diametral_inertia=diametral,
                    )
                )
        for i, (node, (kx, ky)) in enumerate(one["bearings"]):
            bearings.append(stiff_bearing(f"{name} {i + 1}", name, float(z[node]), kx, ky))
    teeth = Fraction(params["ratio"]).limit_denominator(200)
    frame = MeshFrame(
        base_radii=(params["r1"], params["r2"]),
        teeth=(teeth.numerator, teeth.denominator),
        pressure_angle=params["alpha"],
        centre_line=params["phi"],
    )
    return DriveTrain(
        frame=frame,
        shafts=(shafts[0], shafts[1]),
        gears=(bodies[0], bodies[1]),
        bearings=tuple(bearings),
        discs=tuple(discs),
        least_elements=1,
    )


def lumped(
    frame: MeshFrame,
    *,
    masses: tuple[float, float],
    inertias: tuple[float, float],
    bearings: tuple[Bearing, Bearing],
    damping: Damping | None = None,
) -> Assembly:
    """Two rigid gears, each on one bearing in its plane: x, y and tz of both, six coordinates.

    ``masses`` [kg], ``inertias`` [kg m^2] polar, of pinion and wheel.
    The limit of stiff shafts with bearings on both sides of each gear, and the smallest train in
    which gears part and bearings give.
    """
    names = tuple(f"{shaft}.0.{one}" for shaft in SHAFTS for one in ("x", "y", "tz"))
    empty = Assembly(
        frame=frame,
        damping=damping or Damping(),
        coordinates=names,
        **(assembly._empty(6) | dict(zip(("drive", "back"), frame.columns, strict=True))),
        bearings=(),
        nodes=(np.zeros(1), np.zeros(1)),
        gear_nodes=(0, 0),
        mesh_mass=mesh_mass(frame, pinion=inertias[0], wheel=inertias[1]),
    )
    own = [value for m, inertia in zip(masses, inertias, strict=True) for value in (m, m, inertia)]
    empty.mass[...] = np.diag(own)
    places = tuple(assembly._put_bearing(empty, one, np.zeros((6, 2))) for one in bearings)
    return replace(empty, bearings=places)


def six(params: dict[str, Any]) -> Assembly:
    """The truth's `six`: two masses on one ring bearing each."""
    frame = MeshFrame(
        base_radii=(params["rb1"], params["rb2"]),
        teeth=(params["z1"], round(params["z1"] * params["rb2"] / params["rb1"])),
        pressure_angle=np.radians(params["alpha_deg"]),
        centre_line=np.radians(params["phi_deg"]),
        sense=params.get("sense", 1),
    )
    law = RingLaw(
        coefficient=params["kb"], exponent=params["exponent"], clearance=params["clearance"]
    )
    first, second = (
        Bearing(name=f"{shaft} bearing", shaft=shaft, position=0.0, law=law, damping=params["cb"])
        for shaft in SHAFTS
    )
    return lumped(
        frame,
        masses=(params["m1"], params["m2"]),
        inertias=(params["I1"], params["I2"]),
        bearings=(first, second),
        damping=Damping(shafts=0.0, mesh=params["zeta_mesh"]),
    )


def random_train(rng: np.random.Generator, **changes: Any) -> DriveTrain:
    """Two shafts of two to four sections in linear bearings, a motor and a load."""
    module, teeth = rng.uniform(1e-3, 6e-3), rng.integers(15, 60, 2)
    angle = np.radians(rng.uniform(18.0, 26.0))
    radii = 0.5 * module * teeth * np.cos(np.radians(20.0))
    made = material("steel")
    shafts, bearings, bodies = [], [], []
    for name, base in zip(SHAFTS, radii, strict=True):
        size = rng.uniform(0.35, 0.8) * base
        sections = tuple(
            Section(
                length=float(rng.uniform(1.0, 4.0) * size),
                outer_diameter=float(2.0 * size * rng.uniform(0.7, 1.0)),
                inner_diameter=float(size * rng.choice([0.0, 0.5])),
                material=made,
            )
            for _ in range(rng.integers(2, 5))
        )
        total = sum(one.length for one in sections)
        shafts.append(Shaft(sections=sections, gear_position=total * rng.uniform(0.25, 0.75)))
        for i, place in enumerate((0.05, 0.95)):
            kx, ky = 10.0 ** rng.uniform(7.5, 9.0, 2)
            bearings.append(stiff_bearing(f"{name} {i + 1}", name, place * total, kx, ky))
        mass = 7850.0 * np.pi * base**2 * 10.0 * module
        polar = 0.5 * mass * base**2
        bodies.append(
            GearBody(mass=mass, polar_inertia=polar, diametral_inertia=0.5 * polar + 1e-5 * mass)
        )
    parts: dict[str, Any] = {
        "frame": MeshFrame(
            base_radii=(float(radii[0]), float(radii[1])),
            teeth=(int(teeth[0]), int(teeth[1])),
            pressure_angle=angle,
            centre_line=rng.uniform(-np.pi, np.pi),
            sense=int(rng.choice([-1, 1])),
        ),
        "shafts": tuple(shafts),
        "gears": tuple(bodies),
        "bearings": tuple(bearings),
        "motor": DriveEnd(position=0.0, inertia=5.0 * bodies[0].polar_inertia, stiffness=2e4),
        "load": DriveEnd(
            position=shafts[1].length, inertia=3.0 * bodies[1].polar_inertia, stiffness=5e4
        ),
    }
    return DriveTrain(**(parts | changes))
