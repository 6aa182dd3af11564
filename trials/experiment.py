"""The thesis's experiment on 256 sampled drive trains: the answer that its page reads, minutes."""

from __future__ import annotations

import csv
import io
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rig_answer import results
from rig_samples import (
    ASSUMED,
    DIGITS,
    SAMPLES_STORED,
    SEED,
    SEEN,
    SPEEDS,
    TABLE,
    Shown,
    trains,
)

from thermogear.base.arrays import Dataset
from thermogear.base.display import MICROMETRE
from thermogear.thesis import experiment

TARGET = Path(experiment.__file__).with_name(experiment.TABLE)


def header() -> list[str]:
    """Names of the columns of the stored table."""
    found = [*(one.name for one in ASSUMED), *(f"label_{rpm:.0f}" for rpm in SPEEDS)]
    for place in SEEN:
        found += [f"{place}_channel", *(f"{place}_{rpm:.0f}" for rpm in SPEEDS)]
        found += [f"{place}_most_{rpm:.0f}" for rpm in SPEEDS]
    return found


def row(one: Shown) -> list[str]:
    """A line of the stored table: inputs in the units of their ranges, amplitudes in um."""
    found = [f"{v:.{DIGITS}g}" for v in one.values.values()]
    found += list(one.labels)
    for place in SEEN:
        found.append(one.channels[place])
        found += [f"{MICROMETRE(v):.{DIGITS}g}" for v in (*one.amplitudes[place], *one.most[place])]
    return found


def text_of(rows: Sequence[Shown]) -> str:
    """The table of ``rows`` as it is stored."""
    into = io.StringIO()
    writer = csv.writer(into, lineterminator="\n")
    writer.writerow(header())
    writer.writerows(row(one) for one in rows)
    return into.getvalue()


def put(found: Dataset) -> None:
    """The answer where the page reads it."""
    TARGET.write_text(json.dumps(found.to_dict(), ensure_ascii=False, indent=0) + "\n", "utf-8")


def main() -> None:
    began, rows = time.process_time(), []
    for one in trains():
        rows.append(one)
        print(f"{len(rows)} of {SAMPLES_STORED}: {', '.join(one.labels)}", file=sys.stderr)
    TABLE.write_text(text_of(rows), "utf-8")
    found = results(rows)
    put(found)
    seconds = time.process_time() - began
    print(f"{len(rows)} drive trains from seed {SEED}, {seconds:.0f} s of processor time: {TARGET}")
    print(f"motions: {found.attrs['motions']}; without one: {found.attrs['lost']} trains")
    print(found.attrs["sentence"])
    print(found.attrs["deciding"])


if __name__ == "__main__":
    main()
