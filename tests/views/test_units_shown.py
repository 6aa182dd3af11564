"""Numbers are shown in one place: no page, picture or command turns SI into another unit itself."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import thermogear
from thermogear.base import display
from thermogear.base.display import CELSIUS, HERTZ, HOUR, MINUTE, SPEED, Display

SOURCE = Path(thermogear.__file__).parent
FACTORS = (1e9, 1e6, 1e3, 1e-3, 1e-6, 1e-8, 1e-9, 60.0, 100.0, 180.0, 3600.0, 273.15)
"""Factors and zeros between SI and the units people read."""
NAMED = ("RPM", "ZERO_CELSIUS", "STANDARD_GRAVITY")
ALLOWED = {
    # a tolerance beside the size of what is compared, no unit
    "1e-06 * scale",
    "1e-06 * size",
    "1e-09 * rpm[-1]",
    "1e-09 * max(abs(high), 1e-12)",
    "1e-09 * np.max(np.abs(torques))",
    "1e-09 * swing",
    "1e-09 * drawing.module",
    "0.001 * abs(shift)",
    "0.001 * middle",
    "0.001 * abs(right)",
    # half a width for a picture whose values are all alike, no unit
    "max(abs(low), 1.0) * 0.001",
    "0.5 * max(abs(float(values[0])), 1.0) * 0.001",
    # what a person writes in rpm, µm or % is read, not shown; no command loads numpy for it
    "RPM * np.linspace(said.low, said.high, said.count)",
    "float(rpm) * RPM",
    "rpm * RPM",
    "speed * RPM",
    "low * RPM",
    "high * RPM",
    "point[0] * RPM",
    "grid('rpm', rpm) * RPM",
    "1e-06 * largest",
    "number / 100.0",
    "u_data / 100.0",
    # printed in µm, and sampled in N/µm: the stored numbers are made of these
    "1e-06 * float(line[f'{name}_{rpm:.0f}'])",
    "values['housing_mass'] * values['mount_stiffness'] * 1000000.0",
    # the number of a claim, no share
    "100 * (number + 1)",
}


def conversions(tree: ast.AST) -> Iterator[str]:
    """Every product, quotient, sum or difference with a factor or a zero of a unit."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.BinOp):
            continue
        scaled = isinstance(node.op, ast.Mult | ast.Div)
        for side in (node.left, node.right):
            known = isinstance(side, ast.Name) and side.id in NAMED
            if isinstance(side, ast.Constant) and isinstance(side.value, int | float):
                known = float(side.value) in (FACTORS if scaled else (273.15,))
            turns = isinstance(node.op, ast.Div) and ast.unparse(node.right) in {
                "2.0 * np.pi", "2 * np.pi", "2.0 * math.pi", "np.pi",
            }  # fmt: skip
            if known or turns:
                yield ast.unparse(node)
                break


@pytest.mark.parametrize("folder", ["views", "front", "thesis"])
def test_no_unit_is_made_outside_the_display(folder: str) -> None:
    found = {
        f"{path.relative_to(SOURCE)}: {words}"
        for path in sorted((SOURCE / folder).rglob("*.py"))
        for words in conversions(ast.parse(path.read_text("utf-8")))
        if words not in ALLOWED
    }
    assert found == set()


def test_no_page_makes_a_table_by_hand() -> None:
    made = {
        str(path.relative_to(SOURCE))
        for folder in ("views", "front", "thesis")
        for path in (SOURCE / folder).rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Call) and ast.unparse(node.func).rpartition(".")[2] == "Table"
    }
    assert made == {"views/columns.py"}


def test_conversions_are_seen() -> None:
    seen = "f'{1e6 * x:.2f}', v / RPM, t - 273.15, s / 60.0, w / (2.0 * np.pi), y * 1e-3"
    seen += ", f'{100 * part:.0f} %', 100.0 * abs(a / b - 1.0), share * 100.0"
    assert len([*conversions(ast.parse(seen))]) == 9
    unseen = "MICROMETRE(x), 0.5 * x, t - t0, 2.0 * np.pi * k / teeth"
    assert [*conversions(ast.parse(unseen))] == []


def test_shown_numbers_are_exact_where_the_unit_is() -> None:
    assert SPEED(SPEED.stored(1000.0)) == pytest.approx(1000.0, rel=1e-15)
    assert (MINUTE(90.0), HOUR(5400.0), HERTZ(2.0 * np.pi)) == (1.5, 1.5, 1.0)
    assert CELSIUS(293.15) == 20.0
    for shown in vars(display).values():
        if isinstance(shown, Display):
            values = np.array([-1.5, 0.0, 273.15, 1e4])
            assert shown.stored(shown(values)) == pytest.approx(values, rel=1e-14, abs=1e-12)
            assert [shown(value) for value in values.tolist()] == shown(values).tolist()
