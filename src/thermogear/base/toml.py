"""The nested tables of a TOML text, dotted overrides put into them, and TOML written."""

from __future__ import annotations

import datetime
import json
import math
import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from operator import itemgetter
from typing import Any

from thermogear.base.errors import InputError, nearest, printable, short

NAMED = {"model.friction": "law"}
"""A name that may replace a table, and the field of the table that holds it."""

_KEY = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+( [A-Za-z0-9_-]+)*)*")


MOST_KEYS = 16
"""Names in one dotted key. Chosen: the case file's longest has 6; parsing costs their square."""
_LONG_KEY = re.compile(
    r"""(?m)(?:^|[\[{,])[ \t]*+(?:(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+\.[ \t]*+)"""
    f"{{{MOST_KEYS}}}"
)


def tables(name: str, text: str) -> dict[str, Any]:
    """The tables of a TOML text; a syntax error names line and column."""
    if long := _LONG_KEY.search(text):
        line = text.count("\n", 0, long.start()) + 1
        raise InputError(
            name, f"a key of more than {MOST_KEYS} names in line {line}", allowed="TOML of a case"
        )
    if not text.strip():
        raise InputError(name, "an empty file", fix="`thermogear example rig` shows a case file")
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as cause:
        match = re.fullmatch(r"(?P<what>.*) \(at (?P<where>.*)\)", str(cause), re.DOTALL)
        what, where = (match["what"], match["where"]) if match else (str(cause), "some line")
        unquoted = what.startswith(("Invalid value", "Expected newline"))
        fix = 'a value with its unit stands in quotes: "5 mm"' if unquoted else None
        if text.lstrip().startswith(("{", "<")):
            fix = "a case file is TOML; `thermogear example rig` shows one"
        elif what.startswith("Illegal character '\\n'"):
            fix = "a text ends with the quote it began with"
        raise InputError(name, f"invalid TOML at {where}", why=what, fix=fix) from cause
    except (ValueError, RecursionError) as cause:
        raise InputError(name, "a number or a nesting beyond reason", allowed="TOML") from cause


