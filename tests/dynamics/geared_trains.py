"""Drive trains in motion for the tests: the public truth cases as models."""

from __future__ import annotations

from typing import Any

import numpy as np
from tests.shafts.trains import elastic, six

from thermogear.base.excitation import Periodic
from thermogear.dynamics.geared import GearedModel, LocalBearing
from thermogear.shafts.assembly import Assembly, assemble
from thermogear.shafts.bearings.laws import RingLaw
from thermogear.shafts.mesh_lines import MeshFrame
from thermogear.shafts.reduction import Reduction, reduced
from thermogear.shafts.statics import equilibrium
from thermogear.shafts.train import (
    SHAFTS,
    Bearing,
    Damping,
    DriveEnd,
    DriveTrain,
    GearBody,
    Section,
    Shaft,
)

Floats = np.ndarray


def series(mean: float, rows: Any) -> Periodic:
    """A Periodic of complex amplitudes in order."""
    return Periodic(mean, tuple(complex(*row) for row in rows))


def functions(params: dict[str, Any]) -> tuple[Periodic, Periodic]:
    """k and e of a truth case."""
    stiffness = series(params["k_mean"], zip(params["k_re"], params["k_im"], strict=True))
    return stiffness, series(0.0, zip(params["e_re"], params["e_im"], strict=True))


def by_order(rows: Any) -> Periodic:
    """A Periodic of rows (order, re, im)."""
    found = np.zeros(1 + max((int(row[0]) for row in rows), default=0), complex)
    for order, real, imaginary in rows:
        found[int(order)] = complex(real, imaginary)
    return Periodic(float(found[0].real), tuple(found[1:]))


def rig(params: dict[str, Any]) -> Assembly:
    """The truth's rig: two shafts of eight elements on four ring bearings, motor and load."""
    made = elastic(params["mat"]["E"], params["mat"]["G"], params["mat"]["rho"])
    z = np.r_[0.0, np.cumsum(params["lengths"])]
    law = RingLaw(
        coefficient=params["kb"], exponent=params["exponent"], clearance=params["clearance"]
    )
    shafts, bearings = [], []
    for name, size in zip(SHAFTS, (params["d1"], params["d2"]), strict=True):
        sections = tuple(
            Section(length=one, outer_diameter=size, material=made) for one in params["lengths"]
        )
        shafts.append(Shaft(sections=sections, gear_position=float(z[params["gear_node"]])))
        bearings += [
            Bearing(
                name=f"{name} {node}", shaft=name, position=float(z[node]), law=law,
                damping=params["cb"],
            )
            for node in params["bearing_nodes"]
        ]  # fmt: skip
    gears = [
        GearBody(
            mass=params[name]["m"],
            polar_inertia=params[name]["Ip"],
            diametral_inertia=params[name]["Id"],
        )
        for name in SHAFTS
    ]
    return assemble(
        DriveTrain(
            frame=MeshFrame(
                base_radii=(params["rb1"], params["rb2"]),
                teeth=(params["z1"], params["z2"]),
                pressure_angle=np.radians(params["alpha_deg"]),
                centre_line=np.radians(params["phi_deg"]),
            ),
            shafts=(shafts[0], shafts[1]),
            gears=(gears[0], gears[1]),
            bearings=tuple(bearings),
            motor=DriveEnd(position=0.0, inertia=params["J_motor"], stiffness=params["k_motor"]),
            load=DriveEnd(
                position=float(z[-1]), inertia=params["J_load"], stiffness=params["k_load"]
            ),
            damping=Damping(shafts=params["beta"], mesh=params["zeta_mesh"]),
            least_elements=1,
        )
    )


def moving(
    assembly: Assembly, params: dict[str, Any], coordinates: int | None = None, **changes: Any
) -> tuple[GearedModel, Floats, Reduction]:
    """The equations of ``assembly`` as a truth case says, and the state at rest."""
    stiffness, error = functions(params)
    rest = equilibrium(assembly, params["T1"], mesh=stiffness.mean, half_backlash=params["b"])
    linear = rest.linear()
    kept = reduced(assembly, coordinates)
    turn = assembly.frame.sense * params["rpm"] * np.pi / 30.0
    parts: dict[str, Any] = {
        "mass": kept.matrix(assembly.mass),
        "damping": kept.matrix(linear.damping + turn * assembly.gyroscopic),
        "stiffness": kept.matrix(assembly.stiffness),
        "force": kept.vector(assembly.end_torques(params["T1"])),
        "drive": kept.vector(assembly.drive),
        "back": kept.vector(assembly.back),
        "mesh_stiffness": stiffness,
        "error": error,
        "half_backlash": params["b"],
        "mesh_damping": linear.mesh_damping,
        "mesh_frequency": params["z1"] * params["rpm"] / 60.0,
        "bearings": tuple(
            LocalBearing(
                directions=kept.vector(place.directions),
                coefficient=place.bearing.law.coefficient,
                exponent=place.bearing.law.exponent,
                clearance=place.bearing.law.clearance,
                base=rest.bearing_stiffness[number],
            )
            for number, place in enumerate(assembly.bearings)
            if isinstance(place.bearing.law, RingLaw)
        ),
    }
    if params["chi0"] or params["chi1"]:
        at = np.concatenate([assembly.at_gear(s)[:, [0, 1, 4]] for s in SHAFTS], axis=-1)
        parts["friction"] = np.stack(
            [kept.vector(at @ one) for one in assembly.frame.friction_columns]
        )
        parts["friction_at_pitch"] = by_order(params["chi0"])
        parts["friction_per_metre"] = by_order(params["chi1"])
    model = GearedModel(**(parts | changes))
    start = np.r_[kept.coordinates(rest.displacement), np.zeros(kept.size)]
    return model, start, kept


def moving_six(params: dict[str, Any], **changes: Any) -> tuple[GearedModel, Floats, Reduction]:
    """The truth's `six` in motion."""
    return moving(six(params), params, **changes)


def from_outputs(model: GearedModel, values: Any, rates: Any) -> Floats:
    """The state whose outputs, and their rates, are given; the outputs fix it."""
    q, v = (
        np.linalg.lstsq(model.outputs, np.asarray(one), rcond=None)[0] for one in (values, rates)
    )
    return np.r_[q, v]
