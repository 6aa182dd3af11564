"""Materials and lubricants: named sets, one source each."""

from __future__ import annotations

import difflib
import re
from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from thermogear.base import bounds
from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError, nearest, require_choice
from thermogear.base.units import ZERO_CELSIUS


class Row(NamedTuple):
    """One set as tables print it: GPa, -, kg/m^3, W/(m K), J/(kg K), 1e-6/K, 1e-4/K, C."""

    modulus: float
    poisson: float
    density: float
    conductivity: float
    heat: float
    expansion: float
    slope: float
    tempered: float | None
    source: str


_HOT_MODULUS = "; its modulus falls when hot, which is left out"
_CASE_HARDENED = "; tempered at 180 C as usual for case-hardening"
_MANGANESE_CHROME = Row(
    212, 0.28, 7850, 45.9, 461, 11.5, 2.9, 180,
    "supplier's sheet of 20MnCr5, slope from 207 GPa at 100 C" + _CASE_HARDENED,
)  # fmt: skip
TABLE: dict[str, Row] = {
    "16MnCr5": _MANGANESE_CHROME,
    "20MnCr5": _MANGANESE_CHROME,
    "18CrNiMo7-6": Row(
        208, 0.30, 7830, 39, 460, 11.8, 3.3, 180,
        "usual, unconfirmed; slope of carbon steel" + _CASE_HARDENED,
    ),
    "42CrMo4": Row(
        206, 0.30, 7840, 42.6, 470, 12.3, 3.3, 540,
        "suppliers' sheets, specific heat usual and unconfirmed; slope of carbon steel; quenched "
        "and tempered at 540 C or more",
    ),
    "AISI 9310": Row(
        200, 0.29, 7850, 51.9, 472, 11.5, 3.3, 150,
        "MatWeb sheet of E9310, mock carburized, tempered at 150 C (its thermal values are "
        "estimates for steel); slope of carbon steel",
    ),
    "PA66": Row(
        1.85, 0.35, 1140, 0.26, 1670, 80, 0, None,
        "GEARpie material library, conditioned (3.2 GPa dry); Poisson's ratio and expansion usual, "
        "unconfirmed; its modulus falls when hot, which is left out",
    ),
    "POM": Row(
        3.2, 0.35, 1415, 0.30, 1465, 110, 88, None,
        "GEARpie material library; usual, unconfirmed: slope through 2.0 GPa at 60 C and 1.0 GPa "
        "at 100 C within 6 %",
    ),
    "PEEK": Row(
        3.7, 0.40, 1300, 0.27, 1340, 50, 0, None,
        "usual, unconfirmed; its modulus falls above 140 C, which is left out",
    ),
    "EN-GJL-200": Row(
        100, 0.26, 7150, 50, 460, 11.7, 0, None,
        "EN 1561, values for information, usual and unconfirmed: as EN-GJL-250, modulus 88 to "
        "113 GPa" + _HOT_MODULUS,
    ),
    "EN-GJL-250": Row(
        110, 0.26, 7200, 48.5, 460, 11.7, 0, None,
        "EN 1561, values for information, usual and unconfirmed: modulus 103 to 118 GPa, "
        "conductivity at 100 C, expansion and specific heat 20 to 200 C (other sheets have an "
        "expansion of 10.5 to 11)" + _HOT_MODULUS,
    ),
    "EN-GJS-400-15": Row(
        169, 0.275, 7100, 36.2, 461, 11.5, 0, None,
        "EN 1563, values for information: modulus and density read in a foundry's table, the rest "
        "usual, unconfirmed: conductivity at 300 C; expansion 20 to 100 C and specific heat at "
        "20 C as a public code has them (10.8 elsewhere, 12.5 from 20 to 400 C)" + _HOT_MODULUS,
    ),
    "EN-GJS-500-7": Row(
        169, 0.275, 7100, 35.2, 461, 11.5, 0, None,
        "EN 1563, values for information: modulus, density and conductivity at 300 C read in a "
        "foundry's table, the rest as EN-GJS-400-15" + _HOT_MODULUS,
    ),
    "AlSi9Cu3": Row(
        71, 0.33, 2750, 110, 963, 21.1, 0, None,
        "MatWeb and NADCA sheets of A380, the same kind of die-casting alloy, density of EN 1706; "
        "expansion 20 to 100 C, conductivity 96 to 120 by sheet" + _HOT_MODULUS,
    ),
    "AlSi10Mg": Row(
        72, 0.33, 2630, 140, 900, 21.0, 0, None,
        "MakeItFrom sheet of EN AC-43400, density and expansion of A360 by NADCA (22 there); "
        "conductivity 113 to 140 by sheet" + _HOT_MODULUS,
    ),
    "AZ91D": Row(
        45, 0.35, 1810, 72, 1050, 26, 0, None,
        "die caster's sheet of AZ91D and AZoM, expansion 20 to 100 C; Poisson's ratio usual, "
        "unconfirmed (0.29 to 0.35)" + _HOT_MODULUS,
    ),
}  # fmt: skip

