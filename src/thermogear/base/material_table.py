"""Gear steels, polymers and casting metals at 20 C, as tables print them."""

from __future__ import annotations

from typing import NamedTuple


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
