"""``thermogear verify``: tables, JSON, one-line refusals."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner, Result

from said import numbers
from thermogear.base.errors import InputError
from thermogear.case.examples import example_text
from thermogear.front.verify_commands import verify

pytestmark = pytest.mark.slow


@pytest.fixture
def case(tmp_path: Path) -> str:
    path = tmp_path / "rig.toml"
    path.write_text(example_text("rig"), encoding="utf-8")
    return str(path)


def call(*arguments: str) -> Result:
    return CliRunner().invoke(verify, list(arguments))


def test_stiffness_prints_model_elements_and_difference(case: str) -> None:
    done = call("stiffness", case, "--positions", "1")
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


def test_stiffness_as_json(case: str) -> None:
    done = call("stiffness", case, "--positions", "1", "--torque", "200", "--json")
    content = json.loads(done.output)
    assert content["torque"] == 200.0
    assert content["line_load_n_per_m"] == pytest.approx(200.0 / 58.7308e-3 / 25e-3, rel=1e-5)
    ratio = np.array(content["model"]) / np.array(content["finite_elements"]) - 1.0
    assert ratio == pytest.approx(content["relative_difference"], rel=1e-9)


def test_growth_of_both_gears(case: str) -> None:
    text = call("growth", case)
    assert text.exit_code == 0, text.output
    assert text.output.count("worst") == 2
    content = json.loads(call("growth", case, "--json").output)
    assert np.max(np.abs(content["pinion"]["difference"])) < 0.2e-6
    assert np.max(np.abs(content["wheel"]["difference"])) < 0.7e-6


def test_the_fixed_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    import thermogear.verify.pairs as pairs

    # the whole list is computed in the tests of the checks; here its printing
    published, far = pairs.published_pair(), pairs.far_pairs()
    pairs_drawn = pairs.drawn_pairs()
    monkeypatch.setattr(pairs, "own_pairs", lambda: far[:1])
    monkeypatch.setattr(pairs, "far_pairs", lambda: (published,))
    monkeypatch.setattr(pairs, "corner_pairs", lambda: (published,))
    monkeypatch.setattr(pairs, "drawn_pairs", lambda: pairs_drawn[-3:-2])
    roots = pairs.root_pairs()
    monkeypatch.setattr(pairs, "root_pairs", lambda: roots[2:])
    done = call("pairs")
    assert done.exit_code == 0, done.output
    lines = done.output.splitlines()
    assert [4.0, 20.0, 35.0, 25.0] in [numbers(line)[:4] for line in lines]
    model, finite, off = numbers(lines[-1])[-3:]
    assert off == pytest.approx(100.0 * (model / finite - 1.0), abs=0.01)


def test_refusals(case: str, tmp_path: Path) -> None:
    done = call("stiffness", case, "--torque", "0")
    assert isinstance(done.exception, InputError)
    assert str(done.exception) == "torque: got 0 N m; allowed > 0; state --torque"
    points = tmp_path / "points.toml"
    points.write_text(example_text("table-4.2"), encoding="utf-8")
    done = call("growth", str(points))
    assert isinstance(done.exception, InputError)
    assert str(done.exception).startswith("case: got kind = 'dimensionless'; allowed kind = 'gear'")
