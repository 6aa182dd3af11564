"""Coefficient of friction: published laws as functions, law objects, one table of names.

Every law returns the magnitude |mu|; the direction belongs to the friction force. A law object
holds a law's own parameters and is called with a :class:`ContactState`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest
from thermogear.heat.contact_state import ContactState
from thermogear.heat.film import RMS_OF_MEAN_ROUGHNESS, rms_roughness
from thermogear.heat.law_parameters import (
    Bounded,
    Coefficient,
    Factor,
    PitchFloor,
    law_words,
    with_parameters,
)
from thermogear.heat.laws import (
    CEILING,
    FZG_LUBRICANT_FACTOR,
    ISO_LUBRICANT_FACTOR,
    doleschel_share,
    fernandes,
    iso_13989_1,
    iso_13989_2,
    lubricant_factor,
    schlenk,
    xu_kahraman,
)

ROUGHNESS_LIMIT = 1.13e-6
"""Roughness [m] at which Benedict and Kelley's factor 1.13/(1.13 - S) diverges."""


class FrictionLaw(Protocol):
    """A coefficient of friction with its name, regime and source.

    >>> [law().name for law in (Boundary, Schlenk, Iso13989Flash, Iso13989Integral, Fernandes)]
    ['boundary', 'schlenk', 'iso-13989-1', 'iso-13989-2', 'fernandes']
    """

    name: ClassVar[str]
    regime: ClassVar[str]
    source: ClassVar[str]
    ranges: ClassVar[Mapping[str, tuple[float, float]]]

    def __call__(self, state: ContactState) -> Floats:
        """|mu| [-] in the common shape of ``state``."""


def outside_range(law: FrictionLaw, state: ContactState) -> NDArray[np.bool_]:
    """Where ``state`` leaves the range the law's source gives, in the shape of ``state``.

    A law's ``ranges`` name fields of :class:`ContactState` with their least and greatest SI
    values; a field the state does not carry is not judged.
    """
    given = {name: getattr(state, name) for name in law.ranges}
    return np.broadcast_to(beyond(law, given), state.shape).copy()


def beyond(law: FrictionLaw, values: Mapping[str, ArrayLike | None]) -> NDArray[np.bool_]:
    """Where ``values`` [SI], by field of :class:`ContactState`, leave the law's range.

    Any shapes that broadcast; a field that is not given, or None, is not judged.
    """
    outside = np.zeros((), dtype=bool)
    for name, (low, high) in law.ranges.items():
        value = values.get(name)
        if value is not None:
            outside = outside | (np.asarray(value) < low) | (np.asarray(value) > high)
    return np.asarray(outside)


def _spread(mu: Floats, state: ContactState) -> Floats:
    return np.broadcast_to(mu, state.shape).copy()