ALSO = {
    **dict.fromkeys(("aluminium", "aluminum", "alsi9cu3fe", "46000", "a380"), "AlSi9Cu3"),
    **dict.fromkeys(("alsi10mgfe", "43400", "a360"), "AlSi10Mg"),
    **dict.fromkeys(
        ("greyiron", "grayiron", "greycastiron", "graycastiron", "castiron", "gg25"), "EN-GJL-250"
    ),
    **dict.fromkeys(
        ("ductileiron", "nodulariron", "ductilecastiron", "gjs400", "ggg40"), "EN-GJS-400-15"
    ),
    **dict.fromkeys(("gjs500", "ggg50"), "EN-GJS-500-7"),
    **dict.fromkeys(("magnesium", "az91"), "AZ91D"),
}
"""Further names of a set, in small letters and figures alone, without a standard's EN or EN AC."""


NEVER = 1e9
"""A tempering temperature [K] that nothing reaches."""
DATA_HOLD = ZERO_CELSIUS + 204.0
"""Up to where the fit of :class:`Material` to the modulus of carbon steel holds [K]; taken for all
materials that have no limit of their own (ours)."""


@dataclass(frozen=True, kw_only=True)
class Material:
    """An isotropic gear material (SI, at 20 C).

    E(T) = E20 [1 - ``modulus_slope`` (T - 293.15 K)]; the slope's source for carbon steel is
    the fit to Roark's table (202.0 .. 182.7 GPa at 21 .. 316 C), valid 21..204 C.

    >>> steel = material("steel")
    >>> f"{steel.thermal_expansion * 1e6:.1f} um/(m K)"
    '11.5 um/(m K)'
    """

    name: str
    youngs_modulus: float
    poisson_ratio: float
    density: float
    thermal_conductivity: float
    specific_heat: float
    thermal_expansion: float
    modulus_slope: float = 0.0
    tempering_temperature: float = NEVER
    source: str = "given by the user"

    def __post_init__(self) -> None:
        for field, allowed in (
            ("youngs_modulus", bounds.YOUNGS_MODULUS),
            ("density", bounds.DENSITY),
            ("thermal_conductivity", bounds.CONDUCTIVITY),
            ("specific_heat", bounds.SPECIFIC_HEAT),
            ("thermal_expansion", bounds.EXPANSION),
            ("modulus_slope", bounds.MODULUS_SLOPE),
        ):
            allowed.require(f"material.{field}", getattr(self, field))
        if self.tempering_temperature != NEVER:
            bounds.TEMPERING.require("material.tempering_temperature", self.tempering_temperature)
        if not 0.0 <= self.poisson_ratio < 0.5:
            raise InputError("material.poisson_ratio", self.poisson_ratio, allowed="0 <= nu < 0.5")

    def youngs_modulus_at(self, temperature: ArrayLike) -> Floats:
        """E(T) [Pa] at ``temperature`` [K], any shape; InputError where nothing is left of it."""
        rise = np.asarray(temperature, dtype=float) - (ZERO_CELSIUS + 20.0)
        found = np.asarray(self.youngs_modulus * (1.0 - self.modulus_slope * rise))
        if np.any(found <= 0.0):
            hottest = float(np.max(rise)) + 20.0
            raise InputError(
                f"temperature of {self.name}",
                f"{hottest:.6g} degC",
                allowed=f"< {20.0 + 1.0 / self.modulus_slope:.4g} degC",
                why="its modulus falls to nothing there",
            )
        return found

    @property
    def bears(self) -> tuple[float, str]:
        """Temperature [K] up to which something may be said of it, and what ends there, in words.

        The short-time limit of a polymer, the tempering of a steel; where no source has either,
        :data:`DATA_HOLD`.
        """
        if self.name in POLYMER_LIMITS:
            return POLYMER_LIMITS[self.name][1], "a gear bears no more for a short time"
        if self.tempering_temperature < NEVER:
            return self.tempering_temperature, "a gear was tempered there"
        return DATA_HOLD, "the data of a gear's material hold no further"

    @property
    def thermal_contact_coefficient(self) -> float:
        """sqrt(k rho c) [J/(m^2 K s^0.5)]."""
        return float(np.sqrt(self.thermal_conductivity * self.density * self.specific_heat))


