"""In which encoding a text is written that is not UTF-8: Western European or Chinese."""

from __future__ import annotations

import re
from dataclasses import dataclass

_HIGH = re.compile(r"[^\x00-\x7f]+")
_LONGEST_RUN = 3  # letters that are not ASCII in a row, in a European word
_LIKELY = 0.5  # of a Chinese head are signs, or characters of the first level of GB 2312


@dataclass(frozen=True)
class Encoding:
    """An encoding: ``codec`` that reads it, ``name`` it is told by; ``likely``: its signs are such
    as heads hold."""

    codec: str
    name: str
    likely: bool = True


def encoding_of(head: bytes) -> Encoding:
    """The encoding of a text that is no UTF-8, by its first bytes.

    Windows-1252 (Latin-1 and more) or GB 18030 (GBK and more): European letters are single ones
    between ASCII letters, Chinese characters are pairs of high bytes, or four bytes. A pair whose
    second byte is ASCII, or that is alone between two ASCII letters, speaks for Europe.

    >>> encoding_of("Gehäuse [µm]".encode("latin-1")).name
    'Latin-1'
    >>> encoding_of("加速度 [g]".encode("gbk")).name
    'GBK'
    """
    text = head.decode("gb18030", "replace")
    votes, signs, known = 0, 0, 0
    for run in _HIGH.finditer(text):
        around = text[max(run.start() - 1, 0)], text[run.end() : run.end() + 1]
        alone = len(run.group()) == 1 and all(map(str.isalpha, around))
        for raw in (sign.encode("gb18030") for sign in run.group()):
            votes += 1 if len(raw) == 4 or (raw[1] >= 0xA1 and not alone) else -1
            signs += 1
            known += len(raw) == 4 or (raw[1] >= 0xA1 and 0xA1 <= raw[0] <= 0xD7)
    if votes > 0 and "\ufffd" not in text:
        return Encoding("gb18030", "GBK", known >= _LIKELY * signs)
    european = head.decode("cp1252", "replace")
    longest = max((len(run) for run in _HIGH.findall(european)), default=0)
    latin = all(sign < "\x80" or sign >= "\xa0" for sign in head.decode("latin-1"))
    name = "Latin-1" if latin else "Windows-1252"
    return Encoding("cp1252", name, longest <= _LONGEST_RUN and "\ufffd" not in european)
