"""Kills of eight commands at random moments: is anything lost, different or left over?

``make trial-kills`` runs each command once undisturbed, then again and again in a new folder: it is
killed (SIGKILL) at a random moment of its usual time and given once more, until it was killed 25
times and then ends by itself. Its folder is then compared, file by file, with that of the
undisturbed run, and searched for names that only a killed writer leaves. Writes
docs/trial_kills.md; ``python checks/trial_kills.py 3`` kills each command three times and prints.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr

SEED = 20_2026
KILLS = 25
PAGE = Path(__file__).parents[1] / "docs" / "trial_kills.md"
SMALL = "--set grid.path_positions=41 --set grid.mesh_positions=48 --set grid.harmonics=12"
COMMANDS = {
    "run": f"run rig {SMALL}",
    "map": "map rig --over rpm=1000:9000:24 --over temperature=20:140:12 --full",
    "sweep": f"sweep rig --over torque=40:120:40 {SMALL}",
    "runup": "runup rig --rpm 2000:9000:40",
    "basins": "basins table-4.2 --x -2:2:61 --v -2:2:61",
    "bifurcation": "bifurcation table-4.2 --over zeta=0.02:0.2:60",
    "train": "bifurcation motor-train --over rpm=1000:3000:4",
    "measure": "measure {records} --unit g",
}
STAMPS = re.compile(r"\d{4}-\d\d-\d\d[T ][\d:.]+(Z|[+-]\d\d:?\d\d)?|\d+(\.\d+)? s\b")
"""What differs between two runs of one command: when they were, how long they took."""


@dataclass
class Count:
    """What the kills of one command showed."""

    kills: int = 0
    begun: int = 0  # kills after which something was in the folder
    files: int = 0
    lost: int = 0
    differing: int = 0
    left: int = 0
    wrong: str = ""


def start(words: str, out: Path) -> subprocess.Popen[str]:
    """The command, in a process group of its own: its workers are killed with it."""
    return subprocess.Popen(
        [sys.executable, "-m", "thermogear", *words.split(), "-o", out.name], cwd=out.parent,
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


def content(path: Path) -> str:
    """A digest of what a file says; of a netCDF file its numbers, of a text without its times."""
    if path.suffix == ".nc":
        seen = hashlib.sha256()
        for name, group in xr.open_datatree(path, engine="h5netcdf").to_dict().items():
            for key in sorted(map(str, group.variables)):
                seen.update(f"{name}/{key}".encode())
                seen.update(np.ascontiguousarray(group[key].values.astype("U")).tobytes())
        return seen.hexdigest()
    raw = path.read_bytes()
    with contextlib.suppress(UnicodeDecodeError):
        raw = STAMPS.sub("", raw.decode()).encode()
    return hashlib.sha256(raw).hexdigest()


def files(folder: Path) -> dict[str, Path]:
    """Files of a folder by their names in it; the seals follow what they seal."""
    return {
        str(path.relative_to(folder)): path
        for path in sorted(folder.rglob("*"))
        if path.is_file() and path.suffix != ".sha256"
    }


def stored(path: Path) -> bool:
    """Whether a file must be the same: the journal is the order in which chunks were finished."""
    return path.name not in {"lock", "journal.jsonl", "summary.json"}


def compare(whole: Path, folder: Path, count: Count) -> None:
    """Add what is lost, different or left over in ``folder`` to ``count``."""
    right, seen = files(whole), files(folder)
    count.files = len(right)
    lost = set(right) - set(seen)
    left = {name for name in seen if ".part" in name} | (set(seen) - set(right))
    other = {n for n in set(right) & set(seen) if stored(right[n])}
    differing = {n for n in other if content(right[n]) != content(seen[n])}
    count.lost, count.left, count.differing = len(lost), len(left), len(differing)
    count.wrong = ", ".join(sorted(lost | left | differing)[:5])


def trial(words: str, kills: int, chance: random.Random) -> Count:
    """One command killed ``kills`` times at random moments, then left to end."""
    count = Count()
    with tempfile.TemporaryDirectory() as place:
        whole, folder = Path(place) / "whole" / "out", Path(place) / "killed" / "out"
        whole.parent.mkdir()
        folder.parent.mkdir()
        clock = time.monotonic()
        process = start(words, whole)
        _, said = process.communicate()
        if process.returncode:
            count.wrong = said.strip().splitlines()[-1]
            return count
        usual = time.monotonic() - clock
        while count.kills < kills:
            process = start(words, folder)
            try:
                process.communicate(timeout=chance.uniform(0.2, 1.0) * usual)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate()
                count.kills += 1
                count.begun += folder.is_dir() and any(folder.iterdir())
        process = start(words, folder)
        _, said = process.communicate()
        if process.returncode:
            count.wrong = said.strip().splitlines()[-1]
            count.lost += 1
            return count
        compare(whole, folder, count)
    return count


def records(folder: Path) -> None:
    """Four short records, for a folder that is measured."""
    time_of = np.arange(8192) / 12_800.0
    for number in range(4):
        line = np.cos(2.0 * np.pi * (600.0 + 10.0 * number) * time_of)
        rows = "".join(f"{t:.9f},{v:.7g}\n" for t, v in zip(time_of, line, strict=True))
        (folder / f"r{number}.csv").write_text(f"time,a\ns,g\n{rows}", encoding="utf-8")


def main(words: list[str]) -> int:
    """Print the table; write the page after a whole trial."""
    kills = int(words[0]) if words else KILLS
    only = words[1:] or list(COMMANDS)
    chance = random.Random(SEED)
    rows = [
        "| command | kills | with something stored | files | lost | differing | left over |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    wrong = []
    with tempfile.TemporaryDirectory() as place:
        records(Path(place))
        for name in only:
            asked = COMMANDS[name].format(records=place)
            count = trial(asked, kills, chance)
            row = [count.kills, count.begun, count.files, count.lost, count.differing, count.left]
            rows.append(f"| {name} | " + " | ".join(map(str, row)) + " |")
            wrong += [f"- {name}: {count.wrong}"] * bool(count.wrong)
            print(json.dumps({"command": name, **vars(count)}), file=sys.stderr, flush=True)
    print("\n".join([*rows, "", *wrong]))
    if not words:
        head = ["---", "orphan: true", "---", "# Trial of kills", ""]
        head += [
            f"Made by `make trial-kills` (seed {SEED}): each command is killed at {KILLS} random"
        ]
        head += [
            "moments and given again, then ends by itself; its folder is compared with that of an"
        ]
        head += ["undisturbed run: all files but their times, the numbers of netCDF files.", ""]
        PAGE.write_text("\n".join([*head, *rows, "", *wrong, ""]), "utf-8")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