LUBRICANT_KINDS: dict[str, str] = {
    "mineral": "mineral base oil",
    "pao": "polyalphaolefin",
    "ester": "synthetic ester",
    "pag": "polyalkylene glycol",
}
"""Base oil families: what pressure-viscosity and lubricant factors are tabulated by."""

NO_BATH = ZERO_CELSIUS + 150.0
"""Temperature [K] above which no oil bath is kept whose flash point is not known (ours: flash
points of gear oils are 180 to 260 C, and oil that hot lasts days)."""

_WALTHER_SHIFT = 0.7  # mm^2/s, ASTM D341 above 2 mm^2/s (DIN 51563 prints 0.8)


@dataclass(frozen=True, kw_only=True)
class Lubricant:
    """An oil by its Walther line (ASTM D341): log10 log10(nu + 0.7) = A - B log10 T.

    nu in mm^2/s, T in K. Density rho(T) = ``density_15`` - ``density_slope`` (T - 288.15 K),
    kg/m^3 (form of ISO/TR 15144-1 eq. 20, whose slope is 0.7 kg/(m^3 K)). ``kind`` is one of
    :data:`LUBRICANT_KINDS`. ``thermal_conductivity`` [W/(m K)] and ``specific_heat``
    [J/(kg K)] are taken constant. ``temperature_range`` [K] is where the line is trusted;
    outside it the viscosity functions warn; ``flash_point`` [K], None where it is not known.
    ``walther_a``, ``walther_b`` and ``density_15`` may be
    arrays, one entry for each operating point: oils side by side.

    >>> oil = Lubricant.from_two_points("oil", (313.15, 100e-6), (373.15, 11e-6))
    >>> f"{oil.walther_a:.2f}, {oil.walther_b:.2f}"
    '9.25, 3.59'
    """

    name: str
    kind: str
    walther_a: float | Floats
    walther_b: float | Floats
    density_15: float | Floats
    source: str = "given by the user"
    density_slope: float = 0.7
    thermal_conductivity: float = 0.135
    specific_heat: float = 2000.0
    temperature_range: tuple[float, float] = (ZERO_CELSIUS - 20.0, ZERO_CELSIUS + 150.0)
    flash_point: float | None = None

    @property
    def hottest_bath(self) -> float:
        """Temperature [K] above which no bath of it is kept: its flash point, else NO_BATH."""
        return self.flash_point or NO_BATH

    def __post_init__(self) -> None:
        require_choice("lubricant.kind", self.kind, LUBRICANT_KINDS)
        for field in (
            "walther_a",
            "walther_b",
            "thermal_conductivity",
            "specific_heat",
        ):
            value = getattr(self, field)
            if not np.all(np.isfinite(value) & (np.asarray(value) > 0.0)):
                raise InputError(f"lubricant.{field}", value, allowed="> 0, finite")
        if not (np.isfinite(self.density_slope) and self.density_slope >= 0.0):
            raise InputError(
                "lubricant.density_slope", self.density_slope, allowed=">= 0 kg/(m^3 K)"
            )
        bounds.OIL_DENSITY.require("lubricant.density_15", self.density_15)
        low, high = self.temperature_range
        if not 0.0 < low < high:
            raise InputError(
                "lubricant.temperature_range",
                f"{low} .. {high} K",
                allowed="0 K < lower < upper",
            )

    def part(self, places: Any) -> Lubricant:
        """The oils of some operating points; an index with a new axis shapes them otherwise."""
        lines = {n: getattr(self, n) for n in ("walther_a", "walther_b", "density_15")}
        several = {n: line[places] for n, line in lines.items() if np.ndim(line)}
        return replace(self, **several) if several else self

    @classmethod
    def from_two_points(
        cls,
        name: str,
        point_1: tuple[float, float],
        point_2: tuple[float, float],
        *,
        kind: str = "mineral",
        density_15: float | None = None,
        source: str = "two viscosities of a data sheet",
    ) -> Lubricant:
        """The oil through two points (temperature [K], kinematic viscosity [m^2/s]).

        ``density_15`` [kg/m^3] defaults to 43.37 log10(nu40) + 805.5, nu40 in mm^2/s
        (ISO/TR 15144-1 eq. 21, for want of a measured one). Raises when the points are not
        two, or the viscosity does not fall from the colder to the hotter.
        """
        (cold, thick), (hot, thin) = sorted([point_1, point_2])
        bounds.BODY.require("lubricant.temperatures", [cold, hot])
        bounds.VISCOSITY.require("lubricant.viscosities", [thick, thin])
        if not cold < hot:
            raise InputError(
                "lubricant.temperatures",
                f"{cold} and {hot} K",
                allowed="two different temperatures",
                fix="give the viscosities at 313.15 K and 373.15 K (40 and 100 C)",
            )
        if not thin < thick:
            raise InputError(
                "lubricant.viscosities",
                f"{thick * 1e6:g} mm^2/s at {cold} K and {thin * 1e6:g} mm^2/s at {hot} K",
                allowed="falling with temperature",
            )
        ordinates = np.log10(np.log10(np.array([thick, thin]) * 1e6 + _WALTHER_SHIFT))
        abscissae = np.log10([cold, hot])
        slope = float((ordinates[0] - ordinates[1]) / (abscissae[1] - abscissae[0]))
        intercept = float(ordinates[0] + slope * abscissae[0])
        if density_15 is None:
            at_40 = 10.0 ** (10.0 ** (intercept - slope * np.log10(ZERO_CELSIUS + 40.0)))
            density_15 = float(43.37 * np.log10(at_40 - _WALTHER_SHIFT) + 805.5)
        return cls(
            name=name,
            kind=kind,
            walther_a=intercept,
            walther_b=slope,
            density_15=density_15,
            source=source,
        )