def benedict_kelley(
    line_load: ArrayLike,
    *,
    sliding_speed: ArrayLike,
    sum_speed: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    pitch_floor: float = 0.01,
    ceiling: float = CEILING,
) -> Floats:
    """Mixed-lubrication friction of Benedict and Kelley, regularised [-].

    mu = 0.0127 * 1.13/(1.13 - S) * log10[ 29660 w/(eta v_s v_sum^2) ],
    S in um, w in N/mm, eta in mPa s, v in m/s (0.02966 with SI units in the logarithm).

    ``line_load`` w [N/m] >= 0, ``sliding_speed`` v1 - v2 [m/s] of either sign, ``sum_speed``
    v1 + v2 [m/s] >= 0, ``viscosity`` eta [Pa s] > 0, ``roughness`` S [m] < 1.13 um.
    ``pitch_floor`` delta: the logarithm sees sqrt(v_s^2 + (delta v_sum/2)^2), so the pitch
    point has a finite value; it moves mu by less than 1e-4 where |v_s| > 0.1 v_sum/2.
    ``ceiling``: greatest value returned, met only near rest. Where the argument falls below 1
    (light load, high speed) the formula would turn negative and 0 is returned; so too at zero
    load. Any shape. Raises for S >= 1.13 um. Sign and limits: mu falls with both speeds and
    viscosity, rises with load and roughness.
    Source: Benedict and Kelley, ASLE Trans. 4 (1961) 59-70; 29660 is 3.17e8 of the US units
    (lb/in, cP, in/s) converted, usually printed 29700.

    >>> mu = benedict_kelley(
    ...     200e3, sliding_speed=1.0, sum_speed=10.0, viscosity=0.02, roughness=0.4e-6
    ... )
    >>> f"{mu:.4f}"
    '0.0682'
    """
    if not (np.isfinite(pitch_floor) and pitch_floor > 0.0):
        raise InputError("pitch_floor", pitch_floor, allowed="> 0")
    w, vs, total, eta, rough = (
        np.asarray(a, dtype=float)
        for a in (line_load, sliding_speed, sum_speed, viscosity, roughness)
    )
    if np.any(rough >= ROUGHNESS_LIMIT):
        raise InputError(
            "roughness",
            f"{rough.max() * 1e6:.3g} um",
            allowed="< 1.13 um",
            why="Benedict and Kelley's factor 1.13/(1.13 - S) diverges there",
            fix="use the law 'iso-13989-2' or a smoother flank",
        )
    vs, total = np.broadcast_arrays(vs, total)
    below = eta * np.hypot(vs, pitch_floor * 0.5 * total) * total**2
    w, below = np.broadcast_arrays(w, below)
    at_rest = below == 0.0
    ratio = np.divide(0.02966 * w, below, out=np.ones(w.shape), where=~at_rest)
    decades = np.log10(np.maximum(ratio, 1.0))
    mu = np.minimum(0.0127 * ROUGHNESS_LIMIT / (ROUGHNESS_LIMIT - rough) * decades, ceiling)
    return np.where(at_rest & (w > 0.0), ceiling, mu)


def benedict_kelley_as_printed(
    line_load: ArrayLike,
    *,
    sliding_speed: ArrayLike,
    entrainment_speed: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
) -> Floats:
    """The "mixed" formula exactly as the thesis prints it, evaluated in SI; signed [-].

    mu = 1.13e-2 (eta w/S)^0.127 sign(v_s) log10[ 29700 eta / sqrt(v_e^2/|v_s|) ].

    Arguments as :func:`benedict_kelley` with ``entrainment_speed`` (v1 + v2)/2. 0 where
    nothing slides. Power and logarithm both take dimensional arguments, so the value depends
    on the units: 0.55..0.61 for the rig. Kept to show the misprint; feeds nothing.
    """
    w, vs, ve, eta, rough = (
        np.asarray(a, dtype=float)
        for a in (line_load, sliding_speed, entrainment_speed, viscosity, roughness)
    )
    slides = np.asarray((vs != 0.0) & (ve > 0.0))
    slide, roll = np.where(slides, np.abs(vs), 1.0), np.where(slides, ve, 1.0)
    inside = 29700.0 * eta / np.sqrt(roll**2 / slide)
    mu = 1.13e-2 * (eta * w / rough) ** 0.127 * np.log10(inside)
    return np.where(slides, np.sign(vs) * mu, 0.0)


def constant_dry(sliding_speed: ArrayLike, coefficient: float = 0.2) -> Floats:
    """Dry friction, one constant everywhere [-].

    ``sliding_speed`` [m/s] gives the shape only; ``coefficient`` [-] 0.1..0.5 in the thesis.
    Raises outside 0 < mu <= 1.

    >>> constant_dry([0.5, 2.0], coefficient=0.15)
    array([0.15, 0.15])
    """
    if not 0.0 < coefficient <= 1.0:
        raise InputError("dry_coefficient", coefficient, allowed="0 < mu <= 1")
    return np.full(np.shape(sliding_speed), float(coefficient))


