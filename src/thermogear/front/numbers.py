"""Numbers as options: what is no number is refused like any other value, with what is allowed."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import click

from thermogear.base.errors import InputError, short
from thermogear.study.declared import numbers


class NumberType(click.ParamType[float | int]):
    """A number, or a whole one; ``allowed`` in words, ``example`` of one. It may have one of the
    ``units`` behind it, each with its factor."""

    def __init__(
        self,
        allowed: str,
        example: str,
        *,
        whole: bool = False,
        units: Mapping[str, float] | None = None,
    ) -> None:
        self.name = "integer" if whole else "float"
        self._allowed, self._example, self._whole = allowed, example, whole
        self._units = units or {}

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> float | int:
        """The number; InputError where the text is none."""
        text = str(value).strip()
        unit = next((one for one in self._units if text.lower().endswith(one.lower())), "")
        try:
            if self._whole:
                return int(text)
            return float(text.removesuffix(text[len(text) - len(unit) :])) * self._units.get(
                unit, 1
            )
        except ValueError:
            option = param.opts[0] if param is not None else "number"
            fix = f"as {option} {self._example}"
            raise InputError(option, short(value), allowed=self._allowed, fix=fix) from None


def number(
    option: str,
    words: str,
    allowed: str,
    example: str,
    *,
    whole: bool = False,
    units: Mapping[str, float] | None = None,
    **more: Any,
) -> Callable[[Any], Any]:
    """A click option that takes a :class:`NumberType`; ``words`` of its help."""
    kind = NumberType(allowed, example, whole=whole, units=units)
    return click.option(option, type=kind, help=words, **more)


def grid(option: str, text: str) -> Any:
    """The numbers of ``FROM:TO:COUNT``, evenly apart."""
    import numpy as np

    try:
        low, high, count = text.split(":")
        values = np.linspace(float(low), float(high), int(count))
    except ValueError:
        raise InputError(option, repr(text), allowed="FROM:TO:COUNT") from None
    if values.size < 1:
        raise InputError(option, repr(text), allowed="a count >= 1")
    return values


def start(text: str) -> tuple[float, float]:
    """The two numbers of ``X,V``, a start in half backlashes."""
    x, v = numbers("--start", text, allowed="two numbers X,V", fix="0,0", count=2)
    if not abs(x) < 1e6 or not abs(v) < 1e6:
        raise InputError("--start", text, allowed="finite numbers below 1e6")
    return x, v
