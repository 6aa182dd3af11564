"""The closed loop of friction and heat over speeds and torques: one map of everything hot."""

from __future__ import annotations

import json
import time
import warnings
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from thermogear.base.arrays import Floats
from thermogear.base.errors import ValidityWarning
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import (
    HEAT_NOT_SETTLED,
    REGIMES,
    STATUS,
    dressed,
    is_known,
    label,
    labelled,
)
from thermogear.case.case import GearCase
from thermogear.heat.film import regime_shares
from thermogear.heat.scuffing import scuffing_margin, scuffing_temperature
from thermogear.mesh.balance import HeatBalance
from thermogear.mesh.balance_table import balance_dataset, blanked
from thermogear.mesh.cycle import mesh_cycle
from thermogear.mesh.model import MeshModel
from thermogear.mesh.operating import Operating
from thermogear.results.beside import from_data
from thermogear.results.result import Notice, Result
from thermogear.study.declared import Temperature, declared
from thermogear.study.notices import heat_notices, jam_notices, turn_notices
from thermogear.study.scuffing import load_stage, not_steel

PATH_POSITIONS = 81
MESH_POSITIONS = 64
BLOCK = 60
"""Operating points that are solved together: progress and memory, not the result."""
GRID = ("pinion_speed", "pinion_torque")


@declared(Temperature)
def thermal_map(
    case: GearCase,
    speeds: Sequence[float] = Temperature.speeds,
    torques: Sequence[float] = Temperature.torques,
    *,
    progress: Progress = silent,
) -> Result:
    """Temperatures, films, flashes, backlash and scuffing margins over ``speeds`` x ``torques``.

    ``speeds`` [rad/s] > 0 and ``torques`` [N m] of the pinion. The first model of the case, its
    gearbox with the nodes it holds; other temperatures of the case are not used. Steady states
    alone: :func:`~thermogear.study.warm_up.warm_up_survey` has the way there.

    Groups: ``map`` over (pinion_speed, pinion_torque), ``status`` per point (ok, jammed,
    no_oil_bath; not_converged, heat_not_settled: every number is nan) with ``iterations`` and
    ``residual``, and ``several`` where from hot another state is steady than the one told.
    """
    began = time.perf_counter()
    model = case.models[0]
    omega = np.repeat(np.asarray(speeds, dtype=float), len(torques))
    moment = np.tile(np.asarray(torques, dtype=float), len(speeds))
    shape = (len(speeds), len(torques))
    blocks = range(0, omega.size, BLOCK)
    points: list[xr.Dataset] = []
    for done, start in enumerate(blocks):
        progress("closed loop", done, len(blocks))
        part = slice(start, start + BLOCK)
        points.append(_points(case, model, omega[part], moment[part]))
    progress("closed loop", len(blocks), len(blocks))
    seconds = time.perf_counter() - began
    why = [r for part in points for r in json.loads(part.attrs["lost"]).values()]
    grid = _on_grid(xr.concat(points, "operating"), speeds, torques, shape)
    return Result.of(
        Temperature.kind,
        f"{_heading(grid)}: {case.title}",
        {"map": grid},
        _notices(case, grid, seconds, why),
        **case.provenance,
        bundle=model.name,
        choices=model.choices(),
        held={name: float(np.ravel(t)[0]) for name, t in case.gearbox.measured.items()},
        scuffing_load_stage=case.scuffing_load_stage,
        cold_half_backlash=case.cold_backlash.half,
        seconds=seconds,
    )


def _heading(grid: xr.Dataset) -> str:
    """What the page of a map, of a line or of one point of it is called."""
    axes = {"pinion_speed": "speed", "pinion_torque": "torque"}
    over = [words for name, words in axes.items() if grid.sizes[name] > 1]
    return f"Temperatures over {' and '.join(over)}" if over else "Temperatures"


def _points(case: GearCase, model: MeshModel, speed: Floats, torque: Floats) -> xr.Dataset:
    """Everything that the map shows, over ``operating``: of heat balance and mesh cycle."""
    with warnings.catch_warnings():
        # told once, with the number of points, in the notices
        warnings.filterwarnings("ignore", "(oil temperature|viscosity|film):", ValidityWarning)
        settled = case.balance_of(model, speed, torque)
        cycle = mesh_cycle(
            case.pair,
            settled.operating,
            model,
            deviations=case.deviations,
            path_positions=PATH_POSITIONS,
            mesh_positions=MESH_POSITIONS,
        )
        return _gathered(case, settled, cycle)