@dataclass(frozen=True, kw_only=True)
class BenedictKelley(Bounded):
    """Benedict and Kelley 1961 with its two regularisations; see :func:`benedict_kelley`.

    Its viscosity is that of the oil supply, as the thesis and gear codes read eta_0.

    >>> BenedictKelley(ceiling=0.2).regime
    'mixed'
    """

    pitch_floor: PitchFloor = 0.01
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "benedict-kelley"
    regime: ClassVar[str] = "mixed"
    source: ClassVar[str] = "Benedict and Kelley, ASLE Trans. 4 (1961) 59-70"
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType(
        {"roughness": (0.0, 1.13e-6)}
    )

    def __call__(self, state: ContactState) -> Floats:
        return _spread(
            benedict_kelley(
                state.line_load,
                sliding_speed=state.sliding,
                sum_speed=state.sum_speed,
                viscosity=state.oil_viscosity,
                roughness=state.roughness,
                pitch_floor=self.pitch_floor,
                ceiling=self.ceiling,
            ),
            state,
        )


@dataclass(frozen=True)
class ConstantDry:
    """One constant, dry; see :func:`constant_dry`.

    >>> ConstantDry(0.15)
    ConstantDry(coefficient=0.15)
    """

    coefficient: float = 0.2
    name: ClassVar[str] = "dry"
    regime: ClassVar[str] = "dry"
    source: ClassVar[str] = "a constant, as the case gives it"
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType({})

    def __post_init__(self) -> None:
        constant_dry(0.0, self.coefficient)

    def __call__(self, state: ContactState) -> Floats:
        return _spread(constant_dry(state.sliding, self.coefficient), state)


@dataclass(frozen=True)
class Boundary(Bounded):
    """Boundary lubrication, one constant."""

    coefficient: Coefficient = 0.10
    name: ClassVar[str] = "boundary"
    regime: ClassVar[str] = "boundary"
    source: ClassVar[str] = "0.10 in public gear code for doped oils, 0.12 in bearing practice"
    # where the regime of its name ends, by the customary limit
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType(
        {"film_parameter": (0.0, 1.0)}
    )

    def __call__(self, state: ContactState) -> Floats:
        return _spread(constant_dry(state.sliding, self.coefficient), state)


@dataclass(frozen=True, kw_only=True)
class XuKahraman(Bounded):
    """Xu and Kahraman 2007, local; see :func:`laws.xu_kahraman`.

    The fit's roughness is rms: the contact's Ra is converted. ``smooth`` leaves it out, as a
    blend with boundary friction needs it.

    >>> XuKahraman(smooth=True).name
    'xu-kahraman'
    """

    smooth: bool = False
    pitch_floor: PitchFloor = 0.01
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "xu-kahraman"
    regime: ClassVar[str] = "elastohydrodynamic"
    source: ClassVar[str] = "Xu and Kahraman, J. Mech. Des. 129 (2007) 58-68"
    # the regression's roughness enters as exp(S): beyond about 1 um rms it runs away
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType(
        {"roughness": (0.0, 1e-6 / RMS_OF_MEAN_ROUGHNESS), "viscosity": (1e-3, np.inf)}
    )

    def __call__(self, state: ContactState) -> Floats:
        return _spread(
            xu_kahraman(
                state.pressure,
                sliding_speed=state.sliding,
                entrainment=state.entrainment,
                viscosity=state.viscosity,
                reduced_radius=state.reduced_radius,
                roughness=0.0 if self.smooth else rms_roughness(state.roughness),
                pitch_floor=self.pitch_floor,
                ceiling=self.ceiling,
            ),
            state,
        )


