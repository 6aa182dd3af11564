"""Which bifurcation of one orbit diagram is which of another: each is followed on the way between.

Between both diagrams lies a family of equations: every coefficient at the share s of its way from
one to the other, s = 0..1. A bifurcation is a curve in the plane of the parameter and s
(:func:`~thermogear.analysis.event_curve.event_curve`). It has a partner where its curve arrives at
s = 1. A curve may turn back and end at another bifurcation of its own diagram, where the two meet
on the way, or leave the range: then there is none. Order and nearness decide nothing.

It is a homotopy of the equation. Each curve is a continuation in two parameters, so that it costs
as much as some branches. It fails, and the row says why, where a curve breaks off or two curves
end at one bifurcation. Where two curves pass close to each other, one may go on along the other:
neither is believed then.
Checked by ``tests/study/test_diagrams.py``, and by ``checks/trial_matched.py``, which confirms each
pair by a diagram half way between both states.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from thermogear.analysis.bifurcations import BIRTH, FLIP, GRAZING, Bifurcation
from thermogear.analysis.branches import KINDS
from thermogear.analysis.event_curve import BACK, LEFT, REACHED, event_curve
from thermogear.analysis.family import Family, dimension_of, model_at
from thermogear.analysis.orbits import Orbit, closed
from thermogear.analysis.section import lanes_of
from thermogear.base.arrays import Dataset
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import moves
from thermogear.dynamics.lanes import mixed
from thermogear.dynamics.return_map import return_map

MATCHED, JOINED, BEYOND, UNKNOWN = "matched", "meets another", "leaves the range", "not followed"
"""What becomes of a bifurcation on the way to the other diagram."""
ENDS = {REACHED: MATCHED, BACK: JOINED, LEFT: BEYOND}
TOGETHER = 1e-6
"""Of the parameter's range: where a curve arrives this near to a bifurcation, it arrives at it.

Both are zeros of the same functions, located to 1e-9 of the range or better
(:data:`~thermogear.analysis.curve.FOUND`).
"""
MOST_FOLLOWED = 64
COLLAPSED = 1e-4
"""Of its first value (ours): where the distance between the halves of an orbit is less, it closes
sooner than at the start: its curve has gone on along the orbits of the shorter period."""


class _Event(NamedTuple):
    kind: str
    period: int
    value: float
    state: tuple[float, float]


def matches(
    one: Dataset,
    other: Dataset,
    families: tuple[Family, Family],
    *,
    most: int = MOST_FOLLOWED,
    progress: Callable[[int, int], None] | None = None,
) -> list[dict[str, Any]]:
    """The bifurcations of two diagrams over the same values, a row for each, in their order.

    ``families`` the diagrams were made of. A row holds ``kind``, ``period`` [mesh periods],
    ``one`` and ``other`` (the parameter there, None where it has no partner), ``partner``:
    matched; meets another bifurcation of its own diagram (``met``: where that is); leaves the
    range; or is not followed to an end, and ``why``; and ``share``, how far from one to the other
    that is. ``drawn``: the other diagram lists the partner; it lists none of a branch that it does
    not show. ``most`` curves are followed, grazings last. ``progress`` gets how many are done, of
    how many. Without branches nothing is located: no rows.
    """
    if any("bifurcation_kind" not in data for data in (one, other)):
        return []
    name = str(one.attrs["parameter"])
    values = one[name].values
    near = TOGETHER * float(np.ptp(values))
    both = [_events(data, near) for data in (one, other)]
    known: list[set[_Event]] = [set(), set()]
    rows: list[dict[str, Any]] = []
    for way, here in enumerate(both):
        for event in here:
            if progress is not None:
                progress(sum(map(len, known)), sum(map(len, both)))
            if event in known[way]:
                continue
            pair = (families[way], families[1 - way])
            limits = (float(values.min()), float(values.max()))
            if len(rows) < most:
                partner, end, share, why = _followed(event, pair, name, limits)
            else:
                partner, end, share, why = UNKNOWN, None, 0.0, f"more than {most} bifurcations"
            side = 1 - way if partner == MATCHED else way
            twins = [] if end is None else [e for e in both[side] if _same(e, event, end, near)]
            known[way].add(event)
            known[side].update(twins)
            if twins:
                end = twins[0].value
            ends = (event.value, end if partner == MATCHED else None)
            rows.append({
                "kind": event.kind, "period": event.period,
                "one": ends[way], "other": ends[1 - way],
                "partner": partner, "share": abs(way - share), "drawn": bool(twins),
                "met": end if partner == JOINED else None, "why": why,
            })  # fmt: skip
    for state in ("one", "other"):
        counts = Counter(_place(row, state) for row in rows if row["partner"] == MATCHED)
        for row in rows:
            if row["partner"] == MATCHED and counts[_place(row, state)] > 1:
                # a curve that passes close to another can go on along it: neither is believed
                row |= {"partner": UNKNOWN, "why": "two curves end at one bifurcation"}
                row[state] = None
    return sorted(rows, key=lambda row: float(row["other" if row["one"] is None else "one"]))


def _place(row: Mapping[str, Any], side: str) -> tuple[Any, ...]:
    """Kind, period and value of a row's bifurcation in the state ``side``."""
    return row["kind"], row["period"], row[side]


