"""Finished stores as Datasets: every number and every word of what they mean checked.

A store is a directory: ``result.zarr`` (zarr v3), ``manifest.json`` (what the work is, twice) and
``journal.jsonl``: what is finished, with a hash of every chunk's numbers, and, once all is there,
of every other array's numbers, of every ``zarr.json`` (units, meanings, names of the axes) and of
the manifest. :mod:`thermogear.results.store` writes them.
"""

from __future__ import annotations

import hashlib
import json
import zlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from thermogear.base.arrays import Dataset
from thermogear.base.errors import InputError

RESULT = "result.zarr"
MANIFEST = "manifest.json"
COPY = "manifest.copy.json"
JOURNAL = "journal.jsonl"
METADATA = "zarr.json"
FORMAT = 2

_AGAIN = "repeat the command that began it"


def require_schema(stated: object, *, newest: int, what: str, version: str) -> None:
    """Refuse ``what`` whose schema ``stated`` is above the ``newest`` known here.

    Raises InputError, one line with the schema and the ``version`` of thermogear that wrote it.
    """
    schema = int(stated) if isinstance(stated, int | np.integer) else 0
    if schema > newest:
        raise InputError(
            what,
            f"schema {schema}",
            allowed=f"at most {newest}",
            why=f"thermogear {version or '(version not stated)'} wrote it",
            fix="read it with that version, or a newer one",
        )


def numbers_hash(values: NDArray[Any]) -> str:
    """sha256 of an array's numbers, independent of how they are compressed."""
    plain = np.ascontiguousarray(values)
    little = plain.astype(plain.dtype.newbyteorder("<"), copy=False)
    return hashlib.sha256(little.tobytes()).hexdigest()


def read_journal(directory: Path) -> list[dict[str, Any]]:
    """The journal's lines that are whole; torn or damaged ones prove nothing."""
    try:
        raw = (Path(directory) / JOURNAL).read_bytes()
    except FileNotFoundError:
        return []
    found: list[dict[str, Any]] = []
    for line in raw.split(b"\n"):
        seal, _, text = line.partition(b" ")
        if seal != b"%08x" % zlib.crc32(text) or not text:
            continue
        entry = json.loads(text)
        if isinstance(entry, dict):
            found.append(entry)
    return found


def read_manifests(directory: Path) -> dict[str, dict[str, Any]]:
    """The copies of the manifest that are whole, by the sha256 of their text."""
    found: dict[str, dict[str, Any]] = {}
    for name in (MANIFEST, COPY):
        try:
            raw = (Path(directory) / name).read_bytes()
        except (FileNotFoundError, NotADirectoryError):
            continue
        seal, _, text = raw.partition(b"\n")
        if hashlib.sha256(text.rstrip(b"\n")).hexdigest().encode() == seal:
            content = json.loads(text)
            if isinstance(content, dict):
                found[seal.decode()] = content
    return found


@dataclass(frozen=True)
class Vouched:
    """What a journal vouches for.

    ``chunks``: hashes of the numbers of each finished chunk, by variable. Of a finished whole:
    ``numbers`` of every other array, ``metadata`` of every zarr.json by its path, ``manifest``;
    ``created``: when it was finished, ``title`` of its case.
    """

    chunks: Mapping[tuple[int, ...], Mapping[str, str]] = field(default_factory=dict)
    numbers: Mapping[str, str] = field(default_factory=dict)
    metadata: Mapping[str, str] = field(default_factory=dict)
    manifest: str = ""
    created: str = ""
    title: str = ""


def read_vouched(directory: Path) -> Vouched:
    """What the journal of ``directory`` vouches for; its last word on each."""
    chunks: dict[tuple[int, ...], dict[str, str]] = {}
    whole: dict[str, Any] = {}
    told: dict[str, str] = {}
    for entry in read_journal(directory):
        if "chunk" in entry:
            chunks[tuple(entry["chunk"])] = entry["sha256"]
        whole = entry.get("whole", whole)
        told |= {name: entry[name] for name in ("created", "title") if name in entry}
    return Vouched(chunks, **{**whole, **told})


