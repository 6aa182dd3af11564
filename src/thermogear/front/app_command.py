"""``thermogear app``: turn a dial, see the gears answer."""

from __future__ import annotations

import click

from thermogear.base.errors import of_extra
from thermogear.front import delivery

USUAL_PORT = 8350


@click.command()
@click.argument("case", metavar="[CASE]", default="rig")
@click.option("--port", type=click.IntRange(1, 65535), help=f"Port [{USUAL_PORT}, or a free one].")
@click.option("--no-browser", is_flag=True, help="Only print the address.")
@delivery.overrides
def app(case: str, port: int | None, no_browser: bool, overrides: tuple[str, ...]) -> None:
    """Open CASE in the browser: turn a dial, see stiffness, backlash, run-up and orbit answer.

    The page is served to this machine alone, at an address with a secret in it; Ctrl+C ends it.
    Everything shown can be had as a case file, as a command and as a report. Needs the extra [app].

    \b
      thermogear app mine.toml
    """
    for package in ("starlette", "uvicorn", "websockets"):
        of_extra(package, "app", field="app", got=f"no package {package}", use="the app")
    read = delivery.load_gears(case, overrides)

    from thermogear.front.app import guard, server
    from thermogear.front.app.given import Given

    given = Given(case, read)
    listening, token = server.bound(port, usual=USUAL_PORT), guard.new_token()
    click.echo(f"http://{server.ADDRESS}:{listening.getsockname()[1]}/?token={token}")
    click.echo("open it in a browser on this machine; Ctrl+C ends it", err=True)
    server.serve(given, listening, token, browser=not no_browser)


COMMANDS: tuple[click.Command, ...] = (app,)
"""For the main group to register."""
