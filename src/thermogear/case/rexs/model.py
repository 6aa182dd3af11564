"""What a REXS model holds, whatever file it came in: components, relations, load cases."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache

from thermogear.base.errors import InputError, nearest, short

VERSIONS = ("1.0", "1.1", "1.2", "1.3", "1.4", "1.5", "1.6", "1.7", "2.0.0")
"""Those that are read; there is no 1.8 and no 1.9."""

MOST_COMPONENTS = 100_000
MOST_RELATIONS = 200_000
MOST_ATTRIBUTES = 1_000_000
MOST_LOAD_CASES = 2_000
LONGEST_TEXT = 4_000_000
"""Of one value [characters]."""

Value = str | int | float | bool | list[object] | None


@dataclass(frozen=True)
class Attribute:
    """One value with the unit written with it; None where none is written."""

    id: str
    unit: str | None
    value: Value


@dataclass(frozen=True)
class Component:
    """A part: an id that relations name, a type, attributes by their id."""

    id: int
    type: str
    name: str = ""
    attributes: dict[str, Attribute] = field(default_factory=dict)

    @property
    def called(self) -> str:
        """Type, id and name, as messages say it."""
        return f"{self.type} {self.id}" + (f" {short(self.name)}" if self.name else "")


@dataclass(frozen=True)
class Relation:
    """Components that belong together, (role, id) in the order of the file."""

    id: int
    type: str
    order: int | None
    refs: tuple[tuple[str, int], ...]

    def role(self, *names: str) -> int | None:
        """The id of the first reference in one of the roles."""
        return next((found for role, found in self.refs if role in names), None)


@dataclass(frozen=True, kw_only=True)
class LoadCase:
    """What differs under one load: attributes by component. ``spectrum``: the id of its own."""

    id: int
    spectrum: int
    components: dict[int, dict[str, Attribute]]


@dataclass
class Model:
    """A whole model. ``container``: XML, JSON, each perhaps in a zip; ``order`` of components is
    the file's."""

    version: str
    application: str
    container: str
    components: dict[int, Component] = field(default_factory=dict)
    relations: list[Relation] = field(default_factory=list)
    load_cases: list[LoadCase] = field(default_factory=list)
    attributes: int = 0

    # --- building ------------------------------------------------------------------------
    def add(self, component: Component) -> None:
        """One more component; an id twice is refused."""
        if component.id in self.components:
            raise InputError(
                f"component {component.id}", "an id twice", allowed="each id once in components"
            )
        if len(self.components) >= MOST_COMPONENTS:
            raise too_many("components", MOST_COMPONENTS)
        self.components[component.id] = component

    def relate(self, relation: Relation) -> None:
        """One more relation."""
        if len(self.relations) >= MOST_RELATIONS:
            raise too_many("relations", MOST_RELATIONS)
        self.relations.append(relation)

    def load(self, case: LoadCase) -> None:
        """One more load case."""
        if len(self.load_cases) >= MOST_LOAD_CASES:
            raise too_many("load cases", MOST_LOAD_CASES)
        self.load_cases.append(case)

    def count(self) -> None:
        """One more attribute, anywhere."""
        self.attributes += 1
        if self.attributes > MOST_ATTRIBUTES:
            raise too_many("attributes", MOST_ATTRIBUTES)

    # --- asking --------------------------------------------------------------------------
    @property
    def after(self) -> tuple[int, ...]:
        """The version as numbers, for comparisons."""
        return numbers(self.version)

    def of_type(self, *types: str) -> list[Component]:
        """Components of these types, in the file's order."""
        return [one for one in self.components.values() if one.type in types]

    def related(self, *types: str) -> Iterator[Relation]:
        """Relations of these types, ordered ones by their order."""
        found = [one for one in self.relations if one.type in types]
        yield from sorted(found, key=lambda one: (one.order is None, one.order or 0))

    def at(self, found: int | None) -> Component | None:
        """The component of an id, None for none."""
        return None if found is None else self.components.get(found)

    def referenced(self, origin: int, *types: str) -> list[Component]:
        """What a component refers to, of these types."""
        every = self.related("reference", "ordered_reference")
        found = (self.at(one.role("referenced")) for one in every if one.role("origin") == origin)
        return [one for one in found if one is not None and one.type in types]


def too_many(what: str, most: int) -> InputError:
    """A model larger than any gearbox."""
    return InputError("REXS file", f"more than {most} {what}", allowed=f"0..{most} {what}")


@cache
def numbers(version: str) -> tuple[int, ...]:
    """``"1.10"`` as (1, 10), so that it is above 1.9; ``-Beta`` is left out."""
    return tuple(int(part) for part in re.findall(r"\d+", version.partition("-")[0]))


def known_version(text: object) -> str:
    """The version a file says it has; refused where no schema of it is known."""
    if not isinstance(text, str) or not re.fullmatch(r"\d{1,3}(\.\d{1,3}){1,2}(-\w{1,20})?", text):
        raise InputError(
            "model.version", short(text), allowed=" | ".join(VERSIONS), why="no version of REXS"
        )
    plain = ".".join(str(part) for part in numbers(text))
    plain = "2.0.0" if plain == "2.0" else plain
    if plain not in VERSIONS:
        raise InputError(
            "model.version",
            short(text),
            allowed=" | ".join(VERSIONS),
            why="its names and units are not known here",
            fix=nearest(plain, VERSIONS),
        )
    return plain


def identity(text: object, where: str) -> int:
    """An id as a whole number."""
    if isinstance(text, int) and not isinstance(text, bool) and abs(text) < 2**63:
        return text
    if isinstance(text, str) and re.fullmatch(r"\s*-?\d{1,18}\s*", text):
        return int(text)
    raise InputError(f"{where} id", short(text), allowed="a whole number")
