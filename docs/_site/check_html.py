"""Follow every local link of the built site: python docs/_site/check_html.py docs/_build/html."""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

OWN = ("search.html", "genindex.html", "py-modindex.html")


class _Page(HTMLParser):
    """Targets and anchors of one page."""

    def __init__(self) -> None:
        super().__init__()
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.outside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if value is None:
                continue
            if name in ("id", "name"):
                self.anchors.add(value)
            elif name in ("href", "src") and tag != "base":
                self.links.append(value)
                if tag in ("script", "img", "link") and urlsplit(value).netloc:
                    self.outside.append(value)


def check(root: Path) -> tuple[int, int, list[str]]:
    """(pages, links followed, complaints) of the site under ``root``."""
    pages: dict[Path, _Page] = {}
    for file in sorted(root.rglob("*.html")):
        page = _Page()
        page.feed(file.read_text("utf-8"))
        pages[file.resolve()] = page
    followed, wrong = 0, []
    for file, page in pages.items():
        name = file.relative_to(root.resolve())
        wrong += [f"{name}: the page would load {link} from outside" for link in page.outside]
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            followed += 1
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            if not target.exists():
                wrong.append(f"{name}: {link} leads to no file")
            elif target in pages:
                known = pages[target].anchors | {"", "top"}
                if unquote(parts.fragment) not in known:
                    wrong.append(f"{name}: {link} leads to no anchor")
    return len(pages), followed, wrong


def main(root: Path) -> int:
    pages, followed, wrong = check(root)
    for line in wrong:
        print(line, file=sys.stderr)
    lessons = [file.read_text("utf-8") for file in (root / "tutorials").glob("*.html")]
    notebooks = sum("cell_output" in text for text in lessons)
    print(f"{pages} pages, {notebooks} notebooks executed, {followed} links followed")
    print((root / "index.html").resolve())
    return 1 if wrong else 0


if __name__ == "__main__":
    raise SystemExit(main(Path(sys.argv[1])))
