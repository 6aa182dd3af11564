"""A run: from a case to the tree of labelled results that pages are drawn from.

The groups of the tree: ``path`` (along the path of contact), ``mesh`` (over the mesh phase, and
figures per operating point), ``flanks/...`` (where they are measured), ``balance`` (where the
temperatures are computed), ``profile``, ``motion``, ``train_motion`` (of a case
with shafts), ``dial`` (one point over gear temperatures), ``temperature`` (the same over gear
temperatures) and ``base_sets/...``; a dimensionless case has ``points`` alone.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitations
from thermogear.base.plan import Alive, keep_going
from thermogear.base.progress import Progress, asking, silent
from thermogear.base.vocabulary import (
    QUANTITIES,
    STATES,
    attributes,
    dressed,
    label,
    labelled,
)
from thermogear.case.base import Case
from thermogear.case.case import DimensionlessCase, GearCase, load_example
from thermogear.case.citations import citations
from thermogear.case.points import excitations, points_of
from thermogear.case.thermal_state import HOT, UNDEFORMED, ThermalState
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.dynamics.models import TorsionalModel
from thermogear.heat.film import regime
from thermogear.mesh.balance_table import balance_dataset
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.model import CHOICES
from thermogear.mesh.profile import profiles
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Notice, Result, now
from thermogear.study import run_notices
from thermogear.study.answers.survey import answered
from thermogear.study.answers.survey import groups as behind_answers
from thermogear.study.answers.survey import notices as answer_notices
from thermogear.study.dial import dial
from thermogear.study.drawing import drawn_points
from thermogear.study.measured_flanks import measured_flanks
from thermogear.study.motion import Motion, follow, follow_gears, still_values
from thermogear.study.shafts.sketch import sketch

MOST_KEPT = 1_000_000
"""Values of a curve over the mesh phases of a turn, all operating points together: 8 MB."""


def run(case: Case, *, progress: Progress = silent, alive: Alive = keep_going) -> Result:
    """Everything that ``case`` asks for (SI, units as attributes).

    ``alive`` is called wherever ``progress`` is and raises to end the work.

    A jammed operating point, one at whose temperatures a law has no value (nan), a motion that
    diverges or cannot be labelled is a status in the data, never an exception. Raises InputError
    where the case as a whole is impossible.
    """
    progress = asking(alive, progress)
    if isinstance(case, DimensionlessCase):
        groups: dict[str, Dataset] = {"points": _points(case, "motion", progress)}
        notices: Iterator[Notice] = run_notices.dimensionless_notices(groups["points"])
        own: dict[str, Any] = {}
    elif isinstance(case, GearCase):
        cycles = _cycles(case, progress)
        groups = _gear_groups(case, cycles, progress)
        cold, hot = (cycles[case.models[0].name].sel(state=state) for state in STATES)
        found, asked = answered(case, case.models[0], cold, hot, progress)
        groups |= {name: make() for name, make in behind_answers(asked).items()}
        told: list[Notice] = []
        if case.train is not None and "motion" in case.pictures:
            from thermogear.study.shafts.motion import train_motion

            groups["train_motion"], told = train_motion(case, progress=progress)
        notices = chain(run_notices.notices(case, groups), answer_notices(case, asked), told)
        own = {
            "facts": run_notices.facts(case, groups),
            "bundles": {model.name: model.choices() for model in case.models},
            "choices": {field: dict(names) for field, names in CHOICES.items()},
            "answers": [one.row for one in found],
        }
        if case.train is not None:
            own["train"] = sketch(case.train.drive_train(pair=case.pair), case.pair)
    else:
        raise InputError("case", type(case).__name__, allowed="GearCase or DimensionlessCase")
    return Result.of(
        case.kind,
        case.title,
        groups,
        notices,
        **case.provenance,
        thesis_case=of_the_thesis(case),
        created=now(),
        environment=run_notices.environment(platform.python_version()),
        assumptions=[
            {"field": a.field, "value": a.value, "reason": a.reason} for a in case.assumptions
        ],
        citations=citations(case),
        **own,
    )


# --- gear cases ---------------------------------------------------------------------------


def gear_motion(case: GearCase) -> Dataset:
    """The group ``motion`` of :func:`run` alone, and nothing else computed."""
    return _motion(case, _cycles(case, silent), "state", silent)


def _gear_groups(
    case: GearCase, cycles: Mapping[str, Dataset], progress: Progress
) -> dict[str, Dataset]:
    groups: dict[str, Dataset] = {}
    groups |= _split(_bundles(cycles))
    groups |= measured_flanks(case)
    first = cycles[case.models[0].name]["status"].sel(state="hot")
    drawn = drawn_points(case, first)
    if drawn is not None:
        groups["drawing"] = drawn
    if case.computed:
        groups["balance"] = balances(case)
    wanted = set(case.pictures)
    if "profile" in wanted:
        groups["profile"] = profiles(case.pair, case.operating, printed=of_the_thesis(case))
    if "motion" in wanted:
        groups["motion"] = _motion(case, cycles, "state", progress)
        alike, model = case.mean_tooth(), case.models[0]
        hot = cycles[model.name].sel(state="hot") if alike is case else HOT.cycle(alike, model)
        turned = dial(alike, hot, progress)
        if turned is not None:
            groups["dial"] = turned
    if "temperature" in wanted and case.gear_temperatures:
        groups["temperature"] = _temperature_row(case, progress)
    if "base-sets" in wanted and of_the_thesis(case):
        for name in case.base_sets:
            base = load_example(name)
            if isinstance(base, DimensionlessCase):
                groups[f"base_sets/{name}"] = _points(base, name, progress)
    return groups


def _joined(
    parts: Sequence[Dataset], name: str, places: ArrayLike, attrs: Any = "override"
) -> Dataset:
    """``parts`` along a new axis; ``attrs`` says what becomes of attributes, as in xarray."""
    import xarray as xr

    axis = xr.DataArray(np.asarray(places), dims=name, name=name)
    axis.attrs = attributes(name) if name in QUANTITIES else {}
    return xr.concat(list(parts), axis, combine_attrs=attrs)


def _bundles(cycles: Mapping[str, Dataset]) -> Dataset:
    return _joined(list(cycles.values()), "bundle", list(cycles), "drop_conflicts")


def _cycles(case: GearCase, progress: Progress) -> dict[str, Dataset]:
    """Bundle -> the cycle undeformed and hot, everything but the bodies' temperatures alike."""
    found: dict[str, Dataset] = {}
    for number, model in enumerate(case.models):
        progress("mesh cycle", number, len(case.models))
        states = [state.cycle(case, model) for state in (UNDEFORMED, HOT)]
        found[model.name] = _with_numbers(case, _joined(states, "state", list(STATES)))
    progress("mesh cycle", len(case.models), len(case.models))
    return found


