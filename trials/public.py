"""What ``thermogear measure`` says of public records, and what is known of them.

    python trials/public.py [FOLDER]     trials/records/public_records.md anew

FOLDER (default: ``shared/data`` beside this checkout) holds records, which are read there and never
copied, with a ``README.md`` of what is known of them. Where it is missing the page stays.
"""

from __future__ import annotations

import json
import re
import resource
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "trials" / "records" / "public_records.md"
FOLDER = ROOT.parent / "shared" / "data"
SECONDS = 600
_CLEAR = 0.5
"""Relative half width below which a sideband counts as clear."""
_WORDS = 1500

_RUN = """
import json, resource, sys
from thermogear.front.cli import main
code = main(["measure", *sys.argv[1:]])
used = resource.getrusage(resource.RUSAGE_SELF)
print(json.dumps([used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3]), file=sys.stderr)
sys.exit(code)
"""


@dataclass(frozen=True)
class Said:
    """What ``measure`` said of one record: ``figures`` of its JSON, or why it was refused."""

    name: str
    figures: dict[str, Any] = field(default_factory=dict)
    refused: str = ""
    seconds: float = 0.0
    megabytes: float = 0.0


def records(folder: Path) -> list[Path]:
    """The files of a folder, at any depth, that are no words about them."""
    return sorted(
        path
        for path in folder.rglob("*")
        if path.is_file()
        and not any(part.startswith(".") for part in path.relative_to(folder).parts)
        and not re.match(r"readme|licen[cs]e|notice|index", path.name, re.IGNORECASE)
    )


def known(folder: Path) -> list[str]:
    """What the folder's README says, as lines of a quotation."""
    path = folder / "README.md"
    if not path.is_file():
        return ["> Nothing is told of these records."]
    text = path.read_text("utf-8")
    lines = [line for line in text.splitlines() if not line.startswith("# ")]
    whole = "\n".join(lines).strip()[:_WORDS]
    return [f"> {line}".rstrip() for line in whole.splitlines()]


def said(path: Path, folder: Path) -> Said:
    """One record through the command, in a process of its own."""
    name = str(path.relative_to(folder))
    try:
        done = subprocess.run(
            [sys.executable, "-c", _RUN, str(path), "--json"],
            capture_output=True,
            text=True,
            timeout=SECONDS,
            check=False,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (SECONDS, SECONDS)),
        )
    except subprocess.TimeoutExpired:
        return Said(name, refused=f"it took more than {SECONDS} s")
    told = done.stderr.splitlines()
    if done.returncode != 0:
        errors = [line for line in told if line.startswith("error: ")]
        return Said(name, refused=errors[0] if errors else f"exit code {done.returncode}")
    seconds, megabytes = json.loads(told[-1])
    return Said(name, json.loads(done.stdout), "", seconds, megabytes)


def rows(one: Said) -> list[str]:
    """What is said of one record, as lines of a page."""
    head = f"### `{one.name}`"
    if one.refused:
        return [head, "", f"Refused: {one.refused}", ""]
    figures = one.figures
    rate, mesh = figures["rate"], figures["mesh_position"]
    lines = figures["lines"]
    channels = list(dict.fromkeys(line["channel"] for line in lines))
    samples = int(figures["settings"]["samples"])
    told = [head, "", "| what | said |", "|---|---|"]

    def row(what: str, text: str) -> None:
        told.append(f"| {what} | {text.replace('|', '/')} |")

    row("read", f"{samples} samples of {len(channels)} channels: {', '.join(channels[:8])}")
    row("rate", "not stated" if rate is None else f"{rate:g} samples/s")
    if mesh is None:
        row("mesh line", "none found")
    else:
        hertz = "" if rate is None else f", {mesh * rate:.6g} Hz"
        row("mesh line", f"{mesh:.6f} cycles/sample{hertz}")
    row("teeth", "confirmed" if figures["teeth_confirmed"] else "undecided")
    for family in figures["families"]:
        row("lines at equal distances", f"{family['distance']:.6f} cycles/sample to both sides of "
            f"the mesh line and its harmonics: {family['lines']}")  # fmt: skip
    row("sidebands", _sidebands(lines))
    strongest = _strongest([line for line in lines if line["kind"] == "line"])
    if strongest:
        row("other prominent lines", strongest)
    for finding in figures["findings"]:
        row("finding of the gate", finding["text"])
    if not figures["findings"]:
        row("findings of the gate", "none")
    for notice in figures["notices"]:
        if notice["level"] == "important" and notice not in figures["findings"]:
            row("important", notice["text"])
    per = one.seconds / (samples * max(len(channels), 1)) * 1e6
    row("cost", f"{one.seconds:.1f} s of processor, {per:.0f} s per million samples of a channel, "
        f"{one.megabytes:.0f} MB")  # fmt: skip
    return [*told, ""]


def _sidebands(lines: list[dict[str, Any]]) -> str:
    own = [line for line in lines if line["kind"] == "sideband"]
    if not own:
        return "none read: no teeth are given"
    clear = [line for line in own if (line["relative_half_width"] or _CLEAR) < _CLEAR]
    text = f"{len(clear)} of {len(own)} read to better than {100 * _CLEAR:.0f} %"
    return f"{text}; strongest {_strongest(clear)}" if clear else text


def _strongest(lines: list[dict[str, Any]]) -> str:
    """The strongest line in each channel, with its interval."""
    best: dict[str, dict[str, Any]] = {}
    for line in lines:
        held = best.get(line["channel"])
        if line["reading"] is not None and (held is None or line["reading"] > held["reading"]):
            best[line["channel"]] = line
    return "; ".join(
        f"{channel}: {line['name']}, {line['reading']:.4g} ± "
        f"{100 * line['relative_half_width']:.2g} %"
        for channel, line in list(best.items())[:4]
    )


def page(folder: Path, found: Sequence[Said]) -> str:
    """The whole page."""
    lines = [
        "# Public records",
        "",
        "Made by `make trial NAME=public`: every record of a folder through "
        "`thermogear measure`, with",
        "no option, beside what its README says. Nothing is told to the program: where a file",
        "states no rate, lines are in cycles per sample. The records are not part of the project.",
        "",
        "## What is known",
        "",
        *known(folder),
        "",
        "## What was said",
        "",
    ]
    for one in found:
        lines += rows(one)
    return "\n".join(lines).rstrip() + "\n"


def main(words: Sequence[str]) -> int:
    if len(words) > 1 or any(word.startswith("-") for word in words):
        print("error: arguments: got more than one folder, or an option; use trial_public.py "
              "[FOLDER]", file=sys.stderr)  # fmt: skip
        return 2
    folder = Path(words[0]) if words else FOLDER
    files = records(folder) if folder.is_dir() else []
    if not files:
        what = "holds no records" if folder.is_dir() else "is not there"
        print(f"{folder} {what}: {PAGE.relative_to(ROOT)} stays as it is")
        return 0
    found = []
    for path in files:
        found.append(said(path, folder))
        print(f"{found[-1].name}: {found[-1].refused or 'measured'}", flush=True)
    PAGE.write_text(page(folder, found), "utf-8")
    print(PAGE.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
