"""Does this processor divide rightly? Ends with 1 where it does not.

``python checks/processor.py [SECONDS]`` divides 20 000 pairs of numbers again and again on every
core it may use and holds each quotient against the exact one, rounded to nearest as IEEE 754
asks. A core with a defect gives a few wrong ones, now and then, by some 1e-11: enough to fail
tests that ask for equal bits. ``make test`` asks it when tests fail, and tries those that failed
once more only where the processor was seen to divide wrongly.
"""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

SECONDS = 60.0
TURN = 0.25
"""Seconds on one core before the next."""


def numbers(count: int = 20_000, seed: int = 5) -> tuple[Floats, Floats, Floats]:
    """Dividends, divisors and their exact quotients, rounded once."""
    a, b = np.random.default_rng(seed).uniform(0.1, 3.0, (2, count))
    exact = [float(Fraction(x) / Fraction(y)) for x, y in zip(a.tolist(), b.tolist(), strict=True)]
    return a, b, np.array(exact)


def first_wrong(
    seconds: float, divide: Callable[[Floats, Floats], Floats] = np.divide
) -> tuple[str | None, int]:
    """The first wrong quotient in words, None where all are right; how many were made."""
    a, b, exact = numbers()
    cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else [None]
    end, made = time.monotonic() + seconds, 0
    try:
        while time.monotonic() < end:
            for core in cores:
                if core is not None:
                    os.sched_setaffinity(0, {core})
                turn = time.monotonic() + TURN
                while time.monotonic() < turn:
                    found = divide(a, b)
                    made += found.size
                    wrong = np.flatnonzero(found != exact)
                    if wrong.size:
                        i = wrong[0]
                        x, y, right, got = (float(one[i]) for one in (a, b, exact, found))
                        return f"{x!r}/{y!r} = {right!r}, not {got!r}", made
    finally:
        if cores != [None]:
            os.sched_setaffinity(0, cores)
    return None, made


def main(words: list[str]) -> int:
    """Say what was found."""
    wrong, made = first_wrong(float(words[0]) if words else SECONDS)
    if wrong is None:
        print(f"the processor divided {made:.1e} pairs of numbers rightly")
        return 0
    print(f"THE PROCESSOR DIVIDES WRONGLY, after {made:.1e} quotients: {wrong}")
    print("no number of this machine can be relied on; failed tests are tried once more")
    return 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
