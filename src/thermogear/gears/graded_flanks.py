"""Flanks as an accuracy grade may leave them: a slope and a wave of the profile, by a seed.

A grade bounds deviations and does not say how they lie. Here every flank of a gear is alike, so
that the deviations repeat in each mesh period; pitch errors, which change from tooth to tooth and
bring the lines of the shaft, are not modelled.
"""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.accuracy import flank_tolerances
from thermogear.gears.deviations import FLANKS, GEARS, FlankShape, active_profile
from thermogear.gears.pair import GearPair

USED = (0.8, 1.0)
"""Share of its tolerance that a seeded deviation takes: evenly drawn, 0.9 within 10 %."""
_MANY_TEETH = 20
_WAVES = (2.5, 3.5)  # of fewer teeth, of more
_SAMPLES = 4097
EPSILON = float(np.finfo(float).eps)


class ProfileFigures(NamedTuple):
    """What a measuring machine reads off a profile trace [m].

    slope f_Halpha: rise of the mean line from root to tip, > 0 outside at the tip; form
    f_falpha: peak to peak about that line; total F_alpha: peak to peak about the design profile.
    """

    slope: float
    form: float
    total: float


def profile_figures(position: ArrayLike, *, added: ArrayLike) -> ProfileFigures:
    """f_Halpha, f_falpha and F_alpha of a trace: least-squares line and peaks.

    position: roll path [m] or share of the evaluated length, shape (n,), rising from root to
    tip, at least three points; added: deviation [m] there, > 0 outside. All that is given is the
    evaluated length. Raises for fewer points, or positions that do not rise.
    Source: ISO 1328-1:2013, profile evaluation.

    >>> figures = profile_figures([0.0, 5e-3, 10e-3], added=[-3e-6, 0.0, 3e-6])
    >>> [f"{1e6 * size:.1f} um" for size in figures]
    ['6.0 um', '0.0 um', '6.0 um']
    """
    x, trace = np.asarray(position, dtype=float), np.asarray(added, dtype=float)
    if x.ndim != 1 or x.size < 3 or x.shape != trace.shape or not np.all(np.diff(x) > 0.0):
        raise InputError(
            "profile", f"{x.size} positions", allowed="three or more, strictly rising, one trace"
        )
    (figures,) = trace_figures((x - x[0]) / (x[-1] - x[0]), traces=trace[None])
    return ProfileFigures(*figures.tolist())


def trace_figures(share: Floats, *, traces: Floats) -> Floats:
    """:func:`profile_figures` of ``traces`` (trace, n) at one ``share``, (trace, figure).

    >>> share = np.linspace(0.0, 1.0, 5)
    >>> trace_figures(share, traces=np.array([4.0 * share])).round(9)[:, ::2]
    array([[4., 4.]])
    """
    line = np.stack([share, np.ones_like(share)], axis=1)
    size = np.sqrt((line * line).sum(axis=0))
    figures = []
    for trace in traces:  # each by itself, so that none hangs on the others in the last digit
        slope, level = np.linalg.lstsq(line / size, trace, share.size * EPSILON)[0] / size
        rest = trace - slope * share - level
        figures.append((slope, np.ptp(rest), np.ptp(trace)))
    return np.array(figures)


