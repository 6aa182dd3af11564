"""A fold, period doubling, pitchfork or torus as a curve in two parameters.

Unknown are the state z (d,) on the section and both parameters p and q. The orbit closes, G(z, p,
q) = 0, and one scalar g vanishes. Of a real multiplier s = +1 or -1, with J = DP^n,

    (J - s 1, b; c^T, 0)(v; g) = (0; 1),        dg/da = -w^T (dJ/da) v,

w^T the same of J^T with b and c exchanged; b and c are the singular vectors of the last point, so
that the bordered matrix is regular, also where the curve turns. Of a complex pair g = |mu|^2 - 1
and dmu/da = w^H (dJ/da) v/(w^H v). As second derivatives commute, w^T (dJ/dz_i) v for all i is w^T
times one difference of J along v: a step costs as many runs for thirty coordinates as for one.
J is that of the variational equations; derivatives of J, and those by p and q, are central
differences and steer Newton's method alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike, NDArray

from thermogear.analysis.bifurcations import FLIP, FOLD, PITCHFORK, TORUS, Bifurcation
from thermogear.analysis.curve import Curve
from thermogear.analysis.orbits import multipliers
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics.return_map import is_moved

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
Sheet = Callable[[float, float], object]
"""(p, q) -> model."""

CARRIED = (FOLD, FLIP, PITCHFORK, TORUS)
LONGEST, FIRST, SHORTEST = 0.05, 0.01, 1e-6
"""Steps along the curve, scaled as :class:`~thermogear.analysis.curve.Curve` scales."""
APART = {True: 1e-5, False: 1e-4}
"""Scaled step of the differences: of one mass, and of maps that carry more rounding."""
CLOSED = 1e-12
ROUNDING = 1e-8
"""A residual that no longer falls is rounding below this."""
MOST_STEPS = 10
OUTSIDE = 1e-6
"""Beyond 1 by more, a multiplier other than the one that bifurcates makes the orbit unstable."""
REACHED = "reached the end"
LOST = "no further point"


@dataclass(frozen=True, eq=False, kw_only=True)
class EventCurve:
    """Where one bifurcation lies in the plane of two parameters, in the order of the walk.

    ``kind``, ``parameters`` (p, q) and mesh periods ``period`` of the orbit; ``values`` (point, 2)
    of p and q, ``states`` (point, d), ``multipliers`` (point, d) of the whole orbit; ``stable``:
    no other multiplier lies outside the unit circle, so that a motion meets the bifurcation;
    ``asked``: the point lies at one of the values of q asked for. ``ended``: why.
    """

    kind: str
    parameters: tuple[str, str]
    period: int
    values: Floats
    states: Floats
    multipliers: Complexes
    stable: NDArray[np.bool_]
    asked: NDArray[np.bool_]
    ended: str

    @property
    def turns(self) -> tuple[int, ...]:
        """Points at which the curve turns back in q."""
        steps = np.sign(np.diff(self.values[:, 1]))
        return tuple((np.flatnonzero(steps[1:] * steps[:-1] < 0.0) + 1).tolist())

    def at(self, second: float) -> Floats:
        """Values of p where the curve passes ``second`` of q, straight between its points."""
        p, q = self.values.T
        found = [float(p[i]) for i in range(q.size) if q[i] == second]
        for i in range(q.size - 1):
            if (q[i] - second) * (q[i + 1] - second) < 0.0:
                share = (second - q[i]) / (q[i + 1] - q[i])
                found.append(float(p[i] + share * (p[i + 1] - p[i])))
        return np.array(found)

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
            },
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class _Point:
    """A converged point (d + 2,), its equations' matrix (d + 1, d + 2) and its tangent."""

    scaled: Floats
    matrix: Floats
    tangent: Floats
    jacobian: Floats
    multipliers: Complexes