@dataclass(frozen=True)
class LambdaBlend(Bounded):
    """Mixed lubrication: boundary and smooth film friction by Doleschel's share.

    mu = xi mu_boundary + (1 - xi) mu_film, xi = (1 - lambda/2)^2 below 2, lambda the central film
    over the mean Ra (:func:`laws.doleschel_share`). The film's law is smooth, so that asperities
    are not counted twice. ``boundary`` 0.07 is what Arana, Larranaga and Ulacia, Proc. IMechE J
    233 (2019) 303-316, advise for ground gears in such a blend, near the greatest mean friction
    measured at 0.5 m/s on FZG gears, 0.065; other codes take 0.09 to 0.10.

    >>> LambdaBlend(boundary=0.09).boundary
    0.09
    """

    boundary: Coefficient = 0.07
    film: XuKahraman = XuKahraman(smooth=True)
    name: ClassVar[str] = "lambda-blend"
    regime: ClassVar[str] = "boundary to elastohydrodynamic"
    source: ClassVar[str] = (
        "Doleschel's share and boundary value as in Arana et al., Proc. IMechE J 233 (2019) "
        "303-316; smooth film by Xu and Kahraman"
    )
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType(
        {"viscosity": (1e-3, np.inf)}
    )
    films: ClassVar[tuple[str, ...]] = ("central_film_parameter",)

    def __call__(self, state: ContactState) -> Floats:
        share = doleschel_share(state.needed("central_film_parameter", self.name))
        mu = share * self.boundary + (1.0 - share) * self.film(state)
        return _spread(mu, state)


def _of_mesh(
    state: ContactState, law: str
) -> tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike, ArrayLike]:
    """What every mean of the mesh takes first: load, speed, radius, oil, roughness (SI)."""
    at = state.pitch(law)
    return at.line_load, at.sum_speed, at.reduced_radius, state.oil_viscosity, state.roughness


@dataclass(frozen=True, kw_only=True)
class Schlenk(Bounded):
    """Mean friction of ISO/TR 14179-2; ``factor`` None takes X_L by the base oil."""

    factor: Factor | None = None
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "schlenk"
    regime: ClassVar[str] = "mixed, mean of the mesh"
    source: ClassVar[str] = "Schlenk, ISO/TR 14179-2; X_L of FZG tests (Fernandes, Seabra)"

    def __call__(self, state: ContactState) -> Floats:
        kind = lubricant_factor(state.lubricant_kind, FZG_LUBRICANT_FACTOR)
        factor = kind if self.factor is None else self.factor
        return _spread(
            schlenk(*_of_mesh(state, self.name), factor=factor, ceiling=self.ceiling), state
        )


@dataclass(frozen=True, kw_only=True)
class Iso13989Flash(Bounded):
    """Mean friction of ISO/TR 13989-1; ``factor`` None takes c by the base oil."""

    factor: Factor | None = None
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "iso-13989-1"
    regime: ClassVar[str] = "mixed, mean of the mesh"
    source: ClassVar[str] = "ISO/TR 13989-1 eq. 25-28"

    def __call__(self, state: ContactState) -> Floats:
        kind = ISO_LUBRICANT_FACTOR.get(state.lubricant_kind, 1.0)
        factor = kind if self.factor is None else self.factor
        return _spread(
            iso_13989_1(*_of_mesh(state, self.name), factor=factor, ceiling=self.ceiling), state
        )


@dataclass(frozen=True, kw_only=True)
class Iso13989Integral(Bounded):
    """Mean friction of ISO/TR 13989-2 and 15144-1 (Michaelis); ``factor`` X_L."""

    factor: Factor = 1.0
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "iso-13989-2"
    regime: ClassVar[str] = "mixed, mean of the mesh"
    source: ClassVar[str] = "ISO/TR 13989-2 eq. 1-7 = ISO/TR 15144-1 eq. 86"

    def __call__(self, state: ContactState) -> Floats:
        return _spread(
            iso_13989_2(*_of_mesh(state, self.name), factor=self.factor, ceiling=self.ceiling),
            state,
        )


