"""Pictures told in place of drawn, for tests that read what a page or its files say."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest
from markupsafe import escape

from thermogear.views import drawing
from thermogear.views.picture import Picture


def words_in(value: object) -> Iterator[str]:
    """Every text of a picture's data, in their order."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from words_in(one)


def told(picture: Picture, kind: str, *, salt: str = "", **how: Any) -> bytes:
    """In place of ``drawing.image``: an SVG of all the picture's texts."""
    words = "".join(f"<text>{escape(one)}</text>" for one in words_in(picture.to_json()))
    return f'<svg viewBox="0 0 1 1">{words}</svg>'.encode()


@contextmanager
def in_words() -> Iterator[None]:
    """Every picture is an SVG of all its texts: titles, axes, curves, letters, classes.

    What a reader reads of it is there but for the numbers at its axes; that every kind of picture
    can be drawn, and shows these texts, is asked in ``views``.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(drawing, "image", told)
        yield
