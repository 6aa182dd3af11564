"""A case through its duty: when the backlash is least, and what thermometers would say of it."""

from __future__ import annotations

import time
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from thermogear.base.arrays import Dataset, Floats
from thermogear.base.bounds import whole
from thermogear.base.errors import InputError, ValidityWarning
from thermogear.base.progress import Progress, silent
from thermogear.base.units import RPM, ZERO_CELSIUS
from thermogear.base.vocabulary import label
from thermogear.case.case import GearCase
from thermogear.case.duty import Measured, chosen_point, point_duty
from thermogear.case.gearbox_schema import NODES
from thermogear.case.sensors import Shown, shown_by
from thermogear.heat.transient import HOTTEST
from thermogear.mesh.balance_table import LOSSES, of_bearings
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.thermal import HotPair
from thermogear.mesh.warm_up import PHASES, Duty, WarmUp, meshing, warm_up
from thermogear.results.result import Notice, Result
from thermogear.study.declared import WarmUpSurvey, declared
from thermogear.study.notices import turn_notices
from thermogear.study.scuffing import borne_by

FLAT = 5e-8
"""Half backlash [m] above its least within which no moment is told as that of the least: a tenth of
a micrometre of backlash, below what flanks and centres are known to (ours)."""
LEAST_LOSS = 5e-9
"""A steady loss of backlash [m] below which another one is no share of it."""
MOMENTS = 400
"""About so many moments are stored, and at least 12 of each piece of the duty."""
MOST_OF_ONE = 120
"""Moments that one piece has at most."""
MOST_PIECES = 2000

ALONG = ("moment",)


