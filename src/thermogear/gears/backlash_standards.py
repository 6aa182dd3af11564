"""Backlash as standards recommend it: a least normal backlash, tooth-thickness and axis tolerances.

ISO/TR 10064-2 says how much, DIN 3967 how thin the teeth are cut for it and how exactly, DIN 3964
how exact the centre distance is. All are recommendations: a drawing overrules them.
"""

from __future__ import annotations

import math
import re

from thermogear.base.errors import InputError, require_choice
from thermogear.gears.backlash import BacklashSpan, backlash_span
from thermogear.gears.pair import GearPair

_MM, _UM = 1e-3, 1e-6

ALLOWANCES: dict[str, tuple[int, ...]] = {  # -A_sne, um, of the five steps of diameter
    "a": (100, 135, 180, 250, 330),
    "ab": (85, 110, 150, 200, 280),
    "b": (70, 95, 125, 170, 230),
    "bc": (58, 75, 105, 140, 190),
    "c": (48, 65, 85, 115, 155),
    "cd": (40, 54, 70, 95, 130),
    "d": (33, 44, 60, 80, 110),
    "e": (22, 30, 40, 56, 75),
    "f": (10, 14, 19, 26, 35),
    "g": (5, 7, 9, 12, 17),
    "h": (0, 0, 0, 0, 0),
}
"""Series of the upper tooth-thickness allowance of DIN 3967, from the thinnest teeth."""
_DIAMETERS = (10.0, 50.0, 125.0, 280.0, 560.0, 1000.0)  # mm, upper ends of the steps
SERIES = range(21, 31)
"""Numbers of the tooth-thickness tolerance of DIN 3967; 24 to 27 are preferred."""
_COMMON = (3, 5, 8, 12, 20, 30, 50, 80, 130, 200, 300, 500, 800)  # um
_BETWEEN = (6, 10, 16, 25, 40, 60, 100, 160, 250, 400, 600)  # um
_TOLERANCES = (  # row of numbers and its first place, of the six steps of diameter
    (_COMMON, 0),
    (_COMMON, 1),
    (_BETWEEN, 0),
    (_COMMON, 2),
    (_BETWEEN, 1),
    (_COMMON, 3),
)

_UNIT_GRADES = {6: 10.0, 7: 16.0, 8: 25.0}
_SIZES = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500)  # mm, ISO 286-1
_LARGE = (*_SIZES, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)


def least_normal_backlash(*, module: float, centre_distance: float) -> float:
    """j_bn,min = (2/3)(0.06 + 0.0005 a + 0.03 m) [m], mm in the formula.

    ``module`` m, ``centre_distance`` a [m]. Range, usual and unconfirmed: ferrous gears in a
    ferrous housing, below 15 m/s at the pitch circle, industrial tolerances. Source: ISO/TR
    10064-2. (AGMA 2002 has it without 2/3.)

    >>> f"{1e6 * least_normal_backlash(module=4e-3, centre_distance=120e-3):.0f} um"
    '160 um'
    """
    a, m = centre_distance / _MM, module / _MM
    return 2.0 / 3.0 * (0.06 + 0.0005 * a + 0.03 * m) * _MM


def recommended_normal_backlash(pair: GearPair) -> float:
    """:func:`least_normal_backlash` [m] of a pair.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> f"{1e6 * recommended_normal_backlash(pair):.0f} um"
    '160 um'
    """
    return least_normal_backlash(module=pair.pinion.module, centre_distance=pair.centre_distance)


def upper_allowance(diameter: float, series: str) -> float:
    """A_sne [m] <= 0: the least by which teeth are thinned, along the reference circle.

    ``diameter`` d [m] of the reference circle, up to 560 mm; ``series`` out of
    :data:`ALLOWANCES`. Raises beyond. Source: DIN 3967, table, by two transcriptions.

    >>> f"{1e6 * upper_allowance(80e-3, 'cd'):.0f} um"
    '-70 um'
    """
    require_choice("thickness.series", series, ALLOWANCES)
    values = ALLOWANCES[series]
    return -values[_step(diameter, len(values))] * _UM


def thickness_tolerance(diameter: float, number: int) -> float:
    """T_sn [m] > 0: how far tooth thicknesses may differ.

    ``diameter`` d [m] of the reference circle, up to 1000 mm; ``number`` out of :data:`SERIES`.
    Raises beyond. Source: DIN 3967, table, by two transcriptions.

    >>> f"{1e6 * thickness_tolerance(80e-3, 25):.0f} um"
    '40 um'
    """
    if number not in SERIES:
        raise InputError(
            "thickness.number", number, allowed=f"{SERIES[0]}..{SERIES[-1]}", fix="24..27 is usual"
        )
    row, first = _TOLERANCES[_step(diameter, len(_TOLERANCES))]
    return row[number - SERIES[0] + first] * _UM


