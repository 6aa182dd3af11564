"""What kind of picture a picture is, by its data."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

FREE = ("words", "title", "label", "unit")


def traits(value: object, of: str = "picture") -> Iterator[tuple[str, object]]:
    """What a picture's data ask of the drawing: which fields say something, and which choice."""
    if isinstance(value, dict):
        mark = value.get("kind", of)
        for field, one in value.items():
            if isinstance(one, dict):
                yield from traits(one, f"{mark} {field}")
            elif field in ("panels", "marks"):
                for part in chain(*one) if field == "panels" else one:
                    yield from traits(part, "panel")
            elif isinstance(one, str) and field not in FREE and not one.startswith("#"):
                yield f"{mark} {field}", one
            else:
                yield f"{mark} {field}", (type(one).__name__, bool(one))
