"""What a folder of results holds, as words to be compared: for ``checks/same.py``.

Stored variables (netCDF, zarr) are read without thermogear, bit by bit. Everything else a command
tells is kept as text: attributes, JSON, CSV, pages, what it printed. Left out is what says when,
where and with what version.
"""

from __future__ import annotations

import csv
import fnmatch
import hashlib
import json
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import h5netcdf
import numpy as np
import zarr
from numpy.typing import NDArray

Array = NDArray[Any]

LEFT_OUT = frozenset({"thermogear", "thermogear_version", "created", "environment", "seconds"})
"""Attributes and keys of JSON that say when, how long and with what version."""
BLANKED = {
    r"\d{4}-\d\d-\d\dT[\d:.]+(\+[\d:]+|Z)?": "<date>",
    r"thermogear \d+\.\d+\.\d+": "thermogear <version>",
    r"\bin \d+(\.\d+)? s\b": "in <seconds> s",
}
"""The same in running text."""
_DRAWN = re.compile(r"<svg\b.*?</svg>", re.DOTALL)
_NAMES = re.compile(r"(?<=[a-z_])[0-9a-f]{10}\b")
"""The ends of names inside a picture, which matplotlib draws at random."""
FILES_LEFT_OUT = (
    *("lock", "journal.jsonl", "manifest*.json", "*.sha256", ".thermogear"),
    "record*.*",
)
"""Files that hold hashes of others, versions, or nothing; records, which are inputs."""
NAMES_OF_CODE = ("*:claims/code",)
"""Stored texts that name functions: they are told, and do not count as variables."""
TEXTS = (".txt", ".toml", ".html", ".svg")
LONGEST = 200
"""Longer texts are told by their hash."""


@dataclass(frozen=True)
class Stored:
    """One stored variable; ``dims`` are paths, as variables are."""

    dtype: str
    dims: tuple[str, ...]
    shape: tuple[int, ...]
    sha256: str


@dataclass
class Digest:
    """``variables`` by ``folder/file:group/name``, ``told`` texts by where they stand."""

    variables: dict[str, Stored] = field(default_factory=dict)
    told: dict[str, list[str]] = field(default_factory=dict)

    def plain(self) -> dict[str, Any]:
        """For JSON."""
        return {"variables": {k: asdict(v) for k, v in self.variables.items()}, "told": self.told}

    @staticmethod
    def of_plain(content: Mapping[str, Any]) -> Digest:
        """What :meth:`plain` gave."""
        return Digest(
            {
                path: Stored(v["dtype"], tuple(v["dims"]), tuple(v["shape"]), v["sha256"])
                for path, v in content["variables"].items()
            },
            dict(content["told"]),
        )


def digest(folder: Path, name: str, without: Iterable[str] = ()) -> Digest:
    """The digest of every file below ``folder``, their paths beginning with ``name``."""
    found = Digest()
    passed = set(without)
    for path in _files(folder):
        inside = path.relative_to(folder).as_posix()
        if inside in passed or any(fnmatch.fnmatch(path.name, p) for p in FILES_LEFT_OUT):
            continue
        place = f"{name}/{inside}"
        if path.suffix in (".nc", ".zarr"):
            for one in _variables(path):
                if any(fnmatch.fnmatch(f"{place}:{one.path}", p) for p in NAMES_OF_CODE):
                    found.told[f"{place}:{one.path}"] = list(map(blank, _texts(one.values)))
                else:
                    found.variables[f"{place}:{one.path}"] = _stored(one, place)
                found.told |= _attributes(f"{place}:{one.path}", one.attributes)
            for group, attributes in _groups(path):
                found.told |= _attributes(f"{place}:{group}", attributes)
        elif path.suffix == ".csv":
            found.told |= _columns(path, place)
        elif path.suffix == ".json":
            found.told |= _leaves(f"{place}:", json.loads(path.read_text("utf-8")))
        elif path.suffix in TEXTS:
            found.told |= _text(path.read_text("utf-8"), place)
        else:
            found.told[place] = [_hash(path.read_bytes())]
    return found


def values(folder: Path, path: str) -> Array:
    """The numbers or texts of the variable ``path`` (without the name of the digest)."""
    file, _, name = path.partition(":")
    for one in _variables(folder / file):
        if one.path == name:
            return one.values
    raise KeyError(path)


def _files(folder: Path) -> Iterator[Path]:
    """Files, and zarr stores as one."""
    for path in sorted(folder.iterdir()):
        if path.is_dir() and path.suffix != ".zarr":
            yield from _files(path)
        else:
            yield path


# --- arrays ---------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Variable:
    path: str
    dims: tuple[str, ...]
    values: Array
    attributes: Mapping[str, Any]


