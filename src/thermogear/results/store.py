"""Long work on disk: checked chunks that no kill, full disk or flipped bit can falsify.

A store is a directory: ``result.zarr`` (zarr v3, opened by xarray), ``manifest.json`` (what the
work is, twice), ``journal.jsonl`` (what is finished, with a hash of every chunk's numbers),
``quarantine`` (chunks that failed their check) and ``lock``. A chunk counts as finished when the
journal says so and its decoded numbers have the hash written there; everything else is computed
again. One writer at a time.
"""

from __future__ import annotations

import hashlib
import json
import os
import zlib
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import numpy as np
import zarr
from numpy.typing import NDArray
from zarr.codecs import Crc32cCodec, ZstdCodec
from zarr.storage import LocalStore, MemoryStore

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError
from thermogear.base.files import (
    LOCK,
    PART,
    clear_parts,
    held,
    put,
    require_directory,
    sync,
)
from thermogear.base.plan import Arrays, Key, Plan, dataset_of, empty_arrays, keys_of, region_of
from thermogear.base.stores import (
    COPY,
    FORMAT,
    JOURNAL,
    MANIFEST,
    METADATA,
    RESULT,
    foreign_names,
    numbers_hash,
    read_manifests,
    read_vouched,
)
from thermogear.results.fingerprint import code_version, environment
from thermogear.results.result import now

QUARANTINE = "quarantine"

_KIND = "go on with it where it was begun, by version and kind of machine, or in a new directory"
_OTHER = "name another directory, or repeat the command the store was begun with"


def put_bytes(path: Path, data: bytes) -> None:
    """Write ``data`` beside ``path``, flush it to the disk, put it in place."""
    path.parent.mkdir(parents=True, exist_ok=True)
    put(path, data)
    sync(path.parent)


class Staging:
    """Encodes arrays into the bytes of zarr files, in memory."""

    def __init__(self) -> None:
        self._files: dict[str, Any] = {}
        self._arrays: dict[str, zarr.Array[Any]] = {}
        self._group = zarr.group(store=MemoryStore(store_dict=self._files), zarr_format=3)

    def make(
        self,
        name: str,
        dims: tuple[str, ...],
        *,
        shape: tuple[int, ...],
        chunks: tuple[int, ...],
        dtype: np.dtype[Any],
        fill: float | int | None,
        attributes: Mapping[str, Any],
    ) -> None:
        """An empty array of the group."""
        # kept as made: an array opened again forgets to write chunks of nothing but fill
        self._arrays[name] = self._group.create_array(
            name,
            shape=shape,
            chunks=chunks,
            dtype=dtype,
            fill_value=fill,
            compressors=[ZstdCodec(level=3), Crc32cCodec()],
            dimension_names=dims,
            attributes=_plain(attributes),
            config={"write_empty_chunks": True},
        )

    def attributes(self, values: Mapping[str, Any]) -> None:
        """Attributes of the whole."""
        self._group.attrs.put(_plain(values))

    def take(self, name: str, region: tuple[slice, ...], values: NDArray[Any]) -> dict[str, bytes]:
        """The files that hold ``values`` at ``region``, by path; nothing of them is kept."""
        self._arrays[name][region] = values
        inside = f"{name}/c"
        found = [path for path in self._files if path == inside or path.startswith(inside + "/")]
        return {path: self._files.pop(path).to_bytes() for path in found}

    def metadata(self) -> dict[str, bytes]:
        """The zarr.json files."""
        return {
            path: data.to_bytes()
            for path, data in sorted(self._files.items())
            if path.endswith(METADATA)
        }


