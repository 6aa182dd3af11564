"""What a study found: labelled groups, what is said of them, and where they come from.

Every study returns a :class:`Result`; it is the only thing that is stored, and the only thing a
page is drawn from.
"""

from __future__ import annotations

import datetime
import json
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import thermogear
from thermogear.base.arrays import Dataset, DataTree
from thermogear.base.errors import InputError, nearest
from thermogear.base.files import SCHEMA
from thermogear.base.notice import Notice as Notice
from thermogear.base.notice import stored_notices
from thermogear.base.stores import RESULT as STORE
from thermogear.base.stores import about_store, read_store, require_schema
from thermogear.results.answer import Answer
from thermogear.results.beside import with_notices
from thermogear.results.files import RESULTS, claimed, finite
from thermogear.results.tables import frames, points, told

if TYPE_CHECKING:
    import pandas as pd

FILES = dict.fromkeys(("gear", "dimensionless", "thesis", "sensitivity"), RESULTS)
"""The file of a kind; of every other kind it is ``KIND.nc``."""
OF_POINTS = ("mesh", "motion")
"""Groups of a run that say something of each operating point, as one table."""
SHOWN = 6
"""Notices that a notebook shows."""
FIX = "name a directory that this command, or `thermogear run CASE -o DIR`, has written"

Plain = str | int | float


class Later(Mapping[str, Dataset]):
    """Groups that are made when first asked for, once."""

    def __init__(self, **made: Callable[[], Dataset]) -> None:
        self._made = made
        self._there: dict[str, Dataset] = {}

    def __getitem__(self, name: str) -> Dataset:
        if name not in self._there:
            self._there[name] = self._made[name]()
        return self._there[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._made)

    def __len__(self) -> int:
        return len(self._made)


