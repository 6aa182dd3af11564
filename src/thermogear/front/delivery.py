"""From a study to what its reader gets: stored, drawn, printed. Every command's way out."""

from __future__ import annotations

from collections.abc import Callable, Collection
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click

from thermogear.base.errors import InputError, meant, printable
from thermogear.base.progress import Progress
from thermogear.front.lines import show_path

if TYPE_CHECKING:
    from thermogear.case.case import DimensionlessCase, GearCase
    from thermogear.results.result import Result
    from thermogear.views.page import Page

CSV, HIDDEN = "thermogear.csv", "thermogear.hidden"
_Command = TypeVar("_Command", bound=Callable[..., Any])


OF_PART = {
    "--turn": "gears.period=turn",
    "--mean-tooth": "gears.period=mesh",
    "--part case": "gears.part=case",
    "--part nominal": "gears.part=nominal",
}
"""What ``--turn``, ``--mean-tooth`` and ``--part`` stand for."""


def _with_part(
    context: click.Context, _: click.Parameter, given: tuple[str, ...]
) -> tuple[str, ...]:
    """``--set`` and what ``--part``, ``--turn`` and ``--mean-tooth`` stand for; each once."""
    turn, mean, part = (context.params.pop(name) for name in ("turn", "mean_tooth", "part"))
    options = {"--turn": turn, "--mean-tooth": mean, f"--part {part}": part}
    taken = {option: OF_PART[option] for option, wanted in options.items() if wanted}
    fields = [change.partition("=")[0].strip() for change in (*given, *taken.values())]
    for option, change in taken.items():
        if fields.count(field := change.partition("=")[0]) > 1:
            fix = "leave one of --turn, --mean-tooth, --part and --set out"
            raise InputError(option, f"{field} twice", allowed="once", fix=fix)
    return (*given, *taken.values())


def together(*options: Callable[[_Command], _Command]) -> Callable[[_Command], _Command]:
    """Options that several commands have, in the order of the help."""

    def put(command: _Command) -> _Command:
        for option in reversed(options):
            command = option(command)
        return command

    return put


overrides: Callable[[Any], Any] = together(
    click.option(
        "--set",
        "overrides",
        multiple=True,
        metavar="PATH=VALUE",
        callback=_with_part,
        help="Put a value in place of the file's, as gears.pinion.teeth=30; PATH= leaves it "
        "out. May be repeated.",
    ),
    click.option(
        "--part",
        type=click.Choice(["case", "nominal"]),
        is_eager=True,
        help="Flanks as CASE has them, or as designed, with reliefs alone.",
    ),
    click.option(
        "--turn", is_flag=True, is_eager=True, help="The whole turn of gears whose teeth differ."
    ),
    click.option(
        "--mean-tooth", is_flag=True, is_eager=True, help="Their mean tooth over one mesh period."
    ),
)
"""``--set``, and the options that choose the part and its period."""


def _csv_place(context: click.Context, _: click.Parameter, name: str | None) -> None:
    """Keep the place of ``--csv`` for the end; refuse one that nobody could write to."""
    if name is None:
        return
    path = Path(name)
    if path.suffix.lower() != ".csv":
        raise InputError("--csv", name, allowed="a file that ends in .csv", fix=f"write {name}.csv")
    if path.is_dir() or not path.parent.is_dir():
        raise InputError(
            "--csv",
            name,
            allowed="a file",
            why="it is a directory" if path.is_dir() else f"{path.parent} is no directory",
            fix="write --csv points.csv",
        )
    context.meta[CSV] = path


csv = click.option(
    "--csv",
    metavar="FILE",
    expose_value=False,
    callback=_csv_place,
    help="Write FILE too: a row for each point, units in the heads, labels as words.",
)


