"""Borders of contact loss on a map: where a flank or a bearing begins to part, as whole curves.

Between two neighbours of the map, of which a contact opens in one motion and not in the other, lies
a grazing. It is located on the branch of the one's orbit and followed both ways
(:func:`~thermogear.analysis.event_curve.event_curve`) to the borders of the map. Borders of
periodic motions alone; a border that passes no pair of neighbours that were computed is missed.
Checked by ``tests/analysis/test_borders.py``.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.any_motion import settle
from thermogear.analysis.bifurcations import GRAZING, Bifurcation
from thermogear.analysis.bordered import Sheet
from thermogear.analysis.continuation import continuation
from thermogear.analysis.event_curve import EventCurve, event_curve
from thermogear.analysis.outcome import begun
from thermogear.analysis.settle import PERIODIC
from thermogear.analysis.walk import Search
from thermogear.base.arrays import Dataset, Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.progress import Progress, silent
from thermogear.base.vocabulary import ASSUMED
from thermogear.dynamics.return_map import return_map

MOST_CURVES, MOST_TRIES = 16, 24
"""Borders that are followed, and pairs of neighbours at which they are looked for; chosen."""
SAME, RESAMPLED = 5e-3, 4000
"""Share of a map's range [1] within which an event lies on a curve, drawn in so many points."""
STEPS = 100
"""Parts of a pair of neighbours that progress is told in."""
LEG = 20
"""Points of a leg that count as half of it [1], chosen."""
ORBITS = 400
"""Orbits, each of its own model, that a border takes [1]: what borders of trains took, see
:func:`expected`; a short one takes a tenth."""
PARTED = 1e-9
"""Share of the time [1] that is no more than rounding."""
Edge = tuple[int, tuple[int, int], tuple[int, int]]
"""The axis along which two neighbours differ, and both places."""


def with_borders(
    data: Dataset, sheets: Sequence[Sheet], *, axes: Sequence[Floats], start: Floats,
    progress: Progress = silent,
) -> Dataset:  # fmt: skip
    """Add the borders of contact loss to a map over ``axes``, begun from ``start``.

    ``sheets`` (p, q) -> model, one for each state of heat. ``border_first`` and ``border_second``
    (border, border_point), ``border_contact`` (the flag's number), ``border_state`` (border); the
    attribute ``borders`` says where and why each ends, ``borders_cut`` that Ctrl+C left others out.
    """
    rows: list[tuple[int, list[EventCurve]]] = []
    names = tuple(map(str, data["label"].dims[-2:]))
    data.attrs["borders_cut"] = 0
    try:
        for state, sheet in enumerate(sheets):
            here = data.isel(state=state) if "state" in data["label"].dims else data

            def tell(stage: str, done: int, total: int, state: int = state) -> None:
                progress(stage, done + state * total, total * len(sheets))

            for legs in _curves(here, sheet, axes, start, names, tell):
                rows.append((state, legs))
    except KeyboardInterrupt:
        data.attrs["borders_cut"] = 1
    longest = max([1, *(sum(len(leg.values) for leg in legs) for _, legs in rows)])
    values = np.full((2, len(rows), longest), np.nan)
    about = []
    for number, (_, legs) in enumerate(rows):
        line = np.concatenate([legs[0].values[::-1], *(leg.values[1:] for leg in legs[1:])])
        values[:, number, : len(line)] = line.T
        ends = [[*leg.values[-1].tolist(), leg.ended] for leg in legs]
        about.append({"period": legs[0].period, "ends": ends})
    dims, words = ("border", "border_point"), "along a border of contact loss"
    for name, axis, row in zip(("first", "second"), names, values, strict=True):
        units = str(data[axis].attrs.get("units", "1"))
        data[f"border_{name}"] = (dims, row, {"long_name": f"{axis} {words}", "units": units})
    contacts = np.array([legs[0].contact for _, legs in rows], np.int32)
    data["border_contact"] = (("border",), contacts, {"long_name": "contact: flanks, bearings"})
    data["border_state"] = (("border",), np.array([state for state, _ in rows], np.int32))
    data.attrs["borders"] = json.dumps(about)
    return data


def expected(sheet: Sheet, *, axes: Sequence[Floats], start: Floats) -> float:
    """Seconds that a border takes, within a factor of three, from one orbit in the map's middle.

    0 where nothing moves there.
    """
    middle = [float(axis[:2].mean()) for axis in axes]
    try:
        sheet(*middle)
        begun_at = time.perf_counter()
        section: Any = return_map(sheet(*middle))
        state = section.visit(begun(start[None], (section,), section.dimension)[0]).points[-1]
        section.extremes(state, 1)
    except (ConvergenceError, InputError):
        return 0.0
    return ORBITS * (time.perf_counter() - begun_at)