def pairs(overrides: Mapping[str, str] | Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Overrides as (dotted path, text), from a mapping or from ``"a.b=c"``."""
    if isinstance(overrides, Mapping):
        return tuple((dotted(str(key)), str(value)) for key, value in overrides.items())
    found = []
    for text in overrides:
        key, equals, value = text.partition("=")
        if not equals:
            raise InputError(
                "--set", short(text), allowed="PATH=VALUE", fix="write gears.pinion.teeth=30"
            )
        found.append((dotted(key.strip()), value.strip()))
    return tuple(found)


def overridden(data: dict[str, Any], changes: tuple[tuple[str, str], ...]) -> dict[str, Any]:
    """``data`` with ``changes`` put in; tables on the way are new, made where missing.

    A key of a list is the number of an entry, from 0, its name, or "all" for every one. An
    empty text leaves out what ``data`` holds at its path, a field or a table; InputError where
    ``data`` holds nothing there, and where a list has no such entry. ``data`` itself stays as
    it is.

    >>> overridden({"oil": {"name": "M220"}}, (("oil.name", ""), ("grid.harmonics", "12")))
    {'oil': {}, 'grid': {'harmonics': 12}}
    >>> overridden({"bearings": [{}, {"play": "9 um"}]}, (("bearings.1.play", "12 um"),))
    {'bearings': [{}, {'play': '12 um'}]}
    """
    if any(path.startswith("bearings.") for path, _ in changes):
        data = at_the_ends(data, moved=True)
    made = dict(data)
    for path, text in changes:
        if not settable(path):
            raise InputError(short(path), "no path", allowed="dotted names: gears.pinion.teeth")
        if not text.strip():
            _require_held(data, path)
        for place in entries_of(made, path):
            keys = place.split(".")
            # an earlier change may have left out more
            if text.strip() or held(made, place)[0] == len(keys):
                made = _put(made, keys, 0, text)
    return made


def entries_of(data: Mapping[str, Any], path: str) -> list[str]:
    """The paths that ``path`` means: "all" is written out for every entry of its list.

    >>> entries_of({"bearings": [{}, {}]}, "bearings.all.play")
    ['bearings.0.play', 'bearings.1.play']
    """
    before, every, after = path.partition(".all.")
    entries = held(data, before)[1] if every else None
    if not isinstance(entries, list):
        return [path]
    numbered = (f"{before}.{number}.{after}" for number in range(len(entries)))
    return [place for one in numbered for place in entries_of(data, one)]


def _put(inside: Any, keys: list[str], depth: int, text: str) -> Any:
    """A copy of the table or list at ``keys[:depth]`` with ``text`` at the end of the keys."""
    above = ".".join(keys[:depth])
    if isinstance(inside, str) and above in NAMED:
        inside = {NAMED[above]: inside}
    if not isinstance(inside, dict | list):
        raise InputError(".".join(keys), "an unknown path", why=f"{above} is a value, not a table")
    made: Any = inside.copy()
    key: Any = _entry(inside, keys, depth) if isinstance(inside, list) else keys[depth]
    if depth + 1 < len(keys):
        if key not in made and (keys[depth + 1] == "all" or keys[depth + 1].isdecimal()):
            raise InputError(".".join(keys), "no list", why=f"the file holds no {key}")
        below = inside.get(key, {}) if isinstance(inside, dict) else inside[key]
        made[key] = _put(below, keys, depth + 1, text)
    elif text.strip():
        made[key] = value_of(text)
    else:
        del made[key]
    return made


def _entry(entries: list[Any], keys: list[str], depth: int) -> int:
    """The number of an entry that a key means."""
    key, count = keys[depth], len(entries)
    if key.isdecimal() and len(key) < 9 and int(key) < count:
        return int(key)
    names = [one.get("name") for one in entries if isinstance(one, Mapping)]
    if key in names:
        return names.index(key)
    allowed = f"0..{count - 1}, or all" if count else "none: the list is empty"
    allowed += f", or a name: {', '.join(map(str, names))}" * bool(names and all(names))
    raise InputError(".".join(keys), f"entry {key} of {'.'.join(keys[:depth])}", allowed=allowed)


def at_the_ends(data: dict[str, Any], *, moved: bool = False) -> dict[str, Any]:
    """The tables of a file with the bearings that its shafts name at their ends among the others.

    One name serves both ends; two are the left and the right one. ``moved``: the shafts name them
    no longer.
    """
    shafts, bearings = data.get("shafts"), data.get("bearings", [])
    if not isinstance(shafts, list) or not isinstance(bearings, list):
        return data
    more, kept = [], []
    for one in shafts:
        named = one.get("bearings") if isinstance(one, dict) else None
        types: Any = [named] if isinstance(named, str) else named
        known = isinstance(one, dict) and one.get("gear") in ("pinion", "wheel")
        fits = isinstance(types, list) and 1 <= len(types) <= 2
        if not known or not fits or not all(isinstance(t, str) for t in types):
            kept.append(one)  # the shaft itself says what is wrong
        else:
            ends = zip(("left", "right"), (types[0], types[-1]), strict=True)
            more += [{"shaft": one["gear"], "end": end, "type": t} for end, t in ends]
            kept.append({k: v for k, v in one.items() if not (moved and k == "bearings")})
    return {**data, "shafts": kept, "bearings": [*bearings, *more]} if more else data


def dotted(path: str) -> str:
    """A path as messages write it, ``bearings[0].play``, with dots alone."""
    return re.sub(r"\[(\w+)\]", r".\1", path)


def settable(path: str) -> bool:
    """Whether an override can name ``path``: dotted keys of letters, digits, ``_`` and ``-``."""
    return path.count(".") < MOST_KEYS and _KEY.fullmatch(path) is not None


def _require_held(data: Mapping[str, Any], path: str) -> None:
    """Refuse to leave out what the file does not hold."""
    parts = path.split(".")
    depth, inside = max((held(data, one) for one in entries_of(data, path)), key=itemgetter(0))
    if depth < len(parts):
        known = inside if isinstance(inside, Mapping) else ()
        above = f"[{'.'.join(parts[:depth])}] of " if depth else ""
        raise InputError(
            path,
            "nothing to leave out",
            why=f"{above}the file does not hold {parts[depth]}",
            fix=nearest(parts[depth], known) if known else f"write --set {path}=VALUE to put it in",
        )


def held(data: Mapping[str, Any], path: str) -> tuple[int, Any]:
    """How many keys of ``path`` lead somewhere in ``data``, and what is there.

    >>> held({"shafts": [{"gear": "pinion"}]}, "shafts.0.gear")
    (3, 'pinion')
    """
    inside: Any = data
    parts = path.split(".")
    for depth, key in enumerate(parts):
        if isinstance(inside, str) and (name := NAMED.get(".".join(parts[:depth]))):
            inside = {name: inside}
        if isinstance(inside, list) and key != "all":
            inside = inside[_entry(inside, parts, depth)]
        elif isinstance(inside, Mapping) and key in inside:
            inside = inside[key]
        else:
            return depth, inside
    return len(parts), inside


def told(path: str, text: str) -> str:
    """An override in words: ``path = text``, or that it is left out."""
    return f"{path} = {text}" if text.strip() else f"{path} left out"


def given(value: Any) -> str:
    """``value`` as a person writes it behind ``--set PATH=``: a text without quotes where it may.

    >>> given("5 mm"), given("12"), given(12), given([{"order": 1}])
    ('5 mm', '"12"', '12', '[{ order = 1 }]')
    """
    plain = isinstance(value, str) and value and value == value.strip() and value_of(value) == value
    return value if plain else literal(value)


def value_of(text: str) -> Any:
    """The value of an override: TOML where it is TOML, else the text itself."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return parsed["value"] if set(parsed) == {"value"} else text


# --- writing ----------------------------------------------------------------------------------


def line(key: str, value: Any, comment: str = "") -> str:
    """``key = value   # comment``, or nothing where there is no value."""
    if value is None:
        return ""
    return f"{quoted(key)} = {literal(value)}" + (f"   # {flat(comment)}" if comment else "")


def table(name: str, *lines: str) -> list[str]:
    """A table of those lines that say something; none where none does."""
    said = [one for one in lines if one]
    return [*([heading(name)] if name else []), *said] if said else []


def heading(name: str) -> str:
    """``[a.b]`` of a dotted name."""
    return f"[{name}]"


def literal(value: Any) -> str:
    """A text, number, truth, list or table as TOML, numbers to the last bit."""
    if isinstance(value, Mapping):
        inside = ", ".join(f"{quoted(key)} = {literal(one)}" for key, one in value.items())
        return f"{{ {inside} }}" if inside else "{}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(literal(one) for one in value)}]"
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def written(data: Mapping[str, Any]) -> str:
    """Nested tables as a whole TOML text, numbers to the last bit; ``None`` is left out.

    >>> print(written({"title": "mine", "gears": {"module": "3 mm", "pinion": {"teeth": 19}}}))
    title = "mine"
    <BLANKLINE>
    [gears]
    module = "3 mm"
    <BLANKLINE>
    [gears.pinion]
    teeth = 19
    <BLANKLINE>
    """
    return "\n".join(_lines(data, "")).removeprefix("\n") + "\n"


def _lines(data: Mapping[str, Any], name: str) -> Iterator[str]:
    """Plain values first, since a heading would take them, then tables and lists of tables."""
    inner = {key: one for key, one in data.items() if isinstance(one, Mapping) or _of_tables(one)}
    yield from (line(key, one) for key, one in data.items() if key not in inner and one is not None)
    for key, one in inner.items():
        path = f"{name}.{quoted(key)}" if name else quoted(key)
        each, head = ([one], f"[{path}]") if isinstance(one, Mapping) else (one, f"[[{path}]]")
        for table in each:
            yield from ("", head, *_lines(table, path))


def _of_tables(value: Any) -> bool:
    """Whether ``value`` is a list of tables alone."""
    several = isinstance(value, list | tuple) and len(value) > 0
    return several and all(isinstance(one, Mapping) for one in value)


def flat(text: str) -> str:
    """``text`` as a comment may hold it: one line, printable."""
    return printable(" ".join(text.split()))


def quoted(key: str) -> str:
    """``key`` bare where TOML allows it, else in quotes."""
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else literal(key)
