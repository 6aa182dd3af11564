"""Texts of a case: no byte that leaves the program rewrites a terminal, a page or a table."""

from __future__ import annotations

import os
import pty
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest

from thermogear.case.examples import example_text
from thermogear.front.cli import main

EVIL = "=cmd\x1b[2J\x1b]0;owned\x07\u202e<script>alert(1)</script>\u2066\x9b1m"
RAW = [b"\x1b[2J", b"\x1b]0;", b"owned\x07", "\u202e".encode(), "\u2066".encode()]
RAW += ["\x9b1m".encode()]
ESCAPED = [b"\\u202e", b"\\u001b", b"\\x1b"]
"""Raw in JSON and on a page: whoever reads it makes the character of it."""
SHOWN = "=cmd<script>alert(1)</script>"
"""What of it a case may say: no control character, no mark of direction."""
CASES = ["rig", "rig-train", "table-4.2"]


def toml(value: Any) -> str:
    """A plain value as TOML, texts with every control character escaped."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{toml(str(k))} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + "".join(c if c.isalnum() else f"\\U{ord(c):08x}" for c in value) + '"'
    return str(value)


def written(path: Path, content: dict[str, Any]) -> Path:
    path.write_text("".join(f"{toml(k)} = {toml(v)}\n" for k, v in content.items()), "utf-8")
    return path


def seeded(value: Any) -> Iterator[Any]:
    """``value`` with one value, one key or one entry more replaced by the text, each in turn."""
    yield EVIL
    if isinstance(value, dict):
        for key, inner in value.items():
            yield {EVIL if k == key else k: v for k, v in value.items()}
            for changed in seeded(inner):
                yield value | {key: changed}
    if isinstance(value, list):
        for place, inner in enumerate(value):
            for changed in seeded(inner):
                yield [*value[:place], changed, *value[place + 1 :]]


def require_clean(content: bytes, *, read_on: bool = False) -> int:
    """The number of bytes scanned; none of them is raw, nor becomes so where it is read on."""
    for raw in (*RAW, *(ESCAPED if read_on else ())):
        assert raw not in content, content[max(0, content.find(raw) - 60) :][:160]
    return len(content)


def texts(path: Path) -> Iterator[str]:
    """Every text in a netCDF file: names, attributes, variables."""
    found: list[str] = []

    def visit(name: str, item: h5py.HLObject) -> None:
        values = [*item.attrs.values()]
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "OSU":
            values.append(item[...])
        found.append(name)
        found.extend(str(v) for one in values for v in np.ravel(one))

    with h5py.File(path) as file:
        file.visititems(visit)
        found += [str(v) for one in file.attrs.values() for v in np.ravel(one)]
    yield from found


@pytest.mark.parametrize("name", CASES)
def test_every_field_of_a_case_is_told_without_a_raw_byte(
    name: str, tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    fields = scanned = 0
    content = tomllib.loads(example_text(name))
    if name == "rig":
        steel = {"youngs_modulus": "206 GPa", "density": "7850 kg/m^3"}
        content |= {"materials": {"steel of mine": steel}}
    for changed in seeded(content):
        if not isinstance(changed, dict):
            continue
        path = written(tmp_path / "case.toml", changed)
        for words in ([], ["--json"]):
            main(["check", str(path), *words])
            out, err = capfdbinary.readouterr()
            assert out or err.startswith(b"error: ")
            scanned += require_clean(out, read_on=bool(words)) + require_clean(err)
            if not out:
                break  # refused
        fields += 1
    print(f"{name}: {fields} fields, {scanned} bytes")


def named(text: str) -> dict[str, Any]:
    """The drive train with the text wherever a free one may stand."""
    content = tomllib.loads(example_text("rig-train"))
    content["title"] = text
    for number, bearing in enumerate(content["bearings"]):
        bearing["name"] = text + str(number)
    content["discs"] = [
        {"shaft": "pinion", "name": text, "position": "200 mm", "outer_diameter": "80 mm",
         "width": "10 mm"}
    ]  # fmt: skip
    return content


def test_no_byte_of_a_case_s_names_is_passed_on_raw(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    train = written(tmp_path / "train.toml", named(SHOWN))
    plain = tomllib.loads(example_text("table-4.2")) | {"title": SHOWN}
    free = written(tmp_path / "free.toml", plain)
    commands = [
        ["statics", str(train), "-o", str(tmp_path / "statics")],
        ["modes", str(train), "-o", str(tmp_path / "modes")],
        ["map", str(free), "--over", "w=1:2:3", "--over", "zeta=0.02:0.05:3",
         "-o", str(tmp_path / "map"), "--csv", str(tmp_path / "map.csv")],
    ]  # fmt: skip
    for words in commands:
        assert main(words) == 0, words
    out, err = capfdbinary.readouterr()
    kept = [
        path
        for path in sorted(tmp_path.rglob("*"))
        # pixels and packed numbers hold no text
        if path.is_file() and path.suffix not in {".toml", ".png"} and "c" not in path.parts
    ]
    assert {".html", ".nc", ".csv", ".json"} <= {p.suffix for p in kept}
    scanned = require_clean(out) + require_clean(err)
    for path in kept:
        content = path.read_bytes()
        if path.suffix == ".nc":
            content = "\n".join(texts(path)).encode()
        scanned += require_clean(content, read_on=path.suffix in {".json", ".html"})
        if path.suffix == ".html":
            assert b"<script>alert" not in content
        if path.suffix == ".csv":
            assert re.search(rb"(?m)(^|,)\"?=cmd", content) is None
    print(f"{len(kept)} files, {scanned} bytes, {sorted({p.suffix for p in kept})}")


@pytest.mark.parametrize(("text", "code"), [(EVIL, 2), (SHOWN, 0)])
def test_a_terminal_gets_no_raw_byte_of_a_case_s_names(
    text: str, code: int, tmp_path: Path
) -> None:
    case = written(tmp_path / "train.toml", named(text))
    ours, theirs = pty.openpty()
    process = subprocess.Popen(
        [sys.executable, "-m", "thermogear", "check", str(case)],
        stdin=theirs, stdout=theirs, stderr=theirs,
    )  # fmt: skip
    os.close(theirs)
    content = b""
    try:
        while piece := os.read(ours, 65536):
            content += piece
    except OSError:  # the other end is closed
        pass
    os.close(ours)
    assert process.wait() == code, content.decode()
    require_clean(content)
    print(len(content), "bytes of a pseudo-terminal")
