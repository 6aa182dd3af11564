"""In which encoding a text is written that is not UTF-8: Western European or Chinese."""

from __future__ import annotations

import re

_HIGH = re.compile(rb"[\x80-\xff]+")


def encoding_of(head: bytes) -> tuple[str, str]:
    """The codec that reads a text which is no UTF-8, by its first bytes, and its name.

    GBK where all high bytes come in pairs, half of which or more are signs or common characters
    (the first level of GB 2312); else Windows-1252, of which Latin-1 is a part: European letters
    are single high bytes between ASCII letters.

    >>> encoding_of("Gehäuse [µm]".encode("latin-1"))
    ('cp1252', 'Latin-1')
    >>> encoding_of("加速度 [g]".encode("gbk"))
    ('gb18030', 'GBK')
    """
    runs = _HIGH.findall(head)
    leads = [lead for run in runs for lead in run[::2]]
    common = [lead for lead in leads if 0xA1 <= lead <= 0xA9 or 0xB0 <= lead <= 0xD7]
    if all(len(run) % 2 == 0 for run in runs) and 2 * len(common) >= len(leads):
        return "gb18030", "GBK"
    beyond = any(0x80 <= byte < 0xA0 for byte in head)
    return "cp1252", "Windows-1252" if beyond else "Latin-1"
