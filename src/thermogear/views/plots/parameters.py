"""How the parameters of diagrams, maps, sweeps and branches are named and shown."""

from __future__ import annotations

import numpy as np
from markupsafe import Markup
from numpy.typing import ArrayLike, NDArray

from thermogear.base.display import CELSIUS, MICROMETRE, Display, display
from thermogear.views.typesetting import math_symbol, prose

NUMBER = Display(unit="")
TURNS = display("pinion_speed")
PARAMETERS = {
    "damping_ratio": ("damping ratio ζ", NUMBER),
    "frequency": ("frequency ratio ω_h", NUMBER),
    "stiffness_amplitude": ("stiffness amplitude ε", NUMBER),
    "mean_force": ("mean force F_m", NUMBER),
    "force_amplitude": ("force amplitude F_h", NUMBER),
    "half_backlash": ("half backlash b′", NUMBER),
    "thermal_stiffness": ("thermal stiffness ε_T", NUMBER),
    "pinion_speed": ("pinion speed [rpm]", TURNS),
    "speed": ("pinion speed [rpm]", TURNS),
    "pinion_torque": ("pinion torque [N m]", NUMBER),
    "torque": ("pinion torque [N m]", NUMBER),
    "gear_temperature": ("gear temperature [°C]", CELSIUS),
    "temperature": ("addendum temperature [°C]", CELSIUS),
    "cold_half_backlash": ("cold half backlash [µm]", MICROMETRE),
}
"""Words of a parameter's axis, and how its SI value is shown."""


def shown(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Values of a parameter in the unit its axis shows."""
    return PARAMETERS.get(name, ("", NUMBER))[1](values)


def axis_words(name: str, unit: str = "1") -> str:
    """The label of a parameter's axis in a picture, with its ``unit`` as stored if it says none."""
    words = math_symbol(_words(name))
    return words if "[" in words else f"{words} [{'–' if unit == '1' else unit}]"


def page_words(name: str) -> Markup:
    """The heading of a parameter's column on a page."""
    return prose(_words(name))


def _words(name: str) -> str:
    return PARAMETERS[name][0] if name in PARAMETERS else name.replace("_", " ")
