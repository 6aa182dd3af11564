"""Notices by their codes."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import Any

from thermogear.base.notice import Notice


def coded(notices: Iterable[Notice] | str) -> dict[str, list[Mapping[str, Any]]]:
    """The data of every notice under its code; ``notices`` may be the JSON text of a store."""
    listed = json.loads(notices) if isinstance(notices, str) else notices
    found: dict[str, list[Mapping[str, Any]]] = {}
    for notice in map(Notice.stored, listed):
        found.setdefault(notice.code, []).append(notice.data)
    return found
