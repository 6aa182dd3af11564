"""Flanks as a measuring machine found them: what of a chart's traces acts in the mesh.

A trace holds slope, form, waves, and noise of the probe. A run has one mesh period for all, so
the mean of the teeth acts, without the waves too short to be distinguished from noise; each
trace is evaluated by itself. The roll path rho is the string length along the line of action.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.gears.accuracy import flank_class
from thermogear.gears.deviations import FlankTable, active_profile
from thermogear.gears.geometry import Gear
from thermogear.gears.graded_flanks import ProfileFigures, profile_figures
from thermogear.gears.pair import GearPair

LEAST_POINTS = 10
"""Points of a trace within the evaluated range, at least."""
_WAVES, _SHORTEST = 30.0, 5e-5
"""ISO 1328-1:2013 evaluates below a cut-off of a 30th of the range, 0.05 mm at least (recalled)."""
_BROADEST = 6.0
"""The range over the longest cut-off: two or three waves over a flank are never smoothed away."""
_QUIET = 0.25
"""Curvature that noise may leave, root mean square, over that of the pair's own flanks."""
_GAUSS = math.sqrt(math.log(2.0) / math.pi)
_KNOTS = 4  # for each cut-off


class MeasuredFlank(NamedTuple):
    """One side's flanks of a gear.

    ``flank`` "drive" or "back"; ``figures`` [m] and ISO 1328-1:2013 ``grades`` of each trace
    (None: none of 1..11, or not in the range of the standard); ``rho`` [m] and ``acting`` [m]:
    knots of what acts, linear between, constant beyond; ``cutoff`` [m] of the filter; ``noise``
    [m] of one trace, standard deviation; ``scatter`` [m] between the teeth, root mean square;
    ``limited``: noise asks for a longer cut-off than is taken.
    """

    flank: str
    figures: tuple[ProfileFigures, ...]
    grades: tuple[int | None, ...]
    rho: Floats
    acting: Floats
    cutoff: float
    noise: float
    scatter: float
    limited: bool

    def table(self, gear: str, base_radius: float) -> FlankTable:
        """What acts, as a deviation of the mesh."""
        radius = np.hypot(base_radius, self.rho)
        return FlankTable(gear, radius=radius, added=self.acting, flank=self.flank)


@dataclass(frozen=True, eq=False, kw_only=True)
class ProfileTraces:
    """Traces of one gear over one row of points.

    ``rho`` [m]: roll path, rising, shape (point,); ``added`` [m]: > 0 outside, shape (trace,
    point); ``flank``: "drive" or "back" of each trace; ``tooth``: its number; ``range`` [m]: the
    evaluated part of the roll path, None: the active profile as far as the trace goes.
    """

    gear: str
    rho: Floats
    added: Floats
    flank: tuple[str, ...]
    tooth: tuple[int, ...]
    range: tuple[float, float] | None = None

    def evaluated(self, pair: GearPair) -> tuple[float, float]:
        """The evaluated range [m] of the roll path; refused where too little of it was traced."""
        start, _, tip = active_profile(pair, self.gear)
        low, high = self.range or (start, tip)
        slack = 1e-6 * (tip - start)
        low, high = max(low, float(self.rho[0])), min(high, float(self.rho[-1]))
        inside = int(np.sum((self.rho >= low - slack) & (self.rho <= high + slack)))
        if inside < LEAST_POINTS:
            raise InputError(
                "points",
                f"{inside} points of the trace in the evaluated range",
                allowed=f">= {LEAST_POINTS}",
                fix="export the chart with more points, or state another range to evaluate",
            )
        return low, high

    def flanks(self, pair: GearPair) -> tuple[MeasuredFlank, ...]:
        """What acts on each side that was measured, drive first."""
        sides = [side for side in ("drive", "back") if side in self.flank]
        return tuple(self._flank(pair, side) for side in sides)

    def _flank(self, pair: GearPair, side: str) -> MeasuredFlank:
        low, high = self.evaluated(pair)
        gear = pair.pinion if self.gear == "pinion" else pair.wheel
        slack = 1e-6 * (high - low)
        inside = (self.rho >= low - slack) & (self.rho <= high + slack)
        x = self.rho[inside]
        rows = self.added[[place for place, one in enumerate(self.flank) if one == side]][:, inside]
        widest = float(np.max(np.diff(x)))
        finest = max((high - low) / _WAVES, _SHORTEST, 2.0 * widest)
        at = _even(x, finest / (2 * _KNOTS))
        plain = rows @ smoothing(x, at=at, cutoff=finest).T
        figures = tuple(profile_figures(position=at, added=one) for one in plain)
        grades = tuple(flank_class(gear.teeth, gear.module, figures=one) for one in figures)
        noise = noise_of(x, rows=rows)
        wanted = quiet_cutoff(
            noise / math.sqrt(len(rows)),
            spacing=float(np.mean(np.diff(x))),
            curvature=_QUIET * _least_curvature(pair, self.gear, x),
        )
        broadest = max(finest, (high - low) / _BROADEST)
        cutoff = min(max(finest, wanted), broadest)
        knots = _even(x, cutoff / _KNOTS)
        acting = smoothing(x, at=knots, cutoff=cutoff) @ rows.mean(axis=0)
        _, pitch, _ = active_profile(pair, self.gear)
        acting = acting - np.interp(pitch, knots, acting)
        own = rows - rows.mean(axis=1, keepdims=True)
        scatter = float(np.sqrt(np.mean(np.var(own, axis=0, ddof=1)))) if len(rows) > 1 else 0.0
        return MeasuredFlank(
            side, figures, grades, knots, acting, cutoff, noise, scatter, wanted > broadest
        )


