"""Random drive trains in motion, each by its number alone: case files as people write them.

Teeth, module, load from light to full, speed around the resonance of the teeth, backlash, run-out
of the teeth, linear, ring and rolling bearings with their clearances, hot or undeformed, and usual
damping. A case that is refused is drawn anew from the same numbers.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from thermogear.base.errors import ThermogearError
from thermogear.case.case import GearCase, gear_case, load_case
from thermogear.case.thermal_state import HOT, UNDEFORMED
from thermogear.shafts.reduction import interface_of
from thermogear.study.shafts.moving import MovingTrain, moving, rubbing
from thermogear.study.shafts.state import TrainState, settled

Floats = NDArray[np.float64]
Random = np.random.Generator

SEED = 16_2026
MODULES = (2.0, 2.5, 3.0, 4.0, 5.0)
"""[mm]"""
UNIT_LOAD = (0.3, 15.0)
"""Tangential force over face width and module [N/mm^2], from light to full, by its logarithm."""
ERRORS = (0.3, 8.0)
"""Amplitude of the unloaded error at mesh order [um], by its logarithm."""
RATIO = (0.3, 2.3)
"""Mesh frequency over that of the mode with most of the teeth's energy, by its logarithm."""
TYPES = {
    20: ("6204", "NU204E"),
    25: ("6205", "6305"),
    30: ("6206", "6306", "NU206E", "NU2206E"),
    40: ("6208", "6308"),
}
"""Shafts [mm] and the rolling bearings that fit them."""
ROUGH = "\n[grid]\nmesh_positions = 48\npath_positions = 51\nharmonics = 8\n"
"""Enough to know where the teeth's resonance is."""
FINE = "\n[grid]\nmesh_positions = 120\npath_positions = 101\nharmonics = 16\n"
IN_TURN = 0.08
"""Share of trains with forces at shaft orders: unbalance and eccentric teeth."""
MOST_TRIES = 50


@dataclass(frozen=True, eq=False, kw_only=True)
class Drawn:
    """A train by its number: its case, and that at rest; ``kind`` of its bearings."""

    number: int
    kind: str
    hot: bool
    ratio: float
    case: GearCase
    rest: TrainState

    def train(self, more: int) -> MovingTrain:
        """In motion, in ``more`` coordinates than the interface of its contacts."""
        least = len(interface_of(self.rest.assembly)) - 1
        friction = rubbing(self.case, self.rest)
        return moving(self.case, self.rest, coordinates=least + more, friction=friction)


def drawn(number: int, seed: int = SEED) -> Drawn:
    """Train ``number`` of the seed: the first case of its numbers that can move."""
    rng = np.random.default_rng([seed, number])
    for _ in range(MOST_TRIES):
        try:
            found = _tried(number, rng)
        except ThermogearError:
            continue
        if found is not None:
            return found
    raise RuntimeError(f"train {number} of seed {seed}: {MOST_TRIES} cases refused")


def _tried(number: int, rng: Random) -> Drawn | None:
    kind = ("linear", "ring", "rolling", "mixed")[int(rng.integers(4))]
    hot = bool(rng.integers(2))
    ratio = float(np.exp(rng.uniform(*np.log(RATIO))))
    text, torque = _text(rng, kind)
    start = _case(text + ROUGH, 1500.0, torque)
    rest = settled(start, [0], states=[UNDEFORMED])[0][0]
    if rest.status != 0:
        return None
    rpm = 60.0 * ratio * _mesh_mode(rest) / start.pair.pinion.teeth
    case = _case(text + FINE, rpm, torque)
    there = settled(case, [0], states=[HOT if hot else UNDEFORMED])[0][0]
    if there.status != 0:
        return None
    return Drawn(number=number, kind=kind, hot=hot, ratio=ratio, case=case, rest=there)


def _case(text: str, rpm: float, torque: float) -> GearCase:
    point = f'\n[operating]\nspeed = "{rpm!r} rpm"\ntorque = "{torque!r} N m"\n'
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return gear_case(load_case(text + point))


def _mesh_mode(rest: TrainState) -> float:
    """Frequency [Hz] of the mode at rest with most of its energy in the teeth."""
    linear = rest.linear
    modes = linear.modes(0.0, count=min(60, linear.basis.shape[1]))
    energy = np.abs(modes.shape.T @ rest.assembly.drive) ** 2
    return float(modes.frequency[int(energy.argmax())] / (2.0 * np.pi))


