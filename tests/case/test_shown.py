"""What a notebook or a prompt shows of a case: short, and the figures that `check` prints."""

from __future__ import annotations

import pytest

from thermogear.case.case import gear_case, load_case
from thermogear.case.examples import EXAMPLES
from thermogear.case.faults import fault_words


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_case_shows_itself_in_two_kilobytes(name: str) -> None:
    case = load_case(name)
    assert len(repr(case)) < 2000
    assert repr(case).startswith(f"{type(case).__name__}: {case.title}")


def test_the_figures_shown_are_those_of_the_case() -> None:
    fault = 'faults=[{kind = "crack", gear = "wheel", depth = "1 mm"}]'
    case = gear_case(load_case("fzg-c", ["operating.torque=70 N m", "title=a <b> & c", fault]))
    table = case._repr_html_()
    assert "<b>a &lt;b&gt; &amp; c</b>" in table
    assert "<tr><td>operating.torque</td><td>70 N m</td></tr>" in table
    assert case.figures["torque"] == "70 N m"
    assert case.figures["teeth"] == "16:24"
    assert case.figures["faults"] == fault_words(case.file.faults[0])
    assert float(load_case("table-4.2").figures["points"]) == len(load_case("table-4.2").points)
