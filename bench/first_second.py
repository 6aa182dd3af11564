"""Processor time of what people wait for first, in units of ``import numba``, trees side by side.

Run as ``python bench/first_second.py OLD/src NEW/src``: each command runs in a process of its own,
warm (machine code and bytecode stored by a first round that does not count), the trees in turn,
each round at another torque, and the unit in the same round. ``--cold`` adds the first answers
with no machine code stored. Printed are the medians and quartiles [s of user and system time], and
how many units each is. Accuracy is asked by ``make same``.
"""

from __future__ import annotations

import argparse
import os
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

OWN = """
[gears]
module = "3 mm"
face_width = "30 mm"
[gears.pinion]
teeth = 23
[gears.wheel]
teeth = 41
[oil]
name = "ISO VG 100"
[operating]
speed = "1700 rpm"
torque = "{torque} N m"
[flanks]
seed = 1
"""
COMMANDS = {
    "answers, own pair": ["answers", "own.toml"],
    "run rig": ["run", "rig.toml", "-o", "run"],
    "runup rig, with branches": ["runup", "rig.toml", "--rpm", "3000:6000:60", "-o", "runup"],
}
COLD = "answers, nothing compiled"


def spent(command: list[str], tree: str, folder: Path, **more: str) -> float:
    """User and system time [s] of a process and of those that it started."""
    environment = {**os.environ, "PYTHONPATH": tree, **more}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env=environment, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def one_round(number: int, trees: list[str], commands: dict[str, list[str]]) -> dict[str, float]:
    """Seconds of every command and tree, at a torque that no round before had, and of the unit."""
    took: dict[str, float] = {}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        took["unit"] = spent([sys.executable, "-c", "import numba"], trees[0], folder)
        (folder / "own.toml").write_text(OWN.format(torque=100 + number), "utf-8")
        for title, words in commands.items():
            for tree in trees:
                start = [sys.executable, "-m", "thermogear"]
                example = [*start, "example", "rig"]
                environment = {**os.environ, "PYTHONPATH": tree}
                text = subprocess.run(
                    example, env=environment, check=True, stdout=subprocess.PIPE, text=True
                ).stdout
                rig = text.replace('torque = "100 N m"', f'torque = "{100 + number} N m"')
                (folder / "rig.toml").write_text(rig, "utf-8")
                more = {"NUMBA_CACHE_DIR": str(folder / "code")} if title == COLD else {}
                took[f"{title}|{tree}"] = spent([*start, *words], tree, folder, **more)
                for made in ("run", "runup", "code"):
                    shutil.rmtree(folder / made, ignore_errors=True)
    return took


def main() -> None:
    """Print a line for each command and tree."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("trees", nargs="+", metavar="TREE/src")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--cold", action="store_true")
    asked = parser.parse_args()
    trees = [str(Path(tree).resolve()) for tree in asked.trees]
    commands = dict(COMMANDS)
    if asked.cold:
        commands[COLD] = COMMANDS["answers, own pair"]
    one_round(0, trees, COMMANDS)
    rounds = [one_round(number, trees, commands) for number in range(1, asked.rounds + 1)]
    unit = statistics.median(each["unit"] for each in rounds)
    print(f"{unit:6.2f} s  import numba, the unit")
    for name in list(rounds[0])[1:]:
        title, tree = name.split("|")
        seconds = sorted(each[name] for each in rounds)
        low, middle, high = statistics.quantiles(seconds, n=4, method="inclusive")
        spread = f"({low:.2f} to {high:.2f})"
        print(f"{middle:6.2f} s {spread}  {middle / unit:5.1f} units  {title}  {tree}")


if __name__ == "__main__":
    main()
