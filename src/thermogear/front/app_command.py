"""``thermogear app``: turn a dial, see the gears answer."""

from __future__ import annotations

from typing import Any

import click

from thermogear.base.errors import InputError, of_extra
from thermogear.front import delivery
from thermogear.front.measure_commands import supplies
from thermogear.front.measuring import measured_by

USUAL_PORT = 8350


@click.command()
@click.argument("case", metavar="[CASE]", default="rig")
@click.argument("record", metavar="[RECORD]", required=False)
@click.option("--port", type=click.IntRange(1, 65535), help=f"Port [{USUAL_PORT}, or a free one].")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@delivery.overrides
@supplies
def app(
    case: str,
    record: str | None,
    port: int | None,
    no_browser: bool,
    overrides: tuple[str, ...],
    **options: Any,
) -> None:
    """Open CASE in the browser: turn a dial, see stiffness, backlash, run-up and orbit answer.

    RECORD is drawn over the computed orders. The page is served to this machine alone, at an
    address with a secret in it; Ctrl+C ends it. Everything shown can be had as a case file, as a
    command and as a report. Needs the extra [app].

    \b
      thermogear app mine.toml
      thermogear app mine.toml record.csv --rate 25600 --unit g
    """
    for package in ("starlette", "uvicorn", "websockets"):
        of_extra(package, "app", field="app", got=f"no package {package}", use="the app")
    given_options = {n: v for n, v in options.items() if v not in (None, (), "frequency")}
    if record is None and given_options:
        name = next(iter(given_options))
        option = "--channel" if name == "channels" else f"--{name.replace('_', '-')}"
        raise InputError(
            option, given_options[name], why="there is no record to read", fix="leave it out"
        )
    read = delivery.load_gears(case, overrides)
    if record is not None and options["teeth"] is None:
        options["teeth"] = read.pair.pinion.teeth
    measured = None if record is None else measured_by(record, options)

    from pathlib import Path

    from thermogear.front.app import guard, server
    from thermogear.front.app.given import Given

    given = Given(case, read, measured, "" if record is None else Path(record).name)
    listening, token = server.bound(port, usual=USUAL_PORT), guard.new_token()
    click.echo(f"http://{server.ADDRESS}:{listening.getsockname()[1]}/?token={token}")
    click.echo("open it in a browser on this machine; Ctrl+C ends it", err=True)
    server.serve(given, listening, token, browser=not no_browser)


COMMANDS: tuple[click.Command, ...] = (app,)
"""For the main group to register."""
