"""The chain from friction to stiffness as the claims of sections 2 and 3 need it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.display import SPEED
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.one_point import of_case
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.models import PairModel, from_excitation
from thermogear.gears.contact import flank_radii, path_of_contact, rolling_velocities
from thermogear.gears.stiffness import mesh_figures
from thermogear.heat.expansion import RadialField, radial_displacement
from thermogear.mesh.balance import heat_balance
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Temperatures

PRINTED_MIDDLE, PRINTED_SWING = 4.875e8, 2.75e8
"""The two stiffness figures [N/m] that the document prints in section 3.2."""
SPEEDS = (500.0, 3000.0)
TORQUES = (50.0, 200.0)


def operating_grid(case: GearCase, *, speeds: int = 6, torques: int = 5) -> Dataset:
    """Friction, flash and growth over speed and torque, with two states of the bodies.

    ``given``: the case's temperatures at every point; ``balance``: what the closed loop of losses
    and heat flow leads to. Over (thermal, pinion speed, pinion torque): ``friction`` the mean
    along the path, ``flash`` the highest, both mixed and dry, ``growth`` of both flanks the mean,
    ``gear_temperature`` of the pinion's addendum.
    """
    omega = SPEED.stored(np.linspace(*SPEEDS, speeds))
    moment = np.linspace(*TORQUES, torques)
    flat = np.repeat(omega, torques), np.tile(moment, speeds)
    # the document's mixed friction, as far as it can be read, feeds the loop too
    model = MeshModel.consistent().override(friction="benedict-kelley")
    given = replace(case.operating, speed=flat[0], torque=flat[1])
    closed = heat_balance(
        case.pair,
        *flat,
        case.operating.lubricant,
        case.operating.half_backlash,
        model,
        reference=case.operating.temperatures.reference,
        housing=case.housing,
    )
    states = {"given": given, "balance": closed.operating}
    rows: dict[str, list[Floats]] = {}
    for operating in states.values():
        cycle = mesh_cycle(case.pair, operating, model, path_positions=101, mesh_positions=16)
        tip = np.asarray(operating.temperatures.pinion_addendum, dtype=float)
        found = {
            "friction_mixed": cycle["friction_coefficient_mixed"].values.mean(axis=1),
            "friction_dry": cycle["friction_coefficient_dry"].values.mean(axis=1),
            "flash_mixed": cycle["flash_temperature_mixed"].values.max(axis=1),
            "flash_dry": cycle["flash_temperature_dry"].values.max(axis=1),
            "growth": cycle["deformation_sum"].values.mean(axis=1),
            "gear_temperature": np.broadcast_to(tip, flat[0].shape),
        }
        for name, values in found.items():
            rows.setdefault(name, []).append(np.reshape(values, (speeds, torques)))
    units = {"growth": "m", "gear_temperature": "K", "flash_mixed": "K", "flash_dry": "K"}
    words = {
        "friction_mixed": "mean friction coefficient, mixed",
        "friction_dry": "mean friction coefficient, dry",
        "flash_mixed": "highest flash temperature, mixed",
        "flash_dry": "highest flash temperature, dry",
        "growth": "mean growth of both flanks",
        "gear_temperature": "pinion addendum temperature",
    }
    dims = ("thermal", "speed", "torque")
    data = label(
        {
            name: (dims, np.stack(values), units.get(name, "1"), words[name])
            for name, values in rows.items()
        },
        {
            "thermal": list(states),
            "speed": ("speed", omega, "rad/s"),
            "torque": ("torque", moment, "N m"),
        },
    )
    settled = np.reshape(closed.settled, (speeds, torques))
    return data.assign(settled=(("speed", "torque"), settled.astype(np.int8)))


def correlations(grid: Dataset, thermal: str, kind: str = "mixed") -> dict[str, float]:
    """Pearson's correlations of friction, flash and growth over the grid (nan: one is constant)."""
    here = grid.sel(thermal=thermal)
    rows = {
        "friction": here[f"friction_{kind}"].values.ravel(),
        "flash": here[f"flash_{kind}"].values.ravel(),
        "growth": here["growth"].values.ravel(),
    }
    found = {}
    for first, second in (("friction", "flash"), ("flash", "growth"), ("friction", "growth")):
        a, b = rows[first], rows[second]
        flat = min(np.ptp(a) / np.abs(a).max(), np.ptp(b) / np.abs(b).max()) < 1e-9
        found[f"{first}-{second}"] = math.nan if flat else float(np.corrcoef(a, b)[0, 1])
    return found


def rolling_by_radius(case: GearCase) -> tuple[float, float]:
    """Greatest relative difference of omega r sin(alpha) from the rolling speeds, per flank."""
    pair = case.pair
    s = path_of_contact(pair, 101)
    speed = float(case.speeds[0])
    found = []
    for gear, radius, rolling, omega in zip(
        (pair.pinion, pair.wheel),
        flank_radii(pair, s),
        rolling_velocities(pair, speed, s),
        (speed, speed / pair.ratio),
        strict=True,
    ):
        printed = omega * radius * np.sin(gear.pressure_angle_at(radius))
        found.append(float(np.max(np.abs(printed / rolling - 1.0))))
    return found[0], found[1]


