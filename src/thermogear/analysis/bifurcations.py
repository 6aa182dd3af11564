"""Where a branch of periodic orbits bifurcates between two of its points, and on what side."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from operator import attrgetter

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import root_scalar

from thermogear.analysis.curve import Curve, Family, Point, Stretch
from thermogear.analysis.orbits import Orbit
from thermogear.base.arrays import Floats
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.base.vocabulary import contact_name
from thermogear.dynamics.return_map import MovedMap, is_moved

FOLD = "fold"
FLIP = "period doubling"
GRAZING = "grazing"
BIRTH = "period halving"
PITCHFORK = "pitchfork"
"""Only where the equation has a symmetry: an orbit that is its own mirror image loses it.

Also of a drive train with alike halves left and right of its gears.
"""
TORUS = "torus"
"""A complex pair of multipliers leaves or enters the unit circle (Neimark-Sacker)."""
SUPERCRITICAL = "supercritical"
SUBCRITICAL = "subcritical"
VERTICAL = "vertical: linear until the contact changes"

LONGEST_STEP = 0.05
LOOK_CLOSER = 1e-3
"""Between points nearer than this no second event of a kind is looked for."""
HIDDEN = ("tests.fold", "tests.flip", "margin", "tests.spiral")
"""What of a point may dip to 0 and back within a step."""
SILENT = 1e-11
"""A test function below this is rounding: of orbits that float in the gap it is 0 all along."""
DOUBLED = (1e-4, 3e-5, 1e-3, 1e-5, 3e-4, 3e-3, 1e-2)
"""Amplitudes (scaled) at which a doubled orbit is looked for near its flip."""


@dataclass(frozen=True)
class Bifurcation:
    """Where a branch changes.

    ``kind`` fold, period doubling, grazing, period halving, pitchfork or torus; ``parameter`` and
    its ``value``, the ``orbit`` there; ``note`` says what a grazing begins or ends, and of a period
    doubling or pitchfork whether it is supercritical (the new orbits are stable and live where
    the old one no longer is), subcritical (they are unstable and live where it still is) or, in
    lasting contact, vertical (they all live at the value itself until they lose contact).
    """

    kind: str
    parameter: str
    value: float
    orbit: Orbit
    note: str = ""

    @property
    def period(self) -> int:
        """Mesh periods of the orbit that bifurcates."""
        return self.orbit.period

    @property
    def state(self) -> Floats:
        """(x, x') of the orbit at phase 0."""
        return self.orbit.state

    @property
    def multipliers(self) -> NDArray[np.complex128]:
        """Floquet multipliers of the orbit."""
        return self.orbit.multipliers


def locate(curve: Curve, a: Point, b: Point) -> list[Bifurcation]:
    """Bifurcations between two neighbouring points, in the order of the walk."""
    stretch = Stretch(curve, a, b)
    length = stretch.length
    events: list[tuple[float, Bifurcation]] = []
    nodes = {0.0, length}
    for graze, note in _grazes(stretch):
        nodes.add(graze)
        events.append((graze, _bifurcation(curve, stretch.at(graze), GRAZING, note)))
        # multipliers turn sharply where contact changes: folds come in pairs close by
        for near in (1e-6, 1e-5, 1e-4, 1e-3):
            steps = {s for s in (graze - near, graze + near) if 0.0 < s < length}
            nodes |= {s for s in steps if stretch.closes(s)}
    broken = PITCHFORK if curve.symmetric else FLIP
    for low, high in pairwise(sorted(nodes)):
        if crossed(stretch.at(low), stretch.at(high)):
            # turns back without a multiplier beyond +1: into an orbit's mirror image
            step = stretch.zero(_ahead, low=low, high=high)
            events.append((step, _bifurcation(curve, stretch.at(step), PITCHFORK)))
        for name, kind in (("fold", FOLD), ("flip", broken), *_tori(stretch)):
            test = attrgetter(f"tests.{name}")
            one, other = test(stretch.at(low)), test(stretch.at(high))
            if one * other < 0.0 and min(abs(one), abs(other)) > SILENT:
                step = stretch.zero(test, low=low, high=high)
                ahead = _ahead(stretch.at(low)) * _ahead(stretch.at(high))
                if kind == FOLD and curve.dimension > 2 and ahead > 0.0:
                    kind = PITCHFORK  # a multiplier passes +1 although the branch does not turn
                if kind == TORUS and not _complex_pair(stretch.at(step)):
                    continue  # mu and 1/mu, both real
                events.append((step, _bifurcation(curve, stretch.at(step), kind)))
    return [event for _, event in sorted(events, key=lambda pair: pair[0])]


def _ahead(point: Point) -> float:
    """How fast the parameter grows along the branch."""
    return float(point.tangent[-1])


def crossed(a: Point, b: Point) -> bool:
    """Whether a branch of long states turns back between two points without a fold.

    At a fold (1 - mu_1)(1 - mu_2)... changes sign with the parameter's direction. Where only one of
    them does, branches cross: in a train that is its own mirror image, two motions that mirror each
    other meet in one that does not change by it.
    """
    long = a.scaled.size > 3
    return long and _ahead(a) * _ahead(b) < 0.0 and a.tests.fold * b.tests.fold > 0.0


def _tori(stretch: Stretch) -> tuple[tuple[str, str], ...]:
    """The test for a complex pair, where one can cross: not of two multipliers of known product."""
    known = stretch.curve.dimension == 2 and not np.isnan(stretch.first.determinant)
    return () if known else (("torus", TORUS),)


def _complex_pair(point: Point) -> bool:
    """Whether the two multipliers whose product is nearest to 1 are a complex pair."""
    mu = np.linalg.eigvals(point.visit.jacobian).astype(complex)
    one, other = np.triu_indices(mu.size, 1)
    pair = int(np.argmin(np.abs(1.0 - mu[one] * mu[other])))
    return bool(abs(mu[one[pair]].imag) > 1e-6)


def _grazes(stretch: Stretch) -> Iterator[tuple[float, str]]:
    """Where contact changes on a stretch, and what does.

    There an extreme of x meets an edge of the backlash. Its distance from the edge, with the sign
    of whether contact is still as it was, runs smoothly through 0.
    """

    def counts(point: Point) -> tuple[int, ...]:
        # both sides of a symmetric orbit graze at once, whichever rounding sees first
        return point.contacts[:1] * 2 if stretch.curve.symmetric else point.contacts

    start, before = 0.0, counts(stretch.at(0.0))
    while before != counts(stretch.at(stretch.length)):
        known = before

        def same(point: Point, known: tuple[int, ...] = known) -> bool:
            return counts(point) == known

        def apart(point: Point, same: Callable[[Point], bool] = same) -> float:
            size = min(max(point.margin, 1e-300), 1.0)
            return size if same(point) else -size

        try:
            found = stretch.zero(apart, low=start, high=stretch.length)
        except ConvergenceError:
            found = stretch.narrowed(same, start)
        high = min(
            step
            for step, point in stretch.points.items()
            if step > max(start, found - 2.0 * stretch.near) and counts(point) != before
        )
        after = counts(stretch.at(high))
        names = [f"losses of {contact_name(n)}" for n in range(2, len(after))]
        rows = zip(("contact losses", "back-side impacts", *names), before, after, strict=True)
        yield high, ", ".join(f"{name} per orbit {a} -> {b}" for name, a, b in rows if a != b)
        start, before = high, after


def _bifurcation(curve: Curve, point: Point, kind: str, note: str = "") -> Bifurcation:
    """The bifurcation at a point, of a flip or a pitchfork with its side."""
    value = float(point.scaled[-1] * curve.span)
    found = Bifurcation(kind, curve.parameter, value, curve.orbit(point), note)
    if kind == FLIP or (kind == PITCHFORK and is_moved(found.orbit.section)):
        found = replace(found, note=criticality(found, curve.family))
    return found


def looked_closer(curve: Curve, before: Point | None, a: Point, b: Point) -> list[Point]:
    """The points from ``a`` (left out) to ``b``, so near that no pair of events hides between.

    Two folds, flips or grazings in one step leave every sign and count as it was. A parabola
    through three neighbours, bent four times as much, says how far a test function may dip
    between two of them; where it may reach zero, the point half way is computed.
    """
    length = float((b.scaled - a.scaled) @ a.tangent)
    if length <= LOOK_CLOSER or not _may_hide(before, a, b):
        return [b]
    stretch = Stretch(curve, a, b)
    half = stretch.between(low=0.0, high=length)
    middle = stretch.at(0.5 * length if half is None else half)
    return [
        *looked_closer(curve, b, a, middle),
        *looked_closer(curve, a, middle, b),
    ]


def _may_hide(beside: Point | None, a: Point, b: Point) -> bool:
    if beside is None:
        # the first step of a walk is short; only next to a zero anything may hide in it
        values = attrgetter(*HIDDEN)
        pairs = zip(map(abs, values(a)), map(abs, values(b)), strict=True)
        return any(min(one, other) < 4.0 * abs(one - other) + LOOK_CLOSER for one, other in pairs)
    width = float(np.linalg.norm(b.scaled - a.scaled))
    near, far = (float(np.linalg.norm(p.scaled - beside.scaled)) for p in (a, b))
    along = -near if near < far else width + far
    for name in HIDDEN:
        one, other, third = (float(attrgetter(name)(p)) for p in (a, b, beside))
        if (name != "margin" and one * other < 0.0) or not np.isfinite(one + other + third):
            continue
        slope = (other - one) / width
        bend = ((third - one) / along - slope) / (along - width)
        # of one + slope s + 4 bend s (s - width) the extreme on the way, towards zero
        sign = 1.0 if one > 0.0 else -1.0
        bent = 4.0 * sign * bend
        if bent <= 0.0:
            continue
        s = 0.5 * (width - sign * slope / bent)
        if 0.0 < s < width and sign * one + sign * slope * s + bent * s * (s - width) <= 0.0:
            return True
    return False


def criticality(bifurcation: Bifurcation, family: Family) -> str:
    """Whether a period doubling or a pitchfork is supercritical; "" where no orbit shows it.

    The multiplier of the new orbits near it that was +1 is below 1 (they are stable, and live
    where the old orbit is not) or above. An orbit in lasting contact is neither: there the
    equation is linear (Hill's), and orbits of every size exist at the same value.
    """
    orbit = bifurcation.orbit
    linear = is_moved(orbit.section)
    if linear and orbit.contact_losses == 0 and orbit.back_impacts == 0:
        return VERTICAL
    try:
        curve, _, point = doubled_beside(bifurcation, family)
    except ConvergenceError:
        return ""
    if curve.dimension == 2:
        return SUPERCRITICAL if point.tests.fold > 0.0 else SUBCRITICAL
    mu = np.linalg.eigvals(point.visit.jacobian)
    nearest = mu[np.argmin(np.abs(mu - 1.0))].real
    return SUPERCRITICAL if nearest < 1.0 else SUBCRITICAL


def _halved(orbit: Orbit) -> MovedMap:
    """The map of an orbit of one mass, which goes by half periods too."""
    if not is_moved(orbit.section):
        raise InputError("orbit", type(orbit.section).__name__, allowed="one of one mass")
    return orbit.section


def doubled_beside(bifurcation: Bifurcation, family: Family) -> tuple[Curve, Floats, Point]:
    """An orbit near a flip (of twice the period) or a pitchfork (no longer symmetric).

    With its curve and the scaled direction (d + 1,) that leads to it, along the eigenvector of the
    multiplier -1 of the flipping map. Raises ConvergenceError where none is found.
    """
    orbit = bifurcation.orbit
    value = bifurcation.value
    span = max(abs(value), 1e-3)
    broken = bifurcation.kind == PITCHFORK
    period = orbit.period if broken else 2 * orbit.period
    curve = Curve(family, bifurcation.parameter, period, start=value, span=span, mirrors=broken)
    units = curve.unit[:-1]
    jacobian = -_halved(orbit).flow(orbit.state, period)[1] if broken else orbit.jacobian
    matrix = jacobian / units[:, None] * units
    direction = np.linalg.svd(matrix + np.eye(units.size))[2][-1]
    normal = np.append(direction, 0.0)
    centre = np.append(orbit.state, value) / curve.unit
    for amplitude in DOUBLED:
        point = curve.correct(
            centre + amplitude * normal, normal=normal, old=normal, reach=10.0 * amplitude
        )
        if point is None:
            continue
        # half way round, a doubled orbit stands on the other side of the flipping one; the
        # flipping orbit itself, elsewhere on its branch, stands where it started
        gap = mothers_of(curve, point).get(PITCHFORK if broken else BIRTH)
        if gap is not None and np.linalg.norm(gap) > amplitude:
            return curve, normal, point
    raise ConvergenceError(
        f"no orbit found beside the {bifurcation.kind} of period {orbit.period} at "
        f"{bifurcation.parameter} = {value!r}"
    )


def mothers_of(curve: Curve, point: Point) -> dict[str, Floats]:
    """How far the orbit is from the mothers it may have, scaled (d,), by how it left them.

    Of an even period: from itself half its period later, 0 where it has shrunk into an orbit
    of half its period. In a symmetric equation: from its own mirror image, 0 where it has
    become symmetric. Empty where there is no such mother.
    """
    points = point.visit.points
    found: dict[str, Floats] = {}
    if curve.symmetric:
        return found
    if curve.period % 2 == 0:
        found[BIRTH] = np.asarray((points[curve.period // 2] - points[0]) / curve.unit[:-1])
    section = curve.map_at(float(point.scaled[-1] * curve.span)) if curve.mirrors else None
    if is_moved(section):
        end, _ = section.flow(points[0], curve.period)
        found[PITCHFORK] = np.asarray((end + points[0]) / curve.unit[:-1])
    return found


def passed_mother(curve: Curve, a: Point, b: Point) -> str:
    """How a branch went through its mother orbit and on as its own image; "" where it did not."""
    first, then = mothers_of(curve, a), mothers_of(curve, b)
    for kind in first.keys() & then.keys():
        closes = float(np.max(np.abs(then[kind]))) < 1e-9
        if closes or float(first[kind] @ then[kind]) < 0.0:
            return kind
    return ""


def birth_of(curve: Curve, a: Point, kind: str) -> Bifurcation | None:
    """The flip or pitchfork of the mother orbit near ``a``; None when not found."""
    broken = kind == PITCHFORK
    start = float(a.scaled[-1] * curve.span)
    away = mothers_of(curve, a)[kind]
    # half way between the orbit and its image: z_0 and z_n/2, or z_0 and -z(n T/2)
    centre = a.scaled[:-1] + (-0.5 if broken else 0.5) * away
    mother = Curve(
        curve.family,
        curve.parameter,
        curve.period if broken else curve.period // 2,
        start=start,
        span=curve.span,
        mirrors=broken,
        symmetric=broken,
    )
    units = curve.unit[:-1] / mother.unit[:-1]

    def there(value: float) -> Point | None:
        if not np.isfinite(value):
            return None
        return mother.correct(np.append(centre * units, value / curve.span), normal=mother.upright)

    def flip(value: float) -> float:
        point = there(value)
        return np.nan if point is None else point.tests.flip

    near = max(1e-13, 4.0 * float(np.spacing(abs(start))))
    found = root_scalar(flip, method="secant", x0=start, x1=start + 1e-4 * curve.span, xtol=near)
    if not found.converged or not abs(found.root - start) < LONGEST_STEP * curve.span:
        return None
    point = there(float(found.root))
    if point is None:
        return None
    born = Bifurcation(kind, curve.parameter, float(found.root), mother.orbit(point))
    return replace(born, note=criticality(born, curve.family)) if broken else born