@dataclass(frozen=True, eq=False, repr=False)
class Result:
    """One finished study of one case.

    ``kind`` names the study; ``groups`` are labelled Datasets by their path (SI, units as
    attributes; "" is the root); ``provenance`` holds the version, the case as it was read, what
    was chosen and what was summed up: texts, numbers, or JSON texts of lists and tables.
    """

    kind: str
    title: str
    groups: Mapping[str, Dataset]
    notices: tuple[Notice, ...] = ()
    provenance: Mapping[str, Plain] = field(default_factory=dict)

    @classmethod
    def of(
        cls,
        kind: str,
        title: str,
        groups: Mapping[str, Dataset],
        notices: Iterable[Notice] = (),
        **provenance: Any,
    ) -> Result:
        """A new result of this version; lists and tables of ``provenance`` become JSON texts."""
        about = {"thermogear": thermogear.__version__, "created": now(), **provenance}
        return cls(kind, title, groups, tuple(notices), {k: _plain(v) for k, v in about.items()})

    def hiding(self, codes: Collection[str]) -> Result:
        """The same without the notices of these ``codes``; a notice says how many there were."""
        hidden = [notice for notice in self.notices if notice.code in codes]
        if not hidden:
            return self
        important = sum(notice.level == "important" for notice in hidden)
        told = Notice.of("notices_hidden", hidden=len(hidden), important=important)
        return replace(self, notices=(told, *(n for n in self.notices if n not in hidden)))

    def with_(self, **provenance: Any) -> Result:
        """The same with more, or other, provenance."""
        more = {name: _plain(value) for name, value in provenance.items()}
        return replace(self, provenance={**self.provenance, **more})

    # --- reading --------------------------------------------------------------------------

    def group(self, name: str) -> Dataset | None:
        """A group by its path, None where it is absent."""
        return self.groups.get(name)

    @property
    def data(self) -> Dataset:
        """The one Dataset of a result that has a single group."""
        if len(self.groups) != 1:
            raise InputError("group", "none named", allowed=" | ".join(self.groups))
        return next(iter(self.groups.values()))

    def text(self, name: str) -> str:
        """An entry of the provenance as text, empty where it is absent."""
        return str(self.provenance.get(name, ""))

    def values(self, name: str) -> list[Any]:
        """An entry that holds a list; empty where it is absent."""
        return _decoded(self.provenance, name, [])

    def rows(self, name: str) -> list[dict[str, Any]]:
        """An entry that holds a list of tables; empty where it is absent."""
        found = self.values(name)
        if not all(isinstance(row, dict) for row in found):
            raise InputError(f"results attribute {name}", "no list of rows", fix=FIX)
        return found

    def table(self, name: str) -> dict[str, Any]:
        """An entry that holds a table; empty where it is absent."""
        return _decoded(self.provenance, name, {})

    @property
    def summary(self) -> dict[str, Any]:
        """What the study summed up, where it did: the figures a script wants."""
        return self.table("summary")

    @property
    def answers(self) -> tuple[Answer, ...]:
        """What the study answered, in the order of the questions; empty where it did not."""
        return tuple(Answer(**row) for row in self.rows("answers"))

    @property
    def interrupted(self) -> bool:
        """Whether Ctrl+C cut the study short; what is here was finished before."""
        return bool(self.provenance.get("interrupted", 0))

    @property
    def stored(self) -> bool:
        """Whether it stands in a store of long work, and not in a file of its own."""
        return bool(self.provenance.get("store", 0))

    # --- as others know it ----------------------------------------------------------------

    @cached_property
    def tree(self) -> DataTree:
        """The whole as an xarray DataTree; title, kind, notices and provenance as attributes."""
        import xarray as xr

        found = xr.DataTree.from_dict({name or "/": data for name, data in self.groups.items()})
        found.attrs = self.attrs
        return found

    @property
    def attrs(self) -> dict[str, Plain]:
        """The root attributes of the stored file."""
        notices = stored_notices(self.notices)
        about: dict[str, Plain] = {"title": self.title, "kind": self.kind, "notices": notices}
        return {**self.provenance, **about, "schema": SCHEMA}

    def __repr__(self) -> str:
        rows = (f"\n  {name}: {axes}" for name, axes in self._axes())
        return f"Result {self.kind}: {self.title}{''.join(rows)}"

    def _axes(self) -> list[tuple[str, str]]:
        """Every group with its axes and their lengths, in words."""
        return [
            (name or "(root)", " × ".join(f"{dim} {size}" for dim, size in data.sizes.items()))
            for name, data in self.groups.items()
        ]

    def _repr_html_(self) -> str:
        """What a notebook shows: title, kind, answers or notices, the groups with their axes."""

        def row(*cells: str) -> str:
            return f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in cells)}</tr>"

        said = [row(one.verdict, one.sentence) for one in self.answers]
        said = said or [row(one.level, one.text) for one in self.notices[:SHOWN]]
        groups = [row(*cells) for cells in self._axes()]
        about = f"{self.kind}, thermogear {self.text('thermogear')}, {self.text('created')}"
        return (
            f"<div><p><b>{escape(self.title)}</b><br>{escape(about.rstrip(', '))}</p>"
            f"<table>{''.join(said)}</table><table>{''.join(groups)}</table>"
            "<p><code>.to_frame()</code>: a row for each point</p></div>"
        )

    def __getitem__(self, path: str) -> Any:
        return self.tree[path]

    def __contains__(self, path: str) -> bool:
        return path in self.tree

    def to_frame(
        self, group: str | None = None, along: Collection[str] = (), *, units: str = "si"
    ) -> pd.DataFrame:
        """A pandas DataFrame: a row for each operating point or grid point, units in the heads.

        Columns are ``name [unit]``, SI or, with ``units`` "display", as pages show them (um, degC,
        rpm). Labels and statuses are words; a point that failed is a row with its status. Curves
        are left out: ``group`` names one group, ``along`` the dimensions of the wanted variables
        (default: those that most variables have), for instance a curve's. Raises InputError for
        names that are not there. Group "answers": a row for each answer, its value in its unit.
        """
        if group == "answers" or (group is None and self.kind == "answers"):
            return told(self.rows("answers"))
        if group is not None and group not in self.groups:
            raise InputError("group", repr(group), fix=nearest(group, list(self.groups)))
        if not self.groups:
            raise InputError("results", "no groups", why="nothing was stored")
        if group is None and not along:
            chosen = [self.groups[one] for one in OF_POINTS if one in self.groups]
            data = points(chosen or list(self.groups.values())[:1])
        else:
            data = self.data if group is None else self.groups[group]
        if "" in self.groups:
            # a store knows no order of its variables
            data = data[sorted(map(str, data.data_vars))]
        found = frames(data, units)
        most = max(found, key=lambda dims: len(found[dims].columns), default=())
        wanted = tuple(sorted(along)) if along else most
        if wanted not in found:
            raise InputError(
                "along", " x ".join(along) or "nothing", allowed=" | ".join(map(" x ".join, found))
            )
        return found[wanted]

    # --- files ----------------------------------------------------------------------------

    @property
    def file(self) -> str:
        """The name of the file it is stored in."""
        return FILES.get(self.kind, f"{self.kind}.nc")

    def write(self, directory: str | Path) -> Path:
        """Store it as ``directory/file`` with its seal; the file.

        The directory is made if new. It holds data alone; :func:`thermogear.save` writes the page
        and the tables too. Raises InputError for a directory of foreign files.
        """
        with claimed(Path(directory)) as folder:
            self.put(folder)
        return Path(directory) / self.file

    def put(self, folder: Path) -> Path:
        """The file alone, into a folder that is ours already."""
        from thermogear.base.netcdf import write_tree

        return write_tree(self.tree, folder / self.file)

    @classmethod
    def read(cls, path: str | Path, fix: str = FIX) -> Result:
        """A stored file, its seal checked, all of it in memory.

        Raises InputError, in one line with ``fix``, where it is missing, damaged or not ours.
        """
        from thermogear.base.netcdf import read_tree

        found = result_of(read_tree(Path(path), fix))
        if not found.kind or "thermogear" not in found.provenance:
            raise InputError("results", str(path), why="it was not written by thermogear", fix=fix)
        return found


