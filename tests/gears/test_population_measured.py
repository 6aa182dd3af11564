"""Gears of a class measured anew: by their geometry, with nothing of the program but the drawing.

A centre beside the axis, an index and a profile of each tooth are read as an inspection machine
reads them, about the bore: the shift of a flank along its normal, written in polar angles here, is
not taken over the mesh.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from thermogear.gears.geometry import Gear
from thermogear.gears.pair import GearPair
from thermogear.gears.population import drawn_pair

MODULE = 3.175e-3
PAIR = GearPair(Gear(28, MODULE), Gear(28, MODULE))
ODD = GearPair(Gear(20, MODULE), Gear(75, MODULE))
GRADE = 5
ALPHA = math.radians(20.0)
NAMES = ("pinion", "wheel")
LEAST = 1.0 / math.sqrt(2.0)


def tolerances(teeth: int, grade: int) -> np.ndarray:
    """f_pT, F_pT, f_HalphaT, f_falphaT, F_alphaT [m] of ISO 1328-1:2013, unrounded."""
    module = 1e3 * MODULE
    d = module * teeth
    slope = 0.4 * module + 0.001 * d + 4.0
    form = 0.55 * module + 5.0
    steps = [
        0.001 * d + 0.4 * module + 5.0,
        0.002 * d + 0.55 * math.sqrt(d) + 0.7 * module + 12.0,
        slope,
        form,
        math.hypot(slope, form),
    ]
    return 1e-6 * math.sqrt(2.0) ** (grade - 5) * np.array(steps)


def read(pair: GearPair, name: str, drawn: Sequence[Any], side: str) -> np.ndarray:
    """The five figures of one side of a gear [m].

    In the gear's frame, angles from the axis of tooth 0 towards tooth 1: an involute flank of tooth
    n at the roll angle xi has its normal, the tangent of the base circle, at a right angle to
    2 pi n/z +- (psi - xi), upper sign the flank that faces the next tooth: leaning over its tooth,
    it unwinds towards the axis of the tooth. The flank is moved along the normal by the shift of
    the centre, and by the index of its tooth.
    """
    gear, mate = (pair.pinion, pair.wheel)[:: 1 if name == "pinion" else -1]
    z, base = gear.teeth, gear.base_radius
    centre, index, *sides = (d for d in drawn if d.gear == name)
    profiles = next(s for s in sides if s.shapes[0].flank == side).shapes
    line = math.sin(ALPHA) * 0.5 * MODULE * (gear.teeth + mate.teeth)
    tip = math.sqrt((0.5 * MODULE * z + MODULE) ** 2 - base**2)
    start = line - math.sqrt((0.5 * MODULE * mate.teeth + MODULE) ** 2 - mate.base_radius**2)
    pitch = base * math.tan(ALPHA)
    half = 0.5 * math.pi / z + math.tan(ALPHA) - ALPHA
    # tooth 0 enters first, tooth 1 after it: the next tooth is behind. Of the driving pinion the
    # drive flank faces ahead, of the driven wheel behind
    to_next = -1.0 if (name == "pinion") == (side == "drive") else 1.0
    facing = 1.0 if side == "drive" else -1.0

    def added(n: int, rho: np.ndarray) -> np.ndarray:
        normal = 2.0 * math.pi * n / z + to_next * (half - rho / base + 0.5 * math.pi)
        shift = centre.amount * np.cos(normal - centre.angle)
        shape, x = profiles[n], (rho - start) / (tip - start)

        def form(x: np.ndarray) -> np.ndarray:
            wave = np.sin(2.0 * math.pi * shape.waves * x + shape.phase)
            barrel = shape.barrel * (2.0 * x - 1.0) ** 2
            return np.asarray(shape.slope * (x - 0.5) - barrel + shape.wave * wave)

        at_pitch = form(np.array((pitch - start) / (tip - start)))
        return np.asarray(shift + facing * index.errors[n] + form(x) - at_pitch)

    arc = np.array([float(added(n, np.array([pitch]))[0]) for n in range(z)]) / math.cos(ALPHA)
    rho = np.linspace(start, tip, 400)
    figures = []
    for n in np.arange(4) * z // 4:
        trace = added(int(n), rho)
        line_through = np.polyval(np.polyfit(rho, trace, 1), rho)
        figures.append(
            [abs(line_through[-1] - line_through[0]), np.ptp(trace - line_through), np.ptp(trace)]
        )
    return np.array([np.abs(np.diff(arc, append=arc[:1])).max(), np.ptp(arc), *np.max(figures, 0)])


def shares_of(pair: GearPair, parts: int) -> np.ndarray:
    """Figures over tolerances, (part, gear, side, figure)."""
    return np.array(
        [
            [
                [
                    read(pair, name, drawn, side) / tolerances(teeth, GRADE)
                    for side in ("drive", "back")
                ]
                for name, teeth in zip(NAMES, (pair.pinion.teeth, pair.wheel.teeth), strict=True)
            ]
            for drawn in (drawn_pair(pair, GRADE, seed=21, place=n) for n in range(parts))
        ]
    )


@pytest.fixture(scope="module")
def shares() -> np.ndarray:
    return shares_of(PAIR, 64)


def test_every_part_has_the_class_on_both_flanks_and_none_a_better(shares: np.ndarray) -> None:
    """To 1.5 %: profiles of 400 points here."""
    for worst in (shares, shares_of(ODD, 16)):
        assert worst.max() <= 1.015
        assert worst.max(axis=(2, 3)).min() >= LEAST * 0.985


def test_shares_of_the_tolerances_are_those_of_another_program(shares: np.ndarray) -> None:
    """Of 128 gears so many lie below its quantiles of 5, 50, 95 %, given to .01, as they should.

    Within four standard deviations of a binomial count.
    """
    drive = shares[:, :, 0].reshape(-1, 5)
    for place, quantiles in enumerate(
        ((0.42, 0.71, 0.95), (0.31, 0.63, 0.94), (0.21, 0.54, 0.91), (0.28, 0.69, 0.93))
    ):
        for share, value in zip((0.05, 0.5, 0.95), quantiles, strict=True):
            mean, sd = 128.0 * share, math.sqrt(128.0 * share * (1.0 - share))
            assert np.count_nonzero(drive[:, place] < value - 0.005) <= mean + 4.0 * sd
            assert np.count_nonzero(drive[:, place] < value + 0.005) >= mean - 4.0 * sd


def test_two_classes_coarser_every_figure_is_doubled() -> None:
    fine, coarse = (drawn_pair(ODD, grade, seed=21, place=5) for grade in (GRADE, GRADE + 2))
    for name in NAMES:
        for side in ("drive", "back"):
            np.testing.assert_allclose(
                read(ODD, name, coarse, side), 2.0 * read(ODD, name, fine, side)
            )
