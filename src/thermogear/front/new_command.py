"""``new``: a case file of one's own out of what a gear pair needs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

import click

from thermogear.base.errors import InputError
from thermogear.front.lines import put_text, show_path

NEEDED = {
    "teeth": ("Teeth of pinion and wheel", "20 40"),
    "module": ("Module", "3 mm"),
    "face_width": ("Face width", "30 mm"),
    "torque": ("Torque at the pinion", "80 N m"),
    "speed": ("Speed of the pinion", "3000 rpm"),
}
"""What a case needs: the question, and an answer."""


@click.command()
@click.option("--teeth", nargs=2, type=int, metavar="Z1 Z2", help="Teeth of pinion and wheel.")
@click.option("--module", metavar="LENGTH", help='Module: "3 mm", or "8 1/in".')
@click.option("--face-width", metavar="LENGTH", help="Face width of both gears.")
@click.option("--torque", metavar="TORQUE", help='Torque at the pinion: "80 N m".')
@click.option("--speed", metavar="SPEED", help='Speed of the pinion: "3000 rpm".')
@click.option("--pressure-angle", metavar="ANGLE", help='"25 deg"; 20 deg if left out.')
@click.option("--title", metavar="TEXT", help="Title of the page.")
@click.option(
    "--profile-shift", nargs=2, type=float, metavar="X1 X2", help="Profile shifts, in modules; 0."
)
@click.option(
    "--centre-distance", metavar="LENGTH", help="That of the shifts without backlash if left out."
)
@click.option("--tip-rounding", metavar="LENGTH", help="Radius of all tips' edges; sharp.")
@click.option("--tip-chamfer", metavar="LENGTH", help="Height of a chamfer of all tips; none.")
@click.option(
    "--material", nargs=2, metavar="NAME NAME", help="Materials of pinion and wheel; steel."
)
@click.option("--oil", metavar="NAME", help='Oil: "ISO VG 100" if left out.')
@click.option(
    "--oil-temperature",
    metavar="TEMPERATURE",
    help='"80 degC"; computed from the losses if left out.',
)
@click.option(
    "--backlash",
    metavar="LENGTH",
    help="Normal backlash, whole gap; ISO/TR 10064-2's least if left out.",
)
@click.option(
    "--accuracy", type=int, metavar="CLASS", help="Accuracy class of the flanks, ISO 1328-1; 6."
)
@click.option(
    "--drawn-teeth", is_flag=True, help="Whole gears of the class: eccentric, every tooth its own."
)
@click.option(
    "--run-out", nargs=2, metavar="LENGTH LENGTH", help="Radial run-out of pinion and wheel; none."
)
@click.option(
    "--pitch-errors",
    nargs=2,
    metavar="LIST LIST",
    help='Index errors of the teeth of pinion and wheel, "1 um, -2 um, ..."; "" for none.',
)
@click.option("--pinion-flanks", metavar="CSV", help="Inspection chart of the pinion's flanks.")
@click.option("--wheel-flanks", metavar="CSV", help="The wheel's; each replaces the class.")
@click.option(
    "--allow-undercut", is_flag=True, help="Take teeth whose undercut shortens the path of contact."
)
@click.option(
    "--fault",
    "faults",
    metavar="KIND, FIELD=VALUE, ...",
    multiple=True,
    help='A fault of one gear: "crack, gear=pinion, tooth=3, depth=2 mm". May be repeated.',
)
@click.option("--shafts", is_flag=True, help="Two shafts between four ball bearings too.")
@click.option("-o", "--output", metavar="FILE", help="Write a new FILE instead of printing.")
def new(output: str | None, **given: Any) -> None:
    """Write a short case of your own gear pair; without options it asks.

    \b
      thermogear new --teeth 20 40 --module "3 mm" --face-width "30 mm" \\
        --torque "80 N m" --speed "3000 rpm" -o mine.toml
    """
    from thermogear.base.files import require_new_file
    from thermogear.case.new import NewCase

    if output is not None:
        require_new_file(Path(output))
    missing = [name for name in NEEDED if given[name] is None]
    if len(missing) == len(NEEDED) and sys.stdin is not None and sys.stdin.isatty():
        given |= _asked()
        output = output or click.prompt("File to write", default="mine.toml")
        require_new_file(Path(output))
    elif missing:
        options = ", ".join(f"--{name.replace('_', '-')}" for name in missing)
        first = missing[0]
        raise InputError(
            options,
            "nothing",
            why="a gear pair needs module, teeth, face width, torque and speed",
            fix=f"write --{first.replace('_', '-')} {_quoted(first)}",
        )
    folder = Path() if output is None else Path(output).parent
    for name in ("pinion_flanks", "wheel_flanks"):
        if given[name] is not None:
            given[name] = _from(folder, given[name])
    text = NewCase(**{k: v for k, v in given.items() if v is not None}).text(folder)
    put_text(text, output)
    if output is not None:
        show_path(output, "next: thermogear answers ")


def _from(folder: Path, chart: str) -> str:
    """The name of a file as a case in ``folder`` says it; as given where there is no way."""
    try:
        return Path(os.path.relpath(chart, folder)).as_posix()
    except ValueError:  # another drive
        return chart


def _quoted(name: str) -> str:
    example = NEEDED[name][1]
    return example if name == "teeth" else f'"{example}"'


def _asked() -> dict[str, Any]:
    """The answers of a person at a terminal."""
    answers: dict[str, Any] = {}
    for name, (question, example) in NEEDED.items():
        text = click.prompt(question, default=example)
        answers[name] = _teeth(text) if name == "teeth" else text
    return answers


def _teeth(text: str) -> tuple[int, int]:
    parts = text.replace(":", " ").replace("/", " ").replace(",", " ").split()
    try:
        first, second = (int(part) for part in parts)
    except ValueError as cause:
        raise InputError(
            "teeth", repr(text), allowed="two whole numbers", fix="write 20 40"
        ) from cause
    return first, second


COMMANDS: tuple[click.Command, ...] = (new,)
"""For the main group to register."""
