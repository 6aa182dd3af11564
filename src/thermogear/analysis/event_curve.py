"""A fold, period doubling, pitchfork, torus or grazing as a curve in two parameters.

Its equations and Newton's method are :mod:`~thermogear.analysis.bordered`.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.bifurcations import FLIP, FOLD, GRAZING, PITCHFORK, TORUS, Bifurcation
from thermogear.analysis.bordered import Bordered, Located, Sheet
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import contact_name
from thermogear.dynamics.return_map import is_moved

CARRIED = (FOLD, FLIP, PITCHFORK, TORUS, GRAZING)
LONGEST, FIRST, SHORTEST = 0.05, 0.01, 1e-6
"""Steps along the curve, scaled as :class:`~thermogear.analysis.curve.Curve` scales."""
ALONG = 0.9
"""Cosine between the curve's directions at neighbouring points."""
CORNER, AHEAD = 2.5e-3, -0.2
"""The same within so short a step, where multipliers have a kink and the curve a corner."""
SHORT, AROUND = 1e-5, 0.2
"""The shortest step for a search on a circle, and how far it goes on that."""
REACHED, BACK, LEFT = "reached the end", "came back", "left the range"
AROUND_ONCE = "closes on itself"
OPENED = "beyond, another opening of the same contact comes first"
MEETING = 1e-3
"""Scaled step within which a curve ends at such a point; chosen, a tenth of a line's width."""
LOST = "no further point"
VANISHED = "the extreme that touches meets the next one, and both vanish"
FOLDED = "the orbit folds there"
FOLDING = 0.02
"""A multiplier this near to +1 where no further orbit is found says why [1]; chosen."""
MERGING = 1e-3
"""Two neighbouring extremes of depths so alike are about to vanish [half backlashes]; chosen."""


@dataclass(frozen=True, eq=False, kw_only=True)
class EventCurve:
    """Where one bifurcation lies in the plane of two parameters, in the order of the walk.

    ``kind``, ``parameters`` (p, q) and mesh periods ``period`` of the orbit; ``values`` (point, 2)
    of p and q, ``states`` (point, d), ``multipliers`` (point, d) of the whole orbit; ``stable``:
    other multiplier lies outside the unit circle, so that a motion meets the bifurcation;
    ``asked``: the point lies at one of the values of q asked for. ``ended``: why. Of a grazing
    ``contact`` is the one that touches, as :func:`~thermogear.dynamics.extremes.contact_name`
    counts, and ``meets`` are the first points behind what it meets on its way, with words.
    """

    kind: str
    parameters: tuple[str, str]
    period: int
    values: Floats
    states: Floats
    multipliers: NDArray[np.complex128]
    stable: NDArray[np.bool_]
    asked: NDArray[np.bool_]
    ended: str
    contact: int | None = None
    meets: tuple[tuple[int, str], ...] = ()

    @property
    def turns(self) -> tuple[int, ...]:
        """Points at which the curve turns back in q."""
        steps = np.sign(np.diff(self.values[:, 1]))
        return tuple((np.flatnonzero(steps[1:] * steps[:-1] < 0.0) + 1).tolist())

    @property
    def closed(self) -> bool:
        """Whether it comes back to its first point."""
        return self.ended == AROUND_ONCE

    def exchanged(self) -> EventCurve:
        """The same with p and q exchanged."""
        return replace(self, parameters=self.parameters[::-1], values=self.values[:, ::-1])

    def dataset(self) -> xr.Dataset:
        """The curve over ``point``."""
        first, second = self.parameters
        return xr.Dataset(
            {
                "first": ("point", self.values[:, 0], {"long_name": first}),
                "second": ("point", self.values[:, 1], {"long_name": second}),
                "section": (
                    ("point", "coordinate"),
                    self.states,
                    {"long_name": "state at phase 0", "units": "1"},
                ),
                "multiplier_real": (
                    ("point", "multiplier"),
                    self.multipliers.real,
                    {"long_name": "Floquet multiplier, real part", "units": "1"},
                ),
                "multiplier_imag": (
                    ("point", "multiplier"),
                    self.multipliers.imag,
                    {"long_name": "Floquet multiplier, imaginary part", "units": "1"},
                ),
                "stable": (
                    "point",
                    self.stable.astype(np.int8),
                    {"long_name": "no other multiplier outside the unit circle", "units": "1"},
                ),
                "asked": (
                    "point",
                    self.asked.astype(np.int8),
                    {"long_name": "at a value asked for", "units": "1"},
                ),
            },
            attrs={
                "kind": self.kind, "first": first, "second": second, "period": self.period,
                "ended": self.ended,
                "contact": "" if self.contact is None else contact_name(self.contact),
            },
        )  # fmt: skip