def _text(rng: Random, kind: str) -> tuple[str, float]:
    """A case without its operating point, and its torque [N m]."""
    module = float(rng.choice(MODULES))
    turning = bool(rng.random() < IN_TURN)
    z1 = int(rng.integers(17, 33))
    z2 = 2 * z1 if turning else round(z1 * rng.uniform(1.0, 3.0))
    width = module * float(rng.uniform(6.0, 12.0))
    load, error = (float(np.exp(rng.uniform(*np.log(one)))) for one in (UNIT_LOAD, ERRORS))
    torque = load * width * module * 0.5e-3 * module * z1
    heat = float(rng.uniform(50.0, 130.0))
    text = (
        f'[gears]\nmodule = "{module!r} mm"\nface_width = "{width!r} mm"\n'
        f"[gears.pinion]\nteeth = {z1}\nprofile_shift = {float(rng.uniform(0.0, 0.3))!r}\n"
        f"[gears.wheel]\nteeth = {z2}\n"
        f'[oil]\nname = "ISO VG 100"\ntemperature = "{heat - 10.0!r} degC"\n'
        f'[temperatures]\npinion_addendum = "{heat!r} degC"\n'
        f'pinion_bore = "{heat - float(rng.uniform(0, 15))!r} degC"\n'
        f'wheel_addendum = "{heat - float(rng.uniform(0, 10))!r} degC"\n'
        f'wheel_bore = "{heat - float(rng.uniform(10, 20))!r} degC"\n'
        f'housing = "{heat - float(rng.uniform(10, 40))!r} degC"\n'
        f'[backlash]\nvalue = "{float(rng.uniform(0.06, 0.3))!r} mm"\ndirection = "normal"\n'
        'extent = "total"\ntemperature = "20 degC"\n'
        f"[dynamics]\ndamping_ratio = {float(rng.uniform(0.01, 0.1))!r}\n"
        "[transmission_error]\nharmonics = ["
        f'{{ order = 1, amplitude = "{error!r} um", '
        f'phase = "{float(rng.uniform(0, 360))!r} deg" }}, '
        f'{{ order = 2, amplitude = "{float(rng.uniform(0.0, 0.4)) * error!r} um", '
        f'phase = "{float(rng.uniform(0, 360))!r} deg" }}]\n'
    )
    for gear, teeth in (("pinion", z1), ("wheel", z2)):
        text += _shaft(rng, gear, module * (teeth - 2.5), width, kind, turning)
    for end in ("motor", "load"):
        if rng.integers(2):
            text += (
                f'\n[{end}]\ninertia = "{float(rng.uniform(0.005, 0.2))!r} kg m^2"\n'
                f'coupling_stiffness = "{float(rng.uniform(1e3, 2e4))!r} N m/rad"\n'
                f'coupling_damping = "{float(rng.uniform(0.5, 3.0))!r} N m s/rad"\n'
            )
    text += (
        f'\n[train]\ncentre_line = "{float(rng.uniform(-180, 180))!r} deg"\n'
        f'sense = "{("counter-clockwise", "clockwise")[int(rng.integers(2))]}"\n'
    )
    return text, torque


def _shaft(rng: Random, gear: str, root: float, width: float, kind: str, turning: bool) -> str:
    """A shaft of one diameter in two bearings."""
    bore = int(rng.choice([one for one in TYPES if one < 0.75 * root] or [min(TYPES)]))
    left, right = (float(rng.uniform(0.5 * width + 15.0, 0.5 * width + 60.0)) for _ in range(2))
    text = (
        f'\n[[shafts]]\ngear = "{gear}"\nlength = "{left + right + 30.0!r} mm"\n'
        f'diameter = "{bore} mm"\ngear_position = "{left + 15.0!r} mm"\n'
    )
    if turning:
        text += (
            f'unbalance = "{float(rng.uniform(5, 30))!r} g mm"\n'
            f'eccentricity = "{float(rng.uniform(1, 10))!r} um"\n'
        )
    for place in (15.0, left + right + 15.0):
        law = kind if kind != "mixed" else ("linear", "ring", "rolling")[int(rng.integers(3))]
        text += f'\n[[bearings]]\nshaft = "{gear}"\nposition = "{place!r} mm"\n'
        text += _law(rng, law, bore)
    return text


def _law(rng: Random, law: str, bore: int) -> str:
    if law == "linear":
        stiff = float(np.exp(rng.uniform(np.log(80.0), np.log(800.0))))
        return f'stiffness = ["{stiff!r} N/um", "{stiff * float(rng.uniform(0.6, 1.0))!r} N/um"]\n'
    if law == "ring":
        return (
            f'ring = {{ load = "{float(rng.uniform(500, 3000))!r} N", '
            f'deflection = "{float(rng.uniform(4, 20))!r} um", '
            f"exponent = {float(rng.choice([1.0, 10.0 / 9.0, 1.5]))!r}, "
            f'play = "{float(rng.uniform(2, 40))!r} um" }}\n'
        )
    name = str(rng.choice(TYPES[bore]))
    grade = ("C2", "CN", "C3", "C4")[int(rng.integers(4))]
    return f'type = "{name}"\nclearance_class = "{grade}"\n'
