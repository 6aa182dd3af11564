"""Random base sets that meet the thesis's table 4.2, each statement judged for each of them."""

from __future__ import annotations

import csv
import io
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from thermogear.analysis.labels import label, labels
from thermogear.base.parameters import long_name
from thermogear.case.case import load_example
from thermogear.dynamics.models import TorsionalModel
from thermogear.thesis import motions
from thermogear.thesis.base_sets import COLUMNS, STATEMENTS, TABLE, Judged, share

Floats = NDArray[np.float64]
TARGET = Path(__file__).parents[1] / "src" / "thermogear" / "thesis" / TABLE
DRAWS, SEED = 100_000, 480
BLOCK = 20_000
"""Draws judged at once."""
RANGES = {
    "damping_ratio": (0.10, 0.18),
    "frequency": (1.1, 1.3),
    "stiffness_amplitude": (0.1, 0.9),
    "force_amplitude": (0.05, 5.0),
    "force_ratio": (0.5, 200.0),
}
"""Uniform over the first three (the ranges of the document's table), over the logarithm of the
others: |F_h| in half backlashes, of either sign, and |F_h|/F_m. Ours: the document states none."""
DIGITS = 9
VALUES = 61
"""Values of a row's diagram."""
FLIPS = 4
"""Period doublings located on each row."""
MANY_POINTS = 8
"""Points of a section beyond which it is read as spread out [1]; chosen."""
NEARLY = 0.1
"""Relative shift of a first flip that is read as nearly the same [1]; chosen."""
ENDS = (("chaotic", 1), ("period-1", 0))
"""(label, place of the value in a row) that a set must show; the rarer one is asked first."""
PERIODS = 4000
STARTS = 2


def drawn(count: int, *, seed: int = SEED) -> Iterator[dict[str, Floats]]:
    """``count`` base sets as columns of the model, in blocks."""
    rng = np.random.default_rng(seed)
    for first in range(0, count, BLOCK):
        size = min(BLOCK, count - first)
        columns = {name: rng.uniform(*RANGES[name], size) for name in list(RANGES)[:3]}
        size_of_force, ratio = (
            np.exp(rng.uniform(np.log(low), np.log(high), size))
            for low, high in list(RANGES.values())[3:]
        )
        columns["mean_force"] = size_of_force / ratio
        columns["force_amplitude"] = size_of_force * rng.choice([-1.0, 1.0], size)
        yield {name: _rounded(values) for name, values in columns.items()}


def _rounded(values: Floats) -> Floats:
    """As they are stored, so that a stored set is computed again alike."""
    return np.array([float(f"{value:.{DIGITS}g}") for value in values])


def meeting(
    columns: Mapping[str, Floats], ends: Mapping[str, tuple[float, float]]
) -> NDArray[np.int64]:
    """Places of the sets whose rows all begin at period-1 and end in chaos.

    ``ends``: row -> its first and last value, as :class:`~thermogear.thesis.motions.Rows` has it.
    """
    left = np.arange(len(columns["frequency"]))
    for name, place in ENDS:
        for row, values in ends.items():
            if left.size:
                lanes = {key: column[left] for key, column in columns.items()}
                lanes[long_name(row)] = np.full(left.size, values[place])
                model = TorsionalModel(**lanes)
                settled = labels(
                    model, cap=PERIODS, follow=PERIODS, starts=STARTS, batch_periods=100
                )
                left = left[[motion.name == name for motion in settled]]
    return left


