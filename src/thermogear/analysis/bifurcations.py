"""Points of a branch of periodic orbits, and where between two of them it bifurcates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq, root_scalar

from thermogear.analysis.orbits import Orbit, closed
from thermogear.analysis.section import ReturnMap, Visit, lanes_of, scales
from thermogear.base.errors import ConvergenceError, InputError
from thermogear.dynamics import exact
from thermogear.dynamics.tables import Lanes

Floats = NDArray[np.float64]
Family = Callable[[float], object]

FOLD = "fold"
FLIP = "period doubling"
GRAZING = "grazing"
BIRTH = "period halving"
PITCHFORK = "pitchfork"
"""Only where the equation has a symmetry: an orbit that is its own mirror image loses it."""
SUPERCRITICAL = "supercritical"
SUBCRITICAL = "subcritical"
VERTICAL = "vertical: linear until the contact changes"

NEWTON_TOLERANCE = 1e-14
ROUNDING = 1e-10
"""A residual that no longer falls is rounding below this (scaled); a long orbit carries its own."""
LONGEST_STEP = 0.05
LOOK_CLOSER = 1e-3
"""Between points nearer than this no second event of a kind is looked for."""
SILENT = 1e-11
"""A test function below this is rounding: of orbits that float in the gap it is 0 all along."""
SMALL = 1e-5
"""Step of the parameter (of its range) in which the coefficients are differentiated.

Rounding, 1/SMALL times enlarged, and the curvature, SMALL^2, are alike in size. It turns the
tangent a little: points slip along the branch, by 1e-13, and not off it.
"""
DOUBLED = (1e-4, 3e-5, 1e-3, 1e-5, 3e-4, 3e-3, 1e-2)
"""Amplitudes (scaled) at which a doubled orbit is looked for beside its flip."""


@dataclass(frozen=True)
class Bifurcation:
    """Where a branch changes.

    ``kind`` fold, period doubling, grazing, period halving or pitchfork; ``parameter`` and its
    ``value``, the ``orbit`` there; ``note`` says what a grazing begins or ends, and of a period
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


@dataclass(frozen=True, kw_only=True)
class Point:
    """A converged point of a branch in scaled coordinates, with its tangent.

    ``visit`` runs over the whole orbit, ``determinant`` is that of its Jacobian. ``trace`` and
    ``closing`` are trace and determinant of the map whose fixed point it is: the orbit's own, or
    of a symmetric orbit half of it with the sign reversed. ``margin``: how near an extreme of x
    comes to an edge of the backlash, in half backlashes (inf: not computed).
    """

    scaled: Floats
    tangent: Floats
    visit: Visit
    determinant: float
    trace: float
    closing: float
    margin: float = np.inf

    @property
    def fold(self) -> float:
        """(1 - mu_1)(1 - mu_2)."""
        return 1.0 - self.trace + self.closing

    @property
    def flip(self) -> float:
        """(1 + mu_1)(1 + mu_2)."""
        return 1.0 + self.trace + self.closing

    @property
    def contacts(self) -> tuple[int, int]:
        return self.visit.contact_losses, self.visit.back_impacts

    @property
    def floats(self) -> bool:
        """Whether the orbit never touches a tooth."""
        return self.contacts == (0, 0) and float(self.visit.shares[1]) > 0.5


def mirrored(lanes: Lanes, period: int) -> bool:
    """Whether x(t) -> -x(t + n T/2) takes solutions to solutions, n = ``period``.

    Of odd n a force of odd orders and a stiffness of even ones do it, of even n no force at all.
    """
    tables = (*lanes.stiffness_pieces, *lanes.force_pieces)
    if any(piece is not None for piece in tables):
        return False
    if period % 2 == 0:
        return not np.any(lanes.force)
    return not (np.any(lanes.force[:, ::2]) or np.any(lanes.stiffness[:, 1::2]))


