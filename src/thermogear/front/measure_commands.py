"""``thermogear measure`` and ``thermogear compare``: commands for the main group to register."""

from __future__ import annotations

import math
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from thermogear.base.errors import InputError
from thermogear.base.progress import Progress
from thermogear.base.units import RPM
from thermogear.front import delivery
from thermogear.front.measuring import in_angles, measured_among, measured_by, measured_files
from thermogear.front.numbers import number

if TYPE_CHECKING:
    from thermogear.results.result import Result


def reads(command: Any, *, speeds: bool = False) -> Any:
    """The options that supply what a file does not state; ``speeds``: --speed may be repeated."""
    return delivery.together(
        number("--rate", "Samples per second.", "> 0 samples/s", "25600", metavar="HZ"),
        click.option(
            "--unit", metavar="UNIT", help="Unit of the vibration channels: g, m/s^2, ..."
        ),
        number("--scale", "Units at full scale, for integer samples.", "a number of units", "50"),
        number("--teeth", "Teeth of the pinion.", "a whole number 1..2000", "25", whole=True),
        number(
            "--speed",
            "Nominal speed of the pinion" + " (one of each record)" * speeds + ".",
            "> 0 .. 500000 rpm",
            "1500, or '25 Hz'",
            metavar="RPM",
            multiple=speeds,
            units={"rpm": 1.0, "Hz": 60.0, "rad/s": 30.0 / math.pi},
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
    )(command)


def supplies(command: Any, *, speeds: bool = False) -> Any:
    """Those of :func:`reads`, and the options of what is read from a record."""
    return delivery.together(
        partial(reads, speeds=speeds),
        number(
            "--orders",
            "Order of the first shaft to read too. May be repeated.",
            "> 0 .. 10000",
            "1",
            multiple=True,
            metavar="ORDER",
        ),
        click.option(
            "--bearing",
            "bearings",
            metavar="TYPE",
            multiple=True,
            help="Rolling bearing on the first shaft, as 6205: its rates are looked for in the "
            "envelope. May be repeated.",
        ),
        number(
            "--start",
            "Read the record from there on [0 s]; 2097152 samples at most are reduced.",
            "a time within the record, in seconds",
            "60",
            metavar="SECONDS",
        ),
        number("--harmonics", "Mesh harmonics to read [3].", "1..64", "3", whole=True),
        number("--sidebands", "Sidebands on each side to read [2].", "0..64", "2", whole=True),
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
    )(command)


def require_gear(teeth: int | None, *speeds: float | None) -> None:
    """Refuse teeth and speeds that no gear has, before anything is read."""
    from thermogear.base.bounds import SPEED
    from thermogear.measured.reduction import require_teeth

    for speed in speeds:
        if speed is not None and not 0.0 < speed * RPM <= SPEED.most:
            raise InputError("--speed", f"{speed:g} rpm", allowed=f"> 0 .. {SPEED.high:g} rpm")
    require_teeth(teeth)


@click.command()
@click.argument("files", metavar="FILE|DIR...", nargs=-1, required=True)
@supplies
@click.option(
    "--join",
    type=click.Choice(["channels", "time"]),
    help="The files are one run: each some of its channels, or pieces of its time in this order.",
)
@delivery.as_json
@delivery.output("Also write measured.nc and its page.", required=False)
def measure(
    files: tuple[str, ...],
    join: str | None,
    as_json: bool,
    output: str | None,
    **options: Any,
) -> None:
    """Read a record and print its lines: order, frequency, amplitude, uncertainty.

    Several files, or those in a directory, are one run: --join says how.
    """
    require_gear(options["teeth"], options["speed"])

    def make(report: Progress) -> Result:
        from thermogear.measured.dataset import result_of

        return result_of(measured_files(files, join, options, report))

    delivery.deliver(make, output, as_json=as_json)


@click.command()
@click.argument("case", metavar="CASE")
@click.argument("measured", metavar="[FILE|DIR|TABLE]...", nargs=-1)
@partial(supplies, speeds=True)
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
@click.option(
    "--baseline",
    "baselines",
    metavar="RECORD|DIR",
    multiple=True,
    help="Healthy record: condition indicators are compared, simulated with the [[faults]] of CASE "
    "and without. May be repeated.",
)
@delivery.overrides
@delivery.as_json
@delivery.output(
    "Also write comparison.nc and comparison.html; with --baseline they are named diagnosis.",
    required=False,
)
def compare(
    case: str,
    measured: tuple[str, ...],
    tolerances: tuple[str, ...],
    samples: int | None,
    at: tuple[str, ...],
    u_data: float | None,
    baselines: tuple[str, ...],
    overrides: tuple[str, ...],
    as_json: bool,
    output: str | None,
    speed: tuple[float, ...],
    **options: Any,
) -> None:
    """Compare CASE (a case, a directory of results, or thesis-5.2) with records or tables.

    Several records, at one speed each, make one table with one verdict on heat for each bundle. A
    case is computed at the speed of the record: --speed (one for all, or one of each in their
    order), else what its mesh line and the teeth of the case imply.

    A case with shafts and --at: mesh lines of accelerometers on bearings or housing are compared
    with the drive train's at the same place, along the same axis. Places: bearing:NAME, housing,
    journal:NAME, gear:pinion, gear:wheel.

    With --baseline the indicators of `diagnose`: of the baseline, of the record, and of the motion
    without the faults of CASE and with them, with the change of both.
    """
    from thermogear.measured.comparison import result_of
    from thermogear.measured.joined import files_of
    from thermogear.measured.published import PUBLISHED, is_table
    from thermogear.study.compare import compare as study
    from thermogear.study.compare import computes, own_teeth, speeds_of

    require_gear(options["teeth"], *speed)
    read: Any = case
    if computes(case) and (measured or baselines):
        read = delivery.load(case, overrides)
    elif overrides:
        raise InputError(
            "--set",
            overrides[0],
            why="stored lines are not computed anew",
            fix="name the case instead of its results",
        )
    if baselines:
        lines = {"tolerance": tolerances, "samples": samples, "at": at, "u-data": u_data}
        options["speed"] = next(iter(speed), None)
        faults = partial(_faults, read, measured, baselines, lines, options)
        delivery.deliver(faults, output, as_json=as_json)
        return
    if samples is not None and not tolerances:
        raise InputError("--samples", samples, why="beside no --tolerance", fix="leave it out")
    found = ([name] if name in PUBLISHED else files_of([name]) for name in measured)
    named = [str(file) for several in found for file in several]
    tables = [one in PUBLISHED or is_table(one) for one in named]
    if at and (not named or any(tables)):
        raise InputError("--at", at[0], why="there is no record to read", fix="name a record")
    for name, value in {**options, "speed": speed}.items():
        # a table of lines may count in shaft turns: its teeth are asked for
        given = value if name != "method" else value != "frequency"
        if given and all(tables) and not (name == "teeth" and tables):
            option = "--channel" if name == "channels" else f"--{name.replace('_', '-')}"
            raise InputError(
                option, value[0] if name == "speed" else value, why="there is no record to read",
                fix="leave it out",
            )  # fmt: skip
    tolerated = dict(_tolerance(text) for text in tolerances)
    speeds = speeds_of([*speed] if len(speed) > 1 else next(iter(speed), None), len(named))

    def make(report: Progress) -> Result:
        teeth = options["teeth"] or (own_teeth(read) if named else None)
        against: list[Any] = []
        for file, table, rpm in zip(named, tables, speeds, strict=True):
            known = {**options, "teeth": teeth, "speed": rpm or (case_speed(read) if at else None)}
            read_by = measured_by if len(named) == 1 else measured_among
            against.append(file if table else read_by(file, known))
        return result_of(
            study(
                read,
                against or None,
                teeth=teeth,
                speed=[None if rpm is None else rpm * RPM for rpm in speeds] or None,
                at=at,
                u_data=None if u_data is None else u_data / 100.0,
                tolerances=tolerated,
                samples=12 if samples is None else samples,
            )
        )

    delivery.deliver(make, output, as_json=as_json)


_OF_LINES = ("orders", "start", "harmonics", "sidebands", "sensor_tolerance")


def _faults(
    case: Any,
    records: tuple[str, ...],
    baseline: tuple[str, ...],
    lines: dict[str, Any],
    options: dict[str, Any],
    report: Progress,
) -> Result:
    """Indicators of records beside those of a case's motion with its faults and without."""
    from thermogear.case.case import gear_case
    from thermogear.study.bearing_rates import bearing_rates
    from thermogear.study.compare_faults import compare_faults

    for name, given in (lines | {name: options[name] for name in _OF_LINES}).items():
        if given:
            got = ", ".join(map(str, given)) if isinstance(given, tuple) else given
            why = "beside --baseline indicators are compared, not lines"
            option = f"--{name.replace('_', '-')}"
            raise InputError(option, got, why=why, fix="leave one out")
    if isinstance(case, str):
        why = "it is no case, and has no motion with faults"
        raise InputError("CASE", case, why=why, fix="name the case itself")
    pair = gear_case(case)
    options["speed"] = options["speed"] or case_speed(case)
    return compare_faults(
        pair,
        *in_angles(records, baseline, pair.pair.pinion.teeth, options),
        bearings=[("pinion", rates) for rates in bearing_rates(options["bearings"])],
        progress=report,
    )


def case_speed(case: Any) -> float | None:
    """The speed [rpm] of a case that has one alone, by which a record's mesh line is found."""
    from thermogear.base import display

    speeds: set[float] = set() if isinstance(case, str) else set(case.stated.speed.tolist())
    return display.SPEED(speeds.pop()) if len(speeds) == 1 else None


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
