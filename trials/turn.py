"""Random pairs with pitch errors on both gears: the exact engine over a turn put to another test.

``make trial NAME=turn`` draws pairs until 40 have a motion that closes (seed fixed before the first
run), five of them with more than 500 mesh periods to a turn and three hunting pairs with more than
1500. Stiffness and error of the whole turn come from the loaded contact. The motion from rest goes
to the event-exact maps with their label, and to Runge-Kutta steps of this file, in metres and
seconds and in the total displacement, whose tables are its own inverse transforms. Dynamic factor
and share of contact loss are compared, and trials/records/turn.md is written.
``python trials/turn.py 3`` prints three short ones.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numba
import numpy as np
from numpy.typing import NDArray

from thermogear import Excitation, Gear, GearPair, Periodic, label
from thermogear.analysis.proof import Label
from thermogear.dynamics.models import from_excitation
from thermogear.gears.deviations import PitchError
from thermogear.gears.loaded import solve_mesh
from thermogear.mesh.excite import disc_inertia

Floats = NDArray[np.float64]

SEED = 53_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "turn.md"
LENGTHS = ((1500, 2000), *[(1500, 2000)] * 2, (500, 1500), (500, 1500), *[(12, 500)] * 35)
"""Mesh periods of a turn, least and most, of each pair; the last are those of a short trial."""
TEETH = (16, 60)
POSITIONS, HARMONICS = 96, 24
"""Of a mesh period: phases of the loaded contact, harmonics that are kept."""
FINER = (192, 60)
"""The same of the finer tables, which show what the coarser ones cost: no verdict."""
FINER_UP_TO = 500
"""Mesh periods of a turn up to which the finer tables are made."""
STEPS = 512
"""Runge-Kutta steps of a mesh period."""
FACTOR, LOSS = 0.01, 0.005
"""Allowed: relative difference of dynamic factors, difference of the shares of contact loss."""


@dataclass(frozen=True)
class Drawn:
    """A pair with the index errors [m] of all its teeth, and how it runs."""

    pair: GearPair
    errors: tuple[PitchError, PitchError]
    force: float
    ratio: float
    damping: float

    @property
    def mesh_periods(self) -> int:
        return math.lcm(self.pair.pinion.teeth, self.pair.wheel.teeth)

    def excitation(self, positions: int, harmonics: int) -> Excitation:
        """Stiffness k and error delta - F/k of the whole turn, at the mean load."""
        count, pair = self.mesh_periods, self.pair
        phase = np.arange(positions * count) / positions
        mesh = solve_mesh(pair, self.force, phase, deviations=self.errors)
        stiffness, deflection = np.ravel(mesh.tangent), np.ravel(mesh.deflection)
        gears = (pair.pinion, pair.wheel)
        inertias = tuple(disc_inertia(gear, radius=gear.pitch_radius) for gear in gears)
        torques = tuple(self.force * gear.base_radius for gear in gears)
        radii = (pair.pinion.base_radius, pair.wheel.base_radius)
        k = Periodic.from_samples(stiffness, harmonics * count)
        e = Periodic.from_samples(deflection - self.force / stiffness, harmonics * count)
        made = {
            "stiffness": k, "error": e, "half_backlash": 60e-6, "reference_half_backlash": 60e-6,
            "mean_force": self.force, "inertias": inertias, "base_radii": radii,
            "torques": torques, "damping_ratio": self.damping, "mesh_periods": count,
        }  # fmt: skip
        natural = Excitation(**made, mesh_frequency=1.0).natural_frequency
        return Excitation(**made, mesh_frequency=self.ratio * natural)


@dataclass(frozen=True)
class Compared:
    """What both say of one pair: dynamic factors, shares of contact loss, and the processor times.

    ``finer``: the factor of the own integration with the finer tables, nan where none were made;
    ``apart``: from the same start both end on different motions, compared from the orbit itself.
    """

    drawn: Drawn
    label: Label
    factors: tuple[float, float]
    losses: tuple[float, float]
    finer: float
    apart: bool
    seconds: tuple[float, float]

    @property
    def factor_error(self) -> float:
        return abs(self.factors[0] / self.factors[1] - 1.0)

    @property
    def loss_error(self) -> float:
        return abs(self.losses[0] - self.losses[1])

    @property
    def row(self) -> str:
        teeth = f"{self.drawn.pair.pinion.teeth}/{self.drawn.pair.wheel.teeth}"
        finer = f"{self.finer:.3f}" if math.isfinite(self.finer) else "–"
        return (
            f"| {teeth} | {self.drawn.mesh_periods} | {self.drawn.ratio:.2f} | "
            f"{self.drawn.damping:.3f} | {self.label.period} | {self.factors[0]:.4f} | "
            f"{self.factors[1]:.4f} | {100 * self.losses[0]:.2f} | {100 * self.losses[1]:.2f} | "
            f"{finer} | {self.seconds[0]:.2f} | {self.seconds[1]:.2f} |"
        )


def draw(random: np.random.Generator, least: int, most: int) -> Drawn:
    """A pair whose turn has ``least`` to ``most`` mesh periods."""
    while True:
        first, second = (int(z) for z in random.integers(TEETH[0], TEETH[1] + 1, 2))
        if least <= math.lcm(first, second) <= most:
            break
    module = float(random.uniform(1.5e-3, 6e-3))
    width = 10.0 * module
    gears = [Gear(z, module, face_width=width) for z in (first, second)]
    pair = GearPair(gears[0], gears[1])
    sigma = float(random.uniform(0.5e-6, 4e-6))
    errors = [
        PitchError(name, tuple(sigma * random.standard_normal(z)))
        for name, z in (("pinion", first), ("wheel", second))
    ]
    return Drawn(
        pair,
        (errors[0], errors[1]),
        force=float(random.uniform(50e3, 200e3)) * width,
        ratio=float(random.uniform(0.15, 1.4)),
        damping=float(random.uniform(0.03, 0.1)),
    )


@numba.njit(cache=False)
def _turn(
    k: Floats, e: Floats, rate: Floats, numbers: Floats, state: Floats, forces: Floats
) -> float:
    """One turn of m y'' + c (y' - e') + k f(y - e) = F by steps; the time out of contact [s].

    Tables at half steps; ``numbers``: m, c, F, half backlash, step. A step during which the flanks
    part or meet counts in proportion to the gap at its ends.
    """
    m, c, load, b, h = numbers
    size = k.size
    y, v = state
    lost = 0.0
    for step in range(size // 2):
        dy = dv = ay = av = 0.0
        for stage in range(4):
            place = (2 * step + (stage + 1) // 2) % size
            part = 0.0 if stage == 0 else (1.0 if stage == 3 else 0.5)
            at, speed = y + part * h * ay, v + part * h * av
            x = at - e[place]
            bent = x - b if x > b else (x + b if x < -b else 0.0)
            if stage == 0:
                forces[step] = k[place] * bent
                before = x - b
            ay, av = speed, (load - c * (speed - rate[place]) - k[place] * bent) / m
            weight = 1.0 if stage in (0, 3) else 2.0
            dy += weight * ay
            dv += weight * av
        y += h * dy / 6.0
        v += h * dv / 6.0
        after = y - e[(2 * step + 2) % size] - b
        if before < 0.0 and after < 0.0:
            lost += h
        elif before < 0.0 or after < 0.0:
            lost += h * min(before, after) / (min(before, after) - max(before, after))
    state[0], state[1] = y, v
    return lost


def table(series: Periodic, count: int, order: int = 0) -> Floats:
    """``series``, or its derivative by the phase, at ``count`` phases of the turn."""
    spectrum = np.zeros(count // 2 + 1, complex)
    spectrum[1 : len(series.harmonics) + 1] = 0.5 * np.array(series.harmonics)
    spectrum *= (2j * np.pi * np.arange(spectrum.size)) ** order
    spectrum[0] = series.mean if order == 0 else 0.0
    return np.asarray(np.fft.irfft(spectrum, count) * count)


def integrated(
    at: Excitation, turns: int, start: tuple[float, float], period: int = 1
) -> tuple[float, float]:
    """Dynamic factor and share of contact loss of ``period`` turns, by steps.

    ``turns`` are run before, and at most twenty times as many until the greatest force comes again
    within 1e-5 after ``period`` turns. ``start``: (x, x') [m, m/s], x less the error.
    """
    count = 2 * STEPS * at.mesh_periods
    time_of_turn = 2.0 * np.pi * at.mesh_periods / at.mesh_frequency
    k, e = table(at.stiffness, count), table(at.error, count)
    rate = table(at.error, count, 1) / time_of_turn
    mass = at.equivalent_mass
    damping = 2.0 * at.damping_ratio * mass * at.natural_frequency
    step = 2.0 * time_of_turn / count
    numbers = np.array([mass, damping, at.mean_force, at.half_backlash, step])
    state = np.array([start[0] + e[0], start[1] + rate[0]])
    forces = np.empty(count // 2)
    turns_done: list[tuple[float, float]] = []
    while True:
        lost = _turn(k, e, rate, numbers, state, forces)
        turns_done.append((float(np.abs(forces).max()) / at.mean_force, lost / time_of_turn))
        if len(turns_done) < turns + 2 * period:
            continue
        last, before = (
            max(one[0] for one in part)
            for part in (turns_done[-period:], turns_done[-2 * period : -period])
        )
        if abs(last / before - 1.0) < 1e-5 or len(turns_done) >= 20 * (turns + 2 * period):
            return last, float(np.mean([one[1] for one in turns_done[-period:]]))


def compared(drawn: Drawn) -> Compared | None:
    """Both ways; None where the motion is labelled as one that does not close."""
    begun = time.process_time()
    at = drawn.excitation(POSITIONS, HARMONICS)
    statics = time.process_time()
    length, speed = at.reference_half_backlash, at.reference_half_backlash * at.natural_frequency
    start = (at.half_backlash + at.mean_force / at.stiffness.mean, 0.0)
    motion = label(from_excitation(at), initial_state=(start[0] / length, 0.0))
    orbit = motion.orbit
    if orbit is None or motion.name == "undecided":
        return None
    factor, loss = orbit.dynamic_load_factor(), max(1.0 - float(orbit.shares[2]), 0.0)
    done = time.process_time()
    # what is left of a start after so many mesh periods: 1e-4
    turns = math.ceil(
        math.log(1e4) * drawn.ratio / (2.0 * math.pi * drawn.damping * at.mesh_periods)
    )
    stepped = integrated(at, turns, start, motion.period)
    apart = abs(stepped[0] / factor - 1.0) > FACTOR or abs(stepped[1] - loss) > LOSS
    if apart:
        there = (float(orbit.state[0]) * length, float(orbit.state[1]) * speed)
        stepped = integrated(at, turns, there, motion.period)
    finer = math.nan
    if at.mesh_periods <= FINER_UP_TO:
        finer, _ = integrated(drawn.excitation(*FINER), turns, start, motion.period)
    return Compared(
        drawn, motion, (factor, stepped[0]), (loss, stepped[1]), finer, apart,
        (statics - begun, done - statics),
    )  # fmt: skip


def all_compared(count: int | None = None) -> Iterator[Compared | None]:
    """Pair after pair, None for one that does not close: the last ``count`` of them, or all."""
    random = np.random.default_rng(SEED)
    for least, most in LENGTHS[-count:] if count else LENGTHS:
        pair = None
        while pair is None:
            pair = compared(draw(random, least, most))
            yield pair


HEAD = f"""# Pairs with pitch errors: the exact engine over a turn against other steps

Made by `make trial NAME=turn`, seed {SEED}: pairs of {TEETH[0]} to {TEETH[1]} teeth, modules of
1.5 to
6 mm, 50 to 200 N/mm, index errors of both gears with standard deviations of 0.5 to 4 um, mesh over
natural frequency 0.15 to 1.4, damping ratio 0.03 to 0.1. Stiffness and error of the turn come from
the loaded contact at {POSITIONS} phases of each mesh period, {HARMONICS} harmonics of the mesh
frequency are kept. *Exact*: event-exact maps with the turn as their period, labelled. *Steps*:
{STEPS} Runge-Kutta steps of a mesh period in SI units, an own program, from the same start.
*Finer*: the same steps with tables of {FINER[0]} phases and {FINER[1]} harmonics, which is what
the tables cost and no error of the engine. Seconds of one core: tables of the turn; label, orbit
and factor.

| teeth | mesh periods | ratio | damping | turns | factor, exact | steps | loss [%], exact | steps \
| finer | tables [s] | motion [s] |
|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|
"""


def page(pairs: list[Compared], open_: int) -> str:
    """The page of all pairs, ``open_`` of which did not close."""
    worst = max(one.factor_error for one in pairs)
    loss = max(one.loss_error for one in pairs)
    tables = [abs(one.finer / one.factors[1] - 1.0) for one in pairs if math.isfinite(one.finer)]
    beyond = sum(one.factor_error > FACTOR or one.loss_error > LOSS for one in pairs)
    apart = sum(one.apart for one in pairs)
    rows = "\n".join(one.row for one in pairs)
    return f"""{HEAD}{rows}

{len(pairs)} pairs. Worst: dynamic factor {100 * worst:.3f} % apart (allowed {100 * FACTOR:g} %),
share of contact loss {100 * loss:.3f} % of the time (allowed {100 * LOSS:g} %); {beyond} pairs
beyond. From the same start {apart} ended on another motion and were compared from the orbit
itself. The motions of {open_} more pairs that were drawn did not close by their labels; others
were drawn for them. Finer tables change the factor by {100 * float(np.median(tables)):.2f} %
(median), {100 * max(tables):.1f} % at most.
"""


def main() -> None:
    """Print every pair, and without a number of pairs write the page."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else None
    pairs, open_ = [], 0
    for one in all_compared(count):
        if one is None:
            open_ += 1
            continue
        pairs.append(one)
        print(one.row, flush=True)
    text = page(pairs, open_)
    print(text[text.rindex("\n\n") :].strip())
    if count is None:
        PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