class Curve:
    """G(z, p) = P^n(z; p) - z in coordinates scaled by b, 2 pi b/T and the parameter's range.

    ``mirrors``: :func:`mirrored` holds all along. On a ``symmetric`` branch, of orbits with
    x(t + n T/2) = -x(t), P^n is the square of the map H = -(half an orbit), and G = H(z; p) - z:
    where its symmetry breaks the orbit has a multiplier +1 of P^n, but -1 of H, so that the
    branch runs through the pitchfork as any branch runs through a flip.
    """

    def __init__(
        self,
        family: Family,
        parameter: str,
        period: int,
        *,
        start: float,
        span: float,
        mirrors: bool = False,
        symmetric: bool = False,
    ) -> None:
        self.family = family
        self.mirrors = mirrors
        self.parameter = parameter
        self.period = period
        self.span = span
        self.symmetric = symmetric
        self.unit = np.append(scales(lanes_of(family(start))), span)

    def map_at(self, value: float) -> ReturnMap:
        return ReturnMap(lanes_of(self.family(value)))

    def residual(self, scaled: Floats) -> tuple[Floats, Floats, ReturnMap]:
        """G (2,), the Jacobian (2, 2) of the closing map in units of the model, its maps."""
        value = scaled * self.unit
        section = self.map_at(float(value[2]))
        if self.symmetric:
            end, jacobian = section.flow(value[:2], self.period)
            end, jacobian = -end, -jacobian
        else:
            end, jacobian = section.flow(value[:2], 2 * self.period)
        return (end - value[:2]) / self.unit[:2], jacobian, section

    def in_parameter(self, scaled: Floats, section: ReturnMap) -> tuple[Floats, float]:
        """dG/dp (2,) along the path of this orbit, and its margin in half backlashes.

        The coefficients are differentiated, not the trajectory: crossings stay at their phases,
        so that no grazing lies between the ends of a difference.
        """
        value = scaled * self.unit
        maps = section.maps
        count = maps.half.shape[0]
        if self.symmetric:
            middle = int(np.searchsorted(maps.borders, 0.5))
            steps = (self.period // 2) * count + (middle if self.period % 2 else 0)
        else:
            steps = self.period * count
        rates = self._rates(float(value[2]), section)
        moved, margin = exact.moved_by(maps, rates=rates, start=value[:2], steps=steps)
        sign = -1.0 if self.symmetric else 1.0
        return sign * moved * self.span / self.unit[:2], margin / section.backlash

    def _rates(self, value: float, section: ReturnMap) -> tuple[Floats, Floats, float]:
        """Derivatives of the affine maps by the parameter: central, one-sided at its border."""
        small = SMALL * self.span
        for weights in (
            {-1: -0.5, 1: 0.5},
            {0: -1.5, 1: 2.0, 2: -0.5},
            {0: 1.5, -1: -2.0, -2: 0.5},
        ):
            try:
                around = {k: lanes_of(self.family(value + k * small)) for k in weights}
            except InputError:
                continue
            break
        else:
            raise InputError(self.parameter, value, allowed="values with neighbours")
        polys, half, backlash = np.zeros(1), np.zeros(1), 0.0
        for k, weight in weights.items():
            one = exact.prepare_maps(around[k], section.maps.borders, section.maps.marks)
            polys = polys + weight * one.polys[:, 0]
            half = half + weight * one.half[:, 0]
            backlash += weight * float(one.backlash[0])
        return polys / small, half / small, backlash / small

    def correct(
        self,
        guess: Floats,
        *,
        normal: Floats,
        old: Floats | None = None,
        reach: float = np.inf,
        tangent: bool = True,
    ) -> Point | None:
        """Newton onto the curve inside the plane through ``guess`` normal to ``normal``.

        Done when the residual is below 1e-14, or no longer falls and is what rounding leaves. The
        point's tangent and margin are known with ``tangent``, else good for nothing.
        """
        scaled = guess.copy()
        matrix = np.empty((3, 3))
        matrix[2] = normal
        two = self.unit[:2]
        best: tuple[float, Floats, Floats, ReturnMap] | None = None
        last = np.inf
        stalled = 0
        for count in range(20):
            gap, jacobian, section = self.residual(scaled)
            size = float(np.max(np.abs(gap)))
            if not (np.isfinite(size) and np.all(np.isfinite(jacobian))):
                return None
            if best is None or size < best[0]:
                best, stalled = (size, scaled, jacobian, section), 0
            else:
                stalled += 1
            if (
                size <= NEWTON_TOLERANCE
                or (stalled >= 1 and best[0] < 1e-2 * ROUNDING)
                or (stalled >= 2 and best[0] < ROUNDING)
            ):
                break
            matrix[:2, :2] = jacobian / two[:, None] * two - np.eye(2)
            if count == 0 or (size > 0.01 * last and size > 1e-11):
                # dear, and near enough from the last time while Newton falls fast
                matrix[:2, 2] = self.in_parameter(scaled, section)[0]
            last = size
            try:
                step = np.linalg.solve(matrix, [-gap[0], -gap[1], -normal @ (scaled - guess)])
            except np.linalg.LinAlgError:
                return None
            scaled = scaled + step
            if not float(np.linalg.norm(scaled - guess)) <= reach:
                return None
        if best is None or not best[0] < ROUNDING:
            return None
        _, scaled, jacobian, section = best
        matrix[:2, :2] = jacobian / two[:, None] * two - np.eye(2)
        margin = np.inf
        if tangent:
            matrix[:2, 2], margin = self.in_parameter(scaled, section)
        if not np.all(np.isfinite(matrix)):
            return None
        null = np.linalg.svd(matrix[:2])[2][2]
        direction = normal if old is None else old
        if null @ direction < 0.0:
            null = -null
        whole = section.determinant(self.period)
        return Point(
            scaled=scaled,
            tangent=null,
            visit=section.visit(scaled[:2] * two, self.period),
            determinant=whole,
            trace=float(jacobian[0, 0] + jacobian[1, 1]),
            closing=float(np.sqrt(whole)) if self.symmetric else whole,
            margin=margin,
        )

    def orbit(self, point: Point) -> Orbit:
        value = point.scaled * self.unit
        model = self.family(float(value[2]))
        return closed(ReturnMap(lanes_of(model)), value[:2], self.period, model=model)

    def across(self, point: Point) -> dict[str, Floats]:
        """How far the orbit stands from the mothers it may have, scaled (2,), by how it left them.

        Of an even period: from itself half its period later, 0 where it has shrunk into an orbit
        of half its period. In a symmetric equation: from its own mirror image, 0 where it has
        become symmetric. Empty where there is no such mother.
        """
        points = point.visit.points
        found: dict[str, Floats] = {}
        if self.symmetric:
            return found
        if self.period % 2 == 0:
            found[BIRTH] = np.asarray((points[self.period // 2] - points[0]) / self.unit[:2])
        if self.mirrors:
            section = self.map_at(float(point.scaled[2] * self.span))
            end, _ = section.flow(points[0], self.period)
            found[PITCHFORK] = np.asarray((end + points[0]) / self.unit[:2])
        return found

    def zero(self, a: Point, name: str, *, low: float, high: float) -> float:
        """Where the test function ``name`` vanishes between two distances from ``a``."""
        return float(
            brentq(
                lambda step: getattr(self.between(a, step), name),
                low,
                high,
                xtol=1e-14,
                rtol=8.9e-16,
            )
        )

    def between(self, a: Point, step: float, *, tangent: bool = False) -> Point:
        """The point a distance ``step`` along the tangent of ``a``."""
        if step == 0.0:
            return a
        point = self.correct(
            a.scaled + step * a.tangent, normal=a.tangent, old=a.tangent, tangent=tangent
        )
        if point is None:
            raise ConvergenceError(
                f"no orbit found near {self.parameter} = "
                f"{float((a.scaled[2] + step * a.tangent[2]) * self.span)!r}, "
                "between two orbits of the branch"
            )
        return point


def locate(curve: Curve, a: Point, b: Point) -> list[Bifurcation]:
    """Bifurcations between two neighbouring points, in the order of the walk."""
    length = float((b.scaled - a.scaled) @ a.tangent)
    events: list[tuple[float, Bifurcation]] = []

    def at(step: float, kind: str, note: str = "") -> None:
        point = curve.between(a, step)
        value = float(point.scaled[2] * curve.span)
        found = Bifurcation(kind, curve.parameter, value, curve.orbit(point), note)
        if kind in (FLIP, PITCHFORK):
            found = replace(found, note=criticality(found, curve.family))
        events.append((step, found))

    def counts(point: Point) -> tuple[int, int]:
        # both sides of a symmetric orbit graze at once, whichever rounding sees first
        losses, impacts = point.contacts
        return losses, losses if curve.symmetric else impacts

    nodes = {0.0: a, length: b}
    start = 0.0
    while counts(nodes[start]) != counts(b):
        low, high = start, length
        before = counts(nodes[start])
        while high - low > 1e-13:
            middle = 0.5 * (low + high)
            if counts(curve.between(a, middle)) == before:
                low = middle
            else:
                high = middle
        nodes[high] = curve.between(a, high)
        at(high, GRAZING, _grazed(before, counts(nodes[high])))
        # multipliers turn sharply where contact changes: folds come in pairs close by
        for near in (1e-6, 1e-5, 1e-4, 1e-3):
            for step in (high - near, high + near):
                if 0.0 < step < length:
                    nodes[step] = curve.between(a, step)
        if high == start:
            break
        start = high
    ends = sorted(nodes)
    broken = PITCHFORK if curve.symmetric else FLIP
    for low, high in pairwise(ends):
        for name, kind in (("fold", FOLD), ("flip", broken)):
            one, other = getattr(nodes[low], name), getattr(nodes[high], name)
            if one * other < 0.0 and min(abs(one), abs(other)) > SILENT:
                at(curve.zero(a, name, low=low, high=high), kind)
    return [event for _, event in sorted(events, key=lambda pair: pair[0])]


def looked_closer(curve: Curve, before: Point | None, a: Point, b: Point) -> list[Point]:
    """The points from ``a`` (left out) to ``b``, so near that no pair of events hides between.

    Two folds, flips or grazings in one step leave every sign and count as it was. A parabola
    through three neighbours, bent four times as much, says how far a test function may dip
    between two of them; where it may reach zero, the point half way is computed.
    """
    length = float((b.scaled - a.scaled) @ a.tangent)
    if length <= LOOK_CLOSER or not _may_hide(before, a, b):
        return [b]
    middle = curve.between(a, 0.5 * length, tangent=True)
    return [
        *looked_closer(curve, b, a, middle),
        *looked_closer(curve, a, middle, b),
    ]


def _may_hide(beside: Point | None, a: Point, b: Point) -> bool:
    if beside is None:
        # the first step of a walk is short; only next to a zero anything may hide in it
        pairs = [(abs(getattr(a, n)), abs(getattr(b, n))) for n in ("fold", "flip", "margin")]
        return any(min(one, other) < 4.0 * abs(one - other) + LOOK_CLOSER for one, other in pairs)
    width = float(np.linalg.norm(b.scaled - a.scaled))
    near, far = (float(np.linalg.norm(p.scaled - beside.scaled)) for p in (a, b))
    along = -near if near < far else width + far
    for name in ("fold", "flip", "margin"):
        one, other, third = (float(getattr(p, name)) for p in (a, b, beside))
        if name != "margin" and one * other < 0.0:
            continue
        if not np.isfinite(one + other + third):
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

    The multiplier of the new orbits beside it that was +1 is below 1 (they are stable, and live
    where the old orbit is not) or above. An orbit in lasting contact is neither: there the
    equation is linear (Hill's), and orbits of every size exist at the same value.
    """
    orbit = bifurcation.orbit
    if orbit.contact_losses == 0 and orbit.back_impacts == 0:
        return VERTICAL
    try:
        _, _, point = doubled_beside(bifurcation, family)
    except ConvergenceError:
        return ""
    return SUPERCRITICAL if point.fold > 0.0 else SUBCRITICAL


def doubled_beside(bifurcation: Bifurcation, family: Family) -> tuple[Curve, Floats, Point]:
    """An orbit beside a flip (of twice the period) or a pitchfork (no longer symmetric).

    With its curve and the scaled direction (3,) that leads to it, along the eigenvector of the
    multiplier -1 of the flipping map. Raises ConvergenceError where none is found.
    """
    orbit = bifurcation.orbit
    value = bifurcation.value
    span = max(abs(value), 1e-3)
    broken = bifurcation.kind == PITCHFORK
    period = orbit.period if broken else 2 * orbit.period
    curve = Curve(family, bifurcation.parameter, period, start=value, span=span, mirrors=broken)
    two = curve.unit[:2]
    jacobian = orbit.jacobian
    if broken:
        jacobian = -ReturnMap(orbit.lanes).flow(orbit.state, period)[1]
    matrix = jacobian / two[:, None] * two
    direction = np.linalg.svd(matrix + np.eye(2))[2][1]
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
        gap = curve.across(point).get(PITCHFORK if broken else BIRTH)
        if gap is not None and np.linalg.norm(gap) > amplitude:
            return curve, normal, point
    raise ConvergenceError(
        f"no orbit found beside the {bifurcation.kind} of period {orbit.period} at "
        f"{bifurcation.parameter} = {value!r}"
    )


def passed_mother(curve: Curve, a: Point, b: Point) -> str:
    """How a branch went through its mother orbit and on as its own image; "" where it did not."""
    first, then = curve.across(a), curve.across(b)
    for kind in first.keys() & then.keys():
        closes = float(np.max(np.abs(then[kind]))) < 1e-9
        if closes or float(first[kind] @ then[kind]) < 0.0:
            return kind
    return ""


def birth_of(curve: Curve, a: Point, kind: str) -> Bifurcation | None:
    """The flip or pitchfork of the mother orbit near ``a``; None when not found."""
    broken = kind == PITCHFORK
    start = float(a.scaled[2] * curve.span)
    away = curve.across(a)[kind]
    # half way between the orbit and its image: z_0 and z_n/2, or z_0 and -z(n T/2)
    centre = a.scaled[:2] + (-0.5 if broken else 0.5) * away
    mother = Curve(
        curve.family,
        curve.parameter,
        curve.period if broken else curve.period // 2,
        start=start,
        span=curve.span,
        mirrors=broken,
        symmetric=broken,
    )
    upright = np.array([0.0, 0.0, 1.0])
    units = curve.unit[:2] / mother.unit[:2]

    def there(value: float) -> Point | None:
        if not np.isfinite(value):
            return None
        guess = np.append(centre * units, value / curve.span)
        return mother.correct(guess, normal=upright, tangent=False)

    def flip(value: float) -> float:
        point = there(value)
        return np.nan if point is None else point.flip

    found = root_scalar(flip, method="secant", x0=start, x1=start + 1e-4 * curve.span, xtol=1e-13)
    if not found.converged or not abs(found.root - start) < LONGEST_STEP * curve.span:
        return None
    point = there(float(found.root))
    if point is None:
        return None
    born = Bifurcation(kind, curve.parameter, float(found.root), mother.orbit(point))
    return replace(born, note=criticality(born, curve.family)) if broken else born


def _grazed(before: tuple[int, int], after: tuple[int, int]) -> str:
    parts = []
    for name, old, new in zip(("contact losses", "back-side impacts"), before, after, strict=True):
        if old != new:
            parts.append(f"{name} per orbit {old} -> {new}")
    return ", ".join(parts)
