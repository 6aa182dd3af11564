"""A picture as a piece of a page: SVG without foreign names, with ids of its own."""

from __future__ import annotations

import re
from pathlib import Path

from markupsafe import Markup, escape

from thermogear.base.files import put
from thermogear.views.picture import Picture

_ID = re.compile(r'\bid="([^"]+)"')
_USE = re.compile(r'(?:xlink:)?href="#([^"]+)"')
_PATH = re.compile(r'\sd="([^"]+)"')
_LONG = re.compile(r"(\d+\.\d{2})\d+")
_URL = re.compile(r"url\(#([^)]+)\)")
_STYLE = re.compile(r'(<[a-z][^<>]*?)\sstyle="([^"<>{}]+)"')
_PICTURE = re.compile(r"<svg\b.*?</svg>", re.DOTALL)
_SIZE = re.compile(r'<svg\b[^>]*?viewBox="([^"]+)"[^>]*>', re.DOTALL)


def draw(picture: Picture, name: str, title: str) -> Markup:
    """The picture as inline SVG; ``name`` makes its ids unique.

    The same picture gives the same text. ``title`` is what a screen reader says.
    """
    from thermogear.views.drawing import image

    return Markup(_inline(image(picture, "svg", salt=name).decode(), name, title))


def shared_styles(page: str) -> str:
    """``page`` with every look that a picture's parts have said once, in its style sheet.

    Matplotlib says them with each line and letter: a third of a page.
    """
    names: dict[str, str] = {}

    def named(look: re.Match[str]) -> str:
        return f'{look[1]} class="{names.setdefault(look[2], f"k{len(names)}")}"'

    text = _PICTURE.sub(lambda picture: _STYLE.sub(named, picture[0]), page)
    sheet = "\n".join(f"svg .{name}{{{look}}}" for look, name in names.items())
    return text.replace("</style>", f"{sheet}\n</style>", 1)


def put_picture(picture: Picture, path: Path, *, resolution: int) -> Path:
    """Save ``picture`` as ``path`` (its ending says what), white behind, whole or not at all.

    ``resolution`` in dots per inch.
    """
    from thermogear.views.drawing import image

    kind = path.suffix.removeprefix(".")
    return put(path, image(picture, kind, dpi=resolution, facecolor="white"))


def _inline(text: str, name: str, title: str) -> str:
    """Strip what belongs to a file of its own: prolog, name spaces, metadata, fixed size."""
    opening = _SIZE.search(text)
    if opening is None:
        raise ValueError("a picture without a view box")
    box = opening[1]
    body = text[opening.end() :]
    body = re.sub(r"<metadata>.*?</metadata>", "", body, flags=re.DOTALL)
    body = re.sub(r"<!--.*?-->", "", body, flags=re.DOTALL)
    body = _ID.sub(lambda m: f'id="{name}-{m[1]}"', body)
    body = _USE.sub(lambda m: f'href="#{name}-{m[1]}"', body)
    body = _URL.sub(lambda m: f"url(#{name}-{m[1]})", body)
    body = body.replace("xlink:href=", "href=").replace(' type="text/css"', "")
    # style elements would speak to the whole page; the page's own sheet says the same
    body = re.sub(r"<defs>\s*<style>.*?</style>\s*</defs>", "", body, flags=re.DOTALL)
    body = _PATH.sub(_shortened, body)
    body = re.sub(r"\n\s*", "\n", body)
    head = f'<svg viewBox="{box}" role="img" aria-labelledby="{name}-title">'
    return f'{head}<title id="{name}-title">{escape(title)}</title>{body.strip()}'


def _shortened(path: re.Match[str]) -> str:
    """The same path in fewer letters: hundredths of a point, an L once for a run of lines."""
    kept: list[str] = []
    command = ""
    for word in _LONG.sub(r"\1", path[1]).split():
        if word.isalpha():
            if word == command == "L":
                continue
            command = word
        kept.append(word)
    return f' d="{" ".join(kept)}"'
