"""Natural frequencies over speed, the orders that excite them, and the speeds where both meet."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from thermogear.base.arrays import Complexes, Dataset, Floats
from thermogear.base.errors import InputError
from thermogear.base.progress import Progress, silent
from thermogear.base.units import RPM
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.shaft_plan import TrainPlan
from thermogear.results.result import Notice, Result
from thermogear.shafts.linear import (
    LinearTrain,
    Modes,
    damping_ratios,
    lift_off,
    resonant_forces,
    strain_shares,
)
from thermogear.shafts.response import (
    Response,
    error_response,
    run_out_error,
    unbalance_pull,
    unbalance_response,
)
from thermogear.shafts.train import SHAFTS
from thermogear.study.declared import Campbell, declared
from thermogear.study.shafts.modes import bearing_parts, name_of
from thermogear.study.shafts.sketch import sketch
from thermogear.study.shafts.state import TrainState, plan_of, settled
from thermogear.study.shafts.statics import notices

SPEEDS = 9
"""Speeds at which the natural frequencies are computed; they change little in between."""
FINE = 240
"""Speeds of the response."""
MESH_HARMONICS = 3
FASTEST = 500_000 * RPM
"""No pinion turns faster [rad/s]."""
LEVELS = ("least", "mean", "greatest")


@dataclass(frozen=True, kw_only=True)
class Order:
    """What excites the train ``order`` times a turn of the pinion: a mesh, a shaft or a bearing."""

    name: str
    order: float
    kind: str
    parts: tuple[str, ...]


def orders_of(case: GearCase) -> list[Order]:
    """Mesh harmonics, both shafts and the elements of every rolling bearing passing the load."""
    pair = case.pair
    z1, ratio = pair.pinion.teeth, pair.pinion.teeth / pair.wheel.teeth
    found = [
        Order(
            name="mesh" if h == 1 else f"{h} x mesh",
            order=float(h * z1),
            kind="mesh",
            parts=("mesh",),
        )
        for h in range(1, MESH_HARMONICS + 1)
    ]
    found += [
        Order(name=f"{shaft} shaft", order=turns, kind="shaft", parts=(shaft,))
        for shaft, turns in zip(SHAFTS, (1.0, ratio), strict=True)
    ]
    for name, shaft, passing in plan_of(case).passing_orders:
        turns = passing * (1.0 if shaft == SHAFTS[0] else ratio)
        same = [one for one in found if one.kind == "bearing" and one.order == turns]
        parts = (*(same[0].parts if same else ()), name)
        found = [one for one in found if one not in same]
        words = f"elements of {' and '.join(parts)}"
        found.append(Order(name=words, order=turns, kind="bearing", parts=parts))
    return found


@dataclass(frozen=True, kw_only=True)
class Critical:
    """A speed [rad/s] of the pinion at which an ``order`` meets a mode of ``frequency`` [rad/s].

    ``force`` [N]: the greatest dynamic one on a bearing there, by this mode alone; nan where a
    bearing lifts off or the teeth part, by the linear force from the speed ``lift_off`` [rad/s] on.
    """

    speed: float
    frequency: float
    order: str
    mode: int
    mostly: str
    force: float
    lift_off: float


def critical_speeds(case: GearCase, state: TrainState, highest: float) -> list[Critical]:
    """Where mesh and shaft orders meet modes up to ``highest`` [rad/s], at mean stiffness."""
    rings, found = bearing_parts(case), []
    for order in orders_of(case):
        if order.kind == "bearing":
            continue
        rows, shapes = _critical(plan_of(case), state, state.linear, order)
        speeds, _, _, forces, lifts = rows
        parts = strain_shares(state.linear, shapes)
        for mode in range(int(np.sum(speeds <= highest))):
            here = {name: float(value[mode]) for name, value in parts.items()}
            found.append(
                Critical(
                    speed=float(speeds[mode]),
                    frequency=float(speeds[mode] * order.order),
                    order=order.name,
                    mode=mode + 1,
                    mostly=name_of(here, rings),
                    force=float(forces[mode]),
                    lift_off=float(lifts[mode]),
                )
            )
    return found


@declared(Campbell)
def campbell(
    case: GearCase,
    *,
    speeds: tuple[float, float] | None = None,
    torque: float | None = None,
    count: int = Campbell.count,
    progress: Progress = silent,
) -> Result:
    """Natural frequencies over the pinion's speed, critical speeds and forced response.

    ``speeds`` (from, to) [rad/s], 0 to 1.5 times the case's greatest if left out; ``torque`` [N m]
    of the pinion, the hardest point's; ``count`` modes. Undeformed and hot as that point is, with
    its bearings' stiffness; the mesh at its least, mean and greatest stiffness. Groups:
    ``campbell`` over (state, stiffness_level, pinion_speed, mode); ``critical`` over (state,
    stiffness_level, line, mode) with the participation of the mode; ``response`` over (state,
    line, response_speed, ...). Raises InputError for a case without shafts.
    """
    at = case.stated
    place = int(np.argmax(at.speed * at.torque))
    if torque is not None:
        case = case.with_values({"torque": torque})
        place = int(np.argmax(case.stated.speed * case.stated.torque))
    low, high = (0.0, 1.5 * float(at.speed.max())) if speeds is None else speeds
    if not 0.0 <= low < high <= FASTEST:
        raise InputError(
            "speeds",
            f"{low / RPM:.6g}:{high / RPM:.6g} rpm",
            allowed="0 <= LOW < HIGH <= 500000 rpm",
        )
    found = [row[0] for row in settled(case, [place], progress=progress)]
    count = min(count, found[0].linear.basis.shape[1])
    grid = np.linspace(low, high, SPEEDS)
    orders = orders_of(case)
    rings = bearing_parts(case)
    plan = plan_of(case)
    curves, responses, names, met = [], [], [], []
    fine = np.linspace(max(low, high / FINE), high, FINE)
    for number, state in enumerate(found):
        trains = [state.rest.linear(k) for k in state.band]
        curve, kept = [], []
        for level, train in enumerate(trains):
            progress("campbell", number * (len(trains) + 1) + level, 2 * (len(trains) + 1))
            followed = _followed(train, grid, count)
            curve.append([m.frequency for m in followed])
            kept.append(followed)
        curves.append(curve)
        names.append([_name(trains[1], kept[1][0], mode, rings) for mode in range(count)])
        met.append(
            [[_first(_critical(plan, state, t, one)[0], count) for one in orders] for t in trains]
        )
        progress("campbell", number * (len(trains) + 1) + len(trains), 2 * (len(trains) + 1))
        responses.append(_responses(case, state, fine, orders))
    progress("campbell", 1, 1)
    lines: dict[str, Any] = {
        "line": [one.name for one in orders],
        "order": (("line",), [one.order for one in orders], "1", "per turn of the pinion"),
    }
    states = [one.state.kind for one in found]
    levels, shares, gains, forces, lifts = np.moveaxis(np.array(met), 3, 0)
    numbered = (("mode",), np.arange(1, count + 1), "1", "number of the mode")
    level_names = {"state": states, "stiffness_level": list(LEVELS), "mode": numbered}
    return Result.of(
        Campbell.kind,
        f"Campbell diagram: {case.title}",
        {
            "campbell": label(
                {
                    "natural_frequency": (
                        ("state", "stiffness_level", "pinion_speed", "mode"),
                        curves,
                        "rad/s",
                        "natural frequency",
                    ),
                    "mode_name": (("state", "mode"), names),
                },
                level_names | {"pinion_speed": (("pinion_speed",), grid)},
            ),
            "critical": label(
                {
                    "critical_speed": (
                        ("state", "stiffness_level", "line", "mode"),
                        levels,
                        "rad/s",
                        "speed of the pinion at which the order meets the mode",
                    ),
                    "participation": (
                        ("state", "stiffness_level", "line", "mode"),
                        shares,
                        "1",
                        "how much of the mode the order can drive",
                    ),
                    "amplification": (
                        ("state", "stiffness_level", "line", "mode"),
                        gains,
                        "1",
                        "participation over twice the damping ratio: how far the resonance rises",
                    ),
                    "resonant_force": (
                        ("state", "stiffness_level", "line", "mode"),
                        forces,
                        "N",
                        "greatest dynamic force on a bearing at the resonance, by this mode alone",
                    ),
                    "lift_off_speed": (
                        ("state", "stiffness_level", "line", "mode"),
                        lifts,
                        "rad/s",
                        "speed from which the mode lifts a bearing off or parts the teeth",
                    ),
                },
                level_names | lines,
            ),
            "response": _response_table(case, states, fine, responses),
        },
        [*notices(case, [[one] for one in found]), Notice.of("linear_about_rest")],
        **case.provenance,
        bundle=case.models[0].name,
        speeds=[float(s) for s in at.speed],
        torque=found[0].torque,
        band=[list(one.band) for one in found],
        train=sketch(plan_of(case).drive_train(pair=case.pair), case.pair),
    )


def _followed(train: LinearTrain, grid: Floats, count: int) -> list[Modes]:
    """The ``count`` lowest modes at the first speed, each followed by its shape."""
    ahead = min(count + 6, train.basis.shape[1])
    found = [_taken(train.modes(float(grid[0]), count=ahead), slice(0, count))]
    for speed in grid[1:]:
        here = train.modes(float(speed), count=ahead)
        last = found[-1]
        near = np.abs(
            np.outer(last.frequency, here.frequency)
            * (last.shape.conj().T @ train.assembly.mass @ here.shape)
            + last.shape.conj().T @ train.stiffness @ here.shape
        )
        _, chosen = linear_sum_assignment(-near)
        found.append(_taken(here, chosen))
    return found


def _taken(modes: Modes, which: Any) -> Modes:
    return Modes(
        frequency=modes.frequency[which],
        shape=modes.shape[:, which],
        damping_ratio=modes.damping_ratio[which],
    )


def _name(train: LinearTrain, modes: Modes, place: int, rings: Mapping[str, str]) -> str:
    shares = strain_shares(train, modes.shape[:, place : place + 1])
    return name_of({name: float(value[0]) for name, value in shares.items()}, rings)


def pushes(plan: TrainPlan, state: TrainState, order: Order, frequency: Floats) -> Complexes:
    """What an order pushes with at ``frequency`` [rad/s], (frequency, n); nan where unknown.

    Mesh harmonics by the loaded error, shafts by unbalance and run-out; how elements shake their
    ring no table says.
    """
    train = state.assembly
    if order.kind == "bearing":
        return np.full((frequency.size, train.size), np.nan, complex)
    through = state.linear.mesh + 1j * frequency * state.linear.mesh_damping
    if order.kind == "mesh":
        errors, harmonic = state.loaded_error, round(order.order / train.frame.teeth[0])
        error = complex(errors[harmonic - 1]) if harmonic <= errors.size else 0j
        return np.asarray(np.multiply.outer(through * error, train.drive))
    (shaft,) = order.parts
    error = sum((run_out_error(train, r) for r in plan.run_outs if r.shaft == shaft), 0j)
    pull = unbalance_pull(train, shaft, plan.unbalances)
    whole = np.multiply.outer(through * error, train.drive)
    return np.asarray(whole + np.multiply.outer(frequency**2, pull))


def _critical(
    plan: TrainPlan, state: TrainState, train: LinearTrain, order: Order
) -> tuple[Floats, Complexes]:
    """Speeds, participations, amplifications, bearing forces, lift-off, (5, found); shapes.

    Speeds [rad/s], forces [N]. An undamped mode has infinite amplification, or nan where the order
    does not drive it. The linear train holds while the dynamic force stays below the static load
    in every bearing, and in the teeth. Beyond, the force is nan and the lift-off a speed.
    """
    speed, shape = train.critical(order.order)
    w = speed * order.order
    forces = resonant_forces(train, shape, frequency=w, force=pushes(plan, state, order, w))
    share = participation(train, order, shape)
    ratio = damping_ratios(train, shape, frequency=w)
    force = forces[:-1].max(axis=0, initial=0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        excess = np.fmax.reduce(forces / held(state)[:, None], axis=0)
        gain = share / (2.0 * ratio)
    # beside a run-out, whose push is the same at every speed, an unbalance comes later than told
    turned = not any(r.shaft in order.parts for r in plan.run_outs)
    begin = lift_off(
        speed, ratio=ratio, excess=np.where(np.isfinite(force), excess, np.nan),
        unbalance=order.kind == "shaft" and turned,
    )  # fmt: skip
    return np.stack([speed, share, gain, np.where(np.isfinite(begin), np.nan, force), begin]), shape


def held(state: TrainState) -> Floats:
    """Static load [N] of each bearing, and last of the teeth: above it the force would turn round.

    A preloaded bearing keeps its elements loaded for a while then; its stiffness is another, too.
    """
    return np.append(np.linalg.norm(state.rest.bearing_force, axis=-1), state.rest.mesh_force)


def _first(rows: Floats, count: int) -> Floats:
    """The ``count`` first columns; nan where there are fewer."""
    found = np.full((rows.shape[0], count), np.nan)
    kept = min(count, rows.shape[1])
    found[:, :kept] = rows[:, :kept]
    return found


def participation(train: LinearTrain, order: Order, shape: NDArray[np.complex128]) -> Floats:
    """How much of each mode (n, modes) an order can drive [-].

    Mesh and bearing orders: the strain energy of the teeth, or of that bearing, over all. Shaft
    orders: the kinetic energy of that shaft's forward whirl over all, for an unbalance turns
    forward.
    """
    if order.kind != "shaft":
        shares = strain_shares(train, shape)
        ring = "bearing " if order.kind == "bearing" else ""
        return np.asarray(sum((shares[ring + part] for part in order.parts), np.zeros(())))
    own, (shaft,) = train.assembly, order.parts
    turns = own.frame.sense * (1.0 if shaft == SHAFTS[0] else -1.0)
    nodes = range(own.nodes[SHAFTS.index(shaft)].size)
    rows = [[own.index[f"{shaft}.{i}.{c}"] for i in nodes] for c in ("x", "y")]
    forward = 0.5 * (shape[rows[0]] + 1j * turns * shape[rows[1]])
    moving = own.mass[np.ix_(rows[0], rows[0])]
    energy = 2.0 * np.sum(forward.conj() * (moving @ forward), axis=0).real
    total = np.sum(shape.conj() * (own.mass @ shape), axis=0).real
    return np.asarray(energy / total)


def _responses(
    case: GearCase, state: TrainState, speeds: Floats, orders: Sequence[Order]
) -> list[Response]:
    """The response to the mesh's harmonics, to the unbalance and to the run-out of either shaft.

    Nan where a bearing lifts off or the teeth part, see :func:`held`.
    """
    error = state.loaded_error
    found = [
        error_response(
            state.linear,
            speeds,
            order=one.order,
            error=complex(error[h]) if h < error.size else 0.0,
        )
        for h, one in enumerate(one for one in orders if one.kind == "mesh")
    ]
    plan = plan_of(case)
    found += [unbalance_response(state.linear, speeds, s, plan.unbalances) for s in SHAFTS]
    ratio = case.pair.pinion.teeth / case.pair.wheel.teeth
    for shaft, turns in zip(SHAFTS, (1.0, ratio), strict=True):
        moved = sum(
            (run_out_error(state.assembly, one) for one in plan.run_outs if one.shaft == shaft),
            0j,
        )
        found.append(error_response(state.linear, speeds, order=turns, error=moved))
    return [_in_contact(one, held(state)) for one in found]


def _in_contact(response: Response, most: Floats) -> Response:
    """The ``response``, nan at speeds where a force of it is above the ``most`` it may be."""
    rings = np.linalg.norm(response.bearing_force, axis=-1)
    forces = np.column_stack([rings, np.abs(response.mesh_force)])
    beyond = np.any(forces > most, axis=1)
    kept = ("mesh_force", "bearing_force", "ring_acceleration", "casing_acceleration")
    arrays = {name: np.array(getattr(response, name)) for name in kept}
    for values in arrays.values():
        values[beyond] = np.nan
    return replace(response, **arrays)


def _response_table(
    case: GearCase, states: Sequence[str], speeds: Floats, found: Sequence[Sequence[Response]]
) -> Dataset:
    over = ("state", "source", "response_speed")

    def amplitude(name: str) -> Floats:
        return np.array([[np.abs(getattr(one, name)) for one in row] for row in found])

    across = {
        "bearing_force": ("bearing", "N", "dynamic force of the bearing, amplitude along "),
        "ring_acceleration": ("bearing", "m/s^2", "acceleration of the outer ring along "),
        "casing_acceleration": ("", "m/s^2", "acceleration of the housing along "),
    }
    variables: dict[str, Any] = {
        "dynamic_mesh_force": (
            over,
            amplitude("mesh_force"),
            "N",
            "dynamic mesh force, amplitude",
        )
    }
    for name, (along, unit, words) in across.items():
        values = amplitude(name)
        for c, axis in enumerate(("x", "y")):
            dims = (*over, along) if along else over
            variables[f"{name}_{axis}"] = (dims, values[..., c], unit, words + axis)
    sources = [f"mesh harmonic {h}" for h in range(1, MESH_HARMONICS + 1)]
    sources += [f"unbalance of the {shaft}'s shaft" for shaft in SHAFTS]
    sources += [f"run-out of the {shaft}" for shaft in SHAFTS]
    return label(
        variables,
        {
            "state": list(states),
            "source": sources,
            "response_speed": (("response_speed",), speeds, "rad/s", "speed of the pinion"),
            "bearing": list(plan_of(case).bearing_names),
        },
    )
