"""Numbers of one unit that stand side by side are named in the call.

A call such as ``f(approach, recess)`` of ``f(recess, approach)`` runs, and nothing notices. So two
neighbouring positional parameters of a public function, method or class may hold numbers only where
their units differ in dimension (angles and counts are pure numbers), and truth values never. A unit
is what the docstring says in brackets behind the name, else what the name means everywhere in the
house; a number without a known unit passes for any other. Compiled kernels take their arguments by
place alone and are left out; a NamedTuple is a tuple by nature.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import re
from collections.abc import Callable, Iterator
from dataclasses import is_dataclass
from functools import cache
from itertools import pairwise

import numpy as np
import pint
import pytest

import thermogear
from thermogear.base.materials import Lubricant
from thermogear.dynamics.models import TorsionalModel
from thermogear.dynamics.return_map import return_map
from thermogear.heat.losses import mesh_loss

# --- what is exempt, each proven or with its reason ----------------------------------------------


def swapped_distance(exchanged: bool) -> object:
    model = TorsionalModel(
        damping_ratio=0.05,
        frequency=0.7,
        stiffness_amplitude=0.1,
        mean_force=0.1,
        force_amplitude=0.05,
    )
    points = [np.array([1.0, 0.2]), np.array([-0.3, 0.7])]
    return return_map(model.lanes()).distance(*(points[::-1] if exchanged else points))


def swapped_points(exchanged: bool) -> object:
    points = [(313.15, 100e-6), (373.15, 11e-6)]
    return Lubricant.from_two_points("oil", *(points[::-1] if exchanged else points))


SYMMETRIC: dict[str, Callable[[bool], object]] = {
    "dynamics.return_map.ReturnMap.distance": swapped_distance,
    "dynamics.return_map.StateMap.distance": swapped_distance,
    "base.materials.Lubricant.from_two_points": swapped_points,
    "heat.losses.mesh_loss": lambda exchanged: float(
        mesh_loss(2e4, *((0.2, 0.06) if exchanged else (0.06, 0.2)))
    ),
}
"""Exchanging the neighbours changes nothing: evaluated both ways."""

REASONS = {
    "base.progress.silent": "called as every Progress is: stage, done, total",
    "front.app.parts.Look.told": "called as every Progress is: stage, done, total",
    **{
        f"views.picture.{kind}": "x before y, as in every plot"
        for kind in ("Curve", "Points", "Stems", "Text", "Bars", "Field", "Contours", "Hatch")
    },
    "base.display.Display.text": "value and digits as in round",
    "base.display.exactly": "value and digits as in round",
    "base.display.number": "value and digits as in round",
    "base.display.span": "values and digits as in round",
}

# --- units ---------------------------------------------------------------------------------------

UNITS = {
    "added": "m",
    "angle": "rad",
    "backlash": "m",
    "deflection": "m",
    "depth": "m",
    "distance": "m",
    "emissivity": "-",
    "entrainment": "m/s",
    "exponent": "-",
    "factor": "-",
    "flash": "K",
    "force": "N",
    "frequency": "Hz",
    "friction": "-",
    "guess": "state",
    "immersion": "-",
    "length": "m",
    "load": "N/m",
    "modulus": "Pa",
    "peclet": "-",
    "phase": "-",
    "poisson": "-",
    "prandtl": "-",
    "pressure": "Pa",
    "radius": "m",
    "rate": "Hz",
    "ratio": "-",
    "reference": "K",
    "roughness": "m",
    "shift": "-",
    "sliding_speed": "m/s",
    "state": "state",
    "stiffness": "N/m",
    "sum_speed": "m/s",
    "t": "time",
    "teeth": "-",
    "temperature": "K",
    "torque": "N m",
    "transmission": "-",
    "viscosity": "Pa s",
    "width": "m",
    "y": "state",
}
"""What a name, or its last word, means where the docstring of a function says nothing else."""

MARK = re.compile(
    r"``(?P<marked>\w+)``"
    r"|(?<![`\w/])(?P<bare>[a-z]\w*)(?=:| \[|, [a-z]\w*(?::| \[))"
    r"|(?<![\w)])\[(?P<unit>[^\[\]`\n]{1,40})\]"
)
"""A name, in double backquotes or before a colon or a unit; and a unit."""
LIST = re.compile(r"\s*(?:,|and|,\s*and)\s*")
REFERENCE = re.compile(r"(?:[Aa]rguments|rest)[^.;:]* as\s+:func:`(\w+)`")
PINT = pint.UnitRegistry()
COUNTED = re.compile(r"\b(?:bin|cycle|module|period|sample|tooth|turn)s?\b")


@cache
def dimension(unit: str) -> str:
    """What pint makes of a unit, angles and counts being pure numbers; else the text itself."""
    text = COUNTED.sub("1", "1" if unit == "-" else unit)
    text = re.sub(r"(?<=[\w)]) (?=[\w(])", "*", text).replace("^", "**")
    try:
        return str(dict(PINT.parse_expression(text).dimensionality)) if text != "1" else "{}"
    except Exception:  # a word that pint does not know
        return unit


def documented(doc: str, names: set[str]) -> dict[str, str]:
    """Unit of each of ``names``: the first bracket behind it within its own clause."""
    marks = [m for m in MARK.finditer(doc) if m["unit"] or (m["marked"] or m["bare"]) in names]
    found: dict[str, str] = {}
    for place, mark in enumerate(marks):
        name, last = mark["marked"] or mark["bare"], mark
        for after in marks[place + 1 :] if name and name not in found else ():
            between = doc[last.end() : after.start()]
            if after["unit"]:
                if not re.search(r"\.\s|;", between):
                    found[name] = after["unit"].strip()
                break
            if not LIST.fullmatch(between):
                break
            last = after
    return found


def units_of(function: Callable[..., object]) -> dict[str, str]:
    """The units that the docstring gives, or that of the function it refers to."""
    doc, names = inspect.getdoc(function) or "", set(inspect.signature(function).parameters)
    other = REFERENCE.search(doc)
    there = getattr(inspect.getmodule(function), other[1], None) if other else None
    return (units_of(there) if there else {}) | documented(doc, names)


# --- the rule ------------------------------------------------------------------------------------

ARRAYS = {"Floats", "NDArray", "ndarray", "Sequence", "tuple", "list"}
NUMBERS = ARRAYS | {"ArrayLike", "float", "int", "None", "np", "float64", "int64"}


def kind(annotation: object) -> str | None:
    """ "float", "int", "bool", "array", "either" of float and array; None for anything else."""
    words = set(re.findall(r"[A-Za-z_]\w*", str(annotation)))
    if words == {"bool"}:
        return "bool"
    if not words - {"None"} or not words <= NUMBERS:
        return None
    if "ArrayLike" in words:
        return "either"
    if words & ARRAYS:
        return "array"
    return "float" if "float" in words else "int"


class Parameter:
    """One parameter: name, kind of its numbers (None: no numbers) and their unit, where known."""

    def __init__(self, parameter: inspect.Parameter, units: dict[str, str]) -> None:
        self.name, self.kind = parameter.name, kind(parameter.annotation)
        plain = re.sub(r"_?\d+$", "", self.name)
        usual = UNITS.get(plain) or UNITS.get(plain.rsplit("_", 1)[-1])
        self.unit = units.get(self.name) or usual or ("-" if self.kind == "int" else None)

    def __str__(self) -> str:
        return f"{self.name} [{self.unit or '?'}]"

    def may_be_taken_for(self, other: Parameter) -> bool:
        """Whether a value of ``other`` here would run."""
        kinds = {self.kind, other.kind}
        if None in kinds:
            return False
        if "bool" in kinds:
            return kinds == {"bool"}
        if "array" in kinds and kinds & {"float", "int"}:
            return False
        units = self.unit, other.unit
        return None in units or dimension(str(units[0])) == dimension(str(units[1]))


def exchangeable(function: Callable[..., object]) -> list[str]:
    """Neighbouring positional parameters whose values could stand in each other's place."""
    by_place = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    units = units_of(function)
    row = [
        Parameter(p, units)
        for p in inspect.signature(function).parameters.values()
        if p.kind in by_place
    ]
    return [f"{one}, {two}" for one, two in pairwise(row) if one.may_be_taken_for(two)]