def _with_numbers(case: GearCase, cycle: Dataset) -> Dataset:
    """``cycle`` with the dimensionless numbers of the equation of motion beside it.

    The leading axis is the state, "undeformed" first, or the gear temperature; thermal stiffness
    counts from the first of the axis unless the cycle carries the undeformed mean itself.
    """
    mass = case.equivalent_mass
    mean = cycle["mean_stiffness"].values
    turns = cycle["pinion_speed"].values / (2.0 * np.pi)
    mesh_frequency = np.broadcast_to(case.pair.pinion.teeth * turns, mean.shape)
    natural = np.sqrt(mean / mass) / (2.0 * np.pi)
    length = cycle["cold_half_backlash"].values
    lines = np.fft.rfft(cycle["mesh_stiffness"].values, axis=-1)
    harmonic = 2.0 * np.abs(lines[..., case.period.mesh_periods])
    samples = cycle.sizes["mesh_phase"]
    error = case.transmission_error.harmonics
    amplitude = abs(error[0]) if error else 0.0
    ratio = mesh_frequency / natural
    numbers = {
        "natural_frequency": natural,
        "mesh_frequency": mesh_frequency,
        "frequency_ratio": ratio,
        "damping_ratio": np.full(mean.shape, case.damping_ratio),
        "stiffness_amplitude": harmonic / samples / mean,
        "thermal_stiffness_ratio": mean / _cold_mean(cycle) - 1.0,
        "mean_force": cycle["normal_force"].values / (mean * length),
        "force_amplitude": amplitude / length * ratio**2,
        "half_backlash_ratio": cycle["half_backlash"].values / length,
    }
    dims = cycle["mean_stiffness"].dims
    return cycle.assign({name: labelled(name, (dims, v)) for name, v in numbers.items()})


def _cold_mean(cycle: Dataset) -> NDArray[np.float64]:
    if "cold_mean_stiffness" in cycle.attrs:
        return np.asarray(cycle.attrs["cold_mean_stiffness"])
    return np.asarray(cycle["mean_stiffness"].values[0])


def _split(whole: Dataset) -> dict[str, Dataset]:
    """The path's curves apart from the mesh's; kinematics that all bundles share once."""
    shared = [
        "pinion_rolling_velocity",
        "wheel_rolling_velocity",
        "sliding_velocity",
        "entrainment_velocity",
    ]
    for name in shared:
        whole[name] = whole[name].isel(bundle=0, state=0, drop=True)
    whole["reduced_radius"] = whole["reduced_radius"].isel(bundle=0, state=0, drop=True)
    springs = [str(n) for n in whole.data_vars if str(n).endswith("_stiffness")]
    along = [
        str(n) for n, v in whole.data_vars.items() if "path_position" in v.dims and n not in springs
    ]
    rest = [str(n) for n in whole.data_vars if n not in along]
    path = whole[along].drop_vars("mesh_phase", errors="ignore")
    film = path["film_parameter"]
    # a point without a film has no regime: a place that is no flag's
    known = ~np.isnan(film.values)
    acting = np.where(known, regime(np.where(known, film.values, 0.0)), -1)
    path["regime"] = labelled("regime", (film.dims, acting))
    return {"path": path, "mesh": _bounded(whole[rest])}


