"""Twenty pictures, each with the command that made it: docs/gallery.md and its pictures.

    python trials/gallery.py            all anew, some minutes
    python trials/gallery.py campbell   the pictures of that command alone

Every command runs as a user would run it, on a ready-made case; ``thermogear report`` writes the
pictures of its page. They are stored 720 pixels wide in 64 colours.
"""

from __future__ import annotations

import shlex
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from PIL import Image

DOCS = Path(__file__).parents[1] / "docs"
PAGE = DOCS / "gallery.md"
PICTURES = DOCS / "pictures" / "gallery"
WIDTH, COLOURS = 720, 64

BASE = "bifurcation table-4.2 --over zeta=0.1:0.18:81 --branch-period 0"
GALLERY = {
    "run fzg-c": {
        "gears": "Both gears in mesh, gaps enlarged",
        "flash-own": "Flash temperature along the path of contact",
        "growth": "Growth of both hot flanks",
        "dial": "Stiffness, backlash and orbit at one temperature",
        "dynamic-factor": "Dynamic factor of pairs of the class, and how many part",
    },
    "friction fzg-c": {"laws_1": "Friction laws along the path of contact"},
    "contact loaded-27-35": {"phase": "Stiffness and error over the mesh period, by load"},
    "relief loaded-27-35": {
        "profile": "Tip relief as it is ground",
        "parts": "What the relief does to unseen parts of the class",
    },
    "temperature fzg-c": {"map": "Film, flash, temperature and backlash over speed and torque"},
    "warmup fzg-c": {"course": "Warming up: temperatures, half backlash"},
    "statics motor-train": {"clearances": "Bearing clearance cold and hot"},
    "modes motor-train": {"modes": "Modes of the drive train"},
    "campbell motor-train": {
        "campbell": "Critical speeds",
        "bearing_forces": "Bearing forces over speed",
    },
    "orbit table-4.2": {"orbit": "One orbit with its proof"},
    BASE: {"orbits": "Period doublings and chaos"},
    "map table-4.2 --over zeta=0.1:0.2:24 --over w=0.6:1.4:24": {
        "regimes": "Regimes, lost contact"
    },
    "runup rig --rpm 3000:6000:31 --parts 1": {
        "runup": "Up and down, undeformed and hot",
        "waterfall": "The same by order",
    },
}
"""Command without its ``-o``: its pictures on the page, each with what it shows."""


def main(asked: list[str]) -> int:
    """Run the commands, all or those that begin with a name asked for; write the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for command, shown in GALLERY.items():
        if not asked or command.split()[0] in asked:
            draw(command, shown)
    PAGE.write_text(page(), "utf-8")
    return 0


def draw(command: str, shown: dict[str, str]) -> None:
    """The pictures of one command, small, in the folder of the gallery."""
    with TemporaryDirectory() as folder:
        for words in ([*shlex.split(command), "-o", "out"], ["report", "out", "--pictures", "p"]):
            subprocess.run(["thermogear", *words], cwd=folder, check=True)
        for name in shown:
            store(Path(folder, "p", f"{name}.png"), command, name)


def store(found: Path, command: str, name: str) -> None:
    """A picture of a report in the gallery's size."""
    with Image.open(found) as image:
        height = round(image.height * WIDTH / image.width)
        small = image.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
        small.quantize(COLOURS).save(PICTURES / file_of(command, name), optimize=True)


def file_of(command: str, name: str) -> str:
    """The name of a picture's file in the gallery."""
    return f"{command.split()[0]}-{name}.png"


def page() -> str:
    """The text of docs/gallery.md."""
    lines = [
        "# Gallery",
        "",
        "Made by `make trial NAME=gallery` from ready-made cases.",
        "`thermogear report DIR --pictures P` writes the pictures of any command; in Python",
        "`pictures(result)` gives them by name. On a page they move.",
    ]
    for command, shown in GALLERY.items():
        lines += ["", "```sh", f"thermogear {command} -o {command.split()[0]}", "```"]
        for name, words in shown.items():
            lines += ["", f"![{words}](pictures/gallery/{file_of(command, name)})"]
    return "\n".join([*lines, ""])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