def roll_path(
    gear: Gear,
    *,
    diameter: ArrayLike | None = None,
    angle: ArrayLike | None = None,
) -> Floats:
    """Roll path rho [m] of points on a flank, given by ``diameter`` d [m] or roll ``angle`` [rad].

    rho = sqrt(d^2/4 - r_b^2) = r_b * angle; nan below the base circle. Shape of what is given.

    >>> gear = Gear(20, 4e-3)
    >>> f"{1e3 * roll_path(gear, diameter=80e-3):.2f} mm"
    '13.68 mm'
    """
    if angle is not None:
        return np.asarray(gear.base_radius * np.asarray(angle, dtype=float))
    radius = 0.5 * np.asarray(diameter, dtype=float)
    square = (radius - gear.base_radius) * (radius + gear.base_radius)
    return np.sqrt(np.where(square >= 0.0, square, np.nan))


def smoothing(x: Floats, *, at: Floats, cutoff: float) -> Floats:
    """Weights (len(at), len(x)) of the Gaussian profile filter of a ``cutoff`` [m] wavelength.

    A sine of that wavelength keeps half its height; the filter is a local straight line, so that
    a line passes unchanged up to the ends, where a plain Gaussian would need a run-in. ``x`` [m]
    rising, its gaps at most half a cut-off; ``at`` [m] where the filtered trace is asked for.
    Source: ISO 16610-21 (weights), -31 (ends).

    >>> x = np.linspace(0.0, 8e-3, 41)
    >>> f"{smoothing(x, at=x[20:21], cutoff=0.8e-3).sum():.3f}"
    '1.000'
    """
    cells = np.gradient(x)
    away = x[None, :] - at[:, None]
    weight = cells * np.exp(-math.pi * (away / (_GAUSS * cutoff)) ** 2)
    zeroth, first, second = (np.sum(weight * away**k, axis=1, keepdims=True) for k in range(3))
    return np.asarray(weight * (second - first * away) / (zeroth * second - first**2))


def noise_of(x: Floats, *, rows: Floats) -> float:
    """Standard deviation [m] of what changes from point to point: fourth divided differences.

    Five neighbours are weighed so that every cubic cancels and white noise keeps its variance;
    the median over all of ``rows`` [m] (trace, point) at ``x`` [m] leaves single outliers out.

    >>> x = np.arange(20) * 0.1e-3
    >>> f"{1e6 * noise_of(x, rows=(2.0 * x)[None]):.3f} um"
    '0.000 um'
    """
    near = np.stack([x[k : x.size - 4 + k] for k in range(5)])
    near = (near - near.mean(axis=0)) / np.ptp(near, axis=0)
    weights = np.stack(
        [1.0 / np.prod([near[k] - near[j] for j in range(5) if j != k], axis=0) for k in range(5)]
    )
    weights /= np.sqrt(np.sum(weights**2, axis=0))
    rest = sum(weights[k] * rows[:, k : x.size - 4 + k] for k in range(5))
    return float(np.median(np.abs(rest)) / 0.6744897501960817)


def quiet_cutoff(noise: float, *, spacing: float, curvature: float) -> float:
    """Cut-off wavelength [m] beyond which white noise bends a flank less than ``curvature``.

    Root mean square of the second derivative of filtered noise:
    noise sqrt(3 spacing/(8 sqrt(pi))) s^(-5/2), s = cutoff sqrt(ln 2/2)/pi the filter's width.
    noise [m] standard deviation, spacing [m] of the points, curvature [1/m] over the roll path.
    A bump that bends as much as the two flanks do about their contact would carry by itself.

    >>> f"{1e3 * quiet_cutoff(0.5e-6, spacing=0.02e-3, curvature=50.0):.2f} mm"
    '0.28 mm'
    """
    if noise <= 0.0:
        return 0.0
    bend = noise * math.sqrt(3.0 * spacing / (8.0 * math.sqrt(math.pi)))
    return float((bend / curvature) ** 0.4 * math.pi / math.sqrt(0.5 * math.log(2.0)))


def _even(x: Floats, step: float) -> Floats:
    """Even places over ``x``, at most about ``step`` apart; as many where ``x`` is rounded."""
    return np.linspace(x[0], x[-1], math.ceil((x[-1] - x[0]) / step - 1e-6) + 1)


def _least_curvature(pair: GearPair, name: str, rho: Floats) -> float:
    """Least curvature [1/m] over the roll path of both involutes against each other.

    The gap beside the contact is tan(alpha)^2 x^2/(2 rho*), x along the roll path, tan(alpha) =
    rho/r_b of this gear, rho* the reduced radius.
    """
    start, _, tip = active_profile(pair, name)
    gear = pair.pinion if name == "pinion" else pair.wheel
    one = np.clip(rho, start, tip)
    reduced = one * (pair.line_of_action - one) / pair.line_of_action
    return float(np.min((one / gear.base_radius) ** 2 / reduced))
