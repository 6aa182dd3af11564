"""``thermogear verify``: tables, JSON, one-line refusals."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner, Result

from said import numbers
from thermogear.base.errors import InputError
from thermogear.case.examples import example_text
from thermogear.front.verify_commands import verify
from thermogear.verify import checks

pytestmark = pytest.mark.slow


@pytest.fixture
def case(tmp_path: Path) -> str:
    path = tmp_path / "rig.toml"
    path.write_text(example_text("rig"), encoding="utf-8")
    return str(path)


@pytest.fixture
def one_check(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is checked first is found again whatever is asked: for tests of what is printed."""
    check, kept = checks.check_stiffness, list[checks.StiffnessCheck]()

    def once(*asked: Any, **how: Any) -> checks.StiffnessCheck:
        if not kept:
            kept.append(check(*asked, **how))
        return kept[0]

    monkeypatch.setattr(checks, "check_stiffness", once)


def call(*arguments: str) -> Result:
    return CliRunner().invoke(verify, list(arguments))


@pytest.mark.usefixtures("one_check")
def test_stiffness_as_a_table_and_as_json(case: str) -> None:
    """Both of one check: what is printed of it is in question here."""
    asked = ("stiffness", case, "--positions", "1")
    done = call(*asked)  # at the greatest torque of the case, 100 N m
    assert done.exit_code == 0, done.output
    assert "corner" in done.output
    rows = [line.split() for line in done.output.splitlines() if line.startswith("  0.")]
    assert len(rows) == 2
    load = numbers(next(line for line in done.output.splitlines() if "F_n/b" in line))[-1]
    for row in rows:
        model, finite, error = map(float, row[2:5])
        # N/mm over N/(mm um) is um
        assert error == pytest.approx(load / model - load / finite, abs=2e-3)
        assert abs(error) < 0.03 * load / finite
    content = json.loads(call(*asked, "--torque", "100", "--json").output)
    assert content["torque"] == 100.0
    assert content["line_load_n_per_m"] == pytest.approx(100.0 / 58.7308e-3 / 25e-3, rel=1e-5)
    ratio = np.array(content["model"]) / np.array(content["finite_elements"]) - 1.0
    assert ratio == pytest.approx(content["relative_difference"], rel=1e-9)


def test_refusals(case: str, tmp_path: Path) -> None:
    done = call("stiffness", case, "--torque", "0")
    assert isinstance(done.exception, InputError)
    assert str(done.exception) == "torque: got 0 N m; allowed > 0; state --torque"
    points = tmp_path / "points.toml"
    points.write_text(example_text("table-4.2"), encoding="utf-8")
    done = call("stiffness", str(points))
    assert isinstance(done.exception, InputError)
    assert str(done.exception).startswith("case: got kind = 'dimensionless'; allowed kind = 'gear'")