def event_curve(
    bifurcation: Bifurcation,
    sheet: Sheet,
    names: tuple[str, str],
    *,
    start: float,
    asked: ArrayLike,
    limits: tuple[float, float],
    within: tuple[float, float] | None = None,
    alone: bool = False,
    most_points: int = 400,
    progress: Callable[[int, float], None] | None = None,
) -> EventCurve:
    """Follow ``bifurcation``, located at q = ``start``, in p and q to the last value ``asked``.

    ``sheet`` (p, q) -> model in the model's units, ``names`` of both parameters; ``limits`` of p,
    between which the curve is followed, and q ``within`` a range of its own (default: from
    ``start`` to the last value asked for). Pseudo-arclength continuation, around turning points in
    either parameter; points are also computed at every value of q ``asked`` for on the way. It
    ends at the border of either range, where it closes on itself, where no further point is found,
    where a complex pair of multipliers turns real, a grazing ``alone`` where its contact opens at
    another phase, too, or after ``most_points``: ``ended`` says it.

    Raises InputError for a birth, which is the flip of another orbit; ConvergenceError where the
    bifurcation is not found at ``start``.
    """
    _require_carried(bifurcation)
    marks = _marks(asked, start)
    low, high = sorted(limits)
    spans = (max(high - low, 1e-300), abs(float(marks[-1]) - start))
    walk = Bordered(bifurcation, sheet, start, spans=spans)
    ahead = np.zeros(bifurcation.state.size + 2)
    ahead[-1] = float(np.sign(marks[-1] - start))
    edges = _edges(names, start, float(marks[-1]), limits=(low, high), within=within)
    first = _first(walk, bifurcation, start, ahead)
    if first is None:
        raise ConvergenceError(
            f"the {bifurcation.kind} at {names[0]} = {bifurcation.value!r} was not found again at "
            f"{names[1]} = {start!r}"
        )
    at_start = bool(np.any(marks == start))
    points, at_mark, meets = [first], [at_start], list[tuple[int, str]]()
    ended, step, here = "", FIRST, first
    walk.settle(first)
    while not ended:
        there, step = _step(walk, here, step)
        if there is None:
            ended = _lost(walk, here)
            break
        landed, ended = _landed(walk, here, there, marks, edges)
        far = _away(there, here)
        opened = alone and there.touch is not None and there.losses[there.touch.contact] > 0
        if (ended == LOST and far > SHORT) or (opened and far > MEETING):
            step, ended = 0.5 * far, ""
            continue
        landed, ended = ([], OPENED) if opened else (landed, ended)
        points += [point for point, _ in landed]
        at_mark += [mark for _, mark in landed]
        meets += [(len(points) - 1, words) for words in _met(here, points[-1])]
        if progress is not None:
            progress(len(points), float((points[-1].scaled * walk.whole)[-1]))
        walk.settle(there)
        if len(points) > most_points:
            ended = ended or f"{most_points} points"
        if len(points) > 3 and max(_away(here, first), _away(there, first)) < far:
            ended = ended or AROUND_ONCE * bool(there.tangent @ first.tangent > ALONG)
        ended, here = ended or _resonance(walk), there
    return _curve(walk, names, points, at_mark, ended, meets)


def _require_carried(bifurcation: Bifurcation) -> None:
    """Refuse what is not followed."""
    if bifurcation.kind not in CARRIED:
        raise InputError("bifurcation", bifurcation.kind, allowed=" | ".join(CARRIED))
    one_mass = is_moved(bifurcation.orbit.section)
    if bifurcation.kind == PITCHFORK and not one_mass:
        raise InputError("bifurcation", PITCHFORK, why="of a model of more than one mass")


