"""The quasi-static mesh cycle: from pair, operating points and choices to one labelled Dataset."""

from __future__ import annotations

import json
import warnings
from collections.abc import Sequence

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.vocabulary import STATUS, label
from thermogear.gears.contact import (
    entrainment_velocity,
    flank_radii,
    path_of_contact,
    sliding_velocity,
)
from thermogear.gears.deviations import Deviation, PitchError
from thermogear.gears.pair import GearPair
from thermogear.heat.expansion import base_circle_growth
from thermogear.heat.gearbox import body_radius
from thermogear.heat.losses import efficiency
from thermogear.heat.temperature import conduction_power, contact_temperature
from thermogear.mesh.clearance import clearance
from thermogear.mesh.elastic import ElasticPair, elastic_pair, mean_stiffness_of_body
from thermogear.mesh.friction_path import FrictionPath
from thermogear.mesh.mesh_heat import mesh_heat
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.mesh.thermal import HotPair, thesis_thermal_stiffness

Floats = NDArray[np.float64]
Variables = dict[str, tuple[tuple[str, ...], ArrayLike]]

PATH = ("operating", "path_position")
PHASE = ("operating", "mesh_phase")
POINT = ("operating",)


def mesh_cycle(
    pair: GearPair,
    operating: Operating,
    model: MeshModel | None = None,
    *,
    deviations: Sequence[Deviation] = (),
    path_positions: int = 201,
    mesh_positions: int = 512,
) -> xr.Dataset:
    """Everything quasi-static about ``pair`` at its operating points, in SI.

    Along the path of contact A..E of one tooth pair (``path_position`` s [m] from the pinion's
    tangent point): rolling and sliding velocities, load share, line load, Hertz contact,
    friction, flash and contact temperature, thermal growth of both flanks, and the springs of
    the pair. Over the mesh phase (0 where a pair enters at A): mesh stiffness, half backlash,
    kinematic error. Per operating point: normal force, mean and extreme stiffness, half backlash,
    jam temperature (the pinion's addendum, once when both gears warm alike beside a housing as it
    is, once when shafts and housing rise in proportion to them; nan where that never jams), and
    ``status``: ``ok``; ``jammed`` where the least half backlash over the phase is <= 0 (the values
    stay, for they say how far it is jammed); ``not_converged`` where the loaded contact did not
    settle. ``friction_coefficient_least`` and ``_greatest`` span the laws of oiled contacts that
    are within their range there, ``friction_outside_range`` is 1 where the chosen one is not, and
    ``film_outside_range`` where the film forms beyond the range of the oil's viscosity line.
    ``edge_contact`` names the tip corner that carries along the path, where the pressure
    is nan; ``edge_contact_share`` is the share of the mesh period with such a corner, beyond A
    and E too, nan where the stiffness model knows none.

    ``deviations`` of the flanks (relief, profile, ...) enter the loaded contact and the clearance
    (:func:`~thermogear.mesh.clearance.clearance`); the cold half backlash is that of the flanks
    without them. The cycle is one mesh period: pitch errors, which differ from tooth to tooth,
    enter with the teeth of the first period alone, and a warning says so. ``model`` defaults to
    :meth:`MeshModel.consistent`. Zero torque gives zero contact and flash; zero speed gives
    zero flash; the pitch point has its limit values. Warns outside the ranges of the sources;
    raises InputError for fewer than 2 positions.
    """
    for name, count in (("path_positions", path_positions), ("mesh_positions", mesh_positions)):
        if count < 2:
            raise InputError(name, count, allowed=">= 2")
    if any(isinstance(d, PitchError) and np.ptp(d.errors) > 0.0 for d in deviations):
        warnings.warn(
            "pitch errors: the mesh cycle holds one mesh period, in which the first teeth alone "
            "stand; ask loaded_contact for phases of a whole revolution",
            ValidityWarning,
            stacklevel=2,
        )
    hot = HotPair(pair, operating, MeshModel.consistent() if model is None else model)
    elastic = elastic_pair(hot, deviations)
    s = path_of_contact(pair, path_positions)
    phase = np.arange(mesh_positions) / mesh_positions

    variables: Variables = {}
    path = FrictionPath(elastic, s)
    variables |= _contact(path)
    variables |= _deformation(hot, s)
    variables |= {name: (PATH, k) for name, k in elastic.parts(s).items()}
    variables["pair_stiffness"] = (PATH, elastic.pair_stiffness(s))
    variables |= _mesh(hot, elastic, phase)
    status = np.where(path.settled, variables["status"][1], STATUS.index("not_converged"))
    variables["status"] = (POINT, status)

    r1, r2 = flank_radii(pair, s)
    points = pair.path
    return label(
        variables,
        {
            "pinion_speed": (POINT, operating.speed),
            "pinion_torque": (POINT, operating.torque),
            "path_position": (("path_position",), s),
            "pinion_radius": (("path_position",), r1),
            "wheel_radius": (("path_position",), r2),
            "mesh_phase": (("mesh_phase",), phase),
        },
        {
            "bundle": hot.model.name,
            "choices": json.dumps(hot.model.choices()),
            "path_points": json.dumps({k.upper(): v for k, v in points._asdict().items()}),
            "contact_ratio": pair.contact_ratio,
        },
    )


