"""``thermogear diagnose``: the command for the main group to register."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.front import delivery
from thermogear.front.measure_commands import case_speed, reads, require_gear
from thermogear.front.measuring import in_angles
from thermogear.front.numbers import number

if TYPE_CHECKING:
    from thermogear.results.result import Result

MACHINES = ("large rigid", "large flexible", "medium rigid", "medium flexible")


@click.command()
@click.argument("files", metavar="RECORD... [CASE]", nargs=-1, required=True)
@click.option(
    "--baseline",
    "baselines",
    metavar="RECORD|DIR",
    multiple=True,
    help="Healthy record of the same machine, or a folder of them. May be repeated.",
)
@reads
@number("--wheel-teeth", "Teeth of the wheel.", "a whole number 1..2000", "48", whole=True)
@click.option(
    "--bearing",
    "bearings",
    metavar="TYPE",
    multiple=True,
    help="Rolling bearing on the pinion's shaft, as 6205. May be repeated.",
)
@click.option(
    "--wheel-bearing",
    "wheel_bearings",
    metavar="TYPE",
    multiple=True,
    help="Rolling bearing on the wheel's shaft. May be repeated.",
)
@click.option(
    "--band",
    metavar="LOW:HIGH",
    help="Orders of the pinion between which the envelope is taken [by the kurtogram].",
)
@click.option(
    "--machine",
    type=click.Choice(MACHINES),
    help="Class of ISO 10816-3, for the zone of the velocity: large is above 300 kW, medium from "
    "15 kW on; support rigid or flexible.",
)
@delivery.as_json
@delivery.output("Also write diagnosis.nc and its page.", required=False)
def diagnose(
    files: tuple[str, ...],
    baselines: tuple[str, ...],
    wheel_teeth: int | None,
    bearings: tuple[str, ...],
    wheel_bearings: tuple[str, ...],
    band: str | None,
    machine: str | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> None:
    """Say what RECORD shows of gears and bearings, against healthy ones of the same machine.

    For each shaft a synchronous average, its condition indicators and teeth; beside them the
    squared envelope with the bearings' rates, the cepstrum, the velocity. Without --baseline there
    are values and no verdict. Teeth are those of --teeth and --wheel-teeth, or of CASE.
    """
    require_gear(options["teeth"], options["speed"])
    require_gear(wheel_teeth)
    named, case = _parted(files)
    teeth = options["teeth"], wheel_teeth
    if case is not None:
        pair = delivery.load_gears(case, ()).pair
        teeth = teeth[0] or pair.pinion.teeth, teeth[1] or pair.wheel.teeth
        options["speed"] = options["speed"] or case_speed(delivery.load(case, ()))
    if teeth[0] is None:
        why = "averages count in turns of the pinion, by its mesh line or its tacho"
        raise InputError(
            "--teeth", "none", why=why, fix="give --teeth and --wheel-teeth, or a case"
        )
    edges = None if band is None else _band(band)

    def make(report: Progress) -> Result:
        from thermogear.study.bearing_rates import bearing_rates
        from thermogear.study.diagnosis import diagnose as study

        hung = [("pinion", rates) for rates in bearing_rates(bearings)]
        hung += [("wheel", rates) for rates in bearing_rates(wheel_bearings)]

        return study(
            *in_angles(named, baselines, teeth[0] or 0, options),
            teeth=(teeth[0] or 0, teeth[1]),
            bearings=hung,
            band=edges,
            machine=machine,
            progress=report,
        )

    delivery.deliver(make, output, as_json=as_json)


def _parted(files: tuple[str, ...]) -> tuple[tuple[str, ...], str | None]:
    """Records, and the case where the last name is one's."""
    from thermogear.case.examples import EXAMPLES

    last = files[-1]
    if Path(last).suffix != ".toml" and (last not in EXAMPLES or Path(last).exists()):
        return files, None
    if len(files) == 1:
        raise InputError(
            "RECORD", last, why="it is a case, and no record", fix="name a record first"
        )
    return files[:-1], last


def _band(text: str) -> tuple[float, float]:
    low, sign, high = text.partition(":")
    try:
        edges = float(low), float(high)
    except ValueError:
        edges = 0.0, 0.0
    if not (sign and 0.0 <= edges[0] < edges[1] < 1e6):
        raise InputError("--band", repr(text), allowed="LOW:HIGH in orders, as 60:200")
    return edges


COMMANDS: tuple[click.Command, ...] = (diagnose,)
