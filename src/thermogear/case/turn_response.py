"""Motions of points of a case on their way over a range: what each settles on, and its figures.

Teeth that are alike: the exact engine, one mesh period by another. Where they differ, the turn is
followed in fixed steps until it repeats itself (:mod:`thermogear.dynamics.turns`): no orbit is
proven, and multipliers, exponents and counts of impacts are not known.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from thermogear.analysis.outcome import outcome_arrays, settle_with_status, started
from thermogear.analysis.settle import PERIODIC, UNDECIDED, Rule, Settled
from thermogear.base.arrays import Dataset, Floats, Whole
from thermogear.base.plan import Alive, Arrays, keep_going
from thermogear.base.vocabulary import FIXED_STEPS
from thermogear.case.case import GearCase
from thermogear.case.points import Points
from thermogear.case.response import Recording, figures_of_record, respond
from thermogear.dynamics.turns import (
    STEPS,
    TurnLanes,
    TurnTables,
    follow_turns,
    longest,
    record_turns,
)

DIGITS = 7
"""Decimals of what a motion over a turn is computed with, in units of the equation: other numbers
of the same teeth differ by rounding alone, which a motion that never settles would amplify."""
SAMPLES = STEPS // 2
"""Of a mesh period of a recorded turn; extremes are those of all steps."""


def over_turn(data: Dataset, case: GearCase) -> Dataset:
    """Stored motions with what they are of the turn of ``case``: its mesh periods and teeth.

    As they are where the case repeats itself after one mesh period.
    """
    of, teeth = case.period.mesh_periods, [case.pair.pinion.teeth, case.pair.wheel.teeth]
    if of == 1:
        return data
    closed = f"turns of {of} mesh periods after which the motion repeats itself, 0: none seen"
    data = data.assign(
        period=data["period"].assign_attrs(long_name=closed),
        label=data["label"].assign_attrs(comment=FIXED_STEPS),
    )
    return data.assign_attrs(mesh_periods=of, teeth=teeth)


def turn_tables(points: Points) -> Iterator[tuple[Whole, TurnTables]]:
    """Points that share their tables, and these, begun at the greatest error."""
    keys = [
        (stiffness.tobytes(), error.tobytes(), float(length))
        for stiffness, error, length in zip(
            points.flat.stiffness, points.error, points.length, strict=True
        )
    ]
    for key in dict.fromkeys(keys):
        index = np.array([place for place, other in enumerate(keys) if other == key])
        tables = TurnTables(
            stiffness=points.flat.stiffness[index[0]],
            error=points.error[index[0]] / points.length[index[0]],
            mesh_periods=points.mesh_periods,
        ).from_greatest()
        # what it weighs in e'' grows with the order squared
        orders = 1.0 + (np.arange(tables.error.size) / points.mesh_periods) ** 2
        error = np.round(tables.error * orders, DIGITS) / orders
        yield index, replace(tables, stiffness=np.round(tables.stiffness, DIGITS), error=error)


def turn_lanes(points: Points) -> TurnLanes:
    """The numbers of ``points`` that their tables do not hold."""
    flat = points.flat
    return TurnLanes(
        mean=np.round(flat.force[:, 0].real, DIGITS),
        damping=np.round(flat.damping, DIGITS),
        backlash=np.round(flat.half_backlash, DIGITS),
        period=np.round(flat.period, DIGITS),
    )


def settled_response(
    points: Points,
    start: Floats,
    rule: Rule,
    record: Recording,
    *,
    carried: bool = False,
    alive: Alive = keep_going,
) -> tuple[Settled, Arrays]:
    """What ``points`` settle on from ``start`` (point, 2), and what is stored of it, (point, ...).

    :func:`~thermogear.analysis.outcome.outcome_arrays` and
    :func:`~thermogear.case.response.respond`. Over a turn the start is ``carried`` on from the
    motion at another point, or held until a vibration has died out; figures of what does not repeat
    itself are those of half as long as it was followed.
    """
    if points.mesh_periods == 1:
        settled = settle_with_status(points.flat, points.status, start, rule, alive=alive)
        figures = outcome_arrays(settled, points.status)
        return settled, figures | respond(points, settled.state, record, lines=True, alive=alive)
    settled = started(points.status, start)
    moving = np.flatnonzero(~points.still)
    back = np.full(len(start), np.nan)
    figures = respond(points, np.full_like(start, np.nan), record, lines=True)
    for index, tables in turn_tables(points.take(moving)):
        here = moving[index]
        lanes = turn_lanes(points.take(here))
        motions = follow_turns(tables, lanes, start[here], carried=carried)
        for place, lane in enumerate(here):
            alive()
            several = int(motions.period[place])
            turns = several or longest(points.mesh_periods) // (2 * points.mesh_periods)
            taken = replace(record, periods=turns, samples=SAMPLES * points.mesh_periods)
            point = points.take(np.array([lane]))
            met, x, felt = record_turns(
                tables, lanes.take(np.array([place])), motions.state[place],
                turns=turns, samples=SAMPLES,
            )  # fmt: skip
            for name, values in _figures(point, x, felt, taken).items():
                figures[name][lane] = values
            settled.point[lane] = met
            back[lane] = np.mean(x < -point.flat.half_backlash)
        settled.period[here] = motions.period
        settled.label[here] = np.where(motions.period > 0, PERIODIC, UNDECIDED)
        settled.state[here] = motions.state
        settled.used[here] = motions.followed
    settled.shares[:] = np.stack([back, figures["contact_loss_share"] - back,
                                  1.0 - figures["contact_loss_share"]], axis=1)  # fmt: skip
    # a motion that does not repeat itself is none the less one
    return settled, figures | outcome_arrays(settled, points.status) | {"status": points.status}


def _figures(point: Points, x: Floats, felt: Floats, record: Recording) -> Arrays:
    """Figures of one recorded motion; extremes and shares as they were ``felt`` at every step."""
    found: Arrays = dict(figures_of_record(point, x[None], record, lines=True))
    force = point.stiffness * point.length * felt[:2]
    found["mesh_force_max"], found["mesh_force_min"] = force[:1], force[1:]
    if point.force[0] > 0.0:
        found["dynamic_factor"] = np.abs(force).max() / point.force
    found["dte_peak_to_peak"] = point.length * (felt[2] - felt[3])
    found["contact_loss_share"] = felt[4:]
    return {name: values[0] for name, values in found.items()}
