"""Every sentence of the document is claimed or listed as no claim; the claims' own consistency."""

from __future__ import annotations

import hashlib
import importlib
import re
import unicodedata
from collections import Counter
from pathlib import Path

import pytest

from thermogear.thesis.claim import KINDS
from thermogear.thesis.report import CLAIMS, table

ROOT = Path(__file__).resolve().parents[2]
DOCUMENT = ROOT.parent / "shared" / "thesis.txt"

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


def test_every_sentence_is_claimed_or_listed(capsys: pytest.CaptureFixture[str]) -> None:
    rows = table()
    if not DOCUMENT.is_file():
        # the document is not part of the package: its digests are held against each other alone
        with capsys.disabled():
            print("\nno document beside the repository: the table's own consistency is checked")
    else:
        found = [digest(one) for one in sentences(DOCUMENT.read_text(encoding="utf-8"))]
        assert found == [row.digest for row in rows]
    assert all(bool(row.claims) != bool(row.reason) for row in rows)
    assert all(re.fullmatch(r"[0-9a-f]{64}", row.digest) for row in rows)
    # the numbers of a list stand before several sentences; nothing else repeats
    repeated = [n for n, c in Counter(row.digest for row in rows).items() if c > 1]
    assert all(row.reason for row in rows if row.digest in repeated)


def test_table_and_claims_name_each_other() -> None:
    numbers = [claim.number for claim in CLAIMS]
    assert len(set(numbers)) == len(numbers)
    assert {name for row in table() for name in row.claims} == set(numbers)


def test_sentences_of_sections_two_to_six_without_claim_are_none_that_state() -> None:
    silent = {row.reason for row in table() if not row.claims and row.place[:1] in "23456"}
    assert silent == {
        "heading",
        "introduces what follows",
        "head of a table",
        "number of a list",
        "summary of aims",
        "outlook: names what is left out",
        "outlook: an appraisal",
    }


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.number)
def test_claim_is_whole(claim) -> None:  # type: ignore[no-untyped-def]
    assert 2 <= claim.section <= 6
    assert claim.place.startswith(str(claim.section))
    assert claim.kind in KINDS
    assert claim.words.endswith(".")
    assert claim.code
    for name in claim.code:
        module, _, attribute = name.rpartition(".")
        assert hasattr(importlib.import_module(module), attribute), name


def test_no_sentence_of_the_document_is_copied() -> None:
    if not DOCUMENT.is_file():
        assert CLAIMS
        return
    theirs = {one.lower() for one in sentences(DOCUMENT.read_text(encoding="utf-8"))}
    assert not theirs & {claim.words.lower() for claim in CLAIMS}


def test_splitting_keeps_formulas_and_lines_whole() -> None:
    text = "One. Two has\n 3.5 mm: So it is.\n\n$$ a\n= b $$\n1 2 3\n"
    assert sentences(text) == ["One.", "Two has", "3.5 mm:", "So it is.", "$$ a = b $$", "1 2 3"]
    assert digest("abc") == ("ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad")
    assert digest("a") != digest("A")
