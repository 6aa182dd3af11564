"""Between SI and the units people read; inside the floors numbers are SI."""

from __future__ import annotations

import math
from decimal import Decimal

RPM = math.pi / 30.0
"""One revolution per minute [rad/s]: ``rpm * RPM`` is SI, ``speed / RPM`` is in rpm."""

ZERO_CELSIUS = 273.15
"""0 degC [K]."""

STANDARD_GRAVITY = 9.80665
"""The g of accelerations [m/s^2] (CGPM 1901)."""

ROUNDED = 0.01
"""Modules that a fillet or the end of a chart may miss an exact length by, however few its digits:
as much as a profile shift given to a hundredth leaves open (ours)."""


def half_digit(number: str) -> float:
    """Half a unit of the last digit of a decimal ``number``.

    >>> half_digit("91.50"), half_digit("2e3")
    (0.005, 500.0)
    """
    return 0.5 * 10.0 ** min(int(Decimal(number).as_tuple().exponent), 300)
