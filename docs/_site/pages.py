"""The pages made from data, written before sphinx looks for its sources.

Each function returns {path under docs/: text}. They need the package alone, not sphinx, so the
tests make them too. :func:`write` touches only what changed, so that sphinx reads no page twice.
"""

from __future__ import annotations

import ast
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import thermogear
from _site.case_file import case_file
from _site.command_pages import commands
from _site.errata_page import errata_page
from _site.limits_page import limits
from _site.notices_page import notices
from _site.validation_page import validation

Pages = dict[str, str]
PACKAGE = Path(thermogear.__file__).parent
FLOORS = {
    "base": "errors, vocabulary of stored quantities, materials, oils, the excitation",
    "signals": "spectra, filters, lines, orders",
    "dynamics": "equations of motion with a dead zone, event-exact maps, Runge-Kutta lanes",
    "analysis": "sections, orbits, continuation, Lyapunov exponents, labels, maps, basins",
    "measured": "readers of records, reduction to lines and orders",
    "shafts": "drive train, bearings, modes, statics, response",
    "gears": "geometry, contact, loaded contact, deviations, stiffness",
    "heat": "lubricant, friction, temperature, thermal deformation",
    "mesh": "the choices of the mesh model, the quasi-static cycle, the heat balance",
    "case": "what a case file holds: schema, units, defaults, families of operating points",
    "results": "what is stored: results, files, stores of long work, workers",
    "study": "one module for each study: run, motion, orbit, branches, sweeps, comparisons",
    "thesis": "the claims of the thesis and their evidence",
    "views": "pictures, pages, tables from stored results",
    "front": "the command line",
}
GENERATED = "generated"


def modules(floor: str) -> Iterator[str]:
    """Dotted names of a floor's public modules; packages have no page of their own."""
    for file in sorted((PACKAGE / floor).rglob("*.py")):
        parts = file.relative_to(PACKAGE).with_suffix("").parts
        if not any(part.startswith("_") for part in parts):
            yield ".".join(("thermogear", *parts))


def first_line(module: str) -> str:
    """The first sentence of a module's docstring."""
    file = (PACKAGE.parent / Path(*module.split("."))).with_suffix(".py")
    text = ast.get_docstring(ast.parse(file.read_text("utf-8"))) or ""
    return text.split("\n\n")[0].replace("\n", " ").replace("|", r"\|").replace("*", r"\*")


def _title(text: str) -> str:
    return f"{text}\n{'=' * len(text)}\n\n"


def reference() -> Pages:
    """A page per module, an index per floor, the public names."""
    made: Pages = {}
    for floor, words in FLOORS.items():
        names = list(modules(floor))
        text = _title(f"thermogear.{floor}") + f"{words.capitalize()}.\n\n"
        text += f".. py:module:: thermogear.{floor}\n\n"
        text += ".. toctree::\n   :hidden:\n\n"
        text += "".join(f"   {name}\n" for name in names) + "\n"
        for name in names:
            text += f":doc:`{name.removeprefix('thermogear.' + floor + '.')} <{name}>`\n"
            text += f"   {first_line(name)}\n"
            page = _title(name) + f".. automodule:: {name}\n   :members:\n"
            made[f"{GENERATED}/{name}.rst"] = page
        made[f"{GENERATED}/floor_{floor}.rst"] = text
    homes = thermogear._HOME
    text = _title("Public names")
    text += "What ``from thermogear import ...`` offers; each loads its module when first used.\n\n"
    for name, home in homes.items():
        text += f"* :py:obj:`{name} <{home}.{name}>` of :doc:`{home}`\n"
    made[f"{GENERATED}/names.rst"] = text
    return made


MAKERS: tuple[Callable[[], Pages], ...] = (
    reference,
    commands,
    case_file,
    limits,
    notices,
    validation,
    errata_page,
)


def write(docs: Path) -> None:
    """Write every generated page under ``docs`` and remove those no longer made."""
    made: Pages = {}
    for maker in MAKERS:
        made |= maker()
    for path, text in made.items():
        file = docs / path
        file.parent.mkdir(parents=True, exist_ok=True)
        if not file.exists() or file.read_text("utf-8") != text:
            file.write_text(text, "utf-8")
    for file in (docs / GENERATED).rglob("*.*"):
        if str(file.relative_to(docs)) not in made:
            file.unlink()


def load(name: str) -> dict[str, object]:
    """A JSON file that lies in docs/."""
    found: dict[str, object] = json.loads((Path(__file__).parents[1] / name).read_text("utf-8"))
    return found
