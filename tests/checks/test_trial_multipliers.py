"""Tangents where rolling elements begin and cease to carry; `trial NAME=multipliers` in short."""

from __future__ import annotations

import copy
from dataclasses import replace

import numpy as np
import pytest
from scripts import script

from conftest import AtLength, Compared
from dynamics.geared_trains import moving_six
from dynamics.test_geared_laws import BASE
from thermogear.base.display import shared
from thermogear.dynamics.geared import GearedModel, LocalBearing
from thermogear.dynamics.geared_map import GearedMap

TRIAL = script("trials/multipliers")
SEED = 31
"""Of the states from which the tangents are taken, fixed before the first comparison."""


def on_elements(elements: int, exponent: float) -> tuple[GearedModel, np.ndarray]:
    """The truth's six, its rings replaced by rolling elements as stiff at ten micrometres."""
    model, start, _ = moving_six(copy.deepcopy(BASE) | {"e_re": [2e-5], "rpm": 7000.0})
    strong = 0.6e8 * 1e-5 ** (1.0 - exponent)
    rings = tuple(
        LocalBearing(
            directions=b.directions, coefficient=strong, exponent=exponent, clearance=b.clearance,
            elements=elements, angle=0.3, base=b.base,
        )
        for b in model.bearings
    )  # fmt: skip
    return replace(model, bearings=rings), start


def carrying(model: GearedModel, state: np.ndarray, periods: int) -> int:
    """How often an element begins or ceases to carry."""
    run = GearedMap(model=model).engine.run(state, periods, samples=256)
    total = 0
    for one in model.bearings:
        deep = run.samples[:, : model.size] @ one.directions @ one.rays.T - one.clearance
        total += int(np.sum((deep[1:] > 0.0) != (deep[:-1] > 0.0)))
    return total


@pytest.mark.parametrize(("elements", "exponent"), [(8, 1.5), (9, 10.0 / 9.0)])
def test_tangents_where_elements_enter_and_leave(
    elements: int, exponent: float, compared: Compared
) -> None:
    """The Jacobian of two periods against DOP853's."""
    model, start = on_elements(elements, exponent)
    section, other = GearedMap(model=model), TRIAL.Independent(model, 1e-11)
    rng = np.random.default_rng(SEED)
    unit, usual, finer, laws, entries = section.unit, [], [], [], 0
    for _ in range(3):
        state = section.carry(start + 0.2 * unit * rng.standard_normal(start.size), 10)[-1]
        entries += carrying(model, state, 2)
        true = other.jacobian(state, 2)[1] * unit / unit[:, None]
        for engine, away in ((section, usual), (section.finer, finer)):
            own = engine.visit(state, 2).jacobian * unit / unit[:, None]
            away.append(np.abs(own - true).max() / np.abs(true).max())
            laws.append(np.linalg.slogdet(own)[1] - np.log(section.determinant(2)))
    assert entries > 12
    what = f"tangent, power {exponent:.3g}"
    compared(what, "DOP853 of the variational equations", usual, 1e-5)
    compared(f"{what}, finer steps", "DOP853 of the variational equations", finer, 1e-6)
    compared(f"determinant, power {exponent:.3g}", "exp of the trace", laws, 1e-6)


@pytest.mark.slow
def test_printed_digits_are_right(at_length: AtLength, compared: Compared) -> None:
    count = at_length(1, 40, "multipliers of random trains on rolling bearings")
    rows = [TRIAL.compared(7)] if count == 1 else list(TRIAL.trial(count))
    assert all(row.right and row.changes for row in rows)
    compared("multipliers of random trains", "DOP853", [row.away for row in rows], 1e-6)
    assert f"**0 of {len(rows)} have" in "\n".join(TRIAL.page(rows))


def test_a_wrong_digit_is_seen() -> None:
    assert TRIAL.right("0.874", 0.87444)
    assert not TRIAL.right("0.874", 0.87451)
    assert not TRIAL.right("0.8912", 0.874)
    assert TRIAL.right("3.1·10⁻⁹", 3.14e-9)
    assert not TRIAL.right("3.1·10⁻⁹", 3.16e-9)
    assert TRIAL.right("below 10⁻⁸", 9e-9)
    assert not TRIAL.right("below 10⁻⁸", 2e-8)


def test_figures_that_all_within_an_error_share() -> None:
    """Every number within the error rounds to what is shown; one figure more would not do."""
    rng = np.random.default_rng(SEED)
    for size, error in zip(
        10.0 ** rng.uniform(-9, 0, 200), 10.0 ** rng.uniform(-7, 0, 200), strict=True
    ):
        text = shared(size, error=error * size)
        for true in size * (1.0 + error * rng.uniform(-1.0, 1.0, 5)):
            assert TRIAL.right(text, true)
    assert shared(0.5, error=0.0) == "0.500000"
    assert shared(0.5, error=np.inf) == "–"