MATERIALS: dict[str, Material] = {
    "steel": Material(
        name="steel",
        youngs_modulus=206e9,
        poisson_ratio=0.3,
        density=7850.0,
        thermal_conductivity=46.0,
        specific_heat=470.0,
        thermal_expansion=11.5e-6,
        modulus_slope=3.3e-4,
        tempering_temperature=ZERO_CELSIUS + 180.0,
        source="case-hardening gear steel, handbook values; E(T) slope fitted to Roark's table",
    ),
}
MATERIALS |= {
    name: Material(
        name=name,
        youngs_modulus=row.modulus * 1e9,
        poisson_ratio=row.poisson,
        density=row.density,
        thermal_conductivity=row.conductivity,
        specific_heat=row.heat,
        thermal_expansion=row.expansion * 1e-6,
        modulus_slope=row.slope * 1e-4,
        tempering_temperature=NEVER if row.tempered is None else ZERO_CELSIUS + row.tempered,
        source=row.source,
    )
    for name, row in TABLE.items()
}

POLYMER_LIMITS: dict[str, tuple[float, float]] = {
    "PA66": (ZERO_CELSIUS + 100.0, ZERO_CELSIUS + 160.0),
    "POM": (ZERO_CELSIUS + 100.0, ZERO_CELSIUS + 140.0),
    "PEEK": (ZERO_CELSIUS + 250.0, ZERO_CELSIUS + 250.0),
}
"""Tooth temperatures [K] a polymer bears lastingly and for a short time: usual, unconfirmed.
Creep of PA66 and POM begins at 60 to 80 C."""


def material(name: str) -> Material:
    """The named set as :func:`spelled` finds it, or an error that says the nearest name.

    >>> f"{1e-9 * material('steel').youngs_modulus:.0f} GPa"
    '206 GPa'
    """
    known = spelled(name, MATERIALS)
    if known is None:
        raise InputError("material", repr(name), fix=nearest(name, MATERIALS))
    return MATERIALS[known]


def spelled(name: str, known: Collection[str]) -> str | None:
    """The name among ``known`` that ``name`` means, None where none is meant.

    Itself first; else capitals, blanks, signs and the EN or EN AC of a standard do not count, and
    usual names are known.

    >>> spelled("grey iron", MATERIALS), spelled("en ac-alsi9cu3", MATERIALS)
    ('EN-GJL-250', 'AlSi9Cu3')
    """

    def bare(text: str) -> str:
        return re.sub("^en(ac)?", "", re.sub("[^a-z0-9]", "", text.lower()))

    if name in known:
        return name
    return {bare(one): one for one in known}.get(bare(name), ALSO.get(bare(name)))


_PUBLIC_SET = (
    "GEARpie lubricant library (C. Fernandes, University of Porto); density at 15 C and its "
    "expansion from the same set, conductivity from its formula at 60 C"
)


def _graded(prefix: str, kind: str, lines: dict[int, tuple[float, float]]) -> dict[str, Lubricant]:
    """One family of ISO VG grades: density, its slope, conductivity and heat are shared."""
    density, expansion, conductivity = {
        "mineral": (902.0, 5.8e-4, 0.135),
        "pao": (859.0, 5.5e-4, 0.142),
    }[kind]
    return {
        f"{prefix}{grade}": Lubricant(
            name=f"{prefix}{grade}",
            kind=kind,
            walther_a=a,
            walther_b=b,
            density_15=density,
            source=_PUBLIC_SET,
            density_slope=density * expansion,
            thermal_conductivity=conductivity,
            specific_heat=2306.93,
        )
        for grade, (a, b) in lines.items()
    }


