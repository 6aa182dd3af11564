"""The parameters of a law object: their ranges, a law with others, a law in words.

A parameter is a field of the law's dataclass; a range is in its annotation. A field that
holds a law has the parameters of that law.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, is_dataclass, replace
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, TypeVar, get_type_hints

from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError, nearest

Coefficient = Annotated[float, Bounds(low=0.001, high=1.0, unit="", si="")]
"""A coefficient of friction, or the greatest one a law returns."""
PitchFloor = Annotated[float, Bounds(low=1e-6, high=1.0, unit="", si="")]
"""Share of the entrainment speed below which a law is regularised; the range is ours."""
Factor = Annotated[float, Bounds(low=0.01, high=100.0, unit="", si="")]
"""A factor of the lubricant; the range is ours."""

_Law = TypeVar("_Law")


class Bounded:
    """A dataclass that refuses a field out of the range in its annotation.

    ``films``: what a law of friction asks of the films of a contact, none if not said otherwise;
    ``ranges``: of the variables it is stated for, any if not said otherwise.
    """

    films: ClassVar[tuple[str, ...]] = ()
    ranges: ClassVar[Mapping[str, tuple[float, float]]] = MappingProxyType({})

    def __post_init__(self) -> None:
        for name, allowed in ranges(type(self)).items():
            value = getattr(self, name)
            if value is not None:
                allowed.require(name, value)


def parameters(law: object) -> dict[str, Any]:
    """Field -> value of a law's parameters, in order.

    >>> parameters(friction_law("boundary"))
    {'coefficient': 0.1}
    """
    return {f.name: getattr(law, f.name) for f in fields(law)} if is_dataclass(law) else {}


def ranges(law: type[Any]) -> Mapping[str, Bounds]:
    """The parameters of a kind of law that have a range, with it.

    >>> list(ranges(type(friction_law("boundary"))))
    ['coefficient']
    """
    return {
        name: mark
        for name, hint in get_type_hints(law, include_extras=True).items()
        for kind in (hint, *getattr(hint, "__args__", ()))  # a range may stand beside None
        for mark in getattr(kind, "__metadata__", ())
        if isinstance(mark, Bounds)
    }


def require_known(law: Any, names: Mapping[str, object]) -> None:
    """Refuse a name that is no parameter of ``law``; says the nearest of that law.

    >>> require_known(friction_law("boundary"), {"coefficient": 0.12})
    """
    known = parameters(law)
    for name in names:
        if name not in known:
            raise InputError(
                name,
                "an unknown parameter",
                why=f"the law {law.name} does not have it",
                fix=nearest(name, known) if known else "leave it out",
            )


def with_parameters(law: _Law, values: Mapping[str, Any]) -> _Law:
    """``law`` with ``values`` in place of parameters; a mapping speaks to the law in its field.

    Raises InputError for an unknown name, which says the nearest, and for a value out of range.

    >>> with_parameters(friction_law("boundary"), {"coefficient": 0.12})
    Boundary(coefficient=0.12)
    """
    require_known(law, values)
    made = {}
    for name, value in values.items():
        inner = getattr(law, name)
        if isinstance(value, Mapping):
            try:
                value = with_parameters(inner, value)
            except InputError as error:
                raise error.under(name) from error
        made[name] = value
    return replace(law, **made) if made else law  # type: ignore[type-var]


def law_words(law: Any, plain: object) -> str:
    """The law's name, and in brackets the parameters in which it differs from ``plain``.

    >>> law_words(friction_law("boundary", coefficient=0.12), friction_law("boundary"))
    'boundary(coefficient=0.12)'
    """
    usual = parameters(plain)
    told = [
        f"{name}={law_words(value, usual.get(name)) if is_dataclass(value) else value}"
        for name, value in parameters(law).items()
        if value != usual.get(name)
    ]
    return f"{law.name}({', '.join(told)})" if told else str(law.name)
