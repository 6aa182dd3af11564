"""``thermogear`` on the command line.

Nothing heavy is imported before a command needs it, so that help is instant. Every error a user
can make is one line on the error stream and exit code 2.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from thermogear import __version__
from thermogear.base.errors import InputError, InputErrors, ThermogearError, nearest, printable
from thermogear.base.parameters import long_name
from thermogear.front import (
    app_command,
    delivery,
    diagnose_command,
    draw_command,
    measure_commands,
    motion_commands,
    new_command,
    rexs_commands,
    study_commands,
    sweep_commands,
    thesis_commands,
    versus_commands,
)
from thermogear.front.lines import put_text, say, show_path, system_error, warnings_as_lines

if TYPE_CHECKING:
    from thermogear.base.progress import Progress
    from thermogear.results.result import Result

# the matrices here are small: threads of the linear algebra only wait for one another
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

USER_ERROR = 2
INTERRUPTED = 130


GROUPS = {
    "Begin": {
        "new": "Write a short case of your own gear pair.",
        "example": "Print a ready-made case, or list them.",
        "schema": "Print the JSON schema of a case file.",
        "check": "Check CASE without running it, and list its defaults.",
        "app": "Open CASE in the browser and turn its dials.",
        "draw": "Draw the gears of CASE in mesh, cold and hot.",
        "versus": "Set two to six cases side by side.",
        "report": "Draw the page of stored results anew.",
        "import": "List a REXS model, or write one of its stages as a case.",
    },
    "One pair": {
        "answers": "Answer the usual questions on CASE, each with a verdict.",
        "run": "Run CASE: temperatures, stiffness, motion, and a report.",
        "friction": "Draw every friction law over the path of contact of CASE.",
        "temperature": "Map temperatures and backlash over speed and torque.",
        "warmup": "Follow CASE from a cold start through its duty.",
        "relief": "Find the tip relief that makes the hot pair run evenly.",
        "contact": "Solve the loaded tooth contact over position and load.",
        "orbit": "Find the closed orbit a motion settles on.",
        "lyapunov": "Compute the largest Lyapunov exponent of a motion.",
    },
    "Over speed and load": {
        "sweep": "Compute the settled motion over any grid of parameters.",
        "runup": "Run CASE up and down in speed, without heat and hot.",
        "bifurcation": "Draw the orbit diagram of CASE over one parameter.",
        "continue": "Follow an orbit in a parameter and locate bifurcations.",
        "map": "Map the regimes of CASE over two parameters.",
        "basins": "Map which motion every start of CASE ends on.",
    },
    "Drive train": {
        "statics": "Compute the loads of shafts and bearings at rest.",
        "modes": "Compute the natural frequencies of the drive train.",
        "campbell": "Find the critical speeds, cold and hot.",
        "waterfall": "Run the drive train up and down, with forces and sound.",
    },
    "Records": {
        "measure": "Read a record and print its lines with their uncertainty.",
        "compare": "Compare CASE with records or tables of lines.",
        "detect": "Find which fault, of which size, which indicator sees.",
        "diagnose": "Hold gears and bearings in records against a baseline.",
    },
    "Research": {
        "sensitivity": "Rank the inputs that decide the results.",
        "thesis": "Judge the claims of the thesis.",
    },
}
"""Commands as the help lists them: group -> name -> one sentence of at most 60 characters."""


class _Commands(click.Group):
    """Commands in groups, in the order of use; an unknown one is answered with the nearest."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return [name for rows in GROUPS.values() for name in rows]

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        widest = max(map(len, self.commands))
        for title, rows in GROUPS.items():
            with formatter.section(title):
                formatter.write_dl([(name.ljust(widest), words) for name, words in rows.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and not args[0].startswith("-") and args[0] not in self.commands:
            raise click.UsageError(
                f"unknown command {args[0]!r}; {nearest(args[0], self.commands)}", ctx=ctx
            )
        return super().resolve_command(ctx, args)


def _one_name(token: str) -> str:
    """An option by any of the names of its parameter, hyphens and underscores alike."""
    return long_name(token).replace("_", "-")


_SETTINGS = {"help_option_names": ["-h", "--help"], "token_normalize_func": _one_name}


@click.group(cls=_Commands, context_settings=_SETTINGS)
@click.version_option(__version__, prog_name="thermogear", message="%(prog)s %(version)s")
def cli() -> None:
    """Dynamics of spur gear pairs that get hot.

    From a case file to a report: friction, flash and body temperature, hot backlash, mesh
    stiffness and nonlinear vibration.

    \b
      thermogear new -o mine.toml
      thermogear answers mine.toml
      thermogear run mine.toml -o results
    """


@cli.command()
@delivery.case
@delivery.output()
@delivery.overrides
@delivery.as_json
@click.option("--force", is_flag=True, help="Run even if it may not fit into the free memory.")
@click.option(
    "--pictures",
    type=click.Choice(["first", "all", "none"]),
    default="first",
    show_default=True,
    help="Which the page shows; `thermogear report DIR` draws all of them later.",
)
@click.option(
    "--curves", is_flag=True, help="Write the curves as CSV; `thermogear report DIR` can later."
)
def run(
    case: str,
    output: str,
    overrides: tuple[str, ...],
    as_json: bool,
    force: bool,
    pictures: str,
    curves: bool,
) -> None:
    """Run CASE and write results.nc, summary.json and report.html to DIR."""
    from thermogear.case.size import require_room
    from thermogear.results.files import require_ours

    read = delivery.load(case, overrides)
    require_room(read, forced=force)
    require_ours(Path(output))

    def make(report: Progress) -> Result:
        from thermogear.study.run import run as study
        from thermogear.thesis.errata import with_errata

        return with_errata(study(read, progress=report), read)

    delivery.deliver(make, output, as_json=as_json, pictures=pictures, curves=curves)


@cli.command()
@click.argument("directory", metavar="DIR")
@click.option("--of", default="", metavar="KIND", help="Which results, where DIR holds several.")
@click.option("--pictures", metavar="FOLDER", help="Save the page's pictures to FOLDER as well.")
@click.option("--kind", metavar="KIND", help="Of the pictures: png [the default], svg or pdf.")
@click.option("--curves", is_flag=True, help="Write the curves as CSV to DIR as well.")
@delivery.hide
def report(directory: str, of: str, pictures: str | None, kind: str | None, curves: bool) -> None:
    """Draw the page anew, with every picture, from the results of any command stored in DIR."""
    from thermogear.results.result import open_results
    from thermogear.views.write import page_of, write_pictures, write_report, write_tables

    place, written = Path(directory), list[Path]()
    if kind is not None and pictures is None:
        raise InputError("--kind", kind, why="no picture is saved", fix="add --pictures FOLDER")
    if pictures is not None:
        written = write_pictures(place, Path(pictures), kind or "png", of)
    if curves:
        page = page_of(open_results(place, of))
        written += dict.fromkeys(path.parent for path in write_tables(page, place))
    hidden = click.get_current_context().meta.get(delivery.HIDDEN, ())
    for path in (write_report(place, of, hidden=hidden), *written):
        show_path(path)


@cli.command()
@delivery.case
@delivery.overrides
@delivery.plain_json
def check(case: str, overrides: tuple[str, ...], as_json: bool) -> None:
    """Check CASE without running it: the numbers it amounts to, the defaults it has taken."""
    from thermogear.case.derived import facts
    from thermogear.case.size import estimated_bytes
    from thermogear.front.taken import defaults
    from thermogear.results.files import json_text

    read = delivery.load(case, overrides)
    found = facts(read)
    if as_json:
        rows = [{"group": f.group, "name": f.name, "value": f.value, "unit": f.unit} for f in found]
        ours = [{"field": a.field, **a.figure, "reason": a.reason} for a in read.assumptions]
        content = {"title": read.title, "kind": read.kind, "facts": rows, "assumptions": ours}
        click.echo(json_text(content), nl=False)
        return
    click.echo(read.title)
    group = ""
    for fact in found:
        if fact.group != group:
            group = fact.group
            click.echo(f"\n{group}")
        value = f"{fact.value:.7g}" if isinstance(fact.value, float) else str(fact.value)
        click.echo(f"  {fact.name:<38} {printable(value)} {fact.unit}".rstrip())
    taken = [line if line.startswith(" ") else f"\n{line}" for line in defaults(read.assumptions)]
    for line in taken:
        click.echo(line)
    count = len(read.assumptions)
    told = "1 value is ours" if count == 1 else f"{count or 'no'} values are ours"
    left = sum(bool(one.default) for one in read.assumptions)
    told += f", {'all' if left == count else left} of them defaults" if left else ""
    click.echo(f"\n{told}; a run takes about {estimated_bytes(read) / 2**20:.3g} MiB of memory")


_to_file = click.option("-o", "--output", metavar="FILE", help="Write a new FILE (UTF-8) instead.")


@cli.command()
@click.argument("name", required=False)
@_to_file
def example(name: str | None, output: str | None) -> None:
    """Print the ready-made case NAME; without a name, list them."""
    from thermogear.case.examples import EXAMPLES, example_text

    if name is None:
        if output is not None:
            raise click.UsageError(f"-o needs the NAME of a case: {' | '.join(EXAMPLES)}")
        for known, words in EXAMPLES.items():
            click.echo(f"{known:<12} {words}")
        return
    put_text(example_text(name), output)


@cli.command()
@_to_file
def schema(output: str | None) -> None:
    """Print the JSON schema of a case file."""
    from thermogear.case.schema import json_schema

    put_text(json.dumps(json_schema(), indent=2, ensure_ascii=False) + "\n", output)


for _list in (
    app_command,
    new_command,
    rexs_commands,
    draw_command,
    study_commands,
    motion_commands,
    sweep_commands,
    measure_commands,
    diagnose_command,
    thesis_commands,
    versus_commands,
):
    for _command in _list.COMMANDS:
        cli.add_command(_command)


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command line; the exit code: 0, 2 after a user's error, 130 after Ctrl+C."""
    arguments = list(sys.argv[1:] if argv is None else argv)
    try:
        with warnings_as_lines(), cli.make_context("thermogear", arguments) as context:
            cli.invoke(context)
    except click.exceptions.Exit as leaving:
        return leaving.exit_code
    except click.exceptions.NoArgsIsHelpError as without:
        click.echo(without.format_message())
        return USER_ERROR
    except click.ClickException as error:
        say("error", error.format_message())
        return USER_ERROR
    except ThermogearError as error:
        for one in error.errors if isinstance(error, InputErrors) else (error,):
            say("error", one.told if isinstance(one, InputError) else one)
        return USER_ERROR
    except (KeyboardInterrupt, click.Abort) as stop:
        say("interrupted", "; ".join(["stopped on request", *map(str, stop.args)]))
        return INTERRUPTED
    except BrokenPipeError:
        # the reader of the output left (as `head` does); there is nobody to tell
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except OSError as error:
        say("error", system_error(error))
        return USER_ERROR
    except (MemoryError, RecursionError) as error:
        say("error", f"{type(error).__name__}: the case is too large for this machine")
        return USER_ERROR
    return 0
