"""Exact moving band source on a half-plane (Jaeger), and flash temperatures from it.

Lengths in half widths, Peclet number Pe = v B/a. In the frame of the source the material
moves in +x and the surface rise is

T(x) = Q/(pi k) int phi(s) exp[Pe (x-s)/2] K_0[Pe |x-s|/2] ds,

Q the heat per width and phi its shape with unit total. ``tests/heat/two_bodies.py`` solves two
bodies whose temperatures agree point by point: what Blok's formula and the Peclet correction are
checked against.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.polynomial.polynomial import polyval
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.base.materials import Material
from thermogear.heat.temperature import (
    blok_flash,
    flash_factor,
    frictional_heat,
)

METHODS: dict[str, str] = {
    "blok": "high-speed limit, share of heat by B sqrt(v)",
    "peclet": "the same with the exact single-body maximum C(Pe) on each flank",
}

_SHAPES: dict[str, Callable[[Floats], Floats]] = {  # of (1 - s)(1 + s)
    "ellipse": lambda p: np.asarray(2.0 / np.pi * np.sqrt(p)),
    "uniform": lambda p: np.full(p.shape, 0.5),
    "parabola": lambda p: 0.75 * p,
}


@cache
def _tanh_sinh() -> tuple[Floats, Floats, Floats]:
    """Fractions f and 1 - f of an interval, both to full digits, and weights."""
    t = np.arange(-60, 61) * 0.06
    front, back = (
        1.0 / (1.0 + np.exp(-np.pi * np.sinh(t))),
        1.0 / (1.0 + np.exp(np.pi * np.sinh(t))),
    )
    return front, back, 0.06 * np.pi * np.cosh(t) * front * back


def moving_source_rise(
    position: ArrayLike, *, peclet: float, distribution: str = "ellipse"
) -> Floats:
    """Surface rise under one moving band source, T k sqrt(Pe)/Q [-].

    ``position`` x/B in -1..1 of any shape (the trailing edge is +1), ``peclet`` Pe > 0,
    ``distribution`` of :data:`FLASH_FACTORS`. Its maximum is the factor C of
    T = C Q/(B_i sqrt(v) sqrt(B)). Quadrature split at the logarithmic singularity with nodes
    crowding at both ends of each part; 1e-9.

    >>> f"{moving_source_rise(0.3, peclet=1000.0).item():.2f}"
    '0.73'
    """
    flash_factor(distribution)
    if not (np.isfinite(peclet) and peclet > 0.0):
        raise InputError("peclet", peclet, allowed="> 0")
    from scipy.special import k0e

    shape = _SHAPES[distribution]
    x = np.asarray(position, dtype=float)
    front, back, weight = _tanh_sinh()
    total = np.zeros(x.shape)
    for behind in (True, False):  # the heat upstream of x has passed over it, the rest comes
        length = np.asarray(1.0 + x if behind else 1.0 - x)[..., None]
        away = length * front
        near_edge = length * back
        # at an edge of the band one part is empty; its kernel must stay finite
        kernel = k0e(0.5 * peclet * np.where(length > 0.0, away, 1.0))
        if not behind:
            kernel = kernel * np.exp(-peclet * away)
        profile = shape(near_edge * (2.0 - near_edge))
        total = total + np.sum(weight * kernel * profile * length, axis=-1)
    return np.asarray(np.sqrt(peclet) / np.pi * total)


_LOWEST, _HIGHEST = 1e-4, 1e5


_MAXIMA = (
    0.03569070708829218, 0.04036277316877917, 0.04561185497338723, 0.051502281202783926,
    0.05810407824780244, 0.06549312785763083, 0.0737512264529919, 0.08296601020023528,
    0.09323070103389983, 0.10464361804190009, 0.11730738573830735, 0.13132775551158168,
    0.14681193883893653, 0.16386633085995067, 0.18259348130676067, 0.20308814830250557,
    0.2254322526390888, 0.24968854225334158, 0.27589278981679183, 0.30404439856865795,
    0.33409540977816654, 0.3659381266101969, 0.39939193765951864, 0.4341904774924434,
    0.46997100595206354, 0.5062687452216308, 0.5425196622846806, 0.5780754185695557,
    0.6122333878783057, 0.6442823137876843, 0.6735603636080292, 0.699517918700495,
    0.7217741366441041, 0.740155971609125, 0.7547117462172094, 0.7656974782356165,
    0.7735403580373187, 0.7787871304508678, 0.7820439490558336, 0.7839098888394899,
    0.7849062494773641, 0.7854184546569821, 0.7856824013720352, 0.7858212700182572,
    0.7858955347489275, 0.7859356064830403, 0.7859573397372627, 0.7859691658525355,
    0.7859756153935115, 0.7859791382240766, 0.7859810645737114, 0.7859821187758473,
    0.7859826960247205, 0.7859830122415018, 0.7859831855183186, 0.7859832804900225,
    0.7859833325519566, 0.78598336109496, 0.7859833767451067, 0.7859833853266682,
    0.7859833900324915, 0.7859833926130517, 0.7859833940282007, 0.7859833948046943,
    0.7859833952301922, 0.7859833954616339, 0.7859833955948715, 0.7859833956596011,
    0.7859833956954791, 0.785983395739437,
)  # fmt: skip
"""What `_solved_maxima` gives for the ellipse of Hertz: solving it anew costs each start the
import of scipy's optimisers, a fifth of a second. A test solves it."""


