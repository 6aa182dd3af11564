"""What a sensitivity study varies and what it watches: inputs with their ranges, outputs with what
is concluded from them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import KW_ONLY, dataclass, replace

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Floats
from thermogear.base.parameters import PARAMETERS, Parameter
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT
from thermogear.case.thesis_cases import of_the_thesis
from thermogear.heat.lubrication import kinematic_viscosity
from thermogear.mesh.operating import Operating


@dataclass(frozen=True)
class Input:
    """An input without a stated value: its ``name`` in the results, what it is, its range in SI.

    ``logarithmic``: all decades alike.
    """

    name: str
    parameter: Parameter
    _: KW_ONLY
    low: float
    high: float
    logarithmic: bool = False

    @property
    def unit(self) -> str:
        """The unit it is shown in."""
        return self.parameter.shown or "–"

    def values(self, unit_interval: Floats) -> Floats:
        """The range's values at places 0..1."""
        if self.logarithmic:
            return np.asarray(self.low * (self.high / self.low) ** unit_interval)
        return np.asarray(self.low + (self.high - self.low) * unit_interval)


INPUTS: tuple[Input, ...] = (
    Input("face_width", PARAMETERS["face_width"], low=0.015, high=0.040),
    Input("torque", PARAMETERS["pinion_torque"], low=50.0, high=200.0),
    Input("viscosity", PARAMETERS["oil_viscosity"], low=46e-6, high=320e-6, logarithmic=True),
    Input("roughness", PARAMETERS["roughness"], low=0.2e-6, high=0.8e-6),
    Input("backlash", PARAMETERS["cold_backlash"], low=0.20e-3, high=0.40e-3),
    Input("damping", PARAMETERS["damping_ratio"], low=0.03, high=0.17),
    Input("error", PARAMETERS["error_amplitude"], low=1e-6, high=10e-6),
    Input("gear", PARAMETERS["gear_temperature"], low=373.15, high=433.15),
    Input("housing", PARAMETERS["housing_below_gears"], low=0.0, high=60.0),
    Input("shaft", PARAMETERS["shafts_below_gears"], low=0.0, high=40.0),
    Input("oil", PARAMETERS["oil_below_gears"], low=0.0, high=60.0),
)
"""Every range is ours, as wide as rigs of this kind are; only the gear temperature's is stated."""
MOST_PARTS = 64
"""Parts of a series among which one is drawn: each asks for mesh cycles of its own (chosen)."""
PART = Input(
    "part",
    Parameter(name="part", words="part of the class, by its mean tooth"),
    low=0.0, high=float(MOST_PARTS),
)  # fmt: skip
"""Which part of a series the gears are: its drawing is the number without its fraction."""


@dataclass(frozen=True)
class Output:
    """A figure that a conclusion rests on, and when the conclusion ``holds`` for it."""

    name: str
    words: str
    unit: str
    conclusion: str
    holds: Callable[[Floats], NDArray[np.bool_]]
    scale: float = 1.0


OUTPUTS: tuple[Output, ...] = (
    Output("friction", "mean mixed friction coefficient", "–",
           "mixed friction stays below dry friction of 0.1", lambda y: y < 0.1),
    Output("flash", "highest flash temperature, mixed", "K",
           "the flash stays below 50 K", lambda y: y < 50.0),
    Output("dry_over_mixed", "highest flash, dry over mixed", "–",
           "mixed lubrication runs cooler than dry friction of 0.2", lambda y: y > 1.0),
    Output("growth", "mean growth of both flanks", "µm",
           "hot flanks grow", lambda y: y > 0.0, 1e6),
    Output("backlash_left", "hot over cold half backlash, consistent", "–",
           "heat reduces the backlash", lambda y: y < 1.0),
    Output("stiffness_change", "change of the mean stiffness, consistent", "%",
           "heat raises the mesh stiffness", lambda y: y > 0.0, 100.0),
    Output("stiffness_change_thesis", "change of the mean stiffness, thesis", "%",
           "heat raises the mesh stiffness", lambda y: y > 0.0, 100.0),
    Output("frequency_ratio", "mesh over natural frequency, hot", "–",
           "the tests lie below the range 1.1 to 1.3 of the diagrams", lambda y: y < 1.1),
    Output("swing", "swing of the displacement, hot", "µm",
           "the swing reaches the printed simulation's 2 x 15.9 µm", lambda y: y >= 31.8e-6, 1e6),
    Output("swing_change", "change of the swing by heat, consistent", "%",
           "heat raises the displacement", lambda y: y > 0.0, 100.0),
    Output("out_of_contact", "share of time out of drive contact, hot", "–",
           "the teeth lose contact", lambda y: y > 0.0),
)  # fmt: skip
"""What is watched; the conclusions are the thesis's, or what a reader would ask of it."""

