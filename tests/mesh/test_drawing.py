"""Both gears drawn: they touch, they do not overlap, and what is left between them is 2 b'."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pytest
from numpy.typing import NDArray

from conftest import Compared
from thermogear import Gear, GearPair, MeshModel, Operating, Relief, Temperatures
from thermogear.base.errors import GeometryError, ValidityWarning
from thermogear.base.materials import MATERIALS, ZERO_CELSIUS, Material, lubricant
from thermogear.gears.deviations import Deviation, PressureAngleError
from thermogear.mesh.clearance import Clearance
from thermogear.mesh.drawing import drawn_gears
from thermogear.mesh.thermal import HotPair
from thermogear.views.gears import PINION, WHEEL, DrawnState, GearDrawing, gear_drawing

Floats = NDArray[np.float64]
T0 = ZERO_CELSIUS + 20.0
PHASES = (0.0, 0.11, 0.37, 0.5, 0.83)
FINE = 16


@dataclass(frozen=True, eq=False)
class Drawn:
    """A pair, its states of heat and what was drawn of it."""

    pair: GearPair
    states: dict[str, Operating]
    deviations: tuple[Deviation, ...] = ()

    @cached_property
    def drawing(self) -> GearDrawing:
        data = drawn_gears(
            self.pair,
            self.states,
            MeshModel.consistent(),
            deviations=self.deviations,
            phases=PHASES,
            fineness=FINE,
        )
        return gear_drawing(data, factor=1.0)

    def half_backlash(self, state: str) -> Floats:
        hot = HotPair(self.pair, self.states[state], MeshModel.consistent())
        return Clearance(hot, np.array(PHASES), self.deviations).half_backlash[0]


def operating(half: float, hot: float, material: Material) -> Operating:
    uneven = 4.0 if material.youngs_modulus < 30e9 else 10.0
    return Operating(
        speed=np.array([100.0]),
        torque=np.array([5.0]),
        lubricant=lubricant("M100"),
        oil_temperature=T0 + hot,
        temperatures=Temperatures(
            reference=T0,
            pinion_addendum=T0 + hot + uneven,
            pinion_bore=T0 + 0.8 * hot,
            wheel_addendum=T0 + hot,
            wheel_bore=T0 + 0.8 * hot,
            housing=T0 + 0.7 * hot,
        ),
        half_backlash=half,
        housing=material,
    )


def states(half: float, hot: float, material: Material) -> dict[str, Operating]:
    warm = operating(half, hot, material)
    return {"undeformed": warm.as_drawn(), "hot": warm}


def fixed_pairs() -> list[Drawn]:
    """Seven teeth, and undercut ones."""
    steel, found = MATERIALS["steel"], list[Drawn]()
    for first, second in (
        (Gear(7, 2e-3, profile_shift=0.6, tip_radius=9.6e-3), Gear(150, 2e-3)),
        (
            Gear(13, 3e-3, profile_shift=0.05, tip_radius=22.0e-3, allow_undercut=True),
            Gear(31, 3e-3, profile_shift=0.1, tip_radius=49.2e-3),
        ),
    ):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ValidityWarning)
            tight = GearPair(first, second).centre_distance
            pair = GearPair(first, second, tight + 0.02e-3)
        found.append(Drawn(pair, states(60e-6, 80.0, steel)))
    return found


def random_pairs(count: int = 14, seed: int = 3) -> list[Drawn]:
    """Pairs that can mesh: 7 to 150 teeth, undercut, large shift, wide axes, plastics, relief."""
    draw, found = np.random.default_rng(seed), list[Drawn]()
    while len(found) < count:
        plastic = len(found) % 4 == 3
        material = MATERIALS["POM" if plastic else "steel"]
        shared = {
            "pressure_angle": math.radians(float(draw.choice([17.5, 20.0, 25.0]))),
            "material": material,
            "allow_undercut": True,
        }
        module = float(draw.uniform(0.8e-3, 8e-3))
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", ValidityWarning)
                gears = [
                    Gear(int(teeth), module, profile_shift=float(draw.uniform(-0.3, 0.8)), **shared)
                    for teeth in (draw.integers(7, 40), draw.integers(12, 151))
                ]
                tight = GearPair(gears[0], gears[1])
                wide = tight.centre_distance + float(draw.uniform(0.0, 0.02)) * module
                pair = GearPair(gears[0], gears[1], wide)
        except GeometryError:
            continue
        path = pair.path
        relieved: tuple[Deviation, ...] = (
            Relief("pinion", amount=4e-3 * module, length=0.25 * (path.e - path.a)),
            PressureAngleError("wheel", 3e-4),
        )
        half = 0.5 * pair.normal_backlash + float(draw.uniform(0.01, 0.03)) * module
        hot = float(draw.uniform(10.0 if plastic else 20.0, 25.0 if plastic else 110.0))
        found.append(Drawn(pair, states(half, hot, material), relieved if len(found) % 2 else ()))
    return found


PAIRS = [*fixed_pairs(), *random_pairs()]


def profile(drawing: GearDrawing, state: DrawnState, gear: int) -> tuple[Floats, Floats, Floats]:
    """(radius, angle on the back side, on the drive side), from the root circle outwards."""
    shape = drawing.shape(state, gear, factor=1.0)
    middle = shape.size // 2
    back, drive = shape[: middle + 1], shape[: middle - 1 : -1]
    radius = np.abs(drive)
    keep = np.concatenate([[True], np.diff(radius) > 1e-9 * radius[-1]])
    keep[-1] = True
    return radius[keep], np.angle(back)[keep], np.angle(drive)[keep]


def free_turns(drawing: GearDrawing, state: DrawnState, phase: int) -> tuple[float, float]:
    """How far [mm, at the base circle] the pinion may turn on and back till a tooth touches.

    Every point of the wheel near the mesh against the pinion's outline at its radius: plane
    geometry on the outlines alone, negative where they overlap.
    """
    radius, back, drive = profile(drawing, state, PINION)
    step = 2.0 * math.pi / drawing.teeth[PINION]
    tip = radius[-1]
    wheel = drawing.whole(state, WHEEL, phase=phase)
    near = wheel[np.abs(wheel) < tip]
    # which place the pinion's teeth leave a point: its angle from the nearest tooth's axis
    place = np.angle(near * np.exp(-1j * drawing.axis(state, PINION, phase=phase, factor=1.0)))
    r = np.abs(near)
    ahead = np.mod(place, step) - np.interp(r, radius, drive)
    behind = np.mod(place, step) - step - np.interp(r, radius, back)
    base = drawing.circles[PINION]["base"]
    return base * float(ahead.min()), base * -float(behind.max())


@pytest.mark.parametrize(
    "drawn", PAIRS, ids=lambda d: f"{d.pair.pinion.teeth}:{d.pair.wheel.teeth}"
)
def test_drawn_gears_touch_and_leave_what_the_backlash_says(
    drawn: Drawn, compared: Compared
) -> None:
    """The drive flanks touch, nothing overlaps, the back flanks are 2 b' apart, cold and hot."""
    drawing, touch, left = drawn.drawing, [], []
    module = drawing.module
    for name in drawn.states:
        state, half = drawing.state(name), 1e3 * drawn.half_backlash(name)
        for phase in range(len(PHASES)):
            on, back = free_turns(drawing, state, phase)
            touch.append(on / module)
            left.append((on + back - 2.0 * half[phase]) / module)
    compared("gap of the drive flanks [modules]", "0, on the drawn outlines", touch, 2e-4)
    compared("gap of the back flanks [modules]", "2 b', on the drawn outlines", left, 2e-4)


