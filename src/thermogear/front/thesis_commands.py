"""``thermogear thesis`` and ``thermogear sensitivity``: commands for the main group to register."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery

if TYPE_CHECKING:
    from thermogear.results.result import Result


MOST_TRAINS = 10_000


@click.command()
@delivery.output("Directory of the report; made if new.")
@click.option("--redraw", is_flag=True, help="Draw the page anew from what DIR holds already.")
@click.option(
    "--experiment",
    type=int,
    metavar="N",
    help="Sample N drive trains of the test rig anew, seconds each; left out, the 256 that come "
    "with the package.",
)
@delivery.as_json
def thesis(output: str, redraw: bool, experiment: int | None, as_json: bool) -> None:
    """Judge every claim of the thesis and write the report to DIR.

    Sections 2 to 6: what is said, what is computed as in the thesis and consistently, a verdict,
    its argument and the code behind it. Ctrl+C keeps the claims judged so far.
    """
    if experiment is not None and not 8 <= experiment <= MOST_TRAINS:
        raise InputError("--experiment", experiment, allowed=f"8..{MOST_TRAINS} drive trains")
    if redraw:
        if experiment is not None:
            raise InputError("--experiment", experiment, why="beside --redraw", fix="leave it out")
        from thermogear.views.write import write_report

        click.echo(write_report(Path(output)))
        return
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
