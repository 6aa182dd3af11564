"""The table of the case file that chooses the law of friction and its parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import is_dataclass
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, StrictBool, create_model

from thermogear.case.fields import Choice, NameOrTable, Number
from thermogear.case.table import Table
from thermogear.heat.friction import LAWS, LUBRICATED
from thermogear.heat.law_parameters import parameters, ranges, require_known
from thermogear.mesh.model import CHOICES


def _reader(name: str, laws: Sequence[object]) -> Any:
    """What reads the parameter ``name`` of some ``laws``; each law knows its own range."""
    having = [law for law in laws if name in parameters(law)]
    values = [parameters(law)[name] for law in having]
    inner = [value for value in values if is_dataclass(value)]
    if inner:
        return _table(
            f"{name.capitalize()}Table", "The law inside a law, with its parameters.", inner
        )
    if isinstance(values[0], bool):
        return StrictBool
    known = [one[name] for one in (ranges(type(law)) for law in having) if name in one]
    usual = next((f"{value:g}" for value in values if value is not None), "1")
    if not known:
        return Annotated[float, Number(example=usual)]
    low, high = min(one.least for one in known), max(one.most for one in known)
    return Annotated[float, Number(low=low, high=high, example=usual)]


def _usual(name: str, laws: Sequence[Any]) -> str:
    """The default of a parameter, with the laws that have it."""
    having: dict[str, list[str]] = {}
    for law in laws:
        if name in (known := parameters(law)):
            value = known[name]
            words = "by the oil" if value is None else str(getattr(value, "name", value))
            having.setdefault(words, []).append(law.name)
    return "; ".join(f"{words} ({', '.join(names)})" for words, names in having.items())


def _table(name: str, words: str, laws: Sequence[object], **before: Any) -> type[Table]:
    fields = dict(before)
    for law in laws:
        for parameter in parameters(law):
            usual = Field(default=None, title=_usual(parameter, laws))
            fields.setdefault(parameter, (_reader(parameter, laws) | None, usual))
    return create_model(name, __base__=Table, __doc__=words, **fields)


if TYPE_CHECKING:
    FrictionTable = Table
else:
    FrictionTable = _table(
        "FrictionTable",
        "The law of friction and its parameters; every law has only some of them.",
        LUBRICATED,
        law=(
            Annotated[str, Choice(*CHOICES["friction"])] | None,
            Field(default=None, title="as the bundle has it"),
        ),
    )


def _check(law: str, values: Mapping[str, object]) -> None:
    require_known(LAWS[law], values)


FRICTION = NameOrTable("law", *CHOICES["friction"], check=_check)
"""A law by its name, or a table with its parameters."""