@dataclass(frozen=True, kw_only=True)
class Fernandes(Bounded):
    """Mean friction by Fernandes 2016; ``factor`` None takes X_L by the base oil."""

    factor: Factor | None = None
    ceiling: Coefficient = CEILING
    name: ClassVar[str] = "fernandes"
    regime: ClassVar[str] = "mixed, mean of the mesh"
    source: ClassVar[str] = "Fernandes et al., Tribology International 101 (2016) 204"

    def __call__(self, state: ContactState) -> Floats:
        kind = lubricant_factor(state.lubricant_kind, FZG_LUBRICANT_FACTOR)
        factor = kind if self.factor is None else self.factor
        return _spread(
            fernandes(
                *_of_mesh(state, self.name),
                state.needed("pressure_viscosity", self.name),
                state.pitch(self.name).face_width,
                factor=factor,
                ceiling=self.ceiling,
            ),
            state,
        )


_TABLE: dict[FrictionLaw, str] = {
    BenedictKelley(): "law for mixed lubrication, Benedict and Kelley 1961",
    ConstantDry(): "constant coefficient, `dry_coefficient`",
    Boundary(): "boundary lubrication, one constant",
    XuKahraman(): "elastohydrodynamic, local, Xu and Kahraman 2007",
    LambdaBlend(): "boundary and smooth film, weighted by the film (Doleschel)",
    Schlenk(): "mean of the mesh, ISO/TR 14179-2",
    Iso13989Flash(): "mean of the mesh, ISO/TR 13989-1",
    Iso13989Integral(): "mean of the mesh, ISO/TR 13989-2 = ISO/TR 15144-1",
    Fernandes(): "mean of the mesh, Fernandes 2016",
}

LAWS = {law.name: law for law in _TABLE}
"""Every law by its name, with the parameters of its source."""

MEANINGS = {law.name: words for law, words in _TABLE.items()}
"""What every law is, in words."""


def friction_law(name: str, **parameters: object) -> FrictionLaw:
    """The named law with its default parameters, or with other ``parameters``, by their names.

    Raises InputError for an unknown law or parameter, which says the nearest, and for a value out
    of range.

    >>> friction_law("boundary", coefficient=0.12)
    Boundary(coefficient=0.12)
    """
    if name not in LAWS:
        raise InputError("friction", repr(name), fix=nearest(name, LAWS))
    return with_parameters(LAWS[name], parameters)


def friction_words(law: FrictionLaw) -> str:
    """The law's name, and in brackets the parameters that are not its defaults.

    >>> friction_words(friction_law("boundary", coefficient=0.12))
    'boundary(coefficient=0.12)'
    """
    return law_words(law, LAWS.get(law.name))


@dataclass(frozen=True, eq=False)
class LawsTogether:
    """Laws side by side in one contact: ``names`` and, over (law, *shape of the contact),

    ``coefficient`` |mu| (nan where a law has no value for this oil or roughness) and ``outside``,
    true where the contact leaves the law's range; ``missing`` says why a law has no value, else "".
    """

    names: tuple[str, ...]
    coefficient: Floats
    outside: NDArray[np.bool_]
    missing: tuple[str, ...]

    def band(self) -> tuple[Floats, Floats]:
        """(least, greatest) |mu| of the laws within their range; nan where there is none."""
        valid = np.isfinite(self.coefficient) & ~self.outside
        some = valid.any(axis=0)
        least = np.min(self.coefficient, axis=0, where=valid, initial=np.inf)
        greatest = np.max(self.coefficient, axis=0, where=valid, initial=-np.inf)
        return np.where(some, least, np.nan), np.where(some, greatest, np.nan)


def laws_together(state: ContactState, laws: Sequence[FrictionLaw]) -> LawsTogether:
    """Every one of ``laws`` in ``state``; one that refuses it says why and is nan."""
    mu = np.full((len(laws), *state.shape), np.nan)
    outside = np.zeros(mu.shape, dtype=bool)
    missing = []
    for place, law in enumerate(laws):
        reason = ""
        try:
            mu[place] = law(state)
        except InputError as error:
            reason = str(error)
        missing.append(reason)
        outside[place] = outside_range(law, state)
    return LawsTogether(tuple(law.name for law in laws), mu, outside, tuple(missing))


LUBRICATED = tuple(law for name, law in LAWS.items() if name != ConstantDry.name)
"""The laws of an oiled contact, whose spread is the band about the chosen one."""
