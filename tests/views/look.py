"""Pages as a reader sees them: pictures at desktop and phone width, and what is wrong with them.

``python tests/views/look.py OUT PAGE...`` opens each page (a file, or a folder with pages) in
Chromium, writes its pictures to ``OUT`` and prints a row per page and width. Exit code 1 if an
element is wider than the page, a picture broken, a reference dead, a label too small, cut or on
top of another, or the console holds an error; 2 if there is no browser. Without words it only
says whether there is one.
"""

from __future__ import annotations

import sys
from pathlib import Path

import browser

HEAD = ("page", "width", "height", "wide", "broken", "dead", "labels", "errors", "time")


def pages(words: list[str]) -> dict[Path, Path | None]:
    """The pages that the words name, each with the folder of its pictures.

    A folder stands for the pages below it; of those, listings of code are left out, and the pages
    of single modules are checked without a picture.
    """
    found: dict[Path, Path | None] = {}
    for word in words:
        path = Path(word)
        if path.is_dir():
            for one in sorted(path.rglob("*.html")):
                if not {"_static", "_modules"} & set(one.parts):
                    own = Path(path.name) / one.parent.relative_to(path)
                    found[one] = None if one.name.startswith("thermogear.") else own
        elif path.is_file():
            found[path] = Path(path.resolve().parent.name.lstrip("."))
        else:
            print(f"{path}: not there, left out")
    return found


def row(sight: browser.Sight) -> list[str]:
    """One line of the table."""
    faults = {name: len(found) for name, found in sight.faults.items()}
    labels = faults["small"] + faults["cut"] + faults["over"]
    counts = (faults["wide"], faults["broken"], faults["dead"], labels, faults["errors"])
    name = "/".join(sight.page.parts[-2:])
    return [name, str(sight.width), str(sight.height), *map(str, counts), f"{sight.seconds:.1f} s"]


def main(words: list[str]) -> int:
    """Look at every page named."""
    program = browser.find()
    if program is None:
        print("no browser found: install the package chromium (Debian: apt-get install chromium)")
        return 2
    if len(words) < 2:
        print(f"{program} is there; usage: look.py OUT PAGE...")
        return 0 if not words else 2
    out, named = Path(words[0]), pages(words[1:])
    print(("{:44}" + "{:>7}" * 7 + "{:>8}").format(*HEAD))
    seen = []
    with browser.opened(program) as one:
        for page, folder in named.items():
            for width in browser.WIDTHS:
                sight = one.look(page, width, None if folder is None else out / folder)
                seen.append(sight)
                print(("{:44}" + "{:>7}" * 7 + "{:>8}").format(*row(sight)), flush=True)
    for sight in seen:
        for kind, found in sight.faults.items():
            for what in sorted(set(found)):
                print(f"{sight.page.name} {sight.width}: {kind}: {what}")
    unsound = sum(not sight.sound for sight in seen)
    shots = sum(len(sight.pictures) for sight in seen)
    print(f"{len(named)} pages, {shots} pictures in {out}, {unsound} sights with faults")
    return 1 if unsound or not named else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
