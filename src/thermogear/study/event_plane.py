"""Bifurcations of branches, followed in a second parameter: where a motion jumps, as a plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.bifurcations import GRAZING, PITCHFORK, Bifurcation
from thermogear.analysis.bordered import Sheet
from thermogear.analysis.continuation import Branch
from thermogear.analysis.event_curve import CARRIED, LOST, EventCurve, event_curve
from thermogear.base.errors import ConvergenceError
from thermogear.base.notice import Notice
from thermogear.base.parameters import Parameter
from thermogear.base.progress import Progress
from thermogear.base.vocabulary import contact_name
from thermogear.dynamics.return_map import MovedMap

if TYPE_CHECKING:
    from collections.abc import Callable

    import xarray as xr

MOST_CURVES = 16
STEPS = 1000
OF_ONE_MASS = (PITCHFORK,)
"""Followed where one mass moves alone."""
SAME = 1e-3
"""Of the range: a curve that comes back this near to another event ends at it."""


@dataclass(frozen=True, eq=False)
class Plane:
    """The ``second`` parameter, the ``values`` asked for, and ``sheet`` (p, q) -> model.

    ``bearings``: the names of a train's, for grazings.
    """

    second: Parameter
    values: NDArray[np.float64]
    sheet: Sheet
    bearings: tuple[str, ...] = ()

    @property
    def models(self) -> Callable[[float], object]:
        """value of the first parameter -> model, at the first value of the second."""
        start = float(self.values[0])
        return lambda value: self.sheet(value, start)

    def followed(
        self,
        branches: Sequence[Branch],
        first: Parameter,
        limits: tuple[float, float],
        progress: Progress,
    ) -> tuple[list[EventCurve], list[Notice], bool]:
        """A curve for every bifurcation, grazings last; notices; whether Ctrl+C cut it."""
        events = [b for branch in branches for b in branch.bifurcations if b.kind in CARRIED]
        chosen = [b for b in events if b.kind not in OF_ONE_MASS or one_mass(b)]
        chosen.sort(key=lambda event: event.kind == GRAZING)
        left = {b.kind for b in events} - {b.kind for b in chosen}
        notices = [
            Notice.of("events_of_train_not_followed", kind=kind, parameter=self.second.name)
            for kind in OF_ONE_MASS
            if kind in left
        ]
        curves: list[EventCurve] = []
        try:
            for event in chosen:
                if any(_ends_at(one, event, limits, float(self.values[0])) for one in curves):
                    continue
                if len(curves) == MOST_CURVES:
                    notices.append(Notice.of("curves_left_out", most=MOST_CURVES))
                    break
                try:
                    curves.append(self._curve(event, first, limits, progress))
                except ConvergenceError as error:
                    notices.append(Notice.of("curve_not_found", kind=event.kind, reason=str(error)))
        except KeyboardInterrupt:
            return curves, notices, True
        return curves, notices, False

    def _curve(
        self, event: Bifurcation, first: Parameter, limits: tuple[float, float], progress: Progress
    ) -> EventCurve:
        start, end = float(self.values[0]), float(self.values[-1])
        stage = f"{event.kind} in {self.second.name}"

        def told(_points: int, value: float) -> None:
            done = round(STEPS * abs(value - start) / abs(end - start))
            progress(stage, min(STEPS, done), STEPS)

        progress(stage, 0, STEPS)
        found = event_curve(
            event, self.sheet, (first.name, self.second.name), start=start, asked=self.values,
            limits=limits, progress=told,
        )  # fmt: skip
        progress(stage, STEPS, STEPS)
        return found

    def summary(self, curves: Sequence[EventCurve], first: Parameter) -> dict[str, Any]:
        """What is told of the curves; values in SI."""
        return {
            "second": self.second.name,
            "second_unit": self.second.shown,
            "second_from": float(self.values[0]),
            "second_to": float(self.values[-1]),
            "curves": [self._told(one, first) for one in curves],
        }

    def _told(self, curve: EventCurve, first: Parameter) -> dict[str, Any]:
        points = [
            {
                "first": float(p),
                "second": float(q),
                "shown": float(first.show(p)),
                "shown_unit": first.shown,
                "second_shown": float(self.second.show(q)),
                "second_shown_unit": self.second.shown,
                "stable": bool(stable),
            }
            for (p, q), stable in zip(curve.values, curve.stable, strict=True)
        ]
        asked = [one for one, mark in zip(points, curve.asked, strict=True) if mark]
        turns = [points[place] for place in curve.turns]
        ended, _, why = curve.ended.partition(": ")
        if ended == LOST:
            p, q = map(float, curve.values[-1])
            beyond = (first.told(p), self.second.told(q))
            ended = f"{ended} beyond {' and '.join(beyond)}"
        return {
            "kind": curve.kind,
            "contact": self.contact(curve),
            "meets": [points[place] | {"what": words} for place, words in curve.meets],
            "period": curve.period,
            "points": len(curve.values),
            "ended": f"{ended}: {why}" if why else ended,
            "asked": asked,
            "turns": turns,
        }

    def contact(self, curve: EventCurve) -> str:
        """What touches on the curve of a grazing, by name; else ""."""
        return "" if curve.contact is None else contact_name(curve.contact, self.bearings)

    def groups(self, curves: Sequence[EventCurve], first: Parameter) -> dict[str, xr.Dataset]:
        """The curves as they are stored."""
        found = {}
        for number, curve in enumerate(curves):
            data = curve.dataset()
            data["first"].attrs["units"] = first.unit
            data["second"].attrs["units"] = self.second.unit
            data.attrs["contact"] = self.contact(curve)
            found[f"curve_{number}"] = data
        return found


def one_mass(event: Bifurcation) -> bool:
    """Whether its orbit is that of one mass."""
    return isinstance(event.orbit.section, MovedMap)


def _ends_at(
    curve: EventCurve, event: Bifurcation, limits: tuple[float, float], start: float
) -> bool:
    """Whether a curve came back to another event where it began: one curve joins both."""
    if (curve.kind, curve.period) != (event.kind, event.period):
        return False
    p, q = curve.values[-1]
    back = abs(q - start) < SAME * float(np.ptp(curve.values[:, 1]))
    return bool(back and abs(p - event.value) < SAME * abs(limits[1] - limits[0]))
