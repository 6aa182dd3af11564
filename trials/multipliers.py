"""Random drive trains on rolling bearings: is every printed digit of a Floquet multiplier right?

``make trial NAME=multipliers`` draws trains (seed fixed before the first run) until so many
settle on a
periodic motion in which elements begin and cease to carry, in ten minutes at most, and takes the
largest multiplier of each again by another integration: DOP853 of the equation with its variational
equations to 1e-11 a step, its orbit found by Newton's rule with its own Jacobian. Nothing of the
engine is in it. Writes trials/records/multipliers.md; ``--count 4`` prints a short one.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent))
from train_draws import Drawn, drawn
from train_reference import Independent

from thermogear.analysis.any_motion import settle
from thermogear.analysis.walk import Motion, Search
from thermogear.base.display import shared
from thermogear.dynamics.geared_map import GearedMap

Floats = NDArray[np.float64]

PAGE = Path(__file__).parents[1] / "trials" / "records" / "multipliers.md"
SEED = 29_2026
COUNT = 40
LONGEST = 600.0
"""Seconds of the processor for the trial."""
MODES = 6
"""Kept beside the interface of the contacts."""
SAMPLES = 256
"""A mesh period, in which elements are looked for that begin or cease to carry."""
TOLERANCE = 1e-11
"""Error of a step of the other integration, over the motion of the teeth by a half backlash."""
SEARCH = Search(cap=1024, exponent=False, sections=0, starts=1)
"""Chaos is not asked for: it has no multiplier."""


@dataclass(frozen=True, kw_only=True)
class Compared:
    """The largest multiplier of train ``number``, printed and by the other integration."""

    number: int
    kind: str
    exponents: tuple[float, ...]
    period: int
    changes: int
    printed: str
    error: float
    away: float
    right: bool


def orbit_of(number: int, seed: int = SEED) -> tuple[Drawn, GearedMap, Motion] | None:
    """What train ``number`` settles on; None where no element changes on it, or it is no orbit."""
    one = drawn(number, seed)
    train = one.train(MODES)
    if train.model.cycle > 1 or not any(b.elements for b in train.model.bearings):
        return None
    section = GearedMap(model=train.model)
    motion = settle(section, train.start, SEARCH)
    if motion.orbit is None or not changes(section, motion):
        return None
    return one, section, motion


def changes(section: GearedMap, motion: Motion) -> int:
    """How often an element begins or ceases to carry on the orbit, by samples."""
    model = section.model
    run = section.engine.run(motion.state, motion.period, samples=SAMPLES)
    total = 0
    for one in model.bearings:
        u = run.samples[:, : model.size] @ one.directions
        carries = u @ one.rays.T > one.clearance
        total += int(np.sum(carries != np.roll(carries, 1, axis=0)))
    return total


def other_multiplier(section: GearedMap, motion: Motion) -> float:
    """Modulus of the largest multiplier by the other integration, on its own orbit."""
    other, n = Independent(section.model, TOLERANCE), motion.period
    state = motion.state
    for _ in range(2):
        there, jacobian = other.jacobian(state, n)
        state = state - np.linalg.solve(jacobian - np.eye(state.size), there - state)
    _, jacobian = other.jacobian(state, n)
    return float(np.abs(np.linalg.eigvals(jacobian)).max())


def compared(number: int, seed: int = SEED) -> Compared | None:
    """The multiplier of train ``number`` against the other integration's; None: no orbit."""
    found = orbit_of(number, seed)
    if found is None:
        return None
    one, section, motion = found
    size, error = abs(motion.multiplier), motion.multiplier_error
    printed, true = shared(size, error=error), other_multiplier(section, motion)
    bearings = section.model.bearings
    return Compared(
        number=number,
        kind=one.kind,
        exponents=tuple(sorted({b.exponent for b in bearings if b.elements})),
        period=motion.period,
        changes=changes(section, motion),
        printed=printed,
        error=error,
        away=abs(size - true),
        right=right(printed, true),
    )


def right(printed: str, true: float) -> bool:
    """Whether ``true`` is rounded to what is ``printed``, by half a unit of its last place."""
    if printed.startswith("below"):
        return true <= 10.0 ** _power(printed)
    mantissa, _, power = printed.partition("·")
    places = len(mantissa.partition(".")[2])
    scale = 10.0 ** _power(power) if power else 1.0
    # a true value on the border between two roundings may go either way: rounding of doubles
    return abs(float(mantissa) - true / scale) <= 0.5 * 10.0**-places + 1e-12


def _power(text: str) -> int:
    plain = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
    return int(text.rpartition("10")[2].translate(plain))


def trial(count: int) -> Iterator[Compared]:
    """Comparisons of the first ``count`` trains with an orbit, as many as the time allows."""
    number = made = 0
    while made < count and time.process_time() < LONGEST:
        found = compared(number)
        number += 1
        if found is not None:
            made += 1
            yield found


def page(rows: Sequence[Compared]) -> list[str]:
    """What is printed, or written to the page."""
    wrong = [row for row in rows if not row.right]
    worst = max(rows, key=lambda row: row.away)
    drawn_of = rows[-1].number + 1
    lines = [
        "# Trial of Floquet multipliers on rolling bearings",
        "",
        f"Made by `make trial NAME=multipliers` (seed {SEED}): {drawn_of} random drive trains, "
        f"of which {len(rows)} have rolling elements",
        "that begin and cease to carry, no forces at shaft orders, and settle on an orbit within "
        "1024 mesh periods.",
        "The largest multiplier of each against DOP853 of its variational equations at "
        f"{TOLERANCE:g} a step, on an orbit of its own.",
        "*Changes*: how often an element begins or ceases to carry on the orbit. *Error*: what "
        "finer steps change, which says how",
        "many digits are printed. *Away*: from the other integration's, whose own error is in it.",
        "",
        f"**{len(wrong)} of {len(rows)} have a printed digit that is wrong.** The worst is "
        f"{worst.away:.1e} away (train {worst.number}, printed {worst.printed}).",
        "",
        "| train | bearings | exponents | period | changes | printed | error | away | |",
        "|---:|---|---|---:|---:|---:|---:|---:|---|",
    ]
    for row in rows:
        powers = ", ".join(f"{n:.3g}" for n in row.exponents)
        verdict = "" if row.right else "**wrong**"
        lines.append(
            f"| {row.number} | {row.kind} | {powers} | {row.period} | {row.changes} | "
            f"{row.printed} | {row.error:.1e} | {row.away:.1e} | {verdict} |"
        )
    return lines


def main(words: Sequence[str]) -> None:
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("--count", type=int, default=COUNT)
    count = reader.parse_args(words).count
    rows = []
    for row in trial(count):
        print(row, file=sys.stderr, flush=True)
        rows.append(row)
    text = "\n".join(page(rows)) + "\n"
    if count == COUNT:
        PAGE.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
