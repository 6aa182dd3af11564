"""The textbook mesh stiffness: springs of the two gears in series, tooth pairs in parallel.

Each tooth pair is five compliances (bending, shear, axial, foundation, contact) that know
nothing of the neighbouring pair. The sum overestimates double contact by 11..68 % and
single contact by 5..17 % against finite elements (25:75 and 20:40, bores of 0.2..0.8 of the
root circle), because two teeth in contact share one gear body; :mod:`thermogear.gears.loaded`
removes that.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.bounds import YOUNGS_MODULUS
from thermogear.base.errors import ValidityWarning
from thermogear.base.gauss import gauss
from thermogear.gears.contact import curvature_radii, pair_positions, reduced_modulus
from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.tooth import ToothCompliances, tooth_compliances

CONTACT_LAWS = {
    "weber-banaschek": "logarithmic, depth to each tooth's axis",
    "yang-sun": "linear, independent of load",
    "palmgren": "roller on plane, F^0.9",
}
PALMGREN_EXPONENT = 0.9


def yang_sun_stiffness(modulus: ArrayLike, face_width: ArrayLike) -> Floats:
    """Linear contact stiffness of a pair, k_h = pi E* b/2 [N/m].

    modulus: E* [Pa] with 1/E* = sum (1 - nu_i^2)/E_i; face_width: b [m]. For equal materials
    pi E b/(4 (1 - nu^2)). Independent of load and position.
    Source: Yang & Sun 1985, J. Mech. Trans. Autom. 107, 529.

    >>> f"{1e-9 * yang_sun_stiffness(115e9, 20e-3):.2f} GN/m"
    '3.61 GN/m'
    """
    return np.asarray(0.5 * np.pi * np.asarray(modulus) * np.asarray(face_width), dtype=float)


def weber_approach(
    force: ArrayLike,
    *,
    depth: ArrayLike,
    half_width: ArrayLike,
    modulus: ArrayLike,
    poisson: float,
    face_width: float | Floats,
) -> Floats:
    """Approach [m] of one flank to its tooth's axis under a Hertzian line load.

    delta_i = F 2 (1 - nu^2)/(pi E b) [ arsinh(eta) - nu/(1 - nu) eta (sqrt(1 + eta^2) - eta) ],
    eta = h_i/a: the strain of the half plane under Hertz's pressure down to the depth h_i.

    For a << h_i it is Weber and Banaschek's ln(2 h_i/a) - nu/(2 (1 - nu)), from which it departs
    by (a/h_i)^2/4. That form turns negative near a thin tip, where h_i < 0.6 a; the whole
    integral is >= 0 and rises with the force, 0 where the tooth has no depth left.

    force: F [N] >= 0 of the tooth pair; depth: h_i = x_p/cos(beta) >= 0 [m], from the contact
    along the force to the tooth axis; half_width: a [m] of the contact; modulus, poisson: of
    this gear; face_width: b [m]. The pair's approach is the sum over its two teeth. Any shapes;
    zero load gives 0 (F ln a -> 0). Plane strain near the contact.
    Source: Weber & Banaschek 1953; the stresses under the line contact Johnson, eq. 4.46.

    >>> approach = weber_approach(
    ...     4e3, depth=4e-3, half_width=0.15e-3, modulus=210e9, poisson=0.3, face_width=20e-3
    ... )
    >>> f"{1e6 * approach:.2f} um"
    '2.08 um'
    """
    f, a = np.asarray(force, dtype=float), np.asarray(half_width, dtype=float)
    loaded = f > 0.0
    eta = np.asarray(depth, dtype=float) / np.where(loaded, a, 1.0)
    # sqrt(1 + eta^2) - eta without the difference
    narrow = 1.0 / (np.hypot(1.0, eta) + eta)
    bracket = np.arcsinh(eta) - poisson / (1.0 - poisson) * eta * narrow
    scale = 2.0 * (1.0 - poisson**2) / (np.pi * np.asarray(modulus, dtype=float) * face_width)
    return np.asarray(np.where(f == 0.0, 0.0, f * scale * bracket))


def palmgren_approach(force: ArrayLike, modulus: ArrayLike, face_width: ArrayLike) -> Floats:
    """Approach [m] of a roller pair, delta = 3.81 (1/(pi E*))^0.9 F^0.9/b^0.8.

    force: F [N] >= 0; modulus: E* [Pa]; face_width: b [m]. For steel on steel the familiar
    3.84e-5 F^0.9/b^0.8 (N, mm). Zero load gives 0. Empirical, for bearing rollers.
    Source: Palmgren 1959, Ball and Roller Bearing Engineering.

    >>> f"{1e6 * palmgren_approach(4e3, 115e9, 20e-3):.2f} um"
    '6.02 um'
    """
    f = np.asarray(force, dtype=float)
    scale = (1.0 / (np.pi * np.asarray(modulus, dtype=float))) ** PALMGREN_EXPONENT
    return np.asarray(3.81 * scale * f**PALMGREN_EXPONENT / np.asarray(face_width) ** 0.8)


# Columns A..F of X* = A/th^2 + B h^2 + C h/th + D/th + E h + F
SAINSOT = {
    "L": (-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045),
    "M": (60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086),
    "P": (-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236),
    "Q": (-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904),
}
_RATIO_RANGE = (1.4, 7.0)
_ANGLE_RANGE = (0.01, 0.12)
# the reference gear of the literature lies at 0.1205, so the edge is not sharp
_ANGLE_MARGIN = 1.05


def sainsot_coefficients(theta_f: float, *, ratio: float) -> dict[str, float]:
    """L*, M*, P*, Q* for the foot half angle ``theta_f`` [rad] and h = r_f/r_bore.

    >>> f"{sainsot_coefficients(0.1, ratio=3.0)['L']:.3f}"
    '6.903'
    """
    return {
        name: a / theta_f**2 + b * ratio**2 + c * ratio / theta_f + d / theta_f + e * ratio + f
        for name, (a, b, c, d, e, f) in SAINSOT.items()
    }


def sainsot_compliance(
    gear: Gear,
    t: ArrayLike,
    modulus: ArrayLike | None = None,
    face_width: float | None = None,
) -> NDArray[np.float64]:
    """Deflection of the tooth's foundation per unit normal force, 1/k_f [m/N].

    1/k_f = cos^2(beta)/(b E) {L* (u_f/S_f)^2 + M* (u_f/S_f) + P* (1 + Q* tan^2 beta)},
    u_f = r_b/cos(beta) - r_f, S_f = 2 r_f theta_f, beta = t - theta_b.

    t: tan of the pressure angle at the loaded point, any shape; modulus: E [Pa], default the
    material's; face_width: b [m], default the gear's. Warns (ValidityWarning) outside
    1.4 <= h <= 7 or 0.01 <= theta_f <= 0.12, the ranges commonly quoted, by more than 5 % of
    the angle. Neighbouring teeth are not coupled.
    Source: Sainsot, Velex & Duverger 2004, J. Mech. Des. 126, 748.

    >>> gear = Gear(40, 4e-3, bore_radius=20e-3)
    >>> f"{1e9 * sainsot_compliance(gear, math.tan(math.radians(20))):.3f} um/kN"
    '1.490 um/kN'
    """
    theta_f, ratio = gear.root_half_angle, gear.root_radius / gear.bore_radius
    if not (
        _RATIO_RANGE[0] <= ratio <= _RATIO_RANGE[1]
        and _ANGLE_RANGE[0] <= theta_f <= _ANGLE_RANGE[1] * _ANGLE_MARGIN
    ):
        warnings.warn(
            f"foundation of the gear with {gear.teeth} teeth: r_f/r_bore = {ratio:.3f}, "
            f"theta_f = {theta_f:.4f} rad; range of the source 1.4 .. 7, 0.01 .. 0.12 rad",
            ValidityWarning,
            stacklevel=2,
        )
    c = sainsot_coefficients(theta_f, ratio=ratio)
    beta = np.asarray(t, dtype=float) - gear.base_half_angle
    cosine = np.cos(beta)
    lever = (gear.base_radius / cosine - gear.root_radius) / (2.0 * gear.root_radius * theta_f)
    young = np.asarray(gear.material.youngs_modulus if modulus is None else modulus, dtype=float)
    width = gear.face_width if face_width is None else face_width
    shape = c["L"] * lever**2 + c["M"] * lever + c["P"] * (1.0 + c["Q"] * np.tan(beta) ** 2)
    return np.asarray(cosine**2 * shape / (young * width))


@dataclass(frozen=True, kw_only=True)
class Moduli:
    """Young's moduli [Pa] of one gear's teeth and body; arrays broadcast with the positions.

    A hot gear takes ``tooth`` at its pitch circle's temperature and ``body`` at the body's
    area mean.

    >>> f"{1e-9 * Moduli.of(Gear(20, 4e-3)).tooth:.0f} GPa"
    '206 GPa'
    """

    tooth: ArrayLike
    body: ArrayLike

    def __post_init__(self) -> None:
        for name in ("tooth", "body"):
            YOUNGS_MODULUS.require(f"modulus.{name}", getattr(self, name))

    @classmethod
    def of(cls, gear: Gear) -> Moduli:
        """Both at the reference temperature."""
        return cls(tooth=gear.material.youngs_modulus, body=gear.material.youngs_modulus)

    @classmethod
    def at(cls, gear: Gear, *, tooth: ArrayLike, body: ArrayLike) -> Moduli:
        """E(T) of the gear's material at the two temperatures [K]."""
        material = gear.material
        return cls(tooth=material.youngs_modulus_at(tooth), body=material.youngs_modulus_at(body))


