"""``thermogear thesis``: a command for the main group to register."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.results.result import Result


OPTIONS = {"records": "record", "overrides": "set"}
"""Options of many values by their parameters."""


@click.command()
@click.argument("case", metavar="[CASE]", required=False)
@delivery.output("Directory of the report; made if new.")
@click.option(
    "--operating", type=int, metavar="N",
    help="Operating point of CASE, from 1 [the one nearest to resonance].",
)  # fmt: skip
@click.option("--bundle", metavar="NAME", help="Bundle of CASE [the first].")
@click.option(
    "--temperatures", metavar="FROM:TO:COUNT", help="Gear temperatures in degC [100:160:4]."
)
@click.option(
    "--values", type=click.IntRange(2, 10_000), metavar="N", help="Values of each diagram [61]."
)
@click.option(
    "--record", "records", multiple=True, metavar="FILE[=RPM]",
    help="A record to put beside CASE, with its pinion speed where the file does not say it. May "
    "be repeated.",
)  # fmt: skip
@delivery.overrides
@delivery.as_json
def thesis(case: str | None, output: str, as_json: bool, **options: Any) -> None:
    """Judge every claim of the thesis, or redo the thesis for CASE, and write the report to DIR.

    Without CASE sections 2 to 6: what is said, what is computed as in the thesis and consistently,
    a verdict, its argument and the code behind it. With CASE the thesis's steps for one operating
    point of it: gear temperatures, damping, speed and stiffness fluctuation, friction and
    records. Ctrl+C keeps what is finished.
    """
    if case is not None:
        _redone(case, output, as_json, options)
        return
    for name, value in options.items():
        if value:
            raise InputError(f"--{OPTIONS.get(name, name)}", value, why="no case is named")
    from thermogear.study.sensitivity import require_salib

    require_salib()

    def make(report: Progress) -> Result:
        from thermogear.thesis.report import build

        return build(progress=lambda stage, done, total: report("thesis", done, total))

    delivery.deliver(make, output, as_json=as_json, kept="the claims judged so far stay")


def _redone(path: str, output: str, as_json: bool, options: dict[str, Any]) -> None:
    """The thesis's steps for the pair of a case file."""
    from thermogear.case.allowed import kelvin
    from thermogear.front.numbers import grid
    from thermogear.study.thesis_pair import thesis_pair

    names = ("operating", "bundle", "values")
    given = {name: options[name] for name in names if options[name] is not None}
    if options["temperatures"] is not None:
        degrees = grid("--temperatures", options["temperatures"]).tolist()
        given["temperatures"] = [kelvin("--temperatures", value) for value in degrees]
    given["records"] = dict(_record(text) for text in options["records"])
    read = delivery.load_gears(path, options["overrides"])
    delivery.deliver(
        lambda report: thesis_pair(read, progress=report, **given), output, as_json=as_json
    )


def _record(text: str) -> tuple[Path, float | None]:
    """File and speed [rad/s] of ``FILE[=RPM]``."""
    name, sign, rpm = text.rpartition("=")
    try:
        return Path(name if sign else text), float(rpm) * RPM if sign else None
    except ValueError:
        raise InputError("--record", repr(text), allowed="FILE=RPM, a number of rpm") from None


COMMANDS: list[click.Command] = [thesis]