class _Bordered:
    """G and g over (z, p, q), scaled by the map's units and by both ranges."""

    def __init__(
        self,
        bifurcation: Bifurcation,
        sheet: Sheet,
        second: float,
        *,
        spans: tuple[float, float],
    ) -> None:
        self.kind = bifurcation.kind
        self.bifurcation = bifurcation
        self.sheet = sheet
        self.spans = spans
        self._curves: dict[float, Curve] = {}
        self.unit = self._made(second, bifurcation.value).unit
        self.whole = np.append(self.unit, spans[1])
        self.apart = APART[is_moved(bifurcation.orbit.section)]
        self.root = -1.0 if self.kind in (FLIP, PITCHFORK) else 1.0
        self.mu = complex(self.root)
        if self.kind == TORUS:
            given = bifurcation.multipliers
            off = np.where(np.abs(given.imag) > 1e-9, np.abs(np.abs(given) - 1.0), np.inf)
            mu = complex(given[int(off.argmin())])
            self.mu = complex(mu.real, abs(mu.imag))
        self.borders: tuple[Floats, Floats] | None = None

    def _made(self, second: float, value: float) -> Curve:
        def family(first: float) -> object:
            return self.sheet(first, second)

        broken = self.kind == PITCHFORK
        return Curve(
            family, self.bifurcation.parameter, self.bifurcation.period, start=value,
            span=self.spans[0], mirrors=broken, symmetric=broken,
        )  # fmt: skip

    def curve(self, second: float, value: float) -> Curve:
        """The curve of orbits over p at one q, in the units of the first one."""
        found = self._curves.get(second)
        if found is None:
            for old in list(self._curves)[:-3]:
                del self._curves[old]
            found = self._curves[second] = self._made(second, value)
            found.unit = self.unit
        return found

    def closing(self, scaled: Floats) -> tuple[Floats, Floats]:
        """G (d,) and J (d, d), both scaled."""
        value = scaled * self.whole
        curve = self.curve(float(value[-1]), float(value[-2]))
        gap, jacobian, _ = curve.residual(scaled[:-1])
        units = self.unit[:-1]
        return gap, jacobian / units[:, None] * units

    def border(self, jacobian: Floats) -> None:
        """Take b and c from J, for the points that come."""
        left, _, right = np.linalg.svd(jacobian - self.root * np.eye(len(jacobian)))
        self.borders = (left[:, -1], right[-1])

    def vectors(self, jacobian: Floats) -> tuple[float, Any, Any]:
        """g, and v and w with dg = Re(w (dJ) v)."""
        if self.kind == TORUS:
            values, right = np.linalg.eig(jacobian)
            left = np.linalg.inv(right)
            place = int(np.argmin(np.abs(values - self.mu)))
            mu = complex(values[place])
            return abs(mu) ** 2 - 1.0, right[:, place], 2.0 * np.conj(mu) * left[place]
        if self.borders is None:
            self.border(jacobian)
        assert self.borders is not None
        b, c = self.borders
        d = len(jacobian)
        matrix = np.zeros((d + 1, d + 1))
        matrix[:d, :d] = jacobian - self.root * np.eye(d)
        matrix[:d, d], matrix[d, :d] = b, c
        last = np.append(np.zeros(d), 1.0)
        v, w = np.linalg.solve(matrix, last), np.linalg.solve(matrix.T, last)
        return float(v[d]), v[:d], -w[:d]

    def residual(self, scaled: Floats) -> tuple[Floats, Floats]:
        """(G, g) (d + 1,) and J."""
        gap, jacobian = self.closing(scaled)
        if not (np.all(np.isfinite(gap)) and np.all(np.isfinite(jacobian))):
            return np.full(gap.size + 1, np.nan), jacobian
        return np.append(gap, self.vectors(jacobian)[0]), jacobian

    def matrix(self, scaled: Floats, jacobian: Floats) -> Floats:
        """d(G, g)/d(z, p, q), (d + 1, d + 2)."""
        d = len(jacobian)
        found = np.zeros((d + 1, d + 2))
        found[:d, :d] = jacobian - np.eye(d)
        _, v, w = self.vectors(jacobian)
        for factor, along in ((1.0, np.real(v)), (1j, np.imag(v))):
            size = float(np.linalg.norm(along))
            if size > 0.0:
                _, change = self._apart(scaled, np.append(along / size, [0.0, 0.0]))
                found[d, :d] += size * (factor * (w @ change)).real
        for column in (d, d + 1):
            gap, change = self._apart(scaled, np.eye(d + 2)[column])
            found[:d, column] = gap
            found[d, column] = (w @ change @ v).real
        return found

    def _apart(self, scaled: Floats, along: Floats) -> tuple[Floats, Floats]:
        """Derivatives of G and J along a direction, one-sided at a parameter's border."""
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                parts = [
                    (weight, self.closing(scaled + k * self.apart * along))
                    for k, weight in weights.items()
                ]
            except InputError:
                continue
            gap = sum(weight * one[0] for weight, one in parts)
            change = sum(weight * one[1] for weight, one in parts)
            return np.asarray(gap / self.apart), np.asarray(change / self.apart)
        raise InputError("parameter", (scaled * self.whole)[-2:].tolist(), allowed="neighbours")

    def correct(
        self,
        guess: Floats,
        *,
        normal: Floats,
        matrix: Floats | None = None,
        direction: Floats | None = None,
        reach: float = np.inf,
    ) -> _Point | None:
        """Newton onto the curve in the plane through ``guess`` normal to ``normal``.

        It begins with a ``matrix`` from nearby, and takes a fresh one where that converges slowly.
        """
        scaled, own = guess.copy(), matrix
        best: tuple[float, Floats, Floats] | None = None
        last, stalled = np.inf, 0
        for _ in range(MOST_STEPS):
            rest, jacobian = self.residual(scaled)
            size = float(np.max(np.abs(rest)))
            if not np.isfinite(size):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian), 0
            else:
                stalled += 1
            if size <= CLOSED or (stalled and best[0] < 0.1 * ROUNDING) or stalled > 2:
                break
            if own is None or size > 0.2 * last:
                own = self.matrix(scaled, jacobian)
            last = size
            whole = np.vstack([own, normal])
            try:
                step = np.linalg.solve(whole, np.append(-rest, -normal @ (scaled - guess)))
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        _, scaled, jacobian = best
        own = self.matrix(scaled, jacobian)
        if not np.all(np.isfinite(own)):
            return None
        tangent = np.linalg.svd(own)[2][-1]
        if direction is not None and tangent @ direction < 0.0:
            tangent = -tangent
        return _Point(
            scaled=scaled,
            matrix=own,
            tangent=tangent,
            jacobian=jacobian,
            multipliers=self.orbit_multipliers(scaled, jacobian),
        )

    def orbit_multipliers(self, scaled: Floats, jacobian: Floats) -> Complexes:
        """Those of the whole orbit, also of a symmetric one."""
        units = self.unit[:-1]
        mine = jacobian * units[:, None] / units
        value = scaled * self.whole
        section = self.curve(float(value[-1]), float(value[-2])).map_at(float(value[-2]))
        period = self.bifurcation.period
        whole = mine @ mine if self.kind == PITCHFORK else mine
        return multipliers(whole, section.determinant(period))

    def settle(self, point: _Point) -> None:
        """Take borders and multiplier from a point, for those that come."""
        self.border(point.jacobian)
        if self.kind == TORUS:
            values = np.linalg.eigvals(point.jacobian).astype(complex)
            self.mu = complex(values[int(np.argmin(np.abs(values - self.mu)))])

    def stable(self, found: Complexes) -> bool:
        """Whether no multiplier but those that bifurcate lies outside the unit circle."""
        outside = int(np.sum(np.abs(found) > 1.0 + OUTSIDE))
        if outside == 0:
            return True
        near = np.abs(np.abs(found) - 1.0)
        own = 2 if self.kind == TORUS else 1
        rest = np.delete(found, np.argsort(near)[:own])
        return not bool(np.any(np.abs(rest) > 1.0 + OUTSIDE))


