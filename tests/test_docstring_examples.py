"""The examples in the docstrings run, and the public functions that have none are named here.

An example runs where its module's own names, ``np``, ``math`` and every name of
``from thermogear import ...`` are known. Numbers are printed rounded, so that every CPU prints them
alike.
"""

from __future__ import annotations

import ast
import doctest
import importlib
import math
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import thermogear

SOURCE = Path(thermogear.__file__).parent
FORMULAS = (
    *("gears", "heat", "signals"),
    *(f"dynamics.{name}" for name in ("models", "integrate", "tables")),
)
"""Where every public function has an example; elsewhere every name of ``import thermogear``."""

# The list only shrinks. An entry that has got its example fails the test.
WITHOUT = {
    "case.duty.read_duty": "reads a file; docs/howto/warm_up.md shows one",
    "case.duty.read_measured": "reads a file; docs/howto/warm_up.md shows one",
    "case.rexs.container.read_rexs": "reads a file; docs/howto/rexs.md shows one",
    "measured.readers.read_record": "reads a file; docs/tutorials/own_record.md shows one",
    "measured.reduction.measure": "needs a record; docs/tutorials/own_record.md shows one",
    "dynamics.geared.GearedModel": "takes the matrices of a train; a case makes it",
    "dynamics.return_map.ReturnMap": "a protocol; docs/howto/own_model.md makes two",
    "base.plan.slices": "needs a plan of minutes; docs/howto/many_samples.md shows one",
    "base.errors.ConvergenceError": "no round input makes an iteration fail",
    "base.excitation.Excitation": "made by excitation(), which has an example",
    "dynamics.models.from_excitation": "needs the excitation that excitation() makes",
    "gears.mesh_system.as_drawn": "its phases are packed bytes, made by MeshSystem",
    "heat.free_convection.with_free_convection": "takes six objects; heat_balance calls it",
    "heat.friction.outside_range": "takes a whole ContactState; laws_together calls it",
    "heat.friction.beyond": "takes a whole ContactState; laws_together calls it",
    "heat.friction.laws_together": "takes a whole ContactState; docs/howto/friction_law.md",
    "heat.friction.benedict_kelley_as_printed": "a misprint kept on show, no value to use",
    "heat.thesis_profile.flank_growth_as_printed": "a misprint kept on show, no value to use",
    "heat.thesis_profile.profile_as_printed": "a misprint kept on show, no value to use",
}
LATER = ("results", "study", "views")
"""Floors whose names need a stored result or a run of seconds: the tutorials run those."""


@cache
def package_names() -> dict[str, object]:
    named = {name: getattr(thermogear, name) for name in thermogear._HOME}
    return named | {"np": np, "math": math}


def sources() -> Iterator[tuple[str, str]]:
    """Every module's dotted name below ``thermogear`` and its text."""
    for file in sorted(SOURCE.rglob("*.py")):
        yield ".".join(file.relative_to(SOURCE).with_suffix("").parts), file.read_text("utf-8")


def examples_of(tree: ast.Module) -> str:
    """The lines of every example in a module, its answers left out."""
    kinds = ast.Module | ast.ClassDef | ast.FunctionDef
    docs = [ast.get_docstring(node) or "" for node in ast.walk(tree) if isinstance(node, kinds)]
    return "\n".join(x for x in "\n".join(docs).splitlines() if x.startswith((">>> ", "... ")))


def wanted(module: str, tree: ast.Module) -> Iterator[str]:
    """The names of a module that need an example and have none in their own docstring."""
    formulas = any(f"{module}.".startswith(f"{part}.") for part in FORMULAS)
    for node in tree.body:
        if not isinstance(node, ast.FunctionDef | ast.ClassDef) or node.name.startswith("_"):
            continue
        if ">>> " in (ast.get_docstring(node) or ""):
            continue
        if thermogear._HOME.get(node.name) == f"thermogear.{module}":
            if not module.startswith(LATER):
                yield node.name
        elif formulas and isinstance(node, ast.FunctionDef) and not module.endswith("_kernel"):
            yield node.name


def without_example() -> set[str]:
    """Names that need an example, and no example of their module uses them either."""
    found = set()
    for module, text in sources():
        tree = ast.parse(text)
        used = set(re.findall(r"\w+", examples_of(tree)))
        found |= {f"{module}.{name}" for name in wanted(module, tree) if name not in used}
    return found


def test_public_functions_have_an_example() -> None:
    assert without_example() == WITHOUT.keys()


@pytest.mark.parametrize("name", [name for name, text in sources() if ">>> " in text])
def test_examples_of_a_module(name: str) -> None:
    module = importlib.import_module(f"thermogear.{name}")
    places = package_names() | vars(module)
    runner = doctest.DocTestRunner(verbose=False)
    said: list[str] = []
    count = 0
    for case in doctest.DocTestFinder(exclude_empty=True).find(module, globs=places):
        count += len(case.examples)
        runner.run(case, out=said.append)
    assert count > 0
    assert runner.failures == 0, "".join(said)
