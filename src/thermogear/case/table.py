"""What every table of a case file shares: unknown keys refused, one of two rivals, usual ranges."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler
from pydantic_core import CoreSchema

from thermogear.base import bounds
from thermogear.base.errors import InputError
from thermogear.case.described import described
from thermogear.case.fields import BODY, Measure, measure

Length = Annotated[float, measure("length", bounds.LENGTH)]
Body = Annotated[float, BODY]
Below = Annotated[float, Measure("temperature difference", "-400 K", "400 K")]


class Table(BaseModel):
    """A table of the file: unknown keys are refused, the values do not change any more."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        found = handler(core)
        properties = handler.resolve_ref_schema(found)["properties"]
        for name, keys in described(cls).items():
            properties[name] |= keys
        return found


def one_of(table: Table, first: str, second: str, field: str = "") -> None:
    """Refuse a table that holds both of two rivals, or neither; ``field`` is its place."""
    given = [name for name in (first, second) if getattr(table, name) is not None]
    if len(given) != 1:
        got, fix = ("both", "leave one out") if given else ("neither", f"write {first} = ...")
        raise InputError(
            field, f"{got} {first} and {second}", allowed="exactly one of the two", fix=fix
        )


def not_both(table: Table, first: str, second: str, field: str = "") -> None:
    """Refuse a table that holds both of two rivals."""
    if getattr(table, first) is not None and getattr(table, second) is not None:
        one_of(table, first, second, field)
