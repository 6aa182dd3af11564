"""Thresholds of verdicts: what a number is held against, and where that comes from."""

from __future__ import annotations

import math
from dataclasses import KW_ONLY, dataclass

from thermogear.base.materials import POLYMER_LIMITS
from thermogear.base.units import ZERO_CELSIUS

FINE, LOOK, OPEN = "fine", "look here", "not decided"
"""What an answer may come to."""


@dataclass(frozen=True)
class Limit:
    """A bound that a value keeps: ``least`` or ``most`` in ``unit`` as shown.

    ``what`` is held against it, in words, where that is not the figure of the sentence itself.

    ``confirmed`` False: the source is recalled, not read; a verdict then calls the limit usual.
    A ``source`` that begins with "ours" is a choice of this program; a verdict says that too.
    """

    unit: str
    _: KW_ONLY
    what: str = ""
    least: float = -math.inf
    most: float = math.inf
    source: str
    confirmed: bool = True

    def verdict(self, value: float) -> str:
        """Fine within the bound, look here outside; not decided without a value or a bound."""
        bounded = math.isfinite(self.least) or math.isfinite(self.most)
        if not (bounded and math.isfinite(value)):
            return OPEN
        return FINE if self.least <= value <= self.most else LOOK

    @property
    def words(self) -> str:
        """The bound as a reader sees it, called usual where it is unconfirmed, or ours."""
        return self.beside(math.nan)

    def beside(self, value: float) -> str:
        """:attr:`words`, with the ``value`` where it is within 2 % of the bound, 0.05 of a bound 0.

        As many digits of both as tell them apart: a sentence may round the difference away.
        """
        if not math.isfinite(self.least) and not math.isfinite(self.most):
            return "no limit known"
        side, bound = (
            ("at least", self.least) if math.isfinite(self.least) else ("at most", self.most)
        )
        unit = f" {self.unit}" if self.unit else ""
        what = f"{self.what} " if self.what else ""
        whose = ", ours" if self.source.startswith("ours") else ""
        close = abs(value - bound) <= (0.02 * abs(bound) or 0.05)
        digits, near = 4, close and value != bound
        while near and f"{value:.{digits}g}" == f"{bound:.{digits}g}":
            digits += 1
        here = f", here {value:.{digits}g}{unit}" * near
        usual = "" if self.confirmed else ", usual"
        return f"{what}{side} {bound:.{digits}g}{unit}{whose}{usual}{here}"


PARTING = 2.0
"""Greatest mesh force over its mean [-] beyond which flanks are taken to part: a harmonic force
about its mean that reaches twice the mean reaches zero half a period later. Ours: no standard
bounds the dynamic factor itself."""
LOAD_SHARE = 3.0 / 7.0
"""Of the deflection w/c' of one tooth pair what is gone where two carry, 1 - c'/c_gamma with
c_gamma = c' (0.75 eps + 0.25) of ISO 6336-1 at eps = 2: the load's share of the static error."""