def _contact(path: FrictionPath) -> Variables:
    """Kinematics, load, Hertz contact, film, friction and flash along the path."""
    hot, s = path.hot, path.s
    pair, speed = hot.pair, hot.operating.speed[:, None]
    v1, v2 = path.velocities
    first, second = path.body_temperatures
    flash = path.flash(path.friction)
    least, greatest = path.band
    found: dict[str, ArrayLike] = {
        "pinion_rolling_velocity": v1,
        "wheel_rolling_velocity": v2,
        "sliding_velocity": sliding_velocity(pair, speed, s),
        "entrainment_velocity": entrainment_velocity(pair, speed, s),
        "load_share": path.share,
        "line_load": path.line_load,
        "hertz_half_width": path.half_width,
        "hertz_pressure": np.where(path.edge > 0, np.nan, path.pressure),
        "film_thickness": path.film,
        "film_parameter": path.film_parameter,
        "friction_coefficient": path.friction,
        "friction_coefficient_mixed": path.mixed,
        "friction_coefficient_dry": path.dry,
        "friction_coefficient_least": least,
        "friction_coefficient_greatest": greatest,
        "flash_temperature": flash,
        "flash_temperature_mixed": path.flash(path.mixed),
        "flash_temperature_dry": path.flash(path.dry),
        "pinion_heat_share": path.heat_share,
        "contact_temperature": contact_temperature(
            flash, path.heat_share, bulk_1=first, bulk_2=second
        ),
        "pinion_body_temperature": first,
        "wheel_body_temperature": second,
    }
    shape, known = (hot.count, s.size), path.settled[:, None]
    variables: Variables = {
        name: (PATH, np.where(known, np.broadcast_to(np.asarray(values), shape), np.nan))
        for name, values in found.items()
    }
    means = mesh_heat(path.elastic)
    power, share, beyond, conductance = (
        np.where(means.settled, values, np.nan)
        for values in (means.power, means.partition, means.beyond, means.conductance)
    )
    variables |= {
        "edge_contact": (PATH, path.edge),
        "friction_outside_range": (
            PATH,
            np.broadcast_to(path.outside, shape).astype(np.int8),
        ),
        "film_outside_range": (POINT, path.beyond_oil.astype(np.int8)),
        "reduced_radius": (("path_position",), path.radius),
        "normal_force": (POINT, path.elastic.force),
        "dynamic_viscosity": (POINT, path.viscosity[:, 0]),
        "frictional_power": (POINT, power),
        "pinion_share_of_heat": (POINT, share),
        "power_off_the_path": (POINT, beyond),
        "flank_conductance": (POINT, conductance),
        "mesh_efficiency": (
            POINT,
            efficiency(power=hot.operating.speed * hot.operating.torque, loss=power),
        ),
    }
    return variables