_PUBLIC_MINERAL = _graded(
    "M",
    "mineral",
    {
        32: (9.5259, 3.7449),
        46: (9.7044, 3.7995),
        68: (9.4422, 3.6778),
        100: (9.2479, 3.5849),
        150: (9.0379, 3.4861),
        220: (8.8178, 3.3852),
        320: (9.0658, 3.4730),
    },
)
PUBLIC_MINERAL = tuple(_PUBLIC_MINERAL)
"""Names of the mineral oils of one public set."""

_SHEETS = "usual data sheet as a public gear code holds it: grade at 40 C, viscosity at 100 C"

LUBRICANTS: dict[str, Lubricant] = {
    **_PUBLIC_MINERAL,
    "M460": Lubricant.from_two_points(
        "M460",
        (ZERO_CELSIUS + 40.0, 460e-6),
        (ZERO_CELSIUS + 100.0, 30.6e-6),
        density_15=900.0,
        source=_SHEETS,
    ),
    **_graded(
        "P",
        "pao",
        {
            68: (7.9787, 3.0914),
            100: (7.8091, 3.0083),
            150: (7.646383, 2.928541),
            220: (7.4846, 2.8510),
            320: (7.3514, 2.7865),
        },
    ),
    "G220": Lubricant.from_two_points(
        "G220",
        (ZERO_CELSIUS + 40.0, 220e-6),
        (ZERO_CELSIUS + 100.0, 34.4e-6),
        kind="pag",
        density_15=1074.0,
        source=_SHEETS,
    ),
    "FVA3": Lubricant(
        name="FVA3",
        kind="mineral",
        walther_a=9.2384,
        walther_b=3.5810,
        density_15=892.1,
        source=(
            "reference mineral oil, ISO VG 100, Walther line of the public FZG calculations; "
            "density from its viscosity at 40 C by ISO/TR 15144-1 eq. 21"
        ),
    ),
    # the Walther line through the two limits of SAE J306 that define the grade: 150 000 mPa s at
    # -40 C (75W, its greatest) and the middle of 13.5 .. 18.5 mm^2/s at 100 C (90). Not one
    # maker's oil: for that, take the two viscosities of its data sheet
    "75W90": Lubricant.from_two_points(
        "75W90",
        (ZERO_CELSIUS - 40.0, 150.0 / 900.0),
        (ZERO_CELSIUS + 100.0, 16e-6),
        kind="pao",
        source="representative of the grade from the limits of SAE J306; density by viscosity",
    ),
}


_ISO_GRADE = re.compile(r"(?:iso[\s-]*)?vg[\s-]*(\d+)", re.IGNORECASE)


def lubricant(name: str) -> Lubricant:
    """The named oil, or an error that says the nearest name.

    An ISO viscosity grade alone, "ISO VG 100" or "VG 100", is the mineral oil of that grade.

    >>> lubricant("FVA3").kind
    'mineral'
    """
    grade = _ISO_GRADE.fullmatch(name.strip())
    known = f"M{grade[1]}" if grade else name
    if known in LUBRICANTS:
        return LUBRICANTS[known]
    raise InputError("lubricant", repr(name), fix=_advice(name, bool(grade)))


def _advice(name: str, mineral: bool) -> str:
    """The nearest oil, its kind said; all grades of the kind where there is none of that number."""
    plain = re.sub(r"[\s-]", "", name).upper()
    number = plain[len(plain.rstrip("0123456789")) :]
    family = [n for n in LUBRICANTS if n[0] == ("M" if mineral else plain[:1]) and n[1:].isdigit()]
    if family and (mineral or plain[1:] == number) and plain not in family:
        return f"grades of {LUBRICANT_KINDS[LUBRICANTS[family[0]].kind]}: {', '.join(family)}"
    close = [plain] if plain in family else [n for n in LUBRICANTS if number and n[1:] == number]
    close = close or difflib.get_close_matches(plain, LUBRICANTS, n=1, cutoff=0.5)
    if close:
        oils = [f"{n!r} ({LUBRICANT_KINDS[LUBRICANTS[n].kind]})" for n in close]
        return f"did you mean {' or '.join(oils)}?"
    return "known: " + ", ".join(LUBRICANTS)