def _bounded(mesh: Dataset) -> Dataset:
    """``mesh`` with every so many-th position of a turn where it has more than it may keep.

    As many of each mesh period, first ones among them; all figures are made before.
    """
    if "mesh_periods" not in mesh.attrs:
        return mesh
    least = mesh["mesh_stiffness"].size / MOST_KEPT
    each = mesh.sizes["mesh_phase"] // mesh.attrs["mesh_periods"]
    step = next((n for n in range(1, each) if n >= least and each % n == 0), each)
    return mesh.isel(mesh_phase=slice(None, None, step))


def _motion(
    case: GearCase, cycles: Mapping[str, Dataset], axis: str, progress: Progress
) -> Dataset:
    """Motion of every bundle, place on ``axis`` and operating point, in SI."""
    first = next(iter(cycles.values()))
    every = [c.isel({axis: k}) for c in cycles.values() for k in range(c.sizes[axis])]
    points = points_of(Excitations.joined([excitations(case, cycle) for cycle in every]))
    stage = "motion" if axis == "state" else "motion over temperature"
    found = follow_gears(points, case.simulation, lambda done, total: progress(stage, done, total))
    dims = ("bundle", axis, "operating")
    shape = (len(cycles), first.sizes[axis], first.sizes["operating"])
    coordinates: dict[str, Any] = {
        "pinion_speed": (("operating",), first["pinion_speed"].values),
        "pinion_torque": (("operating",), first["pinion_torque"].values),
    }
    if found is None:
        lost = {n: (dims, v.reshape(shape)) for n, v in still_values(points.status).items()}
        data = label(lost, coordinates)
        return data.assign_coords({"bundle": list(cycles), axis: first[axis].values})
    mesh_frequency = case.pair.pinion.teeth * first["pinion_speed"].values / (2.0 * np.pi)
    motion = found.motion
    variables: dict[str, Any] = {
        "time": (("operating", "sample"), motion.phase / mesh_frequency[:, None]),
        "order": (("order",), motion.order),
        "line_frequency": (("operating", "order"), motion.order * mesh_frequency[:, None]),
    }
    for name, values in found.values.items():
        variables[name] = (dims + _last_axis(name), values.reshape(*shape, *values.shape[1:]))
    data = label(variables, coordinates, _motion_attributes(motion, case))
    return data.assign_coords({"bundle": list(cycles), axis: first[axis].values})


def _last_axis(name: str) -> tuple[str, ...]:
    if name.startswith("section"):
        return ("section",)
    if name in ("line_amplitude", "dte_line"):
        return ("order",)
    return ("sample",) if name.endswith(("displacement", "velocity")) and "peak" not in name else ()


def _motion_attributes(motion: Motion, case: Case) -> dict[str, Any]:
    return {
        "bin_width_orders": motion.bin_width,
        "window": "rectangular, whole mesh periods",
        "periods": motion.periods,
        "discarded": motion.discarded,
        **({"mesh_periods": motion.mesh_periods} if motion.mesh_periods > 1 else {}),
        "initial_state": list(case.simulation.initial_state),
    }


def _temperature_row(case: GearCase, progress: Progress) -> Dataset:
    """Figures and motion of both gears at each temperature of the row."""
    cycles: dict[str, Dataset] = {}
    temperatures = np.asarray(case.gear_temperatures)
    for model in case.models:
        row = [ThermalState.of(float(t)).cycle(case, model) for t in temperatures]
        drawn = case.cycle(UNDEFORMED.operating(case, model), model)
        reference = drawn["mean_stiffness"].values
        joined = _joined(row, "gear_temperature", temperatures)
        joined.attrs["cold_mean_stiffness"] = reference
        cycles[model.name] = _with_numbers(case, joined)
    motion = _motion(case, cycles, "gear_temperature", progress)
    motion["gear_temperature"].attrs = attributes("gear_temperature")
    figures = _bundles(cycles)
    scalars = [
        str(n)
        for n, v in figures.data_vars.items()
        if not {"path_position", "mesh_phase"} & set(v.dims) and n not in motion
    ]
    kept = figures[scalars].drop_vars(
        ["path_position", "mesh_phase", "pinion_radius", "wheel_radius"], errors="ignore"
    )
    kept.attrs = {}
    joined = kept.merge(motion, combine_attrs="override")
    return joined.assign_attrs(motion.attrs, housing=_housing(case))


