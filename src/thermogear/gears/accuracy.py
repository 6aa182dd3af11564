"""What an accuracy grade lets a flank deviate: ISO 1328-1, both editions by their year.

A tolerance is the greatest allowed magnitude of a deviation; none says how it lies over the
flank or from tooth to tooth. The two editions give one grade different numbers: name the
edition. Spur gears, flank tolerances alone (no radial or composite ones).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.errors import InputError, require_choice

_MM, _UM = 1e-3, 1e-6
_STEP = math.sqrt(2.0)  # from grade to grade
_GRADES = {"2013": (1, 11), "1995": (0, 12)}
EDITIONS = tuple(_GRADES)
"""Years of the editions of ISO 1328-1; 2013 is DIN ISO 1328-1:2018."""
_RANGES = {  # field: unit, its SI value, allowed in the editions in the order of EDITIONS
    "diameter": ("mm", _MM, (5.0, 15000.0), (5.0, 10000.0)),
    "module": ("mm", _MM, (0.5, 70.0), (0.5, 70.0)),
}
_LEAST_TEETH, _MOST_TEETH = 5, 1000
_DIAMETERS = (5, 20, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6000, 8000, 10000)  # mm, 1995
_MODULES = (0.5, 2, 3.5, 6, 10, 16, 25, 40, 70)  # mm, 1995


class FlankTolerances(NamedTuple):
    """Tolerances of one gear's pitches and profiles [m].

    single_pitch f_pT (1995 f_pt), cumulative_pitch F_pT (F_p), profile_slope f_Halpha,
    profile_form f_falpha, profile_total F_alpha.

    >>> f"{1e6 * flank_tolerances(20, 4e-3, grade=5).rounded().single_pitch:.1f} um"
    '6.5 um'
    """

    single_pitch: float
    cumulative_pitch: float
    profile_slope: float
    profile_form: float
    profile_total: float

    def rounded(self) -> FlankTolerances:
        """As the standard prints them."""
        return FlankTolerances(*(float(round_tolerance(value)) for value in self))


def round_tolerance(value: ArrayLike) -> NDArray[np.float64]:
    """A tolerance [m] to 1 um above 10 um, 0.5 um from 5 to 10 um, 0.1 um below; any shape.

    Halves round up. Source: ISO 1328-1:2013, rounding rule.

    >>> [f"{1e6 * t:.1f} um" for t in round_tolerance([11.4e-6, 7.3e-6, 3.21e-6])]
    ['11.0 um', '7.5 um', '3.2 um']
    """
    size = np.asarray(value, dtype=float) / _UM
    step = np.where(size > 10.0, 1.0, np.where(size >= 5.0, 0.5, 0.1))
    return np.asarray(np.floor(size / step + 0.5 + 1e-9) * step * _UM)


def flank_tolerances(
    teeth: int, module: float, *, grade: int, edition: str = "2013"
) -> FlankTolerances:
    """Unrounded tolerances of a spur gear's pitches and profiles [m].

    2013, um and mm, times sqrt(2)^(A - 5):
    f_pT = 0.001 d + 0.4 m + 5,  F_pT = 0.002 d + 0.55 sqrt(d) + 0.7 m + 12,
    f_Halpha = 0.4 m + 0.001 d + 4,  f_falpha = 0.55 m + 5,
    F_alpha = sqrt(f_Halpha^2 + f_falpha^2).

    1995, d and m the geometric means of the steps they lie in, times sqrt(2)^(Q - 5):
    f_pt = 0.3 (m + 0.4 sqrt(d)) + 4,  F_p = 0.3 m + 1.25 sqrt(d) + 7,
    f_Halpha = 2 sqrt(m) + 0.14 sqrt(d) + 0.5,  f_falpha = 2.5 sqrt(m) + 0.17 sqrt(d) + 0.5,
    F_alpha = 3.2 sqrt(m) + 0.22 sqrt(d) + 0.7.

    ``teeth`` z, ``module`` m [m], d = m z the reference diameter, ``grade`` A (2013: 1..11) or Q
    (1995: 0..12), ``edition`` out of :data:`EDITIONS`. Raises outside 5 <= z <= 1000, d 5..15000
    mm (1995: 10000), m 0.5..70 mm: nothing is extrapolated. Source: the two editions of ISO
    1328-1 as public gear codes carry them.

    >>> f"{1e6 * flank_tolerances(20, 4e-3, grade=5).single_pitch:.2f} um"
    '6.68 um'
    """
    diameter = teeth * module
    _require(edition, grade, teeth, diameter=diameter, module=module)
    d, m = diameter / _MM, module / _MM
    if edition == "2013":
        slope, form = 0.4 * m + 0.001 * d + 4.0, 0.55 * m + 5.0
        values = (
            0.001 * d + 0.4 * m + 5.0,
            0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0,
            slope,
            form,
            math.hypot(slope, form),
        )
    else:
        d, m = _mean_of_step(d, _DIAMETERS), _mean_of_step(m, _MODULES)
        values = (
            0.3 * (m + 0.4 * math.sqrt(d)) + 4.0,
            0.3 * m + 1.25 * math.sqrt(d) + 7.0,
            2.0 * math.sqrt(m) + 0.14 * math.sqrt(d) + 0.5,
            2.5 * math.sqrt(m) + 0.17 * math.sqrt(d) + 0.5,
            3.2 * math.sqrt(m) + 0.22 * math.sqrt(d) + 0.7,
        )
    return FlankTolerances(*(value * _STEP ** (grade - 5) * _UM for value in values))


def flank_class(
    teeth: int, module: float, *, figures: tuple[float, ...], rounded: bool = True
) -> int | None:
    """The best class of ISO 1328-1:2013 that lets a profile, or a whole gear, deviate so far.

    ``figures``: f_Halpha, f_falpha, F_alpha [m], with f_p, F_p before them where pitches are
    measured, signs left aside; each is held against the tolerance, ``rounded`` as the standard
    prints it. None where class 11 is exceeded, or the gear leaves the standard's range; ``module``
    [m].

    >>> flank_class(20, 4e-3, figures=(5e-6, 7e-6, 9e-6))
    5
    """
    low, high = _GRADES["2013"]
    for grade in range(low, high + 1):
        try:
            exact = flank_tolerances(teeth, module, grade=grade)
        except InputError:
            return None
        limits = (exact.rounded() if rounded else exact)[-len(figures) :]
        if all(abs(got) <= most for got, most in zip(figures, limits, strict=True)):
            return grade
    return None


def _require(edition: str, grade: int, teeth: int, **sizes: float) -> None:
    require_choice("accuracy.edition", edition, EDITIONS)
    best, worst = _GRADES[edition]
    whole = isinstance(grade, int | np.integer) and not isinstance(grade, bool)
    if not whole or not best <= grade <= worst:
        raise InputError(
            "accuracy.grade",
            repr(grade),
            allowed=f"a whole number, {best}..{worst}",
            why=f"the grades of ISO 1328-1:{edition}",
        )
    if not _LEAST_TEETH <= teeth <= _MOST_TEETH:
        raise InputError(
            "accuracy.teeth",
            teeth,
            allowed=f"{_LEAST_TEETH}..{_MOST_TEETH}",
            why="the range of ISO 1328-1",
        )
    place = EDITIONS.index(edition)
    for field, value in sizes.items():
        unit, scale, *ranges = _RANGES[field]
        low, high = ranges[place]
        if not low * (1.0 - 1e-12) <= value / scale <= high * (1.0 + 1e-12):
            raise InputError(
                f"accuracy.{field}",
                f"{value / scale:.6g} {unit}",
                allowed=f"{low:g}..{high:g} {unit}",
                why=f"the range of ISO 1328-1:{edition}",
            )


def _mean_of_step(value: float, edges: tuple[float, ...]) -> float:
    """Geometric mean of the step of ``edges`` that ``value`` lies in, its upper edge included."""
    place = int(np.clip(np.searchsorted(edges, value * (1.0 - 1e-12)), 1, len(edges) - 1))
    return math.sqrt(edges[place - 1] * edges[place])