LIMITS: dict[str, Limit] = {
    "contact_ratio": Limit("", least=1.2, source="public gear code; 1.0 is where contact breaks"),
    "form_clearance": Limit(
        "µm", least=0.0, source="ISO 21771-1: the other tip stays on the involute"
    ),
    "tip_thickness": Limit(
        "modules", least=0.2, source="public gear code; 0.4 for case-hardened", confirmed=True
    ),
    "tip_clearance": Limit(
        "modules", least=0.12, source="half of the 0.25 of ISO 53", confirmed=False
    ),
    "oil_mineral": Limit("°C", most=90.0, source="sump of mineral oil", confirmed=False),
    "oil_pao": Limit("°C", most=105.0, source="sump of polyalphaolefin", confirmed=False),
    "oil_ester": Limit("°C", most=105.0, source="sump of ester, as of PAO", confirmed=False),
    "oil_pag": Limit("°C", most=110.0, source="sump of polyalkylene glycol", confirmed=False),
    "teeth_steel": Limit(
        "°C", most=150.0, source="stress relief of carburised steel, 150 to 200", confirmed=False
    ),
    "teeth_tempered": Limit(
        "°C", most=400.0, source="50 K and more below tempering of 42CrMo4", confirmed=False
    ),
    **{
        f"teeth_{name}": Limit(
            "°C",
            most=lasting - ZERO_CELSIUS,
            source=f"lasting temperature of {name}",
            confirmed=False,
        )
        for name, (lasting, _) in POLYMER_LIMITS.items()
    },
    "backlash": Limit("µm", least=0.0, source="a pair without backlash jams"),
    "jam_margin": Limit(
        "K", what="margin", least=30.0, source="ours: as much as a heat balance may be off"
    ),
    "film": Limit(
        "", least=1.0, source="boundary lubrication below (others: 0.4 and 0.7)", confirmed=False
    ),
    "scuffing_margin": Limit(
        "K", what="margin", least=50.0, source="ISO/TR 13989-1, ISO/TS 6336-20"
    ),
    "scuffing_safety": Limit(
        "", what="safety", least=2.0, source="ISO/TR 13989-2, ISO/TS 6336-21: low risk"
    ),
    "effective_contact_ratio": Limit(
        "", least=1.2, source="that of the contact ratio, held by what carries"
    ),
    "edge_contact": Limit(
        "%",
        what="load on a tip corner",
        most=0.0,
        source="ours: a corner has no Hertzian contact, it digs in and settles; tip relief keeps "
        "it free",
    ),
    "resonance": Limit(
        "%",
        what="own speeds off it by",
        least=15.0,
        source="ISO 6336-1: main resonance at 0.85 to 1.15 of it; ours: the same about every "
        "speed with a dynamic factor above 2",
    ),
    "contact_loss": Limit("%", what="own speeds in it", most=0.0, source="flanks that part hammer"),
    "parting_pairs": Limit(
        "%",
        what="pairs in which it happens",
        most=10.0,
        source="ours: nine of ten pairs run without it up to the greatest own speed",
    ),
    "back_contact": Limit(
        "%", what="own speeds in it", most=0.0, source="a tooth that hits the back side rattles"
    ),
    "coexisting": Limit(
        "",
        what="motions at own speeds",
        most=1.0,
        source="one steady motion: no jump, no hysteresis",
    ),
    "dynamic_factor": Limit(
        "", most=1.0, source="ISO 6336-1 method B: what the load rating counts with"
    ),
    "parting": Limit(
        "",
        most=PARTING,
        source="ours: a harmonic force of twice its mean falls to zero in between, and flanks part",
    ),
    "transmission_error": Limit(
        "µm",
        most=0.0,
        source="ours: f_Hα + f_fα of the class by ISO 1328-1, both gears', are what manufacture "
        "allows; the load adds 0.43 w/c', the step from one tooth pair to two",
    ),
    **{
        f"root_{name}": Limit(
            "MPa",
            most=850.0 / 1.4,
            source="ISO 6336-5: 2 x 425 MPa, case-hardened, quality MQ, over a usual safety of 1.4",
            confirmed=False,
        )
        for name in ("16MnCr5", "20MnCr5", "18CrNiMo7-6", "AISI 9310")
    },
    "critical_speed": Limit(
        "%",
        what="own speeds off it by",
        least=15.0,
        source="the margin of ISO 6336-1 for the main resonance, taken over",
        confirmed=False,
    ),
    "bearing_safety": Limit(
        "", what="safety", least=1.5, source="C0/P0 of 1 to 2 is usual", confirmed=False
    ),
    "bearing_clearance": Limit(
        "µm", least=0.0, source="a hot bearing without play is preloaded; aim at 0 to 10 µm"
    ),
    "tilt": Limit(
        "",
        what="of the teeth's deflection",
        most=0.5,
        source="ours: beyond it the load leans to one end",
    ),
    "relief": Limit(
        "%", what="gain", most=30.0, source="ours: a relief that takes more is worth cutting"
    ),
}
"""Every threshold of a verdict, by the name of its answer."""

NO_LIMIT = {
    "teeth_unknown": Limit("°C", source="no limit is known for a material that is no steel"),
    "root_unknown": Limit("MPa", source="no fatigue strength is known of the material"),
}
"""Of answers whose material has no bound in the table."""


VIBRATION_ZONES: dict[str, tuple[float, float, float]] = {
    "large rigid": (2.3e-3, 4.5e-3, 7.1e-3),
    "large flexible": (3.5e-3, 7.1e-3, 11.0e-3),
    "medium rigid": (1.4e-3, 2.8e-3, 4.5e-3),
    "medium flexible": (2.3e-3, 4.5e-3, 7.1e-3),
}
"""Bounds A/B, B/C, C/D of the velocity's rms [m/s] on a bearing housing after ISO 10816-3, as two
public programs have them (phonometry; predictive-maintenance-mcp); the standard itself was not
read. Large: above 300 kW, medium: 15 to 300 kW; rigid: the support's lowest natural frequency is
1.25 times the excitation's or more. ISO 20816-3:2022 has one zone in place of A and B."""


def zone_of(velocity: float, machine: str) -> str:
    """Zone A (new) to D (damage) of a ``velocity`` [m/s, rms 10 .. 1000 Hz] of a class of machine
    in :data:`VIBRATION_ZONES`; "" where the velocity is not known.

    >>> zone_of(3e-3, "medium rigid"), zone_of(math.nan, "medium rigid")
    ('C', '')
    """
    if not math.isfinite(velocity):
        return ""
    return "ABCD"[sum(velocity > bound for bound in VIBRATION_ZONES[machine])]
