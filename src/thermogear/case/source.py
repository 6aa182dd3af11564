"""The text of a case: from a file, from a ready-made case, or as given."""

from __future__ import annotations

from pathlib import Path

from thermogear.base.errors import InputError
from thermogear.base.files import decoded, meant_beside, require_regular
from thermogear.case.examples import EXAMPLES, example_text

LARGEST = 1_000_000
"""A case file is text written by hand: one larger than this [bytes] is something else."""


def folder_of(source: str | Path) -> Path:
    """The folder of the files that a case names: its own; for a text the working directory."""
    return Path() if _is_text(source) else Path(source).parent


def _is_text(source: str | Path) -> bool:
    return isinstance(source, str) and (not source.strip() or "\n" in source or "=" in source)


def case_text(source: str | Path) -> tuple[str, str]:
    """(name, text) of a case given by its path or as text.

    A ``str`` is a text when it holds a line break or an equals sign, or nothing; else a path. The
    bare name of a ready-made case means it where no such file exists.
    """
    if _is_text(source):
        return "case", str(source)
    path = Path(source)
    name = path.name or str(path)
    if str(source) in EXAMPLES and not path.exists():
        return name, example_text(name)
    if path.is_dir():
        raise InputError(name, "a directory", allowed="a case file (TOML)")
    require_regular(path, name)
    try:
        with path.open("rb") as file:
            raw = file.read(LARGEST + 1)
    except FileNotFoundError as cause:
        raise InputError(name, "no such file", fix=_instead(path)) from cause
    except (OSError, ValueError) as cause:
        reason = getattr(cause, "strerror", None) or str(cause)
        raise InputError(repr(name), "a file that cannot be read", why=str(reason)) from cause
    if len(raw) > LARGEST:
        raise InputError(
            name, f"more than {LARGEST} bytes", allowed=f"0..{LARGEST} bytes", why="no case file"
        )
    try:
        text = decoded(raw)
    except UnicodeDecodeError as cause:
        if b"\0" in raw:
            raise _binary(name) from cause
        line = raw.count(b"\n", 0, cause.start) + 1
        raise InputError(
            name,
            f"byte 0x{raw[cause.start]:02x} in line {line}",
            allowed="UTF-8 text (TOML)",
            why="another encoding",
            fix="save the file as UTF-8",
        ) from cause
    if "\0" in text:
        raise _binary(name)
    return name, text


def _binary(name: str) -> InputError:
    return InputError(name, "binary data", allowed="UTF-8 text (TOML)", why="it holds zero bytes")


def _instead(path: Path) -> str:
    example = path.stem if path.stem in EXAMPLES else "rig"
    return meant_beside(path, "*.toml") or (
        f"`thermogear example {example} -o {example}.toml` writes one"
    )
