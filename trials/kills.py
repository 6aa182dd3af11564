"""Kills of eight commands at random moments: is anything lost, different or left over?

``make trial NAME=kills`` runs each command once undisturbed, then in new folders: it is killed
(SIGKILL)
at a random moment of its usual time and given once more, until it was killed five times or ended by
itself before; 25 kills a command. Everything below the directory it was started in is then
compared with what the undisturbed run left, file by file, the directory for temporary files
included; every seal must vouch for its file. Writes trials/records/kills.md;
``python trials/kills.py 3 run`` kills one command three times and prints.
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
ROW = 5
"""Kills of one folder before the command is left to end."""
PAGE = Path(__file__).parents[1] / "trials" / "records" / "kills.md"
SMALL = "--set grid.path_positions=41 --set grid.mesh_positions=48 --set grid.harmonics=12"
COMMANDS = {
    "run": f"run rig {SMALL}",
    "map": "map rig --over rpm=1000:9000:24 --over temperature=20:140:12 --full",
    "sweep": f"sweep rig --over torque=40:120:40 {SMALL}",
    "runup": "runup rig --rpm 2000:9000:40",
    "basins": "basins table-4.2 --x -2:2:61 --v -2:2:61",
    "bifurcation": "bifurcation table-4.2 --over zeta=0.02:0.2:60",
    "train": "bifurcation rig-train --over rpm=1000:3000:4 --coordinates 24 --branch-period 0",
    "measure": "measure {records} --unit g",
}
STAMPS = re.compile(
    r"\d{4}-\d\d-\d\d[T ][\d:.]+(Z|[+-]\d\d:?\d\d)?|\d+(\.\d+)? s\b|\"seconds\": [\d.e-]+"
)
"""What differs between two runs of one command: when they were, how long they took."""


@dataclass
class Count:
    """What the kills of one command showed; files are counted over all folders compared."""

    kills: int = 0
    begun: int = 0  # kills after which something was in the folder
    folders: int = 0
    files: int = 0
    lost: int = 0
    differing: int = 0
    left: int = 0
    wrong: str = ""


def start(words: str, place: Path) -> subprocess.Popen[str]:
    """The command, in a process group of its own: its workers are killed with it."""
    temporary = place / "temporary"
    temporary.mkdir(exist_ok=True)
    return subprocess.Popen(
        [sys.executable, "-W", "ignore", "-m", "thermogear", *words.split(), "-o", "out"],
        cwd=place, env=os.environ | {"TMPDIR": str(temporary)},
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip


def content(path: Path) -> str:
    """A digest of what a file says: numbers and attributes of netCDF, texts without their times."""
    digest = hashlib.sha256()
    if path.suffix == ".nc":
        with xr.open_datatree(path, engine="h5netcdf") as tree:
            for name, group in tree.to_dict().items():
                digest.update(STAMPS.sub("", f"{name} {sorted(group.attrs.items())}").encode())
                for key in sorted(map(str, group.variables)):
                    digest.update(f"{key} {sorted(group[key].attrs.items())}".encode())
                    digest.update(np.ascontiguousarray(group[key].values.astype("U")).tobytes())
        return digest.hexdigest()
    raw = path.read_bytes()
    if path.name == "journal.jsonl":
        return said_by_journal(raw.decode())
    with contextlib.suppress(UnicodeDecodeError):
        raw = STAMPS.sub("", raw.decode()).encode()
    return hashlib.sha256(raw).hexdigest()


def said_by_journal(text: str) -> str:
    """The chunks and the whole that a journal vouches for, in no order."""
    entries = []
    for line in text.splitlines():
        with contextlib.suppress(ValueError):
            entry = json.loads(line.partition(" ")[2])
            if "chunk" in entry or "whole" in entry:
                entries.append(json.dumps({k: v for k, v in entry.items() if k != "created"}))
    return "\n".join(sorted(set(entries)))


def files(folder: Path) -> dict[str, Path]:
    """Everything below a folder by its name in it, empty directories too."""
    return {
        str(path.relative_to(folder)): path
        for path in sorted(folder.rglob("*"))
        if path.is_file() or not any(path.iterdir())
    }


def vouched(path: Path) -> bool:
    """Whether a seal holds the digest of its file."""
    raw = path.with_suffix("").read_bytes()
    return hashlib.sha256(raw).hexdigest() in path.read_text().split()


def compare(whole: Path, place: Path, count: Count) -> None:
    """Add what is lost, different or left over in ``place`` to ``count``."""
    right, seen = files(whole), files(place)
    lost = set(right) - set(seen)
    left = {name for name in seen if ".part" in name} | (set(seen) - set(right))
    differing = {
        name
        for name in set(right) & set(seen)
        if right[name].is_file()
        and not (
            vouched(seen[name])
            if name.endswith(".sha256")
            else content(right[name]) == content(seen[name])
        )
    }
    count.folders += 1
    count.files += len(right)
    count.lost += len(lost)
    count.left += len(left)
    count.differing += len(differing)
    count.wrong = count.wrong or ", ".join(sorted(lost | left | differing)[:5])


def ended(process: subprocess.Popen[str], count: Count) -> bool:
    """Whether the command ended as it should; else its last line is kept."""
    _, said = process.communicate()
    if process.returncode:
        count.wrong = count.wrong or said.strip().splitlines()[-1]
    return not process.returncode


def trial(words: str, kills: int, chance: random.Random) -> Count:
    """One command killed ``kills`` times at random moments, then left to end."""
    count = Count()
    with tempfile.TemporaryDirectory() as place:
        whole = Path(place) / "whole"
        whole.mkdir()
        if not ended(start(words, whole), Count()):
            count.wrong = "the undisturbed run failed"
            return count
        clock = time.monotonic()  # the second: kernels are compiled, the machine is warm
        usual_place = Path(place) / "usual"
        usual_place.mkdir()
        ended(start(words, usual_place), count)
        usual = time.monotonic() - clock
        compare(whole, usual_place, count)
        number = 0
        while count.kills < kills:
            number += 1
            folder = Path(place) / f"killed-{number}"
            folder.mkdir()
            for _ in range(min(ROW, kills - count.kills)):
                process = start(words, folder)
                try:
                    process.wait(timeout=chance.uniform(0.2, 1.0) * usual)
                except subprocess.TimeoutExpired:
                    os.killpg(process.pid, signal.SIGKILL)
                    process.communicate()
                    count.kills += 1
                    count.begun += (folder / "out").is_dir() and any((folder / "out").iterdir())
                else:
                    ended(process, count)
                    break
            if ended(start(words, folder), count):
                compare(whole, folder, count)
            else:
                count.lost += 1
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
        "| command | kills | with something stored | folders compared | files in them | lost "
        "| differing | left over |",
        "|---|---:|---:|---:|---:|---:|---:|---:|",
    ]
    wrong = []
    with tempfile.TemporaryDirectory() as place:
        records(Path(place))
        for name in only:
            asked = COMMANDS[name].format(records=place)
            count = trial(asked, kills, chance)
            row = list(vars(count).values())[:-1]
            rows.append(f"| {name} | " + " | ".join(map(str, row)) + " |")
            wrong += [f"- {name}: {count.wrong}"] * bool(count.wrong)
            print(json.dumps({"command": name, **vars(count)}), file=sys.stderr, flush=True)
    print("\n".join([*rows, "", *wrong]))
    if not words:
        head = ["# Trial of kills", ""]
        head += [
            f"Made by `make trial NAME=kills` (seed {SEED}). Each command is killed "
            "(SIGKILL, with its",
            f"workers) {KILLS} times at a random moment between a fifth and the whole of its usual",
            f"time and given again; after {ROW} kills, or when it ends before the kill, it is left",
            "to end. Everything below the directory it was started in is then compared, file by",
            "file, with what an undisturbed run left: texts without dates and durations, numbers",
            "and attributes of netCDF files, entries of the journal; every seal must vouch for its",
            "file. The directory for temporary files is compared too. One undisturbed repetition",
            "is in the count.",
            "",
        ]
        PAGE.write_text("\n".join([*head, *rows, "", *wrong, ""]), "utf-8")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
