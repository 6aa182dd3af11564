"""What a notebook or a prompt shows of a case: short, and the figures that `check` prints."""

from __future__ import annotations

import re

import pytest
from click.testing import CliRunner

from thermogear.case.case import load_case
from thermogear.case.examples import EXAMPLES
from thermogear.front.cli import cli


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_case_shows_itself_in_two_kilobytes(name: str) -> None:
    case = load_case(name)
    assert len(repr(case)) < 2000
    assert repr(case).startswith(f"{type(case).__name__}: {case.title}")


def test_the_figures_shown_are_those_of_check() -> None:
    changes = ["operating.torque=70 N m", "title=a <b> & c"]
    table = load_case("fzg-c", changes)._repr_html_()
    assert "<b>a &lt;b&gt; &amp; c</b>" in table
    assert "<tr><td>operating.torque</td><td>70 N m</td></tr>" in table
    printed = CliRunner().invoke(cli, ["check", "fzg-c", "--set", changes[0]]).stdout
    cells = re.findall(r"<tr><td>pinion, (.*?)</td><td>(.*?)</td></tr>", table)
    assert len(cells) > 5
    for label, value in cells:
        assert re.search(rf"^  {re.escape(label)} +{re.escape(value)}$", printed, re.M), label