def _gathered(case: GearCase, settled: HeatBalance, cycle: xr.Dataset) -> xr.Dataset:
    data = balance_dataset(settled).drop_vars("heat_to_ambient")
    operating: Operating = settled.operating
    worst = ", worst tooth pair of the turn" * ("film_parameter_least_of_turn" in cycle)

    weight = cycle["line_load"] * np.abs(cycle["sliding_velocity"])
    friction = (cycle["friction_coefficient"] * weight).sum("path_position").values
    weighed = weight.sum("path_position").values
    contact = cycle["greatest_contact_temperature"].values
    stage, assumed = load_stage(case)
    margin = (
        np.full(contact.shape, np.nan)
        if assumed and not_steel(case)
        else scuffing_margin(limit=scuffing_temperature(stage), temperature=contact)
    )
    least = cycle["half_backlash_curve"].min("mesh_phase").values
    figures: Mapping[str, tuple[Any, str, str]] = {
        "mean_friction": (
            np.divide(friction, weighed, out=np.full(contact.shape, np.nan), where=weighed > 0.0),
            "1",
            "friction coefficient, mean by sliding power",
        ),
        "greatest_friction": (
            cycle["friction_coefficient"].max("path_position").values,
            "1",
            "greatest friction coefficient along the path",
        ),
        "greatest_flash": (
            cycle["greatest_flash_temperature"].values,
            "K",
            f"greatest flash temperature{worst}",
        ),
        "greatest_contact_temperature": (contact, "K", f"greatest contact temperature{worst}"),
        "scuffing_margin": (margin, "K", "scuffing temperature less contact temperature"),
        "least_film_parameter": (
            cycle["least_film_parameter"].values,
            "1",
            f"least film parameter{worst or ' along the path'}",
        ),
        "least_half_backlash": (least, "m", "least half backlash over the mesh phase"),
        "thermal_growth": (
            cycle["deformation_sum"].max("path_position").values,
            "m",
            "greatest normal growth of both flanks together",
        ),
    }
    along = ("operating",)
    variables = {name: dressed(along, *entry) for name, entry in figures.items()}
    for name in (
        "jam_temperature",
        "proportional_jam_temperature",
        "mesh_efficiency",
        "mean_stiffness",
    ):
        variables[name] = cycle[name].variable
    shares = regime_shares(cycle["film_parameter"].values)
    variables["regime_share"] = dressed(
        ("operating", "regime_name"), shares, "1", "share of the path"
    )
    merged = data.assign(variables)
    status = np.where(settled.settled, cycle["status"].values, HEAT_NOT_SETTLED)
    lost = ~is_known(status)
    merged["status"] = labelled("status", (along, status))
    low, high = operating.lubricant.temperature_range
    oil = np.asarray(operating.oil_temperature)
    hottest = case.pair.pinion.material.tempering_temperature
    teeth = np.asarray(operating.temperatures.pinion_addendum)
    valid = ~lost & (oil >= low) & (oil <= high)
    merged["within_oil_range"] = dressed(
        along, valid.astype(np.int8), "1", "1 where the oil stays on its viscosity line"
    )
    merged["tempered"] = dressed(
        along, (~lost & (teeth > hottest)).astype(np.int8), "1", "1 where the steel is tempered"
    )
    return blanked(merged, lost).assign_coords(regime_name=list(REGIMES))


def _on_grid(
    whole: xr.Dataset, speeds: Sequence[float], torques: Sequence[float], shape: tuple[int, int]
) -> xr.Dataset:
    """The points with the axis ``operating`` unfolded into speed and torque."""
    flat = whole.drop_vars(list(GRID))
    variables = {}
    for name, variable in flat.variables.items():
        if "operating" not in variable.dims:
            continue
        front = variable.transpose("operating", ...)
        variables[str(name)] = xr.Variable(
            (*GRID, *front.dims[1:]), front.values.reshape(*shape, *front.shape[1:]), front.attrs
        )
    kept = {str(n): flat[n] for n in flat.coords}
    axes = {"pinion_speed": list(speeds), "pinion_torque": list(torques)}
    return label(variables, kept | axes)


def _notices(
    case: GearCase, grid: xr.Dataset, seconds: float, why: Sequence[str]
) -> Iterator[Notice]:
    status = grid["status"].values
    settled = is_known(status)
    count = status.size
    yield from heat_notices(grid, settled, why)
    yield from turn_notices(case)
    yield from from_data(grid)
    outside = settled & (grid["within_oil_range"].values == 0)
    low, high = case.stated.lubricant.temperature_range
    if outside.any():
        yield Notice.of(
            "oil_leaves_viscosity_line", outside=outside.sum(), points=count, range=[[low, high]]
        )
    teeth = grid["node_temperature"].sel(node=["pinion_tooth", "wheel_tooth"]).mean("node").values
    beyond = settled & (teeth > high)
    if beyond.any():
        yield Notice.of("flanks_beyond_oil", beyond=beyond.sum(), points=count, limit=high)
    jammed = int((status == STATUS.index("jammed")).sum())
    if jammed:
        yield Notice.of("points_jammed", count=jammed, points=count)
    elif settled.any():
        least = np.nanmin(grid["least_half_backlash"].values[settled])
        yield Notice.of("no_point_jams", settled=settled.sum(), points=count, half_backlash=least)
        yield from jam_notices(grid, case.stated.temperatures.reference)
    yield Notice.of("warm_up_elsewhere")
    stage, assumed = load_stage(case)
    other = not_steel(case)
    if assumed and other:
        yield Notice.of("no_scuffing_margin", material=other)
    elif assumed:
        yield Notice.of("scuffing_stage_assumed", stage=stage)
    yield Notice.of(
        "heat_balances_solved",
        points=count,
        seconds=seconds,
        iterations=grid["iterations"].values.max(),
        residual=np.max(grid["residual"].values[settled], initial=0.0),
    )
