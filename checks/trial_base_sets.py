"""Random base sets that meet the thesis's table 4.2, each statement judged for each of them."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from thermogear.case.case import load_example
from thermogear.thesis import base_sets, motions

TARGET = Path(__file__).parents[1] / "src" / "thermogear" / "thesis" / base_sets.TABLE


def main() -> None:
    began, kept, count = time.process_time(), [], 0
    rows = motions.rows(load_example("table-4.2"), load_example("section-4.1"))
    for columns in base_sets.drawn(base_sets.DRAWS):
        count += len(columns["frequency"])
        for place in base_sets.meeting(columns, rows.ends):
            values = {name: float(columns[name][place]) for name in base_sets.COLUMNS}
            kept.append(base_sets.judged(values, rows))
        print(f"{count} drawn, {len(kept)} meet the table", file=sys.stderr)
        if kept:
            TARGET.write_text(base_sets.text_of(kept), "utf-8")
    seconds = time.process_time() - began
    print(f"{len(kept)} of {count} sets from seed {base_sets.SEED}, {seconds:.0f} s: {TARGET}")
    for number in base_sets.STATEMENTS:
        hits, low, high = base_sets.share(kept, number)
        print(f"{number}: {hits} ({100 * low:.0f} to {100 * high:.0f} %)")


if __name__ == "__main__":
    main()