_KNOTS = np.linspace(np.log(_LOWEST), np.log(_HIGHEST), len(_MAXIMA))


def _solved_maxima(distribution: str) -> list[float]:
    from scipy.optimize import minimize_scalar

    def minus(x: float, peclet: float) -> float:
        return -float(moving_source_rise(x, peclet=peclet, distribution=distribution))

    return [
        -min(
            minimize_scalar(
                minus, (), (-0.2, 1.0), (pe,), method="bounded", options={"xatol": 1e-7}
            ).fun,
            minus(1.0, pe),
        )
        for pe in np.exp(_KNOTS).tolist()
    ]


@cache
def _peak_table(distribution: str) -> Floats:
    """C over ln Pe: the coefficients [power, interval] of a cubic spline over `_KNOTS`.

    Its third derivative is continuous at the second knot from either end.
    """
    peaks = np.array(_MAXIMA if distribution == "ellipse" else _solved_maxima(distribution))
    rise = np.diff(peaks)
    matrix = 4.0 * np.eye(peaks.size) + np.eye(peaks.size, k=1) + np.eye(peaks.size, k=-1)
    matrix[0, :2] = matrix[-1, :-3:-1] = 1.0, 2.0
    begin, end = 2.5 * rise[[0, -1]] + 0.5 * rise[[1, -2]]
    slope = np.linalg.solve(matrix, [begin, *(3.0 * (rise[:-1] + rise[1:])), end])
    bend = slope[:-1] + slope[1:] - 2.0 * rise
    return np.array([peaks[:-1], slope[:-1], rise - slope[:-1] - bend, bend])


def peclet_factor(peclet: ArrayLike, distribution: str = "ellipse") -> Floats:
    """Flash factor C(Pe) of the exact single-body solution [-].

    T_max = C Q_i/(B_i sqrt(v_i) sqrt(B)); C -> u of :data:`FLASH_FACTORS` for Pe -> infinity
    and -> sqrt(Pe) (A - ln Pe)/pi for Pe -> 0. ``peclet`` Pe = v B/a >= 0, any shape; 0 at 0.
    A spline through exact maxima, 1e-5 between Pe 1e-4 and 1e5, the limits beyond.

    >>> [f"{factor:.3f}" for factor in peclet_factor([1.0, 10.0, 1e5])]
    ['0.691', '0.783', '0.786']
    """
    flash_factor(distribution)
    pe = np.asarray(peclet, dtype=float)
    if not np.all(pe >= 0.0):
        raise InputError("peclet", pe.min(), allowed=">= 0")
    table = _peak_table(distribution)
    place = (np.log(np.clip(pe, _LOWEST, _HIGHEST)) - _KNOTS[0]) / (_KNOTS[1] - _KNOTS[0])
    interval = np.minimum(place.astype(int), _KNOTS.size - 2)
    exact = polyval(place - interval, table[:, interval], tensor=False)
    slow = np.where(pe > 0.0, np.minimum(pe, _LOWEST), 1.0)
    level = np.pi * table[0, 0] / np.sqrt(_LOWEST) + np.log(_LOWEST)
    slowest = np.sqrt(slow) / np.pi * (level - np.log(slow))
    return np.where(pe == 0.0, 0.0, np.where(pe < _LOWEST, slowest, exact))


