"""Numbers told as texts in what is meant for scripts."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

UNIT = r"(?:%|°C|degC|[kmµu]?(?:m|s|N|W|g|Pa|Hz|rad)|rpm|K|N m|N/m|rad/s|m/s\^?2?|min|h)"
SHOWN = re.compile(
    r"(?!\d\.\d\.\d+$)"
    rf"[-+−]?\d[\d.,  ]*(?:e[-+]?\d+|·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?(?:\.\.[-+]?\d[\d.e]*)?(?: ?{UNIT})?"
)
"""A whole text that is a number, with thousands set off, powers of ten, a unit, or two of them.

The numbers of the thesis's statements (2.1.10) are none."""
TEXTS = {
    "thermogear",
    "unit",
    "units",
    "name",
    "case",
    "differences",
    "values",
    "title",
    "kind",
    "version",
    "printed",
    "place",
    "as_in_the_thesis",
    "consistent",
}
"""Keys of names, of units ("1"), of versions, of fields as a case file spells them and of figures
as another document prints them and of its sections ("2.3"), and of
findings, which are sentences."""


def told_as_text(value: Any, key: str = "") -> Iterator[str]:
    """Key and text of every number that is a text."""
    if isinstance(value, Mapping):
        for name, one in value.items():
            if name not in TEXTS and not str(name).endswith("_unit"):
                yield from told_as_text(one, f"{key}.{name}")
    elif isinstance(value, list | tuple):
        for one in value:
            yield from told_as_text(one, f"{key}[]")
    elif isinstance(value, str) and SHOWN.fullmatch(value.strip()):
        yield f"{key} {value!r}"
