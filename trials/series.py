"""Do the bands of a series hold? Fresh pairs of the class, none of which an answer has seen.

``make trial NAME=series`` draws ten gear pairs (seed fixed before the first run), asks `answers`
for
their series of 64 pairs, and draws 64 others of the same class: the share of these that the stated
bands of 90 % hold, with its binomial interval, goes into trials/records/series.md.
``python trials/series.py 2`` prints two of them.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from math import lcm
from pathlib import Path

import numpy as np

from thermogear import answers, load_case
from thermogear.analysis.order_statistics import Estimate, proportion

SEED = 54_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "series.md"
PAIRS, PARTS = 10, 64
LEAST, MOST = 0.80, 0.97
"""Share of fresh pairs that a band of 90 % may hold: its ends and what is counted are of 64."""
BANDS = {
    "error of the turn [µm]": ("transmission_error", "turn", "turn_error", 1e6),
    "error that repeats with the mesh [µm]": ("transmission_error", "mesh", "mesh_error", 1e6),
    "dynamic factor": ("dynamic_factor", "part", "own_dynamic_factor", 1.0),
}
"""Figure -> answer, prefix of its figures, what is stored of each part, and its scale."""


@dataclass(frozen=True)
class Held:
    """One figure of one pair: its band, and the share of fresh pairs in it."""

    teeth: tuple[int, int]
    figure: str
    band: tuple[float, float]
    share: Estimate

    @property
    def row(self) -> str:
        """For the table."""
        return (
            f"| {self.teeth[0]}/{self.teeth[1]} | {lcm(*self.teeth)} | {self.figure} | "
            f"{self.band[0]:.3g} to {self.band[1]:.3g} | {100 * self.share.value:.0f} | "
            f"{100 * self.share.low:.0f} to {100 * self.share.high:.0f} |"
        )


def drawn_text(number: int) -> tuple[tuple[int, int], str]:
    """Teeth and case file of pair ``number``."""
    rng = np.random.default_rng([SEED, number])
    teeth = int(rng.integers(17, 41)), int(rng.integers(20, 61))
    module = float(rng.choice([1.5, 2.0, 3.0, 4.0]))
    torque = rng.uniform(0.05, 0.15) * (1e3 * 10.0 * module) * 0.5e-3 * module * teeth[0]
    text = f"""[gears]
module = "{module} mm"
face_width = "{10 * module} mm"
[gears.pinion]
teeth = {teeth[0]}
[gears.wheel]
teeth = {teeth[1]}
[oil]
name = "ISO VG 100"
temperature = "80 degC"
[flanks]
accuracy = {int(rng.integers(4, 8))}
[operating]
speed = "{rng.uniform(1500.0, 9000.0):.0f} rpm"
torque = "{torque:.1f} N m"
[grid]
path_positions = 41
mesh_positions = 48
harmonics = 12
"""
    return teeth, text


def held(number: int, parts: int = PARTS) -> Iterator[Held]:
    """What the bands of pair ``number`` hold of as many fresh ``parts``."""
    teeth, text = drawn_text(number)
    told, fresh = (
        answers(load_case(text, [f"flanks.parts={parts}", f"flanks.seed={seed}"]))
        for seed in (1, 2)
    )
    by = {one.name: one.figures for one in told.answers}
    for figure, (name, prefix, stored, scale) in BANDS.items():
        low, high = (by[name][f"{prefix}_{end}"] for end in ("low", "high"))
        values = scale * fresh["series"][stored].values[0]
        values = values[0] if values.ndim > 1 else values
        inside = int(((values >= low) & (values <= high)).sum())
        yield Held(teeth, figure, (low, high), proportion(inside, of=parts))


def main(count: int, page: Path | None) -> int:
    """Hold ``count`` pairs, print or write the table, and return how many bands fail for sure."""
    warnings.simplefilter("ignore")
    rows = [row for number in range(count) for row in held(number)]
    out = [row for row in rows if not LEAST <= row.share.value <= MOST]
    sure = [row for row in out if row.share.high < LEAST or row.share.low > MOST]
    mean = 100.0 * float(np.mean([row.share.value for row in rows]))
    text = f"""# Series: do the stated bands hold fresh pairs?


Made by `make trial NAME=series`, seed {SEED}: gears of 17 to 60 teeth, modules of 1.5 to 4 mm, 50
to 150
N/mm, classes 4 to 7, 1500 to 9000 rpm. *Band*: what `answers` says of {PARTS} pairs, 90 % of all
lie in it. *Held*: the share of {PARTS} other pairs of the class, drawn with another seed, that do,
with its binomial interval of 95 %. Both have the same population, which is assumed: this tests the
statistics and no works.

| teeth | mesh periods | figure | band | held [%] | interval [%] |
|---|---:|---|---|---:|---|
{chr(10).join(row.row for row in rows)}

{len(rows)} bands. Held in the mean: {mean:.1f} %. Outside 80 to 97 %: {len(out)}, with the
whole interval: {len(sure)}. Band and count are of {PARTS} pairs each: both scatter.
"""
    if page is None:
        print(text)
    else:
        page.write_text(text, encoding="utf-8")
    return len(sure)


if __name__ == "__main__":
    asked = sys.argv[1:]
    main(int(asked[0]) if asked else PAIRS, None if asked else PAGE)
