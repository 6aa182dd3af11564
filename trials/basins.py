"""Shares of basins along a parameter: do their intervals hold what 10 000 other starts find?

``make trial NAME=basins`` computes the shares of 400 random starts at five values of the frequency
for three base sets (seed fixed before the first run), and at each value follows 10 000 other starts
to where they end, one by one with no trap and no rays. Each share is held against the interval, and
the intervals against what 95 % means for so many. Writes trials/records/basins.md; ``--count 500``
prints a short one.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import binom

from thermogear import TorsionalModel, basin_shares
from thermogear.analysis.attractors import attractors_from
from thermogear.analysis.basin_shares import CONFIDENCE, SAME_MOTION, STARTS
from thermogear.analysis.basins import BASIN_RULE

PAGE = Path(__file__).parents[1] / "trials" / "records" / "basins.md"
SEED, OTHER = 81, 82
COUNT = 10_000
BOX = (-2.0, 2.0)
SETS = {
    "two motions": (
        TorsionalModel(
            damping_ratio=0.05, frequency=0.7, stiffness_amplitude=0.1, mean_force=0.1,
            force_amplitude=0.05,
        ),
        (0.55, 0.6, 0.65, 0.7, 0.75),
    ),
    "seven motions": (
        TorsionalModel(
            damping_ratio=0.03, frequency=1.3, stiffness_amplitude=0.3, mean_force=0.1,
            force_amplitude=-0.05,
        ),
        (1.26, 1.28, 1.3, 1.32, 1.34),
    ),
    "light damping": (
        TorsionalModel(
            damping_ratio=0.02, frequency=0.8, stiffness_amplitude=0.2, mean_force=0.2,
            force_amplitude=0.1,
        ),
        (0.5, 0.6, 0.7, 0.8, 0.9),
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Held:
    """The share of a motion at a value, its interval, and the share of the other starts."""

    name: str
    value: float
    period: int
    share: float
    low: float
    high: float
    other: float
    count: int

    @property
    def inside(self) -> bool:
        """Whether the other share lies in the interval, its own error of two deviations aside."""
        own = 2.0 * np.sqrt(max(self.other * (1.0 - self.other), 1e-12) / self.count)
        return bool(self.low - own <= self.other <= self.high + own)

    @property
    def strictly(self) -> bool:
        """Whether it lies in the interval itself."""
        return self.low <= self.other <= self.high


def held(name: str, count: int) -> Iterator[Held]:
    """The shares of one base set, each against those of ``count`` other starts."""
    model, values = SETS[name]
    data = basin_shares(model, "frequency", values, x=BOX, v=BOX, seed=SEED)
    rng = np.random.default_rng(OTHER)
    for place, value in enumerate(data["frequency"].values):
        lanes = model.replace(frequency=float(value)).lanes()
        found, where = attractors_from(lanes, rng.uniform(*BOX, (count, 2)), BASIN_RULE)
        here = data.isel(frequency=place)
        taken = set()
        for n in np.flatnonzero(here["motion_count"].values > 0):
            section = here["motion_section"].values[n]
            period = int(here["motion_period"].values[n])
            own = [k for k, one in enumerate(found) if _same(one, period, section, lanes.unit[0])]
            taken |= set(own)
            other = float(np.isin(where, own).mean())
            low, high = (float(here[f"motion_share_{end}"].values[n]) for end in ("low", "high"))
            share = float(here["motion_share"].values[n])
            yield Held(name, float(value), period, share, low, high, other, count)
        for k in set(range(len(found))) - taken:
            # none of the starts found it: its interval begins at 0
            other, high = float((where == k).mean()), 1.0 - (0.5 - 0.5 * CONFIDENCE) ** (1 / STARTS)
            yield Held(name, float(value), found[k].period, 0.0, 0.0, high, other, count)


def _same(one: object, period: int, section: np.ndarray, unit: np.ndarray) -> bool:
    """Whether an attractor is the motion of that period and section; chaos by its period 0."""
    if one.period != period:
        return False
    gap = np.abs(one.points[:1] - section[np.isfinite(section[:, 0])]) / unit
    return period == 0 or float(gap.max(axis=1).min()) < 1e-6 * SAME_MOTION


def page(rows: Sequence[Held]) -> list[str]:
    """The page's lines."""
    outside = sum(not row.strictly for row in rows)
    chance = float(binom.sf(outside - 1, len(rows), 1.0 - CONFIDENCE)) if outside else 1.0
    lines = [
        "# Shares of basins against other starts", "",
        f"{len(rows)} shares of {STARTS} random starts at five frequencies of {len(SETS)} base "
        f"sets, each with its 95 % interval, against {rows[0].count} other starts followed one by "
        f"one. **{outside} of {len(rows)} lie outside their interval**; as many or more come by "
        f"chance with a probability of {chance:.2g}, were all independent: the starts are the same "
        "at every value, and shares of one value add up to one. "
        f"{sum(not row.inside for row in rows)} lie outside by more than two standard deviations "
        "of the other share. `make trial NAME=basins`.",
        "", "| base set | frequency | period | share [%] | interval [%] | other starts [%] | |",
        "|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    return lines + [
        f"| {row.name} | {row.value:g} | {row.period or 'chaos'} | {100 * row.share:.2f} "
        f"| {100 * row.low:.2f} to {100 * row.high:.2f} | {100 * row.other:.2f} "
        f"| {'' if row.strictly else 'outside'} |"
        for row in rows
    ]


def main() -> int:
    """Run it; without --count the page is written."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=COUNT)
    asked = parser.parse_args()
    rows = [row for name in SETS for row in held(name, asked.count)]
    text = "\n".join(page(rows)) + "\n"
    if asked.count == COUNT:
        PAGE.write_text(text, encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
