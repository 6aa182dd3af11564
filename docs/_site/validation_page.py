"""The validation page, from what the tests measured (`make validation`)."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parents[1] / "validation.json"

FLOORS = {
    "gears": "Geometry, contact, stiffness",
    "shafts": "Shafts and bearings",
    "heat": "Friction, film, temperature, growth",
    "mesh": "The mesh cycle and the heat balance",
    "verify": "Finite elements",
    "dynamics": "Equations of motion",
    "analysis": "Orbits, bifurcations, exponents, labels",
    "case": "Case files",
    "results": "Stores",
    "study": "From case to result",
    "signals": "Spectra and lines",
    "measured": "Records",
    "thesis": "The thesis",
    "base": "Materials and excitation",
}

HEAD = """\
# Validation

What the tests compare, with what, how close it must be, and how close it came. Every line is a
test that fails when the third column leaves the fourth. The numbers are those the
tests measured in the run named here; `make validation` measures them again and writes this page's
data (`docs/validation.json`). Nothing on this page is typed by hand.

"Computed apart" means: by another program, before this one was written, and kept as numbers in the
tests. A line that several cases of one test share shows the worst of them.

"""


def number(value: float) -> str:
    """Two significant digits, short."""
    if value == 0.0:
        return "0"
    text = f"{value:.2g}"
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}\u00a0×\u00a010{raised(int(exponent))}" if exponent else text


def raised(power: int) -> str:
    """A power as a superscript."""
    return str(power).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _cell(text: str) -> str:
    return text.replace("|", "\\|").replace("*", "\\*").replace("_", "\\_").replace("$", "\\$")


def _unit(unit: str) -> str:
    return {"1": "", "": "", "%": "\u00a0%"}.get(unit, f"\u00a0{unit}")


def floor_of(test: str) -> str:
    """The floor a test of tests/<floor>/ stands for."""
    return test.split("/")[1]


def merged(entries: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """One line for the cases of a parametrised test that compare the same: the worst of them.

    The worst is the one that comes nearest to what is allowed.
    """
    lines: dict[tuple[str, ...], dict[str, Any]] = {}
    for one in entries:
        test = one["test"].split("[")[0]
        key = (test, one["quantity"], one["against"], one["unit"])
        known = lines.get(key)
        if known is None:
            lines[key] = one | {"test": test, "cases": 1}
        else:
            known["cases"] += 1
            if one["worst"] * known["tolerance"] > known["worst"] * one["tolerance"]:
                known |= {"worst": one["worst"], "tolerance": one["tolerance"]}
    return list(lines.values())


def _rows(entries: Iterable[dict[str, Any]]) -> str:
    text = "| what | compared with | worst seen | must be within | test |\n|---|---|---|---|---|\n"
    for one in merged(entries):
        unit = _unit(one["unit"])
        cases = f" ({one['cases']} cases)" if one["cases"] > 1 else ""
        file, _, rest = one["test"].partition("::")
        name = rest.rpartition("::")[2]
        text += (
            f"| {_cell(one['quantity'])}{cases} | {_cell(one['against'])} "
            f"| {number(one['worst'])}{unit} | {number(one['tolerance'])}{unit} "
            f"| `{file.removeprefix('tests/')}` `{name}` |\n"
        )
    return text


def validation() -> dict[str, str]:
    """The page, a table per floor."""
    stored = json.loads(RESULTS.read_text("utf-8"))
    entries = stored["entries"]
    lines = merged(entries)
    tests = {one["test"] for one in lines}
    text = HEAD + (
        f"{len(lines)} comparisons ({len(entries)} cases) in {len(tests)} tests; "
        f"thermogear {stored['thermogear']}, Python {stored['python']}, "
        f"numpy {stored['numpy']}, scipy {stored['scipy']}, "
        f"numba {stored['numba']}. A difference without a unit is relative or dimensionless.\n\n"
    )
    for floor, title in FLOORS.items():
        own = [one for one in entries if floor_of(one["test"]) == floor]
        if own:
            text += f"## {title}\n\n{_rows(own)}\n"
    return {"generated/validation.md": text}