def thickness_limits(diameter: float, tolerance: str) -> tuple[float, float]:
    """Upper and lower tooth-thickness allowance A_sne, A_sni = A_sne - T_sn [m], both <= 0.

    ``diameter`` d [m]; ``tolerance`` as drawings write it, "cd25" or "25cd". Source: DIN 3967.

    >>> [round(1e6 * limit) for limit in thickness_limits(80e-3, "cd25")]
    [-70, -110]
    """
    found = re.fullmatch(r"([a-h]+)(\d+)|(\d+)([a-h]+)", tolerance.strip())
    if not found:
        raise InputError("thickness", repr(tolerance), allowed="series and number, such as 'cd25'")
    series, number = found[1] or found[4], int(found[2] or found[3])
    upper = upper_allowance(diameter, series)
    return upper, upper - thickness_tolerance(diameter, number)


def _step(diameter: float, steps: int) -> int:
    """Place of the step of DIN 3967 that ``diameter`` [m] lies in, its upper end included."""
    d, most = diameter / _MM, _DIAMETERS[steps - 1]
    if not 0.0 < d <= most * (1.0 + 1e-12):
        raise InputError(
            "thickness.diameter",
            f"{d:.6g} mm",
            allowed=f"0 < d <= {most:g} mm",
            why="the range of DIN 3967's table",
        )
    return next(place for place, end in enumerate(_DIAMETERS) if d <= end * (1.0 + 1e-12))


def centre_distance_tolerance(centre_distance: float, grade: int = 7) -> float:
    """js = IT/2 [m] that the centre distance may deviate to either side.

    IT6, 7, 8 = 10, 16, 25 i,  i = 0.45 D^(1/3) + 0.001 D um,  D [mm] the geometric mean of the
    step of sizes, rounded to 1 um; above 500 mm i = 0.004 D + 2.1 (usual, unconfirmed).

    ``centre_distance`` a [m] 3..3150 mm, ``grade`` of IT, 6 to 8; 7 is the usual one. Raises
    beyond. The standard's table rounds by hand: 1 um more in six of its places up to 500 mm.
    Source: DIN 3964 (js), ISO 286-1 (IT).

    >>> f"{1e6 * centre_distance_tolerance(120e-3):.1f} um"
    '17.5 um'
    """
    if grade not in _UNIT_GRADES:
        raise InputError("centre_distance.grade", grade, allowed="6 | 7 | 8")
    size = centre_distance / _MM
    if not _LARGE[0] < size <= _LARGE[-1] * (1.0 + 1e-12):
        raise InputError(
            "centre_distance", f"{size:.6g} mm", allowed=f"{_LARGE[0]}..{_LARGE[-1]} mm"
        )
    place = next(k for k, end in enumerate(_LARGE) if size <= end * (1.0 + 1e-12))
    mean = math.sqrt(_LARGE[place - 1] * _LARGE[place])
    unit = 0.45 * mean ** (1.0 / 3.0) + 1e-3 * mean if place < len(_SIZES) else 4e-3 * mean + 2.1
    return 0.5 * math.floor(_UNIT_GRADES[grade] * unit + 0.5) * _UM


def standard_backlash(
    pair: GearPair, pinion: str = "cd25", wheel: str = "cd25", *, grade: int = 7
) -> BacklashSpan:
    """j_bn [m] of tooth thicknesses by DIN 3967 and a centre distance by DIN 3964.

    ``pinion``, ``wheel``: tolerances as :func:`thickness_limits`; ``grade`` as
    :func:`centre_distance_tolerance`. Raises as these.

    >>> pair = GearPair(Gear(20, 4e-3), Gear(40, 4e-3))
    >>> [round(1e6 * backlash) for backlash in standard_backlash(pair)]  # um
    [143, 197, 252]
    """
    play = centre_distance_tolerance(pair.centre_distance, grade)
    return backlash_span(
        pinion=thickness_limits(2.0 * pair.pinion.pitch_radius, pinion),
        wheel=thickness_limits(2.0 * pair.wheel.pitch_radius, wheel),
        distance=(-play, play),
        pair=pair,
    )