def _deformation(hot: HotPair, s: Floats) -> Variables:
    """Growth of both flanks along the path, and what the assumed fields imply."""
    pair, operating = hot.pair, hot.operating
    first, second = hot.growth(s)
    variables: Variables = {
        "pinion_deformation": (PATH, first),
        "wheel_deformation": (PATH, second),
        "deformation_sum": (PATH, first + second),
    }
    t = operating.temperatures
    for name, gear, bore, body, tip in (
        ("pinion", pair.pinion, t.pinion_bore, t.pinion_body, t.pinion_addendum),
        ("wheel", pair.wheel, t.wheel_bore, t.wheel_body, t.wheel_addendum),
    ):
        # what passes the body node enters the bore; without one the whole field carries it
        known = body is not None and hot.model.flank != "thesis"
        growth = base_circle_growth(gear, hot.field(gear), hot.model.bore)
        variables[f"{name}_base_growth"] = (POINT, np.broadcast_to(growth.ravel(), (hot.count,)))
        power = conduction_power(
            bore_radius=gear.bore_radius,
            tip_radius=body_radius(gear) if known else gear.tip_radius,
            bore_temperature=bore,
            addendum_temperature=tip if body is None or not known else body,
            conductivity=gear.material.thermal_conductivity,
            face_width=gear.face_width,
        )
        variables[f"{name}_shaft_heat"] = (POINT, np.broadcast_to(power, (hot.count,)))
    return variables


def _mesh(hot: HotPair, elastic: ElasticPair, phase: Floats) -> Variables:
    """Stiffness and backlash over the mesh phase, with the figures made of them."""
    k, error, loaded_error, edge_share = elastic.over(phase)
    thermal = (
        thesis_thermal_stiffness(hot, phase, elastic.pair_stiffness)
        if hot.model.thermal_stiffness == "thesis"
        else np.zeros_like(k)
    )
    total = k + thermal
    backlash = clearance(hot, phase, elastic.deviations)
    least = backlash.half_backlash.min(axis=1)
    status = np.where(least > 0.0, STATUS.index("ok"), STATUS.index("jammed"))
    rim, clamped = (mean_stiffness_of_body(elastic, phase, b) for b in ("rim", "bore-clamped"))
    known = np.isfinite(total).all(axis=1) & np.isfinite(rim) & np.isfinite(clamped)
    status[~known] = STATUS.index("not_converged")
    highest, lowest = total.max(axis=1), total.min(axis=1)
    return {
        "elastic_stiffness": (PHASE, k),
        "thermal_stiffness": (PHASE, thermal),
        "mesh_stiffness": (PHASE, total),
        "half_backlash_curve": (PHASE, backlash.half_backlash),
        "kinematic_error": (PHASE, backlash.error),
        "spring_error": (PHASE, backlash.error if error is None else error),
        "transmission_error": (PHASE, loaded_error),
        "mean_stiffness": (POINT, total.mean(axis=1)),
        "rim_stiffness": (POINT, rim),
        "bore_clamped_stiffness": (POINT, clamped),
        "peak_to_peak_stiffness": (POINT, highest - lowest),
        "mid_range_stiffness": (POINT, 0.5 * (highest + lowest)),
        # counted from the least, so that a constant gap keeps its last bit
        "half_backlash": (POINT, least + (backlash.half_backlash - least[:, None]).mean(axis=1)),
        "cold_half_backlash": (POINT, np.full(hot.count, hot.operating.half_backlash)),
        "least_half_backlash": (POINT, least),
        "jam_temperature": (POINT, backlash.jam_temperature),
        "proportional_jam_temperature": (POINT, backlash.proportional_jam_temperature),
        "edge_contact_share": (POINT, edge_share),
        "status": (POINT, status),
    }
