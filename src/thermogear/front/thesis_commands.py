"""``thermogear thesis`` and ``thermogear sensitivity``: commands for the main group to register."""

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
    "--experiment",
    type=click.IntRange(8, 10_000),
    metavar="N",
    help="Sample N drive trains of the test rig anew, seconds each; left out, the 256 that come "
    "with the package.",
)
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
def thesis(
    case: str | None,
    output: str,
    experiment: int | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Judge every claim of the thesis, or redo the thesis for CASE, and write the report to DIR.

    Without CASE sections 2 to 6: what is said, what is computed as in the thesis and consistently,
    a verdict, its argument and the code behind it. With CASE the thesis's steps for one operating
    point of it: gear temperatures, damping, speed and stiffness fluctuation, friction, records,
    outlook. Ctrl+C keeps what is finished.
    """
    if case is not None:
        if experiment is not None:
            raise InputError("--experiment", experiment, why="beside CASE", fix="leave one out")
        _redone(case, output, as_json, options)
        return
    for name, value in options.items():
        if value:
            raise InputError(f"--{OPTIONS.get(name, name)}", value, why="no case is named")
    from thermogear.study.sensitivity import require_salib

    require_salib()

    def make(report: Progress) -> Result:
        from thermogear.thesis.evidence import Size
        from thermogear.thesis.report import build

        return build(
            Size(trains=experiment or 0),
            progress=lambda stage, done, total: report("thesis", done, total),
        )

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


@click.command()
@delivery.case
@delivery.output("Store the study and its page in DIR.", required=False)
@click.option(
    "--samples",
    default=128,
    show_default=True,
    help="Base samples, a power of two, 8 or more; 128 for figures.",
)
@click.option("--speed", type=float, metavar="RPM", help="Pinion speed; the case's middle one.")
@click.option("--seed", default=1, show_default=True, help="Seed of sampling and bootstrap.")
@delivery.overrides
@delivery.as_json
def sensitivity(
    case: str,
    output: str | None,
    samples: int,
    speed: float | None,
    seed: int,
    overrides: tuple[str, ...],
    as_json: bool,
) -> None:
    """Which inputs decide which results (extra [sensitivity]).

    Widths, loads, oil, finish, backlash, damping, error and heat run through ranges around those of
    CASE. Of the ready-made `rig` they are the inputs that the thesis leaves unstated, and its
    conclusions are judged.
    """
    from thermogear.study.sensitivity import Plan, require_salib
    from thermogear.study.sensitivity import sensitivity as study
    from thermogear.study.watched import inputs_of

    require_salib()
    if speed is not None and not 0.0 < speed < 1e6:
        raise InputError("--speed", f"{speed:g} rpm", allowed="> 0, below 1e6 rpm")
    at = None if speed is None else speed * RPM
    Plan(samples=samples, speed=at, seed=seed)
    read = delivery.load_gears(case, overrides)
    plan = Plan(samples=samples, speed=at, seed=seed, inputs=inputs_of(read))

    def make(report: Progress) -> Result:
        return study(read, plan, progress=report)

    delivery.deliver(make, output, as_json=as_json)


COMMANDS: list[click.Command] = [thesis, sensitivity]
