"""Files that a case names, in the text of the case itself: how they are kept and shown there."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping
from typing import Any

_HEAD = "# Files named above, as they were read: this text needs them no more."
_BODY = re.compile(
    r'^\[files\.(?P<name>"[^\n]*")\]\n'
    r"text = (?:'''\n(?P<plain>.*?)'''|(?P<quoted>\"[^\n]*\"))$",
    re.DOTALL | re.MULTILINE,
)


def with_files(text: str, files: Mapping[str, str]) -> str:
    """A case's ``text`` with the contents of ``files`` by name at its end."""
    if not files:
        return text
    parts = [] if _HEAD in text else [_HEAD]
    for name, content in files.items():
        plain = "'''" not in content
        body = f"'''\n{content}'''" if plain else json.dumps(content, ensure_ascii=False)
        parts.append(f"[files.{json.dumps(name, ensure_ascii=False)}]\ntext = {body}")
    return text.rstrip("\n") + "\n\n" + "\n".join(parts) + "\n"


def folded(text: str) -> str:
    """A case's text for a reader: of each file its name and length."""

    def said(match: re.Match[str]) -> str:
        content = match["plain"]
        if content is None:
            content = json.loads(match["quoted"])
        return f"# {json.loads(match['name'])}: {told(content)}, kept in the stored results"

    return _BODY.sub(said, text.replace(f"{_HEAD}\n", ""))


def told(content: str) -> str:
    """A file's content in a few words that differ where the content does."""
    digest = hashlib.sha256(content.encode()).hexdigest()[:12]
    return f"{content.count(chr(10))} lines, sha256 {digest}"


def with_digests(data: dict[str, Any]) -> dict[str, Any]:
    """A case's tables with the name of each file in place of its content."""
    files = data.get("files")
    if not isinstance(files, dict):
        return data
    short = {
        name: {"text": told(str(one.get("text", "")))} if isinstance(one, dict) else one
        for name, one in files.items()
    }
    return {**data, "files": short}