@dataclass(frozen=True)
class WavyProfile(FlankShape):
    """A flank whose profile is inclined and wavy over its active length.

    S(x) = slope (x - 1/2) + wave(x), x = 0 at the start of the active profile to 1 at the tip
    along the line of action; wave: sin(2 pi ``waves`` x + ``phase``) less its own mean line,
    with ``form`` peak to peak. So :func:`profile_figures` gives back ``slope`` f_Halpha [m] and
    ``form`` f_falpha [m] >= 0; ``phase`` [rad]. > 0 is material outside; constant beyond.

    >>> flank = WavyProfile("pinion", slope=6e-6, form=0.0)
    >>> (1e6 * flank.added([0.0, 0.5, 1.0])).round(3)
    array([-3.,  0.,  3.])
    """

    gear: str
    _: KW_ONLY
    slope: float
    form: float = 0.0
    waves: float = _WAVES[0]
    phase: float = 0.0
    flank: str = "both"

    def __post_init__(self) -> None:
        require_choice("profile.gear", self.gear, GEARS)
        require_choice("profile.flank", self.flank, FLANKS)
        bounds.ADDED.require("profile.slope", self.slope)
        bounds.RELIEF_AMOUNT.require("profile.form", self.form)
        for name in ("waves", "phase"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"profile.{name}", getattr(self, name), allowed="finite")
        if not 1.0 <= self.waves <= 20.0:
            raise InputError("profile.waves", self.waves, allowed="1..20")

    @cached_property
    def _wave(self) -> tuple[float, float, float]:
        """Mean and slope of the plain sine, and the factor that gives the rest its size."""
        k, start, end = 2.0 * math.pi * self.waves, self.phase, self.phase + self._turn
        mean = (math.cos(start) - math.cos(end)) / k
        first = -math.cos(end) / k + (math.sin(end) - math.sin(start)) / k**2
        slope = 12.0 * (first - 0.5 * mean)
        x = np.linspace(0.0, 1.0, _SAMPLES)
        rest = np.sin(k * x + self.phase) - mean - slope * (x - 0.5)
        return mean, slope, self.form / float(np.ptp(rest))

    @property
    def _turn(self) -> float:
        return 2.0 * math.pi * self.waves

    def added(self, share: ArrayLike) -> Floats:
        """S [m] at ``share`` x of the active profile, any shape."""
        x = np.clip(np.asarray(share, dtype=float), 0.0, 1.0)
        mean, slope, size = self._wave
        wave = np.sin(self._turn * x + self.phase) - mean - slope * (x - 0.5)
        return np.asarray(self.slope * (x - 0.5) + size * wave)

    def taken_off(self, pair: GearPair, rho: Floats) -> Floats:
        """e = -S."""
        start, _, tip = active_profile(pair, self.gear)
        return -self.added((rho - start) / (tip - start))

    def borders(self, pair: GearPair) -> Floats:
        """Ends of the active profile and, of a wave, every tenth in between."""
        start, _, tip = active_profile(pair, self.gear)
        count = math.ceil(10.0 * self.waves) if self.form else 1
        return np.linspace(start, tip, count + 1)


def hand_over(pair: GearPair, *, pinion: float, wheel: float) -> float:
    """Step [m] of the unloaded transmission error where one tooth pair takes over from the next.

    |f_Halpha1 - f_Halpha2| p_b/g_a: along the path the pinion's profile runs from root to tip and
    the wheel's from tip to root, so equal slopes cancel. The light mesh runs on a saw-tooth of
    this height peak to peak. ``pinion``, ``wheel``: profile slopes [m], > 0 outside at the tip.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * hand_over(pair, pinion=6e-6, wheel=0.0):.2f} um"
    '3.67 um'
    """
    return abs(pinion - wheel) / pair.contact_ratio


def graded_flanks(
    pair: GearPair, grade: int, *, seed: int, edition: str = "2013"
) -> tuple[WavyProfile, ...]:
    """Profile deviations of both gears, drive and back flanks, within their grade's tolerances.

    For every gear and side: f_Halpha of random sign and f_falpha, each 80 to 100 % of its
    tolerance (:data:`USED`, evenly drawn), both smaller in proportion where the total would leave
    F_alpha; 2.5 waves over the active profile below 20 teeth, else 3.5, of random phase. The
    random parts come from ``seed`` in the order pinion, wheel; drive, back, so that a better
    ``grade`` with the same seed is the same flank, smaller. Roughness is left out: the film has
    it. Raises as :func:`~thermogear.gears.accuracy.flank_tolerances`.
    Source: profile of public PHM-BGU gear models (slope, sine of n waves, 10 % scatter); the
    tolerance as a bound, the sign and the evaluated form are ours.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [(flank.gear, flank.flank) for flank in graded_flanks(pair, 6, seed=1)][:2]
    [('pinion', 'drive'), ('pinion', 'back')]
    """
    rng = np.random.default_rng(seed)
    found = []
    for name, gear in zip(GEARS, (pair.pinion, pair.wheel), strict=True):
        limits = flank_tolerances(gear.teeth, gear.module, grade=grade, edition=edition)
        for flank in ("drive", "back"):
            sign = 1.0 if rng.random() < 0.5 else -1.0
            slope, form = rng.uniform(*USED, size=2)
            profile = WavyProfile(
                name,
                slope=sign * slope * limits.profile_slope,
                form=form * limits.profile_form,
                waves=_WAVES[gear.teeth >= _MANY_TEETH],
                phase=float(rng.uniform(0.0, 2.0 * math.pi)),
                flank=flank,
            )
            found.append(_within(profile, limits.profile_total))
    return tuple(found)


def _within(profile: WavyProfile, total: float) -> WavyProfile:
    """The same shape, no larger than ``total`` [m] peak to peak."""
    size = float(np.ptp(profile.added(np.linspace(0.0, 1.0, _SAMPLES))))
    share = min(1.0, total / size)
    return WavyProfile(
        profile.gear,
        slope=share * profile.slope,
        form=share * profile.form,
        waves=profile.waves,
        phase=profile.phase,
        flank=profile.flank,
    )
