"""How far the load-shared mesh force stands from the one-spring form, for one gear case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.excitation import Excitation
from thermogear.base.pair_springs import PairSprings
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.one_point import OnePoint
from thermogear.dynamics.integrate import simulate
from thermogear.dynamics.load_shared import LoadSharedModel
from thermogear.dynamics.models import from_excitation
from thermogear.gears.turn import mean_tooth
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.load_shared import contact_at, pair_springs
from thermogear.mesh.thermal import HotPair
from thermogear.results.result import Result
from thermogear.study.declared import SharedForce, declared
from thermogear.study.orbit import found

POSITIONS = 240
LIGHT = 0.05
"""Part of the mean load that counts as light."""
FACTORS = LIGHT ** (np.arange(18, -7, -1) / 12.0)
"""Loads over the mean load at which springs are compared at rest: 1 and LIGHT among them."""
STEPS, SAMPLES, PERIODS, DISCARD = 1024, 128, 64, 192


@declared(SharedForce)
def shared_results(
    point: OnePoint,
    *,
    speeds: tuple[float, float] | None = None,
    count: int = SharedForce.count,
    progress: Progress = silent,
) -> Result:
    """Both mesh forces of a gear case at rest and in motion.

    At rest over load: mean tangent stiffness and swing of the exact loaded contact, of the pairs'
    springs and of the one spring. In motion over ``count`` speeds from ``speeds`` first to last
    [rad/s] (default a third to five thirds of resonance): swing at the mean load and at
    :data:`LIGHT` of it. Both forms are built at the mean load.

    A swing is that of the transmission error r_b1 theta_1 - r_b2 theta_2 [m], peak to peak: what
    each form takes for the error is its own split of it, and belongs to no comparison. Towards
    speed 0 it is the static one, far above resonance it goes to 0, for both. Where teeth differ or
    a gear is eccentric both forms are of the mean tooth over one mesh period.
    """
    if point.operating is None:
        raise InputError(
            "case", "a dimensionless case", why="it has no tooth pairs to share a load"
        )
    case = point.gears
    if point.bundle.stiffness != "loaded":
        raise InputError(
            "--bundle",
            repr(point.bundle.name),
            why="tooth pairs share a load in the loaded contact alone",
            fix="choose the bundle 'consistent'",
        )
    case = replace(case, deviations=mean_tooth(case.pair, case.deviations))
    here = replace(point, case=case).excitation()
    hot = HotPair(case.pair, point.operating, point.bundle)
    progress("springs", 0, 2)
    drive, back = (
        pair_springs(hot, 0, case.deviations, flank=flank, positions=POSITIONS)
        for flank in ("drive", "back")
    )
    progress("springs", 2, 2)
    data = at_rest(case, hot, here, drive).merge(free_play(case, hot, here, drive, back))
    resonance = here.natural_frequency / case.pair.pinion.teeth
    low, high = speeds or (resonance / 3.0, 5.0 * resonance / 3.0)
    swings: list[list[tuple[float, float]]] = []
    every = np.linspace(low, high, count)
    cut = False
    try:
        for number, speed in enumerate(every.tolist()):
            progress("speeds", number, count)
            turning = replace(here, mesh_frequency=case.pair.pinion.teeth * speed)
            swings.append([_swings(turning, case, drive, back, part) for part in (1.0, LIGHT)])
        progress("speeds", count, count)
    except KeyboardInterrupt:
        cut = True
    by_form = np.reshape(swings, (-1, 2, 2))
    swing = {
        f"{form}_swing": (("speed", "part"), by_form[..., place], "m")
        for place, form in enumerate(("shared", "one_spring"))
    }
    moving = label(
        swing,
        {
            "speed": ("speed", every[: len(swings)], "rad/s", "pinion speed"),
            "part": ("part", [1.0, LIGHT], "1", "load over the mean load"),
        },
    )
    summary = {"title": point.title, **_summary(data, moving), "interrupted": cut}
    return found(SharedForce.kind, {"rest": data, "motion": moving}, summary, interrupted=cut)


def at_rest(case: GearCase, hot: HotPair, here: Excitation, drive: PairSprings) -> Dataset:
    """Mean stiffness and swing of the error over load: exact, pair springs, one spring."""
    phase = np.arange(POSITIONS) / POSITIONS + 1e-12
    loads = FACTORS * here.mean_force
    exact = contact_at(hot, 0, loads, phase, case.deviations)
    shared = drive.deflection(loads[:, None], phase)
    k = here.stiffness(phase)
    given = case.transmission_error(phase)
    one = loads[:, None] / k + here.error(phase)
    values = {
        "exact_stiffness": exact.tangent.mean(axis=1),
        "shared_stiffness": drive.stiffness_at(shared, phase).mean(axis=1),
        "one_spring_stiffness": np.full(loads.size, k.mean()),
        "exact_swing": np.ptp(exact.deflection + given, axis=1),
        "shared_swing": np.ptp(shared + given, axis=1),
        "one_spring_swing": np.ptp(one, axis=1),
    }
    return label(
        {
            name: ("load", v, "N/m" if name.endswith("stiffness") else "m")
            for name, v in values.items()
        },
        {
            "load": ("load", loads, "N", "normal force"),
            "factor": ("load", FACTORS, "1", "load over the mean load"),
        },
    )


def free_play(
    case: GearCase, hot: HotPair, here: Excitation, drive: PairSprings, back: PairSprings
) -> Dataset:
    """Free play 2 b' [m] over the mesh phase: of the pairs' springs and of the one spring.

    Both from one gap function; in motion the one spring keeps its mean all along.
    """
    phase = np.arange(POSITIONS) / POSITIONS
    shared = LoadSharedModel.from_excitation(here, drive, back)
    one = Clearance(hot, phase, case.deviations).half_backlash[0]
    values = {"shared_clearance": shared.clearance(phase), "one_spring_clearance": 2.0 * one}
    return label(
        {name: ("mesh_phase", play, "m") for name, play in values.items()},
        {"mesh_phase": ("mesh_phase", phase, "1", "mesh phase")},
    )


def _swings(
    here: Excitation, case: GearCase, drive: PairSprings, back: PairSprings, part: float
) -> tuple[float, float]:
    """Swing of the settled transmission error [m], load-shared and one spring."""
    light = replace(here, mean_force=part * here.mean_force)
    shared = LoadSharedModel.from_excitation(light, drive, back, case.transmission_error)
    length = here.reference_half_backlash
    run: dict[str, Any] = {"periods": PERIODS, "discard": DISCARD, "samples_per_period": SAMPLES}
    # the base circles stand still at first: what moves against them is the error
    turn = light.mesh_frequency / (2.0 * np.pi)
    given, whole = (
        -turn * float(e.derivative()(0.0)) for e in (case.transmission_error, here.error)
    )
    start = shared.rest(), given
    ours = simulate(shared, steps_per_period=STEPS, initial_state=start, **run)
    start = light.half_backlash / length, whole / (length * light.natural_frequency)
    one = simulate(from_excitation(light), initial_state=start, **run)
    phase = np.arange(PERIODS * SAMPLES) / SAMPLES
    by_pairs = ours["x"].values + case.transmission_error(phase)
    by_one = length * one["x"].values + here.error(phase)
    return float(np.ptp(by_pairs)), float(np.ptp(by_one))


def _summary(rest: Dataset, moving: Dataset) -> dict[str, Any]:
    """How far apart the two forms are, at the mean load and where they part."""

    def apart(data: Dataset, quantity: str, of: Callable[..., Any] = np.max, **at: Any) -> float:
        here = data.sel(at, method="nearest")
        ratio = here[f"shared_{quantity}"] / here[f"one_spring_{quantity}"]
        return float("nan") if not ratio.size else float(of(np.abs(ratio.values - 1.0)))

    rested = rest.swap_dims(load="factor")
    play = rest["one_spring_clearance"].values
    found_here = {
        "least_clearance_m": float(play.min()),
        "mean_clearance_m": float(play.mean()),
        "clearance_apart_m": float(np.abs(rest["shared_clearance"].values - play).max()),
    }
    for where, part in (("mean", 1.0), ("light", LIGHT)):
        found_here |= {
            f"stiffness_at_{where}_load": apart(rested, "stiffness", factor=part),
            f"swing_at_rest_{where}_load": apart(rested, "swing", factor=part),
            f"median_swing_in_motion_{where}_load": apart(moving, "swing", np.median, part=part),
            f"swing_in_motion_{where}_load": apart(moving, "swing", part=part),
        }
    return {name: value for name, value in found_here.items() if np.isfinite(value)}
