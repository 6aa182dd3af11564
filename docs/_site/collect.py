"""Refresh docs/thesis.json: the errata of the rig and the verdicts on the thesis's claims."""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

from thermogear import load_case, run
from thermogear.thesis.errata import errata
from thermogear.thesis.report import build
from thermogear.views.write import save_results

TEXTS = ("number", "place", "kind", "words", "as_in_the_thesis", "consistent", "verdict")


def main(target: Path) -> None:
    """Run the rig and judge every claim; write both as JSON."""
    case = load_case("rig")
    tree = run(case)
    groups = {name: tree[name].to_dataset() for name in ("mesh", "path")}
    with tempfile.TemporaryDirectory() as folder:
        judged = save_results(build(), Path(folder) / "thesis")
    stored = {
        "thermogear": judged["thermogear"],
        "errata": errata(case, groups),
        "verdicts": judged["verdicts"],
        "experiment": judged["experiment"],
        "claims": [{name: row[name] for name in TEXTS} for row in judged["rows"]],
    }
    target.write_text(json.dumps(stored, indent=1, ensure_ascii=False) + "\n", "utf-8")
    print(f"{target}: {len(stored['errata'])} errata, {len(stored['claims'])} claims")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