def public(members: dict[str, object], module: str) -> Iterator[tuple[str, object]]:
    for name, member in members.items():
        if isinstance(member, classmethod | staticmethod):
            member = member.__func__
        if hasattr(member, "py_func"):  # a compiled kernel
            continue
        home = getattr(inspect.unwrap(member) if callable(member) else member, "__module__", None)
        if not name.startswith("_") and home == module:
            yield name, member


def callables() -> dict[str, Callable[..., object]]:
    """Every public function, method and class by its dotted name below ``thermogear``."""
    found: dict[str, Callable[..., object]] = {}
    for entry in pkgutil.walk_packages(thermogear.__path__, "thermogear."):
        if entry.name == "thermogear.__main__":
            continue
        module = importlib.import_module(entry.name)
        floor = entry.name.removeprefix("thermogear.")
        for name, member in public(vars(module), entry.name):
            if inspect.isclass(member):
                if is_dataclass(member) or "__init__" in vars(member):
                    found[f"{floor}.{name}"] = member
                for method, function in public(vars(member), entry.name):
                    if inspect.isfunction(inspect.unwrap(function)):
                        found[f"{floor}.{name}.{method}"] = function
            elif inspect.isfunction(inspect.unwrap(member)):
                found[f"{floor}.{name}"] = member
    return found