OWN_CONCLUSIONS: dict[str, tuple[str, Callable[[Floats], NDArray[np.bool_]]]] = {
    "frequency_ratio": ("the mesh runs below its natural frequency", lambda y: y < 1.0),
    "swing": ("", lambda y: np.zeros(y.shape, bool)),
}
"""What is asked of gears of one's own where the thesis's conclusion speaks of its rig."""

TIMES = {
    "face_width": (0.6, 1.6), "torque": (0.5, 2.0), "viscosity": (0.46, 3.2),
    "roughness": (0.5, 2.0), "backlash": (0.8, 1.6), "error": (0.2, 2.0),
}  # fmt: skip
"""Ranges around the values of a case of one's own, as wide as those of the rig around its own."""
BESIDE_OWN = (40.0, 20.0)
"""How far below and above its own the gear temperature runs [K]."""


def inputs_of(case: GearCase) -> tuple[Input, ...]:
    """The inputs of a study of ``case``: the rig's ranges for the rig, else around its own values.

    A case without a kinematic error of its own has no such input; of a series the part is one.
    """
    if of_the_thesis(case):
        return INPUTS
    at, pair = state_of(case), case.pair
    tip = first(at.temperatures.pinion_addendum)
    harmonics = case.transmission_error.harmonics
    own = {
        "face_width": pair.face_width,
        "torque": float(case.torques[0]),
        "viscosity": float(kinematic_viscosity(at.lubricant, ZERO_CELSIUS + 40.0)),
        "roughness": 0.5 * (pair.pinion.roughness + pair.wheel.roughness),
        "backlash": 2.0 * at.half_backlash,
        "error": abs(harmonics[0]) if harmonics else 0.0,
    }
    below = {
        "housing": tip - first(at.temperatures.housing),
        "shaft": tip - first(at.temperatures.pinion_bore),
        "oil": tip - first(at.oil_temperature),
    }
    found = []
    for one in INPUTS:
        low, high = one.low, one.high
        if one.name in own:
            low, high = (own[one.name] * factor for factor in TIMES[one.name])
        elif one.name == "gear":
            low, high = tip - BESIDE_OWN[0], tip + BESIDE_OWN[1]
        elif one.name in below:
            low, high = min(low, 1.5 * below[one.name]), max(high, 1.5 * below[one.name])
        if low < high:
            found.append(replace(one, low=low, high=high))
    return (
        *found,
        *([replace(PART, high=float(min(case.series, MOST_PARTS)))] if case.series > 1 else ()),
    )


def outputs_of(case: GearCase) -> tuple[Output, ...]:
    """What a study of ``case`` watches; nothing of the thesis beside gears of one's own."""
    if of_the_thesis(case):
        return OUTPUTS
    found = []
    for one in OUTPUTS:
        if one.name != "stiffness_change_thesis":
            words, holds = OWN_CONCLUSIONS.get(one.name, (one.conclusion, one.holds))
            said = one.words.removesuffix(", consistent")
            found.append(replace(one, words=said, conclusion=words, holds=holds))
    return tuple(found)


def state_of(case: GearCase) -> Operating:
    """The hot state at the middle speed and the first torque."""
    place = len(case.speeds) // 2 * len(case.torques)
    HOT.require_settled(case, case.models[0], place)
    return case.operating.point(place)


def first(values: object) -> float:
    return float(np.ravel(np.asarray(values, dtype=float))[0])
