"""From a mesh cycle to what dynamics needs: one Excitation per operating point."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr

from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation, Periodic
from thermogear.base.vocabulary import STATUS
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair

NO_ERROR = Periodic(0.0)


def disc_inertia(gear: Gear, *, radius: float, bore_radius: float = 0.0) -> float:
    """I = pi rho b (R^4 - r_x^4)/2 [kg m^2] of a disc of the gear's material and face width.

    ``radius`` R [m] of the disc (pitch or tip radius), ``bore_radius`` r_x [m], 0 for a solid
    disc.
    """
    if not 0.0 <= bore_radius < radius:
        raise InputError("bore_radius", f"{bore_radius} m", allowed=f"0 <= r_x < {radius} m")
    density = gear.material.density
    return 0.5 * math.pi * density * gear.face_width * (radius**4 - bore_radius**4)


def excitation(
    cycle: xr.Dataset,
    pair: GearPair,
    *,
    damping_ratio: float,
    inertias: tuple[float, float] | None = None,
    transmission_error: Periodic = NO_ERROR,
    harmonics: int = 40,
) -> list[Excitation | None]:
    """The excitation of every operating point of ``cycle``; None where the pair is jammed.

    k(t) keeps ``harmonics`` harmonics of the mesh stiffness (thermal stiffness included where
    the model has one). e(t) is the kinematic ``transmission_error`` [m] plus the cycle's
    ``spring_error``, the error that belongs to that stiffness (deviations and heat in it), both
    over the mesh phase; the loaded transmission error never enters, so that elasticity is not
    counted twice.
    The half backlash is its mean over the phase, the length scale the cold one. ``inertias``
    [kg m^2] default to solid discs of pitch radius. Torques balance: T2 = T1 z2/z1.
    Raises for a speed of 0, where no mesh frequency exists.
    """
    speeds = np.asarray(cycle["pinion_speed"], dtype=float)
    if np.any(speeds <= 0.0):
        raise InputError(
            "operating.speed",
            "0 rpm",
            allowed="> 0 rpm for motion",
            why="nothing excites a pair that does not turn",
            fix="raise the speed or leave motion out",
        )
    if inertias is None:
        inertias = (
            disc_inertia(pair.pinion, radius=pair.pinion.pitch_radius),
            disc_inertia(pair.wheel, radius=pair.wheel.pitch_radius),
        )
    found: list[Excitation | None] = []
    for point, speed in enumerate(speeds):
        here = cycle.isel(operating=point)
        if STATUS[int(here["status"])] != "ok":
            found.append(None)
            continue
        torque = float(here["pinion_torque"])
        stiffness = Periodic.from_samples(here["mesh_stiffness"].values, harmonics)
        heat = Periodic.from_samples(here["spring_error"].values, harmonics)
        found.append(
            Excitation(
                stiffness=stiffness,
                error=transmission_error + heat,
                half_backlash=float(here["half_backlash"]),
                reference_half_backlash=float(here["cold_half_backlash"]),
                mean_force=torque / pair.pinion.base_radius,
                mesh_frequency=pair.pinion.teeth * float(speed),
                inertias=inertias,
                base_radii=(pair.pinion.base_radius, pair.wheel.base_radius),
                torques=(torque, torque * pair.ratio),
                damping_ratio=damping_ratio,
            )
        )
    return found
