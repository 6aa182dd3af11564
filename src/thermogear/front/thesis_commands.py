"""``thermogear thesis`` and ``thermogear sensitivity``: commands for the main group to register."""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path

import click

from thermogear.base.errors import InputError
from thermogear.base.units import RPM


@click.command()
@click.option(
    "-o", "--output", required=True, metavar="DIR", help="Directory of the report; made if new."
)
@click.option("--redraw", is_flag=True, help="Draw the page anew from what DIR holds already.")
@click.option("--json", "as_json", is_flag=True, help="Print the summary as JSON.")
def thesis(output: str, redraw: bool, as_json: bool) -> None:
    """Judge every claim of the thesis and write the report to DIR.

    Sections 2 to 6: what is said, what is computed as in the thesis and consistently, a verdict,
    its argument and the code behind it. Ctrl+C keeps the claims judged so far.
    """
    from thermogear.views.claims_report import REPORT, write_claims_report

    directory = Path(output)
    if redraw:
        click.echo(write_claims_report(directory))
        return
    from thermogear.front.progress import Stopped, progress
    from thermogear.study.sensitivity import require_salib
    from thermogear.thesis.report import build_to_directory

    require_salib()
    with progress(wanted=not as_json) as told:
        summary = build_to_directory(
            directory,
            progress=lambda stage, done, total: told("thesis", done, total),
            also=write_claims_report,
        )
    path = directory / REPORT
    cut = summary["claims"] < summary["claims_in_all"]
    if as_json:
        click.echo(json.dumps(summary, indent=2, ensure_ascii=False))
    else:
        of = f" of {summary['claims_in_all']}" if cut else ""
        click.echo(f"{summary['claims']}{of} claims in {summary['seconds']:.0f} s")
        for verdict, count in summary["verdicts"].items():
            click.echo(f"{count:6d}  {verdict}")
        click.echo(path)
    if cut:
        raise Stopped(f"the claims judged so far stay in {directory}")


@click.command()
@click.argument("case", metavar="CASE")
@click.option("-o", "--output", metavar="DIR", help="Store the study and its page in DIR.")
@click.option(
    "--samples",
    default=128,
    show_default=True,
    help="Base samples, a power of two, 8 or more; 128 for figures.",
)
@click.option("--speed", type=float, metavar="RPM", help="Pinion speed; the case's middle one.")
@click.option("--seed", default=1, show_default=True, help="Seed of sampling and bootstrap.")
@click.option(
    "--set", "overrides", multiple=True, metavar="PATH=VALUE",
    help="Put a value in place of the file's. May be repeated.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the indices as JSON.")
def sensitivity(
    case: str,
    output: str | None,
    samples: int,
    speed: float | None,
    seed: int,
    overrides: tuple[str, ...],
    as_json: bool,
) -> None:
    """Which inputs that the thesis leaves unstated decide its conclusions (extra [sensitivity]).

    Ranges and conclusions are those of the thesis's rig: CASE is the ready-made case `rig`, or a
    copy of it with the same gears and values; any other is refused.
    """
    from thermogear.case.case import gear_case, load_case
    from thermogear.case.thesis_cases import require_of_the_thesis
    from thermogear.front.progress import progress
    from thermogear.results.files import claimed
    from thermogear.study.sensitivity import (
        ABOUT,
        Plan,
        as_rows,
        plain_words,
        require_salib,
        store,
    )
    from thermogear.study.sensitivity import sensitivity as study

    require_salib()
    if speed is not None and not 0.0 < speed < 1e6:
        raise InputError("--speed", f"{speed:g} rpm", allowed="> 0, below 1e6 rpm")
    plan = Plan(samples=samples, speed=None if speed is None else speed * RPM, seed=seed)
    read = gear_case(load_case(Path(case), overrides))
    require_of_the_thesis(read, ABOUT)
    with nullcontext() if output is None else claimed(Path(output)) as folder:
        with progress(wanted=not as_json) as told:
            data = study(read, plan, progress=told)
        if folder is not None:
            from thermogear.views.claims_report import write_claims_report

            store(data, folder)
            page = write_claims_report(folder).name
    if as_json:
        click.echo(json.dumps(as_rows(data), indent=2, ensure_ascii=False))
    else:
        for text in plain_words(data):
            click.echo(f"- {text}")
        click.echo(f"{data.attrs['evaluations']} evaluations in {data.attrs['seconds']:.1f} s")
    if output is not None and not as_json:
        click.echo(Path(output) / page)


COMMANDS: list[click.Command] = [thesis, sensitivity]