def _variables(path: Path) -> Iterator[_Variable]:
    if path.suffix == ".zarr":
        for name, array in sorted(zarr.open_group(path, mode="r").arrays()):
            names: Any = array.metadata.to_dict().get("dimension_names")
            yield _Variable(
                name, tuple(map(str, names or ())), np.asarray(array[...]), dict(array.attrs)
            )
        return
    with h5netcdf.File(path, "r") as file:
        yield from _in_group(file, "")


def _in_group(group: Any, above: str) -> Iterator[_Variable]:
    for name, one in sorted(group.variables.items()):
        yield _Variable(above + name, one.dimensions, np.asarray(one[...]), dict(one.attrs))
    for name, inner in sorted(group.groups.items()):
        yield from _in_group(inner, f"{above}{name}/")


def _groups(path: Path) -> Iterator[tuple[str, Mapping[str, Any]]]:
    if path.suffix == ".zarr":
        yield "", dict(zarr.open_group(path, mode="r").attrs)
        return
    with h5netcdf.File(path, "r") as file:
        todo = [("", file)]
        while todo:
            name, group = todo.pop()
            yield name, dict(group.attrs)
            todo += [(f"{name}{inner}/", one) for inner, one in group.groups.items()]


def _stored(one: _Variable, place: str) -> Stored:
    group = one.path.rpartition("/")
    kind, raw = _bytes(one.values)
    dims = tuple(f"{place}:{group[0]}{group[1]}{name}" for name in one.dims)
    return Stored(kind, dims, tuple(one.values.shape), hashlib.sha256(raw).hexdigest())


def _bytes(array: Array) -> tuple[str, bytes]:
    """The kind of an array, and its bytes; texts are one kind, however they are stored."""
    if array.dtype.kind in "OUST":
        return "text", json.dumps(_texts(array)).encode()
    little = np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<"), copy=False)
    return little.dtype.str, little.tobytes()


def _texts(array: Array) -> list[str]:
    return [v.decode() if isinstance(v, bytes) else str(v) for v in array.ravel().tolist()]


# --- texts ----------------------------------------------------------------------------------


def blank(text: str) -> str:
    """``text`` without dates, versions and seconds; its hash where it is long."""
    text = _without(text)
    return text if len(text) <= LONGEST else f"{text[:40]}... {_hash(text.encode())}"


def _without(text: str) -> str:
    for pattern, word in BLANKED.items():
        text = re.sub(pattern, word, text)
    return text


def _hash(raw: bytes) -> str:
    return hashlib.sha256(raw).hexdigest()[:16]


def _attributes(place: str, attributes: Mapping[str, Any]) -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name, value in attributes.items():
        if name not in LEFT_OUT:
            plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
            found |= _leaves(f"{place}@{name}", plain)
    return found


def _leaves(place: str, content: Any) -> dict[str, list[str]]:
    """Every leaf of what JSON holds; a text that is JSON is opened too."""
    if isinstance(content, str) and content[:1] in ("{", "["):
        try:
            content = json.loads(content)
        except ValueError:
            return {place: [blank(content)]}
    if isinstance(content, Mapping) and content:
        found: dict[str, list[str]] = {}
        for key, value in content.items():
            if key not in LEFT_OUT:
                found |= _leaves(f"{place}/{key}", value)
        return found
    if isinstance(content, list):
        if not any(isinstance(value, dict | list) for value in content):
            return {place: [blank(str(value)) for value in content]}
        found = {}
        for number, value in enumerate(content):
            found |= _leaves(f"{place}/{number}", value)
        return found
    return {place: [blank(str(content))]}


def _columns(path: Path, place: str) -> dict[str, list[str]]:
    """The cells of a table, column by column under their heads."""
    with path.open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    heads = rows[0] if rows else []
    wide = max(map(len, rows), default=0)
    names: list[str] = []
    for name in (heads[i] if i < len(heads) else "" for i in range(wide)):
        count = sum(name == other.partition(" #")[0] for other in names)
        names.append(f"{name} #{count + 1}" if count else name)
    return {
        f"{place}:{name}": [row[i] if i < len(row) else "" for row in rows[1:]]
        for i, name in enumerate(names)
    }


def _text(text: str, place: str) -> dict[str, list[str]]:
    """Lines; what is JSON as its leaves."""
    if text[:1] in ("{", "["):
        try:
            return _leaves(f"{place}:", json.loads(text))
        except ValueError:
            pass
    return {f"{place}:": [blank(line) for line in _DRAWN.sub(_picture, text).splitlines()]}


def _picture(found: re.Match[str]) -> str:
    """One word for a picture."""
    known: dict[str, str] = {}
    text = _NAMES.sub(lambda name: known.setdefault(name[0], f"-{len(known)}"), found[0])
    return f"<svg {_hash(_without(text).encode())}>"
