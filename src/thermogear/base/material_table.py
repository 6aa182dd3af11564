"""Gear steels and polymers at 20 C, as tables print them."""

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
}  # fmt: skip
