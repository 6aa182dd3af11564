"""Between SI and the units people read; inside the floors numbers are SI."""

from __future__ import annotations

import math

RPM = math.pi / 30.0
"""One revolution per minute [rad/s]: ``rpm * RPM`` is SI, ``speed / RPM`` is in rpm."""

ZERO_CELSIUS = 273.15
"""0 degC [K]."""

STANDARD_GRAVITY = 9.80665
"""The g of accelerations [m/s^2] (CGPM 1901)."""