class GearCompliances(NamedTuple):
    """The compliances [m/N] of one gear in a tooth pair."""

    tooth: ToothCompliances
    foundation: Floats

    @property
    def total(self) -> Floats:
        """Sum of tooth and foundation [m/N]."""
        return self.tooth.total + self.foundation


class PairCompliances(NamedTuple):
    """The compliances [m/N] of one tooth pair; stiffness of each part is its inverse."""

    pinion: GearCompliances
    wheel: GearCompliances
    contact: Floats

    @property
    def total(self) -> Floats:
        """Sum of all parts [m/N]."""
        return self.pinion.total + self.wheel.total + self.contact


class MeshFigures(NamedTuple):
    """Time mean and extremes [N/m] of a mesh stiffness over one period."""

    mean: float
    minimum: float
    maximum: float


def pair_compliances(
    pair: GearPair,
    s: ArrayLike,
    start: str = "root-circle",
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
) -> PairCompliances:
    """The five parts of one tooth pair's compliance at ``s`` [m] on the path of contact.

    Beam integrals by :func:`tooth_compliances` from ``start``, Sainsot's foundation, Yang and
    Sun's contact; the common face width counts for both gears. pinion, wheel: moduli, default
    at the reference temperature. Any shapes that broadcast; nan where ``s`` is nan.

    >>> pair = GearPair(Gear(30, 4e-3), Gear(45, 4e-3))
    >>> parts = pair_compliances(pair, pair.path.c)
    >>> f"{1e9 * parts.contact:.3f} um/kN"
    '0.281 um/kN'
    """
    first = Moduli.of(pair.pinion) if pinion is None else pinion
    second = Moduli.of(pair.wheel) if wheel is None else wheel
    width = pair.face_width
    parts = [
        GearCompliances(
            tooth_compliances(gear, rho / gear.base_radius, start, moduli.tooth, width),
            sainsot_compliance(gear, rho / gear.base_radius, moduli.body, width),
        )
        for gear, rho, moduli in zip(
            (pair.pinion, pair.wheel), curvature_radii(pair, s), (first, second), strict=True
        )
    ]
    modulus = reduced_modulus(
        first.tooth,
        pair.pinion.material.poisson_ratio,
        second.tooth,
        pair.wheel.material.poisson_ratio,
    )
    contact = 1.0 / yang_sun_stiffness(modulus, width)
    return PairCompliances(parts[0], parts[1], contact)


