"""What a field of a case file may hold: the readers behind the annotations of the schema.

Each reader is handed what TOML gave, returns an SI number (or a name), and refuses everything else
with an :class:`InputError` whose field is still empty: its place is filled in by
:mod:`thermogear.case.refusals`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import KW_ONLY, dataclass
from typing import Any, ClassVar

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from thermogear.base import bounds
from thermogear.base.bounds import Bounds
from thermogear.base.errors import InputError, nearest, short
from thermogear.base.units import ZERO_CELSIUS
from thermogear.case.units import KINDS, number_in, read_quantity, shown

MOST = 100_000
"""No list in a case file is longer than this."""


class Reader:
    """A field that reads itself; subclasses say how (``read``) and what is written (``schema``)."""

    example: str = ""

    def read(self, raw: object) -> Any:
        """The value that leaves the file."""
        raise InputError("", short(raw))

    def written(self, value: float) -> object:
        """The SI ``value`` as a file holds it, to the last bit."""
        return value

    def within(self, value: float) -> float:
        """``value`` [SI] where the field allows it, for what comes another way than by a file."""
        return float(self.read(self.written(value)))

    def schema(self) -> dict[str, Any]:
        """The JSON schema of what may be written."""
        return {}

    def facts(self) -> dict[str, Any]:
        """What a form needs to know: keys of :mod:`thermogear.case.described`."""
        return {"x-kind": "text"}

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return self.schema()


@dataclass(frozen=True)
class Measure(Reader):
    """A number with a unit, as text: ``"5 mm"``; ``low`` and ``high`` are such texts."""

    kind: str
    low: str | None = None
    high: str | None = None
    why: str | None = None
    example: str = ""

    def __post_init__(self) -> None:
        object.__setattr__(self, "example", f'"{self.example or KINDS[self.kind].example}"')

    @property
    def allowed(self) -> str | None:
        """The range in words: MIN..MAX UNIT."""
        if self.low is None or self.high is None:
            return f">= {self.low}" if self.low else (f"<= {self.high}" if self.high else None)
        low, unit = self.low.split(" ", 1)
        high, unit_of_high = self.high.split(" ", 1)
        same = unit == unit_of_high
        return f"{low}..{high} {unit}" if same else f"{self.low}..{self.high}"

    def read(self, raw: object) -> float:
        try:
            value = read_quantity(raw, self.kind)
        except InputError as error:
            allowed = self.allowed or f"a text: number and unit of {self.kind}"
            # in the unit of this field's own range
            fix = (error.fix or "").replace(
                f' {KINDS[self.kind].shown}"', f" {self.example.split(' ', 1)[1]}"
            )
            raise InputError("", error.got, allowed=allowed, why=error.why, fix=fix) from error
        if self.kind == "temperature" and value <= 0.0:
            raise InputError(
                "",
                short(raw),
                allowed=self.allowed or "> 0 K",
                why="nothing is colder than 0 K (-273.15 degC)",
                fix=f"write for instance {self.example}",
            )
        self._bounded(value, short(raw))
        return value

    def _bounded(self, value: float, got: str) -> None:
        low = -math.inf if self.low is None else read_quantity(self.low, self.kind)
        high = math.inf if self.high is None else read_quantity(self.high, self.kind)
        if low - 1e-12 * abs(low) <= value <= high + 1e-12 * abs(high):
            return
        fix = f"write for instance {self.example}"
        kelvins = self.kind == "temperature" and got.endswith(("K'", "kelvin'"))
        if kelvins and low <= value + ZERO_CELSIUS <= high:
            fix = f'that is {value - ZERO_CELSIUS:g} degC; did you mean "{value:g} degC"?'
        raise InputError("", got, allowed=self.allowed, why=self.why, fix=fix)

    def written(self, value: float) -> str:
        return f"{value!r} {KINDS[self.kind].si}"

    def shown(self, value: float) -> str:
        """The SI ``value`` in the unit of the example."""
        return shown(value, self.kind, unit=self.example.strip('"').split(" ", 1)[1])

    def within(self, value: float) -> float:
        if not math.isfinite(value):
            raise InputError("", f"{value:g}", allowed=self.allowed)
        self._bounded(value, shown(value, self.kind))
        return value

    def schema(self) -> dict[str, Any]:
        allowed = f", {self.allowed}" if self.allowed else ""
        written = f"{self.kind}: number and unit{allowed}"
        return {
            "type": "string",
            "pattern": r"^\s*[+-]?[0-9.].*\S",
            "description": written,
            "$comment": written,  # stays where a field describes its default
            "examples": [self.example.strip('"')],
        }

    def facts(self) -> dict[str, Any]:
        number, unit = self.example.strip('"').split(" ", 1)
        low, high = (
            None if end is None else number_in(read_quantity(end, self.kind), self.kind, unit)
            for end in (self.low, self.high)
        )
        # a temperature's zero is a convention, its leading decade says nothing
        step = 1.0 if self.kind == "temperature" else _step(number, KINDS[self.kind].example)
        return {
            "x-kind": self.kind,
            "x-unit": unit,
            **_range(low, high, step),
            **_about(self.allowed, self.why),
        }


def measure(kind: str, allowed: Bounds, why: str | None = None, example: str = "") -> Measure:
    """The field of a quantity that has its bounds in Python too."""
    low, high = allowed.ends
    return Measure(kind, low, high, why, example)


class Module(Measure):
    """A module by its length, or by its diametral pitch: "8 1/in" is 25.4 mm/8.

    A module in inches is refused: so many inches mean a diametral pitch as often.
    """

    def read(self, raw: object) -> float:
        inches = _INCHES.fullmatch(raw) if isinstance(raw, str) else None
        number = float(inches["number"]) if inches else 0.0
        if inches is None or not number:
            return super().read(raw)
        if inches["unit"].lower() in ("dp", "1/in", "1/inch"):
            return super().read(f"{25.4 / number:.15g} mm")
        raise InputError(
            "",
            short(raw),
            allowed=self.allowed,
            why="a module in inches; in inches gears "
            f"are named by the diametral pitch, here {1.0 / number:.4g} 1/in",
            fix=f'write the metric module "{25.4 * number:.6g} mm"',
        )


_INCHES = re.compile(
    r"\s*(?P<number>\d+\.?\d*|\.\d+)\s*(?P<unit>DP|1/in|1/inch|in|inch|inches|\")\s*", re.IGNORECASE
)


@dataclass(frozen=True, kw_only=True)
class Number(Reader):
    """A pure number within [low, high]."""

    low: float = -math.inf
    high: float = math.inf
    example: str = "0.1"
    why: str | None = None

    @property
    def allowed(self) -> str:
        """The range in words."""
        if math.isfinite(self.low) and math.isfinite(self.high):
            return f"{self.low:g}..{self.high:g}"
        if math.isfinite(self.low):
            return f">= {self.low:g}"
        return f"<= {self.high:g}" if math.isfinite(self.high) else "a finite number"

    def read(self, raw: object) -> float:
        fix = f"write for instance {self.example}"
        if isinstance(raw, str):
            raise InputError(
                "",
                short(raw),
                allowed=self.allowed,
                why="text where a pure number is needed",
                fix=f"{fix}, without quotes and unit",
            )
        if isinstance(raw, bool) or not isinstance(raw, int | float):
            raise InputError("", short(raw), allowed=self.allowed, why="not a number", fix=fix)
        if isinstance(raw, int) and abs(raw) > 2**53:
            raise InputError("", short(raw), allowed=self.allowed, why=self.why, fix=fix)
        value = float(raw)
        if not (math.isfinite(value) and self.low <= value <= self.high):
            raise InputError("", short(raw), allowed=self.allowed, why=self.why, fix=fix)
        return value

    def schema(self) -> dict[str, Any]:
        limits = {"minimum": self.low, "maximum": self.high}
        return {"type": "number"} | {k: v for k, v in limits.items() if math.isfinite(v)}

    def facts(self) -> dict[str, Any]:
        low, high = (end if math.isfinite(end) else None for end in (self.low, self.high))
        limits = _range(low, high, _step(self.example, "0.1"))
        return {"x-kind": "number", **limits, **_about(self.allowed, self.why)}


@dataclass(frozen=True, kw_only=True)
class Count(Reader):
    """A whole number within [low, high]."""

    low: int
    high: int
    example: str = "25"
    why: str | None = None

    def read(self, raw: object) -> int:
        allowed = f"{self.low}..{self.high}"
        fix = f"write for instance {self.example}"
        if isinstance(raw, bool) or not isinstance(raw, int):
            kind = "text" if isinstance(raw, str) else "a value"
            why = f"{kind} where a whole number is needed"
            raise InputError("", short(raw), allowed=f"{allowed}, whole", why=why, fix=fix)
        if not self.low <= raw <= self.high:
            raise InputError("", short(raw), allowed=allowed, why=self.why, fix=fix)
        return raw

    def written(self, value: float) -> object:
        return int(value) if float(value).is_integer() else value

    def schema(self) -> dict[str, Any]:
        return {"type": "integer", "minimum": self.low, "maximum": self.high}

    def facts(self) -> dict[str, Any]:
        limits = {"x-minimum": self.low, "x-maximum": self.high, "x-step": 1}
        return {"x-kind": "count", **limits, **_about(f"{self.low}..{self.high}, whole", self.why)}


class Choice(Reader):
    """One of a few names; an unknown one is answered with the nearest."""

    def __init__(self, *names: str) -> None:
        self.names = names
        self.example = f'"{names[0]}"'

    def read(self, raw: object) -> str:
        if not isinstance(raw, str) or raw not in self.names:
            fix = nearest(raw, self.names) if isinstance(raw, str) else f"write {self.example}"
            if fix.startswith("known:"):
                fix = f"write for instance {self.example}"
            raise InputError("", short(raw), allowed=" | ".join(self.names), fix=fix)
        return raw

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "enum": list(self.names)}

    def facts(self) -> dict[str, Any]:
        return {"x-kind": "choice", "x-choices": list(self.names)}


class NameOrTable(Choice):
    """A name, or a table that holds it as ``key`` with fields of its own.

    The name alone is read as a table of it; ``check`` sees every table that names it.
    """

    def __init__(
        self, key: str, *names: str, check: Callable[[str, Mapping[str, object]], None]
    ) -> None:
        super().__init__(*names)
        self.key, self.check = key, check

    def read(self, raw: object) -> Any:
        if raw is None or isinstance(raw, BaseModel):
            return raw
        if not isinstance(raw, dict):
            return {self.key: super().read(raw)}
        if raw.get(self.key) in self.names:
            self.check(raw[self.key], {k: v for k, v in raw.items() if k != self.key})
        return raw

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_before_validator_function(self.read, handler(source))

    def __get_pydantic_json_schema__(
        self, core: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        return {"anyOf": [self.schema(), handler(core)]}


@dataclass(frozen=True)
class Words(Reader):
    """A line of text."""

    example: str = '"steel"'
    longest: int = 200

    def read(self, raw: object) -> str:
        if not isinstance(raw, str):
            raise InputError("", short(raw), allowed="a text", fix=f"write {self.example}")
        if len(raw) > self.longest or not raw.isprintable():
            raise InputError(
                "", short(raw), allowed=f"one line of at most {self.longest} characters"
            )
        return raw

    def schema(self) -> dict[str, Any]:
        return {"type": "string", "maxLength": self.longest}


@dataclass(frozen=True)
class Several(Reader):
    """A list of what ``one`` reads; with ``single`` one alone may be written without brackets."""

    one: Reader
    _: KW_ONLY
    least: int = 1
    most: int = MOST
    single: bool = True
    distinct: bool = False

    _KINDS_OF_ONE: ClassVar[tuple[type, ...]] = (str, int, float, bool)

    @property
    def example(self) -> str:  # type: ignore[override]
        """A list to copy."""
        return f"[{', '.join([self.one.example] * max(self.least, 1))}]"

    def read(self, raw: object) -> tuple[Any, ...]:
        if self.single and isinstance(raw, self._KINDS_OF_ONE):
            raw = [raw]
        if not isinstance(raw, list | tuple):
            raise InputError("", short(raw), allowed="a list", fix=f"write {self.example}")
        if not self.least <= len(raw) <= self.most:
            several = f"{self.least}..{self.most}" if self.least < self.most else f"{self.least}"
            raise InputError(
                "",
                f"a list of {len(raw)}",
                allowed=f"{several} entries",
                fix=f"write for instance {self.example}",
            )
        values = []
        for place, entry in enumerate(raw):
            try:
                values.append(self.one.read(entry))
            except InputError as error:
                if len(raw) == 1:
                    raise
                raise error.named(f"[{place}]") from error
        if self.distinct and len(set(values)) < len(values):
            twice = next(raw[i] for i, v in enumerate(values) if v in values[:i])
            raise InputError("", f"{short(twice)} twice", allowed="each value once")
        return tuple(values)

    def schema(self) -> dict[str, Any]:
        item = self.one.schema()
        many = {"type": "array", "items": item, "minItems": self.least, "maxItems": self.most}
        return {"anyOf": [item, many]} if self.single else many

    def facts(self) -> dict[str, Any]:
        one = self.one.facts()
        count = f"{self.least}..{self.most} values" if self.most < MOST else None
        if self.least == self.most:
            count = f"{self.least} values"
        return {**one, "x-list": True, **_about(one.get("x-about"), count)}


FOLLOW = {
    "proportional": "every excess over the reference scales with that of the gears' addenda",
    "fixed": "distances in kelvins stay, and what is given outright stays where it is",
}
"""How shafts, housing and oil follow where the gears' temperature is varied."""

