"""What a sentence says in figures and names, for tests that leave its wording free."""

from __future__ import annotations

import re

NUMBER = r"(?<![\w.^])[-−]?(?:\d{1,3}(?: \d{3})+(?!\d)|\d+)(?:\.\d+)?(?:e[-+]?\d+)?"
FACT = re.compile(rf"(?<!\w)'([^']+)'|({NUMBER})")


def _value(number: str) -> float:
    return float(number.replace("−", "-").replace(" ", ""))


def facts(text: str) -> list[str | float]:
    """Every quoted name and every number in ``text``, in order."""
    return [name or _value(number) for name, number in FACT.findall(text)]


def numbers(text: str) -> list[float]:
    """Every number in ``text``, in order."""
    return [_value(found) for found in re.findall(NUMBER, text)]
