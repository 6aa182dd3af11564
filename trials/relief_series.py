"""Does the relief of a series help parts it was not made for? Six own pairs at two loads.

``make trial NAME=relief_series`` draws six gear pairs (seed fixed before the first run), designs
the tip relief of each for two loads, and judges it by 64 parts that neither the design nor its own
judgement has seen: the printed gain against theirs, the parts made worse, and the regret against
the best of a grid, which is chosen on these parts themselves. Writes
trials/records/relief_series.md. ``python trials/relief_series.py 2`` prints two of them.
"""

from __future__ import annotations

import sys
import warnings
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from thermogear import load_case
from thermogear.case.case import GearCase
from thermogear.case.thermal_state import HOT
from thermogear.gears.deviations import Relief
from thermogear.mesh.thermal import HotPair
from thermogear.study.relief import one_point, relief_survey
from thermogear.study.relief_series import Ground, PartErrors, drawn_periods, ratios
from thermogear.study.series import series_parts

SEED = 56_2026
PAGE = Path(__file__).parents[1] / "trials" / "records" / "relief_series.md"
PAIRS, SEEN, PARTS = 6, 80, 64
ERRORS, WORSE, REGRET = 2.0, 12, 0.01
"""Allowed: standard errors of the difference between two gains, parts made worse, mean regret."""


@dataclass(frozen=True)
class Judged:
    """A relief of one pair, judged by fresh parts."""

    teeth: tuple[int, int]
    grade: int
    printed: float
    error: float
    fresh: float
    fresh_error: float
    worse: int
    regret: float

    @property
    def apart(self) -> float:
        """Printed gain less that of the fresh parts, in standard errors of the difference."""
        error = float(np.hypot(self.error, self.fresh_error))
        return (self.printed - self.fresh) / error if error else 0.0  # no relief: no gain

    @property
    def row(self) -> str:
        """For the table."""
        return (
            f"| {self.teeth[0]}/{self.teeth[1]} | {self.grade} | {100 * self.printed:.1f} ± "
            f"{100 * self.error:.1f} | {100 * self.fresh:.1f} ± {100 * self.fresh_error:.1f} | "
            f"{self.apart:+.1f} | {self.worse} | {100 * self.regret:+.2f} |"
        )


def drawn_case(number: int) -> tuple[GearCase, tuple[float, float]]:
    """Pair ``number`` and its two torques [N m]."""
    rng = np.random.default_rng([SEED, number])
    teeth = int(rng.integers(17, 41)), int(rng.integers(20, 61))
    module = float(rng.choice([2.0, 3.0, 4.0, 6.0]))
    torque = rng.uniform(0.1, 0.3) * (1e3 * 10.0 * module) * 0.5e-3 * module * teeth[0]
    case = load_case(f"""[gears]
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
speed = "1500 rpm"
torque = "{torque:.1f} N m"
""")
    assert isinstance(case, GearCase)
    return case, (0.6 * torque, torque)


def judged(number: int) -> Judged:
    """The relief of pair ``number``, judged by parts 80 to 143 of its series."""
    case, torques = drawn_case(number)
    result = relief_survey(case, torque=torques)
    gain, rows = result.table("gains")["series"], result.table("reliefs")
    designed = [
        Relief(gear, amount=row["amount_m"], length=row["length_m"]) for gear, row in rows.items()
    ]
    model = case.models[0].override(stiffness="loaded")
    hots = [
        HotPair(case.pair, one_point(HOT.operating(case, case.models[0]), torque), model)
        for torque in torques
    ]
    parts = series_parts(case, SEEN + PARTS)[SEEN:]
    fresh = PartErrors(hots, parts, periods=drawn_periods(case.pair, 77), positions=32)
    before = fresh.rms(())
    ratio = ratios(before, after=fresh.rms(designed))
    most = 2.0 * max(row["amount_m"] for row in rows.values()) or 50e-6
    grid = Ground(case.pair, shape="linear", largest=most, symmetric=True)
    tried = [float(ratios(before, after=fresh.rms(grid.reliefs(x))).mean()) for x in grid.grid()]
    return Judged(
        (case.pair.pinion.teeth, case.pair.wheel.teeth),
        int(case.accuracy or 0),
        printed=gain["gain"],
        error=gain["standard_error"],
        fresh=1.0 - float(ratio.mean()),
        fresh_error=float(ratio.std(ddof=1)) / PARTS**0.5,
        worse=int((ratio > 1.0).sum()),
        regret=float(ratio.mean()) / min(1.0, *tried) - 1.0,
    )


def main(count: int, page: Path | None) -> int:
    """Judge ``count`` pairs, print or write the table, and return what is beyond the allowed."""
    warnings.simplefilter("ignore")
    rows = []
    for number in range(count):
        rows.append(judged(number))
        print(rows[-1].row, flush=True)
    regret = float(np.mean([row.regret for row in rows]))
    apart = sum(abs(row.apart) > ERRORS for row in rows)
    worse = sum(row.worse > WORSE for row in rows)
    text = f"""# Relief of a series, judged by parts it has not seen

Made by `make trial NAME=relief_series`, seed {SEED}: gears of 17 to 60 teeth, modules of 2 to 6
mm, 100
to 300 N/mm, classes 4 to 7, each at two loads, the lesser .6 of the greater. *Printed*: gain that
`relief` states, of its 64 judging parts, with its standard error [%]: what the relief takes off the
root mean square of the transmission error within a mesh period. *Fresh*: the same of {PARTS} other
parts and other mesh periods. *Apart*: their difference over its standard error. *Worse*: fresh
parts, of {PARTS}, less even than without relief. *Regret*: mean error of the fresh parts over that
of the best of 36 reliefs alike on both gears, which is chosen on them.

| teeth | class | printed [%] | fresh [%] | apart | worse | regret [%] |
|---|---:|---:|---:|---:|---:|---:|
{chr(10).join(row.row for row in rows)}

{count} pairs. More than {ERRORS:g} standard errors apart: {apart}. More than {WORSE} parts worse:
{worse}. Mean regret {100 * regret:+.2f} % (allowed {100 * REGRET:g} %).
"""
    if page is None:
        print(text)
    else:
        page.write_text(text, encoding="utf-8")
    return apart + worse + int(regret > REGRET)


if __name__ == "__main__":
    asked = sys.argv[1:]
    sys.exit(main(int(asked[0]) if asked else PAIRS, None if asked else PAGE) > 0)