def _marks(values: ArrayLike, start: float) -> Floats:
    """The values of q asked for; InputError where they lead nowhere."""
    marks = np.atleast_1d(np.asarray(values, dtype=float))
    if not np.all(np.isfinite(marks)) or marks.size == 0 or marks[-1] == start:
        raise InputError("asked", marks.tolist(), allowed=f"finite, the last not {start}")
    return marks


def _curve(
    walk: Bordered,
    names: tuple[str, str],
    points: list[Located],
    at_mark: list[bool],
    ended: str,
    meets: list[tuple[int, str]],
) -> EventCurve:
    """The points of a walk in units of the model."""
    scaled, touch = np.array([point.scaled for point in points]), points[0].touch
    return EventCurve(
        kind=walk.kind,
        parameters=names,
        period=walk.bifurcation.period,
        values=scaled[:, -2:] * walk.whole[-2:],
        states=scaled[:, :-2] * walk.unit[:-1],
        multipliers=np.array([point.multipliers for point in points]),
        stable=np.array([walk.stable(point.multipliers) for point in points]),
        asked=np.array(at_mark),
        ended=ended,
        contact=None if touch is None else touch.contact,
        meets=tuple(meets),
    )


def _away(point: Located, first: Located) -> float:
    return float(np.linalg.norm(point.scaled - first.scaled))


def _resonance(walk: Bordered) -> str:
    """Where a complex pair of multipliers turns real; "" where it does not."""
    if walk.kind != TORUS or abs(walk.mu.imag) >= 1e-4:
        return ""
    resonance = "1:1, beside a fold" if walk.mu.real > 0.0 else "1:2, beside a doubling"
    return f"the complex pair of multipliers became real: resonance {resonance}"


def _met(here: Located, there: Located) -> list[str]:
    """What a grazing meets between two of its points: other contacts, and bifurcations."""
    if there.touch is None:
        return []
    pairs = enumerate(zip(here.losses, there.losses, strict=True))
    words = [f"the {contact_name(n)} touches, too" for n, (a, b) in pairs if a != b]
    before, after = (p.multipliers[np.abs(p.multipliers) > 1.0] for p in (here, there))
    if before.size != after.size:
        mu = (before if before.size > after.size else after)[-1]
        torus = abs(mu.imag) > 1e-6 * abs(mu)
        words.append(f"a {TORUS if torus else FOLD if mu.real > 0.0 else FLIP} meets it")
    return words


def _lost(walk: Bordered, here: Located) -> str:
    """Why a curve ends where no further point is found, as far as its last point shows it."""
    why = walk.refused
    if not why and walk.depths_beside(here) < MERGING:
        why = VANISHED
    if not why and walk.kind != FOLD and np.abs(here.multipliers - 1.0).min() < FOLDING:
        why = FOLDED
    return f"{LOST}: {why}" if why else LOST


def _edges(
    names: tuple[str, str],
    start: float,
    last: float,
    *,
    limits: tuple[float, float],
    within: tuple[float, float] | None,
) -> dict[tuple[float, int], str]:
    """Values of p (place -2) and of q (-1) at which a curve ends, and the words for it."""
    edges = {(limit, -2): f"{LEFT} of {names[0]}" for limit in limits}
    if within is None:
        edges[start, -1] = f"{BACK} to the first value of {names[1]}"
    else:
        edges |= {(limit, -1): f"{LEFT} of {names[1]}" for limit in within}
    return edges | {(last, -1): REACHED}


def _first(walk: Bordered, bifurcation: Bifurcation, start: float, ahead: Floats) -> Located | None:
    """The bifurcation itself, at q = ``start``."""
    guess = np.concatenate([bifurcation.state, [bifurcation.value, start]]) / walk.whole
    first = walk.correct(guess, normal=ahead, direction=ahead, reach=0.1)
    if first is not None:
        return first
    line = walk.on_line(guess, held=-1)
    return walk.searched(guess, line, direction=ahead, farthest=0.01)


