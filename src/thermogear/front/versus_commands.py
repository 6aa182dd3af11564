"""``thermogear versus``: cases side by side; a command for the main group to register."""

from __future__ import annotations

import difflib
import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from thermogear.case.case import DimensionlessCase, GearCase


@click.command()
@click.argument("results", nargs=-1, metavar="RESULTS RESULTS [...]")
@click.option(
    "-o", "--output", required=True, metavar="DIR", help="Directory of the page; made if new."
)
@click.option("--json", "as_json", is_flag=True, help="Print the comparison as JSON.")
def versus(results: tuple[str, ...], output: str, as_json: bool) -> None:
    """Set two to six cases side by side: what differs, key figures, curves over each other.

    Each of RESULTS is a directory of `thermogear run`, or a case (its file, or the name of a
    ready-made one), which is run first into a directory of its own below DIR. Writes versus.html,
    versus.nc and CSV tables.
    """
    from thermogear.study import versus as study

    study.require_number(len(results))
    directory = Path(output)
    paths = [_existing(Path(given)) for given in results]

    from thermogear.case.case import load_case
    from thermogear.case.size import require_room
    from thermogear.front.progress import Stopped, progress
    from thermogear.results.files import claimed
    from thermogear.results.result import Results, read_results
    from thermogear.views.versus_report import write_versus

    # everything is read and checked before the first case runs
    found: dict[int, Results] = {}
    cases: dict[int, GearCase | DimensionlessCase] = {}
    kinds: dict[str, str] = {}
    for place, path in enumerate(paths):
        if path.is_dir():
            found[place] = read_results(path)
            kinds[str(path)] = found[place].kind
        else:
            cases[place] = load_case(path)
            require_room(cases[place])
            kinds[str(path)] = cases[place].kind
    study.require_one_kind(kinds)
    homes = _homes(directory, paths)
    done = 0
    try:
        with claimed(directory) as folder:
            for place, case in cases.items():
                from thermogear.study.run import run_to_directory

                with progress(wanted=not as_json) as told:
                    run_to_directory(case, homes[place], progress=told)
                done += 1
                found[place] = read_results(homes[place])
            stored = [
                study.Stored(homes[place].name, found[place].texts, found[place].groups)
                for place in range(len(paths))
            ]
            data = study.versus(stored)
            study.store(data, folder)
            page = write_versus(folder)[0].name
    except KeyboardInterrupt:
        if not done:
            raise
        what = f"{done} of {len(cases)} runs are whole and stay below {directory}"
        raise Stopped(what) from None
    if as_json:
        click.echo(json.dumps(study.summary(data), indent=2, ensure_ascii=False))
        return
    for notice in json.loads(data.attrs["notices"]):
        click.echo(f"- {notice['text']}")
    click.echo(directory / page)


def _existing(path: Path) -> Path:
    """``path`` where it is there or names a ready-made case; else the nearest name beside it."""
    from thermogear.base.errors import InputError
    from thermogear.case.examples import EXAMPLES

    if path.exists() or str(path) in EXAMPLES:
        return path
    try:
        beside = [one.name for one in path.parent.iterdir()]
    except OSError:
        beside = []
    close = difflib.get_close_matches(path.name, beside, n=1, cutoff=0.6)
    raise InputError(
        "results",
        repr(str(path)),
        why="there is no such directory or case file",
        fix=f"did you mean {close[0]!r}?" if close else "`thermogear run CASE -o DIR` writes one",
    )


def _homes(directory: Path, paths: list[Path]) -> list[Path]:
    """Where the results of each path stand: a directory given, or a new one below DIR."""
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
