"""The closed loop of friction and heat, iterated so that it keeps the order of states.

A state is the temperature of every free node, shape (count, nodes); every operating point goes
its own way and knows nothing of the others.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from thermogear.base.bounds import BODY
from thermogear.base.errors import ThermogearError, ValidityWarning

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]

HOTTEST = 700.0
"""Iterates [K] are held below it; a point that ends there has no steady state worth a name."""

FIRST, LARGEST, SHARE = 2.0, 8.0, 0.15
"""First step of a point [K]; largest one [K], or this share of the way it still has to go."""
CAREFUL = 0.8
"""Part of the step that would just keep the order of states by the last slope."""
NEAR, NEAREST, FARTHEST = 0.5, 1.0, 10.0
"""Change [K] below which steps are extrapolated; how far [K] and how many times they then go."""
WARMER, TRIALS = 5.0, 16
"""A start at which no law answers is made warmer by this [K], this often."""


class Response(NamedTuple):
    """What the network's steady state at the losses of a state is [K], and whether it counts."""

    reached: Floats
    known: Flags


Respond = Callable[[Floats, Indices], Response]


@dataclass(eq=False, kw_only=True)
class Course:
    """Where the iteration from one start ended, arrays (count, ...).

    ``nodes`` [K]; ``iterations``; ``residual`` [K] the greatest change of a node in the last
    one; ``lost``: in one line, by the place of the point, why it has no value.
    """

    nodes: Floats
    iterations: NDArray[np.int64]
    residual: Floats
    known: Flags
    lost: dict[int, str] = field(default_factory=dict)

    def part(self, places: slice) -> Course:
        """The points at ``places``, a slice without steps, counted from its start."""
        lost = range(places.start, places.stop)
        return Course(
            nodes=self.nodes[places],
            iterations=self.iterations[places],
            residual=self.residual[places],
            known=self.known[places],
            lost={p - lost.start: why for p, why in self.lost.items() if p in lost},
        )

    def settled(self, tolerance: float) -> Flags:
        """Whether a point ended at a steady state."""
        found = (self.residual <= tolerance) & self.known
        found[list(self.lost)] = False
        return np.asarray(found)


def asked(respond: Respond, nodes: Floats, index: Indices, lost: dict[int, str]) -> Response:
    """``respond``, with the points at which it raises named in ``lost`` and left as they are.

    A batch that is refused is halved until the points that fail are alone.
    """
    try:
        return respond(nodes, index)
    except ThermogearError as error:
        if index.size == 1:
            lost[int(index[0])] = str(error)
            return Response(nodes.copy(), np.zeros(1, np.bool_))
    middle = index.size // 2
    parts = [
        asked(respond, nodes[part], index[part], lost)
        for part in (slice(None, middle), slice(middle, None))
    ]
    return Response(*(np.concatenate(both) for both in zip(*parts, strict=True)))


def follow(
    respond: Respond, start: Floats, held: Flags, *, tolerance: float, most_iterations: int
) -> Course:
    """Iterate T <- T + w (N(T) - T) from ``start`` to a fixed point, every point by itself.

    Each step is a part w <= 1 of the way to the network's steady state N(T), so small that by
    the last slope of N it keeps the order of states (w < 1/(1 - N') where N falls), and never
    more than a few kelvins. Where N keeps the order, iterates from below all steady states rise
    to the lowest of them, and from above fall to the highest: the iteration cannot step over
    one. Near the end, within :data:`NEAR`, steps are extrapolated by Aitken's factor.

    ``held`` (count, nodes): nodes of given temperature. A start that the laws refuse is made
    warmer, in steps of 5 K; a point that is refused later is lost, and stays where it was.
    """
    count = start.shape[0]
    found = Course(
        nodes=start.copy(),
        iterations=np.zeros(count, np.int64),
        residual=np.full(count, np.inf),
        known=np.zeros(count, np.bool_),
    )
    factor, before = np.ones(count), np.full(start.shape, np.nan)
    moved = np.full(start.shape, np.nan)
    going = np.arange(count)
    with warnings.catch_warnings():
        # iterates on the way may leave an oil's range; the result is asked once more
        warnings.simplefilter("ignore", ValidityWarning)
        answer = _first(respond, found, held)
        going = going[[place not in found.lost for place in going]]
        for turn in range(most_iterations):
            if not going.size:
                break
            refused: dict[int, str] = {}
            if turn:
                answer = asked(respond, found.nodes[going], going, refused)
            else:
                answer = Response(answer.reached[going], answer.known[going])
            change = answer.reached - found.nodes[going]
            residual = np.abs(change).max(axis=1)
            found.residual[going], found.known[going] = residual, answer.known
            found.iterations[going] += 1
            found.lost |= refused
            step, factor[going] = _steps(change, before[going], moved[going], factor[going])
            before[going], moved[going] = change, step
            on = (residual > tolerance) & [place not in refused for place in going]
            going = going[on]
            found.nodes[going] = np.clip(found.nodes[going] + step[on], BODY.least, BODY.most)
    return found


def _first(respond: Respond, found: Course, held: Flags) -> Response:
    """The answer at the start, which is made warmer where it is refused."""
    everything = np.arange(found.nodes.shape[0])
    answer = asked(respond, found.nodes, everything, found.lost)
    for _ in range(TRIALS):
        again = np.array(sorted(found.lost), dtype=np.int64)
        if not again.size:
            break
        warm = np.minimum(found.nodes[again] + WARMER, BODY.most)
        found.nodes[again] = np.where(held[again], found.nodes[again], warm)
        reasons: dict[int, str] = {}
        part = asked(respond, found.nodes[again], again, reasons)
        answer.reached[again], answer.known[again] = part.reached, part.known
        # the first refusal says why
        found.lost = {place: found.lost[place] for place in reasons}
    return answer


def _steps(change: Floats, before: Floats, moved: Floats, factor: Floats) -> tuple[Floats, Floats]:
    """The next step [K] of each point and its Aitken factor, from the last change and step."""
    residual = np.abs(change).max(axis=1)
    square = np.einsum("ij,ij->i", moved, moved)
    along = np.einsum("ij,ij->i", change - before, moved)
    known = np.isfinite(square) & (square > 0.0)
    # N' along the last step: change = N(T) - T
    slope = 1.0 + np.divide(along, square, out=np.zeros_like(residual), where=known)
    part = np.minimum(1.0, CAREFUL / (1.0 + np.maximum(-slope, 0.0)))
    part = np.where((slope >= 0.0) & known, 1.0, part)
    furthest = np.where(known, np.maximum(LARGEST, SHARE * residual), FIRST)
    careful = np.minimum(part, furthest / np.maximum(residual, 1e-300))
    extrapolated = np.clip(aitken(factor, before=before, change=change), 0.05, FARTHEST)
    near = np.isfinite(before).all(axis=1) & (residual <= NEAR)
    close = np.minimum(extrapolated, NEAREST / np.maximum(residual, 1e-300))
    chosen = np.where(near, close, careful)
    return chosen[:, None] * change, chosen


def aitken(factor: Floats, *, before: Floats, change: Floats) -> Floats:
    """Aitken's relaxation factor of each point from its last two changes."""
    turn = change - before
    square = np.einsum("ij,ij->i", turn, turn)
    along = np.einsum("ij,ij->i", before, turn)
    known = np.isfinite(square) & (square > 0.0)
    return np.asarray(-factor * np.divide(along, square, out=-np.ones_like(factor), where=known))
