"""The errata of the thesis and its claims, from the package's own results (`make validation`)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from _site.validation_page import raised

UNITS = {"um": "µm", "N/m^2": "N/m²"}
STORED = Path(__file__).parents[1] / "thesis.json"

HEAD = """\
# The thesis: errata and claims

thermogear starts from a thesis on spur gear dynamics with thermal deformation of the tooth profile.
Its summary prints formulas that cannot hold. Below stands what is wrong with each, and what both
forms give for the ready-made rig. Printed formulas are kept under names that end in `_as_printed`
and feed nothing. `make validation` computes this page's numbers anew.

"""


def _cell(text: str) -> str:
    return (
        str(text).replace("|", "\\|").replace("*", "\\*").replace("_", "\\_").replace("$", "\\$")
    ).replace("<", "&lt;")


def _value(value: float | None, unit: str) -> str:
    if value is None:
        return "–"
    mantissa, _, exponent = f"{value:.4g}".partition("e")
    shown = f"{mantissa}\u00a0×\u00a010{raised(int(exponent))}" if exponent else mantissa
    return shown if unit in ("", "1") else f"{shown} {UNITS.get(unit, unit)}"


SEEN = {
    "either": "an accelerometer on a cap or on the housing",
    "cap": "an accelerometer on a cap",
    "housing": "an accelerometer on the housing",
    "journal": "the journal in its bearing",
    "teeth": "the deflection of the teeth",
}


def _experiment(found: dict[str, Any]) -> str:
    """The thesis's experiment on sampled drive trains: the sentence, the shares."""
    text = (
        "\n## The experiment once more, with shafts and bearings\n\n"
        f"{_cell(found['sentence'])} What decides it, by rank correlation: "
        f"{_cell(found['deciding'])}. Motions: {_cell(found['motions'])}. The page that "
        "`thermogear thesis -o DIR` writes has the pictures and every assumption with its range "
        "and reason; `make trial NAME=experiment` samples the trains anew.\n\n"
    )
    limits = list(next(iter(found["shares"].values())))
    text += f"| trains of {found['trains']} that show the printed displacements, growing | "
    text += " | ".join(f"within {limit}" for limit in limits) + " |\n"
    text += "|---|" + "---|" * len(limits) + "\n"
    for place, words in SEEN.items():
        cells = [
            f"{one['hits']:.0f} ({100 * one['share_low']:.1f} to {100 * one['share_high']:.1f} %)"
            for one in found["shares"][place].values()
        ]
        text += f"| {words} | " + " | ".join(cells) + " |\n"
    return text


def errata_page() -> dict[str, str]:
    """Errata with both values, then the claims with their verdicts."""
    stored: dict[str, Any] = json.loads(STORED.read_text("utf-8"))
    text = HEAD + "## Errata\n\n| | as printed | what is wrong | printed form | repaired |\n"
    text += "|---|---|---|---|---|\n"
    for row in stored["errata"]:
        units = row["unit"].split(" | ")
        text += (
            f"| {row['number']} | {_cell(row['printed'])} | {_cell(row['problem'])} "
            f"| {_value(row['value_as_printed'], units[0])} "
            f"| {_value(row['value_repaired'], units[-1])} |\n"
        )
    counts = "; ".join(f"{name}: {number}" for name, number in stored["verdicts"].items())
    text += (
        f"\n## Claims\n\n{len(stored['claims'])} statements, formulas, figures and table entries "
        f"of sections 2 to 6, in our own words. {counts}. `thermogear thesis -o DIR` judges them "
        "anew and writes the full page with every argument and picture.\n"
    )
    text += _experiment(stored["experiment"])
    section = None
    for claim in stored["claims"]:
        if claim["number"].split(".")[0] != section:
            section = claim["number"].split(".")[0]
            text += (
                f"\n### Section {section}\n\n"
                "| | claim | verdict | consistently |\n|---|---|---|---|\n"
            )
        text += (
            f"| {claim['number']} | {_cell(claim['words'])} | {claim['verdict']} "
            f"| {_cell(claim['consistent'])} |\n"
        )
    return {"generated/errata.md": text}
