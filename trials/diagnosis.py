"""How often ``diagnose`` errs: false alarms on healthy records, and faults that it finds.

``python trials/diagnosis.py [SETS]``: of each set three healthy records are the baseline; a
fourth healthy one must raise no alarm, and one with a fault of one tooth must name shaft and tooth.
The records are of ``tests/measured/faulty_gears.py``, which shares no code with the package; gears,
tooth and seed of a set are drawn by its number alone.
"""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path

import numpy as np
from scipy import stats

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "measured"))
from faulty_gears import Gears

from thermogear.measured.diagnosis import InAngle, in_angle
from thermogear.measured.record import Channel, Record
from thermogear.study.diagnosis import diagnose

DIPS = (0.1, 0.2, 0.4)
"""Shares of its amplitude that the faulty tooth loses; it is late by a twentieth [pitch]."""


def read(gears: Gears, seed: int, own: int, **fault: float) -> InAngle:
    """A record of the gears whose teeth are drawn by the seed ``own``, with a tacho."""
    x, turns = gears.record(seed, gears=own, **fault)  # type: ignore[arg-type]
    channels = (Channel("a", x, "m/s^2"), Channel("tacho", gears.tacho(turns), "V"))
    record = Record(channels, f"r{seed}", rate=gears.rate, tacho="tacho")
    speed = 2 * np.pi * gears.speed
    return in_angle(record, teeth=gears.teeth[0], speed=speed, pulses_per_turn=1.0)


def one(number: int) -> tuple[str, list[tuple[bool, bool]]]:
    """The verdict on a healthy record; of each fault whether its shaft, and its tooth, is named."""
    drawn = np.random.default_rng(7000 + number)
    gears, seed = Gears(teeth=(11, 13)), 10_000 + 20 * number
    shaft, tooth = 0, int(drawn.integers(11))
    base = [(f"h{k}", partial(read, gears, seed + k, number)) for k in range(3)]
    records = [("healthy", partial(read, gears, seed + 3, number))]
    records += [
        (f"{dip}", partial(read, gears, seed + 4 + k, number, shaft=shaft, tooth=tooth, dip=dip,
                           lag=dip / 20))
        for k, dip in enumerate(DIPS)
    ]  # fmt: skip
    found = diagnose(records, base, teeth=gears.teeth).table("figures")
    places = {row["record"]: row for row in found["places"] if row["shaft"] == "pinion"}
    rows = [
        (row["shaft"] == "pinion", places[row["record"]]["tooth"] == tooth + 1)
        for row in found["verdicts"][1:]
    ]
    return found["verdicts"][0]["verdict"], rows


def main() -> None:
    """Print the counts with their 95 % intervals (Clopper and Pearson)."""
    sets = int(sys.argv[1]) if len(sys.argv) > 1 else 60
    rows = [one(number) for number in range(sets)]
    counts = {"false alarms": sum(verdict == "changed" for verdict, _ in rows)}
    for place, dip in enumerate(DIPS):
        counts[f"dip {dip:g}: shaft"] = sum(found[place][0] for _, found in rows)
        counts[f"dip {dip:g}: tooth"] = sum(found[place][1] for _, found in rows)
    for name, count in counts.items():
        low, high = stats.binomtest(count, sets).proportion_ci()
        print(f"{name}: {count} of {sets} ({100 * low:.1f} to {100 * high:.1f} %)")


if __name__ == "__main__":
    main()
