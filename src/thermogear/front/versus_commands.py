"""``thermogear versus``: cases side by side; a command for the main group to register."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.base.progress import Progress
    from thermogear.case.case import GearCase
    from thermogear.results.result import Result


@click.command()
@click.argument("results", nargs=-1, metavar="RESULTS RESULTS [...]")
@delivery.output("Directory of the page; made if new.")
@delivery.overrides
@delivery.as_json
def versus(
    results: tuple[str, ...], output: str, overrides: tuple[str, ...], as_json: bool
) -> None:
    """Set two to six cases side by side: what differs, key figures, curves over each other.

    Each of RESULTS is a directory of `thermogear run`, or a case (its file, or the name of a
    ready-made one), which is run first, as the options say, into a directory of its own below
    DIR. Writes versus.html, versus.nc and CSV tables.
    """
    from thermogear.study import versus as study

    study.require_number(len(results))
    directory = Path(output)
    paths = [_existing(Path(given)) for given in results]

    from thermogear.base.errors import InputError
    from thermogear.case.size import require_room
    from thermogear.front.progress import Stopped
    from thermogear.results.result import read_results
    from thermogear.study.run import run
    from thermogear.thesis.errata import with_errata
    from thermogear.views.write import save_results

    # everything is read and checked before the first case runs
    results_by_place: dict[int, Result] = {}
    cases: dict[int, GearCase] = {}
    for place, path in enumerate(paths):
        if path.is_dir():
            results_by_place[place] = read_results(path)
            study.require_gears(str(path), results_by_place[place].kind)
        else:
            cases[place] = delivery.load_gears(str(path), overrides)
            require_room(cases[place])
    if overrides and not cases:
        why = "directories of results stay as they are"
        raise InputError("overrides", ", ".join(overrides), why=why, fix="name a case, or none")
    homes = _homes(directory, paths)
    done = 0

    def make(report: Progress) -> Result:
        nonlocal done
        for place, case in cases.items():
            results_by_place[place] = with_errata(run(case, progress=report), case)
            save_results(results_by_place[place], homes[place])
            done += 1
        stored = [study.stored(results_by_place[p], homes[p].name) for p in range(len(paths))]
        return study.versus(stored)

    try:
        delivery.deliver(make, output, as_json=as_json)
    except KeyboardInterrupt:
        if not done:
            raise
        what = f"{done} of {len(cases)} runs are whole and stay below {directory}"
        raise Stopped(what) from None


def _existing(path: Path) -> Path:
    """``path`` where it is there or names a ready-made case; else the nearest name there."""
    from thermogear.base.errors import InputError
    from thermogear.base.files import meant_beside
    from thermogear.case.examples import EXAMPLES

    if path.exists() or str(path) in EXAMPLES:
        return path
    raise InputError(
        "results",
        repr(str(path)),
        why="there is no such directory or case file",
        fix=meant_beside(path) or "`thermogear run CASE -o DIR` writes one",
    )


def _homes(directory: Path, paths: list[Path]) -> list[Path]:
    """Where the results of each path are: a directory given, or a new one below DIR."""
    taken = {path.resolve() for path in paths if path.is_dir()}
    homes = []
    for path in paths:
        home, number = path, 1
        if not path.is_dir():
            name = path.name.removesuffix(".toml")
            home = directory / name
            while home.resolve() in taken:
                number += 1
                home = directory / f"{name}-{number}"
            taken.add(home.resolve())
        homes.append(home)
    return homes


COMMANDS: list[click.Command] = [versus]