def _plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """Attributes as JSON knows them."""

    def one(value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return [one(v) for v in value.tolist()]
        if isinstance(value, np.generic):
            value = value.item()
        return str(value) if isinstance(value, float) and not np.isfinite(value) else value

    return {str(k): one(v) for k, v in values.items()}


class Store:
    """One plan's results on disk, held by this process alone; use it in a ``with`` block."""

    def __init__(self, directory: Path, plan: Plan) -> None:
        self.directory = Path(directory)
        self.plan = plan
        self.repaired: list[str] = []
        self._held = ExitStack()
        self._hashes: dict[Key, Mapping[str, str]] = {}
        self._whole = empty_arrays(plan)
        self._readers: dict[str, zarr.Array[Any]] = {}
        self._staging = Staging()
        for name, v in plan.variables().items():
            shape = tuple(int(plan.sizes[d]) for d in v.dims)
            chunks = tuple(int(plan.cuts.get(d, plan.sizes[d])) for d in v.dims)
            self._staging.make(
                name,
                v.dims,
                shape=shape,
                chunks=chunks,
                dtype=np.dtype(v.dtype),
                fill=v.fill,
                attributes=v.attributes,
            )

    # --- opening and closing ---------------------------------------------------------------

    def __enter__(self) -> Self:
        require_directory(self.directory, "store")
        known = (self.directory / MANIFEST).exists() or (self.directory / COPY).exists()
        inside = [p.name for p in self.directory.iterdir()] if self.directory.is_dir() else []
        begun = {n for n in inside if n.startswith(f".{MANIFEST}.") and n.endswith(PART)}
        if not known and set(inside) - {LOCK} - begun:
            raise InputError(
                "store",
                str(self.directory),
                why="the directory holds files that are not a store",
                fix="name a new or an empty directory",
            )
        self.directory.mkdir(parents=True, exist_ok=True)
        with ExitStack() as stack:
            stack.enter_context(held(self.directory, "store"))
            clear_parts(self.result.rglob(f".*{PART}"))
            self._agree()
            self._repair_metadata()
            self._hashes |= read_vouched(self.directory).chunks
            self._held = stack.pop_all()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._held.close()

    @property
    def result(self) -> Path:
        """The zarr group."""
        return self.directory / RESULT

    def _manifest(self) -> str:
        content = {
            "format": FORMAT,
            "kind": self.plan.kind,
            "inputs": self.plan.inputs(),
            "chunks": {name: int(n) for name, n in self.plan.cuts.items()},
            "code": code_version(),
            "environment": environment(),
        }
        return json.dumps(content, indent=1)

    def _agree(self) -> None:
        """Begin a manifest, or refuse a store that was begun with something else."""
        text = self._manifest()
        stored = next(iter(read_manifests(self.directory).values()), None)
        if stored is not None:
            difference = first_difference(stored, json.loads(text))
            if difference is not None:
                field, old, new = difference
                raise InputError(
                    field.removeprefix("inputs."),
                    new,
                    allowed=old,
                    why=f"the store {self.directory} was begun with the latter",
                    fix=_KIND if field.startswith(("environment", "code")) else _OTHER,
                )
        elif (self.directory / MANIFEST).exists() or (self.directory / COPY).exists():
            # both copies are damaged: nothing of what lies here can be trusted or thrown away
            raise InputError(
                "store",
                str(self.directory),
                why="both copies of its manifest are damaged",
                fix="name another directory",
            )
        seal = hashlib.sha256(text.encode()).hexdigest()
        whole = f"{seal}\n{text}\n".encode()
        for name in (MANIFEST, COPY):
            path = self.directory / name
            if not path.exists() or path.read_bytes() != whole:
                if stored is not None:
                    self.repaired.append(name)
                put_bytes(path, whole)

    def _repair_metadata(self) -> None:
        finished = read_vouched(self.directory).metadata.get(METADATA)
        for path, data in self._staging.metadata().items():
            place = self.result / path
            there = place.read_bytes() if place.exists() else b""
            # a finished store's root carries attributes that a plan does not know
            own = path == METADATA and hashlib.sha256(there).hexdigest() == finished
            if there != data and not own:
                if place.exists():
                    self.repaired.append(path)
                put_bytes(place, data)

    # --- the journal -----------------------------------------------------------------------

    def _note(self, entry: Mapping[str, Any]) -> None:
        text = json.dumps(entry, separators=(",", ":"))
        line = f"{zlib.crc32(text.encode()):08x} {text}\n"
        path = self.directory / JOURNAL
        with path.open("ab") as file:
            # a line that a kill tore off must not swallow this one
            if file.tell() and not _ends_line(path):
                file.write(b"\n")
            file.write(line.encode())
            file.flush()
            os.fsync(file.fileno())

    # --- chunks ----------------------------------------------------------------------------

    def write(self, key: Key, arrays: Arrays) -> None:
        """Store a chunk: its files first, then the line that vouches for them."""
        hashes: dict[str, str] = {}
        for name, variable in self.plan.variables().items():
            region = region_of(self.plan, key, variable)
            for path, data in self._staging.take(name, region, arrays[name]).items():
                put_bytes(self.result / path, data)
            hashes[name] = numbers_hash(arrays[name])
            self._whole[name][region] = arrays[name]
        self._note({"chunk": list(key), "sha256": hashes})
        self._hashes[key] = hashes

    def load(self, key: Key) -> Arrays:
        """A finished chunk's arrays; InputError where its check fails."""
        found: Arrays = {}
        if not self._readers:
            group = zarr.open_group(LocalStore(self.result, read_only=True), mode="r")
            for name in self.plan.variables():
                array = group[name]
                assert isinstance(array, zarr.Array)
                self._readers[name] = array
        for name, variable in self.plan.variables().items():
            region = region_of(self.plan, key, variable)
            for path in self._paths(name, key):
                if not path.exists():
                    raise InputError(str(path), "no such chunk", fix="repeat the command")
            try:
                values = np.asarray(self._readers[name][region])
            except Exception as error:  # whatever a decoder makes of broken bytes
                raise InputError(
                    f"{name} chunk {key}", type(error).__name__, why="it cannot be decoded"
                ) from error
            if numbers_hash(values) != self._hashes.get(key, {}).get(name):
                raise InputError(f"{name} chunk {key}", "other numbers than the journal's")
            found[name] = values
        return found

    def _paths(self, name: str, key: Key) -> list[Path]:
        variable = self.plan.variables()[name]
        place = dict(zip(self.plan.cuts, key, strict=True))
        parts = [str(place.get(d, 0)) for d in variable.dims]
        return [self.result.joinpath(name, "c", *parts)]

    def finished(self) -> set[Key]:
        """The chunks whose numbers pass their check; what fails goes to quarantine."""
        good: set[Key] = set()
        for key in keys_of(self.plan):
            if key not in self._hashes:
                continue
            try:
                arrays = self.load(key)
            except InputError:
                self._set_aside(key)
                continue
            good.add(key)
            for name, values in arrays.items():
                self._whole[name][region_of(self.plan, key, self.plan.variables()[name])] = values
        return good

    def _set_aside(self, key: Key) -> None:
        self.repaired.append(f"chunk {key}")
        del self._hashes[key]
        paths = [path for name in self.plan.variables() for path in self._paths(name, key)]
        self._quarantine([path for path in paths if path.exists()])

    def _quarantine(self, paths: Sequence[Path]) -> None:
        if not paths:
            return
        bin_ = self.directory / QUARANTINE
        bin_.mkdir(exist_ok=True)
        number = sum(1 for _ in bin_.iterdir())
        for path in paths:
            words = "-".join(path.relative_to(self.result).parts)
            path.replace(bin_ / f"{number}-{words}")

    # --- the finished whole ----------------------------------------------------------------

    def complete(self, title: str = "") -> Dataset:
        """Add to the chunks, once all are there, what follows from them, and store that too."""
        variables = self.plan.variables()
        missing = [key for key in keys_of(self.plan) if key not in self._hashes]
        if missing:
            raise InputError(
                "store", f"{len(missing)} chunks are missing", fix="compute them first"
            )
        data = dataset_of(self.plan, self._whole)
        extras = {str(n): v for n, v in data.variables.items() if str(n) not in variables}
        staging = Staging()
        hashes: dict[str, str] = {}
        for name, variable in extras.items():
            values = np.asarray(variable.values)
            dims = tuple(str(d) for d in variable.dims)
            shape = values.shape
            chunks = tuple(max(1, n) for n in shape)
            staging.make(
                name,
                dims,
                shape=shape,
                chunks=chunks,
                dtype=values.dtype,
                fill=None,
                attributes=variable.attrs,
            )
            region = tuple(slice(0, n) for n in shape)
            files = staging.take(name, region, values) if values.size else {}
            for path, content in files.items():
                put_bytes(self.result / path, content)
            hashes[name] = numbers_hash(values)
        staging.attributes(data.attrs | {"coordinates": " ".join(sorted(map(str, data.coords)))})
        for path, content in staging.metadata().items():
            put_bytes(self.result / path, content)
        metadata = self._staging.metadata() | staging.metadata()
        foreign = foreign_names(self.result, metadata)
        self.repaired += foreign
        self._quarantine([self.result / name for name in foreign])
        whole = {
            "numbers": hashes,
            "metadata": {p: hashlib.sha256(raw).hexdigest() for p, raw in metadata.items()},
            "manifest": hashlib.sha256(self._manifest().encode()).hexdigest(),
        }
        before = read_vouched(self.directory)
        if whole != {name: getattr(before, name) for name in whole}:
            self._note({"whole": whole, "created": now(), "title": title})
        return data


def _ends_line(path: Path) -> bool:
    with path.open("rb") as file:
        file.seek(-1, os.SEEK_END)
        return file.read(1) == b"\n"


def first_difference(old: Any, new: Any, field: str = "") -> tuple[str, str, str] | None:
    """Name, old and new value of the first field in which two plain structures differ."""
    if isinstance(old, dict) and isinstance(new, dict):
        for key in [*old, *(k for k in new if k not in old)]:
            name = f"{field}.{key}" if field else str(key)
            if key not in old or key not in new:
                return name, _short(old.get(key, "nothing")), _short(new.get(key, "nothing"))
            found = first_difference(old[key], new[key], name)
            if found is not None:
                return found
        return None
    if isinstance(old, list) and isinstance(new, list):
        if len(old) != len(new):
            return field, f"{len(old)} values", f"{len(new)} values"
        for place, (one, two) in enumerate(zip(old, new, strict=True)):
            found = first_difference(one, two, f"{field}[{place}]")
            if found is not None:
                return found
        return None
    return None if type(old) is type(new) and old == new else (field, _short(old), _short(new))


def _short(value: object) -> str:
    text = json.dumps(value) if not isinstance(value, str) else value
    return text if len(text) <= 60 else text[:57] + "..."
