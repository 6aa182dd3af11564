"""An answer: one question, one sentence, one number with its limit, one verdict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from thermogear.base.limits import FINE, LOOK, OPEN


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What one question comes to at one operating point, or for the case as a whole.

    ``name`` of the figure and its ``question``; ``sentence`` for a reader; ``value`` in ``unit``
    as shown, None where there is none; ``limit`` in words and its ``source``; ``verdict`` as
    :mod:`~thermogear.base.limits` names them; ``operating`` "3000 rpm, 80 N m", empty where it is
    not of one point. ``figures``: the numbers in the sentence by name, in whole precision, a list
    where they are several of a kind; ``units`` of them as shown.
    """

    name: str
    question: str
    sentence: str
    value: float | None
    unit: str
    limit: str
    source: str
    verdict: str
    operating: str = ""
    figures: Mapping[str, Any] = field(default_factory=dict)
    units: Mapping[str, str] = field(default_factory=dict)

    @property
    def row(self) -> dict[str, object]:
        """For a file."""
        return asdict(self)


def worst(answers: Iterable[Answer]) -> Answer:
    """The gravest of several: look here before not decided before fine, then the worst value."""
    order = (LOOK, OPEN, FINE)

    def rank(one: Answer) -> tuple[int, float]:
        value = 0.0 if one.value is None else one.value
        return order.index(one.verdict), value if "at least" in one.limit else -value

    return min(answers, key=rank)