def _step(walk: Bordered, here: Located, step: float) -> tuple[Located | None, float]:
    """The next point and the step that may follow; None where there is none."""
    while step > SHORTEST:
        guess = here.scaled + step * here.tangent
        there = _tried(walk, here, guess, step)
        if there is None:
            step *= 0.5
            continue
        turn = float(there.tangent @ here.tangent)
        size = float(np.linalg.norm(there.tangent[-2:]))
        if turn > 0.98:
            # as far as the parameters go, where the state hardly moves with them
            longest = LONGEST * max(1.0, float(np.max(np.abs(here.scaled[:-2]))))
            step = min(1.7 * step, max(longest, LONGEST / max(size, 0.05)))
        return there, step
    return None, step


def _tried(walk: Bordered, here: Located, guess: Floats, step: float) -> Located | None:
    """The point at a step's end: by Newton's method, else by a search along the branch."""
    try:
        there = walk.correct(
            guess, normal=here.tangent, matrix=here.matrix, direction=here.tangent,
            reach=0.5 * step,
        )  # fmt: skip
        walk.refused = ""
    except InputError as error:
        there, walk.refused = None, str(error)
    except ConvergenceError:
        there = None
    if there is not None and float(there.tangent @ here.tangent) > ALONG:
        return there
    path = walk.on_circle(here.scaled, step=step * here.tangent)
    if path is None or step < SHORT:
        return None
    try:
        there = walk.searched(guess, path, direction=here.tangent, farthest=AROUND)
    except (InputError, ConvergenceError):
        return None
    if there is None or not float(np.linalg.norm(there.scaled - here.scaled)) < 3.0 * step:
        return None
    chord = there.scaled - here.scaled
    chord = chord / np.linalg.norm(chord)
    # derivatives are of little use here: on along the chord, on a short step around a corner too
    least = ALONG if step > CORNER else AHEAD
    return replace(there, tangent=chord) if float(chord @ here.tangent) > least else None


def _landed(
    walk: Bordered,
    here: Located,
    there: Located,
    marks: Floats,
    edges: dict[tuple[float, int], str],
) -> tuple[list[tuple[Located, bool]], str]:
    """The points of one step, those asked for among them, and why the walk ends there."""
    begin, end = ((point.scaled * walk.whole)[-2:] for point in (here, there))
    places = dict.fromkeys([*((float(q), -1) for q in marks), *edges])
    stops = [
        (value, place, place == -1 and value in marks)
        for value, place in places
        if (value - begin[place]) * (value - end[place]) < 0.0 or value == end[place]
    ]
    found: list[tuple[float, Located | None, bool, str]] = []
    for value, place, mark in stops:
        before, after = here.scaled[place], there.scaled[place]
        if after == before:
            continue
        share = (value / walk.whole[place] - before) / (after - before)
        point = _stopped(walk, here, there, share, place, value)
        found.append((share, point, mark, edges.get((value, place), "")))
    points: list[tuple[Located, bool]] = []
    for share, stop, mark, ended in sorted(found, key=lambda stop: stop[0]):
        if stop is not None:
            points.append((stop, mark))
        if ended:
            return points, ended if stop is not None else LOST
        if share >= 1.0 and stop is not None:
            return points, ""
    return [*points, (there, False)], ""


def _stopped(
    walk: Bordered, here: Located, there: Located, share: float, place: int, value: float
) -> Located | None:
    """The point of a step at which the parameter ``place`` has its ``value``."""
    guess = here.scaled + share * (there.scaled - here.scaled)
    normal = np.zeros(guess.size)
    normal[place] = 1.0
    guess[place] = value / walk.whole[place]
    reach = 0.5 * float(np.linalg.norm(there.scaled - here.scaled))
    try:
        point = walk.correct(
            guess, normal=normal, matrix=here.matrix, direction=here.tangent, reach=reach
        )
        if point is None:
            path = walk.on_line(guess, held=place)
            point = walk.searched(guess, path, direction=here.tangent, farthest=reach)
    except (InputError, ConvergenceError):
        return None
    return point