def put_csv(result: Result) -> None:
    """Write the points of ``result`` where ``--csv`` wants them, whole or not at all.

    Lines at the orders of a turn stand in a file beside it, ``points_lines.csv``.
    """
    path = click.get_current_context().meta.get(CSV)
    if path is not None:
        from thermogear.base.files import put
        from thermogear.results.tables import csv_text

        put(path, csv_text(result.to_frame(units="display")))
        data = next(iter(result.groups.values()))
        if "dte_line" in data and "mesh_periods" in data.attrs:
            from thermogear.base.period import line_names

            along = [str(dim) for dim in data["dte_line"].dims]
            lines = result.to_frame(along=along, units="display")
            names = line_names(data.attrs, data["order"].values)
            lines.insert(along.index("order"), "line", names * (len(lines) // len(names)))
            put(path.with_name(f"{path.stem}_lines.csv"), csv_text(lines))


def _hidden(context: click.Context, _: click.Parameter, given: tuple[str, ...]) -> None:
    """Keep the codes of ``--hide`` for the end; refuse one that no notice has."""
    from thermogear.base.notice import catalogue

    codes = [code.strip() for text in given for code in text.split(",")]
    for code in codes:
        if code not in catalogue():
            near = meant(code, catalogue(), cutoff=0.6) or "--json shows the code of every notice"
            raise InputError("--hide", repr(code), why="no notice has this code", fix=near)
    context.meta[HIDDEN] = codes


hide = click.option(
    "--hide",
    metavar="CODE[,CODE]",
    multiple=True,
    expose_value=False,
    callback=_hidden,
    help="Leave out the notices of this code. May be repeated.",
)


def without_hidden(page: Page) -> Page:
    """The page without the notices that ``--hide`` names; one says how many there were."""
    from thermogear.views.write import page_of

    shown = page.result.hiding(click.get_current_context().meta.get(HIDDEN, ()))
    return page if shown is page.result else page_of(shown)


plain_json = click.option("--json", "as_json", is_flag=True, help="Print the figures as JSON.")
"""Of commands that have no notices."""


as_json: Callable[[Any], Any] = together(plain_json, hide)
"""``--json``, and ``--hide`` of the notices that page, terminal and JSON show."""


case = click.argument("case", metavar="CASE")


def output(
    words: str = "Directory of the results; made if new.", *, required: bool = True
) -> Callable[[_Command], _Command]:
    """``-o DIR``."""
    return click.option("-o", "--output", required=required, metavar="DIR", help=words)


def load(path: str, changes: tuple[str, ...]) -> GearCase | DimensionlessCase:
    """The case of a command, its file or a ready-made one."""
    from thermogear.case.case import load_case

    try:
        return load_case(Path(path), changes)
    except InputError as error:
        if error.field == "gears" and set(changes) & set(OF_PART.values()):
            raise InputError(
                "--turn, --mean-tooth or --part", "a case without gears", fix="leave it out"
            ) from error
        raise


def heat_once(axes: Collection[str], state: str | None) -> None:
    """Refuse ``--state`` beside an axis of gear temperatures: neither says which one is meant."""
    if "gear_temperature" in axes and state is not None:
        raise InputError(
            "--state",
            state,
            why="the gear temperature itself is varied here",
            fix="leave out --state, or the temperature",
        )


def load_gears(path: str, changes: tuple[str, ...]) -> GearCase:
    """The same where it must have gears."""
    from thermogear.case.case import gear_case

    return gear_case(load(path, changes))


def deliver(
    make: Callable[[Progress], Result],
    directory: str | None,
    *,
    as_json: bool,
    kept: str = "what was found so far stays",
    pictures: str = "all",
    curves: bool = True,
) -> None:
    """Compute, store and draw into ``directory`` if one is named, and print.

    The directory is claimed before anything is computed; everything is written, or after an
    error or Ctrl+C nothing. ``pictures`` says how many the page shows: all, first or none;
    ``curves``, whether its tables are written. A result that Ctrl+C cut short is kept, and Ctrl+C
    passed on.
    """
    from thermogear.front.progress import Stopped, progress
    from thermogear.results.files import claimed

    place = None if directory is None else Path(directory)
    written: list[Path] = []
    with nullcontext() if place is None else claimed(place) as folder:
        with progress(wanted=not as_json) as report:
            result = make(report)
        from thermogear.views.write import clear_tables, page_of, write

        put_csv(result)
        page = without_hidden(page_of(result))
        if folder is not None:
            result.put(folder)
            every = f"All of them: thermogear report {printable(str(place))}"
            shown = page if pictures == "all" else page.showing(pictures, every)
            written = write(shown, folder, tables=curves)
    if place is not None:
        clear_tables(place, written)
    tell(page, None if place is None else place / written[0].name, as_json=as_json)
    if result.interrupted:
        raise Stopped("what was found so far is printed" if place is None else f"{kept} in {place}")


def tell(page: Page, path: Path | None, *, as_json: bool) -> None:
    """Print a page as a terminal or a script wants it, and its path."""
    from thermogear.results.files import json_text

    page = without_hidden(page)
    if as_json:
        click.echo(json_text(page.figures), nl=False)
        return
    for line in page.lines():
        click.echo(line)
    if path is not None:
        show_path(path)