def test_the_gears_of_one_temperature_are_the_drawn_ones_larger() -> None:
    """Gears and housing alike hot: every place grows by lambda t, no gap but in proportion."""
    pair, steel = PAIRS[0].pair, MATERIALS["steel"]
    cold = operating(60e-6, 0.0, steel).as_drawn()
    warm = Operating(
        speed=cold.speed,
        torque=cold.torque,
        lubricant=cold.lubricant,
        oil_temperature=cold.oil_temperature,
        temperatures=Temperatures.uniform(T0 + 100.0, reference=T0),
        half_backlash=60e-6,
        pulled=0.0,
    )
    drawing = Drawn(pair, {"undeformed": cold, "hot": warm}).drawing
    first, last = drawing.states
    larger = 1.0 + 100.0 * steel.thermal_expansion
    for gear in (PINION, WHEEL):
        grown = last.outlines[gear] / first.outlines[gear]
        assert np.abs(grown - larger).max() < 1e-9
    assert last.centre_distance / first.centre_distance == pytest.approx(larger, rel=1e-12)
    assert last.lag == pytest.approx(0.0, abs=1e-9)


def test_shares_add_up_and_contacts_lie_on_the_line_of_action() -> None:
    drawing = PAIRS[2].drawing
    for state in drawing.states:
        assert np.nansum(state.share, axis=-1) == pytest.approx(1.0)
        carried = state.share > 0.0
        first, last = drawing.line_of_action
        along = (last - first) / abs(last - first)
        off = ((drawing.contact - first) * np.conj(along)).imag
        assert np.abs(off[carried]).max() < 1e-9
        assert np.nanmin(state.drive_gap, axis=-1) == pytest.approx(0.0, abs=1e-15)
    # where a contact lies, the drawn pinion's flank is
    cold = drawing.states[0]
    for phase in range(len(PHASES)):
        line = drawing.whole(cold, PINION, phase=phase)
        for point in drawing.contact[phase][cold.share[phase] > 0.0]:
            assert np.abs(line - point).min() < 0.03 * drawing.module


def test_enlarging_is_in_proportion_and_keeps_the_touch() -> None:
    """Ten times the gap where ten times is asked for, to first order in what is small."""
    drawn = PAIRS[4]
    data = drawn_gears(
        drawn.pair, drawn.states, MeshModel.consistent(), phases=PHASES, fineness=FINE
    )
    drawing = gear_drawing(data, factor=10.0)
    for state in drawing.states:
        centre = drawing.centre(state, WHEEL)
        assert centre - drawing.centre_distance == pytest.approx(
            10.0 * (state.centre_distance - drawing.centre_distance)
        )
        plain, large = (drawing.shape(state, PINION, factor=f) for f in (1.0, 10.0))
        assert large - drawing.tight[PINION] == pytest.approx(
            10.0 * (plain - drawing.tight[PINION])
        )
