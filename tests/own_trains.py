"""Case files with shafts: a short one, and random ones."""

from __future__ import annotations

import numpy as np

PAIR = """
[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 20
[gears.wheel]
teeth = 40
[oil]
name = "ISO VG 100"
temperature = "60 degC"
[operating]
speed = "3000 rpm"
torque = "80 N m"
"""

PINION = """
[[shafts]]
gear = "pinion"
length = "120 mm"
diameter = "25 mm"
bearings = "6205"
"""

WHEEL = """
[[shafts]]
gear = "wheel"
length = "120 mm"
diameter = "30 mm"
bearings = "6206"
"""

TRAIN = PAIR + PINION + WHEEL


def bare(name: str, more: str = "") -> str:
    """A shaft of 120 mm without bearings."""
    return f'\n[[shafts]]\ngear = "{name}"\nlength = "120 mm"\ndiameter = "25 mm"\n{more}\n'


def bearing(shaft: str, position: str, law: str = 'type = "6205"') -> str:
    return f'\n[[bearings]]\nshaft = "{shaft}"\nposition = "{position}"\n{law}\n'


FOUR = "".join(
    bearing(shaft, place) for shaft in ("pinion", "wheel") for place in ("10 mm", "110 mm")
)
OWN = PAIR + bare("pinion") + bare("wheel") + FOUR


def random_train(random: np.random.Generator) -> str:
    """Any pair that turns, on stepped shafts in bearings of every kind."""
    text = PAIR
    for shaft in ("pinion", "wheel"):
        lengths = random.uniform(30.0, 60.0, int(random.integers(2, 6)))
        sections = ", ".join(
            f'{{ length = "{x!r} mm", diameter = "{float(random.uniform(20.0, 40.0))!r} mm", '
            f'inner_diameter = "{float(random.uniform(0.0, 15.0))!r} mm" }}'
            for x in map(float, lengths)
        )
        whole = float(lengths.sum())
        at = float(random.uniform(0.1, 0.9)) * whole
        text += f'\n[[shafts]]\ngear = "{shaft}"\nsections = [{sections}]\n'
        text += (
            f'gear_position = "{at!r} mm"\nunbalance = "{float(random.uniform(0, 30))!r} g mm"\n'
        )
        text += f'eccentricity = "{float(random.uniform(0, 10))!r} um"\n'
        beside = [k for k in range(21) if abs(k / 20.0 * whole - at) > 16.0]
        for share in np.sort(random.choice(beside, int(random.integers(2, 5)), False)):
            law = _LAWS[int(random.integers(len(_LAWS)))]
            text += bearing(shaft, f"{float(share) / 20.0 * whole!r} mm", law)
        if random.integers(2):
            text += f'\n[[discs]]\nshaft = "{shaft}"\nposition = "{0.3 * whole!r} mm"\n'
            text += 'outer_diameter = "80 mm"\nwidth = "10 mm"\n'
    for end in ("motor", "load"):
        if random.integers(2):
            text += f'\n[{end}]\ninertia = "0.02 kg m^2"\ncoupling_stiffness = "2000 N m/rad"\n'
    if random.integers(2):
        text += '\n[housing]\nmass = "40 kg"\nmount_stiffness = ["50 N/um", "70 N/um"]\n'
    return text + (
        f'\n[train]\ncentre_line = "{float(random.uniform(-180, 180))!r} deg"\n'
        f'sense = "{("counter-clockwise", "clockwise")[int(random.integers(2))]}"\n'
        f'damping = "{("bearings", "proportional", "modal")[int(random.integers(3))]}"\n'
    )


_LAWS = (
    'type = "6205"\nclearance_class = "C3"',
    'type = "NU206E"\nplay = "12 um"\nhousing_interference = "-5 um"',
    'type = "6206"\nplay = "-4 um"\nshaft_interference = "0 um"',
    'stiffness = "200 N/um"\ndamping = "600 N s/m"',
    'stiffness = ["200 N/um", "150 N/um"]\ncross_stiffness = "20 N/um"',
    'ring = { load = "1000 N", deflection = "15 um", exponent = 1.5, play = "16 um" }',
    'type = "6305"\nseat_stiffness = "400 N/um"',
    'inside = { bore = "25 mm", outside_diameter = "52 mm", width = "15 mm", elements = 9, '
    'element_diameter = "7.938 mm", pitch_diameter = "38.5 mm" }',
)