def pair_stiffness(
    pair: GearPair,
    s: ArrayLike,
    start: str = "root-circle",
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
) -> Floats:
    """Stiffness of one tooth pair [N/m] at ``s``: 1/k = sum of the parts' compliances.

    Arguments as :func:`pair_compliances`. 0 where the pair is out of contact (``s`` nan or
    off the path A..E).

    >>> pair = GearPair(Gear(30, 4e-3), Gear(45, 4e-3))
    >>> f"{1e-6 * pair_stiffness(pair, pair.path.c):.0f} N/um"
    '286 N/um'
    """
    s_ = np.asarray(s, dtype=float)
    slack = 1e-9 * pair.base_pitch
    with np.errstate(invalid="ignore"):
        inside = (s_ >= pair.path.a - slack) & (s_ <= pair.path.e + slack)
    at = np.where(inside, s_, pair.path.c)
    return np.asarray(
        np.where(inside, 1.0 / pair_compliances(pair, at, start, pinion, wheel).total, 0.0)
    )


def mesh_stiffness(
    pair: GearPair,
    phase: ArrayLike,
    start: str = "root-circle",
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
) -> Floats:
    """Mesh stiffness [N/m] over the mesh phase: the uncoupled sum over the pairs in contact.

    k(phi) = sum_j k(s_j),  s_j = s_A + (phi + j) p_b < s_E.
    phase: in periods, any shape; moduli broadcast with it. Jumps where a pair enters or leaves.

    >>> pair = GearPair(Gear(30, 4e-3), Gear(45, 4e-3))
    >>> (1e-6 * mesh_stiffness(pair, [0.1, 0.8])).round(0)  # N/um, two pairs and one
    array([493., 286.])
    """
    s = pair_positions(pair, phase)
    # pair by pair, so that the moduli's axes meet the phase's and never the pairs'
    return np.asarray(
        sum(pair_stiffness(pair, s[..., rank], start, pinion, wheel) for rank in range(s.shape[-1]))
    )