def _carrying(
    speed: ArrayLike, half_width: ArrayLike, material: Material, distribution: str
) -> Floats:
    """Heat per width one flank takes per kelvin, B_i sqrt(v) sqrt(B)/C(Pe) [W/(m K)]."""
    v, b = np.asarray(speed, dtype=float), np.asarray(half_width, dtype=float)
    diffusivity = material.thermal_conductivity / (material.density * material.specific_heat)
    pe = np.asarray(v * b / diffusivity)
    below = peclet_factor(pe, distribution)
    above = material.thermal_contact_coefficient * np.sqrt(v * b)
    return np.asarray(np.divide(above, below, out=np.zeros(pe.shape), where=below > 0.0))


def peclet_flash(
    heat: ArrayLike,
    *,
    speed_1: ArrayLike,
    speed_2: ArrayLike,
    half_width: ArrayLike,
    material_1: Material,
    material_2: Material,
    distribution: str = "ellipse",
) -> Floats:
    """Flash temperature with the Peclet correction, equal maxima on both flanks [K].

    T = Q/[g_1 + g_2],  g_i = B_i sqrt(v_i) sqrt(B)/C(Pe_i).

    ``heat`` Q [W/m] frictional power per width, ``speed_1``, ``speed_2`` [m/s],
    ``half_width`` B [m]. Any shape; 0 where nothing is dissipated. Blok's formula for large Pe,
    lower below.

    >>> steel = material("steel")
    >>> rise = peclet_flash(
    ...     10e3, speed_1=6.0, speed_2=4.0, half_width=0.15e-3, material_1=steel, material_2=steel
    ... )
    >>> f"{rise:.1f} K"
    '11.1 K'
    """
    q = np.asarray(heat, dtype=float)
    one = _carrying(speed_1, half_width, material_1, distribution)
    total = np.asarray(one + _carrying(speed_2, half_width, material_2, distribution))
    shape = np.broadcast_shapes(q.shape, total.shape)
    return np.asarray(np.divide(q, total, out=np.zeros(shape), where=total > 0.0))


def flash_temperature(
    friction: ArrayLike,
    line_load: ArrayLike,
    *,
    speed_1: ArrayLike,
    speed_2: ArrayLike,
    half_width: ArrayLike,
    material_1: Material,
    material_2: Material,
    distribution: str = "ellipse",
    method: str = "peclet",
) -> Floats:
    """Flash temperature of one tooth pair by a named method [K].

    ``friction`` mu [-], ``line_load`` w [N/m] of this pair, ``speed_1``, ``speed_2`` [m/s],
    ``half_width`` B [m], ``distribution`` ellipse, uniform or parabola, ``method`` "blok"
    or "peclet" (default). Any shape; 0 at the pitch point, at no load and at rest.

    >>> steel = material("steel")
    >>> rise = flash_temperature(
    ...     0.05, 100e3, speed_1=6.0, speed_2=4.0, half_width=0.15e-3,
    ...     material_1=steel, material_2=steel,
    ... )
    >>> f"{rise:.1f} K"
    '11.1 K'
    """
    heat = frictional_heat(friction, line_load, speed_1=speed_1, speed_2=speed_2)
    if method == "blok":
        return blok_flash(
            friction,
            line_load,
            speed_1=speed_1,
            speed_2=speed_2,
            half_width=half_width,
            contact_coefficient_1=material_1.thermal_contact_coefficient,
            contact_coefficient_2=material_2.thermal_contact_coefficient,
            factor=flash_factor(distribution),
        )
    if method == "peclet":
        return peclet_flash(
            heat,
            speed_1=speed_1,
            speed_2=speed_2,
            half_width=half_width,
            material_1=material_1,
            material_2=material_2,
            distribution=distribution,
        )
    raise InputError("method", repr(method), allowed=" | ".join(METHODS))