def _same(event: _Event, kind: _Event, value: float, near: float) -> bool:
    """Whether ``event`` is one of the kind and period of another, at ``value``."""
    return event[:2] == kind[:2] and abs(event.value - value) <= near


def _events(data: Dataset, near: float) -> list[_Event]:
    """The bifurcations of a diagram, grazings last; a halving is the doubling that it ends at."""
    found: list[_Event] = []
    columns = [data[f"bifurcation_{name}"].values for name in ("kind", "period", "value", "x", "v")]
    for code, period, value, *state in zip(*(row.tolist() for row in columns), strict=True):
        kind = FLIP if KINDS[code] == BIRTH else KINDS[code]
        event = _Event(kind, period, value, tuple(state))
        if not any(_same(e, event, value, near) for e in found):
            found.append(event)
    return sorted(found, key=lambda event: event.kind == GRAZING)


def _followed(
    event: _Event, pair: tuple[Family, Family], name: str, limits: tuple[float, float]
) -> tuple[str, float | None, float, str]:
    """What becomes of an event, the parameter and the share of the way where, and why."""
    if dimension_of(pair[0]) != 2:
        return UNKNOWN, None, 0.0, "bifurcations of drive trains are not followed"

    def between(value: float, share: float) -> object:
        one, other = (family(np.array([[value]])) for family in pair)
        if not all(np.all(moves(getattr(points, "status", 0))) for points in (one, other)):
            raise ConvergenceError("one of both states has no motion there")
        return mixed(lanes_of(one), lanes_of(other), share)

    try:
        model = model_at(pair[0], event.value)
        orbit = closed(return_map(model), np.array(event.state), event.period, model=model)
        curve = event_curve(
            Bifurcation(event.kind, name, event.value, orbit), between, (name, "share"),
            start=0.0, asked=[1.0], limits=limits,
        )  # fmt: skip
        partner = next((word for end, word in ENDS.items() if curve.ended.startswith(end)), UNKNOWN)
        if partner == MATCHED:
            model = between(*curve.values[-1])
            there = closed(return_map(model), curve.states[-1], event.period, model=model)
            if _sooner(there) < COLLAPSED * _sooner(orbit):
                return UNKNOWN, None, 1.0, "its orbit closes sooner there"
    except (ConvergenceError, InputError) as error:
        return UNKNOWN, None, 0.0, str(error)
    farthest = curve.values[:, 1].max() if partner in (JOINED, UNKNOWN) else curve.values[-1, 1]
    why = curve.ended if partner == UNKNOWN else ""
    return partner, float(curve.values[-1, 0]), float(farthest), why


def _sooner(orbit: Orbit) -> float:
    """How far an orbit is from closing sooner than at its end [units of its section]; inf at 1."""
    lags = [lag for lag in range(1, orbit.period) if orbit.period % lag == 0]
    unit = orbit.section.unit
    gaps = [np.max(np.abs(orbit.points[lag] - orbit.points[0]) / unit) for lag in lags]
    return float(min(gaps, default=np.inf))