def conduction_balance(case: GearCase) -> float:
    """Largest relative change of the heat flow r dT/dr of the printed field along the pinion."""
    gear, t = case.pair.pinion, case.operating.temperatures
    r = np.linspace(gear.bore_radius, gear.tip_radius, 4001)
    ln = np.log
    tip, bore = float(np.ravel(t.pinion_addendum)[0]), float(np.ravel(t.pinion_bore)[0])
    printed = (ln(gear.bore_radius) - ln(r)) / (ln(gear.bore_radius) - ln(gear.tip_radius))
    field = printed * (tip - bore) + bore
    flow = 0.5 * (r[1:] + r[:-1]) * np.diff(field) / np.diff(r)
    return float(np.ptp(flow) / abs(flow.mean())) if tip != bore else 0.0


def tip_displacement(case: GearCase, gear_temperature: float) -> tuple[float, float]:
    """(radial, half circumferential) displacement [m] of the pinion's tip corner."""
    gear = case.pair.pinion
    t = case.operating_at(gear_temperature).temperatures
    field = RadialField(
        bore_radius=gear.bore_radius,
        tip_radius=gear.tip_radius,
        bore_temperature=t.pinion_bore,
        addendum_temperature=t.pinion_addendum,
        reference=t.reference,
    )
    radial = radial_displacement(
        field,
        gear.tip_radius,
        root_radius=gear.root_radius,
        expansion=gear.material.thermal_expansion,
        poisson=gear.material.poisson_ratio,
    )
    psi = float(gear.half_thickness_angle(gear.tip_radius))
    strain = gear.material.thermal_expansion * float(field.rise(gear.tip_radius))
    return float(radial), gear.tip_radius * psi * strain


def uniform_change(case: GearCase, temperature: float) -> tuple[float, float]:
    """(backlash, stiffness at constant E): relative change with everything at ``temperature``.

    An all-warm pair only swells: neither may change, whatever a spring k_T would add.
    """
    model = MeshModel.consistent().override(modulus="constant")
    reference = case.operating.temperatures.reference
    found = []
    for at in (reference, temperature):
        operating = replace(
            case.operating.point(0), temperatures=Temperatures.uniform(at, reference=reference)
        )
        cycle = mesh_cycle(case.pair, operating, model, path_positions=3, mesh_positions=64)
        found.append((float(cycle["half_backlash"][0]), float(cycle["mean_stiffness"][0])))
    (b0, k0), (b1, k1) = found
    return b1 / b0 - 1.0, k1 / k0 - 1.0


def thermal_springs(case: GearCase, temperatures: Floats) -> tuple[Floats, Floats]:
    """The thesis's mean k_T [N/m] and elastic k [N/m] at gear ``temperatures`` [K]."""
    rows = []
    for temperature in temperatures:
        operating = case.operating_at(float(temperature)).point(0)
        cycle = mesh_cycle(
            case.pair, operating, MeshModel.thesis(), path_positions=3, mesh_positions=64
        )
        rows.append([float(cycle[n].mean()) for n in ("thermal_stiffness", "elastic_stiffness")])
    springs, elastic = np.array(rows).T
    return springs, elastic


def thermal_spring_over_torque(case: GearCase, torques: Floats) -> Floats:
    """The thesis's mean k_T [N/m] of the hot pair over pinion ``torques`` [N m]."""
    operating = replace(
        case.operating,
        speed=np.full(torques.size, case.speeds[0]),
        torque=torques,
    )
    cycle = mesh_cycle(
        case.pair, operating, MeshModel.thesis(), path_positions=3, mesh_positions=64
    )
    return np.asarray(cycle["thermal_stiffness"].values.mean(axis=1))


def width_of_printed_stiffness(case: GearCase) -> dict[str, float]:
    """The face width at which the textbook curve has the printed mid-range, and its figures there.

    The textbook stiffness is proportional to the width.
    """
    figures = mesh_figures(case.pair)
    middle = 0.5 * (figures.maximum + figures.minimum)
    swing = figures.maximum - figures.minimum
    scale = PRINTED_MIDDLE / middle
    return {
        "width": case.pair.face_width * scale,
        "middle": middle,
        "swing": swing,
        "mean": figures.mean,
        "swing_at_width": swing * scale,
        "mean_at_width": figures.mean * scale,
        "minimum": figures.minimum,
        "maximum": figures.maximum,
    }


def two_gears_against_one(case: GearCase, periods: int = 6) -> dict[str, float]:
    """The two rotations integrated as they stand against the single equation, from one start.

    ``difference``: largest |x| difference over the cold half backlash; ``momentum``: largest
    change of I1 omega1/r_b1 + I2 omega2/r_b2 over its parts' size; ``length``, ``rate``: scales.
    """
    point = of_case(case, operating=len(case.speeds), bundle=case.models[0].name)
    found = point.excitation()
    pair = PairModel.from_excitation(found)
    length, rate = found.reference_half_backlash, found.natural_frequency
    start = pair.start(x=length, v=0.0)
    whole = simulate(
        pair, periods=periods, discard=0, samples_per_period=64, initial_state=start,
        method="adaptive",
    )  # fmt: skip
    single = simulate(
        from_excitation(found), periods=periods, discard=0, samples_per_period=64,
        initial_state=(1.0, 0.0),
    )  # fmt: skip
    x = whole["x"].values[0]
    parts = [
        i * whole[name].values[0] / r
        for i, name, r in zip(pair.inertias, ("omega1", "omega2"), pair.base_radii, strict=True)
    ]
    total = parts[0] + parts[1]
    return {
        "difference": float(np.max(np.abs(x / length - single["x"].values[0]))),
        "momentum": float(np.ptp(total) / np.abs(parts[0]).max()),
        "length": length,
        "rate": rate,
    }
