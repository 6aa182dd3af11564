"""What a case file allows, for values that come another way: options, axes, calls from Python."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from numpy.typing import ArrayLike
from pydantic import BaseModel

from thermogear.base.errors import InputError, nearest
from thermogear.base.parameters import (
    EQUATION,
    GEARS,
    NUMBERS,
    PARAMETERS,
    Parameter,
    long_name,
    named,
)
from thermogear.base.toml import dotted
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.dimensionless_schema import DimensionlessFile
from thermogear.case.fields import BODY, Count, Measure, Number, Reader, Several
from thermogear.case.refusals import reader_at, table_at
from thermogear.case.schema import GearFile
from thermogear.case.units import KINDS

FLUCTUATION = "stiffness_fluctuation"
"""The factor on every harmonic of the mesh stiffness but its mean; 1 leaves a pair as it is."""
LANE = ("frequency", "half_backlash", FLUCTUATION)
"""Numbers of the equation that can be put in place of a gear pair's own, all else as it is."""


def gear_parameter(name: str, option: str = "parameter") -> Parameter:
    """The parameter of a gear case that ``name`` means: out of the table, or a dotted field.

    Raises :class:`InputError` where there is no such field, or none that holds numbers.
    """
    name = dotted(name)
    if "." not in name:
        try:
            return named(name, (*GEARS, *LANE), option)
        except InputError as error:
            fix = f"{error.fix} or a dotted field"
            raise InputError(option, error.got, why=error.why, fix=fix) from error
    reader = gear_reader(name)
    kind = KINDS[reader.kind] if isinstance(reader, Measure) else None
    unit = "1" if kind is None else kind.si
    return Parameter(name=name, words=name, unit=unit, shown=unit if kind else "", fields=(name,))


def number_parameter(name: str, option: str = "parameter") -> Parameter:
    """The number of the dimensionless equation that ``name`` means."""
    return named(name, NUMBERS, option)


def gear_reader(parameter: str) -> Reader:
    """What reads one value of a gear parameter, or of a dotted field of a gear case.

    Raises :class:`InputError` where there is no such field, or none that holds numbers.
    """
    one = PARAMETERS.get(long_name(parameter))
    if one is not None and one.name == FLUCTUATION:
        return Number(low=0.0, example="1")
    if one is not None and not one.fields:
        return dimensionless_reader(one.name)
    return _reader(GearFile, parameter if one is None else one.fields[0])


def dimensionless_reader(parameter: str) -> Reader:
    """What reads one value of a number of the dimensionless equation."""
    return _reader(DimensionlessFile, f"{EQUATION}.{parameter}")


def _reader(file: type[BaseModel], field: str) -> Reader:
    place = tuple(field.split("."))
    found = reader_at(file, place)
    one = found.one if isinstance(found, Several) else found
    if one is None:
        table = table_at(file, place[:-1])
        known = table.model_fields if table else [*file.model_fields]
        raise InputError(field, "an unknown field", fix=nearest(place[-1], known))
    if not isinstance(one, Measure | Number | Count):
        raise InputError(field, "a field of words", allowed="a field that holds a number")
    return one


def within(option: str, reader: Reader, values: ArrayLike) -> None:
    """Refuse, under the name of ``option``, SI ``values`` that no case file could hold."""
    found = np.unique(np.asarray(values, dtype=float))
    # a range is met between its ends; whole numbers are counted one by one
    for value in found.tolist() if isinstance(reader, Count) else {*found[:1], *found[-1:]}:
        with _speaking_of(option):
            reader.within(float(value))


def kelvin(option: str, celsius: float) -> float:
    """``celsius`` [degC] as K, where gears, oil or housing may have it."""
    value = celsius + ZERO_CELSIUS
    within(option, BODY, value)
    return value


def read_value(option: str, reader: Reader, text: str) -> float:
    """A value written on a command line as SI: with its unit, or a pure number."""
    if isinstance(reader, Measure):
        with _speaking_of(option):
            return reader.read(text)
    try:
        number = float(text)
    except ValueError:
        raise InputError(option, repr(text), allowed="a number") from None
    within(option, reader, number)
    return number


def read_shown(parameter: Parameter, text: str) -> float:
    """A value of a gear parameter as a person writes it, as SI.

    With its unit as in a case file; a bare number of a parameter of the table is in its shown unit.
    """
    name, reader = parameter.name, gear_reader(parameter.name)
    try:
        number = float(text)
    except ValueError:
        return read_value(name, reader, text)
    if name not in PARAMETERS and isinstance(reader, Measure):
        unit = KINDS[reader.kind].shown
        raise InputError(
            name,
            text,
            allowed=reader.allowed,
            why="the unit is missing",
            fix=f"write it at every value: {name}={text} {unit}:TO {unit}:COUNT",
        )
    value = parameter.read(number) if name in PARAMETERS else number
    within(name, reader, value)
    return value


def positive_stiffness(option: str, amplitude: ArrayLike, *, thermal: ArrayLike = 0.0) -> None:
    """Refuse an amplitude eps at which the mesh stiffness 1 + eps_T + eps cos(.) is not positive.

    No tooth contact pulls: where eps reaches 1 + eps_T the equation is no gear pair's any more.
    The equation itself (:class:`~thermogear.dynamics.models.TorsionalModel`) takes any amplitude.
    """
    largest = float(np.max(np.abs(np.asarray(amplitude, dtype=float))))
    least = 1.0 + float(np.min(np.asarray(thermal, dtype=float)))
    if largest >= least:
        raise InputError(
            option,
            f"{largest:g}",
            allowed=f"< {least:g} (1 + eps_T)",
            why="the mesh stiffness 1 + eps_T + eps cos would reach zero",
            fix="lower eps or raise eps_T",
        )


def require_numbers(numbers: Mapping[str, ArrayLike]) -> None:
    """Refuse numbers of the dimensionless equation, by their long names, out of their ranges.

    A sequence holds the values that one number runs through.
    """
    for name, values in numbers.items():
        within(name, dimensionless_reader(name), values)
    if "stiffness_amplitude" in numbers:
        positive_stiffness(
            "stiffness_amplitude",
            numbers["stiffness_amplitude"],
            thermal=numbers.get("thermal_stiffness", 0.0),
        )


@contextmanager
def _speaking_of(option: str) -> Iterator[None]:
    try:
        yield
    except InputError as error:
        raise error.named(option) from error