def result_of(tree: DataTree) -> Result:
    """What a stored ``tree`` holds, every group in memory."""
    groups = {
        node.path.strip("/"): node.to_dataset(inherit=True).load()
        for node in tree.subtree
        if node.has_data
    }
    return _from_attributes(tree.attrs, groups)


def stored_dataset(data: Dataset, title: str = "") -> Result:
    """The result behind the one Dataset of a store of long work, its attributes as provenance."""
    return _from_attributes({"title": title, **data.attrs, "store": True}, {"": data})


def _from_attributes(attrs: Mapping[Any, Any], groups: Mapping[str, Dataset]) -> Result:
    about = {str(name): _plain(value) for name, value in attrs.items()}
    version = str(about.get("thermogear", ""))
    require_schema(about.pop("schema", 0), newest=SCHEMA, what="results", version=version)
    kind, title = str(about.pop("kind", "")), str(about.pop("title", ""))
    told = _decoded(about, "notices", [])
    about.pop("notices", None)
    if not all(isinstance(one, str | dict) for one in told):
        raise InputError("results attribute notices", "no list of notices", fix=FIX)
    notices = tuple(Notice.stored(one) for one in told)
    return Result(kind, title, groups, notices, about)


_Json = TypeVar("_Json", list[Any], dict[str, Any])


def _decoded(about: Mapping[str, Plain], name: str, absent: _Json) -> _Json:
    """An entry that holds JSON of the kind of ``absent``, which stands for one that is absent."""
    field = f"results attribute {name}"
    try:
        found = json.loads(str(about[name])) if name in about else absent
    except ValueError as error:
        raise InputError(field, "text that is not JSON", fix=FIX) from error
    if not isinstance(found, type(absent)):
        raise InputError(field, f"no {'list' if absent == [] else 'table'}", fix=FIX)
    return found


def open_results(directory: str | Path, kind: str = "") -> Result:
    """What any command has stored in ``directory`` (or in one file), checked and in memory.

    ``kind`` chooses where results of several studies stand in one directory. Raises InputError
    where there are none, several, damaged or foreign ones.
    """
    path = Path(directory)
    if path.is_file():
        return Result.read(path)
    if (path / STORE).exists():
        about = about_store(path)
        data = with_notices(read_store(path))
        return stored_dataset(data, about.pop("title", "")).with_(**about)
    there = sorted(file.name for file in path.glob("*.nc"))
    wanted = [FILES.get(kind, f"{kind}.nc")] if kind else there
    if len(wanted) > 1:
        kinds = [name.removesuffix(".nc") for name in wanted]
        raise InputError("results", f"{path} holds several", fix=f"name one: {' | '.join(kinds)}")
    found = Result.read(path / (wanted[0] if wanted else RESULTS))
    if kind and found.kind != kind:
        raise InputError(
            "results", f"kind {found.kind!r}", allowed=kind, why="it was not written by thermogear"
        )
    return found


def read_results(directory: Path, kinds: Collection[str] = ("gear", "dimensionless")) -> Result:
    """All of ``directory/results.nc``; its kind is one of ``kinds``."""
    path = Path(directory) / RESULTS
    found = Result.read(path)
    if found.kind not in kinds:
        raise InputError("results", str(path), why="it was not written by thermogear", fix=FIX)
    return found


def now() -> str:
    """This moment as a result's ``created`` writes it."""
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def _plain(value: Any) -> Plain:
    """A value as an attribute holds it: lists and tables as JSON."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, Mapping | list | tuple) or value is None:
        return json.dumps(finite(value), allow_nan=False)
    found: Plain = value.item() if hasattr(value, "item") else value
    return found
