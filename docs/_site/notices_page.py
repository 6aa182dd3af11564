"""Every notice by its code, from the catalogue that holds them."""

from __future__ import annotations

import re

from _site.case_file import _cell
from thermogear.base.notice import LEVELS, catalogue

HEAD = """\
# Notices

What a study says beside its numbers. A notice is a code with data, and its sentence is made from
them. A page and a terminal show the sentence; JSON has `code`, `level`, `data` (SI) and `text`, and
so has `Result.notices` in Python. Words in *italics* are names of the data. `about` names the
bundle, state or record where there are several, and begins the sentence. `--hide CODE` leaves a
notice out of page, terminal and JSON, and says how many were hidden; what is stored keeps all of
them. This page is made from the catalogue, `thermogear/base/notices/*.toml`.

"""


def _shown(sentence: str) -> str:
    """A sentence with the names of its data, in the units shown; words of the plural."""
    plural = re.sub(r"{\w+\|[^|}]*\|([^}]*)}", r"\1", sentence)
    plain = _cell(re.sub(r"[\[\]]", "", plural))
    return re.sub(
        r"{(\w+)[^ }]*(?: ([^}]*))?}", lambda field: f"*{field[1]}* {field[2] or ''}".strip(), plain
    )


def notices() -> dict[str, str]:
    """A table for each level, a row for each code."""
    text = HEAD
    for level in LEVELS:
        text += f"## {level.capitalize()}\n\n| code | sentence | what to do |\n|---|---|---|\n"
        for code, entry in catalogue().items():
            if entry.level == level:
                text += f"| `{code}` | {_shown(entry.sentence)} | {_cell(entry.to_do)} |\n"
        text += "\n"
    return {"generated/notices.md": text}
