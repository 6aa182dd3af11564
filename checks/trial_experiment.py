"""The thesis's experiment on 256 sampled drive trains: the table that its page reads, minutes."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from thermogear.thesis.experiment import SAMPLES_STORED, SEED, TABLE, text_of, trains
from thermogear.thesis.experiment_answer import results

TARGET = Path(__file__).parents[1] / "src" / "thermogear" / "thesis" / TABLE


def main() -> None:
    began, rows = time.process_time(), []
    for one in trains():
        rows.append(one)
        print(f"{len(rows)} of {SAMPLES_STORED}: {', '.join(one.labels)}", file=sys.stderr)
    TARGET.write_text(text_of(rows), "utf-8")
    found = results(rows)
    seconds = time.process_time() - began
    print(f"{len(rows)} drive trains from seed {SEED}, {seconds:.0f} s of processor time: {TARGET}")
    print(f"motions: {found.attrs['motions']}; without one: {found.attrs['lost']} trains")
    print(found.attrs["sentence"])
    print(found.attrs["deciding"])


if __name__ == "__main__":
    main()
