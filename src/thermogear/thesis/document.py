"""The document's sentences without their text: digests, and which claims cover each of them."""

from __future__ import annotations

import csv
import hashlib
import io
import re
import unicodedata
from dataclasses import dataclass
from importlib.resources import files

TABLE = "sentences.csv"

_FORMULA = re.compile(r"\$\$.*?\$\$", re.DOTALL)
_END = re.compile(r"(?<=[.!?:])\s+(?=[A-Z])")


def sentences(text: str) -> list[str]:
    """The sentences of a document in order; a displayed formula or a table's line counts as one.

    White space is single, the characters are composed (NFC); headings are sentences too.
    """
    flat = _FORMULA.sub(
        lambda found: " ".join(found[0].split()), unicodedata.normalize("NFC", text)
    )
    found: list[str] = []
    for line in (" ".join(line.split()) for line in flat.splitlines()):
        if line:
            found += [line] if line.startswith("$$") else _END.split(line)
    return found


def digest(sentence: str) -> str:
    """SHA-256 of a normalised sentence, hexadecimal."""
    return hashlib.sha256(sentence.encode("utf-8")).hexdigest()


@dataclass(frozen=True)
class Sentence:
    """A sentence by its ``digest``: where it stands and the numbers of the claims it makes.

    Without claims ``reason`` says why it makes none.
    """

    digest: str
    place: str
    claims: tuple[str, ...]
    reason: str = ""


def table() -> tuple[Sentence, ...]:
    """Every sentence of the document, in its order."""
    text = (files("thermogear.thesis") / TABLE).read_text(encoding="utf-8")
    rows = csv.DictReader(io.StringIO(text))
    return tuple(
        Sentence(row["sha256"], row["place"], tuple(row["claims"].split()), row["reason"])
        for row in rows
    )
