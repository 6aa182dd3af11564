"""``thermogear measure`` and ``thermogear compare``: commands for the main group to register."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery
from thermogear.front.measuring import measured_by, measured_files
from thermogear.front.numbers import number

if TYPE_CHECKING:
    from thermogear.results.result import Result


def supplies(command: Any) -> Any:
    """The options that supply what a file does not state."""
    for option in (
        number("--rate", "Samples per second.", "> 0 samples/s", "25600", metavar="HZ"),
        click.option(
            "--unit", metavar="UNIT", help="Unit of the vibration channels: g, m/s^2, ..."
        ),
        number("--scale", "Units at full scale, for integer samples.", "a number of units", "50"),
        number("--teeth", "Teeth of the pinion.", "a whole number 1..2000", "25", whole=True),
        number(
            "--speed", "Nominal speed of the pinion.", "> 0 .. 500000 rpm", "1500", metavar="RPM"
        ),
        click.option(
            "--channel",
            "channels",
            multiple=True,
            help="Channel to use (name or number); of several files also FILE::CHANNEL.",
        ),
        click.option(
            "--tacho",
            metavar="CHANNEL|FILE",
            help="Channel of pulses or of speed (name or number), or a file that has it; of "
            "several channels of a file FILE::CHANNEL.",
        ),
        number("--pulses", "Tacho pulses per turn.", "1e-6..1e7 pulses per turn", "1"),
        number(
            "--tacho-scale",
            "The tacho channel is a speed in another unit, as volts: rpm in one of them.",
            "> 0 rpm",
            "300",
            metavar="RPM",
        ),
        number(
            "--orders",
            "Order of the first shaft to read too. May be repeated.",
            "> 0 .. 10000",
            "1",
            multiple=True,
            metavar="ORDER",
        ),
        number("--harmonics", "Mesh harmonics to read [3].", "1..64", "3", whole=True),
        number("--sidebands", "Sidebands on each side to read [2].", "0..64", "2", whole=True),
        click.option(
            "--decimal", type=click.Choice([".", ","]), help="Decimal sign of a text file."
        ),
        number(
            "--limit",
            "Most GiB that a packed file may become [32 times its size, 0.25..8].",
            "> 0 GiB",
            "4",
            metavar="GIB",
        ),
        number(
            "--sensor-tolerance",
            "Relative standard uncertainty of the sensor.",
            "0 .. below 1",
            "0.03",
        ),
        click.option(
            "--method",
            default="frequency",
            show_default=True,
            help="Acceleration to displacement: frequency, line, or trapezoid as in the thesis.",
        ),
    ):
        command = option(command)
    return command


def _require_gear(options: dict[str, Any]) -> None:
    """Refuse teeth and a speed that no gear has, before anything is read."""
    from thermogear.measured.reduction import require_teeth

    speed = options["speed"]
    from thermogear.base.bounds import SPEED

    if speed is not None and not 0.0 < speed * RPM <= SPEED.most:
        raise InputError("--speed", f"{speed:g} rpm", allowed=f"> 0 .. {SPEED.high:g} rpm")
    require_teeth(options["teeth"])


@click.command()
@click.argument("files", metavar="FILE|DIR...", nargs=-1, required=True)
@supplies
@click.option(
    "--baseline",
    metavar="first|last|FILE",
    help="Of several records the one that the others are compared with [first].",
)
@click.option(
    "--join",
    type=click.Choice(["channels", "time"]),
    help="The files are one run: each some of its channels, or pieces of its time in this order.",
)
@delivery.as_json
@delivery.output("Also write measured.nc (of several: records.nc) and its page.", required=False)
def measure(
    files: tuple[str, ...],
    baseline: str | None,
    join: str | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> None:
    """Read a record and print its lines: order, frequency, amplitude, uncertainty.

    Of several files, or of those in a directory, what changed against a baseline beyond its
    uncertainty, and trends; with --join they are one record.
    """
    _require_gear(options)
    one = len(files) == 1 and not Path(files[0]).is_dir()
    if one and baseline is not None:
        raise InputError("--baseline", baseline, why="there is one record", fix="name several")
    if join is not None and baseline is not None:
        why = "files that are joined are one record"
        raise InputError("--baseline", baseline, why=why, fix="leave out --join or --baseline")

    def make(report: Progress) -> Result:
        from thermogear.measured.dataset import result_of
        from thermogear.measured.several import files_of

        if one and join is None:
            return result_of(measured_by(files[0], options))
        return measured_files(files_of(files), join, baseline, options, report)

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@click.argument("case", metavar="CASE")
@click.argument("measured", metavar="[FILE|TABLE]", required=False)
@supplies
@click.option(
    "--tolerance",
    "tolerances",
    multiple=True,
    metavar="FIELD=PERCENT",
    help="Standard uncertainty of a field of the case, as operating.torque=5. May be repeated.",
)
@click.option("--samples", type=int, help="Runs for the input uncertainty of --tolerance [12].")
@click.option(
    "--at",
    multiple=True,
    metavar="CHANNEL=PLACE:DIRECTION",
    help="Where an accelerometer sits on the drive train, as a1=bearing:pinion left:x, "
    "a2=housing:y or a3=bearing:wheel left:30 (degrees from x). May be repeated.",
)
@click.option("--u-data", type=float, metavar="PERCENT", help="Uncertainty of the measurement.")
@delivery.overrides
@delivery.as_json
@delivery.output("Also write comparison.nc and comparison.html.", required=False)
def compare(
    case: str,
    measured: str | None,
    tolerances: tuple[str, ...],
    samples: int | None,
    at: tuple[str, ...],
    u_data: float | None,
    overrides: tuple[str, ...],
    as_json: bool,
    output: str | None,
    **options: Any,
) -> None:
    """Compare CASE (a case, a directory of results, or thesis-5.2) with a record or a table.

    A case with shafts and --at: mesh lines of accelerometers on bearings or housing are compared
    with the drive train's at the same place, along the same axis. Places: bearing:NAME, housing,
    journal:NAME, gear:pinion, gear:wheel.
    """
    from thermogear.measured.comparison import result_of
    from thermogear.measured.published import PUBLISHED, is_table
    from thermogear.study.compare import compare as study
    from thermogear.study.compare import computes

    _require_gear(options)
    read: Any = case
    if computes(case) and measured is not None:
        read = delivery.load(case, overrides)
    elif overrides:
        raise InputError(
            "--set",
            overrides[0],
            why="stored lines are not computed anew",
            fix="name the case instead of its results",
        )
    if samples is not None and not tolerances:
        raise InputError("--samples", samples, why="beside no --tolerance", fix="leave it out")
    table = measured in PUBLISHED or (measured is not None and is_table(measured))
    record = measured is not None and not table
    if at and not record:
        raise InputError("--at", at[0], why="there is no record to read", fix="name a record")
    for name, value in options.items():
        # a table of lines may count in shaft turns: its teeth are asked for
        given = value if name != "method" else value != "frequency"
        if given and not record and not (name == "teeth" and table):
            option = "--channel" if name == "channels" else f"--{name.replace('_', '-')}"
            raise InputError(option, value, why="there is no record to read", fix="leave it out")
    speed = options["speed"]
    tolerated = dict(_tolerance(text) for text in tolerances)

    def make(report: Progress) -> Result:
        against: Any = measured
        if measured is not None and record:
            known = dict(options)
            if at:
                known = _expected(read, known)
            against = measured_by(measured, known)
        found = study(
            read,
            against,
            teeth=options["teeth"],
            speed=None if speed is None else speed * RPM,
            at=at,
            u_data=None if u_data is None else u_data / 100.0,
            tolerances=tolerated,
            samples=12 if samples is None else samples,
        )
        return result_of(found)

    delivery.deliver(make, output, as_json=as_json)


def _expected(case: Any, options: dict[str, Any]) -> dict[str, Any]:
    """``options`` with teeth and speed of the case, by which the record's mesh line is found.

    What is given stays; a speed is known where the case has one alone.
    """
    from thermogear.case.case import gear_case

    if isinstance(case, str):
        return options  # results
    read = gear_case(case)
    speeds = set(read.stated.speed.tolist())
    own = {
        "teeth": read.pair.pinion.teeth,
        "speed": speeds.pop() / RPM if len(speeds) == 1 else None,
    }
    return {**options, **{name: v for name, v in own.items() if options[name] is None}}


def _tolerance(text: str) -> tuple[str, float]:
    name, sign, value = text.partition("=")
    try:
        number = float(value.strip().removesuffix("%"))
    except ValueError:
        number = float("nan")
    if not (sign and name.strip() and number >= 0):
        raise InputError("--tolerance", repr(text), allowed="FIELD=PERCENT, as operating.torque=5")
    return name.strip(), number / 100.0


COMMANDS: tuple[click.Command, ...] = (measure, compare)