def mesh_figures(
    pair: GearPair,
    start: str = "root-circle",
    pinion: Moduli | None = None,
    wheel: Moduli | None = None,
) -> MeshFigures:
    """Mean and extremes of :func:`mesh_stiffness` with both sides of its jumps included.

    The mean is integrated between the jumps by Gauss-Legendre quadrature. Scalar moduli.

    >>> pair = GearPair(Gear(30, 4e-3), Gear(45, 4e-3))
    >>> f"{1e-6 * mesh_figures(pair).mean:.0f} N/um"
    '433 N/um'
    """
    length = pair.path.e - pair.path.a
    ratio = length / pair.base_pitch
    nodes, weights = gauss(32)
    s = pair.path.a + 0.5 * length * (1.0 + nodes)
    single = pair_stiffness(pair, s, start, pinion, wheel)
    mean = float(0.5 * ratio * np.sum(weights * single))
    # between the jumps at phase 0 and eps - floor(eps) the number of pairs is constant
    change = ratio - np.floor(ratio + 1e-12)
    values = []
    for low, high, count in (
        (0.0, change, int(np.floor(ratio + 1e-12)) + 1),
        (change, 1.0, int(np.floor(ratio + 1e-12))),
    ):
        if high - low > 1e-9:
            phi = np.linspace(low, high, 201)
            at = pair.path.a + (phi + np.arange(count)[:, None]) * pair.base_pitch
            at = np.minimum(at, pair.path.e)
            values.append(pair_stiffness(pair, at, start, pinion, wheel).sum(axis=0))
    every = np.concatenate(values)
    return MeshFigures(mean, float(every.min()), float(every.max()))