@declared(WarmUpSurvey)
def warm_up_survey(
    case: GearCase,
    duty: Duty | None = None,
    *,
    start: float | None = None,
    measured: Measured | None = None,
    moments: int = MOMENTS,
    progress: Progress = silent,
) -> Result:
    """Temperatures, backlash, flash, film and stiffness of a case over its duty.

    ``duty`` of :func:`~thermogear.case.duty.read_duty` or made by hand (default: the case's
    operating point of the greatest power until it is steady); ``start`` [K] of all nodes (default:
    the first ambient); ``measured``: a record to be set beside the curves; about so many
    ``moments`` are stored. The first model of the case, its
    gearbox with the nodes it holds; other temperatures of the case are not used.

    Groups: ``course`` over (moment, node, loss_kind, sensor); ``steady`` over the pieces of the
    duty, each held for good; ``record`` over the rows measured. Attribute ``worst`` (JSON)
    has the moment of the least half backlash [m], its margin [K] and the steady one beside it.
    """
    began = time.perf_counter()
    for name, value, kind, fix in (
        ("duty", duty, Duty, "read_duty(FILE, case)"),
        ("measured", measured, Measured, "read_measured(FILE)"),
    ):
        if not isinstance(value, kind | None):
            raise InputError(name, repr(value), allowed=f"a {kind.__name__}", fix=f"pass {fix}")
    work = point_duty(case, *chosen_point(case)) if duty is None else duty
    if work.pieces > MOST_PIECES:
        raise InputError("duty", f"{work.pieces} rows", allowed=f"at most {MOST_PIECES}")
    of_each = max(12, min(MOST_OF_ONE, whole("moments", moments, least=1) // work.pieces))
    with warnings.catch_warnings():
        # told in the notices, with how long
        warnings.filterwarnings("ignore", "(oil temperature|viscosity|film):", ValidityWarning)
        course = _course(
            case,
            work,
            start,
            times=() if measured is None else measured.time,
            moments=of_each,
            progress=progress,
        )
        shown = shown_by(case.pair, case.gearbox.surroundings, case.sensors, course)
        data = _course_dataset(case, course, shown, progress)
        steady = _steady(case, work)
    groups = {"course": data, "steady": steady}
    if measured is not None:
        groups["record"] = _record(measured, course, shown)
    seconds = time.perf_counter() - began
    worst = _worst(case, course, steady)
    return Result.of(
        WarmUpSurvey.kind,
        f"Warm-up: {case.title}",
        groups,
        _notices(case, course, steady, measured, seconds),
        **case.provenance,
        bundle=case.models[0].name,
        choices=case.models[0].choices(),
        held=dict(course.held),
        duty="one point until steady" if duty is None else "table",
        worst=worst,
        jams=jams_of(course),
        sensors={one.name: one.words for one in shown},
        evaluations=course.course.evaluations,
        greatest_imbalance=float(course.course.imbalance.max()),
        seconds=seconds,
    )


def _course(
    case: GearCase,
    duty: Duty,
    start: float | None,
    *,
    times: Floats | Sequence[float],
    moments: int,
    progress: Progress = silent,
) -> WarmUp:
    at = case.stated
    return warm_up(
        case.pair,
        duty,
        at.lubricant,
        at.half_backlash,
        case.models[0],
        gearbox=case.gearbox,
        start=start,
        reference=at.temperatures.reference,
        housing=at.housing,
        deviations=case.deviations,
        times=times,
        moments=moments,
        progress=progress,
    )


# --- over time ------------------------------------------------------------------------------


def _course_dataset(
    case: GearCase, course: WarmUp, shown: Sequence[Shown], progress: Progress
) -> Dataset:
    count = course.time.size
    nodes = [n for n in (*NODES, "ambient") if n in course.temperatures]
    nodes += [n for n in course.temperatures if n not in nodes]
    losses = [np.broadcast_to(getattr(course.losses, name), (count,)) for name in LOSSES]
    each: dict[str, tuple[Any, ...]] = {
        "node_temperature": (
            (*ALONG, "node"),
            np.stack([course.temperatures[n] for n in nodes], axis=-1),
            "K",
            "temperature of a node of the heat balance",
        ),
        "loss": (
            (*ALONG, "loss_kind"),
            np.stack(losses, axis=-1),
            "W",
            "heat that a loss sets free",
        ),
        "sensor_temperature": (
            (*ALONG, "sensor"),
            np.stack([one.shown for one in shown], axis=-1),
            "K",
            "temperature that a sensor shows",
        ),
        "true_temperature": (
            (*ALONG, "sensor"),
            np.stack([one.true for one in shown], axis=-1),
            "K",
            "true temperature that a sensor is meant to say",
        ),
        "half_backlash": (
            ALONG, course.half_backlash, "m", "least half backlash over the mesh phase"
        ),
        "jam_margin": (
            ALONG, course.margin, "K", "by how much both gears could be hotter until the jam"
        ),
        "pinion_speed": (ALONG, course.operating.speed, "rad/s", "pinion speed"),
        "pinion_torque": (ALONG, course.operating.torque, "N m", "pinion torque"),
        "heat_in": (ALONG, course.course.heat_in, "J", "heat set free since the start"),
        "heat_out": (
            ALONG, course.course.heat_out, "J", "heat left through the given nodes since the start"
        ),
        "heat_kept": (ALONG, course.course.kept, "J", "heat kept in gears, oil and housing"),
        "imbalance": (
            ALONG, course.course.imbalance, "1", "|kept - in + out| over the heat turned over"
        ),
    }  # fmt: skip
    bearings, names = of_bearings(course.losses, ALONG[0], count)
    meshed = meshing(case.pair, course.operating, case.models[0], case.deviations, progress)
    return label(
        each | bearings | meshed,
        {
            **names,
            "node": nodes,
            "loss_kind": list(LOSSES),
            "sensor": [one.name for one in shown],
            "time": (ALONG, course.time, "s", "time from the start"),
        },
    )


# --- what it is measured against --------------------------------------------------------------


def _steady(case: GearCase, duty: Duty) -> Dataset:
    """Every piece of the duty held for good: temperatures and least half backlash."""
    model = case.models[0]
    points = np.stack([duty.ambient, duty.speed, duty.torque], axis=1)
    unique, back = np.unique(points, axis=0, return_inverse=True)
    values = np.full(len(unique), np.nan)
    fine = np.zeros(len(unique), np.int8)
    twice = np.zeros(len(unique), np.int8)
    temperatures: dict[str, Floats] = {}
    for ambient in np.unique(unique[:, 0]):
        here = np.flatnonzero(unique[:, 0] == ambient)
        around = replace(case.gearbox.surroundings, ambient=float(ambient))
        box = replace(case.gearbox, surroundings=around)
        balance = case.balance_of(model, unique[here, 1], unique[here, 2], gearbox=box)
        gap = _least_gap(case, HotPair(case.pair, balance.operating, model))
        # at rest the balance knows no free convection: it matters where anything but the ambient
        # has a temperature of its own
        runs = (unique[here, 1] > 0.0) | (around.oil_flow == 0.0 and not case.gearbox.measured)
        settled_here = balance.settled & runs
        twice[here] = balance.several & settled_here
        values[here] = np.where(settled_here, gap, np.nan)
        fine[here] = settled_here
        for name, t in balance.steady.temperatures.items():
            whole = temperatures.setdefault(name, np.full(len(unique), np.nan))
            whole[here] = np.where(settled_here, np.broadcast_to(t, here.shape), np.nan)
    nodes = {name: t[back] for name, t in temperatures.items()}
    along = ("piece",)
    return label(
        {
            "half_backlash": (along, values[back], "m", "least half backlash if held for good"),
            "settled": (along, fine[back], "1", "1 where there is a steady state"),
            "several": (along, twice[back], "1", "1 where from hot another one is reached"),
            "node_temperature": (
                ("piece", "node"),
                np.stack(list(nodes.values()), axis=-1),
                "K",
                "steady temperature",
            ),
            "begin": (along, duty.time[:-1], "s", "time at which the piece begins"),
            "pinion_speed": (along, duty.speed, "rad/s", "pinion speed"),
            "pinion_torque": (along, duty.torque, "N m", "pinion torque"),
            "ambient": (along, duty.ambient, "K", "ambient temperature"),
        },
        {"node": list(nodes)},
    )


def _least_gap(case: GearCase, pair: HotPair) -> Floats:
    """Least half backlash over the mesh phase [m], (count,)."""
    return Clearance(pair, np.arange(PHASES) / PHASES, case.deviations).least


def _worst(case: GearCase, course: WarmUp, steady: Dataset) -> dict[str, Any]:
    """The least half backlash, the steady one of the same piece, and the end."""
    one, rest = course.worst, float(steady["half_backlash"][course.worst.piece])
    cold = float(_least_gap(case, HotPair(case.pair, case.stated, case.models[0]).drawn())[0])
    lost, lost_for_good = cold - one.half_backlash, cold - rest
    ratio = lost / lost_for_good - 1.0 if lost_for_good > LEAST_LOSS else np.nan
    borne, why = borne_by(case.pair)
    return {
        "time_s": one.time,
        "between_s": least_between(course),
        "flat_m": FLAT,
        "half_backlash_m": one.half_backlash,
        "undeformed_half_backlash_m": cold,
        "margin_K": one.margin,
        "borne_K": borne - one.temperatures["pinion_tooth"],
        "borne_degC": borne - ZERO_CELSIUS,
        "borne_why": why,
        "steady_half_backlash_m": rest,
        "below_steady_m": rest - one.half_backlash,
        "loss_above_steady": ratio,
        "end_half_backlash_m": float(course.half_backlash[-1]),
        "end_s": float(course.time[-1]),
        "pinion_speed_rpm": float(course.duty.speed[one.piece]) / RPM,
        "pinion_torque_Nm": float(course.duty.torque[one.piece]),
        "piece": one.piece,
        "temperatures_K": one.temperatures,
        "at_the_end": bool(one.time >= course.time[-1]),
        "warmed": bool(one.temperatures["pinion_tooth"] > course.temperatures["pinion_tooth"][0]),
        "at_the_start": bool(one.time <= course.time[0]),
    }


# --- against a record -------------------------------------------------------------------------


def _computed(names: Sequence[str], when: Floats, course: WarmUp, shown: Sequence[Shown]) -> Floats:
    """What the named nodes and sensors have at stored times, (rows, columns) [K]."""
    by = {one.name: one.shown for one in shown} | course.temperatures
    place = np.minimum(np.searchsorted(course.time, when), course.time.size - 1)
    return np.stack([by[name][place] for name in names], axis=1)


def _record(measured: Measured, course: WarmUp, shown: Sequence[Shown]) -> Dataset:
    inside = measured.time <= course.time[-1]
    if not np.any(inside):
        raise InputError("measured", "no row within the course", allowed="rows within the duty")
    when, values = measured.time[inside], measured.values[inside]
    computed = _computed(measured.names, when, course, shown)
    by = ("row", "channel")
    return label(
        {
            "measured": (by, values, "K", "measured temperature"),
            "computed": (by, computed, "K", "computed temperature of the same name"),
            "difference": (by, computed - values, "K", "computed less measured"),
        },
        {
            "channel": list(measured.names),
            "time": (("row",), when, "s", "time from the start"),
        },
    )


# --- in words -----------------------------------------------------------------------------------


def least_between(course: WarmUp) -> tuple[float, float]:
    """Times [s] around the worst moment between which half backlash stays within FLAT of it."""
    worst, time = course.worst, course.time
    above = time[course.half_backlash > worst.half_backlash + FLAT]
    first, last = above[above < worst.time].max(initial=-1.0), above[above > worst.time]
    inside = time[(time > first) & (time < last.min(initial=np.inf))]
    return min(inside.min(initial=np.inf), worst.time), max(inside.max(initial=0.0), worst.time)


def jams_of(course: WarmUp) -> list[float]:
    """When [s] the backlash is used up, 0 among them where none is there from the start."""
    jams: list[float] = [0.0] * bool(course.half_backlash[0] <= 0.0) + course.jams.tolist()
    return jams or [course.worst.time] * bool(course.worst.half_backlash <= 0.0)


def no_bath_from(course: WarmUp) -> float:
    """When [s] the oil of a course first gets hotter than any bath of it, between the moments too.

    0 where it is so from the start. Only for a course that has such a moment.
    """
    from scipy.optimize import brentq

    place = int(np.argmax(course.operating.no_bath))
    if place == 0:
        return 0.0
    hottest, between = course.operating.lubricant.hottest_bath, course.time[place - 1 : place + 1]
    return float(brentq(lambda time: course.course.at(time)["oil"] - hottest, *between))


def _notices(
    case: GearCase,
    course: WarmUp,
    steady: Dataset,
    measured: Measured | None,
    seconds: float,
) -> Iterator[Notice]:
    yield from turn_notices(case, alike="flash, film, friction and stiffness over time")
    if jams := jams_of(course):
        yield Notice.of("pair_jams", time=jams[0])
    if course.course.too_hot:
        yield Notice.of("node_too_hot", time=course.time[-1], limit=HOTTEST)
    lubricant = case.stated.lubricant
    if course.operating.no_bath.any():
        yield Notice.of("no_bath_from", time=no_bath_from(course), hottest=lubricant.hottest_bath)
    low, high = lubricant.temperature_range
    oil = np.asarray(course.operating.oil_temperature)
    outside = (oil < low) | (oil > high)
    if outside.any():
        spent = np.diff(course.time)[outside[1:]].sum()
        yield Notice.of("oil_outside_for", duration=spent, range=[[low, high]])
    unknown = (steady["settled"].values == 0) & (course.duty.speed > 0.0)
    if unknown.any():
        yield Notice.of("pieces_not_settled", lost=unknown.sum(), pieces=unknown.size)
    several = int(steady["several"].values.sum())
    if several:
        yield Notice.of("second_steady_state_of_pieces", several=several, pieces=unknown.size)
    endless = not np.isfinite(course.duty.time[-1])
    if endless and not (course.course.settled or course.course.too_hot):
        yield Notice.of("no_rest_reached")
    if measured is not None and np.any(measured.time > course.time[-1]):
        yield Notice.of("rows_after_end", rows=(measured.time > course.time[-1]).sum())
    if np.any(course.duty.speed == 0.0):
        yield Notice.of("free_convection_at_rest")
    yield Notice.of(
        "losses_along_the_course",
        evaluations=course.course.evaluations,
        seconds=seconds,
        error=course.course.error,
        imbalance=course.course.imbalance.max(),
    )