def event_curve(
    bifurcation: Bifurcation,
    sheet: Sheet,
    names: tuple[str, str],
    *,
    start: float,
    asked: ArrayLike,
    limits: tuple[float, float],
    most_points: int = 400,
    progress: Callable[[int, float], None] | None = None,
) -> EventCurve:
    """Follow ``bifurcation``, located at q = ``start``, in p and q to the last value ``asked``.

    ``sheet`` (p, q) -> model in the model's units, ``names`` of both parameters; ``limits`` of p,
    between which the curve is followed. Pseudo-arclength continuation, around turning points in
    either parameter; points are also computed at every value of q ``asked`` for on the way. It
    ends at the last of these, at a limit of p, back at ``start``, where no further point is found,
    where a complex pair of multipliers turns real, or after ``most_points``: ``ended`` says it.

    Raises InputError for a grazing or a birth, which have no multiplier of their own;
    ConvergenceError where the bifurcation is not found at ``start``.
    """
    if bifurcation.kind not in CARRIED:
        raise InputError("bifurcation", bifurcation.kind, allowed=" | ".join(CARRIED))
    one_mass = is_moved(bifurcation.orbit.section)
    if bifurcation.kind == PITCHFORK and not one_mass:
        raise InputError("bifurcation", PITCHFORK, why="of a model of more than one mass")
    marks = np.atleast_1d(np.asarray(asked, dtype=float))
    if not np.all(np.isfinite(marks)) or marks.size == 0 or marks[-1] == start:
        raise InputError("asked", marks.tolist(), allowed=f"finite, the last not {start}")
    low, high = sorted(limits)
    spans = (max(high - low, 1e-300), abs(float(marks[-1]) - start))
    walk = _Bordered(bifurcation, sheet, start, spans=spans)
    d = bifurcation.state.size
    ahead = np.zeros(d + 2)
    ahead[-1] = float(np.sign(marks[-1] - start))
    guess = np.concatenate([bifurcation.state, [bifurcation.value, start]]) / walk.whole
    first = walk.correct(guess, normal=ahead, direction=ahead, reach=0.1)
    if first is None:
        raise ConvergenceError(
            f"the {bifurcation.kind} at {names[0]} = {bifurcation.value!r} was not found again at "
            f"{names[1]} = {start!r}"
        )
    points, at_mark = [first], [bool(np.any(marks == start))]
    ended = ""
    step, here = FIRST, first
    walk.settle(first)
    while not ended:
        there, step = _step(walk, here, step)
        if there is None:
            ended = LOST
            break
        found, ended = _landed(walk, here, there, marks, (low, high), start, names)
        for point, mark in found:
            points.append(point)
            at_mark.append(mark)
        if progress is not None:
            progress(len(points), float((points[-1].scaled * walk.whole)[-1]))
        walk.settle(there)
        if walk.kind == TORUS and abs(walk.mu.imag) < 1e-4:
            ended = ended or f"the complex pair of multipliers became real ({walk.mu.real:+.3f})"
        if len(points) > most_points:
            ended = ended or f"{most_points} points"
        here = there
    scaled = np.array([one.scaled for one in points])
    return EventCurve(
        kind=bifurcation.kind,
        parameters=names,
        period=bifurcation.period,
        values=scaled[:, -2:] * walk.whole[-2:],
        states=scaled[:, :-2] * walk.unit[:-1],
        multipliers=np.array([one.multipliers for one in points]),
        stable=np.array([walk.stable(one.multipliers) for one in points]),
        asked=np.array(at_mark),
        ended=ended,
    )