def _curves(
    data: Dataset, sheet: Sheet, axes: Sequence[Floats], start: Floats, names: tuple[str, ...],
    progress: Progress,
) -> Iterator[list[EventCurve]]:  # fmt: skip
    """Every border of one state, each in one leg or in two from where it was located."""
    lines: list[EventCurve] = []
    tries = count = 0
    pairs = [(n, edge) for n, flags in enumerate(_opened(data)) for edge in _edges(data, flags)]
    whole = max(STEPS * len(pairs), 1)
    for number, (contact, edge) in enumerate(pairs):
        progress("borders", STEPS * number, whole)
        if any(_passes(leg, axes, edge) for leg in lines if leg.contact == contact):
            continue
        tries += 1
        if tries > MOST_TRIES or count >= MOST_CURVES:
            break

        def tell(share: float, done: int = STEPS * number) -> None:
            progress("borders", done + round(STEPS * share), whole)

        try:
            event = _between(sheet, axes, edge, start, names, contact)
            legs = [] if event is None else _followed(event, sheet, axes, edge, names, tell)
        except (ConvergenceError, InputError):
            continue
        if legs:
            count += 1
            lines += legs
            yield legs
    progress("borders", whole, whole)


def _opened(data: Dataset) -> list[NDArray[np.bool_]]:
    """Of every contact whether it opens (the back flank: closes) at a point of the map."""
    if "lost_contact" not in data:
        return [data["drive_share"].values < 1.0 - PARTED, data["back_share"].values > PARTED]
    lost = np.nan_to_num(data["lost_contact"].values).astype(int)
    masks = np.ravel(data["lost_contact"].attrs["flag_masks"])
    return [(lost & int(mask)) > 0 for mask in masks]


def _edges(data: Dataset, flags: NDArray[np.bool_]) -> Iterator[Edge]:
    """Neighbours with closed orbits of one period, of which one alone opens the contact."""
    known = (data["label"].values == PERIODIC) & (data["status"].values != ASSUMED)
    period = data["period"].values
    for axis in (0, 1):
        count = flags.shape[axis] - 1
        low, high = ([np.take(a, range(k, k + count), axis) for a in (flags, known, period)]
                     for k in (0, 1))  # fmt: skip
        here = (low[0] != high[0]) & low[1] & high[1] & (low[2] == high[2])
        for i, j in np.argwhere(here).tolist():
            ends = (i, j), (i + (axis == 0), j + (axis == 1))
            first, last = ends[::-1] if flags[i, j] else ends
            yield axis, first, last  # from where the contact is never lost: fewest events


def _passes(curve: EventCurve, axes: Sequence[Floats], edge: Edge) -> bool:
    """Whether a curve passes between both neighbours, or as near as :data:`SAME` by them."""
    _, low, high = edge
    scale = np.array([np.ptp(values) for values in axes])
    places = np.arange(len(curve.values))
    dense = np.linspace(0.0, places[-1], RESAMPLED)
    line = np.stack([np.interp(dense, places, v) for v in curve.values.T], axis=1) / scale
    ends = np.array([[axes[k][place[k]] for k in (0, 1)] for place in (low, high)]) / scale
    near = (line >= ends.min(axis=0) - SAME) & (line <= ends.max(axis=0) + SAME)
    return bool(near.all(axis=1).any())


def _between(
    sheet: Sheet, axes: Sequence[Floats], edge: Edge, start: Floats, names: tuple[str, ...],
    contact: int,
) -> tuple[Bifurcation, float] | None:  # fmt: skip
    """The grazing of a contact between two neighbours, and the value of the other parameter."""
    axis, low, high = edge
    level = float(axes[1 - axis][low[1 - axis]])
    ends = [float(axes[axis][place[axis]]) for place in (low, high)]

    def family(value: float) -> object:
        return sheet(value, level) if axis == 0 else sheet(level, value)

    begin, end = ends
    section = return_map(family(begin))
    state = begun(start[None], (section,), section.dimension)[0]
    motion = settle(section, state, Search(starts=1))
    if motion.orbit is None:
        return None
    for stop in (GRAZING, None):
        branch = continuation(
            motion.orbit, names[axis], end, family=family, start=begin, stop_at=stop
        )
        for event in branch.of_kind(GRAZING):
            orbit_map: Any = event.orbit.section
            seen = orbit_map.extremes(event.state, event.period)
            rest = seen.without(int(np.abs(seen.depth).argmin())).losses
            if seen.touch().contact == contact and rest[contact] == 0:
                return event, level
    return None


def _followed(
    event: tuple[Bifurcation, float], sheet: Sheet, axes: Sequence[Floats], edge: Edge,
    names: tuple[str, ...], tell: Callable[[float], None],
) -> list[EventCurve]:  # fmt: skip
    """Both legs of a border from where it was located; one where it closes on itself."""
    axis, (grazing, level) = edge[0], event
    turned = sheet if axis == 0 else lambda p, q: sheet(q, p)
    order = (axis, 1 - axis)
    (low, high), within = ((float(min(axes[k])), float(max(axes[k]))) for k in order)
    legs: list[EventCurve] = []
    for number, end in enumerate(within):
        if end == level or (legs and legs[0].closed):
            continue

        def told(points: int, _value: float, number: int = number) -> None:
            # a leg may turn back in the parameter, and how long it is shows at its end
            tell(0.5 * (number + points / (points + LEG)))

        curve = event_curve(
            grazing, turned, (names[axis], names[1 - axis]), start=level, asked=[end],
            limits=(low, high), within=within, alone=True, progress=told,
        )  # fmt: skip
        legs.append(curve.exchanged() if axis else curve)
    return legs
