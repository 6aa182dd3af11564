"""Thermal growth of gears: annulus displacement, flank growth, hot half backlash, jam.

A gear body is an annulus with the radial field of :class:`RadialField`; its teeth carry no
hoop stress and follow the root circle. Everything is of first order in lambda tau, tau the
rise over the reference temperature.

The displacements are written as u(r) = lambda tau(r) r + w(r). The excess w comes from the
gradient and from the bore's support alone, so that a uniform field gives w = 0 exactly: then
an involute stays an involute and gears that heat with their housing keep their backlash to the
last bit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, require_choice
from thermogear.gears.geometry import Gear
from thermogear.heat.temperature import radial_temperature

BORES: dict[str, str] = {
    "free": "free bore",
    "rigid": "bore held by a rigid cold shaft, u_a = 0",
    "shaft": "bore follows a shaft of the same material at its own temperature",
}
"""How the bore is held: name -> what it means."""

PLANES = ("stress", "strain")


@dataclass(frozen=True, eq=False, kw_only=True)
class RadialField:
    """T(r) of a gear body, logarithmic between bore, addendum circle and the places ``between``.

    ``bore_radius`` r_x, ``tip_radius`` r_a [m]; ``bore_temperature`` T_x and
    ``addendum_temperature`` T_a [K], numbers or arrays that broadcast against the radii (shape
    (operating, 1) against radii of shape (position,)); ``reference`` T0 [K], where the
    drawing's dimensions hold. ``between``: (radius [m], temperature [K]) of further places in
    rising order, such as the nodes of a heat network, through which the field passes; with
    none it is the steady conduction of an annulus. Raises for r_x <= 0, r_x >= r_a, places that
    do not rise from bore to tip, temperatures <= 0 K.

    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> gear = Gear(20, 4e-3)
    >>> f"{1e6 * base_circle_growth(gear, field):.2f} um"
    '43.23 um'
    >>> f"{1e6 * flank_growth(gear, field, 40e-3):.2f} um"
    '15.73 um'
    """

    bore_radius: float
    tip_radius: float
    bore_temperature: ArrayLike
    addendum_temperature: ArrayLike
    reference: float
    between: tuple[tuple[float, ArrayLike], ...] = ()

    def __post_init__(self) -> None:
        for name in ("bore_temperature", "addendum_temperature"):
            object.__setattr__(self, name, np.asarray(getattr(self, name), dtype=float))
        if not (np.isfinite(self.reference) and self.reference > 0.0):
            raise InputError("reference temperature", f"{self.reference} K", allowed="> 0 K")
        placed = tuple((float(r), np.asarray(t, dtype=float)) for r, t in self.between)
        object.__setattr__(self, "between", placed)
        self.temperature(self.tip_radius)
        radii = [self.bore_radius, *(r for r, _ in placed), self.tip_radius]
        if not np.all(np.diff(radii) > 0.0):
            raise InputError(
                "between", f"{radii[1:-1]} m", allowed="rising between bore and tip radius"
            )
        for _, kelvin in placed:
            if not np.all(np.isfinite(kelvin) & (kelvin > 0.0)):
                raise InputError("between", f"{kelvin} K", allowed="> 0 K, finite")

    @classmethod
    def uniform(
        cls, *, bore_radius: float, tip_radius: float, temperature: ArrayLike, reference: float
    ) -> RadialField:
        """The same temperature everywhere."""
        return cls(
            bore_radius=bore_radius,
            tip_radius=tip_radius,
            bore_temperature=temperature,
            addendum_temperature=temperature,
            reference=reference,
        )

    @property
    def bore_rise(self) -> Floats:
        """t_x = T_x - T0 [K]."""
        return np.asarray(self.bore_temperature) - self.reference

    @property
    def gradient(self) -> Floats:
        """g = (T_a - T_x)/ln(r_a/r_x) [K]; exactly 0 for a uniform field.

        Over the whole body: the gradient everywhere only where nothing is between.
        """
        drop = np.asarray(self.addendum_temperature) - np.asarray(self.bore_temperature)
        return np.asarray(drop / np.log(self.tip_radius / self.bore_radius))

    @cached_property
    def kinks(self) -> tuple[tuple[float, Floats], ...]:
        """(r_k [m], dg_k [K]) with T(r) = T_x + sum dg_k ln(r/r_k) over the places r_k < r."""
        if not self.between:
            return ((self.bore_radius, self.gradient),)
        ends = (self.tip_radius, self.addendum_temperature)
        all_of_them = ((self.bore_radius, self.bore_temperature), *self.between, ends)
        places = [(r, np.asarray(t)) for r, t in all_of_them]
        found: list[tuple[float, Floats]] = []
        before: Floats | float = 0.0
        for (low, cool), (high, warm) in pairwise(places):
            slope = np.asarray((warm - cool) / np.log(high / low))
            found.append((low, np.asarray(slope - before)))
            before = slope
        return tuple(found)

    def temperature(self, radius: ArrayLike) -> Floats:
        """T(r) [K] for r_x <= r <= r_a; raises outside."""
        whole = radial_temperature(
            radius,
            bore_radius=self.bore_radius,
            tip_radius=self.tip_radius,
            bore_temperature=self.bore_temperature,
            addendum_temperature=self.addendum_temperature,
        )
        return self.rise(radius) + self.reference if self.between else whole

    def rise(self, radius: ArrayLike) -> Floats:
        """tau(r) = t_x + sum dg_k ln(r/r_k) [K] over the reference."""
        r = np.asarray(radius, dtype=float)
        total = self.bore_rise
        for start, change in self.kinks:
            total = total + change * np.log(np.maximum(r, start) / start)
        return np.asarray(total)

    def area_mean(self, radius: ArrayLike) -> Floats:
        """Mean temperature over the annulus from the bore to ``radius`` [K], by area."""
        r = np.asarray(radius, dtype=float)
        area = 0.5 * (r**2 - self.bore_radius**2)
        total = np.asarray(self.bore_temperature)
        for start, change in self.kinks:
            total = total + change * (_log_moment(np.maximum(r, start), start) / area)
        return np.asarray(total)


def _log_moment(radius: ArrayLike, bore_radius: ArrayLike) -> Floats:
    """K(r) = int_{r_x}^r s ln(s/r_x) ds = r^2 ln(r/r_x)/2 - (r^2 - r_x^2)/4."""
    r, rx = np.asarray(radius, dtype=float), np.asarray(bore_radius, dtype=float)
    return np.asarray(0.5 * r**2 * np.log(r / rx) - 0.25 * (r**2 - rx**2))


def _support(bore: str, plane: str, expansion: float, poisson: float) -> tuple[float, float]:
    """(lambda, nu) of the plane problem; refuses unknown names."""
    require_choice("bore", bore, BORES)
    require_choice("plane", plane, PLANES)
    if plane == "strain":
        return expansion * (1.0 + poisson), poisson / (1.0 - poisson)
    return expansion, poisson


def _annulus_excess(
    field: RadialField,
    radius: ArrayLike,
    outer_radius: float,
    expansion: float,
    poisson: float,
    bore: str,
) -> Floats:
    """w(r) = u(r) - lambda tau(r) r of an annulus free at ``outer_radius`` [m].

    ``expansion`` and ``poisson`` already those of the plane problem.
    """
    if not outer_radius > field.bore_radius:
        raise InputError(
            "bore_radius",
            f"{field.bore_radius} m with root radius {outer_radius} m",
            allowed="0 < bore radius < root radius",
            why="no ring would be left below the teeth",
        )
    r = np.asarray(radius, dtype=float)
    rx, ro = field.bore_radius, outer_radius

    def free(at: Floats) -> Floats:
        total: Floats | float = 0.0
        for start, change in field.kinks:
            beyond = np.maximum(at, start)
            whole = _log_moment(max(ro, start), start) / (ro**2 - rx**2)
            pulled = (1.0 + poisson) * _log_moment(beyond, start)
            pulled = pulled + ((1.0 - poisson) * at**2 + (1.0 + poisson) * rx**2) * whole
            total = total + expansion * change * (pulled / at - at * np.log(beyond / start))
        return np.asarray(total)

    excess = free(r)
    if bore == "free":
        return excess
    # the support moves the bore from where it would go freely; the outer edge stays free
    wanted = -expansion * field.bore_rise * rx if bore == "rigid" else 0.0 * field.bore_rise
    shift = wanted - free(np.asarray(rx))
    spread = ((1.0 - poisson) * r**2 + (1.0 + poisson) * ro**2) / (
        (1.0 - poisson) * rx**2 + (1.0 + poisson) * ro**2
    )
    return np.asarray(excess + shift * spread * (rx / r))


def _excess(
    field: RadialField,
    radius: ArrayLike,
    root_radius: float,
    expansion: float,
    poisson: float,
    bore: str,
) -> Floats:
    """w(r) in ring and tooth; above the root circle dw/dr = -lambda g, g the gradient there."""
    r = np.asarray(radius, dtype=float)
    inside = np.minimum(r, root_radius)
    total = _annulus_excess(field, inside, root_radius, expansion, poisson, bore)
    for start, change in field.kinks:
        length = np.maximum(r, start) - np.maximum(inside, start)
        total = total - expansion * change * length
    return np.asarray(total)


def radial_displacement(
    field: RadialField,
    radius: ArrayLike,
    *,
    root_radius: float,
    expansion: float,
    poisson: float,
    bore: str = "free",
    plane: str = "stress",
) -> Floats:
    """Radial displacement u_r(r) of ring and tooth [m].

    Up to the root circle R an annulus, with free bore (A1):

    u = (lambda/r) { (1+nu) J(r) + [(1-nu) r^2 + (1+nu) r_x^2] J(R)/(R^2 - r_x^2) },
    J(r) = int_{r_x}^r tau s ds.

    Bore moved by u_a (A2), which is 0 (``bore`` "rigid") or lambda t_x r_x ("shaft"):

    u = (1+nu) lambda J/r + C1 r + C2/r,
    C1 = [(1-nu) r_x u_a + (1-nu^2) lambda J(R)]/[(1-nu) r_x^2 + (1+nu) R^2],
    C2 = r_x u_a - C1 r_x^2.

    Above it the tooth grows freely, u_r(r) = u(R) + lambda int_R^r tau dr.

    ``field`` the temperature, ``radius`` r [m], ``root_radius`` R [m], ``expansion`` lambda [1/K],
    ``poisson`` nu, ``plane`` "stress" or "strain" (nu -> nu/(1-nu), lambda -> lambda (1+nu), the
    shaft's too). Shape of field and radius. Identity for the free bore: u(R) = lambda R times the
    area mean of tau. Raises for unknown names and for R <= r_x. At the base circle it is the u_b
    that printed formulas leave undefined. Continuous at R. Source: plane thermoelasticity of the
    annulus; both forms agree with a boundary-value solver.

    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> u = radial_displacement(field, 40e-3, root_radius=35e-3, expansion=11.5e-6, poisson=0.3)
    >>> f"{1e6 * u:.2f} um"
    '46.00 um'
    """
    lam, nu = _support(bore, plane, expansion, poisson)
    r = np.asarray(radius, dtype=float)
    return np.asarray(lam * field.rise(r) * r + _excess(field, r, root_radius, lam, nu, bore))


def base_circle_growth(
    gear: Gear, field: RadialField, bore: str = "free", plane: str = "stress"
) -> Floats:
    """u_b = u_r(r_b), the radial displacement of the base circle [m].

    T0 + u_b/(lambda r_b) is the gear's effective temperature for its base pitch. Shape of the
    field's temperatures.
    """
    return radial_displacement(
        field,
        gear.base_radius,
        root_radius=gear.root_radius,
        expansion=gear.material.thermal_expansion,
        poisson=gear.material.poisson_ratio,
        bore=bore,
        plane=plane,
    )


def flank_normal_growth(
    field: RadialField,
    radius: ArrayLike,
    half_thickness_angle: ArrayLike,
    *,
    base_radius: float,
    root_radius: float,
    expansion: float,
    poisson: float,
    bore: str = "free",
    plane: str = "stress",
    strain_taken_off: ArrayLike = 0.0,
) -> Floats:
    """Normal growth (B) of one flank about its tooth centre line [m], positive = material.

    delta_n(r) = u_r sin(alpha_k) + psi [ r lambda tau(r) - u_r ] cos(alpha_k),
    cos(alpha_k) = r_b/r.

    ``radius`` r [m] >= r_b, ``half_thickness_angle`` psi(r) [rad], ``base_radius``,
    ``root_radius`` [m], the rest as :func:`radial_displacement`. ``strain_taken_off`` eps [-]
    returns delta_n - eps rho_k instead, rho_k the curvature radius: the growth beyond a body
    that swells uniformly by eps, exactly 0 for lambda tau = eps. Uniform tau: lambda tau rho_k.
    Shape of field and radius. Raises for r < r_b. Agrees with a plane-stress finite-element
    sector to 0.2 um (25 teeth) and 0.7 um (75 teeth).

    >>> field = RadialField.uniform(
    ...     bore_radius=16e-3, tip_radius=44e-3, temperature=393.15, reference=293.15
    ... )
    >>> growth = flank_normal_growth(
    ...     field, 40e-3, 0.08, base_radius=37.5e-3, root_radius=35e-3, expansion=1e-5, poisson=0.3
    ... )
    >>> f"{1e6 * growth:.2f} um"
    '13.92 um'
    """
    lam, nu = _support(bore, plane, expansion, poisson)
    r = np.asarray(radius, dtype=float)
    if np.any(r < base_radius * (1.0 - 1e-12)):
        raise InputError(
            "radius",
            f"{r.min():.6g} m",
            allowed=f">= {base_radius:.6g} m",
            why="the involute starts at the base circle",
        )
    cosine = np.minimum(base_radius / r, 1.0)
    curvature = np.sqrt(np.maximum(r**2 - base_radius**2, 0.0))
    excess = _excess(field, r, root_radius, lam, nu, bore)
    uniform = (lam * field.rise(r) - np.asarray(strain_taken_off)) * curvature
    tilt = curvature / r - np.asarray(half_thickness_angle) * cosine
    return np.asarray(uniform + excess * tilt)


def flank_growth(
    gear: Gear,
    field: RadialField,
    radius: ArrayLike,
    bore: str = "free",
    plane: str = "stress",
    strain_taken_off: ArrayLike = 0.0,
) -> Floats:
    """Normal growth (B) of one flank of ``gear`` at ``radius`` [m]; :func:`flank_normal_growth`.

    Includes the body's radial displacement; the axes' movement enters apart, in
    :func:`hot_half_backlash`.
    """
    return flank_normal_growth(
        field,
        radius,
        gear.half_thickness_angle(radius),
        base_radius=gear.base_radius,
        root_radius=gear.root_radius,
        expansion=gear.material.thermal_expansion,
        poisson=gear.material.poisson_ratio,
        bore=bore,
        plane=plane,
        strain_taken_off=strain_taken_off,
    )


def centre_distance_growth(
    centre_distance: ArrayLike,
    expansion: ArrayLike,
    *,
    temperature: ArrayLike,
    reference: ArrayLike,
) -> Floats:
    """Da = lambda_h (T_h - T0) a [m]: how far a housing at ``temperature`` moves the axes.

    ``centre_distance`` a [m], ``expansion`` lambda_h [1/K], temperatures [K]. Along the line of
    action it opens the mesh by Da sin(alpha_w).

    >>> growth = centre_distance_growth(0.12, 11.5e-6, temperature=333.15, reference=293.15)
    >>> f"{1e6 * growth:.1f} um"
    '55.2 um'
    """
    rise = np.asarray(temperature, dtype=float) - np.asarray(reference)
    return np.asarray(np.asarray(expansion) * rise * np.asarray(centre_distance))


def hot_half_backlash(
    half_backlash: ArrayLike,
    *,
    growth_1: ArrayLike,
    growth_2: ArrayLike,
    axis_opening: ArrayLike = 0.0,
) -> Floats:
    """Half backlash when hot, along the line of action [m].

    b' = b - (delta_n1 + delta_n2) + Da sin(alpha_w).

    ``half_backlash`` b [m] cold; ``growth_1``, ``growth_2`` [m] of one flank of pinion and
    wheel (both flanks of both gears grow); ``axis_opening`` Da sin(alpha_w) [m]. Any shape.
    b' <= 0 means jammed. Growths with ``strain_taken_off`` = lambda_h (T_h - T0) and no opening
    give the same: a pair as hot as its housing keeps b exactly.

    >>> backlash = hot_half_backlash(60e-6, growth_1=18e-6, growth_2=25e-6, axis_opening=19e-6)
    >>> f"{1e6 * backlash:.1f} um"
    '36.0 um'
    """
    lost = np.asarray(growth_1, dtype=float) + np.asarray(growth_2)
    return np.asarray(np.asarray(half_backlash) - lost + np.asarray(axis_opening))