def _step(walk: _Bordered, here: _Point, step: float) -> tuple[_Point | None, float]:
    """The next point and the step that may follow; None where there is none."""
    while step > SHORTEST:
        guess = here.scaled + step * here.tangent
        there = None
        try:
            there = walk.correct(
                guess, normal=here.tangent, matrix=here.matrix, direction=here.tangent,
                reach=0.5 * step,
            )  # fmt: skip
        except (InputError, ConvergenceError):
            there = None
        if there is not None and float(there.tangent @ here.tangent) > 0.9:
            turn = float(there.tangent @ here.tangent)
            size = float(np.linalg.norm(there.tangent[-2:]))
            if turn > 0.98:
                # as far as the parameters go, where the state hardly moves with them
                longest = LONGEST * max(1.0, float(np.max(np.abs(here.scaled[:-2]))))
                step = min(1.7 * step, max(longest, LONGEST / max(size, 0.05)))
            return there, step
        step *= 0.5
    return None, step


def _landed(
    walk: _Bordered,
    here: _Point,
    there: _Point,
    marks: Floats,
    limits: tuple[float, float],
    start: float,
    names: tuple[str, str],
) -> tuple[list[tuple[_Point, bool]], str]:
    """The points of one step, those asked for among them, and why the walk ends there."""
    (p0, q0), (p1, q1) = ((one.scaled * walk.whole)[-2:] for one in (here, there))
    stops = [(float(q), -1, True) for q in marks if (q - q0) * (q - q1) < 0.0 or q == q1]
    way = np.sign(marks[-1] - start)
    ended = ""
    if way * (q1 - marks[-1]) >= 0.0:
        ended = REACHED
    elif way * (q1 - start) < 0.0:
        stops.append((start, -1, False))
        ended = f"came back to the first value of {names[1]}"
    for limit in limits:
        if (p1 - limit) * (p0 - limit) < 0.0:
            stops.append((limit, -2, False))
            ended = f"left the range of {names[0]}"
    found: list[tuple[float, _Point, bool]] = []
    for value, place, mark in stops:
        before, after = here.scaled[place], there.scaled[place]
        if after == before:
            continue
        share = (value / walk.whole[place] - before) / (after - before)
        guess = here.scaled + share * (there.scaled - here.scaled)
        normal = np.zeros(guess.size)
        normal[place] = 1.0
        guess[place] = value / walk.whole[place]
        point = walk.correct(guess, normal=normal, matrix=here.matrix, direction=here.tangent)
        if point is not None:
            found.append((share, point, mark))
    found.sort(key=lambda one: one[0])
    if ended:
        last = next((i for i, one in enumerate(found) if not one[2] or one[0] >= 1.0), None)
        border = [one for one in found if one[0] <= 1.0]
        return [(point, mark) for _, point, mark in border or found[: (last or 0) + 1]], ended
    if not any(share >= 1.0 for share, _, _ in found):
        found.append((1.0, there, False))
    return [(point, mark) for _, point, mark in found], ended
