"""The bytes of a REXS file: XML, JSON, or either in a zip; sizes are bounded before unpacking."""

from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path
from typing import BinaryIO

from thermogear.base.errors import InputError, short
from thermogear.base.files import meant_beside, require_regular
from thermogear.case.rexs.json_reader import read_json
from thermogear.case.rexs.model import Model
from thermogear.case.rexs.xml_reader import read_xml

LARGEST = 64 * 1024 * 1024
"""Bytes of a model, packed or unpacked."""
MOST_ENTRIES = 1000
"""Files in a zip."""
MOST_RATIO = 400
"""Unpacked over packed bytes of a zip's entry: XML of long tables reaches some tens."""

_MODEL = re.compile(r"\.(rexs|rexsj|rexs\.xml|rexs\.json|xml|json)$", re.IGNORECASE)
_FIELD = "REXS file"


def read_rexs(path: str | Path) -> Model:
    """The gearbox model in a REXS file: XML (``.rexs``), JSON (``.rexsj``) or a zip (``.rexsz``).

    Versions 1.0 to 1.7 and 2.0.0; the content decides the kind, not the name. ``.components``
    by their id, ``.relations``, ``.load_cases``: values as they are written, with the unit beside
    them, such as [mm]; nothing is converted. Raises InputError in one line for what is no REXS
    file, any DOCTYPE, and sizes no gearbox has (64 MiB, 2 million nodes), before anything is
    unpacked.
    Source: REXS specification (rexs.info), root file formats.
    """
    place = Path(path)
    if place.is_dir():
        raise InputError(short(place.name), "a directory", allowed="a REXS file")
    require_regular(place, short(place.name))
    try:
        with place.open("rb") as file:
            head = file.read(4)
            file.seek(0)
            if head.startswith(b"PK"):
                return _unzipped(file)
            raw = file.read(LARGEST + 1)
    except FileNotFoundError as cause:
        fix = meant_beside(place, "*.rexs*")
        raise InputError(short(place.name), "no such file", fix=fix) from cause
    except (OSError, ValueError) as cause:
        reason = getattr(cause, "strerror", None) or str(cause)
        raise InputError(short(place.name), "a file that cannot be read", why=reason) from cause
    if len(raw) > LARGEST:
        raise _too_large(f"more than {LARGEST} bytes")
    return model_of(raw)


def model_of(raw: bytes, zipped: str = "") -> Model:
    """The model in the bytes of a file; ``zipped`` says how the container is called then."""
    start = raw[:64].removeprefix(b"\xef\xbb\xbf").lstrip()
    if start.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise InputError(_FIELD, "UTF-16 text", allowed="UTF-8", fix="save it as UTF-8")
    if start.startswith(b"<"):
        return read_xml(raw, f"XML{zipped}")
    if start.startswith((b"{", b"[")):
        return read_json(raw, f"JSON{zipped}")
    got = "an empty file" if not raw.strip() else short(start[:20].decode("latin-1"))
    raise InputError(_FIELD, got, allowed="XML, JSON, or a zip with one of them")


def _too_large(got: str) -> InputError:
    return InputError(_FIELD, got, allowed=f"0..{LARGEST} bytes", why="no gearbox needs as much")


def _unzipped(file: BinaryIO) -> Model:
    try:
        with zipfile.ZipFile(file) as archive:
            chosen = _chosen(archive.infolist())
            with archive.open(chosen) as entry:
                raw = entry.read(LARGEST + 1)
    except (
        zipfile.BadZipFile,
        zlib.error,
        EOFError,
        NotImplementedError,
        RuntimeError,
        ValueError,
        OSError,
    ) as cause:
        if isinstance(cause, InputError):
            raise
        raise InputError(
            _FIELD, "a zip that cannot be unpacked", why=" ".join(str(cause).split())[:80]
        ) from cause
    if len(raw) > LARGEST:
        raise _too_large(f"a zip that unpacks to more than {LARGEST} bytes")
    return model_of(raw, " in a zip")


def _chosen(entries: list[zipfile.ZipInfo]) -> zipfile.ZipInfo:
    """The one model in a zip; names, number, sizes and ratio are checked for every entry."""
    if len(entries) > MOST_ENTRIES:
        raise InputError(
            _FIELD, f"a zip of {len(entries)} files", allowed=f"1..{MOST_ENTRIES} files"
        )
    models = []
    for entry in entries:
        name = entry.filename.replace("\\", "/")
        if name.startswith("/") or ":" in name or ".." in name.split("/"):
            raise InputError(
                _FIELD,
                f"the name {short(entry.filename)} in a zip",
                allowed="names inside the zip",
                why="it leads out of it",
            )
        if entry.flag_bits & 1:
            raise InputError(_FIELD, "an encrypted zip", allowed="one without a password")
        if entry.file_size > MOST_RATIO * max(entry.compress_size, 1024):
            raise InputError(
                _FIELD,
                f"a zip that unpacks {short(entry.filename)} to {entry.file_size} bytes out of "
                f"{entry.compress_size}",
                allowed=f"at most {MOST_RATIO} times as many",
                why="no model packs so well",
            )
        hidden = name.startswith("__MACOSX/") or name.rpartition("/")[2].startswith(".")
        if not hidden and not entry.is_dir() and _MODEL.search(name):
            models.append(entry)
    if sum(entry.file_size for entry in entries) > LARGEST:
        raise _too_large(f"a zip of {sum(entry.file_size for entry in entries)} bytes unpacked")
    rexs = [one for one in models if "rexs" in one.filename.rpartition("/")[2].lower()] or models
    if len(rexs) != 1:
        raise InputError(
            _FIELD,
            f"a zip with {len(rexs)} models",
            allowed="one model and the files it names",
            fix="unpack it and import one of them" if rexs else None,
        )
    return rexs[0]