def judged(values: Mapping[str, float], rows: motions.Rows) -> Judged:
    """Which statements of section 4 hold for the base set of ``values`` [1].

    Section 4.1 has a frequency of its own: here the middle between the first period doubling over
    frequency without heat and with the document's. ``rows``: ends of the rows and heat's numbers.
    """
    base = replace(rows, base=dict(values))
    diagrams = motions.diagrams(base, VALUES)
    labels_along = {
        key: motions.sequence(data, key.startswith("zeta")) for key, data in diagrams.items()
    }
    zeta, omega, epsilon = (set(labels_along[f"{row}/none"]) for row in motions.SWEPT)
    located = motions.flips(base, FLIPS)
    flips = located["value"]
    cold, hot = (flips.sel(heat=heat, flip=1).values for heat in ("none", "thesis"))
    # period doublings of a row's cascade, those just before the document's range too
    counts = {heat: np.isfinite(flips.sel(heat=heat).values).sum(axis=-1) for heat in motions.HEATS}
    turns = [0, 0]
    if hot[1] > cold[1]:
        middle = 0.5 * (cold[1] + hot[1])
        turns = [label(base.model(heat, frequency=middle)).period for heat in ("none", "thesis")]
    alternates = turns[0] == 1 and turns[1] > 1
    scattered = {
        heat: max(motions.scatter(diagrams[f"{row}/{heat}"]) for row in motions.SWEPT)
        for heat in ("none", "thesis")
    }
    swings = [motions.swing(base.model("none", frequency=f))[0] for f in rows.ends["omega"]]
    holds = {
        **dict.fromkeys(("4.1.3", "4.1.4", "4.1.5", "4.1.6", "4.1.8"), alternates),
        "4.1.7": alternates and turns[1] > MANY_POINTS,
        "4.2.3": motions.stability_falls(diagrams["zeta/none"]),
        "4.2.6": len(omega) > 3,
        "4.2.8": "period-2" in epsilon,
        "4.2.10": {"period-1", "period-2", "chaotic"} <= zeta,
        "4.2.11": {"period-1", "period-2"} <= omega and np.isfinite(cold[1]),
        "4.2.12": swings[0] > swings[1],
        "4.2.13": {"period-1", "period-2", "period-4", "chaotic"} <= epsilon,
        "4.3.2": counts["none"].min() > 0 and np.array_equal(counts["none"], counts["thesis"]),
        "4.3.4": "period-2" in zeta,
        "4.3.5": "period-4" in zeta,
        "4.3.7": "chaotic" in zeta,
        # a flip that is not there is nan, and no statement about it holds
        "4.3.8": np.all(np.abs(hot / cold - 1.0) < NEARLY),
        "4.3.9": scattered["thesis"] > scattered["none"],
        "4.3.10": hot[0] > cold[0],
    }
    if located["lost"].sel(heat=["none", "thesis"]).values.any():
        del holds["4.3.2"]
    return Judged(values, {number: bool(value) for number, value in holds.items()})


def text_of(sets: Sequence[Judged]) -> str:
    """The table of ``sets`` as it is stored: values, then 1 or 0 for each statement."""
    into = io.StringIO()
    writer = csv.writer(into, lineterminator="\n")
    writer.writerow([*COLUMNS, *STATEMENTS])
    for judged_set in sets:
        writer.writerow(
            [
                *(judged_set.values[name] for name in COLUMNS),
                *(int(judged_set.holds[n]) if n in judged_set.holds else "" for n in STATEMENTS),
            ]
        )
    return into.getvalue()


def main() -> None:
    began, kept, count = time.process_time(), [], 0
    rows = motions.rows(load_example("table-4.2"), load_example("section-4.1"))
    for columns in drawn(DRAWS):
        count += len(columns["frequency"])
        for place in meeting(columns, rows.ends):
            values = {name: float(columns[name][place]) for name in COLUMNS}
            kept.append(judged(values, rows))
        print(f"{count} drawn, {len(kept)} meet the table", file=sys.stderr)
        if kept:
            TARGET.write_text(text_of(kept), "utf-8")
    seconds = time.process_time() - began
    print(f"{len(kept)} of {count} sets from seed {SEED}, {seconds:.0f} s: {TARGET}")
    for number in STATEMENTS:
        hits, low, high = share(kept, number)
        print(f"{number}: {hits} ({100 * low:.0f} to {100 * high:.0f} %)")


if __name__ == "__main__":
    main()