def about_store(directory: Path) -> dict[str, Any]:
    """Whose a finished store is: case, changes, bundle, heat, what was fixed, version and date."""
    vouched = read_vouched(directory)
    manifest = read_manifests(directory).get(vouched.manifest, {})
    inputs = manifest.get("inputs", {})
    found = {name: inputs[name] for name in ("torque",) if name in inputs}
    model = inputs.get("model", {})
    own = ("case", "overrides", "bundle", "state") if "case" in model else ()
    found |= {name: model[name] for name in own}
    found |= {} if own else {"model": model}
    if "temperatures" in inputs:
        found.pop("state", None)  # several, told with the figures
    code = str(manifest.get("code", "")).partition("+")[0]
    return found | {"thermogear": code, "created": vouched.created, "title": vouched.title}


class _Damage(Exception):
    """What is not as it was written."""


def read_store(directory: str | Path) -> Dataset:
    """A finished store as a Dataset in memory: numbers and metadata checked against the journal.

    Raises InputError where the directory is no store, is not finished, or is damaged, be it by a
    foreign array or changed units; the same command as before repairs it.
    """
    import xarray as xr

    place = Path(directory)
    manifests = read_manifests(place)
    if not manifests:
        raise InputError("store", str(place), why="there is no store, or its manifest is damaged")
    for manifest in manifests.values():
        version = str(manifest.get("code", "")).partition("+")[0]
        require_schema(manifest.get("format"), newest=FORMAT, what="store", version=version)
    if all(manifest.get("format") != FORMAT for manifest in manifests.values()):
        why = "another version of thermogear wrote it, whose stores do not vouch for the same"
        raise InputError("store", str(place), why=why, fix="compute it anew in another directory")
    vouched = read_vouched(place)
    if not vouched.metadata:
        raise InputError("store", str(place), why="it is not finished", fix=_AGAIN)
    try:
        if vouched.manifest not in manifests:
            raise _Damage("its manifest is of other work")
        _check_metadata(place / RESULT, vouched.metadata)
        with xr.open_zarr(
            place / RESULT, consolidated=False, mask_and_scale=False, zarr_format=3
        ) as opened:
            data: Dataset = opened.load()
        _check_numbers(data, manifests[vouched.manifest]["chunks"], vouched)
    except Exception as error:  # whatever a reader makes of broken bytes
        what = str(error) if isinstance(error, _Damage) else f"{type(error).__name__}: {error}"
        raise InputError(
            "store", str(place), why=f"it is damaged or changed ({what})", fix=_AGAIN
        ) from error
    return data


def _check_metadata(result: Path, metadata: Mapping[str, str]) -> None:
    """Every zarr.json as it was written, and no array beside them."""
    for path, seal in metadata.items():
        if hashlib.sha256((result / path).read_bytes()).hexdigest() != seal:
            raise _Damage(f"{RESULT}/{path} is not as written")
    for name in foreign_names(result, metadata):
        raise _Damage(f"{RESULT}/{name} is not of this store")


def foreign_names(result: Path, metadata: Iterable[str]) -> list[str]:
    """The folders in the group ``result`` that belong to none of its arrays."""
    own = {Path(path).parts[0] for path in metadata}
    return sorted(p.name for p in result.iterdir() if p.is_dir() and p.name not in own)


def _check_numbers(data: Dataset, cuts: Mapping[str, int], vouched: Vouched) -> None:
    counts = [-(-data.sizes[name] // n) for name, n in cuts.items()]
    if set(vouched.chunks) != set(np.ndindex(*counts)):
        have = len(vouched.chunks)
        raise _Damage(f"{have} of {int(np.prod(counts))} chunks are vouched for")
    for key, hashes in vouched.chunks.items():
        ranges = {
            name: slice(k * n, (k + 1) * n) for k, (name, n) in zip(key, cuts.items(), strict=True)
        }
        for name, seal in hashes.items():
            variable = data[name].variable
            part = variable[tuple(ranges.get(str(d), slice(None)) for d in variable.dims)]
            if numbers_hash(part.values) != seal:
                raise _Damage(f"numbers of {name}, chunk {key}")
    for name, seal in vouched.numbers.items():
        if numbers_hash(data[name].values) != seal:
            raise _Damage(f"numbers of {name}")