def _housing(case: GearCase) -> str:
    """How the housing goes along with the gears: a name of ``views.captions.FOLLOWS``."""
    if case.follow == "proportional":
        return "proportional"
    if case.temperature_rule is not None:
        return "follows" if case.temperature_rule.housing.below else "stays"
    return "stays" if "housing" in case.gearbox.measured else "computed"


def balances(case: GearCase) -> Dataset:
    """The heat balance of every bundle of a case whose temperatures are computed."""
    each = [balance_dataset(case.balance(model)) for model in case.models]
    why = [json.loads(data.attrs.pop("lost")) for data in each]
    lost = dict(zip((model.name for model in case.models), why, strict=True))
    names = [model.name for model in case.models]
    whole = _joined(each, "bundle", names).assign_attrs(lost=json.dumps(lost))
    readings = [
        {
            "node": one.node,
            "kind": one.kind,
            "indicated_K": one.indicated,
            "temperature_K": one.temperature,
            "uncertainty_K": one.uncertainty,
        }
        for one in case.readings
    ]
    held = {name: float(np.ravel(t)[0]) for name, t in case.gearbox.measured.items()}
    if case.readings:
        whole["half_backlash_uncertainty"] = dressed(
            ("operating",),
            carried_uncertainty(case),
            "m",
            "standard uncertainty of the half backlash from the readings",
        )
    return whole.assign_attrs(readings=json.dumps(readings), held=json.dumps(held))


def carried_uncertainty(case: GearCase) -> NDArray[np.float64]:
    """Standard uncertainty [m] of the mean half backlash from the readings' own, (operating,).

    Each reading is moved by its standard uncertainty up and down, the heat balance solved anew,
    and the differences added in squares: first order, independent readings, the first model.
    0 without readings.
    """
    model, at = case.models[0], case.stated
    square = np.zeros(at.speed.size)
    phase = np.arange(16) / 16.0
    for one in case.readings:
        if one.uncertainty == 0.0:
            continue
        ends = []
        for sign in (1.0, -1.0):
            held = {**case.gearbox.measured, one.node: one.temperature + sign * one.uncertainty}
            box = replace(case.gearbox, measured=held)
            moved = case.balance_of(model, at.speed, at.torque, gearbox=box, from_hot=False)
            hot = HotPair(case.pair, moved.operating, model)
            gap = Clearance(hot, phase, case.deviations)
            ends.append(gap.half_backlash.mean(axis=1))
        square += (0.5 * (ends[0] - ends[1])) ** 2
    return np.sqrt(square)


# --- dimensionless cases ------------------------------------------------------------------


def _points(case: DimensionlessCase, stage: str, progress: Progress) -> Dataset:
    """Motion of every point of a dimensionless case."""
    columns = {
        name: np.array([point.model_arguments()[name] for point in case.points])
        for name in case.points[0].model_arguments()
    }
    model = TorsionalModel(**columns)
    motion = follow(model, case.simulation, lambda done, total: progress(stage, done, total))
    stored = {
        "damping_ratio": "damping_ratio",
        "frequency": "frequency_ratio",
        "stiffness_amplitude": "stiffness_amplitude",
        "mean_force": "mean_force",
        "force_amplitude": "force_amplitude",
        "half_backlash": "half_backlash_ratio",
        "thermal_stiffness": "thermal_stiffness_ratio",
    }
    variables: dict[str, Any] = {
        stored[name]: (("point",), values) for name, values in columns.items()
    }
    plain = {"displacement": "scaled_displacement", "velocity": "scaled_velocity"}
    texts: dict[str, Any] = {}
    for name, values in motion.values.items():
        if name.startswith("label"):
            texts[name] = (("point",), values)
            continue
        axis = _last_axis(name)
        variables[plain.get(name, name)] = (("point", *axis), values)
    variables["order"] = (("order",), motion.order)
    data = label(variables, None, _motion_attributes(motion, case))
    for name in (
        "section_displacement",
        "section_velocity",
        "line_amplitude",
        "half_order_amplitude",
        "peak_to_peak_displacement",
    ):
        data[name].attrs["units"] = "1"
    texts["row"] = (("point",), [point.row for point in case.points])
    texts["parameter"] = (("point",), [point.parameter for point in case.points])
    texts["expected"] = (("point",), [point.expected for point in case.points])
    data = data.assign(texts)
    data["value"] = (("point",), [point.value for point in case.points])
    data["value_unit"] = (("point",), [point.unit for point in case.points])
    data["phase"] = (
        ("sample",),
        motion.phase,
        {"units": "1", "long_name": "time in mesh periods", "symbol": "t/T"},
    )
    return data.assign_attrs(title=case.title)