CALLABLES = callables()


def test_no_call_can_exchange_two_numbers_of_one_unit() -> None:
    assert len(CALLABLES) > 1000
    exempt = SYMMETRIC.keys() | REASONS.keys()
    found = {name: exchangeable(function) for name, function in CALLABLES.items()}
    offenders = {name: pairs for name, pairs in found.items() if pairs and name not in exempt}
    advice = "name them (a bare * before the first), or say different units in the docstring"
    assert offenders == {}, advice
    assert [name for name in exempt if not found[name]] == [], "no longer exempt"


@pytest.mark.parametrize("name", SYMMETRIC)
def test_what_may_be_exchanged_makes_no_difference(name: str) -> None:
    assert SYMMETRIC[name](True) == SYMMETRIC[name](False)


def rule(source: str) -> list[str]:
    space: dict[str, Callable[..., object]] = {}
    exec("from __future__ import annotations\n" + source, space)
    return exchangeable(space["f"])


@pytest.mark.parametrize(
    ("source", "pairs"),
    [
        ("def f(recess: float, approach: float): ...", ["recess [?], approach [?]"]),
        ("def f(recess: float, *, approach: float): ...", []),
        ("def f(*, recess: float, approach: float): ...", []),
        ("def f(radius1: float, radius2: ArrayLike): ...", ["radius1 [m], radius2 [m]"]),
        ("def f(line_load: ArrayLike, radius: ArrayLike): ...", []),
        ("def f(a: float, b: float):\n '``a`` [mm], ``b`` [m]'", ["a [mm], b [m]"]),
        ("def f(a: float, b: float):\n '``a``, ``b`` [m]'", ["a [m], b [m]"]),
        ("def f(a: float, b: float):\n 'a: height [m]; b: mass [kg]'", []),
        ("def f(a: float, b: float):\n '``a`` [J], ``b`` [N m]'", ["a [J], b [N m]"]),
        ("def f(a: float, b: float):\n '``a`` [Hz], ``b`` [samples/s]'", ["a [Hz], b [samples/s]"]),
        ("def f(a: float, b: float):\n '``a`` [rad], ``b`` [-]'", ["a [rad], b [-]"]),
        ("def f(samples: int, periods: int): ...", ["samples [-], periods [-]"]),
        ("def f(speeds: Floats, count: int): ...", []),
        ("def f(hot: bool, dry: bool): ...", ["hot [?], dry [?]"]),
        ("def f(name: str, other: str): ...", []),
    ],
)
def test_the_rule_itself(source: str, pairs: list[str]) -> None:
    assert rule(source) == pairs
