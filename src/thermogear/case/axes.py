"""What a command line says of parameters and their values, as long names and SI values."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from thermogear.base.arrays import Floats
from thermogear.base.errors import InputError
from thermogear.case.allowed import (
    dimensionless_reader,
    gear_parameter,
    number_parameter,
    read_shown,
    read_value,
)
from thermogear.case.base import Case
from thermogear.case.case import GearCase


def parse_axis(case: Case, text: str, option: str = "over") -> tuple[str, Floats]:
    """NAME=FROM:TO:COUNT or NAME=A,B,C in the units a person writes, as name and SI values.

    Gear values carry their unit as in a case file (``20 mm:30 mm:3``); those that have a name of
    their own may leave it out.

    >>> name, values = parse_axis(load_case("rig"), "rpm=1000:2000:3")
    >>> name, values.round(2)
    ('pinion_speed', array([104.72, 157.08, 209.44]))
    """
    name, sign, rest = text.partition("=")
    gears = isinstance(case, GearCase)
    example = "rpm=200:12000:120" if gears else "zeta=0.10:0.18:200"
    parts = rest.split(":") if ":" in rest else rest.split(",")
    number = parts.pop() if ":" in rest else ""
    # nine digits count more points than any machine computes
    counted = len(parts) == 2 and number.isdecimal() and len(number) < 9 and int(number) > 0
    if not sign or (":" in rest and not counted):
        raise InputError(
            option,
            repr(text),
            allowed="NAME=FROM:TO:COUNT, COUNT 1..99999999, or NAME=A,B,C",
            fix=f"as {example}",
        )
    if gears:
        parameter = gear_parameter(name)
        ends = [read_shown(parameter, part) for part in parts]
    else:
        parameter = number_parameter(name)
        reader = dimensionless_reader(parameter.name)
        ends = [read_value(parameter.name, reader, part) for part in parts]
    values = np.linspace(ends[0], ends[1], int(number)) if counted else np.array(ends)
    return parameter.name, values


def parse_axes(case: Case, texts: Sequence[str]) -> dict[str, Floats]:
    """Every axis of the command line, as :func:`parse_axis`; each parameter once."""
    found: dict[str, Floats] = {}
    for text in texts:
        name, values = parse_axis(case, text)
        if name in found:
            raise InputError("over", f"{name} twice", allowed="each parameter once")
        found[name] = values
    return found


def split_change(text: str) -> tuple[str, str]:
    """Both sides of NAME=VALUE.

    >>> split_change("state=hot")
    ('state', 'hot')
    """
    name, sign, value = text.partition("=")
    if not sign:
        raise InputError("change", repr(text), allowed="NAME=VALUE")
    return name, value


def parse_numbers(texts: Sequence[str]) -> dict[str, float]:
    """NAME=VALUE of numbers of the dimensionless equation, each once.

    >>> parse_numbers(["frequency=0.7"])
    {'frequency': 0.7}
    """
    found: dict[str, float] = {}
    for name, value in map(split_change, texts):
        full = number_parameter(name).name
        if full in found:
            raise InputError("change", f"{full} twice", allowed="each number once")
        found[full] = read_value(name, dimensionless_reader(full), value)
    return found
