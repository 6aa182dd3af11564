"""Base sets that the document could have used: drawn at random, kept where they meet its table.

Table 4.2 states the ranges of damping, frequency and stiffness amplitude and not the set they start
from. What holds for one set found by search need not hold for another. So the set is drawn from
ranges that are ours, kept where all three rows begin at period-1 and end in chaos (which stands for
the document's quasi-periodic motion), and every statement of section 4 becomes a share of the sets
kept. `make trial NAME=base_sets` draws and judges them; independent draws, so that the interval
of a share is exact.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files

TABLE = "base_sets.csv"
CONFIDENCE = 0.95
STATEMENTS = (
    "4.1.3", "4.1.4", "4.1.5", "4.1.6", "4.1.8", "4.1.7", "4.2.3", "4.2.6", "4.2.8", "4.2.10",
    "4.2.11", "4.2.12", "4.2.13", "4.3.2", "4.3.4", "4.3.5", "4.3.7", "4.3.8", "4.3.9", "4.3.10",
)  # fmt: skip
"""Numbers of the claims that are judged for every set and stored."""
TORUS = ("4.1.9", "4.2.2", "4.2.4", "4.2.9", "4.3.6")
"""Claims of quasi-periodic motion: false in every set, as any damping shrinks every area [1]."""
COLUMNS = ("damping_ratio", "frequency", "stiffness_amplitude", "mean_force", "force_amplitude")


@dataclass(frozen=True)
class Judged:
    """A base set that meets the table, and whether each statement holds for it, by its number.

    A statement is missing that could not be judged, as a bifurcation was lost on the way.
    """

    values: Mapping[str, float]
    holds: Mapping[str, bool]


def stored() -> list[Judged]:
    """The sets that come with the package; `make trial NAME=base_sets` computes them."""
    text = (files("thermogear.thesis") / TABLE).read_text(encoding="utf-8")
    return [
        Judged(
            {name: float(line[name]) for name in COLUMNS},
            dict.fromkeys(TORUS, False)
            | {number: line[number] == "1" for number in STATEMENTS if line[number]},
        )
        for line in csv.DictReader(io.StringIO(text))
    ]


def share(sets: Sequence[Judged], number: str) -> tuple[int, float, float]:
    """(sets for which a statement holds, lower and upper end of the share's 95 % interval).

    Sets for which it is not judged are misses for the lower end and hits for the upper.
    """
    hits = sum(judged_set.holds.get(number, False) for judged_set in sets)
    return hits, *interval(
        hits, count=len(sets), lost=sum(number not in judged_set.holds for judged_set in sets)
    )


def interval(hits: int, *, count: int, lost: int = 0) -> tuple[float, float]:
    """Exact (Clopper-Pearson) 95 % interval of a share, ``lost`` of ``count`` not known.

    The lost ones are misses for the lower end and hits for the upper.

    >>> low, high = interval(0, count=256)
    >>> low, round(high, 4)
    (0.0, 0.0143)
    """
    from scipy.stats import beta

    half, most = 0.5 * (1.0 - CONFIDENCE), hits + lost
    low = 0.0 if hits == 0 else float(beta.ppf(half, hits, count - hits + 1))
    high = 1.0 if most == count else float(beta.ppf(1.0 - half, most + 1, count - most))
    return low, high
