"""Counts of a mutation run: docs/mutation.json and checks/records/mutation.md."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
FLOORS = ("signals", "dynamics", "analysis", "gears", "heat", "mesh")
JUDGED = ROOT / "docs" / "mutation_judged.toml"


def wilson(hits: int, number: int) -> tuple[float, float]:
    """95 % interval of a share (Wilson 1927)."""
    if number == 0:
        return 0.0, 1.0
    z, share = 1.959964, hits / number
    middle = share + z * z / (2 * number)
    half = z * math.sqrt(share * (1 - share) / number + z * z / (4 * number * number))
    return (middle - half) / (1 + z * z / number), (middle + half) / (1 + z * z / number)


def counted(verdicts: list[dict[str, Any]]) -> dict[str, Any]:
    """Counts per floor, and the survivors; those judged equivalent stand apart."""
    judged = {
        (j["file"], j["before"], j["after"])
        for j in (tomllib.loads(JUDGED.read_text("utf-8"))["judged"])
    }
    floors: dict[str, dict[str, int]] = {
        floor: {"killed": 0, "survived": 0, "equivalent": 0} for floor in (*FLOORS, "all")
    }
    survivors = []
    for v in verdicts:
        outcome = "killed"
        if v["outcome"] == "survived":
            known = (v["file"], v["before"], v["after"]) in judged
            outcome = "equivalent" if known else "survived"
        if outcome == "survived":
            survivors.append({name: v[name] for name in ("file", "line", "before", "after")})
        for floor in (v["file"].split("/")[2], "all"):
            floors[floor][outcome] += 1
    return {"floors": floors, "survivors": survivors}


def table(counts: dict[str, dict[str, int]]) -> list[str]:
    """Rows of markdown."""
    lines = [
        "| floor | mutants | killed | survived | judged equivalent | score | 95 % interval |",
        "|---|---|---|---|---|---|---|",
    ]
    for floor, n in counts.items():
        number = n["killed"] + n["survived"]
        if number:
            low, high = wilson(n["killed"], number)
            lines.append(
                f"| {floor} | {number} | {n['killed']} | {n['survived']} | {n['equivalent']} | "
                f"{n['killed'] / number:.1%} | {low:.1%} to {high:.1%} |"
            )
    return lines


def write(name: str, verdicts: list[dict[str, Any]], asked: int) -> None:
    """docs/mutation.json and the page made of it."""
    place = ROOT / "docs" / "mutation.json"
    told: dict[str, Any] = json.loads(place.read_text("utf-8")) if place.exists() else {}
    now = {**counted(verdicts), "asked": asked, "done": len(verdicts)}
    told[name] = {"first": told.get(name, {}).get("first", now["floors"]), "now": now}
    place.write_text(json.dumps(told, indent=1, sort_keys=True) + "\n", encoding="utf-8")
    lines = [
        "# Mutation testing of the physics",
        "`make mutate` changes one place of a physics module (an operator, a number, a condition)",
        "and runs the tests of the physics floors that run the module, until one fails; it writes",
        "this page. A mutant that no test can tell from the program is judged, with",
        "its reason, in `docs/mutation_judged.toml` and not counted; one that runs five times too",
        "long counts as killed. Annotations, decorators and the words of errors are left alone.",
    ]
    for sampled, results in sorted(told.items()):
        lines += ["", f"## Sample: {sampled}", *table(results["now"]["floors"])]
        if results["now"]["done"] < results["now"]["asked"]:
            lines += ["", "Stopped after {done} of {asked} mutants.".format(**results["now"])]
        if results["first"] != results["now"]["floors"]:
            lines += ["", "When this sample was first run:", "", *table(results["first"])]
        survivors = results["now"]["survivors"]
        if survivors:
            lines += ["", "Survivors:", ""]
            lines += [
                f"- `{s['file'].removeprefix('src/thermogear/')}:{s['line']}` `{s['before']}` -> "
                f"`{s['after']}`" for s in survivors
            ]  # fmt: skip
    text = "\n".join(lines) + "\n"
    (ROOT / "checks" / "records" / "mutation.md").write_text(text, encoding="utf-8")