BODY = measure("temperature", bounds.BODY)
"""The temperature of gears, oil or housing."""


@dataclass(frozen=True)
class NumberOrTemperature(Reader):
    """The value of a swept parameter: a pure number, or a temperature with its unit."""

    example: str = "0.18"

    def read(self, raw: object) -> tuple[float, str]:
        return (BODY.read(raw), "K") if isinstance(raw, str) else (Number().read(raw), "1")

    def schema(self) -> dict[str, Any]:
        return {"anyOf": [Number().schema(), BODY.schema()]}

    def facts(self) -> dict[str, Any]:
        return {"x-kind": "number or temperature"}


def _range(low: float | None, high: float | None, step: float) -> dict[str, float]:
    """Ends that there are, without the last digits of a conversion."""
    ends = {"x-minimum": low, "x-maximum": high, "x-step": step}
    return {key: float(f"{end:.12g}") for key, end in ends.items() if end is not None}


def _about(*words: str | None) -> dict[str, str]:
    said = "; ".join(one for one in words if one)
    return {"x-about": said} if said else {}


def _step(example: str, usual: str) -> float:
    """A tenth of the leading decade of an example, or of ``usual`` where that is zero."""
    number = abs(float(example.split(" ")[0])) or abs(float(usual.split(" ")[0]))
    return float(f"1e{math.floor(math.log10(number)) - 1}")
